# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs that time the native module: what they render is what they say, and numbers are a sample's of the fastest repetition."""

import re
import sys
from types import SimpleNamespace as Of

import numpy as np
import pytest

from native_scenes import ROOT, native

sys.path.insert(0, str(ROOT / "blender_addon_c/native"))
import bench  # noqa: E402
import bench_nodes  # noqa: E402

COST = 0.6


def rendered(scene):
    """Its picture, and how many samples were timed."""
    job, pixels = native.start(scene), np.zeros(4 * scene["width"] * scene["height"], np.float32)
    native.wait(job, 1e9)
    assert native.poll(job)["state"] == "done", native.poll(job)
    native.image(job, pixels)
    samples = native.timings(job)["samples"]
    native.free(job)
    return pixels.reshape(scene["height"], scene["width"], 4), samples


def test_the_plate():
    """Normals of crossed sines, .6 steep at most; a square of two by two of so many triangles that face the eye; the one is seen by the other."""
    image = bench.bumps(64, 8, 0.6)
    normal = 2.0 * image[..., :3] - 1
    slope = -normal[..., :2] / normal[..., 2:]
    assert np.allclose(np.linalg.norm(normal, axis=-1), 1, atol=1e-5) and (normal[..., 2] > 0).all() and (image[..., 3] == 1).all() and image.dtype == np.float32
    t = (np.arange(64) + 0.5) / 64
    assert np.allclose(slope[..., 0], 0.6 * np.cos(16 * np.pi * t)[None], atol=1e-5) and np.allclose(slope[..., 1], 0.6 * np.cos(16 * np.pi * t)[:, None], atol=1e-5)
    assert bench.bumps.__defaults__ == (2048, 8, 0.6)
    for cuts in (1, 3):
        made = bench.grid(cuts)
        corners = made["positions"][made["corner_position"]].reshape(-1, 3, 3)
        areas = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert len(areas) == 2 * cuts**2 == len(made["material"]) and np.allclose(areas, [(0, 0, 2 / cuts**2)], atol=1e-6)
        assert np.allclose(made["corner_uvs"], (made["positions"][made["corner_position"], :2] + 1) / 2) and (made["corner_normals"] == (0, 0, 1)).all()
    pictures = [rendered(bench.plate(16, 2, 1, cuts, image)) for cuts in (1, 3)]
    assert all(np.allclose(picture[..., 3], 1) and 0 < picture[..., 0].mean() < 10 and samples == 2 * 16 * 16 for picture, samples in pictures)
    assert np.allclose(pictures[0][0], pictures[1][0], atol=1e-3)  # the same plate, however it is cut
    scene = bench.plate(image=image)
    assert (scene["width"], scene["height"], scene["samples"], scene["threads"], scene["region"]) == (512, 512, 64, 0, (0, 0, 512, 512))
    steel = scene["materials"][0]
    assert [steel[word] for word in ("ex", "ey", "detail", "f0", "f82", "kd")] == [6170.84, 7.876543, "ROTATE", (1, 1, 1), (1, 1, 1), (0, 0, 0)]
    assert np.isclose(np.linalg.norm(scene["lights"][0]["direction"]), 1)


class Native:
    """Jobs that take as long as they are told, one after another."""

    def __init__(self, times, state="done"):
        self.times, self.state, self.scenes, self.freed, self.waited = list(times), state, [], [], set()

    def start(self, scene):
        self.scenes.append(scene)
        return len(self.scenes)

    def wait(self, job, seconds):
        assert seconds >= 1e6
        self.waited.add(job)

    def poll(self, job):
        assert job in self.waited
        return {"state": self.state, "message": "no memory"}

    def timings(self, job):
        return dict(self.times[(job - 1) % len(self.times)])

    def free(self, job):
        self.freed.append(job)

    def isa(self):
        return "avx9"


