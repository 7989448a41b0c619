# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages one by one, and the door to the system: test_stages.c and test_system.c, beside the module."""

import subprocess

import pytest

from native_scenes import MODULE

COST = 3.6


@pytest.mark.parametrize("name", ["test_stages", "test_system"])
def test_programs(name):
    program = MODULE.parent / name
    assert program.exists(), f"{program} is missing: run `make native`"
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
