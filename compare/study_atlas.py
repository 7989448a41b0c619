# SPDX-License-Identifier: Apache-2.0
"""The stability atlas: where detail methods fail, as printed in their papers and as the library has them.

As a part of the report it draws maps (study.py). By itself it prints the sample that shows a region:

    build/venv/bin/python compare/study_atlas.py --at form=deform_smooth_printed tilt=45 azimuth=45 theta=-60
    build/venv/bin/python compare/study_atlas.py --at form=perturb tilt=60 azimuth=45 eye=85 eye_azimuth=90
    build/venv/bin/python compare/study_atlas.py --at form=valid_estevez tilt=30 azimuth=0 eye=60 light=80
    build/venv/bin/python compare/study_atlas.py --at form=rotate horizon=valid_reflection tilt=60 azimuth=0 light=85

Angles in degrees: tilt and azimuth of n; theta of the half vector in n's plane (below 0: away from n; phi: another
plane), or of the eye and the light. size: an exponent of the narrow axis, or an alpha. Printed are the value of the
printed formula, of the library, of the reference (`shade eval --precision reference`) and of the displaced surface.
"""
import argparse
import functools
import sys

import numpy as np

import atlas_at
import atlas_charts as charts
import atlas_facing
import atlas_measures as measures
import atlas_regions
import report
from atlas_findings import EDGES, JUMPS, PLAIN, SHADED, findings, most, of, printed  # noqa: F401  a study's
from atlas_forms import FORMS, HORIZONS, ROTATION, SLOPES, USUAL, WARP
from study import Figure, Table, Task

NAME, TITLE = "atlas", "Stability: where methods fail"
INTRO = """Each detail method, as its paper prints it and as the library has it, is held against the surface that is
really displaced: D′ at half vectors in the plane of the bumped normal, the integral of D′ and the place of its peak,
rounding, white furnaces, draws, exchange of light and eye, jumps: over tilt, over exponents and alphas, and where the
eye or the light grazes. Whether h leaves the disc does not depend on exponents. Printed forms are of D′ alone: as a
BRDF they are black below either horizon, reciprocal, and nothing is drawn by them. A map's cells fail where they pass a limit; what fails is outlined and named there, and the table at the end gives the formula's
reason, what the library does instead, and a command that prints the sample. Truth: the frame of the displaced height
field, long-hand in Python; for rounding in 80-bit numbers."""

LOBED = [w for w in FORMS if w not in ("rotate_row_three", "rotate_axis_v", "ward_no_squares", "ward_of_h",
                                       "beckmann_unnormalised", "ggx_unnormalised")]
COMMAND = "build/venv/bin/python compare/report_page.py --only atlas"


def half(step, _folder, say):
    tilts, thetas = [*np.arange(0, 90, step), 89.0], np.arange(-90, 90 + step / 2, step)
    say("D′ in the plane of n")
    return [row for word in FORMS for azimuth in (45, 90) for row in measures.half(word, tilts, thetas, azimuth)]


def normal(step, size, _folder, say):
    rows = []
    for word in FORMS:
        say(f"∫D′ of {FORMS[word].label}")
        rows += measures.normal(word, [*np.arange(0, 80, step), 85.0], np.arange(0, 91, 15), size)
    return rows


def lobe(tilts, rings, turns, _folder, say):
    rows = []
    for word in LOBED:
        say(f"widths of {FORMS[word].label}")
        rows += measures.lobe(word, tilts, (20, 70), rings, turns)
    return rows


def rounding(tilts, _folder, say):
    say("rounding")
    return measures.rounded(tilts, (1, 10, 100, 1e3, 1e4, 1e5, 1e6))


EYES = (0, 15, 30, 45, 60, 70, 80, 85, 89)


