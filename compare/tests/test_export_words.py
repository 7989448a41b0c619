# SPDX-License-Identifier: Apache-2.0
"""What export_povray.py writes of each part, and which parts it refuses, by stand-ins for Blender; test_end_to_end.py exports real files."""
import re
from types import SimpleNamespace
from unittest.mock import MagicMock

import fake_blender
import numpy as np
import pytest

COST = 0.2

METAL = "LibshadeMetalNode"


@pytest.fixture(scope="module")
def export():
    with fake_blender.imported("export_povray") as (bpy, module):
        bpy.app.version, bpy.app.version_string = (3, 4, 1), "3.4.1"
        yield bpy, module


def refused(module, words):
    return pytest.raises(module.ExportError, match=words)


def test_numbers_and_names(export):
    module, taken = export[1], set()
    assert [module.number(value) for value in (0.1, 1, 1e-7, 1 / 3)] == ["0.1", "1.0", "1e-07", "0.33333334"]
    assert module.vector((1, 0.5, 0.1)) == "<1.0, 0.5, 0.1>" and module.swapped((1, 2, 3)) == (1, 3, 2)
    assert [module.identifier("Mesh", name, taken) for name in ("a b", "a.b", "a_b", "ä", "c")] == ["Mesh_a_b", "Mesh_a_b_2", "Mesh_a_b_3", "Mesh__", "Mesh_c"]


def test_meshes_as_text(export):
    """Corners with the same normal or coordinates share one; y and z trade places; each triangle names its texture where there are several."""
    module = export[1]
    arrays = (np.array([[0, 1, 2], [3, 4, 5], [6, 7, 8.5]], np.float32), np.array([[0, 0, 1]] * 5 + [[0, 1, 0]], np.float32), np.array([[0, 0], [1, 0], [0, 1]] * 2, np.float32),
              np.array([0, 1, 2, 2, 1, 0], np.int32), np.array([0, 7], np.int32))
    one = module.mesh_text(arrays, ["Metal_A"])
    assert "vertex_vectors { 3,\n<0, 2, 1>,\n<3, 5, 4>,\n<6, 8.5, 7>\n}" in one and "normal_vectors { 2,\n<0, 1, 0>,\n<0, 0, 1>\n}" in one
    assert "face_indices { 2,\n<0, 1, 2>,\n<2, 1, 0>\n}" in one and "normal_indices { 2,\n<0, 0, 0>,\n<0, 0, 1>\n}" in one and one.startswith("mesh2 {\n") and one.endswith("texture { Metal_A }\n}")
    assert "uv_vectors { 3,\n<0, 0>,\n<0, 1>,\n<1, 0>\n}" in one and "uv_indices { 2,\n<0, 2, 1>,\n<0, 2, 1>\n}" in one
    two = module.mesh_text(arrays, ["Metal_A", "Metal_B"])
    assert "texture_list { 2, texture { Metal_A }, texture { Metal_B } }" in two and "face_indices { 2,\n<0, 1, 2>, 0,\n<2, 1, 0>, 1\n}" in two and "texture { Metal_A }\n}" not in two


def test_places_as_text(export):
    """The images of POV-Ray's x, y and z, which are Blender's x, z and y, and of the origin."""
    module = export[1]
    matrix = fake_blender.Matrix([[1, 2, 3, 10], [4, 5, 6, 20], [7, 8, 9, 30], [0, 0, 0, 1]])
    assert module.matrix_text(matrix) == "matrix <1.0, 7.0, 4.0, 3.0, 9.0, 6.0, 2.0, 8.0, 5.0, 10.0, 30.0, 20.0>"
    half = module.rotation((2 * np.cos(np.pi / 6), 0, 0, 2 * np.sin(np.pi / 6)))  # 60° about z, not unit
    assert half == pytest.approx(np.array([[0.5, -(3**0.5) / 2, 0], [3**0.5 / 2, 0.5, 0], [0, 0, 1]]))
    turn = np.array([0.5, 0.1, -0.7, 0.4])
    turn /= np.linalg.norm(turn)
    w, v = turn[0], turn[1:]
    for axis in np.eye(3):  # Rodrigues
        assert module.rotation(turn) @ axis == pytest.approx(axis + 2 * w * np.cross(v, axis) + 2 * np.cross(v, np.cross(v, axis)))


