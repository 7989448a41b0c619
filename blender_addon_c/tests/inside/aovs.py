# SPDX-License-Identifier: GPL-3.0-or-later
"""What AOV Output nodes say."""

import bpy

import common


def _material(name, shader, **settings):
    material = bpy.data.materials.new(name)
    tree = common.tree_of(material)
    node = tree.nodes.new(shader)
    for key, value in settings.items():
        node.inputs[key].default_value = value
    tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return material, tree, node


def _output(tree, name):
    node = tree.nodes.new("ShaderNodeOutputAOV")
    if hasattr(node, "aov_name"):
        node.aov_name = name
    else:
        node.name = name
    return node


def aovs(options):
    """Two plates side by side, of which one shines and says what it is, and the other does not; nearer, below, a pane of which
    .7 is clear, and which says nothing."""
    scene = common.empty_scene(32, 32, samples=64)
    engine = scene.render.engine = options["engine"]
    if engine == "CYCLES":
        scene.cycles.samples, scene.cycles.pixel_filter_type = 64, "BOX"
        scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    common.write_multilayer(scene)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=4)
    said, tree, _ = _material("said", "ShaderNodeEmission", Strength=3)
    color, place = _output(tree, "color"), tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(place.outputs["UV"], color.inputs["Color"])
    inner = bpy.data.node_groups.new("inner", "ShaderNodeTree")
    value = _output(inner, "value")
    value.inputs["Value"].default_value = -0.25 if options.get("below") else 0.25
    tree.nodes.new("ShaderNodeGroup").node_tree = inner
    mute = _output(tree, "muted")
    mute.inputs["Color"].default_value, mute.mute = (1, 1, 1, 1), True
    silent, _, _ = _material("silent", "ShaderNodeBsdfDiffuse")
    for x, material in ((-1, said), (1, silent)):
        common.plane(material, 2).location = (x, 0, 0)
    pane, tree, clear = _material("pane", "ShaderNodeBsdfTransparent")
    mixed, matt = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    mixed.inputs[0].default_value = 0.3
    matt.inputs["Color"].default_value = (1, 1, 1, 1)  # what is darker has less than its share of Cycles' paths
    tree.links.new(clear.outputs[0], mixed.inputs[1])
    tree.links.new(matt.outputs[0], mixed.inputs[2])
    tree.links.new(mixed.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    common.plane(pane, 4).location = (0, -2, 1)
    common.light(scene)
    layer = scene.view_layers[0]
    for name, kind in (("color", "COLOR"), ("value", "VALUE"), ("muted", "COLOR"), ("missing", "VALUE")):
        one = layer.aovs.add()
        one.name, one.type = name, kind
    common.render(options["picture"])
    return {}


def occlusion(options):
    """A matt floor, and over it four balls: one that shines, one of glass, one matt with a bent normal, one that is a hole; panes."""
    scene = common.empty_scene(64, 48, samples=128)
    engine = scene.render.engine = options["engine"]
    if engine == "CYCLES":
        scene.cycles.samples, scene.cycles.pixel_filter_type = 128, "BOX"
        scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.film_exposure = 3  # which is not for it
    common.write_multilayer(scene)
    scene.world = None
    if options["distance"] is not None:
        scene.world = bpy.data.worlds.new("world")
        scene.world.light_settings.distance = options["distance"]
    common.camera(scene, (0, -3, 3), (0.7853982, 0, 0), type="ORTHO", ortho_scale=4)
    matt, tree, shader = _material("bent", "ShaderNodeBsdfDiffuse")
    normal = tree.nodes.new("ShaderNodeNormalMap")
    normal.inputs["Color"].default_value = (0.8, 0.5, 0.9, 1)
    tree.links.new(normal.outputs["Normal"], shader.inputs["Normal"])
    common.plane(_material("floor", "ShaderNodeBsdfDiffuse")[0], 5)
    for x, material in ((-1.2, _material("shines", "ShaderNodeEmission")[0]), (-0.4, _material("clear", "ShaderNodeBsdfGlass")[0]),
                        (0.4, matt), (1.2, matt)):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.35, location=(x, 0, 0.4))
        ball = bpy.context.object
        ball.data.materials.append(material)
        ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    ball.is_holdout = True
    bpy.data.objects["Plane"].is_shadow_catcher = bool(options.get("caught"))
    for x, full in ((-0.9, False), (0.9, True)):  # panes before the row, one that casts a full shadow
        pane, _, shader = _material("pane", "ShaderNodeBsdfTransparent")
        shader.inputs["Color"].default_value = (1, 1, 1, 1)
        if full:
            setattr(pane if hasattr(pane, "use_transparent_shadow") else pane.cycles, "use_transparent_shadow", False)
        common.plane(pane, 1).location = (x, -1.2, 0.4)
    common.light(scene)
    scene.view_layers[0].use_pass_ambient_occlusion = True
    common.render(options["picture"])
    return {}


def groups(options):
    """A floor with what shines of two groups and of none: a sun, a world, and a ball that shares its material with another."""
    scene = common.empty_scene(48, 32, samples=256)
    engine = scene.render.engine = options["engine"]
    if engine == "CYCLES":
        scene.cycles.samples, scene.cycles.pixel_filter_type = 256, "BOX"
        scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.film_exposure, scene.render.film_transparent = 2, False
    common.write_multilayer(scene)
    common.camera(scene, (0, -3, 3), (0.7853982, 0, 0), type="ORTHO", ortho_scale=4)
    common.plane(_material("floor", "ShaderNodeBsdfDiffuse")[0], 5)
    shines = _material("shines", "ShaderNodeEmission", Color=(1, 0.5, 0.2, 1), Strength=4)[0]
    for x, group in ((-1, "far"), (1, "")):
        bpy.ops.mesh.primitive_ico_sphere_add(radius=0.3, location=(x, 0, 0.4))
        bpy.context.object.data.materials.append(shines)
        bpy.context.object.lightgroup = group
    common.light(scene, rotation=(0.5, 0.3, 0), energy=2, size=0.2).lightgroup = "near"
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world).nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
    scene.world.lightgroup = "far"
    for name in "near", "far":
        scene.view_layers[0].lightgroups.add(name=name)
    common.render(options["picture"])
    return {}
