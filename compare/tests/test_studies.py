# SPDX-License-Identifier: Apache-2.0
"""Sections of the report on rows of round numbers: sentences, tables and charts say what these are; what the tasks ask of `shade bench`."""
import csv
import io
from types import SimpleNamespace as Of

import numpy as np
import pytest

import answers
import fronts
import study_cloth
import study_diffuse
import study_horizons
import study_lobes
import study_precision
import study_speed
import style

COST = 3.7

RUNS = (0.9, 1.0, 1.2)  # of a time: its median is it, the middle half .95 to 1.1
STEADY = ("perturb", "lambert", "max_normal", "hard", "near", "float", 1)  # what others are compared with: all runs the same
NAME = "ashikhmin_shirley"


def timed(ns, **columns):
    steady = columns.get("method", columns.get("lobes", columns.get("precision"))) in STEADY
    return [{"kind": "speed", "run": run, "ns": ns * (1 if steady else share), **columns} for run, share in enumerate(RUNS)]


def wrong(error, **columns):
    """Its bar: half as much to twice."""
    return {"kind": "error", "error": error, "error_low": error / 2, "error_high": 2 * error, **columns}


DIFFUSE = {"lambert": (1.0, .40, .1), "max_normal": (2.0, .30, .25), "max_normal_scaled": (2.0, .25, -.2), "fibre": (3.0, .20, .05), "fibre_view": (2.5, .10, 0.0)}
HORIZONS = {"hard": (10, (8, 5, 2)), "valid_reflection": (11, (6, 2.6, .4)), "estevez": (12, (5, 5, 2)), "chiang": (12.8, (6, 5, 1)),
            "schuessler": (20, (9, 9, 9)), "valid_estevez": (14, (3.6, 2, .4))}  # of lights at 5, 15 and 80 degrees, of ten each
LOBES = {1: .20, 2: .10, 3: .06, 4: .04, 6: .02, 8: .01}
CLOTH = {"denim": (100, 250, 200, .010, .3), "silk_charmeuse": (100, 300, 330, .005, .2)}  # ns of near, far, single; errors
PRECISION = {"float": (2, 4e-6), "double": (5, 4e-15), "reference": (400, 2e-19)}
TILTS = (10, 20, 30, 45)
DETAIL = {"none": (4.0, (.568, .835, .929, .978)), "perturb": (5.0, (.390, .501, .513, .509)), "gram_schmidt": (6.0, (.013, .051, .115, .254)),
          "shortest_arc": (6.6, (.006, .025, .059, .137)), "rotate": (6.0, (0, 0, 0, 0)), "rotate_approximate": (6.0, (0, 0, 0, 0)),
          "deform_linear": (9.0, (.153, .303, .448, .657)), "deform_linear_conserving": (12.0, (.1, .2, .3, .4)), "deform_smooth": (12.0, (.071, .149, .240, .409)),
          "deform_smooth_conserving": (15.0, (.1, .2, .3, .4))}


def speed_rows():
    made = []
    for mdf, times in ((NAME, 1), ("ggx", 2)):
        for method, (ns, errors) in DETAIL.items():
            half = method == "rotate_approximate" and mdf == "ggx"
            made += timed(ns * times * (.75 if half else 1), method=method, distribution=mdf, precision="float")
            made += [wrong(.05 if half else error, method=method, distribution=mdf, tilt=tilt, error_most=3e-12 if method == "rotate" else 3 * error)
                     for tilt, error in zip(TILTS, errors)]
        for method, ns in (("rotate_plain", 18 if times == 1 else 21), ("rotate_literal", 60)):
            made += timed(ns * times, method=method, distribution=mdf, precision="float")
    return made


ROWS = {
    "diffuse": [{"kind": "truth", "mean": .5, "quadrature": 1e-5}, *(wrong(error, method=word, worst=.9, bias=bias) for word, (_ns, error, bias) in DIFFUSE.items()),
                *(row for word, (ns, *_) in DIFFUSE.items() if not word.endswith("scaled") for row in timed(ns, method=word))],
    "horizons": [row for mdf, of in ((NAME, 1), ("ggx", 2)) for word, (ns, errors) in HORIZONS.items() for row in [
        *timed(ns * of, distribution=mdf, method=word), *({"kind": "error", "distribution": mdf, "method": word, "light": light, "truth": 10.0, "error": error / of,
                                                           "picture": 3 * error} for light, error in zip((5, 15, 80), errors))]],
    "lobes": [row for lobes, error in LOBES.items() for row in [
        *(row for key, of, mdf in (("waves", 1, "ggx"), ("scratches", .5, "ggx"), ("ripples", 0, "ggx"), ("ripples", 0, "ward"))
          for row in (wrong((of * error or .25 if mdf == "ggx" else .3) / share, map=key, distribution=mdf, lobes=lobes, footprint=size)
                      for size, share in ((4, 4), (16, 1), (64, 2)))),
        *timed(100 * lobes, distribution="ggx", lobes=lobes), *timed(50 * lobes, distribution="ward", lobes=lobes)]],
    "cloth": [row for name, (near, far, single, *errors) in CLOTH.items() for row in [
        *(wrong(error, cloth=name, method=form, worst=3 * error, noise=.001) for form, error in zip(("far", "single"), errors)),
        *(row for form, ns in (("near", near), ("far", far), ("single", single)) for row in timed(ns, cloth=name, method=form))]],
    "precision": [row for mdf, of in ((NAME, 1), ("ggx", 2)) for form, (ns, error) in PRECISION.items() for row in [
        {"kind": "error", "distribution": mdf, "precision": form, "points": 300, "error": error / of, "error_low": error / 8},
        *timed(ns * of, distribution=mdf, precision=form)]],
    "speed": speed_rows(),
}
STUDIES = {"diffuse": study_diffuse, "horizons": study_horizons, "lobes": study_lobes, "cloth": study_cloth, "precision": study_precision, "speed": study_speed}

