# SPDX-License-Identifier: Apache-2.0
"""Whole pictures: seconds a frame against error, on the bumped plate, in our engine, Cycles and POV-Ray.

The truth is the plate of plate.py really displaced, rendered by Cycles with many samples. Only the full
report has this study: it renders for minutes.
"""
import json
import time

import numpy as np

import fronts
import paths
import pictures
import plate
import programs
import report
import style
import whole
from study import Figure, Finding, Table, Task

NAME = "frames"
TITLE = "Whole pictures: seconds a frame against error"
INTRO = ("The plate of sinusoidal bumps, slope 0.6, 512 × 512 pixels, with its bumps as a normal map. The truth is the "
         "same plate as a displaced mesh of 1.28 million triangles, rendered by Cycles with 256 samples a pixel, or "
         "1024 under the sky. Under a sun the error is the mean absolute difference over the mean of the truth; under a drawn studio's sky, with "
         "up to 4 bounces, that of means over 4 × 4 pixels. Seconds are those of the whole render, from the scene in "
         "memory to the picture (POV-Ray: from its file), the median of turns.")
SIZE, REPEAT, QUADS = 512, 3, 800
TRUTH = {"sun": 256, "sky": 1024}  # samples a pixel
LIGHTS = {"sun": "under a sun", "sky": "under a studio's sky"}
ENGINES = {"cycles": "Cycles' normal map", "libshade": "libshade, rotate", "gram_schmidt": "libshade, Gram-Schmidt",
           "perturb": "libshade, perturb", "povray": "POV-Ray, rotate"}
SAMPLES = {"sun": (4, 16, 64), "sky": (16, 64, 256)}


def error(picture, truth, light):
    if light == "sky":
        picture, truth = paths.blocks(picture), paths.blocks(truth)
    return pictures.relative_difference(picture, truth)


def blender(light):
    def run(folder, say):
        say("Blender")
        pictures.write_float(folder / "normals.exr", plate.normal_map(2048))
        common = {"size": SIZE, "quads": QUADS}
        if light == "sky":
            pictures.write_float(folder / "sky.exr", paths.studio())
            common["sky"] = str(folder / "sky.exr")
        jobs = {("displaced", 0): {"engine": "CYCLES", "surface": "displaced", "samples": TRUTH[light],
                                   "repeat": 0, "seed": 7}}
        for samples in SAMPLES[light]:
            jobs["cycles", samples] = {"engine": "CYCLES", "surface": "bumped"}
            for detail in ("rotate", "gram_schmidt", "perturb"):
                name = "libshade" if detail == "rotate" else detail
                jobs[name, samples] = {"engine": "LIBSHADE", "surface": "bumped", "detail": detail}
        for number, ((_name, samples), job) in enumerate(jobs.items()):
            job.update({"samples": samples, "repeat": REPEAT, **common, **job, "output": str(folder / f"{number}.exr")})
        whole.write_text(folder / "jobs.json", json.dumps(
            {"normal_map": str(folder / "normals.exr"), "mesh": "", "result": str(folder / "seconds.json"),
             "jobs": list(jobs.values())}))
        report.step("in Blender", programs.blender(programs.HERE / "plate_render.py", folder / "jobs.json"),
                    folder / "blender.log", programs.ADD_ON)
        said = json.loads((folder / "seconds.json").read_text(encoding="utf-8"))
        seen = {name: pictures.read(job["output"]) for name, job in jobs.items()}
        truth, rows = seen["displaced", 0], []
        for (name, samples), seconds in zip(jobs, said["seconds"]):
            if name != "displaced":
                rows += [{"light": light, "engine": name, "samples": samples, "run": k, "seconds": s,
                          "error": error(seen[name, samples], truth, light), "blender": said["blender"]}
                         for k, s in enumerate(seconds)]
        if light == "sun":
            rows += povray(folder, truth, say)
        return rows
    return run


SCENE = """#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level 2 }}
camera {{ orthographic location <0, 0, -2> right x up y direction z }}
light_source {{ <{0:.9f}, {1:.9f}, {2:.9f}> * 100 rgb 1 parallel point_at 0 }}
mesh2 {{
  vertex_vectors {{ 4, <-.5, -.5, 0>, <.5, -.5, 0>, <.5, .5, 0>, <-.5, .5, 0> }}
  uv_vectors {{ 4, <0, 0>, <1, 0>, <1, 1>, <0, 1> }}
  face_indices {{ 2, <0, 1, 2>, <0, 2, 3> }}
  uv_mapping
  texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{
    ashikhmin_shirley {3:.9g}, {4:.9g} specular rgb 1 detail rotate fresnel none horizon hard tangent uv
    bump_image {{ exr "normals.exr" }} }} }} }}
}}
"""


