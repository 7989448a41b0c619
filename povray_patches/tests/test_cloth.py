# SPDX-License-Identifier: AGPL-3.0-or-later
"""`fabric { }`: against libshade's reference, by what is known of weaves, and by what light may pass."""
import numpy as np
import pytest

from scenes import SUN, dot, normalise, scene

COST = 73.1

CLOTHS = ("silk_charmeuse", "silk_shantung", "denim", "gabardine", "linen", "wool_flannel", "polyester_lining",
          "shot_taffeta", "herringbone_tweed")
FRONT = """#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location <0, 0, -3> right 2*x up 2*y look_at 0 }
"""


def cloth(words, pigment="rgb 0", more="", ambient=0):
    return f"texture {{ pigment {{ {pigment} }} finish {{ ambient {ambient} diffuse 0 mdf {{ fabric {{ {words} }} {more} }} }} }}"


def sheet(x0=-1., y0=-1., x1=1., y1=1., z=0., uv="<0, 0>, <1, 0>, <1, 1>, <0, 1>"):
    """Its uv_vectors run right and up, as the eye sees it."""
    return (f"mesh2 {{ vertex_vectors {{ 4, <{x0}, {y0}, {z}>, <{x1}, {y0}, {z}>, <{x1}, {y1}, {z}>, <{x0}, {y1}, {z}> }}\n"
            f"uv_vectors {{ 4, {uv} }} face_indices {{ 2, <0, 1, 2>, <0, 2, 3> }}\n")


def swatches(crossings, cloths=CLOTHS):
    """Cloths side by side."""
    text = ""
    for k, word in enumerate(cloths):
        x, y = k % 3 * .66 - 1, k // 3 * .66 - 1
        text += sheet(x, y, x + .6, y + .6) + cloth(f'preset "{word}" crossings <{crossings}, {crossings * .9}>') + " }\n"
    return text


# Far away the reference takes ten seconds a cloth. Where near passes into far one value may be off by more than
# `shade check` allows; sums are not.
@pytest.mark.parametrize("crossings, size, cloths", [(4, 36, CLOTHS), (1200, 9, ("denim", "silk_charmeuse"))])
def test_every_preset_is_the_reference_near_and_far(render, shade_check, crossings, size, cloths):
    report = shade_check(render(scene(swatches(crossings, cloths), SUN, FRONT), size=(size, size)).dump, 2e-5)
    assert ("cloth far" in report) == (crossings > 10), report


def test_near_passes_into_far_without_a_change_of_mean(render):
    """The mean picture of a swatch is the same from every distance."""
    for word in ("denim", "herringbone_tweed"):
        text = sheet() + cloth(f'preset "{word}" crossings <49.3, 47.9>') + "}"
        means = [render(scene(text, SUN, FRONT), size=(n, n), dump=False).image.mean((0, 1)) for n in (320, 64, 36, 24, 12)]
        for mean in means[1:]:
            assert mean == pytest.approx(means[0], rel=.06)  # 48 yarns, whose brightness varies by a fifth: 3 % of their mean


OBJECTS = {"sphere": "sphere { 0, 1", "torus": "torus { .7, .3 rotate -40*x", "box": "box { -.6, .6 rotate <20, 30, 0>",
           "cylinder": "cylinder { -.7*y, .7*y, .6 rotate -30*x", "cone": "cone { -y, .9, y, .2", "plane": "plane { y, -.5 clipped_by { sphere { 0, .9 } }",
           "blob": "blob { threshold .5 sphere { -.4*x, 1, 1 } sphere { .4*x, 1, 1 }",
           "lathe": "lathe { cubic_spline 5, <0, -.5>, <.6, 0>, <.9, .5>, <.5, 1>, <.4, 1.4> translate -.6*y",
           "mirrored": "sphere { 0, 1 scale <-1, 1, 1>", "inside out": "sphere { 0, 1 inverse", "squashed": "sphere { 0, 1 scale <1, .5, .7>"}


@pytest.mark.parametrize("shape", OBJECTS)
def test_every_object_is_the_reference(render, shade_check, shape):
    per_unit = 3.3 if shape in ("cylinder", "cone", "plane", "blob", "lathe", "box") else 15.3
    body = OBJECTS[shape] + " " + cloth(f'preset "denim" crossings {per_unit}') + "}"
    dump = render(scene(body), size=(60, 45)).dump
    assert dump.hit.mean() > .05 and np.isfinite(dump.S).all()
    # at poles and rims a pixel is long one way and narrow the other: its mean is held to no single value there
    longest = np.maximum(dump.channels["foot.U"], dump.channels["foot.V"])
    assert (longest[dump.hit] > .75).mean() < .2, longest[dump.hit].mean()
    shade_check(dump.only(longest < .75), 2e-5)
    # u grows along the tangent T, v along N x T, so that no cloth is mirrored
    with np.errstate(invalid="ignore"):
        for k, way in enumerate((dump.T, np.cross(dump.N, dump.T))):
            right = []
            for axis, here in ((0, np.s_[:-1]), (1, np.s_[:, :-1])):
                moved, grown = np.diff(dump.P, axis=axis), np.diff(dump.uv[..., k], axis=axis)
                along = np.sum(moved * way[here], -1)
                clear = (np.abs(along) > .7 * np.linalg.norm(moved, axis=-1)) & (np.abs(grown) < 2)
                right += list((grown * along > 0)[clear & (np.sum(np.diff(dump.N, axis=axis)**2, -1) < .1)])
            assert len(right) > 200 and np.mean(right) > .97, k


def test_a_unit_of_uv_holds_as_many_crossings_as_it_says(render):
    for words, u, v in (('preset "linen" crossings <30, 20>', 30, 20), ('preset "linen" crossings 12', 12, 12),
                        ("ends_per_cm 7 picks_per_cm 3 mm_per_unit 50", 35, 15), ("weave \"plain\"", 200, 200)):
        dump = render(scene(sheet() + cloth(words) + "}", SUN, FRONT), size=(16, 16)).dump
        pixels = (np.arange(16) + .5) / 16
        assert dump.uv[..., 0] == pytest.approx(np.broadcast_to(pixels * u, (16, 16)), rel=1e-5)
        assert dump.uv[..., 1] == pytest.approx(np.broadcast_to(pixels[::-1, None] * v, (16, 16)), rel=1e-5)
        # a pixel is a sixteenth
        assert dump.channels["foot.U"] == pytest.approx(np.full((16, 16), u / 16), rel=1e-5)
        assert dump.channels["foot.V"] == pytest.approx(np.full((16, 16), v / 16), rel=1e-5)


