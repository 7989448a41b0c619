# SPDX-License-Identifier: Apache-2.0
"""Two builds of the Blender engine's native module take turns at whole frames of one scene, without Blender.

    bench_frames_turns.py FOLDER_A SCENE_A FOLDER_B SCENE_B [--first B]

A folder is an add-on's, a scene what bench_frames_export.py made with it. Prints a line of JSON: "seconds", [those of A's
frames, those of B's], user and system, all threads, of rendering alone (scenes are built before); "differences" of the last
two pictures, the largest and the mean one.
"""
import argparse
import importlib.util
import json
import pickle
import time

import numpy as np

ENOUGH = 0.4  # seconds of frames of one build: shorter ones are rendered more often
MOST = 6  # frames of one build


def differences(one, other):
    """The largest, relative where a number is brighter than the mean of all (rounding is), and the mean one, over that mean."""
    off, mean = np.abs(other - one), max(float(one.mean()), 1e-30)
    return float((off / np.maximum(one, mean)).max()), float(off.mean()) / mean


class Build:
    def __init__(self, folder, file):
        spec = importlib.util.spec_from_file_location("_native", f"{folder}/_native.abi3.so")
        self.native = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.native)
        with open(file, "rb") as pickled:
            scene = pickle.load(pickled)
        self.view = {name: scene[name] for name in ("width", "height", "region", "samples", "camera")}
        self.job = self.native.start(scene)
        self.wait()

    def wait(self):
        self.native.wait(self.job, 1e9)
        state = self.native.poll(self.job)
        if state["state"] != "done":
            raise SystemExit(f"{state['state']}: {state['message']}")

    def frame(self):
        """Its seconds."""
        before = time.process_time()
        self.job = self.native.look(self.job, self.view)
        self.wait()
        return time.process_time() - before

    def picture(self):
        x0, y0, x1, y1 = self.view["region"]
        pixels = np.zeros((y1 - y0) * (x1 - x0) * 4, np.float32)
        self.native.image(self.job, pixels)
        return pixels.reshape(-1, 4)[:, :3].astype(float)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("folder_a", "scene_a", "folder_b", "scene_b"):
        parser.add_argument(name)
    parser.add_argument("--first", choices="AB", default="A", help="whose scene is built, and whose frame rendered, first")
    given = parser.parse_args()
    sides = [(given.folder_a, given.scene_a), (given.folder_b, given.scene_b)]
    order = (0, 1) if given.first == "A" else (1, 0)
    builds = {side: Build(*sides[side]) for side in order}
    warm = max([builds[side].frame() for side in order])
    seconds = ([], [])
    for turn in range(max(1, min(MOST, round(ENOUGH / warm)))):
        for side in (order, order[::-1])[turn % 2]:
            seconds[side].append(builds[side].frame())
    print(json.dumps({"seconds": seconds, "differences": differences(*(builds[side].picture() for side in (0, 1)))}))


if __name__ == "__main__":
    main()
