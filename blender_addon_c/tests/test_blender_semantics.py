# SPDX-License-Identifier: GPL-3.0-or-later
"""What each setting of Blender means: through the dump and the picture, against values worked
out by hand. The scene is one plane of one metal under one sun straight above (scenes.py: plain)."""

import json
import math

import numpy as np
import OpenImageIO as oiio
import pytest

from blender_runs import Dump, measured, rgba

COST = 13

METAL = {"ex": 6, "ey": 2, "f0": (0.9, 0.6, 0.3)}
OTHER = {"ex": 1, "ey": 7, "f0": (0.2, 0.4, 0.8)}
UP = (0, 0, 1)
GGX = {"mdf": "ggx", "brdf": "microfacet"}


def of_roughness(roughness, f0):
    """A metal of Blender's roughness: alpha is its square, the exponents 2 / alpha² − 2."""
    alpha = roughness**2
    return {"ax": alpha, "ay": alpha, "ex": 2 / alpha**2 - 2, "ey": 2 / alpha**2 - 2, "f0": f0}


def brightness(metal, irradiance):
    """S where light, eye and normal are one: D's peak over 4, and the body's part."""
    if metal.get("mdf") == "ggx":
        peak = 1 / (math.pi * metal["ax"] * metal["ay"])
    else:
        peak = math.sqrt((metal["ex"] + 1) * (metal["ey"] + 1)) / (2 * math.pi)
    return (np.multiply(metal["f0"], peak / 4) + np.divide(metal.get("kd", 0), math.pi)) * irradiance


def header(path):
    return json.loads(oiio.ImageBuf(str(path)).spec().getattribute("libshade"))


def cycles_normal(n, strength):
    """The Normal Map node: x and y times the strength, z mixed towards 1 by at most 1."""
    n = np.array([n[0] * strength, n[1] * strength, 1 + min(strength, 1) * (n[2] - 1)])
    return n / np.linalg.norm(n)


def linear(srgb):
    """IEC 61966-2-1, above its linear part."""
    return tuple(((c + 0.055) / 1.055) ** 2.4 for c in srgb)


TILT = (0.48, 0.36, 0.8)
# change: what the sun's energy of 3 is multiplied by, the metal, its normal, uv of (u, v)
CASES = {
    "plain_light": {},
    "light_color": {"factor": (0.8, 0.5, 0.2)},
    "temperature": {"factor": (0.8, 0.5, 0.2)},
    "exposure": {"factor": 2**-1.5},
    "emission": {"factor": np.multiply((0.5, 0.25, 1), 1.75)},
    "unused_emission": {},
    "color_rgb": {"metal": {**METAL, "f0": (0.2, 0.5, 0.7)}},
    "color_tex_image": {"metal": {**METAL, "f0": linear((1, 230 / 255, 0.8))}},
    "override": {"metal": OTHER},
    "diffuse": {"metal": {"ex": 200, "ey": 10, "f0": (0, 0, 0), "kd": (0.7, 0.5, 0.2)}},
    "glossy": {"metal": {**of_roughness(0.6, (0.7, 0.5, 0.2)), **GGX, "fresnel": "none"}},
    "no_material": {"metal": {"f0": (0, 0, 0), "kd": (0.8, 0.8, 0.8), "ex": 200, "ey": 10}},
    "strength": {"normal": cycles_normal(TILT, 2), "normal 3.4": np.array((0.96, 0.72, 0.6)) / np.sqrt(1.8)},
    "value": {"normal": cycles_normal(TILT, 0.25)},
    "slot_clamp": {"metal": OTHER},
    "uv_active": {"uv": lambda u, v: (u / 2, v / 2)},
    "edited": {"uv": lambda u, v: (u / 2, v / 2), "metal": {**METAL, "f0": linear((1, 230 / 255, 0.8))}},
    "uv_node": {"uv": lambda u, v: (v, 1 - u), "metal": {**METAL, "f0": (0, 0, 0)}},
    "uv_normal_map": {"uv": lambda u, v: (u, v), "normal": TILT},
}


TEXTURED = {"uv_node", "edited", *(case for case in CASES if case.startswith("color_tex_"))}


