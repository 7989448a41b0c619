# SPDX-License-Identifier: Apache-2.0
"""The stability atlas: the printed formulas have the figures of docs/theory/papers.md, which C tests found; measures have
those of known lobes; no finding outlives rows that say otherwise; maps name what fails; --at prints it."""
import base64
import io
import re
import xml.etree.ElementTree

import numpy as np
import pytest
from PIL import Image

import atlas_at
import atlas_charts
import atlas_facing
import atlas_findings
import atlas_forms
import atlas_measures
import atlas_regions
import shade
import study_atlas
from atlas_forms import FORMS, dot
from atlas_measures import direction

COST = 8
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
    for angles in ((30, 20), (70, -130), (5, 110)):
        assert atlas_facing.spherical(direction(*angles)) == pytest.approx(angles)
    n, light = direction(30, 45), direction(60, 45)[None]
    for eye, horizon, jumps in ((60, "hard", True), (60, "valid_estevez", False), (40, "hard", False)):
        material = shade.Material(ex=10, ey=5, fresnel="none", horizon=horizon)
        assert (atlas_facing.stepped(material, n, direction(eye, 225), light, "eye")[0] > 1e-3) == jumps
        swap = atlas_facing.swapped(material, n, direction(eye, 225), light, "eye")[0]
        assert (swap[0] > 1e-6) == (horizon == "valid_estevez")


def test_rows_say_where_it_is_worst():
    """Light, eye and normal of a row give its number, and none of those that were tried gives more."""
    def asymmetry(horizon, tilt, azimuth, eye, light):
        material = FORMS["rotate"].material(horizon=horizon)
        there, back = (float(shade.eval(material, direction(tilt, azimuth), *both).f[..., 0]) for both in ((light, eye), (eye, light)))
        return abs(there - back) / max(there, back) if max(there, back) > 1e-3 else 0

    row, = (row for row in atlas_measures.pairs("rotate", "valid_estevez", 30, (30, 75), (0, 45), 3) if (row["eye"], row["light"]) == (75, 30))
    tried = {(azimuth, a, b): asymmetry("valid_estevez", 30, azimuth, direction(75, a), direction(30, b)) for azimuth in (0, 45) for a in (10, 130, 250) for b in (10, 130, 250)}
    at = row["azimuth"], row["eye_azimuth"], row["light_azimuth"]
    assert tried[at] == pytest.approx(row["asymmetry"], rel=1e-5) == max(tried.values()) and row["asymmetry"] > 0.01
    assert max(row["asymmetry"] for row in atlas_measures.pairs("rotate", "hard", 30, (30, 75), (0, 45), 3)) < 1e-5
    for which, other, angle in (("eye", "light", 75), ("light", "eye", 60)):
        row, = atlas_facing.facing("rotate", "valid_estevez", which, [30], [angle], (0, 45), 24 if which == "light" else 0)
        for name in ("asymmetry", "jump"):
            n, fixed = direction(30, row[f"{name}_azimuth"]), direction(angle, row[f"{name}_{which}_azimuth"])
            far = direction(row[f"{name}_{other}"], row[f"{name}_{other}_azimuth"])
            if name == "asymmetry":
                pair = (fixed, far) if which == "eye" else (far, fixed)
                assert asymmetry("valid_estevez", 30, row["asymmetry_azimuth"], *pair) == pytest.approx(row[name], rel=1e-4) and row[name] > 0.5
            else:
                found = atlas_facing.stepped(FORMS["rotate"].material(horizon="valid_estevez"), n, fixed, atlas_facing.others(fixed, n), which)
                assert found.max() == pytest.approx(row[name]) and np.allclose(atlas_facing.others(fixed, n)[found.argmax()], far)
        assert (row["map"], row[which], row["tilt"], row["nan"], "albedo" in row) == (which, angle, 30, 0, which == "light")
    material = FORMS["rotate"].material(horizon="valid_estevez")
    beams = {(azimuth, azimuth + turn): atlas_facing.returned(material, direction(30, azimuth), direction(60, azimuth + turn), 24, 0.07) for azimuth in (0, 45) for turn in (0, 90, 180, 270)}
    assert row["albedo"] == pytest.approx(beams[row["azimuth"], row["light_azimuth"]]) == max(beams.values())

    row, = atlas_measures.grazing("rotate", "hard", [60], [45], 256, (0, 45), 4)
    found = {}
    for azimuth in (0, 45):
        for turn in (0, 90, 180, 270):
            drawn = shade.sample(FORMS["rotate"].material(horizon="hard"), direction(60, azimuth), direction(45, turn), atlas_measures.numbers(256))
            weights = np.where(drawn.pdf > 0, drawn.f[:, 0] * drawn.cosine / np.where(drawn.pdf > 0, drawn.pdf, 1), 0)
            found[azimuth, turn] = weights.mean(), weights.std() / weights.mean() if weights.mean() > 0.05 else 0
    assert row["albedo"] == pytest.approx(found[row["azimuth"], row["eye_azimuth"]][0], rel=1e-5) == pytest.approx(max(albedo for albedo, _ in found.values()), rel=1e-5)
    assert row["spread"] == pytest.approx(found[row["spread_azimuth"], row["spread_eye_azimuth"]][1], rel=1e-4) == pytest.approx(max(spread for _, spread in found.values()), rel=1e-4)


