# SPDX-License-Identifier: GPL-3.0-or-later
"""A hundred renders of scenes that differ. Prints "RENDERED how, MiB of memory" for each."""

import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

RENDERS = 100


def image(name, side=256):
    """A picture of noise."""
    made = bpy.data.images.new(name, side, side, float_buffer=True, is_data=True)
    made.pixels.foreach_set(np.random.default_rng(1).random(4 * side * side, np.float32))
    made.update()
    return made


def build():
    """A height field of 7000 triangles, instances of it, images on it and around it."""
    scene = common.empty_scene(16, 12, 1)
    scene.libshade.max_bounces = 2
    steel, tree, node = common.metal("steel", ex=6, ey=2)
    texture = common.image_node(tree, image("color"))
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    common.normal_map(tree, node, image("normal"))
    plain = bpy.data.materials.new("plain")
    common.tree_of(plain)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=2)
    field = common.added(steel)
    more = [common.link(scene, "more", field.data, (x, 0, -1)) for x in (-2, 0, 2)]
    bpy.ops.mesh.primitive_uv_sphere_add(location=(0, 0, 1), radius=0.3)
    common.added(plain)
    common.camera(scene)
    common.light(scene)
    common.light(scene, "POINT", 30.0, 0.1, location=(0, 0, 3))
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    sky = tree.nodes.new("ShaderNodeTexEnvironment")
    sky.image = image("sky")
    tree.links.new(sky.outputs[0], tree.nodes["Background"].inputs["Color"])
    return scene, field, more, (steel, plain), scene.world


def vary(k, scene, field, more, materials, world):
    """What the k-th render has; (k + 1) % 10 == 0: an error."""
    field.data.materials[0] = materials[k % 3 == 0]
    scene.world = world if k % 2 else None
    more[0].hide_render = k % 4 == 0
    more[1].scale.x = -1 if k % 5 == 0 else 1
    scene.render.film_transparent = k % 7 == 0
    scene.render.use_border = k % 6 == 0
    scene.render.border_max_x = 0.5
    bpy.context.view_layer.use_pass_normal = bpy.context.view_layer.use_pass_z = k % 5 == 0
    blind = (k + 1) % 10 == 0
    scene.camera.data.type, scene.camera.data.ortho_scale = ("ORTHO", 0.0) if blind else ("PERSP", 6.0)
    field.data.vertices[0].co.z = 0.001 * k


parts = build()
for k in range(RENDERS):
    vary(k, *parts)
    try:
        bpy.ops.render.render()
        how = "finished"
    except RuntimeError:
        how = "error"
    print("RENDERED", how, common.resident(), flush=True)
common.finish()