@pytest.mark.parametrize("change", CASES)
def test_plain(blender, tmp_path, change):
    newer = change in ("temperature", "exposure")  # of lights: from 4.5 on
    if change == "unused_emission" and blender.version > "5.1":
        pytest.skip("lamps always use their nodes there")
    if newer and blender.version < "4.5":
        pytest.skip("Blender 3.4 has no such setting")
    if change == "no_material" and blender.version > "4":
        pytest.skip("no one metal: a Principled BSDF, as in Cycles (test_smooth_cubes)")
    told, text = blender.scene("plain", tmp_path, change=change)
    case, dump = CASES[change], Dump(tmp_path / "dump.exr")
    irradiance = 3 * np.multiply(case.get("factor", 1), np.ones(3))
    if change == "temperature":
        red, green, blue = told["factor"]  # Blender's own: warm white
        assert red > 1.5 * green > 3 * blue > 0
        irradiance *= told["factor"]
    metal = case.get("metal", METAL)
    assert dump.hit.all()
    np.testing.assert_allclose(dump["light0.E"], np.broadcast_to(irradiance, (16, 16, 3)), rtol=1e-6)
    np.testing.assert_allclose(dump["light0.L"], np.broadcast_to(UP, (16, 16, 3)), atol=1e-6)
    normal = case.get(f"normal {measured(blender.version)}", case.get("normal", UP))
    np.testing.assert_allclose(dump["Ns"], np.broadcast_to(normal, (16, 16, 3)), atol=4e-5)
    u, v = np.moveaxis((dump["P"][..., :2].astype(float) + 1) / 2, -1, 0)
    uv = np.stack(case.get("uv", lambda u, v: (u, v))(u, v), -1)
    np.testing.assert_allclose(dump["uv"], uv, atol=1e-5)
    used = {int(i) for i in np.unique(dump["material"])}
    (material,) = (m for m in header(tmp_path / "dump.exr")["materials"] if m["id"] in used)
    for key, value in metal.items():
        if key == "f0":  # per pixel where there is a texture
            textured = change in TEXTURED
            found = dump["Color"][0, 0] if textured else material[key]
            half_step = 0.5 / 65535  # a texture's colour has 16 bits
            np.testing.assert_allclose(found, value, rtol=1e-6, atol=half_step if textured else 1e-9)
        elif isinstance(value, str):
            assert material[key] == value
        else:
            assert material[key] == pytest.approx(value, rel=1e-6), key
    if change not in ("strength", "value", "uv_normal_map"):  # detail NONE: as bright, in fact
        expected = brightness(metal, irradiance)
        np.testing.assert_allclose(rgba(tmp_path / "picture.exr"),
                                   np.broadcast_to([*expected, 1], (16, 16, 4)), rtol=2e-5)


def look_up(texels, uv, extension, interpolation):
    """A texel's centre lies at half-integers; beyond the edge as `extension` says."""
    height, width = texels.shape[:2]

    def texel(x, y):
        if extension == "REPEAT":
            return texels[y % height, x % width]
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        value = texels[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)]
        return value * inside[..., None] if extension == "CLIP" else value

    x, y = uv[..., 0] * width, uv[..., 1] * height
    if interpolation == "Closest":
        return texel(np.floor(x).astype(int), np.floor(y).astype(int))
    x, y = x - 0.5, y - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = (x - i)[..., None], (y - j)[..., None]
    return ((texel(i, j) * (1 - s) + texel(i + 1, j) * s) * (1 - t)
            + (texel(i, j + 1) * (1 - s) + texel(i + 1, j + 1) * s) * t)


def test_one_image_in_many_ways(blender, tmp_path):
    """Extension and interpolation are the node's, not the image's."""
    texels = np.random.default_rng(11).random((2, 3, 3)).astype(np.float32).astype(float)
    ways = [(e, i) for i in ("Linear", "Closest") for e in ("REPEAT", "EXTEND", "CLIP")]
    blender.scene("wraps", tmp_path, ways=ways, pixels=texels.tolist())
    dump = Dump(tmp_path / "dump.exr")
    assert dump.hit.all()
    for strip, way in enumerate(ways):
        inside = np.s_[:, 32 * strip + 1:32 * strip + 31]
        uv = dump["uv"][inside].astype(float)
        assert uv.min() < -0.9 and uv.max() > 1.9
        near_step = np.abs(uv * [3, 2] - np.round(uv * [3, 2])).min(-1) < 1e-3
        sure = np.ones_like(near_step) if way[1] == "Linear" else ~near_step
        found, wanted = dump["Color"][inside], look_up(texels, uv, *way)
        assert np.abs(found - wanted)[sure].max() < 5e-5, way


