# SPDX-License-Identifier: Apache-2.0
"""What truth.py, consistency.py and slopes.py ask of the renderers, and what they print and draw, word by word; nothing is rendered."""
import json
import re
from collections import namedtuple
from types import SimpleNamespace as Of

import numpy as np
import pytest
from matplotlib import pyplot as plt

import consistency
import fabric
import horizon
import paths
import pictures
import plate
import programs
import report
import slopes
import speed
import truth

COST = 2.2


def title(axes):
    """Which stands on the left once style.py has been there."""
    return axes.get_title() or axes.get_title("left")


def options(*words):
    return truth.arguments([str(word) for word in words])


# ---- truth.py: what is rendered


@pytest.mark.parametrize("words, folder, size, light", [
    ([], "truth", 512, "sun"), (["--surface", "scratches"], "truth-scratches", 512, "sun"), (["--light", "sky"], "truth-sky", 256, "sky"),
    (["--eye", 30], "truth-waves-30-1", 256, "sky"), (["--surface", "letter", "--slope", ".5"], "truth-letter-90-0.5", 256, "sky"),
    (["--surface", "noise", "--size", 64], "truth-noise-90-1", 64, "sky")])
def test_what_goes_without_saying(words, folder, size, light):
    made = options(*words)
    assert (made.output, made.size, made.light) == (programs.BUILD / "compare" / folder, size, light)
    assert (made.samples, made.quads, made.map, made.eye, made.results) == (256, 800, 2048, 30 if "--eye" in words else 90, False)


@pytest.mark.parametrize("words, said", [
    (["--eye", 14], "--eye wants 15 to 90 degrees, --slope 0.1 to 2"), (["--eye", 91], "15 to 90"), (["--slope", ".09"], "0.1 to 2"), (["--slope", 2.1], "0.1 to 2"),
    (["--eye", 30, "--surface", "scratches"], "--eye is for waves, noise, ridges and letter"), (["--light", "sky", "--size", 100], "a --size that is a multiple of 32"),
    (["--light", "sky", "--surface", "scratches"], "--light sky is not for --surface scratches"), (["--sky", __file__], "--sky is for --light sky"),
    (["--light", "sky", "--sky", "/none.exr"], "/none.exr: no such file"), (["--light", "moon"], "invalid choice")])
def test_what_cannot_be_asked(words, said, capsys):
    with pytest.raises(SystemExit) as end:
        options(*words)
    assert end.value.code == 2 and said in capsys.readouterr().err


def test_what_is_rendered_of_each_surface():
    cycles, ours = {"engine": "CYCLES"}, {"engine": "LIBSHADE", "surface": "bumped"}
    flat, real = {**cycles, "surface": "bumped"}, {**cycles, "surface": "displaced"}
    of = lambda *words: list(truth.jobs_of(options(*words)).items())
    detail = lambda *words: [(word, {**ours, "detail": word}) for word in words]
    assert of() == [("displaced", real), ("Cycles' normal map", flat), *detail("none", "perturb", "gram_schmidt", "rotate"), ("Cycles' Anisotropic, here", ours)]
    assert of("--surface", "scratches") == [("displaced", real), ("Cycles' normal map", flat), *detail(
        "none", "perturb", "deform_linear", "deform_smooth", "shortest_arc", "gram_schmidt", "rotate")]
    assert of("--light", "sky") == [("displaced", real), ("Cycles' normal map", flat), *detail("rotate"), ("Cycles' Anisotropic, here", ours)]
    shared = {"ggx": (pytest.approx(.2**.5), 0), "bounces": 12, "eye": 30, "tiles": 5, "color": .6}
    assert of("--eye", 30) == [("displaced", {**real, **shared}), ("Cycles' normal map", {**flat, **shared}), *(
        (word, {**ours, "detail": "rotate", "horizon": word.upper(), **shared}) for word in ("hard", "valid_estevez", "schuessler", "mutual"))]
    assert [truth.tiles(Of(eye=eye)) for eye in (90, 89, 45, 15)] == [1, 3, 3, 7]


@pytest.fixture
def ordered(monkeypatch, tmp_path):
    """What is asked of Blender; its pictures are of the number of their file."""
    asked = []

    def step(text, command, log, environment=None, folder=None, allowed=(0,)):
        order = json.loads((tmp_path / "jobs.json").read_text())
        assert not any(truth.Path(job["output"]).exists() for job in order["jobs"])  # an earlier run's are gone
        asked.append((text, [str(word) for word in command], log, environment, order))
        for number, job in enumerate(order["jobs"]):
            pictures.write_float(job["output"], np.full((4, 4, 3), number, np.float32))
    monkeypatch.setattr(report, "step", step)
    monkeypatch.setattr(plate, "normal_map", lambda size: np.full((2, 2, 3), size / 4096, np.float32))
    return asked


