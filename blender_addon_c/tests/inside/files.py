# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of many files or pictures: tiles, sequences and movies."""

import importlib
import os

import bpy

import common


def _write(path, number, size):
    image = bpy.data.images.new("part", size, size)
    image.pixels.foreach_set([(0.1 + 0.2 * number, (k % size) / size, (k // size) / size, 1.0)[c]
                              for k in range(size * size) for c in range(4)])
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    bpy.data.images.remove(image)


def _tiled(folder):
    """Four places, one of them without a tile."""
    for number, tile in enumerate((1001, 1002, 1012)):
        _write(os.path.join(folder, f"part.{tile}.png"), number, 8)
    image = bpy.data.images.load(os.path.join(folder, "part.1001.png"))
    image.source = "TILED"
    image.filepath = os.path.join(folder, "part.<UDIM>.png")
    for tile in (1002, 1012):
        if not any(t.number == tile for t in image.tiles):
            image.tiles.new(tile)
    return image


def _sequence(folder):
    for number in (1, 2, 3):
        _write(os.path.join(folder, f"part.{number:03}.png"), number, 8)
    image = bpy.data.images.load(os.path.join(folder, "part.001.png"))
    image.source = "SEQUENCE"
    return image


def _movie(folder):
    """The pictures of the sequence in one file, without losses, by Blender's sequencer."""
    _sequence(folder)
    scene = bpy.data.scenes.new("movie")
    render, editor = scene.render, scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    for number in (1, 2, 3):
        strips.new_image(name=str(number), filepath=os.path.join(folder, f"part.{number:03}.png"), channel=1,
                         frame_start=number)
    render.resolution_x = render.resolution_y = 16
    render.resolution_percentage, scene.frame_start, scene.frame_end = 100, 1, 3
    scene.view_settings.view_transform = "Standard"
    if hasattr(render.image_settings, "media_type"):  # from 5.0 on
        render.image_settings.media_type = "VIDEO"
    render.image_settings.file_format = "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec = "AVI", "FFV1"
    render.filepath, render.use_file_extension = os.path.join(folder, "movie.avi"), False
    bpy.ops.render.render(animation=True, scene=scene.name)
    bpy.data.scenes.remove(scene)
    return bpy.data.images.load(os.path.join(folder, "movie.avi"))


def _shown(options):
    if "frame" not in options:
        return _tiled(options["where"])
    return (_movie if options["source"] == "MOVIE" else _sequence)(options["where"])


def many_files(options):
    """A plate of UVs from 0 to 2 that shows them. "frame": of a sequence or a movie."""
    scene = common.empty_scene(32, 32, samples=1)
    scene.frame_set(options.get("frame", 1))
    material, tree, metal = common.metal(fresnel="NONE", detail="NONE")
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = _shown(options)
    node.interpolation = "Closest"
    user = node.image_user
    user.frame_start, user.frame_duration, user.frame_offset = 2, 2, options.get("offset", 0)
    user.use_cyclic, user.use_auto_refresh = options.get("cyclic", False), options.get("refresh", True)
    if options.get("packed"):
        node.image.pack()
        for name in os.listdir(options["where"]):
            if name.endswith(".png"):
                os.remove(os.path.join(options["where"], name))
    plate = common.plane(material)
    for corner in plate.data.uv_layers.active.data:
        corner.uv = 2 * corner.uv
    if options["engine"] == "CYCLES":
        shader = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(node.outputs["Color"], shader.inputs["Color"])
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.filter_width = 1, False, 0.01
    else:
        tree.links.new(node.outputs["Color"], metal.inputs["Color"])
    common.light(scene)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=2)
    common.render(options["picture"])
    return {"path": bpy.path.abspath(node.image.filepath_from_user(image_user=user))}


def held_image(options):
    """A plate that shines with an image of bytes or floats, which the add-on holds in memory or, as a large one, in a file."""
    scene = common.empty_scene(32, 32, samples=1)
    held = importlib.import_module(common.MODULE + ".export.image")
    image = bpy.data.images.new("held", 16, 16, float_buffer=options["floats"])
    image.pixels.foreach_set([1.0 if k % 4 == 3 else (k * 37 % 101) / 101 for k in range(4 * 16 * 16)])
    material = bpy.data.materials.new("plate")
    tree = common.tree_of(material)
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(common.image_node(tree, image).outputs["Color"], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    common.plane(material)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=2)
    large, rooms, own_room = held._LARGE, [], held._room

    def room(*given):
        rooms.append(own_room(*given))
        return rooms[-1]

    held._LARGE, held._room = 1 if options["in_file"] else large, room
    try:
        common.render(options["picture"])
    finally:
        held._LARGE, held._room = large, own_room
    return {"files": sum(pages is not None for _data, pages in rooms)}
