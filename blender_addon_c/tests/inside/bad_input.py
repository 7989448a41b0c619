# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that cannot be rendered as they are. arguments: FOLDER

For each: a line "CASE name", all that Blender prints, a line "ROW is it an error|owner|node" for each of the panel
of what is not rendered as in Cycles, and "END finished|error".
"""

import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

folder, = common.arguments()


def plate(scene, **leave_out):
    """A lit plate before a camera, without what is left out; returns (object, tree, node)."""
    material, tree, node = common.metal("steel", ex=6, ey=2)
    node.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
    ob = common.plane(material)
    if not leave_out.get("camera"):
        common.camera(scene)
    if not leave_out.get("light"):
        common.light(scene)
    return ob, tree, node


def image_file(name, content=None):
    """An image whose file is missing, or holds `content`."""
    path = os.path.join(folder, name)
    if content is not None:
        with open(path, "wb") as file:
            file.write(content)
    image = bpy.data.images.new(name, 4, 4)
    image.source, image.filepath = "FILE", path
    return image


def flat_image(red, green, blue):
    """An image of one colour, linear."""
    image = bpy.data.images.new("image", 4, 4, float_buffer=True, is_data=True)
    image.pixels.foreach_set([red, green, blue, 1] * 16)
    image.update()
    return image


def fine(scene):
    plate(scene)


def empty(scene):
    common.camera(scene)
    common.light(scene)


def no_camera(scene):
    plate(scene, camera=True)


def no_light(scene):
    plate(scene, light=True)


def no_uv(scene):
    ob, _tree, _node = plate(scene)
    ob.data.uv_layers.remove(ob.data.uv_layers[0])


def no_uv_matt(scene):
    ob, _tree, _node = plate(scene)
    ob.data.materials.clear()
    ob.data.uv_layers.remove(ob.data.uv_layers[0])


def no_uv_textured(scene):
    ob, tree, node = plate(scene)
    texture = common.image_node(tree, flat_image(0.2, 0.4, 0.6))
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    ob.data.uv_layers.remove(ob.data.uv_layers[0])


def no_faces(scene):
    ob, _tree, _node = plate(scene)
    wire = bpy.data.meshes.new("wire")
    wire.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    ob.data = wire


def missing_image(scene):
    _ob, tree, node = plate(scene)
    texture = common.image_node(tree, image_file("gone.png"))
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])


def missing_normal_map(scene):
    _ob, tree, node = plate(scene)
    common.normal_map(tree, node, image_file("gone.exr"))


def broken_image(scene):
    _ob, tree, node = plate(scene)
    texture = common.image_node(tree, image_file("broken.png", b"not a picture"))
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])


def no_image(scene):
    _ob, tree, node = plate(scene)
    common.normal_map(tree, node, None)


def eight_bit_normal_map(scene):
    _ob, tree, node = plate(scene)
    node.ex, node.ey = 8000.0, 8000.0
    common.normal_map(tree, node, bpy.data.images.new("bytes", 4, 4))


def blunt_eight_bit_normal_map(scene):
    _ob, tree, node = plate(scene)
    node.ex, node.ey = 1000.0, 10.0
    common.normal_map(tree, node, bpy.data.images.new("few", 4, 4, is_data=True))


def no_uv_area(scene):
    ob, _tree, _node = plate(scene)
    for corner in ob.data.uv_layers[0].data:
        corner.uv = 0.3 * corner.uv.x + 0.1, 0.7 * corner.uv.x + 0.2


def steep_normal_map(scene):
    """A tenth of its texels 60 degrees aside, the rest 45."""
    _ob, tree, node = plate(scene)
    image = bpy.data.images.new("steep", 10, 10, float_buffer=True, is_data=True)
    angles = [math.radians(60.0 if k % 10 == 0 else 45.0) for k in range(100)]
    image.pixels.foreach_set([part for a in angles for part in (0.5 + 0.5 * math.sin(a), 0.5, 0.5 + 0.5 * math.cos(a), 1.0)])
    common.normal_map(tree, node, image)


def less_steep_normal_map(scene):
    """The same, half as strong."""
    steep_normal_map(scene)
    tree = bpy.data.materials["steel"].node_tree
    tree.nodes["Normal Map"].inputs["Strength"].default_value = 0.5


def bump_node(scene):
    _ob, tree, node = plate(scene)
    bump = tree.nodes.new("ShaderNodeBump")
    wires = tree.nodes.new("ShaderNodeWireframe")
    tree.links.new(wires.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], node.inputs["Normal"])


def sky_color(scene):
    _ob, tree, node = plate(scene)
    sky = tree.nodes.new("ShaderNodeTexSky")
    tree.links.new(sky.outputs["Color"], node.inputs["Color"])


def ies(scene):
    _ob, tree, node = plate(scene)
    texture = common.image_node(tree, flat_image(0.2, 0.4, 0.6))
    source = tree.nodes.new("ShaderNodeTexIES")
    tree.links.new(source.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])


def cycle(scene):
    """Two nodes that feed each other; Blender itself may refuse the link."""
    _ob, tree, node = plate(scene)
    one, other = (tree.nodes.new("ShaderNodeGamma") for _ in range(2))
    for source, target in ((one, other), (other, one)):
        target.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
        tree.links.new(source.outputs["Color"], target.inputs["Color"])
    tree.links.new(other.outputs["Color"], node.inputs["Color"])


def deep_nodes(scene):
    """Three hundred, each of which feeds the next: more than Python's calls usually may be deep."""
    _ob, tree, node = plate(scene)
    socket = node.inputs["Color"]
    for _ in range(300):
        gamma = tree.nodes.new("ShaderNodeGamma")
        gamma.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
        tree.links.new(gamma.outputs["Color"], socket)
        socket = gamma.inputs["Color"]