def test_cloth_has_one_scale_on_all_sides_of_a_box(render):
    """A unit of a box's sides is one of the object, whatever their size."""
    for turn in ("", "rotate 90*y", "rotate 90*x", "rotate -90*y"):
        dump = render(scene(f"box {{ <-.5, -.1, -.3>, <.5, .1, .3> {cloth('crossings 12')} {turn} }}", SUN, FRONT), size=(64, 64)).dump
        for axis in (0, 1):
            step = np.abs(np.diff(np.where(dump.hit, dump.uv[..., axis], np.nan), axis=1 - axis))
            across = np.abs(np.diff(np.where(dump.hit, dump.uv[..., axis], np.nan), axis=axis))
            steps = np.nanmedian(step), np.nanmedian(across)
            assert max(steps) == pytest.approx(12 * 2 / 64, rel=1e-3) and min(steps) < 1e-6


def test_the_footprint_grows_with_distance_and_slant(render):
    near, far, slanted = (render(scene(sheet() + cloth("crossings 10") + f" {place} }}", SUN, """#version 3.7;
global_settings { assumed_gamma 1 }
camera { location 0 right x up y direction 2*z }
"""), size=(21, 21)).dump for place in ("translate 4*z", "translate 8*z", "rotate 60*y translate 4*z"))
    width = lambda dump, axis: dump.channels[f"foot.{axis}"][10, 10]
    assert width(near, "U") == pytest.approx(10 / 2 * 4 * .5 / 21, rel=1e-3)
    assert width(far, "U") == pytest.approx(2 * width(near, "U"), rel=1e-3)
    assert width(slanted, "U") == pytest.approx(2 * width(near, "U"), rel=1e-3)
    assert width(slanted, "V") == pytest.approx(width(near, "V"), rel=1e-3)


@pytest.mark.parametrize("camera", ["perspective angle 110", "perspective angle 60 right <2, .3, 0>", "orthographic right <8, 1, 2> direction 3*z", "fisheye right x up y angle 150",
                                    "spherical right 1.3*x angle 150 90", "cylinder 1 angle 120 right 1.3*x"])
def test_a_footprint_is_as_wide_as_its_pixel_anywhere_in_a_picture(render, camera):
    """On the wall a pixel's width follows from what the pixels beside it see."""
    wall = "plane { z, 3 " + cloth('preset "linen" crossings 20') + " }"
    dump = render(scene(wall, SUN, f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 }}\ncamera {{ {camera} }}\n"), size=(36, 36)).dump
    uv = np.where(dump.hit[..., None], dump.uv, np.nan)
    across, down = (uv[1:-1, 2:] - uv[1:-1, :-2]) / 2, (uv[2:, 1:-1] - uv[:-2, 1:-1]) / 2
    x, y, z = np.moveaxis(dump.V[1:-1, 1:-1], -1, 0)
    width = np.sqrt(np.abs(across[..., 0] * down[..., 1] - across[..., 1] * down[..., 0]) * np.abs(z))  # what the ray slants
    found = [np.where(dump.hit, dump.channels[f"foot.{axis}"], np.nan)[1:-1, 1:-1] for axis in "UV"]
    expected = width * np.hypot(x, z) / np.abs(z), width * np.hypot(y, z) / np.abs(z)  # the longest step of a slanted circle along each axis
    clear = (expected[0] < 500) & (np.minimum(*expected) > .25) & np.isfinite(width)
    assert clear.sum() > 300
    for k in (0, 1):
        ratio = found[k][clear] / expected[k][clear]
        assert abs(np.median(ratio) - 1) < .01 and (np.abs(ratio - 1) < .05).mean() > .95, (ratio.min(), ratio.max())


@pytest.mark.parametrize("transform, left", [("", ""), ("rotate 180*y", ""), ("scale <-1, 1, 1>", ""), ("", "mirrored on"),
                                             ("scale <-1, 1, 1>", "mirrored on")])  # also from behind, and mirrored
def test_a_twill_rises_to_the_right(render, transform, left):
    """Weft is on top iff ((floor u + n_s floor v) mod (n_w + n_p)) < n_w, as whoever looks at the cloth counts it."""
    words = left + " weave 1, 3, 1 crossings 8 warp { diffuse rgb 0 specular 0 } weft { diffuse rgb .8 specular 0 } yarns { curve 0 ridge 0 segments 0 }"
    image = render(scene(sheet() + cloth(words) + transform + "}", "light_source { -9*z, rgb 1 parallel point_at 0 }\n", FRONT),
                   size=(8, 8), dump=False).image[::-1, :, 0]  # row 0 at the bottom
    weft = image > .1
    assert weft.mean() == pytest.approx(1 / 4)
    up = [[(i, j) for i in range(8) if weft[j, i]] for j in range(8)]
    steps = {(up[j + 1][0][0] - up[j][0][0]) % 4 for j in range(7)}
    # (i + j) mod 4 == 0: one up is one to the left, in whatever way the map runs; `mirrored on`: of a mirrored object, right
    assert steps == ({1} if left and transform else {3}), weft.astype(int)


def test_a_mirrored_cloth_is_the_picture_in_a_mirror(render, shade_check):
    """Whatever moves it, and by the reference too; unlit from the side, so that fibres and slants tell left from right."""
    sun = "light_source {{ <{}, 5, -9>*100, rgb 1 parallel point_at 0 }}\n"
    words = 'preset "denim" crossings 7 mirrored on'
    box = "box {{ -.6, .6 rotate <20, 30, 10> {} {} }}"
    plain = render(scene(box.format(cloth(words), ""), sun.format(3), FRONT), size=(48, 48))
    other = render(scene(box.format(cloth(words), "scale <-1, 1, 1>"), sun.format(-3), FRONT), size=(48, 48))
    assert other.image[:, ::-1] == pytest.approx(plain.image, abs=2e-3) and plain.image.max() > .02
    for dump, x in ((plain.dump, -3), (other.dump, -3)):  # a dump has the side to the right of what turns the cloth's hand
        lit = dump.E[0].max(-1) > 0
        assert lit[dump.hit].mean() > .3 and (dump.hit & ~lit).any()
        assert dump.L[0][lit] == pytest.approx(np.broadcast_to(np.array([x, 5, -9]) / np.sqrt(115), (lit.sum(), 3)), abs=1e-5)
        assert np.array_equal(dump.L[0][dump.hit & ~lit], dump.N[dump.hit & ~lit])
    shade_check(other.dump, 2e-5)


