# SPDX-License-Identifier: Apache-2.0
"""study_peers.py without the other renderers: its measures of made-up pictures, its findings on altered rows."""
import json

import numpy as np
import pytest

import plate
import study_peers as study

COST = 0.3


def made(error, noise, seed=1):
    """Pictures of a renderer whose normal map is off by `error` and whose noise has this relative size."""
    random = np.random.default_rng(seed)
    truth = random.random((64, 64, 3)) + 0.5
    sign = np.where(np.indices((64, 64)).sum(0) % 2, 1, -1)[..., None]
    many = truth + error * truth.mean() * sign
    return {"truth": truth, "many": many, "timed": many * (1 + noise * random.standard_normal(truth.shape))}


@pytest.fixture
def rows():
    sizes, found = {**study.SIZES, "size": 64}, []
    for light in ("sun", "sky"):
        for engine, error, seconds in (("libshade", 0.004, 0.5), ("cycles", 0.08, 5.0), ("cycles_5", 0.079, 6.0),
                                       ("mitsuba", 0.1, 0.4)):
            found.append(study.measured(engine, light, made(error, 0.05), {"timed": [2 * seconds, seconds, seconds]}, "1",
                                        sizes))
    return found


def test_what_is_measured(rows):
    sun = study.of(rows, "sun")
    assert sun["cycles"]["error"] == pytest.approx(0.08, rel=1e-6)
    assert sun["cycles"]["seconds"] == 5.0 and sun["cycles"]["seconds_high"] == 10.0
    assert sun["cycles"]["samples_per_second"] == pytest.approx(64 * 64 * 64 / 5.0)
    assert sun["cycles"]["relmse"] == pytest.approx(0.05**2 / (1 + 64 / 1024), rel=0.05)
    assert sun["mitsuba"]["seconds_to_error"] == pytest.approx(0.4 * sun["mitsuba"]["relmse"] / 1e-3)


def test_under_a_sky_single_pixels_are_no_error(rows):
    """The sign of the made error turns from pixel to pixel: means of blocks do not see it."""
    assert study.of(rows, "sky")["cycles"]["error"] < 1e-9


def test_findings_hold(rows):
    assert all(finding.holds for finding in study.findings(rows))
    assert study.findings([]) == [] and study.tables([]) == [] and study.figures([]) == []
    assert len(study.tables(rows)[0].rows) == 8


@pytest.mark.parametrize("number, engine, column, value", [
    (0, "libshade", "error", 0.05), (0, "mitsuba", "error", 0.001), (1, "cycles_5", "mean", 1.3),
    (2, "libshade", "samples_per_second", 1.0), (2, "cycles_5", "samples_per_second", 1e9),
])
def test_altered_rows_are_noticed(rows, number, engine, column, value):
    changed = [{**row, column: value} if row["engine"] == engine else row for row in rows]
    assert [k for k, finding in enumerate(study.findings(changed)) if not finding.holds] == [number]


def test_a_renderer_that_is_missing_is_noticed(rows):
    assert not study.findings([row for row in rows if row["engine"] != "mitsuba"])[0].holds


def test_only_its_own_target_runs_it():
    assert study.tasks(True) == []
    assert len(study.tasks(False)) in (0, 8)


def test_both_conventions_are_the_same_alphas():
    """What Blender's node makes of roughness and anisotropy is what Mitsuba is given."""
    square = study.ROUGHNESS**2
    assert (square * (1 - study.ANISOTROPY), square / (1 - study.ANISOTROPY)) == pytest.approx(study.ALPHAS)
    assert plate.SLOPE == 0.6  # as the study's words have it


# ---- what is asked of the renderers, and what is said


def test_what_is_asked_of_each_renderer(monkeypatch, tmp_path):
    """The normal map timed and with many samples, the displaced plate; each with noise of its own."""
    sizes = {"size": 8, "samples": 4, "many": 16, "repeat": 2, "quads": 10}
    timed, many = {"samples": 4, "repeat": 2, "seed": 1}, {"samples": 16, "repeat": 0}
    for light, more in (("sun", {}), ("sky", {"sky": "s.exr"})):
        common = {"size": 8, "quads": 10, **more}
        assert study.jobs_of(light, "s.exr", sizes) == {"timed": {**common, "surface": "bumped", **timed}, "many": {**common, "surface": "bumped", **many, "seed": 2},
                                                        "truth": {**common, "surface": "displaced", **many, "seed": 3}}
    asked = []
    monkeypatch.setattr(study.plate_jobs, "run", lambda folder, jobs, python=None: asked.append((jobs, python)))
    for engine in ("libshade", "cycles", "cycles_5"):
        study.run_blender(engine, tmp_path, {"timed": {}, "many": {}})
    of = lambda engine, **more: {part: {"engine": engine, "ggx": (study.ROUGHNESS, study.ANISOTROPY), "output": f"{tmp_path}/{part}.exr", **more} for part in ("timed", "many")}
    assert asked == [(of("LIBSHADE", detail="rotate"), None), (of("CYCLES"), None), (of("CYCLES"), study.BPY)]

    def step(text, command, log, environment):
        assert (text, command, log) == ("Rendering the plate in Mitsuba", [str(study.PEERS), f"{study.programs.HERE}/peers_mitsuba.py", f"{tmp_path}/jobs.json"], tmp_path / "mitsuba.log")
        assert set(environment) == {"DRJIT_LIBLLVM_PATH"}
        order = json.loads((tmp_path / "jobs.json").read_text())
        assert (order["normals"], order["folder"], order["result"]) == (f"{tmp_path}/normals.npy", str(tmp_path), f"{tmp_path}/seconds.json")
        assert np.load(tmp_path / "normals.npy").shape == (2, 2, 3) and [job["alphas"] for job in order["jobs"]] == [[.05, .3]] * 2
        for number, job in enumerate(order["jobs"]):
            np.save(job["output"], np.full((2, 2, 3), number, np.float32))
        (tmp_path / "seconds.json").write_text('{"seconds": [[1, 2], [3]], "version": "3.5"}')
    monkeypatch.setattr(study.report, "step", step)
    made, seconds, version = study.run_mitsuba(tmp_path, {"timed": {"surface": "bumped"}, "many": {}}, np.zeros((2, 2, 3)))
    assert {part: (picture.mean(), picture.dtype) for part, picture in made.items()} == {"timed": (0, float), "many": (1, float)}
    assert (seconds, version) == ({"timed": [1, 2], "many": [3]}, "3.5")


