# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of many files: tiles and sequences."""

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


def many_files(options):
    """A plate of UVs from 0 to 2 that shows them. "frame": of a sequence."""
    scene = common.empty_scene(32, 32, samples=1)
    scene.frame_set(options.get("frame", 1))
    material, tree, metal = common.metal(fresnel="NONE", detail="NONE")
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = _sequence(options["where"]) if "frame" in options else _tiled(options["where"])
    node.interpolation = "Closest"
    user = node.image_user
    user.frame_start, user.frame_duration, user.frame_offset = 2, 2, options.get("offset", 0)
    user.use_cyclic, user.use_auto_refresh = options.get("cyclic", False), True
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
