# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: small scenes that export_povray.py can write out for POV-Ray whole.

    blender -b --factory-startup --addons libshade --python-exit-code 9 -P twin_scenes.py -- NAME FOLDER

NAME is one of SCENES; FOLDER gets scene.blend, and has the normal maps that it reads: bumps.exr of plate.py and
scratches.exr of sphere.py. Mesh, material, camera and lights are
said once, here: study_consistency.py renders the file by our engine, and by POV-Ray what is exported of it.
"""
import os
import sys

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import sphere  # noqa: E402

WIDTH, HEIGHT = 800, 600
STEEL, COPPER = (0.60, 0.585, 0.565), (0.93, 0.62, 0.52)


def map_file(folder, name):
    """A normal map of the folder, loaded."""
    image = bpy.data.images.load(os.path.join(folder, name))
    image.colorspace_settings.name = "Non-Color"
    return image


def shader(name, kind):
    """A material of one node of ours, and the node."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    output, node = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new(kind)
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    if kind == "LibshadeMetalNode":  # as a block of POV-Ray's, without the strokes of a new one
        node.strokes, node.grain, node.is_new, node.horizon = 0.0, "UV", False, "VALID_ESTEVEZ"
    return made, node


def material(name, kind, image=None, color=None, **values):
    """One node of ours, `values` its properties, over a normal map if there is one."""
    made, node = shader(name, kind)
    tree = made.node_tree
    for word, value in values.items():
        setattr(node, word, value)
    if color:
        node.inputs["Color"].default_value = (*color, 1.0)
    if image:
        texture, bump = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeNormalMap")
        texture.image = image
        tree.links.new(texture.outputs["Color"], bump.inputs["Color"])
        tree.links.new(bump.outputs["Normal"], node.inputs["Normal"])
    return made


def mesh(name, made, positions, faces, uv, **place):
    """Quads, smooth, with UVs of each vertex."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(positions.tolist(), [], faces.tolist())
    data.uv_layers.new(name="UVMap").data.foreach_set("uv", uv[faces.ravel()].astype(np.float32).ravel())
    data.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    data.materials.append(made)
    data.update()
    item = bpy.data.objects.new(name, data)
    for word, value in place.items():
        setattr(item, word, value)
    bpy.context.scene.collection.objects.link(item)


def grid(quads, height=lambda x, y: 0 * x):
    """The square from -1 to 1 as quads x quads quads."""
    side = np.linspace(0, 1, quads + 1)
    u, v = (a.ravel() for a in np.meshgrid(side, side))
    first = (np.arange(quads)[:, None] * (quads + 1) + np.arange(quads)).ravel()
    x, y = 2 * u - 1, 2 * v - 1
    return (np.stack([x, y, height(x, y)], -1), np.stack([first, first + 1, first + quads + 2, first + quads + 1], -1),
            np.stack([u, v], -1))


def brushed_plate(folder):
    """Bumps of slope 0.6 on a plate of brushed copper, seen from the side."""
    image = map_file(folder, "bumps.exr")
    copper = material("copper", "LibshadeMetalNode", image, COPPER, ex=200, ey=10, detail="ROTATE", fresnel="SCHLICK",
                      diffuse="LAMBERT", kd=(0.03, 0.02, 0.015))
    mesh("plate", copper, *grid(8), rotation_euler=(0.1, -0.05, 0.3))


def scratched_sphere(folder):
    """The sphere of sphere.py in steel of GGX, over a brushed floor."""
    image = map_file(folder, "scratches.exr")
    steel = material("steel", "LibshadeMetalNode", image, STEEL, distribution="GGX", brdf="MICROFACET", ax=0.1, ay=0.4,
                     detail="ROTATE", fresnel="SCHLICK")
    positions, _normals, faces, uv = sphere.mesh(96, False)
    mesh("ball", steel, positions * 1.6, faces, uv, location=(0, 0, 0.72), rotation_euler=(0.83, 0, 0))
    floor = material("floor", "LibshadeMetalNode", None, STEEL, ex=20, ey=400, detail="ROTATE", fresnel="SCHLICK")
    mesh("floor", floor, *grid(4))


def swatches(_folder):
    """Denim and a shot taffeta as sheets that hang in folds, near enough that yarns are seen."""
    for k, (preset, size) in enumerate((("DENIM", 0.002), ("SHOT_TAFFETA", 0.001))):
        cloth = material(preset.lower(), "LibshadeFabricNode", preset=preset, size_mode="LENGTH", size=size)
        mesh(preset.lower(), cloth, *grid(48, lambda x, y: 0.08 * np.sin(4 * x + y)), scale=(0.55, 0.8, 1.0),
             location=(1.2 * k - 0.6, 0, 0.1), rotation_euler=(0.25, 0.0, 0.15 - 0.3 * k))


SCENES = {"brushed_plate": brushed_plate, "scratched_sphere": scratched_sphere, "swatches": swatches}


def light(kind, energy, at, color=(1, 1, 1)):
    """A sharp lamp: a sun from there to the origin, or a point. energy: irradiance of a sun, watts of a point."""
    data = bpy.data.lights.new(kind, kind)
    data.energy, data.color = energy, color
    if kind == "SUN":
        data.angle = 0
    else:
        data.shadow_soft_size = 0
    item = bpy.data.objects.new(kind, data)
    item.location = at
    item.rotation_euler = Vector(at).to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)


def begin():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="libshade")


def save(folder, background):
    """FOLDER/scene.blend before an even, grey world, without light that is reflected."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.world.color = (background,) * 3
    scene.render.engine = "LIBSHADE"
    scene.libshade.max_bounces = 0
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "scene.blend"))


def main(name, folder):
    begin()
    scene = bpy.context.scene
    SCENES[name](folder)
    light("SUN", 2.0, (1.5, -1.0, 2.5), (1.0, 0.95, 0.88))
    light("POINT", 60.0, (-2.0, 0.5, 1.8), (0.8, 0.88, 1.0))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (0.0, -2.6, 2.6)
    camera.rotation_euler = (camera.location - Vector((0, 0, 0.25))).to_track_quat("Z", "Y").to_euler()
    camera.data.lens = 45
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    save(folder, 0.0)


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1:])