def test_a_renderer_leaves_its_row_and_two_tiles(monkeypatch, tmp_path):
    """And no large files."""
    monkeypatch.setattr(study.paths, "studio", lambda: np.zeros((2, 4, 3), np.float32))
    skies, tiled = [], []

    def rendered(*words):
        skies.append(words[-1]["timed"].get("sky"))
        (tmp_path / "mesh.ply").touch()
        return made(.1, .05), {"timed": [2.0]}, "9"
    monkeypatch.setattr(study, "run_mitsuba", rendered)
    monkeypatch.setattr(study, "run_blender", rendered)
    monkeypatch.setattr(study.sheet, "tiles", lambda folder, name, tiles: tiled.append((name, [label for label, _picture in tiles])) or [{"kind": "tile"}] * 2)
    (tmp_path / "log.txt").touch()
    for engine, light in (("mitsuba", "sky"), ("cycles", "sky"), ("libshade", "sun")):
        said = []
        rows = study.peer(engine, light, {**study.SIZES, "size": 64})(tmp_path, said.append)
        assert [row["kind"] for row in rows] == ["peer", "tile", "tile"] and [row["engine"] for row in rows] == [engine] * 3 and said == ["rendering"]
        assert [path.name for path in tmp_path.iterdir()] == ["log.txt"]
    assert skies == [f"{tmp_path}/sky.npy", f"{tmp_path}/sky.exr", None]
    assert tiled == [(light, [f"{label}|normal map", f"{label}|displaced"]) for light, label in (("sky", "Mitsuba 3"), ("sky", "Cycles"), ("sun", "libshade"))]


def test_what_is_said(rows):
    known = [{**row, "samples_per_second": speed, "error": error, "mean": mean, "relmse": .002, "seconds_to_error": 3.0, "version": "v"} for row, speed, error, mean in zip(
        rows, (9e6, 1e6, 2e6, 12e6, 8e6, 1.5e6, 2.5e6, 11e6), (.004, .08, .079, .1) * 2, (1, 1.001, 1.002, 1.005, 2, 2, 2, 2))]
    assert [finding.text for finding in study.findings(known)] == [
        "Beside its own displaced plate under a sun our normal map is off by 0.4 %, that of Cycles of Blender 3.4 by 8 %, that of Cycles of Blender 5.0 by 7.9 %, "
        "that of Mitsuba 3 by 10 %.",
        "The displaced plates are the same in all of them, so that the errors can be compared: their brightness under the sun differs by 0.5 % at most.",
        "Million samples a second of the whole picture: under a sun 9 (libshade), 1 (Cycles), 2 (Cycles 5), 12 (Mitsuba 3); under a sky 8 (libshade), 1.5 (Cycles), "
        "2.5 (Cycles 5), 11 (Mitsuba 3)."]
    assert [(finding.figure, finding.timed) for finding in study.findings(known)] == [("peers", False), ("peers", False), ("peers", True)]
    table, = study.tables(known)
    assert table.id == "peers" and list(table.columns) == ["renderer", "version", "light", "million samples/s", "median time, s", "relMSE", "time to relMSE 0.001, s", "error, %"]
    assert table.caption.startswith("256² pixels, 64 samples. ")
    seconds = [.5, 5, 6, .4]
    assert table.rows == [[name, "v", light, pytest.approx(row["samples_per_second"] / 1e6), second, .002, 3, pytest.approx(100 * row["error"])] for row, (light, name, second) in zip(
        known, [(light, name, second) for light in ("sun", "sky") for name, second in zip(
            ("Blender 3.4 with libshade", "Cycles of Blender 3.4", "Cycles of Blender 5.0", "Mitsuba 3"), seconds)])]


def test_tasks_of_its_target(monkeypatch):
    monkeypatch.setattr(study, "ready", lambda: True)
    assert [(task.key, task.seconds, task.command) for task in study.tasks(False)] == [
        (f"{engine}-{light}", seconds, "make compare-peers") for light in ("sun", "sky")
        for engine, seconds in (("libshade", 40), ("cycles", 120), ("cycles_5", 160), ("mitsuba", 40))]
    assert study.SIZES == {"size": 256, "samples": 64, "many": 1024, "repeat": 3, "quads": 1000} and study.tasks(True) == []
    monkeypatch.setattr(study.sheet, "panels", lambda tiles, across: f"{len(tiles)} by {across}")
    tiles = [{"kind": "tile", "figure": "sky", "place": place} for place in range(3)]
    assert [(figure.id, figure.title, figure.svg) for figure in study.figures(tiles)] == [("pictures-sky", "The plate under a sky", "3 by 2")]
