# SPDX-License-Identifier: GPL-3.0-or-later
"""Awkward scenes by chance are rendered or refused with a reason: no crash, no hang, no NaN."""

import soak

COST = 12


def test_awkward_scenes_render_or_say_why_not(blender, tmp_path):
    """25 of those that `make soak` tries 500 of."""
    ends = {}
    for seed, how, said in soak.seeds(blender, tmp_path, 0, 25):
        ends[seed] = how
        assert soak.good(how), f"seed {seed}: {how}\n{said[-3000:]}"
    assert sorted(ends) == list(range(25))
