# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes in files and shade-render, without Blender: the module's pixels, options, files that are broken."""

import os
import signal
import subprocess
import time
import zlib

import numpy as np
import OpenImageIO as oiio
import pytest

import damaged
from native_scenes import few, point, render, scene, sun
from shade_render import COMBINED, TOOL, assert_same, made, parts_of, put_parts, run, scene_file

COST = 4.7


NOISY = {"lights": [sun(angle=1.0)]}  # other samples are another picture


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return damaged.whole_files(tmp_path_factory.mktemp("whole"))


@pytest.fixture
def path(tmp_path):
    """Of a scene of two passes."""
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", [(scene(planes=[{"type": "DEPTH"}], **NOISY), [COMBINED, ("Depth", "Z", "DEPTH", 1.0)])])
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
        expected, _ = render(scene(**NOISY, **changes))
        found = made(tmp_path, path, *words)
        assert (found["L.Combined.R"] == expected[::-1, :, 0]).all() and (found["L.Combined.R"] != whole["L.Combined.R"]).any()
    for word, said in (("--help", "usage: shade-render SCENE"), ("-h", "usage: shade-render SCENE"), ("--version", "shade-render ")):
        done = run(word)
        assert done.returncode == 0 and done.stdout.startswith(said) and not done.stderr


@pytest.mark.parametrize("words, status, said", [
    ((), 2, "one scene and -o FILE.exr"), (("-o", "x.share"), 2, "-o FILE.exr"), (("-o", ".shshare"), 2, "-o FILE.exr"), (("-o", "x.png"), 2, "-o FILE.exr"), (("-o", "x.exr", "--tile", "1,2,3"), 2, "'1"),
    (("-o", "x.exr", "--samples", "0"), 2, "'0'"), (("-o", "x.exr", "--tile", "0,0,17,1"), 1, "--tile must be within"),
    (("-o", "x.exr", "--passes", "Mist"), 1, "none of these passes"),
    (("-o", "x.exr", "--passes", "Depths,Dept,Combined2"), 1, "none of these passes"), (("-o", "missing/x.exr"), 1, "missing/x.exr: cannot write"),
    (("-o", "x.exr", "more"), 2, "one scene and -o FILE.exr"), (("-o", "x.exr", "--nothing"), 2, "--nothing"), (("-o", "x.exr", "--tile", "0,4,1,13"), 1, "--tile must be within"),
    *((("-o", "x.exr", option, value), 2, f"'{value.split(',')[0]}") for option, value in (
        ("--samples", "65537"), ("--samples", "4.5"), ("--seed", "-1"), ("--seed", "4294967296"), ("--threads", "0"), ("--threads", "257"), ("--tile", "0,0,0,4"),
        ("--tile", "0,0,4,0"), ("--tile", "-1,0,4,4"), ("--tile", "0,0,4,4,4"), ("--share", "0,0"), ("--share", "-1,4")))])
def test_what_is_wrong_with_a_call_is_told(path, words, status, said):
    done = run(path, *words)
    assert done.returncode == status and said in done.stderr, done.stderr


@pytest.mark.parametrize("words", [("--samples", "1"), ("--samples", "65536", "--seed", "4294967295", "--threads", "256"), ("--seed", "0", "--threads", "1", "--tile", "0,0,1,1")])
def test_all_that_an_option_may_be_is_taken(tmp_path, words):
    done = run(tmp_path / "no.shscene", "-o", tmp_path / "x.exr", *words)
    assert done.returncode == 1 and done.stderr == f"shade-render: {tmp_path}/no.shscene: No such file or directory\n"


