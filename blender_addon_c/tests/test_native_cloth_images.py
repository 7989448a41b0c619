# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of one repeat of a cloth, for renderers that know no yarns."""

import numpy as np
import pytest

from native_scenes import native
from test_native_cloth import cloth
from test_native_cloth_made import WIF

COST = 0.35

ROUND = {"width": 0.8, "gap": 0.2, "curve": 0.5, "ridge": 0.0, "crimp": 0.0, "fuzz": 0.0}


def images(**given):
    made = native.cloth_images(cloth(**given))
    width, height = made["size"]
    planes = {word: made[word] and np.frombuffer(made[word], np.float32).reshape(height, width, 4)
              for word in ("tilt", "yarns", "tint") if made[word]}
    return made, planes


def test_round_yarns_by_hand():
    """Plain weave: half of sigma is the tilt, to either side, and 1 less its size the occlusion; beside a yarn the one below,
    and a gap where both end. Noise leaves no trace."""
    varied = {**ROUND, "slub": 0.8, "vary_tilt": 0.5, "along_tilt": 0.3, "vary_brightness": 0.5}
    made, planes = images(preset="linen", warp_yarn=varied, weft_yarn=varied)
    assert made["repeat"] == (2, 2) and made["size"] == (64, 64) and made["tint"] is None
    across, along = images(preset="gabardine")[0]["per_unit"]  # 44 ends and 22 picks a centimetre
    assert across == pytest.approx(2 * along) and made["per_unit"][0] == made["per_unit"][1]
    assert made["warp"]["slub"] == pytest.approx(0.8) and made["warp"]["share"] == pytest.approx(0.8)
    tilt, yarns = planes["tilt"], planes["yarns"]
    # of three points a texel
    place = (np.arange(96) + 0.5) / 96
    sigma = (2 * place - 1) / 0.8
    inside = np.abs(sigma).reshape(32, 3).max(1) < 1
    mean = sigma.reshape(32, 3).mean(1)
    lean = np.abs(0.5 * sigma).reshape(32, 3).mean(1)
    seen = {}
    for j in (0, 1):
        for i in (0, 1):
            cell = tilt[32 * j:32 * j + 32, 32 * i:32 * i + 32], yarns[32 * j:32 * j + 32, 32 * i:32 * i + 32]
            kind = "warp" if cell[1][16, 16, 0] > 0.5 else "weft"
            seen[i, j] = kind
            if kind == "weft":  # the same, with u and v exchanged
                cell = [part.swapaxes(0, 1)[..., [1, 0, 2]] for part in cell]
            across, mask = cell[0][16], cell[1][16]
            np.testing.assert_allclose(2 * across[inside, 0] - 1, 0.5 * mean[inside], atol=1e-5)
            np.testing.assert_allclose(across[inside, 1], 0.5, atol=1e-6)
            np.testing.assert_allclose(across[inside, 2], 1 - lean[inside], atol=1e-5)
            assert (mask[inside, 0] == 1).all() and (mask[:2, 1] == 1).all() and (mask[:2, 0] == 0).all()
            # of the texel that the yarn ends in, beside a gap, what is yarn counts: two of three columns of points
            np.testing.assert_allclose(cell[1][0, 3, :2], (2 / 3, 0), atol=1e-6)
            np.testing.assert_allclose(2 * cell[0][0, 3, 0] - 1, 0.5 * sigma[10:12].mean(), atol=1e-5)
            corner = cell[1][0, 0], cell[0][0, 0]
            assert (corner[0][:2] == 0).all() and corner[1][0] == corner[1][1] == 0.5 and corner[1][2] == 1
    assert seen[0, 0] == seen[1, 1] != seen[0, 1] == seen[1, 0]


