# SPDX-License-Identifier: GPL-3.0-or-later
"""The metal and the cloth node without a render; asserts. arguments: none"""

import os
import sys
from types import SimpleNamespace

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common


def near(a, b):
    return abs(a - b) <= 1e-5 * max(abs(a), abs(b), 1e-3)


def test_sockets(node):
    assert [s.name for s in node.inputs] == [
        "Color", "Roughness", "Anisotropy", "Rotation", "Diffuse Color", "Normal", "Tangent"]
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
    """Cycles' Anisotropic BSDF, α = r² (1 − a) and r²/(1 − a), a < 0: r²/(1 + a) and r² (1 + a), has our alphas."""
    inner = node.node_tree.nodes
    shader = inner["Anisotropic BSDF"]
    for ax, ay in ((0.2, 0.1), (0.018, 0.45), (0.15, 0.15)):
        node.ax, node.ay = ax, ay
        r, a = (shader.inputs[n].default_value for n in ("Roughness", "Anisotropy"))
        alphas = (r * r / (1 + a), r * r * (1 + a)) if a < 0 else (r * r * (1 - a), r * r / (1 - a))
        assert near(alphas[0], ax) and near(alphas[1], ay), (alphas, ax, ay)
    # the tangent of strokes by where they lie (groove.py renders them)
    strokes = inner["Strokes"]
    factor, along, across = (next(s for s in strokes.inputs if s.identifier == word)
                             for word in ("Factor_Float", "A_Vector", "B_Vector"))
    assert shader.inputs["Tangent"].links[0].from_node == strokes
    assert (along.links[0].from_socket.name, across.links[0].from_socket.name) == ("Tangent", "Strokes Across")
    for groove, expected in (("Y", 1), ("X", 0), ("AUTO", None)):
        node.groove = groove
        assert factor.is_linked == (expected is None) and (factor.is_linked or factor.default_value == expected)
    node.groove, node.kd, node.distribution = "AUTO", (0.1, 0.2, 0.3), "GGX"
    assert [near(a, b) for a, b in zip(inner["Diffuse BSDF"].inputs["Color"].default_value, (0.1, 0.2, 0.3))]
    assert shader.distribution == "GGX"
    node.kd, node.distribution, node.fresnel = (0, 0, 0), "ASHIKHMIN_SHIRLEY", "CONDUCTOR"
    color = inner["Color"].inputs["Color1"]
    assert not color.is_linked and near(color.default_value[0], (0.25 + 9) / (2.25 + 9))
    node.fresnel = "SCHLICK"
    assert color.is_linked and shader.distribution == "ASHIKHMIN_SHIRLEY"
    assert [g.name for g in bpy.data.node_groups if g.get("libshade_groove")] == ["Libshade Groove"]


def test_properties_set_sockets(node):
    """Cycles' formulas of roughness and anisotropy, on the sockets; a socket's own value stays until a
    property of the same thing is set."""
    roughness, amount = node.inputs["Roughness"], node.inputs["Anisotropy"]
    for ax, ay in ((0.2, 0.1), (0.01, 1.0), (0.15, 0.15)):
        node.ax, node.ay = ax, ay
        r, a = roughness.default_value, amount.default_value
        alphas = (r * r / (1 + a), r * r * (1 + a)) if a < 0 else (r * r * (1 - a), r * r / (1 - a))
        assert near(alphas[0], ax) and near(alphas[1], ay), (alphas, ax, ay)
    roughness.default_value = 0.75
    node.detail, node.kd = "NONE", (0.1, 0.2, 0.3)
    assert roughness.default_value == 0.75
    assert [near(a, b) for a, b in zip(node.inputs["Diffuse Color"].default_value, (0.1, 0.2, 0.3))] == [True] * 3
    node.ay = 0.15
    assert near(roughness.default_value, 0.15 ** 0.5)


def test_old_files(node):
    """A node of a file with a Principled BSDF inside keeps it."""
    tree = node.node_tree = bpy.data.node_groups.new("old", "ShaderNodeTree")
    principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
    for ax, ay in ((0.2, 0.1), (0.1, 0.2), (0.15, 0.15)):
        node.ax, node.ay = ax, ay
        roughness, anisotropic, rotation = (principled.inputs[n].default_value for n in (
            "Roughness", "Anisotropic", "Anisotropic Rotation"))
        aspect = (1 - 0.9 * anisotropic) ** 0.5
        alphas = roughness**2 / aspect, roughness**2 * aspect
        if rotation:
            alphas = alphas[::-1]
        assert near(alphas[0], ax) and near(alphas[1], ay), (alphas, ax, ay)
    tree.nodes.clear()
    node.ax = 0.3  # someone has been inside: nothing to do


