# SPDX-License-Identifier: GPL-3.0-or-later
"""Small parts of the add-on against what is known of them: parts.py FOLDER."""

import importlib
import os
import sys
from types import SimpleNamespace

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402

folder, = common.arguments()


def module(name):
    return importlib.import_module(f"{common.MODULE}.{name}")


def test_strands_between_points():
    """Catmull and Rom's curve through points of a parabola is that parabola, but at the ends, which count twice."""
    t = np.arange(6.0)
    points, radii, counts = module("export.strands")._finer(
        np.stack([t, t * t, 0 * t], 1), 1 + t, np.array([6]))
    assert counts.tolist() == [11] and np.allclose(radii, 1 + np.arange(11) / 2)
    assert np.allclose(points[2:-2, 1], points[2:-2, 0] ** 2) and np.allclose(points[::2], np.stack([t, t * t, 0 * t], 1))


def test_layers_of_cryptomatte():
    """Two names a layer: of five, three."""
    for depth, layers in ((1, 1), (4, 2), (5, 3), (6, 3), (16, 8), (99, 8)):
        kinds = {f"use_pass_cryptomatte_{kind}": True for kind in ("object", "material", "asset")}
        found = module("export.passes")._mattes(SimpleNamespace(pass_cryptomatte_depth=depth, **kinds))
        assert len(found) == 3 * layers and found[layers - 1].name == f"CryptoObject{layers - 1:02}", depth


def test_tile_of_images():
    """Three texels across a scratch, but two lengths; the node's own before both."""
    scratches = module("scratches")
    said = {"density": 4.0, "length": 14.0, "width": 1.5, "depth": 0.3, "direction": 0.4, "spread": 0.7, "seed": 3.0, "tile": 0.0}
    assert abs(scratches.tile_of_images(said, 256) - 0.128) < 1e-9
    assert abs(scratches.tile_of_images(said, 16) - 0.028) < 1e-9
    assert scratches.tile_of_images({**said, "tile": 0.07}, 256) == 0.07


def test_settings_of_cycles():
    """All of ours but four are Cycles'; a file's are taken over, and given back by undo."""
    scene = common.empty_scene(8, 8)
    ours, module_ = scene.libshade, module("cycles_settings")
    own = {"texture_blur", "filter_normals", "groove_transport", "soft_terminator"}
    assert set(ours.__annotations__) - set(module_.shared(ours, scene.cycles)) == own
    layer = scene.view_layers[0]
    assert set(module_.shared(layer.libshade, layer.cycles)) == set(layer.libshade.__annotations__)
    given = {"samples": 77, "max_bounces": 3, "sample_clamp_indirect": 4.5, "light_sampling_threshold": 0.25, "seed": 9,
             "use_adaptive_sampling": True, "pixel_filter_type": "GAUSSIAN", "filter_width": 2.5, "caustics_refractive": False}
    for name, value in given.items():
        setattr(scene.cycles, name, value)
    layer.cycles.use_pass_shadow_catcher = True
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.libshade.copy_cycles_settings() == {"FINISHED"}
    for name, value in given.items():
        assert getattr(ours, name) == value, name
    assert layer.libshade.use_pass_shadow_catcher and not module_.copy(ours, scene.cycles)
    bpy.ops.ed.undo_push(message="copied")
    bpy.ops.ed.undo()
    ours = bpy.context.scene.libshade
    assert ours.samples == 4 and ours.max_bounces == 0 and ours.pixel_filter_type == "BOX"
    assert not bpy.context.view_layer.libshade.use_pass_shadow_catcher and bpy.context.scene.cycles.samples == 77


def cloth(preset, **settings):
    common.empty_scene(8, 8)
    tree = common.tree_of(bpy.data.materials.new("cloth"))
    node = tree.nodes.new("LibshadeFabricNode")
    node.preset = preset
    for name, value in settings.items():
        setattr(node, name, value)
    return node


