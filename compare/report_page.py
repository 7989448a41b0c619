# SPDX-License-Identifier: Apache-2.0
"""The report: build/compare/report.html and the CSV files beside it, from the studies of study_*.py.

What a study measures is done in pieces, and the rows of each are kept as soon as it is done: after
Ctrl-C, or when one thing has changed, a second run does only what is missing. The time that the rest
takes is said beforehand. A page is written only if every sentence of its findings holds for the rows of
that run; else the sentences that do not are printed, and the exit status is 1.

--quick takes two minutes on two idle cores and writes build/compare/quick/report.html.

--engine slurm has the pieces done by the nodes of a Slurm cluster that share this folder (docs/start/farm.md), but for those of
studies that measure times, which run here and alone.
"""
import argparse
import ast
import csv
import hashlib
import importlib
import json
import numbers
import re
import subprocess
import sys
import time
from pathlib import Path

import answers
import page
import programs
import report
import results
import whole

ORDER = ("speed", "precision", "horizons", "diffuse", "lobes", "cloth", "frames", "atlas", "truth",
         "consistency", "peers")  # on the page; others follow
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
KEY = re.compile(r"[A-Za-z0-9_-]+")


def known():
    """{name: module} of the studies that are there, in the page's order."""
    modules = [importlib.import_module(path.stem) for path in sorted(programs.HERE.glob("study_*.py"))]
    rank = {name: place for place, name in enumerate(ORDER)}
    modules.sort(key=lambda m: rank.get(m.NAME, len(ORDER)))
    return {module.NAME: module for module in modules}


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="the two minutes' report")
    parser.add_argument("--only", action="append", metavar="STUDY",
                        help="this study alone, or these")
    parser.add_argument("--again", action="store_true", help="do what is done already again")
    parser.add_argument("--plan", action="store_true",
                        help="say what would be done and how long it takes, no more")
    parser.add_argument("--results", action="store_true", help="rewrite docs/results/, as make compare does")
    parser.add_argument("--output", type=Path,
                        help="folder of report.html and data/ (default build/compare, or "
                             "build/compare/quick)")
    parser.add_argument("--engine", choices=("slurm", "local"), help="have libshade-farm do the pieces")
    parser.add_argument("--piece", metavar="STUDY/KEY", help=argparse.SUPPRESS)  # of --engine: this one alone, of that stamp
    parser.add_argument("--stamp", help=argparse.SUPPRESS)
    options = parser.parse_args(argv)
    if options.quick and options.results:
        parser.error("--results: the quick report is too rough for docs/results/")
    options.studies = known()
    for name in options.only or ():
        if name not in options.studies:
            parser.error(f"--only {name}: no such study; there are {', '.join(options.studies)}")
    if options.only:
        options.studies = {name: module for name, module in options.studies.items()
                           if name in options.only}
    if options.output is None:
        options.output = programs.BUILD / "compare" / ("quick" if options.quick else "")
    options.output = options.output.resolve()
    if options.output.exists() and not options.output.is_dir():
        parser.error(f"--output {options.output}: no folder")
    return options


# ---- what rows depend on ----------------------------------------------------------------------


APART = ("atlas",)  # studies with a page of their own
DRAW = ("page", "answers", "style", "study", "report", "results", "report_page", "atlas_charts", "detail_speed_page")  # no rows


def sources(path, found=None):
    """A script and those beside it that it imports, but for what only draws the page."""
    found = {} if found is None else found
    if path in found or path.stem in DRAW:
        return found
    found[path] = path.read_bytes()
    for node in ast.walk(ast.parse(found[path])):
        names = ([alias.name for alias in node.names] if isinstance(node, ast.Import)
                 else [node.module] if isinstance(node, ast.ImportFrom) and node.module else [])
        for name in names:
            beside = path.with_name(name.split(".")[0] + ".py")
            if beside.is_file():
                sources(beside, found)
    return found


def stamp(module, task, quick, head):
    """A word that changes with whatever the rows of a task depend on."""
    digest = hashlib.sha256(repr((module.NAME, task.key, quick, head["machine"])).encode())
    for path, text in sorted(sources(Path(module.__file__)).items()):
        digest.update(path.name.encode() + text)
    library = sorted(programs.BUILD.glob("libshade.so.*"))
    for path in (Path(programs.SHADE), *library, *map(Path, task.needs)):
        digest.update(path.read_bytes() if path.is_file() else b"absent")
    return digest.hexdigest()[:24]


