# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: make the scene of an example and keep it, and variants of it, as Blender files.

    blender -b --factory-startup --addons libshade --python-exit-code 9 -P example_scene.py -- \
        MAKE_SCENE.py FOLDER [VARIANTS.json]

FOLDER gets scene.blend, lit for our engine. VARIANTS.json is {name: {property: value}}: for each of them
FOLDER gets NAME.blend, the same scene with these properties of every Libshade Metal node.
"""
import importlib.util
import inspect
import json
import os
import sys
import types

import bpy


class NoPictures:
    """bpy.ops for an example that renders as soon as it is read: its picture is not wanted."""

    def __init__(self, ops):
        self._ops = ops
        self.render = types.SimpleNamespace(render=lambda *_args, **_values: {"FINISHED"})

    def __getattr__(self, name):
        return getattr(self._ops, name)


def build(script, folder):
    """The example's scene, open."""
    sys.argv[sys.argv.index("--") + 1:] = [os.path.join(folder, "example.blend")]
    spec = importlib.util.spec_from_file_location("example", script)
    example = importlib.util.module_from_spec(spec)
    kept, bpy.ops = bpy.ops, NoPictures(bpy.ops)
    try:
        spec.loader.exec_module(example)
    finally:
        bpy.ops = kept
    if hasattr(example, "build"):
        values = {"folder": folder, "near": False}
        example.build(*[values[name] for name in inspect.signature(example.build).parameters])
    bpy.context.scene.libshade.max_bounces = 0


def metals():
    return [node for material in bpy.data.materials if material.use_nodes
            for node in material.node_tree.nodes if node.bl_idname == "LibshadeMetalNode"]


def save(path):
    for image in bpy.data.images:
        if image.source == "GENERATED" and image.is_dirty:  # else its pixels are not in the file
            image.pack()
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True, relative_remap=True)


def main(script, folder, variants=""):
    build(os.path.abspath(script), folder)
    bpy.context.scene.render.engine = "LIBSHADE"
    save(os.path.join(folder, "scene.blend"))
    if variants:
        with open(variants, encoding="utf-8") as file:
            wanted = json.load(file)
        kept = [{name: getattr(node, name) for values in wanted.values() for name in values} for node in metals()]
        for name, values in wanted.items():
            for node, before in zip(metals(), kept):
                for key, value in {**before, **values}.items():
                    setattr(node, key, value)
            save(os.path.join(folder, f"{name}.blend"))


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1:])
