# SPDX-License-Identifier: GPL-3.0-or-later
"""Awkward scenes by chance, in the system's Blender and PyPI's, or in others: inside/hostile.py, and what became of each seed.

    build/venv/bin/python blender_addon_c/tests/soak.py [--seeds 500] [--first 0] [--version 4.2 5.3] [--zip FILE] [--each 40]
"""

import argparse
import collections
import pathlib
import re
import sys
import tempfile

from blender_runs import ZIP, Blender, Missing


def seeds(blender, folder, first, count, seconds=300, each=()):
    """Runs seeds and yields (seed, how it ended, all that was printed). After a crash comes the next.

    each: [seconds that one may take], else hostile.py's.
    """
    end = first + count
    while first < end:
        text = blender.run("hostile.py", folder, first, end - first, *each, status=None, seconds=seconds)
        ran = re.split(r"^SEED (\d+)\n", text, flags=re.M)
        if len(ran) < 3:
            raise RuntimeError(text[-4000:])
        for number, said in zip(ran[1::2], ran[2::2]):
            ended = re.findall(r"^END (.*)$", said, re.M)
            how = ended[-1] if ended else "crashed or hung"
            if "Traceback" in said and "internal error" not in how:
                how = "broken: Python's traceback"
            yield int(number), how, said
            first = int(number) + 1


def good(how):
    return how in ("finished", "error")


def main():
    words = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    words.add_argument("--seeds", type=int, default=500)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--version", nargs="+", default=["old", "new"], help="of those that are here")
    words.add_argument("--zip", type=pathlib.Path, default=ZIP, help="the add-on's")
    words.add_argument("--each", type=float, nargs=1, default=(), help="seconds for each, more beside other work")
    given = words.parse_args()
    failed = 0
    for which in given.version:
        ends = collections.Counter()
        with tempfile.TemporaryDirectory() as home:
            try:
                blender = Blender(which, pathlib.Path(home) / "home", given.zip.resolve())
            except Missing as missing:
                print(missing, flush=True)
                continue
            version = blender.version
            for seed, how, said in seeds(blender, home, given.first, given.seeds, None, given.each):
                ends[how if good(how) else "broken"] += 1
                if not good(how):
                    failed += 1
                    print(f"Blender {version}, seed {seed}: {how}\n{said[-3000:]}", flush=True)
        print(f"Blender {version}: {dict(ends)}", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
