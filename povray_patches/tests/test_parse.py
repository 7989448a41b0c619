# SPDX-License-Identifier: AGPL-3.0-or-later
"""finish { mdf { } }: what it accepts, and what it says about what it does not."""
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from conftest import ROOT
from scenes import HEADER, SUN, saddle, scene

COST = 15.4

WORDS = ("ashikhmin_shirley, ward, ward_half, beckmann, ggx, brdf, detail, groove, fresnel, diffuse, horizon, multiscatter, tangent, "
         "specular, roughness, bump_image, reflection, preset, fabric, scratches, notes, slopes or }")
DETAILS = ("none, perturb, gram_schmidt, rotate, shortest_arc, rotate_approximate, deform_linear, deform_smooth, auto, "
           "deform_linear_conserving or deform_smooth_conserving")


def sphere(block, before=""):
    return f"{before}\nsphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} finish {{ ambient 0 diffuse 0 mdf {{ {block} }} }} }} }}\n"


@pytest.fixture
def material(render):
    def first(block, before=""):
        return render(scene(sphere(block, before)), (16, 12)).dump.header["materials"][0]
    return first


def test_defaults(material):
    m = material("")
    assert (m["mdf"], m["brdf"], m["detail"], m["groove"], m["fresnel"], m["horizon"]) == (
        "ashikhmin_shirley", "ashikhmin_shirley", "rotate", "auto", "none", "valid_estevez")
    assert (m["ex"], m["ey"], m["f0"]) == (200, 10, [1, 1, 1])


NEWER = "#declare mdf_Defaults = 1;\n"
VERSIONS = """#include "libshade_metals.inc"
#macro Ball(At, Finish) sphere { At*x, .4 texture { pigment { rgb .5 } finish { Finish } } } #end
#macro Newer() #local mdf_Defaults = 1; finish { mdf { ggx .3, .3 } } #end
Ball(-1.2, finish { mdf { ggx .3, .3 } })
Ball(-.8, finish { mdf { ggx .3, .3 brdf auto } })
Ball(-.4, finish { LS_F_Steel_Brushed mdf { ggx .1, .4 } })
Ball(0, finish { mdf { brdf ward_dur ward .2, .2 } })
Ball(.4, finish { mdf { preset "brushed_steel" beckmann .1, .2 scratches off } })
Ball(.8, Newer())
"""


def test_defaults_by_version(render, shade_check):
    """A scene of before keeps its BRDFs, also where it changes what an include file has; one that asks for the newer
    defaults has the BRDF that goes with the distribution."""
    old = ["ashikhmin_shirley", "auto", "ashikhmin_shirley", "ward_dur", "ashikhmin_shirley", "auto"]
    new = ["auto", "auto", "auto", "ward_dur", "auto", "auto"]
    note = "the defaults of version 0 hold (scene.pov:"
    for text, brdfs in ((VERSIONS, old), (NEWER + VERSIONS, new)):
        result = render(scene(text), (56, 8))
        own = [m for m in result.dump.header["materials"] if m["name"].startswith("scene.pov")]
        said = [m["fabric"]["cloth"] if "fabric" in m else m for m in own]
        assert [m["brdf"] for m in said] == brdfs
        log = " ".join(result.message.split())
        assert log.count(note) == (text is VERSIONS), log
        assert ("brdf is ashikhmin_shirley, not microfacet" in log) == (text is VERSIONS)
        shade_check(result.dump, everything=False)  # the include file's finishes are not in the picture
    for bad in ("2", ".5", "x"):
        log = render(scene(sphere("", f"#declare mdf_Defaults = {bad};")), (8, 8), fails=True, dump=False).message
        assert "mdf_Defaults is the version of a block's defaults, 0 to 1." in " ".join(log.split()), log


@pytest.mark.parametrize("metal", ['preset "brushed_gold" scratches off', "ggx .1, .4 fresnel conductor <.2, .9, 1.1>, <3.9, 2.4, 2.3>"])
def test_specular_colours_a_metal_before_it(render, metal):
    """Not one that comes after it, nor in a scene of before there were versions of defaults, which is said."""
    def block(words):
        return f"texture {{ pigment {{ rgb <.7, .5, .3> }} finish {{ ambient 0 diffuse 0 mdf {{ {words} }} }} }}"
    result = render(scene(f"""sphere {{ -4*x, .9 {block(f"{metal} specular rgb <.1, .2, .3>")} }}
#declare mdf_Defaults = 1;
sphere {{ -2*x, .9 {block(f"{metal} specular rgb <.1, .2, .3>")} }} sphere {{ 0, .9 {block(f"{metal} specular pigment")} }}
sphere {{ 2*x, .9 {block(f"specular rgb .5 {metal}")} }}""", SUN), (48, 12))
    before, own, pigment, last = result.dump.header["materials"]
    assert [m["fresnel"] for m in (before, own, pigment, last)] == ["conductor", "schlick", "schlick", "conductor"]
    assert own["f0"] == pytest.approx([.1, .2, .3], abs=1e-6)
    seen = result.dump.color[result.dump.id == pigment["id"]]
    assert len(seen) > 9 and seen == pytest.approx(np.tile([.7, .5, .3], (len(seen), 1)), abs=1e-6)
    assert result.message.count("has no part in a conductor, which has a colour of its own") == 2


def test_every_word(material):
    m = material("ashikhmin_shirley 300, 20 detail gram_schmidt groove y fresnel schlick brdf ashikhmin_shirley "
                 "tangent <1, 2, 3> specular rgb <.1, .2, .3>")
    assert (m["ex"], m["ey"], m["detail"], m["groove"], m["fresnel"]) == (300, 20, "gram_schmidt", "y", "schlick")
    assert m["f0"] == pytest.approx([.1, .2, .3], abs=1e-6)


def test_other_models(material):
    m = material("ggx .1, .4 brdf microfacet multiscatter on fresnel conductor <.2, .9, 1.1>, <3.9, 2.4, 2.3> diffuse fibre .2")
    assert (m["mdf"], m["ax"], m["ay"], m["brdf"], m["diffuse"]) == ("ggx", .1, .4, "microfacet", "fibre")
    assert m["multiscatter"] == "on"
    assert m["eta"] == pytest.approx([.2, .9, 1.1], abs=1e-6) and m["k"] == pytest.approx([3.9, 2.4, 2.3], abs=1e-6)
    assert m["kd"] == pytest.approx([.2] * 3, abs=1e-6) and m["ex"] == pytest.approx(198)
    m = material("beckmann .2, .2 fresnel f82 rgb <.9, .8, .7> diffuse lambert rgb <.1, .2, .3> detail auto horizon schuessler")
    assert m["horizon"] == "schuessler"
    assert m["fresnel"] == "f82" and m["f82"] == pytest.approx([.9, .8, .7], abs=1e-6)


@pytest.mark.parametrize("block, ex, ey", [
    ("ashikhmin_shirley 100, 5", 100, 5), ("ashikhmin_shirley 100 5", 100, 5),
    ("ashikhmin_shirley 50 * 2, sqrt(25) detail none", 100, 5),
    ("ashikhmin_shirley (clock + 1) * 100, vlength(<3, 4, 0>)", 100, 5),
    ("ashikhmin_shirley Big, Big / 20", 100, 5), ("ashikhmin_shirley Twice(50), Twice(2.5)", 100, 5),
    ("Words(100, 5)", 100, 5), ("ashikhmin_shirley Exponents[0], Exponents[1]", 100, 5),
    ("#if (1) ashikhmin_shirley 100, 5 #else detail nonsense #end", 100, 5),
    ("#local E = 5; ashikhmin_shirley E * 20, E", 100, 5),
    ("ashikhmin_shirley 1, 1 #while (I < 3) ashikhmin_shirley I * 50, I + 3 #declare I = I + 1; #end", 100, 5)])
def test_expressions_macros_and_directives(material, block, ex, ey):
    before = """#declare Big = 100; #declare I = 1;
#macro Twice(A) 2 * A #end
#macro Words(A, B) ashikhmin_shirley A, B detail perturb #end
#declare Exponents = array[2] { 100, 5 }"""
    m = material(block, before)
    assert (m["ex"], m["ey"]) == (ex, ey)


@pytest.mark.parametrize("colour, expected", [
    ("rgb <.9, .8, .6>", [.9, .8, .6]), ("<.9, .8, .6>", [.9, .8, .6]), (".5", [.5, .5, .5]), ("Gold", [.9, .7, .3]),
    ("Gold * .5", [.45, .35, .15]), ("Shade(.25)", [.25, .25, .25]), ("red .5", [.5, 0, 0])])
def test_colours(material, colour, expected):
    before = "#declare Gold = rgb <.9, .7, .3>; #macro Shade(A) rgb A #end"
    assert material(f"specular {colour} detail none", before)["f0"] == pytest.approx(expected, abs=1e-6)


def test_words_stay_free_for_the_scene(render):
    """A scene's own identifiers and macros with the block's names: before, inside # directives of, and after it."""
    text = scene("""
#macro detail(tangent) 2 * tangent #end
#declare uv = 7; #declare groove = <1, 0, 0>; #declare gram_schmidt = .5; #declare schlick = 3;
#declare bump_image = uv + detail(1);
sphere { 0, 1 texture { pigment { rgb .5 }
  finish { ambient 0 diffuse 0 specular .2 mdf {
    #if (uv = 7 & bump_image = 9) ashikhmin_shirley 100, 5 #else #error "uv or bump_image lost" #end
    #local E = detail(uv);
    detail none
    #local E = detail(uv); #declare E2 = E;
    groove y
    #ifdef (detail) detail rotate #end
    tangent uv
    groove x
    tangent x + y
  } } } rotate uv * groove }
#if (detail(uv) != 14 | gram_schmidt != .5 | bump_image != 9 | schlick != 3) #error "lost after the block" #end
#declare ashikhmin_shirley = array[2] { uv, groove.x };
sphere { uv * 2 * x, 1 pigment { uv_mapping checker } finish { specular .4 } rotate groove }
""")
    assert render(text, (16, 12)).dump.header["materials"][0]["ex"] == 100


