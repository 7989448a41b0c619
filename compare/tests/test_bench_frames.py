# SPDX-License-Identifier: Apache-2.0
"""bench_frames.py without a renderer: medians and quarters, which scenes are taken on, what it says of known times."""
import pickle
import subprocess
import sys
from types import SimpleNamespace as Of

import numpy as np
import pytest

import bench_frames as bench
import programs

COST = 2.6

SCENES = [bench.Scene(name, programs.ROOT / "x.py") for name in ("pan", "pan-near", "dial")]


def row_of(name, *pairs, largest=0.0):
    row = bench.Row(name)
    for before, after in pairs:
        row.add((before, after), largest, largest / 10)
    return row


@pytest.mark.parametrize("ratios, low, median, high", [
    ([1.5], 1.5, 1.5, 1.5), ([3, 1, 2], 1.5, 2, 2.5), ([4, 1, 3, 2, 5], 2, 3, 4), ([1, 2, 3, 4], 1.75, 2.5, 3.25),
])
def test_quarters_are_those_of_the_ratios(ratios, low, median, high):
    row = row_of("pan", *((2.0, 2.0 * ratio) for ratio in ratios))
    assert row.quarters() == pytest.approx((low, median, high))
    assert row.error() == pytest.approx(0.93 * (high - low) / len(ratios) ** 0.5)
    assert row.least(0) == 2 and row.least(1) == pytest.approx(2 * min(ratios))


def test_a_scene_that_is_slower_is_named_and_one_that_looks_different():
    rows = [row_of("pan", (1, 1.02), (1, 1.04), (1, 1.05)), row_of("dial", (1, 1.0), (1, 1.02), (1, 1.03), largest=2e-5),
            row_of("table", (1, 0.5), (1, 0.7), (1, 0.6), largest=9e-6)]
    rows[2].largest, rows[2].mean = 9e-6, 0  # the largest counts
    said = "\n".join(bench.verdict(rows, 1.03, False))
    assert "Over 1.03: pan." in said and "Pictures differ: dial." in said and "Median of 3 scenes 1.020, 0.600 to 1.040" in said
    assert "byte for byte" not in said
    assert "0.400 is what this machine's noise makes of 1" in "\n".join(bench.verdict(rows, 1.03, True))
    assert "Over 1.05: none." in "\n".join(bench.verdict(rows, 1.05, False))
    lines = {line.split()[0]: line for line in bench.table(rows, 1.03).splitlines()}
    assert lines["pan"].split()[1:5] == ["1.040", "1.030", "to", "1.045"] and lines["pan"].endswith("same  slower")
    assert lines["dial"].split()[-3:] == ["2.0e-05", "2.0e-06", "differs"] and lines["table"].split()[-1] == "same"
    assert rows[0].numbers()["ratio"] == pytest.approx(1.04) and rows[1].numbers()["largest_difference"] == 2e-5


@pytest.mark.parametrize("minutes, count", [(1e9, {"pan": 3, "pan-near": 5, "dial": 3}), (0, {"pan": 3, "pan-near": 3, "dial": 3})])
def test_pairs_begin_in_turns_and_go_on_where_a_median_is_not_sure(minutes, count):
    """pan-near's ratios part by a tenth at first: its quarters are near each other after five."""
    asked = []
    ratios = {"pan": iter([1, 1, 1]), "pan-near": iter([1, 1.1, 1, 1, 1]), "dial": iter([2, 2, 2])}

    def pair(scene, swapped):
        asked.append((scene.name, swapped))
        return (1.0, next(ratios[scene.name])), 0.0, 0.0
    rows = {scene.name: bench.Row(scene.name) for scene in SCENES}
    bench.take(SCENES, rows, pair, minutes)
    assert {name: len(row.seconds) for name, row in rows.items()} == count
    assert [swapped for name, swapped in asked if name == "pan-near"] == [bool(k % 2) for k in range(count["pan-near"])]
    assert [name for name, _ in asked[:3]] == list(count)


