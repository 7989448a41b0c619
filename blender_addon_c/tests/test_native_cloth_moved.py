# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloth that does not lie as the UV map says, is seen at a distance of one's choice, or is glossier here than there."""

import json

import numpy as np
import pytest

from native_scenes import dump, mesh, ortho, registers, render, scene, some, square, sun, vectors
from test_native_cloth import COVERAGE, PLACE, checked, cloth

COST = 2.9

FRAME, UV = registers(8, 2), registers(10, 3)
LIGHTS = [sun((0.5, 0.2, 0.8)), sun((-0.3, 0.6, 0.5), (1, 2, 3))]


def moved(nodes=(), framed=True, given=(), **fed):
    """A material of one cloth; fed: what WEAVE gets, given: what cloth and closure get."""
    frame = {"frame": FRAME} if framed else {}
    made = {"cloth": 0, "place": PLACE, **frame, **dict(given)}
    return {"name": "cloth", "closure": "FABRIC", "coverage": COVERAGE, **made, "nodes": [
        *nodes, {"type": "WEAVE", "cloth": 0, "out": PLACE, **frame, **fed}, {"type": "CLOTH", "out": COVERAGE, **made}]}


def math(operation, a, b, out, c=0.0):
    return {"type": "MATH", "operation": operation, "a": [a], "b": [b], "c": [c], "out": [out]}


def plate(matrix, mirror=1.0):
    """Its UV map, of metres, by a matrix."""
    xy = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
    return mesh(np.c_[xy, 0 * xy[:, 0]], [[0, 1, 2], [0, 2, 3]], uvs=(xy * (mirror, 1)) @ np.transpose(matrix))


def linear(matrix):
    """Nodes that make x and y of a vector of u and v, and its change over a step; what WEAVE gets then."""
    nodes, step, out = [{"type": "GEOMETRY", "what": "UV", "out": UV}], 0.25, registers(20, 6)
    for k, (du, dv) in enumerate([(0, 0), (step, 0), (0, step)]):
        for row in (0, 1):
            at = out[2 * k + row]
            nodes += [math("ADD", UV[0], du, (30,)), math("ADD", UV[1], dv, (31,)),
                      math("MULTIPLY", (30,), float(matrix[row][0]), (32,)),
                      math("MULTIPLY_ADD", (31,), float(matrix[row][1]), at, (32,))]
    return nodes, {"vector": out, "step": step}


ANGLE = 0.7
TURN = np.array([(np.cos(ANGLE), np.sin(ANGLE)), (-np.sin(ANGLE), np.cos(ANGLE))])


def ways(turned):
    """The same cloth: by a map that is turned and scaled, by Rotation and Scale, and by a vector."""
    matrix, (nodes, vector) = 1.5 * TURN, linear(1.5 * TURN)
    both = {"turn": [float(np.cos(ANGLE)), float(np.sin(ANGLE))], "scale": [1.5]}
    yield plate(matrix, turned), moved(framed=False)
    yield plate(np.eye(2), turned), moved(**both)
    yield plate(np.eye(2), turned), moved(nodes, **vector)
    half, (nodes, vector) = 0.3, linear(1.5 * TURN)
    back = np.array([(np.cos(half), -np.sin(half)), (np.sin(half), np.cos(half))])
    nodes, vector = linear(3.0 * back @ TURN)  # a vector that is turned further, and back again
    yield plate(np.eye(2), turned), moved(nodes, **vector, turn=[np.cos(half), np.sin(half)], scale=[0.5])


@pytest.mark.parametrize("mirror, behind", some([(1.0, True), (-1.0, True), (1.0, False), (-1.0, False)]))
def test_turned_by_nodes_or_by_the_map(mirror, behind, tmp_path):
    """Lights, draws and extents alike, seen aslant, and by the reference."""
    lights = [light | {"direction": tuple(np.multiply(light["direction"], -1 if behind else 1))} for light in LIGHTS]
    plain = {"cloths": [cloth("denim", 0.002)], "lights": lights, "background": (0.3, 0.5, 0.9), "max_bounces": 1,
             "camera": ortho(0.9, (1, 0.5, -3 if behind else 3)), "samples": 16, "width": 24, "height": 24}
    seen = []
    for k, (shape, material) in enumerate(ways(mirror)):
        given = scene(materials=[material], meshes=[shape], **plain)
        planes, _ = dump(given, tmp_path / f"{k}.exr")
        assert planes["foot.U"].max() < 0.75 and "apart" not in checked(tmp_path / f"{k}.exr")
        at = np.stack([planes[name] for name in ("uv.U", "uv.V", "foot.U", "foot.V")])
        seen.append((at, vectors(planes, "T"), render(given)[0][..., :3]))
    assert np.ptp(seen[0][0][0]) > 10
    for at, tangent, picture in seen[1:]:
        np.testing.assert_allclose(at, seen[0][0], rtol=1e-3, atol=2e-3)
        np.testing.assert_allclose(tangent, seen[0][1], atol=1e-4)
        assert np.abs(picture - seen[0][2]).mean() < 0.01 * seen[0][2].mean()


