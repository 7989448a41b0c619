# SPDX-License-Identifier: AGPL-3.0-or-later
"""The diffuse part of a block is diffuse: POV-Ray's own word, in the same scene, gives the same picture."""
import numpy as np
import OpenImageIO as oiio
import pytest

from scenes import HEADER, LAMP, SUN, scene

COST = 4.4

COLOUR = "<.9, .5, .2>"


def stock(k=.6, more=""):
    return f"finish {{ ambient 0 diffuse {k} {more} }}"


def block(k=.6, more=""):
    return f"finish {{ ambient 0 diffuse 0 {more} mdf {{ specular 0 diffuse lambert {k} * {COLOUR} }} }}"


@pytest.fixture
def picture(render, tmp_path):
    """Linear, 16 bits; one thread, so that radiosity takes its samples in the same order."""
    def run(text, size=(64, 48)):
        render(text, size, ["+FN16", "+Oflat.png", "File_Gamma=1", "+WT1"], dump=False)
        image = oiio.ImageInput.open(str(tmp_path / "flat.png"))
        pixels = np.asarray(image.read_image("uint16")).astype(int)
        image.close()
        return pixels
    return run


def texture(finish, pigment=f"rgb {COLOUR}"):
    return f"texture {{ pigment {{ {pigment} }} {finish} }}"


def ball(f):
    return f"sphere {{ 0, 1 {texture(f())} }}\n"


def ball_and_floor(f):
    return ball(f) + f"plane {{ y, -1 {texture(f())} }}\n"


FADING = "gradient y color_map { [0 rgbt <.9, .5, .2, 1>] [1 rgbt <.9, .5, .2, 0>] }"
IRID = "irid { .4 thickness .5 turbulence .3 }"
SETTINGS = {  # name: (objects, lights, global_settings)
    "lights": (ball_and_floor, SUN + LAMP, ""),
    "spotlight": (ball, "light_source { <3, 4, -6>, rgb 1 spotlight point_at 0 radius 4 falloff 9 }", ""),
    "shadowless": (ball, SUN.replace("parallel", "shadowless parallel"), ""),
    "double_illuminate": (lambda f: f"disc {{ 0, y + z, 1.2 {texture(f())} double_illuminate }} "
                                    f"sphere {{ <1.5, .5, 0>, .4 {texture(f())} double_illuminate }}",
                          "light_source { <-4, 8, 9>, rgb 1 } light_source { <4, 8, -9>, rgb .5 }", ""),
    "one side only": (lambda f: f"disc {{ 0, y + z, 1.2 {texture(f())} }}", "light_source { <-4, -8, 9>, rgb 1 }", ""),
    "area_illumination": (ball, "light_source { <3, 4, -6>, rgb 1 area_light 4*x, 4*y, 4, 4 area_illumination }", ""),
    "area_light": (ball_and_floor, "light_source { <3, 4, -6>, rgb 1 area_light 4*x, 4*y, 3, 3 }", ""),
    "radiosity": (lambda f: ball_and_floor(f) + "sphere { <1.6, -.4, -.3>, .5 pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 2 } }\n",
                  LAMP, "radiosity { pretrace_start .08 pretrace_end .02 count 30 error_bound .6 recursion_limit 2 }"),
    "photons": (lambda f: f"box {{ <-3, -2, 1.6>, <3, 3, 1.7> {texture(f())} }} box {{ <-1, -1.2, -1>, <1, -1.1, 1> pigment {{ rgb 1 }} "
                          "finish { ambient 0 diffuse 0 reflection 1 } photons { target reflection on } }",
                "light_source { <0, 3, -2.5>, rgb 1 }", "photons { count 4000 }"),
    "transparent": (lambda f: f"sphere {{ 0, 1 {texture(f(), 'rgbt <.9, .5, .2, .4>')} }} sphere {{ <1.6, 0, .5>, .6 {texture(f(), 'rgbf <.9, .5, .2, .7>')} }}",
                    SUN, ""),
    "layers": (lambda f: f"sphere {{ 0, 1 {texture(f())} {texture(f(.3), FADING)} }}", SUN + LAMP, ""),
    "texture_map": (lambda f: f"sphere {{ 0, 1 texture {{ gradient x texture_map {{ [0 {texture(f())[9:-1]}] [1 {texture(f(.3))[9:-1]}] }} }} }}",
                    SUN + LAMP, ""),
    "irid": (lambda f: f"sphere {{ 0, 1 {texture(f(more=IRID))} }}", SUN + LAMP, ""),
}


