# SPDX-License-Identifier: Apache-2.0
"""What the stability atlas says in words, each sentence with the test that its rows make it true."""
import atlas_measures as measures
import atlas_regions
import style
from atlas_forms import FORMS, HORIZONS
from study import Finding

SHADED = [w for w, f in FORMS.items() if f.mdf == "ashikhmin_shirley"]
PLAIN = [w for w in SHADED if not FORMS[w].printed]
# where D' jumps: docs/theory/conventions.md, "Continuity"
JUMPS = {("perturb", "h = z"), ("deform_linear_conserving", "h = n"), ("deform_smooth_conserving", "h = n"),
         ("rotate", "n → y"), ("gram_schmidt", "n → x"), ("ggx_rotate", "z̃ = 0")}
EDGES = {("hard", "wi.z = 0"), ("hard", "n·wo = 0"), ("valid_reflection", "wi.z = 0"), ("estevez", "n·wo = 0"),
         ("chiang", "n·wo = 0")}


def of(rows, which, *words, **same):
    """Rows of a map, of these forms, with these values."""
    return [r for r in rows if r["map"] == which and (not words or r["form"] in words)
            and all(r.get(k) == v for k, v in same.items())]


def most(rows, column):
    """The largest of a column, or of what a function makes of a row."""
    measure = column if callable(column) else lambda row: row[column]
    return max((measure(row) for row in rows), default=float("nan"))


def printed(word):
    return word in FORMS and FORMS[word].printed is not None


def excess(row):
    return row["energy"] - row["true_energy"]


def few(value):
    """One digit: 0.05, 2·10⁻⁵."""
    return style.power(float(f"{value:.1g}"))


def exact(rows):
    cells = of(rows, "half", "rotate", "beckmann_rotate")
    error = most(cells, "error")
    energy = most(of(rows, "normal", "rotate"), lambda r: abs(excess(r)))
    return Finding(
        f"`rotate` is the displaced surface: at {len(cells)} half vectors and tilts to 89° D′ differs by at most "
        f"{few(error)} of the peak, its integral by {few(energy)}.", error < 1e-9 and energy < 1e-9, "half-rotation")


def no_nan(rows):
    cells = [r for r in rows if r["map"] in ("half", "lobe") and not printed(r["form"])]
    theirs = [r for r in of(rows, "half") if printed(r["form"])]
    shaded = [r for r in of(rows, "wide") if not printed(r["form"])] + of(rows, "eye") + of(rows, "light") + \
        [r for r in of(rows, "narrow") if not printed(r["form"])]
    bad = sum(r["nan"] for r in theirs)
    return Finding(
        f"No NaN leaves the library, at {len(cells)} cells of D′ and {len(shaded)} of jumps, f and draws, exponents 0 to "
        f"10⁶, alphas 10⁻⁴ to 10, grazing light and eye included; the printed formulas give NaN in {bad} of {len(theirs)}.",
        cells and shaded and sum(r["nan"] for r in cells + shaded) == 0 < bad, "half-warp")


def disc(rows):
    cells = of(rows, "normal", "deform_smooth_printed")
    off, mild = most(cells, "off_share"), most([r for r in cells if r["tilt"] == 30], "off_share")
    ours = most(of(rows, "normal", "deform_smooth"), "nan_share")
    return Finding(
        f"The smooth warp leaves the disc: at a tilt of 30° for {100 * mild:.0f} % of the half vectors, at most for "
        f"{100 * off:.0f} %. As printed that is NaN; the library gives 0 there.",
        0.05 < mild < off < 0.5 and ours == 0, "half-warp")


def misprints(rows):
    two, made = most(of(rows, "half", "rotate_row_two"), "error"), most(of(rows, "normal", "rotate_row_two"), excess)
    three = most(of(rows, "normal", "rotate_row_three"), "energy")
    return Finding(
        f"As printed, row 2 of the rotation is off by {two:.2f} of the peak and makes up to {made:.2f} of light from "
        f"nothing; row 3 makes the lobe its peak everywhere, an integral of {three:.0f}.",
        two > 0.3 and made > 0.1 and three > 40, "half-rotation")


def energy(rows):
    linear, smooth, perturb = (
        [r["energy"] for r in of(rows, "normal", w)] for w in ("deform_linear", "deform_smooth", "perturb"))
    kept = most([r for r in of(rows, "normal", "deform_linear_conserving", "deform_smooth_conserving")
                 if r["tilt"] <= 60], lambda r: abs(r["energy"] - 1))
    return Finding(
        f"∫D′ leaves 1: {min(perturb):.2f} to {max(perturb):.2f} for `perturb`, up to {max(linear):.2f} for the "
        f"linear warp and {max(smooth):.2f} for the smooth one; the conserving warps keep it within {few(kept)} to "
        "tilts of 60°.",
        min(perturb) < 0.8 and max(perturb) > 1.3 and max(linear) > max(smooth) > 1.05 and kept < 0.03, "energy")


