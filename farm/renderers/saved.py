# SPDX-License-Identifier: Apache-2.0
"""Saved scenes, .shscene, by shade-render."""

import json
import os
import shutil
import struct

import files

ENDING = ".shshare"  # of tiles and shares


def header_of(scene):
    """Without its arrays."""
    try:
        with open(scene, "rb") as file:
            begin = file.read(16)
            if begin[:8] != b"shscene\n" or len(begin) < 16:
                raise files.Refusal(f"{scene}: no saved scene: \"shscene\" must be its first line")
            return json.loads(file.read(struct.unpack("<I", begin[8:12])[0]))
    except OSError as error:
        raise files.Refusal(f"{scene}: {error.strerror}") from error
    except ValueError as error:
        raise files.Refusal(f"{scene}: its header must be JSON: {error}") from error


def words_for_number(words, name):
    """The number behind --name, or None."""
    for at, word in enumerate(words):
        text = word[len(name) + 3:] if word.startswith(f"--{name}=") else words[at + 1] if word == f"--{name}" and at + 1 < len(words) else ""
        if text.isdigit():
            return int(text)
    return None


def about(header, words):
    """What tiles and shares go by."""
    try:
        pictures = [one["scene"] for one in header["pictures"]]
        first = pictures[0]
        x0, y0, x1, y1 = first.get("region", (0, 0, first["width"], first["height"]))
        limited = any(scene.get("time_limit") for scene in pictures)
        adaptive = any(scene.get("adaptive_threshold") for scene in pictures)
        return {"size": [x1 - x0, y1 - y0], "corner": [x0, first["height"] - y1], "samples": words_for_number(words, "samples") or first["samples"],
                "cloth": any(scene.get("cloths") for scene in pictures), "layer": f"{header['pictures'][0]['layer']}.Combined",
                "no_tiles": "the scene has a Time Limit, by which parts would have samples of other numbers" if limited else "",
                "no_shares": "the scene has adaptive sampling, which goes by all samples of a pixel: switch it off, or take --tiles" if adaptive else ""}
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise files.Refusal("the saved scene's header has not what was expected: pictures, each with scene, width, height and samples") from error


def examine(scene, options):
    if options.frames:
        raise files.Refusal(f"{scene}: a saved scene is one frame; --frames goes with FILE.blend and FILE.pov")
    said = about(header_of(scene), options.words)
    passes = sum(len(one["passes"]) for one in header_of(scene)["pictures"])
    return {**said, "frames": [None], "inputs": [scene], "programs": ["shade-render"], "layer": said["layer"] if passes > 1 else ""}


def part_words(item, said):
    words = []
    if item.get("tile"):
        x, y, width, height = item["tile"]
        words += ["--tile", f"{x + said['corner'][0]},{y + said['corner'][1]},{width},{height}"]
    if item.get("share"):
        words += ["--share", "{},{}".format(*item["share"])]
    return words


def render(job, item, work, log):
    said = job.said
    part = item.get("tile") or item.get("share")
    name = "part" + ENDING if part else f"{said['name']}.exr"
    log.run([said["programs"]["shade-render"], job.path(said["scene"]), "-o", os.path.join(work, name), "--threads", said["threads"], *said["words"],
             *part_words(item, said)])
    return [name]


def merge(job, frame, parts, work, log):
    name = f"{job.said['name']}.exr"
    merge_shares(job, job.path(job.said["scene"]), [path for _, paths in parts for path in paths], os.path.join(work, name), log)
    return [name]


def merge_shares(job, scene, shares, place, log):
    log.run([job.said["programs"]["shade-render"], scene, "--merge", *shares, "-o", place, "--threads", job.said["threads"]])


def pack(scene, inputs, folder, _options):
    place = os.path.join(folder, os.path.basename(scene))
    shutil.copyfile(scene, place)
    return place
