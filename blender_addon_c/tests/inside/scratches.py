# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Scratches: pictures of what it says, by Cycles and by our engine; asserts what its operators and properties
do to a file. argument: a folder, for ENGINE_NAME.exr of each picture"""

import importlib
import math
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

SIZE, WIDE = 128, 0.04  # pixels; metres of the plate
NUMBERS = {"Density per cm²": 4.0, "Length mm": 14.0, "Width mm": 1.5, "Depth": 0.3, "Direction": 0.4, "Spread": 0.7}
OUTPUTS = ("Normal", "Height", "Mask")


def module(name):
    return importlib.import_module(f"{common.MODULE}.{name}")


def new_scene(engine):
    scene = common.empty_scene(SIZE, SIZE, 1)
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    common.camera(scene, (0, 0, 1), type="ORTHO", ortho_scale=WIDE)
    common.light(scene)
    return scene


def scratched(tree, **numbers):
    node = tree.nodes.new("LibshadeScratchesNode")
    node.seed, node.size, node.tile = 3, WIDE, WIDE
    for name, value in (NUMBERS | numbers).items():
        node.inputs[name].default_value = value
    return node


def leaning(tree):
    """A normal map that is the same everywhere."""
    image = bpy.data.images.new("leaning", 4, 4, float_buffer=True, is_data=True)
    image.pixels.foreach_set(np.float32([0.6, 0.45, 0.95, 1] * 16))
    image.update()
    node = tree.nodes.new("ShaderNodeNormalMap")
    node.inputs["Strength"].default_value = 1.0
    tree.links.new(common.image_node(tree, image).outputs["Color"], node.inputs["Color"])
    return node.outputs[0]


def showing(engine):
    """A material whose colour says an output of a node: (material, tree, what makes it say one)."""
    material, tree, metal = common.metal("shown", fresnel="NONE")
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "MULTIPLY_ADD"

    def show(node, output):
        by, more = {"Normal": (0.5, 0.5), "Height": (-1000.0, 0.0), "Mask": (1.0, 0.0)}[output]
        scaled.inputs[1].default_value, scaled.inputs[2].default_value = (by,) * 3, (more,) * 3
        tree.links.new(node.outputs[output], scaled.inputs[0])

    if engine == "CYCLES":
        shader = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        tree.links.new(scaled.outputs[0], shader.inputs["Color"])
    else:
        tree.links.new(scaled.outputs[0], metal.inputs["Color"])
    return material, tree, show


def of_uv(tree, node):
    tree.links.new(leaning(tree), node.inputs["Normal"])


def of_map(tree, node):
    """Turned, and half as large."""
    where, turned = tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeMapping")
    turned.inputs["Rotation"].default_value[2] = 0.5
    tree.links.new(where.outputs[0], turned.inputs["Vector"])
    tree.links.new(turned.outputs[0], node.inputs["Vector"])


def of_object(_tree, node):
    node.unit = "METRES"


def of_amount(tree, node):
    where, ramp = tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeTexGradient")
    tree.links.new(where.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs["Fac"], node.inputs["Amount"])


def of_own_tile(_tree, node):
    node.tile = 0.0


def of_points_along(tree, node):
    """Strokes that all go along x, of what the map turns."""
    node.inputs["Direction"].default_value, node.inputs["Spread"].default_value = math.pi + 0.03, 0.05
    of_map(tree, node)


POINTS = {"points": of_uv, "points along": of_points_along}  # one image of 8 bits
CASES = {**POINTS, "own tile": of_own_tile, "uv": of_uv, "map": of_map, "object": of_object, "amount": of_amount}


def pictures(folder):
    """What it says, baked; of one as it is without images."""
    for engine in ("LIBSHADE", "CYCLES"):
        for name, links in (*CASES.items(), ("bare", of_uv), ("alone", None)):
            scene = new_scene(engine)
            material, tree, show = showing(engine)
            node = scratched(tree)
            if links:
                links(tree, node)
            if engine == "CYCLES" and name in CASES or name == "own tile":  # that of the images
                module("scratches").bake(node, "plate", scene, 1024, 2, points=name in POINTS)
            common.plane(material, WIDE)
            for output in OUTPUTS if name in ("uv", "bare", "amount", "points") else OUTPUTS[:1]:
                show(node, output)
                dump = os.path.join(folder, f"libshade_{name}_{output}.exr")
                os.environ["LIBSHADE_DUMP"] = dump if engine == "LIBSHADE" else ""
                common.render(os.path.join(folder, f"{engine.lower()}_{name}_{output}.exr" if engine == "CYCLES" else "picture.exr"))


def other_units(folder):
    """The same plate in half metres, by the object's lengths: dumps of Normal and Height."""
    for unit in (1.0, 0.5):
        scene = new_scene("LIBSHADE")
        scene.unit_settings.scale_length = unit
        scene.camera.data.ortho_scale = WIDE / unit
        material, tree, show = showing("LIBSHADE")
        node = scratched(tree)
        node.unit, node.tile = "METRES", WIDE / unit
        common.plane(material, WIDE / unit)
        for output in OUTPUTS[:2]:
            show(node, output)
            os.environ["LIBSHADE_DUMP"] = os.path.join(folder, f"unit_{unit}_{output}.exr")
            common.render(os.path.join(folder, "picture.exr"))
        scene = new_scene("CYCLES")  # and by images, in units of the map
        scene.unit_settings.scale_length = unit
        scene.camera.data.ortho_scale = WIDE / unit
        material, tree, show = showing("CYCLES")
        node = scratched(tree)
        node.size = node.tile = WIDE / unit
        module("scratches").bake(node, "plate", scene, 1024, 2)
        show(node, "Normal")
        common.plane(material, WIDE / unit)
        common.render(os.path.join(folder, f"baked_{unit}.exr"))