def test_differences_of_pictures():
    """Of a bright pixel as a part of itself."""
    one = np.array([[0.5, 0.5, 0.5], [10.0, 0.25, 0.25]])
    mean = one.mean()
    assert bench.differences(one, one) == (0, 0)
    assert bench.differences(one, one + np.array([[0, 0, 0], [1e-3, 0, 0]])) == pytest.approx((1e-4, 1e-3 / 6 / mean))
    assert bench.differences(one, one + np.array([[0, 1e-3, 0], [0, 0, 0]])) == pytest.approx((1e-3 / mean, 1e-3 / 6 / mean))


def test_which_scenes_a_word_names():
    def names(*words):
        return [scene.name for scene in bench.chosen(SCENES, words)]
    assert names() == ["pan", "pan-near", "dial"] and names("pan") == ["pan"] and names("pa", "d") == ["pan", "pan-near", "dial"]
    with pytest.raises(bench.Failed, match="tree: no scene"):
        names("tree")


def test_seconds_of_a_frame_of_povray():
    """Not those of parsing."""
    said = "Parse Time: x\n using 1 thread(s) with 5.0 CPU-seconds total\nRender Time:\n Radiosity Time: x (1 seconds)\n" \
        " using 1 thread(s) with 1.250 CPU-seconds total\n Trace Time: x\n using 1 thread(s) with 0.500 CPU-seconds total\n"
    assert bench.seconds_of_povray(said) == 1.75
    with pytest.raises(bench.Failed):
        bench.seconds_of_povray("Render Time: none")


def test_every_example_is_there():
    scenes = bench.blender_scenes() + bench.povray_scenes()
    folders = {path.parent.name for path in programs.ROOT.glob("examples/*/*/*.p*") if path.suffix in (".py", ".pov")} - {"cookbook"}
    assert folders == {scene.script.parent.name for scene in scenes if "examples" in scene.script.parts} | {bench.SUZANNE.stem}
    assert "suzanne" in {scene.name for scene in scenes}
    assert {"plate", "studio", "room"} <= {scene.name for scene in scenes} and len({scene.name for scene in scenes}) == len(scenes)


@pytest.mark.parametrize("arguments, status, words", [
    ([], 2, "BEFORE is missing"), (["nosuch"], 2, "nosuch: no commit"), (["HEAD", "--only", "nosuch"], 2, "nosuch: no scene"),
    (["HEAD", "--limit", "0"], 2, "--limit"), (["--help"], 0, ""), (["--list"], 0, ""),
])
def test_ends(arguments, status, words):
    said = subprocess.run([sys.executable, programs.HERE / "bench_frames.py", *arguments], capture_output=True, text=True, timeout=60)
    assert said.returncode == status and words in said.stderr and "Traceback" not in said.stderr


def test_a_commits_add_on_has_the_modules_of_its_packages():
    made = bench.goals(programs.ROOT)
    packages = [path.parent for path in (programs.ROOT / "blender_addon_c").glob("*/__init__.py")]
    assert len(packages) > 1
    for module in (module for package in packages for module in package.glob("*.py")):
        assert f"build/blender/addons/libshade/{module.parent.name}/{module.name}" in made


def test_a_commits_add_on_has_its_own_libraries():
    """By its Makefile, whatever lies in build/."""
    native = [path for path in bench.goals(programs.ROOT) if path.endswith(".so")]
    assert sorted(native) == [f"build/blender/addons/libshade/{name}.so" for name in (
        "_native.abi3", "lib/libshade_embree", "lib/libshade_openexrcore", "lib/libshade_tbb")]


def test_what_is_kept_is_of_the_same_files(tmp_path, monkeypatch):
    """A scene's file is kept with what it was made from: the add-on's modules, its script and what stands beside, its order."""
    side, scene = bench.Side(tmp_path, tmp_path / "scenes"), bench.Scene("pan", tmp_path / "make.py")
    for file in (side.add_on / "nodes.py", side.add_on / "export/scene.py", scene.script):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("a")
    side.scenes.mkdir()
    assert bench.kept(side, scene) is None
    side.file(scene).with_suffix(".of").write_text("of")
    assert bench.kept(side, scene) is None  # what was made is gone
    side.file(scene).write_text("made")
    assert bench.kept(side, scene) == "of"
    seen = [bench.made_from(side, scene)]
    for file in (side.add_on / "nodes.py", side.add_on / "export/scene.py", scene.script):
        file.write_text("b")
        seen.append(bench.made_from(side, scene))
    seen.append(bench.made_from(side, scene._replace(samples=17)))
    monkeypatch.setitem(bench.ORDERS, "pan", {"size": 1})
    seen.append(bench.made_from(side, scene))
    assert len(set(seen)) == len(seen) and bench.made_from(side, scene) == seen[-1]


