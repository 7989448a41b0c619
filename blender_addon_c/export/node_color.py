# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of numbers and colours."""

from array import array

from .value import LUMINANCE, clamped, color_of, dot, each, number_in, number_of, unit, vector_in


def _rgb(_reader, found):
    return tuple(float(v) for v in found.output.default_value[:3])


def _value_node(_reader, found):
    return (float(found.output.default_value),)


def _math(reader, found):
    node = found.node
    if node.operation not in MATH:
        reader.warn(f"'{node.name}': {node.operation.lower()} is not supported; its first input is "
                    "used")
        return (number_in(reader, found, 0),)
    parts = [number_in(reader, found, k) for k in range(len(node.inputs))]
    part = reader.program.math(node.operation, *parts)
    return (clamped(reader, part) if node.use_clamp else part,)


MATH = set("""ADD SUBTRACT MULTIPLY DIVIDE MULTIPLY_ADD POWER LOGARITHM SQRT INVERSE_SQRT ABSOLUTE
EXPONENT MINIMUM MAXIMUM LESS_THAN GREATER_THAN SIGN COMPARE SMOOTH_MIN SMOOTH_MAX ROUND FLOOR CEIL
TRUNC FRACT MODULO FLOORED_MODULO WRAP SNAP PINGPONG SINE COSINE TANGENT ARCSINE ARCCOSINE ARCTANGENT
ARCTAN2 SINH COSH TANH RADIANS DEGREES""".split())

# Of the Vector Math node, to operations on each part.
_EACH = {**{name: name for name in ("ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "FLOOR",
                                    "CEIL", "MODULO", "WRAP", "SNAP", "MINIMUM", "MAXIMUM", "SINE",
                                    "COSINE", "TANGENT", "POWER", "SIGN")},
         "FRACTION": "FRACT", "ABSOLUTE": "ABSOLUTE"}


def _vector_math(reader, found):
    node, program = found.node, reader.program
    a, b, c = (vector_in(reader, found, k) for k in range(3))
    if node.operation in _EACH:
        return each(reader, _EACH[node.operation], a, b, c)
    if node.operation == "SCALE":
        return each(reader, "MULTIPLY", a, (number_in(reader, found, "Scale"),) * 3)
    if node.operation == "DOT_PRODUCT":
        return (dot(reader, a, b),)
    if node.operation == "CROSS_PRODUCT":
        return tuple(program.math("SUBTRACT", program.math("MULTIPLY", a[i], b[j]),
                                  program.math("MULTIPLY", a[j], b[i]))
                     for i, j in ((1, 2), (2, 0), (0, 1)))
    if node.operation in ("LENGTH", "DISTANCE"):
        d = each(reader, "SUBTRACT", a, b) if node.operation == "DISTANCE" else a
        return (program.math("SQRT", dot(reader, d, d)),)
    if node.operation == "NORMALIZE":
        return unit(reader, a)
    reader.warn(f"'{node.name}': {node.operation.lower()} is not supported; its first input is used")
    return a


MODES = set("""MIX DARKEN MULTIPLY BURN LIGHTEN SCREEN DODGE ADD OVERLAY SOFT_LIGHT LINEAR_LIGHT
DIFFERENCE EXCLUSION SUBTRACT DIVIDE""".split())


def _blend(reader, node, factor, a, b):
    mode = node.blend_type
    if mode not in MODES:
        reader.warn(f"'{node.name}': blending by {mode.lower()} is not supported; mixed")
        mode = "MIX"
    if mode == "MIX":
        return each(reader, "MIX", a, b, (factor,) * 3)
    return tuple(reader.program.emit("MIX", 1, mode=mode, factor=[factor], a=[one], b=[other])[0]
                 for one, other in zip(a, b))


def _mix_rgb(reader, found):
    mixed = _blend(reader, found.node, clamped(reader, number_in(reader, found, "Fac")),
                   vector_in(reader, found, "Color1"), vector_in(reader, found, "Color2"))
    return tuple(clamped(reader, part) for part in mixed) if found.node.use_clamp else mixed


