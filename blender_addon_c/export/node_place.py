# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a point is: coordinates, what the surface is there, and the object that it belongs to."""

from mathutils import Matrix

from .. import versions
from . import tree
from .attributes import ABSENT, NOTHING
from .graph import is_known
from .value import Value, dot, each, number_in, of_group, surface_normal, three, unit, value_of, vector_in


# ---- the UV map and other layers of the mesh


def uv(reader, name=""):
    """Of the map of that name; "" is the active one."""
    if not reader.is_main(name):
        return layer(reader, "UV", name)[:3]
    return reader.program.emit("GEOMETRY", what="UV", **({"shift": reader.shift} if reader.shift else {}))


def layer(reader, kind, name=""):
    """Four parts of a layer (layers.py)."""
    key = ("layer", kind, name, reader.shift)
    if key not in reader.known:
        shift = {"shift": reader.shift} if reader.shift and kind != "TANGENT" else {}
        reader.known[key] = reader.program.emit("LAYER", 3, "more", layer=reader.layer(kind, name), **shift)
    return reader.known[key]


def place(reader, socket, groups):
    """Where an image is looked up; None: at the place of the UV map that is the mesh's own."""
    found = tree.trace(socket, groups)
    name = ""
    own = not getattr(found.node, "from_instancer", False)
    if own and found.node and found.node.type == "UVMAP":
        name = found.node.uv_map
    elif of_group(found) or found.node and not (own and found.node.type == "TEX_COORD" and found.output.name == "UV"):
        value = value_of(reader, socket, groups, own=Value("VECTOR", None))
        if value.parts is not None:
            return three(reader, value)
    return None if reader.is_main(name) and not reader.shift else uv(reader, name)


def _uv_map(reader, found):
    if found.node.from_instancer:
        return reader.attribute("INSTANCE", "UV")[:3]
    return uv(reader, found.node.uv_map)


# Names that are Cycles' own, whatever a mesh has by them: most are of volumes and strands [measured: 3.4 and 5.0].
_TAKEN = {
    **dict.fromkeys(("color", "density", "flame", "heat", "temperature", "velocity", "undeformed", "undisplaced", "particle",
                     "ptex_uv", "point_random", "shadow_transparency")),
    "uv": lambda reader: uv(reader),
    "generated": lambda reader: layer(reader, "GENERATED")[:3],
    "pointiness": lambda reader: layer(reader, "POINTINESS")[:1] * 3,
    "random_per_island": lambda reader: layer(reader, "ISLAND")[:1] * 3,
}


def _of_surface(reader, kind, name):
    """Of points of a cloud each instance, which is a ball, has its own."""
    return reader.attribute("POINT", name) if reader.of_points else layer(reader, kind, name)


def _attribute(reader, found):
    """Of a colour, Fac is its mean, of a pair its first number."""
    node = found.node
    if node.type == "ATTRIBUTE" and node.attribute_type != "GEOMETRY":
        *color, alpha = reader.attribute(node.attribute_type, node.attribute_name)
    elif node.type == "VERTEX_COLOR":
        *color, alpha = NOTHING if node.layer_name in _TAKEN else _of_surface(reader, "COLOR", node.layer_name)
    elif found.output.identifier == "Fac" and node.attribute_name not in _TAKEN and not reader.of_points:
        return layer(reader, "FACTOR", node.attribute_name)[:1]
    elif node.attribute_name in _TAKEN:
        told = _TAKEN[node.attribute_name]
        *color, alpha = (*told(reader), 1.0) if told else ABSENT
    else:
        *color, alpha = _of_surface(reader, "ATTRIBUTE", node.attribute_name)
    if found.output.name == "Alpha":
        return (alpha,)
    return (dot(reader, color, (1 / 3,) * 3),) if found.output.identifier == "Fac" else color


# ---- the point


def position(reader):
    parts = reader.program.emit("GEOMETRY", what="POSITION")
    for what, step in zip(("ALONG_U", "ALONG_V"), reader.shift or ()):
        if is_known(step) and step == 0:
            continue
        if what not in reader.known:
            reader.known[what] = reader.program.emit("GEOMETRY", what=what)
        parts = each(reader, "MULTIPLY_ADD", reader.known[what], (step,) * 3, parts)
    return parts


def of_object(reader, what, vector=None):
    """Of the object that is hit; a vector into its space or out of it."""
    reader.asks_objects()
    return reader.program.emit("OBJECT", what=what, **({"vector": tuple(vector)} if vector else {}))


