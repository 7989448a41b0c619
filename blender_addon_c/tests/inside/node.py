# SPDX-License-Identifier: GPL-3.0-or-later
"""The metal and the cloth node without a render; asserts. arguments: none"""

import os
import re
import sys
from fnmatch import fnmatchcase
from types import SimpleNamespace
from urllib.parse import unquote, urlparse

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common


def near(a, b):
    return abs(a - b) <= 1e-5 * max(abs(a), abs(b), 1e-3)


def test_sockets(node):
    assert [s.name for s in node.inputs] == [
        "Color", "Edge Tint", "Roughness", "Anisotropy", "Rotation", "Diffuse Color", "Normal", "Tangent"]
    assert [s.name for s in node.outputs] == ["BSDF"]
    assert node.detail == "ROTATE" and node.distribution == "ASHIKHMIN_SHIRLEY"
    assert node.brdf == "AUTO"
    assert node.groove == "AUTO" and node.fresnel == "SCHLICK" and node.horizon == "MUTUAL"
    assert near(node.ex, 200) and near(node.ey, 10)
    # a slider from 0 to 1 turn, as Cycles' own; numbers beyond are turns all the same
    turns, theirs = (n.inputs["Rotation"] for n in (node, node.node_tree.nodes["Anisotropic BSDF"]))
    assert [socket.bl_rna.properties["default_value"].subtype for socket in (turns, theirs)] == ["FACTOR"] * 2
    turns.default_value = -1.25
    assert turns.default_value == -1.25
    turns.default_value = 0


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


def by_identifier(node):
    return {socket.identifier: socket for socket in node.inputs}


def test_grain(node):
    """What feeds the groove inside where nothing is linked to Tangent; bumps reach it or not."""
    inner = node.node_tree.nodes
    source, of_map = (by_identifier(inner[name])[socket] for name, socket in (("Either", "A_Vector"), ("Mapless", "B_Vector")))
    assert source.links[0].from_node == inner["Mapless"] and of_map.links[0].from_node == inner["Tangent"]
    for axis in "XYZ":
        node.grain = f"RADIAL_{axis}"
        assert (inner["Tangent"].direction_type, inner["Tangent"].axis) == ("RADIAL", axis)
        assert source.links[0].from_node == inner["Tangent"]
        node.grain = f"AXIS_{axis}"
        vector = tuple(inner["Axis"].inputs["Vector"].default_value)
        assert source.links[0].from_node == inner["Axis"] and vector["XYZ".index(axis)] == 1 == round(sum(vector), 2)
    node.grain, node.uv_map = "UV", "other"
    assert source.links[0].from_node == inner["Mapless"] and inner["Tangent"].uv_map == inner["UV Map"].uv_map == "other"
    assert tuple(inner["Axis"].inputs["Vector"].default_value)[0] == 1  # of a mesh without it
    for response in ("IGNORE", "FOLLOW"):
        node.bump_response = response
        assert inner["Groove"].inputs["Normal"].is_linked == (response == "FOLLOW")