def test_exposure_is_of_light_and_warnings_are_told(tmp_path, path):
    """Not of what covers a pixel; without a library nothing is denoised."""
    scene_file.write(path, "L", [(scene(), [("Combined", "RGBA", "", 2.5), ("Plain", "RGBA", "", 1.0), ("Less", "RGBA", "", -1.0)])])
    found = made(tmp_path, path)
    assert all((found[f"L.Less.{letter}"] == -found[f"L.Plain.{letter}"]).all() for letter in "RGB")
    assert all((found[f"L.Combined.{letter}"] == np.float32(2.5) * found[f"L.Plain.{letter}"]).all() for letter in "RGB")
    assert (found["L.Combined.A"] == found["L.Plain.A"]).all() and found["L.Combined.R"].any() and found["L.Combined.A"].any()
    scene_file.write(path, "L", [(scene(use_denoising=True, denoiser="/no/library"), [COMBINED])])
    done = run(path, "-o", tmp_path / "x.exr")
    assert done.returncode == 0 and done.stderr.startswith("shade-render: warning: ") and done.stderr.endswith("the picture is as noisy as it was\n"), done.stderr
    done = run(path, "-o", tmp_path / "x.shshare")  # a share is not denoised
    assert done.returncode == 0 and not done.stderr
    done = run(path, "-o", tmp_path / "no" / "x.exr")  # which is found before anything is rendered
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "x.exr: cannot write" in done.stderr, done.stderr


def test_as_many_channels_as_a_file_holds(tmp_path, path):
    """256, and no more."""
    passes = [(f"{k}", "RGBA", "", 1.0) for k in range(64)]
    small = scene(width=1, height=1, samples=1, meshes=[])
    scene_file.write(path, "L", [(small, passes)])
    assert len(made(tmp_path, path)) == 256
    scene_file.write(path, "L", [(small, [*passes, ("more", "R", "", 1.0)])])
    done = run(path, "-o", tmp_path / "x.exr")
    assert done.returncode == 1 and done.stderr.endswith(": passes must have 256 channels at most\n") and not (tmp_path / "x.exr").exists(), done.stderr


def test_ctrl_c_leaves_no_file(tmp_path):
    """Of two pictures the first is half of the work."""
    path = tmp_path / "s.shscene"
    short, long = (scene(width=400, height=400, samples=samples) for samples in (1, 65536))
    scene_file.write(path, "L", [(short, [COMBINED]), (long, [("Long", "RGBA", "", 1.0)])])
    going = subprocess.Popen([TOOL, path, "-o", tmp_path / "x.exr", "--progress", "--threads", "1"], stderr=subprocess.PIPE, text=True)
    screen = os.openpty()  # what is told goes elsewhere
    quiet = subprocess.Popen([TOOL, path, "-o", tmp_path / "y.exr", "--threads", "1"], stdout=screen[1], stderr=subprocess.PIPE, text=True)
    assert going.stderr.readline().split()[1:] == ["50", "%"]  # after two seconds
    asked = time.monotonic()
    going.send_signal(signal.SIGINT)
    assert going.wait(60) == 130 and time.monotonic() - asked < 10
    assert quiet.poll() is None  # it has as much to do, and where no terminal is says nothing
    quiet.send_signal(signal.SIGINT)
    assert quiet.communicate(timeout=60)[1] == "" and quiet.returncode == 130
    for end in screen:
        os.close(end)
    assert [file.name for file in tmp_path.iterdir()] == ["s.shscene"]


