# SPDX-License-Identifier: Apache-2.0
"""Steel plates on slate, scratched: brushed, used, and used with deep ones over it. `near`: a part of one, closely.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade --python-exit-code 1 -P make_scene.py -- PICTURE.png [near] [cycles] [SAMPLES]
"""
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

STEEL = (0.62, 0.60, 0.58)
WIDE, LONG, THICK = 0.05, 0.11, 0.003  # metres


def scratched(name, roughness, *presets):
    """Steel, scratched by one preset after the other."""
    scratches = parts.of_addon("scratches")
    made = parts.metal(name, STEEL, roughness)
    tree = made.node_tree
    shader = next(node for node in tree.nodes if node.bl_idname == "LibshadeMetalNode")
    shader.distribution, shader.brdf = "BECKMANN", "MICROFACET"
    before = None
    for place, preset in enumerate(presets):
        node = tree.nodes.new(scratches.SCRATCHES)
        scratches.apply_preset(node, preset)
        node.unit, node.seed, node.location = "METRES", place + 3, (240 * (place - len(presets)), 0)
        if before:
            tree.links.new(before.outputs["Normal"], node.inputs["Normal"])
        if CYCLES:
            scratches.bake(node, name, bpy.context.scene, points=not NEAR)
        before = node
    tree.links.new(before.outputs["Normal"], shader.inputs["Normal"])
    return made


def plate(made, x, turn):
    bpy.ops.mesh.primitive_cube_add(size=1, location=(x, 0, THICK / 2), rotation=(0, 0, turn))
    item = bpy.context.object
    item.dimensions = LONG, WIDE, THICK
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    edge = item.modifiers.new("edge", "BEVEL")
    edge.width, edge.segments = 0.0007, 3
    item.data.materials.append(made)


def build():
    parts.begin()
    bpy.ops.mesh.primitive_plane_add(size=4)
    bpy.context.object.data.materials.append(parts.plain("slate", (0.02, 0.021, 0.023), 0.5))
    for place, (name, roughness, presets) in enumerate((
            ("brushed", 0.25, ("BRUSHED",)), ("used", 0.2, ("FINE_POLISH", "USED")), ("deep", 0.2, ("FINE_POLISH", "USED", "DEEP")))):
        plate(scratched(name, roughness, *presets), 0.066 * (place - 1), 1.5707963)
    parts.sky("forest", 1.0, 0.0)
    parts.lamp(0.025, (0.05, 0.22, 0.3), (0, 0, 0), 0.03)
    if NEAR:
        parts.camera((0.066, -0.05, 0.075), (0.062, 0.012, 0), 70)
    else:
        parts.camera((0.0, -0.24, 0.3), (0, 0.0, 0), 60)


NEAR, CYCLES = "near" in sys.argv, "cycles" in sys.argv
sys.argv = [word for word in sys.argv if word != "near"]
parts.main(build, 600, 400, 128)
