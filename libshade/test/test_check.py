# SPDX-License-Identifier: Apache-2.0
"""`shade check`: right dumps pass, wrong ones fail, and bad files are refused."""
import contextlib
import json
import os
import pty
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

COST = 46.5

ROOT = Path(__file__).resolve().parents[2]
SHADE = Path(os.environ.get("SHADE", ROOT / "build/shade"))
CC = os.environ.get("CC", "cc")
WIDTH, HEIGHT, MATERIALS, LIGHTS = 60, 65, 14, 2


def check(dump, *options, shade=SHADE):
    return subprocess.run([shade, "check", dump, *options], capture_output=True, text=True,
                          timeout=300)


def check_json(dump, *options):
    result = check(dump, "--json", *options)
    report = json.loads(result.stdout)
    assert report["pass"] == (result.returncode == 0)
    return report


def make(build, root=ROOT, cflags="", names=("libshade.a", "libshade_dump.a", "shade"), more=()):
    """Targets of libshade.mk into a folder of their own."""
    rules = f"B := {build}\ninclude libshade/libshade.mk\n"
    targets = [f"{build}/{name}" for name in names]
    subprocess.run(["make", "-s", "-f", "-", f"CC={CC}", f"CFLAGS={cflags}", *more, *targets],
                   input=rules, text=True, cwd=root, check=True, stdout=subprocess.DEVNULL)


def exr_flags():
    return subprocess.run(["pkg-config", "--cflags", "OpenEXR"], capture_output=True, text=True,
                          check=True).stdout.split()


def build_makedump(libraries, output, root=ROOT):
    source = root / "libshade"
    subprocess.run([CC, "-std=c11", "-O1", f"-I{source}/include", f"-I{source}", *exr_flags(),
                    source / "test/makedump.c", libraries / "libshade_dump.a",
                    libraries / "libshade.a", "-lOpenEXRCore-3_1", "-lm", "-o", output],
                   check=True)
    return output


def run_makedump(program, dump, *options, seed=1):
    subprocess.run([program, dump, str(WIDTH), str(HEIGHT), str(seed), *options], check=True)
    return dump


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("check")


@pytest.fixture(scope="module")
def makedump(folder):
    return build_makedump(SHADE.parent, folder / "makedump")


@pytest.fixture(scope="module")
def good(folder, makedump):
    return run_makedump(makedump, folder / "good.exr")


class Dump:
    """A dump taken apart by another reader of OpenEXR."""

    def __init__(self, path):
        image = oiio.ImageInput.open(str(path))
        assert image, oiio.geterror()
        self.spec = image.spec()
        self.names = list(self.spec.channelnames)
        self.pixels = image.read_image(oiio.FLOAT).copy()
        self.header = json.loads(self.spec.getattribute("libshade"))
        image.close()

    def __getitem__(self, name):
        return self.pixels[:, :, self.names.index(name)]

    def planes(self, group):
        """View-like access to several channels: group[0], group[1], … as arrays to write to."""
        return [self[name] for name in self.names if name.startswith(group + ".")]

    def write(self, path, names=None, text=None, type=oiio.FLOAT, **settings):
        names = names or self.names
        spec = oiio.ImageSpec(self.spec.width, self.spec.height, len(names), type)
        spec.channelnames = names
        spec.attribute("libshade", json.dumps(self.header) if text is None else text)
        spec.attribute("compression", settings.get("compression", "zip"))
        spec.x, spec.y = settings.get("corner", (0, 0))
        if settings.get("tile"):
            spec.tile_width = spec.tile_height = settings["tile"]
        pixels = np.stack([self[name] for name in names], axis=2)
        output = oiio.ImageOutput.create(str(path))
        assert output.open(str(path), spec), output.geterror()
        assert output.write_image(pixels), output.geterror()
        output.close()
        return path


@pytest.fixture
def dump(good):
    return Dump(good)


# ---- the library is right -----------------------------------------------------------


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_library_passes(makedump, tmp_path, seed):
    report = check_json(run_makedump(makedump, tmp_path / "x.exr", seed=seed), "--all")
    assert report["pass"] and report["excused"] == 0
    assert len(report["cells"]) == MATERIALS * LIGHTS
    assert {cell["detail"] for cell in report["cells"]} == {
        "none", "perturb", "gram_schmidt", "rotate"}
    for cell in report["cells"]:
        assert cell["values"] > 100 and 0 < cell["mean"] <= cell["largest"] < 5e-5
        assert 50 < cell["tilt"] <= 60.001


def test_material_color_is_used_without_channels(makedump, tmp_path):
    path = run_makedump(makedump, tmp_path / "plain.exr", "plain")
    taken_apart = Dump(path)
    assert not taken_apart.planes("Color")
    assert check(path).returncode == 0
    taken_apart.header["materials"][3]["f0"] = [0.9, 0.31, 0.5]
    assert_only_material_fails(taken_apart.write(tmp_path / "wrong.exr"), 3)


# ---- what varies from hit to hit ---------------------------------------------------------

VARIED = ["alpha.X", "alpha.Y", "groove.A", *(f"{group}.{c}" for group in ("f82", "eta", "k", "kd")
                                              for c in "RGB"),
          *(f"lobe{k}.{c}" for k in (2, 3) for c in ("share", "alpha.X", "alpha.Y", "groove.A")),
         *(f"slopes.{c}" for c in ("X", "Y", "XX", "XY", "YY"))]


@pytest.fixture(scope="module")
def varied(folder, makedump):
    return run_makedump(makedump, folder / "varied.exr", "varied", seed=5)


@pytest.fixture(scope="module")
def few_varied(folder, makedump):
    """The check works longest on what is wrong."""
    subprocess.run([makedump, folder / "few.exr", "24", "26", "7", "varied"], check=True)
    return folder / "few.exr"


def test_varied_passes(varied):
    assert set(VARIED) <= set(Dump(varied).names)
    report = check_json(varied, "--all")
    assert report["pass"]
    for cell in report["cells"]:
        assert cell["values"] > 100 and 0 < cell["mean"] < 1e-5


@pytest.mark.parametrize("channel", VARIED)
def test_each_varied_channel_matters(few_varied, tmp_path, channel):
    """One channel that is another hit's; as it is, the dump is right."""
    if channel == VARIED[0]:
        assert check(few_varied).returncode == 0
    dump = Dump(few_varied)
    hit = dump["material.ID"] >= 0
    both = hit & np.roll(hit, 7, axis=0)
    plane = dump[channel]
    plane[:] = np.where(both, np.roll(plane, 7, axis=0), plane)
    assert_differs(dump.write(tmp_path / "x.exr"))


@pytest.mark.parametrize("channel", ["alpha.Y", "groove.A", "f82.R", "eta.G", "k.B", "kd.R", "lobe2.share", "lobe3.Ns.Z", "slopes.XY"])
def test_varied_channels_are_there_and_finite(few_varied, tmp_path, channel):
    dump = Dump(few_varied)
    group = channel.split(".")[0] + "."
    assert_differs(dump.write(tmp_path / "less.exr",
                              names=[n for n in dump.names if not n.startswith(group)]))
    y, x = first_hit(dump)
    dump[channel][y, x] = np.nan
    fault = assert_fault(dump.write(tmp_path / "x.exr"), "not finite")
    assert (fault["x"], fault["y"]) == (x, y)


