# SPDX-License-Identifier: GPL-3.0-or-later
"""What the engine makes of a scene, against what the scene was built from."""

import math

import numpy as np
import pytest

from blender_runs import Dump, read_picture, rgba

COST = 5.5


def cosine(a, b):
    return np.clip((a * b).sum(-1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1), -1, 1)


@pytest.mark.parametrize("settings", [
    {"width": 64, "height": 40, "camera": {}},
    {"width": 40, "height": 64, "camera": {"lens": 35, "shift_x": 0.13, "shift_y": -0.07}},
    {"width": 64, "height": 40, "aspect": 1.7,
     "camera": {"sensor_fit": "VERTICAL", "sensor_height": 30, "shift_x": -0.2}},
    {"width": 64, "height": 40,
     "camera": {"type": "ORTHO", "ortho_scale": 5, "shift_x": 0.1, "shift_y": 0.05}},
], ids=["perspective", "portrait-shift", "vertical-aspect", "orthographic"])
def test_camera(blender, tmp_path, settings):
    """Every hit lies on the line through its pixel's centre, as Blender's view_frame has it."""
    told, _ = blender.scene("view", tmp_path, **settings)
    dump = Dump(tmp_path / "dump.exr")
    hit = dump.hit
    assert hit.mean() > 0.3
    corners = np.array(told["corners"])
    points = np.concatenate([dump["P"][hit].astype(float), np.ones((hit.sum(), 1))], 1)
    x, y, z, _ = (points @ np.array(told["to_camera"]).T).T
    if settings["camera"].get("type") != "ORTHO":
        x, y = x / -z * -corners[0, 2], y / -z * -corners[0, 2]
    low, high = corners.min(0), corners.max(0)
    width, height = settings["width"], settings["height"]
    rows, columns = np.nonzero(hit)
    pixel_x = (x - low[0]) / (high[0] - low[0]) * width
    pixel_y = (y - low[1]) / (high[1] - low[1]) * height
    assert np.abs(pixel_x - (columns + 0.5)).max() < 2e-3
    assert np.abs(pixel_y - (height - rows - 0.5)).max() < 2e-3


@pytest.mark.parametrize("shadow", [True, False])
def test_lights(blender, tmp_path, shadow):
    """Sun: strength × colour; point: power / 4π / d²; directions; the wall's shadow."""
    blender.scene("lights", tmp_path, shadow=shadow)
    dump = Dump(tmp_path / "dump.exr")
    floor = dump.hit & (np.abs(dump["P"][..., 2]) < 1e-4)
    point = dump["P"][floor].astype(float)
    lit = point[:, 0] > 0  # the wall stands at x = −2
    # A sun shines along −z of its object, turned by Euler angles x, y, z in this order.
    a, b, c = 0.4, -0.3, 0.2
    towards = np.array([
        math.cos(c) * math.sin(b) * math.cos(a) + math.sin(c) * math.sin(a),
        math.sin(c) * math.sin(b) * math.cos(a) - math.cos(c) * math.sin(a),
        math.cos(b) * math.cos(a)])
    assert np.abs(dump["light0.L"][floor] - towards).max() < 1e-5
    assert np.abs(dump["light0.E"][floor][lit] / (2.5 * np.array([1, 0.5, 0.25])) - 1).max() < 1e-5
    to_light = np.array([1, 1, 2]) - point
    squared = (to_light**2).sum(1, keepdims=True)
    expected = 100 / (4 * math.pi) * np.array([0.2, 0.4, 1]) / squared
    assert np.abs(dump["light1.E"][floor][lit] / expected[lit] - 1).max() < 1e-4
    assert np.abs(dump["light1.L"][floor] - to_light / np.sqrt(squared)).max() < 1e-4
    # From (−3, 0, 0.5) the wall, 2 wide and 2 high at x = −2, hides what is right behind it.
    behind = (np.abs(point[:, 0] + 1) < 0.5) & (np.abs(point[:, 1]) < 1)
    assert behind.sum() > 5
    energy = dump["light2.E"][floor][behind]
    assert (energy == 0).all() if shadow else (energy > 0).all()


@pytest.mark.parametrize("what", ["flat", "smooth", "custom"])
def test_normals(blender, tmp_path, what):
    blender.scene("mesh", tmp_path, what=what)
    dump = Dump(tmp_path / "dump.exr")
    hit = dump.hit
    point, normal = dump["P"][hit].astype(float), dump["N"][hit].astype(float)
    if what == "custom":
        angle = np.degrees(np.arccos(cosine(normal, np.array([0.6, 0, 0.8]))))
        assert np.median(angle) < 0.1
        return
    angle = np.degrees(np.arccos(cosine(normal, point)))
    # 80 faces: flat ones are off by up to half a face's width, smooth ones follow the ball
    # within what linear interpolation costs.
    assert angle.max() < 2 if what == "smooth" else angle.max() > 8
    if what == "flat":
        assert len(np.unique(normal.round(4), axis=0)) <= 40


def test_uvs_and_tangent(blender, tmp_path):
    """Blender's plane has UVs (0, 0) to (1, 1), so u runs along x."""
    blender.scene("mesh", tmp_path, what="plane")
    dump = Dump(tmp_path / "dump.exr")
    assert dump.hit.all()
    assert np.abs(dump["uv"] - (dump["P"][..., :2] + 1) / 2).max() < 1e-5
    assert np.abs(dump["T"] - [1, 0, 0]).max() < 1e-5
    assert np.abs(dump["N"] - [0, 0, 1]).max() < 1e-6


