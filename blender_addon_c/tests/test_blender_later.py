# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender 5.2 adds to nodes: rendered as in its Cycles, or named."""

import pytest

COST = 10  # where there is a 5.2, as in .ci/run; else 0.1: skipped


@pytest.mark.parametrize("what", ["stock", "planted", "chosen", "unsure", "normals", "rounds", "thin", "dark", "data"])
def test_what_5_2_adds_is_rendered_or_named(blender52, tmp_path, what):
    assert "all asserted" in blender52.inside("later.py", what, tmp_path)
