# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of evaluated meshes."""

import numpy as np


def _get(collection, attribute, width, dtype):
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values


def mesh_of(ob, slots, drawn, table, messages):
    """Triangles of an evaluated mesh, or None when it has no faces. drawn: may they be a light?"""
    mesh = ob.data
    if hasattr(mesh, "calc_normals_split"):  # until 4.1 corner normals are made on request
        mesh.calc_normals_split()
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    if not triangles:
        return None
    corners = _get(triangles, "loops", 3, np.int32)
    triangle_materials, used = _triangle_materials(mesh, slots or [None], drawn, table)
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


def _triangle_materials(mesh, slots, drawn, table):
    """Material of each triangle, and all those that are in use: indices into the table."""
    if len(slots) == 1:
        slot = np.zeros(len(mesh.loop_triangles), np.int32)
    else:
        slot = _get(mesh.loop_triangles, "material_index", 1, np.int32).clip(0, len(slots) - 1)
    indices = np.zeros(len(slots), np.int32)
    used = np.flatnonzero(np.bincount(slot))
    indices[used] = [table.index(slots[i], drawn) for i in used]
    return indices[slot], indices[used].tolist()
