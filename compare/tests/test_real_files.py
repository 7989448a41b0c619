# SPDX-License-Identifier: Apache-2.0
"""The list of real files, and what is judged; nothing is fetched or rendered here."""
import importlib
import sys
import tarfile
import zipfile
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

import materials
import pictures
import real_files
import real_files_fetch

COST = 1.1


def row(state, difference="", warnings=""):
    return {**real_files.listed()[0], **real_files.EMPTY, "state": state, "difference": difference,
            "warnings": warnings}


KINDS = {"blend", "glb", "gltf", "obj", "fbx", "dae", "ply", "stl", "x3d", "usd", "usda"}


def test_list():
    """Packages by name and version, each thing once; nothing but a name says where they are."""
    rows = real_files.listed()
    assert len({(r["package"], r["path"], r["material"]) for r in rows}) >= 100
    names = [real_files.name_of(r) for r in rows]
    assert len(set(names)) == len(names)
    for r in rows:
        assert r["source"] in ("deb", "src", "pypi") and r["version"] and r["blender"] in ("3.4", "5.0")
        assert r["path"].rpartition(".")[2].lower() in KINDS and not r["path"].startswith("/")
        assert "://" not in "".join(r.values())
    assert real_files.listed("no package is called so") == []


def test_materials():
    """Sixty-one, in both Blenders by turns, and some of hair; each is known by its own lines."""
    everything = materials.listed(materials.arguments([]))
    rows = [row for row in everything if not row["path"]]
    assert {row["material"][:5] for row in everything if row["path"]} == {"hair_"}
    assert len({row["material"] for row in rows}) == len({row["version"] for row in rows}) == len(rows) == 61
    assert [row["blender"] for row in rows[:4]] == ["3.4", "5.0"] * 2
    assert {row["blender"] for row in materials.listed(materials.arguments(["--blender", "5.0"]))} == {"5.0"}
    assert materials.arguments([]).limit == real_files.arguments([]).limit


def test_results_of_other_settings_are_not_taken():
    """Each option that changes what is measured has results of its own; others do not."""
    one, two = real_files.listed()[:2]
    key = lambda *words, row=one: real_files.key_of(row, real_files.arguments(list(words)))  # noqa: E731
    assert len({key(), key("--size", "64"), key("--noise", ".02"), key("--cap", "64"), key("--seconds", "9"), key(row=two)}) == 6
    assert key() == key("--threads", "3") == key("--limit", ".1", "--share", ".5", "--timeout", "9")


def test_verdict(capsys):
    options = real_files.arguments([])
    good = [row("rendered", 0.05)] * 9
    unjudged = [row("nothing to see in Cycles"), row("CYCLES: exit status 1"), row("noise of Cycles", 3.0)]
    assert real_files.verdict([*good, row("rendered", 0.0501), *unjudged], options)
    assert "9 of 10 within 0.05 (90.0 %); of the other 1 0 with a warning; 3 not judged" in capsys.readouterr().out
    for bad in (row("rendered", 0.06, "a node"), row("LIBSHADE: exit status -11"),
                row("values that are not finite")):
        assert not real_files.verdict([*good[1:], bad, bad], options)
    assert "of the other 2 0 with a warning" in capsys.readouterr().out
    assert not real_files.verdict([row("package: not to be had")], options)
    capsys.readouterr()
    one = {"package": "p", "path": "a/b.obj", "material": "", "blender": "3.4", "brightness": 1.5, "noise_cycles": 0.01, "noise_libshade": 0.02}
    real_files.verdict([{**row("rendered", 0.06, "a node"), **one}, {**row("rendered", 0.5), **one, "material": "tile"},
                        {**row("LIBSHADE: exit status 1"), **one, "brightness": "", "blender": "5.0"}, {**row("noise of Cycles", 2), **one}], options)
    assert capsys.readouterr().out.splitlines() == [  # the worst first, what failed before it
        "beyond the limit  difference  brightness  noise, Cycles and ours", "----------------  ----------  ----------  ----------------------",
        "p: a/b.obj, 5.0            -                           0.01 0.02", "p: tile, 3.4             0.5         1.5               0.01 0.02",
        "p: a/b.obj, 3.4         0.06         1.5               0.01 0.02", "", "p: a/b.obj, 5.0: LIBSHADE: exit status 1; warnings: none",
        "", "p: tile, 3.4: rendered; warnings: none", "", "p: a/b.obj, 3.4: rendered; warnings: a node", "", "p: a/b.obj, 3.4: not judged: noise of Cycles",
        "", "0 of 3 within 0.05 (0.0 %); of the other 3 1 with a warning; 1 not judged"]


def test_what_is_kept_of_them(monkeypatch):
    """Of each Blender how many, how many of them are good, the median and the worst, by name."""
    written = {}
    heads = []
    monkeypatch.setattr(real_files.kept, "write", lambda name, head, columns, rows: (written.update({name: rows}), heads.append((head["command"], columns))))
    rows = [{**row("rendered", off), "path": f"a/{k}.obj", "blender": "3.4"} for k, off in enumerate((0.001, 0.06, 0.02, 0.04))]
    found = [*rows, {**row("CYCLES: exit status 1"), "blender": "3.4"}, {**row("rendered", 0.01), "material": "tile", "blender": "5.0"}]
    real_files.keep(found, real_files.arguments(["--results"]))
    assert written["files"] == [["3.4", 5, 4, 3, 0.03, "1.obj 0.06, 3.obj 0.04, 2.obj 0.02, 0.obj 0.001"], ["5.0", 1, 1, 1, 0.01, "tile 0.01"]]
    assert heads == [("make compare-files FILES=\"--results\"", ["Blender", "of the list", "judged", "within 0.05", "median", "worst"])]
    real_files.keep(found, real_files.arguments(["--results", "--filter", "obj", "--limit", "0.1", "--threads", "3"]))
    assert heads[-1][0] == 'make compare-files FILES="--filter obj --limit 0.1 --results"' and heads[-1][1][3] == "within 0.1"
    hair = {**row("rendered", 0.03), "material": "hair_a", "path": real_files.STRANDS}
    materials.keep({True: [{**hair, "path": ""}, hair]}, materials.arguments([]))
    assert heads[-1] == ("make compare-materials MATERIALS=--results", ["shown on", "Blender", "*Grooves Follow Bumps*", "judged", "within 0.05", "median", "worst"])
    assert written["materials"] == [[what, hair["blender"], "on", 1, 1, 0.03, "hair_a 0.03"] for what in ("ball and box", "hair")]


def test_key_changes_with_what_is_asked():
    one, other = real_files.listed()[:2]
    options = real_files.arguments([])
    keys = {real_files.key_of(*asked) for asked in (
        (one, options), (other, options), (one, real_files.arguments(["--size", "64"])))}
    assert len(keys) == 3
    assert real_files.key_of(one, real_files.arguments(["--threads", "1"])) in keys


def test_path_is_in_its_package(tmp_path):
    (tmp_path / "a b.blend").touch()
    assert real_files_fetch.path_of(tmp_path, "a b.blend") == str(tmp_path / "a b.blend")
    with pytest.raises(OSError, match="not in its package"):
        real_files_fetch.path_of(tmp_path, "gone.blend")


