# SPDX-License-Identifier: GPL-3.0-or-later
"""What a later Blender adds, for test_blender_later.py and test_blender_nodes.py. arguments: what (a function here), FOLDER"""

import importlib
import math
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

what, folder = common.arguments()
PICTURE = os.path.join(folder, "later.exr")


def begin():
    scene = common.empty_scene(8, 8, 1)
    common.camera(scene, type="ORTHO", ortho_scale=1.0)
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.filter_width = 1, False, 0.01  # middles of pixels
    scene.libshade.pixel_filter_type, scene.libshade.filter_width = "GAUSSIAN", 0.01
    return scene, importlib.import_module(common.MODULE + ".export.known"), importlib.import_module(common.MODULE + ".report")


def told(scene, report):
    """What is said of a scene, of unknown things."""
    common.render(PICTURE)
    return [text for text, _error in report.told(scene) if "is not supported; left out" in text]


def stock():
    """Each node that is read has its row in the table, and a new one says nothing that is not known."""
    _scene, known, _report = begin()
    closures, reads = (importlib.import_module(f"{common.MODULE}.export.{name}") for name in ("closure", "node"))
    made = bpy.data.node_groups.new("made", "ShaderNodeTree").nodes
    kinds = [getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ShaderNode")]
    nodes = [made.new(kind.__name__) for kind in kinds if issubclass(kind, bpy.types.ShaderNode) and kind.__name__ not in (
        "ShaderNode", "ShaderNodeCustomGroup")]
    nodes = [node for node in nodes if node.bl_idname in {*known.KINDS, *closures.CLOSURES, *reads.NODES} or node.type in reads.NODES]
    assert len(nodes) > 70
    for node in nodes:
        assert node.bl_idname in known.KINDS and known._unknown_of(node) == [], node
        if bpy.app.version < (5, 1):
            kind = known.KINDS.get(node.bl_idname)
            assert {socket.identifier for socket in node.inputs} <= kind.inputs
            assert {socket.identifier for socket in node.outputs} <= kind.outputs
            assert {*node.bl_rna.properties.keys()} <= known._OF_ALL | kind.properties.keys() | {"texture_mapping"}


def graphs(scene):
    """(owner, tree, shader) of a material in a group, a world and a lamp."""
    material, tree, showing = common.shown(False)
    common.plane(material)
    group = bpy.data.node_groups.new("group", "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        group.outputs.new("NodeSocketColor", "Color")
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = group
    tree.links.new(outer.outputs[0], showing)
    yield "material 'shown'", group, group.nodes.new("NodeGroupOutput").inputs[0]
    world = scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    yield "world 'world'", world.node_tree, next(n for n in world.node_tree.nodes if n.type == "BACKGROUND").inputs["Color"]
    lamp = common.light(scene, "POINT")
    lamp.data.use_nodes = True
    yield "light 'point'", lamp.data.node_tree, next(n for n in lamp.data.node_tree.nodes if n.type == "EMISSION").inputs["Color"]


def planted():
    """Properties, sockets, words and outputs that nobody knows are named where they say something and lead to a picture."""
    scene, known, report = begin()
    kinds = "ShaderNodeTexNoise", "ShaderNodeMapping"
    bpy.types.ShaderNodeTexNoise.flavour = bpy.props.EnumProperty(name="Flavour", items=[("A", "Plain", ""), ("B", "Odd", "")])
    bpy.types.ShaderNodeTexNoise.hops = bpy.props.IntProperty(name="Number of Hops", default=3)
    bpy.types.ShaderNodeTexNoise.pull = bpy.props.FloatVectorProperty(name="Pull", default=(1.0, 2.0, 3.0))
    before = {kind: known.KINDS[kind] for kind in kinds}
    try:
        for owner, tree, socket in graphs(scene):
            noise, place = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeMapping")
            tree.links.new(place.outputs[0], noise.inputs["Vector"])
            tree.links.new(noise.outputs["Color"], socket)
            assert told(scene, report) == []

            def named(text, node=noise, owner=owner):
                return [f"{owner}: '{node.name}': {text} is not supported; left out"]

            noise.flavour = "B"
            assert told(scene, report) == named("Flavour"), told(scene, report)
            noise.flavour = "A"
            if not owner.startswith("material"):  # the rest is the same, and worlds take their time
                assert told(scene, report) == []
                continue
            noise.hops = 4
            assert told(scene, report) == named("Number of Hops (hops)")
            noise.hops, noise.pull = 3, (1, 2, 4)
            assert told(scene, report) == named("Pull")
            noise.mute = True
            assert told(scene, report) == []
            noise.mute, noise.pull = False, (1, 2, 3)
            noise.texture_mapping.scale = (2, 1, 1)
            assert told(scene, report) == named("Texture Mapping")
            noise.texture_mapping.scale = (1, 1, 1)
            aside = tree.nodes.new("ShaderNodeTexNoise")  # which leads nowhere
            aside.flavour = "B"
            # sockets, of which those that do not say 0 are what a new node says
            known.KINDS["ShaderNodeTexNoise"] = before["ShaderNodeTexNoise"]._replace(
                inputs=before["ShaderNodeTexNoise"].inputs - {"Roughness", "Scale", "Detail"})
            assert told(scene, report) == []
            noise.inputs["Roughness"].default_value = 0.7
            assert told(scene, report) == named("Roughness")
            noise.inputs["Roughness"].default_value = 0.5
            value = tree.nodes.new("ShaderNodeValue")
            link = tree.links.new(value.outputs[0], noise.inputs["Scale"])
            assert told(scene, report) == named("Scale")
            tree.links.remove(link)
            known.KINDS.update(before)
            # a word
            words = before["ShaderNodeMapping"].properties["vector_type"] - {"TEXTURE"}
            known.KINDS["ShaderNodeMapping"] = before["ShaderNodeMapping"]._replace(properties={"vector_type": words})
            assert told(scene, report) == []
            place.vector_type = "TEXTURE"
            assert named(f"{place.bl_rna.properties['vector_type'].name.replace('Type', 'Type (vector_type)')} Texture", place)[0] in told(
                scene, report), told(scene, report)
            known.KINDS.update(before)
    finally:
        known.KINDS.update(before)
        for name in ("flavour", "hops", "pull"):
            delattr(bpy.types.ShaderNodeTexNoise, name)


def pictures(scene):
    """(Cycles', ours)."""
    made = []
    for engine in ("CYCLES", "LIBSHADE"):
        scene.render.engine = engine
        common.render(PICTURE)
        made.append(picture())
    return made


def picture():
    """The last that was rendered."""
    image = bpy.data.images.load(PICTURE)
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[..., :3].astype(float)


def zone(tree, kind="RGBA"):
    """(first node, last node) of one that repeats an item."""
    first, last = tree.nodes.new("GeometryNodeRepeatInput"), tree.nodes.new("GeometryNodeRepeatOutput")
    first.pair_with_output(last)
    last.repeat_items.new(kind, "item")
    return first, last


def mixed(tree, mode, color, factor=1.0):
    """(socket, socket) of a colour that is mixed with another."""
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type, node.blend_type = "RGBA", mode
    by = {socket.identifier: socket for socket in node.inputs}
    by["Factor_Float"].default_value = factor
    by["B_Color"].default_value = (*color, 1)
    return by["A_Color"], next(socket for socket in node.outputs if socket.identifier == "Result_Color")


def repeated(tree, showing, times, number=None, start=(0.1, 0.05, 0.02, 1)):
    """A colour that is doubled so often. number: a node's output that says it."""
    first, last = zone(tree)
    first.inputs["item"].default_value = start
    first.inputs["Iterations"].default_value = times
    if number:
        tree.links.new(number, first.inputs["Iterations"])
    a, result = mixed(tree, "MULTIPLY", (2, 2, 2))
    tree.links.new(first.outputs["item"], a)
    tree.links.new(result, last.inputs["item"])
    tree.links.new(last.outputs["item"], showing)


def value_of(tree, number):
    node = tree.nodes.new("ShaderNodeValue")
    node.outputs[0].default_value = number
    return node.outputs[0]


def in_group(tree, showing):
    """A zone in a zone, in a group whose sockets say how often and from what; each time adds what time it is, a tenth each."""
    group = bpy.data.node_groups.new("group", "ShaderNodeTree")
    for name, way, kind in (("Color", "INPUT", "Color"), ("Times", "INPUT", "Int"), ("Color", "OUTPUT", "Color")):
        group.interface.new_socket(name, in_out=way, socket_type="NodeSocket" + kind)
    given, made = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    (first, last), (inner, end) = zone(group), zone(group)
    inner.inputs["Iterations"].default_value = 2
    link = group.links.new
    link(given.outputs["Color"], first.inputs["item"])
    link(given.outputs["Times"], first.inputs["Iterations"])
    link(first.outputs["item"], inner.inputs["item"])
    a, half = mixed(group, "MIX", (0, 0, 1), 0.5)
    link(inner.outputs["item"], a)
    link(half, end.inputs["item"])
    b, added = mixed(group, "ADD", (0, 0, 0))
    link(end.outputs["item"], b)
    tenth = group.nodes.new("ShaderNodeMath")
    tenth.operation = "MULTIPLY"
    tenth.inputs[1].default_value = 0.1
    link(first.outputs["Iteration"], tenth.inputs[0])
    link(tenth.outputs[0], b.node.inputs[next(k for k, s in enumerate(b.node.inputs) if s.identifier == "B_Color")])
    link(added, last.inputs["item"])
    link(last.outputs["item"], made.inputs["Color"])
    outer = tree.nodes.new("ShaderNodeGroup")
    outer.node_tree = group
    outer.inputs["Color"].default_value, outer.inputs["Times"].default_value = (1, 0.2, 0.1, 1), 2
    tree.links.new(outer.outputs[0], showing)


def menu(tree, showing, chosen, output="Output"):
    node = tree.nodes.new("GeometryNodeMenuSwitch")
    node.data_type = "RGBA"
    node.enum_items.new("third")
    for k, color in enumerate(((0.9, 0.1, 0.2, 1), (0.1, 0.8, 0.3, 1), (0.2, 0.3, 0.7, 1))):
        node.inputs[1 + k].default_value = color
    node.inputs["Menu"].default_value = chosen
    tree.links.new(node.outputs[output], showing)
    return node


def shaders(tree, _showing):
    """Of shaders, one of which is ours."""
    node = tree.nodes.new("GeometryNodeMenuSwitch")
    node.data_type = "SHADER"
    shine = tree.nodes.new("ShaderNodeEmission")
    shine.inputs["Color"].default_value = (0.3, 0.6, 0.9, 1)
    tree.links.new(tree.nodes.new("LibshadeMetalNode").outputs[0], node.inputs["A"])
    tree.links.new(shine.outputs[0], node.inputs["B"])
    node.inputs["Menu"].default_value = "B"
    tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Surface"])


# What shows, and the colour that it is.
CHOSEN = [
    (lambda tree, showing: repeated(tree, showing, 3), (0.8, 0.4, 0.16)),
    (lambda tree, showing: repeated(tree, showing, 0), (0.1, 0.05, 0.02)),
    (lambda tree, showing: repeated(tree, showing, 1, value_of(tree, 2.0)), (0.4, 0.2, 0.08)),
    (in_group, (0.0625 + 0.1, 0.0125 + 0.1, 0.94375 + 0.1)),
    (lambda tree, showing: menu(tree, showing, "third"), (0.2, 0.3, 0.7)),
    (lambda tree, showing: menu(tree, showing, "A"), (0.9, 0.1, 0.2)),
    (lambda tree, showing: menu(tree, showing, "B", "B"), (1, 1, 1)),
    (lambda tree, showing: menu(tree, showing, "B", "A"), (0, 0, 0)),
    (shaders, (0.3, 0.6, 0.9)),
]


def chosen():
    """Zones that repeat and switches, by what they say by hand and in Cycles, in a world too."""
    scene, _known, report = begin()
    for column, (make, _color) in enumerate(CHOSEN):
        material, tree, showing = common.shown(False, f"shown {column}")
        make(tree, showing)
        common.plane(material, 1).location = (column, 0, 0)
    scene.render.resolution_x, scene.render.film_transparent = 8 * (len(CHOSEN) + 1), False
    scene.camera.data.ortho_scale, scene.camera.location = len(CHOSEN) + 1, (len(CHOSEN) / 2, 0, 4)
    world = scene.world = bpy.data.worlds.new("world")
    menu(world.node_tree, world.node_tree.nodes["Background"].inputs["Color"], "third")
    theirs, ours = (picture[4, 4::8] for picture in pictures(scene))
    wanted = np.array([color for _make, color in CHOSEN] + [(0.2, 0.3, 0.7)])
    assert np.abs(ours - wanted).max() < 2e-4, np.c_[ours, wanted].round(3)
    assert np.abs(ours - theirs).max() < 2e-4, np.c_[ours, theirs].round(3)
    assert not [text for text, _error in report.told(scene) if "supported" in text], report.told(scene)


def unsure():
    """How often what depends on the place, and outputs that nobody knows, are named."""
    scene, known, report = begin()
    material, tree, showing = common.shown(False)
    common.plane(material)
    noise = tree.nodes.new("ShaderNodeTexNoise")
    repeated(tree, showing, 1, noise.outputs[0])
    common.render(PICTURE)
    assert any("'Repeat Output' (item) is not supported" in text for text, _error in report.told(scene)), report.told(scene)
    before = known.KINDS["ShaderNodeTexNoise"]
    known.KINDS["ShaderNodeTexNoise"] = before._replace(outputs={"Color"})
    try:
        tree.links.new(noise.outputs[0], showing)
        common.render(PICTURE)
        assert any(f"'{noise.name}' ({noise.outputs[0].name}) is not supported" in text for text, _error in report.told(scene)), report.told(scene)
    finally:
        known.KINDS["ShaderNodeTexNoise"] = before


def normals():
    """A plate with a normal map whose green points down is lit as one whose green is turned round, and as in Cycles."""
    scene, _known, _report = begin()
    scene.render.resolution_x = scene.render.resolution_y = 32
    common.light(scene, "SUN", rotation=(0.7, 0.4, 0.2))
    y, x = np.mgrid[0:32, 0:32] / 32
    slopes = np.stack([0.3 * np.cos(12 * x), 0.4 * np.sin(9 * y + 3 * x), np.ones_like(x)], -1)
    colors = 0.5 + 0.5 * slopes / np.linalg.norm(slopes, axis=-1, keepdims=True)
    material, tree, _showing = common.shown(False)
    matt, bump, texture = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "NormalMap", "TexImage"))
    tree.links.new(texture.outputs[0], bump.inputs["Color"])
    tree.links.new(bump.outputs[0], matt.inputs["Normal"])
    tree.links.new(matt.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    common.plane(material, 1)

    def seen(convention, turned):
        image = texture.image = bpy.data.images.new("normals", 32, 32, float_buffer=True, is_data=True)
        shown = np.concatenate([colors, np.ones((32, 32, 1))], -1)
        shown[..., 1] = 1 - shown[..., 1] if turned else shown[..., 1]
        image.pixels.foreach_set(shown.astype(np.float32).ravel())
        image.update()
        bump.convention = convention
        return pictures(scene)

    for space, strength, cubic in (("TANGENT", 1.0, False), ("TANGENT", 0.6, False), ("TANGENT", 1.0, True), ("OBJECT", 1.0, False)):
        bump.space, bump.inputs["Strength"].default_value = space, strength
        texture.interpolation = "Cubic" if cubic else "Linear"
        (_, up), (theirs, down), (_, turned) = seen("OPENGL", False), seen("DIRECTX", False), seen("OPENGL", True)
        far = [np.abs(down - other).mean() / theirs.mean() for other in (turned, up, theirs)]
        assert far[0] < 2e-4 and far[1] > 0.05 and far[2] < 0.004, (space, strength, cubic, far)


def rounds():
    scene, _known, _report = begin()
    material, tree, showing = common.shown(False)
    common.plane(material, 1)
    place, scaled, whole, back = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "VectorMath", "VectorMath", "VectorMath"))
    scaled.operation, whole.operation, back.operation = "MULTIPLY_ADD", "ROUND", "MULTIPLY_ADD"
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = (4, 3, 1), (-1.7, -1.2, 0.3)
    back.inputs[1].default_value, back.inputs[2].default_value = (0.1,) * 3, (0.5,) * 3
    for one, other in ((place.outputs["Generated"], scaled.inputs[0]), (scaled.outputs[0], whole.inputs[0]),
                       (whole.outputs[0], back.inputs[0]), (back.outputs[0], showing)):
        tree.links.new(one, other)
    theirs, ours = pictures(scene)
    assert np.abs(ours - theirs).max() < 1e-4 and len(np.unique(ours.round(3))) == 4


