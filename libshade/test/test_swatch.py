# SPDX-License-Identifier: Apache-2.0
"""`shade presets`, `shade fabric`, `shade swatch`: names, numbers, pictures and bad requests."""
import functools
import json
import math
import os
import pathlib
import re
import subprocess

import numpy as np
import OpenImageIO as oiio
import pytest

COST = 4.6

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
    assert [line.split(maxsplit=1)[1] for line in lines] == [f"{p['label']}: {p['help']}" for p in table]
    bibliography = (ROOT / "REFERENCES.bib").read_text()
    for p in table:
        keys = re.findall(r"\[(\w+)\]", p["source"] + p["color_source"])
        assert keys, p["name"]
        assert all(f"{{{key}," in bibliography for key in keys), p
        if p["kind"] == "fabric":
            assert p["weft"]["diffuse"] == "fibre" and 0 < p["warp"]["width"] <= 1
            assert [p[word] for word in ("occlusion", "mdf", "brdf", "detail")] == ["tilt", "ashikhmin_shirley", "auto", "rotate"]
        else:
            assert p["material"]["fresnel"] == "conductor" and p["scratches"][0]["pits"] > 0


def rounded(x):
    """As %g prints it."""
    return pytest.approx(x, rel=5e-6, abs=0)


@functools.cache
def words_of_yarns():
    return good("weave", "--help")


@pytest.mark.parametrize("name", CLOTHS + METALS)
def test_one_preset(name):
    """The text form has the numbers of the other, which are finite throughout."""
    p = json.loads(good("presets", "--json", name.upper().replace("_", "-")))
    text = good("presets", name)
    head, sources, *rest = text.splitlines()
    assert p["name"] == name and head == f"{name}: {p['label']}, {p['help']}"
    assert sources == f"  sources: {p['source']}; colour: {p['color_source']}"

    def numbers(line):
        return [float(x) for x in re.findall(r"(?<![\w.])-?\d[\d.e+-]*", line)]

    def finite(x):
        if isinstance(x, dict):
            return all(finite(v) for v in x.values())
        if isinstance(x, list):
            return all(finite(v) for v in x)
        return not isinstance(x, float) or math.isfinite(x)

    assert finite(p)
    if p["kind"] == "metal":
        m, (s,) = p["material"], p["scratches"]
        assert numbers(rest[0])[:2] == [rounded(m["ex"]), rounded(m["ey"])]
        assert numbers(rest[0])[2:] == pytest.approx([m["ax"], m["ay"]], abs=5e-4)
        assert rest[0].endswith("in circles" if p["turned"] else "straight")
        assert numbers(rest[1]) == [rounded(x) for x in m["eta"] + m["k"]]
        assert numbers(rest[2]) == [rounded(x) for x in [
            s["pits"], p["scratch_cm"], *s["radius"], *s["stretch"], *s["depth"]]] + [
                pytest.approx(math.degrees(s[word]), rel=5e-3) for word in ("direction", "spread")]
        assert rest[2].endswith(" degrees")
        return
    weave = re.fullmatch(r"  weave (\w+), (\S+) ends and (\S+) picks per cm", rest[0])
    assert weave[1] == p["weave"]
    assert [float(weave[2]), float(weave[3])] == [p["ends_per_cm"], p["picks_per_cm"]]
    lines = (len(rest) - 2) // 2
    for k, yarn in enumerate(("warp", "weft")):
        heading, *rows = rest[1 + k * lines:1 + (k + 1) * lines]
        assert heading.strip() == yarn and rows[2].endswith(f" ({p[yarn]['diffuse']})")
        assert all(f" {row.split(maxsplit=2)[2]} (" in words_of_yarns() for row in rows[3:])
        found = {row.split()[0]: numbers(row.split(maxsplit=1)[1]) for row in rows}
        assert found.pop("exponents") == [p[yarn]["along"], p[yarn]["across"]]
        for color in ("f0", "kd"):
            assert found.pop(color) == [rounded(x) for x in p[yarn][color]]
        shape = {word: value for word, value in p[yarn].items()
                 if word not in ("along", "across", "f0", "kd", "diffuse")}
        assert {word: value[0] for word, value in found.items()} == {
            word: rounded(value) for word, value in shape.items()}
    assert numbers(rest[-1]) == [rounded(x) for x in p["backing"] + [p["nap"]]]


