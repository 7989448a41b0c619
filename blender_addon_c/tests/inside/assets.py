# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library of the installed add-on: in the preferences, and what comes out of it; asserts. argument: a folder,
for a picture of each of two"""

import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common


def module(name):
    return sys.modules[f"{common.MODULE}.{name}"]


def test_preferences():
    """Added once, repaired when its folder is gone, removed; others' libraries stay."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    ours, before = module("assets").FOLDER, [(item.name, item.path) for item in libraries]
    assert os.path.isdir(ours) and module("assets").registered() is None
    for _again in range(2):
        assert bpy.ops.libshade.add_assets() == {"FINISHED"}
        assert [(item.name, item.path) for item in libraries] == [*before, ("Libshade", ours)]
    assert getattr(libraries[-1], "import_method", "APPEND").startswith("APPEND")
    libraries[-1].path = os.path.join(os.path.dirname(ours), "gone", "assets")  # of a version before
    bpy.ops.preferences.addon_disable(module=common.MODULE)
    common.enable()
    assert [(item.name, item.path) for item in libraries] == [*before, ("Libshade", ours)]
    # a library of that name that is someone else's
    libraries[-1].path = os.path.dirname(ours)
    bpy.ops.preferences.addon_disable(module=common.MODULE)
    common.enable()
    assert libraries[-1].path == os.path.dirname(ours) and module("assets").registered() is None
    libraries[-1].path = ours
    assert bpy.ops.libshade.remove_assets() == {"FINISHED"} and bpy.ops.libshade.remove_assets() == {"CANCELLED"}
    assert [(item.name, item.path) for item in libraries] == before
    owner = bpy.context.preferences.addons[common.MODULE].preferences
    assert not module("assets").tells_timings() and not owner.timings
    owner.timings = True
    assert module("assets").tells_timings()
    owner.timings = False


def catalogs():
    """Path by identifier."""
    with open(os.path.join(module("assets").FOLDER, "blender_assets.cats.txt"), encoding="utf-8") as file:
        rows = [line.strip().split(":") for line in file if ":" in line]
    return {row[0]: row[1] for row in rows}


def appended(name, kind):
    with bpy.data.libraries.load(os.path.join(module("assets").FOLDER, name + ".blend"), assets_only=True) as (there, here):
        setattr(here, kind, getattr(there, kind))
    return getattr(here, kind)


def picture_of(item):
    pixels = np.array(item.preview.image_pixels_float[:]).reshape(*item.preview.image_size, 4)
    assert len(pixels) >= 128 and 0.5 < (pixels[..., 3] > 0.99).mean() < 0.8, item.name  # a ball
    return pixels[..., :3][pixels[..., 3] > 0.99].mean(0)


def linear_of(item):
    """Mean linear colour of what the picture does not clip."""
    picture_of(item)
    pixels = np.array(item.preview.image_pixels_float[:]).reshape(-1, 4)
    ball = pixels[pixels[:, 3] > 0.99, :3]
    pixels = ball[ball.max(axis=1) < 0.98]
    assert len(pixels) > max(0.9 * len(ball), 0.35 * item.preview.image_size[0] ** 2), f"{item.name}: a tenth is too bright, or little of it is seen"
    return np.where(pixels < 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4).mean(0)


def uneven(pixels):
    """(along y, along x): mean second difference."""
    return [np.abs(np.diff(pixels, 2, axis=axis)).mean() for axis in (0, 1)]


def tags_of(item):
    return [tag.name for tag in item.asset_data.tags]


def sockets_of(tree):
    """Inputs by name: (default, about)."""
    inputs = [s for s in tree.interface.items_tree if s.in_out == "INPUT"] if hasattr(tree, "interface") else tree.inputs
    return {s.name: (getattr(s, "default_value", None), s.description) for s in inputs}