def test_twist_of_strands_and_of_fibres():
    """A yarn of strands is plied, and its fibres run along it; of a single one they turn."""
    settings = module("fabric.yarns").settings
    for preset, plied in (("GABARDINE", True), ("SHOT_TAFFETA", False)):
        made, _trouble = settings(cloth(preset, warp_twist=0.6), 1.0)
        assert made["warp_yarn"]["plied"] is plied and not made["weft_yarn"], preset


def test_images_are_read_as_they_are_written():
    """Tilts and shares are numbers; the tint is a colour, of a draft."""
    node = cloth("LINEN")
    native, maps = module("_native"), module("fabric.maps")
    made = native.cloth_images({"preset": "linen", "size": 0.1, "transmit": 0.0, "open": False})
    made = {**made, "tint": made["tilt"]}
    made = {**made, **{word: (word, bytes(made[word])) for word in maps.WORDS}}
    spaces = {word: maps.image(made, word, "cloth").colorspace_settings for word in maps.WORDS}
    assert spaces["tilt"].is_data and spaces["yarns"].is_data and spaces["tint"].name == "sRGB"
    assert node.node_tree.nodes["tilt"].image.colorspace_settings.is_data


def test_whose_a_message_is():
    """Names have quotes too: the longest that fits, and its node."""
    common.empty_scene()
    short, long = (bpy.data.materials.new(name) for name in ("plate", "plate' two"))
    for material in (short, long):
        common.tree_of(material).nodes.new("ShaderNodeBump").name = "Bump"
    cause = module("report").cause
    assert cause("material 'plate' two': 'Bump': left out")[:2] == (long, "Bump")
    assert cause("material 'plate': 'Bump': left out")[:2] == (short, "Bump")
    assert cause("nothing 'plate': left out")[0] is None


def test_the_viewport_has_samples_of_its_own():
    viewport, scene = module("viewport"), common.empty_scene(8, 8)
    scene.libshade.samples, scene.libshade.preview_samples = 9, 7
    seen, read = [], viewport.export.read
    viewport.export.read = lambda _depsgraph, _camera, size, region, samples, *_others, **_more: seen.append((size, region, samples))
    try:
        view = viewport._View((8, 6), Matrix.Identity(4), Matrix.Identity(4), (0.1, 100), (0, 0, 8, 6))
        viewport.Viewport()._read(view, bpy.context.evaluated_depsgraph_get(), None)
    finally:
        viewport.export.read = read
    assert seen == [((8, 6), (0, 0, 8, 6), 7)]


def test_pixels_that_no_file_has_are_read_each_time():
    """Painted ones are: Blender need not tell that they changed."""
    common.empty_scene()
    image = bpy.data.images.new("painted", 4, 4)
    image.pack()
    kept, fetched = module("export.kept").Kept(), []
    for dirty, times in ((False, 1), (True, 2)):
        if dirty:
            image.pixels[0] = 0.5
        assert image.is_dirty == dirty
        fetched.clear()
        kept.begin()
        for _ in range(2):
            kept.image(image, None, lambda: fetched.append(1) or {})
        assert len(fetched) == times, dirty


def test_balls_at_points():
    """Each where its object carries it, and as large as the object is in the mean; when it moves, too. What the points say
    is each ball's own, the rest their object's."""
    turn = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.7, 4, (1, 2, 3)) @ Matrix.Diagonal((1, 2, 4, 1))
    places, sizes = np.array([[1.0, 0, 0], [0.2, -0.5, 3.0]]), np.array([0.5, 0.1])
    tones = np.array([[1.0, 2, 3, 4], [5, 6, 7, 8]])
    made = {"matrix": np.array(turn).ravel().tolist(), "motion": np.array([turn, Matrix.Identity(4)]),
            "attributes": [(9,) * 4, (0,) * 4, (0,) * 4]}
    points = module("export.strands").Points(places, sizes, {"tone": tones}.get)
    table = SimpleNamespace(attributes=SimpleNamespace(listed=[("OBJECT", "tone"), ("POINT", "tone"), ("POINT", "none")]))
    balls = module("export.scene")._at_points(made, points, table)
    assert len(balls) == 2
    for ball, place, size, tone in zip(balls, places, sizes, tones):
        assert np.array_equal(ball["attributes"], [(9,) * 4, tone, (0,) * 4])
        wanted = Matrix.Translation(turn @ Vector(place)) @ Matrix.Scale(2 * size, 4)
        assert np.allclose(np.reshape(ball["matrix"], (4, 4)), wanted, atol=1e-6)
        assert np.allclose(ball["motion"][0], wanted, atol=1e-5)
        assert np.allclose(ball["motion"][1], Matrix.Translation(place) @ Matrix.Scale(size, 4), atol=1e-6)


