# SPDX-License-Identifier: AGPL-3.0-or-later
"""The patches as a series, the glue as C++, and the scenes that must not change."""
import os
import re
import subprocess
from pathlib import Path

import pytest

from conftest import ROOT

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
    assert "SPDX-License-Identifier: AGPL-3.0-or-later" in header
    assert len(re.search(r"Description: .+\n((?: .+\n)+)", header).group(1).split()) > 20


def test_series_is_complete_and_applied_without_fuzz():
    assert sorted(SERIES) == sorted(p.name for p in PATCHES.glob("*.patch"))
    quilt = dict(os.environ, QUILT_PATCHES=str(PATCHES), QUILT_SERIES=str(PATCHES / "series"), QUILT_PC=".pc-libshade")
    applied = subprocess.run(["quilt", "--quiltrc=-", "applied"], cwd=SOURCE, env=quilt, text=True, stdout=subprocess.PIPE)
    assert [Path(line).name for line in applied.stdout.split()] == SERIES
    # build.sh applied them with --fuzz=0; taking them off a copy must give the original files back
    check = subprocess.run(["quilt", "--quiltrc=-", "diff", "-z", "--no-timestamps"], cwd=SOURCE, env=quilt, text=True, stdout=subprocess.PIPE)
    assert check.stdout == "", "the tree has changes that are in no patch"


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.parametrize("name", sorted(p.name for p in (PATCHES / "glue").glob("*.cpp")))
def test_glue_compiles_without_a_warning(compiler, name, tmp_path):
    """Our files with every warning on; POV-Ray's headers count as the system's."""
    folder = tmp_path / "glue/backend"
    folder.mkdir(parents=True)
    (folder / "mdf").symlink_to(PATCHES / "glue")
    system = [SOURCE / d for d in ("unix", "source", "source/backend", "source/base", "source/frontend", "vfe", "vfe/unix")]
    done = subprocess.run([compiler, "-DHAVE_CONFIG_H", "-std=gnu++17", "-fsyntax-only", "-Wall", "-Wextra", "-Wconversion", "-Werror",
                           f"-I{tmp_path}/glue", f"-I{ROOT}/libshade/include", f"-I{ROOT}/libshade",
                           *[f"-isystem{d}" for d in system], "-isystem/usr/include/OpenEXR", "-isystem/usr/include/Imath",
                           str(folder / "mdf" / name)], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, done.stdout
