# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that bend normals."""

import math

from .. import versions
from . import tree
from .graph import is_known
from .node_image import image_of, is_cubic, is_plain
from .node_place import layer, of_object, place, round_tangent
from .value import Value, each, dot, framed, normal_of, number_in, number_of, surface_normal, three, unit, value_of, vector_in

def _normal_map(reader, found):
    strength = number_in(reader, found, "Strength")
    if not versions.NORMAL_MAPS_MIX or found.node.space != "TANGENT" or (is_known(strength) and strength == 1.0):
        return _normal_map_of(reader, found, strength)
    whole = _normal_map_of(reader, found, 1.0, strength)
    if whole is None:
        return None
    times = reader.program.math("MAXIMUM", strength, 0.0)
    rest = reader.program.math("SUBTRACT", 1.0, times)
    x, y, z = each(reader, "MULTIPLY_ADD", whole.parts, (times,) * 3, (0.0, 0.0, rest))
    return Value("NORMAL", unit(reader, (x, y, reader.program.math("MAXIMUM", z, 1e-4))))


def _normal_map_of(reader, found, strength, mixed=1.0):
    """mixed: how much of it counts, by what comes after."""
    node = found.node
    if node.space != "TANGENT":
        return _normal_of_space(reader, found, strength)
    mapless, down = reader.mapless and not node.uv_map, _points_down(node)
    own = not mapless and reader.is_main(node.uv_map)
    color = tree.trace(node.inputs["Color"], found.groups)
    if color.node and color.node.type == "TEX_IMAGE" and color.output.name == "Color":
        _check_normal_image(reader, color.node.image)
        image = image_of(reader, color.node)
        if image == -1:
            return None
        if image >= 0 and is_known(strength) and is_known(mixed):
            _check_steepness(reader, color.node.image, image, strength * mixed)
        at = place(reader, color.node.inputs["Vector"], color.groups)
        if (own and at is None and image >= 0 and is_known(strength) and not is_cubic(color.node) and is_plain(color.node)
                and not reader.images.points_down(image)):
            normal = _across(reader, reader.program.emit("NORMAL_MAP", image=image, strength=strength), down)
            if reader.filters:
                *mean, x, y = reader.program.emit("NORMAL_MAP", 5, image=image, strength=strength, filtered=True)
                reader.filtered[normal[0]] = _across(reader, mean, down), (x, y)
            return Value("NORMAL", normal)
    elif color.node is None:
        reader.warn(f"'{node.name}' has no image")
    tangent = {} if own else {"tangent": (*round_tangent(reader, "Z"), 1.0) if mapless else layer(reader, "TANGENT", node.uv_map)}
    given = {"color": _color_of(reader, found), "strength": [strength], **tangent}
    normal = reader.program.emit("PERTURB", **given)
    reader.below[normal[0]] = reader.program.emit("PERTURB", below=True, **given)
    image = color.node.image if color.node and color.node.type == "TEX_IMAGE" else None
    if image and not image.is_float and is_known(strength):
        reader.coarse[normal[0]] = image.name, strength
    return Value("NORMAL", normal)


def _points_down(node):
    """Is a map's green down, not up? Can be chosen from 5.1 on."""
    return getattr(node, "convention", "OPENGL") == "DIRECTX"


def _color_of(reader, found):
    """Whose green is up."""
    x, y, z = vector_in(reader, found, "Color")
    return (x, reader.program.math("SUBTRACT", 1.0, y), z) if _points_down(found.node) else (x, y, z)


def _across(reader, normal, turned):
    """A normal in the shading frame, whose y may be turned round."""
    return [normal[0], reader.program.math("MULTIPLY", normal[1], -1.0), normal[2]] if turned else normal


def _normal_of_space(reader, found, strength):
    """Of the world's space or the object's; on the back it is turned round."""
    color, space = _color_of(reader, found), found.node.space
    to = each(reader, "MULTIPLY_ADD", color, (2.0,) * 3, (-1.0,) * 3)
    if space.startswith("BLENDER"):
        to = (to[0], *each(reader, "MULTIPLY", to[1:], (-1.0,) * 2, (0.0,) * 2))
    if space.endswith("OBJECT"):
        to = of_object(reader, "NORMAL_OUT_OF", to)
    else:
        to = unit(reader, to)
    back = reader.program.emit("GEOMETRY", what="BACKFACING")[0]
    side = reader.program.math("MULTIPLY_ADD", back, -2.0, 1.0)
    own = surface_normal(reader)
    mixed = each(reader, "MIX", own, each(reader, "MULTIPLY", to, (side,) * 3), (strength,) * 3)
    return Value("NORMAL", framed(reader, mixed))


def _check_normal_image(reader, image):
    if image and not image.colorspace_settings.is_data:
        reader.warn(f"normal map '{image.name}' has colour space "
                    f"'{image.colorspace_settings.name}': set it to Non-Color")


