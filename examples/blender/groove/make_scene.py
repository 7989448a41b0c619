# SPDX-License-Identifier: Apache-2.0
"""Three brushed plates in Cycles: bumped, bumped with Libshade Groove before the shader, displaced; with `across`
Libshade Groove's *Tangent*, its *Strokes Across*, displaced.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup --addons libshade \
        -P examples/blender/groove/make_scene.py -- groove.png [across]
"""
import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

SLOPE, PERIODS, QUADS, TEXELS = 0.5, 2, 300, 512


def slopes(u, v):
    k = 2 * math.pi * PERIODS
    return SLOPE * np.cos(k * u) * np.sin(k * v), SLOPE * np.sin(k * u) * np.cos(k * v)


def normal_map():
    """The bumps' normals as a picture."""
    v, u = (np.indices((TEXELS, TEXELS)) + 0.5) / TEXELS
    x, y = slopes(u, v)
    pixels = np.ones((TEXELS, TEXELS, 4), np.float32)
    pixels[..., :3] = 0.5 + 0.5 * np.stack([-x, -y, np.ones_like(x)], -1) / np.sqrt(x * x + y * y + 1)[..., None]
    image = bpy.data.images.new("bumps", TEXELS, TEXELS, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.ravel())
    return image


def plate(name, quads):
    """A unit square, or as many quads of it, with the bumps in them."""
    side = np.linspace(0, 1, quads + 1)
    u, v = (a.ravel() for a in np.meshgrid(side, side))
    k = 2 * math.pi * PERIODS
    height = SLOPE / k * np.sin(k * u) * np.sin(k * v) * (quads > 1)
    first = (np.arange(quads)[:, None] * (quads + 1) + np.arange(quads)).ravel()
    faces = np.stack([first, first + 1, first + quads + 2, first + quads + 1], -1)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.stack([u - 0.5, v - 0.5, height], -1).tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    uv = np.stack([u, v], -1)[faces.ravel()].astype(np.float32)
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.ravel())
    mesh.update()
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def brushed(name, image=None):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader, output, tangent = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfAnisotropic", "OutputMaterial", "Tangent"))
    tangent.direction_type = "UV_MAP"
    shader.inputs["Color"].default_value = (0.8, 0.62, 0.42, 1)
    shader.inputs["Roughness"].default_value, shader.inputs["Anisotropy"].default_value = 0.4, 0.75
    tree.links.new(tangent.outputs[0], shader.inputs["Tangent"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    if image:
        texture, bump = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeNormalMap")
        texture.image = image
        tree.links.new(texture.outputs["Color"], bump.inputs["Color"])
        tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return material


def sun(energy, towards, angle):
    """Far away, so that all three plates have the same light."""
    data = bpy.data.lights.new("sun", "SUN")
    data.energy, data.angle = energy, angle
    ob = bpy.data.objects.new("sun", data)
    ob.rotation_euler = Vector(towards).to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(ob)


def keeps_lines(name, image):
    """Strokes stay on the lines of the surface."""
    made = brushed(name, image)
    bpy.data.objects[name].data.materials.append(made)
    bpy.ops.libshade.follow_bumps()
    tree = made.node_tree
    group = next(node for node in tree.nodes if node.type == "GROUP")
    shader = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBsdfAnisotropic")
    tree.links.new(group.outputs["Strokes Across"], shader.inputs["Tangent"])


def main(picture, across):
    scene = parts.begin()
    image = normal_map()
    follows = plate("follows", 1)
    follows.data.materials.append(brushed("follows", image))
    bpy.ops.libshade.follow_bumps()
    other = plate("other", 1)
    if across:
        keeps_lines("other", image)
    else:  # after the operator, which so has not met it
        other.data.materials.append(brushed("alone", image))
    displaced = plate("displaced", QUADS)
    displaced.data.materials.append(brushed("displaced"))
    (follows if across else other).location.x, displaced.location.x = -1.06, 1.06

    sun(1.2, (0.3, 0.5, 0.8), 0.2)
    sun(0.6, (-0.6, -0.2, 0.8), 0.4)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 3.24, (0, 0, 3)
    scene.collection.objects.link(camera)
    scene.camera = camera
    parts.room((0.06, 0.065, 0.075))
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.max_bounces = 128, False, 0
    scene.render.resolution_x, scene.render.resolution_y = 972, 324
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = picture
    bpy.ops.render.render(write_still=True)


words = sys.argv[sys.argv.index("--") + 1:]
main(words[0], "across" in words[1:])
