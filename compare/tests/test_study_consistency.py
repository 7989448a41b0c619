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

COST = 0.82


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


def test_the_reduced_set_has_every_word():
    """Each distribution, BRDF, detail, horizon and diffuse model but the demo's own and auto's twins."""
    import shade

    used = {key: {str(values[key]).lower() for values in study.VARIANTS.values() if key in values}
            for key in ("distribution", "brdf", "detail", "horizon", "diffuse")}
    assert {"ward", "ward_half", "beckmann", "ggx"} <= used["distribution"]
    assert set(shade.choices("detail")) - used["detail"] <= {"none", "deform_linear", "deform_smooth_conserving"}
    assert set(shade.choices("horizon")) - used["horizon"] <= {"valid_estevez", "mutual"}  # which POV-Ray does not have
    assert {"fibre", "fibre_view", "max_normal", "lambert"} <= used["diffuse"]
