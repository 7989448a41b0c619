# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that feed a closure: one function for each, to nodes of the native module.

A function gets the material's reader and where a link came from (tree.Source), and returns what the
node's output says: parts, each a number or a register, one of a value, three of a colour or vector.
"""

from array import array
from collections import namedtuple

from mathutils import Matrix

from . import tree
from .graph import is_known
from .image import MISSING, MISSING_COLOR

# kind: VALUE, RGBA, VECTOR, or NORMAL, a vector in the shading frame.
Value = namedtuple("Value", "kind parts")

_WRAPS = {"REPEAT", "EXTEND", "CLIP", "MIRROR"}
_FILTERS = {"Linear": "LINEAR", "Closest": "CLOSEST"}
_LUMINANCE = (0.2126, 0.7152, 0.0722)  # of Rec. 709, Blender's default


def color_of(reader, socket, groups):
    """Three parts of a socket."""
    return _three(reader, value_of(reader, socket, groups))


def number_of(reader, socket, groups):
    """The one part of a socket."""
    return _one(reader, value_of(reader, socket, groups))


def normal_of(reader, socket, groups):
    """Registers of a normal in the shading frame, or None for the surface's own."""
    found = tree.trace(socket, groups)
    if found.node is None:
        return None
    value = value_of(reader, socket, groups, own=Value("NORMAL", None))
    if value.parts is None or value.kind == "NORMAL":
        return value.parts
    return reader.program.emit("FRAME", vector=_three(reader, value), to="SHADING")


def value_of(reader, socket, groups, own=None):
    """What feeds a socket. `own`: what it is where nothing does, else the socket's own value."""
    found = tree.trace(socket, groups)
    own = own or _own_value(found.socket)
    if found.node is None:
        return own
    key = (found.output, found.groups, reader.shift)
    if key not in reader.known:
        reader.known[key] = None  # being asked for
        reader.known[key] = _value(reader, found, socket) or "unknown"
    known = reader.known[key]
    if known is None:
        reader.warn(f"'{found.node.name}' feeds itself; the link is left out")
    return own if known in (None, "unknown") else known


def _own_value(socket):
    value = tree.own_value(socket)
    if isinstance(value, tuple):
        return Value("RGBA" if len(value) == 4 else "VECTOR", value[:3])
    return Value("VALUE", (value,))


def _value(reader, found, socket):
    node = found.node
    function = NODES.get(node.type)
    if not function:
        reader.warn(f"{socket.name}: '{node.name}' ({found.output.name}) is not supported; "
                    "what feeds it is used, or the socket's own value")
        through = next((l for l in node.internal_links if l.to_socket == found.output), None)
        if not (through and through.from_socket.is_linked):
            return None
        return value_of(reader, through.from_socket, found.groups)
    value = function(reader, found)
    if value is None or isinstance(value, Value):
        return value
    return Value("VALUE" if len(value) == 1 else found.output.type, tuple(value))


def _three(reader, value):
    if value.kind == "NORMAL":
        return tuple(reader.program.emit("FRAME", vector=value.parts, to="WORLD"))
    return value.parts if len(value.parts) == 3 else value.parts * 3


def _one(reader, value):
    if len(value.parts) == 1:
        return value.parts[0]
    weights = _LUMINANCE if value.kind == "RGBA" else (1 / 3,) * 3
    return _dot(reader, _three(reader, value), weights)


# ---- several numbers at once


def _each(reader, operation, a, b=(0.0,) * 3, c=(0.0,) * 3):
    return tuple(reader.program.math(operation, *parts) for parts in zip(a, b, c))


def _dot(reader, a, b):
    total = 0.0
    for one, other in zip(a, b):
        total = reader.program.math("ADD", total, reader.program.math("MULTIPLY", one, other))
    return total


def _clamped(reader, part):
    return reader.program.math("CLAMP", part, 0.0, 1.0)


def _input(reader, found, name):
    """Three parts of an input, by name or number."""
    return color_of(reader, found.node.inputs[name], found.groups)


def _number(reader, found, name):
    return number_of(reader, found.node.inputs[name], found.groups)


# ---- constants and images


def _rgb(_reader, found):
    return tuple(float(v) for v in found.output.default_value[:3])


def _value_node(_reader, found):
    return (float(found.output.default_value),)


