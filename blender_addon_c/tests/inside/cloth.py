# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Fabric inside Blender: each socket against what it should do, by hand or as numbers and textures say the same;
older nodes. Leaves dumps in a folder for the reference: cloth.py FOLDER."""

import math
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402

folder, = common.arguments()
SIDE = 24


def cloth(preset="LINEN", sun=(0.5, 0.2, 0), **settings):
    """A new scene of a plate under a sun; (its tree, its node, the plate)."""
    scene = common.next_scene(SIDE, SIDE, samples=32)
    material = bpy.data.materials.new("cloth")
    tree = common.tree_of(material)
    tree.nodes.clear()
    node, output = tree.nodes.new("LibshadeFabricNode"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    node.preset = preset
    for name, value in settings.items():
        setattr(node, name, value)
    common.light(scene, rotation=sun)
    common.camera(scene, type="ORTHO", ortho_scale=1.9)
    return tree, node, common.plane(material)


def picture(dump=""):
    """What is rendered, from the bottom; dump: leave one of that name."""
    os.environ["LIBSHADE_DUMP"] = os.path.join(folder, dump + ".exr") if dump else ""
    path = os.path.join(folder, "picture.exr")
    common.render(path)
    image = bpy.data.images.load(path)
    pixels = np.array(image.pixels[:], np.float32).reshape(image.size[1], image.size[0], -1)
    bpy.data.images.remove(image)
    os.remove(path)
    return pixels


def feed(tree, node, name, value):
    """A number of the socket, through nodes that no one can work out beforehand."""
    place, apart, to = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("UVMap", "SeparateXYZ", "Math"))
    tree.links.new(place.outputs[0], apart.inputs[0])
    tree.links.new(apart.outputs[0], to.inputs[0])
    to.operation, to.inputs[1].default_value, to.inputs[2].default_value = "MULTIPLY_ADD", 1e-6, value
    tree.links.new(to.outputs[0], node.inputs[name])
    return to


def unfeed(tree, node, name):
    for link in list(node.inputs[name].links):
        tree.links.remove(link)


def difference(a, b):
    return np.abs(a - b).mean() / np.abs(b).mean()


def test_numbers_and_textures():
    """The same picture; and each socket changes it."""
    for name, value, sun in (("Gloss", 0.2, (0.1, 0.1, 0)), ("Fuzz", 1.5, (1.2, 0.2, 0)), ("Translucency", 0.6, (0.5, 0.2, 0)),
                             ("Translucency", 0.6, (math.pi - 0.5, 0.2, 0)), ("Alpha", 0.4, (0.5, 0.2, 0)),
                             ("Scale", 3.0, (0.5, 0.2, 0)), ("Rotation", 0.1, (0.9, 0.2, 0))):
        tree, node, _plate = cloth("SILK_SHANTUNG", sun, size=0.002)
        node.inputs["Alpha"].default_value = 0.9  # the rest is what the world shows
        before = picture()
        node.inputs[name].default_value = value
        said = picture()
        feed(tree, node, name, value)
        fed = picture()
        assert difference(fed, said) < (0.01 if name == "Translucency" else 2e-3), (name, difference(fed, said))
        assert np.abs(said - before).mean() > 0.02 * said.mean(), name
        if name == "Alpha":  # by hand
            assert np.allclose(said[..., 3], 0.4, atol=0.12) and abs(said[..., 3].mean() - 0.4) < 0.02
            assert difference(said[..., :3].mean((0, 1)) / 0.4, before[..., :3].mean((0, 1)) / 0.9) < 0.05
        if name == "Translucency" and sun[0] > 2:  # from behind, as much as that share
            assert before[..., :3].max() == 0
            node.inputs[name].links[0].from_node.inputs[2].default_value = 0.3
            assert difference(picture()[..., :3].mean(), said[..., :3].mean() / 2) < 0.02


def test_dumps():
    """For the reference: gloss and fuzz; the place on cloth that is turned, larger and fed."""
    tree, node, _plate = cloth("DENIM", size=0.001)
    node.inputs["Gloss"].default_value, node.inputs["Fuzz"].default_value = 0.3, 0.7
    picture("gloss")
    node.inputs["Rotation"].default_value, node.inputs["Scale"].default_value = 0.125, 1.4
    picture("turned")
    mapping, place = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeUVMap")
    mapping.inputs["Rotation"].default_value, mapping.inputs["Scale"].default_value = (0, 0, 0.4), (1.5, 1.5, 1)
    tree.links.new(place.outputs[0], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    picture("fed")


def test_vector():
    """Another UV map, and the object's own coordinates, are as the map itself where they say the same."""
    tree, node, ob = cloth("DENIM", size=0.002)
    first = ob.data.uv_layers[0].name
    own = picture()
    ob.data.uv_layers.new(name="turned")
    for loop in range(4):  # a quarter, as Rotation would have it
        u, v = ob.data.uv_layers[first].data[loop].uv
        ob.data.uv_layers["turned"].data[loop].uv = (v, -u)
    ob.data.uv_layers[first].active_render = True
    place = tree.nodes.new("ShaderNodeUVMap")
    place.uv_map = "turned"
    link = tree.links.new(place.outputs[0], node.inputs["Vector"])
    by_map = picture()
    tree.links.remove(link)
    node.inputs["Rotation"].default_value = 0.25
    by_turn = picture()
    assert difference(by_map, by_turn) < 2e-3, difference(by_map, by_turn)
    assert difference(by_turn, own) > 0.02
    node.inputs["Rotation"].default_value = 0.0
    coordinates, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value, mapping.inputs["Location"].default_value = (0.5, 0.5, 1), (0.5, 0.5, 0)
    tree.links.new(coordinates.outputs["Object"], mapping.inputs[0])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    assert difference(picture(), own) < 2e-3
    while ob.data.uv_layers:  # no map at all: its tangent is the object's x axis
        ob.data.uv_layers.remove(ob.data.uv_layers[0])
    assert difference(picture(), own) < 2e-3


