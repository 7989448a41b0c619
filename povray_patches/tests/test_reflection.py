# SPDX-License-Identifier: AGPL-3.0-or-later
"""`reflection { }`: what a lobe gathers of the scene, against integrals of Ashikhmin and Shirley's formula."""
import functools
import re
from pathlib import Path

import numpy as np
import pytest

from scenes import dot, normalise

COST = 14.7

EX, EY = 60.0, 9.0
EYE = normalise(np.array([0.3, 0.8, -0.5]))  # from the plate
FAR, RADIUS = 1000.0, 250.0
METAL = "specular <1, .8, .6> horizon hard tangent x"


def scene(block, rest, finish="ambient 0 diffuse 0"):
    """A plate in the xz plane, seen from one direction all over."""
    place = "<" + ", ".join(f"{10 * c:.9g}" for c in EYE) + ">"
    return f"""#version 3.7; global_settings {{ assumed_gamma 1 }}
camera {{ orthographic location {place} look_at 0 angle 2 }}
box {{ <-4, -1, -4>, <4, 0, 4> pigment {{ rgb 0 }} finish {{ {finish} mdf {{ ashikhmin_shirley {EX}, {EY} {METAL} {block} }} }} }}
{rest}
"""


def emitter(towards, radiance=1.0, radius=RADIUS):
    place = "<" + ", ".join(f"{FAR * c:.9g}" for c in towards) + ">"
    return f"sphere {{ {place}, {radius} pigment {{ rgb 1 }} finish {{ ambient 0 diffuse 0 emission {radiance} }} }}\n"


def brdf_cos(wi):
    """f cos for f0 = 1 towards EYE; T, B, N are POV-Ray's x, z, y [AshikhminShirley2000 Eq. 4]."""
    h = normalise(wi + EYE)
    ho, ni, no = dot(h, EYE), wi[..., 1], EYE[1]
    sine2 = np.maximum(1 - h[..., 1] ** 2, 1e-30)
    exponent = (EX * h[..., 0] ** 2 + EY * h[..., 2] ** 2) / sine2
    D = np.sqrt((EX + 1) * (EY + 1)) / (2 * np.pi) * np.maximum(h[..., 1], 0) ** exponent
    return np.where(ni > 0, D / (4 * ho * np.maximum(ni, no)) * ni, 0)


def over_sphere(inside, n=1200):
    """The integral of f cos over the directions that `inside` takes, by midpoints."""
    z, phi = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(2 * n) + 0.5) * np.pi / n, indexing="ij")
    r = np.sqrt(1 - z * z)
    wi = np.stack([r * np.cos(phi), z, r * np.sin(phi)], -1)
    return np.sum(brdf_cos(wi) * inside(wi)) / n * np.pi / n


@functools.cache
def albedo():
    return over_sphere(lambda wi: 1.0)


MIRROR = EYE * [-1, 1, -1]
TURNED = normalise(MIRROR + [0.25, 0, 0.1])
CLOSE = pytest.approx


def mean(result):
    return result.image.mean((0, 1))


def reflected(result):
    """Rays."""
    return int(re.search(r"Reflected Rays:\s+(\d+)", result.log).group(1))


COLOUR = np.array([1, 0.8, 0.6])


def test_furnace(render):
    """Even light of 1 from all round gives the albedo, which is 1 of a white lobe with `multiscatter`."""
    text = scene("reflection { samples 64 }", "background { rgb 1 }")
    assert mean(render(text, (32, 24), dump=False)) == CLOSE(albedo() * COLOUR, rel=0.01)
    rough = text.replace(f"ashikhmin_shirley {EX}, {EY}", "ggx .9, .2 brdf microfacet multiscatter on")
    assert mean(render(rough, (32, 24), dump=False))[0] == CLOSE(1, rel=0.01)


