# SPDX-License-Identifier: Apache-2.0
"""What the scenes share: turned bodies, materials of sockets, Blender's studio skies, a camera, the picture."""
import importlib
import math
import os
import sys

import addon_utils
import bpy
import numpy as np
from mathutils import Vector


def begin():
    """An empty file; the add-on is on."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)  # add-ons stay as they are
    name = _addon()
    if name not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module=name)
    return bpy.context.scene


def _addon():
    """What it is called: an extension, or a folder of scripts."""
    found = [module.__name__ for module in addon_utils.modules() if module.__name__.split(".")[-1] == "libshade"]
    if not found:
        sys.exit("libshade is not there: install its zip, or set BLENDER_USER_SCRIPTS=build/blender after `make blender`")
    return found[0]


def of_addon(name):
    """A module of it."""
    return importlib.import_module(f"{_addon()}.{name}")


def material(name, kind):
    """A material of one shader node: (material, node)."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made, node


def metal(name, color, roughness, anisotropy=0.0, grain="UV", rotation=0.0):
    made, node = material(name, "LibshadeMetalNode")
    node.grain, node.strokes = grain, 0.0
    for socket, value in (("Color", (*color, 1)), ("Roughness", roughness), ("Anisotropy", anisotropy), ("Rotation", rotation)):
        node.inputs[socket].default_value = value
    return made


def cloth(name, preset, size):
    """A cloth of libshade's; one unit of the UV map is `size` metres of it."""
    made, node = material(name, "LibshadeFabricNode")
    node.preset, node.size = preset, size
    return made


def plain(name, color, roughness=0.5):
    made, node = material(name, "ShaderNodeBsdfPrincipled")
    node.inputs["Base Color"].default_value = (*color, 1)
    node.inputs["Roughness"].default_value = roughness
    return made


def place(name, mesh, made, location=(0, 0, 0), rotation=(0, 0, 0), smooth=True):
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), smooth))
    mesh.materials.append(made)
    item = bpy.data.objects.new(name, mesh)
    item.location, item.rotation_euler = location, rotation
    bpy.context.scene.collection.objects.link(item)
    return item


def grid(points, closed=False):
    """Faces of rows of points, (rows, columns, 3); `closed`: the last column meets the first. Its UV map
    runs along the columns (u) and rows (v), by their lengths."""
    rows, columns = points.shape[:2]
    if closed:
        points, columns = np.concatenate([points, points[:, :1]], 1), columns + 1
    across = np.linalg.norm(np.diff(points, axis=1), axis=2).mean(0)
    along = np.linalg.norm(np.diff(points, axis=0), axis=2).mean(1)
    u, v = (np.concatenate([[0], np.cumsum(step)]) for step in (across, along))
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    faces = np.stack([first, first + 1, first + columns + 1, first + columns], -1)
    mesh = bpy.data.meshes.new("grid")
    mesh.from_pydata(points.reshape(-1, 3).tolist(), [], faces.tolist())
    uv = np.stack(np.meshgrid(u, v), -1).reshape(-1, 2)[faces.ravel()]
    mesh.uv_layers.new().data.foreach_set("uv", uv.astype(np.float32).ravel())
    return mesh


def turned(profile, segments=192):
    """A body of revolution about z: `profile` lists (radius, height), outwards side to the right of its way."""
    profile = np.asarray(profile, float)
    angle = 2 * math.pi * np.arange(segments) / segments
    radius, height = profile.T
    points = np.stack([radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle),
                       np.repeat(height[:, None], segments, 1)], -1)
    return grid(points, closed=True)


def rounded(corners, radius, steps=6):
    """A line through `corners`, (x, y), its inner corners rounded off, as far as their sides are long."""
    corners = [np.asarray(c, float) for c in corners]
    line = [corners[0]]
    for before, at, after in zip(corners, corners[1:], corners[2:]):
        a, b = before - at, after - at
        reach = min(radius, np.linalg.norm(a) / 2, np.linalg.norm(b) / 2)
        start, end = at + a / np.linalg.norm(a) * reach, at + b / np.linalg.norm(b) * reach
        line += [(1 - t)**2 * start + 2 * t * (1 - t) * at + t * t * end for t in np.linspace(0, 1, steps)]
    return np.array([*line, corners[-1]])


