#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The committed results: tables in docs/results/, and README.md's table, which is made from them.

`make compare` and `make bench` rewrite them; `make manual` only reads them.

    results.py bench build/bench.csv    what `make bench` left
    results.py readme                   README.md's table alone
"""
import argparse
import csv
import datetime
import os
import platform
import re
import subprocess
from pathlib import Path

import programs
import report
import whole

FOLDER = programs.ROOT / "docs" / "results"
README = programs.ROOT / "README.md"
BEGIN, END = "<!-- results: `make compare` and `make bench` write what follows -->", "<!-- end of results -->"
CYCLES = "Cycles' normal map"
LICENCE = "<!-- SPDX-" "License-Identifier: Apache-2.0 -->"  # in two, or it would be this file's own
HEAD = ("date", "machine", "compiler", "commit", "command")
# the tables of the report that are kept: {study: id of its table}
KEPT = {"speed": "errors", "precision": "numbers", "diffuse": "numbers", "lobes": "numbers", "cloth": "numbers",
        "consistency": "matrix"}


def first_line(command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=programs.ROOT)
    except OSError:
        return ""
    return done.stdout.splitlines()[0].strip() if done.returncode == 0 and done.stdout else ""


def surroundings(command):
    """What the head of each CSV, of each table here and of the report says: {word: text}."""
    cpu = Path("/proc/cpuinfo")
    said = cpu.read_text(encoding="utf-8") if cpu.exists() else ""
    model = re.search(r"model name\s*:\s*(.*)", said)
    family, number = (re.search(rf"{word}\s*:\s*(\d+)", said) for word in ("cpu family", "model"))
    commit = first_line(["git", "rev-parse", "--short=12", "HEAD"]) or "unknown"
    if first_line(["git", "status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs/results", ":!README.md"]):
        commit += ", changed"
    isa = re.search(r"\((.*?)\)|\b(avx512|avx2|sse2|scalar)\b", first_line([programs.SHADE, "--version"]))
    return {
        "machine": f"{model[1] if model else platform.processor() or platform.machine()}, "
                   + (f"family {family[1]} model {number[1]}, " if family and number else "")
                   + f"{os.cpu_count()} cores" + (f", {isa[0].strip('()')}" if isa else ""),
        "compiler": first_line([os.environ.get("CC", "cc"), "--version"]) or "unknown",
        "commit": commit,
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "command": command,
    }


# ---- the tables ----------------------------------------------------------------------------------


def cell(value):
    if value is None:
        return ""
    return str(value).replace("|", "\\|") if isinstance(value, (str, int)) else report.number(float(value))


def line(cells):
    return "| " + " | ".join(cells) + " |"


def markdown(columns, rows):
    return "\n".join([line(columns), "|" + "---|" * len(columns), *(line(map(cell, row)) for row in rows)])


def write(name, head, columns, rows):
    """docs/results/NAME.txt, and README.md's table after it."""
    said = "\n".join(f"- {word.capitalize()}: {f'`{head[word]}`' if word == 'command' else head[word]}" for word in HEAD)
    whole.write_text(FOLDER / f"{name}.txt", f"{LICENCE}\n{said}\n\n{markdown(columns, rows)}\n")
    write_readme()