def test_edge_tint(node):
    """It is f82 under that Fresnel; by the socket also Schlick's is darkened; a conductor's own is at 82 degrees what its
    index of refraction says."""
    nodes = sys.modules[f"{common.MODULE}.nodes"]
    tint, dip = node.inputs["Edge Tint"], node.node_tree.nodes["Edge"].inputs[1]

    def now():
        return tuple(round(part, 4) for part in tint.default_value)[:3]
    node.f82 = (0.2, 0.4, 0.6)
    assert now() == (1, 1, 1) and nodes.fresnel_of(node) == "SCHLICK"
    node.fresnel = "F82"
    assert now() == (0.2, 0.4, 0.6) and nodes.fresnel_of(node) == "F82"
    node.fresnel = "SCHLICK"
    assert now() == (1, 1, 1) and nodes.fresnel_of(node) == "SCHLICK"
    tint.default_value = (0.5, 0.5, 0.5, 1)
    assert nodes.fresnel_of(node) == "F82"
    node.fresnel = "F82"
    assert now() == (0.5, 0.5, 0.5)
    for fresnel, on in (("NONE", False), ("SCHLICK", True), ("CONDUCTOR", True)):
        node.fresnel = fresnel
        assert (dip.default_value > 0) == on and node.inputs["Edge Tint"].default_value[0] == 0.5
        assert nodes.fresnel_of(node) == ("F82" if fresnel == "SCHLICK" else fresnel)
    with bpy.context.temp_override(node=node):
        assert bpy.ops.libshade.measured_metal(metal="COPPER") == {"FINISHED"}
    lost = node.node_tree.nodes["Lost"].inputs["Color2"]
    assert near(node.k[0], 3.483) and lost.is_linked and nodes.fresnel_of(node) == "CONDUCTOR"
    # by the amplitudes of both polarisations at a cosine of 1/7, of red: sin^2 = 48/49
    n = complex(0.2347, -3.483)
    inside = (n * n - 48 / 49) ** 0.5
    whole = (abs((1 / 7 - inside) / (1 / 7 + inside)) ** 2 + abs((n * n / 7 - inside) / (n * n / 7 + inside)) ** 2) / 2
    head_on = abs((1 - n) / (1 + n)) ** 2
    assert near(tint.default_value[0] * (head_on + (1 - head_on) * (6 / 7) ** 5), whole)
    node.set_color = (0, 0, 0, 0)  # as on nodes of older files, whose sockets say nothing of the index
    node.eta = node.eta
    assert not lost.is_linked and near(lost.default_value[0] * (head_on + (1 - head_on) * (6 / 7) ** 5), whole)


def test_sliders(node):
    """The lobe in alphas and in exponents, whatever says it; one set, the other stays."""
    node.ax, node.ay = 0.1, 0.4
    assert near(10**node.shown_ax, 0.1) and near(10**node.shown_ay, 0.4) and near(10**node.shown_ex, 198)
    node.inputs["Roughness"].default_value, node.inputs["Anisotropy"].default_value = 0.5, 0.6  # .1 and .625
    assert near(10**node.shown_ax, 0.1) and near(10**node.shown_ay, 0.625) and near(10**node.shown_ey, 3.12)
    node.shown_ex = 3
    assert near(node.ex, 1000) and near(node.ay, 0.625) and near(10**node.shown_ay, 0.625)
    # what a script says beyond the ends, as the end; sockets beyond theirs, too
    for kind, low, high in (("a", 1e-4, 10), ("e", 0.01, 1e6)):
        for value, end in ((1e38, high), (-1e38, low), (float("inf"), high), (float("-inf"), low)):
            setattr(node, f"shown_{kind}x", value)
            assert near(10 ** getattr(node, f"shown_{kind}x"), end), (kind, value)
    for roughness, anisotropy in ((0, 0), (0, 1), (1, -1), (1e30, -1e30), (-1, 5)):
        node.inputs["Roughness"].default_value, node.inputs["Anisotropy"].default_value = roughness, anisotropy
        assert all(-4 <= getattr(node, f"shown_{word}") <= 6 for word in ("ax", "ay", "ex", "ey"))
    drawn = []
    for width in ("ROUGHNESS", "ALPHA", "EXPONENTS"):
        node.width_as = width
        node.draw_advanced(Layout(drawn))
    assert {"shown_ax", "shown_ay", "shown_ex", "shown_ey", "Measured Metal", "distribution", "detail"} <= set(drawn)
    node.strokes, seen = 0.5, []
    node.draw_advanced(Layout(seen))
    assert {"distribution, grey", "brdf, grey"} == {word for word in seen if word.endswith("grey")}
    node.strokes = 0.0
    layout = Layout(drawn)
    type(node).draw_buttons(node, SimpleNamespace(object=None), layout)
    assert drawn[-4:] == ["grain", "uv_map", "strokes", "bump_response"]
    assert layout.pointers == {"node": node}  # in a material's tab nothing else tells its operators


