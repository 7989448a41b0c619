# SPDX-License-Identifier: Apache-2.0
"""The plate as each renderer is given it, by stand-ins for Blender and Mitsuba: surfaces, metals, light, camera, turns."""
import json
import re
import sys
from types import SimpleNamespace
from unittest.mock import MagicMock

import fake_blender
import numpy as np
import plate
import programs
import pytest
import sphere

COST = 0.2

JOB = {"surface": "bumped", "engine": "LIBSHADE", "size": 48, "samples": 4, "quads": 3, "repeat": 1, "output": ""}


def read(name):
    """A script as far as its functions, which stand without its renderer."""
    path = programs.HERE / f"{name}.py"
    text, given = path.read_text(encoding="utf-8"), {"__file__": str(path), "__name__": name}
    exec(compile(re.split(r"^main\(", text, flags=re.M)[0], str(path), "exec"), given)  # noqa: S102
    return SimpleNamespace(**given), given


@pytest.fixture
def blender():
    with fake_blender.imported() as (bpy,):
        bpy.app.version = (3, 4, 1)
        yield bpy, *read("plate_render")


@pytest.fixture
def mitsuba(monkeypatch):
    mi = MagicMock()
    monkeypatch.setitem(sys.modules, "mitsuba", mi)
    return mi, *read("peers_mitsuba")


# ---- the surface, the same in both


def test_surfaces(blender, mitsuba, tmp_path):
    """Flat with the map's coordinates or displaced; a sphere is as fine as its outline needs; tiles repeat the map about the middle."""
    stored = tmp_path / "mesh.npz"
    np.savez(stored, positions=[[1, 2, 3]], faces=[[0, 0, 0, 0]], uv=[[4, 5]])
    for parts_of in (lambda **job: blender[1].parts_of({**JOB, **job}, ""), lambda **job: mitsuba[1].parts_of({**JOB, **job})):
        positions, normals, faces, uv = parts_of()
        assert len(positions) == 4 and len(faces) == 1 and np.allclose(positions[:, :2] + 0.5, uv) and (normals is None or np.allclose(normals, (0, 0, 1)) and not positions[:, 2].any())
        positions, normals, faces, uv = parts_of(surface="displaced", quads=8)
        assert len(faces) == 64 and np.allclose(positions[:, 2], plate.height(*uv.T)) and np.allclose(normals, plate.normals(*uv.T))
        for surface, quads in (("bumped", sphere.FLAT), ("displaced", 6)):
            wanted = sphere.mesh(quads, surface == "displaced")
            assert all(np.array_equal(ours, theirs) for ours, theirs in zip(parts_of(shape="sphere", surface=surface, quads=6), wanted))
    positions, _normals, _faces, uv = blender[1].parts_of({**JOB, "tiles": 4}, "")
    assert (positions[:, :2].min(), positions[:, :2].max(), uv.min(), uv.max()) == (-2, 2, -1.5, 2.5)
    positions, normals, faces, uv = blender[1].parts_of({**JOB, "surface": "displaced"}, str(stored))
    assert (positions.tolist(), normals, faces.tolist(), uv.tolist()) == ([[1, 2, 3]], None, [[0, 0, 0, 0]], [[4, 5]])
    assert len(blender[1].parts_of(JOB, str(stored))[0]) == 4


# ---- Blender


