# SPDX-License-Identifier: GPL-3.0-or-later
"""What the export makes of a lobe that bumps widen. Without Blender."""

import importlib.util
import sys
from types import SimpleNamespace

import pytest

from native_scenes import ROOT

sys.path.insert(0, str(ROOT / "libshade/python"))
import shade  # noqa: E402

_SPEC = importlib.util.spec_from_file_location("closure_widened", ROOT / "blender_addon_c/export/closure_widened.py")
closure_widened = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(closure_widened)
NUMBERS = {"ADD": lambda a, b: a + b, "MULTIPLY": lambda a, b: a * b, "DIVIDE": lambda a, b: a / b,
           "MULTIPLY_ADD": lambda a, b, c: a * b + c, "SQRT": lambda a: a**0.5}


@pytest.mark.parametrize("brdf", ["microfacet", "ashikhmin_shirley"])
@pytest.mark.parametrize("mdf", ["beckmann", "ward", "ward_half"])
@pytest.mark.parametrize("alphas", [(0.05, 0.2), (0.3, 0.3), (0.7, 0.4)])
def test_bumps_widen_a_lobe_as_the_library_does(mdf, brdf, alphas):
    reader = SimpleNamespace(program=SimpleNamespace(math=lambda operation, *numbers: NUMBERS[operation](*numbers)))
    variances = (0.03, 0.01)
    lobe = shade.split(shade.Material(mdf=mdf, brdf=brdf, ax=alphas[0], ay=alphas[1]), None, [variances[0], 0, variances[1]], 1)
    given = {"mdf": mdf.upper(), "brdf": brdf.upper(), "ax": alphas[0], "ay": alphas[1]}
    for axis, alpha, variance, wide in zip("xy", alphas, variances, (lobe.x, lobe.y)):
        square, widened = closure_widened.widened(reader, given, axis, 2 * variance)
        assert square == pytest.approx(alpha**2) and widened == pytest.approx(float(wide) ** 2)
        assert given[f"a{axis}_from"] == [pytest.approx(float(wide))]
