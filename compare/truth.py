# SPDX-License-Identifier: Apache-2.0
"""Detail methods against the truth: a normal map against really displaced geometry.

The plate of plate.py, as a displaced mesh rendered by Cycles, is the truth. Our
engine renders it flat with a normal map, once per detail method; so does
Cycles, with its own Normal Map node. The error is the mean absolute difference
over the mean of the truth.

That Cycles' own Anisotropic BSDF, whose grooves follow bumps in our engine, is within a limit of
its own is checked as well.

With --light sky pictures of the sky take the sun's place, a drawn studio and those that come with
Blender, or the files of --sky; light goes up to 4 bounces, and the error is that of means over 4 x 4
pixels: noise is no difference. The displaced plate is rendered twice and its pictures' mean is the
truth: half their difference is its noise. Real bumps hide some of the sky and reflect each other,
each place in its own way; "of the normal alone" is the error of the best picture
that has one colour where the normal is one, found with the truth at hand: no method that knows the
normal and nothing else comes nearer. The exit status asks for less than the error of Cycles, in the
median; what is wanted is a third of it, and whether that is reached is said, and kept in truth.json.

With --surface noise, ridges or letter, or with --eye, the rules of the horizon are compared under skies, `mutual` among
them, whose bumps shade and light each other: round lobes of GGX, bumps as steep as --slope, with up to 12
bounces; --eye is how many degrees the eye stands above the plate. What is of the normal alone is known from above
alone, of waves. The exit status asks that `mutual` be no further off than `valid_estevez`, today's rule, in the median.

With --surface scratches the bumps are a field of `shade scratch`: its height picture
displaces the mesh, whose normals are the mesh's own; its normal picture is the normal map.
The error is then taken off the creases, where pits meet each other and the plate. More
methods are compared, and `rotate` must also be the best of them.

Leaves in the output folder: truth.json, strip.png (the pictures side by side),
chart.png (the errors). Exit status 0 if all limits hold, else 1.
"""
import argparse
import json
import os
import subprocess
from pathlib import Path

import numpy as np

import paths
import pictures
import plate
import programs
import report
import results
import whole

LIMIT = 0.02
MORE = 4  # times the samples, under a sky: our engine's noise costs little to take away
STOCK_LIMIT = 0.01
METHODS = ("none", "perturb", "gram_schmidt", "rotate")
SCRATCH_METHODS = ("none", "perturb", "deform_linear", "deform_smooth", "shortest_arc",
                   "gram_schmidt", "rotate")
CYCLES = "Cycles' normal map"
STOCK = "Cycles' Anisotropic, here"


def arguments(argv=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--surface", choices=("waves", "scratches", "noise", "ridges", "letter"), default="waves",
                        help="what is bumped (default waves)")
    parser.add_argument("--eye", type=float, help="degrees above the plate, 15 to 90 (default 90)")
    parser.add_argument("--slope", type=float, default=1.0,
                        help="of --surface noise, ridges and letter and with --eye: of the bumps, 0.1 to 2 (default 1)")
    parser.add_argument("--light", choices=("sun", "sky"), default="sun",
                        help="what lights it (default sun)")
    parser.add_argument("--sky", type=Path, action="append",
                        help="with --light sky: this picture alone, or these")
    parser.add_argument("--size", type=int,
                        help="pixels along a side (default 512, under a sky 256)")
    parser.add_argument("--samples", type=int, default=256, help="per pixel (default 256)")
    parser.add_argument("--quads", type=int, default=800,
                        help="quads along a side of the displaced mesh (default 800)")
    parser.add_argument("--map", type=int, default=2048, help="texels along a side (default 2048)")
    parser.add_argument("--results", action="store_true", help="rewrite docs/results/, as make compare does")
    parser.add_argument("--output", type=Path,
                        help="folder for results (default build/compare/truth, or "
                             "build/compare/truth-scratches, build/compare/truth-sky)")
    options = parser.parse_args(argv)
    options.horizons = options.surface in ("noise", "ridges", "letter") or options.eye is not None
    options.eye = 90.0 if options.eye is None else options.eye
    if not (15 <= options.eye <= 90 and 0.1 <= options.slope <= 2):
        parser.error("--eye wants 15 to 90 degrees, --slope 0.1 to 2")
    if options.horizons:
        if options.surface == "scratches":
            parser.error("--eye is for waves, noise, ridges and letter")
        options.light = "sky"
    if options.size is None:
        options.size = 256 if options.light == "sky" else 512
    tile = 4 * 4 * plate.PERIODS
    if options.light == "sky" and (options.surface == "scratches" or options.size < 1
                                   or options.size % tile):
        parser.error(f"--light sky is not for --surface scratches, and for a --size that is a multiple of {tile}")
    if options.sky and options.light != "sky":
        parser.error("--sky is for --light sky")
    for sky in options.sky or ():
        if not sky.is_file():
            parser.error(f"{sky}: no such file")
    if options.output is None:
        name = f"truth-{options.surface}-{options.eye:g}-{options.slope:g}" if options.horizons else \
            "truth-sky" if options.light == "sky" else \
            "truth" if options.surface == "waves" else "truth-scratches"
        options.output = programs.BUILD / "compare" / name
    return options