def result_of(tmp_path, monkeypatch, ours, theirs, noise=(0.001, 0.001)):
    """What is said of two pictures each, of two seeds; noise: ours, Cycles'."""
    archive = tmp_path / "libshade.zip"
    archive.write_bytes(b"add-on")
    monkeypatch.setattr(real_files, "ZIP", archive)

    def rendered(_row, engine, stem, _added, _file, _options):
        for seed, value in enumerate(ours if engine == "LIBSHADE" else theirs, 1):
            pictures.write_float(f"{stem}_{seed}.exr", np.full((16, 16, 3), value, np.float32))
        return {"noise": noise[engine == "CYCLES"], "samples": 16, "seconds": 1.0, "added": [], "words": []}

    monkeypatch.setattr(real_files, "rendered", rendered)
    return real_files.both(real_files.listed()[0], real_files.arguments(["--output", str(tmp_path)]), "a.blend")


def test_pictures_of_both_seeds_count(tmp_path, monkeypatch):
    found = result_of(tmp_path, monkeypatch, (0.5, 0.7), (0.4, 0.6))
    assert (found["state"], found["difference"], found["brightness"]) == ("rendered", 0.2, 1.2)


def test_only_noise_of_cycles_excuses(tmp_path, monkeypatch):
    """More than half of the limit; ours is our fault."""
    states = {noise: result_of(tmp_path, monkeypatch, (1, 1), (1, 1), noise)["state"]
              for noise in ((0.2, 0.001), (0.001, 0.2), (0.001, 0.024), (0.001, 0.026))}
    assert list(states.values()) == ["rendered", "noise of Cycles", "rendered", "noise of Cycles"]


def in_blender(monkeypatch, bpy, enabled):
    """real_files_render.py, with what stands for Blender; which add-ons it enables."""
    for name, module in (("bpy", bpy), ("mathutils", SimpleNamespace(Vector=Vector)), ("addon_utils", SimpleNamespace(enable=enabled.append))):
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, "real_files_render", raising=False)
    render = importlib.import_module("real_files_render")
    monkeypatch.delitem(sys.modules, "real_files_render")
    return render


class Vector(np.ndarray):
    def __new__(cls, values):
        return np.array(list(values), float).view(cls)

    @property
    def length(self):
        return float(np.linalg.norm(self))

    def normalized(self):
        return self / self.length

    def to_track_quat(self, track, up):
        return SimpleNamespace(to_euler=lambda: (track, up, self))


@pytest.mark.parametrize("there, path, called", [
    (["wm.obj_import"], "a.OBJ", "wm.obj_import"), (["import_mesh.stl"], "a.stl", "import_mesh.stl"),
    (["wm.stl_import", "import_mesh.stl"], "a.stl", "wm.stl_import"), (["import_scene.x3d"], "a.wrl", "import_scene.x3d"),
    (["wm.usd_import"], "a.usdz", "wm.usd_import"), ([], "a.fbx", None), (["wm.obj_import"], "a.max", None)])
def test_the_first_operator_that_is_there_imports(monkeypatch, there, path, called):
    """Of an add-on only once that is enabled, which it is where nothing else reads the kind."""
    asked = []

    class Operators:
        def __init__(self, module):
            self.names = [word.split(".")[1] for word in there if word.startswith(module + ".")
                          and (module == "wm" or enabled)]
            self.module = module

        def __dir__(self):
            return self.names

        def __getattr__(self, name):
            return lambda filepath: asked.append(f"{self.module}.{name}")

    class All:
        def __getattr__(self, module):
            return Operators(module)

    enabled = []
    bpy = ModuleType("bpy")
    bpy.ops, bpy.app = All(), SimpleNamespace(version_string="3.4.1")
    render = in_blender(monkeypatch, bpy, enabled)
    if called:
        render.imported(path)
        assert asked == [called] and bool(enabled) == (not called.startswith("wm."))
    else:
        with pytest.raises(SystemExit, match=f"{path}: Blender 3.4.1 imports no"):
            render.imported(path)


FLAGS = ("use_border", "use_compositing", "use_sequencer", "use_freestyle", "use_multiview", "use_stamp", "use_file_extension", "use_persistent_data")
AS_ARTISTS_GET_IT = {  # of Blender's factory settings, but for what makes two pictures differ by chance
    "max_bounces": 12, "diffuse_bounces": 4, "glossy_bounces": 4, "transmission_bounces": 12, "transparent_max_bounces": 8, "sample_clamp_direct": 0, "sample_clamp_indirect": 10,
    "light_sampling_threshold": .01, "blur_glossy": 1, "caustics_reflective": True, "caustics_refractive": True, "use_adaptive_sampling": False, "use_denoising": False,
    "pixel_filter_type": "BLACKMAN_HARRIS", "filter_width": 1.5, "device": "CPU", "use_progressive_refine": False, "time_limit": 0}
OURS = {"texture_blur": 0, "filter_normals": False}


def scene_of(**more):
    frame = SimpleNamespace(resolution_x=1920, resolution_y=1080, image_settings=SimpleNamespace(), **dict.fromkeys(FLAGS, True))
    empty = lambda names: SimpleNamespace(**dict.fromkeys(names))
    return SimpleNamespace(render=frame, cycles=empty(AS_ARTISTS_GET_IT), libshade=empty((*AS_ARTISTS_GET_IT, *OURS, "groove_transport")), **more)


@pytest.mark.parametrize("engine, grooves", [("CYCLES", False), ("LIBSHADE", False), ("LIBSHADE", True)])
def test_settings_of_a_render(monkeypatch, engine, grooves):
    """As artists get it; the longer side as asked, both in fours."""
    bpy = ModuleType("bpy")
    scene = scene_of()
    bpy.context, bpy.app = SimpleNamespace(scene=scene), SimpleNamespace(version=(3, 4))
    render = in_blender(monkeypatch, bpy, [])
    settings = render.set_render({**JOB, "engine": engine, "grooves": grooves})
    assert vars(settings) == {**AS_ARTISTS_GET_IT, **({**OURS, "groove_transport": grooves} if engine == "LIBSHADE" else {})}
    frame = scene.render
    assert (frame.engine, frame.resolution_x, frame.resolution_y, frame.resolution_percentage) == (engine, 128, 72, 100)
    assert not any(getattr(frame, name) for name in FLAGS) and frame.use_single_layer is True and not hasattr(frame, "threads")
    assert vars(frame.image_settings) == {"file_format": "OPEN_EXR", "color_mode": "RGBA", "color_depth": "32"}
    frame.resolution_x, frame.resolution_y, frame.image_settings.media_type = 30, 3000, "VIDEO"
    render.set_render({**JOB, "threads": 3})
    assert (frame.threads_mode, frame.threads, frame.resolution_x, frame.resolution_y, frame.image_settings.media_type) == ("FIXED", 3, 16, 128, "IMAGE")


