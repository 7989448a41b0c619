# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Fabric: its sockets, properties and drafts, in Blender 3.4 and 5.0."""

import subprocess

import numpy as np
import pytest

from blender_runs import BUILD, Dump


def test_cloth_in_blender(blender, tmp_path):
    """What is asserted inside; then the reference agrees with each dump."""
    assert "all asserted" in blender.run("cloth.py", tmp_path)
    dumps = sorted(tmp_path.glob("*.exr"))
    assert len(dumps) >= 4
    for dump in dumps:
        done = subprocess.run([BUILD / "shade", "check", dump], capture_output=True, text=True)
        assert done.returncode == 0 and "no metal" not in done.stdout, done.stdout + done.stderr
    # ends and picks of denim, 26 and 17 a centimetre, as large as the object and before it is stretched
    for name, times in (("real", 1.0), ("stretched", 0.5)):
        planes = Dump(tmp_path / f"{name}.exr")
        place, point = planes["uv"][planes.hit], planes["P"][planes.hit]
        for axis, per_metre in ((0, 2600 * times), (1, 1700)):
            assert np.ptp(place[:, axis]) / np.ptp(point[:, axis]) == pytest.approx(per_metre, rel=2e-3), (name, axis)
