# SPDX-License-Identifier: GPL-3.0-or-later
"""Malformed and awkward scenes: a ValueError that says where, or a defined picture."""

import copy
import json
import subprocess
from array import array
from contextlib import nullcontext

import numpy as np
import pytest

from native_scenes import (
    ROOT,
    area,
    dump,
    finish,
    image,
    material,
    mesh,
    native,
    ortho,
    point,
    render,
    scene,
    sky,
    spot,
    square,
    sun,
    vectors,
)

COST = 1.2

SHADE = ROOT / "build/shade"
PIXELS = np.zeros((2, 2, 4), np.float32)


def change(path, value):
    """A good scene with the item at this path replaced; ... removes it."""
    description = copy.deepcopy(
        scene(
            lights=[sun(), point((0, 0, 1))],
            images=[image(PIXELS)],
            materials=[material(normal_image=0)],
        )
    )
    at = description
    for step in path[:-1]:
        at = at[step]
    if value is ...:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    return description


@pytest.mark.parametrize(
    "path, value, message",
    [
        (("width",), 0, "width must be an integer from 1"),
        (("height",), -5, "height must be"),
        (("width",), 10**9, "width must be"),
        (("width",), "many", "width must be"),
        (("width",), ..., "width is missing"),
        (("samples",), 0, "samples must be"),
        (("samples",), 10**6, "samples must be an integer from 1 to 65536"),
        (("threads",), -1, "threads must be"),
        (("region",), (0, 0, 17, 16), "region must be"),
        (("region",), (5, 5, 5, 9), "region is empty"),
        (("region",), (0, 0, 1), "region must be a sequence of 4"),
        (("background",), (1.0,) * 4, "background must be a sequence of 3 finite numbers"),
        (("looks",), [{"rays": np.array([1], np.uint32)}], r"looks\[0\]: rays must be kinds of rays"),
        (("looks",), [{"rays": np.array([64], np.uint32)}], r"looks\[0\]: rays must be kinds of rays"),
        (("looks",), [{"rays": np.array([2.0])}], r"looks\[0\]: rays"),
        (("looks",), [{"rays": np.array([2], np.uint32)}], r"looks\[0\]: background is missing"),
        (("looks",), [{"rays": np.array([2], np.uint32), "sky": {}}], r"looks\[0\].sky: strength is missing"),
        (("looks",), [{"rays": np.array([2], np.uint32), "background": (1, 1, 1)}] * 16, "more looks than ways"),
        (("sky",), {**sky(), "shader": 0}, "sky: shader must be"),
        (("sky",), {**sky(), "shader": 2}, "a sky's shader is 2; there are 1 materials"),
        (("sky",), {**sky(), "shader": 1}, "a sky's shader has a node that only surfaces know"),
        (("camera", "clip"), (1, 2, 3), "camera: clip must be a sequence of 2"),
        (("background",), (0, float("nan"), 0), "background must be"),
        (("filter_width",), -1.0, "filter_width must be from 0"),
        (("camera",), None, "camera must be a dict"),
        (("camera", "type"), "ROUND", "camera: type must be one of ORTHO, PERSP, PANO"),
        (("camera", "type"), "PANO", "camera: panorama is missing"),
        (("camera", "matrix"), [0.0] * 16, "camera: matrix must be invertible"),
        (("camera", "clip"), (2, 1), "camera: clip must be"),
        (("camera", "clip"), (2, 2), "camera: clip must be"),
        (("camera", "clip"), (0, 0), "camera: clip must be"),
        (("camera", "lens"), (-1, 1), "camera: focus is missing"),
        (("pixel_filter_type",), "MITCHELL", "pixel_filter_type must be one of BLACKMAN_HARRIS, "),
        (("time_limit",), float("nan"), "time_limit must be"),
        (("camera", "clip"), (-1, 1), "camera: clip must be"),
        (("camera", "frame"), "abc", "camera: frame must be"),
        (("lights",), 3, "lights must be a list"),
        (("lights", 0), 3, r"lights\[0\]: a dict is expected"),
        (("lights", 0, "type"), "LAMP", r"lights\[0\]: type must be one of SUN, POINT, SPOT, AREA"),
        (("lights", 0, "direction"), (0, 0, 0), r"lights\[0\]: direction must be"),
        (("lights", 0, "angle"), -1, r"lights\[0\]: angle must be from 0"),
        (("lights", 1, "position"), (0, 0, float("inf")), r"lights\[1\]: position must be"),
        (("lights", 1, "radius"), -1, r"lights\[1\]: radius must be"),
        (("images", 0, "channels"), 5, r"images\[0\]: channels must be"),
        (("images", 0, "width"), 3, r"images\[0\]: data has 16 items; 24 are expected"),
        (("images", 0, "data"), np.zeros(16), r"images\[0\]: data has items of format 'd'"),
        (
            ("images", 0, "data"),
            np.zeros((4, 8), np.float32)[:, ::2],
            r"images\[0\]: data must be a contiguous buffer",
        ),
        (("images", 0, "data"), [1, 2, 3], r"images\[0\]: data must be a contiguous buffer"),
        (("images", 0, "wrap"), "BOX", r"images\[0\]: wrap must be one of REPEAT, EXTEND, CLIP, MIRROR"),
        (
            ("materials", 0, "detail"),
            "bend",
            r"materials\[0\]: detail must be one of none, perturb",
        ),
        (("materials", 0, "ex"), float("nan"), r"materials\[0\]: ex must be a finite number"),
        (
            ("materials", 0, "nodes", 0, "image"),
            1,
            r"materials\[0\]\.nodes\[0\]: image must be an integer from 0 to 0",
        ),
        (("materials", 0, "name"), 7, r"materials\[0\]: name must be a string"),
        (("meshes", 0, "positions"), ..., r"meshes\[0\]: positions is missing"),
        (("meshes", 0, "positions"), np.zeros(10, np.float32), r"meshes\[0\]: positions must be 3"),
        (
            ("meshes", 0, "corner_position"),
            np.int32([0, 1, 9] * 2),
            r"corner_position has an index outside of the 4",
        ),
        (
            ("meshes", 0, "corner_position"),
            np.int32([0, 1, -1] * 2),
            r"corner_position has an index outside",
        ),
        (
            ("meshes", 0, "corner_position"),
            np.zeros(6, np.int64),
            r"corner_position has items of format 'l'",
        ),
        (
            ("meshes", 0, "corner_normals"),
            np.zeros(9, np.float32),
            r"corner_normals has 9 items; 18",
        ),
        (("meshes", 0, "corner_uvs"), np.zeros(9, np.float32), r"corner_uvs has 9 items; 12"),
        (
            ("meshes", 0, "material"),
            np.int32([0, 1]),
            r"material has an index outside of the 1 materials",
        ),
        (
            ("meshes", 0, "material"),
            np.int32([0, -1]),
            r"material has an index outside of the 1 materials",
        ),
        (("instances", 0, "mesh"), 1, r"instances\[0\]: mesh must be an integer from 0 to 0"),
        (("instances", 0, "matrix"), [float("nan")] * 16, r"instances\[0\]: matrix must be"),
        (("dump",), 5, "dump must be a string"),
    ],
)
def test_malformed_scene_says_where(path, value, message):
    with pytest.raises(ValueError, match=message):
        native.start(change(path, value))


