# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits by depsgraph updates, in Blender 5.0, whose window no test has: what Rendered mode and F12 show of them."""

import re

COST = 6


def test_edits_show(blender_new, tmp_path):
    """Each of them, and as in a scene that was made so."""
    told = blender_new.run("redraw.py", tmp_path)
    seen = re.findall(r"^EDIT (\w+) (view|render) (\S+) (\S+)$", told, re.M)
    assert "\nDONE" in told and len(seen) >= 50, told[-3000:]
    for edit, where, changed, wrong in seen:
        # smooth normals of 5.0 are not the same to the last bit each time
        assert float(changed) > 5e-3 and float(wrong) < 1e-4, f"{edit} in the {where}: {changed} changed, {wrong} wrong"