def test_what_is_behind_shows_through_the_gaps(render):
    words = "crossings 6.37 yarns { width 1 gap .5 } backing rgb 0"  # no whole number of pixels
    text = sheet() + cloth(words) + "}\nbackground { rgb <1, .5, .25> }"
    near = render(scene(text, "", FRONT), size=(96, 96))
    coverage = near.dump.channels["coverage.A"]
    assert set(np.unique(coverage)) == {0., 1.}
    assert 1 - coverage.mean() == pytest.approx((.5 / 1.5) ** 2, abs=.02)
    assert near.image == pytest.approx((1 - coverage)[..., None] * [1, .5, .25], abs=1e-3)
    far = render(scene(text.replace("crossings 6.37", "crossings 6000"), "", FRONT), size=(8, 8)).image
    assert far == pytest.approx(np.broadcast_to(np.array([1, .5, .25]) * (.5 / 1.5) ** 2, (8, 8, 3)), rel=.03)
    lined = render(scene(text.replace("backing rgb 0", "backing rgb .1"), "", FRONT), size=(8, 8), dump=False).image
    assert lined.max() == 0


def test_light_passes_the_gaps_and_nothing_else(render):
    """The floor below a net: its mean is that of the open floor times the share of the gaps, near and far."""
    camera = """#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location <0, -.5, -8> direction z up y right x look_at <0, -.5, 0> }
light_source { <0, 90, 0>, rgb 1 parallel point_at 0 }
plane { y, -1 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }
""".replace("location <0, -.5, -8> direction z up y right x look_at <0, -.5, 0>", "location <0, -.5, 0> up z right x direction -y")
    mean = {}
    for crossings in (0, 10, 5000):
        net = sheet(-3, -3, 3, 3) + cloth(f"crossings {6.37 * crossings} yarns {{ gap 1 }} backing rgb 0") + " rotate 90*x }" if crossings else ""
        mean[crossings] = render(camera + net, size=(100, 100), dump=False).image.mean()
    assert mean[0] == pytest.approx(1, abs=2e-3)
    assert mean[10] == pytest.approx(.25, abs=.03)  # the view ends amid a gap
    assert mean[5000] == pytest.approx(.25, abs=.01)


def test_light_from_behind_comes_through_thin_yarns(render, shade_check):
    lights = "light_source { <2, 3, 9>, rgb 1 parallel point_at 0 }\n"
    thin = 'preset "linen" crossings 21.3 yarns { diffuse rgb .4 transmit rgb <.4, .3, .2> }'
    dump = render(scene(sheet() + cloth(thin) + "}", lights, FRONT), size=(64, 64)).dump
    assert dump.S.mean((0, 1, 2)).min() > .01
    shade_check(dump, 2e-5)
    assert render(scene(sheet() + cloth('preset "linen" crossings 20') + "}", lights, FRONT), size=(16, 16)).dump.S.max() == 0
    # it is not light on their back that double_illuminate would let shine in front
    own, both = (render(scene(sheet() + cloth(thin) + f" {more} }}", lights, FRONT), size=(12, 12), dump=False).image for more in ("", "double_illuminate"))
    assert np.array_equal(own, both) and own.mean() > .01


@pytest.mark.parametrize("yarns", ["warp", "weft"])
def test_one_yarn_alone_may_be_thin(render, shade_check, yarns):
    lights = "light_source { <2, 3, 9>, rgb 1 parallel point_at 0 }\n"
    thin = f'preset "linen" crossings 21.3 {yarns} {{ transmit rgb .4 }}'
    dump = render(scene(sheet() + cloth(thin) + "}", lights, FRONT), size=(32, 32)).dump
    assert dump.S.mean() > .005
    shade_check(dump, 2e-5)


def test_folds_carry_the_cloth(render, shade_check):
    bent = cloth('preset "silk_charmeuse" crossings 20').replace("finish", "normal { bumps .6 scale .4 } finish")
    dump = render(scene(sheet() + bent + "}", header=FRONT), size=(64, 64)).dump
    assert np.abs(dump.N - dump.Ns).max() > .1
    shade_check(dump, 2e-5)


@pytest.mark.parametrize("words, defaults, brdf", [
    ("ggx detail deform_smooth horizon chiang occlusion sky", "", "ashikhmin_shirley"),  # a scene of before
    ("seed 7 yarns { vary_brightness .5 slub .4 along 40 across 4 diffuse fibre_view rgb <.5, .2, .1> }", "#declare mdf_Defaults = 1;", "auto"),
    ("weave \"satin-8\" nap 1 nap_color rgb <.9, .8, .7> brdf ward_dur", "#declare mdf_Defaults = 1;", "ward_dur")])
def test_every_number_reaches_the_cloth(render, shade_check, words, defaults, brdf):
    result = render(scene(defaults + sheet() + cloth(words + " crossings 9") + "}", header=FRONT), size=(48, 48))
    assert result.dump.header["materials"][0]["fabric"]["cloth"]["brdf"] == brdf
    assert ("brdf is ashikhmin_shirley, not microfacet" in " ".join(result.message.split())) == ("ggx" in words)
    shade_check(result.dump, 2e-5)


WIF = """[WIF]
Version=1.1
[CONTENTS]
WEAVING=true
WARP=true
WEFT=true
THREADING=true
TIEUP=true
TREADLING=true
COLOR PALETTE=true
COLOR TABLE=true
WARP COLORS=true
[WEAVING]
Shafts=2
Treadles=2
[WARP]
Threads=2
Color=1
Spacing=.1
Units=centimeters
[WEFT]
Threads=2
Color=2
Spacing=.2
Units=centimeters
[COLOR PALETTE]
Entries=2
Range=0,255
[COLOR TABLE]
1=255,0,0
2=0,0,255
[WARP COLORS]
1=1
2=1
[THREADING]
1=1
2=2
[TIEUP]
1=1
2=2
[TREADLING]
1=1
2=2
"""


def test_a_draft_brings_its_yarns(render, shade_check, tmp_path):
    (tmp_path / "two.wif").write_text(WIF)
    dump = render(scene(sheet() + cloth('draft "two.wif" mm_per_unit 20') + "}", header=FRONT), size=(64, 64)).dump
    assert dump.uv[0, -1] == pytest.approx([20 * 127 / 128, 10 * 127 / 128], rel=1e-5)  # 10 and 5 to the centimetre
    shade_check(dump, 2e-5)
    S = dump.S.sum((0, 1, 2))
    assert S[0] > 3 * S[1] and S[2] > 3 * S[1]  # red and blue


def test_a_draft_without_spacing_is_square(render, tmp_path):
    """By its thickness, or else as dense as the cloth is; unless the scene says how dense it is."""
    bare = "\n".join(line for line in WIF.splitlines() if not line.startswith("Spacing")) + "\n"
    (tmp_path / "bare.wif").write_text(bare)
    (tmp_path / "thick.wif").write_text(bare.replace("[WEFT]\n", "[WEFT]\nThickness=.05\n"))
    for words, u, v, note in (('draft "bare.wif"', 147, 147, "73.4847 to the centimetre"), ('draft "thick.wif"', 40, 40, "20 to the centimetre"),
                              ('draft "bare.wif" picks_per_cm 30', 60, 60, ""), ('draft "thick.wif" ends_per_cm 50 picks_per_cm 30', 100, 60, ""), ('ends_per_cm 50 draft "bare.wif" crossings <3, 5>', 3, 5, "")):
        result = render(scene(sheet() + cloth(f'preset "silk_charmeuse" mm_per_unit 20 {words}') + "}", SUN, FRONT), size=(16, 16))
        assert result.dump.uv[0, -1] == pytest.approx([u * 31 / 32, v * 31 / 32], rel=1e-3)
        said = " ".join(result.message.split())
        assert ("states no spacing" in said) == bool(note) and note in said, said


