# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that feed a closure: one function for each, to the native module's."""

from . import tree

_WRAPS = {"REPEAT", "EXTEND", "CLIP"}
_FILTERS = {"Linear": "LINEAR", "Closest": "CLOSEST"}


def color_of(reader, socket, groups):
    """The colour of a socket, or white where a node of ours takes its place."""
    found = tree.trace(socket, groups)
    if found.node is None:
        return tuple(found.socket.default_value[:3])
    # What no reader knows goes to the texture's, which says what it leaves out.
    return _COLORS.get(found.node.type, _color_tex_image)(reader, found)


def number_of(reader, socket, groups):
    """The number of a socket."""
    found = tree.trace(socket, groups)
    if found.node is None:
        return found.socket.default_value
    if found.node.type == "VALUE":
        return found.output.default_value
    reader.warn(f"{socket.name}: '{found.node.name}' is not supported; the socket's own value is "
                "used")
    return found.socket.default_value


def _color_rgb(reader, found):
    return tuple(found.output.default_value[:3])


def _color_tex_image(reader, found):
    image = _image(reader, found, "Color")
    if image < 0:
        return tuple(found.socket.default_value[:3])
    reader.nodes.append({"type": "IMAGE", "image": image})
    return 1.0, 1.0, 1.0


def normal_of(reader, socket, groups):
    found = tree.trace(socket, groups)
    if found.node is None:
        return
    if found.node.type != "NORMAL_MAP":
        reader.warn(f"Normal: '{found.node.name}' is not supported, only a Normal Map node; "
                    "left out")
        return
    node = found.node
    if node.space != "TANGENT":
        reader.warn(f"Normal: '{node.name}' is in {node.space.lower()} space, only tangent "
                    "space is supported; left out")
        return
    color = tree.trace(node.inputs["Color"], found.groups)
    if color.node is None:
        reader.warn(f"Normal: '{node.name}' has no image; left out")
        return
    image = _image(reader, color, "Normal")
    if image < 0:
        return
    _check_normal_image(reader, color.node.image)
    if node.uv_map:
        reader.use_uv_map(node.uv_map)
    strength = tree.trace(node.inputs["Strength"], found.groups)
    value = strength.socket
    if strength.node and strength.node.type == "VALUE":
        value = strength.output
    elif strength.node:
        reader.warn(f"Normal: the strength from '{strength.node.name}' is not supported; "
                    "its socket's own value is used")
    reader.nodes.append({"type": "NORMAL_MAP", "image": image, "strength": value.default_value})


def _check_normal_image(reader, image):
    if not image.colorspace_settings.is_data:
        reader.warn(f"normal map '{image.name}' has colour space "
                    f"'{image.colorspace_settings.name}': set it to Non-Color")
    if not image.is_float:
        reader.warn(f"normal map '{image.name}' has 8 bits: its steps show in sharp "
                    "highlights; use 16 bits or float")


def _image(reader, found, purpose):
    """Index of the image that a traced socket reads, or -1 (with a message)."""
    node = found.node
    if node.type != "TEX_IMAGE" or found.output.name != "Color":
        reader.warn(f"{purpose}: '{node.name}' ({found.output.name}) is not supported, "
                    "only an Image Texture; left out")
        return -1
    if not node.image:
        reader.warn(f"{purpose}: '{node.name}' has no image; left out")
        return -1
    if node.projection != "FLAT":
        reader.warn(f"{purpose}: '{node.name}': only flat projection is supported")
    if node.extension not in _WRAPS:
        reader.warn(f"{purpose}: '{node.name}': extension {node.extension.lower()} is not "
                    "supported; repeated")
    if node.interpolation not in _FILTERS:
        reader.warn(f"{purpose}: '{node.name}': interpolation {node.interpolation.lower()} "
                    "is not supported; linear")
    _coordinates(reader, node, found.groups)
    return reader.images.index(
        node.image, node.extension if node.extension in _WRAPS else "REPEAT",
        _FILTERS.get(node.interpolation, "LINEAR"), reader.owner)


def _coordinates(reader, node, groups):
    vector = tree.trace(node.inputs["Vector"], groups)
    if vector.node is None or (vector.node.type == "TEX_COORD" and vector.output.name == "UV"):
        return
    if vector.node.type == "UVMAP":
        reader.use_uv_map(vector.node.uv_map)
    else:
        reader.warn(f"'{node.name}': coordinates from '{vector.node.name}' "
                    f"({vector.output.name}) are not supported; the UV map is used as it is")


# What may feed a colour, by the node's type: each is tested by test_blender_semantics.
_COLORS = {"RGB": _color_rgb, "TEX_IMAGE": _color_tex_image}
