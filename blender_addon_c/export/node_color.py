# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of numbers and colours."""

from array import array

from .. import working_space
from .graph import is_known
from .value import clamped, color_of, dot, each, number_in, number_of, unit, vector_in


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
                                    "COSINE", "TANGENT", "POWER", "SIGN", "ROUND")},
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
    if node.operation in _VECTORS:
        return _VECTORS[node.operation](reader, found, a, b, c)
    reader.warn(f"'{node.name}': {node.operation.lower()} is not supported; its first input is used")
    return a


def _scaled(reader, vector, by, more=(0.0,) * 3):
    return each(reader, "MULTIPLY_ADD", vector, (by,) * 3, more)


def _project(reader, _found, a, b, _c):
    return _scaled(reader, b, reader.program.math("DIVIDE", dot(reader, a, b), dot(reader, b, b)))


def _reflect(reader, _found, a, b, _c):
    normal = unit(reader, b)
    return _scaled(reader, normal, reader.program.math("MULTIPLY", dot(reader, a, normal), -2.0), a)


def _refract(reader, found, a, b, _c):
    """Nothing where all is reflected."""
    math, normal, eta = reader.program.math, unit(reader, b), number_in(reader, found, "Scale")
    along = dot(reader, a, normal)
    sine = math("MULTIPLY", math("MULTIPLY", eta, eta),
                math("SUBTRACT", 1.0, math("MULTIPLY", along, along)))
    rest = math("SUBTRACT", 1.0, sine)
    down = math("MULTIPLY_ADD", eta, along, math("SQRT", rest))
    bent = _scaled(reader, normal, math("MULTIPLY", down, -1.0), each(reader, "MULTIPLY", a, (eta,) * 3))
    there = math("SUBTRACT", 1.0, math("LESS_THAN", rest, 0.0))
    return each(reader, "MULTIPLY", bent, (there,) * 3)


def _face_forward(reader, _found, a, b, c):
    math = reader.program.math
    side = math("MULTIPLY_ADD", math("LESS_THAN", dot(reader, c, b), 0.0), 2.0, -1.0)
    return each(reader, "MULTIPLY", a, (side,) * 3)


_VECTORS = {"PROJECT": _project, "REFLECT": _reflect, "REFRACT": _refract, "FACEFORWARD": _face_forward}


MODES = set("""MIX DARKEN MULTIPLY BURN LIGHTEN SCREEN DODGE ADD OVERLAY SOFT_LIGHT LINEAR_LIGHT
DIFFERENCE EXCLUSION SUBTRACT DIVIDE""".split())


def _blend(reader, node, factor, a, b):
    mode = node.blend_type
    if mode in _HUES:
        return _HUES[mode](reader, factor, a, b)
    if mode not in MODES:
        reader.warn(f"'{node.name}': blending by {mode.lower()} is not supported; mixed")
        mode = "MIX"
    if mode == "MIX":
        return each(reader, "MIX", a, b, (factor,) * 3)
    return tuple(reader.program.emit("MIX", 1, mode=mode, factor=[factor], a=[one], b=[other])[0]
                 for one, other in zip(a, b))


def hue(reader, what, color):
    return reader.program.emit("HUE", what=what, color=tuple(color))


def _with_hue_of(reader, factor, a, b, saturation):
    """a with the hue of b, which may be grey, and with its saturation too."""
    own, other = hue(reader, "RGB_TO_HSV", a), hue(reader, "RGB_TO_HSV", b)
    made = hue(reader, "HSV_TO_RGB", (other[0], other[1] if saturation else own[1], own[2]))
    colored = reader.program.math("SUBTRACT", 1.0, reader.program.math("COMPARE", other[1], 0.0, 0.0))
    return each(reader, "MIX", a, made, (reader.program.math("MULTIPLY", factor, colored),) * 3)


def _mix_saturation(reader, factor, a, b):
    own, other = hue(reader, "RGB_TO_HSV", a), hue(reader, "RGB_TO_HSV", b)
    mixed = reader.program.math("MIX", own[1], other[1], factor)
    made = hue(reader, "HSV_TO_RGB", (own[0], mixed, own[2]))
    grey = reader.program.math("COMPARE", own[1], 0.0, 0.0)
    return each(reader, "MIX", made, a, (grey,) * 3)


def _mix_value(reader, factor, a, b):
    own, other = hue(reader, "RGB_TO_HSV", a), hue(reader, "RGB_TO_HSV", b)
    return hue(reader, "HSV_TO_RGB", (*own[:2], reader.program.math("MIX", own[2], other[2], factor)))


_HUES = {"HUE": lambda reader, factor, a, b: _with_hue_of(reader, factor, a, b, False),
         "COLOR": lambda reader, factor, a, b: _with_hue_of(reader, factor, a, b, True),
         "SATURATION": _mix_saturation, "VALUE": _mix_value}


