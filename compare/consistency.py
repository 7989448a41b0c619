# SPDX-License-Identifier: Apache-2.0
"""One scene, two renderers, one verdict.

Renders a Blender file with our engine, writes its POV-Ray form, renders that
with the patched POV-Ray, and judges:

  each dump against the C reference (`shade check`),
  the two dumps against each other (material, position, UV, normals, tangent, view, and each
  light's direction and irradiance, channel by channel),
  the two pictures against each other, channel by channel.

Leaves in the output folder: blender.png, povray.png, difference.png (ten times
the absolute difference), both dumps and pictures as OpenEXR, and the POV-Ray
form in povray/. Exit status: 0 all within limits; 1 not, or bad input, or a
program that failed; 2 bad usage.
"""
import argparse
import json
import re
from pathlib import Path

import numpy as np

import dumps
import pictures
import programs
import report
import whole

# Largest and mean relative error of S against the reference, beyond what the rounding of the dump's directions may
# do; POV-Ray shades in double.
CHECK_LIMITS = {"Blender": (1e-4, 1e-5), "POV-Ray": (1e-5, 1e-6)}
BEYOND = {"largest": "beyond_rounding", "mean": "mean_beyond_rounding"}
# What counts as equal, and how many of the pixels that both cover must be.
DUMP_LIMITS = {
    "material": (1e-6, "of its parameters"),
    "slopes": (0.1, "of their spread"),  # each renderer looks at points of its own
    "P": (1e-4, "of the size"),
    "uv": (1e-4, "of the map"),
    "N": (0.1, "degrees"),
    "T": (0.1, "degrees"),
    "Ns": (0.2, "degrees"),
    "V": (0.1, "degrees"),
    "L": (0.1, "degrees"),
    "E": (1e-3, "of itself"),
}
SHARE = 0.995
PICTURE_LIMIT = 0.02
# What a run leaves in its folder: an earlier run's is not judged as this one's.
JUDGED = ("blender.exr", "blender_dump.exr", "povray.exr", "povray_dump.exr", "povray_centres.exr", "verdict.txt")


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", type=Path, help="Blender file with Libshade Metal materials")
    parser.add_argument("--percent", type=int, default=100,
                        help="of the file's resolution (default 100)")
    parser.add_argument("--samples", type=int, default=64,
                        help="per pixel in Blender (default 64)")
    parser.add_argument("--grid", type=int, default=4,
                        help="side of POV-Ray's grid of rays in a pixel, 1 to 9 (default 4)")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "consistency",
                        help="folder for results (default build/compare/consistency)")
    parser.add_argument("--all", action="store_true",
                        help="fail also when a material or a light has nothing to compare")
    options = parser.parse_args(argv)
    if not 1 <= options.percent <= 100 or options.samples < 1 or not 1 <= options.grid <= 9:
        parser.error("--percent wants 1 to 100, --samples at least 1, --grid 1 to 9")
    return options


def render_blender(options):
    """Picture and dump from our engine; returns (width, height)."""
    folder = options.output
    output = report.step(
        "Rendering in Blender",
        programs.blender(programs.HERE / "blender_render.py", folder / "blender.exr",
                         options.percent, options.samples, scene=options.scene),
        folder / "blender.log",
        {**programs.ADD_ON, "LIBSHADE_DUMP": str(folder / "blender_dump.exr")},
    )
    size = re.search(r"^size (\d+) (\d+)$", output, re.MULTILINE)
    if not size:
        raise report.StepFailed(f"Blender said no picture size; see {folder / 'blender.log'}")
    return int(size.group(1)), int(size.group(2))


def export_povray(options):
    """The scene's POV-Ray form, in povray/."""
    report.step(
        "Writing the scene for POV-Ray",
        programs.blender(programs.HERE / "export_povray.py", options.output / "povray",
                         scene=options.scene),
        options.output / "export.log", programs.ADD_ON,
    )


def dump_povray(options, width, height):
    """The dump of povray/scene.ini."""
    folder = options.output
    report.step(
        "Dumping in POV-Ray",
        [programs.POVRAY, "scene.ini", f"+W{width}", f"+H{height}", "+FE", "-D", "-A",
         f"+O{folder / 'povray_centres.exr'}"],
        folder / "povray_dump.log", {"LIBSHADE_DUMP": str(folder / "povray_dump.exr")},
        folder=folder / "povray",
    )


def render_povray(options, width, height, over=1):
    """The picture of povray/scene.ini. over: so many pixels in place of one along either side, each with one ray."""
    folder = options.output
    # Every pixel whose neighbours are not the same is averaged over a grid of rays.
    rays = ["-A"] if over > 1 else ["+AM1", "+A0.001", f"+R{options.grid}", "-J"]
    report.step(
        "Rendering in POV-Ray",
        [programs.POVRAY, "scene.ini", f"+W{over * width}", f"+H{over * height}", "+FE", "-D", *rays,
         f"+O{folder / 'povray.exr'}"],
        folder / "povray.log", folder=folder / "povray",
    )


