# SPDX-License-Identifier: GPL-3.0-or-later
"""Radial Tiling: segments about a middle, of a polygon whose inner radius is 1 and whose corners may be round."""

from math import atan, cos, pi, sin, tan

from .graph import is_known
from .value import dot, number_in, vector_in


def _radial_tiling(reader, found):
    sides, roundness = (number_in(reader, found, name) for name in ("Sides", "Roundness"))
    if not is_known(sides, roundness):
        reader.warn(f"'{found.node.name}': Sides and Roundness that differ from place to place are not supported; 5 and 0 are used")
        sides, roundness = 5.0, 0.0
    sides, roundness = max(sides, 2.0), min(max(roundness, 0.0), 1.0)
    if roundness and sides % 1 or 0 < roundness < 1 and sides == 2:
        reader.warn(f"'{found.node.name}': Roundness of {'two sides' if sides == 2 else 'a part of a side'} is not supported; its corners are sharp")
        roundness = 0.0
    key = ("tiling", found.node, found.groups, reader.shift)
    if key not in reader.known:
        reader.known[key] = _tiled(reader, found, sides, roundness)
    return reader.known[key][found.output.name]


def _tiled(reader, found, sides, roundness):
    """What its outputs say."""
    math = reader.program.math
    x, y, _ = vector_in(reader, found, "Vector")
    turn = math("MULTIPLY_ADD", math("LESS_THAN", y, 0.0), 2 * pi, math("ARCTAN2", y, x))
    number, half = math("FLOOR", math("MULTIPLY", turn, sides / (2 * pi))), pi / sides
    begin, far = math("MULTIPLY", number, 2 * half), math("SQRT", dot(reader, (x, y), (x, y)))
    # the last may be a part of a side
    part = pi - sides // 1 * half
    is_part = math("GREATER_THAN", number, sides // 1 - 0.5) if part > 1e-6 else 0.0
    middle = math("MIX", half, part, is_part)
    off = math("SUBTRACT", math("SUBTRACT", turn, begin), middle)
    if roundness == 1:
        across, up, width = off, far, half
        most = half
    elif roundness > 0:
        across, up, most, width = _rounded(reader, off, far, half, roundness)
    else:
        size = math("MULTIPLY", far, math("MIX", 1.0, cos(half) / cos(part), is_part))
        across, up = (math("MULTIPLY", size, math(name, off)) for name in ("SINE", "COSINE"))
        width = math("MIX", tan(half), tan(part), is_part) if sides > 2 else 0.0
        most = math("MULTIPLY", up, width) if sides > 2 else 1.0
    if found.node.normalize:
        across = math("MULTIPLY_ADD", math("DIVIDE", across, most), 0.5, 0.5)
    else:
        up = math("SUBTRACT", up, 1.0)
    return {"Segment Coordinates": (across, up, 0.0), "Segment ID": (number,), "Segment Width": (width,),
            "Segment Rotation": (math("ADD", begin, middle),)}


def _rounded(reader, off, far, half, roundness):
    """(across, up, most of it across, width): a corner is a circle of that radius, and its length blends into the side's."""
    math = reader.program.math
    flat = atan((1 - roundness) * tan(half))  # where a side ends, from its middle
    bevel = half - flat
    blend, middle = (1 - roundness) * bevel, (1 - roundness) / cos(half)
    aside = math("ABSOLUTE", off)
    sign = math("MULTIPLY_ADD", math("LESS_THAN", off, 0.0), -2.0, 1.0)
    is_corner = math("GREATER_THAN", aside, flat)

    straight = math("MULTIPLY", far, math("COSINE", off))
    along = math("MULTIPLY", math("COSINE", math("SUBTRACT", half, aside)), middle)
    root = math("SQRT", math("MULTIPLY_ADD", along, along, roundness**2 - middle**2))
    up = math("MIX", straight, math("DIVIDE", far, math("ADD", along, root)), is_corner)
    into, near = math("SUBTRACT", aside, flat), math("MULTIPLY", far, cos(flat))
    square = math("MULTIPLY", math("MULTIPLY", into, into), 0.5 / blend)
    first = math("MULTIPLY_ADD", near, into, math("MULTIPLY", math("SUBTRACT", 1.0, near), square))
    then = math("MULTIPLY_ADD", math("SUBTRACT", near, 1.0), 0.5 * blend, into)
    bent = math("MULTIPLY_ADD", far, sin(flat), math("MIX", then, first, math("LESS_THAN", into, blend)))
    across = math("MIX", math("MULTIPLY", far, math("SINE", aside)), bent, is_corner)
    share = math("MULTIPLY", math("MULTIPLY", into, 1 / bevel), is_corner)
    outlines = (math("MULTIPLY_ADD", size, by + 0.5 * blend, 0.5 * blend + roundness * bevel)
                for size, by in ((up, tan(flat)), (near, tan(flat))))
    return math("MULTIPLY", across, sign), up, math("MIX", *outlines, share), tan(flat) + blend + roundness * bevel


NODES = {"ShaderNodeRadialTiling": _radial_tiling}
