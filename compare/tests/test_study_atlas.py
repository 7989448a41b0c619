# SPDX-License-Identifier: Apache-2.0
"""The stability atlas: the printed formulas have the figures of docs/theory/papers.md, which C tests found; measures have
those of known lobes; no finding outlives rows that say otherwise; maps name what fails; --at prints it."""
import xml.etree.ElementTree

import numpy as np
import pytest

import atlas_at
import atlas_charts
import atlas_facing
import atlas_forms
import atlas_measures
import atlas_regions
import shade
import study_atlas
from atlas_forms import FORMS, dot
from atlas_measures import direction

COST = 11
TOGETHER = "report"

H, SOLID = atlas_measures.hemisphere(160, 320)
AZIMUTHS = (np.arange(24) + 0.5) * 15
EXPONENTS = (200.0, 10.0)


def variation(value, tilt, shape, mdf="ashikhmin_shirley", groove="x"):
    """Total variation against the displaced surface, mean over azimuths of n."""
    return np.mean([(np.abs(value(n, H, shape) - atlas_forms.truth(n, H, shape, mdf, groove)) * SOLID).sum() / 2
                    for n in (direction(tilt, a) for a in AZIMUTHS)])


# ---- printed formulas: docs/theory/papers.md, which tells what the C tests found ------------------------------

@pytest.mark.parametrize("word, tilt, shape, want", [
    ("rotate_row_two", 30, EXPONENTS, 0.420), ("rotate_always_x", 30, EXPONENTS[::-1], 0.116),
    ("ward_of_h", 30, (0.1, 0.5), 0.875), ("perturb", 30, EXPONENTS, 0.513),
    ("deform_linear_printed", 30, EXPONENTS, 0.448), ("deform_linear", 45, EXPONENTS, 0.657),
    ("deform_smooth", 30, EXPONENTS, 0.240), ("gram_schmidt", 30, EXPONENTS, 0.116),
    ("shortest_arc", 45, EXPONENTS, 0.137), ("none", 20, EXPONENTS, 0.835)])
def test_total_variation(word, tilt, shape, want):
    form = FORMS[word]
    assert variation(form.value, tilt, shape, form.mdf, form.groove) == pytest.approx(want, abs=1.5e-3)


@pytest.mark.parametrize("mdf, want", [("beckmann", 0.228), ("ggx", 0.243)])
def test_short_of_l(mdf, want):
    """Of the widths that match exponents 200 and 10."""
    shape = tuple(np.sqrt(2 / (np.array(EXPONENTS) + 2)))
    assert variation(FORMS[f"{mdf}_short_of_l"].value, 45, shape, mdf) == pytest.approx(want, abs=1.5e-3)


@pytest.mark.parametrize("mdf, want", [("beckmann", 1.121), ("ggx", 0.987)])
def test_unnormalised(mdf, want):
    n, shape = direction(30, np.degrees(1)), (0.2, 0.2)
    off = (np.abs(FORMS[f"{mdf}_unnormalised"].value(n, H, shape) - atlas_forms.truth(n, H, shape, mdf)) * SOLID).sum()
    assert off / 2 == pytest.approx(want, abs=2e-3)


@pytest.mark.parametrize("tilt, want", [(30, 0.105), (45, 0.250), (60, 0.472)])
def test_common_denominator(tilt, want):
    form = FORMS["rotate_denominator"]
    normals = [direction(tilt, a) for a in range(0, 360, 15)]
    off = max(np.abs(form.value(n, H) - form.truth(n, H)).max() for n in normals)
    assert off / form.peak() == pytest.approx(want, abs=2e-3)


