# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras of several views."""

import bpy

import common


def _shining(name):
    """Of the colours of its own places."""
    material = bpy.data.materials.new(name)
    tree = common.tree_of(material)
    shine, place = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(place.outputs["Generated"], shine.inputs["Color"])
    tree.links.new(shine.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return material


def eyes(options):
    """A head before a wall, both views side by side; options: engine, camera and stereo settings, right: a camera of its own."""
    scene = common.empty_scene(96, 72, samples=64)
    engine = scene.render.engine = options["engine"]
    settings = scene.cycles if engine == "CYCLES" else scene.libshade
    settings.samples, settings.max_bounces = 64, 0
    if engine == "CYCLES":
        settings.pixel_filter_type, settings.use_denoising, settings.use_adaptive_sampling = "BOX", False, False
    common.monkey(_shining("head"), rotation=(0.2, 0, 0.3))
    wall = common.plane(_shining("wall"), 12)
    wall.location, wall.rotation_euler = (0, 4, 0), (1.5708, 0, 0)
    left = common.camera(scene, (0.5, -5, 0.7), (1.45, 0.1, 0.05), **options.get("camera", {}))
    render, stereo = scene.render, left.data.stereo
    render.pixel_aspect_y = options.get("aspect", 1.0)
    render.use_multiview, stereo.interocular_distance, stereo.convergence_distance = True, 0.5, 4.0
    for name, value in options.get("stereo", {}).items():
        setattr(stereo, name, value)
    if "right" in options:
        render.views_format, left.name = "MULTIVIEW", "eye_L"
        common.camera(scene, (1.5, -5, 0.7), (1.45, 0, 0.3), lens=options["right"]).name = "eye_R"
        scene.camera = left
    if options.get("passes"):
        common.write_multilayer(scene)
        common.ask_for(scene.view_layers[0], options["passes"])
        render.image_settings.views_format = "MULTIVIEW"
    else:
        render.image_settings.views_format = "STEREO_3D"
        side = render.image_settings.stereo_3d_format
        side.display_mode, side.use_squeezed_frame = "SIDEBYSIDE", True
    common.render(options["picture"])
    return {}
