# SPDX-License-Identifier: GPL-3.0-or-later
"""What versions of Blender do differently stands in one table. Without Blender."""

import re
from pathlib import Path

COST = 0.1

ADD_ON = Path(__file__).resolve().parents[1]
TEXTS = {path.relative_to(ADD_ON).as_posix(): path.read_text(encoding="utf-8")
         for path in ADD_ON.rglob("*.py") if path.relative_to(ADD_ON).parts[0] not in ("tests", "native")}
ROW = re.compile(r"^([A-Z_]+) = _(?:since|before)\(\d, \d+\)  # \S.*$", re.M)


def test_only_the_table_asks_for_the_version():
    assert [name for name, text in TEXTS.items() if re.search(r"app\.version\b(?!_)|version_string *[<>=!]", text)] == ["versions.py"]


def test_each_row_says_why_and_is_read():
    table, others = TEXTS["versions.py"], "\n".join(text for name, text in TEXTS.items() if name != "versions.py")
    rows = ROW.findall(table)
    assert len(rows) > 20 and sorted(rows) == sorted(re.findall(r"^([A-Z_]+) =", table, re.M))
    assert set(rows) == set(re.findall(r"\bversions\.([A-Z_]+)\b", others))
