# SPDX-License-Identifier: GPL-3.0-or-later
"""Small parts of the add-on against what is known of them: parts.py FOLDER."""

import functools
import os
import sys
import time
from types import SimpleNamespace

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402
from parts_of import module, replaced  # noqa: E402

folder, = common.arguments()


def test_strands_between_points():
    """Catmull and Rom's curve through points of a parabola is that parabola, but at the ends, which count twice."""
    t, strands = np.arange(6.0), module("export.strands")
    given, two = np.stack([t, t * t, 0 * t], 1), np.array([4, 6])  # strands; the first stands still
    points, along = (part[13:] for part in strands._curves(np.concatenate([np.zeros((4, 3)), given]), two, 4))
    assert len(points) == 21 and np.allclose(strands._between(np.append([9.0] * 4, 1 + t), two, 4)[13:], 1 + np.arange(21) / 4)
    assert np.allclose(points[4:-4, 1], points[4:-4, 0] ** 2) and np.allclose(points[::4], given)
    x = points[4:-4, 0]
    assert np.allclose(along[4:-4] * np.hypot(1, 2 * x)[:, None], np.stack([0 * x + 1, 2 * x, 0 * x], 1))


def test_strands_do_not_twist():
    """What lies across a curve in a plane stays in that plane, or upright on it; each strand for itself."""
    angle = np.linspace(0, np.pi, 40)
    axis = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    side, up = module("export.strands")._across(np.concatenate([axis, axis[:, ::-1]]), np.array([0, 40]))
    for part in side, up:
        assert (np.sum(part[:39] * part[1:40], 1) > 0.99).all() and (np.sum(part[40:-1] * part[41:], 1) > 0.99).all()
    assert np.allclose(np.cross(side[:40], up[:40]), axis) and np.abs(np.sum(side[:40] * axis, 1)).max() < 1e-12
    assert np.ptp(side[:40, 2]) < 1e-9


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


def test_what_baking_scratches_says():
    """A tile of 6.4 cm in 512 texels: .125 mm each, beside scratches of 50 or 150 micrometres."""
    operators, said = module("scratches.operators"), []
    before = operators.bake, operators.description
    fake = SimpleNamespace(size="512", samples=3, tile=0.0, points=False, node_of=lambda _context: SimpleNamespace(id_data=SimpleNamespace(name="tree")),
                           report=lambda kind, text: said.append((*kind, text)))
    try:
        for width, fewer, fake.points in ((150e-6, False, False), (50e-6, True, False), (50e-6, False, True)):  # points are to be coarse
            operators.bake = lambda *_arguments, fewer=fewer: {"tile": 0.064, "fewer": fewer, "density": 1234.0}
            operators.description = lambda *_arguments, width=width: {"width": 1e3 * width}
            operators.LIBSHADE_OT_bake_scratches.execute(fake, bpy.context)
    finally:
        operators.bake, operators.description = before
    told = ("INFO", "512 × 512 texels of 0.125 mm, which repeat every 6.4 cm, are packed into the file")
    assert said == [told, told, ("WARNING", "A texel is 2.5 times as wide as a scratch: choose a smaller tile or more texels"),
                    ("WARNING", "There are no more than 1,234 scratches per cm²"), told], said


def test_what_makes_images_of_scratches_old():
    """Each number that the field has, its place, and how large it is in metres."""
    scene = common.empty_scene(8, 8)
    material = bpy.data.materials.new("scratched")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    node = material.node_tree.nodes.new(module("scratches").SCRATCHES)
    images, stamps = module("scratches.images"), []

    def stamp(unit=1.0, tile=0.1):
        stamps.append(images._stamp(node, unit, tile))
        return stamps[-1]
    assert stamp() == stamp()
    del stamps[1]
    stamp(tile=0.2)
    for unit in ("UV", "METRES"):
        node.unit = unit
        for size in (0.5, 0.25) if unit == "UV" else ():
            node.size = size
            stamp()
        for scale in (0.75, 3.0):
            stamp(scale)
    node.unit = "UV"
    for name in module("scratches.tree").NUMBERS:
        node.inputs[name].default_value = 0.5 * node.inputs[name].default_value + 0.125
        stamp()
    node.seed += 1
    stamp()
    assert len(set(stamps)) == len(stamps) == 15, stamps
    node.baked = images._stamp(node, 1.0, 0.1)
    assert not images.is_stale(node, scene)
    node.size *= 2
    assert images.is_stale(node, scene)
    node.baked = "[]"
    assert images.is_stale(node, scene)


def test_settings_of_cycles():
    """All of ours but four are Cycles'; a file's are taken over, and given back by undo."""
    scene = common.empty_scene(8, 8)
    ours, module_ = scene.libshade, module("cycles_settings")
    own = {"texture_blur", "filter_normals", "groove_transport", "bumps_mutual", "bumps_are", "bump_slopes", "soft_terminator"}
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
        scene.cycles.film_exposure = 2.5
        shown = viewport.Viewport()
        shown._error = "of before"
        shown._read(view, bpy.context.evaluated_depsgraph_get(), None)
    finally:
        viewport.export.read = read
    assert seen == [((8, 6), (0, 0, 8, 6), 7)]
    assert shown._exposure == 2.5 and shown._waiting and not shown._changed and not shown._error


def test_what_a_viewport_looks_at():
    """An orthographic view shows as much behind its origin as before it."""
    viewport = module("viewport")
    stands = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.5, 4, "X")
    area = SimpleNamespace(width=64, height=48)
    for perspective in (True, False):
        data = SimpleNamespace(view_matrix=stands.inverted(), window_matrix=Matrix.Identity(4), is_perspective=perspective,
                               view_perspective="PERSP" if perspective else "ORTHO")
        space = SimpleNamespace(clip_start=0.5, clip_end=100.0, camera=None, use_render_border=False)
        context = SimpleNamespace(region=area, region_data=data, space_data=space)
        view = viewport._view_of(context, SimpleNamespace(scene=bpy.context.scene))
        back = 0.0 if perspective else 100.0
        assert np.allclose(view.to_world @ Vector((0, 0, 0)), stands @ Vector((0, 0, back)), atol=1e-4), view
        assert view.clip == ((0.5, 100.0) if perspective else (0.5, 200.0)) and view.size == (64, 48) and view.region == (0, 0, 64, 48)


def test_what_mapping_nodes_make_of_directions_in_a_world():
    """A texture's is the inverse of a point's; of normals lengths are divided."""
    reader = module("export.world")._Reader
    material = bpy.data.materials.new("mapped")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    node, made = material.node_tree.nodes.new("ShaderNodeMapping"), {}
    for kind in ("VECTOR", "NORMAL", "POINT", "TEXTURE"):
        node.vector_type = "POINT"
        place, turn, scale = (1.0, -2.0, 0.5), (0.3, -0.5, 0.2), (2.0, 0.5, 1.5)
        for name, values in (("Location", place), ("Rotation", turn), ("Scale", scale)):
            node.inputs[name].default_value = values
        node.vector_type = kind
        made[kind] = reader._mapping(None, node, ())
    turned = Matrix.Rotation(0.2, 4, "Z") @ Matrix.Rotation(-0.5, 4, "Y") @ Matrix.Rotation(0.3, 4, "X")
    assert np.allclose(made["POINT"], Matrix.Translation(place) @ turned @ Matrix.Diagonal((*scale, 1)), atol=1e-5)
    assert np.allclose(made["TEXTURE"] @ made["POINT"], Matrix.Identity(4), atol=1e-5)
    assert np.allclose(made["VECTOR"], turned @ Matrix.Diagonal((*scale, 1)), atol=1e-5)
    assert np.allclose(made["NORMAL"], turned @ Matrix.Diagonal((0.5, 2.0, 1 / 1.5, 1)), atol=1e-5)