def old(node):
    """As a node of a file from before these sockets: a tree with the numbers that its sockets had."""
    group = sys.modules[f"{common.MODULE}.group"]
    tree = bpy.data.node_groups.new("before", "ShaderNodeTree")
    for name, kind in (("Warp Color", "Color"), ("Weft Color", "Color"), ("Normal", "Vector")):
        group.new_socket(tree, name, "INPUT", f"NodeSocket{kind}")
    group.new_socket(tree, "BSDF", "OUTPUT", "NodeSocketShader")
    for name, kind in (("Mix", "MixRGB"), ("Darken", "MixRGB"), ("Principled BSDF", "BsdfPrincipled")):
        tree.nodes.new(f"ShaderNode{kind}").name = name
    for socket in node.inputs:
        if socket.type == "VALUE":
            socket.default_value = 0.0
    target = node.outputs[0].links[0].to_socket
    node.node_tree = tree
    node.id_data.links.new(node.outputs[0], target)
    assert [s.name for s in node.inputs] == ["Warp Color", "Weft Color", "Normal"]


def test_old_nodes():
    """Its properties count, before it is updated and after; sockets, links and colours stay."""
    tree, node, _plate = cloth("WOOL_FLANNEL")
    old(node)
    node.preset, node.size = "LINEN", 0.003
    node.preset = "WOOL_FLANNEL"
    node.transmission, node.open_gaps = 0.4, True
    node.inputs["Warp Color"].default_value = (0.5, 0.2, 0.1, 1)
    rgb = tree.nodes.new("ShaderNodeRGB")
    rgb.outputs[0].default_value = (0.2, 0.3, 0.4, 1)
    tree.links.new(rgb.outputs[0], node.inputs["Weft Color"])
    before = picture("old")
    assert bpy.ops.libshade.update_nodes() == {"FINISHED"} and "before" not in bpy.data.node_groups
    node = tree.nodes[node.name]
    inputs = node.inputs
    assert len(inputs) == 10 and abs(inputs["Translucency"].default_value - 0.4) < 1e-6
    assert abs(inputs["Fuzz"].default_value - 0.35) < 1e-6 and inputs["Weft Color"].links[0].from_node == rgb
    assert sum(s.is_linked for s in inputs) == 1 and node.outputs[0].is_linked
    assert difference(picture(), before) < 1e-6
    assert bpy.ops.libshade.update_nodes() == {"CANCELLED"}
    node.transmission = 0.1  # sets its socket
    assert abs(inputs["Translucency"].default_value - 0.1) < 1e-6
    inputs["Translucency"].default_value = 0.4  # and is not asked any more
    assert difference(picture(), before) < 1e-6


