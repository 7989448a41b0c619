# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes for the tests, by name: a request a line on stdin, {"name": …, "dump": …, "options": …}.

A scene renders to options["picture"]; it is answered by a line "TOLD {json}" of facts for the
test, after all that Blender prints.
"""

import json
import math
import os
import sys

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common
import windowless
from aovs import aovs, groups, occlusion
from brought import brought
from eyes import eyes
from files import held_image, many_files
from skies import noisy_world, seen_sky, seen_world, under_lamp, under_sky


def view(options):
    """Suzanne before a camera with the given settings; tells where the camera's frame is."""
    scene = common.empty_scene(options["width"], options["height"])
    common.monkey(common.metal()[0])
    common.plane(common.metal("floor")[0], 20).location = (0, 0, -1)
    common.light(scene)
    camera = common.camera(scene, (3, -4, 3), (1.05, 0.1, 0.65), **options["camera"])
    camera.scale = (2, 2, 2)
    scene.render.pixel_aspect_x = options.get("aspect", 1)
    common.render(options["picture"])
    # Blender's own statement of the frame: corners before the camera, scale taken out.
    corners = camera.data.view_frame(scene=scene)
    place = Matrix.LocRotScale(camera.location, camera.rotation_euler, None)
    return {"corners": [list(c) for c in corners], "to_camera": [list(r) for r in place.inverted()]}


def lights(options):
    """A floor under a tilted sun and two point lights, one of them behind a wall."""
    scene = common.empty_scene(48, 32)
    common.plane(common.metal()[0], 8)
    wall = common.plane(common.metal("wall")[0], 2)
    wall.location, wall.rotation_euler = (-2, 0, 1), (0, math.pi / 2, 0)
    common.camera(scene, (0, 0, 10))
    sun = common.light(scene, "SUN", 2.5, rotation=(0.4, -0.3, 0.2))
    sun.data.color = (1, 0.5, 0.25)
    near = common.light(scene, "POINT", 100, location=(1, 1, 2))
    near.data.color = (0.2, 0.4, 1)
    hidden = common.light(scene, "POINT", 50, location=(-3, 0, 0.5))
    common.cast_shadow(hidden.data, options["shadow"])
    common.render(options["picture"])
    return {}


def mesh(options):
    """Flat or smooth ball; or a plane whose UVs are known; tells nothing."""
    scene = common.empty_scene(48, 48)
    material, _tree, _node = common.metal()
    if options["what"] == "plane":
        common.plane(material)
    else:
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=1)
        ball = common.added(material)
        common.smooth(ball.data, options["what"] == "smooth")
        if options["what"] == "custom":
            if hasattr(ball.data, "use_auto_smooth"):
                ball.data.use_auto_smooth = True
            ball.data.normals_split_custom_set([(0.6, 0, 0.8)] * len(ball.data.loops))
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=2.0)
    common.render(options["picture"])
    return {}


def slots(options):
    """Four planes in a row, left to right: two slots of one mesh, its linked copy with its own
    material, a collection instance."""
    scene = common.empty_scene(48, 12)
    red, blue, own, other = (common.metal(n)[0] for n in ("red", "blue", "own", "other"))
    data = bpy.data.meshes.new("two")
    data.from_pydata([(x, y, 0) for x in (0, 1, 2) for y in (-0.5, 0.5)], [],
                     [(0, 2, 3, 1), (2, 4, 5, 3)])
    data.uv_layers.new()
    for material in (red, blue):
        data.materials.append(material)
    data.polygons[1].material_index = 1
    common.link(scene, "first", data, (-4, 0, 0))
    copy = common.link(scene, "copy", data, (-2, 0, 0))
    copy.material_slots[0].link = "OBJECT"
    copy.material_slots[0].material = own
    collection = bpy.data.collections.new("instanced")
    single = bpy.data.meshes.new("single")
    single.from_pydata([(0, -0.5, 0), (1, -0.5, 0), (1, 0.5, 0), (0, 0.5, 0)], [], [(0, 1, 2, 3)])
    single.uv_layers.new()
    single.materials.append(other)
    collection.objects.link(bpy.data.objects.new("single", single))
    for x in (0, 2):
        empty = common.link(scene, "empty", None, (x, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=8.0)
    common.render(options["picture"])
    return {}


def film(options):
    """A small plane before a background, or a transparent film."""
    scene = common.empty_scene(64, 64, samples=16)
    common.plane(common.metal()[0], 1.03)
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=2.0)
    scene.render.film_transparent = options["transparent"]
    scene.world = bpy.data.worlds.new("world")
    background = common.tree_of(scene.world).nodes["Background"]
    background.inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
    background.inputs["Strength"].default_value = 0.5
    common.render(options["picture"])
    return {}


def border(options):
    """The same picture whole, or only its border."""
    scene = common.empty_scene(61, 47, samples=8)
    common.monkey(common.metal()[0])
    common.light(scene, rotation=(0.3, 0.2, 0))
    common.camera(scene)
    render = scene.render
    render.use_border, render.use_crop_to_border = options["border"], options["crop"]
    render.border_min_x, render.border_max_x = 0.21, 0.77
    render.border_min_y, render.border_max_y = 0.13, 0.613
    common.render(options["picture"])
    return {}


def layers(options):
    """Two view layers, the second without the plane."""
    scene = common.empty_scene(32, 32)
    collection = bpy.data.collections.new("first only")
    scene.collection.children.link(collection)
    plane = common.plane(common.metal()[0], 1)
    scene.collection.objects.unlink(plane)
    collection.objects.link(plane)
    other = common.plane(common.metal("other")[0], 0.5)
    other.location = (1, 1, 0)
    common.light(scene)
    common.camera(scene)
    second = scene.view_layers.new("second")
    second.layer_collection.children["first only"].exclude = True
    scene.view_layers[0].name = "first"
    common.write_multilayer(scene)
    common.render(options["picture"])
    return {}


def bump(options):
    """A plane under a float normal map of one direction, with the given strength and wiring."""
    scene = common.empty_scene(16, 16)
    material, tree, node = common.metal(detail="ROTATE")
    image = bpy.data.images.new("tilt", 4, 4, float_buffer=True, is_data=True)
    x, y = options["tilt"]
    normal = np.array([x, y, math.sqrt(1 - x * x - y * y)])
    image.pixels.foreach_set(np.tile([*(normal * 0.5 + 0.5), 1], 16).astype(np.float32))
    image.update()
    texture, bump = common.normal_map(tree, node, image, options["strength"])
    plane = common.plane(material)
    if options["wiring"] == "reroute":
        reroute = tree.nodes.new("NodeReroute")
        tree.links.new(bump.outputs["Normal"], reroute.inputs[0])
        tree.links.new(reroute.outputs[0], node.inputs["Normal"])
    elif options["wiring"] == "uv map":
        # The active render map is turned by a quarter; the node asks for the other.
        plane.data.uv_layers.new(name="turned")  # it moves the one that is there
        first, second = plane.data.uv_layers
        for loop in range(4):
            u, v = first.data[loop].uv
            second.data[loop].uv = (v, 1 - u)
        second.active_render = True
        bump.uv_map = first.name
    elif options["wiring"] == "mute":
        bump.mute = True
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=1.0)
    common.render(options["picture"])
    return {}


def color(options):
    """A plane whose Color is an image of two halves, sRGB bytes or linear floats; or an RGB node."""
    scene = common.empty_scene(32, 32)
    material, tree, node = common.metal()
    if options["kind"] == "rgb":
        source = tree.nodes.new("ShaderNodeRGB")
        source.outputs[0].default_value = (0.25, 0.5, 0.75, 1)
    else:
        image = bpy.data.images.new("halves", 8, 8, float_buffer=options["kind"] == "float")
        if options["kind"] == "data":
            image.colorspace_settings.name = "Non-Color"
        left, right = (0.25, 0.5, 0.75, 1), (1, 0, 0.5, 1)
        image.pixels.foreach_set(np.tile([left] * 4 + [right] * 4, (8, 1)).ravel()
                                 .astype(np.float32))
        source = common.image_node(tree, image)
        source.interpolation = "Closest"
    tree.links.new(source.outputs["Color"], node.inputs["Color"])
    common.plane(material)
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=2.0)
    common.render(options["picture"])
    return {}


def metal_sockets(options):
    """A plate of metal, its sockets (`fed`) read from the UV map or set by hand: roughness .3 to .8, anisotropy .2 to
    .7, no turn to .2, half a diffuse colour."""
    scene = common.empty_scene(48, 48, 64)
    lobe = {"distribution": "GGX"} if options.get("ggx") else {}
    material, tree, node = common.metal(fresnel="SCHLICK" if options.get("edge") else "NONE", **lobe)
    node.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
    apart, place = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(place.outputs[0], apart.inputs[0])
    fed = {"Roughness": ("X", 0.5, 0.3), "Anisotropy": ("Y", 0.5, 0.2), "Rotation": ("X", 0.2, 0.0),
           "Diffuse Color": ("Y", 0.2, 0.0)}
    fed |= {"Edge Tint": ("X", 0.8, 0.1)} if options.get("edge") else {}
    for name, (axis, factor, least) in fed.items():
        if name not in options["fed"]:
            middle = factor / 2 + least
            node.inputs[name].default_value = (middle,) * 3 + (1,) if "Color" in name or "Tint" in name else middle
            continue
        to = tree.nodes.new("ShaderNodeMath")
        to.operation, to.inputs[1].default_value, to.inputs[2].default_value = "MULTIPLY_ADD", factor, least
        tree.links.new(apart.outputs[axis], to.inputs[0])
        tree.links.new(to.outputs[0], node.inputs[name])
    common.plane(material)
    low = options.get("edge")  # eye and light near 82 degrees
    common.light(scene, rotation=(-1.4, 0, 0) if low else (0.5, 0.2, 0))
    common.camera(scene, *([(0, -4, 0.7), (1.4, 0, 0)] if low else []))
    scene.render.engine = options.get("engine", "LIBSHADE")
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    common.render(options["picture"])
    return {}


def metal_preset(options):
    """A monkey of a preset; `by`: a colour of its own, if any, on its socket ("socket") or by F82 ("f82"); `kept`: what it is without
    the colours on its sockets, as on nodes of older files."""
    scene = common.empty_scene(48, 48, 64)
    material, _tree, node = common.metal()
    nodes = sys.modules[f"{common.MODULE}.nodes"]
    nodes.apply_preset(node, "BRUSHED_BRASS")
    if options.get("kept"):
        node.set_color = (0, 0, 0, 0)
        node.inputs["Color"].default_value = (0.1, 0.2, 0.3, 1)
        node.eta = node.eta  # what is inside follows
    if options["by"]:
        node.inputs["Color"].default_value = (0.1, 0.2, 0.9, 1)
    if options["by"] == "f82":
        edge = tuple(node.inputs["Edge Tint"].default_value)
        node.set_color, node.fresnel = (0, 0, 0, 0), "F82"
        node.inputs["Edge Tint"].default_value = edge
    common.monkey(material)
    scene.world = bpy.data.worlds.new("sky")
    common.tree_of(scene.world)
    common.light(scene, rotation=(0.9, 0.2, 0))
    common.camera(scene)
    scene.render.engine = options.get("engine", "LIBSHADE")
    scene.cycles.samples, scene.cycles.use_denoising = 256, False
    common.render(options["picture"])
    return {}