def grazing(tilts, draws, turns, _folder, say):
    rows = []
    for word in SHADED:
        say(f"grazing light and eye: {FORMS[word].label}")
        if FORMS[word].printed:
            rows += measures.grazing(word, "hard", tilts, EYES, 36, (0, 45, 90), turns)
        else:
            rows += measures.grazing(word, "hard", tilts, EYES, draws, (0, 45, 90), 2 * turns)
    return rows + measures.grazing("rotate", "valid_estevez", tilts, EYES, draws, (0, 45, 90), 2 * turns)


def pairs(angles, _folder, say):
    say("exchange of light and eye")
    rows = [row for horizon in HORIZONS for row in measures.pairs("rotate", horizon, 30, angles)]
    return rows + [row for word in PLAIN if word != "rotate" for row in measures.pairs(word, "hard", 30, angles)]


LIT = [*(("rotate", h) for h in HORIZONS), *((w, "hard") for w in PLAIN if w != "rotate")]
ANY_WIDTH = [*((w, "hard") for w in LOBED if w in SHADED or w in ("beckmann_rotate", "ggx_rotate")),
             ("rotate", "valid_estevez")]


def wide(tilts, _folder, say):
    say("jumps of lobes of any width")
    return [row for word in FORMS for row in atlas_facing.widths(word, tilts)]


def faced(tilts, angles, azimuths, rings, _folder, say):
    rows = []
    for word, horizon in LIT:
        say(f"eye and light at an angle: {FORMS[word].label}, {horizon}")
        rows += atlas_facing.facing(word, horizon, "eye", tilts, angles, azimuths)
        rows += atlas_facing.facing(word, horizon, "light", tilts, (*angles, 90), azimuths, rings)
    return rows


def narrow(tilts, draws, turns, rings, _folder, say):
    rows = []
    for word, horizon in ANY_WIDTH:
        say(f"grazing eye, lobes of any width: {FORMS[word].label}")
        rows += atlas_facing.narrow(word, horizon, tilts, 85, draws, (0, 45), turns, rings)
    return rows


def points(_folder, say):
    say("jumps, fibres")
    return measures.jumps() + measures.horizons() + measures.fibre(np.arange(0, 90, 7.5), np.arange(0, 360, 15))


def tasks(quick):
    part, steep = functools.partial, [*range(0, 90, 10), 85, 89]
    made = ((("half", 2, part(half, 5)), ("normal", 6, part(normal, 10, 72)),
             ("lobe", 6, part(lobe, (0, 15, 30, 45, 60, 75), 64, 160)), ("rounding", 1, part(rounding, steep)),
             ("grazing", 4, part(grazing, (0, 15, 30, 45, 60, 75), 512, 4)),
             ("pairs", 1, part(pairs, (0, 15, 30, 45, 60, 75, 85, 89))), ("points", 1, points),
             ("wide", 1, part(wide, (0, 15, 30, 45, 60, 75))),
             ("faced", 3, part(faced, (0, 15, 30, 60, 75), (0, 30, 60, 75, 85, 89), (0, 90), 32)),
             ("narrow", 2, part(narrow, (0, 20, 40, 60, 75), 128, 2, 40))) if quick else
            (("half", 4, part(half, 3)), ("normal", 60, part(normal, 5, 160)),
             ("lobe", 40, part(lobe, (0, 10, 20, 30, 40, 50, 60, 70, 80), 160, 320)),
             ("rounding", 1, part(rounding, range(0, 90, 5))),
             ("grazing", 25, part(grazing, range(0, 81, 10), 4096, 4)),
             ("pairs", 2, part(pairs, (*range(0, 90, 10), 85, 89))), ("points", 1, points),
             ("wide", 2, part(wide, range(0, 90, 5))),
             ("faced", 60, part(faced, range(0, 81, 10), (*range(0, 90, 10), 85, 89), (0, 45, 90), 64)),
             ("narrow", 40, part(narrow, range(0, 81, 10), 1024, 4, 80))))
    return [Task(f"{key}_quick" if quick else key, seconds, run, COMMAND + (" --quick" if quick else ""))
            for key, seconds, run in made]


# ---- how it looks -------------------------------------------------------------------------------------

