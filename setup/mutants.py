#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Do the tests notice small mistakes? Puts mistakes into a copy of the tree, one at a time, builds,
runs the tests that ought to notice, and says which mistakes they caught and which survived.

Run by hand from anywhere, by the system's Python (another one's folder in PATH is where Blender would look for
its modules), after `make check` or as much of it as the tests named in the list need:

    setup/mutants.py                      all of setup/mutants.txt, in build/mutants
    setup/mutants.py --only weave         those whose file or text holds the word
    setup/mutants.py --list setup/mutants-once-missed.txt   what tests had not noticed before
    setup/mutants.py --stale                                only whether a list finds its lines
    setup/mutants.py --table --only weave                   all tests to their end; who noticed goes to
                                                            setup/mutants-noticed.txt, which setup/costs.py counts

A list is made of blocks, parted by empty lines; # begins a comment:

    libshade/src/dispatch.c          the file
    - *status |= found;              a line of it, or several; they must occur there once
    + *status = found;               what stands there instead; none: they are left out
    $ c bsdf sample                  who ought to notice, one or more of; none: all tests that reach the file
                                     (setup/reach.py), the cheapest first:

    $ c NAME …       programs of libshade/test
    $ py ARGUMENTS   pytest on libshade and compare; words may be quoted, as in a shell
    $ blender ARGUMENTS, $ povray ARGUMENTS   the same, where the renderer must be built first
    $ zip ARGUMENTS  the same, where the add-on's archive must be made again, with assets and manual