def camera(kind, corners):
    data = SimpleNamespace(type=kind, dof=SimpleNamespace(use_dof=False), view_frame=lambda scene: corners)
    return SimpleNamespace(name="eye", data=data, matrix_world=SimpleNamespace(decompose=lambda: ((1, 2, 3), (1, 0, 0, 0), None)))


def test_cameras(export):
    """By the corners of its picture: right and up are as wide and high, direction leads to the middle."""
    module = export[1]
    corners = [(3, 2, -5), (3, -1, -5), (-1, -1, -5), (-1, 2, -5)]
    text = module.camera_text(None, camera("PERSP", corners))
    assert text == "camera {\n  perspective\n  location <1.0, 3.0, 2.0>\n  direction <1.0, -5.0, 0.5>\n  right <4.0, 0.0, 0.0>\n  up <0.0, 0.0, 3.0>\n}\n"
    text = module.camera_text(None, camera("ORTHO", corners))
    assert "orthographic\n  location <2.0, 3.0, 2.5>\n  direction <0.0, -1.0, 0.0>\n  right <4.0" in text
    soft = camera("PERSP", corners)
    soft.data.dof.use_dof = True
    for wrong in (soft, camera("PANO", corners)):
        with refused(module, "camera 'eye': only sharp perspective or orthographic"):
            module.camera_text(None, wrong)


def lamp(kind):
    data = SimpleNamespace(type=kind, energy=4.0, color=(1, 0.5, 0.25), use_nodes=False, use_shadow=True, angle=0.0, shadow_soft_size=0.0)
    return SimpleNamespace(name="lamp", data=data, original=SimpleNamespace(data=SimpleNamespace()))


def test_lights(export):
    """A sun's irradiance over π, from afar; a point's W by 4π, and by twice π times the square of where it begins to fade."""
    module = export[1]

    class Turn:
        def __matmul__(self, v):
            assert tuple(v) == (0, 0, 1)
            return SimpleNamespace(normalized=lambda: np.array((0, 0.6, 0.8)))
    matrix = SimpleNamespace(to_3x3=Turn, translation=(1, 2, 3))
    numbers = lambda text: np.array([[float(x) for x in part.split(",")] for part in re.findall("<(.*?)>", text)])  # noqa: E731
    text = module.light_text(lamp("SUN"), matrix, 2.0)
    assert numbers(text) == pytest.approx(np.array([[0, 160, 120], [4 / np.pi, 2 / np.pi, 1 / np.pi]])) and "parallel point_at 0" in text
    text = module.light_text(lamp("POINT"), matrix, 2.0)
    fade = 2e-4
    assert numbers(text) == pytest.approx(np.array([[1, 3, 2], np.array((4, 2, 1)) / (8 * np.pi**2 * fade**2)]), rel=1e-6) and "fade_distance 0.0002 fade_power 2" in text
    for change, words in (({"angle": 0.1}, "only sharp sun and point lights"), ({"use_nodes": True}, "nodes cannot be written"), ({"use_shadow": False}, "it casts no shadow"), ({"type": "SPOT"}, "only sharp sun")):
        wrong = lamp("SUN")
        vars(wrong.data).update(change)
        with refused(module, f"light 'lamp': {words}"):
            module.light_text(wrong, matrix, 1.0)
    soft = lamp("POINT")
    soft.data.shadow_soft_size = 0.1
    with refused(module, "only sharp sun and point lights"):
        module.light_text(soft, matrix, 1.0)


def test_the_size_of_a_scene(export):
    module = export[1]

    class Moved:
        def __init__(self, by):
            self.by = by

        def __matmul__(self, corner):
            return SimpleNamespace(length=np.linalg.norm(np.add(corner, self.by)))
    thing = SimpleNamespace(bound_box=[(0, 0, 0), (3, 4, 0)])
    assert module.scene_size([(thing, Moved((0, 0, 0)))]) == 5 and module.scene_size([(thing, Moved((0, 0, 0))), (thing, Moved((0, 0, 12)))]) == 13