def floats(count):
    return np.zeros(count, np.float32)


LENS = ortho() | {"lens": (1, 1), "focus": 1.0, "blades": 0, "turn": 0.0}
ROUND = ortho() | {"type": "PANO", "panorama": "MIRRORBALL", "fov": 1.0, "focal": 1.0, "range": [0.0] * 4, "sensor": (1.0, 1.0), "polynomial": [0.0] * 5}
PATTERN = {"width": 1, "height": 1, "data": floats(3), "axes": [1, 0, 0, 0, 1, 0, 0, 0, 1]}
MOTION = "motion must be 12 numbers at each of 2 to 129 times"
SHAPES = "moved_positions must be all positions at each of 2 to 129 times"
DIFFUSE = {"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0], "color": (1, 1, 1)}
CURVE = {"type": "CURVE", "x": [0.0], "in": [0.0], "low": 0.0, "high": 1.0, "out": [(3,)]}


@pytest.mark.parametrize("path, value, message", [
    (("camera",), LENS | {"lens": (-1, 1)}, "camera: lens must be two lengths from 0 on"), (("camera",), LENS | {"lens": (1, -1)}, "camera: lens must be two lengths"),
    *((("camera", "motion"), floats(count), f"camera: {MOTION}") for count in (12, 25, 12 * 130)), (("instances", 0, "motion"), floats(12), r"instances\[0\]: " + MOTION),
    (("camera", "clip"), (2, 1), "clip must be two distances from 0 on, near before far"), (("camera", "panorama"), "NONE", None), (("camera",), ROUND | {"panorama": "FLAT"}, "camera: panorama must be one of "),
    *((("region",), region, "region must be x0, y0, x1, y1 inside of the picture") for region in ((-1, 0, 5, 5), (0, 0, 5, 17), (0, 0, 17, 5))),
    *((("region",), region, "region is empty") for region in ((5, 4, 5, 9), (9, 4, 5, 9), (4, 5, 9, 5))),
    (("meshes", 0, "positions"), floats(10), r"meshes\[0\]: positions must be 3 floats per position"),
    (("meshes", 0, "corner_position"), np.zeros(5, np.int32), r"meshes\[0\]: corner_position must be 3 indices per triangle"),
    *((("meshes", 0, "moved_positions"), floats(count), r"meshes\[0\]: " + SHAPES) for count in (12, 25, 12 * 130)),
    (("layers",), [{"width": 3}], r"layers\[0\]: width must be 2 or 4"), (("layers",), [{"width": 2}, {"width": 2, "tangents_of": 0}], r"layers\[1\]: tangents_of must be a layer of two numbers"),
    (("layers",), [{"width": 4}, {"width": 4, "tangents_of": 0}], r"layers\[1\]: tangents_of must be a layer of two numbers"), (("layers",), [{"width": 4, "tangents_of": 0}], r"layers\[0\]: tangents_of must be"),
    (("lights", 0, "pattern"), PATTERN, r"lights\[0\]: a sun shines one way and has no pattern"), (("lights", 1, "pattern"), PATTERN | {"face": True}, r"lights\[1\].pattern: face must be an area light"),
    (("lights", 1, "pattern"), PATTERN | {"axes": [1, 0, 0, 0, 0, 0, 0, 0, 1]}, r"lights\[1\].pattern: axes must be three directions"), (("lights", 1, "pattern"), PATTERN, None),
    (("lights", 1), area((0, 0, 1), direction=(0, 0, 0)), r"lights\[1\]: direction must be a direction"),
    (("lights", 1), spot((0, 0, 1), (0, 0, 0)), r"lights\[1\]: direction must be a direction"),
    *((("materials", 0, "weight"), weight, r"materials\[0\]: weight must be 3 operands: finite numbers, or registers \(0\) to \(255\)") for weight in (
        (0, 0), (0, 0, 0, 0), (0, 0, (-1,)), (0, 0, (256,)), (0, 0, (1, 2)), (0, 0, ()), (0, 0, "1"), (0, 0, 1e39), (0, 0, (0.5,)))),
    (("materials", 0, "weight"), (0, 0, (255,)), "weight: no node before has written register 255"),
    (("materials", 0, "nodes", 0), {"type": "GEOMETRY", "what": "NORMAL", "out": [(2,), (3,), (4,)]}, r"nodes\[0\]: out must be registers from 3 on"),
    (("materials", 0), {"name": "n", "nodes": [], "closures": [DIFFUSE | {"normal": (0, 0, 1)}]}, r"closures\[0\]: normal must be three registers"),
    (("images", 0), image(PIXELS) | {"width": 65536, "height": 65536}, r"images\[0\]: the image has too many pixels"),
    *((("cloths",), [{"preset": "denim", "size": 1.0, "counts": counts}], r"cloths\[0\]: counts must be two numbers from .01 to 10000") for counts in ((0.009, 1), (1, 10001), (-1, 1))),
    *((("cloths",), [{"preset": "denim", "repeats": repeats}], r"cloths\[0\]: repeats must be two numbers to a million") for repeats in ((1.1e6, 1), (1, -1.1e6))),
    (("materials", 0, "nodes", 0), {"type": "GEOMETRY", "what": "NORMAL", "shift": [0.0, 0.0], "out": [(3,), (4,), (5,)]}, r"nodes\[0\]: shift: only UV has one"),
    (("materials", 0), {"name": "two", "nodes": [], "closures": [DIFFUSE | {"own": [0, 0, 1]}]}, "own must be three registers"),
    (("materials", 0), {"name": "none", "nodes": [], "closures": []}, "closures has 0 items; 1 to "),
    *((("materials", 0, "nodes", 0), CURVE | {"table": floats(count)}, "table must be 2 to 65536 numbers") for count in (1, 65537))])
def test_malformed_parts_say_what_is_expected(path, value, message):
    """Whole messages; None: it is taken."""
    if message is None:
        native.free(native.start(change(path, value)))
        return
    with pytest.raises(ValueError, match=message):
        native.start(change(path, value))


NOT_GIVEN = [*((key,) for key in (
    "sky", "looks", "cloths", "scratches", "layers", "attributes", "planes", "mattes", "mist", "shutter", "line_time", "max_bounces", "diffuse_bounces", "transparent_max_bounces",
    "transparent_less", "caustics_reflective", "reach", "clear_glass", "filter_width", "pixel_filter_type", "vectors", "use_denoising", "time_limit", "adaptive_threshold")),
    *(("camera", key) for key in ("lens", "motion")), *(("lights", 1, key) for key in ("pattern", "link", "shade", "hidden", "met", "ball")),
    *(("materials", 0, key) for key in ("weight", "pass_color", "pass_index", "drawn", "turned", "closures", "normal")), *(("images", 0, key) for key in ("paged", "wide"))]


def test_none_is_what_is_not_given():
    plain, none = change(("seed",), 0), change(("seed",), 0)
    for path in NOT_GIVEN:
        at, other = none, plain
        for step in path[:-1]:
            at, other = at[step], other[step]
        at[path[-1]] = None
        other.pop(path[-1], None)
    expected = render(plain)[0]
    assert expected[..., :3].any() and np.array_equal(render(none)[0], expected)


def test_numbers_out_of_reach_are_the_nearest_within():
    """Seeds go round, as those of 32 bits do; a panorama's angles end at ten thousand, a light's brightness at 1e30."""
    noisy = {"lights": [sun(angle=1.0)]}

    def with_seed(seed):
        return render(scene(seed=seed, width=4, height=4, **noisy))[0]
    assert np.array_equal(with_seed(2**32 + 5), with_seed(5)) and np.array_equal(with_seed(-1), with_seed(2**32 - 1))
    assert not np.array_equal(with_seed(5), with_seed(-1))
    colors = image(np.random.default_rng(1).random((16, 16, 3)).astype(np.float32))

    def around(angle):
        camera = ROUND | {"panorama": "EQUIRECTANGULAR", "range": [-0.5, angle, -0.5, 0.5]}
        return render(scene(camera=camera, images=[colors], sky=sky(), meshes=[], transparent=False))[0]
    assert np.array_equal(around(1e6), around(1e4)) and np.array_equal(around(-1e6), around(-1e4)) and not np.array_equal(around(1e3), around(1e4))

    def lit(strength):
        return render(scene(width=4, height=4, lights=[point((0, 0, 2), (strength, 0, 1))]))[0]
    assert np.array_equal(lit(3e38), lit(1e30)) and not np.array_equal(lit(1e29), lit(1e30))


def test_cameras_that_some_things_cannot_have():
    """A dump is of a flat picture, and another look at a scene that is there stands still."""
    with pytest.raises(ValueError, match="camera: a dump needs one that is not panoramic"):
        native.start(change(("camera",), ROUND) | {"dump": "x"})
    given = scene(width=2, height=2, samples=1, apart=1)
    job = native.start(given)
    finish(job)
    moving = given["camera"] | {"motion": np.tile(np.float32([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3]) + floats(12), 2) + np.repeat(np.float32([0, 1]), 12)}
    with pytest.raises(ValueError, match="camera must be one that stands still"):
        native.look(job, {key: given[key] for key in ("width", "height", "samples", "region")} | {"camera": moving})
    native.free(job)


# What each number may be at least and at most, as export/ keeps to it; of what is whole the next ones are none
WHOLE = {("width",): (1, 65536), ("height",): (1, 65536), ("samples",): (1, 65536), ("threads",): (0, 256), ("sky_hidden",): (0, 15), ("max_bounces",): (0, 1024),
         ("diffuse_bounces",): (0, 1024), ("glossy_bounces",): (0, 1024), ("transmission_bounces",): (0, 1024), ("transparent_max_bounces",): (0, 1024),
         ("adaptive_min_samples",): (1, 65536), ("matte_slots",): (1, 16), ("attributes",): (0, 1 << 20), ("camera", "blades"): (0, 1024), ("lights", 1, "hidden"): (0, 14),
         ("lights", 1, "link"): (0, 29), ("lights", 1, "shade"): (0, 29), ("instances", 0, "link"): (0, 29), ("materials", 0, "pass_index"): (0, 32767),
         ("instances", 0, "pass_index"): (0, 32767), ("instances", 0, "hidden"): (0, 31), ("instances", 0, "unlit"): (0, 2**30 - 1), ("instances", 0, "shadeless"): (0, 2**30 - 1)}
NUMBERS = {("filter_width",): (0, 100), ("clear_glass",): (0, 1), ("time_limit",): (0, 1e9), ("texture_blur",): (0, 1e3), ("normal_blur",): (0, 1e3), ("line_time",): (0, 1),
           ("camera", "focus"): (1e-6, 1e18), ("camera", "turn"): (-1e3, 1e3), ("instances", 0, "random"): (0, 1), ("sample_clamp_direct",): (0, 1e30),
           ("sample_clamp_indirect",): (0, 1e30), ("adaptive_threshold",): (0, 1e30), ("light_sampling_threshold",): (0, 1e30), ("blur_glossy",): (0, 1e30), ("reach",): (0, 1e30)}


@pytest.mark.parametrize("path", [*WHOLE, *NUMBERS])
def test_what_a_number_may_be(path):
    def started(value):
        given = change(path, value)
        given.update(region=(0, 0, 1, 1), mattes=[{"type": "OBJECT"}], **{"samples": 1, "matte_slots": 1} | {path[0]: given[path[0]]})
        given["camera"] = {"lens": (0.1, 0.1), "focus": 1.0, "blades": 3, "turn": 0.0} | given["camera"]
        job = native.start(given)
        native.cancel(job)
        native.free(job)
    low, high = (WHOLE | NUMBERS)[path]
    for value in (low, high if path in WHOLE else min(high, float(np.float32(high)))):
        started(value)
    for value in (low - 1, high + 1) if path in WHOLE else (low - 0.001, 1.001 * high):
        with pytest.raises(ValueError, match=f"{path[-1]} must be (an integer )?from "):
            started(value)


def test_not_even_a_scene():
    for nonsense in (None, [], 5):
        with pytest.raises(ValueError, match="a dict is expected"):
            native.start(nonsense)
    for call in (native.poll, native.cancel, native.free, native.timings, native.slopes):
        with pytest.raises((ValueError, TypeError)):
            call(5)


def test_image_checks_its_buffer():
    job = native.start(scene())
    finish(job)
    for out in (np.zeros(5, np.float32), np.zeros((16, 16, 4)), np.zeros((16, 16, 4), np.int32)):
        with pytest.raises(ValueError, match="1024 float32"):
            native.image(job, out)
    for numbers, expected in ((5, pytest.raises(ValueError, match="1024 float32")), (1024, nullcontext())):
        out = array("f", [0] * numbers)
        with expected:
            native.image(job, out)
        out.append(0)  # which Python refuses where the module holds it still
    frozen = np.zeros((16, 16, 4), np.float32)
    frozen.flags.writeable = False
    with pytest.raises((ValueError, BufferError)):
        native.image(job, frozen)
    native.free(job)


@pytest.mark.parametrize(
    "changes",
    [
        {"meshes": []},
        {"meshes": [], "materials": [], "lights": []},
        {"instances": []},
        {"meshes": [mesh(np.zeros((0, 3)), np.zeros((0, 3), int), uvs=np.zeros((0, 2)))]},
        {"meshes": [mesh([[0, 0, 0]], [[0, 0, 0]], [[0, 0, 1]], [[0, 0]])]},  # no area
    ],
)
def test_empty_scenes_are_empty_pictures(changes, tmp_path):
    picture, _ = render(scene(**changes))
    assert (picture == 0).all()
    planes, _ = dump(scene(**changes), tmp_path / "d.exr")
    assert (planes["material.ID"] == -1).all()


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 1e30])
def test_bad_positions_lose_their_triangle_only(bad):
    plate = square()
    plate["positions"] = np.vstack([plate["positions"], [[bad, 0, 0]]]).astype(np.float32)
    plate["corner_position"][5] = 4  # the second triangle
    picture, _ = render(scene(meshes=[plate]))
    assert (picture[2, 13] > 0).all()  # in the first triangle, below the diagonal
    assert (picture[13, 2] == 0).all()


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 0.0])
def test_bad_normals_and_uvs_have_a_defined_result(bad, tmp_path):
    plate = square()
    plate["corner_normals"][:] = bad
    expected, _ = render(scene())
    picture, _ = render(scene(meshes=[plate]))
    np.testing.assert_allclose(picture, expected, rtol=1e-5)  # the facet's own normal
    textured = {
        "images": [image(np.random.default_rng(1).random((8, 8, 4)).astype(np.float32))],
        "materials": [material(normal_image=0, color_image=0)],
    }
    for wrap in ("REPEAT", "EXTEND", "CLIP"):
        textured["images"][0]["wrap"] = wrap
        for value in (bad, 1e30, -1e10):
            plate = square()
            plate["corner_uvs"][::2] = value
            render(scene(meshes=[plate], **textured))  # finite, no crash
            dump(scene(meshes=[plate], **textured), tmp_path / "d.exr")