@pytest.mark.parametrize("channel, value", [("share", -.1), ("share", 1.1), ("Ns.Y", 2)])
def test_lobes_are_unit_parts_of_a_hit(few_varied, tmp_path, channel, value):
    dump = Dump(few_varied)
    y, x = first_hit(dump)
    dump[f"lobe2.{channel}"][y, x] = value
    fault = assert_fault(dump.write(tmp_path / "x.exr"), "a lobe's Ns is not a unit vector, or shares are no parts of 1")
    assert (fault["x"], fault["y"]) == (x, y)


@pytest.mark.parametrize("lobe", [2, 3])
def test_each_lobes_normal_matters(few_varied, tmp_path, lobe):
    dump = Dump(few_varied)
    there = dump[f"lobe{lobe}.share"] > 0
    both = there & np.roll(there, 7, axis=0)
    for c in "XYZ":
        plane = dump[f"lobe{lobe}.Ns.{c}"]
        plane[:] = np.where(both, np.roll(plane, 7, axis=0), plane)
    assert_differs(dump.write(tmp_path / "x.exr"))


def test_half_a_channel_is_refused(few_varied, tmp_path):
    dump = Dump(few_varied)
    path = dump.write(tmp_path / "x.exr", names=[n for n in dump.names if n != "alpha.Y"])
    result = check(path)
    assert result.returncode == 1 and "alpha.Y is missing" in result.stderr


# ---- cloth ------------------------------------------------------------------------------

TIER_NAMES = {"near": 1, "far": 2, "single": 3}


@pytest.fixture(scope="module")
def cloth(folder, makedump):
    path = folder / "cloth.exr"
    subprocess.run([makedump, path, "16", "16", "6", "cloth"], check=True)
    return path


def less_cloth(cloth, path, *left_out):
    """The same without most hits of some tiers: for far ones the reference takes a mean each, for single
    ones much of the cloth once."""
    dump = Dump(cloth)
    longer = np.maximum(dump["foot.U"], dump["foot.V"])
    of_tier = {"far": (dump["tier"] == 2) | (dump["tier"] == 0) & (longer > 0.75), "single": dump["tier"] == 3}
    for tier in left_out:
        dump.pixels[of_tier[tier]] = 0
    of_tier["far"][::4] = False
    dump.pixels[of_tier["far"]] = 0
    dump["material.ID"][dump["N.X"]**2 + dump["N.Y"]**2 + dump["N.Z"]**2 == 0] = -1
    dump.write(path)
    assert check_json(path)["pass"]
    return path


@pytest.fixture(scope="module")
def near_cloth(cloth, folder):
    return less_cloth(cloth, folder / "near_cloth.exr", "far", "single")


@pytest.fixture(scope="module")
def single_cloth(cloth, folder):
    return less_cloth(cloth, folder / "single_cloth.exr", "far")


@pytest.fixture(scope="module")
def far_cloth(cloth, folder):
    return less_cloth(cloth, folder / "far_cloth.exr", "single")


def test_cloth_passes(cloth):
    report = check_json(cloth, "--all")
    assert report["pass"] and report["largest"] < 1e-5
    for cell in report["cells"]:
        assert cell["values"] > 20 and cell["mean"] < 1e-6
    for tier, limit in ("far", 0.15), ("single", 0.05):
        apart = [cell[tier] for cell in report["cells"] if tier in cell]
        assert apart and all(0 < part["values"] and part["limit"] == limit and part["over"] == 0
                             for part in apart)
    said = re.findall(r"^apart: material (\d+), light (\d+), cloth (\w+): (\d+) values, largest error (\S+) at \((\d+), (\d+)\), beyond doubt (\S+) \(limit (\S+)\), "
                      r"(\d+) over it, of their sum (\S+) \(limit (\S+)\)$", check(cloth).stdout, re.M)
    told = [(cell["material"], cell["light"], tier, cell[tier]) for cell in report["cells"] for tier in ("far", "single") if tier in cell]
    assert [(int(line[0]), int(line[1]), line[2], int(line[3])) for line in said] == [(*of, part["values"]) for *of, part in told]
    for line, (*_of, part) in zip(said, told):
        assert [float(line[k]) for k in (4, 7, 8, 10, 11)] == pytest.approx([part[word] for word in ("largest", "beyond_doubt", "limit", "sum", "sum_limit")], rel=1e-3)
        assert [int(line[k]) for k in (5, 6, 9)] == [part["x"], part["y"], part["over"]]


def lit_cloth(dump, tier):
    """A hit of that tier, and where its light is brightest."""
    auto = dump["tier"] == 0
    longer = np.maximum(dump["foot.U"], dump["foot.V"])
    of_tier = {"near": (dump["tier"] == 1) | auto & (longer == 0),
               "points": auto & (longer > 0) & (longer <= 0.75),
               "far": (dump["tier"] == 2) | auto & (longer > 2), "single": dump["tier"] == 3}[tier]
    s = np.where(of_tier & (dump["material.ID"] >= 0), dump["light0.S.G"], 0)
    y, x = np.unravel_index(s.argmax(), s.shape)
    assert s[y, x] > 0
    return y, x


@pytest.mark.parametrize("tier, channel, factor", [
    ("near", "light0.S.R", 1.001), ("points", "light0.S.G", 1.001), ("far", "light0.S.B", 1.5),
    ("single", "light0.S.G", 1.1), ("near", "light0.E.R", 1.01), ("points", "light0.E.B", 1.01),
    ("far", "light0.E.G", 1.5), ("single", "light0.E.R", 1.1), ("near", "light0.S.G", 0),
    ("far", "light0.S.R", 0), ("single", "light0.S.B", 0)])
def test_one_wrong_value_on_cloth(request, tmp_path, tier, channel, factor):
    dump = Dump(request.getfixturevalue(("near" if tier == "points" else tier) + "_cloth"))
    y, x = lit_cloth(dump, tier)
    dump[channel][y, x] *= factor
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert not report["pass"] and not report["faults"]
    if tier in ("far", "single"):
        assert report["largest"] < 1e-5
        (worst,) = [cell[tier] for cell in report["cells"] if tier in cell and cell[tier]["over"] > 0]
        assert worst["over"] == 1 and (worst["x"], worst["y"]) == (x, y) and worst["largest"] > worst["limit"]


