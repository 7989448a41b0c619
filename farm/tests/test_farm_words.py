# SPDX-License-Identifier: Apache-2.0
"""libshade-farm by its parts, with stand-ins for Slurm, Blender and ffmpeg: what it asks of them, item by item, and what it says of it."""

import argparse
import importlib.util
import json
import os
import pathlib
import runpy
import signal
import struct
import subprocess
import sys
import threading
import time
import zipfile
import zlib
from types import SimpleNamespace as Of

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "farm")]

import engines  # noqa: E402
import files  # noqa: E402
import finish  # noqa: E402
import item  # noqa: E402
import job as jobs  # noqa: E402
import png  # noqa: E402
import renderers  # noqa: E402
from engines import local, slurm  # noqa: E402
from renderers import blender, commands, povray, saved  # noqa: E402

COST = 1.2

spec = importlib.util.spec_from_file_location("farm_main", ROOT / "farm/__main__.py")
main = importlib.util.module_from_spec(spec)
spec.loader.exec_module(main)
SAID = {"scene": "a.pov", "name": "a", "words": ["+A"], "threads": 2, "programs": {"povray": "/p/povray", "blender": "/b/blender", "shade-render": "/s/render"}, "engine": "slurm",
        "sbatch": ["--mem=4G"], "range": [1, 9], "corner": [10, 20], "pictures": True, "libraries": ["/lib"], "clock": False, "movie": {"rate": 25, "layer": ""}, "inputs": [],
        "environment": {}, "isa": None, "items": [{"frame": 1, "tile": None, "share": None}, {"frame": 2, "tile": None, "share": None}]}


@pytest.fixture
def job(tmp_path):
    def job(**more):
        return jobs.Job.create(str(tmp_path / "a b"), {**SAID, **more})
    return job


class Log:
    """What a renderer is asked."""

    def __init__(self, makes=()):
        self.asked, self.makes = [], makes

    def run(self, words, folder=None, environment=None):
        self.asked.append(([str(word) for word in words], folder))
        for name in self.makes:
            pathlib.Path(folder or self.work, name).touch()
        return ""


# ---- what is asked for


@pytest.mark.parametrize("text, of_file, wanted", [
    ("3", None, ([3], 3, 3)), ("1-4", None, ([1, 2, 3, 4], 1, 4)), ("-2-3/2", None, ([-2, 0, 2], -2, 3)), ("all", (2, 8, 3), ([2, 5, 8], 2, 8)), ("7-7/5", None, ([7], 7, 7))])
def test_frames(text, of_file, wanted):
    assert main.parse_frames(text, of_file) == wanted


@pytest.mark.parametrize("text, of_file, said", [
    ("all", None, "--frames 'all': A, A-B or A-B/STEP was expected"), ("1-x", (1, 2, 1), "--frames '1-x': A, A-B or A-B/STEP was expected, or all"),
    ("4-3", None, "--frames '4-3' are none: A must be at most B, and STEP at least 1"), ("1-3/0", None, "--frames '1-3/0' are none")])
def test_frames_that_are_none(text, of_file, said):
    with pytest.raises(files.Refusal) as wrong:
        main.parse_frames(text, of_file)
    assert str(wrong.value).startswith(said) and (text != "all" or not str(wrong.value).endswith("or all"))


def test_words_of_options():
    assert (main.parse_tiles("3x2"), main.parse_tiles("9999x9999"), main.parse_program("blender=/a=b"), main.positive("17"), main.whole_number("0")) == ((3, 2), (9999, 9999), ("blender", "/a=b"), 17, 0)
    for parse, words, said in ((main.parse_tiles, ("0x2", "3", "3x", "12345x1"), "NxM was expected, columns and rows"),
                               (main.parse_program, ("cat=x", "blender=", "blender"), "blender=PATH, povray=PATH or shade-render=PATH was expected"),
                               (main.positive, ("0", "-1", "x", "1000000"), "a whole number from 1 on was expected"), (main.whole_number, ("-1", "x"), "a whole number from 0 on was expected")):
        for text in words:
            with pytest.raises(argparse.ArgumentTypeError, match=f"'{text}': {said}"):
                parse(text)


HELP = {  # of each word: option, what stands for its value, default
    "submit": [("-o", "FOLDER", None), ("--frames", "A-B[/STEP]", None), ("--tiles", "NxM", None), ("--shares", "K", None), ("--engine", None, "local"), ("--threads", "T", None),
               ("--dry-run", None, False), ("--pack", None, False), ("--also", "FILE", []), ("--isa", None, None), ("--program", "NAME=PATH", []), ("--sbatch", "WORDS", ""),
               ("--no-movie", None, False), ("--rate", "FPS", None)],
    "status": [], "cancel": [], "resume": [("--engine", None, None)], "item": [], "merge": [("--round", None, None)]}


def test_options_and_their_defaults():
    whole = main.parser()
    tasks = whole._subparsers._group_actions[0].choices
    assert {name: [(one.option_strings[0], one.metavar, one.default) for one in task._actions if one.option_strings and one.dest != "help"] for name, task in tasks.items()} == HELP
    assert {name: [one.metavar for one in task._actions if not one.option_strings] for name, task in tasks.items()} == {
        "submit": ["FILE.blend|FILE.pov|SCENE.shscene"], "status": ["FOLDER"], "cancel": ["FOLDER"], "resume": ["FOLDER"], "item": ["FOLDER", "N"], "merge": ["FOLDER"]}
    choices = {one.option_strings[0]: list(one.choices) for one in tasks["submit"]._actions if one.choices}
    assert choices == {"--engine": ["local", "slurm"], "--isa": ["scalar", "sse2", "avx2", "avx512", "neon"]}
    said = whole.format_help()
    assert all(text in " ".join(said.split()) for text in ("submit begin a scene's items", "status what is done, runs, failed and hangs", "cancel end what runs; what is whole stays",
                                                           "resume render what is missing", "item one item, on this machine", "merge frames of their parts, and the movie"))
    assert "Exit status: 0 done, 1 something is missing or refused, 2 bad usage, 130 after Ctrl-C, which loses no whole item." in said
    said = " ".join(one.help for one in tasks["submit"]._actions)
    for text in ("print items, inputs and commands, and begin nothing", "copy the scene and what it reads into FOLDER", "each frame in N columns and M rows",
                 "each frame's samples in K parts", "hold all machines to one instruction set", "another input, whose name the scene puts together", "blender, povray or shade-render",
                 "(default NAME-farm-1, -2, ...)", "(default: its current frame, a still)", "(default local)", "(default: local, all cores over all items; slurm, 1)",
                 "(default: the .blend's, else 24)", "(LIBSHADE_ISA)", "or a list of commands, .items (renderers/commands.py)", "more options for sbatch, as one word: --sbatch='--mem=4G --time=2:00:00'", "(made where ffmpeg is found)"):
        assert text in said


def test_items_are_frames_by_tiles_by_shares():
    about = {"no_tiles": "", "no_shares": "", "size": [40, 30], "samples": 8, "cloth": False}
    found = main.plan_items(about, [1, 2], (2, 1), 2)
    assert [(one["frame"], one["tile"], one["share"]) for one in found] == [
        (frame, tile, share) for frame in (1, 2) for tile in ([0, 0, 20, 30], [20, 0, 20, 30]) for share in ([0, 4], [4, 8])]
    assert main.plan_items(about, [None], None, 1) == [{"frame": None, "tile": None, "share": None}]
    assert [one["tile"] for one in main.plan_items(about, [None], (1, 2), None)] == [[0, 0, 40, 15], [0, 15, 40, 15]]
    assert [one["tile"] for one in main.plan_items({**about, "size": [64, 90], "grid": 32}, [None], (1, 2), None)] == [[0, 0, 64, 32], [0, 32, 64, 58]]
    for more, tiles, shares, said in (({"no_tiles": "why"}, (1, 2), None, "--tiles: why"), ({"no_tiles": "why"}, None, 2, "--shares: why"), ({"no_shares": "so"}, None, 2, "--shares: so")):
        with pytest.raises(files.Refusal, match=said):
            main.plan_items({**about, **more}, [1], tiles, shares)
    assert renderers.cut(10, 3) == [(0, 3), (3, 6), (6, 10)]
    with pytest.raises(files.Refusal, match="^90 pixels cannot be cut into 4 tiles at multiples of 32$"):
        renderers.cut(90, 4, 32)
    with pytest.raises(files.Refusal, match="whose samples are shaded together: of 64 samples there are 3 shares at most"):
        renderers.cuts_of_samples(64, 4, True)
    assert renderers.cuts_of_samples(256, 4, True) == [(0, 64), (64, 128), (128, 192), (192, 256)] and renderers.cuts_of_samples(64, 3, True) == [(0, 4), (4, 16), (16, 64)]
    assert [jobs.name_of(3, one) for one in ({}, {"frame": 0}, {"frame": 5, "tile": [0, 1, 2, 3], "share": [4, 8]}, {"name": "x", "frame": 1}, {"share": [0, 1]})] == [
        "item 3", "item 3 (frame 0)", "item 3 (frame 5, tile 0,1,2,3, samples 4 to 7)", "item 3 (x)", "item 3 (samples 0 to 0)"]
    assert item.is_part({"share": [0, 1]}) and item.is_part({"tile": [0, 0, 1, 1]}) and not item.is_part({"frame": 1}) and item.key_of_frame(None) == "f" and item.key_of_frame(7) == "f7"


@pytest.mark.parametrize("samples, parts, together, wanted", [
    (100, 3, False, [0, 33, 66, 100]), (127, 2, False, [0, 63, 127]), (128, 2, False, [0, 64, 128]), (300, 2, False, [0, 128, 300]), (300, 4, False, [0, 64, 128, 256, 300]),
    (4, 4, False, [0, 1, 2, 3, 4]), (16, 2, True, [0, 4, 16]), (300, 1, True, [0, 300]), (1000, 2, True, [0, 512, 1000]), (64, 2, True, [0, 16, 64])])
def test_shares_of_samples(samples, parts, together, wanted):
    """As even as they can be; where they are long, and of cloth always, between passes: 4, 16, 64 samples, then each 64."""
    assert renderers.cuts_of_samples(samples, parts, together) == list(zip(wanted, wanted[1:]))
    with pytest.raises(files.Refusal, match=f"^{samples} samples cannot be cut into {samples + 1} shares$"):
        renderers.cuts_of_samples(samples, samples + 1, together)


