# SPDX-License-Identifier: GPL-3.0-or-later
"""The Ambient Occlusion and Bevel nodes, against Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import averaged

COST = 11

CASES = {"near": {}, "the world's distance": {"distance": 0.0}, "inside": {"inside": True, "distance": 0.5},
         "local": {"only_local": True}, "tilted": {"normal": (0.6, -0.3, 0.7)}, "one ray": {"rays": 1, "distance": 9.0}}
BEVELS = {"wide": {"radius": 0.2}, "many": {"radius": 0.2, "rays": 8}, "bent": {"radius": 0.2, "normal": (0.3, -0.5, 0.7)}}


def both(blender, folder, options):
    pictures = []
    for engine in ("LIBSHADE", "CYCLES"):
        blender.scene("occluded", folder, engine=engine, dump="", **{"samples": 64, "rays": 4, **options})
        pictures.append(averaged(folder / "picture.exr"))
    return pictures


@pytest.mark.parametrize("case", CASES)
def test_what_stands_about_is_what_cycles_says(blender, tmp_path, case):
    ours, theirs = both(blender, tmp_path, CASES[case])
    assert theirs.std() > 0.02 * theirs.mean()  # something is occluded
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.005)
    assert np.abs(ours - theirs).mean() < 0.02 * theirs.mean()


@pytest.mark.parametrize("case", BEVELS)
def test_edges_are_as_round_as_in_cycles(blender, tmp_path, case):
    """And they are round: without the node they differ."""
    ours, theirs = both(blender, tmp_path, BEVELS[case])
    sharp, _ = both(blender, tmp_path, BEVELS[case] | {"radius": 0.0})
    assert np.abs(ours - theirs).mean() < 0.005 * theirs.mean()
    assert np.abs(sharp - theirs).mean() > 0.007 * theirs.mean()