def test_opposite_normals_of_corners_cancel_out(tmp_path):
    plate = square()
    plate["corner_normals"][::3] = (0, 0, -1)
    planes, _ = dump(scene(meshes=[plate], width=65, height=65), tmp_path / "d.exr")
    length = sum(planes[f"N.{c}"].astype(float) ** 2 for c in "XYZ")
    np.testing.assert_allclose(length, 1, atol=1e-6)


def test_singular_and_huge_instances():
    for matrix in (np.zeros((4, 4)), np.diag([1.0, 1, 0, 1]), np.diag([1e30, 1e30, 1e30, 1])):
        render(scene(instances=[{"mesh": 0, "matrix": matrix.ravel().tolist()}]))


def check(path):
    return subprocess.run([SHADE, "check", path], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("f0", [(1.5, 0.5, 0.5), (-1, 0.5, 0.5), (1e300, -1e300, 0.5)])
def test_dump_says_the_clamped_reflectance_that_was_shaded(f0, tmp_path):
    path = tmp_path / "d.exr"
    planes, header = dump(scene(materials=[material(f0=f0)]), path)
    clamped = np.clip(f0, 0, 1)
    assert json.loads(header)["materials"][0]["f0"] == clamped.tolist()
    assert (vectors(planes, "Color", "RGB") == clamped).all()
    done = check(path)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("word, given, low, high", [
    ("f82", (-1, 2, 0.5), 0, 1),
    ("eta", (-1, 1e4, 0.5), 1e-3, 100),
    ("k", (-1, 1e4, 3), 0, 100),
    ("kd", (-1, 2, 0.5), 0, 1),
])
def test_dump_says_other_clamped_colors(word, given, low, high, tmp_path):
    path = tmp_path / "d.exr"
    fresnel = {"f82": "F82", "eta": "CONDUCTOR", "k": "CONDUCTOR"}.get(word, "SCHLICK")
    _, header = dump(scene(materials=[material(fresnel=fresnel, **{word: given})]), path)
    assert json.loads(header)["materials"][0][word] == np.clip(given, low, high).tolist()
    done = check(path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_dump_says_the_clamped_texture_that_was_shaded(tmp_path):
    path = tmp_path / "d.exr"
    pixels = np.ones((8, 8, 4), np.float32)
    pixels[..., :3] = np.random.default_rng(1).choice([-3, 0, 1, 7], (8, 8, 3))
    planes, _ = dump(scene(images=[image(pixels)], materials=[material(color_image=0)]), path)
    color = vectors(planes, "Color", "RGB")
    assert color.min() == 0 and color.max() == 1
    done = check(path)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("given, shaded", [(0.0, 1e-4), (-1.0, 1e-4), (3e-4, 3e-4), (0.02, 0.02), (20.0, 10.0)])
def test_dump_says_the_clamped_roughness_that_was_shaded(given, shaded, tmp_path):
    """What nodes give, from 1e-4 to 10: head-on, facing the sun, a lobe's peak is F0 / (4 pi ax ay)."""
    path, out = tmp_path / "d.exr", [(3,)]
    said = {"type": "MATH", "operation": "ADD", "a": [given], "b": [0.0], "c": [0.0], "out": out}
    rough = material(mdf="GGX", brdf="MICROFACET", f0=(1, 1, 1)) | {"nodes": [said], "ax_from": out, "ay_from": out}
    planes, _ = dump(scene(width=4, height=4, materials=[rough]), path)
    for axis in "XY":
        np.testing.assert_allclose(planes[f"alpha.{axis}"], shaded, rtol=1e-6)
    np.testing.assert_allclose(planes["light0.S.R"], 1 / (4 * np.pi * shaded**2), rtol=2e-3)
    done = check(path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_normal_map_of_nan_and_below_the_surface():
    pixels = np.full((4, 4, 4), np.nan, np.float32)
    flat, _ = render(scene())
    picture, _ = render(scene(images=[image(pixels)], materials=[material(normal_image=0)]))
    np.testing.assert_allclose(picture, flat, rtol=1e-6)
    pixels[:] = 0.0  # points down and sideways
    render(scene(images=[image(pixels)], materials=[material(normal_image=0, normal_strength=1e6)]))


@pytest.mark.parametrize("number", [(0.0, 0.0), (1e38, 1e38), (-1e38, 1e38)])
def test_what_has_no_normal_is_black_and_told(number):
    """A normal that a graph makes of nothing, or of numbers too large; one that it makes well is not told of."""
    def plate(a, b):
        times = {"type": "MATH", "operation": "MULTIPLY", "a": [a], "b": [b], "c": [0.0], "out": [(150,)]}
        return scene(materials=[{**material(), "nodes": [times], "normal": [(150,)] * 3}], camera=ortho(0.5))
    words = "some samples had no valid direction or normal and are black"
    picture, state = render(plate(*number))
    assert state["warnings"] == [words] and (picture[..., :3] == 0).all() and (picture[..., 3] == 1).all()
    picture, state = render(plate(1.0, 1.0))
    assert state["warnings"] == [] and (picture[..., :3] > 0).all()


@pytest.mark.parametrize("bad, same", [(float("nan"), 0.0), (-1.0, 0.0), (float("-inf"), 0.0), (float("inf"), 1e18)])
def test_a_lamps_pattern_of_bad_numbers(bad, same):
    """None there; the rest of it shines."""
    def seen(value):
        data = np.full((8, 8, 3), 0.5, np.float32)
        data[3, 5] = (value, value, 0.5)  # below it
        lamp = point((0, 0, 1), (1e-18,) * 3 if same else (1,) * 3)
        return render(scene(lights=[lamp | {"pattern": {"width": 8, "height": 8, "axes": (0, 1, 0, 0, 0, 1, 1, 0, 0), "data": data.ravel()}}]))[0]
    assert np.array_equal(seen(bad), seen(same)) and not np.array_equal(seen(same), seen(0.5))


def test_extreme_materials_and_lights_stay_finite():
    for ex, ey in ((0.0, 0.0), (1e6, 1e6), (1e12, -5.0)):
        _, state = render(scene(materials=[material(ex=ex, ey=ey, f0=(2, -1, 0.5))]))
        assert any("clamped" in text for text in state["warnings"])
    render(scene(lights=[point((0, 0, 1e-30)), point((0, 0, 1e15), (1e30,) * 3), sun(angle=np.pi)]))
    for f0 in ((1, 1, 1), (0, 1, 1)):  # times a highlight's peak it would be no number
        for strength in (3e38, -3e38):
            render(scene(lights=[point((0, 0, 2), (strength, 0, 1))], materials=[material(ex=1e5, ey=1e5, f0=f0)]))
    render(scene(lights=[sun() for _ in range(40)]))


def test_dump_that_cannot_be_written(tmp_path):
    job = native.start(scene(dump=str(tmp_path / "no/such/folder/d.exr")))
    state = finish(job)
    assert state["state"] == "failed" and "no/such/folder/d.exr" in state["message"]
    out = np.empty((16, 16, 4), np.float32)
    native.image(job, out)  # the picture itself is there
    assert (out[..., 3] == 1).all()
    native.free(job)
