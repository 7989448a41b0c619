# SPDX-License-Identifier: Apache-2.0
"""Files that nobody here made: does our engine show what Cycles of the same Blender shows?

real_files.csv lists scenes in packages of Debian and PyPI, each by package, version and path; apt and
pip fetch them into build/. What is no .blend is imported (glTF, OBJ, FBX, Collada, X3D, PLY, STL, USD).
Each is rendered with default bounces and small, grooves left behind by bumps as in Cycles, by both
engines of Blender 3.4 (the system's) or, newer files, glTF and USD, 5.0 (PyPI's bpy), with samples raised until two seeds agree within --noise. A camera that frames the scene, and a
sun and a grey world, are added, the same for both, where the file has none or nothing is seen.

The difference is the mean absolute difference over the mean, of 4 x 4 means. Pictures, and results.csv
with the warnings that our engine gave, are in --output; a second run renders what is new: all of ours
after a new `make blender`, Cycles' never again. Not judged, but counted, is what Blender cannot open or
package, where nothing is seen, and where Cycles' seeds differ by half of --limit even so. Exit status 1
where less than --share of the others are within --limit, or there are no others.
"""
import argparse
import csv
import hashlib
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import paths
import pictures
import programs
import real_files_fetch
import report
import results as kept
import whole

LIST = programs.HERE / "real_files.csv"
BPY = programs.BUILD / "venv-bpy/bin/python"
ZIP = programs.BUILD / "libshade-blender.zip"
UNJUDGED = ("CYCLES", "nothing", "noise", "package")  # states that begin so
EMPTY = dict.fromkeys(("difference", "brightness", "noise_cycles", "noise_libshade", "samples_cycles",
                       "samples_libshade", "seconds_cycles", "seconds_libshade", "added", "state", "warnings"), "")
STRANDS = "hair curves"  # the path of a material that is shown on hair
SETUP = 1  # of real_files_render.py: raised when a change there changes pictures


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--filter", default="", metavar="WORDS",
                        help="only those whose package, path, material or Blender match this pattern")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="only each Nth of those (default 1)")
    parser.add_argument("--count", type=int, default=0, help="at most so many (default all)")
    parser.add_argument("--list", action="store_true", help="show which, render nothing")
    parser.add_argument("--size", type=int, default=128, help="pixels along the longer side (default 128)")
    parser.add_argument("--noise", type=float, default=0.01,
                        help="two seeds of an engine are to agree within this (default .01)")
    parser.add_argument("--cap", type=int, default=4096, help="samples at most (default 4096)")
    parser.add_argument("--seconds", type=float, default=30.0, help="of one picture, at most (default 30)")
    parser.add_argument("--timeout", type=float, default=240.0,
                        help="seconds for all an engine does with one file (default 240)")
    parser.add_argument("--threads", type=int, default=0, help="of a render (default all)")
    parser.add_argument("--limit", type=float, default=0.05, help="difference that is good (default .05)")
    parser.add_argument("--share", type=float, default=0.9, help="of the files that are to be good (default .9)")
    parser.add_argument("--results", action="store_true", help="keep what is found in docs/results/files.txt")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "files",
                        help="folder for packages, pictures, results (default build/compare/files)")
    return parser.parse_args(argv)


