# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes in the picture, shadow catchers and what is thin, against the Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import averaged, read_picture, rgba

COST = 12


@pytest.mark.parametrize("transparent, clear", [(True, False), (False, False), (True, True)])
def test_holdouts(blender, tmp_path, transparent, clear):
    """clear: through a pane of glass that hides nothing from the film, too."""
    pictures = []
    for engine, samples in ("LIBSHADE", 256 if clear else 64), ("CYCLES", 512 if clear else 128):
        blender.scene("holes", tmp_path, dump="", engine=engine, samples=samples, transparent=transparent, clear=clear)
        pixels = rgba(tmp_path / "picture.exr").astype(float)
        pictures.append(pixels.reshape(6, 4, 24, 4, 4).mean((1, 3)))
    ours, theirs = pictures
    apart = np.abs(ours - theirs)
    print(f"colour {apart[..., :3].mean() / theirs[..., :3].mean():.4f}, alpha {apart[..., 3].max():.4f}")
    if transparent and not clear:
        assert set(np.unique(theirs[..., 3].round(1))) >= {0.0, 0.3, 0.5, 0.7}
    assert apart[..., 3].max() < 0.02 and apart[..., :3].mean() < 0.01 * theirs[..., :3].mean()


@pytest.mark.parametrize("transparent, apart", [(True, False), (False, False), (False, True)])
def test_shadow_catchers(blender, tmp_path, transparent, apart):
    """The picture, or, if they are wanted apart, that without shadows and the pass of what these leave."""
    pictures = []
    parts = ["Combined.R", "Combined.G", "Combined.B", "Combined.A",
             *(f"Shadow Catcher.{end}" for end in "RGB" if apart)]
    for engine, samples in ("LIBSHADE", 64), ("CYCLES", 128):
        blender.scene("caught", tmp_path, dump="", engine=engine, samples=samples, transparent=transparent, apart=apart)
        names, pixels = read_picture(tmp_path / "picture.exr")
        names = [".".join(name.split(".")[-2:]) for name in names]
        pixels = pixels[..., [names.index(part) for part in parts]].astype(float)
        pictures.append(pixels.reshape(12, 4, 16, 4, len(parts)).mean((1, 3)))
    ours, theirs = pictures
    off = np.abs(ours - theirs)
    print(f"colour {off[..., :3].mean() / theirs[..., :3].mean():.4f}, others {off[..., 3:].mean((0, 1)).max():.4f}")
    assert not transparent or 0.1 < theirs[..., 3].mean() < 0.9
    assert off[..., 3].mean() < 0.01 and off[..., :3].mean() < 0.015 * theirs[..., :3].mean()
    assert not apart or (theirs[..., 4:].min() < 0.6 and off[..., 4:].mean() < 0.008)


# ---- hair, curves and points are there, and as thick


@pytest.mark.parametrize("what", ["hair", "curves", "points"])
def test_strands(blender, tmp_path, what):
    """Curves are metal with strokes along them."""
    if what == "curves" and blender.version < "4":
        return  # Python cannot make any there
    pictures = []
    for engine, samples in ("LIBSHADE", 64), ("CYCLES", 128):
        _, text = blender.scene("hairy", tmp_path, dump="", engine=engine, samples=samples, what=what, strokes=what == "curves")
        pictures.append(averaged(tmp_path / "picture.exr"))
        if engine == "LIBSHADE":
            assert "Warning: libshade" not in text
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    orange = [(p[..., 0] - p[..., 2]).sum() for p in pictures]  # what they alone are
    ours_alone, theirs_alone = (p[..., 0] - p[..., 2] for p in pictures)
    alone = np.abs(ours_alone - theirs_alone).sum() / theirs_alone.sum()
    print(f"{what}: relative error {apart:.4f}, orange {orange[0]:.3f} {orange[1]:.3f}, {alone:.4f} apart")
    assert orange[1] > 1 and abs(orange[0] / orange[1] - 1) < 0.08 and apart < 0.02 and alone < 0.11


def test_strands_of_no_numbers(blender_new, tmp_path):
    blender_new.scene("hairy", tmp_path, dump="", engine="LIBSHADE", samples=4, what="curves", broken=True)
    assert np.isfinite(rgba(tmp_path / "picture.exr")).all()