def test_the_focus_is_on_a_bone():
    """Which stands in its object, moved and stretched; without a bone of that name it is on the object."""
    scene = common.empty_scene()
    camera = common.camera(scene, (0, 0, 10))
    bones = bpy.data.armatures.new("bones")
    ob = bpy.data.objects.new("bones", bones)
    scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    bone = bones.edit_bones.new("tip")
    bone.head, bone.tail = (0, 0, 2), (0, 0, 3)
    bpy.ops.object.mode_set(mode="OBJECT")
    ob.location, ob.scale = (0, 0, 1), (1, 1, 1.5)
    dof = camera.data.dof
    dof.use_dof, dof.focus_object = True, ob
    for name, distance in (("tip", 6), ("none", 9)):
        dof.focus_subtarget = name
        depsgraph = bpy.context.evaluated_depsgraph_get()
        found = module("export.camera")._focus_distance(camera.evaluated_get(depsgraph), dof, depsgraph)
        assert abs(found - distance) < 1e-5, (name, found)


def test_custom_cameras_are_named():
    """What a program in OSL sees nothing here knows: seen in perspective, and said."""
    if "CUSTOM" not in bpy.types.Camera.bl_rna.properties["type"].enum_items:
        return
    camera, told = common.camera(common.empty_scene(), (0, 0, 5)), []
    for kind in ("PERSP", "CUSTOM"):
        camera.data.type = kind
        messages = module("export.messages").Messages()
        seen = module("export.camera").camera_of(camera, bpy.context.evaluated_depsgraph_get(), (64, 48), messages)
        told.append((seen, list(messages.warnings)))
    (plain, nothing), (custom, warned) = told
    assert custom == plain and plain["type"] == "PERSP" and not nothing
    assert warned == ["camera 'camera': custom (OSL) cameras are not supported; seen in perspective"], warned


def test_slubs_in_cycles():
    """A yarn of half its width has its picture over half of its crossing; place and crossing of a plain map."""
    scene = common.empty_scene(64, 4, samples=1)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = 1, False, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    common.camera(scene, (0, 0, 1), type="ORTHO", ortho_scale=2)
    material = bpy.data.materials.new("place")
    tree = common.tree_of(material)
    tree.nodes.clear()
    group, shine, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Group", "Emission", "OutputMaterial"))
    group.node_tree = module("fabric.place").place_tree()
    for name, value in (("Per Unit", (4, 4, 0)), ("Per Crossing", (0.25, 0.25, 0)), ("Warp Slub", (0, 1, 0.5)), ("Weft Slub", (0, 1, 1))):
        group.inputs[name].default_value = value
    tree.links.new(group.outputs["Place"], shine.inputs["Color"])
    tree.links.new(shine.outputs[0], output.inputs["Surface"])
    common.plane(material, 2)
    path = os.path.join(folder, "place.exr")
    common.render(path)
    image = bpy.data.images.load(path)
    seen = np.array(image.pixels[:], np.float32).reshape(4, 64, -1)[0, :, 0]
    u = 4 * (np.arange(64) + 0.5) / 64
    across = np.clip((u % 1 - 0.5) / 0.5 + 0.5, 1 / 64, 63 / 64)
    assert np.abs(seen - 0.25 * (np.floor(u) + across)).max() < 2e-3, (seen, u)


for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__, "done", flush=True)
print("all asserted")
common.finish()