def too_many_nodes(scene):
    """Images that are all needed at the end, each of three numbers."""
    _ob, tree, node = plate(scene)
    image = flat_image(0.2, 0.4, 0.6)
    looks = []
    for k in range(130):
        looks.append(common.image_node(tree, image))
        coordinates = tree.nodes.new("ShaderNodeCombineXYZ")
        coordinates.inputs["X"].default_value = k / 130
        tree.links.new(coordinates.outputs["Vector"], looks[-1].inputs["Vector"])
    socket = node.inputs["Color"]
    for look in looks:  # each is mixed with what all the others give
        mix = tree.nodes.new("ShaderNodeMixRGB")
        tree.links.new(look.outputs["Color"], mix.inputs["Color1"])
        tree.links.new(mix.outputs["Color"], socket)
        socket = mix.inputs["Color2"]


def other_uv_map(scene):
    _ob, tree, node = plate(scene)
    common.normal_map(tree, node, flat_image(0.5, 0.5, 1))[1].uv_map = "elsewhere"


def no_material(scene):
    ob, _tree, _node = plate(scene)
    ob.data.materials.clear()


def principled(scene):
    ob, _tree, _node = plate(scene)
    ob.data.materials[0] = bpy.data.materials.new("plain")
    inputs = common.tree_of(ob.data.materials[0]).nodes["Principled BSDF"].inputs
    inputs["Subsurface" if "Subsurface" in inputs else "Subsurface Weight"].default_value = 1


def light_linking(scene):
    """Only from 4.0 on. Two objects' light is for some others; one of them does not shine."""
    ob, _tree, _node = plate(scene)
    lamp = next(ob for ob in scene.objects if ob.type == "LIGHT")
    if bpy.app.version >= (4, 0):
        lamp.light_linking.receiver_collection = scene.collection
        ob.light_linking.blocker_collection = scene.collection


def displaced(scene):
    """The surface itself, which is bumped only; flat, it is as it was."""
    ob, tree, _node = plate(scene)
    material = ob.data.materials[0]
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = "DISPLACEMENT"
    node = tree.nodes.new("ShaderNodeDisplacement")
    tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Displacement"])


def volume(scene):
    """What is inside is left out."""
    _ob, tree, _node = plate(scene)
    node = tree.nodes.new("ShaderNodeVolumeAbsorption")
    tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Volume"])


def volume_alone(scene):
    """A surface without a shader shows what is behind."""
    volume(scene)
    tree = scene.objects["Plane"].data.materials[0].node_tree
    tree.links.remove(tree.get_output_node("ALL").inputs["Surface"].links[0])


def subsurface(scene):
    ob, tree, _node = plate(scene)
    node = tree.nodes.new("ShaderNodeSubsurfaceScattering")
    node.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
    tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Surface"])


def cloth_without_uv(scene):
    """And in colours that are none."""
    ob, tree, _node = plate(scene)
    shader = tree.nodes.new("LibshadeFabricNode")
    shader.inputs["Warp Color"].default_value = (math.nan, math.inf, -1, 1)
    shader.open_gaps, shader.transmission = True, 1
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    while ob.data.uv_layers:
        ob.data.uv_layers.remove(ob.data.uv_layers[0])


def mixed(scene):
    ob, tree, node = plate(scene)
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(node.outputs["BSDF"], mix.inputs[1])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def flat_lights(scene):
    """Of no size, and of no direction."""
    plate(scene)
    for kind in ("AREA", "SPOT", "SUN"):
        light = common.light(scene, kind, location=(0, 0, 2))
        light.scale = (0, 0, 0)
        if kind == "AREA":
            light.data.spread = math.radians(1)


def no_strength(scene):
    """The second lamp's is no number."""
    plate(scene)
    light = common.light(scene, "POINT", location=(0, 0, 2))
    light.name, light.data.energy = "broken lamp", math.nan


def curve_of_no_number(scene):
    _ob, tree, node = plate(scene)
    curve = tree.nodes.new("ShaderNodeRGBCurve")
    curve.inputs["Color"].default_value = (math.nan, math.inf, 0.5, 1)
    tree.links.new(curve.outputs[0], node.inputs["Color"])


def no_threshold(scene):
    """Of adaptive sampling."""
    plate(scene)
    scene.libshade.use_adaptive_sampling, scene.libshade.adaptive_threshold = True, math.nan


