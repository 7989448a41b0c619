# SPDX-License-Identifier: Apache-2.0
"""What a person sees of `shade`: defaults, help, what each option changes, progress, files and how it ends."""
import contextlib
import functools
import json
import os
import pathlib
import pty
import re
import signal
import stat
import struct
import subprocess
import time

import OpenImageIO as oiio
import pytest

COST = 6.6

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))


def shade(*words, text=""):
    return subprocess.run([SHADE, *map(str, words)], input=text, capture_output=True, text=True, timeout=60)


@functools.cache  # each answer once
def answer_of(*words, text):
    return good(*words, text=text)


def good(*words, text=""):
    result = shade(*words, text=text)
    assert result.returncode == 0 and result.stderr == "", result.stderr
    return result.stdout


# ---- defaults, and that each option changes something ----------------------------------------------

HIT = ".28 0 .96  .6 0 .8  0 .28 .96\n"
POINTS = "".join(f"{.137 * k % 1:.4f} {.291 * k % 1:.4f}\n" for k in range(60))
PIXELS = "".join(f"{.137 * k % 1:.4f} {.291 * k % 1:.4f} .02 0 0 .03\n" for k in range(60))
CROSSINGS = "".join(f"{1.37 * k % 23:.4f} {2.91 * k % 23:.4f}\n" for k in range(60))
CLOTH = "".join(f"{1.3 * k:.4f} {.7 * k:.4f} {k % 4} .6 0 .8 0 .28 .96\n" for k in range(8))
F = ("eval", "--what", "f")
FACES_BACK = "-.28 0 .96  .6 0 .8  -.96 0 .28\n"
TILTED = ".6 0 .8  .6 0 .8  -.8 0 .6\n"
EX = ("--ex", 20, "--ey", 3)
TWILL = ("weave", "--pattern", "2,2,1")
# command, what it reads, option, its default, other values; a person's, beside --help
OPTIONS = [
    (("eval",), ".28 0 .96  .6 0 .8\n", "--what", "D", []),
    (("eval",), ".28 0 .96  .6 0 .8\n", "--precision", "double", ["float", "reference"]),
    (("eval",), ".28 0 .96  .6 0 .8\n", "--mdf", "ashikhmin_shirley", []),
    (("eval",), ".28 0 .96  .6 0 .8\n", "--detail", "rotate", ["none"]),
    (("eval",), ".28 0 .96  .6 0 .8\n", "--groove", "auto", []),
    (F, HIT, "--horizon", "hard", []),
    (("eval", "--what", "diffuse"), ".36 .48 .8\n.8 0 .6\n", "--diffuse", "lambert", ["max_normal", "fibre"]),
    (F, HIT, "--brdf", None, ["ward_1992", "ward_dur", "ward_bounded"]),
    (("eval",), ".28 0 .96  .6 0 .8\n", ("--ex", "--ey"), (200, 10), [(201, 10), (200, 11)]),
    ((*F, "--f0", .5), HIT, "--f82", None, [.3]),
    ((*F, "--eta", 1.5, "--k", 3), HIT, "--kd", 0, [.5]),
    (("fabric", "denim"), CLOTH, "--tier", "auto", ["near", "far", "single"]),
    (("fabric", "denim"), CLOTH, "--precision", "double", ["float"]),
    (("weave", "--pattern", "2,2,1"), CROSSINGS, "--precision", "double", ["float"]),
    ((*TWILL, "--vary-tilt", .3), CROSSINGS, "--seed", 0, [1]),
    *(((*TWILL, *more), CROSSINGS, f"--{name}", default, [other]) for name, default, other, more in [
        ("width", 1, 2, ("--gap", .5)), ("gap", 0, .5, ()), ("curve", .5, .4, ()), ("ridge", .2, .1, ()),
        ("slant", .25, .5, ()), ("segments", 1, 2, ()), ("crimp", 0, .3, ()),
        ("crimp_length", .5, .9, ("--crimp", .3)), ("vary_tilt", 0, .2, ()), ("along_tilt", 0, .2, ()),
        ("slub", 0, .5, ("--gap", .5)), ("along_length", 4, 3, ("--along-tilt", .2)),
        ("weft-curve", .5, .4, ()), ("warp-curve", .5, .4, ())]),
    (("scratch", "--eval"), POINTS, "--pits", 5000, [2500]),
    (("scratch", "--eval"), POINTS, "--radius", "0.0005,0.002", ["0.0005,0.003", ".001,.002"]),
    (("scratch", "--eval"), POINTS, "--stretch", "20,60", ["20,61", "19,60"]),
    (("scratch", "--eval"), POINTS, "--depth", "0.05,0.25", ["0.05,0.26", ".06,.25"]),
    (("scratch", "--eval"), POINTS, "--direction", 0, [10]),
    (("scratch", "--eval"), POINTS, "--spread", 10, [9]),
    (("scratch", "--eval"), POINTS, "--seed", 1, [0, 2]),
    (("slopes", "MAP"), PIXELS, "--normals", "colour", ["signed", "slope"]),
    (("slopes", "MAP"), "1.3 -.2\n1.02 .5\n.99 .999\n", "--wrap", "repeat", ["clamp", "mirror"]),
    (("slopes", "MAP"), PIXELS, "--strength", 1, [100]),
    (("slopes", "MAP", *EX), PIXELS, "--mdf", "ashikhmin_shirley", ["ward", "ggx"]),
    (("slopes", "MAP", *EX), PIXELS, "--lobes", None, [1, 8]),
]


