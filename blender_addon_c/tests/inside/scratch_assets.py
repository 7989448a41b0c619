# SPDX-License-Identifier: GPL-3.0-or-later
"""Scratched assets as an artist gets them: pictures of them by our engine and, as they are, by Cycles; asserts what becomes of their
images when they are appended, saved, linked, edited and baked again. argument: a folder, for NAME_ENGINE.exr"""

import importlib
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

SIZE, SAMPLES, WIDE = 128, 32, 1 / 6  # pixels; units of the UV map across the picture
SHOWN = {"Fine-polished steel": "scratches", "Steel with brush strokes": "scratches", "Used steel": "scratches",
         "Deeply scratched steel": "scratches", "Scratched copper": "metals"}


def module(name):
    return importlib.import_module(f"{common.MODULE}.{name}")


def library(name):
    return os.path.join(os.path.dirname(module("assets").__file__), "assets", name + ".blend")


def appended(name, item, kind="materials", link=False):
    with bpy.data.libraries.load(library(name), link=link) as (_there, here):
        setattr(here, kind, [item])
    return getattr(here, kind)[0]


def of_library(name, item):
    """As the Asset Browser appends it."""
    path = library(name)
    bpy.ops.wm.append(filepath=os.path.join(path, "Material", item), directory=os.path.join(path, "Material"), filename=item,
                      do_reuse_local_id=True)
    return bpy.data.materials[item]


def scratches_in(material):
    return next(n for n in material.node_tree.nodes if n.bl_idname == "LibshadeScratchesNode")


def metal_in(material):
    return next(n for n in material.node_tree.nodes if n.bl_idname == "LibshadeMetalNode")


def images_in(tree):
    return [n.image for n in tree.nodes if n.bl_idname == "ShaderNodeTexImage"]


def own_images():
    """But for what Blender leaves behind when it appends: linked ones without users, which no file gets."""
    return [image for image in bpy.data.images if not image.library]


def scene_of(engine):
    scene = common.empty_scene(SIZE, SIZE, SAMPLES)
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising, cycles.max_bounces = SAMPLES, False, False, 0
    cycles.pixel_filter_type, cycles.filter_width, scene.libshade.pixel_filter_type = "BLACKMAN_HARRIS", 1.5, "BLACKMAN_HARRIS"
    lean = math.radians(30)
    common.camera(scene, (0, -4 * math.sin(lean), 4 * math.cos(lean)), (lean, 0, 0), type="ORTHO", ortho_scale=WIDE)
    common.light(scene, rotation=(math.radians(-35), 0.1, 0), size=0.2)
    common.light(scene, energy=1.0, rotation=(0.2, 0.9, 0), size=0.1)
    world = scene.world = bpy.data.worlds.new("even")
    background = next(n for n in common.tree_of(world).nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.2, 0.2, 0.2, 1)
    return scene


