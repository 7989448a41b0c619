# SPDX-License-Identifier: AGPL-3.0-or-later
"""horizon mutual: how steep the bumps of an object are, by what the normals of its dump say."""
import re

import numpy as np
import pytest

from scenes import dot, normalise, scene

COST = 3.4

ABOVE = """#version 3.7; global_settings { assumed_gamma 1 } #declare mdf_Defaults = 1;
camera { orthographic location 10*y right 8*x up 6*z direction -y }
light_source { <3, 5, -1>, rgb 1 }
"""


def block(words=""):
    return f"finish {{ ambient 0 diffuse 0 mdf {{ ggx .2, .2 tangent x horizon mutual {words} }} }}"


def body(normal, words="", more="", pigment="rgb .5"):
    return f"pigment {{ {pigment} }} normal {{ {normal} }} {block(words)} {more}"


def texture(*words, **more):
    return f"texture {{ {body(*words, **more)} }}"


def seen_slopes(dump, number):
    """Mean slope, and its second moment about that, along T and N x T, of a material's pixels."""
    mask = dump.id == number
    N, T, Ns = (normalise(a[mask]) for a in (dump.N, dump.T, dump.Ns))
    x, y, z = dot(Ns, T), dot(Ns, np.cross(N, T)), dot(Ns, N)
    steep = z * 50 > 1
    s = -np.stack([x[steep], y[steep]]) / z[steep]
    xx, xy, _, yy = np.cov(s, bias=True).ravel()
    return np.array([*s.mean(1), xx, xy, yy])


# Each lies in a square of a unit, and shows all that it has to the camera above it: its slopes do not depend on where
# on it one looks. Bumps of a size of many pixels, and many of them.
SQUARE = "polygon { 5, <-.5, -.5>, <.5, -.5>, <.5, .5>, <-.5, .5>, <-.5, -.5> rotate 90*x"
MESH = ("mesh { triangle { <-.5, 0, -.5>, <.5, 0, -.5>, <.5, 0, .5> } triangle { <-.5, 0, -.5>, <.5, 0, .5>, <-.5, 0, .5> }")
OBJECTS = {
    "noise": f"{SQUARE} {texture('bumps 1 scale .05')} }}",
    "scaled": f"{SQUARE} {texture('bumps .15 scale .3 no_bump_scale')} scale <1, 1, 1> scale .25 scale 4 }}",
    "ridges": f"{SQUARE} {texture('gradient x 1 sine_wave scale .2 rotate 30*y')} }}",
    "turbulent": f"{MESH} {texture('wrinkles 1 turbulence .5 scale .1', more='rotate 20*y')} }}",
    "slope_map": f"disc {{ 0, y, .5 {texture('gradient x 1 slope_map { [0 <0, 1>] [.5 <.5, 1>] [.5 <.5, -1>] [1 <0, -1>] } scale .2')} }}",
    "layered": f"{SQUARE} {texture('bumps .4 scale .05')} {texture('ripples 1 scale .1', pigment='rgbt .5')} }}",
    "blended": f"{SQUARE} texture {{ checker {texture('bumps .5 scale .05')} {texture('bumps 1 scale .05')} scale .2 }} }}",
    "averaged": f"{SQUARE} texture {{ average texture_map {{ [1 {body('bumps 1 scale .05')}] [2 {body('dents 1 scale .05')}] }} }} }}",
    "csg": f"difference {{ box {{ <-.5, -.3, -.5>, <.5, 0, .5> }} cylinder {{ -10*y, y, .3 }} {texture('bumps 1 scale .04')} }}",
}


def test_slopes_are_those_of_the_normals_that_are_shaded(render, shade_check):
    """Of each material where it is seen, by the dump alone: scaled, turbulent, layered, blended, on meshes and CSG."""
    text = "".join(f"object {{ {thing} translate <{k % 4 * 2 - 3}, 0, {k // 4 * 2 - 2}> }}\n" for k, thing in enumerate(OBJECTS.values()))
    result = render(scene(text, header=ABOVE, lights=""), (480, 360))
    dump = result.dump
    shown = [m for m in dump.header["materials"] if (dump.id == m["id"]).any()]
    assert len(shown) == len(OBJECTS) + 1  # two of what is blended; of layers a dump has the top one
    for m in shown:
        found, seen = np.array(m["slopes"]), seen_slopes(dump, m["id"])
        square = seen[2] + seen[4]
        assert square > .01 and np.abs(found - seen)[2:] == pytest.approx(0, abs=.1 * square), (m["name"], found, seen)
        assert np.abs(found - seen)[:2] == pytest.approx(0, abs=.1 * square ** .5), (m["name"], found, seen)
    assert shown[2]["slopes"][3] > .02  # ridges that run askew, and not those of a sheet's other side
    shade_check(dump, 1e-5, everything=False)


