# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: what our engine hands to its native module of one scene after the other, as files.

    blender -b --factory-startup --addons libshade --python-exit-code 9 -P bench_frames_export.py -- ORDER.json

ORDER.json is a list of {"script": file, "arguments": [...], "output": file, "percentage", "samples": integers, "settings":
{name: value of scene.libshade}}. A script makes its scene and may begin to render it. The output is the scene's
dictionary, pickled, as the add-on of this Blender gives it to the native module of the same build.
"""
import functools
import json
import os
import pickle
import runpy
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import whole  # noqa: E402


class Taken(Exception):
    """The scene is there; it is not to be rendered."""


class Order:
    """What is asked for now."""

    scene = None  # of ORDER.json
    taken = False


def plain(value):
    """Dictionaries, lists, numbers and arrays, whatever they were."""
    if isinstance(value, dict):
        return {key: plain(of) for key, of in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(map(plain, value))
    if value is None or isinstance(value, (bool, int, float, str, bytes, np.ndarray)):
        return value
    return np.array(memoryview(value))


def start(render, given, *before):
    """In the place of the native module's: other pictures than the frame (a sky that is baked) are rendered."""
    frame = bpy.context.scene.render
    size = [side * frame.resolution_percentage // 100 for side in (frame.resolution_x, frame.resolution_y)]
    if [given["width"], given["height"]] != size:
        return render(given, *before)
    with whole.place(Order.scene["output"]) as part:
        part.write_bytes(pickle.dumps(plain(given), protocol=4))
    Order.taken = True
    raise Taken


@bpy.app.handlers.persistent
def prepare(scene, *_):
    """Before a scene is rendered: by our engine, as large as asked for, and only read."""
    scene.render.engine = "LIBSHADE"
    scene.render.resolution_percentage = Order.scene["percentage"]
    for name, value in {"samples": Order.scene["samples"], **Order.scene["settings"]}.items():
        if hasattr(scene.libshade, name):
            setattr(scene.libshade, name, value)
    native = sys.modules["libshade._native"]
    render = getattr(native.start, "args", [native.start])[0]
    native.start = functools.partial(start, render)


def take(scene):
    Order.scene, Order.taken = scene, False
    bpy.ops.wm.read_factory_settings()
    bpy.ops.preferences.addon_enable(module="libshade")
    bpy.app.handlers.render_init.append(prepare)
    sys.argv = ["blender", "--", *scene["arguments"]]
    try:
        if scene["script"].endswith(".blend"):
            bpy.ops.wm.open_mainfile(filepath=scene["script"])
        else:
            runpy.run_path(scene["script"], run_name="__main__")
        if not Order.taken:
            bpy.ops.render.render()
    except RuntimeError:  # of the operator, after Taken
        if not Order.taken:
            raise
    if not Order.taken:
        raise RuntimeError(f"{scene['script']}: rendered without our engine")


def main(path):
    with open(path, encoding="utf-8") as file:
        order = json.load(file)
    for number, scene in enumerate(order):
        take(scene)
        print(f"\n{100 * (number + 1) // len(order)} %", flush=True)


main(sys.argv[sys.argv.index("--") + 1])
sys.exit(0)  # its own status would be 1, for the reports of errors
