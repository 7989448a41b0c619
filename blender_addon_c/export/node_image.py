# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as nodes show them."""

import math
import os

from .. import versions
from . import ies
from .image import MISSING, MISSING_COLOR, tiles_of
from .node_place import of_object, place, position, uv
from .value import Value, dot, each, number_in, surface_normal, three, unit, value_of

_STEP = 1 / 256  # along u and v, by which coordinates say how they move

_WRAPS = {"REPEAT", "EXTEND", "CLIP", "MIRROR"}
_FILTERS = {"Linear": "LINEAR", "Closest": "CLOSEST", "Cubic": "LINEAR", "Smart": "LINEAR"}


def _tex_image(reader, found):
    node = found.node
    image = image_of(reader, node)
    if image == MISSING:
        return (1.0,) if found.output.name == "Alpha" else MISSING_COLOR
    if image < 0:
        return None
    key = ("image", node, found.groups, reader.shift)
    if key not in reader.known:  # both outputs are of one look
        reader.known[key] = _PROJECTIONS[node.projection](reader, node, found.groups, image)
    *color, alpha = reader.known[key]
    return (alpha,) if found.output.name == "Alpha" else color


def _tex_environment(reader, found):
    """Looked up by a direction, which is the place where nothing is linked."""
    node = found.node
    image = image_of(reader, node)
    if image == MISSING:
        return MISSING_COLOR
    if image < 0:
        return None
    value = value_of(reader, node.inputs["Vector"], found.groups, own=Value("VECTOR", None))
    to = three(reader, value) if value.parts is not None else tuple(position(reader))
    around = _on_ball if node.projection == "MIRROR_BALL" else on_map
    return _look(reader, node, image, lambda: around(reader, to), averaged=False)[:3]


def on_map(reader, to):
    """The place in an equirectangular picture that a direction points to."""
    math_ = reader.program.math
    up = math_("ARCSINE", math_("DIVIDE", to[2], math_("SQRT", dot(reader, to, to))))
    return (math_("MULTIPLY_ADD", math_("ARCTAN2", to[1], to[0]), -0.5 / math.pi, 0.5),
            math_("MULTIPLY_ADD", up, 1.0 / math.pi, 0.5))


def _on_ball(reader, to):
    """In a mirror ball that is seen along y."""
    math_ = reader.program.math
    x, y, z = unit(reader, to)
    half = math_("SQRT", math_("MULTIPLY", math_("MAXIMUM", math_("SUBTRACT", 1.0, y), 0.0), 0.5))
    return tuple(math_("MULTIPLY_ADD", math_("DIVIDE", part, half), 0.25, 0.5) for part in (x, z))


def _tex_ies(reader, found):
    """Looked up by a direction in the object's space: where nothing is linked, the normal or, later, where one looks from."""
    node, math_ = found.node, reader.program.math
    image = _profile_of(reader, node)
    strength = number_in(reader, found, "Strength")
    if image < 0:
        return (math_("MULTIPLY", strength, ies.MISSING),)
    value = value_of(reader, node.inputs["Vector"], found.groups, own=Value("VECTOR", None))
    if value.parts is not None:
        to = three(reader, value)
    elif versions.OLD_IES:
        to = of_object(reader, "NORMAL_INTO", surface_normal(reader))
    else:
        to = of_object(reader, "NORMAL_INTO", reader.program.emit("GEOMETRY", what="INCOMING"))  # as if it were one
    x, y, z = unit(reader, to)
    columns = ies.COLUMNS + 2  # one more on either side
    at = (math_("MULTIPLY_ADD", math_("ARCTAN2", x, y), 0.5 / math.pi * ies.COLUMNS / columns, 0.5),
          math_("MULTIPLY", math_("ARCCOSINE", math_("MULTIPLY", z, -1.0)), 1 / math.pi))
    seen = reader.program.emit("IMAGE", 3, "alpha", image=image, cubic=False, at=at)
    return (math_("MULTIPLY", seen[0], strength),)


def _profile_of(reader, node):
    """Index of the picture of a photometric file, MISSING where there is none (with a message)."""
    try:
        text = ies.text_of(node)
        key = ("profile", text)
        if key not in reader.known:
            reader.known[key] = reader.images.made(ies.picture(text))
        return reader.known[key]
    except (OSError, ValueError) as error:
        name = node.ies.name if node.mode == "INTERNAL" and node.ies else os.path.basename(node.filepath)
        reader.warn(f"'{node.name}': " + (f"'{name}': " if name and isinstance(error, ValueError) else "") +
                    f"{error}; {ies.MISSING:g} for all directions")
        return MISSING


# ---- by projection: red, green, blue, alpha


