# SPDX-License-Identifier: GPL-3.0-or-later
"""Files as they are, against the Cycles of the same Blender: world, lamp, matt bodies and metal."""

import numpy as np
import pytest

from blender_runs import rgba


def averaged(path):
    """Means of 4 x 4 pixels."""
    pixels = rgba(path)[..., :3].astype(float)
    height, width = (side // 4 for side in pixels.shape[:2])
    return pixels[:4 * height, :4 * width].reshape(height, 4, width, 4, 3).mean((1, 3))


@pytest.mark.parametrize("floor", [False, True])
def test_a_new_file(blender, tmp_path, floor):
    """Nothing but the engine is chosen. From 4.0 on Cycles dims the body of a Principled BSDF by
    what its surface reflects, a twentieth, which is not done here yet."""
    limit = (0.03 if floor else 0.02) if blender.version < "4" else (0.06 if floor else 0.05)
    pictures = []
    for engine, samples in ("LIBSHADE", 64), ("CYCLES", 128):
        blender.scene("first_minute", tmp_path, dump="", engine=engine, samples=samples, floor=floor)
        pictures.append(averaged(tmp_path / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"relative error {apart:.4f}, means {ours.mean():.4f} {theirs.mean():.4f}")
    assert theirs.mean() > 0.05
    assert apart <= limit