def test_keyframes(scene):
    """Properties that keyframes set reach the sockets and what is inside, and leave sockets of the artist's own."""
    material, _tree, node = common.metal("animated")
    common.plane(material)
    for frame, exponent in ((1, 100.0), (11, 1000.0)):
        node.ex = exponent
        node.keyframe_insert("ex", frame=frame)
    shader, seen = node.node_tree.nodes["Anisotropic BSDF"], []
    for frame in (1, 6, 11):
        scene.frame_set(frame)
        seen.append((node.inputs["Roughness"].default_value, shader.inputs["Roughness"].default_value))
        assert near(*seen[-1]), (seen, node.ex, node.ax, list(node.set_shape))
    assert seen[0] > seen[1] > seen[2] and near(seen[0][0], ((2 / 102) ** 0.5 * node.ay) ** 0.25)
    node.inputs["Roughness"].default_value = 0.7
    scene.frame_set(1)
    assert near(node.inputs["Roughness"].default_value, 0.7)
    # alphas, of which one distribution reads nothing, exponents, which the others do not; what are no numbers
    inside = {"width": lambda node: node.inputs["Roughness"].default_value, "grain": lambda node: node.node_tree.nodes["Tangent"].axis,
              "bumps": lambda node: node.node_tree.nodes["Groove"].inputs["Normal"].is_linked}
    for distribution, name, values, what in (
            ("ASHIKHMIN_SHIRLEY", "ay", (0.1, 0.3), "width"), ("GGX", "ex", (100.0, 1000.0), "width"),
            ("GGX", "grain", ("RADIAL_X", "RADIAL_Y"), "grain"), ("GGX", "bump_response", ("FOLLOW", "IGNORE"), "bumps")):
        material, _tree, node = common.metal("animated", distribution=distribution)
        common.plane(material)
        seen = []
        for frame, value in zip((1, 11), values):
            setattr(node, name, value)
            seen.append(inside[what](node))
            node.keyframe_insert(name, frame=frame)
        for frame, expected in zip((1, 11, 1), (*seen, seen[0])):
            scene.frame_set(frame)
            assert inside[what](node) == expected or what == "width" and near(inside[what](node), expected), (name, frame)
        assert seen[0] != seen[1]
    # drivers, whose variables change without the frame
    material, _tree, node = common.metal("driven")
    ob, driver = common.plane(material), node.driver_add("ex").driver
    variable = driver.variables.new()
    variable.name, variable.targets[0].id, variable.targets[0].data_path = "x", ob, "location.x"
    driver.expression = "100 * x"
    for place in (1.0, 2.0, 3.0):
        ob.location.x = place
        bpy.context.view_layer.update()
        assert near(node.inputs["Roughness"].default_value, (2 / (100 * place + 2)) ** 0.125 * node.ay ** 0.25), place


def test_update():
    """A node of the version before, with links and values: the new one says the same."""
    _material, tree, node = common.metal("before")
    node.ax, node.ay, node.kd, node.distribution, node.groove = 0.2, 0.1, (0.1, 0.2, 0.3), "GGX", "Y"
    before = node.node_tree.copy()  # as then
    before.name = "before"
    for name in ("Edge Tint",):
        if hasattr(before, "interface"):
            before.interface.remove(before.interface.items_tree[name])
        else:
            before.inputs.remove(before.inputs[name])
    for name in ("Edge", "Dip", "At 82", "Lost", "Share", "Rest", "Axis", "UV Map", "Mapless"):
        before.nodes.remove(before.nodes[name])
    node.node_tree = before
    assert [s.name for s in node.inputs][:2] == ["Color", "Roughness"]
    rgb, bump = tree.nodes.new("ShaderNodeRGB"), tree.nodes.new("ShaderNodeBump")
    tree.links.new(rgb.outputs[0], node.inputs["Color"])
    tree.links.new(bump.outputs[0], node.inputs["Normal"])
    node.inputs["Anisotropy"].default_value, node.inputs["Rotation"].default_value = -0.4, 0.25
    drawn = []
    type(node).draw_buttons(node, None, Layout(drawn))
    assert drawn[-1] == "libshade.update_nodes"
    assert bpy.ops.libshade.update_nodes() == {"FINISHED"}
    node = tree.nodes[node.name]
    inputs = node.inputs
    assert [s.name for s in inputs][:2] == ["Color", "Edge Tint"] and "before" not in bpy.data.node_groups
    assert inputs["Color"].links[0].from_node == rgb and inputs["Normal"].links[0].from_node == bump
    assert sum(socket.is_linked for socket in inputs) == 2 and node.outputs[0].is_linked
    assert near(inputs["Anisotropy"].default_value, -0.4) and near(inputs["Rotation"].default_value, 0.25)
    assert near(inputs["Roughness"].default_value, 0.02**0.25) and near(inputs["Diffuse Color"].default_value[2], 0.3)
    inner = node.node_tree.nodes
    assert inner["Anisotropic BSDF"].distribution == "GGX" and by_identifier(inner["Strokes"])["Factor_Float"].default_value == 1
    assert bpy.ops.libshade.update_nodes() == {"CANCELLED"}


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