def label(rows):
    form = FORMS.get(rows[0]["form"])
    return form.label if form else {"literal": "pow, x² + y²", "common": "pow, 1 − z²"}.get(
        rows[0]["form"], f"library, {rows[0]['form']}")


def side(rows):
    return label(rows) if rows[0]["azimuth"] == 45 else f"n at {rows[0]['azimuth']:g}°"


FAMILIES = ((ROTATION, "Rotation, as printed and corrected"), (WARP, "Warps of the disc"),
            (USUAL, "What renderers do"), (SLOPES, "Ward, Beckmann, GGX"))
NOTE = f" Made by `{COMMAND}`."
HALF = ("Half vectors in the plane of z and n, below 0 on the side away from n; n at an azimuth of 45° (left) and 90°. "
        "Exponents 200 and 10, alphas 0.1 and 0.4. Outlined: more than 0.1 of the peak off, jumps, NaN, off the disc.")
ENERGY = ("∫D′ over the hemisphere (with n·h for Beckmann and GGX), less that of the displaced surface, of which part "
          "turns below the horizon. Outlined: off by more than 0.03.")
LOBE = ("∫D′ less that of the displaced surface, by the parameter of the narrow axis (the other exponent a twentieth, "
        "the other alpha four times as much, at most 10), worst of two azimuths. Outlined: off by more than 0.03.")
ROUNDING = ("D′ of `rotate` against 80-bit arithmetic on the same inputs, worst of 144 half vectors within three "
            "widths of the lobe. Outlined: more than 10⁻³.")
FURNACE = ("Albedo of a white metal (F = 1, exponents 200 and 10) under even light, black below either horizon unless "
           "said. Outlined: above 1.01.")
SPREAD = ("Deviation of f cos/pdf over its mean, draws that find no direction counted as 0; where the albedo is above "
          "0.05. Outlined: above 1.")
WIDE = ("The largest step of D′ between half vectors 10⁻⁷ rad apart (less for narrow lobes), in the plane of z and n, by "
        "the parameter of the narrow axis. Outlined: more than 10⁻³ of the peak; NaN.")
PEAK = ("Angle from n to where D′ is largest, by the parameter of the narrow axis; 0 where the displaced surface's own is "
        "largest elsewhere, as of alphas above 1. Outlined: more than 1°.")
GRAZED = "The eye 85° from z; by the parameter of the narrow axis. "
BEAM = ("What of a beam of light on the facet is reflected to any eye above: ∫ f cos (n·wo) dwo over n·wi; exponents 200 "
        "and 10, F = 1, black below either horizon unless said. Outlined: above 1.01.")
SWAP = " `rotate` with each horizon, worst of all directions of the other. Outlined: not reciprocal."
STEP = ("The largest step of f cos as the {} moves by 10⁻⁷ rad along its polar angle, worst of all directions of the other. "
        "Outlined: more than 10⁻³ of the largest f cos there.")
FIBRE = ("Φ of light on fibres along azimuth 0 (Hast, Wesslén and Seipel, Eq. 10) against the mean over the fibre. "
         "Outlined: off by more than 10⁻³, NaN.")


def hard(rows):
    return label(rows) + ("" if rows[0]["horizon"] == "hard" else ", default horizon")


