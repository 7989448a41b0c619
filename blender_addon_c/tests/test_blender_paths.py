# SPDX-License-Identifier: GPL-3.0-or-later
"""Files as they are, against the Cycles of the same Blender: world, lamp, matt bodies and metal."""

import numpy as np
import pytest

from blender_runs import averaged, rgba

COST = 9.7


@pytest.mark.parametrize("floor", [False, True])
def test_a_new_file(blender, tmp_path, floor):
    """Nothing but the engine is chosen."""
    limit = 0.02 if floor else 0.005
    pictures = []
    for engine, samples in ("LIBSHADE", 24), ("CYCLES", 48):
        blender.scene("first_minute", tmp_path, dump="", engine=engine, samples=samples, floor=floor)
        pictures.append(averaged(tmp_path / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"relative error {apart:.4f}, means {ours.mean():.4f} {theirs.mean():.4f}")
    assert theirs.mean() > 0.05
    assert apart <= limit


def test_denoising(blender, tmp_path):
    """Few samples come near to many; where there is no Open Image Denoise, nothing is lost."""
    def picture(samples, denoise):
        _, text = blender.scene("first_minute", tmp_path, dump="", engine="LIBSHADE", floor=True,
                                samples=samples, denoise=denoise)
        return rgba(tmp_path / "picture.exr")[..., :3].astype(float), text

    (noisy, _), (clean, text) = (picture(4, denoise) for denoise in (False, True))
    missing = "Open Image Denoise was not found; the picture is as noisy as it was"
    if blender.version < "4":  # Debian has none
        assert missing in text
        np.testing.assert_allclose(noisy, clean, rtol=1e-4, atol=1e-5)  # 3.4 adds up normals in any order
        return
    assert missing not in text
    many, _ = picture(192, False)
    before, after = (((p - many) ** 2 / (many**2 + 1e-3)).mean() for p in (noisy, clean))
    print(f"error of 4 samples {before:.4f}, denoised {after:.4f}")
    assert after < before / 4 and abs(clean.mean() / noisy.mean() - 1) < 0.01
