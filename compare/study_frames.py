# SPDX-License-Identifier: Apache-2.0
"""Whole pictures: seconds a frame against error, on the bumped plate and a scratched sphere, in five renderers.

The truth is each surface really displaced, rendered by Cycles with many samples; it is kept, since it does not
depend on the library. Only the full report has this study: it renders for minutes (study.py).
"""
import functools
import hashlib
import json
import subprocess

import numpy as np

import frames_povray
import fronts
import gallery
import paths
import pictures
import plate
import plate_jobs
import programs
import sheet
import sphere
import study_peers as peers
import style
import whole
from sheet import percent
from study import Figure, Finding, Table, Task

NAME = "frames"
TITLE = "Whole pictures: seconds a frame against error"
INTRO = (
    "GGX with alphas 0.05 and 0.3 on a plate of sinusoidal bumps, slope 0.6, and on a sphere with 60 scratches, each with "
    "its relief as a normal map. The truth is the same surface as a displaced mesh of more than a million triangles, "
    "rendered by Cycles 3.4. Pictures are 512 × 512 under a sun and 256 × 256 under a drawn studio's sky, with up to 4 "
    "bounces. The error is the mean absolute difference over the mean of the truth: of the plate under the sun pixel by "
    "pixel, else of means over blocks, 4 × 4 under the sky and 8 × 8 of the sphere under the sun, within 95 % of its "
    "radius: a displaced scratch is seen beside where its normal map has it, and that no map can follow. Seconds are those of the whole render, from the "
    "scene in memory to the picture (POV-Ray: from its file), the median of turns. POV-Ray has no light of a sky for these "
    "lobes.")
LIGHTS = {"sun": "under a sun", "sky": "under a studio's sky"}
SHAPES = {"plate": "the plate", "sphere": "the sphere"}
SCENES = [(shape, light) for shape in SHAPES for light in LIGHTS]
SIZE = {"sun": 512, "sky": 256}  # pixels along a side
QUADS = {"plate": 800, "sphere": 1000}
BLOCK = {("plate", "sun"): 1, ("plate", "sky"): 4, ("sphere", "sun"): 8, ("sphere", "sky"): 4}  # pixels along a side
SAMPLES = {"sun": (4, 16, 64), "sky": (16, 64, 256)}  # a pixel
TRUTH = {"sun": 128, "sky": 512}  # of each of two pictures, whose mean is the truth
REPEAT = 3
ENGINES = {"libshade": "libshade, rotate", "gram_schmidt": "libshade, Gram-Schmidt", "perturb": "libshade, perturb",
           "cycles": "Cycles 3.4's normal map", "cycles_5": "Cycles 5.0's normal map",
           "mitsuba": "Mitsuba 3's normal map", "povray": "POV-Ray, rotate"}
NORMAL_MAPS = ("cycles", "cycles_5", "mitsuba")  # of other renderers


# ---- the work ------------------------------------------------------------------------------------


def judged(picture, shape, light):
    """The values that are compared, shape (number, 3)."""
    side = BLOCK[shape, light]
    mask = sphere.judged(len(picture)) if shape == "sphere" else np.ones(picture.shape[:2], bool)
    within = paths.blocks(np.repeat(mask[..., None], 3, -1).astype(float), side)[..., 0] == 1
    return paths.blocks(picture, side)[within]


def error(picture, truth, shape, light):
    return pictures.relative_difference(judged(picture, shape, light), judged(truth, shape, light))


@functools.lru_cache(1)
def normals_of(shape):
    return plate.normal_map(2048) if shape == "plate" else sphere.normal_map(1536)


def job_of(engine, shape, light, sky, samples, **more):
    job = {"engine": "CYCLES" if engine.startswith("cycles") else "LIBSHADE", "shape": shape, "surface": "bumped",
           "ggx": (peers.ROUGHNESS, peers.ANISOTROPY), "size": SIZE[light], "quads": QUADS[shape], "samples": samples,
           "repeat": REPEAT, "seed": 1, **({"sky": sky} if light == "sky" else {}), **more}
    if job["engine"] == "LIBSHADE":
        job["detail"] = "rotate" if engine == "libshade" else engine
    return job


