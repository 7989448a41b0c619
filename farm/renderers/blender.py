# SPDX-License-Identifier: Apache-2.0
"""Blender's files. Whole frames are rendered by Blender, by the file's own engine; tiles and shares by shade-render, of scenes
that Blender saves."""

import json
import os
import pkgutil
import re
import subprocess
import tempfile

import files

from . import saved

_SCRIPT = "in_blender.py"


def _words(program, scene, more, threads, task, said):
    script = pkgutil.get_data(__name__, _SCRIPT).decode()
    return [program, "-b", "--addons", "libshade", scene, "--python-exit-code", "1", "-t", str(threads), *more, "--python-expr", script, "--", "--farm", task,
            json.dumps(said, ensure_ascii=False)]


def _check_engine(said):
    """Blender takes another engine where the file's is not there."""
    found = re.search(r"Engine '(\w+)' not available", said)
    if found:
        raise files.Refusal(f"the file's engine {found[1]} is not there: install and enable its add-on, or name its folder by BLENDER_USER_SCRIPTS")


def _ask(scene, options, task, **said):
    """Now, on this machine."""
    words = _words(options.programs["blender"], scene, options.words, 0, task, said)
    try:
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", env={**os.environ, **options.environment})
    except OSError as error:
        raise files.Refusal(f"{words[0]}: cannot be run: {error.strerror}; install Blender, or name it by --program blender=PATH") from error
    _check_engine(done.stdout + done.stderr)
    if done.returncode:
        lines = [line for line in (done.stdout + done.stderr).splitlines() if "Error" in line]
        raise files.Refusal(f"{scene}: Blender: {lines[-1].strip() if lines else f'ended with {done.returncode}'}")


def examine(scene, options):
    if not os.path.isfile(scene):
        raise files.Refusal(f"{scene}: no such file")
    with tempfile.TemporaryDirectory(prefix="libshade-farm-") as folder:
        place = os.path.join(folder, "about.json")
        _ask(scene, options, "examine", place=place)
        found = files.read_json(place)
        if not found:
            raise files.Refusal(f"{scene}: Blender cannot read it")
        said = {"frames": [found["frame"]], "all_frames": found["frames"], "rate": found["rate"], "inputs": found["inputs"], "programs": ["blender"],
                "no_tiles": "", "no_shares": ""}
        if not (options.tiles or options.shares):
            return said
        if found["engine"] != "LIBSHADE":
            said["no_tiles"] = f"the file's engine is {found['engine']}: only libshade renders tiles and shares; give -E LIBSHADE behind --"
        elif found["composites"] or found["sequences"]:
            said["no_tiles"] = "the file composites or edits its frames after they are rendered: take whole frames, or switch that off"
        if said["no_tiles"]:
            return said
        _ask(scene, options, "save", frame=found["frame"], place=os.path.join(folder, "frame.shscene"))
        each = [saved.about(saved.header_of(os.path.join(folder, name)), []) for name in sorted(os.listdir(folder)) if name.endswith(".shscene")]
    return {**said, **each[0], "cloth": any(one["cloth"] for one in each), "programs": ["blender", "shade-render"],
            "no_tiles": max(one["no_tiles"] for one in each), "no_shares": max(one["no_shares"] for one in each)}


def _in_blender(job, task, log, **more):
    said = job.said
    _check_engine(log.run(_words(said["programs"]["blender"], job.path(said["scene"]), said["words"], said["threads"], task, more)))


def _save(job, frame, work, log):
    """Of each view layer and eye, its saved scene."""
    _in_blender(job, "save", log, frame=frame, place=os.path.join(work, "frame.shscene"))
    found = sorted(name for name in os.listdir(work) if name.endswith(".shscene"))
    if not found:
        raise files.Refusal("Blender saved no scene")
    return found


def render(job, item, work, log):
    stem = f"{job.said['name']}_{item['frame']:04}"
    if item.get("tile") or item.get("share"):
        names = []
        for scene in _save(job, item["frame"], work, log):
            names.append(scene.replace(".shscene", saved.ENDING))
            log.run([job.said["programs"]["shade-render"], os.path.join(work, scene), "-o", os.path.join(work, names[-1]), "--threads", job.said["threads"],
                     *saved.part_words(item, job.said)])
        return names
    _in_blender(job, "render", log, frame=item["frame"], place=os.path.join(work, stem))
    names = sorted(name for name in os.listdir(work) if name.startswith(stem))
    if not names:
        raise files.Refusal("Blender wrote no picture")
    return names


def merge(job, frame, parts, work, log):
    names = []
    for scene in _save(job, frame, work, log):
        shares = [path for _, paths in parts for path in paths if os.path.basename(path) == scene.replace(".shscene", saved.ENDING)]
        names.append(f"{job.said['name']}_{frame:04}{scene[len('frame'):-len('.shscene')]}.exr")
        saved.merge_shares(job, os.path.join(work, scene), shares, os.path.join(work, names[-1]), log)
    return names


def pack(scene, _inputs, folder, options):
    place = os.path.join(folder, os.path.basename(scene))
    _ask(scene, options, "pack", place=place)
    with tempfile.TemporaryDirectory(prefix="libshade-farm-") as other:
        told = os.path.join(other, "about.json")
        _ask(place, options, "examine", place=told)
        for path in files.read_json(told)["inputs"]:
            if path != place and os.path.isfile(path):
                raise files.Refusal(f"{path}: Blender cannot pack it; submit without --pack, from a shared folder")
    return place
