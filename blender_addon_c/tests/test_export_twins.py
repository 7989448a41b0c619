# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects and faces in one place are named, others are not."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

COST = 0.2

FILE = Path(__file__).resolve().parents[1] / "export/twins.py"
SPEC = importlib.util.spec_from_file_location("twins", FILE)
twins = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(twins)

HERE, ASIDE = ([1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0] for x in (0, 9))
GRID = np.stack([*np.mgrid[:6, :6], np.zeros((6, 6))], -1).reshape(-1, 3).astype(np.float32)
SQUARES = np.array([i + 6 * j for j in range(5) for i in range(5)])


def mesh(name, offsets=((0, 1, 7), (0, 7, 6)), positions=GRID):
    corners = np.concatenate([SQUARES + k for triangle in offsets for k in triangle]).reshape(2, 3, -1).transpose(0, 2, 1)
    return {"name": name, "positions": positions.ravel(), "corner_position": corners.astype(np.int32).ravel()}


TWICE = np.tile(mesh("b")["corner_position"], 2)
ONE, SOME = (mesh("b") | {"corner_position": np.append(TWICE[:len(TWICE) // 2], TWICE[:3 * count])} for count in (1, 2))  # a 25th of its faces, a 13th


@pytest.mark.parametrize("meshes, places, said", [
    ([mesh("a")], [HERE], None), ([mesh("a")], [HERE, HERE], "a: "), ([mesh("a")], [HERE, ASIDE], None),
    ([mesh("a"), mesh("b", ((0, 7, 6), (1, 7, 0)))], [HERE, HERE], "(and 1 more)"),
    ([mesh("a"), mesh("b", ((0, 1, 6), (1, 7, 6)))], [HERE, HERE], "(and 1 more): they fill one box"),  # other diagonals
    ([mesh("b") | {"corner_position": TWICE}], [HERE], "b: "), ([ONE], [HERE], None), ([SOME], [HERE], "b: "),
    ([mesh("a", positions=GRID * np.float32("nan"))], [HERE, HERE], None), ([mesh("a")], [], None),
    ([mesh("a", positions=0 * GRID)], [HERE, HERE], None)])
def test_twins(meshes, places, said):
    found = []
    log = type("Log", (), {"warning": lambda _self, text: found.append(text)})()
    twins.name_twins(meshes, [{"mesh": min(k, len(meshes) - 1), "matrix": m} for k, m in enumerate(places)], log)
    assert len(found) == (said is not None)
    assert said is None or said in found[0]


def bowl(name, size, smooth=True):
    x, y = GRID[:, 0] / 5 - 0.5, GRID[:, 1] / 5 - 0.5
    made = mesh(name, positions=size * np.stack([x, y, x * x + y * y], -1).astype(np.float32))
    normals = np.stack([-2 * x, -2 * y, np.ones_like(x)], -1)[made["corner_position"]]
    return made | {"corner_normals": np.float32(normals if smooth else 0 * normals + (0, 0, 1))}


@pytest.mark.parametrize("others, lifted, said", [
    ([bowl("b", 1.005)], True, True), ([bowl("b", 1.005)], False, False), ([bowl("b", 1.1)], True, False), ([], True, False),
    ([bowl("b", 1.005, False)], True, False)])
def test_shells_that_light_goes_through(others, lifted, said):
    found = []
    log = type("Log", (), {"warning": lambda _self, text: found.append(text)})()
    meshes = [bowl("a", 1), *others]
    twins.name_twins(meshes, [{"mesh": k, "matrix": HERE} for k in range(len(meshes))], log, lifted)
    assert len(found) == said and (not said or "(and 1 more): they fill nearly one box" in found[0])


GLASS, MATT = {"closure": "GLASS", "refracts": True}, {"closure": "DIFFUSE"}


def slab(name, material, low, size):
    """The lower and the upper face of a box."""
    made = mesh(name, positions=np.concatenate([GRID * size, GRID * size + (0, 0, 1)]) + (0, 0, low))
    corners = made["corner_position"]
    return made | {"corner_position": np.concatenate([corners, corners + len(GRID)]), "material": np.full(100, material)}


@pytest.mark.parametrize("low, other, place, said", [(0, 1, HERE, True), (0.01, 1, HERE, False), (0, 1, ASIDE, False), (-1, 1, HERE, False),
                                                     (0, 0, HERE, True), (np.nan, 1, HERE, False)])
def test_glass_that_stands_on_something(low, other, place, said):
    found = []
    log = type("Log", (), {"warning": lambda _self, text: found.append(text)})()
    floor = mesh("floor") | {"material": np.full(50, other)}
    twins.name_standing([slab("glass", 0, low, 0.3), floor], [{"mesh": 0, "matrix": place}, {"mesh": 1, "matrix": HERE}],
                        [{"closures": [MATT, GLASS]}, MATT], log)
    assert len(found) == said and (not said or found[0].startswith(("glass:", "floor:")))
    twins.name_standing([slab("matt", 0, low, 0.3), floor], [{"mesh": 0, "matrix": place}, {"mesh": 1, "matrix": HERE}], [MATT, MATT], log)
    assert len(found) == said