def test_what_is_there_is_not_made_again(tmp_path, monkeypatch):
    """Suzanne's scene is, by the older add-on; what POV-Ray reads of it and pictures are not."""
    made = []
    monkeypatch.setattr(bench, "FRAMES", tmp_path)
    monkeypatch.setattr(bench, "ORDERS", {"plate": {"size": 8}})
    monkeypatch.setattr(bench.pictures, "write_float", lambda path, _pixels: (path.touch(), made.append(path.name)))
    monkeypatch.setattr(bench.report, "step", lambda text, _command, log, environment: made.append((text.split(" (")[0], log.name, environment["BLENDER_USER_SCRIPTS"])))
    monkeypatch.setattr(bench.subprocess, "run", lambda words, **_options: made.append(words[-1].name))
    monkeypatch.setattr(bench.plate, "normal_map", lambda _size: None)
    older = bench.Side(tmp_path / "old", tmp_path)
    scene = lambda name: bench.Scene(name, programs.ROOT / "x.py")
    building, writing = (("Building suzanne.blend", "suzanne.log", str(tmp_path / "old/build/blender")),
                         ("Writing it for POV-Ray", "suzanne.log", programs.ADD_ON["BLENDER_USER_SCRIPTS"]))
    for names, wanted in ((["povray-suzanne"], ["normals.exr", "sky.exr", building, writing]), (["povray-suzanne"], [building]), (["suzanne"], [building]),
                          (["pan"], []), (["povray-embossed"], ["basket.png"])):
        made.clear()
        bench.prepare([scene(name) for name in names], older)
        assert made == wanted, names
        (tmp_path / "povray").mkdir(exist_ok=True)
        (tmp_path / "povray/meshes.inc").touch()
    assert (tmp_path / "plate.json").exists()


def test_what_a_scene_hands_over_is_taken(tmp_path, monkeypatch, capsys):
    """In the place of the renderer: the frame, not pictures of another size on the way; a scene that renders without our engine is said."""
    opened, rendered, frame = [], [], Of(resolution_x=40, resolution_y=30, resolution_percentage=50, engine="CYCLES")
    scene = Of(render=frame, libshade=Of(samples=1, max_bounces=2))
    native = Of(start=lambda given, *before: rendered.append((given["width"], before)) or "a job")
    handlers = Of(persistent=lambda function: function, render_init=[])

    def render():
        for handler in handlers.render_init:
            handler(scene)
        native.start({"width": 8, "height": 8}, "before")
        native.start({"width": 20, "height": 15, "data": np.arange(3), "of": [1, None]})
    bpy = Of(app=Of(handlers=handlers), context=Of(scene=scene), ops=Of(wm=Of(read_factory_settings=lambda: opened.append("factory"), open_mainfile=lambda filepath: opened.append(filepath)),
                                                                     preferences=Of(addon_enable=lambda module: opened.append(module)), render=Of(render=render)))
    monkeypatch.setitem(sys.modules, "bpy", bpy)
    monkeypatch.setitem(sys.modules, "libshade._native", native)
    monkeypatch.setattr(sys, "argv", ["blender"])
    path = programs.HERE / "bench_frames_export.py"
    script = {"__file__": str(path), "__name__": "bench_frames_export"}
    exec(compile(path.read_text(encoding="utf-8").split("\nmain(")[0], str(path), "exec"), script)
    order = {"script": "a.blend", "arguments": ["x"], "output": str(tmp_path / "frame"), "percentage": 50, "samples": 9, "settings": {"max_bounces": 5, "none": 1}}
    with pytest.raises(script["Taken"]):
        script["take"](order)
    assert rendered == [(8, ("before",))] and sys.argv == ["blender", "--", "x"]
    assert frame.engine == "LIBSHADE" and frame.resolution_percentage == 50 and vars(scene.libshade) == {"samples": 9, "max_bounces": 5}
    given = pickle.loads((tmp_path / "frame").read_bytes())
    assert given["width"] == 20 and given["of"] == [1, None] and np.array_equal(given["data"], np.arange(3))
    assert opened == ["factory", "libshade", "a.blend"]
    (tmp_path / "make.py").write_text("import sys\nimport bpy\nassert sys.argv[1:] == ['--', 'near']\nbpy.context.scene.libshade.samples = 77\nbpy.ops.render.render()\n")
    handlers.render_init.clear()
    with pytest.raises(script["Taken"]):  # a script that renders by itself
        script["take"]({**order, "script": str(tmp_path / "make.py"), "arguments": ["near"], "output": str(tmp_path / "other")})
    assert opened[3:] == ["factory", "libshade"] and scene.libshade.samples == 9 and (tmp_path / "other").exists()
    taken = []
    script["take"] = lambda one: taken.append(one)
    (tmp_path / "order.json").write_text("[1, 2, 3]")
    script["main"](tmp_path / "order.json")
    assert taken == [1, 2, 3] and capsys.readouterr().out == "\n33 %\n\n66 %\n\n100 %\n"
    exec(compile(path.read_text(encoding="utf-8").split("\nmain(")[0], str(path), "exec"), script)
    handlers.render_init.clear()
    bpy.ops.render.render = lambda: None
    with pytest.raises(RuntimeError, match="a.blend: rendered without our engine"):
        script["take"](order)

    def fails():
        raise RuntimeError("no camera")
    bpy.ops.render.render = fails
    with pytest.raises(RuntimeError, match="no camera"):
        script["take"](order)