def test_slopes_of_a_picture_are_those_of_its_texels(render, tmp_path):
    """Bilinear between them, each as often as any other; stretched three times as long along u."""
    from test_bump_image import mapped, random_map, write_png
    colours = np.round(random_map((8, 8)) * 65535)
    write_png(tmp_path / "map.png", colours, "uint16")
    square = "mesh { triangle { <0, 0, 0>, <1, 0, 0>, <1, 0, 1> uv_vectors <0, 0>, <1, 0>, <1, 1> } triangle { <0, 0, 0>, <1, 0, 1>, <0, 0, 1> uv_vectors <0, 0>, <1, 1>, <0, 1> }"
    image = 'tangent uv bump_image { png "map.png" strength .5 scale 1 }'
    text = f"{square} texture {{ uv_mapping pigment {{ rgb .5 }} {block(image)} }} scale <3, 1, 1> }}"
    found = render(scene(text, header=ABOVE, lights=""), (32, 24)).dump.header["materials"][0]["slopes"]
    u = (np.arange(512) + .5) / 512
    n = mapped(colours / 65535, np.stack(np.meshgrid(u, u), -1), .5).reshape(-1, 3)
    x, y = -n[:, 0] / n[:, 2], -n[:, 1] / n[:, 2]
    (xx, xy), (_, yy) = np.cov(x, y, bias=True)
    assert found[2] == pytest.approx(xx, rel=.06) and found[4] == pytest.approx(yy, rel=.06)
    # POV-Ray's space has the left hand: N x T is the other way
    assert found[:2] == pytest.approx([x.mean(), -y.mean()], abs=.05 * xx ** .5)
    assert found[3] == pytest.approx(-xy, abs=.05 * (xx + yy))


