# SPDX-License-Identifier: GPL-3.0-or-later
"""Another scene or view takes over what a job has built: the same picture to the last bit, and little work."""

import copy
import os

import numpy as np
import pytest

from native_scenes import (area, box, finish, image, material, native, ortho, persp, point, registers, scene,
                           sky, sphere, square, sun)

COST = 4.5

SIDE = 12
STEPS = 10 if "ASAN_OPTIONS" in os.environ else 40  # a sanitizer looks at memory; it is slow
RNG = np.random.default_rng


def picture(job, description):
    state = finish(job)
    assert state["state"] == "done", state
    x0, y0, x1, y1 = description["region"]
    out = np.full((y1 - y0, x1 - x0, 4), np.nan, np.float32)
    native.image(job, out)
    return out


def fresh(description):
    job = native.start(description)
    out = picture(job, description)
    native.free(job)
    return out


def texels(seed, side=16):
    pixels = RNG(seed).uniform(0.2, 0.8, (side, side, 3)).astype(np.float32)
    pixels[..., 2] += 0.2
    return pixels


def matrix(rng, size=0.4):
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    out = np.eye(4)
    out[:3, :3] = turn * rng.uniform(0.5, 1.0) * size
    out[:3, 3] = rng.uniform(-0.7, 0.7, 3)
    return out.ravel().tolist()



def layered(image):
    """An image at another UV map, and a tangent of that for strokes' colour."""
    uv, tangent, color = registers(3, 3), registers(6, 3), registers(9, 3)
    nodes = [{"type": "LAYER", "layer": 0, "out": uv}, {"type": "LAYER", "layer": 1, "out": tangent},
             {"type": "IMAGE", "image": image, "at": uv[:2], "out": color},
             *({"type": "MATH", "operation": "MULTIPLY_ADD", "a": [one], "b": [0.3], "c": [other], "out": [out]}
               for one, other, out in zip(tangent, color, registers(12, 3)))]
    return material() | {"nodes": nodes, "f0_from": registers(12, 3)}


def start_of(apart=100):
    """A floor and two balls that lie in the world itself, and one of 2000 triangles, thrice, apart from it."""
    rng = RNG(3)
    meshes = [square(2.0, z=-0.8), box((-0.3,) * 3, (0.3,) * 3), sphere(4), sphere(12)]
    for mesh in meshes[2:]:
        mesh["layers"] = [{"layer": 0, "data": np.ascontiguousarray(mesh["corner_uvs"].reshape(-1, 2)[:, ::-1])}]
    meshes[1]["material"] = np.ascontiguousarray(np.arange(12) % 2, np.int32)
    meshes[3]["material"] = np.ascontiguousarray(np.arange(len(meshes[3]["material"])) % 3, np.int32)
    plain = np.eye(4).ravel().tolist()
    return scene(
        width=SIDE, height=SIDE, samples=2, threads=2, max_bounces=2, apart=apart, meshes=meshes,
        layers=[{"width": 2}, {"width": 4, "tangents_of": 0}], transparent=False,
        instances=[{"mesh": 0, "matrix": plain}, {"mesh": 1, "matrix": matrix(rng)}, {"mesh": 2, "matrix": matrix(rng), "hidden": 16},
                   *({"mesh": 3, "matrix": matrix(rng)} for _ in range(3))],
        images=[image(texels(1)), image(texels(2)), image(texels(4))],
        materials=[material(), layered(0), material(normal_image=1)],
        lights=[sun((0.3, 0.2, 1)), point((0, 0, 2), (2, 2, 2), 0.1), area((1, 0, 1.5))], background=(0.2, 0.3, 0.4))


# ---- what an artist does next; each leaves what it does not change


def move(rng, now):
    at = rng.integers(1, len(now["instances"]))
    now["instances"][at] = {**now["instances"][at], "matrix": matrix(rng)}


def move_nothing(rng, now):
    pass


def flatten(rng, now):
    """One axis is nothing: no rays can be turned into it, so it lies in the world itself."""
    at = rng.integers(3, len(now["instances"]))
    flat = np.reshape(matrix(rng), (4, 4)) @ np.diag([1, 1, 0, 1])
    now["instances"][at] = {**now["instances"][at], "matrix": flat.ravel().tolist()}


