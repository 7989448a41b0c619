# SPDX-License-Identifier: Apache-2.0
"""check.py on pairs of dumps, good ones and then one broken part at a time."""
import contextlib
import io
import json
import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import synthetic
import test_judges as parts

import check
import dumps
import pictures
import programs
import report

COST = 2.4


def pair(folder, first=None, second=None, after=None, povray=True):
    """Two dumps of the same ball: a Blender's and, unless told otherwise, POV-Ray's. `first` and
    `second` change them before they are shaded, `after` the second's S."""
    files = []
    for name, change, left in (("a", first, False), ("b", second, povray)):
        dump = parts.Dump()
        if change:
            change(dump)
        dump.shade()
        if name == "b" and after:
            after(dump)
        planes = dump.planes
        if left:
            planes = {n[:-1] + {"Y": "Z", "Z": "Y"}.get(n[-1], n[-1]): p for n, p in planes.items()}
        header = {"version": "0", "renderer": "POV-Ray 3.7" if left else "Blender 3.4.1",
                  "materials": dump.materials}
        files.append(synthetic.write(folder / f"{name}.exr", planes, header))
    return files


def started(*arguments):
    """(status, what it prints, what it says on standard error) of the script, in this process, which has all that it imports."""
    said, wrong = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(wrong), pytest.raises(SystemExit) as end:
        report.run(lambda: check.main(list(map(str, arguments))))
    return end.value.code, said.getvalue(), wrong.getvalue()


def judged(files, *options):
    """(status, {first word of a row that is missed}, the whole verdict)."""
    status, text, wrong = started("--json", *options, *files)
    assert status in (0, 1) and text, wrong
    said = json.loads(text)
    assert said["agree"] == (status == 0) == (not said["missed"])
    return status, {row.split()[0] for row in said["missed"]}, said


def refused(*arguments):
    status, text, wrong = started(*arguments)
    assert not text, text + wrong
    return status, wrong


@pytest.mark.parametrize("povray", [True, False])
def test_good_pairs_agree(tmp_path, povray):
    status, missed, said = judged(pair(tmp_path, povray=povray), "--all")
    assert status == 0 and not missed
    measured = {row["what"] for row in said["rows"]}
    assert {"light1.S, mean difference over mean", "covered by one only"} <= measured


def test_the_order_does_not_matter(tmp_path):
    a, b = pair(tmp_path)
    assert judged([b, a])[0] == 0


def test_worlds_that_the_header_does_not_tell(tmp_path):
    files = pair(tmp_path)
    assert judged(files, "--world", "mirrored")[0] == 0
    status, missed, _ = judged(files, "--world", "same")
    assert status == 1 and {"N", "V", "light0.L"} <= missed


@pytest.mark.parametrize("change, row", [
    (parts.turn("V", 0.2), "V"), (parts.turn_tangent, "T"), (parts.turn("Ns", 0.4), "Ns"),
    (parts.shift("P.X", 6e-4), "P"), (parts.shift("uv.U", 1e-3), "uv"), (parts.cut, "covered"),
    (parts.scale("light1.E.G", 1.002), "light1.E"), (parts.turn("light0.L", 0.2), "light0.L"),
    (parts.swap_materials, "material"), (parts.setting(1, "ey", 12.1), "material"),
])
@pytest.mark.parametrize("which", ["first", "second"])
def test_what_the_other_dump_has_otherwise(tmp_path, which, change, row):
    """Each is shaded rightly for what it says, so that the reference passes both."""
    status, missed, _ = judged(pair(tmp_path, **{which: change}))
    assert status == 1 and row in missed and not missed & {"A", "B", "A:", "B:"}


@pytest.mark.parametrize("factor, missed", [(1.001, {"B"}), (1.03, {"B", "light0.S,"})])
def test_what_one_shades_otherwise(tmp_path, factor, missed):
    assert judged(pair(tmp_path, after=parts.scale("light0.S.R", factor)))[1] == missed


@pytest.mark.parametrize("light", [0, 1])
def test_each_light_is_compared(tmp_path, light):
    """Whatever the lights after it are."""
    first, second = map(dumps.read, pair(tmp_path, after=parts.scale(f"light{light}.S.R", 1.03), povray=False))
    assert check.shaded_rows(first, first)[1]
    assert not check.shaded_rows(first, second)[1]


def test_a_light_without_blue_is_compared(tmp_path):
    """What is dark in one channel is not dark."""
    first, second = map(dumps.read, pair(tmp_path, after=parts.scale("light1.S.R", 1.03), povray=False))
    for dump in (first, second):
        for light in dump.lights:
            light["S"][..., 2] = 0.0
    rows, good = check.shaded_rows(first, second)
    assert [row[3] for row in rows] == ["ok", "MISSED"] and not good


