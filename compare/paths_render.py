# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: render the two scenes of paths.py, once per job.

    blender -b --factory-startup --addons libshade --python-exit-code 9 \
        -P paths_render.py -- JOBS.json

JOBS.json is {"sky": OpenEXR file, "result": file, "jobs": [job, ...]}. A job is
    "engine":  "CYCLES" or "LIBSHADE"
    "scene":   "studio" or "room"
    "size", "samples", "seed": integers
    "output":  OpenEXR file for the picture
The result file gets {"blender": version, "seconds": [of each job's render operator]}.
"""
import json
import math
import os
import sys
import time

import bpy
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import whole  # noqa: E402

BOUNCES = {"studio": 4, "room": 8}


def material(name, kind, color, **sockets):
    """One shader node, of type ShaderNodeBsdf<kind>, joined to the output."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    output, shader = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeBsdf" + kind)
    if hasattr(shader, "distribution"):
        shader.distribution = "GGX"
    shader.inputs["Color"].default_value = (*color, 1.0)
    for socket, value in sockets.items():
        shader.inputs[socket].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def brushed():
    """GGX with alphas .05 and .3. Cycles: alphas r² (1 - a) and r² / (1 - a)."""
    roughness, anisotropy = math.sqrt(math.sqrt(0.05 * 0.3)), 1.0 - math.sqrt(0.05 / 0.3)
    made = material("brushed", "Anisotropic", (0.9, 0.75, 0.5), Roughness=roughness,
                    Anisotropy=anisotropy)
    tree = made.node_tree
    tangent = tree.nodes.new("ShaderNodeTangent")
    tangent.direction_type = "UV_MAP"  # left out, it runs round the object's Z axis
    shader = next(n for n in tree.nodes if "Tangent" in n.inputs)
    tree.links.new(tangent.outputs["Tangent"], shader.inputs["Tangent"])
    return made


def link(scene, name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    ob = bpy.data.objects.new(name, data)
    ob.location, ob.rotation_euler = location, rotation
    scene.collection.objects.link(ob)
    return ob


def take(scene, name, surface, smooth=True):
    """The object that an operator has just made, moved to this scene."""
    ob = bpy.context.active_object
    ob.name = name
    ob.data.materials.append(surface)
    ob.data.polygons.foreach_set("use_smooth", [smooth] * len(ob.data.polygons))
    return ob


def things(scene):
    """Suzanne subdivided twice, two spheres and the floor."""
    bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 1), rotation=(-0.6, 0, 0.3))
    suzanne = take(scene, "suzanne", brushed())
    suzanne.modifiers.new("smooth", "SUBSURF").levels = 2
    suzanne.modifiers["smooth"].render_levels = 2
    balls = ((-1.7, 0.3, 0.6), material("matt", "Diffuse", (0.6, 0.2, 0.15))), \
        ((1.7, 0.2, 0.6), material("gloss", "Glossy", (0.8, 0.8, 0.85), Roughness=math.sqrt(0.1)))
    for place, surface in balls:
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.6, location=place)
        take(scene, "ball", surface)


def box(scene, low, high, surface):
    """Closed, seen from within."""
    x, y, z = zip(low, high)
    corners = [(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new("box")
    mesh.from_pydata(corners, [], faces)
    mesh.materials.append(surface)
    link(scene, "box", mesh)


def world_of(sky):
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    tree = world.node_tree
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    if not sky:
        background.inputs["Color"].default_value = (0, 0, 0, 1)
        return world
    image = tree.nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(sky, check_existing=True)
    tree.links.new(image.outputs["Color"], background.inputs["Color"])
    return world


def build(job, sky):
    """The scene of one job, in the current scene's place."""
    scene = bpy.data.scenes.new(job["scene"])
    bpy.context.window.scene = scene
    grey = material("grey", "Diffuse", (0.5, 0.5, 0.5))
    things(scene)
    if job["scene"] == "studio":
        bpy.ops.mesh.primitive_plane_add(size=40)
        take(scene, "floor", grey, False)
        scene.world = world_of(sky)
    else:
        box(scene, (-4, -7, 0), (4, 4, 5), grey)
        light = bpy.data.lights.new("area", "AREA")
        light.energy, light.size = 400.0, 2.0
        link(scene, "area", light, (0, -1, 4.95))
        scene.world = world_of("")
    camera = bpy.data.cameras.new("camera")
    camera.lens = 45
    eye = Vector((0, -6.5, 2.4))
    turn = (Vector((0, 0, 0.9)) - eye).to_track_quat("-Z", "Y").to_euler()
    scene.camera = link(scene, "camera", camera, eye, turn)
    set_render(scene, job)
    return scene


def set_render(scene, job):
    render, size = scene.render, job["size"]
    render.engine = job["engine"]
    render.resolution_x = render.resolution_y = size
    render.resolution_percentage = 100
    render.filepath = job["output"]
    render.use_file_extension = False
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    scene.view_settings.view_transform = "Standard"
    bounces = BOUNCES[job["scene"]]
    settings = scene.libshade if job["engine"] == "LIBSHADE" else scene.cycles
    values = {"samples": job["samples"], "seed": job["seed"], "max_bounces": bounces,
              "diffuse_bounces": bounces, "glossy_bounces": bounces, "blur_glossy": 0.0,
              "sample_clamp_direct": 0.0, "sample_clamp_indirect": 0.0,
              "light_sampling_threshold": 0.0, "pixel_filter_type": "BOX",
              "use_adaptive_sampling": False, "use_denoising": False, "filter_normals": False}
    for name, value in values.items():
        if hasattr(settings, name):
            setattr(settings, name, value)


def main(path):
    with open(path, encoding="utf-8") as file:
        order = json.load(file)
    seconds = []
    for job in order["jobs"]:
        scene = build(job, order["sky"])
        start = time.perf_counter()
        bpy.ops.render.render(scene=scene.name, write_still=True)
        seconds.append(time.perf_counter() - start)
        print(f"\n{100 * len(seconds) // len(order['jobs'])} %", flush=True)
    whole.write_text(order["result"],
                     json.dumps({"blender": bpy.app.version_string, "seconds": seconds}))


main(sys.argv[sys.argv.index("--") + 1])
