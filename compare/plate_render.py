# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: render the plate of plate.py, or the sphere of sphere.py, once per job.

    blender -b --factory-startup [--addons libshade] --python-exit-code 2 \
        -P plate_render.py -- JOBS.json

JOBS.json is {"normal_map": file, "mesh": file or "", "result": file, "jobs": [job, ...]}; the
mesh, if there is one, is an .npz of positions, faces and uv that takes the place of the
displaced plate, with smooth normals of its own. A job is
    "engine":   "CYCLES" or "LIBSHADE"
    "shape":    "plate", as where there is none, or "sphere"; the normal map is of that
    "surface":  "flat", "bumped" (normal map) or "displaced" (mesh)
    "detail":   libshade's detail method (LIBSHADE only); without it the metal is Cycles' own node
    "ggx":      if it is there, roughness and anisotropy of GGX in the place of Ashikhmin-Shirley's lobe
    "sky":      if there is one, a picture that lights the plate in the sun's place, by up to BOUNCES
    "bounces":  in the place of BOUNCES
    "horizon":  in the place of the plain formula (LIBSHADE only)
    "color":    of the metal, 1 if there is none
    "eye":      the camera's elevation in degrees, 90 if there is none; "tiles": how many plates lie beside each other
    "seed":     of the noise, 0 if there is none
    "size", "samples", "quads": integers
    "repeat":   how often to render for time; the seconds of each go to the result file
    "output":   OpenEXR file for the picture, or "" for none (costs one more render)
