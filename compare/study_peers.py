# SPDX-License-Identifier: Apache-2.0
"""Other renderers in one run with ours: Cycles 3.4 and 5.0, Mitsuba 3 (study.py). `make compare-peers`."""
import json
import os

import numpy as np

import paths
import pictures
import plate
import plate_jobs
import programs
import report
import sheet
import style
import whole
from gallery import pick
from sheet import percent
from study import Figure, Finding, Table, Task

NAME, TITLE = "peers", "Beside other renderers"
INTRO = (
    "One bumped plate, GGX with alphas 0.05 and 0.3, slope 0.6, in four renderers: as a normal map on a flat square, and "
    "as a displaced mesh of each renderer's own, which is its own truth. Under a sun, and under a drawn studio's sky by "
    "up to 4 bounces. Times are the median of several renders of the normal-mapped plate, the scene's set-up included as "
    "each program does it (Mitsuba's kernels are compiled before). Noise is relMSE against the same renderer's picture of "
    "many samples; time multiplied by it tells the seconds to an error of 0.001. Measured by `make compare-peers`, which "
    "fetches Mitsuba 3 and Blender 5.0 from PyPI.")

ALPHAS = (0.05, 0.3)
ROUGHNESS, ANISOTROPY = (ALPHAS[0] * ALPHAS[1]) ** 0.25, 1 - (ALPHAS[0] / ALPHAS[1]) ** 0.5
ENGINES = {"libshade": "Blender 3.4 with libshade", "cycles": "Cycles of Blender 3.4", "cycles_5": "Cycles of Blender 5.0",
           "mitsuba": "Mitsuba 3"}
PEERS, BPY = (programs.BUILD / name / "bin" / "python" for name in ("venv-peers", "venv-bpy"))
LLVM = "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1"  # of Debian's libllvm19
TARGET = 1e-3


def ready():
    """Whether `make compare-peers` has set up what it needs."""
    return (programs.BUILD / "venv-peers" / "done").exists()


# ---- the work ------------------------------------------------------------------------------------

SIZES = {"size": 256, "samples": 64, "many": 1024, "repeat": 3, "quads": 1000}


def jobs_of(light, sky, sizes):
    """{part: job} of one renderer: the timed picture, one of many samples, the displaced plate's of many."""
    common = {"size": sizes["size"], "quads": sizes["quads"], **({"sky": sky} if light == "sky" else {})}
    many = {**common, "samples": sizes["many"], "repeat": 0}
    return {"timed": {**common, "surface": "bumped", "samples": sizes["samples"], "repeat": sizes["repeat"], "seed": 1},
            "many": {**many, "surface": "bumped", "seed": 2}, "truth": {**many, "surface": "displaced", "seed": 3}}


def run_blender(engine, folder, jobs):
    for part, job in jobs.items():
        job.update(engine="LIBSHADE" if engine == "libshade" else "CYCLES", ggx=(ROUGHNESS, ANISOTROPY),
                   output=str(folder / f"{part}.exr"))
        if engine == "libshade":
            job["detail"] = "rotate"
    return plate_jobs.run(folder, jobs, python=BPY if engine == "cycles_5" else None)


def run_mitsuba(folder, jobs, normals=None):
    """As plate_jobs.run() does."""
    np.save(folder / "normals.npy", plate.normal_map(2048) if normals is None else normals)
    for number, job in enumerate(jobs.values()):
        job.update(alphas=ALPHAS, output=str(folder / f"{number}.npy"))
    order = {"normals": str(folder / "normals.npy"), "folder": str(folder), "result": str(folder / "seconds.json"),
             "jobs": list(jobs.values())}
    whole.write_text(folder / "jobs.json", json.dumps(order))
    report.step("Rendering the plate in Mitsuba", [str(PEERS), str(programs.HERE / "peers_mitsuba.py"),
                                                   str(folder / "jobs.json")], folder / "mitsuba.log",
                {"DRJIT_LIBLLVM_PATH": os.environ.get("DRJIT_LIBLLVM_PATH", LLVM)})
    result = json.loads((folder / "seconds.json").read_text(encoding="utf-8"))
    made = {part: np.load(job["output"]).astype(float) for part, job in jobs.items()}
    return made, dict(zip(jobs, result["seconds"])), result["version"]