@pytest.mark.parametrize("name", SETTINGS)
def test_equals_the_word_diffuse(picture, name):
    objects, lights, settings = SETTINGS[name]
    header = HEADER.replace("assumed_gamma 1", "assumed_gamma 1 " + settings)
    expected, found = (picture(scene(objects(f), lights, header)) for f in (stock, block))
    assert name == "one side only" or expected.max() > 3000, "nothing to compare"
    assert np.abs(expected - found).max() <= 1


def test_nothing_is_left_of_a_clear_surface(picture):
    assert picture(scene(f"sphere {{ 0, 1 {texture(block(), 'rgbt 1')} }}")).max() == 0


def test_opacity_leaves_the_highlight_alone(render, shade_check):
    finish = "finish { ambient 0 diffuse 0 mdf { ashikhmin_shirley 40, 40 specular .3 diffuse DIFFUSE } }"

    def image(colour, diffuse):
        result = render(scene(f"disc {{ 0, y - z, 1.3 texture {{ pigment {{ {colour} }} {finish.replace('DIFFUSE', diffuse)} }} }}"))
        shade_check(result.dump)
        return result.image
    both, half = image("rgb 1", "fibre .5"), image("rgbt <1, 1, 1, .5>", "fibre .5")
    highlight = image("rgb 1", "fibre 0")
    np.testing.assert_allclose(half, highlight + .5 * (both - highlight), rtol=3e-3, atol=1e-4)
    assert (both - highlight).max() > .1 and highlight.max() > .05


@pytest.mark.parametrize("model, k", [("max_normal", .5), ("fibre", .9), ("fibre_view", .9), ("ashikhmin_shirley", .9)])
def test_radiosity_takes_the_albedo(picture, shade, model, k):
    """In an even world, albedo times its light: the integral of f cos, by quadrature of the reference's formulas."""
    ball = "sphere { 0, 1 texture { pigment { rgb 1 } finish { ambient 0 diffuse 0 mdf { specular 0 tangent y diffuse MODEL } } } }"
    header = HEADER.replace("assumed_gamma 1", "assumed_gamma 1 radiosity { pretrace_end .08 count 100 error_bound 1 recursion_limit 1 normal off }")
    world = "background { rgb .5 }\n"
    centre = lambda model: picture(header + world + ball.replace("MODEL", model), (33, 25))[12, 16, 0] / 65535
    found = centre(f"{model} {k}") / centre("lambert .5")  # what POV-Ray gathers of the world, but for its noise, is the same

    # the fibre runs along y; the eye sees the ball's middle from <1, 2, -5>
    eye = np.array([1, 2, -5.0]) / np.sqrt(30)
    n = eye
    t = np.array([0, 1, 0]) - n[1] * n
    t /= np.linalg.norm(t)
    rng = (np.arange(120) + .5) / 120
    cosine, phi = np.meshgrid(rng, 2 * np.pi * rng, indexing="ij")
    across = np.sqrt(1 - cosine ** 2) * np.sin(phi)
    lean = np.sqrt(across ** 2 + cosine ** 2)  # sqrt(1 - (l.t)^2)
    if model == "max_normal":
        value = lean
    elif model == "fibre":
        value = (lean + cosine) / np.pi
    elif model == "fibre_view":  # the eye along n: normals at angle a from it, weighted by cos a
        arc = (np.arange(400) + .5) / 400 * np.pi - np.pi / 2
        lit = np.maximum(np.cos(arc) * cosine[..., None] + np.sin(arc) * across[..., None], 0)
        value = (lit * np.cos(arc)).sum(-1) / np.cos(arc).sum()
    else:
        value = 28 / 23 * (1 - (1 - cosine / 2) ** 5) * (1 - .5 ** 5) * cosine
    albedo = k * np.mean(value) * 2 * np.pi / np.pi
    assert found == pytest.approx(albedo / .5, rel=.01)