def test_what_runs_is_seen_to_run(tmp_path, monkeypatch):
    """Its mark is touched again and again, and goes with it."""
    monkeypatch.setattr(item, "_TOUCH_SECONDS", 0.01)
    place = tmp_path / "running"
    with item._Touched(str(place)):
        os.utime(place, (1, 1))
        end = time.monotonic() + 20
        while place.stat().st_mtime < 2 and time.monotonic() < end:
            time.sleep(0.01)
        assert place.stat().st_mtime > 2 and files.read_json(str(place)) == {"host": files.host(), "pid": os.getpid()}
    assert not place.exists()


def test_programs_and_folders(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(main, "built", lambda: str(tmp_path))
    (tmp_path / "povray").mkdir()
    for name in ("povray/povray", "shade-render", "other"):
        (tmp_path / name).touch(0o755)
    (tmp_path / "blender").mkdir()
    assert [main.find_program(name, {}) for name in ("povray", "shade-render", "blender")] == [f"{tmp_path}/povray/povray", f"{tmp_path}/shade-render", "blender"]
    assert main.find_program("blender", {"blender": "./other"}) == f"{tmp_path}/other" and main.find_program("povray", {"povray": "sh"}) == "sh"
    with pytest.raises(files.Refusal, match="--program blender=/none: no program"):
        main.find_program("blender", {"blender": "/none"})
    assert [main.new_folder(None, "a") for _ in range(2)] == [f"{tmp_path}/a-farm-1", f"{tmp_path}/a-farm-2"] and main.new_folder("new/one", "a") == f"{tmp_path}/new/one"
    assert main.new_folder("new/one", "a") == f"{tmp_path}/new/one"  # still empty
    assert os.path.isdir("new/one")
    with pytest.raises(files.Refusal, match="povray: the folder is not empty; each submission has one of its own"):
        main.new_folder("povray", "a")


@pytest.fixture
def submitted(monkeypatch, tmp_path):
    """submitted(words) -> (exit status, what was submitted, its items' numbers), by an engine that stands for slurm."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(main, "built", lambda: str(tmp_path / "build"))
    monkeypatch.delenv("BLENDER_USER_SCRIPTS", raising=False)
    monkeypatch.setattr(main.os, "sched_getaffinity", lambda _pid: range(12))
    monkeypatch.setattr(slurm, "check", lambda: checked.append(1))
    monkeypatch.setattr(slurm, "submit", lambda job, numbers: asked.append((job.said, numbers)) or 7)
    monkeypatch.setattr(slurm, "commands", lambda job, numbers: [f"sbatch {job.folder} {list(numbers)}"])
    asked, checked = [], []

    def submitted(*words):
        asked.clear()
        status = main.main(["submit", *map(str, words)])
        return status, *(asked[0] if asked else (None, None))
    submitted.checked = checked
    return submitted


def test_what_a_submission_keeps(submitted, tmp_path, capsys):
    """All that items need to know, by job.json; what is not there is warned of; a folder is not one of the inputs."""
    (tmp_path / "maps").mkdir()
    (tmp_path / "build/blender/addons/libshade").mkdir(parents=True)
    (tmp_path / "a.pov").write_text('#include "b.inc"')
    (tmp_path / "b.inc").touch()
    status, said, numbers = submitted("a.pov", "--engine", "slurm", "--frames", "1-5/2", "--also", "none.png", "--also", "maps", "--isa", "avx2", "--sbatch=--mem=4G -p 'a b'",
                                      "--rate", "30", "--", "+W64", "+H64", f"+L{tmp_path}/maps", "+KFF9")
    assert status == 7 and numbers == [0, 1, 2]
    told = lambda name: {"path": str(tmp_path / name), "size": (tmp_path / name).stat().st_size, "sha256": files.sha256(tmp_path / name)}
    assert said == {"version": 1, "scene": f"{tmp_path}/a.pov", "name": "a", "words": ["+W64", "+H64", "+KFF9"], "threads": 1,
                    "items": [{"frame": frame, "tile": None, "share": None} for frame in (1, 3, 5)], "programs": {"povray": "povray"},
                    "environment": {"BLENDER_USER_SCRIPTS": f"{tmp_path}/build/blender"}, "isa": "avx2", "engine": "slurm", "sbatch": ["--mem=4G", "-p", "a b"], "range": [1, 5],
                    "corner": [0, 0], "pictures": True, "libraries": [f"{tmp_path}/maps"], "clock": True, "movie": {"rate": 30, "layer": ""},
                    "inputs": [told("a.pov"), told("b.inc")]}
    out = capsys.readouterr()
    assert out.out == f"3 items; all of it is in {tmp_path}/a-farm-1\n" and out.err == f"libshade-farm: warning: {tmp_path}/none.png: an input is not there\n"
    assert sorted(os.listdir("a-farm-1")) == ["checked", "failed", "farm.pyz", "frames", "job.json", "log", "results", "running", "work"] and submitted.checked == [1]
    said = submitted("a.pov", "--engine", "slurm", "--threads", "3", "--no-movie", "--program", "povray=sh")[1]
    assert (said["threads"], said["movie"], said["programs"], said["range"], said["items"]) == (3, None, {"povray": "sh"}, [None, None], [{"frame": None, "tile": None, "share": None}])
    status, said, _numbers = submitted("a.pov", "--engine", "slurm", "--pack", "-o", "packed")
    assert (said["scene"], [one["path"] for one in said["inputs"]]) == ("inputs/a.pov", ["inputs/a.pov", "inputs/b.inc"]) and os.path.isfile("packed/inputs/b.inc")
    (tmp_path / "far.inc").touch()
    os.makedirs("in")
    (tmp_path / "in/c.pov").write_text('#include "../far.inc"')
    assert submitted("in/c.pov", "--engine", "slurm", "--pack", "-o", "gone")[0] == 1 and not os.path.exists("gone")


def test_a_dry_run(submitted, tmp_path, capsys):
    """Items, inputs with their hashes and commands; nothing is made or asked for. Of its threads all cores over all items, here."""
    (tmp_path / "a.pov").touch()
    words = ("a.pov", "--tiles", "2x1", "--dry-run", "--", "+W64", "+H32")
    assert submitted(*words)[0] == 0 and os.listdir(tmp_path) == ["a.pov"]
    run = f"python3 {tmp_path}/a-farm-1/farm.pyz item {tmp_path}/a-farm-1"
    assert capsys.readouterr().out.splitlines() == ["2 items of 6 threads each:", "  item 0 (tile 0,0,32,32)", "  item 1 (tile 32,0,32,32)", "inputs:",
                                                    f"  {files.sha256(tmp_path / 'a.pov')}  {tmp_path}/a.pov", "commands:", f"  {run} 0", f"  {run} 1"]
    assert submitted(*words[:3], "--engine", "slurm", "-o", "x", *words[3:])[0] == 0 and not submitted.checked
    assert capsys.readouterr().out.splitlines()[0::6] == ["2 items of 1 thread each:", f"  sbatch {tmp_path}/x [0, 1]"]
    assert submitted("none.pov")[0] == 1 and capsys.readouterr().err == f"libshade-farm: {tmp_path}/none.pov: no such file\n"


def test_resume_goes_round_what_hangs(submitted, job, monkeypatch, capsys):
    """What is held or waits is ended first; what failed before is no longer told of."""
    made, asked = job(movie=None), []
    monkeypatch.setattr(slurm, "cancel", lambda job: asked.append(job.is_cancelled()))
    monkeypatch.setattr(local, "submit", lambda job, numbers: asked.append(numbers) or 0)
    files.write_json(made.path("failed", "1.json"), {"message": "x"})
    files.write_json(made.path("finished.json"), {})
    whole(made, 0)
    assert main.main(["resume", made.folder, "--engine", "local"]) == 0 and asked == [True, [1]]
    assert not made.is_cancelled() and os.listdir(made.path("failed")) == [] and not os.path.exists(made.path("finished.json"))
    whole(made, 1)
    assert main.main(["resume", made.folder]) == 0 and capsys.readouterr().out == "all items are whole\n" and len(asked) == 3 and len(os.listdir(made.path("frames"))) == 2
    assert main.main(["merge", made.folder]) == 0 and main.main(["item", made.folder, "2"]) == 1
    assert capsys.readouterr().err == "libshade-farm: item 2: there are 2, from 0 on\n"
    monkeypatch.setattr(finish, "merge", lambda _job: ["item 1: x"])
    assert main.main(["merge", made.folder]) == 1 and capsys.readouterr().out == "item 1: x\n"
    monkeypatch.setattr(finish, "after", lambda folder, round_, engine: (folder, round_, engine) == (made.folder, 2, slurm) and 5)
    assert main.main(["merge", made.folder, "--round", "2"]) == 5

    def stopped(_options):
        raise KeyboardInterrupt
    monkeypatch.setattr(main, "status", stopped)
    assert main.main(["status", made.folder]) == 130

    def full(_options):
        raise OSError(28, "No space left on device", "/x")
    monkeypatch.setattr(main, "status", full)
    assert main.main(["status", made.folder]) == 1 and capsys.readouterr().err == "libshade-farm: /x: No space left on device\n"


# ---- what is said of a submission


def whole(job, number, **more):
    work = pathlib.Path(job.path("work", f"w{number}"))
    work.mkdir()
    (work / f"{number}.png").write_text("x")
    job.take(str(number), str(work), [f"{number}.png"], **more)


def test_status(job, capsys, monkeypatch):
    made = job(engine="local", items=[{"frame": frame} for frame in range(1, 8)])
    files.write_json(made.path("engine.json"), {"engine": "local"})
    assert main.main(["status", made.folder]) == 0 and capsys.readouterr().out.splitlines() == [
        "a: 7 items: 0 done, 0 running, 0 failed, 7 wait", f"hangs: nothing runs it on {files.host()}; go on with: libshade-farm resume '{made.folder}'"]
    whole(made, 0, seconds=2.0, megabytes=70)
    whole(made, 1, seconds=4.0, megabytes=50)
    files.write_json(made.path("running", "2"), {"host": "h"})
    files.write_json(made.path("failed", "3.json"), {"message": "tile is too hot", "host": "node1", "log": "/l/3.log"})
    files.write_json(made.path("failed", "2.json"), {"message": "before", "host": "node1", "log": "/l/2.log"})  # it runs again
    monkeypatch.setattr(files, "host", lambda: "here")
    assert main.main(["status", made.folder]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "a: 7 items: 2 done, 1 running, 1 failed, 3 wait", "an item took 3.0 s, 4.0 s at most, and 70 MB at most", "remain: about 00:15, as many as now at once",
        "failed: item 3 (frame 4): tile is too hot; on node1, log /l/3.log", f"hangs: nothing runs it on here; go on with: libshade-farm resume '{made.folder}'"]
    os.utime(made.path("running", "2"), (time.time() - 61,) * 2)  # its machine is gone
    monkeypatch.setattr(engines, "of", lambda _job: Of(state=lambda _job: (4, ["a node"]), cancel=lambda _job: None))
    files.write_json(made.path("cancelled"), {})
    main.main(["status", made.folder])
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "a: 7 items: 2 done, 0 running, 2 failed, 3 wait; 4 in the queue" and said[-2:] == [
        "hangs: a node", f"cancelled; go on with: libshade-farm resume '{made.folder}'"]
    for number in range(2, 7):
        whole(made, number, seconds=1.0)
    files.remove(made.path("cancelled"))
    files.write_json(made.path("finished.json"), {"wrong": ["merge of frame 1: no"]})
    main.main(["status", made.folder])
    assert capsys.readouterr().out.splitlines()[2:] == ["hangs: a node", "failed: merge of frame 1: no", f"frames are in {made.folder}/frames"]
    assert main.main(["cancel", made.folder]) == 0 and made.is_cancelled()
    assert capsys.readouterr().out == f"cancelled; what is whole stays. Go on with: libshade-farm resume '{made.folder}'\n"
    assert main.main(["status", made.folder + "/none"]) == 1
    assert "none: no submission: job.json of version 1 is missing there" in capsys.readouterr().err


def test_durations_and_progress(job, monkeypatch):
    assert [local.duration(seconds) for seconds in (0, 59.4, 59.6, 3599, 3600, 45296)] == ["00:00", "00:59", "01:00", "59:59", "1:00:00", "12:34:56"]
    made = job(items=[{"frame": frame} for frame in range(4)])
    assert local._progress(made, 0, 0, 1) == "0 of 4 items are whole"
    whole(made, 0)
    monkeypatch.setattr(local, "time", Of(time=lambda: 130.0))
    assert local._progress(made, 100, 0, 1) == "1 of 4 items are whole, 01:30 remain" and local._progress(made, 100, 1, 1) == "1 of 4 items are whole"
    whole(made, 1)
    whole(made, 2)
    assert local._progress(made, 100, 2, 1) == "3 of 4 items are whole, 00:30 remain"  # two were there before it began
    assert local.commands(made, [0, 1]) == [f"python3 '{made.folder}/farm.pyz' item '{made.folder}' {number}" for number in (0, 1)]


def test_what_comes_after_the_items(job, capsys, monkeypatch):
    """Missing ones again, twice at most; then what is wrong is told with where it ran."""
    made = job(items=[{"frame": 1}, {"frame": 2}, {"frame": 3}], movie=None)
    monkeypatch.setattr(files, "host", lambda: "here")
    whole(made, 0)
    files.write_json(made.path("running", "1"), {"host": "node7"})
    asked = []
    engine = Of(submit=lambda job, numbers, round_: asked.append((numbers, round_)))
    assert finish.after(made.folder, 0, engine) == 0 and asked == [([1, 2], 1)]
    assert capsys.readouterr().out == "2 of 3 items failed; they are tried again\n" and not os.path.exists(made.path("running", "1"))
    assert finish.after(made.folder, 1, engine) == 0 and finish.after(made.folder, 2, engine) == 1 and len(asked) == 2
    wrong = [f"item 1 (frame 2): it was killed, or its machine failed; on node7, log {made.folder}/log/1.log",
             f"item 2 (frame 3): it never began; on no machine, log {made.folder}/log/2.log"]
    assert capsys.readouterr().out.splitlines()[1:] == wrong and files.read_json(made.path("finished.json")) == {"wrong": wrong}
    assert os.listdir(made.path("frames")) == ["0.png"] and files.read_json(made.path("failed/1.json"))["log"] == made.log(1)

    def refuses(*_words):
        raise files.Refusal("sbatch: no such partition")
    assert finish.after(made.folder, 0, Of(submit=refuses)) == 1
    assert capsys.readouterr().err == f"sbatch: no such partition; go on with: libshade-farm resume {made.folder}\n"


def test_a_movie(job, monkeypatch):
    """Of all frames in their order, of a still none; numbers in an EXR are light, of one of its layers."""
    made, asked = job(items=[{"frame": 5}, {"frame": 3}]), []
    for number in (0, 1):
        whole(made, number)
    monkeypatch.setattr(finish.shutil, "which", lambda name: "/bin/ffmpeg")

    def run(words, **_options):
        folder = os.path.dirname(words[-1])
        asked.append([word.replace(folder, "F") for word in words])
        links.append([os.readlink(os.path.join(folder, name)) for name in sorted(os.listdir(folder))])
        pathlib.Path(words[-1]).touch()
        return Of(returncode=status, stderr="a warning\nno codec\n" if status else "")
    monkeypatch.setattr(finish.subprocess, "run", run)
    links, status = [], 0
    assert finish.movie(made) == f"movie: {made.folder}/frames/a.mp4" and os.path.exists(made.path("frames/a.mp4")) and not os.listdir(made.path("work"))
    assert asked == [["ffmpeg", "-nostdin", "-v", "error", "-framerate", "25", "-i", "F/%06d.png", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-pix_fmt", "yuv420p",
                      "-crf", "18", "F/movie.mp4"]]
    assert links == [[made.path("frames", f"{number}.png") for number in (0, 1)]]
    monkeypatch.setattr(finish, "pictures", lambda _job: ["a/1.EXR", "a/2.EXR"])
    made.said["movie"]["layer"] = "L.Combined"
    finish.movie(made)
    assert asked[1][4:11] == ["-apply_trc", "iec61966_2_1", "-layer", "L.Combined", "-framerate", "25", "-i"] and asked[1][11] == "F/%06d.exr"
    status = 1
    assert finish.movie(made) == "no movie: ffmpeg says: no codec"
    monkeypatch.setattr(finish.shutil, "which", lambda name: None)
    assert finish.movie(made) == f"no movie: ffmpeg is not installed here; frames are in {made.folder}/frames"
    monkeypatch.setattr(finish, "pictures", lambda _job: ["a/1.exr"])
    assert finish.movie(made) == ""
    made.said["movie"] = None
    assert finish.movie(made) == ""


# ---- Slurm


def test_what_is_asked_of_slurm(job, monkeypatch, capsys):
    made, asked = job(), []

    def call(*words):
        asked.append(list(words))
        return "MaxArraySize            = 10\n" if words[0] == "scontrol" else f"{100 + len(asked)};cluster\n"
    monkeypatch.setattr(slurm, "_call", call)
    monkeypatch.setattr(slurm, "check", lambda: None)
    assert slurm.submit(made, [0, 1, 2, 5, 12, 13], 1) == 0
    run = f"exec python3 '{made.folder}/farm.pyz'"
    common = lambda name: ["sbatch", "--parsable", f"--job-name={name}", f"--chdir={made.folder}", "--output=log/slurm.out", "--open-mode=append"]
    assert asked == [["scontrol", "show", "config"],
                     [*common("a"), "--array=0-2,5", "--requeue", "--cpus-per-task=2", "--mem=4G", f"--wrap={run} item '{made.folder}' $SLURM_ARRAY_TASK_ID"],
                     [*common("a"), "--array=2-3", "--requeue", "--cpus-per-task=2", "--mem=4G", f"--wrap={run} item '{made.folder}' $((10 + SLURM_ARRAY_TASK_ID))"],
                     [*common("a-merge"), "--dependency=afterany:102:103", "--kill-on-invalid-dep=yes", "--requeue", "--cpus-per-task=2", "--mem=4G",
                      f"--wrap={run} merge '{made.folder}' --round 1"]]
    assert files.read_json(made.path("engine.json")) == {"engine": "slurm", "ids": ["102", "103", "104"], "round": 1}
    assert capsys.readouterr().out == f"submitted 6 items as 102, 103, the merge as 104; see: libshade-farm status '{made.folder}'\n"

    def full(*words):
        if any("-merge" in word for word in words):
            raise files.Refusal("sbatch: no room")
        return call(*words)
    monkeypatch.setattr(slurm, "_call", full)
    with pytest.raises(files.Refusal, match="^sbatch: no room$"):
        slurm.submit(made, [0], 2)
    assert files.read_json(made.path("engine.json")) == {"engine": "slurm", "ids": ["106"], "round": 2}  # what runs can be cancelled
    monkeypatch.setattr(slurm, "_call", call)
    assert [slurm._spec(numbers) for numbers in ([3], [5, 1, 2], [1, 3, 5])] == ["3", "1-2,5", "1,3,5"]
    shown = slurm.commands(made, [0])
    assert len(shown) == 2 and "afterany:ARRAY1 " in shown[1] and "--round 0" in shown[1]
    monkeypatch.setattr(slurm, "_call", lambda *words: (_ for _ in ()).throw(files.Refusal("no")))
    assert "--array=0-1000 " in slurm.commands(made, list(range(1500)))[0] and "--array=0-498 " in slurm.commands(made, list(range(1500)))[1]


def test_what_slurm_says(job, monkeypatch):
    made = job()
    monkeypatch.setattr(slurm, "_call", lambda *words: told[words[0]])
    files.write_json(made.path("engine.json"), {"engine": "slurm", "ids": ["7", "8"]})
    told = {"squeue": "7_0|RUNNING|None|node1\n7_1|PENDING|JobHeldUser|\n7_2|PENDING|launch failed requeued held|\n8|PENDING|Dependency|\nodd\n",
            "sinfo": "node1|mixed|none\nnode2|drained|a lamp \nnode2|drained|a lamp\nnode3|down*|gone|more\nnode4|draining|moves\nnode5|idle|none\n"}
    free = "free it with: scontrol"
    assert slurm.state(made) == (3, [f"7_1 is held (JobHeldUser); {free} release 7_1", f"7_2 is held (launch failed requeued held); {free} release 7_2",
                                     f"node node2 is drained (a lamp); {free} update nodename=node2 state=resume",
                                     f"node node3 is down* (gone|more); {free} update nodename=node3 state=resume",
                                     f"node node4 is draining (moves); {free} update nodename=node4 state=resume"])
    told["squeue"] = "7_0|RUNNING|None|node1\n"
    assert slurm.state(made) == (1, [])
    told["squeue"] = ""
    assert slurm.state(made) == (0, [f"Slurm knows no more of it; go on with: libshade-farm resume '{made.folder}'"])
    files.write_json(made.path("finished.json"), {"wrong": []})
    assert slurm.state(made) == (0, [])
    asked = []

    def refuses(text):
        def call(*words):
            asked.append(words)
            raise files.Refusal(text)
        return call
    monkeypatch.setattr(slurm, "_call", refuses("squeue: Invalid job id specified"))
    assert slurm.state(made) == (0, []) and asked[0] == ("squeue", "-h", "-r", "-j", "7,8", "-o", "%i|%T|%r|%N")
    slurm.cancel(made)
    assert ("scancel", "7", "8") in asked
    monkeypatch.setattr(slurm, "_call", refuses("squeue: Unable to contact slurm controller"))
    assert slurm.state(made) == (None, ["squeue: Unable to contact slurm controller; what follows is known by markers alone"])
    with pytest.raises(files.Refusal, match="Unable to contact"):
        slurm.cancel(made)
    files.remove(made.path("engine.json"))
    slurm.cancel(made)
    monkeypatch.undo()
    for words, said in ((["sh", "-c", "echo one >&2; echo two >&2; exit 3"], "sh: two"), (["sh", "-c", "exit 3"], "sh: ended with 3"), (["/none"], "/none: .*No such file")):
        with pytest.raises(files.Refusal, match=said):
            slurm._call(*words)
    assert slurm._call("echo", "a") == "a\n"


# ---- renderers


def options(**more):
    return Of(**{"words": [], "frames": None, "tiles": None, "shares": None, "programs": {"blender": "blender"}, "environment": {}, **more})


def test_pov_ray_is_asked(job, tmp_path):
    """By names of Latin letters; a tile's rows and columns count from one, the clock is of the frames that were asked for."""
    scene = tmp_path / "é.pov"
    scene.touch()
    (tmp_path / "w.ini").write_text("")
    made, work = job(scene=str(scene), words=["+W80", str(tmp_path / "w.ini")]), tmp_path / "work"
    plain = ["/p/povray", "+Llibrary0", "+Llibrary1", "+W80", "words1.ini", "-D", "+WT2", "+Iscene.pov", "+Opicture"]
    for one, more, name in (({"frame": None}, [], "a.png"), ({"frame": 3}, ["+KFI1", "+KFF9", "+SF3", "+EF3"], "a_0003.png"),
                            ({"frame": None, "tile": [0, 10, 32, 20]}, ["+SC1", "+EC32", "+SR11", "+ER30"], "a.png")):
        work.mkdir()
        log = Log(["picture.png"])
        assert povray.render(made, one, str(work), log) == [name] and log.asked == [([*plain, *more], str(work))] and (work / name).exists()
        assert [os.readlink(work / link) for link in ("library0", "library1", "scene.pov", "words1.ini")] == [str(tmp_path), "/lib", str(scene), str(tmp_path / "w.ini")]
        povray.shutil.rmtree(work)
    work.mkdir()
    made.said["clock"] = True
    log = Log(["picture1.png", "picture2.png"])
    with pytest.raises(files.Refusal, match="POV-Ray wrote 2 pictures, and one was expected"):
        povray.render(made, {"frame": 3}, str(work), log)
    assert log.asked[0][0][-2:] == ["+SF3", "+EF3"] and "+KFI1" not in log.asked[0][0]


def test_what_a_scene_of_pov_ray_needs(tmp_path, monkeypatch):
    home, library = tmp_path / "home", tmp_path / "library"
    for path, text in ((home / "a.pov", '#include "b.inc" // "c.inc"\n/* "c.inc" */ image_map { png "d.png" } "e\\"f"'), (home / "b.inc", '#include "l.inc"'), (home / "c.inc", ""),
                       (home / "d.png", '"c.inc"'), (library / "l.inc", ""), (library / "b.inc", ""), (home / "s.ini", "Width = 64 ; columns\nHeight=48\nFinal_Frame=9\n")):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    said = povray.examine(str(home / "a.pov"), options(words=[str(home / "s.ini"), f"+L{library}", "+A0.2"]))
    assert sorted(said["inputs"]) == sorted(map(str, (home / "a.pov", home / "b.inc", home / "d.png", library / "l.inc", home / "s.ini")))
    assert {name: said[name] for name in ("frames", "size", "samples", "cloth", "programs", "rate", "grid", "clock", "libraries", "words", "no_tiles")} == {
        "frames": [None], "size": [64, 48], "samples": 0, "cloth": False, "programs": ["povray"], "rate": 24, "grid": 32, "clock": True, "libraries": [str(library)],
        "words": [str(home / "s.ini"), "+A0.2"], "no_tiles": ""}
    ask = lambda *words: povray.examine(str(home / "a.pov"), options(words=["+W64", "+H48", *words]))
    assert not ask()["clock"] and ask("+KFF9")["clock"] and ask("Height=50")["size"] == [64, 50] and ask("-w32")["size"] == [32, 48]
    for words in ([], ["+W64"], ["+H48"]):
        assert povray.examine(str(home / "a.pov"), options(words=words))["no_tiles"] == "tiles need the picture's size: give +W and +H behind --", words
    monkeypatch.chdir(home)
    for word, text, height in (("T.INI", "Height=12\n", 12), ("+A0.3", "Height=12\n", 0), ("gone.ini", None, 0)):  # files of options are called so, and are there
        if text:
            (home / word).write_text(text)
        said = povray.examine("a.pov", options(words=["+W64", word]))
        assert said["size"] == [64, height] and said["words"] == ["+W64", str(home / word) if height else word] and (str(home / word) in said["inputs"]) == bool(height), word
    assert ask("+FN")["no_tiles"] == ask("+FN16")["no_tiles"] == "" and ask("+FE")["no_tiles"] == ask("Output_File_Type=J")["no_tiles"] == "tiles are joined as PNG (+FN) only"
    (home / "a.pov").write_text("global_settings { radiosity { } }")
    assert ask()["no_tiles"].startswith("radiosity gathers light over what is rendered")


def header(**more):
    return {"pictures": [{"layer": "V", "passes": [1], "scene": {"width": 40, "height": 24, "samples": 20, **more}}]}


def test_saved_scenes(job, tmp_path):
    assert saved.about(header(), []) == {"size": [40, 24], "corner": [0, 0], "samples": 20, "cloth": False, "layer": "V.Combined", "no_tiles": "", "no_shares": ""}
    part = saved.about(header(region=[8, 4, 20, 14], cloths=[1]), ["--samples", "7"])
    assert (part["size"], part["corner"], part["samples"], part["cloth"]) == ([12, 10], [8, 10], 7, True)
    assert saved.about(header(time_limit=1.0), [])["no_tiles"].startswith("the scene has a Time Limit") and saved.about(header(adaptive_threshold=.1), [])["no_shares"].startswith(
        "the scene has adaptive sampling")
    assert [saved.words_for_number(words, "samples") for words in (["--samples=9"], ["--samples", "9"], ["--samples"], ["--sample", "9"], ["--samples", "x"], [])] == [9, 9, *[None] * 4]
    with pytest.raises(files.Refusal, match="pictures, each with scene, width, height and samples"):
        saved.about({"pictures": []}, [])
    path, text = tmp_path / "a.shscene", json.dumps({"pictures": header()["pictures"] * 2}).encode()
    path.write_bytes(b"shscene\n" + struct.pack("<II", len(text), 1) + text + b"arrays")
    with pytest.raises(files.Refusal, match="a.shscene: a saved scene is one frame; --frames goes with FILE.blend and FILE.pov$"):
        saved.examine(str(path), options(frames="1"))
    said = saved.examine(str(path), options())
    assert (said["frames"], said["inputs"], said["programs"], said["layer"]) == ([None], [str(path)], ["shade-render"], "V.Combined")
    for data, wrong in ((b"other\n", "\"shscene\" must be its first line"), (b"shscene\n" + struct.pack("<II", 3, 1) + b"{x}", "its header must be JSON")):
        path.write_bytes(data)
        with pytest.raises(files.Refusal, match=wrong):
            saved.header_of(str(path))
    with pytest.raises(files.Refusal, match="none.shscene: No such file"):
        saved.header_of(str(tmp_path / "none.shscene"))
    made, log = job(scene="/x/a.shscene"), Log()
    assert saved.render(made, {}, "/w", log) == ["a.exr"] and saved.render(made, {"tile": [1, 2, 3, 4], "share": [5, 6]}, "/w", log) == ["part.shshare"]
    assert saved.merge(made, None, [({}, ["/r/0"]), ({}, ["/r/1"])], "/w", log) == ["a.exr"]
    assert [words for words, _folder in log.asked] == [
        ["/s/render", "/x/a.shscene", "-o", "/w/a.exr", "--threads", "2", "+A"],
        ["/s/render", "/x/a.shscene", "-o", "/w/part.shshare", "--threads", "2", "+A", "--tile", "11,22,3,4", "--share", "5,6"],
        ["/s/render", "/x/a.shscene", "--merge", "/r/0", "/r/1", "-o", "/w/a.exr", "--threads", "2"]]


def test_blender_is_asked(job, tmp_path):
    """Whole frames of it, parts of scenes that it saves: of each view layer one."""
    made, work = job(scene="/x/a.blend", words=["-E", "CYCLES"]), tmp_path / "work"
    work.mkdir()
    log = Log(["a_0003.png"])
    log.work = work
    assert blender.render(made, {"frame": 3}, str(work), log) == ["a_0003.png"]
    words = log.asked[0][0]
    assert words[:10] == ["/b/blender", "-b", "--addons", "libshade", "/x/a.blend", "--python-exit-code", "1", "-t", "2", "-E"] and words[11] == "--python-expr"
    assert "def examine" in words[12] and words[13:16] == ["--", "--farm", "render"] and json.loads(words[16]) == {"frame": 3, "place": f"{work}/a_0003"}
    log = Log(["frame.shscene", "frame-left.shscene"])
    log.work = work
    assert blender.render(made, {"frame": 3, "share": [0, 4]}, str(work), log) == ["frame-left.shshare", "frame.shshare"]
    assert log.asked[0][0][15] == "save" and json.loads(log.asked[0][0][16]) == {"frame": 3, "place": f"{work}/frame.shscene"}
    assert log.asked[1][0] == ["/s/render", f"{work}/frame-left.shscene", "-o", f"{work}/frame-left.shshare", "--threads", "2", "--share", "0,4"]
    log.asked.clear()
    parts = [({}, [f"/r/{number}/frame-left.shshare", f"/r/{number}/frame.shshare"]) for number in (0, 1)]
    assert blender.merge(made, 3, parts, str(work), log) == ["a_0003-left.exr", "a_0003.exr"]
    assert log.asked[2][0] == ["/s/render", f"{work}/frame.shscene", "--merge", "/r/0/frame.shshare", "/r/1/frame.shshare", "-o", f"{work}/a_0003.exr", "--threads", "2"]
    empty = tmp_path / "empty"
    empty.mkdir()
    for one, said in (({"frame": 1}, "Blender wrote no picture"), ({"frame": 1, "tile": [0, 0, 1, 1]}, "Blender saved no scene")):
        with pytest.raises(files.Refusal, match=said):
            blender.render(made, one, str(empty), Log())


def test_what_a_file_of_blender_needs(monkeypatch, tmp_path):
    scene, program = tmp_path / "a.blend", tmp_path / "blender"
    about = {"inputs": [str(scene)], "frames": [1, 9, 2], "frame": 4, "rate": 25, "engine": "LIBSHADE", "composites": False, "sequences": False}
    with pytest.raises(files.Refusal, match="a.blend: no such file"):
        blender.examine(str(scene), options())
    scene.touch()

    def ask(_scene, _options, task, place, frame=None):
        asked.append((task, frame))
        if task == "examine":
            files.write_json(place, about)
        else:
            for name, one in (("frame.shscene", header()), ("frame-b.shscene", header(cloths=[1], adaptive_threshold=.1))):
                text = json.dumps(one).encode()
                (pathlib.Path(place).parent / name).write_bytes(b"shscene\n" + struct.pack("<II", len(text), 1) + text)
    asked, real = [], blender._ask
    monkeypatch.setattr(blender, "_ask", ask)
    plain = {"frames": [4], "all_frames": [1, 9, 2], "rate": 25, "inputs": [str(scene)], "programs": ["blender"], "no_tiles": "", "no_shares": ""}
    assert blender.examine(str(scene), options()) == plain and asked == [("examine", None)]
    found = blender.examine(str(scene), options(tiles=(1, 2)))
    assert (found["programs"], found["cloth"], found["size"], found["layer"], asked[-1]) == (["blender", "shade-render"], True, [40, 24], "V.Combined", ("save", 4))
    assert found["no_shares"].startswith("the scene has adaptive sampling")  # one of its layers has
    for more, said in (({"engine": "CYCLES"}, "the file's engine is CYCLES: only libshade renders tiles and shares; give -E LIBSHADE behind --"),
                       ({"composites": True}, "the file composites or edits its frames after they are rendered"), ({"sequences": True}, "the file composites or edits")):
        before = dict(about)
        about.update(more)
        assert blender.examine(str(scene), options(shares=2))["no_tiles"].startswith(said)
        about.update(before)
    program.write_text("#!/bin/sh\necho starts\necho \"$SAYS\"\nexit $STATUS\n")
    program.chmod(0o755)
    for says, status, wrong in (("Engine 'LIBSHADE' not available", 0, "the file's engine LIBSHADE is not there: install and enable its add-on, or name its folder by BLENDER_USER_SCRIPTS"),
                                ("  File Error: no room ", 1, "a.blend: Blender: File Error: no room"), ("", 3, "a.blend: Blender: ended with 3")):
        with pytest.raises(files.Refusal, match=wrong):
            real(str(scene), options(programs={"blender": str(program)}, environment={"SAYS": says, "STATUS": str(status)}), "pack")
    with pytest.raises(files.Refusal, match="none: cannot be run: No such file or directory; install Blender, or name it by --program blender=PATH"):
        real(str(scene), options(programs={"blender": "/none"}), "pack")


def test_lists_of_commands(job, tmp_path):
    listed = tmp_path / "a.items"
    listed.write_text(json.dumps({"folder": "/f", "inputs": ["x", "/y"], "items": [{"name": "one", "words": ["cp", "a"]}, {"name": "two", "words": ["ls"]}]}))
    why = "commands have neither tiles nor shares"
    assert commands.examine(str(listed), options()) == {"frames": [0, 1], "names": ["one", "two"], "inputs": [str(listed), "/f/x", "/y"], "programs": [], "no_tiles": why,
                                                        "no_shares": why, "no_frames": True}
    with pytest.raises(files.Refusal, match="a.items: commands have no frames"):
        commands.examine(str(listed), options(frames="1"))
    log = Log()
    assert commands.render(job(scene=str(listed)), {"frame": 1}, str(tmp_path), log) == ["1.txt"] and log.asked == [(["ls"], "/f")] and (tmp_path / "1.txt").read_bytes() == b"done\n"
    for text in ('{"folder": "", "inputs": [], "items": []}', "no JSON", '{"items": [{"name": "x", "words": ["a", 1]}], "folder": "", "inputs": []}'):
        listed.write_text(text)
        with pytest.raises(files.Refusal, match="JSON with folder, inputs and items, each with a name and words, was expected"):
            commands.examine(str(listed), options())
    with pytest.raises(files.Refusal, match=r"a.png: its name must end in .shscene, .blend, .pov, .items"):
        renderers.of("a.png")
    assert renderers.of("a/B.POV") is povray


# ---- results and files


def test_a_result_is_taken_once(job, tmp_path, monkeypatch):
    """The quicker copy's stays; one that a disk has damaged gives way."""
    made, synced = job(), []
    monkeypatch.setattr(files, "synced", synced.append)
    whole(made, 0, seconds=1.0)
    assert synced == [made.path("work/w0/0.png")]
    told = files.read_json(made.path("results/0/item.json"))
    assert told["seconds"] == 1 and told["files"][0]["path"] == "0.png" and told["files"][0]["size"] == 1 and made.result("0") == [made.path("results/0/0.png")]
    work = pathlib.Path(made.path("work/again"))
    work.mkdir()
    (work / "0.png").write_text("y")
    made.take("0", str(work), ["0.png"])
    assert pathlib.Path(made.path("results/0/0.png")).read_text() == "x" and made.missing() == [1]
    pathlib.Path(made.path("results/0/0.png")).write_text("z")
    assert made.is_whole("0") and not made.is_whole("0", thorough=True)
    made.take("0", str(work), ["0.png"])
    assert pathlib.Path(made.path("results/0/0.png")).read_text() == "y"
    pathlib.Path(made.path("results/0/0.png")).write_text("longer")
    assert made.missing() == [0, 1] and not made.is_whole("7")
    place = tmp_path / "shown/a.png"
    files.publish(made.path("results/0/0.png"), str(place))
    assert os.path.samefile(place, made.path("results/0/0.png")) and os.listdir(place.parent) == ["a.png"]
    files.write_json(str(tmp_path / "x.json"), {"a": "é"})
    assert (tmp_path / "x.json").read_text(encoding="utf-8") == '{\n "a": "é"\n}\n' and (tmp_path / "x.json").stat().st_mode & 0o777 == 0o644
    assert files.read_json(str(tmp_path / "none"), 5) == 5 and files.told(str(tmp_path / "x.json"), "n")["path"] == "n"


def test_what_a_renderer_says_at_its_end(tmp_path, monkeypatch):
    log = item.Log(str(tmp_path / "log"))
    for words, said in ((["sh", "-c", "echo one; echo ' two '; echo; exit 4"], "^sh ended with 4: two$"), (["sh", "-c", "exit 4"], "^sh ended with 4: it said nothing$"), (["sh", "-c", r"printf '\377 hot\n'; exit 5"], "^sh ended with 5: \ufffd hot$"),
                        (["/none"], "^/none: cannot be run: No such file or directory; --program says where it is$")):
        with pytest.raises(files.Refusal, match=said):
            log.run(words)
    monkeypatch.setenv("LIBSHADE_ISA", "avx512")
    with pytest.raises(files.Refusal, match="^this machine has no avx512, to which items are held$"):
        log.run(["echo", "warning: LIBSHADE_ISA 'avx512': no"])
    assert log.run(["sh", "-c", "pwd; echo $A"], folder="/", environment={"A": "b"}) == "/\nb\n"
    assert "in /: sh -c 'pwd; echo $A'" in (tmp_path / "log").read_text(errors="replace")


def test_what_runs_here_is_ended(job, monkeypatch):
    """The process that a submission's folder names, if that is still one of ours."""
    made = job(engine="slurm")  # and was resumed here
    hangs = [f"nothing runs it on {files.host()}; go on with: libshade-farm resume '{made.folder}'"]
    with subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)", "submit"]) as child:
        while b"submit" not in pathlib.Path(f"/proc/{child.pid}/cmdline").read_bytes():
            time.sleep(.01)
        for host, pid, runs in ((files.host(), child.pid, True), ("other", child.pid, False), (files.host(), os.getppid(), False), (files.host(), 0, False)):
            files.write_json(made.path("engine.json"), {"engine": "local", "pid": pid, "host": host})
            assert local.state(made) == (None, [] if runs else hangs)
        local.cancel(made)
        assert child.poll() is None
        files.write_json(made.path("engine.json"), {"engine": "local", "pid": child.pid, "host": files.host()})
        local.cancel(made)
        assert child.wait(20) == -signal.SIGTERM
    assert local.state(made) == (None, hangs) and engines.of(made) is local
    files.write_json(made.path("finished.json"), {})
    assert local.state(made) == (None, []) and local._words(made, 3) == [sys.executable, made.path("farm.pyz"), "item", made.folder, "3"]


