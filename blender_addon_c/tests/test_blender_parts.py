# SPDX-License-Identifier: GPL-3.0-or-later
"""Small parts of the add-on, in Blender 3.4 and 5.0, against what is known of them."""

COST = 10


def test_parts(blender, tmp_path):
    assert "all asserted" in blender.inside("parts.py", tmp_path)


def test_small_functions(blender):
    assert "all asserted" in blender.inside("small.py")


def test_formulas(blender_old):
    assert "all asserted" in blender_old.inside("formulas.py")


def test_what_is_told(blender):
    assert "all asserted" in blender.inside("told.py")