def test_metals_of_the_plate(blender):
    """Ours by its properties, Cycles' by roughness and anisotropy: the same lobe; the map where bumps are a map."""
    _bpy, script, _given = blender
    roughness, anisotropy = (0.05 * 0.3) ** 0.25, 1 - (0.05 / 0.3) ** 0.5
    for job, wanted in (({"detail": "rotate"}, {"detail": "ROTATE", "horizon": "HARD", "ex": plate.EX, "ey": plate.EY, "fresnel": "NONE"}),
                        ({"detail": "none", "horizon": "MUTUAL", "ggx": (roughness, anisotropy)}, {"detail": "NONE", "horizon": "MUTUAL", "distribution": "GGX", "brdf": "MICROFACET",
                                                                                                   "ax": pytest.approx(0.05), "ay": pytest.approx(0.3)})):
        made = script.new_material({**JOB, **job}, "image")
        nodes = {node.bl_idname: node for node in made.node_tree.nodes}
        metal = nodes["LibshadeMetalNode"]
        assert {name: getattr(metal, name) for name in wanted} == wanted and made.use_nodes and nodes["ShaderNodeTexImage"].image == "image"
        assert hasattr(metal, "ax") == ("ggx" in job) and metal.inputs["Color"].default_value == (1, 1, 1, 1)
        assert set(made.node_tree.linked) == {("ShaderNodeTexImage", "Color", "ShaderNodeNormalMap", "Color"), ("ShaderNodeNormalMap", "Normal", "LibshadeMetalNode", "Normal"),
                                              ("LibshadeMetalNode", "BSDF", "ShaderNodeOutputMaterial", "Surface")}
    for job, wanted in (({"color": 0.5}, ("ASHIKHMIN_SHIRLEY", plate.ROUGHNESS, plate.ANISOTROPY)), ({"ggx": (0.1, 0.2), "surface": "displaced"}, ("GGX", 0.1, 0.2))):
        made = script.new_material({**JOB, **job}, "image")
        nodes = {node.bl_idname: node for node in made.node_tree.nodes}
        metal = nodes["ShaderNodeBsdfAnisotropic"]
        assert (metal.distribution, metal.inputs["Roughness"].default_value, metal.inputs["Anisotropy"].default_value) == wanted
        assert metal.inputs["Color"].default_value == (*[job.get("color", 1)] * 3, 1) and nodes["ShaderNodeTangent"].direction_type == "UV_MAP"
        assert ("ShaderNodeTangent", "Tangent", "ShaderNodeBsdfAnisotropic", "Tangent") in made.node_tree.linked and ("ShaderNodeNormalMap" in nodes) == ("surface" not in job)


def test_meshes_of_the_plate(blender):
    """Smooth quads; those with normals of their own have them; one for all jobs that show the same."""
    bpy, script, given = blender
    faces, uv = np.array([[0, 1, 2, 3], [3, 2, 1, 0]]), np.arange(8).reshape(4, 2) / 8
    mesh = script.new_mesh(np.eye(4)[:, :3], np.ones((4, 3)), faces, uv)
    said = {call.args[0]: call.args[1] for part in (mesh.vertices, mesh.loops, mesh.polygons, mesh.uv_layers.new.return_value.data) for call in part.foreach_set.call_args_list}
    assert np.allclose(said["co"], np.eye(4)[:, :3].ravel()) and said["vertex_index"].tolist() == [0, 1, 2, 3, 3, 2, 1, 0] and said["loop_start"].tolist() == [0, 4]
    assert said["loop_total"].tolist() == [4, 4] and said["use_smooth"].all() and np.allclose(said["uv"].reshape(-1, 2), uv[faces.ravel()])
    assert [part.add.call_args.args for part in (mesh.vertices, mesh.loops, mesh.polygons)] == [(4,), (8,), (2,)] and mesh.use_auto_smooth is True and mesh.auto_smooth_angle == np.pi
    mesh.normals_split_custom_set_from_vertices.assert_called_once_with(np.ones((4, 3)).tolist())
    mesh.update.assert_called_once_with(calc_edges=True)
    assert not script.new_mesh(np.eye(4)[:, :3], None, faces, uv).normals_split_custom_set_from_vertices.called
    given["parts_of"], given["new_material"] = lambda _job, file: (np.eye(4)[:, :3], None, faces, uv) if file == "" else 1 / 0, lambda _job, image: image
    first = script.shared_mesh(JOB, "image", "")
    first.materials.append.assert_called_once_with("image")
    assert all(script.shared_mesh({**JOB, **job}, "image", "") is first for job in ({"seed": 3}, {"samples": 9}, {"sky": "x"}, {"output": "y"}, {"repeat": 4}))
    assert all(script.shared_mesh({**JOB, **job}, "image", "") is not first for job in ({"surface": "displaced"}, {"quads": 9}, {"detail": "none"}, {"engine": "CYCLES"}))


