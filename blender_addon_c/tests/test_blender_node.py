# SPDX-License-Identifier: GPL-3.0-or-later
"""The metal node: its properties, its files, and what other renderers make of it."""

import pytest

from blender_runs import difference, rgba


def test_node(blender, tmp_path):
    text = blender.run("node.py", tmp_path / "node.blend")
    assert "all asserted" in text


@pytest.mark.parametrize("converted", [False, True])
def test_cycles_renders_it(blender, tmp_path, converted):
    """Cycles sees an ordinary metal: as node, and as plain group, the same picture."""
    blender.scene("cycles", tmp_path, converted=converted, dump="")
    picture = rgba(tmp_path / "picture.exr")
    blender.scene("cycles", tmp_path, converted="principled", dump="")
    principled = rgba(tmp_path / "picture.exr")
    assert principled[..., :3].max() > 0.5
    assert difference(picture, principled) < 1e-4
