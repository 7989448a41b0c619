# SPDX-License-Identifier: GPL-3.0-or-later
"""Every type of light that the module knows: what reaches a surface, and who reads it from Blender.

A type that has no entry here, or that export/light.py does not know, fails.
"""

import ast

import numpy as np
import pytest

from native_scenes import ROOT, area, dump, material, native, ortho, point, render, scene, spot, sun, unit, vectors

COST = 1.4

TYPES = native.table()["lights"]

def to(p):
    return np.array((0.4, -0.3, 1.5)) - p


def faded(t):
    t = t.clip(0, 1)
    return t * t * (3 - 2 * t)


# By type: a light, and its irradiance and direction at P, from its definition.
LIGHTS = {
    "SUN": (
        sun((0.3, 0.1, 0.9), (2, 1, 0.5)),
        lambda p: (np.broadcast_to((2, 1, 0.5), p.shape), np.broadcast_to((0.3, 0.1, 0.9), p.shape)),
    ),
    "POINT": (
        point((0.4, -0.3, 1.5), (3, 2, 1)),
        lambda p: (
            (3, 2, 1) / ((np.array((0.4, -0.3, 1.5)) - p) ** 2).sum(-1)[..., None],
            np.array((0.4, -0.3, 1.5)) - p,
        ),
    ),
    # cone of 60 degrees about an axis that leans, full up to half the cosine that is left
    "SPOT": (
        spot((0.4, -0.3, 1.5), (-0.3, 0.1, -1), (3, 2, 1), angle=np.pi / 3, blend=0.5),
        lambda p: (
            (3, 2, 1) / (to(p) ** 2).sum(-1)[..., None]
            * faded((unit(-to(p)) @ unit(np.array((-0.3, 0.1, -1))) - np.cos(np.pi / 6))
                    / (0.5 - 0.5 * np.cos(np.pi / 6)))[..., None],
            to(p),
        ),
    ),
    # as its middle gives it, with slats: half the cone's angle is 1
    "AREA": (
        area((0.4, -0.3, 1.5), (0.5, 0.5), (3, 2, 1), spread=2.0),
        lambda p: (
            (3, 2, 1) / (to(p) ** 2).sum(-1)[..., None] * unit(to(p))[..., 2:]
            * (np.tan(1) - np.hypot(*to(p)[..., :2].T).T / to(p)[..., 2])[..., None].clip(0)
            / (np.tan(1) - 1),
            to(p),
        ),
    ),
}


