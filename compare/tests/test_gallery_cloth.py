# SPDX-License-Identifier: Apache-2.0
"""Cloth and fibres of the gallery: where points of a picture lie on the cloth, how they are lit, and formulas beside each other."""
from types import SimpleNamespace

import atlas_forms
import gallery_cloth as gallery
import numpy as np
import pytest

COST = 0.1


class Cloth:
    """Told what it is asked, and as bright as it is told."""

    def __init__(self, bright=0.22):
        self.bright = bright

    def eval(self, uv, wi, wo, footprint, tier=None):
        self.asked = SimpleNamespace(uv=uv, wi=wi, wo=wo, footprint=footprint, tier=tier)
        return np.full((*uv.shape[:2], 3), self.bright)


def test_directions():
    assert gallery.direction(90, 30) == pytest.approx((0, 0, 1)) and gallery.direction(30, 60) == pytest.approx((3**0.5 / 4, 0.75, 0.5))


def test_a_patch_lies_flat():
    """So many crossings across, v upwards, pixels at their middles, seen from straight above."""
    cloth = Cloth()
    made = gallery.flat(cloth, 4, 8.0, (30, 60), "near")
    asked = cloth.asked
    assert asked.uv[0].tolist() == [[1, 7], [3, 7], [5, 7], [7, 7]] and asked.uv[3, 0].tolist() == [1, 1] and (asked.footprint, asked.tier) == (2, "near")
    assert asked.wi == pytest.approx((3**0.5 / 4, 0.75, 0.5)) and asked.wo.tolist() == [0, 0, 1] and made.shape[:2] == (4, 4) and made.min() == 255
    gallery.flat(cloth, 9)
    assert (cloth.asked.footprint, cloth.asked.tier) == (1, "auto") and cloth.asked.wi == pytest.approx(gallery.direction(55, 120))


def test_cloth_hangs_round_a_cylinder():
    """The warp runs round it: arcs of v, frames that turn about x, footprints that stretch to the rim; dark where light or eye is behind."""
    cloth, size = Cloth(), 8
    made = gallery.hung(cloth, size, 16.0, (20, 100))
    asked = cloth.asked
    y = 0.98 * (1 - (2 * np.arange(size)[:, None] + 1) / size)
    turn = np.arcsin(y) * np.ones((1, size))
    assert asked.uv[..., 1] == pytest.approx(8 * turn) and asked.uv[0, :, 0] == pytest.approx(8 * ((2 * np.arange(size) + 1) / size - 1))
    normal, up = np.stack([0 * turn, np.sin(turn), np.cos(turn)], -1), np.stack([0 * turn, np.cos(turn), -np.sin(turn)], -1)
    for said, towards in ((asked.wi, gallery.direction(20, 100)), (asked.wo, np.array([0, 0, 1.0]))):
        assert np.allclose(said, np.stack([np.full_like(turn, towards[0]), up @ towards, normal @ towards], -1))
    assert np.allclose(asked.footprint, np.stack([np.full_like(turn, 2), 2 / np.cos(turn)], -1))
    lit = normal @ gallery.direction(20, 100) > 0
    assert not lit.all() and (made[..., :3].min(-1) == np.where(lit, 255, 0)).all()
    gallery.hung(cloth, size)
    assert cloth.asked.uv[0, -1, 0] == pytest.approx(30 * 7 / 8) and np.allclose(cloth.asked.wi[..., 0], gallery.direction(45, 150)[0])


def test_cloths_of_the_papers(monkeypatch):
    """Both yarns are alike but where a figure says so; nothing is darkened that does not ask for it."""
    monkeypatch.setattr(gallery.shade, "fabric", lambda **words: words)
    plain, twisted = gallery.cloth(), gallery.cloth((4, 1, 2), "tilt", "perturb", curve=0.6)
    assert plain["warp"] == plain["weft"] == gallery.YARN and (plain["pattern"], plain["occlusion"], plain["detail"], plain["horizon"]) == ((2, 1, 1), "none", "rotate", "hard")
    assert twisted["warp"] == twisted["weft"] == {**gallery.YARN, "curve": 0.6} and (twisted["pattern"], twisted["occlusion"], twisted["detail"]) == ((4, 1, 2), "tilt", "perturb")


def test_a_yarn_is_darkened_by_its_tilt(monkeypatch):
    """In the picture's own scale, whose gamma is 1.6; not the cross that marks the normal."""
    cross = np.array([213, 94, 0, 255], np.uint8)
    monkeypatch.setattr(gallery.gallery_metal, "disc", lambda lobe, n, size: np.array([[[200, 200, 200, 255], cross]], np.uint8))
    made = dict(gallery.yarn_lobes(None, 1))
    for tilt in (0.0, 0.3, 0.6):
        bright = int(200 * (1 - tilt) ** (1 / 1.6))
        assert made[f"tilt {tilt:g}"][0, 0].tolist() == [200, 200, 200, 255] and made[f"darkened, tilt {tilt:g}"].tolist() == [[[bright] * 3 + [255], cross.tolist()]]


