# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels, samples, alpha; jobs: progress, cancel, threads, memory."""

import contextlib
import math
import threading
import time
from array import array
from pathlib import Path

import numpy as np
import pytest

from native_scenes import (
    chance,
    few,
    finish,
    image,
    material,
    mesh,
    native,
    ortho,
    persp,
    point,
    render,
    scene,
    sphere,
    square,
    sun,
)

COST = 3.3


def half_covered(x):
    """A plate that ends at this x, in a 16 pixel picture of [-1, 1]."""
    return mesh([[-2, -2, 0], [x, -2, 0], [x, 2, 0], [-2, 2, 0]], [[0, 1, 2], [0, 2, 3]])


@pytest.mark.parametrize("samples", [1, 4, 16, 64, 100, 256, 1500])
def test_coverage_is_alpha(samples):
    picture, _ = render(scene(samples=samples, meshes=[half_covered(1 / 16)]))
    assert (picture[:, :8, 3] == 1).all() and (picture[:, 9:] == 0).all()
    edge = picture[:, 8, 3]
    # a power of two is a net in base 2, over all of its passes: exactly half on either side
    tolerance = 0 if samples in (4, 16, 64, 256) else 1 if samples == 1 else 0.05
    assert (np.abs(edge - 0.5) <= tolerance).all()
    # premultiplied: the colour of the covered part, times alpha
    np.testing.assert_allclose(picture[:, 8, :3], edge[:, None] * picture[:, 7, :3], rtol=1e-4)


def test_background_fills_what_is_not_covered():
    background = np.float32([0.1, 0.2, 0.4])
    base = {"samples": 16, "meshes": [half_covered(1 / 16)], "background": background.tolist()}
    clear, _ = render(scene(**base))
    solid, _ = render(scene(transparent=False, **base))
    assert (solid[..., 3] == 1).all()
    np.testing.assert_allclose(
        solid[..., :3], clear[..., :3] + (1 - clear[..., 3:]) * background, rtol=1e-6
    )


def busy(**changes):
    """Something of everything: smooth and flat, two materials, three kinds of light, misses."""
    ball = sphere(20, radius=0.6)
    ball["material"][:] = 1
    return scene(
        **{
            "width": 50,
            "height": 37,
            "samples": 12,
            "camera": persp(0.4, (1, -2, 2)),
            "lights": [sun((1, 0.5, 2), angle=0.2), point((1, 1, 2), radius=0.3), sun()],
            "materials": [material(), material(ex=50.0, detail="GRAM_SCHMIDT")],
            "meshes": [square(0.7), ball],
        }
        | changes
    )


def test_threads_and_repetition_change_no_bit():
    first, _ = render(busy(threads=1))
    for threads in (1, 2, 3, 7):
        again, _ = render(busy(threads=threads))
        assert (again == first).all()
    assert 0.2 < (first[..., 3] > 0).mean() < 0.95


def test_region_is_a_cut_of_the_whole():
    whole, _ = render(busy())
    for x0, y0, x1, y1 in ((0, 0, 50, 37), (13, 5, 14, 6), (17, 0, 50, 20), (3, 30, 41, 37)):
        part, _ = render(busy(region=(x0, y0, x1, y1)))
        assert (part == whole[y0:y1, x0:x1]).all()


def test_seed_changes_the_samples_and_not_the_picture():
    a, _ = render(busy(samples=64))
    b, _ = render(busy(samples=64, seed=2))
    assert (a != b).any()
    assert abs(a.mean() - b.mean()) < 0.01 * a.mean()
    of = {seed: render(busy(samples=1, seed=seed))[0] for seed in (1, -1, 2**32 + 1, 2**32 - 1)}  # by the lowest 32 bits
    assert (of[1] == of[2**32 + 1]).all() and (of[-1] == of[2**32 - 1]).all() and (of[1] != of[-1]).any()


def test_stratified_samples_beat_random_ones():
    """Edges at angles, 64 samples against 4096: random ones are off by up to 1/16."""
    turned = mesh([[-2, -2.3, 0], [0.3, -2, 0], [-0.2, 2, 0], [-2, 2, 0]], [[0, 1, 2], [0, 2, 3]])
    fine, _ = render(scene(samples=4096, meshes=[turned]))
    coarse, _ = render(scene(samples=64, meshes=[turned]))
    edge = (fine[..., 3] > 0) & (fine[..., 3] < 1)
    error = np.sqrt(((fine - coarse)[..., 3][edge] ** 2).mean())
    assert edge.sum() > 10 and error < 0.02


