# SPDX-License-Identifier: Apache-2.0
"""Paths of many bounces: how long until a picture is that good, in Cycles and in our engine.

Two scenes, the same for both engines: the studio (Suzanne of anisotropic GGX, two spheres and a
grey floor under a studio's sky, 4 bounces) and the room (the same in a closed box under an area
light, 8 bounces). No clamps, no denoising, no adaptive sampling, box filter.

The error is relMSE: the mean of (I - R)^2 / (R^2 + (.1 mean R)^2), each at most its 99.9th
percentile, where R is the engine's own picture of many samples and another seed, whose own error is
taken off. It falls as 1 / samples, so time x error tells the seconds to an error of .001. That both
engines render the same picture is checked on their R; a difference beyond --limit is exit status 1.
"""
import argparse
import json
from pathlib import Path

import numpy as np

import pictures
import programs
import report
import results
import whole

ENGINES = {"Cycles": "CYCLES", "libshade": "LIBSHADE"}


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=512, help="pixels along a side (default 512)")
    parser.add_argument("--samples", type=int, default=64, help="of the timed picture (default 64)")
    parser.add_argument("--reference", type=int, default=1024,
                        help="samples of the picture that it is compared with (default 1024)")
    parser.add_argument("--scene", choices=("studio", "room"), action="append",
                        help="this one alone (default both)")
    parser.add_argument("--limit", type=float, default=0.02,
                        help="largest difference of the engines' pictures (default .02)")
    parser.add_argument("--results", action="store_true", help="rewrite docs/results/, as make compare does")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "paths",
                        help="folder for results (default build/compare/paths)")
    options = parser.parse_args(argv)
    if not 0 < options.samples < options.reference or options.size < 4:
        parser.error("--reference must be more than --samples, both more than 0, --size 4 or more")
    options.scene = options.scene or ["studio", "room"]
    return options


def studio(height=512):
    """A sky of 2 x 1: dim walls, two soft boxes, a strip and a small hot lamp, linear RGB."""
    y, x = np.mgrid[0:height, 0:2 * height] + 0.5
    across, up = x / height * np.pi - np.pi, np.pi / 2 - y / height * np.pi  # radians, row 0 on top
    sky = np.full((height, 2 * height, 3), 0.08)
    sky[up < 0] = 0.03
    for middle, half, color in (((-1.9, 0.7), (0.45, 0.3), (9.0, 8.6, 8.0)),
                                ((1.2, 0.5), (0.25, 0.5), (5.0, 6.0, 7.5)),
                                ((-0.2, 1.3), (1.2, 0.08), (12.0, 12.0, 12.0)),
                                ((2.6, 0.35), (0.04, 0.04), (160.0, 130.0, 90.0))):
        inside = (abs(across - middle[0]) < half[0]) & (abs(up - middle[1]) < half[1])
        sky[inside] = color
    return sky


def relative_mse(picture, reference):
    error = (picture - reference) ** 2 / (reference**2 + (0.1 * reference.mean()) ** 2)
    return float(np.minimum(error, np.quantile(error, 0.999)).mean())


def own_error(measured, samples, reference):
    """Of the timed picture alone: what was measured is its error and that of the reference."""
    return measured / (1.0 + samples / reference)


def blocks(picture, side=4):
    """Means of blocks, so that noise does not pass for a difference."""
    height, width = (n // side * side for n in picture.shape[:2])
    return picture[:height, :width].reshape(height // side, side, width // side, side, 3).mean((1, 3))


def main(argv=None):
    options = arguments(argv)
    head = results.surroundings("make compare")
    folder = options.output = options.output.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    pictures.write_float(folder / "sky.exr", studio())
    jobs, kinds = [], (("warm", 1, 0), ("timed", options.samples, 0), ("many", options.reference, 1))
    for scene in options.scene:
        for name, engine in ENGINES.items():
            jobs += [{"engine": engine, "scene": scene, "size": options.size, "samples": samples,
                      "seed": seed, "output": str(folder / f"{scene}_{name}_{kind}.exr")}
                     for kind, samples, seed in kinds]
    order = {"sky": str(folder / "sky.exr"), "result": str(folder / "seconds.json"), "jobs": jobs}
    whole.write_text(folder / "jobs.json", json.dumps(order))
    report.step(f"Rendering {len(jobs)} pictures (minutes; Cycles takes most of them)",
                programs.blender(programs.HERE / "paths_render.py", folder / "jobs.json"),
                folder / "blender.log", programs.ADD_ON)
    result = json.loads((folder / "seconds.json").read_text(encoding="utf-8"))
    seconds = {job["output"]: time for job, time in zip(jobs, result["seconds"])}
    rows, kept, good = [], [], True
    for scene in options.scene:
        many = {}
        for name in ENGINES:
            timed, many[name] = (pictures.read(folder / f"{scene}_{name}_{kind}.exr")
                                 for kind in ("timed", "many"))
            taken = seconds[str(folder / f"{scene}_{name}_timed.exr")]
            error = own_error(relative_mse(timed, many[name]), options.samples, options.reference)
            rows.append([f"{scene}, {name}", f"{taken:.2f}",
                         f"{options.size**2 * options.samples / taken / 1e6:.2f}", f"{error:.4f}",
                         f"{error * options.samples:.2f}", f"{taken * error / 1e-3:.1f}"])
            kept.append([scene, name, taken, options.size**2 * options.samples / taken / 1e6, error, taken * error / 1e-3, None])
        pair = blocks(many["libshade"]), blocks(many["Cycles"])
        apart = pictures.relative_difference(*pair)
        kept[-1][-1] = apart
        mean = pair[0].mean() / pair[1].mean() - 1.0
        good &= apart <= options.limit
        rows.append([f"{scene}, libshade beside Cycles", "", "", "", f"{100 * mean:+.2f} %",
                     f"{apart:.4f}"])
        pictures.write_png(folder / f"{scene}.png", np.concatenate(list(many.values()), axis=1))
    print(f"\nBlender {result['blender']}, {options.size} x {options.size}, {options.samples} samples "
          f"against {options.reference}; {head['machine']}; {head['compiler']}\n")
    print(report.table(["", "seconds", "M samples/s", "relMSE", "relMSE x samples", "s to .001"], rows))
    print("\nThe last two numbers of `beside`: brightness, and relative difference of 4 x 4 blocks.")
    if options.results:
        results.write("paths", head, ["scene", "renderer", "seconds", "million samples a second", "relMSE",
                                      "seconds to a relMSE of .001", "difference of the pictures"], kept)
    if not good:
        print(f"The engines' pictures differ by more than {options.limit}.")
    return 0 if good else 1


if __name__ == "__main__":
    report.run(main)
