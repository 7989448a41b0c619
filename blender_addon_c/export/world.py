# SPDX-License-Identifier: GPL-3.0-or-later
"""What is around everything: one colour, an image, or a sky."""

import operator

import numpy as np
from mathutils import Euler, Matrix

from . import tree
from .known import understood
from .around import SEEN, Shine
from .graph import TooLarge
from .image import MISSING, MISSING_COLOR
from .sky import sky_of
from .visibility import ALL, hidden

# Of Math nodes between numbers that are known.
_SIMPLE = {"ADD": operator.add, "SUBTRACT": operator.sub, "MULTIPLY": operator.mul, "MAXIMUM": max, "MINIMUM": min}

# What its directions may come from, and their sign.
_COORDINATES = {"Generated": 1, "Object": 1, "Normal": -1}


def world_of(world, table, messages):
    """The part of the scene's dictionary that says what is around everything."""
    if not world:
        return {"background": (0.0, 0.0, 0.0)}
    seen = {"sky_hidden": hidden(getattr(world, "cycles_visibility", None), ALL[:-1], "")}
    nodes = tree.of(world)
    if not nodes:
        return {"background": tuple(world.color), **seen}
    try:
        output = nodes.get_output_node("ALL")
        if output and tree.trace(output.inputs["Volume"]).node:
            messages.warning(f"world '{world.name}': volumes are not supported; left out")
        reader = _Reader(world, table, messages)
        table.unknown.name(nodes, reader.warn)
        return {**_by_way(reader, reader.read(nodes), nodes), **seen}
    except (RecursionError, TooLarge, ValueError) as error:  # or the native module has said what is wrong
        why = error if isinstance(error, ValueError) else "its nodes are too many"
        messages.warning(f"world '{world.name}': {why}; black")
        return {"background": (0.0, 0.0, 0.0), **seen}


# Ways by which rays that surfaces draw come (the native module's ray_kinds), and what Light Path says of them.
_DIFFUSE, _GLOSSY, _TRANSMISSION, _SINGULAR = 2, 4, 8, 32
_WAYS = {
    _DIFFUSE: {"DIFFUSE", "REFLECTION"},
    _GLOSSY: {"GLOSSY", "REFLECTION"},
    _GLOSSY | _SINGULAR: {"GLOSSY", "SINGULAR", "REFLECTION"},
    _TRANSMISSION: {"GLOSSY", "TRANSMISSION"},
    _TRANSMISSION | _SINGULAR: {"GLOSSY", "SINGULAR", "TRANSMISSION"},
    _TRANSMISSION | _DIFFUSE: {"DIFFUSE", "TRANSMISSION"},
}


def _by_way(reader, lit, nodes):
    """What rays see may be another colour than what lights the scene, by the way that they come: samples of the world's
    light come by none, as in Cycles [measured: 3.4 and 5.0]."""
    seen = _as_seen(reader, {"CAMERA"}, nodes) if "CAMERA" in reader.asked else lit
    looks = _looks(reader, nodes)
    if looks and "sky" not in lit and any(lit["background"]) and any("sky" in one for one in (seen, *looks)):
        # Cycles draws from all of a world that is uneven to some ray
        lit = reader.even(lit["background"])
    made = {**lit, "looks": looks} if looks else lit
    if seen == lit:
        return made
    return {**made, **({"backdrop_sky": seen["sky"]} if "sky" in seen else {"backdrop": seen["background"]})}


def _as_seen(reader, way, nodes):
    reader.way = frozenset(way)
    return reader.read(nodes)


def _looks(reader, nodes):
    """For the native module: what rays see that come by these ways, where nodes ask for that."""
    read = {}  # by rays
    while True:
        asked = reader.asked - {"CAMERA"}
        groups = {}
        for rays, words in _WAYS.items():
            if asked & words:
                groups.setdefault(frozenset(asked & words), []).append(rays)
        missing = [group[0] for group in groups.values() if group[0] not in read]
        if not missing:
            return [{"rays": np.array(group, np.uint32), **read[group[0]]} for group in groups.values()]
        for rays in missing:  # they may ask for more, where the others do not come
            read[rays] = _as_seen(reader, _WAYS[rays], nodes)