def test_what_bench_prints(monkeypatch, capsys):
    """Of each part the least, stages in nanoseconds a sample, the rest in seconds; what took nothing is left out."""
    took = [{"samples": 2e6, "wall": 0.5, "image": 0.03, "mesh": 0.02, "bvh": 0.01, "trace": 0.2, "shade": 0.4, "dump": 0.0},
            {"samples": 2e6, "wall": 0.4, "image": 0.04, "mesh": 0.01, "bvh": 0.02, "trace": 0.3, "shade": 0.1, "dump": 0.0}]
    fake, clock = Native(took), iter((1.0, 1.75, 5.0, 5.25))
    monkeypatch.setattr(bench, "load", lambda path: fake if path == "other.so" else None)
    monkeypatch.setattr(bench, "bumps", lambda: np.ones((2, 2, 4), np.float32))
    monkeypatch.setattr(bench, "machine", lambda: ("a machine", 7, "cc 1"))
    monkeypatch.setattr(bench, "time", Of(process_time=lambda: next(clock)))
    monkeypatch.setattr(sys, "argv", ["bench.py", "--module", "other.so", "--size", "8", "--samples", "3", "--repeat", "2", "--mesh", "2"])
    bench.main()
    said = [re.sub(" +", " ", line).strip() for line in capsys.readouterr().out.splitlines()]
    assert said == ["a machine, 7 threads, avx9, cc 1", "8 x 8, 3 samples, 8 triangles", "trace 100.00 ns", "shade 50.00 ns", "sum 150.00 ns a sample and thread",
                    "image 0.0300 s", "mesh 0.0100 s", "bvh 0.0100 s", "wall 0.4000 s", "cpu 0.2500 s", "5.0 million samples a second, all threads, all included"], said
    assert fake.freed == [1, 2] and [(scene["width"], scene["samples"], scene["threads"], len(scene["meshes"][0]["material"])) for scene in fake.scenes] == [(8, 3, 0, 8)] * 2
    monkeypatch.setattr(sys, "argv", ["bench.py", "--module", "other.so", "--threads", "3"])
    fake.state, fake.scenes[:] = "failed", []
    monkeypatch.setattr(bench, "time", Of(process_time=lambda: 0.0))
    with pytest.raises(SystemExit, match="no memory"):
        bench.main()
    assert fake.scenes[0]["threads"] == 3 and fake.scenes[0]["width"] == 512 and fake.scenes[0]["samples"] == 64


def test_the_machine_that_is_timed():
    model, cores, compiler = bench.machine()
    assert re.search(r" family (\d+|None) model (\d+|None)\b", model) and 1 <= cores <= 4096 and compiler


WHITE = {"width": 4, "height": 4, "channels": 4, "srgb": True, "wrap": "REPEAT", "filter": "LINEAR"}
IMAGES = {(kind, k): {**WHITE, "data": np.full((4, 4, 4), value, kind)} for kind, value in ((np.uint8, 255), (np.float32, 1.0)) for k in range(4)}


