# SPDX-License-Identifier: Apache-2.0
"""Two dumps of one scene, one verdict: do both renderers shade what they should, and the same?

Any two files that LIBSHADE_DUMP=FILE.exr left (docs/theory/conventions.md, "Dump"), of either renderer, of
two versions or of two machines, are judged:

  each against the C reference (`shade check`),
  one against the other: material, position, UV, normals, tangent, view, and each light's
  direction and irradiance, pixel by pixel,
  what was shaded of each light, in the mean.

POV-Ray's world is left-handed with y up, Blender's right-handed with z up: a dump whose header
names POV-Ray is brought into Blender's world first, unless --world says otherwise.

Each row says what was measured, the limit, and the pixel where it is worst (column, row from the
top). Exit status: 0 all within limits; 1 not, or bad input, or a program that failed; 2 bad usage.
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

import consistency
import dumps
import pictures
import programs
import report

SHADED_LIMIT = 0.02  # mean difference of S over its mean, worst channel, as of pictures
WORLDS = ("auto", "same", "mirrored")


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=Path, metavar="A.exr", help="a dump")
    parser.add_argument("second", type=Path, metavar="B.exr", help="another of the same scene")
    parser.add_argument("--world", choices=WORLDS, default="auto",
                        help="whether B's axes y and z trade places beside A's "
                             "(default auto: by the headers' `renderer`)")
    parser.add_argument("--all", action="store_true",
                        help="fail also when a material or a light has nothing to compare")
    parser.add_argument("--json", action="store_true", help="the verdict as JSON")
    parser.add_argument("--picture", type=Path, metavar="FILE.png",
                        help="write what A shaded, what B shaded and ten times the difference")
    return parser.parse_args(argv)


def renderer(dump):
    name = dump.header.get("renderer")
    return name if isinstance(name, str) and name else "unknown renderer"


def is_povray(dump):
    return renderer(dump).startswith("POV-Ray")


def against_reference(path, kind, every):
    """What `shade check` says of a dump, as its JSON; StepFailed if it cannot judge it."""
    largest, mean = consistency.CHECK_LIMITS[kind]
    command = [programs.SHADE, "check", "--json", "--tolerance", str(largest),
               "--mean-tolerance", str(mean), *(["--all"] if every else []), str(path)]
    try:
        # on a terminal it shows how far it is there, and what is wrong
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=None if sys.stderr.isatty() else subprocess.PIPE,
                              text=True, check=False)
    except OSError as error:
        raise report.StepFailed(f"{programs.SHADE}: {error.strerror}: run make, or name another "
                                "`shade` by SHADE in the environment") from error
    try:
        return json.loads(done.stdout)
    except ValueError as error:
        said = (done.stderr or "").strip() or f"`shade check` left with status {done.returncode}"
        raise report.StepFailed(said if str(path) in said else f"{path}: {said}") from error


def reference_rows(letter, path, dump, every):
    kind = "POV-Ray" if is_povray(dump) else "Blender"
    checked = against_reference(path, kind, every)
    rows, good = consistency.check_rows(letter, checked, every, consistency.CHECK_LIMITS[kind])
    if not good and all(row[3] != consistency.verdict(False) for row in rows):  # cloth from afar has no row of its own
        rows.append([f"{letter}: `shade check` does not pass it", "", "", consistency.verdict(False)])
    return rows, good


def check_pair(first, second, paths):
    """ValueError if the two cannot be of one scene."""
    for what, measure in (("pixels", lambda d: "{1} x {0}".format(*d.material.shape)),
                          ("lights", lambda d: str(len(d.lights)))):
        a, b = measure(first), measure(second)
        if a != b:
            raise ValueError(f"{paths[1]}: {b} {what}; expected {a}, as in {paths[0]}")
    for dump, path in zip((first, second), paths):
        if not dump.covered.any():
            raise ValueError(f"{path}: nothing is hit; expected a material.ID of 0 or more somewhere")
    if not (first.covered & second.covered).any():
        raise ValueError(f"{paths[1]}: it covers no pixel that {paths[0]} covers; "
                         "expected the same scene and camera")


def place(pixels, error):
    """Where an error is largest, as text; what is no number is the largest."""
    if not len(error):
        return ""
    row, column = pixels[np.argmax(np.where(np.isfinite(error), error, np.inf))]
    return f"({column}, {row})"


def pair_rows(a, b):
    """consistency.dump_rows with a place at the end of each."""
    rows, good = consistency.dump_rows(a, b)
    apart = np.argwhere(a.covered != b.covered)
    where = [f"({apart[0][1]}, {apart[0][0]})" if len(apart) else ""]
    where += [place(dumps.pixels_of(a, b, name), error) if error.max() > 0 or np.isnan(error).any()
              else "" for name, error in dumps.deviations(a, b).items()]
    return [[*row, spot] for row, spot in zip(rows, where)], good


def shaded_rows(a, b):
    """Of each light, S of one beside that of the other, where both hit."""
    rows, good = [], True
    both = a.covered & b.covered
    pixels = np.argwhere(both)
    for k, (la, lb) in enumerate(zip(a.lights, b.lights)):
        sa, sb = la["S"][both], lb["S"][both]
        name = f"light{k}.S, mean difference over mean"
        bad = ~(np.isfinite(sa) & np.isfinite(sb)).all(axis=-1)
        if bad.any():
            rows.append([f"light{k}.S not finite", f"{np.count_nonzero(bad)} times", "0",
                         consistency.verdict(False), place(pixels, np.where(bad, np.inf, 0.0))])
            good = False
            continue
        larger = np.maximum(sa.mean(axis=0), sb.mean(axis=0))
        if not larger.max() > 0.0:
            rows.append([name, "dark in both", "", "noted", ""])
            continue
        off = np.abs(sa - sb)
        worst = float(np.max(off.mean(axis=0) / np.maximum(larger, 0.1 * larger.mean())))
        ok = worst <= SHADED_LIMIT
        good &= ok
        rows.append([name, f"{100 * worst:.3f} %", f"{100 * SHADED_LIMIT:.0f} %",
                     consistency.verdict(ok), place(pixels, off.max(axis=-1)) if worst else ""])
    return rows, good


def shaded(dump):
    """Picture of all lights' S; what is not finite is black."""
    total = sum((light["S"] for light in dump.lights), np.zeros((*dump.material.shape, 3)))
    return np.where(np.isfinite(total), total, 0.0)