def bumped(module, tmp_path):
    """A material with a map that can be written; (material, Normal Map, texture, image)."""
    (tmp_path / "map.png").touch()
    made = fake_blender.material("steel")
    metal, node, texture = (made.node_tree.nodes.new(kind) for kind in (METAL, "ShaderNodeNormalMap", "ShaderNodeTexImage"))
    for one in (metal, node, texture):
        one.name = one.bl_idname
    node.space, node.inputs["Strength"].default_value, texture.extension, texture.interpolation = "TANGENT", 0.5, "REPEAT", "Linear"
    texture.image = SimpleNamespace(name="map", filepath=str(tmp_path / "map.png"), file_format="PNG", packed_file=None, colorspace_settings=SimpleNamespace(name="Non-Color", is_data=True))
    made.node_tree.new(node.outputs["Normal"], metal.inputs["Normal"])
    made.node_tree.new(texture.outputs["Color"], node.inputs["Color"])
    return made, metal, node, texture


def link(made, node, name, kind="ShaderNodeValue"):
    source = made.node_tree.nodes.new(kind)
    source.name = "Other"
    made.node_tree.new(source.outputs["Value"], node.inputs[name])


@pytest.mark.parametrize("change, words", [
    (lambda made, metal, node, texture: link(made, metal, "Normal"), "expected a ShaderNodeNormalMap node, found 'Other'"),
    (lambda made, metal, node, texture: link(made, node, "Color"), "expected a ShaderNodeTexImage node, found 'Other'"),
    (lambda made, metal, node, texture: node.inputs["Color"].links.clear(), "the Normal Map node has no image"), (lambda made, metal, node, texture: setattr(texture, "image", None), "the Normal Map node has no image"),
    (lambda made, metal, node, texture: setattr(node, "space", "OBJECT"), "only tangent space and a plain strength"), (lambda made, metal, node, texture: link(made, node, "Strength"), "only tangent space and a plain strength"),
    (lambda made, metal, node, texture: link(made, texture, "Vector"), "only a repeating image on the plain UV map"), (lambda made, metal, node, texture: setattr(texture, "extension", "CLIP"), "only a repeating image"),
    (lambda made, metal, node, texture: setattr(texture.image, "packed_file", b"x"), "must be a PNG or OpenEXR file"), (lambda made, metal, node, texture: setattr(texture.image, "file_format", "JPEG"), "must be a PNG or OpenEXR file"),
    (lambda made, metal, node, texture: setattr(node.inputs["Strength"], "default_value", 1.5), "Blender 3.4.1 mixes normals by the strength, 1.5; POV-Ray's multiplies slopes")])
def test_maps_that_cannot_be_written(export, tmp_path, change, words):
    bpy, module = export
    bpy.path.abspath = lambda path: path
    made, metal, node, texture = bumped(module, tmp_path)
    change(made, metal, node, texture)
    with refused(module, f"material 'steel', Normal: .*{words}"):
        module.bump_image(metal.inputs["Normal"], made, str(tmp_path))


def test_maps_that_can(export, tmp_path, monkeypatch):
    bpy, module = export
    bpy.path.abspath = lambda path: path
    made, metal, node, texture = bumped(module, tmp_path)
    assert module.bump_image(metal.inputs["Normal"], made, str(tmp_path / "out")) == '\n      bump_image { png "../map.png" strength 0.5 filter off }'
    texture.image.file_format = "OPEN_EXR"
    node.inputs["Strength"].default_value = 1
    assert '{ exr "../map.png" strength 1.0 filter off }' in module.bump_image(metal.inputs["Normal"], made, str(tmp_path / "out"))
    monkeypatch.setattr(bpy.app, "version", (3, 5, 0))
    node.inputs["Strength"].default_value = 1.5
    assert "strength 1.5" in module.bump_image(metal.inputs["Normal"], made, str(tmp_path))
    assert module.bump_image(metal.inputs["Other"], made, str(tmp_path)) == ""


def strokes(grain, turn=0.0, uv_map=""):
    node = fake_blender.Nodes().new(METAL)
    node.grain, node.uv_map, node.inputs["Rotation"].default_value = grain, uv_map, turn
    return node


