# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene of all that an artist edits, and edits by chance."""

import random

import bpy
import numpy as np

import common

chance = random.Random()


# ---- the scene


def image(name):
    made = bpy.data.images.new(name, 8, 8, float_buffer=chance.random() < 0.5)
    made.pixels.foreach_set(np.random.default_rng(len(name)).random(256, np.float32))
    return made


def material(name, number):
    made, tree, node = common.metal(name)
    texture, _bump = common.normal_map(tree, node, bpy.data.images[number % 2])
    where = tree.nodes.new("ShaderNodeUVMap")
    where.uv_map = ("UVMap", "other")[number % 2]
    tree.links.new(where.outputs[0], texture.inputs[0])
    return made


def build():
    scene = common.empty_scene()
    scene.render.engine = "LIBSHADE"
    image("one"), image("other")
    materials = [material(f"metal{k}", k) for k in range(3)]
    plain = bpy.data.materials.new("plain")
    common.tree_of(plain)
    materials.append(plain)
    cloth = bpy.data.materials.new("cloth")
    tree = common.tree_of(cloth)
    tree.links.new(tree.nodes.new("LibshadeFabricNode").outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=5, y_subdivisions=5)
    grid = common.added(materials[0])
    grid.data.materials.append(materials[1])
    grid.data.uv_layers.new(name="other")
    grid.shape_key_add(name="basis")
    bend = grid.shape_key_add(name="bend")
    for k, point in enumerate(bend.data):
        point.co.z += 0.1 * (k % 3)
    for k in range(3):
        common.link(scene, f"copy{k}", grid.data, (k, 0, 1))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6)
    ball = common.added(materials[2])
    ball.modifiers.new("fine", "SUBSURF").levels = 1
    bpy.ops.object.text_add()
    common.added(plain)
    bpy.ops.curve.primitive_bezier_circle_add()
    common.added(plain).data.bevel_depth = 0.1
    bpy.ops.object.metaball_add(radius=0.5)
    inside = bpy.data.collections.new("inside")
    monkey = bpy.data.objects.new("inner", ball.data)
    inside.objects.link(monkey)
    empty = common.link(scene, "instance", None, (0, 3, 0))
    empty.instance_type, empty.instance_collection = "COLLECTION", inside
    parent = common.link(scene, "parent", bpy.data.meshes.new_from_object(ball), (4, 0, 0))
    parent.instance_type = "FACES"
    common.link(scene, "child", grid.data, (4, 0, 0)).parent = parent
    common.camera(scene)
    common.light(scene)
    common.light(scene, "POINT", 30.0, 0.1, location=(0, 0, 3))
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world)
    return scene


# ---- edits


def objects(*kinds):
    return [ob for ob in bpy.data.objects if ob.type in (kinds or (ob.type,))]


def some(*kinds):
    return chance.choice(objects(*kinds))


def edit_move():
    some("MESH", "CURVE", "LIGHT").location.x += chance.uniform(-1, 1)


def edit_turn():
    some("MESH", "CURVE", "FONT").rotation_euler.x += 1


def edit_lamp():
    some("LIGHT").data.energy *= 1.1


def edit_camera():
    some("CAMERA").location.y += 0.1


def edit_world():
    common.tree_of(bpy.context.scene.world).nodes["Background"].inputs["Strength"].default_value = chance.random()


def edit_slider():
    node = bpy.data.materials[f"metal{chance.randrange(3)}"].node_tree.nodes["Libshade Metal"]
    node.inputs["Color"].default_value[0] = chance.random()


def edit_property():
    node = bpy.data.materials[f"metal{chance.randrange(3)}"].node_tree.nodes["Libshade Metal"]
    node.detail = chance.choice(["ROTATE", "DEFORM_LINEAR", "NONE"])


def edit_keys():
    """Of what is carried over into our nodes, where keyframes change it."""
    kind, owner = chance.choice([("Metal", f"metal{k}") for k in range(3)] + [("Fabric", "cloth")])
    node = bpy.data.materials[owner].node_tree.nodes["Libshade " + kind]
    name, value = chance.choice({
        "Metal": [("ex", chance.uniform(5, 500)), ("grain", chance.choice(["UV", "RADIAL_Z", "AXIS_Y"])),
                  ("bump_response", chance.choice(["FOLLOW", "IGNORE"])), ("bumps_are", chance.choice(["RELIEF", "SHAPE"]))],
        "Fabric": [("size", chance.uniform(0.1, 1)), ("warp_width", chance.uniform(0.2, 0.9))]}[kind])
    setattr(node, name, value)
    node.keyframe_insert(name, frame=bpy.context.scene.frame_current + chance.randrange(3))


def edit_driver():
    node = bpy.data.materials[f"metal{chance.randrange(3)}"].node_tree.nodes["Libshade Metal"]
    if node.driver_remove("ay"):
        return
    driver = node.driver_add("ay").driver
    variable = driver.variables.new()
    variable.name, variable.targets[0].id, variable.targets[0].data_path = "x", some("LIGHT"), "location.x"
    driver.expression = "0.1 + abs(x) / 4"


def edit_uv_map_node():
    tree = bpy.data.materials[f"metal{chance.randrange(3)}"].node_tree
    tree.nodes["UV Map"].uv_map = chance.choice(["UVMap", "other", "third", ""])


def edit_unlink():
    tree = bpy.data.materials[f"metal{chance.randrange(3)}"].node_tree
    socket = tree.nodes["Libshade Metal"].inputs["Normal"]
    if socket.links:
        tree.links.remove(socket.links[0])
    else:
        tree.links.new(tree.nodes["Normal Map"].outputs[0], socket)


