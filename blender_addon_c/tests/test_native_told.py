# SPDX-License-Identifier: GPL-3.0-or-later
"""What objects say by name, islands, light below 0 and graphs of many registers, in the native module alone."""

import json
import subprocess

import numpy as np
import pytest

from native_scenes import ROOT, few, material, mesh, native, ortho, registers, render, scene, square
from test_native_closures import of, shade

COST = 0.6

SAID = np.float32([[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8], [0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1]])


def told(attribute, **changes):
    """Two squares beside each other, each of which shines with what it says; and one beside that says nothing."""
    nodes = [{"type": "ATTRIBUTE", "attribute": attribute, "out": registers(200, 3), "more": registers(203, 1)}]
    shines = {"name": "tells", "closure": "EMISSION", "weight": registers(200, 2) + registers(203, 1), "nodes": nodes}
    instances = [{"mesh": 0, "matrix": place(0.5 * k - 0.5), "attributes": row} for k, row in enumerate(SAID)]
    instances.append({"mesh": 0, "matrix": place(0.5)})
    return scene(meshes=[square(0.25)], materials=[shines], instances=instances, attributes=2, camera=ortho(0.75), lights=[],
                 transparent=False, width=6, height=6, **changes)


def place(x):
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix.ravel().tolist()


@pytest.mark.parametrize("attribute", [0, 1])
@pytest.mark.parametrize("moves", [False, True])
def test_objects_say_four_numbers_each(attribute, moves):
    made = told(attribute, samples=few(16))
    if moves:  # towards the camera
        for one in made["instances"]:
            step = np.array(one["matrix"], np.float32)[:12]
            one["motion"] = np.stack([step, step + np.float32([0] * 11 + [0.1])])
    picture = render(made)[0]
    for k, row in enumerate([*SAID, np.zeros(8)]):
        expected = row[4 * attribute:4 * attribute + 4][[0, 1, 3]]
        assert np.allclose(picture[2:4, 2 * k:2 * k + 2, :3], expected, atol=1e-5), (k, moves)


@pytest.mark.parametrize("change, words", [
    ({"attributes": -1}, "attributes must be"), ({"attributes": 0}, "attribute must be"), ({"attributes": 3}, "attributes has 8 items")])
def test_what_is_said_is_checked(change, words):
    with pytest.raises(ValueError, match=words):
        native.start({**told(0), **change})


def by_hand(pairs, count):
    """Sets by their smallest member."""
    of = list(range(count))
    for a, b in pairs:
        a, b = of[a], of[b]
        of = [min(a, b) if x in (a, b) else x for x in of]
    return of


def test_roots_stand_for_what_pairs_join():
    chance = np.random.default_rng(4)
    for count, many in ((1, 0), (7, 3), (50, 30), (50, 200)):
        pairs = chance.integers(0, count, (many, 2)).astype(np.int32)
        told = bytearray(pairs)
        found = np.frombuffer(native.roots(told, count), np.uint32)
        told.clear()  # which Python refuses where roots holds it still
        assert (found[found] == found).all()
        same = np.array(by_hand(pairs.tolist(), count))
        assert ((found[:, None] == found) == (same[:, None] == same)).all()


def test_which_stands_for_all_is_by_rank():
    """The first of a pair of equals, the root of the larger tree else: as in Cycles' sets, which hash it."""
    for pairs, roots in (([(1, 0)], [1, 1]), ([(0, 1), (2, 1)], [0, 0, 0]), ([(0, 1), (2, 3), (3, 1)], [2, 2, 2, 2])):
        assert list(np.frombuffer(native.roots(np.int32(pairs), len(roots)), np.uint32)) == roots


@pytest.mark.parametrize("pairs, count", [([(0, 2)], 2), ([(-1, 0)], 2), ([(0, 0)], 0), ([0], 1), ([(0, 0)], -1)])
def test_roots_of_what_is_not_there(pairs, count):
    told = bytearray(np.int32(pairs))
    with pytest.raises(ValueError, match="below count"):
        native.roots(told, count)
    told.clear()


def emitter(weight, **more):
    return {"name": "light", "closure": "EMISSION", "weight": weight, "nodes": [], **more}


@pytest.mark.parametrize("fed", [False, True])
@pytest.mark.parametrize("clamp", [0.0, 10.0])
def test_light_below_0_is_seen(fed, clamp):
    weight = (-0.5, 0.25, -2.0)
    nodes = [{"type": "MATH", "operation": "ADD", "a": [x], "b": [0.0], "c": [0.0], "out": [(150 + k,)]}
             for k, x in enumerate(weight)]
    shines = emitter(registers(150, 3), nodes=nodes) if fed else emitter(weight)
    made = scene(meshes=[square(2.0)], materials=[shines], lights=[], camera=ortho(0.5), width=4, height=4,
                 transparent=False, sample_clamp_direct=clamp)
    assert np.allclose(render(made)[0][..., :3], weight, atol=1e-6)


