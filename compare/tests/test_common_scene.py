# SPDX-License-Identifier: Apache-2.0
"""Scenes of examples as both renderers can show them (example_common.py), by stand-ins: what is changed, to what, and what is said of it."""
import json
from types import SimpleNamespace
from unittest.mock import MagicMock

import fake_blender
import numpy as np
import pytest

COST = 0.3

METAL, OUTPUT = "LibshadeMetalNode", "ShaderNodeOutputMaterial"


@pytest.fixture
def common():
    with fake_blender.imported("example_scene", "example_common") as (bpy, _scene, module):
        module.nodes = SimpleNamespace(SHAPE=("Roughness", "Anisotropy"), MATT_COLOR=("Diffuse Color",), EDGE=("Edge Tint",), fresnel_of=lambda node: "F82",
                                       lobe=lambda node: (0.1, 0.4), sockets_rule=lambda node, names: node.rules)
        module.metal_tree = SimpleNamespace(alphas_of=lambda roughness, anisotropy: (roughness / 10, anisotropy / 10))
        yield bpy, module


def shaded(kind=METAL, **values):
    """A material whose surface one node feeds, and the node."""
    made = fake_blender.material("brass")
    made.use_nodes = True
    node, output = (made.node_tree.nodes.new(name) for name in (kind, OUTPUT))
    made.node_tree.new(node.outputs["BSDF"], output.inputs["Surface"])
    node.strokes, node.horizon, node.rules, node.ax, node.ay, node.bl_label = 0.0, "HARD", False, 0.2, 0.3, kind
    for word, value in {"Rotation": 0.0, "Diffuse Color": (0.1, 0.2, 0.3, 1), "Edge Tint": (0.4, 0.5, 0.6, 1), **values}.items():
        node.inputs[word].default_value = value
    return made, node


def feed(material, node, name, kind):
    source = material.node_tree.nodes.new(kind)
    source.bl_label = kind
    material.node_tree.new(source.outputs["Color"], node.inputs[name])
    return source


def surface(material):
    return material.node_tree.get_output_node("ALL").inputs["Surface"].links[0].from_node


def test_what_was_changed_is_told_once(common):
    left = common[1].LeftOut()
    for what, name in (("soft lamps", "a"), ("depth of field", ""), ("soft lamps", "b"), ("soft lamps", "a")):
        left.say(what, name)
    assert left.texts() == ["soft lamps: a, b", "depth of field"]


def test_metals_keep_what_a_dump_can_say(common):
    module = common[1]
    made, node = shaded()
    node.strokes = 0.5
    for name in ("Color", "Roughness", "Anisotropy", "Diffuse Color", "Edge Tint", "Rotation", "Tangent", "Grit"):
        feed(made, node, name, "ShaderNodeValue")
    left = module.LeftOut()
    module.metal(made, node, left)
    assert [name for name, socket in node.inputs.items() if socket.is_linked] == ["Grit"]
    assert left.texts() == [*(f"what is linked to {name}: brass" for name in ("Color", "Roughness", "Anisotropy", "Diffuse Color", "Edge Tint", "Rotation", "Tangent")),
                            "strokes of the node, which no block of POV-Ray's has: brass"]
    assert (node.strokes, node.fresnel, node.kd, node.f82, node.ax, node.ay) == (0, "F82", (0.1, 0.2, 0.3), (0.4, 0.5, 0.6), 0.2, 0.3)


@pytest.mark.parametrize("rules, turn, widths, after", [(False, 0, (0.2, 0.3), 0), (False, 0.5, (0.2, 0.3), 0.5), (True, 0.5, (0.1, 0.4), 0.5), (False, 0.25, (0.3, 0.2), 0), (True, 1.75, (0.4, 0.1), 0)])
def test_a_quarter_turn_is_another_lobe(common, rules, turn, widths, after):
    module = common[1]
    made, node = shaded(Rotation=turn)
    node.rules, left = rules, module.LeftOut()
    module.metal(made, node, left)
    assert (node.ax, node.ay) == widths and node.inputs["Rotation"].default_value == after
    assert left.texts() == (["a quarter turn of Rotation, for which the lobe's two widths trade places: brass"] if turn % 0.5 else [])


@pytest.mark.parametrize("kind, horizon, kept, rule, said", [
    ("ShaderNodeNormalMap", "HARD", True, "HARD", []), ("ShaderNodeNormalMap", "MUTUAL", True, "VALID_ESTEVEZ", ["how bumps shade each other, by slopes that each renderer finds by itself: brass"]),
    ("ShaderNodeBump", "MUTUAL", False, "MUTUAL", ["ShaderNodeBump nodes, which no block of POV-Ray's has: brass"]), (None, "MUTUAL", False, "MUTUAL", [])])