def test_metals():
    """Each preset is what it is called, as a person would tell it; turned ones have a round grain."""
    _material, tree, node = common.metal("presets")
    nodes = sys.modules[f"{common.MODULE}.nodes"]
    words = [item.identifier for item in bpy.ops.libshade.metal_preset.get_rna_type().properties["preset"].enum_items]
    assert len(words) == 18 and "BRUSHED_STEEL" in words
    color, alphas = {}, {}
    for word in words:
        nodes.apply_preset(node, word)
        color[word], alphas[word] = tuple(node.inputs["Color"].default_value)[:3], (node.ax, node.ay)
        assert all(0.3 < c <= 1 for c in color[word]) or "GOLD" in word or "COPPER" in word or "BRASS" in word, word
        tangents = [n for n in tree.nodes if n.bl_idname == "ShaderNodeTangent"]
        assert len(tangents) == node.inputs["Tangent"].is_linked == ("TURNED" in word), word
        assert not tangents or tangents[0].direction_type == "RADIAL"
    for word, (ax, ay) in alphas.items():
        ratio = max(ax, ay) / min(ax, ay)
        assert ratio < 1.2 if "SCRATCHED" in word else ratio > 2, (word, ax, ay)
        assert "SCRATCHED" in word or ax < ay  # smooth along the strokes
    r, g, b = color["BRUSHED_GOLD"]
    assert r > 1.1 * g > 1.5 * b, (r, g, b)
    r, g, b = color["TURNED_COPPER"]
    assert r > g > b and r > 1.3 * g
    assert max(color["SCRATCHED_ALUMINIUM"]) < 1.1 * min(color["SCRATCHED_ALUMINIUM"])
    # a tangent of the author's own stays
    own = tree.nodes.new("ShaderNodeTangent")
    tree.links.new(own.outputs[0], node.inputs["Tangent"])
    for word in ("TURNED_BRASS", "BRUSHED_BRASS"):
        nodes.apply_preset(node, word)
        assert node.inputs["Tangent"].links[0].from_node == own
    with bpy.context.temp_override(node=node):
        assert bpy.ops.libshade.metal_preset(preset="BRUSHED_TITANIUM") == {"FINISHED"}
    assert near(node.ax, alphas["BRUSHED_TITANIUM"][0])
    assert not bpy.ops.libshade.metal_preset.poll()


class Layout:
    """Takes what a panel draws; a property that is not there is an error."""

    def __init__(self, drawn):
        self.drawn = drawn

    def prop(self, owner, name, **_text):
        assert hasattr(owner, name), (owner, name)
        self.drawn.append(name)

    def operator(self, _name, text=""):
        self.drawn.append(text)
        return SimpleNamespace()

    def column(self, **_settings):
        return Layout(self.drawn)


def drawn_by(panel, **context):
    drawn = []
    known = SimpleNamespace(layout=Layout(drawn))
    for name in ("of", "settings"):
        if hasattr(panel, name):
            setattr(known, name, getattr(panel, name))
    panel.draw(known, SimpleNamespace(**context))
    return drawn


def test_panels_and_menus():
    """Panels have this Blender's names for what they show; the menu has the engine's shaders."""
    common.empty_scene()
    panels, menus = (sys.modules[f"{common.MODULE}.{name}"] for name in ("panels", "menus"))
    camera = bpy.data.cameras.new("camera")
    camera.type = "PANO"
    settings = camera if hasattr(camera, "panorama_type") else camera.cycles
    counts = []
    for kind in ("EQUIRECTANGULAR", "FISHEYE_EQUIDISTANT", "FISHEYE_EQUISOLID", "FISHEYE_LENS_POLYNOMIAL", "MIRRORBALL"):
        settings.panorama_type = kind
        counts.append(len(drawn_by(panels.DATA_PT_libshade_panorama, camera=camera)))
    assert counts == [5, 2, 3, 7, 1], counts
    ob, world = bpy.data.objects.new("object", None), bpy.data.worlds.new("world")
    assert drawn_by(panels.OBJECT_PT_libshade_visibility, object=ob) == [
        "visible_camera", "visible_diffuse", "visible_glossy", "visible_transmission", "visible_shadow",
        "is_holdout", "is_shadow_catcher"]
    assert drawn_by(panels.WORLD_PT_libshade_visibility, world=world)[:4] == ["camera", "diffuse", "glossy", "transmission"]
    labels = drawn_by(menus.NODE_MT_libshade_shaders)
    assert labels[:3] == ["Material Output", "Mix Shader", "Add Shader"] and len(labels) > 12
    assert {"Principled BSDF", "Diffuse BSDF", "Emission", "Glass BSDF"} < set(labels)
    # 3.4 hides its own under our engine, 5.0 does not
    assert menus._hides_shaders() == (bpy.app.version < (4, 0))


def test_copies(material, node):
    """A copy's settings are its own, those of the node inside too, whichever is changed."""
    def inside(node):
        return node.node_tree.nodes["Anisotropic BSDF"].inputs["Roughness"].default_value

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
test_properties_set_sockets(common.metal("sockets")[2])
test_old_files(common.metal("old")[2])
test_copies(material, node)
test_convert(test_save_and_load(blend))
test_fabric()
test_metals()
test_panels_and_menus()
test_disable_and_enable()
print("all asserted")
common.finish()
