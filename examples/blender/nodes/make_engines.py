# SPDX-License-Identifier: Apache-2.0
"""Libshade Metal (brushed brass with bumps), Fabric (denim) and Scratches (baked, before a steel) on Blender's monkey: a
row by our engine, one by Cycles and one by EEVEE, which needs a screen.

    BLENDER_USER_SCRIPTS=build/blender LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a \
        blender -b --factory-startup --addons libshade --python-exit-code 1 -P examples/blender/nodes/make_engines.py -- PICTURE.jpg
"""
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

WIDE, HIGH, SAMPLES = 900, 210, 64


def brass():
    made = parts.metal("brass", (0.9, 0.72, 0.36), 0.35, 0.7)
    tree = made.node_tree
    shader = next(node for node in tree.nodes if node.bl_idname == "LibshadeMetalNode")
    noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
    noise.inputs["Scale"].default_value = 7
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.3, 0.1
    tree.links.new(noise.outputs["Fac"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return made


def scratched():
    scratches = parts.of_addon("scratches")
    made = parts.metal("steel", (0.62, 0.60, 0.58), 0.3)
    tree = made.node_tree
    node = tree.nodes.new(scratches.SCRATCHES)
    scratches.apply_preset(node, "DEEP")
    node.size = 0.12
    scratches.bake(node, "steel", bpy.context.scene)
    tree.links.new(node.outputs["Normal"], next(n for n in tree.nodes if n.bl_idname == "LibshadeMetalNode").inputs["Normal"])
    return made


def monkey(made, x):
    bpy.ops.mesh.primitive_monkey_add(size=0.11, location=(x, 0, 0), rotation=(-0.35, 0, 0.5 * -x / 0.14))
    item = bpy.context.object
    bpy.ops.object.shade_smooth()
    item.modifiers.new("fine", "SUBSURF").render_levels = 3
    item.data.materials.append(made)


def rows(folder):
    eevee = "BLENDER_EEVEE_NEXT" if (4, 2) <= bpy.app.version < (5, 0) else "BLENDER_EEVEE"
    for engine in ("LIBSHADE", "CYCLES", eevee):
        path = os.path.join(folder, f"{engine}.png")
        bpy.context.scene.eevee.taa_render_samples = SAMPLES
        parts.render(path, engine, WIDE, HIGH, SAMPLES)
        image = bpy.data.images.load(path)
        yield np.array(image.pixels[:], np.float32).reshape(HIGH, WIDE, 4)


def main(picture):
    parts.begin()
    denim, node = parts.material("denim", "LibshadeFabricNode")
    node.preset, node.size = "DENIM", 0.06
    for x, made in ((-0.14, brass()), (0, denim), (0.14, scratched())):
        monkey(made, x)
    parts.sky("interior", 0.6, 2.1, (0.05, 0.05, 0.05))
    parts.lamp(2.2, (-0.4, -0.6, 0.5), (0, 0, 0), 0.12)
    parts.camera((0, -0.62, 0.02), (0, 0, 0), 46)
    with tempfile.TemporaryDirectory() as folder:
        sheet = np.concatenate(list(rows(folder))[::-1])
    made = bpy.data.images.new("sheet", WIDE, 3 * HIGH)
    made.pixels.foreach_set(sheet.ravel())
    made.filepath_raw, made.file_format = os.path.abspath(picture), "JPEG"
    made.save()


main(sys.argv[sys.argv.index("--") + 1])
