# SPDX-License-Identifier: GPL-3.0-or-later
"""What a viewport keeps of a scene while it is edited is what a fresh read of it finds."""

COST = 9.3


def test_kept_is_as_fresh(blender):
    told = blender.run("kept.py", 1, 200).splitlines()
    wrong = [line for line in told if line.startswith(("DIFFERENT", "Traceback"))]
    assert told[-1] == "SAME" and not wrong, "\n".join(told[-60:])
