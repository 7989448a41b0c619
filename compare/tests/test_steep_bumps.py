# SPDX-License-Identifier: Apache-2.0
"""Bumps among bumps: the traced truth beside other programs' numbers and beside what a flat metal must give."""
import math
import os
import re
import subprocess
import time

import pytest

import steep_bumps as bumps

COST = 3.5


def traced(tmp_path, *order):
    """{(eye, reflectance, light, way): mean} of one case."""
    surface, slope, lobe, paths = order
    options = bumps.arguments(["--output", str(tmp_path), "--paths", str(paths)])
    with open(bumps.trace(options, (surface, slope, lobe)), encoding="utf-8") as file:
        rows = [row.split(",") for row in file.read().splitlines()[1:]]
    return {(float(row[5]), float(row[6]), row[7], row[8]): 0.5 * (float(row[9]) + float(row[10])) for row in rows}


@pytest.mark.parametrize("surface, wanted", [
    # two programs that nobody derived from this one, 20,000 paths each
    ("noise", {"even": 0.511, "zenith": 0.650, "horizon": 0.371}),
    ("sine", {"even": 0.516, "zenith": 0.681, "horizon": 0.351}),
])
def test_the_truth_is_what_other_programs_found(tmp_path, surface, wanted):
    found = traced(tmp_path, surface, 1, ("ggx", 0.2, 0.2), 2000)
    for light, value in wanted.items():
        assert found[30.0, 0.6, light, "displaced"] == pytest.approx(value, rel=0.03), light
    # with light from everywhere a white metal of smooth facets keeps it all, however bumped; what is lost is the facets'
    assert 0.85 < found[30.0, 1.0, "even", "displaced"] < 0.93
    # sun and eye trade places: what bumps hide of one they shade of the other
    there, back = (sum(found[eye, 1.0, f"sun_{sun}_{turn}", "displaced"] * math.sin(math.radians(eye))
                       for turn in (0, 90, 180) for eye, sun in pairs)
                   for pairs in (((15.0, 30), (15.0, 60)), ((30.0, 15), (60.0, 15))))
    assert there == pytest.approx(back, rel=0.12)


def test_without_bumps_every_way_is_the_displaced_one(tmp_path):
    found = traced(tmp_path, "ridges_across", 0.01, ("ggx", 0.02, 0.02), 4000)
    for (eye, reflectance, light, way), value in found.items():
        if light == "even":
            assert value == pytest.approx(reflectance, rel=0.02), (eye, way)
        up = math.sin(math.radians(eye))  # a mirror sees the sky before the eye, as high up; of a lobe this narrow that is the mean
        sky = {"zenith": 0.2 + 1.6 * up, "horizon": 1.8 - 1.6 * up, "patch_before": 3.4, "patch_behind": 0.2}
        if light in sky and way != "schuessler" and (eye in (30, 45) or light != "patch_before"):
            assert value == pytest.approx(reflectance * sky[light], rel=0.03, abs=0.015), (eye, light, way)
        if light in ("zenith", "horizon"):
            assert value == pytest.approx(found[eye, reflectance, light, "displaced"], rel=0.03), (eye, light, way)
        if light.startswith("sun_60") and way != "schuessler":  # whose upright mirrors, however small, send light back
            assert value == pytest.approx(found[eye, reflectance, light, "displaced"], rel=0.1, abs=0.01), (eye, light, way)
    for eye in (15.0, 30.0, 60.0):  # of suns as high as the eye that one shines which is behind the surface
        suns = [found[eye, 1.0, f"sun_{eye:g}_{turn}", "displaced"] for turn in (0, 90, 180)]
        assert suns[2] > 100 * max(suns[:2]) and suns[2] > 50 and suns[2] > 100 * found[eye, 1.0, "sun_5_180", "displaced"], (eye, suns)


