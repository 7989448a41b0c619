# SPDX-License-Identifier: AGPL-3.0-or-later
"""The patches as a series, the glue as C++, and the scenes that must not change."""
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from conftest import ROOT

COST = 43
ALONE = {"test_no_existing_scene_changes": 11}

PATCHES = ROOT / "povray_patches"
SERIES = [line for line in (PATCHES / "series").read_text().split("\n") if line and not line.startswith("#")]
SOURCE = Path(os.environ.get("POVRAY_SOURCE", ROOT / "build/povray/src"))


def test_no_existing_scene_changes(povray, unpatched):
    done = subprocess.run([PATCHES / "check.sh", povray, unpatched, SOURCE / "distribution"], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=900)
    print(done.stdout)
    assert done.returncode == 0, done.stdout
    assert re.search(r"^140 of 140 scenes pixel-identical", done.stdout, re.M), done.stdout


def test_check_notices_a_difference(povray, unpatched, tmp_path):
    """check.sh itself must be able to fail."""
    (tmp_path / "scenes/one").mkdir(parents=True)
    (tmp_path / "scenes/one/a.pov").write_text(
        "#version 3.7; sphere { 5*z, 1 pigment { rgb 1 } finish { ambient 1 } } #if (file_exists(\"libshade_metals.inc\")) box { -1, 1 } #end")
    (tmp_path / "include").mkdir()
    done = subprocess.run([PATCHES / "check.sh", povray, unpatched, tmp_path, "one"], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
    assert done.returncode == 1 and "DIFFERS one/a.pov" in done.stdout, done.stdout


@pytest.mark.parametrize("name", SERIES)
def test_patch_says_why(name):
    header = (PATCHES / name).read_text().split("\n--- ")[0]
    # REUSE-IgnoreStart
    assert "SPDX-License-Identifier: AGPL-3.0-or-later" in header
    # REUSE-IgnoreEnd
    assert len(re.search(r"Description: .+\n((?: .+\n)+)", header).group(1).split()) > 20


def test_series_is_complete_and_applied_without_fuzz():
    assert sorted(SERIES) == sorted(p.name for p in PATCHES.glob("*.patch"))
    quilt = dict(os.environ, QUILT_PATCHES=str(PATCHES), QUILT_SERIES=str(PATCHES / "series"), QUILT_PC=".pc-libshade")
    applied = subprocess.run(["quilt", "--quiltrc=-", "applied"], cwd=SOURCE, env=quilt, text=True, stdout=subprocess.PIPE)
    assert [Path(line).name for line in applied.stdout.split()] == SERIES
    # build.sh applied them with --fuzz=0; taking them off a copy must give the original files back
    check = subprocess.run(["quilt", "--quiltrc=-", "diff", "-z", "--no-timestamps"], cwd=SOURCE, env=quilt, text=True, stdout=subprocess.PIPE)
    assert check.stdout == "", "the tree has changes that are in no patch"


@pytest.mark.skipif("SERIES" not in os.environ, reason="of `make soak`: what is built has all patches")
def test_each_patch_compiles_without_those_after_it(tmp_path):
    """With the glue as it is."""
    shutil.copytree(SOURCE / "source", tmp_path / "source")

    def patch(name, *options):
        done = subprocess.run(["patch", "-p1", "--fuzz=0", "--no-backup-if-mismatch", *options, "-i", PATCHES / name], cwd=tmp_path, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        assert done.returncode == 0 and "offset" not in done.stdout, f"{name}:\n{done.stdout}"
        return [tmp_path / path for path in re.findall(r"^patching file (\S+\.cpp)$", done.stdout, re.M)]
    for name in reversed(SERIES):
        patch(name, "-R", "-s")

    headers = ["-include", SOURCE.parent / "headers.h"] if (SOURCE.parent / "headers.h.gch").exists() else []
    flags = re.search(r"^CXXFLAGS = (.*)", (SOURCE / "Makefile").read_text(), re.M).group(1).split()
    folders = [tmp_path / d for d in ("source", "source/backend", "source/base", "source/frontend")] + [SOURCE / d for d in ("unix", "vfe", "vfe/unix")]
    folders += [ROOT / "libshade/include", ROOT / "libshade", "/usr/include/OpenEXR", "/usr/include/Imath"]
    for name in SERIES:
        files = patch(name)
        if name == SERIES[0]:
            files += (tmp_path / "source/backend/mdf").glob("*.cpp")
        for path in files:
            done = subprocess.run(["g++", "-pthread", *flags, "-DHAVE_CONFIG_H", *headers, "-fsyntax-only", "-w", *[f"-I{d}" for d in folders], path],
                                  cwd=tmp_path, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            assert done.returncode == 0, f"{name}:\n{done.stdout}"


SYSTEM = [SOURCE / d for d in ("unix", "source", "source/backend", "source/base", "source/frontend", "vfe", "vfe/unix")]
STRICT = ["-DHAVE_CONFIG_H", "-std=gnu++17", "-Wall", "-Wextra", "-Wconversion", "-Werror",
          f"-I{ROOT}/libshade/include", f"-I{ROOT}/libshade",
          *[f"-isystem{d}" for d in SYSTEM], "-isystem/usr/include/OpenEXR", "-isystem/usr/include/Imath"]


@pytest.fixture(scope="module", params=["g++", "clang++"])
def strictly(request, tmp_path_factory):
    """strictly(words) runs a compiler that has read most of POV-Ray's headers, which takes two thirds of the time of a file."""
    folder = tmp_path_factory.mktemp("ahead")
    (folder / "ahead.h").write_text("".join(f'#include "{name}.h"\n' for name in ("backend/frame", "backend/scene/scene", "backend/parser/parse")))

    def run(*words):
        done = subprocess.run([request.param, *STRICT, *words], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        assert done.returncode == 0, done.stdout
    suffix = "gch" if request.param == "g++" else "pch"  # where each looks for it
    run("-x", "c++-header", folder / "ahead.h", "-o", folder / f"ahead.h.{suffix}")
    return lambda *words: run("-include", folder / "ahead.h", *words)


@pytest.mark.parametrize("name", sorted(p.name for p in (PATCHES / "glue").glob("*.cpp")))
def test_glue_compiles_without_a_warning(strictly, name, tmp_path):
    """Our files with every warning on; POV-Ray's headers count as the system's."""
    folder = tmp_path / "glue/backend"
    folder.mkdir(parents=True)
    (folder / "mdf").symlink_to(PATCHES / "glue")
    strictly("-fsyntax-only", f"-I{tmp_path}/glue", folder / "mdf" / name)
