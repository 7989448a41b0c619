# SPDX-License-Identifier: GPL-3.0-or-later
"""What the export makes of a lobe that bumps widen. Without Blender."""

import importlib
import sys
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import pytest

from native_scenes import ROOT

sys.path.insert(0, str(ROOT / "libshade/python"))
import shade  # noqa: E402

ADD_ON = ROOT / "blender_addon_c"
NUMBERS = {"ADD": lambda a, b: a + b, "MULTIPLY": lambda a, b: a * b, "DIVIDE": lambda a, b: a / b,
           "MULTIPLY_ADD": lambda a, b, c: a * b + c, "SQRT": lambda a: a**0.5}


@pytest.fixture()
def closure(monkeypatch):
    """export/closure.py in an add-on whose other parts do nothing."""
    for name, folder in (("hollow", ADD_ON), ("hollow.export", ADD_ON / "export")):
        package = ModuleType(name)
        package.__path__ = [str(folder)]
        monkeypatch.setitem(sys.modules, name, package)
    monkeypatch.setitem(sys.modules, "bpy", MagicMock(app=SimpleNamespace(version=(3, 4, 1))))
    for name in ("fabric", "metal_tree", "nodes", "export.cloth", "export.tree", "export.node_place", "export.value"):
        package, _, last = f"hollow.{name}".rpartition(".")
        monkeypatch.setitem(sys.modules, f"hollow.{name}", MagicMock())
        monkeypatch.setattr(sys.modules[package], last, sys.modules[f"hollow.{name}"], raising=False)
    yield importlib.import_module("hollow.export.closure")
    for name in [name for name in sys.modules if name.startswith("hollow.")]:
        sys.modules.pop(name)


@pytest.mark.parametrize("brdf", ["microfacet", "ashikhmin_shirley"])
@pytest.mark.parametrize("mdf", ["beckmann", "ward", "ward_half"])
@pytest.mark.parametrize("alphas", [(0.05, 0.2), (0.3, 0.3), (0.7, 0.4)])
def test_bumps_widen_a_lobe_as_the_library_does(closure, mdf, brdf, alphas):
    reader = SimpleNamespace(program=SimpleNamespace(math=lambda operation, *numbers: NUMBERS[operation](*numbers)))
    variances = (0.03, 0.01)
    lobe = shade.split(shade.Material(mdf=mdf, brdf=brdf, ax=alphas[0], ay=alphas[1]), None, [variances[0], 0, variances[1]], 1)
    given = {"mdf": mdf.upper(), "brdf": brdf.upper(), "ax": alphas[0], "ay": alphas[1]}
    for axis, alpha, variance, wide in zip("xy", alphas, variances, (lobe.x, lobe.y)):
        square, widened = closure._widened(reader, given, axis, 2 * variance)
        assert square == pytest.approx(alpha**2) and widened == pytest.approx(float(wide) ** 2)
        assert given[f"a{axis}_from"] == [pytest.approx(float(wide))]
