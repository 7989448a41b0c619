# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell of particles and hair. Where there are none they say what they say in Cycles."""

from . import strands
from .node_place import layer

_RANDOM = float(strands.by_chance(0))  # of no particle [Cycles 3.4, 5.0]


def _particle_info(reader, found):
    """What an instance says that a particle shows."""
    wide = 3 if found.output.type == "VECTOR" else 1
    if not reader.has_surface:
        return (_RANDOM,) if found.output.name == "Random" else (0.0,) * wide
    return reader.attribute("PARTICLE", found.output.name)[:wide]


_OF_STRANDS = ("Is Strand", "Intercept", "Length", "Random")  # as strands.py lays them down


def _hair_info(reader, found):
    name = found.output.name
    if name in _OF_STRANDS:
        return (layer(reader, "STRAND")[(3, 0, 1, 2)[_OF_STRANDS.index(name)]],)
    if name == "Thickness":
        return (layer(reader, "STRAND", "thickness")[0],)
    return (0.0,) * (3 if found.output.type == "VECTOR" else 1)


NODES = {"PARTICLE_INFO": _particle_info, "HAIR_INFO": _hair_info}
