# SPDX-License-Identifier: GPL-3.0-or-later
"""Stereoscopy: what each eye sees, against the Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import averaged, read_picture

COST = 7.4

EYES = {
    "off axis": {"stereo": {"pivot": "CENTER"}, "camera": {"shift_x": 0.1}},
    "toe in": {"stereo": {"pivot": "RIGHT", "convergence_mode": "TOE"}},
    "parallel, tall": {"stereo": {"convergence_mode": "PARALLEL"}, "camera": {"sensor_fit": "VERTICAL", "shift_x": -0.2}, "aspect": 1.4},
    "off axis, tall": {"stereo": {"pivot": "CENTER"}, "camera": {"sensor_fit": "VERTICAL"}, "aspect": 1.4},
    "even": {"stereo": {"pivot": "CENTER"}, "camera": {"type": "ORTHO", "ortho_scale": 4}},
    "all around": {"stereo": {"pivot": "CENTER"}, "camera": {"type": "PANO"}},
    "two cameras": {"right": 70.0},
}


@pytest.mark.parametrize("name", EYES)
def test_each_eye_sees_its_own(blender, tmp_path, name):
    pictures = []
    for engine in "CYCLES", "LIBSHADE":
        _, told = blender.scene("eyes", tmp_path, dump="", engine=engine, **EYES[name])
        pictures.append(averaged(tmp_path / "picture.exr"))
    theirs, ours = pictures
    half = theirs.shape[1] // 2
    assert np.abs(theirs[:, :half] - theirs[:, half:]).mean() > 0.02 * theirs.mean()
    print(f"{name}: {np.abs(ours - theirs).mean() / theirs.mean():.4f}")
    assert np.abs(ours - theirs).mean() <= 0.005 * theirs.mean()
    assert "stereo" not in told.lower()


def test_spherical_stereo_is_named(blender, tmp_path):
    _, told = blender.scene("eyes", tmp_path, dump="", engine="LIBSHADE", camera={"type": "PANO"},
                            stereo={"use_spherical_stereo": True})
    assert told.count("Spherical Stereo is not supported") == 1


def test_passes_have_all_eyes(blender, tmp_path):
    blender.scene("eyes", tmp_path, dump="", engine="LIBSHADE", passes=["z", "normal"], **EYES["toe in"])
    names, pixels = read_picture(tmp_path / "picture.exr")
    for name in ("Normal", "Y"), ("Depth", "Z"), ("Combined", "R"):  # from 5.0 on each eye has parts of its own
        left, right = (pixels[..., k] for k, n in enumerate(names) if n.split(".")[1] == name[0] and n.endswith("." + name[1]))
        known = (left < 1e9) & (right < 1e9)
        assert left[known].std() > 0.01 and np.abs(left - right)[known].mean() > 0.01
