# SPDX-License-Identifier: Apache-2.0
"""Cloth from afar: the module agrees with the tool, and the script's verdict."""
import csv
import subprocess

import numpy as np
import pytest

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