def listed(pattern=""):
    with open(LIST, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return [row for row in rows if re.search(pattern, name_of(row))]


def name_of(row):
    """package: path or material, Blender's version"""
    return f"{row['package']}: {row['material'] or row['path']}, {row['blender']}"


def key_of(row, options):
    asked = [SETUP, row, options.size, options.noise, options.cap, options.seconds]
    return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()[:16]


def command_of(version, job):
    script = [str(programs.HERE / "real_files_render.py"), "--", str(job)]
    if version == "3.4":
        return [programs.BLENDER, "-b", "--factory-startup", "--python-exit-code", "9", "-P", *script]
    return [str(BPY), *script]


def rendered(row, engine, stem, added, file, options):
    """What real_files_render.py told, and the words of our engine; {"failed": why} where it did not."""
    told = stem.with_suffix(".json")
    if told.exists() and "words" in (before := json.loads(told.read_text(encoding="utf-8"))):  # else a run was stopped in between
        return before
    job = {"file": file, "material": row["material"], "engine": engine, "size": options.size,
           "noise": options.noise, "cap": options.cap, "seconds": options.seconds,
           "threads": options.threads, "added": added, "output": str(stem),
           "grooves": getattr(options, "grooves", False), "strands": row["path"] == STRANDS}
    work, log = stem.with_suffix(".job"), stem.with_suffix(".log")
    whole.write_text(work, json.dumps(job))
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith(("LIBSHADE_", "BLENDER_", "PYTHON"))}
    environment.update(programs.ADD_ON, BLENDER_USER_CONFIG=str(options.output / "config"))
    try:
        with open(log, "wb") as words:
            status = subprocess.run(command_of(row["blender"], work), stdout=words, stderr=words,
                                    stdin=subprocess.DEVNULL, env=environment, check=False,
                                    timeout=options.timeout).returncode
        why = None if told.exists() else f"{engine}: exit status {status}, see {log.name}"
    except subprocess.TimeoutExpired:
        why = f"{engine}: more than {options.timeout:g} s"
    words = re.findall(r"^(?:Warning|Error): libshade: (.*)$", log.read_text(errors="replace"), re.M)
    result = {**(json.loads(told.read_text(encoding="utf-8")) if not why else {"failed": why}),
              "words": list(dict.fromkeys(words))}
    whole.write_text(told, json.dumps(result))
    return result


def both(row, options, file):
    """A row of results."""
    key = key_of(row, options)
    cycles = options.output / "cycles" / key
    native = hashlib.sha256(ZIP.read_bytes()).hexdigest()[:12]
    ours = options.output / f"libshade-{native}" / (key + "-grooves" * getattr(options, "grooves", False))
    for stem in (cycles, ours):
        stem.parent.mkdir(parents=True, exist_ok=True)
    theirs = rendered(row, "CYCLES", cycles, None, file, options)
    result = {**row, **EMPTY}
    if "failed" in theirs:
        return {**result, "state": theirs["failed"]}
    our = rendered(row, "LIBSHADE", ours, theirs["added"], file, options)
    result.update(warnings="; ".join(our["words"]), added=" ".join(theirs["added"]))
    for name, told in (("cycles", theirs), ("libshade", our)):
        if "failed" not in told:
            result.update({f"noise_{name}": round(told["noise"], 4), f"samples_{name}": told["samples"],
                           f"seconds_{name}": round(told["seconds"], 2)})
    if "failed" in our:
        return {**result, "state": our["failed"]}
    pair = [np.mean([pictures.read(f"{stem}_{seed}.exr") for seed in (1, 2)], 0) for stem in (ours, cycles)]
    show(options.output / "pictures" / f"{key}.png", *pair)
    if not np.isfinite(pair).all():
        return {**result, "state": "values that are not finite"}
    our_blocks, their_blocks = map(paths.blocks, pair)
    mean = their_blocks.mean()
    if mean < 1e-6:
        return {**result, "state": "nothing to see in Cycles"}
    noisy = theirs["noise"] > options.limit / 2
    return {**result, "difference": round(float(abs(our_blocks - their_blocks).mean() / mean), 4),
            "brightness": round(float(our_blocks.mean() / mean), 4),
            "state": "noise of Cycles" if noisy else "rendered"}


def show(path, ours, cycles):
    """Cycles, ours, and four times what ours has more (red) or less (blue)."""
    path.parent.mkdir(exist_ok=True)
    scale = 1 / max(np.nan_to_num(np.quantile(cycles, 0.98)), 1e-6)
    more = 4 * (ours - cycles).mean(-1) * scale
    signed = np.stack([more, 0 * more, -more], -1)
    pictures.write_png(path, np.nan_to_num(np.concatenate([cycles * scale, ours * scale, signed], 1)))


def missing(options, rows):
    """What has to be there first."""
    if not ZIP.exists():
        raise report.StepFailed(f"{ZIP}: not there; make blender makes it")
    if any(row["blender"] == "3.4" for row in rows) and not shutil.which(programs.BLENDER):
        raise report.StepFailed(f"{programs.BLENDER}: no such program; BLENDER may name it")
    if any(row["blender"] != "3.4" for row in rows) and not BPY.exists():
        raise report.StepFailed(f"{BPY}: not there; make compare-files makes it")
    options.output.mkdir(parents=True, exist_ok=True)


