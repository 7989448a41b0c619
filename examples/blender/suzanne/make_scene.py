# SPDX-License-Identifier: Apache-2.0
"""Build the brushed-steel Suzanne scene. Run inside Blender:

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade --python-exit-code 1 -P make_scene.py -- OUT.blend

The normal maps are written beside OUT.blend, in textures/.
"""
import math
import os
import sys

import bpy
import numpy as np
from mathutils import Vector

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = FOLDER, os.path.dirname(FOLDER)
import bumps  # noqa: E402
import parts  # noqa: E402

STEEL = (0.60, 0.585, 0.565)


def save_normal_map(path, normals):
    """Write unit normals (rows from the bottom) as a 16-bit PNG without gamma."""
    size = len(normals)
    pixels = np.ones((size, size, 4), np.float32)
    pixels[..., :3] = 0.5 + 0.5 * normals
    image = bpy.data.images.new("normals", size, size, float_buffer=True, is_data=True)
    image.pixels.foreach_set(pixels.ravel())
    scene = bpy.data.scenes.new("for saving")
    scene.view_settings.view_transform = "Raw"
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "16"
    image.save_render(path, scene=scene)
    bpy.data.scenes.remove(scene)
    bpy.data.images.remove(image)


def load_normal_map(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    return image


def metal_node(tree, ex, ey):
    node = tree.nodes.new("LibshadeMetalNode")
    node.ex, node.ey = ex, ey
    node.detail = "ROTATE"
    node.fresnel = "SCHLICK"
    node.inputs["Color"].default_value = (*STEEL, 1.0)
    return node


def new_metal(name, ex, ey, image, strength=1.0):
    """A metal with a normal map, wired as artists do it."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (300, 0)
    metal = metal_node(tree, ex, ey)
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.location = (-700, 0)
    bump = tree.nodes.new("ShaderNodeNormalMap")
    bump.inputs["Strength"].default_value = strength
    bump.location = (-300, 0)
    tree.links.new(texture.outputs["Color"], bump.inputs["Color"])
    tree.links.new(bump.outputs["Normal"], metal.inputs["Normal"])
    tree.links.new(metal.outputs["BSDF"], output.inputs["Surface"])
    return material


def add_suzanne(material):
    """Blender's monkey with its own UV map, standing on its chin."""
    bpy.ops.mesh.primitive_monkey_add(location=(0.0, 0.0, 0.945), rotation=(-0.25, 0.0, 0.42))
    monkey = bpy.context.object
    bpy.ops.object.shade_smooth()
    subdivision = monkey.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = subdivision.render_levels = 3
    layer = monkey.data.uv_layers[0].data
    uv = np.empty(2 * len(layer), np.float32)
    layer.foreach_get("uv", uv)
    layer.foreach_set("uv", uv * 3.0)  # the map repeats three times over the head
    monkey.data.materials.append(material)
    return monkey


def add_turntable(material, radius=3.4, rings=48, spokes=192):
    """A disc turned on a lathe: u runs around, v outwards, so the grooves are circles."""
    ring, spoke = np.meshgrid(np.linspace(0.04, 1.0, rings + 1), np.arange(spokes), indexing="ij")
    angle = 2.0 * math.pi * spoke / spokes
    vertices = np.stack(
        [radius * ring * np.cos(angle), radius * ring * np.sin(angle), 0.0 * ring], axis=-1
    ).reshape(-1, 3)
    faces, uvs = [], []
    for r in range(rings):
        for s in range(spokes):
            corners = ((r, s), (r + 1, s), (r + 1, s + 1), (r, s + 1))
            faces.append([i * spokes + j % spokes for i, j in corners])
            uvs += [(8.0 * j / spokes, 2.0 * i / rings) for i, j in corners]
    mesh = bpy.data.meshes.new("Turntable")
    mesh.from_pydata(vertices.tolist(), [], faces)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", np.asarray(uvs, np.float32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), dtype=bool))
    mesh.materials.append(material)
    disc = bpy.data.objects.new("Turntable", mesh)
    bpy.context.scene.collection.objects.link(disc)
    return disc


def add_light(name, kind, energy, place, colour=(1.0, 1.0, 1.0)):
    """A light at `place`; a sun shines from there to the origin. Both are sharp."""
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = energy, colour
    if kind == "SUN":
        data.angle = 0.0
    else:
        data.shadow_soft_size = 0.0
    light = bpy.data.objects.new(name, data)
    light.location = place
    light.rotation_euler = Vector(place).to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(light)


def add_camera(place, target, lens):
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    camera = bpy.data.objects.new("Camera", data)
    camera.location = place
    camera.rotation_euler = (Vector(place) - Vector(target)).to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def build(folder):
    """Fill the empty file with the scene; textures go to folder/textures."""
    parts.begin()
    textures = os.path.join(folder, "textures")
    os.makedirs(textures, exist_ok=True)
    images = {}
    for name, normals in (("hammered", bumps.hammered(1024)), ("turned", bumps.grain(1024))):
        path = os.path.join(textures, name + ".png")
        save_normal_map(path, normals)
        images[name] = load_normal_map(path)

    add_suzanne(new_metal("Brushed steel", 100.0, 2.5, images["hammered"]))
    add_turntable(new_metal("Turned steel", 70.0, 4.0, images["turned"]))
    add_light("Sun", "SUN", 2.6, (2.4, -2.8, 3.2), (1.0, 0.95, 0.88))
    add_light("Lamp", "POINT", 420.0, (-3.6, -2.6, 2.6), (0.82, 0.91, 1.0))
    add_light("Rim lamp", "POINT", 420.0, (2.5, 4.0, 4.2))
    add_camera((0.9, -6.2, 2.6), (0.0, 0.0, 0.72), 55.0)

    scene = bpy.context.scene
    parts.room((0.012, 0.014, 0.018))
    scene.render.resolution_x, scene.render.resolution_y = 960, 720
    scene.view_settings.view_transform = "Standard"


def main(path):
    path = os.path.abspath(path)
    build(os.path.dirname(path))
    scene = bpy.context.scene
    scene.render.engine = "LIBSHADE"
    scene.libshade.samples = 64
    scene.libshade.max_bounces = 0  # lamps only, as in the same scene for POV-Ray
    scene.libshade.pixel_filter_type = "BOX"
    scene.libshade.light_sampling_threshold = 0
    scene.libshade.soft_terminator = False
    bpy.context.preferences.filepaths.save_version = 0  # no OUT.blend1 of an earlier run
    bpy.ops.wm.save_as_mainfile(filepath=path, relative_remap=True)


if __name__ == "__main__":
    if "--" not in sys.argv or len(sys.argv) != sys.argv.index("--") + 2:
        sys.exit("usage: blender -b … -P make_scene.py -- OUT.blend")
    main(sys.argv[-1])
