# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene saved for shade-render and rendered with all passes, to saved.shscene and saved.exr. What the operator saves goes to
operator.shscene. arguments: FOLDER SCRIPT [of an example, its arguments]"""

import os
import runpy
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

folder, script, *given = common.arguments()
sys.dont_write_bytecode = True  # beside an example
common.enable()


@bpy.app.handlers.persistent
def hasty(scene, *_):
    """Whatever the script renders."""
    scene.render.engine, scene.render.resolution_percentage, scene.libshade.samples = "LIBSHADE", 1, 1


def all_passes(layer):
    for name in layer.bl_rna.properties.keys():
        if name.startswith("use_pass_") and not name.endswith(("subsurface_direct", "shadow_catcher")):
            setattr(layer, name, True)
    layer.libshade.pass_debug_sample_count = layer.libshade.denoising_store_passes = True
    layer.use_pass_cryptomatte_object = layer.use_pass_cryptomatte_asset = True
    for kind in ("COLOR", "VALUE"):
        layer.aovs.add().type = kind


bpy.app.handlers.render_init.append(hasty)
sys.argv = ["blender", "--", *given]
runpy.run_path(script, run_name="__main__")
bpy.app.handlers.render_init.clear()
scene = bpy.context.scene
scene.render.engine, scene.libshade.samples, scene.libshade.seed = "LIBSHADE", 4, 7
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 40, 100
scene.cycles.film_exposure = 1.3
all_passes(bpy.context.view_layer)
bpy.ops.libshade.save_scene(filepath=os.path.join(folder, "operator.shscene"))
common.write_multilayer(scene)
scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "ZIP"
os.environ["LIBSHADE_SCENE"] = os.path.join(folder, "saved.shscene")
common.render(os.path.join(folder, "saved.exr"))
del os.environ["LIBSHADE_SCENE"]
common.finish()
