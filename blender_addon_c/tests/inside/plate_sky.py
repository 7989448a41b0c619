# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bumped brushed plate lacks of the displaced one under a studio's sky, in parts that add up.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup --addons libshade \\
        -P blender_addon_c/tests/inside/plate_sky.py -- FOLDER [SAMPLES]

The plate of compare/plate.py, seen from above, Anisotropic BSDF (Ashikhmin-Shirley). The truth is Cycles'
displaced plate with 4 bounces. From there one thing after the other is taken away: light that comes off
the plate itself (no bounces), then the plate's shadow on itself (it casts none). What is left is one
reflection off each point by its own normal, which is what a normal map can show at best.
Printed are mean absolute and mean signed differences over the truth's mean; noise is that of two seeds,
over the square root of two.
"""

import os
import sys

import bpy
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "..", "compare")]
import common
import groove


def world(scene, sky):
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    image = tree.nodes.new("ShaderNodeTexEnvironment")
    image.image = sky
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    tree.links.new(image.outputs["Color"], background.inputs["Color"])


def new_scene(engine, samples):
    scene = groove.new_scene(engine)
    for ob in [ob for ob in scene.objects if ob.type == "LIGHT"]:
        bpy.data.objects.remove(ob)
    world(scene, studio())
    scene.cycles.samples = scene.libshade.samples = samples
    scene.cycles.sample_clamp_direct = 0
    ours = scene.libshade
    ours.light_sampling_threshold = ours.blur_glossy = ours.sample_clamp_indirect = ours.sample_clamp_direct = 0
    ours.pixel_filter_type = "BOX"
    return scene


def studio(height=256):
    """A sky of 2 x 1, linear: dim, with a wide soft box and a narrow warm one well above the horizon."""
    y, x = np.mgrid[0:height, 0:2 * height] + 0.5  # rows from the bottom
    across, up = x / height * np.pi - np.pi, y / height * np.pi - np.pi / 2
    pixels = np.ones((height, 2 * height, 4), np.float32)
    pixels[..., :3] = np.where(up < 0, 0.03, 0.08)[..., None]
    for middle, half, color in (((-1.9, 0.9), (0.45, 0.3), (9, 8.6, 8)), ((1.2, 0.7), (0.2, 0.2), (16, 13, 9))):
        pixels[(abs(across - middle[0]) < half[0]) & (abs(up - middle[1]) < half[1]), :3] = color
    image = bpy.data.images.new("sky", 2 * height, height, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.ravel())
    return image


def read(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(groove.SIZE, groove.SIZE, 4)[..., :3].astype(float)


def blocks(step):
    side = groove.SIZE // 4
    return step.reshape(side, 4, side, 4, 3).mean((1, 3))


def main():
    folder, *more = common.arguments()
    samples = int(more[0]) if more else 256
    common.enable()
    taken = {}

    def render(name, scene, bounces, seed=0):
        path = os.path.join(folder, name + ".exr")
        for settings in (scene.cycles, scene.libshade):
            settings.max_bounces = settings.glossy_bounces = bounces
            settings.seed = seed
        common.render(path)
        taken[name] = read(path)

    for engine in ("CYCLES", "LIBSHADE"):
        scene, word = new_scene(engine, samples), engine.lower()
        flat, fine = (common.link(scene, word, groove.new_plate(quads)) for quads in (1, 300))
        material = groove.new_material("across", groove.bumps())[0]
        flat.data.materials.append(material)
        fine.data.materials.append(groove.new_material("across")[0])
        flat.hide_render = True
        render(word + "_truth", scene, 4)
        render(word + "_again", scene, 4, 1)
        render(word + "_alone", scene, 0)
        fine.visible_shadow = fine.visible_glossy = False  # rays that may go no further meet the sky, too
        render(word + "_open", scene, 0)
        fine.hide_render, flat.hide_render = True, False
        render(word + "_bumped", scene, 4)
        if engine == "CYCLES":
            assert bpy.ops.libshade.follow_bumps() == {"FINISHED"}
            render("cycles_groove", scene, 4)

    truth = taken["cycles_truth"]

    def tell(what, a, b, scale=1.0):
        step = (taken[a] - taken[b]) / truth.mean() * scale
        four = blocks(step)
        print(f"{what}: {np.abs(step).mean():.4f} absolute, {np.abs(four).mean():.4f} by 4 x 4, {step.mean():+.4f} signed",
              flush=True)

    for word in ("cycles", "libshade"):
        tell(word + " noise", word + "_again", word + "_truth", 0.5**0.5)
        tell(word + " displaced, one off the other", word + "_truth", "cycles_truth")
        tell(word + " light off itself", word + "_alone", word + "_truth")
        tell(word + " own shadow", word + "_open", word + "_alone")
        tell(word + " left to the normal map", word + "_bumped", word + "_open")
        tell(word + " bumped, all", word + "_bumped", word + "_truth")
    tell("cycles with Libshade Groove, left to it", "cycles_groove", "cycles_open")
    tell("cycles with Libshade Groove, all", "cycles_groove", "cycles_truth")
    common.finish()


if __name__ == "__main__":
    main()
