#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What the tests cost. Each file of tests says it in a line of its own, in seconds of a processor:

    COST = 12                                    a file of pytest's
    ALONE = {"test_one_that_goes_apart": 30}     more of it: a test that needs nothing of its file's, and goes to any worker
    TOGETHER = "report"                          its worker is that of other files that say the same word
    /* COST = 12 */                              a program of libshade/test

The seconds are user + system, as the time of a run of that file tells them, of a processor that
makes `make demo` of 4eb53c7 in ten minutes of its time.

Run by hand it lists files, the dearest first, each with how many mistakes of setup/mutants.txt it is known to notice
(setup/mutants.py --table): what costs much and finds nothing goes to `make soak`.
"""
import ast
import functools
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("libshade/test", "blender_addon_c/tests", "povray_patches/tests", "compare/tests", "farm/tests")


@functools.cache
def _said(file):
    lines = re.findall(r"^(?:/\* )?(COST|ALONE|TOGETHER) = (.*?)(?: \*/|  #.*)?$",
                       (ROOT / file).read_text(encoding="utf-8"), re.M)
    return {name: ast.literal_eval(value) for name, value in lines}


def said(file, name, otherwise):
    """What a file, by its path in the tree, says of itself under that name."""
    return _said(file).get(name, otherwise)


def files():
    return sorted(str(path.relative_to(ROOT)) for folder in FOLDERS for kind in ("py", "c")
                  for path in (ROOT / folder).glob(f"test_*.{kind}"))


def cost(file):
    return said(file, "COST", 0) + sum(said(file, "ALONE", {}).values())


def main():
    table = (ROOT / "setup" / "mutants-noticed.txt").read_text(encoding="utf-8").splitlines()
    noticed = [{test.split("::")[0] for test in line.partition("\t")[2].split()} for line in table]
    print("seconds  noticed  file")
    for file in sorted(files(), key=cost, reverse=True):
        print(f"{cost(file):7.1f}  {sum(file in by for by in noticed):7}  {file}")
    print(f"{sum(map(cost, files())):7.0f}")


if __name__ == "__main__":
    main()
