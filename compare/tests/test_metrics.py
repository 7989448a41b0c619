# SPDX-License-Identifier: Apache-2.0
"""Pictures, figures and tables."""
import os
import re
import time

import numpy as np
import pytest

import bench_frames
import consistency
import paths
import pictures
import report
import truth

COST = 0.55


def test_srgb_encoding_at_known_values():
    # IEC 61966-2-1: middle grey 0.2140 is 127.5; the straight part ends at 0.0031308.
    linear = np.array([0.0, 0.0031308, 0.21404114, 1.0, 7.0, -1.0])
    assert pictures.encode(linear).tolist() in ([0, 10, 127, 255, 255, 0], [0, 10, 128, 255, 255, 0])


def test_float_pictures_survive_a_file(tmp_path):
    rgb = np.random.default_rng(1).random((5, 7, 3))
    pictures.write_float(tmp_path / "a.exr", rgb)
    assert np.array_equal(pictures.read(tmp_path / "a.exr"), rgb.astype(np.float32))


def test_rows_stay_in_order(tmp_path):
    rgb = np.zeros((4, 4, 3))
    rgb[0, 3] = (1.0, 0.5, 0.25)
    pictures.write_png(tmp_path / "a.png", rgb)
    back = pictures.read(tmp_path / "a.png")
    assert back[0, 3, 0] == 1.0 and back[0, 3, 1] > back[0, 3, 2] > 0.0
    assert np.count_nonzero(back) == 3


def test_what_was_read_can_be_written(tmp_path):
    rgb = np.random.default_rng(4).random((5, 7, 3))
    pictures.write_float(tmp_path / "a.exr", rgb)
    pictures.write_png(tmp_path / "a.png", pictures.read(tmp_path / "a.exr"))
    assert pictures.read(tmp_path / "a.png").shape == (5, 7, 3)


def test_missing_picture_is_named(tmp_path):
    with pytest.raises(OSError, match="none.exr"):
        pictures.read(tmp_path / "none.exr")


def test_relative_difference():
    picture = np.full((2, 2, 3), 2.0)
    assert pictures.relative_difference(picture, picture) == 0.0
    assert pictures.relative_difference(1.1 * picture, picture) == pytest.approx(0.1)
    # Differences of either sign count.
    mixed = picture * np.array([0.9, 1.1, 1.0])
    assert pictures.relative_difference(mixed, picture) == pytest.approx(0.2 / 3.0)


def test_relative_difference_refuses_nonsense():
    black = np.zeros((2, 2, 3))
    with pytest.raises(ValueError, match="black"):
        pictures.relative_difference(black, black)
    with pytest.raises(ValueError, match="different size"):
        pictures.relative_difference(black, np.ones((2, 3, 3)))
    with pytest.raises(ValueError, match="not finite"):
        pictures.relative_difference(black * np.nan, np.ones((2, 2, 3)))


def test_pictures_that_differ_too_much_are_missed():
    picture = np.random.default_rng(2).random((8, 8, 3))
    assert consistency.picture_rows(picture, 1.01 * picture)[1]
    assert not consistency.picture_rows(picture, 1.03 * picture)[1]


@pytest.mark.parametrize("name, largest, mean, good", [
    ("Blender", 0.9e-4, 0.9e-5, True),
    ("Blender", 1.1e-4, 0.9e-5, False),
    ("Blender", 0.9e-4, 1.1e-5, False),
    ("POV-Ray", 0.9e-5, 0.9e-6, True),
    ("POV-Ray", 0.9e-5, 1.1e-6, False),
    ("POV-Ray", 1.1e-5, 0.9e-6, False),
    ("Blender", float("nan"), 0.0, False),
])
def test_limits_against_the_reference(name, largest, mean, good):
    said = {"pass": True, "values": 10, "largest": largest, "mean": mean, "faults": []}
    assert consistency.check_rows(name, said)[1] is good


def test_what_rounding_of_directions_may_do_is_taken_off():
    """Off the largest and off the mean, which are noted where they are over; what is left is judged."""
    said = {"pass": True, "values": 10, "largest": 3e-4, "beyond_rounding": 9e-5, "mean": 4e-5, "mean_beyond_rounding": 9e-6,
            "faults": []}
    rows, good = consistency.check_rows("Blender", said)
    assert good and [row[1:] for row in rows] == [["3.0e-04", "", "noted"], ["9.0e-05", "1e-04", "ok"],
                                                  ["4.0e-05", "", "noted"], ["9.0e-06", "1e-05", "ok"]]
    for worse in ({"beyond_rounding": 1.1e-4}, {"mean_beyond_rounding": 1.1e-5}):
        assert not consistency.check_rows("Blender", {**said, **worse})[1]


