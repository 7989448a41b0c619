# SPDX-License-Identifier: GPL-3.0-or-later
"""The scratches node: a field of libshade's over the surface, as a normal, a height and a mask. Our engine evaluates
it; what other renderers see of it is in scratch_tree.py."""

import json
import struct
import zlib
from math import isfinite, pi, remainder

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from . import _native, scratch_tree
from .export import size
from .group import add_button, preset_of_scripts, register_node, unregister_node
from .manual import draw_button
from .report import draw_on, is_enabled
from .scratch_tree import DENSITY, DEPTH, DIRECTION, LENGTH, NUMBERS, SPREAD, VECTOR, WIDTH

SCRATCHES = "LibshadeScratchesNode"
_MANUAL = "#scratches"

# By word: what it is called, is, and what the sockets say. By eye, after what is said of such surfaces.
PRESETS = {
    "FINE_POLISH": ("Fine Polish", "Hairlines any way, as a cloth and paste leave them",
                    {DENSITY: 1200.0, LENGTH: 4.0, WIDTH: 0.012, DEPTH: 0.06, DIRECTION: 0.0, SPREAD: 1.5707963}),
    "BRUSHED": ("Brushed", "Long strokes along x of Vector, as a belt of grit 180 leaves them",
                {DENSITY: 500.0, LENGTH: 25.0, WIDTH: 0.03, DEPTH: 0.12, DIRECTION: 0.0, SPREAD: 0.035}),
    "USED": ("Used", "Sparse scratches any way, as on what lies in a drawer",
             {DENSITY: 20.0, LENGTH: 8.0, WIDTH: 0.03, DEPTH: 0.15, DIRECTION: 0.0, SPREAD: 1.5707963}),
    "DEEP": ("Deep", "Few and wide ones, as of keys and gravel",
             {DENSITY: 1.5, LENGTH: 25.0, WIDTH: 0.15, DEPTH: 0.35, DIRECTION: 0.3, SPREAD: 0.9}),
}


def apply_preset(node, preset):
    for name, value in PRESETS[preset][2].items():
        node.inputs[name].default_value = value


def tile_of(node, unit):
    """Metres of the square that repeats: the node's own, else that of its images, so that all renderers show the same
    scratches; 0: as many scratches fill."""
    if isfinite(node.tile) and node.tile > 0:
        return node.tile * unit
    try:
        return float(json.loads(node.baked)[-1])
    except (ValueError, IndexError, TypeError):
        return 0.0


def description(node, unit, numbers=None):
    """What the native module is to know of a node's field. unit: metres in one of the scene's. numbers: of its sockets,
    by name, else their own."""
    said = {}
    for name, (key, least, most, initial, _about) in NUMBERS.items():
        value = numbers[name] if numbers else node.inputs[name].default_value
        said[key] = min(max(value, least), most) if isfinite(value) else initial
    return {**said, "seed": float(node.seed), "tile": tile_of(node, unit)}


def in_digits(number):
    """As people write numbers, without powers of ten."""
    digits = f"{number:.3g}"
    return f"{number:,.0f}" if abs(number) >= 1000 else f"{number:.6f}".rstrip("0").rstrip(".") if "e" in digits else digits


def metres(node, unit):
    """In a unit of Vector."""
    return unit * (node.size if node.unit == "UV" and isfinite(node.size) else 1.0)


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


# ---- images

_MADE = "libshade_scratch_images"  # on the tree: texels, samples, are they points?
_ALONG_X = 0.1  # radians
_SIZES = 512, 1024, 1536, 2048, 4096, 8192


def _source(node):
    """What feeds Vector, past reroutes: (kind of place for scratch_tree, UV map whose tangents fit or None)."""
    socket = node.inputs[VECTOR]
    while socket.is_linked:
        link = socket.links[0]
        source = link.from_node
        if source.bl_idname == "NodeReroute":
            socket = source.inputs[0]
        elif source.bl_idname == "ShaderNodeUVMap":
            return "VECTOR", source.uv_map
        else:
            return "VECTOR", "" if link.from_socket.name == "UV" and source.bl_idname == "ShaderNodeTexCoord" else None
    return ("UV", node.uv_map) if node.unit == "UV" else ("OBJECT", None)


def _stamp(node, unit, tile):
    """What images depend on. tile: of the images, metres."""
    said = description(node, unit)
    if not said["tile"] == node.tile * unit:  # it is that of the images themselves
        said["tile"] = 0.0
    return json.dumps([said, metres(node, unit), *_source(node), tile])