# ---- what it does, of renderers that others stand for


def test_what_scenes_are():
    """The plate and the rooms by their orders, POV-Ray's without samples; views of a scene are scenes of their own."""
    scenes = {scene.name: scene for scene in bench.blender_scenes() + bench.povray_scenes()}
    sky, normals = (str(bench.FRAMES / f"{name}.exr") for name in ("sky", "normals"))
    plate = {"engine": "LIBSHADE", "output": "", "surface": "bumped", "detail": "rotate", "size": 512, "samples": 64, "quads": 1, "repeat": 1}
    room = {"engine": "LIBSHADE", "output": "", "size": 256, "samples": 16, "seed": 0}
    assert bench.ORDERS == {"plate": {"normal_map": normals, "result": "", "jobs": [plate]}, "plate-unfiltered": {"normal_map": normals, "result": "", "jobs": [plate]},
                            "plate-sky": {"normal_map": normals, "result": "", "jobs": [{**plate, "size": 256, "samples": 16, "sky": sky}]},
                            "studio": {"sky": sky, "result": "", "jobs": [{**room, "scene": "studio"}]}, "room": {"sky": sky, "result": "", "jobs": [{**room, "scene": "room"}]}}
    said = {name: (scenes[name].script.name, scenes[name].samples, scenes[name].percentage, dict(scenes[name].settings)) for name in bench.ORDERS}
    assert said == {"plate": ("plate_render.py", 64, 100, {"filter_normals": True}), "plate-unfiltered": ("plate_render.py", 64, 100, {"filter_normals": False}),
                    "plate-sky": ("plate_render.py", 16, 100, {"filter_normals": True}), "studio": ("paths_render.py", 16, 100, {}), "room": ("paths_render.py", 16, 100, {})}
    assert {scene.samples for name, scene in scenes.items() if name.startswith("povray-")} == {0} and scenes["pan"].samples == 16 and scenes["pan"].percentage == 25
    assert scenes["jacket-near"].arguments == (str(bench.FRAMES / "jacket.blend"), "near") and scenes["jacket"].arguments == (str(bench.FRAMES / "jacket.blend"),)
    assert scenes["povray-metals"].script.name == "metals.pov" and scenes["plate"].arguments == (str(bench.FRAMES / "plate.json"),)
    side = bench.Side(programs.ROOT / "x", programs.ROOT / "y")
    assert (side.file(scenes["pan"]), side.povray, side.add_on) == (programs.ROOT / "y/pan.pickle", programs.ROOT / "x/build/povray/povray",
                                                                   programs.ROOT / "x/build/blender/addons/libshade")


