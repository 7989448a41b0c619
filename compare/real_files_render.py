# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender, or by the Python of bpy: render one real file for real_files.py.

    blender -b --factory-startup --python-exit-code 9 -P real_files_render.py -- JOB.json

JOB.json is an object of
    "file":     a .blend, or of a kind that this Blender imports (IMPORTS)
    "material": "", or the name of a material of the file, which is then shown on a ball and a box
    "strands":  true: it is shown on hair instead
    "grooves":  true: grooves go with bumps (our engine's *Grooves Follow Bumps*)
    "engine":   "CYCLES" or "LIBSHADE"
    "size":     pixels along the longer side
    "noise", "cap", "seconds": samples are raised until two seeds agree within this (relative mean
                absolute difference of 4 x 4 means), up to so many, or until a picture takes so long
    "threads":  0 is all
    "added":    null, or what was added to the file before: a list of "camera", "light"
    "output":   stem of two OpenEXR files, STEM_1.exr and STEM_2.exr, one for each seed, and of
                STEM.json: {"samples", "noise", "seconds" (of one picture), "added", "blender"}
"""
import json
import os
import sys
import time

import bpy  # first: the Python of bpy knows addon_utils only then
import addon_utils
import numpy as np
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import whole  # noqa: E402

FIRST_SAMPLES = 64
BLACK = 1e-4  # mean of a picture of nothing
# What artists who touch nothing get, the same in both engines, whatever the file says.
SETTINGS = {"max_bounces": 12, "diffuse_bounces": 4, "glossy_bounces": 4, "transmission_bounces": 12,
            "transparent_max_bounces": 8, "sample_clamp_direct": 0.0, "sample_clamp_indirect": 10.0,
            "light_sampling_threshold": 0.01, "blur_glossy": 1.0, "caustics_reflective": True,
            "caustics_refractive": True, "use_adaptive_sampling": False, "use_denoising": False,
            "pixel_filter_type": "BLACKMAN_HARRIS", "filter_width": 1.5, "device": "CPU",
            "use_progressive_refine": False, "time_limit": 0.0,
            # ours alone: images are looked up at points and grooves stay behind bumps, as in Cycles
            "texture_blur": 0.0, "filter_normals": False, "groove_transport": False}

# Kind of file: operators, the first of which that is there reads it; add-ons that bring the latter ones.
IMPORTS = {"gltf": (["import_scene.gltf"], "io_scene_gltf2"), "glb": (["import_scene.gltf"], "io_scene_gltf2"),
           "obj": (["wm.obj_import"], ""), "dae": (["wm.collada_import"], ""),
           "fbx": (["wm.fbx_import", "import_scene.fbx"], "io_scene_fbx"),
           "ply": (["wm.ply_import", "import_mesh.ply"], "io_mesh_ply"),
           "stl": (["wm.stl_import", "import_mesh.stl"], "io_mesh_stl"),
           "x3d": (["import_scene.x3d"], "io_scene_x3d"), "wrl": (["import_scene.x3d"], "io_scene_x3d"),
           **dict.fromkeys(("usd", "usda", "usdc", "usdz"), (["wm.usd_import"], ""))}


def link(name, data):
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def sample(path, name, strands=False):
    """A material on a smooth ball and a box above a grey floor, or on hair."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path) as (there, here):
        if name not in there.materials:
            raise SystemExit(f"{path}: no material '{name}'")
        here.materials = [name]
    shown = bpy.data.materials[name]
    if strands:
        add_strands(shown)
        return
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(-1.1, 0, 1))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(shown)
    bpy.ops.mesh.primitive_cube_add(size=1.6, location=(1.1, 0.2, 0.81), rotation=(0, 0, 0.5))
    bpy.context.object.data.materials.append(shown)
    bpy.ops.mesh.primitive_plane_add(size=12)
    floor = bpy.data.materials.new("floor")
    floor.diffuse_color = (0.5, 0.5, 0.5, 1)  # without nodes: matt
    bpy.context.object.data.materials.append(floor)
    add_camera([Vector((-2, -1, 0)), Vector((2, 1, 2))])