def test_a_background_is_seen_through_and_mirrored(render):
    """With an alpha channel a block mirrors the background that is transparent to the eye, and is whole."""
    plate = scene("reflection { samples 4 }", "background { rgbBACKGROUND }").replace("<-4, -1, -4>, <4, 0, 4>", "<-.05, -.001, -.05>, <.05, 0, .05>")
    opaque = render(plate.replace("BACKGROUND", " <.5, 1, .25>"), (32, 24), dump=False).image
    seen = render(plate.replace("BACKGROUND", "t <.5, 1, .25, 1>"), (32, 24), ["+UA"], dump=False).channels
    rgb, whole = np.stack([seen[name] for name in "RGB"], -1), seen["A"] == 1
    assert 0.05 < whole.mean() < 0.9 and (rgb[~whole] == 0).all() and (seen["A"][~whole] == 0).all()
    assert opaque[whole].min() > 0.05 and rgb[whole] == CLOSE(opaque[whole], rel=1e-3)
    # and one that is clear itself lets it through, whatever it mirrors
    clear = plate.replace("BACKGROUND", "t <.5, 1, .25, 1>").replace("rgb 0", "rgbt 1")
    assert (render(clear, (32, 24), ["+UA"], dump=False).channels["A"][whole] == 0).all()


@pytest.mark.parametrize("towards", [MIRROR, TURNED], ids=["mirrored", "turned"])
def test_gathers_the_integral_over_an_emitter(render, towards):
    cone = np.sqrt(1 - (RADIUS / FAR) ** 2)
    expected = over_sphere(lambda wi: wi @ towards > cone) * COLOUR
    found = mean(render(scene("reflection { samples 64 }", emitter(towards)), (48, 36), dump=False))
    assert expected[0] > 0.05 and found == CLOSE(expected, rel=0.01)


def test_a_highlight_is_the_reflection_of_what_is_as_bright(render):
    """A lamp of colour c is an irradiance of pi c: as a small ball of radiance pi c over its solid angle."""
    small = 30.0
    solid_angle = 2 * np.pi * (1 - np.sqrt(1 - (small / FAR) ** 2))
    place = "<" + ", ".join(f"{FAR * c:.9g}" for c in TURNED) + ">"
    lamp = f"light_source {{ {place}, rgb 1 parallel point_at 0 %s }}\n"
    highlight = mean(render(scene("", lamp % ""), dump=False))
    ball = emitter(TURNED, np.pi / solid_angle, small)
    gathered = mean(render(scene("reflection { samples 256 }", ball), (64, 48), dump=False))
    assert highlight == CLOSE(np.pi * brdf_cos(TURNED) * COLOUR, rel=2e-3)
    assert gathered == CLOSE(highlight, rel=0.03)
    # and the same ball as what the lamp looks like is not counted again, unless the lamp gives no highlight
    looks = "looks_like { union { " + emitter(np.zeros(3), np.pi / solid_angle, small).strip() + " sphere { 1e4*y, 1e-3 } } }"
    both = mean(render(scene("reflection { samples 16 }", lamp % looks), dump=False))
    assert both == CLOSE(highlight, rel=2e-3)
    fill = mean(render(scene("reflection { samples 256 }", lamp % ("shadowless " + looks)), (64, 48), dump=False))
    assert fill == CLOSE(highlight, rel=0.03)


def test_same_bytes_for_any_threads_and_window(render):
    text = scene("reflection { samples 5 }", emitter(MIRROR) + "sphere { <1, .3, .5>, .5 pigment { checker rgb 1 rgb .1 } finish { emission 1 } }\n")
    one = render(text, (40, 30), ["+WT1"], dump=False).image
    four = render(text, (40, 30), ["+WT4", "+BS8"], dump=False).image
    part = render(text, (40, 30), ["+SC11", "+SR7", "+EC30", "+ER20"], dump=False).image
    assert np.array_equal(one, four)
    assert np.array_equal(part[6:20, 10:30], one[6:20, 10:30])
    assert one.std() > 0.01


@pytest.mark.parametrize("block, rays", [("ggx .2, .2 reflection { samples 5 }", 5), ("fabric { preset \"denim\" crossings 900 } reflection { samples 5 }", 5),
                                         ("fabric { preset \"denim\" crossings 900 } reflection { }", 32), ("ggx .04, .04 reflection { }", 13),
                                         ("ggx 1e-4, 1e-4 reflection { }", 4)])