def test_a_build_of_a_commit_is_made_once(tmp_path, monkeypatch):
    """Of its own files, with what was fetched for POV-Ray; a make that fails leaves nothing that looks built."""
    steps = []
    monkeypatch.setattr(bench, "BEFORE", tmp_path / "before")
    monkeypatch.setattr(bench, "goals", lambda root: [root.name])
    monkeypatch.setattr(bench.programs, "BUILD", tmp_path / "build")
    monkeypatch.setattr(bench.os, "cpu_count", lambda: 5)
    (tmp_path / "build/povray/download").mkdir(parents=True)
    (tmp_path / "build/povray/download/povray.tar.gz").touch()
    commit = "1234abcd"

    def run(words, input=None, **_options):
        words = [str(word) for word in words]
        if words[0] == "tar":
            assert input == f"of {commit}".encode()
            (tmp_path / "before" / commit / "Makefile").touch()
        return Of(returncode=int(words[-1].startswith("none")), stdout=f"{commit}\n" if "rev-parse" in words else f"of {words[-1]}".encode())
    monkeypatch.setattr(bench.subprocess, "run", run)
    monkeypatch.setattr(bench.programs, "ROOT", tmp_path)
    monkeypatch.setattr(bench.report, "step", lambda *words: steps.append(words))
    root = tmp_path / "before" / commit
    for _ in range(2):
        assert bench.before("v1") == bench.Side(root, root / "frames")
    assert steps == [(f"Building v1 in before/{commit} (minutes)", ["make", "-j5", commit], root / "built.log", bench.NOT_FROM_MAKE, root)]
    assert bench.NOT_FROM_MAKE == {"MAKEFLAGS": "", "MFLAGS": "", "MAKEOVERRIDES": "", "MAKELEVEL": ""}
    assert (root / "build/povray/download/povray.tar.gz").exists() and (root / "built").exists() and (root / "Makefile").exists()
    with pytest.raises(bench.Failed, match=f"none: no commit of {tmp_path}"):
        bench.before("none")
    commit = "5678"
    monkeypatch.setattr(bench.report, "step", lambda *words: (_ for _ in ()).throw(bench.report.StepFailed("no compiler")))
    with pytest.raises(bench.report.StepFailed):
        bench.before("v2")
    assert not (tmp_path / "before/5678/built").exists()


def test_scenes_are_exported_once(tmp_path, monkeypatch):
    """By the add-on of each build; where both have the same Python, one's are the other's."""
    orders, made_of = [], {"old": "a", "new": "b"}
    monkeypatch.setattr(bench, "made_from", lambda side, scene: f"{made_of[side.root.name]} {scene.name}")
    monkeypatch.setattr(bench.os, "cpu_count", lambda: 2)

    def step(text, command, log, environment):
        order = bench.json.loads(bench.Path(command[-1]).read_text())
        orders.append((text.rpartition("/")[2], environment["BLENDER_USER_SCRIPTS"].partition("/build")[0].rpartition("/")[2], [bench.Path(of["output"]).name for of in order]))
        for of in order:
            assert (of["percentage"], of["samples"], of["settings"], of["script"]) == (25, 16, {}, str(programs.ROOT / "x.py"))
            bench.Path(of["output"]).write_text("made")
    monkeypatch.setattr(bench.report, "step", step)
    sides = [bench.Side(tmp_path / name, tmp_path / name / "frames") for name in ("old", "new")]
    bench.export(sides, SCENES)
    both = [["pan.pickle", "dial.pickle"], ["pan-near.pickle"]]
    assert sorted(orders) == sorted((side, side, files) for side in ("old", "new") for files in both)
    del orders[:]
    bench.export(sides, SCENES)
    assert not orders
    made_of.update(old="c", new="c")
    bench.export(sides, SCENES)
    assert sorted(orders) == sorted(("old", "old", files) for files in both)
    assert all(bench.kept(side, scene) == f"c {scene.name}" for side in sides for scene in SCENES)


