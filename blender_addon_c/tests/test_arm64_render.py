# SPDX-License-Identifier: GPL-3.0-or-later
"""shade-render of `make check-arm64`, run by qemu: the pictures of x86-64. Skipped where it is not built."""

import os
import shutil

import pytest

import damaged
from blender_runs import BUILD
from shade_render import run, scene_file
from test_windows_render import both, script_of

COST = 0.02  # skipped in make check; else 250

TOOL = BUILD / "arm64/shade-render"
LIBRARIES = [str(BUILD / "arm64/debian" / folder / "aarch64-linux-gnu") for folder in ("usr/lib", "lib")]
pytestmark = pytest.mark.skipif("BOTH" not in os.environ or not (TOOL.exists() and shutil.which("qemu-aarch64")),
                                reason="takes minutes: make check-arm64")


@pytest.fixture(scope="module")
def tool(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm64") / "run"
    path.write_text(f"#!/bin/sh\nexec qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH={':'.join(LIBRARIES)} {TOOL} \"$@\"\n")
    path.chmod(0o755)
    return path


def test_it_takes_neon(tool):
    assert "(neon)" in run("--version", tool=tool).stdout


@pytest.mark.parametrize("number", range(3))
def test_pictures(tool, tmp_path, number):
    """Metal, cloth, matt, glass of both light and shadow; motion, mattes and other passes."""
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", damaged.whole_scenes()[number])
    both(tool, tmp_path, path, "--seed", 4294967295, "--samples", 16)


@pytest.mark.parametrize("name, words, share", [("factory", (), 0.999), ("plate", (), 0.999), ("pan", ("--passes", "Combined"), 0.997),
                                                ("jacket", ("--samples", 2), 0.999)])
def test_saved_scenes(tool, blender_old, tmp_path, name, words, share):
    """On the pan's fine bumps paths part where sums are rounded otherwise: a few pixels are off by a tenth of a percent, and more of
    what little light goes round more than once."""
    blender_old.run("saved.py", tmp_path, *script_of(name, tmp_path))
    both(tool, tmp_path, tmp_path / "saved.shscene", *words, share=share)