def cycles(options):
    """A ball of metal in Cycles: by our node, by its plain group, or by an Anisotropic BSDF."""
    scene = common.empty_scene(48, 48)
    if options["converted"] == "anisotropic":
        material = bpy.data.materials.new("metal")
        tree = common.tree_of(material)
        tree.nodes.clear()
        node, output = tree.nodes.new("ShaderNodeBsdfAnisotropic"), tree.nodes.new("ShaderNodeOutputMaterial")
        node.distribution = "ASHIKHMIN_SHIRLEY"
        node.inputs["Roughness"].default_value, node.inputs["Anisotropy"].default_value = 0.4, -0.5
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = "UV_MAP"
        tree.links.new(tangent.outputs["Tangent"], node.inputs["Tangent"])
        tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    else:
        material, tree, node = common.metal(ax=0.32, ay=0.08, fresnel="NONE")
    node.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
    if options["converted"] is True:
        bpy.ops.libshade.convert_to_group(all_materials=True)
    bpy.ops.mesh.primitive_uv_sphere_add()
    common.smooth(common.added(material).data)
    common.light(scene, rotation=(0.5, 0, 0))
    common.camera(scene)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 8, False
    common.render(options["picture"])
    return {}


def cloth(options):
    """Two plates of cloth under a sun, 8 crossings of linen each; the second's colour is an image's,
    dark to the left, and what is behind shows between its yarns."""
    scene = common.empty_scene(48, 24, samples=16)
    scene.render.engine = options.get("engine", "LIBSHADE")
    if scene.render.engine == "CYCLES":
        scene.cycles.samples, scene.cycles.use_denoising = 8, False
    for x in (-1, 1):
        material = bpy.data.materials.new(f"cloth {x}")
        tree = common.tree_of(material)
        tree.nodes.clear()
        node, output = tree.nodes.new("LibshadeFabricNode"), tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
        node.preset, node.size = "LINEN", 8 / 15 / 100
        if x > 0:
            image = bpy.data.images.new("image", 2, 1, float_buffer=True)
            image.pixels.foreach_set(np.float32([0.05, 0.05, 0.05, 1, 0.8, 0.8, 0.8, 1]))
            texture = common.image_node(tree, image)
            texture.interpolation = "Closest"
            for name in ("Warp Color", "Weft Color"):
                tree.links.new(texture.outputs["Color"], node.inputs[name])
            node.open_gaps = True
        common.plane(material).location = (x, 0, 0)
    common.light(scene, rotation=(0.5, 0, 0))
    common.camera(scene, type="ORTHO", ortho_scale=4.0)
    common.render(options["picture"])
    return {}


def suzanne(options):
    """Suzanne subdivided on a bumped floor; options["save"]: keep the file, else open it."""
    if options.get("save"):
        scene = common.empty_scene(160, 120, samples=32)
        material, _tree, node = common.metal("steel", ex=200, ey=10)
        node.inputs["Color"].default_value = (0.7, 0.65, 0.6, 1)
        ob = common.monkey(material, location=(0, 0, 1), rotation=(-0.5, 0, 0.3))
        ob.modifiers.new("subdivision", "SUBSURF").render_levels = 2
        material, tree, node = common.metal("bumped", ex=10, ey=80)
        rows, columns = np.mgrid[0:128, 0:128] * (2 * math.pi / 128)
        slope = np.stack([-0.3 * np.cos(4 * columns), -0.3 * np.cos(4 * rows), 0 * rows + 1], -1)
        normal = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
        image = bpy.data.images.new("waves", 128, 128, float_buffer=True, is_data=True)
        pixels = np.concatenate([normal * 0.5 + 0.5, 0 * normal[..., :1] + 1], -1)
        image.pixels.foreach_set(pixels.ravel().astype(np.float32))
        image.pack()
        common.normal_map(tree, node, image)
        common.plane(material, 8)
        common.light(scene, rotation=(-0.9, 0.2, 0))
        common.light(scene, "POINT", 300, location=(-2, -3, 3))
        common.camera(scene, (0, -5, 3), (1.1, 0, 0))
        bpy.ops.wm.save_as_mainfile(filepath=options["save"])
    else:
        bpy.ops.wm.open_mainfile(filepath=options["open"])
        common.enable()
    common.render(options["picture"])
    return {}


def _in_cycles(scene, samples):
    """The same scene by Cycles: no denoising, no clamping, all samples."""
    scene.render.engine = "CYCLES"
    settings = scene.cycles
    settings.use_denoising = settings.use_adaptive_sampling = False
    settings.samples, settings.blur_glossy, settings.sample_clamp_indirect = samples, 0, 0
    settings.pixel_filter_type = "BOX"


def _plain(name, kind, color, **sockets):
    """One shader node, of type ShaderNode<kind>."""
    material = bpy.data.materials.new(name)
    tree = common.tree_of(material)
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNode" + kind)
    for socket, value in {"Color": (*color, 1), **sockets}.items():
        shader.inputs[socket].default_value = value
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def _matt(name, *color):
    return _plain(name, "BsdfDiffuse", color)


def _key(owner, path, *values):
    """Straight from one value to the next, frame by frame from 1 on."""
    for frame, value in enumerate(values):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=1 + frame)
    action = owner.id_data.animation_data.action
    curves = action.layers[0].strips[0].channelbags[0].fcurves if hasattr(action, "layers") and action.layers else action.fcurves
    for curve in curves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def _moving_camera(scene):
    _key(scene.camera, "location", (0, -6, 2.4), (0.3, -6, 2.4), (0.9, -5.6, 2.4))
    _key(scene.camera, "rotation_euler", (1.2, 0, 0), (1.2, 0, 0), (1.2, 0.1, 0.2))


def _zooming_camera(scene):
    _key(scene.camera.data, "lens", 50, 50, 40)


def _moving_object(scene):
    bpy.ops.mesh.primitive_cube_add(size=1.6)
    cube = common.added(_matt("cube", 0.8, 0.3, 0.1))
    cube.scale = (1, 0.6, 1.2)
    _key(cube, "location", (0, 0, 0.9), (0.2, 0, 0.9), (1, 0, 1.1))
    _key(cube, "rotation_euler", (0, 0, 0), (0.3, 0, 0), (0.3, 0.4, 2.6))
    still = bpy.data.objects.new("still", cube.data)
    still.location = (-1.6, 0, 1)
    scene.collection.objects.link(still)


def _moving_shape(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)
    ball = common.added(_matt("ball", 0.3, 0.7, 0.2))
    common.smooth(ball.data)
    ball.location = (0, 0, 1)
    ball.shape_key_add(name="basis")
    other = ball.shape_key_add(name="other")
    for point in other.data:
        x, y, z = point.co
        point.co = (1.6 * x + 0.5 * z, y, 0.6 * z)
    _key(other, "value", 0.0, 0.2, 1.0)


def _no_motion(scene):
    """What asks for blur and cannot have it."""
    import math
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    cube = common.added(_matt("cube", 0.8, 0.3, 0.1))
    _key(cube, "scale", (1, 1, 1), (1, 1, 1), (0, 0, 0))
    bpy.ops.mesh.primitive_uv_sphere_add()
    grown = common.added(_matt("grown", 0.8, 0.3, 0.1))
    modifier = grown.modifiers.new("array", "ARRAY")
    _key(modifier, "count", 1, 2, 3)
    wave = grown.modifiers.new("wave", "WAVE")
    wave.time_offset = -10
    far = bpy.data.objects.new("far", cube.data)
    scene.collection.objects.link(far)
    _key(far, "location", (0, 0, 0), (0, 0, 0), (1e30, math.inf, math.nan))


def moving(options):
    """One thing that moves over a floor under a sun and a lamp, from frame 2 to 3."""
    scene = common.empty_scene(64, 48, samples=options["samples"])
    scene.render.film_transparent = False
    common.plane(_matt("floor", 0.5, 0.5, 0.5), 12)
    common.camera(scene, (0, -6, 2.4), (1.2, 0, 0))
    common.light(scene, rotation=(0.7, 0.3, 0), energy=2.0, size=0.2)
    data = scene.camera.data
    if "panorama" in options:
        data.type = "PANO"
        for name, value in options["panorama"].items():
            setattr(data if hasattr(data, "panorama_type") else data.cycles, name, value)
    if "lens" in options:
        data.dof.use_dof = True
        for name, value in options["lens"].items():
            setattr(data.dof, name, value)
    for what in options["what"]:
        globals()[f"_{what}"](scene)
    render = scene.render
    render.use_motion_blur, render.motion_blur_shutter = options.get("blur", True), options.get("shutter", 1.0)
    owner = scene.cycles if hasattr(scene.cycles, "motion_blur_position") else render
    owner.motion_blur_position = options.get("position", "START")
    for ob in scene.objects:
        for name, value in options.get("object", {}).items():
            setattr(ob.cycles, name, value)
    if "rolling" in options:
        scene.cycles.rolling_shutter_type, scene.cycles.rolling_shutter_duration = "TOP", options["rolling"]
    if "border" in options:
        render.use_border = True
        render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y = options["border"]
    if "curve" in options:
        points = render.motion_blur_shutter_curve.curves[0].points
        for point, place in zip(points, options["curve"]):
            point.location = place
        render.motion_blur_shutter_curve.update()
    scene.frame_set(options.get("frame", 2))
    scene.libshade.max_bounces = 4
    if "passes" in options:
        common.write_multilayer(scene)
        common.ask_for(scene.view_layers[0], options["passes"])
    if options["engine"] == "CYCLES":
        _in_cycles(scene, options["samples"])
        scene.cycles.max_bounces = 4
    common.render(options["picture"])
    return {"frame": scene.frame_current}


def blind(options):
    """Only saves the file: a plane before a camera that cannot be rendered."""
    scene = common.empty_scene(16, 16)
    common.plane(common.metal()[0])
    common.camera(scene, type="ORTHO", ortho_scale=0.0)
    bpy.ops.wm.save_as_mainfile(filepath=options["save"])
    return {}


def around(options):
    """A ball that shines as its direction says, 2 more, and a camera that sees around in it."""
    scene = common.empty_scene(options.pop("width"), options.pop("height"), samples=1)
    engine, kind, path = (options.pop(name) for name in ("engine", "kind", "picture"))
    scene.render.film_transparent = False
    material = bpy.data.materials.new("direction")
    tree = common.tree_of(material)
    tree.nodes.clear()
    place, to, unit, more = tree.nodes.new("ShaderNodeNewGeometry"), *(
        tree.nodes.new("ShaderNodeVectorMath") for _ in range(3))
    to.operation, unit.operation = "SUBTRACT", "NORMALIZE"
    to.inputs[1].default_value, more.inputs[1].default_value = (1, 2, 3), (2, 2, 2)
    shine, out = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    for source, target in ((place.outputs["Position"], to), (to.outputs[0], unit), (unit.outputs[0], more),
                           (more.outputs[0], shine), (shine.outputs[0], out)):
        tree.links.new(source, target.inputs[0])
    bpy.ops.mesh.primitive_cube_add(size=20, location=(1, 2, 3))
    common.added(material)
    data = common.camera(scene, (1, 2, 3), (1.0, 0.3, -0.4), type="PANO").data
    settings = data if hasattr(data, "panorama_type") else data.cycles
    settings.panorama_type = kind
    for name, value in options.items():
        setattr(settings if hasattr(settings, name) else data, name, value)
    if engine == "CYCLES":
        _in_cycles(scene, 1)
    for settings in scene.cycles, scene.libshade:
        settings.pixel_filter_type, settings.filter_width = "BLACKMAN_HARRIS", 0.01
    common.render(path)
    return {}


