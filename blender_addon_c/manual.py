# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual, which comes with the add-on: buttons, and Blender's own Online Manual (F1) of what is ours."""

from pathlib import Path

import bpy

_FOLDER = Path(__file__).resolve().parent / "manual"

# Of Blender's names of what the mouse is over, in lower case, the first that fits; where the manual tells of it.
_PLACES = (
    ("bpy.types.libshademetalnode*", "blender/metal.html"),
    ("bpy.types.libshadefabricnode*", "blender/fabric.html"),
    ("bpy.types.libshadescratchesnode*", "blender/scratches.html"),
    ("bpy.ops.libshade.scratches_preset*", "blender/scratches.html#preset"),
    ("bpy.ops.libshade.*scratch*", "blender/scratches.html#bake-to-images"),
    ("bpy.ops.libshade.import_wif*", "blender/fabric.html#import-wif"),
    ("bpy.ops.libshade.measure_cloth*", "blender/fabric.html#measure-for-cycles"),
    ("bpy.ops.libshade.metal_preset*", "blender/metal.html#preset"),
    ("bpy.ops.libshade.measured_metal*", "blender/metal.html#measured-metal"),
    ("bpy.ops.libshade.update_nodes*", "blender/metal.html#nodes-of-older-files"),
    ("bpy.ops.libshade.follow_bumps*", "blender/grooves-in-cycles.html#make-grooves-follow-bumps"),
    ("bpy.ops.libshade.add_groove*", "blender/grooves-in-cycles.html#make-grooves-follow-bumps"),
    ("bpy.ops.libshade.*_assets*", "blender/assets.html#add-the-library"),
    ("bpy.ops.libshade.convert_to_group*", "blender/assets.html#files-for-blenders-without-the-add-on"),
    ("bpy.ops.libshade.save_scene*", "blender/rendering.html#without-blender"),
    ("bpy.ops.libshade.copy_cycles_settings*", "blender/rendering.html#start-from-a-file-for-cycles"),
    ("bpy.types.libshade*settings*", "blender/rendering.html"),
    ("bpy.ops.libshade.*", "start/blender.html"),
)


def url(place=""):
    return _FOLDER.as_uri() + "/" + place


def draw_button(layout, place="start/blender.html", text="Manual"):
    layout.operator("wm.url_open", text=text, icon="HELP").url = url(place)


def _places():
    return url(), _PLACES


def register():
    bpy.utils.register_manual_map(_places)


def unregister():
    bpy.utils.unregister_manual_map(_places)
