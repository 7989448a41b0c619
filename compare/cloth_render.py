# SPDX-License-Identifier: Apache-2.0
"""Inside Blender: a cloth by our engine's near model and by Cycles, for compare/cloth_cycles.py.

A request a line on standard input, JSON: {"preset", "scene" (plane, ball), "engine", "picture", "even", "samples", "side"}; even: without
what varies from yarn to yarn, which differs by chance between the two. Answers DONE on a line.
"""
import importlib
import json
import math
import os
import sys

import bpy

MODULE = os.environ.get("LIBSHADE_MODULE", "libshade")
VARIED = ("vary_brightness", "vary_tilt", "along_brightness", "along_tilt", "slub")
ACROSS = {"plane": 20, "ball": 320}  # crossings in a unit of the UV map, about


def begin(request):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if MODULE not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module=MODULE)
    scene = bpy.context.scene
    render, side = scene.render, request["side"]
    render.engine = request["engine"]
    render.resolution_x = render.resolution_y = side
    render.resolution_percentage = 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.film_transparent = True
    scene.libshade.samples = scene.cycles.samples = request["samples"]
    scene.libshade.max_bounces = 1
    scene.cycles.max_bounces = 1
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = scene.libshade.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 0.01
    world = scene.world = bpy.data.worlds.new("sky")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.35, 0.35, 0.35, 1)
    return scene


def lamp(scene, energy, angles):
    data = bpy.data.lights.new("sun", "SUN")
    data.energy, data.angle = energy, 0.2
    item = bpy.data.objects.new("sun", data)
    item.rotation_euler = angles
    scene.collection.objects.link(item)


def cloth(request):
    material = bpy.data.materials.new("cloth")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new("LibshadeFabricNode"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    node.preset, node.distance = request["preset"], "NEAR"
    for word in VARIED if request["even"] else ():
        for yarn in ("warp", "weft"):
            setattr(node, f"{yarn}_{word}", 0.0)
    native = importlib.import_module(f"{MODULE}._native")
    counts = native.cloth(request["preset"].lower())["counts"]
    node.size = ACROSS[request["scene"]] / (100 * math.sqrt(counts[0] * counts[1]))
    return material


def build(request):
    scene = begin(request)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.type, camera.location = "ORTHO", (0, 0, 4)
    if request["scene"] == "plane":
        bpy.ops.mesh.primitive_plane_add(size=2, rotation=(0.5, 0.2, 0.15))
        camera.data.ortho_scale = 1.2
    else:
        bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=1.0, rotation=(1.2, 0.3, 0.5))
        bpy.ops.object.shade_smooth()
        for loop in bpy.context.object.data.uv_layers.active.data:  # as long as wide
            loop.uv.x *= 2
        camera.data.ortho_scale = 2.1
    bpy.context.object.data.materials.append(cloth(request))
    lamp(scene, 2.2, (0.75, 0.3, 0))
    lamp(scene, 0.8, (-0.9, -0.9, 0))


def main():
    for line in sys.stdin:
        request = json.loads(line)
        build(request)
        bpy.context.scene.render.filepath = request["picture"][:-4]
        bpy.ops.render.render(write_still=True)
        print("DONE", flush=True)
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