def _tex_coord(reader, found):
    name, node = found.output.name, found.node
    if node.from_instancer and name in ("Generated", "UV"):
        return reader.attribute("INSTANCE", name)[:3]
    if name == "Object":
        if not node.object:
            return of_object(reader, "POINT_INTO", position(reader))
        return transform(reader, position(reader), node.object.matrix_world.inverted_safe())
    return _COORDINATES[name](reader)


def _camera(reader):
    return transform(reader, position(reader), reader.camera()[0])


def _window(reader):
    """Of the picture's frame, 0 to 1."""
    to_camera, (x0, x1, y0, y1), perspective = reader.camera()
    *at, far = transform(reader, position(reader), to_camera)
    divide = reader.program.math
    if perspective:
        at = [divide("DIVIDE", part, far) for part in at]
    return (*(divide("MULTIPLY", divide("SUBTRACT", part, low), 1.0 / (high - low))
              for part, low, high in zip(at, (x0, y0), (x1, y1))), 0.0)


def _camera_data(reader, found):
    """Of the point itself, in heights too."""
    shift, reader.shift = reader.shift, None
    at = _camera(reader)
    reader.shift = shift
    if found.output.name == "View Z Depth":
        return at[2:]
    far = reader.program.math("SQRT", dot(reader, at, at))
    return (far,) if found.output.name == "View Distance" else each(reader, "DIVIDE", at, (far,) * 3)


_COORDINATES = {
    "Generated": lambda reader: layer(reader, "GENERATED")[:3],
    "Normal": lambda reader: of_object(reader, "NORMAL_INTO", surface_normal(reader)),
    "UV": uv,
    "Camera": _camera,
    "Window": _window,
    "Reflection": lambda reader: reader.program.emit("GEOMETRY", what="REFLECTION"),
}

_GEOMETRY = {"Position": "POSITION", "Normal": "NORMAL", "True Normal": "TRUE_NORMAL",
             "Incoming": "INCOMING", "Backfacing": "BACKFACING"}
_OF_MESH = {"Pointiness": "POINTINESS", "Random Per Island": "ISLAND", "Parametric": "PARAMETRIC"}


def _geometry(reader, found):
    name = found.output.name
    if name == "Tangent":
        return usual_tangent(reader)
    if name in _OF_MESH:
        told = layer(reader, _OF_MESH[name])
        return (*told[:2], 0.0) if name == "Parametric" else told[:1]
    what = _GEOMETRY[name]
    if what in ("POSITION", "NORMAL"):
        return position(reader) if what == "POSITION" else surface_normal(reader)
    parts = reader.program.emit("GEOMETRY", what=what)
    return parts[:1] if what == "BACKFACING" else parts


# ---- tangents, in world space


def round_tangent(reader, axis):
    """Along circles about an axis through the middle of the object's texture space."""
    key = ("round", axis)
    if key not in reader.known:
        shift, reader.shift = reader.shift, None
        x, y, z = each(reader, "SUBTRACT", layer(reader, "GENERATED")[:3], (0.5,) * 3)
        back = reader.program.math
        about = {"X": (0.0, back("MULTIPLY", z, -1.0), y), "Y": (back("MULTIPLY", z, -1.0), 0.0, x),
                 "Z": (back("MULTIPLY", y, -1.0), x, 0.0)}[axis]
        reader.known[key] = _along_surface(reader, of_object(reader, "NORMAL_OUT_OF", about))
        reader.shift = shift
    return reader.known[key]


def usual_tangent(reader):
    """Where nothing says another: round the object's z axis, on hair along it."""
    if not reader.of_strands:
        return round_tangent(reader, "Z")
    return _along_surface(reader, of_object(reader, "VECTOR_OUT_OF", layer(reader, "STRAND", "tangent")[:3]))


def _along_surface(reader, vector):
    """Its part along the surface, of length 1."""
    normal = reader.program.emit("GEOMETRY", what="NORMAL")
    down = reader.program.math("MULTIPLY", dot(reader, vector, normal), -1.0)
    along = each(reader, "MULTIPLY_ADD", normal, (down,) * 3, vector)
    return unit(reader, along)