def test_strokes():
    """A new node has them, and its presets of brushed and turned metals; who gives its lobe in numbers, or has an older file, does not."""
    _material, tree, _node = common.metal("strokes")
    node = tree.nodes.new("LibshadeMetalNode")

    def inside():
        shader = node.node_tree.nodes["Anisotropic BSDF"]
        return shader.distribution == "GGX", shader.inputs["Roughness"].links[0].from_node.name == "Worn"
    assert (node.strokes, node.grain) == (1, "AXIS_Y") and inside() == (True, True)
    for word, strokes, grain in (("TURNED_STEEL", 1, "RADIAL_Z"), ("SCRATCHED_STEEL", 0, "AXIS_Y"), ("BRUSHED_STEEL", 1, "AXIS_Y")):
        node.preset = word
        assert (node.strokes, node.grain) == (strokes, grain) and inside()[1] == bool(strokes), word
    assert node.horizon == "MUTUAL"
    node.ex, node.horizon = 300, "HARD"
    assert (node.strokes, node.grain) == (0, "UV") and inside() == (False, False)
    node.preset = "BRUSHED_STEEL"
    assert (node.strokes, node.grain, node.horizon) == (0, "UV", "HARD")
    properties = node.bl_rna.properties
    assert [properties[name].default for name in ("strokes", "grain", "horizon")] == [0, "UV", "VALID_ESTEVEZ"]  # what older files mean


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
        assert node.grain == ("RADIAL_Z" if "TURNED" in word else "UV") and not node.inputs["Tangent"].is_linked, word
        tangent = node.node_tree.nodes["Tangent"]
        assert (tangent.direction_type, tangent.axis) == (("RADIAL", "Z") if "TURNED" in word else ("UV_MAP", tangent.axis))
    for word, (ax, ay) in alphas.items():
        ratio = max(ax, ay) / min(ax, ay)
        assert ratio < 1.2 if "SCRATCHED" in word else ratio > 2, (word, ax, ay)
        assert "SCRATCHED" in word or ax < ay  # smooth along the strokes
    r, g, b = color["BRUSHED_GOLD"]
    assert r > 1.1 * g > 1.5 * b, (r, g, b)
    r, g, b = color["TURNED_COPPER"]
    assert r > g > b and r > 1.3 * g
    assert max(color["SCRATCHED_ALUMINIUM"]) < 1.1 * min(color["SCRATCHED_ALUMINIUM"])
    # sockets show the index of refraction, and count once they are changed or linked; a preset takes it back
    nodes.apply_preset(node, "BRUSHED_COPPER")
    red, edge = node.inputs["Color"], node.inputs["Edge Tint"]
    assert nodes.fresnel_of(node) == "CONDUCTOR" and edge.default_value[1] < 1
    node.eta, node.k = (0.5, 0.5, 0.5), (3, 3, 3)
    assert nodes.fresnel_of(node) == "CONDUCTOR" and near(red.default_value[1], (0.25 + 9) / (2.25 + 9))
    for socket in (red, edge):
        socket.default_value = (0.1, 0.2, 0.3, 1)
        assert nodes.fresnel_of(node) == "F82"
        nodes.apply_preset(node, "BRUSHED_COPPER")
        assert nodes.fresnel_of(node) == "CONDUCTOR" and near(red.default_value[0], color["BRUSHED_COPPER"][0])
    tree.links.new(tree.nodes.new("ShaderNodeRGB").outputs[0], red)
    assert nodes.fresnel_of(node) == "F82"
    tree.links.remove(red.links[0])
    with bpy.context.temp_override(node=node):
        assert bpy.ops.libshade.measured_metal(metal="GOLD") == {"FINISHED"}
    assert nodes.fresnel_of(node) == "CONDUCTOR" and red.default_value[0] > 0.99
    node.fresnel = "SCHLICK"
    assert tuple(edge.default_value) == (1, 1, 1, 1)
    # of a file whose node had its round tangent outside
    node.grain, round_one = "UV", tree.nodes.new("ShaderNodeTangent")
    round_one["libshade_round"] = True
    tree.links.new(round_one.outputs[0], node.inputs["Tangent"])
    nodes.apply_preset(node, "TURNED_BRASS")
    assert node.grain == "RADIAL_Z" and not [n for n in tree.nodes if n.bl_idname == "ShaderNodeTangent"]
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
    node.preset = "Brushed Copper"  # a script's
    assert near(node.ax, alphas["BRUSHED_COPPER"][0]) and near(red.default_value[0], color["BRUSHED_COPPER"][0])
    try:
        node.preset = "brushed_lead"
    except TypeError as error:
        assert "brushed_lead" in str(error) and "BRUSHED_STEEL" in str(error)
    else:
        raise AssertionError("a metal that there is not")


