# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file's working space makes of colours that are not its own: working_space.py SPACE FOLDER. Writes
shown_ENGINE.exr, strips side by side that shine as nodes say; lit_ENGINE.exr, two films in front of a sky and beside a lamp;
preset_SPACE.exr, presets in white light by our engine, in Rec. 709 and in SPACE, and appended.exr, those of the former file
in the latter space. FOLDER/draft.wif: a draft of colours."""

import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402

space, folder = common.arguments()


def begin(width, height, samples, working_space):
    """An empty file."""
    scene = common.empty_scene(width, height, samples)
    bpy.ops.wm.set_working_color_space(working_space=working_space, convert_colors=False)
    assert bpy.data.colorspace.working_space == working_space
    common.write_multilayer(scene)  # as rendered, in the working space
    scene.cycles.samples, scene.cycles.pixel_filter_type = samples, "BOX"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.film_transparent, scene.libshade.texture_blur = False, 0
    scene.world = bpy.data.worlds.new("world")
    return scene


def both(scene, name):
    for engine in ("LIBSHADE", "CYCLES"):
        scene.render.engine = engine
        common.render(os.path.join(folder, f"{name}_{engine.lower()}.exr"))


def colors(color_space, float_buffer=False, alpha=False):
    """A packed image of random colours."""
    image = bpy.data.images.new(color_space, 16, 4, float_buffer=float_buffer, alpha=True)
    image.colorspace_settings.name = color_space
    pixels = np.random.default_rng(3).uniform(0, 1, (64, 4)).astype(np.float32)
    pixels[:, 3] = np.linspace(0.2, 1, 64) if alpha else 1
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def image_in(color_space, **about):
    return lambda tree: common.image_node(tree, colors(color_space, **about)).outputs["Color"]


def along(tree, low, high):
    """A number from one end of the strip to the other."""
    place, ramp = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapRange")
    parts = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(place.outputs["UV"], parts.inputs[0])
    tree.links.new(parts.outputs["X"], ramp.inputs["Value"])
    ramp.inputs["To Min"].default_value, ramp.inputs["To Max"].default_value = low, high
    return ramp.outputs["Result"]


def through(kind, source, *into):
    def strip(tree):
        node = tree.nodes.new(kind)
        given = source(tree)
        if isinstance(given, float):
            node.inputs[0].default_value = given
        else:
            tree.links.new(given, node.inputs[into[0] if into else 0])
        return node.outputs[0]
    return strip


def vertex_colors(tree):
    node = tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name = "dyed"
    return node.outputs["Color"]


STRIPS = {
    "bytes": image_in("sRGB"), "bytes of light": image_in("Linear Rec.709"), "wide bytes": image_in("Rec.2020"),
    "floats": image_in("Linear Rec.709", float_buffer=True), "data": image_in("Non-Color"),
    "translucent": image_in("sRGB", alpha=True),
    "black body": through("ShaderNodeBlackbody", lambda _tree: 1500.0),
    "black bodies": through("ShaderNodeBlackbody", lambda tree: along(tree, 700.0, 13000.0)),
    "spectrum": through("ShaderNodeWavelength", lambda tree: along(tree, 380.0, 780.0)),
    "grey": through("ShaderNodeRGBToBW", image_in("sRGB")), "number": through("ShaderNodeMath", image_in("sRGB")),
    "hue": through("ShaderNodeHueSaturation", image_in("sRGB"), "Color"), "attribute": vertex_colors,
}


def shown():
    scene = begin(64, 4 * len(STRIPS), 64, space)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=16)
    for row, (name, strip) in enumerate(STRIPS.items()):
        material, tree, color = common.shown(False, name)
        tree.links.new(strip(tree), color)
        ob = common.plane(material, 1)
        ob.scale, ob.location = (16, 1, 1), (0, row + 0.5 - len(STRIPS) / 2, 0)
        dyed = ob.data.color_attributes.new("dyed", "BYTE_COLOR", "CORNER")
        dyed.data.foreach_set("color", [0.9, 0.1, 0.2, 1, 0.1, 0.7, 0.1, 1, 0.1, 0.2, 0.8, 1, 0.9, 0.8, 0.7, 1])
    both(scene, "shown")
    print("ROWS", *(name.replace(" ", "_") for name in STRIPS))


def lit():
    scene = begin(48, 32, 512, space)
    scene.libshade.max_bounces = scene.cycles.max_bounces = 2
    common.camera(scene, (0, -8, 0), (1.6, 0, 0))
    tree = scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sun_elevation, sky.sun_rotation, sky.sun_disc = 0.2, 2.0, False
    tree.links.new(sky.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    tree.nodes["Background"].inputs["Strength"].default_value = 0.05
    lamp = common.light(scene, "POINT", 300, 0.5, location=(2, -2, 2)).data
    lamp.use_temperature, lamp.temperature = True, 2500
    lamp.color = (0.8, 1, 0.9)
    for x, metallic, thickness in ((-1, 1.0, 350.0), (1, 0.0, 500.0)):
        material = bpy.data.materials.new("film")
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (0.8, 0.7, 0.6, 1)
        for key, value in {"Roughness": 0.3, "Metallic": metallic, "Thin Film Thickness": thickness}.items():
            shader.inputs[key].default_value = value
        bpy.ops.mesh.primitive_uv_sphere_add(location=(1.2 * x, 0, 0))
        common.smooth(common.added(material).data)
    both(scene, "lit")


def row_of_five(working_space):
    scene = begin(80, 16, 16, working_space)
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=5)
    return scene


def presets(working_space):
    row_of_five(working_space)
    for x, word in enumerate(("BRUSHED_GOLD", "BRUSHED_COPPER", "DENIM", "WOOL_FLANNEL", "LINEN")):
        if word.startswith("BRUSHED"):
            material, _tree, node = common.metal(word)
        else:
            material = bpy.data.materials.new(word)
            tree = material.node_tree
            tree.nodes.clear()
            node, output = tree.nodes.new("LibshadeFabricNode"), tree.nodes.new("ShaderNodeOutputMaterial")
            tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
        node.preset = word
        if word == "LINEN":
            module = sys.modules[f"{common.MODULE}.fabric.draft"]
            module.import_wif(node, os.path.join(folder, "draft.wif"))
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(x - 2, 0, 0))
        common.smooth(common.added(material).data)
    common.render(os.path.join(folder, f"preset_{working_space.split()[-1]}.exr"))


def appended():
    path = os.path.join(folder, "presets.blend")
    presets("Linear Rec.709")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    scene = row_of_five(space)
    with bpy.data.libraries.load(path) as (there, wanted):
        wanted.objects = [name for name in there.objects if name.startswith("Sphere")]
    for ob in wanted.objects:
        scene.collection.objects.link(ob)
    common.render(os.path.join(folder, "appended.exr"))


shown()
lit()
appended()
presets(space)
print("done")
common.finish()
