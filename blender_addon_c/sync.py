# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene to the dictionary that the native module renders."""

import math

import bpy
import numpy as np

from . import materials


_MOST_THREADS = 256  # that the native module starts


class SceneError(Exception):
    """The scene cannot be rendered; the text says why, for the artist."""


class Messages:
    """What to tell the artist; each text once, however many objects it concerns."""

    def __init__(self):
        self.errors, self.warnings = {}, {}

    def error(self, text):
        self.errors[text] = None

    def warning(self, text):
        self.warnings[text] = None


def region_of(scene, width, height):
    """Pixels to render, (x0, y0, x1, y1), y up from the bottom, rounded as Blender does."""
    render = scene.render
    if not render.use_border:
        return 0, 0, width, height
    return (int(render.border_min_x * width), int(render.border_min_y * height),
            int(render.border_max_x * width), int(render.border_max_y * height))


def read(depsgraph, camera, size, region, samples, messages):
    """The whole scene, as native/scene/read.c takes it, without a dump."""
    scene, render = depsgraph.scene_eval, depsgraph.scene_eval.render
    table = materials.Table(messages)
    meshes, instances, lights = _objects(depsgraph, table, messages)
    if not instances:
        raise SceneError("nothing to render: the scene has no visible mesh with faces")
    if not lights:
        messages.warning("no sun or point light in the scene: surfaces will be black")
    if render.use_multiview:
        messages.warning("stereoscopy is not supported: every view shows the same picture")
    return {
        "width": size[0],
        "height": size[1],
        "region": region,
        "samples": samples,
        "seed": scene.libshade.seed,
        "threads": min(render.threads, _MOST_THREADS) if render.threads_mode == "FIXED" else 0,
        "transparent": render.film_transparent,
        "background": materials.background(scene.world, messages),
        "filter_width": scene.libshade.filter_width,
        "camera": camera,
        "lights": lights,
        "images": table.images,
        "materials": table.materials,
        "meshes": meshes,
        "instances": instances,
        "dump": "",
        "renderer": f"Blender {bpy.app.version_string}",
    }


def camera_of(ob, depsgraph, size, messages):
    """A camera object, as a render of that size sees through it."""
    if ob is None or ob.type != "CAMERA":
        raise SceneError("the scene has no camera")
    ob = ob.evaluated_get(depsgraph)
    data, render = ob.data, depsgraph.scene_eval.render
    if data.type == "PANO":
        raise SceneError(f"camera '{ob.name}' is panoramic: use Perspective or Orthographic")
    if data.dof.use_dof:
        messages.warning(f"camera '{ob.name}': depth of field is not supported")
    # The projection holds lens, sensor fit, shift and aspect.
    projection = ob.calc_matrix_camera(depsgraph, x=size[0], y=size[1],
                                       scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y)
    return camera_by(projection, ob.matrix_world, (data.clip_start, data.clip_end))


def camera_by(projection, to_world, clip):
    """A camera by its projection, turned back into the part of the view plane that it spans."""
    p = projection
    perspective = p[3][2] != 0
    frame = [((p[i][2] + side) if perspective else (side - p[i][3])) / p[i][i]
             for i in (0, 1) for side in (-1.0, 1.0)]
    place, turn, _scale = to_world.decompose()
    matrix = turn.to_matrix().to_4x4()
    matrix.translation = place
    return {"type": "PERSP" if perspective else "ORTHO", "matrix": _rows(matrix),
            "frame": tuple(frame), "clip": clip}


def _rows(matrix):
    return [value for row in matrix for value in row]


def _objects(depsgraph, table, messages):
    """All meshes, their instances and the lights."""
    meshes, instances, lights = [], [], []
    known = {}  # (mesh, materials of its slots) to the mesh's index, or None for one without faces
    override = depsgraph.view_layer_eval.material_override
    for item in depsgraph.object_instances:
        ob = item.object
        if not item.show_self:
            continue
        if ob.type == "LIGHT":
            lights += _light(ob, item.matrix_world, messages)
        elif isinstance(ob.data, bpy.types.Mesh):  # curves, text and so on come as meshes as well
            if not ob.visible_camera:
                messages.warning(f"object '{ob.name}': hidden from the camera, so left out")
                continue
            slots = [override] if override else _slots(ob, depsgraph)
            key = (ob.data, *slots)
            if key not in known:
                mesh = _mesh(ob, slots, table, messages)
                known[key] = len(meshes) if mesh else None
                meshes += [mesh] if mesh else []
            if known[key] is not None:
                instances.append({"mesh": known[key], "matrix": _rows(item.matrix_world)})
    return meshes, instances, lights