def test_filter_widens_edges_and_keeps_the_mean():
    edge = {"samples": 1024, "meshes": [half_covered(0)], "width": 8, "height": 8}
    box_filtered, _ = render(scene(**edge))
    wide, _ = render(scene(filter_width=3.0, **edge))
    assert (box_filtered[:, 4, 3] == 0).all() and (box_filtered[:, 3, 3] == 1).all()
    # part of a 3 pixel Blackman-Harris window beyond half a pixel, by quadrature
    x = (np.arange(30000) + 0.5) / 30000
    window = (
        0.35875
        - 0.48829 * np.cos(2 * np.pi * x)
        + 0.14128 * np.cos(4 * np.pi * x)
        - 0.01168 * np.cos(6 * np.pi * x)
    )
    beyond = window[x > 0.5 + 0.5 / 3].sum() / window.sum()
    np.testing.assert_allclose(wide[:, 4, 3], beyond, atol=0.01)
    np.testing.assert_allclose(wide[:, 3, 3], 1 - beyond, atol=0.01)


def test_gaussian_filter():
    edge = {"samples": 1024, "meshes": [half_covered(0)], "width": 8, "height": 8}
    wide, _ = render(scene(filter_width=3.0, pixel_filter_type="GAUSSIAN", **edge))
    x = (np.arange(30000) + 0.5) / 30000 - 0.5
    window = np.exp(-2 * (6 * x) ** 2)
    np.testing.assert_allclose(wide[:, 4, 3], window[x > 0.5 / 3].sum() / window.sum(), atol=0.01)


def around():
    """A tenth to all sides, of a panorama."""
    return {**ortho(), "type": "PANO", "panorama": "EQUIRECTANGULAR", "range": [-0.1, 0.1, -0.1, 0.1], "fov": 1.0, "focal": 1.0,
            "sensor": (1.0, 1.0), "polynomial": [0.0] * 5, "frame": [0, 1, 0, 1]}


SHAPES = [(0, 0.0), (4, 0.0), (4, math.pi / 4), (3, 0.3), (6, 1.0)]


# half: of the picture's width, on the plate; that of a panorama lies another way for each ray, and is round here
@pytest.mark.parametrize("view, half, wide, high, blades, turn", [
    *((*view, 0.9, 0.6, *shape) for view in ((ortho, 1.0), (persp, 3 * 0.5)) for shape in SHAPES), (around, 3 * 0.1, 0.3, 0.3, 0, 0.0)])
def test_lens_blurs_an_edge_by_its_shape(view, half, wide, high, blades, turn):
    """The plate 3 before the camera, all sharp at 2: an edge is blurred by half the aperture."""
    lens = {"lens": (wide, high), "focus": 2.0, "blades": blades, "turn": turn}
    edge = {"samples": few(4096), "meshes": [half_covered(0)], "width": 8, "height": 8}
    seen = render(scene(camera={**view(), **lens}, **edge))[0][..., 3].mean(axis=0)
    grid = (np.arange(400) + 0.5) / 200 - 1  # points of the aperture, the same another way: by rejection
    points = np.stack(np.meshgrid(grid, grid), -1).reshape(-1, 2)
    middles = turn + 2 * np.pi * np.arange(blades) / max(blades, 1)
    sides = np.stack([np.cos(middles), np.sin(middles)])
    inside = ((points @ sides).max(axis=1) < np.cos(np.pi / blades) if blades
              else (points**2).sum(axis=1) < 1)
    spread = np.sort(-0.5 * wide * points[inside][:, 0])  # of where rays meet the plate, along x
    x = (np.arange(4000) + 0.5) / 4000 * 2 - 1
    covered = np.searchsorted(spread, -x * half) / len(spread)
    np.testing.assert_allclose(seen, covered.reshape(8, -1).mean(axis=1), atol=chance(4e-3))


