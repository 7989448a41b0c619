# SPDX-License-Identifier: GPL-3.0-or-later
"""Light through transparent panes, of every kind of light: what a plate reflects without them, times what
they let through. Shadow rays and drawn rays share it; a share too many or too few is seen."""

import functools

import numpy as np
import pytest

from native_scenes import area, chance, few, image, native, ortho, persp, point, registers, render, scene, sky, spot, square, sun
from test_native_closures import EMISSION, TRANSPARENT, diffuse, glass, glossy, of, weighed
from test_native_light_paths import EYE, LIGHTS, SURFACES, panel, ray_meets, reflected, shining, sky_of

COST = 2.6

RED = np.array((0.8, 0.5, 0.1))


def pane(color=RED, rest=0.0):
    """Lets `color` through and is matt beside it."""
    return of(TRANSPARENT | {"weight": [*np.atleast_1d(color).tolist()] * (3 // np.size(color))},
              weighed(diffuse(), rest) if rest else EMISSION | {"weight": [0.0] * 3})


def seen(lights, panes=(), material=None, **changes):
    """Mean light from the middle of a plate under panes, the eye below them."""
    materials = [material or SURFACES["matt"], *(made for _, made in panes)]
    meshes = [square(), *(square(500.0, height, k + 1) for k, (height, _) in enumerate(panes))]
    eye = np.multiply(0.5, EYE)
    given = {"lights": lights, "materials": materials, "meshes": meshes, "width": 8, "height": 8,
             "samples": 256, "camera": ortho(half=1e-3, eye=tuple(eye)), "max_bounces": 0} | changes
    return render(scene(**given))[0][..., :3].astype(float).mean((0, 1))


SHARP = {"sun": sun((-0.3, 0.2, 0.9), (2, 2, 2)), "point": point((-0.5, 0.1, 2.0), (2, 2, 2)),
         "spot": spot((0, 0, 3), intensity=(4, 4, 4))}


@pytest.mark.parametrize("light", SHARP)
@pytest.mark.parametrize("panes", [1, 2, 3])
def test_sharp_light_keeps_what_panes_let_through(light, panes):
    """Each sample is the answer, but for what the panes are beside: matt, they shade nothing here."""
    clear = seen([SHARP[light]])
    made = [(0.6, pane()), (0.8, pane((1, 1, 0.5), 0.5)), (1.0, pane(0.5, 0.5))][:panes]
    through = np.prod([RED, (1, 1, 0.5), (0.5,) * 3][:panes], 0)
    assert clear.min() > 0.05
    np.testing.assert_allclose(seen([SHARP[light]], made), clear * through, rtol=2e-5)


def test_an_opaque_sheet_among_them_stops_all():
    made = [(0.6, pane()), (0.8, of(diffuse())), (1.0, pane())]
    assert (seen(list(SHARP.values()), made) == 0).all()
    # behind the lamp it stops nothing
    clear = seen([SHARP["point"]], made[:1])
    np.testing.assert_allclose(seen([SHARP["point"]], [made[0], (2.1, of(diffuse()))]), clear, rtol=1e-5)


@pytest.mark.parametrize("most, through", [(0, 0), (1, 0), (2, 0), (3, 1), (4, 1)])
def test_as_many_panes_as_paths_may_pass(most, through):
    made = [(0.6 + 0.1 * k, pane(0.5)) for k in range(3)]
    clear = seen([SHARP["sun"]])
    np.testing.assert_allclose(seen([SHARP["sun"]], made, transparent_max_bounces=most),
                               clear * 0.125 * through, rtol=1e-5)


@pytest.mark.parametrize("panes, through", [(8, 1), (9, 0)])
def test_eight_panes_where_nothing_is_said(panes, through):
    made = [(0.6 + 0.05 * k, pane(1.0)) for k in range(panes)]
    np.testing.assert_allclose(seen([SHARP["sun"]], made, samples=1), through * seen([SHARP["sun"]], samples=1), rtol=2e-5)


@pytest.mark.parametrize("most", [1, 2, 3])
def test_paths_may_pass_one_pane_less_than_before(most):
    """As in Cycles from 5.0 on: on the way from the eye to what shines as many as one fewer allowed; not on that to the sun."""
    made, shines = [(0.6 + 0.1 * k, pane(1.0)) for k in range(most + 1)], of(weighed(EMISSION, 1.0))
    before, less, fewer = (seen([], made, shines, camera=ortho(half=1e-3), samples=1, transparent_max_bounces=allowed, transparent_less=one_less)
                           for allowed, one_less in ((most, False), (most, True), (most - 1, False)))
    assert (before == 1).all() and (less == 0).all() and (fewer == 0).all()
    shadows = [seen([SHARP["sun"]], made[:most], samples=1, transparent_max_bounces=most, transparent_less=one_less) for one_less in (False, True)]
    assert (shadows[0] == shadows[1]).all() and shadows[0].min() > 0


def test_panes_that_the_path_has_passed_count_too():
    """The eye above: two panes on the way to the plate, two on the way to the sun."""
    made = [(0.6, pane(0.5)), (0.8, pane(0.5))]
    above = {"camera": ortho(half=1e-3), "max_bounces": 1}
    clear = seen([SHARP["sun"]], **above)
    for most, part in ((1, 0), (2, 0), (3, 0), (4, 1 / 16), (8, 1 / 16)):
        np.testing.assert_allclose(seen([SHARP["sun"]], made, transparent_max_bounces=most, **above),
                                   clear * part, rtol=1e-5)


def test_a_pane_by_an_image():
    """Stripes: the plate shows them, moved along the sun's way."""
    stripes = np.zeros((1, 8, 3), np.float32)
    stripes[0, ::2] = (1, 0.5, 0.25)
    given = of(TRANSPARENT | {"weight": registers(3, 3)}, nodes=[{"type": "IMAGE", "image": 0, "out": registers(3, 3)}])
    picture, _ = render(scene(
        lights=[sun((0.25, 0, 1), (np.pi,) * 3)], materials=[of(diffuse()), given], meshes=[square(), square(1.0, 1.0, 1)],
        images=[image(stripes, filter="CLOSEST")], width=16, height=2, samples=4, max_bounces=0,
        camera=persp(1.0, (0, 0, 0.9)) | {"frame": (-1, 1, -0.1, 0.1)}))
    slant = 1 / np.hypot(0.25, 1)
    x = ((np.arange(16) + 0.5) / 8 - 1) * 0.9 + 0.25  # on the pane
    for column, at in enumerate(x):
        if abs((at * 4) % 1 - 0.5) < 0.2 and abs(at) < 1:
            inside = stripes[0, int((at + 1) * 4)]
            np.testing.assert_allclose(picture[:, column, :3], np.broadcast_to(inside * slant, (2, 3)), rtol=1e-4)


@functools.cache
def clear_of(surface, shape):
    """What a plate reflects of a light without panes: a quadrature, for several tests."""
    return reflected(SURFACES[surface], lambda d: ray_meets(shape, d))


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("kind", [*LIGHTS, "panel"])
@pytest.mark.parametrize("choice", [False, True])
def test_soft_light_through_panes(surface, kind, choice):
    """Samples of lights and drawn rays share what comes through; at the last bounce too. choice: a dim lamp
    beside it, so that one of two is drawn.
    The noise is up to .5 % over four seeds."""
    shape = "area" if kind == "panel" else kind
    truth = clear_of(surface, shape) * RED * 0.5
    lights = [LIGHTS[kind]] if kind != "panel" else []
    made = [(0.6, pane()), (0.8, pane(0.5, 0.5))]
    more = {"samples": few(512)}
    if choice:
        lights = [*lights, point((0, 0, 1000), (1e-3,) * 3), *[point((0, 0, 1000), (1e-9,) * 3)] * 4]
    if kind == "panel":
        whole = panel()["meshes"][1]
        whole["material"][:] = 3
        more |= {"meshes": [square(), square(500.0, 0.6, 1), square(500.0, 0.8, 2), whole],
                 "materials": [SURFACES[surface], made[0][1], made[1][1], shining(2 / 1.5)]}
    for bounces in (0, 2):
        found = seen(lights, made, SURFACES[surface], max_bounces=bounces, diffuse_bounces=0, **more)
        if bounces:  # a matt pane under the lamp gives the plate some back
            assert (found > (1 - chance(0.02)) * truth).all()
        else:
            np.testing.assert_allclose(found, truth, rtol=chance(0.012))


@pytest.mark.parametrize("surface", SURFACES)
def test_a_sky_through_panes(surface):
    pixels = np.full((8, 16, 3), 0.2, np.float32)
    pixels[6, 8:12] = (20, 10, 3)
    truth = reflected(SURFACES[surface], lambda d: sky_of(pixels, d)) * RED
    found = seen([], [(0.6, pane())], SURFACES[surface], images=[image(pixels, filter="CLOSEST")], sky=sky(),
                 samples=2048)
    np.testing.assert_allclose(found, truth, rtol=0.015)


def test_the_eye_sees_no_lamp_through_a_pane():
    """As it sees none without; the sky it sees."""
    picture, _ = render(scene(lights=[area((0, 0, -1), (9, 9), direction=(0, 0, 1))], materials=[pane(0.5)],
                              background=(1, 2, 3), transparent=False, samples=16))
    np.testing.assert_allclose(picture[..., :3], np.broadcast_to((0.5, 1, 1.5), (16, 16, 3)), rtol=1e-5)


def test_threads_change_no_bit():
    given = {"lights": [LIGHTS["area"], SHARP["sun"], SHARP["spot"]], "meshes": [square(), square(0.5, 0.4, 1)],
             "materials": [SURFACES["matt"], pane(0.5, 0.5)], "width": 40, "height": 30, "max_bounces": 4}
    assert (render(scene(**given, threads=1))[0] == render(scene(**given, threads=2))[0]).all()


def test_awkward_panes_end():
    """One on top of the other, more than may be passed, weights of no number."""
    odd = of(TRANSPARENT | {"weight": [1e30, 1e30, float("inf")]})
    bad = registers(3, 1)
    none = of(TRANSPARENT | {"weight": [bad[0]] * 3}, nodes=[
        {"type": "MATH", "operation": "EXPONENT", "a": [1e4], "b": [0.0], "c": [0.0], "out": bad},
        {"type": "MATH", "operation": "SUBTRACT", "a": bad, "b": bad, "c": [0.0], "out": bad}])
    for made in (none, of(TRANSPARENT | {"weight": [1e30] * 3})):
        seen(list(SHARP.values()), [(0.6, made)] * 40, transparent_max_bounces=1024)
    with pytest.raises(ValueError, match="weight"):
        native.start(scene(materials=[odd]))


@pytest.mark.parametrize("what, by, more, through", [
    ("LENGTH", 1.0, 0.0, 0.6 * 0.8), ("TRANSPARENT_DEPTH", 0.25, 0.5, 0.5 * 0.75), ("SHADOW", 0.5, 0.0, 0.25), ("DEPTH", 0.5, 0.0, 0.25),
    ("CAMERA", -0.5, 0.5, 0.25), ("DIFFUSE", -0.5, 0.5, 0.25), ("GLOSSY", -0.5, 0.5, 0.25), ("TRANSMISSION", -0.5, 0.5, 0.25),
    ("DIFFUSE_DEPTH", 1.0, 0.5, 0.25)])
def test_what_a_shadow_ray_has_met(what, by, more, through):
    """Two panes, each lets through what its node says: how far the ray has come from the plate, and past how many panes; of which kind it is."""
    nodes = [{"type": "PATH", "what": what, "out": registers(3, 1)},
             {"type": "MATH", "operation": "MULTIPLY_ADD", "a": registers(3, 1), "b": [by], "c": [more], "out": registers(4, 1)}]
    told = of(TRANSPARENT | {"weight": registers(4, 1) * 3}, EMISSION | {"weight": [0.0] * 3}, nodes=nodes)
    up = [sun((0, 0, 1), (2, 2, 2))]
    np.testing.assert_allclose(seen(up, [(0.6, told), (0.8, told)], samples=4), seen(up, samples=4) * through,
                               rtol=2e-3 if what == "LENGTH" else 2e-5)  # rays begin a little above the plate


@pytest.mark.parametrize("floor, kind", [(diffuse(), "DIFFUSE"), (glossy(1e-3), "GLOSSY"), (glass(0.05, 1.0, tint=(0.9,) * 3), "TRANSMISSION")])
def test_a_shadow_ray_has_made_the_path_s_bounces(floor, kind):
    """From a wall that is seen by one bounce: a pane beside its lamp, by how many of each kind it says, and by all and one more."""
    low = kind == "TRANSMISSION"
    side = -1.0 if low else 1.0
    wall, sheet = square(9.0, 2 * side, 1), square(0.1, 1.75 * side, 2)
    sheet["positions"] = sheet["positions"] + np.float32((0.4, 0, 0))
    plain = {"meshes": [square(0.5), wall, sheet], "lights": [spot((0.8, 0, 1.5 * side), (-0.8, 0, 0.5 * side), (1e3,) * 3, 0.1)],
             "camera": ortho(half=1e-3, eye=(0, 0, 0.5)), "width": 4, "height": 4, "samples": 256, "max_bounces": 1}

    def by(what, share, more):
        nodes = [{"type": "PATH", "what": what, "out": registers(3, 1)},
                 {"type": "MATH", "operation": "MULTIPLY_ADD", "a": registers(3, 1), "b": [share], "c": [more], "out": registers(4, 1)}]
        told = of(TRANSPARENT | {"weight": registers(4, 1) * 3}, nodes=nodes)
        return render(scene(materials=[of(floor), of(diffuse()), told], **plain))[0][..., :3].astype(float)

    clear = by("SHADOW", 0.0, 1.0)
    assert clear.mean() > 0.1
    for what in ("DIFFUSE", "GLOSSY", "TRANSMISSION"):
        np.testing.assert_allclose(by(f"{what}_DEPTH", 0.25, 0.25), clear * (0.5 if what == kind else 0.25), rtol=1e-5)
    np.testing.assert_allclose(by("DEPTH", 0.25, 0.0), clear * 0.5, rtol=1e-5)


def test_a_pane_shades_as_long_as_it_is_there():
    """It leaves the plate's middle after an eighth of the time, and lets a half through."""
    clear = seen([SHARP["sun"]])
    still, away = np.eye(3, 4, dtype=np.float32), np.eye(3, 4, dtype=np.float32)
    away[0, 3] = 4.0
    offset = -0.6 * SHARP["sun"]["direction"][0] / SHARP["sun"]["direction"][2]  # where the sun's way to the middle meets it
    for one in (still, away):
        one[:2, 3] -= (offset, 0.6 * SHARP["sun"]["direction"][1] / SHARP["sun"]["direction"][2] * -1)
    own = np.eye(4).ravel().tolist()
    moving = seen([SHARP["sun"]], [(0.6, pane(0.5))], samples=few(1024), meshes=[square(), square(0.5, 0.6, 1)],
                  instances=[{"mesh": 0, "matrix": own}, {"mesh": 1, "matrix": own, "motion": np.stack([still, away])}])
    np.testing.assert_allclose(moving, clear * (1 - 0.125 * 0.5), rtol=chance(0.004))
