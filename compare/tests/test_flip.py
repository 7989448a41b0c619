# SPDX-License-Identifier: Apache-2.0
"""flip.py against what its authors' own program says (flip-evaluator 1.7 of PyPI, pictures for screens)."""
import numpy as np
import pytest

import flip

COST = 0.5


def pairs():
    random = np.random.default_rng(1)
    a = random.random((40, 56, 3)).astype(np.float32) ** 2
    noise = np.clip(a + 0.1 * random.standard_normal(a.shape), 0, 1).astype(np.float32)
    patch = a.copy()
    patch[10:14, 20:40] = [1, 0.2, 0.1]
    edge, moved = np.zeros((2, 40, 56, 3), np.float32)
    edge[:, :28] = moved[:, :30] = [0.2, 0.5, 0.9]
    return {"noise": (a, noise), "patch": (a, patch), "edge": (edge, moved)}


@pytest.mark.parametrize("name, mean, most, at", [
    ("noise", 0.1596546769142151, 0.4325205, 0.1651218),
    ("patch", 0.051194991916418076, 0.8605416, 0.8331444),
    ("edge", 0.10839243978261948, 0.9165057, 0.88678855),
])
def test_as_its_authors_have_it(name, mean, most, at):
    """They compute in float32 and with kernels cut off elsewhere: .3 % of the mean."""
    found = flip.flip(*(image.astype(float) for image in pairs()[name]))
    assert found.mean() == pytest.approx(mean, rel=4e-3)
    assert found.max() == pytest.approx(most, rel=2e-3)
    assert found[12, 30] == pytest.approx(at, rel=2e-3)


def test_ends_of_the_scale():
    a = pairs()["noise"][0].astype(float)
    assert flip.mean(a, a) == 0
    white, black = np.ones((32, 32, 3)), np.zeros((32, 32, 3))
    assert 0.9 < flip.mean(white, black) <= 1
    assert flip.mean(white, 5 * white) == 0  # a screen shows no more than white
    green, blue = (np.broadcast_to(c, (32, 32, 3)) for c in ([0.0, 1, 0], [0.0, 0, 1]))
    assert flip.mean(green, blue) == pytest.approx(1, abs=1e-6)


def test_it_is_the_same_either_way_round():
    a, b = (image.astype(float) for image in pairs()["patch"])
    assert np.allclose(flip.flip(a, b), flip.flip(b, a), atol=1e-12)


@pytest.mark.parametrize("a, b", [
    (np.zeros((4, 4, 3)), np.zeros((4, 5, 3))), (np.zeros((4, 4)), np.zeros((4, 4))),
    (np.full((4, 4, 3), np.nan), np.zeros((4, 4, 3))),
])
def test_what_is_no_pair_is_refused(a, b):
    with pytest.raises(ValueError, match="expected|finite"):
        flip.flip(a, b)
