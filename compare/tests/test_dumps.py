# SPDX-License-Identifier: Apache-2.0
"""Reading and comparing dumps; each comparison must notice what it is there to notice."""
import numpy as np
import pytest
import synthetic

import consistency
import dumps

COST = 0.78


@pytest.fixture
def channels():
    return synthetic.planes()


def load(path, channels):
    return dumps.read(synthetic.write(path, channels))


def compare(tmp_path, channels, change):
    """(rows by first word, verdict) of a dump against itself after `change`."""
    changed = {name: plane.copy() for name, plane in channels.items()}
    change(changed)
    a, b = load(tmp_path / "a.exr", channels), load(tmp_path / "b.exr", changed)
    rows, good = consistency.dump_rows(a, b)
    return {row[0].split()[0]: row for row in rows}, good


def turn(channels, name, degrees, pixels=slice(None)):
    """Turn a direction about z, in the covered pixels numbered by `pixels`."""
    where = np.flatnonzero(channels["material.ID"].ravel() >= 0)[pixels]
    x, y = channels[name + ".X"].ravel(), channels[name + ".Y"].ravel()
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    x[where], y[where] = c * x[where] - s * y[where], s * x[where] + c * y[where]
    channels[name + ".X"], channels[name + ".Y"] = x.reshape(64, 64), y.reshape(64, 64)


def test_equal_dumps_agree(tmp_path, channels):
    rows, good = compare(tmp_path, channels, lambda c: None)
    assert good
    assert {"P", "N", "T", "Ns", "V"} <= set(rows)
    assert all(row[3] in ("", "ok") for row in rows.values())


@pytest.mark.parametrize("name", ["N", "T", "Ns"])
def test_turned_directions_are_caught(tmp_path, channels, name):
    rows, good = compare(tmp_path, channels, lambda c: turn(c, name, 3.0))
    assert not good
    assert [n for n, row in rows.items() if row[3] == "MISSED"] == [name]


def test_one_percent_of_wrong_pixels_is_too_many(tmp_path, channels):
    assert not compare(tmp_path, channels, lambda c: turn(c, "T", 20.0, slice(0, None, 100)))[1]
    assert compare(tmp_path, channels, lambda c: turn(c, "T", 20.0, slice(0, None, 400)))[1]


def test_tilted_view_is_caught(tmp_path, channels):
    def tilt(c):
        c["V.X"] = c["V.X"] + np.sin(np.radians(0.2))

    rows, good = compare(tmp_path, channels, tilt)
    assert not good and rows["V"][3] == "MISSED"


def test_moved_points_are_caught(tmp_path, channels):
    def move(c):
        c["P.X"] = c["P.X"] + 1e-3

    rows, good = compare(tmp_path, channels, move)
    assert not good and rows["P"][3] == "MISSED"


def test_how_far_dumps_are_apart(tmp_path, channels):
    """Points in parts of the diagonal of what is seen, texture coordinates by the worse of both, a light by its worst channel and the larger of both."""
    def change(c):
        c["P.X"], c["uv.V"], c["light0.E.G"] = c["P.X"] + 0.02, c["uv.V"] - 0.25, 1.25 * c["light0.E.G"]
        c["uv.U"] = c["uv.U"] + 0.125
    changed = {name: plane.copy() for name, plane in channels.items()}
    change(changed)
    a, b = load(tmp_path / "a.exr", channels), load(tmp_path / "b.exr", changed)
    seen = channels["material.ID"] >= 0
    box = np.sqrt(sum(float(np.ptp(channels[f"P.{axis}"][seen])) ** 2 for axis in "XYZ"))
    off = dumps.deviations(a, b)
    assert dumps.size(a) == pytest.approx(box, rel=1e-6) and off["P"] == pytest.approx(0.02 / box, rel=1e-4)
    assert off["uv"] == pytest.approx(0.25) and off["light0.E"] == pytest.approx(0.2) and len(off["uv"]) == seen.sum()
    rows, columns = np.nonzero(seen)
    assert dumps.pixels_of(a, b, "P").tolist() == np.stack([rows, columns], 1).tolist()


@pytest.mark.parametrize("number, good", [(2.0**24, True), (2.0**24 + 2, False), (-(2.0**24) - 2, False), (0.5, False)])
def test_numbers_of_materials_are_whole(tmp_path, channels, number, good):
    channels["material.ID"][channels["material.ID"] >= 0] = number
    if good:
        assert load(tmp_path / "a.exr", channels).material.max() == number
    else:
        with pytest.raises(ValueError, match="a.exr: material.ID holds what is no index; expected whole numbers, -1 for a miss"):
            load(tmp_path / "a.exr", channels)


