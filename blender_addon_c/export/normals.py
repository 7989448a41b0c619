# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals at the corners of a mesh's triangles, as Cycles takes them: those of corners where some edge is sharp or a mesh has
its own, else a flat face has those of its triangles, not its own, and a smooth one those of its vertices, be its neighbour flat
[Cycles 3.4, 4.2 and 5.0]."""

import numpy as np

from .layers import read

_AT_ONCE = 1 << 14  # triangles that a processor's cache holds


def of_loops(mesh):
    """By corner of the mesh's faces, as if all faces were smooth. Until 4.0 the mesh has calculated them."""
    if not hasattr(mesh, "corner_normals"):  # from 4.1 on
        return read(mesh.loops, "normal", 3).reshape(-1, 3)
    if by_corners(mesh):
        return read(mesh.corner_normals, "vector", 3).reshape(-1, 3)
    corners = mesh.attributes.get(".corner_vert")  # none in a mesh without faces
    vertices = read(corners.data, "value", 1, np.int32) if corners else np.zeros(0, np.int32)
    return read(mesh.vertex_normals, "vector", 3).reshape(-1, 3)[vertices]


def by_corners(mesh):
    """Does each corner count?"""
    if hasattr(mesh, "use_auto_smooth"):  # until 4.0
        return mesh.use_auto_smooth
    if mesh.normals_domain != "CORNER":
        return False
    sharp = mesh.attributes.get("sharp_edge")
    return mesh.has_custom_normals or bool(sharp and read(sharp.data, "value", 1, bool).any())


def flat(mesh):
    """Triangles that have a normal of their own: numbers of them, or a slice of all."""
    if by_corners(mesh):
        return np.zeros(0, np.int64)
    if hasattr(mesh, "corner_normals"):
        sharp = mesh.attributes.get("sharp_face")
        if not sharp or sharp.domain != "FACE" or sharp.data_type != "BOOLEAN":
            return np.zeros(0, np.int64)
        of_faces = read(sharp.data, "value", 1, bool)
        if of_faces.all():
            return slice(None)
        return np.flatnonzero(of_faces[read(mesh.loop_triangles, "polygon_index", 1, np.int32)])
    return np.flatnonzero(~read(mesh.loop_triangles, "use_smooth", 1, bool))


def flatten(normals, triangles, positions, corner_positions):
    """Gives these triangles their own normals, in place. normals: three a triangle; positions: three numbers a vertex."""
    points, corners, shown = positions.reshape(-1, 3), corner_positions.reshape(-1, 3), normals.reshape(-1, 3, 3)
    count = len(shown) if isinstance(triangles, slice) else len(triangles)
    for first in range(0, count, _AT_ONCE):
        some = slice(first, min(first + _AT_ONCE, count))
        some = some if isinstance(triangles, slice) else triangles[some]
        a, b, c = (points[corners[some, k]].T.astype(float) for k in range(3))
        (x, y, z), (u, v, w) = b - a, c - a
        with np.errstate(all="ignore"):
            own = np.stack([y * w - z * v, z * u - x * w, x * v - y * u])
            length = np.sqrt((own * own).sum(0))
            own /= length
        good = (length > 0) & np.isfinite(own).all(0)
        shown[some] = own.T[:, None] if good.all() else np.where(good[:, None, None], own.T[:, None], shown[some])
