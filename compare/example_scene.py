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

import bpy


def build(script, folder):
    """The example's scene, open. Examples that make a picture get one in the folder."""
    sys.argv[sys.argv.index("--") + 1:] = [os.path.join(folder, "example.blend")]
    spec = importlib.util.spec_from_file_location("example", script)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    if hasattr(example, "build"):
        values = {"folder": folder, "near": False}
        example.build(*[values[name] for name in inspect.signature(example.build).parameters])
    bpy.context.scene.libshade.max_bounces = 0


def metals():
    return [node for material in bpy.data.materials if material.use_nodes
            for node in material.node_tree.nodes if node.bl_idname == "LibshadeMetalNode"]


def save(path):
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


main(*sys.argv[sys.argv.index("--") + 1:])
