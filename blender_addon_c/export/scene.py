# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as a whole: its objects, and the settings of the picture."""

import math

import bpy

from . import passes, tree
from .camera import rows
from .light import kinds, light_of, name_linking
from .material import Table
from .matte import Mattes
from .mesh import mesh_of
from .visibility import ALL, BOUNCED, CAMERA, hidden, is_hidden
from .world import world_of

_BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces",
           "transparent_max_bounces")  # as in the settings and in the native module
_SHORTCUTS = ("sample_clamp_direct", "sample_clamp_indirect", "light_sampling_threshold", "blur_glossy", "texture_blur",
              "caustics_reflective", "caustics_refractive")
_MOST_THREADS = 256  # that the native module starts


def read(depsgraph, camera, size, region, samples, messages, mattes=None):
    """The whole scene, as native/scene/read.c takes it, without a dump."""
    mattes = mattes or Mattes(())
    scene, render = depsgraph.scene_eval, depsgraph.scene_eval.render
    colors = depsgraph.mode == "RENDER" and passes.have_colors(scene, depsgraph.view_layer)
    table = Table(messages, scene.libshade, colors, camera, depsgraph)
    with tree.deep():
        meshes, instances, lights = _objects(depsgraph, table, mattes, messages)
        world = world_of(scene.world if depsgraph.view_layer.use_sky else None, table.images, messages)
    if not lights and "sky" not in world and not any(world["background"]):
        messages.warning(f"no {kinds('or')} light in the scene: surfaces will be black")
    if render.use_multiview:
        messages.warning("stereoscopy is not supported: every view shows the same picture")
    return {
        "width": size[0],
        "height": size[1],
        "region": region,
        "samples": samples,
        "seed": _seed(scene),
        "threads": min(render.threads, _MOST_THREADS) if render.threads_mode == "FIXED" else 0,
        "transparent": render.film_transparent,
        **world,
        **{name: getattr(scene.libshade, name) for name in _BOUNCES},
        "matt_leans": bpy.app.version >= (4, 0),  # measured: 3.4 and 5.0
        "transparent_less": bpy.app.version >= (5, 0),  # measured: 3.4, 4.2, 4.5 and 5.0
        **{name: getattr(scene.libshade, name) for name in _SHORTCUTS},
        "normal_blur": samples**-0.5 if scene.libshade.filter_normals else 0.0,
        **_adaptive(scene.libshade, samples),
        **_pixel_filter(scene.libshade),
        "time_limit": scene.libshade.time_limit,
        "soft_terminator": scene.libshade.soft_terminator,
        "camera": camera,
        "lights": lights,
        "images": table.images.listed,
        "cloths": table.cloths,
        "layers": table.layers.listed,
        "materials": [{**m, **mattes.of_material(m["name"])} for m in table.materials],
        **mattes.wanted(),
        "by_camera": table.by_camera,
        "meshes": meshes,
        "instances": instances,
        "dump": "",
        "renderer": f"Blender {bpy.app.version_string}",
    }


def _seed(scene):
    settings = scene.libshade
    return settings.seed + (scene.frame_current if settings.use_animated_seed else 0)


def _adaptive(settings, samples):
    """What 0 stands for is as in Cycles."""
    if not settings.use_adaptive_sampling:
        return {}
    threshold = settings.adaptive_threshold or max(0.001, 1.0 / samples)
    least = settings.adaptive_min_samples or math.ceil(16.0 / threshold**0.3)
    return {"adaptive_threshold": threshold, "adaptive_min_samples": max(4, least)}


def _pixel_filter(settings):
    if settings.pixel_filter_type == "BOX":
        return {"filter_width": 0.0}
    times = {"GAUSSIAN": 3, "BLACKMAN_HARRIS": 2}[settings.pixel_filter_type]  # where Cycles' end, in its widths
    return {"pixel_filter_type": settings.pixel_filter_type, "filter_width": times * settings.filter_width}


