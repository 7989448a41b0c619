# SPDX-License-Identifier: Apache-2.0
"""`shade scratch`: the files against each other and against points, and bad requests."""
import os
import pathlib
import re
import signal
import subprocess
import time

import numpy as np
import OpenImageIO as oiio
import pytest

COST = 3.0

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))
SCRATCHES = ("--pits", "300", "--radius", ".004,.02", "--stretch", "1,8", "--spread", "90",
             "--layer", "--pits", "40", "--stretch", "20")


def run(*options, text="", cwd=None):
    return subprocess.run([SHADE, "scratch", *map(str, options)], input=text, cwd=cwd,
                          capture_output=True, text=True, timeout=120)


def make(*options):
    result = run(*options)
    assert result.returncode == 0, result.stderr
    assert result.stderr == ""


def pixels(path):
    image = oiio.ImageInput.open(str(path))
    assert image, oiio.geterror()
    values = image.read_image("float")
    spec = image.spec()
    image.close()
    return values, spec


def test_height_and_normal_agree_with_points(tmp_path):
    width, height = 120, 90
    make("-o", tmp_path / "n.exr", "--height", tmp_path / "h.exr", "--size", f"{width}x{height}",
         *SCRATCHES)
    normals, spec = pixels(tmp_path / "n.exr")
    assert spec.channelnames == ("R", "G", "B") and str(spec.format) == "float"
    heights, spec = pixels(tmp_path / "h.exr")
    assert spec.channelnames == ("Y",)
    u = (np.arange(width) + 0.5) / width
    v = 1 - (np.arange(height) + 0.5) / height  # row 0 is the top
    lines = "".join(f"{a!r} {b!r}\n" for b in map(float, v) for a in map(float, u))
    # the height over the width of the tile comes from --size
    result = run("--eval", "--size", f"{width}x{height}", *SCRATCHES, text=lines)
    assert result.returncode == 0, result.stderr
    values = np.array(result.stdout.split(), float).reshape(height, width, 7)
    assert np.abs(values[..., 0] - heights[..., 0]).max() < 1e-8
    assert np.abs(values[..., 1:4] - (2 * normals - 1)).max() < 1e-6
    assert (values[..., 4:] == 0).all()
    assert heights.min() < -0.001 and heights.max() == 0
    make("--height", tmp_path / "alone.exr", "--size", f"{width}x{height}", *SCRATCHES)
    assert (tmp_path / "alone.exr").read_bytes() == (tmp_path / "h.exr").read_bytes()
    # averages of 3 x 3 points a texel, which are those of a picture three times as large
    make("--height", tmp_path / "mean.exr", "--size", f"{width // 3}x{height // 3}", "--samples", 3, *SCRATCHES)
    mean = heights.reshape(height // 3, 3, width // 3, 3).mean((1, 3))
    assert np.abs(pixels(tmp_path / "mean.exr")[0][..., 0] - mean).max() < 1e-7 < mean.std()


def test_normals_are_the_gradient_of_the_height_file(tmp_path):
    size = 1024
    make("-o", tmp_path / "n.exr", "--height", tmp_path / "h.exr", "--size", size, "--pits", 9,
         "--radius", ".05,.2", "--stretch", "1,2", "--spread", "90", "--depth", ".2,.5")
    normals = 2 * pixels(tmp_path / "n.exr")[0].astype(float) - 1
    h = pixels(tmp_path / "h.exr")[0][..., 0].astype(float) * size
    slopes = -normals[..., :2] / normals[..., 2:]
    # the picture repeats: differences go round its edges, and rows run downwards
    x = (np.roll(h, -1, 1) - np.roll(h, 1, 1)) / 2
    y = (np.roll(h, 1, 0) - np.roll(h, -1, 0)) / 2
    # off the creases the gradient changes slowly from texel to texel
    smooth = np.ones((size, size), bool)
    for k in range(2):
        for axis in range(2):
            for step in (-1, 1):
                there = np.roll(slopes[..., k], step, axis)
                smooth &= np.abs(slopes[..., k] - there) < 0.03
    assert smooth.mean() > 0.8 and (h[smooth] < 0).mean() > 0.2
    # second order in the texel: the third derivative of a cap times texel^2/6
    error = np.hypot(slopes[..., 0] - x, slopes[..., 1] - y)[smooth]
    assert error.max() < 2e-3 and np.median(error) < 1e-5


@pytest.mark.parametrize("name, options", [
    ("a.png", ()), ("a.png", ("--bits", "8")), ("a.exr", ()), ("a.exr", ("--half",))])
def test_same_bytes_whatever_the_threads(tmp_path, name, options):
    files = []
    for threads in (1, 2, 3, 7):
        make("-o", tmp_path / name, "--size", "200x130", "--threads", threads, *options, *SCRATCHES)
        files.append((tmp_path / name).read_bytes())
    assert len(set(files)) == 1
    make("-o", tmp_path / name, "--size", "200x130", "--seed", "2", *options, *SCRATCHES)
    assert (tmp_path / name).read_bytes() != files[0]


@pytest.mark.parametrize("name, options, kind, step", [
    ("a.png", ("--bits", "8"), "uint8", 1 / 255), ("a.png", (), "uint16", 1 / 65535),
    ("a.exr", ("--half",), "half", 2.0**-11)])
def test_every_format_holds_the_same_normals(tmp_path, name, options, kind, step):
    make("-o", tmp_path / "f.exr", "--size", 64, *SCRATCHES)
    make("-o", tmp_path / name, "--size", 64, *options, *SCRATCHES)
    truth = pixels(tmp_path / "f.exr")[0]
    got, spec = pixels(tmp_path / name)
    assert str(spec.format) == kind
    assert np.abs(got - truth).max() <= 0.51 * step


def test_directx_turns_green(tmp_path):
    make("-o", tmp_path / "a.exr", "--size", 64, *SCRATCHES)
    make("-o", tmp_path / "b.exr", "--size", 64, "--directx", *SCRATCHES)
    a, b = pixels(tmp_path / "a.exr")[0], pixels(tmp_path / "b.exr")[0]
    assert np.abs(a[..., 1] + b[..., 1] - 1).max() < 1e-6
    assert (a[..., [0, 2]] == b[..., [0, 2]]).all()
    assert np.abs(a[..., 1] - 0.5).max() > 0.05


def test_the_comment_makes_the_picture_again(tmp_path):
    make("-o", tmp_path / "a.exr", "--size", "50x40", "--seed", "7", "--directx", "--samples", "2", "--direction", "30", *SCRATCHES,
         "--direction", "-50", "--spread", "5")
    command = pixels(tmp_path / "a.exr")[1].get_string_attribute("ImageDescription") or \
        pixels(tmp_path / "a.exr")[1].get_string_attribute("comments")
    assert command.startswith("shade scratch ")
    make("-o", tmp_path / "b.exr", *command.split()[2:])
    assert np.abs(pixels(tmp_path / "a.exr")[0] - pixels(tmp_path / "b.exr")[0]).max() < 1e-6


@pytest.mark.parametrize("size, shape", [
    ("1", (1, 1)), ("1x7", (7, 1)), ("33x17", (17, 33)), ("16384x20", (20, 16384))])
def test_any_size(tmp_path, size, shape):
    for name in ("a.png", "a.exr"):
        make("-o", tmp_path / name, "--size", size, "--pits", 50)
        assert pixels(tmp_path / name)[0].shape[:2] == shape


@pytest.mark.parametrize("size", ["100x200", "200x100", "200"])
def test_pits_are_round_whatever_the_shape_of_the_picture(tmp_path, size):
    """Their radius is in widths of the picture."""
    make("--height", tmp_path / "h.exr", "--size", size, "--pits", 1, "--radius", ".1", "--stretch", "1")
    width = int(size.split("x")[0])
    assert (pixels(tmp_path / "h.exr")[0] < 0).sum() == pytest.approx(np.pi * (.1 * width)**2, rel=.05)


def test_no_pits_make_a_flat_map(tmp_path):
    make("-o", tmp_path / "a.exr", "--height", tmp_path / "h.exr", "--size", 8, "--pits", 0)
    assert (pixels(tmp_path / "a.exr")[0] == [0.5, 0.5, 1]).all()
    assert (pixels(tmp_path / "h.exr")[0] == 0).all()


def test_footprints_add_up_to_the_picture(tmp_path):
    make("-o", tmp_path / "n.exr", "--size", 1024, *SCRATCHES)
    normals = 2 * pixels(tmp_path / "n.exr")[0].astype(float) - 1
    slopes = (-normals[..., :2] / normals[..., 2:]).reshape(-1, 2)
    n = 8
    lines = "".join(f"{(i + .5) / n} {(j + .5) / n} {1 / n} 0 0 {1 / n}\n"
                    for i in range(n) for j in range(n))
    result = run("--eval", *SCRATCHES, text=lines)
    values = np.array(result.stdout.split(), float).reshape(n * n, 7)
    mean = -values[:, 1:3] / values[:, 3:4]
    got = (values[:, 4:] + mean[:, [0, 0, 1]] * mean[:, [0, 1, 1]]).mean(0)
    want = (slopes[:, [0, 0, 1]] * slopes[:, [0, 1, 1]]).mean(0)
    assert np.abs(got - want).max() < 0.02 * want.max()
    assert (values[:, 0] < 0).all()


BAD = [
    ((), "nothing to write"),
    (("-o", "a.jpg"), ".exr or .png"),
    (("-o", "a.exr", "--size", "0"), "--size '0'"),
    (("-o", "a.exr", "--size", "4x0"), "--size '4x0'"),
    (("-o", "a.exr", "--size", "-4"), "--size '-4'"),
    (("-o", "a.exr", "--size", "65537"), "65536"),
    (("-o", "a.exr", "--size", "4x5x6"), "--size"),
    (("-o", "a.exr", "--size", "1x4000"), "1000 times"),
    (("-o", "a.exr", "--pits", "-1"), "--pits '-1'"),
    (("-o", "a.exr", "--pits", "1e3"), "--pits '1e3'"),
    (("-o", "a.exr", "--pits", "99999999999999999999"), "--pits"),
    (("-o", "a.exr", "--radius", "-1"), "--radius '-1'"),
    (("-o", "a.exr", "--radius", "0"), "--radius '0'"),
    (("-o", "a.exr", "--radius", ".2,.1"), "A <= B"),
    (("-o", "a.exr", "--radius", "nan"), "--radius"),
    (("-o", "a.exr", "--stretch", "0.5"), "--stretch"),
    (("-o", "a.exr", "--stretch", "2,"), "--stretch"),
    (("-o", "a.exr", "--depth", "1"), "0.99"),
    (("-o", "a.exr", "--spread", "91"), "--spread"),
    (("-o", "a.exr", "--direction", "inf"), "--direction"),
    (("-o", "a.exr", "--seed", "-1"), "--seed"),
    (("-o", "a.exr", "--samples", "0"), "--samples"),
    (("-o", "a.exr", "--threads", "0"), "--threads"),
    (("-o", "a.exr", "--bits", "8"), "--bits is for PNG"),
    (("-o", "a.png", "--bits", "12"), "8 or 16"),
    (("-o", "a.png", "--half"), "--half"),
    (("-o", "a.exr", "--half", "--float"), "together"),
    (("-o", "a.exr", "--height", "a.exr"), "same file"),
    (("-o", "a.exr", "--height", "a.png"), ".exr"),
    (("-o", "a.exr", "--eval"), "--eval"),
    (("-o", "a.exr", *("--layer",) * 8), "8 layers"),
    (("-o", "a.exr", *("--pits", "4000000", "--layer") * 2), "4000000"),
    (("-o",), "lacks its value"),
    (("-o", "a.exr", "--sead", "1"), "unknown option '--sead'"),
    (("-o", "a.exr", "b.exr"), "unexpected argument 'b.exr'"),
]


@pytest.mark.parametrize("options, expected", BAD)
def test_bad_usage(tmp_path, options, expected):
    result = run(*options, cwd=tmp_path)
    assert result.returncode == 2, result.stderr
    assert expected in result.stderr and result.stderr.startswith("shade scratch: ")
    assert result.stdout == "" and not any(tmp_path.iterdir())


# Options, values that they take, and values just beyond; a person's, by the help
ENDS = [
    ("--size", ("1000x1", "1x1000", "16384"), ("1001x1", "1x1001", "0x1")), ("--pits", ("0", "1"), ("4000001",)), ("--radius", ("1e-6", ".5", ".1,.5"), ("9e-7", ".51", ".1,.2,.3")),
    ("--stretch", ("1", "1e5"), (".99", "1.1e5")), ("--depth", ("0", ".99", "0,.99"), ("-.01", ".991")), ("--direction", ("-360", "360"), ("-361", "361")),
    ("--spread", ("0", "90"), ("-1", "90.1")), ("--seed", ("0", "18446744073709551615"), ("18446744073709551616", "1.5")), ("--samples", ("1", "64"), ("65",)),
    ("--threads", ("1", "256"), ("257",)), ("--bits", ("8", "16"), ("9", "168"))]


@pytest.mark.parametrize("option, taken, beyond", ENDS)
def test_ends_of_ranges(tmp_path, option, taken, beyond):
    few = ("--size", "8", "--pits", "3")
    for value in taken:
        file = ("-o", tmp_path / "a.png") if option in ("--bits", "--threads", "--samples") else ("--eval",)
        assert run(*file, *few, option, value, text=".5 .5\n").returncode == 0, value
    for value in beyond:
        result = run("--eval", *few, option, value, text=".5 .5\n")
        assert result.returncode == 2 and f"{option} '{value}': expected " in result.stderr, value


@pytest.mark.parametrize("options, expected", [
    (("-o", "a.png", "--float"), "--half and --float are for EXR; a PNG has --bits"), (("--height", "h.exr", "--bits", "8"), "--bits is for PNG"),
    (("-o", "a.exr", "--pits", "4000000", "--layer", "--pits", "1"), "more than 4000000 pits"), (("--eval", "--height", "h.exr"), "--eval and files do not go together")])
def test_what_does_not_go_together(tmp_path, options, expected):
    result = run(*options, cwd=tmp_path)
    assert result.returncode == 2 and expected in result.stderr and not any(tmp_path.iterdir())


def test_what_cannot_be_written(tmp_path):
    for name in ("none/a.exr", "none/a.png"):
        result = run("-o", tmp_path / name, "--size", 8)
        assert result.returncode == 1
        assert f"{tmp_path / name}: cannot write: No such file or directory" in result.stderr
    (tmp_path / "folder.exr").mkdir()
    result = run("-o", tmp_path / "folder.exr", "--size", 8)
    assert result.returncode == 1 and "is a folder" in result.stderr
    os.mkfifo(tmp_path / "pipe.png")
    result = run("-o", tmp_path / "pipe.png", "--size", 8)
    assert result.returncode == 1 and "device or pipe" in result.stderr
    assert (tmp_path / "pipe.png").is_fifo()
    (tmp_path / "pipe.png").unlink()
    # the second file fails: the first is not left behind
    result = run("-o", tmp_path / "a.exr", "--height", tmp_path / "none/h.exr", "--size", 8)
    assert result.returncode == 1
    assert [p.name for p in tmp_path.iterdir()] == ["folder.exr"]


@pytest.mark.skipif(not pathlib.Path("/dev/full").is_char_device(), reason="needs /dev/full")
def test_a_full_disk_is_told(tmp_path):
    with open("/dev/full", "w") as full:
        result = subprocess.run([SHADE, "scratch", "--eval"], input=b"0 0\n", stdout=full,
                                stderr=subprocess.PIPE, timeout=60)
    assert result.returncode == 1 and b"No space left" in result.stderr


@pytest.mark.parametrize("text, line", [
    ("0 0\n1\n", 2), ("0 0 0 0\n", 1), ("x y\n", 1), ("0 0\n\n0 nan\n", 3), ("0 0 0 0 0 0 0\n", 1),
    ("0 " + " " * 2000 + "x\n", 1), ("# two\n0 0 1\n", 2)])
def test_bad_points_name_their_line(text, line):
    result = run("--eval", "--pits", 10, text=text)
    assert result.returncode == 1
    assert re.search(rf"line {line}: .*; expected u v or u v du1", result.stderr)
    assert not re.search("nan|inf", result.stdout)


@pytest.mark.parametrize("name", ["a.exr", "a.png"])
def test_ctrl_c_leaves_the_old_file(tmp_path, name):
    path = tmp_path / name
    path.write_text("old")
    process = subprocess.Popen([SHADE, "scratch", "-o", path, "--size", "16384", "--samples", "8"],
                               stderr=subprocess.PIPE, text=True)
    for _ in range(500):
        if len(list(tmp_path.iterdir())) == 2:
            break
        time.sleep(0.01)
    assert len(list(tmp_path.iterdir())) == 2, "no temporary file was seen"
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted" in message
    assert path.read_text() == "old" and len(list(tmp_path.iterdir())) == 1
