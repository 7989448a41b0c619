# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that samples of lights and drawn rays share: against quadratures, for surfaces that leave it
to the one or to the other."""

import functools

import numpy as np
import pytest

from native_scenes import (
    area, ashikhmin_shirley, box, chance, few, image, material, mesh, native, ortho, persp, point, render, scene, sky, sphere,
    spot, square, sun)

COST = 4.2

EYE = (0.6, 0, 0.8)  # seen from there, the plate's middle looks at the light


def matt(kd=0.5):
    return material(f0=(0, 0, 0), fresnel="NONE", kd=(kd,) * 3)


def picture(**changes):
    return render(scene(**changes))[0][..., :3].astype(float)


CELLS = 512


@functools.cache
def half_sphere():
    z, phi = np.meshgrid((np.arange(CELLS) + 0.5) / CELLS,
                         (np.arange(2 * CELLS) + 0.5) * np.pi / CELLS, indexing="ij")
    r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], -1)


@functools.cache  # of three surfaces, for forty lights
def towards_eye(kd, ex, ey, f0):
    wi = half_sphere()
    if kd[0]:
        return np.broadcast_to(kd, wi.shape) / np.pi * wi[..., 2:]
    return ashikhmin_shirley(np.broadcast_to((0, 0, 1), wi.shape), wi, np.broadcast_to(EYE, wi.shape), ex, ey, f0)


def reflected(surface, radiance):
    """Light from all of the half sphere, z up, that leaves towards EYE: the midpoint rule."""
    f_cos = towards_eye(*(surface[name] for name in ("kd", "ex", "ey", "f0")))
    return (f_cos * radiance(half_sphere())).mean((0, 1)) * 2 * np.pi


# metal that all but mirrors, metal that spreads, a matt body
SURFACES = {"sharp": material(ex=3000.0, ey=900.0), "wide": material(ex=20.0, ey=5.0), "matt": matt()}


def ray_meets(kind, d, p=(0, 0, 0)):
    """Radiance that a ray from p meets of the lights below."""
    with np.errstate(divide="ignore", invalid="ignore"):
        if kind == "area":  # at z = 1.5, from x = -1.9 to -0.4
            q = d * (1.5 / d[..., 2:])
            inside = (np.abs(q[..., 0] + 1.15) < 0.75) & (np.abs(q[..., 1]) < 0.5)
            return (inside * 2 / (1.5 * 1.0))[..., None]
        if kind == "sun":
            angle = np.arccos(np.clip(d @ (-0.6, 0, 0.8), -1, 1))
            return ((angle < 0.2) * 3 / (np.pi * np.sin(0.2) ** 2))[..., None]
        c = np.array((-1.2, 0, 1.6))  # a ball of radius 0.5
        off2 = (c**2).sum() - (d @ c) ** 2
        return (((off2 < 0.25) & (d @ c > 0)) * 2 / (np.pi * 0.25))[..., None]


LIGHTS = {
    "area": area((-1.15, 0, 1.5), (1.5, 1.0), (2, 2, 2)),
    "sun": sun((-0.6, 0, 0.8), (3, 3, 3), angle=0.4) | {"even": True},
    "ball": point((-1.2, 0, 1.6), (2, 2, 2), 0.5) | {"ball": True},
}


def of_plate(surface, lights, **changes):
    return picture(**{"materials": [surface], "lights": lights, "width": 8, "height": 8, "samples": few(1024),
                      "camera": ortho(half=1e-3, eye=EYE)} | changes).mean((0, 1))


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("kind", LIGHTS)
def test_soft_light_on_metal(kind, surface):
    """Seen as a mirror image by the sharp metal, which samples of the light would hardly find."""
    truth = reflected(SURFACES[surface], lambda d: ray_meets(kind, d))
    assert truth.min() > 0.01
    np.testing.assert_allclose(of_plate(SURFACES[surface], [LIGHTS[kind]]), truth, rtol=chance(0.01))


@pytest.mark.parametrize("surface", ["sharp", "matt"])
@pytest.mark.parametrize("ball, gain", [(True, 1), (True, 2), (False, 1)])
def test_a_bulb_whose_light_falls_off_otherwise(surface, ball, gain):
    """By the distance to where its ball, or its disc, is met: samples of it and drawn rays agree on that."""
    even = {"width": 1, "height": 1, "axes": np.eye(3).ravel().tolist(), "data": np.ones(3, np.float32), "gain": gain}

    def radiance(d):
        c = np.array((-1.2, 0, 1.6))
        along = d @ c
        off2 = 4 - along**2 if ball else 4 * (4 / np.maximum(along, 1e-9)**2 - 1)  # squares of how far from the middle it is met
        far = along - np.sqrt(np.maximum(0.25 - off2, 0)) if ball else 4 / np.maximum(along, 1e-9)
        return (((off2 < 0.25) & (along > 0)) * 2 / (np.pi * 0.25) * far**gain)[..., None]
    lamp = LIGHTS["ball"] | {"ball": ball, "pattern": even}
    np.testing.assert_allclose(of_plate(SURFACES[surface], [lamp]), reflected(SURFACES[surface], radiance), rtol=chance(0.01))


@pytest.mark.parametrize("surface", SURFACES)
def test_two_lamps_are_the_sum_of_each(surface):
    """The first hit takes both, later ones choose: what a path chose is no chance of the next path's lamps."""
    wall = square(1.0, 0.0, 1)
    wall["positions"] = np.ascontiguousarray(wall["positions"][:, [2, 0, 1]] * (0, 3, 3) - (4, 0, 0), np.float32)  # faces +x
    wall["corner_normals"] = np.ascontiguousarray(wall["corner_normals"][:, [2, 0, 1]])
    given = {"meshes": [square(), wall], "materials": [SURFACES[surface], matt()], "samples": few(4096)}
    lamps = [LIGHTS["area"], LIGHTS["ball"] | {"position": (1.0, 0.5, 1.2)}]
    each = [of_plate(SURFACES[surface], [lamp], **given, max_bounces=2) for lamp in lamps]
    both = of_plate(SURFACES[surface], lamps, **given, max_bounces=2)
    np.testing.assert_allclose(both, sum(each), rtol=chance(0.002))