def test_an_item_from_begin_to_end(job, monkeypatch, capsys, tmp_path):
    """Its result, its marks and its words; a part's picture is not shown, what is left beside the result goes."""
    handlers = {}
    monkeypatch.setattr(item.signal, "signal", handlers.__setitem__)
    monkeypatch.setattr(files, "host", lambda: "here")
    (tmp_path / "a.pov").touch()
    said = [files.told(str(tmp_path / "a.pov"))]
    made, seen = job(scene=str(tmp_path / "a.pov"), inputs=said, items=[{"frame": 1}, {"frame": 2, "tile": [0, 0, 1, 1]}], isa="sse2", environment={"A_WORD": "b"}), []
    for name in ("LIBSHADE_ISA", "A_WORD"):
        monkeypatch.setenv(name, "before")

    def render(one_job, one, work, log):
        seen.append((files.read_json(made.path("running", "0")), os.environ["LIBSHADE_ISA"], os.environ["A_WORD"], one["frame"], os.stat(work).st_mode & 0o777))
        for name in ("a.png", "left"):
            pathlib.Path(work, name).write_text("x")
        if fails:
            raise fails[0]
        return ["a.png"]
    monkeypatch.setattr(povray, "render", render)
    files.write_json(made.path("failed", "0.json"), {"message": "before"})
    monkeypatch.setattr(item.resource, "getrusage", lambda whose: Of(ru_maxrss={item.resource.RUSAGE_CHILDREN: 70 * 1024 + 5}[whose]))  # KiB: getrusage(2)
    fails = []
    assert item.run(made, 0) == 0 and seen == [({"host": "here", "pid": os.getpid()}, "sse2", "b", 1, 0o755)]
    assert set(handlers) == {signal.SIGTERM, signal.SIGINT, signal.SIGHUP}
    with pytest.raises(item.Ended, match="^2$"):
        handlers[signal.SIGINT](2, None)
    assert sorted(os.listdir(made.path("results/0"))) == ["a.png", "item.json"] and os.listdir(made.path("frames")) == ["a.png"]
    told = files.read_json(made.path("results/0/item.json"))
    assert (told["host"], told["files"][0]["path"]) == ("here", "a.png") and 0 <= told["seconds"] < 60 and abs(told["ended"] - time.time()) < 60 and told["megabytes"] == 70
    assert not any(os.listdir(made.path(name)) for name in ("failed", "running", "work"))
    lines = [line.split(f" here {os.getpid()}: ")[1] for line in pathlib.Path(made.log(0)).read_text().splitlines()]
    assert lines == ["item 0 (frame 1)", "done"] and item.run(made, 0) == 0 and capsys.readouterr().out == "item 0 (frame 1) is whole already\n"
    for wrong, status, text in ((files.Refusal("too hot"), 1, "too hot"), (item.Ended(15), 143, "ended by SIGTERM"), (OSError(28, "No space"), 1, "[Errno 28] No space")):
        fails[:] = [wrong]
        assert item.run(made, 1) == status
        assert capsys.readouterr().out == f"item 1 (frame 2, tile 0,0,1,1): {text}; on here, log {made.log(1)}\n"
        assert {**files.read_json(made.path("failed", "1.json")), "time": 0} == {"host": "here", "message": text, "log": made.log(1), "time": 0} and not os.listdir(made.path("work"))
    fails.clear()
    assert item.run(made, 1) == 0 and os.listdir(made.path("frames")) == ["a.png"] and made.missing() == []
    pathlib.Path(made.path("results/0/a.png")).write_text("y")  # a disk has damaged it
    pathlib.Path(made.path("frames/a.png")).unlink()
    capsys.readouterr()
    assert item.run(made, 0) == 0 and pathlib.Path(made.path("results/0/a.png")).read_text() == "x" and capsys.readouterr().out == "" and os.listdir(made.path("frames")) == ["a.png"]
    (tmp_path / "a.pov").write_text("x")
    pathlib.Path(made.path("results/0/a.png")).unlink()
    rendered = len(seen)
    assert item.run(made, 0) == 1 and len(seen) == rendered
    assert f"{tmp_path}/a.pov: an input is another than was submitted; put the old one back, or submit again; on here" in capsys.readouterr().out