def _mix(reader, found):
    node = found.node
    word = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}.get(node.data_type)
    if not word:
        reader.warn(f"'{node.name}': {node.data_type.lower()} is not supported; left out")
        return None
    by = {socket.identifier: socket for socket in node.inputs}
    uniform = word != "Vector" or node.factor_mode == "UNIFORM"
    factor = by["Factor_Float" if uniform else "Factor_Vector"]
    factor = ((number_of(reader, factor, found.groups),) * 3 if uniform
              else color_of(reader, factor, found.groups))
    if node.clamp_factor:
        factor = tuple(clamped(reader, part) for part in factor)
    if word == "Float":
        a, b = (number_of(reader, by[f"{letter}_Float"], found.groups) for letter in "AB")
        return (reader.program.math("MIX", a, b, factor[0]),)
    a, b = (color_of(reader, by[f"{letter}_{word}"], found.groups) for letter in "AB")
    if word == "Vector":
        return each(reader, "MIX", a, b, factor)
    mixed = _blend(reader, node, factor[0], a, b)
    return tuple(clamped(reader, part) for part in mixed) if node.clamp_result else mixed


def _ramp(reader, found):
    ramp, key = found.node.color_ramp, ("ramp", found.node, found.groups, reader.shift)
    if key not in reader.known:
        table = array("f", [part for k in range(256) for part in ramp.evaluate(k / 255)])
        reader.known[key] = reader.program.emit(
            "RAMP", 4, table=table, at=[number_in(reader, found, "Fac")],
            smooth=ramp.color_mode != "RGB" or ramp.interpolation != "CONSTANT")
    *color, alpha = reader.known[key]
    return (alpha,) if found.output.name == "Alpha" else color


def _separate(reader, found):
    if getattr(found.node, "mode", "RGB") != "RGB":
        reader.warn(f"'{found.node.name}': {found.node.mode} is not supported; taken as RGB")
    return (vector_in(reader, found, 0)[list(found.node.outputs).index(found.output)],)


def _combine(reader, found):
    if getattr(found.node, "mode", "RGB") != "RGB":
        reader.warn(f"'{found.node.name}': {found.node.mode} is not supported; taken as RGB")
    return tuple(number_in(reader, found, k) for k in range(3))


def _clamp(reader, found):
    value, low, high = (number_in(reader, found, name) for name in ("Value", "Min", "Max"))
    if found.node.clamp_type == "RANGE":
        low, high = (reader.program.math(pick, low, high) for pick in ("MINIMUM", "MAXIMUM"))
    return (reader.program.math("CLAMP", value, low, high),)


def _invert(reader, found):
    color, factor = vector_in(reader, found, "Color"), number_in(reader, found, "Fac")
    return each(reader, "MIX", color, each(reader, "SUBTRACT", (1.0,) * 3, color), (factor,) * 3)


def _gamma(reader, found):
    """What is not above 0 stays as it is."""
    color, gamma = vector_in(reader, found, "Color"), number_in(reader, found, "Gamma")
    positive = each(reader, "GREATER_THAN", color)
    return each(reader, "MIX", color, each(reader, "POWER", color, (gamma,) * 3), positive)


def _bright_contrast(reader, found):
    contrast = number_in(reader, found, "Contrast")
    offset = reader.program.math("MULTIPLY_ADD", contrast, -0.5, number_in(reader, found, "Bright"))
    slope = reader.program.math("ADD", contrast, 1.0)
    scaled = each(reader, "MULTIPLY_ADD", vector_in(reader, found, "Color"), (slope,) * 3,
                   (offset,) * 3)
    return each(reader, "MAXIMUM", scaled)


def _to_bw(reader, found):
    return (dot(reader, vector_in(reader, found, "Color"), LUMINANCE),)


def _map_range(reader, found):
    node, program = found.node, reader.program
    if node.data_type != "FLOAT" or node.interpolation_type != "LINEAR":
        reader.warn(f"'{node.name}': only linear ranges of floats are supported")
    names = ("Value", "From Min", "From Max", "To Min", "To Max")
    value, low, high, to_low, to_high = (number_in(reader, found, name) for name in names)
    part = program.math("DIVIDE", program.math("SUBTRACT", value, low),
                        program.math("SUBTRACT", high, low))
    if node.clamp:
        part = clamped(reader, part)
    return (program.math("MIX", to_low, to_high, part),)


NODES = {
    "RGB": _rgb, "VALUE": _value_node,
    "MATH": _math, "VECT_MATH": _vector_math, "MIX_RGB": _mix_rgb, "MIX": _mix, "VALTORGB": _ramp,
    "SEPRGB": _separate, "SEPXYZ": _separate, "SEPARATE_COLOR": _separate,
    "COMBRGB": _combine, "COMBXYZ": _combine, "COMBINE_COLOR": _combine,
    "CLAMP": _clamp, "INVERT": _invert, "GAMMA": _gamma, "BRIGHTCONTRAST": _bright_contrast,
    "RGBTOBW": _to_bw, "MAP_RANGE": _map_range,
}
