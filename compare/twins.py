# SPDX-License-Identifier: Apache-2.0
"""What an mdf block costs a render of POV-Ray's: each scene beside its twin, in which POV-Ray's own `specular` stands for the block.

Whole renders by one thread, processor time; the two take turns, and the median of the pairs' ratios counts.
"""
import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import whole

ROOT = Path(__file__).resolve().parent.parent
SHAPES = "sphere torus box plane cylinder cone lathe sor spheres mesh".split()
STOCK = "diffuse .3 specular .6 roughness .02"


def twin(text):
    """The scene with STOCK in place of every `mdf { … }` and of the `diffuse` beside it."""
    while (found := re.search(r"(\bdiffuse [\d.]+\s+)?\bmdf\s*{", text)):
        depth, end = 1, found.end()
        while depth:
            if end == len(text):
                raise ValueError("a block without an end")
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        text = text[:found.start()] + STOCK + text[end:]
    return re.sub(r"#ifndef \(mdf_Version\).*?#end\n", "", text, flags=re.S)


def seconds(povray, scene, options):
    process = subprocess.Popen([povray, f"+I{scene}", "-V", "-D", "-F", "-P", "+WT1", "-GA", *options],
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"twins.py: {scene} {' '.join(options)} failed:\n{said.decode(errors='replace')[-2000:]}")
    return used.ru_utime + used.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("povray", help="POV-Ray with libshade")
    parser.add_argument("--pairs", type=int, default=11, help="of each scene (default 11)")
    parser.add_argument("--only", default="", help="scenes whose name has this in it")
    parser.add_argument("-o", "--output", default="", help="the table as CSV")
    arguments = parser.parse_args()
    if arguments.pairs < 1:
        parser.error("--pairs must be 1 or more")
    if not os.access(arguments.povray, os.X_OK):
        parser.error(f"{arguments.povray}: no such program")

    primitives = (ROOT / "compare/twins/primitives.pov").read_text()
    scenes = [(name, primitives, [f"Declare=Shape={i}", "+W2400", "+H1200"]) for i, name in enumerate(SHAPES)]
    scenes += [(name, (ROOT / f"examples/povray/{name}/{name}.pov").read_text(), ["+W1600", "+H800"]) for name in ("metals", "turned")]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, text, options in scenes:
            if arguments.only not in name:
                continue
            paths = {side: Path(folder) / f"{name}-{side}.pov" for side in ("block", "stock")}
            whole.write_text(paths["block"], text)
            whole.write_text(paths["stock"], twin(text))
            times = {"block": [], "stock": []}
            for pair in range(arguments.pairs):
                for side in sorted(paths, reverse=pair % 2):
                    times[side].append(seconds(arguments.povray, paths[side], options))
            ratios = [a / b for a, b in zip(times["block"], times["stock"])]
            rows.append({"scene": name, "ratio": f"{statistics.median(ratios):.3f}", "least": f"{min(ratios):.3f}", "most": f"{max(ratios):.3f}",
                         "block_s": f"{min(times['block']):.2f}", "stock_s": f"{min(times['stock']):.2f}"})
            print("{scene:10s} {ratio}  ({least} to {most})  {block_s} s, {stock_s} s".format(**rows[-1]), flush=True)
    if not rows:
        sys.exit(f"twins.py: no scene has '{arguments.only}' in its name")
    if arguments.output:
        whole.write_csv(arguments.output, rows)


if __name__ == "__main__":
    main()
