# SPDX-License-Identifier: Apache-2.0
"""Files appear whole or not at all, whatever ends the writing; and nothing is written otherwise."""
import ast
import csv
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pictures
import pytest
import whole

COST = 0.54

COMPARE = Path(whole.__file__).parent


class Broken(Exception):
    pass


@pytest.mark.parametrize("error", [Broken, KeyboardInterrupt])
@pytest.mark.parametrize("before", [None, "old"])
def test_an_error_leaves_what_was_there(tmp_path, before, error):
    path = tmp_path / "table.csv"
    if before:
        path.write_text(before, encoding="utf-8")

    def rows():
        yield ["a", "b"]
        raise error

    with pytest.raises(error):
        whole.write_csv(path, rows())
    with pytest.raises(error), whole.place(path) as part:
        part.write_text("half", encoding="utf-8")
        raise error
    assert [p.read_text(encoding="utf-8") for p in tmp_path.iterdir()] == ([before] if before else [])


def test_a_killed_program_leaves_what_was_there(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("old", encoding="utf-8")
    code = f"""
import os, signal, sys
sys.path.insert(0, {str(COMPARE)!r})
import whole
with whole.place({str(path)!r}) as part:
    part.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""
    done = subprocess.run([sys.executable, "-c", code])
    assert done.returncode == -signal.SIGKILL
    assert path.read_text(encoding="utf-8") == "old"


def test_what_is_written(tmp_path):
    path = tmp_path / "table.csv"
    whole.write_csv(path, [{"a": 1, "b": "x,y"}, {"a": 2, "b": ""}])
    assert path.read_bytes() == b'a,b\r\n1,"x,y"\r\n2,\r\n'
    whole.write_csv(path, [["a"], [3]])
    with open(path, newline="", encoding="utf-8") as file:
        assert list(csv.reader(file)) == [["a"], ["3"]]
    link = tmp_path / "link.csv"
    link.symlink_to(path)
    whole.write_text(link, "ü")  # the file, not the link, is replaced
    assert link.is_symlink() and path.read_text(encoding="utf-8") == "ü"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["link.csv", "table.csv"]
    os.mkfifo(tmp_path / "pipe")
    for wrong in (tmp_path, tmp_path / "pipe"):
        with pytest.raises(OSError, match="no plain file"):
            whole.write_text(wrong, "")


def test_a_picture_that_cannot_be_written_leaves_the_old_one(tmp_path, monkeypatch):
    path = tmp_path / "a.exr"
    pictures.write_float(path, np.full((2, 2, 3), 0.5))
    old = path.read_bytes()
    monkeypatch.setattr(pictures.np, "ascontiguousarray", lambda _pixels: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        pictures.write_float(path, np.ones((2, 2, 3)))
    assert path.read_bytes() == old and [p.name for p in tmp_path.iterdir()] == ["a.exr"]


def writes(tree):
    """Lines of calls that write a file by its name, but to the `part` of whole.place."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        first = node.args[0].id if node.args and isinstance(node.args[0], ast.Name) else ""
        mode = node.args[1] if len(node.args) > 1 else None
        if name == "open" and isinstance(mode, ast.Constant) and set(str(mode.value)) & set("wax+"):
            yield node.lineno, first
        if name in ("savez", "savefig", "imsave", "savetxt"):
            yield node.lineno, first
        if name in ("write_text", "write_bytes") and getattr(node.func.value, "id", "") != "whole":
            yield node.lineno, getattr(node.func.value, "id", "")


def test_nothing_is_written_otherwise():
    """But logs of running programs, which are to be read while they grow."""
    found = [f"{path.name}: {first}" for path in sorted(COMPARE.glob("*.py"))
             for _line, first in writes(ast.parse(path.read_text(encoding="utf-8"))) if first != "part"]
    assert found == ["real_files.py: log", "report.py: log"]