def test_what_the_viewport_says_of_a_picture():
    """No finer one follows one that failed; what went wrong is said, and how much more there is."""
    viewport = module("viewport")
    shown = viewport.Viewport()
    for finished, factor, failed, last in ((False, 1, False, False), (True, 1, False, True), (True, 8, False, False), (True, 8, True, True)):
        shown._finished, shown._failed, shown._made = finished, failed, SimpleNamespace(factor=factor)
        assert shown._is_last() == last, (finished, factor, failed)
    shown._messages = SimpleNamespace(errors=["bad"], warnings=["odd"])
    assert shown._complaint({"state": "done", "warnings": []}) == "bad (and 1 more)"
    assert shown._complaint({"state": "failed", "message": "broken", "warnings": ["old"]}) == "broken (and 3 more)"
    shown._messages = SimpleNamespace(errors=[], warnings=[])
    assert shown._complaint({"state": "done", "warnings": ["old"]}) == "old" and shown._complaint({"state": "done", "warnings": []}) == ""
    view = viewport._View((100, 60), None, None, None, (10, 20, 91, 60))
    for factor, size, region, samples in ((1, (100, 60), (10, 20, 91, 60), 9), (0, (100, 60), (10, 20, 91, 60), 9),
                                          (8, (13, 8), (1, 2, 12, 8), 1)):
        made = viewport._picture(view, factor, 9)
        assert (made.size, made.region, made.samples) == (size, region, samples), made


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
    """Which stands in its object, moved and stretched; without a bone of that name it is on the object. Behind the camera it is as far."""
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
    for place, name, distance in ((10, "tip", 6), (10, "none", 9), (-2, "tip", 6), (-2, "none", 3)):
        camera.location.z, dof.focus_subtarget = place, name
        depsgraph = bpy.context.evaluated_depsgraph_get()
        found = module("export.camera")._focus_distance(camera.evaluated_get(depsgraph), dof, depsgraph)
        assert abs(found - distance) < 1e-5, (place, name, found)


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


# What an artist finds: default, least, most; a person's, and Cycles' own where it has the setting, but for seven.
SETTINGS = {
    "samples": (64, 1, 1 << 16), "preview_samples": (16, 1, 1 << 16), "seed": (0, 0, 2**31 - 1), "max_bounces": (12, 0, 1024),
    "diffuse_bounces": (4, 0, 1024), "glossy_bounces": (4, 0, 1024), "transmission_bounces": (12, 0, 1024),
    "transparent_max_bounces": (8, 0, 1024), "sample_clamp_direct": (0, 0, 1e8), "sample_clamp_indirect": (10, 0, 1e8),
    "light_sampling_threshold": (0.01, 0, 1), "caustics_reflective": True, "caustics_refractive": True, "blur_glossy": (1, 0, 10),
    "texture_blur": (0.25, 0, 10), "filter_normals": True, "groove_transport": True, "bumps_mutual": False, "bumps_are": "RELIEF", "bump_slopes": "",
    "pixel_filter_type": "BLACKMAN_HARRIS",
    "filter_width": (1.5, 0.01, 10), "soft_terminator": True, "use_adaptive_sampling": False, "adaptive_threshold": (0.01, 0, 1),
    "adaptive_min_samples": (0, 0, 4096), "use_denoising": False, "use_preview_denoising": True, "use_animated_seed": False,
    "time_limit": (0, 0, 1e6)}
LAYER_SETTINGS = {"denoising_store_passes": False, "use_pass_shadow_catcher": False, "pass_debug_sample_count": False}
UNLIKE_CYCLES = {"samples", "preview_samples", "use_adaptive_sampling", "use_denoising", "use_preview_denoising", "pass_debug_sample_count"}


# The words beside them, and beside operators in menus and buttons; where a slider ends before its range does
LABELS = dict(line.strip().split(": ") for line in """samples: Samples; preview_samples: Viewport Samples; seed: Seed; max_bounces: Max Bounces; diffuse_bounces: Diffuse;
    glossy_bounces: Glossy; transmission_bounces: Transmission; transparent_max_bounces: Transparent; sample_clamp_direct: Clamp Direct; sample_clamp_indirect: Clamp Indirect;
    light_sampling_threshold: Light Threshold; caustics_reflective: Reflective Caustics; caustics_refractive: Refractive Caustics; blur_glossy: Filter Glossy;
    texture_blur: Texture Blur; filter_normals: Filter Normal Maps; groove_transport: Grooves Follow Bumps; bumps_mutual: Bumps Shade Each Other; bumps_are: Bumps Are;
    bump_slopes: Bump Slopes;
    pixel_filter_type: Pixel Filter; filter_width: Width; soft_terminator: Soft Terminator; use_adaptive_sampling: Adaptive Sampling; adaptive_threshold: Noise Threshold;
    adaptive_min_samples: Min Samples; use_denoising: Denoise; use_preview_denoising: Denoise Viewport; use_animated_seed: Animate Seed; time_limit: Time Limit;
    denoising_store_passes: Denoising Data; use_pass_shadow_catcher: Shadow Catcher; pass_debug_sample_count: Sample Count""".split(";"))
SLIDERS, DIGITS = {"samples": 4096, "preview_samples": 256}, {"light_sampling_threshold": 4, "adaptive_threshold": 4}
KINDS = {"filter_width": ("PIXEL", "NONE"), "time_limit": ("TIME_ABSOLUTE",) * 2}
OPERATORS = dict(line.strip().split(": ") for line in """add_assets: Add Assets to the Asset Browser; add_groove: Libshade Groove; add_studio_light: Add Studio Light;
    bake_scratches: Bake to Images; convert_to_group: Convert to Plain Group; copy_cycles_settings: Copy Settings from Cycles; copy_report: Copy Report;
    follow_bumps: Make Grooves Follow Bumps; import_wif: Import WIF; measure_cloth: Measure for Cycles; measured_metal: Measured Metal; metal_preset: Metal;
    remove_assets: Remove Assets from the Asset Browser; drop_scratch_images: Remove Images; save_scene: Save Scene for libshade; scratches_preset: Scratches;
    select_cause: Select; update_nodes: Update Libshade Nodes""".split(";"))


def test_defaults_and_ranges_of_settings():
    scene = common.empty_scene()
    for settings, table in ((scene.libshade, SETTINGS), (scene.view_layers[0].libshade, LAYER_SETTINGS)):
        theirs = (scene if settings == scene.libshade else scene.view_layers[0]).cycles.bl_rna.properties
        known = {name: p for name, p in settings.bl_rna.properties.items() if name not in ("rna_type", "name")}
        assert set(known) == set(table), set(known) ^ set(table)
        for name, wanted in table.items():
            p = known[name]
            found = (p.default, p.hard_min, p.hard_max) if isinstance(wanted, tuple) else p.default
            assert np.allclose(found, wanted) if isinstance(wanted, tuple) else found == wanted, (name, found)
            assert p.name == LABELS[name] and len(p.description) > 10 and not p.description.endswith("."), name
            if isinstance(wanted, tuple):
                found = (p.soft_min, p.soft_max, p.subtype or p.unit, p.unit)  # of a time it knows no word
                assert found == (p.hard_min, SLIDERS.get(name, p.hard_max), *KINDS.get(name, ("NONE", "NONE"))), (name, found)
                assert p.type == "INT" or p.precision == DIGITS.get(name, 2), name
            if name in theirs and name not in UNLIKE_CYCLES:
                assert theirs[name].default == p.default, name


