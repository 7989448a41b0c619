# SPDX-License-Identifier: GPL-3.0-or-later
"""Light by the way it took: planes beside the picture against their sum and against formulas."""

import numpy as np
import pytest

from native_scenes import (
    finish, image, look_at, material, native, ortho, persp, point, registers, scene, sky, sphere, square, sun,
)
from test_native_closures import EMISSION, TRANSLUCENT, TRANSPARENT, diffuse, glass, glossy, of, weighed

COST = 2

KINDS, PARTS = ("DIFFUSE", "GLOSSY", "TRANSMISSION"), ("DIRECT", "INDIRECT", "COLOR")
ALL = [f"{kind}_{part}" for kind in KINDS for part in PARTS] + ["EMISSION", "ENVIRONMENT"]
ONE = {"width": 1, "height": 1, "lights": [], "transparent": False}
FACE = of(diffuse(color=(0.8, 0.5, 0.2)))
GOLD = {key: value for key, value in material(mdf="GGX", brdf="MICROFACET", ax=0.3, ay=0.3).items()
        if key not in ("name", "nodes")}


def passes(description, wanted=tuple(ALL), channels=3):
    """The picture and the planes, by name, from the bottom."""
    job = native.start(scene(**description) | {"planes": [{"type": name} for name in wanted]})
    assert finish(job)["state"] == "done"
    size = description.get("height", 16), description.get("width", 16)
    picture, planes = np.full((*size, 4), np.nan, np.float32), {}
    native.image(job, picture)
    for name in wanted:
        planes[name] = np.full((*size, channels), np.nan, np.float32)
        native.image(job, planes[name], name)
        assert np.isfinite(planes[name]).all(), name
    native.free(job)
    return picture, planes


def total(planes):
    """The picture that the planes say."""
    return planes["EMISSION"] + planes["ENVIRONMENT"] + sum(
        planes[f"{kind}_COLOR"] * (planes[f"{kind}_DIRECT"] + planes[f"{kind}_INDIRECT"])
        for kind in KINDS)


def of_everything(**changes):
    """Balls of lists of closures over a floor, under lamps and an image."""
    materials = [
        of(diffuse(color=(0.7, 0.6, 0.5))),
        of(weighed(diffuse(color=(0.8, 0.2, 0.1)), 0.5), weighed(GOLD, 0.5)),
        of(weighed(glass(0.2), 0.9, 0.8, 0.7)),
        of(weighed(TRANSPARENT, 0.6), weighed(diffuse(), 0.2), weighed(TRANSLUCENT, 0.1, 0.2, 0.1)),
        of(weighed(glass(1e-4), 0.3), weighed(GOLD, 0.3), weighed(diffuse(), 0.2),
           weighed(EMISSION, 0.1, 0.2, 0.3)),
    ]
    balls = [sphere(12, 0.45, (x, y, 0.5)) | {"material": np.full(24 * 24, number, np.int32)}
             for number, (x, y) in enumerate([(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)], 1)]
    pixels = np.full((4, 8, 3), 0.4, np.float32)
    pixels[3, 2] = (8, 6, 4)
    return {"width": 24, "height": 24, "samples": 16, "transparent": False, "max_bounces": 6,
            "materials": materials, "meshes": [square(0.8), *balls], "camera": ortho(1.1, (0.3, -0.8, 3)),
            "lights": [sun((1, 0.4, 1), angle=0.1), point((0, 0, 1.5), radius=0.1)],
            "images": [image(pixels)], "sky": sky()} | changes


