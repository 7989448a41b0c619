# SPDX-License-Identifier: Apache-2.0
"""The plate and the bumps are what they claim to be."""
import bumps
import numpy as np
import pytest

import plate

COST = 0.71


def test_exponents_of_the_issue():
    assert plate.EX == pytest.approx(6170.84, abs=5e-3)
    assert plate.EY == pytest.approx(7.876543, abs=5e-7)


def test_slopes_are_those_of_the_height():
    u, v = np.random.default_rng(3).random((2, 1000))
    e = 1e-6
    du, dv = plate.slopes(u, v)
    assert np.allclose((plate.height(u + e, v) - plate.height(u - e, v)) / (2 * e), du, atol=1e-8)
    assert np.allclose((plate.height(u, v + e) - plate.height(u, v - e)) / (2 * e), dv, atol=1e-8)


@pytest.mark.parametrize("surface", ["waves", "noise", "ridges", "letter"])
def test_reliefs_have_their_slopes_and_repeat(surface):
    u, v = np.random.default_rng(3).random((2, 1000))
    e, at = 1e-6, lambda u, v: plate.relief(surface, 1.5, u, v)
    height, du, dv = at(u, v)
    assert np.allclose((at(u + e, v)[0] - at(u - e, v)[0]) / (2 * e), du, atol=1e-7)
    assert np.allclose((at(u, v + e)[0] - at(u, v - e)[0]) / (2 * e), dv, atol=1e-7)
    assert np.allclose(at(u + 1, v - 2)[0], height)
    _, du, dv = at(*plate.grid(64))
    assert (np.hypot(du, dv).max() if surface != "noise" else np.sqrt(2 * (du**2 + dv**2).mean())) == pytest.approx(1.5, rel=.05)
    n = 2 * plate.relief_map(surface, 1.5, 64)[::-1] - 1
    assert np.allclose(-n[..., 0] / n[..., 2], du, atol=1e-5) and np.allclose(-n[..., 1] / n[..., 2], dv, atol=1e-5)
    positions, faces, uv = plate.relief_mesh(surface, 1.5, 8, 3)
    assert faces.shape == (192, 4) and faces.max() == len(positions) - 1 and positions[:, 1].min() == -1.5
    assert np.array_equal(positions[:, :2], uv - 0.5) and np.allclose(positions[:, 2], at(*uv.T)[0])


def test_normals_stand_on_the_surface():
    u, v = np.random.default_rng(4).random((2, 1000))
    n, (du, dv) = plate.normals(u, v), plate.slopes(u, v)
    assert np.allclose(np.linalg.norm(n, axis=-1), 1) and (n[:, 2] > 0).all()
    for along in (np.stack([np.ones_like(u), 0 * u, du], -1), np.stack([0 * u, np.ones_like(u), dv], -1)):
        assert np.abs((n * along).sum(-1)).max() < 1e-12


def test_steepest_slope():
    steepness = np.hypot(*plate.slopes(*plate.grid(800)))
    assert steepness.max() == pytest.approx(plate.SLOPE, rel=1e-3)
    assert steepness.max() <= plate.SLOPE


def test_sun_reaches_all_of_it():
    # A ray to the sun climbs faster than any slope, so it meets no other bump.
    assert np.linalg.norm(plate.SUN) == pytest.approx(1.0)
    assert plate.SUN[2] / np.hypot(*plate.SUN[:2]) > 1.5 * plate.SLOPE
    assert (plate.normals(*plate.grid(200)) @ plate.SUN).min() > 0.1


def test_normal_map_decodes_to_the_normals():
    rgb = plate.normal_map(64)
    assert rgb.dtype == np.float32 and rgb.min() >= 0.0 and rgb.max() <= 1.0
    u, v = plate.grid(64)
    assert np.allclose(2.0 * rgb[::-1] - 1.0, plate.normals(u, v), atol=1e-6)