def peaks(rows):
    moved = {r["form"] for r in of(rows, "normal") if r["displaced"] > 1 and not printed(r["form"])}
    return Finding("The peak stands where n is (within 1°) for all of the library's methods but `none`.",
                   moved == {"none"}, "displaced")


def any_width(rows):
    cells = [r for r in of(rows, "lobe") if not printed(r["form"])]
    moved = {r["form"] for r in cells if r["displaced"] > 1}
    wide = [r["size"] for r in cells if r["form"] == "deform_smooth_conserving" and r["displaced"] > 1]
    tail = [r["size"] for r in of(rows, "wide", "rotate") if r["jump"] > 1e-3]
    return Finding(
        "At every exponent from 0 to 10⁶ and every alpha from 10⁻⁴ to 10 that holds too, but for the conserving smooth warp "
        f"at exponents to {max(wide, default=0):g}; D′ of `rotate` jumps for exponents below 1 alone (to "
        f"{max(tail, default=0):g}), which have not come to 0 at the carried horizon.",
        moved == {"none", "deform_smooth_conserving"} and 1 <= max(wide) <= 100 and 0 <= max(tail, default=-1) < 1, "peak")


def jumps(rows):
    nearest = min(r["distance"] for r in of(rows, "jump"))
    stays = [r for r in of(rows, "jump", distance=nearest) if r["jump"] > 1e-5]
    names = sorted(f"{FORMS[r['form']].label} at {r['place']} ({r['jump']:.2g})" for r in stays)
    return Finding("D′ jumps, in parts of the peak: " + ", ".join(names) + "; elsewhere on the list it does not.",
                   {(r["form"], r["place"]) for r in stays} == JUMPS, "jumps")


def edges(rows):
    nearest = min(r["distance"] for r in of(rows, "edge"))
    stays = {(r["horizon"], r["place"]): r["jump"] for r in of(rows, "edge", distance=nearest) if r["jump"] > 1e-3}
    told = {place: ", ".join(f"`{h}`" for h, where in stays if where == place) for place in ("wi.z = 0", "n·wo = 0")}
    return Finding(
        f"Across the surface's horizon f cos jumps with light for {told['wi.z = 0']}; across n's with the eye for "
        f"{told['n·wo = 0']}; for the default `valid_estevez` and for `schuessler` at neither.", set(stays) == EDGES,
        "jumps")


def furnace(rows):
    albedo = {w: most(of(rows, "grazing", w, horizon="hard"), "albedo") for w in SHADED}
    above = [w for w in PLAIN if albedo[w] > 1.01]
    rest = max(albedo[w] for w in PLAIN if w not in above)
    kept = most(of(rows, "grazing", "rotate", horizon="valid_estevez"), "albedo")
    return Finding(
        "In a white furnace these give more than they take: "
        + ", ".join(f"`{w}` {albedo[w]:.2f}" for w in above)
        + f". All other methods of the library stay at {rest:.2f} or below, `rotate` with the default horizon at "
        f"{kept:.2f}.", set(above) == {"perturb", "deform_linear", "deform_smooth"} and 0 < kept <= 1.01, "albedo")


def weights(rows):
    hard = {w: of(rows, "grazing", w, horizon="hard") for w in ("rotate", "perturb")}
    flat = most([r for r in hard["rotate"] if r["tilt"] == 0], "spread")
    steep, worst = most(hard["rotate"], "spread"), most(hard["perturb"], "spread")
    return Finding(
        f"Sampling weights of `rotate` spread by {flat:.2f} of their mean where n = z, and by up to {steep:.1f} where "
        f"much of the lobe lies below the horizon; those of `perturb` by up to {worst:.1f}.",
        flat < 1.5 < steep < worst, "spread")


def beams(rows):
    best = most(of(rows, "light", "rotate", horizon="valid_estevez"), "albedo")
    hard = most(of(rows, "light", "rotate", horizon="hard"), "albedo")
    bent = most(of(rows, "light", "rotate", horizon="valid_reflection"), "albedo")
    above = sorted({r["form"] for r in of(rows, "light", horizon="hard") if r["albedo"] > 1.01})
    return Finding(
        f"Of a beam of light on a facet at any angle `rotate` gives back at most {best:.2f} with the default horizon and "
        f"{hard:.2f} with `hard`, but up to {bent:.1f} with `valid_reflection` alone, which bends n to light that grazes; "
        f"with `hard` these give back more than they get: {', '.join(f'`{w}`' for w in above)}.",
        max(best, hard) <= 1.01 < bent and above == ["deform_linear", "deform_smooth", "perturb"], "beam")