def test_bumps_of_normal_maps_stay(common, kind, horizon, kept, rule, said):
    module = common[1]
    made, node = shaded()
    node.horizon, left = horizon, module.LeftOut()
    if kind:
        feed(made, node, "Normal", kind)
    module.bumps(made, node, left)
    assert (node.inputs["Normal"].is_linked, node.horizon, left.texts()) == (kept, rule, said)


def test_other_shaders(common):
    """Cycles' Anisotropic becomes our metal of its lobe, cloth loses what is linked, all else is matt; each by its kind."""
    bpy, module = common
    glossy, node = shaded("ShaderNodeBsdfAnisotropic", Color=(1, 2, 3, 1), Roughness=2.0, Anisotropy=5.0)
    bump = feed(glossy, node, "Normal", "ShaderNodeNormalMap")
    behind, second = shaded("ShaderNodeBsdfAnisotropic", Color=(1, 1, 1, 1), Roughness=1.0, Anisotropy=1.0)
    group = feed(behind, second, "Normal", "ShaderNodeGroup")
    feed(behind, group, "Normal", "ShaderNodeNormalMap")
    cloth, yarn = shaded("LibshadeFabricNode")
    feed(cloth, yarn, "Warp Color", "ShaderNodeTexImage")
    wood, _node = shaded("ShaderNodeBsdfPrincipled", **{"Base Color": (0.3, 0.2, 0.1, 1)})
    wood.name, wood.node_tree.nodes[0].bl_label = "wood", "Principled BSDF"
    bare = fake_blender.material("bare")
    bare.use_nodes = True
    bare.node_tree.nodes.new(OUTPUT)
    plain, unused = fake_blender.material("plain"), fake_blender.material("unused")
    unused.use_nodes = True
    bpy.data.materials, left = [glossy, behind, cloth, wood, bare, plain, unused], module.LeftOut()
    module.materials(left)
    for material, detail in ((glossy, "GRAM_SCHMIDT"), (behind, "ROTATE")):
        ours = surface(material)
        assert (ours.bl_idname, ours.distribution, ours.brdf, ours.fresnel, ours.detail) == (METAL, "GGX", "MICROFACET", "NONE", detail)
        assert (ours.strokes, ours.grain, ours.is_new, ours.horizon) == (0, "UV", False, "VALID_ESTEVEZ") and ours.inputs["Normal"].links[0].from_node.bl_idname == "ShaderNodeNormalMap"
    assert (surface(glossy).ax, surface(glossy).ay, surface(glossy).inputs["Color"].default_value) == (0.2, 0.5, (1, 2, 3, 1)) and surface(glossy).inputs["Normal"].links[0].from_node is bump
    assert surface(cloth) is yarn and not yarn.inputs["Warp Color"].is_linked
    for material, color in ((wood, (0.3, 0.2, 0.1)), (bare, (0.8, 0.8, 0.8))):
        assert (surface(material).bl_idname, surface(material).fresnel, surface(material).diffuse, surface(material).kd, surface(material).inputs["Color"].default_value) == (
            METAL, "NONE", "LAMBERT", color, (0, 0, 0, 1))
    assert left.texts() == ["Libshade Metal in place of Cycles' Anisotropic BSDF: brass", "what is linked to Warp Color: brass",
                            "matt in its base colour in place of Principled BSDF: wood", "matt in its base colour in place of no shader: bare"]
    assert not plain.node_tree.nodes and not unused.node_tree.nodes


def thing(name, faces, *modifiers, uv=True, kind="MESH"):
    class Modifiers(list):
        def new(self, name, kind):
            self.append(SimpleNamespace(name=name, type=kind))
            return self[-1]

        def __getitem__(self, key):
            return next(one for one in self if one.name == key) if isinstance(key, str) else list.__getitem__(self, key)
    return SimpleNamespace(name=name, type=kind, data=SimpleNamespace(polygons=range(faces), uv_layers=[1] if uv else []), modifiers=Modifiers(modifiers))


