# SPDX-License-Identifier: Apache-2.0
"""Runs inside Blender: meshes, triangulated, and what calc_tangents says of them.

blender -b --factory-startup --python-exit-code 3 -P export_tangents.py -- FOLDER
writes FOLDER/<mesh>.in (input of tangents_driver), <mesh>.out (what Blender says,
in the driver's output format) and <mesh>.area (UV area of each triangle).
"""
import sys
from pathlib import Path

import bpy
import numpy as np


def suzanne():
    bpy.ops.mesh.primitive_monkey_add()
    bpy.ops.object.modifier_add(type="SUBSURF")
    bpy.context.object.modifiers[0].levels = 2
    bpy.ops.object.modifier_apply(modifier=bpy.context.object.modifiers[0].name)
    bpy.ops.object.shade_smooth()


def sphere():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()


def torus():
    bpy.ops.mesh.primitive_torus_add(generate_uvs=True)
    bpy.ops.object.shade_smooth()


def flat_suzanne():
    bpy.ops.mesh.primitive_monkey_add()


def cylinder_with_hard_edges():
    bpy.ops.mesh.primitive_cylinder_add(vertices=40)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.use_auto_smooth = True


def mirrored_suzanne():
    """Right half maps onto the left half's UVs, so handedness changes at the seam."""
    suzanne()
    mesh = bpy.context.object.data
    uv = mesh.uv_layers.active.data
    for loop in mesh.loops:
        co = mesh.vertices[loop.vertex_index].co
        uv[loop.index].uv = (abs(co.x) * 0.5, co.z * 0.5 + 0.1 * co.y)


def custom_normals():
    """A grid, bulging, with normals bent away from the geometry, and sharp across x = 0."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20)
    mesh = bpy.context.object.data
    for v in mesh.vertices:
        v.co.z = 0.3 * np.cos(3 * v.co.x) * np.cos(2 * v.co.y)
    mesh.use_auto_smooth = True
    normals = []
    for polygon in mesh.polygons:
        side = np.sign(polygon.center.x)
        for index in polygon.loop_indices:
            co = mesh.vertices[mesh.loops[index].vertex_index].co
            n = np.array([0.3 * side + 0.2 * co.x, 0.3 * co.y, 1.0])
            normals.append(n / np.linalg.norm(n))
    mesh.normals_split_custom_set(normals)


def degenerate_uvs():
    """Suzanne whose UVs collapse to one point in a patch: triangles without UV area."""
    suzanne()
    mesh = bpy.context.object.data
    for data in mesh.uv_layers.active.data:
        u, v = data.uv
        if 0.3 < u < 0.45 and 0.5 < v < 0.7:
            data.uv = (0.4, 0.6)


def triangulate():
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.quads_convert_to_tris()
    bpy.ops.object.mode_set(mode="OBJECT")


def floats(loops, name, width):
    values = np.empty(len(loops) * width, np.float32)
    loops.foreach_get(name, values)
    return values.reshape(-1, width)


def export(folder, name):
    mesh = bpy.context.object.data
    mesh.calc_tangents()
    assert all(p.loop_total == 3 for p in mesh.polygons)
    vertex = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertex)
    co = floats(mesh.vertices, "co", 3)[vertex]
    uv = floats(mesh.uv_layers.active.data, "uv", 2)
    normal, tangent = floats(mesh.loops, "normal", 3), floats(mesh.loops, "tangent", 3)
    sign = floats(mesh.loops, "bitangent_sign", 1)
    with open(folder / f"{name}.in", "wb") as out:
        for part in (np.uint32([len(mesh.polygons)]), co, normal, uv):
            out.write(part.tobytes())
    np.hstack([tangent, sign]).tofile(folder / f"{name}.out")
    a, b = (uv.reshape(-1, 3, 2)[:, i] - uv.reshape(-1, 3, 2)[:, 0] for i in (1, 2))
    (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).astype(np.float32).tofile(folder / f"{name}.area")


def main():
    folder = Path(sys.argv[sys.argv.index("--") + 1])
    for make in (suzanne, sphere, torus, flat_suzanne, cylinder_with_hard_edges,
                 mirrored_suzanne, custom_normals, degenerate_uvs):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        make()
        triangulate()
        export(folder, make.__name__)


main()
