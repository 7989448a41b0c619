# SPDX-License-Identifier: GPL-3.0-or-later
"""How long Rendered mode takes to show an edit of a large mesh, in a window of the system's Blender.

    build/venv/bin/python blender_addon_c/tests/measure_viewport.py [--side 708] [--times 5]
"""

import argparse
import collections
import pathlib
import statistics
import tempfile

from blender_runs import Blender
from test_blender_window import Window


def main():
    words = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    words.add_argument("--side", type=int, default=708, help="quads along a side of the mesh: 708 are a million triangles")
    words.add_argument("--times", type=int, default=5, help="each kind of edit so often")
    given = words.parse_args()
    with tempfile.TemporaryDirectory() as home:
        folder = pathlib.Path(home)
        window = Window(Blender("old", folder / "home"), folder, folder / "picture.png", str(given.side), str(given.times),
                        script="heavy.py")
        try:
            window.wait("done", seconds=60 * given.times + 120)
        finally:
            window.close()
            told = window.log.read_text().splitlines() if window.log.exists() else []
            output = (folder / "output").read_text(errors="replace")
    found, triangles = collections.defaultdict(list), 0
    for kind, *rest in (line.split() for line in told):
        if kind == "ready":
            triangles = int(rest[0])
        elif kind == "EDIT":
            found[rest[0]].append([float(word) for word in rest[1::2]])
    if not found:
        raise SystemExit(output[-3000:])
    print(f"{triangles} triangles; seconds to the first new picture, median (least) of {given.times}; of these reading, BVH; "
          "of all cores (least)")
    for name, rows in found.items():
        took, reading, bvh, cpu = zip(*rows)
        print(f"{name:10} {statistics.median(took):.3f} ({min(took):.3f}); {statistics.median(reading):.3f}, {statistics.median(bvh):.3f}; "
              f"{statistics.median(cpu):.3f} ({min(cpu):.3f})")
    print(f"wanted of meshes: {0.1 + 1.5e-6 * triangles:.3f}")


if __name__ == "__main__":
    main()