def test_words_of_one_place_are_free_in_another(material):
    # `x` is a choice after groove and a vector after tangent; `rotate` a choice and, outside, a transformation
    assert material("groove x tangent x detail rotate")["groove"] == "x"
    assert material("tangent y groove y tangent <x.x, 0, 1>")["groove"] == "y"


def test_declared_finishes_are_shared_copied_and_changed(render):
    text = scene("""
#declare F = finish { ambient 0 diffuse 0 mdf { ashikhmin_shirley 100, 5 detail none specular rgb <.1, .2, .3> } }
#declare G = finish { F mdf { detail perturb } }
#declare T = texture { pigment { rgb .5 } finish { G } }
#undef F
sphere { -x, .8 texture { T } }
sphere { x, .8 texture { T finish { mdf { ashikhmin_shirley 50, 50 } } } }
#default { finish { ambient 0 mdf { detail gram_schmidt } } }
sphere { y, .5 pigment { rgb 1 } }
""")
    dump = render(text).dump
    seen = [m for m in dump.header["materials"] if (dump.id == m["id"]).any()]
    assert [(m["ex"], m["detail"]) for m in seen] == [(100, "perturb"), (50, "perturb"), (200, "gram_schmidt")]
    assert seen[1]["f0"] == pytest.approx([.1, .2, .3], abs=1e-6)


@pytest.mark.parametrize("block, message", [
    ("shiny 3", f"Expected '{WORDS}', undeclared identifier 'shiny' found instead"),
    ("diffuse wool .2", "Expected 'lambert, max_normal, fibre,"),
    ("weft { }", f"Expected '{WORDS}', undeclared identifier 'weft' found instead"),
    ("200, 10", f"Expected '{WORDS}'"),
    ("Ashikhmin_Shirley 1, 1", f"Expected '{WORDS}', 'Ashikhmin_Shirley' found instead; did you mean 'ashikhmin_shirley'?"),
    ("detail rotated", f"Expected '{DETAILS}', 'rotated' found instead; did you mean 'rotate'?"),
    ("detial rotate", "did you mean 'detail'?"), ("reflection .5", "mdf: expected '{', 'on' or 'off' after 'reflection', but found a number."),
    ("detail", f"Expected '{DETAILS}', }} found instead"),
    ("groove 1", "Expected 'auto, x or y'"),
    ("fresnel 1", "Expected 'none, schlick, f82 or conductor'"),
    ("ashikhmin_shirley detail rotate", "mdf: ashikhmin_shirley: exponent along needs a number, 'detail' found instead."),
    ("ggx .1", "mdf: ggx: alpha across needs a number, } found instead."),
    ("ggx .1,, .2", "mdf: ggx: alpha across needs a number, a comma found instead."),
    ("fresnel conductor <.2, .9, 1.1>", "mdf: fresnel conductor's k needs a colour, } found instead."),
    ("fresnel conductor detail none", "mdf: fresnel conductor's eta needs a colour, 'detail' found instead."),
    ("fresnel f82", "mdf: fresnel f82 needs a colour, } found instead."),
    ("diffuse fibre", "needs a colour, } found instead."),
    ("specular", "mdf: specular needs a colour, } found instead."),
    ("specular gold", "mdf: specular needs a colour, 'gold' found instead."), ("fresnel f82 pigment", "mdf: fresnel f82 needs a colour, pigment found instead."),
    ("fabric { backing pigment }", "mdf: backing needs a colour, pigment found instead."), ("fabric { warp { specular normal } }", "mdf: warp: specular needs a colour, normal found instead."),
    ("roughness", "mdf: roughness needs a number, } found instead."),
    ("roughness .1,", "mdf: roughness needs a number, } found instead."),
    ("specular rgb 1e39", "mdf: specular is not a finite number."),
    ("ggx 1e300 * 1e300, .1", "mdf: alpha along is not a finite number."),
    ("roughness 1e300 * 1e300", "mdf: roughness is not a finite number."),
    ("bump_image { strength 1e300 * 1e300 png \"broken.png\" }", "mdf: bump_image strength is not a finite number."),
    ("bump_image { png \"broken.png\" strength }", "mdf: bump_image strength needs a number, } found instead."),
    ("tangent <0, 0, 0>", "mdf: tangent <0, 0, 0> has no direction."),
    ("tangent <1e-20, 0, 0>", "mdf: tangent <1e-20, 0, 0> has no direction."), ("fabric { weave 2e9, 1, 1 }", "mdf: weave needs three whole numbers: ends under, ends over, shift; 2e+09 is none."),
    ("fabric { weave , 1, 2, 1 }", "mdf: weave: ends under needs a number, a comma found instead."),
    ("fabric { weave 4096, 1, 0 }", "mdf: there is no weave 4096, 1, 0: ends under (1 at least) and over (0 at least) are 4096 together at most."),
    ("tangent <1e300 * 1e300, 0, 0>", "mdf: tangent <inf, 0, 0> has no direction."),
    ("tangent radial", "mdf: expected an axis after 'tangent radial', as in tangent radial y, but found }."),
    ("tangent radial y at", "mdf: expected a point after 'at', but found }."), ("ggx .1, .2, .3", ", a comma found instead; 'ggx' takes no more than what stands before that."),
    ("groove z", "z found instead."), ("fabric { denim }", "a preset's name stands in quotes after preset: preset \"denim\""),
    ("\"gold\"", "a text in quotes found instead; a preset's name follows preset."), ("bump_image \"a.png\"", "mdf: expected '{' after 'bump_image', but found a text in quotes."),
    ("bump_image { png }", "mdf: expected the name of a file, in quotes, after 'png', but found }."),
    ("fabric { warp diffuse rgb 1 }", "mdf: expected '{' after 'warp', but found 'diffuse'."), ("scratches { layer pits 3 }", "mdf: expected '{' after 'layer', but found 'pits'."), ("tangent radial 0 * y", "mdf: tangent <0, 0, 0> has no direction."),
    ("tangent radial y at <0, 1e300 * 1e300, 0>", "mdf: tangent radial's point is not finite."),
    ("at <0, 1, 0>", f"Expected '{WORDS}', undeclared identifier 'at' found instead"),
    ("bump_image { png \"broken.png\" scale <1, 0> }", "mdf: bump_image scale is <1, 0>; it needs finite numbers that are not 0."),
    ("bump_image { png \"broken.png\" translate <0, 1e300 * 1e300> }", "mdf: bump_image translate is <0, inf>; it needs finite numbers."),
    ("specular rgb <0, 0, 1e39>", "mdf: specular is not a finite number."),
    ("bump_image { }", "mdf: bump_image needs a file: png \"file\" or exr \"file\"."),
    ("bump_image { jpeg \"a.jpg\" }", "Expected 'png, exr, strength, scale, translate, filter, once or }', jpeg found instead; a picture of another format is to be converted first."),
    ("bump_image { png \"missing.png\" }", "mdf: cannot open the bump_image file 'missing.png'."),
    ("bump_image { exr \"missing\" }", "mdf: cannot open the bump_image file 'missing'."),
    ("bump_image { png \"broken.png\" }", "mdf: cannot read the bump_image file 'broken.png'"),
    ("bump_image { exr \"broken.exr\" }", "mdf: cannot read the bump_image file 'broken.exr'"),
    ("ashikhmin_shirley 1, 1 }", "")])
def test_errors_name_line_and_expectation(render, tmp_path, block, message):
    for name in ("broken.png", "broken.exr"):
        (tmp_path / name).write_bytes(b"not a picture at all")
    text = scene(sphere(f"\n{block}\n"))
    line = text[:text.index(block)].count("\n") + 1
    result = render(text, fails=True)
    assert result.status == 1, result.log
    log = result.message
    assert "Parse Error" in log and message in log, log
    assert f"'scene.pov' line {line}" in log or f"'scene.pov' line {line + 1}" in log, log
    assert log.count("Parse Error") == 1, log


@pytest.mark.parametrize("block, hint", [
    ("diffuse .5", "; a block's diffuse part is a model and a colour, as in diffuse lambert rgb .3; POV-Ray's own diffuse stands in finish"),
    ("metallic", "the metal's colour follows specular."), ("normal { bumps .2 }", "'normal' stands in the texture, beside finish { }, and moves"),
    ("occlusion sky", "'occlusion' belongs in fabric { }."), ("fabric { crimp .2 }", "'crimp' belongs in warp { }, weft { } or yarns { }"),
    ("preset \"brushed_steel\" mm_per_unit 300", "'mm_per_unit' belongs in fabric { } or scratches { }."),
    ("crosings 3", "did you mean 'crossings', which belongs in fabric { }?"), ("detail crossings", "'crossings' belongs in fabric { }."),
    ("ashik 3, 4", "did you mean 'ashikhmin_shirley'?"), ("at y", "'at' follows tangent radial <axis>."),
    ("stretgh 3", "did you mean 'stretch', which belongs in layer { } of scratches { }?"),  # nearer than the strength of bump_image { }
    ("scratches { pits 3 }", "'pits' belongs in layer { } of scratches { }."), ("schlick", "'schlick' follows fresnel.")])
def test_an_error_tells_where_a_word_belongs(render, block, hint):
    result = render(scene(sphere(block)), (8, 8), fails=True)
    assert result.status == 1 and hint in result.message, result.message


