# SPDX-License-Identifier: GPL-3.0-or-later
"""A scratched plate of Libshade Metal by our engine and, its scratches baked to images, by Cycles, in light.

arguments: FOLDER [CASE ...]; writes FOLDER/CASE_libshade.exr and CASE_cycles.exr of each, by default all of CASES.
"""

import importlib
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

SIZE, SAMPLES = 128, 64
WIDTH = 0.6  # mm, of scratches
# Metres of which the picture shows half; what Vector is; the tile, metres (0: what Bake to Images chooses), and its texels.
CASES = {"near": (0.04, "uv", 0.04, 1024), "near default": (0.04, "uv", 0.0, 1024), "medium": (0.16, "uv", 0.16, 2048),
         "medium default": (0.16, "uv", 0.0, 2048), "near object": (0.04, "object", 0.04, 1024),
         "medium object": (0.16, "object", 0.16, 2048)}


def scene_of(wide):
    scene = common.empty_scene(SIZE, SIZE, SAMPLES)
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising, cycles.max_bounces = SAMPLES, False, False, 0
    cycles.pixel_filter_type, cycles.filter_width, scene.libshade.pixel_filter_type = "BLACKMAN_HARRIS", 1.5, "BLACKMAN_HARRIS"
    lean = math.radians(30)
    common.camera(scene, (0, -math.sin(lean), math.cos(lean)), (lean, 0, 0), type="ORTHO", ortho_scale=wide / 2)
    common.light(scene, rotation=(math.radians(-35), 0.1, 0), size=0.2)
    common.light(scene, energy=1.0, rotation=(0.2, 0.9, 0), size=0.1)
    world = scene.world = bpy.data.worlds.new("even")
    tree = common.tree_of(world)
    next(n for n in tree.nodes if n.type == "BACKGROUND").inputs["Color"].default_value = (0.2, 0.2, 0.2, 1)
    return scene


def pictures(case, folder):
    wide, vector, tile, texels = CASES[case]
    scene = scene_of(wide)
    material, tree, metal = common.metal("plate", fresnel="NONE", horizon="VALID_ESTEVEZ")  # Cycles' bumps do not shade each other
    metal.inputs["Roughness"].default_value, metal.inputs["Anisotropy"].default_value = 0.4, 0.0
    node = tree.nodes.new("LibshadeScratchesNode")
    node.size = 2 * wide
    node.unit = "UV" if vector == "uv" else "METRES"
    for name, value in {"Density per cm²": 3.0, "Length mm": 15.0, "Width mm": WIDTH, "Depth": 0.25}.items():
        node.inputs[name].default_value = value
    scratches = importlib.import_module(common.MODULE + ".scratches")
    plan = scratches.bake(node, "plate", scene, texels, 3, tile)
    print("TILE", case, plan["tile"], flush=True)
    tree.links.new(node.outputs["Normal"], metal.inputs["Normal"])
    common.plane(material, 2 * wide)
    for engine in ("LIBSHADE", "CYCLES"):
        scene.render.engine = engine
        common.render(os.path.join(folder, f"{case}_{engine.lower()}.exr"))


if __name__ == "__main__":
    folder, *cases = common.arguments()
    for case in cases or CASES:
        pictures(case, folder)
    print("all rendered", flush=True)
    common.finish()