def test_what_is_written_of_a_scene(tmp_path):
    """Arrays once each, at multiples of 64, and names as they are; not what the export keeps for itself. What cannot be written leaves nothing, or what was there."""
    path, array, other = tmp_path / "s.shscene", np.arange(5, dtype=np.float32), np.arange(5, dtype=np.int32)
    ours = dict.fromkeys(("aovs", "aov_reach", "by_camera", "catchers", "group", "dump"), 1)
    given = {"name": "Käse", "number": np.float32(0.5), "one": array, "same": array[:], "other": memoryview(other), "part": array[:2], "bits": array.view(np.int32), **ours}
    scene_file.write(path, "L", [(given, [COMBINED]), ({"again": array}, [])], [("cryptomatte/a", "ß")])
    header, arrays = parts_of(path)
    first, second = header["pictures"]
    assert first["scene"] == {"name": "Käse", "number": 0.5, "one": {"array": 0}, "same": {"array": 0}, "other": {"array": 1}, "part": {"array": 2}, "bits": {"array": 3}}
    assert second == {"layer": "L", "passes": [], "scene": {"again": {"array": 0}}} and header["texts"] == [{"name": "cryptomatte/a", "text": "ß"}]
    assert first["passes"] == [{"name": "Combined", "channels": "RGBA", "plane": "", "exposure": 1.0}] and header["version"] == 1
    assert [one["offset"] for one in header["arrays"]] == [0, 64, 128, 192] and [one["type"] for one in header["arrays"]] == ["float32", "int32", "float32", "int32"]
    assert [found.tolist() for found in arrays[:3]] == [[0, 1, 2, 3, 4], [0, 1, 2, 3, 4], [0, 1]] and path.stat().st_size % 64 == 0
    scene_file.write(tmp_path / "odd", "L", [({"path": "a\udcff"}, [])])  # of a file whose name is no text
    assert parts_of(tmp_path / "odd")[0]["pictures"][0]["scene"] == {"path": "a?"}
    (tmp_path / "odd").unlink()
    whole = path.read_bytes()
    with pytest.raises(ValueError):
        scene_file.write(path, "L", [({"number": float("nan")}, [])])
    with pytest.raises(AttributeError):  # in the midst of it
        scene_file.put(path, "{}", [array, None])
    with pytest.raises(OSError):
        scene_file.write(tmp_path / "no" / "s.shscene", "L", [({}, [])])
    assert path.read_bytes() == whole and [file.name for file in tmp_path.iterdir()] == ["s.shscene"]


