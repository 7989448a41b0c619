# SPDX-License-Identifier: AGPL-3.0-or-later
"""The patches as a series, the glue as C++, and the scenes that must not change."""
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from conftest import ROOT

COST = 43.3
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


STAND_IN = """#!/bin/sh
for word; do case $word in +I*) in=${word#+I} ;; +O*) out=${word#+O} ;; esac; done
{ echo "$0 and the date"; cat "$in"; } >"$out"
case $in in
  bad.pov) exit 4 ;;
"""


def test_what_check_says(tmp_path):
    """Of scenes that are equal but for the head of their files, that differ, that fail, and of words that are wrong; by stand-ins for POV-Ray."""
    for name in ("textures/same", "lights/differ", "objects/status", "objects/bad", "extra/other"):
        path = tmp_path / f"scenes/{name}.pov"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(bytes(64 * 48 * 6))
    (tmp_path / "scenes/none").mkdir()
    for name, own in (("one", ""), ("two", '  differ.pov) printf x >>"$out" ;;\n  status.pov) exit 3 ;;\n')):
        (tmp_path / name).write_text(STAND_IN + own + "esac\n")
        (tmp_path / name).chmod(0o755)

    def check(*words, status):
        done = subprocess.run([PATCHES / "check.sh", *words], cwd=tmp_path, text=True, capture_output=True, timeout=60)
        assert done.returncode == status, done
        return done.stdout, done.stderr
    programs = ["./one", tmp_path / "two", tmp_path]
    said, wrong = check(*programs, status=1)  # the folders by default
    assert said.splitlines()[:-1] == ["DIFFERS lights/differ.pov", "DIFFERS objects/status.pov (exit status 0, unpatched 3)",
                                      "fails   objects/bad.pov (both, exit status 4)"] and not wrong
    assert re.match(r"1 of 4 scenes pixel-identical, \d+ s$", said.splitlines()[-1])
    assert check(*programs, "textures", "extra", status=0)[0].startswith("2 of 2 scenes")
    assert check("./one", "./one", tmp_path, status=0)[0].splitlines()[0] == "fails   objects/bad.pov (both, exit status 4)"
    assert check(*programs, "none", status=1)[0].startswith("0 of 0 scenes")
    assert "usage: check.sh PATCHED" in check("--help", status=0)[0] and "usage: check.sh PATCHED" in check("./one", "./two", status=2)[1]
    assert check("./three", "./two", tmp_path, status=2)[1] == "check.sh: ./three: no such program\n"
    assert check(*programs, "nowhere", status=2)[1] == f"check.sh: {tmp_path}/scenes/nowhere: no such folder\n"


def test_build_says_how_it_is_used():
    for words, status in ((["--help"], 0), (["-h"], 0), ([], 2), (["out"], 2)):
        done = subprocess.run([PATCHES / "build.sh", *words], text=True, capture_output=True, timeout=60)
        said, other = (done.stdout, done.stderr) if status == 0 else (done.stderr, done.stdout)
        assert done.returncode == status and said.startswith("usage: build.sh OUT LIBSHADE ARCHIVE") and not other, done


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
