# SPDX-License-Identifier: GPL-3.0-or-later
"""How far and where shaders draw their lobes out: alphas along the tangent and across it, and x and y of that tangent in the
shading frame, None for the UV map's own."""

from . import tree
from .closure_add import is_zero
from .graph import is_known
from .node_place import tangent_of, usual_tangent
from .value import clamped, color_of, number_of


def drawn_out(reader, node, groups, alpha, name, rotation):
    """alpha / a and alpha a, a^2 = 1 - 0.9 anisotropic; where the tangent is turned to, or None."""
    math, amount = reader.program.math, clamped(reader, number_of(reader, node.inputs[name], groups))
    if is_zero(amount):
        return (alpha, alpha), None
    a = math("SQRT", math("SUBTRACT", 1.0, math("MULTIPLY", amount, 0.9)))
    return (math("MINIMUM", math("DIVIDE", alpha, a), 1.0), math("MULTIPLY", alpha, a)), _groove(reader, node, rotation, groups)


def stretched(reader, node, groups, alpha):
    """Alphas along the tangent and across it, and where it is turned to, or None."""
    alphas = pulled(reader, node, groups, alpha)
    return alphas, None if alphas[0] is alphas[1] else _groove(reader, node, "Rotation", groups)


def pulled(reader, node, groups, alpha):
    """Alphas along the tangent and across it, of the Glossy BSDF: alpha / (1 + a) and alpha (1 + a) below 0,
    alpha (1 - a) and alpha / (1 - a) above."""
    math, socket = reader.program.math, node.inputs.get("Anisotropy")
    a = number_of(reader, socket, groups) if socket else 0.0
    if is_zero(a):
        return alpha, alpha
    a = math("CLAMP", a, -0.99, 0.99)
    size = math("SUBTRACT", 1.0, math("ABSOLUTE", a))
    small, large = math("MULTIPLY", alpha, size), math("MINIMUM", math("DIVIDE", alpha, size), 1.0)
    along = math("GREATER_THAN", a, 0.0) if not is_known(a) else float(a > 0)
    return math("MIX", large, small, along), math("MIX", small, large, along)


def tangent(reader, node, groups):
    """Of a node's Tangent."""
    found = tree.trace(node.inputs["Tangent"], groups)
    if found.node is None:
        vector = usual_tangent(reader)
    elif found.node.type == "TANGENT":
        vector = tangent_of(reader, found.node)
    else:
        vector = color_of(reader, node.inputs["Tangent"], groups)
    return vector and in_frame(reader, vector)


def in_frame(reader, vector):
    return reader.program.emit("FRAME", vector=tuple(vector), to="SHADING")[:2]


def _groove(reader, node, rotation, groups):
    """Where the tangent points once it is turned."""
    return rotated(reader, tangent(reader, node, groups), node.inputs[rotation], groups)


def rotated(reader, own, rotation, groups):
    """The same of a tangent, or of the mesh's own where that is None, and a socket of turns."""
    reader.by_mesh = reader.by_mesh or not own
    turns = number_of(reader, rotation, groups)
    if is_known(turns) and turns % 1 == 0:
        return own
    math = reader.program.math
    angle = math("MULTIPLY", turns, 6.283185307179586)
    c, s = math("COSINE", angle), math("SINE", angle)
    if not own:
        return [c, s]
    x, y = own
    return [math("SUBTRACT", math("MULTIPLY", x, c), math("MULTIPLY", y, s)),
            math("MULTIPLY_ADD", x, s, math("MULTIPLY", y, c))]