@pytest.fixture(scope="module")
def map_of_normals(tmp_path_factory):
    path = tmp_path_factory.mktemp("seen") / "n.png"
    good("scratch", "-o", path, "--size", 32, "--pits", 60, "--radius", ".02,.1", "--stretch", "1,3")
    return path


@pytest.mark.parametrize("command, text, option, default, others", OPTIONS,
                         ids=[f"{o[0][0]}{o[2]}{k}" for k, o in enumerate(OPTIONS)])
def test_defaults_and_that_options_change_something(map_of_normals, command, text, option, default, others):
    command = [map_of_normals if word == "MAP" else word for word in command]

    def answer(value):
        pairs = zip(option, value) if isinstance(option, tuple) else [(option, value)]
        return answer_of(*command, *(word for pair in pairs for word in pair), text=text)
    plain = answer_of(*command, text=text)
    assert "nan" not in plain
    if default is not None:
        assert answer(default) == plain
    different = [answer(other) for other in others]
    assert len({plain, *different}) == 1 + len(different), "an option that changes nothing"
    for other in different if option == "--precision" else []:  # the same words, the same numbers to as many digits
        for one, two in zip(plain.split(), other.split(), strict=True):
            assert one == two or float(one) == pytest.approx(float(two), rel=3e-4, abs=1e-5), (one, two)


