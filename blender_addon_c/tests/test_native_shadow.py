# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows: where geometry says, no acne, no leaks, penumbras of the right width."""

import numpy as np
import pytest

from native_scenes import (
    box,
    dump,
    material,
    mesh,
    ortho,
    persp,
    point,
    render,
    scene,
    sphere,
    square,
    sun,
    unit,
    vectors,
)


def lit(planes, light=0):
    return planes[f"light{light}.E.G"] > 0


def test_shadow_of_a_box_is_its_projection(tmp_path):
    low, high = np.array([-0.3, -0.2, 0.2]), np.array([0.1, 0.3, 0.6])
    light = unit(np.array([0.5, 0.3, 0.8]))
    for changes in ({"lights": [sun(light)]}, {"lights": [point(tuple(3 * light))]}):
        planes, _ = dump(
            scene(width=128, height=128, meshes=[square(), box(low, high)], **changes),
            tmp_path / "d.exr",
        )
        p, to_light = vectors(planes, "P"), vectors(planes, "light0.L")
        floor = p[..., 2] < 0.01

        def blocked(grow):
            with np.errstate(divide="ignore"):
                a, b = (low - grow - p) / to_light, (high + grow - p) / to_light
            return np.minimum(a, b).max(-1) <= np.maximum(a, b).min(-1)

        certain = floor & (blocked(1e-4) == blocked(-1e-4))
        assert certain.sum() > 0.99 * floor.sum()
        assert (lit(planes) == ~blocked(0))[certain].all()
        assert 0.02 < (~lit(planes))[certain].mean() < 0.3


def test_light_without_shadow_ignores_the_box(tmp_path):
    planes, _ = dump(
        scene(
            meshes=[square(), box((-0.5, -0.5, 1), (0.5, 0.5, 1.5))],
            camera=ortho(eye=(0, 0, 0.9)),
            lights=[sun(), sun(shadow=False)],
        ),
        tmp_path / "d.exr",
    )
    assert not lit(planes, 0)[8, 8] and lit(planes, 0)[0, 0] and lit(planes, 1).all()


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("offset", [0.0, 50.0])
def test_no_acne_and_no_leaks_at_any_scale(tmp_path, scale, offset):
    """A convex body shadows its own back, by facets; a lid above a plate lets nothing through."""
    shift = np.eye(4)
    shift[:3, :3] *= scale
    shift[:3, 3] = offset * scale
    center = np.full(3, offset * scale)
    ball = sphere(32, smooth=False)
    light = unit(np.array([0.6, 0.2, 0.5]))
    camera = ortho(
        1.1 * scale,
        center + np.array([1, -2, 1.5]) * 2 * scale,
        center,
        (1e-3 * scale, 100 * scale),
    )
    base = {
        "width": 128,
        "height": 128,
        "camera": camera,
        "lights": [sun(light)],
        "instances": [{"mesh": 0, "matrix": shift.ravel().tolist()}],
    }
    planes, _ = dump(scene(meshes=[ball], **base), tmp_path / "d.exr")
    hit = planes["material.ID"] == 0
    cosine = vectors(planes, "N") @ light  # a flat facet's own normal
    assert (lit(planes) == (cosine > 0))[hit & (np.abs(cosine) > 1e-3)].all()
    lid = mesh(
        np.concatenate([square()["positions"], square(2, 0.001)["positions"]]),
        [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
    )
    camera = ortho(0.9 * scale, center + (0, 0, 0.0005 * scale), center, (0, scale))
    planes, _ = dump(scene(meshes=[lid], **base | {"camera": camera}), tmp_path / "d.exr")
    assert (planes["material.ID"] == 0).all() and (planes["P.Z"] - center[2] < 5e-4 * scale).all()
    assert not lit(planes).any()


def test_smooth_body_keeps_light_up_to_the_facets_terminator(tmp_path):
    ball = sphere(48)
    light = unit(np.array([1, 0.2, 0.3]))
    planes, _ = dump(
        scene(
            width=128,
            height=128,
            meshes=[ball],
            camera=persp(0.4, (0.5, -3, 1)),
            lights=[sun(light)],
        ),
        tmp_path / "d.exr",
    )
    hit = planes["material.ID"] == 0
    cosine = vectors(planes, "N") @ light
    facet = np.pi / 48
    assert lit(planes)[hit & (cosine > 1.5 * facet)].all()
    assert not lit(planes)[hit & (cosine <= 0)].any()


def test_point_light_below_inside_and_on_the_surface(tmp_path):
    planes, _ = dump(
        scene(lights=[point((0, 0, -1)), point((0.0625, 0.0625, 0))]), tmp_path / "d.exr"
    )
    assert not lit(planes, 0).any()
    for name, plane in planes.items():
        assert np.isfinite(plane).all(), name
    inside, _ = dump(
        scene(meshes=[sphere(16)], camera=ortho(1.1), lights=[point((0, 0, 0))]), tmp_path / "d.exr"
    )
    assert not lit(inside).any()


def disc_part(d, r):
    """Part of a disc of radius r beyond a line at the signed distance d from its centre."""
    t = np.clip(d / r, -1, 1)
    return (np.arccos(t) - t * np.sqrt(1 - t * t)) / np.pi


@pytest.mark.parametrize("kind", ["sun", "point"])
def test_penumbra_of_an_edge(kind):
    """Half-plane x < 0 at height 1 over the floor: light goes with the visible part of the disc."""
    roof = mesh([[-9, -9, 1], [0, -9, 1], [0, 9, 1], [-9, 9, 1]], [[0, 1, 2], [0, 2, 3]])
    size = 32
    if kind == "sun":
        angle = 0.6
        lights = [sun(angle=angle)]
        radius, height = np.tan(angle / 2), 1.0
    else:
        lights = [point((0, 0, 4), (16, 16, 16), radius=1.0)]
        radius, height = 1.0, 4.0
    base = scene(
        width=size,
        height=4,
        samples=256,
        camera=ortho(0.5, (0, 0, 0.5)) | {"frame": (-0.5, 0.5, -0.05, 0.05)},
        materials=[material(ex=0.0, ey=0.0, fresnel="NONE", f0=(1, 1, 1))],
        lights=lights,
        meshes=[square(9), roof],
    )
    shadowed, _ = render(base)
    free, _ = render(base | {"lights": [lights[0] | {"shadow": False}]})
    seen = (shadowed[..., 0] / free[..., 0]).mean(0)
    x = (np.arange(size) + 0.5) / size - 0.5
    # the edge as seen from (x, 0), on the light's plane
    edge = -x if kind == "sun" else x + (0 - x) * height
    expected = disc_part(edge, radius)
    assert expected[0] < 0.1 and expected[-1] > 0.9
    np.testing.assert_allclose(seen, expected, atol=0.02)


def test_soft_light_of_no_size_is_sharp():
    base = {
        "meshes": [square(), box((-0.3, -0.3, 0.3), (0.3, 0.3, 0.5))],
        "width": 32,
        "height": 32,
    }
    sharp, _ = render(scene(lights=[sun((0.5, 0.2, 1))], **base))
    tiny, _ = render(scene(lights=[sun((0.5, 0.2, 1), angle=1e-5)], **base))
    np.testing.assert_allclose(tiny, sharp, atol=2e-2 * sharp.max())