def test_each_hit_sends_as_many_rays_as_asked(render, block, rays):
    """Without a number a lobe sends by its width, 4 to 64 for one of alpha 1, and cloth 32."""
    whole = scene("", "background { rgb 1 }")
    start, end = whole.index("mdf {"), whole.index("}", whole.index("mdf {"))
    result = render(f"{whole[:start]}mdf {{ {block} {whole[end:]}", (16, 12), ["+V"], dump=False)
    assert 0.88 * rays < reflected(result) / (16 * 12) <= rays  # but those below the plate


def test_rays_multiply_no_further_than_asked(render):
    """Two plates that see each other: N rays at the first, one for each at the second, each one level deep."""
    facing = "box { <-9, 4, -9>, <9, 5, 9> no_image pigment { rgb 0 } finish { ambient 0 diffuse 0 mdf { ashikhmin_shirley 60, 9 specular 1 reflection { samples 16 } } } }\n"
    result = render(scene("reflection { samples 16 }", facing + "background { rgb 1 }"), (16, 12), ["+WT1", "+V"], dump=False)
    assert reflected(result) <= 16 * 12 * 16 * 4  # max_trace_level 5: the camera's ray and four


def test_textures_that_are_averaged_share_the_rays(render):
    """As many as one finish sends, and the mean by weights, of textures with less than a ray's part and maps in maps."""
    colours = [(1, .2, 0), (0, .9, .1), (.3, 0, 1), (.8, .4, 0), (.1, 0, .7)]
    A, B, C, D, E = (f"pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ ashikhmin_shirley {EX}, {EY} specular rgb <{r}, {g}, {b}> horizon hard tangent x "
                     "reflection { samples 4 } } }" for r, g, b in colours)
    weights = np.array([1, 3 * .75, 3 * .25, 2 * .25, 2 * .75]) / 6
    texture = (f"texture {{ average texture_map {{ [1 {A}] [3 gradient y texture_map {{ [0 {B}] [1 {C}] }} translate -.25*y]"
               f" [2 average texture_map {{ [1 {D}] [3 {E}] }}] }} }}")
    plate = scene("", "background { rgb 1 }")
    mapped = plate[:plate.index("pigment")] + texture + " }\nbackground { rgb 1 }\n"
    result = render(mapped, (48, 36), dump=False)
    assert mean(result) == CLOSE(albedo() * (weights @ colours), rel=0.02)
    assert 3 * 48 * 36 < reflected(result) <= 4 * 48 * 36 * 1.02  # some go below the plate
    # and where parts of a blob have a texture each
    metal = "texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ ggx .2, .2 specular rgb {} reflection {{ samples 4 }} }} }} }}"
    parts = f"sphere {{ 0, 1, 1 {metal.format('<1, 0, 0>')} }} sphere {{ 0, 1, 3 {metal.format('<0, 1, 0>')} }}"
    result = render("#version 3.7; global_settings { assumed_gamma 1 } camera { location -5*z look_at 0 angle 20 } background { rgb 1 }\n"
                    f"blob {{ threshold 1 {parts} }}", (32, 24), dump=False)
    red, green = result.image[result.image[..., 2] == 0].sum(0)[:2]
    assert green > 100 and red / green == CLOSE(1 / 3, rel=.05)
    hits = np.sum(result.image[..., 2] == 0)
    assert 3 * hits < reflected(result) <= 4 * hits * 1.05


def test_each_of_two_layers_mirrors_the_room(render):
    """Also where the rays of one have met a wall before those of the other set out."""
    layer = "texture {{ pigment {{ rgbt <0, 0, 0, {}> }} finish {{ ambient 0 diffuse 0 mdf {{ ashikhmin_shirley %s, %s specular {} horizon hard tangent x reflection {{ samples 16 }} }} }} }}" % (EX, EY)
    plate = scene("", "sphere { 0, 1000 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }")
    layers = layer.format(0, "rgb <1, .2, 0>") + layer.format(1, "rgb <0, .5, .3>")
    result = render(plate[:plate.index("pigment")] + layers + plate[plate.index("}\nsphere"):], (24, 18), dump=False)
    assert mean(result) == CLOSE(albedo() * np.array([1, .7, .3]), rel=.02)


