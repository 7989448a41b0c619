# SPDX-License-Identifier: GPL-3.0-or-later
"""What a tool left on a Libshade Metal, where its Strokes are not 0: strokes that are rougher than the polish between them, with tails as
wide as measured ones have. Sized in metres; those that a ray is too wide for are their mean. They turn with Rotation."""

from math import e, tau

from .. import metal_tree, nodes
from .closure_lobe import GGX
from .graph import is_known
from .node_place import layer, of_object, position, uv
from .value import dot, each, number_of

_AXES = "XYZ"
_STEPS = 36  # of a turn, where a texture turns them
_APART = 7.3  # widths between what is seen by one step and by the next, so that they have nothing in common
_FLATTER = 1.2  # noise of three dimensions varies so much more than that of four
_LEANS = 0.2  # a cosine: where a face leans so far towards the axis, strokes would be cut short


def worn(reader, node, groups, settings, parts):
    """Into the settings and parts of a metal's closure."""
    math = reader.program.math
    strength = math("MULTIPLY", metal_tree.ROUGHER * node.strokes, _share(reader, node, groups))
    factor = math("ADD", 1.0, strength)
    alphas = parts.get("alpha") or nodes.lobe(node)
    parts["alpha"] = tuple(math("MINIMUM", math("MULTIPLY", alpha, factor), 1.0) for alpha in alphas)
    settings |= GGX


def _share(reader, node, groups):
    """0 on the polish to 1 on a stroke."""
    math, width = reader.program.math, node.stroke_width * 1e-3
    ray = math("MULTIPLY", reader.program.emit("PATH", 1, what="WIDTH")[0], 2.0 * reader.unit_of_length() / width)
    seen = math("DIVIDE", 1.0, math("MAXIMUM", ray, 1e-6))  # coarsest strokes in what a ray stands for
    detail = math("CLAMP", math("LOGARITHM", seen, 2.0), 0.0, metal_tree.OCTAVES)

    def noise(at):
        found = reader.program.emit("NOISE", 1, dimensions=len(at), what="FBM", even=False, first=False, at=[*at, 0.0][:4], detail=[detail],
                                    roughness=[metal_tree.UNEVEN], lacunarity=[2.0], offset=[0.0], gain=[1.0])[0]
        return math("MULTIPLY", found, _FLATTER) if len(at) == 4 else found

    turns = number_of(reader, node.inputs["Rotation"], groups) if "Rotation" in node.inputs else 0.0
    if is_known(turns) and turns % 1 == 0:
        found = noise(_where(reader, node, width))
    else:
        found = _turned(reader, noise, turns, *_plane(reader, node, width))
    found = math("MULTIPLY", found, math("MINIMUM", seen, 1.0))
    return math("CLAMP", math("MULTIPLY_ADD", found, metal_tree.CONTRAST, 0.5), 0.0, 1.0)


def _turned(reader, noise, turns, along, across, beside):
    """Noise of strokes turned in the plane of two numbers. A place alone would shear what a texture turns: there it is strokes of
    whole steps, two at a time, each by how near it is and as strong together as one."""
    math = reader.program.math

    def at(turns, apart):
        c, s = (math(word, math("MULTIPLY", turns, tau)) for word in ("COSINE", "SINE"))
        own = math("MULTIPLY_ADD", along, c, math("MULTIPLY", across, s))
        return noise((math("MULTIPLY", own, 1.0 / metal_tree.LENGTHS),
                      math("SUBTRACT", math("MULTIPLY", across, c), math("MULTIPLY", along, s)),
                      math("MULTIPLY_ADD", apart, _APART, beside)))

    if is_known(turns):
        return at(turns, 0.0)
    steps = math("MULTIPLY", turns, _STEPS)
    first = math("FLOOR", steps)
    part = math("SUBTRACT", steps, first)
    rest = math("SUBTRACT", 1.0, part)
    pair = [at(math("DIVIDE", step, _STEPS), math("FLOORED_MODULO", step, _STEPS)) for step in (first, math("ADD", first, 1.0))]
    length = math("SQRT", math("MULTIPLY_ADD", part, part, math("MULTIPLY", rest, rest)))
    return math("DIVIDE", math("MULTIPLY_ADD", pair[0], rest, math("MULTIPLY", pair[1], part)), length)


def _place(reader, node, width):
    """The point in the object in widths, from the grain's axis on."""
    reader.measures()
    in_object, at = of_object(reader, "METRES")[1], _AXES.index(node.grain[-1])
    scale = reader.program.math("MULTIPLY", in_object, 1.0 / width)
    place = each(reader, "MULTIPLY", of_object(reader, "POINT_INTO", position(reader)), (scale,) * 3)
    return [place[(at + k) % 3] for k in range(3)]