HELP = {  # a person's: what is said of an option in --help, with its default
    "check": {"--tolerance": "(default 1e-4)", "--mean-tolerance": "(default 1e-5)", "--threads": "(default: one a CPU)"},
    "eval": {"--what": "(default D)", "--mdf": "(default ashikhmin_shirley)", "--detail": "(default rotate)",
             "--groove": "(default auto)", "--diffuse": "(default lambert)", "--horizon": "(default hard)",
             "--precision": "(default double;", "--defaults": "0 to 1, the version of the defaults (default 1); to 0: brdf ashikhmin_shirley"},
    "fabric": {"--precision": "(default double)", "--tier": "auto: by footprint"},
    "scratch": {"--size": "(default 1024)", "--pits": "(default 5000)", "--radius": "(default 0.0005,0.002)",
                "--stretch": "(default 20,60)", "--depth": "0 to 0.99 (default 0.05,0.25)", "--direction": "(default 0)",
                "--spread": "(default 10)", "--layer": "(8 at most)", "--seed": "(default 1)",
                "--samples": "1 to 64 (default 1, its centre)", "--bits": "8|16 of a PNG (default 16)",
                "--threads": "(default: all CPUs)"},
    "slopes": {"--normals": "colour (0 to 1 for -1 to 1, default)", "--wrap": "repeat (default)",
               "--strength": "0 to 100 (default 1)", "--mdf": "(default ashikhmin_shirley)", "--lobes": "1 to 8"},
    "swatch": {"--size": "16 to 2048 (default 256; --all 192)", "--across": "1 to 16 (default 5)",
               "--threads": "1 to 256 (default: as many as there are processors)"},
    "weave": {"--size": "(the longer side 512 by default)", "--cells": "(default: one repeat)", "--bits": "8|16 of a PNG (8)",
              "--threads": "(default: one a CPU)", "--twist": "its strands to its axis (30), how many lie along a crossing (1)",
              "--occlusion": "(default tilt)", "--seed": "of all variation (0)", "--width": "(1e-06 to 1e+06, default 1)",
              "--gap": "(0 to 1e+06, default 0)", "--curve": "(0 to 0.98, default 0.5)", "--ridge": "(0 to 0.98, default 0.2)",
              "--slant": "(-100 to 100, default 0.25)", "--segments": "(0 to 1000, default 1)",
              "--fibre": "(-1.5708 to 1.5708, default 0)", "--crimp": "(0 to 0.98, default 0)",
              "--crimp_length": "(0.01 to 16, default 0.5)", "--vary_brightness": "(0 to 1, default 0)",
              "--vary_tilt": "(0 to 1, default 0)", "--along_brightness": "(0 to 1, default 0)",
              "--along_tilt": "(0 to 1, default 0)", "--slub": "(0 to 1, default 0)",
              "--along_length": "(0.01 to 1e+06, default 4)", "--fuzz": "(0 to 1, default 0)"},
}


@pytest.mark.parametrize("command", HELP)
def test_help_says_the_defaults(command):
    text = good(command, "--help")
    for option, words in HELP[command].items():
        said = re.search(rf"^  (-\S+ \S+ +)?{option}\s.*(\n {{12,}}.*)*", text, re.M)
        assert said and words in re.sub(r"\s+", " ", said[0]), option
    assert good(command, "-h") == text and text.startswith(f"usage: shade {command} ")


def test_what_shade_says_of_itself():
    """Each command and what it does, to whom asks; to who errs too, and to another stream."""
    text = good("--help")
    assert text == good("-h") == good("help")
    listed = re.findall(r"^  (\w+) +(\S.*)$", text, re.M)
    assert [name for name, _ in listed if name != "shade"] == "eval bench scratch presets fabric swatch slopes check weave".split()
    for name, does in listed:
        first = {"eval": "evaluate", "bench": "time", "scratch": "make a map of scratches", "presets": "cloths and metals", "fabric": "what a cloth reflects",
                 "swatch": "pictures", "slopes": "look a normal map up", "check": "recompute a renderer's dump", "weave": "which yarn", "shade": ""}
        assert does.startswith(first[name]), name
    for name in "presets", "bench":  # the others: above
        assert good(name, "-h") == good(name, "--help") and good(name, "-h").startswith(f"usage: shade {name} ")
    alone, unknown = shade(), shade("sheen")
    assert (alone.returncode, alone.stdout, alone.stderr) == (2, "", text)
    by = {isa: subprocess.run([SHADE, "--version"], env=os.environ | {"LIBSHADE_ISA": isa}, capture_output=True, text=True, timeout=60, check=True)
          for isa in ("mmx", "")}
    told = by["mmx"]
    assert told.stderr.startswith("shade: warning: ") and "mmx" in told.stderr and told.stderr.count("\n") == 1
    assert told.stdout == by[""].stdout and re.fullmatch(r"shade \d+\.\d+\.\d+ \((avx512|avx2|sse2|neon|scalar)\)\n", told.stdout)
    assert (unknown.returncode, unknown.stdout, unknown.stderr) == (2, "", f"shade: unknown command 'sheen'\n\n{text}")