# ---- one plain scene; each change is one thing that Blender says, and that the renderer must read

def plain_light(_ob, _light, _tree, _node):
    """A sun of energy 3 straight above a plane of one metal."""


def light_color(_ob, light, _tree, _node):
    light.data.color = (0.8, 0.5, 0.2)


def temperature(_ob, light, _tree, _node):
    light.data.color = (0.8, 0.5, 0.2)
    light.data.use_temperature, light.data.temperature = True, 2500
    return {"factor": list(light.data.temperature_color)}


def exposure(_ob, light, _tree, _node):
    light.data.exposure = -1.5


def emission(_ob, light, _tree, _node):
    light.data.use_nodes = True
    shader = light.data.node_tree.nodes["Emission"]
    shader.inputs["Color"].default_value = (0.5, 0.25, 1, 1)
    shader.inputs["Strength"].default_value = 1.75


def unused_emission(ob, light, tree, node):
    emission(ob, light, tree, node)
    light.data.use_nodes = False


def color_rgb(_ob, _light, tree, node):
    source = tree.nodes.new("ShaderNodeRGB")
    source.outputs[0].default_value = (0.2, 0.5, 0.7, 1)
    tree.links.new(source.outputs[0], node.inputs["Color"])


def color_tex_image(_ob, _light, tree, node):
    """One colour, in bytes of sRGB."""
    image = bpy.data.images.new("colour", 2, 2)
    image.pixels.foreach_set(np.tile([1, 230 / 255, 204 / 255, 1], 4).astype(np.float32))
    image.update()
    tree.links.new(common.image_node(tree, image).outputs["Color"], node.inputs["Color"])


def override(_ob, _light, _tree, _node):
    other, _, node = common.metal("other", ex=1, ey=7, fresnel="NONE", detail="NONE")
    node.inputs["Color"].default_value = (0.2, 0.4, 0.8, 1)
    bpy.context.view_layer.material_override = other


def _only_shader(ob, kind):
    material = ob.data.materials[0] = bpy.data.materials.new("plain")
    tree = common.tree_of(material)
    shader = tree.nodes.new(kind)
    shader.inputs["Color"].default_value = (0.7, 0.5, 0.2, 1)
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return shader


def diffuse(ob, _light, _tree, _node):
    _only_shader(ob, "ShaderNodeBsdfDiffuse")


def glossy(ob, _light, _tree, _node):
    shader = _only_shader(ob, "ShaderNodeBsdfGlossy")
    shader.distribution, shader.inputs["Roughness"].default_value = "GGX", 0.6


def no_material(ob, _light, _tree, _node):
    ob.data.materials.clear()


def tilted(tree, node, strength):
    """A float normal map of (0.48, 0.36, 0.8) everywhere."""
    image = bpy.data.images.new("tilt", 2, 2, float_buffer=True, is_data=True)
    image.pixels.foreach_set(np.tile([0.74, 0.68, 0.9, 1], 4).astype(np.float32))
    image.update()
    return common.normal_map(tree, node, image, strength)


def strength(_ob, _light, tree, node):
    tilted(tree, node, 2.0)


def value(_ob, _light, tree, node):
    _, bump = tilted(tree, node, 1.0)
    source = tree.nodes.new("ShaderNodeValue")
    source.outputs[0].default_value = 0.25
    tree.links.new(source.outputs[0], bump.inputs["Strength"])


def slot_clamp(ob, _light, _tree, _node):
    for name, color in (("second", (0.1, 0.2, 0.3, 1)), ("last", (0.2, 0.4, 0.8, 1))):
        material, _, node = common.metal(name, ex=1, ey=7, fresnel="NONE", detail="NONE")
        node.inputs["Color"].default_value = color
        ob.data.materials.append(material)
    ob.data.polygons[0].material_index = 7


def uv_layers(ob):
    """first: as it is; second: turned by a quarter; third: half as large. The third renders."""
    first = ob.data.uv_layers[0]
    first.name = "first"
    for name in ("second", "third"):  # each moves those that are there
        ob.data.uv_layers.new(name=name)
    _, second, third = ob.data.uv_layers
    for loop in range(4):
        u, v = ob.data.uv_layers["first"].data[loop].uv
        second.data[loop].uv, third.data[loop].uv = (v, 1 - u), (u / 2, v / 2)
    ob.data.uv_layers.active = ob.data.uv_layers["second"]
    ob.data.uv_layers["third"].active_render = True


def uv_active(ob, _light, _tree, _node):
    uv_layers(ob)


def edited(ob, _light, tree, node):
    """A file may be saved in edit mode."""
    uv_layers(ob)
    color_tex_image(ob, _light, tree, node)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")


def uv_node(ob, _light, tree, node):
    uv_layers(ob)
    image = bpy.data.images.new("image", 2, 2, float_buffer=True, is_data=True)
    source = tree.nodes.new("ShaderNodeUVMap")
    source.uv_map = "second"
    texture = common.image_node(tree, image)
    tree.links.new(source.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], node.inputs["Color"])


def uv_normal_map(ob, _light, tree, node):
    uv_layers(ob)
    tilted(tree, node, 1.0)[1].uv_map = "first"


def plain(options):
    """The plane from above, with one of the changes above made to it."""
    scene = common.empty_scene(16, 16)
    material, tree, node = common.metal(ex=6, ey=2, fresnel="NONE", detail="NONE")
    node.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
    ob = common.plane(material)
    light = common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=2.0)
    facts = globals()[options["change"]](ob, light, tree, node)
    common.render(options["picture"])
    return facts or {}


def wraps(options):
    """Strips side by side, one image on all: each with its extension and interpolation."""
    scene = common.empty_scene(32 * len(options["ways"]), 32)
    pixels = np.array(options["pixels"], np.float32)
    image = bpy.data.images.new("shared", pixels.shape[1], pixels.shape[0], float_buffer=True,
                                is_data=True)
    image.pixels.foreach_set(np.concatenate([pixels, 0 * pixels[..., :1] + 1], -1).ravel())
    image.update()
    for column, (extension, interpolation) in enumerate(options["ways"]):
        material, tree, node = common.metal(fresnel="NONE", detail="NONE")
        texture = common.image_node(tree, image)
        texture.extension, texture.interpolation = extension, interpolation
        tree.links.new(texture.outputs["Color"], node.inputs["Color"])
        ob = common.plane(material, 1)
        ob.location = (column + 0.5 - 0.5 * len(options["ways"]), 0, 0)
        for loop in ob.data.uv_layers[0].data:
            loop.uv = (3 * loop.uv[0] - 1, 3 * loop.uv[1] - 1)
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=len(options["ways"]))
    common.render(options["picture"])
    return {}


def minified(options):
    """A plane that shines with an image of twelve texels a pixel: through a Mapping node, then a node
    that averages do not pass."""
    scene = common.empty_scene(32, 32, samples=options["samples"])
    size, rng = 384, np.random.default_rng(3)
    image = bpy.data.images.new("noise", size, size, float_buffer=True)  # linear: Cycles mixes bytes as coded
    pixels = np.ones((size, size, 4), np.float32)
    pixels[..., :3] = rng.random((size, size, 3)) > 0.5
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    material, tree, _ = common.metal()
    texture, mapping = common.image_node(tree, image), tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0, 0, 0.5)
    mapping.inputs["Scale"].default_value = (1.5, 1, 1)
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    shader, color = tree.nodes.new("ShaderNodeEmission"), texture.outputs["Color"]
    if options["bent"]:
        node = tree.nodes.new("ShaderNodeGamma")
        node.inputs["Gamma"].default_value = 3.0
        tree.links.new(color, node.inputs["Color"])
        color = node.outputs["Color"]
    tree.links.new(color, shader.inputs["Color"])
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    common.plane(material, 1)
    common.camera(scene, type="ORTHO", ortho_scale=1)
    scene.render.engine = options["engine"]
    scene.libshade.texture_blur = options.get("blur", scene.libshade.texture_blur)
    if options["engine"] == "CYCLES":
        scene.cycles.samples, scene.cycles.use_denoising = options["samples"], False
    common.render(options["picture"])
    return {}


def graph(options):
    """Planes side by side, each shining with what one node says. A case: the node, its settings, its inputs (numbers, or
    A, B: images of one colour)."""
    cases = options["cases"]
    scene = common.empty_scene(4 * len(cases), 4, samples=1)
    images = {}
    for name, color in options["colors"].items():
        image = images[name] = bpy.data.images.new(name, 2, 2, float_buffer=True, is_data=True)
        image.pixels.foreach_set([*color, 1] * 4)
        image.update()
    for column, case in enumerate(cases):
        material, tree, showing = common.shown(by_metal=False)
        node = tree.nodes.new(case["node"])
        for key, value in case.get("set", {}).items():
            setattr(node, key, value)
        by = {socket.identifier: socket for socket in node.inputs}
        for key, value in case.get("inputs", {}).items():
            socket = node.inputs[int(key)] if key.isdigit() else by.get(key) or node.inputs[key]
            if isinstance(value, str):
                tree.links.new(common.image_node(tree, images[value]).outputs["Color"], socket)
            else:
                socket.default_value = value
        if case.get("ramp"):
            for place, color in case["ramp"]:
                node.color_ramp.elements.new(place).color = color
        _bend(node, case)
        if "own" in case:
            node.outputs[0].default_value = case["own"]
        outputs = {socket.identifier: socket for socket in node.outputs}
        output = outputs.get(case.get("output")) or node.outputs[case.get("output", 0)]
        tree.links.new(output, showing)
        ob = common.plane(material, 1)
        ob.location = (column + 0.5 - 0.5 * len(cases), 0, 0)
        for loop in ob.data.uv_layers[0].data:
            loop.uv = (0.3, 0.6)
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=len(cases))
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    scene.cycles.pixel_filter_type = "BOX"
    common.render_each(scene, options)
    return {}


def _bend(node, case):
    """"curves": the points of each; what they leave out stays a line."""
    for curve, points in zip(node.mapping.curves if "curves" in case else (), case.get("curves", ())):
        for k, point in enumerate(points):
            if k < len(curve.points):
                curve.points[k].location = point
            else:
                curve.points.new(*point)
    if "curves" in case:
        node.mapping.use_clip, node.mapping.extend = False, case.get("extend", "EXTRAPOLATED")
        node.mapping.update()