def _tex_image(reader, found):
    node = found.node
    image = _image(reader, node)
    if image == MISSING:
        return (1.0,) if found.output.name == "Alpha" else MISSING_COLOR
    if image < 0:
        return None
    at = _coordinates(reader, node.inputs["Vector"], found.groups)
    key = ("image", node, found.groups, reader.shift)
    if key not in reader.known:  # both outputs are of one look
        reader.known[key] = reader.program.emit("IMAGE", 3, "alpha", image=image,
                                                **({"at": at[:2]} if at else {}))
    *color, alpha = reader.known[key]
    return (alpha,) if found.output.name == "Alpha" else color


def _image(reader, node):
    """Index of the image that a node shows, MISSING or -1 (with a message)."""
    if not node.image:
        reader.warn(f"'{node.name}' has no image")
        return MISSING
    if node.projection != "FLAT":
        reader.warn(f"'{node.name}': only flat projection is supported")
    if node.extension not in _WRAPS:
        reader.warn(f"'{node.name}': extension {node.extension.lower()} is not supported; repeated")
    if node.interpolation not in _FILTERS:
        reader.warn(f"'{node.name}': interpolation {node.interpolation.lower()} is not supported; "
                    "linear")
    return reader.images.index(
        node.image, node.extension if node.extension in _WRAPS else "REPEAT",
        _FILTERS.get(node.interpolation, "LINEAR"), reader.owner)


def _coordinates(reader, socket, groups):
    """Where an image is looked up; None: at the UV map's place."""
    at = _place(reader, socket, groups)
    return _uv(reader) if at is None and reader.shift else at


def _place(reader, socket, groups):
    found = tree.trace(socket, groups)
    if found.node is None or (found.node.type == "TEX_COORD" and found.output.name == "UV"):
        reader.uses_uv = True
        return None
    if found.node.type == "UVMAP":
        reader.use_uv_map(found.node.uv_map)
        return None
    value = value_of(reader, socket, groups, own=Value("VECTOR", None))
    if value.parts is None:
        reader.uses_uv = True
        return None
    return _three(reader, value)


# ---- normals


def _normal_map(reader, found):
    node = found.node
    strength = _number(reader, found, "Strength")
    if node.space in ("WORLD", "BLENDER_WORLD"):
        return _world_normal(reader, found, strength)
    if node.space != "TANGENT":
        reader.warn(f"'{node.name}' is in {node.space.lower()} space, only tangent and world "
                    "space are supported; left out")
        return None
    if node.uv_map:
        reader.use_uv_map(node.uv_map)
    color = tree.trace(node.inputs["Color"], found.groups)
    if color.node and color.node.type == "TEX_IMAGE" and color.output.name == "Color":
        _check_normal_image(reader, color.node.image)
        image = _image(reader, color.node)
        if image < 0:
            return None
        at = _coordinates(reader, color.node.inputs["Vector"], color.groups)
        if at is None and is_known(strength):
            return Value("NORMAL", reader.program.emit("NORMAL_MAP", image=image,
                                                       strength=strength))
    elif color.node is None:
        reader.warn(f"'{node.name}' has no image")
    return Value("NORMAL", reader.program.emit("PERTURB", color=_input(reader, found, "Color"),
                                               strength=[strength]))


def _world_normal(reader, found, strength):
    color = _input(reader, found, "Color")
    to = _each(reader, "MULTIPLY_ADD", color, (2.0,) * 3, (-1.0,) * 3)
    if found.node.space == "BLENDER_WORLD":
        to = (to[0], *_each(reader, "MULTIPLY", to[1:], (-1.0,) * 2, (0.0,) * 2))
    own = reader.program.emit("GEOMETRY", what="NORMAL")
    mixed = _each(reader, "MIX", own, to, (strength,) * 3)
    return Value("NORMAL", reader.program.emit("FRAME", vector=mixed, to="SHADING"))


def _check_normal_image(reader, image):
    if image and not image.colorspace_settings.is_data:
        reader.warn(f"normal map '{image.name}' has colour space "
                    f"'{image.colorspace_settings.name}': set it to Non-Color")
    if image and not image.is_float:
        reader.warn(f"normal map '{image.name}' has 8 bits: its steps show in sharp "
                    "highlights; use 16 bits or float")