def test_what_is_in_focus_is_sharp():
    nearer = {"meshes": [square(0.5, z=1.0)], "samples": 64}
    plate = {"meshes": [half_covered(0)], "samples": 64}
    lens = {"lens": (0.4, 0.4), "focus": 3.0, "blades": 5, "turn": 0.0}
    for view in (ortho(), persp()):
        flat = [render(scene(camera=c, **plate))[0] for c in (view, {**view, **lens})]
        np.testing.assert_allclose(*(f[..., 3] for f in flat), atol=1e-6)
        near = [render(scene(camera=c, **nearer))[0] for c in (view, {**view, **lens})]
        assert np.abs(near[0] - near[1])[..., 3].max() > 0.1


def test_clip_distances_cut():
    near, _ = render(scene(camera=ortho(clip=(3.1, 100))))
    far, _ = render(scene(camera=ortho(clip=(0.1, 2.9))))
    kept, _ = render(scene(camera=ortho(clip=(2.9, 3.1))))
    assert (near == 0).all() and (far == 0).all() and (kept[..., 3] == 1).all()


def test_clip_distances_are_along_the_view():
    """A wide perspective: at the corner the ray is sqrt(3) times as long as the view is deep."""
    def alpha(low, high):
        picture, _ = render(scene(camera=persp(1.0, clip=(low, high)), meshes=[square(4)]))
        return picture[..., 3]

    assert (alpha(2.9, 3.1) == 1).all() and (alpha(0.01, 3.1) == 1).all()
    assert (alpha(3.1, 100) == 0).all() and (alpha(0.01, 2.9) == 0).all()


def slow():
    """Would take an hour."""
    return busy(width=2000, height=2000, samples=65_536)


def test_cancel_stops_before_the_picture_is_whole():
    job = native.start(slow())
    while native.poll(job)["progress"] == 0 or native.poll(job)["stage"] == "build":
        assert not native.wait(job, 0.01)
    state = native.poll(job)
    assert state["state"] == "running" and state["stage"] == "render" and 0 < state["progress"] < 1
    native.cancel(job)
    start = time.monotonic()
    assert native.wait(job, 60)
    print(f"cancelled after {time.monotonic() - start:.3f} s")
    state = native.poll(job)
    assert state["state"] == "cancelled" and state["progress"] < 1
    assert state["sample"] == int(state["progress"] * state["samples"])  # those that all pixels have
    out = np.empty((2000, 2000, 4), np.float32)
    native.image(job, out)
    assert np.isfinite(out).all()
    native.free(job)


def so_far(job, size):
    out = np.empty((size, size, 4), np.float32)
    native.image(job, out)
    return out


def test_unfinished_picture_has_whole_tiles_only_then_all_of_them():
    size, samples = 1024, 2048
    flat = scene(width=size, height=size, samples=samples, threads=1)
    done = render(scene(width=size, height=16, samples=64))[0][0, 0]
    job = native.start(flat)
    while native.poll(job)["progress"] == 0:
        assert not native.wait(job, 0)
    out = so_far(job, size)
    finished = out[..., 3] == 1
    assert 0 < finished.mean() < 1 and (out[~finished] == 0).all()
    np.testing.assert_allclose(out[finished], np.broadcast_to(done, (finished.sum(), 4)), rtol=1e-4)
    while native.poll(job)["progress"] < 5 / samples:  # the first pass takes 4 samples of each
        assert not native.wait(job, 0.01)
    out = so_far(job, size)
    native.free(job)  # cancels too
    np.testing.assert_allclose(out, np.broadcast_to(done, out.shape), rtol=1e-4)


def test_planes_tell_the_first_surface():
    """Normal bent by a map, colour as it is textured, numbers; nothing where nothing is met."""
    bump = np.tile(np.float32([0.5 + 0.5 * 0.6, 0.5, 0.5 + 0.5 * 0.8]), (2, 2, 1))
    tint = np.tile(np.float32([0.25, 0.5, 0.75]), (2, 2, 1))
    plate = {**material(color_image=0, normal_image=1), "pass_index": 9}
    words = ["NORMAL", "ALBEDO", "MATERIAL", "DEPTH"]
    wanted = scene(materials=[plate], images=[image(tint), image(bump)], meshes=[square(0.5)],
                   planes=[{"type": word} for word in words], samples=20)
    job = native.start(wanted)
    finish(job)
    normal, albedo, number, depth = (np.full((16, 16, n), np.nan, np.float32) for n in (3, 3, 1, 1))
    for word, out in zip(words, (normal, albedo, number, depth)):
        native.image(job, out, word)
    again = np.full_like(depth, np.nan)
    native.image(job, again, "DEPTH", True)  # what is left of a picture so far is said of pictures
    assert (again == depth).all()
    with pytest.raises(ValueError, match="did not ask for a plane 'UV'"):
        native.image(job, depth, "UV")
    native.free(job)
    inside, outside = (slice(5, 11),) * 2, (slice(0, 3),) * 2
    np.testing.assert_allclose(normal[inside], np.broadcast_to([0.6, 0, 0.8], (6, 6, 3)), atol=1e-3)
    np.testing.assert_allclose(albedo[inside], np.broadcast_to(tint[0, 0], (6, 6, 3)), atol=1e-3)
    assert (number[inside] == 9).all() and (number[outside] == 0).all()
    np.testing.assert_allclose(depth[inside], 3, atol=1e-5)
    assert (depth[outside] == 1e10).all() and (normal[outside] == 0).all()