def widths(rows):
    cells = [r for r in of(rows, "narrow") if not printed(r["form"])]
    made = {r["form"] for r in cells if r["albedo"] > 1.01}
    rest = most([r for r in cells if r["form"] not in made], "albedo")
    wide = most(cells, "spread")
    return Finding(
        f"For an eye 85° from z, at any exponent or alpha, the albedo stays at {rest:.2f} or below but for "
        f"{' and '.join(f'`{w}`' for w in sorted(made))}; weights spread by up to {wide:.1f} of their mean.",
        made == {"deform_linear", "deform_smooth"} and 0.9 < rest <= 1.01 and 1 < wide < 10, "narrow-albedo")


def horizon_steps(rows):
    stays = {h: [most(of(rows, w, "rotate", horizon=h), "jump") > 1e-3 for w in ("light", "eye")]
             for h in HORIZONS}
    smooth = [h for h, both in stays.items() if not any(both)]
    return Finding(
        f"At every tilt and angle of light and eye f cos of `rotate` has no jump with {' and '.join(f'`{h}`' for h in smooth)}"
        "; with the others it jumps where light or eye crosses a horizon.", smooth == ["schuessler", "valid_estevez"],
        "steps-light")


def exchange(rows):
    swapped = {h: most(of(rows, "pairs", "rotate", horizon=h), "asymmetry") for h in HORIZONS}
    tilted = [r for which in ("eye", "light", "narrow") for r in of(rows, which) if not printed(r["form"])]
    plain = max(most([r for r in tilted if r["horizon"] == "hard"], "asymmetry"),
                most(of(rows, "pairs", horizon="hard"), "asymmetry"))
    swapped["schuessler"] = max(swapped["schuessler"], most([r for r in tilted if r["horizon"] == "schuessler"], "asymmetry"))
    others = [v for h, v in swapped.items() if h not in ("hard", "schuessler")]
    return Finding(
        f"At every tilt, angle and width every method is reciprocal with `hard` ({f'within {few(plain)}' if plain else 'to the last bit'}), `rotate` "
        f"with `schuessler` too (within {few(swapped['schuessler'])}); with the other horizons light and eye cannot be "
        f"exchanged: f differs by up to {100 * max(others):.0f} %.",
        plain < 1e-9 and swapped["schuessler"] < 1e-9 and min(others) > 0.1, "pairs")


def rounding(rows):
    worst = {w: most(of(rows, "float", w, size=1e6), "error") for w in measures.FLOATS}
    return Finding(
        f"In float a textbook frame with pow of the cosine is off by {few(worst['literal'])} at an exponent of 10⁶, "
        f"the library by {few(worst['float'])}. Over 1 − z² in place of x² + y² the same pow is off by "
        f"{few(worst['common'])}, since the rounding of z cancels; that needs a frame that is unit, which the "
        "approximate rotation is not.",
        worst["literal"] > 0.02 and worst["float"] < 5e-4 and worst["common"] < 5e-3, "rounding")


def slopes(rows):
    cells = of(rows, "half", "ggx_short_of_l", "beckmann_short_of_l")
    steep, mild = most(cells, "error"), most([r for r in cells if r["tilt"] <= 45], "error")
    same = most(of(rows, "half", "rotate"), "error")
    return Finding(
        "Slope distributions see the L that the approximate rotation leaves out: D′ of GGX or Beckmann is off by up to "
        f"{mild:.2f} of the peak at tilts to 45°, by {few(steep)} times it beyond; Ashikhmin-Shirley's is not.",
        steep > 10 and mild > 0.1 and same < 1e-9, "half-slopes")


def fibres(rows):
    cells = of(rows, "fibre")
    behind = most([r for r in cells if 90 < r["azimuth"] < 270], "error")
    ahead = most([r for r in cells if not 90 <= r["azimuth"] <= 270], "error")
    ours = most(cells, "library_error")
    return Finding(
        f"The printed fibre integral is off by {behind:.3f} where the light comes from behind the fibre's tangent, by "
        f"{few(ahead)} elsewhere, and 0/0 between; the library by {few(ours)} everywhere.",
        behind > 0.5 and ahead < 1e-6 and ours < 1e-6 and sum(r["nan"] for r in cells) > 0, "fibre")


def explained(rows):
    failed = atlas_regions.regions(rows)
    nameless = [region for region in failed if region.explained is None]
    return Finding(
        f"Of {len(failed)} regions that fail {sum(region.default for region in failed)} concern defaults. Each has a name, a reason and a command, in the table"
        + (f", but for {nameless[0].label}: {nameless[0].failure}." if nameless else "."),
        failed and not nameless, "regions")


ALL = (exact, no_nan, disc, misprints, energy, peaks, any_width, jumps, edges, horizon_steps, furnace, beams, widths,
       weights, exchange, rounding, slopes, fibres, explained)


def findings(rows):
    found = (finding(rows) for finding in ALL)
    return [Finding(f.text, bool(f.holds), f.figure) for f in found]
