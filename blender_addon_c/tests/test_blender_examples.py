# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands of examples in PyPI's bpy, where the add-on is an extension."""

import os

import OpenImageIO as oiio

from blender_runs import ROOT

COST = 1.6

# others are made in test_blender_example_scenes.py, and rendered in make soak but for the drape, which takes minutes
NAMES = ["pan"] + (["bolts", "cloth", "dial", "groove", "jacket", "scratches", "suzanne", "table"] if "BOTH" in os.environ else [])


def test_examples_are_made(blender_new, tmp_path):
    text = blender_new.run("examples.py", tmp_path, *(ROOT / "examples/blender" / name / "make_scene.py" for name in NAMES))
    assert "Not rendered as in Cycles" not in text and "not supported" not in text
    for name in NAMES:
        pixels = oiio.ImageBuf(str(tmp_path / f"{name}.png")).get_pixels()
        assert pixels.shape[0] >= 6 and pixels[..., :3].std() > 0.02, name
