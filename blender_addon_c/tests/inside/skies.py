# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's Sky Texture, alone or above a floor."""

import bpy
import numpy as np

import common

_NAMES = {"dust_density": "aerosol_density"}  # as 5.0 has it


def _sky(scene, settings, turn, hue=None):
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    node = tree.nodes.new("ShaderNodeTexSky")
    plain = {"sun_disc": True, "sun_intensity": 1.0, "altitude": 100.0, "air_density": 1.0, "dust_density": 1.0,
             "ozone_density": 1.0, "sun_rotation": 0.0}
    for name, value in {**plain, **settings}.items():
        setattr(node, name if hasattr(node, name) else _NAMES[name], value)
    background = tree.nodes["Background"].inputs
    background["Strength"].default_value = 0.5
    color = node.outputs["Color"]
    if hue:
        color = _node(tree, "HueSaturation", {"Color": color, **hue}).outputs["Color"]
    tree.links.new(color, background["Color"])
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


def _node(tree, kind, inputs=(), **settings):
    node = tree.nodes.new("ShaderNode" + kind)
    for name, value in settings.items():
        setattr(node, name, value)
    for name, value in dict(inputs).items():
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, node.inputs[name])
        else:
            node.inputs[name].default_value = value
    return node


def _ramp(tree, factor):
    node = _node(tree, "ValToRGB", {"Fac": factor})
    low, high = node.color_ramp.elements
    low.color, high.color = (0.05, 0.2, 0.6, 1), (1.0, 0.5, 0.1, 1)
    low.position, high.position = 0.3, 0.7
    return node.outputs["Color"]


def _height(tree, output="Generated"):
    """The z part of a direction, from 0 to 1."""
    parts = _node(tree, "SeparateXYZ", {0: tree.nodes.new("ShaderNodeTexCoord").outputs[output]})
    return _node(tree, "MapRange", {"Value": parts.outputs["Z"], "From Min": -1.0}).outputs[0]


def _picture(tree, projection="EQUIRECTANGULAR", rows=64):
    """An image of waves, each colour its own."""
    image = bpy.data.images.new("waves", 2 * rows, rows, float_buffer=True)
    v, u = np.mgrid[0:rows, 0:2 * rows] * np.pi / rows
    waves = [1.2 + np.sin(2 * u + 3 * v + k) * np.sin((1 + k) * v) for k in range(3)]
    image.pixels.foreach_set(np.stack([*waves, np.ones_like(u)], -1).astype(np.float32).ravel())
    return _node(tree, "TexEnvironment", image=image, projection=projection)


def _of(name):
    """The node of 5.0, or that of 3.4."""
    return name if hasattr(bpy.types, "ShaderNode" + name) else {"Mix": "MixRGB"}[name]


def _colored(tree, color):
    return _node(tree, "HueSaturation", {"Hue": 0.6, "Saturation": 1.2, "Value": 0.7, "Color": color}).outputs[0]


def _two_backgrounds(tree):
    one, other = (_node(tree, "Background", {"Color": color, "Strength": 1.0}).outputs[0]
                  for color in ((0.9, 0.4, 0.1, 1), _picture(tree).outputs["Color"]))
    return _node(tree, "MixShader", {0: _height(tree), 1: one, 2: other}).outputs[0]


def _turned(tree):
    coordinates = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    angle = _node(tree, "CombineXYZ", {"X": 0.4, "Z": 1.1}).outputs[0]
    picture = _picture(tree)
    tree.links.new(_node(tree, "Mapping", {"Vector": coordinates, "Rotation": angle}).outputs[0], picture.inputs["Vector"])
    return picture.outputs["Color"]


def _sum(tree, parts):
    """Of vectors of sockets, each with a weight of its own, and a half."""
    total = (0.5,) * 3
    for weight, socket in enumerate(parts, 2):
        node = _node(tree, "VectorMath", {0: socket, 1: (0.02 * weight,) * 3, 2: total}, operation="MULTIPLY_ADD")
        total = node.outputs[0]
    return total


def _of_places(tree):
    coordinates, geometry = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeNewGeometry")
    return _sum(tree, [*(coordinates.outputs[name] for name in ("Object", "Normal", "UV", "Reflection")),
                       *(geometry.outputs[name] for name in ("Position", "Normal", "Incoming", "True Normal"))])


def _of_cameras(tree):
    return _sum(tree, [tree.nodes.new("ShaderNodeTexCoord").outputs[name] for name in ("Camera", "Window")])


