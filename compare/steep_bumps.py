# SPDX-License-Identifier: Apache-2.0
"""Bumps among bumps: how bright a bumped metal is on the mean, beside the same bumps really displaced.

build/bumps (compare/bumps/) traces displaced fields of metal with up to 32 reflections, and shades the same fields
by their normals with each choice of horizon. Surfaces: a noise of waves, a sine plate, ridges seen across and along.
`mutual` knows the slopes of the whole field where that is even, else those of a window about each point.
With --long lobes are long, too (not on the sine plate); with --uneven fields are: waves of four octaves, long waves
with fine ones, roofs, an embossed letter, pits, scratches, and noise on one half.
Eyes stand at 15 to 75 degrees, reflectances are .6 and 1, lights five drawn skies (even, bright zenith, bright
horizon, a bright patch before and behind the eye) and twelve suns of 5 to 60 degrees.

An error is that of the mean over the whole field. Under a sun it is over the truth plus a tenth of what that eye sees
on the mean of all suns: some suns light nearly nothing. Tables give the median of the cases, and what 95 % of them
stay under. A group is a surface, a slope, a lobe and a sky.

Leaves in the output folder: bumps.csv (all values), errors.csv, groups.csv. A case that is there already, of the
same program, is not traced again.
"""
import argparse
import concurrent.futures
import csv
import os
import subprocess
from pathlib import Path

import numpy as np

import programs
import report
import results
import whole

SURFACES = ("noise", "sine", "ridges_across", "ridges_along")
SLOPES = (0.3, 0.6, 1.0, 1.6)
ROUND = [("ggx", alpha, alpha) for alpha in (0.05, 0.2, 0.4)]
LONG = [("ggx", 0.05, 0.4), ("ggx", 0.4, 0.05), ("ashikhmin_shirley", 200, 10), ("ashikhmin_shirley", 10, 200)]
UNEVEN = {"fractal": "1/f", "long_and_fine": "long waves with fine ones", "roofs": "roofs", "letter": "letter", "pits": "pits",
          "scratches": "scratches", "half": "half flat"}
UNEVEN_PATHS = 8000  # an eye, at most: their fields are four times as large
UNEVEN_CASES = [(surface, slope, ("ggx", alpha, alpha)) for surface in UNEVEN for slope in (0.6, 1.0) for alpha in (0.05, 0.2)]
PROGRAM = programs.BUILD / "bumps"
WORDS = ("surface", "mdf", "light", "way")
KEY = ("surface", "slope", "mdf", "first", "second")
FLOOR = 0.1  # of what an eye sees of all suns
WORSE = 0.03
OLD = "valid_estevez"
LABELS = {"noise": "noise", "all": "all even surfaces", **UNEVEN, "uneven": "all uneven surfaces"}
PATCHES = ("patch_before", "patch_behind")


def arguments(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--paths", type=int, default=20000, help="of each eye (default 20000)")
    parser.add_argument("--surfaces", default=",".join(SURFACES), help=f"some of {', '.join(SURFACES)} (default all)")
    parser.add_argument("--slopes", default=",".join(map(str, SLOPES)), help="default %(default)s")
    parser.add_argument("--long", action="store_true", help="lobes that are long, too: GGX .05, .4 and Ashikhmin-Shirley 200, 10")
    parser.add_argument("--uneven", action="store_true", help="uneven surfaces, too, at slopes .6 and 1")
    parser.add_argument("--results", action="store_true", help="rewrite docs/results/, as make compare does")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "bumps",
                        help="folder for results (default build/compare/bumps)")
    options = parser.parse_args(argv)
    options.surfaces = options.surfaces.split(",")
    if not set(options.surfaces) <= set(SURFACES):
        parser.error(f"--surfaces wants some of {', '.join(SURFACES)}")
    try:
        options.slopes = [float(word) for word in options.slopes.split(",")]
    except ValueError:
        parser.error("--slopes wants numbers between commas")
    return options


def trace(options, case):
    """The CSV file of a case: its name holds all that it was asked for."""
    surface, slope, (mdf, first, second) = case
    paths = min(options.paths, UNEVEN_PATHS) if surface in UNEVEN else options.paths
    path = options.output / f"{surface}-{slope:g}-{mdf}-{first:g}-{second:g}-{paths}.csv"
    if not path.exists() or path.stat().st_mtime < PROGRAM.stat().st_mtime:
        command = [PROGRAM, path, surface, slope, mdf, first, second, paths]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
        if done.returncode:
            raise report.StepFailed(f"{PROGRAM}: exit status {done.returncode}: {done.stderr.strip()}")
    return path


def measure(options):
    """All rows, numbers as such, with progress."""
    cases = [(surface, slope, lobe) for surface in options.surfaces for slope in options.slopes
             for lobe in ROUND + (LONG if options.long and surface != "sine" else [])] + (UNEVEN_CASES if options.uneven else [])
    rows = []
    progress = report.Progress("Tracing displaced bumps")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for done, path in enumerate(pool.map(lambda case: trace(options, case), cases), 1):
            progress.read(f"{100 * done // len(cases)} %")
            with open(path, encoding="utf-8", newline="") as file:
                rows += [{key: text if key in WORDS else float(text) for key, text in row.items()} for row in csv.DictReader(file)]
    progress.done()
    return rows


