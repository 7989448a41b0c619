# SPDX-License-Identifier: Apache-2.0
"""study_consistency.py's rows of made-up dumps and pictures, and its findings on altered rows."""
import re
import xml.etree.ElementTree as ET
from types import SimpleNamespace

import numpy as np
import pytest
import synthetic
import test_judges as parts

import dumps
import programs
import study_consistency as study

COST = 1


def dump(folder, name, change=None, after=None):
    made = parts.Dump()
    if change:
        change(made)
    made.shade()
    if after:
        after(made)
    return synthetic.write(folder / f"{name}.exr", made.planes, {"version": "0", "materials": made.materials})


def one(folder, change=None, after=None, tint=1.0):
    """Rows of one scene in both renderers; `change` and `after` are POV-Ray's."""
    folder.mkdir(exist_ok=True)
    files = {"Blender": dump(folder, "a"), "POV-Ray": dump(folder, "b", change, after)}
    rows = [study.checked_row("ball", "as it is", name, file, folder) for name, file in files.items()]
    rows.append(study.pair_row("ball", "as it is", [dumps.read(file) for file in files.values()]))
    image = np.random.default_rng(5).random((60, 72, 3))
    shown = [image, np.clip(image * tint, 0, None)]
    rows.append(study.picture_row("ball", "as it is", shown))
    return rows + study.worst_tiles(folder, "ball", "as it is", shown)


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    return one(tmp_path_factory.mktemp("good"))


def holds(rows):
    return [finding.holds for finding in study.findings(rows)]


def test_good_parts_hold(rows):
    assert holds(rows) == [True, True, True]
    table, = study.tables(rows)
    assert table.rows == [["ball", "as it is", *table.rows[0][2:]]]
    assert all(text.startswith("ok, ") for text in table.rows[0][2:-2])


@pytest.mark.parametrize("broken, wrong", [
    ({"after": parts.scale("light0.S.R", 1.001)}, [0]),
    ({"after": parts.nan}, [0, 1]),
    ({"change": parts.turn("Ns", 0.4)}, [1]),
    ({"change": parts.cut}, [1]),
    ({"tint": 1.03}, [2]),
])
def test_one_bad_part(tmp_path, broken, wrong):
    found = one(tmp_path / "bad", **broken)
    assert [k for k, good in enumerate(holds(found)) if not good] == wrong
    line = study.tables(found)[0].rows[0]
    assert any(str(text).startswith("MISSED, ") for text in line)


@pytest.mark.parametrize("kind, column, value, wrong", [
    ("check", "ok", 0, 0), ("check", "error", 2e-4, 0), ("check", "beyond", 1.1e-5, 0), ("check", "values", 0, 0),
    ("pair", "ok", 0, 1), ("pair", "share", 0.99, 1),
    ("picture", "ok", 0, 2), ("picture", "difference", 0.03, 2), ("picture", "flip", 0.06, 2),
])
def test_altered_rows_are_noticed(rows, kind, column, value, wrong):
    changed = [{**row, column: value} if row["kind"] == kind else row for row in rows]
    assert [k for k, good in enumerate(holds(changed)) if not good] == [wrong]


def test_far_cloth_of_all_materials_and_lights_counts(monkeypatch):
    """Values of each cell, and the worst of their sums; cells of what is near have none."""
    cells = [{"far": {"values": 300, "over": 2, "sum": 0.01}}, {}, {"far": {"values": 500, "over": 3, "sum": 0.015}}]
    found = {"pass": False, "faults": [], "materials": [], "lights": [], "values": 800, "largest": 1e-6, "mean": 1e-7, "cells": cells}
    monkeypatch.setattr(study.consistency, "check", lambda *_: found)
    monkeypatch.setattr(study.consistency, "check_rows", lambda *_: ([], False))
    monkeypatch.setattr(study.consistency, "beyond", lambda checked, what: checked[what])
    row = study.checked_row("drape", "as it is", "Blender", None, None)
    assert (row["far_values"], row["far_over"], row["far_sum"], row["ok"]) == (800, 5, 0.015, 0)


