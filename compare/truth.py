# SPDX-License-Identifier: Apache-2.0
"""Detail methods against the truth: a normal map against really displaced geometry.

The plate of plate.py, as a displaced mesh rendered by Cycles, is the truth. Our
engine renders it flat with a normal map, once per detail method; so does
Cycles, with its own Normal Map node. The error is the mean absolute difference
over the mean of the truth.

Leaves in the output folder: truth.json, strip.png (the pictures side by side),
chart.png (the errors). Exit status 0 if `rotate` is within its limit, else 1.
"""
import argparse
import json
import os
from pathlib import Path

import pictures
import plate
import programs
import report

LIMIT = 0.02
METHODS = ("none", "perturb", "gram_schmidt", "rotate")
CYCLES = "Cycles' normal map"


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=512, help="pixels along a side (default 512)")
    parser.add_argument("--samples", type=int, default=256, help="per pixel (default 256)")
    parser.add_argument("--quads", type=int, default=800,
                        help="quads along a side of the displaced mesh (default 800)")
    parser.add_argument("--map", type=int, default=2048, help="texels along a side (default 2048)")
    parser.add_argument("--output", type=Path, default=programs.BUILD / "compare" / "truth",
                        help="folder for results (default build/compare/truth)")
    return parser.parse_args(argv)


def render(options):
    """{name: picture}; the truth is called "displaced"."""
    folder = options.output
    common = {"size": options.size, "samples": options.samples, "quads": options.quads, "repeat": 0}
    jobs = {
        "displaced": {"engine": "CYCLES", "surface": "displaced"},
        CYCLES: {"engine": "CYCLES", "surface": "bumped"},
        **{m: {"engine": "LIBSHADE", "surface": "bumped", "detail": m} for m in METHODS},
    }
    for number, job in enumerate(jobs.values()):
        job.update(common, output=str(folder / f"{number}.exr"))
    pictures.write_float(folder / "normals.exr", plate.normal_map(options.map))
    order = {"normal_map": str(folder / "normals.exr"), "result": str(folder / "seconds.json"),
             "jobs": list(jobs.values())}
    (folder / "jobs.json").write_text(json.dumps(order), encoding="utf-8")
    for job in jobs.values():
        Path(job["output"]).unlink(missing_ok=True)
    report.step(
        f"Rendering the plate {len(jobs)} times in Blender",
        programs.blender(programs.HERE / "plate_render.py", folder / "jobs.json"),
        folder / "blender.log", programs.ADD_ON,
    )
    return {name: pictures.read(job["output"]) for name, job in jobs.items()}


def errors(images):
    truth = images["displaced"]
    return {name: pictures.relative_difference(image, truth)
            for name, image in images.items() if name != "displaced"}


def pyplot(folder):
    """matplotlib without a window and without files in the user's home."""
    os.environ.setdefault("MPLCONFIGDIR", str(folder))
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    return plt


def label(name):
    return {"displaced": "displaced mesh (truth)"}.get(name, name.replace("_", "-"))


def write_strip(images, measured, path):
    """The pictures side by side, each with its error."""
    order = ["displaced", "rotate", "gram_schmidt", CYCLES, "perturb"]
    # Bright enough to see the lobe's skirts; its peak is far beyond white.
    scale = 0.5 / images["displaced"].mean()
    figure, axes = pyplot(path.parent).subplots(1, len(order), figsize=(3 * len(order), 3.3),
                                                layout="constrained")
    for name, axis in zip(order, axes):
        axis.imshow(pictures.encode(scale * images[name]), interpolation="none")
        error = f": {measured[name]:.4f}" if name in measured else ""
        axis.set_title(label(name) + error, fontsize=10)
        axis.set_axis_off()
    figure.savefig(path, dpi=150)


def write_chart(measured, path):
    figure, axes = pyplot(path.parent).subplots(figsize=(7, 3), layout="constrained")
    names = sorted(measured, key=measured.get, reverse=True)
    values = [measured[name] for name in names]
    bars = axes.barh([label(n) for n in names], values,
                     color=["#2a6f97" if n in METHODS else "#c8553d" for n in names])
    axes.bar_label(bars, [f" {v:.4f}" for v in values])
    axes.axvline(LIMIT, color="black", linestyle=":", linewidth=1)
    axes.set_xscale("log")
    axes.set_xlim(min(values) / 3.0, 4.0 * max(values))
    axes.set_xlabel("mean absolute error / mean, against the displaced plate (dotted: limit)")
    figure.savefig(path, dpi=120)


def main(argv=None):
    options = arguments(argv)
    options.output = options.output.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    images = render(options)
    measured = errors(images)
    write_strip(images, measured, options.output / "strip.png")
    write_chart(measured, options.output / "chart.png")
    ok = measured["rotate"] <= LIMIT
    result = {"errors": measured, "limit": LIMIT, "ok": ok, "size": options.size,
              "samples": options.samples, "quads": options.quads, "map": options.map}
    (options.output / "truth.json").write_text(json.dumps(result, indent=1), encoding="utf-8")
    print()
    print(report.table(
        ["normal map against displaced plate", "error", "limit", ""],
        [[label(name), f"{value:.4f}", f"{LIMIT}" if name == "rotate" else "",
          ("ok" if ok else "MISSED") if name == "rotate" else ""]
         for name, value in measured.items()],
    ))
    print(f"\nPictures and figures: {options.output}")
    return 0 if ok else 1


if __name__ == "__main__":
    report.run(main)