def test_what_a_file_lacks_is_added(monkeypatch):
    """A camera that frames all that is rendered, a sun and a grey world, where there is none or nothing is lit."""
    bpy, links = ModuleType("bpy"), []
    light = SimpleNamespace(type="LIGHT", hide_render=False)
    box = lambda hidden=False, kind="MESH": SimpleNamespace(type=kind, hide_render=hidden, matrix_world=Moved(), evaluated_get=lambda _graph: SimpleNamespace(
        bound_box=[(0, 0, 0), (2, 2, 1)]))

    class Moved:
        def __matmul__(self, at):
            return at + (1, 0, 0)
    background = SimpleNamespace(type="BACKGROUND", inputs={"Color": SimpleNamespace(default_value=None)})
    new_world = SimpleNamespace(node_tree=SimpleNamespace(nodes=[SimpleNamespace(type="OUTPUT"), background]))
    made = lambda name, *kind: SimpleNamespace(name=name, kind=kind)
    collection = SimpleNamespace(objects=SimpleNamespace(link=links.append))
    scene = SimpleNamespace(camera=None, world=None, objects=[box(), box(hidden=True), box(kind="EMPTY")], collection=collection)
    bpy.context = SimpleNamespace(scene=scene, evaluated_depsgraph_get=lambda: None)
    bpy.data = SimpleNamespace(cameras=SimpleNamespace(new=made), lights=SimpleNamespace(new=made), worlds=SimpleNamespace(new=lambda _name: new_world),
                               objects=SimpleNamespace(new=lambda name, data: SimpleNamespace(data=data)))
    bpy.app = SimpleNamespace(version=(3, 4))
    render = in_blender(monkeypatch, bpy, [])
    black, grey = (SimpleNamespace(use_nodes=nodes, color=(value,) * 3) for nodes, value in ((False, 0), (False, .1)))
    shown = SimpleNamespace(use_nodes=True, color=(0, 0, 0))
    for world, objects, is_dark in ((None, [], True), (black, [], True), (grey, [], False), (shown, [], False), (None, [light], False),
                                    (None, [SimpleNamespace(type="LIGHT", hide_render=True)], True)):
        scene.world, scene.objects = world, objects
        assert render.dark() == is_dark
    assert [tuple(corner) for corner in render.corners()] == [(-1, -1, -1), (1, 1, 1)]  # of nothing
    scene.objects = [box(), box(hidden=True), box(kind="EMPTY")]
    assert render.complete(None) == ["camera", "light"] and [ob.data.name for ob in links] == ["added", "added"]
    camera, sun = links
    radius = 1.5  # of the box from (1, 0, 0) to (3, 2, 1)
    towards = np.array([.5, -1, .6]) / np.sqrt(1.61)
    assert np.allclose(camera.location, np.array([2, 1, .5]) + towards * radius * 2.9) and scene.camera is camera
    assert camera.rotation_euler[:2] == ("Z", "Y") and np.allclose(camera.rotation_euler[2], towards)
    assert (camera.data.lens, camera.data.clip_start, camera.data.clip_end) == (50, pytest.approx(.0015), 150)
    assert (sun.data.kind, sun.data.energy, sun.data.angle, sun.rotation_euler) == (("SUN",), 3, .1, (.6, .2, .9))
    assert scene.world is new_world and new_world.use_nodes and background.inputs["Color"].default_value == (.4, .4, .4, 1)
    del links[:]
    assert render.complete(None) == []
    scene.world = None
    assert render.complete(None) == ["light"] and render.complete(["camera"]) == ["camera"] and render.complete([]) == [] and len(links) == 2


def test_samples_are_raised_until_seeds_agree(tmp_path, monkeypatch):
    """By what the noise asks for, to the cap, or as long as a picture may take; what is dark gets a camera of ours, then light."""
    bpy = ModuleType("bpy")
    bpy.context = SimpleNamespace(preferences=SimpleNamespace(filepaths=SimpleNamespace()), scene=None)
    bpy.app = SimpleNamespace(version_string="3.4.1")
    enabled = []
    render = in_blender(monkeypatch, bpy, enabled)

    class Ended(Exception):
        pass

    def end(status):
        raise Ended(status)
    monkeypatch.setattr(render.os, "_exit", end)
    for name, given in (("opened", None), ("complete", []), ("corners", []), ("add_camera", None), ("add_light", None), ("set_render", "settings")):
        monkeypatch.setattr(render, name, lambda *words, name=name, given=given: asked.append(name) or (list(given) if given == [] else given))

    def run(noise_of, seconds_of=lambda _samples: 1.0, seen=lambda _asked: 1.0, **job):
        del asked[:], counts[:]

        def pair(_job, _settings, samples):
            counts.append(samples)
            bright = seen(asked)
            return np.array([[bright, 2 * bright]]), noise_of(samples), seconds_of(samples)
        monkeypatch.setattr(render, "pair", pair)
        (tmp_path / "job").write_text(render.json.dumps({**JOB, "output": str(tmp_path / "key"), **job}))
        with pytest.raises(Ended) as end:
            render.main(str(tmp_path / "job"))
        assert end.value.args == (0,) and asked[0] == "opened"
        return counts[:], render.json.loads((tmp_path / "key.json").read_text())
    asked, counts = [], []
    noisy = lambda of: lambda samples: of / samples**.5
    assert run(noisy(.08)) == ([64], {"samples": 64, "noise": .01, "seconds": 1, "added": [], "blender": "3.4.1"})
    assert bpy.context.preferences.filepaths.use_scripts_auto_execute is False and not enabled
    assert run(noisy(.16), engine="LIBSHADE")[0] == [64, 307] and enabled == ["libshade"]  # four times as many, and a fifth more
    assert run(noisy(8))[0] == [64, 1024, 4096]  # sixteen times at most; the cap
    assert run(noisy(8), cap=100)[0] == [64, 100] and run(noisy(8), cap=80)[0] == [64]
    assert run(noisy(8), seconds_of=lambda samples: samples / 10)[0] == [64, 300]  # thirty seconds
    assert run(noisy(.0801))[0] == [64, 96]  # half as many more, at least
    dark = lambda until: lambda asked: 1.0 if until in asked else 0.0
    assert run(noisy(.01), seen=dark("add_camera")) == ([64, 64], {"samples": 64, "noise": .00125, "seconds": 1, "added": ["camera"], "blender": "3.4.1"})
    assert run(noisy(.01), seen=dark("add_light"))[1]["added"] == ["camera", "light"] and asked[-3:] == ["corners", "add_camera", "add_light"]
    assert run(noisy(.01), seen=dark("add_light"), added=[])[0] == [64]
    assert render.apart(np.ones((8, 8, 3)), np.full((8, 8, 3), 3.0)) == 1 and render.apart(*np.zeros((2, 8, 8, 3))) == 0
    checks = np.indices((8, 8)).sum(0)[..., None] % 2 * np.ones(3)
    assert render.apart(checks, 1 - checks) == 0  # of means
    rows = np.zeros((14, 8, 3))  # two rows of which no block is whole
    rows[3:5] = 4
    shown = np.zeros((14, 8, 3))
    shown[:8] = 1
    assert render.apart(rows, shown) == 0 and render.apart(rows[:, ::-1], np.roll(shown, 4, 0)) == 1


