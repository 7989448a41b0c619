# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders in the Add menu of Blenders that show theirs under Cycles and EEVEE alone, as 3.4 does."""

import importlib

import bpy

from .export.closure import CLOSURES
from .names import ENGINE
from .own_node import add_button

_FIRST = ("ShaderNodeOutputMaterial", "ShaderNodeMixShader", "ShaderNodeAddShader")
# Where Blender decides what its menu shows, in one version or another.
_MODULES = ("nodeitems_builtins", "bl_ui.node_add_menu_shader")


def _hides_shaders():
    for name in _MODULES:
        try:
            module = importlib.import_module(name)
        except ImportError:
            continue
        if hasattr(module, "object_eevee_cycles_shader_nodes_poll"):
            return True
    return False


def shaders():
    """(bl_idname, label) of what this Blender has and the engine shades."""
    known = [name for name in CLOSURES if name.startswith("ShaderNode") and name != "ShaderNodeBackground"]
    there = {name: getattr(bpy.types, name).bl_rna.name for name in (*_FIRST, *known) if hasattr(bpy.types, name)}
    first = [name for name in _FIRST if name in there]
    return [(name, there[name]) for name in first + sorted(set(there) - set(first), key=there.get)]


class NODE_MT_libshade_shaders(bpy.types.Menu):
    bl_label = "Shaders of Cycles"

    def draw(self, _context):
        for name, label in shaders():
            add_button(self.layout, name, label)


def _draw_add_menu(self, context):
    space = context.space_data
    if context.engine == ENGINE and space.tree_type == "ShaderNodeTree" and space.shader_type == "OBJECT":
        self.layout.menu(NODE_MT_libshade_shaders.__name__)


def register():
    bpy.utils.register_class(NODE_MT_libshade_shaders)
    if _hides_shaders():
        bpy.types.NODE_MT_add.append(_draw_add_menu)


def unregister():
    if _hides_shaders():
        bpy.types.NODE_MT_add.remove(_draw_add_menu)
    bpy.utils.unregister_class(NODE_MT_libshade_shaders)
