# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as a whole: its objects, and the settings of the picture."""

import math
from collections import namedtuple

import bpy
import numpy as np

from .. import versions
from . import passes, strands, tree
from .aov import OCCLUSION, wanted_of
from .camera import rows
from .kept import owners_of
from .light import Links, kinds, light_of, name_shading
from .material import POINTS, STRANDS, Table
from .matte import Mattes
from .mesh import mesh_of
from .motion import Still
from .size import metres
from .twins import name_standing, name_twins
from .visibility import ALL, BOUNCED, CAMERA, is_hidden, of_both
from .world import world_of

_BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces",
           "transparent_max_bounces")  # as in the settings and in the native module
_SHORTCUTS = ("sample_clamp_direct", "sample_clamp_indirect", "light_sampling_threshold", "blur_glossy", "texture_blur",
              "caustics_reflective", "caustics_refractive")
_APART = 4096  # triangles of a mesh that moves by itself in a viewport
_MOST_THREADS = 256  # that the native module starts


def read(depsgraph, camera, size, region, samples, messages, mattes=None, motion=Still(), kept=None, space=None):
    """The whole scene, as native/render/read.c takes it, without a dump. kept: what was read before (kept.Kept);
    Later may be raised then. space: the 3D view that shows it."""
    mattes = mattes or Mattes(())
    scene, render = depsgraph.scene_eval, depsgraph.scene_eval.render
    colors = depsgraph.mode == "RENDER" and passes.have_colors(scene, depsgraph.view_layer)
    aovs = wanted_of(depsgraph.view_layer) if depsgraph.mode == "RENDER" else ()
    table = Table(messages, scene.libshade, colors, camera, depsgraph, kept, aovs)
    if kept:
        kept.begin()
    with tree.deep():
        meshes, instances, lights, catchers = _objects(depsgraph, table, mattes, motion, messages, kept, space)
        own_world = passes.world_of_layer(scene, depsgraph.view_layer_eval) if depsgraph.view_layer.use_sky else None
        world = world_of(own_world, table, messages)
    if kept:
        kept.end()
    if not lights and "sky" not in world and not any(world["background"]):
        messages.warning(f"no {kinds('or')} light in the scene: surfaces will be black")
    if depsgraph.mode == "RENDER":
        name_twins(meshes, instances, messages, scene.libshade.soft_terminator)
        name_standing(meshes, instances, table.materials, messages)
    if catchers["seen"] and versions.CATCHERS_TWICE:
        if any(kind == OCCLUSION for _name, kind in aovs):
            messages.warning("pass Ambient Occlusion: shadow catchers count once, not twice as in this Cycles")
        if getattr(depsgraph.view_layer, "lightgroups", ()):
            messages.warning("light groups are without shadow catchers, which are in those of this Cycles")
    _name_settings(scene, messages)
    return {
        "width": size[0],
        "height": size[1],
        "region": region,
        "samples": samples,
        "seed": _seed(scene),
        "threads": min(render.threads, _MOST_THREADS) if render.threads_mode == "FIXED" else 0,
        "transparent": render.film_transparent,
        **_clear_glass(scene),
        **world,
        **{name: getattr(scene.libshade, name) for name in _BOUNCES},
        "matt_leans": versions.MATT_LEANS,
        "transparent_less": versions.TRANSPARENT_LESS,
        **{name: getattr(scene.libshade, name) for name in _SHORTCUTS},
        "normal_blur": samples**-0.5 if scene.libshade.filter_normals else 0.0,
        **_adaptive(scene.libshade, samples),
        **_pixel_filter(scene.libshade),
        "time_limit": scene.libshade.time_limit,
        "soft_terminator": scene.libshade.soft_terminator,
        "camera": {**camera, **motion.camera()},
        **motion.scene(),
        "lights": lights,
        "images": table.images.listed,
        "cloths": table.cloths,
        "scratches": table.scratches,
        "layers": table.layers.listed,
        "attributes": len(table.attributes.listed),
        "materials": [{**m, **mattes.of_material(m["name"])} for m in table.materials] + table.shaders,
        "aovs": table.aovs,
        "aov_reach": table.reach,
        "group": getattr(own_world, "lightgroup", ""),
        **mattes.wanted(),
        "by_camera": table.by_camera,
        "meshes": meshes,
        "instances": instances,
        "catchers": catchers,
        "apart": _APART if kept else 0,
        "dump": "",
        "renderer": f"Blender {bpy.app.version_string}",
    }


def _clear_glass(scene):
    """How rough the glass may be, as alpha, through which a transparent film is seen."""
    cycles = getattr(scene, "cycles", None)
    on = scene.render.film_transparent and getattr(cycles, "film_transparent_glass", False)
    return {"clear_glass": min(max(cycles.film_transparent_roughness, 0.0), 1.0) ** 2} if on else {}


def _seed(scene):
    settings = scene.libshade
    return settings.seed + (scene.frame_current if settings.use_animated_seed else 0)


