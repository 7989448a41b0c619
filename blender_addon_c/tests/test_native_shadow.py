# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows: where geometry says, no acne, no leaks, penumbras of the right width."""

import os
import subprocess
import sys
from pathlib import Path

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

COST = 2.8


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


def turned(description, turn):
    """The same scene in a world that is turned as a whole."""
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    camera = dict(description["camera"])
    camera["matrix"] = (matrix @ np.reshape(camera["matrix"], (4, 4))).ravel().tolist()
    lights = [
        light | {key: tuple(turn @ light[key]) for key in ("direction", "position") if key in light}
        for light in description["lights"]
    ]
    instances = [
        {"mesh": i["mesh"], "matrix": (matrix @ np.reshape(i["matrix"], (4, 4))).ravel().tolist()}
        for i in description["instances"]
    ]
    return description | {"camera": camera, "lights": lights, "instances": instances}


def rotation(axis, angle):
    """By Rodrigues' formula."""
    x, y, z = unit(np.array(axis, float))
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


# that the disc faces the point must not depend on where in the world it is
TURNS = {
    "as it is": np.eye(3),
    "head over": rotation((1, 0, 0), np.pi),
    "light along x": rotation((0, 1, 0), np.pi / 2),
    "light along -y": rotation((1, 0, 0), np.pi / 2),
    "askew": rotation((1, 2, 3), 1.0),
    "askew, down": rotation((2, -3, 0.5), 2.3),
}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize("kind", ["sun", "point"])
@pytest.mark.parametrize("edge_along", ["x", "y"])
def test_penumbra_of_an_edge(kind, turn, edge_along):
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
    if edge_along == "x":  # the other axis of the disc is cut
        base = turned(base, rotation((0, 0, 1), np.pi / 2))
    base = turned(base, turn)
    shadowed, _ = render(base)
    free, _ = render(base | {"lights": [base["lights"][0] | {"shadow": False}]})
    seen = (shadowed[..., 0] / free[..., 0]).mean(0)
    x = (np.arange(size) + 0.5) / size - 0.5
    # the edge as seen from (x, 0), on the light's plane
    edge = -x if kind == "sun" else x + (0 - x) * height
    expected = disc_part(edge, radius)
    assert expected[0] < 0.1 and expected[-1] > 0.9
    np.testing.assert_allclose(seen, expected, atol=0.02)


def test_two_of_the_same_light_are_one_of_twice_the_strength():
    half_roof = mesh([[-9, -9, 1], [0, -9, 1], [0, 9, 1], [-9, 9, 1]], [[0, 1, 2], [0, 2, 3]])
    base = {
        "camera": ortho(0.2, (0, 0, 0.5)),
        "meshes": [square(9), half_roof],
        "samples": 1024,
        "materials": [material(ex=0.0, ey=0.0, fresnel="NONE", f0=(1, 1, 1))],
    }

    def picture(*lights):
        return render(scene(lights=list(lights), **base))[0][..., 0].astype(float)

    one = picture(sun(angle=1.0, irradiance=(2, 2, 2)))
    two = picture(sun(angle=1.0), sun(angle=1.0))
    assert abs(two.mean() - one.mean()) < 2e-3 * one.mean()
    assert np.abs(two - one).max() < 0.1 * one.max()


def test_soft_lights_have_samples_of_their_own():
    """Two of the same light: as bright as one of twice the strength, but with less noise."""
    half_roof = mesh([[-9, -9, 1], [0, -9, 1], [0, 9, 1], [-9, 9, 1]], [[0, 1, 2], [0, 2, 3]])
    base = {
        "camera": ortho(0.2, (0, 0, 0.5)),
        "meshes": [square(9), half_roof],
        "samples": 4,
        "materials": [material(ex=0.0, ey=0.0, fresnel="NONE", f0=(1, 1, 1))],
    }

    def picture(*lights, **changes):
        return render(scene(lights=list(lights), **base | changes))[0][..., 0].astype(float)

    # no drawn ray meets them: their own samples alone
    light, double = ({**sun(angle=1.0, irradiance=(e, e, e)), "met": False} for e in (1, 2))
    truth = picture(double, samples=4096)
    one, two = picture(double) - truth, picture(light, light) - truth
    assert abs(two.mean()) < 0.02 * truth.mean()
    noise = [np.sqrt((error**2).mean()) for error in (one, two)]
    # independent: 0.71; the same samples: 1
    assert 0.01 * truth.mean() < noise[0] and 0.5 * noise[0] < noise[1] < 0.85 * noise[0]


@pytest.mark.parametrize("shadow", [True, False])
def test_light_behind_the_facet_is_no_light(tmp_path, shadow):
    """The smooth normal leans to the light, which is below the triangle itself: nothing lets it
    through, with shadow rays or without."""
    smooth = unit(np.array([0.8, 0, 0.6]))
    lights = [
        sun(direction, shadow=shadow) for direction in ((0.9, 0, -0.2), (0.9, 0, 0.2), (-0.9, 0, 0.2))
    ]
    sheet = mesh(square()["positions"], [[0, 1, 2], [0, 2, 3]], np.tile(smooth, (4, 1)))
    planes, _ = dump(scene(meshes=[sheet], lights=lights), tmp_path / "d.exr")
    np.testing.assert_allclose(vectors(planes, "N")[8, 8], smooth, atol=1e-6)
    assert not lit(planes, 0).any() and lit(planes, 1).all() and not lit(planes, 2).any()