@pytest.mark.parametrize("size", [0.1, 20.0])
def test_what_gathers_light_is_as_large_as_its_object(size):
    """Draws that are aimed at a mirror's ball are the same, whether its mesh is so large or its matrix."""
    pictures = []
    for radius, scale in ((3.0, 1.0), (3.0 / size, size)):
        mirror = sphere(12, radius)
        place = np.diag([scale, scale, scale, 1.0])
        place[:3, 3] = -6.4, 0.8, 8.0
        instances = [{"mesh": k, "matrix": matrix.ravel().tolist()} for k, matrix in enumerate((np.eye(4), place))]
        pictures.append(picture(meshes=[square(), mirror | {"material": mirror["material"] + 1}], instances=instances,
                                materials=[matt(), material(fresnel="NONE", f0=(1, 1, 1), ex=3000.0, ey=3000.0)],
                                lights=[LIGHTS["area"]], max_bounces=2, camera=ortho(half=0.5, eye=EYE), samples=4))
    assert (np.isclose(*pictures, rtol=1e-3).all(-1)).mean() > 0.97


@pytest.mark.parametrize("kind", ["metal", "glass", "weighed by a node"])
@pytest.mark.parametrize("placed", [False, True])
def test_what_gathers_light_is_aimed_at(kind, placed):
    """A small ball far above a plate mirrors a bright floor with its lower half. One of 400 draws would meet it by chance, and a pixel's
    noise would be 1.8 times the mean."""
    mirror = material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=1e-3, ay=1e-3)
    if kind == "glass":
        pane = {"closure": "GLASS", "ior": [1.5], "alpha": [1e-4], "tint": (1, 1, 1), "reflects": True, "refracts": False, "joint": True}
        mirror = {"name": "", "nodes": [], "closures": [pane]}
    if kind == "weighed by a node":
        node = {"type": "MATH", "operation": "ADD", "a": [1.0], "b": [0.0], "c": [0.0], "out": [(9,)]}
        lobe = {key: value for key, value in mirror.items() if key not in ("name", "nodes")}
        mirror = {"name": "", "nodes": [node], "closures": [lobe | {"weight": [(9,)] * 3}]}
    ball = sphere(24, 0.05 if placed else 0.5, (0, 0, 0) if placed else (0, 0, 10))
    place = np.diag([10.0, 10, 10, 1]) if placed else np.eye(4)
    place[2, 3] = 10.0 if placed else 0.0
    instances = [{"mesh": k, "matrix": matrix.ravel().tolist()} for k, matrix in enumerate((np.eye(4), place, np.eye(4)))]
    meshes = [square(0.2), ball | {"material": ball["material"] + 1}, square(500.0, -1.0, 2)]
    seen = picture(meshes=meshes, instances=instances, materials=[matt(1.0), mirror, shining(1.0)], lights=[], camera=ortho(0.1),
                   width=16, height=16, samples=256, max_bounces=2)[..., 0]
    assert seen.std() < 1.1 * seen.mean() and seen.mean() == pytest.approx(0.5 * 0.05**2, rel=0.2)