def hide(rng, now):
    at = rng.integers(0, len(now["instances"]))
    now["instances"][at] = {**now["instances"][at], "hidden": int(rng.choice([0, 1, 16, 6]))}


def add(rng, now):
    now["instances"].append({"mesh": int(rng.integers(0, len(now["meshes"]))), "matrix": matrix(rng)})


def remove(rng, now):
    if len(now["instances"]) > 4:
        del now["instances"][rng.integers(1, len(now["instances"]))]


def bend(rng, now):
    at = rng.integers(0, len(now["meshes"]))
    moved = now["meshes"][at]["positions"] * rng.uniform(0.8, 1.2, 3).astype(np.float32)
    now["meshes"][at] = {**now["meshes"][at], "positions": moved}


def unwrap(rng, now):
    at = rng.integers(2, len(now["meshes"]))
    moved = now["meshes"][at]["corner_uvs"] * rng.uniform(0.5, 2, 2).astype(np.float32)
    now["meshes"][at] = {**now["meshes"][at], "corner_uvs": moved}


def smooth(rng, now):
    at = rng.integers(0, len(now["meshes"]))
    leaning = now["meshes"][at]["corner_normals"] + rng.uniform(-0.2, 0.2, 3).astype(np.float32)
    now["meshes"][at] = {**now["meshes"][at], "corner_normals": leaning}


def repaint(rng, now):
    at, mesh = rng.integers(0, len(now["materials"])), rng.integers(0, len(now["meshes"]))
    count = len(now["meshes"][mesh]["material"])
    now["meshes"][mesh] = {**now["meshes"][mesh],
                           "material": np.ascontiguousarray(rng.integers(0, at + 1, count), np.int32)}


def turn_slider(rng, now):
    at = rng.integers(0, len(now["materials"]))
    now["materials"][at] = {**now["materials"][at], "ex": float(rng.uniform(1, 500)), "kd": tuple(rng.random(3) / 2)}


def swap_image(rng, now):
    at = rng.integers(0, len(now["materials"]))
    one = {"color_image": int(rng.integers(-1, 3)), "normal_image": int(rng.integers(-1, 3)),
           "normal_strength": float(rng.uniform(0, 2))}
    now["materials"][at] = material(**one)


def shuffle_images(rng, now):
    rng.shuffle(now["images"])


def paint_image(rng, now):
    now["images"][rng.integers(0, 3)] = image(texels(rng.integers(1e6), int(rng.integers(1, 30))))


def look_closer(rng, now):
    at = rng.integers(0, 3)
    now["images"][at] = {**now["images"][at], "filter": str(rng.choice(["LINEAR", "CLOSEST"])),
                         "wrap": str(rng.choice(["REPEAT", "EXTEND", "CLIP"]))}


def relayer(rng, now):
    """Tangents are not asked for any more, or are again."""
    at = rng.integers(0, 3)
    now["materials"][at] = layered(int(rng.integers(0, 3)))
    now["layers"] = [{"width": 2}, {"width": 4, **({"tangents_of": 0} if rng.random() < 0.5 else {})}]


def swap_layer(rng, now):
    mesh = now["meshes"][3]
    now["meshes"][3] = {**mesh, "layers": [{"layer": 0, "data": rng.random(mesh["layers"][0]["data"].shape, np.float32)}]}


def light(rng, now):
    now["lights"] = [*now["lights"][:1], point(tuple(rng.uniform(-1, 1, 2)) + (2.0,), tuple(rng.uniform(0, 3, 3)), 0.1)]


def take_lamp(rng, now):
    del now["lights"][rng.integers(0, len(now["lights"]) + 1):]


def give_lamp(rng, now):
    now["lights"].append(area(tuple(rng.uniform(-1, 1, 2)) + (1.5,)))


def dawn(rng, now):
    now["background"] = tuple(rng.random(3))


def show_sky(rng, now):
    now["sky"] = sky(index=int(rng.integers(0, 3)), strength=tuple(rng.random(3)))


def soften(rng, now):
    now["soft_terminator"] = not now.get("soft_terminator", False)


def settings(rng, now):
    now["max_bounces"], now["seed"] = int(rng.integers(0, 4)), int(rng.integers(0, 100))


def count_cores(rng, now):
    now["threads"] = int(rng.integers(1, 3))