# Widths of the highlights of threads, degrees, as [SadeghiJensen2013 Table II] measured them: linen,
# silk crepe, shot silk, polyester satin, twisted silk. An exponent is 1/width^2.
@pytest.mark.parametrize("cloth, yarn, width", [
    ("denim", "warp", 12), ("denim", "weft", 12), ("linen", "warp", 12), ("linen", "weft", 12),
    ("silk_charmeuse", "warp", 5), ("silk_shantung", "warp", 5), ("shot_taffeta", "weft", 5),
    ("shot_taffeta", "warp", 4), ("polyester_lining", "warp", 2.5), ("silk_charmeuse", "weft", 18)])
def test_exponents_along_the_fibres_are_those_measured(cloth, yarn, width):
    p = json.loads(good("presets", "--json", cloth))
    assert p[yarn]["along"] == round(1 / math.radians(width) ** 2)


# Alphas of rolled brass and rolled aluminium [Ward1992]; exponents are 2/alpha^2 - 2. Along the
# strokes the lobe is the narrower one.
@pytest.mark.parametrize("finish, along, across", [("brushed", .05, .16), ("turned", .04, .09)])
def test_exponents_of_metals_are_those_measured(finish, along, across):
    for name in METALS:
        if name.startswith(finish):
            m = json.loads(good("presets", "--json", name))["material"]
            assert m["ex"] == round(2 / along ** 2 - 2) and m["ey"] == round(2 / across ** 2 - 2)
            assert m["ax"] == pytest.approx(along, rel=2e-3)
            assert m["ay"] == pytest.approx(across, rel=2e-3)


# What is by eye, and what scenes that name a preset therefore hold: changing one changes pictures.
# Weave, ends and picks per cm; of warp and weft: exponents, crimp, width and gap, fuzz; nap.
CLOTH_NUMBERS = {
    "silk_charmeuse": ("satin_8", 120, 45, (131, 6, .53, .97, .03, 0), (10, 6, .3, .9, .1, 0), 0),
    "silk_shantung": ("plain", 50, 24, (131, 5, .5, .8, .2, 0), (60, 4, .25, .9, .1, 0), 0),
    "denim": ("twill_3_1", 26, 17, (23, 4, .42, .94, .06, .3), (23, 4, .42, .54, .46, .3), .03),
    "gabardine": ("twill_3_1", 44, 22, (40, 5, .4, .97, .03, 0), (40, 5, .3, .95, .05, 0), .02),
    "linen": ("plain", 15, 15, (23, 4, .42, .82, .18, .1), (23, 4, .42, .82, .18, .1), .01),
    "wool_flannel": ("twill_2_2", 20, 18, (10, 3, .3, .96, .04, .9), (10, 3, .3, .96, .04, .9), .35),
    "polyester_lining": ("satin_5", 60, 34, (525, 8, .5, .97, .03, 0), (200, 8, .3, .95, .05, 0), 0),
    "shot_taffeta": ("plain", 46, 34, (205, 5, .42, .95, .05, 0), (131, 5, .42, .95, .05, 0), 0),
    "herringbone_tweed": ("herringbone", 9, 8.5, (10, 3, .4, .95, .05, .6), (10, 3, .4, .95, .05, .6),
                          .08),
}
FINISH_NUMBERS = {  # pits, their radius and stretch, depth, spread, cm, circles
    "brushed": (24000, [.0003, .0014], [60, 400], [.03, .16], .03, 5, False),
    "turned": (9000, [.0012, .0022], [150, 400], [.06, .14], .002, 4, True),
    "scratched": (2600, [.0003, .0016], [20, 300], [.1, .5], math.pi / 2, 5, False),
}


@pytest.mark.parametrize("name", CLOTHS)
def test_numbers_of_cloths(name):
    p = json.loads(good("presets", "--json", name))
    weave, ends, picks, warp, weft, nap = CLOTH_NUMBERS[name]
    assert (p["weave"], p["ends_per_cm"], p["picks_per_cm"], p["nap"]) == (weave, ends, picks, nap)
    for yarn, want in (("warp", warp), ("weft", weft)):
        words = ("along", "across", "crimp", "width", "gap", "fuzz")
        assert tuple(p[yarn][word] for word in words) == want, yarn