def is_stale(node, scene):
    try:
        tile = json.loads(node.baked)[-1]
    except (ValueError, IndexError):
        return True
    return node.baked != _stamp(node, size.unit_of(scene), tile)


def tile_of_images(said, texels):
    """Metres: a node's own; where it is chosen, so small that a third of a scratch's width is a texel, but two lengths."""
    if said["tile"] > 0:
        return said["tile"]
    wanted = max(texels * said["width"] / 3, 2 * said["length"]) * 1e-3
    return min(wanted, _native.scratches(said)["tile"])


def _image(name, values, floats):
    height, width, _channels = values.shape
    image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=floats, is_data=True)
    image.pixels.foreach_set(values.ravel())
    image.update()
    image.pack()
    return image


def _png(levels):
    """The file of a picture of bytes, height x width x 3 from the bottom: Blender's own packs half as tightly."""
    rows = levels[::-1].astype(np.uint8)
    height, width, _channels = rows.shape
    beside = rows.copy()
    beside[:, 1:] -= rows[:, :-1]
    kinds = [np.concatenate([np.full((height, 1), kind, np.uint8), values.reshape(height, -1)], 1) for kind, values in ((0, rows), (1, beside))]
    packed = min((zlib.compress(filtered.tobytes(), 9) for filtered in kinds), key=len)
    chunks = (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", packed), (b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
                                          for kind, data in chunks)


def _image_of_bytes(name, levels):
    file = _png(levels)
    image = bpy.data.images.new(name, levels.shape[1], levels.shape[0], alpha=False, is_data=True)
    image.pack(data=file, data_len=len(file))
    image.source = "FILE"
    image.colorspace_settings.is_data = True
    return image


def _points_of(said, texels):
    """Levels (256) of points of a field, and metres that level 0 of its height is deep. It has x and y of normals,
    of which level 128 is exactly 0, and the height, of which 255 is 0; no scratch has that, so that it says the mask, too.
    Where all strokes go along x, half as many points along them, and twice as many across."""
    along = abs(remainder(said["direction"], pi)) + said["spread"] < _ALONG_X and texels <= 2048  # of memory
    fine = 2 * texels if along else texels
    normal, height = (np.frombuffer(picture, np.float32).reshape(fine, fine, 4)[:, ::4 if along else 1]
                      for picture in _native.scratch_images(said, fine, 1)[:2])
    heights, levels = height[..., 0], np.rint(254 * normal[..., :3] - 127) + 128
    deepest = max(-float(heights.min()), 1e-12)
    levels[..., 2] = np.where(heights < 0, np.minimum(np.rint(255 + 255 * heights / deepest), 254), 255)
    return levels, deepest


def bake(node, owner, scene, texels=2048, samples=3, tile=0.0, points=False):
    """Images of one tile, in the node's group, which our engine repeats then, too; (metres that it is wide, what was
    left out). owner: whose name they get. tile: in the scene's units, becomes the node's own; 0: as the node has it.
    points: of points, by one image of 8 bits; else of means of samples^2 points, by three of floats."""
    unit = size.unit_of(scene)
    drop(node)
    if tile:
        node.tile = tile
    said = description(node, unit)
    said["tile"] = tile_of_images(said, texels)
    plan = _native.scratches(said)
    name, deepest = f"{owner} {node.name}", None
    if points:
        levels, deepest = _points_of(said, texels)
        images = [_image_of_bytes(name, levels)]
    else:
        data = _native.scratch_images(said, texels, samples)
        images = [_image(f"{name} {what}", np.frombuffer(picture, np.float32).reshape(texels, texels, 4), what != scratch_tree.MASK)
                  for what, picture in zip(("Normal", scratch_tree.HEIGHT, scratch_tree.MASK), data)]
    place, uv_map = _source(node)
    node.node_tree = scratch_tree.baked(images, place, metres(node, unit) / plan["tile"], uv_map, plan["tile"], unit, deepest)
    node.node_tree[_MADE] = [texels, samples, int(points)]
    node.baked = _stamp(node, unit, plan["tile"])
    return plan


def drop(node):
    """Other renderers see none again."""
    tree, node.node_tree, node.baked = node.node_tree, scratch_tree.plain(), ""
    if scratch_tree.is_plain(tree) or tree.users:
        return
    images = {inner.image for inner in tree.nodes if inner.bl_idname == "ShaderNodeTexImage" and inner.image}
    bpy.data.node_groups.remove(tree)
    for image in images:
        if not image.users:
            bpy.data.images.remove(image)


