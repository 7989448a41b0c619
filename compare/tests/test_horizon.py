# SPDX-License-Identifier: Apache-2.0
"""The truth about horizons is one: checked by reciprocity and by another way to compute it."""
import subprocess

import numpy as np
import pytest

import horizon
import plate
import programs

COST = 5.9

PROGRAM = programs.BUILD / "horizon"


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    folder = tmp_path_factory.mktemp("horizon")
    return horizon.measure(horizon.arguments(
        ["--points", "48", "--azimuths", "2", "--output", str(folder)]))


def direction(elevation, azimuth):
    e, a = np.radians([elevation, azimuth])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def test_every_choice_and_pair_is_there(rows):
    assert list(horizon.LOOKS) == horizon.choices(rows)
    assert len(rows) == 2 * 3 * len(horizon.LOOKS) * 12 * 12
    for row in rows:
        values = [value for value in row.values() if isinstance(value, float)]
        assert np.isfinite(values).all() and min(values) >= 0
        assert row["truth_twice"] >= row["truth"]


def test_truth_is_reciprocal(rows):
    """Light and eye trade places: shadows become hidden parts, and hidden parts shadows."""
    for material, limit in (("lambert", 0.03), ("ggx", 0.1)):
        found = {(r["field"], r["light"], r["light_azimuth"], r["view"], r["view_azimuth"]):
                 r["truth"] / np.sin(np.radians(r["light"]))
                 for r in horizon.pick(rows, material=material, horizon="hard")}
        there = np.array(list(found.values()))
        back = np.array([found[f, v, va, li, la] for f, li, la, v, va in found])
        assert np.abs(there - back).sum() < limit * there.sum()
        # so does light that is reflected twice
        more = {key: (row["truth_twice"] - row["truth"]) / np.sin(np.radians(row["light"]))
                for key, row in zip(found, horizon.pick(rows, material=material, horizon="hard"))}
        there = np.array(list(more.values()))
        back = np.array([more[f, v, va, li, la] for f, li, la, v, va in more])
        assert np.abs(there - back).sum() < 4.5 * limit * there.sum() and 0.01 * sum(found.values()) < there.sum() < 0.2 * sum(found.values())


def test_nothing_differs_where_all_is_lit_and_seen(rows):
    """Steeper than any bump: each visible point is shaded alike, flat or displaced."""
    high = [r for r in horizon.pick(rows, horizon="hard") if min(r["light"], r["view"]) > 30
            and r["field"] == "sinusoid"]
    assert sum(r["shading"] for r in high) < 1e-5 * sum(r["truth"] for r in high)
    low = [r for r in horizon.pick(rows, horizon="hard") if r["light"] < 15]
    assert sum(r["shading"] for r in low) > 0.1 * sum(r["truth"] for r in low)


@pytest.mark.parametrize("light, view", [(20, 40), (10, 20), (20, 10)])
def test_sinusoid_by_marching(rows, light, view):
    """Lambert's truth again: plate.py's heights, walked along in small even steps."""
    size, steps = 64, 1500
    row, = [r for r in horizon.pick(rows, field="sinusoid", material="lambert", horizon="hard",
                                    light=float(light), view=float(view))
            if r["light_azimuth"] < 180 < r["view_azimuth"]]
    wi = direction(light, row["light_azimuth"])
    wo = direction(view, row["view_azimuth"])
    top = plate.SLOPE / (2 * np.pi * plate.PERIODS)
    u, v = (a.ravel() for a in plate.grid(size))
    point = np.stack([u, v, np.zeros_like(u)], 1) + 1.001 * top / wo[2] * wo
    step = 2.002 * top / wo[2] / steps
    falling = np.ones(len(u), bool)
    for _ in range(steps):
        falling &= point[:, 2] > plate.height(point[:, 0], point[:, 1])
        point[falling] -= step * wo
    n = plate.normals(point[:, 0], point[:, 1])
    cosine = n @ wi
    lit = cosine > 0
    ray = point + 2 * step * n
    for _ in range(steps):
        ray += 2 * top / wi[2] / steps * wi
        lit &= ray[:, 2] > plate.height(ray[:, 0], ray[:, 1])
    truth = np.where(lit, cosine, 0).mean() / np.pi
    assert row["truth"] == pytest.approx(truth, rel=0.03)
    flat = plate.normals(*plate.grid(1000))
    seen = (flat @ wi > 0) & (flat @ wo > 0)
    assert row["mean"] == pytest.approx(np.where(seen, flat @ wi, 0).mean() / np.pi, rel=0.02)


def test_errors_of_either_sign_add_up():
    """Brightness is off by as much above the truth as below it: that is no agreement."""
    row = {"horizon": "hard", "material": "ggx", "light": 40.0, "view": 40.0, "truth": 2.0}
    rows = [{**row, "image": 0.3, "mean": 2.5}, {**row, "image": 0.1, "mean": 1.5}]
    assert horizon.errors(rows) == {"picture": pytest.approx(0.1), "brightness": pytest.approx(0.25)}


def test_whole_script(tmp_path, capsys):
    assert horizon.main(["--points", "4", "--azimuths", "1", "--output", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "brightness: GGX" in out and "valid_estevez" in out
    assert (tmp_path / "chart.png").stat().st_size > 10_000
    lines = (tmp_path / "errors.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + 2 * 3 * len(horizon.REGIONS)


@pytest.mark.parametrize("arguments, status", [
    ((), 2), (("x.csv", "0"), 2), (("x.csv", "12x"), 2), (("x.csv", "4", "2", "1"), 2),
    (("x.csv", "513"), 2), (("x.csv", "4", "0"), 2), (("x.csv", "4", "361"), 2), (("x.csv", ""), 2), (("--points",), 2),
    (("missing/x.csv",), 1)])
def test_bad_arguments(tmp_path, arguments, status):
    done = subprocess.run([PROGRAM, *arguments], cwd=tmp_path, capture_output=True, text=True,
                          check=False)
    assert done.returncode == status and "horizon" in done.stderr
    assert not list(tmp_path.iterdir())


def test_the_program_tells_its_usage_and_how_far_it_is(tmp_path):
    done = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stdout.startswith("usage: horizon OUTPUT.csv [POINTS [AZIMUTHS]]")
    assert "(default 64)" in done.stdout and not done.stderr
    done = subprocess.run([PROGRAM, "x.csv", "1", "1"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.split(" %\n") == [*(str(100 * k // 12) for k in range(12)), ""]
