# SPDX-License-Identifier: GPL-3.0-or-later
"""The cloth node: a cloth by name, in two colours. What other renderers see of it is in tree.py."""

from functools import lru_cache

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty

from .. import _native, nodes, working_space
from ..group import own_tree, renew
from ..manual import draw_button
from ..names import FABRIC
from ..own_node import NodePanel, add_button, register_node, unregister_node
from ..report import draw_on, in_digits, is_enabled
from . import draft, maps, size, yarns
from . import tree as fabric_tree
from .yarns import CUSTOM, DRAFT

_NAME = "Libshade Fabric"
_CLOTHS = {row["word"].upper(): row for row in _native.table()["cloths"]}
_FIRST = next(iter(_CLOTHS))
TRANSLUCENCY = "Translucency"


def settings(node, unit):
    """(what the native module is to know of a node's cloth, but for what its sockets say; what is wrong or ""). unit: metres
    in one of the scene."""
    made, trouble = yarns.settings(node, unit)
    return {**made, "open": node.open_gaps, **working_space.told("from_rec709", working_space.from_rec709())}, trouble


def socket_rules(node):
    """Does Translucency's socket say what the property does not?"""
    socket = node.inputs.get(TRANSLUCENCY)
    return bool(socket) and (socket.is_linked or socket.default_value != node.set_transmission)


def is_old(node):
    """Is it of a version with fewer sockets or no yarns inside, which no one has changed?"""
    return fabric_tree.is_stand_in(node.node_tree)


def update_node(tree, node):
    """A new tree inside, with all sockets; what the old ones said goes on to hold."""
    def fill(said):
        for name, _kind, _about, value, _limits in fabric_tree.SOCKETS:
            if value is not None:  # one in the place of an older socket has lost it
                node.inputs[name].default_value = value
        node.fill_sockets()
        for name, value in said.items():
            node.inputs[name].default_value = value
        node.transmission = node.transmission  # to its socket
        if not node.based_on:
            yarns.fill(node)

    renew(tree, node, fabric_tree.new_tree(), fill)


def cloths():
    """Words of the presets, and their rows in the native module's table."""
    return dict(_CLOTHS)


@lru_cache(maxsize=None)
def _brightness(preset):
    """Of the whole cloth beside that of its yarns' colours: they lie in each other's shadow."""
    row = _CLOTHS[preset]
    dyes = (1 - row["weft_share"]) * sum(row["warp"]) + row["weft_share"] * sum(row["weft"])
    return min(1.0, sum(_native.cloth_albedo(row["word"])) / dyes)


def _woven(node):
    """What its images are called."""
    if node.preset != CUSTOM:
        return _CLOTHS[node.preset]["label"]
    if node.weave == DRAFT:
        return node.draft.name if node.draft else "Draft"
    return yarns.WEAVES[node.weave]["label"]


def _said(node):
    """All that keyframes may change."""
    return [tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value
            for value in (getattr(node, name) for name in _SAID)]