def test_turned_by_hand(tmp_path):
    """A quarter turn: the weft, along x before, is along y. Twice the scale: twice the crossings."""
    plain = {"cloths": [cloth("denim", 0.01)], "meshes": [plate(np.eye(2))], "lights": LIGHTS, "camera": ortho(0.9)}
    planes, _ = dump(scene(materials=[moved(turn=[0.0, 1.0], scale=[2.0])], **plain), tmp_path / "d.exr")
    np.testing.assert_allclose(vectors(planes, "T"), np.broadcast_to((0, 1, 0), (16, 16, 3)), atol=1e-6)
    np.testing.assert_allclose(planes["uv.U"], 2 * 26 * planes["P.Y"], atol=1e-4)  # 26 ends a cm
    np.testing.assert_allclose(planes["uv.V"], -2 * 17 * planes["P.X"], atol=1e-4)
    np.testing.assert_allclose(planes["foot.U"], 2 * 26 * 1.8 / 16, rtol=1e-4)


def test_what_is_no_number_leaves_no_hole():
    """Coordinates, angles and scales without sense, side by side on one cloth: the picture is finite."""
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": UV}, math("DIVIDE", UV[0], 0.0, (20,)),
             math("POWER", -2.0, 0.5, (21,)), math("MULTIPLY", UV[0], 3e38, (22,)), math("MULTIPLY", (22,), 10.0, (23,))]
    made = []
    for bad in ([(20,)], [(21,)], [(22,)], [(23,)], [0.0]):
        for fed in ({"turn": bad * 2}, {"scale": bad}, {"vector": [UV[0], UV[1], *bad * 4], "step": 0.1},
                    {"vector": bad * 6, "step": 0.1}):
            for given in ({}, {"gloss_from": bad, "nap_from": bad}):
                made.append(moved(nodes, given=given, framed="scale" not in fed, **fed))
    edges = np.linspace(-1, 1, len(made) + 1)
    strips = [mesh([(-1, a, 0), (1, a, 0), (1, b, 0), (-1, b, 0)], [[0, 1, 2], [0, 2, 3]],
                   uvs=np.array([(-1, a), (1, a), (1, b), (-1, b)]), materials=k)
              for k, (a, b) in enumerate(zip(edges, edges[1:]))]
    picture = render(scene(cloths=[cloth()], materials=made, meshes=strips, lights=LIGHTS, background=(1, 1, 1), max_bounces=1,
                           height=4 * len(made)))[0]
    assert np.isfinite(picture).all() and (picture[..., 3] == 1).all()


def test_gloss_and_nap_as_numbers_and_as_textures(tmp_path):
    """The exponents are the yarns' own times the gloss, as the reference has them; a register says the same."""
    plain = {"meshes": [square(1.0)], "lights": [sun((0.1, 0.2, 0.9))], "camera": ortho(0.9, (0.4, 0.5, 3)), "samples": 256}
    own = scene(cloths=[cloth("silk_charmeuse", 0.001)], materials=[moved(framed=False)], **plain)
    dull = scene(cloths=[cloth("silk_charmeuse", 0.001, gloss=0.25, nap=0.4)], materials=[moved(framed=False)], **plain)
    told = []
    for given in (own, dull):
        _planes, header = dump(given, tmp_path / "d.exr")
        assert "cloth" in checked(tmp_path / "d.exr")
        told.append(json.loads(header)["materials"][0]["fabric"]["cloth"] if isinstance(header, str) else
                    header["materials"][0]["fabric"]["cloth"])
    for yarn in ("warp", "weft"):
        for word in ("along", "across"):
            assert told[1][yarn][word] == pytest.approx(0.25 * told[0][yarn][word])
    assert told[1]["nap"] == pytest.approx(0.4)
    nodes = [math("ADD", 0.25, 0.0, (20,)), math("ADD", 0.4, 0.0, (21,))]
    fed = moved(nodes, framed=False, given={"gloss_from": [(20,)], "nap_from": [(21,)]})
    pictures = [render(given)[0][..., :3] for given in (own, dull, own | {"materials": [fed]})]
    assert np.abs(pictures[0] - pictures[1]).mean() > 0.1 * pictures[1].mean()
    assert np.abs(pictures[2] - pictures[1]).mean() < 0.002 * pictures[1].mean()


@pytest.mark.parametrize("tier, number, size, side", [("near", 1, 0.0004, 16), ("near", 1, 0.05, 16), ("far", 2, 0.05, 3),
                                                      ("auto", 0, 0.0004, 16)])
def test_distance(tier, number, size, side, tmp_path):
    """Whatever a pixel spans: by the tier in the dump, which the reference heeds."""
    given = scene(cloths=[cloth("denim", size, tier=tier)], materials=[moved(framed=False)], meshes=[square(1.0)],
                  lights=[sun((0.1, 0.2, 0.9))], width=side, height=side, camera=ortho(0.9, (0.4, 0.5, 3)))
    planes, _ = dump(given, tmp_path / "d.exr")
    said = checked(tmp_path / "d.exr")
    assert (planes["tier"] == number).all() and ("cloth far" in said) == (tier == "far")
    shown = np.std(planes["light0.S.R"]) / np.mean(planes["light0.S.R"])
    assert shown < 0.01 if tier == "far" else shown > 0.1


@pytest.mark.parametrize("change, message", [
    ({"cloths": [cloth(tier="single")]}, r"tier"),
    ({"cloths": [cloth(gloss=1.5)]}, r"gloss"),
    ({"cloths": [cloth(nap=-1.0)]}, r"nap"),
    ({"materials": [moved(given={"frame": [0.0, 1.0]})]}, r"frame must be two registers"),
    ({"materials": [moved(framed=False, turn=[0.0, 1.0])]}, r"frame"),
    ({"materials": [moved(vector=[0.0] * 6)]}, r"step"),
])
def test_what_cannot_be_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        render(scene(cloths=[cloth()], materials=[moved(scale=[1.0])]) | change)
