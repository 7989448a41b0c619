# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloth of one's own yarns and drafts: what the native module reads is what the reference then shades."""

import json
import math

import numpy as np
import pytest

from native_scenes import dump, native, ortho, registers, scene, square, sun
from test_native_cloth import checked, cloth, fabric
from test_native_cloth_moved import moved

COST = 0.48

PLAIN = {"materials": [fabric()], "meshes": [square(1.0)], "lights": [sun((0.2, 0.3, 0.9))], "camera": ortho(0.9, (0.4, 0.5, 3))}

# Pick by pick the ends 1, 2, 4; 2; 1, 3, 4 are on top.
WIF = """[WIF]
Version=1.1
[WEAVING]
Rising Shed=true
Shafts=3
Treadles=3
[WARP]
Threads=4
Color=2
Thickness=.04
Spacing=.05
Units=centimeters
[WEFT]
Threads=3
Color=1
Thickness=.08
Spacing=.1
Units=centimeters
[COLOR PALETTE]
Range=0,255
Entries=2
[COLOR TABLE]
1=255,255,255
2=200,40,60
[THREADING]
1=1
2=2
3=3
4=1
[TIEUP]
1=1,2
2=2
3=1,3
[TREADLING]
1=1
2=2
3=3
"""


def told(given, path):
    planes, header = dump(given, path)
    header = json.loads(header) if isinstance(header, str) else header
    return planes, header["materials"][0]["fabric"]


def test_yarns_of_ones_own(tmp_path):
    """Numbers of the yarns are those of the dump's header, which the reference reads; the others stay the preset's."""
    warp = {"width": 0.6, "gap": 0.4, "crimp": 0.25, "slub": 0.3, "vary_tilt": 0.1, "along": 70.0}
    weft = {"width": 0.5, "gap": 0.5, "curve": 0.7, "along_brightness": 0.2, "across": 7.0}
    given = cloth("gabardine", 0.0006, weave="herringbone", counts=(30.0, 20.0), warp_yarn=warp, weft_yarn=weft)
    _planes, before = told(scene(cloths=[cloth("gabardine", 0.0006)], **PLAIN), tmp_path / "a.exr")
    planes, after = told(scene(cloths=[given], **PLAIN), tmp_path / "b.exr")
    assert "apart" not in checked(tmp_path / "b.exr")
    assert after["weave"] == "herringbone" and before["weave"] != "herringbone"
    for yarn, own in (("warp", warp), ("weft", weft)):
        for part in ("yarns", "cloth"):
            for word, value in before[part][yarn].items():
                if not isinstance(value, str):
                    assert after[part][yarn][word] == pytest.approx(own.get(word, value), rel=1e-6), (yarn, word)
    np.testing.assert_allclose(np.ptp(planes["uv.U"]) / np.ptp(planes["P.X"]), 30 * 100 * 0.0006 / 2, rtol=1e-3)
    np.testing.assert_allclose(np.ptp(planes["uv.V"]) / np.ptp(planes["P.Y"]), 20 * 100 * 0.0006 / 2, rtol=1e-3)


@pytest.mark.parametrize("yarn, hand", [("warp", 1), ("warp", -1), ("weft", 1), ("weft", -1)])
def test_twist(yarn, hand, tmp_path):
    """tan of the strands' angle to the yarn is width / (2 slant) of the other's crossing; S leans to +sigma on the weft,
    and on the warp, a mirror, Z does. cloth() has the angle back."""
    angle = math.radians(25)
    both = {"width": 0.8, "gap": 0.2, "segments": 2.0}
    given = {f"{name}_yarn": dict(both) for name in ("warp", "weft")}
    given[f"{yarn}_yarn"]["twist"] = hand * angle
    _planes, after = told(scene(cloths=[cloth("denim", 0.0006, **given)], **PLAIN), tmp_path / "d.exr")
    assert "apart" not in checked(tmp_path / "d.exr")
    numbers = after["yarns"][yarn]
    assert numbers["slant"] == pytest.approx(hand * (-1 if yarn == "warp" else 1) * 0.8 / (2 * math.tan(angle)), rel=1e-5)
    assert numbers["fibre"] == pytest.approx(hand * angle, rel=1e-5) and numbers["segments"] == 2
    plied = {**given[f"{yarn}_yarn"], "plied": True}
    _planes, after = told(scene(cloths=[cloth("denim", 0.0006, **{**given, f"{yarn}_yarn": plied})], **PLAIN), tmp_path / "e.exr")
    assert after["yarns"][yarn]["fibre"] == 0
    for row in native.table()["cloths"]:
        own = native.cloth(row["word"])
        for name, other in (("warp", "weft"), ("weft", "warp")):
            number, crossing = own[name], own[other]["width"] + own[other]["gap"]
            slant = number["slant"] * (-1 if name == "warp" else 1) if number["segments"] > 0 else 0
            expected = math.atan(number["width"] / (2 * crossing * slant)) if slant else 0
            assert number["twist"] == pytest.approx(expected, abs=1e-9)