class LibshadeFabricNode(bpy.types.ShaderNodeCustomGroup):
    """Woven cloth, yarn by yarn from near, as a whole from afar"""

    bl_idname = FABRIC
    bl_label = f"{_NAME} (woven cloth)"  # as LibshadeMetalNode
    bl_width_default = 200

    def fill_sockets(self):
        """What the preset says of them."""
        row = _CLOTHS[yarns.base(self)]
        said = {"Warp Color": (*working_space.here(row["warp"]), 1.0), "Weft Color": (*working_space.here(row["weft"]), 1.0),
                "Fuzz": row["nap"]}
        for name in fabric_tree.OF_PRESET:
            if name in self.inputs:  # not all on older nodes
                self.inputs[name].default_value = said[name]

    def _chosen(self, _context):
        if self.preset != CUSTOM:
            yarns.fill(self)
            self.fill_sockets()
        self.update_preview()

    def _has_length(self, _context):
        self.size_mode = "LENGTH"  # which is told to what is inside

    def _changed(self, _context):
        self.update_preview()

    def _transmits(self, _context):
        socket = self.inputs.get(TRANSLUCENCY)
        if socket:
            socket.default_value = self.transmission
            self.set_transmission = socket.default_value

    __annotations__ = {
        "preset": EnumProperty(
            name="Cloth", description="What is woven how, of which yarns",
            items=[(word, row["label"], row["help"], k) for k, (word, row) in enumerate(_CLOTHS.items())]
            + [(CUSTOM, "Custom", "Its own weave and yarns", 1000)],
            default=_FIRST, update=_chosen),
        **yarns.properties(_has_length, _changed),
        "transmission": FloatProperty(
            name="Translucency", min=0, max=1, subtype="FACTOR", default=0,
            description="Sets the socket Translucency, which older nodes do not have", update=_transmits),
        "open_gaps": BoolProperty(
            name="Open Gaps", default=False,
            update=_changed,
            description="What is behind shows through between the yarns, in place of a lining"),
        "repeat_mm": FloatVectorProperty(size=2, options={"HIDDEN"}),  # of the weave, where Scale is 1
        "set_transmission": FloatProperty(options={"HIDDEN"}),  # what it last set the socket to
        # The tree inside also belongs to a copy of this node, until one of them changes.
        "shares_tree": BoolProperty(options={"HIDDEN"}),
    }

    def init(self, _context):
        self.name = _NAME
        self.node_tree = fabric_tree.new_tree()
        self.size_mode = "REAL"
        self._chosen(None)

    def copy(self, node):
        self.shares_tree = node.shares_tree = True  # as LibshadeMetalNode.copy

    def follow(self, animated):
        """What keyframes and drivers make of the properties, for what is inside; that of a linked cloth would show this file's images."""
        if self.id_data.library:
            return
        socket = self.inputs.get(TRANSLUCENCY)
        if socket and not socket_rules(self):
            socket.default_value = animated.transmission
            self.set_transmission = socket.default_value
        self.update_preview(by=animated)

    def update_preview(self, unit=None, by=None):
        """Carry the settings (of `by`) over to what is inside. unit: metres in one of the scene, if it is not the one that is open."""
        by = by or self
        if not fabric_tree.can_update(self.node_tree):
            return
        own_tree(self)
        base = yarns.base(by)
        if fabric_tree.is_stand_in(self.node_tree):
            fabric_tree.update_stand_in(self.node_tree, yarns.weft_share(by), _brightness(base),
                                        _CLOTHS[base]["exponent"])
            return
        if unit is None:
            unit = fabric_tree.scene_unit()
            size.note_unit(getattr(bpy.context, "scene", None))
        made, _trouble = settings(by, unit)
        pictures = maps.of(made)
        if by != self and not maps.may_show(pictures):
            return
        if by.size_mode == "REAL":  # counts are of a metre
            self.repeat_mm = [1000 * count / per for count, per in zip(pictures["repeat"], pictures["per_unit"])]
        fabric_tree.update(self.node_tree, pictures, f"Libshade {_woven(by)}", size.space_of(self, by.size_mode), unit,
                           by.open_gaps)

    def draw_buttons(self, _context, layout):
        if not draw_on(self, layout):
            return
        layout.prop(self, "preset", text="")
        if is_old(self):
            layout.operator("libshade.update_nodes", icon="FILE_REFRESH")
        if fabric_tree.NEW[0] not in self.inputs:
            layout.prop(self, "size")
            return
        layout.prop(self, "size_mode")
        if self.size_mode != "REAL":
            layout.prop(self, "size" if self.size_mode == "LENGTH" else "repeats")
        scale = self.inputs["Scale"]
        if self.size_mode == "REAL" and self.repeat_mm[0] and scale.default_value and not scale.is_linked:
            sides = (abs(side / scale.default_value) for side in self.repeat_mm)
            layout.label(text="Repeat: {} × {} mm".format(*map(in_digits, sides)))  # too small to be seen?
        if not is_old(self):
            lines = layout.column(align=True)  # as wide as the sidebar at first
            lines.label(text="In Cycles, EEVEE", icon="INFO")
            lines.label(text="approximate", icon="BLANK1")
            if self.size_mode == "REAL":
                layout.operator("libshade.measure_cloth", icon="ARROW_LEFTRIGHT")

    def draw_buttons_ext(self, context, layout):
        self.draw_buttons(context, layout)
        if not is_enabled():
            return
        if TRANSLUCENCY not in self.inputs:
            layout.prop(self, "transmission")
        layout.prop(self, "open_gaps")
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False  # its name has room
        column.prop(self, "distance")
        if self.based_on:
            column.prop(self, "weave")
            if self.weave == DRAFT:
                layout.template_ID(self, "draft", new="text.new", open="text.open")
                layout.prop(self, "draft_colors")
            layout.operator("libshade.import_wif", icon="IMPORT")
            layout.prop(self, "ends_per_cm")
            layout.prop(self, "picks_per_cm")
        layout.operator("libshade.convert_to_group")
        draw_button(layout, "blender/fabric.html")

    def draw_label(self):
        return _NAME


_SAID = [name for name in LibshadeFabricNode.__annotations__
         if name not in ("based_on", "draft", "distance", "repeat_mm", "set_transmission", "shares_tree")]


def _draw_add_menu(self, context):
    if context.space_data.tree_type == "ShaderNodeTree":
        add_button(self.layout, FABRIC, LibshadeFabricNode.bl_label)


class _Yarns(NodePanel):
    kind = FABRIC

    @classmethod
    def poll(cls, context):
        return super().poll(context) and bool(context.active_node.based_on)

    def draw(self, context):
        column, node = self.layout.column(align=True), context.active_node  # names in the sliders have room
        for word in yarns.numbers():
            column.prop(node, f"{self.yarn}_{word}")


class NODE_PT_libshade_warp(_Yarns, bpy.types.Panel):
    bl_label, yarn = "Warp", "warp"


class NODE_PT_libshade_weft(_Yarns, bpy.types.Panel):
    bl_label, yarn = "Weft", "weft"


_PANELS = (NODE_PT_libshade_warp, NODE_PT_libshade_weft)


def register():
    nodes.UPDATES[FABRIC], nodes.FOLLOWED[FABRIC] = (is_old, update_node), _said
    register_node(LibshadeFabricNode)
    for panel in _PANELS:
        bpy.utils.register_class(panel)
    draft.register()
    size.register()
    bpy.types.NODE_MT_add.append(_draw_add_menu)


def unregister():
    bpy.types.NODE_MT_add.remove(_draw_add_menu)
    size.unregister()
    draft.unregister()
    for panel in reversed(_PANELS):
        bpy.utils.unregister_class(panel)
    unregister_node(LibshadeFabricNode)