def tangent_of(reader, node):
    """What a Tangent node says; None where it is the mesh's own. Without a UV map those of Cycles run round the object."""
    if node.direction_type == "RADIAL":
        return round_tangent(reader, node.axis)
    return round_tangent(reader, "Z") if reader.mapless and not node.uv_map else tangent_of_map(reader, node.uv_map)


def tangent_of_map(reader, name):
    """Along u of a UV map ("": the active one); None where it is the mesh's own."""
    if reader.is_main(name):
        return None
    return _along_surface(reader, layer(reader, "TANGENT", name)[:3])


def along_axis(reader, vector):
    """Along the surface, as near as that is to a direction of the object's."""
    return _along_surface(reader, of_object(reader, "VECTOR_OUT_OF", vector))


def _tangent(reader, found):
    told = tangent_of(reader, found.node)
    reader.by_mesh = reader.by_mesh or not told
    return told or reader.program.emit("GEOMETRY", what="TANGENT")


_WAYS = {
    "Is Camera Ray": "CAMERA", "Is Shadow Ray": "SHADOW", "Is Diffuse Ray": "DIFFUSE", "Is Glossy Ray": "GLOSSY",
    "Is Singular Ray": "SINGULAR", "Is Reflection Ray": "REFLECTION", "Is Transmission Ray": "TRANSMISSION",
    "Ray Length": "LENGTH", "Ray Depth": "DEPTH", "Diffuse Depth": "DIFFUSE_DEPTH",
    "Glossy Depth": "GLOSSY_DEPTH", "Transparent Depth": "TRANSPARENT_DEPTH",
    "Transmission Depth": "TRANSMISSION_DEPTH",
}


def _light_path(reader, found):
    """There are no volumes and no portals."""
    what = _WAYS.get(found.output.name)
    return reader.program.emit("PATH", 1, what=what) if what else (0.0,)


def _light_falloff(reader, found):
    """A strength that does not fall off as light does, by the way of the ray."""
    math, name = reader.program.math, found.output.name
    strength, smooth = (number_in(reader, found, socket) for socket in ("Strength", "Smooth"))
    if name == "Quadratic" and is_known(smooth) and smooth <= 0:
        return (strength,)
    far = reader.program.emit("PATH", 1, what="LENGTH")[0]
    square = math("MULTIPLY", far, far)
    if name != "Quadratic":
        strength = math("MULTIPLY", strength, far if name == "Linear" else square)
    if is_known(smooth) and smooth <= 0:
        return (strength,)
    part = math("DIVIDE", square, math("ADD", math("MAXIMUM", smooth, 0.0), square))
    return (math("MULTIPLY", strength, part),)


# ---- the object


def _object_info(reader, found):
    name = found.output.name
    if name == "Material Index":
        return (float(reader.pass_index),)
    if name in ("Location", "Color"):
        return of_object(reader, name.upper())
    key = ("object numbers",)
    if key not in reader.known:
        reader.known[key] = of_object(reader, "NUMBERS")
    return (reader.known[key][("Alpha", "Object Index", "Random").index(name)],)


# ---- transformations


def transform(reader, vector, matrix, unit=False):
    rows = [float(value) for row in matrix.to_4x4()[:3] for value in row]
    return reader.program.emit("TRANSFORM", vector=tuple(vector), matrix=rows, unit=unit)


def _mapping(reader, found):
    kind = found.node.vector_type
    vector = vector_in(reader, found, "Vector")
    place = (vector_in(reader, found, "Location") if kind in ("POINT", "TEXTURE") else (0.0,) * 3)
    scale, turn = vector_in(reader, found, "Scale"), vector_in(reader, found, "Rotation")
    if kind == "TEXTURE":
        moved = each(reader, "SUBTRACT", vector, place)
        return each(reader, "DIVIDE", _turned(reader, moved, turn, back=True), scale)
    if is_known(*scale, *place, *turn):
        factors = [(1 / s if s else 0.0) if kind == "NORMAL" else s for s in scale]
        matrix = _euler(turn).to_4x4() @ Matrix.Diagonal((*factors, 1.0))
        matrix.translation = place
        return transform(reader, vector, matrix, unit=kind == "NORMAL")
    sized = each(reader, "DIVIDE" if kind == "NORMAL" else "MULTIPLY", vector, scale)
    turned = _turned(reader, sized, turn)
    return each(reader, "ADD", unit(reader, turned) if kind == "NORMAL" else turned, place)


