# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user sees of a render beside its light: threads, limits of numbers, images used twice, where there is no picture."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from native_scenes import MODULE, image, native, of_means, ortho, render, scene, square, sun
from native_scenes import material as metal

COST = 1.0
pytestmark = of_means  # nothing runs here that others do not run under sanitizers


def tasks():
    return len(os.listdir("/proc/self/task"))


@pytest.mark.parametrize("threads", [1, 3])
def test_as_many_threads_as_asked(threads):
    """With more than one those of the BVH's builder are there, too."""
    before, seen = tasks(), []
    for _ in range(20):  # those of a job before may still be ending
        time.sleep(0.01)
        before = min(before, tasks())
    job = native.start(scene(width=512, height=512, samples=65536, threads=threads))
    while native.poll(job)["stage"] != "render":
        assert not native.wait(job, 0.001)
    for _ in range(10):
        seen.append(tasks() - before)
        time.sleep(0.005)
    native.cancel(job)
    assert native.wait(job, 60)
    native.free(job)
    assert max(seen) == 1 if threads == 1 else max(seen) >= threads, seen


AIR = {"model": "SINGLE", "elevation": 0.5, "altitude": 0.0, "air": 1.0, "dust": 1.0, "ozone": 1.0, "later": True, "sun_size": 0.01,
       "sun_bright": 1.0, "strength": (1, 1, 1), "matrix": np.eye(3, 4).ravel().tolist()}


@pytest.mark.parametrize("model, word, low, high", [
    ("SINGLE", "altitude", 0, 1e5), ("SINGLE", "air", 0, 1e3), ("SINGLE", "dust", 0, 1e3), ("SINGLE", "ozone", 0, 1e3),
    ("SINGLE", "sun_size", 0, 1.5708), ("SINGLE", "sun_bright", 0, 1e6), ("SINGLE", "elevation", -1.5708, 1.5708),
    ("PREETHAM", "turbidity", 1, 1000)])
def test_limits_of_skies(model, word, low, high):
    """What Blender's own sliders give is within; what is just taken, and just not."""
    def told(value):
        try:
            native.free(native.start(scene(width=1, height=1, samples=1, sky={**AIR, "turbidity": 2.0, "model": model, word: value})))
        except ValueError as error:
            return str(error)
        return ""
    assert not told(low) and not told(high)
    for beyond in (low - 1e-3 * max(1, abs(low)), high * 1.001):
        assert f"{word} must be" in told(beyond), (word, beyond)


def test_two_materials_share_an_image():
    """Each with a strength of its own."""
    rng = np.random.default_rng(3)
    bumps = (0.5 + 0.2 * rng.standard_normal((8, 8, 3))).clip(0, 1).astype(np.float32)
    bumps[..., 2] = 1

    def picture(*strengths):
        meshes = []
        for k, _ in enumerate(strengths):
            mesh = square(0.4)
            mesh["positions"] = (np.asarray(mesh["positions"], np.float32).reshape(-1, 3) + (k - 0.5, 0, 0)).astype(np.float32)
            mesh["material"] = np.full_like(mesh["material"], k)
            meshes.append(mesh)
        return render(scene(width=32, height=32, samples=4, lights=[sun((0.3, 0.2, 1))], images=[image(bumps)], meshes=meshes,
                            materials=[metal(normal_image=0, normal_strength=strength) for strength in strengths]))[0]
    weak, strong = picture(0.3, 0.3), picture(1.0, 1.0)
    assert np.abs(weak - strong).max() > 0.01
    both = picture(0.3, 1.0)
    assert np.array_equal(both[:, :16], weak[:, :16]) and np.array_equal(both[:, 16:], strong[:, 16:])


@pytest.mark.parametrize("transparent", [True, False])
def test_a_mirror_ball_has_no_corners(transparent):
    """Beside the ball there is no picture: black, and not see-through."""
    camera = {**ortho(), "type": "PANO", "panorama": "MIRRORBALL", "fov": 1.0, "focal": 1.0, "range": [0.0] * 4, "sensor": (1.0, 1.0),
              "polynomial": [0.0] * 5, "frame": [0, 1, 0, 1]}
    picture, _ = render(scene(camera=camera, width=16, height=16, samples=16, meshes=[], lights=[], background=(2, 2, 2), transparent=transparent))
    assert (picture[:2, :2] == (0, 0, 0, 1)).all() and (picture[-2:, -2:] == (0, 0, 0, 1)).all()
    assert (picture[6:10, 6:10] == ((0, 0, 0, 0) if transparent else (2, 2, 2, 1))).all()


def test_a_library_that_cannot_be_loaded_is_named(tmp_path):
    """The module's own and the system's, each with the reason; as the reason why there is no picture."""
    shutil.copy(MODULE, tmp_path / "_native.abi3.so")
    for name in ("libembree3.so.3", "libembree4.so.4"):
        (tmp_path / name).write_text("no library")
    script = "from native_scenes import finish, native, scene; state = finish(native.start(scene())); print(state['state'], state['message'])"
    done = subprocess.run([sys.executable, "-c", script], cwd=Path(__file__).parent, text=True, capture_output=True, check=True,
                          env={**os.environ, "NATIVE_MODULE": str(tmp_path / "_native.abi3.so"), "LD_LIBRARY_PATH": str(tmp_path)})
    own, _, of_system = done.stdout.partition("; nor ")
    assert own == f"failed cannot load {tmp_path}/lib/libshade_embree.so: cannot open shared object file: No such file or directory"
    assert of_system.startswith(f"{tmp_path}/libembree") and "file too short" in of_system