HORIZONS = ("hard", "valid_estevez", "schuessler", "mutual")
BEFORE = "valid_estevez"
ROUND = (0.2**0.5, 0.0)  # roughness and anisotropy of alphas of .2
BOUNCES = 12  # where bumps see each other


def methods(options):
    if options.light == "sky":
        return ("rotate",)
    return METHODS if options.surface == "waves" else SCRATCH_METHODS


def scratch(*arguments):
    done = subprocess.run([programs.SHADE, "scratch", *plate.SCRATCHES, *map(str, arguments)],
                          stderr=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(done.stderr.strip())


def save_mesh(path, positions, faces, uv):
    with whole.place(path) as part:
        np.savez(part, positions=positions, faces=faces, uv=uv)


def tiles(options):
    """How many plates in a row fill the picture of an eye that stands aslant, and what bumps hide of them."""
    return 1 if options.eye == 90 else 2 * int(np.ceil((1 / np.sin(np.radians(options.eye)) + 0.5) / 2)) + 1


def prepare(options):
    """Write the normal map, and the mesh where it is a field of scratches; the order's part."""
    folder = options.output
    order = {"normal_map": str(folder / "normals.exr"), "mesh": ""}
    if options.horizons:
        pictures.write_float(order["normal_map"], plate.relief_map(options.surface, options.slope, options.map))
        order["mesh"] = str(folder / "mesh.npz")
        save_mesh(order["mesh"], *plate.relief_mesh(options.surface, options.slope, options.quads, tiles(options)))
        return order
    if options.surface == "waves":
        pictures.write_float(order["normal_map"], plate.normal_map(options.map))
        return order
    scratch("-o", order["normal_map"], "--size", options.map)
    scratch("--height", folder / "height.exr", "--size", options.quads)
    positions, faces, uv = plate.height_mesh(pictures.read(folder / "height.exr")[..., 0])
    order["mesh"] = str(folder / "mesh.npz")
    save_mesh(order["mesh"], positions, faces, uv)
    return order


def run(options, jobs):
    """Pictures of {name: job}; the truth is called "displaced"."""
    folder = options.output
    for number, job in enumerate(jobs.values()):
        ours = job["engine"] == "LIBSHADE" and options.light == "sky"
        job.update(size=options.size, samples=options.samples * (MORE if ours else 1),
                   quads=options.quads, repeat=0,
                   output=str(folder / f"{number}.exr"))
    order = {**prepare(options), "result": str(folder / "seconds.json"),
             "jobs": list(jobs.values())}
    whole.write_text(folder / "jobs.json", json.dumps(order))
    for job in jobs.values():
        Path(job["output"]).unlink(missing_ok=True)
    report.step(
        f"Rendering the plate {len(jobs)} times in Blender",
        programs.blender(programs.HERE / "plate_render.py", folder / "jobs.json"),
        folder / "blender.log", programs.ADD_ON,
    )
    return {name: pictures.read(job["output"]) for name, job in jobs.items()}


def jobs_of(options):
    if options.horizons:
        shared = {"ggx": ROUND, "bounces": BOUNCES, "eye": options.eye, "tiles": tiles(options), "color": 0.6}
        return {
            "displaced": {"engine": "CYCLES", "surface": "displaced", **shared},
            CYCLES: {"engine": "CYCLES", "surface": "bumped", **shared},
            **{h: {"engine": "LIBSHADE", "surface": "bumped", "detail": "rotate", "horizon": h.upper(), **shared} for h in HORIZONS},
        }
    jobs = {
        "displaced": {"engine": "CYCLES", "surface": "displaced"},
        CYCLES: {"engine": "CYCLES", "surface": "bumped"},
        **{m: {"engine": "LIBSHADE", "surface": "bumped", "detail": m} for m in methods(options)},
    }
    if options.surface == "waves":
        jobs[STOCK] = {"engine": "LIBSHADE", "surface": "bumped"}
    return jobs


def render(options):
    """{name: picture}."""
    return run(options, jobs_of(options))


def skies(options):
    """{name: file}."""
    if options.sky:
        files = [sky.resolve() for sky in options.sky]
        return {str(f) if len({g.stem for g in files}) < len(files) else f.stem: f for f in files}
    drawn = options.output / "sky.exr"
    pictures.write_float(drawn, paths.studio())
    mark = "skies in "
    said = subprocess.run(
        [programs.BLENDER, "-b", "--factory-startup", "--python-expr",
         f"import bpy; print({mark!r} + str(bpy.utils.system_resource('DATAFILES')))"],
        capture_output=True, text=True, check=True).stdout
    data = next(line[len(mark):] for line in said.splitlines() if line.startswith(mark))
    found = sorted(Path(data, "studiolights", "world").glob("*.exr"))
    return {"drawn": drawn, **{file.stem: file for file in found}}


AGAIN = "displaced again"


def render_skies(options):
    """{sky: {name: picture}}."""
    files, jobs = skies(options), {}
    for sky, file in files.items():
        one = jobs_of(options)
        one[AGAIN] = one["displaced"]
        # seeds of their own: noise that pictures have in common would pass for likeness
        jobs.update({(sky, name): {**job, "sky": str(file), "seed": seed}
                     for seed, (name, job) in enumerate(one.items())})
    made = run(options, jobs)
    return {sky: {name: picture for (under, name), picture in made.items() if under == sky}
            for sky in files}


def of_the_normal_alone(picture):
    """The picture nearest to this one that has one colour wherever the plate has one normal."""
    rows = np.stack([picture[v, u] for u, v in plate.same_normals(len(picture))])
    return np.median(rows, axis=0)


def errors(images, where=None):
    """Of every picture, at the pixels `where` (all of them if None)."""
    kept = {name: image if where is None else image[where] for name, image in images.items()}
    return {name: pictures.relative_difference(image, kept["displaced"])
            for name, image in kept.items() if name != "displaced"}


def limits(measured):
    """Largest errors, by name."""
    return {"rotate": LIMIT, **({STOCK: STOCK_LIMIT} if STOCK in measured else {})}


WANTED = 1 / 3  # of Cycles' error, under a sky
NORMAL = "of the normal alone"
NOISE = "noise of the truth"


def errors_under(images, by_normals=True):
    """Of one sky's pictures: {name: error}, with that of the best picture by normals, and noise."""
    images = {name: paths.blocks(image) for name, image in images.items()}
    again = images.pop(AGAIN)
    noise = pictures.relative_difference(again, images["displaced"]) / 2.0
    images["displaced"] = (images["displaced"] + again) / 2.0
    if by_normals:
        images[NORMAL] = of_the_normal_alone(images["displaced"])
    return {**errors(images), NOISE: noise}


def pyplot(folder):
    """matplotlib without a window and without files in the user's home."""
    os.environ.setdefault("MPLCONFIGDIR", str(folder))
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    return plt


def label(name):
    return {"displaced": "displaced mesh (truth)"}.get(name, name.replace("_", "-"))


def write_strip(images, measured, mean, path, names=("displaced", "rotate", "gram_schmidt", CYCLES, "perturb")):
    """The pictures side by side, each with its error; that of the truth as bright as `mean`."""
    order = [name for name in names if name in images]
    scale = mean / images["displaced"].mean()
    figure, axes = pyplot(path.parent).subplots(1, len(order), figsize=(3 * len(order), 3.3),
                                                layout="constrained")
    for name, axis in zip(order, axes):
        axis.imshow(pictures.encode(scale * images[name]), interpolation="none")
        error = f": {measured[name]:.4f}" if name in measured else ""
        axis.set_title(label(name) + error, fontsize=10)
        axis.set_axis_off()
    with whole.place(path) as part:
        figure.savefig(part, dpi=150)


def write_chart(measured, limit, path):
    figure, axes = pyplot(path.parent).subplots(figsize=(7, 3), layout="constrained")
    from matplotlib import ticker  # after pyplot has set where its files go

    names = sorted(measured, key=measured.get, reverse=True)
    values = [measured[name] for name in names]
    bars = axes.barh([label(n) for n in names], values,
                     color=["#c8553d" if n == CYCLES else "#2a6f97" for n in names])
    axes.bar_label(bars, [f" {v:.4f}" for v in values])
    axes.axvline(limit, color="black", linestyle=":", linewidth=1)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    axes.set_xlim(min(values) / 3.0, 4.0 * max(values))
    axes.set_xlabel("mean absolute error / mean, against the displaced plate (dotted: limit)")
    with whole.place(path) as part:
        figure.savefig(part, dpi=120)


def main_horizons(options):
    """The rules of the horizon under skies."""
    pictures_of = render_skies(options)
    floor = (NORMAL,) if options.surface == "waves" and options.eye == 90 else ()
    measured = {sky: errors_under(images, bool(floor)) for sky, images in pictures_of.items()}
    median = {name: float(np.median([one[name] for one in measured.values()])) for name in next(iter(measured.values()))}
    worse = [sky for sky, one in measured.items() if one["mutual"] > one[BEFORE] + one[NOISE]]
    dark = {name: float(np.mean([images[name].max(-1) < 0.05 * images["displaced"].mean() for images in pictures_of.values()]))
            for name in ("displaced", CYCLES, *HORIZONS)}
    bright = {name: float(np.mean([images[name].mean() / images["displaced"].mean() for images in pictures_of.values()]))
              for name in (CYCLES, *HORIZONS)}
    ok = median["mutual"] <= median[BEFORE]
    first = next(iter(pictures_of))
    write_strip(pictures_of[first], measured[first], 0.2, options.output / "strip.png", ("displaced", BEFORE, "mutual", CYCLES))
    whole.write_text(options.output / "truth.json", json.dumps(
        {"skies": measured, "errors": median, "worse": worse, "dark": dark, "brightness": bright, "ok": ok, "size": options.size,
         "samples": options.samples, "quads": options.quads, "surface": options.surface, "eye": options.eye, "slope": options.slope}, indent=1))
    names = [*HORIZONS, CYCLES, *floor, NOISE]
    print()
    print(report.table([f"{options.surface}, slope {options.slope:g}, eye at {options.eye:g} degrees, under", *map(label, names)],
                       [[sky, *(f"{one[name]:.4f}" for name in names)] for sky, one in [*measured.items(), ("median", median)]]
                       + [[what, *(f"{of[name]:.4f}" if name in of else "" for name in names)]
                          for what, of in (("brightness over the truth's", bright), ("dark pixels", dark))]))
    print(f"\n`mutual` is further off than {label(BEFORE)}, by more than the noise, under: {', '.join(worse) or 'none'}"
          + ("" if ok else f"\nMISSED: further off than {label(BEFORE)} in the median."))
    print(f"\nPictures and figures: {options.output}")
    return 0 if ok else 1


def main_sky(options):
    pictures_of = render_skies(options)
    measured = {sky: errors_under(images) for sky, images in pictures_of.items()}
    ours = ("rotate", STOCK)
    parts = {sky: {name: one[name] / one[CYCLES] for name in (*ours, NORMAL)}
             for sky, one in measured.items()}
    median = {name: float(np.median([one[name] for one in measured.values()]))
              for name in next(iter(measured.values()))}
    median_parts = {name: float(np.median([one[name] for one in parts.values()]))
                    for name in (*ours, NORMAL)}
    ok = all(median_parts[name] < 1.0 for name in ours)
    wanted = all(median_parts[name] <= WANTED for name in ours)
    first = next(iter(pictures_of))
    write_strip({name: image for name, image in pictures_of[first].items() if name != AGAIN},
                measured[first], 0.2, options.output / "strip.png")
    write_chart({name: median[name] for name in (CYCLES, *ours, NORMAL)},
                WANTED * median[CYCLES], options.output / "chart.png")
    whole.write_text(options.output / "truth.json", json.dumps(
        {"skies": measured, "errors": median, "beside_cycles": median_parts, "wanted": wanted,
         "ok": ok, "size": options.size, "samples": options.samples, "quads": options.quads,
         "map": options.map, "surface": options.surface, "light": options.light}, indent=1))
    print()

    def row(name, one, part):
        return [name, f"{one[CYCLES]:.4f}",
                *(f"{one[of]:.4f} ({part[of]:.2f})" for of in (*ours, NORMAL)),
                f"{one[NOISE]:.4f}"]

    print(report.table(
        ["normal map against displaced plate, under", CYCLES, *map(label, ours), NORMAL, NOISE],
        [*(row(sky, measured[sky], parts[sky]) for sky in measured),
         row("median", median, median_parts)]))
    if options.results:
        results.write("displaced-sky", results.surroundings("make compare"),
                      ["sky", CYCLES, *(f"{label(of)}{more}" for of in (*ours, NORMAL) for more in ("", ", over Cycles'")), NOISE],
                      [[sky, one[CYCLES], *(value for of in (*ours, NORMAL) for value in (one[of], part[of])), one[NOISE]]
                       for sky, one, part in [*((sky, measured[sky], parts[sky]) for sky in measured),
                                              ("median", median, median_parts)]])
    print(f"\nIn brackets, of Cycles' error. Wanted, at most {WANTED:.2f} in the median: "
          f"{'reached' if wanted else 'not reached'}."
          + ("" if ok else f" MISSED: no less than {CYCLES}."))
    print(f"\nPictures and figures: {options.output}")
    return 0 if ok else 1


def main(argv=None):
    options = arguments(argv)
    options.output = options.output.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    if options.horizons:
        return main_horizons(options)
    if options.light == "sky":
        return main_sky(options)
    images = render(options)
    where, compared = None, 1.0
    if options.surface == "scratches":
        where = plate.off_creases(pictures.read(options.output / "normals.exr"), options.size)
        compared = float(where.mean())
        if not where.any():
            raise ValueError(f"{options.output / 'normals.exr'}: no pixel lies off the creases")
    measured = errors(images, where)
    limit = limits(measured)
    ok = {name: measured[name] < most for name, most in limit.items()}
    ok["rotate"] &= min((name for name in measured if name != STOCK), key=measured.get) == "rotate"
    # Under a sun bright enough to see the lobe's skirts; its peak is far beyond white.
    write_strip(images, measured, 0.5, options.output / "strip.png")
    write_chart(measured, limit["rotate"], options.output / "chart.png")
    result = {"errors": measured, "limits": limit, "ok": all(ok.values()), "size": options.size,
              "samples": options.samples, "quads": options.quads, "map": options.map,
              "surface": options.surface, "light": options.light, "compared": compared}
    whole.write_text(options.output / "truth.json", json.dumps(result, indent=1))
    print()
    print(report.table(
        ["normal map against displaced plate", "error", "limit", ""],
        [[label(name), f"{value:.4f}", f"{limit[name]:.4g}" if name in limit else "",
          ("ok" if ok[name] else "MISSED") if name in limit else ""]
         for name, value in measured.items()],
    ))
    if options.results:
        results.write(f"displaced-{options.surface}", results.surroundings("make compare"), ["method", "error", "limit"],
                      [[label(name), value, limit.get(name)] for name, value in measured.items()])
    if where is not None:
        print(f"\nOff the creases: {100 * compared:.0f} % of the picture.")
    print(f"\nPictures and figures: {options.output}")
    return 0 if result["ok"] else 1


if __name__ == "__main__":
    report.run(main)
