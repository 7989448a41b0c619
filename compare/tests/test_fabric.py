# SPDX-License-Identifier: Apache-2.0
"""Cloth from afar: the module agrees with the tool, and the script's verdict."""
import csv
import json
import subprocess

import numpy as np
import pytest

import cloth_cycles
import fabric
import programs
import report

COST = 1.8


def test_module_and_tool_agree():
    cloth = fabric.Cloth("denim")
    uv = fabric.spread(40, 50)
    wi, wo = fabric.direction(30, 40), fabric.direction(20, 200)
    ours = cloth.shade(uv, 0.3, wi, wo, fabric.AUTO)
    lines = "".join(" ".join(repr(float(x)) for x in (u, v, 0.3, *wi, *wo)) + "\n" for u, v in uv)
    tool = subprocess.run([programs.SHADE, "fabric", "denim"], input=lines, text=True, check=True,
                          capture_output=True).stdout
    assert np.array(tool.split(), float).reshape(ours.shape) == pytest.approx(ours, rel=1e-12)


def test_points_fill_a_square_evenly():
    """Its 64 parts alike, within what a lattice's points do."""
    for count, span in ((4096, 50), (1000, 0.5)):
        points = fabric.spread(count, span)
        held = np.histogram2d(*points.T, bins=8, range=[[0, span]] * 2)[0]
        assert held.sum() == count and np.abs(held - count / 64).max() < 4, held


def test_moments_and_turns():
    """Of a half sphere that shines as the cosine, a quarter along either axis; the largest way back, whichever way a curve goes."""
    h = np.random.default_rng(3).normal(size=(200000, 3))
    h /= np.linalg.norm(h, axis=1)[:, None] * np.where(h[:, 2:] < 0, -1, 1)
    found = fabric.moments(h, h[:, 2:] ** 2 * (1, 2, 3))
    assert found.shape == (2, 3) and np.allclose(found, 0.25, atol=5 * 0.17 / 200000**0.5)
    for means, back in (([1, 2, 1.5, 3], 0.5), ([3, 1, 2, 0], 1), ([1, 2, 3], 0), ([0, 5, 2, 4], 3)):
        assert fabric.turned_back(np.array(means, float)) == back, means


def test_verdict(tmp_path, capsys):
    assert fabric.main(["wool_flannel", "--points", "8192", "--output", str(tmp_path)]) == 0
    assert "Within the limits" in capsys.readouterr().out
    with open(tmp_path / "fabric.csv", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert row["cloth"] == "wool_flannel"
    # the cheaper tier is worse, so the figures are of two different things
    assert 0 < float(row["colour_far"]) < 0.02 < float(row["colour_single"])
    assert all((tmp_path / name).stat().st_size for name in ("chart.png", "strip.png", "zoom.csv"))


@pytest.mark.parametrize("name", ["cheesecloth", "brushed_steel"])
def test_no_such_cloth(name):
    with pytest.raises(report.StepFailed, match=name):
        fabric.Cloth(name)


def test_cloth_beside_that_of_cycles(tmp_path, monkeypatch, capsys):
    """Of pictures whose figures are known: ours has a chequer of which means of 4 x 4 pixels show nothing."""
    light = {("plane", "LIBSHADE"): (1.0, 2.0, 3.0), ("plane", "CYCLES"): (1.1, 2.0, 3.3), ("ball", "LIBSHADE"): (0.5, 0.5, 0.5), ("ball", "CYCLES"): (0.4, 0.5, 0.6)}
    orders = []

    def picture(path):
        scene, *_preset, engine = path.stem.split("_")
        made = np.ones((10, 10, 4), np.float32) * (*light[scene, engine], 1)
        made[::2] *= 1.25 if (scene, engine) == ("ball", "LIBSHADE") else 1
        made[1::2] *= 0.75 if (scene, engine) == ("ball", "LIBSHADE") else 1
        return made

    class Started:
        _command = ["true"]

        def __init__(self, version, _home):
            orders.append(version)

        def environment(self):
            return {}

    def run(_words, input, **_options):
        orders.append([json.loads(line) for line in input.splitlines()])
        return subprocess.CompletedProcess([], 0, "DONE\n" * len(orders[-1]))
    monkeypatch.setattr(cloth_cycles, "rgba", picture)
    monkeypatch.setattr(cloth_cycles, "Blender", Started)
    monkeypatch.setattr(cloth_cycles.subprocess, "run", run)
    cloth_cycles.main(["5.0", "--presets", "denim,wool_flannel", "--keep", str(tmp_path)])
    rows = capsys.readouterr().out.splitlines()
    assert rows[1] == "Blender 5.0" and rows[5:] == [
        f"| {name} | 0.067 | 1.07 | 1.10, 1.00, 1.10 | 0.133 | 1.00 | 0.80, 1.00, 1.20 |" for name in ("Denim", "Wool flannel")], rows
    assert orders[0] == "5.0" and len(orders[1]) == 8 and {one["engine"] for one in orders[1]} == {"LIBSHADE", "CYCLES"}
    assert {(one["scene"], one["side"], one["samples"], one["even"]) for one in orders[1]} == {("plane", 160, 32, True), ("ball", 192, 48, False)}
    assert (tmp_path / "5.0/sheet.png").stat().st_size
    cloth_cycles.main(["--presets", "linen"])
    assert [order for order in orders[2:] if isinstance(order, str)] == ["3.4", "5.0"]
    for words in (["2.8"], ["--presets", "velvet"]):
        with pytest.raises(SystemExit):
            cloth_cycles.main(words)
    monkeypatch.setattr(cloth_cycles.subprocess, "run", lambda *_words, **_options: subprocess.CompletedProcess([], 0, "DONE\n"))
    with pytest.raises(SystemExit, match="Blender 3.4: 4 pictures expected"):
        cloth_cycles.main(["3.4", "--presets", "linen"])