class Layout:
    """Takes what a panel draws; a property that is not there is an error."""

    def __init__(self, drawn):
        self.drawn, self.pointers, self.enabled = drawn, {}, True

    def context_pointer_set(self, name, owner):
        self.pointers[name] = owner

    def prop(self, owner, name, **_text):
        assert hasattr(owner, name), (owner, name)
        self.drawn.append(name if self.enabled else f"{name}, grey")

    def operator(self, name, text="", icon=""):
        self.drawn.append(text or name)
        return SimpleNamespace()

    def separator(self):
        self.drawn.append("")

    def operator_menu_enum(self, _name, _attribute, text):
        self.drawn.append(text)

    def label(self, text, icon=""):
        self.drawn.append(text)

    def template_list(self, _list, _name, owner, name, *_active, **_settings):
        self.prop(owner, name)

    def column(self, **_settings):
        return Layout(self.drawn)

    row = column


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
    # what engine and manual call the layer's is nowhere else under our engine
    layer = bpy.context.view_layer
    assert drawn_by(panels.VIEWLAYER_PT_libshade_passes, view_layer=layer)[-2:] == ["pass_cryptomatte_depth", "pass_alpha_threshold"]
    aov = panels.VIEWLAYER_PT_libshade_passes_aov
    assert drawn_by(aov, view_layer=layer) == ["aovs", "scene.view_layer_add_aov", "scene.view_layer_remove_aov"]
    assert aov.bl_parent_id == panels.VIEWLAYER_PT_libshade_passes.__name__ and hasattr(bpy.types, aov.__name__)
    # Blender's own Simplify would be above Sampling
    types, ours = bpy.types, [panel.__name__ for panel in panels._registered if panel.bl_context == "render"]
    assert "LIBSHADE" not in types.RENDER_PT_simplify.COMPAT_ENGINES
    assert ours[0] == "RENDER_PT_libshade_sampling" and ours[-3:] == [
        f"RENDER_PT_libshade_simplify{part}" for part in ("", "_viewport", "_render")] and all(hasattr(types, name) for name in ours)
    # none of ours is there a second time
    shown = [(panel.bl_space_type, getattr(panel, "bl_context", ""), getattr(panel, "bl_parent_id", ""), panel.bl_label)
             for panel in types.Panel.__subclasses__() if panel.is_registered and "LIBSHADE" in getattr(panel, "COMPAT_ENGINES", ())]
    assert {"Light", "Sampling", "Passes", "Override", "Performance"} <= {label for *_place, label in shown}
    own = [(panel.bl_space_type, panel.bl_context, getattr(panel, "bl_parent_id", ""), panel.bl_label) for panel in panels._registered]
    assert not [place for place in own if shown.count(place) != 1], [place for place in own if shown.count(place) != 1]
    labels = drawn_by(menus.NODE_MT_libshade_shaders)
    assert labels[:3] == ["Material Output", "Mix Shader", "Add Shader"] and len(labels) > 12
    assert {"Principled BSDF", "Diffuse BSDF", "Emission", "Glass BSDF"} < set(labels)
    # what Shift+A opens executes, if nothing else is said: a new node would not stay at the mouse
    for name in ("nodes", "fabric.node", "groove", "scratches.node"):
        menu = SimpleNamespace(layout=Layout([]))
        sys.modules[f"{common.MODULE}.{name}"]._draw_add_menu(menu, SimpleNamespace(space_data=SimpleNamespace(tree_type="ShaderNodeTree")))
        assert menu.layout.operator_context == "INVOKE_DEFAULT" and menu.layout.drawn, name
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


