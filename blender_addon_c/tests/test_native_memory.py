# SPDX-License-Identifier: GPL-3.0-or-later
"""What the module says that it holds, against the kernel's view of the process and sizes that are known."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from native_scenes import finish, native, scene, sphere

COST = 1.3

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


def test_all_is_given_back():
    before = held()
    held(meshes=[sphere(60)])
    assert held() == pytest.approx(before, abs=64 << 10)  # what threads are begun at the time


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