def edit_emission():
    tree = bpy.data.materials["plain"].node_tree
    socket = tree.nodes["Material Output"].inputs["Surface"]
    shines = tree.nodes.get("Emission") or tree.nodes.new("ShaderNodeEmission")
    tree.links.new(chance.choice([shines, tree.nodes["Principled BSDF"]]).outputs[0], socket)


def edit_vertices():
    mesh = some("MESH").data
    mesh.vertices[0].co.z += 0.1
    mesh.update()


def edit_uvs():
    layers = some("MESH").data.uv_layers
    if len(layers) and len(layers[0].data):
        layers[0].data[0].uv.x += 0.1
        layers[0].id_data.update()


def edit_new_layer():
    layers = some("MESH").data.uv_layers
    if len(layers) < 4:
        layers.new(name=chance.choice(["other", "third"]))


def edit_drop_layer():
    layers = some("MESH").data.uv_layers
    if len(layers):
        layers.remove(layers[-1])


def edit_smooth():
    common.smooth(some("MESH").data, chance.random() < 0.5)


def edit_faces_material():
    mesh = some("MESH").data
    mesh.polygons[0].material_index = chance.randrange(3)
    mesh.update()


def edit_slots():
    slots = some("MESH").material_slots
    if len(slots):
        slot = chance.choice(slots)
        slot.link = chance.choice(["DATA", "OBJECT"])
        slot.material = chance.choice([None, *bpy.data.materials])


def edit_more_slots():
    materials = some("MESH", "FONT", "CURVE", "META").data.materials
    if len(materials) > 2:
        materials.pop()
    else:
        materials.append(chance.choice(bpy.data.materials))


def edit_modifier():
    modifiers = some("MESH").modifiers
    if len(modifiers) > 1:
        modifiers.remove(modifiers[0])
    elif len(modifiers):
        modifiers[0].show_viewport = not modifiers[0].show_viewport
    else:
        modifiers.new("solidify", "SOLIDIFY").thickness = chance.random() / 10


def edit_modifier_value():
    for ob in objects("MESH"):
        for modifier in ob.modifiers:
            if modifier.type == "SOLIDIFY":
                modifier.thickness = chance.random() / 10
            if modifier.type == "SUBSURF":
                modifier.levels = chance.randrange(3)


def edit_shape_key():
    for keys in bpy.data.shape_keys:
        keys.key_blocks["bend"].value = chance.random()


def edit_text():
    some("FONT").data.body = chance.choice(["a", "bc", "", "Text"])


def edit_curve():
    some("CURVE").data.bevel_depth = chance.random() / 5


def edit_metaball():
    some("META").data.elements[0].radius = chance.uniform(0.4, 1)


def edit_new_object():
    common.link(bpy.context.scene, "new", some("MESH", "FONT").data, (chance.random(), 5, 0))


def edit_new_mesh():
    made = some("MESH").data.copy()
    common.link(bpy.context.scene, "apart", made, (chance.random(), 6, 0))


def edit_remove():
    named = [ob for ob in bpy.data.objects if ob.name.startswith(("new", "apart", "copy"))]
    if named:
        bpy.data.objects.remove(chance.choice(named))


def edit_exchange():
    some("MESH").data = chance.choice([ob.data for ob in objects("MESH") if not ob.data.shape_keys])


def edit_hide():
    ob = some("MESH", "FONT")
    ob.hide_viewport = not ob.hide_viewport


def edit_visibility():
    ob = some("MESH")
    ob.visible_diffuse = ob.visible_glossy = ob.visible_transmission = not ob.visible_diffuse


def edit_holdout():
    ob = some("MESH")
    ob.is_holdout = not ob.is_holdout


def edit_catcher():
    ob = some("MESH")
    ob.is_shadow_catcher = not ob.is_shadow_catcher


def edit_pixels():
    image = chance.choice(bpy.data.images)
    image.pixels[chance.randrange(256)] = chance.random()
    image.update()


def edit_color_space():
    chance.choice(bpy.data.images).colorspace_settings.name = chance.choice(["sRGB", "Non-Color"])


def edit_image_of_node():
    tree = bpy.data.materials[f"metal{chance.randrange(3)}"].node_tree
    tree.nodes["Image Texture"].image = chance.choice([None, *(i for i in bpy.data.images if i.size[0] == 8)])


def edit_frame():
    scene = bpy.context.scene
    scene.frame_set(scene.frame_current + 1)


def edit_override():
    layer = bpy.context.view_layer
    layer.material_override = None if layer.material_override else bpy.data.materials["plain"]


def edit_rename():
    some("MESH").name = chance.choice("abcdef")


def edit_mode():
    layer = bpy.context.view_layer
    if layer.objects.active and layer.objects.active.mode == "EDIT":
        bpy.ops.object.mode_set(mode="OBJECT")
    else:
        shown = [ob for ob in layer.objects if ob.type == "MESH" and ob.visible_get()]
        layer.objects.active = chance.choice(shown) if shown else None
        if shown:
            bpy.ops.object.mode_set(mode="EDIT")
            bpy.ops.mesh.select_all(action="SELECT")
            bpy.ops.transform.translate(value=(0, 0, 0.1))


EDITS = {name: made for name, made in globals().items() if name.startswith("edit_")}
CHEAP = {"edit_move", "edit_lamp", "edit_camera", "edit_world", "edit_slider", "edit_frame"}  # ask for no mesh again


def some_names():
    """What is done next, most often one thing."""
    return chance.sample(sorted(EDITS), chance.choice([1, 1, 1, 2, 4]))
