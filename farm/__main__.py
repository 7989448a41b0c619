# SPDX-License-Identifier: Apache-2.0
"""libshade-farm: frames, tiles and shares of a scene as items of a scheduler's, or of this machine alone."""

import argparse
import os
import re
import shlex
import shutil
import sys
import zipapp

import engines
import files
import finish
import item
import job as jobs
import renderers
from engines.local import duration

HERE = os.path.dirname(os.path.abspath(__file__))

_EPILOG = """Exit status: 0 done, 1 something is missing or refused, 2 bad usage, 130 after Ctrl-C, which loses no whole item.
Words behind -- go to the renderer: shade-render's, Blender's behind the file's name, POV-Ray's."""


def built():
    """Where the renderers may lie that were built with this."""
    return os.path.dirname(HERE) if os.path.isfile(HERE) else os.path.join(os.path.dirname(HERE), "build")


_BESIDE = {"shade-render": "shade-render", "povray": "povray/povray"}


def find_program(name, given):
    """Named, or built with this, or else by its name alone, for each machine to find."""
    if name in given:
        if not shutil.which(given[name]):
            raise files.Refusal(f"--program {name}={given[name]}: no program")
        return os.path.abspath(given[name]) if os.sep in given[name] else given[name]
    beside = os.path.join(built(), _BESIDE.get(name, name))
    if os.path.isfile(beside) and os.access(beside, os.X_OK):
        return beside
    return name


def parse_frames(text, of_file):
    """(frames, first, last of what was asked for)."""
    if text == "all" and of_file:
        first, last, step = of_file
    else:
        found = re.fullmatch(r"(-?\d+)(?:-(-?\d+)(?:/(\d+))?)?", text)
        if not found:
            raise files.Refusal(f"--frames '{text}': A, A-B or A-B/STEP was expected" + (", or all" if of_file else ""))
        first, last, step = int(found[1]), int(found[2] or found[1]), int(found[3] or 1)
    frames = list(range(first, last + 1, step)) if step else []
    if not frames:
        raise files.Refusal(f"--frames '{text}' are none: A must be at most B, and STEP at least 1")
    return frames, first, last