def test_light_below_0_takes_from_others():
    """A plate under two lamps of opposite light gets none, in the mean."""
    floor = {"name": "floor", "closure": "DIFFUSE", "model": "LAMBERT", "color": (0.8,) * 3, "roughness": [0.0], "nodes": []}
    meshes = [square(0.5, 0.0, 0), square(0.5, 1.0, 1), square(0.5, 1.001, 2)]
    pictures = []
    for first in (1.0, -1.0):
        materials = [floor, emitter((first, 2 * first, 0.0)), emitter((0.0,) * 3)]
        made = scene(meshes=meshes, materials=materials, lights=[], camera=ortho(0.4, eye=(0, 0, 0.5)), width=4, height=4,
                     samples=few(1024), max_bounces=0, transparent=False, light_sampling_threshold=0.01)
        pictures.append(render(made)[0][..., :2].mean((0, 1)))
    assert pictures[0][0] > 0.1 and np.allclose(pictures[0], -pictures[1], rtol=0.02)


def test_a_graph_may_use_all_registers():
    """A sum of 250 numbers that all wait for the last."""
    nodes = [{"type": "GEOMETRY", "what": "POSITION", "out": registers(3, 3)}]
    nodes += [{"type": "MATH", "operation": "MULTIPLY_ADD", "a": [(3,)], "b": [0.0], "c": [k / 1e4], "out": [(k,)]}
              for k in range(6, 256)]
    sum_ = 0.0
    for k in range(6, 256):
        nodes.append({"type": "MATH", "operation": "ADD", "a": [(k,)], "b": [sum_ if k == 6 else (4,)], "c": [0.0], "out": [(4,)]})
    made = scene(meshes=[square(2.0)], materials=[emitter([(4,)] * 3, nodes=nodes)], lights=[], camera=ortho(0.5), width=4, height=4,
                 transparent=False)
    assert np.allclose(render(made)[0][..., :3], sum(range(6, 256)) / 1e4, rtol=1e-5)


@pytest.mark.parametrize("lost, said", [
    (0, []), (2, []), (3, ["plate: 3% of its UV map has no area: strokes there go as those beside it"]), (99, ["plate: 99% of its UV map has no area: strokes there go as those beside it"]),
    (100, ["plate: its UV map has no area: its tangent is the object's X axis"]), (None, ["plate has no UV map: its tangent is the object's X axis"])])
def test_what_is_said_of_uv_maps_under_strokes(lost, said):
    """From more than 2 % of the triangles on that strokes are on; nothing where what is there has no strokes, or they are turned by nodes.
    Bodies of fibres have strokes, and metals that are not round."""
    round_ = material(ex=20.0, ey=20.0)
    matt = round_ | {"fresnel": "NONE", "f0": (0, 0, 0), "kd": (0.5, 0.5, 0.5), "ex": 200.0}
    bodies = [row["word"] for row in native.table()["lists"]["diffuse"]]
    closures = [(material(), True), (material() | {"turned": True}, False), (round_, False), (matt, False),
                *((round_ | {"diffuse": word}, word not in ("lambert", "ashikhmin_shirley")) for word in bodies),
                (of({"closure": "DIFFUSE", "model": "LAMBERT", "color": (1, 1, 1), "roughness": [0.0]}), False)]
    corners = np.arange(101) / 100
    xy = np.concatenate([np.stack([corners, 0 * corners], 1), np.stack([corners, 0 * corners + 1], 1)])
    faces = [[k, k + 1, 101 + k] for k in range(100)]
    plate = mesh(np.c_[xy, 0 * xy[:, 0]], faces, uvs=xy) | {"name": "plate"}
    if lost is None:
        plate["corner_uvs"] = None
    else:
        plate["corner_uvs"].reshape(100, 6)[:lost] = 0.25
    for closure, is_said in closures:
        state = render(scene(meshes=[plate], materials=[closure], samples=1, width=2, height=2))[1]
        assert state["warnings"] == (said if is_said else []), closure


@pytest.mark.parametrize("end, said", [(np.eye(4), False), (np.diag([-1.0, 1, 1, 1]), True), (np.zeros((4, 4)), True), (np.diag([1.0, 1, 1e-4, 1]), False),
                                       (np.diag([1.0, 1e-5, 1e-5, 1]), True)])