def test_nodes_that_are_timed():
    """So many of them, in order; white images are white, alone and averaged; thirty nodes say the same from near and from far where all images are even."""
    cases = bench_nodes.cases()
    assert list(cases) == ["plain", "bytes", "float", "averaged bytes", "averaged float", "30 nodes", "near", "near, averaged"]
    assert {name: case[3] for name, case in cases.items() if case[3]} == {"averaged bytes": 0.25, "averaged float": 0.25, "near, averaged": 0.25}
    assert [case[2] for case in cases.values()] == [np.uint8, np.uint8, np.float32, np.uint8, np.float32, np.uint8, np.uint8, np.uint8]
    assert len(bench_nodes.thirty(1, True)[0]) == 34
    with_image = {name: [node["image"] for node in case[0] if node["type"] == "IMAGE"] for name, case in cases.items()}
    assert with_image == {"plain": [], **dict.fromkeys(("bytes", "float", "averaged bytes", "averaged float"), [0]), **dict.fromkeys(("30 nodes", "near", "near, averaged"), [0, 1, 2, 3])}
    assert [sum(bool(node.get("averaged")) for node in case[0]) for case in cases.values()] == [0, 0, 0, 1, 1, 0, 0, 4]
    transforms = [[node["matrix"][:4:3] for node in cases[name][0] if node["type"] == "TRANSFORM"] for name in ("30 nodes", "near", "near, averaged")]
    assert transforms == [[[3, 0.1]], [[0.375, 0.1]], [[0.375, 0.1]] * 3]
    seen = {}
    for name, case in cases.items():
        scene = bench_nodes.scene_of(case, 4, 1, IMAGES)
        assert scene["threads"] == 1 and scene["texture_blur"] == case[3] and len(scene["images"]) == len(set(with_image[name]))
        seen[name] = rendered(scene)[0][..., :3].mean((0, 1))
    matt = seen["bytes"] / seen["plain"]
    assert np.allclose(matt, 2, rtol=1e-4), seen  # white is twice as bright as .5
    assert all(np.allclose(seen[name], seen["bytes"], rtol=1e-4) for name in ("float", "averaged bytes", "averaged float")), seen
    bright = 1.0  # of white, by sixteen steps; a hue of a whole turn is red, and as much blue as one is a little more
    for _ in range(4):
        bright = max(0.8 * (0.9 * bright + 0.05) + 0.1, 0.1)
    assert np.allclose(seen["30 nodes"][:2], seen["bytes"][:2] * (bright**1.5, 0), rtol=1e-4), (seen, bright)
    assert all(np.allclose(seen[name], seen["30 nodes"], rtol=1e-4) for name in ("near", "near, averaged")), seen
    whole = bench_nodes.picture(np.float32, 1)
    assert whole["data"].shape == (2048, 2048, 4) and whole["data"].dtype == np.float32 and {**whole, "width": 4, "height": 4, "data": 0} == {**WHITE, "data": 0}
    assert np.isclose(whole["data"][::16].mean(), 0.5, rtol=1e-2) and whole["data"][::16].max() == 1


def test_what_bench_of_nodes_prints(monkeypatch, capsys):
    """Nanoseconds a vertex more than of one colour, of each build its own."""
    builds = {"one.so": 0, "two.so": 1}
    took = {name: ((0.3 + k) * 1e-3, (0.3 + 2 * k) * 1e-3) for k, name in enumerate(bench_nodes.cases())}
    asked, repeats = [], iter([2.0, 1.0, 3.0] * 99)

    def seconds(module, scene):
        assert scene["size"] == (256, 64, 8)
        if module == 0 and scene["case"] == "plain":
            asked.append(next(repeats))
        return asked[-1] * took[scene["case"]][module], 1000
    monkeypatch.setattr(bench_nodes, "load", builds.get)
    monkeypatch.setattr(bench_nodes, "picture", lambda kind, k: (kind, k))
    cases = bench_nodes.cases
    monkeypatch.setattr(bench_nodes, "cases", lambda: {name: name for name in cases()})
    monkeypatch.setattr(bench_nodes, "scene_of", lambda case, size, samples, images: {"case": case, "size": (size, samples, len(images))})
    monkeypatch.setattr(bench_nodes, "seconds", seconds)
    monkeypatch.setattr(sys, "argv", ["bench_nodes.py", "--module", "one.so", "--other", "two.so", "--repeat", "3"])
    bench_nodes.main()
    lines = capsys.readouterr().out.splitlines()
    assert [line[:16].strip() for line in lines] == list(took) and len(asked) == 3
    assert [re.findall(r"[\d.]+ ns", line) for line in lines] == [[f"{1000 * k:.2f} ns", f"{2000 * k:.2f} ns"] for k in range(8)], lines
    monkeypatch.undo()
    fake = Native([{"samples": 7.0, "wall": 9.0, "image": 9.0, "mesh": 9.0, "bvh": 9.0, "trace": 0.25, "shade": 0.5}])
    assert bench_nodes.seconds(fake, {}) == (0.75, 7) and fake.freed == [1]
    fake.state = "failed"
    with pytest.raises(SystemExit, match="no memory"):
        bench_nodes.seconds(fake, {})
