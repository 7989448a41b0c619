# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell of particles and hair, which say what they say in Cycles where there are none, and of which time and item it is."""

from . import strands, tree
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


def _told(reader, found, number):
    """Of nodes that choose, what tree says."""
    if number is None:
        reader.warn(f"'{found.node.name}' ({found.output.name}): what it depends on differs from place to place; 0")
    return (float(number or 0),)


NODES = {"PARTICLE_INFO": _particle_info, "HAIR_INFO": _hair_info,
         "REPEAT_INPUT": lambda reader, found: _told(reader, found, tree.iteration(found)),
         "MENU_SWITCH": lambda reader, found: _told(reader, found, tree.is_item(found))}