@pytest.mark.parametrize("turn", [TURNS["as it is"], TURNS["askew"], TURNS["askew, down"]])
@pytest.mark.parametrize("reach", [10.0, 1e4])
@pytest.mark.parametrize("shared", [False, True])
def test_no_acne_on_a_large_triangle_close_by(tmp_path, reach, turn, shared):
    """Where it is hit is only as exact as its far corners are; of a mesh that is kept once as its instance's are."""
    for lights in ([sun((0.5, 0.2, 0.6))], [point((0.4, 0.3, 0.9))]):
        base = scene(
            width=64,
            height=64,
            camera=persp(0.5, (0.1, 0.2, 1.0), (0.3, 0.1, 0)),
            lights=lights,
            meshes=[mesh([[-reach, -reach, 0], [reach, -reach, 0], [0.3, reach, 0]], [[0, 1, 2]])],
        )
        if shared:  # askew in its own space
            askew, place = TURNS["askew"], np.eye(4)
            place[:3, :3] = reach * askew.T
            corners = np.array([[-1, -1, 0], [1, -1, 0], [0.3 / reach, 1, 0]]) @ askew.T
            base |= {"apart": 1, "meshes": [mesh(corners, [[0, 1, 2]])], "instances": [{"mesh": 0, "matrix": place.ravel().tolist()}]}
        planes, _ = dump(turned(base, turn), tmp_path / "d.exr")
        assert (planes["material.ID"] == 0).all() and lit(planes).all()


def test_soft_light_of_no_size_is_sharp():
    base = {
        "meshes": [square(), box((-0.3, -0.3, 0.3), (0.3, 0.3, 0.5))],
        "width": 32,
        "height": 32,
    }
    sharp, _ = render(scene(lights=[sun((0.5, 0.2, 1))], **base))
    tiny, _ = render(scene(lights=[sun((0.5, 0.2, 1), angle=1e-5)], **base))
    np.testing.assert_allclose(tiny, sharp, atol=2e-2 * sharp.max())


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("shared", [False, True])
def test_soft_terminator_of_few_faces(back, shared):
    """A smooth ball of few faces under a low sun is lit as the round one is; its faces' own shadow
    is far from that. Seen from within, where it does not bulge, nothing changes."""
    matt = material(fresnel="NONE", f0=(0, 0, 0), kd=(1, 1, 1))
    size = 0.8 if not back else 4.0
    turn = np.diag([size, size, size, 1.0])
    view = ortho() if not back else ortho(eye=(0, 0, 0.5))
    lights = [sun((1, 0, 0.3))] if not back else [point((0.5, 0.2, 0.2))]

    def ball(rings, **changes):
        copies = 100_000 // rings**2 if shared else 0  # so many that the mesh is kept once
        far = np.diag([1e-3, 1e-3, 1e-3, 1.0])
        far[:3, 3] = 50, 50, 0
        placed = [turn] + [far] * copies
        return render(scene(
            meshes=[sphere(rings)], materials=[matt], width=64, height=64, lights=lights, camera=view,
            instances=[{"mesh": 0, "matrix": m.ravel().tolist()} for m in placed], **changes))[0]

    few = [ball(10, soft_terminator=on)[..., 0] for on in (False, True)]
    if back:
        np.testing.assert_allclose(*few, atol=1e-6)
        assert few[0].mean() > 0.01
        return
    many = ball(96)[..., 0]
    inside = (ball(10)[..., 3] == 1) & (many > 0) & (many < 0.3 * many.max())
    hard, soft = (np.abs(f - many)[inside].mean() / many[inside].mean() for f in few)
    print(f"error {hard:.4f} hard, {soft:.4f} soft, {inside.mean():.3f} of the picture")
    assert soft < 0.4 * hard and soft < 0.03


ENDLESS = """
import sys
sys.path.insert(0, sys.argv[1])
import subprocess
import sys
from pathlib import Path

import numpy as np
from native_scenes import persp, point, area, render, scene, sphere, square, sun
from test_native_instances import matrices
rng = np.random.default_rng(0)
placed = matrices(9, "turned")
for m in placed:
    m[:3, :3] *= 3
    m[:3, 3] = rng.uniform(-0.7, 0.7, 3)
render(scene(width=40, height=40, samples=4, threads=1, meshes=[square(2, -0.8), sphere(60)],
             instances=[{"mesh": k > 0, "matrix": m.ravel().tolist()} for k, m in enumerate([np.eye(4), *placed])],
             lights=[sun((0.3, 0.2, 1)), point((0, 0, 2), radius=0.1), area((1, 0, 1.5))],
             camera=persp(eye=rng.uniform(-2, 2, 2).tolist() + [3])))
"""


def test_shadow_rays_between_instances_end():
    """Said to be coherent, Embree 3.13 followed some of these for ever."""
    subprocess.run([sys.executable, "-c", ENDLESS, str(Path(__file__).parent)], check=True, timeout=100)


LEFT_OVER = """
import sys
sys.path.insert(0, sys.argv[1])
from native_scenes import point, render, scene, sun
for lamps in [sun((0.3, 0.2, 1))], [sun(), point((0, 0, 2))], [point((0, 0, 2), radius=0.1)] * 5:
    picture, _ = render(scene(width=3, height=3, samples=1, lights=lamps))
    assert picture[1, 1, 0] > 0, lamps
"""


def test_what_memory_held_before_is_no_ray():
    """Nine rays are no whole packet; numbers without end beside them once ended the process, by an assertion of Embree's."""
    subprocess.run([sys.executable, "-c", LEFT_OVER, str(Path(__file__).parent)], check=True, timeout=100, env={**os.environ, "MALLOC_PERTURB_": "128"})
