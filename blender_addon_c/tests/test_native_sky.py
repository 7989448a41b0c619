# SPDX-License-Identifier: GPL-3.0-or-later
"""The sun of a sky: without air there is nothing else, and its light is known. Against the fit of the CIE's
observer by [WymanSloanShirley2013]; skies with air are compared with Cycles (test_blender_sky.py)."""

import numpy as np
import pytest

from native_scenes import chance, image, ortho, persp, registers, render, scene, sky, unit
from test_native_light_paths import SURFACES, of_plate, picture, reflected

COST = 3.4

TO = np.array((-0.6, 0, 0.8))  # seen from the eye, the plate's middle looks at it
TURN = np.diag((-1.0, -1.0, 1.0))  # the sky's sun stands above its x axis


def airless(**changes):
    return {"model": "SINGLE", "elevation": float(np.arcsin(0.8)), "altitude": 0.0, "air": 0.0, "dust": 0.0,
            "ozone": 0.0, "later": True, "sun_size": 0.4, "sun_bright": 2.0, "strength": (0.01, 0.02, 0.01),
            "matrix": np.c_[TURN, np.zeros(3)].ravel().tolist(), **changes}


def sunlight():
    """Of a black body of 5778 K in linear Rec. 709, W/m²."""
    def lobe(nm, middle, below, above):
        return np.exp(-0.5 * ((nm - middle) / np.where(nm < middle, below, above)) ** 2)

    nm = np.arange(380.0, 780.5)
    bright = 6.79e-5 * 1.191043e20 / nm**5 / np.expm1(1.438777e7 / (nm * 5778))
    x = 1.056 * lobe(nm, 599.8, 37.9, 31) + 0.362 * lobe(nm, 442, 16, 26.7) - 0.065 * lobe(nm, 501.1, 20.4, 26.2)
    y = 0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1)
    z = 1.217 * lobe(nm, 437, 11.8, 36) + 0.681 * lobe(nm, 459, 26, 13.8)
    to_rgb = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
    return to_rgb @ [(bright * part).sum() for part in (x, y, z)]


def radiance(d, size=0.4):
    angle = np.arccos(np.clip(d @ TO, -1, 1)) / (size / 2)
    limb = 0.4 + 0.6 * np.sqrt(np.maximum(1 - angle**2, 0))
    even = 2 * np.array((0.01, 0.02, 0.01)) * sunlight() / (2 * np.pi * (1 - np.cos(size / 2)))
    return (limb * (angle < 1))[..., None] * even


@pytest.mark.parametrize("surface", SURFACES)
def test_sun_on_a_plate(surface):
    truth = reflected(SURFACES[surface], radiance)
    seen = of_plate(SURFACES[surface], [], sky=airless())
    np.testing.assert_allclose(seen, truth, rtol=0.02)  # of which the fit's part is .01


def test_a_small_sun():
    """Its irradiance is that of any size, but for the rim."""
    seen = of_plate(SURFACES["matt"], [], sky=airless(sun_size=0.005), samples=64)
    np.testing.assert_allclose(seen, 0.5 / np.pi * 0.8 * 0.8 * 2 * np.array((0.01, 0.02, 0.01)) * sunlight(), rtol=0.02)


def test_the_disc_is_seen():
    seen = picture(sky=airless(), lights=[], meshes=[], transparent=False, camera=persp(0.3, (0, 0, 0), TO), width=33,
                   height=33, samples=64)
    np.testing.assert_allclose(seen[16, 16], radiance(TO), rtol=0.015)
    assert not seen[0].any() and 0.2 < (seen[16] > 0).mean() < 0.8


def test_the_ground_hides_a_sun_that_sets():
    """All of the light is above the level, whose eye is as good as there."""
    up, down = (picture(sky=airless(elevation=0.0, matrix=np.eye(3, 4).ravel().tolist()), lights=[], transparent=False,
                        meshes=[], camera=ortho(eye=(0, 0, 0), target=(1, 0, way * 0.05)), samples=4, width=2,
                        height=2).mean() for way in (1, -1))
    assert up > 1 and down == 0


@pytest.mark.parametrize("projection", ["EQUIRECTANGULAR", "MIRROR_BALL"])
def test_what_a_picture_around_shows_where(projection):
    """A map as Blender lays it, or a ball that mirrors what is around to an eye before it, at -y."""
    texels = np.random.default_rng(6).random((6, 10, 3), np.float32)
    picture = image(texels, filter="CLOSEST")
    for way in unit(np.random.default_rng(7).standard_normal((6, 3))):
        if projection == "MIRROR_BALL":
            normal = unit(way - (0, 1, 0))
            u, v = 0.5 + 0.5 * normal[0], 0.5 + 0.5 * normal[2]
        else:
            u, v = 0.5 - np.arctan2(way[1], way[0]) / (2 * np.pi), 0.5 + np.arcsin(way[2]) / np.pi
        seen, _ = render(scene(images=[picture], sky=sky(projection=projection), meshes=[], lights=[], transparent=False, width=1,
                               height=1, samples=1, camera=ortho(1e-4, eye=tuple(-3 * way))))
        np.testing.assert_allclose(seen[0, 0, :3], texels[int(6 * v), int(10 * u)], rtol=1e-5)