def _bump(reader, found):
    """The height is read at the point, a step along u and one along v."""
    node, groups = found.node, found.groups
    own = normal_of(reader, node.inputs["Normal"], groups)
    height = node.inputs["Height"]
    if reader.in_height:
        reader.warn(f"'{node.name}' bends a normal that a height depends on; left out")
    if reader.in_height or tree.trace(height, groups).node is None:
        return Value("NORMAL", own) if own else None
    width = node.inputs.get("Filter Width")
    if width and (width.is_linked or abs(width.default_value - 0.1) > 1e-6):
        reader.warn(f"'{node.name}': Filter Width is not supported; heights are a quarter of a texel apart")
    step = 0.25 / max(1.0, _fineness(height, groups, set()) or 250.0)
    heights, reader.in_height = [], True
    for shift in (None, (0, step), (1, step)):
        reader.shift = shift
        heights.append(number_of(reader, height, groups))
    reader.shift, reader.in_height = None, False
    distance = _number(reader, found, "Distance")
    if node.invert:
        distance = reader.program.math("MULTIPLY", distance, -1.0)
    return Value("NORMAL", reader.program.emit(
        "BUMP", height=heights, step=step, strength=[_number(reader, found, "Strength")],
        distance=[distance], normal=own or (0.0, 0.0, 1.0)))


def _fineness(socket, groups, seen):
    """Texels of the finest image that feeds a socket, along the UV map; 0 where there is none."""
    found = tree.trace(socket, groups)
    node = found.node
    if node is None or (node, found.groups) in seen:
        return 0.0
    seen.add((node, found.groups))
    if node.type == "TEX_IMAGE":
        size = max(node.image.size) if node.image else 0
        return size * _repeats(node.inputs["Vector"], found.groups)
    return max((_fineness(s, found.groups, seen) for s in node.inputs if s.is_linked), default=0.0)


def _repeats(socket, groups):
    """How often the nearest Mapping node, if there is one, repeats what is looked up."""
    found = tree.trace(socket, groups)
    if found.node is None or found.node.type != "MAPPING" or found.node.inputs["Scale"].is_linked:
        return 1.0
    scale = max(abs(s) for s in found.node.inputs["Scale"].default_value)
    return 1 / scale if found.node.vector_type == "TEXTURE" and scale else scale


# ---- coordinates


def _uv(reader):
    parts = reader.program.emit("GEOMETRY", what="UV")
    if reader.shift:
        axis, step = reader.shift
        parts[axis] = reader.program.math("ADD", parts[axis], step)
    return parts


def _position(reader):
    parts = reader.program.emit("GEOMETRY", what="POSITION")
    if reader.shift:
        axis, step = reader.shift
        along = reader.program.emit("GEOMETRY", what=("ALONG_U", "ALONG_V")[axis])
        parts = _each(reader, "MULTIPLY_ADD", along, (step,) * 3, parts)
    return parts


def _uv_map(reader, found):
    reader.use_uv_map(found.node.uv_map)
    return _uv(reader)


def _tex_coord(reader, found):
    name, node = found.output.name, found.node
    if name == "Reflection":
        return reader.program.emit("GEOMETRY", what="REFLECTION")
    if name == "Object" and node.object:
        inverse = node.object.matrix_world.inverted_safe()
        return _transform(reader, _position(reader), inverse)
    if name == "Normal":
        reader.warn(f"'{node.name}' (Normal) is that of world space, not of the object's")
        return reader.program.emit("GEOMETRY", what="NORMAL")
    if name != "UV":
        reader.warn(f"coordinates from '{node.name}' ({name}) are not supported; the UV map is "
                    "used as it is")
    reader.uses_uv = True
    return _uv(reader)


_GEOMETRY = {"Position": "POSITION", "Normal": "NORMAL", "Tangent": "TANGENT",
             "True Normal": "TRUE_NORMAL", "Incoming": "INCOMING", "Backfacing": "BACKFACING"}


def _geometry(reader, found):
    what = _GEOMETRY.get(found.output.name)
    if not what:
        reader.warn(f"'{found.node.name}' ({found.output.name}) is not supported; the socket's own "
                    "value is used")
        return None
    parts = _position(reader) if what == "POSITION" else reader.program.emit("GEOMETRY", what=what)
    return parts[:1] if what == "BACKFACING" else parts


def _transform(reader, vector, matrix, unit=False):
    rows = [float(value) for row in matrix.to_4x4()[:3] for value in row]
    return reader.program.emit("TRANSFORM", vector=tuple(vector), matrix=rows, unit=unit)