# ---- rows in files ----------------------------------------------------------------------------


def plain(value, where):
    if isinstance(value, str):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real) and abs(float(value)) < float("inf"):
        return float(value)
    raise ValueError(f"{where}: {value!r}: expected a text or a finite number")


def write_rows(path, rows, head):
    """Dictionaries as CSV, with lines `# word: text` before it; a column that a row lacks is empty."""
    rows = [{key: plain(value, f"{path.name}, column {key}") for key, value in row.items()}
            for row in rows]
    columns = list(dict.fromkeys(key for row in rows for key in row))
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole.place(path) as part, open(part, "w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {word}: {text}\n" for word, text in head.items())
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: repr(v) if isinstance(v, float) else v for key, v in row.items()}
                         for row in rows)


def number(text):
    if not NUMBER.fullmatch(text):
        return text
    return int(text) if text.lstrip("+-").isdigit() else float(text)


def read_rows(path):
    """(rows, head) of such a file."""
    with open(path, newline="", encoding="utf-8") as file:
        lines = file.readlines()
    count = next((k for k, line in enumerate(lines) if not line.startswith("# ")), len(lines))
    head = dict(line[2:].rstrip("\n").split(": ", 1) for line in lines[:count])
    table = csv.DictReader(lines[count:])
    return [{key: number(text) for key, text in row.items() if text not in ("", None)}
            for row in table], head


# ---- the run ----------------------------------------------------------------------------------


def duration(seconds):
    if seconds < 90:
        return f"{max(seconds, 1):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def plan(options, head):
    """[(module, task, file, stamp, done)] of all tasks."""
    pieces = []
    for module in options.studies.values():
        seen = set()
        for task in module.tasks(options.quick):
            if not KEY.fullmatch(task.key) or task.key in seen:
                raise ValueError(f"{module.__file__}: task '{task.key}': expected letters, digits, "
                                 "- and _, and no key twice")
            seen.add(task.key)
            file = options.output / "data" / module.NAME / f"{task.key}.csv"
            mark = stamp(module, task, options.quick, head)
            done = not options.again and file.is_file() and read_rows(file)[1].get("stamp") == mark
            pieces.append((module, task, file, mark, done))
    return pieces


def say_plan(pieces):
    left = [task.seconds for _module, task, _file, _mark, done in pieces if not done]
    done = f", {len(pieces) - len(left)} of them done before" if len(left) < len(pieces) else ""
    print(f"{len(pieces)} pieces{done}; about {duration(sum(left))} on two idle cores"
          if left else f"{len(pieces)} pieces, all of them done before", flush=True)


FARMED = ("atlas", "truth", "consistency")  # studies that measure no times


def do(module, task, file, mark, head, say):
    """One piece: its file appears once all of it is done."""
    folder = file.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    rows = task.run(folder, say)
    if not rows:
        raise ValueError(f"study {module.NAME}, {task.key}: no rows")
    write_rows(file, rows, {**head, "command": task.command or head["command"], "stamp": mark})
    if not any(folder.iterdir()):
        folder.rmdir()


def farm(options, pieces):
    """What is missing, by items of libshade-farm."""
    todo = [piece for piece in pieces if not piece[-1] and piece[0].NAME in FARMED]
    if not todo:
        return
    words = [sys.executable, str(Path(__file__).resolve()), *(["--quick"] if options.quick else []), "--output", str(options.output)]
    items = [{"name": f"{module.NAME}: {task.key}", "words": [*words, "--piece", f"{module.NAME}/{task.key}", "--stamp", mark]}
             for module, task, _file, mark, _done in todo]
    number = 1 + max((int(path.suffix[1:]) for path in options.output.glob("farm.*") if path.suffix[1:].isdigit()), default=0)
    folder = options.output / f"farm.{number}"
    listed = options.output / f"report-{number}.items"
    whole.write_text(listed, json.dumps({"folder": str(programs.ROOT), "inputs": [], "items": items}, indent=1))
    command = ["/usr/bin/python3", str(programs.ROOT / "farm")]
    if subprocess.run([*command, "submit", str(listed), "-o", str(folder), "--engine", options.engine]).returncode not in (0, 1):
        raise KeyboardInterrupt
    live = report.Progress(f"{len(todo)} pieces by {options.engine}")
    while not (folder / "finished.json").exists():
        if not (folder / "job.json").exists():
            raise ValueError("the pieces were not submitted")
        time.sleep(0.5)
        live.read(f"{100 * len(list((folder / 'results').iterdir())) // len(todo)} %")
    wrong = json.loads((folder / "finished.json").read_text(encoding="utf-8"))["wrong"]
    live.done("failed" if wrong else None)
    if wrong:
        raise ValueError("\n  ".join([f"pieces failed; go on with: {' '.join(command)} resume {folder}", *wrong]))


