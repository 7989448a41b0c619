# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes in files and shade-render, without Blender: the module's pixels, options, files that are broken."""

import signal
import subprocess
import time

import numpy as np
import OpenImageIO as oiio
import pytest

import damaged
from native_scenes import few, render, scene
from shade_render import COMBINED, TOOL, assert_same, made, parts_of, put_parts, run, scene_file

COST = 2.8


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return damaged.whole_files(tmp_path_factory.mktemp("whole"))


@pytest.fixture
def path(tmp_path):
    """Of a scene of two passes."""
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", [(scene(planes=[{"type": "DEPTH"}]), [COMBINED, ("Depth", "Z", "DEPTH", 1.0)])])
    return path


@pytest.mark.parametrize("number", range(2))
def test_pixels_are_the_modules(tmp_path, number):
    (description, passes), = damaged.whole_scenes()[number]
    expected, _ = render(description)
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", [(description, passes[:1])])
    found = made(tmp_path, path)
    assert (np.stack([found[letter] for letter in "RGBA"], -1) == expected[::-1]).all()


def test_options(tmp_path, path):
    whole = made(tmp_path, path)
    assert set(whole) == {*(f"L.Combined.{letter}" for letter in "RGBA"), "L.Depth.Z"}
    alone = made(tmp_path, path, "--passes", "Depth")
    assert_same(alone, {"L.Depth.Z": whole["L.Depth.Z"]})
    for changes, words in (({"samples": few(64)}, ("--samples", few(64))), ({"seed": 9}, ("--seed", 9))):
        expected, _ = render(scene(**changes))
        found = made(tmp_path, path, *words)
        assert (found["L.Combined.R"] == expected[::-1, :, 0]).all()
    assert run("--help").stdout.startswith("usage: shade-render") and run("--version").stdout.startswith("shade-render ")


@pytest.mark.parametrize("words, status, said", [
    ((), 2, "one scene and -o FILE.exr"), (("-o", "x.png"), 2, "-o FILE.exr"), (("-o", "x.exr", "--tile", "1,2,3"), 2, "'1"),
    (("-o", "x.exr", "--samples", "0"), 2, "'0'"), (("-o", "x.exr", "--tile", "0,0,17,1"), 1, "--tile must be within"),
    (("-o", "x.exr", "--passes", "Mist"), 1, "none of these passes"),
    (("-o", "x.exr", "--passes", "Depths,Dept,Combined2"), 1, "none of these passes"), (("-o", "missing/x.exr"), 1, "missing/x.exr: cannot write")])
def test_what_is_wrong_with_a_call_is_told(path, words, status, said):
    done = run(path, *words)
    assert done.returncode == status and said in done.stderr, done.stderr


def test_ctrl_c_leaves_no_file(tmp_path):
    """Of two pictures the first is half of the work."""
    path = tmp_path / "s.shscene"
    short, long = (scene(width=400, height=400, samples=samples) for samples in (1, 65536))
    scene_file.write(path, "L", [(short, [COMBINED]), (long, [("Long", "RGBA", "", 1.0)])])
    going = subprocess.Popen([TOOL, path, "-o", tmp_path / "x.exr", "--progress"], stderr=subprocess.PIPE, text=True)
    assert going.stderr.readline().split()[1:] == ["50", "%"]  # after two seconds
    asked = time.monotonic()
    going.send_signal(signal.SIGINT)
    assert going.wait(60) == 130 and time.monotonic() - asked < 10
    assert [file.name for file in tmp_path.iterdir()] == ["s.shscene"]


@pytest.mark.parametrize("change, said", [
    (lambda header, arrays: header.update(version=2), "version must be an integer from 1 to 1"),
    (lambda header, arrays: header["pictures"][0]["scene"].pop("width"), "pictures[0].scene: width is missing"),
    (lambda header, arrays: header["pictures"][0]["scene"]["meshes"][0].update(positions=[1]),
     "pictures[0].scene.meshes[0]: positions must be {\"array\": k}"),
    (lambda header, arrays: header["pictures"][0]["scene"]["meshes"][0].update(positions=header["pictures"][0]["scene"]["meshes"][0]["material"]),
     "pictures[0].scene.meshes[0]: positions has items of type int32"),
    (lambda header, arrays: header["arrays"][1].update(offset=0), "arrays[1]: offset must be where the array before ends"),
    (lambda header, arrays: header["arrays"][0].update(type="float16"), "arrays[0]: type must be one of float32"),
    (lambda header, arrays: header["arrays"][0].update(shape=[2**40]), "arrays[0]: shape must be whole numbers"),
    (lambda header, arrays: arrays.append(np.zeros(4, np.float32)), "arrays must be all that is behind the header"),
    (lambda header, arrays: header.update(texts=[{"name": "cryptomatte/1/name", "text": "a"}, {"name": "channels", "text": "a"}]),
     "texts[1]: name must be \"cryptomatte/"),
    (lambda header, arrays: header["pictures"][0]["passes"][1].update(plane="MIST"), "pass Depth: plane 'MIST' must be one that the scene has"),
])
def test_a_broken_file_is_told_by_its_key(tmp_path, path, change, said):
    header, arrays = parts_of(path)
    change(header, arrays)
    put_parts(path, header, arrays)
    done = run(path, "-o", tmp_path / "x.exr")
    assert done.returncode == 1 and f"shade-render: {path}: {said}" in done.stderr and not (tmp_path / "x.exr").exists(), done.stderr


def test_damaged_files(tmp_path, files):
    """Of 5,000 that `make soak` tries under sanitizers."""
    for seed in range(max(40, few(96))):
        wrong = damaged.wrong_with(files, tmp_path, seed)
        assert not wrong, f"seed {seed}: {wrong}"


def test_a_tile_knows_its_place(tmp_path, path):
    """Of a region that begins in the midst of the renderer's tiles; of blocks that have enough samples early, too."""
    changes = {"width": 40, "height": 40, "region": (3, 5, 39, 37), "adaptive_threshold": 0.2, "adaptive_min_samples": 4}
    scene_file.write(path, "L", [(scene(**changes), [COMBINED])])
    expected, _ = render(scene(**changes))
    whole, tile = (made(tmp_path, path, *words) for words in ((), ("--tile", "20,10,9,19")))
    spec = oiio.ImageBuf(str(tmp_path / "ours.exr")).spec()
    assert (spec.x, spec.y, spec.width, spec.height, spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (20, 10, 9, 19, 0, 0, 40, 40)
    assert_same(whole, {letter: np.ascontiguousarray(expected[::-1, :, k]) for k, letter in enumerate("RGBA")})
    assert_same(tile, {name: np.ascontiguousarray(pixels[7:26, 17:26]) for name, pixels in whole.items()})