def _mapping(reader, found):
    kind = found.node.vector_type
    vector = _coordinates(reader, found.node.inputs["Vector"], found.groups)
    if vector is None:
        linked = found.node.inputs["Vector"].is_linked
        vector = (_uv(reader) if linked
                  else _own_value(found.node.inputs["Vector"]).parts)
    place = (_input(reader, found, "Location") if kind in ("POINT", "TEXTURE") else (0.0,) * 3)
    scale, turn = _input(reader, found, "Scale"), _input(reader, found, "Rotation")
    if not is_known(*turn):
        reader.warn(f"'{found.node.name}': a rotation that varies is not supported; its socket's "
                    "own value is used")
        turn = tuple(found.node.inputs["Rotation"].default_value)
    rotation = _euler(turn)
    if kind == "TEXTURE":
        moved = _each(reader, "SUBTRACT", vector, place)
        return _each(reader, "DIVIDE", _transform(reader, moved, rotation.transposed()), scale)
    if is_known(*scale, *place):
        factors = [(1 / s if s else 0.0) if kind == "NORMAL" else s for s in scale]
        matrix = rotation.to_4x4() @ Matrix.Diagonal((*factors, 1.0))
        matrix.translation = place
        return _transform(reader, vector, matrix, unit=kind == "NORMAL")
    sized = _each(reader, "DIVIDE" if kind == "NORMAL" else "MULTIPLY", vector, scale)
    turned = _transform(reader, sized, rotation, unit=kind == "NORMAL")
    return _each(reader, "ADD", turned, place)


def _euler(turn):
    x, y, z = (Matrix.Rotation(angle, 3, axis) for angle, axis in zip(turn, "XYZ"))
    return z @ y @ x


# ---- numbers and colours


def _math(reader, found):
    node = found.node
    if node.operation not in MATH:
        reader.warn(f"'{node.name}': {node.operation.lower()} is not supported; its first input is "
                    "used")
        return (_number(reader, found, 0),)
    parts = [_number(reader, found, k) for k in range(len(node.inputs))]
    part = reader.program.math(node.operation, *parts)
    return (_clamped(reader, part) if node.use_clamp else part,)


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
    a, b, c = (_input(reader, found, k) for k in range(3))
    if node.operation in _EACH:
        return _each(reader, _EACH[node.operation], a, b, c)
    if node.operation == "SCALE":
        return _each(reader, "MULTIPLY", a, (_number(reader, found, "Scale"),) * 3)
    if node.operation == "DOT_PRODUCT":
        return (_dot(reader, a, b),)
    if node.operation == "CROSS_PRODUCT":
        return tuple(program.math("SUBTRACT", program.math("MULTIPLY", a[i], b[j]),
                                  program.math("MULTIPLY", a[j], b[i]))
                     for i, j in ((1, 2), (2, 0), (0, 1)))
    if node.operation in ("LENGTH", "DISTANCE"):
        d = _each(reader, "SUBTRACT", a, b) if node.operation == "DISTANCE" else a
        return (program.math("SQRT", _dot(reader, d, d)),)
    if node.operation == "NORMALIZE":
        return _each(reader, "DIVIDE", a, (program.math("SQRT", _dot(reader, a, a)),) * 3)
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
        return _each(reader, "MIX", a, b, (factor,) * 3)
    return tuple(reader.program.emit("MIX", 1, mode=mode, factor=[factor], a=[one], b=[other])[0]
                 for one, other in zip(a, b))


def _mix_rgb(reader, found):
    mixed = _blend(reader, found.node, _clamped(reader, _number(reader, found, "Fac")),
                   _input(reader, found, "Color1"), _input(reader, found, "Color2"))
    return tuple(_clamped(reader, part) for part in mixed) if found.node.use_clamp else mixed


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
        factor = tuple(_clamped(reader, part) for part in factor)
    if word == "Float":
        a, b = (number_of(reader, by[f"{letter}_Float"], found.groups) for letter in "AB")
        return (reader.program.math("MIX", a, b, factor[0]),)
    a, b = (color_of(reader, by[f"{letter}_{word}"], found.groups) for letter in "AB")
    if word == "Vector":
        return _each(reader, "MIX", a, b, factor)
    mixed = _blend(reader, node, factor[0], a, b)
    return tuple(_clamped(reader, part) for part in mixed) if node.clamp_result else mixed