def _sheet(material, options):
    """A curved, smooth sheet in an awkward place, with all kinds of attributes and two UV maps; the
    active one is not the first."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=5, y_subdivisions=4, size=1)
    ob = common.added(material)
    mesh = ob.data
    common.smooth(mesh)
    for vertex in mesh.vertices:
        x, y, _ = vertex.co
        vertex.co.z = options.get("height", 0.1) * math.sin(4 * x + y)
    second = mesh.uv_layers.new(name="second")
    for k, loop in enumerate(mesh.loops):
        x, y, _ = mesh.vertices[loop.vertex_index].co
        second.data[k].uv = (0.4 + 0.3 * y, 0.6 - 0.5 * x + 0.2 * y)
    second.active_render = True
    for name, kind, domain, size in (("number", "FLOAT", "POINT", 1), ("vector", "FLOAT_VECTOR", "POINT", 3),
                                     ("count", "INT", "FACE", 1), ("bytes", "BYTE_COLOR", "CORNER", 4),
                                     ("floats", "FLOAT_COLOR", "POINT", 4)):
        attribute = mesh.attributes.new(name, kind, domain)
        numbers = [(0.5 + 0.5 * math.sin(0.7 * k)) for k in range(size * len(attribute.data))]
        numbers = [k % 3 for k in range(len(attribute.data))] if kind == "INT" else numbers
        attribute.data.foreach_set("value" if size == 1 else "vector" if size == 3 else "color", numbers)
    colors = mesh.color_attributes
    colors.render_color_index = list(colors.keys()).index("floats")
    for name in options.get("modifiers", ()):
        ob.modifiers.new(name, name)
    ob.color, ob.pass_index, material.pass_index = (0.2, 0.7, 0.4, 0.6), 3, 2
    ob.rotation_euler = options.get("turn", (0.3, -0.2, 0.5))
    ob.scale = options.get("scale", (0.9, 0.7, 0.8))
    return ob


def _plain_image(*color):
    image = bpy.data.images.new("plain", 1, 1, float_buffer=True, is_data=True)
    image.pixels.foreach_set([*color, 1])
    image.update()
    return image


def _bent_normal(tree, by):
    """The surface's normal and a bit of the world."""
    added, unit = (tree.nodes.new("ShaderNodeVectorMath") for _ in range(2))
    added.operation, unit.operation = "ADD", "NORMALIZE"
    added.inputs[1].default_value = by
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"], added.inputs[0])
    tree.links.new(added.outputs[0], unit.inputs[0])
    return unit.outputs[0]


def _through_group(tree, name, vector, hidden):
    """What comes out of a group that passes on its own vector, which nothing feeds."""
    group = bpy.data.node_groups.new("group", "ShaderNodeTree")
    if hasattr(group, "interface"):  # from 4.0 on
        socket = group.interface.new_socket(name, in_out="INPUT", socket_type="NodeSocketVector")
        group.interface.new_socket(name, in_out="OUTPUT", socket_type="NodeSocketVector")
    else:
        socket = group.inputs.new("NodeSocketVector", name)
        group.outputs.new("NodeSocketVector", name)
    socket.hide_value = hidden
    group.links.new(group.nodes.new("NodeGroupInput").outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.inputs[0].default_value = vector
    return node.outputs[0]


def _showing(case, engine):
    """A material of what a node says. "beside": an image has asked for the active UV map before."""
    material, tree, showing = common.shown(engine != "CYCLES", case["node"])
    node = tree.nodes.new(case["node"])
    for key, value in case.get("set", {}).items():
        setattr(node, key, value)
    by = {socket.identifier: socket for socket in node.inputs}
    for name, value in case.get("inputs", {}).items():
        if name == "Normal":
            tree.links.new(_bent_normal(tree, value), node.inputs["Normal"])
        else:
            (by.get(name) or node.inputs[name]).default_value = value
    if "own" in case:
        node.outputs[0].default_value = case["own"]
    if case["node"] in ("ShaderNodeTexImage", "ShaderNodeTexEnvironment"):
        node.image = bpy.data.images.new("spots", 5, 4, float_buffer=True, is_data=True)
        node.image.pixels.foreach_set([0.5 + 0.5 * math.sin(k * k) for k in range(80)])
        node.image.update()
    _bend(node, case)
    if "group" in case:
        tree.links.new(_through_group(tree, "Normal", *case["group"]), node.inputs["Normal"])
    for name, (by, more) in case.get("fed", {}).items():  # by generated coordinates
        place, moved = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
        moved.operation = "MULTIPLY_ADD"
        moved.inputs[1].default_value = by if isinstance(by, list) else (by,) * 3
        moved.inputs[2].default_value = more if isinstance(more, list) else (more,) * 3
        tree.links.new(place.outputs["Generated"], moved.inputs[0])
        tree.links.new(moved.outputs[0], {s.identifier: s for s in node.inputs}[name])
    if "uv_map" in case:
        where = tree.nodes.new("ShaderNodeUVMap")
        where.uv_map = case["uv_map"]
        tree.links.new(where.outputs[0], node.inputs["Vector"])
    if "Color" in node.inputs and "Strength" in node.inputs:
        image = _plain_image(0.7, 0.35, case.get("blue", 0.9))
        tree.links.new(common.image_node(tree, image).outputs["Color"], node.inputs["Color"])
        node.inputs["Strength"].default_value = case.get("strength", 1.0)
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[0].default_value = (case.get("times", 0.25),) * 3
    scaled.inputs[2].default_value = (0.5,) * 3
    if case.get("beside"):
        tree.links.new(common.image_node(tree, _plain_image(*[0.25] * 3)).outputs["Color"], scaled.inputs[0])
    tree.links.new(node.outputs[case.get("output", 0)], scaled.inputs[1])
    tree.links.new(scaled.outputs[0], showing)
    return material


def places(options):
    """Curved sheets side by side, each showing what one node says there, a quarter of it about .5."""
    cases = options["cases"]
    scene = common.empty_scene(16 * len(cases), 16, samples=1)
    for column, case in enumerate(cases):
        ob = _sheet(_showing(case, options["engine"]), case)
        if "other" in case:
            ob.data.materials.append(_showing({**case, **case["other"]}, options["engine"]))
            for k, polygon in enumerate(ob.data.polygons):
                polygon.material_index = k % 2
        ob.name = f"sheet {column}"
        ob.location = (column + 0.5 - 0.5 * len(cases), 0.1, 0.2)
    common.light(scene)
    kind = {"type": "ORTHO", "ortho_scale": len(cases)}
    if options["perspective"]:
        kind = {"angle": 2 * math.atan(0.125 * len(cases)), "shift_y": 0.1 / len(cases)}
    common.camera(scene, (0, 0, 4), **kind)
    if options["engine"] == "CYCLES":
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.filter_width = 1, False, 0.01
    common.render(options["picture"])
    return {}


def _way_color(tree, names, scale, offset):
    """Three outputs of a Light Path node as a colour."""
    path, color, scaled = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("LightPath", "CombineXYZ", "VectorMath"))
    for name, socket in zip(names, color.inputs):
        tree.links.new(path.outputs[name], socket)
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = (scale,) * 3, (offset,) * 3
    tree.links.new(color.outputs[0], scaled.inputs[0])
    return scaled.outputs[0]


def _of_shader(kind, color=None, tree_color=None, **settings):
    material = bpy.data.materials.new(kind)
    tree = common.tree_of(material)
    tree.nodes.clear()
    shader, output = (tree.nodes.new(f"ShaderNode{word}") for word in (kind, "OutputMaterial"))
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    if color:
        shader.inputs["Color"].default_value = (*color, 1)
    if tree_color:
        tree.links.new(_way_color(tree, *tree_color), shader.inputs["Color"])
    for name, value in settings.items():
        if name in shader.inputs:
            shader.inputs[name].default_value = value
        else:
            setattr(shader, name, value)
    return material


def _even_light(material):
    """Cycles finds its light by rays alone, as it is found here."""
    if bpy.app.version < (3, 5):
        material.cycles.sample_as_light = False
    else:
        material.cycles.emission_sampling = "NONE"


def ways(options):
    """By which way points are seen. Plates of several shaders in a dome that shines by what three
    outputs of a Light Path node say, or "shadow": a floor beneath two plates that light of a lamp
    passes by that, seen as it is and through a clear pane."""
    names, scale = options["outputs"], options["scale"]
    if options["shadow"]:
        scene = common.empty_scene(64, 32, samples=32)
        # diagonals of quads, along which Cycles loses rays, lie out of sight
        common.plane(_of_shader("BsdfDiffuse", (0.8,) * 3), 12).location.x = 4
        for height in (0.5, 1.25):
            plate = common.plane(_of_shader("BsdfTransparent", tree_color=(names, -scale, 1.0)), 12)
            plate.location = (4, 0, height)
            plate.visible_camera = plate.visible_transmission = False
        common.plane(_of_shader("BsdfRefraction", (1,) * 3, Roughness=0.0, IOR=1.1), 6).location = (3, 0, 3.5)
        common.light(scene, "POINT", 300.0, location=(0.1, 0.2, 3))
        common.camera(scene, type="ORTHO", ortho_scale=2, clip_start=0.2)
    else:
        plates = [("BsdfDiffuse", {}), ("BsdfGlossy", {"Roughness": 0.0}), ("BsdfGlossy", {"Roughness": 0.5}),
                  ("BsdfRefraction", {"Roughness": 0.0, "IOR": 1.3}), ("BsdfRefraction", {"Roughness": 0.5, "IOR": 1.3}),
                  ("BsdfTranslucent", {}), ("BsdfTransparent", {}), ("BsdfGlossy", {"Roughness": 0.0})]
        scene = common.empty_scene(8 * len(plates), 8, samples=options["samples"])
        for column, (kind, settings) in enumerate(plates):
            plate = common.plane(_of_shader(kind, (0.8,) * 3, **settings), 0.9)
            plate.location.x = column + 0.5 - 0.5 * len(plates)
        pane = common.plane(_of_shader("BsdfTransparent", (0.9,) * 3), 0.9)
        pane.location = (plate.location.x, 0, 0.02)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=12, segments=64, ring_count=32)
        dome = _of_shader("Emission", tree_color=(names, scale, 0.05))
        common.added(dome)
        _even_light(dome)
        common.camera(scene, type="ORTHO", ortho_scale=len(plates), clip_start=0.2)
    if options["engine"] == "CYCLES":
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising = options["samples"], False
        scene.cycles.use_adaptive_sampling, scene.cycles.blur_glossy = False, 0
    else:
        scene.libshade.blur_glossy, scene.libshade.max_bounces = 0, 12
    common.render(options["picture"])
    return {}