def _faces(reader, node):
    """The normal in the object, from the grain's axis on, and whether it looks along that axis most; else along the next one more
    than along the last; and whether it leans towards the axis."""
    math, at = reader.program.math, _AXES.index(node.grain[-1])
    found = of_object(reader, "NORMAL_INTO", reader.program.emit("GEOMETRY", what="NORMAL"))
    normal = [found[(at + k) % 3] for k in range(3)]
    size = each(reader, "ABSOLUTE", normal)
    ends = math("GREATER_THAN", size[0], math("MAXIMUM", size[1], size[2]))
    return normal, ends, math("GREATER_THAN", size[1], size[2]), math("GREATER_THAN", size[0], _LEANS)


def _in_map(reader, node, width):
    reader.measures()
    scale = reader.program.math("MULTIPLY", of_object(reader, "METRES")[0], 1.0 / width)
    return each(reader, "MULTIPLY", uv(reader, node.uv_map)[:2], (scale,) * 2)


def _where(reader, node, width):
    """Three or four numbers: along strokes, in their lengths, and across, in widths."""
    math, kind = reader.program.math, node.grain.partition("_")[0]
    if kind == "UV":
        u, v = _in_map(reader, node, width)
        return math("MULTIPLY", u, 1.0 / metal_tree.LENGTHS), v, 0.0
    own, following, last = _place(reader, node, width)
    if kind == "AXIS":  # where they look along it strokes lie along the next one, as the tangent does
        _normal, ends, beside, leans = _faces(reader, node)  # where they lean, as if seen from the side that they look to
        along, depth = math("MIX", own, following, ends), math("MAXIMUM", beside, ends)  # that of `following`, else of `last`
        return (math("MULTIPLY", along, 1.0 / metal_tree.LENGTHS), math("MIX", following, _APART, math("MULTIPLY", leans, depth)),
                math("MIX", last, _APART, math("MULTIPLY", leans, math("SUBTRACT", 1.0, depth))))
    radius = math("SQRT", math("MULTIPLY_ADD", last, last, math("MULTIPLY", following, following)))
    turn = math("DIVIDE", metal_tree.A_TURN, math("MAXIMUM", radius, 1e-6))
    return own, radius, math("MULTIPLY", following, turn), math("MULTIPLY", last, turn)


def _plane(reader, node, width):
    """The same where they are turned, in widths: along the tangent, a quarter of a turn on from it, and the rest."""
    math, kind = reader.program.math, node.grain.partition("_")[0]
    if kind == "UV":
        u, v = _in_map(reader, node, width)
        return u, math("MULTIPLY", v, _hand_of_map(reader, node)), 0.0
    own, following, last = _place(reader, node, width)
    normal, ends, beside, leans = _faces(reader, node)
    hand = _hand_of_object(reader)
    if kind == "AXIS":  # on faces along `following`, along `last`, along the axis itself
        signed = [math("SIGN", part) for part in normal]
        sides = (math("MULTIPLY", following, signed[2]), math("MULTIPLY", math("MULTIPLY", last, signed[1]), -1.0))
        across = math("MIX", math("MIX", *sides, beside), math("MULTIPLY", last, signed[0]), ends)
        along, rest = math("MIX", own, following, ends), math("MIX", math("MIX", last, following, beside), own, ends)
        return along, math("MULTIPLY", across, hand), math("MIX", rest, 0.0, leans)
    # A spiral keeps its angle where it winds by the logarithm of the radius: widths are right where that is a power of two.
    radius = math("MAXIMUM", math("SQRT", math("MULTIPLY_ADD", last, last, math("MULTIPLY", following, following))), 1e-6)
    near = math("POWER", 2.0, math("ROUND", math("LOGARITHM", radius, 2.0)))
    along = math("MULTIPLY", near, math("ARCTAN2", following, math("MULTIPLY", last, -1.0)))
    outwards = math("SIGN", math("MULTIPLY_ADD", normal[1], following, math("MULTIPLY", normal[2], last)))
    spread = math("MULTIPLY", math("MULTIPLY", near, math("LOGARITHM", radius, e)), math("MULTIPLY", math("SIGN", normal[0]), -1.0))
    return along, math("MULTIPLY", math("MIX", math("MULTIPLY", own, outwards), spread, ends), hand), near


def _triple(reader, a, b, c):
    math = reader.program.math
    cross = [math("SUBTRACT", math("MULTIPLY", b[i - 2], c[i - 1]), math("MULTIPLY", b[i - 1], c[i - 2])) for i in range(3)]
    return dot(reader, a, cross)


def _hand_of_object(reader):
    """-1 where it is mirrored."""
    axes = [of_object(reader, "VECTOR_OUT_OF", [float(i == k) for i in range(3)]) for k in range(3)]
    return reader.program.math("SIGN", _triple(reader, *axes))


def _hand_of_map(reader, node):
    """-1 where the map is mirrored."""
    if not reader.is_main(node.uv_map):
        return reader.program.math("SIGN", layer(reader, "TANGENT", node.uv_map)[3])
    normal, *along = (reader.program.emit("GEOMETRY", what=what) for what in ("NORMAL", "ALONG_U", "ALONG_V"))
    return reader.program.math("SIGN", _triple(reader, normal, *along))


def is_worn(node):
    return getattr(node, "strokes", 0.0) > 0