SAID = {
    "diffuse": ["Nearest to fibres that shade and hide each other is `fibre_view`, 0.10 off, at 2.50 times Lambert's time; Lambert itself is 0.40 off.",
                "The maximum normal, the papers' quick way, is 0.30 off and 25 % too bright in the mean; scaled by 2/π it is 0.25 off. The integral over the fibre, "
                "0.20 off, takes 1.50 times its time."],
    "horizons": ["Over all elevations `valid_estevez`, where both renderers start, is nearest to a displaced patch's brightness: 0.200 and 0.100 off "
                 "(Ashikhmin-Shirley, GGX) where `hard` is 0.500 and 0.250 off, at 1.4 and 1.4 times the time.",
                 "It matters where light grazes: below 15° `hard` is 0.650 and 0.325 off, `valid_estevez` 0.280 and 0.140. `schuessler` costs most and errs most, "
                 "but is reciprocal."],
    "lobes": ["Six lobes come within 2.0 % of every texel shaded, on random waves and scratches, at 6.0 times the time of one, which is up to 20.0 % off.",
              "GGX needs them most: on random waves one lobe is 20.0 % off, six are 2.0 %, since the variance of GGX is infinite and no width matches it.",
              "Where slopes are not spread as chance spreads them, no number of lobes helps: on even ripples six are still 25 to 30 % off, for the mean and the "
              "spread are all that is known."],
    "cloth": ["The far form is within 1.0 % of the mean of near for each of 2 cloths, and a sample of it takes 2.5 to 3.0 times as long as one of near, of which a "
              "pixel would need thousands.",
              "One lobe a yarn, the papers' alternating exponents seen from afar, is 20 to 30 % off and takes 0.8 to 1.1 times as long: nothing speaks for it but its "
              "few tables."],
    "precision": ["Use float for pictures: its worst error is 2·10⁻⁶ to 4·10⁻⁶, and double, with 2·10⁻¹⁵ to 4·10⁻¹⁵, takes 2.5 times as long.",
                  "The reference that the tests trust is right to 2·10⁻¹⁹, against 40 digits, and takes 80 times as long as double."],
    "speed": ["`rotate` follows the displaced surface exactly: at every tilt to 45° and for 2 distributions its total variation stays below 3·10⁻¹¹. Use it wherever a "
              "lobe is longer than wide.",
              "Being exact costs next to nothing: `rotate` takes the time of Gram-Schmidt (a tie) and 1.20 times the time of plain `perturb`.",
              "Gram-Schmidt, which most renderers use, is off by 0.013 at 10° and 0.25 at 45°; `perturb`, the papers' simple normal mapping, by 0.39 and 0.51.",
              "Deformation, which the papers offer for speed, is neither quicker nor nearer than rotation: at 30° the linear warp is off by 0.45 in 1.50 times the time "
              "of `rotate`, the smooth one by 0.24 in 2.00 times.",
              "The papers' approximate rotation is worth little: for Ashikhmin-Shirley it is the exact one, in the time of that (a tie); for GGX it saves 25 % of the "
              "time and is off by 0.05 at 30°.",
              "As printed, with arc tangents, powf and normalised axes, rotation takes 10 times as long (the papers: 54 µs exact, 11 µs approximate). In plain C (`-O2`, "
              "libm, a sample after the other) the library's own formula takes 3.0 to 3.5 times as long as its vectorised form.",
              "At every tilt the front of speed against accuracy holds none, perturb and rotate; `rotate_approximate` ties with `rotate`.",
              "This quadrature ranks the methods as the table of the method's notes does at 10°, 20°, 30°, 45°, and differs from it by 0.0000 at most; the table has "
              "three digits."],
}


def test_what_the_sentences_say():
    for name, module in STUDIES.items():
        found = module.findings(ROWS[name])
        assert all(finding.holds for finding in found), name
        assert [finding.text for finding in found] == SAID[name]


# What a sentence needs to be true: study, its number there, which rows, a figure of theirs with which it still holds, and one with which it no longer does
OF = {"distribution": NAME}
HOLDS = [
    ("diffuse", 0, {"kind": "error", "method": "fibre_view"}, "error", .19, .21), ("diffuse", 0, {"kind": "speed", "method": "fibre_view"}, "ns", 2.9, 3.1),
    ("diffuse", 1, {"kind": "error", "method": "fibre"}, "error", .29, .31), ("diffuse", 1, {"kind": "error", "method": "max_normal"}, "bias", .11, .09),
    ("diffuse", 1, {"kind": "speed", "method": "fibre"}, "ns", 3.9, 4.1),
    ("horizons", 0, {**OF, "method": "valid_estevez", "light": 80}, "error", 3.3, 3.5), ("horizons", 1, {**OF, "method": "valid_estevez", "light": 5}, "error", 8.3, 8.5),
    ("horizons", 1, {**OF, "method": "chiang", "light": 80}, "error", 15.9, 16.1), ("horizons", 1, {**OF, "kind": "speed", "method": "chiang"}, "ns", 19.9, 20.1),
    ("lobes", 0, {"map": "waves", "lobes": 6, "footprint": 16}, "error", .029, .031), ("lobes", 1, {"map": "waves", "lobes": 6, "footprint": 16}, "error", .099, .101),
    ("lobes", 2, {"map": "ripples", "distribution": "ggx", "lobes": 6}, "error", .021, .019),
    ("cloth", 0, {"cloth": "denim", "method": "far"}, "error", .019, .021), ("cloth", 1, {"cloth": "silk_charmeuse", "method": "single"}, "error", .011, .009),
    ("cloth", 1, {"cloth": "denim", "method": "far"}, "error", .059, .061),
    ("precision", 0, {**OF, "precision": "float"}, "error", 9e-5, 1.1e-4), ("precision", 0, {**OF, "precision": "double"}, "error", 9e-13, 1.1e-12),
    ("precision", 0, {**OF, "kind": "speed", "precision": "double"}, "ns", 2.5, 2.3), ("precision", 1, {**OF, "precision": "reference"}, "error", 9e-15, 1.1e-14),
    ("precision", 1, {**OF, "kind": "speed", "precision": "reference"}, "ns", 51, 49),
    ("speed", 0, {"distribution": "ggx", "method": "rotate", "tilt": 10}, "error_most", 9e-10, 1.1e-9), ("speed", 1, {**OF, "kind": "speed", "method": "rotate"}, "ns", 7.4, 7.6),
    ("speed", 1, {**OF, "method": "rotate", "tilt": 45}, "error", 9e-10, 1.1e-9), ("speed", 2, {**OF, "method": "gram_schmidt", "tilt": 10}, "error", .25, .26),
    ("speed", 2, {**OF, "method": "gram_schmidt", "tilt": 10}, "error", 1e-6, 0), ("speed", 2, {**OF, "method": "gram_schmidt", "tilt": 45}, "error", .508, .51),
    ("speed", 2, {**OF, "method": "perturb", "tilt": 10}, "error", .014, .012),
    ("speed", 3, {**OF, "method": "deform_linear", "tilt": 10}, "error", 1.1e-3, 9e-4), ("speed", 3, {**OF, "kind": "speed", "method": "deform_linear"}, "ns", 6.1, 5.9),
    ("speed", 4, {**OF, "method": "rotate_approximate", "tilt": 30}, "error", 9e-10, 1.1e-9),
    ("speed", 4, {"distribution": "ggx", "method": "rotate_approximate", "tilt": 30}, "error", .021, .019),
    ("speed", 4, {"distribution": "ggx", "kind": "speed", "method": "rotate_approximate"}, "ns", 6.1, 5.9),
    ("speed", 5, {**OF, "kind": "speed", "method": "rotate_literal"}, "ns", 18.5, 17.5), ("speed", 5, {**OF, "kind": "speed", "method": "rotate_plain"}, "ns", 9.1, 8.9),
    ("speed", 7, {**OF, "method": "none", "tilt": 10}, "error", .57, .571)]


