# SPDX-License-Identifier: GPL-3.0-or-later
"""The cloth node: a cloth by name, in two colours. Inside is a Principled BSDF of their mean, as other
renderers see it."""

from functools import lru_cache

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from . import _native
from .group import new_socket
from .manual import draw_button
from .report import draw_on

FABRIC = "LibshadeFabricNode"

_CLOTHS = {row["word"].upper(): row for row in _native.table()["cloths"]}
_FIRST = next(iter(_CLOTHS))
_SHADER, _MIX, _DARKEN = "Principled BSDF", "Mix", "Darken"


def settings(node):
    """What the native module is to know of a node's cloth."""
    return {"preset": node.preset.lower(), "size": node.size, "transmit": node.transmission,
            "open": node.open_gaps}


def cloths():
    """Words of the presets, and their rows in the native module's table."""
    return dict(_CLOTHS)


def own_colors(preset):
    """(warp, weft) of a preset as it is."""
    return _CLOTHS[preset]["warp"], _CLOTHS[preset]["weft"]


@lru_cache(maxsize=None)
def _brightness(preset):
    """Of the whole cloth beside that of its yarns' colours: they lie in each other's shadow."""
    row = _CLOTHS[preset]
    yarns = (1 - row["weft_share"]) * sum(row["warp"]) + row["weft_share"] * sum(row["weft"])
    return min(1.0, sum(_native.cloth_albedo(row["word"])) / yarns)


def _new_tree():
    """What other renderers see: the colours by what shows of each, as rough as the yarns are."""
    tree = bpy.data.node_groups.new("Libshade Fabric", "ShaderNodeTree")
    for name, color in zip(("Warp Color", "Weft Color"), own_colors(_FIRST)):
        new_socket(tree, name, "INPUT", "NodeSocketColor").default_value = (*color, 1.0)
    new_socket(tree, "Normal", "INPUT", "NodeSocketVector").hide_value = True
    new_socket(tree, "BSDF", "OUTPUT", "NodeSocketShader")

    inputs, outputs = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    mix, shader = tree.nodes.new("ShaderNodeMixRGB"), tree.nodes.new("ShaderNodeBsdfPrincipled")
    darken = tree.nodes.new("ShaderNodeMixRGB")
    inputs.location, mix.location, darken.location = (-700, 0), (-450, 0), (-200, 0)
    outputs.location = (300, 0)
    mix.name, darken.name, shader.name = _MIX, _DARKEN, _SHADER
    darken.blend_type, darken.inputs[0].default_value = "MULTIPLY", 1.0
    tree.links.new(inputs.outputs["Warp Color"], mix.inputs[1])
    tree.links.new(inputs.outputs["Weft Color"], mix.inputs[2])
    tree.links.new(mix.outputs[0], darken.inputs[1])
    tree.links.new(darken.outputs[0], shader.inputs["Base Color"])
    tree.links.new(inputs.outputs["Normal"], shader.inputs["Normal"])
    tree.links.new(shader.outputs["BSDF"], outputs.inputs["BSDF"])
    return tree


class LibshadeFabricNode(bpy.types.ShaderNodeCustomGroup):
    """Woven cloth, yarn by yarn from near, as a whole from afar"""

    bl_idname = FABRIC
    bl_label = "Libshade Fabric"
    bl_width_default = 200

    def _chosen(self, _context):
        for name, color in zip(("Warp Color", "Weft Color"), own_colors(self.preset)):
            self.inputs[name].default_value = (*color, 1.0)
        self.update_preview()

    __annotations__ = {
        "preset": EnumProperty(
            name="Cloth", description="What is woven how, of which yarns",
            items=[(word, row["label"], row["help"]) for word, row in _CLOTHS.items()],
            default=_FIRST, update=_chosen),
        "size": FloatProperty(
            name="Size", subtype="DISTANCE", unit="LENGTH", min=1e-4, max=1e4, soft_max=10,
            default=0.2, description="Length of cloth that one unit of the UV map spans"),
        "transmission": FloatProperty(
            name="Translucency", min=0, max=1, subtype="FACTOR", default=0,
            description="Share of the matt light that leaves the yarns on the other side"),
        "open_gaps": BoolProperty(
            name="Open Gaps", default=False,
            description="What is behind shows through between the yarns, in place of a lining"),
        # The tree inside also belongs to a copy of this node, until one of them changes.
        "shares_tree": BoolProperty(options={"HIDDEN"}),
    }

    def init(self, _context):
        self.node_tree = _new_tree()
        self.update_preview()

    def copy(self, node):
        self.shares_tree = node.shares_tree = True  # as LibshadeMetalNode.copy

    def update_preview(self):
        names = (_SHADER, _MIX, _DARKEN)
        if not (self.node_tree and all(self.node_tree.nodes.get(name) for name in names)):
            return  # someone has been inside
        if self.shares_tree:
            self.node_tree, self.shares_tree = self.node_tree.copy(), False
        row = _CLOTHS[self.preset]
        inner = self.node_tree.nodes
        inner[_MIX].inputs[0].default_value = row["weft_share"]
        inner[_DARKEN].inputs[2].default_value = (*[_brightness(self.preset)] * 3, 1.0)
        roughness = (2.0 / (row["exponent"] + 2.0)) ** 0.25  # its square is alpha
        inner[_SHADER].inputs["Roughness"].default_value = roughness

    def draw_buttons(self, _context, layout):
        draw_on(self, layout)
        layout.prop(self, "preset", text="")
        layout.prop(self, "size")

    def draw_buttons_ext(self, context, layout):
        self.draw_buttons(context, layout)
        layout.prop(self, "transmission")
        layout.prop(self, "open_gaps")
        layout.operator("libshade.convert_to_group")
        draw_button(layout, "#cloth")

    def draw_label(self):
        return "Libshade Fabric"


def _draw_add_menu(self, context):
    if context.space_data.tree_type == "ShaderNodeTree":
        add = self.layout.operator("node.add_node", text=LibshadeFabricNode.bl_label)
        add.type, add.use_transform = FABRIC, True


def register():
    if not bpy.types.Node.bl_rna_get_subclass_py(FABRIC):  # see nodes.unregister
        bpy.utils.register_class(LibshadeFabricNode)
    bpy.types.NODE_MT_add.append(_draw_add_menu)


def unregister():
    bpy.types.NODE_MT_add.remove(_draw_add_menu)
    if bpy.app.version >= (5, 0):
        bpy.utils.unregister_class(LibshadeFabricNode)