@pytest.mark.parametrize("order", [1, -1])
def test_what_moves_to_no_size_is_said(end, said, order):
    """On its way, too: what becomes its mirror image has no size in the midst."""
    steps = np.stack([(1 - t) * np.eye(4)[:3] + t * end[:3] for t in (0, 0.5, 1)][::order]).astype(np.float32)
    endless = np.diag([1e306] * 3 + [1])  # beside which, for it is left out, others move
    given = scene(meshes=[square() | {"name": "wing"}, square(1e6)], samples=4, width=2, height=2, instances=[
        {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "motion": steps}, {"mesh": 1, "matrix": endless.ravel().tolist()}])
    words = "wing moves too far, or to no size, while the shutter is open: it is not blurred"
    picture, state = render(given)
    assert state["warnings"] == [words] * said and (not said or (picture[..., 3] == 1).all())


def test_what_an_object_is_that_says_nothing():
    """White, of number 0 and of chance 0."""
    nodes = [{"type": "OBJECT", "what": "COLOR", "out": registers(3, 3)}, {"type": "OBJECT", "what": "NUMBERS", "out": registers(6, 3)}]
    shown = []
    for weight in (registers(3, 3), registers(6, 3)):
        shines = {"name": "shows", "closure": "EMISSION", "weight": weight, "nodes": nodes}
        given = scene(materials=[shines], lights=[], transparent=False, samples=1, width=2, height=2)
        shown.append(render(given)[0][0, 0, :3].tolist())
        given["instances"][0] |= {"color": (0.5, 0.25, 1, 1), "random": 0.75, "pass_index": 3}
        shown.append(render(given)[0][0, 0, :3].tolist())
    assert shown == [[1, 1, 1], [0.5, 0.25, 1], [1, 0, 0], [1, 3, 0.75]], shown  # alpha, index, random


@pytest.mark.parametrize("of, name, said", [("metal", "denim", "no metal 'denim'"), ("metal", "mithril", "no metal 'mithril'"), ("cloth", "brushed_steel", "no cloth 'brushed_steel'"),
                                            ("cloth", "canvas", "no cloth 'canvas'"), ("cloth_albedo", "brushed_steel", "no cloth 'brushed_steel'")])
def test_presets_of_the_other_kind(of, name, said):
    with pytest.raises(ValueError, match=said):
        getattr(native, of)(name)


def test_the_table_is_the_librarys():
    """As its Python module reads it. Gold is yellow, of what |(m - 1)/(m + 1)|^2 says of its index; silver is all but white."""
    table = native.table()
    assert {row["word"]: (row["label"], row["eta"], row["k"]) for row in table["measured"]} == shade.metals()
    colors = {}
    for row in table["measured"]:
        index = np.array(row["eta"]) + 1j * np.array(row["k"])
        colors[row["word"]] = abs((index - 1) / (index + 1)) ** 2
    assert colors["gold"][0] > colors["gold"][1] > 1.5 * colors["gold"][2] and min(colors["silver"]) > 0.9
    keys = ("unit", "help", "components", "minimum", "maximum", "initial")
    told = {row["word"]: [row[key] for key in keys] for row in table["params"]}
    assert told == {word: [getattr(row, key) for key in keys] for word, row in shade.parameters().items()}
    assert {row["word"]: row["label"] for row in table["weaves"]} == shade.weaves()


def test_presets_are_the_tools():
    """Their numbers as `shade presets` says them."""
    done = subprocess.run([ROOT / "build/shade", "presets", "--json"], check=True, capture_output=True)
    presets, table = {row["name"]: row for row in json.loads(done.stdout)}, native.table()
    about = {row["word"]: (row["label"], row["help"]) for row in [*table["cloths"], *table["metals"]]}
    assert about == {word: (row["label"], row["help"]) for word, row in presets.items()}
    for row in table["cloths"]:
        truth, own = presets[row["word"]], native.cloth(row["word"])
        assert own["weave"] == truth["weave"] and own["counts"] == (truth["ends_per_cm"], truth["picks_per_cm"])
        for yarn in ("warp", "weft"):
            numbers = {word: value for word, value in own[yarn].items() if word != "twist"}
            assert numbers == pytest.approx({word: truth[yarn][word] for word in numbers})
            assert row[yarn] == pytest.approx(truth[yarn]["kd"])
        assert row["nap"] == truth["nap"]
        exponents = [truth[yarn][word] for yarn in ("warp", "weft") for word in ("along", "across")]
        assert row["exponent"] == pytest.approx(np.mean(exponents))
    for row in table["metals"]:
        truth = presets[row["word"]]
        assert row["turned"] == truth["turned"]
        own = native.metal(row["word"])  # with its scratches in its lobe
        for word in ("eta", "k", "kd", "fresnel"):
            assert own[word] == (truth["material"][word] if word == "fresnel" else pytest.approx(truth["material"][word]))
        assert all(np.size(own[param["word"]]) == param["components"] for param in table["params"])
        assert own["ex"] <= 1.0001 * truth["material"]["ex"] and own["ey"] <= 1.0001 * truth["material"]["ey"]
