# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell of what the engine has not: they say what they say in Cycles where it is not there. Of hair they do
tell."""

from .node_place import layer

_RANDOM = 0.8603128  # of no particle [Cycles 3.4, 5.0]


def _particle_info(_reader, found):
    if found.output.name == "Random":
        return (_RANDOM,)
    return (0.0,) * (3 if found.output.type == "VECTOR" else 1)


_OF_STRANDS = ("Is Strand", "Intercept", "Length", "Random")  # as strands.py lays them down


def _hair_info(reader, found):
    name = found.output.name
    if name in _OF_STRANDS:
        return (layer(reader, "STRAND")[(3, 0, 1, 2)[_OF_STRANDS.index(name)]],)
    if name == "Thickness":
        return (layer(reader, "STRAND", "thickness")[0],)
    return (0.0,) * (3 if found.output.type == "VECTOR" else 1)


NODES = {"PARTICLE_INFO": _particle_info, "HAIR_INFO": _hair_info}
