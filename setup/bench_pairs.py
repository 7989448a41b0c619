#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is a row of `shade bench` slower than it was? Two builds of the tool take turns; the median of a row's ratios counts.

    make bench-pairs BEFORE=ffb05d3           build/shade against the tool as that commit built it
    setup/bench_pairs.py ffb05d3 --pairs 5    the same, quicker and less sure
    setup/bench_pairs.py old/shade new/shade --what f lanes --mdf ggx

BEFORE and AFTER are programs, or commits, which are built in build/pairs the first time. A turn is the rows of one distribution
and one question, some seconds: what else the machine does falls on both sides. Every other pair begins with AFTER. All turns are
made once, then all again, so that the pairs of a row lie minutes apart. Beside the median and the middle half of the ratios stands
that of the least times, which a busy machine bends less. Rows over the limit are taken again, as many pairs, and are slower only if
their second median is over it too. One program against itself shows what this machine can tell apart.

Ctrl-C, or a tool that fails, ends it with what was measured so far. Exit status: 0 if no row is slower, 1 if some are, 2 if it
cannot be told, 130 after Ctrl-C.
"""
import argparse
import contextlib
import csv
import io
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
BUILT = ROOT / "build/pairs"
NAMES = ("question", "isa", "set", "what", "precision", "distribution", "method")
# what answers for all distributions at once, and in cache
APART = ("cloth", "lanes", "maps", "diffuse", "lobes", "reference")
NEEDED = {"what", "method", "distribution", "precision", "isa", "set", "ns"}


class Failed(Exception):
    """Nothing can be said; the text tells why."""


def run(command, **options):
    try:
        return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, **options)
    except OSError as error:
        raise Failed(f"{command[0]}: {error.strerror}") from error


def last_lines(text):
    return "\n".join(text.strip().splitlines()[-8:])


def tool_of(word, note):
    """The program that a word names, or that of a commit."""
    if os.path.isfile(word) and os.access(word, os.X_OK):
        return os.path.abspath(word)
    found = run(["git", "-C", str(ROOT), "rev-parse", "--verify", "--quiet", "--end-of-options", f"{word}^{{commit}}"])
    if found.returncode:
        raise Failed(f"{word}: neither a program nor a commit of {ROOT}")
    commit = found.stdout.strip()
    tool = BUILT / commit / "build/shade"
    if not tool.is_file():
        note(f"building shade of {word} in {tool.parent.parent}")
        build(commit, BUILT / commit)
    return str(tool)


def build(commit, place):
    """Whole or not at all: what is half built does not lie where the next run looks."""
    BUILT.mkdir(parents=True, exist_ok=True)
    part = Path(tempfile.mkdtemp(prefix=".part-", dir=BUILT))
    try:
        archive = subprocess.run(["git", "-C", str(ROOT), "archive", commit], capture_output=True, check=False)
        unpacked = subprocess.run(["tar", "-x", "-C", str(part)], input=archive.stdout, capture_output=True, check=False)
        if archive.returncode or unpacked.returncode:
            raise Failed(f"{commit}: git archive: {last_lines((archive.stderr + unpacked.stderr).decode(errors='replace'))}")
        # of an outer make nothing is to be heard here
        clean = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
        made = run(["make", "-C", str(part), f"-j{os.cpu_count() or 1}", "build/shade"], env=clean)
        if made.returncode:
            raise Failed(f"{commit}: make build/shade: status {made.returncode}\n{last_lines(made.stdout + made.stderr)}")
        shutil.rmtree(place, ignore_errors=True)
        part.rename(place)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def words_of(tool, option):
    """What `shade eval` says that it knows."""
    said = re.search(rf"--{option} +(.*?)(?: +\(default .*)?$", run([tool, "eval", "--help"]).stdout, re.M)
    if not said:
        raise Failed(f"{tool}: `eval --help` names no --{option}: is it the shade tool?")
    return said[1].split(" | ")


def own_isa(tool):
    said = re.search(r"\((\w+)\)", run([tool, "--version"]).stdout)
    if not said:
        raise Failed(f"{tool}: `--version` names no instruction set: is it the shade tool?")
    return said[1]


class Turn(NamedTuple):
    """What `shade bench` is asked for at once; mdf is None where it answers for all."""

    question: str
    isa: str
    mdf: str | None
    arrays: str

    def options(self):
        apart = self.question in APART
        return ["--isa", self.isa, "--what", self.question, *([] if apart else ["--mdf", self.mdf, "--set", self.arrays])]

    def has(self, row):
        return (self.question, self.isa) == (row["question"], row["isa"]) and self.mdf in (None, row["distribution"])


def times_of(tool, turn):
    """{row: ns}."""
    command = [tool, "bench", "--csv", *turn.options()]
    made = run(command)
    if made.returncode:
        raise Failed(f"{' '.join(command)}: status {made.returncode}\n{last_lines(made.stderr)}")
    rows = csv.DictReader(io.StringIO(made.stdout))
    if not NEEDED <= set(rows.fieldnames or ()):
        raise Failed(f"{' '.join(command)}: not the columns of `shade bench --csv`")
    try:
        return {(turn.question, *(row[name] for name in NAMES[1:])): float(row["ns"]) for row in rows}
    except (TypeError, ValueError) as error:
        raise Failed(f"{' '.join(command)}: a row without a time: {error}") from error


class Progress:
    """A line that is written over on a terminal, and one a pair elsewhere."""

    def __init__(self, total):
        self.total, self.done, self.begun = total, 0, time.monotonic()
        self.live = sys.stderr.isatty()

    def step(self, words, ends_pair):
        self.done += 1
        left = (time.monotonic() - self.begun) / self.done * (self.total - self.done)
        text = f"{self.done} of {self.total} turns, {left / 60:.0f} min left"
        if self.live:
            print(f"\r{text}  {words}\033[K", end="", file=sys.stderr, flush=True)
        elif ends_pair:
            print(text, file=sys.stderr, flush=True)

    def clear(self):
        if self.live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def take(tools, turns, pairs):
    """{row: ([ns before], [ns after])}, {row of one tool alone: which}, and what broke it off, or nothing."""
    found, alone, progress = {}, {}, Progress(pairs * len(turns))
    try:
        for pair in range(pairs):
            for turn in turns:
                times = {side: times_of(tools[side], turn) for side in ((0, 1), (1, 0))[pair % 2]}
                alone.update({key: int(key in times[1]) for key in times[0].keys() ^ times[1].keys()})
                for key in times[0].keys() & times[1].keys():
                    for side in (0, 1):
                        found.setdefault(key, ([], []))[side].append(times[side][key])
                progress.step(" ".join(turn.options()), turn is turns[-1])
    except KeyboardInterrupt:
        return found, alone, "broken off"
    except Failed as failure:
        if not found:
            raise
        return found, alone, str(failure)
    finally:
        progress.clear()
    return found, alone, ""


def summary(key, before, after):
    ratios = sorted(b / a for a, b in zip(before, after))
    quarter = len(ratios) // 4
    return {**dict(zip(NAMES, key)), "pairs": len(ratios), "ratio": statistics.median(ratios), "low": ratios[quarter],
            "high": ratios[-1 - quarter], "ratio_of_least": min(after) / min(before), "ns_before": min(before), "ns_after": min(after)}


def line(row):
    return ("{isa:7s} {set:6s} {what:16s} {precision:6s} {distribution:17s} {method:24s} {ratio:.3f} ({low:.3f} to {high:.3f})  "
            "least {ratio_of_least:.3f}: {ns_before:.4g} -> {ns_after:.4g} ns").format(**row)


def turns_of(arguments, tools):
    asked = arguments.what
    if not asked:
        asked = ["D", "f"]
        if arguments.set == "cache":
            asked += ["D_call", "f_call", *(f"f_{word}" for word in words_of(tools[0], "horizon") if word != "hard")]
    distributions = arguments.mdf or words_of(tools[0], "mdf")
    return [Turn(question, isa, mdf, arguments.set)
            for isa in arguments.isa or [own_isa(tools[0])]
            for question in asked
            for mdf in ([None] if question in APART else distributions)]


@contextlib.contextmanager
def placed(path):
    """A file that appears whole or not at all."""
    part = f"{path}.{os.getpid()}"
    try:
        with open(part, "w", newline="", encoding="utf-8") as file:
            yield file
        os.replace(part, path)
    except OSError as error:
        raise Failed(f"{path}: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            os.unlink(part)


def write(path, rows):
    with placed(path) as file:
        table = csv.DictWriter(file, [*NAMES, "pairs", "ratio", "low", "high", "ratio_of_least", "ns_before", "ns_after"])
        table.writeheader()
        table.writerows(rows)


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", metavar="BEFORE", help="the older tool: a program or a commit")
    parser.add_argument("after", metavar="AFTER", nargs="?", default=str(ROOT / "build/shade"),
                        help="the newer one (default build/shade, which `make` makes)")
    parser.add_argument("--pairs", type=int, default=11, metavar="N", help="of each row (default 11)")
    parser.add_argument("--limit", type=float, default=1.03, metavar="R", help="a ratio above this is over (default 1.03)")
    parser.add_argument("--isa", nargs="+", metavar="NAME", help="instruction sets (default: the widest of this CPU)")
    parser.add_argument("--what", nargs="+", metavar="NAME", help="as `shade bench --what` (default D, f, both by calls, f under every horizon)")
    parser.add_argument("--mdf", nargs="+", metavar="NAME", help="distributions (default: all that BEFORE has)")
    parser.add_argument("--set", default="cache", choices=("cache", "memory"), help="(default cache; memory takes a minute a pair)")
    parser.add_argument("--cpu", type=int, metavar="N", help="the processor to stay on")
    parser.add_argument("--once", action="store_true", help="rows over the limit are not taken again")
    parser.add_argument("-o", "--output", metavar="FILE", help="all rows of the first taking as CSV")
    arguments = parser.parse_args()
    if arguments.pairs < 1:
        parser.error(f"--pairs {arguments.pairs}: expected 1 or more")
    if not arguments.limit > 0:
        parser.error(f"--limit {arguments.limit}: expected more than 0")
    if arguments.output and not os.path.isdir(os.path.dirname(arguments.output) or "."):
        parser.error(f"--output {arguments.output}: there is no such folder")
    if arguments.cpu is not None:
        try:
            os.sched_setaffinity(0, {arguments.cpu})
        except OSError:
            parser.error(f"--cpu {arguments.cpu}: expected one of {sorted(os.sched_getaffinity(0))}")
    return arguments


def tell(rows, over, alone, tools, limit):
    for key in sorted(alone):
        print(f"only in {tools[alone[key]]}:", *key)
    for row in sorted(over, key=lambda row: -row["ratio"]):
        print(line(row))
    slow = {tuple(row[name] for name in NAMES) for row in over}
    for isa, question in dict.fromkeys((row["isa"], row["question"]) for row in rows):
        these = [row for row in rows if (row["isa"], row["question"]) == (isa, question)]
        ratios = [row["ratio"] for row in these]
        many = sum(tuple(row[name] for name in NAMES) in slow for row in these)
        print(f"{isa:7s} {question:16s} median of {len(ratios):3d} rows {statistics.median(ratios):.3f}, "
              f"{min(ratios):.3f} to {max(ratios):.3f}; over {limit:g}: {many}")


def main():
    arguments = read_arguments()
    tools = [tool_of(word, lambda text: print(text, file=sys.stderr, flush=True)) for word in (arguments.before, arguments.after)]
    turns = turns_of(arguments, tools)
    found, alone, broken = take(tools, turns, arguments.pairs)
    rows = [summary(key, *times) for key, times in sorted(found.items())]
    over = [row for row in rows if row["ratio"] > arguments.limit]
    if not rows and not broken:
        raise Failed("the two tools have no row in common")
    if over and not broken and not arguments.once:
        print(f"{len(over)} rows over {arguments.limit:g} at first; taken again:", flush=True)
        second, _, broken = take(tools, [turn for turn in turns if any(map(turn.has, over))], arguments.pairs)
        if not broken:
            keys = [tuple(row[name] for name in NAMES) for row in over]
            over = [row for row in (summary(key, *second[key]) for key in keys if key in second) if row["ratio"] > arguments.limit]
    tell(rows, over, alone, tools, arguments.limit)
    if arguments.output and rows:
        write(arguments.output, rows)
    if broken:
        print(f"bench_pairs.py: {broken}: " + (f"what stands above is of {rows[0]['pairs']} pairs at most" if rows else "nothing was measured"),
              file=sys.stderr)
        return 130 if broken == "broken off" else 2
    return 1 if over else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failed as failure:
        print(f"bench_pairs.py: {failure}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)
