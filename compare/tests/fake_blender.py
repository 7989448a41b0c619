# SPDX-License-Identifier: Apache-2.0
"""Stand-ins for bpy, mathutils and the add-on, so that scripts which run inside Blender can be read without it."""
import contextlib
import importlib
import sys
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import numpy as np


class Vector(tuple):
    """Three numbers; to_track_quat(…).to_euler() says what was asked."""

    def __sub__(self, other):
        return Vector(np.subtract(self, other))

    def __rsub__(self, other):
        return Vector(np.subtract(other, self))

    def to_track_quat(self, axis, up):
        return SimpleNamespace(to_euler=lambda: (tuple(self), axis, up))


class Matrix(np.ndarray):
    """Four by four, its products by @."""

    def __new__(cls, rows):
        return np.array(rows, float).view(cls)

    @classmethod
    def Identity(cls, size):
        return cls(np.eye(size))

    @classmethod
    def Diagonal(cls, values):
        return cls(np.diag(values))

    @classmethod
    def Translation(cls, by):
        made = cls(np.eye(4))
        made[:3, 3] = by
        return made

    @classmethod
    def Rotation(cls, angle, size, axis):
        made = cls(np.eye(size))
        first = ("XYZ".index(axis) + 1) % 3
        second = (first + 1) % 3
        made[first, first] = made[second, second] = np.cos(angle)
        made[first, second], made[second, first] = -np.sin(angle), np.sin(angle)
        return made


class Socket:
    def __init__(self, node, name):
        self.node, self.name, self.links, self.default_value = node, name, [], None

    is_linked = property(lambda self: bool(self.links))


class Sockets(dict):
    """Made when they are asked for, by name or number; iterated over as Blender's are."""

    def __init__(self, node):
        super().__init__()
        self.node = node

    def __missing__(self, key):
        made = self[key] = Socket(self.node, key)
        return made

    def __iter__(self):
        return iter(self.values())


class Nodes(list):
    def new(self, kind):
        made = SimpleNamespace(bl_idname=kind, type=kind.removeprefix("ShaderNode").upper())
        made.inputs, made.outputs = Sockets(made), Sockets(made)
        self.append(made)
        return made


class Tree:
    """Of nodes; `linked`: what was linked, as (node, output, node, input)."""

    def __init__(self):
        self.nodes, self.links, self.linked = Nodes(), self, []

    def new(self, source, target):
        self.linked.append((source.node.bl_idname, source.name, target.node.bl_idname, target.name))
        target.links[:] = [SimpleNamespace(from_node=source.node, from_socket=source, to_socket=target)]

    def remove(self, link):
        link.to_socket.links.remove(link)

    def get_output_node(self, target):
        return next((node for node in self.nodes if node.bl_idname == "ShaderNodeOutputMaterial"), None) if target == "ALL" else None


def material(name):
    return SimpleNamespace(name=name, use_nodes=False, node_tree=Tree(), diffuse_color=(0.8, 0.8, 0.8, 1))


@contextlib.contextmanager
def imported(*names):
    """(bpy, *modules of these names), read anew with stand-ins in place of Blender's own, which are gone afterwards."""
    bpy, mathutils, libshade = MagicMock(), ModuleType("mathutils"), MagicMock()
    for kind in (bpy.data.objects, bpy.data.lights, bpy.data.meshes, bpy.data.cameras):
        kind.new.side_effect = lambda name, *more: MagicMock(**{"said": (name, *more)})
    bpy.data.materials.new.side_effect = material
    mathutils.Vector, mathutils.Matrix = Vector, Matrix
    libshade.nodes = SimpleNamespace(apply_preset=lambda node, word: setattr(node, "preset", word))
    before = {name: sys.modules.pop(name, None) for name in (*names, "bpy", "mathutils", "libshade")}
    sys.modules.update(bpy=bpy, mathutils=mathutils, libshade=libshade)
    try:
        yield bpy, *map(importlib.import_module, names)
    finally:
        for name, module in before.items():
            sys.modules.pop(name, None)
            if module:
                sys.modules[name] = module