def _turned(reader, vector, turn, back=False):
    """About x, y and z one after the other, or all of it back."""
    if is_known(*turn):
        rotation = _euler(turn)
        return transform(reader, vector, rotation.transposed() if back else rotation)
    math, made = reader.program.math, list(vector)
    for axis in (2, 1, 0) if back else (0, 1, 2):
        c = math("COSINE", turn[axis])
        s = math("MULTIPLY", math("SINE", turn[axis]), -1.0 if back else 1.0)
        one, two = (axis + 1) % 3, (axis + 2) % 3
        x, y = made[one], made[two]
        made[one] = math("SUBTRACT", math("MULTIPLY", x, c), math("MULTIPLY", y, s))
        made[two] = math("MULTIPLY_ADD", x, s, math("MULTIPLY", y, c))
    return made


def _vector_rotate(reader, found):
    node, math = found.node, reader.program.math
    vector, center = (vector_in(reader, found, name) for name in ("Vector", "Center"))
    moved = each(reader, "SUBTRACT", vector, center)
    if node.rotation_type == "EULER_XYZ":
        turned = _turned(reader, moved, vector_in(reader, found, "Rotation"), back=node.invert)
        return each(reader, "ADD", turned, center)
    angle = math("MULTIPLY", number_in(reader, found, "Angle"), -1.0 if node.invert else 1.0)
    if node.rotation_type != "AXIS_ANGLE":
        turn = [angle if node.rotation_type[0] == axis else 0.0 for axis in "XYZ"]
        return each(reader, "ADD", _turned(reader, moved, turn), center)
    axis = vector_in(reader, found, "Axis")
    turned = each(reader, "ADD", _turned_about(reader, moved, unit(reader, axis), angle), center)
    there = math("GREATER_THAN", dot(reader, axis, axis), 0.0)  # without an axis it stays
    return each(reader, "MIX", vector, turned, (there,) * 3)


def _turned_about(reader, v, axis, angle):
    """v cos + (axis x v) sin + axis (axis v) (1 - cos)."""
    math = reader.program.math
    c, s = math("COSINE", angle), math("SINE", angle)
    down = math("MULTIPLY", dot(reader, axis, v), math("SUBTRACT", 1.0, c))
    made = []
    for k in range(3):
        one, two = (k + 1) % 3, (k + 2) % 3
        across = math("SUBTRACT", math("MULTIPLY", axis[one], v[two]), math("MULTIPLY", axis[two], v[one]))
        made.append(math("ADD", math("MULTIPLY_ADD", across, s, math("MULTIPLY", v[k], c)),
                         math("MULTIPLY", axis[k], down)))
    return made



def _vector_transform(reader, found):
    node, vector = found.node, vector_in(reader, found, "Vector")
    kind = node.vector_type
    across = kind == "NORMAL" and versions.NORMALS_STAY_ACROSS
    word = "NORMAL" if across else "POINT" if kind == "POINT" else "VECTOR"
    if node.convert_from != node.convert_to:
        if node.convert_from == "OBJECT":
            vector = of_object(reader, f"{word}_OUT_OF", vector)
        elif node.convert_from == "CAMERA":
            vector = _by_camera(reader, kind, vector, back=True)
        if node.convert_to == "OBJECT":
            vector = of_object(reader, f"{word}_INTO", vector)
        elif node.convert_to == "CAMERA":
            vector = _by_camera(reader, kind, vector)
    elif across:
        return vector
    return unit(reader, vector) if kind == "NORMAL" else vector


def _by_camera(reader, kind, vector, back=False):
    matrix = reader.camera()[0]
    matrix = matrix.inverted_safe() if back else matrix
    return transform(reader, vector, matrix if kind == "POINT" else matrix.to_3x3())


def _euler(turn):
    x, y, z = (Matrix.Rotation(angle, 3, axis) for angle, axis in zip(turn, "XYZ"))
    return z @ y @ x


NODES = {
    "UVMAP": _uv_map, "TEX_COORD": _tex_coord, "NEW_GEOMETRY": _geometry, "MAPPING": _mapping,
    "TANGENT": _tangent, "ATTRIBUTE": _attribute, "VERTEX_COLOR": _attribute, "OBJECT_INFO": _object_info,
    "CAMERA": _camera_data, "LIGHT_PATH": _light_path, "LIGHT_FALLOFF": _light_falloff,
    "VECTOR_ROTATE": _vector_rotate, "VECT_TRANSFORM": _vector_transform,
}