def test_faults_of_a_dump_are_shown_and_fail():
    said = {"pass": True, "values": 10, "largest": 0.0, "mean": 0.0, "faults": []}
    assert consistency.check_rows("Blender", said)[1]
    said["faults"] = [{"what": "S is not finite", "count": 3, "x": 1, "y": 2}]
    rows, good = consistency.check_rows("Blender", said)
    assert not good and rows[-1][0] == "Blender: S is not finite, first at (1, 2)"
    # what `shade check` alone has seen counts too
    assert not consistency.check_rows("Blender", {**said, "faults": [], "pass": False})[1]
    said = {"pass": True, "values": 0, "largest": 0.0, "mean": 0.0, "faults": []}
    assert not consistency.check_rows("Blender", said)[1], "nothing compared is no agreement"


@pytest.mark.parametrize("what", ["materials", "lights"])
def test_what_has_nothing_to_compare_is_shown(what):
    said = {"pass": True, "values": 10, "largest": 0.0, "mean": 0.0, "faults": [],
            "idle_materials": 0, "idle_lights": 0}
    assert consistency.check_rows("POV-Ray", said, every=True)[1]
    said[f"idle_{what}"] = 2
    rows, good = consistency.check_rows("POV-Ray", said, every=True)
    assert not good
    assert rows[-1] == [f"POV-Ray: {what} with nothing to compare", "2", "0", "MISSED"]
    rows, good = consistency.check_rows("POV-Ray", said)
    assert good and len(rows) == 2


def test_the_worst_channel_of_a_picture():
    picture = np.full((4, 4, 3), [2.0, 1.0, 0.5])
    for channel in range(3):
        tinted = picture.copy()
        tinted[:, ::2, channel] *= 1.1
        tinted[:, 1::2, channel] *= 0.9
        assert pictures.worst_channel(tinted, picture) == pytest.approx(0.1)
    # a black channel is not infinitely wrong at once, but light in it counts
    picture[..., 2] = 0.0
    assert pictures.worst_channel(picture, picture) == 0.0
    assert pictures.worst_channel(picture + [0, 0, 0.01], picture) == pytest.approx(0.1)
    with pytest.raises(ValueError, match="black"):
        pictures.worst_channel(picture, 0 * picture)


@pytest.mark.parametrize("status", [0, 1, 7])
def test_what_main_returns_is_the_exit_status(status):
    with pytest.raises(SystemExit) as left:
        report.run(lambda: status)
    assert left.value.code == status


def test_trouble_is_bad_input(capsys):
    def main():
        raise ValueError("no such thing")

    with pytest.raises(SystemExit) as left:
        report.run(main)
    assert left.value.code == 1 and "error: no such thing" in capsys.readouterr().err


def test_errors_of_the_methods_are_against_the_displaced_plate():
    displaced = np.full((2, 2, 3), 4.0)
    images = {"displaced": displaced, "rotate": 1.01 * displaced, "none": 0.0 * displaced}
    measured = truth.errors(images)
    assert measured == {"rotate": pytest.approx(0.01), "none": pytest.approx(1.0)}


def test_table_lines_up():
    lines = report.table(["what", "n"], [["a", "1"], ["longer", "1000"]]).splitlines()
    assert lines[0] == "what       n"
    assert lines[2] == "a          1"
    assert lines[3] == "longer  1000"


def test_a_failing_step_says_which_and_why(tmp_path):
    with pytest.raises(report.StepFailed, match="(?s)Doing it.*status 3.*the reason"):
        report.step("Doing it", ["sh", "-c", "echo the reason; exit 3"], tmp_path / "log")
    assert (tmp_path / "log").read_text() == "the reason\n"
    with pytest.raises(report.StepFailed) as failed:
        report.step("Doing it", ["sh", "-c", "for k in $(seq 30); do echo line $k; done; exit 1"], tmp_path / "log")
    assert str(failed.value).splitlines()[1:] == [f"line {k}" for k in range(16, 31)]
    with pytest.raises(report.StepFailed, match="no-such-program"):
        report.step("Doing it", ["no-such-program"], tmp_path / "log")
    assert report.step("Doing it", ["sh", "-c", "echo no; exit 1"], tmp_path / "log",
                       allowed=(0, 1)) == "no\n"


@pytest.mark.parametrize("value, power, rounded, number", [
    (0, "0", "0", "0"), (0.05, "0.05", "0.05", "0.0500"), (1e-3, "0.001", "0.001", "0.00100"), (12.345, "12.345", "10", "12.3"), (300, "300", "300", "300"),
    (99999.0, "99999", "10⁵", "99999"), (1e5, "10⁵", "10⁵", "1.0·10⁵"), (-2.5e-7, "-2·10⁻⁷", "-2·10⁻⁷", "-2.5·10⁻⁷"), (1e-6, "10⁻⁶", "10⁻⁶", "1.0·10⁻⁶"),
    (0.0123, "0.0123", "0.01", "0.0123"), (-4.0, "-4", "-4", "-4.00"), (1, "1", "1", "1.00")])
