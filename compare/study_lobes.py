# SPDX-License-Identifier: Apache-2.0
"""Lobes of a filtered normal map, 1 to 8: what a lookup costs, and how far its colour is from the truth.

Maps, truth and errors are those of slopes.py.
"""
import numpy as np

import fronts
import programs  # noqa: F401  (finds the module)
import shade
import slopes
import style
from study import Figure, Finding, Table, Task

NAME = "lobes"
TITLE = "Normal maps from afar: how many lobes"
INTRO = ("From afar a pixel holds many normals. The library keeps the mean and the spread of their slopes, and shades "
         "one wider lobe or several that carry the spread between them. The truth shades every texel under the pixel, "
         "supersampled, from the definitions. The error is that of the mean colour, over 20 pairs of light and eye, at "
         "the worst of the pixel's footprints. Times are for a whole lookup in double, one call a lobe.")
COUNTS = (1, 2, 3, 4, 6, 8)
FOOTPRINTS = (4, 16, 64)


def maps():
    """{key: (label, normals)}."""
    return {
        "waves": ("random waves", lambda: slopes.gaussian_map(0.15, 0.10, 2)),
        "ripples": ("even ripples", lambda: slopes.ripple_map(0.15, 0.10)),
        "scratches": ("scratches", lambda: slopes.scratch_map(
            pits=3000, radius=(0.004, 0.012), stretch=(2, 8), spread=np.radians(20), depth=(0.03, 0.12))),
    }


def errors(key, mdfs, footprints):
    def run(_folder, say):
        normals = maps()[key][1]()
        fine, pyramid = slopes.supersampled(normals), shade.SlopeMap(normals, normals="signed")
        rows = []
        for mdf in mdfs:
            say(mdf)
            first, second = slopes.LOBES[mdf]
            true = np.array([slopes.shaded(mdf, first, second, fine, *pair).mean() for pair in slopes.directions()])
            for footprint in footprints:
                for lobes in COUNTS:
                    got = slopes.look_up(pyramid, footprint, mdf, (first, second), lobes)
                    off = np.abs(slopes.mean_colours(mdf, got, lobes) - true) / true.mean()
                    low, high = np.percentile(off, [25, 75])
                    rows.append({"kind": "error", "map": key, "distribution": mdf, "footprint": footprint,
                                 "lobes": lobes, "error": float(off.mean()), "error_low": float(low),
                                 "error_high": float(high)})
        return rows
    return run


def speed(runs):
    def run(_folder, say):
        rows = fronts.bench(["--what", "lobes"], runs, say)
        return [{"kind": "speed", **row, "lobes": int(row["what"].split("_")[1])} for row in rows]
    return run


def tasks(quick):
    mdfs = ("ggx",) if quick else tuple(slopes.LOBES)
    footprints = (16,) if quick else FOOTPRINTS
    keys = ("waves", "scratches") if quick else tuple(maps())
    each = 2.5 if quick else 30
    return [Task("speed", 0.5 * (5 if quick else 15), speed(5 if quick else 15), fronts.command(["--what", "lobes"])),
            *(Task(f"error-{key}", each, errors(key, mdfs, footprints)) for key in keys)]


def cases(rows):
    """[(map, distribution)]."""
    return list(dict.fromkeys((r["map"], r["distribution"]) for r in rows if r["kind"] == "error"))


def points(rows, key, mdf):
    found = []
    for lobes in COUNTS:
        each = fronts.pick(rows, kind="error", map=key, distribution=mdf, lobes=lobes)
        worst = max(each, key=lambda r: r["error"])
        found.append(fronts.Point(f"lobes_{lobes}",
                                  fronts.times(rows, kind="speed", distribution=mdf, lobes=lobes), worst["error"],
                                  min(worst["error_low"], worst["error"]), max(worst["error_high"], worst["error"])))
    return found


def findings(rows):
    each = {case: {p.word: p for p in points(rows, *case)} for case in cases(rows)}
    one, six = ({case: p[f"lobes_{n}"] for case, p in each.items()} for n in (1, 6))
    ggx = [case for case in each if case == ("waves", "ggx")]
    cost = float(np.median([fronts.ratio(six[c].times, one[c].times)[0] for c in each]))
    judged = [c for c in each if c[0] != "ripples"]
    told = [
        Finding(f"Six lobes come within {100 * max(six[c].error for c in judged):.1f} % of every texel shaded, on "
                f"random waves and scratches, at {cost:.1f} times the time of one, which is up to "
                f"{100 * max(one[c].error for c in judged):.1f} % off.",
                max(six[c].error for c in judged) < 0.03
                and max(six[c].error for c in judged) < max(one[c].error for c in judged), "fronts"),
    ]
    for case in ggx:
        told.append(Finding("GGX needs them most: on random waves one lobe is "
                            f"{100 * one[case].error:.1f} % off, six are {100 * six[case].error:.1f} %, since the "
                            "variance of GGX is infinite and no width matches it.",
                            six[case].error < 0.5 * one[case].error, "fronts"))
    rippled = [c for c in each if c[0] == "ripples"]
    if rippled:
        told.append(Finding("Where slopes are not spread as chance spreads them, no number of lobes helps: on even "
                            f"ripples six are still {100 * min(six[c].error for c in rippled):.0f} to "
                            f"{100 * max(six[c].error for c in rippled):.0f} % off, for the mean and the spread are "
                            "all that is known.", min(six[c].error for c in rippled) > 0.02, "fronts"))
    return told


def figures(rows):
    panels = []
    for key, mdf in cases(rows):
        panel, axes = style.figure(360, 290)
        fronts.chart(axes, points(rows, key, mdf), f"{maps()[key][0]}, {style.of(mdf).label}",
                     "error of the mean colour", time_label="ns a lookup, one core")
        panels.append(style.svg(panel))
    return [Figure("fronts", "Time against error, by the number of lobes",
                   "The worst footprint. Bars: the middle half of the runs, and of the pairs of light and eye; dashed: "
                   "the Pareto front. `build/venv/bin/python compare/report_page.py --only lobes`", "\n".join(panels),
                   "Charts of time against error for each map and distribution: more lobes take longer and come "
                   "nearer, but on even ripples.")]


def tables(rows):
    lines = [[maps()[key][0], style.of(mdf).label, int(p.word.split("_")[1]), 100 * p.error, p.ns,
              "{:.0f} to {:.0f}".format(*p.bar)]
             for key, mdf in cases(rows) for p in points(rows, key, mdf)]
    return [Table("numbers", "Lobes of a filtered map", "Mean colour at the worst footprint.",
                  ["map", "distribution", "lobes", "off, %", "ns", "middle half"], lines)]