def test_an_uneven_picture_has_the_slopes_near_each_hit(render, shade_check, tmp_path):
    """Ripples on its right half, askew, and nothing on its left: by a dump, as a light's share, in a furnace."""
    from test_bump_image import mapped, write_png
    u, v = np.meshgrid((np.arange(128) + .5) / 128, 1 - (np.arange(128) + .5) / 128)
    wave = np.where(u < .5, 0, np.cos(2 * np.pi * (16 * u + 8 * v)))
    n = normalise(np.stack([-.8 * wave, -.4 * wave, np.ones_like(wave)], -1))
    colours = np.round((n + 1) / 2 * 65535)
    write_png(tmp_path / "map.png", colours, "uint16")
    square = ("mesh {{ triangle {{ <0, 0, 0>, <2, 0, 0>, <2, 0, 2> uv_vectors <0, 0>, <1, 0>, <1, 1> }} triangle {{ <0, 0, 0>, <2, 0, 2>, <0, 0, 2> "
              "uv_vectors <0, 0>, <1, 1>, <0, 1> }} texture {{ uv_mapping pigment {{ rgb <.9, .6, .4> }} {} }} translate {} }}\n")
    image = 'bump_image { png "map.png" }'
    blocks = (image + " notes on specular pigment", image + " ggx .7, .7 multiscatter on specular pigment", image + " diffuse lambert rgb .3 detail auto")
    places = ("<-3, 0, -2.5>", "<1, 0, -2.5>", "<-3, 0, .5>")
    text = "".join(square.format(block(words), place) for words, place in zip(blocks, places))
    result = render(scene(text, header=ABOVE), (160, 120))
    assert result.message.count("its bump image is uneven: each hit has the slopes near it") == 1
    dump = result.dump
    shade_check(dump, 1e-5, everything=False)
    assert len(np.unique(dump.id[dump.hit])) == len(blocks)
    s = np.stack([dump.channels[f"slopes.{name}"] for name in ("X", "Y", "XX", "XY", "YY")], -1)
    n = mapped(colours / 65535, np.stack(np.meshgrid((np.arange(512) + .5) / 512, (np.arange(512) + .5) / 512), -1)[:, 256:]).reshape(-1, 3)
    (xx, xy), (_, yy) = np.cov(-n[:, 0] / n[:, 2], -n[:, 1] / n[:, 2], bias=True)
    for number in range(len(blocks)):
        flat, rippled = (dump.hit & (dump.id == number) & side for side in (abs(dump.uv[..., 0] - .25) < .12, abs(dump.uv[..., 0] - .75) < .12))
        assert flat.sum() > 150 and np.abs(s[flat]).max() < .03 * (xx + yy)
        off = s[rippled][:, 2:] - [xx, -xy, yy]  # the left hand
        assert np.abs(off).max() < .3 * (xx + yy) and np.abs(off.mean(0)).max() < .02 * (xx + yy)
        assert np.abs(s[rippled][:, :2]).max() < .02
        assert dump.header["materials"][number]["slopes"][2] == pytest.approx(xx / 2, rel=.06)  # that of all of it

    white = block("specular rgb 1 fresnel schlick reflection { samples 16 } " + image)
    sky = "sky_sphere { pigment { rgb 1 } }\n"
    furnace = render(scene(sky + square.format(white, "<-1, 0, -1>"), header=ABOVE[:ABOVE.index("light_source")].replace("8*x up 6*z", "2*x up 2*z"), lights=""), (32, 32), dump=False).image[..., 0]
    i = (np.arange(4000) + .5) / 4000 * np.pi / 2  # a flat plate, seen from straight above: f cos = D G1 / 4, of GGX
    h, k = np.cos(i / 2), .04
    D, G = k / (np.pi * (1 + (k - 1) * h * h)**2), 2 / (1 + np.sqrt(1 + k * np.tan(i)**2))
    albedo = (D * G / 4 * np.sin(i)).sum() * np.pi / 8000 * 2 * np.pi
    assert furnace[:, 4:12].mean() == pytest.approx(albedo, abs=.01) and furnace[:, 20:].mean() == pytest.approx(1, abs=.05)


def test_words_notes_and_warnings(render):
    """What a block says holds, and is clamped with a warning; what is found is told; without bumps there is no such horizon."""
    ball = "sphere {{ {}*x, 1 texture {{ pigment {{ rgb .5 }} {} {} }} }}\n"
    normal = "normal { bumps .5 scale .2 }"
    text = (ball.format(-3, normal, block("slopes .1, -.2, .3, .05, .4 notes on")) + ball.format(0, normal, block("notes on"))
            + ball.format(3, "", block("slopes 0, 0, 4e6, 1e9, .25")) + ball.format(6, "", block())
            + ball.format(9, "", block("slopes 0, 0, .1, 0, .1 horizon hard")) + ball.format(-6, normal, block()))
    result = render(scene(text, header=ABOVE, lights=""), (8, 6))
    first, second, third, fourth, *_ = result.dump.header["materials"]
    assert first["slopes"] == [.1, -.2, .3, .05, .4]
    assert third["slopes"] == pytest.approx([0, 0, 1e6, 500, .25])
    assert "slopes" not in fourth
    told = re.findall(r"slopes ([\d., e-]+) \(deviations ([\d.]+) along the strokes, ([\d.]+) across\)", " ".join(result.message.split()))
    assert len(told) == 2  # those with notes
    assert told[0] == ("0.1, -0.2, 0.3, 0.05, 0.4", "0.55", "0.63")
    x, y, xx, xy, yy = (float(v) for v in told[1][0].split(","))
    assert [xx, yy] == pytest.approx([second["slopes"][2], second["slopes"][4]], rel=.005) and xx > .001
    assert x in (0, pytest.approx(second["slopes"][0], rel=.005)) and y in (0, pytest.approx(second["slopes"][1], rel=.005))
    assert xy in (0, pytest.approx(second["slopes"][3], rel=.005))
    assert [float(v) for v in told[1][1:]] == pytest.approx([xx ** .5, yy ** .5], rel=.05)
    for warning in ("slopes xx is 4e+06; it is taken as 1e+06.", "slopes xy is 1e+09; it is taken as 500.",
                    "'horizon mutual' (scene.pov:7) is 'horizon hard' here: its texture has no bumps.",
                    "'slopes' (scene.pov:8) changes nothing: 'horizon mutual' alone reads it."):
        assert result.message.count(warning) == 1, (warning, result.message)