def test_a_lamp_before_what_gathers_light():
    """Draws of the plate are aimed at a mirror far behind the lamp, which covers a part of it: samples of the lamp
    and they share its light still. It shines downwards, so that the mirror is dark."""
    mirror = sphere(12, 3.0, (-6.4, 0.8, 8.0))
    truth = reflected(SURFACES["matt"], lambda d: ray_meets("area", d))
    seen = of_plate(SURFACES["matt"], [LIGHTS["area"]], meshes=[square(), mirror | {"material": mirror["material"] + 1}],
                    materials=[SURFACES["matt"], material(fresnel="NONE", f0=(0.3, 0.3, 0.3), ex=30.0, ey=30.0)],
                    max_bounces=1, samples=256)
    np.testing.assert_allclose(seen, truth, rtol=0.004)


@pytest.mark.parametrize("surface", SURFACES)
def test_a_choice_of_lights_and_a_sky(surface):
    """One of three lights or the sky a sample: the sum of all."""
    pixels = np.full((8, 16, 3), 0.2, np.float32)
    pixels[6, 8:12] = (6, 3, 1)
    truth = reflected(SURFACES[surface], lambda d: sum(ray_meets(kind, d) for kind in LIGHTS)
                      + sky_of(pixels, d))
    seen = of_plate(SURFACES[surface], list(LIGHTS.values()), images=[image(pixels, filter="CLOSEST")],
                    sky=sky(), samples=few(2048))
    np.testing.assert_allclose(seen, truth, rtol=chance(0.01))


def sky_of(pixels, d):
    """Closest texel of an image of the sky by longitude and latitude, seen from inside."""
    height, width = pixels.shape[:2]
    x = (0.5 - np.arctan2(d[..., 1], d[..., 0]) / (2 * np.pi)) % 1
    y = 1 - np.arccos(np.clip(d[..., 2], -1, 1)) / np.pi
    return pixels[np.minimum((y * height).astype(int), height - 1), (x * width).astype(int) % width]


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("bounces", [0, 3])
def test_sky_on_a_plate(surface, bounces):
    """An image with a lamp in it, turned by a matrix; it is a light, and needs no bounce."""
    rng = np.random.default_rng(1)
    pixels = rng.random((16, 32, 3)).astype(np.float32)
    pixels[12, 7] = (80, 60, 40)
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])
    truth = reflected(SURFACES[surface], lambda d: sky_of(pixels, d @ turn.T) * (1, 2, 0.5))
    seen = of_plate(SURFACES[surface], [], images=[image(pixels, filter="CLOSEST")], max_bounces=bounces,
                    sky=sky((1, 2, 0.5), np.c_[turn, np.zeros(3)]), samples=few(2048))
    np.testing.assert_allclose(seen, truth, rtol=chance(0.015))