# Of ours in the menus: those that change nothing in the file, which need no undo
UNDONE_BY_NOTHING = {"libshade.save_scene", "libshade.copy_report", "libshade.add_assets", "libshade.remove_assets"}


def test_operators_are_undone():
    common.enable()
    words = {f"libshade.{name}" for name in dir(bpy.ops.libshade)}
    assert len(words) > 12 and words >= UNDONE_BY_NOTHING
    for word in words:
        operator = getattr(bpy.types, word.replace("libshade.", "LIBSHADE_OT_"))
        assert operator.__doc__, word
        assert ("UNDO" in getattr(operator, "bl_options", ())) == (word not in UNDONE_BY_NOTHING), word
    assert {word.removeprefix("libshade."): getattr(bpy.types, word.replace("libshade.", "LIBSHADE_OT_")).bl_label for word in words} == OPERATORS
    filters = bpy.context.scene.libshade.bl_rna.properties["pixel_filter_type"].enum_items
    assert [(item.identifier, item.name) for item in filters] == [("BOX", "Box"), ("GAUSSIAN", "Gaussian"), ("BLACKMAN_HARRIS", "Blackman-Harris")]


def test_what_is_undone_is_read_again():
    kept, nodes = module("export.kept"), module("nodes")
    for when in ("undo_post", "redo_post", "load_post"):
        assert kept._forget in getattr(bpy.app.handlers, when), when
    size = module("fabric.size")
    for when in ("depsgraph_update_post", "undo_post", "redo_post", "render_init"):
        assert size.follow_unit in getattr(bpy.app.handlers, when), when
    assert size._note_all in bpy.app.handlers.load_post
    for when in ("undo_pre", "redo_pre", "load_pre"):
        assert nodes._forget_followed in getattr(bpy.app.handlers, when), when
    one = kept.Kept()
    one.begin()
    one._images["a"] = one._meshes["b"] = None
    one.begin()
    assert one._images and one._meshes
    kept._forget()
    one.begin()
    assert not one._images and not one._meshes


def test_what_makes_another_image():
    """Everything of an image that changes what is read of it."""
    kept = module("export.kept")
    image = bpy.data.images.new("about", 4, 4)
    told = [kept._about(image, None)]
    for word, value in (("alpha_mode", "PREMUL"), ("alpha_mode", "CHANNEL_PACKED"), ("generated_type", "UV_GRID"),
                        ("generated_color", (1, 0.5, 0, 1)), ("generated_width", 8), ("generated_height", 16),
                        ("use_generated_float", True), ("source", "FILE"), ("filepath", "//elsewhere.png")):
        setattr(image, word, value)
        told.append(kept._about(image, None))
    image.source = "GENERATED"
    image.colorspace_settings.name = "Non-Color"
    told.append(kept._about(image, None))
    assert len(set(told)) == len(told), told
    path = os.path.join(folder, "about")
    for k, size in enumerate((1, 2)):
        with open(path, "wb") as file:
            file.write(b"x" * size)
        os.utime(path, (k, k))
        told.append(kept._about(image, path))
    assert told[-1] != told[-2]


def test_many_sets_of_lights():
    """Thirty sets are bits of a number of 32; the others light all, and each is named."""
    told = module("export.messages").Messages()
    sets = module("export.light")._Sets("link", "receiver", "light linking", "it lights all", told)
    lamps = []
    if bpy.app.version < (4, 0):
        return
    for k in range(40):
        collection = bpy.data.collections.new(f"set {k}")
        lamp = SimpleNamespace(type="LIGHT", name=f"lamp {k}")
        lamp.original = SimpleNamespace(light_linking=SimpleNamespace(receiver_collection=collection))
        lamps.append(sets.of_light(lamp))
    assert lamps == [{"link": k} if k < 30 else {} for k in range(40)], lamps
    assert len(told.warnings) == 10 and all(f"'lamp {k}'" in "".join(told.warnings) for k in range(30, 40))
    # each for one of 30 objects alone: that object gets it, and no other
    objects = [bpy.data.objects.new(f"lit {k}", None) for k in range(31)]
    for some, ob in zip(sets._some, objects):
        some.add(ob)
    for k, ob in enumerate(objects):
        assert sets.of_object(ob, None) == (2**30 - 1) & ~(1 << k), k


def test_what_the_status_line_says():
    """The time that is left, not all of it, falls; none before there is something to tell it by."""
    engine = module("engine")
    now, state = [100.0], {"stage": "build", "memory": 3 << 20, "memory_peak": 5 << 20, "sample": 0, "samples": 64, "progress": 0.0}
    clock, engine.time = engine.time, SimpleNamespace(perf_counter=lambda: now[0])
    try:
        status = engine._Status()
        assert status.text(state) == "Mem:3.00M, Peak:5.00M | Building the BVH" and status.text(state) == ""
        state["stage"] = "render"
        assert status.text(state) == "Mem:3.00M, Peak:5.00M | Rendering | Sample 0/64"
        for seconds, done, left in ((110, 0.1, "01:30"), (150, 0.5, "00:50"), (180, 0.8, "00:20"), (7300, 0.5, "2:00:00")):
            now[0], state["progress"], state["sample"] = float(seconds), done, int(64 * done)
            assert status.text(state) == (f"Remaining {left} | Mem:3.00M, Peak:5.00M | Rendering | Sample {int(64 * done)}/64")
            now[0] += 0.3
            assert status.text(state) == ""
        # what several pictures share
        now[0] = 10.0
        assert engine._within({"time_limit": 30.0}, 40.0, 3) == {"time_limit": 10.0}
        assert engine._within({"time_limit": 0.0}, 40.0, 3) == {"time_limit": 0.0}
        assert engine._within({"time_limit": 30.0}, 5.0, 1) == {"time_limit": 0.1}
        for took, limits in ((1.0, [10.0, 14.5, 28.0]), (10.0, [10.0, 10.0, 10.0]), (40.0, [10.0, 0.05, 0.1])):
            had = []

            def picture(view, _count, _messages, took=took, had=had):
                had.append(view["time_limit"])
                now[0] += took
                return "seen"
            views, made = {name: {"time_limit": 30.0, "name": name} for name in ("objects", "shadows", "others")}, {}
            finished, last = engine.LibshadeEngine._pictures(SimpleNamespace(_picture=picture), views, made, 4, None)
            assert finished and last["name"] == "others" and list(made) == ["objects", "shadows"], made
            assert np.allclose([*had, last["time_limit"]], limits), (had, last)
        # Esc: the others are not begun, and the last has no part
        stops = SimpleNamespace(_picture=lambda view, *_: None if view["name"] == "objects" else 1 / 0)
        assert engine.LibshadeEngine._pictures(stops, views, made, 4, None) == (False, views["others"])
    finally:
        engine.time = clock


