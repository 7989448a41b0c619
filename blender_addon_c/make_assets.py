# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's asset library: metals, cloths and scratched metals as materials, Libshade Groove and a metal for any renderer as plain
node groups; each with a picture that libshade renders.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup --addons libshade \
        --python-exit-code 1 -P make_assets.py -- FOLDER [SHEET.png]

Writes FOLDER/*.blend, and last blender_assets.cats.txt; SHEET.png: all pictures on one.
"""

import math
import os
import sys
import tempfile
import uuid

import bpy
import numpy as np
from mathutils import Vector

SAMPLES, SIZE, COLUMNS = 64, 192, 10
CATALOGS = ("Libshade", "Libshade/Metals", "Libshade/Fabrics", "Libshade/Grooves", "Libshade/Scratches")
# Scratches that show on what is a metre large, in metres to a unit of UV, and what is between them.
SCRATCHED_UNIT, SCRATCHES = 0.1, {"Density per cm²": 20.0, "Length mm": 10.0, "Width mm": 0.1, "Depth": 0.25}
POLISH = 0.25
# Images that Cycles shows of them, and of each preset's: metres, of a whole unit of UV where repeats would show, and texels.
IMAGE = 0.1, 1536
IMAGES = {"FINE_POLISH": (0.008, 1024), "BRUSHED": (0.025, 1024), "USED": (0.05, 1024), "DEEP": (0.1, 2048)}
# A unit of UV on the picture's ball, in metres of cloth: small enough for coarse yarns to show.
BALL_OF_CLOTH = 0.05


def catalog(path):
    """The same in every build, so that what users sort stays where it is."""
    return str(uuid.uuid5(uuid.NAMESPACE_URL, f"libshade/assets/{path}"))


def catalogs():
    lines = ["# Catalogs of libshade's assets.", "", "VERSION 1", ""]
    return "\n".join(lines + [f"{catalog(path)}:{path}:{path.replace('/', '-')}" for path in CATALOGS]) + "\n"


# ---- a ball in a photographer's room


def area(scene, energy, place, size, color=(1, 1, 1)):
    data = bpy.data.lights.new("lamp", "AREA")
    data.energy, data.size, data.color = energy, size, color
    ob = bpy.data.objects.new("lamp", data)
    ob.location = place
    ob.rotation_euler = (-Vector(place)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(ob)


def dome(scene):
    """What metal reflects: a floor, a dark wall, and above it what gets brighter to the top. No camera sees it."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=20.0)
    ob = bpy.context.object
    ob.visible_camera = False
    material = bpy.data.materials.new("dome")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    place, parts, height, ramp, shine, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in (
        "NewGeometry", "SeparateXYZ", "MapRange", "ValToRGB", "Emission", "OutputMaterial"))
    height.inputs["From Min"].default_value, height.inputs["From Max"].default_value = -20.0, 20.0
    elements = ramp.color_ramp.elements
    for at, (position, value) in enumerate(((0.0, 0.30), (0.42, 0.10), (0.50, 0.02), (0.58, 0.22), (0.75, 0.6), (1.0, 0.9))):
        element = elements[at] if at == 0 else elements[-1] if position == 1.0 else elements.new(position)
        element.position, element.color = position, (value, value, value, 1)
    for source, target in ((place.outputs["Position"], parts.inputs[0]), (parts.outputs["Z"], height.inputs["Value"]),
                           (height.outputs[0], ramp.inputs[0]), (ramp.outputs[0], shine.inputs["Color"]),
                           (shine.outputs[0], output.inputs["Surface"])):
        tree.links.new(source, target)
    ob.data.materials.append(material)


def room(of_metal):
    """An empty file but for the ball, lamps, what is around and a camera; the ball."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="libshade")
    scene = bpy.context.scene
    if of_metal:
        dome(scene)
    else:
        world = scene.world = bpy.data.worlds.new("room")
        world.use_nodes = True
        world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.16, 0.17, 0.19, 1)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=1.0)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    for loop in ball.data.uv_layers.active.data:  # as long as wide
        loop.uv.x *= 2
    ball.rotation_euler = (0.35, 0.0, 0.5)
    share, small = (0.25, 0.3) if of_metal else (1.0, 1.0)
    area(scene, 260 * share, (-3.0, -2.5, 3.0), 1.6 * small)
    area(scene, 110 * share, (3.5, -2.0, 0.8), 1.0 * small, (1.0, 0.93, 0.85))
    area(scene, 160 * share, (1.0, 3.5, 3.0), 1.5 * small, (0.85, 0.93, 1.0))
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    data.type, data.ortho_scale, camera.location = "ORTHO", 2.2, (0, -4, 0)
    camera.rotation_euler = (math.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render = scene.render
    render.engine, render.film_transparent = "LIBSHADE", True
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage = 100
    render.image_settings.file_format, render.image_settings.color_mode = "PNG", "RGBA"
    scene.libshade.samples = SAMPLES
    scene.view_settings.view_transform = "Standard"
    return ball


def picture_of(ball, material, path):
    ball.data.materials.clear()
    ball.data.materials.append(material)
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    pixels = image.pixels[:]
    bpy.data.images.remove(image)
    return pixels


def show(item, pixels):
    """Give an asset its picture."""
    preview = item.preview_ensure()
    preview.image_size = SIZE, SIZE
    preview.image_pixels_float.foreach_set(pixels)


def write_sheet(pictures, path):
    rows = -(-len(pictures) // COLUMNS)
    whole = np.zeros((rows * SIZE, COLUMNS * SIZE, 4), np.float32)
    for number, pixels in enumerate(pictures):
        row, column = divmod(number, COLUMNS)
        y, x = (rows - 1 - row) * SIZE, column * SIZE  # images begin below
        whole[y:y + SIZE, x:x + SIZE] = np.reshape(pixels, (SIZE, SIZE, 4))
    image = bpy.data.images.new("sheet", COLUMNS * SIZE, rows * SIZE, alpha=True)
    image.pixels.foreach_set(whole.ravel())
    image.filepath_raw, image.file_format = os.path.abspath(path), "PNG"
    image.save()


def mark(item, path, help_, tags):
    item.asset_mark()
    item.asset_data.catalog_id, item.asset_data.description = catalog(path), help_
    for tag in ("libshade", *tags):
        item.asset_data.tags.new(tag, skip_if_exists=True)


# ---- what is shown


def new_material(name, kind):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (300, 0)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material, tree, node


def scratch(tree, node, scratches):
    """Large enough to be seen on an object of a metre or two."""
    texture = tree.nodes.new(scratches.SCRATCHES)
    texture.location, texture.size = (-280, 0), SCRATCHED_UNIT
    scratches.apply_preset(texture, "USED")
    for name, value in SCRATCHES.items():
        texture.inputs[name].default_value = value
    bake_shared(texture, scratches)
    tree.links.new(texture.outputs["Normal"], node.inputs["Normal"])
    node.inputs["Roughness"].default_value = POLISH


def bake_shared(texture, scratches):
    """Images for other renderers, the same for all metals."""
    made = next((n for m in bpy.data.materials for n in (m.node_tree.nodes if m.node_tree else ())
                 if n.bl_idname == texture.bl_idname and n.baked), None)
    if made:
        texture.node_tree, texture.baked, texture.tile = made.node_tree, made.baked, made.tile
    else:
        bake(texture, "Metal", IMAGE, scratches)


def bake(texture, owner, image, scratches):
    tile, texels = image
    scratches.bake(texture, owner, bpy.context.scene, texels, tile=tile, points=True)


def metals(nodes, scratches):
    """(material, help, tags) of each metal."""
    for word, row in nodes.metals().items():
        name = row["label"].capitalize()
        material, tree, node = new_material(name, nodes.METAL)
        nodes.apply_preset(node, word)  # the strokes of brushed and turned ones are in the node
        if word.startswith("SCRATCHED"):
            node.grain = "UV"
            scratch(tree, node, scratches)
        yield material, row["help"], ["metal", *row["label"].lower().split()]


def cloths(fabric):
    for word, row in fabric.cloths().items():
        material, _tree, node = new_material(row["label"].capitalize(), fabric.FABRIC)
        node.preset, node.size = word, BALL_OF_CLOTH
        yield material, row["help"], ["cloth", "fabric", *row["label"].lower().split()]
        node.size_mode = "REAL"  # its picture is there


# By preset of the scratches: what the metal is called.
_SCRATCHED = {"FINE_POLISH": "Fine-polished steel", "BRUSHED": "Steel with brush strokes", "USED": "Used steel",
              "DEEP": "Deeply scratched steel"}


def scratched(nodes, scratches):
    """Polished steel and what scratched it, at 10 cm to a unit of the UV map; and each time the scratches alone."""
    for word, (label, help_, _values) in scratches.PRESETS.items():
        material, tree, node = new_material(_SCRATCHED[word], nodes.METAL)
        nodes.apply_preset(node, "BRUSHED_STEEL")
        node.strokes, node.grain = 0.0, "UV"
        node.distribution, node.brdf = "BECKMANN", "MICROFACET"
        node.inputs["Roughness"].default_value, node.inputs["Anisotropy"].default_value = 0.22, 0.0
        texture = tree.nodes.new(scratches.SCRATCHES)
        texture.location = (-280, 0)
        scratches.apply_preset(texture, word)
        bake(texture, label, IMAGES[word], scratches)
        tree.links.new(texture.outputs["Normal"], node.inputs["Normal"])
        tags = ["scratches", *label.lower().split()]
        yield material, help_, ["metal", "steel", *tags]
        yield scratch_group(texture.node_tree, f"{label} Scratches"), f"{help_}: normal, height, mask", tags


def scratch_group(baked, name):
    """The images of a node as a plain group, which needs no add-on, at 10 cm to a unit of the UV map times Scale."""
    tree = baked.copy()
    tree.name = name
    given = next(n for n in tree.nodes if n.bl_idname == "NodeGroupInput")
    inputs, remove = (([s for s in tree.interface.items_tree if s.in_out == "INPUT"], tree.interface.remove)
                      if hasattr(tree, "interface") else (list(tree.inputs), tree.inputs.remove))
    for socket in inputs:
        if socket.name not in ("Amount", "Normal"):
            remove(socket)
    place = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeUVMap").outputs[0].links[0].to_node
    from libshade.group import new_socket

    socket = new_socket(tree, "Scale", "INPUT", "NodeSocketFloat")
    socket.default_value, socket.description = 1.0, "1: 10 cm to a unit of the UV map; 2: scratches half as large"
    times = tree.nodes.new("ShaderNodeMath")
    times.operation, times.location = "MULTIPLY", (place.location[0] - 180, place.location[1] - 140)
    times.inputs[1].default_value = place.inputs["Scale"].default_value
    tree.links.new(given.outputs["Scale"], times.inputs[0])
    tree.links.new(times.outputs[0], place.inputs["Scale"])
    return tree


def bumpy(node, tree):
    """Waves about a ball that grooves are to follow."""
    place, wave, bump = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("UVMap", "TexWave", "Bump"))
    wave.inputs["Scale"].default_value, wave.inputs["Distortion"].default_value = 1.2, 3.0
    bump.inputs["Distance"].default_value = 0.06
    tree.links.new(place.outputs[0], wave.inputs["Vector"])
    tree.links.new(wave.outputs["Fac"], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], node.inputs["Normal"])


def groups(nodes, groove):
    """(group, material to show it by, help, tags): plain ones, which need no add-on."""
    material, tree, node = new_material("shown", nodes.METAL)
    nodes.apply_preset(node, "BRUSHED_STEEL")
    node.strokes, node.grain = 0.0, "UV"
    bumpy(node, tree)
    metal = node.node_tree.copy()
    metal.name = "Metal Whose Grooves Follow Bumps"
    yield metal, material, ("Brushed metal of Cycles' own shaders: color, roughness, anisotropy to 100 : 1, rotation, edge "
                            "tint; its strokes go with what is linked to Normal"), ["metal", "brushed"]
    yield groove.groove_tree(), material, ("Tangent of a bumped surface, for Anisotropic, Glossy and Principled BSDF: "
                                           "their strokes go with the bumps"), ["tangent", "normal"]


def save(folder, name, items):
    """Only these and what they use."""
    path = os.path.join(folder, name)
    bpy.data.libraries.write(path + ".part", set(items), fake_user=True, compress=True)
    os.replace(path + ".part", path)


def main(folder, sheet=None):
    os.makedirs(folder, exist_ok=True)
    pictures = []
    with tempfile.TemporaryDirectory() as scratch:
        path = os.path.join(scratch, "picture.png")
        for name, kind in (("metals", "Metals"), ("fabrics", "Fabrics"), ("grooves", "Grooves"), ("scratches", "Scratches")):
            ball = room(kind != "Fabrics")
            from libshade import fabric, groove, nodes, scratches  # what the add-on is now: room() enables it anew

            made = []
            if kind == "Grooves":
                for group, material, help_, tags in groups(nodes, groove):
                    mark(group, f"Libshade/{kind}", help_, tags)
                    pictures.append(picture_of(ball, material, path))
                    show(group, pictures[-1])
                    made.append(group)
            else:
                items = {"Metals": lambda: metals(nodes, scratches), "Fabrics": lambda: cloths(fabric),
                         "Scratches": lambda: scratched(nodes, scratches)}[kind]()
                for material, help_, tags in items:
                    mark(material, f"Libshade/{kind}", help_, tags)
                    # circles are seen from above their middle, and strokes along y from the side
                    ball.rotation_euler = (1.1, 0.2, 0.0) if "turned" in tags else (0.0, 0.0, 1.8) if "brushed" in tags and kind == "Metals" else (
                        0.35, 0.0, 0.5)
                    if isinstance(material, bpy.types.Material):  # else the group in the one before
                        pictures.append(picture_of(ball, material, path))
                    show(material, pictures[-1])
                    made.append(material)
            save(folder, f"{name}.blend", made)
    if sheet:
        write_sheet(pictures, sheet)
    path = os.path.join(folder, "blender_assets.cats.txt")
    with open(path + ".part", "w", encoding="utf-8") as file:
        file.write(catalogs())
    os.replace(path + ".part", path)


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if len(words) not in (1, 2):
        sys.exit("usage: blender -b … -P make_assets.py -- FOLDER [SHEET.png]")
    main(*words)
