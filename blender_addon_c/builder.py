# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees by formulas."""

import bpy

from .group import new_inside
from .groove import arrange


def shared(name, mark, fill):
    """The file's group of that mark for nodes of ours, made where there is none."""
    for tree in bpy.data.node_groups:
        if tree.get(mark) and not tree.library:
            return tree
    tree = new_inside(name)
    tree[mark] = True
    fill(tree)
    arrange(tree)
    return tree


class Builder:
    """Nodes of a tree, and their links."""

    def __init__(self, tree):
        self.tree = tree

    def new(self, kind, **inputs):
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in inputs.items():
            self.feed(node.inputs[name], value)
        return node

    def feed(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def math(self, operation, *values):
        node = self.new("Math")
        node.operation = operation
        for socket, value in zip(node.inputs, values):
            self.feed(socket, value)
        return node.outputs[0]

    def vector(self, operation, a, b=None, c=None):
        node = self.new("VectorMath")
        node.operation = operation
        self.feed(node.inputs[0], a)
        if operation == "SCALE":
            self.feed(node.inputs["Scale"], b)
        elif b is not None:
            self.feed(node.inputs[1], b)
        if c is not None:
            self.feed(node.inputs[2], c)
        return node.outputs["Value" if operation in ("DOT_PRODUCT", "LENGTH") else "Vector"]

    def parts(self, vector):
        return self.new("SeparateXYZ", Vector=vector).outputs

    def together(self, x, y, z=0.0):
        return self.new("CombineXYZ", X=x, Y=y, Z=z).outputs[0]
