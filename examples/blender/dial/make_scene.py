# SPDX-License-Identifier: Apache-2.0
"""A watch: a dial of rays, a ring of circles, polished hands; strokes run another way on each part.

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

STEEL, BLUE, GOLD = (0.62, 0.60, 0.58), (0.035, 0.10, 0.34), (0.95, 0.74, 0.46)


def block(name, corners, height, made, turn=0.0, bevel=0.012):
    """A bar over the outline `corners`, (x, y), with its edges broken."""
    mesh = bpy.data.meshes.new(name)
    count = len(corners)
    points = [(x, y, z) for z in (0.0, height) for x, y in corners]
    sides = [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
    mesh.from_pydata(points, [], [tuple(range(count))[::-1], tuple(range(count, 2 * count)), *sides])
    uv = mesh.uv_layers.new().data
    for loop in mesh.loops:  # u along the bar
        x, y, z = points[loop.vertex_index]
        uv[loop.index].uv = (y, x + z)
    item = parts.place(name, mesh, made, rotation=(0, 0, turn), smooth=False)
    edge = item.modifiers.new("edge", "BEVEL")
    edge.width, edge.segments, edge.limit_method = bevel, 3, "ANGLE"
    return item


def hand(name, length, width, tail, height, made, turn):
    outline = [(-width * 0.5, -tail), (width * 0.5, -tail), (width, length * 0.72), (0, length), (-width, length * 0.72)]
    item = block(name, outline, 0.035, made, turn, 0.01)
    item.location.z = height


def ring(name, profile, made, height=0.0):
    return parts.place(name, parts.turned(profile, 256), made, (0, 0, height))


def build():
    parts.begin()
    table = parts.plain("slate", (0.02, 0.021, 0.023), 0.42)
    bpy.ops.mesh.primitive_plane_add(size=80, location=(0, 0, -0.75))
    bpy.context.object.data.materials.append(table)

    rays = parts.metal("dial of rays", BLUE, 0.34, 0.92, "RADIAL_Z", 0.25)
    circles = parts.metal("turned steel", STEEL, 0.28, 0.9, "RADIAL_Z")
    brushed = parts.metal("brushed steel", STEEL, 0.3, 0.88)
    small = parts.metal("turned blue", (0.05, 0.13, 0.38), 0.3, 0.9, "RADIAL_Z")
    bright, gold = parts.metal("polished steel", STEEL, 0.1), parts.metal("polished gold", GOLD, 0.14)

    ring("dial", [(0.001, 0), (2.0, 0)][::-1], rays)
    ring("flange", [(1.98, 0.0), (2.12, 0.22)], small)
    ring("bezel", parts.rounded([(2.1, 0.2), (2.14, 0.34), (2.52, 0.26), (2.62, 0.02)], 0.06, 8)[::-1], circles)
    ring("case", parts.rounded([(2.62, 0.04), (2.70, -0.12), (2.62, -0.70), (1.5, -0.75)], 0.14, 10)[::-1], brushed)

    for hour in range(12):
        turn = -2 * math.pi * hour / 12
        wide = 0.075 if hour % 3 else 0.11
        if hour == 6:  # there the seconds are
            continue
        item = block("hour", [(-wide, 1.42), (wide, 1.42), (wide, 1.86), (-wide, 1.86)], 0.06, gold, turn, 0.02)
        item.location.z = 0.0
    for minute in range(60):
        if minute % 5:
            block("minute", [(-0.012, 1.88), (0.012, 1.88), (0.012, 1.95), (-0.012, 1.95)], 0.012, bright,
                  -2 * math.pi * minute / 60, 0.003)

    seconds = ring("seconds", parts.rounded([(0.001, 0.012), (0.50, 0.012), (0.53, 0.03), (0.56, 0.03), (0.58, 0.0)], 0.01, 4)[::-1], small)
    seconds.location.y = -1.05
    for mark in range(12):
        item = block("tick", [(-0.012, 0.38), (0.012, 0.38), (0.012, 0.47), (-0.012, 0.47)], 0.02, bright, -2 * math.pi * mark / 12, 0.003)
        item.location.y = -1.05
    hand("second", 0.44, 0.022, 0.14, 0.045, gold, 2.3)
    bpy.context.scene.objects["second"].location.y = -1.05
    hand("hours", 1.12, 0.085, 0.26, 0.12, bright, math.radians(360 - 304))
    hand("minutes", 1.66, 0.06, 0.3, 0.17, bright, math.radians(360 - 50))
    ring("pin", parts.rounded([(0.001, 0.25), (0.1, 0.25), (0.12, 0.0)], 0.04, 6)[::-1], gold)

    crown = np.array([(0.0012, 0.32), *parts.rounded([(0.18, 0.32), (0.24, 0.28), (0.24, 0.0), (0.1, -0.02)], 0.03, 4)])
    item = parts.place("crown", parts.turned(crown[::-1], 96), brushed, (2.66, 0, -0.25), (0, math.pi / 2, 0))
    for vertex in item.data.vertices:  # its grip
        scale = 1 + 0.05 * math.cos(24 * math.atan2(vertex.co.y, vertex.co.x))
        vertex.co.x, vertex.co.y = vertex.co.x * scale, vertex.co.y * scale

    parts.sky("interior", 1.3, 2.6, (0.02, 0.02, 0.022))
    parts.lamp(650, (-4.5, 4.0, 6.0), (0, 0, 0), 3.4, (1, 0.96, 0.9))
    parts.lamp(300, (2.5, 6.0, 6.5), (0, 0, 0), 3.0, (0.85, 0.92, 1))
    parts.camera((1.0, -6.2, 8.2), (0.08, -0.1, -0.1), 60)


if __name__ == "__main__":
    parts.main(build, 960, 640, 256)
