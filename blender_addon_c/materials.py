# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials, lights and the world: the part that libshade understands.

Whatever is linked and not understood is named in a message.
"""

import os
from collections import namedtuple

import bpy
import numpy as np

from . import nodes

# Where a socket's links lead: the last input on the way (its value counts when nothing feeds
# it), and the node and output that feed it, or None.
Source = namedtuple("Source", "socket node output groups")

_WRAPS = {"REPEAT", "EXTEND", "CLIP"}
_FILTERS = {"Linear": "LINEAR", "Closest": "CLOSEST"}


def trace(socket, groups=()):
    """Follow a socket through reroutes, muted nodes and groups; `groups` are the nodes around."""
    link = next((l for l in socket.links if l.is_valid and not l.is_muted), None)
    if not link:
        return Source(socket, None, None, groups)
    node, output = link.from_node, link.from_socket
    if node.mute:
        through = next((l for l in node.internal_links if l.to_socket == output), None)
        return trace(through.from_socket, groups) if through else Source(socket, None, None, groups)
    if node.type == "REROUTE":
        return trace(node.inputs[0], groups)
    if node.type == "GROUP" and node.node_tree:
        inner = next((n for n in node.node_tree.nodes
                      if n.type == "GROUP_OUTPUT" and n.is_active_output), None)
        if inner:
            return trace(_twin(inner.inputs, output), (*groups, node))
    if node.type == "GROUP_INPUT" and groups:
        return trace(_twin(groups[-1].inputs, output), groups[:-1])
    return Source(socket, node, output, groups)


def _twin(sockets, socket):
    return next(s for s in sockets if s.identifier == socket.identifier)


def _tree(owner):
    """Node tree of a material, light or world, if it uses one."""
    # From 5.0 on only lights may do without, and asking the others is deprecated.
    always = bpy.app.version >= (5, 0) and not isinstance(owner, bpy.types.Light)
    return owner.node_tree if always or owner.use_nodes else None


def _shader(tree):
    """What feeds the Surface of a tree's active output."""
    output = tree.get_output_node("ALL")
    return trace(output.inputs["Surface"]) if output else None


class Table:
    """Materials and images of one render, each once."""

    def __init__(self, messages):
        self.materials, self.images = [], []
        self._messages = messages
        self._indices = {}  # by material
        self._uv_maps = []  # by index, "" is the mesh's active one
        self._image_indices = {}  # by image, wrap and filter
        self._pixels = {}  # by image; None: cannot be read

    def index(self, material, owner):
        """Index of a material; None is an empty slot of the object `owner`."""
        if material not in self._indices:
            if not material:
                self._messages.warning(f"object '{owner}': no material, rendered as grey metal")
            reader = _Reader(self, self._messages, material)
            self._indices[material] = len(self.materials)
            self.materials.append(reader.read())
            self._uv_maps.append(reader.uv_map)
        return self._indices[material]

    def uv_map(self, indices, owner):
        """Name of the UV map that materials ask for, "" for the mesh's active one."""
        names = sorted({self._uv_maps[i] for i in indices})
        if len(names) > 1:
            self._messages.warning(f"object '{owner}': its materials use different UV maps; "
                                   f"libshade uses '{names[-1]}' for all")
        return names[-1]

    def textured(self, indices):
        """Has any of the materials a texture?"""
        return any(self.materials[i]["nodes"] for i in indices)

    def image(self, image, wrap, filtering, owner):
        """Index of an image, or -1 when it cannot be used."""
        key = (image, wrap, filtering)
        if key not in self._image_indices:
            if image not in self._pixels:
                self._pixels[image] = self._fetch(image, owner)
            pixels = self._pixels[image]
            self._image_indices[key] = -1 if pixels is None else len(self.images)
            if pixels is not None:
                self.images.append({**pixels, "wrap": wrap, "filter": filtering})
        return self._image_indices[key]

    def _fetch(self, image, owner):
        if image.source not in {"FILE", "GENERATED"}:
            self._messages.warning(f"{owner}: image '{image.name}' is a "
                                   f"{image.source.lower()}: only single images are supported")
            return None
        path = os.path.normpath(bpy.path.abspath(image.filepath, library=image.library))
        on_disk = image.source == "FILE" and not image.packed_file and not image.is_dirty
        if on_disk and not os.path.isfile(path):
            self._messages.error(f"{owner}: image file not found: {path}")
            return None
        width, height = image.size
        if not width or not height:
            self._messages.error(f"{owner}: image '{image.name}' cannot be read: {path}")
            return None
        data = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(data)
        # Blender hands float images over in linear light, bytes as they are in the file.
        srgb = not image.is_float and image.colorspace_settings.name == "sRGB"
        if not (srgb or image.is_float or image.colorspace_settings.is_data):
            self._messages.warning(f"{owner}: image '{image.name}': colour space "
                                   f"'{image.colorspace_settings.name}' is read as Non-Color")
        return {"width": width, "height": height, "channels": image.channels, "data": data,
                "srgb": srgb}


