# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of one tile of a scratches node's field, which other renderers show."""

import json
import struct
import zlib
from math import pi, remainder

import bpy
import numpy as np

from .. import _native
from ..export import size
from . import tree as scratch_tree
from .field import description, metres
from .tree import VECTOR

MADE = "libshade_scratch_images"  # on the tree: texels, samples, are they points?
_ALONG_X = 0.1  # radians
SIZES = 512, 1024, 1536, 2048, 4096, 8192


def _source(node):
    """What feeds Vector, past reroutes: (kind of place for tree.py, UV map whose tangents fit or None)."""
    socket = node.inputs[VECTOR]
    while socket.is_linked:
        link = socket.links[0]
        source = link.from_node
        if source.bl_idname == "NodeReroute":
            socket = source.inputs[0]
        elif source.bl_idname == "ShaderNodeUVMap":
            return "VECTOR", source.uv_map
        else:
            return "VECTOR", "" if link.from_socket.name == "UV" and source.bl_idname == "ShaderNodeTexCoord" else None
    return ("UV", node.uv_map) if node.unit == "UV" else ("OBJECT", None)


def _stamp(node, unit, tile):
    """What images depend on. tile: of the images, metres."""
    said = description(node, unit)
    if not said["tile"] == node.tile * unit:  # it is that of the images themselves
        said["tile"] = 0.0
    return json.dumps([said, metres(node, unit), *_source(node), tile])


def is_stale(node, scene):
    try:
        tile = json.loads(node.baked)[-1]
    except (ValueError, IndexError):
        return True
    return node.baked != _stamp(node, size.unit_of(scene), tile)


def tile_of_images(said, texels):
    """Metres: a node's own; where it is chosen, so small that a third of a scratch's width is a texel, but two lengths."""
    if said["tile"] > 0:
        return said["tile"]
    wanted = max(texels * said["width"] / 3, 2 * said["length"]) * 1e-3
    return min(wanted, _native.scratches(said)["tile"])


def _image(name, values, floats):
    height, width, _channels = values.shape
    image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=floats, is_data=True)
    image.pixels.foreach_set(values.ravel())
    image.update()
    image.pack()
    return image


def _png(levels):
    """The file of a picture of bytes, height x width x 3 from the bottom: Blender's own packs half as tightly."""
    rows = levels[::-1].astype(np.uint8)
    height, width, _channels = rows.shape
    beside = rows.copy()
    beside[:, 1:] -= rows[:, :-1]
    kinds = [np.concatenate([np.full((height, 1), kind, np.uint8), values.reshape(height, -1)], 1) for kind, values in ((0, rows), (1, beside))]
    packed = min((zlib.compress(filtered.tobytes(), 9) for filtered in kinds), key=len)
    chunks = (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", packed), (b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
                                          for kind, data in chunks)


def _image_of_bytes(name, levels):
    file = _png(levels)
    image = bpy.data.images.new(name, levels.shape[1], levels.shape[0], alpha=False, is_data=True)
    image.pack(data=file, data_len=len(file))
    image.source = "FILE"
    image.colorspace_settings.is_data = True
    return image


def _points_of(said, texels):
    """Levels (256) of points of a field, and metres that level 0 of its height is deep. It has x and y of normals,
    of which level 128 is exactly 0, and the height, of which 255 is 0; no scratch has that, so that it says the mask, too.
    Where all strokes go along x, half as many points along them, and twice as many across."""
    along = abs(remainder(said["direction"], pi)) + said["spread"] < _ALONG_X and texels <= 2048  # of memory
    fine = 2 * texels if along else texels
    normal, height = (np.frombuffer(picture, np.float32).reshape(fine, fine, 4)[:, ::4 if along else 1]
                      for picture in _native.scratch_images(said, fine, 1)[:2])
    heights, levels = height[..., 0], np.rint(254 * normal[..., :3] - 127) + 128
    deepest = max(-float(heights.min()), 1e-12)
    levels[..., 2] = np.where(heights < 0, np.minimum(np.rint(255 + 255 * heights / deepest), 254), 255)
    return levels, deepest


def bake(node, owner, scene, texels=2048, samples=3, tile=0.0, points=False):
    """Images of one tile, in the node's group, which our engine repeats then, too; (metres that it is wide, what was
    left out). owner: whose name they get. tile: in the scene's units, becomes the node's own; 0: as the node has it.
    points: of points, by one image of 8 bits; else of means of samples^2 points, by three of floats."""
    unit = size.unit_of(scene)
    drop(node)
    if tile:
        node.tile = tile
    said = description(node, unit)
    said["tile"] = tile_of_images(said, texels)
    plan = _native.scratches(said)
    name, deepest = f"{owner} {node.name}", None
    if points:
        levels, deepest = _points_of(said, texels)
        images = [_image_of_bytes(name, levels)]
    else:
        data = _native.scratch_images(said, texels, samples)
        images = [_image(f"{name} {what}", np.frombuffer(picture, np.float32).reshape(texels, texels, 4), what != scratch_tree.MASK)
                  for what, picture in zip(("Normal", scratch_tree.HEIGHT, scratch_tree.MASK), data)]
    place, uv_map = _source(node)
    node.node_tree = scratch_tree.baked(images, place, metres(node, unit) / plan["tile"], uv_map, plan["tile"], unit, deepest)
    node.node_tree[MADE] = [texels, samples, int(points)]
    node.baked = _stamp(node, unit, plan["tile"])
    return plan


def drop(node):
    """Other renderers see none again."""
    tree, node.node_tree, node.baked = node.node_tree, scratch_tree.plain(), ""
    if scratch_tree.is_plain(tree) or tree.users:
        return
    images = {inner.image for inner in tree.nodes if inner.bl_idname == "ShaderNodeTexImage" and inner.image}
    bpy.data.node_groups.remove(tree)
    for image in images:
        if not image.users:
            bpy.data.images.remove(image)