def work(pieces, head):
    """Do what is missing."""
    todo = [piece for piece in pieces if not piece[-1]]
    remaining = sum(piece[1].seconds for piece in todo)
    for place, (module, task, file, mark, _done) in enumerate(todo):
        progress = report.Progress(f"[{place + 1}/{len(todo)}, {duration(remaining)} left] "
                                   f"{module.NAME}: {task.key}")

        def say(text, live=progress):
            if live.live:
                live.show(text)

        try:
            do(module, task, file, mark, head, say)
        except BaseException:
            progress.done("failed")
            raise
        progress.done()
        remaining -= task.seconds


def sift(findings, quick):
    """(those that are to stand on the page, how many are left out). A quick run may be too noisy to
    tell times apart: what such a sentence says is then not said, and none of the others may fail."""
    told = [finding for finding in findings if finding.holds or not (quick and finding.timed)]
    return told, len(findings) - len(told)


def gather(options, pieces, head):
    """[page.Section]; writes each study's CSV. ValueError where a finding does not hold."""
    sections, wrong = [], []
    for name, module in options.studies.items():
        rows, commands = [], {}
        if not any(piece[0] is module for piece in pieces):
            continue  # a study of the full report alone
        for of, task, file, _mark, _done in pieces:
            if of is module:
                rows += read_rows(file)[0]
                if task.command:
                    commands.setdefault(task.command, []).append(task.key)
        write_rows(options.output / "data" / f"{name}.csv", rows, head)
        told, left = sift(module.findings(rows), options.quick)
        wrong += [f"study {name}: does not hold for data/{name}.csv: \"{finding.text}\""
                  for finding in told if not finding.holds]
        sections.append(page.Section(name, module.TITLE, module.INTRO, told, module.figures(rows),
                                     module.tables(rows), commands, len(rows), left, *answers.of(name, rows), name in APART))
    if wrong:
        raise ValueError("no page, since findings do not hold:\n  " + "\n  ".join(wrong))
    return sections


def main(argv=None):
    options = arguments(argv)
    head = results.surroundings(f"make {'compare-quick' if options.quick else 'compare'}")
    pieces = plan(options, head)
    if options.piece:
        of = [piece for piece in pieces if f"{piece[0].NAME}/{piece[1].key}" == options.piece]
        if not of:
            raise ValueError(f"--piece {options.piece}: no such piece")
        do(*of[0][:3], options.stamp or of[0][3], head, lambda text: print(text, flush=True))
        return 0
    say_plan(pieces)
    if options.plan:
        return 0
    if not Path(programs.SHADE).is_file():
        raise ValueError(f"{programs.SHADE}: no such file; run make")
    options.output.mkdir(parents=True, exist_ok=True)
    if options.engine:
        farm(options, pieces)
        options.again = False
        pieces = plan(options, head)
    work(pieces, head)
    sections = gather(options, pieces, head)
    left = sum(section.left for section in sections)
    if left:
        print(page.left_out(left), file=sys.stderr)
    target = options.output / "report.html"
    whole.write_text(target, page.html(sections, head, options.quick))
    for section in sections:
        if section.apart:
            whole.write_text(options.output / f"{section.name}.html", page.html([section], head, options.quick, alone=True))
    for section in sections if options.results else ():
        results.write_tables(section.name, section.tables, head)
    print(f"The report: {target}")
    return 0


if __name__ == "__main__":
    report.run(main)