@pytest.mark.parametrize("node, said", [
    (strokes("UV"), ("tangent uv", "")), (strokes("UV", 0.5), ("tangent uv", "rotate 180*z")), (strokes("UV", 2.0), ("tangent uv", "")), (strokes("UV", -0.5), ("tangent uv", "rotate 180*z")),
    (strokes("RADIAL_X"), ("tangent radial <-1.0, -0.0, -0.0> at <1.0, 3.0, 2.0>", "")), (strokes("RADIAL_Z"), ("tangent radial <-0.0, -1.0, -0.0> at <1.0, 3.0, 2.0>", "")),
    (strokes("RADIAL_Y", 0.5), ("tangent radial <0.0, 0.0, 1.0> at <1.0, 3.0, 2.0>", "")), (strokes("AXIS_Z"), ("tangent <1.0, 3.0, 2.0>", "")), (strokes("AXIS_Z", 0.5), ("tangent <-1.0, -3.0, -2.0>", ""))])
def test_how_strokes_run(export, monkeypatch, node, said):
    """Round an axis the other way, since the world is mirrored; half a turn turns them round."""
    module = export[1]
    monkeypatch.setattr(module.metal_tree, "axis_vector", {"Z": (1, 2, 3)}.__getitem__, raising=False)
    assert module.tangent_text(node, (1, 2, 3), "it") == said


def test_strokes_that_cannot_be_written(export):
    module = export[1]
    made = fake_blender.material("steel")
    for name in ("Tangent", "Rotation"):
        node = strokes("UV")
        link(made, node, name)
        with refused(module, f"it, {name}: "):
            module.tangent_text(node, (0, 0, 0), "it")
    with refused(module, "it, Rotation: only whole and half turns can be written"):
        module.tangent_text(strokes("UV", 0.25), (0, 0, 0), "it")
    with refused(module, "it, UV Map: only strokes along the active one can be written"):
        module.tangent_text(strokes("UV", 0, "Second"), (0, 0, 0), "it")


@pytest.mark.parametrize("grain, sizes, middle", [("RADIAL_Z", (2, 2, 9), (1, 2, 3)), ("RADIAL_X", (9, 2, 2.001), (1, 2, 3)), ("RADIAL_Z", (2, 2.1, 2), None), ("UV", (2, 5, 9), (0, 0, 0))])
def test_where_strokes_have_their_axis(export, monkeypatch, grain, sizes, middle):
    module = export[1]
    monkeypatch.setattr(module, "fabric_of", lambda _material: None)
    monkeypatch.setattr(module, "metal_of", lambda _material: SimpleNamespace(grain=grain))
    mesh = SimpleNamespace(name="pot", texspace_size=sizes, texspace_location=(1, 2, 3))
    if middle:
        assert module.middle_of(mesh, SimpleNamespace(name="steel")) == middle
    else:
        with refused(module, "material 'steel' on mesh 'pot': strokes round an axis are ellipses there"):
            module.middle_of(mesh, SimpleNamespace(name="steel"))
    monkeypatch.setattr(module, "fabric_of", lambda _material: "cloth")
    assert module.middle_of(mesh, SimpleNamespace(name="steel")) == (0, 0, 0)


def test_a_block_has_what_each_choice_reads(export, monkeypatch):
    """The distribution's word alone, then each list's word with its numbers, then what every metal has; not f0."""
    module = export[1]
    row = lambda word, components=1, read_by=None: {"word": word, "components": components, "read_by": read_by}  # noqa: E731
    monkeypatch.setattr(module._native, "table", lambda: {"lists": ["mdf", "detail"], "params": [
        row("ex", 1, ("mdf", ["ashikhmin_shirley"])), row("ey", 1, ("mdf", ["ashikhmin_shirley"])), row("ax", 1, ("mdf", ["ggx"])), row("f0", 3), row("kd", 3, ("detail", ["rotate"])), row("tilt")]}, raising=False)
    said = {"mdf": "ashikhmin_shirley", "detail": "rotate", "ex": 7, "ey": 8, "ax": 9, "f0": (1, 1, 1), "kd": (0.5, 0.25, 1), "tilt": 3}
    assert module.choices_text(said) == "ashikhmin_shirley 7.0, 8.0\n      detail rotate rgb <0.5, 0.25, 1.0>\n      tilt 3.0"
    assert module.choices_text({**said, "mdf": "ggx", "detail": "none"}) == "ggx 9.0\n      detail none\n      tilt 3.0"


