# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's window on a virtual screen: real keys start a render, and stop one."""

import os
import shutil
import subprocess
import time

import numpy as np
import pytest

from blender_runs import BUILD, INSIDE, rgba

COST = 105
SCREENSHOT = BUILD / "screenshots/blender.png"


class Window:
    """Blender in a window of a screen of its own, and the log of inside/window.py, or of another script."""

    def __init__(self, blender, folder, screenshot, *more, script="window.py"):
        more = more if script != "window.py" else (screenshot, *more)
        self.log, self._screenshot = folder / "log", screenshot
        SCREENSHOT.parent.mkdir(exist_ok=True)
        self._read, number = os.pipe()
        self._screen = subprocess.Popen(
            ["Xvfb", "-displayfd", str(number), "-screen", "0", "1280x960x24", "-nolisten", "tcp"],
            pass_fds=[number], stderr=subprocess.DEVNULL)
        os.close(number)
        with os.fdopen(self._read) as pipe:
            display = ":" + pipe.readline().strip()
        self._env = blender.environment({"DISPLAY": display, "LIBGL_ALWAYS_SOFTWARE": "1"})
        self._output = open(folder / "output", "w")
        self.blender = subprocess.Popen(
            [shutil.which("blender"), "--factory-startup", "--window-geometry", "0", "0", "1280",
             "900", "-P", INSIDE / script, "--", self.log, *more],
            env=self._env, stdout=self._output, stderr=subprocess.STDOUT)

    def wait(self, line, seconds=60, times=1):
        """Until the log has the line so often; returns how long that took."""
        started = time.monotonic()
        while not (self.log.exists()
                   and self.log.read_text().splitlines().count(line) >= times):
            assert self.blender.poll() is None, "Blender has ended"
            assert time.monotonic() - started < seconds, f"no '{line}' within {seconds} s"
            time.sleep(0.05)
        return time.monotonic() - started

    def key(self, name):
        subprocess.run(["xdotool", "mousemove", "500", "400", "key", name], env=self._env,
                       check=True)

    def _ask(self, please):
        please.touch()
        while please.exists():
            assert self.blender.poll() is None, "Blender has ended"
            time.sleep(0.05)

    def take_screenshot(self, name):
        """Returns the picture's path, in build/screenshots."""
        self._ask(self._screenshot.with_name(self._screenshot.name + ".please"))
        return self._screenshot.rename(self._screenshot.with_name(name))

    def please(self, what):
        """One of the requests of inside/window.py."""
        self._ask(self.log.with_name(f"{self.log.name}.{what}"))

    def close(self):
        for process in (self.blender, self._screen):
            process.terminate()
            process.wait(60)  # memory of a gigabyte is given back slowly beside other work
        self._output.close()


@pytest.fixture
def window(request, blender_old, tmp_path):
    window = Window(blender_old, tmp_path, SCREENSHOT, *getattr(request, "param", ()))
    yield window
    window.close()


def test_f12_and_esc(window):
    window.wait("ready 0")
    window.key("F12")
    window.wait("complete 0")
    window.wait("ready 1")
    window.take_screenshot("blender_finished.png")
    finished = rgba(f"{window.log}.1.exr")
    assert finished[..., :3].max() > 0.5 and finished[..., 3].mean() > 0.5

    window.key("F12")
    window.wait("rendering 1")  # hours of it
    window.take_screenshot("blender_rendering.png")
    lines = window.log.read_text().splitlines()
    assert not {"complete 1", "cancel 1"} & set(lines), "the second render ended by itself"
    window.key("Escape")
    print(f"Esc: stopped after {window.wait('cancel 1'):.2f} s")
    window.wait("ready 2")
    assert "complete 1" not in window.log.read_text()
    assert window.blender.poll() is None


def golden(path, columns=slice(1000)):
    """Number of pixels in the 3D view that are of our golden metal's colour, and bright."""
    red, _green, blue = np.moveaxis(rgba(path)[80:800, columns, :3], -1, 0)
    return ((red > 0.4) & (red > 1.2 * blue) & (red < 2.5 * blue)).sum()


def white(path):
    """The same of what is white in the right half of the camera's frame."""
    return (rgba(path)[240:630, 530:790, :3].min(-1) > 0.6).sum()


def test_viewport_says_what_is_wrong(window):
    """In the header, and still after the next redraw."""
    window.wait("ready 0")
    window.please("viewport")
    window.wait("viewport: ")
    window.please("portal")
    portal = "viewport: light 'area': portals are not supported; left out"
    window.wait(portal)
    window.please("empty")  # a scene without faces is its world
    window.wait(portal, times=2)
    window.please("redraw")
    window.wait(portal, times=3)
    window.take_screenshot("blender_viewport_error.png")
    assert window.log.read_text().splitlines()[-1] == portal
    window.please("select")
    window.wait("selected area")


@pytest.fixture(scope="module")
def shared(blender_old, tmp_path_factory):
    """A window for tests that leave the scene as it is."""
    window = Window(blender_old, tmp_path_factory.mktemp("window"), SCREENSHOT.with_name("shared.png"))
    window.wait("ready 0")
    yield window
    window.close()


def test_previews_are_our_own(shared):
    """The ball in the material's tab; a dump is not written over by it."""
    shared.please("material")
    shared.wait("preview True")
    shared.take_screenshot("blender_material.png")