@pytest.mark.parametrize("light", range(LIGHTS))
@pytest.mark.parametrize("filled", [0, 64, 191])
def test_cloth_from_afar_in_shadow(far_cloth, tmp_path, monkeypatch, light, filled):
    """There the reference has no mean, and no doubt of it: neither memory nor the light before lends one."""
    monkeypatch.setenv("MALLOC_PERTURB_", str(filled))  # 64: numbers below 0; 191: above
    dump = Dump(far_cloth)
    y, x = lit_cloth(dump, "far")
    for channel in "RGB":
        dump[f"light{light}.E.{channel}"][y, x] = dump[f"light{light}.S.{channel}"][y, x] = 0
    report = check_json(dump.write(tmp_path / "dark.exr"))
    assert report["pass"] and all(0 <= cell["far"]["beyond_doubt"] < 0.15 for cell in report["cells"] if "far" in cell)
    dump[f"light{light}.S.G"][y, x] = dump[f"light{light}.S.G"].max()
    report = check_json(dump.write(tmp_path / "shines.exr"))
    assert not report["pass"] and sum(cell["far"]["over"] for cell in report["cells"] if "far" in cell) == 1


def far_field(far_cloth, path, seed):
    """A large dump of hits of two cloths, seen from afar under one light: eight of the first at its highlight, 4,088 of the
    last, seven in eight of them in shadow, where there is no mean to take. Each is elsewhere on the cloth: a far value is
    the same, the points of its mean are not."""
    dump = Dump(far_cloth)
    hits = []
    for material in 0, 3:
        s = np.where((dump["tier"] == 2) & (dump["material.ID"] == material), dump["light0.S.G"], 0)
        hits.append(dump.pixels[np.unravel_index(s.argmax(), s.shape)].copy())
    dump.spec.width, dump.spec.height = 128, 32
    dump.pixels = np.repeat(hits, [8, 128 * 32 - 8], axis=0).reshape(32, 128, -1)
    random = np.random.default_rng(seed)
    for channel in "uv.U", "uv.V":
        dump[channel][:] = 50 * random.random((32, 128))
    for plane in dump.planes("light1"):
        plane[:] = 0
    for plane in dump.planes("light0.E") + dump.planes("light0.S"):
        plane[4:] = 0
    return dump.write(path), dump


@pytest.mark.parametrize("seed", [0, 1])
def test_sum_of_few_hits_from_afar(far_cloth, tmp_path, seed):
    """Means of as few points as a large dump can have are 5 % off, and so are sums of few hits: those are asked again."""
    path, dump = far_field(far_cloth, tmp_path / "field.exr", seed)
    terminal, inner = pty.openpty()
    begun = time.monotonic()
    process = subprocess.Popen([SHADE, "check", path, "--json", "--threads", "1"], stdout=subprocess.PIPE, stderr=inner, text=True)
    os.close(inner)
    for _ in range(4):  # how far it is shows of what takes a while, by the clock: stopped so often, it does
        time.sleep(0.15)
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.6)
        process.send_signal(signal.SIGCONT)
    text, _ = process.communicate(timeout=300)
    took, told = time.monotonic() - begun, b""
    with contextlib.suppress(OSError):  # Linux says so at its end
        while new := os.read(terminal, 65536):
            told += new
    os.close(terminal)
    told = told.decode()
    bars = [(len(bar), bar.count("#"), int(part)) for bar, part in re.findall(r"\rshade check \[([#.]+)\] +(\d+) %", told)]
    parts = [part for *_, part in bars]
    assert parts == sorted(parts) and (parts or took < 3.5) and (not parts or told.endswith("\r\033[K"))  # quicker, it may end before
    assert all(abs(filled / width - part / 100) < .05 for width, filled, part in bars)
    report = json.loads(text)
    far = {cell["material"]: cell["far"] for cell in report["cells"] if cell.get("far", {"values": 0})["values"]}
    assert report["pass"] and far[0]["values"] == 24 and far[0]["sum"] < 0.02
    for channel in "RGB":
        dump[f"light0.S.{channel}"][0, :8] *= 1.08
    assert not check_json(dump.write(tmp_path / "brighter.exr"))["pass"]


@pytest.mark.parametrize("channel, factor, change", [
    ("uv.U", 1, 0.3), ("uv.V", 1, 0.3), ("foot.U", 0.3, 0), ("foot.V", 0.3, 0), ("tier", 1, 2)])
def test_one_wrong_place_on_cloth(near_cloth, tmp_path, channel, factor, change):
    dump = Dump(near_cloth)
    tier = "points" if channel.startswith("foot") else "near"
    y, x = lit_cloth(dump, tier)
    dump[channel][y, x] = dump[channel][y, x] * factor + change
    assert not check_json(dump.write(tmp_path / "x.exr"))["pass"]


@pytest.mark.parametrize("channel, value, words", [
    ("tier", 4, "tier is none"), ("tier", 0.5, "tier is none"), ("foot.U", -1, "out of range"),
    ("foot.V", np.nan, "out of range"), ("coverage.A", 1.5, "coverage"),
    ("coverage.A", np.nan, "coverage"), ("coverage.A", 0.5, "coverage"),
    ("uv.U", 1e30, "out of range")])
def test_one_bad_value_on_cloth(near_cloth, tmp_path, channel, value, words):
    dump = Dump(near_cloth)
    y, x = lit_cloth(dump, "near")
    dump[channel][y, x] = value
    fault = assert_fault(dump.write(tmp_path / "x.exr"), words)
    assert (fault["x"], fault["y"]) == (x, y)


@pytest.mark.parametrize("path, value, message", [
    (["weave"], "no_such", "bad value of 'weave': expected a name"), (["yarns", "seed"], -1, "bad value of 'seed': expected a whole number"),
    (["yarns", "warp", "width"], 0, "bad value of 'width': expected a number from "),
    (["yarns", "occlusion"], "dusk", "bad value of 'occlusion': expected \"none\" or "),
    (["cloth", "nap"], "much", "bad value of 'nap'"), (["cloth", "mdf"], "x", "bad value of 'mdf': expected \""),
    (["cloth", "weft", "diffuse"], "x", "bad value of 'diffuse': expected \""),
    (["cloth", "warp", "kd"], [1, 2], "bad value of 'kd': expected [r, g, b]"),
    (["cloth", "horizon"], None, "lacks 'horizon'"), (["yarns", "weft"], None, "lacks 'weft'"),
    (["cloth", "sheen"], 1, "unknown or repeated key in 'cloth'")])
def test_header_of_cloth_is_read_strictly(near_cloth, tmp_path, path, value, message):
    dump = Dump(near_cloth)
    place = dump.header["materials"][0]["fabric"]
    for key in path[:-1]:
        place = place[key]
    if value is None:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    result = check(dump.write(tmp_path / "x.exr"))
    assert result.returncode == 1
    assert f"material number 0 of the header: fabric: {message}" in result.stderr


@pytest.mark.parametrize("material, path, value", [
    (0, ["yarns", "warp", "crimp"], 0.01), (1, ["yarns", "seed"], 77), (2, ["yarns", "weft", "curve"], 0),
    (3, ["cloth", "nap"], 0), (0, ["cloth", "weft", "along"], 5), (1, ["cloth", "warp", "kd"], [0, 0, 0]),
    (2, ["cloth", "horizon"], "hard"), (1, ["cloth", "draft_colors"], False), (0, ["cloth", "shadows"], False)])