def test_real_size():
    """A metre of denim is 2600 ends wide: by the mesh before modifiers, the object's scale and the scene's unit."""
    tree, node, ob = cloth("DENIM")
    assert node.size_mode == "REAL"
    ob.scale, ob.location = (0.001, 0.001, 0.001), (0, 0, 0)
    camera = bpy.context.scene.camera
    camera.data.ortho_scale, camera.data.clip_start = 0.0019, 0.001
    plain = picture("real")
    for modifiers in (0, 1):  # in edit mode, where the mesh itself has no coordinates
        if modifiers:
            ob.modifiers.new("edges", "EDGE_SPLIT")
        bpy.ops.object.mode_set(mode="EDIT")
        assert difference(picture(), plain) < 2e-3
        assert bpy.ops.libshade.measure_cloth() == {"FINISHED"} and abs(ob["libshade_metres"] - 0.002) < 1e-6
        bpy.ops.object.mode_set(mode="OBJECT")
    ob.modifiers.clear()
    node.size = 0.002  # what a unit of the map spans now
    assert node.size_mode == "LENGTH" and difference(picture(), plain) < 2e-3
    node.size_mode = "REAL"
    for loop in ob.data.uv_layers[0].data:  # whatever the map's unit is
        loop.uv *= 3
    assert difference(picture(), plain) < 2e-3
    bpy.context.scene.unit_settings.scale_length = 0.5  # as large as half of that
    ob.modifiers.clear()
    node.inputs["Scale"].default_value = 2.0
    assert difference(picture(), plain) < 2e-3
    node.size = 0.002 / 3  # as long as the interface says, in the scene's unit
    assert node.size_mode == "LENGTH" and difference(picture(), plain) < 2e-3
    node.size_mode = "REAL"
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    shift = tree.nodes.new("ShaderNodeVectorMath")
    shift.inputs[1].default_value = (1, 1, 0)
    tree.links.new(coordinates.outputs["Object"], shift.inputs[0])
    tree.links.new(shift.outputs[0], node.inputs["Vector"])
    assert difference(picture(), plain) < 2e-3


def test_modifiers_stretch_cloth():
    """It is measured before they do: for the dump's reader."""
    _tree, _node, ob = cloth("DENIM")
    ob.scale = (0.001,) * 3
    bpy.context.scene.camera.data.ortho_scale, bpy.context.scene.camera.data.clip_start = 0.0019, 0.001
    key = ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="wide")
    for point in key.data:
        point.co.x *= 2
    key.value = 1.0
    picture("stretched")