def scene_with(module, items, camera):
    graph = SimpleNamespace(scene_eval=MagicMock(camera=camera or None), object_instances=items)
    module.bpy.context.evaluated_depsgraph_get = lambda: graph
    module.bpy.types.Mesh = SimpleNamespace


def item(kind="MESH", hidden=False, polygons=(1,), slots=(), parent=None):
    thing = SimpleNamespace(type=kind, hide_render=hidden, name="ball", data=SimpleNamespace(polygons=polygons), material_slots=[SimpleNamespace(material=one) for one in slots])
    return SimpleNamespace(show_self=True, object=thing, parent=parent, matrix_world=np.eye(4))


@pytest.mark.parametrize("items, camera, words", [
    ([], False, "the scene has no camera"), ([item("LIGHT")], True, "the scene has no mesh"), ([item()], True, "the scene has no light"), ([item(hidden=True), item("LIGHT")], True, "the scene has no mesh"),
    ([item(polygons=()), item("LIGHT")], True, "the scene has no mesh"), ([item(parent=SimpleNamespace(hide_render=True)), item("LIGHT")], True, "the scene has no mesh"),
    ([item(), item("LIGHT")], True, "object 'ball': an empty material slot"), ([item(slots=[None]), item("LIGHT")], True, "object 'ball': an empty material slot")])
def test_scenes_without_what_is_needed(export, tmp_path, items, camera, words):
    module = export[1]
    scene_with(module, items, camera)
    with refused(module, words):
        module.export(str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def metal(module, monkeypatch, said, **change):
    node = strokes("UV")
    node.strokes, node.bump_response, node.horizon, node.bumps_are, node.inputs["Color"].default_value = 0.0, "FOLLOW", "HARD", "RELIEF", (0.5, 0.25, 1, 1)
    vars(node).update(change)
    monkeypatch.setattr(module, "metal_of", lambda _material: node)
    monkeypatch.setattr(module, "fabric_of", lambda _material: None)
    monkeypatch.setattr(module, "settings_of", lambda _node, _what: {"fresnel": "schlick", "diffuse": "lambert", "kd": (0, 0, 0), **said})
    monkeypatch.setattr(module, "choices_text", lambda _said: "ggx 1")
    monkeypatch.setattr(module, "bump_image", lambda *_given: " BUMP")
    return node, lambda: module.texture_text(SimpleNamespace(name="steel"), "folder", (0, 0, 0))


def test_metals_as_text(export, monkeypatch):
    """The colour is a socket; a conductor has none; bumps that are not followed are not written."""
    module = export[1]
    node, text = metal(module, monkeypatch, {})
    assert "ggx 1\n      specular rgb <0.5, 0.25, 1.0>\n      tangent uv BUMP\n" in text() and "ambient 0 diffuse 0" in text()
    node.bump_response = "IGNORE"
    assert "BUMP" not in text()
    node.bump_response, node.inputs["Rotation"].default_value = "FOLLOW", 0.5
    assert text().endswith("  }\n  rotate 180*z\n}")
    node.horizon = "MUTUAL"
    assert "BUMP" in text()
    node.bumps_are = "SHAPE"
    with refused(module, "material 'steel', Bumps Are: no block of POV-Ray's has a Shape; set it to Relief to write the rest"):
        text()
    assert "specular" not in metal(module, monkeypatch, {"fresnel": "conductor"})[1]() and "specular" not in metal(module, monkeypatch, {"fresnel": "conductor", "diffuse": "ashikhmin_shirley"})[1]()
    with refused(module, "a conductor with the diffuse part of Ashikhmin and Shirley"):
        metal(module, monkeypatch, {"fresnel": "conductor", "diffuse": "ashikhmin_shirley", "kd": (0, 0.1, 0)})[1]()
    with refused(module, "Strokes: no block of POV-Ray's has them; set Strokes to 0 to write the rest"):
        metal(module, monkeypatch, {}, strokes=0.1)[1]()
    node, text = metal(module, monkeypatch, {})
    link(fake_blender.material("steel"), node, "Color")
    with refused(module, "a textured Color cannot be written"):
        text()