def thin():
    """A sheet before the half of a white world that is behind or before it, by hand: of light that meets a side r is reflected, and
    goes to and fro inside; what is matt goes on as far as it is scattered forward."""
    scene, _known, report = begin()
    angle = 0.5
    scene.camera.data.ortho_scale, scene.camera.rotation_euler, scene.camera.location = 0.1, (angle, 0, 0), (0, -4 * math.sin(angle), 4)
    scene.libshade.samples, scene.libshade.max_bounces, scene.render.film_transparent = 256, 8, False
    world = scene.world = bpy.data.worlds.new("world")
    tree = world.node_tree
    place, split, half = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "SeparateXYZ", "Math"))
    tree.links.new(place.outputs["Generated"], split.inputs[0])
    tree.links.new(split.outputs[2], half.inputs[0])
    tree.links.new(half.outputs[0], tree.nodes["Background"].inputs["Color"])
    half.inputs[1].default_value = 0
    material = bpy.data.materials.new("sheet")
    node = material.node_tree.nodes["Principled BSDF"]
    common.plane(material, 40)
    node.inputs["Thin Wall"].default_value = True
    before, within = math.cos(angle), math.sqrt(1 - (math.sin(angle) / 1.5) ** 2)
    r = sum(((a - b) / (a + b)) ** 2 for a, b in ((before, 1.5 * within), (1.5 * before, within))) / 2
    for color, roughness in (((1, 1, 1), 0.0), ((1, 1, 1), 0.3), ((0.8, 0.5, 0.2), 0.02), ((0.8, 0.5, 0.2), 0.8)):
        node.inputs["Transmission Weight"].default_value, node.inputs["Roughness"].default_value = 1, roughness
        node.inputs["Base Color"].default_value = (*color, 1)
        for way in ("GREATER_THAN", "LESS_THAN"):
            half.operation = way
            common.render(PICTURE)
            c = np.array(color) ** (1 / within)
            on = c * (1 - r) ** 2 / (1 - (c * r) ** 2)
            wanted = r + c * r * on if way == "GREATER_THAN" else on
            seen = picture().mean((0, 1))
            assert np.abs(seen - wanted).max() < 0.004, (color, roughness, way, seen, wanted)
    node.inputs["Transmission Weight"].default_value, node.inputs["Specular IOR Level"].default_value = 0, 0
    node.inputs["Subsurface Weight"].default_value = 0.8
    for forward in (0.0, 0.5, -0.4):
        node.inputs["Subsurface Anisotropy"].default_value = forward
        for way in ("GREATER_THAN", "LESS_THAN"):
            half.operation = way
            common.render(PICTURE)
            on = 0.8 * (1 + forward) / 2
            seen = picture().mean((0, 1))
            wanted = np.array((0.8, 0.5, 0.2)) * (on if way == "LESS_THAN" else 1 - on)
            assert np.abs(seen - wanted).max() < 0.004, (forward, way, seen, wanted)
    assert not any("Thin Wall" in text or "Subsurface" in text for text, _error in report.told(scene)), report.told(scene)