def test_viewport(shared):
    """Rendered mode shows the metal, soon after it has been asked for; then a part of it, what is in local view, and both in two views."""
    assert golden(shared.take_screenshot("blender_solid.png")) < 5_000  # outline, axis

    def until(name, is_so):
        deadline = time.monotonic() + 30
        while not is_so(path := shared.take_screenshot(f"blender_{name}.png")):
            assert time.monotonic() < deadline, f"{name}: {golden(path)} golden pixels in the viewport"
            time.sleep(0.5)
        return golden(path)

    shared.please("viewport")
    whole = until("viewport", lambda path: golden(path) >= 20_000)
    shared.please("border")
    until("border", lambda path: 0.02 * whole < golden(path) < 0.5 * whole)
    plate = white(shared.take_screenshot("blender_border.png"))
    shared.please("local")  # of the monkey, without the plate
    until("local", lambda path: white(path) < 0.2 * plate and golden(path) > 0.02 * whole)
    shared.please("split")  # and the other shows all
    until("split", lambda path: golden(path, slice(500)) > 0.1 * whole and golden(path, slice(540, 1000)) > 0.02 * whole)


def red(path):
    """Number of pixels in the viewport that are red and nothing else."""
    red, green, blue = np.moveaxis(rgba(path)[80:800, :500, :3], -1, 0)
    return ((red > 0.1) & (red > 4 * green) & (red > 4 * blue)).sum()


def test_an_artist_opens_everything(window):
    """All panels of our nodes, the assets and the preferences are drawn, and Blender says nothing; a draft's Text that is
    edited under a live viewport is rendered anew, by itself."""
    window.wait("ready 0")
    window.please("weave")
    window.please("fabric")
    window.please("viewport")
    window.wait("viewport: ")
    before = red(window.take_screenshot("blender_fabric.png"))
    window.please("dye")
    deadline = time.monotonic() + 30
    while red(window.take_screenshot("blender_dyed.png")) < before + 5_000:
        assert time.monotonic() < deadline, "the viewport shows the draft as it was"
        time.sleep(0.5)
    for words in (("scratches",), ("metal",), ("assets", "library"), ("preferences",)):
        for word in words:
            window.please(word)
            window.please("redraw")
            time.sleep(0.5)
        window.take_screenshot(f"blender_{words[0]}.png")
        if words == ("metal",):  # which is active, while the scratches' button is pressed
            window.please("bake")
            deadline = time.monotonic() + 30
            while "baked by its dialog" not in (window.log.parent / "output").read_text(errors="replace"):
                assert time.monotonic() < deadline, "the dialog's OK has baked nothing"
                window.key("Return")
                time.sleep(0.5)
                window.please("baked")
    said = (window.log.parent / "output").read_text(errors="replace")
    assert not [line for line in said.splitlines() if "Error" in line or "Traceback" in line], said[-3000:]


EDITS = int(os.environ.get("EDITS", 12))  # thousands in `make soak`


@pytest.mark.parametrize("window", [(str(EDITS),)], indirect=True)
def test_viewport_while_it_is_edited(window):
    """By chance, with undo: the picture never goes, and what there is in the end is what a new viewport shows."""
    window.wait("ready 0")
    window.please("viewport")
    window.please("edits")
    window.wait("edited", seconds=3 * EDITS)
    told = window.log.read_text().splitlines()
    taken = [word.split(":") for line in told if line.startswith("seconds ") for word in line.split()[1:]]
    print(f"{len(taken)} first pictures: median {np.median([float(seconds) for _, seconds in taken]):.3f} s,",
          "longest", *max(taken, key=lambda word: float(word[1])))
    memory = np.array([line.split()[1:] for line in told if line.startswith("memory ")], float)
    print("edits, MiB held, objects:", *(f"{done:.0f} {mib:.0f} {objects:.0f};" for done, mib, objects in memory))
    if len(memory) > 6:  # the first fill undo's steps
        print(f"{100 * np.polyfit(*memory[4:, :2].T, 1)[0]:.2f} MiB more every hundred edits from the fifth on")
    assert len(taken) > EDITS / 4 and not [line for line in told if line.startswith("blank")]
    window.wait("whole")
    in_the_end = rgba(window.take_screenshot("blender_edited.png"))[80:800, :1000]
    window.please("solid")
    window.please("viewport")
    window.wait("whole", times=2)
    fresh = rgba(window.take_screenshot("blender_edited_fresh.png"))[80:800, :1000]
    assert np.ptp(fresh[..., :3]) > 0.2 and (np.abs(in_the_end - fresh) > 0.02).any(-1).mean() < 0.002


@pytest.fixture
def counted(blender_old, tmp_path):
    window = Window(blender_old, tmp_path, None, script="drawn.py")
    yield window
    window.close()


def test_viewport_is_drawn_only_for_news(counted):
    """Of a picture that takes hours as often as it is copied, of one that is finished not at all, and while BVHs are built not
    just to see whether they are there. Counts, not seconds."""
    counted.wait("done", seconds=120)
    told = {phase: dict(zip(words[::2], map(int, words[1::2])))
            for phase, *words in map(str.split, counted.log.read_text().splitlines()) if words}
    print(told)
    assert told["refining"]["copies"] == 3 and told["building"]["pictures"] >= 6
    # once for Blender's own reasons
    assert max(told[phase]["idle"] for phase in ("refining", "building")) <= 1, told
    assert told["whole"] == dict.fromkeys(told["whole"], 0)
