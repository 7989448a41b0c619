# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a surface shows its side: Fresnel's reflectance, and what is like it."""

from . import tree
from .value import dot, group_vector, number_in, surface_normal, three, value_of


def _cosine(reader, found):
    """Of the eye and the normal, which may be bumped."""
    socket = found.node.inputs["Normal"]
    source = tree.trace(socket, found.groups)
    if source.node:
        normal = three(reader, value_of(reader, socket, found.groups))
    else:
        normal = group_vector(source) or surface_normal(reader)
    eye = reader.program.emit("GEOMETRY", what="INCOMING")
    return reader.program.math("ABSOLUTE", dot(reader, eye, normal))


def dielectric(reader, c, eta):
    """Reflectance of a clear body of relative index eta; 1 where all is reflected."""
    math = reader.program.math
    square = math("ADD", math("SUBTRACT", math("MULTIPLY", eta, eta), 1.0), math("MULTIPLY", c, c))
    g = math("SQRT", square)
    a = math("DIVIDE", math("SUBTRACT", g, c), math("ADD", g, c))
    b = math("DIVIDE", math("SUBTRACT", math("MULTIPLY", c, math("ADD", g, c)), 1.0),
             math("ADD", math("MULTIPLY", c, math("SUBTRACT", g, c)), 1.0))
    part = math("MULTIPLY", math("MULTIPLY", 0.5, math("MULTIPLY", a, a)),
                math("MULTIPLY_ADD", b, b, 1.0))
    return math("MIX", 1.0, part, math("GREATER_THAN", square, 0.0))


def _turned_inside(reader, eta, outside):
    """eta on one side of the surface, 1 / eta on the other."""
    back = reader.program.emit("GEOMETRY", what="BACKFACING")[0]
    other = reader.program.math("DIVIDE", 1.0, eta)
    first, second = (eta, other) if outside else (other, eta)
    return reader.program.math("MIX", first, second, back)


def _fresnel(reader, found):
    eta = reader.program.math("MAXIMUM", number_in(reader, found, "IOR"), 1e-5)
    return (dielectric(reader, _cosine(reader, found), _turned_inside(reader, eta, True)),)


def _layer_weight(reader, found):
    math, blend = reader.program.math, number_in(reader, found, "Blend")
    if found.output.name == "Fresnel":
        eta = math("MAXIMUM", math("SUBTRACT", 1.0, blend), 1e-5)
        return (dielectric(reader, _cosine(reader, found), _turned_inside(reader, eta, False)),)
    blend = math("CLAMP", blend, 0.0, 1.0 - 1e-5)
    low, high = math("MULTIPLY", blend, 2.0), math("DIVIDE", 0.5, math("SUBTRACT", 1.0, blend))
    power = math("MIX", high, low, math("LESS_THAN", blend, 0.5))
    return (math("SUBTRACT", 1.0, math("POWER", _cosine(reader, found), power)),)


NODES = {"FRESNEL": _fresnel, "LAYER_WEIGHT": _layer_weight}
