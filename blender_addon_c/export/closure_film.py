# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films, and the metals below them."""

from .. import working_space
from ..metal_tree import AT_82
from .graph import is_known
from .value import number_of


def film_of(reader, node, groups):
    """What a METAL or GLASS says of a thin film on it, or nothing."""
    socket = node.inputs.get("Thin Film Thickness")
    thickness = number_of(reader, socket, groups) if socket else 0.0
    if is_known(thickness) and thickness <= 0:
        return {}
    return {"film_thickness": [thickness], "film_ior": [number_of(reader, node.inputs["Thin Film IOR"], groups)],
            **working_space.told("film_rgb", working_space.from_xyz())}


def tinted(reader, base, edge):
    """What a METAL says of a metal of this colour and tint below a film."""
    eta, k = _index_of(reader, base, edge)
    return {"film_eta": eta, "film_k": k, "film_tint": edge}


def _index_of(reader, base, edge):
    """A metal's index and extinction that reflect this colour head-on; how much the first is, that at 82 degrees
    says [Gulbrandsen2014], as in Cycles. edge: its tint there."""
    math, etas, ks = reader.program.math, [], []
    for part, tint in zip(base, edge):
        part = math("CLAMP", part, 0.0, 0.99)
        tint = math("MULTIPLY", tint, math("MULTIPLY_ADD", part, 1 - AT_82, AT_82))
        root = math("SQRT", part)
        least = math("DIVIDE", math("SUBTRACT", 1.0, part), math("ADD", 1.0, part))
        most = math("DIVIDE", math("ADD", 1.0, root), math("SUBTRACT", 1.0, root))
        eta = math("MIX", most, least, tint)
        above, below = math("ADD", eta, 1.0), math("SUBTRACT", eta, 1.0)
        square = math("SUBTRACT", math("MULTIPLY", part, math("MULTIPLY", above, above)), math("MULTIPLY", below, below))
        etas.append(eta)
        ks.append(math("SQRT", math("MAXIMUM", math("DIVIDE", square, math("SUBTRACT", 1.0, part)), 0.0)))
    return tuple(etas), tuple(ks)