def test_ridges_run_along_the_eye_or_across_it(tmp_path):
    """Mirrors that lean to the sides alone, however often they are met, send no light back to where the eye is: of a patch there
    nothing but the sky's least is seen. Those across the eye's way send a good part."""
    for surface, eyes, least, most in (("ridges_along", (15.0, 45.0, 75.0), 0.199, 0.202), ("ridges_across", (45.0,), 0.5, 2)):
        found = traced(tmp_path, surface, 1, ("ggx", 0.001, 0.001), 200)
        for eye in eyes:
            behind, even = (found[eye, 1.0, sky, "displaced"] for sky in ("patch_behind", "even"))
            assert least < behind / even < most, (surface, eye)


def test_of_an_uneven_field_slopes_near_a_point_count(tmp_path):
    """Of scratches, most of whose plate is flat: that of the whole is half as far off again in the median."""
    plate = traced(tmp_path, "scratches", 1, ("ggx", 0.2, 0.2), 1000)
    off = [value / plate[(*key, "displaced")] - 1 for *key, way, value in ((*key, value) for key, value in plate.items())
           if way == "mutual" and key[2] in ("even", "zenith", "horizon")]
    assert len(off) == 30 and abs(sum(off) / 30) < 0.015 and sorted(map(abs, off))[15] < 0.022


def test_lights_of_lines():
    rows = [dict(row("hard", light, 1.0), surface=surface) for surface in ("noise", "pits")
            for light in ("even", "patch_behind", "sun_5_0", "sun_30_90")]
    assert [bumps.light_of(one) for one in rows] == ["skies", "skies", "", "suns from 15°",
                                                    "even, zenith, horizon", "patches", "", "suns from 15°"]
    assert [[bumps.is_of(name, one) for one in rows[::4]] for name in ("all", "uneven", "pits")] == [[1, 0], [0, 1], [0, 1]]


def row(way, light, mean, again=None):
    return {"surface": "noise", "slope": 1.0, "mdf": "ggx", "first": 0.2, "second": 0.2, "eye": 30.0, "reflectance": 1.0,
            "light": light, "way": way, "value": mean, "again": mean if again is None else again}


def test_errors_are_over_the_truth_and_under_suns_over_their_mean_as_well():
    found = bumps.errors([row("displaced", "even", 0.5, 0.7), row("hard", "even", 0.45), row("displaced", "sun_15_0", 0.0),
                          row("displaced", "sun_15_90", 2.0), row("hard", "sun_15_0", 0.1), row("hard", "sun_15_90", 1.0)])
    by_light = {one["light"]: one for one in found}
    assert by_light["even"]["error"] == pytest.approx(-0.25) and by_light["even"]["noise"] == pytest.approx(1 / 6)
    assert by_light["sun_15_0"]["error"] == pytest.approx(1.0) and by_light["sun_15_90"]["error"] == pytest.approx(-1 / 2.1)


def test_groups_that_got_worse_are_named():
    rows = [row("displaced", light, 1.0) for light in ("even", "zenith")]
    rows += [row(bumps.OLD, "even", 0.9), row("new", "even", 0.88), row(bumps.OLD, "zenith", 0.9), row("new", "zenith", 1.14)]
    count, worse = bumps.groups(bumps.errors(rows), "new")
    assert count == 2 and [line[5] for line in worse] == ["zenith"]
    assert worse[0][6] == pytest.approx(14) and worse[0][8] == pytest.approx(10)


@pytest.mark.parametrize("wrong", [["--slopes", "1,steep"], ["--surfaces", "noise,wool"]])
def test_words_that_are_none_are_refused(wrong, capsys):
    with pytest.raises(SystemExit) as ended:
        bumps.arguments(wrong)
    assert ended.value.code == 2 and "wants" in capsys.readouterr().err