RANGES = [  # what is just refused, and what is just taken; a person's
    (("scratch", "--eval"), "--depth", [-.01, 1], [0, .99]), (("scratch", "--eval"), "--stretch", [.99, "1e5,1.1e5"], [1]),
    (("scratch", "--eval"), "--radius", [.51, "0"], [.5]), (("scratch", "--eval"), "--direction", [-361, 361], [-360, 360]),
    (("scratch", "--eval"), "--spread", [-1, 91], [0, 90]), (("scratch", "--eval"), "--samples", [0, 65], [1, 64]),
    (("scratch", "--eval"), "--threads", [0, 257], [1, 256]), (("scratch", "--eval"), "--pits", [-1, 4000001], [0]),
    (("scratch", "--eval"), "--seed", [-1, 2**64], [0, 2**64 - 1]), (("scratch", "--eval"), "--bits", [7, 9, 17, 32], []),
    (("slopes", "MAP"), "--strength", [-.1, 100.1], []), (("slopes", "MAP"), "--lobes", [0, 9], []),
    (("slopes", "MAP", "--ey", 5), "--ex", [-1, 1.1e6], []), (("slopes", "MAP", "--ay", 1), "--ax", [.00009, 10.1], []),
    (("weave", "--name", "plain"), "--curve", [-.01, .981], [0, .98]), (("weave", "--name", "plain"), "--slant", [-101, 101], [-100, 100]),
    (("weave", "--name", "plain"), "--seed", [-1, 2**32], [0, 2**32 - 1]),
    (("weave", "--name", "plain"), "--threads", [0, 257], [1, 256]), (("weave", "--name", "plain"), "--bits", [7, 12, 32], []),
    (("weave", "--name", "plain"), "--cells", [0, 1000001], [1, 1000000]), (("weave", "--name", "plain"), "--size", [0, 65537], [1, 65536]),
    (("weave", "--name", "plain"), "--twist", ["S,.59", "S,91", "Z,30,1001", "Q", "S,30,2,single"], ["S,.6", "Z,90", "none", "Z,30,1000,plied"]),
    (("weave",), "--pattern", ["0,1,1", "1,-1,1", "1,4096,0"], ["1,0,0", "inf,1,1"]),
    (("eval", "--ay", 1), "--ax", [.00009, 10.1], [.0001, 10]), (("eval", "--ey", 1), "--ex", [-1, 1.1e6], [0, 1e6]),
    (("eval",), "--f0", [-.1, 1.1], [0, 1]), (("eval", "--k", 1), "--eta", [.0009, 101], [.001, 100]),
    (("eval", "--eta", 1), "--k", [-1, 101], [0, 100]), (("eval",), "--kd", [-.1, 1.1], [0, 1]),
    (("swatch", "denim", "-o", "/no/such/x.png"), "--size", [15, 2049], []),
    (("swatch", "denim", "-o", "/no/such/x.png"), "--across", [0, 17], []),
    (("swatch", "denim", "-o", "/no/such/x.png"), "--threads", [0, 257], []),
    (("check", "/no/such.exr"), "--tolerance", [-1, "nan", "x"], []), (("check", "/no/such.exr"), "--mean-tolerance", [-1, "inf"], []),
    (("check", "/no/such.exr"), "--threads", [0, -1, "1.5"], []),
]


@pytest.mark.parametrize("command, option, refused, taken", RANGES, ids=[f"{r[0][0]}{r[1]}" for r in RANGES])
def test_ranges(map_of_normals, command, option, refused, taken):
    command = [map_of_normals if word == "MAP" else word for word in command]
    for value in [*refused, "", "1x"]:
        result = shade(*command, option, value)
        assert result.returncode == 2 and option in result.stderr and not result.stdout, value
    for value in taken:
        assert shade(*command, option, value).returncode == 0, value
    result = shade(*command, option)
    assert result.returncode == 2 and option in result.stderr


# ---- what is read ----------------------------------------------------------------------------------