class _Reader:
    """One material. `uv_map`: the UV map that its images ask for; `nodes`: what it reads them by."""

    def __init__(self, table, messages, material):
        self._table, self._messages, self._material = table, messages, material
        self._owner = f"material '{material.name}'" if material else "no material"
        self.uv_map, self.nodes = "", []

    def _warn(self, text):
        self._messages.warning(f"{self._owner}: {text}")

    def read(self):
        material = self._material
        plain = {
            "name": material.name if material else "", "closure": "METAL",
            **nodes.initial_settings(), "nodes": self.nodes,
        }
        if not material:
            return {**plain, **_roughness(0.5), "f0": (0.8, 0.8, 0.8)}
        tree = _tree(material)
        shader = _shader(tree) if tree else None
        node = shader.node if shader else None
        if node and node.bl_idname == nodes.METAL:
            return {**plain, **nodes.settings(node), "f0": self._inputs(node, "Color", shader)}
        if node and node.type == "BSDF_PRINCIPLED":
            self._warn("no Libshade Metal node; its Principled BSDF is rendered as metal "
                       "of its base colour and roughness")
            return {**plain, **_roughness(node.inputs["Roughness"].default_value),
                    "f0": self._inputs(node, "Base Color", shader)}
        fed_by = f"its surface is '{node.name}'" if node else "its surface has no shader"
        self._warn(f"no Libshade Metal node ({fed_by if tree else 'it has no nodes'}); "
                   "rendered as metal of its viewport colour")
        return {**plain, **_roughness(material.roughness),
                "f0": tuple(material.diffuse_color[:3])}

    def _inputs(self, node, color, shader):
        """What feeds a shader's colour and normal, as nodes; the colour where it is one."""
        f0 = self._color(node.inputs[color], shader.groups)
        self._normal(node.inputs["Normal"], shader.groups)
        return f0

    def _color(self, socket, groups):
        """The colour of a socket, or white where a node of ours takes its place."""
        found = trace(socket, groups)
        if found.node is None:
            return tuple(found.socket.default_value[:3])
        # What no reader knows goes to the texture's, which says what it leaves out.
        return _COLORS.get(found.node.type, _Reader._color_texture)(self, found)

    def _color_value(self, found):
        return tuple(found.output.default_value[:3])

    def _color_texture(self, found):
        image = self._image(found, "Color")
        if image < 0:
            return tuple(found.socket.default_value[:3])
        self.nodes.append({"type": "IMAGE", "image": image})
        return 1.0, 1.0, 1.0

    def _normal(self, socket, groups):
        found = trace(socket, groups)
        if found.node is None:
            return
        if found.node.type != "NORMAL_MAP":
            self._warn(f"Normal: '{found.node.name}' is not supported, only a Normal Map node; "
                       "left out")
            return
        node = found.node
        if node.space != "TANGENT":
            self._warn(f"Normal: '{node.name}' is in {node.space.lower()} space, only tangent "
                       "space is supported; left out")
            return
        color = trace(node.inputs["Color"], found.groups)
        if color.node is None:
            self._warn(f"Normal: '{node.name}' has no image; left out")
            return
        image = self._image(color, "Normal")
        if image < 0:
            return
        self._check_normal_image(color.node.image)
        if node.uv_map:
            self._use_uv_map(node.uv_map)
        strength = trace(node.inputs["Strength"], found.groups)
        value = strength.socket
        if strength.node and strength.node.type == "VALUE":
            value = strength.output
        elif strength.node:
            self._warn(f"Normal: the strength from '{strength.node.name}' is not supported; "
                       "its socket's own value is used")
        self.nodes.append({"type": "NORMAL_MAP", "image": image, "strength": value.default_value})

    def _check_normal_image(self, image):
        if not image.colorspace_settings.is_data:
            self._warn(f"normal map '{image.name}' has colour space "
                       f"'{image.colorspace_settings.name}': set it to Non-Color")
        if not image.is_float:
            self._warn(f"normal map '{image.name}' has 8 bits: its steps show in sharp "
                       "highlights; use 16 bits or float")

    def _image(self, found, purpose):
        """Index of the image that a traced socket reads, or -1 (with a message)."""
        node = found.node
        if node.type != "TEX_IMAGE" or found.output.name != "Color":
            self._warn(f"{purpose}: '{node.name}' ({found.output.name}) is not supported, "
                       "only an Image Texture; left out")
            return -1
        if not node.image:
            self._warn(f"{purpose}: '{node.name}' has no image; left out")
            return -1
        if node.projection != "FLAT":
            self._warn(f"{purpose}: '{node.name}': only flat projection is supported")
        if node.extension not in _WRAPS:
            self._warn(f"{purpose}: '{node.name}': extension {node.extension.lower()} is not "
                       "supported; repeated")
        if node.interpolation not in _FILTERS:
            self._warn(f"{purpose}: '{node.name}': interpolation {node.interpolation.lower()} "
                       "is not supported; linear")
        self._coordinates(node, found.groups)
        return self._table.image(
            node.image, node.extension if node.extension in _WRAPS else "REPEAT",
            _FILTERS.get(node.interpolation, "LINEAR"), self._owner)

    def _coordinates(self, node, groups):
        vector = trace(node.inputs["Vector"], groups)
        if vector.node is None or (vector.node.type == "TEX_COORD" and vector.output.name == "UV"):
            return
        if vector.node.type == "UVMAP":
            self._use_uv_map(vector.node.uv_map)
        else:
            self._warn(f"'{node.name}': coordinates from '{vector.node.name}' "
                       f"({vector.output.name}) are not supported; the UV map is used as it is")

    def _use_uv_map(self, name):
        if name and self.uv_map and name != self.uv_map:
            self._warn(f"uses the UV maps '{self.uv_map}' and '{name}'; "
                       f"libshade uses '{self.uv_map}' for both")
        self.uv_map = self.uv_map or name