def test_a_picture_is_to_be_right_in_the_mean_and_to_the_eye():
    image = np.full((60, 72, 3), 0.3)
    brighter = study.picture_row("ball", "as it is", [image, 1.025 * image])
    assert brighter["difference"] > brighter["limit"] and brighter["flip"] <= brighter["flip_limit"] and not brighter["ok"]
    lamp = np.zeros((60, 72, 3))
    lamp[:, :36] = 50.0  # beside which .2 in the dark is nothing in the mean
    glow = np.where(lamp > 0, lamp, 0.2)
    seen = study.picture_row("ball", "as it is", [lamp, glow])
    assert seen["difference"] <= seen["limit"] and seen["flip"] > seen["flip_limit"] and not seen["ok"]
    assert study.picture_row("ball", "as it is", [image, image])["ok"]


def test_a_mean_that_rounding_takes_over_its_limit_is_said(rows):
    """How many, the largest, and what is left of it beyond rounding."""
    good = [row for row in rows if row["kind"] == "check"] * 5
    assert "takes a material's mean" not in study.finding_reference(good).text
    sharp = {**good[0], "mean": 2e-5, "beyond": 4e-7}
    finding = study.finding_reference([*good, sharp])
    assert finding.holds and "11 of 11 dumps" in finding.text
    assert "over its limit in 1, whose lobes are narrow: the largest is 2.0e-05; beyond that rounding no mean of them is above 4.0e-07." in finding.text
    missed = {**sharp, "beyond": 1.1e-5, "ok": 0, "missed": "Blender against reference, mean error of S"}
    assert not study.finding_reference([*good, missed]).holds


def test_far_cloth_over_its_limit_is_said_by_name(rows):
    """Few values of one in many dumps, for nothing else: no other scene is to be hidden by it."""
    good = [row for row in rows if row["kind"] == "check"] * 5
    good += [{**row, "variant": "in both"} for row in good]
    cloth = {**good[0], "scene": "cloth", "ok": 0, "missed": "", "far_values": 1000, "far_over": 3, "far_sum": 0.01}
    finding = study.finding_reference([*good, cloth])
    assert finding.holds and "20 of 21 dumps" in finding.text and "cloth (3 of 1000 values of cloth from afar)" in finding.text
    assert study.cell([cloth], "error", "{:.0e}".format).startswith("MISSED, ")
    assert study.cell([cloth], "error", "{:.0e}".format).endswith(" (3 of 1000 values of cloth from afar)")
    assert study.finding_reference([*good, cloth, cloth]).holds and not study.finding_reference([*good, *[cloth] * 3]).holds
    in_both = {**cloth, "variant": "in both"}  # of those more may be so named
    assert study.finding_reference([*good, *[in_both] * 3]).holds and not study.finding_reference([*good, *[in_both] * 4]).holds
    read = {key: value for key, value in cloth.items() if value != ""}  # as a CSV gives it back
    assert study.finding_reference([*good, read]) == study.finding_reference([*good, cloth])
    assert not study.finding_reference([*good, {**cloth, "far_over": 6}]).holds
    assert not study.finding_reference([*good, {**cloth, "far_sum": 0.021}]).holds
    assert not study.finding_reference([*good, {**cloth, "far_over": 0}]).holds
    assert not study.finding_reference([*good, {**cloth, "missed": "mean error of S"}]).holds


def test_a_pair_that_misses_is_said(rows):
    pair = next(row for row in rows if row["kind"] == "pair")
    finding = study.finding_pair([*rows, {**pair, "scene": "povray/embossed", "ok": 0, "least": "Ns", "share": 0.99}])
    assert not finding.holds and "1 times of 2" in finding.text and "MISSED: povray/embossed (Ns in 99.00% of its pixels" in finding.text