def test_each_part_of_the_header_matters(near_cloth, tmp_path, material, path, value):
    dump = Dump(near_cloth)
    place = dump.header["materials"][material]["fabric"]
    for key in path[:-1]:
        place = place[key]
    assert place[path[-1]] != value
    place[path[-1]] = value
    assert_only_cloth_fails(dump.write(tmp_path / "x.exr"), material)


def test_cloth_of_a_dump_older_than_shadows_has_none(near_cloth, tmp_path):
    dump = Dump(near_cloth)
    del dump.header["materials"][0]["fabric"]["cloth"]["shadows"]
    assert_only_cloth_fails(dump.write(tmp_path / "x.exr"), 0)


def assert_only_cloth_fails(path, material):
    report = check_json(path)
    assert not report["pass"]
    assert {c["material"] for c in report["cells"] if c["largest"] > 1e-4} == {material}


def test_text_says_what_was_shaded(few_varied, tmp_path):
    """Of the worst value of each material under each light: S, then the reference, as JSON has them; the limits of --help."""
    dump = Dump(few_varied)
    y, x = first_hit(dump)
    dump["light0.S.G"][y, x] = 7 * dump["light0.S.G"].max()
    for faulty in np.argwhere(dump["material.ID"] >= 0)[50:52]:
        dump["uv.U"][tuple(faulty)] = np.nan
    dump["T.X"][tuple(np.argwhere(dump["material.ID"] >= 0)[60])] = 3
    path = dump.write(tmp_path / "x.exr")
    report, text = check_json(path), check(path).stdout
    told = re.findall(r"^fault: (.*): (\d+) times, first at \((\d+), (\d+)\)$", text, re.M)
    assert [(fault["what"], fault["count"], fault["x"], fault["y"]) for fault in report["faults"]] == [(what, *map(int, at)) for what, *at in told]
    assert [int(fault[1]) for fault in told] == [2, 1] and text.rstrip().endswith(", 3 faults")
    assert (f"left out: {report['horizon']} values on the horizon" in text) == (report["horizon"] > 0)
    rows = re.findall(r"^ +(\d+) .* (\d+) +(\d+) +(\S+) +(\S+)  \((\d+), (\d+)\) ([RGB]): (\S+), (\S+)$", text, re.M)
    cells = [cell for cell in report["cells"] if cell["values"]]
    assert len(rows) == len(cells) > 5
    for (material, light, values, largest, mean, at_x, at_y, channel, s, reference), cell in zip(rows, cells):
        worst = cell["worst"]
        assert (int(material), int(light), int(values)) == (cell["material"], cell["light"], cell["values"])
        assert (int(at_x), int(at_y), channel) == (worst["x"], worst["y"], worst["channel"])
        assert float(largest) == pytest.approx(cell["largest"], rel=1e-3) and float(mean) == pytest.approx(cell["mean"], rel=1e-3)
        assert float(s) == pytest.approx(float(dump[f"light{light}.S.{channel}"][int(at_y), int(at_x)]), rel=1e-6)
        assert float(reference) == pytest.approx(worst["reference"], rel=1e-7)
        assert abs(float(s) - float(reference)) / max(float(s), float(reference)) == pytest.approx(float(largest), rel=2e-2, abs=1e-6)
    assert report["tolerance"] == 1e-4 and report["mean_tolerance"] == 1e-5
    assert "(limit 0.0001)" in text and "(limit 1e-05)" in text and text.splitlines()[-1].startswith("FAIL: ")


def test_text_report(good):
    result = check(good)
    assert result.returncode == 0 and result.stderr == ""
    assert result.stdout.splitlines()[-1].startswith("PASS: ")
    assert f"{WIDTH} x {HEIGHT}" in result.stdout and "makedump" in result.stdout


@pytest.mark.parametrize("compression, corner", [("none", (0, 0)), ("zips", (-5, -40)), ("zip", (7, 3))])
def test_other_writer(dump, tmp_path, compression, corner):
    """Its channels in another order, packed in another way; a part that was cut out of a larger picture lies where it was."""
    path = dump.write(tmp_path / "x.exr", names=sorted(dump.names, reverse=True),
                      compression=compression, corner=corner)
    assert check(path).returncode == 0


# ---- the check is independent, and notices one wrong sign -------------------------------


def test_reference_shares_no_symbol_with_the_library():
    objects = SHADE.parent / "obj"

    def symbols(files, *options):
        files = sorted(objects.glob(files))
        assert files
        lines = subprocess.run(["nm", "-P", *options, *files], capture_output=True, text=True,
                               check=True).stdout.splitlines()
        names = {line.split()[0] for line in lines if len(line.split()) >= 2}
        return {name for name in names if not name.startswith(".")}  # the compiler's labels

    kernel = symbols("src/isa_*.o", "--defined-only")  # static functions too
    library = symbols("src/*.o", "--defined-only", "--extern-only")
    reference = symbols("reference/*.o", "--extern-only")  # what it has and what it wants
    assert any("density_about" in name for name in kernel)
    assert "shade_bsdf_eval" in library and "shade_ref_f" in reference
    assert not reference & (kernel | library)
    files = list((ROOT / "libshade/reference").glob("*.[ch]"))
    source = "".join(path.read_text() for path in files)
    assert set(re.findall(r'#include\s*[<"](.*?)[>"]', source)) <= {
        "shade/shade.h", "shade/weave.h", "shade/fabric.h", "math.h", "complex.h", "stdint.h",
        "string.h", "../data/albedo_fit.h", *(path.name for path in files if path.suffix == ".h")}


# header, what stands around the expression @, the expression, the wrong one
FLIPS = {
    "cross product, x": ("model/detail.h", "c.x = @;", "difference(ny, hz, nz, hy)",
                         "difference(ny, hz, -nz, hy)"),
    "cross product, y": ("model/detail.h", "c.y = @;", "difference(nz, hx, nx, hz)",
                         "difference(nz, hx, -nx, hz)"),
    "cross product, z": ("model/detail.h", "c.z = @;", "difference(nx, hy, ny, hx)",
                         "difference(nx, hy, -ny, hx)"),
    "rotate, sum of y'": ("model/detail.h", "real y = @;", "difference(nx, c.z, nz, c.x)",
                          "difference(nx, c.z, -nz, c.x)"),
    "exponent": ("model/mdf_ashikhmin_shirley.h", "@", "(x * p.xx + (y * p.yy + mean))",
                 "(x * p.xx - (y * p.yy + mean))"),
    "Schlick": ("model/fresnel.h", "real m = @;", "1 - c", "1 + c"),
    "cosine to the light": ("model/brdf.h", "real ci = dot(n.x, @, n.z, wi.x", "n.y", "-n.y"),
    "bent normal": ("model/horizon.h", ": @;", "s + a", "s - a"),
    "shadow of the slope": ("model/horizon.h", "@", "R(0.125)", "R(1.0)"),
    "cubic shadow": ("model/horizon.h", "return @;", "g + g * g * (1 - g)", "g"),
    "share of the mirror": ("model/horizon.h", "return @ /", "q", "p"),
    "textured Fresnel": ("model/fresnel.h", "return f0 + @ *", "(1 - f0)", "-(1 - f0)"),
}
# All are compiled together, since the scalar code takes seconds, and FLIPPED chooses one when a program starts
CHOICE = """char *getenv(const char *);
int atoi(const char *);
static int flipped = -1;
__attribute__((constructor)) static void choose_flip(void) {
  const char *word = getenv("FLIPPED");
  flipped = word ? atoi(word) : -1;
}
"""


