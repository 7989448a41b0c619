# SPDX-License-Identifier: Apache-2.0
"""Each judge's `main`, given good parts and then one bad part at a time: it must say so by its
status, name the part, and leave nothing that says "agreed"."""
import contextlib
import io
import json
import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import synthetic

import consistency
import dumps
import fabric
import pictures
import plate
import programs
import report
import shade
import slopes
import truth

COST = 6.8


# ---- consistency.py ---------------------------------------------------------------------------

SIZE = 32
EXPONENTS = ((9.0, 3.0), (2.0, 12.0))
F0 = ((0.9, 0.6, 0.3), (0.5, 0.7, 0.8))


def materials():
    """Their objects in a dump's header; the library lists the keys, the values are ours."""
    return [{**shade.Material(ex=ex, ey=ey).json(number, f"number {number}"), "detail": "none", "fresnel": "none",
             "horizon": "hard", "f0": list(f0)}
            for number, ((ex, ey), f0) in enumerate(zip(EXPONENTS, F0))]


class Dump:
    """What one renderer would write of a ball of two metals under two coloured lights."""

    def __init__(self):
        self.materials = materials()
        self.planes = synthetic.planes(SIZE)
        inside, left = self.planes["material.ID"] >= 0, self.planes["P.X"] < 0
        self.planes["material.ID"] = np.where(inside, np.where(left, 1.0, 0.0), -1.0)
        for c, value in zip("XYZ", (-0.48, 0.36, 0.8)):
            self.planes[f"light1.L.{c}"] = np.where(inside, value, 0.0)
        for c, value in zip("RGB", (2.0, 0.5, 1.0)):
            self.planes[f"light1.E.{c}"] = np.where(inside, value, 0.0)

    def vector(self, name, parts="XYZ"):
        # as the file will hold it
        return np.stack([self.planes[f"{name}.{c}"].astype(np.float32).astype(float)
                         for c in parts], -1)

    def shade(self):
        """S of every light, by the formula of docs/theory/conventions.md for unbumped Ashikhmin-Shirley."""
        n, t, wo = (self.vector(name) for name in ("N", "T", "V"))
        n, t, wo = (v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)
                    for v in (n, t, wo))
        t = t - (t * n).sum(-1, keepdims=True) * n
        t /= np.maximum(np.linalg.norm(t, axis=-1, keepdims=True), 1e-30)
        b = np.cross(n, t)
        which = self.planes["material.ID"].astype(int)
        ex, ey = (np.choose(np.maximum(which, 0), [m[k] for m in self.materials])
                  for k in ("ex", "ey"))
        f0 = np.array([m["f0"] for m in self.materials])[np.maximum(which, 0)]
        light = 0
        while f"light{light}.L.X" in self.planes:
            wi = self.vector(f"light{light}.L")
            h = wi + wo
            h /= np.maximum(np.linalg.norm(h, axis=-1, keepdims=True), 1e-30)
            hx, hy, hz = ((h * axis).sum(-1) for axis in (t, b, n))
            ni, no = ((w * n).sum(-1) for w in (wi, wo))
            e = (ex * hx**2 + ey * hy**2) / np.maximum(hx**2 + hy**2, 1e-30)
            d = np.sqrt((ex + 1) * (ey + 1)) / (2 * np.pi) * np.maximum(hz, 0) ** e
            lit = (which >= 0) & (ni > 0) & (no > 0)
            f = d / (4 * np.maximum((h * wo).sum(-1), 1e-9) * np.maximum(np.maximum(ni, no), 1e-9))
            s = np.where(lit, f * ni, 0)[..., None] * f0 * self.vector(f"light{light}.E", "RGB")
            for i, c in enumerate("RGB"):
                self.planes[f"light{light}.S.{c}"] = s[..., i]
            light += 1

    def write(self, path, left_handed):
        planes = self.planes
        if left_handed:  # POV-Ray's world: y and z trade places
            planes = {name[:-1] + {"Y": "Z", "Z": "Y"}.get(name[-1], name[-1]): plane
                      for name, plane in planes.items()}
        return synthetic.write(path, planes, {"version": "0", "materials": self.materials})


def scale(name, factor, where=lambda planes: True):
    def change(dump):
        p = dump.planes
        p[name] = np.where(where(p), factor * p[name], p[name])
    return change