def test_the_colours_of_a_draft_are_all_that_dyes_its_yarns(render, tmp_path):
    (tmp_path / "two.wif").write_text(WIF)
    seen = [render(scene(sheet() + cloth(f'draft "two.wif" mm_per_unit 20 {words}') + "}", header=FRONT), size=(32, 32)).dump.S
            for words in ("", "yarns { diffuse rgb 1 }", "weft { diffuse rgb .5 }", "warp { diffuse rgb .5 }")]
    assert seen[0] == pytest.approx(seen[1], rel=1e-6)
    assert seen[2].sum() < .95 * seen[0].sum() and seen[3].sum() < .95 * seen[0].sum()
    for words, colours, shadows in (("", True, True), ("draft_colors off shadows off", False, False), ("draft_colors off draft_colors on shadows on", True, True)):
        dump = render(scene(sheet() + cloth(f'draft "two.wif" mm_per_unit 20 yarns {{ diffuse rgb .5 }} {words}') + "}", header=FRONT), size=(24, 24)).dump
        said = dump.header["materials"][0]["fabric"]["cloth"]
        assert (said["draft_colors"], said["shadows"]) == (colours, shadows), words
        tint = dump.S.sum((1, 2)) / dump.E.sum((1, 2))  # by lamp
        assert ((np.ptp(tint, axis=1) > .05 * tint.mean(1)) == colours).all(), tint


@pytest.mark.parametrize("colour", ["<.7, .3, .1>", "<.1, .5, .8>"])
def test_yarns_take_the_pigments_colour(render, colour):
    pictures = [render(scene(sheet() + cloth(f'preset "gabardine" crossings 20 warp {{ diffuse {d} }}', p) + "}", header=FRONT),
                       dump=False).image for d, p in (("pigment", f"rgb {colour}"), (f"rgb {colour}", "rgb 0"))]
    assert pictures[0] == pytest.approx(pictures[1], rel=2e-3, abs=1e-4)  # half floats


def test_a_dump_has_no_room_for_yarns_of_the_pigments_colour(render, shade_check):
    """Its header has one colour a yarn, so these hits are left out; those of another cloth beside it are there."""
    words = 'preset "gabardine" crossings 20'
    text = (sheet(-1, -1, 0, 1) + cloth(f"{words} warp {{ diffuse pigment }}", "checker rgb <.7, .3, .1>, rgb <.1, .5, .8> scale .1") + "}\n"
            + sheet(0, -1, 1, 1) + cloth(words) + "}")
    dump = render(scene(text, header=FRONT)).dump
    assert dump.hit.mean() == pytest.approx(.5, abs=.02) and (dump.P[dump.hit][:, 0] < 0).all()  # its x is that of the other hand
    shade_check(dump, 2e-5, everything=False)


@pytest.mark.parametrize("yarns", ["warp", "yarns"])
@pytest.mark.parametrize("settings", ["", "radiosity { pretrace_start .2 pretrace_end .1 count 20 }"])
def test_yarns_glow_in_the_pigments_colour(render, yarns, settings):
    """What ambient light and radiosity's give: one colour, said either way."""
    header = FRONT.replace("assumed_gamma 1", "assumed_gamma 1 " + settings)
    assert settings in header
    pictures = [render(scene("background { rgb <.4, .6, .8> } " + sheet() + cloth(f'preset "gabardine" crossings 20 {yarns} {{ diffuse {d} }}', "rgb <.8, .3, .1>", ambient=.5) + "}",
                             "", header), dump=False).image for d in ("pigment", "rgb <.8, .3, .1>")]
    assert pictures[0].max() > .1
    assert pictures[0] == pytest.approx(pictures[1], rel=.05)  # what fabric.h says of a cloth's albedo


def test_cloths_that_differ_in_a_pigment_alone_are_two(render):
    """One glows grey, one in the pigment's colour where its warp is dyed, one where its weft is, which shows less."""
    words = ["", "warp { diffuse pigment }", "weft { diffuse pigment }"]
    places = [sheet(-1 + 2 / 3 * k, -1, -1 / 3 + 2 / 3 * k, 1) for k in range(3)]
    swatch = "weave \"satin_5\" crossings 300 "
    text = "".join(place + cloth(swatch + word, "rgb <.9, .1, .5>", ambient=1) + " }\n" for place, word in zip(places, words))
    grey, warp, weft = render(scene(text, "", FRONT), size=(3, 1), dump=False).image[0] - (.9, .1, .5)  # which glows as well
    assert np.ptp(grey) < 2e-3 < .1 < grey.min()
    for dyed, part in ((warp, .1), (weft, .02)):
        assert dyed[0] > grey[0] + part and dyed[1] < grey[1] - part and abs(dyed[2] - grey[2]) < 2e-3, (grey, warp, weft)
    assert weft[0] < .5 * (grey[0] + warp[0])


@pytest.mark.parametrize("fresnel, rest", [
    *((fresnel, rest) for fresnel in ("none", "f82 rgb <.9, .7, .8>") for rest in ("", "reflection { samples 4 }")),
    *(("schlick", rest) for rest in ("", "diffuse lambert pigment", "diffuse ashikhmin_shirley pigment", "diffuse fibre rgb .4", "reflection { samples 4 }"))])
def test_metal_takes_the_pigments_colour(render, shade_check, fresnel, rest):
    """A pattern is patches of blocks with its colours."""
    colours = ("rgb <.9, .6, .2>", "rgb <.2, .5, .9>")
    block = lambda specular, diffuse: (f"finish {{ ambient .2 diffuse 0 mdf {{ ggx .3, .1 fresnel {fresnel} specular {specular} "
                                       f"{rest.replace('pigment', diffuse)} }} }}")
    whole = f"texture {{ pigment {{ checker {colours[0]}, {colours[1]} scale .5 }} {block('pigment', 'pigment')} }}"
    parts = " ".join(f"texture {{ pigment {{ rgb 0 }} {block(c, c)} }}" for c in colours)
    results = [render(scene("background { rgb .5 } sphere { 0, 1 " + t + "}"))
               for t in (whole, f"texture {{ checker {parts} scale .5 }}")]
    shade_check(results[0].dump)
    assert results[0].dump.S == pytest.approx(results[1].dump.S, rel=1e-4, abs=1e-6)


