# SPDX-License-Identifier: GPL-3.0-or-later
"""Every type of light that the module knows: what reaches a surface, and who reads it from Blender.

A type that has no entry here, or that export/light.py does not know, fails.
"""

import ast

import numpy as np
import pytest

from native_scenes import ROOT, dump, native, point, scene, sun, unit, vectors

TYPES = native.table()["lights"]

# By type: a light, and its irradiance and direction at P, from its definition.
LIGHTS = {
    "SUN": (
        sun((0.3, 0.1, 0.9), (2, 1, 0.5)),
        lambda p: (np.broadcast_to((2, 1, 0.5), p.shape), np.broadcast_to((0.3, 0.1, 0.9), p.shape)),
    ),
    "POINT": (
        point((0.4, -0.3, 1.5), (3, 2, 1)),
        lambda p: (
            (3, 2, 1) / ((np.array((0.4, -0.3, 1.5)) - p) ** 2).sum(-1)[..., None],
            np.array((0.4, -0.3, 1.5)) - p,
        ),
    ),
}


@pytest.mark.parametrize("kind", TYPES)
def test_what_reaches_a_plate(kind, tmp_path):
    assert kind in LIGHTS, f"{kind} is not tested: give it an entry in LIGHTS"
    light, truth = LIGHTS[kind]
    planes, _ = dump(scene(lights=[light]), tmp_path / "d.exr")
    irradiance, direction = truth(vectors(planes, "P"))
    np.testing.assert_allclose(vectors(planes, "light0.E", "RGB"), irradiance, rtol=1e-5)
    np.testing.assert_allclose(vectors(planes, "light0.L"), unit(direction), atol=1e-6)


def test_blender_hands_over_what_the_module_knows():
    tree = ast.parse((ROOT / "blender_addon_c/export/light.py").read_text())
    (table,) = (
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "_LIGHTS"
    )
    assert sorted(key.value for key in table.keys) == sorted(TYPES)