def test_depth_of_a_panorama_is_how_far_it_is():
    """Not along the way that the camera looks."""
    camera = {**ortho(), "type": "PANO", "panorama": "EQUIRECTANGULAR", "range": [-0.6, 0.6, -0.6, 0.6], "fov": 1.0, "focal": 1.0, "sensor": (1.0, 1.0),
              "polynomial": [0.0] * 5, "frame": [0, 1, 0, 1]}
    job = native.start(scene(camera=camera, meshes=[square(99.0)], planes=[{"type": "DEPTH"}], samples=4))
    finish(job)
    depth = np.zeros((16, 16, 1), np.float32)
    native.image(job, depth, "DEPTH")
    native.free(job)
    at = np.cos((np.arange(16) + 0.5) * 1.2 / 16 - 0.6)
    np.testing.assert_allclose(depth[..., 0], 3 / (at[:, None] * at), rtol=0.06)


def plane_of(word, channels, **changes):
    job = native.start(scene(width=5, height=5, samples=1, planes=[{"type": word}], **changes))
    assert finish(job)["state"] == "done"
    out = np.full((5, 5, channels), np.nan, np.float32)
    native.image(job, out, word)
    native.free(job)
    return out


ROUND = {"type": "PANO", "panorama": "FISHEYE_EQUIDISTANT", "fov": 0.6, "focal": 1.0, "range": [0.0] * 4, "sensor": (1.0, 1.0), "polynomial": [0.0] * 5, "frame": [0, 1, 0, 1]}


def test_distance_of_a_panorama_is_from_where_rays_begin():
    found = plane_of("DISTANCE", 1, camera=ortho(clip=(0.5, 100)) | ROUND, meshes=[square(9.0)])[..., 0]
    assert found[2, 2] == pytest.approx(2.5, rel=0.01) and found[0, 2] == pytest.approx(3 / np.cos(0.24) - 0.5, rel=0.05)


def test_no_surface_reflects_more_than_all():
    """Of several that add up the colour that a denoiser is told is 1 at most, of each channel."""
    white = {key: value for key, value in material(f0=(0, 0, 0), fresnel="NONE", kd=(0.8, 0.7, 0.3)).items() if key not in ("name", "nodes")}
    found = plane_of("ALBEDO", 3, materials=[{"name": "two", "nodes": [], "closures": [white, white]}])
    np.testing.assert_allclose(found[2, 2], (1, 1, 0.6), rtol=1e-5)


def test_planes_of_no_sample_are_dark():
    """Where a job that was stopped has not been; no number is what a sample's share of nothing would be."""
    job = native.start(busy(width=256, height=256, samples=1024, planes=[{"type": word} for word in ("ALBEDO", "NORMAL", "SAMPLES")]))
    native.cancel(job)
    finish(job)
    for word, channels in (("ALBEDO", 3), ("NORMAL", 3), ("SAMPLES", 1)):
        plane = np.full((256, 256, channels), np.nan, np.float32)
        native.image(job, plane, word)
        assert np.isfinite(plane).all() and (plane == 0).any(), word
    native.free(job)


