# SPDX-License-Identifier: Apache-2.0
"""Materials of the kinds that public libraries hold: does our engine show what Cycles of the same Blender shows?

materials_list.py builds them by stock nodes. Each is shown on a ball and a box, or on hair, as real_files.py shows materials
of files and by its judgement: every other one in Blender 3.4, the rest in PyPI's bpy, or all in --blender. Pictures, and
results.csv with the warnings that our engine gave, are in --output; a second run renders what is new. Exit status 1
where less than --share of them are within --limit. With --results all are shown with grooves that follow bumps, too, and
docs/results/materials.txt keeps what is found.
"""
import argparse
import hashlib
import inspect
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import materials_list
import programs
import real_files
import report
import results as kept
import whole

VERSIONS = ("3.4", "5.0")


def arguments(argv=None):
    defaults = real_files.arguments([])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--filter", default="", metavar="WORDS", help="only those whose name or Blender match this pattern")
    parser.add_argument("--blender", choices=VERSIONS, help="all in this one (default turn by turn)")
    parser.add_argument("--grooves", action="store_true", help="with *Grooves Follow Bumps*, as our engine comes (default off, as Cycles)")
    parser.add_argument("--results", action="store_true", help="keep all in docs/results/materials.txt")
    parser.add_argument("--list", action="store_true", help="show which, render nothing")
    parser.add_argument("--size", type=int, default=96, help="pixels along the longer side (default 96)")
    parser.add_argument("--noise", type=float, default=0.015, help="two seeds of an engine are to agree within this (default .015)")
    parser.add_argument("--share", type=float, default=57 / 61, help="of the materials that are to be good (default 57 of 61)")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "materials",
                        help="folder for pictures and results (default build/compare/materials)")
    return parser.parse_args(argv, argparse.Namespace(**{name: getattr(defaults, name) for name in (
        "cap", "seconds", "timeout", "threads", "limit")}))


def listed(options):
    """As rows of real_files.csv; `version` is that of the material's own lines."""
    rows = []
    for path, builders in (("", materials_list.BUILDERS), (real_files.STRANDS, materials_list.STRANDS)):
        for number, (name, build) in enumerate(builders.items()):
            lines = hashlib.sha256(inspect.getsource(build).encode()).hexdigest()[:12]
            blender = options.blender or VERSIONS[number % 2]
            if path:  # 3.4's Python makes no such curves
                blender = "5.0"
            rows.append({"source": "made", "package": "materials", "version": lines, "path": path, "material": name, "blender": blender})
    return [row for row in rows if re.search(options.filter, real_files.name_of(row))]


def file_of(version, output):
    """All materials in one file, made anew."""
    path = output / f"materials-{version}.blend"
    script = [str(programs.HERE / "materials_make.py"), "--", str(path)]
    command = ([programs.BLENDER, "-b", "--factory-startup", "--python-exit-code", "9", "-P", *script] if version == "3.4"
               else [str(real_files.BPY), *script])
    path.unlink(missing_ok=True)
    made = subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL,
                          env={name: value for name, value in os.environ.items() if not name.startswith("PYTHON")})
    if not path.exists():
        raise report.StepFailed(f"{path}: not made\n{made.stdout[-2000:]}{made.stderr[-2000:]}")
    return str(path)


def shown(rows, files, options):
    """Rows of results, as far as they are."""
    results = []
    for number, row in enumerate(rows, 1):
        start = time.perf_counter()
        results.append(real_files.both(row, options, files[row["blender"]]))
        last = results[-1]
        print(f"{number}/{len(rows)} {real_files.name_of(row)}: {last['difference'] if last['state'] == 'rendered' else last['state']} "
              f"({time.perf_counter() - start:.1f} s)", file=sys.stderr, flush=True)
        whole.write_csv(options.output / "results.csv", results)
    return results


def keep(found, options):
    """docs/results/materials.txt; found: {with grooves: results}"""
    rows = []
    for what, path in (("ball and box", ""), ("hair", real_files.STRANDS)):
        for grooves, results in found.items():
            for version in VERSIONS:
                of = [r for r in results if (r["path"], r["blender"]) == (path, version)]
                if not of:
                    continue
                rows.append([what, version, "on" if grooves else "off", *real_files.summary(of, options.limit)])
    kept.write("materials", kept.surroundings('make compare-materials MATERIALS=--results'),
               ["shown on", "Blender", "*Grooves Follow Bumps*", "judged", f"within {options.limit:g}", "median", "worst"], rows)


def main(argv=None):
    options = arguments(argv)
    options.output = options.output.resolve()
    rows = listed(options)
    if options.list or not rows:
        print("\n".join(map(real_files.name_of, rows)) or "none matches")
        return 0 if rows else 1
    real_files.missing(options, rows)
    files, found = {version: file_of(version, options.output) for version in sorted({row["blender"] for row in rows})}, {}
    for grooves in (False, True) if options.results else (options.grooves,):
        options.grooves = grooves
        found[grooves] = shown(rows, files, options)
    if options.results:
        keep(found, options)
    return 0 if real_files.verdict([r for results in found.values() for r in results], options) else 1


if __name__ == "__main__":
    report.run(main)
