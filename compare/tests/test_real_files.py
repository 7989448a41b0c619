# SPDX-License-Identifier: Apache-2.0
"""The list of real files, and what is judged; nothing is fetched or rendered here."""
import importlib
import sys
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

import materials
import pictures
import real_files
import real_files_fetch

COST = 0.27


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


def test_materials():
    """Sixty-one, in both Blenders by turns, and some of hair; each is known by its own lines."""
    everything = materials.listed(materials.arguments([]))
    rows = [row for row in everything if not row["path"]]
    assert {row["material"][:5] for row in everything if row["path"]} == {"hair_"}
    assert len({row["material"] for row in rows}) == len({row["version"] for row in rows}) == len(rows) == 61
    assert [row["blender"] for row in rows[:4]] == ["3.4", "5.0"] * 2
    assert {row["blender"] for row in materials.listed(materials.arguments(["--blender", "5.0"]))} == {"5.0"}
    assert materials.arguments([]).limit == real_files.arguments([]).limit


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


def test_what_is_kept_of_them(monkeypatch):
    """Of each Blender how many, how many of them are good, the median and the worst, by name."""
    written = {}
    monkeypatch.setattr(real_files.kept, "write", lambda name, head, columns, rows: written.update({name: rows}))
    rows = [{**row("rendered", off), "path": f"a/{k}.obj", "blender": "3.4"} for k, off in enumerate((0.001, 0.06, 0.02, 0.04))]
    found = [*rows, {**row("CYCLES: exit status 1"), "blender": "3.4"}, {**row("rendered", 0.01), "material": "tile", "blender": "5.0"}]
    real_files.keep(found, real_files.arguments(["--results"]))
    assert written["files"] == [["3.4", 5, 4, 3, 0.03, "1.obj 0.06, 3.obj 0.04, 2.obj 0.02, 0.obj 0.001"], ["5.0", 1, 1, 1, 0.01, "tile 0.01"]]
    hair = {**row("rendered", 0.03), "material": "hair_a", "path": real_files.STRANDS}
    materials.keep({True: [{**hair, "path": ""}, hair]}, materials.arguments([]))
    assert written["materials"] == [[what, hair["blender"], "on", 1, 1, 0.03, "hair_a 0.03"] for what in ("ball and box", "hair")]


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


def result_of(tmp_path, monkeypatch, ours, theirs, noise=(0.001, 0.001)):
    """What is said of two pictures each, of two seeds; noise: ours, Cycles'."""
    archive = tmp_path / "libshade.zip"
    archive.write_bytes(b"add-on")
    monkeypatch.setattr(real_files, "ZIP", archive)

    def rendered(_row, engine, stem, _added, _file, _options):
        for seed, value in enumerate(ours if engine == "LIBSHADE" else theirs, 1):
            pictures.write_float(f"{stem}_{seed}.exr", np.full((16, 16, 3), value, np.float32))
        return {"noise": noise[engine == "CYCLES"], "samples": 16, "seconds": 1.0, "added": [], "words": []}

    monkeypatch.setattr(real_files, "rendered", rendered)
    return real_files.both(real_files.listed()[0], real_files.arguments(["--output", str(tmp_path)]), "a.blend")


def test_pictures_of_both_seeds_count(tmp_path, monkeypatch):
    found = result_of(tmp_path, monkeypatch, (0.5, 0.7), (0.4, 0.6))
    assert (found["state"], found["difference"], found["brightness"]) == ("rendered", 0.2, 1.2)


def test_only_noise_of_cycles_excuses(tmp_path, monkeypatch):
    """More than half of the limit; ours is our fault."""
    states = {noise: result_of(tmp_path, monkeypatch, (1, 1), (1, 1), noise)["state"]
              for noise in ((0.2, 0.001), (0.001, 0.2), (0.001, 0.024), (0.001, 0.026))}
    assert list(states.values()) == ["rendered", "noise of Cycles", "rendered", "noise of Cycles"]


@pytest.mark.parametrize("there, path, called", [
    (["wm.obj_import"], "a.OBJ", "wm.obj_import"), (["import_mesh.stl"], "a.stl", "import_mesh.stl"),
    (["wm.stl_import", "import_mesh.stl"], "a.stl", "wm.stl_import"), (["import_scene.x3d"], "a.wrl", "import_scene.x3d"),
    (["wm.usd_import"], "a.usdz", "wm.usd_import"), ([], "a.fbx", None), (["wm.obj_import"], "a.max", None)])
def test_the_first_operator_that_is_there_imports(monkeypatch, there, path, called):
    """Of an add-on only once that is enabled, which it is where nothing else reads the kind."""
    asked = []

    class Operators:
        def __init__(self, module):
            self.names = [word.split(".")[1] for word in there if word.startswith(module + ".")
                          and (module == "wm" or enabled)]
            self.module = module

        def __dir__(self):
            return self.names

        def __getattr__(self, name):
            return lambda filepath: asked.append(f"{self.module}.{name}")

    class All:
        def __getattr__(self, module):
            return Operators(module)

    enabled = []
    bpy = ModuleType("bpy")
    bpy.ops, bpy.app = All(), SimpleNamespace(version_string="3.4.1")
    for name, module in (("bpy", bpy), ("mathutils", MagicMock()), ("addon_utils", SimpleNamespace(enable=enabled.append))):
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, "real_files_render", raising=False)
    render = importlib.import_module("real_files_render")
    monkeypatch.delitem(sys.modules, "real_files_render")
    if called:
        render.imported(path)
        assert asked == [called] and bool(enabled) == (not called.startswith("wm."))
    else:
        with pytest.raises(SystemExit, match=f"{path}: Blender 3.4.1 imports no"):
            render.imported(path)