def split(results, limit):
    """(those that are judged, those of them that are good)"""
    judged = [r for r in results if not r["state"].startswith(UNJUDGED)]
    return judged, [r for r in judged if r["state"] == "rendered" and r["difference"] <= limit]


def summary(results, limit, worst=5):
    """A row of a kept table: how many are judged, how many are good, the median, the worst by their names."""
    judged, good = split(results, limit)
    off = sorted((r for r in judged if r["state"] == "rendered"), key=lambda r: -r["difference"])
    last = lambda r: r["material"] or r["path"].rpartition("/")[2]  # noqa: E731
    return [len(judged), len(good), statistics.median(r["difference"] for r in off) if off else None,
            ", ".join(f"{last(r)} {r['difference']:.3g}" for r in off[:worst])]


def verdict(results, options):
    """Prints all that is not good, then the sum; is it enough?"""
    judged, good = split(results, options.limit)
    bad = sorted((r for r in judged if r not in good), key=lambda r: -(r["difference"] or 9))
    if bad:
        print(report.table(["beyond the limit", "difference", "brightness", "noise, Cycles and ours"],
                           [[name_of(r), str(r["difference"]) or "-", str(r["brightness"]),
                             f"{r['noise_cycles']} {r['noise_libshade']}"] for r in bad]))
    for r in bad:
        print(f"\n{name_of(r)}: {r['state']}; warnings: {r['warnings'] or 'none'}")
    for r in results:
        if r not in judged:
            print(f"\n{name_of(r)}: not judged: {r['state']}")
    named = sum(bool(r["warnings"]) for r in bad)
    print(f"\n{len(good)} of {len(judged)} within {options.limit} ({100 * len(good) / max(len(judged), 1):.1f} %); "
          f"of the other {len(bad)} {named} with a warning; {len(results) - len(judged)} not judged")
    return bool(judged) and len(good) >= options.share * len(judged)


def main(argv=None):
    options = arguments(argv)
    options.output = options.output.resolve()
    rows = listed(options.filter)[::max(options.every, 1)][:options.count or None]
    if options.list or not rows:
        print("\n".join(map(name_of, rows)) or "none matches")
        return 0 if rows else 1
    missing(options, rows)
    results, failed = [], {}
    for number, row in enumerate(rows, 1):
        start, place = time.perf_counter(), (row["source"], row["package"], row["version"])
        try:
            if place in failed:
                raise report.StepFailed(failed[place])
            root = real_files_fetch.root_of(*place, options.output)
            results.append(both(row, options, real_files_fetch.path_of(root, row["path"])))
        except report.StepFailed as error:
            failed[place] = str(error).splitlines()[0]
            results.append({**row, **EMPTY, "state": "package: " + failed[place]})
        except (OSError, ValueError) as error:
            results.append({**row, **EMPTY, "state": str(error)})
        last = results[-1]
        print(f"{number}/{len(rows)} {name_of(row)}: "
              f"{last['difference'] if last['state'] == 'rendered' else last['state']} "
              f"({time.perf_counter() - start:.1f} s)", file=sys.stderr, flush=True)
        whole.write_csv(options.output / "results.csv", results)
    if options.results:
        keep(results, options)
    return 0 if verdict(results, options) else 1


def keep(results, options):
    """docs/results/files.txt"""
    usual = vars(arguments([]))
    asked = [f"--{word} {value}" for word, value in vars(options).items()
             if word not in ("results", "list", "threads", "timeout", "share", "output") and value != usual[word]]
    kept.write("files", kept.surroundings(f'make compare-files FILES="{" ".join([*asked, "--results"])}"'),
               ["Blender", "of the list", "judged", f"within {options.limit:g}", "median", "worst"],
               [[version, len(of), *summary(of, options.limit)]
                for version in sorted({r["blender"] for r in results}) if (of := [r for r in results if r["blender"] == version])])


if __name__ == "__main__":
    report.run(main)
