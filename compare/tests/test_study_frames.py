# SPDX-License-Identifier: Apache-2.0
"""study_frames.py without a renderer: the sphere's numbers, what is compared of a picture, findings on altered rows."""
import json
import re
from types import SimpleNamespace

import numpy as np
import pytest

import sphere
import study_frames as study

COST = 1.4


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


# ---- what is asked of the renderers, and what is said


def test_what_its_words_promise():
    """Pictures, blocks and counts are those of the introduction and the table."""
    assert study.SIZE == {"sun": 512, "sky": 256} and study.TRUTH == {"sun": 128, "sky": 512} and study.REPEAT == 3
    assert study.BLOCK == {("plate", "sun"): 1, ("plate", "sky"): 4, ("sphere", "sun"): 8, ("sphere", "sky"): 4}
    assert study.SAMPLES == {"sun": (4, 16, 64), "sky": (16, 64, 256)} and all(2 * side**2 > 1e6 for side in study.QUADS.values())
    assert {task.command for task in study.tasks(False)} == {"build/venv/bin/python compare/report_page.py --only frames"}
    assert [(task.key, task.seconds) for task in study.tasks(False)] == [("plate-sun", 120), ("plate-sky", 150), ("sphere-sun", 120), ("sphere-sky", 150)]


def test_jobs_of_each_engine(monkeypatch, tmp_path):
    asked = []

    def run(folder, jobs, python=None, normals=None):
        asked.append((jobs, python, normals))
        return {key: f"picture of {key}" for key in jobs}, {key: [1.0] for key in jobs}, "9"
    monkeypatch.setattr(study.plate_jobs, "run", run)
    monkeypatch.setattr(study.peers, "run_mitsuba", lambda folder, jobs, normals: run(folder, jobs, "mitsuba", normals))
    monkeypatch.setattr(study, "normals_of", lambda shape: f"normals of {shape}")
    job = study.job_of("gram_schmidt", "plate", "sun", "s.exr", 7, extra=1)
    assert job == {"engine": "LIBSHADE", "shape": "plate", "surface": "bumped", "ggx": (study.peers.ROUGHNESS, study.peers.ANISOTROPY), "size": study.SIZE["sun"],
                   "quads": study.QUADS["plate"], "samples": 7, "repeat": study.REPEAT, "seed": 1, "extra": 1, "detail": "gram_schmidt"}
    assert study.job_of("libshade", "sphere", "sky", "s.exr", 7)["detail"] == "rotate" and study.job_of("libshade", "sphere", "sky", "s.exr", 7)["sky"] == "s.exr"
    assert study.job_of("cycles_5", "plate", "sun", None, 7)["engine"] == "CYCLES" and "detail" not in study.job_of("cycles", "plate", "sun", None, 7)
    found = study.in_blender(("libshade", "perturb"), "plate", "sun", None, tmp_path, "python")
    counts = study.SAMPLES["sun"]
    assert list(found) == [*(("libshade", samples) for samples in counts), ("perturb", counts[-1])]
    assert found["perturb", counts[-1]] == (f"picture of {('perturb', counts[-1])}", [1.0], "9")
    (jobs, python, normals), = asked
    assert (python, normals) == ("python", "normals of plate") and jobs["libshade", counts[0]]["output"] == f"{tmp_path}/libshade-{counts[0]}.exr"
    found = study.in_mitsuba("sphere", "sky", "s.npy", tmp_path)
    assert list(found) == [("mitsuba", samples) for samples in study.SAMPLES["sky"]] and asked[-1][1:] == ("mitsuba", "normals of sphere")
    assert all(job["sky"] == "s.npy" and job["samples"] == samples for (_engine, samples), job in asked[-1][0].items())


def test_the_truth_is_kept_until_what_makes_it_changes(monkeypatch, tmp_path):
    """The mean of two renders with seeds of their own; half their difference is its noise."""
    made, version = [], [b"Blender 3.4\nmore"]

    def run(folder, jobs, normals=None):
        made.append({name: (job["surface"], job["samples"], job["repeat"], job["seed"], job["engine"]) for name, job in jobs.items()})
        for name, value in (("truth-7", 1.0), ("truth-8", 2.0)):
            study.pictures.write_float(jobs[name]["output"], np.full((study.SIZE["sun"],) * 2 + (3,), value, np.float32))
    monkeypatch.setattr(study.plate_jobs, "run", run)
    monkeypatch.setattr(study, "normals_of", lambda shape: None)
    monkeypatch.setattr(study, "SIZE", {"sun": 16})
    monkeypatch.setattr(study.subprocess, "run", lambda *_words, **_options: SimpleNamespace(stdout=version[0]))
    said = []
    for _ in range(2):
        picture, noise = study.truth("plate", "sun", None, tmp_path, said.append)
        assert picture.mean() == 1.5 and noise == pytest.approx(.25) and said == ["the truth"]
    assert made == [{f"truth-{seed}": ("displaced", study.TRUTH["sun"], 0, seed, "CYCLES") for seed in (7, 8)}]
    version[0] = b"Blender 5.0\nmore"
    study.truth("plate", "sun", None, tmp_path, said.append)
    assert len(made) == 2


