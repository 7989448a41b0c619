# SPDX-License-Identifier: GPL-3.0-or-later
"""The scratches node: a field of libshade's over the surface, as a normal, a height and a mask. Our engine evaluates
it; what other renderers see of it is in tree.py."""

import json

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, StringProperty

from .. import _native
from ..export import size
from ..manual import draw_button
from ..names import SCRATCHES
from ..own_node import CHOSEN, add_button, preset_of_scripts, register_node, unregister_node
from ..report import draw_on, in_digits, is_enabled
from . import tree as scratch_tree
from .field import PRESETS, apply_preset, description
from .images import is_stale
from .operators import CLASSES, LIBSHADE_OT_bake_scratches, LIBSHADE_OT_drop_scratch_images, LIBSHADE_OT_scratches_preset

_MANUAL = "blender/scratches.html"


class LibshadeScratchesNode(bpy.types.ShaderNodeCustomGroup):
    """Scratches from near to far: a normal that becomes roughness, a height and a mask"""

    bl_idname = SCRATCHES
    bl_label = scratch_tree.NAME
    bl_width_default = 240

    __annotations__ = {
        "unit": EnumProperty(
            name="Vector In", default="UV", description="What Vector counts",
            items=[("UV", "UV", "Units of a UV map, each as long as Size; unlinked: of that map"),
                   ("METRES", "Lengths", "As object coordinates do, in the scene's units; unlinked: those, along the object's sides")]),
        "size": FloatProperty(
            name="Size", subtype="DISTANCE", unit="LENGTH", min=1e-4, max=1e4, soft_max=10, default=0.1,
            description="Length that one unit of the UV map spans"),
        "uv_map": StringProperty(name="UV Map", description="Where nothing is linked to Vector; none: the active one"),
        "seed": IntProperty(name="Seed", description="Another one, other scratches of the same kind", default=1),
        "tile": FloatProperty(
            name="Tile", subtype="DISTANCE", unit="LENGTH", min=0, max=1e3, soft_max=10, default=0,
            description="Side of the square that repeats; 0: as that of the images, else as large as 200,000 scratches fill"),
        # What the images inside were made of; "" where there are none.
        "baked": StringProperty(options={"HIDDEN"}),
        **CHOSEN,
    }
    preset = preset_of_scripts(PRESETS, apply_preset)

    def init(self, _context):
        self.node_tree = scratch_tree.plain()

    def draw_buttons(self, context, layout):
        if not draw_on(self, layout):
            return
        layout.operator_menu_enum(LIBSHADE_OT_scratches_preset.bl_idname, "preset", text="Preset")
        layout.prop(self, "unit")
        if self.unit == "UV":
            layout.prop(self, "size")
        layout.prop(self, "seed")
        if scratch_tree.is_plain(self.node_tree):
            lines = layout.column(align=True)  # as wide as the sidebar at first
            lines.label(text="Not in Cycles, EEVEE", icon="INFO")
            lines.label(text="until baked", icon="BLANK1")
            layout.operator(LIBSHADE_OT_bake_scratches.bl_idname, icon="IMAGE_DATA")
            return
        if is_stale(self, context.scene):
            layout.label(text="Images are outdated", icon="ERROR")
        else:
            layout.label(text=f"Baked: {in_digits(100 * json.loads(self.baked)[-1])} cm tile", icon="INFO")
        row = layout.row(align=True)
        row.operator(LIBSHADE_OT_bake_scratches.bl_idname, text="Bake Again", icon="IMAGE_DATA")
        row.operator(LIBSHADE_OT_drop_scratch_images.bl_idname, text="", icon="X")

    def draw_buttons_ext(self, context, layout):
        self.draw_buttons(context, layout)
        if not is_enabled():
            return
        if self.unit == "UV":
            layout.prop(self, "uv_map")
        layout.prop(self, "tile")
        plan = _native.scratches(description(self, size.unit_of(context.scene)))
        layout.label(text=f"Repeats every {in_digits(100 * plan['tile'])} cm")
        if plan["fewer"]:
            layout.label(text=f"Only {in_digits(plan['density'])} per cm²", icon="ERROR")
        layout.operator("libshade.convert_to_group")
        draw_button(layout, _MANUAL)

    def draw_label(self):
        return self.bl_label


def _draw_add_menu(self, context):
    if context.space_data.tree_type == "ShaderNodeTree":
        add_button(self.layout, SCRATCHES, LibshadeScratchesNode.bl_label)


def register():
    register_node(LibshadeScratchesNode)
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.NODE_MT_add.append(_draw_add_menu)


def unregister():
    bpy.types.NODE_MT_add.remove(_draw_add_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    unregister_node(LibshadeScratchesNode)