def test_scenes_of_the_plate(blender):
    """One sun of irradiance 1 or a sky, an eye straight above that is turned by its elevation, and nothing that would favour a renderer."""
    bpy, script, given = blender
    given["shared_mesh"] = lambda *_given: "mesh"
    world = fake_blender.material("world")
    background = world.node_tree.nodes.new("ShaderNodeBackground")
    bpy.data.worlds.new.side_effect = lambda name: world
    bpy.data.scenes.new.side_effect = lambda name: MagicMock()
    for job, sky in (({}, ""), ({"engine": "CYCLES", "eye": 30, "seed": 5, "bounces": 2}, "sky.exr")):
        scene = script.new_scene({**JOB, **job}, "image", "", sky)
        linked = {call.args[0].said[0]: call.args[0] for call in scene.collection.objects.link.call_args_list}
        assert sorted(linked) == (["camera", "plate"] if sky else ["camera", "plate", "sun"]) and linked["plate"].said[1] == "mesh" and scene.camera is linked["camera"]
        above, eye = linked["camera"], np.radians(job.get("eye", 90))
        assert above.location == pytest.approx((0, -5 * np.cos(eye), 5 * np.sin(eye))) and above.rotation_euler == pytest.approx((np.pi / 2 - eye, 0, 0))
        assert (above.said[1].type, above.said[1].ortho_scale) == ("ORTHO", 1)
        if not sky:
            sun = linked["sun"]
            assert (sun.said[1].said, sun.said[1].energy, sun.said[1].angle) == (("sun", "SUN"), 1, 0) and sun.rotation_euler == (tuple(plate.SUN), "Z", "Y")
        render, settings = scene.render, scene.cycles if sky else scene.libshade
        assert (render.engine, render.resolution_x, render.resolution_y, render.resolution_percentage) == (job.get("engine", "LIBSHADE"), 48, 48, 100)
        assert (render.image_settings.file_format, render.image_settings.color_depth, scene.view_settings.view_transform, scene.display_settings.display_device) == ("OPEN_EXR", "32", "Standard", "sRGB")
        assert (settings.samples, settings.max_bounces, settings.pixel_filter_type, settings.use_adaptive_sampling, settings.use_denoising, settings.seed) == (4, 2 if sky else 0, "BOX", False, False, job.get("seed", 0))
        assert (settings.light_sampling_threshold, settings.sample_clamp_direct, settings.sample_clamp_indirect, settings.blur_glossy, settings.soft_terminator, settings.filter_normals) == (0, 0, 0, 0, False, False)
        assert not sky or settings.diffuse_bounces == settings.glossy_bounces == 2
        assert scene.world is world and world.color == (0, 0, 0) and world.use_nodes == bool(sky)
    assert script.new_scene(JOB, "image", "", "sky.exr").libshade.max_bounces == 4
    assert background.inputs["Color"].links[0].from_node.bl_idname == "ShaderNodeTexEnvironment" and background.inputs["Strength"].default_value is None
    bpy.data.images.load.assert_called_with("sky.exr", check_existing=True)
    bpy.app.version = (5, 0, 0)
    for sky in ("", "sky.exr"):
        script.new_world(sky)
        assert background.inputs["Strength"].default_value == bool(sky)