def test_slots_and_instances(blender, tmp_path):
    """Materials by slot, by object, by instance; one mesh may carry different ones."""
    blender.scene("slots", tmp_path)
    dump = Dump(tmp_path / "dump.exr")
    middle = dump["material"][6].reshape(8, 6)  # 6 pixels a unit, from x = −4
    assert (middle == middle[:, :1]).all()
    red, blue, own, blue_again, other, gap, other_again, gap_again = middle[:, 0]
    assert blue == blue_again and other == other_again and gap == gap_again == -1
    assert len({red, blue, own, other, gap}) == 5


@pytest.mark.parametrize("transparent", [True, False])
def test_film(blender, tmp_path, transparent):
    blender.scene("film", tmp_path, transparent=transparent)
    picture = rgba(tmp_path / "picture.exr")
    corner, middle = picture[0, 0], picture[32, 32]
    background = [0.05, 0.1, 0.2]
    assert middle[3] == pytest.approx(1)
    assert corner == pytest.approx([0, 0, 0, 0] if transparent else [*background, 1], abs=1e-6)
    if transparent:
        # The plane covers 1.03² of 2²: partial pixels count by their coverage.
        assert picture[..., 3].mean() == pytest.approx(1.03**2 / 4, rel=5e-3)
        assert ((picture[..., 3] > 0.01) & (picture[..., 3] < 0.99)).any()
    else:
        assert (picture[..., 3] > 0.9999).all()


def test_border(blender, tmp_path):
    """A border shows the same pixels as the whole picture; the crop holds only these."""
    blender.scene("border", tmp_path, border=False, crop=False, dump="")
    whole = rgba(tmp_path / "picture.exr")
    blender.scene("border", tmp_path, border=True, crop=False, dump="")
    part = rgba(tmp_path / "picture.exr")
    blender.scene("border", tmp_path, border=True, crop=True, dump="")
    crop = rgba(tmp_path / "picture.exr")
    x0, x1, y0, y1 = int(0.21 * 61), int(0.77 * 61), int(0.13 * 47), int(0.613 * 47)
    inside = np.s_[47 - y1:47 - y0, x0:x1]
    assert crop.shape == (y1 - y0, x1 - x0, 4)
    assert part.shape == whole.shape
    assert crop[..., 3].mean() > 0.2
    assert np.array_equal(part[inside], crop)
    assert np.abs(whole[inside] - crop).max() < 1e-5
    part[inside] = 0
    assert not part.any()


def test_view_layers(blender, tmp_path):
    """Each layer has its own objects."""
    blender.scene("layers", tmp_path, dump="")
    names, pixels = read_picture(tmp_path / "picture.exr")
    alpha = {layer: pixels[..., names.index(f"{layer}.Combined.A")] for layer in ("first", "second")}
    assert alpha["first"][16, 16] == pytest.approx(1)
    assert alpha["second"][16, 16] == 0
    assert 0 < alpha["second"].sum() < alpha["first"].sum()


@pytest.mark.parametrize("wiring", ["plain", "reroute", "uv map"])
@pytest.mark.parametrize("strength", [1.0, 0.5])
def test_normal_map(blender, tmp_path, wiring, strength):
    """Ns is the map's normal in the frame of x, y, z; strength mixes it with N."""
    x, y = 0.3, 0.2
    blender.scene("bump", tmp_path, tilt=(x, y), strength=strength, wiring=wiring)
    dump = Dump(tmp_path / "dump.exr")
    mapped = np.array([x, y, math.sqrt(1 - x * x - y * y)])
    # Blender: N + strength × (mapped − N), then unit length.
    expected = np.array([0, 0, 1]) + strength * (mapped - [0, 0, 1])
    expected /= np.linalg.norm(expected)
    assert np.abs(dump["Ns"] - expected).max() < 1e-3


def test_muted_normal_map(blender, tmp_path):
    """Muted, the Normal Map node does nothing: N stays (and the artist is told)."""
    _, text = blender.scene("bump", tmp_path, tilt=(0.3, 0.2), strength=1, wiring="mute")
    assert np.abs(Dump(tmp_path / "dump.exr")["Ns"] - [0, 0, 1]).max() < 1e-6


@pytest.mark.parametrize("kind", ["rgb", "byte", "float", "data"])
def test_color(blender, tmp_path, kind):
    """Reflectance at normal incidence: sRGB bytes are decoded, all else is linear."""
    blender.scene("color", tmp_path, kind=kind)
    color = Dump(tmp_path / "dump.exr")["Color"]
    expected = np.array([0.25, 0.5, 0.75])
    tolerance = 0.004 if kind == "data" else 1e-5
    if kind == "byte":
        expected = ((np.round(expected * 255) / 255 + 0.055) / 1.055) ** 2.4
        tolerance = 1e-3
    assert np.abs(color[16, 4] - expected).max() < tolerance
    if kind != "rgb":
        assert np.abs(color[16, 28, 0] - 1) < 1e-3 and color[16, 28, 1] < 1e-3