def test_how_the_plate_is_rendered(ordered, monkeypatch, tmp_path):
    (tmp_path / "0.exr").write_text("old")
    images = truth.render(options("--output", tmp_path, "--samples", 8, "--map", 1024, "--quads", 40))
    text, command, log, environment, order = ordered.pop()
    assert (text, log, environment) == ("Rendering the plate 7 times in Blender", tmp_path / "blender.log", programs.ADD_ON)
    assert command == [str(word) for word in programs.blender(programs.HERE / "plate_render.py", tmp_path / "jobs.json")]
    assert (order["mesh"], order["normal_map"], order["result"]) == ("", f"{tmp_path}/normals.exr", f"{tmp_path}/seconds.json")
    assert all((job["size"], job["samples"], job["quads"], job["repeat"]) == (512, 8, 40, 0) for job in order["jobs"])
    assert {name: float(image.mean()) for name, image in images.items()} == {name: number for number, name in enumerate(truth.jobs_of(options()))}
    assert pictures.read(tmp_path / "normals.exr").mean() == .25
    skies = [tmp_path / f"{name}.exr" for name in ("one", "two")]
    for sky in skies:
        sky.touch()
    found = truth.render_skies(options("--output", tmp_path, "--light", "sky", "--samples", 8, "--sky", skies[0], "--sky", skies[1]))
    *_words, order = ordered.pop()
    assert [job["sky"] for job in order["jobs"]] == [str(skies[0])] * 5 + [str(skies[1])] * 5 and [job["seed"] for job in order["jobs"]] == [0, 1, 2, 3, 4] * 2
    assert [job["samples"] for job in order["jobs"][:5]] == [8, 8, 32, 32, 8]  # ours has four times as many
    names = ["displaced", truth.CYCLES, "rotate", truth.STOCK, truth.AGAIN]
    assert {sky: {name: float(image.mean()) for name, image in images.items()} for sky, images in found.items()} == {
        "one": dict(zip(names, range(5))), "two": dict(zip(names, range(5, 10)))}
    made = []
    monkeypatch.setattr(plate, "relief_map", lambda *words: made.append(words) or np.zeros((2, 2, 3), np.float32))
    monkeypatch.setattr(plate, "relief_mesh", lambda *words: made.append(words) or (np.zeros((3, 3)), np.zeros((1, 3), int), np.zeros((3, 2))))
    assert truth.prepare(options("--output", tmp_path, "--surface", "ridges", "--slope", .5, "--eye", 45, "--map", 64, "--quads", 10)) == {
        "normal_map": f"{tmp_path}/normals.exr", "mesh": f"{tmp_path}/mesh.npz"}
    assert made == [("ridges", .5, 64), ("ridges", .5, 10, 3)] and sorted(np.load(tmp_path / "mesh.npz")) == ["faces", "positions", "uv"]