def test_renders_take_turns(blender, tmp_path):
    """Each as often as asked, by turns, timed; pictures afterwards."""
    bpy, script, given = blender
    order = {"normal_map": "map.exr", "mesh": "m", "result": str(tmp_path / "result.json"),
             "jobs": [{"name": "a", "repeat": 2, "output": "a.exr"}, {"name": "b", "repeat": 1, "output": ""}, {"name": "c", "repeat": 3, "output": "c.exr", "sky": "s"}]}
    (tmp_path / "jobs.json").write_text(json.dumps(order))
    asked, clock = [], iter(range(99))
    given["new_scene"] = lambda job, image, mesh, sky: SimpleNamespace(name=job["name"], render=SimpleNamespace(filepath=""), of=(mesh, sky))
    given["time"] = SimpleNamespace(perf_counter=lambda: next(clock) ** 2)
    bpy.app.version_string = "3.4.1"
    bpy.ops.render.render.side_effect = lambda scene, **how: asked.append((scene, bpy.context.window.scene.name, bpy.context.window.scene.render.filepath, how))
    script.main(str(tmp_path / "jobs.json"))
    assert [(scene, how) for scene, _seen, _path, how in asked] == [*((name, {}) for name in "abcacc"), *((name, {"write_still": True}) for name in "ac")]
    assert all(scene == seen for scene, seen, *_rest in asked) and [path for *_rest, path, how in asked if how] == ["a.exr", "c.exr"]
    assert json.loads((tmp_path / "result.json").read_text()) == {"seconds": [[1, 13], [5], [9, 17, 21]], "blender": "3.4.1"}
    assert bpy.data.images.load.return_value.colorspace_settings.name == "Non-Color" and bpy.data.images.load.call_args.args == ("map.exr",)


@pytest.mark.parametrize("world", [True, False])
def test_a_file_is_rendered_as_pov_ray_does(monkeypatch, capsys, tmp_path, world):
    """One bounce, plain pixels, nothing that only our engine softens, no light of the background's."""
    monkeypatch.setattr(sys, "argv", ["blender", "--", "out.exr", "25", "16"])
    with fake_blender.imported() as (bpy,):
        scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = 402, 300
        if not world:
            scene.world = None
        _script, given = read("blender_render")
        given["main"](*sys.argv[2:])
        render, ours = scene.render, scene.libshade
        assert (render.engine, ours.samples, ours.max_bounces, ours.pixel_filter_type, ours.light_sampling_threshold, ours.soft_terminator, ours.filter_normals) == ("LIBSHADE", 16, 0, "BOX", 0, False, False)
        assert (render.resolution_percentage, render.image_settings.file_format, render.image_settings.color_depth, render.use_file_extension) == (25, "OPEN_EXR", "32", False)
        assert render.filepath.startswith("/") and render.filepath.endswith("/out.exr")
        seen = scene.world and scene.world.cycles_visibility
        assert not world or (seen.diffuse, seen.glossy, seen.transmission, seen.scatter) == (False,) * 4
        bpy.ops.render.render.assert_called_once_with(write_still=True)
    assert capsys.readouterr().out == "size 100 75\n"