def test_seed(blender, tmp_path):
    """The same seed, the same picture; another one, another noise about the same coverage."""
    pictures = []
    for seed in (3, 3, 4):
        blender.scene("edges", tmp_path, seed=seed, dump="")
        pictures.append(rgba(tmp_path / "picture.exr")[..., 3])
    assert np.array_equal(pictures[0], pictures[1])
    apart = np.count_nonzero(pictures[0] != pictures[2])
    assert 10 < apart < 24 * 24 / 2
    for picture in pictures:
        assert picture.mean() == pytest.approx(1.2**2 / 4, abs=0.01)


@pytest.mark.parametrize("kind, width", [("BLACKMAN_HARRIS", 1.5), ("GAUSSIAN", 1.5), ("BLACKMAN_HARRIS", 3.0),
                                         ("BOX", 1.0)])
def test_pixel_filter_is_that_of_cycles(blender, tmp_path, kind, width):
    """Both blur the plane's edges alike; half the width is ten times as far from that, or more."""
    def coverage(engine, part=1.0):
        blender.scene("edges", tmp_path, filter=(kind, part * width), engine=engine, samples=1024, dump="")
        return rgba(tmp_path / "picture.exr")[..., 3]

    truth = coverage("CYCLES")
    apart = np.abs(coverage("LIBSHADE") - truth).mean()
    assert apart < 0.002
    assert kind == "BOX" or np.abs(coverage("LIBSHADE", 0.5) - truth).mean() > max(10 * apart, 0.01)


def disc_part(d, r):
    """Part of a disc of radius r beyond a line at the signed distance d from its centre."""
    t = np.clip(d / r, -1, 1)
    return (np.arccos(t) - t * np.sqrt(1 - t * t)) / np.pi


@pytest.mark.parametrize("kind, size", [("SUN", 0.6), ("SUN", 0.2), ("POINT", 1.0), ("POINT", 0.4)])
def test_size_of_a_light(blender, tmp_path, kind, size):
    """A sun's angle is the whole one that it is seen under, a lamp's size its radius. The roof's
    edge at x = 0, height 1, hides part of its disc."""
    seen = []
    for shadow in (True, False):
        blender.scene("penumbra", tmp_path, kind=kind, size=size, shadow=shadow, dump="")
        seen.append(rgba(tmp_path / "picture.exr")[..., 0].mean(0))
    x = (np.arange(32) + 0.5) / 32 - 0.5
    # in the light's plane: 1 above for a disc of radius tan(angle / 2), 4 above for the lamp
    expected = disc_part(-x, math.tan(size / 2)) if kind == "SUN" else disc_part(-3 * x, size)
    np.testing.assert_allclose(seen[0] / seen[1], expected, atol=0.025)


@pytest.mark.parametrize("perspective, clip, planes, shown", [
    # as much behind the viewpoint as before it
    (False, (0.5, 10), [(-0.75, 9.5), (-0.25, -9.5), (0.25, 10.5), (0.75, -10.5), (0, 0.2)],
     [1, 1, 0, 0, 1]),
    # by the distance along the view, not along the ray: 1.25 times as long at the side
    (True, (0.5, 10), [(-0.75, 0.45), (-0.25, 0.55), (0.25, 10.5), (0.75, 9.5), (0, -1)],
     [0, 1, 0, 1, 0]),
], ids=["orthographic", "perspective"])
def test_clip_of_the_viewport(blender, tmp_path, perspective, clip, planes, shown):
    told, _ = blender.scene("viewport", tmp_path, dump="", perspective=perspective, clip=clip,
                            planes=planes)
    assert told["said"] == "" and told["alpha"] == pytest.approx(shown)


@pytest.mark.parametrize("bent", [False, True])
def test_images_far_away_are_averages(blender, tmp_path, bent):
    """As Cycles has them by many points; by few points nearer to it where nodes let the mean through."""
    def picture(engine, samples, **options):
        blender.scene("minified", tmp_path, engine=engine, samples=samples, bent=bent, dump="", **options)
        return rgba(tmp_path / "picture.exr")[4:-4, 4:-4, :3].astype(float)

    truth = picture("CYCLES", 256)
    assert picture("LIBSHADE", 256).mean() == pytest.approx(truth.mean(), rel=0.003)
    averaged, points = (np.abs(picture("LIBSHADE", 4, **blur) - truth).mean() for blur in ({}, {"blur": 0.0}))
    assert averaged == points if bent else averaged < 0.75 * points
