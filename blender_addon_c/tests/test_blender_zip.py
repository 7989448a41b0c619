# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip: the same bytes each time, and the same picture wherever it is installed."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from blender_runs import BPY, BUILD, ROOT, ZIP, Dump, difference, rgba

COST = 21


# What the add-on brings its own copies of.
SYSTEM_LIBRARIES = ["libembree3.so.3", "libtbb.so.12", "libOpenEXRCore-3_1.so.30"]
SYMBOLS = ["rtcNewDevice", "exr_start_write"]


def test_same_files_same_bytes(tmp_path):
    unpacked = tmp_path / "libshade"
    shutil.copytree(BUILD / "blender/addons/libshade", unpacked,
                    ignore=shutil.ignore_patterns("__pycache__"))
    files = [p for p in unpacked.rglob("*") if p.is_file()]
    for path in files:
        os.utime(path, (1e9, 1e9))
    again = tmp_path / "again.zip"
    subprocess.run([sys.executable, ROOT / "blender_addon_c/package.py", again, unpacked, *files],
                   check=True)
    assert again.read_bytes() == ZIP.read_bytes()


def test_contents():
    """One folder at the top, everything that is imported, nothing of a developer's machine."""
    with zipfile.ZipFile(ZIP) as archive:
        names = archive.namelist()
    assert names == sorted(names)
    assert all(n.startswith("libshade/") and not n.endswith((".pyc", ".part")) for n in names)
    folder = ROOT / "blender_addon_c"
    sources = {f"libshade/{path}" for path in (p.relative_to(folder) for p in folder.rglob("*.py"))
               if path.parts[0] not in ("native", "tests")}
    sources -= {f"libshade/{name}.py" for name in ("package", "make_assets")}
    assert sources <= set(names)
    assert {n for n in names if "/assets/" in n} == {f"libshade/assets/{n}" for n in (
        "metals.blend", "fabrics.blend", "grooves.blend", "scratches.blend", "blender_assets.cats.txt")}
    assert {"libshade/blender_manifest.toml", "libshade/_native.abi3.so"} <= set(names)


def test_assets(blender, tmp_path):
    """In the preferences and out of its files."""
    assert "all asserted" in blender.run("assets.py", tmp_path)
    for name in ("Turned copper", "Cotton denim"):
        r, g, b = rgba(tmp_path / f"{name}.exr")[8:-8, 8:-8, :3].mean((0, 1))
        assert r > g > b > 0 if "copper" in name else b > 1.2 * r > 0, name


def test_the_preferences_show_all_that_is_said():
    """What it is and where stands on one line each."""
    addon = (ROOT / "blender_addon_c/__init__.py").read_text()
    said = re.findall(r'"(?:description|location)": "(.*)"', addon)
    assert len(said) == 2 and all(len(line) < 60 for line in said), said


def test_one_version():
    addon = (ROOT / "blender_addon_c/__init__.py").read_text()
    manifest = (ROOT / "blender_addon_c/blender_manifest.toml").read_text()
    version = re.search(r'"version": \((\d+), (\d+), (\d+)\)', addon).groups()
    assert ".".join(version) == re.search(r'^version = "(.+)"', manifest, re.M).group(1)


@pytest.fixture(scope="module")
def blend(blender_old, tmp_path_factory):
    """(file, picture from 3.4, dump from 3.4)"""
    folder = tmp_path_factory.mktemp("suzanne")
    blender_old.scene("suzanne", folder, save=str(folder / "suzanne.blend"))
    return folder / "suzanne.blend", rgba(folder / "picture.exr"), Dump(folder / "dump.exr")


@pytest.fixture(scope="module")
def plain_new(blender_new, blend, tmp_path_factory):
    """The same from 5.0."""
    folder = tmp_path_factory.mktemp("plain_new")
    blender_new.scene("suzanne", folder, open=str(blend[0]))
    return rgba(folder / "picture.exr"), Dump(folder / "dump.exr")


def test_same_picture_in_both_versions(blend, plain_new):
    _file, picture, _dump = blend
    assert picture[..., 3].mean() > 0.5 and picture[..., :3].max() > 1
    error = difference(plain_new[0], picture)
    print(f"3.4.1 against bpy 5.0.1: mean absolute difference over mean {error:.2e}")
    assert error <= 1e-3


def assert_as_before(folder, plain_new):
    picture, dump = rgba(folder / "picture.exr"), Dump(folder / "dump.exr")
    assert dump.hit.mean() > 0.5  # with a foreign Embree every ray misses
    assert np.array_equal(dump["P"], plain_new[1]["P"])
    assert difference(picture, plain_new[0]) < 1e-5


def test_without_system_libraries(blender_new, blend, plain_new, tmp_path):
    """In a mount namespace of its own, where the system's copies are empty files.

    Debian's Blender itself is linked to them: only bpy, which brings its own, starts there.
    """
    folders = [Path("/usr/lib") / sys.implementation._multiarch, Path("/usr/lib")]
    hidden = [p for name in SYSTEM_LIBRARIES for f in folders if (p := f / name).exists()]
    mounts = "; ".join(f"mount --bind /dev/null {p}" for p in hidden)
    enter = ["unshare", "--map-root-user", "--mount", "sh", "-ec", mounts + '; exec "$@"', "sh"]
    if subprocess.run([*enter, "true"], capture_output=True, check=False).returncode:
        pytest.skip("this machine lets nobody make a mount namespace")
    blender_new.run("check_symbols.py", "missing", *SYSTEM_LIBRARIES, prefix=enter)
    blender_new.scene("suzanne", tmp_path, prefix=enter, open=str(blend[0]))
    assert_as_before(tmp_path, plain_new)


def test_foreign_libraries_in_global_scope(blender_new, blend, plain_new, tmp_path):
    """With Blender's own Embree 4 and OpenEXRCore before all others, as in official builds."""
    libraries = sorted(BPY.parents[1].glob("lib/python*/site-packages/bpy/lib/lib*.so*"))
    preload = [str(p) for p in libraries if p.name.startswith(("libembree4", "libOpenEXRCore"))]
    assert len(preload) == 2, "bpy has changed its libraries"
    env = {"LD_PRELOAD": ":".join(preload)}
    blender_new.run("check_symbols.py", "global", *SYMBOLS, env=env)
    blender_new.scene("suzanne", tmp_path, env=env, open=str(blend[0]))
    assert_as_before(tmp_path, plain_new)


@pytest.mark.parametrize("blind", [False, True])
def test_command_line(blender_old, blend, tmp_path, blind):
    """blender -b FILE -E LIBSHADE -f 1: a picture and status 0, or a message and status 1."""
    file = blend[0]
    if blind:
        file = tmp_path / "blind.blend"
        blender_old.scene("blind", tmp_path, save=str(file), dump="")
    done = subprocess.run(
        [shutil.which("blender"), "-b", "--factory-startup", "--addons", "libshade", file,
         "-E", "LIBSHADE", "-o", tmp_path / "frame_", "-F", "OPEN_EXR", "-f", "1"],
        env=blender_old.environment(), capture_output=True, text=True, timeout=300, check=False)
    picture = tmp_path / "frame_0001.exr"
    if blind:
        assert done.returncode == 1 and not picture.exists()
        assert "sees nothing" in done.stdout + done.stderr
    else:
        assert done.returncode == 0, done.stderr
        assert difference(rgba(picture), blend[1]) < 1e-3


def test_update(blender_old):
    blender_old.run("updated.py", ZIP)


def test_nothing_is_left_behind(blender):
    """Enabled and disabled twice, then installed again over itself."""
    assert "all asserted" in blender.run("left.py", ZIP)
