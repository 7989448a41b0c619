# SPDX-License-Identifier: GPL-3.0-or-later
"""What our nodes share with each other: how Blender knows them, and what menus, operators and panels do with them."""

import bpy
from bpy.props import StringProperty

from . import versions


def preset_of_scripts(words, apply):
    """`node.preset = word`, and which one was chosen last, "" for none: what that has set may be another by now. The
    class has CHOSEN among its properties."""
    def choose(node, word):
        known = str(word).upper().replace(" ", "_")
        if known not in words:
            raise TypeError(f"preset: '{word}' is none of {', '.join(words)}")
        apply(node, known)
    return property(lambda node: node.chosen, choose)


CHOSEN = {"chosen": StringProperty(options={"HIDDEN"})}  # the last preset, as its word


def add_button(layout, kind, label):
    """In an Add menu. The context of what Shift+A opens is to execute, which leaves the node where it is, not at the mouse."""
    layout.operator_context = "INVOKE_DEFAULT"
    add = layout.operator("node.add_node", text=label)
    add.type, add.use_transform = kind, True


def register_node(cls):
    """Where it stayed registered it is found. 5.0 has forgotten what it is derived from once others have asked for that anew."""
    if bpy.types.Node.bl_rna_get_subclass_py(cls.bl_idname):
        return
    base = bpy.types.ShaderNodeCustomGroup
    if cls.__bases__[0] is not base:
        cls.__bases__ = base,
    bpy.utils.register_class(cls)


def unregister_node(cls):
    """But where its class has to stay until Blender ends."""
    if versions.NODES_UNREGISTER:
        bpy.utils.unregister_class(cls)


def shown_node(context, kind):
    """The node of that kind that an editor shows, or None."""
    node = getattr(context, "node", None) or getattr(context, "active_node", None)
    return node if node and node.bl_idname == kind else None


class OnNode:
    """An operator on a node of its `kind` that an editor shows."""

    @classmethod
    def node_of(cls, context):
        return shown_node(context, cls.kind)

    @classmethod
    def poll(cls, context):
        node = cls.node_of(context)
        return node is not None and not node.id_data.library


class NodePanel:
    """A panel, closed at first, beside the shader editor, on a node of its `kind`."""

    bl_space_type, bl_region_type, bl_category = "NODE_EDITOR", "UI", "Node"
    bl_parent_id = "NODE_PT_active_node_properties"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        node = context.active_node
        return node is not None and node.bl_idname == cls.kind