def test_fibre_formulas():
    """As printed where that has a value, black from below; the library's maximum normal is √(1 − (l·t)²); Lambert's is the cosine."""
    random = np.random.default_rng(2)
    light = random.normal(size=(200, 3))
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    up, eye = np.abs(light) * (np.sign(light[:, :1]) * (1, 0, 0) + (0, 1, 1)), np.broadcast_to([0, 0, 1.0], light.shape)
    assert gallery.phi(gallery.PRINTED, up, eye) == pytest.approx(atlas_forms.fibre(up)) and not gallery.phi(gallery.PRINTED, -up, eye).any()
    most = np.sqrt(1 - up[:, 0]**2)
    assert gallery.phi("max_normal", up, eye) == pytest.approx(most) and gallery.phi(gallery.SCALED, up, eye) == pytest.approx(most * 2 / np.pi)
    assert gallery.phi("lambert", up, eye) == pytest.approx(up[:, 2]) and gallery.phi("fibre", up, eye) == pytest.approx((most + up[:, 2]) / np.pi)


def test_fibres_hide_each_other():
    """By rays over half cylinders side by side, walked along in small steps."""
    theta = np.pi * (np.arange(40) + 0.5) / 40 - np.pi / 2
    places = np.stack([np.sin(theta), np.cos(theta)], -1)

    def open_to(w):
        facing = places @ w
        way = places[:, None] + 1e-3 * places[:, None] + np.linspace(0, 6, 3000)[None, :, None] * w / np.linalg.norm(w)
        nearest = np.abs((way[..., 0] + 1) % 2 - 1)
        return np.where((facing > 0) & ~((nearest**2 + way[..., 1]**2 < 1) & (way[..., 1] > -1)).any(1), facing, 0)
    for elevation, azimuth, eye_elevation in ((50, 70, 60), (25, 100, 90), (15, 90, 30), (35, -60, 30)):
        light, eye = gallery.direction(elevation, azimuth), gallery.direction(eye_elevation, 90)
        lit, seen = open_to(light[1:]), open_to(eye[1:])
        assert gallery.fibres(light[None], eye[None], 40)[0] == pytest.approx((lit * seen).sum() / seen.sum(), rel=0.03)


@pytest.mark.parametrize("along", [True, False])
def test_spheres_of_fibres(along):
    """Lambert's is n·l whichever way fibres run; the maximum normal's is the light's part across the fibres, along latitudes or meridians."""
    light = np.array((0.5, 0.4, 0.75)) / np.linalg.norm((0.5, 0.4, 0.75))
    side = (np.arange(20) + 0.5) / 20 * 2.1 - 1.05
    x, y = np.meshgrid(side, -side)
    inside = 1 - x * x - y * y > 0
    n = np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 1e-6))], -1)
    lit = inside & (n @ light > 0)
    pixels, value = gallery.sphere_of("lambert", along, 20, (0.5, 0.4, 0.75))
    assert value == pytest.approx(np.where(lit, n @ light, 0), abs=1e-6) and pixels.shape[:2] == (20, 20)
    round_ = np.stack([n[..., 2], 0 * x, -x], -1)
    round_ /= np.linalg.norm(round_, axis=-1, keepdims=True)
    fibre = round_ if along else np.cross(n, round_)
    _pixels, value = gallery.sphere_of("max_normal", along, 20, (0.5, 0.4, 0.75))
    assert value[lit] == pytest.approx(np.sqrt(1 - (fibre @ light)**2)[lit], abs=1e-6) and not value[~lit].any()


def test_errors_of_fibre_models(monkeypatch):
    """Over the mean of the truth, lights evenly over the hemisphere; the worst is of one light; brightness of all."""
    lights = []
    monkeypatch.setattr(gallery, "fibres", lambda light, eye: lights.append((light, eye)) or np.where(np.arange(len(light)) == 0, 2.0, 0.5))
    monkeypatch.setattr(gallery, "phi", lambda model, light, eye: np.where(np.arange(len(light)) == 0, 2.3, 0.4))
    rows = gallery.diffuse_rows(3)
    assert [(row["kind"], row["elevation"], row["method"]) for row in rows] == [("diffuse", elevation, model) for elevation in (90, 60, 30) for model in (
        "lambert", "max_normal", "fibre", "fibre_view", "max_normal_scaled", "fibre_printed")]
    for row in rows:
        assert (row["error"], row["worst"], row["brightness"]) == (pytest.approx(0.5 / 3), pytest.approx(0.3), pytest.approx(1 + 0.1 / 3))
    assert [round(float(np.degrees(np.arcsin(eye[0, 2])))) for _light, eye in lights] == [90] + [60] * 7 + [30] * 7
    assert sorted(round(float(np.degrees(np.arctan2(eye[0, 1], eye[0, 0]))) % 360) for _light, eye in lights[1:8]) == [0, 45, 90, 135, 180, 225, 270]
    lights.clear()
    gallery.diffuse_rows(500)
    light = lights[0][0]
    assert np.linalg.norm(light, axis=1) == pytest.approx(np.ones(500)) and light.mean(0) == pytest.approx([0, 0, 0.5], abs=0.01) and (light[:, :2]**2).mean(0) == pytest.approx([1 / 3] * 2, abs=0.01)