def test_points_and_means_that_are_known():
    """A fibre lit from above and from its side; powers of a cosine along x and y where the azimuth has no limit; D' of a form that ignores n."""
    assert atlas_measures.over_fibre(np.array([[0, 0, 1.0], [0, 1, 0], [1, 0, 0]])) == pytest.approx([2 / np.pi, 1 / np.pi, 0], abs=1e-6)
    rows = atlas_measures.fibre([0, 60], [90, 180])
    assert [(row["theta"], row["azimuth"]) for row in rows] == [(0, 90), (0, 180), (60, 90), (60, 180)] and max(row["library_error"] for row in rows) < 1e-5
    jumps = {(row["form"], row["place"]): row["jump"] for row in atlas_measures.jumps() if row["distance"] == 1e-6}
    c = np.cos(np.radians(20))
    assert jumps["perturb", "h = z"] == pytest.approx(c**10 - c**200, rel=1e-3) and jumps["rotate", "h = z"] < 1e-3
    edges = {(row["horizon"], row["place"]): row["jump"] for row in atlas_measures.horizons() if row["distance"] == 1e-6}
    assert {horizon for horizon, _place in edges} == set(atlas_forms.HORIZONS)
    assert all((edges[horizon, place] > 1e-3) == (horizon == "hard") for horizon in ("hard", "valid_estevez") for place in ("wi.z = 0", "n·wo = 0"))
    points = atlas_measures.numbers(4096)
    assert points.shape == (4096, 2) and np.ptp(np.histogram2d(*points.T, bins=8, range=[[0, 1]] * 2)[0]) < 16
    rows = atlas_measures.lobe("none", [40], (20, 70), 60, 48)
    assert [row["size"] for row in rows] == [0, 0.1, 1, 10, 100, 1e3, 1e4, 1e5, 1e6] and {row["tilt"] for row in rows} == {40} and not any(row["nan"] for row in rows)
    for row in rows:
        assert row["energy"] == pytest.approx(1, abs=0.02) and row["azimuth"] in (20, 70)
        assert row["size"] < 10 or row["displaced"] == pytest.approx(40, abs=0.5), row  # a wide one is largest along the widest part of its arc
    wide = atlas_facing.widths("none", [30, 80])
    ends, fades = ({row["size"]: row for row in atlas_facing.widths(word, [30])} for word in ("ggx_rotate", "beckmann_rotate"))  # at the carried horizon, 90° off n
    assert ends[1]["theta"] == ends[10]["theta"] == -60 and ends[1]["jump"] > 1 and fades[1]["jump"] < 1e-4
    assert len(wide) == 18 and max(row["jump"] for row in wide) < 1e-2 and not any(row["nan"] for row in wide)
    rows = atlas_measures.rounded([40], (1, 1e6))
    for row in (row for row in rows if row["size"] == 1e6):  # of the wide axis, whose exponent is a twentieth
        n, h = (direction(row[f"{v}_theta"], row[f"{v}_phi"]) for v in "nh")
        assert min(abs(np.linalg.norm(np.cross(n, h)) * np.sqrt(1e6 / 20) / wide - 1) for wide in (0.2, 0.7, 1.5, 3)) < 0.01
    found = {(row["form"], row["size"]): row["error"] for row in rows}
    assert list(found) == [(word, size) for size in (1, 1e6) for word in ("literal", "common", "float", "double")]
    assert found["double", 1e6] < 1e-8 and found["float", 1e6] < 1e-4 < 1e-2 < found["literal", 1e6] and found["literal", 1] < 1e-5


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


@pytest.fixture(scope="module")
def told(rows):
    """{what makes a sentence: the sentence}."""
    return {one: one(rows).text for one in atlas_findings.ALL}