def heights(options):
    """A matt plate, twice as long as its UV map says, under a low sun and a Bump node or two."""
    scene = common.empty_scene(128, 128, samples=16)
    material = bpy.data.materials.new("matt")
    tree = common.tree_of(material)
    tree.nodes.clear()
    shader, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "OutputMaterial"))
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    bump = tree.nodes.new("ShaderNodeBump")
    bump.invert = options.get("invert", False)
    bump.inputs["Strength"].default_value = options.get("strength", 1.0)
    bump.inputs["Distance"].default_value = options.get("distance", 0.2)
    tree.links.new(bump.outputs[0], shader.inputs["Normal"])
    if options.get("position"):
        geometry, parts = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeSeparateXYZ")
        wave = tree.nodes.new("ShaderNodeMath")
        wave.operation = "SINE"
        tree.links.new(geometry.outputs["Position"], parts.inputs[0])
        tree.links.new(parts.outputs["X"], wave.inputs[0])
        height = wave.outputs[0]
    else:
        image = bpy.data.images.new("waves", 64, 64, float_buffer=True, is_data=True)
        at = (np.arange(64) + 0.5) / 64 * 2 * math.pi
        waves = 0.5 + 0.2 * np.sin(at)[None, :] + 0.2 * np.cos(2 * at + 1)[:, None]
        image.pixels.foreach_set(np.float32(np.stack([waves] * 3 + [waves * 0 + 1], -1).ravel()))
        image.update()
        texture = common.image_node(tree, image)
        if options.get("other"):
            where = tree.nodes.new("ShaderNodeUVMap")
            where.uv_map = "other"
            tree.links.new(where.outputs[0], texture.inputs["Vector"])
            tree.links.new(common.image_node(tree, _plain_image(*[0.8] * 3)).outputs["Color"],
                           shader.inputs["Color"])
        if options.get("mapping"):
            place, mapping = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "Mapping"))
            mapping.inputs["Scale"].default_value = (options["mapping"],) * 3
            tree.links.new(place.outputs["UV"], mapping.inputs["Vector"])
            tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
        grey = tree.nodes.new("ShaderNodeRGBToBW")
        tree.links.new(texture.outputs["Color"], grey.inputs[0])
        height = grey.outputs[0]
    tree.links.new(height, bump.inputs["Height"])
    if options.get("displaced"):
        displacement = tree.nodes.new(f"ShaderNode{options.get('by', 'Displacement')}")
        displacement.space, displacement.inputs["Scale"].default_value = options["displaced"], options.get("height", 0.15)
        tree.links.new(height, displacement.inputs[0])
        tree.links.new(displacement.outputs[0], output.inputs["Displacement"])
        if not options.get("chain"):
            tree.links.remove(bump.outputs[0].links[0])
    elif options.get("chain"):
        first = tree.nodes.new("ShaderNodeBump")
        first.inputs["Distance"].default_value = 0.05
        tree.links.new(height, first.inputs["Height"])
        tree.links.new(first.outputs[0], bump.inputs["Normal"])
    plate = common.plane(material, 2.0)
    plate.scale = (1, 2, 1.5)
    if options.get("other"):
        plate.data.uv_layers.new(name="other")  # it moves those that are there
        own, other = plate.data.uv_layers
        for loop in range(4):
            u, v = own.data[loop].uv
            other.data[loop].uv = (v + 0.2, 1.5 * u - 0.3 * v)
        own.active_render = True
    if "filter" in options and "Filter Width" in bump.inputs:
        bump.inputs["Filter Width"].default_value = options["filter"]
    common.light(scene, rotation=(0.7, 0.5, 0))
    if options.get("mirror"):  # before the eye, which looks up
        mirror = common.plane(_of_shader("BsdfGlossy", (1,) * 3, Roughness=0.0), 100)
        mirror.location, mirror.visible_shadow = (3, 0, 8), False
        common.camera(scene, rotation=(math.pi, 0, 0), angle=0.1)
        scene.libshade.max_bounces = 1
    elif options.get("perspective"):
        common.camera(scene, angle=0.4)
    else:
        common.camera(scene, type="ORTHO", ortho_scale=2.0)
    if options["engine"] == "CYCLES":
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising = 16, False
        scene.cycles.max_bounces = 1 if options.get("mirror") else 0
        scene.cycles.use_adaptive_sampling, scene.cycles.pixel_filter_type = False, "BOX"
    common.render(options["picture"])
    return {}


def grooves(options):
    """A plane of one tilted normal: an anisotropic BSDF of Cycles', or our metal that is the same."""
    scene = common.empty_scene(16, 16)
    scene.libshade.groove_transport = options["transport"]
    exponents = [2 / (0.25 * by) ** 2 - 2 for by in (0.4, 1 / 0.4)]
    material, tree, node = common.metal(distribution="ASHIKHMIN_SHIRLEY", brdf="ASHIKHMIN_SHIRLEY", fresnel="NONE",
                                        detail=options["detail"] or "ROTATE", ex=exponents[0], ey=exponents[1],
                                        horizon="VALID_REFLECTION")
    if not options["detail"]:
        tree.nodes.remove(node)
        node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
        node.distribution = "ASHIKHMIN_SHIRLEY"
        node.inputs["Roughness"].default_value, node.inputs["Anisotropy"].default_value = 0.5, 0.6
        tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    if options["axis"] or not options["detail"]:
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type, tangent.axis = "RADIAL" if options["axis"] else "UV_MAP", options["axis"] or "Z"
        tree.links.new(tangent.outputs["Tangent"], node.inputs["Tangent"])
    node.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
    tilted(tree, node, 1.0)
    common.plane(material)
    common.light(scene, rotation=(0.5, 0.4, 0))
    common.camera(scene, type="ORTHO", ortho_scale=2.0)
    common.render(options["picture"])
    return {}


def bump_of(tree, bump):
    """A colour as a normal map, or ("vector", x, y, z), or ("bumped", x, y, z): by a slope, too."""
    if bump[0] in ("vector", "bumped"):
        node = tree.nodes.new("ShaderNodeCombineXYZ")
        for socket, number in zip(node.inputs, bump[1:]):
            socket.default_value = number
        if bump[0] == "bumped":
            vector, place, part = node, tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
            node = tree.nodes.new("ShaderNodeBump")
            node.inputs["Strength"].default_value, node.inputs["Distance"].default_value = 0.8, 0.4
            tree.links.new(place.outputs["Object"], part.inputs[0])
            tree.links.new(part.outputs["X"], node.inputs["Height"])
            tree.links.new(vector.outputs[0], node.inputs["Normal"])
    else:
        node = tree.nodes.new("ShaderNodeNormalMap")
        node.inputs["Color"].default_value = (*bump, 1)
    return node.outputs[0]


def shaded(case):
    """A material of one shader: its node and inputs, or a pair of such and how they are combined."""
    material = bpy.data.materials.new(case["name"])
    tree = common.tree_of(material)
    tree.nodes.clear()
    last = None
    for shader in case["shaders"]:
        node = tree.nodes.new(shader["node"])
        for key, value in shader.get("set", {}).items():
            if hasattr(node, key):
                setattr(node, key, value)
        for key, value in shader.get("inputs", {}).items():
            if key in node.inputs:  # some have other names in another version
                node.inputs[key].default_value = value
        if shader.get("bump"):
            tree.links.new(bump_of(tree, shader["bump"]), node.inputs["Normal"])
        if shader.get("grooved"):
            tangent = tree.nodes.new("ShaderNodeTangent")
            tangent.direction_type = "RADIAL" if shader["grooved"] in "XYZ" else "UV_MAP"
            tangent.axis = shader["grooved"] if shader["grooved"] in "XYZ" else "Z"
            tree.links.new(tangent.outputs["Tangent"], node.inputs["Tangent"])
        if last:
            both = tree.nodes.new(case["by"])
            tree.links.new(last, both.inputs[len(both.inputs) - 2])
            tree.links.new(node.outputs[0], both.inputs[len(both.inputs) - 1])
            node = both
        last = node.outputs[0]
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(last, output.inputs["Surface"])
    return material


def bare(kind):
    """A material that says nothing, or not what it should."""
    if kind == "none":
        return None
    material = bpy.data.materials.new(kind)
    material.diffuse_color = (0.2, 0.5, 0.1, 1)
    if kind == "untouched":
        return material
    tree = common.tree_of(material)
    tree.nodes.clear()
    if kind == "no shader":
        tree.nodes.new("ShaderNodeOutputMaterial")
    elif kind == "image":
        node = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(node.outputs["BSDF"], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        texture = common.image_node(tree, bpy.data.images.new("gone", 1, 1))
        texture.image.source, texture.image.filepath = "FILE", "/nowhere/gone.png"
        tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    return material


def balls(options):
    """Balls in a row under an even sky and a sun; options["cases"]: their materials."""
    cases = options["cases"]
    scene = common.empty_scene(24 * len(cases), 24, samples=options["samples"])
    scene.cycles.film_exposure = options.get("exposure", 1.0)
    scene.render.film_transparent = False
    for column, case in enumerate(cases):
        material = bare(case["bare"]) if "bare" in case else shaded(case)
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.45)
        ob = common.added(material)
        ob.location = (column + 0.5 - 0.5 * len(cases), 0, 0)
        common.smooth(ob.data)
    scene.world = bpy.data.worlds.new("world")
    background = common.tree_of(scene.world).nodes["Background"].inputs
    background["Color"].default_value = (*[options.get("sky", 0.5)] * 3, 1)
    common.light(scene, rotation=(0.6, 0.3, 0), energy=1.0, size=0.3)
    if "floor" in options:  # behind the lower halves
        floor = bpy.data.materials.new("floor")
        common.tree_of(floor).nodes["Principled BSDF"].inputs["Base Color"].default_value = options["floor"]
        common.plane(floor, 2 * len(cases)).location = (0, -len(cases), -0.5)
    common.camera(scene, type="ORTHO", ortho_scale=len(cases))
    scene.libshade.groove_transport = options.get("transport", True)
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.samples, scene.cycles.blur_glossy = options["samples"], 0
    for settings in scene.cycles, scene.libshade:
        settings.pixel_filter_type = "BOX"
        settings.max_bounces, settings.sample_clamp_indirect = 12, 0
    if "passes" in options:
        common.write_multilayer(scene)
        common.ask_for(scene.view_layers[0], options["passes"], True)
        scene.world.mist_settings.start, scene.world.mist_settings.depth = 3.2, 2.0
    common.render_each(scene, options)
    return {}


