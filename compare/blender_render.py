# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: render the open file with our engine to a 32-bit float OpenEXR.

    blender -b --factory-startup --addons libshade SCENE.blend --python-exit-code 9 \
        -P blender_render.py -- OUT.exr PERCENT SAMPLES

PERCENT scales the file's resolution. With LIBSHADE_DUMP=FILE in the environment
the engine also leaves its dump. Prints "size WIDTH HEIGHT".
"""
import os
import sys

import bpy


def main(path, percent, samples):
    scene = bpy.context.scene
    render = scene.render
    render.engine = "LIBSHADE"
    scene.libshade.samples = int(samples)
    scene.libshade.max_bounces = 0
    scene.libshade.pixel_filter_type = "BOX"  # as POV-Ray's
    scene.libshade.light_sampling_threshold = 0
    scene.libshade.soft_terminator = scene.libshade.filter_normals = False  # as export_povray.py writes it
    if scene.world:  # the background of POV-Ray lights nothing
        for kind in ("diffuse", "glossy", "transmission", "scatter"):
            setattr(scene.world.cycles_visibility, kind, False)
    render.resolution_percentage = int(percent)
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.filepath = os.path.abspath(path)
    render.use_file_extension = False
    bpy.ops.render.render(write_still=True)
    scale = render.resolution_percentage / 100.0
    print("size", int(render.resolution_x * scale), int(render.resolution_y * scale))


main(*sys.argv[sys.argv.index("--") + 1:])
