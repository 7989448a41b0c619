# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes saved for shade-render: what the native module would render."""

import os

import bpy
from bpy_extras.io_utils import ExportHelper

from . import export, scene_file
from .names import ENGINE

_chosen = None  # the operator's file, while it renders


def place_of(depsgraph, view):
    """(path or "", is only that wanted and no picture?). view: one eye's name. Each view layer and eye has a file of its own."""
    path = _chosen or os.environ.get("LIBSHADE_SCENE", "")
    layers = [layer for layer in depsgraph.scene.view_layers if layer.use]
    stem, end = os.path.splitext(path)
    parts = [stem, *([bpy.path.clean_name(depsgraph.view_layer.name)] if len(layers) > 1 else []), *([view] if view else [])]
    return "-".join(parts) + end if path else "", bool(_chosen)


def write(path, layer, scene, passes, exposure, others, texts):
    """passes: export's, of the scene; others: (scene, pass, its channels, exposure) of each that is a picture of its own; texts:
    of the rendered file's header."""
    if scene["catchers"]["seen"]:
        raise export.SceneError("a scene with shadow catchers cannot be saved")
    main = [("Combined", "RGBA", "", exposure)]
    main += [(p.name, p.channels, p.plane, exposure if export.is_light(p) else 1.0) for p in passes
             if p.plane not in (export.AOV, export.CATCHER)]
    try:
        scene_file.write(path, layer, [(scene, main), *((view, [(name, channels, "", by)]) for view, name, channels, by in others)], texts)
    except (OSError, ValueError) as error:
        raise export.SceneError(f"the scene cannot be saved: {error}") from error


class LIBSHADE_OT_save_scene(bpy.types.Operator, ExportHelper):
    """Write what would be rendered now, in this frame, to a file that shade-render renders without Blender. What the render result \
shows is empty then"""
    bl_idname = "libshade.save_scene"
    bl_label = "Save Scene for libshade"

    filename_ext = ".shscene"
    filter_glob: bpy.props.StringProperty(default="*.shscene", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def execute(self, _context):
        global _chosen
        _chosen = bpy.path.abspath(self.filepath)
        try:
            bpy.ops.render.render()
        except RuntimeError as error:  # of the engine, which has said it
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            _chosen = None
        self.report({"INFO"}, f"Saved for shade-render: {self.filepath}")
        return {"FINISHED"}


def register():
    bpy.utils.register_class(LIBSHADE_OT_save_scene)


def unregister():
    bpy.utils.unregister_class(LIBSHADE_OT_save_scene)
