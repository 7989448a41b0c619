# SPDX-License-Identifier: GPL-3.0-or-later
"""shade-render of `make windows`, run by Wine: the pictures of Linux's, names, long paths, damaged scenes, what stands in the way,
what its files need; the add-on's files, which no Blender runs here. Skipped where these are not built: `make check-windows` and
`make soak-machines` build them."""

import json
import os
import re
import resource
import runpy
import signal
import subprocess
import zipfile

import numpy as np
import OpenImageIO as oiio
import pytest

import damaged
import own_dll
from blender_runs import BPY, BUILD, ROOT, Blender, rgba
from blender_runs import ZIP as LINUX
from native_scenes import scene
from shade_render import COMBINED, assert_same, channels, made, run, scene_file

COST = 0.1  # where nothing was built; else 25

ALL = "BOTH" in os.environ  # in make check-windows

VERSION = re.search(r'SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text())[1]
ZIP = BUILD / f"release/shade-render-{VERSION}-windows-x64.zip"
WINE = "/usr/lib/wine/wine64"
ENVIRONMENT = {"WINEPREFIX": str(BUILD / "windows/wine"), "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml,winemenubuilder.exe="}
ADDON = BUILD / f"release/libshade-blender-{VERSION}-windows-x64.zip"
FLAT, RELEASE = BUILD / f"release/libshade-blender-{VERSION}-3.4-to-4.1.zip", BUILD / "release/libshade-blender.zip"
PYTHON310 = "_native.cp310-win_amd64.pyd"
pytestmark = pytest.mark.skipif(not (ZIP.exists() and os.path.exists(WINE)), reason="needs Wine and what make windows builds: make check-windows")
# of Windows itself, since its version 10
SYSTEM = re.compile(r"(kernel32|advapi32|shell32|msvcrt|api-ms-win-crt-[\w-]+)\.dll", re.I)


@pytest.fixture(scope="module", autouse=True)
def wine():
    """One program of Windows that stays: else each of the others would start Wine's services, and wait for their end."""
    with subprocess.Popen([WINE, "cmd"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=os.environ | ENVIRONMENT) as stays:
        yield
        stays.stdin.close()


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    """In a folder whose name is no ASCII."""
    folder = tmp_path_factory.mktemp("установлено здесь 織物")
    with zipfile.ZipFile(ZIP) as archive:
        archive.extractall(folder)
    return folder / ZIP.stem


def runner(path, program):
    """A script that runs a program of Windows, as one of Linux is run."""
    path.write_text("#!/bin/sh\n" + "".join(f"export {name}='{value}'\n" for name, value in ENVIRONMENT.items()) + f"exec {WINE} '{program}' \"$@\"\n")
    path.chmod(0o755)
    return path


@pytest.fixture(scope="module")
def tool(unpacked):
    return runner(unpacked / "run", unpacked / "shade-render.exe")


def assert_near(ours, linux, share=0.999):
    """Compilers contract products and sums, and round elementary functions, each in its way."""
    assert set(ours) == set(linux)
    for name, expected in linux.items():
        found, expected = ours[name].astype(float), expected.astype(float)
        size = np.maximum(np.abs(expected), 1e-3)
        assert (np.abs(found - expected) <= 1e-4 * size).mean() >= share, name
        assert abs(found.mean() - expected.mean()) <= 1e-5 * size.mean(), name


def both(tool, folder, path, *words, share=0.999):
    """The same warnings, too."""
    said = []
    for name, of in (("ours", {"tool": tool}), ("linux", {})):
        done = run(path, "-o", folder / f"{name}.exr", *words, seconds=900, **of)
        assert done.returncode == 0, done.stderr
        said.append(done.stderr)
    assert said[0] == said[1]
    assert_near(channels(folder / "ours.exr"), channels(folder / "linux.exr"), share)


def test_what_it_says(tool):
    for words, status in ((("--version",), 0), (("--help",), 0), (("--samples", "0"), 2), (("x.shscene", "-o", "x.png"), 2)):
        ours, linux = run(*words, tool=tool), run(*words)
        assert (ours.returncode, ours.stdout, ours.stderr) == (status, linux.stdout, linux.stderr)


@pytest.mark.parametrize("number", range(3))
def test_pictures(tool, tmp_path, number):
    """Metal, cloth, matt, glass of both light and shadow; motion, mattes and other passes."""
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", damaged.whole_scenes()[number])
    both(tool, tmp_path, path, "--seed", 4294967295, "--samples", 16)


def script_of(name, folder):
    """[what makes a scene in Blender, its arguments]."""
    if name == "factory":
        (folder / "nothing.py").write_text("")
        return [folder / "nothing.py"]
    if name == "plate":
        normals = oiio.ImageBuf(oiio.ImageSpec(256, 256, 3, oiio.FLOAT))
        normals.set_pixels(oiio.ROI(), runpy.run_path(str(ROOT / "compare/plate.py"))["normal_map"](256))
        assert normals.write(str(folder / "normals.exr")), normals.geterror()
        job = {"engine": "LIBSHADE", "output": "", "surface": "bumped", "detail": "rotate", "size": 1600, "samples": 1, "quads": 1, "repeat": 1}
        (folder / "plate.json").write_text(json.dumps({"normal_map": str(folder / "normals.exr"), "mesh": "", "result": str(folder / "result.json"), "jobs": [job]}))
        return [ROOT / "compare/plate_render.py", folder / "plate.json"]
    return [ROOT / f"examples/blender/{name}/make_scene.py", folder / ("x.blend" if name == "suzanne" else "x.png")]


@pytest.mark.parametrize("name", ["factory", *(["pan", "jacket", "plate", "bolts", "cloth", "dial", "groove", "scratches", "table"] if ALL else [])])
def test_saved_scenes(tool, blender_old, tmp_path, name):
    blender_old.run("saved.py", tmp_path, *script_of(name, tmp_path))
    both(tool, tmp_path, tmp_path / "saved.shscene")


def test_shares_go_from_one_system_to_the_other(tool, tmp_path):
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", [(scene(samples=16), [COMBINED])])
    parts = [tmp_path / "0.shshare", tmp_path / "1.shshare"]
    for part, cut, of in zip(parts, ("0,4", "4,16"), ({"tool": tool}, {})):
        done = run(path, "-o", part, "--share", cut, **of)
        assert done.returncode == 0, done.stderr
    for of in ({"tool": tool}, {}):
        done = run(path, "--merge", *parts, "-o", tmp_path / f"{len(of)}.exr", **of)
        assert done.returncode == 0, done.stderr
    assert_same(channels(tmp_path / "1.exr"), channels(tmp_path / "0.exr"))
    assert_near(channels(tmp_path / "1.exr"), made(tmp_path, path))


@pytest.mark.parametrize("name", ["сцена пять", "布の 織物", "𠀋 é ü", "a" * 200])
def test_names(tool, tmp_path, name):
    """Read, written, replaced; nothing left beside."""
    folder = tmp_path / "папка" / "フォルダ ä"
    folder.mkdir(parents=True)
    path, picture = folder / f"{name}.shscene", folder / f"{name}.exr"
    scene_file.write(path, "L", [(scene(width=8, height=8, samples=1), [COMBINED])])
    for _ in range(2):
        done = run(path, "-o", picture, tool=tool)
        assert done.returncode == 0, done.stderr
    assert {file.name for file in folder.iterdir()} == {path.name, picture.name}
    assert_near(channels(picture), made(tmp_path, path))


def test_long_paths(tool, tmp_path):
    """Far beyond 260 characters."""
    deep = tmp_path.joinpath(*(f"{k}-длинное имя папки, of which there are many" for k in range(9)))
    deep.mkdir(parents=True)
    assert len(str(deep)) > 400
    path = deep / "s.shscene"
    scene_file.write(path, "L", [(scene(width=8, height=8, samples=1), [COMBINED])])
    done = run(path, "-o", deep / "x.exr", tool=tool)
    assert done.returncode == 0 and sorted(file.name for file in deep.iterdir()) == ["s.shscene", "x.exr"], done.stderr
    missing = run(deep / "none.shscene", "-o", deep / "y.exr", tool=tool)
    assert missing.returncode == 1 and str(deep / "none.shscene") in missing.stderr


def test_damaged_files(tool, tmp_path):
    files = damaged.whole_files(tmp_path)
    for seed in range(500 if ALL else 20):
        wrong = damaged.wrong_with(files, tmp_path, seed, tool)
        assert not wrong, f"seed {seed}: {wrong}"


def small_disk():
    """Of which each file has room for 100 bytes: further writes fail."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))


def test_what_stands_in_the_way(tool, tmp_path):
    """A folder, none, one that nobody may write to, a full disk: a message each, nothing left."""
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", [(scene(), [COMBINED])])
    (tmp_path / "folder.exr").mkdir()
    for picture in (tmp_path / "folder.exr", tmp_path / "none/x.exr", "/proc/x.exr"):
        done = run(path, "-o", picture, tool=tool)
        assert done.returncode == 1 and f"shade-render: {picture}: cannot write" in done.stderr, done.stderr
    words = [tool, str(path), "-o", str(tmp_path / "x.exr")]
    done = subprocess.run(words, capture_output=True, text=True, preexec_fn=small_disk, check=False, timeout=60)
    assert done.returncode == 1 and f"shade-render: {tmp_path}/x.exr: " in done.stderr, done.stderr
    assert sorted(file.name for file in tmp_path.iterdir()) == ["folder.exr", "s.shscene"]


def test_a_library_that_is_missing_is_told(unpacked, tmp_path):
    program = tmp_path / "shade-render.exe"
    program.write_bytes((unpacked / "shade-render.exe").read_bytes())
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", [(scene(), [COMBINED])])
    done = run(path, "-o", tmp_path / "x.exr", tool=runner(tmp_path / "run", program))
    assert done.returncode == 1 and re.search(r"cannot load .*\\lib\\libshade_embree.dll: error \d+ of Windows", done.stderr), done.stderr


RUNTIME = {"libshade_embree.dll": {"shtbb.dll", "shcxx.dll", "vcruntime140.dll"}, "shtbb.dll": {"shcxx.dll", "vcruntime140.dll"},
           "shcxx.dll": {"vcruntime140.dll", "vcruntime140_1.dll"}, "vcruntime140.dll": set(), "vcruntime140_1.dll": {"vcruntime140.dll"}}


def needs(folder):
    """{program or DLL: what it needs beside Windows}; nothing says where it was made."""
    files = {path.name: path.read_bytes() for path in folder.rglob("*") if path.suffix in (".exe", ".dll", ".pyd")}
    assert not [name for name, data in files.items() if str(ROOT).encode() in data]
    return {name: {other.lower() for other in own_dll.imports(data) if not SYSTEM.fullmatch(other)} for name, data in files.items()}


def exports(path):
    said = subprocess.run(["x86_64-w64-mingw32-objdump", "-p", path], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"^\s+\[\s*\d+\].*?(\w+)$", said.split("[Ordinal/Name Pointer] Table")[1], re.M))


def test_what_its_files_need(unpacked):
    """Windows and each other, by names that nothing else in a process has."""
    assert needs(unpacked) == {"shade-render.exe": set(), **RUNTIME}
    with pytest.raises(ValueError, match=r"longer\.dll cannot take the place of tbb12\.dll"):
        own_dll.rename((unpacked / "lib/libshade_embree.dll").read_bytes(), {"tbb12.dll": "longer.dll"})


@pytest.fixture(scope="module")
def addon(tmp_path_factory):
    folder = tmp_path_factory.mktemp("addon")
    with zipfile.ZipFile(ADDON) as archive:
        archive.extractall(folder)
    return folder / "libshade"


def test_what_the_addon_needs(addon):
    """Python of any version, by names that are in its stable ABI: the headers declare no others."""
    assert needs(addon) == {"_native.pyd": {"python3.dll"}, "libshade_openexrcore.dll": set(), **RUNTIME}
    assert exports(addon / "_native.pyd") == {"PyInit__native"}
    asked = set(re.findall(r"FUNCTION\((exr_\w+)\)", (ROOT / "libshade/dump/dump_exr.h").read_text()))
    assert len(asked) > 10 and asked <= exports(addon / "lib/libshade_openexrcore.dll")


@pytest.fixture(scope="module")
def flat(tmp_path_factory):
    if not FLAT.exists():
        pytest.skip("make release")
    folder = tmp_path_factory.mktemp("flat")
    with zipfile.ZipFile(FLAT) as archive:
        archive.extractall(folder)
    return folder / "libshade"


@pytest.mark.parametrize("where, name, python", [("addon", "_native.pyd", "python3.dll"), ("flat", PYTHON310, "python310.dll")])
def test_the_module_starts(where, name, python, tmp_path, tool, request):
    """Without a Python, which it is given as functions that do nothing: what it says of itself comes from its own code."""
    module = request.getfixturevalue(where) / name
    said = subprocess.run(["x86_64-w64-mingw32-objdump", "-p", module], capture_output=True, text=True, check=True).stdout
    names = re.findall(r"\b_?Py\w+", said.split(f"DLL Name: {python}")[1].split("\n\n")[0])
    assert len(names) > 30
    through = {"PyModuleDef_Init", "PyUnicode_FromString"}
    assert through <= set(names)
    stubs = "".join(f"__declspec(dllexport) void *{name}(void *first) {{ return {'first' if name in through else '0'}; }}\n" for name in names)
    (tmp_path / "stubs.c").write_text(stubs)
    for source, program, *flags in ((tmp_path / "stubs.c", python, "-shared"), (ROOT / "blender_addon_c/tests/module_host.c", "host.exe")):
        subprocess.run(["x86_64-w64-mingw32-gcc-posix", "-O1", *flags, source, "-o", tmp_path / program], check=True)
    host = runner(tmp_path / "run", tmp_path / "host.exe")
    told = subprocess.run([host, module, "version", "isa"], capture_output=True, text=True, check=False, timeout=60)
    assert told.returncode == 0, told.stdout + told.stderr
    version, isa = told.stdout.split()
    assert run("--version", tool=tool).stdout == f"shade-render {version} ({isa})\n"


def test_blender_finds_the_addon_valid(addon):
    assert 'platforms = ["windows-x64"]' in (addon / "blender_manifest.toml").read_text()
    checker, = BPY.parents[1].glob("lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    subprocess.run([BPY, checker, "validate", ADDON], check=True)


@pytest.mark.skipif(not ALL, reason="the add-on for Linux may be newer: make check-windows makes both")
def test_the_addon_is_linuxs_but_for_what_is_compiled():
    compiled = re.compile(r".*\.(so|dll|pyd)")
    with zipfile.ZipFile(ADDON) as ours, zipfile.ZipFile(LINUX) as linux:
        shared = [{name for name in archive.namelist() if not compiled.fullmatch(name)} for archive in (ours, linux)]
        assert shared[0] == shared[1]
        assert [name for name in shared[0] if ours.read(name) != linux.read(name)] == ["libshade/blender_manifest.toml"]


def test_the_flat_zip(flat, tmp_path):
    """All of both systems' zips, as they are there, and Python 3.10's module for Windows; Blender finds it valid and, the oldest, renders."""
    of = {"libshade/blender_manifest.toml", f"libshade/{PYTHON310}"}
    with zipfile.ZipFile(FLAT) as both, zipfile.ZipFile(ADDON) as windows, zipfile.ZipFile(RELEASE) as linux:
        assert set(both.namelist()) == set(windows.namelist()) | set(linux.namelist()) | of
        assert all(both.read(name) == archive.read(name) for archive in (windows, linux) for name in archive.namelist() if name not in of)
    assert 'platforms = ["linux-x64", "windows-x64"]' in (flat / "blender_manifest.toml").read_text()
    checker, = BPY.parents[1].glob("lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    subprocess.run([BPY, checker, "validate", FLAT], check=True)
    if ALL:
        blender = Blender("old", tmp_path / "home", FLAT)
        (tmp_path / "scene").mkdir()
        try:
            blender.scene("suzanne", tmp_path / "scene", dump="", save=str(tmp_path / "file.blend"))
        finally:
            blender.close()
        assert rgba(tmp_path / "scene/picture.exr")[..., :3].std() > .05
