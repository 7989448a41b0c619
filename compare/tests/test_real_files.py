# SPDX-License-Identifier: Apache-2.0
"""The list of real files, and what is judged; nothing is fetched or rendered here."""
import pytest

import real_files
import real_files_fetch


def row(state, difference="", warnings=""):
    return {**real_files.listed()[0], **real_files.EMPTY, "state": state, "difference": difference,
            "warnings": warnings}


KINDS = {"blend", "glb", "gltf", "obj", "fbx", "dae", "ply", "stl", "x3d", "usd", "usda"}


def test_list():
    """Packages by name and version, each thing once; nothing but a name says where they are."""
    rows = real_files.listed()
    assert len({(r["package"], r["path"], r["material"]) for r in rows}) >= 100
    names = [real_files.name_of(r) for r in rows]
    assert len(set(names)) == len(names)
    for r in rows:
        assert r["source"] in ("deb", "src", "pypi") and r["version"] and r["blender"] in ("3.4", "5.0")
        assert r["path"].rpartition(".")[2].lower() in KINDS and not r["path"].startswith("/")
        assert "://" not in "".join(r.values())
    assert real_files.listed("no package is called so") == []


def test_verdict(capsys):
    options = real_files.arguments([])
    good = [row("rendered", 0.05)] * 9
    unjudged = [row("nothing to see in Cycles"), row("CYCLES: exit status 1"), row("noise of Cycles", 3.0)]
    assert real_files.verdict([*good, row("rendered", 0.0501), *unjudged], options)
    assert "9 of 10 within 0.05 (90.0 %); of the other 1 0 with a warning; 3 not judged" in capsys.readouterr().out
    for bad in (row("rendered", 0.06, "a node"), row("LIBSHADE: exit status -11"),
                row("values that are not finite")):
        assert not real_files.verdict([*good[1:], bad, bad], options)
    assert "of the other 2 0 with a warning" in capsys.readouterr().out
    assert not real_files.verdict([row("package: not to be had")], options)


def test_key_changes_with_what_is_asked():
    one, other = real_files.listed()[:2]
    options = real_files.arguments([])
    keys = {real_files.key_of(*asked) for asked in (
        (one, options), (other, options), (one, real_files.arguments(["--size", "64"])))}
    assert len(keys) == 3
    assert real_files.key_of(one, real_files.arguments(["--threads", "1"])) in keys


def test_path_is_in_its_package(tmp_path):
    (tmp_path / "a b.blend").touch()
    assert real_files_fetch.path_of(tmp_path, "a b.blend") == str(tmp_path / "a b.blend")
    with pytest.raises(OSError, match="not in its package"):
        real_files_fetch.path_of(tmp_path, "gone.blend")