def test_uv_coordinates_of_examples():
    """Parts of the map that is seen where that is more than a unit; none where a shape has none."""
    for shapes, last in ((True, 0.0), (False, 0.7)):  # meshes have coordinates everywhere
        made = [SimpleNamespace(material=np.array([[0, 0, 1, 1]]), covered=np.ones((1, 4), bool), uv=uv, header={"materials": [
            {"id": 0}, {"id": 1}]}) for uv in (np.array([[[3.0, 1], [43, 2], [0.2, 0.3], [0.7, 0.1]]]),
                                               np.array([[[3.0, 1], [43, 2.004], [0.2, 0.3], [0, 0]]]))]
        study.own_uv(*made, shapes)
        off = np.abs(made[0].uv - made[1].uv).max(-1)[0]
        assert off == pytest.approx([0, 1e-4, 0, last], abs=1e-12) and made[0].uv[0, 2] == pytest.approx([0.2, 0.3])


def test_what_was_left_out_is_a_table(rows):
    left = study.left_rows("ball", ["soft lamps", "bumps"])
    table = study.tables([*rows, *left])[1]
    assert table.rows == [["ball", "soft lamps; bumps"]]


def test_a_renderer_that_is_missing_is_noticed(rows):
    assert not holds([row for row in rows if row.get("renderer") != "POV-Ray"])[0]


def test_thumbnails(tmp_path):
    """The crop is round the pixel that differs, and says where it is."""
    image = np.full((50, 90, 3), 0.3)
    spot = image.copy()
    spot[31:34, 77:80] = (0.9, 0.1, 0.1)
    rows = study.worst_tiles(tmp_path, "white_spot", "in both", [image, spot])
    assert rows[0]["label"] == "white spot|in both|Blender"
    column, row = map(int, re.search(r"at \((\d+), (\d+)\)", rows[1]["label"]).groups())
    assert abs(column - 78) <= 2 and abs(row - 32) <= 2
    assert rows[2]["value"] > 0.3
    figure, = study.figures(rows)
    ET.fromstring(f"<svg>{figure.svg}</svg>")
    assert figure.svg.count("data:image/jpeg;base64,") == 3


def test_every_example_is_there():
    """What is added to examples/ is rendered, too; `nodes` are pictures of the editor, the cookbook parts of the others."""
    keys = {task.key for task in study.tasks(False)}
    for name in ("table", "cloth", "groove"):
        assert f"blender-{name}" in keys
    for path in (programs.ROOT / "examples" / "povray").glob("*/*.pov"):
        assert path.stem == "suzanne" or path.parent.name == "cookbook" or f"povray-{path.stem}" in keys
    for path in (programs.ROOT / "examples" / "blender").iterdir():
        assert not path.is_dir() or path.name in ("suzanne", "nodes", "__pycache__") or f"blender-{path.name}" in keys
    assert [task.key for task in study.tasks(True)] == ["suzanne-quick"]


def test_cloths_of_twins_are_as_fine_as_the_examples():
    """Millimetres to a unit, in the scene's text and in its twin; 200 where neither says."""
    twins = (programs.HERE / "povray_twins.py").read_text()
    for name, function in (("cloth", "cloth_table"), ("lampshade", "lampshade")):
        scene = (programs.ROOT / f"examples/povray/{name}/{name}.pov").read_text()
        said = set(re.findall(r"mm_per_unit (\d+)", scene))
        body = re.search(rf"^def {function}\(.*?(?=^def )", twins, re.M | re.S)[0]
        assert said and said <= set(re.findall(r'cloth\("\w+", (\d+)\)', body)), name


def test_the_reduced_set_has_every_word():
    """Each distribution, BRDF, detail, horizon and diffuse model but the demo's own and auto's twins."""
    import shade

    used = {key: {str(values[key]).lower() for values in study.VARIANTS.values() if key in values}
            for key in ("distribution", "brdf", "detail", "horizon", "diffuse")}
    assert {"ward", "ward_half", "beckmann", "ggx"} <= used["distribution"]
    assert set(shade.choices("detail")) - used["detail"] <= {"none", "deform_linear", "deform_smooth_conserving"}
    assert set(shade.choices("horizon")) - used["horizon"] <= {"valid_estevez", "mutual"}  # which POV-Ray does not have
    assert {"fibre", "fibre_view", "max_normal", "lambert"} <= used["diffuse"]


