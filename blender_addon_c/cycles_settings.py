# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that a file has for Cycles, taken over for our engine: these of ours have Cycles' names and meanings."""

import bpy

from .properties import LibshadeSettings, LibshadeViewLayerSettings


def shared(settings, cycles):
    """Names of settings of ours that Cycles has, too."""
    of = LibshadeSettings if isinstance(settings, LibshadeSettings) else LibshadeViewLayerSettings
    return [name for name in of.__annotations__ if name in cycles.bl_rna.properties]


def copy(settings, cycles):
    """Takes them over, within our ranges; returns names of those that are others now."""
    names = shared(settings, cycles)
    before = [getattr(settings, name) for name in names]
    for name in names:
        setattr(settings, name, getattr(cycles, name))
    return [name for name, was in zip(names, before) if getattr(settings, name) != was]


class LIBSHADE_OT_copy_cycles_settings(bpy.types.Operator):
    """Take over samples, bounces, clamping, filters and passes as this file has them for Cycles, in this scene and its view layers"""
    bl_idname = "libshade.copy_cycles_settings"
    bl_label = "Copy Settings from Cycles"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if context.scene and hasattr(context.scene, "cycles"):
            return True
        cls.poll_message_set("The Cycles add-on is not enabled")
        return False

    def execute(self, context):
        scene = context.scene
        pairs = [(scene.libshade, scene.cycles), *((layer.libshade, layer.cycles) for layer in scene.view_layers)]
        changed = [settings.bl_rna.properties[name].name for settings, cycles in pairs for name in copy(settings, cycles)]
        said = ", ".join(dict.fromkeys(changed))
        self.report({"INFO"}, f"As in Cycles now: {said}" if said else "All was as in Cycles already")
        return {"FINISHED"}


def register():
    bpy.utils.register_class(LIBSHADE_OT_copy_cycles_settings)


def unregister():
    bpy.utils.unregister_class(LIBSHADE_OT_copy_cycles_settings)