WORLDS = {
    "ramp": lambda tree: _ramp(tree, _height(tree)),
    "picture, colored": lambda tree: _colored(tree, _picture(tree).outputs["Color"]),
    "ball, colored": lambda tree: _colored(tree, _picture(tree, "MIRROR_BALL").outputs["Color"]),
    "clouds": lambda tree: _ramp(tree, _node(tree, "TexNoise", {"Scale": 1.5, "Detail": 2.0}).outputs["Fac"]),
    "two": _two_backgrounds,
    "turned": _turned,
    "warm": lambda tree: _node(tree, "Blackbody", {"Temperature": 3000.0}).outputs[0],
    "places": _of_places,
    "cameras": _of_cameras,
}


def _unlit(world):
    """Nothing is lit by it: Cycles need not learn where it is bright, which takes longer than a picture of it."""
    world.cycles.sampling_method = "NONE"


def seen_world(options):
    """Whatever nodes make of a world, by name: {name: directions as in seen_sky}."""
    scene = common.empty_scene(64, 48)
    settings = _settings(scene, options["engine"], 1)
    settings.pixel_filter_type = "BLACKMAN_HARRIS"
    settings.filter_width = 0.01 if options["engine"] == "CYCLES" else 0.0
    common.camera(scene, (2, -1, 3), options.get("look", (1.8, 0, -0.3)), angle=2.4)
    for name, make in WORLDS.items():
        scene.world = bpy.data.worlds.new(name)
        tree = common.tree_of(scene.world)
        made = make(tree)
        shines = made.type == "SHADER"
        to = tree.get_output_node("ALL").inputs["Surface"] if shines else tree.nodes["Background"].inputs["Color"]
        tree.links.new(made, to)
        _unlit(scene.world)
        common.render(f"{options['picture']}.{name}.exr")
    return {}


def noisy_world(options):
    """Another colour for each direction, however close, by so many samples."""
    scene = common.empty_scene(32, 24)
    common.camera(scene, (0, 0, 0), (1.8, 0, -0.3), angle=1.2)
    scene.world = bpy.data.worlds.new("noise")
    tree = common.tree_of(scene.world)
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    tree.links.new(_node(tree, "TexWhiteNoise", {"Vector": place}).outputs["Color"], tree.nodes["Background"].inputs["Color"])
    for samples in options["samples"]:
        _settings(scene, options["engine"], samples)
        common.render(f"{options['picture']}.{samples}.exr")
    return {}


def seen_sky(options):
    """A lattice of directions, one a pixel: half the sphere's, the horizon at a third of the height."""
    scene = common.empty_scene(128, 96)
    settings = _settings(scene, options["engine"], 1)
    settings.pixel_filter_type = "BLACKMAN_HARRIS"
    settings.filter_width = 0.01 if options["engine"] == "CYCLES" else 0.0  # pixels' middles
    _sky(scene, options["sky"], options.get("turn"))
    _unlit(scene.world)
    common.camera(scene, (0, 0, 0), options.get("look", (1.8, 0, -0.3)), angle=2.4)
    common.render(options["picture"])
    return {}


def under_sky(options):
    """A floor, a matt ball, a metal one."""
    scene = common.empty_scene(48, 32)
    _settings(scene, options["engine"], options["samples"]).pixel_filter_type = "BOX"
    _sky(scene, options["sky"], options.get("turn"), options.get("hue"))
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


def under_lamp(options):
    """A matt floor under a lamp of a warm colour, by nodes."""
    scene = common.empty_scene(24, 16)
    _settings(scene, options["engine"], options["samples"]).pixel_filter_type = "BOX"
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world).nodes["Background"].inputs["Strength"].default_value = 0.0
    lamp = common.light(scene, options["kind"], 3.0 if options["kind"] == "SUN" else 300.0, location=(0.5, 0, 2)).data
    lamp.color = (1.0, 0.9, 0.8)
    lamp.use_nodes = True
    tree = lamp.node_tree
    warm = _colored(tree, _node(tree, "Blackbody", {"Temperature": 3000.0}).outputs[0])
    strength = _node(tree, "Math", {0: 0.5, 1: 1.5}, operation="POWER").outputs[0]
    shader = _node(tree, "Emission", {"Color": warm, "Strength": strength})
    output = next(node for node in tree.nodes if node.type == "OUTPUT_LIGHT")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    material = bpy.data.materials.new("matt")
    tree = common.tree_of(material)
    tree.links.new(_node(tree, "BsdfDiffuse", {"Color": (0.8, 0.8, 0.8, 1)}).outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    common.plane(material, 8)
    common.camera(scene, (0, -5, 3), (1.08, 0, 0))
    common.render(options["picture"])
    return {}