def test_rows_of_the_matrix():
    """Corrected they are the displaced frame times L; row 3 as printed integrates to 2π of the peak; Ward without
    squares is 212.5 times its peak at hx = −½."""
    n = direction(40, 70)
    x, y, z = atlas_forms.matrix(n, H)
    true = atlas_forms.displaced(n, H)
    root = np.sqrt(1 - n[1] ** 2)
    for ours, theirs in zip((x / root, y / root, z), true):
        assert ours == pytest.approx(theirs, abs=1e-14)
    assert (FORMS["rotate_row_three"].value(n, H) * SOLID).sum() == pytest.approx(np.sqrt(201 * 11), rel=1e-4)
    h = np.array([-0.5, 0, np.sqrt(0.75)])
    shape = (0.1, 0.5)
    form = FORMS["ward_no_squares"]
    assert form.value(np.array([0, 0, 1.0]), h, shape) / form.peak(shape) == pytest.approx(212.5, abs=0.1)


@pytest.mark.parametrize("delta, outside", [(0.3, 0.036), (0.5, 0.087), (0.7, 0.151), (0.98, 0.255)])
def test_smooth_warp_leaves_the_disc(delta, outside):
    row, = atlas_measures.normal("deform_smooth_printed", [np.degrees(np.arcsin(delta))], [0], 160)
    assert row["off_share"] == pytest.approx(outside, abs=2e-3) and row["nan_share"] == pytest.approx(outside, abs=2e-3)
    row, = atlas_measures.normal("deform_smooth", [np.degrees(np.arcsin(delta))], [0], 160)
    assert row["nan_share"] == 0


@pytest.mark.parametrize("word, n, want", [
    ("perturb", (0.3, 0), 0.652), ("perturb", (0, 0.3), 1.263), ("deform_linear", (0.3, 0), 1.028),
    ("deform_linear", (0, 0.3), 1.020), ("deform_smooth", (0.3, 0), 1.012), ("deform_smooth", (0.5, 0.5), 1.065),
    ("rotate", (0.5, 0.5), 0.9999), ("deform_linear_conserving", (0.5, 0.5), 1.0)])
def test_energy(word, n, want):
    """By an independent computation: method.md and docs/theory/papers.md."""
    tilt, azimuth = np.degrees(np.arcsin(np.hypot(*n))), np.degrees(np.arctan2(n[1], n[0]))
    row, = atlas_measures.normal(word, [tilt], [azimuth], 160)
    assert row["energy"] == pytest.approx(want, abs=1.5e-3)


# ---- measures of what is known -------------------------------------------------------------------------

def test_peaks_are_found():
    """Of no detail it stands at z, of rotate at n; a form that is moved is found where it is."""
    rows = atlas_measures.normal("none", [35], [20], 48)
    assert rows[0]["displaced"] == pytest.approx(35, abs=0.05)
    assert atlas_measures.normal("rotate", [35], [20], 48)[0]["displaced"] == 0
    moved = direction(28, 55)
    n = direction(30, 50)
    form = FORMS["rotate"]

    class Moved:
        value = staticmethod(lambda _n, h: form.value(moved, h))

    best = atlas_measures.peak_at(Moved, n, H[np.argmax(form.value(moved, H))])
    assert dot(best, moved) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("size", [0.0, 10.0, 1e3, 1e6])
def test_rings_hold_lobes_of_any_width(size):
    """∫D = 1 of Ashikhmin-Shirley's, whatever the exponents."""
    form, n = FORMS["rotate"], np.array([0, 0, 1.0])
    h, solid = atlas_measures.about(n, 1 / np.sqrt(max(size, 1)), 160, 96)
    value = form.value(n, h, atlas_measures.shape_of(form, size))
    assert (value * solid).sum() == pytest.approx(1, abs=0.01)


def test_jumps_and_halves():
    row = next(r for r in atlas_measures.half("perturb", [10], [0], 60) if r["theta"] == 0)
    along, across = (FORMS["perturb"].value(direction(10, 60), direction(1e-5, p)) for p in (60, 150))
    assert row["jump"] >= 0.5 * abs(along - across) / FORMS["perturb"].peak() > 0.05
    assert max(r["jump"] for r in atlas_measures.half("rotate", [0, 30, 60], range(-80, 90, 20), 60)) < 1e-5
    grid = atlas_measures.half("none", [40], [0, 40], 45)
    assert grid[0]["error"] > 0.9 and [r["nan"] for r in grid] == [0, 0]


