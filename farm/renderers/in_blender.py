# SPDX-License-Identifier: Apache-2.0
"""Runs inside Blender, by --python-expr; its words follow `--farm`: what to do, and a JSON of what for."""

import json
import os
import sys

import bpy


def paths():
    """Of all files that this one reads; folders of caches whole."""
    found = {bpy.data.filepath, *bpy.utils.blend_paths(absolute=True, packed=False, local=False)}
    for image in bpy.data.images:
        if image.source in ("SEQUENCE", "TILED") and image.filepath and not image.packed_file:
            found.update(beside(bpy.path.abspath(image.filepath, library=image.library)))
    stem, here = os.path.splitext(os.path.basename(bpy.data.filepath))[0], os.path.dirname(bpy.data.filepath)
    folders = [os.path.join(here, f"blendcache_{stem}")]
    for ob in bpy.data.objects:
        for modifier in ob.modifiers:
            domain = getattr(modifier, "domain_settings", None)
            if domain and domain.cache_directory:
                folders.append(bpy.path.abspath(domain.cache_directory))
    for folder in folders:
        found.update(os.path.join(at, name) for at, _, names in os.walk(folder) for name in names)
    return sorted(os.path.abspath(path) for path in found if path)


def beside(path):
    """Files whose names differ from it in digits alone, or in what stands for a tile's number."""
    import re

    def shape(name):
        return re.sub(r"<UDIM>|<UVTILE>|u\d+_v\d+|\d+", "#", name)
    folder, name = os.path.split(path)
    return [os.path.join(folder, one) for one in (os.listdir(folder) if os.path.isdir(folder) else []) if shape(one) == shape(name)]


def examine(said):
    scene = bpy.context.scene
    editor = scene.sequence_editor
    strips = editor and (getattr(editor, "strips_all", None) or getattr(editor, "sequences_all", None))  # older ones' name
    nodes = scene.compositing_node_group if hasattr(scene, "compositing_node_group") else scene.use_nodes  # from 5.0 on that is always so
    with open(said["place"], "w", encoding="utf-8") as file:
        json.dump({"inputs": paths(), "frames": [scene.frame_start, scene.frame_end, scene.frame_step], "frame": scene.frame_current,
                   "rate": scene.render.fps / scene.render.fps_base, "engine": scene.render.engine,
                   "composites": bool(scene.render.use_compositing and nodes),
                   "sequences": bool(scene.render.use_sequencer and strips)}, file)


def render(said):
    """One whole frame, as the file says it is written."""
    scene = bpy.context.scene
    if scene.render.image_settings.file_format in ("FFMPEG", "AVI_JPEG", "AVI_RAW"):
        if hasattr(scene.render.image_settings, "media_type"):
            scene.render.image_settings.media_type = "IMAGE"
        scene.render.image_settings.file_format = "PNG"
    scene.render.use_file_extension = True
    scene.render.use_overwrite, scene.render.use_placeholder = True, False
    scene.frame_set(said["frame"])
    scene.render.filepath = said["place"]
    bpy.ops.render.render(write_still=True)


def save(said):
    """What a frame would hand to the renderer."""
    scene = bpy.context.scene
    scene.frame_set(said["frame"])
    if bpy.ops.libshade.save_scene(filepath=said["place"]) != {"FINISHED"}:
        raise RuntimeError("the scene cannot be saved")


def pack(said):
    bpy.ops.file.pack_all()
    bpy.ops.file.pack_libraries()
    bpy.ops.wm.save_as_mainfile(filepath=said["place"], copy=True, compress=True)


def main():
    words = sys.argv[sys.argv.index("--farm") + 1:]
    {"examine": examine, "render": render, "save": save, "pack": pack}[words[0]](json.loads(words[1]))


main()