@pytest.mark.parametrize("block, said", [
    ("scratches on", "mdf: expected '{' or 'off' after 'scratches', as in scratches { preset \"brushed_steel\" }, but found on."),
    ("fabric \"denim\"", "mdf: expected '{' or 'off' after 'fabric', as in fabric { preset \"denim\" }, but found a text in quotes."),
    ("fabric preset \"denim\"", "after 'fabric', as in fabric { preset \"denim\" }, but found 'preset'."),
    ("fabric { preset \"brushed_steel\" }", "\"brushed_steel\" is a metal: mdf { preset \"brushed_steel\" }."),
    ("scratches { preset \"denim\" }", "\"denim\" is a cloth: mdf { preset \"denim\" }."),
    ("preset \"denim\" { crossings 3 }", "{ found instead; 'preset' takes no braces."),
    ("roughness .1, .2, .3", "a comma found instead; 'roughness' takes no more than what stands before that."),
    ("roughness <.1, .2>", "mdf: roughness needs a number, a vector or colour found instead."),
    ("ggx rgb .1, .2", "mdf: ggx: alpha along needs a number, rgb found instead."),
    ("ggx = .1, .2", "mdf: ggx: alpha along needs a number, = found instead."),
    ("fresnel schlick .04", "a number found instead; 'fresnel' takes no more"), ("specular .5 .5", "a number found instead; 'specular' takes no more"),
    ("reflection { samples 4, 5 }", "a comma found instead; 'samples' takes no more"),
    ("fabric { seed 3 <1, 2> }", "< found instead; 'seed' takes no more"), ("fabric { warp { width .5 .5 } }", "a number found instead; 'width' takes no more"),
    ("scratches { mm_per_unit 10 20 }", "'mm_per_unit' takes no more"), ("scratches { layer { pits 3, 4 } }", "'pits' takes no more"),
    ("bump_image { strength 1 1 }", "'strength' takes no more"),
    ("fabric { crossings \"many\" }", "mdf: crossings needs a number or <of u, of v>, a text in quotes found instead."),
    ("fabric { crossings many }", "mdf: crossings needs a number or <of u, of v>, 'many' found instead."),
    ("fabric { crossings <1, 2, 3> }", "mdf: crossings needs a number or <of u, of v>, a vector of 3 numbers found instead."),
    ("bump_image { png \"a.png\" scale }", "mdf: bump_image scale needs a number or <of u, of v>, } found instead."),
    ("bump_image { png a.png }", "mdf: expected the name of a file, in quotes, after 'png', but found 'a'."),
    ("fabric { shadows yes }", "mdf: expected 'on' or 'off' after 'shadows', but found yes."), ("notes \"on\"", "'on' or 'off' after 'notes', but found a text in quotes."),
    ("bump_image { filter 2 }", "after 'filter', but found a number."), ("tangent \"x\"", "Expected 'uv, radial or a vector', a text in quotes found instead"),
    ("tangent uv uv", "undeclared identifier 'uv' found instead; 'uv' follows tangent."),
    ("ggx (.1, .2)", "; mdf: ggx: alpha along needs a number."), ("roughness (0.3", "; mdf: roughness needs a number."),
    ("specular rgb", "; mdf: specular needs a colour."), ("specular color", "mdf: specular needs a colour, } found instead."), ("tangent <1, 0", "; mdf: tangent needs uv, radial or a vector, as x."),
    ("fabric { crossings <400, }", "; mdf: crossings needs a number or <of u, of v>."),
    ("bump_image { png concat(\"a\", ) }", "; mdf: png needs the name of a file, in quotes."),
    ("#declare F = finish { } F", "finish identifier found instead; what a finish begins with stands before its block: finish { NAME mdf { } }"),
    ("alpha .1", "as in ggx .1, .3.")])
def test_mistakes_are_named(render, block, said):
    text = scene(sphere(f"\n{block}\n"))
    result = render(text, (8, 8), fails=True)
    line = text[:text.index(f"\n{block}")].count("\n") + 2
    assert result.status == 1 and said in result.message, result.message
    assert f"'scene.pov' line {line}" in result.message or f"'scene.pov' line {line + 1}" in result.message, result.message


@pytest.mark.parametrize("finish, said", [
    ("finish { mfd { } }", "No matching } in 'finish', 'mfd' found instead; did you mean 'mdf'?"), ("finish { MDF { } }", "did you mean 'mdf'?"),
    ("finish { mdf 3 }", "mdf: expected '{' or 'off' after 'mdf', but found a number."), ("finish { mdf on }", "mdf: expected '{' or 'off' after 'mdf', but found on."),
    ("finish { ambient 0 } mdf { }", "No matching } in 'texture', 'mdf' found instead; 'mdf' stands in finish { }."),
    ("finish { preset \"denim\" }", "No matching } in 'finish', 'preset' found instead; a word of that name stands in mdf { } of a finish."),
    ("finish { mdf { ggx .1, .2 //", f"Expected '{WORDS}', the end of the file found instead."), ("finish { mdf { ggx //", "mdf: ggx: alpha along needs a number, the end of the file found instead."),
    ("finish { mdf { notes on fabric //", "mdf: expected '{' or 'off' after 'fabric', as in fabric { preset \"denim\" }, but found the end of the file."),
    ("finish { scratches { } }", "'scratches' found instead; a word of that name stands in mdf { } of a finish."),
    ("finish { shiny 1 }", "No matching } in 'finish', undeclared identifier 'shiny' found instead")])
def test_a_block_in_the_wrong_place_is_named(render, finish, said):
    result = render(scene(f"sphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} {finish} }} }}"), (8, 8), fails=True)
    assert result.status == 1 and said in result.message and "'scene.pov' line 6" in result.message, result.message


def test_a_scenes_own_variables_may_be_named_like_words(render, material):
    """Where a number, a colour or a text is due, and within expressions."""
    before = ("#declare across = 40; #declare detail = 7; #declare preset = \"brushed_gold\"; #declare fibre = rgb <.1, .2, .3>; #declare layer = array[2] { 3, 4 };\n"
              "#macro gap(A) 2 * A #end #declare crossings = <30, 20>; #declare weave = \"plain\";\n")
    m = material("ashikhmin_shirley detail, detail * detail + layer[1] specular rgb detail / 10 - fibre detail none", before)
    assert (m["ex"], m["ey"], m["detail"]) == (7, 53, "none") and m["f0"] == pytest.approx([.6, .5, .4], abs=1e-6)
    m = material("ggx layer[0] / 10 across / 100 specular fibre tangent <detail, across, 0>", before)
    assert (m["ax"], m["ay"]) == (.3, .4) and m["f0"] == pytest.approx([.1, .2, .3], abs=1e-6)
    gold = material("preset preset scratches off", before)
    assert gold["fresnel"] == "conductor" and gold["eta"] == material('preset "brushed_gold" scratches off')["eta"]
    words = "fabric {{ weave {} crossings {} warp {{ along {} across {} width {} diffuse rgb {} }} }}"
    own = material(words.format("weave", "crossings", "detail", "across", "gap(.4)", "fibre"), before)
    plain = material(words.format('"plain"', "<30, 20>", "7", "40", ".8", "<.1, .2, .3>"))
    assert {k: v for k, v in own.items() if k != "name"} == {k: v for k, v in plain.items() if k != "name"}


@pytest.mark.parametrize("block, objects, message", [
    ("ashikhmin_shirley 2e6, 1", None, "exponent along is 2e+06; it is taken as 1e+06."),
    ("ashikhmin_shirley 5, -1e-3", None, "exponent across is -0.001; it is taken as 0."),
    ("ggx 20, .5", None, "alpha along is 20; it is taken as 10."),
    ("ggx .1, 1.5", None, "alpha across (scene.pov:6) is 1.5: above 1 there is no highlight left; exponents are read by ashikhmin_shirley."),
    ("ashikhmin_shirley .1, .3", None, "exponent along (scene.pov:6) is 0.1: below 1 there is no highlight left; alphas are read by ggx, beckmann and ward."),
    ("roughness 1.5", None, "roughness (scene.pov:6) is 1.5: above 1 there is no highlight left."),
    ("ggx .3, .6 horizon mutual", None, "'horizon mutual' (scene.pov:6) is 'horizon hard' here: its texture has no bumps."),
    ("roughness -2, .1", None, "roughness is -2; it is taken as 1e-06."),
    ("specular rgb <1.5, -1, .5>", None, "specular is <1.5, -1, 0.5>; it is taken as <1, 0, 0.5>."),
    ("bump_image { png \"flat.png\" strength -1 }", None, "bump_image strength is -1; it is taken as 0."),
    ("tangent uv", saddle(2, uv=False, extra="texture { TEXTURE } }"), "'tangent uv' (scene.pov:6) on a mesh without UV coordinates: strokes run along its x axis."),
    ("tangent uv", "cone { -y, 1, y, 0 texture { checker texture { pigment { rgb 1 } } texture { TEXTURE } } }", "strokes run around its axis."),
    ("bump_image { png \"flat.png\" }", "plane { y, 0 texture { TEXTURE } }", "'bump_image' (scene.pov:6) on a plane or disc, which has no UV coordinates: it has no effect there."),
    ("bump_image { png \"flat.png\" }", saddle(2, uv=False, extra="texture { TEXTURE } }"), "'bump_image' (scene.pov:6) on a mesh without UV")])
def test_warnings(render, shade_check, tmp_path, block, objects, message):
    from test_bump_image import write_png
    write_png(tmp_path / "flat.png", np.full((2, 2, 3), (128, 128, 255)), "uint8")
    texture = f"pigment {{ rgb 1 }} finish {{ ambient 0 diffuse 0 mdf {{ {block} }} }}"
    objects = (objects or "sphere { 0, 1 texture { TEXTURE } }").replace("texture { TEXTURE }", "texture { T }")
    result = render(HEADER + SUN + f"\n#declare T = texture {{ {texture} }}\n{objects}\n")
    assert "Parse Warning" in result.message and message in result.message, result.log
    dump = result.dump
    assert dump.hit.any() and np.isfinite(dump.S).all()
    assert result.message.count(message) == 1
    if not {"2e6,", "-2,"} & set(block.split()):  # a lobe that narrow cannot be checked through float32 directions
        shade_check(dump)