def _objects(depsgraph, table, mattes, messages):
    """All meshes, their instances and the lights."""
    meshes, instances, lights = [], [], []
    # (mesh, are its faces a light, materials of its slots): its index, or None for one without faces
    known = {}
    override = depsgraph.view_layer_eval.material_override
    marks = _marks(depsgraph.view_layer.layer_collection)
    for item in depsgraph.object_instances:
        ob = item.object
        if not item.show_self:
            continue
        if ob.type == "LIGHT":
            lights += light_of(ob, item.matrix_world, messages)
        elif isinstance(ob.data, bpy.types.Mesh):  # curves, text and so on come as meshes as well
            for name in ("shadow_catcher", "holdout"):
                if getattr(ob, f"is_{name}", False) or name in marks and _marked(item, name, depsgraph):
                    messages.warning(f"object '{ob.name}': {name.replace('_', ' ')}s are not supported; "
                                     "seen as it is")
            name_linking(ob, "object", messages)
            bits = hidden(ob, ALL)
            if "indirect_only" in marks and _marked(item, "indirect_only", depsgraph):
                bits |= CAMERA
            if is_hidden(bits, *ALL):
                continue
            slots = [override] if override else _slots(ob, depsgraph)
            # is it hidden from some rays of surfaces, only those that see it find its light
            drawn = not any(is_hidden(bits, kind) for kind in BOUNCED)
            key = (ob.data, drawn, *slots)
            if key not in known:
                mesh = _mesh(ob, depsgraph, slots, drawn, table, messages)
                known[key] = len(meshes) if mesh else None
                meshes += [mesh] if mesh else []
            matrix = rows(item.matrix_world)
            if not math.isfinite(sum(matrix)):
                messages.warning(f"object '{ob.name}': its place is not a number; left out")
            elif known[key] is not None:
                instances.append({"mesh": known[key], "matrix": matrix, "pass_index": ob.pass_index,
                                  "hidden": bits, **mattes.of_object(ob),
                                  **(_own(item) if table.by_object else {})})
    return meshes, instances, lights


def _marks(collection):
    """What some collection of a view layer, or one inside, is."""
    own = {name for name in ("holdout", "indirect_only") if getattr(collection, name)}
    return own.union(*map(_marks, collection.children))


def _marked(item, name, depsgraph):
    """Does a collection of its object, or of what instances it, say so?"""
    owner = (item.parent or item.object).original
    return getattr(owner, f"{name}_get")(view_layer=depsgraph.view_layer)


def _mesh(ob, depsgraph, slots, drawn, table, messages):
    """That of an object in edit mode has no UV maps until 3.4, but a copy of it has."""
    if not ob.data.is_editmode:
        return mesh_of(ob, ob.data, slots, drawn, table, messages)
    copy = ob.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph)
    try:
        return mesh_of(ob, copy, slots, drawn, table, messages)
    finally:
        ob.to_mesh_clear()


def _own(item):
    """What nodes may ask of an object."""
    number = item.random_id if item.is_instance else _hash(item.object.name)
    return {"color": tuple(item.object.color), "random": (number & 0xffffffff) / 0xffffffff}


def _hash(name):
    """The number that Cycles gives to an object of this name: its bytes, mixed by lookup3 [Jenkins2006]."""
    whole = 0xffffffff
    text = 0
    for byte in name.encode():
        text = text * 37 + (byte - 256 if byte > 127 else byte) & whole
    b = c = 0xdeadbeef + 8 + 13
    a = b + text & whole
    for k, shift in enumerate((14, 11, 25, 16, 4, 14, 24)):
        x, y = ((c, b), (a, c), (b, a))[k % 3]
        x = (x ^ y) - (y << shift | y >> 32 - shift) & whole
        if k % 3 == 0:
            c = x
        elif k % 3 == 1:
            a = x
        else:
            b = x
    return c


def _slots(ob, depsgraph):
    """Materials by index. Geometry made by nodes brings its own, an object's are in its slots."""
    if ob.original.evaluated_get(depsgraph).data == ob.data:
        return [slot.material for slot in ob.material_slots]
    return list(ob.data.materials)