def view(rng, now):
    eye = rng.uniform(-2, 2, 2).tolist() + [3]
    width, height = (int(side) for side in rng.integers(8, 2 * SIDE, 2))
    now.update(width=width, height=height, region=(1, 2, width - 1, height), samples=int(rng.integers(1, 6)),
               camera=(ortho if rng.integers(2) else persp)(eye=eye))


EDITS = (move, move_nothing, flatten, hide, add, remove, bend, unwrap, smooth, repaint, turn_slider, swap_image, shuffle_images,
         paint_image, look_closer, relayer, swap_layer, light, take_lamp, give_lamp, dawn, show_sky, soften, settings, count_cores, view)


def edited(now, rng, edits):
    now = {**now, **{key: copy.copy(value) for key, value in now.items() if isinstance(value, list)}}
    for edit in edits:
        edit(rng, now)
    return now


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit.__name__)
def test_after_an_edit(edit):
    """Some of the edits show. What moves bulges, too: it goes on doing so."""
    rng, before = RNG(1), start_of() | {"soft_terminator": edit is move}
    was, shows = fresh(before), edit in (move_nothing, count_cores)
    for _ in range(4):
        after = edited(before, rng, [edit])
        first = native.start(before)
        assert native.wait(first, 600)
        job = native.start(after, first)
        native.free(first)
        expected = fresh(after)
        np.testing.assert_array_equal(picture(job, after), expected)
        native.free(job)
        shows = shows or was.shape != expected.shape or (was != expected).any()
    assert shows


def test_an_edited_mesh_is_built_in_haste():
    """By a tree of less quality than the first one's, in which rays find the same, along shared edges too; what was before
    leaves memory."""
    ball = sphere(60)  # 14,000 triangles
    ball["positions"][[500, 502], 0] = np.nan, 1e30
    now = scene(width=96, height=96, samples=4, threads=2, max_bounces=2, apart=4096, meshes=[square(2.0, z=-0.8), ball],
                camera=persp(0.5, (0.1, -2.0, 1.2)), lights=[sun((0.3, 0.2, 1))], background=(0.2, 0.3, 0.4))
    job, held = native.start(now), []
    picture(job, now)
    for step in range(8):
        bent = ball["positions"] * np.float32((1, 1 + 0.05 * step, 1))
        now = {**now, "meshes": [now["meshes"][0], {**ball, "positions": bent}]}
        after = native.start(now, job)
        native.free(job)
        job = after
        np.testing.assert_array_equal(picture(job, now), fresh(now))
        held.append(native.poll(job)["memory"])
    native.free(job)
    assert max(held[1:]) < 1.05 * held[0]


def test_what_is_moved_leaves_nothing():
    """A body that goes to and fro holds what it held after the first time."""
    before = start_of()
    now = {**before, "instances": [*before["instances"][:5], {**before["instances"][5], "matrix": matrix(RNG(1))}]}
    job, held = native.start(before), []
    assert native.wait(job, 600)
    for step in range(12):
        after = native.start((now, before)[step % 2], job)
        native.free(job)
        job = after
        assert finish(job)["state"] == "done"
        held.append(native.poll(job)["memory"])
    native.free(job)
    assert held[-1] == pytest.approx(held[1], abs=8 << 10)


@pytest.mark.parametrize("order, change", [((0, 0), {}), ((0, 1), {"seed": 6.0})])
def test_scratches_that_are_laid(order, change):
    """There is one twice, or the first one changes."""
    def scratched(*fields):
        (u, v, _), (nearer, higher) = uv, near = registers(3, 3), registers(6, 2)
        said = [{"type": "GEOMETRY", "what": "UV", "out": uv},
                *({"type": "MATH", "operation": "ADD", "a": [a], "b": [0.125], "c": [0.0], "out": [b]} for a, b in zip(uv, near))]
        node = {"type": "SCRATCHES", "what": "NORMAL", "at": uv[:2], "near": [nearer, v, u, higher], "step": 0.125, "amount": [1.0],
                "normal": [0.0, 0.0, 1.0], "out": registers(8, 3)}
        materials = [material() | {"nodes": [*said, node | {"field": k}], "normal": registers(8, 3)} for k in range(2)]
        return scene(apart=100, samples=1, scratches=list(fields), materials=materials, meshes=[square(), square(0.5, 0.1, 1)])

    laid = [{"density": 0.1, "length": 30.0, "width": 5.0, "depth": 0.2, "direction": 0.3, "spread": 0.6, "seed": seed, "tile": 0.5}
            for seed in (5.0, 9.0)]
    one, other = (laid[k] for k in order)
    before, after = scratched(*laid), scratched(one | change, other)
    expected, job = fresh(after), native.start(before)
    assert (expected != picture(job, before)).any()
    again = native.start(after, job)
    native.free(job)
    np.testing.assert_array_equal(picture(again, after), expected)
    native.free(again)