def test_a_draft(tmp_path):
    """Of four ends and three picks, over and under as it says, and in its colours, as the reference reads it again."""
    given = cloth("linen", 0.003, draft=WIF, draft_name="three.wif", draft_colors=True)
    planes, after = told(scene(cloths=[given], **PLAIN), tmp_path / "d.exr")
    assert "apart" not in checked(tmp_path / "d.exr")
    assert "weave" not in after and after["cloth"]["draft_colors"] and "[THREADING]" in after["draft"]
    assert planes["uv.U"].max() > 4
    about = native.wif(WIF.encode(), "three.wif")
    assert (about["ends"], about["picks"], about["colored"], about["mended"]) == (4, 3, True, "")
    assert about["weft_share"] == pytest.approx(5 / 12) and about["counts"] == pytest.approx((20, 10))
    assert about["widths"] == pytest.approx(np.array(((0.04, 0.01), (0.08, 0.02)))) and about["sett"] == "spacing"
    given = scene(cloths=[cloth("linen", 1.0, draft=WIF, repeats=(5.0, 7.0))], width=4, height=4, **PLAIN)
    planes, _ = dump(given, tmp_path / "e.exr")
    np.testing.assert_allclose(np.ptp(planes["uv.U"]) / np.ptp(planes["P.X"]), 5 * 4 / 2, rtol=1e-3)
    np.testing.assert_allclose(np.ptp(planes["uv.V"]) / np.ptp(planes["P.Y"]), 7 * 3 / 2, rtol=1e-3)


@pytest.mark.parametrize("warp, weft", [(1, 1), (2, 1), (1, 2), (2, 2)])
def test_yarns_of_either_kind_colour_a_draft(warp, weft):
    """The first of the palette is white."""
    text = WIF.replace("Color=2", f"Color={warp}").replace("Threads=3\nColor=1", f"Threads=3\nColor={weft}")
    for color in ("200,255,255", "255,200,255", "255,255,200"):
        assert native.wif(text.replace("200,40,60", color).encode(), "x.wif")["colored"] == (max(warp, weft) > 1)


BAD = WIF.replace("3=3\n4=", "3=two\n4=", 1)


def test_a_bad_draft_names_its_line():
    """As the tool says it of a file."""
    line = BAD[:BAD.index("3=two")].count("\n") + 1
    with pytest.raises(ValueError, match=rf"bad\.wif, line {line}: "):
        native.wif(BAD.encode(), "bad.wif")
    with pytest.raises(ValueError, match=rf"cloths\[0\]: bad\.wif, line {line}: "):
        native.start(scene(cloths=[cloth(draft=BAD, draft_name="bad.wif")], **PLAIN))


def test_by_the_size_of_the_object(tmp_path):
    """Numbers of the instance, through node OBJECT and Scale."""
    metres = registers(10, 3)
    nodes = [{"type": "OBJECT", "what": "METRES", "out": metres}]
    given = scene(cloths=[cloth("denim", 1.0)], **(PLAIN | {"materials": [moved(nodes, framed=False, scale=metres[:1])]}))
    given["instances"] = [given["instances"][0] | {"metres": (0.002, 0.5)}]
    planes, _ = dump(given, tmp_path / "d.exr")
    np.testing.assert_allclose(np.ptp(planes["uv.U"]) / np.ptp(planes["P.X"]), 26 * 100 * 0.002 / 2, rtol=1e-3)


@pytest.mark.parametrize("change, message", [
    (cloth(weave="chiffon"), r"weave: no weave 'chiffon'"),
    (cloth(counts=(0.0, 1.0)), r"counts"),
    (cloth(repeats=(math.nan, 1.0)), r"repeats"),
    (cloth(warp_yarn={"width": -1.0}), r"warp_yarn.*width"),
    (cloth(weft_yarn={"twist": 4.0}), r"weft_yarn.*twist"),
    (cloth(draft="no draft at all"), r"draft"),
    (cloth(draft=3), r"draft"),
])
def test_what_cannot_be_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        native.start(scene(cloths=[change], **PLAIN))


def test_hostile_drafts():
    """Cut short anywhere, or a byte changed: a draft or a message, never worse."""
    random = np.random.default_rng(1)
    data = np.frombuffer(WIF.encode(), np.uint8)
    for _ in range(300):
        part = data[:random.integers(len(data))].copy() if random.random() < 0.5 else data.copy()
        part[random.integers(len(part), size=min(3, len(part)))] = random.integers(256, size=min(3, len(part)))
        try:
            assert native.wif(part.tobytes(), "w")["ends"] > 0
        except ValueError as error:
            assert str(error).startswith("w")