def add_strands(shown):
    """Sixty bent hairs a few pixels wide, curves as Blender has them from 3.5 on (particles lie elsewhere each time); round, not flat."""
    bpy.context.scene.cycles_curves.shape = "THICK"
    chance, along = np.random.default_rng(1), np.linspace(0, 1, 6)[:, None]
    roots = np.stack([chance.uniform(-1.2, 1.2, 60), chance.uniform(-0.4, 0.4, 60), np.full(60, -1.0)], 1)
    bends = chance.normal(0, 0.4, (60, 3)) * (1, 1, 0)
    data = bpy.data.hair_curves.new("hair")
    data.add_curves([len(along)] * len(roots))
    points = roots[:, None] + along * (0, 0, 2) + along**2 * bends[:, None]
    data.points.foreach_set("position", points.astype(np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.tile(np.linspace(0.06, 0.02, len(along), dtype=np.float32), len(roots)))
    data.materials.append(shown)
    link("hair", data)
    add_camera([Vector((-1.2, -0.6, -1)), Vector((1.2, 0.6, 1))])


def opened(job):
    path = job["file"]
    if job["material"]:
        sample(path, job["material"], job["strands"])
    elif path.endswith(".blend"):
        try:
            bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
        except RuntimeError as error:  # libraries that are missing, for one
            print(error)
            if bpy.data.filepath != path:
                raise
    else:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        imported(path)


def imported(path):
    """A file of another program; SystemExit where this Blender does not read its kind."""
    kind = os.path.splitext(path)[1][1:].lower()
    operators, addon = IMPORTS.get(kind, ([], ""))
    for enable in (False, True):
        if enable and addon:
            addon_utils.enable(addon)
        for operator in operators:
            module, name = operator.split(".")
            if name in dir(getattr(bpy.ops, module)):
                return getattr(getattr(bpy.ops, module), name)(filepath=path)
    raise SystemExit(f"{path}: Blender {bpy.app.version_string} imports no .{kind}")


def corners():
    """Of the boxes round all that is rendered."""
    graph = bpy.context.evaluated_depsgraph_get()
    found = []
    for ob in bpy.context.scene.objects:
        if ob.type in {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD"} and not ob.hide_render:
            found += [ob.matrix_world @ Vector(corner) for corner in ob.evaluated_get(graph).bound_box]
    return found or [Vector((-1, -1, -1)), Vector((1, 1, 1))]


def add_camera(points):
    low, high = (Vector(f(p[i] for p in points) for i in range(3)) for f in (min, max))
    middle, radius = (low + high) / 2, max((high - low).length / 2, 1e-3)
    data = bpy.data.cameras.new("added")
    data.lens = 50
    data.clip_start, data.clip_end = radius * 1e-3, radius * 100
    camera = bpy.context.scene.camera = link("added", data)
    towards = Vector((0.5, -1, 0.6)).normalized()
    camera.location = middle + towards * radius * 2.9  # half the width of the view is .36 rad
    camera.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()


def add_light():
    """A sun and a grey world."""
    sun = bpy.data.lights.new("added", "SUN")
    sun.energy, sun.angle = 3.0, 0.1
    link("added", sun).rotation_euler = (0.6, 0.2, 0.9)
    world = bpy.context.scene.world = bpy.data.worlds.new("added")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.4, 0.4, 0.4, 1)


def dark():
    """No lamp, and no world but a black one."""
    scene = bpy.context.scene
    lamps = any(ob.type == "LIGHT" and not ob.hide_render for ob in scene.objects)
    world = scene.world
    return not lamps and (not world or not world.use_nodes and max(world.color) < 1e-3)


def complete(added):
    """What the file lacks: given, or found out here."""
    scene = bpy.context.scene
    if added is None:
        added = ([] if scene.camera else ["camera"]) + (["light"] if dark() else [])
    if "camera" in added:
        add_camera(corners())
    if "light" in added:
        add_light()
    return added


def set_render(job):
    scene = bpy.context.scene
    render = scene.render
    render.engine = job["engine"]
    longer = max(render.resolution_x, render.resolution_y)
    for name in ("resolution_x", "resolution_y"):
        setattr(render, name, max(16, round(getattr(render, name) * job["size"] / longer / 4) * 4))
    render.resolution_percentage = 100
    for name in ("use_border", "use_compositing", "use_sequencer", "use_freestyle", "use_multiview",
                 "use_stamp", "use_file_extension", "use_persistent_data"):
        setattr(render, name, False)
    render.use_single_layer = True
    if job["threads"]:
        render.threads_mode, render.threads = "FIXED", job["threads"]
    image = render.image_settings
    if hasattr(image, "media_type"):  # from 5.0 on
        image.media_type = "IMAGE"
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGBA", "32"
    settings = scene.libshade if job["engine"] == "LIBSHADE" else scene.cycles
    for name, value in (SETTINGS | {"groove_transport": job["grooves"]}).items():
        if hasattr(settings, name):
            setattr(settings, name, value)
    return settings


def picture(path, settings, samples, seed):
    """Render it; returns (pixels, seconds)."""
    settings.samples, settings.seed = samples, seed
    bpy.context.scene.render.filepath = path
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - start
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Linear Rec.709" if bpy.app.version >= (4, 0) else "Linear"
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    width, height = image.size
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[..., :3], seconds


def apart(a, b):
    """Relative mean absolute difference of 4 x 4 means."""
    a, b = (p[:len(p) // 4 * 4].reshape(len(p) // 4, 4, p.shape[1] // 4, 4, 3).mean((1, 3), dtype=float)
            for p in (a, b))
    mean = (a.mean() + b.mean()) / 2
    return float(abs(a - b).mean() / mean) if mean > 0 else 0.0


def pair(job, settings, samples):
    stem = job["output"]
    (first, slow), (second, seconds) = (picture(f"{stem}_{seed}.exr", settings, samples, seed) for seed in (1, 2))
    return first, apart(first, second), min(slow, seconds)


def main(path):
    with open(path, encoding="utf-8") as file:
        job = json.load(file)
    bpy.context.preferences.filepaths.use_scripts_auto_execute = False
    opened(job)
    if job["engine"] == "LIBSHADE":
        addon_utils.enable("libshade")
    added = complete(job["added"])
    settings, samples = set_render(job), FIRST_SAMPLES
    shown, noise, seconds = pair(job, settings, samples)
    if job["added"] is None:  # nothing to see? our own view, then our own light
        for what, add in (("camera", lambda: add_camera(corners())), ("light", add_light)):
            if shown.mean() < BLACK or np.ptp(shown) < 1e-3 * shown.mean():
                if what not in added:
                    added.append(what)
                    add()
                    shown, noise, seconds = pair(job, settings, samples)
    while noise > job["noise"] and samples < job["cap"]:
        more = min(max((noise / job["noise"]) ** 2 * 1.2, 1.5), 16, job["cap"] / samples,
                   job["seconds"] / max(seconds, 1e-3))
        if more < 1.3:
            break
        samples = int(samples * more)
        shown, noise, seconds = pair(job, settings, samples)
    whole.write_text(job["output"] + ".json", json.dumps(
        {"samples": samples, "noise": noise, "seconds": seconds, "added": added,
         "blender": bpy.app.version_string}))
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)  # bpy's own exit hangs in some versions


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1])