def test_numbers_as_they_are_said(value, power, rounded, number):
    assert (report.power(value), report.rounded(value), report.number(value)) == (power, rounded, number)


def test_a_log_has_all_that_a_program_says(tmp_path, capfd):
    """Both its streams, in the folder where it runs, bytes that are no text among it; where nobody looks a step is one line."""
    said = report.step("Saying", ["sh", "-c", "pwd; echo wrong >&2; printf '\\377\\n'"], tmp_path / "log", folder=tmp_path)
    assert said.splitlines() == [str(tmp_path), "wrong", "\ufffd"] and (tmp_path / "log").read_bytes().endswith(b"wrong\n\377\n")
    shown = capfd.readouterr()
    assert shown.out == "" and re.fullmatch(r"Saying … \d+\.\d s\n", shown.err)
    with pytest.raises(report.StepFailed, match=f"Saying: exit status 2; see {tmp_path}/log\nwhy"):
        report.step("Saying", ["sh", "-c", "echo why; exit 2"], tmp_path / "log")
    with pytest.raises(report.StepFailed, match="^Saying: no-such-program: No such file or directory$"):
        report.step("Saying", ["no-such-program"], tmp_path / "log")
    assert capfd.readouterr().err == "Saying … failed\n" * 2


def test_ctrl_c_is_said(capsys):
    def main():
        raise KeyboardInterrupt
    with pytest.raises(SystemExit) as left:
        report.run(main)
    assert left.value.code == 130 and capsys.readouterr() == ("", "\ninterrupted\n")


def test_progress_shows_a_program_s_percentage(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    report.step("Drawing", ["sh", "-c", "echo Rendered 3 of 12 pixels '(25%)'"], tmp_path / "log")
    shown = capsys.readouterr().err
    assert "\rDrawing … 25 %" in shown and shown.endswith("s   \n")
    progress = report.Progress("Drawing")
    assert capsys.readouterr().err == "\rDrawing …         "  # from the start
    progress.read("Rendered 3 (25 %)\rRendered 6 (50 %)")  # as two reach it at once
    progress.read("and goes on")
    assert progress.seen == "50 %"


def test_an_interrupted_step_leaves_no_program(tmp_path, monkeypatch):
    """Ctrl-C in whatever state the program is, also one that would not end by it."""
    def stop(*_):
        raise KeyboardInterrupt
    monkeypatch.setattr(report.Progress, "read", stop)
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        report.step("Waiting", ["sh", "-c", "trap '' INT; echo $$; exec sleep 30"], tmp_path / "log")
    assert time.monotonic() - begun < 20
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "log").read_text()), 0)


def test_a_dump_is_that_of_the_step_that_wants_one(tmp_path, monkeypatch):
    for name in ("LIBSHADE_DUMP", "LIBSHADE_TIMINGS", "POVINI", "OTHER"):
        monkeypatch.setenv(name, "of the user")
    say = ["sh", "-c", "echo $LIBSHADE_DUMP, $OTHER"]
    assert report.step("Saying", say, tmp_path / "log") == ", of the user\n"
    assert report.step("Saying", say, tmp_path / "log", {"LIBSHADE_DUMP": "of the step"}) == "of the step, of the user\n"
    inherited = bench_frames.environment()
    assert inherited["OTHER"] == "of the user" and not {"LIBSHADE_DUMP", "LIBSHADE_TIMINGS", "POVINI"} & set(inherited)


@pytest.mark.parametrize("module, given, good, bad", [
    (consistency, ["x.blend"], {"percent": (1, 100), "samples": (1, 4096), "grid": (1, 9)},
     {"percent": (0, 101), "samples": (0,), "grid": (0, 10)}),
    (paths, [], {"size": (4, 64)}, {"size": (3,), "samples": (0, 10**9)}),
    (bench_frames, ["HEAD"], {"limit": (1e-3, 1.03)}, {"limit": (0, -1)}),
])
def test_ranges_of_options(module, given, good, bad, capsys):
    for name, values in good.items():
        for value in values:
            assert getattr(module.arguments([*given, f"--{name}", str(value)]), name) == value
    for name, values in bad.items():
        for value in values:
            with pytest.raises(SystemExit) as left:
                module.arguments([*given, f"--{name}={value}"])
            assert left.value.code == 2 and f"--{name}" in capsys.readouterr().err
