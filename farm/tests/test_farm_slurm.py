# SPDX-License-Identifier: Apache-2.0
"""libshade-farm on a real Slurm cluster of four daemons on this machine. FAULTS=1: all of what may fail there (make soak)."""

import json
import os
import pathlib
import re
import signal
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

    def finished(self, job, seconds=300):
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
        with clusters.Cluster(folder / "cluster", dead=10 if FAULTS else 300) as cluster:
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


def node_of(job, item):
    """Where it runs, as it says itself."""
    try:
        return json.loads((job / f"running/{item}").read_text())["host"]
    except OSError:
        return None


def free_what_hangs(farm, job):
    """The commands that `status` names, as a person would run them."""
    for command in re.findall(r"free it with: (.*)", farm("status", job)):
        farm.cluster.run(*command.split(), check=False)


@in_soak
def test_a_daemon_is_killed_and_its_item_runs_twice(farm):
    farm.ask("hang")
    job = farm.submit(farm.folder / "daemon")
    farm.wait_for(lambda: farm.started("0,0") == 1 and farm.started("32,0") == 1 and node_of(job, 0))
    node = node_of(job, 0)
    farm.cluster.kill(node)
    farm.wait_for(lambda: farm.started("0,0") == 2, 90)  # on another node, while the first copy goes on
    assert "running" in farm("status", job)
    (farm.folder / "hang").unlink()
    assert farm.finished(job) == []
    farm.assert_whole(job)
    farm.cluster.start_node(node)
    farm.wait_for(lambda: set(farm.cluster.run("sinfo", "-h", "-N", "-o", "%T").split()) == {"idle"}, 60)


@in_soak
def test_a_steps_daemon_is_killed(farm):
    farm.ask("hang")
    job = farm.submit(farm.folder / "step")
    farm.wait_for(lambda: farm.started("0,0") == 1 and farm.started("32,0") == 1 and node_of(job, 0))
    steps = farm.cluster.steps(node_of(job, 0))
    assert steps
    for pid in steps:
        os.kill(pid, signal.SIGKILL)
    farm.wait_for(lambda: farm.started("0,0") == 2, 120)
    (farm.folder / "hang").unlink()
    assert farm.finished(job) == []
    farm.assert_whole(job)


@in_soak
def test_the_controller_is_killed_and_comes_back(farm):
    """Items that had ended may run again, an item may be held and its node drained; by what `status` says it goes on."""
    farm.ask("hang")
    job = farm.submit(farm.folder / "controller")
    farm.wait_for(lambda: len(list((job / "results").iterdir())) > 30)
    farm.cluster.kill("slurmctld")
    (farm.folder / "hang").unlink()
    assert "what follows is known by markers alone" in farm("status", job)
    time.sleep(4)
    farm.cluster.start_controller()
    end = time.monotonic() + 150
    while not (job / "finished.json").exists() and time.monotonic() < end:
        time.sleep(1)
        free_what_hangs(farm, job)
    assert farm.finished(job, 1) == []
    farm.assert_whole(job)


@in_soak
def test_what_hangs_is_named_and_resume_works_round_it(farm):
    for node in farm.cluster.nodes:
        farm.cluster.run("scontrol", "update", f"nodename={node}", "state=drain", "reason=a lamp")
    job = farm.submit(farm.folder / "hangs")
    number = json.loads((job / "engine.json").read_text())["ids"][0]
    farm.cluster.run("scontrol", "hold", f"{number}_5")
    said = farm("status", job)
    assert f"{number}_5 is held (JobHeld" in said and f"free it with: scontrol release {number}_5" in said
    assert "node node2 is drained (a lamp); free it with: scontrol update nodename=node2 state=resume" in said
    for command in re.findall(r"free it with: (scontrol update .*)", said):
        farm.cluster.run(*command.split())
    farm.wait_for(lambda: len(list((job / "results").iterdir())) == 63)
    assert not (job / "finished.json").exists() and "64 items: 63 done" in farm("status", job)
    farm("resume", job)
    assert farm.finished(job) == []
    farm.assert_whole(job)


@in_soak
def test_what_fails_three_times_is_named_and_nothing_waits(farm):
    for name in ("kill", "kill.", "kill.."):
        farm.ask(name)
    farm.wrapper.write_text(farm.wrapper.read_text().replace("once kill;", "once kill || once kill. || once kill..;"))
    job = farm.submit(farm.folder / "thrice")
    wrong = farm.finished(job)
    assert len(wrong) == 1 and re.fullmatch(r"item 0 \(tile 0,0,16,16\): it was killed, or its machine failed; on node\d, log (.*)", wrong[0])
    assert wrong[0].endswith(str(job / "log/0.log"))
    assert farm.started("0,0") == 3
    farm.wait_for(lambda: not farm.cluster.run("squeue", "-h").strip(), 30)
    said = farm("status", job)
    assert "64 items: 63 done" in said and wrong[0] in said and not list((job / "frames").iterdir())
    farm("resume", job, "--engine", "local")
    farm.assert_whole(job)


@in_soak
def test_two_submissions_and_one_is_cancelled(farm):
    farm.ask("hang")
    one, other = farm.submit(farm.folder / "one"), farm.submit(farm.folder / "other")
    farm.wait_for(lambda: farm.started("0,0") == 1)
    farm("cancel", one)
    (farm.folder / "hang").unlink()
    assert farm.finished(other) == []
    farm.assert_whole(other)
    assert not (one / "finished.json").exists() and "cancelled; go on with" in farm("status", one)
    farm("resume", one)
    assert farm.finished(one) == []
    farm.assert_whole(one)


@in_soak
@pytest.mark.skipif(os.getuid() != 0, reason="only root can be another")
def test_a_plain_user(tmp_path):
    """Whose own cluster it is."""
    folder = tempfile.mkdtemp(prefix="plain-")
    os.chown(folder, 65534, 65534)
    try:
        done = subprocess.run(["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider",
                               f"--basetemp={folder}/pytest", __file__, "-k", "64_items"], cwd=ROOT, capture_output=True, text=True,
                              env={**os.environ, "FAULTS": "", "HOME": folder, "TMPDIR": folder, "PYTHONDONTWRITEBYTECODE": "1"})
        assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr
    finally:
        subprocess.run(["rm", "-rf", folder], check=True)
