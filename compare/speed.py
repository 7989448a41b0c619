# SPDX-License-Identifier: Apache-2.0
"""How fast: the plate with its normal map, in Cycles and in our engine, one after the other.

The time is that of the whole render operator: reading the scene, fetching the
image, building the BVH, rendering, handing the picture back. Both engines
render in turns in one Blender process, so the second time shows what stays warm.
Prints the ratio; this is a measurement, not a test.
"""
import argparse
import json
import re
from pathlib import Path

import pictures
import plate
import programs
import report
import results
import whole


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=512, help="pixels along a side (default 512)")
    parser.add_argument("--samples", type=int, default=64, help="per pixel (default 64)")
    parser.add_argument("--repeat", type=int, default=3, help="renders of each (default 3)")
    parser.add_argument("--results", action="store_true", help="rewrite docs/results/, as make compare does")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "speed",
                        help="folder for results (default build/compare/speed)")
    return parser.parse_args(argv)


def main(argv=None):
    options = arguments(argv)
    head = results.surroundings("make compare")
    folder = options.output = options.output.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    pictures.write_float(folder / "normals.exr", plate.normal_map(2048))
    common = {"surface": "bumped", "size": options.size, "samples": options.samples,
              "quads": 1, "repeat": options.repeat, "output": ""}
    jobs = {"Cycles": {"engine": "CYCLES", **common},
            "libshade": {"engine": "LIBSHADE", "detail": "rotate", **common}}
    order = {"normal_map": str(folder / "normals.exr"), "result": str(folder / "seconds.json"),
             "jobs": list(jobs.values())}
    whole.write_text(folder / "jobs.json", json.dumps(order))
    output = report.step(
        f"Rendering the plate {options.repeat} times with each engine",
        programs.blender(programs.HERE / "plate_render.py", folder / "jobs.json"),
        folder / "blender.log", {**programs.ADD_ON, "LIBSHADE_TIMINGS": "1"},
    )
    result = json.loads((folder / "seconds.json").read_text(encoding="utf-8"))
    seconds = dict(zip(jobs, result["seconds"]))
    samples = options.size**2 * options.samples
    rows = []
    for number, times in enumerate(zip(*seconds.values())):
        ratio = times[0] / times[1]
        rows.append([f"render {number + 1}", *(f"{t:.3f}" for t in times), f"{ratio:.1f}"])
    best = [min(times) for times in seconds.values()]
    rows.append(["best", *(f"{t:.3f}" for t in best), f"{best[0] / best[1]:.1f}"])
    rows.append(["million samples/s", *(f"{samples / t / 1e6:.1f}" for t in best), ""])
    print(f"\nBlender {result['blender']}, {options.size} x {options.size}, "
          f"{options.samples} samples; {head['machine']}; {head['compiler']}\n")
    print(report.table(["seconds", *seconds, "ratio"], rows))
    if options.results:
        results.write("plate-time", head, ["renderer", "seconds", "million samples a second"],
                      [[name, time, samples / time / 1e6] for name, time in zip(jobs, best)])
    stages = re.findall(r"libshade: (sync .*)", output)
    if stages:
        print("\nOur stages, first and last render:")
        print("\n".join(f"  {line}" for line in dict.fromkeys((stages[0], stages[-1]))))
    return 0


if __name__ == "__main__":
    report.run(main)
