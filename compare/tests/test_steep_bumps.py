# SPDX-License-Identifier: Apache-2.0
"""Bumps among bumps: the traced truth beside other programs' numbers and beside what a flat metal must give."""
import pytest

import steep_bumps as bumps

COST = 1.7


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


def test_without_bumps_every_way_is_the_displaced_one(tmp_path):
    found = traced(tmp_path, "ridges_across", 0.01, ("ggx", 0.02, 0.02), 4000)
    for (eye, reflectance, light, way), value in found.items():
        if light == "even":
            assert value == pytest.approx(reflectance, rel=0.02), (eye, way)
        if light in ("zenith", "horizon"):
            assert value == pytest.approx(found[eye, reflectance, light, "displaced"], rel=0.03), (eye, light, way)
        if light.startswith("sun_60") and way != "schuessler":  # whose upright mirrors, however small, send light back
            assert value == pytest.approx(found[eye, reflectance, light, "displaced"], rel=0.1, abs=0.01), (eye, light, way)


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