@pytest.mark.parametrize("light, there", [("sun", {"cycles_5": True, "mitsuba": True}), ("sky", {"cycles_5": False, "mitsuba": False})])
def test_rows_of_a_scene(monkeypatch, tmp_path, light, there):
    """Of each engine that is there; POV-Ray knows no sky."""
    said, picture = [], np.ones((8, 8, 3))
    monkeypatch.setattr(study, "there", lambda: there)
    monkeypatch.setattr(study, "truth", lambda *words: (words[2], .001))
    monkeypatch.setattr(study, "in_blender", lambda engines, *words: {(engine, 4): ((engine, words), [1.0, 2.0], "b") for engine in engines})
    monkeypatch.setattr(study, "in_mitsuba", lambda *words: {("mitsuba", 4): (("mitsuba", words), [3.0], "m")})
    monkeypatch.setattr(study.frames_povray, "run", lambda folder, shape, size, alphas, sides, repeat: {
        side: (("povray", size, alphas, repeat), [4.0], "p") for side in sides})
    monkeypatch.setattr(study.paths, "studio", lambda: picture)
    monkeypatch.setattr(study.pictures, "write_float", lambda path, made: said.append(path))
    monkeypatch.setattr(study, "error", lambda made, true, shape, of: len(made[0]) / 100)
    monkeypatch.setattr(study, "tiles", lambda folder, shape, of, true, made: [{"kind": "tile", "of": [shape, of, true, len(made)]}])
    rows = study.frames("plate", light)(tmp_path, said.append)
    sky = f"{tmp_path}/sky.exr" if light == "sky" else None
    assert rows[-1]["of"] == ["plate", light, sky, 9 if light == "sun" else 4]
    assert [row["engine"] for row in rows if row["kind"] == "missing"] == ([] if light == "sun" else ["cycles_5", "mitsuba"])
    found = [(row["engine"], row["samples"], row["run"], row["seconds"], row["error"], row["version"]) for row in rows if row["kind"] == "frame"]
    ours = [(engine, 4, k, k + 1.0, len(engine) / 100, "b") for engine in ("libshade", "cycles", "gram_schmidt", "perturb") for k in (0, 1)]
    more = [("cycles_5", 4, k, k + 1.0, .08, "b") for k in (0, 1)] + [("mitsuba", 4, 0, 3.0, .07, "m")] + [("povray", n, 0, 4.0, .06, "p") for n in (1, 4, 16)]
    assert found == ours + (more if light == "sun" else []) and {row["noise"] for row in rows if row["kind"] == "frame"} == {.001}
    assert said == (["Blender 3.4", "Blender 5.0", "Mitsuba", "POV-Ray"] if light == "sun" else [sky, "Blender 3.4"])


def test_what_the_table_and_the_sentences_say(rows):
    found = [finding.text for finding in study.findings(rows)]
    near = lambda off: [{**row, "error": off} if (row["engine"], row["shape"], row["light"]) == ("libshade", "sphere", "sky") else row for row in rows]
    assert "our picture is 1 % from the displaced truth, by their normal maps " in found[0] and "Cycles 10 %, Cycles 5 10 %, Mitsuba 3 10 %" in found[0]
    assert found[0].endswith("; POV-Ray with libshade 1 %.") and not any("POV-Ray" in text for text in found[1::2][:2]) and "too near" not in "".join(found)
    for off, holds, said in ((.104, True, True), (.096, True, True), (.094, True, False), (.106, False, False)):
        told = study.findings(near(off))[3]
        assert (told.holds, "(too near to tell apart)." in told.text) == (holds, said)
    assert found[4] == "With as many samples Cycles takes 5.0 to 5.0 times as long as our engine, Cycles 5 takes 6.0 to 6.0 times as long as our engine."
    assert found[5].startswith("The truth's own noise is 0.1 % to 0.1 %, at most 0.10 of our smallest error there (")
    table, = study.tables(rows)
    assert (table.id, table.columns) == ("numbers", ["surface", "light", "renderer", "samples", "seconds", "middle half", "error, %"])
    assert table.caption == "Two cores; errors over the mean of the truth. Versions: 1."
    samples = study.SAMPLES["sun"][0]
    assert table.rows[0] == [study.SHAPES["plate"], study.LIGHTS["sun"], study.ENGINES["libshade"], samples, pytest.approx(samples), f"{samples:.2f} to {samples:.2f}", pytest.approx(1)]