def test_a_pigment_beyond_1_is_taken_as_1(render):
    ball = "sphere {{ 0, 1 pigment {{ rgb {} }} finish {{ ambient 0 diffuse 0 mdf {{ ggx .3, .1 specular pigment diffuse lambert pigment }} }} }}"
    beyond, within = (render(scene(ball.format(colour)), (16, 12), dump=False).image for colour in ("<3, -1, .5>", "<1, 0, .5>"))
    assert np.array_equal(beyond, within) and within[..., 0].max() > .1


@pytest.mark.parametrize("fresnel", ["none", "schlick", "f82 rgb <.9, .7, .8>"])
@pytest.mark.parametrize("rest", ["reflection { samples 16 }", "", "diffuse lambert rgb .2", "reflection off bump_image { png \"fine.png\" }"])
def test_the_pigments_colour_reflects_and_glows(render, tmp_path, fresnel, rest):
    """Rays and the ambient light's share too: one colour, said either way."""
    import OpenImageIO as oiio
    noise = oiio.ImageBuf(oiio.ImageSpec(64, 64, 3, "uint8"))
    noise.set_pixels(noise.roi, np.random.default_rng(1).uniform([.4, .4, .9], [.6, .6, 1], (64, 64, 3)).astype("f4"))
    assert noise.write(str(tmp_path / "fine.png"))
    pictures = [render(scene("background { rgb <.4, .6, .8> } plane { y, -1 pigment { checker rgb .1, rgb .9 } } sphere { 0, 1 texture { pigment { "
                             f"rgb <.8, .5, .1> }} finish {{ ambient .3 diffuse 0 mdf {{ ward .15, .3 fresnel {fresnel} specular {c} {rest} }} }} }} }}"),
                       dump=False).image for c in ("pigment", "rgb <.8, .5, .1>")]
    assert pictures[0].std() > .1
    assert pictures[0] == pytest.approx(pictures[1], rel=3e-3, abs=1e-3)  # half floats


def test_what_was_cloth_is_metal_again_and_back(render):
    def header(words):
        text = f"#declare F = finish {{ mdf {{ {words[0]} }} }}\nsphere {{ 0, 1 texture {{ finish {{ F mdf {{ {words[1]} }} }} }} }}"
        result = render(scene(text))
        seen = result.dump.header["materials"][int(result.dump.id[result.dump.hit][0])]
        return seen, np.abs(result.dump.N - result.dump.Ns).max()
    metal, _ = header(('preset "denim"', "fabric off ggx .1, .2"))
    assert "fabric" not in metal and metal["mdf"] == "ggx"
    for words in ('preset "denim"', 'fabric { preset "denim" }'):
        cloth_now, bumps = header(('preset "scratched_gold"', words))
        assert cloth_now["fabric"]["weave"] == "twill_3_1" and bumps < 1e-6  # no scratches of the metal


def test_a_metal_preset_is_the_librarys(render):
    dump = render(scene('sphere { 0, 1 texture { pigment { rgb 0 } finish { mdf { preset "brushed_brass" } } } }')).dump
    assert dump.header["materials"][0]["fresnel"] == "conductor"
    assert dump.header["materials"][0]["eta"] == pytest.approx([.4777, .5235, 1.128])