def _slots(ob, depsgraph):
    """Materials by index. Geometry made by nodes brings its own, an object's are in its slots."""
    if ob.original.evaluated_get(depsgraph).data == ob.data:
        return [slot.material for slot in ob.material_slots]
    return list(ob.data.materials)


def _light(ob, matrix, messages):
    light = ob.data
    strength = materials.light_strength(light, messages)
    if light.type not in _LIGHTS:
        known = " and ".join(name.lower() for name in _LIGHTS)
        messages.warning(f"light '{ob.name}': {light.type.lower()} lights are not supported, "
                         f"only {known}")
        return []
    return [{"name": ob.name, "type": light.type, "shadow": light.use_shadow,
             **_LIGHTS[light.type](light, matrix, strength)}]


def _sun(light, matrix, strength):
    """A sun's strength is its irradiance, in W/m²."""
    return {"irradiance": strength, "angle": light.angle,
            "direction": tuple(matrix.to_3x3().col[2].normalized())}


def _point(light, matrix, strength):
    """A point light's power, in W, spreads evenly over the sphere."""
    return {"intensity": tuple(s / (4.0 * math.pi) for s in strength),
            "position": tuple(matrix.translation), "radius": light.shadow_soft_size}


_LIGHTS = {"SUN": _sun, "POINT": _point}  # as in the native module's table


def _get(collection, attribute, width, dtype):
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values


def _mesh(ob, slots, table, messages):
    """Triangles of an evaluated mesh, or None when it has no faces."""
    mesh = ob.data
    if hasattr(mesh, "calc_normals_split"):  # until 4.1 corner normals are made on request
        mesh.calc_normals_split()
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    if not triangles:
        return None
    corners = _get(triangles, "loops", 3, np.int32)
    triangle_materials, used = _triangle_materials(mesh, slots or [None], table, ob.name)
    positions = _get(mesh.vertices, "co", 3, np.float32)
    if not np.isfinite(positions).all():
        messages.warning(f"object '{ob.name}': some of its vertices have no valid position")
    uvs = _corner_uvs(mesh, corners, table.uv_map(used, ob.name), ob.name, messages)
    if uvs is None and table.textured(used):
        messages.warning(f"object '{ob.name}': textures need a UV map: each shows one point only")
    return {
        "name": f"object '{ob.name}'",  # for messages of the native module
        "positions": positions,
        "corner_position": _corner_positions(mesh, corners),
        "corner_normals": _corner_normals(mesh, corners),
        "corner_uvs": uvs,
        "material": triangle_materials,
    }


def _corner_positions(mesh, corners):
    shared = mesh.attributes.get(".corner_vert")  # from 3.6 on, and many times faster
    if shared:
        return _get(shared.data, "value", 1, np.int32)[corners]
    return _get(mesh.loop_triangles, "vertices", 3, np.int32)


def _corner_normals(mesh, corners):
    if hasattr(mesh, "corner_normals"):  # from 4.1 on
        normals = _get(mesh.corner_normals, "vector", 3, np.float32)
        return normals.reshape(-1, 3).take(corners, axis=0).ravel()
    return _get(mesh.loop_triangles, "split_normals", 9, np.float32)


def _corner_uvs(mesh, corners, name, owner, messages):
    """UVs of the map of that name, or of the active render map; None without any."""
    layer = mesh.uv_layers.get(name) if name else None
    if name and not layer:
        messages.warning(f"object '{owner}': no UV map '{name}'; using the active one")
    layer = layer or next((l for l in mesh.uv_layers if l.active_render), None)
    if not layer:
        return None
    if hasattr(layer, "uv"):  # from 3.5 on
        uvs = _get(layer.uv, "vector", 2, np.float32)
    else:
        uvs = _get(layer.data, "uv", 2, np.float32)
    # A pair of floats moves as one 64-bit number: 5 times faster than rows of two.
    return uvs.view(np.int64)[corners].view(np.float32)


def _triangle_materials(mesh, slots, table, owner):
    """Material of each triangle, and all those that are in use: indices into the table."""
    if len(slots) == 1:
        slot = np.zeros(len(mesh.loop_triangles), np.int32)
    else:
        slot = _get(mesh.loop_triangles, "material_index", 1, np.int32).clip(0, len(slots) - 1)
    indices = np.zeros(len(slots), np.int32)
    used = np.flatnonzero(np.bincount(slot))
    indices[used] = [table.index(slots[i], owner) for i in used]
    return indices[slot], indices[used].tolist()