def denoise_node(scene):
    """Blender 5's compositor: the Denoise node on the picture as it was and on our passes."""
    layer = scene.view_layers[0]
    layer.libshade.denoising_store_passes = True
    layer.update_render_passes()
    tree = bpy.data.node_groups.new("compositor", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    scene.compositing_node_group = tree
    picture, node, out = (tree.nodes.new(kind) for kind in (
        "CompositorNodeRLayers", "CompositorNodeDenoise", "NodeGroupOutput"))
    for name, socket in (("Image", "Image"), ("Denoising Normal", "Normal"), ("Denoising Albedo", "Albedo")):
        tree.links.new(picture.outputs[name], node.inputs[socket])
    tree.links.new(node.outputs["Image"], out.inputs[0])


def picked(options):
    """What Blender 5's Cryptomatte node picks by the name of one of two plates."""
    scene = common.empty_scene(16, 16, samples=4)
    for name, place in (("left", -0.5), ("right", 0.5)):
        ob = common.plane(common.metal(name)[0], 1.0)
        ob.name, ob.location = name, (place, 0, 0)
    common.camera(scene, (0, 0, 3), type="ORTHO", ortho_scale=2)
    common.light(scene)
    common.ask_for(scene.view_layers[0], ["cryptomatte_object"])
    scene.view_layers[0].update_render_passes()
    tree = bpy.data.node_groups.new("compositor", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    scene.compositing_node_group = tree
    node, out = tree.nodes.new("CompositorNodeCryptomatteV2"), tree.nodes.new("NodeGroupOutput")
    node.scene, node.layer_name, node.matte_id = scene, "ViewLayer.CryptoObject", options["who"]
    tree.links.new(node.outputs["Matte"], out.inputs[0])
    common.render(options["picture"])
    return {}


def first_minute(options):
    """A new file: cube, lamp, grey world; here on a floor, beside a ball of gold."""
    bpy.ops.wm.read_factory_settings()
    common.enable()
    scene = bpy.context.scene
    scene.render.engine = options["engine"]
    scene.render.resolution_x, scene.render.resolution_y = 240, 136
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    settings = scene.cycles if options["engine"] == "CYCLES" else scene.libshade
    settings.samples = options["samples"]
    if options["engine"] == "CYCLES":
        settings.use_adaptive_sampling = False
    settings.use_denoising = options.get("denoise", False)
    if options.get("compositor"):
        denoise_node(scene)
    if options.get("multilayer"):
        common.write_multilayer(scene)
    if options["floor"]:
        for name, color, metallic in (("floor", (0.6, 0.25, 0.15, 1), 0), ("gold", (1, 0.77, 0.34, 1), 1)):
            if name == "floor":
                bpy.ops.mesh.primitive_plane_add(size=12, location=(0, 0, -1))
            else:
                bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(2.2, 1.2, 0))
                bpy.ops.object.shade_smooth()
            material = bpy.data.materials.new(name)
            inputs = common.tree_of(material).nodes["Principled BSDF"].inputs
            inputs["Base Color"].default_value, inputs["Metallic"].default_value = color, metallic
            inputs["Roughness"].default_value = 0.4
            bpy.context.object.data.materials.append(material)
        world = scene.world.node_tree.nodes["Background"].inputs
        world["Color"].default_value = (0.3, 0.4, 0.6, 1)
    common.render(options["picture"])
    return {}


def lit(options):
    """A floor, a matt ball and a metal one under one light, or under a world."""
    scene = common.empty_scene(48, 32)
    scene.render.film_transparent = False
    both = scene.cycles, scene.libshade
    for settings in both:
        settings.samples, settings.max_bounces = options["samples"], 12
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.blur_glossy = scene.cycles.light_sampling_threshold = 0
    scene.libshade.filter_width = 0
    for kind, color, rough, place in (("Diffuse", (0.6, 0.5, 0.4, 1), 0, None),
                                      ("Diffuse", (0.3, 0.6, 0.3, 1), 0, (1, -0.3, 0.5)),
                                      ("Glossy", (0.8, 0.7, 0.5, 1), 0.5, (-0.6, 0.2, 0.6))):
        material = bpy.data.materials.new(kind)
        tree = common.tree_of(material)
        shader = tree.nodes.new("ShaderNodeBsdf" + kind)
        shader.inputs["Color"].default_value, shader.inputs["Roughness"].default_value = color, rough
        if kind == "Glossy":
            shader.distribution = "GGX"
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        if place:
            bpy.ops.mesh.primitive_uv_sphere_add(radius=place[2], location=place, segments=48, ring_count=24)
            common.smooth(common.added(material).data)
        else:
            common.plane(material, 8)
    if options["light"] == "MESH":
        material = bpy.data.materials.new("lamp")
        tree = common.tree_of(material)
        shader = tree.nodes.new("ShaderNodeEmission")
        shader.inputs["Color"].default_value = (1, 0.8, 0.5, 1)
        shader.inputs["Strength"].default_value = options["settings"]["strength"]
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.3, location=(1, -1, 2))
        common.added(material).scale = (1, 1.5, 0.7)
    elif options["light"]:
        light = common.light(scene, options["light"], location=(1, -1, 2), rotation=(0.5, 0.4, 0.2))
        light.scale = options.get("scale", (1, 1, 1))
        for name, value in options["settings"].items():
            setattr(light.data, name, value)
        if "pattern" in options:
            pattern(light.data, **options["pattern"])
    else:
        sky(scene, options["image"], options.get("mapping"))
        if "by camera" in options:
            by_camera(scene, options["by camera"])
        if "by way" in options:
            by_way(scene, options["by way"])
    if "no sky" in options:
        sky(scene, None, None)
        bpy.context.view_layer.use_sky = False
    common.camera(scene, (0, -5, 3), (1.08, 0, 0))
    hide(scene, options.get("hidden", {}))
    for settings in both:
        for name, value in options.get("given", {}).items():
            setattr(settings, name, value)
    if "roughness" in options:
        scene.objects["Sphere.001"].scale = (3, 3, 3)  # a large part of what is seen
        scene.objects["Sphere.001"].data.materials[0].node_tree.nodes["Glossy BSDF"].inputs[
            "Roughness"].default_value = options["roughness"]
    if "panes" in options:
        panes(options["panes"], options.get("full"))
        for settings in both:
            settings.transparent_max_bounces, settings.sample_clamp_indirect = options.get("passes", 8), 0
    if options.get("empty"):
        for ob in [ob for ob in scene.objects if ob.type == "MESH"]:
            bpy.data.objects.remove(ob)
    common.render_each(scene, options)
    return {}


def pattern(light, profile=None, by=None, falls=None):
    """A lamp shines by a photometric file's text, or by a vector that nodes know; or falls off by an output of Light
    Falloff, smoothed."""
    light.use_nodes = True
    tree = light.node_tree
    shader = tree.nodes.get("Emission")
    if profile:
        source = tree.nodes.new("ShaderNodeTexIES")
        source.ies = bpy.data.texts.new("profile")
        source.ies.write(profile)
        tree.links.new(source.outputs[0], shader.inputs["Strength"])
        return
    if falls:
        source, twice = tree.nodes.new("ShaderNodeLightFalloff"), tree.nodes.new("ShaderNodeMath")
        source.inputs["Strength"].default_value, source.inputs["Smooth"].default_value = 0.3, falls[1]
        twice.operation, twice.inputs[1].default_value = "MULTIPLY", 2.0
        tree.links.new(source.outputs[falls[0]], twice.inputs[0])
        tree.links.new(twice.outputs[0], shader.inputs["Strength"])
        return
    node, output = by.split(".")
    source, turned = tree.nodes.new("ShaderNode" + node), tree.nodes.new("ShaderNodeVectorMath")
    turned.operation = "MULTIPLY_ADD"
    turned.inputs[1].default_value = (0.4 if output in ("Normal", "Incoming", "Parametric", "UV") else 0.1,) * 3  # light above 0
    turned.inputs[2].default_value = (0.5,) * 3
    tree.links.new(source.outputs[output], turned.inputs[0])
    tree.links.new(turned.outputs[0], shader.inputs["Color"])


def profiles(options):
    """Photometric files side by side, each in a square of pixels of one direction each: its angle about z goes across, that
    from straight down goes up."""
    across, up, count = *options["lattice"], len(options["profiles"])
    scene = common.empty_scene(across, up * count, samples=1)
    scene.render.engine = options["engine"]
    settings = scene.cycles if options["engine"] == "CYCLES" else scene.libshade
    settings.samples, settings.filter_width = 1, 0.01
    if options["engine"] == "CYCLES":
        settings.use_denoising = settings.use_adaptive_sampling = False
    down = (np.arange(up) + 0.37) / up * np.pi
    about = (np.arange(across) + 0.43) / across * 2 * np.pi
    ways = np.ones((up, across, 4), np.float32)
    ways[..., 0], ways[..., 1] = np.outer(np.sin(down), np.sin(about)), np.outer(np.sin(down), np.cos(about))
    ways[..., 2] = -np.cos(down)[:, None]
    image = bpy.data.images.new("ways", across, up, float_buffer=True, is_data=True)
    image.pixels.foreach_set(ways.ravel())
    image.pack()
    for k, text in enumerate(options["profiles"]):
        material = bpy.data.materials.new("profile")
        tree = common.tree_of(material)
        tree.nodes.clear()
        output, shader, source = (tree.nodes.new("ShaderNode" + kind) for kind in ("OutputMaterial", "Emission", "TexIES"))
        place = common.image_node(tree, image)
        place.interpolation = "Closest"
        source.ies = bpy.data.texts.new("profile")
        source.ies.write(text)
        tree.links.new(place.outputs["Color"], source.inputs["Vector"])
        tree.links.new(source.outputs[0], shader.inputs["Color"])
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        ob = common.plane(material, 1.0)
        ob.location, ob.scale = (0, k - (count - 1) / 2, 0), (across / up, 1, 1)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=max(count, across / up))
    common.render(options["picture"])
    return {}


def hide(scene, hidden):
    """Kinds of ray that do not see the lamp, the metal ball ("Sphere.001") or the world."""
    for name, kinds in hidden.items():
        things = [ob for ob in scene.objects if ob.type == "LIGHT" or ob.name.startswith("Ico")]
        if name == "ball":
            things = [ob for ob in scene.objects if ob.name == "Sphere.001"]
        for kind in kinds:
            if kind == "indirect only":
                apart = bpy.data.collections.new("apart")
                scene.collection.children.link(apart)
                apart.objects.link(things[0])
                scene.collection.objects.unlink(things[0])
                bpy.context.view_layer.layer_collection.children["apart"].indirect_only = True
            elif name == "world":
                setattr(scene.world.cycles_visibility, kind, False)
            else:
                setattr(things[0], f"visible_{kind}", False)


def holes(options):
    """A row of plates before a matt wall, and what leaves holes: an object, a collection, shaders, alpha."""
    scene = common.empty_scene(96, 24, samples=options["samples"])
    scene.render.film_transparent = options["transparent"]
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world).nodes["Background"].inputs["Color"].default_value = (0.3, 0.4, 0.5, 1)
    common.plane(_matt("wall", 0.7, 0.2, 0.2), 3).location = (-2, 0, -1)
    common.light(scene, rotation=(0.6, 0.3, 0), energy=2.0, size=0.1)
    collection = bpy.data.collections.new("held")
    scene.collection.children.link(collection)
    for column, kind in enumerate(("object", "collection", "shader", "half", "alpha", "mirror")):
        material = bpy.data.materials.new(kind)
        tree = common.tree_of(material)
        tree.nodes.clear()
        mix, out = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeOutputMaterial")
        mix.inputs[0].default_value = {"half": 0.5, "alpha": 0.3}.get(kind, 1.0 if kind == "shader" else 0.0)
        body = tree.nodes.new("ShaderNodeBsdfGlossy" if kind == "mirror" else "ShaderNodeBsdfDiffuse")
        body.inputs[0].default_value = (0.2, 0.6, 0.3, 1)
        tree.links.new(body.outputs[0], mix.inputs[1])
        other = tree.nodes.new("ShaderNodeBsdfTransparent" if kind == "alpha" else "ShaderNodeHoldout")
        tree.links.new(other.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], out.inputs["Surface"])
        ob = common.plane(material, 0.8)
        ob.location = (column - 2.5, 0, 0)
        ob.is_holdout = kind in ("object", "alpha", "mirror")
        if kind == "collection":
            scene.collection.objects.unlink(ob)
            collection.objects.link(ob)
    bpy.context.view_layer.layer_collection.children["held"].holdout = True
    if options.get("clear"):  # a pane of glass before the upper half
        scene.cycles.film_transparent_glass, scene.cycles.film_transparent_roughness = True, 0.3
        glass = common.plane(_rough_glass("pane", 0.2), 8)
        glass.location, glass.rotation_euler = (0, 4, 1), (0.1, 0, 0)
    mirror = common.plane(_glossy("floor"), 8)  # sees them all as they are
    mirror.location, mirror.rotation_euler = (0, -0.5, 0), (-1.2, 0, 0)
    common.camera(scene, type="ORTHO", ortho_scale=6)
    if options["engine"] == "CYCLES":
        _in_cycles(scene, options["samples"])
    for settings in scene.cycles, scene.libshade:
        settings.max_bounces = 4
    common.render(options["picture"])
    return {}


def _glossy(name):
    material = _matt(name, 0, 0, 0)
    tree = material.node_tree
    shader = tree.nodes.new("ShaderNodeBsdfGlossy")
    shader.inputs["Color"].default_value, shader.inputs["Roughness"].default_value = (0.8, 0.8, 0.8, 1), 0.2
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return material