def test_errors_are_told_and_the_result_ends():
    engine, export, report = module("engine"), module("export"), module("report")
    scene = common.empty_scene()
    for error, words in ((export.SceneError("no camera"), "libshade: no camera"),
                         (MemoryError("of 9 GiB"), "libshade: out of memory: of 9"),
                         (KeyError("in\nner"), "libshade: internal error: engine.py, line ")):
        for preview in (False, True):
            told, ended = [], []

            def fails(*_arguments, error=error):
                raise error
            report.keep(scene, SimpleNamespace(errors=(), warnings=()))
            fake = SimpleNamespace(is_preview=preview, report=lambda kind, text: told.append((kind, text)), _render=fails,
                                   end_result=ended.append)
            fake._tell_failure = functools.partial(engine.LibshadeEngine._tell_failure, fake)
            engine.LibshadeEngine._view(fake, SimpleNamespace(scene=scene), None, SimpleNamespace(view="", whole="all"), None, None, None)
            assert len(told) == 1 and told[0][0] == {"ERROR"} and told[0][1].startswith(words) and ended == ["all"], told
            assert "\n" not in told[0][1] and bool(report.told(scene)) == (not preview), told
            whole = report.whole(scene)
            assert bpy.app.version_string in whole and (told[0][1].removeprefix("libshade: ") in whole) == (not preview), whole
            assert ("in fails" in whole) == (not preview and not isinstance(error, export.SceneError)), whole
    # what is told of a scene is what its last render told
    said = SimpleNamespace(errors=("bad",), warnings=("odd", "old"))
    report.keep(scene, said, ("native",))
    assert report.told(scene) == [("bad", True), ("odd", False), ("old", False), ("native", False)]
    assert report.whole(scene).splitlines()[1:] == ["Error: bad", "Warning: odd", "Warning: old", "Warning: native"], report.whole(scene)
    report.keep_failure(scene, "odd")
    assert report.told(scene) == [("odd", True), ("bad", True), ("odd", False), ("old", False), ("native", False)] or \
        report.told(scene)[0] == ("odd", True)
    report.keep(scene, SimpleNamespace(errors=(), warnings=("new",)))
    assert report.told(scene) == [("new", False)] and not report.told(bpy.data.scenes.new("another"))
    report.keep_slopes(scene, [(1, 0, 0, .27, .1, .2304), (0, .1, 0, 0, 0, 0)], [{"name": ""}, {"name": "steel"}])
    assert scene.libshade.bump_slopes == "steel: slopes 0.52, 0.48"
    assert report.whole(scene).splitlines()[2:] == ["Note: steel: slopes 0.52, 0.48"]
    report.keep_slopes(scene, [], [])
    assert scene.libshade.bump_slopes == ""


def test_slopes_are_told_of_a_render():
    scene = common.empty_scene(8, 8)
    material, tree, node = common.metal("steel", horizon="MUTUAL")
    output = node.outputs[0].links[0].to_node
    bump, noise = tree.nodes.new("ShaderNodeBump"), tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], node.inputs["Normal"])
    common.plane(material)
    common.camera(scene)
    # and where its time went, where that is asked: reading the scene took a part of it
    engine, told, began = module("engine"), [], time.perf_counter()
    os.environ["LIBSHADE_TIMINGS"] = "1"
    try:
        with replaced(engine, _summary=lambda *said: told.append(said) or "told"):
            bpy.ops.render.render()
    finally:
        del os.environ["LIBSHADE_TIMINGS"]
    (timings, seconds), = told
    assert 0 < seconds < time.perf_counter() - began and timings["samples"] > 0, told
    assert engine._summary({"wall": 1.5, "samples": 4, "tree": 0.25, "shade": 0.5, "tiny": 1e-4}, 0.125) == (
        "libshade: sync 0.125 s, render 1.500 s, 4 samples; seconds summed over threads: shade 0.500, tree 0.250")
    def slopes_of_steel():
        name, _, slopes = scene.libshade.bump_slopes.partition(": slopes ")
        assert name == "steel", scene.libshade.bump_slopes
        return [float(v) for v in slopes.split(", ")]
    assert all(1e-4 < v < 2 for v in slopes_of_steel())
    # one long wave of a map is a bump, or the shape of what was baked
    image, wave = bpy.data.images.new("baked", 64, 64, float_buffer=True), np.sin(2 * np.pi * (np.arange(64) + 0.5) / 64)
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., 0], pixels[..., 1], pixels[..., 2] = 0.5 - 0.25 * wave, 0.5, 0.5 + 0.5 * np.sqrt(1 - 0.25 * wave * wave)
    image.pixels.foreach_set(pixels.ravel())
    common.normal_map(tree, node, image)
    # and so it is by a shader of Cycles' own, whose switch is the scene's: shaded the same, and each deaf to the other's switch
    common.light(scene, rotation=(0.5, 0, 0))
    glossy = tree.nodes.new("ShaderNodeBsdfAnisotropic")  # Glossy, from 4.0 on
    node.distribution = node.brdf = glossy.distribution = "ASHIKHMIN_SHIRLEY"
    node.fresnel, node.detail = "NONE", "GRAM_SCHMIDT"
    for made in node, glossy:
        made.inputs["Color"].default_value, made.inputs["Roughness"].default_value = (0.7, 0.5, 0.2, 1), 0.5
        made.inputs["Anisotropy"].default_value = 0
    common.normal_map(tree, glossy, image)
    scene.libshade.bumps_mutual, pictures, path = True, [], os.path.join(folder, "bumps.exr")
    for shader, own, shared, low, high in ((node, "RELIEF", "SHAPE", 0.3, 0.45), (node, "SHAPE", "RELIEF", 0, 0.06),
                                           (glossy, "SHAPE", "RELIEF", 0.3, 0.45), (glossy, "RELIEF", "SHAPE", 0, 0.06)):
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        node.bumps_are, scene.libshade.bumps_are = own, shared
        common.render(path)
        assert low <= slopes_of_steel()[0] <= high, (shader.name, own, scene.libshade.bump_slopes)
        picture = bpy.data.images.load(path, check_existing=False)
        pictures.append(np.array(picture.pixels[:]))
    relief, shape, same_relief, same_shape = pictures
    assert not np.allclose(relief, shape, rtol=0.05), pictures
    assert np.allclose(relief, same_relief, rtol=1e-3) and np.allclose(shape, same_shape, rtol=1e-3), pictures


def test_studio_light():
    """Offered where one lamp and a dim world are all; what it adds is in the file, and undone it is gone."""
    studio, scene = module("studio"), common.empty_scene()
    assert studio.is_bare(scene)
    common.light(scene)
    world = scene.world = bpy.data.worlds.new("dim")
    background = common.tree_of(world).nodes["Background"].inputs
    background["Color"].default_value = (0.05, 0.05, 0.05, 1)
    assert studio.is_bare(scene)
    background["Strength"].default_value = 10
    assert not studio.is_bare(scene)
    background["Strength"].default_value = 1
    lamp = common.light(scene)
    assert not studio.is_bare(scene)
    bpy.data.objects.remove(lamp)
    if not studio._path():  # bpy of PyPI may come without
        return
    assert bpy.ops.libshade.add_studio_light() == {"FINISHED"} and not studio.is_bare(scene)
    sky = next(node for node in scene.world.node_tree.nodes if node.type == "TEX_ENVIRONMENT")
    assert sky.image.packed_file and scene.world != world and "UNDO" in studio.LIBSHADE_OT_add_studio_light.bl_options