def test_where_a_sentence_stops_to_hold():
    for name, number, rows, key, within, beyond in HOLDS:
        holds = []
        for value in (within, beyond):
            changed = [{**row, key: value} if key in row and all(row.get(word) == said for word, said in rows.items()) else row for row in ROWS[name]]
            assert changed != ROWS[name], (name, rows)
            holds.append(STUDIES[name].findings(changed)[number].holds)
        assert holds == [True, False], (name, number, rows, key)


ANSWERS = {  # surface, use, costs, fails where
    "diffuse": ("diffuse", [("scatters as fibres or brushed grooves do", "`fibre_view`", "2.5 × `lambert`", "10 % off in the mean; `max_normal` 30 %"),
                            ("is matt, without direction", "`lambert`", "the least", "on fibres: 40 % off")]),
    "horizons": ("horizon", [("is seen or lit at low angles", "`valid_estevez`, the default", "1.4 × `hard`",
                              "light below 15° is still 14 to 28 % off; light and eye cannot be exchanged"),
                             ("is traced from the lights, too", "`hard`", "the least", "light below 15°: 32 to 65 % off")]),
    "lobes": ("normal-map filter", [("has a normal map, seen from afar", "with six lobes", "6.0 × one lobe", "on even ripples: 25 to 30 % off; else colours are up to 2 % off"),
                                    ("has one, and time is short", "with one lobe", "the least", "up to 20 % off on random bumps")]),
    "cloth": ("cloth", [("is cloth, its yarns wider than pixels", "near", "the least", "from afar: it needs a sample for every yarn"),
                        ("is cloth from afar", "far", "2.5 to 3.0 × near", "colours are up to 1 % off; by one lobe a yarn up to 30 %")]),
    "precision": ("precision", [("is only looked at", "float", "the least", "values are up to 4·10⁻⁶ off"),
                                ("is measured or compared", "double", "2.5 × float", "values are up to 4·10⁻¹⁵ off")]),
    "speed": ("detail", [("is brushed or grooved, and has bumps", "`rotate`, the default", "1.2 × `perturb`", "nowhere to 45° of tilt: less than 3·10⁻¹¹ off"),
                         ("is as rough along as across", "`auto`, which is `perturb` there", "the least", "once it is longer than wide: 39 % off at 10°"),
                         ("must look as other renderers have it", "`gram_schmidt`", "1.0 × `rotate`", "on steep bumps: 1.3 % off at 10°, 25 % at 45°")]),
}


def test_the_first_screen_says_what_to_use():
    assert set(answers.ANSWERS) == set(ANSWERS) and answers.of("atlas", []) == ("", ())
    for name, (topic, lines) in ANSWERS.items():
        found = answers.of(name, ROWS[name])
        assert (found[0], [(line.surface, line.use, line.costs, line.fails) for line in found[1]]) == (topic, lines)
    assert [answers.times(v) for v in (0.51, 9.94, 9.96, 123.4)] == ["0.5 ×", "9.9 ×", "10 ×", "123 ×"]
    assert [answers.percent(v) for v in (0.00123, 0.994, 0.999, 2.344)] == ["0.12 %", "99 %", "100 %", "234 %"]
    missed = [{**row, "error_most": 0.02} if row.get("method") == "rotate" and row["kind"] == "error" else row for row in ROWS["speed"]]
    assert answers.of("speed", missed)[1][0].fails == "2 % off at its worst"
    assert answers.of("lobes", [row for row in ROWS["lobes"] if row.get("map") != "ripples"])[1][0].fails == "colours are up to 2 % off"


# ---- tables and charts


METHODS = {"none": "none", "perturb": "perturb", "gram_schmidt": "Gram-Schmidt", "shortest_arc": "shortest arc", "rotate": "rotate",
           "rotate_approximate": "rotate, approximate", "deform_linear": "deform, linear", "deform_linear_conserving": "deform, linear, conserving",
           "deform_smooth": "deform, smooth", "deform_smooth_conserving": "deform, smooth, conserving"}
MATERIALS = {NAME: "Ashikhmin-Shirley", "ggx": "GGX"}
FIBRES = {"lambert": "Lambert", "max_normal": "maximum normal", "max_normal_scaled": "maximum normal · 2/π", "fibre": "fibre", "fibre_view": "fibre, view"}
RULES = {"hard": "hard", "valid_reflection": "valid reflection", "estevez": "Estevez", "chiang": "Chiang", "schuessler": "Schüßler", "valid_estevez": "valid, Estevez"}
MAPS = (("random waves", "GGX", lambda lobes: LOBES[lobes]), ("scratches", "GGX", lambda lobes: LOBES[lobes] / 2),
        ("even ripples", "GGX", lambda lobes: .25), ("even ripples", "Ward", lambda lobes: .3))


def bar(ns, word):
    """The middle half of the runs."""
    return (ns, ns) if word in STEADY or word == "max_normal_scaled" else (.95 * ns, 1.1 * ns)


def half(ns, word, form=".3g"):
    return "{:{form}} to {:{form}}".format(*bar(ns, word), form=form)