def patterns():
    return [tree for tree in bpy.data.node_groups if "Pattern" in tree.name]


def test_patterns():
    """What is inside a new node is copied from an unused tree, of which there is one, unless someone has put it to use or
    removed a group from it: nodes then are whole all the same."""
    def whole(node):
        assert node.node_tree not in patterns() and all(g.node_tree for g in node.node_tree.nodes if g.type == "GROUP")
        assert node.node_tree.name.startswith(".Libshade Metal") and "Pattern" not in node.node_tree.name
        assert not [key for key in node.node_tree.keys() if key.startswith("libshade")]
        return node

    whole(common.metal("one")[2])
    pattern, = patterns()
    assert whole(common.metal("two")[2]).node_tree != pattern and patterns() == [pattern] and not pattern.users
    pattern.nodes["Groove"].node_tree = None
    whole(common.metal("three")[2])
    pattern, = (p for p in patterns() if p != pattern)
    pattern.use_fake_user = True
    pattern.nodes.clear()
    whole(common.metal("four")[2])
    pattern.use_fake_user = False  # it has no group that is gone, but none at all
    bpy.data.node_groups.remove(pattern)


def test_save_and_load(path):
    assert patterns()
    linked, _tree, node = common.metal("to be linked")
    linked.use_fake_user = True
    # what older versions kept of a choice that no one had made, and of one: nothing, and the choice
    said = common.metal("said", distribution="GGX", brdf="WARD_DUR")[0]
    said.use_fake_user = True
    node.property_unset("brdf")
    for frame, exponent in ((1, 100.0), (11, 1000.0)):
        node.ex = exponent
        node.keyframe_insert("ex", frame=frame)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    common.enable()
    assert not patterns()  # what has no users is not saved
    metal_of = {name: bpy.data.materials[name].node_tree.nodes["Libshade Metal"] for name in ("metal", "to be linked", "said")}
    assert {name: metal.brdf for name, metal in metal_of.items()} == {
        "metal": "AUTO", "to be linked": "ASHIKHMIN_SHIRLEY", "said": "WARD_DUR"}
    node = bpy.data.materials["metal"].node_tree.nodes["Libshade Metal"]
    assert near(node.ay, 0.15) and node.node_tree
    return node


def test_convert(node):
    """The group has the node's tree, values and links; nothing of libshade is left."""
    tree = bpy.data.materials["metal"].node_tree
    image = common.image_node(tree, bpy.data.images.new("image", 4, 4))
    tree.links.new(image.outputs["Color"], node.inputs["Color"])
    inner = node.node_tree
    # groups that the Add menu lists: the utility alone, for the insides have no settings there
    shown = [g for g in bpy.data.node_groups if g.name.startswith("Libshade")]
    assert all(g.get("libshade_groove") for g in shown) and inner.name.startswith(".Libshade Metal"), shown
    assert bpy.ops.libshade.convert_to_group(all_materials=True) == {"FINISHED"}
    group = tree.nodes["Libshade Metal"]
    assert group.bl_idname == "ShaderNodeGroup" and group.node_tree == inner and inner.name.startswith("Libshade Metal")
    assert group.inputs["Color"].links[0].from_node == image
    assert group.outputs["BSDF"].links[0].to_node.type == "OUTPUT_MATERIAL"
    assert not any(n.bl_idname == "LibshadeMetalNode" for m in bpy.data.materials
                   for n in m.node_tree.nodes)


