# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open, against how long each point is covered, worked out by hand; vectors, holes, lights
for some objects, panoramas."""

import numpy as np
import pytest

from native_scenes import chance, few, mesh, native, ortho, persp, render, scene, sphere, square, sun

COST = 5.2

SIDE = 64
CENTERS = (np.arange(SIDE) + 0.5) * 2 / SIDE - 1  # of pixels, in a view from -1 to 1


def matrix(x=0.0, y=0.0, angle=0.0, size=1.0):
    c, s = size * np.cos(angle), size * np.sin(angle)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, size, 0]], np.float32)


def seen(samples=few(1024), **changes):
    """How much of each pixel is covered."""
    instance = {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), **changes.pop("instance", {})}
    given = scene(width=SIDE, height=SIDE, samples=samples, instances=[instance],
                  **{"meshes": [square(0.25)], **changes})
    return render(given)[0][..., 3]


def covered(low, high):
    """Of the pixels of a row by what reaches from `low` to `high` at the times of an even row."""
    edges = np.linspace(-1, 1, SIDE + 1)
    parts = [np.clip((np.minimum(b, edges[1:]) - np.maximum(a, edges[:-1])) * SIDE / 2, 0, 1)
             for a, b in zip(low, high)]
    return np.mean(parts, 0)


def test_a_square_moves():
    """From -.5 to 0 and on to .25, as long on both ways."""
    alpha = seen(instance={"motion": np.stack([matrix(-0.5), matrix(0), matrix(0.25)])})
    time = (np.arange(4096) + 0.5) / 4096
    middle = np.interp(time, [0, 0.5, 1], [-0.5, 0, 0.25])
    assert np.abs(alpha[26:38].mean(0) - covered(middle - 0.25, middle + 0.25)).max() < chance(4e-3)
    assert (alpha[:SIDE // 4] == 0).all()


def test_the_shutter_opens_slowly():
    """As x: half of the light comes in the last 1 - sqrt(1/2) of the time."""
    shutter = np.sqrt(np.linspace(0, 1, 257)).astype(np.float32)
    alpha = seen(instance={"motion": np.stack([matrix(-0.5), matrix(0.5)])}, shutter=shutter)
    time = np.sqrt((np.arange(4096) + 0.5) / 4096)
    assert np.abs(alpha[26:38].mean(0) - covered(time - 0.75, time - 0.25)).max() < chance(6e-3)


@pytest.mark.parametrize("line_time", [0.0, 0.25, 1.0])
def test_lines_see_one_after_another(line_time):
    """From the top, each for so long a part of the time; a shutter that opens slowly is one of each line."""
    shutter = np.sqrt(np.linspace(0, 1, 257)).astype(np.float32)
    alpha = seen(meshes=[square(4.0)], line_time=line_time, shutter=shutter,  # its right edge passes
                 instance={"motion": np.stack([matrix(-4.5), matrix(-3.5)])})
    part = np.sqrt((np.arange(4096) + 0.5) / 4096)
    for line in 0, 20, SIDE - 1:
        time = (1 - line_time) * (1 - line / SIDE) + line_time * part
        off = alpha[line] - covered(time * 0 - 2, time - 0.5)
        assert abs(off.sum()) < chance(0.08) and np.abs(off).max() < chance(0.025), line  # a line is .5 pixels, noise .03 and .01


def test_a_turn_goes_round():
    """A quarter of a turn from two places is an arc: all its points are as far from the middle."""
    thin = mesh([[0.6, -0.02, 0], [0.7, -0.02, 0], [0.7, 0.02, 0], [0.6, 0.02, 0]], [[0, 1, 2], [0, 2, 3]])
    alpha = seen(meshes=[thin], instance={"motion": np.stack([matrix(angle=0), matrix(angle=np.pi / 2)])})
    x, y = np.meshgrid(CENTERS, CENTERS)
    far = np.hypot(x, y)
    assert alpha[(far < 0.57) | (far > 0.74)].max() == 0
    # an arm .04 wide passes each point of the arc for .04 / r of a quarter turn
    inside = (far > 0.62) & (far < 0.68) & (x > 0.1) & (y > 0.1)
    expected = 0.04 / 0.65 / (np.pi / 2)
    assert alpha[inside].mean() == pytest.approx(expected, rel=chance(0.03))


@pytest.mark.parametrize("what", ["object", "camera"])
def test_a_turn_goes_at_an_even_pace(what):
    """Between two places nearly half a turn apart, as fast at the ends as in the middle; a camera turns the other way."""
    thin = mesh([[0.6, -0.02, 0], [0.7, -0.02, 0], [0.7, 0.02, 0], [0.6, 0.02, 0]], [[0, 1, 2], [0, 2, 3]])
    whole = np.radians(170)
    turns = np.stack([matrix(angle=0), matrix(angle=whole if what == "object" else -whole)])
    if what == "camera":
        turns[:, 2, 3] = 3
    moves = {"instance": {"motion": turns}} if what == "object" else {"camera": {**ortho(), "motion": turns}}
    alpha = seen(meshes=[thin], **moves)
    x, y = np.meshgrid(CENTERS, CENTERS)
    ring, at = np.abs(np.hypot(x, y) - 0.65) < 0.03, np.degrees(np.arctan2(y, x))
    for low in (5, 60, 115):
        assert alpha[ring & (at > low) & (at < low + 50)].mean() == pytest.approx(0.04 / 0.65 / whole, rel=chance(0.06)), low


def test_what_is_mirrored_moves():
    """To the right, as a plate that stays near the camera: what is farther than its origin is cut away."""
    motion = np.stack([matrix(-0.5), matrix(0.5)])
    motion[:, :, 0] *= -1
    alpha = seen(meshes=[square(0.25, z=0.5)], camera=ortho(clip=(0.1, 3)), instance={"motion": motion})
    time = (np.arange(4096) + 0.5) / 4096
    assert np.abs(alpha[26:38].mean(0) - covered(time - 0.75, time - 0.25)).max() < chance(4e-3)


def test_a_turn_takes_the_shorter_way():
    """What lies face down, which is half a turn about an axis of the plane, turns on by two degrees: not by 358. So does a
    camera that looks up."""
    thin = mesh([[0.6, -0.02, 0], [0.7, -0.02, 0], [0.7, 0.02, 0], [0.6, 0.02, 0]], [[0, 1, 2], [0, 2, 3]])
    above = {**thin, "positions": thin["positions"] + np.float32((0, 0, 2))}

    def down(axis):
        c, s = np.cos(2 * np.radians(axis)), np.sin(2 * np.radians(axis))
        return np.array([[c, s, 0, 0], [s, -c, 0, 0], [0, 0, -1, 0]], np.float32)

    def whole(axis):
        return np.vstack([down(axis), (0, 0, 0, 1)]).ravel().tolist()

    still = seen(meshes=[thin], instance={"matrix": whole(-45)})
    camera = {**ortho(1.0), "matrix": whole(-45)}
    up = seen(meshes=[above], camera=camera)
    assert up.sum() == pytest.approx(still.sum(), rel=chance(0.01))
    for axes in ((-44.5, -45.5), (-45.5, -44.5), (-44.5, -45, -45.5)):
        motion = np.stack([down(axis) for axis in axes])
        for alpha, sharp in ((seen(meshes=[thin], instance={"motion": motion}), still),
                             (seen(meshes=[above], camera={**camera, "motion": motion}), up)):
            assert alpha.sum() == pytest.approx(sharp.sum(), rel=chance(0.01))
            assert np.abs(alpha - sharp).sum() < 0.4 * sharp.sum()


def test_a_shape_changes():
    """A square whose right edge goes from .25 to .75; normals turn to the side meanwhile."""
    wide = square(0.25)
    places = np.stack([wide["positions"]] * 3)
    for step in range(3):
        places[step, 1:3, 0] += 0.25 * step
    normals = np.stack([wide["corner_normals"]] * 3)
    wide |= {"positions": np.ascontiguousarray(places[1]), "moved_positions": places, "moved_normals": normals}
    alpha = seen(meshes=[wide])
    time = (np.arange(4096) + 0.5) / 4096
    assert np.abs(alpha[26:38].mean(0) - covered(-0.25 + 0 * time, 0.25 + 0.5 * time)).max() < chance(4e-3)


def test_normals_turn_along():
    """What turns by 60 degrees about x under a light from above is lit by the mean cosine."""
    def tilted(angle):
        c, s = np.cos(angle), np.sin(angle)
        return np.float32([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0]])

    matt = {"name": "matt", "closures": [{"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0],
                                          "color": (1, 1, 1)}], "nodes": []}
    motion = np.stack([tilted(a) for a in np.linspace(-np.pi / 3, np.pi / 3, 3)])
    instance = {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "motion": motion}
    try:
        picture, _ = render(scene(width=16, height=16, samples=few(1024), materials=[matt], meshes=[square(4.0)],
                                  instances=[instance], camera=ortho(0.1)))
    except ValueError as error:
        pytest.fail(str(error))
    expected = np.sin(np.pi / 3) / (np.pi / 3) / np.pi
    assert picture[..., 0].mean() == pytest.approx(expected, rel=chance(5e-3))


def test_normals_follow_a_shear():
    """A plate tilted about y, of normal (nx, 0, nz), whose points come to move along x by up to twice their y: normals are
    (nx, -shear nx, nz) of some length."""
    nx, nz = 0.6, 0.8
    plate = mesh(np.array([[-2, -2], [2, -2], [2, 2], [-2, 2]]) @ [[nz, 0, -nx], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    matt = {"name": "matt", "closures": [{"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0],
                                          "color": (1, 1, 1)}], "nodes": []}
    motion = np.stack([np.float32([[1, shear, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]) for shear in (0, 2)])
    picture, _ = render(scene(samples=few(256), materials=[matt], meshes=[plate], camera=ortho(0.05), instances=[
        {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "motion": motion}]))
    shear = (np.arange(4096) + 0.5) / 2048
    expected = np.mean(nz / np.sqrt(1 + (shear * nx) ** 2)) / np.pi
    assert picture[..., 0].mean() == pytest.approx(expected, rel=chance(5e-3))


def test_the_camera_moves_and_zooms():
    """To the right by a quarter of what it sees, while that gets half as large."""
    camera = persp(1.0, eye=(0, 0, 1))
    motion = np.stack([np.float32([[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 1]]) for x in (0, 0.5)])
    frames = np.float32([[-1, 1, -1, 1], [-0.5, 0.5, -0.5, 0.5]])
    alpha = seen(camera={**camera, "motion": motion, "frames": frames})
    time = (np.arange(4096) + 0.5) / 4096
    half = 1 - 0.5 * time
    expected = covered((-0.25 - 0.5 * time) / half, (0.25 - 0.5 * time) / half)
    assert np.abs(alpha[26:38].mean(0) - expected).max() < chance(4e-3)


@pytest.mark.parametrize("far", [3e38, np.inf, np.nan])
def test_a_part_that_is_too_far_away(far):
    """Embree leaves it out: the rest of what moves with it looks the same (Blender 3.4 aborted)."""
    plate, pictures = square(1.0), []
    lost = mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, far, 0], [0, 1, 0.5], [1, 1, 0.5]],
                [[0, 1, 2], [0, 2, 3], [4, 5, 6]], np.float32([[0, 0, 1]] * 7), np.zeros((7, 2)))
    for one in (mesh(plate["positions"], plate["corner_position"].reshape(-1, 3), np.float32([[0, 0, 1]] * 4), np.zeros((4, 2))),
                lost):
        instance = {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "motion": np.stack([matrix(-0.1), matrix(0.1)])}
        pictures.append(render(scene(meshes=[one], instances=[instance], background=(0.5, 0.5, 0.5), max_bounces=2,
                                     transparent=False))[0])
    assert pictures[0].std() > 0
    np.testing.assert_allclose(pictures[1], pictures[0], rtol=1e-5)


@pytest.mark.parametrize("motion", [
    np.full((3, 12), np.nan), np.full((2, 12), np.inf), np.zeros((2, 12)), np.full((5, 12), 1e30),
    np.stack([matrix().ravel(), matrix(size=1e-30).ravel()])])
def test_places_that_are_none(motion):
    """It stays where it is, with a word about it where it would move."""
    given = scene(width=16, height=16, instances=[
        {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "motion": np.float32(motion)}])
    picture, state = render(given)
    assert (picture[..., 3] == 1).all()
    assert "is not blurred" in "".join(state["warnings"])


@pytest.mark.parametrize("changes, message", [
    ({"motion": np.zeros((1, 12), np.float32)}, "motion must be 12 numbers"),
    ({"motion": np.zeros((2, 11), np.float32)}, "motion must be 12 numbers"),
    ({"motion": np.zeros((200, 12), np.float32)}, "motion must be 12 numbers"),
])
def test_wrong_lengths(changes, message):
    given = scene(instances=[{"mesh": 0, "matrix": np.eye(4).ravel().tolist(), **changes}])
    with pytest.raises(ValueError, match=message):
        native.start(given)


@pytest.mark.parametrize("positions, normals, message", [
    (np.zeros((2, 5, 3)), np.zeros((2, 6, 3)), "moved_positions must be all positions"),
    (np.zeros((3, 4, 3)), np.zeros((2, 6, 3)), "moved_normals"),
])
def test_shapes_of_other_lengths(positions, normals, message):
    given = scene(meshes=[{**square(), "moved_positions": np.float32(positions),
                           "moved_normals": np.float32(normals)}])
    with pytest.raises(ValueError, match=message):
        native.start(given)


@pytest.mark.parametrize("value", [np.nan, np.inf, -1e30])
def test_shapes_of_no_numbers(value):
    places = np.stack([square()["positions"]] * 3)
    places[0] = value
    normals = np.full((3, 6, 3), value, np.float32)
    assert np.isfinite(render(scene(meshes=[{**square(), "moved_positions": places, "moved_normals": normals}]))[0]).all()
    assert np.isfinite(seen(16, shutter=np.full(257, np.nan, np.float32),
                            instance={"motion": np.stack([matrix(-0.5), matrix(0.5)])})).all()


def test_loose_triangles_of_two_meshes():
    """One that bends after one that does not, neither with two triangles to a quad: each keeps its own normals."""
    def loose(count, z, size, seed):
        corner = np.random.default_rng(seed).uniform(-0.9, 0.6, (count, 1, 2))
        flat = corner + np.array([[0, 0], [size, 0], [0, size]])
        points = np.concatenate([flat, np.full((count, 3, 1), z)], -1).reshape(-1, 3)
        return mesh(points.tolist(), np.arange(3 * count).reshape(-1, 3).tolist())
    still, bent = loose(500, -1.0, 0.01, 1), loose(40, 0.0, 0.3, 2)
    places = np.stack([np.asarray(bent["positions"], np.float32).reshape(-1, 3)] * 3)
    normals = np.stack([np.asarray(bent["corner_normals"], np.float32)] * 3)
    places[2, :, 0] += 0.01
    matt = {"name": "matt", "nodes": [],
            "closures": [{"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0], "color": (1, 1, 1)}]}

    def picture(changes):
        meshes = [still, {**bent, **changes}]
        return render(scene(width=32, height=32, samples=64, materials=[matt], meshes=meshes, lights=[sun()],
                            instances=[{"mesh": k, "matrix": np.eye(4).ravel().tolist()} for k in range(2)]))[0]
    plain, moved = picture({}), picture({"moved_positions": places, "moved_normals": normals})
    whole = (plain[..., 3] == 1) & (moved[..., 3] == 1)
    assert whole.sum() > 50
    np.testing.assert_allclose(moved[whole], plain[whole], rtol=1e-5)


def test_vectors():
    """A square that came by a quarter of the picture to the right, and goes on by half of it upwards; in pixels."""
    motion = np.stack([matrix(-0.5), matrix(), matrix(0, 1)])
    job = native.start(scene(width=16, height=16, samples=4, vectors=True, planes=[{"type": "VECTOR"}], instances=[
        {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "motion": motion}]))
    assert native.wait(job, 60)
    vectors = np.zeros((16, 16, 4), np.float32)
    native.image(job, vectors, "VECTOR")
    native.free(job)
    np.testing.assert_allclose(vectors, np.broadcast_to([-4, 0, 0, -8], vectors.shape), atol=1e-4)


def vectors_of(**changes):
    job = native.start(scene(width=16, height=16, samples=4, vectors=True, planes=[{"type": "VECTOR"}], **changes))
    assert native.wait(job, 60)
    found = np.zeros((16, 16, 4), np.float32)
    native.image(job, found, "VECTOR")
    native.free(job)
    return found


@pytest.mark.parametrize("apart", [0, 1])
@pytest.mark.parametrize("others", [[], [sphere(4, center=(9, 0, 0))], [sphere(4, center=(9, 0, 0)), square(0.1, -5.0)]])
def test_vectors_of_what_turns(others, apart):
    """Each point its own, whatever other meshes there are: by -.5 before, by .7 afterwards."""
    own = [{"mesh": k, "matrix": np.eye(4).ravel().tolist()} for k in range(len(others) + 1)]
    own[-1] |= {"motion": np.stack([matrix(angle=angle) for angle in (-0.5, 0, 0.7)])}
    found = vectors_of(meshes=[*others, square(2.0)], instances=own, apart=apart)
    at = np.stack(np.meshgrid(np.arange(16) - 7.5, np.arange(16) - 7.5), -1)
    before, after = (at @ matrix(angle=angle)[:2, :2].T for angle in (-0.5, 0.7))
    expected = np.concatenate([before - at, at - after], -1)
    np.testing.assert_allclose(found, expected, atol=0.55)  # at its first sample


@pytest.mark.parametrize("kind", ["EQUIRECTANGULAR", "FISHEYE_EQUIDISTANT"])
def test_panoramas_have_no_vectors(kind):
    """Though what they see moves, and a flat picture has its vectors: those are places in a plane."""
    moves = {"mesh": 0, "matrix": np.eye(4).ravel().tolist(), "motion": np.stack([matrix(-0.5), matrix(), matrix(0, 1)])}
    around = ortho() | {"type": "PANO", "panorama": kind, "fov": 0.6, "focal": 1.0, "range": [-0.3, 0.3, -0.3, 0.3],
                        "sensor": (1.0, 1.0), "polynomial": [0.0] * 5, "frame": [0, 1, 0, 1]}
    flat, none = (vectors_of(camera=camera, meshes=[square(9.0)], instances=[moves]) for camera in (ortho(), around))
    assert (np.abs(flat).max(-1) > 1).all() and (none == 0).all()


def test_what_was_beside_the_camera_has_no_vector():
    """Nor will it have one where it comes there: no number says how far it moved. What moves else has its own."""
    def eye(z):
        return np.hstack([np.eye(3), [[0], [0], [z]]]).ravel()
    still = vectors_of(camera=persp() | {"motion": np.float32([eye(0), eye(3), eye(3)])})
    assert np.isfinite(still).all() and (still == 0).all()
    again = vectors_of(camera=persp() | {"motion": np.float32([eye(3), eye(3), eye(0)])})
    assert np.isfinite(again).all() and (again == 0).all()
    moved = vectors_of(camera=persp() | {"motion": np.float32([eye(0), eye(3), eye(6)])})
    assert (moved[..., :2] == 0).all() and (moved[..., 2:] != 0).any()


def test_vectors_of_cameras_and_of_shapes():
    """A camera that came from the left and goes on upwards sees the opposite; one that sees half as wide each time moves all away from the middle;
    a shape moves as an object does."""
    def eye(x, y):
        return np.hstack([np.eye(3), [[x], [y], [3]]]).ravel()
    moving = np.float32([eye(-0.5, 0), eye(0, 0), eye(0, 1)])
    np.testing.assert_allclose(vectors_of(camera=ortho() | {"motion": moving}), np.broadcast_to([4, 0, 0, 8], (16, 16, 4)), atol=1e-4)
    frames = np.float32([(-h, h, -h, h) for h in (2, 1, 0.5)])
    zooming = vectors_of(camera=ortho() | {"motion": np.float32([eye(0, 0)] * 3), "frames": frames})
    x, y = np.meshgrid(np.arange(16) - 7.5, np.arange(16) - 7.5)
    np.testing.assert_allclose(zooming, np.stack([-x / 2, -y / 2, -x, -y], -1), atol=0.55)  # at its first sample
    plate = square()
    positions = np.asarray(plate["positions"], np.float32).reshape(-1)
    moved = np.stack([positions + np.tile(np.float32(by), len(positions) // 3) for by in ((-0.5, 0, 0), (0, 0, 0), (0, 1, 0))])
    bent = plate | {"moved_positions": moved, "moved_normals": np.stack([np.asarray(plate["corner_normals"], np.float32).ravel()] * 3)}
    np.testing.assert_allclose(vectors_of(meshes=[bent]), np.broadcast_to([-4, 0, 0, -8], (16, 16, 4)), atol=1e-4)


@pytest.mark.parametrize("transparent", [True, False])
def test_a_hole(transparent):
    """Three quarters of it; the sky behind is not seen there."""
    held = {"name": "held", "closures": [{"closure": "EMISSION", "holds": True, "weight": [0.75] * 3}], "nodes": []}
    picture, _ = render(scene(materials=[held], meshes=[square(0.5)], transparent=transparent, background=(2, 2, 2)))
    assert (np.abs(picture[8, 8] - (0, 0, 0, 0.25)) < 1e-6).all()
    assert (picture[0, 0] == ((0, 0, 0, 0) if transparent else (2, 2, 2, 1))).all()


def test_a_light_for_some():
    left, right = (np.float32([[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]).ravel().tolist() for x in (-0.5, 0.5))
    matt = {"name": "matt", "closures": [{"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0],
                                          "color": (1, 1, 1)}], "nodes": []}
    for lights in (1, 6):  # all of them, or one a sample
        picture, _ = render(scene(materials=[matt], meshes=[square(0.5)], lights=[sun() | {"link": 3}] * lights, instances=[
            {"mesh": 0, "matrix": left}, {"mesh": 0, "matrix": right, "unlit": 1 << 3}]))
        assert picture[8, 4, 0] == pytest.approx(lights / np.pi, rel=1e-3) and picture[8, 12, 0] == 0


@pytest.mark.parametrize("bounces", [0, 4])
@pytest.mark.parametrize("lights", [1, 6])
def test_a_light_that_some_do_not_shade(lights, bounces):
    """Of three roofs one shades all, and what it does not shade is no lamp of these; one does not shade the first lamp,
    however few transparent surfaces light may pass; the third is halfway transparent. All of the lamps, or one a sample."""
    left, right, middle = (np.float32([[0.2, 0, 0, x], [0, 0.2, 0, 0], [0, 0, 1, 0.3], [0, 0, 0, 1]]).ravel().tolist()
                           for x in (-0.6, 0.6, 0.0))
    matt = {"name": "matt", "closures": [{"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0],
                                          "color": (1, 1, 1)}], "nodes": []}
    half = {"name": "half", "closures": [{"closure": "TRANSPARENT", "weight": [0.5] * 3}], "nodes": []}
    lamps = [sun() | {"shade": 5}] + [sun() for _ in range(lights - 1)]
    picture, _ = render(scene(width=20, height=20, materials=[matt, half], lights=lamps, samples=64 * lights, max_bounces=0,
                              transparent_max_bounces=bounces, camera=ortho(eye=(0, 0, 0.2)),
                              meshes=[square(1.0), square(1.0, material_index=0), square(1.0, material_index=1)],
                              instances=[{"mesh": 0, "matrix": np.eye(4).ravel().tolist()},
                                         {"mesh": 1, "matrix": left, "shadeless": 1 << 6},
                                         {"mesh": 1, "matrix": right, "shadeless": 1 << 5},
                                         {"mesh": 2, "matrix": middle}]))
    below = [picture[9:11, at, 0].mean() * np.pi for at in (4, 16, 10)]
    assert picture[2, 2, 0] * np.pi == pytest.approx(lights, rel=0.02)
    assert below[0] == 0 and below[1] == pytest.approx(1, rel=0.15 if lights > 1 else 1e-3)
    assert below[2] == pytest.approx(0.5 * lights if bounces else 0, rel=0.02)


@pytest.mark.parametrize("kind", ["EQUIRECTANGULAR", "EQUIANGULAR_CUBEMAP_FACE", "MIRRORBALL", "FISHEYE_EQUIDISTANT",
                                  "FISHEYE_EQUISOLID", "FISHEYE_LENS_POLYNOMIAL", "CENTRAL_CYLINDRICAL"])
@pytest.mark.parametrize("number", [0.0, 1e30, -1e30])
def test_panoramas_of_extreme_numbers(kind, number):
    camera = {**ortho(), "type": "PANO", "panorama": kind, "range": [number] * 4, "fov": 100.0 if number else 0.0,
              "focal": 1e-6, "sensor": (number, number), "polynomial": [number] * 5, "frame": [0, number, number, 1],
              "lens": (1e17, 0.1), "focus": 1e-6, "blades": 3, "turn": 1.0}
    render(scene(camera=camera, samples=2, planes=[{"type": name} for name in ("DEPTH", "DISTANCE", "VECTOR", "HELD")]))


def test_what_a_panorama_does_not_see():
    """A fisheye's rim through the corner between two tiles: all of one is lit, then comes the other, beyond the rim."""
    matt = {"name": "matt", "closures": [{"closure": "DIFFUSE", "model": "OREN_NAYAR", "roughness": [0.0],
                                          "color": (1, 1, 1)}], "nodes": []}
    rim = np.sin(0.5) / np.sqrt(2)
    x, y = 0.5 - rim, 0.5 + rim
    camera = {**ortho(), "type": "PANO", "panorama": "FISHEYE_EQUISOLID", "fov": 2.0, "focal": 0.5, "range": [0.0] * 4,
              "sensor": (1.0, 1.0), "polynomial": [0.0] * 5, "frame": [x - 0.05, x + 0.05, y - 0.05, y + 0.05]}
    picture, _ = render(scene(camera=camera, width=32, height=32, threads=1, transparent=False, materials=[matt],
                              meshes=[square(99.0)]))
    assert (picture[:16, 16:, 0] > 0.3).all() and (picture[16:, :16] == (0, 0, 0, 1)).all()