@pytest.mark.parametrize("word", ALTERED)
def test_altered_rows_falsify(rows, told, word):
    one, = (one for one, text in told.items() if word in text)
    finding = one(ALTERED[word](rows))
    assert word in finding.text and not finding.holds


# ---- regions, maps, commands ----------------------------------------------------------------------------------

def test_regions_are_named(rows):
    failed = atlas_regions.regions(rows)
    assert {r.failure for r in failed} == set(atlas_regions.FAILS) and all(r.explained for r in failed)
    assert len({(r.form, r.failure) for r in failed}) == len(failed)
    default = [r for r in failed if r.default]
    assert 0 < len(default) < len(failed) / 4 and not any("printed" in r.form or r.form in ("hard", "perturb") for r in default)
    assert ("valid_estevez", "asymmetry") in {(r.form, r.failure) for r in default}
    for met, places in ((True, [("rotate", "hard"), ("rotate", "valid_estevez")]), (True, [("ggx_rotate", None)]), (False, [("rotate", "hard"), ("warp", None)])):
        at = tuple({"form": form} | ({"horizon": horizon} if horizon else {}) for form, horizon in places)
        assert atlas_regions.Region(at[0]["form"], "asymmetry", at, at[0]).default == met  # one place is enough
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


HORIZONS = ["hard", "valid reflection", "estevez", "chiang", "schuessler", "valid estevez"]
OF_MAPS = {"pairs": HORIZONS, "pairs-eye": HORIZONS, "pairs-light": HORIZONS, "narrow-pairs": ["rotate", "rotate, default horizon"], "fibre": ["Eq. 10"],
           "rounding": ["pow, x² + y²", "pow, 1 − z²", "library, float", "library, double"], "peak": ["rotate", "conserving", "deform smooth,", "none", "without 1/L", "Beckmann rotated"]}


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
    assert all((row[-1] == "stays") == (row[-2] > 2e-5) for row in jumps.rows)
    for name, titles in OF_MAPS.items():  # letters of a line that are bold; a map whose title has two says them last first
        assert re.findall(r"font-weight: 600\">([^<]*)<", figures[name].svg) == titles, name
    for name, count in {"half-rotation": 6, "half-warp": 6, "half-usual": 4, "half-slopes": 9}.items():
        assert figures[name].svg.count(">n at 90°<") == count and figures[name].svg.count("<image") == 1 + 2 * count
    for name, horizons in {"steps-eye": 6, "steps-light": 6, "beam": 6, "albedo": 1, "spread": 1, "narrow-spread": 1, "narrow-albedo": 1}.items():
        words = ["rotate, default horizon"] if horizons == 1 else HORIZONS
        assert all(figures[name].svg.count(f">{word}<") == 1 for word in words) and ">Gram-Schmidt<" in figures[name].svg, name
    assert not any("as printed<" in figures[name].svg for name in ("spread", "narrow-spread", "beam", "steps-eye", "steps-light"))
    assert ">azimuth of light, °<" in figures["fibre"].svg and ">light from z, °<" in figures["fibre"].svg and "azimuth of n" not in figures["fibre"].svg
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
        if region.failure in ("displaced", "peak"):
            away = float(re.search(r", ([\d.e+-]+)° from n$", dict(lines)["D′ is largest at"])[1])
            assert away == pytest.approx(region.value, abs=1 if region.failure == "displaced" else 9), region
        if region.failure in ("weights", "narrow weights"):
            assert number(lines, "its deviation over the mean") == pytest.approx(region.value, rel=0.3), region
            assert number(lines, "mean of f cos/pdf, 65536 draws") == pytest.approx(number(lines, "albedo, by quadrature"), rel=0.03, abs=1e-3)
            assert number(lines, "mean of f cos/pdf") < number(lines, "largest weight") * (1 - number(lines, "draws that find no")) + 1e-5, region
        if region.failure in ("narrow furnace", "light furnace"):
            said = number(lines, "share of a beam given back" if region.failure == "light furnace" else "albedo, by quadrature")
            assert said == pytest.approx(region.value, rel=0.2), region
        if region.failure in ("light jump", "eye jump"):
            nearer, farther = map(float, dict(lines)[f"f cos with the {region.map} 10⁻⁷ rad nearer to z, and farther"].split(", "))
            assert abs(nearer - farther) > 1e-4 * max(nearer, farther), region
        if region.failure == "fibre":
            assert abs(number(lines, "Φ as printed") - number(lines, "mean over")) == pytest.approx(region.value, rel=1e-5)
            assert [number(lines, f"Φ of the {who}") for who in ("library", "reference")] == pytest.approx([number(lines, "mean over")] * 2, rel=1e-6)
        told_as_it_is(region, lines)
    for short, whole in ((["form=fibre_printed"], ["theta=45", "azimuth=150"]), (["form=rotate", "theta=10"], ["tilt=30", "azimuth=45"]),
                         (["form=rotate", "theta=-10", "azimuth=20"], ["phi=20"]), (["form=perturb", "eye=20", "light=30"], ["horizon=hard", "eye_azimuth=0", "light_azimuth=0"]),
                         (["form=rotate", "light=20"], ["horizon=hard", "light_azimuth=0", "tilt=30", "azimuth=45"]), (["form=chiang", "light=85"], ["horizon=chiang"])):
        assert atlas_at.at(atlas_at.parse(short)) == atlas_at.at(atlas_at.parse([*short, *whole])), short
    words = ["form=rotate", "tilt=30", "azimuth=20", "theta=10"]
    assert study_atlas.main(["--at", *words]) == 0
    said, lines = capsys.readouterr().out.splitlines(), atlas_at.at(atlas_at.parse(words))
    assert len(said) == len(lines) and len({line.index(value, len(what)) for line, (what, value) in zip(said, lines)}) == 1  # one column
    assert all(line.split("  ")[0] == what and line.endswith("  " + value) for line, (what, value) in zip(said, lines))


