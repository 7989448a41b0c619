# SPDX-License-Identifier: AGPL-3.0-or-later
"""Photons that a block reflects, and those that pass between yarns."""
import subprocess

import numpy as np
import pytest

from scenes import scene

COST = 1.0


# a wall at x = 1 that a plate in y = 0 throws light on, seen from the front
PHOTONS = "global_settings { assumed_gamma 1 photons { spacing .005 gather 150, 200 } }\n"
HEADER = "#version 3.7;\nPHOTONS camera { orthographic location <0, 1, 0> right 1.6*z up 1.6*y direction x }\n"
LIGHT = "light_source { <-9, 9, 0>, rgb 1 parallel point_at 0 }\n"
PLATE = "box {{ <-.25, -.05, -.25>, <.25, 0, .25> pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 {} }} photons {{ target reflection on }} }}\n"
WALL = "box { <1, -9, -9>, <1.1, 9, 9> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"


@pytest.fixture
def thrown(render):
    """What photons add to the wall. layer: of the plate's texture, above its own."""
    def picture(plate, more="", size=(24, 24), layer="", light=LIGHT):
        made = PLATE.format(plate)
        start, end = made.index("pigment"), made.index(" photons")
        made = f"{made[:start]}texture {{ {made[start:end]} }} {layer}{made[end:]}"
        made = WALL + made + more
        with_photons, without = (render(scene(made, light, HEADER.replace("PHOTONS", settings)), size, dump=False).image
                                 for settings in (PHOTONS, "global_settings { assumed_gamma 1 }\n"))
        return with_photons - without
    return picture


def test_a_polished_block_throws_what_a_mirror_does(thrown):
    warm = LIGHT.replace("rgb 1", "rgb <1, .7, .9>")
    mirror = thrown("reflection rgb <.8, .6, .3>", light=warm).mean((0, 1))
    block = thrown("mdf { ggx .01, .01 specular rgb <.8, .6, .3> reflection { } }", light=warm).mean((0, 1))
    assert mirror[0] > .05
    assert block == pytest.approx(mirror, rel=.03)
    assert (thrown("mdf { ggx .01, .01 }") == 0).all()


def test_layers_above_tint_what_a_block_throws(thrown):
    """As they tint highlights: by what they let through."""
    block = "mdf { ggx .05, .05 specular .8 reflection { } }"
    clear, tinted = (thrown(block, layer=f"texture {{ pigment {{ rgbf <1, {green}, {blue}, 1> }} finish {{ ambient 0 diffuse 0 }} }}").mean((0, 1))
                     for green, blue in ((1, 1), (.5, .2)))
    assert clear.min() > .02 and tinted / clear == pytest.approx((1, .5, .2), rel=.03)


@pytest.mark.parametrize("words, share", [("", .8), ("conserve_energy", .8 * .26)])
def test_what_photons_leave_for_what_is_behind(render, words, share):
    """All that the pigment lets through, or what the block does not reflect, at both faces."""
    sheet = f"box {{ <-.5, 1, -.5>, <.5, 1.01, .5> pigment {{ rgbt <1, 1, 1, .8> }} finish {{ ambient 0 diffuse 0 mdf {{ ggx .05, .05 specular .75 }} {words} }} PHOTONS }}\n"
    floor = "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
    above = "#version 3.7;\nglobal_settings { assumed_gamma 1 photons { spacing .01 gather 100, 200 } } camera { orthographic location .5*y right .4*x up .4*z look_at 0 }\n"
    lamp = "light_source { 9*y, rgb 1 parallel point_at 0 }\n"
    lit = render(scene(floor, lamp, above), (8, 8), dump=False).image.mean()
    through = render(scene(floor + sheet.replace("PHOTONS", "photons { target refraction on reflection off collect off }"), lamp, above), (8, 8), dump=False).image.mean()
    assert through / lit == pytest.approx(share ** 2, rel=.1)