def test_clamp_holds_what_a_ray_brings(render):
    bright = "background { rgb 50 }"
    held = mean(render(scene("reflection { samples 64 clamp 2 }", bright), (32, 24), dump=False))
    assert held == CLOSE(2 * albedo() * COLOUR, rel=0.01)
    blue = mean(render(scene("reflection { samples 64 clamp 2 }", "background { rgb <1, .5, 50> }"), (32, 24), dump=False))  # its hue stays
    assert blue == CLOSE(2 * albedo() * COLOUR * [1 / 50, .5 / 50, 1], rel=0.01)


@pytest.mark.parametrize("finish, share", [("ambient .3 diffuse 0", 0.3), ("ambient 0 diffuse 0", 0.0)])
def test_without_it_ambient_light_counts(render, finish, share):
    """The library's albedo is a table: within .02 [albedo.h]."""
    text = scene("", "background { rgb 1 }", finish)
    found = mean(render(text, (32, 24), dump=False))
    assert found == CLOSE(share * albedo() * COLOUR, abs=0.02 * share + 1e-6)
    lit = mean(render(text.replace("assumed_gamma 1", "assumed_gamma 1 ambient_light rgb <2, .5, 1>"), (32, 24), dump=False))
    assert lit == CLOSE(found * [2, .5, 1], rel=2e-3)


def test_radiosity_lights_metal(render):
    text = scene("", "background { rgb 1 }").replace("assumed_gamma 1", "assumed_gamma 1 radiosity { count 60 error_bound .5 pretrace_end .05 }")
    assert mean(render(text, dump=False)) == CLOSE(albedo() * COLOUR, rel=0.05)


def test_radiosity_leaves_highlights_out(render):
    """A matt plate faces a wall that a lamp behind the plate lights: what is matt of it shines back, as in POV-Ray, and nothing else."""
    def lit(kd, specular):
        wall = f"box {{ <-9, -9, -5>, <9, 9, -4> pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ ggx .5, .5 fresnel none specular {specular} diffuse lambert rgb {kd} }} }} }}"
        return render(f"""#version 3.7; global_settings {{ assumed_gamma 1 radiosity {{ count 60 error_bound .5 pretrace_end .05 }} }}
camera {{ orthographic location <0, 0, -3> right 2*x up 2*y look_at 0 }} light_source {{ <0, 0, 50>, rgb 1 parallel point_at 0 }}
{wall} box {{ <-1, -1, 0>, <1, 1, .1> pigment {{ rgb 1 }} finish {{ ambient 0 diffuse 1 }} no_shadow }}""", (12, 12), dump=False).image
    matt = lit(.5, 0)
    assert lit(0, .9).max() == 0 and matt.min() > .1 and lit(.5, .9) == CLOSE(matt, rel=1e-3)


def test_conserve_energy_takes_it_from_what_lies_below(render):
    layers = scene("", "", "ambient 1 diffuse 0 conserve_energy").replace("pigment { rgb 0 }", "texture { pigment { rgb 1 } finish { ambient 1 diffuse 0 } } texture { pigment { rgbt <0, 0, 0, 1> }")
    layers = layers.replace("} } }\n", "} } } }\n", 1)
    found = mean(render(layers, dump=False))
    share = albedo() * COLOUR
    assert found == CLOSE(share + 1 - share, abs=0.03)


@pytest.mark.parametrize("words, message", [
    ("reflection", "mdf: expected '{', 'on' or 'off' after 'reflection', but found }."),
    ("reflection { sample 3 }", "did you mean 'samples'"),
    ("reflection { samples }", "reflection samples needs a number"),
    ("reflection { clamp 1e999 }", "reflection clamp is not a finite number"),
])
def test_what_is_refused(render, words, message):
    result = render(scene(words, ""), (8, 6), dump=False, fails=True)
    assert result.status == 1 and message in result.message


def test_what_is_taken_as_the_nearest(render):
    said = {"reflection { samples 0 }": "reflection samples is 0; it is taken as 1.", "reflection { samples 2.5 }": "reflection samples is 2.5; it is taken as 2.",
            "reflection { clamp -1 }": "reflection clamp is -1; it is taken as 0."}
    log = render("".join(scene(words, "") for words in said), (8, 6), dump=False).message
    for words, message in said.items():
        assert log.count(message) == 1, words