def plate_in_sun(folder):
    """Scratched metal in the sun: the dump, for the reference."""
    scene = common.empty_scene(48, 48, 1)
    material, tree, metal = common.metal("plate", distribution="BECKMANN", brdf="MICROFACET", ax=0.2, ay=0.1)
    tree.links.new(scratched(tree).outputs["Normal"], metal.inputs["Normal"])
    common.plane(material, WIDE)
    common.camera(scene, (0, -0.05, 0.06), (0.7, 0, 0), clip_start=0.01)
    common.light(scene, rotation=(-0.5, 0.2, 0))
    os.environ["LIBSHADE_DUMP"] = os.path.join(folder, "sun.exr")
    common.render(os.path.join(folder, "picture.exr"))


def test_file(folder):
    """Presets, images that are packed, stale and taken away, copies, a saved file."""
    common.empty_scene()
    scratches, tree_of = module("scratches"), module("scratches.tree")
    material, tree, metal = common.metal("plate")
    node = scratched(tree)
    tree.links.new(node.outputs["Normal"], metal.inputs["Normal"])
    other = tree.nodes.new("LibshadeScratchesNode")
    assert node.node_tree == other.node_tree and tree_of.is_plain(node.node_tree)
    with bpy.context.temp_override(node=node):
        for word, (_label, _about, values) in scratches.PRESETS.items():
            assert bpy.ops.libshade.scratches_preset(preset=word) == {"FINISHED"}
            assert all(abs(node.inputs[name].default_value - value) < 1e-6 * value + 1e-9 for name, value in values.items())
            other.preset = word.lower()  # as in a script
            assert all(other.inputs[name].default_value == node.inputs[name].default_value for name in values)
        assert bpy.ops.libshade.bake_scratches(size="512", samples=1) == {"FINISHED"}
        images = [n.image for n in node.node_tree.nodes if n.bl_idname == "ShaderNodeTexImage"]
        assert {image.name for image in images} == {f"plate {node.name} {what}" for what in OUTPUTS}
        assert all(image.packed_file and image.colorspace_settings.is_data for image in images)
        assert tree_of.is_plain(other.node_tree) and not scratches.is_stale(node, bpy.context.scene)
        assert len(tree.links) == 2 and node.outputs["Normal"].is_linked
        node.seed += 1
        assert scratches.is_stale(node, bpy.context.scene)
        assert bpy.ops.libshade.bake_scratches(size="512", samples=1, tile=0.05) == {"FINISHED"}
        assert len(bpy.data.images) == 3 and not scratches.is_stale(node, bpy.context.scene)
        assert abs(node.tile - 0.05) < 1e-6  # both engines'
    common.plane(material, WIDE)
    path = os.path.join(folder, "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    tree = bpy.data.materials["plate"].node_tree
    node = next(n for n in tree.nodes if n.bl_idname == scratches.SCRATCHES and n.baked)
    assert not scratches.is_stale(node, bpy.context.scene) and node.outputs["Normal"].is_linked
    image = next(n.image for n in node.node_tree.nodes if n.bl_idname == "ShaderNodeTexImage" and "Normal" in n.image.name)
    pixels = np.empty(512 * 512 * 4, np.float32)
    image.pixels.foreach_get(pixels)
    normals = 2 * pixels.reshape(-1, 4)[:, :3] - 1
    assert np.allclose((normals**2).sum(1), 1, atol=1e-5) and normals[:, 2].min() < 0.99
    with bpy.context.temp_override(node=node):
        assert bpy.ops.libshade.drop_scratch_images() == {"FINISHED"}
    assert tree_of.is_plain(node.node_tree) and not bpy.data.images and node.outputs["Normal"].is_linked


def hostile(folder):
    """Numbers that cannot be, and links where only one number is read: told or brought into range, and rendered."""
    for name, value in (("Density per cm²", 1e9), ("Width mm", 0.0), ("Depth", math.nan), ("Length mm", math.inf),
                        ("Spread", math.nan), ("Amount", math.nan)):
        scene = common.empty_scene(16, 16, 1)
        material, tree, metal = common.metal("plate")
        node = scratched(tree)
        number = tree.nodes.new("ShaderNodeValue")
        number.outputs[0].default_value = value
        tree.links.new(number.outputs[0], node.inputs[name])
        tree.links.new(node.outputs["Normal"], metal.inputs["Normal"])
        common.plane(material, WIDE)
        common.camera(scene, (0, 0, 1), type="ORTHO", ortho_scale=WIDE)
        common.light(scene)
        os.environ["LIBSHADE_DUMP"] = os.path.join(folder, "hostile.exr")
        common.render(os.path.join(folder, f"hostile {name.split()[0]}.exr"))
    scene = common.empty_scene(16, 16, 1)
    world = scene.world = bpy.data.worlds.new("scratched")
    around = common.tree_of(world)
    background = next(n for n in around.nodes if n.type == "BACKGROUND")
    around.links.new(scratched(around).outputs["Mask"], background.inputs["Color"])
    material, tree, metal = common.metal("plate")
    node = scratched(tree)
    of_amount(tree, node)
    tree.links.new(node.inputs["Amount"].links[0].from_socket, node.inputs["Width mm"])
    tree.links.new(node.outputs["Normal"], metal.inputs["Normal"])
    common.plane(material, WIDE)
    common.camera(scene, (0, 0, 1), type="ORTHO", ortho_scale=WIDE)
    common.light(scene)
    common.render(os.path.join(folder, "hostile link.exr"))


folder, = common.arguments()
common.empty_scene()
pictures(folder)
other_units(folder)
plate_in_sun(folder)
hostile(folder)
test_file(folder)
print("all asserted", flush=True)
common.finish()
