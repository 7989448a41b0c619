# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of several bounces, against what is known of plates under an even sky and of closed bodies."""

import math

import numpy as np
import pytest

from native_scenes import (
    ashikhmin_shirley, box, dump, image, material, native, ortho, persp, point, registers, render, scene, sky,
    sphere, square, sun, vectors)

COST = 0.95

SKY = (0.5, 1.0, 2.0)


def matt(kd, **changes):
    return material(f0=(0, 0, 0), fresnel="NONE", kd=(kd, kd, kd), **changes)


def picture(**changes):
    return render(scene(**changes))[0][..., :3].astype(float)


@pytest.mark.parametrize("bounces", [0, 1])
@pytest.mark.parametrize("light", [SKY, (0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.5)])
def test_a_matt_plate_under_an_even_sky(bounces, light):
    """Every direction is drawn by its share: each sample is the answer. The sky is a light: it needs
    no bounce."""
    seen = picture(lights=[], background=light, materials=[matt(0.5)], max_bounces=bounces)
    np.testing.assert_allclose(seen, np.broadcast_to(np.multiply(0.5, light), seen.shape), rtol=2e-5)


def test_drawn_rays_see_a_light_of_their_own():
    """In place of the even one, by the ways that they come: of mirrors and of matt surfaces, each of some ways."""
    shown = {}
    diffuse, glossy, through, singular = 2, 4, 8, 32  # batch/lanes.h
    looks = [{"rays": np.array([diffuse, glossy | singular], np.uint32), "background": (1, 2, 3)},
             {"rays": np.array([diffuse | through, glossy, glossy | through], np.uint32), "background": (3, 2, 1)}]
    for name, metal in (("matt", matt(0.5)), ("mirror", material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=1e-4, ay=1e-4)),
                        ("dull", material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=0.05, ay=0.05))):
        shown[name] = picture(lights=[], background=SKY, looks=looks, materials=[metal], max_bounces=1).mean((0, 1))
    assert shown["matt"] == pytest.approx((0.5, 1, 1.5), rel=1e-3)
    assert shown["mirror"] == pytest.approx((1, 2, 3), rel=1e-3) and shown["dull"] == pytest.approx((3, 2, 1), rel=1e-2)


def test_sky_and_sun_add_up():
    settings = {"materials": [matt(0.5)], "lights": [sun(irradiance=(3, 2, 1))]}
    lit = picture(**settings)
    np.testing.assert_allclose(picture(**settings, background=SKY, max_bounces=4),
                               lit + np.multiply(0.5, SKY), rtol=2e-5)


@pytest.mark.parametrize("tilt", [0, 50])
def test_metal_under_an_even_sky(tilt):
    """Its albedo, by the midpoint rule over the hemisphere."""
    a = np.radians(tilt)
    eye = (np.sin(a), 0, np.cos(a))
    z, phi = np.meshgrid((np.arange(256) + 0.5) / 256, (np.arange(512) + 0.5) * np.pi / 256)  # 4e-5 off
    r = np.sqrt(1 - z**2)
    wi = np.stack([r * np.cos(phi), r * np.sin(phi), z], -1)
    metal = material(ex=60.0, ey=8.0)
    f_cos = ashikhmin_shirley(np.broadcast_to((0, 0, 1), wi.shape), wi,
                              np.broadcast_to(eye, wi.shape), 60, 8, metal["f0"])
    albedo = f_cos.mean((0, 1)) * 2 * np.pi
    seen = picture(lights=[], background=SKY, materials=[metal], max_bounces=2, samples=256,
                   camera=ortho(half=0.2, eye=tuple(3 * e for e in eye)))
    np.testing.assert_allclose(seen.mean((0, 1)), albedo * SKY, rtol=3e-3)


@pytest.mark.parametrize("bounces", [0, 1, 2, 8])
def test_light_within_a_ball(bounces):
    """Each bounce spreads light evenly over a ball: a geometric series. Eight reach roulette."""
    kd, radius = 0.7, 2.0
    seen = picture(lights=[point((0, 0, 0), (1, 1, 1))], meshes=[sphere(64, radius)],
                   materials=[matt(kd)], camera=persp(eye=(0, 0, 0), target=(1, 0.2, 0.1)),
                   max_bounces=bounces, samples=64)
    irradiance = sum(kd**k for k in range(bounces + 1)) / radius**2
    np.testing.assert_allclose(seen.mean(), kd / np.pi * irradiance, rtol=4e-3)