def turn(name, degrees):
    """About an axis of the world that the direction is not parallel to."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))

    def change(dump):
        p = dump.planes
        y, z = p[f"{name}.Y"], p[f"{name}.Z"]
        p[f"{name}.Y"], p[f"{name}.Z"] = c * y - s * z, s * y + c * z
    return change


def turn_tangent(dump):
    n, t = dump.vector("N"), dump.vector("T")
    a = np.radians(1.0)
    t = np.cos(a) * t + np.sin(a) * np.cross(n, t)
    for i, c in enumerate("XYZ"):
        dump.planes[f"T.{c}"] = t[..., i]


def shift(name, by):
    def change(dump):
        dump.planes[name] = dump.planes[name] + by * (dump.planes["material.ID"] >= 0)
    return change


def cut(dump):
    """Leave out a corner: 1 to 5 % of what is covered."""
    x, y = dump.planes["P.X"], dump.planes["P.Y"]
    gone = (x + y < -1.15) & (dump.planes["material.ID"] >= 0)
    assert 0.01 < gone.sum() / (dump.planes["material.ID"] >= 0).sum() < 0.05
    for name in dump.planes:
        dump.planes[name] = np.where(gone, -1.0 if name == "material.ID" else 0.0,
                                     dump.planes[name])


def swap_materials(dump):
    p = dump.planes
    p["material.ID"] = np.where(p["material.ID"] >= 0, 1 - p["material.ID"], -1)


def setting(number, key, value):
    def change(dump):
        assert dump.materials[number][key] != value
        dump.materials[number][key] = value
    return change


def nan(dump):
    dump.planes["light0.S.B"][SIZE // 2, SIZE // 2] = np.nan


def renumber(dump):
    """Other numbers, order and names for the same materials."""
    for m in dump.materials:
        m["id"] = 1 - m["id"]
        m["name"] = "scene.inc:%d" % m["id"]
    dump.materials.reverse()
    swap_materials(dump)


def unused_material(dump):
    dump.materials.append({**dump.materials[0], "id": 2, "name": "unused"})


def dark_light(dump):
    for c in "XYZ":
        dump.planes[f"light2.L.{c}"] = dump.planes[f"light0.L.{c}"]
    for c in "RGB":
        dump.planes[f"light2.E.{c}"] = 0 * dump.planes["light0.E.R"]


def second_of(planes):
    return planes["material.ID"] == 1


def judge(monkeypatch, folder, blender=None, povray=None, after=None, picture=None, options=()):
    """main() where both renderers hand in these parts: what changes before S is shaded, in each;
    what changes (renderer, S); what changes POV-Ray's picture. Returns (status, rows missed)."""
    pair = {"blender": Dump(), "povray": Dump()}
    for name, change in (("blender", blender), ("povray", povray)):
        if change:
            change(pair[name])
        pair[name].shade()
        if after and after[0] == name:
            after[1](pair[name])
    image = np.random.default_rng(7).random((8, 12, 3))
    other = picture(image.copy()) if picture else image

    def render_blender(chosen):
        pair["blender"].write(chosen.output / "blender_dump.exr", False)
        pictures.write_float(chosen.output / "blender.exr", image)
        return 12, 8

    def dump_povray(chosen, width, height):
        assert (width, height) == (12, 8)
        pair["povray"].write(chosen.output / "povray_dump.exr", True)

    def render_povray(chosen, width, height):
        assert (width, height) == (12, 8)
        pictures.write_float(chosen.output / "povray.exr", other)

    monkeypatch.setattr(consistency, "render_blender", render_blender)
    monkeypatch.setattr(consistency, "export_povray", lambda _chosen: None)
    monkeypatch.setattr(consistency, "dump_povray", dump_povray)
    monkeypatch.setattr(consistency, "render_povray", render_povray)
    scene = folder / "scene.blend"
    scene.touch()
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(io.StringIO()):
        status = consistency.main([str(scene), "--output", str(folder / "out"), *options])
    text = (folder / "out" / "verdict.txt").read_text(encoding="utf-8")
    assert text in said.getvalue() and text.split("\n")[0].split() == ["scene.blend", "measured", "limit"]
    assert ("both renderers agree" in text) == (status == 0)
    assert ("NOT within limits" in text) == (status == 1)
    return status, [line for line in text.splitlines() if line.endswith("MISSED")]


def test_good_parts_agree(monkeypatch, tmp_path):
    assert judge(monkeypatch, tmp_path, options=["--all"]) == (0, [])


def test_files_of_others_stay_and_those_of_an_earlier_run_go(monkeypatch, tmp_path):
    (tmp_path / "out").mkdir()
    for name in ("mine.exr", "povray_centres.exr", "povray_dump.exr"):
        (tmp_path / "out" / name).write_bytes(b"before")
    assert judge(monkeypatch, tmp_path) == (0, [])
    assert (tmp_path / "out" / "mine.exr").read_bytes() == b"before"
    assert not (tmp_path / "out" / "povray_centres.exr").exists()


def test_renderers_may_number_materials_otherwise(monkeypatch, tmp_path):
    assert judge(monkeypatch, tmp_path, povray=renumber, options=["--all"]) == (0, [])


E_CASES = [(f"light{k}.E.{c}", who) for k, c, who in
           ((0, "R", "povray"), (0, "G", "blender"), (0, "B", "povray"),
            (1, "R", "blender"), (1, "G", "povray"), (1, "B", "blender"))]


