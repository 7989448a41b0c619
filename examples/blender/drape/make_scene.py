# SPDX-License-Identifier: Apache-2.0
"""Nine cloths by name, each fallen over a ball: Blender's cloth simulation, then libshade's cloth.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade --python-exit-code 1 -P make_scene.py -- PICTURE.png [cycles] [SAMPLES]
"""
import math
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

CLOTHS = ("SILK_CHARMEUSE", "SHOT_TAFFETA", "POLYESTER_LINING", "DENIM", "LINEN", "SILK_SHANTUNG",
          "GABARDINE", "HERRINGBONE_TWEED", "WOOL_FLANNEL")
SIDE, QUADS, FRAMES = 0.72, 72, 70  # of a cloth: metres, along a side, until it hangs
TABLE, HIGH = 0.11, 0.42  # of the ball that holds it: radius, height of its middle
STEP = 0.37  # of the rows, upwards


def stand(made):
    """A ball on a stick."""
    angle = np.linspace(-math.pi / 2 + 0.12, math.pi / 2 - 0.002, 48)
    ball = np.stack([TABLE * np.cos(angle), TABLE * np.sin(angle)], -1)
    return parts.place("stand", parts.turned([(0.02, -0.6), *ball], 96), made, (0, 0, HIGH))


def fallen(made):
    """A square of cloth as it lies after the fall."""
    side = np.linspace(-SIDE / 2, SIDE / 2, QUADS + 1)
    x, y = np.meshgrid(side, side)
    turn = 0.35
    points = np.stack([x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn),
                       np.full_like(x, HIGH + TABLE + 0.01)], -1)
    item = parts.place("cloth", parts.grid(points), made)
    fall = item.modifiers.new("fall", "CLOTH")
    fall.settings.quality, fall.settings.mass = 5, 0.25
    fall.settings.tension_stiffness = fall.settings.compression_stiffness = fall.settings.shear_stiffness = 12
    fall.settings.bending_stiffness = 1.5
    fall.settings.air_damping = 2
    fall.collision_settings.distance_min = 0.004
    scene = bpy.context.scene
    for frame in range(1, FRAMES + 1):
        scene.frame_set(frame)
    mesh = bpy.data.meshes.new_from_object(item.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    bpy.data.objects.remove(item)
    return mesh


def build():
    scene = parts.begin()
    wood = parts.plain("wood", (0.24, 0.14, 0.08), 0.4)
    holder = stand(wood)
    holder.modifiers.new("solid", "COLLISION")
    holder.collision.thickness_outer = 0.004
    mesh = fallen(wood)
    rows = 3
    for k, preset in enumerate(CLOTHS):
        at = ((k % rows - 1) * 0.38, -(k // rows - 1) * 0.3, -(k // rows - 1) * STEP)
        own = mesh.copy()
        own.materials.clear()
        item = parts.place(preset.lower(), own, parts.cloth(preset, preset, 1.0), at, (0, 0, 0.9 * k))
        smooth = item.modifiers.new("smooth", "SUBSURF")
        smooth.levels = smooth.render_levels = 2
        if k:
            scene.collection.objects.link(other := holder.copy())
            other.location = (*at[:2], HIGH + at[2])
    holder.location = (-0.38, 0.3, HIGH + STEP)
    bpy.ops.mesh.primitive_plane_add(size=30, location=(0, 1.2, 0), rotation=(1.25, 0, 0))
    bpy.context.object.data.materials.append(parts.plain("floor", (0.07, 0.07, 0.075), 0.7))

    parts.sky("interior", 0.25, 0.4, (0.05, 0.05, 0.05))
    parts.lamp(170, (-2.0, -1.2, 2.0), (0, 0, 0.4), 0.7, (1, 0.96, 0.9))
    parts.lamp(110, (2.2, 0.4, 1.2), (0, 0, 0.4), 0.8, (0.88, 0.94, 1))
    parts.camera((0, -3.6, 0.82), (0, 0, 0.36), 88)


if __name__ == "__main__":
    parts.main(build, 960, 960, 192)
