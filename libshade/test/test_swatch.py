# SPDX-License-Identifier: Apache-2.0
"""`shade presets`, `shade fabric`, `shade swatch`: names, numbers, pictures and bad requests."""
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import time

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))
CLOTHS = ("silk_charmeuse silk_shantung denim gabardine linen wool_flannel polyester_lining "
          "shot_taffeta herringbone_tweed").split()
METALS = [f"{finish}_{metal}" for metal in "steel aluminium brass copper gold titanium".split()
          for finish in "brushed turned scratched".split()]


def shade(*words, text=""):
    return subprocess.run([SHADE, *map(str, words)], input=text, capture_output=True, text=True,
                          timeout=300)


def good(*words, text=""):
    result = shade(*words, text=text)
    assert result.returncode == 0 and result.stderr == "", result.stderr
    return result.stdout


def pixels(path):
    image = oiio.ImageInput.open(str(path))
    assert image, oiio.geterror()
    values = image.read_image("float")
    spec = image.spec()
    image.close()
    return values, spec


def direction(theta, phi):
    theta, phi = math.radians(theta), math.radians(phi)
    return [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)]


def reflected(cloth, queries, *options):
    text = "".join(" ".join(repr(float(x)) for x in query) + "\n" for query in queries)
    answers = np.array(good("fabric", cloth, *options, text=text).split(), float)
    return answers.reshape(len(queries), 3)


# ---- names and numbers ---------------------------------------------------------------------------


def test_all_presets_are_there():
    lines = good("presets").splitlines()
    assert [line.split()[0] for line in lines] == CLOTHS + METALS
    table = json.loads(good("presets", "--json"))
    assert [p["name"] for p in table] == CLOTHS + METALS
    bibliography = (ROOT / "REFERENCES.bib").read_text()
    for p in table:
        keys = re.findall(r"\[(\w+)\]", p["source"] + p["color_source"])
        assert keys, p["name"]
        assert all(f"{{{key}," in bibliography for key in keys), p
        if p["kind"] == "fabric":
            assert p["weft"]["diffuse"] == "fibre" and 0 < p["warp"]["width"] <= 1
        else:
            assert p["material"]["fresnel"] == "conductor" and p["scratches"][0]["pits"] > 0


@pytest.mark.parametrize("name", CLOTHS + METALS)
def test_one_preset(name):
    one = json.loads(good("presets", "--json", name.upper().replace("_", "-")))
    assert one["name"] == name
    text = good("presets", name)
    assert text.startswith(f"{name}: ") and "sources: " in text and "nan" not in text


def test_metals_have_their_colours():
    """Normal reflectance of the conductors, by hand; gold is yellow, copper red, steel grey."""
    for name in METALS:
        m = json.loads(good("presets", "--json", name))["material"]
        f0 = [((n - 1) ** 2 + k * k) / ((n + 1) ** 2 + k * k) for n, k in zip(m["eta"], m["k"])]
        assert m["f0"] == pytest.approx(f0, abs=1e-12)
        r, g, b = f0
        if name.endswith(("gold", "brass", "copper")):
            assert r > g > b and r > 1.5 * b
        else:
            assert max(f0) < 1.25 * min(f0)


def test_denim_is_a_twill_of_indigo_over_white():
    p = json.loads(good("presets", "--json", "denim"))
    assert p["weave"] == "twill_3_1"
    assert p["warp"]["kd"][2] > 3 * p["warp"]["kd"][0] and min(p["weft"]["kd"]) > 0.4


# ---- what they reflect ---------------------------------------------------------------------------


def test_taffeta_turns_from_one_colour_to_the_other():
    """Shot: light that falls along the crimson weft finds the green warp, and the other way."""
    eye = direction(0, 0)
    along_weft, along_warp = (
        reflected("shot_taffeta", [[0, 0, 1000, *direction(50, phi), *eye]], "--tier", "far")[0]
        for phi in (0, 90))
    ratio = (along_warp[0] / along_warp[1]) / (along_weft[0] / along_weft[1])
    assert ratio > 1.4, ratio


def test_charmeuse_shines_across_its_floats():
    """The highlight is long across the warp, which runs along v, and short along it."""
    def brightness(phi):
        return reflected("silk_charmeuse", [[0, 0, 1000, *direction(40, phi), *direction(5, phi)]],
                         "--tier", "far", "--no-diffuse")[0].sum()
    assert brightness(0) > 2 * brightness(90)


def test_mean_of_near_is_far():
    generator = np.random.default_rng(5)
    points = generator.random((20000, 2)) * 400
    light, eye = direction(35, 50), direction(20, 250)
    near = reflected("gabardine", [[u, v, 0, *light, *eye] for u, v in points])
    far = reflected("gabardine", [[0, 0, 1e5, *light, *eye]])[0]
    error = near.std(0) / math.sqrt(len(near)) / near.mean(0)
    assert error.max() < 0.01
    assert np.abs(far / near.mean(0) - 1).max() < 0.03 + 3 * error.max()