# Panel, what is set, a setting in it, whether it is grey then; a person's
GREYED = (
    ("RENDER_PT_libshade_film", {"scene.libshade.pixel_filter_type": "BOX"}, "filter_width", True),
    ("RENDER_PT_libshade_film", {"scene.libshade.pixel_filter_type": "GAUSSIAN"}, "filter_width", False),
    ("RENDER_PT_libshade_film", {"scene.libshade.pixel_filter_type": "BLACKMAN_HARRIS"}, "filter_width", False),
    ("RENDER_PT_libshade_film", {"scene.render.film_transparent": False}, "film_transparent_glass", True),
    ("RENDER_PT_libshade_film", {"scene.render.film_transparent": True}, "film_transparent_roughness", False),
    ("RENDER_PT_libshade_sampling", {"scene.libshade.use_adaptive_sampling": False}, "adaptive_threshold", True),
    ("RENDER_PT_libshade_sampling", {"scene.libshade.use_adaptive_sampling": True}, "adaptive_min_samples", False),
    ("RENDER_PT_libshade_light_paths", {"scene.libshade.bumps_mutual": False}, "bumps_are", True),
    ("RENDER_PT_libshade_light_paths", {"scene.libshade.bumps_mutual": True}, "bumps_are", False),
    ("RENDER_PT_libshade_performance", {"scene.render.threads_mode": "AUTO"}, "threads", True),
    ("RENDER_PT_libshade_performance", {"scene.render.threads_mode": "FIXED"}, "threads", False),
    ("RENDER_PT_libshade_motion_blur", {"scene.render.use_motion_blur": False}, "motion_blur_shutter", True),
    ("RENDER_PT_libshade_motion_blur", {"scene.render.use_motion_blur": True}, "motion_blur_shutter", False),
    ("RENDER_PT_libshade_motion_blur", {"scene.cycles.rolling_shutter_type": "NONE"}, "rolling_shutter_duration", True),
    ("RENDER_PT_libshade_motion_blur", {"scene.cycles.rolling_shutter_type": "TOP"}, "rolling_shutter_duration", False),
    ("OBJECT_PT_libshade_motion_blur", {"scene.render.use_motion_blur": True, "object.cycles.use_motion_blur": True}, "motion_steps", False),
    ("OBJECT_PT_libshade_motion_blur", {"scene.render.use_motion_blur": True, "object.cycles.use_motion_blur": False}, "motion_steps", True),
    ("OBJECT_PT_libshade_motion_blur", {"scene.render.use_motion_blur": False, "object.cycles.use_motion_blur": True}, "motion_steps", True),
)


def test_what_is_greyed():
    """A setting is grey where it changes nothing."""
    scene, panels, drawn = common.empty_scene(), module("panels"), {}
    ob = bpy.data.objects.new("thing", bpy.data.meshes.new("thing"))

    class Layout:
        active = use_property_split = use_property_decorate = True

        def prop(self, _of, name, **_more):
            drawn[name] = self

        def template_curve_mapping(self, *_which, **_more):
            pass
        operator = template_curve_mapping

        def row(self, **_more):
            return Layout()
        column = row

    for panel, settings, name, grey in GREYED:
        for path, value in settings.items():
            owner = {"scene": scene, "object": ob}[path.split(".")[0]]
            for part in path.split(".")[1:-1]:
                owner = getattr(owner, part)
            setattr(owner, path.rpartition(".")[2], value)
        getattr(panels, panel).draw(SimpleNamespace(layout=Layout()), SimpleNamespace(scene=scene, object=ob))
        assert drawn[name].active != grey, (panel, settings, name)


# What each panel shows, from the top: a property, "property = its words", an operator, or a line of text. A person's.
SHOWN = {
    "RENDER_PT_libshade_sampling": "samples = Render; preview_samples = Viewport; time_limit; use_adaptive_sampling; adaptive_threshold; adaptive_min_samples;"
    " light_sampling_threshold; use_denoising = Render; use_preview_denoising = Viewport; seed; use_animated_seed; libshade.copy_cycles_settings; libshade.save_scene",
    "RENDER_PT_libshade_light_paths": "max_bounces; diffuse_bounces; glossy_bounces; transmission_bounces; transparent_max_bounces; groove_transport; bumps_mutual;"
    " bumps_are; 'steel' .1 .2; 'tin' .3 .4; sample_clamp_direct; sample_clamp_indirect; blur_glossy; caustics_reflective; caustics_refractive; soft_terminator",
    "RENDER_PT_libshade_film": "film_transparent; film_exposure; film_transparent_glass; film_transparent_roughness; pixel_filter_type; filter_width; texture_blur; filter_normals",
    "RENDER_PT_libshade_motion_blur": "[use_motion_blur]; motion_blur_position = Position; motion_blur_shutter; rolling_shutter_type; rolling_shutter_duration; motion_blur_shutter_curve",
    "OBJECT_PT_libshade_motion_blur": "[use_motion_blur]; motion_steps = Steps; use_deform_motion = Deformation",
    "RENDER_PT_libshade_performance": "threads_mode; threads", "VIEWLAYER_PT_libshade_override": "material_override = Material",
    "RENDER_PT_libshade_share": "Convert All Nodes to Plain Groups (all_materials)",
    "VIEWLAYER_PT_libshade_passes": "use_pass_z; use_pass_mist; use_pass_position; use_pass_normal; use_pass_vector; use_pass_uv; denoising_store_passes; use_pass_shadow_catcher;"
    " pass_debug_sample_count; use_pass_object_index; use_pass_material_index; " + "".join(
        f"use_pass_{kind}_{part} = {part.title()}; " for kind in ("diffuse", "glossy", "transmission") for part in ("direct", "indirect", "color")) +
    "use_pass_emit = Emission; use_pass_environment; use_pass_ambient_occlusion = Ambient Occlusion; use_pass_cryptomatte_object = Object; "
    "use_pass_cryptomatte_material = Material; use_pass_cryptomatte_asset = Asset; pass_cryptomatte_depth = Levels; pass_alpha_threshold",
    "OBJECT_PT_libshade_light_group": "lightgroup", "WORLD_PT_libshade_light_group": "lightgroup",
    "SUN": "type; color; energy = Strength; angle; shadow", "POINT": "type; color; energy = Power; shadow_soft_size = Radius; shadow",
    "SPOT": "type; color; energy = Power; shadow_soft_size = Radius; spot_size; spot_blend; shadow", "AREA": "type; color; energy = Power; shape; size; spread; shadow",
    "AREA RECTANGLE": "type; color; energy = Power; shape; size = Size X; size_y = Y; spread; shadow",
    "AREA ELLIPSE": "type; color; energy = Power; shape; size = Size X; size_y = Y; spread; shadow", "AREA DISK": "type; color; energy = Power; shape; size; spread; shadow",
}
# Where a tab has them, and which of them are closed at first
TABS = {"RENDER": "render", "OBJECT": "object", "VIEWLAYER": "view_layer", "WORLD": "world", "DATA": "data"}
CLOSED = {"RENDER_PT_libshade_motion_blur", "OBJECT_PT_libshade_motion_blur", "RENDER_PT_libshade_performance", "VIEWLAYER_PT_libshade_override", "RENDER_PT_libshade_share",
          "OBJECT_PT_libshade_light_group", "WORLD_PT_libshade_light_group", "OBJECT_PT_libshade_visibility", "WORLD_PT_libshade_visibility", "RENDER_PT_libshade_simplify"}