@pytest.mark.parametrize("first", ["0 0 1 .28 0 .96\n", "0 0 1 .6 0 .8  \n", "0 0 1 0 0 1"])
def test_mark_at_the_beginning(first):
    rest = "# remark\n\n0 0 1 .6 0 .8\n"
    text = first + (rest if first.endswith("\n") else "")
    plain = good("eval", text=text)
    assert good("eval", text="\ufeff" + text) == good("eval", text=" \t# said first\n" + text.replace("\n", "\r\n")) == plain != ""
    assert shade("eval", text=text.replace("0 0 1", "0 0 1\ufeff", 1)).returncode == 1


@pytest.mark.parametrize("line, said", [
    (".28 0 .96  .6 0 .8  0 .28 .96", None), ("0 0 1  .6 0 -.8  0 .28 .96", None), ("0 0 1  .6 0 .8  0 .28 -.96", None),
    (".6 0 -.8  .6 0 .8  0 .28 .96", "lifted"), ("1 0 0  .6 0 .8  0 .28 .96", "lifted"),
    ("0 0 0  .6 0 .8  0 .28 .96", "no such direction"), ("0 0 1  0 0 0  0 .28 .96", "no such direction")])
@pytest.mark.parametrize("precision", ["float", "double"])
def test_what_is_said_of_directions(line, said, precision):
    for what in "f", "pdf":
        message = shade("eval", "--what", what, "--precision", precision, text=line + "\n").stderr
        assert (said or "") in message and bool(message) == bool(said) and message.count("\n") == bool(said)


def test_what_is_said_of_cloth():
    result = shade("fabric", "denim", text="0 0 0 0 0 1 0 0 1\n# no eye\n0 0 0 0 0 1 0 0 0\n0 0 0 0 0 1 .6 0 .8\n")
    assert result.stderr == "shade fabric: standard input, line 3: warning: no such direction: 0\n" and result.returncode == 0
    first, none, last = (line.split() for line in result.stdout.splitlines())
    assert none == ["0", "0", "0"] and all(float(x) > 0 for x in first + last)


def test_highlights_alone():
    """No fibre's end shines where the colours are black: what is left has the colour of f0, grey for these."""
    for cloth in "wool_flannel", "denim", "gabardine":
        for line in good("fabric", cloth, "--no-diffuse", text="0 0 0 -.8 0 .6 .96 0 .28\n.5 .5 9 -.96 0 .28 .96 0 .28\n.3 0 0 0 .6 .8 0 -.96 .28\n").splitlines():
            r, g, b = map(float, line.split())
            assert b <= g * 1.0001 and g <= r * 1.0001 and r <= 1.3 * b + 1e-12, (cloth, line)
    at_rims = "0 0 100 .98 .199 0.0001 -.98 -.199 .0001\n.5 .5 0 .96 0 .28 .96 0 .28\n"
    for line in good("fabric", "wool_flannel", "--no-diffuse", text=at_rims.splitlines()[1] + "\n").splitlines():
        assert max(map(float, line.split())) < 1e-6, "back to the light, far off the highlight"


def test_a_distribution_alone_is_a_lobe(map_of_normals):
    for words in ("--mdf", "ggx"), ("--lobes", 1):
        assert len(good("slopes", map_of_normals, *words, text="0 0\n").split()) == (9 if words[0] == "--mdf" else 13)


# ---- presets: what colour they have ----------------------------------------------------------------

COLOURS = {  # sRGB of the diffuse colours, warp and weft, of the backing and the nap; as seen in the sheet of swatches
    "silk_charmeuse": "ad8e6c aa8969 503f30 bcbcbc", "silk_shantung": "3f8186 458e93 193f3f bcbcbc",
    "denim": "1d325d c8c4b8 273045 818eaa", "gabardine": "9e8665 957e5f 453827 b3a690",
    "linen": "cbbda4 cec0a6 595045 dad3c4", "wool_flannel": "696a6f 6c6e73 45454b a2a4aa",
    "polyester_lining": "551d27 591f29 301016 bcbcbc", "shot_taffeta": "165d3a 7c1027 271919 bcbcbc",
    "herringbone_tweed": "4d3f33 b8aa93 3f3830 bcad9b"}