def test_presets_and_numbers():
    """A preset fills every number in; an edit makes it custom and changes the picture, a preset again takes it back."""
    _tree, node, _plate = cloth("GABARDINE", size=0.0006)
    own = picture()
    yarns = sys.modules[f"{common.MODULE}.fabric.yarns"]
    native = sys.modules[f"{common.MODULE}._native"]
    row = native.cloth("gabardine")
    for yarn in ("warp", "weft"):
        for word in yarns.numbers():
            assert abs(getattr(node, f"{yarn}_{word}") - row[yarn][word]) <= 1e-6 * max(1, abs(row[yarn][word])), word
    assert (node.weave, node.based_on) == (row["weave"].upper(), "GABARDINE")
    for name, value in (("warp_width", 0.1), ("weft_gap", 0.8), ("warp_twist", 0.6), ("weft_crimp", 0.7), ("warp_slub", 0.9),
                        ("weft_vary_brightness", 0.8), ("warp_along_tilt", 0.5), ("ends_per_cm", 20.0), ("picks_per_cm", 60.0),
                        ("weave", "BASKET"), ("warp_along", 2.0)):
        node.preset = "GABARDINE"
        assert difference(picture(), own) < 1e-6, name
        setattr(node, name, value)
        assert node.preset == "CUSTOM" and node.based_on == "GABARDINE", name
        assert difference(picture("own_" + name), own) > 1e-3, name
    node.preset = "GABARDINE"
    node.warp_width = 0.4
    node.preset = "CUSTOM"
    assert abs(node.warp_width - 0.4) < 1e-6
    node.weave, node.distance = "PLAIN", "FAR"
    far = picture()
    assert np.std(far[4:-4, 4:-4, :3].mean(-1)) < 0.02 * far.mean()


def test_keyframes():
    """Properties that keyframes set reach what is inside: a number, a picture, a socket, which then may say something else."""
    seen = {"size": lambda node: node.node_tree.nodes["Place"].inputs["Per Unit"].default_value[0],
            "warp_width": lambda node: node.node_tree.nodes["yarns"].image["libshade_cloth"],
            "transmission": lambda node: node.inputs["Translucency"].default_value}
    _tree, node, _plate = cloth("LINEN")
    told = []
    for frame, values in ((1, (0.01, 0.3, 0.1)), (11, (0.05, 0.8, 0.6))):
        for name, value in zip(seen, values):
            setattr(node, name, value)
            node.keyframe_insert(name, frame=frame)
        told.append([look(node) for look in seen.values()])
    assert not set(told[0]) & set(told[1])
    for frame, expected in ((1, told[0]), (11, told[1]), (1, told[0])):
        bpy.context.scene.frame_set(frame)
        assert [look(node) for look in seen.values()] == expected, frame
    node.inputs["Translucency"].default_value = 0.3
    bpy.context.scene.frame_set(11)
    assert abs(node.inputs["Translucency"].default_value - 0.3) < 1e-6


WIF = """[WIF]
Version=1.1
[WEAVING]
Shafts=3
Treadles=3
[WARP]
Threads=4
Color=2
Thickness=.04
Spacing=.05
Units=centimeters
[WEFT]
Threads=3
Color=1
Thickness=.07
Spacing=.1
Units=centimeters
[COLOR PALETTE]
Range=0,255
Entries=2
[COLOR TABLE]
1=255,255,255
2=200,40,60
[THREADING]
1=1
2=2
3=3
4=1
[TIEUP]
1=1,2
2=2
3=1,3
[TREADLING]
1=1
2=2
3=3
"""


def weft_share(node):
    """Of the middles of crossings, in the picture that is inside for other renderers."""
    image = node.node_tree.nodes["yarns"].image
    width, height = image.size
    seen = np.array(image.pixels[:], np.float32).reshape(height, width, 4)[16::32, 16::32]
    return (seen[..., 1] > seen[..., 0]).mean()


def import_wif(node, name, text, encoding="utf-8"):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(text.encode(encoding))
    material = next((m.name for m in bpy.data.materials if m.node_tree == node.id_data), "")
    group = "" if material else node.id_data.name
    try:
        return bpy.ops.libshade.import_wif(filepath=path, material=material, group=group, node=node.name)
    finally:
        os.remove(path)


