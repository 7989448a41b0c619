# SPDX-License-Identifier: Apache-2.0
"""Brushed metal that reflects: a pot lid, a ring and a monkey on a table under an even sky and a lamp.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade --python-exit-code 1 -P make_scene.py -- PICTURE.png
"""
import os
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

STEEL, BRASS = (0.60, 0.585, 0.565), (0.91, 0.70, 0.32)


def metal(name, color, ex, ey):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new("LibshadeMetalNode"), tree.nodes.new("ShaderNodeOutputMaterial")
    node.ex, node.ey = ex, ey
    node.inputs["Color"].default_value = (*color, 1)
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    return material


def matt(name, color, roughness=0.6):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1)
    inputs["Roughness"].default_value = roughness
    return material


def body(material):
    """What was made last gets a material and smooth faces."""
    bpy.context.object.data.materials.append(material)
    bpy.ops.object.shade_smooth()
    return bpy.context.object


def build():
    scene, ops = parts.begin(), bpy.ops.mesh
    ops.primitive_plane_add(size=30)
    body(matt("table", (0.30, 0.17, 0.10)))
    ops.primitive_cube_add(size=1.5, location=(-2.7, 1.3, 0.75), rotation=(0, 0, 0.5))
    bpy.context.object.data.materials.append(matt("blue", (0.08, 0.16, 0.45)))
    ops.primitive_uv_sphere_add(segments=128, ring_count=64, radius=0.9, location=(-0.9, 0, 0.9))
    body(metal("turned steel", STEEL, 4, 900))
    ops.primitive_torus_add(major_segments=128, minor_segments=48, major_radius=0.8, minor_radius=0.28,
                            location=(1.0, -1.2, 0.28))
    body(metal("brushed brass", BRASS, 900, 12))
    ops.primitive_monkey_add(size=1.9, location=(1.6, 1.1, 0.82), rotation=(-0.55, 0, 0.35))
    monkey = body(metal("gold", (1.0, 0.78, 0.34), 150, 150))
    monkey.modifiers.new("smooth", "SUBSURF").render_levels = 2

    lamp = bpy.data.lights.new("lamp", "POINT")
    lamp.energy, lamp.shadow_soft_size, lamp.color = 700, 0.5, (1, 0.85, 0.7)
    place = bpy.data.objects.new("lamp", lamp)
    place.location = (3.5, -3, 5)
    scene.collection.objects.link(place)

    parts.room((0.35, 0.45, 0.6))

    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler, camera.data.lens = (0.1, -8.6, 4.3), (1.13, 0, 0.0), 46
    scene.collection.objects.link(camera)
    scene.camera = camera


def main(path):
    build()
    scene = bpy.context.scene
    render = scene.render
    render.engine = "LIBSHADE"
    render.resolution_x, render.resolution_y, render.resolution_percentage = 960, 480, 100
    scene.libshade.samples = 256
    scene.view_settings.view_transform = "Standard"
    render.filepath = os.path.abspath(path)
    render.image_settings.file_format = "PNG"
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    if "--" not in sys.argv or len(sys.argv) != sys.argv.index("--") + 2:
        sys.exit("usage: blender -b … -P make_scene.py -- PICTURE.png")
    main(sys.argv[-1])
