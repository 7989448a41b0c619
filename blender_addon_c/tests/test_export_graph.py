# SPDX-License-Identifier: GPL-3.0-or-later
"""Which images a graph averages: those that light is proportional to. Without Blender."""

import importlib.util
import math
from array import array

import pytest

from native_scenes import ROOT

COST = 0.42

_SPEC = importlib.util.spec_from_file_location("graph", ROOT / "blender_addon_c/export/graph.py")
graph = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(graph)


def is_averaged(use):
    """use: (program, the image's colour) -> what a closure has."""
    program = graph.Program()
    color = program.emit("IMAGE", 3, image=0, averaged=True, near=[0.0] * 4, step=0.1)
    nodes, _ = program.finish([{"closure": "DIFFUSE", **use(program, color)}])
    image = next(node for node in nodes if node["type"] == "IMAGE")
    assert ("near" in image) == ("averaged" in image)
    return "averaged" in image


LINEAR = {
    "color": lambda p, c: {"color": c},
    "weight": lambda p, c: {"weight": c},
    "scaled": lambda p, c: {"color": [p.math("DIVIDE", p.math("MULTIPLY_ADD", c[0], 2.0, 0.1), 3.0)] * 3},
    "mixed": lambda p, c: {"color": [p.emit("MIX", 1, mode="MIX", factor=[c[0]], a=[0.2], b=[0.9])[0]] * 3},
    "product of two": lambda p, c: {"color": [p.math("MULTIPLY", c[0], c[1])] * 3},
    "seen in passes alone": lambda p, c: {"color": c, "pass_color": [p.math("POWER", c[0], 2.0)] * 3},
    "left out": lambda p, c: (p.math("POWER", c[0], 2.0), {"color": c})[1],
}
BENT = {
    "roughness": lambda p, c: {"roughness": c[:1]},
    "normal": lambda p, c: {"normal": c},
    "ramp": lambda p, c: {"color": p.emit("RAMP", 3, factor=c[:1])},
    "power": lambda p, c: {"color": [p.math("POWER", c[0], 2.0)] * 3},
    "square": lambda p, c: {"color": [p.math("MULTIPLY", c[0], c[0])] * 3},
    "under a line": lambda p, c: {"color": [p.math("DIVIDE", 1.0, c[0])] * 3},
    "further on": lambda p, c: {"color": [p.math("SQRT", p.math("ADD", c[0], 1.0))] * 3},
    "both": lambda p, c: {"color": c, "roughness": c[:1]},
    "overlay": lambda p, c: {"color": [p.emit("MIX", 1, mode="OVERLAY", factor=[1.0], a=[c[0]], b=[0.9])[0]] * 3},
    "where to look": lambda p, c: {"color": p.emit("IMAGE", 3, image=1, at=c[:2])},
}


@pytest.mark.parametrize("name", LINEAR)
def test_averaged(name):
    assert is_averaged(LINEAR[name])


@pytest.mark.parametrize("name", BENT)
def test_not_averaged(name):
    assert not is_averaged(BENT[name])


def test_a_full_graph_looks_at_points():
    """What averages need would be too many registers at once."""
    program = graph.Program()
    places = [program.emit("OBJECT", 3, what="LOCATION") for _ in range(83)]  # 249 registers of 253
    color = program.emit("IMAGE", 3, image=0, at=places[0][:2], averaged=True, step=0.1,
                         near=program.emit("OBJECT", 3, what="COLOR") + program.emit("OBJECT", 1, what="NUMBERS"))
    sum_ = 0.0
    for part in (part for place in places for part in place):
        sum_ = program.math("ADD", sum_, part)
    nodes, _ = program.finish([{"closure": "DIFFUSE", "color": color, "weight": [sum_] * 3}])
    assert not any("averaged" in node for node in nodes)