def truth(shape, light, sky, folder, say):
    """(picture, its own noise): the mean of two renders, and half their difference; kept until what makes it changes."""
    jobs = {f"truth-{seed}": job_of("cycles", shape, light, sky and "sky", TRUTH[light], surface="displaced", repeat=0,
                                    seed=seed) for seed in (7, 8)}
    digest = hashlib.sha256(json.dumps(jobs).encode())
    for name in ("plate.py", "sphere.py", "plate_render.py", "paths.py"):
        digest.update((programs.HERE / name).read_bytes())
    said = subprocess.run([programs.BLENDER, "--version"], capture_output=True, check=False).stdout
    digest.update(said.splitlines()[0] if said else b"")
    mark = folder / "truth.txt"
    if not (mark.is_file() and mark.read_text(encoding="utf-8") == digest.hexdigest()):
        say("the truth")
        for name, job in jobs.items():
            job.update(output=str(folder / f"{name}.exr"), **({"sky": sky} if sky else {}))
        plate_jobs.run(folder, jobs, normals=normals_of(shape))
        whole.write_text(mark, digest.hexdigest())
    halves = [pictures.read(folder / f"{name}.exr") for name in jobs]
    return sum(halves) / 2, error(*halves, shape, light) / 2


def in_blender(engines, shape, light, sky, folder, python=None):
    """{(engine, samples): (picture, seconds of each turn, version)}; methods but for the first at the most samples."""
    jobs = {(engine, samples): job_of(engine, shape, light, sky, samples, output=str(folder / f"{engine}-{samples}.exr"))
            for engine in engines for samples in (SAMPLES[light][-1:] if engine in ("gram_schmidt", "perturb")
                                                  else SAMPLES[light])}
    made, seconds, version = plate_jobs.run(folder, jobs, python=python, normals=normals_of(shape))
    return {key: (made[key], seconds[key], version) for key in jobs}


def in_mitsuba(shape, light, sky, folder):
    jobs = {("mitsuba", samples): job_of("mitsuba", shape, light, sky, samples) for samples in SAMPLES[light]}
    made, seconds, version = peers.run_mitsuba(folder, jobs, normals_of(shape))
    return {key: (made[key], seconds[key], version) for key in jobs}


def there():
    """{engine that is not always there: whether it is}."""
    return {"cycles_5": peers.BPY.is_file(), "mitsuba": peers.ready()}


def frames(shape, light):
    def run(folder, say):
        sky = None
        if light == "sky":
            sky = str(folder / "sky.exr")
            pictures.write_float(sky, paths.studio())
            np.save(folder / "sky.npy", paths.studio())
        true, noise = truth(shape, light, sky, folder, say)
        say("Blender 3.4")
        made = in_blender(("libshade", "cycles", "gram_schmidt", "perturb"), shape, light, sky, folder)
        rows = [{"kind": "missing", "shape": shape, "light": light, "engine": engine}
                for engine, is_there in there().items() if not is_there]
        if there()["cycles_5"]:
            say("Blender 5.0")
            made.update(in_blender(("cycles_5",), shape, light, sky, folder, peers.BPY))
        if there()["mitsuba"]:
            say("Mitsuba")
            made.update(in_mitsuba(shape, light, sky and str(folder / "sky.npy"), folder))
        if light == "sun":
            say("POV-Ray")
            made.update({("povray", side * side): result for side, result in frames_povray.run(
                folder, shape, SIZE[light], peers.ALPHAS, (1, 2, 4), REPEAT).items()})
        for (engine, samples), (picture, seconds, version) in made.items():
            off = error(picture, true, shape, light)
            rows += [{"kind": "frame", "shape": shape, "light": light, "engine": engine, "samples": samples, "run": k,
                      "seconds": s, "error": off, "noise": noise, "version": version} for k, s in enumerate(seconds)]
        return rows + tiles(folder, shape, light, true, made)
    return run


