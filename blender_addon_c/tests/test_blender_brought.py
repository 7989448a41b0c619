# SPDX-License-Identifier: GPL-3.0-or-later
"""What files of others are full of, against the Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import averaged, rgba

COST = 27

CASES = {"alpha of bytes": {"what": "alpha", "floats": False}, "alpha of floats": {"what": "alpha", "floats": True},
         **{f"alpha of files of {bits} bits": {"what": "alpha", "floats": bits == 16, "bits": bits} for bits in (8, 16)},
         **{what: {"what": what} for what in ("spaces", "groups", "colors", "nothing", "objects", "instancers", "islands", "bright", "tiles", "exposure",
                                           "world", "windows", "lost", "taken", "cloud", "strands", "on_instancers", "smoke", "deep",
                                           "normals", "edges", "particles", "hidden")}}


@pytest.mark.parametrize("name", CASES)
def test_what_is_brought_looks_as_in_cycles(blender, tmp_path, name):
    compare(blender, tmp_path, name)


def test_attributes_of_instances_that_nodes_made(blender_new, tmp_path):
    compare(blender_new, tmp_path, "nodes_tell")


def compare(blender, tmp_path, name):
    pictures = []
    for engine in ("LIBSHADE", "CYCLES"):
        blender.scene("brought", tmp_path, dump="", engine=engine, where=str(tmp_path), **CASES.get(name, {"what": name}))
        pictures.append(rgba(tmp_path / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs)[..., :3].mean() / theirs[..., :3].mean()
    print(f"{name}: relative error {apart:.4f}")
    assert theirs[..., :3].mean() > 0.01 and apart < 0.02
    assert np.abs(ours - theirs)[..., 3].mean() < 0.01


@pytest.mark.parametrize("output", ["Intercept", "Random", "Length", "Thickness"])
def test_hair_tells_of_itself(blender, tmp_path, output):
    pictures = []
    for engine, samples in ("LIBSHADE", 64), ("CYCLES", 128):
        blender.scene("hairy", tmp_path, dump="", engine=engine, samples=samples, what="hair", told=output)
        pictures.append(averaged(tmp_path / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"{output}: relative error {apart:.4f}, mean {ours.mean() / theirs.mean():.4f}")
    assert apart < 0.02
