# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual, which comes with the add-on: buttons, and Blender's own Online Manual (F1) of what is ours."""

from pathlib import Path

import bpy

_PAGE = Path(__file__).resolve().parent / "manual" / "index.html"

# Of Blender's names of what the mouse is over, in lower case, the first that fits; where the manual tells of it.
_PLACES = (
    ("bpy.types.libshademetalnode*", "#libshade-metal"),
    ("bpy.types.libshadefabricnode*", "#cloth"),
    ("bpy.types.libshadescratchesnode*", "#scratches"),
    ("bpy.ops.libshade.*scratch*", "#scratches"),
    ("bpy.ops.libshade.import_wif*", "#cloth"),
    ("bpy.ops.libshade.measure_cloth*", "#cloth"),
    ("bpy.ops.libshade.metal_preset*", "#libshade-metal"),
    ("bpy.ops.libshade.measured_metal*", "#libshade-metal"),
    ("bpy.ops.libshade.update_nodes*", "#libshade-metal"),
    ("bpy.ops.libshade.follow_bumps*", "#grooves-that-follow-bumps-in-cycles"),
    ("bpy.ops.libshade.add_groove*", "#grooves-that-follow-bumps-in-cycles"),
    ("bpy.ops.libshade.*_assets*", "#assets"),
    ("bpy.types.libshade*settings*", "#rendering"),
    ("bpy.ops.libshade.*", "#libshade-in-blender"),
)


def url(place=""):
    return _PAGE.as_uri() + place


def draw_button(layout, place="", text="Manual"):
    layout.operator("wm.url_open", text=text, icon="HELP").url = url(place)


def _places():
    return url(), _PLACES


def register():
    bpy.utils.register_manual_map(_places)


def unregister():
    bpy.utils.unregister_manual_map(_places)