def measured(engine, light, made, seconds, version, sizes):
    taken = float(np.median(seconds["timed"]))
    noise = paths.own_error(paths.relative_mse(made["timed"], made["many"]), sizes["samples"], sizes["many"])
    many, truth = (paths.blocks(made[part]) if light == "sky" else made[part] for part in ("many", "truth"))
    return {"kind": "peer", "engine": engine, "version": version, "light": light, "seconds": taken,
            "seconds_low": float(min(seconds["timed"])), "seconds_high": float(max(seconds["timed"])),
            "samples_per_second": sizes["size"] ** 2 * sizes["samples"] / taken, "relmse": noise,
            "seconds_to_error": taken * noise / TARGET, "error": pictures.relative_difference(many, truth),
            "mean": float(truth.mean())}


def peer(engine, light, sizes):
    def run(folder, say):
        say("rendering")
        sky = None
        if light == "sky":
            kind = "npy" if engine == "mitsuba" else "exr"
            sky = str(folder / f"sky.{kind}")
            np.save(sky, paths.studio()) if kind == "npy" else pictures.write_float(sky, paths.studio())
        jobs = jobs_of(light, sky, sizes)
        made, seconds, version = run_mitsuba(folder, jobs) if engine == "mitsuba" else run_blender(engine, folder, jobs)
        white = float(np.percentile(made["truth"], 97)) if light == "sun" else 2.5 * float(made["truth"].mean())
        tiles = sheet.tiles(folder, light, [
            (f"{style.of(engine).label}|normal map", sheet.grey(made["many"], white)),
            (f"{style.of(engine).label}|displaced", sheet.grey(made["truth"], white))])
        for path in folder.iterdir():
            if path.suffix in (".exr", ".npy", ".ply"):
                path.unlink()
        return [measured(engine, light, made, seconds, version, sizes),
                *({**tile, "engine": engine} for tile in tiles)]
    return run


def tasks(quick):
    if quick or not ready():
        return []
    seconds = {"libshade": 40, "cycles": 120, "cycles_5": 160, "mitsuba": 40}
    return [Task(f"{engine}-{light}", seconds[engine], peer(engine, light, SIZES), "make compare-peers")
            for light in ("sun", "sky") for engine in ENGINES]


# ---- what was found --------------------------------------------------------------------------------


def of(rows, light):
    return {row["engine"]: row for row in pick(rows, kind="peer", light=light)}


def finding_error(rows):
    sun = of(rows, "sun")
    others = {engine: row["error"] for engine, row in sun.items() if engine != "libshade"}
    return Finding(
        f"Beside its own displaced plate under a sun our normal map is off by {percent(sun['libshade']['error'])}, "
        + ", ".join(f"that of {ENGINES[engine]} by {percent(error)}" for engine, error in others.items()) + ".",
        len(others) == 3 and 4 * sun["libshade"]["error"] < min(others.values()), "peers")


def finding_truth(rows):
    found = [row["mean"] for row in of(rows, "sun").values()]
    return Finding(
        f"The displaced plates are the same in all of them, so that the errors can be compared: their brightness under the sun "
        f"differs by {percent(max(found) / min(found) - 1)} at most.", max(found) / min(found) - 1 < 0.01, "peers")


def finding_speed(rows):
    text, best = [], True
    for light in ("sun", "sky"):
        found = of(rows, light)
        text.append(f"under a {light} " + ", ".join(f"{row['samples_per_second'] / 1e6:.2g} ({style.of(engine).label})"
                                                     for engine, row in found.items()))
        best &= found["libshade"]["samples_per_second"] > max(found[e]["samples_per_second"] for e in ("cycles", "cycles_5"))
    return Finding("Million samples a second of the whole picture: " + "; ".join(text) + ".", best, "peers", timed=True)


def findings(rows):
    return [one(rows) for one in (finding_error, finding_truth, finding_speed)] if rows else []


def figures(rows):
    made = []
    for light in ("sun", "sky"):
        tiles = pick(rows, kind="tile", figure=light)
        if tiles:
            made.append(Figure(f"pictures-{light}", f"The plate under a {light}", "By each renderer: normal map, displaced mesh. "
                               "`make compare-peers`.", sheet.panels(tiles, 2), "Pairs of pictures of the plate"))
    return made


def tables(rows):
    lines = [[ENGINES[r["engine"]], r["version"], r["light"], r["samples_per_second"] / 1e6, r["seconds"], r["relmse"],
              r["seconds_to_error"], 100 * r["error"]] for r in pick(rows, kind="peer")]
    return [Table("peers", "Speed, noise and error", f"{SIZES['size']}² pixels, {SIZES['samples']} samples. Error: of the normal "
                  "map beside the renderer's own displaced mesh, mean absolute difference over the mean; under the sky of means "
                  "of 4 × 4 pixels.", ("renderer", "version", "light", "million samples/s", "median time, s", "relMSE",
                                      "time to relMSE 0.001, s", "error, %"), lines)] if lines else []