def sky(picture, strength=1.0, turn=0.0, seen=(0.05, 0.05, 0.05)):
    """One of the skies that come with Blender lights the scene; the camera sees the colour `seen`."""
    path = os.path.join(bpy.utils.system_resource("DATAFILES", path="studiolights/world"), f"{picture}.exr")
    if not os.path.isfile(path):
        sys.exit(f"studiolights/world/{picture}.exr: not among Blender's files (Debian's package blender-data)")
    world = bpy.context.scene.world = bpy.data.worlds.new(picture)
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    new, link = tree.nodes.new, tree.links.new
    spot, mapping, image = new("ShaderNodeTexCoord"), new("ShaderNodeMapping"), new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(path)
    mapping.inputs["Rotation"].default_value[2] = turn
    light, behind, mix = new("ShaderNodeBackground"), new("ShaderNodeBackground"), new("ShaderNodeMixShader")
    rays, output = new("ShaderNodeLightPath"), new("ShaderNodeOutputWorld")
    light.inputs["Strength"].default_value = strength
    behind.inputs["Color"].default_value = (*seen, 1)
    link(spot.outputs["Generated"], mapping.inputs["Vector"])
    link(mapping.outputs["Vector"], image.inputs["Vector"])
    link(image.outputs["Color"], light.inputs["Color"])
    link(rays.outputs["Is Camera Ray"], mix.inputs[0])
    link(light.outputs[0], mix.inputs[1])
    link(behind.outputs[0], mix.inputs[2])
    link(mix.outputs[0], output.inputs["Surface"])


def room(color):
    """An even light from everywhere, in each Blender: since 5.0 a world's own colour is not read."""
    world = bpy.context.scene.world = bpy.data.worlds.new("room")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1)


def lamp(power, location, aim, size, color=(1, 1, 1)):
    data = bpy.data.lights.new("lamp", "AREA")
    data.energy, data.size, data.color = power, size, color
    item = bpy.data.objects.new("lamp", data)
    item.location = location
    item.rotation_euler = (Vector(aim) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)


def camera(location, aim, lens, blur=0.0, focus=None):
    """`blur`: the f-number, 0 is none; `focus`: the point that is sharp, else what it aims at."""
    data = bpy.data.cameras.new("camera")
    item = bpy.data.objects.new("camera", data)
    item.location, data.lens = location, lens
    item.rotation_euler = (Vector(aim) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    data.clip_start = 0.01
    if blur:
        data.dof.use_dof, data.dof.aperture_fstop = True, blur
        data.dof.focus_distance = (Vector(focus or aim) - Vector(location)).length
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item


def render(path, engine, width, height, samples):
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.libshade.samples = scene.cycles.samples = samples
    scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = False, False
    scene.view_settings.view_transform = "Filmic" if bpy.app.version < (4, 0) else "AgX"
    scene.view_settings.look = next((look for look in ("Medium High Contrast", "AgX - Medium High Contrast")
                                     if _has_look(scene, look)), "None")
    scene.render.filepath = os.path.abspath(path)
    scene.render.image_settings.file_format = "JPEG" if str(path).endswith(".jpg") else "PNG"
    scene.render.image_settings.quality = 80  # of JPEG
    bpy.ops.render.render(write_still=True)


def _has_look(scene, look):
    try:
        scene.view_settings.look = look
    except TypeError:
        return False
    return True


def main(build, width, height, samples):
    """`-- PICTURE.png [cycles] [SAMPLES]`: by our engine, or by Cycles."""
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    rest = words[1:]
    engine = "CYCLES" if "cycles" in rest else "LIBSHADE"
    counts = [word for word in rest if word != "cycles"]
    if not words or len(counts) > 1 or not all(word.isdigit() and int(word) > 0 for word in counts):
        sys.exit("usage: blender -b … -P make_scene.py -- PICTURE.png [cycles] [SAMPLES]")
    build()
    render(words[0], engine, width, height, int(counts[0]) if counts else samples)