def test_the_programs_own_words(tmp_path):
    """What is out of range is refused and leaves no file; a line for each eye, reflectance, light and way; seeds."""
    def ask(*words):
        return subprocess.run([bumps.PROGRAM, *words], cwd=tmp_path, capture_output=True, text=True, check=False)
    good = ["o.csv", "ridges_along", "0.01", "ggx", ".2", ".3", "64"]
    for at, words in ((1, ("wool", "")), (2, (".009", "2.01", "1x", "nan")), (3, ("phong",)), (4, ("0", "-1", "2e6")),
                      (5, ("0", "x")), (6, ("63", "1.1e7", ""))):
        for word in words:
            done = ask(*good[:at], word, *good[at + 1:])
            assert done.returncode == 2 and "out of its range" in done.stderr and "--help" in done.stderr, word
    for seed in ("-1", "1.1e9", "x"):
        assert ask(*good, seed).returncode == 2, seed
    for words in ([], good[:6], [*good, "1", "2"], ["--help", "now"]):
        done = ask(*words)
        assert done.returncode == 2 and done.stderr.startswith("usage: bumps OUT.csv") and not done.stdout
    done = ask("--help")
    assert done.stdout.startswith("usage: bumps OUT.csv SURFACE SLOPE MDF FIRST SECOND PATHS [SEED]")
    assert done.returncode == 0 and not done.stderr and not list(tmp_path.iterdir())
    done = ask("none/o.csv", *good[1:])
    assert done.returncode == 1 and "bumps: none/o.csv: " in done.stderr and not list(tmp_path.iterdir())
    written = []
    for seed in ((), ("1",), ("2",)):
        assert ask(*good, *seed).returncode == 0
        written.append((tmp_path / "o.csv").read_text(encoding="utf-8").splitlines())
    assert written[0] == written[1] != written[2]
    assert written[0][0] == "surface,slope,mdf,first,second,eye,reflectance,light,way,value,again"
    rows = [line.split(",") for line in written[0][1:]]
    ways = ["displaced", "hard", "valid_reflection", "estevez", "chiang", "schuessler", "valid_estevez", "mutual"]
    lights = ["even", "zenith", "horizon", "patch_before", "patch_behind"]
    lights += [f"sun_{up}_{turn}" for up in (5, 15, 30, 60) for turn in (0, 90, 180)]
    assert [row[:9] for row in rows] == [["ridges_along", "0.01", "ggx", "0.2", "0.3", eye, color, light, way]
                                         for eye in ("15", "30", "45", "60", "75") for color in ("0.6", "1")
                                         for light in lights for way in ways]


# ---- what is traced, printed and kept


def test_what_is_traced(monkeypatch, tmp_path):
    """Each case once, by a file that says what it is of, until the program changes; fields that are uneven by fewer paths."""
    program = tmp_path / "bumps"
    program.write_text(f'#!/bin/sh\necho "$@" >>{tmp_path}/asked\n[ ! -e {tmp_path}/fails ] || {{ echo no memory >&2; exit 3; }}\n'
                       'echo "surface,slope,mdf,first,second,eye,reflectance,light,way,value,again" >$1\necho "$2,$3,$4,$5,$6,30,1,even,hard,.5,.25" >>$1\n')
    program.chmod(0o755)
    monkeypatch.setattr(bumps, "PROGRAM", program)
    options = bumps.arguments(["--output", str(tmp_path), "--surfaces", "sine,noise", "--slopes", ".3,1", "--long", "--uneven", "--paths", "9000"])
    rows = bumps.measure(options)
    asked = [line.split() for line in (tmp_path / "asked").read_text().splitlines()]
    cases = {tuple(words[1:]) for words in asked}
    lobes = [("ggx", alpha, alpha) for alpha in ("0.05", "0.2", "0.4")]
    long = [("ggx", "0.05", "0.4"), ("ggx", "0.4", "0.05"), ("ashikhmin_shirley", "200", "10"), ("ashikhmin_shirley", "10", "200")]
    uneven = {(surface, slope, "ggx", alpha, alpha, "8000") for surface in ("fractal", "long_and_fine", "roofs", "letter", "pits", "scratches", "half")
              for slope in ("0.6", "1.0") for alpha in ("0.05", "0.2")}
    assert cases == {(surface, slope, *lobe, "9000") for surface in ("sine", "noise") for slope in ("0.3", "1.0") for lobe in lobes + (long if surface == "noise" else [])} | uneven
    assert len(asked) == len(cases) == len(rows) and asked[0][0].startswith(str(tmp_path)) and (tmp_path / "pits-0.6-ggx-0.05-0.05-8000.csv").exists()
    first = next(row for row in rows if row["surface"] == "pits")
    assert {key: first[key] for key in ("slope", "mdf", "light", "value", "again")} == {"slope": .6, "mdf": "ggx", "light": "even", "value": .5, "again": .25}
    bumps.measure(options)
    assert len((tmp_path / "asked").read_text().splitlines()) == len(asked)
    os.utime(program, (time.time() + 9,) * 2)
    case = ("sine", .3, ("ggx", .2, .2))
    bumps.trace(options, case)
    assert len((tmp_path / "asked").read_text().splitlines()) == len(asked) + 1
    (tmp_path / "fails").touch()
    with pytest.raises(bumps.report.StepFailed, match="bumps: exit status 3: no memory"):
        bumps.trace(options, case)
    given = bumps.arguments([])
    assert (given.paths, given.surfaces, given.slopes, given.long, given.uneven, given.output.name) == (20000, ["noise", "sine", "ridges_across", "ridges_along"], [.3, .6, 1, 1.6], False, False, "bumps")