@pytest.mark.parametrize("a, b, off", [
    ({"x": 1.0}, {"x": 1.0, "y": 0}, np.inf), ({"x": [1, 2.0]}, {"x": [1, 2.5]}, 0.2), ({"x": [1]}, {"x": [1, 2]}, np.inf), ("a", "b", np.inf), ("a", "a", 0),
    (True, 1, 0), (True, 2, np.inf), ([], [], 0), ({}, {}, 0), (0, 0, 0), (-1.0, 1.0, 2), (None, None, 0), ({"x": {"y": 4.0}}, {"x": {"y": 5}}, 0.2)])
def test_how_far_values_are_apart(a, b, off):
    assert dumps.apart(a, b) == dumps.apart(b, a) == pytest.approx(off)


def test_a_light_elsewhere_is_caught(tmp_path, channels):
    rows, good = compare(tmp_path, channels, lambda c: turn(c, "light0.L", 1.0))
    assert not good and rows["light0.L"][3] == "MISSED"


@pytest.mark.parametrize("channel", "RGB")
@pytest.mark.parametrize("factor", [0.998, 1.002])
def test_one_channel_of_a_light_is_caught(tmp_path, channels, channel, factor):
    def change(c):
        c[f"light0.E.{channel}"] = factor * c[f"light0.E.{channel}"]

    rows, good = compare(tmp_path, channels, change)
    assert not good
    assert [n for n, row in rows.items() if row[3] == "MISSED"] == ["light0.E"]


def test_direction_to_a_light_does_not_count_in_shadow(tmp_path, channels):
    for name in "RGB":
        channels[f"light0.E.{name}"] = np.where(channels["P.X"] < 0, 0.0, channels[f"light0.E.{name}"])

    def forget(c):
        for name in "XYZ":
            c[f"light0.L.{name}"] = np.where(c["P.X"] < 0, 0.0, c[f"light0.L.{name}"])

    assert compare(tmp_path, channels, forget)[1]


@pytest.mark.parametrize("more", [False, True])
def test_coverage_of_one_only_is_caught(tmp_path, channels, more):
    """1 % of the pixels is covered in one dump and not in the other, either way round."""
    where = np.flatnonzero(channels["material.ID"].ravel() >= 0)[::100]
    less = {name: plane.copy() for name, plane in channels.items()}
    for name, plane in less.items():
        plane.ravel()[where] = -1.0 if name == "material.ID" else 0.0

    a, b = load(tmp_path / "a.exr", channels), load(tmp_path / "b.exr", less)
    if more:
        a, b = b, a
    assert dumps.coverage_difference(a, b) == pytest.approx(0.01, rel=0.02)
    rows, good = consistency.dump_rows(a, b)
    assert not good and [row[0] for row in rows if row[3] == "MISSED"] == ["covered by one only"]


def test_a_vector_of_no_length_is_as_wrong_as_can_be():
    a = np.array([[0.0, 0.0, 1.0]] * 3)
    b = np.array([[0.0, 0.0, 0.0], [np.nan, 0.0, 1.0], [0.0, 0.0, 2.0]])
    assert dumps.angles(a, b).tolist() == [180.0, 180.0, 0.0]


@pytest.mark.parametrize("degrees", [1e-4, 0.1, 45.0, 90.0, 179.9])
def test_angles(degrees):
    t = np.radians(degrees)
    measured = dumps.angles(np.array([1.0, 0.0, 0.0]), np.array([np.cos(t), np.sin(t), 0.0]))
    assert measured == pytest.approx(degrees, rel=1e-9)


def test_handedness_swaps_to_and_fro(tmp_path, channels):
    dump = load(tmp_path / "a.exr", channels)
    swapped = dumps.swap_handedness(dump)
    assert np.array_equal(swapped.P[..., 1], dump.P[..., 2])
    assert not np.array_equal(swapped.lights[0]["L"], dump.lights[0]["L"])
    again = dumps.swap_handedness(swapped)
    assert all(np.array_equal(getattr(again, n), getattr(dump, n)) for n in dumps.DIRECTIONS)


def test_lights_are_found_in_order(tmp_path, channels):
    for k in range(1, 12):
        for c in "RGB":
            channels[f"light{k}.E.{c}"] = channels["light0.E.R"] * (k + 1)
            channels[f"light{k}.S.{c}"] = channels["light0.S.R"]
        for c in "XYZ":
            channels[f"light{k}.L.{c}"] = channels[f"light0.L.{c}"]
    dump = load(tmp_path / "a.exr", channels)
    assert [light["E"].max() for light in dump.lights] == [3.0, *range(2, 13)]


def test_what_is_no_dump_is_said_with_its_name(tmp_path, channels):
    with pytest.raises(OSError, match="nowhere.exr"):
        dumps.read(tmp_path / "nowhere.exr")
    plain = synthetic.write(tmp_path / "plain.exr", channels, header=None)
    with pytest.raises(ValueError, match="plain.exr: not a dump"):
        dumps.read(plain)
    del channels["Ns.Y"]
    with pytest.raises(ValueError, match=r"a.exr: channel Ns\.Y is missing"):
        load(tmp_path / "a.exr", channels)