def test_frames_of_parts(job, monkeypatch):
    """Merged once, of whole results; what goes wrong is told by frame, and the others are merged."""
    parts = [{"frame": frame, "tile": tile} for frame in (1, 2) for tile in ([0, 0, 1, 2], [1, 0, 1, 2])]
    made, asked = job(items=parts, movie=None), []
    monkeypatch.setattr(files, "host", lambda: "here")
    for number in range(4):
        whole(made, number)

    def merge(one_job, frame, of, work, log):
        asked.append((frame, of))
        if frame == 2 and len(asked) < 3:
            raise files.Refusal("no room")
        pathlib.Path(work, f"a_{frame}.png").touch()
        return [f"a_{frame}.png"]
    monkeypatch.setattr(povray, "merge", merge)
    pathlib.Path(made.path("work/left")).mkdir()
    assert finish.merge(made) == [f"merge of frame 2: no room; on here, log {made.folder}/log/f2.log"] and os.path.isdir(made.path("work/left"))
    assert sorted(asked, key=lambda one: one[0])[0] == (1, [(parts[k], [made.path("results", str(k), f"{k}.png")]) for k in (0, 1)])
    assert finish.merge(made) == [] and [frame for frame, _of in asked].count(1) == 1 and not os.listdir(made.path("work"))
    assert sorted(os.listdir(made.path("frames"))) == ["a_1.png", "a_2.png"] == [os.path.basename(path) for path in finish.pictures(made)]


