# SPDX-License-Identifier: GPL-3.0-or-later
"""What versions of Blender do differently stands in one table. Without Blender."""

import re
from pathlib import Path
from types import SimpleNamespace as Of

COST = 0.1

ADD_ON = Path(__file__).resolve().parents[1]
TEXTS = {path.relative_to(ADD_ON).as_posix(): path.read_text(encoding="utf-8")
         for path in ADD_ON.rglob("*.py") if path.relative_to(ADD_ON).parts[0] not in ("tests", "native")}
ROW = re.compile(r"^([A-Z_]+) = _(?:since|before)\(\d, \d+\)  # \S.*$", re.M)

# What 3.4, 3.5, 4.0, 4.2, 4.3, 4.4, 4.5, 5.0 and 5.2 do (x), by what was measured in Cycles and what Blender's release notes say; a person's
ASKED = (3, 4), (3, 5), (4, 0), (4, 2), (4, 3), (4, 4), (4, 5), (5, 0), (5, 2)
DO = {
    "NODES_UNREGISTER": ".......xx", "ALWAYS_NODES": ".......xx", "LONG_PASS_NAMES": ".......xx", "MORE_TO_DENOISE": "........x", "MUTED_AOVS_SPEAK": ".......xx",
    "GROUP_VALUES_COUNT": ".......xx", "BARE_IS_PRINCIPLED": "..xxxxxxx", "BUMPS_FADE": "x........", "MATT_LEANS": "..xxxxxxx", "JOINT_SHADOWING": "..xxxxxxx", "TOON_OVERCOUNTS": "xx.......",
    "ENERGY_OREN_NAYAR": "....xxxxx", "FILM_ON_METAL": ".......xx", "SHINES_BELOW_0": "........x", "SHADOWS_STOP": "..xxxxxxx", "TRANSPARENT_LESS": ".......xx", "NORMAL_MAPS_MIX": "x........",
    "DISPLACED_CLOSELY": "...xxxxxx", "NORMALS_STAY_ACROSS": ".......xx", "NOISE_CLAMPED": "xx.......", "VORONOI_BY_WHOLE": ".......xx", "OLD_IES": "xx.......", "LATER_SKY": ".......xx",
    "ALPHA_AS_SAID": "........x", "OLD_LAMPS": "x........", "LAMPS_STAND_STILL": "xx.......", "LAMPS_ALONE": "xxxxx....", "CATCHERS_TWICE": "xx.......",
}


def test_what_each_version_does():
    found = dict.fromkeys(DO, "")
    for version in ASKED:
        told = {"bpy": Of(app=Of(version=(*version, 1)))}
        exec(TEXTS["versions.py"].replace("import bpy", ""), told)
        found = {name: found[name] + ("x" if told[name] else ".") for name in DO}
    assert found == DO and DO.keys() == {name for name in told if name.isupper()}


def test_only_the_table_asks_for_the_version():
    assert [name for name, text in TEXTS.items() if re.search(r"app\.version\b(?!_)|version_string *[<>=!]", text)] == ["versions.py"]


def test_each_row_says_why_and_is_read():
    table, others = TEXTS["versions.py"], "\n".join(text for name, text in TEXTS.items() if name != "versions.py")
    rows = ROW.findall(table)
    assert len(rows) > 20 and sorted(rows) == sorted(re.findall(r"^([A-Z_]+) =", table, re.M))
    assert set(rows) == set(re.findall(r"\bversions\.([A-Z_]+)\b", others))
