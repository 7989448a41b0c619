# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes and helpers for scripts that run inside Blender.

A script's arguments follow `--`; LIBSHADE_MODULE names the add-on's module.
"""

import os
import sys

import bpy

MODULE = os.environ.get("LIBSHADE_MODULE", "libshade")


def arguments():
    return sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []


def enable():
    if MODULE not in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_enable(module=MODULE)


def resident():
    """MiB of memory that this process holds."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / 2**20


class Finished(BaseException):
    """A script is done, in a process that goes on."""


def finish():
    """Leave without Blender's own exit, which hangs in some versions of bpy."""
    sys.stdout.flush()
    sys.stderr.flush()
    if goes_on:
        raise Finished
    os._exit(0)


goes_on = False  # does this process run several scripts?


def empty_scene(width=64, height=48, samples=4):
    """A scene without objects that renders with libshade to OpenEXR."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    enable()
    return _plain(bpy.context.scene, width, height, samples)


def next_scene(width=64, height=48, samples=4):
    """The same in the file as it is, after the first: groups inside our nodes stay, which take longer to make than a picture."""
    if not bpy.context.preferences.addons.get(MODULE) or not bpy.data.node_groups:
        return empty_scene(width, height, samples)
    before = list(bpy.data.scenes)
    scene = bpy.context.window.scene = bpy.data.scenes.new("Scene")
    bpy.data.batch_remove([*before, *bpy.data.objects, *bpy.data.meshes, *bpy.data.materials, *bpy.data.lights, *bpy.data.cameras,
                           *bpy.data.worlds, *bpy.data.texts])
    return _plain(scene, width, height, samples)


def _plain(scene, width, height, samples):
    render = scene.render
    render.engine = "LIBSHADE"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.film_transparent = True
    scene.libshade.samples = samples
    scene.libshade.max_bounces = 0  # lamps only, for what is compared with a formula
    scene.libshade.pixel_filter_type = "BOX"
    scene.libshade.light_sampling_threshold = scene.libshade.blur_glossy = 0
    scene.libshade.soft_terminator = False
    return scene


def write_multilayer(scene):
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # from 5.0 on
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"


def ask_for(layer, passes, denoising=False):
    """Passes of a view layer, by their properties."""
    for name in passes:
        setattr(layer, "use_pass_" + name, True)
    layer.cycles.denoising_store_passes = layer.libshade.denoising_store_passes = denoising


def link(scene, name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    ob = bpy.data.objects.new(name, data)
    ob.location, ob.rotation_euler = location, rotation
    scene.collection.objects.link(ob)
    return ob


def camera(scene, location=(0, 0, 4), rotation=(0, 0, 0), **settings):
    data = bpy.data.cameras.new("camera")
    for name, value in settings.items():
        setattr(data, name, value)
    scene.camera = link(scene, "camera", data, location, rotation)
    return scene.camera


def cast_shadow(light, casts):
    """A lamp's shadow: until 4.1 Cycles has a setting of its own."""
    owner = light.cycles if hasattr(getattr(light, "cycles", None), "cast_shadow") else light
    setattr(owner, "cast_shadow" if owner != light else "use_shadow", casts)


def light(scene, kind="SUN", energy=3.0, size=0.0, **place):
    data = bpy.data.lights.new(kind.lower(), kind)
    data.energy = energy
    if kind == "SUN":
        data.angle = size
    elif kind == "POINT":
        data.shadow_soft_size = size
    return link(scene, kind.lower(), data, **place)


def tree_of(material):
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    return material.node_tree


def plain(node):
    """A metal node without strokes, whose tangent is that of the UV map."""
    node.strokes, node.grain, node.is_new = 0.0, "UV", False


def metal(name="metal", **settings):
    """A material of one Libshade Metal node; returns (material, tree, node)."""
    material = bpy.data.materials.new(name)
    tree = tree_of(material)
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    node = tree.nodes.new("LibshadeMetalNode")
    plain(node)
    for key, value in settings.items():
        setattr(node, key, value)
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    return material, tree, node


def shown(by_metal, name="shown"):
    """(material, tree, socket) of a material that shows a colour: as what our metal reflects, which a dump has, or as emission.
    Where there are hundreds, to make our nodes takes most of the time."""
    if by_metal:
        material, tree, node = metal(name, fresnel="NONE", detail="NONE")
        return material, tree, node.inputs["Color"]
    material = bpy.data.materials.new(name)
    tree = tree_of(material)
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material, tree, shader.inputs["Color"]


def image_node(tree, image):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    return node


def normal_map(tree, node, image, strength=1.0):
    """Image → Normal Map → the node's Normal; returns (image node, normal map node)."""
    texture, bump = image_node(tree, image), tree.nodes.new("ShaderNodeNormalMap")
    bump.inputs["Strength"].default_value = strength
    tree.links.new(texture.outputs["Color"], bump.inputs["Color"])
    tree.links.new(bump.outputs["Normal"], node.inputs["Normal"])
    return texture, bump


def plane(material=None, size=2.0):
    bpy.ops.mesh.primitive_plane_add(size=size)
    return added(material)


def monkey(material=None, **place):
    bpy.ops.mesh.primitive_monkey_add(**place)
    ob = added(material)
    smooth(ob.data)
    return ob


def smooth(mesh, on=True):
    mesh.polygons.foreach_set("use_smooth", [on] * len(mesh.polygons))
    mesh.update()


def added(material):
    ob = bpy.context.view_layer.objects.active
    if material:
        ob.data.materials.append(material)
    return ob


def render(path):
    """Render to `path` (.exr); raises RuntimeError where the engine reports an error."""
    bpy.context.scene.render.filepath = path[:-4] if path.endswith(".exr") else path
    bpy.ops.render.render(write_still=True)


def render_each(scene, options):
    """By each of options["engines"], to ENGINE.exr beside the picture that one alone would be."""
    for engine in options["engines"]:
        scene.render.engine = engine
        render(os.path.join(os.path.dirname(options["picture"]), f"{engine}.exr"))
