# SPDX-License-Identifier: Apache-2.0
"""Lists of commands, .items: work that is no picture. JSON: {"folder": where they run, "inputs": [files that they read],
"items": [{"name": what it is, "words": [the command]}]}. An item's result is that its command has ended well."""

import os
import shutil

import files


def examine(scene, options):
    said = files.read_json(scene)
    try:
        items = said["items"]
        names = [one["name"] for one in items]
        folder, inputs = said["folder"], said["inputs"]
        if not items or not all(isinstance(one["words"], list) and all(isinstance(word, str) for word in one["words"]) for one in items):
            raise TypeError
    except (KeyError, TypeError) as error:
        raise files.Refusal(f"{scene}: JSON with folder, inputs and items, each with a name and words, was expected") from error
    if options.frames:
        raise files.Refusal(f"{scene}: commands have no frames")
    why = "commands have neither tiles nor shares"
    return {"frames": list(range(len(items))), "names": names, "inputs": [scene, *(os.path.join(folder, one) for one in inputs)], "programs": [],
            "no_tiles": why, "no_shares": why, "no_frames": True}


def render(job, item, work, log):
    said = files.read_json(job.path(job.said["scene"]))
    log.run(said["items"][item["frame"]]["words"], folder=said["folder"])
    name = f"{item['frame']}.txt"
    with open(os.path.join(work, name), "w", encoding="utf-8") as file:
        file.write("done\n")
    return [name]


def pack(scene, _inputs, folder, _options):
    place = os.path.join(folder, os.path.basename(scene))
    shutil.copyfile(scene, place)
    return place