def _hue_saturation(reader, found):
    math, color = reader.program.math, vector_in(reader, found, "Color")
    h, s, v = hue(reader, "RGB_TO_HSV", color)
    turned = math("FRACT", math("ADD", math("ADD", h, number_in(reader, found, "Hue")), 0.5))
    made = hue(reader, "HSV_TO_RGB", (
        turned, clamped(reader, math("MULTIPLY", s, number_in(reader, found, "Saturation"))),
        math("MULTIPLY", v, number_in(reader, found, "Value"))))
    mixed = each(reader, "MIX", color, made, (number_in(reader, found, "Fac"),) * 3)
    return each(reader, "MAXIMUM", mixed)


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
    mode, color = getattr(found.node, "mode", "RGB"), vector_in(reader, found, 0)
    if mode != "RGB":
        key = ("separate", found.node, found.groups, reader.shift)
        if key not in reader.known:
            reader.known[key] = hue(reader, f"RGB_TO_{mode}", color)
        color = reader.known[key]
    return (color[list(found.node.outputs).index(found.output)],)


def _combine(reader, found):
    mode = getattr(found.node, "mode", "RGB")
    color = tuple(number_in(reader, found, k) for k in range(3))
    return color if mode == "RGB" else hue(reader, f"{mode}_TO_RGB", color)


def _old_hsv(reader, found):
    """Nodes of their own until 3.3, which old files still have."""
    if len(found.node.outputs) == 1:
        return hue(reader, "HSV_TO_RGB", (number_in(reader, found, k) for k in range(3)))
    color = hue(reader, "RGB_TO_HSV", vector_in(reader, found, 0))
    return (color[list(found.node.outputs).index(found.output)],)


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
    return (dot(reader, vector_in(reader, found, "Color"), working_space.luminance()),)


def _map_range(reader, found):
    node = found.node
    by = {socket.identifier: socket for socket in node.inputs}
    vector = node.data_type == "FLOAT_VECTOR"
    names = ("From Min", "From Max", "To Min", "To Max", "Steps")
    if not vector:
        given = (number_of(reader, by[name], found.groups) for name in ("Value", *names))
        return (_ranged(reader, node, *given),)
    sockets = (by["Vector"], *(by[name.replace(" ", "_") + "_FLOAT3"] for name in names))
    given = zip(*(color_of(reader, socket, found.groups) for socket in sockets))
    return tuple(_ranged(reader, node, *parts) for parts in given)


def _ranged(reader, node, value, low, high, to_low, to_high, steps):
    """Of numbers an empty range says 0, as near as it may, of vectors its lower end."""
    math, kind = reader.program.math, node.interpolation_type
    part = math("DIVIDE", math("SUBTRACT", value, low), math("SUBTRACT", high, low))
    if kind == "STEPPED":
        steps = math("MAXIMUM", steps, 0.0)
        part = math("DIVIDE", math("FLOOR", math("MULTIPLY", part, math("ADD", steps, 1.0))), steps)
    if node.clamp or kind.startswith("SMOOTH"):
        part = clamped(reader, part)
    square = math("MULTIPLY", part, part)
    if kind == "SMOOTHSTEP":
        part = math("MULTIPLY", square, math("MULTIPLY_ADD", part, -2.0, 3.0))
    elif kind == "SMOOTHERSTEP":
        inner = math("MULTIPLY_ADD", part, math("MULTIPLY_ADD", part, 6.0, -15.0), 10.0)
        part = math("MULTIPLY", math("MULTIPLY", square, part), inner)
    made = math("MIX", to_low, to_high, part)
    if node.data_type == "FLOAT" and not (is_known(low, high) and low != high):
        made = math("MULTIPLY", made, math("SUBTRACT", 1.0, math("COMPARE", low, high, 0.0)))
        if node.clamp:
            made = math("CLAMP", made, math("MINIMUM", to_low, to_high), math("MAXIMUM", to_low, to_high))
    return made


def _normal(reader, found):
    """A direction of its own, and how much another is along it."""
    own = unit(reader, tuple(float(part) for part in found.node.outputs["Normal"].default_value))
    if found.output.name == "Normal":
        return own
    return (dot(reader, own, unit(reader, vector_in(reader, found, "Normal"))),)


NODES = {
    "RGB": _rgb, "VALUE": _value_node,
    "MATH": _math, "VECT_MATH": _vector_math, "MIX_RGB": _mix_rgb, "MIX": _mix, "VALTORGB": _ramp,
    "SEPRGB": _separate, "SEPXYZ": _separate, "SEPARATE_COLOR": _separate,
    "COMBRGB": _combine, "COMBXYZ": _combine, "COMBINE_COLOR": _combine,
    "CLAMP": _clamp, "INVERT": _invert, "GAMMA": _gamma, "BRIGHTCONTRAST": _bright_contrast,
    "SEPHSV": _old_hsv, "COMBHSV": _old_hsv, "HUE_SAT": _hue_saturation, "RGBTOBW": _to_bw, "MAP_RANGE": _map_range,
    "NORMAL": _normal,
}
