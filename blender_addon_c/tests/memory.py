# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a render of eight large images takes beyond Blender's own, in the system's Blender and PyPI's.

    build/venv/bin/python blender_addon_c/tests/memory.py [--side 8192] [--version 3.4]

Blender holds all images before it is asked to render. Images are of bytes, each seen whole at about 16 texels a
pixel along either axis, by 16 samples. Exit status 0 if no version takes more than 3 bytes a texel of each, .75 of
what their bytes are (8192: 1.5 GiB).
"""

import argparse
import pathlib
import re
import sys
import tempfile

from blender_runs import Blender

IMAGES, MOST = 8, 1.5 * 2**30 / (8 * 8192**2)  # bytes a texel


def measure(version, side):
    """MiB: Blender's own, the most beyond it, what is left of that."""
    with tempfile.TemporaryDirectory() as home:
        folder = pathlib.Path(home) / "images"
        folder.mkdir()
        text = Blender(version, pathlib.Path(home) / "home").run("large_images.py", folder, side, seconds=None)
    return [float(part) for part in re.search(r"^MEMORY (\S+) (\S+) (\S+)$", text, re.M).groups()]


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--side", type=int, default=8192)
    words.add_argument("--version", nargs="+", default=["old", "new"])
    given = words.parse_args()
    limit, failed = MOST * IMAGES * given.side**2 / 2**20, False
    for version in given.version:
        own, beyond, left = measure(version, given.side)
        failed |= beyond > limit
        print(f"Blender {version}: {own:.0f} MiB its own, {beyond:.0f} beyond it at most (limit {limit:.0f}), "
              f"{left:.0f} after the render", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