def parse_tiles(text):
    found = re.fullmatch(r"([1-9]\d{0,3})x([1-9]\d{0,3})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"'{text}': NxM was expected, columns and rows")
    return int(found[1]), int(found[2])


def parse_program(text):
    name, _, path = text.partition("=")
    if name not in ("blender", "povray", "shade-render") or not path:
        raise argparse.ArgumentTypeError(f"'{text}': blender=PATH, povray=PATH or shade-render=PATH was expected")
    return name, path


def positive(text):
    if not text.isdigit() or not 0 < int(text) < 10**6:
        raise argparse.ArgumentTypeError(f"'{text}': a whole number from 1 on was expected")
    return int(text)


def plan_items(about, frames, tiles, shares):
    rects = [None]
    if tiles:
        if about["no_tiles"]:
            raise files.Refusal(f"--tiles: {about['no_tiles']}")
        width, height = about["size"]
        columns, rows = (renderers.cut(length, parts, about.get("grid", 1)) for length, parts in zip((width, height), tiles))
        rects = [[x0, y0, x1 - x0, y1 - y0] for y0, y1 in rows for x0, x1 in columns]
    ranges = [None]
    if shares and shares > 1:
        why = about["no_shares"] or about["no_tiles"]
        if why:
            raise files.Refusal(f"--shares: {why}")
        ranges = [list(one) for one in renderers.cuts_of_samples(about["samples"], shares, about["cloth"])]
    return [{"frame": frame, "tile": rect, "share": share} for frame in frames for rect in rects for share in ranges]


def own_program(place):
    """This program as one file that Python runs."""
    if os.path.isfile(HERE):
        shutil.copyfile(HERE, place)
    else:
        zipapp.create_archive(HERE, place, "/usr/bin/env python3",
                              filter=lambda path: path.suffix == ".py" and "tests" not in path.parts)


def new_folder(given, name):
    if given:
        if os.path.isdir(given) and os.listdir(given):
            raise files.Refusal(f"{given}: the folder is not empty; each submission has one of its own")
        os.makedirs(given, exist_ok=True)
        return os.path.abspath(given)
    number = 1
    while True:
        try:
            os.mkdir(f"{name}-farm-{number}")
            return os.path.abspath(f"{name}-farm-{number}")
        except FileExistsError:
            number += 1


def submit(options):
    engine = engines.BY_NAME[options.engine]
    if not options.dry_run:
        engine.check()
    scene = os.path.abspath(options.scene)
    renderer = renderers.of(scene)
    options.environment = {}
    addon = os.path.join(built(), "blender")
    if os.path.isdir(os.path.join(addon, "addons", "libshade")) and "BLENDER_USER_SCRIPTS" not in os.environ:
        options.environment["BLENDER_USER_SCRIPTS"] = addon
    given = dict(options.program)
    options.programs = {name: find_program(name, given) for name in ("blender", "povray", "shade-render")}
    about = renderer.examine(scene, options)
    frames, first, last = parse_frames(options.frames, about.get("all_frames")) if options.frames else (about["frames"], None, None)
    items = plan_items(about, frames, options.tiles, options.shares)
    for one, text in zip(items, about.get("names", [])):
        one["name"] = text
    cores = len(os.sched_getaffinity(0))
    threads = options.threads or (1 if options.engine == "slurm" else max(1, cores // min(cores, len(items))))
    name = os.path.splitext(os.path.basename(scene))[0]
    inputs, absent = [], []
    for path in [*dict.fromkeys([*about["inputs"], *map(os.path.abspath, options.also)])]:
        if os.path.isfile(path):
            inputs.append(path)
        elif not os.path.isdir(path):
            absent.append(path)
    for path in absent:
        print(f"libshade-farm: warning: {path}: an input is not there", file=sys.stderr)
    said = {"scene": scene, "name": name, "words": about.get("words", options.words), "threads": threads, "items": items,
            "programs": {need: options.programs[need] for need in about["programs"]}, "environment": options.environment, "isa": options.isa,
            "engine": options.engine, "sbatch": shlex.split(options.sbatch), "range": [first, last], "corner": about.get("corner", [0, 0]),
            "pictures": not about.get("no_frames"), "libraries": about.get("libraries", []), "clock": about.get("clock", False),
            "movie": None if options.no_movie or about.get("no_frames") else {"rate": options.rate or about.get("rate", 24), "layer": about.get("layer", "")}}
    if options.dry_run:
        plan = jobs.Job.planned(os.path.abspath(options.output or f"{name}-farm-1"), said)
        print(f"{len(items)} items of {threads} thread{'s' if threads > 1 else ''} each:")
        for number in range(len(items)):
            print(f"  {plan.name_of(number)}")
        print("inputs:")
        for path in inputs:
            print(f"  {files.sha256(path)}  {path}")
        print("commands:")
        for line in engine.commands(plan, range(len(items))):
            print(f"  {line}")
        return 0
    folder = new_folder(options.output, name)
    try:
        if options.pack:
            os.makedirs(os.path.join(folder, "inputs"))
            packed = renderer.pack(scene, inputs, os.path.join(folder, "inputs"), options)
            said["scene"] = os.path.relpath(packed, folder)
            inputs = sorted(os.path.join(at, one) for at, _, names in os.walk(os.path.join(folder, "inputs")) for one in names)
        said["inputs"] = [files.told(path, os.path.relpath(path, folder) if options.pack else path) for path in inputs]
        own_program(os.path.join(folder, "farm.pyz"))
        job = jobs.Job.create(folder, said)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    print(f"{len(items)} items; all of it is in {folder}", flush=True)
    return engine.submit(job, list(range(len(items))))


def status(options):
    job = jobs.Job(options.folder)
    missing = set(job.missing())
    engine = engines.of(job)
    queued, hangs = engine.state(job)
    now = job.now()
    running = [number for number in missing if job.is_alive(number, now)]
    wrong = {number: files.read_json(job.path("failed", f"{number}.json")) for number in missing if number not in running}
    wrong = {number: told for number, told in wrong.items() if told}
    done = len(job.items) - len(missing)
    print(f"{job.said['name']}: {len(job.items)} items: {done} done, {len(running)} running, {len(wrong)} failed, "
          f"{len(missing) - len(running) - len(wrong)} wait" + ("" if queued is None else f"; {queued} in the queue"))
    told = [files.read_json(job.path("results", str(number), "item.json"), {}) for number in range(len(job.items)) if number not in missing]
    seconds, memory = [one.get("seconds", 0) for one in told], max((one.get("megabytes", 0) for one in told), default=0)
    if told:
        print(f"an item took {sum(seconds) / len(told):.1f} s, {max(seconds):.1f} s at most, and {memory} MB at most")
    if missing and told:
        print(f"remain: about {duration(sum(seconds) / len(seconds) * len(missing) / max(1, len(running)))}, as many as now at once")
    for number, told in sorted(wrong.items()):
        print(f"failed: {job.name_of(number)}: {told['message']}; on {told['host']}, log {told['log']}")
    for line in hangs:
        print(f"hangs: {line}")
    finished = files.read_json(job.path("finished.json"))
    if job.is_cancelled():
        print(f"cancelled; go on with: libshade-farm resume {shlex.quote(job.folder)}")
    elif finished and not missing:
        for line in finished["wrong"]:
            print(f"failed: {line}")
        print(f"{'frames' if job.said['pictures'] else 'results'} are in {job.shown()}")
    return 0


def cancel(options):
    job = jobs.Job(options.folder)
    files.write_json(job.path("cancelled"), {})
    engines.of(job).cancel(job)
    print(f"cancelled; what is whole stays. Go on with: libshade-farm resume {shlex.quote(job.folder)}")
    return 0


def resume(options):
    job = jobs.Job(options.folder)
    engine = engines.BY_NAME[options.engine] if options.engine else engines.of(job)
    engine.check()
    if not job.is_cancelled():
        files.write_json(job.path("cancelled"), {})
    engines.of(job).cancel(job)  # what is held or waits would run twice
    files.remove(job.path("cancelled"))
    files.remove(job.path("finished.json"))
    missing = job.missing()
    for number in missing:
        files.remove(job.path("failed", f"{number}.json"))
    if not missing:
        print("all items are whole")
        return tell(finish.merge(job))
    return engine.submit(job, missing)


def tell(wrong):
    for line in wrong:
        print(line)
    return 1 if wrong else 0


def run_item(options):
    job = jobs.Job(options.folder)
    if options.number >= len(job.items):
        raise files.Refusal(f"item {options.number}: there are {len(job.items)}, from 0 on")
    return item.run(job, options.number)


def run_merge(options):
    if options.round is None:
        return tell(finish.merge(jobs.Job(options.folder)))
    return finish.after(options.folder, options.round, engines.of(jobs.Job(options.folder)))


def whole_number(text):
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f"'{text}': a whole number from 0 on was expected")
    return int(text)


def parser():
    whole = argparse.ArgumentParser(prog="libshade-farm", description=__doc__.split(": ", 1)[1].capitalize(), epilog=_EPILOG,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    tasks = whole.add_subparsers(dest="task", required=True, metavar="submit|status|cancel|resume|item|merge")
    one = tasks.add_parser("submit", help="begin a scene's items", epilog=_EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    one.add_argument("scene", metavar="FILE.blend|FILE.pov|SCENE.shscene", help="or a list of commands, .items (renderers/commands.py)")
    one.add_argument("-o", "--output", metavar="FOLDER", help="a new or empty folder for all of it (default NAME-farm-1, -2, ...)")
    one.add_argument("--frames", metavar="A-B[/STEP]", help="or A; all: those of the .blend (default: its current frame, a still)")
    one.add_argument("--tiles", metavar="NxM", type=parse_tiles, help="each frame in N columns and M rows")
    one.add_argument("--shares", metavar="K", type=positive, help="each frame's samples in K parts")
    one.add_argument("--engine", choices=sorted(engines.BY_NAME), default="local", help="who runs the items (default local)")
    one.add_argument("--threads", metavar="T", type=positive, help="of an item (default: local, all cores over all items; slurm, 1)")
    one.add_argument("--dry-run", action="store_true", help="print items, inputs and commands, and begin nothing")
    one.add_argument("--pack", action="store_true", help="copy the scene and what it reads into FOLDER, for machines that share no other")
    one.add_argument("--also", metavar="FILE", action="append", default=[], help="another input, whose name the scene puts together")
    one.add_argument("--isa", choices=("scalar", "sse2", "avx2", "avx512", "neon"), help="hold all machines to one instruction set (LIBSHADE_ISA)")
    one.add_argument("--program", metavar="NAME=PATH", type=parse_program, action="append", default=[], help="blender, povray or shade-render")
    one.add_argument("--sbatch", metavar="WORDS", default="", help="more options for sbatch, as one word: --sbatch='--mem=4G --time=2:00:00'")
    one.add_argument("--no-movie", action="store_true", help="no movie of the frames (made where ffmpeg is found)")
    one.add_argument("--rate", metavar="FPS", type=positive, help="of the movie (default: the .blend's, else 24)")
    for name, text in (("status", "what is done, runs, failed and hangs"), ("cancel", "end what runs; what is whole stays"),
                       ("resume", "render what is missing"), ("item", "one item, on this machine"), ("merge", "frames of their parts, and the movie")):
        one = tasks.add_parser(name, help=text)
        one.add_argument("folder", metavar="FOLDER")
        if name == "item":
            one.add_argument("number", metavar="N", type=whole_number)
        if name == "resume":
            one.add_argument("--engine", choices=sorted(engines.BY_NAME), help="another than before")
        if name == "merge":
            one.add_argument("--round", type=whole_number, help=argparse.SUPPRESS)
    return whole


def main(words):
    if words[:1] == ["pack-itself"] and len(words) == 2:  # of `make farm`
        own_program(words[1])
        os.chmod(words[1], 0o755)
        return 0
    renderers_words = []
    if words[:1] == ["submit"] and "--" in words:
        at = words.index("--")
        words, renderers_words = words[:at], words[at + 1:]
    options = parser().parse_args(words)
    options.words = renderers_words
    tasks = {"submit": submit, "status": status, "cancel": cancel, "resume": resume, "item": run_item, "merge": run_merge}
    try:
        return tasks[options.task](options)
    except files.Refusal as error:
        print(f"libshade-farm: {error}", file=sys.stderr)
    except OSError as error:
        print(f"libshade-farm: {error.filename or ''}: {error.strerror}", file=sys.stderr)
    except KeyboardInterrupt:
        return 130
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