def test_meshes_that_pov_ray_can_read(common, monkeypatch):
    """As finely subdivided as 60,000 faces let it; what is finer already is thinned out; each has a UV map."""
    bpy, module = common
    fine, thick = SimpleNamespace(name="s", type="SUBSURF", render_levels=4, levels=1), SimpleNamespace(name="t", type="SOLIDIFY")
    coarse = SimpleNamespace(name="s", type="SUBSURF", render_levels=2, levels=1)
    head, cup, dune, bare, lamp, edge = thing("head", 500, fine), thing("cup", 3750, coarse, thick), thing("dune", 15001), thing("bare", 4, uv=False), thing("lamp", 99999, kind="LIGHT"), thing("edge", 15000)
    bpy.data.objects, left, mapped = [head, cup, dune, bare, lamp, edge], module.LeftOut(), []
    monkeypatch.setattr(module, "project", mapped.append)
    module.meshes(left)
    assert (fine.levels, fine.render_levels, coarse.levels, coarse.render_levels) == (3, 3, 2, 2) and [m.type for m in cup.modifiers] == ["SUBSURF"]
    assert [(m.type, m.decimate_type, m.iterations) for m in dune.modifiers] == [("DECIMATE", "UNSUBDIV", 2)] and not lamp.modifiers and not edge.modifiers and mapped == [bare.data]
    assert left.texts() == ["subdivided 3 times in place of 4: head", "the thickness of Solidify: cup", "meshes thinned out, to a quarter of their faces: dune",
                            "a UV map from above where there was none: bare"]


def test_a_map_from_above(common):
    points, corners, made = np.array([[1, 2, 10], [3, 4, 0], [5, 6, 100]]), np.array([2, 0]), MagicMock()

    def fill(values):
        return lambda _name, to: to.__setitem__(slice(None), values.ravel())
    mesh = MagicMock(vertices=MagicMock(foreach_get=fill(points)), loops=MagicMock(foreach_get=fill(corners)), uv_layers=made)
    mesh.vertices.__len__.return_value, mesh.loops.__len__.return_value = 3, 2
    common[1].project(mesh)
    name, uv = made.new.return_value.data.foreach_set.call_args.args
    assert name == "uv" and uv == pytest.approx([42, 43, 4.7, 5.7])


def test_lights_of_both(common):
    """All are sharp; an area lamp of Blender's is four times as bright straight below as a point of its watts."""
    bpy, module = common
    lamp = lambda name, kind, **more: SimpleNamespace(name=name, type="LIGHT", data=SimpleNamespace(type=kind, energy=10.0, **more))  # noqa: E731
    lamps = [lamp("panel", "AREA"), lamp("beam", "SPOT", shadow_soft_size=0.1), lamp("sun", "SUN", angle=0.1), lamp("sharp sun", "SUN", angle=0.0), lamp("bulb", "POINT", shadow_soft_size=0.2),
             lamp("spark", "POINT", shadow_soft_size=0.0)]
    bpy.data.objects, left = [*lamps, thing("ball", 4)], module.LeftOut()
    module.lights(left)
    assert [(item.data.type, item.data.energy) for item in lamps] == [("POINT", 40), ("POINT", 10), ("SUN", 10), ("SUN", 10), ("POINT", 10), ("POINT", 10)]
    assert all((item.data.angle if item.data.type == "SUN" else item.data.shadow_soft_size) == 0 for item in lamps)
    assert left.texts() == ["sharp points in place of area lamps and spots: panel, beam", "soft lamps as sharp ones: sun, bulb"]


@pytest.mark.parametrize("shaders, color", [([(True, 5.0, (1, 1, 1, 1)), (False, 0.5, (0.2, 0.4, 0.6, 1))], [0.1, 0.2, 0.3]), ([(True, 1.0, (1, 1, 1, 1))], (0, 0, 0)), ([], (0, 0, 0))])
def test_a_sky_becomes_a_plain_colour_and_a_sun(common, shaders, color):
    bpy, module = common
    own = SimpleNamespace(use_nodes=True, color=None, node_tree=SimpleNamespace(nodes=[SimpleNamespace(type="OUTPUT")]))
    for linked, strength, said in shaders:
        own.node_tree.nodes.append(SimpleNamespace(type="BACKGROUND", inputs={"Color": SimpleNamespace(is_linked=linked, default_value=said), "Strength": SimpleNamespace(default_value=strength)}))
    scene, left = MagicMock(world=own), module.LeftOut()
    module.world(scene, left)
    assert own.color == pytest.approx(color) and own.use_nodes is False and left.texts() == ["a sun in place of the sky"]
    item = scene.collection.objects.link.call_args.args[0]
    data = item.said[1]
    assert data.said == ("for the sky", "SUN") and (data.energy, data.angle, item.rotation_euler) == (1, 0, ((-0.4, -0.6, 0.8), "Z", "Y"))
    for none in (None, SimpleNamespace(use_nodes=False, color="kept")):
        scene = MagicMock(world=none)
        module.world(scene, left)
        assert not scene.collection.objects.link.called and (none is None or none.color == "kept")


