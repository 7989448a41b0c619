# SPDX-License-Identifier: Apache-2.0
"""Bolts of denim, tweed and linen on a table; with `near` the denim's loose end, where yarns are seen.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade --python-exit-code 1 -P make_scene.py -- PICTURE.png [near] [cycles] [SAMPLES]
"""
import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

WIDE, LAYER, TURNS = 0.42, 0.0017, 20  # of a bolt: metres, how thick a layer lies, how often it is wound
CORE = 0.024


def line(loose, wave):
    """Places (y, z) along the cloth, from the core outwards, then `loose` metres of it on the table."""
    outer = CORE + TURNS * LAYER
    turn = np.linspace(2 * math.pi * TURNS, 0, 96 * TURNS)
    radius = outer - turn / (2 * math.pi) * LAYER
    angle = turn - math.pi / 2  # it leaves the bolt at the bottom, to the front
    wound = np.stack([radius * np.cos(angle), outer + radius * np.sin(angle)], -1)
    t = np.linspace(0, 1, 160)[1:]
    lying = np.stack([-loose * t, wave * t * (1 + np.sin(3.5 * math.pi * t - 1.2)) * np.minimum(1, 4 * (1 - t) + 0.25)], -1)
    return np.concatenate([wound, lying])


def bolt(preset, location, turn, loose, wave):
    """One unit of the UV map is a metre, the warp along the bolt's length."""
    places = line(loose, wave)
    across = np.linspace(-WIDE / 2, WIDE / 2, 65)
    along = np.arange(len(places))[:, None]
    ripple = 0.0018 * np.sin(across[None] * 23 + along * 0.05) * (along > len(places) - 150)
    points = np.empty((len(across), len(places), 3))
    points[..., 0] = across[:, None]
    points[..., 1] = places[None, :, 0]
    points[..., 2] = places[None, :, 1] + np.abs(ripple.T) + 0.001
    parts.place(preset.lower(), parts.grid(points), parts.cloth(preset, preset, 1.0), location, (0, 0, turn))
    tube = parts.turned([(CORE - 0.002, -WIDE / 2 - 0.006), (CORE - 0.002, WIDE / 2 + 0.006)], 96)
    tube.transform(Matrix.Rotation(math.pi / 2, 4, "Y"))
    x, y, z = location
    parts.place("core", tube, parts.plain("card", (0.42, 0.30, 0.19), 0.7), (x, y, z + CORE + TURNS * LAYER), (0, 0, turn))


def build(near):
    parts.begin()
    bpy.ops.mesh.primitive_plane_add(size=12)
    bpy.context.object.data.materials.append(parts.plain("table", (0.19, 0.125, 0.08), 0.45))
    bolt("HERRINGBONE_TWEED", (-0.31, 0.24, 0), 0.55, 0.22, 0.006)
    bolt("LINEN", (0.33, 0.25, 0), -0.42, 0.24, 0.008)
    bolt("DENIM", (0.0, -0.02, 0), 0.06, 0.34, 0.012)
    parts.sky("interior", 0.55, 2.1, (0.03, 0.03, 0.03))
    parts.lamp(26, (-1.3, 0.9, 1.2), (0, 0, 0), 0.7, (1, 0.96, 0.9))
    parts.lamp(5, (1.0, -0.9, 0.8), (0, 0, 0), 0.5, (0.88, 0.94, 1))
    if near:
        parts.camera((0.05, -0.415, 0.055), (0.012, -0.33, 0.006), 60, 9, (0.015, -0.34, 0.008))
    else:
        parts.camera((0.1, -1.2, 0.58), (0.0, -0.0, 0.035), 46)


if __name__ == "__main__":
    close = "near" in sys.argv
    if close:
        sys.argv.remove("near")
    parts.main(lambda: build(close), 960, 540, 192)