# other instruction sets than the scalar one are the same text and take as long to compile
OTHER_SETS = [f"build/obj/{part}.o" for isa in ("sse2", "avx2", "avx512")
              for part in (f"src/isa_{isa}_float", f"src/isa_{isa}_double", f"tool/literal_{isa}")]
COPY_FLAGS = "-O0 -include choice.h"
AS_THEY_ARE = [word for path in OTHER_SETS for word in ("-o", path)]


@pytest.fixture(scope="module")
def copy(folder):
    """A copy of the library that can be spoilt; as it is, it passes."""
    root = folder / "copy"
    shutil.copytree(ROOT / "libshade", root / "libshade")
    for number, (name, around, right, wrong) in enumerate(FLIPS.values()):
        path = root / "libshade" / name
        text, there = path.read_text(), around.replace("@", right)
        assert text.count(there) == 1, f"{name} has changed: choose the flip anew"
        path.write_text(text.replace(there, around.replace("@", f"(flipped == {number} ? {wrong} : {right})")))
    (root / "choice.h").write_text(CHOICE)
    for path in OTHER_SETS:
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        if (SHADE.parents[1] / path).exists():
            shutil.copy(SHADE.parents[1] / path, root / path)
    make("build", root, COPY_FLAGS, more=AS_THEY_ARE)
    program = build_makedump(root / "build", root / "makedump", root)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LIBSHADE_ISA", "scalar")
        assert check(run_makedump(program, root / "x.exr")).returncode == 0
    return root


@pytest.mark.parametrize("flip", FLIPS)
def test_one_flipped_sign_is_noticed(copy, flip, monkeypatch):
    """In the scalar code."""
    monkeypatch.setenv("LIBSHADE_ISA", "scalar")
    monkeypatch.setenv("FLIPPED", str(list(FLIPS).index(flip)))
    run_makedump(copy / "makedump", copy / "x.exr")
    report = check_json(copy / "x.exr")
    assert not report["pass"]
    assert report["largest"] > 0.1
    # the copy's own tool has its own reference, which no flip reaches
    assert check(copy / "x.exr", shade=copy / "build/shade").returncode == 1


# ---- dumps that are wrong ------------------------------------------------------------


def assert_only_material_fails(path, material):
    report = check_json(path)
    assert not report["pass"] and not report["faults"]
    for cell in report["cells"]:
        assert (cell.get("largest", 0) > 1e-3) == (cell["material"] == material), cell


def assert_fault(path, *words):
    report = check_json(path)
    assert not report["pass"]
    (fault,) = report["faults"]
    for word in words:
        assert word in fault["what"]
    return fault


def test_zero_s(dump, tmp_path):
    hit = dump["material.ID"] == 4
    for plane in dump.planes("light0.S") + dump.planes("light1.S"):
        plane[hit] = 0
    path = dump.write(tmp_path / "x.exr")
    assert_only_material_fails(path, 4)
    assert check_json(path)["largest"] == 1


def test_zero_s_everywhere(dump, tmp_path):
    for plane in dump.planes("light0.S") + dump.planes("light1.S"):
        plane[:] = 0
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert not report["pass"] and report["values"] > 0 and report["largest"] == 1


TINY = float(np.finfo(np.float32).tiny)


def dim(dump, factor):
    """Every light as much weaker; what float32 has no full digits for is 0, as where it is flushed."""
    for light in range(LIGHTS):
        for plane in dump.planes(f"light{light}.S") + dump.planes(f"light{light}.E"):
            plane *= np.float32(factor)
            plane[np.abs(plane) < TINY] = 0


def test_what_float32_has_no_digits_for(dump, tmp_path):
    """Where a material's largest is 1e-36 or so, a part of its values is no float32: 0 is no error there."""
    whole = check_json(dump.write(tmp_path / "whole.exr"))
    dim(dump, 1e-36)
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert report["pass"] and not report["faults"]
    assert 0.1 * whole["values"] < report["values"] < whole["values"]


@pytest.mark.parametrize("low, high, wrong", [(1.5, 3, 0), (1.5, 3, 0.5), (0, 0.5, 2)])
def test_what_is_wrong_beside_it_is_seen(dump, tmp_path, low, high, wrong):
    """One value on the wrong side of float32's smallest: `wrong` of it, where between low and high belong."""
    right = dump["light0.S.R"].astype(float) * 1e-36 / TINY
    lit = dump["light0.E.R"] > 0.1
    dim(dump, 1e-36)
    y, x = np.argwhere((dump["material.ID"] == 4) & (right > low) & (right < high) & lit)[0]
    dump["light0.S.R"][y, x] = wrong * TINY
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert not report["pass"] and report["largest"] > 0.6
    (cell,) = [cell for cell in report["cells"] if cell["largest"] > 1e-3]
    assert cell["material"] == 4 and (cell["worst"]["x"], cell["worst"]["y"]) == (x, y)


def test_all_below_float32_is_nothing_to_compare(dump, tmp_path):
    dim(dump, 1e-36)
    for light in range(LIGHTS):
        for plane in dump.planes(f"light{light}.E"):
            plane *= np.float32(1e-4)
        for plane in dump.planes(f"light{light}.S"):
            plane[:] = 0
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert not report["pass"] and report["values"] == 0


def test_nothing_to_compare(dump, tmp_path):
    for light in range(LIGHTS):
        for plane in dump.planes(f"light{light}.S") + dump.planes(f"light{light}.E"):
            plane[:] = 0
    path = dump.write(tmp_path / "x.exr")
    report = check_json(path)
    assert not report["pass"] and report["values"] == 0
    assert "nothing to compare" in check(path).stdout


def test_no_lights(dump, tmp_path):
    path = dump.write(tmp_path / "x.exr", names=[n for n in dump.names if n[:5] != "light"])
    assert not check_json(path)["pass"]


def test_no_hits(dump, tmp_path):
    dump.pixels[:] = 0
    dump["material.ID"][:] = -1
    assert not check_json(dump.write(tmp_path / "x.exr"))["pass"]


def test_swapped_lights(dump, tmp_path):
    for a, b in zip(dump.planes("light0.S"), dump.planes("light1.S")):
        a[:], b[:] = b.copy(), a.copy()
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert all(cell["largest"] > 0.5 for cell in report["cells"])