def told_by_the_manual():
    """Words of blocks in docs/povray/reference.md: {(block, word): (its default or None, its range or None)}, where these are numbers."""
    text = (Path(__file__).resolve().parents[2] / "docs/povray/reference.md").read_text(encoding="utf-8")
    said = {}
    for block, inside in re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", text, re.M | re.S):
        for word, about in re.findall(r"^### (\w+)\n.*?```\n\n(.*?)(?=^###|\Z)", inside, re.M | re.S):
            number = re.match(r"Default `(?:rgb )?([\d.e-]+)`", about)
            limits = re.search(r"[Rr]ange `([^`]+)` to `([^`]+)`", about)
            said[block, word] = (float(number[1]) if number else None,
                                 [float(end) if "pi" not in end else np.copysign(np.pi / 2, -1 if "-" in end else 1) for end in limits.groups()] if limits else None)
    return said


# Where the words of a section stand, and what a warning says before their name
BLOCKS = {"fabric": ('fabric {{ weave "plain" {} }}', ""), "warp, weft and yarns": ('fabric {{ weave "plain" weft {{ {} }} }}', "weft: "), "scratches": ("scratches {{ {} }}", ""),
          "layer": ("scratches {{ layer {{ {} }} }}", ""), "reflection": ("reflection {{ {} }}", "reflection ")}


def test_numbers_are_taken_as_the_manual_says(render):
    """Beyond a range the nearest within, which is said; without a word its default."""
    words = {key: limits for key, (_number, limits) in told_by_the_manual().items() if key[0] in BLOCKS and limits and key[1] != "diffuse"}
    words |= {("layer", "spread"): [0, 90], ("reflection", "samples"): [1, 4096]}
    assert len(words) > 30
    finishes, wanted = "", []
    for (block, word), (low, high) in words.items():
        for beyond, taken in ((low - abs(low) - 1, low), (3 * high, high)):
            given = f"<{beyond:g}, {low:g}, {high:g}>" if word in ("specular", "transmit", "backing", "nap_color") else f"{beyond:g}"
            taken = f"<{taken:g}, {low:g}, {high:g}>" if given[0] == "<" else f"{taken:g}"
            pair = f"{given}, {low:g}" if word in ("stretch", "depth") else given
            finishes += f"#declare F = finish {{ mdf {{ {BLOCKS[block][0].format(f'{word} {pair}')} }} }}\n"
            wanted.append(f"mdf: {BLOCKS[block][1]}{word} is {given}; it is taken as {taken}.")
    result = render(scene(finishes), (8, 6), dump=False)
    assert [text for text in wanted if text not in result.message] == []
    within = "".join(f"#declare F = finish {{ mdf {{ {BLOCKS[block][0].format(f'{word} ' + ', '.join([f'{end:.17g}'] * (1 + (word in ('stretch', 'depth')))))} }} }}\n"
                     for (block, word), ends in words.items() for end in ends if word not in ("ends_per_cm", "picks_per_cm", "tile_mm"))
    assert "it is taken as" not in render(scene(within), (8, 6), dump=False).message


# What is taken as it stands, and what is cut, with the warning; a person's
AS_IT_STANDS = ["tangent <1e-9, 0, 0>", "roughness 1", "ggx 1, 1", "ward 1, .5", "ashikhmin_shirley 1, 1", "reflection { samples 4096 clamp 0 }", "scratches { " + 8 * "layer { pits 1 } " + "}",
                "fabric { weave 4095, 1, 0 }", "fabric { weave 1, 0, -3 }", "scratches { layer { spread 90 direction -500 } }", "scratches { seed 1e12 }", "fabric { seed -5 }",
                "horizon mutual slopes .1, .1, .2, .2, .2", "roughness .5, .25"]
CUT = [("reflection { samples 2.5 }", "reflection samples is 2.5; it is taken as 2."), ("scratches { layer { pits 2.5 } }", "pits is 2.5; it is taken as 2."),
       ("reflection { clamp -2 }", "reflection clamp is -2; it is taken as 0."), ("roughness 1e-7", "roughness is 1e-07; it is taken as 1e-06."),
       ("horizon mutual slopes 0, 0, .2, .3, .2", "slopes xy is 0.3; it is taken as 0.2."), ("horizon mutual slopes 0, 0, -1, 0, .2", "slopes xx is -1; it is taken as 0.")]


def test_what_is_taken_as_it_stands(render):
    begin = NEWER + "#declare F = finish {{ mdf {{ {} }} }}\n"
    assert "mdf:" not in render(scene("".join(begin.format(block) for block in AS_IT_STANDS)), (8, 6), dump=False).message
    said = render(scene("".join(begin.format(block) for block, _ in CUT)), (8, 6), dump=False).message
    assert [warning for _, warning in CUT if f"mdf: {warning}" not in said] == [] and said.count("mdf:") == len(CUT), said


def test_defaults_are_the_manuals(material):
    names = {"specular": "f0", "transmit": "weft_transmit"}
    made = material('fabric { weave "plain" }')["fabric"]
    found = {**made["yarns"]["weft"], **made["cloth"]["weft"], "weft_transmit": made["cloth"]["weft_transmit"], "backing": made["cloth"]["backing"],
             "nap": made["cloth"]["nap"], "nap_color": made["cloth"]["nap_color"]}
    asked = {word: number for (block, word), (number, _limits) in told_by_the_manual().items() if block == "warp, weft and yarns" and number is not None}
    asked |= {"backing": 0, "nap": 0, "nap_color": .5}
    assert len(asked) > 20
    assert {word: np.mean(found[names.get(word, word)]) for word in asked} == pytest.approx(asked, rel=1e-6)


def test_blocks_are_found_wherever_a_texture_stands(render):
    """Each says its notes once."""
    lines = {}
    def block(name):
        lines[name] = len(lines)
        return f"texture {{ pigment {{ rgb 1 }}\nfinish {{ mdf {{ ggx .{2 * len(lines) + 101}, .5 notes on }} }} }}"
    plain = "texture { pigment { rgb 1 } }"
    mesh = "mesh { triangle { -x, x, y texture { In_Mesh } } triangle { -x, x, -y texture { Also } } }"
    objects = [f"sphere {{ 0, 1 {block('plain')} }}", f"sphere {{ 0, 1 {plain} {block('layer').replace('rgb 1', 'rgbt 1')} }}",
               f"sphere {{ 0, 1 texture {{ gradient x texture_map {{ [0 {block('map')[10:-1]}] [1 pigment {{ rgb 1 }}] }} }} }}",
               f"sphere {{ 0, 1 texture {{ average texture_map {{ [1 {block('average')[10:-1]}] [1 pigment {{ rgb 1 }}] }} }} }}",
               f"sphere {{ 0, 1 texture {{ checker {plain} {block('checker')} }} }}",
               f"sphere {{ 0, 1 texture {{ material_map {{ png \"two.png\" {plain} {block('material_map')} }} }} }}",
               f"box {{ 0, 1 {plain} interior_{block('inside')} }}",
               f"#declare In_Mesh = {block('mesh')};", f"#declare Also = {block('also')};", mesh,
               f"blob {{ threshold .5 sphere {{ 0, 1, 1 {block('blob')} }} }}", f"union {{ sphere {{ 0, 1 }} sphere {{ y, 1 {block('union')} }} }}"]
    from test_bump_image import write_png
    write_png(Path(render(scene("")).image_path).parent / "two.png", np.zeros((2, 2, 3)), "uint8")
    message = render(scene("\n".join(objects)), (8, 6), dump=False).message
    assert {name: message.count(f"lobe: ggx 0.{2 * k + 103}, 0.5") for name, k in lines.items()} == dict.fromkeys(lines, 1), message


def test_parts_that_are_said_again_begin_anew(render, tmp_path):
    """A bump_image, a reflection or a tangent in place of that of the finish before has nothing of it left; what is not said again stays."""
    from test_bump_image import write_png
    write_png(tmp_path / "map.png", np.random.default_rng(3).integers(90, 166, (4, 4, 3)), "uint8")
    before = 'bump_image { png "map.png" strength .3 filter off once scale 3 translate <.2, .1> } reflection { samples 5 clamp 2 } tangent radial y at <5, 0, 0>'
    again = 'bump_image { png "map.png" } reflection { } tangent radial y'

    def shown(words, begin=""):
        result = render(scene(f"#declare F = finish {{ ambient 0 diffuse 0 mdf {{ {before} }} }}\n"
                              f"sphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} finish {{ {begin} ambient 0 diffuse 0 mdf {{ {words} notes on }} }} }} }}", SUN), (16, 12))
        return result.message[result.message.index("bumps: an image"):].split("most of their noise")[0], result.dump
    (own, shape), (said, anew), (kept, _) = shown(again), shown(again, "F"), shown("", "F")
    assert said == own and "strength 1; below a pixel they are roughness reflection" in own and "5 rays" not in own and "brighter" not in own
    assert "strength 0.3, unfiltered, once reflection: 5 rays at a hit, none brighter than 2;" in kept, kept
    assert np.array_equal(shape.Ns, anew.Ns) and np.array_equal(shape.T, anew.T) and np.ptp(shape.Ns[shape.hit] - shape.N[shape.hit]) > .05


def test_subsurface_needs_diffuse_light(render):
    """A colour without green or blue has enough of it, also where no block is: POV-Ray ended there."""
    head = HEADER.replace("assumed_gamma 1", "assumed_gamma 1 mm_per_unit 20 subsurface { samples 4, 1 }")
    ball = "sphere {{ 0, 1 texture {{ pigment {{ rgb <.8, 0, 0> }} finish {{ ambient 0 diffuse {} subsurface {{ translucency .3 }} {} }} }} interior {{ ior 1.4 }} }}"
    mdf = "mdf { specular 0 }"
    refused = render(head + SUN + "\n" + ball.format(0, mdf), (8, 6), dump=False, fails=True)
    assert refused.status == 1 and "has 'subsurface' and 'diffuse 0': what is scattered below the surface is the finish's diffuse light." in refused.message, refused.message
    for finish in (ball.format(.6, mdf), ball.format(.6, "")):
        image = render(head + SUN + finish, (8, 6), dump=False).image
        assert image[..., 0].max() > .01 and np.abs(image[..., 1:]).max() < 1e-3


