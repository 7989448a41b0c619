# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages one by one: test_stages.c, beside the module."""

import subprocess

from native_scenes import MODULE

COST = 3.6


def test_stages():
    program = MODULE.parent / "test_stages"
    assert program.exists(), f"{program} is missing: run `make native`"
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
