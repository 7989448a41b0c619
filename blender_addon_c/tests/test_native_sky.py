# SPDX-License-Identifier: GPL-3.0-or-later
"""The sun of a sky: without air there is nothing else, and its light is known. Against the fit of the CIE's
observer by [WymanSloanShirley2013]; skies with air against finer sums, and in
test_blender_sky.py with Cycles."""

import numpy as np
import pytest

from native_scenes import chance, image, ortho, persp, registers, render, scene, sky, unit
from test_native_light_paths import SURFACES, of_plate, picture, reflected

COST = 5

TO = np.array((-0.6, 0, 0.8))  # seen from the eye, the plate's middle looks at it
TURN = np.diag((-1.0, -1.0, 1.0))  # the sky's sun stands above its x axis


def airless(**changes):
    return {"model": "SINGLE", "elevation": float(np.arcsin(0.8)), "altitude": 0.0, "air": 0.0, "dust": 0.0,
            "ozone": 0.0, "later": True, "sun_size": 0.4, "sun_bright": 2.0, "strength": (0.01, 0.02, 0.01),
            "matrix": np.c_[TURN, np.zeros(3)].ravel().tolist(), **changes}


def light_of(share):
    """Of a black body of 5778 K in linear Rec. 709, W/m²; of each wavelength such a share."""
    def lobe(nm, middle, below, above):
        return np.exp(-0.5 * ((nm - middle) / np.where(nm < middle, below, above)) ** 2)

    nm = np.arange(380.0, 780.5)
    bright = share * 6.79e-5 * 1.191043e20 / nm**5 / np.expm1(1.438777e7 / (nm * 5778))
    x = 1.056 * lobe(nm, 599.8, 37.9, 31) + 0.362 * lobe(nm, 442, 16, 26.7) - 0.065 * lobe(nm, 501.1, 20.4, 26.2)
    y = 0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1)
    z = 1.217 * lobe(nm, 437, 11.8, 36) + 0.681 * lobe(nm, 459, 26, 13.8)
    to_rgb = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
    return to_rgb @ [(bright * part).sum() for part in (x, y, z)]


def sunlight():
    return light_of(1.0)


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


UPWARDS = persp(0.7, (0, 0, 0), (-0.3, 0.2, 0.8))
THIRDS = np.linspace(-0.7, 0.7, 7)[1::2]  # the middles of its picture's nine pixels
WAYS = unit(np.stack([*np.meshgrid(THIRDS, THIRDS), np.full((3, 3), -1.0)], -1).reshape(9, 3)
            @ np.reshape(UPWARDS["matrix"], (4, 4))[:3, :3].T)
ELEVATION = 0.6  # of a sun above the x axis
SUN = np.array((np.cos(ELEVATION), 0, np.sin(ELEVATION)))


def shown(model, **settings):
    """Of an atmosphere, in the ways above."""
    given = {"model": model, "elevation": ELEVATION, "later": True, "sun_size": 0.0, "sun_bright": 1.0, "strength": (1, 1, 1),
             "altitude": 0.0, "air": 0.0, "dust": 0.0, "ozone": 0.0, "matrix": np.eye(3, 4).ravel().tolist(), **settings}
    return picture(lights=[], meshes=[], transparent=False, samples=1, width=3, height=3, filter_width=1e-4,
                   pixel_filter_type="GAUSSIAN", sky=given, camera=UPWARDS).reshape(9, 3)


@pytest.mark.parametrize("turbidity", [2.0, 6.0])
def test_preethams_sky(turbidity):
    """By the appendix of [Preetham1999], of which Blender takes .06; told as X, Y and Z."""
    t, sun_angle = turbidity, np.pi / 2 - ELEVATION
    perez = {"Y": (0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771, -0.0670 * t + 0.3703),
             "x": (-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989, -0.0033 * t + 0.0452),
             "y": (-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537, -0.0109 * t + 0.0529)}
    by_angle = sun_angle ** np.arange(3, -1, -1)
    zenith = {"Y": 0.06 * ((4.0453 * t - 4.9710) * np.tan((4 / 9 - t / 120) * (np.pi - 2 * sun_angle)) - 0.2155 * t + 2.4192),
              "x": (t**2, t, 1) @ np.array([(0.00166, -0.00375, 0.00209, 0), (-0.02903, 0.06377, -0.03202, 0.00394),
                                            (0.11693, -0.21196, 0.06052, 0.25886)]) @ by_angle,
              "y": (t**2, t, 1) @ np.array([(0.00275, -0.00610, 0.00317, 0), (-0.04214, 0.08970, -0.04153, 0.00516),
                                            (0.15346, -0.26756, 0.06670, 0.26688)]) @ by_angle}

    def value(name, cosine, angle):
        a, b, c, d, e = perez[name]
        return (1 + a * np.exp(b / cosine)) * (1 + c * np.exp(d * angle) + e * np.cos(angle) ** 2)
    bright, x, y = (zenith[name] * value(name, WAYS[:, 2], np.arccos(WAYS @ SUN)) / value(name, 1, sun_angle)
                    for name in ("Y", "x", "y"))
    seen = shown("PREETHAM", turbidity=turbidity, rgb=np.eye(3).ravel().tolist())
    np.testing.assert_allclose(seen, np.stack([x / y * bright, bright, (1 - x - y) / y * bright], -1), rtol=2e-3)