# What may feed a colour, by the node's type: each is tested by test_blender_semantics.
_COLORS = {"RGB": _Reader._color_value, "TEX_IMAGE": _Reader._color_texture}


def _roughness(roughness):
    """Settings of an isotropic metal of Blender's roughness, whose square is alpha."""
    alpha = max(roughness * roughness, 1e-4)
    exponent = nodes.exponent_of(alpha)
    return {"ex": exponent, "ey": exponent, "ax": alpha, "ay": alpha}


def _emission(tree, kind, owner, messages, otherwise):
    """(colour, strength) of an Emission or Background shader, linked values left out.

    Any other shader counts as a white one of strength `otherwise`.
    """
    shader = _shader(tree)
    if not shader or not shader.node:
        return (0.0, 0.0, 0.0), 0.0
    if shader.node.type != kind:
        messages.warning(f"{owner}: '{shader.node.name}' is not supported; "
                         "its nodes are left out")
        return (1.0, 1.0, 1.0), otherwise
    color, strength = (trace(shader.node.inputs[name], shader.groups)
                       for name in ("Color", "Strength"))
    for found in (color, strength):
        if found.node:
            messages.warning(f"{owner}: '{found.node.name}' is not supported; "
                             "the socket's own value is used")
    return tuple(color.socket.default_value[:3]), strength.socket.default_value


def background(world, messages):
    """Constant background, linear RGB."""
    if not world:
        return (0.0, 0.0, 0.0)
    tree = _tree(world)
    if not tree:
        return tuple(world.color)
    color, strength = _emission(tree, "BACKGROUND", f"world '{world.name}'", messages, 0.0)
    return tuple(c * strength for c in color)


def light_strength(light, messages):
    """Energy × colour, linear RGB, in the light's own unit: W/m² (sun) or W."""
    owner = f"light '{light.name}'"
    scale = light.energy * 2.0 ** getattr(light, "exposure", 0.0)  # exposure: from 4.5 on
    factors = [light.color]
    if getattr(light, "use_temperature", False):
        factors.append(light.temperature_color)
    if not getattr(light, "normalize", True):
        messages.warning(f"{owner}: power by area (Normalize off) is not supported")
    if _tree(light):
        color, strength = _emission(_tree(light), "EMISSION", owner, messages, 1.0)
        factors.append(color)
        scale *= strength
    return tuple(scale * value for value in np.prod([tuple(f) for f in factors], axis=0))
