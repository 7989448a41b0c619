# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: a scene full of what converters get wrong. Argument: OUT.blend [PERSP|ORTHO]

Two materials on one mesh, a mirrored and an unevenly scaled object, two objects
that share a mesh, flat shading, a normal map of half its strength, models that need other
numbers (alphas, indices of refraction), coloured lights under a turned parent, a camera with
shift, a tall picture, transparent film.
"""
import os
import sys

import bpy
from mathutils import Euler, Matrix

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "examples", "blender", "suzanne"))
import bumps  # noqa: E402
import make_scene  # noqa: E402


def place(ob, location, turn, scale):
    ob.matrix_world = Matrix.LocRotScale(location, Euler(turn), scale)


def set_metal(material, **settings):
    node = next(n for n in material.node_tree.nodes if n.bl_idname == "LibshadeMetalNode")
    for name, value in settings.items():
        setattr(node, name, value)


def build(folder, camera_type):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    path = os.path.join(folder, "hammered.png")
    make_scene.save_normal_map(path, bumps.hammered(256))
    image = make_scene.load_normal_map(path)
    fine = make_scene.new_metal("Fine, bumped", 120.0, 4.0, image)
    across = make_scene.new_metal("Across", 3.0, 80.0, image)
    strong = make_scene.new_metal("Strong", 40.0, 10.0, image, 0.5)
    set_metal(strong, distribution="GGX", brdf="MICROFACET", fresnel="CONDUCTOR", ax=0.1, ay=0.4,
              eta=(0.2, 0.9, 1.1), k=(3.9, 2.4, 2.3))
    set_metal(across, fresnel="F82", f82=(0.9, 0.8, 0.7), diffuse="FIBRE", kd=(0.1, 0.2, 0.3))

    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    ball.data.materials.append(fine)
    ball.data.materials.append(across)
    for polygon in ball.data.polygons:
        polygon.material_index = polygon.center.z > 0.3
    place(ball, (-0.9, 0.0, 1.3), (0.3, 0.5, 0.2), (1.0, 0.6, 0.8))

    twin = bpy.data.objects.new("Mirrored twin", ball.data)
    bpy.context.scene.collection.objects.link(twin)
    place(twin, (0.9, 0.2, 1.4), (0.1, -0.4, 0.9), (-0.8, 0.8, 0.8))

    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.data.materials.append(strong)
    place(cube, (0.1, 0.0, -0.9), (0.2, 0.1, 0.6), (0.7, 0.7, 0.7))

    make_scene.add_light("Sun", "SUN", 2.0, (1.0, -2.0, 2.5))
    make_scene.add_light("Lamp", "POINT", 200.0, (-2.0, -3.0, 1.0))
    bpy.data.lights["Sun"].color = (0.7, 1.0, 0.4)
    bpy.data.lights["Lamp"].color = (1.0, 0.5, 0.8)
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.rotation_euler = (0.0, 0.3, 0.2)
    bpy.data.objects["Lamp"].parent = bpy.data.objects["Sun"].parent = parent

    make_scene.add_camera((0.4, -7.0, 1.2), (0.0, 0.0, 0.2), 50.0)
    scene = bpy.context.scene
    camera = scene.camera.data
    camera.type = camera_type
    camera.ortho_scale = 5.0
    camera.shift_x, camera.shift_y = 0.06, -0.04
    scene.render.resolution_x, scene.render.resolution_y = 240, 320
    scene.render.film_transparent = True


path = os.path.abspath(sys.argv[sys.argv.index("--") + 1])
build(os.path.dirname(path), sys.argv[sys.argv.index("--") + 2])
bpy.ops.wm.save_as_mainfile(filepath=path)