@pytest.mark.parametrize("change, said", [
    (lambda header, arrays: header.update(version=2), "version must be an integer from 1 to 1"),
    (lambda header, arrays: header["pictures"][0]["scene"].pop("width"), "pictures[0].scene: width is missing"),
    (lambda header, arrays: header["pictures"][0]["scene"]["meshes"][0].update(positions=[1]),
     "pictures[0].scene.meshes[0]: positions must be {\"array\": k}"),
    (lambda header, arrays: header["pictures"][0]["scene"]["meshes"][0].update(positions=header["pictures"][0]["scene"]["meshes"][0]["material"]),
     "pictures[0].scene.meshes[0]: positions has items of type int32"),
    (lambda header, arrays: header["pictures"][0]["scene"]["meshes"][0].update(positions={"array": len(header["arrays"])}),
     "pictures[0].scene.meshes[0]: positions must be {\"array\": k} of an array that there is"),
    (lambda header, arrays: header["arrays"][1].update(offset=0), "arrays[1]: offset must be where the array before ends"),
    (lambda header, arrays: header["arrays"][0].update(type="float16"), "arrays[0]: type must be one of float32"),
    *((lambda header, arrays, shape=shape: header["arrays"][0].update(shape=shape), "arrays[0]: shape must be whole numbers") for shape in (
        [2**40], 4, [1.5], [-1], ["4"], [2**20, 2**20])),
    *((lambda header, arrays, value=value: header["pictures"][0]["passes"][0].update(exposure=value), "pictures[0].passes[0]: exposure must be from -1e+30 to 1e+30")
      for value in (1.1e30, -1.1e30)),
    (lambda header, arrays: header["pictures"][0].update(layer=None), "pictures[0]: layer must be a string"), (lambda header, arrays: header.pop("pictures"), "pictures is missing"),
    (lambda header, arrays: header["pictures"][0].update(passes={}), "pictures[0]: passes must be a list"), (lambda header, arrays: header["pictures"][0].update(scene=[]), "pictures[0].scene: an object is expected"),
    (lambda header, arrays: header["pictures"][0]["scene"].update(samples=4.5), "pictures[0].scene: samples must be an integer from 1 to 65536"),
    *((lambda header, arrays, index=index: header["pictures"][0]["scene"]["meshes"][0].update(positions={"array": index}),
       "pictures[0].scene.meshes[0]: positions must be {\"array\": k} of an array that there is") for index in (-1, 0.5)),
    *((lambda header, arrays, weight=weight: header["pictures"][0]["scene"]["materials"][0].update(weight=weight),
       "pictures[0].scene.materials[0]: weight must be 3 operands: finite numbers, or registers [0] to [") for weight in (
        [0, 0], [0, 0, 0, 0], [0, 0, [-1]], [0, 0, [0.5]], [0, 0, [1, 2]], [0, 0, [100000]], [0, 0, "1"], [0, 0, 1e39])),
    (lambda header, arrays: arrays.append(np.zeros(4, np.float32)), "arrays must be all that is behind the header"),
    (lambda header, arrays: header.update(texts=[{"name": "cryptomatte/1/name", "text": "a"}, {"name": "channels", "text": "a"}]),
     "texts[1]: name must be \"cryptomatte/"),
    (lambda header, arrays: header["pictures"][0]["passes"][1].update(plane="MIST"), "pass Depth: plane 'MIST' must be one that the scene has"),
    (lambda header, arrays: header["pictures"][0]["passes"][1].update(channels="XY"), "pass Depth: plane 'DEPTH' must be one that the scene has, of 2 channels or more"),
    (lambda header, arrays: header["pictures"][0]["passes"][1].update(channels=""), "pictures[0].passes[1]: channels must be one to four letters"),
    (lambda header, arrays: header["pictures"][0]["passes"][1].update(channels="ABCDE"), "pictures[0].passes[1]: channels must be one to four letters"),
    (lambda header, arrays: header["pictures"][0]["passes"][1].update(name="Combined", channels="R"), "passes must have channel L.Combined.R once"),
    (lambda header, arrays: header["pictures"][0]["passes"][0].update(exposure="1"), "pictures[0].passes[0]: exposure must be a finite number"),
    (lambda header, arrays: header["pictures"].append({**header["pictures"][0], "scene": {**header["pictures"][0]["scene"], "height": 17}}),
     "pictures[1]: scene must be as large as the first picture's"),
    (lambda header, arrays: header.update(pictures=[]), "pictures must be one or more"), (lambda header, arrays: header.update(pictures=[3]), "pictures[0]: an object is expected"),
    (lambda header, arrays: header["pictures"][0]["scene"].update(samples="4"), "pictures[0].scene: samples must be an integer from 1 to 65536"),
    (lambda header, arrays: header["pictures"][0]["scene"].update(transparent=[]), "pictures[0].scene: transparent must be true or false"),
    (lambda header, arrays: header["pictures"][0]["scene"].update(background=[1, 2]), "pictures[0].scene: background must be a list of 3 finite numbers"),
    (lambda header, arrays: header.update(texts=[{"name": "cryptomatte/" + 244 * "n", "text": "a"}]), "texts[0]: name must be \"cryptomatte/"),
])
def test_a_broken_file_is_told_by_its_key(tmp_path, path, change, said):
    header, arrays = parts_of(path)
    change(header, arrays)
    put_parts(path, header, arrays)
    done = run(path, "-o", tmp_path / "x.exr")
    assert done.returncode == 1 and f"shade-render: {path}: {said}" in done.stderr and not (tmp_path / "x.exr").exists(), done.stderr


def test_the_last_register_may_be_read(tmp_path, path):
    header, arrays = parts_of(path)
    header["pictures"][0]["scene"]["materials"][0].update(weight=[True, 0, [255]], nodes=[
        {"type": "MATH", "operation": "ADD", "a": [0.5], "b": [0.5], "c": [0], "out": [[255]]}])
    put_parts(path, header, arrays)
    found = made(tmp_path, path)
    assert (found["L.Combined.G"] == 0).all() and found["L.Combined.R"].all() and found["L.Combined.B"].all()


def test_a_file_that_ends_early_is_told(tmp_path, path):
    whole = path.read_bytes()
    path.write_bytes(whole[:-64])
    done = run(path, "-o", tmp_path / "x.exr")
    assert done.returncode == 1 and "]: shape must be whole numbers" in done.stderr, done.stderr
    for end in (16, 64, 640):
        path.write_bytes(whole[:end])
        done = run(path, "-o", tmp_path / "x.exr")
        assert done.returncode == 1 and f"shade-render: {path}: its header must end in the file" in done.stderr, (end, done.stderr)