def test_a_message_comes_once(render):
    text = scene("#declare I = 0; #while (I < 4) sphere { I * x, .4 texture { pigment { rgb 1 } finish { mdf { specular\n2\n\n\n } } } } #declare I = I + 1; #end")
    message = render(text).message
    assert message.count("it is taken as") == 1 and "'scene.pov' line 7" in message, message


GAMMAS = [("3.7", "assumed_gamma 1", False), ("3.7", "", False), ("3.7", "assumed_gamma 2.2", True), ("3.7", "assumed_gamma srgb", True),
          ("3.6", "assumed_gamma 1", False), ("3.6", "assumed_gamma 2.2", True), ("3.6", "", True)]


@pytest.mark.parametrize("version, settings, darker, block", [
    *((*gamma, 'preset "brushed_brass"') for gamma in GAMMAS), *((*gamma, 'fabric { preset "denim" }') for gamma in (GAMMAS[0], GAMMAS[6])),
    (*GAMMAS[2], "specular rgb .5"), (*GAMMAS[6], "specular rgb .5")])
def test_presets_tell_of_a_gamma_that_darkens_them(render, version, settings, darker, block):
    head = HEADER.replace("#version 3.7;", f"#version {version};").replace("global_settings { assumed_gamma 1 }", f"global_settings {{ {settings} }}")
    assert head != HEADER or (version, settings) == ("3.7", "assumed_gamma 1")
    ball = f"sphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} finish {{ mdf {{ {block} }} }} }} }}\n"
    result = render(head + SUN + ball + ball, (8, 6), dump=False)
    assert result.message.count("made for assumed_gamma 1.0") == (darker and "preset" in block)