def test_albedo_of_what_is_drawn_and_of_a_quadrature():
    """A printed form that is the library's own gives the library's albedo."""
    literal = atlas_forms.Form("x", "x", "x", "rotate", printed=lambda n, h, s: atlas_forms.truth(n, h, s))
    FORMS["x"] = literal
    try:
        ours, = atlas_measures.grazing("rotate", "hard", [20], [30], 8192, (45,), 2)
        theirs, = atlas_measures.grazing("x", "hard", [20], [30], 64, (45,), 2)
    finally:
        del FORMS["x"]
    assert ours["albedo"] == pytest.approx(theirs["albedo"], rel=0.02) and 0.5 < ours["albedo"] < 1
    assert 0 < ours["spread"] < 2 and theirs["spread"] == 0


def test_a_beam_and_an_eye_get_the_same_of_what_is_reciprocal():
    """∫ f cos over eyes for a beam is that over lights for an eye; the latter by draws, and by a grid of directions."""
    n, material = direction(25, 45), FORMS["rotate"].material(horizon="hard")
    for theta, phi in ((0, 0), (50, 45), (70, 225)):
        v = direction(theta, phi)
        drawn = shade.sample(material, n, v, atlas_measures.numbers(16384))
        weights = np.where(drawn.pdf > 0, drawn.f[:, 0] * drawn.cosine / np.where(drawn.pdf > 0, drawn.pdf, 1), 0)
        given = atlas_facing.returned(material, n, v, 120, 0.07)
        assert given == pytest.approx(weights.mean(), rel=0.02)
        f, cosine = shade.eval(material, n, H, v)
        assert given == pytest.approx((f[:, 0] * cosine * SOLID).sum(), rel=0.01)


def test_a_printed_form_of_any_width_has_the_librarys_albedo():
    FORMS["x"] = atlas_forms.Form("x", "x", "x", "rotate", printed=lambda n, h, s: atlas_forms.truth(n, h, s))
    try:
        theirs = atlas_facing.narrow("x", "hard", [30], 85, 64, turns=1, azimuths=(180,), rings=120)
        ours = atlas_facing.narrow("rotate", "hard", [30], 85, 16384, turns=1, azimuths=(180,))
    finally:
        del FORMS["x"]
    for one, other in zip(ours, theirs):
        assert one["size"] == other["size"] and other["albedo"] == pytest.approx(one["albedo"], rel=0.03, abs=3e-3)


def test_steps_are_jumps_and_slopes_are_none():
    """Across n's horizon `hard` cuts the lobe, the default does not; far from it neither steps."""
    n, light = direction(30, 45), direction(60, 45)[None]
    for eye, horizon, jumps in ((60, "hard", True), (60, "valid_estevez", False), (40, "hard", False)):
        material = shade.Material(ex=10, ey=5, fresnel="none", horizon=horizon)
        assert (atlas_facing.stepped(material, n, direction(eye, 225), light, "eye")[0] > 1e-3) == jumps
        swap = atlas_facing.swapped(material, n, direction(eye, 225), light, "eye")[0]
        assert (swap[0] > 1e-6) == (horizon == "valid_estevez")


# ---- findings -----------------------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def rows(quick_rows):
    made = quick_rows(study_atlas, study_atlas.tasks(True), None)
    return [{key: value for key, value in row.items() if value != ""} for row in made]


def changed(rows, change, **same):
    """The rows, with `change` applied to those that have these values."""
    return [{**r, **change(r)} if all(r.get(k) == v for k, v in same.items()) else r for r in rows]


