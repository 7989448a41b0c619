# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of others are full of: each scene by both engines, all of it shining, without noise."""

import os

import bpy
import numpy as np

import common


def brought(options):
    """Plates that shine with what a case says, seen from above. Returns what Blender made of the case."""
    scene = common.empty_scene(64, 64, samples=64)
    told = _CASES[options["what"]](scene, options)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=4)
    if options["engine"] == "CYCLES":
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 64, False, "BOX"
    else:
        scene.libshade.pixel_filter_type, scene.libshade.texture_blur = "BOX", 0.0
    common.render(options["picture"])
    return told or {}


def _shining(name):
    """A material's tree and the socket of what it shines with."""
    material = bpy.data.materials.new(name)
    tree = common.tree_of(material)
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return material, tree, shader.inputs["Color"]


def _plate(material, number, size=1.0):
    plate = common.plane(material, size)
    plate.location = (-1.5 + number % 4, 1.5 - number // 4, 0)
    return plate


def _alpha(_scene, options):
    """Images of each alpha mode, their alpha linked in the second row."""
    for number in range(8):
        image = bpy.data.images.new(f"image {number}", 8, 8, alpha=True, float_buffer=options["floats"])
        pixels = np.random.default_rng(5).random((64, 4)).astype(np.float32)
        pixels[::7, 3], pixels[::5, 3] = 0, 1
        if options["floats"]:
            pixels[:, :3] *= pixels[:, 3:]
        image.pixels.foreach_set(pixels.ravel())
        image.pack()
        image.alpha_mode = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")[number % 4]
        material, tree, color = _shining(f"image {number}")
        node = common.image_node(tree, image)
        node.interpolation = "Closest"
        tree.links.new(node.outputs["Color"], color)
        if number > 3:  # as something that changes nothing
            tree.links.new(node.outputs["Alpha"], color.node.inputs["Strength"])
        _plate(material, number)


def _spaces(_scene, _options):
    """Images of bytes in colour spaces of all kinds; of greyish colours, so that none is below 0 elsewhere."""
    names = ("Linear Rec.709", "Linear Rec.2020", "ACEScg", "Filmic sRGB", "AgX Base sRGB") if bpy.app.version >= (4, 0) else (
        "Linear", "Linear ACES", "Filmic sRGB", "XYZ", "Raw")
    for number, name in enumerate(names):
        image = bpy.data.images.new(name, 8, 8, alpha=True)
        pixels = 0.4 + 0.3 * np.random.default_rng(11).random((64, 4)).astype(np.float32)
        pixels[:, 3] = 1
        image.pixels.foreach_set(pixels.ravel())
        image.pack()
        image.colorspace_settings.name = name
        material, tree, color = _shining(name)
        node = common.image_node(tree, image)
        image.colorspace_settings.name = name
        node.interpolation = "Closest"
        tree.links.new(node.outputs["Color"], color)
        _plate(material, number)


def _groups(_scene, _options):
    """Vectors of groups that nothing feeds, for a texture, an image and a texture two groups deep."""
    image = bpy.data.images.new("image", 8, 8)
    image.pixels.foreach_set(np.random.default_rng(7).random(256).astype(np.float32))
    inner = None
    for number, kind in enumerate(("ShaderNodeTexVoronoi", "ShaderNodeTexImage", "ShaderNodeGroup")):
        inner, group = _group(kind, inner, image), inner
        material, tree, color = _shining(f"group {number}")
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = inner
        node.inputs[0].default_value = (0.3, 0.2, 0.1)
        tree.links.new(node.outputs[0], color)
        _plate(material, number)


def _group(kind, inside, image):
    group = bpy.data.node_groups.new(kind, "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("At", in_out="INPUT", socket_type="NodeSocketVector")
        group.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        group.inputs.new("NodeSocketVector", "At")
        group.outputs.new("NodeSocketColor", "Color")
    start, node, end = (group.nodes.new(k) for k in ("NodeGroupInput", kind, "NodeGroupOutput"))
    if kind == "ShaderNodeTexImage":
        node.image = image
    elif kind == "ShaderNodeGroup":
        node.node_tree = inside
    group.links.new(start.outputs[0], node.inputs[0])
    group.links.new(next(s for s in node.outputs if s.name == "Color"), end.inputs[0])
    return group


def _colors(scene, _options):
    """Collections and faces that make instances have colours, and what they show has others."""
    material, tree, color = _shining("instance")
    tree.links.new(tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"], color)
    kit = bpy.data.collections.new("kit")
    for number, shade in enumerate(((0.1, 0.7, 0.2, 1), (0.8, 0.2, 0.7, 1))):
        part = common.plane(material, 0.25)
        part.location, part.color = (0.375 * number, 0, 0), shade
        scene.collection.objects.unlink(part)
        kit.objects.link(part)
    for number in range(3):
        empty = common.link(scene, f"empty {number}", None, (-1.5 + number, 1.25, 0))
        empty.instance_type, empty.instance_collection, empty.color = "COLLECTION", kit, (0.9, 0.3 * number, 0.2, 1)
    grid = common.plane(None, 1.0)
    grid.location, grid.color, grid.instance_type, grid.show_instancer_for_render = (0, -1, 0), (0.2, 0.4, 0.9, 1), "FACES", False
    shown = common.plane(material, 0.5)
    shown.color, shown.parent = (1, 1, 0, 1), grid
    _plate(material, 12).color = (0.6, 0.5, 0.4, 1)


def _nothing(_scene, _options):
    """Attributes that are not there, and their alpha."""
    for number, (kind, output) in enumerate((k, o) for k in ("GEOMETRY", "OBJECT", "INSTANCER") for o in ("Color", "Alpha")):
        material, tree, color = _shining(f"{kind} {output}")
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = kind, "nothing"
        tree.links.new(node.outputs[output], color)
        _plate(material, number)


def _exposure(scene, _options):
    material, _tree, color = _shining("plate")
    color.default_value = (0.5, 0.4, 0.1, 1)
    _plate(material, 5)
    scene.cycles.film_exposure = 2.5
    scene.render.film_transparent = True


def _world(scene, _options):
    """A layer with a world of its own, where this Blender has such."""
    scene.render.film_transparent = False
    for number, shade in enumerate(((0.1, 0.6, 0.2, 1), (0.7, 0.2, 0.1, 1))):
        world = bpy.data.worlds.new(f"world {number}")
        common.tree_of(world).nodes["Background"].inputs["Color"].default_value = shade
        if not number:
            scene.world = world
        elif hasattr(scene.view_layers[0], "world_override"):
            scene.view_layers[0].world_override = world


def _windows(_scene, options):
    """An image whose path was written by Windows."""
    image = bpy.data.images.new("saved", 8, 8)
    image.pixels.foreach_set(np.random.default_rng(9).random(256).astype(np.float32) * 0.5 + 0.5)
    folder = os.path.join(options["where"], "inside")
    os.makedirs(folder, exist_ok=True)
    image.filepath_raw, image.file_format = os.path.join(folder, "it.png"), "PNG"
    image.save()
    found = bpy.data.images.load(image.filepath_raw, check_existing=False)
    found.filepath_raw = options["where"] + "/.\\inside\\it.png"
    found.reload()
    material, tree, color = _shining("plate")
    tree.links.new(common.image_node(tree, found).outputs["Color"], color)
    _plate(material, 5)


def _lost(_scene, options):
    """Normal maps without their file, and without an image."""
    lost = bpy.data.images.new("lost", 4, 4)
    lost.source, lost.filepath = "FILE", os.path.join(options["where"], "gone.png")
    lost.colorspace_settings.name = "Non-Color"
    for number, image in enumerate((lost, None)):
        material = bpy.data.materials.new("plate")
        tree = common.tree_of(material)
        shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        node = tree.nodes.new("ShaderNodeNormalMap")
        tree.links.new(common.image_node(tree, image).outputs["Color"], node.inputs["Color"])
        tree.links.new(node.outputs[0], shader.inputs["Normal"])
        _plate(material, 5 + number)
    common.light(bpy.context.scene, rotation=(0.5, 0.6, 0))


_CASES = {name[1:]: made for name, made in list(globals().items())
          if name in ("_alpha", "_spaces", "_groups", "_colors", "_nothing", "_exposure", "_world", "_windows", "_lost")}