TABLES = {
    "diffuse": ("numbers", ["model", "ns", "middle half", "mean error", "worst error", "too bright, %"],
                [[FIBRES[word], ns, half(ns, word), error, .9, 100 * bias] for word, (ns, error, bias) in DIFFUSE.items()]),
    "horizons": ("numbers", ["material", "horizon", "brightness", "light below 15°", "picture", "ns", "middle half"],
                 [[MATERIALS[mdf], RULES[word], sum(off) / 30 / of, sum(off[:2]) / 20 / of, sum(off) / 10, ns * of, half(ns * of, word)]
                  for mdf, of in ((NAME, 1), ("ggx", 2)) for word, (ns, off) in HORIZONS.items()]),
    "lobes": ("numbers", ["map", "distribution", "lobes", "off, %", "ns", "middle half"],
              [[name, mdf, lobes, 100 * error(lobes), ns * lobes, half(ns * lobes, lobes, ".0f")] for name, mdf, error in MAPS for ns in [50 if mdf == "Ward" else 100]
               for lobes in LOBES]),
    "cloth": ("numbers", ["cloth", "form", "off, %", "worst pair, %", "noise, %", "ns", "middle half"],
              [[name.replace("_", " "), form, 100 * error, 300 * error, .1, ns, half(ns, form, ".0f")] for name, (_near, far, single, *errors) in CLOTH.items()
               for form, ns, error in zip(("far", "one lobe"), (far, single), errors)]),
    "precision": ("numbers", ["distribution", "precision", "ns", "middle half", "median error", "worst error"],
                  [[MATERIALS[mdf], form, ns * of, half(ns * of, form), error / 8, error / of] for mdf, of in ((NAME, 1), ("ggx", 2))
                   for form, (ns, error) in PRECISION.items()]),
    "speed": ("errors", ["distribution", "method", "10°", "20°", "30°", "45°", "ns", "ratio", "middle half"],
              [[MATERIALS[mdf], METHODS[word], *errors, ns * of, ns / 5, half(ns / 5, word, ".2f")] for mdf, of in ((NAME, 1), ("ggx", 2))
               for word, (ns, errors) in ({**DETAIL, "rotate_approximate": (4.5, (.05,) * 4)} if mdf == "ggx" else DETAIL).items()]),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables(name):
    table, = STUDIES[name].tables(ROWS[name])
    identity, columns, wanted = TABLES[name]
    assert (table.id, list(table.columns)) == (identity, columns) and table.title == TITLES[name][0] and table.caption.endswith(".")
    made = [row for row in table.rows if row[1] not in ("rotate, plain C", "rotate, as printed")]
    assert [[cell for cell in row if isinstance(cell, str)] for row in made] == [[cell for cell in row if isinstance(cell, str)] for row in wanted]
    for row, right in zip(made, wanted):
        assert row == [right if isinstance(right, str) else pytest.approx(right, rel=.01) for right in right]
    if name == "speed":
        twins = [(row[0], row[1], row[4], row[6]) for row in table.rows if row not in made]
        assert twins == [(label, word, 0, pytest.approx(ns * of)) for label, of in (("Ashikhmin-Shirley", 1), ("GGX", 2))
                         for word, ns in (("rotate, plain C", 18 if of == 1 else 21), ("rotate, as printed", 60))]


TITLES = {  # of the table, and of each figure
    "diffuse": ["Diffuse models against fibres with neighbours", ("front", "Time against error of each diffuse model")],
    "horizons": ["Horizons", ("fronts", "Time against error of each horizon")],
    "lobes": ["Lobes of a filtered map", ("fronts", "Time against error, by the number of lobes")],
    "cloth": ["Cloth from afar against the mean of near", ("front", "Time against error of each form, a point for each cloth")],
    "precision": ["Precision forms", ("forms", "Time against error of each precision")],
    "speed": ["Error and time of every method", ("choice", "Speed against accuracy of the detail methods"), ("tilts", "Only rotation keeps to the displaced surface"),
              ("fronts", "Time against error, at each tilt"), ("mdfs", "Time against error, by distribution")],
}


@pytest.fixture
def drawn(monkeypatch):
    """drawn(study): {figure: axes of its panels}, instead of its SVG."""
    panels = []

    def svg(figure):
        panels.append(figure.axes[0])
        style.pyplot.close(figure)
        return f"{len(panels) - 1}"
    monkeypatch.setattr(style, "svg", svg)
    monkeypatch.setattr(style, "labels", lambda axes, points, **_options: [axes.text(x, y, style.of(word).label) for x, y, word in points])  # anywhere: it is quicker

    def drawn(name):
        figures = STUDIES[name].figures(ROWS[name])
        assert {finding.figure for finding in STUDIES[name].findings(ROWS[name])} <= {part.id for part in (*figures, *STUDIES[name].tables(ROWS[name]))}
        assert [(figure.id, figure.title) for figure in figures] == TITLES[name][1:]
        assert all(f"compare/report_page.py --only {name}`" in figure.caption and len(figure.alt) > 40 for figure in figures)
        return {figure.id: [panels[int(number)] for number in figure.svg.split("\n")] for figure in figures}
    return drawn


def bars_of(axes):
    """Of each point with bars: (ns, its bar), (error, its bar)."""
    found = []
    for made in axes.containers:
        (x, y), (*_caps, bars) = made.lines[0].get_xydata()[0], made.lines
        ends = [np.array(bar.get_segments()[0]) for bar in bars]
        found.append(((x, *ends[0][:, 0]), (y, *(ends[1][:, 1] if len(ends) > 1 else ()))))
    return found


# By panel: its title, what stands at its axes, and of its points ns and error
TIME = "ns a sample, one core"
CHARTS = {
    ("diffuse", "front"): [("", TIME, "mean error / mean of the truth", [(ns, error, word) for word, (ns, error, _bias) in DIFFUSE.items()])],
    ("horizons", "fronts"): [(MATERIALS[mdf], TIME, "error of the brightness", [(ns * of, sum(off) / 30 / of, word) for word, (ns, off) in HORIZONS.items()])
                             for mdf, of in ((NAME, 1), ("ggx", 2))],
    ("lobes", "fronts"): [(f"{name}, {mdf}", "ns a lookup, one core", "error of the mean colour", [((50 if mdf == "Ward" else 100) * lobes, error(lobes), lobes) for lobes in LOBES])
                          for name, mdf, error in MAPS],
    ("cloth", "front"): [("", TIME, "mean error of the colour", [(CLOTH[name][1 + k], CLOTH[name][3 + k], "") for k in (0, 1) for name in CLOTH])],
    ("precision", "forms"): [(MATERIALS[mdf], TIME, "worst relative error", [(ns * of, error / of, word) for word, (ns, error) in PRECISION.items()]) for mdf, of in ((NAME, 1), ("ggx", 2))],
}
LABELS = {"diffuse": set(FIBRES.values()), "horizons": set(RULES.values()), "cloth": {"far", "one lobe", "a sample of near"}, "precision": set(PRECISION),
          "lobes": {"one lobe", *(f"{n} lobes" for n in LOBES if n > 1)}}


def test_charts(drawn):
    for (name, figure), wanted in CHARTS.items():
        panels = drawn(name)[figure]
        assert [(axes.get_title("left"), axes.get_xlabel(), axes.get_ylabel()) for axes in panels] == [panel[:3] for panel in wanted]
        for axes, (*_words, points) in zip(panels, wanted):
            assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
            assert [axis.get_major_formatter()(value, 0) for axis in (axes.xaxis, axes.yaxis) for value in (300, 1e-6)] == ["300", "10⁻⁶"] * 2  # no 10²
            assert {text.get_text() for text in axes.texts} == LABELS[name]
            found = bars_of(axes)
            assert np.array([(x[0], y[0]) for x, y in found]) == pytest.approx(np.array([at[:2] for at in points]))
            low = {"horizons": None, "precision": (.25, .5)}.get(name, (.5, .5))
            for (x, y), (ns, error, word) in zip(found, points):
                assert x[1:] == pytest.approx(bar(ns, word))
                if name == "precision":
                    assert y[2] == pytest.approx(error) and y[1] in (pytest.approx(error / 8), pytest.approx(error / 4))
                elif name != "horizons":
                    assert y[1:] == pytest.approx((low[0] * error, 2 * error))
                else:  # the middle half of three elevations: all of them
                    assert y[1] <= error <= y[2]
            assert all(axes.get_xlim()[0] < x[1] and x[2] < axes.get_xlim()[1] and axes.get_ylim()[0] < min(y) and max(y) < axes.get_ylim()[1] for x, y in found)


def test_charts_of_detail_methods(drawn, monkeypatch):
    figures = drawn("speed")
    shown = [word for word in METHODS if not word.endswith("conserving")]
    error_of = lambda word, tilt, mdf: max(.05 if (word, mdf) == ("rotate_approximate", "ggx") else DETAIL[word][1][TILTS.index(tilt)], 1e-4)
    ns_of = lambda word, mdf: (DETAIL[word][0] if mdf == NAME else 9 if word == "rotate_approximate" else 2 * DETAIL[word][0])
    panels = {"choice": [("Ashikhmin-Shirley, 30°", NAME, 30), ("GGX, 30°", "ggx", 30)], "fronts": [(f"{tilt}° of tilt", NAME, tilt) for tilt in TILTS],
              "mdfs": [("Ashikhmin-Shirley, 30°", NAME, 30), ("GGX, 30°", "ggx", 30)]}
    for name, wanted in panels.items():
        assert [axes.get_title("left") for axes in figures[name]] == [title for title, *_ in wanted]
        for axes, (_title, mdf, tilt) in zip(figures[name], wanted):
            assert (axes.get_xlabel(), axes.get_ylabel()) == (TIME, "total variation")
            found = [(x[0], y[0]) for x, y in bars_of(axes)]
            plain = [(18 if mdf == NAME else 42, 1e-4)] if name == "choice" else []
            assert np.array(found) == pytest.approx(np.array([(ns_of(word, mdf), error_of(word, tilt, mdf)) for word in shown] + plain))
            words = {METHODS[word] for word in shown if mdf == "ggx" or word != "rotate_approximate"} | ({"rotate, plain C"} if plain else set())
            assert {text.get_text() for text in axes.texts} == words  # what ties with rotate has no label of its own
    lines, = figures["tilts"]
    shown.remove("rotate_approximate")
    assert (lines.get_xlabel(), lines.get_ylabel(), lines.get_yscale()) == ("tilt of the normal", "total variation", "log")
    assert [tick.get_text() for tick in lines.get_xticklabels()] == ["10°", "20°", "30°", "45°"]
    assert [line.get_xydata().tolist() for line in lines.lines] == [[[tilt, error_of(word, tilt, NAME)] for tilt in TILTS] for word in shown]
    assert {text.get_text() for text in lines.texts} == {METHODS[word] for word in shown}
    monkeypatch.setattr(fronts, "chart", lambda *_words: None)
    bright = [{**row, "error": 1.2} if row.get("method") == "deform_linear" and row.get("tilt") == 45 else row for row in ROWS["speed"]]
    assert "Above 1, as of deform, linear at 45°, it makes light." in study_speed.figures(bright)[1].caption
    assert "Above 1" not in study_speed.figures(ROWS["speed"])[1].caption


# ---- what the tasks ask for


@pytest.fixture
def bench(monkeypatch):
    """What `shade bench` is asked for; it answers with rows of all methods and precisions."""
    asked = []
    columns = ("what", "method", "distribution", "precision", "isa", "ns", "max_error")

    def run(command, **_options):
        asked.append(command[2:])
        text = io.StringIO()
        made = csv.writer(text)
        made.writerow(columns)
        for precision in ("float", "double"):
            made.writerows([["lobes_6" if "lobes" in command else "D", method, "ggx", precision, "avx2", 2.5, 1e-7] for method in ("rotate", "auto", "perturb")])
        return Of(returncode=0, stdout=text.getvalue(), stderr="")
    monkeypatch.setattr(fronts.subprocess, "run", run)
    return asked


def test_what_is_asked_of_the_bench(bench):
    said = []

    def asked(task, quick=True):
        bench.clear()
        rows = {task.key: task for task in STUDIES[task.study].tasks(quick)}[task.key].run(None, said.append)
        return rows, {" ".join(words) for words in bench}, len(bench)
    task = lambda study, key: Of(study=study, key=key)
    rows, words, count = asked(task("speed", "speed-ggx"))
    assert (words, count) == ({"--csv --what D --mdf ggx --set cache"}, 7) and said == [f"run {k} of 7" for k in range(1, 8)]
    assert rows[0] == {"kind": "speed", "what": "D", "method": "rotate", "distribution": "ggx", "precision": "float", "isa": "avx2", "run": 0, "ns": 2.5, "rounding": 1e-7}
    assert len(rows) == 7 * 4 and {row["method"] for row in rows} == {"rotate", "perturb"} and [row["run"] for row in rows[::4]] == list(range(7))
    rows, words, count = asked(task("horizons", "speed-ggx"))
    assert words == {f"--csv --what {what} --mdf ggx --set cache" for what in ("f", "f_valid_reflection", "f_estevez", "f_chiang", "f_schuessler", "f_valid_estevez")}
    assert count == 6 * 5 == len(rows) and [row["method"] for row in rows[::5]] == list(HORIZONS)
    assert {(row["kind"], row["precision"]) for row in rows} == {("speed", "float")}
    rows, words, count = asked(task("lobes", "speed"))
    assert (words, count, len(rows)) == ({"--csv --what lobes"}, 5, 30) and {row["lobes"] for row in rows} == {6}
    rows, words, count = asked(task("diffuse", "speed"))
    assert (words, count, len(rows)) == ({"--csv --what diffuse"}, 7, 21)
    rows, words, count = asked(task("precision", "speed-ggx"))
    assert (words, count) == ({"--csv --what D --mdf ggx --set cache", "--csv --what reference"}, 10)
    assert len(rows) == 5 * 2 + 5 * 6 and {row["precision"] for row in rows} == {"float", "double", "reference"}


TASKS = {  # quick: keys; all: keys
    "speed": ([f"{word}-{mdf}{tilt}" for mdf in (NAME, "ggx") for word, tilt in (("speed", ""), ("plain", ""), *(("error", f"-{t}") for t in (10, 20, 30, 45, 75)))],
              [f"{word}-{mdf}{tilt}" for mdf in (NAME, "ward", "ward_half", "beckmann", "ggx")
               for word, tilt in (("speed", ""), ("plain", ""), *(("error", f"-{t}") for t in (10, 20, 30, 45, 60, 75)))]),
    "horizons": ([f"speed-{NAME}", "speed-ggx", "cast"],) * 2,
    "lobes": (["speed", "error-waves", "error-scratches"], ["speed", "error-waves", "error-ripples", "error-scratches"]),
    "diffuse": (["speed", "error"],) * 2,
    "precision": ([f"{word}-{mdf}" for word in ("speed", "error") for mdf in (NAME, "ggx")],
                  [f"{word}-{mdf}" for word in ("speed", "error") for mdf in (NAME, "ward", "ward_half", "beckmann", "ggx")]),
    "cloth": (["denim", "silk_charmeuse", "linen"], None),
}
SECONDS = {"speed": (20.6, 210), "horizons": (13.5, 106.5), "lobes": (7.5, 97.5), "diffuse": (2.05, 28.15), "precision": (3.9, 45), "cloth": (2.4, 45)}  # on two cores
COMMANDS = {  # of the first and the last
    "speed": ("build/shade bench --what D --mdf ashikhmin-shirley --set cache", ""),
    "horizons": ("build/shade bench --what f_estevez --mdf ashikhmin-shirley --set cache", "build/venv/bin/python compare/horizon.py"),
    "lobes": ("build/shade bench --what lobes", ""), "diffuse": ("build/shade bench --what diffuse", ""), "precision": ("build/shade bench --what D --set cache", ""),
    "cloth": ("build/venv/bin/python compare/fabric.py denim", "build/venv/bin/python compare/fabric.py linen"),
}


@pytest.mark.parametrize("name", TASKS)
def test_tasks(name):
    """The quick ones take less time, and each says how it is made again."""
    quick, whole = (STUDIES[name].tasks(quick) for quick in (True, False))
    keys = TASKS[name]
    assert [task.key for task in quick] == keys[0] and (keys[1] is None or [task.key for task in whole] == keys[1])
    assert (quick[0].command, quick[-1].command) == COMMANDS[name] and STUDIES[name].NAME == name
    assert (sum(task.seconds for task in quick), sum(task.seconds for task in whole)) == pytest.approx(SECONDS[name])
    if name == "cloth":
        assert len(whole) > 8 and {"denim", "linen"} <= {task.key for task in whole}


# ---- what they measure


def test_fibres_that_shade_and_hide_each_other():
    """From above and lit from there they are round: the mean of cos² over that of cos. What is beside a neighbour sees no low light."""
    up = np.array([[0.0, 0, 1]])
    assert study_diffuse.truth(up, up, 2000) == pytest.approx(np.pi / 4, abs=1e-5)
    for side in (-1, 1):  # 60 degrees from above the next fibre's shadow ends at 60 degrees of this one, its own begins at -30: ∫ cos t cos (t - 60°) / 2
        assert study_diffuse.truth(np.array([[0, side * .75**.5, .5]]), up, 20000) == pytest.approx((np.pi / 4 + .75**.5) / 4, abs=1e-4)
    side = lambda degrees: np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    at = lambda degrees: np.array([[np.sin(np.radians(degrees))], [np.cos(np.radians(degrees))]])
    for turned, light, seen in ((0, 10, True), (60, 80, True), (60, 10, False), (-60, 10, False), (-20, 60, True), (89, 89, True), (89, 85, False), (60, 170, False)):
        assert study_diffuse.free(at(turned), side(light))[0] == seen, (turned, light)
        assert study_diffuse.free(at(-turned), side(light) * (-1, 1))[0] == seen
    spread = study_diffuse.directions(4000, 1)
    low = np.sin(np.radians(10))
    assert np.allclose(np.linalg.norm(spread, axis=1), 1) and spread[:, 2].min() >= low and np.abs(spread.mean(0) - (0, 0, (1 + low) / 2)).max() < .03
    assert np.quantile(spread[:, 2], [.25, .75]) == pytest.approx([low + (1 - low) * share for share in (.25, .75)], abs=1e-3)
    assert np.abs(np.cov(spread[:, :2].T) - np.eye(2) * (1 - (spread[:, 2]**2).mean()) / 2).max() < .02
    assert np.allclose(study_diffuse.model("lambert", spread, spread[::-1]), spread[:, 2], atol=1e-6)
    assert np.allclose(study_diffuse.model("max_normal_scaled", spread, spread[::-1]), study_diffuse.model("max_normal", spread, spread[::-1]) * 2 / np.pi, atol=1e-6)
    truth, *rows = study_diffuse.errors(300, 200)(None, None)
    assert [row["method"] for row in rows] == list(DIFFUSE) and truth["kind"] == "truth" and 0 < truth["quadrature"] < .01 < .3 < truth["mean"] < 1
    off = {row["method"]: row["error"] for row in rows}
    assert min(off, key=off.get) == "fibre_view" and all(row["error_low"] <= row["error"] * 1.5 and row["error_low"] < row["error_high"] <= row["worst"] for row in rows)
    assert {row["method"]: row["bias"] > .1 for row in rows}["max_normal"] and all(abs(row["bias"]) <= row["error"] * 1.0001 for row in rows)


def test_forty_digits():
    """Of the same lobe as the other study's in double; the tool's answers keep as many digits as its forms have."""
    n, h = study_precision.directions(40, 7), study_precision.directions(40, 8)
    assert n[:, 2].min() > .499 and n.dtype == np.float32 and not np.array_equal(n, h)
    with study_precision.decimal.localcontext(study_precision.decimal.Context(prec=40)):
        for mdf in study_precision.MDFS:
            unit = lambda v: v.astype(float) / np.linalg.norm(v.astype(float))
            seen = 0
            for normal, half in zip(n, h):
                found, peak = study_precision.truth(mdf, normal, half)
                wanted = study_speed.displaced(mdf, unit(normal), unit(half)[None], 200, 10)[0]
                assert float(found) == pytest.approx(wanted, rel=1e-9, abs=1e-300) and found < peak
                seen += found * 10**12 > peak
            assert study_precision.truth(mdf, n[0], -h[0])[0] == 0
    said = []
    rows = study_precision.errors("ggx", 40)(None, said.append)
    assert [row["precision"] for row in rows] == ["float", "double", "reference"] and said == ["0 %"] and {row["points"] for row in rows} == {seen}
    assert all(low < row["error"] < high and 0 < row["error_low"] < row["error"] for row, (low, high) in zip(rows, ((1e-8, 1e-4), (1e-17, 1e-12), (0, 1e-14))))
    with pytest.raises(study_precision.report.StepFailed, match="eval --mdf none .*none"):
        study_precision.ask("none", "float", "")


def test_total_variation():
    """Of every method; 0 where it is the displaced surface's lobe, which has an integral of 1."""
    h, weight = study_speed.sphere(60)
    assert weight.sum() == pytest.approx(2 * np.pi)
    for mdf in (NAME, "beckmann", "ggx"):  # a broad lobe, as the quadrature has it
        made = study_speed.displaced(mdf, np.array([0.0, 0, 1]), h, 10, 4)
        assert weight @ (made * (1 if mdf == NAME else h[:, 2])) == pytest.approx(1, abs=1e-3)
    found = study_speed.variation("ashikhmin_shirley", ["perturb", "gram_schmidt"], 30, 6, 140, 200, 10)  # docs/theory/papers.md
    assert [np.mean(found[word]) for word in ("perturb", "gram_schmidt")] == pytest.approx([0.513, 0.116], abs=2e-3)
    rows = {row["method"]: row for row in study_speed.errors("ggx", 20, 8, 60)(None, None)}
    assert set(rows) == set(METHODS)
    assert rows["rotate"]["error_most"] < 1e-9 and .01 < rows["gram_schmidt"]["error"] < rows["perturb"]["error"] < rows["none"]["error"] < 1.01
    # over the area that facets stand for: of two narrow lobes 60 degrees apart one is 1, the other the cosine
    assert np.mean(study_speed.variation("ggx", ["none"], 60, 4, 90, 300, 300)["none"]) == pytest.approx(.75, abs=.08)
    for row in rows.values():
        assert (row["kind"], row["distribution"], row["tilt"]) == ("error", "ggx", 20)
        assert row["error_low"] <= row["error_high"] <= row["error_most"] and row["error"] <= row["error_most"] and row["quadrature"] < .05


def test_plain_c_is_the_same_formula(monkeypatch, tmp_path):
    monkeypatch.setattr(study_speed, "ARRAY", 64)
    row, = study_speed.plain("ggx", 1)(None, None)
    assert {key: row[key] for key in ("kind", "method", "distribution", "precision", "isa", "run")} == {
        "kind": "speed", "method": "rotate_plain", "distribution": "ggx", "precision": "float", "isa": "plain C", "run": 0}
    assert 0 < row["ns"] < 5000 and 0 < row["rounding"] < 1e-5
    displaced = study_speed.displaced
    monkeypatch.setattr(study_speed, "displaced", lambda *words: 1.001 * displaced(*words))
    with pytest.raises(ValueError, match=r"compare/plain.c: D of ward is .* of its peak off"):
        study_speed.plain("ward", 1)(None, None)
    monkeypatch.setattr(study_speed, "PLAIN", tmp_path / "none.so")
    with pytest.raises(study_speed.report.StepFailed, match="none.so: no such file; run make build/plain.so"):
        study_speed.plain("ward", 1)(None, None)
    spread = study_speed.within(np.random.default_rng(5))
    assert spread.shape == (64, 3) and spread.dtype == np.float32 and .5 <= spread[:, 2].min() and np.allclose(np.linalg.norm(spread, axis=1), 1)


def test_brightness_under_horizons(monkeypatch, tmp_path):
    """By each light's elevation the sums over those of the eye."""
    (tmp_path / "horizon").touch()
    monkeypatch.setattr(study_horizons.programs, "BUILD", tmp_path)
    asked = []

    def measure(options):
        asked.append((options.points, options.azimuths, options.output))
        (tmp_path / "horizon.csv").touch()
        return [{"material": mdf, "horizon": rule, "light": light, "eye": eye, "truth": 2.0, "mean": 2.0 + light / 100 + (rule == "hard") - 2 * (eye == 80), "image": .25}
                for mdf in (NAME, "ggx") for rule in HORIZONS for light in (5, 80) for eye in (5, 80)]
    monkeypatch.setattr(study_horizons.horizon, "measure", measure)
    said = []
    rows = study_horizons.cast(16, 5)(tmp_path, said.append)
    assert said == ["casting rays"] and asked == [(16, 5, tmp_path)] and not (tmp_path / "horizon.csv").exists()
    assert [(row["distribution"], row["method"], row["light"]) for row in rows] == [(mdf, rule, light) for mdf in (NAME, "ggx") for rule in HORIZONS for light in (5, 80)]
    assert [(row["kind"], row["truth"], row["picture"]) for row in rows] == [("error", 4, .5)] * 24
    assert [row["error"] for row in rows[:4]] == pytest.approx([1.05 + .95, 1.8 + .2, .05 + 1.95, .8 + 1.2])
    monkeypatch.setattr(study_horizons.programs, "BUILD", tmp_path / "none")
    with pytest.raises(study_horizons.report.StepFailed, match="none/horizon: no such file; run make build/horizon"):
        study_horizons.cast(16, 5)(tmp_path, lambda _text: None)


def test_the_middle_half_of_elevations():
    """Of eight lights, each a step further off than the last, those from the third to the sixth; below 15° are three."""
    rows = [row for mdf in (NAME, "ggx") for word in HORIZONS for row in [*timed(10, distribution=mdf, method=word), *(
        {"kind": "error", "distribution": mdf, "method": word, "light": 5 * k, "truth": 10.0, "error": 1.0 * k, "picture": 0} for k in range(1, 9))]]
    assert [(p.error, p.low, p.high) for p in study_horizons.points(rows, "ggx")] == [(pytest.approx(.45), pytest.approx(.3), pytest.approx(.6))] * 6
    table, = study_horizons.tables(rows)
    assert [row[3] for row in table.rows] == [pytest.approx(.2)] * 12


def test_cloth_is_measured_at_its_own_pairs(monkeypatch):
    """Near at points, far at none: what is off is of the mean of near; times of all three forms by turns."""
    asked, clock = [], [0.0]

    class Cloth:
        def eval(self, uv, wi, wo, tier, footprint=0):
            asked.append((tier, len(uv), float(footprint)))
            clock[0] += {"near": .001, "far": .003, "single": .002}[tier]
            values = {"near": [1.0, 2, 4], "far": [1.01, 2, 4], "single": [1.1, 1.6, 4]}[tier]
            return np.tile(values, (len(uv), 1)) * (1 + .1 * (np.arange(len(uv)) % 2 * 2 - 1)[:, None] * (tier == "near"))
    monkeypatch.setattr(study_cloth, "BATCH", 1000)
    monkeypatch.setattr(study_cloth.shade, "fabric", lambda name: Cloth())
    monkeypatch.setattr(study_cloth.time, "perf_counter", lambda: clock[0])
    said = []
    rows = study_cloth.measure("denim", 64, 2)(None, said.append)
    far, single, *times = rows
    assert (far["method"], far["error"], far["worst"], far["error_low"], far["error_high"]) == ("far", *[pytest.approx(.01)] * 4)
    assert (single["method"], single["error"], single["noise"], far["noise"]) == ("single", pytest.approx(.2), *[pytest.approx(.1 / 8)] * 2)
    assert [(row["method"], row["run"], row["precision"], row["ns"]) for row in times] == [
        (form, run, "float", pytest.approx(ns)) for run in (0, 1) for form, ns in (("near", 1000), ("far", 3000), ("single", 2000))]
    assert said[0] == "0 %" and said[-2:] == ["run 1 of 2", "run 2 of 2"] and len(said) == 22 and {row["cloth"] for row in rows} == {"denim"}
    assert asked[:3] == [("near", 64, 0), ("far", 1, 1e6), ("single", 1, 1e6)] and asked[-3:] == [("near", 1000, 0), ("far", 1000, 20), ("single", 1000, 20)]
    spread = study_cloth.within(np.random.default_rng(1))
    assert spread.shape == (1000, 3) and np.allclose(np.linalg.norm(spread, axis=1), 1) and .499 < spread[:, 2].min() and np.abs(spread[:, :2].mean(0)).max() < .06


def test_lobes_are_judged_by_the_mean_colour(monkeypatch):
    """Of every count at each footprint, over the mean of the truth."""
    made = study_lobes.maps()
    assert {key: label for key, (label, _make) in made.items()} == {"waves": "random waves", "ripples": "even ripples", "scratches": "scratches"}
    asked = []
    for name in ("gaussian_map", "ripple_map", "scratch_map"):
        monkeypatch.setattr(study_lobes.slopes, name, lambda *words, name=name, **options: asked.append((name, words, options)) or np.zeros((4, 4, 3)))
    for _label, make in made.values():
        make()
    assert asked == [("gaussian_map", (.15, .1, 2), {}), ("ripple_map", (.15, .1), {}), ("scratch_map", (), {
        "pits": 3000, "radius": (.004, .012), "stretch": (2, 8), "spread": pytest.approx(np.radians(20)), "depth": (.03, .12)})]
    monkeypatch.setattr(study_lobes.shade, "SlopeMap", lambda _map, normals: "pyramid")
    monkeypatch.setattr(study_lobes.slopes, "supersampled", lambda normals: "fine")
    monkeypatch.setattr(study_lobes.slopes, "directions", lambda: [(0, 1), (1, 0), (1, 1), (0, 0)])
    monkeypatch.setattr(study_lobes.slopes, "shaded", lambda mdf, first, second, fine, wi, wo: np.array([2.0]))
    monkeypatch.setattr(study_lobes.slopes, "look_up", lambda pyramid, footprint, mdf, pair, lobes: (footprint, lobes, pair == study_lobes.slopes.LOBES[mdf]))
    monkeypatch.setattr(study_lobes.slopes, "mean_colours", lambda mdf, got, lobes: 2 + np.array([0, .1, .2, .3]) * got[0] / lobes * got[2])
    said = []
    rows = study_lobes.errors("waves", ("ggx",), (4, 16))(None, said.append)
    assert said == ["ggx"] and [(row["footprint"], row["lobes"]) for row in rows] == [(size, lobes) for size in (4, 16) for lobes in (1, 2, 3, 4, 6, 8)]
    for row in rows:
        share = row["footprint"] / row["lobes"] / 2
        assert (row["error"], row["error_low"], row["error_high"]) == (pytest.approx(.15 * share), pytest.approx(.075 * share), pytest.approx(.225 * share))
        assert (row["kind"], row["map"], row["distribution"]) == ("error", "waves", "ggx")