def test_off_again(render):
    """A finish that begins with another one can leave its reflections out."""
    on = scene("reflection { }", "background { rgb 1 }")
    off = on.replace("box {", "#declare Shining = finish { ambient 0 diffuse 0 mdf { ggx .2, .2 reflection { } } }\nbox {", 1)
    off = off.replace("finish { ambient 0 diffuse 0 mdf { ashikhmin", "finish { Shining mdf { ashikhmin").replace("reflection { } } } }\nbackground", "reflection off } } }\nbackground")
    assert "Shining mdf" in off and "reflection off" in off
    assert mean(render(on, (8, 6), dump=False))[0] > 0.5
    assert mean(render(off, (8, 6), dump=False))[0] == 0


def test_focal_blur_shares_the_rays_out(render):
    """A pixel's samples send together what one alone would, at least one each, and see the same."""
    def look(samples, blur):
        text = scene(f"reflection {{ samples {samples} }}", emitter(normalise(np.array([-.3, .8, .5]))))
        text = text.replace("orthographic", "").replace("angle 2", f"angle 2 {blur}")
        result = render(text, (12, 12), dump=False)
        return mean(result), reflected(result)
    sharp, rays = look(128, "")
    blurred, shared = look(128, "aperture .01 focal_point 0 blur_samples 16, 16")
    assert blurred == pytest.approx(sharp, rel=.02)
    assert shared == pytest.approx(rays, rel=.1)
    assert look(4, "aperture .01 focal_point 0 blur_samples 16, 16")[1] == pytest.approx(16 * 144, rel=.1)


FLOOR = "plane { y, -9 pigment { checker rgb 0 rgb 1 scale 30 } finish { ambient 0 diffuse 0 emission 1 } }\nsky_sphere { pigment { gradient x color_map { [.5 rgb 0] [.5 rgb 1] } scale 2 translate -x } }\n"


def noise(image):
    """Variance of the first component about the mean, and of the means of squares of three pixels."""
    from numpy.lib.stride_tricks import sliding_window_view
    grey = image[..., 0] - image[..., 0].mean()
    return np.mean(grey ** 2), np.mean(sliding_window_view(grey, (3, 3)).mean((-1, -2)) ** 2)


@pytest.mark.parametrize("samples", [4, 8, 11])
def test_rays_of_pixels_beside_each_other_are_elsewhere(render, samples):
    """Were pixels independent, nine of them would have a ninth of the variance."""
    one, nine = noise(render(scene(f"reflection {{ samples {samples} }}", FLOOR), (96, 72), dump=False).image)
    assert one > 1e-4 and nine < 0.8 / 9 * one


def test_shifts_of_pixels_are_even_and_far_apart():
    """Each multiple of the powers of the root of x^3 = x + 1 once, in 256ths; those of pixels beside each other farther apart than by chance."""
    text = (Path(__file__).resolve().parents[1] / "glue/dither.h").read_text(encoding="utf-8")
    pairs = np.array(re.findall(r"{(\d+),(\d+)}", text), int)
    root = np.roots([1, 0, -1, -1]).real.max()
    wanted = np.floor((.5 + np.arange(64 * 64)[:, None] * root ** [-1., -2.]) % 1 * 256).astype(int)
    assert sorted(map(tuple, pairs)) == sorted(map(tuple, wanted))
    tile = pairs.reshape(64, 64, 2)
    def apart(down, right):
        step = np.abs(tile - np.roll(tile, (down, right), (0, 1))) / 256
        return np.linalg.norm(np.minimum(step, 1 - step), axis=-1)
    assert min(apart(0, 1).mean(), apart(1, 0).mean(), apart(1, 1).mean()) > 1.08 * .3826 and min(apart(0, 1).min(), apart(1, 0).min()) > .14
    assert apart(0, 9).mean() == pytest.approx(.3826, rel=.02)  # by chance: (sqrt 2 + asinh 1) / 6