def test_cloth_for_cycles(monkeypatch):
    """As near as it gets, twenty crossings across a plane and 320 round a ball, without what differs by chance where that is asked; sharp pixels of both engines."""
    with fake_blender.imported("cloth_render") as (bpy, script):
        bpy.app.version = (3, 4, 1)
        monkeypatch.setattr(script.importlib, "import_module", lambda name: SimpleNamespace(cloth=lambda word: {("libshade._native", "denim"): {"counts": (30, 40)}}[name, word]))
        request = {"preset": "DENIM", "scene": "plane", "engine": "CYCLES", "picture": "/x/a.exr", "even": True, "samples": 7, "side": 32}
        for scene, crossings, scale in (("plane", 20, 1.2), ("ball", 320, 2.1)):
            uv = [SimpleNamespace(uv=SimpleNamespace(x=x)) for x in (0.25, 1)]
            bpy.context.object.data.uv_layers.active.data = uv
            even = scene == "plane"
            cloth = script.cloth({**request, "scene": scene, "even": even})
            node = cloth.node_tree.nodes[0]
            assert (node.preset, node.distance, node.size) == ("DENIM", "NEAR", pytest.approx(crossings / (100 * 1200**0.5)))
            flat = {f"{yarn}_{word}" for yarn in ("warp", "weft") for word in ("vary_brightness", "vary_tilt", "along_brightness", "along_tilt", "slub")}
            assert {name for name in vars(node) if name[:5] in ("warp_", "weft_")} == (flat if even else set()) and all(getattr(node, name) == 0 for name in flat if even)
            assert cloth.node_tree.linked == [("LibshadeFabricNode", 0, "ShaderNodeOutputMaterial", "Surface")]
            lamps = []
            monkeypatch.setattr(script, "lamp", lambda _scene, *said: lamps.append(said))
            script.build({**request, "scene": scene, "even": even})
            made = bpy.context.scene
            assert (made.camera.data.type, made.camera.data.ortho_scale, made.camera.location) == ("ORTHO", scale, (0, 0, 4)) and [one.uv.x for one in uv] == ([0.25, 1] if even else [0.5, 2])
            assert lamps == [(2.2, (0.75, 0.3, 0)), (0.8, (-0.9, -0.9, 0))] and bpy.context.object.data.materials.append.called
        render, made = bpy.context.scene.render, bpy.context.scene
        assert (render.engine, render.resolution_x, render.resolution_y, render.film_transparent, render.image_settings.file_format, render.image_settings.color_depth) == ("CYCLES", 32, 32, True, "OPEN_EXR", "32")
        assert (made.libshade.samples, made.cycles.samples, made.libshade.max_bounces, made.cycles.max_bounces, made.cycles.use_adaptive_sampling, made.cycles.use_denoising) == (7, 7, 1, 1, False, False)
        assert (made.cycles.pixel_filter_type, made.libshade.pixel_filter_type, made.cycles.filter_width) == ("BOX", "BOX", 0.01)


def test_requests_for_cloth(monkeypatch, capsys):
    """One after the other, each answered when its picture is written; suns that are a little soft."""
    with fake_blender.imported("cloth_render") as (bpy, script):
        made, ended = [], []
        monkeypatch.setattr(script, "build", lambda request: made.append(request["preset"]))
        bpy.ops.render.render.side_effect = lambda **how: made.append((bpy.context.scene.render.filepath, how))
        monkeypatch.setattr(script.os, "_exit", ended.append)
        monkeypatch.setattr(sys, "stdin", [json.dumps({"preset": preset, "picture": f"/x/{preset}.exr"}) + "\n" for preset in ("DENIM", "LINEN")])
        script.main()
        assert made == ["DENIM", ("/x/DENIM", {"write_still": True}), "LINEN", ("/x/LINEN", {"write_still": True})] and ended == [0] and capsys.readouterr().out == "DONE\nDONE\n"
        scene = MagicMock()
        script.lamp(scene, 2.2, (1, 2, 3))
        item = scene.collection.objects.link.call_args.args[0]
        assert item.rotation_euler == (1, 2, 3) and (item.said[1].said, item.said[1].energy, item.said[1].angle) == (("sun", "SUN"), 2.2, 0.2)


# ---- Mitsuba