@pytest.mark.parametrize("hidden", [False, True])
@pytest.mark.parametrize("faces", [False, True])
def test_the_camera_sees_the_sky(hidden, faces):
    rng = np.random.default_rng(2)
    pixels = rng.random((16, 32, 3)).astype(np.float32)
    around = {"images": [image(pixels, filter="CLOSEST")], "sky": sky(), "sky_hidden": int(hidden), "lights": [],
              "camera": persp(0.5, (0, 0, 0), (0.3, 1, 0.2)), "width": 24, "height": 24, "samples": 1,
              "meshes": [square(9, -50)] if faces else []}
    seen, _ = render(scene(**around, transparent=False))
    half = (np.arange(24) + 0.5) / 24 - 0.5
    matrix = np.reshape(around["camera"]["matrix"], (4, 4))[:3, :3]
    d = np.stack([*np.meshgrid(half, half), np.full((24, 24), -1.0)], -1) @ matrix.T
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    truth = sky_of(pixels, d) * (not hidden)
    agree = np.isclose(seen[..., :3], truth, atol=1e-6).all(-1)  # samples lie in their pixel somewhere
    assert agree.mean() > 0.6 and (hidden or truth.std() > 0.1)
    assert (seen[..., 3] == 1).all()
    clear, _ = render(scene(**around, transparent=True))
    assert not clear[12:].any()


def test_a_closed_box_keeps_a_strong_sky_out():
    pixels = np.full((8, 16, 3), 1e6, np.float32)
    pixels[6, 3] = 1e9
    seen = picture(lights=[], images=[image(pixels)], sky=sky(), meshes=[box((-1, -1, -1), (1, 1, 1))],
                   materials=[matt(0.9)], camera=persp(eye=(0.1, 0.2, 0.3), target=(1, 1, 1)),
                   max_bounces=16, samples=64)
    assert (seen == 0).all()


def test_a_wall_stops_what_a_ray_would_meet():
    """A mirror under a light, with a plate between them; the light behind it gives nothing, unless it throws no shadows."""
    lid = mesh([[-9, -9, 1], [9, -9, 1], [9, 9, 1], [-9, 9, 1]], [[0, 1, 2], [0, 2, 3]])
    view = {"camera": ortho(half=1e-3, eye=(0.4, 0, 0.5)), "materials": [SURFACES["sharp"]],
            "lights": [area((-1, 0, 2), (3, 3), (9, 9, 9))], "samples": 256, "width": 8, "height": 8}
    assert picture(**view).mean() > 0.1
    assert (picture(**view, meshes=[square(), lid]) == 0).all()
    view["lights"] = [light | {"shadow": False} for light in view["lights"]]  # as if it were not there
    open_, shut = (picture(**view, meshes=meshes).mean((0, 1)) for meshes in ([square()], [square(), lid]))
    assert open_.mean() > 0.1
    np.testing.assert_allclose(shut, open_, rtol=1e-5)


@pytest.mark.parametrize("lights", [0, 1, 20])
def test_threads_change_no_bit(lights):
    pixels = np.full((8, 16, 3), 0.2, np.float32)
    pixels[6, 3] = 50
    some = [area((-1, 0, 2)), spot((1, 0, 2), radius=0.2), sun(angle=0.1), point((0, 1, 2), shadow=False)]
    settings = {"meshes": [square(), sphere(12, 0.4, (0, 0, 0.5))], "materials": [matt(0.6)],
                "images": [image(pixels)], "sky": sky(), "lights": (some * 5)[:lights], "max_bounces": 6,
                "width": 40, "height": 30, "transparent": False}
    assert (picture(**settings, threads=1) == picture(**settings, threads=2)).all()


@pytest.mark.parametrize("wrong, words", [
    ({"image": 1}, "image must be"), ({"matrix": [1] * 11}, "matrix must be"),
    ({"strength": (1, float("nan"), 1)}, "strength must be"), ({"projection": "FLAT"}, "projection must be one of"),
    ({"model": "HAZE"}, "model must be one of"), ({"model": "PREETHAM", "elevation": 2}, "elevation must be"),
    ({"model": "SINGLE", "elevation": 1, "altitude": -1}, "altitude must be")])
def test_malformed_sky(wrong, words):
    with pytest.raises(ValueError, match="sky.*" + words):
        native.start(scene(images=[image(np.ones((2, 4, 3), np.float32))], sky=sky() | wrong))


def shining(radiance):
    return {"name": "lamp", "nodes": [], "closures": [{"closure": "EMISSION", "weight": [radiance] * 3}]}


