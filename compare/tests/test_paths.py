# SPDX-License-Identifier: Apache-2.0
"""Time to equal error: the error's formula, what a noisy reference takes off, the verdict."""
import json

import numpy as np
import pytest

import paths
import pictures
import whole

COST = 0.65


def test_relative_mse_of_a_known_error():
    reference = np.full((40, 40, 3), 0.5)
    off = reference.copy()
    off[:20] += 0.1  # half of it, by .1: .5 · .01 / (.25 + .0025)
    assert paths.relative_mse(off, reference) == pytest.approx(0.5 * 0.01 / 0.2525)
    assert paths.relative_mse(reference, reference) == 0
    fireflies = reference.copy()
    fireflies[0, 0, 0] = 1e6  # fewer than one in a thousand
    assert paths.relative_mse(fireflies, reference) < 1e-12


@pytest.mark.parametrize("samples, many", [(16, 64), (64, 1024)])
def test_the_reference_has_noise_too(samples, many):
    rng = np.random.default_rng(3)
    truth = np.full((200, 200, 3), 0.7)
    noisy, reference = (truth + rng.normal(0, 0.3 / np.sqrt(n), truth.shape) for n in (samples, many))
    alone = paths.relative_mse(noisy, truth)
    both = paths.relative_mse(noisy, reference)
    assert both > 1.02 * alone
    assert paths.own_error(both, samples, many) == pytest.approx(alone, rel=0.02)


def test_the_sky_has_what_a_studio_has():
    sky = paths.studio(64)
    assert sky.shape == (64, 128, 3) and sky.min() > 0
    assert 5 < sky.max() / sky.mean() < 1000 and (sky.reshape(-1, 3).max(axis=1) > 4).mean() < 0.1


def judge(monkeypatch, folder, change):
    """Exit status where our picture of the room is changed by `change`."""
    rng = np.random.default_rng(8)

    def step(_words, command, _log, _environment):
        order = json.loads((folder / "jobs.json").read_text())
        for job in order["jobs"]:
            picture = 0.5 + rng.normal(0, 0.5 / np.sqrt(job["samples"]), (32, 32, 3))
            ours = job["engine"] == "LIBSHADE" and job["scene"] == "room"
            pictures.write_float(job["output"], change(picture) if ours else picture)
        whole.write_text(order["result"], json.dumps(
            {"blender": "none", "seconds": [0.5] * len(order["jobs"])}))
        assert command[-1].endswith("jobs.json")

    monkeypatch.setattr(paths.report, "step", step)
    return paths.main(["--size", "32", "--samples", "64", "--reference", "65536",
                       "--output", str(folder)])


def test_equal_pictures_are_good(monkeypatch, tmp_path, capsys):
    assert judge(monkeypatch, tmp_path, lambda picture: picture) == 0
    table = capsys.readouterr().out
    assert all(row in table for row in ("studio, Cycles", "room, libshade", "room, libshade beside"))


def dimmer(picture):
    return 0.95 * picture


def stained(picture):
    picture[:12, :12, 1] *= 1.5
    return picture


@pytest.mark.parametrize("change", [dimmer, stained])
def test_one_bad_picture_is_not(monkeypatch, tmp_path, capsys, change):
    assert judge(monkeypatch, tmp_path, change) == 1
    assert "differ by more than 0.02" in capsys.readouterr().out


@pytest.mark.parametrize("words", [["--samples", "0"], ["--samples", "64", "--reference", "64"],
                                   ["--size", "2"], ["--scene", "garden"]])
def test_bad_arguments(words):
    with pytest.raises(SystemExit) as ended:
        paths.arguments(words)
    assert ended.value.code == 2


def test_blocks_are_means_of_squares():
    """Of 4 x 4 pixels; what does not fill one at the right and at the bottom is left out."""
    picture = np.arange(9 * 14 * 3.0).reshape(9, 14, 3)
    found = paths.blocks(picture)
    assert found.shape == (2, 3, 3)
    for y in range(2):
        for x in range(3):
            assert found[y, x] == pytest.approx(picture[4 * y:4 * y + 4, 4 * x:4 * x + 4].mean((0, 1)))