TOLD = {"noise": 0.00123456, "samples": 16, "seconds": 1.2345, "added": ["camera", "light"], "words": []}
SAID = {"added": "camera light", **{f"{what}_cycles": value for what, value in (("noise", 0.0012), ("samples", 16), ("seconds", 1.23))}}


@pytest.mark.parametrize("theirs, ours, values, wanted", [
    ({"failed": "CYCLES: no", "words": ["c"]}, None, None, {"state": "CYCLES: no"}),
    (TOLD, {"failed": "LIBSHADE: no", "words": ["a", "b"]}, None, {"state": "LIBSHADE: no", "warnings": "a; b", **SAID}),
    (TOLD, {**TOLD, "noise": 0.5}, (np.nan, 1), {"state": "values that are not finite"}), (TOLD, TOLD, (1, np.inf), {"state": "values that are not finite"}),
    (TOLD, TOLD, (1, 9e-7), {"state": "nothing to see in Cycles"}), (TOLD, TOLD, (0, 1.1e-6), {"state": "rendered", "difference": 1, "brightness": 0}),
    (TOLD, {**TOLD, "noise": 0.5, "samples": 32, "seconds": 2.0}, (1.12341, 1),
     {"state": "rendered", "difference": 0.1234, "brightness": 1.1234, "noise_libshade": 0.5, "samples_libshade": 32, "seconds_libshade": 2.0, "warnings": "", **SAID})])
def test_states_of_a_pair(tmp_path, monkeypatch, theirs, ours, values, wanted):
    """The first thing that is amiss, and what is known until then; ours gets what was added for Cycles."""
    (tmp_path / "libshade.zip").write_bytes(b"add-on")
    monkeypatch.setattr(real_files, "ZIP", tmp_path / "libshade.zip")
    asked, shown = [], []

    def rendered(_row, engine, stem, added, file, _options):
        asked.append((engine, str(stem.relative_to(tmp_path)), added, file))
        assert stem.parent.is_dir()
        for seed in (1, 2) if values else ():
            pictures.write_float(f"{stem}_{seed}.exr", np.full((8, 8, 3), values[engine == "CYCLES"], np.float32))
        return theirs if engine == "CYCLES" else ours
    monkeypatch.setattr(real_files, "rendered", rendered)
    monkeypatch.setattr(real_files, "show", lambda path, *pair: shown.append((path.parent.name, [float(one.max()) for one in pair])))
    options, one = real_files.arguments(["--output", str(tmp_path)]), real_files.listed()[0]
    options.grooves = True
    found, key = real_files.both(one, options, "a.blend"), real_files.key_of(one, options)
    assert {name: found[name] for name in wanted} == wanted and list(found) == [*one, *real_files.EMPTY]
    if "failed" in theirs:
        assert found == {**one, **real_files.EMPTY, **wanted}
    folder = "libshade-" + real_files.hashlib.sha256(b"add-on").hexdigest()[:12]
    assert asked == [("CYCLES", f"cycles/{key}", None, "a.blend"), ("LIBSHADE", f"{folder}/{key}-grooves", ["camera", "light"], "a.blend")][:2 if ours else 1]
    assert len(shown) == bool(values) and (not shown or np.isnan(values).any() or shown == [("pictures", [pytest.approx(value) for value in values])])


def test_what_of_a_file_is_shown(monkeypatch, capsys):
    """A material lies on a smooth ball and a box above a floor, or on round hair; a file opens without its scripts, and others are imported into nothing."""
    bpy, views, here = MagicMock(), [], SimpleNamespace(materials=[])
    render = in_blender(monkeypatch, bpy, [])
    monkeypatch.setattr(render, "add_camera", lambda points: views.append([tuple(point) for point in points]))
    bpy.data.libraries.load.return_value.__enter__.return_value = SimpleNamespace(materials=["wood", "tile"]), here
    render.opened({**JOB, "material": "tile"})
    assert bpy.data.libraries.load.call_args.args == ("a.blend",) and here.materials == ["tile"] and bpy.data.materials.__getitem__.call_args.args == ("tile",)
    mesh, order = bpy.ops.mesh, [name for name, *_ in bpy.mock_calls if name.endswith(("_add", "smooth", "settings", "append"))]
    assert order == ["ops.wm.read_factory_settings", "ops.mesh.primitive_uv_sphere_add", "ops.object.shade_smooth", "context.object.data.materials.append",
                     "ops.mesh.primitive_cube_add", "context.object.data.materials.append", "ops.mesh.primitive_plane_add", "context.object.data.materials.append"]
    ball, box = (one.call_args.kwargs for one in (mesh.primitive_uv_sphere_add, mesh.primitive_cube_add))
    assert ball["location"][2] == 1 and 0 < box["location"][2] - box["size"] / 2 < .02 and box["location"][0] - ball["location"][0] > 1 + box["size"] / 2
    tile, floor = bpy.data.materials.__getitem__.return_value, bpy.data.materials.new.return_value
    assert [call.args[0] for call in bpy.context.object.data.materials.append.call_args_list] == [tile, tile, floor] and floor.diffuse_color == (.5, .5, .5, 1)
    assert views == [[(-2, -1, 0), (2, 1, 2)]] and bpy.ops.wm.read_factory_settings.call_args.kwargs == {"use_empty": True}
    with pytest.raises(SystemExit, match="a.blend: no material 'stone'"):
        render.opened({**JOB, "material": "stone"})

    hair = bpy.data.hair_curves.new.return_value
    hair.attributes.get.return_value = None
    render.opened({**JOB, "material": "wood", "strands": True})
    points = hair.points.foreach_set.call_args.args[1].reshape(60, 6, 3)
    radii = hair.attributes.new.return_value.data.foreach_set.call_args.args[1].reshape(60, 6)
    assert hair.add_curves.call_args.args == ([6] * 60,) and hair.points.foreach_set.call_args.args[0] == "position" and points.dtype == np.float32
    assert np.allclose(points[:, 0, 2], -1) and np.allclose(points[:, -1, 2], 1) and np.allclose(np.diff(points[..., 2]), .4)
    assert (abs(points[:, 0]) <= (1.2, .4, 1)).all() and (np.ptp(points[:, 0], axis=0)[:2] > (2, .6)).all()
    bent = np.linalg.norm(points[:, -1, :2] - points[:, 0, :2], axis=1)
    assert .3 < bent.mean() < .7 and np.allclose(points[:, 1, :2] - points[:, 0, :2], (points[:, -1, :2] - points[:, 0, :2]) / 25, atol=1e-6)
    assert hair.attributes.new.call_args.args == ("radius", "FLOAT", "POINT") and np.allclose(radii, np.linspace(.06, .02, 6)) and radii.dtype == np.float32
    assert bpy.context.scene.cycles_curves.shape == "THICK" and hair.materials.append.call_args.args == (tile,) and views[1] == [(-1.2, -.6, -1), (1.2, .6, 1)]

    wm, read = bpy.ops.wm, []
    monkeypatch.setattr(render, "imported", read.append)
    render.opened(JOB)
    assert wm.open_mainfile.call_args.kwargs == {"filepath": "a.blend", "load_ui": False, "use_scripts": False}
    wm.open_mainfile.side_effect, bpy.data.filepath = RuntimeError("a library is missing"), "a.blend"
    render.opened(JOB)
    assert capsys.readouterr().out == "a library is missing\n" and not read
    bpy.data.filepath = "other.blend"
    with pytest.raises(RuntimeError, match="missing"):
        render.opened(JOB)
    wm.read_factory_settings.reset_mock()
    render.opened({**JOB, "file": "a.obj"})
    assert read == ["a.obj"] and wm.read_factory_settings.call_args.kwargs == {"use_empty": True}