def panel(pieces=1):
    """The area light above, as faces that shine: in one mesh, or in instances of one that lies on its side, in the space of which
    rays meet it."""
    whole = mesh([[-1.9, -0.5, 1.5], [-0.4, -0.5, 1.5], [-0.4, 0.5, 1.5], [-1.9, 0.5, 1.5]],
                 [[0, 1, 2], [0, 2, 3]], materials=1)
    if pieces == 1:
        return {"meshes": [square(), whole]}
    turn = np.float32([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    places = [np.eye(4) for _ in range(pieces)]
    for k, place in enumerate(places):
        place[0, 0] = 1 / pieces
        place[0, 3] = -1.9 + (1.9 + 1.5 * k) / pieces
        place[:] = place @ turn
    aside = {**whole, **{key: np.ascontiguousarray(whole[key].reshape(-1, 3) @ turn[:3, :3]) for key in ("positions", "corner_normals")}}
    return {"apart": 1, "meshes": [square(), aside],
            "instances": [{"mesh": 0, "matrix": np.eye(4).ravel().tolist()},
                          *({"mesh": 1, "matrix": place.ravel().tolist()} for place in places)]}


# as one mesh and without a bounce what shines by several closures shows it too, below
@pytest.mark.parametrize("surface, pieces, bounces", [(surface, pieces, bounces) for surface in SURFACES for pieces in (1, 30) for bounces in (0, 2)
                                                      if (pieces, bounces) != (1, 0) or surface == "sharp"])
def test_faces_that_shine(surface, pieces, bounces):
    """A light like others: drawn from by samples, met by rays, without a bounce too."""
    truth = reflected(SURFACES[surface], lambda d: ray_meets("area", d))
    seen = of_plate(SURFACES[surface], [], **panel(pieces), materials=[SURFACES[surface], shining(2 / 1.5)],
                    max_bounces=bounces)
    np.testing.assert_allclose(seen, truth, rtol=chance(0.01))


@pytest.mark.parametrize("surface", ["wide", "matt"])
def test_what_shines_by_several_closures_and_lamps_that_are_mirrored(surface):
    """As bright as their sum is; to the same side as one that is not."""
    truth = reflected(SURFACES[surface], lambda d: ray_meets("area", d))
    several = {"name": "lamp", "nodes": [], "closures": [{"closure": "EMISSION", "weight": [part / 1.5] * 3} for part in (0.5, 1.25, 0.25)]}
    seen = of_plate(SURFACES[surface], [], **panel(), materials=[SURFACES[surface], several], max_bounces=0)
    np.testing.assert_allclose(seen, truth, rtol=chance(0.01))
    lamp = LIGHTS["area"]
    seen = of_plate(SURFACES[surface], [lamp | {"axis_v": tuple(-part for part in lamp["axis_v"])}])
    np.testing.assert_allclose(seen, truth, rtol=chance(0.01))


def test_faces_that_shine_beside_a_sun_and_a_sky():
    truth = reflected(SURFACES["wide"], lambda d: sum(ray_meets(kind, d) for kind in ("area", "sun")) + 0.2)
    seen = of_plate(SURFACES["wide"], [LIGHTS["sun"]], **panel(), samples=few(2048),
                    materials=[SURFACES["wide"], shining(2 / 1.5)],
                    images=[image(np.full((8, 16, 3), 0.2, np.float32))], sky=sky())
    # the panel hides the sky behind it
    hidden = reflected(SURFACES["wide"], lambda d: 0.2 * (ray_meets("area", d) > 0))
    both = reflected(SURFACES["wide"], lambda d: ray_meets("sun", d) * (ray_meets("area", d) > 0))
    np.testing.assert_allclose(seen, truth - hidden - both, rtol=chance(0.01))


def test_a_ball_that_shines_within_a_ball():
    """Of its thousand faces half are behind the others; what samples of those behind lose, and what
    ends just before those in front, is what its disc says."""
    walls, lamp = sphere(64, 2.0), sphere(32, 0.25)
    lamp["material"][:] = 1
    seen = picture(lights=[], meshes=[walls, lamp], materials=[matt(0.5), shining(3)], max_bounces=0,
                   camera=persp(0.5, (0, 0, 1.0), (0.2, 0.1, 3)), samples=few(256))
    np.testing.assert_allclose(seen.mean(), 0.5 * 3 * (0.25 / 2) ** 2, rtol=chance(4e-3))
