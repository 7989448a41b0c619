# SPDX-License-Identifier: GPL-3.0-or-later
"""What is left out, blurred or left to chance on purpose: caustics, sharp lobes that paths meet by chance, light
samples that bring little."""

import numpy as np
import pytest

from native_scenes import chance, few, native, ortho, point, render, scene, square, sun
from test_native_closures import TRANSLUCENT, TRANSPARENT, diffuse, glass, glossy, of, weighed
from test_native_light_paths import LIGHTS, SURFACES, of_plate, ray_meets, reflected, shining

COST = 1.5

WHITE = (1.0, 1.0, 1.0)


def picture(**changes):
    return render(scene(**changes))[0][..., :3].astype(float)


def below(lid, floor=None, **changes):
    """A small matt plate under a wide lid, the eye between them, an even white sky around."""
    given = {"meshes": [square(), square(500.0, 1.0, 1)], "materials": [floor or of(diffuse(color=(0.5,) * 3)), lid],
             "lights": [], "background": WHITE, "camera": ortho(0.02, (0, 0, 0.5)), "width": 4, "height": 4,
             "samples": 1024, "max_bounces": 6}
    return picture(**given | changes).mean()


MIRROR, CLEAR = of(glossy(1e-3)), of(glass(1e-4, reflects=False))


def test_caustics_by_mirrors_and_through_glass_are_left_out():
    mirrored, through = below(MIRROR), below(CLEAR)
    assert mirrored > 0.3  # the mirror shows the plate the sky beside it, and itself
    assert through == pytest.approx(0.5 / 1.5**2, rel=0.02)  # beyond the critical angle nothing comes
    assert below(MIRROR, caustics_reflective=False) == 0
    assert below(MIRROR, caustics_refractive=False) == mirrored
    assert below(CLEAR, caustics_refractive=False) == 0
    assert below(CLEAR, caustics_reflective=False) == through


def test_of_glass_one_part_may_be_left_out():
    """Both sides of an even sky: what glass reflects and what it lets through add up."""
    both = below(of(glass(1e-4)))
    parts = [below(of(glass(1e-4)), **{name: False}) for name in ("caustics_reflective", "caustics_refractive")]
    assert min(parts) > 0.1 and sum(parts) == pytest.approx(both, rel=0.02)
    assert below(of(glass(1e-4)), caustics_reflective=False, caustics_refractive=False) == 0


def test_lists_lose_only_what_shines():
    """Half mirror, half translucent; and a list that is all mirrors."""
    mixed = of(weighed(glossy(1e-3), 0.5), weighed(TRANSLUCENT, 0.5))
    alone = below(of(weighed(TRANSLUCENT, 0.5)))
    assert below(mixed) > 1.1 * alone
    assert below(mixed, caustics_reflective=False) == pytest.approx(alone, rel=0.02)
    assert below(of(weighed(glossy(1e-3), 0.5), weighed(glossy(0.1), 0.5)), caustics_reflective=False) == 0


def test_the_eye_and_what_mirrors_see_stay():
    """Only rays from matt surfaces lose it; passing straight on is not another ray."""
    settings = {"caustics_reflective": False, "caustics_refractive": False}
    for floor in (MIRROR, CLEAR, SURFACES["wide"]):
        assert below(MIRROR, floor, **settings) == below(MIRROR, floor)
        assert below(shining(0.5), floor, **settings) == below(shining(0.5), floor) > 0.1
    pane = of(weighed(TRANSPARENT, 0.5))
    stacked = {"meshes": [square(), square(500.0, 0.7, 1), square(500.0, 1.0, 2)], "samples": 256,
               "materials": [of(diffuse()), pane, MIRROR]}
    assert below(None, **stacked) > 0.05
    assert below(None, **stacked, **settings) == 0


def coat(alpha):
    return {"closure": "COAT", "alpha": [alpha]}