def test_rays_of_a_focal_blur_are_laid_out_together(render):
    """16 samples with a ray each, of a plate that looks the same to all of them: as 16 rays of one sample, not as 16 on their own."""
    sharp = scene("reflection { samples 16 }", FLOOR)
    blurred = sharp.replace("angle 2", "angle 2 aperture 1e-6 focal_point 0 blur_samples 16, 16")
    blurred = blurred.replace("orthographic", "").replace(" look_at", " * 1000 look_at").replace("angle 2", "angle .02")
    of_one = noise(render(sharp.replace("samples 16", "samples 1", 1), (64, 48), dump=False).image)[0]
    of_many = noise(render(blurred, (64, 48), dump=False).image)[0]
    assert of_one > .01 and of_many < 0.6 / 16 * of_one


@pytest.mark.parametrize("preset", ["brushed_steel", "turned_steel", "scratched_steel"])
def test_rays_of_several_lobes_are_laid_out_together(render, preset):
    """Each lobe has its own rays in even places: 24 have less variance than as many on their own."""
    def of(samples):
        text = scene(f"preset \"{preset}\" scratches {{ mm_per_unit 2000 }} tangent x reflection {{ samples {samples} }}", "sky_sphere { pigment { checker rgb 0 rgb 1 scale .11 } }")
        return noise(render(text, (96, 72), dump=False).image)[0]
    one = of(1)
    assert one > .01 and of(24) < 0.85 / 24 * one


def test_as_many_rays_as_scratches_ask_for(render):
    """The number left out is by what a hit spreads, scratches among it: presets are about equally grainy."""
    def grain(preset):
        text = scene(f"preset \"{preset}\" scratches {{ mm_per_unit 2000 }} tangent x reflection {{ }}", "sky_sphere { pigment { checker rgb 0 rgb 1 scale .11 } }")
        image = render(text, (96, 72), dump=False).image
        return noise(image)[0] / image[..., 0].mean() ** 2
    assert grain("scratched_steel") < 1.5 * grain("brushed_steel")  # by the plate between scratches alone: 2.4


def test_scratches_without_depth_ask_for_no_more_rays(render):
    """What is that shallow has no slope; its square is 0."""
    def of(scratches):
        return render(scene(f"ggx .2, .05 specular rgb .8 tangent y {scratches} reflection {{ }}", "sky_sphere { pigment { checker rgb 0 rgb 1 scale .11 } }"),
                      (24, 18), dump=False).image
    shallow = "scratches { layer { pits 1000 radius .05, .05 stretch 4, 8 depth 1e-200, 1e-200 } mm_per_unit 20 }"
    assert noise(of(shallow))[0] == pytest.approx(noise(of(""))[0], rel=.3)


def test_a_panel_is_as_bright_as_the_lamps_that_fill_it(render):
    """Scratched and polished: of a lamp far smaller than the panel the highlight would be narrower and brighter."""
    header = "#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { orthographic location -5*z look_at 0 right 2.2*x up 2.2*y }\n"
    lamps = """#declare A = vnormalize(<-40, 50, -60>); #declare U = vnormalize(vcross(A, y)); #declare V = vcross(A, U);
#for (I, 0, 99) #local R = 105.1*sqrt((I + .5)/100); #local W = I*2.399963229728653;
light_source { A*1000 + R*cos(W)*U + R*sin(W)*V, rgb .43822/100 parallel point_at 0 } #end
"""
    panel = "disc { vnormalize(<-40, 50, -60>)*1000, <40, -50, 60>, 105.1 pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 40 } }\n"
    ball = ("sphere {{ 0, 1 pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ preset \"scratched_steel\" scratches {{ mm_per_unit 5000 }} {} }} }} }}\n")
    by_lamps, by_panel = (render(header + light + ball.format(words), size=(50, 50), dump=False).image
                          for words, light in (("", lamps), ("reflection { samples 256 }", panel)))
    bright = by_lamps[..., 0] > .3 * by_lamps.max()
    assert bright.sum() > 5 and by_panel[bright].mean() == pytest.approx(by_lamps[bright].mean(), rel=.03)
    assert by_panel.sum() == pytest.approx(by_lamps.sum(), rel=.03)
