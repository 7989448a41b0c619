# SPDX-License-Identifier: GPL-3.0-or-later
"""Files with nodes of ours, as they are made and converted to plain groups, rendered by Cycles with the add-on, and opened without.

arguments: FOLDER with | without
"""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common


def make():
    """Metal with baked scratches in a colour and a roughness of its sockets, and cloth, side by side."""
    scene = common.empty_scene(48, 24)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 16, False, False
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=4)
    common.light(scene, rotation=(0.5, 0.2, 0))
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world).nodes["Background"].inputs[0].default_value = (0.5, 0.6, 0.8, 1)
    metal, tree, node = common.metal("metal")
    node.inputs["Color"].default_value, node.inputs["Roughness"].default_value = (0.9, 0.6, 0.2, 1), 0.5
    scratches = tree.nodes.new("LibshadeScratchesNode")
    sys.modules[common.MODULE + ".scratches"].bake(scratches, "metal", scene, 256, 1)
    tree.links.new(scratches.outputs["Normal"], node.inputs["Normal"])
    cloth = bpy.data.materials.new("cloth")
    tree = common.tree_of(cloth)
    tree.nodes.clear()
    node = tree.nodes.new("LibshadeFabricNode")
    node.preset = "DENIM"
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    for x, material in ((-1, metal), (1, cloth)):
        common.plane(material, 2).location = (x, 0, 0)


folder, how = common.arguments()
if how == "with":
    make()
else:
    assert common.MODULE not in bpy.context.preferences.addons
for what in "made", "converted":
    path = os.path.join(folder, f"{what}.blend")
    if how == "without":
        bpy.ops.wm.open_mainfile(filepath=path)
        assert common.MODULE not in bpy.context.preferences.addons
    else:
        if what == "converted":
            assert bpy.ops.libshade.convert_to_group(all_materials=True) == {"FINISHED"}
        bpy.ops.wm.save_as_mainfile(filepath=path)
    common.render(os.path.join(folder, f"{what}_{how}.exr"))
common.finish()