@pytest.mark.parametrize("version, space", [((3, 4), "Linear"), ((4, 0), "Linear Rec.709")])
def test_a_picture_of_each_seed(monkeypatch, version, space):
    """The first is shown, by how much the second is apart is the noise, and the shorter time counts."""
    bpy, clock, settings = MagicMock(), [0.0], SimpleNamespace()
    bpy.app.version = version
    render = in_blender(monkeypatch, bpy, [])
    monkeypatch.setattr(render.time, "perf_counter", lambda: clock[0])
    seen = []

    def rendered(write_still):
        assert write_still is True
        seen.append((bpy.context.scene.render.filepath, settings.samples, settings.seed))
        clock[0] += 5 - settings.seed
    bpy.ops.render.render = rendered
    image = bpy.data.images.load.return_value
    image.size, image.pixels.__len__.return_value = (8, 4), 8 * 4 * 4

    def pixels(into):
        into[:] = np.repeat([[[1, 2, 3, 9]], [[1, 2, 6, 9]]][len(seen) - 1], 32, 0).ravel()
        into[:4] = 7, 7, 7, 9
    image.pixels.foreach_get.side_effect = pixels
    first, noise, seconds = render.pair({"output": "x"}, settings, 64)
    assert seen == [("x_1.exr", 64, 1), ("x_2.exr", 64, 2)] and [call.args[0] for call in bpy.data.images.load.call_args_list] == ["x_1.exr", "x_2.exr"]
    assert first.shape == (4, 8, 3) and first[0, 0].tolist() == [7, 7, 7] and first[3, 7].tolist() == [1, 2, 3] and seconds == 3
    assert noise == pytest.approx(15.5 / 16 / np.mean([2 + 5 / 32, 3 + 4 / 32]))  # the third channel of 31 pixels of 32
    assert image.colorspace_settings.name == space and bpy.data.images.remove.call_args.args == (image,)


# ---- how they are rendered, by programs that stand for others


JOB = {"file": "a.blend", "material": "", "engine": "CYCLES", "size": 128, "noise": 0.01, "cap": 4096, "seconds": 30.0, "threads": 0, "added": None,
       "grooves": False, "strands": False}


def test_an_engine_is_asked_once(tmp_path, monkeypatch):
    """With what is asked, and nothing of the caller's environment that changes pictures; what it said of ours is kept, a failure too."""
    blender, stem, options = tmp_path / "blender", tmp_path / "key", real_files.arguments(["--output", str(tmp_path)])
    monkeypatch.setattr(real_files.programs, "BLENDER", str(blender))
    for name in ("LIBSHADE_DUMP", "BLENDER_USER_DATAFILES", "PYTHONPATH"):
        monkeypatch.setenv(name, "/none")

    def stands(text):
        blender.write_text(f"#!/bin/sh\necho $* >>{tmp_path}/asked; env >{tmp_path}/env\n{text}\n")
        blender.chmod(0o755)
        return lambda row=row(""): real_files.rendered({**row, "blender": "3.4"}, "CYCLES", stem, None, "a.blend", options)
    warns = "echo 'Warning: libshade: a node'; echo 'Error: libshade: no image'; echo 'Warning: libshade: a node'; echo 'Warning: other'"
    told = '{"samples": 64, "noise": 0.002, "seconds": 1.5, "added": ["light"], "blender": "3.4.1"}'
    ask = stands(f"{warns}; echo '{told}' >{stem}.json")
    wanted = {**real_files.json.loads(told), "words": ["a node", "no image"]}
    assert ask() == wanted == ask()
    assert (tmp_path / "asked").read_text().splitlines() == [
        f"-b --factory-startup --python-exit-code 9 -P {real_files.programs.HERE}/real_files_render.py -- {stem}.job"]
    assert real_files.json.loads((tmp_path / "key.job").read_text()) == {**JOB, "output": str(stem)}
    environment = dict(line.partition("=")[::2] for line in (tmp_path / "env").read_text().splitlines())
    assert not {"LIBSHADE_DUMP", "BLENDER_USER_DATAFILES", "PYTHONPATH"} & set(environment)
    assert environment["BLENDER_USER_SCRIPTS"] == real_files.programs.ADD_ON["BLENDER_USER_SCRIPTS"] and environment["BLENDER_USER_CONFIG"] == f"{tmp_path}/config"
    (tmp_path / "key.json").write_text(told)  # without words: stopped in between
    assert ask() == wanted and len((tmp_path / "asked").read_text().splitlines()) == 2
    (tmp_path / "key.json").unlink()
    assert stands("exit 11")() == {"failed": "CYCLES: exit status 11, see key.log", "words": []}
    assert stands("exit 0")() == {"failed": "CYCLES: exit status 11, see key.log", "words": []}  # kept
    (tmp_path / "key.json").unlink()
    options.timeout = 0.1
    assert stands("exec sleep 9")()["failed"] == "CYCLES: more than 0.1 s"
    assert real_files.command_of("5.0", "x.job") == [str(real_files.BPY), f"{real_files.programs.HERE}/real_files_render.py", "--", "x.job"]


def test_all_of_a_list(tmp_path, monkeypatch, capsys):
    """Each in its turn; a package that cannot be had is asked for once."""
    rows = [{**row(""), "package": package, "path": path, "material": "", "blender": "3.4"} for package, path in (("a", "1.obj"), ("gone", "2.obj"), ("gone", "3.obj"), ("a", "4.obj"))]
    fetched = []

    def root_of(source, package, version, folder):
        fetched.append(package)
        if package == "gone":
            raise real_files.report.StepFailed("Fetching gone: no route\nmore")
        return tmp_path

    def path_of(_root, path):
        if path == "4.obj":
            raise OSError("4.obj: not in its package")
        return path
    monkeypatch.setattr(real_files_fetch, "root_of", root_of)
    monkeypatch.setattr(real_files_fetch, "path_of", path_of)
    monkeypatch.setattr(real_files, "listed", lambda pattern: rows)
    monkeypatch.setattr(real_files, "missing", lambda options, rows: options.output.mkdir(exist_ok=True))
    monkeypatch.setattr(real_files, "both", lambda row, options, file: {**row, **real_files.EMPTY, "state": "rendered", "difference": 0.04})
    status = real_files.main(["--output", str(tmp_path / "out")])
    said = capsys.readouterr()
    assert status == 1 and fetched == ["a", "gone", "a"] and [line.rpartition(" (")[0] for line in said.err.splitlines()] == [
        "1/4 a: 1.obj, 3.4: 0.04", "2/4 gone: 2.obj, 3.4: package: Fetching gone: no route", "3/4 gone: 3.obj, 3.4: package: Fetching gone: no route",
        "4/4 a: 4.obj, 3.4: 4.obj: not in its package"]
    assert said.out.splitlines()[-1] == "1 of 2 within 0.05 (50.0 %); of the other 1 0 with a warning; 2 not judged"
    assert (tmp_path / "out/results.csv").read_text().count("\n") == 5
    assert real_files.main(["--every", "3", "--list"]) == 0 and capsys.readouterr().out == "a: 1.obj, 3.4\na: 4.obj, 3.4\n"
    assert real_files.main(["--count", "1", "--output", str(tmp_path / "out")]) == 0
    rows.clear()
    assert real_files.main([]) == 1 and capsys.readouterr().out.endswith("none matches\n")