def told_as_it_is(region, lines):
    """What stands above and around of a sample: of which form and widths, n, light and eye; and what is the same by definition."""
    given, told = dict(word.split("=") for word in region.place().split()), dict(lines)
    vectors = {name: [float(x) for x in told[name].strip("()").split(", ")] for name in ("n", "h", "wi", "wo", "light") if name in told}

    def aims(name, theta, phi):
        """In degrees from z and about it."""
        theta, phi = np.radians([float(theta), float(phi)])
        assert vectors[name] == pytest.approx([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], abs=2e-9), region

    if given["form"] == "fibre_printed":
        aims("light", given["theta"], given["azimuth"])
        return
    form = FORMS.get(given["form"], FORMS["rotate"])
    assert told["form"] == form.label + (f" ({form.source})" if form.source else "")
    size = float(given.get("size", 200 if form.mdf == "ashikhmin_shirley" else 0.1))
    wide = (size, size / 20) if form.mdf == "ashikhmin_shirley" else (size, min(4 * size, 10))
    said = "{:g}, {:g}".format(*(wide[::-1] if given["form"] == "rotate_always_x" else wide))
    assert told[f"{form.mdf}, {'exponents' if form.mdf == 'ashikhmin_shirley' else 'alphas'}"] == said, region
    aims("n", given.get("n_theta", given.get("tilt")), given.get("n_phi", given.get("azimuth")))
    for name, word in (("wi", "light"), ("wo", "eye")):
        if name in told:
            aims(name, given[word], given.get(f"{word}_azimuth", 0))
    assert told.get("horizon", given.get("horizon")) == given.get("horizon")
    if "theta" in given:
        aims("h", given["theta"], given["azimuth"])
    if "n·wi" in told:
        assert number(lines, "n·wi") == pytest.approx(np.dot(vectors["n"], vectors["wi"]), abs=1e-8)
    same = []
    level = "wo" in vectors and abs(np.dot(vectors["n"], vectors["wo"])) < 1e-8  # on the horizon, one rounding decides
    if not form.printed and not level:  # what is drawn is the library's own
        same = [("f cos there", "that of the reference"), ("there D′", "there of the reference"), ("∫D′", "∫D′ of the library")]
    if given["form"] not in atlas_measures.FLOATS:
        same.append(("D′ of the library", "D′ of the reference"))
    for one, other in same:
        if any(what.startswith(one) for what in told):
            assert number(lines, one) == pytest.approx(number(lines, other), rel=1e-5), region


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


def drawn(text):
    """Of each SVG: (its viewBox, {words: places and anchors}, [pixels of its pictures and where they are], [paths])."""
    found = []
    for svg in xml.etree.ElementTree.fromstring(f"<all>{text}</all>".replace(' xmlns="http://www.w3.org/2000/svg"', "")):
        words, images, paths = {}, [], [path.get("d") for path in svg.iter("path")]
        for one in svg.iter("text"):
            words.setdefault("".join(one.itertext()), []).append((float(one.get("x")), float(one.get("y")), one.get("text-anchor")))
        for one in svg.iter("image"):
            pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(one.get("href").partition("base64,")[2]))))
            images.append((pixels, *(float(one.get(name)) for name in ("x", "y", "width", "height"))))
        found.append((svg.get("viewBox"), words, images, paths))
    return found