ALTERED = {  # a word of each sentence: rows that make it false
    "is the displaced surface": lambda r: changed(r, lambda _: {"error": 1e-6}, map="half", form="rotate", tilt=40.0,
                                                  theta=40.0),
    "No NaN leaves": lambda r: changed(r, lambda _: {"nan": 1}, map="lobe", form="rotate", size=1e6, tilt=30.0),
    "leaves the disc": lambda r: changed(r, lambda _: {"off_share": 0.0}, map="normal", form="deform_smooth_printed"),
    "row 2 of the rotation": lambda r: changed(r, lambda v: {"energy": v["true_energy"]}, map="normal",
                                               form="rotate_row_two"),
    "∫D′ leaves 1": lambda r: changed(r, lambda _: {"energy": 1.2}, map="normal", form="deform_smooth_conserving",
                                      tilt=30.0),
    "The peak stands": lambda r: changed(r, lambda _: {"displaced": 1.5}, map="normal", form="shortest_arc", tilt=40.0),
    "At every exponent from 0": lambda r: changed(r, lambda _: {"displaced": 3.0}, map="lobe", form="gram_schmidt",
                                                  size=1e4),
    "At every tilt and angle of light": lambda r: changed(r, lambda _: {"jump": 0.1}, map="light", form="rotate",
                                                          horizon="valid_estevez", light=90.0),
    "Of a beam of light": lambda r: changed(r, lambda _: {"albedo": 1.1}, map="light", form="rotate",
                                            horizon="valid_estevez", light=85.0),
    "For an eye 85°": lambda r: changed(r, lambda _: {"albedo": 1.1}, map="narrow", form="rotate", size=1e6),
    "D′ jumps, in": lambda r: changed(r, lambda _: {"jump": 1e-3}, map="jump", form="rotate", place="h = z"),
    "Across the surface's": lambda r: changed(r, lambda _: {"jump": 0.2}, map="edge", horizon="valid_estevez",
                                              place="n·wo = 0"),
    "white furnace": lambda r: changed(r, lambda _: {"albedo": 1.02}, map="grazing", form="rotate", tilt=15.0),
    "Sampling weights": lambda r: changed(r, lambda _: {"spread": 11.0}, map="grazing", form="rotate", tilt=60.0),
    "is reciprocal with": lambda r: changed(r, lambda _: {"asymmetry": 1e-3}, map="narrow", form="shortest_arc", size=1e4),
    "textbook frame": lambda r: changed(r, lambda _: {"error": 1e-3}, map="float", form="float", size=1e6),
    "Slope distributions": lambda r: changed(changed(r, lambda _: {"error": 0.0}, map="half", form="ggx_short_of_l"),
                                             lambda _: {"error": 0.0}, map="half", form="beckmann_short_of_l"),
    "fibre integral": lambda r: changed(r, lambda _: {"library_error": 1e-3}, map="fibre", theta=30.0),
    "regions that fail": lambda r: changed(r, lambda _: {"displaced": 4.0}, map="normal", form="rotate", tilt=40.0)}


def test_findings_hold(rows):
    found = study_atlas.findings(rows)
    assert [f.text for f in found if not f.holds] == []
    assert all(sum(word in f.text for f in found) == 1 for word in ALTERED) and len(found) == len(ALTERED)


@pytest.mark.parametrize("word", ALTERED)
def test_altered_rows_falsify(rows, word):
    finding, = (f for f in study_atlas.findings(ALTERED[word](rows)) if word in f.text)
    assert not finding.holds


# ---- regions, maps, commands ----------------------------------------------------------------------------------

def test_regions_are_named(rows):
    failed = atlas_regions.regions(rows)
    assert {r.failure for r in failed} == set(atlas_regions.FAILS) and all(r.explained for r in failed)
    assert len({(r.form, r.failure) for r in failed}) == len(failed)
    default = [r for r in failed if r.default]
    assert 0 < len(default) < len(failed) / 4 and not any("printed" in r.form or r.form in ("hard", "perturb") for r in default)
    assert ("valid_estevez", "asymmetry") in {(r.form, r.failure) for r in default}
    strange = changed(rows, lambda _: {"displaced": 4.0}, map="normal", form="rotate")
    assert any(r.name == "unexplained" for r in atlas_regions.regions(strange))