def povray(folder, truth, say):
    """Rows of POV-Ray's picture, which is made as bright as the truth: its lamp has no units. Samples
    are a larger picture's, averaged: its own anti-aliasing is not the box that the others filter by."""
    say("POV-Ray")
    sun = plate.SUN
    whole.write_text(folder / "plate.pov", SCENE.format(sun[0], sun[1], -sun[2], plate.EX, plate.EY))
    rows = []
    for side in (1, 2, 4):
        seconds = []
        for _turn in range(REPEAT):
            begun = time.perf_counter()
            report.step("in POV-Ray", [programs.POVRAY, "plate.pov", "+Opovray.exr", "+FE", f"+W{SIZE * side}",
                                       f"+H{SIZE * side}", "-D", "-A"], folder / "povray.log", folder=folder)
            seconds.append(time.perf_counter() - begun)
        picture = paths.blocks(pictures.read(folder / "povray.exr"), side)
        off = error(picture * (truth.mean() / picture.mean()), truth, "sun")
        rows += [{"light": "sun", "engine": "povray", "samples": side * side, "run": k, "seconds": s, "error": off}
                 for k, s in enumerate(seconds)]
    return rows


def tasks(quick):
    if quick:
        return []
    needs = (programs.POVRAY, programs.BUILD / "libshade-blender.zip")
    return [Task(f"plate-{light}", {"sun": 240, "sky": 420}[light], blender(light), "", needs) for light in LIGHTS]


def points(rows, light):
    found = []
    for engine in ENGINES:
        for samples in sorted({r["samples"] for r in rows if r["light"] == light and r["engine"] == engine}):
            mine = sorted(fronts.pick(rows, light=light, engine=engine, samples=samples), key=lambda r: r["run"])
            found.append((samples, fronts.Point(engine, [1e9 * r["seconds"] for r in mine], mine[0]["error"])))
    return found


def best(rows, light, engine):
    return min((p for _s, p in points(rows, light) if p.word == engine), key=lambda p: p.error)


def findings(rows):
    told = []
    for light in dict.fromkeys(r["light"] for r in rows):
        ours, theirs = best(rows, light, "libshade"), best(rows, light, "cycles")
        at = max(SAMPLES[light])
        ratio = fronts.ratio(*([r["seconds"] for r in fronts.pick(rows, light=light, engine=e, samples=at)]
                               for e in ("cycles", "libshade")))[0]
        told.append(Finding(f"On the plate {LIGHTS[light]} our engine is {ours.error:.3f} from the displaced truth, Cycles "
                            f"with its normal map {theirs.error:.3f}; {at} samples a pixel take Cycles {ratio:.1f} times "
                            "as long.", ours.error < theirs.error and ratio > 1, "plate", timed=True))
    if fronts.pick(rows, engine="povray"):
        pov = best(rows, "sun", "povray")
        told.append(Finding(f"POV-Ray with libshade is {pov.error:.3f} from it, in {pov.ns / 1e9:.1f} s.",
                            pov.error < best(rows, "sun", "cycles").error, "plate"))
    return told


def figures(rows):
    panels = []
    for light in dict.fromkeys(r["light"] for r in rows):
        panel, axes = style.figure(400, 300)
        found, ends = points(rows, light), []
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
            axes.errorbar(xs, ys, xerr=bars, **{**look.bars, "linestyle": "-"})
            ends.append((xs[-1], ys[-1], engine))
        low, high = axes.get_xlim()
        axes.set_xlim(low, high * (high / low) ** 0.35)
        style.log_ticks(axes.xaxis)
        style.log_ticks(axes.yaxis)
        axes.set_xlabel("seconds a frame, two cores")
        axes.set_ylabel("error against the displaced plate")
        style.labels(axes, ends)
        panels.append(style.svg(panel))
    if not panels:
        return []
    return [Figure("plate", "Seconds against error, by samples a pixel",
                   "Each line joins a renderer's counts of samples a pixel, fewest on the left; bars: the middle half of "
                   "its turns. `build/venv/bin/python compare/report_page.py --only frames`", "\n".join(panels),
                   "Seconds against error of each renderer. Lines of libshade with rotate end lowest and to the left; "
                   "Cycles' normal map stays high however many samples it takes.")]


def tables(rows):
    lines = [[LIGHTS[light], ENGINES[p.word], samples, p.ns / 1e9,
              f"{p.bar[0] / 1e9:.2f} to {p.bar[1] / 1e9:.2f}", p.error]
             for light in dict.fromkeys(r["light"] for r in rows) for samples, p in points(rows, light)]
    return [Table("numbers", "Whole pictures", "Two cores; errors over the mean of the truth.",
                  ["light", "renderer", "samples", "seconds", "middle half", "error"], lines)] if lines else []