@pytest.mark.parametrize("versions, lacks, said", [(["3.4"], "ZIP", "make blender makes it"), (["5.0"], "BPY", "make compare-files makes it"),
                                                   (["5.0", "3.4"], "BLENDER", "BLENDER may name it"), (["3.4"], "BPY", ""), (["5.0"], "BLENDER", "")])
def test_what_has_to_be_there(tmp_path, monkeypatch, versions, lacks, said):
    (tmp_path / "there").write_text("#!/bin/sh\n")
    (tmp_path / "there").chmod(0o755)
    for name in ("ZIP", "BPY"):
        monkeypatch.setattr(real_files, name, tmp_path / ("none" if name == lacks else "there"))
    monkeypatch.setattr(real_files.programs, "BLENDER", str(tmp_path / ("none" if lacks == "BLENDER" else "there")))
    options = SimpleNamespace(output=tmp_path / "a/b")
    ask = lambda: real_files.missing(options, [{"blender": version} for version in versions])
    if said:
        with pytest.raises(real_files.report.StepFailed, match=f"none: .*{said}"):
            ask()
    else:
        ask()
        assert options.output.is_dir()


def test_pictures_side_by_side(tmp_path, monkeypatch):
    """Cycles', ours, and what ours has more in red, less in blue."""
    shown = []
    monkeypatch.setattr(real_files.pictures, "write_png", lambda path, image: shown.append(image))
    cycles, ours = np.full((4, 4, 3), 0.5), np.full((4, 4, 3), 0.5)
    ours[0], ours[1] = 0.75, 0.25
    real_files.show(tmp_path / "a/x.png", ours, cycles)
    assert shown[0].shape == (4, 12, 3) and np.allclose(shown[0][:, :4], 1) and np.allclose(shown[0][0, 4:8], 1.5)
    assert np.allclose(shown[0][0, 8:], [2, 0, -2]) and np.allclose(shown[0][1, 8:], [-2, 0, 2]) and np.allclose(shown[0][2, 8:], 0)


# ---- packages


@pytest.fixture
def fetched(tmp_path, monkeypatch):
    """Packages are "fetched" as files of these names; the commands asked for."""
    asked = []

    def step(words, command, log, folder):
        asked.append((words, command, folder))
        if "download" in command or "source" in command:
            got = {"apt-get": "p.deb" if "download" in command else "p_1.orig.tar.gz"}.get(command[0], "p.whl")
            with zipfile.ZipFile(folder / got, "w") if got == "p.whl" else tarfile.open(folder / got, "w:gz") as archive:
                if got == "p.whl":
                    archive.writestr("in/a.blend", "x")
                else:
                    for name in ("p-1/in/a.blend", "p-1/../../b.blend", "./p-1/c.blend"):
                        archive.addfile(tarfile.TarInfo(name))
        return ""
    monkeypatch.setattr(real_files_fetch.report, "step", step)
    monkeypatch.setattr(real_files_fetch, "_installed", lambda package: "1" if package == "there" else None)
    return asked


def test_packages_are_fetched_once(tmp_path, fetched):
    root_of = real_files_fetch.root_of
    assert str(root_of("deb", "there", "1", tmp_path)) == "/" and not fetched
    wheel = root_of("pypi", "p", "1", tmp_path)
    assert wheel == tmp_path / "p_1_pypi" and (wheel / "in/a.blend").is_file()
    words, command, _folder = fetched.pop()
    assert words == "Fetching p 1" and command[1:] == ["-m", "pip", "download", "-q", "--no-deps", "--only-binary", ":all:", "p==1"]
    assert root_of("pypi", "p", "1", tmp_path) == wheel and not fetched
    source = root_of("src", "p", "2:1", tmp_path)
    assert source == tmp_path / "p_2_1_src" and sorted(str(path.relative_to(source)) for path in source.rglob("*.blend")) == ["c.blend", "in/a.blend"]
    assert not list(tmp_path.glob("*.blend"))  # what would lie outside is left out
    assert fetched[0][0] == "apt-get update" and fetched[1][1][-4:] == ["source", "--download-only", "--tar-only", "p=2:1"]
    assert "Dir::Etc::sourcelist=/dev/null" in fetched[1][1] and f"Dir::State::Lists={tmp_path}/apt/lists" in fetched[1][1]
    del fetched[:]
    root_of("deb", "there", "2", tmp_path)  # another version than is installed
    assert [words for words, *_ in fetched] == ["Fetching there 2", "Unpacking there"] and fetched[0][1][-2:] == ["download", "there=2"]
    assert fetched[1][1][:2] == ["dpkg-deb", "-x"] and not (tmp_path / "part").exists()


# ---- materials.py


