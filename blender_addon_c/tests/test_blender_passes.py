# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes beside the picture, by view layer, in a multilayer file."""

import math

import numpy as np

from blender_runs import read_picture

WANTED = ("z", "position", "normal", "uv", "object_index", "material_index", "mist")


def test_passes_of_two_view_layers(blender, tmp_path):
    told, text = blender.scene("passes", tmp_path, dump="", passes=WANTED)
    names, pixels = read_picture(tmp_path / "picture.exr")
    full, empty = ({name.split(".", 1)[1]: pixels[..., k] for k, name in enumerate(names)
                    if name.startswith(layer + ".")} for layer in told["layers"])
    assert set(full) == set(empty) >= {"Depth.Z", "Position.X", "Normal.Z", "UV.U", "UV.A",
                                       "IndexOB.X", "IndexMA.X", "Combined.A"}
    assert (empty["Combined.A"] == 0).all() and (empty["Depth.Z"] == 1e10).all()
    assert "passes that are not rendered: Mist" in text
    # pixels that the plate covers; each looks along -z, from (x, y, 3)
    whole = full["Combined.A"] == 1
    assert 20 < whole.sum() < 80 and (full["Depth.Z"][full["Combined.A"] == 0] == 1e10).all()
    x, z = full["Position.X"], full["Position.Z"]
    middle = (np.arange(16) + 0.5) / 8 - 1
    assert (abs(x - middle)[whole] <= 1 / 16 + 1e-6).all()  # its first sample, not its middle
    assert (abs(full["Position.Y"] + middle[:, None])[whole] <= 1 / 16 + 1e-6).all()
    np.testing.assert_allclose(z[whole], (1 - math.tan(0.5) * x)[whole], atol=1e-6)
    np.testing.assert_allclose(full["Depth.Z"][whole], (3 - z)[whole], atol=1e-6)
    for axis, value in zip("XYZ", (math.sin(0.5), 0, math.cos(0.5))):
        np.testing.assert_allclose(full[f"Normal.{axis}"][whole], value, atol=1e-6)
    # u is the mean over the pixel, so that of its middle, but for the samples' own
    np.testing.assert_allclose(full["UV.U"][whole],
                               np.broadcast_to(0.5 + middle / math.cos(0.5), (16, 16))[whole], atol=0.01)
    assert (full["UV.A"][whole] == 1).all()
    assert (full["IndexOB.X"][whole] == 7).all() and (full["IndexMA.X"][whole] == 3).all()
    assert (empty["IndexOB.X"] == 0).all()