def strokes_seen(item, finish):
    """On the ball's picture; without them all three are at most .0082 uneven and, low down, as much one way as the other (.98 to 1.02)."""
    pixels = np.array(item.preview.image_pixels_float[:]).reshape(*item.preview.image_size, 4)[..., :3].mean(-1)
    side = len(pixels)
    across, along = uneven(pixels[side // 8:3 * side // 8, side // 3:2 * side // 3])  # there strokes run along x
    if finish == "Scratched":
        return min(uneven(pixels[side // 6:5 * side // 6, side // 5:4 * side // 5])) > 0.02
    return across > (1.2 if finish == "Brushed" else 1.4) * along


def test_materials(folder):
    """Each is its preset as it is now, in its catalog, with a picture of its colour; two of them rendered."""
    common.empty_scene()
    nodes, fabric, where = module("nodes"), module("fabric"), catalogs()
    metals, cloths = appended("metals", "materials"), appended("fabrics", "materials")
    assert (len(metals), len(cloths)) == (len(nodes.metals()), len(fabric.cloths()))
    for word, row in nodes.metals().items():
        material = next(m for m in metals if m.name.lower() == row["label"].lower())
        node = next(n for n in material.node_tree.nodes if n.bl_idname == nodes.METAL)
        fresh = common.metal(word)[1].nodes.new(nodes.METAL)
        nodes.apply_preset(fresh, word)
        assert node.strokes == fresh.strokes == (not word.startswith("SCRATCHED"))
        assert node.grain == (fresh.grain if node.strokes else "UV")
        if row["label"].startswith("Scratched"):  # what is between scratches that are seen
            assert node.inputs["Normal"].is_linked and node.inputs["Roughness"].default_value < fresh.inputs["Roughness"].default_value
        else:
            assert nodes.settings(node) == nodes.settings(fresh)
            assert [tuple(a.default_value) if a.type == "RGBA" else a.default_value for a in list(node.inputs)[:6]] == [
                tuple(b.default_value) if b.type == "RGBA" else b.default_value for b in list(fresh.inputs)[:6]]
            assert not any(socket.is_linked for socket in node.inputs)
        assert where[material.asset_data.catalog_id] == "Libshade/Metals" and material.asset_data.description == row["help"]
        assert tags_of(material) == ["libshade", "metal", *row["label"].lower().split()]
        colour, metal = linear_of(material), np.array(tuple(node.inputs["Color"].default_value)[:3])
        assert strokes_seen(material, row["label"].split()[0]), word
        assert np.allclose(colour / colour[0], metal / metal[0], atol=0.06), (word, colour, metal)
    for word, row in fabric.cloths().items():
        material = next(m for m in cloths if m.name.lower() == row["label"].lower())
        node = next(n for n in material.node_tree.nodes if n.bl_idname == fabric.FABRIC)
        assert node.preset == word and where[material.asset_data.catalog_id] == "Libshade/Fabrics"
        assert material.asset_data.description == row["help"] and tags_of(material) == ["libshade", "cloth", "fabric", *row["label"].lower().split()]
        assert node.size_mode == "REAL"  # as large as what wears it
        picture_of(material)
    scratches = module("scratches")
    groups = appended("scratches", "node_groups")
    assert {group.name for group in groups} == {f"{label} Scratches" for label, _about, _values in scratches.PRESETS.values()}
    for group in groups:
        assert where[group.asset_data.catalog_id] == "Libshade/Scratches" and picture_of(group).mean() > 0.05
        assert not [n for n in group.nodes if n.bl_idname.startswith("Libshade")]
        assert {"libshade", "scratches"} < set(tags_of(group)) and not {"metal", "steel"} & set(tags_of(group)) and group.asset_data.description.endswith(": normal, height, mask")
        sockets = sockets_of(group)
        assert list(sockets) == ["Amount", "Normal", "Scale"] and sockets["Scale"] == (1.0, "1: 10 cm to a unit of the UV map; 2: scratches half as large"), sockets
        times = next(n for n in group.nodes if n.bl_idname == "NodeGroupInput").outputs["Scale"].links[0].to_node
        assert times.operation == "MULTIPLY" and times.outputs[0].links[0].to_socket.name == "Scale" and times.inputs[1].default_value > 0
    scratched = appended("scratches", "materials")
    assert len(scratched) == len(scratches.PRESETS)
    for material in scratched:
        node = next(n for n in material.node_tree.nodes if n.bl_idname == scratches.SCRATCHES)
        assert where[material.asset_data.catalog_id] == "Libshade/Scratches" and material.asset_data.description
        assert [values for _label, _about, values in scratches.PRESETS.values()
                if all(abs(node.inputs[name].default_value - value) < 1e-6 * value + 1e-9 for name, value in values.items())]
        assert node.outputs["Normal"].is_linked and picture_of(material).mean() > 0.05
        assert {"libshade", "metal", "steel", "scratches"} < set(tags_of(material))
        steel = node.outputs["Normal"].links[0].to_node  # polished, but for them
        assert (steel.strokes, steel.grain, steel.distribution, steel.brdf) == (0, "UV", "BECKMANN", "MICROFACET")
        assert np.allclose([steel.inputs[name].default_value for name in ("Roughness", "Anisotropy")], (0.22, 0)) and steel.outputs[0].links[0].to_socket.name == "Surface"
    scene = bpy.context.scene
    for name, found in (("Turned copper", metals), ("Cotton denim", cloths)):
        scene = common.empty_scene(32, 32, 16)
        material = appended("metals" if found is metals else "fabrics", "materials")
        material = next(m for m in material if m.name == name)
        common.plane(material)
        common.light(scene, rotation=(0.4, 0.2, 0))
        common.camera(scene)
        common.render(os.path.join(folder, f"{name}.exr"))


def test_groups():
    """Plain ones: nothing of ours inside, and the groove of a file that has it already is used."""
    common.empty_scene()
    groove, groups = module("groove").groove_tree(), appended("grooves", "node_groups")
    names = {group.name.split(".")[0] for group in groups}
    assert names == {"Libshade Groove", "Metal Whose Grooves Follow Bumps"}
    assert all(catalogs()[group.asset_data.catalog_id] == "Libshade/Grooves" for group in groups)
    for group in groups:
        assert not [n for n in group.nodes if n.bl_idname.startswith("Libshade")]
        assert tags_of(group) == ["libshade", *(("tangent", "normal") if group.name.startswith("Libshade") else ("metal", "brushed"))]
        assert len(group.asset_data.description) > 40
        picture_of(group)
    assert module("groove").groove_tree() == groove


folder, = common.arguments()
common.empty_scene()
test_preferences()
test_materials(folder)
test_groups()
print("all asserted", flush=True)
common.finish()