def test_after_many_edits():
    """One job after another, some of them ended before they are done."""
    rng = RNG(7)
    now = start_of()
    job = native.start(now)
    for step in range(STEPS):
        now = edited(now, rng, rng.choice(EDITS, rng.integers(1, 4)))
        after = native.start(now, job)
        native.free(job)
        job = after
        if rng.random() < 0.3:
            continue
        np.testing.assert_array_equal(picture(job, now), fresh(now), err_msg=str(step))
    native.free(job)


def test_a_look_is_a_start_with_another_camera():
    rng = RNG(9)
    now = start_of()
    job = native.start(now)
    picture(job, now)
    for _ in range(4):
        now = edited(now, rng, [view])
        seen = native.look(job, {key: now[key] for key in ("width", "height", "region", "samples", "camera")})
        with pytest.raises(ValueError):
            native.poll(job)
        native.free(job)
        job = seen
        np.testing.assert_array_equal(picture(job, now), fresh(now))
        assert native.timings(job)["mesh"] == native.timings(job)["bvh"] == 0
    native.free(job)


def test_what_has_not_moved_is_not_built_again():
    before = start_of()
    first = native.start(before)
    picture(first, before)
    after = edited(before, RNG(1), [turn_slider, light])
    job = native.start(after, first)
    picture(job, after)
    assert native.timings(job)["bvh"] < 0.1 * native.timings(first)["bvh"]
    native.free(first)
    native.free(job)


@pytest.mark.parametrize("changes", [{"width": 0}, {"samples": None}, {"camera": {}}, {"region": (5, 5, 5, 5)}])
def test_a_look_that_is_wrong_leaves_the_job(changes):
    now = start_of()
    job = native.start(now)
    was = picture(job, now)
    with pytest.raises(ValueError):
        native.look(job, {**now, **changes})
    np.testing.assert_array_equal(picture(job, now), was)
    native.free(job)


def test_a_start_that_is_wrong_leaves_the_job():
    now = start_of()
    job = native.start(now)
    was = picture(job, now)
    with pytest.raises(ValueError):
        native.start({**now, "width": 0}, job)
    np.testing.assert_array_equal(picture(job, now), was)
    native.free(job)


def test_a_picture_over_another():
    """What is not rendered yet stays."""
    now = {**start_of(), "width": 256, "height": 256, "region": (0, 0, 256, 256), "samples": 1024}
    job = native.start(now)
    native.cancel(job)
    assert native.wait(job, 600)
    over = np.full((256, 256, 4), 7, np.float32)
    native.image(job, over, "", True)
    plain = np.full((256, 256, 4), 7, np.float32)
    native.image(job, plain)
    assert (over == 7).all(-1).any() and ((over == plain) | ((over == 7) & (plain == 0))).all()
    native.free(job)


def test_a_look_says_what_building_said():
    """Strokes on a mesh without a UV map: with each picture of a viewport, not its first alone."""
    now = scene(meshes=[{**square(1.0), "corner_uvs": None}], materials=[material(ex=100.0, ey=10.0)], width=4, height=4)
    job = native.start(now)
    said = finish(job)["warnings"]
    assert len(said) == 1 and "no UV map" in said[0], said
    for _ in range(2):
        job, before = native.look(job, {key: now[key] for key in ("width", "height", "region", "samples", "camera")}), job
        native.free(before)
        assert finish(job)["warnings"] == said
    native.free(job)


def test_a_picture_that_was_copied_is_let_go():
    """A bytearray cannot grow while something holds its memory."""
    job = native.start(scene(samples=1))
    finish(job)
    for more in ((), ("",), ("", True)):
        room = bytearray(16 * 16 * 16)
        native.image(job, memoryview(room).cast("f"), *more)
        room.append(0)
    native.free(job)