def figures(rows):
    made = []

    def draw(name, title, caption, groups, *how, alt, **more):
        made.append(Figure(name, title, caption + NOTE, charts.maps(groups, *how, **more), alt))

    for family, title in FAMILIES:
        words = [w for w, f in FORMS.items() if f.family == family]
        draw(f"half-{family}", f"{title}: D′ over tilt and half vector", HALF,
             charts.grouped(of(rows, "half", *words), "form", "azimuth"), "half", ("wrong", "nan", "off", "jump"),
             ("theta", "tilt"), side, alt=f"Error of {', '.join(FORMS[w].label for w in words)} over the angle of the "
             "half vector and the tilt of the normal")
    finite = [w for w in FORMS if w != "rotate_row_three"]
    moved = [w for w in finite if w == "rotate" or most(of(rows, "normal", w), "displaced") > 1]
    draw("energy", "Light made or lost", ENERGY, charts.grouped(of(rows, "normal", *finite), "form"), "energy",
         ("energy",), ("azimuth", "tilt"), label, alt="∫D′ over azimuth and tilt of the normal, a map for each form")
    draw("displaced", "Displacement of the peak", "Angle from n to where D′ is largest. Outlined: more than 1°.",
         charts.grouped(of(rows, "normal", *moved), "form"), "displaced", ("displaced",), ("azimuth", "tilt"), label,
         alt="Displacement over azimuth and tilt of the normal, a map for each form that is displaced and for rotate")
    draw("lobe", "Lobes of any width", LOBE, charts.grouped(of(rows, "lobe"), "form"), "lobe", ("lobe",),
         ("size", "tilt"), label, alt="∫D′ over the width of the lobe and the tilt of the normal, a map for each form")
    draw("rounding", "Rounding", ROUNDING, charts.grouped(of(rows, "float"), "form"), "float", ("rounding",),
         ("size", "tilt"), label, alt="Relative error over exponent and tilt, for textbook forms and the library's")
    shaded = charts.grouped(of(rows, "grazing"), "form", "horizon")
    draw("albedo", "White furnace", FURNACE, shaded, "albedo", ("furnace",), ("eye", "tilt"), hard,
         alt="Albedo over the eye's angle and the tilt of the normal, a map for each form")
    draw("spread", "Sampling weights", SPREAD, [g for g in shaded if not printed(g[0]["form"])], "spread", ("weights",),
         ("eye", "tilt"), hard,
         alt="Spread of weights over the eye's angle and the tilt of the normal, a map for each method")
    draw("pairs", "Exchange of light and eye", "`rotate`, tilt 30°, for each horizon. Outlined: not reciprocal.",
         charts.grouped(of(rows, "pairs", "rotate"), "horizon"), "pairs", ("asymmetry",), ("eye", "light"),
         lambda r: r[0]["horizon"].replace("_", " "), alt="Asymmetry of f over the angles of eye and light")
    more_figures(rows, draw)
    draw("fibre", "The fibre integral as printed", FIBRE, [of(rows, "fibre")], "fibre", ("fibre", "fibre nan"),
         ("azimuth", "theta"), lambda _r: "Eq. 10",
         alt="Error of the printed fibre integral over the light's direction",
         heads={"azimuth": "azimuth of light, °", "theta": "light from z, °"})
    return made