@pytest.mark.parametrize("changes", [
    {}, {"sample_clamp_direct": 0.5, "sample_clamp_indirect": 0.3}, {"max_bounces": 0},
    {"lights": [], "background": (0.3, 0.4, 0.5)}, {"lights": [sun((0.2, 0.3, 1))], "sky_hidden": True},
], ids=["all", "clamped", "no bounce", "sky alone", "sky hidden"])
def test_the_planes_add_up_to_the_picture(changes):
    description = of_everything(**changes)
    picture, planes = passes(description)
    np.testing.assert_allclose(total(planes), picture[..., :3], rtol=1e-4, atol=1e-6)
    said = {name for name, plane in planes.items() if plane.max() > 0.01}
    if not changes:
        assert said == set(ALL)
    assert planes["ENVIRONMENT"][0, 0].max() == (0 if "sky_hidden" in changes else picture[0, 0, :3].max())
    # the picture is the same as without any planes, and theirs whatever the threads
    for threads, wanted in ((1, ALL), (2, [])):
        again, others = passes(description | {"threads": threads}, tuple(wanted))
        np.testing.assert_allclose(again, picture, rtol=2e-6, atol=1e-7)
        for name, plane in others.items():
            assert (plane == planes[name]).all()


def test_a_film_that_is_clear_keeps_what_is_behind_it():
    """The picture has no sky, the pass has: also through what lets light pass."""
    clear, planes = passes(of_everything(transparent=True))
    solid, others = passes(of_everything())
    for name in ALL:
        np.testing.assert_allclose(planes[name], others[name], rtol=1e-4, atol=1e-5, err_msg=name)
    assert (solid[..., :3] >= clear[..., :3] - 1e-5).all() and clear[..., 3].min() == 0
    np.testing.assert_allclose(total(planes) - planes["ENVIRONMENT"], clear[..., :3], rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("image_there", [False, True])
@pytest.mark.parametrize("clear", [False, True])
def test_a_sky_that_is_too_bright(image_there, clear):
    """Behind all and behind a veil no brighter than *Clamp Direct*, its hue kept, as in Cycles."""
    hue = np.float32((1, 2, 3))
    world = {"images": [image(np.full((4, 8, 3), hue))], "sky": sky()} if image_there else {"background": hue.tolist()}
    veil = of(weighed(TRANSPARENT, 0.1))
    for meshes, left in (([square(z=-90.0, half=1e-3)], 1.0), ([square()], 0.2 / 0.5)):
        picture, planes = passes({**ONE, **world, "meshes": meshes, "materials": [veil], "samples": 4096 if left < 1 else 4,
                                  "sample_clamp_direct": 0.5, "camera": ortho(1e-2), "transparent": clear})
        np.testing.assert_allclose(planes["ENVIRONMENT"][0, 0], 0.5 * hue / 2 * left, rtol=1e-4 if left == 1 else 0.2)
        np.testing.assert_allclose(picture[0, 0, :3], 0 if clear else planes["ENVIRONMENT"][0, 0], atol=1e-4)


def test_colours():
    """Weights times colours; of metal head-on; of glass what a smooth one reflects and refracts."""
    for given, kind, color in (
            (FACE, "DIFFUSE", (0.8, 0.5, 0.2)), (of(GOLD), "GLOSSY", (0.9, 0.6, 0.3)),
            (of(weighed(diffuse(color=(0.8, 0.5, 0.2)), 0.5, 1, 0.25)), "DIFFUSE", (0.4, 0.5, 0.05)),
            (of(weighed(TRANSLUCENT, 0.3, 0.2, 0.1)), "DIFFUSE", (0.3, 0.2, 0.1)),
            (of(glass(0.3, ior=2.0)), "GLOSSY", (1 / 9,) * 3),
            (of(glass(0.3, ior=2.0) | {"tint": (1, 0.5, 0)}), "TRANSMISSION", (8 / 9, 4 / 9, 0)),
            (of(weighed(glass(0.3, ior=2.0) | {"pass_color": (1, 0.5, 0.1)}, 0.5)), "GLOSSY", (0.5 / 9, 0.25 / 9, 0.05 / 9)),
            (of(weighed(glass(0.3, ior=2.0) | {"pass_color": (1, 0.5, 0.1), "tint": (1, 1, 0.5)}, 0.5)), "TRANSMISSION", (4 / 9, 2 / 9, 0.2 / 9)),
            (of(glass(0.3, refracts=False)), "GLOSSY", (1, 1, 1)),
            (of(glass(0.3, reflects=False)), "TRANSMISSION", (1, 1, 1)),
            (of(glossy(0.5) | {"pass_color": (0.1, 0.2, 4.0)}), "GLOSSY", (0.1, 0.2, 4.0)),
            (of(EMISSION), "DIFFUSE", (0, 0, 0)), (of(weighed(TRANSPARENT, 0.5)), "GLOSSY", (0, 0, 0))):
        _, planes = passes({**ONE, "materials": [given], "samples": 4})
        np.testing.assert_allclose(planes[f"{kind}_COLOR"][0, 0], color, rtol=1e-5, atol=1e-7)
    # a picture of the light alone has its colour too, with which it is divided
    _, planes = passes({**ONE, "materials": [FACE], "lights": [sun()]}, ("DIFFUSE_DIRECT",))
    np.testing.assert_allclose(planes["DIFFUSE_DIRECT"], 1 / np.pi, rtol=1e-5)


def test_light_without_a_colour_is_grey():
    """A channel that the colour lacks is the others' mean."""
    _, planes = passes({**ONE, "materials": [of(diffuse(color=(0, 0.5, 0.25)))], "lights": [
        sun(irradiance=(np.pi, np.pi, 3 * np.pi))]})
    np.testing.assert_allclose(planes["DIFFUSE_DIRECT"][0, 0], (2, 1, 3), rtol=1e-5)
    _, planes = passes({**ONE, "materials": [of(diffuse(color=(0, 0, 0)))], "lights": [sun()]})
    assert (planes["DIFFUSE_DIRECT"] == 0).all()


def test_passed_surfaces_are_seen_and_not_counted():
    """Two veils before a face: what each shows, by what the ones before leave."""
    veil = of(weighed(TRANSPARENT, 0.5), weighed(diffuse(color=(0.8, 0.8, 0.8)), 0.25),
              weighed(EMISSION, 0.1, 0.1, 0.1))
    _, planes = passes({**ONE, "samples": 1024, "background": (1, 1, 1), "max_bounces": 0,
                        "materials": [veil, of(GOLD)], "transparent_max_bounces": 8,
                        "meshes": [square(z=1.0), square(z=0.5)]})
    color, emitted = planes["DIFFUSE_COLOR"][0, 0], planes["EMISSION"][0, 0]
    np.testing.assert_allclose(color, 0.2 * (1 + 0.5), rtol=0.02)
    np.testing.assert_allclose(emitted, 0.1 * (1 + 0.5), rtol=0.02)
    np.testing.assert_allclose(planes["ENVIRONMENT"][0, 0], 0.25, rtol=0.05)
    assert (planes["GLOSSY_COLOR"] == 0).all()


def test_planes_of_what_is_clamped_behind_a_pane():
    """It shines with more than its limit and reflects less than that: each has its own part of the picture."""
    nodes = [{"type": "MATH", "operation": "ADD", "a": [light], "b": [0.0], "c": [0.0], "out": [out]}  # which makes no lamp of it
             for light, out in zip((0.9, 0.6, 0.3), registers(3, 3))]
    lit = of(EMISSION | {"weight": registers(3, 3)}, weighed(diffuse(color=(0.5, 0.25, 0.75)), 1.0), nodes=nodes)
    picture, planes = passes({**ONE, "materials": [of(TRANSPARENT), lit], "meshes": [square(z=0.5), square(material_index=1)],
                              "lights": [sun(irradiance=(0.3, 0.3, 0.3))], "sample_clamp_direct": 0.2, "max_bounces": 2, "camera": ortho(0.5)})
    np.testing.assert_allclose(planes["EMISSION"][0, 0], (0.3, 0.2, 0.1), rtol=1e-5)
    np.testing.assert_allclose(planes["DIFFUSE_DIRECT"][0, 0], 0.3 / np.pi, rtol=1e-5)
    np.testing.assert_allclose(total(planes), picture[..., :3], rtol=1e-5)


@pytest.mark.parametrize("name, closure", [("DIFFUSE", diffuse(color=(0.5, 0.5, 0.5))), ("GLOSSY", glossy(1e-3))])
def test_light_of_a_closed_ball(name, closure):
    """It shines with e on the inside and reflects a: e is direct, e (a + a^2 + … a^n) indirect."""
    a, e, bounces = 0.5, 0.75, 5
    given = of(weighed(closure, a / 0.5 if name == "DIFFUSE" else a), weighed(EMISSION, e))
    _, planes = passes({**ONE, "samples": 4096, "materials": [given], "max_bounces": bounces,
                        "meshes": [sphere(16, 4.0, smooth=False)], "camera": ortho(0.1, (0, 0, 0.5))})
    later = e * sum(a**k for k in range(1, bounces + 1))
    for what, value, within in ((f"{name}_COLOR", a, 1e-5), ("EMISSION", e, 1e-5), (f"{name}_DIRECT", e, 0.02),
                        (f"{name}_INDIRECT", later, 0.03)):
        np.testing.assert_allclose(planes[what][0, 0], value, rtol=within, err_msg=what)
    assert (planes["ENVIRONMENT"] == 0).all()


EYE = (1.0, -2.0, 3.0)


def test_distance_and_normal_as_the_camera_sees_them():
    """Of the ray's middle through one pixel: from where the camera clips, and z away from it."""
    tilted = {**ONE, "camera": persp(1e-4, EYE, (0.1, 0.2, 0), clip=(0.5, 100)), "materials": [FACE]}
    away = np.linalg.norm(np.subtract(EYE, (0.1, 0.2, 0)))
    _, distance = passes(tilted, ("DISTANCE",), 1)
    np.testing.assert_allclose(distance["DISTANCE"], away - 0.5, rtol=1e-4)
    _, normal = passes(tilted, ("SEEN_NORMAL",))
    seen = look_at(EYE, (0.1, 0.2, 0))[:3, :3].T @ (0, 0, 1) * (1, 1, -1)
    np.testing.assert_allclose(normal["SEEN_NORMAL"][0, 0], seen, atol=1e-4)


@pytest.mark.parametrize("camera", [ortho, persp])
@pytest.mark.parametrize("falloff, power", [("LINEAR", 1), ("QUADRATIC", 2), ("INVERSE_QUADRATIC", 0.5)])
def test_mist(camera, falloff, power):
    veil = of(weighed(TRANSPARENT, 0.9, 0.5, 0.1), weighed(diffuse(), 0.1))
    for given, meshes, clear in ((FACE, [square()], 1.0), (veil, [square()], 0.5),
                                 (FACE, [square(z=2.0)], 0), (FACE, [square(1e-6, z=1.0)], 0)):
        mist = {"start": 1.25, "depth": 4.0, "falloff": falloff}
        _, planes = passes({**ONE, "camera": camera(1e-3), "materials": [given], "meshes": meshes,
                            "mist": mist}, ("MIST",), 1)
        depth = 3.0 if clear else 1.0
        left = 1 - np.clip((depth - 1.25) / 4, 0, 1) ** power
        expected = 1 - clear * left if clear else (0 if meshes[0]["positions"][0][0] == -1 else 1)
        np.testing.assert_allclose(planes["MIST"], expected, rtol=1e-4, atol=1e-6)
    _, planes = passes({**ONE, "camera": camera(1e-3), "mist": {**mist, "depth": 0.0}}, ("MIST",), 1)
    assert (planes["MIST"] == 0).all()  # of no depth there is none, as in Cycles


def test_bad_input():
    for bad in ({"start": 0, "depth": 1, "falloff": "CUBIC"}, {"start": 0, "depth": np.nan, "falloff": "LINEAR"},
                {"depth": 1, "falloff": "LINEAR"}):
        with pytest.raises(ValueError, match="mist|falloff|depth|start"):
            native.start(scene(mist=bad))
    for bad in ((1, 1), "white", (np.nan,)):
        with pytest.raises(ValueError, match="pass_color"):
            native.start(scene(materials=[of(diffuse() | {"pass_color": bad})]))