def test_drafts():
    """Import, in several encodings; what it says of yarns; a bad file by name and line, and nothing changes; an edited
    Text is another picture."""
    tree, node, _plate = cloth("LINEN", size=0.002)
    own = picture()
    assert import_wif(node, "three.wif", WIF.replace("\n", "\r\n")) == {"FINISHED"}
    assert node.preset == "CUSTOM" and node.weave == "DRAFT" and node.draft.as_string().startswith("[WIF]\nVersion")
    assert abs(node.ends_per_cm - 20) < 1e-4 and abs(node.picks_per_cm - 10) < 1e-4
    assert abs(node.warp_width - 0.8) < 1e-6 and abs(node.warp_gap - 0.2) < 1e-6
    assert abs(node.weft_width - 0.7) < 1e-6 and abs(node.weft_gap - 0.3) < 1e-6
    assert abs(weft_share(node) - 5 / 12) < 1e-6
    drawn = picture("draft")
    assert difference(drawn, own) > 0.05
    assert import_wif(node, "wide.wif", WIF, "utf-16") == {"FINISHED"} and difference(picture(), drawn) < 1e-6
    text, bad = node.draft, WIF.replace("3=3\n4=", "3=two\n4=")
    line = bad[:bad.index("3=two")].count("\n") + 1
    try:
        import_wif(node, "bad.wif", bad)
        raise AssertionError("a bad file was taken")
    except RuntimeError as error:
        assert f"bad.wif, line {line}: " in str(error), error
    assert node.draft == text and len(bpy.data.texts) == 2
    inside = bpy.data.node_groups.new("cloth inside", "ShaderNodeTree").nodes.new("LibshadeFabricNode")
    assert import_wif(inside, "three.wif", WIF) == {"FINISHED"} and inside.weave == "DRAFT"
    try:
        bpy.ops.libshade.import_wif(filepath=os.path.join(folder, "gone.wif"), group="cloth inside", node=inside.name)
        raise AssertionError("a file that is not there was taken")
    except RuntimeError as error:
        assert "gone.wif: No such file or directory" in str(error), error
    draft = sys.modules[f"{common.MODULE}.fabric.draft"]
    draft.follow()
    text.from_string(WIF.replace("1=1,2\n2=2", "1=1,2,3\n2=2,3"))
    assert draft.follow() > 0 and difference(picture(), drawn) > 0.02
    assert abs(weft_share(node) - 3 / 12) < 1e-6
    text.from_string(bad)
    report = sys.modules[f"{common.MODULE}.report"]
    assert picture().mean() > 0.01
    assert any(f"'{node.name}': {text.name}, line {line}: " in said for said, _error in report.told(bpy.context.scene))
    node.draft = None
    picture()
    assert any("no draft is chosen" in said for said, _error in report.told(bpy.context.scene))


def test_a_draft_goes_with_its_material():
    """Into a file, by appending and by linking; undo takes an import back."""
    _tree, node, _plate = cloth("LINEN")
    assert import_wif(node, "three.wif", WIF) == {"FINISHED"}
    path = os.path.join(folder, "cloth.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    for link in (False, True):
        common.empty_scene()
        with bpy.data.libraries.load(path, link=link) as (there, taken):
            taken.materials = there.materials
        node = next(n for n in taken.materials[0].node_tree.nodes if n.bl_idname == "LibshadeFabricNode")
        assert node.draft and node.draft.as_string().startswith("[WIF]") and node.weave == "DRAFT", link
        assert bool(node.draft.library) == link
    _tree, node, _plate = cloth("LINEN")
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    name, material = node.name, next(m.name for m in bpy.data.materials if m.node_tree == node.id_data)
    assert import_wif(node, "three.wif", WIF) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="imported")
    bpy.ops.ed.undo()
    node = bpy.data.materials[material].node_tree.nodes[name]
    assert node.preset == "LINEN" and not node.draft
    bpy.ops.ed.redo()
    node = bpy.data.materials[material].node_tree.nodes[name]
    assert node.preset == "CUSTOM" and node.draft and node.draft.as_string().startswith("[WIF]")
    os.remove(path)


for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__, "done", flush=True)
print("all asserted")
common.finish()