def test_a_header_that_is_none_is_told(tmp_path, path):
    whole = path.read_bytes()
    length = int.from_bytes(whole[8:12], "little")

    def with_header(text):
        header = text.ljust(length)
        return whole[:12] + zlib.crc32(header).to_bytes(4, "little") + header + whole[16 + length:]

    for data, said in ((b"SHSCENE\n" + whole[8:], 'no saved scene: "shscene" must be its first line'), (whole[:15], 'no saved scene: "shscene"'), (b"", "it is empty"),
                       (with_header(b"[1]"), "its header must be an object"), (with_header(b'{"version": 1,'), "its header must be JSON: "),
                       (with_header(b"{}\0"), "its header must be JSON: it has a zero"), (whole[:16] + b" " + whole[17:], "its header must have the checksum that is before it"),
                       (whole[:16 + length] + bytes([whole[16 + length] ^ 1]) + whole[17 + length:], "arrays[0]: checksum must be that of the array")):
        path.write_bytes(data)
        done = run(path, "-o", tmp_path / "x.exr")
        assert done.returncode == 1 and done.stderr.startswith(f"shade-render: {path}: {said}"), (said, done.stderr)


def test_damaged_files(tmp_path, files):
    """Of 5,000 that `make soak` tries under sanitizers."""
    for seed in range(max(40, few(72))):
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


def shared(folder, path, parts):
    """The names of parts of its picture, each of words."""
    names = [folder / f"{number}.shshare" for number in range(len(parts))]
    for name, words in zip(names, parts):
        done = run(path, "-o", name, *words)
        assert done.returncode == 0 and not done.stderr, done.stderr
    return names


def many_passes(**changes):
    """Whose colours divide light, whose names are ranked, and whose distances are those of the first sample."""
    (description, passes), = damaged.whole_scenes()[0]
    planes = "DEPTH", "NORMAL", "VECTOR", "DIFFUSE_DIRECT", "GLOSSY_DIRECT", "GLOSSY_COLOR", "SAMPLES", "MIST"
    more = [(plane, "XYZ" if plane in ("NORMAL", "DIFFUSE_DIRECT", "GLOSSY_DIRECT", "GLOSSY_COLOR") else "X", plane, 2.0) for plane in planes]
    return {**description, "width": 40, "height": 24, "planes": [{"type": plane} for plane in planes], **changes}, [COMBINED, *more, passes[-1]]


def test_tiles_merged_are_the_picture(tmp_path):
    """To the last bit, wherever they are cut; of blocks that have enough samples early, too."""
    path = tmp_path / "s.shscene"
    description, passes = many_passes(samples=20, region=(1, 2, 39, 24))
    scene_file.write(path, "L", [(description, passes), (description, [("AO", "RGB", "", 1.0)])])
    parts = shared(tmp_path, path, [("--tile", tile) for tile in ("1,0,20,13", "21,0,18,13", "1,13,7,9", "8,13,31,9")])
    assert_same(made(tmp_path, path, "--merge", *parts), made(tmp_path, path))
    assert set(made(tmp_path, path, "--merge", *parts, "--passes", "AO")) == {f"L.AO.{letter}" for letter in "RGB"}


def test_denoising_comes_after_the_merge(tmp_path):
    """By the simple filter, which needs no library: of the whole picture, across the edges of tiles."""
    path = tmp_path / "s.shscene"
    description = many_passes(samples=4, adaptive_threshold=0.0, use_denoising=True, denoiser="?none", region=(0, 0, 40, 24))[0]
    scene_file.write(path, "L", [(description, [COMBINED, ("Noisy Image", "RGBA", "NOISY", 1.0)])])
    found = made(tmp_path, path, "--merge", *shared(tmp_path, path, [("--tile", tile) for tile in ("0,0,20,24", "20,0,20,24")]))
    assert_same(found, made(tmp_path, path))
    assert (found["L.Combined.R"] != found["L.Noisy Image.R"]).any()