def noisy():
    """A sky whose nodes make another colour from 0 to 1 of each direction; its image knows the mean."""
    noise = [{"type": "GEOMETRY", "what": "INCOMING", "out": registers(3, 3)},
             {"type": "WHITE_NOISE", "dimensions": 3, "at": [*registers(3, 3), 0.0], "out": registers(6, 4)}]
    shader = {"name": "world", "nodes": noise, "closures": [{"closure": "EMISSION", "weight": registers(6, 3)}]}
    return {"images": [image(np.full((4, 8, 3), 0.5, np.float32))], "sky": {**sky(strength=(2, 4, 1)), "shader": 2},
            "materials": [SURFACES["matt"], shader]}


@pytest.mark.parametrize("samples", [16, 256])
def test_noise_of_a_sky_is_new_for_each_sample(samples):
    """As the camera sees it: twice numbers even from 0 to 1, of green four times, of blue once."""
    seen = picture(**noisy(), lights=[], meshes=[], transparent=False, camera=persp(0.5, (0, 0, 0), TO), samples=samples) / (1, 2, 0.5)
    assert abs(seen.mean() - 1) < 0.02
    assert abs(seen.std() / (2 * (12 * samples) ** -0.5) - 1) < 0.06


def test_noise_of_a_sky_lights():
    """By light samples and drawn rays together: what its mean gives."""
    np.testing.assert_allclose(of_plate(None, [], **noisy()), (0.5, 1, 0.25), rtol=chance(0.01))


@pytest.mark.parametrize("wrap, share", [("EXTEND", 1.0), ("REPEAT", 0.5)])
@pytest.mark.parametrize("filter_, to", [("LINEAR", 1), ("LINEAR", -1), ("CLOSEST", -1)])
def test_poles_of_an_image_around_everything(wrap, share, filter_, to):
    """What ends there has its last row's colour, what repeats half of the other pole's, as images of Cycles have."""
    pixels = np.zeros((8, 16, 3), np.float32)
    pixels[0], pixels[-1] = (1, 0, 0), (0, 0, 1)
    seen = picture(images=[image(pixels, wrap=wrap, filter=filter_)], sky=sky(), lights=[], meshes=[], instances=[], transparent=False, samples=1,
                   camera=ortho(1e-3, (0, 0, 0), (0, 0, to)))[8, 8]
    share = 1.0 if filter_ == "CLOSEST" else share
    np.testing.assert_allclose(seen, (share, 0, 1 - share) if to < 0 else (1 - share, 0, share), atol=1e-3)


@pytest.mark.parametrize("what, sign, to", [("POSITION", 1, 1), ("NORMAL", -1, -1), ("INCOMING", -1, -1), ("NORMAL", -1, 1)])
def test_nodes_of_a_sky_know_the_way(what, sign, to):
    """As those of a wall about the eye that faces it; light below 0 is none, and none is brighter than 1e10."""
    way = np.array([0.36, 0.48, 0.8]) * to
    nodes = [{"type": "GEOMETRY", "what": what, "out": registers(3, 3)}]
    for weight, light in ((registers(3, 3), np.maximum(sign * way, 0)), ([1e20, 3, -1], (1e10, 3, 0))):
        shader = {"name": "world", "nodes": nodes, "closures": [{"closure": "EMISSION", "weight": weight}]}
        seen, _ = render(scene(images=[image(np.ones((4, 8, 3), np.float32))], sky={**sky(), "shader": 2}, materials=[SURFACES["matt"], shader], meshes=[],
                               lights=[], transparent=False, width=1, height=1, samples=1, camera=ortho(1e-4, eye=tuple(-3 * way))))
        np.testing.assert_allclose(seen[0, 0, :3], light, rtol=1e-4, atol=1e-4)


def test_a_sky_for_the_camera_alone_is_all_that_it_sees():
    """In place of the even light, which is a colour of its own, not beside it."""
    seen, _ = render(scene(images=[image(np.full((4, 8, 3), 0.5, np.float32))], background=(5, 3, 1), backdrop_sky=sky(), meshes=[], lights=[], transparent=False,
                           width=2, height=2, samples=1))
    np.testing.assert_allclose(seen[..., :3], 0.5, rtol=1e-5)