def test_planes_of_objects_and_of_uv():
    """The number of the object that is met first, and where on its map, with 1 where there is one; by what is before, not by its mesh."""
    own = np.eye(4)
    own[2, 3] = 0.5
    wanted = scene(meshes=[square(0.5)], samples=20, planes=[{"type": word} for word in ("OBJECT", "UV", "POSITION")], instances=[
        {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "pass_index": 3}, {"mesh": 0, "matrix": own.ravel().tolist(), "pass_index": 7}])
    job = native.start(wanted)
    finish(job)
    number, uv, place = (np.full((16, 16, n), np.nan, np.float32) for n in (1, 3, 3))
    for word, out in zip(("OBJECT", "UV", "POSITION"), (number, uv, place)):
        native.image(job, out, word)
    native.free(job)
    inside, outside = (slice(5, 11),) * 2, (slice(0, 3),) * 2
    assert (number[inside] == 7).all() and (number[outside] == 0).all() and (uv[outside] == 0).all()
    np.testing.assert_allclose(place[inside][..., 2], 0.5, atol=1e-5)
    middle = (np.arange(5, 11) + 0.5) / 8 - 0.5
    np.testing.assert_allclose(uv[inside][..., :2], np.stack(np.meshgrid(middle, middle), -1), atol=0.02)
    np.testing.assert_allclose(place[inside][..., :2] + 0.5, np.stack(np.meshgrid(middle, middle), -1), atol=1 / 16)
    np.testing.assert_allclose(uv[inside][..., 2], 1, atol=1e-5)


def test_a_normal_as_it_is_seen():
    """To the right, up and away from the eye, as Cycles' denoising data have it: of a plate that a turned camera sees."""
    camera = ortho(0.3, eye=(1, -2, 2))
    job = native.start(scene(width=4, height=4, samples=1, camera=camera, planes=[{"type": "SEEN_NORMAL"}]))
    finish(job)
    seen = np.full((4, 4, 3), np.nan, np.float32)
    native.image(job, seen, "SEEN_NORMAL")
    native.free(job)
    right, up, back = np.reshape(camera["matrix"], (4, 4))[:3, :3].T
    assert back[2] > 0.6 and abs(right[2]) + up[2] > 0.5
    np.testing.assert_allclose(seen, np.broadcast_to((right[2], up[2], -back[2]), seen.shape), atol=1e-5)


