# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Fabric inside Blender: each socket against what it should do, by hand or as numbers and textures say the same;
older nodes. Leaves dumps in a folder for the reference: cloth.py FOLDER."""

import math
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402

folder, = common.arguments()
SIDE = 24


def cloth(preset="LINEN", sun=(0.5, 0.2, 0), **settings):
    """A new scene of a plate under a sun; (its tree, its node, the plate)."""
    scene = common.empty_scene(SIDE, SIDE, samples=32)
    material = bpy.data.materials.new("cloth")
    tree = common.tree_of(material)
    tree.nodes.clear()
    node, output = tree.nodes.new("LibshadeFabricNode"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    node.preset = preset
    for name, value in settings.items():
        setattr(node, name, value)
    common.light(scene, rotation=sun)
    common.camera(scene, type="ORTHO", ortho_scale=1.9)
    return tree, node, common.plane(material)


def picture(dump=""):
    """What is rendered, from the bottom; dump: leave one of that name."""
    os.environ["LIBSHADE_DUMP"] = os.path.join(folder, dump + ".exr") if dump else ""
    path = os.path.join(folder, "picture.exr")
    common.render(path)
    image = bpy.data.images.load(path)
    pixels = np.array(image.pixels[:], np.float32).reshape(image.size[1], image.size[0], -1)
    bpy.data.images.remove(image)
    os.remove(path)
    return pixels


def feed(tree, node, name, value):
    """A number of the socket, through nodes that no one can work out beforehand."""
    place, apart, to = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("UVMap", "SeparateXYZ", "Math"))
    tree.links.new(place.outputs[0], apart.inputs[0])
    tree.links.new(apart.outputs[0], to.inputs[0])
    to.operation, to.inputs[1].default_value, to.inputs[2].default_value = "MULTIPLY_ADD", 1e-6, value
    tree.links.new(to.outputs[0], node.inputs[name])
    return to


def unfeed(tree, node, name):
    for link in list(node.inputs[name].links):
        tree.links.remove(link)


def difference(a, b):
    return np.abs(a - b).mean() / np.abs(b).mean()


def test_numbers_and_textures():
    """The same picture; and each socket changes it."""
    for name, value, sun in (("Gloss", 0.2, (0.1, 0.1, 0)), ("Fuzz", 1.5, (1.2, 0.2, 0)), ("Translucency", 0.6, (0.5, 0.2, 0)),
                             ("Translucency", 0.6, (math.pi - 0.5, 0.2, 0)), ("Alpha", 0.4, (0.5, 0.2, 0)),
                             ("Scale", 3.0, (0.5, 0.2, 0)), ("Rotation", 0.1, (0.9, 0.2, 0))):
        tree, node, _plate = cloth("SILK_SHANTUNG", sun, size=0.002)
        node.inputs["Alpha"].default_value = 0.9  # the rest is what the world shows
        before = picture()
        node.inputs[name].default_value = value
        said = picture()
        feed(tree, node, name, value)
        fed = picture()
        assert difference(fed, said) < (0.01 if name == "Translucency" else 2e-3), (name, difference(fed, said))
        assert np.abs(said - before).mean() > 0.02 * said.mean(), name
        if name == "Alpha":  # by hand
            assert np.allclose(said[..., 3], 0.4, atol=0.12) and abs(said[..., 3].mean() - 0.4) < 0.02
            assert difference(said[..., :3].mean((0, 1)) / 0.4, before[..., :3].mean((0, 1)) / 0.9) < 0.05
        if name == "Translucency" and sun[0] > 2:  # from behind, as much as that share
            assert before[..., :3].max() == 0
            node.inputs[name].links[0].from_node.inputs[2].default_value = 0.3
            assert difference(picture()[..., :3].mean(), said[..., :3].mean() / 2) < 0.02


def test_dumps():
    """For the reference: gloss and fuzz; the place on cloth that is turned, larger and fed."""
    tree, node, _plate = cloth("DENIM", size=0.001)
    node.inputs["Gloss"].default_value, node.inputs["Fuzz"].default_value = 0.3, 0.7
    picture("gloss")
    node.inputs["Rotation"].default_value, node.inputs["Scale"].default_value = 0.125, 1.4
    picture("turned")
    mapping, place = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeUVMap")
    mapping.inputs["Rotation"].default_value, mapping.inputs["Scale"].default_value = (0, 0, 0.4), (1.5, 1.5, 1)
    tree.links.new(place.outputs[0], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    picture("fed")


def test_vector():
    """Another UV map, and the object's own coordinates, are as the map itself where they say the same."""
    tree, node, ob = cloth("DENIM", size=0.002)
    first = ob.data.uv_layers[0].name
    own = picture()
    ob.data.uv_layers.new(name="turned")
    for loop in range(4):  # a quarter, as Rotation would have it
        u, v = ob.data.uv_layers[first].data[loop].uv
        ob.data.uv_layers["turned"].data[loop].uv = (v, -u)
    ob.data.uv_layers[first].active_render = True
    place = tree.nodes.new("ShaderNodeUVMap")
    place.uv_map = "turned"
    link = tree.links.new(place.outputs[0], node.inputs["Vector"])
    by_map = picture()
    tree.links.remove(link)
    node.inputs["Rotation"].default_value = 0.25
    by_turn = picture()
    assert difference(by_map, by_turn) < 2e-3, difference(by_map, by_turn)
    assert difference(by_turn, own) > 0.02
    node.inputs["Rotation"].default_value = 0.0
    coordinates, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value, mapping.inputs["Location"].default_value = (0.5, 0.5, 1), (0.5, 0.5, 0)
    tree.links.new(coordinates.outputs["Object"], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    assert difference(picture(), own) < 2e-3
    while ob.data.uv_layers:  # no map at all: its tangent is the object's x axis
        ob.data.uv_layers.remove(ob.data.uv_layers[0])
    assert difference(picture(), own) < 2e-3


def old(node):
    """As a node of a file from before these sockets: a tree with the numbers that its sockets had."""
    group = sys.modules[f"{common.MODULE}.group"]
    tree = bpy.data.node_groups.new("before", "ShaderNodeTree")
    for name, kind in (("Warp Color", "Color"), ("Weft Color", "Color"), ("Normal", "Vector")):
        group.new_socket(tree, name, "INPUT", f"NodeSocket{kind}")
    group.new_socket(tree, "BSDF", "OUTPUT", "NodeSocketShader")
    for name, kind in (("Mix", "MixRGB"), ("Darken", "MixRGB"), ("Principled BSDF", "BsdfPrincipled")):
        tree.nodes.new(f"ShaderNode{kind}").name = name
    for socket in node.inputs:
        if socket.type == "VALUE":
            socket.default_value = 0.0
    node.node_tree = tree
    assert [s.name for s in node.inputs] == ["Warp Color", "Weft Color", "Normal"]


def test_old_nodes():
    """Its properties count, before it is updated and after; sockets, links and colours stay."""
    tree, node, _plate = cloth("WOOL_FLANNEL")
    old(node)
    node.preset, node.size = "LINEN", 0.003
    node.preset = "WOOL_FLANNEL"
    node.transmission, node.open_gaps = 0.4, True
    node.inputs["Warp Color"].default_value = (0.5, 0.2, 0.1, 1)
    rgb = tree.nodes.new("ShaderNodeRGB")
    rgb.outputs[0].default_value = (0.2, 0.3, 0.4, 1)
    tree.links.new(rgb.outputs[0], node.inputs["Weft Color"])
    before = picture("old")
    assert bpy.ops.libshade.update_nodes() == {"FINISHED"} and "before" not in bpy.data.node_groups
    node = tree.nodes[node.name]
    inputs = node.inputs
    assert len(inputs) == 10 and abs(inputs["Translucency"].default_value - 0.4) < 1e-6
    assert abs(inputs["Fuzz"].default_value - 0.35) < 1e-6 and inputs["Weft Color"].links[0].from_node == rgb
    assert sum(s.is_linked for s in inputs) == 1 and node.outputs[0].is_linked
    assert difference(picture(), before) < 1e-6
    assert bpy.ops.libshade.update_nodes() == {"CANCELLED"}
    node.transmission = 0.1  # sets its socket
    assert abs(inputs["Translucency"].default_value - 0.1) < 1e-6
    inputs["Translucency"].default_value = 0.4  # and is not asked any more
    assert difference(picture(), before) < 1e-6


for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__, "done", flush=True)
print("all asserted")
common.finish()
