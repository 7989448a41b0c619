# SPDX-License-Identifier: Apache-2.0
"""Cloths by name, hanging in folds; with `near` a few centimetres of each, where yarns are seen.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade --python-exit-code 1 -P make_scene.py -- PICTURE.png [near]
"""
import math
import os
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

CLOTHS = ("SILK_CHARMEUSE", "DENIM", "SHOT_TAFFETA", "HERRINGBONE_TWEED", "LINEN")
WIDTH, HEIGHT, STEPS = 0.8, 1.6, 192  # of each, metres as it hangs


def cloth(preset):
    """One unit of the UV map is a metre."""
    material = bpy.data.materials.new(preset)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new("LibshadeFabricNode"), tree.nodes.new("ShaderNodeOutputMaterial")
    node.preset, node.size = preset, 1.0
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    return material


def fold(s, t):
    """How far it hangs forward at s from left to right and t from the top, both in [0, 1]."""
    wide = math.sin(5 * math.pi * s + 0.7 * math.sin(2.1 * t)) + 0.35 * math.sin(11.3 * math.pi * s + t)
    return 0.06 * (0.35 + 0.65 * t) * wide


def curtain(preset, left):
    rows = STEPS // 2
    places, along = [], []
    for k in range(rows + 1):
        line = [(left + WIDTH * i / STEPS, -fold(i / STEPS, k / rows), HEIGHT * (1 - k / rows))
                for i in range(STEPS + 1)]
        length = [0.0]
        for a, b in zip(line, line[1:]):
            length.append(length[-1] + math.dist(a, b))
        places += line
        along += [(u - length[-1] / 2, z) for u, (_x, _y, z) in zip(length, line)]
    wide = STEPS + 1
    faces = [(k * wide + i, (k + 1) * wide + i, (k + 1) * wide + i + 1, k * wide + i + 1)
             for k in range(rows) for i in range(STEPS)]
    mesh = bpy.data.meshes.new(preset)
    mesh.from_pydata(places, [], faces)
    uv = mesh.uv_layers.new().data
    for loop in mesh.loops:
        uv[loop.index].uv = along[loop.vertex_index]
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    mesh.materials.append(cloth(preset))
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(preset, mesh))


def patches(size):
    """Flat pieces side by side."""
    for k, preset in enumerate(CLOTHS):
        bpy.ops.mesh.primitive_plane_add(size=size, location=(size * (k - len(CLOTHS) / 2 + 0.5), 0, 0),
                                         rotation=(math.pi / 2, 0, 0))
        plane = bpy.context.object.data
        for loop in plane.uv_layers.active.data:
            loop.uv *= size
        plane.materials.append(cloth(preset))


def lamp(power, place, turn, size):
    data = bpy.data.lights.new("lamp", "AREA")
    data.energy, data.size = power, size
    item = bpy.data.objects.new("lamp", data)
    item.location, item.rotation_euler = place, turn
    bpy.context.scene.collection.objects.link(item)


def build(near):
    scene = parts.begin()
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    size = 0.012
    if near:
        patches(size)
        data.type, data.ortho_scale = "ORTHO", size * len(CLOTHS)
        data.clip_start = 1e-4
        camera.location = (0, -0.2, 0)
        lamp(4, (-0.25, -0.3, 0.3), (0.8, 0, -0.7), 0.1)
    else:
        for k, preset in enumerate(CLOTHS):
            curtain(preset, (k - len(CLOTHS) / 2) * (WIDTH + 0.03))
        camera.location, data.lens = (0, -5.2, 0.8), 44
        lamp(260, (-2.6, -2.5, 2.2), (1.05, 0, -0.8), 0.5)
        lamp(60, (2.8, -2.5, 1.2), (1.3, 0, 0.85), 1.2)
    camera.rotation_euler = (math.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    parts.room((0.1, 0.1, 0.1))


def main(path, near):
    build(near)
    scene = bpy.context.scene
    render = scene.render
    render.engine = "LIBSHADE"
    render.resolution_x, render.resolution_y, render.resolution_percentage = 960, 192 if near else 400, 100
    scene.libshade.samples = 128
    scene.view_settings.view_transform = "Standard"
    render.filepath = os.path.abspath(path)
    render.image_settings.file_format = "PNG"
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if len(words) not in (1, 2) or words[1:] not in ([], ["near"]):
        sys.exit("usage: blender -b … -P make_scene.py -- PICTURE.png [near]")
    main(words[0], words[1:] == ["near"])