METALS = {  # reflectance at normal incidence, in percent: handbooks' colours of metals
    "steel": (63, 61, 58), "aluminium": (91, 92, 92), "brass": (91, 78, 42), "copper": (93, 62, 52), "gold": (100, 74, 35),
    "titanium": (62, 58, 56)}


def test_colours_of_presets():
    def srgb(c):
        return [255 * (12.92 * x if x <= .0031308 else 1.055 * x**(1 / 2.4) - .055) for x in c]
    seen = set()
    for preset in json.loads(good("presets", "--json")):
        if preset["kind"] == "fabric":
            seen.add(preset["name"])
            colours = preset["warp"]["kd"], preset["weft"]["kd"], preset["backing"], preset["nap_color"]
            for colour, word in zip(colours, COLOURS[preset["name"]].split(), strict=True):
                assert srgb(colour) == pytest.approx([int(word[k:k + 2], 16) for k in (0, 2, 4)], abs=1.5), preset["name"]
            dielectric = all(max(preset[yarn]["f0"]) <= .06 for yarn in ("warp", "weft"))
            assert dielectric == (preset["name"] in ("denim", "gabardine", "linen", "wool_flannel", "herringbone_tweed"))
            assert all(max(preset[yarn]["f0"]) <= .33 for yarn in ("warp", "weft"))
        else:
            material = preset["material"]
            f0 = [100 * ((n - 1)**2 + k * k) / ((n + 1)**2 + k * k) for n, k in zip(material["eta"], material["k"])]
            assert f0 == pytest.approx(METALS[preset["name"].split("_")[1]], abs=6), preset["name"]
            assert material["kd"] == [0, 0, 0]
    assert seen == set(COLOURS)


# ---- files -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("mask", [0o022, 0o002, 0o077])
def test_who_may_read_what_was_written(tmp_path, mask):
    before = os.umask(mask)
    try:
        good("weave", "--name", "plain", "--wif", tmp_path / "a.wif")
        for name in "A.EXR", "b.exr", "C.PNG", "d.Png":
            good("weave", "--name", "plain", "-o", tmp_path / name, "--size", 8)
    finally:
        os.umask(before)
    for path in tmp_path.iterdir():
        assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask, path
    for name, kind in ("A.EXR", b"\x76\x2f\x31\x01"), ("C.PNG", b"\x89PNG"), ("d.Png", b"\x89PNG"):
        assert (tmp_path / name).read_bytes().startswith(kind)


@pytest.mark.parametrize("words, kind", [
    (("weave", "--name", "plain", "-o", "a.exr"), "float"), (("weave", "--name", "plain", "-o", "a.exr", "--half"), "half"),
    (("weave", "--name", "plain", "-o", "a.png"), "uint8"), (("weave", "--name", "plain", "-o", "a.png", "--bits", 16), "uint16"),
    (("scratch", "--pits", 9, "-o", "a.exr"), "float"), (("scratch", "--pits", 9, "-o", "a.exr", "--half"), "half"),
    (("scratch", "--pits", 9, "-o", "a.png"), "uint16"), (("scratch", "--pits", 9, "-o", "a.png", "--bits", 8), "uint8")])
def test_kinds_of_pictures(tmp_path, monkeypatch, words, kind):
    monkeypatch.chdir(tmp_path)
    for size, shape in ((), None), (("--size", "24x16"), (24, 16)):
        if shape is None and words[0] == "scratch" and kind != "uint8":
            continue  # the largest default, once
        good(*words, *size)
        image = oiio.ImageInput.open(next(word for word in words if str(word).startswith("a.")))
        spec = image.spec()
        image.close()
        assert str(spec.format) == kind
        assert (spec.width, spec.height) == (shape or ((1024, 1024) if words[0] == "scratch" else (512, 512)))