@pytest.mark.parametrize("finish", FINISH_NUMBERS)
def test_numbers_of_finishes(finish):
    pits, radius, stretch, depth, spread, cm, turned = FINISH_NUMBERS[finish]
    for name in METALS:
        if name.startswith(finish):
            p = json.loads(good("presets", "--json", name))
            assert p["scratches"] == [{"pits": pits, "radius": radius, "stretch": stretch,
                                       "depth": depth, "direction": 0,
                                       "spread": pytest.approx(spread, abs=1e-9)}], name
            assert (p["scratch_cm"], p["turned"]) == (cm, turned)
            if finish == "scratched":
                assert p["material"]["ex"] == p["material"]["ey"] == 1600


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
    seen, mixture, single = text.splitlines()
    assert seen.startswith("linen: seen and not occluded: warp 0.")
    assert all(int(count) > 1 for count in re.fullmatch(r"mixture: (\d+) lobes of warp, (\d+) of weft", mixture).groups())
    one, other = re.fullmatch(r"single lobe, exponents along and across: warp (\S+) \S+, weft (\S+) \S+", single).groups()
    assert float(one) > 1 and float(other) == pytest.approx(float(one), rel=0.3)
    for satin in "silk_charmeuse", "polyester_lining":  # all but warp, of the longer fibres
        numbers = [float(x) for x in re.findall(r"(?<![\w.])[\d.]+", good("fabric", satin, "--info"))]
        warp, weft, lobes, of_weft, along, across, weft_along, weft_across = numbers
        assert warp > 3 * weft and lobes > of_weft and along > weft_along > weft_across and along > across
        assert len(set(numbers)) == 8


