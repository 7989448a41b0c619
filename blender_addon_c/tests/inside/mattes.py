# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomatte of plates over one another, one of them seen through, two of them one asset: mattes.py FILE ENGINE"""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402

path, engine = common.arguments()
scene = common.empty_scene(32, 32, samples=256)
for number, name in enumerate(("plate", "Ünï", "a.001", "fourth")):
    material = bpy.data.materials.new(f"of {name}")
    tree = common.tree_of(material)
    if name == "a.001":
        mixed, shines, clear = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixShader", "Emission", "BsdfTransparent"))
        mixed.inputs[0].default_value = 0.4
        tree.links.new(clear.outputs[0], mixed.inputs[1])
        tree.links.new(shines.outputs[0], mixed.inputs[2])
        tree.links.new(mixed.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    plate = common.plane(material, 1.3)
    plate.name, plate.rotation_euler = name, (0, 0, 0.3 * number)
    plate.location = (-0.6 + 0.45 * number, 0.3 * (number % 2) - 0.2, 0.1 * number)
    plate.parent = bpy.data.objects["plate"] if number == 1 else None
common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=3)
for kind in ("object", "material", "asset"):
    setattr(scene.view_layers[0], f"use_pass_cryptomatte_{kind}", True)
scene.render.engine = engine
if engine == "CYCLES":
    settings = scene.cycles
    settings.samples, settings.use_denoising, settings.use_adaptive_sampling = 256, False, False
else:
    settings = scene.libshade
settings.pixel_filter_type, settings.filter_width = "BLACKMAN_HARRIS", 1.5
image = scene.render.image_settings
if hasattr(image, "media_type"):
    image.media_type = "MULTI_LAYER_IMAGE"
image.file_format, image.color_depth = "OPEN_EXR_MULTILAYER", "32"
common.render(path)
common.finish()