def test_mesh_lies_on_the_surface():
    positions, normals, faces, uv = plate.mesh(16)
    assert faces.shape == (256, 4) and faces.max() == len(positions) - 1
    assert np.array_equal(positions[:, :2], uv - 0.5)
    assert np.allclose(positions[:, 2], plate.height(*uv.T))
    a, b, d = (positions[faces[:, i]] for i in (0, 1, 3))
    assert (np.cross(b - a, d - a)[:, 2] > 0.0).all(), "faces look up"
    assert (normals[:, 2] > 0.8).all()


@pytest.mark.parametrize("make", [bumps.hammered, bumps.grain])
def test_bumps_are_seamless_unit_normals(make):
    n = make(128)
    assert np.allclose(np.linalg.norm(n, axis=-1), 1.0)
    assert n[..., 2].min() > 0.5
    assert np.abs(n[..., :2].mean(axis=(0, 1))).max() < 5e-3, "no lean to one side"
    for axis in (0, 1):
        steps = np.abs(np.diff(n, axis=axis)).mean()
        seam = np.abs(n.take(0, axis) - n.take(-1, axis)).mean()
        assert seam < 2.0 * steps, "the tile's edge is no rougher than its inside"
    assert np.array_equal(n, make(128)), "the same every time"


def test_a_mesh_of_heights_lies_on_them_and_repeats():
    size = 50
    u, v = plate.grid(size)
    positions, faces, uv = plate.height_mesh(plate.height(u, v)[::-1])
    assert np.allclose(positions[:, 2], plate.height(*uv.T), atol=1e-12)
    assert np.allclose(positions[:, :2], uv - 0.5)
    # it covers the plate, its quads have the texels' area and face up
    assert uv.min() < 0 and uv.max() > 1
    a, b, d = (uv[faces[:, k]] for k in (0, 1, 3))
    along, up = (b - a).T, (d - a).T
    assert np.allclose(along[0] * up[1] - along[1] * up[0], 1 / size**2)


def test_creases_are_left_out():
    size, pixels = 512, 64
    u, v = plate.grid(size)
    slopes = np.stack([np.where(u < 0.5, 0.4 * u, 0.4 * u - 0.5), 0.2 * v], -1)
    n = np.concatenate([-slopes, np.ones_like(u)[..., None]], -1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    kept = plate.off_creases(0.5 + 0.5 * n[::-1], pixels)
    # one crease in the middle of each row, others where the slopes jump at the edges
    centre = (np.arange(pixels) + 0.5) / pixels
    near = np.minimum(np.abs(centre - 0.5), np.minimum(centre, 1 - centre)) < 2 / pixels
    assert not kept[:, near].any()
    assert kept[4:-4][:, np.minimum(np.abs(centre - 0.5), np.minimum(centre, 1 - centre))
                      > 4 / pixels].all()
    # without a margin: the texels on both sides of it
    kept = plate.off_creases(0.5 + 0.5 * n[::-1], size, margin=0)
    assert not kept[:, [size // 2 - 1, size // 2]].any()
    assert kept[1:-1, [size // 2 - 2, size // 2 + 1]].all()
    waves = plate.normal_map(1024)
    assert plate.off_creases(waves, pixels).all()


@pytest.mark.parametrize("size", [8, 32])
def test_same_normals_are_the_same(size):
    n = plate.normals(*plate.grid(size))
    places = plate.same_normals(size)
    assert len(places) == 8 * plate.PERIODS**2
    for picture in (n, n[::-1]):
        assert max(np.abs(picture[v, u] - picture).max() for u, v in places) < 1e-14
    # all of them: as many as a search finds, where slopes are not on an axis of symmetry
    at = 1, 2
    alike = {tuple(place) for place in np.argwhere(np.abs(n - n[at]).max(-1) < 1e-9)}
    assert {(v[at], u[at]) for u, v in places} == alike
    with pytest.raises(ValueError, match="multiple"):
        plate.same_normals(size + 4)
