# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders again and again, each time with another of the module's calls for memory failing, or all from there on: what is left to do
is to say so. With libfaults (faults.c) in LD_PRELOAD; prints how often each end was met."""

import ctypes
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from native_scenes import MODULE, area, image, material, native, scene, sphere, square, sun  # noqa: E402
from test_native_closures import glass, of  # noqa: E402

faults = ctypes.CDLL(None)
faults.faults_of.argtypes = [ctypes.c_size_t] * 2
faults.faults_set.argtypes = [ctypes.c_long, ctypes.c_int]
faults.faults_count.restype = ctypes.c_long
VIEW = "width", "height", "region", "samples", "camera"


def watch_module():
    lines = [line.split()[0] for line in Path("/proc/self/maps").read_text().splitlines() if MODULE.name in line]
    ends = [int(end, 16) for line in lines for end in line.split("-")]
    faults.faults_of(min(ends), max(ends))


def crowded():
    """A small picture with something of everything that asks for memory; but for skies, which take it in a thousand pieces."""
    pixels = np.random.default_rng(1).random((8, 16, 4), np.float32)
    return scene(width=8, height=8, samples=4, threads=2, transparent=False, lights=[sun(), area((0, 0, 2))], max_bounces=2, apart=True,
                 materials=[of(glass(0.1)), material(color_image=0, normal_image=0, ex=20, ey=5)], images=[image(pixels)],
                 meshes=[sphere(8), square(2.0, -1.0, 1)], adaptive_threshold=0.1, adaptive_min_samples=1,
                 planes=[{"type": "DEPTH"}, {"type": "ALBEDO"}], mattes=[{"type": "OBJECT"}], matte_slots=4, use_denoising=True,
                 denoiser="?")


def end_of(start):
    """How a job ends, and the job or None."""
    try:
        job = start()
    except MemoryError:
        return "MemoryError", None
    native.wait(job, 60)
    state = native.poll(job)
    return state["state"] + " " + state["message"], job


def once(given):
    """As a render does; then as a viewport does: another picture of the same scene, and from elsewhere."""
    ends, job = [], None
    for _ in range(2):
        end, made = end_of(lambda: native.start(given, job) if job else native.start(given))
        ends.append(end)
        job = made or job
    if job:
        try:
            end, made = end_of(lambda: native.look(job, {name: given[name] for name in VIEW}) or native.start(given))
        except ValueError:  # that job has gone with what it could not become
            end = "gone"
        ends.append(end)
    return ends


def calls(**metal):
    """How often memory is asked for in a render of a plate."""
    faults.faults_set(0, 0)
    ends = once(scene(threads=1, images=[image(np.full((4, 4, 4), 0.5, np.float32))], materials=[material(**metal)]))
    assert ends == ["done "] * 3, ends
    return faults.faults_count()


def main():
    given, ends = crowded(), Counter()
    assert once(given) == ["done "] * 3, once(given)
    watch_module()
    (plain, same), (bumped, more) = ([calls(horizon=horizon, normal_image=at) for horizon in ("hard", "mutual")] for at in (-1, 0))
    assert plain == same and bumped < more, (plain, same, bumped, more)  # slopes are looked for where there are bumps
    faults.faults_set(0, 0)
    once(given)
    total = faults.faults_count()
    for others in (0, 1):
        for number in range(1, total + 1, 4 if others else 1):
            faults.faults_set(number, others)
            ends.update(once(given))
            faults.faults_set(0, 0)
    assert once(given) == ["done "] * 3
    print("CALLS", total)
    print("ENDS", dict(ends))


main()
