# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as nodes show them."""

from .image import MISSING, MISSING_COLOR
from .node_place import place

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
    at = place(reader, node.inputs["Vector"], found.groups)
    key = ("image", node, found.groups, reader.shift)
    if key not in reader.known:  # both outputs are of one look
        elsewhere = {"at": at[:2]} if at else {}
        if _is_averaged(reader, node):
            elsewhere |= {"averaged": True, **(_near(reader, node, found.groups) if at else {})}
        reader.known[key] = reader.program.emit("IMAGE", 3, "alpha", image=image, cubic=is_cubic(node), **elsewhere)
    *color, alpha = reader.known[key]
    return (alpha,) if found.output.name == "Alpha" else color


def _is_averaged(reader, node):
    """Light, not data; heights are of points."""
    return (reader.averages and not reader.shift and not reader.in_height and node.interpolation == "Linear"
            and not node.image.colorspace_settings.is_data)


def _near(reader, node, groups):
    near = []
    for shift in ((_STEP, 0.0), (0.0, _STEP)):
        reader.shift = shift
        near += place(reader, node.inputs["Vector"], groups)[:2]
    reader.shift = None
    return {"near": near, "step": _STEP}


def is_cubic(node):
    return node.interpolation in ("Cubic", "Smart")


def image_of(reader, node):
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


NODES = {"TEX_IMAGE": _tex_image}