def _check_steepness(reader, image, index, strength):
    """Seen on a ball and a box, matt and metal: .04 off from Cycles at 60 degrees, .04 to .13 at 80; .005 at 30."""
    part = reader.images.turned(index, _STEEP, max(strength, 0.0))
    if part > 0.02:
        reader.warn(f"normal map '{image.name}' turns normals by more than 50 degrees in {max(1, round(100 * part))} % of it: "
                    "there lights may look otherwise than in Cycles")


_STEEP = math.tan(math.radians(50.0))


def _bump(reader, found):
    """The height is read at the point and two steps of a part of a pixel's width from there; where that is
    not known, of a quarter of a texel."""
    node, groups = found.node, found.groups
    own = normal_of(reader, node.inputs["Normal"], groups)
    height = node.inputs["Height"]
    if reader.in_height:
        reader.warn(f"'{node.name}' bends a normal that a height depends on; left out")
    if reader.in_height or tree.trace(height, groups).node is None:
        return Value("NORMAL", own) if own else None
    width = _filter_width(reader, node)
    if not width > 0:
        return Value("NORMAL", own) if own else None
    distance = number_in(reader, found, "Distance")
    if node.invert:
        distance = reader.program.math("MULTIPLY", distance, -1.0)
    return _bumped(reader, width, _fineness(height, groups, set()), lambda: number_of(reader, height, groups),
                   strength=[number_in(reader, found, "Strength")], distance=[distance], own=own)


_UP = (0.0, 0.0, 1.0)


def _bumped(reader, width, fineness, height, own=None, **given):
    """height: reads it, wherever coordinates are shifted to. own: the normal that is bent, None for the surface's."""
    step = 0.25 / max(1.0, fineness or 250.0)
    key = ("steps", width, step)
    if key not in reader.known:
        reader.known[key] = [tuple(reader.program.emit("STEP", 2, axis=axis, scale=min(width, 1e6), otherwise=step))
                             for axis in "XY"]
    heights, reader.in_height = [], True
    for shift in (None, *reader.known[key]):
        reader.shift = shift
        heights.append(height())
    reader.shift, reader.in_height = None, False
    given.update(height=heights, along=sum(reader.known[key], ()))
    normal = reader.program.emit("BUMP", normal=own or _UP, **given)
    if own and own[0] in reader.below:
        reader.below[normal[0]] = reader.program.emit("BUMP", normal=reader.below[own[0]], below=True, **given)
    return Value("NORMAL", normal)


def displaced(reader, socket):
    """Registers of the normal that a material's displacement makes, None without one. Cycles bumps by its
    part along the normal."""
    if tree.trace(socket).node is None:
        return None

    def height():
        parts = three(reader, value_of(reader, socket, ()))
        return dot(reader, parts, reader.program.emit("GEOMETRY", what="NORMAL"))

    width = 0.1 if versions.DISPLACED_CLOSELY else 1.0  # of a Bump node
    return _bumped(reader, width, _fineness(socket, (), set()), height, strength=[1.0], distance=[1.0]).parts


def _displacement(reader, found):
    """Along the normal, in the object's space before it is scaled."""
    node, math = found.node, reader.program.math
    socket = node.inputs["Normal"]
    normal = (value_of(reader, socket, found.groups) if tree.trace(socket, found.groups).node else
              Value("VECTOR", reader.program.emit("GEOMETRY", what="NORMAL")))
    far = math("MULTIPLY", math("SUBTRACT", number_in(reader, found, "Height"), number_in(reader, found, "Midlevel")),
               number_in(reader, found, "Scale"))
    if node.space != "OBJECT":
        return each(reader, "MULTIPLY", three(reader, normal), (far,) * 3)
    own = of_object(reader, "NORMAL_INTO", three(reader, normal))
    return of_object(reader, "VECTOR_OUT_OF", each(reader, "MULTIPLY", own, (far,) * 3))


def _vector_displacement(reader, found):
    node = found.node
    middle, scale = (number_in(reader, found, name) for name in ("Midlevel", "Scale"))
    vector = each(reader, "SUBTRACT", vector_in(reader, found, "Vector"), (middle,) * 3)
    vector = each(reader, "MULTIPLY", vector, (scale,) * 3)
    if node.space == "TANGENT":  # what moves along the surface bends no normal
        own = of_object(reader, "NORMAL_INTO", reader.program.emit("GEOMETRY", what="NORMAL"))
        vector = each(reader, "MULTIPLY", own, vector[1:2] * 3)
    return vector if node.space == "WORLD" else of_object(reader, "VECTOR_OUT_OF", vector)


def _filter_width(reader, node):
    """In pixels. Before it was a socket it was 1 (3.4); versions between were not measured."""
    socket = node.inputs.get("Filter Width")
    if socket and socket.is_linked:
        reader.warn(f"'{node.name}': what feeds Filter Width is left out, as in Cycles")
    return socket.default_value if socket else 1.0


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


NODES = {"NORMAL_MAP": _normal_map, "BUMP": _bump, "DISPLACEMENT": _displacement,
         "VECTOR_DISPLACEMENT": _vector_displacement}
