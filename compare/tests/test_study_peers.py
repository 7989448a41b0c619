# SPDX-License-Identifier: Apache-2.0
"""study_peers.py without the other renderers: its measures of made-up pictures, its findings on altered rows."""
import numpy as np
import pytest

import plate
import study_peers as study

COST = 0.1


def made(error, noise, seed=1):
    """Pictures of a renderer whose normal map is off by `error` and whose noise has this relative size."""
    random = np.random.default_rng(seed)
    truth = random.random((64, 64, 3)) + 0.5
    sign = np.where(np.indices((64, 64)).sum(0) % 2, 1, -1)[..., None]
    many = truth + error * truth.mean() * sign
    return {"truth": truth, "many": many, "timed": many * (1 + noise * random.standard_normal(truth.shape))}


@pytest.fixture
def rows():
    sizes, found = {**study.SIZES, "size": 64}, []
    for light in ("sun", "sky"):
        for engine, error, seconds in (("libshade", 0.004, 0.5), ("cycles", 0.08, 5.0), ("cycles_5", 0.079, 6.0),
                                       ("mitsuba", 0.1, 0.4)):
            found.append(study.measured(engine, light, made(error, 0.05), {"timed": [2 * seconds, seconds, seconds]}, "1",
                                        sizes))
    return found


def test_what_is_measured(rows):
    sun = study.of(rows, "sun")
    assert sun["cycles"]["error"] == pytest.approx(0.08, rel=1e-6)
    assert sun["cycles"]["seconds"] == 5.0 and sun["cycles"]["seconds_high"] == 10.0
    assert sun["cycles"]["samples_per_second"] == pytest.approx(64 * 64 * 64 / 5.0)
    assert sun["cycles"]["relmse"] == pytest.approx(0.05**2 / (1 + 64 / 1024), rel=0.05)
    assert sun["mitsuba"]["seconds_to_error"] == pytest.approx(0.4 * sun["mitsuba"]["relmse"] / 1e-3)


def test_under_a_sky_single_pixels_are_no_error(rows):
    """The sign of the made error turns from pixel to pixel: means of blocks do not see it."""
    assert study.of(rows, "sky")["cycles"]["error"] < 1e-9


def test_findings_hold(rows):
    assert all(finding.holds for finding in study.findings(rows))
    assert study.findings([]) == [] and study.tables([]) == [] and study.figures([]) == []
    assert len(study.tables(rows)[0].rows) == 8


@pytest.mark.parametrize("number, engine, column, value", [
    (0, "libshade", "error", 0.05), (0, "mitsuba", "error", 0.001), (1, "cycles_5", "mean", 1.3),
    (2, "libshade", "samples_per_second", 1.0), (2, "cycles_5", "samples_per_second", 1e9),
])
def test_altered_rows_are_noticed(rows, number, engine, column, value):
    changed = [{**row, column: value} if row["engine"] == engine else row for row in rows]
    assert [k for k, finding in enumerate(study.findings(changed)) if not finding.holds] == [number]


def test_a_renderer_that_is_missing_is_noticed(rows):
    assert not study.findings([row for row in rows if row["engine"] != "mitsuba"])[0].holds


def test_only_its_own_target_runs_it():
    assert study.tasks(True) == []
    assert len(study.tasks(False)) in (0, 8)


def test_both_conventions_are_the_same_alphas():
    """What Blender's node makes of roughness and anisotropy is what Mitsuba is given."""
    square = study.ROUGHNESS**2
    assert (square * (1 - study.ANISOTROPY), square / (1 - study.ANISOTROPY)) == pytest.approx(study.ALPHAS)
    assert plate.SLOPE == 0.6  # as the study's words have it
