# SPDX-License-Identifier: Apache-2.0
"""A brushed steel pan, a copper one and a lid under one of Blender's studio skies.

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

STEEL, COPPER, BRASS = (0.61, 0.59, 0.57), (0.93, 0.62, 0.50), (0.90, 0.72, 0.40)


def brushing(made, fine, low, high, depth):
    """Rings of a lathe: they differ in roughness and height by their distance from the axis."""
    tree = made.node_tree
    node = next(n for n in tree.nodes if n.bl_idname == "LibshadeMetalNode")
    new, link = tree.nodes.new, tree.links.new
    spot, split, root, place, rings = (new(f"ShaderNode{kind}") for kind in (
        "TexCoord", "SeparateXYZ", "Math", "CombineXYZ", "TexNoise"))
    squares = [new("ShaderNodeMath") for _ in range(3)]
    link(spot.outputs["Object"], split.inputs[0])
    for square, axis in zip(squares, "XY"):
        square.operation = "MULTIPLY"
        link(split.outputs[axis], square.inputs[0])
        link(split.outputs[axis], square.inputs[1])
    squares[2].operation, root.operation = "ADD", "SQRT"
    link(squares[0].outputs[0], squares[2].inputs[0])
    link(squares[1].outputs[0], squares[2].inputs[1])
    link(squares[2].outputs[0], root.inputs[0])
    link(root.outputs[0], place.inputs["X"])
    link(split.outputs["Z"], place.inputs["Y"])
    link(place.outputs[0], rings.inputs["Vector"])
    rings.inputs["Scale"].default_value, rings.inputs["Detail"].default_value = fine, 3
    width = new("ShaderNodeMapRange")
    width.inputs["From Min"].default_value, width.inputs["From Max"].default_value = 0.3, 0.7
    width.inputs["To Min"].default_value, width.inputs["To Max"].default_value = low, high
    link(rings.outputs[0], width.inputs["Value"])
    link(width.outputs[0], node.inputs["Roughness"])
    bump = new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = depth
    link(rings.outputs[0], bump.inputs["Height"])
    link(bump.outputs[0], node.inputs["Normal"])
    return made


def pan(name, radius, depth, made, inside, location, turn):
    """Its body, outside and in, and the rounded rim between; lengths in units of 10 cm."""
    wall = 0.03
    base = radius * 0.8
    outer = parts.rounded([(0.001, 0), (base, 0), (radius, depth)], 0.22, 12)
    inner = parts.rounded([(radius - wall, depth), (base - wall, wall), (0.001, wall)], 0.22, 12)
    parts.place(name, parts.turned(np.concatenate([outer, inner[:1]])), made, location, (0, 0, turn))
    parts.place(name + " inside", parts.turned(inner), inside, location, (0, 0, turn))


def handle(made, start, length, rise, location, turn):
    """A bar that narrows, its corners rounded; strokes run along it (u)."""
    t = np.linspace(0, 1, 48)
    wide = 0.11 * (1 - 0.35 * np.sin(math.pi * np.clip(t * 1.15, 0, 1))) * np.where(t > 0.97, np.sqrt(np.clip((1 - t) / 0.03, 0.02, 1)), 1)
    high = start[2] + rise * (1 - (1 - t)**2) + 0.05 * np.sin(3 * math.pi * t) * t
    angle = 2 * math.pi * np.arange(48) / 48
    around = np.stack([np.sign(np.cos(angle)) * np.abs(np.cos(angle))**0.5, np.sign(np.sin(angle)) * np.abs(np.sin(angle))**0.5], -1)
    points = np.empty((49, 48, 3))
    for k, (c, s) in enumerate([*around, around[0]]):
        points[k] = np.stack([start[0] + length * t, start[1] + wide * c, high + 0.035 * s], -1)
    parts.place("handle", parts.grid(points), made, location, (0, 0, turn))


def rivets(made, radius, depth, location, turn):
    for side in (-0.06, 0.06):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.04)
        item = bpy.context.object
        item.data.materials.append(made)
        item.data.polygons.foreach_set("use_smooth", np.ones(len(item.data.polygons), bool))
        x, y = radius - 0.055, side
        item.location = (location[0] + x * math.cos(turn) - y * math.sin(turn),
                         location[1] + x * math.sin(turn) + y * math.cos(turn), location[2] + depth - 0.1)


def build():
    parts.begin()
    counter = parts.plain("counter", (0.16, 0.11, 0.075), 0.38)
    bpy.ops.mesh.primitive_plane_add(size=60)
    bpy.context.object.data.materials.append(counter)
    steel = brushing(parts.metal("turned steel", STEEL, 0.3, 0.85, "RADIAL_Z"), 42, 0.2, 0.34, 0.002)
    floor = brushing(parts.metal("turned steel inside", STEEL, 0.3, 0.9, "RADIAL_Z"), 60, 0.2, 0.3, 0.002)
    copper = brushing(parts.metal("turned copper", COPPER, 0.28, 0.8, "RADIAL_Z"), 40, 0.18, 0.3, 0.002)
    bar, bright = parts.metal("brushed steel", STEEL, 0.3, 0.85), parts.metal("polished brass", BRASS, 0.12)

    at, turn = (-0.55, 0.1, 0.02), -0.42
    pan("pan", 1.4, 0.5, steel, floor, at, turn)
    handle(bar, (1.36, 0, 0.42), 1.9, 0.35, at, turn)
    rivets(bright, 1.4, 0.5, at, turn)

    at, turn = (1.75, 1.55, 0.02), 0.6
    pan("sauce pan", 0.95, 0.85, copper, floor, at, turn)
    handle(bar, (0.92, 0, 0.74), 1.5, 0.3, at, turn)

    lid = parts.rounded([(0.001, 0.32), (0.35, 0.30), (0.98, 0.12), (1.02, 0.03), (0.99, 0.0)], 0.2, 10)
    at = (1.55, -1.2, 0.02)
    parts.place("lid", parts.turned(lid[::-1]), steel, at)
    knob = parts.rounded([(0.08, 0.30), (0.08, 0.40), (0.2, 0.44), (0.2, 0.54), (0.001, 0.58)], 0.05, 8)
    parts.place("knob", parts.turned(knob), bright, at)

    parts.sky("interior", 0.9, 2.2, (0.03, 0.03, 0.032))
    parts.lamp(700, (-3.5, 3.5, 5.5), (0.3, 0, 0), 3.5, (1, 0.95, 0.88))
    parts.lamp(260, (5, -1.5, 4), (0.5, 0, 0), 2.5, (0.85, 0.92, 1))
    parts.camera((0.6, -6.4, 3.9), (0.45, 0.15, 0.2), 52)


if __name__ == "__main__":
    parts.main(build, 960, 540, 256)