def test_the_plate_in_mitsuba(mitsuba):
    """Alphas as they are, the map upside down, z up, a square from above; a sky by as many bounces as the others have."""
    mi, script, _given = mitsuba
    normals, job = np.arange(12.0).reshape(2, 2, 3), {**JOB, "alphas": (0.05, 0.3)}
    script.scene_of(job, normals, "folder")
    told = mi.load_dict.call_args.args[0]
    bsdf = told["plate"]["bsdf"]
    assert bsdf["type"] == "twosided" and bsdf["bsdf"]["type"] == "normalmap" and bsdf["bsdf"]["normalmap"]["raw"] is True and bsdf["bsdf"]["normalmap"]["bitmap"] is mi.Bitmap.return_value
    assert bsdf["bsdf"]["bsdf"] == {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha_u": 0.05, "alpha_v": 0.3}
    assert np.array_equal(mi.Bitmap.call_args.args[0], normals[::-1]) and told["integrator"] == {"type": "direct"} and told["type"] == "scene"
    assert told["light"] == {"type": "directional", "direction": (-plate.SUN).tolist(), "irradiance": 1.0} and told["plate"]["filename"] == "folder/bumped.ply"
    mi.Mesh.return_value.write_ply.assert_called_with("folder/bumped.ply")
    sensor = told["sensor"]
    assert (sensor["type"], sensor["film"]["width"], sensor["film"]["height"], sensor["film"]["rfilter"], sensor["film"]["component_format"]) == ("orthographic", 48, 48, {"type": "box"}, "float32")
    transform = mi.ScalarTransform4f.return_value
    transform.look_at.assert_called_with([0, 0, 2], [0, 0, 0], [0, 1, 0])
    transform.scale.assert_called_with([0.5, 0.5, 1])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(script.np, "load", lambda path: np.full((1, 2, 3), len(path)))
        script.scene_of({**job, "surface": "displaced", "sky": "s.npy"}, normals, "folder")
    told = mi.load_dict.call_args.args[0]
    assert told["plate"]["bsdf"]["bsdf"]["type"] == "roughconductor" and told["integrator"] == {"type": "path", "max_depth": 6} and told["light"]["type"] == "envmap"
    assert mi.Bitmap.call_args.args[0].tolist() == [[[5] * 3] * 2] and [call.args for call in transform.rotate.call_args_list] == [([1, 0, 0], 90)]
    transform.rotate.return_value.rotate.assert_called_with([0, 1, 0], 90)


def test_triangles_for_mitsuba(mitsuba):
    mi, script, given = mitsuba
    values = {}
    mi.traverse.return_value = MagicMock(__setitem__=lambda _self, name, value: values.update({name: value}))
    mi.Float, mi.UInt32 = (lambda kind: lambda array: (kind, array.dtype, array.tolist()))("f"), (lambda kind: lambda array: (kind, array.dtype, array.tolist()))("u")
    script.mesh((np.arange(12.0).reshape(4, 3), np.ones((4, 3)), np.array([[0, 1, 2, 3]]), np.zeros((4, 2))))
    assert values == {"vertex_positions": ("f", np.float32, list(range(12))), "vertex_normals": ("f", np.float32, [1] * 12), "vertex_texcoords": ("f", np.float32, [0] * 8),
                      "faces": ("u", np.uint32, [0, 1, 2, 0, 2, 3])}
    assert mi.Mesh.call_args.args == ("plate", 4, 2) and mi.Mesh.call_args.kwargs == {"has_vertex_normals": True, "has_vertex_texcoords": True} and mi.traverse.return_value.update.called
    mi.set_variant.assert_called_with("llvm_ad_rgb")


def test_mitsuba_compiles_before_it_is_timed(mitsuba, tmp_path):
    mi, script, given = mitsuba
    np.save(tmp_path / "n.npy", np.zeros((1, 1, 3)))
    jobs = [{**JOB, "seed": 10, "repeat": 2, "output": str(tmp_path / "a.npy")}, {**JOB, "seed": 20, "repeat": 0}]
    (tmp_path / "jobs.json").write_text(json.dumps({"normals": str(tmp_path / "n.npy"), "folder": "f", "result": str(tmp_path / "r.json"), "jobs": jobs}))
    clock, asked = iter(range(99)), []
    given["scene_of"], given["time"] = lambda job, normals, folder: (job["seed"], folder), SimpleNamespace(perf_counter=lambda: next(clock) ** 2)
    mi.render.side_effect = lambda scene, spp, seed: asked.append((scene, spp, seed)) or np.full((1, 1, 4), seed, np.float32)
    mi.__version__ = "3.5"
    script.main(str(tmp_path / "jobs.json"))
    assert asked == [((10, "f"), 4, 10), ((10, "f"), 4, 11), ((10, "f"), 4, 12), ((20, "f"), 4, 20)]
    assert np.load(tmp_path / "a.npy").tolist() == [[[10, 10, 10]]] and json.loads((tmp_path / "r.json").read_text()) == {"seconds": [[5, 9], []], "version": "3.5"}
