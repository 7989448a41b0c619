# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of AOV Output nodes, against what they say and the Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import read_picture

COST = 17


def of(path, name):
    """Channels of a pass, in the order R G B A or X."""
    names, pixels = read_picture(path)
    return np.stack([pixels[..., names.index(f"ViewLayer.{name}.{channel}")] for channel in ("RGBA" if name in ("color", "muted") else "X")], -1)


def test_nodes_say_their_passes(blender, tmp_path):
    """Of the first surface; through a pane as much as it lets through."""
    passes = {}
    for engine in "CYCLES", "LIBSHADE":
        _, told = blender.scene("aovs", tmp_path, dump="", engine=engine)
        passes[engine] = {name: of(tmp_path / "picture.exr", name) for name in ("color", "value", "muted", "missing")}
    assert "are not rendered" not in told
    middle = (np.arange(32) + 0.5) / 8 - 2  # rows from above
    x, y = np.meshgrid(middle, -middle)
    there = (x < 0) & (abs(y) < 1)
    share = there * np.where(y < 0, 0.7, 1.0)
    true = {"color": np.stack([(x + 2) / 2 * share, (y + 1) / 2 * share, 0 * x, share], -1), "value": 0.25 * share[..., None],
            "muted": share[..., None] * np.full(4, float(blender.version >= "5")), "missing": 0}
    for name, wanted in true.items():
        np.testing.assert_allclose(passes["CYCLES"][name], wanted, atol=0.1)
        np.testing.assert_allclose(passes["LIBSHADE"][name], wanted, atol=0.1)  # 64 samples choose whether they go on
        means = [passes[engine][name].mean((0, 1)) for engine in passes]
        np.testing.assert_allclose(*means, atol=2e-3)


def test_what_is_below_zero_is_kept(blender, tmp_path):
    lowest = []
    for engine in "CYCLES", "LIBSHADE":
        blender.scene("aovs", tmp_path, dump="", engine=engine, below=True)
        lowest.append(of(tmp_path / "picture.exr", "value").min())
    assert lowest == [-0.25, -0.25]


@pytest.mark.parametrize("distance, caught", [(10, False), (0.3, False), (0, False), (None, False), (10, True)])
def test_ambient_occlusion(blender, tmp_path, distance, caught):
    """By the normals of matt shaders, whatever else the surface is; an object that is held out says nothing. As far as the world
    says, without a world (None) as far as the scene goes. Shadow catchers (caught: the floor) are as other objects."""
    if caught and blender.version < "4":
        pytest.skip("Blender 3.4 counts them twice")
    pictures = []
    for engine in "CYCLES", "LIBSHADE":
        _, told = blender.scene("occlusion", tmp_path, dump="", engine=engine, distance=distance, caught=caught)
        names, pixels = read_picture(tmp_path / "picture.exr")
        name = "Ambient Occlusion" if blender.version >= "5" else "AO"
        pictures.append(np.stack([pixels[..., names.index(f"ViewLayer.{name}.{channel}")] for channel in "RGB"], -1))
    assert "are not rendered" not in told and (pictures[1] <= 1).all()
    theirs, ours = (picture.reshape(12, 4, 16, 4, 3).mean((1, 3)) for picture in pictures)
    print(f"apart {np.abs(ours - theirs).mean() / theirs.mean():.4f}, mean {ours.mean() / theirs.mean():.4f}")
    assert theirs.min() < 0.1 and (distance == 0 or theirs.mean() < 0.95)  # the hole; near the balls
    assert np.abs(ours - theirs).mean() < 0.006 * theirs.mean() and np.abs(ours - theirs).max() < 0.04


def test_light_groups(blender, tmp_path):
    """What is of a group lights its pass alone: a lamp, a world, one of two objects of a material."""
    means = {}
    for engine in "CYCLES", "LIBSHADE":
        _, told = blender.scene("groups", tmp_path, dump="", engine=engine)
        names, pixels = read_picture(tmp_path / "picture.exr")
        for name in "near", "far":
            picture = np.stack([pixels[..., names.index(f"ViewLayer.Combined_{name}.{channel}")] for channel in "RGB"], -1)
            means[engine, name] = picture.reshape(8, 4, 12, 4, 3).mean((1, 3))
    assert "are not rendered" not in told
    for name in "near", "far":
        theirs, ours = means["CYCLES", name], means["LIBSHADE", name]
        print(f"{name}: apart {np.abs(ours - theirs).mean() / theirs.mean():.4f} of {theirs.mean():.3f}")
        assert theirs.mean() > 0.2 and np.abs(ours - theirs).mean() < 0.01 * theirs.mean()