def assert_differs(path):
    report = check_json(path)
    assert not report["pass"] and not report["faults"] and report["largest"] > 0.1


@pytest.mark.parametrize("group", ["Ns", "V", "light0.L", "light1.E", "Color"])
def test_each_input_matters(dump, tmp_path, group):
    """Inputs that are another hit's."""
    hit = dump["material.ID"] >= 0
    both = hit & np.roll(hit, 7, axis=0)
    for plane in dump.planes(group):
        plane[:] = np.where(both, np.roll(plane, 7, axis=0), plane)
    assert_differs(dump.write(tmp_path / "x.exr"))


def test_tangent_matters(dump, tmp_path):
    n, t = (np.stack(dump.planes(group), axis=2) for group in "NT")
    for plane, turned in zip(dump.planes("T"), np.moveaxis(np.cross(n, t), 2, 0)):
        plane[:] = turned
    assert_differs(dump.write(tmp_path / "x.exr"))


def test_normal_matters(dump, tmp_path):
    for n, t in zip(dump.planes("N"), dump.planes("T")):
        n[:], t[:] = np.cos(0.1) * n + np.sin(0.1) * t, np.cos(0.1) * t - np.sin(0.1) * n
    assert_differs(dump.write(tmp_path / "x.exr"))


def test_wrong_material_id(dump, tmp_path):
    ids = dump["material.ID"]
    ids[ids == 6] = 5
    assert_only_material_fails(dump.write(tmp_path / "x.exr"), 5)


@pytest.mark.parametrize("wrong", [99, 2.5, -2, np.nan, np.inf, 1e30])
def test_unknown_material_id(dump, tmp_path, wrong):
    dump["material.ID"][dump["material.ID"] == 2] = wrong
    fault = assert_fault(dump.write(tmp_path / "x.exr"), "material.ID")
    assert fault["count"] > 50


def test_hits_hidden_as_misses(dump, tmp_path):
    dump["material.ID"][dump["material.ID"] == 2] = -1
    assert_fault(dump.write(tmp_path / "x.exr"), "miss")


def first_hit(dump):
    y, x = np.argwhere(dump["material.ID"] >= 0)[40]
    return y, x


@pytest.mark.parametrize("channel, value, words", [
    ("light1.S.G", np.nan, "S is not finite"),
    ("light0.S.R", np.inf, "S is not finite"),
    ("light0.E.R", -1, "E is negative"),
    ("light0.E.G", -1, "E is negative"),
    ("light0.E.B", -1, "E is negative"),
    ("light0.E.B", np.nan, "E is negative or not finite"),
    ("light1.E.R", np.inf, "E is negative or not finite"),
    ("light0.L.X", 3, "not unit"),
    ("light0.L.X", np.nan, "not unit"),
    ("N.X", 2, "not unit"),
    ("V.Z", np.inf, "not unit"),
    ("Ns.Y", np.nan, "not unit"),
    ("T.Y", -4, "not unit"),
    ("Color.G", np.nan, "not finite"),
    ("P.Z", np.inf, "not finite"),
    ("uv.V", np.nan, "not finite"),
])
def test_one_bad_value(dump, tmp_path, channel, value, words):
    y, x = first_hit(dump)
    dump[channel][y, x] = value
    fault = assert_fault(dump.write(tmp_path / "x.exr"), words)
    assert (fault["x"], fault["y"]) == (x, y)


def test_threads_change_nothing(dump, tmp_path):
    hits = np.argwhere(dump["material.ID"] >= 0)
    for y, x in hits[3::97]:
        dump["light1.S.G"][y, x] = np.nan
    for y, x in hits[5::61]:
        dump["light0.S.R"][y, x] *= np.float32(1.01)
    path = dump.write(tmp_path / "x.exr")
    one, two, many = (check(path, "--json", "--threads", n).stdout for n in ("1", "2", "23"))
    assert one == two == many
    fault, = json.loads(one)["faults"]
    assert fault["count"] == len(hits[3::97]) and (fault["y"], fault["x"]) == tuple(hits[3])
    assert not json.loads(one)["pass"]


def test_a_light_without_red_is_no_shadow(dump, tmp_path):
    for name in ("light0.E.R", "light0.S.R"):
        dump[name][:] = 0
    assert check(dump.write(tmp_path / "green.exr")).returncode == 0
    dump["light0.S.G"][:] *= 1.01
    assert check(dump.write(tmp_path / "wrong.exr")).returncode == 1


def test_lengths_of_directions(dump, tmp_path):
    for plane in dump.planes("V"):
        plane *= 1.001
    assert_fault(dump.write(tmp_path / "x.exr"), "not unit")


def test_tangent_along_normal(dump, tmp_path):
    hit = dump["material.ID"] >= 0
    for t, n in zip(dump.planes("T"), dump.planes("N")):
        t[hit] = 0.8 * t[hit] + 0.6 * n[hit]
    assert_fault(dump.write(tmp_path / "x.exr"), "orthogonal")


def bright_hit(dump):
    """A pixel of material 3 and the index where light 0's S is greatest."""
    s = np.where(dump["material.ID"] == 3, dump["light0.S.R"], 0)
    return np.unravel_index(s.argmax(), s.shape)


@pytest.mark.parametrize("factor, passes", [(1 + 5e-5, True), (1 + 2e-4, False), (-1, False),
                                            (0, False), (3, False)])
def test_one_value_off(dump, tmp_path, factor, passes):
    y, x = bright_hit(dump)
    dump["light0.S.R"][y, x] *= np.float32(factor)
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert report["pass"] == passes
    if not passes:
        (cell,) = (c for c in report["cells"] if c["largest"] > 1e-4)
        worst = cell["worst"]
        assert (cell["material"], cell["light"]) == (3, 0)
        assert (worst["x"], worst["y"], worst["channel"]) == (x, y, "R")
        assert worst["s"] == pytest.approx(worst["reference"] * factor, rel=1e-4)


@pytest.mark.parametrize("seed, tolerance", [(2, 1e-4), (1, 1e-5), (3, 1e-5)])
def test_rounding_of_directions_is_no_error(makedump, tmp_path, seed, tolerance):
    """At exponents of 6000 the float32 directions alone make errors over the limit; they are
    computed, reported and excused."""
    path = run_makedump(makedump, tmp_path / "sharp.exr", "sharp", seed=seed)
    limits = ["--tolerance", str(tolerance), "--mean-tolerance", "1e-4"]
    report = check_json(path, *limits)
    assert report["pass"] and report["largest"] > tolerance and report["excused"] > 0
    assert report["beyond_rounding"] <= tolerance
    worst = max(report["cells"], key=lambda cell: cell.get("largest", 0))["worst"]
    assert report["largest"] - tolerance <= worst["rounding"] < 1e-3
    assert "excused" in check(path, *limits).stdout
    assert check(path, "--tolerance", "0").returncode == 1  # no dump is as near as that, but it may be asked


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_rounding_of_directions_is_no_error_of_means(makedump, tmp_path, seed):
    """What is left of a material's mean beyond rounding is next to nothing; a real error of all values is left."""
    path = run_makedump(makedump, tmp_path / "sharp.exr", "sharp", seed=seed)
    limits = ["--tolerance", "1e-3", "--mean-tolerance", "1e-6"]
    report = check_json(path, *limits)
    assert report["pass"] and report["mean"] > 2e-6 and report["mean_beyond_rounding"] <= 1e-6
    cell = max(report["cells"], key=lambda cell: cell.get("mean", 0))
    assert cell["mean_beyond"] < 2e-7, "float32's own S is within 6e-8"
    assert "means over the limit: beyond" in check(path, *limits).stdout
    dump = Dump(path)
    for light in range(LIGHTS):
        for plane in dump.planes(f"light{light}.S"):
            plane *= np.float32(1 + 2e-4)
    report = check_json(dump.write(tmp_path / "bright.exr"), *limits)
    assert not report["pass"] and report["mean_beyond_rounding"] > 1e-4