@pytest.mark.parametrize("obeys", [True, False])
def test_a_renderer_is_ended_with_its_item(tmp_path, monkeypatch, obeys):
    """Asked to end first; killed where it has not after twenty seconds."""
    asked = []

    class Child:
        def wait(self, seconds=None):
            asked.append(("wait", seconds))
            if len(asked) == 1:
                raise item.Ended(15)
            if seconds and not obeys:
                raise subprocess.TimeoutExpired("renderer", seconds)

        def terminate(self):
            asked.append("terminate")

        def kill(self):
            asked.append("kill")
    monkeypatch.setattr(item.subprocess, "Popen", lambda *_words, **_options: Child())
    with pytest.raises(item.Ended):
        item.Log(str(tmp_path / "log")).run(["renderer"])
    assert asked == [("wait", None), "terminate", ("wait", 20), *([] if obeys else ["kill", ("wait", None)])]


class Machine:
    """Six cores, whose processes are of this test: an item's ends with the first of `ends[number]` that is left, or well."""

    def __init__(self, monkeypatch, job, **ends):
        self.job, self.ends, self.on = job, {int(name[1:]): list(each) for name, each in ends.items()}, lambda _child: None
        self.started, self.options, self.at_once, self.killed, self.handlers, self.waits = [], [], [], [], {}, 0
        machine, lock, running = self, threading.Lock(), set()

        class Child:
            def __init__(self, words, **options):
                self.number, self.pid, self.returncode, self.ended = int(words[-1]), 1000 + int(words[-1]), None, threading.Event()
                machine.started.append(self.number)
                machine.options.append(options)
                running.add(self)

            def communicate(self):
                machine.on(self)
                with lock:
                    machine.at_once.append(len(running))
                    running.discard(self)
                self.returncode = (machine.ends.get(self.number) or [0]).pop(0)
                if not self.returncode:
                    whole(job, self.number)
                return f" item {self.number} says why \n", None

        class Event(threading.Event):
            def wait(self, seconds):
                machine.waits += 1
                return super().wait(min(seconds, .002))

        def kill(pid, number):
            self.killed.append((pid, number))
            for child in [one for one in running if one.pid == pid]:
                child.ended.set()
            raise ProcessLookupError  # the first has ended by itself
        monkeypatch.setattr(files, "host", lambda: "here")
        monkeypatch.setattr(local.os, "sched_getaffinity", lambda _pid: range(6))
        monkeypatch.setattr(local.os, "killpg", kill)
        monkeypatch.setattr(local.subprocess, "Popen", Child)
        monkeypatch.setattr(local, "threading", Of(Thread=threading.Thread, Lock=threading.Lock, Event=Event))
        monkeypatch.setattr(local, "signal", Of(SIGINT=2, SIGTERM=15, Signals=signal.Signals, default_int_handler="default", signal=self.handlers.__setitem__))


