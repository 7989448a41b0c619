# SPDX-License-Identifier: Apache-2.0
"""Choices of horizon against the truth: bumps as normals beside bumps really displaced.

build/horizon (compare/horizon.c) ray-casts two height fields, plate.py's sinusoid and a random
one of the same mean square slope, with shadows and hidden parts, and shades the same bumps as
normals on a flat square, once per choice of horizon. Light and eye stand at 80 to 5 degrees of
elevation. Materials: Ashikhmin-Shirley with exponents (200, 10), GGX with the matching alphas,
both carried by `rotate`, and Lambert. Two errors, over the mean of the truth:

  picture     mean absolute difference, point by point as the eye sees them. At low views most of
              it is parallax, which no choice mends
  brightness  of the patch as a whole, as it is seen from afar

Leaves in the output folder: horizon.csv (every pair of directions), errors.csv (the table),
chart.png (errors against elevation).
"""
import argparse
import csv
from pathlib import Path

import numpy as np

import programs
import report
import results
import truth
import whole

MATERIALS = {"ashikhmin_shirley": "Ashikhmin-Shirley", "ggx": "GGX", "lambert": "Lambert"}
MEASURES = ("picture", "brightness")
REGIONS = {
    "all": lambda light, view: True,
    "both above 30°": lambda light, view: light > 30 and view > 30,
    "light below 15°": lambda light, view: light < 15,
    "eye below 15°": lambda light, view: view < 15,
}
LOOKS = {"hard": ("black", "-"), "valid_reflection": ("#2a6f97", "-"), "estevez": ("#c8553d", "-"),
         "chiang": ("#e9a03b", "-"), "schuessler": ("#7a9e3f", "--"),
         "valid_estevez": ("#7b2d8b", "-")}


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=64, help="along a side (default 64)")
    parser.add_argument("--azimuths", type=int, default=5,
                        help="of light and eye, at each elevation (default 5)")
    parser.add_argument("--results", action="store_true", help="rewrite docs/results/, as make compare does")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "horizon",
                        help="folder for results (default build/compare/horizon)")
    return parser.parse_args(argv)


def measure(options):
    """One record a line of horizon.csv, its numbers as such."""
    path = options.output / "horizon.csv"
    report.step("Ray-casting displaced bumps",
                [str(programs.BUILD / "horizon"), str(path), str(options.points),
                 str(options.azimuths)], options.output / "horizon.log")
    with open(path, encoding="utf-8", newline="") as file:
        return [{key: text if key in ("field", "material", "horizon") else float(text)
                 for key, text in row.items()} for row in csv.DictReader(file)]


def errors(rows):
    """{measure: error} over some rows of one choice."""
    total = sum(row["truth"] for row in rows)
    return {
        "picture": sum(row["image"] for row in rows) / total,
        "brightness": sum(abs(row["mean"] - row["truth"]) for row in rows) / total,
    }


def choices(rows):
    return list(dict.fromkeys(row["horizon"] for row in rows))


def pick(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def summary(rows):
    """Lines (measure, material, region, {choice: error})."""
    lines = []
    for name in MEASURES:
        for material in MATERIALS:
            for region, inside in REGIONS.items():
                here = [row for row in pick(rows, material=material)
                        if inside(row["light"], row["view"])]
                lines.append((name, material, region, {
                    choice: errors(pick(here, horizon=choice))[name] for choice in choices(rows)}))
    return lines


def write_errors(lines, path):
    whole.write_csv(path, [["measure", "material", "region", *lines[0][3]],
                           *([name, material, region, *(f"{e:.4f}" for e in found.values())]
                             for name, material, region, found in lines)])


def write_chart(rows, path):
    """Rows of materials; columns: each measure against the light's elevation and the eye's."""
    columns = [(name, axis) for name in MEASURES for axis in ("light", "view")]
    figure, axes = truth.pyplot(path.parent).subplots(
        len(MATERIALS), len(columns), figsize=(13, 8), layout="constrained", sharex=True)
    elevations = sorted({row["light"] for row in rows})
    for line, (material, label) in zip(axes, MATERIALS.items()):
        here = pick(rows, material=material)
        for plot, (name, axis) in zip(line, columns):
            for choice in choices(rows):
                color, style = LOOKS[choice]
                found = [errors(pick(here, horizon=choice, **{axis: e}))[name]
                         for e in elevations]
                plot.plot(elevations, found, style, color=color, marker=".", label=choice)
            plot.set_xscale("log")
            plot.set_xticks(elevations, [f"{e:g}°" for e in elevations], fontsize=7)
            plot.minorticks_off()
            plot.set_ylim(bottom=0)
            plot.grid(alpha=0.3)
        line[0].set_ylabel(label)
    for plot, (name, _) in zip(axes[0], columns):
        plot.set_title(f"error of the {name}", fontsize=10)
    for plot, (_, axis) in zip(axes[-1], columns):
        plot.set_xlabel("elevation of the " + {"light": "light", "view": "eye"}[axis])
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    figure.suptitle("normal-mapped against displaced bumps, by choice of horizon", fontsize=12)
    with whole.place(path) as part:
        figure.savefig(part, dpi=110)


def main(argv=None):
    options = arguments(argv)
    options.output = options.output.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    rows = measure(options)
    lines = summary(rows)
    write_errors(lines, options.output / "errors.csv")
    write_chart(rows, options.output / "chart.png")
    print()
    print(report.table(
        ["error against displaced bumps", "region", *lines[0][3]],
        [[f"{name}: {MATERIALS[material]}", region, *(f"{e:.3f}" for e in found.values())]
         for name, material, region, found in lines]))
    if options.results:
        results.write("horizons", results.surroundings("make compare"), ["error of the", "of", "where", *(f"`{c}`" for c in lines[0][3])],
                      [[name, MATERIALS[material], region, *found.values()] for name, material, region, found in lines])
    once, twice = (np.sum([row[key] for row in pick(rows, horizon="hard")])
                   for key in ("truth", "truth_twice"))
    print(f"\nThe truth is light reflected once; a second reflection would add "
          f"{100 * (twice / once - 1):.1f} % to it.")
    print(f"Figures and chart: {options.output}")
    return 0


if __name__ == "__main__":
    report.run(main)
