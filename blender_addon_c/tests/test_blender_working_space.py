# SPDX-License-Identifier: GPL-3.0-or-later
"""Files whose working space is not linear Rec. 709, against the Cycles of the same Blender; presets against themselves."""

import re

import numpy as np
import pytest

from blender_runs import ROOT, read_picture

COST = 8

# Linear Rec. 709 and D65 to ACEScg (ACES primaries AP1, white of ACES, Bradford).
ACESCG = np.array([[0.613097, 0.339523, 0.047379], [0.070194, 0.916354, 0.013452], [0.020616, 0.109570, 0.869815]])


@pytest.fixture
def blender(blender_new):
    return blender_new


def seen(path):
    """A picture's colours."""
    names, pixels = read_picture(path)
    at = [next(k for k, name in enumerate(names) if name.endswith(f"Combined.{color}")) for color in "RGB"]
    return pixels[..., at].astype(float)


def colored_draft(path):
    """A draft in red and green."""
    text = (ROOT / "examples/weaves/houndstooth.wif").read_text(encoding="utf-8")
    rows = iter(("1=10,200,40", "2=220,20,30"))
    head, _, rest = text.partition("[COLOR TABLE]")
    path.write_text(head + "[COLOR TABLE]" + re.sub(r"^[12]=.*$", lambda _: next(rows), rest, count=2, flags=re.M), encoding="utf-8")


def test_colors_of_a_wide_file(blender, tmp_path):
    colored_draft(tmp_path / "draft.wif")
    text = blender.run("working_space.py", "ACEScg", tmp_path)
    assert "not supported" not in text
    names = re.search(r"^ROWS (.*)$", text, re.M).group(1).split()
    ours, theirs = (np.split(seen(tmp_path / f"shown_{engine}.exr")[::-1], len(names)) for engine in ("libshade", "cycles"))
    off = {name: np.abs(a - b).mean() / b.mean() for name, a, b in zip(names, ours, theirs)}
    assert max(off.values()) < 0.006, off
    ours, theirs = (seen(tmp_path / f"lit_{engine}.exr") for engine in ("libshade", "cycles"))
    assert np.abs(ours - theirs)[:4].mean() < 0.005 * theirs[:4].mean()  # the sky
    for half in np.s_[8:24, 4:20], np.s_[8:24, 28:44]:
        assert np.allclose(ours[half].mean((0, 1)), theirs[half].mean((0, 1)), rtol=0.01), half
    # the same colours by other numbers; metals are by what they reflect head-on and at 82 degrees
    names = "preset_Rec.709", "preset_ACEScg", "appended"
    rows = (np.split(seen(tmp_path / f"{name}.exr")[2:-2], 5, 1) for name in names)
    for k, (plain, wide, appended) in enumerate(zip(*rows)):
        expected = plain @ ACESCG.T
        off = [np.abs(one - expected).mean() / expected.mean() for one in (wide, appended, plain)]
        assert max(off[:2]) < 0.003 < off[2], (k, off)