def test_a_pair_of_each_renderer(tmp_path, monkeypatch):
    """Which is first by turns; POV-Ray's size by its scene, one thread, the picture as a file of floats."""
    asked = []
    monkeypatch.setattr(bench, "FRAMES", tmp_path)
    monkeypatch.setenv("LIBSHADE_TIMINGS", "1")

    def said_by(command, **options):
        asked.append([str(word) for word in command])
        assert "LIBSHADE_TIMINGS" not in options["env"] and options["env"]["MALLOC_MMAP_THRESHOLD_"] == options["env"]["MALLOC_TRIM_THRESHOLD_"] == "131072"
        return Of(stdout='{"seconds": [[1, 3], [2, 6]], "differences": [0.5, 0.25]}', stderr=f"Render Time:\n with {len(asked)}.5 CPU-seconds total\n")
    monkeypatch.setattr(bench, "said_by", said_by)
    monkeypatch.setattr(bench.pictures, "read", lambda path: np.full((2, 2, 3), {"0.exr": 1.0, "1.exr": 1.5}[path.name.rpartition("-")[2]]))
    old, new = (bench.Side(tmp_path / name, tmp_path / name) for name in ("old", "new"))
    for swapped, first in ((False, "A"), (True, "B")):
        assert bench.pair_of(SCENES[0], (old, new), swapped) == ((2, 4), .5, .25)
        assert asked.pop() == [sys.executable, str(programs.HERE / "bench_frames_turns.py"), str(old.add_on), str(old.file(SCENES[0])), str(new.add_on),
                               str(new.file(SCENES[0])), "--first", first]
    scene = bench.Scene("povray-cloth", tmp_path / "cloth.pov", (), 0)
    assert bench.pair_of(scene, (old, new), False) == ((1.5, 2.5), .5, .5) and [words[0] for words in asked] == [str(old.povray), str(new.povray)]
    assert asked[0][1:] == [f"+I{tmp_path}/cloth.pov", f"+L{tmp_path}", f"+L{tmp_path}/povray", f"+O{tmp_path}/povray-cloth-0.exr", "+FE", "+W64", "+H36", "-A", "+WT1", "-D"]
    del asked[:]
    assert bench.pair_of(scene._replace(script=tmp_path / "other.pov"), (old, new), True) == ((2.5, 1.5), .5, .5)
    assert [words[0] for words in asked] == [str(new.povray), str(old.povray)] and asked[0][6:8] == ["+W128", "+H72"]


def test_a_program_that_fails_says_its_last_words(tmp_path):
    failing = tmp_path / "povray"
    failing.write_text("#!/bin/sh\nfor k in 1 2 3 4 5 6 7; do echo line $k >&2; done\nexit 4\n")
    failing.chmod(0o755)
    with pytest.raises(bench.Failed) as wrong:
        bench.said_by([failing])
    assert str(wrong.value).splitlines() == [f"{failing}: status 4", *(f"line {k}" for k in range(2, 8))]


def test_same_builds(tmp_path):
    sides = [bench.Side(tmp_path / name, tmp_path) for name in ("old", "new")]
    native, povray = "build/blender/addons/libshade/_native.abi3.so", "build/povray/src/unix/povray"
    for side in sides:
        for file in (native, povray):
            (side.root / file).parent.mkdir(parents=True, exist_ok=True)
            (side.root / file).write_text("a" if file == native else side.root.name)
    blenders, both = SCENES[:1], [*SCENES[:1], bench.Scene("povray-x", tmp_path, (), 0)]
    assert bench.same_builds(sides, blenders) and not bench.same_builds(sides, both) and not bench.same_builds(sides, both[1:])


