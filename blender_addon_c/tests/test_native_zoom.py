# SPDX-License-Identifier: GPL-3.0-or-later
"""A bumped plate from near and from far: what is smaller than a sample is wide becomes roughness. Against very
many samples of points."""

import numpy as np
import pytest

from native_scenes import (
    dump, image, material, native, ortho, persp, registers, render, scene, some, square, sun, vectors)

COST = 4.7

ALPHA, TEXELS, TILES = 0.1, 256, 400
SLOPE = {"round": (0.15, 0.15), "brushed": (0.03, 0.15)}  # root mean squares along u and v


def bumps(along, across):
    """Normals of waves in all directions, some ten texels long: a Gaussian field of slopes."""
    frequency = np.fft.fftfreq(TEXELS)
    u, v = np.meshgrid(frequency, frequency)
    far = np.hypot(u, v) * TEXELS
    phase = 2 * np.pi * np.random.default_rng(5).random(far.shape)
    waves = np.exp(-((far / 24) ** 2) + 1j * phase) * (far > 2)
    slopes = [np.fft.ifft2(waves * 1j * axis).real for axis in (u, v)]
    x, y = (slope * wanted / np.sqrt((slope**2).mean()) for slope, wanted in zip(slopes, (along, across)))
    normal = np.stack([-x, -y, np.ones_like(x)], -1)
    return np.float32(0.5 + 0.5 * normal / np.linalg.norm(normal, axis=-1, keepdims=True))


def bumped(filtered, given):
    """A metal's normals from the first image, as the export has them."""
    normal = {"type": "NORMAL_MAP", "image": 0, "strength": 1.0, "filtered": filtered,
              "out": registers(3, 5 if filtered else 3)}
    spread = {"spread_from": registers(6, 2)} if filtered else {}
    return given | {"nodes": [normal], "normal": registers(3, 3), **spread}


def metal(filtered, alpha=ALPHA):
    return bumped(filtered, material(mdf="BECKMANN", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=alpha, ay=alpha))


def seen(kind, far, samples, blur=0.0, seed=1, metal=metal, light=(0.3, 0.1, 0.9), even=()):
    """32 x 32 pixels, straight from above; a tile of the map is one wide, a sun is aside. even: rows that have no bumps."""
    plate, normals = square(TILES), bumps(*SLOPE[kind])
    plate["corner_uvs"] = np.float32(plate["corner_uvs"] * TILES)
    normals[even, :] = 0.5, 0.5, 1
    made = scene(meshes=[plate], images=[image(normals)], materials=[metal(blur > 0)], normal_blur=blur,
                 lights=[sun(light, angle=0.02)], camera=persp(0.25, (0, 0.013, far), (0, 0.013, 0)),
                 width=32, height=32, samples=samples, seed=seed, transparent=False, max_bounces=0)
    return render(made)[0][..., 1].astype(float)


@pytest.mark.parametrize("kind", SLOPE)
def test_from_afar_bumps_are_roughness(kind):
    """Eight samples, 0.5 to 100 m: the mean keeps still, and the noise of far bumps goes."""
    for far in some((0.5, 6, 20, 60, 100)):
        truth, points, filtered = (seen(kind, far, samples, blur, seed) for samples, blur, seed in (
            (512, 0.0, 2), (8, 0.0, 1), (8, 8**-0.5, 1)))
        noise, left = (((picture - truth) ** 2).mean() for picture in (points, filtered))
        print(f"{kind} {far} m: mean {filtered.mean() / truth.mean():.4f}, error {left / noise:.3f} of that of points")
        assert filtered.mean() == pytest.approx(truth.mean(), rel=0.03)
        assert left < (1.0001 if far < 1 else 0.3 if far > 15 else 0.85) * noise


@pytest.mark.parametrize("kind", SLOPE)
@pytest.mark.parametrize("alpha", some([0.2, 0.3]))
def test_the_highlight_of_a_wide_lobe(kind, alpha):
    """Light from where the eye is: tilted lobes are higher there than one that slopes widen as if they shifted it,
    2 to 5 %."""
    def wide(filtered):
        return metal(filtered, alpha)
    truth = seen(kind, 60, 512, 0.0, 2, wide, (0, 0, 1)).mean()
    filtered = np.mean([seen(kind, 60, 8, 8**-0.5, seed, wide, (0, 0, 1)).mean() for seed in range(4)])
    print(f"{kind} {alpha}: {filtered / truth:.4f}")
    assert filtered == pytest.approx(truth, rel=0.012)