def dark():
    """A Principled BSDF's emission below 0 takes away of what it reflects."""
    scene, _known, _report = begin()
    common.light(scene, "SUN", rotation=(0.5, 0.6, 0))
    material = bpy.data.materials.new("dark")
    node = material.node_tree.nodes["Principled BSDF"]
    node.inputs["Emission Color"].default_value, node.inputs["Emission Strength"].default_value = (1, 0.2, 0.5, 1), -0.5
    node.inputs["Specular IOR Level"].default_value = 0
    common.plane(material, 1)
    scene.libshade.samples = 64  # the plate is a light, too
    seen = [[picture.mean((0, 1)) for picture in pictures(scene)] for node.inputs["Emission Strength"].default_value in (0, -0.5)]
    for lit, dark in zip(*seen):
        assert np.abs(lit - dark - (0.5, 0.1, 0.25)).max() < 2e-3, (lit, dark)


def data():
    """Denoising data have their names in Cycles' order; those that are missing are named."""
    scene, _known, report = begin()
    common.plane(common.shown(False)[0], 1)
    layer = bpy.context.view_layer
    layer.libshade.denoising_store_passes = layer.cycles.denoising_store_passes = True
    settings = scene.render.image_settings
    settings.media_type, settings.file_format = "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER"
    names = []
    for engine in ("CYCLES", "LIBSHADE"):
        scene.render.engine = engine
        common.render(PICTURE)
        with open(PICTURE, "rb") as file:
            text = file.read().decode("latin-1")
        places = {name: text.find(f"Denoising {name}") for name in ("Albedo", "Specular Albedo", "Normal", "Roughness", "Depth")}
        names.append([name for name in sorted(places, key=places.get) if places[name] >= 0])
    missing = ("Specular Albedo", "Roughness")
    assert set(missing) < set(names[0]) and names[1] == [name for name in names[0] if name not in missing], names
    assert any(all(f"Denoising {name}" in said for name in missing) for said, _error in report.told(scene)), report.told(scene)


globals()[what]()
print("all asserted")
common.finish()