# ---- how a scene goes through both renderers


@pytest.fixture
def rendered(monkeypatch, tmp_path):
    """Every step that is asked for, in order; pictures are of the renderer's number and the size asked for."""
    asked = []

    def ours(options):
        asked.append(("Blender", options.scene.name, options.percent, options.samples))
        study.pictures.write_float(options.output / "blender.exr", np.full((2, options.percent, 3), options.percent / 100, np.float32))
        return options.percent, 2

    def theirs(options, width, height, over=1):
        asked.append(("POV-Ray", width, height, over))
        study.pictures.write_float(options.output / "povray.exr", np.full((height * over, width * over, 3), 1, np.float32))
    monkeypatch.setattr(study.consistency, "render_blender", ours)
    monkeypatch.setattr(study.consistency, "render_povray", theirs)
    monkeypatch.setattr(study.consistency, "dump_povray", lambda options, width, height: asked.append(("dump", width, height)))
    monkeypatch.setattr(study, "checked_row", lambda scene, variant, name, file, folder: {"kind": "check", "of": (scene, variant, name, file.name)})
    monkeypatch.setattr(study.dumps, "read", lambda file: f"dump {file.name}")
    monkeypatch.setattr(study.dumps, "swap_handedness", lambda dump: f"swapped {dump}")
    monkeypatch.setattr(study, "own_uv", lambda first, second, shapes: asked.append(("uv", first, second, shapes)))
    monkeypatch.setattr(study, "pair_row", lambda scene, variant, pair: {"kind": "pair", "of": pair})
    monkeypatch.setattr(study, "picture_row", lambda scene, variant, shown: {"kind": "picture", "of": [image.shape for image in shown]})
    monkeypatch.setattr(study, "worst_tiles", lambda folder, scene, variant, shown: [{"kind": "tile", "of": (scene, variant)}])
    monkeypatch.setattr(study.report, "step", lambda text, command, log, environment=None, **_more: asked.append((text, [str(word).replace(f"{tmp_path}/", "") for word in command], log.name)))
    return asked


def test_one_scene_in_both(rendered, tmp_path):
    """A dump may be smaller than the picture: it is then rendered last, by one sample; POV-Ray's picture is a larger one's means."""
    write = lambda options: rendered.append(("written", options.scene.name))
    said = []
    rows = study.both("ball", "as it is", tmp_path / "ball.blend", tmp_path / "out", study.Look(40, 64, 2, 4), said.append, write)
    assert rendered == [("Blender", "ball.blend", 40, 64), ("written", "ball.blend"), ("dump", 40, 2), ("POV-Ray", 40, 2, 4)] and said == ["as it is"]
    assert [row["kind"] for row in rows] == ["check", "check", "pair", "picture", "tile"] and [row["of"] for row in rows[:2]] == [
        ("ball", "as it is", "Blender", "blender_dump.exr"), ("ball", "as it is", "POV-Ray", "povray_dump.exr")]
    assert rows[2]["of"] == ["dump blender_dump.exr", "swapped dump povray_dump.exr"] and rows[3]["of"] == [(1, 20, 3)] * 2 and (tmp_path / "out/povray").is_dir()
    rendered.clear()
    rows = study.both("povray/net", study.IN_BOTH, tmp_path / "net.blend", tmp_path / "far", study.Look(40, 64, 1, 1, 10), said.append, write)
    assert rendered == [("Blender", "net.blend", 40, 64), ("Blender", "net.blend", 10, 1), ("written", "net.blend"), ("dump", 10, 2), ("POV-Ray", 40, 2, 1),
                        ("uv", "dump blender_dump.exr", "swapped dump povray_dump.exr", True)]
    assert rows[3]["of"] == [(2, 40, 3)] * 2 and study.pictures.read(tmp_path / "far/blender.exr").mean() == pytest.approx(.4)