def portal(scene):
    plate(scene)
    common.light(scene, "AREA").data.cycles.is_portal = True


def cycles_alone(scene):
    plate(scene)
    scene.cycles.use_fast_gi = True
    scene.cycles.use_camera_cull = True  # without Simplify


def world_volume(scene):
    plate(scene)
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(volume.outputs[0], tree.get_output_node("ALL").inputs["Volume"])


def sky(scene, image):
    plate(scene)
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs[0], tree.nodes["Background"].inputs["Color"])
    return tree, texture


def world_without_image(scene):
    sky(scene, None)


def world_of_nothing(scene):
    """No number, less than no light, all that there is; looked up where a scale of 0 leads."""
    image = bpy.data.images.new("sky", 4, 2, float_buffer=True, is_data=True)
    image.pixels.foreach_set([math.nan, -1, math.inf, 1] * 8)
    image.update()
    tree, texture = sky(scene, image)
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.vector_type = "TEXTURE"
    mapping.inputs["Scale"].default_value = (0, 0, 0)
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])


def world_shader(scene):
    plate(scene)
    scene.render.film_transparent = False
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    matt = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(matt.outputs[0], tree.nodes["World Output"].inputs["Surface"])


def hair(scene):
    _ob, tree, _node = plate(scene)
    shader = tree.nodes.new("ShaderNodeBsdfHair")
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def no_shader(scene):
    _ob, tree, node = plate(scene)
    tree.nodes.remove(node)


def many_shaders(scene):
    """The metal, and nine that shine with black."""
    _ob, tree, node = plate(scene)
    last = node.outputs["BSDF"]
    for _ in range(9):
        add, shine = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeEmission")
        value = tree.nodes.new("ShaderNodeTexCoord")  # not known before the picture
        tree.links.new(value.outputs["Reflection"], shine.inputs["Color"])
        shine.inputs["Strength"].default_value = 1e-9
        tree.links.new(last, add.inputs[0])
        tree.links.new(shine.outputs[0], add.inputs[1])
        last = add.outputs[0]
    tree.links.new(last, tree.nodes["Material Output"].inputs["Surface"])


def blind(scene):
    plate(scene)
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 0.0


def flat_object(scene):
    ob, _tree, _node = plate(scene)
    ob.scale = (1, 0, 1)


def vanished_object(scene):
    ob, _tree, _node = plate(scene)
    ob.scale = (0, 0, 0)


def nowhere(scene):
    """One object of two."""
    ob, _tree, _node = plate(scene)
    common.link(scene, "lost", ob.data, (float("nan"), 0, 0))


def not_a_number(scene):
    ob, _tree, _node = plate(scene)
    ob.data.vertices[0].co = (float("nan"), 0, 0)
    ob.data.uv_layers[0].data[1].uv = (float("inf"), 0)


def slot_out_of_range(scene):
    ob, _tree, _node = plate(scene)
    ob.data.polygons[0].material_index = 7


def extreme_exponents(scene):
    _ob, _tree, node = plate(scene)
    node.ex, node.ey = 1e6, 0


def huge(scene):
    """Terabytes, which no machine has, and no more than Blender itself lets a picture be."""
    plate(scene)
    scene.render.resolution_x = scene.render.resolution_y = 1 << 16
    for _ in range(64):
        bpy.context.view_layer.aovs.add()


def one_pixel(scene):
    plate(scene)
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.render.resolution_percentage = 25


def text_and_curve(scene):
    plate(scene)
    bpy.ops.object.text_add()
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.view_layer.objects.active.data.extrude = 0.1


CASES = [
    fine, empty, no_camera, no_light, no_uv, no_uv_matt, no_uv_textured, no_faces, missing_image,
    missing_normal_map,
    broken_image, no_image, eight_bit_normal_map, blunt_eight_bit_normal_map, no_uv_area, steep_normal_map, less_steep_normal_map, bump_node, sky_color, ies, cycle,
    deep_nodes, too_many_nodes,
    other_uv_map, no_material, principled, light_linking, displaced, volume, volume_alone, subsurface, cloth_without_uv, mixed, hair, no_shader, many_shaders, flat_lights, no_strength, no_threshold, curve_of_no_number, portal, cycles_alone, world_volume, world_shader,
    world_without_image, world_of_nothing, blind,
    flat_object, vanished_object, nowhere, not_a_number, slot_out_of_range, extreme_exponents, huge, one_pixel,
    text_and_curve,
]

for case in CASES:
    case(common.next_scene(32, 24))
    report = sys.modules[common.MODULE + ".report"]
    print("CASE", case.__name__, flush=True)
    end = "finished"
    try:
        common.render(os.path.join(folder, case.__name__ + ".exr"))
    except RuntimeError as error:
        print(error)
        end = "error"
    for text, is_error in report.told(bpy.context.scene):
        owner, node, _icon, _rest = report.cause(text)
        print("ROW", "|".join((str(is_error), owner.name if owner else "", node)))
    print("END", end, flush=True)
common.finish()
