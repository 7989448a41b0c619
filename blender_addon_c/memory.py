# SPDX-License-Identifier: GPL-3.0-or-later
"""Is there room for a picture? Blender does not look whether it got what it asked for, and the kernel kills what takes too much."""

import numpy as np

from .export import SceneError

_GIBIBYTE = 1 << 30


def ask_for(width, height, channels):
    """SceneError where a picture and its passes, of so many numbers a pixel, cannot be."""
    count = width * height
    # Blender's, of what is rendered and of the whole; ours, and that which is handed over
    needed, free = 4 * count * (3 * channels + 4), _free()
    said = f"out of memory: {width} × {height} pixels and their passes take {needed / _GIBIBYTE:,.0f} GiB"
    if free is not None and needed > free:
        raise SceneError(f"{said}, {free / _GIBIBYTE:,.0f} GiB are free")
    try:
        np.empty(2 * count * channels + 4 * count, np.float32)  # nothing is written to it: it costs no memory
    except MemoryError:
        raise SceneError(said) from None


def _free():
    """Bytes, as the kernel tells them, or None."""
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            told = dict(line.split(":") for line in file)
        return 1024 * sum(int(told[name].split()[0]) for name in ("MemAvailable", "SwapFree"))
    except (OSError, KeyError, ValueError):
        return None