@pytest.mark.parametrize("options", [[], ["sharp"]])
def test_real_error_is_never_excused(makedump, tmp_path, options):
    dump = Dump(run_makedump(makedump, tmp_path / "x.exr", *options))
    rng = np.random.default_rng(3)
    lit = np.argwhere((dump["light0.S.G"] > .01 * dump["light0.S.G"].max()))
    for y, x in rng.permutation(lit)[:8]:
        before = dump["light0.S.G"][y, x]
        dump["light0.S.G"][y, x] *= np.float32(1 + 1e-3)
        report = check_json(dump.write(tmp_path / "y.exr"), "--mean-tolerance", "1")
        assert not report["pass"] and 5e-4 < report["beyond_rounding"] < 1.2e-3
        dump["light0.S.G"][y, x] = before


def test_light_where_the_reference_has_none(dump, tmp_path):
    dark = (dump["material.ID"] == 3) & (dump["light0.S.R"] == 0)
    y, x = np.argwhere(dark)[0]
    dump["light0.S.R"][y, x] = dump["light0.S.R"][bright_hit(dump)]
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert not report["pass"] and report["largest"] == 1


def test_mean_is_limited_too(dump, tmp_path):
    for plane in dump.planes("light0.S"):
        plane *= np.float32(1 + 3e-5)
    path = dump.write(tmp_path / "x.exr")
    report = check_json(path)
    assert not report["pass"] and report["largest"] < 1e-4 and report["mean"] > 2e-5
    assert check(path, "--mean-tolerance", "1e-4").returncode == 0
    assert check(path, "--mean-tolerance", "1e-4", "--tolerance", "1e-5").returncode == 1


def along_horizon(dump, height):
    """V of material 7 moved to a cosine of `height` from Ns, light 0 mirrored about a
    half vector 10 degrees from Ns, where the lobe is bright; S there is 0."""
    ns, n, v = (np.stack(dump.planes(group), axis=2).astype(float) for group in ("Ns", "N", "V"))
    ns /= np.maximum(np.linalg.norm(ns, axis=2, keepdims=True), 1e-9)
    flat = v - (v * ns).sum(2, keepdims=True) * ns
    flat /= np.maximum(np.linalg.norm(flat, axis=2, keepdims=True), 1e-9)
    v = flat * np.sqrt(1 - height**2) + height * ns
    h = np.cos(np.radians(10)) * ns + np.sin(np.radians(10)) * flat
    light = 2 * (h * v).sum(2, keepdims=True) * h - v
    lit = (dump["material.ID"] == 7) & ((n * v).sum(2) > 0.1) & ((n * light).sum(2) > 0.1)
    for group, vectors in (("V", v), ("light0.L", light)):
        for i, plane in enumerate(dump.planes(group)):
            plane[lit] = vectors[lit, i]
    for plane in dump.planes("light0.S") + dump.planes("light1.S") + dump.planes("light1.E"):
        plane[lit] = 0
    return lit.sum()


def test_rounding_may_decide_on_the_horizon(dump, tmp_path):
    moved = along_horizon(dump, 0)
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert report["pass"]
    assert moved > 20 and 0.1 * moved < report["horizon"] / 3 < 0.9 * moved


def test_no_excuse_above_the_horizon(dump, good, tmp_path):
    moved = along_horizon(dump, 1e-5)
    faded = check_json(good)["horizon"]  # of the materials whose light fades at the horizon
    report = check_json(dump.write(tmp_path / "x.exr"))
    assert moved > 20 and report["horizon"] == faded < 20
    assert not report["pass"] and report["largest"] == 1


def test_idle_material_and_light(dump, tmp_path):
    hit = dump["material.ID"] == 1
    for light in range(LIGHTS):
        for plane in dump.planes(f"light{light}.S") + dump.planes(f"light{light}.E"):
            plane[hit] = 0
    path = dump.write(tmp_path / "x.exr")
    result = check(path)
    assert result.returncode == 0 and "not compared: 1 material and 0 lights" in result.stdout
    assert result.stdout.startswith(f"{path}: {WIDTH} x {HEIGHT} pixels, {LIGHTS} lights, {MATERIALS} materials, from makedump\n")
    assert re.findall(r"^ +(\d+) .* (\d) +0 +- +-  unlit$", result.stdout, re.M) == [("1", "0"), ("1", "1")]
    # one more that no pixel has; from nobody knows whom
    del dump.header["renderer"]
    dump.header["materials"].append(dump.header["materials"][1] | {"id": 77, "name": "nowhere"})
    result = check(dump.write(tmp_path / "more.exr"), "--all")
    assert result.returncode == 1 and "not compared: 2 materials and 0 lights" in result.stdout
    assert f" {MATERIALS + 1} materials, from unknown\n" in result.stdout
    assert len(re.findall(r"^ +77 nowhere .* -  not in the picture$", result.stdout, re.M)) == LIGHTS


# ---- headers -------------------------------------------------------------------------


