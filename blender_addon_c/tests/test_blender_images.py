# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of many files, against the Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import Dump, rgba

COST = 6.8

FRAMES = {"before": {"frame": 1}, "first": {"frame": 2}, "later": {"frame": 3}, "last": {"frame": 9},
          "around": {"frame": 5, "cyclic": True}, "moved": {"frame": 2, "offset": 1},
          "as it is": {"frame": 3, "refresh": False}}
CASES = {"tiles": {}, "packed tiles": {"packed": True},
         **{f"{kind} {name}": {"source": kind.upper(), **frame} for kind in ("sequence", "movie") for name, frame in FRAMES.items()}}


@pytest.mark.parametrize("name", CASES)
def test_files_are_those_of_cycles(blender, tmp_path, name):
    pictures = []
    for engine in ("LIBSHADE", "CYCLES"):
        folder = tmp_path / engine
        folder.mkdir()
        options = {"where": str(folder), **CASES[name]}
        if engine == "LIBSHADE":
            blender.scene("many_files", tmp_path, engine=engine, **options)
            pictures.append(Dump(tmp_path / "dump.exr")["Color"])
        else:
            blender.scene("many_files", tmp_path, engine=engine, dump="", **options)
            pictures.append(rgba(tmp_path / "picture.exr")[..., :3])
    ours, theirs = pictures
    assert theirs.std() > 0.1
    np.testing.assert_allclose(ours, theirs, atol=2e-3)


@pytest.mark.parametrize("floats", [False, True])
def test_large_images_look_the_same_from_files(blender, tmp_path, floats):
    pictures = []
    for in_file in False, True:
        told, _ = blender.scene("held_image", tmp_path, dump="", floats=floats, in_file=in_file)
        assert told["files"] == in_file
        pictures.append(rgba(tmp_path / "picture.exr"))
    assert pictures[0][..., :3].std() > 0.1
    np.testing.assert_array_equal(*pictures)