def furnace(albedo, **more):
    return {"map": "grazing", "form": "rotate", "horizon": "hard", "albedo": albedo, **more}


def test_a_map_is_drawn_to_scale():
    """Colours, ticks, heads, outline and name of cells whose numbers are known: the eye to the right, the tilt upwards."""
    numbers = {(0, 0): 0.0, (30, 0): 1.0, (60, 0): 2.0, (0, 30): 0.5, (30, 30): 1.5, (60, 30): 2.5}
    rows = [furnace(value, eye=float(eye), tilt=float(tilt)) for (eye, tilt), value in numbers.items()]
    scale, first, second = drawn(atlas_charts.maps([rows, rows, rows], "albedo", ("furnace",), ("eye", "tilt"), lambda _rows: "a title of more than a line's letters"))
    assert scale[0] == "0 0 360 52" and first[0] == second[0] == "0 -13 360 185"
    colours = {0: "08446b", 0.5: "4f9fcf", 1: "f4f4f4", 1.5: "ee9a5b", 2: "8f3b00"}
    rgb = {value: [int(colour[k:k + 2], 16) for k in (0, 2, 4)] for value, colour in colours.items()}
    (pixels, *place), = scale[2]
    assert place == [20, 18, 320, 14] and pixels.shape == (1, 320, 3) and [pixels[0, k].tolist() for k in (0, -1)] == [rgb[0], rgb[2]]
    assert {words: at for words, at in scale[1].items() if words[0] in "012"} == {
        words: [(x, 44, "middle")] for words, x in (("0", 20), ("0.5", 100), ("1", 180), ("1.5", 260), ("2", 340))}
    assert scale[1]["albedo of a white metal, worst azimuth"] == [(20, 12, "start")]
    assert [image[1:] for image in first[2]] == [(42, 20, 142, 118), (210, 20, 142, 118)] and [image[1:] for image in second[2]] == [(42, 20, 142, 118)]
    for pixels, *_place in first[2]:
        assert pixels.shape == (118, 142, 3)
        for (eye, tilt), value in numbers.items():  # cells reach half way to the next
            for across, up in ((-14, -14), (14, 14), (0, 0)):
                at = pixels[117 - int((tilt + up + 15) / 60 * 118), int((eye + across + 15) / 90 * 142)]
                assert at.tolist() == rgb[min(value, 2)], (eye, tilt)
    words = first[1]
    for tick in (0, 30, 60):
        below = [(round(left + (tick + 15) / 90 * 142, 1), 151, "middle") for left in (42, 210)]
        beside = [(37, round(138 - (tick + 15) / 60 * 118 + 4, 1), "end")] if tick < 60 else []
        assert words[f"{tick}"] == below[:1] + beside + below[1:], tick
    assert words["eye from z, °"] == [(113, 165, "middle"), (281, 165, "middle")] and words["tilt of n, °"] == [(10, 82, "middle")]
    assert words["a title of more than a"] == [(42, 0, "start"), (210, 0, "start")] and words["line's letters"] == [(42, 13, "start"), (210, 13, "start")]
    for x, left in ((words["unexplained"][0][0], 42), (words["unexplained"][1][0], 210)):
        assert left < x < left + 142 and words["unexplained"][0][2] == "middle"
    wide = 0.53 * 11 * len("unexplained") / 2
    assert first[1]["unexplained"][0][0] + wide <= 42 + 142 and 20 + 13 <= words["unexplained"][0][1] <= 138
    edge = first[3][0]  # round what is over 1.01: from an eye at 45° below, from one at 15° above
    lines = {tuple(sorted({(float(x), float(y)), (float(end), float(y)) if word == "H" else (float(x), float(end))}))
             for x, y, word, end in re.findall(r"M([\d.]+) ([\d.]+)([HV])([\d.]+)", edge)}
    assert lines == {((136.7, 138), (184, 138)), ((89.3, 20), (184, 20)), ((184, 20), (184, 138)), ((89.3, 20), (89.3, 79)), ((136.7, 79), (136.7, 138)),
                     ((89.3, 79), (136.7, 79))} and first[3][1] == edge