def _flat(reader, node, groups, image):
    if node.image.source != "TILED":
        return _look(reader, node, image, lambda: place(reader, node.inputs["Vector"], groups))
    scale = [1.0 / count for count in tiles_of(node.image)]

    math_ = reader.program.math

    def where():  # from -1 to 0 Cycles shows the first tile again
        at = _vector(reader, node, groups)[:2]
        return [math_("MULTIPLY", math_("ADD", part, math_("LESS_THAN", part, 0.0)), by) for part, by in zip(at, scale)]

    seen, there = _look(reader, node, image, where), 1.0
    for part in where():  # beyond all tiles, too, it is missing
        for operation, edge in (("LESS_THAN", 1.0), ("GREATER_THAN", -1e-12)):
            there = math_("MULTIPLY", there, math_(operation, part, edge))
    return each(reader, "MIX", (*MISSING_COLOR, 1.0), seen, (there,) * 4)


def _box(reader, node, groups, image):
    """From three sides, by how much the normal turns to each; none shows it mirrored."""
    normal = of_object(reader, "NORMAL_INTO", surface_normal(reader))
    sides = reader.program.emit("BOX", normal=normal, blend=node.projection_blend)
    total = (0.0,) * 4
    for side, (axis, across, up, turned) in zip(sides, ((0, 1, 2, "LESS_THAN"), (1, 0, 2, "GREATER_THAN"),
                                                        (2, 1, 0, "GREATER_THAN"))):
        behind = reader.program.math(turned, normal[axis], 0.0)

        def where(across=across, up=up, behind=behind):
            at = _vector(reader, node, groups)
            other = reader.program.math("MULTIPLY_ADD", at[across], -2.0, 1.0)
            return reader.program.math("MULTIPLY_ADD", other, behind, at[across]), at[up]

        seen = _look(reader, node, image, where)
        total = each(reader, "MULTIPLY_ADD", seen, (side,) * 4, total)
    return total


def _sphere(reader, node, groups, image):
    def where():
        at = _about_middle(reader, node, groups)
        far = reader.program.math("SQRT", dot(reader, at, at))
        down = reader.program.math("ARCCOSINE", reader.program.math("DIVIDE", at[2], far))
        return _round(reader, at), reader.program.math("MULTIPLY_ADD", down, -1.0 / math.pi, 1.0)

    return _look(reader, node, image, where, averaged=False)  # there is a seam


def _tube(reader, node, groups, image):
    def where():
        at = _about_middle(reader, node, groups)
        return _round(reader, at), reader.program.math("MULTIPLY_ADD", at[2], 0.5, 0.5)

    return _look(reader, node, image, where, averaged=False)


_PROJECTIONS = {"FLAT": _flat, "BOX": _box, "SPHERE": _sphere, "TUBE": _tube}


def _vector(reader, node, groups):
    at = place(reader, node.inputs["Vector"], groups)
    return uv(reader) if at is None else at


def _about_middle(reader, node, groups):
    return each(reader, "MULTIPLY_ADD", _vector(reader, node, groups), (2.0,) * 3, (-1.0,) * 3)


def _round(reader, at):
    turn = reader.program.math("ARCTAN2", at[0], at[1])
    return reader.program.math("MULTIPLY_ADD", turn, -0.5 / math.pi, 0.5)


def _look(reader, node, image, where, averaged=True):
    """where: says the place, None for that of the UV map, wherever coordinates are shifted to."""
    at = where()
    elsewhere = {"at": at[:2]} if at else {}
    if averaged and _is_averaged(reader, node):
        elsewhere |= {"averaged": True, **(_near(reader, where) if at else {})}
    return reader.program.emit("IMAGE", 3, "alpha", image=image, cubic=is_cubic(node), **elsewhere)


def _is_averaged(reader, node):
    """Light, not data; heights are of points."""
    return (reader.averages and not reader.shift and not reader.in_height and node.interpolation == "Linear"
            and not node.image.colorspace_settings.is_data)


def _near(reader, where):
    near = []
    for shift in ((_STEP, 0.0), (0.0, _STEP)):
        reader.shift = shift
        near += where()[:2]
    reader.shift = None
    return {"near": near, "step": _STEP}


def is_plain(node):
    """A single image, looked up where its coordinates say."""
    return node.projection == "FLAT" and node.image.source != "TILED"


def is_cubic(node):
    return node.interpolation in ("Cubic", "Smart")


def image_of(reader, node):
    """Index of the image that a node shows, MISSING or -1 (with a message)."""
    if not node.image:
        reader.warn(f"'{node.name}' has no image")
        return MISSING
    extension = getattr(node, "extension", "REPEAT")  # an Environment Texture has none
    if extension not in _WRAPS:
        reader.warn(f"'{node.name}': extension {extension.lower()} is not supported; repeated")
    if node.interpolation not in _FILTERS:
        reader.warn(f"'{node.name}': interpolation {node.interpolation.lower()} is not supported; "
                    "linear")
    return reader.images.index(
        node.image, extension if extension in _WRAPS else "REPEAT",
        _FILTERS.get(node.interpolation, "LINEAR"), reader.owner, node.image_user,
        "Alpha" in node.outputs and node.outputs["Alpha"].is_linked)


NODES = {"TEX_IMAGE": _tex_image, "TEX_ENVIRONMENT": _tex_environment, "TEX_IES": _tex_ies}