def test_examples_go_through_both(rendered, tmp_path, monkeypatch):
    """Each as it is in its own renderer, then what both can show; by its own look, or that of metal or cloth."""
    looks = []
    monkeypatch.setattr(study, "both", lambda scene, variant, path, folder, look, say, write=None: looks.append((scene, variant, path.name, folder.name, look, write)) or [{"kind": "both"}])
    (tmp_path / "left_out.json").write_text('["soft lamps"]')
    script = lambda name: f"{study.programs.HERE}/{name}.py"
    rows = study.blender_example("dial")(tmp_path, lambda _text: None)
    assert [row["kind"] for row in rows] == ["check", "left", "both"] and looks.pop()[:5] == ("dial", "in both", "common.blend", "both", study.Look(25, 64, 1, 4))
    first, picture, common = rendered
    assert first[0] == "Making the scene" and first[1][-4:] == [script("example_scene"), "--", str(study.BLENDER["dial"]), str(tmp_path)]
    assert picture == ("Blender", "scene.blend", 30, 4) and common[0] == "Changing what one renderer cannot show" and common[1][-3:] == [script("example_common"), "--", str(tmp_path)]
    assert "scene.blend" in common[1]
    rendered.clear()
    study.blender_example("drape")(tmp_path, lambda _text: None)
    assert rendered[1] == ("Blender", "scene.blend", 7, 4) and looks.pop()[4] == study.Look(20, 144, 4, 4, 5)
    study.blender_example("table")(tmp_path, lambda _text: None)
    assert looks.pop()[4] == study.Look(15, 64, 1, 4)
    monkeypatch.setattr(study.povray_common, "common", lambda name, text: (f"common {name} {'fabric' * ('fabric' in text)}", ["a sky"]))
    for name, text, look, size, more in (
            ("net", "fabric { } radiosity { a } samples 12\n", study.Look(25, 144, 4, 4, 10), (96, 54), "fabric { }  samples 1\nlight_source { <-5, 8, -6>, rgb 1 }\n"),
            ("embossed", "// build/shade weave --name basket -o build/basket.png\nlight_source { 0 }\n", study.Look(25, 400, 4, 6), (192, 108),
             "// build/shade weave --name basket -o build/basket.png\nlight_source { 0 }\n")):
        rendered.clear()
        path = tmp_path / "example" / f"{name}.pov"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        rows = study.povray_example(path)(tmp_path, lambda _text: None)
        assert [row["kind"] for row in rows] == ["check", "left", "both"] and rows[0]["of"] == (f"povray/{name}", "as it is", "POV-Ray", "povray_dump.exr")
        assert (tmp_path / "scene.pov").read_text() == more
        *woven, dumped, made = rendered
        assert dumped[0] == "Dumping in POV-Ray" and dumped[1][1:] == ["+Iscene.pov", f"+L{tmp_path}", "+Lexample", "+Opicture.png", f"+W{size[0]}", f"+H{size[1]}", "-A", "-D"]
        assert made[1][-4:] == [script("povray_twins"), "--", name, str(tmp_path)] and [step[1][1:] for step in woven] == (
            [["weave", "--name", "basket", "--size", "1024", "-o", "basket.png"]] if name == "embossed" else [])
        scene, variant, blend, folder, found, write = looks.pop()
        assert (scene, variant, blend, folder, found) == (f"povray/{name}", "in both", "scene.blend", "both", look)
        (tmp_path / "w/povray").mkdir(parents=True, exist_ok=True)
        write(SimpleNamespace(output=tmp_path / "w"))
        assert (tmp_path / "w/povray/scene.pov").read_text().startswith(f"common {name}")
        assert (tmp_path / "w/povray/scene.ini").read_text() == f'Input_File_Name=scene.pov\nLibrary_Path="{tmp_path}"\n'