@pytest.mark.parametrize("words, text, code, message", [
    (["fabric"], "", 2, "usage"),
    (["fabric", "cheesecloth"], "", 2, "no cloth 'cheesecloth'"),
    (["fabric", "brushed_steel"], "", 2, "'brushed_steel' is a metal, no cloth"),
    (["fabric", "denim", "linen"], "", 2, "one preset"),
    (["fabric", "denim", "--tier", "middle"], "", 2, "auto, near, far or single"),
    (["fabric", "denim", "--wrong"], "", 2, "--wrong"),
    (["fabric", "denim"], "# a remark\n\n0 0 0 0 0 1 0 0\n", 1, "line 3: too few"),
    (["fabric", "denim"], "0 0 0 0 0 1 0 0 1 1\n", 1, "line 1: too many"),
    (["fabric", "denim"], "0 0 -1 0 0 1 0 0 1\n", 1, "footprint"),
    (["fabric", "denim"], "0 0 nan 0 0 1 0 0 1\n", 1, "not finite"),
    (["presets", "mithril"], "", 2, "no preset 'mithril'"),
    (["presets", "--yaml"], "", 2, "--yaml"),
    (["presets", "denim", "linen"], "", 2, "unexpected 'linen'"),
    (["swatch"], "", 2, "expected a preset"),
    (["swatch", "denim"], "", 2, "-o FILE"),
    (["swatch", "denim", "--all", "-o", "x.png"], "", 2, "expected a preset, or --all"),
    (["swatch", "mithril", "-o", "x.png"], "", 2, "no preset 'mithril'"),
    (["swatch", "denim", "-o"], "", 2, "missing"),
    (["swatch", "denim", "-o", "x.png", "--size", "0"], "", 2, "16 to 2048"),
    (["swatch", "denim", "-o", "x.png", "--size", "1e3"], "", 2, "16 to 2048"),
    (["swatch", "denim", "-o", "x.png", "--size"], "", 2, "16 to 2048"),
    (["swatch", "denim", "-o", "x.png", "--size", "15"], "", 2, "--size: expected a whole number from 16 to 2048"),
    (["swatch", "denim", "-o", "x.png", "--size", "2049"], "", 2, "16 to 2048"),
    (["swatch", "--all", "-o", "x.png", "--across", "17"], "", 2, "--across: expected a whole number from 1 to 16"),
    (["swatch", "denim", "-o", "x.png", "--threads", "257"], "", 2, "--threads: expected a whole number from 1 to 256"),
    (["swatch", "denim", "linen", "-o", "x.png"], "", 2, "one preset at a time, not also 'linen'"),
    (["swatch", "denim", "-o", "x.png", "--alll"], "", 2, "unknown option '--alll'"),
    (["fabric", "denim", "--precision", "single"], "", 2, "expected double or float, not 'single'"),
    (["swatch", "denim", "-o", "no/such/folder/x.png"], "", 1, "no/such/folder"),
    (["swatch", "denim", "-o", "x.gif"], "", 2, "x.gif"),
])
def test_refusals(words, text, code, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = shade(*words, text=text)
    assert result.returncode == code and message in result.stderr, result.stderr
    assert not list(tmp_path.iterdir())


# ---- pictures ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["denim", "turned_brass"])
def test_sheet(name, tmp_path):
    good("swatch", name, "-o", tmp_path / "a.exr", "--size", 24, "--threads", 1)
    good("swatch", name, "-o", tmp_path / "b.exr", "--size", 24, "--threads", 5)
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    values, spec = pixels(tmp_path / "a.exr")
    assert (spec.width, spec.height, spec.nchannels) == (136, 136, 3)
    assert np.isfinite(values).all() and values.min() >= 0
    assert np.abs(values[[0, 50], [0, 3]] - 0.02).max() < 1e-4  # beside the tiles
    assert spec.get_string_attribute("ImageDescription") == {"denim": "Cotton denim", "turned_brass": "Turned brass"}[name]
    good("swatch", name, "-o", tmp_path / "a.png", "--size", 24)
    coded, spec = pixels(tmp_path / "a.png")
    linear = np.clip(values, 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    assert np.abs(coded - srgb).max() < 0.006


def test_the_light_goes_from_left_to_right(tmp_path):
    """Across what hangs in folds: the side that the light is on is the brighter one."""
    good("swatch", "linen", "-o", tmp_path / "a.exr", "--size", 32, "--threads", 256)
    values, _ = pixels(tmp_path / "a.exr")
    sides = []
    for column in range(4):
        tile = values[8 + 3 * 40 + 8:8 + 3 * 40 + 24, 8 + 40 * column:40 + 40 * column].mean((0, 2))  # the last row: far
        sides.append(tile[4:16].sum() / tile[16:28].sum())
    assert sides[0] > sides[1] > sides[2] > sides[3] and sides[0] > 1.2 and sides[3] < 0.9, sides
    # a cylinder of 0.88 of half a tile: beside it there is ground
    tile = values[8 + 3 * 40 + 16, 8:40, 0]
    assert 27 <= (tile > 0.021).sum() <= 29


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
    assert b"shade swatch --all" in (tmp_path / "all.png").read_bytes()
    for row in range(3):
        for column in range(18):
            tile = values[8 + 35 * row:24 + 35 * row, 8 + 24 * column:24 + 24 * column]
            assert tile.max() > 0.15, (row, column)
            label = values[28 + 35 * row:35 + 35 * row, 8 + 24 * column:24 + 24 * column]
            assert label.max() > 0.5, (row, column)  # no name is shorter than a tile of 16
    ink = values[28:35, 200:230, 0] > 0.5  # below the fifth pair
    assert ["".join(".X"[int(x)] for x in line) for line in ink] == [
        "X......XXX..X...X.XXXXX.X...X.",
        "X.......X...XX..X.X.....XX..X.",
        "X.......X...XX..X.X.....XX..X.",
        "X.......X...X.X.X.XXXX..X.X.X.",
        "X.......X...X..XX.X.....X..XX.",
        "X.......X...X..XX.X.....X..XX.",
        "XXXXX..XXX..X...X.XXXXX.X...X."]
    ground = values[:8].reshape(-1, 3)
    assert len(np.unique(ground, axis=0)) == 1 and 0.1 < ground.max() < 0.2
    # each in its place: what a person calls it
    hues = {"gold": "rgb", "copper": "rgb", "brass": "rgb", "denim": "bgr", "shantung": "bgr", "lining": "rbg"}
    for k, name in enumerate(CLOTHS + METALS):
        top, left = 8 + 35 * (k // 9), 8 + 48 * (k % 9)
        for tile in values[top:top + 16, left:left + 16], values[top + 2:top + 14, left + 26:left + 38]:
            mean = dict(zip("rgb", tile.mean((0, 1))))
            hue = hues.get(name.split("_")[-1])
            if hue:
                assert mean[hue[0]] > mean[hue[1]] > mean[hue[2]], (name, mean)
            elif name.endswith(("steel", "aluminium", "flannel")):
                assert max(mean.values()) < 1.06 * min(mean.values()), (name, mean)
