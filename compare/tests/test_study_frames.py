# SPDX-License-Identifier: Apache-2.0
"""study_frames.py without a renderer: the sphere's numbers, what is compared of a picture, findings on altered rows."""
import numpy as np
import pytest

import sphere
import study_frames as study

COST = 0.95


def test_normals_are_those_of_the_displaced_points():
    u, v = np.random.default_rng(1).uniform(0.3, 0.7, (2, 400))
    step = 1e-6
    du, dv = (sphere.surface(u + a, v + b)[0] - sphere.surface(u - a, v - b)[0] for a, b in ((step, 0), (0, step)))
    crossed = np.cross(du, dv)
    crossed /= np.linalg.norm(crossed, axis=-1, keepdims=True)
    assert np.abs(crossed - sphere.surface(u, v)[1]).max() < 1e-6


def test_the_map_and_the_mesh_are_one_surface():
    rows = 64
    texels = 2.0 * sphere.normal_map(rows)[::-1] - 1  # rows from the bottom
    v, u = (20 + 0.5) / rows, (70 + 0.5) / (2 * rows)
    world = sum(texels[20, 70, k] * axis for k, axis in enumerate(sphere.frame(u, v)))
    assert world == pytest.approx(sphere.surface(u, v)[1], abs=1e-6)
    positions, normals, faces, uv = sphere.mesh(10)
    assert positions == pytest.approx(sphere.surface(*uv.T)[0]) and normals == pytest.approx(sphere.surface(*uv.T)[1])
    a, b, c, _d = (positions[faces[45, k]] for k in range(4))
    assert np.cross(b - a, c - a) @ a > 0 and len(faces) == 100


def test_what_is_compared():
    """A checkerboard of noise is no error of means; what lies beyond the sphere's rim is not seen."""
    truth = np.ones((64, 64, 3))
    noisy = truth + 0.5 * np.where(np.indices((64, 64)).sum(0) % 2, 1, -1)[..., None]
    assert study.error(noisy, truth, "plate", "sun") == pytest.approx(0.5)
    assert study.error(noisy, truth, "plate", "sky") == pytest.approx(0)
    outside = truth.copy()
    outside[~sphere.judged(64)] = 9
    assert study.error(outside, truth, "sphere", "sky") == 0 < study.error(outside, truth, "plate", "sky")


@pytest.fixture
def rows():
    made = []
    for shape, light in study.SCENES:
        for engine, error, seconds in (("libshade", 0.01, 1.0), ("cycles", 0.1, 5.0), ("cycles_5", 0.1, 6.0),
                                       ("mitsuba", 0.1, 0.9), *([("povray", 0.01, 4.0)] if light == "sun" else [])):
            for samples in study.SAMPLES[light]:
                made += [{"kind": "frame", "shape": shape, "light": light, "engine": engine, "samples": samples, "run": k,
                          "seconds": seconds * samples, "error": error, "noise": 0.001, "version": "1"} for k in range(3)]
    return made


def test_findings_hold(rows):
    assert all(finding.holds for finding in study.findings(rows)) and len(study.findings(rows)) == 6
    assert study.findings([]) == [] and study.figures([]) == [] and study.tables([]) == [] and study.tasks(True) == []
    assert len(study.tasks(False)) == 4 and len(study.tables(rows)[0].rows) == 4 * 4 * 3 + 2 * 3
    without = [row for row in rows if row["engine"] != "mitsuba"] + [
        {"kind": "missing", "shape": "plate", "light": "sun", "engine": "mitsuba"}]
    assert all(finding.holds for finding in study.findings(without))
    assert "Mitsuba 3. `make compare-peers`" in study.tables(without)[0].caption


@pytest.mark.parametrize("wrong, same, change", [
    (0, {"engine": "libshade", "shape": "plate", "light": "sun"}, {"error": 0.2}),
    (0, {"engine": "povray", "shape": "plate"}, {"error": 0.2}), (1, {"engine": "mitsuba", "light": "sky"}, {"error": 1e-3}),
    (4, {"engine": "cycles_5", "shape": "sphere", "light": "sky"}, {"seconds": 0.1}), (5, {"shape": "sphere"}, {"noise": 0.009}),
])
def test_altered_rows_falsify(rows, wrong, same, change):
    altered = [{**row, **change} if all(row[k] == v for k, v in same.items()) else row for row in rows]
    held = [finding.holds for finding in study.findings(altered)]
    assert not held[wrong]


def test_noise_counts_beside_the_error_that_it_hides(rows):
    """Where that is largest, not where there is most noise."""
    noise = {("plate", "sun"): (0.009, 0.03), ("sphere", "sun"): (0.006, 0.01)}

    def changed(row):
        most, error = noise.get((row["shape"], row["light"]), (row["noise"], row["error"]))
        return {**row, "noise": most, **({"error": error} if row["engine"] == "libshade" else {})}

    held = [finding.holds for finding in study.findings([changed(row) for row in rows])]
    assert held == [True] * 5 + [False]


def test_what_made_the_tiles_is_removed_but_for_the_truth(tmp_path):
    """The truth takes minutes, and the next run needs it."""
    for name in ("truth-plate.npy", "truth-plate.exr", "libshade-8.exr", "normals.npy", "plate.inc", "ball.ply", "log.txt"):
        (tmp_path / name).write_text("")
    side = study.SIZE["sun"]
    true = np.linspace(0, 1, side * side * 3).reshape(side, side, 3)
    rows = study.tiles(tmp_path, "plate", "sun", true, {("libshade", 8): (true, [1.0], "0")})
    left = {path.name for path in tmp_path.iterdir() if path.suffix != ".jpg"}
    assert rows and left == {"truth-plate.npy", "truth-plate.exr", "log.txt"}