def test_clamps_of_direct_and_indirect_light():
    """Sun and sky over a plate are direct, each by itself; what a ball's wall gives itself is not."""
    lit, sky = picture(lights=[sun(irradiance=(3, 2, 1))], materials=[matt(0.5)]), np.multiply(0.5, SKY)
    for clamp in (0.1, 0.2, 0.7, 0):
        seen = picture(lights=[sun(irradiance=(3, 2, 1))], materials=[matt(0.5)], background=SKY,
                       max_bounces=1, sample_clamp_direct=clamp, sample_clamp_indirect=0.01)
        dimmed = [part * min(1, clamp / part.mean() if clamp else 1) for part in (lit[0, 0], sky)]
        np.testing.assert_allclose(seen, np.broadcast_to(sum(dimmed), seen.shape), rtol=2e-5)
    ball = {"lights": [point((0, 0, 0), (1, 1, 1))], "meshes": [sphere(64, 2.0)], "samples": 64,
            "materials": [matt(0.7)], "camera": persp(eye=(0, 0, 0), target=(1, 0.2, 0.1))}
    direct, most = picture(**ball, max_bounces=0).mean(), 0.01
    seen = picture(**ball, max_bounces=1, sample_clamp_indirect=most).mean()
    np.testing.assert_allclose(seen, direct + most, rtol=1e-3)


def test_what_a_surface_shines_with_is_direct_light_of_the_one_before():
    """A matt ball that shines, seen from inside, by a node: no lamp finds it. What drawn rays meet is clamped as direct
    light, what they meet one bounce later as indirect."""
    kd, light, register = 0.5, 3.0, registers(3, 1)
    nodes = [{"type": "MATH", "operation": "ADD", "a": [light], "b": [0.0], "c": [0.0], "out": register}]
    matt_part = {"closure": "DIFFUSE", "model": "LAMBERT", "color": (kd,) * 3, "roughness": [0.0]}
    ball = {"lights": [], "meshes": [sphere(32, 2.0)], "samples": 16, "camera": persp(eye=(0, 0, 0), target=(1, 0.2, 0.1)),
            "materials": [{"name": "", "nodes": nodes, "closures": [{"closure": "EMISSION", "weight": register * 3}, matt_part]}]}
    for bounces, direct, indirect in ((1, 0, 0.01), (1, 0.7, 0), (2, 0, 0.1), (2, 0.6, 0.1), (0, 0.6, 0.1)):
        parts = [light * kd**k for k in range(bounces + 1)]
        most = [direct or math.inf] * 2 + [indirect or math.inf]
        seen = picture(**ball, max_bounces=bounces, sample_clamp_direct=direct, sample_clamp_indirect=indirect)
        np.testing.assert_allclose(seen.mean(), sum(map(min, parts, most)), rtol=1e-3)


def test_a_texture_may_be_of_the_body(tmp_path):
    """The kd of a material beside its f0, and so says the dump."""
    rng = np.random.default_rng(3)
    pixels = rng.random((4, 4, 3)).astype(np.float32)
    textured = matt(0.9, color_image=0)
    textured["kd_from"] = textured.pop("f0_from")
    sight = {"images": [image(pixels, filter="CLOSEST")], "materials": [textured], "samples": 1,
             "width": 4, "height": 4}
    seen = picture(**sight, lights=[], background=(1, 1, 1), max_bounces=1)
    np.testing.assert_allclose(seen, pixels, rtol=1e-4, atol=1e-4)
    planes, _ = dump(scene(**sight, lights=[sun(irradiance=(np.pi,) * 3)]), tmp_path / "d.exr")
    np.testing.assert_allclose(vectors(planes, "kd", "RGB"), pixels, atol=1e-4)
    np.testing.assert_allclose(vectors(planes, "light0.S", "RGB"), pixels, rtol=1e-4, atol=1e-4)
    assert (vectors(planes, "Color", "RGB") == 0).all()


def test_a_closed_box_keeps_the_sky_out():
    seen = picture(lights=[], background=(1e6, 1e6, 1e6), meshes=[box((-1, -1, -1), (1, 1, 1))], materials=[matt(0.9)],
                   camera=persp(eye=(0.1, 0.2, 0.3), target=(1, 1, 1)), max_bounces=16, samples=64)
    assert (seen == 0).all()