def test_a_line_for_each_renderer(rows, monkeypatch):
    """Seconds against error; the title says which light."""
    panels = []
    monkeypatch.setattr(study.style, "svg", lambda figure: panels.append(figure.axes[0]) or "")
    monkeypatch.setattr(study.style, "labels", lambda axes, points, lines: [axes.text(x, y, word) for x, y, word in points])
    study.chart(rows, "plate", "sun")
    axes, = panels
    assert (axes.get_title("left"), axes.get_xlabel(), axes.get_ylabel()) == (study.LIGHTS["sun"], "seconds a frame, two cores", "error against the displaced surface")
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    counts = study.SAMPLES["sun"]
    wanted = {"libshade": (.01, 1), "cycles": (.1, 5), "cycles_5": (.1, 6), "mitsuba": (.1, .9), "povray": (.01, 4)}
    assert {text.get_text(): text.get_position() for text in axes.texts} == {word: (pytest.approx(seconds * counts[-1]), error) for word, (error, seconds) in wanted.items()}
    drawn = [container.lines[0].get_xydata() for container in axes.containers]
    assert len(drawn) == 5 and np.allclose(drawn[0], [(samples, .01) for samples in counts])
    study.style.pyplot.close("all")


def test_what_is_drawn_of_each_surface(rows, monkeypatch):
    """A chart for each light that it was seen under, then its pictures; of one that was not seen nothing."""
    monkeypatch.setattr(study, "chart", lambda _rows, shape, light: f"{shape} {light}")
    monkeypatch.setattr(study.sheet, "panels", lambda tiles: f"pictures of {[tile['figure'] for tile in tiles]}")
    tiles = [{"kind": "tile", "figure": f"{shape}-{light}"} for shape, light in study.SCENES]
    pictures = lambda shape, light: (f"pictures-{shape}-{light}", f"pictures of ['{shape}-{light}']")
    both = [made for shape in ("plate", "sphere") for made in ((f"frames-{shape}", f"{shape} sun\n{shape} sky"), pictures(shape, "sun"), pictures(shape, "sky"))]
    assert [(figure.id, figure.svg) for figure in study.figures(rows + tiles)] == both
    assert [figure.title for figure in study.figures(rows + tiles)] == ["Seconds against error, the plate", "The plate under a sun", "The plate under a studio's sky",
                                                                       "Seconds against error, the sphere", "The sphere under a sun", "The sphere under a studio's sky"]
    one = [row for row in rows if (row["shape"], row["light"]) == ("sphere", "sky")]
    assert [(figure.id, figure.svg) for figure in study.figures(one + tiles)] == [("frames-sphere", "sphere sky"), pictures("sphere", "sky")]


def test_times_are_compared_at_the_most_samples(rows):
    """Turn by turn: each against ours of that turn."""
    few = [{**row, "seconds": 99.0} if row["engine"] == "cycles" and row["samples"] < max(study.SAMPLES[row["light"]]) else row for row in rows]
    slow = [{**row, "seconds": row["seconds"] * (1 + row["run"])} for row in few]  # a machine that gets slower
    assert study.ratio(few, "plate", "sun", "cycles") == study.ratio(slow[::-1], "plate", "sun", "cycles") == pytest.approx(5)


