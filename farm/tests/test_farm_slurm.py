# SPDX-License-Identifier: Apache-2.0
"""libshade-farm on a real Slurm cluster of four daemons on this machine. FAULTS=1: all of what may fail there (make soak)."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "farm/tests"), str(ROOT / "blender_addon_c/tests")]

import cluster as clusters  # noqa: E402
from native_scenes import scene  # noqa: E402
from shade_render import COMBINED, scene_file  # noqa: E402

COST = 11

FAULTS = bool(os.environ.get("FAULTS"))
RENDER = ROOT / "build/shade-render"
NAME = "kugel 球 1"
pytestmark = [pytest.mark.skipif(bool(clusters.why_not()), reason=f"no Slurm cluster here: {clusters.why_not()}"),
              pytest.mark.skipif(not RENDER.exists(), reason="shade-render is not built (make render)")]
in_soak = pytest.mark.skipif(not FAULTS, reason="make soak")

# Before shade-render renders a tile, what a file of this folder and the tile's name asks for, once
WRAPPER = """#!/bin/sh
once() {{ mv "{0}/$1" "{0}/$1.taken.$$" 2>/dev/null; }}
echo "$*" >>{0}/started
case "$*" in *"--tile 0,0,"*)
  if once kill; then kill -9 $PPID; exit 1; fi
  if [ -e {0}/hang ]; then while [ -e {0}/hang ]; do sleep 0.1; done; fi ;;
*"--tile 16,0,"*)
  if once full; then
    for word in "$@"; do [ "$last" != -o ] || place=$(dirname "$word"); last=$word; done
    exec unshare $(test "$(id -u)" = 0 && echo -m || echo -rm) sh -c 'mount -t tmpfs -o size=4k full "$0" && exec "$@"' "$place" {1} "$@"
  fi ;;
*"--tile 32,0,"*)
  while [ -e {0}/hang ]; do sleep 0.1; done ;;
esac
exec {1} "$@"
"""


class Farm:
    """A cluster, a scene of 64 tiles and its picture, rendered alone."""

    def __init__(self, cluster, folder):
        self.cluster, self.folder = cluster, folder
        self.scene = folder / f"{NAME}.shscene"
        scene_file.write(self.scene, "L", [(scene(width=128, height=128, samples=4), [COMBINED])])
        subprocess.run([RENDER, self.scene, "-o", folder / "alone.exr"], check=True)
        self.wrapper = folder / "wrapper"
        self.wrapper.write_text(WRAPPER.format(folder, RENDER))
        self.wrapper.chmod(0o755)

    def __call__(self, *words, status=0):
        done = subprocess.run(["/usr/bin/python3", ROOT / "farm", *map(str, words)], env=self.cluster.environment, capture_output=True, text=True, timeout=100,
                              cwd=self.folder)
        assert done.returncode == status, (done.stdout, done.stderr)
        return done.stdout + done.stderr

    def submit(self, job, *more):
        (self.folder / "started").write_text("")
        said = self("submit", self.scene, "--engine", "slurm", "--tiles", "8x8", "-o", job, "--program", f"shade-render={self.wrapper}", *more)
        assert "submitted 64 items" in said
        return job

    def ask(self, name):
        (self.folder / name).touch()

    def started(self, tile):
        return sum(f"--tile {tile}," in line for line in (self.folder / "started").read_text().splitlines())

    def wait_for(self, happens, seconds=60):
        end = time.monotonic() + seconds
        while not happens():
            assert time.monotonic() < end, self.cluster.run("squeue", check=False) + self.cluster.run("sinfo", "-N", check=False)
            time.sleep(0.2)

    def finished(self, job, seconds=100):
        self.wait_for((job / "finished.json").exists, seconds)
        return json.loads((job / "finished.json").read_text())["wrong"]

    def assert_whole(self, job):
        """Every pixel is that of the picture rendered alone."""
        ours, alone = (oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT) for path in (job / f"frames/{NAME}.exr", self.folder / "alone.exr"))
        assert ours.shape == alone.shape and (ours == alone).all() and np.ptp(ours) > 0.1
        assert "64 items: 64 done, 0 running, 0 failed, 0 wait" in self("status", job)


@pytest.fixture(scope="module")
def farm():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="farm-"))  # pytest's paths are too long for sockets
    try:
        with clusters.Cluster(folder / "cluster") as cluster:
            yield Farm(cluster, folder)
    finally:
        subprocess.run(["rm", "-rf", folder], check=True)


def test_64_items_one_killed_and_one_on_a_full_disk(farm):
    """Both are tried again by the dependent job, and the picture is whole."""
    farm.ask("kill")
    farm.ask("full")
    job = farm.submit(farm.folder / "a b 球")
    assert farm.finished(job) == []
    farm.assert_whole(job)
    assert farm.started("0,0") == farm.started("16,0") == 2 and farm.started("0,16") == 1  # which were done were not done again
    log = (job / "log/1.log").read_text()
    assert "No space left on device" in log or "unshare" in log and "not permitted" in log
    assert "2 of 64 items failed; they are tried again" in (job / "log/slurm.out").read_text()
    assert not (job / "failed/1.json").exists() and not list((job / "work").iterdir())