def test_fabric():
    """A preset's colours are the sockets'; the mean inside follows what shows; a copy is its own."""
    tree = common.tree_of(bpy.data.materials.new("cloth"))
    node = tree.nodes.new("LibshadeFabricNode")
    assert [s.name for s in node.inputs] == ["Warp Color", "Weft Color", "Gloss", "Fuzz", "Translucency", "Alpha", "Scale", "Rotation",
                                             "Vector", "Normal"]
    before = [tuple(s.default_value) for s in list(node.inputs)[:2]]
    node.preset = "DENIM"
    warp, weft = (tuple(s.default_value)[:3] for s in list(node.inputs)[:2])
    assert before != [warp, weft] and warp[2] > 2 * warp[0] and weft[0] > 0.3, (warp, weft)
    image = node.node_tree.nodes["yarns"].image
    middles = np.array(image.pixels[:], np.float32).reshape(*image.size, 4)[16::32, 16::32]
    assert near((middles[..., 1] > middles[..., 0]).mean(), 0.25)  # twill 3/1
    # four ends of 26 a cm, four picks of 17; at half of Scale twice as much
    assert all(near(*pair) for pair in zip(node.repeat_mm, (40 / 26, 40 / 17)))
    node.inputs["Scale"].default_value = 0.5
    said = []
    type(node).draw_buttons(node, None, Layout(said))
    assert "Repeat: 3.08 × 4.71 mm" in said, said
    tree.links.new(node.outputs["BSDF"], tree.get_output_node("ALL").inputs["Surface"]
                   if tree.get_output_node("ALL") else
                   tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    inner = node.node_tree
    assert bpy.ops.libshade.convert_to_group(all_materials=True) == {"FINISHED"}
    assert any(n.bl_idname == "ShaderNodeGroup" and n.node_tree == inner for n in tree.nodes)


def test_linked(path):
    """Keyframes of a material of another file reach what is inside."""
    scene = common.empty_scene()
    with bpy.data.libraries.load(path, link=True) as (_there, here):
        here.materials = ["to be linked"]
    common.plane(here.materials[0])
    node = here.materials[0].node_tree.nodes["Libshade Metal"]
    for frame, exponent in ((1, 100.0), (11, 1000.0), (1, 100.0)):
        scene.frame_set(frame)
        inside = node.node_tree.nodes["Anisotropic BSDF"].inputs["Roughness"]
        assert near(inside.default_value, (2 / (exponent + 2)) ** 0.125 * node.ay ** 0.25), frame


def manual_of(name):
    """Where Blender's Online Manual of what has this name leads, as its operator finds it."""
    return next((prefix + place for prefix, places in bpy.utils.manual_map() for pattern, place in places
                 if fnmatchcase(name.lower(), pattern)), None)


def test_manual():
    """Everything of ours has its place in the manual that comes with the add-on, and its pages their pictures and links."""
    ours = ["bpy.types." + name for name, module in (("LibshadeMetalNode", "nodes"), ("LibshadeFabricNode", "fabric.node"),
            ("LibshadeSettings", "properties"), ("LibshadeViewLayerSettings", "properties"))
            if getattr(sys.modules[f"{common.MODULE}.{module}"], name)]
    ours += [f"bpy.ops.libshade.{name}" for name in dir(bpy.ops.libshade)]
    assert len(ours) > 10
    pages, pictures = {}, set()

    def page_of(path):
        if path not in pages:
            with open(path, encoding="utf-8") as file:
                pages[path] = file.read()
        return pages[path]

    for name in ours:
        path, _, place = manual_of(name).partition("#")
        page = page_of(unquote(urlparse(path).path))
        assert not place or f'id="{place}"' in page, (name, place)
    for path, page in list(pages.items()):
        pictures |= {os.path.join(os.path.dirname(path), found) for found in re.findall('<img [^>]*src="(.*?)"', page)}
        for link in set(re.findall('href="([^"#:]+\\.html)', page)):
            assert os.path.exists(os.path.join(os.path.dirname(path), unquote(link))), (path, link)
    assert len(pictures) >= 4 and all(os.path.getsize(picture) > 1000 for picture in pictures)


def another(p):
    """A value that a property may have and does not have at first, exact in single precision."""
    if p.type == "STRING":
        return "words"
    if p.type == "BOOLEAN":
        return not p.default
    if p.type == "ENUM":
        return next(item.identifier for item in p.enum_items if item.identifier != p.default)
    if p.type == "POINTER":
        return bpy.data.texts.new("pointed at")
    low, high = max(p.hard_min, -8), min(p.hard_max, 8)
    if p.type == "INT":
        return next(value for value in range(low, high) if value != p.default)
    at = next(value for value in (0.75, 0.5) if low + value * (high - low) != p.default)
    value = float(np.float32(low + at * (high - low)))
    return (value,) * p.array_length if p.is_array else value


def test_read_as_set():
    """Every property of ours can be read, by scripts that walk through them all, and says what was set."""
    scene = bpy.context.scene
    tree = common.metal("read")[1]
    owners = [tree.nodes.new(f"Libshade{kind}Node") for kind in ("Metal", "Fabric", "Scratches")]
    for owner in (*owners, scene.libshade, scene.view_layers[0].libshade):
        for name in dir(owner):
            getattr(owner, name)
        ours = [p for p in owner.bl_rna.properties if p.identifier in type(owner).__annotations__]
        assert len(ours) == len(type(owner).__annotations__)
        for p in ours:
            if p.is_readonly:
                continue
            value = another(p)
            setattr(owner, p.identifier, value)
            told = getattr(owner, p.identifier)
            told = tuple(told) if hasattr(value, "__len__") and not isinstance(value, str) else told
            # a logarithm is of the number that is kept
            assert np.allclose(told, value, atol=1e-5) if p.type == "FLOAT" else told == value, (owner, p.identifier, told)
    fresh = tree.nodes.new("LibshadeMetalNode"), tree.nodes.new("LibshadeScratchesNode")
    for owner, word in zip(fresh, ("BRUSHED_GOLD", "FINE_POLISH")):
        assert owner.preset == ""
        owner.preset = word.title().replace("_", " ")
        assert owner.preset == word


def test_disable_and_enable():
    """Switching the add-on off and on with a rendered node in the file; Blender must survive."""
    material, _tree, _node = common.metal("again")
    common.plane(material)
    bpy.context.view_layer.update()
    assert patterns()
    bpy.ops.preferences.addon_disable(module=common.MODULE)
    assert not patterns()
    for name in ("Metal", "Fabric", "Scratches") if bpy.app.version < (4, 0) else ():
        cls, drawn = bpy.types.Node.bl_rna_get_subclass_py(f"Libshade{name}Node"), []
        cls.draw_buttons_ext(SimpleNamespace(draw_buttons=lambda *said, c=cls: c.draw_buttons(None, *said)), None, Layout(drawn))
        assert drawn == ["libshade is disabled"], drawn  # not buttons whose operators are gone, named in the terminal
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
test_grain(common.metal("grain")[2])
test_edge_tint(common.metal("edge")[2])
test_sliders(common.metal("sliders")[2])
test_keyframes(bpy.context.scene)
test_update()
test_old_files(common.metal("old")[2])
test_copies(material, node)
test_patterns()
test_convert(test_save_and_load(blend))
test_fabric()
test_metals()
test_panels_and_menus()
test_linked(blend)
test_manual()
test_read_as_set()
test_disable_and_enable()
assert manual_of("bpy.types.LibshadeMetalNode.grain") is None  # disabled
print("all asserted")
common.finish()