def test_what_has_no_row_of_its_own_is_said(tmp_path, monkeypatch, capsys):
    """As of cloth from afar: `shade check` judges its values apart from all others."""
    reference = check.against_reference
    monkeypatch.setattr(check, "against_reference", lambda path, *about: {
        **reference(path, *about), **({"pass": False} if path.name == "b.exr" else {})})
    both = [str(path) for path in pair(tmp_path)]
    assert check.main(["--json", *both]) == 1
    assert json.loads(capsys.readouterr().out)["missed"] == ["B: `shade check` does not pass it"]
    assert check.main(both) == 1
    said = capsys.readouterr().out
    assert re.search(r"^A a\.exr, B b\.exr +measured +limit +worst at$", said, re.M), said
    assert said.rstrip().endswith("Verdict: NOT within limits: B: `shade check` does not pass it.")


def test_what_is_no_number_is_said_with_its_place(tmp_path):
    status, missed, said = judged(pair(tmp_path, after=parts.nan))
    assert status == 1 and {"B:", "light0.S"} <= missed
    middle = f"({parts.SIZE // 2}, {parts.SIZE // 2})"
    assert {row["worst"] for row in said["rows"] if row["what"] == "light0.S not finite"} == {middle}


def test_the_worst_pixel(tmp_path):
    def move(dump):
        dump.planes["P.Z"][11, 17] += 0.5

    said = judged(pair(tmp_path, second=move, povray=False))[2]
    assert [row["worst"] for row in said["rows"] if row["what"].startswith("P equal")] == ["(17, 11)"]
    a, b = map(dumps.read, pair(tmp_path, povray=False))
    assert check.pair_rows(a, b)[0][0][-1] == ""
    row, column = np.argwhere(b.covered)[9]
    b.material[row, column] = -1
    assert check.pair_rows(a, b)[0][0][-1] == check.pair_rows(b, a)[0][0][-1] == f"({column}, {row})"


def test_how_two_are_shaded_and_shown(tmp_path, monkeypatch):
    """The pixel whose light is most off, also of light that is dark in one; side by side both, and ten times what they differ by."""
    a, b = map(dumps.read, pair(tmp_path, povray=False))
    b.lights[0]["S"][9, 14] += 0.125
    rows, good = check.shaded_rows(a, b)
    both = a.covered & b.covered
    off = 0.125 / both.sum() / b.lights[0]["S"][both].mean(axis=0)
    assert [row[0] for row in rows] == [f"light{k}.S, mean difference over mean" for k in (0, 1)] and rows[0][4] == "(14, 9)" and rows[1][1:] == ["0.000 %", "2 %", "ok", ""]
    assert 0 < float(rows[0][1].split()[0]) <= 100 * off.max() + 1e-3 and good == (float(rows[0][1].split()[0]) <= 2)
    for dump in (a, b):
        dump.lights[1]["S"][:] = 0
    assert check.shaded_rows(a, b)[0][1][1:4] == ["dark in both", "", "noted"]
    shown = []
    monkeypatch.setattr(check.pictures, "write_png", lambda path, picture: shown.append((path, picture)))
    check.write_picture("x.png", a, b)
    (path, strip), = shown
    ours, theirs = a.lights[0]["S"], b.lights[0]["S"]
    bright = np.percentile(ours[a.covered], 99)
    assert path == "x.png" and strip == pytest.approx(np.concatenate([ours, theirs, 10 * np.abs(theirs - ours)], 1) / bright)


@pytest.mark.parametrize("said, status, wanted", [
    ("b.exr: no dump", 1, "^b.exr: no dump$"), ("out of memory", 1, "^b.exr: out of memory$"), ("", 9, "^b.exr: `shade check` left with status 9$")])
def test_what_shade_check_says_instead(monkeypatch, said, status, wanted):
    monkeypatch.setattr(check.subprocess, "run", lambda *_words, **_more: SimpleNamespace(stdout="", stderr=said + "\n", returncode=status))
    with pytest.raises(report.StepFailed, match=wanted):
        check.against_reference("b.exr", "Blender", False)

    def none(*_words, **_more):
        raise FileNotFoundError(2, "No such file or directory")
    monkeypatch.setattr(check.subprocess, "run", none)
    with pytest.raises(report.StepFailed, match="shade: No such file or directory: run make, or name another `shade` by SHADE in the environment"):
        check.against_reference("b.exr", "Blender", False)