def _adaptive(settings, samples):
    """What 0 stands for is as in Cycles."""
    if not settings.use_adaptive_sampling:
        return {}
    threshold = settings.adaptive_threshold or max(0.001, 1.0 / samples)
    # what is no threshold the renderer names
    asked = math.ceil(min(16.0 / threshold**0.3, 65536)) if threshold > 0 else 4
    least = settings.adaptive_min_samples or asked
    return {"adaptive_threshold": threshold, "adaptive_min_samples": max(4, least)}


def _name_settings(scene, messages):
    """What a file asks of Cycles that makes another picture."""
    cycles, render = getattr(scene, "cycles", None), scene.render
    named = {
        "Fast GI Approximation": getattr(cycles, "use_fast_gi", False),
        "Camera Culling (Simplify)": render.use_simplify and getattr(cycles, "use_camera_cull", False),
        "Distance Culling (Simplify)": render.use_simplify and getattr(cycles, "use_distance_cull", False),
        "Texture Limit (Simplify)": render.use_simplify and getattr(cycles, "texture_limit_render", "OFF") != "OFF",
    }
    for name in (name for name, on in named.items() if on):
        messages.warning(f"Cycles' {name} is not supported; left out")


def _pixel_filter(settings):
    if settings.pixel_filter_type == "BOX":
        return {"filter_width": 0.0}
    times = {"GAUSSIAN": 3, "BLACKMAN_HARRIS": 2}[settings.pixel_filter_type]  # where Cycles' end, in its widths
    return {"pixel_filter_type": settings.pixel_filter_type, "filter_width": times * settings.filter_width}


def _objects(depsgraph, table, mattes, motion, messages, kept, space):
    """All meshes, their instances and the lights."""
    meshes, instances, lights, catchers = [], [], [], {"seen": [], "held": []}
    # (what it is of, how its materials are, materials of its slots): its index, or None for one without faces
    known = {}
    marks = _marks(depsgraph.view_layer.layer_collection)
    links = Links(messages)
    # first, so that objects know which are for some alone; instances of lamps are linked as the lamps are
    for ob in depsgraph.objects if "light_linking" in bpy.types.Object.bl_rna.properties else ():
        links.of_light(ob)
    for item in depsgraph.object_instances:
        ob, maker = item.object, item.parent if item.is_instance else None
        if space and not ob.visible_in_viewport_get(space):
            continue  # of a local view, or of types that it hides: lamps too, as in Cycles
        if ob.type == "LIGHT":
            made = light_of(ob, maker, item.matrix_world, links, table, messages) if item.show_self else []
            lights += [{**one, "group": getattr(ob, "lightgroup", "")} for one in made]
            continue
        for shape in _shapes(item, depsgraph, motion, messages):
            catches = _says(ob, maker, "is_shadow_catcher")
            held = _says(ob, maker, "is_holdout") or ("holdout" in marks and _marked(item, "holdout", depsgraph))
            bits = of_both(ob, maker, ALL)
            if "indirect_only" in marks and _marked(item, "indirect_only", depsgraph):
                bits |= CAMERA
            if is_hidden(bits, *ALL):
                continue
            # is it hidden from some rays of surfaces, only those that see it find its light
            drawn = not any(is_hidden(bits, kind) for kind in BOUNCED)
            # a light that moves is found by rays alone, too
            moved = motion.place(item)
            drawn = drawn and not (motion.blurs and (moved is not None or shape.bent))
            matrix = rows(item.matrix_world)
            if not math.isfinite(sum(matrix)):
                messages.warning(f"object '{ob.name}': its place is not a number; left out")
                continue
            for holds in (held, True) if catches and not held else (held,):
                way = drawn, holds
                key = (shape.of, way, *shape.slots)
                if key not in known:
                    mesh = (kept.mesh(shape, way, owners_of(item, depsgraph), table, messages) if kept
                            else shape.make(way, table, messages))
                    known[key] = len(meshes) if mesh else None
                    meshes += [mesh] if mesh else []
                if known[key] is None:
                    break
                name_shading(ob, meshes[known[key]] if drawn else None, table, messages)
                made = {"mesh": known[key], "matrix": matrix, "pass_index": ob.pass_index,
                        "hidden": bits, "motion": moved, "group": getattr(ob, "lightgroup", ""), **mattes.of_object(ob),
                        **links.of_light(ob), **links.of_object(ob, item.parent), **(_own(item, table) if table.by_object else {}),
                        **_metres(meshes[known[key]], matrix, table.unit)}
                made = _at_points(made, shape.points, table) if shape.points else [made]
                instances += made if holds == held else []
                if catches and not held:
                    catchers["held" if holds else "seen"] += made
    for one in (*instances, *catchers["seen"], *catchers["held"]):
        if "attributes" in one:  # as many as materials ask for by now
            one["attributes"] = table.attributes.array(one["attributes"])
    return meshes, instances, lights, catchers


# What is drawn of an object. of: what it is the same for; owner: its name; points: of a cloud, where copies are, or
# None; bent: does it change meanwhile?
_Shape = namedtuple("_Shape", "of owner slots make points bent", defaults=(None, False))


