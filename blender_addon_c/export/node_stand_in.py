# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell of what the engine has not: they say what they say in Cycles where it is not there."""

from . import tree
from .value import Value, color_of, normal_of, number_in, surface_normal

_RANDOM = 0.8603128  # of no particle [Cycles 3.4, 5.0]


def _particle_info(_reader, found):
    if found.output.name == "Random":
        return (_RANDOM,)
    return (0.0,) * (3 if found.output.type == "VECTOR" else 1)


def _hair_info(_reader, found):
    return (0.0,) * (3 if found.output.type == "VECTOR" else 1)


def _ambient_occlusion(reader, found):
    node = found.node
    reader.warn(f"'{node.name}': ambient occlusion is not supported; nothing is occluded")
    return (1.0,) if found.output.name == "AO" else color_of(reader, node.inputs["Color"], found.groups)


def _bevel(reader, found):
    node = found.node
    radius = number_in(reader, found, "Radius")
    if radius != 0.0:
        reader.warn(f"'{node.name}': bevels are not supported; the normal is as it was")
    own = normal_of(reader, node.inputs["Normal"], found.groups) if tree.trace(
        node.inputs["Normal"], found.groups).node else None
    return Value("NORMAL", own) if own else tuple(surface_normal(reader))


NODES = {"PARTICLE_INFO": _particle_info, "HAIR_INFO": _hair_info, "AMBIENT_OCCLUSION": _ambient_occlusion,
         "BEVEL": _bevel}