@pytest.mark.parametrize("lid, dull", [(glossy, 0.5), (lambda a: glass(a, reflects=False), 0.5), (coat, 0.5)])
def test_lobes_behind_a_matt_surface_are_blurred(lid, dull):
    """By so much that their density does not matter: alpha one half. The sun makes a caustic of it."""
    light = {"lights": [sun((0.3, 0.1, 1) if lid not in (glossy, coat) else (0.3, 0.1, -1), (1, 1, 1))],
             "background": (0, 0, 0), "samples": 4096}
    if lid in (glossy, coat):  # the sun shines on the mirror from below, past the plate
        light["camera"] = ortho(0.02, (0, 0, 0.5))
    sharp, blurred = (below(of(lid(1e-3)), blur_glossy=blur, **light) for blur in (0.0, 1e9))
    truth = below(of(lid(dull)), blur_glossy=0.0, **light)
    assert sharp < 0.5 * truth and truth > 0.002
    assert blurred == pytest.approx(truth, rel=1e-3)
    # what is duller stays; and the eye sees sharply
    assert below(of(lid(0.8)), blur_glossy=1e9, **light) == pytest.approx(below(of(lid(0.8)), **light), rel=1e-3)
    assert below(shining(0.5), of(lid(1e-3)), blur_glossy=1e9) == below(shining(0.5), of(lid(1e-3)))


def test_blur_goes_by_the_density_of_the_way():
    """Behind a metal of alpha .5, blur 1: 1 / density is what is left of alpha's square, between both."""
    light = {"lights": [sun((0.3, 0.1, -1), (1, 1, 1))], "background": (0, 0, 0), "samples": few(4096)}
    floor = of(glossy(0.5))
    values = [below(of(glossy(1e-3)), floor, blur_glossy=blur, **light) for blur in (0.05, 1.0, 1e9)]
    assert values[0] < 0.5 * values[1] < values[2]


SHARP = {"sun": sun((-0.3, 0.2, 0.9), (0.2, 0.3, 0.1)), "point": point((-0.5, 0.1, 2.0), (0.5,) * 3)}


@pytest.mark.parametrize("light", SHARP)
def test_dim_samples_are_left_to_chance(light):
    given = {"materials": [SURFACES["matt"]], "lights": [SHARP[light]], "camera": ortho(1e-3), "samples": 2048,
             "width": 8, "height": 8}
    clear, left = (picture(**given, light_sampling_threshold=most) for most in (0.0, 1.0))
    chance = clear.max()
    error = np.sqrt((1 / chance - 1) / (64 * 2048))
    assert clear.std((0, 1)).max() < 1e-5 and 0.005 < chance < 0.3
    np.testing.assert_allclose(left.mean((0, 1)), clear.mean((0, 1)), rtol=4 * error)
    noise = left[..., 0].std() / left[..., 0].mean()
    assert 1e-3 < noise < 1.5 * np.sqrt((1 / chance - 1) / 2048)  # at most what lots apart would make
    assert (picture(**given, light_sampling_threshold=chance * 0.99) == clear).all()


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("kind", LIGHTS)
def test_shared_samples_are_left_to_chance(surface, kind):
    truth = reflected(SURFACES[surface], lambda d: ray_meets(kind, d))
    seen = of_plate(SURFACES[surface], [LIGHTS[kind]], light_sampling_threshold=0.3, samples=few(4096))
    np.testing.assert_allclose(seen, truth, rtol=chance(0.02))


def test_choices_are_left_to_chance():
    lights = [*LIGHTS.values(), *SHARP.values()]
    clear, left = (of_plate(SURFACES["wide"], lights, light_sampling_threshold=most, samples=few(4096)) for most in (0, 0.5))
    np.testing.assert_allclose(left, clear, rtol=chance(0.02))


def test_threads_change_no_bit():
    given = {"lights": [*LIGHTS.values()], "meshes": [square(), square(0.5, 0.4, 1)], "width": 40, "height": 30,
             "materials": [SURFACES["matt"], of(weighed(glossy(0.2), 0.5), weighed(glass(0.1), 0.5))],
             "light_sampling_threshold": 0.1, "blur_glossy": 1.0, "caustics_refractive": False, "max_bounces": 4}
    assert (picture(**given, threads=1) == picture(**given, threads=2)).all()


@pytest.mark.parametrize("name, value", [("light_sampling_threshold", -1), ("blur_glossy", float("nan"))])
def test_malformed(name, value):
    with pytest.raises((ValueError, TypeError), match=name):
        native.start(scene(**{name: value}))