@pytest.mark.parametrize("ratios, wrong, status", [((1.0, 1.0), None, 0), ((1.0, 1.1), None, 1), ((1.1, 1.0), KeyboardInterrupt(), 130), ((1.0, 1.0), bench.Failed("no more"), 2)])
def test_what_is_told_at_the_end(tmp_path, monkeypatch, capsys, ratios, wrong, status):
    """Also of what was measured before it broke off."""
    monkeypatch.setattr(bench, "blender_scenes", lambda: SCENES[1:])
    monkeypatch.setattr(bench, "povray_scenes", list)
    monkeypatch.setattr(bench, "before", lambda word: bench.Side(tmp_path / word, tmp_path))
    for name in ("prepare", "export"):
        monkeypatch.setattr(bench, name, lambda *_words: None)
    monkeypatch.setattr(bench, "same_builds", lambda *_words: False)
    of = dict(zip(("pan-near", "dial"), ratios))
    monkeypatch.setattr(bench, "pair_of", lambda scene, _sides, _swapped: ((2.0, 2 * of[scene.name]), 0.0, 0.0))
    if wrong:
        turns = iter(range(5))
        measure = bench.pair_of
        monkeypatch.setattr(bench, "pair_of", lambda *words: measure(*words) if next(turns) < 4 else (_ for _ in ()).throw(wrong))
    assert bench.main(["v1", "-o", str(tmp_path / "out.csv")]) == status
    said = capsys.readouterr()
    assert said.out.splitlines()[2].split()[:5] == ["pan-near", f"{ratios[0]:.3f}", f"{ratios[0]:.3f}", "to", f"{ratios[0]:.3f}"]
    assert said.out.splitlines()[0].split("  ")[0] == "scene" and said.out.splitlines()[4:6] == ["", f"Median of 2 scenes {sum(ratios) / 2:.3f}, 1.000 to {max(ratios):.3f}."]
    head, first, _second = (tmp_path / "out.csv").read_text().splitlines()
    assert head == "scene,pairs,ratio,low,high,seconds_before,seconds_after,largest_difference,mean_difference"
    assert first.split(",")[:2] == ["pan-near", "2" if wrong else "3"] and float(first.split(",")[6]) == pytest.approx(2 * ratios[0])
    told = {0: [], 1: [], 130: ["bench_frames.py: broken off"], 2: ["bench_frames.py: no more"]}[status]
    assert said.err.splitlines()[4 if wrong else 6:] == told
    assert said.err.splitlines()[0].split("min")[1] == f"  pair 1  pan-near             {ratios[0]:.3f} ({ratios[0]:.3f} to {ratios[0]:.3f})"


def test_builds_take_turns_at_frames(tmp_path, monkeypatch, capsys):
    """Of one scene in one process: as many frames as take half a second, one build first, then the other."""
    import bench_frames_turns as turns
    done, clock, waited = [], [0.0], []

    def module(folder):
        def start(scene):
            done.append(("start", folder))
            return Of(scene=scene)

        def look(job, view):
            assert view == {name: job.scene[name] for name in ("width", "height", "region", "samples", "camera")}
            clock[0] += {"a": .1, "b": .08}[folder]
            done.append(("look", folder))
            return job

        def image(_job, pixels):
            assert pixels.shape == (2 * 3 * 4,) and pixels.dtype == np.float32
            pixels.reshape(-1, 4)[:] = [{"a": 1, "b": 1.5}[folder]] * 3 + [9]
        return Of(start=start, look=look, wait=lambda *_job: waited.append(done[-1]), poll=lambda _job: {"state": "done", "message": ""}, image=image)
    monkeypatch.setattr(turns.importlib.util, "spec_from_file_location", lambda _name, path: Of(path=path, loader=Of(exec_module=lambda _module: None)))
    monkeypatch.setattr(turns.importlib.util, "module_from_spec", lambda spec: module(spec.path.split("/")[0]))
    monkeypatch.setattr(turns.time, "process_time", lambda: clock[0])
    scene = {"width": 4, "height": 4, "region": (1, 1, 3, 4), "samples": 16, "camera": "c", "more": 1}
    (tmp_path / "s").write_bytes(pickle.dumps(scene))
    for first, other in (("A", "B"), ("B", "A")):
        done.clear()
        waited.clear()
        monkeypatch.setattr(sys, "argv", ["turns", "a", str(tmp_path / "s"), "b", str(tmp_path / "s"), *(["--first", first] if first == "B" else [])])
        turns.main()
        found = turns.json.loads(capsys.readouterr().out)
        assert found["seconds"] == [pytest.approx([.1] * 4), pytest.approx([.08] * 4)] and found["differences"] == [.5, .5]
        f, o = first.lower(), other.lower()
        assert done == [("start", f), ("start", o), *(("look", side) for side in (f, o, f, o, o, f, f, o, o, f))] and waited == done
    monkeypatch.setattr(turns.importlib.util, "module_from_spec", lambda spec: Of(start=lambda _scene: 1, wait=lambda *_job: None,
                                                                                 poll=lambda _job: {"state": "failed", "message": "no memory"}))
    with pytest.raises(SystemExit, match="failed: no memory"):
        turns.main()