FOUR = [{"frame": frame} for frame in range(4)]


def test_items_run_at_once_and_are_tried_again(job, monkeypatch, capsys):
    """Twice again, and not said to be once more; a killed one is named, too."""
    made = job(engine="local", items=FOUR, movie=None)
    machine, all_three = Machine(monkeypatch, made, n1=[1, 4], n3=[-9]), threading.Barrier(3)

    def on(child):
        if len(machine.started) <= 4 and child.number < 3:
            all_three.wait(20)
    machine.on = on
    assert local.submit(made, [0, 1, 2, 3]) == 0 and machine.started == [0, 1, 2, 3, 1, 3, 1] and max(machine.at_once) == 3
    out, err = capsys.readouterr()
    assert err.splitlines() == ["item 1 says why", "2 items failed; they are tried again", "item 1 says why", "1 items failed; they are tried again"]
    assert out.splitlines() == [f"item 3 (frame 3): its process was ended by SIGKILL; on here, log {made.log(3)}", f"4 of 4 items are whole; frames are in {made.folder}/frames"]
    assert files.read_json(made.path("engine.json")) == {"engine": "local", "pid": os.getpid(), "host": "here"} and sorted(os.listdir(made.path("frames"))) == [f"{k}.png" for k in range(4)]
    assert all(one["start_new_session"] and one["stdin"] == subprocess.DEVNULL for one in machine.options) and machine.handlers[2] == "default"
    with pytest.raises(KeyboardInterrupt):
        machine.handlers[15](15, None)