def test_scratches_are_those_of_the_tool(monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(truth.subprocess, "run", lambda command, **words: asked.append(command) or Of(returncode=0, stderr=""))
    monkeypatch.setattr(truth.pictures, "read", lambda path: np.zeros((4, 4, 3)) if path == tmp_path / "height.exr" else None)
    monkeypatch.setattr(plate, "height_mesh", lambda height: (np.zeros((3, 3)), np.zeros((1, 3), int), np.zeros((3, 2))))
    order = truth.prepare(options("--surface", "scratches", "--output", tmp_path, "--map", 64, "--quads", 10))
    assert order == {"normal_map": f"{tmp_path}/normals.exr", "mesh": f"{tmp_path}/mesh.npz"}
    tool = [programs.SHADE, "scratch", *plate.SCRATCHES]
    assert asked == [[*tool, "-o", f"{tmp_path}/normals.exr", "--size", "64"], [*tool, "--height", f"{tmp_path}/height.exr", "--size", "10"]]
    monkeypatch.setattr(truth.subprocess, "run", lambda command, **words: Of(returncode=1, stderr="shade: too large\n") if words["text"] else None)
    with pytest.raises(SystemExit, match="^shade: too large$"):
        truth.scratch()


def test_skies_are_those_of_blender(monkeypatch, tmp_path):
    world = tmp_path / "datafiles/studiolights/world"
    world.mkdir(parents=True)
    for name in ("night", "city"):
        (world / f"{name}.exr").touch()
    monkeypatch.setattr(truth.subprocess, "run", lambda command, **words: Of(stdout=f"Blender\nskies in {tmp_path}/datafiles\n"))
    monkeypatch.setattr(paths, "studio", lambda: np.zeros((2, 4, 3), np.float32))
    made = truth.skies(options("--light", "sky", "--output", tmp_path))
    assert list(made.items()) == [("drawn", tmp_path / "sky.exr"), ("city", world / "city.exr"), ("night", world / "night.exr")] and made["drawn"].exists()
    same = [tmp_path / name / "a.exr" for name in "xy"]
    for path in same:
        path.parent.mkdir()
        path.touch()
    assert truth.skies(options("--light", "sky", "--sky", same[0])) == {"a": same[0]}
    assert truth.skies(options("--light", "sky", "--sky", same[0], "--sky", same[1])) == {str(path): path for path in same}


# ---- what it prints and draws


@pytest.fixture
def shown(monkeypatch):
    """Figures instead of files."""
    made = []
    monkeypatch.setattr(plt.Figure, "savefig", lambda self, path, **words: (made.append((self, words)), path.touch()))
    yield made
    plt.close("all")


def chequered(**errors):
    """Pictures that are off by these parts of the mean, in both directions."""
    displaced = np.random.default_rng(3).random((64, 64, 3)) + .5
    sign = np.kron(np.where(np.indices((16, 16)).sum(0) % 2, 1, -1), np.ones((4, 4)))[..., None]
    return {"displaced": displaced, **{name: displaced + off * displaced.mean() * sign for name, off in errors.items()}}


def test_the_plate_under_a_sun(monkeypatch, tmp_path, capsys, shown):
    images = chequered(**{truth.CYCLES: .1, "none": .5, "perturb": .2, "gram_schmidt": .05, "rotate": .015, truth.STOCK: .012})
    monkeypatch.setattr(truth, "render", lambda _options: images)
    kept = []
    monkeypatch.setattr(truth.results, "write", lambda *words: kept.append(words))
    assert truth.main(["--output", str(tmp_path), "--results"]) == 1  # of STOCK's own limit
    assert capsys.readouterr().out.splitlines() == [
        "", "normal map against displaced plate   error  limit", "----------------------------------  ------  -----  ------",
        "Cycles' normal map                  0.1000", "none                                0.5000", "perturb                             0.2000",
        "gram-schmidt                        0.0500", "rotate                              0.0150   0.02      ok",
        "Cycles' Anisotropic, here           0.0120   0.01  MISSED", "", f"Pictures and figures: {tmp_path}"]
    (name, head, columns, rows), = kept
    assert (name, head["command"], columns) == ("displaced-waves", "make compare", ["method", "error", "limit"])
    assert [(row[0], pytest.approx(row[1]), row[2]) for row in rows][4:] == [("rotate", .015, .02), ("Cycles' Anisotropic, here", .012, .01)]
    (strip, _), (chart, _) = shown
    assert [title(axes) for axes in strip.axes] == ["displaced mesh (truth)", "rotate: 0.0150", "gram-schmidt: 0.0500", "Cycles' normal map: 0.1000", "perturb: 0.2000"]
    first = strip.axes[0].get_images()[0].get_array()
    assert np.allclose(first, pictures.encode(.5 / images["displaced"].mean() * images["displaced"])) and not strip.axes[0].axison
    axes, = chart.axes
    names = ["none", "perturb", "Cycles' normal map", "gram-schmidt", "rotate", "Cycles' Anisotropic, here"]  # the worst at the bottom
    assert [tick.get_text() for tick in axes.get_yticklabels()] == names and [text.get_text() for text in axes.texts] == [
        " 0.5000", " 0.2000", " 0.1000", " 0.0500", " 0.0150", " 0.0120"]
    assert [bar.get_width() for bar in axes.patches] == pytest.approx([.5, .2, .1, .05, .015, .012]) and axes.get_xscale() == "log"
    assert [tuple(bar.get_facecolor()) == tuple(plt.matplotlib.colors.to_rgba("#c8553d")) for bar in axes.patches] == [name == truth.CYCLES for name in names]
    assert axes.get_xlabel() == "mean absolute error / mean, against the displaced plate (dotted: limit)" and axes.lines[0].get_xdata()[0] == .02
    assert axes.get_xlim() == pytest.approx((.004, 2)) and axes.xaxis.get_major_formatter()(0.05, 0) == "0.05"
    said = json.loads((tmp_path / "truth.json").read_text())
    assert (said["ok"], said["size"], said["samples"], said["quads"], said["map"], said["surface"], said["light"], said["compared"], said["limits"]) == (
        False, 512, 256, 800, 2048, "waves", "sun", 1, {"rotate": .02, "Cycles' Anisotropic, here": .01})


def skies_of(**errors):
    """Two skies; under the second errors are twice as large."""
    made = {}
    for sky, times in (("drawn", 1), ("city", 2)):
        images = chequered(**{name: times * off for name, off in errors.items()})
        images["displaced"] = images[truth.AGAIN] = np.kron(np.random.default_rng(3).random((16, 16, 3)) + .5, np.ones((4, 4, 1)))
        off = .002 * times * images["displaced"].mean()
        sign = np.kron(np.where(np.indices((16, 16)).sum(0) % 2, 1, -1), np.ones((4, 4)))[..., None]
        for name, part in errors.items():
            images[name] = images["displaced"] * (1 + times * part)
        images["displaced"], images[truth.AGAIN] = images["displaced"] + off * sign, images["displaced"] - off * sign
        made[sky] = images
    return made


def test_the_plate_under_skies(monkeypatch, tmp_path, capsys, shown):
    made = skies_of(**{truth.CYCLES: .1, "rotate": .03, truth.STOCK: .04})
    monkeypatch.setattr(truth, "render_skies", lambda _options: made)
    monkeypatch.setattr(truth, "of_the_normal_alone", lambda picture: picture * 1.02)
    kept = []
    monkeypatch.setattr(truth.results, "write", lambda *words: kept.append(words))
    assert truth.main(["--output", str(tmp_path), "--light", "sky", "--results"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert re.split(r"  +", said[1]) == ["normal map against displaced plate, under", "Cycles' normal map", "rotate", "Cycles' Anisotropic, here", "of the normal alone",
                                         "noise of the truth"]
    assert [re.split(r"  +", line) for line in said[3:6]] == [
        ["drawn", "0.1000", "0.0300 (0.30)", "0.0400 (0.40)", "0.0200 (0.20)", "0.0020"], ["city", "0.2000", "0.0600 (0.30)", "0.0800 (0.40)", "0.0200 (0.10)", "0.0040"],
        ["median", "0.1500", "0.0450 (0.30)", "0.0600 (0.40)", "0.0200 (0.15)", "0.0030"]]
    assert said[6:] == ["", "In brackets, of Cycles' error. Wanted, at most 0.33 in the median: not reached.", "", f"Pictures and figures: {tmp_path}"]
    (name, _head, columns, rows), = kept
    assert (name, columns) == ("displaced-sky", ["sky", "Cycles' normal map", "rotate", "rotate, over Cycles'", "Cycles' Anisotropic, here", "Cycles' Anisotropic, here, over Cycles'",
                                                 "of the normal alone", "of the normal alone, over Cycles'", "noise of the truth"])
    assert [row[0] for row in rows] == ["drawn", "city", "median"] and rows[0][1:] == pytest.approx([.1, .03, .3, .04, .4, .02, .2, .002], rel=1e-4)
    (strip, _), (chart, _) = shown
    assert [title(axes) for axes in strip.axes] == ["displaced mesh (truth)", "rotate: 0.0300", "Cycles' normal map: 0.1000"]
    assert chart.axes[0].lines[0].get_xdata()[0] == pytest.approx(.05, rel=1e-4) and len(chart.axes[0].patches) == 4
    made["drawn"]["rotate"] = made["drawn"]["displaced"] * 1.5
    assert truth.main(["--output", str(tmp_path), "--light", "sky"]) == 1
    assert "in the median: not reached. MISSED: no less than Cycles' normal map." in capsys.readouterr().out


def test_rules_of_the_horizon_under_skies(monkeypatch, tmp_path, capsys, shown):
    made = skies_of(**{truth.CYCLES: .1, "hard": .08, "valid_estevez": .05, "schuessler": .2, "mutual": .03})
    made["city"]["mutual"] = made["city"]["displaced"] * 1.11
    made["drawn"]["hard"][:16] = 0  # a quarter of the picture
    monkeypatch.setattr(truth, "render_skies", lambda _options: made)
    assert truth.main(["--output", str(tmp_path), "--eye", "30"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert re.split(r"  +", said[1]) == ["waves, slope 1, eye at 30 degrees, under", "hard", "valid-estevez", "schuessler", "mutual", "Cycles' normal map", "noise of the truth"]
    rows = [re.split(r"  +", line) for line in said[3:]]
    assert [row[0] for row in rows[:5]] == ["drawn", "city", "median", "brightness over the truth's", "dark pixels"]
    assert rows[0][2:] == ["0.0500", "0.2000", "0.0300", "0.1000", "0.0020"] and rows[2][2:6] == ["0.0750", "0.3000", "0.0700", "0.1500"]
    assert rows[3][2:] == ["1.0750", "1.3000", "1.0700", "1.1500"] and rows[4][1:] == ["0.1250", "0.0000", "0.0000", "0.0000", "0.0000"]
    assert said[8:] == ["", "`mutual` is further off than valid-estevez, by more than the noise, under: city", "", f"Pictures and figures: {tmp_path}"]
    assert [title(axes) for axes in shown[0][0].axes] == ["displaced mesh (truth)", "valid-estevez: 0.0500", "mutual: 0.0300", "Cycles' normal map: 0.1000"]
    told = json.loads((tmp_path / "truth.json").read_text())
    assert (told["worse"], told["ok"], told["eye"], told["slope"], told["surface"]) == (["city"], True, 30, 1, "waves") and told["dark"]["hard"] == .125
    made["drawn"]["mutual"] = made["drawn"]["displaced"] * 1.2
    assert truth.main(["--output", str(tmp_path), "--eye", "30"]) == 1
    assert "under: drawn, city\nMISSED: further off than valid-estevez in the median." in capsys.readouterr().out


# ---- consistency.py


def test_what_both_renderers_are_asked(monkeypatch, tmp_path):
    asked = []

    def step(text, command, log, environment=None, folder=None, allowed=(0,)):
        asked.append((text, [str(word) for word in command], str(log.relative_to(tmp_path)), environment, folder, allowed))
        return "Fra:1\nsize 96 54\n" if text == "Rendering in Blender" else '{"pass": true}'
    monkeypatch.setattr(report, "step", step)
    given = consistency.arguments(["a.blend", "--output", str(tmp_path)])
    given.scene, inside = tmp_path / "a.blend", ["-b", "--factory-startup", "--addons", "libshade", f"{tmp_path}/a.blend", "--python-exit-code", "9", "-P"]
    assert consistency.render_blender(given) == (96, 54)
    consistency.export_povray(given)
    consistency.dump_povray(given, 96, 54)
    consistency.render_povray(given, 96, 54)
    consistency.render_povray(given, 96, 54, 2)
    for name in ("Blender", "POV-Ray"):
        assert consistency.check(name, tmp_path / f"{name}.exr", given) == {"pass": True}
    povray = lambda text, log, *words, environment=None: (text, [programs.POVRAY, "scene.ini", *words], log, environment, tmp_path / "povray", (0,))
    check = lambda name, largest, mean, *words: (f"Checking {name}'s dump against the reference", [
        programs.SHADE, "check", "--json", "--tolerance", largest, "--mean-tolerance", mean, *words, f"{tmp_path}/{name}.exr"], f"{name}_check.log", None, None, (0, 1))
    assert asked == [
        ("Rendering in Blender", [programs.BLENDER, *inside, f"{programs.HERE}/blender_render.py", "--", f"{tmp_path}/blender.exr", "100", "64"], "blender.log",
         {**programs.ADD_ON, "LIBSHADE_DUMP": f"{tmp_path}/blender_dump.exr"}, None, (0,)),
        ("Writing the scene for POV-Ray", [programs.BLENDER, *inside, f"{programs.HERE}/export_povray.py", "--", f"{tmp_path}/povray"], "export.log", programs.ADD_ON, None, (0,)),
        povray("Dumping in POV-Ray", "povray_dump.log", "+W96", "+H54", "+FE", "-D", "-A", f"+O{tmp_path}/povray_centres.exr",
               environment={"LIBSHADE_DUMP": f"{tmp_path}/povray_dump.exr"}),
        povray("Rendering in POV-Ray", "povray.log", "+W96", "+H54", "+FE", "-D", "+AM1", "+A0.001", "+R4", "-J", f"+O{tmp_path}/povray.exr"),
        povray("Rendering in POV-Ray", "povray.log", "+W192", "+H108", "+FE", "-D", "-A", f"+O{tmp_path}/povray.exr"),
        check("Blender", "0.0001", "1e-05"), check("POV-Ray", "1e-05", "1e-06")]
    given.all = True
    consistency.check("Blender", tmp_path / "b.exr", given)
    assert "--all" in asked[-1][1]
    monkeypatch.setattr(report, "step", lambda *_words, **_options: "nothing")
    with pytest.raises(report.StepFailed, match="Blender said no picture size; see .*/blender.log"):
        consistency.render_blender(given)
    with pytest.raises(report.StepFailed, match="b.exr: `shade check` found no figures:\nnothing"):
        consistency.check("Blender", tmp_path / "b.exr", given)


def test_what_rows_of_the_verdict_say(monkeypatch):
    checked = {"pass": True, "values": 9, "largest": 2e-4, "beyond_rounding": 5e-5, "mean": 2e-6, "faults": [], "idle_materials": 1, "idle_lights": 0}
    assert consistency.check_rows("Blender", checked) == ([["Blender against reference, largest error of S", "2.0e-04", "", "noted"],
                                                           ["Blender: largest error beyond what rounding of the dump's directions may do", "5.0e-05", "1e-04", "ok"],
                                                           ["Blender against reference, mean error of S", "2.0e-06", "1e-05", "ok"]], True)
    rows, good = consistency.check_rows("POV-Ray", {**checked, "pass": False, "faults": [{"what": "not finite", "x": 3, "y": 4, "count": 7}]}, every=True)
    assert not good and rows == [["POV-Ray against reference, largest error of S", "2.0e-04", "1e-05", "MISSED"], ["POV-Ray against reference, mean error of S", "2.0e-06", "1e-06", "MISSED"],
                                 ["POV-Ray: not finite, first at (3, 4)", "7 times", "0", "MISSED"], ["POV-Ray: materials with nothing to compare", "1", "0", "MISSED"]]
    assert consistency.check_rows("POV-Ray", {**checked, "idle_lights": 2}, every=True, limits=(1e-3, 1e-5))[0][-1] == ["POV-Ray: lights with nothing to compare", "2", "0", "MISSED"]
    monkeypatch.setattr(consistency.dumps, "coverage_difference", lambda a, b: .00123)
    error = np.zeros(1000)
    error[:4] = .5
    monkeypatch.setattr(consistency.dumps, "deviations", lambda a, b: {
        "material": error, "P": error, "uv": error, "N": error, "T": 2 * error, "Ns": np.ones(1000), "V": error, "light0.L": error, "light1.E": np.linspace(0, .002, 1000)})
    rows, good = consistency.dump_rows(None, None)
    assert not good and rows == [["covered by one only", "0.123 %", "0.5 %", "ok"]] + [[f"{name} equal within {limit}", f"{share} %", "99.5 %", said] for name, limit, share, said in (
        ("material", "1e-06 of its parameters", "99.600", "ok"), ("P", "0.0001 of the size", "99.600", "ok"), ("uv", "0.0001 of the map", "99.600", "ok"),
        ("N", "0.1 degrees", "99.600", "ok"), ("T", "0.1 degrees", "99.600", "ok"), ("Ns", "0.2 degrees", "0.000", "MISSED"), ("V", "0.1 degrees", "99.600", "ok"),
        ("light0.L", "0.1 degrees", "99.600", "ok"), ("light1.E", "0.001 of itself", "50.000", "MISSED"))]
    assert consistency.picture_rows(np.ones((2, 2, 3)), np.full((2, 2, 3), 1.0123)) == ([["pictures, mean difference over mean", "1.23 %", "2 %", "ok"]], True)
    assert consistency.picture_rows(np.ones((2, 2, 3)), np.full((2, 2, 3), 1.03))[0][0][1:] == ["3.00 %", "2 %", "MISSED"]


@pytest.mark.parametrize("words", [["--percent", "0"], ["--percent", "101"], ["--samples", "0"], ["--grid", "0"], ["--grid", "10"]])
def test_what_consistency_cannot_be_asked(words, capsys):
    with pytest.raises(SystemExit):
        consistency.arguments(["a.blend", *words])
    assert "--percent wants 1 to 100, --samples at least 1, --grid 1 to 9" in capsys.readouterr().err
    given = consistency.arguments(["a.blend"])
    assert (given.percent, given.samples, given.grid, given.all, given.output) == (100, 64, 4, False, programs.BUILD / "compare/consistency")


# ---- slopes.py


def test_what_filtered_maps_print_and_draw(monkeypatch, tmp_path, capsys, shown):
    """Each map's worst footprint, by lobes; of ripples the colour is not judged."""
    asked = {}
    lobes_off = {1: .2, 4: .05, 6: .02, 8: .01}

    def compare_map(name, normals):
        asked[name] = normals
        return [{"map": name, "distribution": mdf, "footprint": size, "lobes": lobes, "colour": off * size / 64 * (5 if name == slopes.RIPPLES else 1), "worst": .4, "bias": .0,
                 "moments": .08 * size / 64, "patches": .3 * size / 64} for mdf in slopes.LOBES for size in slopes.FOOTPRINTS for lobes, off in lobes_off.items()]
    monkeypatch.setattr(slopes, "compare_map", compare_map)
    for name in ("gaussian_map", "ripple_map", "scratch_map"):
        monkeypatch.setattr(slopes, name, lambda *words, name=name, **options: (name, words, {**options}))
    assert slopes.main(["--output", str(tmp_path)]) == 0
    assert asked == {"waves 0.05, 0.10": ("gaussian_map", (.05, .1, 1), {}), "waves 0.15, 0.10": ("gaussian_map", (.15, .1, 2), {}),
                     "ripples 0.15, 0.10": ("ripple_map", (.15, .1), {}), "scratches": ("scratch_map", (), {
                         "pits": 3000, "radius": (.004, .012), "stretch": (2, 8), "spread": pytest.approx(.34907, abs=1e-5), "depth": (.03, .12)})}
    said = [re.split(r"  +", line.strip()) for line in capsys.readouterr().out.splitlines()]
    assert said[0] == ["map", "distribution", "colour, %: 1 lobe", "4 lobes", "6 lobes", "8 lobes", "limit", "moments, %", "limit"]
    assert said[2] == ["waves 0.05, 0.10", "ashikhmin_shirley", "20.00", "5.00", "2.00", "1.00", "3 with 6", "8.00", "10", "ok"]
    assert said[10] == ["ripples 0.15, 0.10", "ashikhmin_shirley", "100.00", "25.00", "10.00", "5.00", "8.00", "10", "ok"]
    assert [line[:2] for line in said[2:18]] == [[name, mdf] for name in asked for mdf in ("ashikhmin_shirley", "beckmann", "ward", "ggx")]
    assert said[18:] == [[""], [f"Figures: {tmp_path}"]]
    (figure, _), = shown
    grid = np.array(figure.axes).reshape(3, 4)
    assert [title(axes) for axes in grid[0]] == list(asked) and {axes.get_xlabel() for axes in grid[0]} == {"lobes"}
    assert {axes.get_xlabel() for axes in grid[1:].flat} == {"footprint, texels a side"} and {axes.get_xscale() for axes in grid[1:].flat} == {"log"}
    assert [axes.get_ylabel() for axes in grid[:, 0]] == ["mean colour, worst footprint, % off", "mean colour, 6 lobes, % off", "second moments of slopes, % off"]
    assert all(axes.get_ylim()[0] == 0 for axes in grid.flat) and [axes.lines[-1].get_ydata()[0] for axes in grid[:, 1]] == pytest.approx([3, 3, 10])
    assert [[text.get_text() for text in axes.get_legend().get_texts()] for axes in grid[:, 0]] == [list(slopes.LOBES), list(slopes.LOBES), ["all patches together", "patch by patch"]]
    by_lobes, by_size, together = (axes.lines[0].get_xydata() for axes in grid[:, 0])
    assert np.allclose(by_lobes, [(1, 20), (4, 5), (6, 2), (8, 1)]) and np.allclose(by_size, [(size, size / 32) for size in (2, 4, 8, 16, 32, 64)])
    assert np.allclose(together, [(size, size / 8) for size in (2, 4, 8, 16, 32, 64)]) and np.allclose(grid[2, 0].lines[1].get_ydata(), together[:, 1] * 3.75)


def test_what_a_lookup_asks(monkeypatch):
    """Every patch of the map, rows from the top, by its own footprint; the scratches' normals, not their heights."""
    monkeypatch.setattr(slopes, "SIZE", 8)
    asked, Seen = [], namedtuple("Seen", "normal covariance")

    class Pyramid:
        def look_up(self, uv, footprint):
            asked.append((uv, footprint))
            count = len(uv)
            return Seen(np.tile([0.0, 0, 1], (count, 1)), np.tile([.01, 0, .02], (count, 1)))
    got = slopes.look_up(Pyramid(), 4, "ggx", (.1, .3), 2)
    (uv, footprint), = asked
    assert uv.tolist() == [[.25, .75], [.75, .75], [.25, .25], [.75, .25]] and footprint == (.5, 0, 0, .5)
    assert got.shape == (4, 9 + 2 * 4) and np.allclose(got[:, 2], 1) and np.allclose(got[:, [3, 5]], [.01, .02]) and np.allclose(got[:, [9, 13]].sum(1), 1)
    monkeypatch.setattr(slopes.shade, "Scratches", lambda layer, cells: Of(picture=lambda *size: ("height", np.full(size, layer["pits"] + cells), "more")))
    assert slopes.scratch_map(pits=7).tolist() == np.full((8, 8), 7.0).tolist()


# ---- horizon.py and fabric.py


def test_what_horizons_print_and_draw(monkeypatch, tmp_path, capsys, shown):
    """By measure, material and where light and eye stand; errors over the mean of the truth, against both elevations."""
    rows = [{"field": "waves", "material": mdf, "horizon": rule, "light": light, "view": view, "truth": 2.0, "truth_twice": 2.1,
             "mean": 2.0 + (rule == "hard") * (.4 if light < 15 else .2), "image": (.1 if view < 15 else .2) * (1 + (rule == "hard"))}
            for mdf in horizon.MATERIALS for rule in ("hard", "valid_estevez") for light in (10.0, 20.0, 40.0) for view in (10.0, 20.0, 40.0)]
    monkeypatch.setattr(horizon, "measure", lambda options: rows)
    kept = []
    monkeypatch.setattr(horizon.results, "write", lambda *words: kept.append(words))
    assert horizon.main(["--output", str(tmp_path), "--results"]) == 0
    said = [re.split(r"  +", line.strip()) for line in capsys.readouterr().out.splitlines()]
    assert said[1] == ["error against displaced bumps", "region", "hard", "valid_estevez"]
    regions = {"all": (.167, .083, .133, 0), "both above 30°": (.2, .1, .1, 0), "light below 15°": (.167, .083, .2, 0), "eye below 15°": (.1, .05, .133, 0)}
    assert said[3:27] == [[f"{measure}: {label}", region, *(f"{v:.3f}" for v in found[k:k + 2])] for measure, k in (("picture", 0), ("brightness", 2))
                          for label in ("Ashikhmin-Shirley", "GGX", "Lambert") for region, found in regions.items()]
    assert said[27:] == [[""], ["The truth is light reflected once; a second reflection would add 5.0 % to it."], [f"Figures and chart: {tmp_path}"]]
    (name, _head, columns, lines), = kept
    assert (name, columns) == ("horizons", ["error of the", "of", "where", "`hard`", "`valid_estevez`"]) and lines[0][:3] == ["picture", "Ashikhmin-Shirley", "all"] and len(lines) == 24
    assert (tmp_path / "errors.csv").read_text().splitlines()[:2] == ["measure,material,region,hard,valid_estevez", "picture,ashikhmin_shirley,all,0.1667,0.0833"]
    (figure, _words), = shown
    grid = np.array(figure.axes).reshape(3, 4)
    assert [title(axes) for axes in grid[0]] == [f"error of the {name}" for name in ("picture", "picture", "brightness", "brightness")]
    assert [axes.get_xlabel() for axes in grid[2]] == [f"elevation of the {name}" for name in ("light", "eye")] * 2
    assert [axes.get_ylabel() for axes in grid[:, 0]] == ["Ashikhmin-Shirley", "GGX", "Lambert"] and all(axes.get_ylim()[0] == 0 and axes.get_xscale() == "log" for axes in grid.flat)
    assert [tick.get_text() for tick in grid[2, 0].get_xticklabels()] == ["10°", "20°", "40°"]
    lines = {line.get_label(): line.get_xydata().tolist() for line in grid[0, 2].lines}
    assert lines == {"hard": [[10, pytest.approx(.2)], [20, pytest.approx(.1)], [40, pytest.approx(.1)]], "valid_estevez": [[10, 0], [20, 0], [40, 0]]}
    assert np.allclose(grid[0, 1].lines[0].get_ydata(), [.1, .2, .2]) and [text.get_text() for text in figure.legends[0].get_texts()] == ["hard", "valid_estevez"]
    given = horizon.arguments([])
    assert (given.points, given.azimuths, given.output) == (64, 5, programs.BUILD / "compare/horizon")


@pytest.mark.parametrize("missed", [None, "colour_far", "width_far", "zoom", "zoom_back"])
def test_what_cloth_from_afar_prints_and_draws(monkeypatch, tmp_path, capsys, shown, missed):
    """Each of the four is judged by its own limit; the first cloth stands on top, strips grow from near to far, seen from above."""
    of = {"colour_far": .019, "colour_single": .3, "standard_error": .001, "width_far": .018, "width_single": .4, "zoom": .011, "zoom_back": .009}
    of.update({missed: .03} if missed else {})
    extents = np.array([.1, 1, 10])
    strips = []

    class Cloth:
        def __init__(self, name):
            self.name = name

        def shade(self, uv, extent, wi, wo, tier):
            strips.append((self.name, extent, tier))
            return np.repeat((uv[:, 1:] / extent / 120), 3, 1)
    monkeypatch.setattr(fabric, "Cloth", Cloth)
    monkeypatch.setattr(fabric, "colours", lambda cloth, points: (of["colour_far"], of["colour_single"], of["standard_error"]))
    monkeypatch.setattr(fabric, "widths", lambda cloth, points: (of["width_far"], of["width_single"]))
    monkeypatch.setattr(fabric, "zoom", lambda cloth, points: (extents, 1 + np.array([0, .005, .01]), of["zoom"], of["zoom_back"]))
    images = []
    monkeypatch.setattr(fabric.pictures, "write_png", lambda path, image: images.append(image))
    assert fabric.main(["denim", "silk_charmeuse", "--output", str(tmp_path)]) == (1 if missed else 0)
    said = [re.split(r"  +", line) for line in capsys.readouterr().out.splitlines()]
    assert said[1] == ["cloth, % of the near model's mean", "far", "one lobe", "std. error", "width far", "width one lobe", "zoom", "back"]
    assert said[3] == ["denim", *(f"{100 * value:.2f}" for value in of.values())] and said[4][0] == "silk_charmeuse"
    assert said[6] == [f"{'LIMITS MISSED' if missed else 'Within the limits'}: colour 2 %, width 2 %, zoom 1.2 %. Figures and chart: {tmp_path}"]
    assert (tmp_path / "fabric.csv").read_text().splitlines()[0] == "cloth,colour_far,colour_single,standard_error,width_far,width_single,zoom,zoom_back"
    assert (tmp_path / "zoom.csv").read_text().splitlines()[:2] == ["crossings,denim,silk_charmeuse", "0.1,1.0,1.0"]
    axes = shown[0][0].axes
    assert [title(one) for one in axes] == ["mean colour, worst of 20 pairs", "second moments of the highlight", "zooming out"]
    assert [one.get_xlabel() for one in axes] == ["error against the mean of near, % (dotted: limit)"] * 2 + ["crossings a pixel (grey: near gives way to far)"]
    assert axes[2].get_ylabel() == "change of the patch's mean, %" and axes[2].get_ylim() == pytest.approx((-1.2, 1.2)) and axes[2].get_xscale() == "log"
    assert [bar.get_width() for bar in axes[0].patches] == pytest.approx([100 * of["colour_far"]] * 2 + [30] * 2) and axes[0].get_xscale() == "log"
    assert [bar.get_width() for bar in axes[1].patches] == pytest.approx([100 * of["width_far"]] * 2 + [40] * 2) and axes[0].yaxis_inverted() and axes[0].lines[0].get_xdata()[0] == 2
    assert [tick.get_text() for tick in axes[0].get_yticklabels()] == ["denim", "silk charmeuse"] and [text.get_text() for text in axes[0].get_legend().get_texts()] == ["mixture", "one lobe"]
    assert [line.get_ydata().tolist() for line in axes[2].lines] == [pytest.approx([0, .5, 1])] * 2
    assert [text.get_text() for text in axes[2].get_legend().get_texts()] == ["denim", "silk charmeuse"]
    assert strips == [(name, extent, "auto") for name in ("denim", "silk_charmeuse") for extent in (.08, .2, .4, .7, 1, 1.4, 2, 3, 6)]
    assert images[0].shape == (2 * 124, 9 * 124, 3) and images[0][2, 10, 0] > images[0][100, 10, 0] > 0  # v upwards


# ---- speed.py


def test_how_fast_the_plate_is(monkeypatch, tmp_path, capsys):
    """Both engines by turns; how many times ours is as fast, and what goes to docs/results."""
    asked, written = [], []

    def step(words, command, log, environment):
        asked.append((words, json.loads((tmp_path / "jobs.json").read_text()), log, environment["LIBSHADE_TIMINGS"]))
        (tmp_path / "seconds.json").write_text(json.dumps({"blender": "5.0", "seconds": [[4.0, 3.0], [1.0, 0.5]]}))
        return "libshade: sync 1 s\nother\nlibshade: sync 2 s\nlibshade: sync 3 s\n"
    monkeypatch.setattr(speed.report, "step", step)
    monkeypatch.setattr(speed.programs, "blender", lambda *words: [str(word) for word in words])
    monkeypatch.setattr(speed.pictures, "write_float", lambda path, picture: written.append((path.name, picture.shape)))
    monkeypatch.setattr(speed.plate, "normal_map", lambda texels: np.zeros((texels // 512, texels // 512, 3)))
    monkeypatch.setattr(speed.results, "surroundings", lambda command: {"machine": "a machine", "compiler": "a compiler", "command": command})
    monkeypatch.setattr(speed.results, "write", lambda *words: written.append(words))
    assert speed.main(["--size", "100", "--samples", "50", "--repeat", "2", "--output", str(tmp_path)]) == 0
    (words, order, log, timings), = asked
    assert words == "Rendering the plate 2 times with each engine" and (log, timings) == (tmp_path / "blender.log", "1")
    assert order["normal_map"] == str(tmp_path / "normals.exr") and written == [("normals.exr", (4, 4, 3))]
    same = {"surface": "bumped", "size": 100, "samples": 50, "quads": 1, "repeat": 2, "output": ""}
    assert order["jobs"] == [{"engine": "CYCLES", **same}, {"engine": "LIBSHADE", "detail": "rotate", **same}]
    printed = capsys.readouterr().out
    assert "Blender 5.0, 100 x 100, 50 samples; a machine; a compiler" in printed
    assert [line.split() for line in printed.splitlines() if re.match("seconds|render|best|million", line)] == [
        ["seconds", "Cycles", "libshade", "ratio"], ["render", "1", "4.000", "1.000", "4.0"], ["render", "2", "3.000", "0.500", "6.0"],
        ["best", "3.000", "0.500", "6.0"], ["million", "samples/s", "0.2", "1.0"]]
    assert printed.endswith("Our stages, first and last render:\n  sync 1 s\n  sync 3 s\n")
    speed.main(["--results", "--output", str(tmp_path)])
    head, rows = written[-1][1], written[-1][3]
    assert written[-1][0] == "plate-time" and head["command"] == "make compare" and written[-1][2] == ["renderer", "seconds", "million samples a second"]
    assert rows == [["Cycles", 3.0, pytest.approx(512 * 512 * 64 / 3e6)], ["libshade", .5, pytest.approx(512 * 512 * 64 / .5e6)]]
    assert asked[-1][0] == "Rendering the plate 3 times with each engine"
    assert speed.arguments([]).output == programs.BUILD / "compare" / "speed"
