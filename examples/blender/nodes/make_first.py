# SPDX-License-Identifier: Apache-2.0
"""The first picture of the manual (docs/start/blender.md), step by step as it says, in half its size.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup --addons libshade --python-exit-code 1 \
        -P examples/blender/nodes/make_first.py -- PICTURE.png
"""
import math
import os
import sys
from pathlib import Path

import addon_utils
import bpy


def asset(name):
    """What dragging it from the Asset Browser brings."""
    addon = next(module for module in addon_utils.modules() if module.__name__.split(".")[-1] == "libshade")
    with bpy.data.libraries.load(str(Path(addon.__file__).parent / "assets/metals.blend")) as (_there, here):
        here.materials = [name]
    return here.materials[0]


def main(picture):
    scene, world = bpy.context.scene, bpy.context.scene.world
    for name in ("Cube", "Light"):
        bpy.data.objects.remove(bpy.data.objects[name])
    bpy.ops.mesh.primitive_monkey_add()
    bpy.ops.object.shade_smooth()
    bpy.ops.object.subdivision_set(level=2)
    monkey = bpy.context.object
    bpy.ops.mesh.primitive_plane_add(location=(0, 0, -1))
    bpy.context.object.scale = 20, 20, 20
    scene.render.engine = "LIBSHADE"
    monkey.data.materials.append(asset("Turned brass"))
    tree = world.node_tree
    sky, background = tree.nodes.new("ShaderNodeTexSky"), tree.nodes["Background"]
    tree.links.new(sky.outputs["Color"], background.inputs["Color"])
    background.inputs["Strength"].default_value = 0.05
    sky.sun_elevation, sky.sun_rotation = math.radians(30), math.radians(200)
    scene.render.resolution_percentage, scene.render.filepath = 50, os.path.abspath(picture)
    bpy.ops.render.render(write_still=True)


main(sys.argv[sys.argv.index("--") + 1])