def test_each_yarn_has_its_own_numbers():
    """The satin's glossy warp, and the other yarns that cross it."""
    made, _planes = images(preset="silk_charmeuse", warp=(0.1, 0.2, 0.3), weft=(0.6, 0.5, 0.4))
    row = native.cloth("silk_charmeuse")
    for yarn in ("warp", "weft"):
        for word in ("along", "across", "fibre"):
            assert made[yarn][word] == pytest.approx(row[yarn][word])
        width, gap = row[yarn]["width"], row[yarn]["gap"]
        assert made[yarn]["share"] == pytest.approx(width / (width + gap))
    assert made["warp"]["along"] != made["weft"]["along"]
    wide, _planes = images(preset="linen", warp_yarn={"width": 0.6, "gap": 0.2}, weft_yarn={"width": 1.2, "gap": 0.8})
    assert (wide["warp"]["share"], wide["weft"]["share"]) == pytest.approx((0.75, 0.6))
    for yarn, color in (("warp", (0.1, 0.2, 0.3)), ("weft", (0.6, 0.5, 0.4))):
        assert made[yarn]["kd"] == pytest.approx(color)


def test_a_draft_has_its_colours():
    """And its own repeat, 4 ends and 3 picks."""
    made, planes = images(preset="linen", draft=WIF, draft_name="three", draft_colors=True, warp_yarn=ROUND, weft_yarn=ROUND)
    assert made["repeat"] == (4, 3) and made["size"] == (128, 96)
    on_warp = planes["yarns"][..., 0] == 1
    np.testing.assert_allclose(planes["tint"][on_warp][:, :3], np.tile(np.array([200, 40, 60]) / 255, (on_warp.sum(), 1)), atol=1e-4)
    assert (planes["tint"][planes["yarns"][..., 1] == 1] > 0.9999).all()
    middles = planes["yarns"][16::32, 16::32, 0]
    assert middles.tolist() == [[1, 1, 0, 1], [0, 1, 0, 0], [1, 0, 1, 1]]  # as WIF says
    assert images(preset="linen", draft=WIF, draft_name="three")[0]["tint"] is None


def test_what_yarns_leave_one_another():
    """Of even light. Flat yarns all; round ones by docs/theory/conventions.md, "Shadows of yarns", by another quadrature."""
    flat = {**ROUND, "curve": 0.0}
    assert images(preset="linen", warp_yarn=flat, weft_yarn=flat)[0]["lit"] == pytest.approx(1, abs=1e-9)
    curve = 0.9
    round_ = {**ROUND, "curve": curve, "width": 1.0, "gap": 0.0}
    x = (np.arange(2000) + 0.5) / 1000 - 1  # across a yarn that fills its crossing: half of the cloth is of either kind
    up, lean = np.sqrt(1 - (curve * x) ** 2), curve**2 / 3
    z, turn = np.meshgrid((np.arange(200) + 0.5) / 200, (np.arange(100) + 0.5) / 100 * 2 * np.pi)
    flat_part, all_ = np.sqrt(1 - z * z), 0.0
    for wide in (flat_part * np.cos(turn), flat_part * np.sin(turn)):
        middle, reach = up.mean() * z, np.sqrt(3 * wide**2 * lean)
        low = np.maximum(middle - reach, 0)
        all_ = all_ + 0.5 * ((middle + reach) ** 2 - low**2) / (4 * reach)
    expected = (2 * z * np.minimum(1, z / all_)).mean()  # no tilt along the yarn varies
    assert expected < 0.985
    assert images(preset="linen", warp_yarn=round_, weft_yarn=round_)[0]["lit"] == pytest.approx(expected, abs=0.004)


def test_large_drafts():
    """At most 2048 texels a side."""
    text = WIF.replace("Threads=4", "Threads=1500")
    made, _planes = images(preset="linen", draft=text, draft_name="wide")
    assert made["repeat"] == (1500, 3) and made["size"] == (1500, 96)


@pytest.mark.parametrize("given", [{}, 3, {**cloth(), "preset": "chiffon"}, {**cloth(), "draft": "[WIF"}])
def test_malformed(given):
    with pytest.raises(ValueError):
        native.cloth_images(given)