def _rough_glass(name, roughness):
    material = _matt(name, 0, 0, 0)
    tree = material.node_tree
    shader = tree.nodes.new("ShaderNodeBsdfGlass")
    shader.inputs["Color"].default_value, shader.inputs["Roughness"].default_value = (0.9, 0.8, 1, 1), roughness
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return material


def hairy(options):
    """Thin things over a floor: hair of particles, curves, points, each alone."""
    scene = common.empty_scene(64, 48, samples=options["samples"])
    scene.render.film_transparent = False
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world).nodes["Background"].inputs["Color"].default_value = (0.4, 0.4, 0.4, 1)
    common.plane(_matt("floor", 0.5, 0.5, 0.5), 12)
    common.light(scene, rotation=(0.7, 0.3, 0), energy=2.0, size=0.2)
    scene.cycles_curves.shape = "THICK"  # ribbons show nothing to who looks along them
    globals()[f"_{options['what']}"](scene)
    if options.get("told"):
        tree = common.tree_of(bpy.data.materials["hair"])
        shader, info = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "HairInfo"))
        shader.inputs["Strength"].default_value = 20.0 if options["told"] == "Thickness" else 2.0
        tree.links.new(info.outputs[options["told"]], shader.inputs["Color"])
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    if options.get("strokes"):
        tree = common.tree_of(bpy.data.materials["hair"])
        shader = tree.nodes.new("ShaderNodeBsdfAnisotropic")
        shader.distribution = "GGX"
        shader.inputs["Color"].default_value = (0.8, 0.4, 0.1, 1)
        shader.inputs["Roughness"].default_value, shader.inputs["Anisotropy"].default_value = 0.5, 0.8
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    if options["what"] == "curves" and options.get("broken"):
        data = scene.objects["curves"].data
        data.points.foreach_set("position", np.tile(np.float32([np.nan, 1e30, 0, 0, 0, 1]), 90))
        data.attributes["radius"].data.foreach_set("value", np.tile(np.float32([np.nan, -1, np.inf, 0.1]), 45))
        common.link(scene, "flat", data).scale = (0, 1, 1)
        common.link(scene, "nothing", bpy.data.hair_curves.new("nothing"))
    common.camera(scene, (0, -6, 2.4), (1.2, 0, 0))
    if options["engine"] == "CYCLES":
        _in_cycles(scene, options["samples"])
    for settings in scene.cycles, scene.libshade:
        settings.max_bounces = 4
    scene.libshade.soft_terminator = True
    common.render(options["picture"])
    return {}


def _hair(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8, location=(0, 0, 1), scale=(0.8, 0.8, 0.8))
    ball = common.added(_matt("ball", 0.1, 0.1, 0.4))
    ball.data.materials.append(_matt("hair", 0.8, 0.4, 0.1))
    ball.modifiers.new("hair", "PARTICLE_SYSTEM")
    settings = ball.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length, settings.hair_step = "HAIR", 60, 0.7, 4
    settings.root_radius, settings.tip_radius, settings.radius_scale, settings.shape = 1.0, 0.3, 0.12, -0.3
    settings.material = 2
    settings.emit_from, settings.use_emit_random, settings.use_modifier_stack = "VERT", False, False


def _curves(scene):
    data = bpy.data.hair_curves.new("curves")  # from 3.5 on
    data.add_curves([6] * 30)
    rng = np.random.default_rng(3)
    steps = rng.normal(0, 0.15, (30, 6, 3)) + (0, 0, 0.25)
    points = np.cumsum(steps, 1) + np.stack([rng.uniform(-1.8, 1.8, 30), rng.uniform(-1, 1, 30), 0 * steps[:, 0, 0]], -1)[:, None]
    data.points.foreach_set("position", points.astype(np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.tile(np.linspace(0.05, 0.02, 6), 30).astype(np.float32))
    data.materials.append(_matt("hair", 0.8, 0.4, 0.1))
    common.link(scene, "curves", data).scale = (1, 1, 1.2)


def _points(scene):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=10, ring_count=6, location=(0, 0, 1))
    ball = common.added(None)
    tree = bpy.data.node_groups.new("points", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    start, end, points, shade = (tree.nodes.new(kind) for kind in (
        "NodeGroupInput", "NodeGroupOutput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial"))
    points.inputs["Radius"].default_value = 0.13
    shade.inputs["Material"].default_value = _matt("points", 0.8, 0.4, 0.1)
    for source, target in ((start.outputs[0], points.inputs[0]), (points.outputs[0], shade.inputs[0]), (shade.outputs[0], end.inputs[0])):
        tree.links.new(source, target)
    ball.modifiers.new("points", "NODES").node_group = tree
    ball.scale = (1.3, 1, 0.8)


def linked(options):
    """Three balls and a floor; a lamp for the first ball, one for all but the second, and one for all. Or, if
    `shades`, that are shaded by these. `shines`: plates that shine instead of the first two, and the third ball
    is polished."""
    scene = common.empty_scene(64, 24, samples=options["samples"])
    scene.render.film_transparent = False
    common.plane(_matt("floor", 0.5, 0.5, 0.5), 12)
    balls = []
    for x in (-1.6, 0, 1.6):
        bpy.ops.mesh.primitive_uv_sphere_add(location=(x, 0, 0.7), radius=0.7)
        balls.append(common.added(_matt("ball", 0.6, 0.6, 0.6)))
        common.smooth(balls[-1].data)
    if options.get("shines"):
        balls[-1].data.materials[0] = _plain("polished", "BsdfAnisotropic", (0.8, 0.8, 0.8), Roughness=0.3)
    for color, place, ball, state in (((1, 0.1, 0.1), (-3, -2, 3), balls[0], "INCLUDE"),
                                      ((0.1, 1, 0.1), (3, -2, 3), balls[1], "EXCLUDE"), ((0.1, 0.1, 1), (0, -3, 3), None, "")):
        if ball and options.get("shines"):
            lamp = common.plane(_plain("plate", "Emission", color, Strength=20.0))
            lamp.location, lamp.rotation_euler = place, (0, 0.6 if place[0] < 0 else -0.6, 0)
            if options["shines"] == "unevenly":
                tree = common.tree_of(lamp.data.materials[0])
                shader = next(n for n in tree.nodes if n.type == "EMISSION")
                tree.links.new(tree.nodes.new("ShaderNodeTexChecker").outputs["Fac"], shader.inputs["Strength"])
        else:
            lamp = common.light(scene, "POINT", 200, options["radius"], location=place)
            lamp.data.color = color
        if ball:
            collection = bpy.data.collections.new("some")
            collection.objects.link(ball)
            collection.collection_objects[0].light_linking.link_state = state
            setattr(lamp.light_linking, "blocker_collection" if options.get("shades") else "receiver_collection",
                    collection)
    for k in range(options["more"]):  # so many that each sample takes one of them
        common.light(scene, "POINT", 5, location=(k, 2, 2))
    common.camera(scene, (0, -6, 2), (1.25, 0, 0), lens=40)
    if options["engine"] == "CYCLES":
        _in_cycles(scene, options["samples"])
    for settings in scene.cycles, scene.libshade:
        settings.max_bounces = 3
    common.render(options["picture"])
    return {}


def occluded(options):
    """A floor and a wall with a ball and a cube; all shine with what an Ambient Occlusion or a Bevel node says."""
    scene = common.empty_scene(64, 48, samples=options["samples"])
    scene.world = bpy.data.worlds.new("world")
    scene.world.light_settings.distance = 0.8
    material = bpy.data.materials.new("open")
    tree = common.tree_of(material)
    kind = "Bevel" if "radius" in options else "AmbientOcclusion"
    node, shines = tree.nodes.new(f"ShaderNode{kind}"), tree.nodes.new("ShaderNodeEmission")
    node.samples, said = options["rays"], node.outputs[0]
    if kind == "Bevel":
        node.inputs["Radius"].default_value = options["radius"]
        moved = tree.nodes.new("ShaderNodeVectorMath")
        moved.operation, moved.inputs[1].default_value, moved.inputs[2].default_value = "MULTIPLY_ADD", [0.5] * 3, [0.5] * 3
        tree.links.new(said, moved.inputs[0])
        said = moved.outputs[0]
    else:
        node.inside, node.only_local = (options.get(name, False) for name in ("inside", "only_local"))
        node.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1)
        node.inputs["Distance"].default_value = options.get("distance", 1.0)
    if "normal" in options:
        given = tree.nodes.new("ShaderNodeCombineXYZ")
        for socket, part in zip(given.inputs, options["normal"]):
            socket.default_value = part
        tree.links.new(given.outputs[0], node.inputs["Normal"])
    tree.links.new(said, shines.inputs["Color"])
    tree.links.new(shines.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    common.plane(material, 3)
    wall = common.plane(material, 3)
    wall.location, wall.rotation_euler = (0, 1, 0), (1.57, 0, 0)
    bpy.ops.mesh.primitive_uv_sphere_add(location=(-0.7, 0, 0.65), radius=0.6, segments=64, ring_count=32)
    common.smooth(common.added(material).data)
    if kind == "Bevel":
        bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0.8, 0, 0.7), rotation=(0.5, 0.4, 0.6))
    else:
        bpy.ops.mesh.primitive_torus_add(location=(0.8, 0, 0.5), rotation=(0.9, 0.3, 0), major_radius=0.45, minor_radius=0.2)
    common.added(material).scale = (1, 1.3, 1)
    common.camera(scene, (0, -6, 2.4), (1.2, 0, 0), lens=60)
    if options["engine"] == "CYCLES":
        _in_cycles(scene, options["samples"])
    for settings in scene.cycles, scene.libshade:
        settings.max_bounces = 0
    common.render(options["picture"])
    return {}


def caught(options):
    """A ball and a cube on a floor that catches their shadows, beside a wall that does, too."""
    scene = common.empty_scene(64, 48, samples=options["samples"])
    scene.render.film_transparent = options["transparent"]
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world).nodes["Background"].inputs["Color"].default_value = (0.3, 0.4, 0.5, 1)
    floor = common.plane(_matt("floor", 0.5, 0.4, 0.3), 3)
    floor.is_shadow_catcher = True
    wall = common.plane(_matt("wall", 0.5, 0.5, 0.5), 3)
    wall.location, wall.rotation_euler, wall.is_shadow_catcher = (0, 1.5, 1), (1.57, 0, 0), True
    bpy.ops.mesh.primitive_uv_sphere_add(location=(-0.6, 0, 0.6), radius=0.6)
    common.smooth(common.added(_matt("ball", 0.8, 0.3, 0.1)).data)
    bpy.ops.mesh.primitive_cube_add(size=0.7, location=(0.8, -0.2, 0.35))
    common.added(_matt("cube", 0.2, 0.6, 0.2))
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.2, location=(0.2, -0.9, 0.25))
    glow = bpy.data.materials.new("glow")  # whose light makes no catcher brighter than what is behind it
    shader = common.tree_of(glow).nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value, shader.inputs["Strength"].default_value = (1, 0.6, 0.3, 1), 3
    glow.node_tree.links.new(shader.outputs[0], glow.node_tree.get_output_node("ALL").inputs["Surface"])
    common.added(glow)
    common.light(scene, rotation=(0.7, 0.4, 0), energy=2.0, size=0.2)
    common.camera(scene, (0, -6, 2.4), (1.2, 0, 0))
    if options["engine"] == "CYCLES":
        _in_cycles(scene, options["samples"])
    for settings in scene.cycles, scene.libshade:
        settings.max_bounces = 4
    common.write_multilayer(scene)
    for settings in scene.view_layers[0].cycles, scene.view_layers[0].libshade:
        settings.use_pass_shadow_catcher = options["apart"]
    common.render(options["picture"])
    return {}