def test_what_is_printed_and_kept(monkeypatch, tmp_path, capsys):
    """A line for each surface, lobe, light and slope: median and 95 % of each way, in per cent; which groups got worse."""
    made = []
    for surface in ("noise", "pits"):
        for first, second in ((.2, .2), (.05, .4)):
            for light, old, new in (("even", .89, .8), ("zenith", .89, .88), ("sun_5_0", .5, .5)):
                of = {"surface": surface, "first": first, "second": second}
                made += [{**row(way, light, value), **of} for way, value in (("displaced", 1.0), (bumps.OLD, old), ("mutual", new))]
    monkeypatch.setattr(bumps, "measure", lambda options: made)
    kept = []
    monkeypatch.setattr(bumps.results, "write", lambda *words: kept.append(words))
    assert bumps.main(["--output", str(tmp_path), "--results"]) == 0
    said = [re.split(r"  +", line.strip()) for line in capsys.readouterr().out.splitlines()]
    assert said[1] == ["Error of the mean beside displaced bumps, in per cent: median / 95 % of the cases"]
    assert said[2] == ["surface", "lobes", "light", "slope", "cases", "valid_estevez", "mutual", "noise of the truth"]
    line = lambda surface, lobes, light: [surface, lobes, light, "1.0", "2", "11.0 / 11", "16.0 / 20", "0.0 / 0.0"]
    pits = "even, zenith, horizon"
    assert said[4:12] == [line("noise", "round", "skies"), line("noise", "long", "skies"), line("all even surfaces", "round", "skies"), line("all even surfaces", "long", "skies"),
                          line("pits", "round", pits), line("pits", "long", pits), line("all uneven surfaces", "round", pits), line("all uneven surfaces", "long", pits)]
    assert said[12:] == [["mutual: 4 of 8 groups more than 3 points worse than valid_estevez"], [f"All values: {tmp_path}"]]
    (name, _head, columns, cells), = kept
    assert (name, columns[5:]) == ("bumps", ["`valid_estevez`", "`mutual`", "noise of the truth"]) and len(cells) == 8
    groups = (tmp_path / "groups.csv").read_text().splitlines()
    assert groups[0] == "way,surface,slope,mdf,first,second,sky,median,95 %,valid_estevez median,valid_estevez 95 %" and len(groups) == 5 and all(",even," in group for group in groups[1:])
    assert (tmp_path / "errors.csv").read_text().splitlines()[0].startswith("surface,lobes,light,slope,cases") and len((tmp_path / "bumps.csv").read_text().splitlines()) == 37
    assert [bumps.said(pair) for pair in ((1.26, 9.94), (1.26, 12.6))] == ["1.3 / 9.9", "1.3 / 13"]
    off = bumps.spread([{"error": value / 100} for value in range(-100, 1)])
    assert off == (50, pytest.approx(95))
