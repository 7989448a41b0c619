# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts of examples build, without rendering it: example_scenes.py FACTS.json "SCRIPT [WORDS …]"..."""

import ast
import json
import os
import sys
import tempfile
import types

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

def nothing(*_):
    return None


# What takes long is done less finely, or where it is seen closely alone
SMALLER = {"drape": {"QUADS": 8, "FRAMES": 1}, "cloth": {"STEPS": 48}, "jacket": dict.fromkeys(("torso", "collar", "sleeve", "pocket"), nothing)}


def plain(value):
    """As a table has it."""
    if isinstance(value, bpy.types.ID):
        return value.name
    if isinstance(value, (str, bool, int)):
        return value
    return round(value, 6) if isinstance(value, float) else [plain(x) for x in value]


def node_of(tree, node):
    """What was set of a node, beside one that is as it comes; a cloth's are those of its preset."""
    if node.bl_idname == "ShaderNodeGroup":
        return {"of": node.node_tree.name}
    other = bpy.data.node_groups.new("fresh", tree.bl_idname)
    try:
        fresh = other.nodes.new(node.bl_idname)
    except RuntimeError:  # one that stands in worlds or materials alone
        fresh = None
    said = {}
    skip = {"name", "label", "location", "location_absolute", "width", "height", "select", "inputs", "outputs", "is_active_output", "parent",
            "internal_links", "dimensions", "color", "show_texture", "target", "node_tree", "image_user", "texture_mapping", "color_mapping",
            "warning_propagation", "is_new", "ax", "ay", "shown_ax", "shown_ay", "shown_ex", "shown_ey", "set_shape", "set_width", "chosen",
            "size_mode", "baked"}
    if fresh and node.bl_idname == "LibshadeFabricNode":
        fresh.preset = said["preset"] = node.preset
    names = [name for name in node.bl_rna.properties.keys() if name not in skip] if fresh else ["image"] * hasattr(node, "image")
    for name in names:
        try:
            value, usual = plain(getattr(node, name)), plain(getattr(fresh, name)) if fresh else None
        except TypeError:
            continue
        if value != usual:
            said[name] = value
    for k, socket in enumerate(node.inputs):
        if socket.is_linked or not hasattr(socket, "default_value") or not socket.enabled:
            continue
        usual = plain(fresh.inputs[k].default_value) if fresh else None
        if plain(socket.default_value) != usual:
            said[socket.name] = plain(socket.default_value)
    bpy.data.node_groups.remove(other)
    return said


def tree_of(tree):
    """Nodes with what was set, and links, by short names."""
    short = {node: node.bl_idname.replace("ShaderNode", "").replace("Libshade", "").replace("Node", "") for node in tree.nodes}
    nodes = sorted(([short[node], node_of(tree, node)] for node in tree.nodes if not node.bl_idname.startswith("ShaderNodeOutput")), key=str)
    links = sorted(f"{short[link.from_node]}.{link.from_socket.name} {short[link.to_node]}.{link.to_socket.name}" for link in tree.links)
    return [nodes, links]


def looks(item):
    return plain(item.matrix_world.to_quaternion() @ Vector((0, 0, -1)))


def column(items, name, kind, wide):
    flat = np.empty(len(items) * wide, kind)
    items.foreach_get(name, flat)
    return flat.reshape(-1, wide)