def test_the_plate_is_rendered_in_blender(monkeypatch, tmp_path):
    """In the system's, or by another's Python; what it says of the time, by job."""
    jobs_of = study.plate_jobs
    asked = []

    def step(text, command, log, environment):
        asked.append((text, command, log, environment))
        order = json.loads((tmp_path / "jobs.json").read_text())
        assert (order["normal_map"], order["result"]) == (f"{tmp_path}/normals.exr", f"{tmp_path}/seconds.json") and [job["n"] for job in order["jobs"]] == [1, 2]
        for job in order["jobs"]:
            study.pictures.write_float(job["output"], np.full((2, 2, 3), job["n"], np.float32))
        (tmp_path / "seconds.json").write_text('{"seconds": [[1.5], [2, 3]], "blender": "3.4.1"}')
    monkeypatch.setattr(jobs_of.report, "step", step)
    monkeypatch.setattr(jobs_of.plate, "normal_map", lambda size: np.full((2, 2, 3), size / 4096, np.float32))
    jobs = {name: {"n": number, "output": str(tmp_path / f"{name}.exr")} for number, name in ((1, "a"), (2, "b"))}
    made, seconds, version = jobs_of.run(tmp_path, jobs)
    assert ({name: picture.mean() for name, picture in made.items()}, seconds, version) == ({"a": 1, "b": 2}, {"a": [1.5], "b": [2, 3]}, "3.4.1")
    assert study.pictures.read(tmp_path / "normals.exr").mean() == .5
    jobs_of.run(tmp_path, jobs, python="/p/python", normals=np.zeros((2, 2, 3), np.float32))
    assert study.pictures.read(tmp_path / "normals.exr").mean() == 0
    script, programs = study.programs.HERE / "plate_render.py", study.programs
    assert [command for _text, command, *_ in asked] == [programs.blender(script, tmp_path / "jobs.json"), ["/p/python", str(script), "--", f"{tmp_path}/jobs.json"]]
    assert {(text, log) for text, _command, log, _environment in asked} == {("Rendering the plate 2 times", tmp_path / "blender.log")} and asked[0][3] == programs.ADD_ON


def test_the_scene_in_pov_ray(monkeypatch, tmp_path):
    """The same sun and material, z into the picture; samples are a larger picture's means, and each turn is timed."""
    frames, clock, asked = study.frames_povray, iter(range(99)), []

    def step(text, command, log, folder):
        asked.append(command)
        width, height = (int(word[2:]) for word in command[4:6])
        picture = np.zeros((height, width, 3), np.float32)
        picture[::2] = 1
        study.pictures.write_float(tmp_path / "povray.exr", picture)
        assert log == tmp_path / "povray.log" and folder == tmp_path
        return "Persistence of Vision\nPOV-Ray 3.8.0-beta\n" if len(asked) > 1 else ""
    monkeypatch.setattr(frames.report, "step", step)
    monkeypatch.setattr(frames.time, "perf_counter", lambda: float(next(clock)))
    found = frames.run(tmp_path, "plate", 8, (.05, .3), (1, 2), 2)
    assert [command[1:] for command in asked] == [["frame.pov", "+Opovray.exr", "+FE", f"+W{side}", f"+H{side}", "-D", "-A"] for side in (8, 8, 16, 16)]
    assert asked[0][0] == study.programs.POVRAY
    assert {side: (picture.shape, picture[0, 0, 0], seconds, version) for side, (picture, seconds, version) in found.items()} == {
        1: ((8, 8, 3), 1, [1, 1], "POV-Ray 3.8.0-beta"), 2: ((8, 8, 3), .5, [1, 1], "POV-Ray 3.8.0-beta")}
    text = " ".join((tmp_path / "frame.pov").read_text().split())
    sun = frames.plate.SUN
    for words in (f"light_source {{ <{sun[0]:.9f}, {sun[1]:.9f}, {-sun[2]:.9f}> * 100 rgb 1/pi parallel point_at 0 }}", "ggx 0.05, 0.3 brdf microfacet specular rgb 1 detail rotate",
                  "fresnel none horizon hard tangent uv", "orthographic location <0, 0, -2> right x up y direction z", 'bump_image { exr "normals.exr" }', "assumed_gamma 1"):
        assert words in text
    mesh = (tmp_path / "mesh.inc").read_text()
    block = lambda name, mesh=mesh: [[float(v) for v in row.split(",")] for row in re.findall("<(.*?)>", re.search(rf"(?s){name} {{ (\d+),\n(.*?)\n}}", mesh)[2])]
    corners, flat = block("vertex_vectors"), block("uv_vectors")
    assert sorted(corners) == [[-.5, -.5, 0], [-.5, .5, 0], [.5, -.5, 0], [.5, .5, 0]] and np.allclose(np.array(corners)[:, :2] + .5, flat) and "normal_vectors" not in mesh
    assert len(block("face_indices")) == 2 and {*sum(block("face_indices"), [])} == {0, 1, 2, 3}
    monkeypatch.setattr(frames.sphere, "mesh", lambda count, relief: (np.array([[0, 0, 1.0]] * 4), np.array([[0, .6, .8]] * 4), np.array([[0, 1, 2, 3]]), np.zeros((4, 2))))
    ball = frames.mesh_text("sphere")
    assert block("vertex_vectors", ball) == [[0, 0, -1]] * 4 and block("normal_vectors", ball) == [[0, .6, -.8]] * 4 and block("face_indices", ball) == [[0, 1, 2], [0, 2, 3]]
