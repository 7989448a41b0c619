# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules of the add-on by name, and what stands in for parts of them for a while."""

import contextlib
import importlib

import bpy

import common


def module(name):
    return importlib.import_module(f"{common.MODULE}.{name}")


@contextlib.contextmanager
def replaced(owner, **parts):
    held = {name: getattr(owner, name) for name in parts}
    try:
        for name, part in parts.items():
            setattr(owner, name, part)
        yield
    finally:
        for name, part in held.items():
            setattr(owner, name, part)


def raised(function, *arguments):
    """What the error says; "" without one."""
    try:
        function(*arguments)
    except Exception as error:  # whatever it is
        return str(error)
    return ""


@contextlib.contextmanager
def bare_cloth():
    """(a tree, a cloth node in it) with nothing inside for other renderers but its sockets: to make that takes most of the time."""
    inside = module("fabric.tree")

    def new_tree():
        made = bpy.data.node_groups.new("bare", "ShaderNodeTree")
        for name, kind, *_about in inside.SOCKETS:
            module("group").new_socket(made, name, "INPUT", f"NodeSocket{kind}")
        return made
    tree = common.tree_of(bpy.data.materials.new("cloth"))
    with replaced(inside, can_update=lambda _tree: False, new_tree=new_tree):
        node = tree.nodes.new("LibshadeFabricNode")
        node.inputs["Scale"].default_value = 1
        yield tree, node