def test_pictures_so_far_are_means_of_the_same_samples():
    """Asked for while more threads than cores add to it: what a pixel has and how many samples are of one pass."""
    tiles, times = 32, few(100)
    given = {"width": tiles, "height": tiles, "samples": 65536, "threads": 16, "mattes": [{"type": "OBJECT"}], "matte_slots": 16,
             "planes": [{"type": "ALBEDO"}], "instances": [{"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "matte": (5.0, 0.0)}]}
    done = render(scene(width=tiles, height=tiles, samples=16))[0][0, 0]
    job = native.start(scene(**given))
    while native.poll(job)["progress"] == 0:
        assert not native.wait(job, 0.001)
    for _ in range(times):
        out = so_far(job, tiles)
        there = out[..., 3] > 0
        np.testing.assert_allclose(out[there], np.broadcast_to(done, (there.sum(), 4)), rtol=1e-3)
        native.image(job, out, "OBJECT_MATTE00")
        np.testing.assert_allclose(out[..., 1][out[..., 0] == 5.0], 1, rtol=1e-3)
    assert native.poll(job)["state"] == "running"
    native.free(job)


def test_time_limit_ends_a_picture_that_is_whole():
    job = native.start({**slow(), "width": 256, "height": 256, "region": (0, 0, 256, 256),
                        "time_limit": 0.2})
    assert native.wait(job, 60)
    state = native.poll(job)
    assert state["state"] == "done" and 0 < state["progress"] < 1
    assert (so_far(job, 256)[..., 3] > 0).any()
    assert 0.2 <= native.timings(job)["wall"] < 5
    native.free(job)


@pytest.mark.parametrize("limit, samples", [(1e-9, 4), (0, 64), (1e6, 64)])
def test_time_that_is_over_leaves_one_pass(limit, samples):
    """Of 4 samples, of the whole picture; no limit is none."""
    job = native.start(scene(samples=64, time_limit=limit, width=100, height=100, planes=[{"type": "SAMPLES"}]))
    state = finish(job)
    assert (state["state"], state["progress"], state["sample"]) == ("done", samples / 64, samples)
    had = np.zeros((100, 100, 1), np.float32)
    native.image(job, had, "SAMPLES")
    assert (had == np.float32(samples / 64)).all() and (so_far(job, 100)[..., 3] == 1).all()
    native.free(job)


def spent():
    """Nanoseconds of each thread of the process, by the kernel's number of it."""
    found = {}
    for task in Path("/proc/self/task").iterdir():
        with contextlib.suppress(OSError):  # it has just ended
            found[task.name] = int((task / "schedstat").read_text().split()[0])
    return found


@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="the kernel does not say what threads spend")
@pytest.mark.parametrize("threads", [1, 2, 4])
def test_as_many_threads_as_are_asked_for(threads):
    """Whatever the cores; Embree's own, which build, sleep then."""
    before, job, busy = spent(), native.start(slow() | {"threads": threads}), []
    while native.poll(job)["stage"] == "build":
        assert not native.wait(job, 0.01)
    begun, until = spent(), time.monotonic() + 10
    while len(busy) < threads and time.monotonic() < until:
        assert not native.wait(job, 0.05)
        busy = [task for task, seconds in spent().items() if task not in before and seconds > begun.get(task, 0) + 1_000_000]
    native.cancel(job)
    assert native.wait(job, math.inf)
    native.free(job)
    assert len(busy) == threads


def test_dropping_a_job_ends_it():
    threads = threading.active_count()
    job = native.start(slow())
    del job
    assert threading.active_count() == threads


def test_python_runs_while_waiting():
    job = native.start(slow())
    counted = []
    thread = threading.Thread(target=lambda: counted.append(native.wait(job, 0.5)))
    thread.start()
    ticks = 0
    while thread.is_alive():
        ticks += 1
        time.sleep(0.001)
    assert ticks > 20 and counted == [False]
    native.free(job)


def test_free_while_another_thread_waits():
    job = native.start(slow())
    result = []
    thread = threading.Thread(target=lambda: result.append(native.wait(job, 60)))
    thread.start()
    time.sleep(0.05)
    native.free(job)
    thread.join(60)
    assert result == [True]
    with pytest.raises(ValueError, match="freed"):
        native.poll(job)


def test_poll_and_timings_at_the_end():
    job = native.start(busy(max_bounces=1))
    state = finish(job)
    assert 0 < state.pop("memory") <= state.pop("memory_peak")
    assert state == {
        "state": "done",
        "progress": 1.0,
        "sample": 12,
        "samples": 12,
        "stage": "render",
        "message": "",
        "warnings": [],
    }
    times = native.timings(job)
    assert times["samples"] == 50 * 37 * 12
    stages = {"camera", "hit", "surface", "choice", "shadow", "reflect", "draw", "trace", "film"}
    stages |= {"light_sun", "light_point", "closure_metal"}
    kinds = {f"{what}_{kind.lower()}" for what in ("light", "closure", "node")
             for kind in native.table()[what + "s"]}
    assert set(times) == stages | kinds | {"sky", "emitters", "wall", "image", "mesh", "bvh", "samples"}
    assert not any(times[k] for k in kinds - stages)  # those it does not have
    assert all(times[k] > 0 for k in stages | {"wall", "mesh", "bvh"})
    native.free(job)


def test_buffers_are_held_until_free():
    pixels = array("f", [0.5] * 64 * 64 * 4)
    job = native.start(scene(images=[image(np.ones((64, 64, 4), np.float32)) | {"data": pixels}], materials=[material(normal_image=0)]))
    with pytest.raises(BufferError):
        pixels.append(0)
    finish(job)
    native.free(job)
    pixels.append(0)


def test_many_jobs_at_once():
    first, _ = render(busy())
    jobs = [native.start(busy()) for _ in range(6)]
    for job in jobs:
        assert finish(job)["state"] == "done"
        out = np.empty_like(first)
        native.image(job, out)
        assert (out == first).all()
        native.free(job)


def test_table_names_what_start_accepts():
    table = native.table()
    assert set(table["lists"]) == {"mdf", "brdf", "detail", "groove", "fresnel", "diffuse", "multiscatter",
                                  "horizon"}
    for key, rows in table["lists"].items():
        for row in rows:
            assert set(row) == {"value", "word", "label", "help"} and row["help"]
            render(scene(materials=[{**material(), key: row["word"]}]))
    words = {row["word"]: row for row in table["params"]}
    assert {"ex", "ey", "ax", "ay", "f0"} <= set(words)
    assert words["f0"]["components"] == 3 and words["ex"]["maximum"] == 1e6
    assert native.version().count(".") == 2 and native.isa() in ("scalar", "sse2", "avx2", "avx512")