def errors(rows):
    """Rows of the ways, each with its `error`, a share, and the `noise` of its truth."""
    truth = {}
    for row in rows:
        row["mean"] = 0.5 * (row["value"] + row["again"])
        if row["way"] == "displaced":
            truth[tuple(row[key] for key in (*KEY, "eye", "reflectance", "light"))] = row
    suns = {}
    for key, row in truth.items():
        if key[-1].startswith("sun"):
            suns.setdefault(key[:-1], []).append(row["mean"])
    found = []
    for row in rows:
        key = tuple(row[name] for name in (*KEY, "eye", "reflectance", "light"))
        if row["way"] != "displaced":
            real = truth[key]
            over = real["mean"] + (FLOOR * np.mean(suns[key[:-1]]) if key[-1].startswith("sun") else 0)
            found.append({**row, "error": row["mean"] / over - real["mean"] / over,
                          "noise": 0.5 * abs(real["value"] - real["again"]) / over})
    return found


def spread(rows, what="error"):
    """Median and 95 % of |error| in per cent."""
    off = np.abs([row[what] for row in rows])
    return 100 * float(np.median(off)), 100 * float(np.quantile(off, 0.95))


def said(pair):
    return "{:.1f} / {:.0f}".format(*pair) if pair[1] >= 10 else "{:.1f} / {:.1f}".format(*pair)


def is_long(row):
    return row["first"] != row["second"]


def light_of(row):
    """What its line of the table says it is lit by, or ""."""
    if row["light"].startswith("sun"):
        return "" if row["light"].startswith("sun_5_") else "suns from 15°"
    return "skies" if row["surface"] not in UNEVEN else "patches" if row["light"] in PATCHES else "even, zenith, horizon"


def is_of(name, row):
    return row["surface"] == name or name == ("uneven" if row["surface"] in UNEVEN else "all")


def lines(found, ways):
    """Lines (surfaces, lobes, lights, slope, cases, {way: (median, 95 %)}, noise)."""
    made = []
    for name in LABELS:
        for long in (False, True):
            of_name = [row for row in found if is_of(name, row) and is_long(row) == long]
            for light in dict.fromkeys(filter(None, map(light_of, of_name))):
                for slope in sorted({row["slope"] for row in of_name}):
                    here = [row for row in of_name if row["slope"] == slope and light_of(row) == light]
                    of = {way: [row for row in here if row["way"] == way] for way in ways}
                    made.append((LABELS[name], "long" if long else "round", light, slope, len(of[ways[0]]),
                                 {way: spread(of[way]) for way in ways}, spread(of[ways[0]], "noise")))
    return made


def groups(found, way):
    """[(surface, slope, mdf, first, second, sky, by this way, by the old one)] that got worse by more than WORSE."""
    of = {}
    for row in found:
        if not row["light"].startswith("sun") and row["way"] in (way, OLD):
            of.setdefault(tuple(row[key] for key in (*KEY, "light")), {}).setdefault(row["way"], []).append(row)
    pairs = [(key, spread(both[way]), spread(both[OLD])) for key, both in of.items()]
    return len(pairs), [(*key, *new, *old) for key, new, old in pairs if max(new[0] - old[0], new[1] - old[1]) > 100 * WORSE]


def main(argv=None):
    options = arguments(argv)
    options.output = options.output.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    rows = measure(options)
    found = errors(rows)
    ways = list(dict.fromkeys(row["way"] for row in found))
    table = lines(found, ways)
    names = list(rows[0])
    whole.write_csv(options.output / "bumps.csv", [names, *([row[name] for name in names] for row in rows)])
    columns = ["surface", "lobes", "light", "slope", "cases", *(f"`{way}`" for way in ways), "noise of the truth"]
    cells = [[*line[:5], *(said(pair) for pair in line[5].values()), said(line[6])] for line in table]
    whole.write_csv(options.output / "errors.csv", [columns, *cells])
    worse = {way: groups(found, way) for way in ways if way != OLD}
    whole.write_csv(options.output / "groups.csv", [["way", *KEY, "sky", "median", "95 %", f"{OLD} median", f"{OLD} 95 %"],
                                                   *([way, *line] for way, (_count, list_) in worse.items() for line in list_)])
    print()
    print("Error of the mean beside displaced bumps, in per cent: median / 95 % of the cases")
    print(report.table([column.strip("`") for column in columns], [list(map(str, line)) for line in cells]))
    for way, (count, list_) in worse.items():
        print(f"{way}: {len(list_)} of {count} groups more than {100 * WORSE:g} points worse than {OLD}")
    if options.results:
        results.write("bumps", results.surroundings("make compare"), columns, cells)
    print(f"All values: {options.output}")
    return 0


if __name__ == "__main__":
    report.run(main)
