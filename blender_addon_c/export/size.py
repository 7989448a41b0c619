# SPDX-License-Identifier: GPL-3.0-or-later
"""How large objects are, for cloth."""

from contextlib import contextmanager

import numpy as np

from .layers import read, uvs_of


def unit_of(scene):
    """Metres in a unit of its lengths; 1 without a scene."""
    unit = scene.unit_settings.scale_length if scene else 1.0
    return unit if np.isfinite(unit) and unit > 0 else 1.0


def unit_size(mesh, name):
    """What a unit of a UV map ("": the active one) spans on a mesh, in its own units: the root of area by area. 1
    without such a map."""
    layer = mesh.uv_layers.get(name) if name else None
    layer = layer or next((l for l in mesh.uv_layers if l.active_render), None)
    count = len(mesh.polygons)
    if not layer or not count:
        return 1.0
    start, total = read(mesh.polygons, "loop_start", 1, np.int32), read(mesh.polygons, "loop_total", 1, np.int32)
    uv = uvs_of(layer).view(np.float32).reshape(-1, 2).astype(float)
    order = np.argsort(start, kind="stable")
    following = np.arange(1, len(uv) + 1)
    following[start + total - 1] = start
    u, v = uv.T
    with np.errstate(invalid="ignore", over="ignore"):
        twice = np.add.reduceat(u * v[following] - u[following] * v, start[order])
        flat = np.abs(twice).sum() / 2
        area = read(mesh.polygons, "area", 1).astype(float).sum()
        size = np.sqrt(area / flat) if flat > 0 else 1.0
    return float(size) if 0 < size < 1e18 else 1.0


@contextmanager
def before_modifiers(ob):
    """An object's own mesh; in edit mode, where no coordinates can be read of it, a copy as it was last left or told."""
    if not ob.data.is_editmode:
        yield ob.data
        return
    try:
        yield ob.to_mesh()
    finally:
        ob.to_mesh_clear()


def metres(matrix, per_unit, unit):
    """(in a unit of the UV map, in one of the object's space): by its scale, in the mean of all directions."""
    scale = abs(np.linalg.det(np.array(matrix, float).reshape(-1, 4)[:3, :3])) ** (1 / 3) * unit
    scale = scale if 0 < scale < 1e18 else 1.0
    return per_unit * scale, scale