@pytest.mark.parametrize("cuts", [(0, 1, 3, 17, 20), (0, 10, 20), (0, 4, 16, 20)])
def test_shares_merged_are_the_picture(tmp_path, cuts):
    """But for rounding, however they are cut."""
    path = tmp_path / "s.shscene"
    scene_file.write(path, "L", [many_passes(samples=20, adaptive_threshold=0.0)])
    parts = shared(tmp_path, path, [("--share", f"{first},{end}") for first, end in zip(cuts, cuts[1:])])
    whole, found = made(tmp_path, path), made(tmp_path, path, "--merge", *parts[::-1])
    assert set(found) == set(whole)
    for name, pixels in whole.items():
        assert np.allclose(found[name], pixels, rtol=3e-6, atol=3e-6), (name, np.abs(found[name] - pixels).max())


def test_shares_say_how_many_samples_and_which(tmp_path, path):
    """Others than the scene's."""
    given = "--samples", "6", "--seed", "3"
    parts = shared(tmp_path, path, [("--share", "0,4", *given), ("--share", "4,6", *given)])
    whole, found = made(tmp_path, path, *given), made(tmp_path, path, "--merge", *parts)
    assert set(found) == set(whole) and all(np.allclose(found[name], whole[name], rtol=3e-6, atol=3e-6) for name in whole)
    assert (whole["L.Combined.R"] != made(tmp_path, path)["L.Combined.R"]).any()
    done = run(path, "-o", tmp_path / "no" / "x.shshare")
    assert done.returncode == 1 and done.stderr.startswith(f"shade-render: {tmp_path}/no/x.shshare: cannot write"), done.stderr


def test_shares_hold_each_picture(tmp_path):
    """Of AOVs and groups of lights: each pass comes from its own."""
    path = tmp_path / "s.shscene"
    pictures = [(scene(samples=8, lights=[point((0, 0, 2), (k, 2 * k, 3 * k))]), [(name, "RGB", "", 1.0)])
                for k, name in ((1, "Combined"), (2, "Twice"), (5, "Five"))]
    scene_file.write(path, "L", pictures)
    whole, found = made(tmp_path, path), made(tmp_path, path, "--merge", *shared(tmp_path, path, [("--share", "0,4"), ("--share", "4,8")]))
    for letter in "RGB":
        first = found[f"L.Combined.{letter}"]
        assert first.max() > 0 and all(np.allclose(found[f"L.{name}.{letter}"], times * first, rtol=1e-5) for name, times in (("Twice", 2), ("Five", 5)))
        assert np.allclose(first, whole[f"L.Combined.{letter}"], rtol=3e-6)


def test_shares_of_cloth_are_cut_where_its_samples_are_not_shaded_together(tmp_path):
    path = tmp_path / "s.shscene"
    (description, passes), _ = damaged.whole_scenes()[2]
    scene_file.write(path, "L", [(description | {"samples": 20}, passes)])
    whole, found = made(tmp_path, path), made(tmp_path, path, "--merge", *shared(tmp_path, path, [("--share", "0,16"), ("--share", "16,20")]))
    assert all(np.allclose(found[name], whole[name], rtol=3e-6, atol=3e-6) for name in whole)
    for part in ("0,8", "8,20", "4,17", "1,4"):
        done = run(path, "-o", tmp_path / "x.shshare", "--share", part)
        assert done.returncode == 1 and "must begin and end at 0, 4, 16" in done.stderr, part