def path_up(start, way, edge, count):
    """Points of a way to a sphere, closer together where it begins; and of how much of it each is the middle."""
    b = start @ way
    far = np.sqrt(b**2 - (start**2).sum(-1) + edge**2) - b
    ends = np.linspace(0, 1, count + 1) ** 2
    t = np.multiply.outer(far, 0.5 * (ends[1:] + ends[:-1]))
    return start[..., None, :] + t[..., None] * way, np.multiply.outer(far, np.diff(ends))


@pytest.mark.parametrize("air, dust, altitude", [(1.0, 0.0, 0.0), (0.5, 2.0, 4000.0)])
def test_a_sky_of_light_that_is_scattered_once(air, dust, altitude):
    """By a finer sum than the engine's: air and dust that thin out by 8 and 1.2 km [Nishita1993]."""
    nm = np.arange(380.0, 780.5)
    scatters = np.array([air * 1.1311425e-3 / (1e-3 * nm) ** 4, dust * 2e-2 + 0 * nm])  # 1/km
    stops = scatters * [[1], [1.11]]

    def amounts(points):
        height = np.linalg.norm(points, axis=-1) - 6360
        return np.exp(-height / 8), np.exp(-height / 1.2)
    expected = []
    for way in WAYS:
        points, steps = path_up(np.array((0, 0, 6360 + max(altitude, 1) / 1000)), way, 6420, 300)
        onward, onward_steps = path_up(points, SUN, 6420, 100)
        there = amounts(points)
        before = [np.cumsum(part * steps) - 0.5 * part * steps for part in there]
        behind = [(part * onward_steps).sum(-1) for part in amounts(onward)]
        mu = way @ SUN
        phase = (3 / (16 * np.pi) * (1 + mu**2),
                 3 * (1 - 0.76**2) * (1 + mu**2) / (8 * np.pi * (2 + 0.76**2) * (1 + 0.76**2 - 2 * 0.76 * mu) ** 1.5))
        lost = sum(np.multiply.outer(stop, one + two) for stop, one, two in zip(stops, before, behind))
        gained = sum(np.multiply.outer(scatter, part * steps * by) for scatter, part, by in zip(scatters, there, phase))
        expected.append(light_of((gained * np.exp(-lost)).sum(-1)))
    seen = shown("SINGLE", air=air, dust=dust, altitude=altitude)
    np.testing.assert_allclose(seen, expected, rtol=0.03)  # of which the fit of light_of is .01


@pytest.mark.parametrize("air, dust, ozone, altitude", [(1.0, 1.0, 1.0, 20e3), (3.0, 0.0, 5.0, 30e3), (1.0, 10.0, 0.0, 8e3)])
def test_a_sky_of_light_that_is_scattered_again(air, dust, ozone, altitude):
    """By a finer sum than the engine's and without its table, from so high that these matter little [GarciaLinan2024]."""
    sun, scatters = np.array((1.679, 1.828, 1.986, 1.307)), np.array((6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2)) * air
    eats = 334.5 * 3.78547397e20 * np.array((3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27)) * ozone
    dusts = np.array((1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22)) * dust
    stops = np.array((2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23)) * dust
    to_xyz = np.array([(53.386918, 22.981338, 0), (43.904844, 71.347796, 0.102507), (1.613728, 18.422961, 31.742921),
                       (20.762669, 2.361421, 110.480096)])

    def matter(points):
        height = np.maximum(np.linalg.norm(points, axis=-1) - 6371, 1e-4)[..., None]
        grains = 1.3681e20 * np.exp(-height / 0.73) + 2e6
        gas = scatters * np.exp(-0.07771971 * height**1.16364243)
        tent = np.exp(-5.55555555 * (np.log(height) - 3.22261) ** 2) / height
        return gas, dusts * grains, gas + (dusts + stops) * grains + eats * tent

    def passes(points, way):
        onward, steps = path_up(points, way, 6471, 150)
        return np.exp(-(matter(onward)[2] * steps[..., None]).sum(-2))
    expected = []
    for way in WAYS:
        points, steps = path_up(np.array((0, 0, 6371 + altitude / 1000)), way, 6471, 80)
        gas, grains, lost = matter(points)
        before = np.cumsum(lost * steps[:, None], 0) - 0.5 * lost * steps[:, None]
        radius, mu = np.linalg.norm(points, axis=-1), way @ SUN
        up = (points @ SUN / radius)[:, None]
        ground, above = np.array((0, 0, 6371.0)), np.array((0, 0, 1.0))
        sunlit = np.array([passes(ground, np.array((np.sqrt(1 - one**2), 0, one))) for one in up[:, 0]])
        returns = passes(ground, above) / passes(radius[:, None] * above, above)
        part = 0.5 * (1 - np.sqrt(1 - (6371 / radius[:, None]) ** 2))
        around = np.array((0.217, 0.347, 0.594, 1)) * 0.02 / (1 + 5 * np.exp(-17.92 * up))
        around = around + part * 0.3 / np.pi * sunlit * returns * up
        direct = passes(points, SUN)
        by_gas, by_grains = 3 / (16 * np.pi) * (1 + mu**2), (1 - 0.8**2) / (4 * np.pi * (1 + 0.8**2 - 1.6 * mu) ** 1.5)
        lit = sun * (gas * (by_gas * direct + around) + grains * (by_grains * direct + around))
        expected.append((lit * np.exp(-before) * steps[:, None]).sum(0) @ to_xyz)
    seen = shown("MULTIPLE", air=air, dust=dust, ozone=ozone, altitude=altitude, rgb=np.eye(3).ravel().tolist())
    np.testing.assert_allclose(seen, expected, rtol=0.02)


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
