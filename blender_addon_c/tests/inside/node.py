# SPDX-License-Identifier: GPL-3.0-or-later
"""The metal and the cloth node without a render; asserts. arguments: none"""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common


def near(a, b):
    return abs(a - b) <= 1e-5 * max(abs(a), abs(b), 1e-3)


def test_sockets(node):
    assert [s.name for s in node.inputs] == ["Color", "Normal", "Tangent"]
    assert [s.name for s in node.outputs] == ["BSDF"]
    assert node.detail == "ROTATE" and node.distribution == "ASHIKHMIN_SHIRLEY"
    assert node.groove == "AUTO" and node.fresnel == "SCHLICK" and node.horizon == "VALID_ESTEVEZ"
    assert near(node.ex, 200) and near(node.ey, 10)


def test_twins(node):
    """e = max(0, 2/α² − 2), and back; a round trip changes nothing."""
    node.ex = 6170.84
    assert near(node.ax, 0.018), node.ax
    assert near(node.ex, 6170.84)
    node.ay = 0.45
    assert near(node.ey, 7.876543), node.ey
    assert near(node.ay, 0.45)
    node.ax = 3
    assert node.ex == 0 and node.ax == 3
    node.ex = 0
    assert near(node.ax, 1)
    node.ex = -5
    assert node.ex == 0
    node.ax = 0
    assert 0 < node.ax <= 1e-3


def test_preview(node):
    """Cycles' Principled BSDF, α = r²/a and r²·a with a² = 1 − 0.9 anisotropic, has our alphas."""
    for ax, ay in ((0.2, 0.1), (0.1, 0.2), (0.15, 0.15)):
        node.ax, node.ay = ax, ay
        principled = node.node_tree.nodes["Principled BSDF"]
        roughness, anisotropic, rotation = (principled.inputs[n].default_value for n in (
            "Roughness", "Anisotropic", "Anisotropic Rotation"))
        aspect = (1 - 0.9 * anisotropic) ** 0.5
        alphas = roughness**2 / aspect, roughness**2 * aspect
        if rotation:
            alphas = alphas[::-1]
        assert near(alphas[0], ax) and near(alphas[1], ay), (alphas, ax, ay)


def test_copies(material, node):
    """A copy's settings are its own, those of the node inside too, whichever is changed."""
    def inside(node):
        return node.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value

    other = material.copy().node_tree.nodes[node.name]
    before = inside(node)
    assert inside(other) == before
    other.ex = other.ey = 5
    assert inside(node) == before != inside(other)
    third = material.copy().node_tree.nodes[node.name]
    node.ex = node.ey = 50
    assert inside(third) == before != inside(node)
    node.ax = node.ay = 0.15
    assert node.node_tree.users > 0


def test_save_and_load(path):
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    common.enable()
    node = bpy.data.materials["metal"].node_tree.nodes["Libshade Metal"]
    assert near(node.ay, 0.15) and node.node_tree
    return node


def test_convert(node):
    """The group has the node's tree, values and links; nothing of libshade is left."""
    tree = bpy.data.materials["metal"].node_tree
    image = common.image_node(tree, bpy.data.images.new("image", 4, 4))
    tree.links.new(image.outputs["Color"], node.inputs["Color"])
    inner = node.node_tree
    assert bpy.ops.libshade.convert_to_group(all_materials=True) == {"FINISHED"}
    group = tree.nodes["Libshade Metal"]
    assert group.bl_idname == "ShaderNodeGroup" and group.node_tree == inner
    assert group.inputs["Color"].links[0].from_node == image
    assert group.outputs["BSDF"].links[0].to_node.type == "OUTPUT_MATERIAL"
    assert not any(n.bl_idname == "LibshadeMetalNode" for m in bpy.data.materials
                   for n in m.node_tree.nodes)


def test_fabric():
    """A preset's colours are the sockets'; the mean inside follows what shows; a copy is its own."""
    tree = common.tree_of(bpy.data.materials.new("cloth"))
    node = tree.nodes.new("LibshadeFabricNode")
    assert [s.name for s in node.inputs] == ["Warp Color", "Weft Color", "Normal"]
    before = [tuple(s.default_value) for s in list(node.inputs)[:2]]
    node.preset = "DENIM"
    warp, weft = (tuple(s.default_value)[:3] for s in list(node.inputs)[:2])
    assert before != [warp, weft] and warp[2] > 2 * warp[0] and weft[0] > 0.3, (warp, weft)
    assert near(node.node_tree.nodes["Mix"].inputs[0].default_value, 0.25)  # twill 3/1
    tree.links.new(node.outputs["BSDF"], tree.get_output_node("ALL").inputs["Surface"]
                   if tree.get_output_node("ALL") else
                   tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    inner = node.node_tree
    assert bpy.ops.libshade.convert_to_group(all_materials=True) == {"FINISHED"}
    assert any(n.bl_idname == "ShaderNodeGroup" and n.node_tree == inner for n in tree.nodes)


def test_disable_and_enable():
    """Switching the add-on off and on with a rendered node in the file; Blender must survive."""
    material, _tree, _node = common.metal("again")
    common.plane(material)
    bpy.context.view_layer.update()
    bpy.ops.preferences.addon_disable(module=common.MODULE)
    common.enable()
    assert common.metal("third")[2].ex == 200
    bpy.ops.preferences.addon_disable(module=common.MODULE)
    bpy.ops.wm.read_homefile(use_empty=True)


blend, = common.arguments()
common.empty_scene()
material, _tree, node = common.metal()
material.use_fake_user = True
test_sockets(node)
test_twins(node)
test_preview(node)
test_copies(material, node)
test_convert(test_save_and_load(blend))
test_fabric()
test_disable_and_enable()
print("all asserted")
common.finish()