def body_of(item):
    """Bounds and area in the scene, units of the UV map per metre, whether it is smooth, what is set of modifiers."""
    mesh, place = item.data, np.array(item.matrix_world)
    points = column(mesh.vertices, "co", np.float32, 3) @ place[:3, :3].T + place[:3, 3]
    area, wide = (column(mesh.polygons, name, np.float32, k) for name, k in (("area", 1), ("normal", 3)))
    middles = column(mesh.polygons, "center", np.float32, 3) @ place[:3, :3].T + place[:3, 3] - points.mean(0)
    smooth = column(mesh.polygons, "use_smooth", bool, 1)
    scale = item.matrix_world.median_scale
    uv = None
    if mesh.uv_layers:
        x, y = column(mesh.uv_layers[0].data, "uv", np.float32, 2).astype(float).T
        count = column(mesh.polygons, "loop_total", np.int32, 1)[:, 0]
        after = np.arange(len(x)) + 1
        ends = np.cumsum(count)
        after[ends - 1] = ends - count
        twice = np.add.reduceat(x * y[after] - y * x[after], ends - count)
        uv = (np.abs(twice).sum() / 2 / (area.sum() * scale**2))**0.5
    said = [[m.type, *[plain(getattr(m, name)) for name in ("render_levels", "width", "segments", "thickness", "offset") if hasattr(m, name)]]
            for m in item.modifiers]
    outside = (area * ((wide @ place[:3, :3].T) * middles).sum(1, keepdims=True)).sum()
    return {"material": [m.name for m in mesh.materials], "low": points.min(0), "high": points.max(0), "area": area.sum() * scale**2, "uv": uv,
            "smooth": smooth.mean(), "modifiers": said, "outside": int(np.sign(outside) * (abs(outside) > 1e-4 * area.sum()**1.5))}


def bodies():
    """Those of one name as one."""
    found = {}
    for item in bpy.context.scene.objects:
        if item.type == "MESH":
            found.setdefault(item.name.split(".")[0], []).append(body_of(item))
    made = {}
    for name, all_of in found.items():
        uvs = [one["uv"] for one in all_of if one["uv"] is not None]
        low, high = np.min([one["low"] for one in all_of], 0), np.max([one["high"] for one in all_of], 0)
        small = 1e-3 * (high - low).max()
        made[name] = [len(all_of), sorted({m.split(".")[0] for one in all_of for m in one["material"]}),
                      [0 if abs(x) < small else float(f"{x:.3g}") for x in low],
                      [0 if abs(x) < small else float(f"{x:.3g}") for x in high],
                      float(f"{sum(one['area'] for one in all_of):.3g}"), float(f"{sum(uvs) / len(uvs):.3g}") if uvs else None,
                      bool(min(one["smooth"] for one in all_of) > 0.5), all_of[0]["modifiers"], min(one["outside"] for one in all_of)]
    return made


def facts():
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    render, view, camera = scene.render, scene.view_settings, scene.camera
    data = camera.data
    bounces = scene.libshade.max_bounces, scene.cycles.max_bounces
    return {
        "picture": [render.engine, render.resolution_x, render.resolution_y, render.resolution_percentage, scene.libshade.samples, scene.cycles.samples,
                    scene.libshade.use_denoising, view.view_transform, view.look, os.path.basename(render.filepath), render.image_settings.file_format,
                    *(bounces if bounces != (12, 12) else ())],
        "camera": [plain(camera.matrix_world.translation), looks(camera), data.type, plain(data.ortho_scale if data.type == "ORTHO" else data.lens),
                   plain(data.clip_start), *([data.dof.aperture_fstop, plain(data.dof.focus_distance)] if data.dof.use_dof else [])],
        "lamps": sorted([o.data.type, plain(o.data.energy), plain(o.matrix_world.translation), looks(o), plain(o.data.color),
                         plain(o.data.size if o.data.type == "AREA" else o.data.angle if o.data.type == "SUN" else o.data.shadow_soft_size)]
                        for o in scene.objects if o.type == "LIGHT"),
        "world": tree_of(scene.world.node_tree) if scene.world.use_nodes else plain(scene.world.color),
        "materials": {m.name: tree_of(m.node_tree) for m in bpy.data.materials if m.users},
        "bodies": bodies()}