# What both renderers shade rightly, each from its own, but not the same: only the comparison of
# the dumps can notice.
@pytest.mark.parametrize("who, change, missed", [
    *((who, scale(name, factor), [name[:8]]) for name, who in E_CASES for factor in (0.998, 1.002)),
    *(("povray", turn(f"light{k}.L", 0.2), [f"light{k}.L"]) for k in (0, 1)),
    ("blender", turn("light1.L", 0.2), ["light1.L"]),
    ("povray", turn("V", 0.2), ["V"]),
    ("blender", turn("V", -0.2), ["V"]),
    ("povray", turn("Ns", 0.4), ["Ns"]),
    ("blender", turn("Ns", -0.4), ["Ns"]),
    ("povray", turn_tangent, ["T"]),
    ("blender", turn_tangent, ["T"]),
    *((who, shift(f"P.{c}", 6e-4), ["P"]) for who, c in
      (("povray", "X"), ("blender", "Y"), ("povray", "Z"))),
    *((who, shift(f"uv.{c}", 1e-3), ["uv"]) for who, c in (("povray", "U"), ("blender", "V"))),
    ("povray", cut, ["covered"]),
    ("blender", cut, ["covered"]),
    ("povray", setting(0, "f0", [0.9, 0.61, 0.3]), ["material"]),
    ("blender", setting(1, "ey", 12.1), ["material"]),
    ("povray", setting(1, "diffuse", "fibre"), ["material"]),
    ("povray", swap_materials, ["material"]),
])
def test_one_part_of_a_dump(monkeypatch, tmp_path, who, change, missed):
    status, rows = judge(monkeypatch, tmp_path, options=["--all"], **{who: change})
    assert status == 1 and [row.split()[0] for row in rows] == missed


def test_a_turned_normal(monkeypatch, tmp_path):
    # the tangent must turn with it to stay orthogonal
    def tilt(dump):
        for name in ("N", "T"):
            turn(name, 0.3)(dump)

    status, rows = judge(monkeypatch, tmp_path, povray=tilt)
    assert status == 1 and [row.split()[0] for row in rows] == ["N", "T"]


# What one renderer shades otherwise than the reference; the other's dump and both pictures are good.
@pytest.mark.parametrize("who, title", [("blender", "Blender"), ("povray", "POV-Ray")])
@pytest.mark.parametrize("change, missed", [
    *((scale(f"light{k}.S.{c}", 1.001, second_of), ["largest", "mean"])
      for k, c in ((0, "R"), (0, "G"), (1, "G"), (1, "B"))),
    # within the largest error, but all of it: over the mean
    (scale("light1.S.R", 1 + 4.5e-5), ["mean"]),
    (nan, ["not finite"]),
])
def test_one_part_of_the_shading(monkeypatch, tmp_path, who, title, change, missed):
    status, rows = judge(monkeypatch, tmp_path, after=(who, change), options=["--all"])
    assert status == 1 and all(row.startswith(title) for row in rows)
    assert all(any(word in row for row in rows) for word in missed)


@pytest.mark.parametrize("who", ["blender", "povray"])
@pytest.mark.parametrize("change, said", [(unused_material, "materials"), (dark_light, "lights")])
def test_what_is_not_compared_fails_only_with_all(monkeypatch, tmp_path, who, change, said):
    # the dark light in both, or their number would differ
    parts = {"blender": change, "povray": change} if change is dark_light else {who: change}
    assert judge(monkeypatch, tmp_path, **parts) == (0, [])
    status, rows = judge(monkeypatch, tmp_path, options=["--all"], **parts)
    assert status == 1 and all(f"{said} with nothing to compare" in row for row in rows)
    assert len(rows) == len(parts)
    for name in parts:  # `shade check` was told to fail, too
        log = (tmp_path / "out" / f"{name}_dump_check.log").read_text(encoding="utf-8")
        assert json.loads(log)["pass"] is False


def test_a_light_that_one_dump_lacks(monkeypatch, tmp_path):
    with pytest.raises(ValueError, match="number of lights"):
        judge(monkeypatch, tmp_path, povray=dark_light)
    assert not (tmp_path / "out" / "verdict.txt").exists()


@pytest.mark.parametrize("channel", range(3))
@pytest.mark.parametrize("factor, status", [(0.97, 1), (1.03, 1), (1.01, 0)])
def test_one_channel_of_a_picture(monkeypatch, tmp_path, channel, factor, status):
    def tint(image):
        image[..., channel] *= factor
        return image

    got, rows = judge(monkeypatch, tmp_path, picture=tint)
    assert got == status and len(rows) == status
    assert all(row.startswith("pictures") for row in rows)


def test_a_verdict_does_not_outlive_its_run(monkeypatch, tmp_path):
    assert judge(monkeypatch, tmp_path)[0] == 0

    def fails(_):
        raise report.StepFailed("Blender is not here")

    monkeypatch.setattr(consistency, "render_blender", fails)
    monkeypatch.setattr(sys, "argv", ["consistency.py", str(tmp_path / "scene.blend"), "--output",
                                      str(tmp_path / "out")])
    with pytest.raises(SystemExit) as left:
        report.run(consistency.main)
    assert left.value.code == 1
    assert not (tmp_path / "out" / "verdict.txt").exists()
    assert not list((tmp_path / "out").glob("*.exr"))