def more_figures(rows, draw):
    """Over widths of the lobe, and where light or eye grazes."""
    draw("wide", "Jumps of lobes of any width", WIDE, charts.grouped(of(rows, "wide"), "form"), "wide",
         ("wide jump", "wide nan"), ("size", "tilt"), label, alt="Jump of D′ over the width of the lobe and the tilt of n")
    words = [w for w in LOBED if w == "rotate" or most(of(rows, "lobe", w), "displaced") > 1]
    draw("peak", "Displacement of the peak of lobes of any width", PEAK, charts.grouped(of(rows, "lobe", *words), "form"),
         "peak", ("peak",), ("size", "tilt"), label, alt="Displacement of the peak over width and tilt, for the forms that "
         "have one and for rotate")
    groups = charts.grouped(of(rows, "narrow"), "form", "horizon")
    library = [g for g in groups if not printed(g[0]["form"])]
    draw("narrow-albedo", "White furnace, lobes of any width", GRAZED + "Albedo of a white metal. Outlined: above 1.01.",
         groups, "albedo", ("narrow furnace",), ("size", "tilt"), hard, alt="Albedo over the width of the lobe and the tilt")
    draw("narrow-spread", "Sampling weights, lobes of any width", GRAZED + SPREAD, library, "spread", ("narrow weights",),
         ("size", "tilt"), hard, alt="Spread of weights over the width of the lobe and the tilt of n")
    draw("narrow-pairs", "Exchange of light and eye, lobes of any width", GRAZED + "All methods with `hard` are 0 at all "
         "widths; here `rotate`. Outlined: not reciprocal.", [g for g in library if g[0]["form"] == "rotate"], "asymmetry",
         ("narrow asymmetry",), ("size", "tilt"), hard, alt="Asymmetry of f over the width of the lobe and the tilt of n")
    lit = charts.grouped(of(rows, "light"), "form", "horizon")
    seen = charts.grouped(of(rows, "eye"), "form", "horizon")
    draw("beam", "Light that grazes: what a beam gives back", BEAM, lit, "returned", ("light furnace",), ("light", "tilt"),
         horizon_too, alt="Share of a beam given back over the light's angle and the tilt of n, a map for each method")
    for which, groups in (("eye", seen), ("light", lit)):
        turned = [g for g in groups if g[0]["form"] == "rotate"]
        draw(f"pairs-{which}", f"Exchange of light and eye, by the {which}'s angle", f"By the {which}'s angle from z." + SWAP,
             turned, "asymmetry", (f"{which} asymmetry",), (which, "tilt"), horizon_too,
             alt=f"Asymmetry of f over the {which}'s angle and the tilt of n, a map for each horizon")
        draw(f"steps-{which}", f"Jumps of f cos, by the {which}'s angle", STEP.format(which), groups, "step",
             (f"{which} jump",), (which, "tilt"), horizon_too,
             alt=f"Jumps of f cos over the {which}'s angle and the tilt of n, a map for each method and horizon")


def horizon_too(rows):
    return rows[0]["horizon"].replace("_", " ") if rows[0]["form"] == "rotate" else label(rows)


def tables(rows):
    listed = []
    for region in atlas_regions.regions(rows):
        name, why, instead = region.explained or ("unexplained", "", "")
        listed.append([name, region.label, "yes" if region.default else "", region.where(), atlas_regions.FAILS[region.failure][3],
                       None if region.failure in atlas_regions.NANS else region.value,
                       f"{why}. The library: {instead}", region.place()])
    def steps(group, what, stays):
        nearer = sorted(group, key=lambda r: -r["distance"])
        return [what, group[0]["place"], *(r["jump"] for r in nearer), "stays" if stays else "vanishes"]

    jumped = [steps(g, "D′, " + FORMS[g[0]["form"]].label, (g[0]["form"], g[0]["place"]) in JUMPS)
              for g in charts.grouped(of(rows, "jump"), "form", "place")]
    jumped += [steps(g, "f cos, " + g[0]["horizon"].replace("_", " "), (g[0]["horizon"], g[0]["place"]) in EDGES)
               for g in charts.grouped(of(rows, "edge"), "horizon", "place")]
    distances = sorted({r["distance"] for r in of(rows, "jump")}, reverse=True)
    return [
        Table("regions", "All regions that fail",
              "Whether `rotate` under `valid_estevez` meets it, where it is, the value at its worst, the formula's reason, and what the library does there. "
              "`build/venv/bin/python compare/study_atlas.py --at` and the words of the last column print the worst "
              "sample: the printed formula, the library, the reference, the truth.",
              ["region", "form", "default", "where", "measure", "at its worst", "why, and instead", "--at"], listed),
        Table("jumps", "Jumps",
              "Difference between two directions as they come together: of D′ in parts of the peak; of `rotate`'s f cos, "
              "across the surface's horizon for the light and n's for the eye, in parts of what it is 20° above.",
              ["of", "where", *(f"at {d:g} rad" for d in distances), "jump"], jumped)]


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--at", nargs="+", required=True, metavar="KEY=VALUE", help="form=… and angles, as above")
    lines = atlas_at.at(atlas_at.parse(parser.parse_args(argv).at))
    width = max(len(what) for what, _ in lines)
    for what, value in lines:
        print(f"{what.ljust(width)}  {value}")
    return 0


if __name__ == "__main__":
    sys.exit(report.run(main))