def test_all_of_a_draft_at_once(tmp_path):
    """As text, as a file and as a map, and nothing is asked for."""
    text = good("weave", "--pattern", "2,1,1", "--print", "--wif", tmp_path / "a.wif", "-o", tmp_path / "a.exr", "--size", 8, text="0 0\n")
    assert text == "X..\n.X.\n..X\n" and b"[WIF]" in (tmp_path / "a.wif").read_bytes()
    image = oiio.ImageInput.open(str(tmp_path / "a.exr"))
    assert "top.ID 0 weft, 1 warp, 2 gap; yarn.ID pick or end from 0; color linear RGB" in image.spec().get_string_attribute("ImageDescription")
    image.close()


def test_no_map_of_a_draft_that_failed(tmp_path):
    result = shade("weave", "--name", "plain", "--wif", tmp_path / "none" / "a.wif", "-o", tmp_path / "a.exr", "--size", 8)
    assert result.returncode == 1 and "a.wif" in result.stderr and not list(tmp_path.iterdir())
    full = shade("weave", "--name", "plain", "--wif", "/dev/full")
    assert full.returncode == 1 and full.stderr == "shade weave: /dev/full: cannot write: No space left on device\n"


# ---- progress, and how it ends ---------------------------------------------------------------------


def until(what, seconds=30):
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "nothing came"
        time.sleep(.01)


@pytest.mark.parametrize("words, side, how", [
    (("--all",), (10 * 200 + 8, 6 * 211 + 8), signal.SIGINT), (("turned_brass",), (4 * 264 + 8, 4 * 264 + 8), signal.SIGTERM)])
def test_progress_and_its_end(tmp_path, words, side, how):
    """The size that is not given; the share done grows, the time left fits it; no signal leaves half a file."""
    terminal, inner = pty.openpty()
    begun = time.monotonic()
    process = subprocess.Popen([SHADE, "swatch", *words, "-o", tmp_path / "a.exr", "--threads", "1"], stderr=inner)
    os.close(inner)
    until(lambda: any(path.stat().st_size > 400 for path in tmp_path.iterdir()))
    header = next(tmp_path.iterdir()).read_bytes()[:2000]
    window = header.index(b"dataWindow\0box2i\0") + 21
    left, top, right, bottom = struct.unpack("<4i", header[window:window + 16])
    assert (right - left + 1, bottom - top + 1) == side
    told = b""
    notes = []
    while how == signal.SIGTERM and sum(n[3] is not None for n in notes) < 2:
        told += os.read(terminal, 4096)
        now = time.monotonic() - begun
        new = re.findall(rb"\rshade swatch \[([#.]+)\] +(\d+) %(?: +(\d+) s left)?", told)
        notes += [(len(bar), bar.count(b"#"), int(part), int(left) if left else None, now) for bar, part, left in new[len(notes):]]
    process.send_signal(how)
    assert process.wait(60) == 130 and not list(tmp_path.iterdir())
    if how != signal.SIGTERM:
        os.close(terminal)
        return
    told += os.read(terminal, 4096)
    os.close(terminal)
    assert b"\r\033[K" in told and b"interrupted, nothing written" in told
    assert [n[2] for n in notes] == sorted(n[2] for n in notes) and 0 < notes[0][2] < notes[-1][2] < 60
    for width, filled, part, left, now in notes:
        assert abs(filled / width - part / 100) < .05
        if left is not None:
            assert left == pytest.approx(now * (100 - part) / part, rel=.5, abs=1.5)


def test_the_time_left_falls(tmp_path):
    terminal, inner = pty.openpty()
    begun = time.monotonic()
    process = subprocess.Popen([SHADE, "swatch", "turned_brass", "-o", tmp_path / "a.png", "--threads", "1", "--size", "75"], stderr=inner)
    os.close(inner)
    told = b""
    with contextlib.suppress(OSError):  # Linux says so at its end
        while new := os.read(terminal, 4096):
            told += new
    took = time.monotonic() - begun
    os.close(terminal)
    process.wait(60)
    notes = [(int(part) / 100, int(left)) for part, left in re.findall(rb"(\d+) % +(\d+) s left", told)]
    assert (notes or took < 1) and all(left <= (1.5 - part) * took + 0.5 for part, left in notes if part > 0.5), (took, notes)