def glossy_of(group):
    material = bpy.data.materials.new("plain")
    tree = common.tree_of(material)
    tree.nodes.clear()
    scratched, shader, output = (tree.nodes.new(kind) for kind in (
        "ShaderNodeGroup", "ShaderNodeBsdfAnisotropic",
        "ShaderNodeOutputMaterial"))
    scratched.node_tree = group
    shader.inputs["Roughness"].default_value, shader.distribution = 0.3, "GGX"
    tree.links.new(scratched.outputs["Normal"], shader.inputs["Normal"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def pictures(folder):
    for engine in ("LIBSHADE", "CYCLES"):
        for name, file in SHOWN.items():
            scene_of(engine)
            material = appended(file, name)
            metal_in(material).horizon = "VALID_ESTEVEZ"  # Cycles' bumps do not shade each other
            common.plane(material, 1.0)
            common.render(os.path.join(folder, f"{name}_{engine.lower()}.exr"))
        scene_of(engine)
        common.plane(glossy_of(appended("scratches", "Deep Scratches", "node_groups")), 1.0)
        common.render(os.path.join(folder, f"Deep_group_{engine.lower()}.exr"))
    scene_of("CYCLES")
    material = appended("scratches", "Used steel", link=True)
    assert material.library and scratches_in(material).node_tree.library
    common.plane(material, 1.0)
    common.render(os.path.join(folder, "linked.exr"))


def test_images():
    """Metals have one image between them, however they come; new nodes none."""
    common.empty_scene()
    scratches, tree_of = module("scratches"), module("scratches.tree")
    scene = bpy.context.scene
    names = [f"Scratched {metal}" for metal in ("copper", "brass", "gold", "titanium")]
    materials = [of_library("metals", name) for name in names]
    nodes = [scratches_in(material) for material in materials]
    assert len({node.node_tree for node in nodes}) == len(own_images()) == 1, own_images()
    for node in nodes:
        assert not scratches.is_stale(node, scene) and not tree_of.is_plain(node.node_tree)
        image, = images_in(node.node_tree)
        assert image.packed_file and image.packed_file.size < 2e6 and not image.is_float and image.colorspace_settings.is_data
    for name in SHOWN:
        of_library(SHOWN[name], name)
    assert len(own_images()) == len({image for m in bpy.data.materials for image in images_in(scratches_in(m).node_tree)}) == 5
    fresh = materials[0].node_tree.nodes.new(scratches.SCRATCHES)
    assert tree_of.is_plain(fresh.node_tree) and scratches.is_stale(fresh, scene) and not fresh.baked
    materials[0].node_tree.nodes.remove(fresh)
    # what is edited is said, and what is baked again is the node's alone
    node, other = nodes[:2]
    node.inputs["Density per cm²"].default_value = 5.0
    assert scratches.is_stale(node, scene) and not scratches.is_stale(other, scene)
    with bpy.context.temp_override(node=node):
        assert bpy.ops.libshade.bake_scratches(size="512", points=True) == {"FINISHED"}
        assert not scratches.is_stale(node, scene) and node.node_tree != other.node_tree and len(own_images()) == 6
        assert tuple(images_in(node.node_tree)[0].size) == (512, 512)
        assert bpy.ops.libshade.bake_scratches(size="512", samples=1) == {"FINISHED"}
        assert len(images_in(node.node_tree)) == 3 and len(own_images()) == 8
        assert bpy.ops.libshade.drop_scratch_images() == {"FINISHED"}
    assert len(own_images()) == 5 and tree_of.is_plain(node.node_tree) and not scratches.is_stale(other, scene)


def test_file(folder):
    """Saved and opened again; undone."""
    common.empty_scene()
    scratches = module("scratches")
    material = of_library("scratches", "Used steel")
    common.plane(material)
    path = os.path.join(folder, "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    node = scratches_in(bpy.data.materials["Used steel"])
    image, = images_in(node.node_tree)
    assert not scratches.is_stale(node, bpy.context.scene) and image.packed_file and image.pixels[0] > 0
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(node=node):
        assert bpy.ops.libshade.drop_scratch_images() == {"FINISHED"}
    assert not images_in(node.node_tree)
    bpy.ops.ed.undo_push(message="dropped")
    bpy.ops.ed.undo()
    node = scratches_in(bpy.data.materials["Used steel"])
    assert images_in(node.node_tree) and not scratches.is_stale(node, bpy.context.scene)


def without_the_addon(folder):
    """The group alone."""
    scene_of("CYCLES")
    material = glossy_of(appended("scratches", "Deep Scratches", "node_groups"))
    bpy.ops.preferences.addon_disable(module=common.MODULE)
    common.plane(material, 1.0)
    common.render(os.path.join(folder, "alone.exr"))


folder, = common.arguments()
common.empty_scene()
pictures(folder)
test_images()
test_file(folder)
without_the_addon(folder)
print("all asserted", flush=True)
common.finish()
