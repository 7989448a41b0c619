# SPDX-License-Identifier: GPL-3.0-or-later
"""Esc: a job ends at once wherever it is, and leaves a whole picture. What the denoiser gets and says, by one that stands in for
Open Image Denoise (fake_denoiser.c)."""

import ctypes
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from native_scenes import area, box, finish, image, native, persp, point, registers, scene, sky, some, sphere, sun
from test_native_closures import TRANSLUCENT, diffuse, glass, glossy, of, weighed

COST = 2.4

WORST = 0.3  # seconds
CASES = {
    # 12 bounces of glass and metal under an image and forty lamps
    "usual": {"max_bounces": 12, "lights": [area((k - 20, 3, 3)) for k in range(20)] +
              [point((k - 20, 3, -3), radius=0.1) for k in range(20)]},
    # in a closed box that loses nothing: a batch's paths are a thousand surfaces long, each of which
    # chooses from a thousand lamps
    "endless": {"max_bounces": 1024, "shut": True,
                "lights": [point((k / 100 - 5, 3, 3)) for k in range(1000)]},
}


def heavy(shut=False, **changes):
    rng = np.random.default_rng(1)
    balls = [sphere(40, 0.4, center) for center in rng.uniform(-1, 1, (20, 3))]
    looks = [of(glass(0.1)), of(weighed(diffuse(), 0.5), weighed(glossy(0.2), 0.5)), of(TRANSLUCENT)]
    for k, ball in enumerate(balls):
        ball["material"] = np.full_like(ball["material"], 0 if shut else k % 3)
    walls = [box((-5,) * 3, (5,) * 3)] if shut else []
    for wall in walls:
        wall["material"] = np.full_like(wall["material"], 1)
    return scene(width=1000, height=1000, samples=65536, camera=persp(), transparent=False,
                 materials=looks, meshes=balls + walls, images=[image(rng.random((64, 128, 3), np.float32))],
                 sky=sky(), **{"glossy_bounces": 1024, "diffuse_bounces": 1024,
                               "transmission_bounces": 1024, **changes})


@pytest.mark.parametrize("name", CASES)
def test_a_cancelled_render_ends_soon(name):
    late = []
    for wait in some((0.01, 0.1, 0.3)):
        job = native.start(heavy(**CASES[name]))
        while native.poll(job)["stage"] == "build":
            assert not native.wait(job, 0.01)
        assert not native.wait(job, wait), "nothing to cancel"
        start = time.perf_counter()
        native.cancel(job)
        assert native.wait(job, 60)
        late.append(time.perf_counter() - start)
        out = np.full((1000, 1000, 4), np.nan, np.float32)
        native.image(job, out)
        native.free(job)
        assert np.isfinite(out).all()
    print(f"{name}: cancelled after {max(late):.3f} s at most")
    assert max(late) < WORST


@pytest.fixture(scope="module")
def fake(tmp_path_factory):
    library = tmp_path_factory.mktemp("denoiser") / "fake.so"
    subprocess.run(["cc", "-fPIC", "-shared", Path(__file__).parent / "fake_denoiser.c", "-o", library], check=True)
    yield library
    made = ctypes.CDLL(str(library))  # the same that the module has opened
    assert ctypes.c_int.in_dll(made, "fake_open").value == 0, "what is done, fails or is cancelled is released"


def denoised(path, samples=4, **changes):
    return native.start(scene(samples=samples, meshes=[sphere(12)], lights=[sun((0.3, 0.2, 1), (9, 3, 1))], use_denoising=True,
                              denoiser=str(path), planes=[{"type": "ALBEDO"}, {"type": "NORMAL"}], **changes))


def pictures(job, size=(16, 16)):
    """The picture, as it was before, and the two planes that the denoiser looks at; from the bottom."""
    made = [np.full((*size, channels), np.nan, np.float32) for channels in (4, 4, 3, 3)]
    for out, plane in zip(made, ("", "NOISY", "ALBEDO", "NORMAL")):
        native.image(job, out, plane)
    native.free(job)
    return made


