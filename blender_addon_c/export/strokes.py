# SPDX-License-Identifier: GPL-3.0-or-later
"""What a tool left on a Libshade Metal, where its Strokes are not 0: strokes that are rougher than the polish between them, with tails as
wide as measured ones have. Sized in metres; those that a ray is too wide for are their mean."""

from .. import metal_tree, nodes
from .closure_lobe import GGX
from .node_place import of_object, position, uv
from .value import each

_AXES = "XYZ"


def worn(reader, node, settings, parts):
    """Into the settings and parts of a metal's closure."""
    math = reader.program.math
    strength = math("MULTIPLY", metal_tree.ROUGHER * node.strokes, _share(reader, node))
    factor = math("ADD", 1.0, strength)
    alphas = parts.get("alpha") or nodes.lobe(node)
    parts["alpha"] = tuple(math("MINIMUM", math("MULTIPLY", alpha, factor), 1.0) for alpha in alphas)
    settings |= GGX


def _share(reader, node):
    """0 on the polish to 1 on a stroke."""
    math, width = reader.program.math, node.stroke_width * 1e-3
    ray = math("MULTIPLY", reader.program.emit("PATH", 1, what="WIDTH")[0], 2.0 * reader.unit_of_length() / width)
    seen = math("DIVIDE", 1.0, math("MAXIMUM", ray, 1e-6))  # coarsest strokes in what a ray stands for
    detail = math("CLAMP", math("LOGARITHM", seen, 2.0), 0.0, metal_tree.OCTAVES)
    at = _where(reader, node, width)
    noise = reader.program.emit("NOISE", 1, dimensions=3, what="FBM", even=False, first=False, at=[*at, 0.0], detail=[detail],
                                roughness=[metal_tree.UNEVEN], lacunarity=[2.0], offset=[0.0], gain=[1.0])[0]
    noise = math("MULTIPLY", noise, math("MINIMUM", seen, 1.0))
    return math("CLAMP", math("MULTIPLY_ADD", noise, metal_tree.CONTRAST, 0.5), 0.0, 1.0)


def _where(reader, node, width):
    """Three numbers: along strokes, in their lengths, and across, in widths."""
    math = reader.program.math
    reader.measures()
    in_map, in_object, _none = of_object(reader, "METRES")
    kind, _space, axis = node.grain.partition("_")
    if kind == "UV":
        u, v = each(reader, "MULTIPLY", uv(reader, node.uv_map)[:2], (math("MULTIPLY", in_map, 1.0 / width),) * 2)
        return math("MULTIPLY", u, 1.0 / metal_tree.LENGTHS), v, 0.0
    at = _AXES.index(axis)
    place = each(reader, "MULTIPLY", of_object(reader, "POINT_INTO", position(reader)), (math("MULTIPLY", in_object, 1.0 / width),) * 3)
    normal = each(reader, "ABSOLUTE", of_object(reader, "NORMAL_INTO", reader.program.emit("GEOMETRY", what="TRUE_NORMAL")))
    own, following, last = (place[(at + k) % 3] for k in range(3))
    ends = math("GREATER_THAN", normal[at], math("MAXIMUM", normal[at - 1], normal[at - 2]))  # faces along the axis
    if kind == "AXIS":  # where they look along it strokes lie along the next one, as the tangent does
        along, across = math("MIX", own, following, ends), math("MIX", following, own, ends)
        return math("MULTIPLY", along, 1.0 / metal_tree.LENGTHS), across, last
    radius = math("SQRT", math("MULTIPLY_ADD", last, last, math("MULTIPLY", following, following)))
    turn = math("DIVIDE", metal_tree.A_TURN, math("MAXIMUM", radius, 1e-6))
    return math("MIX", own, radius, ends), math("MULTIPLY", following, turn), math("MULTIPLY", last, turn)


def is_worn(node):
    return getattr(node, "strokes", 0.0) > 0