# Words before several check boxes, and where no dots for keyframes are drawn
HEADINGS = {"RENDER_PT_libshade_sampling": ["Denoise"],
            "VIEWLAYER_PT_libshade_passes": ["Include", "Indexes", "Diffuse", "Glossy", "Transmission", "Other", "Cryptomatte"]}
STILL = {f"{tab}_PT_libshade_{name}" for tab, names in (("RENDER", ("sampling", "light_paths", "performance")), ("VIEWLAYER", ("passes",))) for name in names}
# What not every Blender has
NOT_ALL = {"exposure", "normalize", "use_soft_falloff", "use_shadow", "cast_shadow = Shadow"}


def test_what_panels_show():
    """In this order, under these words; the button for light where a scene has none, the lines of `Bump Slopes` apart."""
    scene, panels = common.empty_scene(), module("panels")
    ob, world, lamp = bpy.data.objects.new("thing", bpy.data.meshes.new("thing")), bpy.data.worlds.new("world"), bpy.data.lights.new("lamp", "POINT")
    scene.collection.objects.link(bpy.data.objects.new("lamp", lamp))
    bpy.context.view_layer.update()
    settings = SimpleNamespace(**{name: getattr(scene.libshade, name) for name in scene.libshade.__annotations__ if name != "bump_slopes"},
                               bump_slopes="'steel' .1 .2\n'tin' .3 .4")
    said, headings = [], []

    class Layout:
        def prop(self, owner, name, text=None, **_more):
            assert hasattr(owner, name), name
            said.append(f"[{name}]" if text == "" else f"{name} = {text}" if text else name)

        def operator(self, name, text="", **_more):
            asked = SimpleNamespace()
            said.append(lambda: (text or name) + "".join(f" ({key})" for key, value in vars(asked).items() if value))
            return asked

        def label(self, text):
            said.append(text)

        def template_curve_mapping(self, _owner, name):
            said.append(name)

        def prop_search(self, owner, name, of, groups, **_more):
            assert hasattr(owner, name) and hasattr(of, groups)
            said.append(name)

        def row(self, heading="", **_more):
            headings.append(heading)
            return Layout()
        column = row

    def shown(panel, shown_light=None):
        said.clear()
        headings.clear()
        settings_of = SimpleNamespace(libshade=settings, render=scene.render, cycles=scene.cycles, world=scene.world, objects=scene.objects)
        context = SimpleNamespace(scene=settings_of, object=ob, world=world, light=shown_light, view_layer=bpy.context.view_layer)
        drawn = SimpleNamespace(layout=Layout(), of=getattr(panel, "of", None))
        drawn._draw_area = lambda light: panel._draw_area(drawn, light)
        if hasattr(panel, "draw_header"):
            panel.draw_header(drawn, context)
        panel.draw(drawn, context)
        assert getattr(drawn.layout, "use_property_split", False) == (panel is not panels.RENDER_PT_libshade_share), panel  # names stand left of sliders
        assert getattr(drawn.layout, "use_property_decorate", True) == (panel.__name__ not in STILL), panel
        assert [heading for heading in headings if heading] == HEADINGS.get(panel.__name__, []), (panel, headings)
        return [line() if callable(line) else line for line in said]

    with replaced(panels, is_bare=lambda _scene: False):
        for name, wanted in SHOWN.items():
            if "_PT_" in name:
                assert shown(getattr(panels, name)) == wanted.split("; "), (name, said)
                continue
            lamp.type = name.split()[0]
            light = bpy.data.lights["lamp"]
            if " " in name:
                light.shape = name.split()[1]
            found = shown(panels.DATA_PT_libshade_light, light)
            assert [line for line in found if line not in NOT_ALL] == wanted.split("; ")[:-1] and (found[-1] in NOT_ALL), (name, found)
            assert ("normalize" in found) == hasattr(light, "normalize") and ("use_soft_falloff" in found) == (name in ("POINT", "SPOT") and hasattr(light, "use_soft_falloff"))
    with replaced(panels, is_bare=lambda _scene: True):
        assert shown(panels.RENDER_PT_libshade_sampling)[:2] == ["libshade.add_studio_light", "samples = Render"]
    for panel in panels._registered:
        assert panel.bl_context == TABS[panel.__name__.split("_")[0]] and panel.bl_space_type == "PROPERTIES" and panel.COMPAT_ENGINES == {"LIBSHADE"}, panel
        assert ("DEFAULT_CLOSED" in getattr(panel, "bl_options", ())) == (panel.__name__ in CLOSED), panel
        assert panel.poll(SimpleNamespace(engine="CYCLES", light=lamp, object=ob, world=world, camera=None)) is False, panel


def test_a_group_stands_where_its_node_stood():
    common.empty_scene()
    material, tree, node = common.metal("framed")
    frame = tree.nodes.new("NodeFrame")
    node.parent, node.location, node.width, node.hide, node.label, name = frame, (30, -40), 222, True, "mine", node.name
    node.inputs["Rotation"].default_value = 0.25
    where = tuple(node.location)
    target = node.outputs[0].links[0].to_socket.node.name
    assert bpy.ops.libshade.convert_to_group(all_materials=True) == {"FINISHED"}
    group = tree.nodes[name]
    assert group.bl_idname == "ShaderNodeGroup" and group.parent == frame and tuple(group.location) == where
    assert (group.width, group.hide, group.label) == (222, True, "mine")
    assert abs(group.inputs["Rotation"].default_value - 0.25) < 1e-6
    assert group.outputs[0].links[0].to_socket.node.name == target


def test_whose_nodes_become_groups():
    """Those of the active material alone, or of all of them and of groups; not what is linked from another file."""
    def left():
        return {owner.name: sum(n.bl_idname == "LibshadeMetalNode" for n in tree.nodes) for owner, tree in owners}
    common.empty_scene()
    materials = [common.metal(name)[0] for name in ("one", "two")]
    group = bpy.data.node_groups.new("inside", "ShaderNodeTree")
    group.nodes.new("LibshadeMetalNode")
    owners = [*((m, m.node_tree) for m in materials), (group, group)]
    ob = bpy.data.objects.new("thing", bpy.data.meshes.new("thing"))
    ob.data.materials.append(materials[1])
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    assert bpy.ops.libshade.convert_to_group() == {"FINISHED"} and left() == {"one": 1, "two": 0, "inside": 1}, left()
    assert bpy.ops.libshade.convert_to_group(all_materials=True) == {"FINISHED"} and not any(left().values()), left()


def test_operators_of_a_node():
    """On one of their kind that is the file's own."""
    own = module("own_node")

    class Of(own.OnNode):
        kind = "mine"
    for kind, library, may in (("mine", None, True), ("mine", "another.blend", False), ("other", None, False)):
        node = SimpleNamespace(bl_idname=kind, id_data=SimpleNamespace(library=library))
        for context in (SimpleNamespace(node=node), SimpleNamespace(active_node=node)):
            assert Of.poll(context) == may, (kind, library)
        assert type("Panel", (own.NodePanel,), {"kind": "mine"}).poll(SimpleNamespace(active_node=node)) == (kind == "mine")
    assert not Of.poll(SimpleNamespace(active_node=None))