def test_scenes_can_ask_for_the_block(render, unpatched, tmp_path):
    text = scene("#ifdef (mdf_Version) #if (mdf_Version < 2) #error \"old\" #end sphere { 0, 1 finish { mdf { } } }\n#else sphere { 0, 1 } #warning \"stock\" #end\n")
    assert render(text).dump.hit.any()
    done = subprocess.run([unpatched, "+Iscene.pov", "+Ostock.png", "+W8", "+H8", "-D"], cwd=tmp_path, text=True, errors="replace",
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
    assert done.returncode == 0 and "stock" in done.stdout, done.stdout


@pytest.mark.parametrize("words, ex, ey", [("roughness .05", 20, 20), ("roughness 1/300, .1", 300, 10), ("roughness .02 .1", 50, 10), ("ggx .3, .3 roughness .02 detail none", 50, 50)])
def test_roughness_sets_exponents(material, words, ex, ey):
    m = material(words)
    assert (m["ex"], m["ey"]) == pytest.approx((ex, ey), rel=1e-12)
    assert (m["ax"], m["ay"]) == pytest.approx((np.sqrt(2 / (ex + 2)), np.sqrt(2 / (ey + 2))), rel=1e-12)


def test_roughness_is_as_wide_as_that_of_the_word_specular(render):
    """Both are (h.n)^(1/roughness); what else stands in Ashikhmin and Shirley's formula is divided out."""
    text = "sphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} finish {{ ambient 0 diffuse 0 {} }} }} }}"
    stock = render(scene(text.format("specular 1 roughness .05"), SUN), dump=False).image[..., 0]
    result = render(scene(text.format("mdf { roughness .05 detail none horizon hard }"), SUN))
    dump = result.dump
    unit = lambda v: v / np.linalg.norm(v, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore"):
        h = unit(dump.L[0] + dump.V)
        nl, nv, hv = (np.sum(a * b, -1) for a, b in ((dump.N, dump.L[0]), (dump.N, dump.V), (h, dump.V)))
        expected = stock * 21 / 8 * nl / (hv * np.maximum(nl, nv))
    bright = dump.hit & (stock > .02) & (nl > .1)
    assert bright.sum() > 200
    np.testing.assert_allclose(result.image[..., 0][bright], expected[bright], rtol=3e-3)


def test_default_tangent_needs_no_uv_and_no_warning(render):
    result = render(scene("plane { y, 0 pigment { rgb 1 } finish { ambient 0 mdf { } } }"))
    assert "Warning:" not in result.log
    dump = result.dump
    np.testing.assert_allclose(dump.T[dump.hit], np.tile([1, 0, 0], (dump.hit.sum(), 1)), atol=1e-7)


def test_mesh_with_a_collapsed_uv_triangle_warns(render):
    mesh = """mesh2 { vertex_vectors { 4, <-1,0,-1>, <1,0,-1>, <1,0,1>, <-1,0,1> } uv_vectors { 4, <0,0>, <1,0>, <1,1>, <.5,.5> }
      face_indices { 2, <0,1,2>, <0,2,3> } uv_indices { 2, <0,1,2>, <0,2,3> } pigment { rgb 1 } finish { mdf { } } }"""
    result = render(scene(mesh))
    assert "have no UV area around them" in result.message
    assert np.isfinite(result.dump.T).all()


def test_mdf_is_reserved_only_as_such(render):
    result = render(scene("#declare mdf = 3; sphere { 0, 1 pigment { rgb 1 } }"), fails=True, dump=False)
    assert result.status == 1 and "mdf found instead" in result.message


def test_the_list_for_editors_is_what_the_parser_takes(povray, render):
    """What a block says that it expects, and what the list for editors has."""
    lines = [line.split() for line in (Path(povray).parent / "editor/words.txt").read_text().splitlines()]
    for place, before, after in (("mdf", "", ""), ("reflection", "reflection {", "}"), ("fabric", "fabric {", "}"), ("warp", "fabric { warp {", "} }"),
                                 ("scratches", "scratches {", "}"), ("bump_image", "bump_image {", "}"), ("fresnel", "fresnel", "")):
        message = render(scene(sphere(f"{before} Zzzzz {after}", "#declare Zzzzz = 1;")), (8, 8), fails=True).message
        expected = re.search(r"Expected '(.*)', ", " ".join(message.split())).group(1)
        assert sorted(re.split(r", | or ", expected.removesuffix(" or }"))) == sorted(w for p, w in lines if p == place), place
    vim = (Path(povray).parent / "editor/pov.vim").read_text()
    assert {line.split()[-1] for line in vim.splitlines() if line.startswith("syn keyword")} == {w for _, w in lines}
    assert all(line.startswith("syn keyword povMdf ") for line in vim.splitlines()[1:-1]) and vim.endswith("\nhi def link povMdf Statement\n") and vim.startswith('" ')
    assert {("tangent", "at"), ("occlusion", "sky"), ("layer", "pits"), ("finish", "mdf"), ("detail", "rotate")} <= {tuple(line) for line in lines}
    for form, status, stream in (([], 2, "usage: words text | vim"), (["html"], 2, "usage: "), (["vim"], 0, "")):
        done = subprocess.run([Path(povray).parent / "editor/words", *form], text=True, capture_output=True)
        assert done.returncode == status and done.stderr.startswith(stream) and bool(done.stdout) == (status == 0)


# What a message says of words, asked of its own source: calls, words and what comes of them, a line each
ASKS = r"""
#include <iostream>
#include <sstream>
#include "backend/mdf/words.h"
using namespace mdf;
static const char *const names[] = {"none", "mdf", "tangent", "radial", "bump_image", "reflection", "fabric", "warp", "occlusion", "scratches", "layer"};
static WordSet set_of(const std::string &name) {
  for (int k = 0; k < (int)WORDS_LIST; k++)
    if (name == names[k])
      return (WordSet)k;
  for (int k = 0; k < SHADE_LIST_COUNT; k++)
    if (name == shade_list_name((shade_list)k))
      return words_of_list((shade_list)k);
  return WORDS_NONE;
}
int main() {
  std::string line, call, place, text, after;
  while (std::getline(std::cin, line)) {
    std::istringstream in(line);
    std::getline(in, call, '\t'), std::getline(in, place, '\t'), std::getline(in, text, '\t'), std::getline(in, after, '\t');
    const WordSet set = set_of(place);
    std::cout << (call == "hint" ? hint_for(set, text, in ? after : "") : call == "misspelt" ? hint_for_misspelt(set, text) :
                  call == "nearest" ? nearest_word(set, text) : call == "outside" ? hint_outside(text) :
                  call == "name" ? nearest_name(words_in(set), text) : plain_token(text)) << "\n";
    after.clear();
  }
}
"""
BESIDE, FINISH, NUMBERS, NONE = "stands in the texture, beside finish { }", "stands in finish { }, beside mdf { }", "is none of the block's words: a distribution's name with its numbers", ""
SAID = [
    *(("hint", "mdf", word, f"'{word}' {BESIDE}") for word in ("pigment", "texture", "finish", "rotate", "translate", "scale", "matrix", "transform", "turbulence")),
    *(("hint", "mdf", word, f"'{word}' {BESIDE}, and moves the block's highlight too") for word in ("normal", "bump_map", "slope_map")),
    *(("hint", "mdf", word, f"'{word}' {FINISH}") for word in ("ambient", "emission", "phong", "phong_size", "brilliance", "irid", "conserve_energy", "crand", "subsurface")),
    *(("hint", "mdf", word, f"'{word}' begins a colour, which follows the word that it is of") for word in ("rgb", "rgbf", "rgbt", "rgbft", "srgb", "color", "colour", "red", "green", "blue")),
    *(("hint", "mdf", word, f"'{word}' is none of the block's words: two exponents follow ashikhmin_shirley") for word in ("exponent", "exponents", "nu", "nv")),
    *(("hint", "mdf", word, f"'{word}' {NUMBERS}") for word in ("alpha", "alphas", "type", "distribution", "anisotropy", "anisotropic", "mdf")),
    *(("hint", "mdf", word, f"'{word}' stands in the object's interior") for word in ("ior", "interior")), ("hint", "mdf", "metallic", "'metallic' is what a block is without it"),
    ("hint", "mdf", "warp", "'warp' belongs in fabric { }"), ("hint", "warp", "warp", f"'warp' {BESIDE}"), ("hint", "mdf", "nothing", NONE), ("hint", "mdf", "", NONE), ("hint", "mdf", "am", NONE),
    *(("hint", "bump_image", word, "a picture of another format is to be converted first") for word in ("jpeg", "tiff", "gif", "tga", "iff", "ppm", "pgm", "sys", "hdr")),
    ("hint", "mdf", "jpeg", NONE), ("hint", "bump_image", "jpe", NONE),
    *(("hint", place, "linen", "a preset's name stands in quotes after preset: preset \"linen\"") for place in ("mdf", "fabric", "scratches")), ("hint", "warp", "linen", NONE),
    *(("hint", place, "string literal", "a preset's name follows preset") for place in ("mdf", "fabric", "scratches")),
    ("hint", "bump_image", "string literal", "a file's name follows png or exr"), ("hint", "warp", "string literal", NONE),
    *(("hint", "mdf", f"{what} identifier", "what a finish begins with stands before its block") for what in ("finish", "texture")), ("hint", "mdf", "pigment identifier", NONE),
    *(("hint", "mdf", found, "'ggx' takes no more than what stands before that", "ggx") for found in ("float constant", "vector identifier", "color identifier", "<", ",")),
    ("hint", "mdf", "{", "'notes' takes no braces", "notes"), ("hint", "mdf", "float constant", NONE), ("hint", "mdf", "floating", NONE, "ggx"),
    ("hint", "diffuse", "float constant", "a block's diffuse part is a model and a colour"), ("hint", "fresnel", "on", "as in fresnel schlick"), ("hint", "detail", "rgb", NONE),
    *(("hint", place, word, f"'{word}' {where}") for place, word, where in (
        ("fabric", "tangent", "belongs in mdf { } itself"), ("mdf", "crossings", "belongs in fabric { }"), ("layer", "crimp", "belongs in warp { }, weft { } or yarns { } of fabric { }"),
        ("layer", "tile_mm", "belongs in scratches { }"), ("mdf", "pits", "belongs in layer { } of scratches { }"), ("mdf", "strength", "belongs in bump_image { }"),
        ("mdf", "clamp", "belongs in reflection { }"), ("mdf", "at", "follows tangent radial <axis>"), ("mdf", "uv", "follows tangent"), ("mdf", "schlick", "follows fresnel"),
        ("mdf", "microfacet", "follows brdf"), ("mdf", "lambert", "follows diffuse"), ("mdf", "seed", "belongs in fabric { } or scratches { }"), ("warp", "seed", "belongs in fabric { }"),
        ("layer", "seed", "belongs in scratches { }"), ("fabric", "width", "belongs in warp { }, weft { } or yarns { } of fabric { }"), ("reflection", "preset", "belongs in mdf { } itself"),
        ("scratches", "radius", "belongs in layer { } of scratches { }"), ("tangent", "clamp", "belongs in reflection { }"))),
    ("hint", "brdf", "ggx", "'ggx' belongs in mdf { } itself"), ("nearest", "horizon", "estevz", "estevez"), ("nearest", "tangent", "vu", "uv"),
    ("nearest", "diffuse", "fiber", "fibre"), ("nearest", "detail", "grad_schmidt", "gram_schmidt"), ("nearest", "mdf", "fresnl", "fresnel"),
    ("nearest", "mdf", "GGX", "ggx"), ("nearest", "mdf", "xgg", NONE), ("nearest", "mdf", "gg", "ggx"), ("nearest", "mdf", "fresn", "fresnel"), ("nearest", "mdf", "rflection", "reflection"),
    ("nearest", "mdf", "erflection", "reflection"), ("nearest", "mdf", "reflecction", "reflection"), ("nearest", "mdf", "reflextiom", "reflection"), ("nearest", "mdf", "rxflextiom", "reflection"),
    ("nearest", "mdf", "rxfxextiom", NONE), ("nearest", "mdf", "x", NONE), ("nearest", "mdf", "fab", "fabric"), ("nearest", "mdf", "fa", NONE), ("nearest", "mdf", "multi", "multiscatter"),
    ("nearest", "mdf", "axhixhmix_shirley", "ashikhmin_shirley"), ("nearest", "mdf", "axhixhmix_xhirley", NONE), ("nearest", "mdf", "ashikhmin" + 32 * "x", NONE), ("nearest", "mdf", "", NONE),
    ("name", "reflection", "sample", ' Did you mean "samples"?'), ("name", "reflection", "zzz", NONE),
    ("misspelt", "mdf", "crosings", "did you mean 'crossings', which belongs in fabric { }?"), ("misspelt", "mdf", "zzzzz", NONE), ("misspelt", "fabric", "tangnt", "did you mean 'tangent', which belongs in mdf { } itself?"),
    ("outside", "none", "mdf", "'mdf' stands in finish { }."), ("outside", "none", "mfd", "did you mean 'mdf'?"), ("outside", "none", "pits", "a word of that name stands in mdf { } of a finish."),
    ("outside", "none", "at", NONE), ("outside", "none", "sphere", NONE), ("outside", "none", "schlick", NONE),
    ("token", "none", ", ", "a comma"), ("token", "none", ",", "a comma"), ("token", "none", "string literal", "a text in quotes"), ("token", "none", "float constant", "a number"),
    ("token", "none", "End of File", "the end of the file"), ("token", "none", "sphere", "sphere")]


def test_what_is_said_of_words(tmp_path):
    """Hints begin as here; what is nearest, and where a word belongs, is said whole."""
    (tmp_path / "asks.cpp").write_text(ASKS)
    (tmp_path / "backend").mkdir()
    (tmp_path / "backend/mdf").symlink_to(ROOT / "povray_patches/glue")
    subprocess.run(["g++", "-O0", f"-I{tmp_path}", f"-I{ROOT}/libshade/include", tmp_path / "asks.cpp", tmp_path / "backend/mdf/words.cpp", ROOT / "build/libshade.a",
                    "-lm", "-lpthread", "-o", tmp_path / "asks"], check=True)
    found = subprocess.run([tmp_path / "asks"], input="".join("\t".join((*row[:3], *row[4:])) + "\n" for row in SAID), capture_output=True, text=True, check=True).stdout.split("\n")
    assert len(found) == len(SAID) + 1
    wrong = [(row, text) for row, text in zip(SAID, found) if not text.startswith(row[3]) or bool(text) != bool(row[3]) or (row[0] in ("nearest", "name", "token") or " belongs in " in row[3]) and text != row[3]]
    assert not wrong, wrong


def test_a_block_is_taken_off(render):
    text = "#default { finish { ambient 0 diffuse .5 mdf { ggx .1, .3 } } }\nsphere { 0, 1 pigment { rgb 1 } finish { mdf off } }\n"
    plain = "#default { finish { ambient 0 diffuse .5 } }\nsphere { 0, 1 pigment { rgb 1 } }\n"
    assert (render(scene(text), dump=False).image == render(scene(plain), dump=False).image).all()


@pytest.mark.parametrize("words, said", [("tangent x fabric { }", "'tangent'"), ("preset \"linen\" specular rgb <1, 0, 0>", "'specular'"), ("ggx .1, .2 fabric { }", "'ggx' (scene.pov:7) has"),
                                         ("ggx .1, .2 specular .5 ggx .2, .2 tangent x scratches { } fabric { }", "'ggx', 'specular', 'tangent' and 'scratches' (scene.pov:7) have"),
                                         ("fabric { } reflection { } notes off", None), ("specular .5 fabric { } fabric off", None)])
def test_what_has_no_part_in_a_cloth_is_said(render, words, said):
    log = render(scene(sphere(words)), (8, 8)).message
    assert ("no part in a cloth; what its yarns are is said inside fabric { }." in log) == bool(said) and (said or "") in log


def test_notes_tell_a_block_once(render):
    block = ("finish { ambient .1 diffuse .4 emission rgb <.1, .1, .2> phong .3 specular .25 reflection .2 "
             "mdf { ggx .1, .3 fresnel schlick specular rgb <.9, .9, .4> diffuse fibre .1 reflection { samples 7 clamp 3 } notes on } }")
    result = render(scene("".join(f"sphere {{ {i}*x, 1 texture {{ pigment {{ rgb .5 }} Finish }} }}\n" for i in range(3)).replace("Finish", block, 3)), (16, 12))
    text = " ".join(result.log.split())
    assert text.count("mdf block at ") == 3  # three blocks, three places
    for part in ("lobe: ggx 0.1, 0.3; brdf ashikhmin_shirley, detail rotate, horizon valid_estevez", "colour: fresnel schlick, specular rgb <0.9, 0.9, 0.4>",
                 "diffuse: fibre rgb 0.1", "strokes: along u of each object",
                 "the finish adds to it: diffuse 0.4, specular 0.25, phong 0.3, emission rgb <0.1, 0.1, 0.2>, reflection rgb 0.2",
                 "reflection: 7 rays at a hit, none brighter than 3; +A0.3 +AM2 takes most of their noise", "ambient rgb 0.1 gives the pigment's colour alone"):
        assert text.count(part) == 3, part
    declared = f"#declare F = {block}\n" + "".join(f"sphere {{ {i}*x, 1 texture {{ pigment {{ rgb .5 }} finish {{ F }} }} }}\n" for i in range(3))
    assert render(scene(declared), (16, 12)).log.count("mdf block at ") == 1
    assert "mdf block at" not in render(scene(declared.replace("notes on", "notes off")), (16, 12)).log


def test_notes_tell_each_block_what_it_says(render):
    """Of cloths, strokes and rays: as the scene has them, or what a number was cut to."""
    blocks = ["fabric { weave \"plain\" crossings <30, 20> yarns { width .8 } weft { gap .2 } warp { diffuse rgb <.1, .2, .3> } weft { diffuse pigment } }",
              "fabric { ends_per_cm 7 picks_per_cm 3 mm_per_unit 50 yarns { gap .2 } warp { diffuse pigment } weft { diffuse rgb .4 } }",
              "ggx .1, .3 tangent <0, 1, 0> specular pigment multiscatter on", "ward .1, .1 tangent <3e200, 0, 4e200>", "ward .2, .2 tangent radial <0, 0, 1> at <1, 2, 3>",
              *(f"ggx .2, .2 reflection {{ samples {n} }}" for n in (1, 4090, 4096, 4097, .5))]
    text = "".join(f"sphere {{ {9 * k}*y, 1 texture {{ pigment {{ rgb .5 }} finish {{ ambient 0 diffuse 0 mdf {{ {block} notes on }} }} }} }}\n"
                   for k, block in enumerate(blocks, 1))
    log = render(scene(text), (8, 8), dump=False).log
    told = [" ".join(part.split()) for part in re.split("mdf block at ", log)[1:]]
    assert len(told) == len(blocks)
    for part, words in zip(told, (
            ("weave plain, 30 x 20 crossings on a unit", "warp: diffuse rgb <0.1, 0.2, 0.3>; weft: diffuse pigment"),
            ("35 x 15 crossings on a unit", "warp: diffuse pigment; weft: diffuse rgb 0.4 rays pass between its yarns"),
            ("lobe: ggx 0.1, 0.3", "valid_estevez, multiscatter on", "specular pigment", "strokes: along <0, 1, 0> of the texture's space"),
            ("lobe: ward 0.1, 0.1", "strokes: along <0.6, 0, 0.8>"),
            ("lobe: ward 0.2, 0.2", "strokes: round <0, 0, 1> at <1, 2, 3> of the texture's space"),
            *((f"reflection: {n} rays at a hit",) for n in (1, 4090, 4096, 4096, 1)))):
        assert all(word in part for word in words), (words, part)
    assert "rays pass" not in told[0]  # no gaps in the warp
    said = [words for words in log.split("Warning") if "reflection samples" in words]
    assert len(said) == 2 and "4097" in said[0] and "0.5" in said[1], said


# A block, what a finish that begins with it says, and what notes then tell of that, or not; a person's
TAKEN_OVER = [
    ('bump_image { png "flat.png" filter off once strength 2 }', "", "strength 2, unfiltered, once", "roughness"),
    ('bump_image { png "flat.png" filter off once strength 2 }', 'bump_image { png "flat.png" }', "strength 1; below a pixel they are roughness", "once"),
    ('bump_image { png "flat.png" }', 'bump_image { png "flat.png" once }', "below a pixel they are roughness, once", "unfiltered"),
    ("specular pigment diffuse lambert pigment", "", "specular pigment diffuse: lambert pigment", "conductor"),
    ("specular pigment diffuse lambert pigment", 'preset "brushed_gold"', "fresnel conductor", "pigment"),
    ("specular pigment", 'preset "brushed_gold" fresnel schlick', "specular rgb", "pigment"),
    ('preset "brushed_gold"', "", "a unit of u and v is 200 mm", "cloth"),
    ('preset "brushed_gold" scratches { mm_per_unit 70 }', 'preset "turned_steel"', "a unit of u and v is 70 mm", "cloth"),
    ('preset "brushed_gold"', "scratches off", "fresnel conductor", "scratches:"),
    ('preset "brushed_gold"', 'preset "denim"', "weave twill_3_1", "scratches:"),
    ('preset "denim"', 'preset "brushed_gold"', "fresnel conductor", "cloth:"),
    ('fabric { preset "denim" crossings 30 }', "", "30 x 30 crossings", "rays pass"),
    ('fabric { preset "denim" crossings 30 }', "fabric { mm_per_unit 100 }", "260 x 170 crossings", "rays pass"),
    ('fabric { preset "denim" mm_per_unit 100 }', "fabric { crossings <7, 9> }", "7 x 9 crossings", "rays pass"),
    ('fabric { preset "denim" yarns { diffuse pigment } }', "", "warp: diffuse pigment; weft: diffuse pigment", "shines through"),
    ('fabric { preset "denim" yarns { diffuse pigment } }', "fabric { weft { diffuse rgb .5 transmit rgb .1 } }",
     "warp: diffuse pigment; weft: diffuse rgb 0.5 light from behind shines through", "lobe:"),
    ("reflection { samples 7 clamp .3 }", "", "7 rays at a hit, none brighter than 0.3", "lambert"),
    ("reflection { samples 7 }", "reflection off reflection on", "7 rays at a hit", "brighter"),
    ('fabric { preset "denim" yarns { diffuse pigment } }', 'fabric { preset "denim" }', "warp: diffuse rgb", "pigment"),
    ("reflection { samples 7 clamp 3 }", "reflection { samples 9 }", "9 rays at a hit; ", "brighter"),
    ("tangent radial y at <1, 2, 3>", "", "round <0, 1, 0> at <1, 2, 3>", "along"),
    ("tangent radial y at <1, 2, 3>", "tangent radial z", "round <0, 0, 1> at <0, 0, 0>", "along"),
    ("tangent x", "tangent uv", "strokes: along u of each object", "texture's space"),
]


def test_what_a_finish_takes_over(render, tmp_path):
    """A part of a block that is written anew begins with its defaults; what is not stays."""
    from test_bump_image import write_png
    write_png(tmp_path / "flat.png", np.full((2, 2, 3), (128, 128, 255)), "uint8")
    balls = "".join(f"#declare F = finish {{ mdf {{ {first} }} }}\nsphere {{ 0, 1 texture {{ finish {{ F mdf {{ {then} notes on }} }} }} }}\n"
                    for first, then, _, _ in TAKEN_OVER)
    told = render(scene(balls), (8, 6), dump=False).message.split("mdf block at ")[1:]
    assert len(told) == len(TAKEN_OVER)
    for said, (first, then, wanted, unwanted) in zip(told, TAKEN_OVER):
        assert wanted in said and unwanted not in said.split("the finish adds")[0], (first, then, said)


# A finish, its block, and what notes tell and do not; a person's
NOTES = [
    ("ambient .1 diffuse .2 reflection { 0, .3 }", "ggx .1, .3", "diffuse 0.2, reflection rgb 0.3", "samples"),
    ("ambient .1 diffuse 0", "ggx .1, .3", "ambient rgb 0.1 gives the pigment's colour, and the block's albedo", "alone"),
    ("ambient rgb <.1, .2, .3> diffuse 0", "ggx .1, .3 reflection { }", "ambient rgb <0.1, 0.2, 0.3> gives the pigment's colour alone", "albedo"),
    ("ambient 0 diffuse 0", 'fabric { draft "two.wif" mm_per_unit 20 }', "a draft of 2 ends and 3 picks in its own colours, 20 x 10 crossings", "adds"),
    ("ambient 0 diffuse 0", 'fabric { ends_per_cm 50 draft "two.wif" mm_per_unit 20 draft_colors off }', "2 ends and 3 picks, 20 x 10 crossings", "colours"),
    ("ambient 0 diffuse 0", 'fabric { draft "two.wif" weave "satin_5" }', "weave satin_5, ", "draft"),
    ("ambient 0 diffuse 0", 'fabric { draft "two.wif" preset "denim" }', "weave twill_3_1, ", "draft"),
    ("ambient 0 diffuse 0", "fabric { yarns { slub .3 } }", "rays pass between its yarns", "shines"),
    ("ambient 0 diffuse 0", "fabric { yarns { gap .3 } backing rgb <0, .1, 0> }", "weave plain", "rays pass"),
    ("ambient 0 diffuse 0", "fabric { weft { transmit rgb <0, 0, .1> } }", "light from behind shines through its yarns", "rays"),
    ("ambient 0 diffuse 0", 'bump_image { png "flat.png" } horizon mutual slopes 0, 0, .1, 0, .1', "an image of 4 x 2, strength 1, unfiltered", "roughness"),
    ("ambient 0 diffuse 0", "horizon mutual slopes .01, 0, .25, .001, .25", "slopes 0, 0, 0.25, 0, 0.25 (deviations 0.5 along the strokes, 0.5 across)", "0.01"),
    ("ambient 0 diffuse 0", "horizon mutual slopes .1, 0, .25, -.02, .04", "slopes 0.1, 0, 0.25, -0.02, 0.04 (deviations 0.5 along the strokes, 0.2 across)", "unfiltered"),
]


def test_notes_of_each_kind(render, tmp_path):
    from test_bump_image import write_png
    from test_cloth import WIF
    write_png(tmp_path / "flat.png", np.full((2, 4, 3), (128, 128, 255)), "uint8")
    (tmp_path / "two.wif").write_text(WIF.replace("[WEFT]\nThreads=2", "[WEFT]\nThreads=3").replace("[TREADLING]\n", "[TREADLING]\n3=1\n"))
    balls = "".join(f"sphere {{ {9 * k}*y, 1 texture {{ finish {{ {finish} mdf {{ {block} notes on }} }} }} }}\n" for k, (finish, block, _, _) in enumerate(NOTES, 1))
    told = render(scene(balls), (8, 6), dump=False).message.split("mdf block at ")[1:]
    assert len(told) == len(NOTES)
    for said, (finish, block, wanted, unwanted) in zip(told, NOTES):
        assert wanted in said and unwanted not in said.split("Parse Warning")[0], (finish, block, said)


# Objects, a line each, and the warnings that name it; a person's
BLOB = "blob {{ threshold .5 sphere {{ 0, 1, 1 }} texture {{ finish {{ mdf {{ {} }} }} }} }}"
BALL = "sphere {{ 0, 1 texture {{ finish {{ mdf {{ {} }} }} }} }}"
NAMED = [
    (BALL.format("ggx .3, .3 brdf microfacet multiscatter on"), ()),
    (BALL.format("beckmann .3, .3 brdf microfacet multiscatter on"), ()),
    (BALL.format("ward .3, .3 multiscatter on"), ("'multiscatter on'",)),
    (BALL.format('multiscatter on fabric { preset "denim" }'), ("'multiscatter'",)),
    (BALL.format('specular .5 preset "brushed_gold" fabric { preset "denim" }'), ("'specular'",)),
    (BALL.format('preset "brushed_gold" horizon mutual slopes 0, 0, .1, 0, .1'), ()),
    (BALL.format('horizon mutual slopes 0, 0, .1, 0, .1 preset "denim"'), ("'horizon' and 'slopes'",)),
    (BALL.format('bump_image { png "flat.png" } reflection { } fabric { preset "denim" }'), ()),
    (BALL.format('ggx .1, .2 roughness .1 fabric { preset "denim" }'), ("'ggx' and 'roughness'",)),
    (BLOB.format("scratches { } tangent radial y"), ()),
    (BLOB.format("scratches { }"), ("'scratches'",)),
    (BLOB.format('preset "denim"'), ("'fabric'",)),
    (BLOB.format("ggx .1, .2"), ()),
    ("union { sphere { 0, 1 } box { 1, 2 } texture { finish { mdf { tangent uv } } } }", ()),
    ("union { sphere { 0, 1 } blob { threshold .5 sphere { 0, 1, 1 } } texture { finish { mdf { tangent uv } } } }", ("'tangent uv'",)),
]


def test_warnings_name_the_block_that_they_are_of(render, tmp_path):
    from test_bump_image import write_png
    write_png(tmp_path / "flat.png", np.full((2, 4, 3), (128, 128, 255)), "uint8")
    begin = scene("").count("\n") + 1
    log = render(scene("\n".join(line for line, _ in NAMED), header=HEADER.replace("#version", "#declare mdf_Defaults = 1; #version")), (8, 6), dump=False).message
    found = {}
    for words, line in re.findall(r"mdf: ('.*?') \(scene\.pov:(\d+)\)", log):
        found.setdefault(int(line), []).append(words)
    assert {begin + k: list(words) for k, (_, words) in enumerate(NAMED) if words} == found, log
    assert "changes nothing: only ggx and beckmann with brdf microfacet have it." in log


def test_warnings_that_name_no_block_come_once(render, monkeypatch):
    """Of a mesh that stands there twice, of an instruction set that is not there, of defaults; not of what has none of it."""
    collapsed = """#declare M = mesh2 { vertex_vectors { 4, <-1,0,-1>, <1,0,-1>, <1,0,1>, <-1,0,1> } uv_vectors { 4, <0,0>, <1,0>, <1,1>, <.5,.5> }
      face_indices { 2, <0,1,2>, <0,2,3> } uv_indices { 2, <0,1,2>, <0,2,3> } finish { mdf { } } } object { M } object { M translate y }\n"""
    monkeypatch.setenv("LIBSHADE_ISA", "abacus")
    log = render(scene(collapsed + saddle(2, uv=False, extra="finish { mdf { } } }") + BALL.format('ggx .1, .2 fabric { preset "denim" brdf auto }').replace("{ 0,", "{ 99*y,")), (8, 6), dump=False).message
    assert log.count("LIBSHADE_ISA 'abacus'") == log.count("have no UV area around them") == 1 and "1 of the 6 corners" in log, log  # the one of the triangle without area alone
    assert "mdf_Defaults" not in log, log
    said = render(scene(BALL.format("scratches { layer { radius 40, 1 } }")), (8, 6), dump=False).message
    assert "mdf: radius is 40; it is taken as 10." in said, said  # half of a tile of 20 mm


# What a block says, where a dump's header has it, and what stands there; a person's
TOLD = [
    ('fabric { weave "plain" seed 7 }', "fabric yarns seed", 7),
    ("fabric { seed 7 occlusion none }", "fabric yarns occlusion", "none"),
    ("fabric { occlusion sky }", "fabric yarns occlusion", "sky"),
    ("fabric { weft { diffuse lambert rgb .25 } }", "fabric cloth weft diffuse", "lambert"),
    ("fabric { weft { diffuse lambert rgb .25 } }", "fabric cloth warp diffuse", "fibre"),
    ("fabric { yarns { diffuse lambert rgb .25 } }", "fabric cloth warp diffuse", "lambert"),
    ("fabric { detail perturb horizon chiang }", "fabric cloth detail", "perturb"),
    ("fabric { detail perturb horizon chiang }", "fabric cloth horizon", "chiang"),
    ("fabric { beckmann }", "fabric cloth mdf", "beckmann"),
    ('brdf ward_dur preset "brushed_steel"', "brdf", "ashikhmin_shirley"),  # that of a scene of before
    ('preset "brushed_steel" brdf ward_dur', "brdf", "ward_dur"),
    ('fabric { draft "two.wif" preset "denim" }', "fabric weave", "twill_3_1"),
    ('fabric { draft "two.wif" preset "denim" }', "fabric cloth draft_colors", False),
    ('fabric { draft "two.wif" }', "fabric cloth draft_colors", True),
]


def test_what_is_said_reaches_the_header(render, tmp_path):
    from test_cloth import WIF
    (tmp_path / "two.wif").write_text(WIF)
    made = render(scene("".join(f"#declare F = finish {{ mdf {{ {block} }} }}\n" for block, _, _ in TOLD)), (8, 6)).dump.header["materials"]
    assert len(made) == len(TOLD)
    for found, (block, place, wanted) in zip(made, TOLD):
        for word in place.split():
            found = found[word]
        assert found == wanted, (block, place, found)


def test_cloths_and_metals_of_the_include_files(render):
    """Cloths are the presets of their names, a unit of theirs 20 cm; brushed metals have a person's numbers."""
    cloths = ["Silk_Charmeuse", "Silk_Shantung", "Denim", "Gabardine", "Linen", "Wool_Flannel", "Polyester_Lining", "Shot_Taffeta", "Herringbone_Tweed"]
    colours = {"Steel": (.56, .55, .53), "Aluminum": (.91, .92, .92), "Gold": (1, .78, .34), "Copper": (.95, .64, .54), "Brass": (.89, .75, .43)}
    widths = {"Steel_Brushed": (200, 10), "Aluminum_Brushed": (120, 8), "Gold_Brushed": (250, 20), "Copper_Brushed": (200, 15), "Brass_Brushed": (300, 25),
              "Steel_Blasted": (25, 25), "Aluminum_Blasted": (20, 20)}
    ball = "sphere {{ {0}*y, 1 texture {{ {1} finish {{ {2} mdf {{ notes on }} }} }} }}\n"
    text = '#include "mdf_fabrics.inc"\n#include "libshade_metals.inc"\n#declare mdf_Defaults = 1;\n'
    text += "".join(ball.format(9 * k, f"MDF_T_{name}", "") + ball.format(200 + 9 * k, "", f'mdf {{ preset "{name.lower()}" }}') for k, name in enumerate(cloths, 1))
    result = render(scene(text + "".join(ball.format(400 + 9 * k, f"LS_{name}", "") for k, name in enumerate(widths))), (8, 6))
    shown = {int(number): m for m in result.dump.header["materials"] for number in re.findall(r"^scene\.pov:(\d+)", m["name"])}
    numbers = sorted(shown)
    told = re.findall(r"[\d.]+ x [\d.]+ crossings", result.message)
    assert len(numbers) == len(told) + len(widths) == 2 * len(cloths) + len(widths)
    for k, name in enumerate(cloths):
        of_file, of_preset = (shown[numbers[2 * k + i]] for i in (0, 1))
        assert of_file["fabric"] == of_preset["fabric"] and told[2 * k] == told[2 * k + 1], name
    for name, number in zip(widths, numbers[2 * len(cloths):]):
        assert (shown[number]["ex"], shown[number]["ey"]) == widths[name], name
        assert shown[number]["f0"] == pytest.approx([.4 * c for c in colours[name.split("_")[0]]], abs=1e-6), name


def test_a_presets_layers_are_no_longer_ones_own(render):
    """Their scratches become as many as a larger tile holds, and too many are told of."""
    blocks = ("layer { pits 9 } tile_mm 1000", 'layer { pits 9 } preset "brushed_steel" tile_mm 1000', 'preset "brushed_steel" tile_mm 1000 layer { pits 9 }')
    told = [render(scene(sphere(f"scratches {{ {block} }}").replace("{ 0, 1", "{ 99*y, 1")), (8, 6), dump=False).message.count("more than a million") for block in blocks]
    assert told == [0, 1, 1]


def test_include_file_of_metals(render, shade_check):
    names = ["Steel_Brushed", "Aluminum_Brushed", "Gold_Brushed", "Copper_Brushed", "Brass_Brushed", "Steel_Blasted", "Aluminum_Blasted"]
    spheres = "".join(f"sphere {{ <{.4 * i - 1.2}, 0, 0>, .2 texture {{ LS_{name} }} }}\n" for i, name in enumerate(names))
    result = render(scene('#include "libshade_metals.inc"\n' + spheres +
                          "sphere { -.6*y, .3 texture { pigment { rgb 1 } finish { LS_F_Gold_Brushed mdf { tangent <0, 1, 0> } } } }"), (160, 120))
    dump = result.dump
    assert len(np.unique(dump.id[dump.hit])) == 8
    shade_check(dump, everything=False)