def write_picture(path, a, b):
    images = [shaded(dump) for dump in (a, b)]
    bright = np.percentile(images[0][a.covered], 99) or 1.0
    strip = [*images, 10.0 * np.abs(images[0] - images[1])]
    pictures.write_png(path, np.concatenate(strip, axis=1) / bright)


def judge(options):
    """(rows, whether all is within limits, the two dumps in one world)."""
    paths = (options.first, options.second)
    pair = [dumps.read(path) for path in paths]
    check_pair(*pair, paths)
    parts = []
    for letter, path, dump in zip("AB", paths, pair):
        rows, good = reference_rows(letter, path, dump, options.all)
        parts.append(([[*row, ""] for row in rows], good))
    mirrored = {"auto": is_povray(pair[0]) != is_povray(pair[1]), "same": False,
                "mirrored": True}[options.world]
    names = [renderer(dump) for dump in pair]
    if mirrored:
        pair[1] = dumps.swap_handedness(pair[1])
    parts += [pair_rows(*pair), shaded_rows(*pair)]
    head = [[f"{letter}: {name}", "", "", "", ""] for letter, name in zip("AB", names)]
    rows = head + [row for rows, _ in parts for row in rows]
    return rows, all(good for _, good in parts), pair


def main(argv=None):
    options = arguments(argv)
    rows, good, pair = judge(options)
    missed = [row[0] for row in rows if row[3] == consistency.verdict(False)]
    if options.picture:
        write_picture(options.picture, *pair)
    if options.json:
        keys = ("what", "measured", "limit", "verdict", "worst")
        print(json.dumps({"agree": good, "missed": missed,
                          "rows": [dict(zip(keys, row)) for row in rows if row[1] or row[3]]}, indent=1))
        return 0 if good else 1
    print(report.table([f"A {options.first.name}, B {options.second.name}", "measured", "limit", "",
                        "worst at"], rows))
    print("\nVerdict: " + ("both agree with the reference and with each other." if good else
                           f"NOT within limits: {'; '.join(missed)}."))
    return 0 if good else 1


if __name__ == "__main__":
    report.run(main)
