# SPDX-License-Identifier: GPL-3.0-or-later
"""What the module says that it holds, against the kernel's view of the process and sizes that are known."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from native_scenes import MODULE, SANITIZED, few, finish, image, material, native, point, scene, sky, sphere, square

COST = 2.8

MEGABYTE = 1 << 20


def held(**changes):
    """(bytes once it is rendered, the most until then)."""
    job = native.start(scene(samples=1, **changes))
    state = finish(job)
    native.free(job)
    return state["memory"], state["memory_peak"]


def resident():
    """Bytes, now and at most. (getrusage counts what was there before exec as well.)"""
    told = Path("/proc/self/status").read_text()
    return tuple(int(re.search(rf"^{name}:\s*(\d+) kB", told, re.M).group(1)) * 1024
                 for name in ("VmRSS", "VmHWM"))


def test_a_picture_is_four_floats_a_pixel():
    small, _ = held()
    large, peak = held(width=1024, height=2048)
    assert large - small == pytest.approx(32 * MEGABYTE, rel=0.01)
    assert peak >= large
    assert held()[1] < 8 * MEGABYTE  # not that of the larger one before


def test_all_is_given_back():
    before = held()
    held(meshes=[sphere(60)])
    assert held() == pytest.approx(before, abs=64 << 10)  # what threads are begun at the time


def test_a_hundred_jobs_hold_what_one_does():
    """Of all that a job may make; also of one that is refused, stopped, or left by another."""
    lit = point((0, 0, 2)) | {"pattern": {"width": 64, "height": 64, "axes": np.eye(3).ravel().tolist(), "data": np.ones(3 << 12, np.float32)}}
    layered = square()
    layered["layers"] = [{"layer": 0, "data": layered["corner_uvs"]}]
    rich = {"mattes": [{"type": "OBJECT"}, {"type": "MATERIAL"}], "matte_slots": 16, "planes": [{"type": "NORMAL"}, {"type": "SAMPLES"}],
            "adaptive_threshold": 0.1, "adaptive_min_samples": 1, "images": [image(np.ones((32, 32, 4), np.float32))], "lights": [lit],
            "filter_width": 1.5, "time_limit": 10.0, "threads": 2, "looks": [{"rays": np.array([2], np.uint32), "background": (1, 1, 1)}],
            "materials": [material(color_image=0, ex=1e12)],  # which is told
            "layers": [{"width": 2}, {"width": 4, "tangents_of": 0}], "meshes": [layered]}

    def round_of(number):
        held(**rich)
        job = native.start(scene(samples=1024, width=64, height=64, **rich))
        native.cancel(job)
        finish(job)
        native.free(job)
        for bad in ({"lights": [lit | {"pattern": lit["pattern"] | {"data": np.ones(5, np.float32)}}]}, {"meshes": [None]}, {"samples": 0}):
            with pytest.raises(ValueError):
                native.start(scene(**{**rich, **bad}))
        held(sky=sky(), images=rich["images"]) if number % 25 == 0 else None  # whose table takes longer than all else
    round_of(0)
    before = held()[0]
    for number in range(few(100)):
        round_of(number)
    after = held()[0]
    print(f"{after - before} bytes more after as many rounds")
    assert after == pytest.approx(before, abs=1 << 10)


@pytest.mark.skipif("ASAN_OPTIONS" in os.environ, reason="a sanitizer keeps what is freed")
def test_as_the_kernel_counts():
    """In a process of its own: the most, but for what the allocators keep."""
    script = ("import sys; sys.path.insert(0, sys.argv[1]); import test_native_memory as t; t.held();"
              "mesh = t.sphere(300); (before, _), held = t.resident(), t.held(meshes=[mesh], threads=2);"
              "print(held[1], t.resident()[1] - before)")
    done = subprocess.run([sys.executable, "-c", script, str(Path(__file__).parent)], check=True,
                          capture_output=True, text=True)
    said, seen = map(int, done.stdout.split())
    print(f"{said / MEGABYTE:.1f} MiB, the process grew by {seen / MEGABYTE:.1f}")
    assert said > 50 * MEGABYTE
    assert said == pytest.approx(seen, rel=0.15)


@pytest.mark.skipif("NATIVE_MODULE" in os.environ or SANITIZED, reason="a sanitizer has a malloc of its own")
def test_any_call_may_fail(tmp_path):
    """Each of the module's calls for memory in turn, and all from it on: a message, no crash, and the next render is whole."""
    folder, library = Path(__file__).parent, tmp_path / "libfaults.so"
    subprocess.run(["cc", "-O1", "-fPIC", "-shared", folder / "faults.c", "-o", library], check=True)
    done = subprocess.run([sys.executable, folder / "faults.py"], env={**os.environ, "LD_PRELOAD": str(library)},
                          capture_output=True, text=True)
    print(MODULE, done.stdout)
    assert done.returncode == 0, done.stderr[-3000:]
    assert int(re.search(r"^CALLS (\d+)$", done.stdout, re.M).group(1)) > 100
    ends = eval(re.search(r"^ENDS (.*)$", done.stdout, re.M).group(1))
    assert {"MemoryError", "failed out of memory", "done "} <= set(ends) <= {
        "MemoryError", "failed out of memory", "failed out of memory in Embree", "done ", "gone"}, ends
