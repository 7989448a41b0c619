# SPDX-License-Identifier: Apache-2.0
"""Examples as both renderers show them: what povray_common.py leaves of a text, and small pairs in the renderers."""
import re

import pytest

import dumps
import povray_common
import study_consistency as study

COST = 16

EXAMPLES = {path.stem: path for path in study.POVRAY}


@pytest.mark.parametrize("name", EXAMPLES)
def test_what_both_show_of_a_text(name):
    """Lamps are sharp and each example has one; nothing lights but them; all that was there is said."""
    said = EXAMPLES[name].read_text(encoding="utf-8")
    text, left = povray_common.common(name, said)
    assert text.count("{") == text.count("}")
    lamps = re.findall(r"light_source {([^{}]*)}", text)
    assert lamps and all("parallel" in lamp or "fade_distance" in lamp for lamp in lamps)
    for word, what in (("area_light", "lamps with a size"), ("sky_sphere", "the sky"), (r"normal\s*{", "patterns of normals"),
                       ("radiosity", "radiosity")):
        assert not re.search(rf"\b{word}", text)
        assert bool(re.search(rf"\b{word}", re.sub("//.*", "", said))) == any(what in words for words in left)
    names = [re.match(r"#declare (\w+) = finish", line) for line in text.splitlines() if re.search(r"\bemission\b", line)]
    assert all(names) and not any(re.search(rf"finish {{ {found[1]}\b", text) for found in names)  # told of, and used by none
    assert len(set(left)) == len(left)
    # three suns stand for a sky, but where they would shine through a wall or glitter
    suns = 3 if name not in ("presets", "embossed") and re.search(r"\bsky_sphere", re.sub("//.*", "", said)) else 0
    places = ["<1.9, 3.6, 9>", "<6, 5, -6>", "<-9, 4, 1>"]
    assert sum(place in lamp for lamp in lamps for place in places) == suns
    assert sum("three suns" in what for what in left) == (suns > 0)


def test_a_changed_example_is_an_error():
    said = EXAMPLES["metals"].read_text(encoding="utf-8")
    with pytest.raises(povray_common.Changed, match="metals.pov has no"):
        povray_common.common("metals", said.replace("pigment { rgb 0.18 }", "pigment { rgb 0.2 }"))


def test_plain_finishes_keep_what_they_reflect():
    """What is matt in POV-Ray's words reflects pigment times diffuse; a matt block says it at once. The ground keeps the part that lies before the camera."""
    seen = 0
    for name, (_left, edits) in povray_common.EDITS.items():
        for old, new in edits:
            found = re.search(r"pigment { rgb <?([^{}>]*)>? }\s+finish { ambient 0 diffuse ([\d.]+) }", old)
            if found:
                seen += 1
                reflected = re.search(r"diffuse lambert rgb <?([\d., ]*)", new)[1].split(",")
                assert [float(x) for x in reflected] == pytest.approx([float(x) * float(found[2]) for x in found[1].split(",")], abs=0.003), name
            clipped = re.search(r"box { <(-?\d+), -1, (-?\d+)>, <(\d+), 1, (\d+)> }", new)
            if clipped:
                left, near, right, far = map(int, clipped.groups())
                assert left == -right and right in (40, 60) and near in (-12, -8, -7) and far in (8, 40), name
    assert seen == 3


def test_blocks_go_whole():
    text = "a { b { c } } sky { p { q { r } } } skyline { } sky{ x }"
    assert povray_common.without(text, r"\bsky") == ("a { b { c } }  skyline { } ", 2)
    assert povray_common.without(text, r"\bsky", lambda block: "x" in block) == ("a { b { c } }  skyline { } sky{ x }", 1)
    with pytest.raises(povray_common.Changed):
        povray_common.without("sky { ", r"\bsky")


def test_what_takes_the_place_of_light_that_has_none():
    """Suns for a sky, a lamp for what shines; a lamp that fades stays a point; what was taken out is said."""
    text, left = povray_common.common("metals", """#version 3.7; // a comment with area_light
global_settings { assumed_gamma 1 radiosity { count 1 } max_trace_level 9 }
background { rgb 1 }
sky_sphere { pigment { rgb 1 } }
light_source { <1, 2, 3>, rgb 1 area_light x, y, 3, 3 adaptive 1 jitter }
light_source { 0, rgb 1 fade_distance 2 }
box { 0, 1 finish { emission 3 } }
sphere { 0, 1 normal { bumps } finish { tangent x } }
plane { pigment { rgb 0.18 }
  finish { ambient 0 diffuse 0.6 } }
""")
    assert [re.sub(r"\s+", " ", lamp).strip() for lamp in re.findall(r"light_source {([^{}]*)}", text)] == [
        "<1, 2, 3>, rgb 1 parallel point_at 0", "0, rgb 1 fade_distance 2", "<1.9, 3.6, 9>, rgb <0.5, 0.5, 0.5> parallel point_at 0",
        "<6, 5, -6>, rgb <0.35, 0.4, 0.5> parallel point_at 0", "<-9, 4, 1>, rgb <0.5, 0.45, 0.35> parallel point_at 0"]
    assert left == ["radiosity", "POV-Ray's own patterns of normals", "the sky: three suns and a dark background", "panels and bulbs that shine", "lamps with a size as sharp ones",
                    "lamps as suns from where they are", "reflections and ambient light", "strokes along an axis lean by .06 degrees"]
    assert "global_settings { max_trace_level 1 ambient_light rgb 0  assumed_gamma 1" in text and "box" not in re.sub("box { <", "", text) and "sphere { 0, 1  finish { tangent <1, 1e-6, 1e-3> } }" in text
    assert text.endswith("background { rgb 0.02 }\n") and "clipped_by { box { <-60, -1, -12>, <60, 1, 40> } }" in text
    text, left = povray_common.common("embossed", '#version 3.7;\nglobal_settings { }\nsky_sphere { }\npng "basket.png" ')
    assert "#version 3.7;\nlight_source { <-5, 8, -6>, rgb 1  parallel point_at 0 }\n" in text and text.count("light_source") == 1
    assert left == ["the map's filter", "the sky: a dark background", "a sun in place of what shines", "reflections and ambient light"]


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(study, "METAL", {"Blender": study.Look(10, 16, 1, 2), "POV-Ray": study.Look(10, 16, 1, 2)})
    monkeypatch.setattr(study, "OWN", {})
    monkeypatch.setattr(study, "PERCENT", 5)


def test_a_pair_of_a_blender_example(tmp_path, small):
    rows = study.blender_example("dial")(tmp_path, lambda _text: None)
    assert all(row["ok"] for row in rows if row["kind"] == "pair"), rows
    assert all(row["values"] > 0 and row["error"] <= row["limit"] for row in rows if row["kind"] == "check"), rows
    left = [row["what"] for row in rows if row["kind"] == "left"]
    assert any(what.startswith("sharp points") for what in left) and "a sun in place of the sky" in left
    # strokes round an axis, by each renderer's own words: a dump's T is along them
    dump = dumps.read(tmp_path / "both" / "povray_dump.exr")
    assert len({material["id"] for material in dump.header["materials"]}) > 4


def test_a_pair_of_a_povray_example(tmp_path, small):
    rows = study.povray_example(EXAMPLES["turned"])(tmp_path, lambda _text: None)
    assert all(row["ok"] for row in rows if row["kind"] in ("check", "pair")), rows
