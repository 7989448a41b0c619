# SPDX-License-Identifier: GPL-3.0-or-later
"""Every kind of node that the module knows: what it says of a plate, and who asks for it in Blender.

A kind that has no entry here, or that export/node.py never asks for, fails.
"""

import ast

import numpy as np
import pytest

from native_scenes import ROOT, dump, image, material, native, scene, unit, vectors

KINDS = native.table()["nodes"]
COLORS = np.random.default_rng(3).random((5, 7, 3), np.float32)
TILT = unit(np.array((0.3, -0.2, 0.9)))
IMAGES = [
    image(COLORS, filter="CLOSEST"),
    image(np.full((2, 2, 3), 0.5 + 0.5 * TILT, np.float32)),
]


def nearest(u, v):
    rows, columns = COLORS.shape[:2]
    return COLORS[(v * rows).astype(int), (u * columns).astype(int)]


def tilted(u, v):
    return np.broadcast_to(TILT, (*u.shape, 3))


# By kind: a node, the dump's channels that show its output, and their values at (u, v).
NODES = {
    "IMAGE": ({"image": 0}, ("Color", "RGB"), nearest),
    "NORMAL_MAP": ({"image": 1, "strength": 1.0}, ("Ns", "XYZ"), tilted),
}


@pytest.mark.parametrize("kind", KINDS)
def test_what_it_says_of_a_plate(kind, tmp_path):
    assert kind in NODES, f"{kind} is not tested: give it an entry in NODES"
    node, channels, truth = NODES[kind]
    given = material() | {"nodes": [{"type": kind, **node}]}
    planes, _ = dump(scene(images=IMAGES, materials=[given]), tmp_path / "d.exr")
    said = truth(planes["uv.U"].astype(float), planes["uv.V"].astype(float))
    np.testing.assert_allclose(vectors(planes, *channels), said, atol=4e-5)  # 16 bits a texel


def test_blender_asks_for_what_the_module_knows():
    tree = ast.parse((ROOT / "blender_addon_c/export/node.py").read_text())
    asked = {
        value.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Dict)
        for key, value in zip(node.keys, node.values)
        if isinstance(key, ast.Constant) and key.value == "type"
    }
    assert asked == set(KINDS)