@pytest.mark.parametrize("edit, words", [
    (lambda h: h.pop("materials"), "materials"),
    (lambda h: h["materials"].clear(), "materials"),
    (lambda h: h.update(materials={"id": 1}), "materials"),
    (lambda h: h["materials"].append(7), f"number {MATERIALS}"),
    (lambda h: h["materials"].append(h["materials"][2]), "two materials"),
    (lambda h: h["materials"][2].pop("id"), "lacks 'id'"),
    (lambda h: h["materials"][2].pop("detail"), "lacks 'detail'"),
    (lambda h: h["materials"][2].pop("ey"), "lacks 'ey'"),
    (lambda h: h["materials"][2].pop("f0"), "lacks 'f0'"),
    (lambda h: h["materials"][2].update(detail="rotated"), "'detail'"),
    (lambda h: h["materials"][2].update(groove=1), "'groove'"),
    (lambda h: h["materials"][2].update(ex=-1), "'ex'"),
    (lambda h: h["materials"][2].update(ex="200"), "'ex'"),
    (lambda h: h["materials"][2].update(ex=[200]), "'ex'"),
    (lambda h: h["materials"][2].update(f0=1), "'f0'"),
    (lambda h: h["materials"][2].update(f0=[1, 1]), "'f0'"),
    (lambda h: h["materials"][2].update(f0=[1, 1, 1, 1]), "'f0'"),
    (lambda h: h["materials"][2].update(id=2.5), "'id'"),
    (lambda h: h["materials"][2].update(id=-1), "'id'"),
    (lambda h: h["materials"][2].update(name=3), "'name'"),
    (lambda h: h["materials"][2].update(slopes=[0, 0, .1, 0, .1, 5]), "bad value of 'slopes': expected [x, y, xx, xy, yy]"),
    (lambda h: h["materials"][2].update(slopes=[0, 0, .1, 0]), "'slopes'"),
    (lambda h: h["materials"][2].update(glow=3), "unknown key 'glow'"),
])
def test_bad_header(dump, tmp_path, edit, words):
    edit(dump.header)
    path = dump.write(tmp_path / "x.exr")
    result = check(path)
    assert result.returncode == 1
    assert words in result.stderr and str(path) in result.stderr


def test_dump_without_horizon(dump, tmp_path):
    """Dumps from before that list are `hard`: right where the material is, wrong elsewhere."""
    for material in dump.header["materials"]:
        if material.pop("horizon") != "hard":
            for plane in dump.planes("light0.E") + dump.planes("light1.E") + \
                    dump.planes("light0.S") + dump.planes("light1.S"):
                plane[dump["material.ID"] == material["id"]] = 0
    assert check(dump.write(tmp_path / "x.exr")).returncode == 0


@pytest.mark.parametrize("text, words", [
    ("not JSON", "line 1, column 1"),
    ('{"materials": [', "line 1"),
    ("[]", "materials"),
    ("3", "materials"),
])
def test_header_is_no_json(dump, tmp_path, text, words):
    path = dump.write(tmp_path / "x.exr", text=text)
    result = check(path)
    assert result.returncode == 1
    assert words in result.stderr and str(path) in result.stderr


def test_what_a_header_says_twice(dump, near_cloth, tmp_path):
    for of, said, words in ((dump, '"ey": 10, "detail"', "two values of 'ey'"), (dump, '"id": 3, "detail"', "two values of 'id'"),
                            (Dump(near_cloth), '"id": 3, "fabric"', "two values of 'id'"), (Dump(near_cloth), '"name": "b", "fabric"', "two values of 'name'"),
                            (Dump(near_cloth), '"gloss": 1, "fabric"', "unknown key beside fabric: 'gloss'")):
        text = json.dumps(of.header).replace(said.split(", ")[1], said, 1)
        result = check(of.write(tmp_path / "x.exr", text=text))
        assert result.returncode == 1 and f"material number 0 of the header: {words}" in result.stderr, (said, result.stderr)
    cloth = Dump(near_cloth)
    del cloth.header["materials"][0]["id"]
    assert "material number 0 of the header: lacks 'id'" in check(cloth.write(tmp_path / "x.exr")).stderr


def test_missing_material(dump, tmp_path):
    del dump.header["materials"][4]
    assert_fault(dump.write(tmp_path / "x.exr"), "material.ID is not in the header")


# ---- files ---------------------------------------------------------------------------


@pytest.mark.parametrize("settings, words", [
    ({"type": oiio.HALF}, "32-bit float"),
    ({"compression": "piz"}, "compression"),
    ({"compression": "dwaa:45"}, "compression"),
    ({"tile": 16}, "tiled"),
])
def test_other_kinds_of_files(dump, tmp_path, settings, words):
    path = dump.write(tmp_path / "x.exr", **settings)
    result = check(path)
    assert result.returncode == 1
    assert words in result.stderr and str(path) in result.stderr


def test_missing_channel(dump, tmp_path):
    path = dump.write(tmp_path / "x.exr", names=[n for n in dump.names if n != "Ns.Y"])
    result = check(path)
    assert result.returncode == 1 and "Ns.Y is missing" in result.stderr


def test_usage(good, tmp_path):
    for options in ([], ["--tolerance"], [good, good], [good, "--frobnicate"], [good, "--threads"],
                    *([good, "--threads", bad] for bad in ("0", "-1", "x", "1.5", "")),
                    *([good, "--tolerance", bad] for bad in ("nan", "inf", "-1", "x", "1x", ""))):
        result = subprocess.run([SHADE, "check", *options], capture_output=True, text=True)
        assert result.returncode == 2 and result.stderr and not result.stdout
    result = subprocess.run([SHADE, "check", good, "--tolerance", "1x"], capture_output=True, text=True)
    assert "'1x': expected a number of at least 0" in result.stderr
    result = subprocess.run([SHADE, "check", tmp_path], capture_output=True, text=True)
    assert result.returncode == 1 and "is a folder" in result.stderr
    for option in ("--help", "-h"):
        result = subprocess.run([SHADE, "check", option], capture_output=True, text=True)
        assert result.returncode == 0 and "--tolerance" in result.stdout
    for path in (tmp_path / "absent.exr", tmp_path):
        result = check(path)
        assert result.returncode == 1 and str(path) in result.stderr


def test_without_openexr(copy, good):
    for part in "src", "reference":  # these know nothing of OpenEXR
        shutil.copytree(copy / "build/obj" / part, copy / "bare/obj" / part, copy_function=shutil.copy)
    make("bare", copy, COPY_FLAGS, ["shade"], ["EXR_LIBS="])
    for options, status in (([good], 1), (["--help"], 0)):
        result = subprocess.run([copy / "bare/shade", "check", *options], capture_output=True,
                                text=True)
        assert result.returncode == status
    assert "libopenexr-dev" in check(good, shade=copy / "bare/shade").stderr


@pytest.fixture(scope="module")
def sanitized():
    """The tool under AddressSanitizer, which `make check` has made."""
    subprocess.run(["make", "-s", "NEEDS=", "sanitized"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return ROOT / "build/sanitized/shade"


def test_damaged_files_under_sanitizers(sanitized, makedump, tmp_path):
    """In-process, test_dump.c tries every byte of a header; here the whole tool."""
    path = tmp_path / "x.exr"
    subprocess.run([makedump, path, "12", "20", "5"], check=True)
    assert check(path, shade=sanitized).returncode == 0
    whole = path.read_bytes()
    random = np.random.default_rng(7)
    cuts = [whole[:n] for n in random.integers(0, len(whole), 30)]
    damaged = []
    for offset in random.integers(0, len(whole), 60):
        damaged.append(bytearray(whole))
        damaged[-1][offset] ^= random.integers(1, 256)
    for data in cuts + damaged:
        path.write_bytes(data)
        result = check(path, shade=sanitized)
        assert result.returncode in (0, 1), result.stderr
        assert "Sanitizer" not in result.stderr and "runtime error" not in result.stderr
        if len(data) < len(whole):
            assert result.returncode == 1 and str(path) in result.stderr