def _ramp(reader, found):
    ramp, key = found.node.color_ramp, ("ramp", found.node, found.groups, reader.shift)
    if key not in reader.known:
        table = array("f", [part for k in range(256) for part in ramp.evaluate(k / 255)])
        reader.known[key] = reader.program.emit(
            "RAMP", 4, table=table, at=[_number(reader, found, "Fac")],
            smooth=ramp.color_mode != "RGB" or ramp.interpolation != "CONSTANT")
    *color, alpha = reader.known[key]
    return (alpha,) if found.output.name == "Alpha" else color


def _separate(reader, found):
    if getattr(found.node, "mode", "RGB") != "RGB":
        reader.warn(f"'{found.node.name}': {found.node.mode} is not supported; taken as RGB")
    return (_input(reader, found, 0)[list(found.node.outputs).index(found.output)],)


def _combine(reader, found):
    if getattr(found.node, "mode", "RGB") != "RGB":
        reader.warn(f"'{found.node.name}': {found.node.mode} is not supported; taken as RGB")
    return tuple(_number(reader, found, k) for k in range(3))


def _clamp(reader, found):
    value, low, high = (_number(reader, found, name) for name in ("Value", "Min", "Max"))
    if found.node.clamp_type == "RANGE":
        low, high = (reader.program.math(pick, low, high) for pick in ("MINIMUM", "MAXIMUM"))
    return (reader.program.math("CLAMP", value, low, high),)


def _invert(reader, found):
    color, factor = _input(reader, found, "Color"), _number(reader, found, "Fac")
    return _each(reader, "MIX", color, _each(reader, "SUBTRACT", (1.0,) * 3, color), (factor,) * 3)


def _gamma(reader, found):
    """What is not above 0 stays as it is."""
    color, gamma = _input(reader, found, "Color"), _number(reader, found, "Gamma")
    positive = _each(reader, "GREATER_THAN", color)
    return _each(reader, "MIX", color, _each(reader, "POWER", color, (gamma,) * 3), positive)


def _bright_contrast(reader, found):
    contrast = _number(reader, found, "Contrast")
    offset = reader.program.math("MULTIPLY_ADD", contrast, -0.5, _number(reader, found, "Bright"))
    slope = reader.program.math("ADD", contrast, 1.0)
    scaled = _each(reader, "MULTIPLY_ADD", _input(reader, found, "Color"), (slope,) * 3,
                   (offset,) * 3)
    return _each(reader, "MAXIMUM", scaled)


def _to_bw(reader, found):
    return (_dot(reader, _input(reader, found, "Color"), _LUMINANCE),)


def _map_range(reader, found):
    node, program = found.node, reader.program
    if node.data_type != "FLOAT" or node.interpolation_type != "LINEAR":
        reader.warn(f"'{node.name}': only linear ranges of floats are supported")
    names = ("Value", "From Min", "From Max", "To Min", "To Max")
    value, low, high, to_low, to_high = (_number(reader, found, name) for name in names)
    part = program.math("DIVIDE", program.math("SUBTRACT", value, low),
                        program.math("SUBTRACT", high, low))
    if node.clamp:
        part = _clamped(reader, part)
    return (program.math("MIX", to_low, to_high, part),)


# By the node's type: each is tested by test_blender_semantics.
NODES = {
    "RGB": _rgb, "VALUE": _value_node, "TEX_IMAGE": _tex_image, "NORMAL_MAP": _normal_map,
    "BUMP": _bump,
    "UVMAP": _uv_map, "TEX_COORD": _tex_coord, "NEW_GEOMETRY": _geometry, "MAPPING": _mapping,
    "MATH": _math, "VECT_MATH": _vector_math, "MIX_RGB": _mix_rgb, "MIX": _mix, "VALTORGB": _ramp,
    "SEPRGB": _separate, "SEPXYZ": _separate, "SEPARATE_COLOR": _separate,
    "COMBRGB": _combine, "COMBXYZ": _combine, "COMBINE_COLOR": _combine,
    "CLAMP": _clamp, "INVERT": _invert, "GAMMA": _gamma, "BRIGHTCONTRAST": _bright_contrast,
    "RGBTOBW": _to_bw, "MAP_RANGE": _map_range,
}