def test_what_is_left(common, monkeypatch, tmp_path):
    """Both files; packed float pictures as files of their own, what is not focused and what is reflected twice gone."""
    bpy, module = common
    called = []
    for word in ("materials", "meshes", "lights"):
        monkeypatch.setattr(module, word, lambda left, word=word: called.append(word))
    monkeypatch.setattr(module, "world", lambda scene, left: called.append("world"))
    packed, drawn, outside = (MagicMock(packed_file=file, is_float=of) for file, of in ((SimpleNamespace(data=b"exr"), True), (SimpleNamespace(data=b"png"), False), (None, True)))
    packed.name = "bumps"
    bpy.data.images = MagicMock()
    bpy.data.images.__iter__.side_effect = lambda: iter([packed, drawn, outside])
    scene = bpy.context.scene
    scene.camera.data.dof.use_dof = True
    module.main(str(tmp_path))
    assert (tmp_path / "bumps.exr").read_bytes() == b"exr" and [path.name for path in tmp_path.iterdir() if path.suffix == ".exr"] == ["bumps.exr"]
    read = bpy.data.images.load.return_value
    bpy.data.images.load.assert_called_once_with(str(tmp_path / "bumps.exr"))
    packed.user_remap.assert_called_once_with(read)
    assert read.colorspace_settings.name == "Non-Color" and not drawn.user_remap.called and not outside.user_remap.called
    assert called == ["materials", "meshes", "lights", "world"] and scene.camera.data.dof.use_dof is False and (scene.libshade.max_bounces, scene.render.engine) == (0, "LIBSHADE")
    assert json.loads((tmp_path / "left_out.json").read_text()) == ["depth of field", "light that has met another surface"]
    bpy.ops.wm.save_as_mainfile.assert_called_once_with(filepath=str(tmp_path / "common.blend"), copy=True, relative_remap=True)


def test_an_example_is_built_without_its_picture(monkeypatch, tmp_path):
    """It finds its own arguments, renders nothing, and is saved as it is, then with each change of its metals alone."""
    script = tmp_path / "make.py"
    script.write_text("import sys, bpy\nbpy.ops.mesh.cube_add()\nassert bpy.ops.render.render(write_still=True) == {'FINISHED'}\n"
                      "def build(near, folder):\n    bpy.built = near, folder, sys.argv[sys.argv.index('--') + 1:]\n")
    (tmp_path / "variants.json").write_text(json.dumps({"wide": {"ax": 0.5}, "deep": {"detail": "NONE"}}))
    with fake_blender.imported("example_scene") as (bpy, scenes):
        monkeypatch.setattr("sys.argv", ["blender", "--", "a", "b"])
        metal, saved = SimpleNamespace(bl_idname=METAL, ax=0.1, detail="ROTATE"), []
        other = SimpleNamespace(bl_idname="ShaderNodeBsdfDiffuse")
        bpy.data.materials = [SimpleNamespace(use_nodes=True, node_tree=SimpleNamespace(nodes=[metal, other])), SimpleNamespace(use_nodes=False)]
        images = [MagicMock(source=source, is_dirty=dirty) for source, dirty in (("GENERATED", True), ("GENERATED", False), ("FILE", True))]
        bpy.data.images = images
        ops = bpy.ops
        ops.wm.save_as_mainfile.side_effect = lambda filepath, **_how: saved.append((filepath.rpartition("/")[2], metal.ax, metal.detail))
        scenes.main(str(script), str(tmp_path), str(tmp_path / "variants.json"))
        assert bpy.ops is ops and ops.mesh.cube_add.called and not ops.render.render.called
        assert bpy.built == (False, str(tmp_path), [str(tmp_path / "example.blend")])
        assert saved == [("scene.blend", 0.1, "ROTATE"), ("wide.blend", 0.5, "ROTATE"), ("deep.blend", 0.1, "NONE")]
        assert (bpy.context.scene.libshade.max_bounces, bpy.context.scene.render.engine, bpy.context.preferences.filepaths.save_version) == (0, "LIBSHADE", 0)
        assert images[0].pack.called and not images[1].pack.called and not images[2].pack.called