"""
import json
import os
import sys
import time

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import plate  # noqa: E402
import sphere  # noqa: E402
import whole  # noqa: E402

BOUNCES = 4  # under a sky


def parts_of(job, file):
    """(positions, normals or None where they are the mesh's own, faces, uv); a file's are of a displaced plate."""
    displaced = job["surface"] == "displaced"
    if displaced and file:
        stored = np.load(file)
        return stored["positions"], None, stored["faces"], stored["uv"]
    if job.get("shape") == "sphere":
        return sphere.mesh(job["quads"] if displaced else sphere.FLAT, displaced)
    positions, normals, faces, uv = plate.mesh(job["quads"] if displaced else 1)
    tiles = job.get("tiles", 1)
    return positions * tiles, normals if displaced else None, faces, (uv - 0.5) * tiles + 0.5


def new_mesh(positions, normals, faces, uv):
    """Quads with UVs, and smooth normals of their own or given ones."""
    mesh = bpy.data.meshes.new("plate")
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    mesh.loops.add(faces.size)
    mesh.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, 4, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(len(faces), 4, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), dtype=bool))
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", uv[faces.ravel()].astype(np.float32).ravel())
    mesh.update(calc_edges=True)
    if normals is not None:
        if hasattr(mesh, "use_auto_smooth"):  # removed in Blender 4.1
            mesh.use_auto_smooth = True
            mesh.auto_smooth_angle = np.pi
        mesh.normals_split_custom_set_from_vertices(normals.tolist())
    return mesh


def normal_map_node(tree, image):
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    node = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    return node


def new_material(job, image):
    """The metal, as libshade's or as Cycles' node."""
    material = bpy.data.materials.new("metal")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    if "detail" in job:
        metal = tree.nodes.new("LibshadeMetalNode")
        metal.ex, metal.ey = plate.EX, plate.EY
        metal.detail = job["detail"].upper()
        metal.fresnel = "NONE"
        metal.horizon = job.get("horizon", "HARD")  # the plain formula, by which the detail methods are compared
        if "ggx" in job:
            roughness, anisotropy = job["ggx"]
            metal.distribution, metal.brdf = "GGX", "MICROFACET"
            metal.ax, metal.ay = roughness**2 * (1 - anisotropy), roughness**2 / (1 - anisotropy)
    else:
        metal = tree.nodes.new("ShaderNodeBsdfAnisotropic")
        metal.distribution = "GGX" if "ggx" in job else "ASHIKHMIN_SHIRLEY"
        metal.inputs["Roughness"].default_value, metal.inputs["Anisotropy"].default_value = \
            job.get("ggx", (plate.ROUGHNESS, plate.ANISOTROPY))
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = "UV_MAP"
        tree.links.new(tangent.outputs["Tangent"], metal.inputs["Tangent"])
    metal.inputs["Color"].default_value = (*[job.get("color", 1.0)] * 3, 1.0)
    if job["surface"] == "bumped":
        node = normal_map_node(tree, image)
        tree.links.new(node.outputs["Normal"], metal.inputs["Normal"])
    tree.links.new(metal.outputs["BSDF"], output.inputs["Surface"])
    return material


_meshes = {}


def shared_mesh(job, image, file):
    """With its material: one for all scenes of the same, for a displaced plate has a million quads."""
    told = json.dumps({key: value for key, value in sorted(job.items()) if key not in ("sky", "seed", "output", "samples", "repeat")})
    if told not in _meshes:
        _meshes[told] = new_mesh(*parts_of(job, file))
        _meshes[told].materials.append(new_material(job, image))
    return _meshes[told]


def new_sun(scene):
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = 1.0, 0.0
    sun = bpy.data.objects.new("sun", light)
    sun.rotation_euler = Vector(plate.SUN).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(sun)


def new_world(file):
    """Black, or the picture."""
    world = bpy.data.worlds.new("world")
    world.color = (0.0, 0.0, 0.0)
    if bpy.app.version >= (5, 0):  # a world always has nodes, whose background is grey
        next(n for n in world.node_tree.nodes if n.type == "BACKGROUND").inputs["Strength"].default_value = bool(file)
    if file:
        world.use_nodes = True
        tree = world.node_tree
        sky = tree.nodes.new("ShaderNodeTexEnvironment")
        sky.image = bpy.data.images.load(file, check_existing=True)
        background = next(n for n in tree.nodes if n.type == "BACKGROUND")
        tree.links.new(sky.outputs["Color"], background.inputs["Color"])
    return world


def new_scene(job, image, file="", sky=""):
    """Plate, sun or sky, and a camera straight above or aslant, filling the picture."""
    scene = bpy.data.scenes.new("plate")
    scene.collection.objects.link(bpy.data.objects.new("plate", shared_mesh(job, image, file)))

    if not sky:
        new_sun(scene)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 1.0
    above = bpy.data.objects.new("camera", camera)
    eye = np.radians(job.get("eye", 90))
    above.location = (0.0, -5.0 * np.cos(eye), 5.0 * np.sin(eye))
    above.rotation_euler = (np.pi / 2 - eye, 0.0, 0.0)
    scene.collection.objects.link(above)
    scene.camera = above

    scene.world = new_world(sky)

    render = scene.render
    render.engine = job["engine"]
    render.resolution_x = render.resolution_y = job["size"]
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    scene.display_settings.display_device = "sRGB"
    scene.view_settings.view_transform = "Standard"
    settings = scene.libshade if job["engine"] == "LIBSHADE" else scene.cycles
    if job["engine"] == "CYCLES" and "bounces" in job:
        settings.diffuse_bounces = settings.glossy_bounces = job["bounces"]
    for name, value in {
        "samples": job["samples"], "max_bounces": job.get("bounces", BOUNCES) if sky else 0, "pixel_filter_type": "BOX",
        "use_adaptive_sampling": False, "use_denoising": False, "light_sampling_threshold": 0.0,
        "sample_clamp_direct": 0.0, "sample_clamp_indirect": 0.0, "blur_glossy": 0.0,
        "soft_terminator": False, "filter_normals": False, "seed": job.get("seed", 0),
    }.items():
        if hasattr(settings, name):
            setattr(settings, name, value)
    return scene


def render(scene, **options):
    """Seconds of one render."""
    bpy.context.window.scene = scene
    start = time.perf_counter()
    bpy.ops.render.render(scene=scene.name, **options)
    return time.perf_counter() - start


def main(path):
    with open(path, encoding="utf-8") as file:
        order = json.load(file)
    jobs = order["jobs"]
    image = bpy.data.images.load(order["normal_map"])
    image.colorspace_settings.name = "Non-Color"
    scenes = [new_scene(job, image, order.get("mesh", ""), job.get("sky", ""))
              for job in jobs]
    seconds = [[] for _ in jobs]
    # In turns, so that a machine that is busy for a while slows all of them.
    for turn in range(max(job["repeat"] for job in jobs)):
        for job, scene, times in zip(jobs, scenes, seconds):
            if turn < job["repeat"]:
                times.append(render(scene))
    for job, scene in zip(jobs, scenes):
        if job["output"]:
            scene.render.filepath = job["output"]
            render(scene, write_still=True)
    whole.write_text(order["result"],
                     json.dumps({"seconds": seconds, "blender": bpy.app.version_string}))


main(sys.argv[sys.argv.index("--") + 1])
