# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of pixels that need no more samples get none: which ones, that their means stay right, and that
nothing depends on threads, tiles or what else is wanted."""

import numpy as np
import pytest

from native_scenes import (
    FEWER, SANITIZED, area, few, finish, image, material, native, ortho, persp, render, scene, sky, sphere, square, sun)
from test_native_closures import EMISSION, of

COST = 4.1

SIDE = 32


def spent(description):
    """The picture, and how many samples a pixel it took."""
    job = native.start(description)
    assert finish(job)["state"] == "done"
    picture = np.full((description["height"], description["width"], 4), np.nan, np.float32)
    native.image(job, picture)
    samples = native.timings(job)["samples"] / picture[..., 0].size
    native.free(job)
    return picture, samples


def half_noisy(**changes):
    """Left an even light, right a matt plate under a large lamp."""
    left, right = square(1.0, 0.0, 1), square(1.0)
    for half, x in ((left, -1), (right, 1)):
        half["positions"][:, 0] += x
    matt = material(f0=(0, 0, 0), fresnel="NONE", kd=(0.8,) * 3)
    given = {"meshes": [left, right], "materials": [matt, of(EMISSION | {"weight": [0.5] * 3})],
             "lights": [area((1, 0, 1), (4, 4), (9, 9, 9))], "width": SIDE, "height": SIDE, "samples": 512,
             "camera": ortho(1.0), "transparent": False}
    return scene(**given | changes)


def test_only_noisy_blocks_go_on():
    whole, all_samples = spent(half_noisy())
    done, some = spent(half_noisy(adaptive_threshold=1e-4, adaptive_min_samples=16))
    assert all_samples == 512
    assert some == pytest.approx((512 + 16) / 2, rel=0.01)  # of the left half only the first two passes
    np.testing.assert_allclose(done, whole, rtol=1e-5)
    _, least = spent(half_noisy(adaptive_threshold=1e9, adaptive_min_samples=1))
    assert least == 4
    _, more = spent(half_noisy(adaptive_threshold=1e9, adaptive_min_samples=65))
    assert more == 128


@pytest.fixture(scope="module")
def truth():
    return spent(half_noisy(samples=few(8192)))[0]


@pytest.mark.parametrize("threshold", [0.05 * FEWER**0.5, 0.01 * FEWER**0.5])
def test_the_error_is_what_was_asked_for(truth, threshold):
    """Of each block's pixels, by the root of the brightness: about the threshold, where it is done early."""
    seen, some = spent(half_noisy(samples=few(4096), adaptive_threshold=threshold, adaptive_min_samples=4))
    error = np.abs(seen - truth)[..., :3].sum(-1) / np.sqrt(truth[..., :3].sum(-1))
    assert some < few(3000)
    found = np.sqrt((error[:, SIDE // 2:] ** 2).mean()) / threshold
    least = (0.4 if threshold > 0.01 * FEWER**0.5 else 0.7) / (2 if SANITIZED else 1)
    assert least < found < 1.1  # of few samples to spend as many again halves it


def studio(**changes):
    rng = np.random.default_rng(5)
    pixels = rng.random((16, 32, 3)).astype(np.float32)
    pixels[12, 7] = (200, 150, 100)
    return scene(**{"meshes": [square(2), sphere(32, 0.5, (0, 0, 0.5))], "images": [image(pixels)], "sky": sky(),
                    "materials": [material(ex=60.0, ey=8.0)], "lights": [sun((0.3, 0.2, 1), angle=0.1)],
                    "width": 40, "height": 28, "max_bounces": 4, "camera": persp(0.4, (0, -3, 1.5), (0, 0, 0.3)),
                    "transparent": False} | changes)


def test_the_mean_stays_right():
    """Many small pictures, each of another seed: to stop early darkens them by what chance hides. A picture's
    mean varies by .11 %, that of three beside that of six by .08, one beside one by .16."""
    whole, stopped, limit = (1, 1, 0.006) if SANITIZED else (3, 6, 0.003)
    full = np.mean([spent(studio(samples=1024, seed=seed))[0][..., :3].mean() for seed in range(whole)])
    early = [spent(studio(samples=1024, seed=seed, adaptive_threshold=0.05, adaptive_min_samples=16))
             for seed in range(stopped)]
    assert np.mean([samples for _, samples in early]) < 400
    assert np.mean([picture[..., :3].mean() for picture, _ in early]) == pytest.approx(full, rel=limit)


def test_threads_change_no_bit_and_few_samples_all_count():
    given = studio(samples=300, adaptive_threshold=0.05, adaptive_min_samples=16)
    one, samples = spent(given | {"threads": 1})
    two, _ = spent(given | {"threads": 2})
    assert (one == two).all() and samples < 300
    plain, _ = render(studio(samples=16, adaptive_threshold=1e9, adaptive_min_samples=16))
    assert (plain == render(studio(samples=16))[0]).all()


def test_planes_are_means_over_the_same_samples():
    """Of emission the picture is the plane, whatever a block's number of samples."""
    given = half_noisy(adaptive_threshold=1e-4, adaptive_min_samples=16, planes=[{"type": name} for name in ("POSITION", "ALBEDO", "SAMPLES")])
    job = native.start(given)
    assert finish(job)["state"] == "done"
    albedo = np.zeros((SIDE, SIDE, 3), np.float32)
    native.image(job, albedo, "ALBEDO")
    part = np.zeros((SIDE, SIDE), np.float32)
    native.image(job, part, "SAMPLES")
    native.free(job)
    np.testing.assert_allclose(albedo[:, SIDE // 2 + 1:], 0.8, rtol=1e-4)
    assert (part[:, :SIDE // 2 - 4] == 16 / 512).all() and (part[:, SIDE // 2 + 4:] == 1).all()


def test_a_dim_picture_takes_as_many_samples():
    """An error is one by the root of the light: of a 10,000th of the light and a 100th of the error as many; of light below 0 none."""
    matt = material(f0=(0, 0, 0), fresnel="NONE", kd=(0.8,) * 3)
    bright, dim = (spent(half_noisy(samples=512, materials=[matt, matt], lights=[area((1, 0, 1), (4, 4), (9 * light,) * 3)],
                                    adaptive_threshold=0.05 * light**0.5, adaptive_min_samples=4))[1] for light in (1, 1e-4))
    assert dim == pytest.approx(bright, rel=0.05) and 8 < bright < 500
    _, none = spent(scene(samples=64, materials=[matt], lights=[sun(irradiance=(-1, -1, -1))], transparent=False, adaptive_threshold=0.05, adaptive_min_samples=4))
    assert none == 4


@pytest.mark.parametrize("name, value", [("adaptive_threshold", -1), ("adaptive_threshold", float("nan")),
                                         ("adaptive_min_samples", 0)])
def test_malformed(name, value):
    with pytest.raises(ValueError, match=name):
        native.start(scene(**{name: value}))
