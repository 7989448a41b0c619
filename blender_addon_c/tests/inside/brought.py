# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of others are full of: each scene by both engines, all of it shining, without noise."""

import os

import bmesh
import bpy
import numpy as np
from mathutils import Vector

import common


def brought(options):
    """Plates that shine with what a case says, seen from above. Returns what Blender made of the case."""
    scene = common.empty_scene(64, 64, samples=64)
    told = _CASES[options["what"]](scene, options)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=4)
    if options["engine"] == "CYCLES":
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 64, False, "BOX"
    else:
        scene.libshade.pixel_filter_type, scene.libshade.texture_blur = "BOX", 0.0
    common.render(options["picture"])
    return told or {}


def _shining(name):
    """A material's tree and the socket of what it shines with."""
    material = bpy.data.materials.new(name)
    tree = common.tree_of(material)
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return material, tree, shader.inputs["Color"]


def _plate(material, number, size=1.0):
    plate = common.plane(material, size)
    plate.location = (-1.5 + number % 4, 1.5 - number // 4, 0)
    return plate


def _divide(mesh, cuts):
    work = bmesh.new()
    work.from_mesh(mesh)
    bmesh.ops.subdivide_edges(work, edges=work.edges, cuts=cuts, use_grid_fill=True)
    work.to_mesh(mesh)
    work.free()


def _alpha(scene, options):
    """Images of each alpha mode, their alpha linked in the second row."""
    for number in range(8):
        image = bpy.data.images.new(f"image {number}", 8, 8, alpha=True, float_buffer=options["floats"])
        pixels = np.random.default_rng(5).random((64, 4)).astype(np.float32)
        pixels[::7, 3], pixels[::5, 3] = 0, 1
        if options["floats"]:
            pixels[:, :3] *= pixels[:, 3:]
        image.pixels.foreach_set(pixels.ravel())
        if "bits" in options:  # on disk, where Blender and Cycles each read it
            image = bpy.data.images.load(_written(image, scene, options["bits"], os.path.join(options["where"], f"{number}.png")))
        else:
            image.pack()
        image.alpha_mode = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")[number % 4]
        material, tree, color = _shining(f"image {number}")
        node = common.image_node(tree, image)
        node.interpolation = "Closest"
        tree.links.new(node.outputs["Color"], color)
        if number > 3:  # as something that changes nothing
            tree.links.new(node.outputs["Alpha"], color.node.inputs["Strength"])
        _plate(material, number)


def _written(image, scene, bits, path):
    """As a PNG file of that depth; returns its path."""
    settings = scene.render.image_settings
    before = settings.file_format, settings.color_mode, settings.color_depth
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGBA", str(bits)
    image.save_render(path, scene=scene)
    settings.file_format, settings.color_mode, settings.color_depth = before
    return path


def _spaces(_scene, _options):
    """Images of bytes in colour spaces of all kinds; of greyish colours, so that none is below 0 elsewhere."""
    names = ("Linear Rec.709", "Linear Rec.2020", "ACEScg", "Filmic sRGB", "AgX Base sRGB") if bpy.app.version >= (4, 0) else (
        "Linear", "Linear ACES", "Filmic sRGB", "XYZ", "Raw")
    for number, name in enumerate(names):
        image = bpy.data.images.new(name, 8, 8, alpha=True)
        pixels = 0.4 + 0.3 * np.random.default_rng(11).random((64, 4)).astype(np.float32)
        pixels[:, 3] = 1
        image.pixels.foreach_set(pixels.ravel())
        image.pack()
        image.colorspace_settings.name = name
        material, tree, color = _shining(name)
        node = common.image_node(tree, image)
        image.colorspace_settings.name = name
        node.interpolation = "Closest"
        tree.links.new(node.outputs["Color"], color)
        _plate(material, number)


def _groups(_scene, _options):
    """Vectors of groups that nothing feeds, for a texture, an image and a texture two groups deep."""
    image = bpy.data.images.new("image", 8, 8)
    image.pixels.foreach_set(np.random.default_rng(7).random(256).astype(np.float32))
    inner = None
    for number, kind in enumerate(("ShaderNodeTexVoronoi", "ShaderNodeTexImage", "ShaderNodeGroup")):
        inner = _group(kind, inner, image)
        material, tree, color = _shining(f"group {number}")
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = inner
        node.inputs[0].default_value = (0.3, 0.2, 0.1)
        tree.links.new(node.outputs[0], color)
        _plate(material, number)


def _group(kind, inside, image):
    group = bpy.data.node_groups.new(kind, "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("At", in_out="INPUT", socket_type="NodeSocketVector")
        group.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        group.inputs.new("NodeSocketVector", "At")
        group.outputs.new("NodeSocketColor", "Color")
    start, node, end = (group.nodes.new(k) for k in ("NodeGroupInput", kind, "NodeGroupOutput"))
    if kind == "ShaderNodeTexImage":
        node.image = image
    elif kind == "ShaderNodeGroup":
        node.node_tree = inside
    group.links.new(start.outputs[0], node.inputs[0])
    group.links.new(next(s for s in node.outputs if s.name == "Color"), end.inputs[0])
    return group


def _colors(scene, _options):
    """Collections and faces that make instances have colours, and what they show has others."""
    material, tree, color = _shining("instance")
    tree.links.new(tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"], color)
    kit = bpy.data.collections.new("kit")
    for number, shade in enumerate(((0.1, 0.7, 0.2, 1), (0.8, 0.2, 0.7, 1))):
        part = common.plane(material, 0.25)
        part.location, part.color = (0.375 * number, 0, 0), shade
        scene.collection.objects.unlink(part)
        kit.objects.link(part)
    for number in range(3):
        empty = common.link(scene, f"empty {number}", None, (-1.5 + number, 1.25, 0))
        empty.instance_type, empty.instance_collection, empty.color = "COLLECTION", kit, (0.9, 0.3 * number, 0.2, 1)
    grid = common.plane(None, 1.0)
    grid.location, grid.color, grid.instance_type, grid.show_instancer_for_render = (0, -1, 0), (0.2, 0.4, 0.9, 1), "FACES", False
    shown = common.plane(material, 0.5)
    shown.color, shown.parent = (1, 1, 0, 1), grid
    _plate(material, 12).color = (0.6, 0.5, 0.4, 1)


def _nothing(_scene, _options):
    """Attributes that are not there, and their alpha."""
    for number, (kind, output) in enumerate((k, o) for k in ("GEOMETRY", "OBJECT", "INSTANCER") for o in ("Color", "Alpha")):
        material, tree, color = _shining(f"{kind} {output}")
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = kind, "nothing"
        tree.links.new(node.outputs[output], color)
        _plate(material, number)


def _told(number, kind, name, output):
    """A plate that shines with what an Attribute node says."""
    material, tree, color = _shining(f"{kind} {name} {output}")
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_type, node.attribute_name = kind, name
    tree.links.new(node.outputs[output], color)
    return material if number is None else _plate(material, number)


def _objects(scene, _options):
    """Numbers that objects, their meshes, the view layer, the scene and its world say, of all types."""
    made = []
    for number, name in enumerate(("whole", "part", "three", "two", "five", "location", "pass_index", "color", "text", "of_mesh",
                                   "flag")):
        made.append(_told(number, "OBJECT", name, "Alpha" if number % 4 == 3 else "Color" if number % 2 else "Vector"))
    for plate in made:
        plate["whole"], plate["part"], plate["three"], plate["two"] = 2, 0.3, (0.2, 0.5, 0.7), (0.9, 0.4)
        plate["five"], plate["text"], plate["flag"], plate.pass_index = (0.5,) * 5, "it", True, 3
        plate.data["of_mesh"], plate.data["part"], plate.color = 0.6, 0.9, (0.7, 0.2, 0.4, 0.8)
    scene.view_layers[0]["of_layer"], scene["of_scene"], scene["of_layer"] = 0.35, (0.1, 0.6, 0.2), 0.9
    scene.world = bpy.data.worlds.new("world")
    scene.world["of_world"] = 4
    for number, name in enumerate(("of_layer", "of_scene", "of_world", "frame_current", "nowhere")):
        _told(11 + number, "VIEW_LAYER", name, "Color")


def _instancers(scene, _options):
    """Empties that show a collection, faces that show a plate, each with its own number, and what has none."""
    kit = bpy.data.collections.new("kit")
    for number, (kind, output) in enumerate((("INSTANCER", "Color"), ("OBJECT", "Color"), ("INSTANCER", "Fac"))):
        part = common.plane(_told(None, kind, "tint", output), 0.25)
        part.location, part["tint"] = (0.3 * number, 0, 0), (0.9, 0.8, 0.1 * number)
        scene.collection.objects.unlink(part)
        kit.objects.link(part)
    for number in range(3):
        empty = common.link(scene, f"empty {number}", None, (-1.5 + number, 1.25, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", kit
        if number:
            empty["tint"] = (0.2, 0.3 * number, 0.5)
    for number, name in enumerate(("visible_camera", "is_holdout")):  # what shows others hides them
        empty = common.link(scene, name, None, (-1.5 + number, 0.5, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", kit
        setattr(empty, name, name == "is_holdout")
    grid = common.plane(None, 1.0)
    grid.location, grid.instance_type, grid.show_instancer_for_render, grid["tint"] = (0, -1, 0), "FACES", False, 0.4
    common.plane(_told(None, "INSTANCER", "tint", "Color"), 0.5).parent = grid
    _told(12, "INSTANCER", "tint", "Color")["tint"] = 0.7


def _nodes_tell(_scene, options):
    """Numbers that geometry nodes store on instances, of instances too; from 5.0 on Python knows them."""
    for number, nested in enumerate((False, True)):
        group = bpy.data.node_groups.new("made", "GeometryNodeTree")
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
        made, link = group.nodes.new, group.links.new
        last = made("GeometryNodeMeshGrid")
        last.inputs["Size X"].default_value = last.inputs["Size Y"].default_value = 0.25
        material = made("GeometryNodeSetMaterial")
        material.inputs["Material"].default_value = _told(None, "INSTANCER", "tint", "Color")
        link(last.outputs[0], material.inputs[0])
        last = material
        for level in range(1 + nested):
            points, shown, stored, random = (made(f"{kind}") for kind in (
                "GeometryNodeMeshLine", "GeometryNodeInstanceOnPoints", "GeometryNodeStoreNamedAttribute", "FunctionNodeRandomValue"))
            points.inputs["Count"].default_value = 4
            points.inputs["Offset"].default_value = (0.25, 0, 0) if level == 0 else (0, 0.25, 0)
            random.data_type, random.inputs["Seed"].default_value = "FLOAT_VECTOR", 3 + level
            stored.domain, stored.data_type = "INSTANCE", "FLOAT_VECTOR"
            stored.inputs["Name"].default_value = "tint" if level == nested else "other"
            link(points.outputs[0], shown.inputs["Points"])
            link(last.outputs[0], shown.inputs["Instance"])
            link(shown.outputs[0], stored.inputs["Geometry"])
            link(next(s for s in random.outputs if s.enabled), next(s for s in stored.inputs if s.name == "Value" and s.enabled))
            last = stored
        out = made("NodeGroupOutput")
        link(last.outputs[0], out.inputs[0])
        host = common.plane(None, 1.0)
        host.location = (-1.375 + 1.5 * number, -0.625, 0)
        host.modifiers.new("made", "NODES").node_group = group


def _islands(scene, _options):
    """Meshes of several islands, with vertices twice in one place, and what Geometry nodes say of them."""
    for number, output in enumerate(("Random Per Island", "Pointiness", "Parametric")):
        material, tree, color = _shining(output)
        node = tree.nodes.new("ShaderNodeNewGeometry")
        tree.links.new(node.outputs[output], color)
        form, chance = bmesh.new(), np.random.default_rng(number)
        for k in range(4):
            before = len(form.verts)
            bmesh.ops.create_grid(form, x_segments=3, y_segments=2 + k, size=0.25)
            for v in list(form.verts)[before:]:
                v.co += Vector((0.5 * (k % 2), 0.5 * (k // 2), 0.1 * chance.random()))
        bmesh.ops.split_edges(form, edges=list(form.edges)[::5])
        mesh = bpy.data.meshes.new(output)
        form.to_mesh(mesh)
        form.free()
        mesh.materials.append(material)
        common.link(scene, output, mesh, (-1.75 + 1.5 * (number % 2), 0.75 - 1.5 * (number // 2), 0))


def _normals(scene, _options):
    """Bent quadrilaterals: flat, some flat (both of these move), an edge sharp, some flat with it, all edges, normals of their own."""
    for number, (smooth, sharp, own) in enumerate(((0, (), False), (2, (), False), (4, (7,), False), (2, (7,), False), (2, range(13), False),
                                                   (2, (), True))):
        mesh, chance = bpy.data.meshes.new("strip"), np.random.default_rng(3)
        mesh.from_pydata([(0.3 * (k // 2), 0.8 * (k % 2), 0.4 * chance.random()) for k in range(10)], [],
                         [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(4)])
        for k, face in enumerate(mesh.polygons):
            face.use_smooth = k < smooth
        for k in sharp:
            mesh.edges[k].use_edge_sharp = True
        if hasattr(mesh, "use_auto_smooth"):  # until 4.0
            mesh.use_auto_smooth, mesh.auto_smooth_angle = bool(sharp or own), 3.14
        if own:
            mesh.normals_split_custom_set([(0.2 * (k % 3), 0.3, 1) for k in range(16)])
        material, tree, color = _shining("strip")
        node, more = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeVectorMath")
        more.inputs[1].default_value = (1, 1, 0)
        tree.links.new(node.outputs["Normal"], more.inputs[0])
        tree.links.new(more.outputs[0], color)
        mesh.materials.append(material)
        strip = common.link(scene, "strip", mesh, (-1.8 + 1.8 * (number % 2), 0.8 - 1.2 * (number // 2), 0))
        if number < 2:
            strip.shape_key_add(name="before")
            key = strip.shape_key_add(name="after")
            for k, point in enumerate(key.data):
                point.co.z += 0.1 * (k % 3)
            for frame in (0, 2):
                key.value = 0.5 * frame
                key.keyframe_insert("value", frame=frame)
        if number == 1:  # shows other meshes, which are not its own
            tree, (joined,) = _of_nodes("more", "JoinGeometry")
            points, grid = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeMeshGrid")
            grid.inputs["Size X"].default_value = grid.inputs["Size Y"].default_value = 0.1
            tree.links.new(joined.inputs[0].links[0].from_socket, points.inputs["Points"])
            tree.links.new(grid.outputs[0], points.inputs["Instance"])
            tree.links.new(points.outputs[0], joined.inputs[0])
            strip.modifiers.new("more", "NODES").node_group = tree
    scene.render.use_motion_blur = True


def _edges(_scene, _options):
    """Numbers that edges say, of all types, bytes and pairs of points, and what is one number of several."""
    there = bpy.types.Attribute.bl_rna.properties["data_type"].enum_items.keys()
    kinds = ("FLOAT", "INT", "INT8", "BOOLEAN", "FLOAT_VECTOR", "FLOAT_COLOR", "BYTE_COLOR", "FLOAT2")
    cases = [(kind, "EDGE", "Color") for kind in kinds] + [("INT8", "POINT", "Color"), ("QUATERNION", "POINT", "Color"),
                                                           ("QUATERNION", "POINT", "Alpha"), ("FLOAT_COLOR", "EDGE", "Alpha"), ("FLOAT2", "POINT", "Fac"),
                                                           ("FLOAT_COLOR", "CORNER", "Fac")]
    for number, (kind, domain, output) in enumerate(cases):
        plate, chance = _told(number, "GEOMETRY", "tint", output), np.random.default_rng(number)
        plate.data.materials[0].node_tree.nodes["Emission"].inputs["Strength"].default_value = 0.5
        if kind not in there:
            continue
        _divide(plate.data, 2)
        told = plate.data.attributes.new("tint", kind, domain)
        for item in told.data:
            value = chance.random(4)
            if hasattr(item, "color"):
                item.color = value
            elif hasattr(item, "vector"):
                item.vector = value[:len(item.vector)]
            else:
                item.value = {"FLOAT": value[0], "INT": int(5 * value[0]), "INT8": int(5 * value[0]), "BOOLEAN": bool(value[0] > 0.7)}.get(kind, value)


def _hidden(_scene, _options):
    """Links that are left at sockets which a node has for another kind: they lead nowhere, in the middle of a graph too."""
    for number in range(4):
        material, tree, color = _shining("plate")
        color.default_value = (0.2, 0.4, 0.1, 1)
        given, mix = tree.nodes.new("ShaderNodeRGB"), tree.nodes.new("ShaderNodeMix")
        given.outputs[0].default_value = (0.9, 0.1, 0.6, 1)
        kinds = {kind: [s for s in mix.outputs if s.identifier.startswith(f"Result_{kind}")][0] for kind in ("Float", "Color")}
        inputs = {s.identifier: s for s in mix.inputs}
        mix.data_type = "RGBA" if number < 2 else "FLOAT"
        inputs["A_Color"].default_value, inputs["A_Float"].default_value = (0.3, 0.8, 0.2, 1), 0.7
        tree.links.new(given.outputs[0], inputs["A_Color" if number % 2 else "A_Float"])
        tree.links.new(kinds["Float" if number in (0, 3) else "Color"], color)
        _plate(material, 4 * number + number)


def _particles(scene, _options):
    """What particles say, of each output."""
    for number, (output, part) in enumerate((("Index", 0.1), ("Random", 0.9), ("Age", 0.1), ("Lifetime", 0.02), ("Location", 0.3), ("Size", 3),
                                             ("Velocity", 1), ("Angular Velocity", 0.5))):
        material, tree, color = _shining(output)
        node, more = tree.nodes.new("ShaderNodeParticleInfo"), tree.nodes.new("ShaderNodeVectorMath")
        more.operation, more.inputs[1].default_value, more.inputs[2].default_value = "MULTIPLY_ADD", (part,) * 3, (0.2,) * 3
        tree.links.new(node.outputs[output], more.inputs[0])
        tree.links.new(more.outputs[0], color)
        bpy.ops.mesh.primitive_cube_add(size=0.8, location=(-1.5 + number % 4, -0.5 - number // 4, 0))  # itself, of no particle
        shown = common.added(material)
        host = _plate(None, number)
        host.show_instancer_for_render = False
        host.modifiers.new("made", "PARTICLE_SYSTEM")
        made = host.particle_systems[0].settings
        made.count, made.frame_start, made.frame_end, made.lifetime, made.lifetime_random = 12, 1, 3, 100, 0.5
        made.render_type, made.instance_object, made.particle_size, made.size_random = "OBJECT", shown, 0.3, 0.5
        made.normal_factor, made.angular_velocity_factor, made.angular_velocity_mode = 0.2, 2, "GLOBAL_Z"
        made.effector_weights.gravity, made.use_rotations, made.use_dynamic_rotation = 0, True, False
    for frame in range(1, 6):
        scene.frame_set(frame)


def _bright(scene, _options):
    """Colours above 1, and below 0: of matt and shining surfaces, of light, fed and not."""
    common.light(scene, rotation=(0.5, 0.6, 0))
    lit = "Emission Color" if bpy.app.version >= (4, 0) else "Emission"
    cases = (("BsdfDiffuse", "Color", {}), ("BsdfDiffuse", "Color", {"Roughness": 0.6}), ("BsdfPrincipled", "Base Color", {}),
             ("BsdfGlossy", "Color", {"Roughness": 0.7}), ("BsdfPrincipled", lit, {"Emission Strength": -0.5}), ("Emission", "Color", {}),
             ("Emission", "Color", {"Strength": -0.1}), ("BsdfPrincipled", "Base Color", {"Metallic": 1.0, "Roughness": 0.7}))
    for number in range(16):
        kind, socket, more = cases[number % 8]
        material = bpy.data.materials.new("plate")
        tree = common.tree_of(material)
        shader, given, math = (tree.nodes.new(f"ShaderNode{name}") for name in (kind, "CombineXYZ", "VectorMath"))
        for name, value in more.items():
            shader.inputs[name].default_value = value
        for part, value in zip(given.inputs, (1.7, -0.2, 0.4) if number % 3 else (3.0, 0.5, 1.2)):
            part.default_value = value
        if number > 7:  # not known before the picture
            place = tree.nodes.new("ShaderNodeNewGeometry")
            tree.links.new(place.outputs["Backfacing"], math.inputs[1])
        tree.links.new(given.outputs[0], math.inputs[0])
        tree.links.new(math.outputs[0], shader.inputs[socket])
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        _plate(material, number)


def _tiles(_scene, options):
    """Tiles of several sizes, and what is beyond them all: three more on the one side, on the other the first again."""
    chance = np.random.default_rng(2)
    for number, size in ((1001, 8), (1002, 4), (1011, 2)):
        tile = bpy.data.images.new("tile", size, size)
        pixels = chance.random((size, size, 4)).astype(np.float32)
        pixels[..., 3] = 1
        tile.pixels.foreach_set(pixels.ravel())
        tile.filepath_raw, tile.file_format = os.path.join(options["where"], f"part.{number}.png"), "PNG"
        tile.save()
    for number, interpolation in enumerate(("Linear", "Closest")):
        image = bpy.data.images.load(os.path.join(options["where"], "part.1001.png"))
        image.source, image.filepath = "TILED", os.path.join(options["where"], "part.<UDIM>.png")
        for tile in (1002, 1011):
            image.tiles.new(tile_number=tile)
        image.reload()
        material, tree, color = _shining(interpolation)
        node, place, wide = common.image_node(tree, image), tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeMapping")
        node.interpolation = interpolation
        wide.inputs["Scale"].default_value, wide.inputs["Location"].default_value = (4, 4, 1), (-1.5, -1.5, 0)
        tree.links.new(place.outputs[0], wide.inputs["Vector"])
        tree.links.new(wide.outputs[0], node.inputs["Vector"])
        tree.links.new(node.outputs["Color"], color)
        _plate(material, 5 * number, 2.0).location = (-1 + 2 * number, 0, 0)


def _exposure(scene, _options):
    material, _tree, color = _shining("plate")
    color.default_value = (0.5, 0.4, 0.1, 1)
    _plate(material, 5)
    scene.cycles.film_exposure = 2.5
    scene.render.film_transparent = True


def _world(scene, _options):
    """A layer with a world of its own, where this Blender has such."""
    scene.render.film_transparent = False
    for number, shade in enumerate(((0.1, 0.6, 0.2, 1), (0.7, 0.2, 0.1, 1))):
        world = bpy.data.worlds.new(f"world {number}")
        common.tree_of(world).nodes["Background"].inputs["Color"].default_value = shade
        if not number:
            scene.world = world
        elif hasattr(scene.view_layers[0], "world_override"):
            scene.view_layers[0].world_override = world


def _windows(_scene, options):
    """An image whose path was written by Windows."""
    image = bpy.data.images.new("saved", 8, 8)
    image.pixels.foreach_set(np.random.default_rng(9).random(256).astype(np.float32) * 0.5 + 0.5)
    folder = os.path.join(options["where"], "inside")
    os.makedirs(folder, exist_ok=True)
    image.filepath_raw, image.file_format = os.path.join(folder, "it.png"), "PNG"
    image.save()
    found = bpy.data.images.load(image.filepath_raw, check_existing=False)
    found.filepath_raw = options["where"] + "/.\\inside\\it.png"
    found.reload()
    material, tree, color = _shining("plate")
    tree.links.new(common.image_node(tree, found).outputs["Color"], color)
    _plate(material, 5)


def _lost(_scene, options):
    """Normal maps without their file, and without an image."""
    lost = bpy.data.images.new("lost", 4, 4)
    lost.source, lost.filepath = "FILE", os.path.join(options["where"], "gone.png")
    lost.colorspace_settings.name = "Non-Color"
    for number, image in enumerate((lost, None)):
        material = bpy.data.materials.new("plate")
        tree = common.tree_of(material)
        shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        node = tree.nodes.new("ShaderNodeNormalMap")
        tree.links.new(common.image_node(tree, image).outputs["Color"], node.inputs["Color"])
        tree.links.new(node.outputs[0], shader.inputs["Normal"])
        _plate(material, 5 + number)
    common.light(bpy.context.scene, rotation=(0.5, 0.6, 0))


def _taken(_scene, _options):
    """Attributes by names that Cycles has for something else."""
    names = ("mine", "color", "density", "heat", "flame", "temperature", "velocity", "uv", "generated", "pointiness",
             "random_per_island", "undeformed", "shadow_transparency")
    for number, (kind, name) in enumerate([*(("Attribute", name) for name in names), *(("VertexColor", name) for name in names[:3])]):
        material, tree, color = _shining(f"{kind} {name}")
        node = tree.nodes.new(f"ShaderNode{kind}")
        setattr(node, "layer_name" if kind == "VertexColor" else "attribute_name", name)
        tree.links.new(node.outputs["Color"], color)
        plate = _plate(material, number)
        told = plate.data.color_attributes.new(name, "FLOAT_COLOR", "POINT")
        told.data.foreach_set("color", np.random.default_rng(number).random(16).astype(np.float32))


def _of_nodes(name, *kinds):
    """A tree of geometry nodes and nodes of these kinds, one after the other, from what comes in to what goes out."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        if hasattr(tree, "interface"):
            tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
        else:
            (tree.inputs if way == "INPUT" else tree.outputs).new("NodeSocketGeometry", "Geometry")
    made = [tree.nodes.new(kind) for kind in ("NodeGroupInput", *(f"GeometryNode{kind}" for kind in kinds), "NodeGroupOutput")]
    for before, after in zip(made, made[1:]):
        tree.links.new(before.outputs[0], next(s for s in after.inputs if s.type == "GEOMETRY"))
    return tree, made[1:-1]


def _store(tree, node, name, domain):
    """Colours by chance."""
    node.data_type, node.domain, node.inputs["Name"].default_value = "FLOAT_VECTOR", domain, name
    chance = tree.nodes.new("FunctionNodeRandomValue")
    chance.data_type = "FLOAT_VECTOR"
    tree.links.new(next(s for s in chance.outputs if s.enabled), next(s for s in node.inputs if s.name == "Value" and s.enabled))


def _cloud(_scene, _options):
    """Points that say something each, by an Attribute and by a Color Attribute node, and what they do not say."""
    for number, (kind, name) in enumerate((("Attribute", "tint"), ("VertexColor", "tint"), ("Attribute", "other"))):
        material, tree, color = _shining(f"{kind} {name}")
        node = tree.nodes.new(f"ShaderNode{kind}")
        setattr(node, "layer_name" if kind == "VertexColor" else "attribute_name", name)
        tree.links.new(node.outputs["Color"], color)
        made, (points, stored, shade) = _of_nodes("cloud", "MeshToPoints", "StoreNamedAttribute", "SetMaterial")
        points.inputs["Radius"].default_value, shade.inputs["Material"].default_value = 0.3, material
        _store(made, stored, "tint", "POINT")
        if kind == "VertexColor":
            stored.data_type = "FLOAT_COLOR"
            chance = next(n for n in made.nodes if n.type == "RANDOM_VALUE")
            made.links.new(next(s for s in chance.outputs if s.enabled), next(s for s in stored.inputs if s.name == "Value" and s.enabled))
        _plate(None, 5 * number, 0.6).modifiers.new("cloud", "NODES").node_group = made
    _plate(_shining("even")[0], 3)


def _strands(scene, _options):
    """Curves and their points say something; from 4.0 on Python can make some. Their rims, of which
    ours have eight sides, are not seen."""
    if not hasattr(bpy.data, "hair_curves") or bpy.app.version < (4, 0):
        _plate(_shining("even")[0], 3)
        return
    for number, (domain, count) in enumerate((("POINT", 6), ("CURVE", 1))):
        material, tree, color = _shining(domain)
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_name = "tint"
        tree.links.new(node.outputs["Color"], color)
        data = bpy.data.hair_curves.new(domain)
        data.add_curves([6])
        places = np.zeros((6, 3), np.float32)
        places[:, 1] = np.linspace(-2.5, 2.5, 6)
        data.points.foreach_set("position", places.ravel())
        radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
        radius.data.foreach_set("value", np.full(6, 1.2, np.float32))
        told = data.attributes.new("tint", "FLOAT_COLOR", domain)
        told.data.foreach_set("color", np.random.default_rng(4).random(4 * count).astype(np.float32))
        data.materials.append(material)
        common.link(scene, domain, data, (-1 + 2 * number, 0, 0))


def _on_instancers(_scene, _options):
    """Where instances are on what shows them: on faces, and on nothing."""
    for number, (kind, output) in enumerate((("TexCoord", "Generated"), ("TexCoord", "UV"), ("UVMap", "UV"))):
        grid = common.plane(None, 1.0)
        _divide(grid.data, 1)
        grid.location, grid.instance_type, grid.show_instancer_for_render = (-1.3 + 1.3 * number, 0.6, 0), "FACES", False
        for parent, place in ((grid, (0, 0, 0)), (None, (-1.3 + 1.3 * number, -0.8, 0))):
            material, tree, color = _shining(f"{kind} {output}")
            node, more = tree.nodes.new(f"ShaderNode{kind}"), tree.nodes.new("ShaderNodeVectorMath")
            node.from_instancer, more.inputs[1].default_value = True, (0.6, 0.7, 0.8)
            tree.links.new(node.outputs[output], more.inputs[0])
            tree.links.new(more.outputs[0], color)
            shown = common.plane(material, 0.3)
            shown.parent, shown.location = parent, place


def _smoke(_scene, _options):
    """A box for smoke that was never made hides nothing."""
    material, _tree, color = _shining("plate")
    color.default_value = (0.5, 0.4, 0.1, 1)
    _plate(material, 5)
    box = common.plane(_shining("box")[0], 3.0)
    box.location = (0, 0, 1)
    box.modifiers.new("smoke", "FLUID").fluid_type = "DOMAIN"


def _deep(scene, options):
    """Texels of 16 bits are seen: of files, one with alpha, one packed, one of data, one by cubic splines."""
    image = bpy.data.images.new("deep", 8, 8, alpha=True, float_buffer=True)
    pixels = np.random.default_rng(6).random((64, 4)).astype(np.float32)
    image.pixels.foreach_set(pixels.ravel())
    settings = scene.render.image_settings
    names = "file_format", "color_mode", "color_depth"
    before = [getattr(settings, name) for name in names]
    if hasattr(settings, "media_type"):  # from 5.0 on
        settings.media_type = "IMAGE"
    kinds = (("PNG", "RGB"), ("TIFF", "RGB"), ("PNG", "RGBA"), ("PNG", "BW"), ("TIFF", "RGBA"), ("PNG", "packed"), ("PNG", "Non-Color"), ("PNG", "Cubic"))
    for number, (kind, what) in enumerate(kinds):
        settings.file_format, settings.color_mode, settings.color_depth = kind, what if what in ("BW", "RGBA") else "RGB", "16"
        path = os.path.join(options["where"], f"deep {number}.{kind.lower()}")
        image.save_render(path, scene=scene)
        found = bpy.data.images.load(path)
        if what == "packed":
            found.pack()
        elif what == "Non-Color":
            found.colorspace_settings.name = what
        material, tree, color = _shining(f"{kind} {what}")
        node = common.image_node(tree, found)
        node.interpolation = "Cubic" if what == "Cubic" else "Linear"
        tree.links.new(node.outputs["Color"], color)
        _plate(material, number)
    for name, value in zip(names, before):
        setattr(settings, name, value)


_CASES = {name[1:]: made for name, made in list(globals().items())
          if name in ("_alpha", "_spaces", "_groups", "_colors", "_nothing", "_objects", "_instancers", "_nodes_tell", "_islands",
                      "_bright", "_tiles", "_exposure", "_world", "_windows", "_lost", "_taken", "_cloud", "_strands", "_on_instancers", "_smoke", "_deep",
                      "_normals", "_edges", "_particles", "_hidden")}
