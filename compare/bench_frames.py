#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do whole frames take longer than they did? Two builds take turns at every example scene; the median of the ratios counts.

    make bench-frames BEFORE=4eb53c7              what is in build/ against that commit, which is built in build/before
    make bench-frames BEFORE=HEAD ONLY="plate pan"   these scenes alone (--list says which there are)

Scenes are those of examples/blender, rendered by the engine's native module without Blender; the plate of plate.py with
its normal map (as Blender's settings are, without Filter Normals, under a sky with bounces); the studio and the room of
paths.py; and those of examples/povray. Each build's own add-on exports them once, by today's scripts. What counts is user
and system time, of all threads, of rendering alone. A pair is a few frames of either build, which take turns; the next pair
begins with the other build, in a process of its own, minutes later. After three pairs of each scene those are taken further
whose medians are not sure to .005, until all are or --minutes are spent.

Pictures: the largest difference, over the pixel where that is brighter than the mean, and the mean one; "same" below 1e-5.
Exit status: 0 if no scene is slower than --limit, 1 if some are, 2 if it cannot be told, 130 after Ctrl-C, which tells what
was measured so far. Where the add-ons differ each makes the scene, and Blender subdivides meshes to the last bit alike only
by chance: of a few paths more. What was built and exported stays for the next run; `rm -r build/before build/frames` frees the space.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bench_frames_turns import differences
import pictures
import plate
import paths
import programs
import report
import whole

BEFORE, FRAMES = programs.BUILD / "before", programs.BUILD / "frames"
EXAMPLES = programs.ROOT / "examples"
LEAST = 3  # pairs of each scene, whatever time they take
SUZANNE = FRAMES / "suzanne.blend"
NOT_FROM_MAKE = dict.fromkeys(("MAKEFLAGS", "MFLAGS", "MAKEOVERRIDES", "MAKELEVEL"), "")  # of the make that runs this
SURE = 0.005  # of a median: its standard error
SAME = 1e-5  # pictures, largest difference
# POV-Ray's pictures, so that one takes about half a second
WIDTH = {"metals": 640, "turned": 640, "suzanne": 480, "reflection": 256, "scratches": 192, "cloth": 64, "kitchen": 64, "presets": 48}


class Failed(Exception):
    """Nothing can be said, or no more; the text tells why."""


class Scene(NamedTuple):
    """`samples` 0: POV-Ray's. `percentage` of the size that its script says."""

    name: str
    script: Path
    arguments: tuple = ()
    samples: int = 16
    percentage: int = 25
    settings: tuple = ()


def blender_scenes():
    made = []
    for folder in sorted(path.parent for path in EXAMPLES.glob("blender/*/make_scene.py")):
        text = (folder / "make_scene.py").read_text(encoding="utf-8")
        if folder.name == "suzanne":  # its script only writes a file, for both renderers
            made.append(Scene("suzanne", SUZANNE))
            continue
        views = [()] + [(word,) for word in ("near", "across") if f"[{word}]" in text]
        made += [Scene("-".join((folder.name, *view)), folder / "make_scene.py", (str(FRAMES / f"{folder.name}.blend"), *view)) for view in views]
    made.append(Scene("nodes", EXAMPLES / "blender/nodes/make_engines.py", (str(FRAMES / "nodes.jpg"),)))
    jobs = {"plate": {"surface": "bumped", "detail": "rotate", "size": 512, "samples": 64, "quads": 1, "repeat": 1}}
    jobs["plate-unfiltered"] = jobs["plate"]
    jobs["plate-sky"] = {**jobs["plate"], "size": 256, "samples": 16, "sky": str(FRAMES / "sky.exr")}
    for name, job in jobs.items():
        made.append(Scene(name, programs.HERE / "plate_render.py", (order_of(name, job, normal_map=str(FRAMES / "normals.exr")),),
                          job["samples"], 100, (("filter_normals", name != "plate-unfiltered"),)))
    for name in ("studio", "room"):
        job = {"scene": name, "size": 256, "samples": 16, "seed": 0}
        made.append(Scene(name, programs.HERE / "paths_render.py", (order_of(name, job, sky=str(FRAMES / "sky.exr")),), 16, 100))
    return made


def order_of(name, job, **files):
    """Where a script's order will lie; `write_orders` puts it there."""
    ORDERS[name] = {**files, "result": "", "jobs": [{"engine": "LIBSHADE", "output": "", **job}]}
    return str(FRAMES / f"{name}.json")


ORDERS = {}


def povray_scenes():
    return [Scene(f"povray-{path.stem}", path, (), 0) for path in sorted(EXAMPLES.glob("povray/*/*.pov"))
            if path.parent.name != "cookbook"]


# ---- what is compared


class Side(NamedTuple):
    """A build: where it stands, and where its scenes are kept."""

    root: Path
    scenes: Path

    @property
    def add_on(self):
        return self.root / "build/blender/addons/libshade"

    @property
    def povray(self):
        return self.root / "build/povray/povray"

    def file(self, scene):
        return self.scenes / f"{scene.name}.pickle"


def before(word):
    """The build of a commit, made the first time."""
    found = subprocess.run(["git", "-C", programs.ROOT, "rev-parse", "--verify", "--quiet", "--end-of-options", f"{word}^{{commit}}"],
                           capture_output=True, text=True, check=False)
    if found.returncode:
        raise Failed(f"{word}: no commit of {programs.ROOT}")
    commit = found.stdout.strip()
    root = BEFORE / commit
    if not (root / "built").exists():
        root.mkdir(parents=True, exist_ok=True)
        archive = subprocess.run(["git", "-C", programs.ROOT, "archive", commit], capture_output=True, check=True)
        subprocess.run(["tar", "-x", "-C", root], input=archive.stdout, check=True)
        fetched = programs.BUILD / "povray/download"
        if fetched.is_dir() and not (root / "build/povray/download").exists():
            shutil.copytree(fetched, root / "build/povray/download", copy_function=shutil.copy)
        report.step(f"Building {word} in {root.relative_to(programs.ROOT)} (minutes)", ["make", f"-j{os.cpu_count() or 1}", *goals(root)],
                    root / "built.log", NOT_FROM_MAKE, root)
        (root / "built").touch()
    return Side(root, root / "frames")


def goals(root):
    """The add-on, without its assets and its manual, and POV-Ray; as that commit's Makefile calls its native files."""
    source, made = root / "blender_addon_c", "build/blender/addons/libshade"
    files = [path.relative_to(source) for path in python_of(source)]
    named = subprocess.run(["make", "--silent", "--no-print-directory", "NEEDS=", "--eval=native-names: ; @echo $(BLENDER_NATIVE)", "native-names"],
                           cwd=root, env=os.environ | NOT_FROM_MAKE, capture_output=True, text=True, check=True)
    return [*named.stdout.split(), *(f"{made}/{path}" for path in files), "povray"]


def python_of(folder):
    """The add-on's modules: its own and those of its folders."""
    return [path for path in sorted((*folder.glob("*.py"), *folder.glob("*/*.py"))) if path.parent.name not in ("native", "tests")]


def export(sides, scenes):
    """What each add-on hands to its module, for scenes whose file is not there as that add-on makes it. One whose Python is
    the other's need not be asked."""
    for side, other in (sides, sides[::-1]):
        side.scenes.mkdir(parents=True, exist_ok=True)
        wanted = []
        for scene in scenes:
            made = made_from(side, scene)
            if kept(side, scene) != made and kept(other, scene) == made:
                shutil.copy(other.file(scene), side.file(scene))
                whole.write_text(side.file(scene).with_suffix(".of"), made)
            elif kept(side, scene) != made:
                wanted.append(scene)
        processes = min(os.cpu_count() or 1, len(wanted))
        with concurrent.futures.ThreadPoolExecutor(max(processes, 1)) as pool:
            list(pool.map(lambda k: export_some(side, wanted[k::processes], k), range(processes)))


def export_some(side, scenes, number):
    order = [{"script": str(scene.script), "arguments": scene.arguments, "output": str(side.file(scene)),
              "percentage": scene.percentage, "samples": scene.samples, "settings": dict(scene.settings)} for scene in scenes]
    whole.write_text(side.scenes / f"order-{number}.json", json.dumps(order))
    report.step(f"Exporting {len(scenes)} scenes with the add-on of {side.root}",
                programs.blender(programs.HERE / "bench_frames_export.py", side.scenes / f"order-{number}.json"),
                side.scenes / f"export-{number}.log", add_on_of(side))
    for scene in scenes:
        whole.write_text(side.file(scene).with_suffix(".of"), made_from(side, scene))


def kept(side, scene):
    """From what the file was made that is there."""
    of = side.file(scene).with_suffix(".of")
    return of.read_text(encoding="utf-8") if of.exists() and side.file(scene).exists() else None


def made_from(side, scene):
    """Of what a scene's file depends on: the add-on's Python, the script and what stands beside it, the order."""
    files = [*python_of(side.add_on), scene.script,
             EXAMPLES / "blender/parts.py", programs.HERE / "bench_frames_export.py"]
    sums = hashlib.sha256(repr((scene, ORDERS.get(scene.name))).encode())
    for file in sorted(files):
        sums.update(file.read_bytes())
    return sums.hexdigest()


def add_on_of(side):
    return {"BLENDER_USER_SCRIPTS": str(side.root / "build/blender")}


def prepare(scenes, older):
    """What scripts and POV-Ray's scenes read. A file of Blender's is the older add-on's: it does not know what newer ones keep in theirs."""
    FRAMES.mkdir(parents=True, exist_ok=True)
    for name, order in ORDERS.items():
        whole.write_text(FRAMES / f"{name}.json", json.dumps(order))
    if not (FRAMES / "sky.exr").exists():
        pictures.write_float(FRAMES / "normals.exr", plate.normal_map(2048))
        pictures.write_float(FRAMES / "sky.exr", paths.studio())
    names = {scene.name for scene in scenes}
    if "povray-embossed" in names:
        subprocess.run([programs.SHADE, *"weave --name basket --cells 16 --curve .35 --ridge 0 --map normal --bits 16 -o".split(),
                        FRAMES / "basket.png"], check=True, stdout=subprocess.DEVNULL)
    if names & {"suzanne", "povray-suzanne"}:
        report.step("Building suzanne.blend", programs.blender(EXAMPLES / "blender/suzanne/make_scene.py", SUZANNE), FRAMES / "suzanne.log", add_on_of(older))
    if "povray-suzanne" in names and not (FRAMES / "povray/meshes.inc").exists():
        report.step("Writing it for POV-Ray", programs.blender(programs.HERE / "export_povray.py", FRAMES / "povray", scene=SUZANNE),
                    FRAMES / "suzanne.log", programs.ADD_ON)


# ---- turns


def said_by(command, **options):
    made = subprocess.run([*map(str, command)], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, **options)
    if made.returncode:
        raise Failed(f"{command[0]}: status {made.returncode}\n" + "\n".join((made.stderr or made.stdout).splitlines()[-6:]))
    return made


def pair_of(scene, sides, swapped):
    """((seconds before, after), largest, mean difference) of one pair."""
    if scene.samples:
        made = json.loads(said_by([sys.executable, programs.HERE / "bench_frames_turns.py", *(
            part for side in sides for part in (side.add_on, side.file(scene))), "--first", "AB"[swapped]],
            env=environment()).stdout)
        return tuple(map(statistics.mean, made["seconds"])), *made["differences"]
    seconds = {}
    for number in ((0, 1), (1, 0))[swapped]:
        width = WIDTH.get(scene.script.stem, 128)
        said = said_by([sides[number].povray, f"+I{scene.script}", f"+L{FRAMES}", f"+L{FRAMES / 'povray'}",
                        f"+O{FRAMES / f'{scene.name}-{number}.exr'}", "+FE", f"+W{width}", f"+H{width * 9 // 16}", "-A", "+WT1", "-D"],
                       cwd=scene.script.parent, env=environment()).stderr
        seconds[number] = seconds_of_povray(said)
    return (seconds[0], seconds[1]), *differences(*(pictures.read(FRAMES / f"{scene.name}-{number}.exr") for number in (0, 1)))


def environment():
    """Fresh memory for each frame, or a whole process is as quick as its first pages happen to lie."""
    inherited = {name: value for name, value in os.environ.items() if name not in ("LIBSHADE_DUMP", "LIBSHADE_TIMINGS", "POVINI")}
    return {**inherited, "MALLOC_MMAP_THRESHOLD_": "131072", "MALLOC_TRIM_THRESHOLD_": "131072"}


def seconds_of_povray(said):
    """Photons, radiosity and tracing, of all threads."""
    found = re.findall(r"with ([\d.]+) CPU-seconds total", said.partition("Render Time:")[2])
    if not found:
        raise Failed("POV-Ray says no CPU-seconds")
    return sum(map(float, found))


# ---- what it says


class Row:
    """What was measured of a scene."""

    def __init__(self, name):
        self.name, self.seconds, self.largest, self.mean = name, [], 0.0, 0.0

    def add(self, seconds, largest, mean):
        self.seconds.append(seconds)
        self.largest, self.mean = max(self.largest, largest), max(self.mean, mean)

    def ratios(self):
        return sorted(after / before for before, after in self.seconds)

    def quarters(self):
        """Lower quartile, median, upper quartile."""
        return tuple(float(np.quantile(self.ratios(), q)) for q in (0.25, 0.5, 0.75))

    def error(self):
        """The median's standard error, were the ratios a normal distribution's."""
        low, _, high = self.quarters()
        return 0.93 * (high - low) / len(self.seconds) ** 0.5

    def least(self, side):
        return min(seconds[side] for seconds in self.seconds)

    def numbers(self):
        low, median, high = self.quarters()
        return {"scene": self.name, "pairs": len(self.seconds), "ratio": median, "low": low, "high": high,
                "seconds_before": self.least(0), "seconds_after": self.least(1), "largest_difference": self.largest,
                "mean_difference": self.mean}


def table(rows, limit):
    lines = []
    for row in rows:
        low, median, high = row.quarters()
        lines.append([row.name, f"{median:.3f}", f"{low:.3f} to {high:.3f}", str(len(row.seconds)), f"{row.least(0):.3f}", f"{row.least(1):.3f}",
                      f"{row.largest:.1e}", f"{row.mean:.1e}", "same" if row.largest < SAME else "differs", "slower" if median > limit else ""])
    return report.table(["scene", "ratio", "middle half", "pairs", "s before", "s after", "largest", "mean", "picture", ""], lines)


def verdict(rows, limit, alike):
    """Lines below the table."""
    medians = [row.quarters()[1] for row in rows]
    lines = [f"Median of {len(rows)} scenes {statistics.median(medians):.3f}, {min(medians):.3f} to {max(medians):.3f}."]
    if alike:
        lines.append(f"Both builds are the same, byte for byte: {max(abs(m - 1) for m in medians):.3f} is what this machine's noise makes of 1.")
    slower = [row.name for row, median in zip(rows, medians) if median > limit]
    lines.append(f"Over {limit:g}: {', '.join(slower) or 'none'}.")
    differ = [row.name for row in rows if row.largest >= SAME]
    lines.append(f"Pictures differ: {', '.join(differ) or 'none'}.")
    return lines


def same_builds(sides, scenes):
    files = [("build/blender/addons/libshade/_native.abi3.so", True), ("build/povray/src/unix/povray", False)]
    return all((sides[0].root / file).read_bytes() == (sides[1].root / file).read_bytes()
               for file, of_blender in files if any(bool(scene.samples) == of_blender for scene in scenes))


def take(scenes, rows, pair, minutes):
    """Pairs, scene by scene, then all again. pair(scene, swapped) measures one."""
    begun, number = time.monotonic(), 0
    while left := [scene for scene in scenes if number < LEAST or rows[scene.name].error() > SURE]:
        for scene in left:
            spent = (time.monotonic() - begun) / 60
            if number >= LEAST and spent > minutes:
                return
            row = rows[scene.name]
            row.add(*pair(scene, bool(number % 2)))
            low, median, high = row.quarters()
            print(f"{spent:4.1f} min  pair {number + 1}  {scene.name:20s} {median:.3f} ({low:.3f} to {high:.3f})", file=sys.stderr, flush=True)
        number += 1


def arguments(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", metavar="BEFORE", nargs="?", help="a commit")
    parser.add_argument("--only", nargs="+", metavar="SCENE", help="these alone; a word stands for all scenes that begin with it")
    parser.add_argument("--minutes", type=float, default=9.0, metavar="M", help="of pairs, building apart (default 9)")
    parser.add_argument("--limit", type=float, default=1.03, metavar="R", help="a median above this is slower (default 1.03)")
    parser.add_argument("--list", action="store_true", help="name the scenes and end")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", default=programs.BUILD / "bench_frames.csv",
                        help="the table as CSV (default build/bench_frames.csv)")
    options = parser.parse_args(argv)
    if not options.limit > 0:
        parser.error("--limit wants more than 0")
    if not options.before and not options.list:
        parser.error("BEFORE is missing: a commit to compare with")
    return options


def chosen(scenes, words):
    for word in words or ():
        if not any(scene.name.startswith(word) for scene in scenes):
            raise Failed(f"{word}: no scene; --list names them")
    exact = {scene.name for scene in scenes}
    return [scene for scene in scenes
            if not words or any(scene.name == word or word not in exact and scene.name.startswith(word) for word in words)]


def main(argv=None):
    options = arguments(argv)
    scenes = chosen(blender_scenes() + povray_scenes(), options.only)
    if options.list:
        print(*(scene.name for scene in scenes), sep="\n")
        return 0
    sides = before(options.before), Side(programs.ROOT, FRAMES)
    prepare(scenes, sides[0])
    ours = [scene for scene in scenes if scene.samples]
    export(sides, ours)
    rows, status = {scene.name: Row(scene.name) for scene in scenes}, 0
    try:
        take(scenes, rows, lambda scene, swapped: pair_of(scene, sides, swapped), options.minutes)
    except KeyboardInterrupt:
        print("bench_frames.py: broken off", file=sys.stderr)
        status = 130
    except Failed as failure:
        print(f"bench_frames.py: {failure}", file=sys.stderr)
        status = 2
    measured = [row for row in rows.values() if row.seconds]
    if not measured:
        return status or 2
    print(table(measured, options.limit), "", *verdict(measured, options.limit, same_builds(sides, scenes)), sep="\n")
    whole.write_csv(options.output, [row.numbers() for row in measured])
    return status or int(any(row.quarters()[1] > options.limit for row in measured))


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (Failed, report.StepFailed, OSError) as failure:
        print(f"bench_frames.py: {failure}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)