def test_the_dialog_of_images_knows_those_that_there_are():
    operators, scratches = module("scratches.operators"), module("scratches.images")
    tree = {scratches.MADE: (1024, 5, 1)}
    node = SimpleNamespace(node_tree=tree, id_data=SimpleNamespace(nodes=SimpleNamespace(active=None)))
    manager = SimpleNamespace(invoke_props_dialog=lambda _asked: {"RUNNING_MODAL"})
    for made, wanted in (((1024, 5, 1), ("1024", 5, True)), ((512, 1, 0), ("512", 1, False)), ((77, 1, 1), ("2048", 3, False))):
        tree[scratches.MADE] = made
        asked = SimpleNamespace(node_of=lambda _context: node, size="2048", samples=3, points=False)
        said = operators.LIBSHADE_OT_bake_scratches.invoke(asked, SimpleNamespace(window_manager=manager), None)
        assert said == {"RUNNING_MODAL"} and (asked.size, asked.samples, asked.points) == wanted and node.id_data.nodes.active == node


class Stopped(Exception):
    """Far enough."""


def of_engine(scene, preview):
    """What the module would get of a scene, and whether the engine asked where to save it; nothing is rendered."""
    engine, asked = module("engine"), []
    fake = SimpleNamespace(is_preview=preview, resolution_x=16, resolution_y=12, update_stats=lambda *_texts: None,
                           camera_override=scene.camera)
    place, start = engine.saved.place_of, engine._start

    def stop(made):
        asked.append(made)
        raise Stopped
    engine.saved.place_of, engine._start = lambda *_which: (asked.append("place"), ("", False))[1], stop
    try:
        engine.LibshadeEngine._render_scene(fake, bpy.context.evaluated_depsgraph_get(), (0, 0, 16, 12), SimpleNamespace(view=""),
                                            np.zeros(16 * 12 * 4, np.float32), module("export").Messages())
    except Stopped:
        pass
    finally:
        engine.saved.place_of, engine._start = place, start
    return asked[-1], "place" in asked


# A setting, and what the native module is told of it; a person's.
TOLD = (
    ("render.threads_mode", "AUTO", "threads", 0), ("render.threads_mode", "FIXED", "threads", 3), ("render.threads", 256, "threads", 256),
    ("render.threads", 1024, "threads", 256), ("libshade.samples", 33, "samples", 33), ("libshade.seed", 7, "seed", 7),
    ("libshade.use_animated_seed", True, "seed", 12), ("libshade.max_bounces", 3, "max_bounces", 3),
    ("libshade.diffuse_bounces", 1, "diffuse_bounces", 1), ("libshade.glossy_bounces", 2, "glossy_bounces", 2),
    ("libshade.transmission_bounces", 5, "transmission_bounces", 5), ("libshade.transparent_max_bounces", 6, "transparent_max_bounces", 6),
    ("libshade.sample_clamp_direct", 4.0, "sample_clamp_direct", 4), ("libshade.sample_clamp_indirect", 2.0, "sample_clamp_indirect", 2),
    ("libshade.light_sampling_threshold", 0.25, "light_sampling_threshold", 0.25), ("libshade.blur_glossy", 0.5, "blur_glossy", 0.5),
    ("libshade.texture_blur", 0.5, "texture_blur", 0.5), ("libshade.caustics_reflective", False, "caustics_reflective", False),
    ("libshade.caustics_refractive", False, "caustics_refractive", False), ("libshade.soft_terminator", False, "soft_terminator", False),
    ("libshade.filter_normals", False, "normal_blur", 0), ("libshade.time_limit", 5.0, "time_limit", 5),
    ("libshade.pixel_filter_type", "BOX", "filter_width", 0), ("libshade.pixel_filter_type", "GAUSSIAN", "filter_width", 4.5),
    ("libshade.pixel_filter_type", "BLACKMAN_HARRIS", "filter_width", 3), ("libshade.filter_width", 2.0, "filter_width", 4),
    ("render.film_transparent", True, "transparent", True), ("cycles.film_transparent_glass", True, "clear_glass", 0.01),
    ("cycles.film_transparent_roughness", 0.5, "clear_glass", 0.25), ("render.film_transparent", False, "clear_glass", None),
    ("libshade.adaptive_min_samples", 9, "adaptive_min_samples", None), ("libshade.use_adaptive_sampling", True, "adaptive_min_samples", 9),
    ("libshade.adaptive_min_samples", 1, "adaptive_min_samples", 4), ("libshade.adaptive_threshold", 0.5, "adaptive_threshold", 0.5),
    ("libshade.use_preview_denoising", True, "use_denoising", None), ("libshade.use_denoising", True, "use_denoising", True),
)


def test_what_the_module_is_told():
    """Each setting by itself, after those before it. Material balls are rendered by other rules and leave no file."""
    scene = common.empty_scene(16, 12)
    common.camera(scene, (0, 0, 5))
    scene.render.threads_mode, scene.render.threads = "AUTO", 3
    scene.frame_set(5)
    scene.cycles.film_transparent_roughness = 0.1
    for path, value, key, wanted in TOLD:
        owner, _, name = path.partition(".")
        setattr(getattr(scene, owner), name, value)
        scene.update_tag()
        made, _ = of_engine(scene, False)
        assert wanted == made.get(key) or abs(made.get(key, 1e9) - wanted) < 1e-6, (path, value, key, made.get(key))
    os.environ["LIBSHADE_DUMP"] = "/no/such/dump.exr"
    try:
        for preview in (False, True):
            made, placed = of_engine(scene, preview)
            assert placed != preview and made["samples"] == (32 if preview else 33) and bool(made["dump"]) != preview, (preview, made["samples"])
    finally:
        del os.environ["LIBSHADE_DUMP"]