def check(name, dump, options):
    """What `shade check` says of a dump, as its JSON."""
    largest, mean = CHECK_LIMITS[name]
    output = report.step(
        f"Checking {name}'s dump against the reference",
        [programs.SHADE, "check", "--json", "--tolerance", str(largest),
         "--mean-tolerance", str(mean), *(["--all"] if options.all else []), str(dump)],
        options.output / f"{dump.stem}_check.log", allowed=(0, 1),
    )
    try:
        return json.loads(output)
    except ValueError as error:
        raise report.StepFailed(f"{dump}: `shade check` found no figures:\n{output}") from error


def verdict(ok):
    return "ok" if ok else "MISSED"


def beyond(checked, what):
    """The largest or the mean error that `shade check` found, less what the rounding of the dump's directions may do."""
    return min(checked.get(BEYOND[what], checked[what]), checked[what])


def check_rows(name, checked, every=False, limits=None):
    """Table rows and whether all is within limits; `checked` is `shade check`'s JSON, of a run
    with --all if `every` material and light counts. `limits`: largest and mean, else the name's."""
    rows, good = [], checked["pass"] is True and not checked["faults"]
    for what, limit in zip(("largest", "mean"), limits or CHECK_LIMITS[name]):
        ok = checked["values"] > 0 and beyond(checked, what) <= limit
        good &= ok
        rounded = ok and checked[what] > limit
        rows.append([f"{name} against reference, {what} error of S", f"{checked[what]:.1e}",
                     *(("", "noted") if rounded else (f"{limit:.0e}", verdict(ok)))])
        if rounded:
            rows.append([f"{name}: {what} error beyond what rounding of the dump's directions may do",
                         f"{beyond(checked, what):.1e}", f"{limit:.0e}", verdict(ok)])
    for fault in checked["faults"]:
        rows.append([f"{name}: {fault['what']}, first at ({fault['x']}, {fault['y']})",
                     f"{fault['count']} times", "0", verdict(False)])
    for what in ("materials", "lights"):
        if every and checked[f"idle_{what}"]:
            good = False
            rows.append([f"{name}: {what} with nothing to compare",
                         str(checked[f"idle_{what}"]), "0", verdict(False)])
    return rows, good


def dump_rows(a, b):
    """Compare two dumps that are in the same world; rows and whether all is within limits."""
    apart = dumps.coverage_difference(a, b)
    good = apart <= 1.0 - SHARE
    rows = [["covered by one only", f"{100 * apart:.3f} %", f"{100 * (1 - SHARE):.1f} %",
             verdict(good)]]
    for name, error in dumps.deviations(a, b).items():
        limit, unit = DUMP_LIMITS[name.split(".")[-1]]
        share = float(np.mean(error <= limit))
        ok = share >= SHARE
        good &= ok
        rows.append([f"{name} equal within {limit:g} {unit}", f"{100 * share:.3f} %",
                     f"{100 * SHARE:.1f} %", verdict(ok)])
    return rows, good


def picture_rows(blender, povray):
    difference = pictures.worst_channel(povray, blender)
    ok = difference <= PICTURE_LIMIT
    return [["pictures, mean difference over mean", f"{100 * difference:.2f} %",
             f"{100 * PICTURE_LIMIT:.0f} %", verdict(ok)]], ok


def main(argv=None):
    options = arguments(argv)
    folder = options.output = options.output.resolve()
    options.scene = options.scene.resolve()
    if not options.scene.is_file():
        raise report.StepFailed(f"{options.scene}: no such file")
    (folder / "povray").mkdir(parents=True, exist_ok=True)
    for old in JUDGED:
        (folder / old).unlink(missing_ok=True)
    size = render_blender(options)
    export_povray(options)
    dump_povray(options, *size)
    render_povray(options, *size)

    parts = []
    for name, file in (("Blender", "blender_dump.exr"), ("POV-Ray", "povray_dump.exr")):
        parts.append(check_rows(name, check(name, folder / file, options), options.all))
    parts.append(dump_rows(dumps.read(folder / "blender_dump.exr"),
                           dumps.swap_handedness(dumps.read(folder / "povray_dump.exr"))))
    images = [pictures.read(folder / f"{name}.exr") for name in ("blender", "povray")]
    parts.append(picture_rows(*images))

    pictures.write_png(folder / "blender.png", images[0])
    pictures.write_png(folder / "povray.png", images[1])
    pictures.write_png(folder / "difference.png", 10.0 * np.abs(images[0] - images[1]))

    good = all(ok for _, ok in parts)
    text = report.table([options.scene.name, "measured", "limit", ""],
                        [row for rows, _ in parts for row in rows])
    text += f"\n\nVerdict: {'both renderers agree' if good else 'NOT within limits'}.\n"
    whole.write_text(folder / "verdict.txt", text)
    print(f"\n{text}\nPictures: {folder}/blender.png, povray.png, difference.png")
    return 0 if good else 1


if __name__ == "__main__":
    report.run(main)