def test_items_that_never_end_well(job, monkeypatch, capsys):
    made = job(engine="local", items=FOUR[:2], movie=None, pictures=False, threads=9)
    machine, seconds = Machine(monkeypatch, made, n0=[2, 2, 2]), iter(range(0, 10**6, 3))
    monkeypatch.setattr(local, "time", Of(time=lambda: next(seconds)))

    def on(_child):
        before, end = machine.waits, time.monotonic() + 20
        while machine.waits < before + 2 and time.monotonic() < end:  # what is done is told of meanwhile
            time.sleep(.001)
    machine.on = on
    assert local.submit(made, [0, 1]) == 1 and machine.started == [0, 1, 0, 0] and set(machine.at_once) == {1}
    out, err = capsys.readouterr()
    said = [line for line in err.splitlines() if "remain" not in line and line != "0 of 2 items are whole"]
    assert said == ["item 0 says why", "1 items failed; they are tried again"] * 2 + [
        "item 0 says why", f"item 0 (frame 0): it never began; on no machine, log {made.log(0)}"]
    assert "0 of 2 items are whole" in err and "1 of 2 items are whole, 0" in err and out == f"1 of 2 items are whole; results are in {made.folder}/results\n"


@pytest.mark.parametrize("cancelled", [False, True])
def test_what_runs_is_stopped(job, monkeypatch, capsys, cancelled):
    """By Ctrl-C, or by `cancel` elsewhere: no more begin, none is said to have failed."""
    made = job(engine="local", items=FOUR, movie=None)
    machine = Machine(monkeypatch, made, **{f"n{k}": [-15] for k in range(4)})

    def on(child):
        if child.number == 2 and cancelled:
            files.write_json(made.path("cancelled"), {})
        elif child.number == 2:
            machine.handlers[2](2, None)
        assert child.ended.wait(20)
    machine.on = on
    assert local.submit(made, [0, 1, 2, 3]) == 130 and machine.started == [0, 1, 2] and sorted(machine.killed) == [(1000, 15), (1001, 15), (1002, 15)]
    assert capsys.readouterr() == ("", f"stopped; go on with: libshade-farm resume '{made.folder}'\n") and not os.path.exists(made.path("finished.json"))


# ---- what runs within Blender


class Blender:
    """Its Python, as far as in_blender.py asks; `done` are its operators, in their order."""

    def __init__(self, monkeypatch, path, images=(), objects=(), saves=("FINISHED",), **render):
        self.done, node = [], lambda name: lambda **words: self.done.append((name, words)) or set(saves)
        self.settings = Of(file_format="OPEN_EXR", media_type="MULTI")
        self.render = Of(**{"fps": 30, "fps_base": 1.25, "engine": "LIBSHADE", "use_compositing": True, "use_sequencer": True, "image_settings": self.settings, "filepath": "", **render})
        self.scene = Of(sequence_editor=None, use_nodes=False, frame_start=2, frame_end=8, frame_step=3, frame_current=5, render=self.render,
                        frame_set=lambda frame: self.done.append(frame))
        blend_paths = lambda absolute, packed, local: ["/elsewhere/b.png", ""] if (absolute, packed, local) == (True, False, False) else ["/wrong"]
        ops = Of(render=Of(render=node("render")), libshade=Of(save_scene=node("save_scene")), file=Of(pack_all=node("pack_all"), pack_libraries=node("pack_libraries")),
                 wm=Of(save_as_mainfile=node("save")))
        monkeypatch.setitem(sys.modules, "bpy", Of(data=Of(filepath=path, images=images, objects=objects), utils=Of(blend_paths=blend_paths), context=Of(scene=self.scene), ops=ops,
                                                   path=Of(abspath=lambda text, library=None: text.replace("//", f"{os.path.dirname(library or path)}/"))))
        self.patch = monkeypatch

    def run(self, task, **said):
        self.patch.setattr(sys, "argv", ["blender", "-b", "--", "--farm", task, json.dumps(said)])
        runpy.run_path(str(ROOT / "farm/renderers/in_blender.py"))


def test_what_a_file_reads_and_asks_for(monkeypatch, tmp_path):
    for name in ("maps/a_01.png", "maps/a_02.png", "maps/b_01.png", "maps/t.1001.png", "maps/t.1002.png", "far/l_1.png", "far/l_22.png", "blendcache_x/cloth.bphys", "liquid/deep/one.vdb",
                 "blendcache_y/cloth.bphys"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    image = lambda source, path, packed=None, library=None: Of(source=source, filepath=path, packed_file=packed, library=library)
    images = [image("SEQUENCE", "//maps/a_01.png"), image("TILED", "//maps/t.<UDIM>.png"), image("SEQUENCE", "//l_1.png", library=f"{tmp_path}/far/l.blend"),
              image("FILE", "//maps/b_01.png"), image("SEQUENCE", "//maps/b_01.png", packed=1), image("SEQUENCE", ""), image("SEQUENCE", "//nowhere/c_1.png")]
    domain = lambda folder: Of(domain_settings=Of(cache_directory=folder))
    made = Blender(monkeypatch, f"{tmp_path}/x.blend", images, [Of(modifiers=[Of(), domain(""), Of(domain_settings=None)]), Of(modifiers=[domain("//liquid")])])
    made.run("examine", place=str(tmp_path / "told"))
    names = ["blendcache_x/cloth.bphys", "far/l_1.png", "far/l_22.png", "liquid/deep/one.vdb", "maps/a_01.png", "maps/a_02.png", "maps/t.1001.png", "maps/t.1002.png", "x.blend"]
    assert files.read_json(str(tmp_path / "told")) == {"inputs": sorted(["/elsewhere/b.png", *(f"{tmp_path}/{name}" for name in names)]), "frames": [2, 8, 3], "frame": 5, "rate": 24,
                                                       "engine": "LIBSHADE", "composites": False, "sequences": False}

    def asks(render=(), **scene):
        one = Blender(monkeypatch, f"{tmp_path}/none/x.blend", **dict(render))
        vars(one.scene).update(scene)
        one.run("examine", place=str(tmp_path / "told"))
        told = files.read_json(str(tmp_path / "told"))
        return told["composites"], told["sequences"]
    assert asks(use_nodes=True) == (True, False) == asks(use_nodes=False, compositing_node_group=Of()) and asks(use_nodes=True, compositing_node_group=None) == (False, False)
    assert asks(sequence_editor=Of(strips_all=[1])) == asks(sequence_editor=Of(sequences_all=[1])) == (False, True) and asks(sequence_editor=Of(strips_all=[])) == (False, False)
    assert asks({"use_compositing": False, "use_sequencer": False}, use_nodes=True, sequence_editor=Of(strips_all=[1])) == (False, False)


def test_what_blender_does_for_an_item(monkeypatch):
    """A frame as the file has it, but pictures of what would be a movie; a scene that is saved, or an error."""
    for kind, wanted in (("OPEN_EXR", ("OPEN_EXR", "MULTI")), ("FFMPEG", ("PNG", "IMAGE")), ("AVI_JPEG", ("PNG", "IMAGE")), ("AVI_RAW", ("PNG", "IMAGE"))):
        made = Blender(monkeypatch, "/x.blend")
        made.settings.file_format = kind
        made.run("render", frame=7, place="/w/a_0007")
        assert (made.settings.file_format, made.settings.media_type) == wanted and made.done == [7, ("render", {"write_still": True})]
        assert (made.render.filepath, made.render.use_file_extension, made.render.use_overwrite, made.render.use_placeholder) == ("/w/a_0007", True, True, False)
    made = Blender(monkeypatch, "/x.blend")
    del made.settings.media_type  # before 5.0
    made.settings.file_format = "FFMPEG"
    made.run("render", frame=7, place="/w/a")
    assert vars(made.settings) == {"file_format": "PNG"}
    made = Blender(monkeypatch, "/x.blend")
    made.run("save", frame=3, place="/w/frame.shscene")
    made.run("pack", place="/w/x.blend")
    assert made.done == [3, ("save_scene", {"filepath": "/w/frame.shscene"}), ("pack_all", {}), ("pack_libraries", {}),
                         ("save", {"filepath": "/w/x.blend", "copy": True, "compress": True})]
    with pytest.raises(RuntimeError, match="the scene cannot be saved"):
        Blender(monkeypatch, "/x.blend", saves=["CANCELLED"]).run("save", frame=3, place="/w/frame.shscene")


def test_packed_scenes(monkeypatch, tmp_path):
    """Each kind's, in the submission's folder; what Blender cannot pack is named, what is absent is not."""
    folder, asked = tmp_path / "inputs", []
    folder.mkdir()
    (tmp_path / "movie.mp4").touch()

    def ask(scene, _options, task, place):
        asked.append((scene, task))
        pathlib.Path(place).write_text(json.dumps({"inputs": [str(folder / "a.blend"), str(tmp_path / "none.png"), *more]}))
    monkeypatch.setattr(blender, "_ask", ask)
    more = []
    assert blender.pack("/x/a.blend", [], str(folder), options()) == f"{folder}/a.blend" and asked == [("/x/a.blend", "pack"), (f"{folder}/a.blend", "examine")]
    more = [str(tmp_path / "movie.mp4")]
    with pytest.raises(files.Refusal, match="movie.mp4: Blender cannot pack it; submit without --pack, from a shared folder"):
        blender.pack("/x/a.blend", [], str(folder), options())
    for of, name in ((saved, "a.shscene"), (commands, "a.items")):
        (tmp_path / name).write_text(name)
        assert of.pack(str(tmp_path / name), [], str(folder), options()) == f"{folder}/{name}" and (folder / name).read_text() == name


# ---- PNG


def chunk(kind, body, more=0):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body) ^ more)


def png_of(path, rows, header=(3, 1, 8, 0, 0, 0, 0), begin=b"\x89PNG\r\n\x1a\n", more=(), wrong=0, end=b"IEND"):
    path.write_bytes(begin + chunk(b"IHDR", struct.pack(">IIBBBBB", *header)) + b"".join(chunk(*one) for one in more) + chunk(b"IDAT", zlib.compress(bytes(rows)), wrong) + chunk(end, b""))
    return str(path)


@pytest.mark.parametrize("kind, row, wanted", [
    (0, [10, 20, 250], [10, 20, 250]), (1, [10, 20, 250], [10, 30, 24]), (2, [10, 20, 250], [110, 220, 194]), (3, [10, 20, 250], [60, 150, 169]),
    (4, [10, 20, 250], [110, 220, 214]), (4, [200, 1, 2], [44, 101, 103]), (4, [206, 1, 2], [50, 201, 203])])