def test_materials_of_the_comparison():
    """Each is made of nodes that this Blender has, all of which lead to what is shown, and is read without a word; its images are packed, and
    what is no colour is read as numbers."""
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), *[os.pardir] * 3, "compare"))
    import materials_list
    import materials_make
    scene = common.empty_scene(8, 8)
    common.camera(scene, (0, 0, 5))
    builders, made = materials_list.BUILDERS | materials_list.STRANDS, []
    assert len(materials_list.BUILDERS) > 55 and len(materials_list.STRANDS) == 5 and {name[:5] for name in materials_list.STRANDS} == {"hair_"}
    for name, build in builders.items():
        maker = materials_make.Maker(name)
        maker.surface(build(maker))
        made.append(bpy.data.materials[name])
        tree = made[-1].node_tree
        seen, left = set(), [maker.end.node]
        while left:
            node = left.pop()
            if node.name not in seen:
                seen.add(node.name)
                left += [link.from_node for link in tree.links if link.to_node == node]
        # what an older one's shaders have no socket for leads nowhere
        assert bpy.app.version < (5, 0) or seen == {node.name for node in tree.nodes}, (name, {node.name for node in tree.nodes} - seen)
        assert maker.end.node.inputs["Surface"].is_linked and made[-1].use_fake_user
    for image in [image for image in bpy.data.images if image.name.split(".")[0] in builders]:
        used = [link.to_socket for material in made for link in material.node_tree.links if getattr(link.from_node, "image", None) == image]
        colours = any(socket.name in ("Base Color", "Color") and socket.node.type != "NORMAL_MAP" for socket in used)
        assert image.packed_file and used and (image.colorspace_settings.name == "sRGB") == colours, (image.name, [socket.name for socket in used])
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=len(made), y_subdivisions=1)
    mesh = bpy.context.object.data
    for material, polygon in zip(made, mesh.polygons):
        mesh.materials.append(material)
        polygon.material_index = len(mesh.materials) - 1
    scene.collection.objects.link(bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN")))
    messages = module("export").Messages()
    with replaced(module("export"), Messages=lambda: messages):
        scene_told, _ = of_engine(scene, False)
    assert not messages.errors and not messages.warnings, (list(messages.errors), list(messages.warnings))
    assert {material["name"] for material in scene_told["materials"]} >= set(builders)


def test_messages_are_told_once():
    """Of two eyes, too; and all of them are kept for the panel."""
    engine, report, scene = module("engine"), module("report"), common.empty_scene()
    said, told = [], set()
    fake = SimpleNamespace(report=lambda kind, text: said.append((*kind, text)))
    for warnings in (["odd"], ["odd", "new"], ["new"]):
        engine.LibshadeEngine._tell(fake, scene, SimpleNamespace(errors=["bad"], warnings=warnings), told)
    assert said == [("ERROR", "libshade: bad"), ("WARNING", "libshade: odd"), ("WARNING", "libshade: new")], said
    assert report.told(scene) == [("bad", True), ("new", False)]


def test_what_a_saved_scene_says():
    """Exposure multiplies light, and nothing else; what cannot be written, or not be rendered, is no success."""
    saved, export, written = module("saved"), module("export"), []
    passes = [SimpleNamespace(name=name, channels=letters, plane=plane) for name, letters, plane in (
        ("Depth", "Z", "Z"), ("Emit", "RGB", "EMISSION"), ("DiffCol", "RGB", "DIFFUSE_COLOR"), ("DiffDir", "RGB", "DIFFUSE_DIRECT"),
        ("other", "RGBA", export.AOV), ("shadow", "RGB", export.CATCHER))]
    scene, write, bpy_ = {"catchers": {"seen": []}}, saved.scene_file.write, saved.bpy
    try:
        saved.scene_file.write = lambda *said: written.append(said)
        saved.write("a.shscene", "layer", scene, passes, 2.5, [("view", "other", "RGBA", 1.0)], "texts")
        assert written == [("a.shscene", "layer", [
            (scene, [("Combined", "RGBA", "", 2.5), ("Depth", "Z", "Z", 1.0), ("Emit", "RGB", "EMISSION", 2.5),
                     ("DiffCol", "RGB", "DIFFUSE_COLOR", 1.0), ("DiffDir", "RGB", "DIFFUSE_DIRECT", 2.5)]),
            ("view", [("other", "RGBA", "", 1.0)])], "texts")], written
        for error in (OSError("full"), ValueError("odd")):
            def fails(*_said, error=error):
                raise error
            saved.scene_file.write = fails
            try:
                saved.write("a.shscene", "layer", scene, passes, 1.0, [], "")
                raise AssertionError("written all the same")
            except export.SceneError as told:
                assert str(error) in str(told)
        told, seen = [], []

        def renders():
            seen.append(saved._chosen)
            if len(seen) > 1:
                raise RuntimeError("no camera")
        saved.bpy = SimpleNamespace(path=bpy.path, ops=SimpleNamespace(render=SimpleNamespace(render=renders)))
        fake = SimpleNamespace(filepath="/tmp/b.shscene", report=lambda kind, text: told.append((*kind, text)))
        ends = [saved.LIBSHADE_OT_save_scene.execute(fake, None) for _ in range(2)]
    finally:
        saved.scene_file.write, saved.bpy = write, bpy_
    assert ends == [{"FINISHED"}, {"CANCELLED"}] and seen == ["/tmp/b.shscene"] * 2 and saved._chosen is None
    assert told == [("INFO", "Saved for shade-render: /tmp/b.shscene"), ("ERROR", "no camera")], told


class Items(list):
    """A collection of Blender's: attributes of its items by foreach_get."""

    def __init__(self, count, **attributes):
        super().__init__(range(count))
        self.attributes = attributes

    def foreach_get(self, name, values):
        values[:] = np.ravel(self.attributes[name])


def test_how_thick_hair_is():
    """Without a radius of their own curves are 5 mm thick in radius and points 10, as in Cycles; a spiral's steps are added."""
    strands = module("export.strands")
    curves = SimpleNamespace(points=Items(3, position=np.zeros((3, 3))), curves=Items(2, points_length=[2, 1]), attributes={})
    found = strands.of_curves(curves)
    assert np.allclose(found.radii, 0.005) and found.ends.tolist() == [2, 3]
    curves.attributes = {"radius": SimpleNamespace(domain="POINT", data_type="FLOAT", data=Items(3, value=[1, 2, 3]))}
    assert strands.of_curves(curves).radii.tolist() == [1, 2, 3]
    points = SimpleNamespace(attributes={"position": SimpleNamespace(data=Items(2, vector=np.zeros((2, 3))))})
    assert np.allclose(strands.of_points(points).radii, 0.01)
    plain = {"render_step": 2, "kink_extra_steps": 4, "kink": "NO", "child_type": "NONE", "shape": 0.0, "radius_scale": 1.0,
             "root_radius": 0.2, "tip_radius": 0.1, "use_close_tip": False}
    ob = SimpleNamespace(type="CURVES", matrix_world=Matrix.Identity(4))
    for change, steps, ends in (({}, 5, (0.1, 0.05)), ({"kink": "SPIRAL"}, 9, (0.1, 0.05)), ({"render_step": 3}, 9, (0.1, 0.05)),
                                ({"use_close_tip": True}, 5, (0.1, 0)), ({"radius_scale": 3.0}, 5, (0.3, 0.15))):
        system = SimpleNamespace(settings=SimpleNamespace(**{**plain, **change}), particles=[0], child_particles=[],
                                 co_hair=lambda _ob, particle_no, step: (particle_no, 0, step))
        hair = strands.of_hair(ob, None, system)
        assert hair.ends.tolist() == [steps] and np.allclose(hair.radii[[0, -1]], ends), (change, hair)


def test_the_viewport_is_never_coarser_than_that():
    """A picture that takes long makes the next one coarser, to 32 pixels; a quick one finer, to 2."""
    viewport = module("viewport")
    held, factors = viewport._native, []
    try:
        for wall, fits in ((9.0, lambda f: f == 32), (0.0, lambda f: f == 2)):
            viewport._native = SimpleNamespace(timings=lambda _job, wall=wall: {"wall": wall, "image": 0, "mesh": 0, "bvh": 0})
            shown = viewport.Viewport()
            for factor in (1, 2, 4, 8, 16, 32, 32, 32):
                shown._factor, shown._job = factor, None
                shown._made = SimpleNamespace(factor=factor)
                for _ in range(12):
                    shown._made.factor = shown._factor
                    shown._adapt()
                factors.append(shown._factor)
                assert fits(shown._factor), (wall, factors)
    finally:
        viewport._native = held


for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__, "done", flush=True)
print("all asserted")
common.finish()