def test_a_rough_block_throws_its_lobe(thrown, shade):
    """Against a sum over the plate by the reference's f."""
    found = thrown("mdf { ggx .2, .4 tangent z brdf microfacet specular .7 horizon hard reflection { } }")[..., 0]
    ticks = (np.arange(8) + .5) / 16 - .25
    px, pz = (a.ravel() for a in np.meshgrid(ticks, ticks))
    rows, columns = np.arange(1, 24, 4), np.arange(1, 24, 4)
    expected = np.zeros((len(rows), len(columns)))
    to_light = np.array([-1, 1, 0]) / np.sqrt(2)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            point = np.array([1, 1 + .8 - 1.6 * (row + .5) / 24, -.8 + 1.6 * (column + .5) / 24])
            way = point - np.stack([px, 0 * px, pz], -1)
            square = (way ** 2).sum(-1)
            way /= np.sqrt(square)[:, None]
            local = lambda v: f"{v[2]:.17g} {v[0]:.17g} {v[1]:.17g}"  # tangent z, normal y
            lines = "\n".join(f"0 0 1 {local(w)} {local(to_light)}" for w in way)
            done = subprocess.run([shade, "eval", "--what", "f", "--mdf", "ggx", "--ax", ".2", "--ay", ".4", "--brdf", "microfacet", "--precision", "reference"],
                                  input=lines, text=True, capture_output=True, check=True)
            f = .7 * np.array([float(line.split()[0]) for line in done.stdout.splitlines()])
            expected[i, j] = (f * way[:, 1] * to_light[1] * way[:, 0] / square).sum() / 256
    near = found[np.ix_(rows, columns)] + 0 * expected
    blur = lambda a: a.reshape(3, 2, 3, 2).mean((1, 3))
    np.testing.assert_allclose(blur(near), blur(expected), rtol=.2, atol=.02 * expected.max())
    assert near.mean() == pytest.approx(expected.mean(), rel=.05)


def test_photons_pass_between_yarns(render, thrown):
    """As much of them as of light: those of a wide beam are dimmed, those of a narrow one let through or not."""
    cloth = ("plane {{ y, 2 pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ fabric {{ crossings 600 yarns {{ gap 1 }} backing rgb 0 }} }} }} "
             "photons {{ {} }} }}\n")
    whole = thrown("reflection .8").mean()
    floor = "plane { y, -.1 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
    above = "#version 3.7;\nglobal_settings { assumed_gamma 1 } camera { orthographic location 1*y right 2*x up 2*z look_at 0 }\n"
    lit, shaded = (render(scene(floor + net, LIGHT, above), (16, 16), dump=False).image.mean() for net in ("", cloth.format("")))
    assert .1 < shaded / lit < .9
    assert thrown("reflection .8", cloth.format("pass_through")).mean() == pytest.approx(whole * shaded / lit, rel=.1)


@pytest.mark.parametrize("lamp", ["", "parallel point_at 0"])
@pytest.mark.parametrize("crossings, faces", [(15, 1), (150, 2)])
def test_photons_are_as_wide_as_they_lie_apart(render, lamp, crossings, faces):
    """From a lamp far away, too: a quarter of what is narrower than a crossing passes both faces of a net, as a whole, and a quarter of
    a quarter of what is wider."""
    net = (f"box {{ <-.5, .6, -.5>, <.5, .62, .5> pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ fabric {{ crossings {crossings} yarns {{ gap 1 }} "
           "backing rgb 0 } } } photons { target refraction on reflection off collect off } }\n")
    floor = "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
    above = "#version 3.7;\nglobal_settings { assumed_gamma 1 photons { spacing .01 gather 100, 200 } } camera { orthographic location .5*y right .5*x up .5*z look_at 0 }\n"
    found = render(scene(floor + net, f"light_source {{ 40*y, rgb 1 {lamp} }}\n", above), (16, 16), dump=False).image.mean()
    assert found == pytest.approx(.25**faces, rel=.04)
