# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip of `make release-addon`: what it asks of a system, and that it renders as the local one does, in Blenders of other systems too."""

import os
import re
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from blender_runs import BPY, BUILD, NAMESPACE, ROOT, Blender, Missing, rgba
from native_scenes import scene
from shade_render import COMBINED, channels, made, scene_file

COST = 20  # in .ci/run, which makes a release; else 0.1: skipped

RELEASE = BUILD / "release/libshade-blender.zip"
VERSION = re.search(r'SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text())[1]
pytestmark = pytest.mark.skipif(not RELEASE.exists(), reason=f"{RELEASE} is not there: make release-addon")

GLIBC, GLIBCXX = (2, 28), (3, 4, 21)
SYSTEM = {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "ld-linux-x86-64.so.2"}
CXX = {"libstdc++.so.6", "libgcc_s.so.1"}
MAY_NEED = {"_native.abi3.so": SYSTEM, "libshade_openexrcore.so": SYSTEM,
            "libshade_embree.so": SYSTEM | CXX | {"libshade_tbb.so"}, "libshade_tbb.so": SYSTEM | CXX}


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("release")
    with zipfile.ZipFile(RELEASE) as archive:
        archive.extractall(folder)
    return folder / "libshade"


def said(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def versions(file, name):
    """Those of symbols `name`_2.28 that a file asks for."""
    return [tuple(map(int, found.split("."))) for found in
            re.findall(rf"\b{name}_([\d.]+)", said("objdump", "-p", file))]


def test_what_it_asks_of_a_system(unpacked):
    elves = {p.name: p for p in unpacked.rglob("*") if p.is_file() and p.read_bytes()[:4] == b"\x7fELF"}
    assert set(elves) == set(MAY_NEED)
    for name, file in elves.items():
        dynamic = said("readelf", "-d", file)
        assert set(re.findall(r"NEEDED.*\[(.*)\]", dynamic)) <= MAY_NEED[name], name
        if name != "_native.abi3.so":
            assert re.findall(r"SONAME.*\[(.*)\]", dynamic) == [name]
        glibc = versions(file, "GLIBC")
        assert glibc and max(glibc) <= GLIBC, name
        assert max(versions(file, "GLIBCXX"), default=GLIBCXX) <= GLIBCXX, name
        assert str(ROOT).encode() not in file.read_bytes(), f"{name} knows where it was built"


def test_only_the_module_itself_is_exported(unpacked):
    assert said("nm", "-D", "--defined-only", unpacked / "_native.abi3.so").split()[2::3] == ["PyInit__native"]


ARCHIVES = {name: RELEASE.parent / f"{name}.tar.gz" for name in
            (f"{of}-{VERSION}-linux-{machine}" for of in ("libshade", "shade-render") for machine in ("x64", "arm64"))}
# of Debian for arm64, which runs by qemu
ARM64 = ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]


@pytest.mark.parametrize("name", ARCHIVES)
def test_archives(name, tmp_path):
    """Library and tools: what they ask of a system, that nothing in them knows this one, that the tools do as the local ones, with libraries of their own."""
    if not ARCHIVES[name].exists():
        pytest.skip("make release")
    subprocess.run(["tar", "-xzf", ARCHIVES[name], "-C", tmp_path], check=True)
    elves = [p for p in tmp_path.rglob("*") if p.is_file() and not p.is_symlink() and p.read_bytes()[:4] == b"\x7fELF"]
    arm = name.endswith("arm64")
    for file in elves:
        assert set(re.findall(r"NEEDED.*\[(.*)\]", said("readelf", "-d", file))) <= MAY_NEED.get(file.name, SYSTEM) | {"ld-linux-aarch64.so.1"}
        latest = (2, 34) if arm and file.name.startswith("libshade_") else GLIBC  # Embree and TBB of Debian 12
        assert max(versions(file, "GLIBC")) <= latest and str(ROOT).encode() not in file.read_bytes(), file
        assert max(versions(file, "GLIBCXX"), default=GLIBCXX) <= ((3, 4, 29) if arm else GLIBCXX), file
        assert ("AArch64" if arm else "X86-64") in said("readelf", "-h", file)
    tool, = (p for p in elves if p.name in ("shade", "shade-render"))
    if arm and not (shutil.which(ARM64[0]) and os.path.exists(ARM64[2])):
        pytest.skip("no qemu here")
    run = [*(ARM64 if arm else []), tool]
    assert said(*run, "--version") == (f"{tool.name} {VERSION} (neon)\n" if arm else said(BUILD / tool.name, "--version"))
    if tool.name == "shade":
        values = [np.array(subprocess.run([*words, "eval"], input="0 0 1 .1 .2 .97\n.1 0 .99 0 0 1\n", capture_output=True, text=True,
                                          check=True).stdout.split(), float) for words in (run, [BUILD / "shade"])]
        assert len(values[0]) and np.allclose(*values, rtol=1e-12)
        assert sorted(p.name for p in tmp_path.glob("*/lib/libshade*")) == ["libshade.a", "libshade.so", f"libshade.so.{VERSION[:-2]}", f"libshade.so.{VERSION}"]
    else:
        scene_file.write(tmp_path / "one.shscene", "L", [(scene(width=64, height=48, samples=4), [COMBINED])])
        pictures = []
        for words in (run, [BUILD / "shade-render"]):
            done = subprocess.run([*words, tmp_path / "one.shscene", "-o", tmp_path / "one.exr"], capture_output=True, text=True, check=True,
                                  env=os.environ | {"LD_DEBUG": "files"})
            of = channels(tmp_path / "one.exr")
            pictures.append(np.stack([of[name] for name in sorted(of)], -1))
            if words == run:
                assert {f"{tool.parent}/lib/libshade_{own}.so" for own in ("embree", "tbb")} <= set(re.findall(r"calling init: (\S+)", done.stderr))
        assert pictures[1][..., 1:].std() > .01
        assert_same(*pictures)


def rendered(module, picture, prefix=(), **environment):
    """What a module says of itself; the picture of one scene into a file. prefix: words before the command."""
    code = f"""
import sys
from native_scenes import MODULE, dump, native, render, scene
import numpy as np
np.save({str(picture)!r}, render(scene())[0])
dump(scene(), {str(picture) + ".exr"!r})
print(native.isa(), str(MODULE) == {str(module)!r})"""
    done = subprocess.run([*prefix, sys.executable, "-c", code], cwd=ROOT / "blender_addon_c/tests", text=True, capture_output=True,
                          env=os.environ | environment | {"NATIVE_MODULE": str(module)}, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    isa, same = done.stdout.split()
    assert same == "True"
    return isa, np.load(picture)


LOCAL = BUILD / "blender/native/_native.abi3.so"


def assert_same(picture, expected):
    """But for rays that Embree 3 and 4 round differently."""
    error = np.abs(picture - expected)[..., :3]
    assert error.mean() <= 1e-5 * expected[..., :3].mean()
    assert (error.max(-1) <= 1e-4).mean() >= .999


@pytest.mark.parametrize("isa", ["", "sse2", "avx2"])
def test_the_module_alone(unpacked, tmp_path, isa):
    """On the instruction set that the local one takes: with another runtime it is SSE2 without a word."""
    ours = rendered(unpacked / "_native.abi3.so", tmp_path / "ours.npy", LIBSHADE_ISA=isa)
    local = rendered(LOCAL, tmp_path / "local.npy", LIBSHADE_ISA=isa)
    assert ours[0] == local[0]
    assert_same(ours[1], local[1])


@pytest.mark.parametrize("name", ["с пробелом и кириллицей", "場面 の フォルダ"])
def test_folders_of_any_name(unpacked, tmp_path, name):
    folder = tmp_path / name
    shutil.copytree(unpacked, folder)
    rendered(folder / "_native.abi3.so", tmp_path / "there.npy")


def test_a_folder_that_nobody_may_write(unpacked, tmp_path):
    """Mounted so: modes alone stop no administrator."""
    script = 'mount --bind "$1" "$1"; mount -o remount,ro,bind "$1"; if touch "$1/file" 2>&-; then exit 1; fi; shift; exec "$@"'
    prefix = [*NAMESPACE, "sh", "-ec", script, "sh", str(unpacked)]
    if subprocess.run([*prefix, "true"], capture_output=True, check=False).returncode:
        pytest.skip("this machine lets nobody make a mount namespace")
    rendered(unpacked / "_native.abi3.so", tmp_path / "there.npy", prefix=prefix)


def test_two_at_once_and_an_update_over_one_that_runs(tmp_path):
    blender = Blender("new", tmp_path / "home", RELEASE)
    file, pictures = str(tmp_path / "file.blend"), []

    def render(name, env=None, **where):
        (tmp_path / name).mkdir()
        blender.scene("suzanne", tmp_path / name, env, dump="", **where)
        pictures.append(rgba(tmp_path / name / "picture.exr"))

    try:
        render("first", save=file)  # in the process that goes on
        render("another", env={"ANOTHER": "process"}, open=file)
        blender.run("install.py", RELEASE)
        render("after", open=file)
    finally:
        blender.close()
    assert pictures[0][..., :3].std() > .05
    for picture in pictures[1:]:
        assert np.array_equal(picture, pictures[0])


def test_blender_finds_it_valid():
    checker, = BPY.parents[1].glob("lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    subprocess.run([BPY, checker, "validate", RELEASE], check=True)


# in make soak all that there are
BLENDERS = ["5.2"] + (["old", "new", "4.2", "4.5", "5.3"] if "BOTH" in os.environ else [])


@pytest.mark.parametrize("which", BLENDERS)
def test_in_blender(which, tmp_path):
    """Installed as a user does, under a home of any name; three scenes, and what the local renderer makes of the same."""
    try:
        blender = Blender(which, tmp_path / "дом 家 с пробелом", RELEASE)
    except Missing as missing:
        pytest.skip(str(missing))
    scenes = {"first_minute": {"engine": "LIBSHADE", "floor": True, "samples": 16}, "cloth": {}, "suzanne": {"save": str(tmp_path / "file.blend")}}
    for name, options in scenes.items():
        folder = tmp_path / name
        folder.mkdir()
        blender.scene(name, folder, {"LIBSHADE_SCENE": str(folder / "saved.shscene")}, dump="", **options)
        pictures = [np.stack([of[next(key for key in of if f"Combined.{c}".endswith(key))] for c in "RGBA"], -1)
                    for of in (channels(folder / "picture.exr"), made(folder, folder / "saved.shscene"))]
        assert pictures[1][..., :3].std() > .05
        assert_same(*pictures)