@pytest.mark.parametrize("before", ["", "?"])
def test_what_the_denoiser_gets(fake, before):
    """The light as it is, and what surfaces are, pixel by pixel."""
    job = denoised(f"{before}{fake}", threads=3)
    state = finish(job)
    assert state["state"] == "done" and not state["warnings"] and ctypes.c_int.in_dll(ctypes.CDLL(str(fake)), "fake_threads").value == 3
    picture, noisy, albedo, normal = pictures(job)
    assert noisy[..., :3].max() > 1.5 and (np.ptp(albedo, (0, 1)) > 0.2).all() and (np.ptp(normal, (0, 1)) > 0.5).all()
    assert np.abs(noisy[8] - noisy[-9]).max() > 1e-3  # upside down it is another
    np.testing.assert_allclose(picture[..., :3], noisy[::-1, :, :3] + 0.25 * (albedo + normal), rtol=1e-5, atol=1e-6)
    assert (picture[..., 3] == noisy[..., 3]).all()


@pytest.mark.parametrize("before, samples, by_it", [("", 1, True), ("?", 4, True), ("?", 1, False)])
def test_a_first_look_does_not_wait_for_the_denoiser(fake, before, samples, by_it):
    """One sample of a viewport goes through the simple filter, though the denoiser is there."""
    job = denoised(f"{before}{fake}", samples)
    assert finish(job)["state"] == "done"
    picture, noisy, albedo, normal = pictures(job)
    by_fake = noisy[::-1, :, :3] + 0.25 * (albedo + normal)
    assert np.allclose(picture[..., :3], by_fake, rtol=1e-5, atol=1e-6) == by_it and (picture != noisy).any()


def test_a_first_look_is_smoothed_further():
    """Without the denoiser: a faint edge on a plate of 96 pixels changes in some of them beside it, of the one sample in many."""
    pixels = np.repeat(np.float32([[[0.5], [0.55]]]), 3, -1)
    shown = {"type": "IMAGE", "image": 0, "out": registers(3, 3)}
    changed = []
    for samples in (1, 4):
        job = native.start(scene(
            samples=samples, width=96, height=4, lights=[], images=[image(pixels, filter="CLOSEST")], use_denoising=True,
            materials=[{"name": "x", "closure": "EMISSION", "weight": registers(3, 3), "nodes": [shown]}], denoiser="?/no/library",
            planes=[{"type": "ALBEDO"}, {"type": "NORMAL"}]))
        assert finish(job)["state"] == "done"
        picture, noisy, *_ = pictures(job, (4, 96))
        changed.append(np.count_nonzero(np.abs(picture - noisy)[2, :, 0] > 1e-5))
    assert changed[0] > 2 * changed[1] > 4


def test_a_denoiser_that_fails_says_why(fake, monkeypatch):
    monkeypatch.setenv("FAKE_ERROR", "no room for weights")
    job = denoised(fake)
    state = finish(job)
    assert state["state"] == "done"
    assert state["warnings"] == ["Open Image Denoise: no room for weights; the picture is as noisy as it was"]
    picture, noisy, *_ = pictures(job)
    assert (picture == noisy).all()


def test_a_denoiser_that_is_no_library_is_named(tmp_path):
    (tmp_path / "none.so").write_text("no library")
    job = denoised(tmp_path / "none.so")
    state = finish(job)
    native.free(job)
    assert state["state"] == "done"
    assert state["warnings"] == ["Open Image Denoise was not found; the picture is as noisy as it was"]


def test_esc_while_it_denoises_is_no_failure(fake, monkeypatch):
    monkeypatch.setenv("FAKE_WAITS", "1")
    job = denoised(fake)
    while native.poll(job)["stage"] != "denoise":
        assert not native.wait(job, 0.01)
    assert not native.wait(job, 0.05), "it does not wait"
    native.cancel(job)
    state = finish(job)
    assert state["state"] == "cancelled" and not state["warnings"] and not state["message"]
    picture, noisy, *_ = pictures(job)
    assert (picture == noisy).all()