def test_dumps_that_do_not_match_are_refused(tmp_path, channels):
    a = load(tmp_path / "a.exr", channels)
    small = {name: plane[:32] for name, plane in channels.items()}
    with pytest.raises(ValueError, match="different size"):
        dumps.deviations(a, load(tmp_path / "b.exr", small))
    channels["material.ID"] = np.full_like(channels["material.ID"], -1.0)
    with pytest.raises(ValueError, match="no covered pixel"):
        dumps.deviations(a, load(tmp_path / "c.exr", channels))


def test_cloth_of_pov_ray_is_turned_back(tmp_path, channels):
    """POV-Ray records cloth with x the other way, metal as it is: in Blender's world both are where they were."""
    header = {"version": "0", "materials": [{"id": 0, "name": "m"}, {"id": 1, "name": "c", "fabric": {}}]}
    channels["material.ID"] = np.where(np.indices((64, 64))[1] < 32, 0.0, 1.0)
    written = {name: plane.copy() for name, plane in channels.items()}
    for name in [n[:-2] for n in channels if n.endswith(".X")]:
        x = channels[name + ".X"]
        written[name + ".X"] = np.where(channels["material.ID"] == 1, -x, x)
        written[name + ".Y"], written[name + ".Z"] = channels[name + ".Z"], channels[name + ".Y"]
    blender, povray = (dumps.read(synthetic.write(tmp_path / f"{k}.exr", planes, header))
                       for k, planes in enumerate((channels, written)))
    back = dumps.swap_handedness(povray)
    for name in ("P", *dumps.DIRECTIONS):
        assert np.array_equal(getattr(back, name), getattr(blender, name), equal_nan=True)


def test_t_is_along_the_grooves(tmp_path, channels):
    """Turned with the frame, or said as an angle from T about N, counterclockwise: the same."""
    said = {**channels, "groove.A": np.full((64, 64), np.radians(30.0))}
    angle, n, t = np.radians(30.0), *(np.stack([channels[f"{name}.{axis}"] for axis in "XYZ"], -1) for name in "NT")
    about = np.cos(angle) * t + np.sin(angle) * np.cross(n, t)
    turned = {**channels, **{f"T.{axis}": about[..., k] for k, axis in enumerate("XYZ")}}
    a, b, plain = (load(tmp_path / f"{k}.exr", made) for k, made in enumerate((said, turned, channels)))
    seen = plain.covered
    assert a.T[seen] == pytest.approx(b.T[seen], abs=1e-6) and np.abs(a.T - plain.T)[seen].max() > 0.3


def test_a_light_without_blue_reaches_what_it_reaches(tmp_path, channels):
    """Its direction is compared there."""
    number = next(int(name[5:].split(".")[0]) for name in channels if name.endswith("L.X"))
    channels[f"light{number}.E.B"] *= 0.0
    _, good = compare(tmp_path, channels, lambda c: None)
    assert good
    rows, good = compare(tmp_path, channels, lambda c: turn(c, f"light{number}.L", 2.0))
    assert not good and rows[f"light{number}.L"][3] == "MISSED"


@pytest.mark.parametrize("other, off", [(None, 0.6), ([0.0] * 5, 0.6), ([0.1, -0.2, 0.3, -0.05, 0.2], 0.0), ([0.1, -0.2, 0.3, 0.05, 0.2], 0.2),
                                        ([0.1, -0.2, 0.3, -0.05, 0.23], 0.03 / 0.53), ([0.1, 0.2, 0.3, -0.05, 0.2], 0.4 / 0.5**0.5)])
def test_slopes_of_bumps_are_compared_by_their_spread(tmp_path, channels, other, off):
    """What the other world's dump says of them is along the frame of a mirror; the rest of a material is compared without."""
    ours, theirs = load(tmp_path / "a.exr", channels), load(tmp_path / "b.exr", channels)
    ids = np.unique(ours.material)
    ours.header["materials"] = [{"id": int(k), "slopes": [0.1, 0.2, 0.3, 0.05, 0.2]} for k in ids]
    theirs.header["materials"] = [{"id": int(k), **({"slopes": other} if other else {})} for k in ids]
    found = dumps.deviations(ours, dumps.swap_handedness(theirs))
    assert found["slopes"] == pytest.approx(off) and (found["material"] == 0).all()
    rows, _ = consistency.dump_rows(ours, dumps.swap_handedness(theirs))
    assert [row[3] for row in rows if row[0] == "slopes equal within 0.1 of their spread"] == ["ok" if off < 0.1 else "MISSED"]
    assert not [row for row in consistency.dump_rows(*[load(tmp_path / "a.exr", channels)] * 2)[0] if row[0].startswith("slopes")]
