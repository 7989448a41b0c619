# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists do with a scratches node: choose a preset, bake images, remove them."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from ..names import SCRATCHES
from ..own_node import OnNode
from ..report import in_digits
from .field import PRESETS, apply_preset, description
from .images import MADE, SIZES, bake, drop


class LIBSHADE_OT_scratches_preset(OnNode, bpy.types.Operator):
    """Give this Libshade Scratches the numbers of a worked or worn surface"""

    kind = SCRATCHES
    bl_idname = "libshade.scratches_preset"
    bl_label = "Scratches"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Scratches", description="What made them",
                         items=[(word, label, about) for word, (label, about, _values) in PRESETS.items()])

    def execute(self, context):
        apply_preset(self.node_of(context), self.preset)
        return {"FINISHED"}


class LIBSHADE_OT_bake_scratches(OnNode, bpy.types.Operator):
    """Make images of one tile of these scratches and put them inside the node, so that Cycles and EEVEE show them. \
They are packed into the file. Our engine then repeats the same square"""

    kind = SCRATCHES
    bl_idname = "libshade.bake_scratches"
    bl_label = "Bake to Images"
    bl_options = {"REGISTER", "UNDO"}

    size: EnumProperty(name="Size", description="Texels along a side; each image takes 16 bytes of memory a texel", default="2048",
                       items=[(str(n), f"{n} × {n}", "") for n in SIZES])
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
        made = node.node_tree.get(MADE)  # images like those that there are
        if made and str(made[0]) in {str(n) for n in SIZES}:
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


class LIBSHADE_OT_drop_scratch_images(OnNode, bpy.types.Operator):
    """Take the images out of this node again"""

    kind = SCRATCHES
    bl_idname = "libshade.drop_scratch_images"
    bl_label = "Remove Images"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        drop(self.node_of(context))
        return {"FINISHED"}


CLASSES = (LIBSHADE_OT_scratches_preset, LIBSHADE_OT_bake_scratches, LIBSHADE_OT_drop_scratch_images)