# ---- operators


class _OnScratches:
    """An operator on a scratches node that an editor shows."""

    @staticmethod
    def node_of(context):
        node = getattr(context, "node", None) or getattr(context, "active_node", None)
        return node if node and node.bl_idname == SCRATCHES else None

    @classmethod
    def poll(cls, context):
        node = cls.node_of(context)
        return node is not None and not node.id_data.library


class LIBSHADE_OT_scratches_preset(_OnScratches, bpy.types.Operator):
    """Give this Libshade Scratches the numbers of a worked or worn surface"""

    bl_idname = "libshade.scratches_preset"
    bl_label = "Scratches"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Scratches", description="What made them",
                         items=[(word, label, about) for word, (label, about, _values) in PRESETS.items()])

    def execute(self, context):
        apply_preset(self.node_of(context), self.preset)
        return {"FINISHED"}


class LIBSHADE_OT_bake_scratches(_OnScratches, bpy.types.Operator):
    """Make images of one tile of these scratches and put them inside the node, so that Cycles and EEVEE show them. \
They are packed into the file. Our engine then repeats the same square"""

    bl_idname = "libshade.bake_scratches"
    bl_label = "Bake to Images"
    bl_options = {"REGISTER", "UNDO"}

    size: EnumProperty(name="Size", description="Texels along a side; each image takes 16 bytes of memory a texel", default="2048",
                       items=[(str(n), f"{n} × {n}", "") for n in _SIZES])
    samples: IntProperty(name="Samples", description="Points along a texel that it is the mean of", min=1, max=8, default=3)
    tile: FloatProperty(name="Tile", subtype="DISTANCE", unit="LENGTH", min=0, max=1e3, default=0,
                        description="Side of the square that the images show; 0: the node's own, else one whose scratches "
                                    "are three texels wide, if that is two lengths")

    points: BoolProperty(
        name="Seen from Afar", default=False,
        description="Points, in one image of 8 bits, not means, in three of floats. From afar, where a pixel shows many, they are as "
                    "bright and as rough as the scratches, however fine these are; closely they look like coarse grains")

    def invoke(self, context, _event):
        node = self.node_of(context)
        node.id_data.nodes.active = node  # the one whose button it is: the dialog's OK knows no other
        made = node.node_tree.get(_MADE)  # images like those that there are
        if made and str(made[0]) in {str(n) for n in _SIZES}:
            self.size, self.samples, self.points = str(made[0]), made[1], bool(made[2])
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        node, texels = self.node_of(context), int(self.size)
        owner = next((m.name for m in bpy.data.materials if m.node_tree == node.id_data), node.id_data.name)
        plan = bake(node, owner, context.scene, texels, self.samples, self.tile, self.points)
        texel = 1e3 * plan["tile"] / texels
        self.report({"INFO"}, f"{texels} × {texels} texels of {texel:.3g} mm, which repeat every {in_digits(100 * plan['tile'])} cm, "
                              "are packed into the file")
        width = description(node, 1.0)["width"]
        if texel > width and not self.points:
            self.report({"WARNING"}, f"A texel is {texel / width:.2g} times as wide as a scratch: choose a smaller tile or more texels")
        if plan["fewer"]:
            self.report({"WARNING"}, f"There are no more than {in_digits(plan['density'])} scratches per cm²")
        return {"FINISHED"}


class LIBSHADE_OT_drop_scratch_images(_OnScratches, bpy.types.Operator):
    """Take the images out of this node again"""

    bl_idname = "libshade.drop_scratch_images"
    bl_label = "Remove Images"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        drop(self.node_of(context))
        return {"FINISHED"}


def _draw_add_menu(self, context):
    if context.space_data.tree_type == "ShaderNodeTree":
        add_button(self.layout, SCRATCHES, LibshadeScratchesNode.bl_label)


_CLASSES = (LIBSHADE_OT_scratches_preset, LIBSHADE_OT_bake_scratches, LIBSHADE_OT_drop_scratch_images)


def register():
    register_node(LibshadeScratchesNode)
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.NODE_MT_add.append(_draw_add_menu)


def unregister():
    bpy.types.NODE_MT_add.remove(_draw_add_menu)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    unregister_node(LibshadeScratchesNode)