def test_two_plates_at_a_right_angle():
    """
    Floor [0, 1] x [0, 1] and wall x = 0 under a sun that only the floor sees: what the wall gets
    is an integral over the floor, and a pixel's two bounces must not share their random numbers.
    """
    kd = 0.8
    floor, wall = square(0.5), square(0.5)
    eye = np.eye(4)
    down, up = eye.copy(), np.array([[0, 0, 1, -0.5], [0, 1, 0, 0], [-1, 0, 0, 0.5], [0, 0, 0, 1]], float)
    seen = picture(lights=[sun((0, 0, 1))], meshes=[floor, wall],
                   instances=[{"mesh": 0, "matrix": down.ravel().tolist()},
                              {"mesh": 1, "matrix": up.ravel().tolist()}],
                   materials=[matt(kd)], width=3, height=3, samples=4096, max_bounces=1,
                   camera=ortho(half=0.02, eye=(3, 0, 0.25), target=(0, 0, 0.25)) | {
                       "matrix": [0, 0, 1, 3, 1, 0, 0, 0, 0, 1, 0, 0.25, 0, 0, 0, 1]})
    # radiance of the floor kd / pi; the point is (-0.5, 0, 0.25), its normal +x
    x, y = np.meshgrid((np.arange(2000) + 0.5) / 2000, (np.arange(2000) + 0.5) / 2000 - 0.5)
    d2 = x**2 + y**2 + 0.25**2
    form = (x * 0.25 / d2**2).mean()
    np.testing.assert_allclose(seen[1], (kd / np.pi) ** 2 * form, rtol=0.01)  # at the row's height


def test_threads_change_no_bit():
    settings = {"meshes": [square(), sphere(12, 0.4, (0, 0, 0.5))], "materials": [matt(0.6)],
                "background": SKY, "lights": [sun((0.3, 0.2, 1), angle=0.1)], "max_bounces": 6,
                "width": 40, "height": 30}
    assert (picture(**settings, threads=1) == picture(**settings, threads=2)).all()


@pytest.mark.parametrize("value, words", [(-1, "max_bounces"), (1 << 20, "max_bounces"), (0.5, "max_bounces")])
def test_senseless_number_of_bounces(value, words):
    with pytest.raises((ValueError, TypeError), match=words):
        native.start(scene(max_bounces=value))


@pytest.mark.parametrize("bounces", [0, 4])
def test_a_dark_sky_is_seen_and_lights_nothing(bounces):
    pixels = np.full((4, 8, 3), 0.7, np.float32)
    for around in ({"background": SKY}, {"images": [image(pixels)], "sky": sky()}):
        seen, lit = (picture(lights=[], materials=[matt(0.5)], meshes=[square(0.5)], transparent=False,
                             max_bounces=bounces, sky_hidden=14 * dark, **around) for dark in (True, False))
        assert (seen[5:11, 5:11, :3] == 0).all() and (seen[:3, :3, :3] > 0.2).all()
        np.testing.assert_allclose(seen[:3, :3], lit[:3, :3], rtol=1e-6)
        assert (lit[5:11, 5:11, :3] > 0.05).all()


@pytest.mark.parametrize("pane", [False, True])
def test_drawn_rays_reach_no_farther_than_that(pane):
    """A black sheet at h hides of an even sky what is nearer than r: all within the cosine h / r; so it does past what is clear."""
    glass = {"name": "clear", "nodes": [], "closures": [{"closure": "TRANSPARENT"}]}
    black = {"name": "black", "nodes": [], "closures": [{"closure": "EMISSION", "weight": (0, 0, 0)}]}
    white = {"name": "white", "nodes": [], "closures": [{"closure": "DIFFUSE", "model": "LAMBERT", "color": (1, 1, 1), "roughness": [0.0], "bumps": "OPEN"}]}
    seen = picture(meshes=[square(0.2), square(2e3, 0.5, 1), *([square(2e3, 0.2, 2)] if pane else [])], materials=[white, black, glass], lights=[],
                   background=(1, 1, 1), reach=0.5 / 0.6, samples=256, width=8, height=8, camera=ortho(0.1, (0, 0, 0.15)))
    assert seen.mean() == pytest.approx(0.36, abs=0.006)