TITLES = {
    "half-rotation": "Rotation, as printed and corrected: D′ over tilt and half vector", "half-warp": "Warps of the disc: D′ over tilt and half vector",
    "half-usual": "What renderers do: D′ over tilt and half vector", "half-slopes": "Ward, Beckmann, GGX: D′ over tilt and half vector", "energy": "Light made or lost",
    "displaced": "Displacement of the peak", "lobe": "Lobes of any width", "rounding": "Rounding", "albedo": "White furnace", "spread": "Sampling weights",
    "pairs": "Exchange of light and eye", "wide": "Jumps of lobes of any width", "peak": "Displacement of the peak of lobes of any width",
    "narrow-albedo": "White furnace, lobes of any width", "narrow-spread": "Sampling weights, lobes of any width", "narrow-pairs": "Exchange of light and eye, lobes of any width",
    "beam": "Light that grazes: what a beam gives back", "pairs-eye": "Exchange of light and eye, by the eye's angle", "steps-eye": "Jumps of f cos, by the eye's angle",
    "pairs-light": "Exchange of light and eye, by the light's angle", "steps-light": "Jumps of f cos, by the light's angle", "fibre": "The fibre integral as printed"}


def test_maps_name_what_fails(rows):
    """Each region's name stands on a map of its kind, the SVG is well formed and holds no number of a NaN."""
    figures = {f.id: f for f in study_atlas.figures(rows)}
    assert {name: figure.title for name, figure in figures.items()} == TITLES
    assert all("Outlined: " in figure.caption and figure.caption.endswith(f" Made by `{study_atlas.COMMAND}`.") and len(figure.alt) > 40 for figure in figures.values())
    assert [(table.id, list(table.columns)[:8]) for table in study_atlas.tables(rows)] == [
        ("regions", ["region", "form", "default", "where", "measure", "at its worst", "why, and instead", "--at"]),
        ("jumps", ["of", "where", *(f"at {distance:g} rad" for distance in sorted({row["distance"] for row in study_atlas.of(rows, "jump")}, reverse=True)), "jump"])]
    shown = "".join(f.svg for f in figures.values())
    for region in atlas_regions.regions(rows):
        assert f">{atlas_charts.html.escape(region.name)}<" in shown, region
    for figure in figures.values():
        xml.etree.ElementTree.fromstring(f"<all>{figure.svg}</all>")
        assert "nan" not in figure.svg.replace("NaN", "").split("base64")[0] and figure.alt and len(figure.svg) < 400000
    regions, jumps = study_atlas.tables(rows)
    assert len(regions.rows) == len(atlas_regions.regions(rows))
    assert all(len(row) == len(regions.columns) for row in regions.rows)
    assert {row[-1] for row in jumps.rows} == {"stays", "vanishes"}
    distances = sorted({row["distance"] for row in study_atlas.of(rows, "jump")}, reverse=True)
    jump = {(row["form"], row["place"], row["distance"]): row["jump"] for row in study_atlas.of(rows, "jump")}
    for (form, place), row in zip(dict.fromkeys(key[:2] for key in jump), jumps.rows):
        assert row[:2] == ["D′, " + study_atlas.FORMS[form].label, place] and row[2:-1] == [jump[form, place, far] for far in distances]
    assert any(row[2] != row[-2] for row in jumps.rows)
    linked = {f.figure for f in study_atlas.findings(rows)}
    assert linked <= {*figures, "regions", "jumps"}


def test_a_region_is_outlined():
    """A path round two cells side by side: four lines."""
    mask = np.zeros((3, 4), bool)
    mask[1, 1:3] = True
    path = atlas_charts.outline(mask, [0, 10, 20, 30, 40], [30, 20, 10, 0])
    assert path.count("<path") == 2
    lines = path.split('"')[1].split("M")[1:]
    assert sorted(lines) == sorted(["10.0 20.0H30.0", "10.0 10.0H30.0", "10.0 20.0V10.0", "30.0 20.0V10.0"])


def number(lines, word):
    return float(next(value for what, value in lines if word in what).split()[0])