def test_rows_of_a_png(tmp_path, kind, row, wanted):
    """By the standard's filters, worked out by hand: the last by the left, the upper and the upper left neighbour; the row above is 100, 200, 200."""
    place = png_of(tmp_path / "a.png", [0, 100, 200, 200, kind, *row], (3, 2, 8, 0, 0, 0, 0))
    assert list(png.rows_of(place)[2][1]) == wanted and len(png.rows_of(place, 1)[2]) == 1
    tie = png_of(tmp_path / "b.png", [0, 150, 190, 190, 4, 176, 1, 1], (3, 2, 8, 0, 0, 0, 0))  # left and upper left are equally near: left it is
    assert list(png.rows_of(tie)[2][1])[:2] == [70, 71]


@pytest.mark.parametrize("kind, bits, step", [(0, 8, 1), (2, 8, 3), (3, 8, 1), (4, 8, 2), (6, 8, 4), (0, 16, 2), (6, 16, 8)])
def test_bytes_of_a_pixel(tmp_path, kind, bits, step):
    assert png.rows_of(png_of(tmp_path / "a.png", [1, *[7] * step, *[1] * step], (2, 1, bits, kind, 0, 0, 0)))[1:] == (step, [bytes([7] * step + [8] * step)])


@pytest.mark.parametrize("more, said", [
    ({"begin": b"GIF89a.."}, "no PNG"), ({"wrong": 1}, "chunk IDAT must have its checksum"), ({"end": b"tEXt"}, "it must begin with IHDR and end with IEND"),
    ({"header": (3, 1, 4, 0, 0, 0, 0)}, "a PNG of 8 or 16 bits a channel, not interlaced, was expected"), ({"header": (3, 1, 8, 0, 0, 0, 1)}, "a PNG of 8 or 16 bits"),
    ({"header": (3, 1, 8, 5, 0, 0, 0)}, "a PNG of 8 or 16 bits"), ({"header": (3, 2, 8, 0, 0, 0, 0)}, "it must have 2 rows")])
def test_pngs_that_are_none(tmp_path, more, said):
    with pytest.raises(files.Refusal, match=f"a.png: {said}"):
        png.rows_of(png_of(tmp_path / "a.png", [0, 1, 2, 3], **more))


def test_tiles_of_pngs(tmp_path):
    """Each tile's own pixels; all that tells of colours is the first's."""
    a, b = (png_of(tmp_path / f"{name}.png", [0, *row, 0, *row], (3, 2, 8, 0, 0, 0, 0), more=[(b"gAMA", name.encode())]) for name, row in (("a", [1, 2, 3]), ("b", [4, 5, 6])))
    png.paste([(a, (0, 0, 3, 1)), (a, (0, 1, 1, 1)), (b, (1, 1, 2, 1))], tmp_path / "all.png")
    chunks, step, rows = png.rows_of(tmp_path / "all.png")
    assert [list(row) for row in rows] == [[1, 2, 3], [1, 5, 6]] and step == 1 and [kind for kind, _body in chunks] == [b"IHDR", b"gAMA", b"IDAT", b"IEND"] and chunks[1][1] == b"a"
    other = png_of(tmp_path / "other.png", [0, 1, 2, 3], (1, 1, 8, 2, 0, 0, 0))
    with pytest.raises(files.Refusal, match="other.png: its size and channels must be those of the other tiles"):
        png.paste([(a, (0, 0, 3, 1)), (other, (0, 0, 1, 1))], tmp_path / "all.png")


# ---- what can go wrong with folders and disks


def test_the_program_packs_itself(monkeypatch, tmp_path):
    """One file that can be run and holds no tests; packed so, it copies itself and finds what was built beside it."""
    place = tmp_path / "build/libshade-farm"
    place.parent.mkdir()
    assert main.main(["pack-itself", str(place)]) == 0 and place.stat().st_mode & 0o777 == 0o755 and place.read_bytes().startswith(b"#!/usr/bin/env python3\n")
    names = zipfile.ZipFile(place).namelist()
    assert {"__main__.py", "engines/slurm.py", "renderers/in_blender.py"} <= set(names) and all(name.endswith((".py", "/")) and not name.startswith("tests/t") for name in names)
    assert main.built() == str(ROOT / "build")
    monkeypatch.setattr(main, "HERE", str(place))
    main.own_program(str(tmp_path / "farm.pyz"))
    assert main.built() == str(place.parent) and (tmp_path / "farm.pyz").read_bytes() == place.read_bytes()
    with pytest.raises(SystemExit):
        main.main(["pack-itself"])


def test_files_appear_whole_or_not_at_all(monkeypatch, tmp_path):
    place, synced = tmp_path / "a.json", []
    monkeypatch.setattr(files.os, "fsync", lambda handle: synced.append(os.readlink(f"/proc/self/fd/{handle}")))
    files.write_json(str(place), 1)
    files.synced(str(place))
    assert len(synced) == 2 and synced[0].endswith(".tmp") and synced[1] == str(place)  # on the disk before it has its name
    with pytest.raises(TypeError):
        files.write_json(str(place), {"a": object()})
    assert files.read_json(str(place)) == 1 and os.listdir(tmp_path) == ["a.json"]
    other = tmp_path / "b.png"
    other.write_text("b")
    for links in (True, False):  # a disk without links gets a copy
        files.publish(str(other), str(tmp_path / "shown/a.png"))
        assert os.path.samefile(other, tmp_path / "shown/a.png") == links and (tmp_path / "shown/a.png").read_text() == "b" and os.listdir(tmp_path / "shown") == ["a.png"]
        monkeypatch.setattr(files.os, "link", lambda *_words: (_ for _ in ()).throw(OSError(1, "no links")))
    monkeypatch.setenv("SLURMD_NODENAME", "node7")
    assert files.host() == "node7"
    monkeypatch.delenv("SLURMD_NODENAME")
    monkeypatch.setattr(files.socket, "gethostname", lambda: "plain")
    assert files.host() == "plain" and files.told(str(other)) == {"path": str(other), "size": 1, "sha256": "3e23e8160039594a33894f6564e1b1348bbd7a0088d42c4acb73eeaed59c009d"}
    assert not files.is_as_told(str(other), {"size": 2, "sha256": files.sha256(str(other))}) and not files.is_as_told(str(tmp_path / "none"), {"size": 1})


def test_inputs_are_read_once(job, monkeypatch, tmp_path):
    """On each machine, until their size, place or time is another."""
    scene, read = tmp_path / "a.pov", []
    scene.write_text("one")
    made = job(inputs=[files.told(str(scene))])
    monkeypatch.setattr(files, "sha256", lambda path, real=files.sha256: read.append(path) or real(path))
    host = "one"
    monkeypatch.setattr(files, "host", lambda: host)
    for count in (1, 1):
        made.check_inputs()
        assert len(read) == count
    os.utime(scene, (5, 5))
    made.check_inputs()
    host = "two"
    made.check_inputs()
    assert len(read) == 3 and sorted(os.listdir(made.path("checked"))) == ["one.json", "two.json"]
    os.rmdir(made.path("running"))
    assert abs(made.now() - time.time()) < 60  # a folder that cannot be written: by the own clock
    for name in os.listdir(made.path("checked")):
        os.remove(made.path("checked", name))
    os.rmdir(made.path("checked"))
    made.check_inputs()  # a full disk is no reason to stop
    assert len(read) == 4
    scene.unlink()
    with pytest.raises(files.Refusal, match="a.pov: an input is not there: No such file or directory"):
        made.check_inputs()


def test_a_result_that_cannot_be_put(job, tmp_path, monkeypatch):
    made, tried = job(), []
    work = pathlib.Path(made.path("work/w"))
    work.mkdir()
    (work / "0.png").touch()

    def rename(*words):
        tried.append(words)
        raise PermissionError(13, "no") if len(words[0]) == len(str(work)) and words[0] == str(work) else FileNotFoundError(2, "none")
    monkeypatch.setattr(jobs.os, "rename", rename)
    with pytest.raises(files.Refusal, match="results/0: cannot be put there"):
        made.take("0", str(work), ["0.png"])
    assert [words[0] for words in tried].count(str(work)) == 3


def test_an_item_whose_folder_is_full(job, monkeypatch, capsys):
    """It is told of, without a log where none can be; a part that a disk has damaged is not merged."""
    made = job(items=[{"frame": 1, "tile": [0, 0, 1, 1]}, {"frame": 1, "tile": [1, 0, 1, 1]}])
    monkeypatch.setattr(item.signal, "signal", lambda *_words: None)
    monkeypatch.setattr(files, "host", lambda: "here")
    monkeypatch.setattr(item, "Log", lambda _path: (_ for _ in ()).throw(OSError(28, "No space left")))
    assert item.run(made, 0) == 1 and capsys.readouterr().out == f"item 0 (frame 1, tile 0,0,1,1): [Errno 28] No space left; on here, log {made.log(0)}\n"
    monkeypatch.undo()
    for number in (0, 1):
        whole(made, number)
    pathlib.Path(made.path("results/1/1.png")).write_text("z")
    with pytest.raises(files.Refusal, match=r"item 1 \(frame 1, tile 1,0,1,1\): its result is not whole"):
        item.merge_frame(made, 1, [0, 1])
    with item._Touched(made.path("none/running")):
        pass


def test_slurm_is_asked_until_it_has_ended(job, monkeypatch):
    made, left, slept = job(), ["7_0|RUNNING|None|n\n7_1|PENDING|None|\n", "7_0|RUNNING|None|n\n", ""], []
    files.write_json(made.path("engine.json"), {"engine": "slurm", "ids": ["7"]})
    monkeypatch.setattr(slurm, "_call", lambda *words: left.pop(0) if words[0] == "squeue" else "")
    monkeypatch.setattr(slurm, "time", Of(time=lambda: 100 + len(slept), sleep=slept.append))
    slurm.cancel(made)
    assert left == [] and len(slept) == 2
    left[:] = ["7_0|RUNNING|None|n\n"] * 99
    slurm.cancel(made)
    assert len(slept) == 22  # twenty seconds at most
    monkeypatch.setattr(slurm, "_call", lambda *words: "SlurmUser = x\n")
    assert slurm._largest_array() == 1001
    monkeypatch.setattr(slurm.shutil, "which", lambda name: name == "sbatch")
    slurm.check()
    monkeypatch.setattr(slurm.shutil, "which", lambda name: None)
    with pytest.raises(files.Refusal, match="^sbatch is not installed: this machine is no client of a Slurm cluster. .*--engine local needs no scheduler$"):
        slurm.check()
