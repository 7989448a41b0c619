# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Fabric in Cycles and in our own engine's near model, for test_blender_cloth.py: cloth_cycles.py FOLDER; and what
becomes of its images."""

import math
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402

folder, = common.arguments()
VARIED = ("vary_brightness", "vary_tilt", "along_brightness", "along_tilt", "slub")
MARK = "libshade_cloth"


def new_cloth(preset, even=True, **settings):
    material = bpy.data.materials.new("cloth")
    tree = common.tree_of(material)
    tree.nodes.clear()
    node, output = tree.nodes.new("LibshadeFabricNode"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    node.preset, node.distance = preset, "NEAR"
    for word in VARIED if even else ():  # which differs by chance
        setattr(node, f"warp_{word}", 0.0)
        setattr(node, f"weft_{word}", 0.0)
    for name, value in settings.items():
        setattr(node, name, value)
    return material, tree, node


def plate(preset, sun=(0.6, 0.3, 0), sky=0.3, **settings):
    """A new scene of a plate that is seen aslant, of some twenty crossings; (its tree, its node, the plate)."""
    scene = common.next_scene(48, 48, samples=32)
    scene.cycles.samples, scene.cycles.max_bounces = 32, 1
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type, scene.libshade.max_bounces = "BOX", 1
    world = scene.world = bpy.data.worlds.new("sky")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (sky, sky, sky, 1)
    material, tree, node = new_cloth(preset, **settings)
    common.light(scene, rotation=sun, size=0.2)
    common.camera(scene, type="ORTHO", ortho_scale=1.1)
    ob = common.plane(material)
    ob.rotation_euler = (0.4, 0.2, 0.1)
    return tree, node, ob


def both(name):
    """By either engine."""
    for engine in ("LIBSHADE", "CYCLES"):
        bpy.context.scene.render.engine = engine
        common.render(os.path.join(folder, f"{name}_{engine.lower()}.exr"))


def mapped(tree, node):
    """Object coordinates, turned and larger, to Vector."""
    place, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value, mapping.inputs["Scale"].default_value = (0, 0, 0.5), (1.3, 1.3, 1.3)
    tree.links.new(place.outputs["Object"], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])


def test_pictures():
    """Two presets, and each socket."""
    plate("LINEN", size=0.013)
    both("linen")
    tree, node, _ob = plate("SILK_CHARMEUSE", size=0.003)
    both("charmeuse")
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(geometry.outputs["Normal"], node.inputs["Normal"])
    common.render(os.path.join(folder, "charmeuse_told_cycles.exr"))
    for link in list(node.inputs["Normal"].links):
        tree.links.remove(link)
    for name, value in (("Gloss", 0.2), ("Fuzz", 0.8), ("Scale", 0.7), ("Rotation", 0.17), ("Alpha", 0.6)):
        node.inputs[name].default_value = value
    both("sockets")
    tree, node, _ob = plate("POLYESTER_LINING", size=0.006)
    mapped(tree, node)
    both("vector")
    plate("SHOT_TAFFETA", sun=(0.9, 0.6, 0), sky=0.0, size=0.006, warp_twist=0.8, weft_twist=-0.5)  # fibres that turn round their yarns
    both("twisted")
    _tree, _node, ob = plate("GABARDINE", size=0.006)  # its diagonal still rises as it is woven
    for loop in ob.data.uv_layers[0].data:
        loop.uv.x *= -1
    both("mirrored")
    tree, node, _ob = plate("DENIM", sun=(math.pi - 0.6, 0.3, 0), sky=0.0, size=0.01)
    node.inputs["Translucency"].default_value = 0.5
    both("through")
    tree, node, _ob = plate("LINEN", size=0.013, open_gaps=True)
    both("open")
    tree, node, _ob = plate("LINEN", size=0.013)
    tilted = tree.nodes.new("ShaderNodeVectorMath")
    tilted.operation, tilted.inputs[1].default_value = "ADD", (0.35, 0.2, 0.0)
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(geometry.outputs["Normal"], tilted.inputs[0])
    unit = tree.nodes.new("ShaderNodeVectorMath")
    unit.operation = "NORMALIZE"
    tree.links.new(tilted.outputs[0], unit.inputs[0])
    tree.links.new(unit.outputs[0], node.inputs["Normal"])
    both("folded")


def test_real_size():
    """As large as our own engine has it, once it is measured; again where the scale changes."""
    _tree, node, ob = plate("DENIM")
    bpy.context.scene.unit_settings.scale_length = 0.5
    node.size_mode = "REAL"
    ob.scale = (0.01, 0.01, 0.01)
    camera = bpy.context.scene.camera
    camera.data.ortho_scale, camera.data.clip_start = 0.011, 0.001
    assert bpy.ops.libshade.measure_cloth() == {"FINISHED"}
    assert abs(ob["libshade_metres"] - 0.01) < 1e-6 and abs(ob["libshade_metres_of_unit"] - 0.005) < 1e-6
    both("real")
    node.size = 0.01  # of the scene's units
    place, unit = node.node_tree.nodes["Place"], bpy.context.scene.unit_settings
    before = place.inputs["Per Unit"].default_value[0]
    unit.scale_length = 0.25
    bpy.context.view_layer.update()
    assert abs(place.inputs["Per Unit"].default_value[0] / before - 0.5) < 1e-6
    unit.scale_length = 1.0  # and nothing that tells of it before the render does
    both("length")


def ours():
    return sorted(image.name for image in bpy.data.images if image.get(MARK))


def test_images():
    """One set for all that are woven alike; replaced where a number changes, gone with the last; saved with the file."""
    common.empty_scene()
    made = [new_cloth("DENIM", even=False) for _ in range(3)]
    assert len(ours()) == 2 and all(image.packed_file and image.size[0] == 128 for image in bpy.data.images), ours()
    held = [made[0][2].node_tree.nodes[word].image for word in ("tilt", "yarns")]
    for k in range(6):
        made[0][2].warp_curve = 0.2 + 0.01 * k
    assert len(ours()) == 3, ours()  # only the tilt differs
    assert made[1][2].node_tree.nodes["tilt"].image == held[0] != made[0][2].node_tree.nodes["tilt"].image
    made[0][2].inputs["Gloss"].default_value, made[0][2].size, made[0][2].ends_per_cm = 0.3, 0.7, 30.0
    assert len(ours()) == 3
    made[0][2].preset = "DENIM"
    assert len(ours()) == 2
    copy = made[0][0].copy()
    copy.node_tree.nodes[made[0][2].name].warp_ridge = 0.0
    assert made[0][2].node_tree.nodes["tilt"].image == held[0] and len(ours()) == 3
    maps = sys.modules[f"{common.MODULE}.fabric.maps"]
    lonely = bpy.data.images.new("lonely", 4, 4)  # as with a window: gone when nothing has used it for a while
    lonely[MARK] = "0"
    maps.sweep()
    assert "lonely" in bpy.data.images and len(ours()) == 4
    maps._since["lonely"] -= 60
    maps.sweep()
    assert "lonely" not in bpy.data.images and len(ours()) == 3
    shared = next(tree for tree in bpy.data.node_groups if tree.get(MARK))
    inside = len(shared.nodes)
    bpy.ops.libshade.follow_bumps()  # is not for what is inside
    assert len(shared.nodes) == inside and sum(bool(tree.get(MARK)) for tree in bpy.data.node_groups) == 1
    colors = {name: tuple(np.round(np.reshape(bpy.data.images[name].pixels[:], (-1, 4)).mean(0), 3)) for name in ours()}
    path = os.path.join(folder, "cloth.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert colors == {name: tuple(np.round(np.reshape(bpy.data.images[name].pixels[:], (-1, 4)).mean(0), 3)) for name in ours()}
    assert {image.colorspace_settings.name for image in bpy.data.images if image.get(MARK)} == {"Non-Color"}
    os.remove(path)


def cloth_of(material):
    return next(node for node in material.node_tree.nodes if node.bl_idname == "LibshadeFabricNode")


def assert_seen(node, library=None):
    """Its images are those of its settings, and of the file that it is of."""
    fabric, maps = (sys.modules[f"{common.MODULE}.{name}"] for name in ("fabric", "fabric.maps"))
    made = maps.of(fabric.settings(node, 1.0)[0])
    for word in maps.WORDS:
        image = node.node_tree.nodes[word].image
        assert (image is None) == (made[word] is None), word
        if image:
            key, data = made[word]
            wanted = np.frombuffer(data, np.float32).reshape(*made["size"][::-1], -1)
            seen = np.reshape(image.pixels[:], wanted.shape)
            assert image[MARK] == key and image.packed_file and image.library == library, word
            assert np.abs(seen - wanted)[..., :3].max() < 1 / 254, word


def push(name):
    bpy.ops.ed.undo_push(message=name)


def test_undone():
    """Images go back and forth with what they show, and none stays."""
    common.empty_scene()
    bpy.context.preferences.edit.use_global_undo = True
    material, _tree, node = new_cloth("DENIM", even=False)
    new_cloth("LINEN", even=False)
    name, before = material.name, len(ours())
    push("made")
    for curve in (0.2, 0.3, 0.4):  # made once for all of these tests
        node.warp_curve = curve
        assert_seen(node)
        push("curve")
    node.preset = "SHOT_TAFFETA"
    push("preset")
    for steps in (bpy.ops.ed.undo,) * 4, (bpy.ops.ed.redo,) * 4, (bpy.ops.ed.undo,) * 2, (bpy.ops.ed.redo,):
        for step in steps:
            step()
            assert_seen(cloth_of(bpy.data.materials[name]))
    cloth_of(bpy.data.materials[name]).preset = "DENIM"
    assert len(ours()) == before, ours()
    material = bpy.data.materials[name]
    push("again")
    bpy.data.materials.remove(material)
    sys.modules[f"{common.MODULE}.fabric.maps"].drop()
    push("removed")
    bpy.ops.ed.undo()
    assert_seen(cloth_of(bpy.data.materials[name]))


def saved():
    """The path of a file with one cloth, which varies."""
    common.empty_scene()
    material, _tree, node = new_cloth("DENIM", even=False)
    material.use_fake_user, node.warp_curve = True, 0.4
    path = os.path.join(folder, "cloth.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    return path


def taken(path, link):
    with bpy.data.libraries.load(path, link=link) as (there, here):
        here.materials = there.materials
    return here.materials[0]


def test_opened():
    """Twice, and edited: what is in the file shows its cloth."""
    path = saved()
    for curve in (0.4, 0.3):
        bpy.ops.wm.open_mainfile(filepath=path)
        node = cloth_of(bpy.data.materials["cloth"])
        assert abs(node.warp_curve - curve) < 1e-6 and len(ours()) == 2, ours()
        assert_seen(node)
        node.warp_curve = 0.3
        assert_seen(node)
        assert len(ours()) == 2, ours()
        bpy.ops.wm.save_mainfile()
    os.remove(path)


def test_appended():
    """Beside cloth that is here already, and edited: its images are of this file, and no more of them."""
    path = saved()
    common.empty_scene()
    own = new_cloth("DENIM", even=False)[2]
    nodes = [cloth_of(taken(path, link=False)) for _ in range(2)]
    for node in (own, *nodes):
        assert_seen(node)
    for node in nodes:
        for curve in (0.2, 0.4):
            node.warp_curve = curve
            assert_seen(node)
    assert len(ours()) == 3, ours()  # one tilt for both
    for node in (own, *nodes):
        node.preset, node.warp_ridge = "DENIM", 0.5
        assert_seen(node)
    assert len(ours()) == 2, ours()
    os.remove(path)


def test_linked():
    """It shows its cloth with the other file's images; a cloth of this file has its own; one that is made local changes alone,
    and is saved as it is then."""
    path, other = saved(), os.path.join(folder, "links.blend")
    common.empty_scene()
    material = taken(path, link=True)
    library = material.library
    assert_seen(cloth_of(material), library)
    own = new_cloth("DENIM", even=False)[2]
    own.warp_curve = 0.4
    assert_seen(own)
    sys.modules[f"{common.MODULE}.fabric.maps"].drop()
    bpy.ops.libshade.measure_cloth()  # and what else looks after all cloth
    assert_seen(cloth_of(material), library)
    copy = material.copy()
    copy.name, copy.use_fake_user = "mine", True
    node = cloth_of(copy)
    node.warp_curve = 0.3
    assert_seen(node)
    assert node.node_tree.library is None and len(ours()) == 5, ours()
    assert_seen(cloth_of(material), library)
    bpy.ops.wm.save_as_mainfile(filepath=other)
    bpy.ops.wm.open_mainfile(filepath=other)
    node = cloth_of(bpy.data.materials["mine"])
    assert abs(node.warp_curve - 0.3) < 1e-6
    assert_seen(node)
    common.empty_scene()
    material = taken(path, link=True)
    material.make_local()
    node = cloth_of(bpy.data.materials["cloth"])
    tree = node.node_tree
    node.warp_curve = 0.3
    assert_seen(node)
    assert tree.library and not node.node_tree.library
    os.remove(other)
    os.remove(path)


def test_copied():
    """A duplicate is edited, and its original not; both go, and so do their images."""
    common.empty_scene()
    material, tree, node = new_cloth("DENIM", even=False)
    copy = material.copy()
    push("copied")
    for curve in (0.2, 0.3):
        cloth_of(copy).warp_curve = curve
        node.warp_curve = curve + 0.1
        assert_seen(cloth_of(copy))
        assert_seen(node)
    assert len(ours()) == 3, ours()
    again, unlike = copy.copy(), material.copy()  # the first of these keeps what it has
    cloth_of(copy).preset, node.preset = "LINEN", "DENIM"
    for one in (copy, again, material, unlike):
        assert_seen(cloth_of(one))
    assert cloth_of(again).warp_curve != cloth_of(unlike).warp_curve and len(ours()) == 6, ours()
    for one in (copy, again, unlike):
        bpy.data.materials.remove(one)
    tree.nodes.remove(node)
    for group, users in bpy.data.user_map(subset=set(bpy.data.node_groups)).items():
        if not users:
            bpy.data.node_groups.remove(group)
    sys.modules[f"{common.MODULE}.fabric.maps"].drop()
    assert not ours(), ours()


for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__, "done", flush=True)
print("all asserted")
common.finish()