def test_each_row_of_a_map_counts():
    """Bumps in every other row, which are no Gaussian field: the mean is 7 % off, whichever rows these are."""
    for first in (0, 1):
        rows = {"even": slice(first, None, 2), "light": (0, 0, 1)}
        truth = seen("round", 60, 512, 0.0, 2, **rows).mean()
        filtered = np.mean([seen("round", 60, 8, 8**-0.5, seed, **rows).mean() for seed in range(4)])
        assert filtered == pytest.approx(truth, rel=0.1)


def cosines(filtered):
    """Ashikhmin and Shirley's lobe, twice as narrow along v as along u."""
    ax, ay = 0.1, 0.05
    return bumped(filtered, material(fresnel="NONE", f0=(1, 1, 1), ax=ax, ay=ay, ex=2 / ax**2 - 2, ey=2 / ay**2 - 2))


@pytest.mark.parametrize("light", some([(0, 0, 1), (0.1, 0.3, 0.9), (0.1, 0.6, 0.8)]))
def test_beside_the_highlight_of_a_power_of_the_cosine(light):
    """Eight samples from 12 to 100 m, where slopes are 0, 1 and 2.2 root mean squares: within 3 % of points."""
    for far in (12, 30, 100):
        truth = seen("brushed", far, 512, 0.0, 2, cosines, light).mean()
        filtered = np.mean([seen("brushed", far, 8, 8**-0.5, seed, cosines, light).mean() for seed in range(6)])
        print(f"{light} {far} m: {filtered / truth:.4f}")
        assert filtered == pytest.approx(truth, rel=0.03)


def test_many_samples_see_points():
    """The less each stands for, the less is filtered."""
    points, filtered = (seen("round", 6, 256, blur) for blur in (0.0, 1 / 16))
    np.testing.assert_allclose(filtered, points, rtol=2e-6)


@pytest.mark.parametrize("lobe", [metal, cosines])
def test_footprints_finer_than_a_texel_are_points(lobe):
    """To the pixel, as long as they are below the square root of three texels; wider ones are filtered."""
    texel, pixel = 2.0 / TEXELS, 2 * 0.25 / 32  # metres, on a plate a metre away
    points = seen("brushed", 1.0, 4, 0.0, 1, lobe)
    for texels in (0.1, 1.7, 1.8, 16):
        found = seen("brushed", 1.0, 4, texels * texel / pixel, 1, lobe)
        assert np.array_equal(found, points) == (texels < 3**0.5)
    assert abs(found - points).max() > 0.1 * points.max()


@pytest.mark.parametrize("mdf, brdf", [("BECKMANN", "MICROFACET"), ("ASHIKHMIN_SHIRLEY", "ASHIKHMIN_SHIRLEY")])
def test_what_a_lobe_reflects_of_an_even_sky(mdf, brdf, tmp_path):
    """By its table, and by rays, seen at 53 degrees."""
    alpha, out = 0.4, registers(3, 3)
    exponent = 2 / alpha**2 - 2
    lobe = material(mdf=mdf, brdf=brdf, fresnel="NONE", f0=(1, 1, 1), ax=alpha, ay=alpha, ex=exponent, ey=exponent)
    said = {"nodes": [{"type": "ALBEDO", "lobe": mdf, "alpha": [alpha], "out": out}], "f0_from": out[:1] * 3}
    around = {"lights": [], "camera": ortho(half=0.1, eye=(0.8, 0, 0.6)), "background": (1, 1, 1), "max_bounces": 1}
    planes, _ = dump(scene(materials=[lobe | said], **around), tmp_path / "d.exr")
    found = render(scene(materials=[lobe], samples=1024, width=16, height=16, **around))[0][..., :3].mean()
    assert found < 0.97
    np.testing.assert_allclose(vectors(planes, "Color", "RGB").mean(), found, rtol=0.01)


def test_malformed_blur():
    with pytest.raises(ValueError, match="normal_blur"):
        native.start(scene(normal_blur=-1.0))
