# SPDX-License-Identifier: GPL-3.0-or-later
"""What later Blenders add to nodes: rendered as in their Cycles, or named."""

import pytest

COST = 9


@pytest.mark.parametrize("what", ["stock", "planted", "unknown_output", "every_node_is_known", "chosen", "unsure"])
def test_what_is_not_known_of_a_node_is_named(blender, tmp_path, what):
    assert "all asserted" in blender.inside("later.py", what, tmp_path)


@pytest.mark.parametrize("what", ["stock", "chosen", "normals", "rounds", "thin"])
def test_what_5_2_adds_is_rendered(blender52, tmp_path, what):
    assert "all asserted" in blender52.inside("later.py", what, tmp_path)
