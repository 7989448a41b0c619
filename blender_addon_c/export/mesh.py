# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of evaluated meshes."""

import numpy as np

from . import normals
from .layers import data_of, integers, read, uv_layer, uvs_of
from .material import MAPLESS
from .size import before_modifiers, unit_size


def mesh_of(ob, mesh, slots, way, table, motion, messages):
    """Triangles of an object's evaluated mesh, or None when it has no faces. way: of the table, how its materials are."""
    if hasattr(mesh, "calc_normals_split"):  # until 4.1 corner normals are made on request
        mesh.calc_normals_split()
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    if not triangles:
        return None
    corners = integers(triangles, "loops", 3)
    triangle_materials, used = _triangle_materials(mesh, slots or [None], way, table)
    positions = read(mesh.vertices, "co", 3, np.float32)
    if not np.isfinite(positions).all():
        messages.warning(f"object '{ob.name}': some of its vertices have no valid position")
    corner_positions = _corner_positions(mesh, corners)
    if _crossed(mesh) > _CROSSED:
        messages.warning(f"object '{ob.name}': edges of three faces and more, and normals of its corners: Cycles of this Blender "
                         "shades it by others")
    uvs = _corner_uvs(mesh, corners, triangle_materials, table.uv_maps(used), ob.name, messages)
    if uvs is None and table.textured(used):
        messages.warning(f"object '{ob.name}': textures need a UV map: each shows one point only")
    return {
        "name": f"object '{ob.name}'",  # for messages of the native module
        "positions": positions,
        "corner_position": corner_positions,
        "corner_normals": _corner_normals(mesh, corners, positions, corner_positions),
        "corner_uvs": uvs,
        "material": triangle_materials,
        **motion.shape(ob, mesh, corners, corner_positions),
        **_measured(ob, mesh, table.measured(used)),
        "layers": _layers(mesh, corners, corner_positions, table.layers_of(used), ob.name, messages),
    }


_CROSSED = 0.01  # of edges, from which on it is worth a word: of 2 % the picture is .05 off [measured in 5.0]


def _crossed(mesh):
    """Which part of its edges has more than two faces, where its normals are those of corners (sharp edges, or its own); there
    Cycles is off [not in 3.4; in 5.0; between not measured]."""
    edges = mesh.attributes.get(".corner_edge")
    if not edges or not hasattr(mesh, "corner_normals") or not normals.by_corners(mesh):  # all from some 4.x on
        return 0.0
    faces = np.bincount(read(edges.data, "value", 1, np.int32), minlength=1)
    return float(np.mean(faces > 2))


def _measured(ob, mesh, name):
    """What a unit of its UV map of this name spans, before modifiers; nothing where the name is None."""
    if name is None:
        return {}
    own = ob.original
    if not isinstance(own.data, type(mesh)) or own.data.is_editmode and not own.modifiers:
        return {"per_unit": unit_size(mesh, name)}
    with before_modifiers(own) as before:
        return {"per_unit": unit_size(before if len(before.polygons) and before.uv_layers else mesh, name)}


def _layers(mesh, corners, positions, wanted, owner, messages):
    """Those that its materials ask for: (number, kind, name)."""
    where = {"CORNER": corners, "POINT": positions}
    if any(kind in ("ATTRIBUTE", "FACTOR") for _number, kind, _name in wanted):
        where["FACE"] = np.repeat(read(mesh.loop_triangles, "polygon_index", 1, np.int32), 3)
    given = [(number, data_of(mesh, kind, name, where, owner, messages))
             for number, kind, name in wanted if kind != "TANGENT"]
    return [{"layer": number, "data": np.ascontiguousarray(data)} for number, data in given if data is not None]


def _corner_positions(mesh, corners):
    shared = mesh.attributes.get(".corner_vert")  # from 3.6 on, and many times faster
    if shared:
        return read(shared.data, "value", 1, np.int32)[corners]
    return integers(mesh.loops, "vertex_index", 1)[corners]


def _corner_normals(mesh, corners, positions, corner_positions):
    if hasattr(mesh, "corner_normals"):  # from 4.1 on
        made = normals.of_loops(mesh).take(corners, axis=0).ravel()
    else:
        made = read(mesh.loop_triangles, "split_normals", 9, np.float32)
        mesh.free_normals_split()
    normals.flatten(made, normals.flat(mesh), positions, corner_positions)
    return made


def _corner_uvs(mesh, corners, materials, names, owner, messages):
    """Of each triangle those of the map that its material asks for; None without any."""
    layers = {name: uv_layer(mesh, name, owner, messages) for name in set(names.values())}
    if not any(layers.values()):
        return None
    uvs = {name: uvs_of(layer)[corners] if layer else np.zeros(len(corners), np.int64) for name, layer in layers.items()}
    if len(uvs) == 1:
        return next(iter(uvs.values())).view(np.float32)
    made = np.empty(len(corners), np.int64)
    for material, name in names.items():
        mine = np.repeat(materials == material, 3)
        made[mine] = uvs[name][mine]
    return made.view(np.float32)


def _triangle_materials(mesh, slots, way, table):
    """Material of each triangle, and all those that are in use: indices into the table."""
    if len(slots) == 1:
        slot = np.zeros(len(mesh.loop_triangles), np.int32)
    else:
        slot = read(mesh.loop_triangles, "material_index", 1, np.int32).clip(0, len(slots) - 1)
    indices = np.zeros(len(slots), np.int32)
    used = np.flatnonzero(np.bincount(slot))
    kind = () if mesh.uv_layers else (MAPLESS,)
    indices[used] = [table.index(slots[i], *way, *kind) for i in used]
    return indices[slot], indices[used].tolist()