def tiles(folder, shape, light, true, made):
    """The pictures of the most samples beside the truth; what made them is removed, but for the truth's own."""
    white = float(np.percentile(true, 98)) if light == "sun" else 2.5 * float(true[true > 0].mean())
    kept = {engine: picture for (engine, _samples), (picture, _seconds, _version) in made.items()}
    side = SIZE[light] // 256
    shown = [("displaced: the truth", sheet.grey(paths.blocks(true, side), white))]
    shown += [(style.of(engine).label, sheet.grey(paths.blocks(kept[engine], side), white), "error {}",
               error(kept[engine], true, shape, light)) for engine in ENGINES if engine in kept]
    rows = sheet.tiles(folder, f"{shape}-{light}", shown)
    for path in folder.iterdir():
        if path.suffix in (".exr", ".npy", ".ply", ".inc") and not path.name.startswith("truth-"):
            path.unlink()
    return rows


def tasks(quick):
    if quick:
        return []
    needs = (programs.POVRAY, programs.BUILD / "libshade-blender.zip", peers.PEERS.parents[1] / "done",
             peers.BPY.parents[1] / "done")
    return [Task(f"{shape}-{light}", {"sun": 120, "sky": 150}[light], frames(shape, light),
                 "build/venv/bin/python compare/report_page.py --only frames", needs) for shape, light in SCENES]


# ---- what was found --------------------------------------------------------------------------------


def points(rows, shape, light):
    """[(samples, point)] of each engine, in the order of ENGINES."""
    found = []
    frame = fronts.pick(rows, kind="frame", shape=shape, light=light)
    for engine in ENGINES:
        for samples in sorted({r["samples"] for r in frame if r["engine"] == engine}):
            mine = sorted(fronts.pick(frame, engine=engine, samples=samples), key=lambda r: r["run"])
            found.append((samples, fronts.Point(engine, [time_of(r) for r in mine], mine[0]["error"])))
    return found


def time_of(row):
    """In ns, as fronts has times."""
    return 1e9 * row["seconds"]


def best(rows, shape, light, engine):
    return min((p.error for _s, p in points(rows, shape, light) if p.word == engine), default=float("inf"))


def scenes(rows):
    return [scene for scene in SCENES if fronts.pick(rows, kind="frame", shape=scene[0], light=scene[1])]


def finding_error(rows, shape, light):
    ours = best(rows, shape, light, "libshade")
    others = {e: best(rows, shape, light, e) for e in NORMAL_MAPS}
    others = {e: value for e, value in others.items() if value < float("inf")}
    text = (f"On {SHAPES[shape]} {LIGHTS[light]} our picture is {percent(ours)} from the displaced truth, by their normal "
            "maps " + ", ".join(f"{style.of(e).label} {percent(value)}" for e, value in others.items()))
    good = bool(others) and ours < min(others.values())
    if shape == "sphere" and light == "sky" and others:  # light from all sides hides what a detail method does
        good = ours < 1.05 * min(others.values())
        text += " (too near to tell apart)" if abs(ours / min(others.values()) - 1) < 0.05 else ""
    if light == "sun":
        pov = best(rows, shape, light, "povray")
        text += f"; POV-Ray with libshade {percent(pov)}"
        good &= pov < min(others.values(), default=0)
    return Finding(text + ".", good, f"frames-{shape}")


def ratio(rows, shape, light, engine):
    """Seconds of an engine over ours at the most samples, turn by turn."""
    at = fronts.pick(rows, kind="frame", shape=shape, light=light, samples=max(SAMPLES[light]))
    return fronts.ratio(*([r["seconds"] for r in sorted(fronts.pick(at, engine=e), key=lambda r: r["run"])]
                          for e in (engine, "libshade")))[0]


def finding_time(rows):
    """The other engines that have Blender's scene; Mitsuba's time is in the table."""
    engines = [e for e in ("cycles", "cycles_5") if fronts.pick(rows, kind="frame", engine=e)]
    found = {e: [ratio(rows, *scene, e) for scene in scenes(rows)] for e in engines}
    return Finding(
        "With as many samples " + ", ".join(
            f"{style.of(e).label} takes {min(v):.1f} to {max(v):.1f} times as long as our engine" for e, v in found.items())
        + ".", bool(found) and min(map(min, found.values())) > 1, "numbers", timed=True)