def test_materials_are_made_and_shown(tmp_path, monkeypatch, capsys):
    """In each Blender by its own Python; with --results with grooves that follow bumps, too."""
    blender, bpy = (tmp_path / name for name in ("blender", "python"))
    for program in (blender, bpy):
        program.write_text(f'#!/bin/sh\necho $* >>{tmp_path}/asked; env >{tmp_path}/env; for last; do :; done; [ -e {tmp_path}/fails ] && echo no node && exit 9\ntouch "$last"\n')
        program.chmod(0o755)
    monkeypatch.setattr(materials.programs, "BLENDER", str(blender))
    monkeypatch.setattr(real_files, "BPY", bpy)
    monkeypatch.setattr(real_files, "missing", lambda options, rows: options.output.mkdir(exist_ok=True))
    monkeypatch.setenv("PYTHONPATH", "/none")
    shown, kept = [], []

    def both(row, options, file):
        shown.append((row["material"], file, options.grooves))
        return {**row, **real_files.EMPTY, "state": "rendered", "difference": 0.04}
    monkeypatch.setattr(real_files, "both", both)
    monkeypatch.setattr(materials, "keep", lambda found, options: kept.append({grooves: len(of) for grooves, of in found.items()}))
    out = tmp_path / "out"
    first, second = (row["material"] for row in materials.listed(materials.arguments([]))[:2])
    assert materials.main(["--output", str(out), "--filter", f": ({first}|{second}),"]) == 0
    script = f"{materials.programs.HERE}/materials_make.py"
    assert (tmp_path / "asked").read_text().splitlines() == [f"-b --factory-startup --python-exit-code 9 -P {script} -- {out}/materials-3.4.blend", f"{script} -- {out}/materials-5.0.blend"]
    assert "PYTHONPATH" not in (tmp_path / "env").read_text()
    assert shown == [(first, f"{out}/materials-3.4.blend", False), (second, f"{out}/materials-5.0.blend", False)] and not kept
    said = capsys.readouterr()
    assert [line.rpartition(" (")[0] for line in said.err.splitlines()] == [f"1/2 materials: {first}, 3.4: 0.04", f"2/2 materials: {second}, 5.0: 0.04"]
    assert "2 of 2 within 0.05 (100.0 %)" in said.out and (out / "results.csv").read_text().count("\n") == 3
    shown.clear()
    assert materials.main(["--output", str(out), "--filter", f": {first},", "--results"]) == 0 and [grooves for *_, grooves in shown] == [False, True] and kept == [{False: 1, True: 1}]
    shown.clear()
    assert materials.main(["--output", str(out), "--filter", f": {first},", "--grooves", "--blender", "5.0"]) == 0 and shown == [(first, f"{out}/materials-5.0.blend", True)]
    capsys.readouterr()
    assert materials.main(["--filter", f": {first},", "--list"]) == 0 and capsys.readouterr().out == f"materials: {first}, 3.4\n"
    assert materials.main(["--filter", "no such"]) == 1 and capsys.readouterr().out == "none matches\n"
    (tmp_path / "fails").touch()
    with pytest.raises(real_files.report.StepFailed, match="materials-3.4.blend: not made\nno node"):
        materials.file_of("3.4", out)
    given = materials.arguments([])
    assert (given.size, given.noise, given.cap, given.seconds, given.timeout, given.threads) == (96, .015, 4096, 30, 240, 0) and given.share == pytest.approx(57 / 61)
    usual = real_files.arguments([])
    assert (usual.size, usual.noise, usual.limit, usual.share, usual.every, usual.count) == (128, .01, .05, .9, 1, 0)


def test_materials_are_of_this_world():
    """Colours, roughnesses and the like are shares, images have values from 0 to 1; each ends in a shader. Normals lean against the slope."""
    made = materials.materials_list
    for name, build in {**made.BUILDERS, **made.STRANDS}.items():
        maker = MagicMock()
        assert build(maker) is not None and maker.mock_calls, name
        for _name, words, options in maker.mock_calls:
            for image in (word for word in (*words, *options.values()) if isinstance(word, np.ndarray)):
                assert image.ndim == 3 and image.shape[2] == 3 and image.shape[0] == image.shape[1] and 0 <= image.min() <= image.max() <= 1 and np.ptp(image) > .05, name
            for key, value in options.items():
                if isinstance(value, (int, float, tuple)) and not isinstance(value, bool):
                    low, high = {"IOR": (1, 3), "Anisotropy": (-1, 1), "Scale": (0, 200), "Strength": (0, 20)}.get(key, (0, 1))
                    if key in ("Base_Color", "Color", "Roughness", "Metallic", "Anisotropic", "Anisotropy", "IOR", "Rotation", "Strength", "Sheen_Weight", "Sheen_Roughness", "Coat_Weight",
                               "Coat_Roughness", "Transmission_Weight", "Specular_IOR_Level"):
                        assert all(low <= one <= high for one in np.ravel(value)), (name, key, value)
    ramp = made._normals(np.tile(np.arange(8) / 16, (8, 1)), 2.0)[:, 1:-1]
    assert np.allclose(np.linalg.norm(2 * ramp - 1, axis=-1), 1) and np.allclose(2 * ramp[..., 0] - 1, -2 * .125 / np.hypot(.25, 1)) and np.allclose(ramp[..., 1], .5)
    assert np.allclose(made._normals(np.tile(np.arange(8) / 16, (8, 1)).T, 2.0)[1:-1, :, 1], ramp[:, :, 0].T) and made._grey(np.array([[-1, .5, 2]])).tolist() == [[[0] * 3, [.5] * 3, [1] * 3]]


# Of nodes that the materials are made of: inputs, outputs; * is a colour, - is off
NODES = {"OutputMaterial": ("Surface Displacement", ""), "BsdfPrincipled": ("*Base_Color Roughness Specular Clearcoat", "BSDF"), "TexCoord": ("", "Generated Object UV"),
         "Mapping": ("Vector Scale Rotation", "Vector"), "TexNoise": ("Vector -W Scale Detail Roughness Distortion", "-Fac Factor *Color"), "TexMusgrave": ("Vector Scale Detail", "Fac"),
         "TexVoronoi": ("Vector Scale Randomness", "Distance *Color"), "TexWave": ("Vector Scale Distortion Detail", "*Color Fac"), "ValToRGB": ("Fac", "*Color Alpha"),
         "MapRange": ("Value From_Min From_Max To_Min To_Max", "Result"), "Math": ("Value Value Value", "Value"), "Mix": ("Factor -Factor -A -B *A *B", "-Result *Result"),
         "Bump": ("Strength Distance Height Normal", "Normal"), "MixShader": ("Fac Shader Shader", "Shader"), "AddShader": ("Shader Shader", "Shader"), "TexImage": ("Vector", "*Color Alpha")}