def _shapes(item, depsgraph, motion, messages):
    """The object itself, and the hair on it."""
    ob, override = item.object, depsgraph.view_layer_eval.material_override
    if item.show_self and _is_volume(ob):
        messages.warning(f"object '{ob.name}': volumes are not supported; left out")
        return
    if not isinstance(ob.data, (bpy.types.Mesh, strands.CURVES, strands.POINTS)):
        return  # text and so on come as meshes
    slots = [override] if override else _slots(ob, depsgraph)
    owner = f"object '{ob.name}'"
    shown_at = tuple(round(x, 6) for row in item.matrix_world.to_3x3() for x in row)  # tubes are round there
    if not item.show_self:
        pass
    elif isinstance(ob.data, bpy.types.Mesh):
        bent = motion.bends(ob)
        yield _Shape((ob.data, ob.original if bent else None), owner, slots,
                     lambda way, table, messages: _mesh(ob, depsgraph, slots, way, table, motion, messages), bent=bent)
    elif isinstance(ob.data, strands.CURVES):
        yield _Shape((ob.data, shown_at), owner, slots, lambda way, table, _messages: _tubes(
            strands.of_curves(ob.data), item.matrix_world, owner, (slots or [None])[0], way, table))
    elif isinstance(ob.data, strands.POINTS):
        points = strands.of_points(ob.data)
        if len(points.places):
            yield _Shape((ob.data, len(points.places)), owner, slots, lambda way, table, _messages: strands.ball(
                len(points.places), owner, table.index((slots or [None])[0], *way, POINTS)), points)
    if item.show_particles and ob.type == "MESH":
        matrix = item.matrix_world
        for modifier, system in strands.hairs(ob):
            used = [(slots or [None])[min(max(system.settings.material - 1, 0), max(len(slots) - 1, 0))]]
            yield _Shape((ob.original, system.name, shown_at), owner, used,
                         lambda way, table, _messages, modifier=modifier, system=system, used=used:
                         _tubes(strands.of_hair(ob, modifier, system), matrix, owner, used[0], way, table))


def _is_volume(ob):
    """A box of smoke is one in Cycles, whether or not there is smoke."""
    return ob.type == "VOLUME" or any(
        modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and modifier.domain_settings.domain_type == "GAS"
        for modifier in ob.modifiers)


def _tubes(hair, matrix, owner, material, way, table):
    number = table.index(material, *way, STRANDS)
    return strands.tubes(hair, matrix, owner, number, table.layers_of([number]))


def _at_points(made, points, table):
    """Copies of an instance, within its space; round whatever that is, as in Cycles."""
    places, sizes = points.places, points.radii

    def at(matrix):
        moved = np.repeat(matrix[None], len(places), 0)
        moved[:, :3, :3] = (strands.even_size(matrix) * sizes)[:, None, None] * np.eye(3)
        moved[:, :3, 3] += places @ matrix[:3, :3].T
        return moved

    matrices = at(np.array(made["matrix"]).reshape(4, 4)).reshape(-1, 16).tolist()
    copies = [{**made, "matrix": matrix} for matrix in matrices]
    if made["motion"] is not None:
        moved = np.stack([at(matrix) for matrix in made["motion"]], 1).astype(np.float32)
        copies = [{**copy, "motion": motion} for copy, motion in zip(copies, moved)]
    for number, (kind, name) in enumerate(table.attributes.listed if "attributes" in made else ()):
        told = points.told(name) if kind == "POINT" else None
        for copy, numbers in zip(copies, told if told is not None else ()):
            copy["attributes"] = [*copy["attributes"][:number], numbers, *copy["attributes"][number + 1:]]
    return copies


def _says(ob, maker, name):
    """What instances an object has a say, as in Cycles."""
    return any(getattr(owner, name, False) for owner in (ob, maker) if owner)


def _marks(collection):
    """What some collection of a view layer, or one inside, is."""
    own = {name for name in ("holdout", "indirect_only") if getattr(collection, name)}
    return own.union(*map(_marks, collection.children))


def _marked(item, name, depsgraph):
    """Does a collection of its object, or of what instances it, say so?"""
    owner = (item.parent or item.object).original
    return getattr(owner, f"{name}_get")(view_layer=depsgraph.view_layer)


def _mesh(ob, depsgraph, slots, way, table, motion, messages):
    """That of an object in edit mode has no UV maps until 3.4, but a copy of it has."""
    if not ob.data.is_editmode:
        return mesh_of(ob, ob.data, slots, way, table, motion, messages)
    copy = ob.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph)
    try:
        return mesh_of(ob, copy, slots, way, table, motion, messages)
    finally:
        ob.to_mesh_clear()


def _own(item, table):
    """What nodes may ask of an object."""
    number = item.random_id if item.is_instance else _hash(item.object.name)
    shows = item.parent if item.is_instance and item.parent else item.object  # an instance has its instancer's colour
    told = {"attributes": table.attributes.of_item(item)} if table.attributes.listed else {}
    return {"color": tuple(shows.color), "random": (number & 0xffffffff) / 0xffffffff, **told}


def _metres(mesh, matrix, unit):
    """Where a material of the mesh asks for that."""
    return {"metres": metres(matrix, mesh["per_unit"], unit)} if "per_unit" in mesh else {}


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
