# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's Sky Texture, alone or above a floor."""

import bpy

import common

_NAMES = {"dust_density": "aerosol_density"}  # as 5.0 has it


def _sky(scene, settings, turn):
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    node = tree.nodes.new("ShaderNodeTexSky")
    plain = {"sun_disc": True, "sun_intensity": 1.0, "altitude": 100.0, "air_density": 1.0, "dust_density": 1.0,
             "ozone_density": 1.0, "sun_rotation": 0.0}
    for name, value in {**plain, **settings}.items():
        setattr(node, name if hasattr(node, name) else _NAMES[name], value)
    background = tree.nodes["Background"].inputs
    background["Strength"].default_value = 0.5
    tree.links.new(node.outputs["Color"], background["Color"])
    if turn:  # there is no socket beside a sun's disc
        mapping, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
        mapping.inputs["Rotation"].default_value = turn
        tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])


def _settings(scene, engine, samples):
    scene.render.engine = engine
    scene.render.film_transparent = False
    settings = scene.cycles if engine == "CYCLES" else scene.libshade
    settings.samples, settings.max_bounces = samples, 4
    if engine == "CYCLES":
        settings.use_denoising = settings.use_adaptive_sampling = False
        settings.blur_glossy = settings.light_sampling_threshold = 0
    return settings


def seen_sky(options):
    """A lattice of directions, one a pixel: half the sphere's, the horizon at a third of the height."""
    scene = common.empty_scene(128, 96)
    settings = _settings(scene, options["engine"], 1)
    settings.pixel_filter_type = "BLACKMAN_HARRIS"
    settings.filter_width = 0.01 if options["engine"] == "CYCLES" else 0.0  # pixels' middles
    _sky(scene, options["sky"], options.get("turn"))
    common.camera(scene, (0, 0, 0), options.get("look", (1.8, 0, -0.3)), angle=2.4)
    common.render(options["picture"])
    return {}


def under_sky(options):
    """A floor, a matt ball, a metal one."""
    scene = common.empty_scene(48, 32)
    _settings(scene, options["engine"], options["samples"]).pixel_filter_type = "BOX"
    _sky(scene, options["sky"], options.get("turn"))
    for kind, size, place in (("Diffuse", 0, None), ("Diffuse", 0.5, (1, -0.3, 0.5)), ("Glossy", 0.6, (-0.6, 0.2, 0.6))):
        material = bpy.data.materials.new(kind)
        tree = common.tree_of(material)
        shader = tree.nodes.new("ShaderNodeBsdf" + kind)
        shader.inputs["Color"].default_value = (0.6, 0.5, 0.4, 1)
        if kind == "Glossy":
            shader.distribution, shader.inputs["Roughness"].default_value = "GGX", 0.4
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        if place:
            bpy.ops.mesh.primitive_uv_sphere_add(radius=size, location=place, segments=48, ring_count=24)
            common.smooth(common.added(material).data)
        else:
            common.plane(material, 8)
    common.camera(scene, (0, -5, 3), (1.08, 0, 0))
    common.render(options["picture"])
    return {}
