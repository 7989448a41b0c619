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

COST = 2.2

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


def test_what_a_scene_hands_over_is_taken(tmp_path, monkeypatch):
    """In the place of the renderer: the frame, not pictures of another size on the way; a scene that renders without our engine is said."""
    rendered, frame = [], Of(resolution_x=40, resolution_y=30, resolution_percentage=50, engine="CYCLES")
    scene = Of(render=frame, libshade=Of(samples=1, max_bounces=2))
    native = Of(start=lambda given, *before: rendered.append((given["width"], before)) or "a job")
    handlers = Of(persistent=lambda function: function, render_init=[])

    def render():
        for handler in handlers.render_init:
            handler(scene)
        native.start({"width": 8, "height": 8}, "before")
        native.start({"width": 20, "height": 15, "data": np.arange(3), "of": [1, None]})
    bpy = Of(app=Of(handlers=handlers), context=Of(scene=scene), ops=Of(wm=Of(read_factory_settings=lambda: None, open_mainfile=lambda filepath: None),
                                                                     preferences=Of(addon_enable=lambda module: None), render=Of(render=render)))
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
    handlers.render_init.clear()
    bpy.ops.render.render = lambda: None
    with pytest.raises(RuntimeError, match="a.blend: rendered without our engine"):
        script["take"](order)

    def fails():
        raise RuntimeError("no camera")
    bpy.ops.render.render = fails
    with pytest.raises(RuntimeError, match="no camera"):
        script["take"](order)