def test_metals_of_the_include_file(render):
    """Each of its textures is the preset of its name; the marks of the turned ones go round y, of the others along one axis."""
    names = [f"{how} {metal}" for metal in ("Steel", "Aluminium", "Brass", "Copper", "Gold", "Titanium") for how in ("Brushed", "Turned", "Scratched")]
    boxes = "".join(f"box {{ -.4, .4 texture {{ MDF_T_{name.replace(' ', '_')} }} translate <{k % 6}, 0, {k // 6}> }}\n" for k, name in enumerate(names))
    dump = render("""#version 3.7; global_settings { assumed_gamma 1 } #declare mdf_Defaults = 1;
#include "mdf_metals.inc"
camera { orthographic location <2.5, 9, 1> right 6*x up 3*y look_at <2.5, 0, 1> } light_source { <4, 9, -3>, 1 parallel point_at 0 }
""" + boxes, size=(240, 120)).dump
    made = {}
    for k, name in enumerate(names):
        centre = np.array([k % 6, .4, k // 6])
        here = dump.hit & (np.abs(dump.P - centre).max(-1) < .39)
        from_centre = dump.P[here] - centre
        round_y = np.abs(dot(normalise(np.cross([0, 1, 0], from_centre)), normalise(dump.T[here])))
        material = dump.header["materials"][int(np.median(dump.id[here]))]
        how, metal = name.split()
        made.setdefault(metal, []).append((material["eta"], material["k"]))
        assert here.sum() > 500 and (material["ex"], material["ey"]) == pytest.approx({"Brushed": (798, 76), "Turned": (1248, 245), "Scratched": (1600, 1600)}[how])
        assert (round_y.min() > .99) if how == "Turned" else (round_y.min() < .1 and abs(np.median(round_y) - .5 ** .5) < 1e-3), name
    assert all(numbers == [numbers[0]] * 3 for numbers in made.values()) and len({str(numbers[0]) for numbers in made.values()}) == 6
    assert made["Brass"][0][0] == pytest.approx([.4777, .5235, 1.128])


@pytest.mark.parametrize("word, camera", [
    ("denim", FRONT), ("silk_charmeuse", FRONT), ("wool_flannel", FRONT),
    ("denim", FRONT.replace("orthographic location <0, 0, -3>", "location <0, 0, -300> direction 300*z aperture .01 focal_point 0 blur_samples 16, 16"))])
def test_even_light_shows_the_albedo(render, word, camera):
    """In a white room rays find the albedo; `ambient 1` shows the library's table of it, within its 5 %."""
    room = "background { rgb 1 } "
    lit = render(scene(room + sheet() + cloth(f'preset "{word}" crossings 900', more="reflection { samples 256 }") + "}", "", camera),
                 size=(12, 12), dump=False).image.mean((0, 1))
    shown = render(scene(room + sheet() + cloth(f'preset "{word}" crossings 900', ambient=1) + "}", "", FRONT),
                   size=(12, 12), dump=False).image.mean((0, 1))
    assert lit == pytest.approx(shown, rel=.06)


@pytest.mark.parametrize("plate, settings", [
    ("pigment { rgb 0 } finish { ambient 0 diffuse 0 mdf { ggx .5, .5 reflection { samples 8 } } }", ""),
    ("pigment { rgb 1 } finish { ambient 0 diffuse 1 }", "radiosity { count 60 error_bound .5 pretrace_end .05 }")], ids=["rough", "matt"])
def test_rays_that_spread_find_a_cloths_mean(render, plate, settings):
    """Of one that shows its warp alone: to a rough plate, and a matt one, it is the same however wide its yarns are."""
    def lit(crossings):
        wall = sheet(-9, -9, 9, 9, -4) + cloth(f"weave 1, 0, 0 crossings {crossings}") + "}\n"
        lamp = "light_source { <40, 60, 50>, rgb 1 parallel point_at 0 shadowless }\n"
        text = scene(wall + sheet() + f"texture {{ {plate} }} }}", lamp, FRONT.replace("assumed_gamma 1", f"assumed_gamma 1 {settings}"))
        return render(text, size=(24, 24), dump=False).image
    fine, coarse = lit(9000), lit(9)
    assert fine.min() > .01 and coarse == pytest.approx(fine, rel=1e-3)


def test_the_same_for_any_number_of_threads(render):
    text = scene(swatches(200).replace('crossings', 'backing 0 crossings'), header=FRONT)
    one, two = (render(text, options=[f"+WT{n}"], dump=False).image for n in (1, 2))
    assert (one == two).all()


def test_shadows_of_yarns_may_be_left_out(render, shade_check):
    """Yarns that lean towards a low lamp then take more than falls on the cloth (docs/theory/conventions.md)."""
    low = "light_source { <800, 0, -100> rgb 1 parallel point_at 0 }\n"  # 83 degrees
    dumps = [render(scene(sheet() + cloth(f'preset "silk_shantung" crossings 4 yarns {{ diffuse rgb 1 }} {words}') + "}", low, FRONT), size=(24, 24)).dump
             for words in ("", "shadows on", "shadows off")]
    for dump in dumps:
        shade_check(dump, 2e-5)
    assert [dump.header["materials"][0]["fabric"]["cloth"]["shadows"] for dump in dumps] == [True, True, False]
    assert (dumps[0].S == dumps[1].S).all()
    assert dumps[2].S.sum() > 1.1 * dumps[1].S.sum()


SCRATCHES = "scratches { tile_mm 20 mm_per_unit 40 layer { pits 4000 radius .01, .03 stretch 100, 400 depth .2, .4 direction 30 spread 10 } }"


@pytest.mark.parametrize("shape, place", [(sheet(), "rotate 40*z scale .7"), ("cylinder { -y, y, .6", ""),
                                          ("plane { z, 0", "tangent radial z at <.2, .1, 0>")])
def test_scratches_are_the_reference_and_keep_their_mean(render, shade_check, shape, place):
    """Near, normals; from afar, a wider lobe: the same light in all."""
    def picture(size, camera=FRONT):
        more = (place, "") if place.startswith("tangent") else ("", place)
        words = f"texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ beckmann .18, .36 {SCRATCHES} {more[0]} }} }} {more[1]} }}"
        return render(scene(f"{shape} {words} }}", "light_source { <10, 6, -50>, rgb 1 parallel point_at 0 }\n", camera.replace("2*x", ".6*x").replace("2*y", ".6*y")), size=(size, size))
    near = picture(600)
    assert np.abs(near.dump.N - near.dump.Ns).max() > .05
    shade_check(near.dump)
    for size in (60, 12, 4):
        far = picture(size)
        # of points (pixels of an eighth) far ones have 2.2 % less, one lobe had 6.0; near ones here, over pixels as wide as a
        # scratch, whose slopes are no Gaussian, some 2 % more
        assert far.image.mean((0, 1)) == pytest.approx(near.image.mean((0, 1)), rel=.065), size
    shade_check(far.dump)
    assert (far.dump.channels["alpha.X"] > .18).all()


def test_energy_is_conserved_by_the_mean_normal_of_scratches(render):
    """What a narrow lobe at a low view leaves of the layer below is what Schlick's term at that normal does not reflect; the plate's own is .14 off."""
    camera = FRONT.replace("<0, 0, -3> right 2*x up 2*y", "<0, -60, -20> right .06*x up .06*y")
    block = "mdf { ggx .001, .001 specular .04 fresnel schlick scratches { tile_mm 20 mm_per_unit 40 layer { pits 4000 radius .03, .05 stretch 100, 400 depth .2, .4 spread 10 } } }"
    layers = f"texture {{ pigment {{ rgb 1 }} finish {{ ambient 0 diffuse 0 emission 1 }} }} texture {{ pigment {{ rgbt <0, 0, 0, 1> }} finish {{ ambient 0 diffuse 0 conserve_energy {block} }} }}"
    result = render(scene(f"{sheet()} {layers} }}", "", camera), size=(40, 40))
    dump, channels = result.dump, result.dump.channels
    normals = [dump.Ns, *(np.stack([channels[f"lobe{k}.Ns.{c}"] for c in "XYZ"], -1) for k in (2, 3))]
    shares = [channels[f"lobe{k}.share"] for k in (2, 3)]
    shares.insert(0, 1 - sum(shares))
    mean = sum(share[..., None] * n / np.maximum(np.abs(n[..., 2:]), 1e-9) for share, n in zip(shares, normals))
    cosine = np.sum(mean * dump.V, -1) / np.linalg.norm(mean, axis=-1)
    assert np.ptp(shares[0]) > .3 and np.ptp(cosine) > .1
    assert result.image[..., 0] == pytest.approx(.96 * (1 - (1 - cosine) ** 5), abs=.003)


SPARSE = "scratches { tile_mm 20 mm_per_unit 40 layer { pits 250 radius .012, .064 stretch 20, 300 depth .1, .3 direction 30 spread 28 } }"
TILE = FRONT.replace("2*x", ".5*x").replace("2*y", ".5*y")


def scratched_tile(render, lobe, rest, size, block="", dump=True):
    words = f"texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ {lobe} {block} }} }} }}"
    return render(scene(f"{sheet()} {words} }}", rest, TILE), size=(size, size), dump=dump)


@pytest.mark.parametrize("lobe, light, limit", [
    (f"beckmann .1, .2 {SPARSE}", "0, 0", .05), (f"beckmann .1, .2 {SPARSE}", "10, 6", .035),  # one lobe: 23 % too dark, 2
    (f"ggx .15, .15 {SPARSE}", "0, 0", .05), (f"ggx .15, .15 {SPARSE}", "10, 6", .035),  # 23 and 19
    ('preset "brushed_steel" scratches { mm_per_unit 100 }', "0, 0", .035), ('preset "scratched_steel" scratches { mm_per_unit 100 }', "0, 0", .3)])  # 0; 95
def test_far_scratches_leave_the_plate_between_them(render, shade_check, lobe, light, limit):
    """What is not scratched keeps its own lobe: the mean of a tile from near."""
    def picture(size, dump=True):
        return scratched_tile(render, lobe, f"light_source {{ <{light}, -50>, rgb 1 parallel point_at 0 }}\n", size, dump=dump)
    near = picture(900, False).image.mean((0, 1))  # within .4 % of 1200
    for size in (20, 4):
        far = picture(size)
        assert far.image.mean((0, 1)) == pytest.approx(near, rel=limit), size
        shade_check(far.dump)
    shares = far.dump.channels["lobe2.share"] + far.dump.channels["lobe3.share"]
    assert (shares > 0).all() and (shares < 1).all()


@pytest.mark.parametrize("rest", ["background { rgb 1 }", "sphere { <2, 1, -9>, 3 pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }"])
def test_far_scratches_reflect_by_all_their_lobes(render, rest):
    """Rays drawn for one lobe of several have the density of them all."""
    near, far = (scratched_tile(render, f"beckmann .1, .2 {SPARSE}", rest, size, f"reflection {{ samples {samples} }}", False).image.mean()
                 for size, samples in ((600, 4), (6, 4096)))
    assert near > .05 and far == pytest.approx(near, rel=.02)


def test_scratches_run_where_they_are_told(render):
    """Slopes of scratches along a direction lie across it, and the texture's turns turn them."""
    def spread(words, place="", of_object=""):
        words = words.replace("direction 30 spread 10", "direction 30 spread 1")
        dump = render(scene(sheet() + f"texture {{ pigment {{ rgb 0 }} finish {{ mdf {{ {words} }} }} {place} }} {of_object} }}", SUN, FRONT), size=(200, 200)).dump
        x, y = (dump.Ns[dump.hit][:, k] / dump.Ns[dump.hit][:, 2] for k in (0, 1))
        xx, xy, yy = (x * x).mean(), (x * y).mean(), (y * y).mean()
        return np.degrees(.5 * np.arctan2(2 * xy, xx - yy)) % 180  # the axis that slopes spread along
    assert spread(SCRATCHES) == pytest.approx(120, abs=4)
    assert spread(SCRATCHES, "rotate 25*z") == pytest.approx(145, abs=4)
    assert spread(SCRATCHES.replace("direction 30", "direction -20")) == pytest.approx(70, abs=4)
    # what turns out of the plane, as the axis of a lathe may be, leaves them in it; an object takes them along, once
    assert spread(SCRATCHES + " tangent radial y", "rotate 90*x") == pytest.approx(120, abs=4)
    assert spread(SCRATCHES + " tangent radial y", "rotate 90*y") == pytest.approx(120, abs=4)
    assert spread(SCRATCHES + " tangent radial z", of_object="rotate 25*z") == pytest.approx(145, abs=4)


def test_far_scratches_are_wide_across_their_strokes(render):
    """A pixel of many strokes is as narrow along them as the plate, and as wide across them wherever the texture turns them."""
    words = SCRATCHES.replace("direction 30 spread 10", "direction 30 spread 1")
    plates = "".join(sheet() + f"scale <.3, 1, 1> translate {.65 * k - .65}*x texture {{ finish {{ mdf {{ ggx .1, .1 {words} }} }} rotate {25 * k}*z }} }}\n" for k in range(3))
    dump = render(scene(plates, SUN, FRONT), size=(24, 8)).dump
    wide = dump.channels["alpha.Y"]
    for k in range(3):
        of = dump.hit & (np.abs(dump.P[..., 0] - .65 * k + .65) < .28)
        angle, T, N = dump.channels["groove.A"][of], dump.T[of], dump.N[of]
        x, y, _ = T.T * np.cos(angle) + np.cross(N, T).T * np.sin(angle)
        assert of.sum() > 20 and np.degrees(np.arctan2(y, x)) % 180 == pytest.approx(30 + 25 * k, abs=1)
        assert dump.channels["alpha.X"][of] == pytest.approx(.1, rel=.01) and (wide[of] > .25).all()
        assert wide[of].mean() == pytest.approx(wide[dump.hit].mean(), rel=.01)


@pytest.mark.parametrize("shape, place", [("disc { 0, z, .9", "rotate <0, 40, 0> translate <.2, .1, .1>"), ("box { <-.9, -.9, -.1>, <.9, .9, .1>", "")])
def test_turning_leaves_circles(render, shape, place):
    """Round the axis of `tangent radial`, of one width and density wherever they are: slopes lie outward."""
    words = SCRATCHES.replace("direction 30 spread 10", "direction 0 spread 0")
    def slopes(shape, words, place=""):
        dump = render(scene(f"{shape} texture {{ pigment {{ rgb 0 }} finish {{ mdf {{ {words} }} }} }} {place} }}", SUN, FRONT), size=(300, 300)).dump
        there = dump.hit & (np.abs(dump.N[..., 2]) > .5)
        with np.errstate(invalid="ignore"):
            return dump, there, dump.Ns / np.sum(dump.N * dump.Ns, -1, keepdims=True) - dump.N
    dump, there, slope = slopes(shape, words + " tangent radial z", place)
    cos, sin = (np.cos(np.radians(40)), np.sin(np.radians(40))) if place else (1, 0)
    axis = np.array([sin, 0, cos])
    arm = dump.P - ([.2, .1, .1] if place else [0, 0, 0])
    arm -= (arm @ axis)[..., None] * axis
    radius = np.linalg.norm(arm, axis=-1)
    round_it, outward = np.sum(np.cross(axis, arm) * slope, -1) / radius, np.sum(arm * slope, -1) / radius
    _, flat, plain = slopes("plane { z, 0", words)
    share = lambda where, slope: (np.linalg.norm(slope[where], axis=-1) > .05).mean()
    for near, far in ((.1, .5), (.5, .85)):
        where = there & (radius > near) & (radius < far)
        assert where.sum() > 5000 and (outward[where] ** 2).mean() > 100 * (round_it[where] ** 2).mean() > 0
        assert share(where, slope) == pytest.approx(share(flat, plain), rel=.15)
    # outward, one scratch comes after another, as across those of the plane
    steps = lambda slope, where: (np.abs(np.diff(slope[:, 150][where[:, 150]])) > .01).mean()
    assert steps(outward, there) == pytest.approx(steps(plain[..., 1], flat), rel=.4)


def test_ends_of_a_range_may_change_places(render):
    def normals(words):
        return render(scene(sheet() + f"texture {{ finish {{ mdf {{ {words} }} }} }} }}", SUN, FRONT), size=(60, 60)).dump.Ns
    given = normals(SCRATCHES)
    for one, other in ((".01, .03", ".03, .01"), ("100, 400", "400, 100"), (".2, .4", ".4, .2")):
        np.testing.assert_allclose(normals(SCRATCHES.replace(one, other)), given, atol=1e-6)


def test_a_metal_preset_brings_its_scratches(render):
    def bumps(words):
        dump = render(scene(sheet() + f"texture {{ finish {{ mdf {{ {words} }} }} }} }}", SUN, FRONT), size=(40, 40)).dump
        return np.abs(dump.N - dump.Ns).max() + np.ptp(dump.channels.get("alpha.X", np.zeros(1)))
    assert bumps('preset "scratched_gold" scratches { mm_per_unit 20 }') > .01
    assert bumps('preset "scratched_gold" scratches off') == 0


def test_cloth_on_the_parts_of_a_blob(render):
    ball = "sphere {{ {} * x, 1, 1 texture {{ pigment {{ rgb 1 }} finish {{ mdf {{ fabric {{ preset \"denim\" }} }} }} }} }}"
    result = render(scene(f"blob {{ threshold .5 {ball.format(-.4)} {ball.format(.4)} }}"), size=(32, 24))
    assert result.message.count("without UV coordinates: it lies along two of the object's axes") == 1
    assert result.dump.hit.any() and result.image.max() > .01


def test_a_larger_tile_holds_more_of_the_same_scratches(render):
    """A quarter of a tile four times as wide: as rough, by scratches of the same width. A tile so large that they would be too many
    grows them, and says so."""
    def look(words):
        text = scene(sheet() + f"texture {{ pigment {{ rgb 0 }} finish {{ mdf {{ preset \"scratched_steel\" scratches {{ mm_per_unit 9 {words} }} }} }} }} }}", SUN, FRONT)
        dump = render(text, size=(300, 300)).dump
        tilted = dump.Ns[..., 2] > -.98
        edges = (tilted[:, 1:] != tilted[:, :-1]).mean()
        return tilted.mean(), edges
    share, edges = look("tile_mm 50")
    assert .1 < share < .5
    for words in ("tile_mm 200", 'preset "scratched_gold" tile_mm 9 tile_mm 150'):
        assert look(words) == pytest.approx((share, edges), rel=.2), words
    said = "mdf: a tile_mm of 10000 would hold more than a million scratches; they have grown instead."
    assert render(scene('#declare F = finish { mdf { preset "scratched_steel" scratches { tile_mm 10000 } } }\n'), (8, 6)).message.count(said) == 1


def test_the_tile_leaves_a_layers_lengths(render):
    layer = "layer { pits 4000 radius .01, .03 stretch 100, 400 depth .2, .4 direction 30 spread 10 }"
    def normals(words):
        return render(scene(sheet() + f"texture {{ finish {{ mdf {{ scratches {{ mm_per_unit 25 {words} }} }} }} }} }}", SUN, FRONT), size=(60, 60)).dump.Ns
    np.testing.assert_allclose(normals("tile_mm 12 " + layer), normals("tile_mm 40 " + layer + " tile_mm 12"), atol=1e-6)
    layer = layer.replace("4000", "300")
    plain = layer.replace("radius .01, .03", "")  # and those that it has if it says none
    np.testing.assert_allclose(normals("tile_mm 12 " + plain), normals(plain + " tile_mm 12"), atol=1e-6)
    # the first layer takes the place of a preset's, the second does not; another seed lays them elsewhere
    given = normals(f"tile_mm 12 seed 3 {layer}")
    np.testing.assert_allclose(normals(f'preset "scratched_gold" tile_mm 12 seed 3 {layer}'), given, atol=1e-6)
    assert np.abs(normals(f"tile_mm 12 seed 3 {layer} {layer.replace('direction 30', 'direction 90')}") - given).max() > .05
    assert np.abs(normals(f"tile_mm 12 seed 4 {layer}") - given).max() > .01


@pytest.mark.parametrize("block, message", [
    ("scratches 3", "mdf: expected '{' or 'off' after 'scratches', as in scratches { preset \"brushed_steel\" }, but found a number."), ('scratches { preset "denim" }', 'mdf: there is no metal "denim". Metals: brushed_steel,'),
    ("scratches { layer { pits } }", "mdf: pits needs a number"), ("scratches { layer { radius .1 } }", "mdf: the other end of radius needs a number, } found instead."),
    ("scratches {" + "layer { pits 1 } " * 9 + "}", "mdf: scratches have 8 layers at most."), ("scratches { layers 3 }", "did you mean 'layer'?"),
    ('fabric { preset "denin" }', 'mdf: there is no cloth "denin". Did you mean "denim"? Cloths: silk_charmeuse,'),
    ('preset "goldd"', 'mdf: there is no preset "goldd". Cloths: silk_charmeuse,'),
    ("preset denim", "mdf: preset needs a text in quotes, 'denim' found instead."),
    ("fabric { crosings 3 }", "did you mean 'crossings'?"),
    ("fabric { warp { widht 3 } }", "did you mean 'width'?"),
    ("fabric { crossings 1e300 * 1e300 }", "mdf: crossings is not a finite number."),
    ("fabric { weave 1, 2 }", "mdf: weave: shift needs a number, } found instead."), ("fabric { weave 0, 0, 0 }", "mdf: there is no weave 0, 0, 0"),
    ("fabric { weave 1.5, 1, 1 }", "mdf: weave needs three whole numbers"),
    ('fabric { weave "twil" }', 'mdf: there is no weave "twil"; there are: plain,'),
    ('fabric { draft "none.wif" }', "mdf: cannot open the draft 'none.wif'."),
    ('fabric { draft "scene.pov" }', "expected the sections of a Weaving Information File"),
    ("fabric { occlusion skyy }", "did you mean 'sky'?"), ("fabric { detail rotat }", "did you mean 'rotate'?"),
    ("fabric { warp { diffuse wool rgb 1 } }", "mdf: warp: diffuse needs a colour, 'wool' found instead."),
    ("fabric { shadows }", "expected 'on' or 'off'"), ("fabric { mm_per_unit }", "mdf: mm_per_unit needs a number"),
    ("fabric { backing }", "mdf: backing needs a colour"), ("fabric {", "found instead")])
def test_errors_name_what_was_expected(render, block, message):
    result = render(scene(f"sphere {{ 0, 1 texture {{ finish {{ mdf {{ {block} }} }} }} }}"), fails=True)
    assert result.status == 1 and "Parse Error" in result.log
    assert message.lower() in result.message.lower(), result.message


@pytest.mark.parametrize("block, message", [
    ("fabric { crossings 0 }", "mdf: crossings is 0; it is taken as 1e-06."),
    ("fabric { yarns { curve 3 } }", "mdf: yarns: curve is 3; it is taken as 0.98."),
    ("fabric { weft { diffuse rgb <2, 0, 0> } }", "mdf: weft: diffuse is <2, 0, 0>; it is taken as <1, 0, 0>."),
    ("fabric { nap -1 }", "mdf: nap is -1; it is taken as 0.")])
def test_numbers_out_of_range_are_warned_of_once(render, block, message):
    ball = f"sphere {{ 0, 1 texture {{ finish {{ mdf {{ {block} }} }} }} }}\n"
    assert render(scene(ball + ball), size=(8, 6)).message.count(message) == 1