def read(name):
    """(head, rows) of such a table; a row is {column: text}."""
    lines = (FOLDER / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    head = {word.lower(): text.strip("`") for word, text in re.findall(r"^- (\w+): (.*)$", "\n".join(lines), re.M)}
    cells = [[text.strip() for text in re.split(r"(?<!\\)\|", one.strip()[1:-1])] for one in lines if one.startswith("|")]
    return head, [dict(zip(cells[0], row)) for row in cells[2:]]


def write_tables(name, tables, head):
    """The table of a study of the report that is kept, if it has rows."""
    for table in tables:
        if KEPT.get(name) == table.id and table.rows:
            write(name, head, table.columns, table.rows)


def bench(path):
    """docs/results/bench.txt: of `shade bench --output PATH`, what is in cache, a column for each distribution."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["set"] == "cache" and row["distribution"]]
    distributions = list(dict.fromkeys(row["distribution"] for row in rows))
    found = {}
    for row in rows:
        found.setdefault((row["what"], row["method"], row["precision"]), {})[row["distribution"]] = row
    lines = [[f"`{what}`", f"`{method}`", precision, *(float(of[d]["ns"]) if d in of else None for d in distributions),
              max((float(row["max_error"]) for row in of.values() if row["max_error"]), default=None)]
             for (what, method, precision), of in found.items()]
    write("bench", surroundings("make bench"),
          ["what", "method", "precision", *(f"{d.replace('_', ' ')}, ns" for d in distributions), "worst error"], lines)


# ---- README.md's ---------------------------------------------------------------------------------


def where(name, **wanted):
    """The one row of a table with these cells."""
    found = [row for row in read(name)[1] if all(row[column] == text for column, text in wanted.items())]
    if len(found) != 1:
        raise ValueError(f"docs/results/{name}.txt: {len(found)} rows with {wanted}: expected one")
    return found[0]


def share(text):
    """An error over the mean, in per cent; nothing but rounding is 0."""
    return "0 %" if "·10⁻" in text else f"{report.number(100 * float(text))} %"


def readme():
    """README.md's table: six results, from the tables of docs/results/."""
    speed = {name: where("speed", distribution="Ashikhmin-Shirley", method=name) for name in ("rotate", "Gram-Schmidt", "perturb")}
    plain = where("speed", distribution="Ashikhmin-Shirley", method="rotate, plain C")
    plate = {name: where("displaced-waves", method=name)["error"] for name in ("rotate", CYCLES)}
    paths = {(scene, engine): float(where("paths", scene=scene, renderer=engine)["seconds to a relMSE of .001"])
             for scene in ("studio", "room") for engine in ("Cycles", "libshade")}
    cloth = [row for row in read("cloth")[1] if row["form"] == "far"]
    agreed = where("consistency", scene="suzanne", variant="as it is")
    return markdown(["what", "measured"], [
        ["A brushed highlight, the normal tilted by 30°, beside that of a surface with that slope: how much of it is elsewhere",
         f"`rotate` {share(speed['rotate']['30°'])}, Gram-Schmidt {share(speed['Gram-Schmidt']['30°'])}, the normal "
         f"alone {share(speed['perturb']['30°'])}"],
        ["The time of `rotate` over that of the normal alone; of the same formula in plain C over `rotate`",
         f"{speed['rotate']['ratio']}; {report.number(float(plain['ns']) / float(speed['rotate']['ns']))}"],
        ["A bumped plate under a sun, beside the plate really displaced",
         f"libshade {share(plate['rotate'])} off, Cycles' normal map {share(plate[CYCLES])}"],
        ["The time of Cycles over ours, to a picture of the same noise",
         "; ".join(f"{scene} {paths[scene, 'Cycles'] / paths[scene, 'libshade']:.1f}" for scene in ("studio", "room"))],
        [f"Cloth from afar beside the mean of its yarns, {len(cloth)} cloths",
         f"at most {max(float(row['off, %']) for row in cloth):.1f} % off"],
        ["One scene in both renderers: the largest error of a value beside the reference; pixels that agree",
         f"Blender {agreed['Blender, reference'].split(', ')[1]}, POV-Ray {agreed['POV-Ray, reference'].split(', ')[1]}; "
         f"{agreed['dump, dump'].split(', ')[1]}"]])


def between():
    """(what stands before the marks of README.md, between them, after them)."""
    text = README.read_text(encoding="utf-8")
    before, rest = text.split(f"{BEGIN}\n\n")
    return before + f"{BEGIN}\n\n", *rest.split(f"\n\n{END}")


def write_readme():
    before, _old, after = between()
    whole.write_text(README, f"{before}{readme()}\n\n{END}{after}")


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("bench", "readme"))
    parser.add_argument("file", nargs="?", type=Path, help="of bench: the CSV file that it left")
    options = parser.parse_args(argv)
    if (options.what == "bench") != (options.file is not None):
        parser.error("bench wants the CSV file, readme none")
    if options.file:
        bench(options.file)
    else:
        write_readme()
    return 0


if __name__ == "__main__":
    report.run(main)