class _Richer(Exception):
    """Its nodes make more of it than one colour or one image."""


class _Reader:
    """The nodes of one world, for samples of its light or, where it makes a difference, for rays that come a `way`: what
    Light Path says of them. `asked`: what it was asked for."""

    def __init__(self, world, table, messages):
        self._owner, self._table, self._messages = f"world '{world.name}'", table, messages
        self._images = table.images
        self.way, self.asked = frozenset(), frozenset()

    def warn(self, text):
        self._messages.warning(f"{self._owner}: {text}")

    def _factor(self, socket, groups):
        """A number that is known, or None."""
        found = tree.trace(socket, groups)
        if found.node is None:
            return tree.number_in(found.socket)
        if found.node.type == "LIGHT_PATH" and found.output.name in SEEN:
            self.asked |= {SEEN[found.output.name]}
            return float(SEEN[found.output.name] in self.way)
        if found.node.type == "MATH" and found.node.operation in _SIMPLE:
            parts = [self._factor(socket, found.groups) for socket in found.node.inputs[:2]]
            made = None if None in parts else _SIMPLE[found.node.operation](*parts)
            return min(max(made, 0.0), 1.0) if found.node.use_clamp and made is not None else made
        return None

    def _trace(self, socket, groups=()):
        """Where links lead, past nodes that pass on all of one input."""
        found = tree.trace(socket, groups)
        for _ in range(100):
            names = self._sides(found.node) if found.node else None
            if not names:
                break
            by = {socket.identifier: socket for socket in found.node.inputs}
            factor, *sides = (by.get(name) or found.node.inputs[k] for k, name in enumerate(names))
            share = self._factor(factor, found.groups)
            if share not in (0.0, 1.0):
                break
            found = tree.trace(sides[int(share)], found.groups)
        if found.node and not understood(found.node, found.output):
            raise _Richer
        return found

    @staticmethod
    def _sides(node):
        """Names of the factor and of both inputs of a node that mixes, else None."""
        if node.type == "MIX_SHADER":
            return "Fac", "Shader", "Shader_001"
        if node.type == "MIX_RGB" and node.blend_type == "MIX":
            return "Fac", "Color1", "Color2"
        if node.type == "MIX" and node.data_type == "FLOAT":
            return "Factor_Float", "A_Float", "B_Float"
        if node.type == "MIX" and node.data_type == "RGBA" and node.blend_type == "MIX":
            return "Factor_Float", "A_Color", "B_Color"
        return None

    def read(self, nodes):
        try:
            return self._plain(nodes)
        except _Richer:
            return self._rich(nodes)

    def _rich(self, nodes):
        shine = Shine(nodes, self._owner, self._table, self._messages, self.way)
        self.asked |= shine.asked
        if not shine.there:
            self.warn(f"'{tree.shader_of(nodes).node.name}' does not shine; black")
        if not shine.turns:
            return {"background": shine.color}
        picture = shine.picture()
        shader = shine.shader(picture["height"], self._images)
        return self._made(picture, {"shader": self._table.add_shader(shader)} if shader else {})

    def _made(self, picture, more=()):
        sky = {**dict(more), "image": self._images.made(picture), "strength": (1.0,) * 3, "matrix": _rows(Matrix.Identity(4)),
               "projection": "EQUIRECTANGULAR"}
        return {"background": (0.0, 0.0, 0.0), "sky": sky}

    def even(self, color):
        """A picture of one colour, which directions are drawn from."""
        return self._made({"width": 2, "height": 1, "channels": 3, "data": np.tile(np.float32(color), 2), "srgb": False,
                           "wrap": "REPEAT", "filter": "LINEAR"})

    def _plain(self, nodes):
        output = nodes.get_output_node("ALL")
        shader = self._trace(output.inputs["Surface"]) if output else None
        node = shader.node if shader else None
        if not node:
            return {"background": (0.0, 0.0, 0.0)}
        if node.type not in {"BACKGROUND", "EMISSION"}:
            raise _Richer
        strength = self._trace(node.inputs["Strength"], shader.groups)
        if strength.node and strength.node.type != "VALUE":
            raise _Richer
        value = tree.number_in(strength.output if strength.node and strength.node.type == "VALUE"
                               else strength.socket)
        color = self._trace(node.inputs["Color"], shader.groups)
        if color.node and color.node.type not in {"TEX_ENVIRONMENT", "TEX_SKY", "RGB"}:
            raise _Richer
        if color.node and color.node.type == "TEX_ENVIRONMENT":
            sky = self._image(color, value)
            if sky == MISSING:
                return {"background": tuple(c * max(value, 0.0) for c in MISSING_COLOR)}
            if sky:
                return {"background": (0.0, 0.0, 0.0), "sky": sky}
        if color.node and color.node.type == "TEX_SKY":
            return {"background": (0.0, 0.0, 0.0), "sky": self._sky(color, value)}
        plain = color.output if color.node and color.node.type == "RGB" else color.socket
        return {"background": tuple(max(c * value, 0.0) for c in tree.color_in(plain))}

    def _image(self, color, strength):
        node = color.node
        if not node.image:
            self.warn(f"'{node.name}' has no image")
            return MISSING
        if node.interpolation not in {"Linear", "Closest"}:
            self.warn(f"'{node.name}': interpolation {node.interpolation.lower()} is not "
                       "supported; linear")
        index = self._images.index(node.image, "REPEAT",
                                   "CLOSEST" if node.interpolation == "Closest" else "LINEAR",
                                   self._owner, node.image_user)
        if index < 0:
            return index if index == MISSING else None
        matrix = self._directions(tree.trace(node.inputs["Vector"], color.groups))
        return {"image": index, "strength": (max(strength, 0.0),) * 3,
                "matrix": _rows(matrix),
                "projection": node.projection}

    def _sky(self, color, strength):
        """What is linked to its vector counts where it is shown."""
        vector = color.node.inputs.get("Vector")
        matrix = (self._directions(tree.trace(vector, color.groups)) if vector and vector.enabled else
                  Matrix.Identity(4))
        return sky_of(self, color.node, strength, matrix)

    def _directions(self, found):
        """The matrix from a direction in the world to the one that the texture looks up."""
        node = found.node
        if node is None:
            return Matrix.Identity(4)
        if not understood(node, found.output):
            raise _Richer
        if node.type == "MAPPING":
            inner = tree.trace(node.inputs["Vector"], found.groups)
            before = (self._directions(inner) if inner.node
                      else _constant(tree.color_in(inner.socket)))
            return self._mapping(node, found.groups) @ before
        if node.type == "TEX_COORD" and found.output.name in _COORDINATES:
            if found.output.name == "Object" and node.object:
                raise _Richer
            return Matrix.Diagonal((*(_COORDINATES[found.output.name],) * 3, 1.0))
        raise _Richer

    def _mapping(self, node, groups):
        values = {"Location": (0.0, 0.0, 0.0)}  # not there in 5.0 where it says nothing
        for name in ("Location", "Rotation", "Scale"):
            socket = node.inputs.get(name)
            if not socket:
                continue
            found = tree.trace(socket, groups)
            if found.node:
                raise _Richer
            values[name] = tree.color_in(found.socket)
        place, turn = Matrix.Translation(values["Location"]), Euler(values["Rotation"]).to_matrix().to_4x4()
        scale = values["Scale"]
        if node.vector_type == "POINT":
            return place @ turn @ _diagonal(scale)
        if node.vector_type == "TEXTURE":
            return _diagonal(_inverse(scale)) @ turn.transposed() @ Matrix.Translation(
                [-v for v in values["Location"]])
        return turn @ _diagonal(scale if node.vector_type == "VECTOR" else _inverse(scale))


def _rows(matrix):
    return [value for row in matrix[:3] for value in row]


def _diagonal(values):
    return Matrix.Diagonal((*values, 1.0))


def _inverse(values):
    """As Blender divides: by 0 to 0."""
    return [1.0 / v if v else 0.0 for v in values]


def _constant(values):
    """The matrix from any direction to one place."""
    matrix = Matrix.Diagonal((0.0, 0.0, 0.0, 1.0))
    matrix.translation = values
    return matrix