def test_commands_print_the_sample(rows, capsys):
    """The command of each region runs; what it prints is what the map has."""
    for region in atlas_regions.regions(rows):
        lines = atlas_at.at(atlas_at.parse(region.place().split()))
        if region.failure == "wrong" and FORMS[region.form].printed:
            off = abs(number(lines, "D′ as printed") - number(lines, "D′ of the displaced"))
            assert off / number(lines, "peak") == pytest.approx(region.value, rel=1e-6)
            assert number(lines, "D′ of the library") == pytest.approx(number(lines, "D′ of the reference"), rel=1e-9)
        if region.failure == "nan":
            assert np.isnan(number(lines, "D′ as printed")) and np.isfinite(number(lines, "D′ of the library"))
        if region.failure == "off":
            assert number(lines, "|p|") > 1 and number(lines, "D′ of the library") == 0
        if region.failure in ("energy", "lobe"):
            off = abs(number(lines, "∫D′") - number(lines, "∫D′ of the displaced"))
            assert off == pytest.approx(region.value, rel=0.1, abs=0.03), region
        if region.failure == "furnace":
            assert number(lines, "albedo") == pytest.approx(region.value, rel=0.1)
        if region.failure == "asymmetry":
            a, b = number(lines, "f(wi, wo)"), number(lines, "f(wo, wi)")
            assert abs(a - b) / max(a, b) == pytest.approx(region.value, rel=1e-6)
            assert a == pytest.approx(number(lines, "f(wi, wo) of the reference"), rel=1e-9)
        if region.failure == "rounding":
            off = number(lines, "of float n and h") / number(lines, "D′ of the displaced") - 1
            assert abs(off) == pytest.approx(region.value, rel=0.02)
    for short, whole in ((["form=fibre_printed"], ["theta=45", "azimuth=150"]), (["form=rotate", "theta=10"], ["tilt=30", "azimuth=45"])):
        assert atlas_at.at(atlas_at.parse(short)) == atlas_at.at(atlas_at.parse([*short, *whole])), short
    assert study_atlas.main(["--at", "form=rotate", "tilt=30", "azimuth=20", "theta=10"]) == 0
    assert "D′ of the reference" in capsys.readouterr().out


@pytest.mark.parametrize("words, says", [
    (["form=rotat"], "form=rotat: expected one of rotate_row_two"),
    (["form=rotate", "tilt=high"], "tilt=high: expected a number"), (["form=rotate", "tilt=nan"], "expected a number"),
    (["tilt=3"], "form=… is missing"), (["form"], "expected KEY=VALUE"),
    (["form=rotate", "angle=3"], "angle=: expected one of"),
    (["form=rotate", "horizon=soft"], "horizon=soft: expected one of")])
def test_bad_places(words, says):
    with pytest.raises(ValueError, match=says):
        atlas_at.parse(words)


def test_a_ramp_begins_and_ends_with_its_stops():
    colours = atlas_charts.ramp("#102030", "#204060", "#ff0000")
    wanted = [(16, 32, 48), (16, 32, 48), (24, 48, 72), (32, 64, 96), (255, 0, 0), (255, 0, 0)]
    assert np.array_equal(colours(np.array([-1, 0, 0.25, 0.5, 1, 2])), wanted)


def test_sizes_of_lobes_are_called_what_they_are(rows):
    """Exponents of Ashikhmin and Shirley's form, alphas of all others."""
    seen = set()
    for group in atlas_charts.grouped([row for row in rows if row["map"] == "lobe"], "form"):
        form = FORMS[group[0]["form"]]
        made = atlas_charts.maps([group], "lobe", (), ("size", "tilt"), lambda _rows: "a title")
        assert (">α<" in made, ">exponent<" in made) == ((False, True) if form.mdf == "ashikhmin_shirley" else (True, False)), form
        assert ">a title<" in made and ">tilt of n, °<" in made
        seen.add(form.mdf == "ashikhmin_shirley")
    assert seen == {False, True}