@pytest.mark.parametrize("column, values, ticks", [
    ("theta", range(-90, 91, 15), {"−90": 0.5 / 13, "−45": 3.5 / 13, "0": 0.5, "45": 9.5 / 13, "90": 12.5 / 13}),
    ("azimuth", range(0, 346, 15), {"0": 0.5 / 24, "90": 6.5 / 24, "180": 12.5 / 24, "270": 18.5 / 24}),
    ("size", (0, 10, 100, 1e3, 1e6), {"0": 0.1, "100": 0.5, "10⁶": 0.9})])
def test_ticks_of_maps(column, values, ticks):
    """Of angles where they are, of sizes at their decades."""
    rows = [furnace(1.0, **{column: float(value)}, tilt=float(tilt)) for value in values for tick in (0,) for tilt in (tick, 30)]
    words = drawn(atlas_charts.maps([rows], "albedo", (), (column, "tilt"), lambda _rows: "so"))[1][1]
    below = {said: (x - 42) / 142 for said, places in words.items() for x, y, _anchor in places if y == 151}
    assert below == {said: pytest.approx(at, abs=1e-3) for said, at in ticks.items()}


def test_scales_of_numbers():
    """Of a logarithmic one decades are as far apart; what is below or above has the end's colour, NaN is grey."""
    scale = atlas_charts.Scale(1e-3, 10, atlas_charts.ramp("#000000", "#0000ff"), "x", True)
    assert scale.ticks() == pytest.approx([1e-3, 1e-2, 0.1, 1, 10]) and scale.place(np.array([1e-3, 0.1, 10, 1e-9])) == pytest.approx([0, 0.5, 1, 0])
    assert scale.rgb(np.array([[1e-9, 1e-3, 0.1, 10, 99, np.nan]]))[0].tolist() == [[0, 0, 0], [0, 0, 0], [0, 0, 128], [0, 0, 255], [0, 0, 255], [154, 160, 166]]
    plain = atlas_charts.Scale(-1, 1, atlas_charts.ramp("#000000", "#0000ff"), "x")
    assert plain.ticks() == [-1, -0.5, 0, 0.5, 1] and plain.place(0.5) == 0.75
    half, lobe, fibre = (atlas_charts.SCALES[name][0] for name in ("half", "lobe", "fibre"))
    assert half({"nan": 0, "error": 0.2}) == fibre({"nan": 0, "error": 0.2}) == 0.2 and np.isnan([half({"nan": 1, "error": 0.2}), fibre({"nan": 1, "error": 0.2})]).all()
    assert lobe({"energy": 1.25, "true_energy": 0.5}) == 0.75


def test_names_keep_clear_of_each_other():
    """In the middle of their region where there is room, else beside what is there, and never outside of the map."""
    mask, xs, ys = np.ones((5, 5), bool), [20 * k for k in range(6)], [100 - 20 * k for k in range(6)]
    assert atlas_charts.place_of(mask, [], xs, ys, 30, 13) == (50, 50)
    x, y = atlas_charts.place_of(mask, [(50, 50, 30)], xs, ys, 30, 13)
    assert abs(y - 50) >= 15 or abs(x - 50) >= 33
    mask[:, 1:] = False
    assert atlas_charts.place_of(mask, [], xs, ys, 60, 13)[0] == 32
    mask[:], mask[0, 4] = False, True
    assert atlas_charts.place_of(mask, [], xs, ys, 60, 13) == (68, 90)
    mask[:], mask[4, 0] = False, True
    assert atlas_charts.place_of(mask, [], xs, ys, 10, 13) == (10, 13)


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


def test_rounding_is_told_where_it_was_found(rows):
    """The normal leans as far as its row says, towards one of three sides, and h stands off it."""
    found = [row for row in rows if row["map"] == "float"]
    assert {row["size"] for row in found} == {10.0**k for k in range(7)} and {row["tilt"] for row in found} >= set(range(0, 90, 10))
    assert all(len(set(np.diff(sorted({row["tilt"] for row in rows if row["map"] == name})))) == 1 for name in ("lobe", "wide", "grazing"))  # a map's rows are as far apart
    for row in found:
        n, h = (direction(row[f"{v}_theta"], row[f"{v}_phi"]) for v in "nh")
        assert row["n_theta"] == pytest.approx(row["tilt"], abs=1e-3) and (row["tilt"] == 0 or min(abs(row["n_phi"] - a) for a in (0, 35, 90)) < 1e-3)
        assert np.dot(n, h) < 1
    assert any(abs(row["h_theta"] - row["tilt"]) > 1 for row in found)
