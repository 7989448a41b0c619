# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Fabric: its sockets, properties and drafts, in Blender 3.4 and 5.0."""

import subprocess

from blender_runs import BUILD


def test_cloth_in_blender(blender, tmp_path):
    """What is asserted inside; then the reference agrees with each dump."""
    assert "all asserted" in blender.run("cloth.py", tmp_path)
    dumps = sorted(tmp_path.glob("*.exr"))
    assert len(dumps) >= 4
    for dump in dumps:
        done = subprocess.run([BUILD / "shade", "check", dump], capture_output=True, text=True)
        assert done.returncode == 0 and "no metal" not in done.stdout, done.stdout + done.stderr