def test_float_and_double():
    generator = np.random.default_rng(6)
    queries = [[*np.float32(generator.random(2) * 50), np.float32(generator.random() * 4),
                *np.float32(direction(generator.random() * 70, generator.random() * 360)),
                *np.float32(direction(generator.random() * 70, generator.random() * 360))]
               for _ in range(500)]
    one, two = (reflected("denim", queries, "--precision", p) for p in ("double", "float"))
    assert np.abs(one - two).max() <= 2e-4 * one.max()


def test_info():
    text = good("fabric", "linen", "--info")
    shares = [float(x) for x in re.findall(r"(?:warp|weft) (0\.\d+)", text)]
    assert len(shares) == 2 and shares[0] == pytest.approx(shares[1], rel=0.1) and sum(shares) < 1


@pytest.mark.parametrize("words, text, code, message", [
    (["fabric"], "", 2, "usage"),
    (["fabric", "cheesecloth"], "", 2, "no cloth 'cheesecloth'"),
    (["fabric", "brushed_steel"], "", 2, "no cloth"),
    (["fabric", "denim", "linen"], "", 2, "one preset"),
    (["fabric", "denim", "--tier", "middle"], "", 2, "auto, near, far or single"),
    (["fabric", "denim", "--wrong"], "", 2, "--wrong"),
    (["fabric", "denim"], "# a remark\n\n0 0 0 0 0 1 0 0\n", 1, "line 3: too few"),
    (["fabric", "denim"], "0 0 0 0 0 1 0 0 1 1\n", 1, "line 1: too many"),
    (["fabric", "denim"], "0 0 -1 0 0 1 0 0 1\n", 1, "footprint"),
    (["fabric", "denim"], "0 0 nan 0 0 1 0 0 1\n", 1, "not finite"),
    (["presets", "mithril"], "", 2, "no preset 'mithril'"),
    (["presets", "--yaml"], "", 2, "--yaml"),
    (["swatch"], "", 2, "expected a preset"),
    (["swatch", "denim"], "", 2, "-o FILE"),
    (["swatch", "denim", "--all", "-o", "x.png"], "", 2, "expected a preset, or --all"),
    (["swatch", "mithril", "-o", "x.png"], "", 2, "no preset 'mithril'"),
    (["swatch", "denim", "-o"], "", 2, "missing"),
    (["swatch", "denim", "-o", "x.png", "--size", "0"], "", 2, "16 to 2048"),
    (["swatch", "denim", "-o", "x.png", "--size", "1e3"], "", 2, "16 to 2048"),
    (["swatch", "denim", "-o", "x.png", "--size"], "", 2, "16 to 2048"),
    (["swatch", "denim", "-o", "no/such/folder/x.png"], "", 1, "no/such/folder"),
    (["swatch", "denim", "-o", "x.gif"], "", 2, "x.gif"),
])
def test_refusals(words, text, code, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = shade(*words, text=text)
    assert result.returncode == code and message in result.stderr, result.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["presets", "fabric", "swatch"])
def test_help(command):
    assert f"usage: shade {command}" in good(command, "--help")


# ---- pictures ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["denim", "turned_brass"])
def test_sheet(name, tmp_path):
    good("swatch", name, "-o", tmp_path / "a.exr", "--size", 24, "--threads", 1)
    good("swatch", name, "-o", tmp_path / "b.exr", "--size", 24, "--threads", 5)
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    values, spec = pixels(tmp_path / "a.exr")
    assert (spec.width, spec.height, spec.nchannels) == (136, 136, 3)
    assert np.isfinite(values).all() and values.min() >= 0
    good("swatch", name, "-o", tmp_path / "a.png", "--size", 24)
    coded, spec = pixels(tmp_path / "a.png")
    linear = np.clip(values, 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    assert np.abs(coded - srgb).max() < 0.006


def test_far_and_near_tiles_have_one_colour(tmp_path):
    """The same light, cloth and angles: only the distance differs."""
    good("swatch", "linen", "-o", tmp_path / "a.exr", "--size", 48)
    values, _ = pixels(tmp_path / "a.exr")
    for column in range(4):
        left = 8 + 56 * column
        near, far = (values[top + 10:top + 38, left + 10:left + 38].mean((0, 1)) for top in (8, 64))
        assert np.abs(near / far - 1).max() < 0.08, (column, near, far)


def test_contact_sheet(tmp_path):
    good("swatch", "--all", "-o", tmp_path / "all.png", "--size", 16, "--across", 9)
    values, spec = pixels(tmp_path / "all.png")
    assert (spec.width, spec.height) == (18 * 24 + 8, 3 * 35 + 8)
    for row in range(3):
        for column in range(18):
            tile = values[8 + 35 * row:24 + 35 * row, 8 + 24 * column:24 + 24 * column]
            assert tile.max() > 0.15, (row, column)
            label = values[28 + 35 * row:35 + 35 * row, 8 + 24 * column:24 + 24 * column]
            assert label.max() > 0.5, (row, column)  # no name is shorter than a tile of 16


def test_interrupt_leaves_nothing(tmp_path):
    process = subprocess.Popen([SHADE, "swatch", "--all", "-o", str(tmp_path / "all.png"),
                                "--size", "512"], stderr=subprocess.PIPE)
    while not list(tmp_path.iterdir()):
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 130
    assert "interrupted" in process.stderr.read().decode()
    assert not list(tmp_path.iterdir())