def test_light_reaches_bumps_that_turn_away_from_it(render, shade_check):
    """Their other side is lit, and what they reflect into others; in colours of a pigment, which more than one reflection
    deepens, under scratches, whose grooves stand askew, and beside light that is scattered."""
    balls = "".join(f"sphere {{ {x}*x, 1 {texture('bumps 1 scale .1', words, pigment='bozo color_map { [0 rgb <.9, .5, .2>] [1 rgb <.2, .5, .9>] } scale .3')} }}\n"
                    for x, words in ((-2.5, "specular pigment fresnel schlick"), (0, 'preset "brushed_steel" horizon mutual scratches { mm_per_unit 50 }'),
                                     (2.5, "diffuse lambert rgb .3 detail auto")))
    multi = "sphere { <0, 0, 2.2>, 1 texture { pigment { bozo color_map { [0 rgb <.9, .5, .2>] [1 rgb <.2, .5, .9>] } } finish { ambient 0 mdf { ggx .7, .7 multiscatter on specular pigment } } } }"
    dump = render(scene(balls + multi, header=ABOVE), (160, 120)).dump
    shade_check(dump, 1e-5, everything=False)
    behind = dump.hit & (dot(dump.Ns, dump.L[0]) < -.05) & (dot(dump.N, dump.L[0]) > .05) & (np.abs(dump.P[..., 2]) < 1)
    assert behind.sum() > 60 and (dump.E[0][behind].min(-1) > 0).mean() > .9  # some are in shadow
    wide = behind & (dump.E[0].min(-1) > 0) & (np.abs(dump.P[..., 0]) > 1.2)  # the steel's narrow lobe has none to give
    assert (dump.S[0][wide].max(-1) > 0).mean() > .9


def test_from_afar_bumps_are_as_bright_as_from_near(render, tmp_path):
    """Under a dome of lamps; those that pixels do not show one by one are not made roughness, which would shade itself again."""
    from test_bump_image import random_map, write_png
    write_png(tmp_path / "map.png", np.round(random_map((64, 64)) * 65535), "uint16")
    square = "mesh {{ triangle {{ <{0}, 0, -1>, <{1}, 0, -1>, <{1}, 0, 1> uv_vectors <0, 0>, <1, 0>, <1, 1> }} triangle {{ <{0}, 0, -1>, <{1}, 0, 1>, <{0}, 0, 1> uv_vectors <0, 0>, <1, 1>, <0, 1> }} texture {{ uv_mapping pigment {{ rgb 1 }} {2} }} }}\n"
    rough = "finish { ambient 0 diffuse 0 mdf { beckmann .2, .2 tangent uv horizon mutual specular rgb 1 %s } }"
    text = (square.format(-2, 0, rough % 'bump_image { png "map.png" strength 1 scale .25 }')
            + square.format(0, 2, rough % "scratches { mm_per_unit 50 layer { pits 4000 radius .1, .3 stretch 5, 30 depth .3, .6 spread 90 } }"))
    turn, up = np.pi * (1 + 5**.5) * np.arange(24), (np.arange(24) + .5) / 24
    lamps = "".join(f"light_source {{ <{s * np.cos(a):.4f}, {z:.4f}, {s * np.sin(a):.4f}> * 1e4, rgb .26 parallel point_at 0 }}\n" for a, z, s in zip(turn, up, np.sqrt(1 - up * up)))
    header = "#version 3.7; global_settings { assumed_gamma 1 } camera { orthographic location <0, 6, -8> right 4*x up 1.2*y look_at 0 }\n"
    near, far = ((np.split(render(scene(text, header=header, lights=lamps), size, dump=False).image[..., 0], 2, axis=1)) for size in ((400, 240), (40, 24)))
    for wide, narrow in zip(near, far):
        assert wide.mean() > .5 and narrow.mean() == pytest.approx(wide.mean(), rel=.06)