def test_material_that_nothing_shows_fails_with_all(tmp_path):
    files = pair(tmp_path, second=parts.unused_material)
    assert judged(files)[0] == 0
    assert judged(files, "--all")[:2] == (1, {"B:"})


def test_the_table_and_the_picture(tmp_path):
    files = pair(tmp_path, after=parts.scale("light1.S.B", 1.2))
    done = subprocess.run([sys.executable, programs.HERE / "check.py", *files, "--picture",
                           tmp_path / "strip.png"], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "Verdict: NOT within limits: B against reference" in done.stdout
    assert "A: Blender 3.4.1" in done.stdout and "B: POV-Ray 3.7" in done.stdout
    strip = pictures.read(tmp_path / "strip.png")
    assert strip.shape == (parts.SIZE, 3 * parts.SIZE, 3)
    difference = strip[:, 2 * parts.SIZE:]
    assert difference[..., 2].max() > 0.1 and difference[..., 0].max() == 0.0


def smaller(dump):
    for name in dump.planes:
        dump.planes[name] = dump.planes[name][: parts.SIZE // 2]


def nothing(dump):
    dump.planes["material.ID"][:] = -1


def elsewhere(dump):
    nothing(dump)
    dump.planes["material.ID"][0, 0] = 0  # a corner, which the ball leaves free


def third_light(dump):
    parts.dark_light(dump)
    dump.shade()


def half(dump):
    dump.planes["material.ID"][3, 3] = 0.5


@pytest.mark.parametrize("second, said", [
    (smaller, "b.exr: 32 x 16 pixels; expected 32 x 32, as in"),
    (third_light, "b.exr: 3 lights; expected 2, as in"),
    (nothing, "b.exr: nothing is hit; expected a material.ID of 0 or more"),
    (elsewhere, "b.exr: it covers no pixel that"),
    (half, "b.exr: material.ID holds what is no index; expected whole numbers"),
])
def test_dumps_that_are_no_pair(tmp_path, second, said):
    files = pair(tmp_path, povray=False)
    dump = parts.Dump()
    dump.shade()
    second(dump)
    synthetic.write(files[1], dump.planes, {"version": "0", "materials": dump.materials})
    status, words = refused(*files)
    assert status == 1 and said in words


def without(channel):
    return lambda planes, header: (
        {name: plane for name, plane in planes.items() if name != channel}, header)


@pytest.mark.parametrize("broken, said", [
    (without("Ns.Y"), "b.exr: channel Ns.Y is missing"),
    (without("light1.E.G"), "b.exr: channel light1.E.G is missing"),
    (without("material.ID"), "b.exr: channel material.ID is missing"),
    (lambda planes, header: (planes, None), "b.exr: not a dump (no attribute `libshade`)"),
    (lambda planes, header: (planes, [1]), "b.exr: the attribute `libshade` is not as expected"),
    (lambda planes, header: (planes, {"materials": [3]}), "is not as expected: an object, its"),
    (lambda planes, header: (planes, {"materials": [{"name": "no id"}]}), "a whole \"id\""),
    (lambda planes, header: (planes, {"materials": [{"id": 0}, {"id": 1}]}), "b.exr"),
])
def test_what_is_no_dump(tmp_path, broken, said):
    files = pair(tmp_path, povray=False)
    dump = parts.Dump()
    dump.shade()
    synthetic.write(files[1], *broken(dump.planes, {"materials": dump.materials}))
    status, words = refused(*files)
    assert status == 1 and said in words and "error:" in words


def test_files_that_are_none(tmp_path):
    files = pair(tmp_path)
    (tmp_path / "text.exr").write_text("not a picture", encoding="utf-8")
    whole = files[1].read_bytes()
    (tmp_path / "half.exr").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "head.exr").write_bytes(whole[:300])
    for name, said in (("text", "text.exr"), ("half", "half.exr: truncated or corrupt"), ("head", "head.exr")):
        status, words = refused(files[0], tmp_path / f"{name}.exr")
        assert status == 1 and said in words and words.count("\n") == 1
    status, words = refused(tmp_path / "none.exr", files[0])
    assert status == 1 and "none.exr" in words


def test_usage(tmp_path):
    for arguments in ([], ["one.exr"], ["a.exr", "b.exr", "c.exr"], ["--world", "flat", "a", "b"]):
        assert refused(*arguments)[0] == 2
    with pytest.raises(SystemExit) as left:
        check.main(["--help"])
    assert left.value.code == 0