@pytest.mark.parametrize("status", [0, 1])
def test_only_agreement_is_stamped(tmp_path, status):
    """`make demo` on a judge that leaves with this status; an old stamp is there already."""
    script = tmp_path / "judge"
    script.write_text(f'#!/bin/sh\necho "$@"\nexit {status}\n', encoding="utf-8")
    script.chmod(0o755)
    build = tmp_path / "build"
    (build / "demo").mkdir(parents=True)
    for name in ("ready", "povray", "shade", "demo/suzanne.blend"):
        (build / name).touch()
    stamp = build / "demo" / "agreed"
    stamp.touch()
    os.utime(stamp, (1, 1))
    rules = f"B := {build}\nBLENDER_READY := {build}/ready\nPOVRAY := {build}/povray\nL := libshade\n.PHONY: povray\n" \
            "include compare/compare.mk\n"
    done = subprocess.run(["make", "-s", "-f", "-", f"PY={script}", "-o", str(build / "povray"),
                           "-o", str(build / "demo/suzanne.blend"), str(stamp)],
                          input=rules, text=True, cwd=programs.ROOT, capture_output=True,
                          check=False)
    said = (build / "demo" / "table.txt").read_text(encoding="utf-8").split()
    assert (done.returncode == 0) == (status == 0), done.stdout + done.stderr
    assert stamp.exists() == (status == 0)
    assert said[0] == "compare/consistency.py" and "--all" in said


def test_parameters_are_compared_as_json():
    a = {"x": [1, 2.0], "word": "ggx", "fabric": {"kd": 0.5}}
    assert dumps.apart(a, json.loads(json.dumps(a))) == 0
    assert dumps.apart(a, {**a, "x": [1, 2.002]}) == pytest.approx(0.001, rel=1e-2)
    for other in ({**a, "word": "ward"}, {**a, "fabric": {}}, {**a, "x": [1]}, {**a, "y": 0},
                  {**a, "x": ["1", 2.0]}, None):
        assert dumps.apart(a, other) == dumps.apart(other, a) == np.inf
    assert dumps.apart({"kd": 0}, {"kd": -1e-3}) == 1


# ---- truth.py -----------------------------------------------------------------------------------

PIXELS = 64


def judge_truth(monkeypatch, folder, errors, surface="waves", where=None):
    """main() on pictures that are off by these errors, `rotate` at the pixels `where` only.
    Returns (status, what truth.json says)."""
    names = [*(truth.METHODS if surface == "waves" else truth.SCRATCH_METHODS), truth.CYCLES]
    errors = {**({truth.STOCK: 0.005} if surface == "waves" else {}), **errors}
    displaced = np.random.default_rng(3).random((PIXELS, PIXELS, 3)) + 0.5
    images = {"displaced": displaced}
    for name in {*names, *errors}:
        off = errors.get(name, 0.3) * displaced.mean()
        sign = np.where(np.indices((PIXELS, PIXELS)).sum(0) % 2, 1, -1)[..., None]
        images[name] = displaced + off * sign * (
            where[..., None] if name == "rotate" and where is not None else 1)
    monkeypatch.setattr(truth, "render", lambda options: images)
    for name in ("write_strip", "write_chart"):
        monkeypatch.setattr(truth, name, lambda *_: None)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        status = truth.main(["--output", str(folder), "--surface", surface, "--size", str(PIXELS)])
    result = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    assert result["ok"] == (status == 0) == ("MISSED" not in said.getvalue())
    return status, result


@pytest.mark.parametrize("errors, status", [
    ({"rotate": 0.015}, 0),
    ({"rotate": 0.019}, 0),
    ({"rotate": 0.021}, 1),  # over the limit, though the best
    ({"rotate": 0.019, "perturb": 0.018}, 1),  # within it, but not the best
    ({"rotate": 0.019, truth.CYCLES: 0.018}, 1),
    ({"rotate": 0.5}, 1),
    ({"rotate": 0.015, truth.STOCK: 0.009}, 0),
    ({"rotate": 0.015, truth.STOCK: 0.011}, 1),
])
def test_truth(monkeypatch, tmp_path, errors, status):
    got, result = judge_truth(monkeypatch, tmp_path, errors)
    assert got == status and result["compared"] == 1
    for name, error in errors.items():
        assert result["errors"][name] == pytest.approx(error, rel=1e-3)