def panes(kinds, full=False):
    """Sheets between the floor and the light, one above the other, some before the eye as well. full: the first, which is
    clear, stops shadow rays."""
    for number, kind in enumerate(kinds):
        material = bpy.data.materials.new(kind)
        tree = common.tree_of(material)
        if kind == "glass paper":
            tree.nodes.remove(tree.nodes["Principled BSDF"])
            shader = tree.nodes.new("ShaderNodeBsdfTransparent")
            shader.inputs["Color"].default_value = (0.9, 0.6, 0.2, 1)
            tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
            setattr(material if hasattr(material, "use_transparent_shadow") else material.cycles, "use_transparent_shadow", not full)
        else:
            shader = tree.nodes["Principled BSDF"]
            shader.inputs["Base Color"].default_value = (0.2, 0.5, 0.7, 1)
            shader.inputs["Roughness"].default_value, shader.inputs["Alpha"].default_value = 1, 0.5
            if "Specular" in shader.inputs:  # until 3.6, whose lobe is not quite the same here
                shader.inputs["Specular"].default_value = 0
        if kind == "holes":
            image = bpy.data.images.new("holes", 4, 4, float_buffer=True, is_data=True)
            alphas = np.indices((4, 4)).sum(0) % 2
            image.pixels.foreach_set(np.float32(np.stack([alphas * 0.8] * 4, -1).ravel()))
            image.update()
            texture = common.image_node(tree, image)
            texture.interpolation = "Closest"
            tree.links.new(texture.outputs["Color"], shader.inputs["Alpha"])
        sheet = common.plane(material, 2.5)
        sheet.location = (-0.3 + 0.3 * number, 0.2 - 0.4 * number, 1.2 + 0.2 * number)


def by_camera(scene, way):
    """Rays of the camera see another colour: two shaders, two colours, or two strengths; or the same image darker."""
    tree = common.tree_of(scene.world)
    path, lit = tree.nodes.new("ShaderNodeLightPath"), tree.nodes["Background"]
    camera = path.outputs["Is Camera Ray"]
    if way == "dimmed":
        dim = tree.nodes.new("ShaderNodeMath")
        dim.operation, dim.inputs[1].default_value, dim.inputs[2].default_value = "MULTIPLY_ADD", -1.2, 1.5
        tree.links.new(camera, dim.inputs[0])
        tree.links.new(dim.outputs[0], lit.inputs["Strength"])
        return
    if way == "shaders":
        mixed, other = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBackground")
        other.inputs["Color"].default_value = (0.1, 0.4, 0.2, 1)
        turned = tree.nodes.new("ShaderNodeMath")
        turned.operation, turned.inputs[0].default_value = "SUBTRACT", 1.0
        for output, socket in ((camera, turned.inputs[1]), (turned.outputs[0], mixed.inputs[0]),
                               (other.outputs[0], mixed.inputs[1]), (lit.outputs[0], mixed.inputs[2]),
                               (mixed.outputs[0], tree.get_output_node("ALL").inputs["Surface"])):
            tree.links.new(output, socket)
        return
    mixed = tree.nodes.new("ShaderNodeMixRGB" if way == "colors" else "ShaderNodeMix")
    mixed.inputs[2].default_value = (0.1, 0.4, 0.2, 1) if way == "colors" else 3.0
    one, other, socket = ((mixed.inputs[1], mixed.inputs[2], lit.inputs["Color"]) if way == "colors" else
                          (mixed.inputs[2], mixed.inputs[3], lit.inputs["Strength"]))
    if way == "colors" and socket.is_linked:
        tree.links.new(socket.links[0].from_socket, one)
    else:
        one.default_value, other.default_value = (0.4, 0.3, 0.2, 1) if way == "colors" else 1.5, other.default_value
    tree.links.new(camera, mixed.inputs[0])
    tree.links.new(mixed.outputs[0], socket)


def by_way(scene, way):
    """Rays that came that way see another colour."""
    tree = common.tree_of(scene.world)
    path, lit = tree.nodes.new("ShaderNodeLightPath"), tree.nodes["Background"]
    mixed, other = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBackground")
    other.inputs["Color"].default_value = (0.9, 0.3, 0.1, 1)
    for output, socket in ((path.outputs[way], mixed.inputs[0]), (lit.outputs[0], mixed.inputs[1]), (other.outputs[0], mixed.inputs[2]),
                           (mixed.outputs[0], tree.get_output_node("ALL").inputs["Surface"])):
        tree.links.new(output, socket)


def sky(scene, image, mapping):
    """A world of one colour, or of an image with two lamps in it."""
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    background = tree.nodes["Background"].inputs
    background["Color"].default_value, background["Strength"].default_value = (0.3, 0.5, 0.8, 1), 1.5
    if not image:
        return
    pixels = np.full((16, 32, 4), (0.2, 0.3, 0.5, 1), np.float32)
    pixels[10:12, 5:7] = (30, 20, 10, 1)
    pixels[13, 25] = (5, 20, 60, 1)
    picture = bpy.data.images.new("sky", 32, 16, float_buffer=True, is_data=True)
    picture.pixels.foreach_set(pixels.ravel())
    picture.update()
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image, texture.projection = picture, image
    tree.links.new(texture.outputs["Color"], background["Color"])
    if mapping:
        node = tree.nodes.new("ShaderNodeMapping")
        node.vector_type = mapping["type"]
        for name in ("Location", "Rotation", "Scale"):
            if name in mapping:
                node.inputs[name].default_value = mapping[name]
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinates.outputs["Generated"], node.inputs["Vector"])
        tree.links.new(node.outputs["Vector"], texture.inputs["Vector"])


def cubes(options):
    """Cubes with the normals of balls, one without a material, one matt, under a sun."""
    scene = common.empty_scene(64, 32, samples=64)
    matt = shaded({"name": "matt", "shaders": [{"node": "ShaderNodeBsdfDiffuse"}]})
    for x, material in ((-1.5, None), (1.5, matt)):
        bpy.ops.mesh.primitive_cube_add(location=(x, 0, 0), rotation=(0.2, 0.1, 0.4))
        common.smooth(common.added(material).data)
    common.light(scene, rotation=(0.6, 0.3, 0.2), size=0.02)
    common.camera(scene, (0, -9, 4), (1.15, 0, 0), lens=45)
    scene.render.engine = options["engine"]
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    scene.cycles.use_adaptive_sampling, scene.cycles.pixel_filter_type = False, "BOX"
    scene.libshade.max_bounces = scene.cycles.max_bounces = 0
    scene.libshade.soft_terminator = True
    common.render(options["picture"])
    return {}


def edges(options):
    """A turned plane, whose edges show the sampling pattern."""
    scene = common.empty_scene(24, 24, options.get("samples", 4))
    scene.libshade.seed = options.get("seed", 0)
    if "filter" in options:
        scene.cycles.samples, scene.cycles.use_denoising = options["samples"], False
        scene.cycles.use_adaptive_sampling = False
        scene.render.engine = options["engine"]
        for settings in scene.libshade, scene.cycles:
            settings.pixel_filter_type, settings.filter_width = options["filter"]
    common.plane(common.metal()[0], 1.2).rotation_euler = (0, 0, 0.3)
    common.light(scene)
    common.camera(scene, type="ORTHO", ortho_scale=2.0)
    common.render(options["picture"])
    return {}


def penumbra(options):
    """A floor under half a roof at height 1, seen from below the roof."""
    scene = common.empty_scene(32, 4, samples=256)
    material, _, node = common.metal(ex=0, ey=0, fresnel="NONE", detail="NONE")
    common.plane(material, 18)
    common.plane(material, 18).location = (-9, 0, 1)
    if options["kind"] == "SUN":
        light = common.light(scene, "SUN", 1, size=options["size"])
    else:
        light = common.light(scene, "POINT", 100, size=options["size"], location=(0, 0, 4))
    common.cast_shadow(light.data, options["shadow"])
    common.camera(scene, (0, 0, 0.5), type="ORTHO", ortho_scale=1.0)
    common.render(options["picture"])
    return {}


def viewport(options):
    """What Rendered mode hands over to be drawn, without a window: alpha of small planes, each
    [x on the screen from -1 to 1, distance before the viewpoint]."""
    scene = common.empty_scene()
    perspective, side = options["perspective"], 256
    for x, distance in options["planes"]:
        half = abs(distance) if perspective else 1  # of the view, there
        common.plane(common.metal()[0], 0.1 * half).location = (x * half, 0, -distance)
    common.light(scene)
    view = windowless.View(side, side)
    start, end = options["clip"]
    window = Matrix.Diagonal((1, 1, -1 / end, 1))
    if perspective:
        window[2][2], window[2][3] = (start + end) / (start - end), 2 * start * end / (start - end)
        window[3][2], window[3][3] = -1, 0
    view.space.clip_start, view.space.clip_end = start, end
    pixels, said = view.picture(Matrix.Identity(4), window, perspective, bpy.context.evaluated_depsgraph_get())
    alpha = pixels[side // 2, :, 3]
    return {"said": said, "alpha": [float(alpha[int((x + 1) / 2 * side)])
                                    for x, _ in options["planes"]]}


def passes(options):
    """A tilted plate, two metres before the camera, in one view layer and not in the other."""
    scene = common.empty_scene(16, 16, samples=8)
    common.write_multilayer(scene)
    common.camera(scene, (0, 0, 3), type="ORTHO", ortho_scale=2)
    common.light(scene)
    plate = common.plane(common.metal()[0], 1.0)
    plate.rotation_euler, plate.location = (0.0, 0.5, 0.0), (0.0, 0.0, 1.0)  # x: -cos to cos
    plate.pass_index, plate.data.materials[0].pass_index = 7, 3
    collection = bpy.data.collections.new("plate")
    scene.collection.children.link(collection)
    scene.collection.objects.unlink(plate)
    collection.objects.link(plate)
    common.plane(common.metal("aside")[0]).location = (10, 10, 0)
    full, empty = scene.view_layers[0], scene.view_layers.new("Empty")
    empty.layer_collection.children["plate"].exclude = True
    for layer in (full, empty):
        common.ask_for(layer, options["passes"])
    common.render(options["picture"])
    return {"layers": [full.name, empty.name]}


def unrendered(options):
    """What is said of a mesh that cannot be rendered."""
    try:
        return mesh(options)
    except RuntimeError as error:
        return {"error": str(error)}


def script(options):
    """Another script of this folder, in this process, which is as when Blender starts."""
    bpy.ops.wm.read_factory_settings()
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), options["script"])
    sys.argv = [path, "--", *options["arguments"]]
    with open(path, encoding="utf-8") as file:
        code = compile(file.read(), path, "exec")
    try:
        exec(code, {"__name__": "__main__", "__file__": path})
    except common.Finished:
        return {}
    raise RuntimeError(f"{path} ended before its end")


common.goes_on = True
for line in sys.stdin:
    request = json.loads(line)
    os.environ["LIBSHADE_DUMP"] = request["dump"]
    facts = globals()[request["name"]](request["options"])
    print("TOLD", json.dumps(facts), flush=True)
common.goes_on = False
common.finish()