def test_shares_that_make_no_picture_are_told(tmp_path):
    path, other = tmp_path / "s.shscene", tmp_path / "other.shscene"
    scene_file.write(path, "L", [(scene(samples=20), [COMBINED])])
    scene_file.write(other, "L", [(scene(samples=20, seed=2), [COMBINED])])
    first, last, both = shared(tmp_path, path, [("--share", "0,8"), ("--share", "8,20"), ("--share", "4,12")])
    elsewhere = tmp_path / "elsewhere.shshare"
    assert run(path, "-o", elsewhere, "--share", "0,8", "--seed", "3").returncode == 0
    fewer = tmp_path / "fewer.shshare"
    assert run(path, "-o", fewer, "--share", "0,8", "--samples", "16").returncode == 0
    broken = tmp_path / "broken.shshare"
    broken.write_bytes(first.read_bytes()[:-8])
    for words, said in (((first,), "shares are missing: these have 40 % of"), ((first, both, last), f"{first} and {both}: both have"),
                        ((elsewhere, last), "its samples and seed must be those of the others"),
                        ((fewer, last), "its samples and seed must be those of the others"), ((broken, last), f"{broken}: it must end in the checksum"),
                        ((path,), "no share of a picture"), ((tmp_path / "no", last), "no: No such file")):
        done = run(path, "-o", tmp_path / "x.exr", "--merge", *words)
        assert done.returncode == 1 and said in done.stderr, (words, done.stderr)
    done = run(other, "-o", tmp_path / "x.exr", "--merge", first, last)
    assert done.returncode == 1 and f"{first}: it is of another scene" in done.stderr
    for changes, words, said in (({"adaptive_threshold": 0.1}, ("--share", "0,8"), "adaptive sampling goes by all samples"),
                                 ({"time_limit": 9.0}, (), "it has a Time Limit"), ({}, ("--share", "8,21"), "within the 20 samples")):
        scene_file.write(other, "L", [(scene(samples=20, **changes), [COMBINED])])
        done = run(other, "-o", tmp_path / "x.shshare", *words)
        assert done.returncode == 1 and said in done.stderr, done.stderr
    assert not (tmp_path / "x.exr").exists() and not (tmp_path / "x.shshare").exists()


# Of a share: which of its eleven numbers is another, or what stands instead of its bytes; and what is said
ALTERED = [(0, 2, "its version must be 1"), (10, 2, "it is of another scene"), (2, 0, "it must be of a part"), (2, 65537, "it must be of a part"), (2, 65536, "shares are missing"), (4, 8, "it must be of a part"), (5, 21, "it must be of a part"), (4, 1, "it must be of a part"),
           (6, -1, "it must be of a part"), (7, 16, "it must be of a part"), (8, 17, "it must be of a part"), (9, 17, "it must be of a part"), (11, 4, "it must have the channels of its scene"),
           (8, 15, "it must end with its last pixel"), (None, b"", "it is empty"), (None, b"shshare\n", "no share of a picture"), (None, b"SHSHARE\n" + bytes(99), "no share of a picture")]


def test_shares_that_say_what_is_not_so_are_told(tmp_path, path):
    name, = shared(tmp_path, path, [("--share", "0,1")])
    whole = name.read_bytes()
    for at, other, said in ALTERED:
        numbers = np.frombuffer(whole[8:-4], np.int32).copy()
        if at is not None:
            numbers[at] = other
            data = b"shshare\n" + numbers.tobytes()
            other = data + zlib.crc32(data).to_bytes(4, "little")
        name.write_bytes(other)
        done = run(path, "-o", tmp_path / "x.exr", "--merge", name)
        assert done.returncode == 1 and said in done.stderr and done.stderr.startswith("shade-render: " if said.startswith("shares") else f"shade-render: {name}: {said}"), (at, said, done.stderr)


@pytest.mark.parametrize("words, said", [
    *((("--merge", "a.shshare", "-o", "x.exr", *more), "--merge expects one FILE.shshare") for more in (
        ("--tile", "0,0,1,1"), ("--share", "0,1"), ("--samples", "4"), ("--seed", "0"), ("-o", "x.shshare"))),
    (("--share", "0,4", "-o", "x.exr"), "--share expects -o FILE.shshare"), (("--share", "4,4", "-o", "x.shshare"), "'4"),
    (("--merge", "-o", "x.exr"), "--merge expects one FILE.shshare"), (("-o", "x.shshare", "--passes", "Combined"), "a share has all passes")])
def test_what_is_wrong_with_a_call_for_shares_is_told(path, words, said):
    done = run(path, *words)
    assert done.returncode == 2 and said in done.stderr, done.stderr
