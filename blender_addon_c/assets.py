# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: its asset library, which users may have among theirs, and whether renders tell their timings."""

import os
import sys

import bpy

from .manual import draw_button

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "assets")
NAME = "Libshade"


def _libraries():
    return bpy.context.preferences.filepaths.asset_libraries


def registered():
    """The user's library that is ours, or None: by its place, or by its name and what no longer exists."""
    for library in _libraries():
        path = os.path.normpath(bpy.path.abspath(library.path))
        if path == FOLDER or library.name == NAME and not os.path.isdir(path):
            return library
    return None


def _repair():
    """After an update the folder may be elsewhere."""
    library = registered()
    if library and os.path.isdir(FOLDER) and os.path.normpath(library.path) != FOLDER:
        library.path = FOLDER


def _import_by_appending(library):
    """What comes out of it can be edited; from 5.0 on its own words for that are fewer than it lists."""
    for method in ("APPEND_REUSE", "APPEND") if hasattr(library, "import_method") else ():  # 3.5 and later
        try:
            library.import_method = method
            return
        except TypeError:
            pass


class LIBSHADE_OT_add_assets(bpy.types.Operator):
    """Show libshade's metals, cloths, scratches and groove groups in the Asset Browser, as a library of these preferences"""

    bl_idname = "libshade.add_assets"
    bl_label = "Add Assets to the Asset Browser"

    def execute(self, _context):
        if not os.path.isdir(FOLDER):
            self.report({"ERROR"}, f"{FOLDER} is not there: install the add-on from its zip")
            return {"CANCELLED"}
        if not registered():
            before = {library.name for library in _libraries()}
            bpy.ops.preferences.asset_library_add(directory=FOLDER)
            library = next((item for item in _libraries() if item.name not in before), None)
            if not library:
                self.report({"ERROR"}, "Blender added no library")
                return {"CANCELLED"}
            library.name, library.path = NAME, FOLDER
            _import_by_appending(library)
        bpy.context.preferences.is_dirty = True
        return {"FINISHED"}


class LIBSHADE_OT_remove_assets(bpy.types.Operator):
    """Take libshade's library off these preferences; what files use of it stays"""

    bl_idname = "libshade.remove_assets"
    bl_label = "Remove Assets from the Asset Browser"

    def execute(self, _context):
        library = registered()
        if not library:
            return {"CANCELLED"}
        bpy.ops.preferences.asset_library_remove(index=list(_libraries()).index(library))
        bpy.context.preferences.is_dirty = True
        return {"FINISHED"}


def tells_timings():
    """Shall a render's report say where its time went?"""
    addon = bpy.context.preferences.addons.get(__package__)
    return bool(os.environ.get("LIBSHADE_TIMINGS")) or getattr(addon and addon.preferences, "timings", False)


class LibshadePreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    timings: bpy.props.BoolProperty(name="Tell Timings", default=False, description=(
        "A render's report says where its time went, for those who look for what is slow"))

    def draw(self, _context):
        if getattr(sys.modules[__package__], "updated", False):
            self.layout.label(text="Updated: until Blender is started again the version before runs", icon="ERROR")
        row = self.layout.row()
        if registered():
            row.label(text=f"Asset library: {NAME}", icon="ASSET_MANAGER")
            row.operator(LIBSHADE_OT_remove_assets.bl_idname, text="Remove Library")
        else:
            row.operator(LIBSHADE_OT_add_assets.bl_idname, icon="ASSET_MANAGER")
        draw_button(row)
        self.layout.prop(self, "timings")


_CLASSES = (LIBSHADE_OT_add_assets, LIBSHADE_OT_remove_assets, LibshadePreferences)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    _repair()


def unregister():
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
