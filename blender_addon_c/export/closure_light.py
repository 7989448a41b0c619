# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of what shines, and of what is seen through."""

from .closure_add import add, times
from .value import color_of, number_of


def emission(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    strength = number_of(reader, node.inputs["Strength"], groups)
    shine(reader, color, reader.program.math("MULTIPLY", strength, share))


def shine(reader, color, strength):
    add(reader, {"closure": "EMISSION"}, times(reader, color, strength))


def transparent(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    add(reader, {"closure": "TRANSPARENT"}, times(reader, color, share))


def ray_portal(reader, node, groups, share):
    reader.warn(f"'{node.name}': light that goes on elsewhere is not supported; shaded as a Transparent BSDF")
    transparent(reader, node, groups, share)


def holdout(reader, _node, _groups, share):
    add(reader, {"closure": "EMISSION", "holds": True}, share)
