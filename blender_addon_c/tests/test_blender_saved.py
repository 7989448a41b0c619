# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that Blender saves are rendered by shade-render to the bit as in Blender, all passes of them."""

import json
import os

import numpy as np
import OpenImageIO as oiio
import pytest

from blender_runs import ROOT
from shade_render import assert_same, channels, made, parts_of
from test_blender_passes import WANTED

COST = 11

EXAMPLES = ROOT / "examples/blender"
# in make soak all but the drape, which takes minutes to make
NAMES = ["pan", "table"] + (["bolts", "cloth", "dial", "groove", "jacket", "scratches", "suzanne"] if "BOTH" in os.environ else [])


def names_in(path):
    """What a file's header says of Cryptomatte."""
    return {field.name: field.value for field in oiio.ImageBuf(str(path)).spec().extra_attribs if field.name.startswith("cryptomatte/")}


@pytest.mark.parametrize("name", NAMES)
def test_an_example_is_rendered_as_in_blender(blender_old, tmp_path, name):
    blender_old.run("saved.py", tmp_path, EXAMPLES / name / "make_scene.py", tmp_path / ("x.blend" if name == "suzanne" else "x.png"))
    path = tmp_path / "saved.shscene"
    (header, arrays), (asked, others) = (parts_of(tmp_path / f"{name}.shscene") for name in ("saved", "operator"))
    assert header["pictures"] == asked["pictures"] and len(arrays) == len(others)
    for a, b in zip(arrays, others):  # Blender's threads sum normals in any order
        np.testing.assert_allclose(a, b, rtol=1e-4, atol=1e-5)
    whole = channels(tmp_path / "saved.exr")
    assert len(whole) > 100 and np.ptp(whole["ViewLayer.Combined.R"]) > 0
    for threads in (1, 2, 3):
        assert_same(made(tmp_path, path, "--threads", threads), whole)
    names = names_in(tmp_path / "ours.exr")
    assert names == names_in(tmp_path / "saved.exr") and len(names) == 12 and all(names.values())
    for x, y, width, height in ((0, 0, 23, 17), (23, 0, 41, 17), (0, 17, 64, 23)):
        tile = made(tmp_path, path, "--tile", f"{x},{y},{width},{height}")
        assert_same(tile, {name: np.ascontiguousarray(pixels[y:y + height, x:x + width]) for name, pixels in whole.items()})


def test_each_view_layer_has_a_file(blender_new, tmp_path):
    told, _ = blender_new.scene("passes", tmp_path, {"LIBSHADE_SCENE": str(tmp_path / "s.shscene")}, dump="", passes=WANTED)
    found = [made(tmp_path, tmp_path / f"s-{layer}.shscene") for layer in told["layers"]]
    whole = channels(tmp_path / "picture.exr")
    assert_same(found[0] | found[1], {name: pixels for name, pixels in whole.items() if not name.startswith("Composite")})


def test_where_none_can_be_saved_is_said(blender_old, tmp_path):
    text = blender_old.run("saved.py", tmp_path / "missing", EXAMPLES / "table/make_scene.py", tmp_path / "x.png", status=3)
    assert "the scene cannot be saved" in text and "missing" in text


def test_shadow_catchers_are_refused(blender_new, tmp_path):
    """They are composed of several pictures."""
    text = blender_new.run("scenes.py", env={"LIBSHADE_SCENE": str(tmp_path / "s.shscene")}, status=None, stdin=json.dumps(
        {"name": "caught", "dump": "", "options": {"picture": str(tmp_path / "picture.exr"), "samples": 1, "transparent": True,
                                                   "apart": False, "engine": "LIBSHADE"}}) + "\n")
    assert "a scene with shadow catchers cannot be saved" in text and not list(tmp_path.glob("s*"))