@pytest.mark.parametrize("kind", TYPES)
def test_what_reaches_a_plate(kind, tmp_path):
    assert kind in LIGHTS, f"{kind} is not tested: give it an entry in LIGHTS"
    light, truth = LIGHTS[kind]
    planes, _ = dump(scene(lights=[light]), tmp_path / "d.exr")
    irradiance, direction = truth(vectors(planes, "P"))
    np.testing.assert_allclose(vectors(planes, "light0.E", "RGB"), irradiance, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(vectors(planes, "light0.L"), unit(direction), atol=1e-6)


@pytest.mark.parametrize("kind, size", [("SUN", {"angle": 0.3}), ("POINT", {"radius": 0.5}), ("POINT", {"radius": 0.5, "ball": True}),
                                        ("SPOT", {"radius": 0.5}), ("SPOT", {"radius": 0.5, "ball": True})])
def test_a_dump_takes_a_soft_lamp_at_its_middle(kind, size, tmp_path):
    light, truth = LIGHTS[kind]
    planes, _ = dump(scene(lights=[light | size]), tmp_path / "d.exr")
    irradiance, direction = truth(vectors(planes, "P"))
    np.testing.assert_allclose(vectors(planes, "light0.E", "RGB"), irradiance, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(vectors(planes, "light0.L"), unit(direction), atol=1e-6)


@pytest.mark.parametrize("wide, high", [(1.0, 1.0), (2.0, 1.0), (1.0, 0.6), (1.5, 3.0)])
def test_a_spot_s_cone_is_wide_or_narrow(wide, high, tmp_path):
    """Across its axis lengths count so many times: a cone as narrow by that."""
    z, x = unit(np.array((-0.3, 0.1, -1))), unit(np.array((1, 0.5, -0.25)))
    y = np.cross(z, x)
    light = spot((0.4, -0.3, 1.5), z, (3, 2, 1), angle=np.pi / 3, blend=0.5) | {"across_u": wide * x, "across_v": high * y}
    light |= {key: tuple(light[key]) for key in ("across_u", "across_v", "direction")}
    planes, _ = dump(scene(lights=[light]), tmp_path / "d.exr")
    away = to(vectors(planes, "P"))
    cosine = unit(np.stack([wide * (-away @ x), high * (-away @ y), -away @ z], -1))[..., 2]
    part = faded((cosine - np.cos(np.pi / 6)) / (0.5 - 0.5 * np.cos(np.pi / 6)))
    np.testing.assert_allclose(vectors(planes, "light0.E", "RGB"), (3, 2, 1) / (away**2).sum(-1)[..., None] * part[..., None],
                               rtol=2e-5, atol=3e-6)


def patterned(light, part, axes=np.eye(3), rows=256):
    """A lamp whose light goes by part(direction in its own axes), three numbers."""
    v, h = ((np.arange(n) + 0.5) / n for n in (rows, 2 * rows))
    down, around = (v[:, None] - 0.5) * np.pi, (0.5 - h) * 2 * np.pi
    way = np.stack([np.cos(down) * np.cos(around), np.cos(down) * np.sin(around), np.sin(down) + 0 * around], -1)
    return light | {"pattern": {"width": 2 * rows, "height": rows, "axes": np.ravel(axes).tolist(),
                                "data": part(way).astype(np.float32).ravel()}}


def tilted(way):
    return np.stack([1 + 0.8 * way[..., 0], 1.5 + way[..., 1] * way[..., 2], np.exp(way[..., 2])], -1)


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA"])
def test_what_reaches_a_plate_by_direction(kind, tmp_path):
    light, truth = LIGHTS[kind]
    axes = np.array([(0.6, 0.8, 0), (-0.8, 0.6, 0), (0, 0, 1)]) @ np.array([(1, 0, 0), (0, 0.8, 0.6), (0, -0.6, 0.8)])
    planes, _ = dump(scene(lights=[patterned(light, tilted, axes)]), tmp_path / "d.exr")
    irradiance, direction = truth(vectors(planes, "P"))
    expected = irradiance * tilted(-unit(direction) @ axes.T)
    assert np.ptp(expected / np.maximum(irradiance, 1e-9)) > 0.1
    np.testing.assert_allclose(vectors(planes, "light0.E", "RGB"), expected, rtol=2e-3, atol=1e-6)


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA"])
@pytest.mark.parametrize("gain", [0, 1, 2])
def test_how_it_falls_off(kind, gain, tmp_path):
    light, truth = LIGHTS[kind]
    even = {"width": 1, "height": 1, "axes": np.eye(3).ravel().tolist(), "data": np.ones(3, np.float32)}
    planes, _ = dump(scene(lights=[light | {"pattern": even | {"gain": gain, "smooth": 0.7}}]), tmp_path / "d.exr")
    irradiance, direction = truth(vectors(planes, "P"))
    far = np.sqrt((direction**2).sum(-1, keepdims=True))
    np.testing.assert_allclose(vectors(planes, "light0.E", "RGB"), irradiance * far**gain * far**2 / (0.7 + far**2), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("more", [0, 8])
def test_a_face_that_shines_in_parts(more):
    """However lights are found: a lamp of which one half shines is a lamp of half the size."""
    places = (np.arange(128) + 0.5) / 128
    data = np.zeros((128, 128, 3), np.float32)
    data[:, places < 0.5] = (2, 1, 0.5)
    even = np.eye(3).ravel().tolist()
    halves = [area((0.1, 0.2, 1), (1.2, 0.8), (1, 1, 1)) | {"pattern": {
        "width": 128, "height": 128, "axes": even, "data": data.ravel(), "face": True}}]
    whole = [area((-0.2, 0.2, 1), (0.6, 0.8), (1, 0.5, 0.25))]
    rest = [point((0.1 * k, 0.2, 3), (0.01,) * 3) for k in range(more)]
    plain = {"samples": 1024, "max_bounces": 2, "background": (0, 0, 0), "filter_width": 0.01}
    parts, wanted = (render(scene(lights=lights + rest, **plain))[0][..., :3] for lights in (halves, whole))
    assert wanted.max() > 0.1
    np.testing.assert_allclose(parts.mean((0, 1)), wanted.mean((0, 1)), rtol=0.01)
    near = [p.reshape(4, p.shape[0] // 4, 4, p.shape[1] // 4, 3).mean((1, 3)) for p in (parts, wanted)]
    np.testing.assert_allclose(*near, rtol=0.06, atol=2e-3)


def test_a_face_ends_at_its_edges():
    """Of a picture of few texels, close to its lamp: beyond the middles of the outer ones it goes on as these are."""
    texels = np.zeros((1, 4, 3), np.float32)
    texels[0, :, 0], texels[0, :, 1] = (4, 0, 0, 0), (0, 0, 0, 1)
    finer = (np.arange(256) + 0.5) / 256 * 4 - 0.5  # the same picture, of 256 texels
    fine = np.stack([np.interp(finer, np.arange(4), texels[0, :, c]) for c in range(3)], -1).astype(np.float32)[None]
    seen = []
    for data in (texels, fine):
        lamp = area((0, 0, 0.1), (1.6, 1.6), (1, 1, 1)) | {"pattern": {
            "width": data.shape[1], "height": 1, "axes": np.eye(3).ravel().tolist(), "data": data.ravel(), "face": True}}
        seen.append(render(scene(lights=[lamp], samples=256, max_bounces=0, camera=ortho(0.8, eye=(0, 0, 0.09)),
                                 materials=[material(f0=(0, 0, 0), kd=(0.8,) * 3)]))[0][..., :2].mean(0))
    assert (seen[0][:2] > 4 * seen[0][-2:])[..., 0].all()
    np.testing.assert_allclose(seen[0], seen[1], rtol=0.02, atol=0.004 * seen[0].max())


@pytest.mark.parametrize("wrong", [{"face": True}, {"gain": 3}, {"smooth": -1.0}, {"smooth": float("nan")}])
def test_patterns_that_a_lamp_cannot_have(wrong):
    even = {"width": 1, "height": 1, "axes": np.eye(3).ravel().tolist(), "data": np.ones(3, np.float32)}
    with pytest.raises(ValueError, match=next(iter(wrong))):
        render(scene(lights=[point((0, 0, 1)) | {"pattern": even | wrong}]))


@pytest.mark.parametrize("radius", [0.0, 0.6])
@pytest.mark.parametrize("more", [0, 8])
def test_patterns_by_choice(radius, more):
    """However lights are found: as many lamps, each of which shines a part of all directions, as one that shines all."""
    def half(sign):
        return lambda way: np.repeat(0.5 + sign * 0.5 * way[..., :1], 3, -1)
    one = [point((0.1 * k, 0.2, 1), (0.4, 0.8, 0.2), radius) for k in range(1 + more)]
    two = [patterned(light, half(sign)) for light in one for sign in (1, -1)]
    plain = {"samples": 256, "max_bounces": 2, "background": (0, 0, 0), "filter_width": 0.01}
    whole, parts = (render(scene(lights=lights, **plain))[0][..., :3] for lights in (one, two))
    assert whole.max() > 0.1
    np.testing.assert_allclose(parts.mean((0, 1)), whole.mean((0, 1)), rtol=0.01)


def test_a_sun_has_no_pattern():
    with pytest.raises(ValueError, match="a sun shines one way"):
        render(scene(lights=[patterned(sun(), tilted)]))


@pytest.mark.parametrize("radius", [1e-38, 1e-20, 1e-13])
def test_a_tiny_lamp_is_a_sharp_one(radius):
    """Its square is no number to divide by."""
    given = [render(scene(lights=[point((0.3, 0.2, 1), radius=r)], background=(0.1, 0.1, 0.1)))[0]
             for r in (radius, 0.0)]
    np.testing.assert_allclose(given[0], given[1], rtol=1e-5)
    assert given[1][..., 0].max() > 0.1


def test_blender_hands_over_what_the_module_knows():
    tree = ast.parse((ROOT / "blender_addon_c/export/light.py").read_text())
    (table,) = (
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "_LIGHTS"
    )
    assert sorted(key.value for key in table.keys) == sorted(TYPES)


@pytest.mark.parametrize("round, size", [(False, (1.0, 1.0)), (True, (1.0, 1.0)), (True, (1.0, 0.4))])
def test_a_face_in_a_mirror(round, size):
    """Is as bright as what it gives by its area: that of a square, a disc or an ellipse."""
    eye, to = np.array((0.6, 0, 0.8)), np.array((-0.6, 0, 0.8))
    mirror = {**material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=1e-3, ay=1e-3)}
    lamp = area(tuple(2 * to), size, round=round, direction=tuple(-to)) | {"axis_u": (0.4 * size[0], 0, 0.3 * size[0])}
    picture = render(scene(lights=[lamp], materials=[mirror], camera=ortho(0.02, tuple(3 * eye)), samples=64, width=4, height=4, max_bounces=1))[0]
    assert picture[..., :3].mean() == pytest.approx(1 / (size[0] * size[1] * (np.pi / 4 if round else 1)), rel=0.01)


@pytest.mark.parametrize("ball, upright, share", [(True, True, 0.75), (True, False, 1.0), (False, True, 1.0)])
def test_a_ball_shines_by_its_normals_where_these_are_asked_for(ball, upright, share):
    """From so far all light goes downwards; normals within 60 degrees of that are those of a disc of 3/4 of the ball's."""
    def light_of(part):
        lamp = patterned(point((0, 0, 30.0), (900.0,) * 3, 0.3), part)
        lamp["pattern"] |= {"upright": True} if upright else {}
        plate = {"name": "matt", "nodes": [], "closures": [{"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0], "color": (1, 1, 1)}]}
        made = scene(width=8, height=8, samples=64, materials=[plate], lights=[lamp | {"ball": ball}], camera=ortho(0.05))
        return render(made)[0][..., 0].mean()
    whole = light_of(lambda way: np.ones(way.shape))
    assert whole > 0.01 and light_of(lambda way: np.repeat(1.0 * (way[..., 2:] < -0.5), 3, -1)) == pytest.approx(share * whole, rel=0.02)
