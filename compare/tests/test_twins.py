# SPDX-License-Identifier: Apache-2.0
"""The twin of a scene has POV-Ray's own words where the block stood, and nothing else changed."""
import csv
import sys

import pytest

import twins

COST = 0.15


def test_twin_replaces_blocks_alone():
    text = ('#ifndef (mdf_Version)\n  #error "x"\n#end\nsphere { 0, 1 finish { ambient 0 diffuse 0 mdf { ggx .1, .3 reflection { samples 2 } } } }\n'
            "box { 0, 1 finish { ambient 0 mdf { specular .5 } irid { .2 } } }\nplane { y, 0 finish { diffuse .6 } }\n")
    stock = f"sphere {{ 0, 1 finish {{ ambient 0 {twins.STOCK} }} }}\nbox {{ 0, 1 finish {{ ambient 0 {twins.STOCK} irid {{ .2 }} }} }}\nplane {{ y, 0 finish {{ diffuse .6 }} }}\n"
    assert twins.twin(text) == stock


def test_twin_of_a_broken_scene_is_refused():
    with pytest.raises(ValueError):
        twins.twin("sphere { finish { mdf { ggx .1, .1 ")


def test_primitives_are_all_named():
    text = (twins.ROOT / "compare/twins/primitives.pov").read_text()
    assert text.count("#case") == len(twins.SHAPES) and "mdf" not in twins.twin(text)


def test_the_two_take_turns(tmp_path, monkeypatch, capsys):
    """Of known times: the median of the pairs' ratios, the least and the most, and the least times of each."""
    asked, times = [], {"block": iter([6, 3, 4, 5] * 99), "stock": iter([2, 2, 2, 1] * 99)}

    def seconds(povray, scene, options):
        side = scene.stem.rpartition("-")[2]
        assert povray == sys.executable and (twins.STOCK in scene.read_text()) == (side == "stock")
        asked.append((scene.stem.rpartition("-")[0], side, options))
        return next(times[side])
    monkeypatch.setattr(twins, "seconds", seconds)
    monkeypatch.setattr(sys, "argv", ["twins.py", sys.executable, "--pairs", "4", "--only", "or", "-o", str(tmp_path / "out.csv")])
    twins.main()
    assert capsys.readouterr().out.splitlines() == ["torus      2.500  (1.500 to 5.000)  3.00 s, 1.00 s", "sor        2.500  (1.500 to 5.000)  3.00 s, 1.00 s"]
    assert [row["ratio"] for row in csv.DictReader((tmp_path / "out.csv").open())] == ["2.500"] * 2
    assert [side for name, side, _ in asked if name == "sor"] == ["block", "stock", "stock", "block"] * 2
    assert asked[0][2] == ["Declare=Shape=1", "+W2400", "+H1200"] and asked[-1][2][0] == "Declare=Shape=7"
    monkeypatch.setattr(sys, "argv", ["twins.py", sys.executable, "--pairs", "1", "--only", "metals"])
    twins.main()
    assert asked[-1][0] == "metals" and asked[-1][2] == ["+W1600", "+H800"]


@pytest.mark.parametrize("words, said", [(["--pairs", "0", sys.executable], "--pairs must be 1 or more"), (["/none/povray"], "/none/povray: no such program"),
                                         ([sys.executable, "--only", "tree"], "twins.py: no scene has 'tree' in its name")])
def test_what_cannot_be_measured(words, said, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["twins.py", *words])
    with pytest.raises(SystemExit) as end:
        twins.main()
    assert said in f"{end.value.code}{capsys.readouterr().err}" and end.value.code != 0


def test_seconds_are_those_of_the_renderer(tmp_path):
    """User and system time of it and its options; a scene that fails is said."""
    povray = tmp_path / "povray"
    povray.write_text(f"#!/bin/sh\necho $* >{tmp_path}/asked\nexec {sys.executable} -c 'while __import__(\"time\").process_time() < .1: pass'\n")
    povray.chmod(0o755)
    assert 0.09 < twins.seconds(povray, tmp_path / "a.pov", ["+W8"]) < 5
    assert (tmp_path / "asked").read_text().split() == [f"+I{tmp_path}/a.pov", "-V", "-D", "-F", "-P", "+WT1", "-GA", "+W8"]
    povray.write_text("#!/bin/sh\necho no light >&2\nexit 3\n")
    with pytest.raises(SystemExit, match=r"twins.py: .*a.pov \+W8 failed:\nno light"):
        twins.seconds(povray, tmp_path / "a.pov", ["+W8"])