def test_scenes_said_once_and_variants(rendered, tmp_path, monkeypatch):
    looks, maps = [], []
    monkeypatch.setattr(study, "both", lambda scene, variant, path, folder, look, say: looks.append((scene, variant, path.name, folder.name, look)) or [])
    monkeypatch.setattr(study.plate, "normal_map", lambda size: maps.append(("plate", size)) or np.zeros((2, 2, 3), np.float32))
    monkeypatch.setattr(study.sphere, "normal_map", lambda rows: maps.append(("sphere", rows)) or np.zeros((2, 2, 3), np.float32))
    study.twin("swatches")(tmp_path, lambda _text: None)
    assert looks.pop() == ("swatches", "as it is", "scene.blend", "out", study.Look(24, 256, 4, 4)) and maps == [("plate", 512), ("sphere", 2048)]
    assert rendered.pop()[1][-3:] == ["--", "swatches", str(tmp_path)] and (tmp_path / "bumps.exr").exists() and (tmp_path / "scratches.exr").exists()
    study.demo({"ggx": {"distribution": "GGX"}}, 20)(tmp_path, lambda _text: None)
    assert looks == [("suzanne", "as it is", "scene.blend", "scene", study.Look(20)), ("suzanne", "ggx", "ggx.blend", "ggx", study.Look(20))]
    assert rendered[0][1][-1] == "variants.json" and (tmp_path / "variants.json").read_text() == '{"ggx": {"distribution": "GGX"}}'
    tasks = {task.key: task for task in study.tasks(False)}
    assert tasks["suzanne"].seconds == 150 and tasks["suzanne"].command == "compare/consistency.py build/demo/suzanne.blend --percent 30"
    assert tasks["twin-swatches"].seconds == 30 and tasks["blender-table"].command == "examples/blender/table/make_scene.py"
    assert tasks["povray-metals"].command == "the command at the top of metals.pov" and study.tasks(True)[0].command.endswith("--percent 20")
    inside = {path.name for path in map(type(tmp_path), tasks["suzanne"].needs)}
    assert {"export_povray.py", "povray_twins.py", "twin_scenes.py", "example_common.py", "_native.abi3.so"} <= inside


def test_what_the_sentences_say():
    check = {"kind": "check", "scene": "dial", "variant": "as it is", "mean": 1e-6, "beyond": 1e-7, "values": 500, "far_values": 0, "far_over": 0, "far_sum": 0.0, "mean_limit": 1e-5,
             "ok": 1, "missed": ""}
    pair = {"kind": "pair", "scene": "dial", "variant": "in both", "apart": .001, "least": "Ns", "share": .99876, "limit": .995, "ok": 1, "missed": ""}
    picture = {"kind": "picture", "scene": "dial", "variant": "in both", "difference": .0123, "limit": .02, "flip": .0314, "flip_limit": .05, "ok": 1}
    rows = [{**check, "renderer": "Blender", "error": 3e-5, "limit": 1e-4}, {**check, "renderer": "POV-Ray", "error": 2e-7, "limit": 1e-5, "scene": "povray/net"},
            pair, {**pair, "scene": "cloth_ball", "share": .9971, "least": "light0.L", "variant": "as it_is"}, picture, {**picture, "difference": .004, "flip": .04}]
    reference, same, shown = study.findings(rows)
    assert reference.text == ("2 of 2 dumps are shaded as the reference says, 1000 values in all: Blender within 3e-05 of each value and POV-Ray within 2e-07 of each value, "
                              "but for what the rounding of a dump's directions explains.")
    assert same.text == ("Both renderers see the same in 2 scenes, 2 times of 2: point, normals, tangent, light and material of a pixel agree in 99.71% of all pixels or more "
                         "(the least is light0.L of cloth ball, as it is).")
    assert shown.text == "Their pictures differ by 1.2 % of the mean at most, channel by channel, and look the same: FLIP 0.040 at most in the mean."
    assert all(finding.holds and finding.figure == "matrix" for finding in (reference, same, shown))
    assert study.tables(rows)[0].rows == [["dial", "as it is", "ok, 3.0e-05", None, None, None, None], ["povray/net", "as it is", None, "ok, 2.0e-07", None, None, None],
                                          ["dial", "in both", None, None, "ok, 99.876%", "ok, 1.2 %", "ok, 0.031"], ["cloth_ball", "as it is", None, None, "ok, 99.710%", None, None]]
    table, = study.tables(rows)
    assert list(table.columns) == ["scene", "variant", "Blender, reference", "POV-Ray, reference", "dump, dump", "picture, picture", "FLIP"]