def finding_noise(rows):
    frame = fronts.pick(rows, kind="frame")
    worst = max(frame, key=lambda r: r["noise"] / best(rows, r["shape"], r["light"], "libshade"))
    most = worst["noise"] / best(rows, worst["shape"], worst["light"], "libshade")
    return Finding(
        f"The truth's own noise is {percent(min(r['noise'] for r in frame))} to {percent(max(r['noise'] for r in frame))}, at "
        f"most {most:.2f} of our smallest error there ({SHAPES[worst['shape']]} {LIGHTS[worst['light']]}).", most < 0.5,
        "numbers")


def findings(rows):
    if not fronts.pick(rows, kind="frame"):
        return []
    return [*(finding_error(rows, *scene) for scene in scenes(rows)), finding_time(rows), finding_noise(rows)]


def chart(rows, shape, light):
    panel, axes = style.figure(360, 290)
    found, ends, lines = points(rows, shape, light), [], []
    axes.set_title(LIGHTS[light])
    axes.set_xscale("log")
    axes.set_yscale("log")
    for engine in ENGINES:
        mine = [p for _s, p in found if p.word == engine]
        if not mine:
            continue
        look = style.of(engine)
        xs, ys = [p.ns / 1e9 for p in mine], [p.error for p in mine]
        bars = np.abs(np.array([[p.bar[0] / 1e9, p.bar[1] / 1e9] for p in mine]).T - xs)
        axes.errorbar(xs, ys, xerr=bars, **{**look.bars, "linestyle": "-" if len(mine) > 1 else "none"})
        ends.append((xs[-1], ys[-1], engine))
        lines.append(list(zip(xs, ys)))
    low, high = axes.get_xlim()
    axes.set_xlim(low, high * (high / low) ** 0.35)
    style.log_ticks(axes.xaxis)
    style.log_ticks(axes.yaxis)
    axes.set_xlabel("seconds a frame, two cores")
    axes.set_ylabel("error against the displaced surface")
    style.labels(axes, ends, lines=lines)
    return style.svg(panel)


def figures(rows):
    made = []
    for shape, words in SHAPES.items():
        lights = [light for of, light in scenes(rows) if of == shape]
        if not lights:
            continue
        made.append(Figure(
            f"frames-{shape}", f"Seconds against error, {words}",
            "Each line joins a renderer's counts of samples a pixel, fewest on the left; bars: the middle half of its turns. "
            "`build/venv/bin/python compare/report_page.py --only frames`",
            "\n".join(chart(rows, shape, light) for light in lights),
            "Seconds against error of each renderer. Lines of libshade with rotate end lowest; normal maps of the other "
            "renderers stay high however many samples they take."))
        for light in lights:
            tiled = gallery.pick(rows, kind="tile", figure=f"{shape}-{light}")
            made.append(Figure(
                f"pictures-{shape}-{light}", f"{words[0].upper()}{words[1:]} {LIGHTS[light]}",
                "The most samples of each renderer. Made by `build/venv/bin/python compare/report_page.py --only frames`.",
                sheet.panels(tiled), "Pictures of the displaced surface and of each renderer's normal map"))
    return made


def tables(rows):
    lines = [[SHAPES[shape], LIGHTS[light], ENGINES[p.word], samples, p.ns / 1e9,
              f"{p.bar[0] / 1e9:.2f} to {p.bar[1] / 1e9:.2f}", 100 * p.error]
             for shape, light in scenes(rows) for samples, p in points(rows, shape, light)]
    if not lines:
        return []
    absent = [ENGINES[e].split("'")[0] for e in dict.fromkeys(r["engine"] for r in fronts.pick(rows, kind="missing"))]
    said = f" Not measured, since not installed: {', '.join(absent)}. `make compare-peers` fetches them." if absent else ""
    versions = dict.fromkeys(str(r["version"]) for r in fronts.pick(rows, kind="frame"))
    return [Table("numbers", "Whole pictures", f"Two cores; errors over the mean of the truth. Versions: "
                  f"{', '.join(versions)}.{said}",
                  ["surface", "light", "renderer", "samples", "seconds", "middle half", "error, %"], lines)]