The last word on a mistake is one line: `caught` (a test failed, whose name follows), `compiler` (it did not
build), `slow` (no end within five minutes: caught too), `SURVIVED`, or `stale` (the text is not there, or not
once). Instruction sets that no test runs stay as the tree has built them: what compares one with another, as the
program isa does, would notice a mistake in a kernel by that alone, so no list names it for one.
Before the mistakes every kind of test that the list names is run on the tree as it is: it must pass.
Exit status: 0 if 90 % of those that are not stale are noticed, else 1; 2 for a list that cannot be read.
"""
import argparse
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import reach

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 300
ENOUGH = 0.9
# what Blender renders of the add-on, and its manual: old ones will do, which takes ten seconds less
MADE_BEFORE = [word for name in ("assets/blender_assets.cats.txt", "manual/index.html")
               for word in ("-o", f"build/blender/addons/libshade/{name}")]
# what may stay where it is: only read
SHARED = ("venv", "venv-bpy")
# what no test named in a list needs
LEFT_OUT = ("sanitized", "threads", "clang", "fuzz", "demo", "compare", "mutants", "pytest-cache")


@dataclass
class Mutant:
    line: int
    file: str
    old: str
    new: str
    tests: list

    def title(self):
        shown = self.new.strip().splitlines() or ["(left out)"]
        return f"{self.file}: {self.old.strip().splitlines()[0]} -> {shown[0]}"


def read_list(path):
    """Mutants of a list; ValueError with the line that cannot be read."""
    mutants, block = [], []

    def end():
        if not block:
            return
        number, file = block[0]
        parts = {"-": [], "+": [], "$": []}
        for at, text in block[1:]:
            if text[:1] not in parts or text[1:2] not in ("", " "):
                raise ValueError(f"{path}:{at}: a line begins with '- ', '+ ' or '$ ', this one does not")
            parts[text[0]].append(text[2:])
        if not parts["-"]:
            raise ValueError(f"{path}:{number}: needs lines that begin with '- '")
        mutants.append(Mutant(number, file, "\n".join(parts["-"]), "\n".join(parts["+"]), parts["$"] or reach.tests(file)))
        block.clear()

    for at, text in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if text.startswith("#"):
            continue
        if text.strip():
            block.append((at, text))
        else:
            end()
    end()
    return mutants


def is_stale(mutant, folder=ROOT):
    path = folder / mutant.file
    return not path.is_file() or path.read_text(encoding="utf-8").count(mutant.old) != 1


def command(test, to_the_end=False):
    """(goals of make, then a command) for a line of tests, which stops at the first that fails or goes on to the end."""
    kind, *words = test.split()
    if kind == "c":
        end = "failed=1" if to_the_end else "exit 1"
        each = [f"build/test/{word} || {{ echo FAILED libshade/test/test_{word}.c::main; {end}; }}" for word in words]
        return [f"build/test/{word}" for word in words], ["sh", "-c", "\n".join(["failed=0", *each, "exit $failed"])]
    goals = {"py": ["all", *(f"build/{name}" for name in ("horizon", "displaced", "bumps", "plain.so"))],
             "blender": ["all", *MADE_BEFORE, "native", "blender"], "zip": ["all", "blender"], "povray": ["all", "povray"]}
    if kind not in goals:
        raise ValueError(f"'{test}': tests are c, py, blender, zip or povray")
    line = test.split(None, 1)[1]
    stop = "" if to_the_end else "-x"
    return goals[kind], ["sh", "-c", f"build/venv/bin/python -m pytest -q {stop} -p no:cacheprovider {line}"]


def kept_as_built():
    """Variables of make by which the instruction sets that no test runs are taken from the tree's build/."""
    build = ROOT / "build"
    try:
        said = subprocess.run([build / "shade", "--version"], check=True, capture_output=True, text=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return []
    widest = re.search(r"\((\w+)\)", said)
    if not widest:
        return []
    given = []
    for objects, of, names, run in ((build / "obj" / "src", build, ("PLAIN_B", "PLAIN_ISAS"), {"scalar"}),
                                    (build / "blender" / "native" / "obj" / "isa", build / "blender" / "native",
                                     ("PLAIN_NATIVE", "PLAIN_STAGES"), set())):
        sets = {re.sub("^isa_|_float$|_double$", "", path.stem) for path in objects.glob("*")} & {"scalar", "sse2", "avx2", "avx512"}
        left = sorted(sets - run - {widest[1]})
        if left:
            given += [f"{names[0]}={of}", f"{names[1]}={' '.join(left)}"]
    return given


def moved(build, was, now):
    """POV-Ray's build says where it is: in another folder it would be configured and compiled anew."""
    for pattern in ("configured", "src/Makefile", "src/config.status", "src/**/Makefile", "src/**/.deps/*.Po",
                    "src/.pc-libshade/.quilt_*"):
        for path in (build / "povray").glob(pattern):
            text, times = path.read_bytes(), path.stat()
            if os.fsencode(was) + b"/" in text:
                path.write_bytes(text.replace(os.fsencode(was) + b"/", os.fsencode(now) + b"/"))
                os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


def failed(log):
    """The first test that a log says failed."""
    found = re.search(r"^(?:FAILED|ERROR) \S+::(\S+)|^\[  FAILED  \] \S+: (\w+)$|^\[  FAILED  \] (\w+)$", log, re.M)
    return next((name for name in found.groups() if name), "") if found else ""


def all_failed(log):
    """Every test of pytest's and program of libshade/test that failed, without parameters."""
    return sorted(set(re.findall(r"^(?:FAILED|ERROR) (\S+::\w+)", log, re.M)))


class Noticed:
    """setup/mutants-noticed.txt: a mistake a line, a tab, and who noticed it; of mistakes not judged again it stays."""

    FILE = ROOT / "setup" / "mutants-noticed.txt"
    # REUSE-IgnoreStart
    HEAD = ("# SPDX-License-Identifier: Apache-2.0\n# Made by setup/mutants.py --table: a mistake, and the tests that "
            "noticed it. Not all mistakes have been judged.\n")
    # REUSE-IgnoreEnd

    def __init__(self, known):
        lines = self.FILE.read_text(encoding="utf-8").splitlines() if self.FILE.exists() else []
        self.by = dict(line.split("\t", 1) for line in lines if "\t" in line)
        self.by = {title: tests for title, tests in self.by.items() if title in known}

    def add(self, title, tests):
        self.by[title] = " ".join(tests)
        text = "".join(f"{title}\t{tests}\n" for title, tests in sorted(self.by.items()))
        self.FILE.write_text(self.HEAD + text, encoding="utf-8")


class Copy:
    """The tree and its build/, where mistakes may be made."""

    def __init__(self, folder):
        self.folder, self.kept = folder, kept_as_built()
        build = folder / "build"
        build.mkdir(parents=True, exist_ok=True)
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True)
        self._unpack(ROOT, folder, ["--null", "-T", "-"], listed.stdout)
        self._unpack(ROOT / "build", build, [*(f"--exclude=./{n}" for n in (*SHARED, *LEFT_OUT)), "."])
        moved(build, ROOT, folder)
        for name in SHARED:
            if (ROOT / "build" / name).exists() and not (build / name).exists():
                (build / name).symlink_to(ROOT / "build" / name)

    @staticmethod
    def _unpack(source, target, what, names=b""):
        """Copy with times, so that what is built already stays good."""
        packed = subprocess.run(["tar", "-C", source, "-cf", "-", *what], input=names, check=True,
                                stdout=subprocess.PIPE)
        subprocess.run(["tar", "-C", target, "-xf", "-"], input=packed.stdout, check=True)

    def run(self, words):
        """Exit status; None where it took too long."""
        with open(self.folder / "build" / "mutant.log", "ab") as log:
            # a session of its own, so that what it started ends with it
            with subprocess.Popen(words, cwd=self.folder, stdout=log, stderr=log, stdin=subprocess.DEVNULL,
                                  start_new_session=True) as process:
                try:
                    return process.wait(SECONDS)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGKILL)
                    return None

    def judge(self, tests, to_the_end=False):
        """What the tests say of the tree as it is."""
        (self.folder / "build" / "mutant.log").unlink(missing_ok=True)
        said = "SURVIVED"
        for test in tests:
            goals, words = command(test, to_the_end)
            # optimised less: quicker to build; the setup goals are not wanted, all of it is there
            made = self.run(["make", f"-j{os.cpu_count()}", "CFLAGS=-O1", "WERROR=-Werror", "NEEDS=", *self.kept, *goals])
            if made != 0:
                return "slow" if made is None else "compiler"
            status = self.run(words)
            if "pytest" in words[-1] and status in (4, 5):
                raise ValueError(f"`{test}` runs no test")
            if status != 0:
                said = "slow" if status is None else "caught"
                if not to_the_end or status is None:
                    return said
        return said

    def log(self):
        return (self.folder / "build" / "mutant.log").read_text(encoding="utf-8", errors="replace")

    def with_mistake(self, mutant, to_the_end=False):
        path = self.folder / mutant.file
        if is_stale(mutant, self.folder):
            return "stale"
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
        try:
            return self.judge(mutant.tests, to_the_end)
        finally:
            path.write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", type=Path, default=ROOT / "setup" / "mutants.txt")
    parser.add_argument("--only", default="", help="a word of the file's name or of the text")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "mutants",
                        help="folder for the copy (default build/mutants)")
    parser.add_argument("--stale", action="store_true", help="name those that no longer find their lines, and end")
    parser.add_argument("--table", action="store_true", help="run all tests to their end and note who noticed")
    parser.add_argument("--no-baseline", action="store_true", help="do not run the tests unchanged first")
    options = parser.parse_args()
    try:
        listed = read_list(options.list)
        mutants = [m for m in listed if options.only in m.title()]
        for mutant in mutants:
            for test in mutant.tests:
                command(test)
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if options.stale:
        gone = [m for m in mutants if is_stale(m)]
        for mutant in gone:
            print(f"{options.list}:{mutant.line}: stale: {mutant.title()}")
        return 1 if gone else 0
    copy = Copy(options.work.resolve())
    if not options.no_baseline:
        for test in sorted({t for m in mutants for t in m.tests}):
            if copy.judge([test]) != "SURVIVED":
                print(f"error: without any mistake `{test}` fails; see {copy.folder}/build/mutant.log",
                      file=sys.stderr)
                return 1
    lists = [listed, *(read_list(ROOT / "setup" / f"mutants{of}.txt") for of in ("", "-once-missed"))]
    noticed_by = Noticed({mutant.title() for of in lists for mutant in of})
    results, started = [], time.monotonic()
    for mutant in mutants:
        begun = time.monotonic()
        try:
            results.append(copy.with_mistake(mutant, options.table))
        except ValueError as error:
            print(f"error: {options.list}:{mutant.line}: {error}", file=sys.stderr)
            return 2
        by = f"  [{failed(copy.log())}]" if results[-1] == "caught" else ""
        if options.table and results[-1] in ("caught", "SURVIVED"):
            noticed_by.add(mutant.title(), all_failed(copy.log()))
        print(f"{results[-1]:9} {time.monotonic() - begun:4.0f} s  {mutant.title()}{by}", flush=True)
    valid = [r for r in results if r != "stale"]
    noticed = sum(r != "SURVIVED" for r in valid)
    print(f"\n{noticed} of {len(valid)} noticed ({results.count('stale')} stale), "
          f"{time.monotonic() - started:.0f} s")
    return 0 if valid and noticed >= ENOUGH * len(valid) else 1


if __name__ == "__main__":
    sys.exit(main())