@pytest.mark.parametrize("version", [(3, 4), (5, 0)])
def test_nodes_of_materials(monkeypatch, version):
    """By words of today's Blender in whichever there is; what an input is given is a value, or the first output of a node that is on."""
    def sockets(words):
        return [SimpleNamespace(name=word.lstrip("*-").replace("_", " "), type="RGBA" if "*" in word else "VALUE", enabled="-" not in word, default_value=None) for word in words.split()]
    made, images = [], []

    def node(kind):
        made.append(SimpleNamespace(kind=kind.removeprefix("ShaderNode"), **dict(zip(("inputs", "outputs"), map(sockets, NODES[kind.removeprefix("ShaderNode")])))))
        if made[-1].kind == "ValToRGB":
            elements = [SimpleNamespace(), SimpleNamespace()]
            made[-1].color_ramp = SimpleNamespace(elements=MagicMock(new=lambda _at: elements.append(SimpleNamespace()), __len__=lambda _self: len(elements), __iter__=lambda _self: iter(elements)))
        return made[-1]
    link = lambda output, socket: setattr(socket, "default_value", output)
    tree = MagicMock(nodes=MagicMock(new=node), links=MagicMock(new=link))
    tree.name = "tile"
    bpy = MagicMock(app=SimpleNamespace(version=version), types=SimpleNamespace(**({"ShaderNodeTexMusgrave": 1} if version < (4, 0) else {})))
    material = bpy.data.materials.new.return_value = SimpleNamespace(node_tree=tree, use_nodes=False, use_fake_user=False)
    bpy.data.images.new = lambda *words: images.append((words, MagicMock())) or images[-1][1]
    monkeypatch.setitem(sys.modules, "bpy", bpy)
    monkeypatch.delitem(sys.modules, "materials_make", raising=False)
    module = importlib.import_module("materials_make")
    monkeypatch.delitem(sys.modules, "materials_make")
    m = module.Maker("tile")
    assert bpy.data.materials.new.call_args.args == ("tile",) and material.use_fake_user and material.use_nodes == (version < (5, 0)) and tree.nodes.clear.called

    def of(shader, kind, properties=(), output=0, **inputs):
        """What it is linked by is an output of a node of that kind, which has these properties and inputs, by name or k for the kth that is on."""
        seen = shader.output()
        one = next(one for one in made if any(seen is socket for socket in one.outputs))
        given = {socket.name.replace(" ", "_"): socket.default_value for socket in one.inputs if socket.enabled and socket.default_value is not None}
        numbered = [socket.default_value for socket in one.inputs if socket.enabled]
        assert one.kind == kind and [socket for socket in one.outputs if socket.enabled][output] is seen and {name: getattr(one, name) for name in dict(properties)} == dict(properties)
        assert numbered == inputs["all"] if "all" in inputs else given == inputs, (kind, given)
        return one
    at = m.place(2)
    coordinates = next(one for one in made if one.kind == "TexCoord").outputs
    of(at, "Mapping", Vector=coordinates[1], Scale=(2, 2, 2), Rotation=(0, 0, 0))
    of(m.place((1, 2, 3), "UV", (0, 0, 1)), "Mapping", Vector=[one for one in made if one.kind == "TexCoord"][1].outputs[2], Scale=(1, 2, 3), Rotation=(0, 0, 1))
    place, grain = at.output(), m.noise(at, 3, 8, 0.55, 0.6)
    of(grain, "TexNoise", Vector=place, Scale=3, Detail=8, Roughness=0.55, Distortion=0.6)
    of(m.noise(color=True), "TexNoise", output=1, Scale=5, Detail=2, Roughness=0.5, Distortion=0)
    if version < (4, 0):
        of(m.musgrave(at, 4, 5, "HETERO_TERRAIN"), "TexMusgrave", {"musgrave_type": "HETERO_TERRAIN"}, Vector=place, Scale=4, Detail=5)
    else:  # the same, whose first octave is counted otherwise
        of(m.musgrave(at, 4, 5), "TexNoise", {"noise_type": "FBM", "normalize": False}, Vector=place, Scale=4, Detail=4)
    of(m.voronoi(at, 12, "DISTANCE_TO_EDGE", Randomness=0.5), "TexVoronoi", {"feature": "DISTANCE_TO_EDGE"}, Vector=place, Scale=12, Randomness=0.5)
    of(m.voronoi(at, 12, output="Color"), "TexVoronoi", {"feature": "F1"}, 1, Vector=place, Scale=12)
    of(m.wave(at, 30, 0.5, "RINGS", way="Z"), "TexWave", {"wave_type": "RINGS", "wave_profile": "SIN", "rings_direction": "Z"}, 1, Vector=place, Scale=30, Distortion=0.5, Detail=2)
    of(m.wave(at, 9, detail=3, profile="SAW"), "TexWave", {"wave_type": "BANDS", "wave_profile": "SAW", "bands_direction": "X"}, 1, Vector=place, Scale=9, Distortion=0, Detail=3)
    ramp = of(m.ramp(grain, (0.2, (0.1, 0.2, 0.3)), (0.5, 0.25), (0.7, 1), how="CONSTANT"), "ValToRGB", Fac=grain.output()).color_ramp
    assert [(one.position, one.color) for one in ramp.elements] == [(0.2, (0.1, 0.2, 0.3, 1)), (0.5, (0.25, 0.25, 0.25, 1)), (0.7, (1, 1, 1, 1))] and ramp.interpolation == "CONSTANT"
    of(m.range(grain, 0.35, 0.6, -1, 2), "MapRange", Value=grain.output(), From_Min=-1, From_Max=2, To_Min=0.35, To_Max=0.6)
    of(m.math("MULTIPLY_ADD", grain, 2, 3), "Math", {"operation": "MULTIPLY_ADD"}, all=[grain.output(), 2, 3])
    of(m.color("MULTIPLY", 0.3, (0.1, 0.2, 0.3), 0.5), "Mix", {"data_type": "RGBA", "blend_type": "MULTIPLY"}, all=[0.3, (0.1, 0.2, 0.3, 1), (0.5, 0.5, 0.5, 1)])
    bump = m.bump(grain, 0.8, 0.03, invert=True)
    of(bump, "Bump", {"invert": True}, Height=grain.output(), Strength=0.8, Distance=0.03)
    of(m.bump(grain, normal=bump), "Bump", {"invert": False}, Height=grain.output(), Strength=0.3, Distance=0.1, Normal=bump.output())
    shader = m.principled(Base_Color=0.5, Roughness=grain, Specular_IOR_Level=0.3, Coat_Weight=0.4, Coat_Tint=(1, 1, 1))  # the last is left out where there is none
    of(shader, "BsdfPrincipled", **{"Base_Color": (0.5, 0.5, 0.5, 1), "Roughness": grain.output(), "Specular": 0.3, "Clearcoat": 0.4})
    with pytest.raises(KeyError, match="no socket 'Rougness' among .*'Roughness'"):
        m.principled(Rougness=0.5)
    of(m.mix(0.3, shader, bump), "MixShader", all=[0.3, shader.output(), bump.output()])
    of(m.add(shader, bump), "AddShader", all=[shader.output(), bump.output()])
    pixels = np.arange(24).reshape(2, 4, 3) / 24
    for data in (False, True):
        shown = of(m.image(pixels, at, data), "TexImage", Vector=place)
        words, image = images[-1]
        assert words == ("tile", 4, 2) and shown.image is image and image.pack.called and (image.colorspace_settings.name == "Non-Color") == data
        assert np.allclose(image.pixels.foreach_set.call_args.args[0].reshape(2, 4, 4), np.concatenate([pixels, np.ones((2, 4, 1))], 2))
    m.surface(shader)
    m.displaced(bump)
    assert [socket.default_value for socket in m.end.node.inputs] == [shader.output(), bump.output()]
    built = []
    monkeypatch.setattr(module.materials_list, "BUILDERS", {"one": lambda maker: built.append(maker) or shader})
    monkeypatch.setattr(module.materials_list, "STRANDS", {"hair_two": lambda maker: built.append(maker) or shader})
    monkeypatch.setattr(module.os, "_exit", lambda status: built.append(status))
    module.main("x.blend")
    assert len(built) == 3 and built[2] == 0 and all(maker.end.node.inputs[0].default_value is shader.output() for maker in built[:2])
    assert [call.args[0] for call in bpy.data.materials.new.call_args_list[-2:]] == ["one", "hair_two"]
    assert bpy.ops.wm.read_factory_settings.call_args.kwargs == {"use_empty": True} and bpy.ops.wm.save_as_mainfile.call_args.kwargs == {"filepath": "x.blend"}