def falls(seen):
    """Of cloth that falls while frames pass, what was set."""
    def told(scene, *_more):
        for item in scene.objects:
            for fall in (one for one in item.modifiers if one.type == "CLOTH"):
                words = ("quality", "mass", "tension_stiffness", "compression_stiffness", "shear_stiffness", "bending_stiffness", "air_damping")
                seen[item.name] = [scene.frame_current, *(plain(getattr(fall.settings, word)) for word in words), plain(fall.collision_settings.distance_min),
                                   *([other.name, plain(other.collision.thickness_outer)] for other in scene.objects if other.collision and other.collision.use)]
    return told


def begin():
    """An empty scene as parts.begin() brings it, but groups inside our nodes stay, which take long to make."""
    data, before = bpy.data, list(bpy.data.scenes)
    scene = bpy.context.window.scene = data.scenes.new("Scene")
    data.batch_remove([*before, *data.objects, *data.meshes, *data.materials, *data.lights, *data.cameras, *data.worlds, *data.images])
    return scene


def rendered(seen):
    """The picture is black."""
    seen.append(facts())
    render = bpy.context.scene.render
    image = bpy.data.images.new("black", render.resolution_x, render.resolution_y)
    image.filepath_raw, image.file_format = render.filepath, render.image_settings.file_format
    os.makedirs(os.path.dirname(render.filepath), exist_ok=True)
    image.save()
    bpy.data.images.remove(image)


def drawn(world):
    """Graphs of make_pictures.py, which are shown in an editor: their trees, and where nodes stand."""
    pictures = world["Pictures"]()
    for make in pictures.left:
        pictures.show(make)
        _window, area, _region = pictures.window()
        tree = bpy.context.object.active_material.node_tree
        selected = [node.name for node in tree.nodes if node.select]
        shown = area.spaces.active
        yield [make.__name__, tree_of(tree), {node.bl_idname.replace("ShaderNode", ""): plain(node.location) for node in tree.nodes},
               [area.ui_type, shown.show_region_ui, shown.show_region_toolbar, shown.overlay.show_context_path, selected]]


found, (target, *scripts) = {}, common.arguments()
sys.dont_write_bytecode = True  # beside an example
for words in scripts:
    script, *rest = words.split(" ")
    name = os.path.basename(os.path.dirname(script)) if script.endswith("make_scene.py") else os.path.basename(script)[:-3]
    name = "-".join([name, *rest])
    seen = found[name] = []
    bpy.ops.render = types.SimpleNamespace(render=lambda write_still, seen=seen: rendered(seen))
    if name in ("make_first", "make_pictures"):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        common.enable()
    with tempfile.TemporaryDirectory() as folder:
        sys.argv = [script, "--", os.path.join(folder, "a.blend" if name == "suzanne" else "a.png"), *rest]
        with open(script, encoding="utf-8") as file:
            *head, last = ast.parse(file.read()).body
        world = {"__file__": script, "__name__": "__main__"}
        exec(compile(ast.Module(head, []), script, "exec"), world)
        finer = {word: plain(world[word]) for word, value in SMALLER.get(name, {}).items() if value != nothing}
        world.update(SMALLER.get(name, {}))
        fallen = {}
        bpy.app.handlers.frame_change_post.append(falls(fallen))
        if "parts" in world and words != scripts[0]:
            world["parts"].begin = begin
        if name == "make_pictures":
            seen += drawn(world)
            continue
        if name == "make_engines" and "BOTH" not in os.environ:  # a bake takes minutes
            world["parts"].of_addon("scratches").bake = lambda node, name, scene: seen.append([node.bl_idname, name, scene == bpy.context.scene])
        if "Jacket" in world:
            sewn = world["Jacket"].thread
            world["Jacket"].thread = lambda jacket, sewn=sewn: (jacket.seams.__delitem__(slice(2, None)), sewn(jacket)) if jacket.seams else None
        exec(compile(ast.Module([last], []), script, "exec"), world)
        bpy.app.handlers.frame_change_post.pop()
        if name == "suzanne":
            seen.append(facts())
        if finer:
            seen[0].update(finer=finer, falls=fallen)
with open(target, "w", encoding="utf-8") as file:
    json.dump(found, file)
common.finish()
