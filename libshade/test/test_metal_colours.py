# SPDX-License-Identifier: Apache-2.0
"""Measured metals have the colours of their published spectra, at every angle."""
import pathlib
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "libshade" / "python"), str(ROOT / "libshade" / "test")]
import metal_spectra  # noqa: E402
import shade  # noqa: E402

COST = 0.11


def test_white_is_white_and_the_observer_sees_daylight():
    """D65 is at x .3127, y .3290, whose colour is (1, 1, 1)."""
    white = np.array([metal_spectra.X_BAR, metal_spectra.Y_BAR, metal_spectra.Z_BAR]) @ metal_spectra.D65
    assert white[:2] / white.sum() == pytest.approx([.3127, .3290], abs=3e-4)
    assert metal_spectra.XYZ_TO_RGB @ white / white[1] == pytest.approx(1, abs=2e-3)


def test_every_metal_is_compared():
    assert set(metal_spectra.TABLES) == set(shade.metals())


@pytest.mark.parametrize("name", metal_spectra.TABLES)
def test_colours(name):
    """Within .001 head-on, .01 up to 87 degrees (three wavelengths alone: gold .10 off, brass .023)."""
    metal = shade.metals()[name]
    cosine = np.cos(np.radians(metal_spectra.ANGLES))
    ours = np.array([metal_spectra.fresnel(n, k, cosine) for n, k in zip(metal.eta, metal.k)])
    wanted = np.clip(metal_spectra.reflectance(name), 0, 1)
    print(name, "head-on", wanted[:, 0].round(3), "greatest error", abs(ours - wanted).max().round(4))
    assert ours[:, 0] == pytest.approx(wanted[:, 0], abs=1e-3)
    assert abs(ours - wanted).max() < .01