def test_what_numbers_are_at_most():
    """By intervals; what is not known is infinite."""
    program = graph.Program()
    u, v = program.emit("IMAGE", 2, image=0, at=[0.0, 0.0])
    at = program.emit("OBJECT", 3, what="LOCATION")[0]
    ramp = program.emit("RAMP", 4, table=array("f", [0.2, 0.1, 3.0, 1.0]), at=[u])[0]
    ranges = [(0.3, (0.3, 0.3)), (u, (0, 1)), (at, (-math.inf, math.inf)), (ramp, (0.1, 3))]
    for part, expected in [*ranges, (program.math("MULTIPLY", u, 2.0), (0, 2)), (program.math("MULTIPLY", u, -2.0), (-2, 0)),
                           (program.math("SUBTRACT", u, v), (-1, 1)), (program.math("MULTIPLY_ADD", u, v, 0.5), (0.5, 1.5)),
                           (program.math("CLAMP", at, 0.0, 1.0), (0, 1)), (program.math("MINIMUM", at, 1.0), (-math.inf, 1)),
                           (program.math("MIX", u, 4.0, v), (0, 4)), (program.math("POWER", u, 2.0), (-math.inf, math.inf)),
                           (program.emit("MIX", 1, mode="SCREEN", factor=[v], a=[u], b=[0.3])[0], (-1, 1)),
                           (program.emit("MIX", 1, mode="SCREEN", factor=[v], a=[u], b=[1.3])[0], (-math.inf, math.inf))]:
        assert program.range_of(part, lambda _image: (0.0, 1.0)) == pytest.approx(expected), part


def test_deep_graphs_have_no_known_range():
    program = graph.Program()
    part = program.emit("IMAGE", 1, image=0, at=[0.0, 0.0])[0]
    for _ in range(3000):
        part = program.math("MULTIPLY", part, 0.5)
    assert program.range_of(part, lambda _image: (0.0, 1.0)) == (-math.inf, math.inf)


NUMBERS = [("ADD", (2, 3, 9), 5), ("SUBTRACT", (2, 3, 9), -1), ("MULTIPLY", (2, 3, 9), 6), ("DIVIDE", (3, 2, 9), 1.5),
           ("DIVIDE", (3, 0, 9), 0), ("MULTIPLY_ADD", (2, 3, 9), 15), ("MINIMUM", (2, 3, 0), 2), ("MAXIMUM", (2, 3, 9), 3),
           ("MIX", (2, 4, 0.25), 2.5), ("MIX", (2, 4, 1.5), 5), ("CLAMP", (5, 2, 3), 3), ("CLAMP", (1, 2, 3), 2),
           ("CLAMP", (2.5, 2, 3), 2.5), ("SQRT", (9, 0, 0), 3), ("SQRT", (-9, 0, 0), 0), ("ABSOLUTE", (-2, 0, 0), 2),
           ("COSINE", (0.5, 0, 0), 0.8775825618903728), ("SINE", (0.5, 0, 0), 0.479425538604203)]


@pytest.mark.parametrize("operation, operands, result", NUMBERS)
def test_numbers_need_no_node(operation, operands, result):
    """By 0 is 0, as the Math node has it, and the root of less than nothing."""
    program = graph.Program()
    assert program.math(operation, *map(float, operands)) == pytest.approx(result, abs=1e-15)
    assert not program.finish([])[0]


def test_what_changes_nothing_needs_no_node():
    program = graph.Program()
    r, s = program.emit("OBJECT", 3, what="LOCATION")[:2]
    for operation, operands, result in [
            ("MULTIPLY", (r, 1.0), r), ("MULTIPLY", (1.0, r), r), ("MULTIPLY", (r, 0.0), 0.0), ("MULTIPLY", (0.0, r), 0.0),
            ("ADD", (r, 0.0), r), ("ADD", (0.0, r), r), ("SUBTRACT", (r, 0.0), r), ("MIX", (r, s, 0.0), r),
            ("MIX", (r, s, 1.0), s)]:
        assert program.math(operation, *operands) is result or program.math(operation, *operands) == result
    for operation, operands in [("SUBTRACT", (0.0, r)), ("MULTIPLY", (r, 2.0)), ("ADD", (r, 1.0)), ("DIVIDE", (1.0, r)),
                                ("MIX", (r, s, 0.5))]:
        assert program.math(operation, *operands) not in (r, s, 0.0), operation


def test_what_stands_behind_a_number():
    program = graph.Program()
    near = program.emit("IMAGE", 3, image=0)
    far = program.emit("NOISE", 1)
    bump = program.emit("BUMP", 3, height=[program.math("MULTIPLY", near[0], far[0])] * 3)
    assert program.reads(bump, {"IMAGE"}) and program.reads((0.5, far[0]), {"NOISE", "BUMP"})
    assert not program.reads(near, {"NOISE"}) and not program.reads(bump, {"SCRATCHES"}) and not program.reads((0.0, 1.0), {"IMAGE"})
