# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders leave nothing behind: a hundred in one process, of scenes that differ."""

import re

import numpy as np

COST = 12

RENDERS = 100


def test_a_hundred_renders_leak_nothing(blender):
    """One of them needs some MiB; Blender's own memory goes up and down by 20."""
    told = re.findall(r"^RENDERED (\w+) ([\d.]+)$", blender.run("leaks.py"), re.M)
    assert [how for how, _ in told] == ["error" if (k + 1) % 10 == 0 else "finished"
                                        for k in range(RENDERS)]
    memory = np.array([float(mib) for _, mib in told])
    growth = np.median(memory[-20:]) - np.median(memory[20:40])
    print(f"{growth:.1f} MiB more after {RENDERS} renders")
    assert growth < 30