def judge_skies(monkeypatch, folder, *skies):
    """main() under skies with these (rotate, stock, Cycles) errors of 4 x 4 blocks; (status, truth.json)."""
    blocks = np.where(np.indices((PIXELS // 4, PIXELS // 4)).sum(0) % 2, 1, -1)
    chequer = np.kron(blocks, np.ones((4, 4)))[..., None]
    single = np.where(np.indices((PIXELS, PIXELS)).sum(0) % 2, 1, -1)[..., None]
    plain = np.random.default_rng(3).random((PIXELS // 4, PIXELS // 4, 3)) + 0.5
    picture = np.kron(plain, np.ones((4, 4, 1)))
    mean = picture.mean()
    made = {f"sky {k}": {"displaced": picture + 0.002 * mean * chequer, truth.AGAIN: picture - 0.002 * mean * chequer,
                         "rotate": picture + rotate * mean * chequer + 0.3 * mean * single,
                         truth.STOCK: picture - stock * mean * chequer,
                         truth.CYCLES: picture + cycles * mean * chequer}
            for k, (rotate, stock, cycles) in enumerate(skies)}
    monkeypatch.setattr(truth, "render_skies", lambda options: made)
    for name in ("write_strip", "write_chart"):
        monkeypatch.setattr(truth, name, lambda *_: None)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        status = truth.main(["--output", str(folder), "--light", "sky", "--size", str(PIXELS)])
    result = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    assert result["ok"] == (status == 0) == ("MISSED" not in said.getvalue())
    assert result["wanted"] == ("not reached" not in said.getvalue())
    return status, result


@pytest.mark.parametrize("rotate, stock, cycles, status, wanted", [
    (0.03, 0.032, 0.1, 0, True),
    (0.03, 0.035, 0.1, 0, False),
    (0.06, 0.08, 0.1, 0, False),
    (0.11, 0.08, 0.1, 1, False),
    (0.06, 0.11, 0.1, 1, False),
])
def test_truth_under_a_sky(monkeypatch, tmp_path, rotate, stock, cycles, status, wanted):
    got, result = judge_skies(monkeypatch, tmp_path, (rotate, stock, cycles))
    assert got == status and result["wanted"] == wanted
    one = result["skies"]["sky 0"]
    assert one["rotate"] == pytest.approx(rotate, rel=1e-3)  # what is within a block does not count
    assert one[truth.STOCK] == pytest.approx(stock, rel=1e-3)
    assert one[truth.NOISE] == pytest.approx(0.002, rel=1e-3)


def test_truth_under_skies_goes_by_the_median(monkeypatch, tmp_path):
    good, fair, bad = (0.03, 0.03, 0.1), (0.05, 0.05, 0.1), (0.12, 0.05, 0.1)
    assert judge_skies(monkeypatch, tmp_path, good, good, fair)[1]["wanted"]
    assert not judge_skies(monkeypatch, tmp_path, good, fair, fair)[1]["wanted"]
    status, result = judge_skies(monkeypatch, tmp_path, good, good, bad)
    assert status == 0 and result["wanted"]
    assert result["beside_cycles"]["rotate"] == pytest.approx(0.3, rel=1e-3)
    status, result = judge_skies(monkeypatch, tmp_path, good, bad, bad)
    assert status == 1 and not result["wanted"]


def test_what_horizons_leave_dark_and_how_bright_they_are(monkeypatch, tmp_path):
    """Dark is below a twentieth of the truth's mean, not of the method's own; brightness is the mean over the truth's; both are means over the skies."""
    flat = lambda value, black=0: np.concatenate([np.zeros((black, PIXELS, 3)), np.full((PIXELS - black, PIXELS, 3), value)])  # noqa: E731
    quarter = PIXELS // 4
    sky = {"displaced": flat(1.0), truth.AGAIN: flat(1.0), "hard": flat(0.04), truth.BEFORE: flat(0.5, quarter), "schuessler": flat(1.5), "mutual": flat(0.9), truth.CYCLES: flat(0.06, 2 * quarter)}
    other = {**sky, "hard": flat(0.06), truth.BEFORE: flat(0.5, 3 * quarter), "mutual": flat(0.7)}
    monkeypatch.setattr(truth, "render_skies", lambda options: {"one": sky, "other": other})
    monkeypatch.setattr(truth, "write_strip", lambda *_: None)
    with contextlib.redirect_stdout(io.StringIO()):
        truth.main(["--output", str(tmp_path), "--light", "sky", "--surface", "letter", "--size", str(PIXELS)])
    result = json.loads((tmp_path / "truth.json").read_text(encoding="utf-8"))
    assert result["dark"] == pytest.approx({"displaced": 0, "hard": 0.5, truth.BEFORE: 0.5, "schuessler": 0, "mutual": 0, truth.CYCLES: 0.5})
    assert result["brightness"] == pytest.approx({"hard": 0.05, truth.BEFORE: 0.25, "schuessler": 1.5, "mutual": 0.8, truth.CYCLES: 0.03})


def test_what_depends_on_the_normal_alone():
    """Nothing is left of such a picture; of one that tells peaks from pits, all that it tells."""
    size = 64
    by_normal = plate.normals(*plate.grid(size))[::-1] + 2.0
    assert truth.of_the_normal_alone(by_normal) == pytest.approx(by_normal, abs=1e-12)
    u, v = plate.grid(size)
    curved = np.sign(plate.height(u, v))[::-1, :, None]  # as many up as down, wherever slopes are the same
    nearest = truth.of_the_normal_alone(by_normal + 0.1 * curved)
    assert np.abs(nearest - by_normal - 0.1 * curved).mean() == pytest.approx(0.1, rel=0.02)


@pytest.mark.parametrize("words, size, folder", [([], 512, "truth"), (["--light", "sky"], 256, "truth-sky"), (["--surface", "scratches"], 512, "truth-scratches"),
                                                 (["--light", "sky", "--size", "64"], 64, "truth-sky")])
def test_truth_s_defaults(words, size, folder):
    """As --help says them."""
    options = truth.arguments(words)
    assert (options.size, options.output.name, options.samples, options.quads, options.map) == (size, folder, 256, 800, 2048)


@pytest.mark.parametrize("words", [["--light", "sky", "--size", "40"], ["--sky", __file__],
                                   ["--light", "sky", "--sky", "gone.exr"],
                                   ["--light", "sky", "--surface", "scratches"]])
def test_truth_under_no_sky_is_refused(words):
    with pytest.raises(SystemExit) as end, contextlib.redirect_stderr(io.StringIO()):
        truth.arguments(words)
    assert end.value.code == 2


@pytest.mark.parametrize("errors, status", [
    ({"rotate": 0.015}, 0), ({"rotate": 0.021}, 1),
    ({"rotate": 0.019, "deform_smooth": 0.018}, 1)])
def test_truth_of_scratches(monkeypatch, tmp_path, errors, status):
    flat = np.broadcast_to([0.5, 0.5, 1.0], (256, 256, 3))
    pictures.write_float(tmp_path / "normals.exr", flat)
    assert judge_truth(monkeypatch, tmp_path, errors, "scratches")[0] == status


def test_creases_do_not_count_and_all_else_does(monkeypatch, tmp_path):
    slope = np.zeros((256, 256))
    slope[:, 128:] = 0.5
    n = np.stack([-slope, 0 * slope, 1 + 0 * slope], -1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    pictures.write_float(tmp_path / "normals.exr", 0.5 + 0.5 * n)
    column = np.arange(PIXELS)
    crease = np.minimum(np.abs(column - 31.5), np.minimum(column, 63 - column)) < 1
    on_crease = np.broadcast_to(crease, (PIXELS, PIXELS)).astype(float)
    status, result = judge_truth(monkeypatch, tmp_path, {"rotate": 0.3}, "scratches", on_crease)
    assert status == 0 and result["errors"]["rotate"] == 0 and 0.8 < result["compared"] < 0.9
    status, result = judge_truth(monkeypatch, tmp_path, {"rotate": 0.3}, "scratches", 1 - on_crease)
    assert status == 1 and result["errors"]["rotate"] == pytest.approx(0.3, rel=0.05)
    # with no creases those same pixels count
    pictures.write_float(tmp_path / "normals.exr", np.broadcast_to([0.5, 0.5, 1.0], (256, 256, 3)))
    assert judge_truth(monkeypatch, tmp_path, {"rotate": 0.5}, "scratches", on_crease)[0] == 1


def test_truth_of_nothing_is_refused(monkeypatch, tmp_path):
    """A normal map that is all creases leaves no pixel to compare."""
    slope = np.where(np.arange(256) % 2, 0.5, -0.5) * np.ones((256, 1))
    n = np.stack([-slope, 0 * slope, 1 + 0 * slope], -1)
    pictures.write_float(tmp_path / "normals.exr",
                         0.5 + 0.5 * n / np.linalg.norm(n, axis=-1, keepdims=True))
    with pytest.raises(ValueError, match="no pixel"):
        judge_truth(monkeypatch, tmp_path, {"rotate": 0.01}, "scratches")


# ---- slopes.py ----------------------------------------------------------------------------------

def slope_row(name, mdf, lobes, **changes):
    return {"map": name, "distribution": mdf, "footprint": 8, "lobes": lobes, "colour": 0.01,
            "worst": 0.01, "bias": 0.0, "moments": 0.02, "patches": 0.02, **changes}


def judge_slopes(monkeypatch, folder, bad):
    """main() on good figures but for bad[map, distribution, lobes]."""
    def compare_map(name, _normals):
        # the bad row first, in the midst and last among its like
        return [slope_row(name, mdf, lobes, footprint=f, **(bad.get((name, mdf, lobes), {})
                                                             if f == 8 else {}))
                for mdf in slopes.LOBES for lobes in slopes.LOBE_COUNTS for f in (2, 8, 64)]

    monkeypatch.setattr(slopes, "compare_map", compare_map)
    for name in ("gaussian_map", "ripple_map", "scratch_map", "write_chart"):
        monkeypatch.setattr(slopes, name, lambda *_, **__: None)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        status = slopes.main(["--output", str(folder)])
    return status, [line for line in said.getvalue().splitlines() if "MISSED" in line]


MAPS = ("waves 0.05, 0.10", "waves 0.15, 0.10", slopes.RIPPLES, "scratches")


def test_good_slopes(monkeypatch, tmp_path):
    # fewer lobes than are judged may be off, ripples too
    bad = {(name, mdf, lobes): {"colour": 0.2} for name in MAPS for mdf in slopes.LOBES
           for lobes in slopes.LOBE_COUNTS if lobes != 6 or name == slopes.RIPPLES}
    assert judge_slopes(monkeypatch, tmp_path, bad) == (0, [])
    lines = (tmp_path / "slopes.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + 3 * len(MAPS) * len(slopes.LOBES) * len(slopes.LOBE_COUNTS)


@pytest.mark.parametrize("name", MAPS)
@pytest.mark.parametrize("mdf", ["ashikhmin_shirley", "beckmann", "ward", "ggx"])
@pytest.mark.parametrize("changes", [{"colour": 0.031}, {"moments": 0.101}, {"colour": np.nan},
                                     {"moments": np.nan}])
def test_one_bad_slope(monkeypatch, tmp_path, name, mdf, changes):
    status, missed = judge_slopes(monkeypatch, tmp_path, {(name, mdf, 6): changes})
    if name == slopes.RIPPLES and "colour" in changes:
        assert (status, missed) == (0, [])
    else:
        assert status == 1 and len(missed) == 1
        assert missed[0].startswith(name) and mdf in missed[0]


def test_maps_are_as_steep_as_they_are_told():
    """Along y what is common to both adds to it: by 1 + .4^2."""
    for made, times in ((slopes.gaussian_map(0.1, 0.02, 1), np.sqrt(1.16)), (slopes.ripple_map(0.1, 0.02), 1.0)):
        sigma = (made[..., :2] / made[..., 2:]).std((0, 1))
        assert sigma == pytest.approx([0.1, 0.02 * times], rel=0.05)


def test_slopes_measure_what_they_say(monkeypatch):
    """Figures of a look-up that is right, and of ones that are off by so much."""
    monkeypatch.setattr(slopes, "SIZE", 64)
    normals = slopes.gaussian_map(0.1, 0.1, 1)
    over = slopes.supersampled(normals)
    monkeypatch.setattr(slopes, "FOOTPRINTS", (32,))
    monkeypatch.setattr(slopes, "LOBE_COUNTS", (6,))
    monkeypatch.setattr(slopes, "LOBES", {"ward": slopes.LOBES["ward"]})
    change = SimpleNamespace(weight=1.0, moments=np.ones(3))

    def look_up(_path, footprint, _mdf, _options, lobes):
        n = slopes.SIZE // footprint
        blocks = over.reshape(n, 2 * footprint, n, 2 * footprint, 2).swapaxes(1, 2)
        blocks = blocks.reshape(n * n, -1, 2)
        mean = blocks.mean(1)
        products = (blocks[..., [0, 0, 1]] * blocks[..., [0, 1, 1]]).mean(1) * change.moments
        out = np.zeros((n * n, 9 + 4 * lobes))
        out[:, :3] = slopes.from_slopes(mean)
        out[:, 3:6] = products - mean[:, [0, 0, 1]] * mean[:, [0, 1, 1]]
        out[:, 6:9] = (0.18, 0.36, 0)
        out[:, 9::4] = change.weight / lobes
        for k in range(lobes):  # every 6th point of the patch: not exact, near enough
            out[:, 10 + 4 * k:13 + 4 * k] = slopes.from_slopes(blocks[:, 300 + 611 * k])
        return out

    monkeypatch.setattr(slopes, "look_up", look_up)
    row, = slopes.compare_map("m", normals)
    good = row["colour"]
    assert good < 0.15 and row["moments"] < 1e-6 and row["patches"] < 1e-6
    change.weight = 1.5
    row, = slopes.compare_map("m", normals)
    assert row["colour"] == pytest.approx(0.5, abs=2 * good)
    assert row["bias"] == pytest.approx(0.5, abs=2 * good)
    for part, moments in ((0, [1.2, 1, 1]), (2, [1, 1, 1.2])):
        change.weight, change.moments = 1.0, np.array(moments)
        row, = slopes.compare_map("m", normals)
        size = (over**2).mean((0, 1))
        assert row["moments"] == pytest.approx(0.2 * size[part // 2] / size.sum(), rel=1e-6)


# ---- fabric.py ----------------------------------------------------------------------------------

GOOD_CLOTH = {"far": 0.01, "single": 0.3, "doubt": 0.005, "width_far": 0.01, "width_single": 0.3,
              "zoom": 0.008, "back": 0.005}


def judge_fabric(monkeypatch, folder, bad, which="second"):
    def value(cloth, key):
        return bad.get(key, GOOD_CLOTH[key]) if cloth.name == which else GOOD_CLOTH[key]

    def pick(*keys):
        return lambda cloth, _points: tuple(value(cloth, key) for key in keys)

    monkeypatch.setattr(fabric, "Cloth",
                        lambda name: SimpleNamespace(name=name))
    monkeypatch.setattr(fabric, "colours", pick("far", "single", "doubt"))
    monkeypatch.setattr(fabric, "widths", pick("width_far", "width_single"))
    monkeypatch.setattr(fabric, "zoom", lambda cloth, points: (
        np.ones(3), np.ones(3), *pick("zoom", "back")(cloth, points)))
    for name in ("write_chart", "write_strip"):
        monkeypatch.setattr(fabric, name, lambda *_: None)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        status = fabric.main(["first", "second", "third", "--output", str(folder)])
    assert ("Within the limits" in said.getvalue()) == (status == 0)
    assert ("LIMITS MISSED" in said.getvalue()) == (status == 1)
    return status


def test_good_cloth(monkeypatch, tmp_path):
    assert judge_fabric(monkeypatch, tmp_path, {}) == 0
    # only measured: the cheaper tier
    assert judge_fabric(monkeypatch, tmp_path, {"single": 3.0, "width_single": 3.0}) == 0


@pytest.mark.parametrize("which", ["first", "second", "third"])
@pytest.mark.parametrize("key, value", [("far", 0.0201), ("width_far", 0.0201), ("zoom", 0.0121),
                                        ("back", 0.0101), ("far", np.nan), ("width_far", np.nan),
                                        ("zoom", np.nan), ("back", np.nan)])
def test_one_bad_figure_of_cloth(monkeypatch, tmp_path, which, key, value):
    assert judge_fabric(monkeypatch, tmp_path, {key: value}, which) == 1


class Stuff:
    """A cloth by formula: what `shade` gives for a tier can be spoilt."""

    def __init__(self, **spoilt):
        self.spoilt = spoilt

    def shade(self, uv, extent, wi, wo, tier):
        wi = np.broadcast_to(wi, (len(uv), 3))
        h = wi + wo
        h = h / np.linalg.norm(h, axis=-1, keepdims=True)
        lobe = np.exp(-(h[:, 0] ** 2 / 0.02 + h[:, 1] ** 2 / 0.05))
        rgb = lobe[:, None] * [0.9, 0.6, 0.3] + [0.1, 0.2, 0.3]
        if tier == fabric.AUTO:
            tier = fabric.FAR if extent > 1 else fabric.NEAR
        change = self.spoilt.get({fabric.NEAR: "near", fabric.FAR: "far",
                                  fabric.SINGLE: "single"}[tier])
        return rgb if change is None else change(rgb, wi, extent)


def tint(channel, factor):
    def change(rgb, _wi, _extent):
        rgb[:, channel] *= factor
        return rgb
    return change


@pytest.mark.parametrize("channel", range(3))
@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_cloth_is_measured_channel_by_channel(channel, factor):
    far, single, doubt = fabric.colours(Stuff(far=tint(channel, factor)), 64)
    assert far == pytest.approx(0.1) and single == pytest.approx(0, abs=1e-12)
    assert doubt == pytest.approx(0, abs=1e-9)
    far, single, _ = fabric.colours(Stuff(single=tint(channel, factor)), 64)
    assert single == pytest.approx(0.1) and far == pytest.approx(0, abs=1e-12)
    _, _, off, back = fabric.zoom(Stuff(far=tint(channel, factor)), 64)
    assert off == pytest.approx(0.1) and back == pytest.approx(0, abs=1e-12)


def test_cloth_is_measured_at_every_pair():
    def one_pair(rgb, wi, _extent):
        light = fabric.direction(*fabric.LIGHTS[3])
        return rgb * np.where(np.allclose(wi, light), 1.25, 1.0)

    assert fabric.colours(Stuff(far=one_pair), 64)[0] == pytest.approx(0.25)

    def broken(rgb, wi, extent):
        return one_pair(rgb, wi, extent) * np.where(np.allclose(
            wi, fabric.direction(*fabric.LIGHTS[1])), np.nan, 1)

    assert np.isnan(fabric.colours(Stuff(far=broken), 64)[0])


def test_moments_weigh_by_what_shines():
    """Light from h over h_z: 3 of it here for 1 there is a mean of 3/4 and 1/4, whatever the brightness."""
    h = np.array([[0.6, 0, 0.8], [0, 0.6, 0.8]])
    colour = np.array([[3.0, 1.0, 0.0], [1.0, 1.0, 2.0]])
    assert fabric.moments(h, 7 * colour) == pytest.approx(0.36 * np.array([[0.75, 0.5, 0], [0.25, 0.5, 1]]))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("channel", range(3))
def test_cloth_s_width_is_measured_along_and_across(axis, channel):
    def wider(rgb, wi, _extent):
        h = wi + [0, 0, 1.0]
        h /= np.linalg.norm(h, axis=-1, keepdims=True)
        rgb[:, channel] *= 1 + 3 * h[:, axis] ** 2
        return rgb

    far, single = fabric.widths(Stuff(far=wider), 4096)
    assert far > 0.02 and single == pytest.approx(0, abs=1e-12)
    far, single = fabric.widths(Stuff(single=wider), 4096)
    assert single > 0.02 and far == pytest.approx(0, abs=1e-12)


def test_a_zoom_that_turns_back_is_measured():
    def wave(rgb, _wi, extent):
        return rgb * (1 + 0.03 * np.exp(-np.log(extent / 5) ** 2) + 0.01 * (extent > 5))

    _, means, off, back = fabric.zoom(Stuff(far=wave), 64)
    assert off == pytest.approx(np.abs(means - 1).max()) and 0.03 < off < 0.045
    assert 0.02 < back < 0.04
