# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell of what the engine has not: they say what they say in Cycles where it is not there."""

_RANDOM = 0.8603128  # of no particle [Cycles 3.4, 5.0]


def _particle_info(_reader, found):
    if found.output.name == "Random":
        return (_RANDOM,)
    return (0.0,) * (3 if found.output.type == "VECTOR" else 1)


def _hair_info(_reader, found):
    return (0.0,) * (3 if found.output.type == "VECTOR" else 1)


NODES = {"PARTICLE_INFO": _particle_info, "HAIR_INFO": _hair_info}
