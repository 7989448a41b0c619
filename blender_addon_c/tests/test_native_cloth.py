# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloth in the whole engine: beside the reference, yarn by yarn and from afar."""

import subprocess

import numpy as np
import pytest

from native_scenes import (ROOT, SANITIZED, dump, image, material, mesh, native, ortho, persp, registers, render, scene,
                           square, sun, unit)

COST = 5.4

PLACE, COVERAGE = registers(3, 4), registers(7, 1)
SHADE = ROOT / "build/shade"


def cloth(preset="denim", size=0.02, transmit=0.0, open=False, **colors):
    return {"preset": preset, "size": size, "transmit": transmit, "open": open, **colors}


def fabric(index=0, nodes=(), open=False, **fed):
    """A material of one cloth."""
    given = {"cloth": index, "place": PLACE, **fed}
    nodes = [*nodes, {"type": "WEAVE", "cloth": index, "out": PLACE},
             {"type": "CLOTH", "out": COVERAGE, **given}]
    made = {"name": "cloth", "closure": "FABRIC", "coverage": COVERAGE, **given}
    if not open:
        return made | {"nodes": nodes}
    rest = registers(8, 1)
    nodes.append({"type": "MATH", "operation": "SUBTRACT", "a": [1.0], "b": COVERAGE, "c": [0.0], "out": rest})
    made.pop("name")
    return {"name": "cloth", "nodes": nodes, "closures": [
        made, {"closure": "TRANSPARENT", "weight": rest * 3}]}


def asked(preset, queries):
    """`shade fabric`: f cos for lines of u, v, footprint, wi, wo."""
    text = "\n".join(" ".join(f"{x:.9g}" for x in row) for row in queries)
    done = subprocess.run([SHADE, "fabric", preset], input=text, capture_output=True, text=True, check=True)
    return np.array([[float(x) for x in line.split()[:3]] for line in done.stdout.splitlines()])


def checked(path):
    done = subprocess.run([SHADE, "check", path], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


WAVES = image(np.dstack([np.float32(0.5 + 0.2 * np.sin(np.mgrid[:16, :16] * 0.7)[k]) for k in (0, 1)]
                        + [np.full((16, 16), 0.9, np.float32)]))
TILTED = {"type": "NORMAL_MAP", "image": 0, "strength": 1.0, "out": registers(10, 3)}


def plates(size, side, lights):
    """Four, before a camera: open linen, translucent flannel, taffeta in own colours with folds, metal;
    two of them on mirrored UV maps."""
    corners = 0.45 * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    uvs = np.float32([(0, 0), (1, 0), (1, 1), (0, 1)])
    meshes = [mesh(corners + (x, y, 0), [[0, 1, 2], [0, 2, 3]], uvs=uvs * (mirror, 1), materials=k)
              for k, (x, y, mirror) in enumerate([(-.5, -.5, 1), (.5, -.5, -1), (-.5, .5, -1), (.5, .5, 1)])]
    cloths = [cloth("linen", size, open=True), cloth("wool_flannel", size, transmit=0.3),
              cloth("shot_taffeta", size, warp=(0.7, 0.1, 0.2), weft=(0.1, 0.3, 0.8))]
    folded = fabric(2, [TILTED], normal=registers(10, 3))
    return scene(images=[WAVES], cloths=cloths, materials=[fabric(0, open=True), fabric(1), folded, material()],
                 meshes=meshes, width=side, height=side, camera=persp(0.2, (2, -3.75, 5)), lights=lights)


def test_the_reference_agrees_on_yarns(tmp_path):
    planes, _ = dump(plates(0.0015, 48, [sun((0.3, 0.2, 0.9)), sun((-2, 0.3, 1))]), tmp_path / "d.exr")
    assert "apart" not in checked(tmp_path / "d.exr")
    number = planes["material.ID"]
    assert {0, 1, 2, 3} <= set(np.unique(number))
    linen = planes["coverage.A"][number == 0]
    assert linen.min() < 0.5 and linen.max() == 1 and (planes["coverage.A"][np.isin(number, (1, 2))] == 1).all()
    # the pixel's extent is what the place says, from one pixel to the next
    for at, wide in (("uv.U", "foot.U"), ("uv.V", "foot.V")):
        at, wide = planes[at], planes[wide]
        inner = (number[1:-1, 1:-1] == 1) & (number[1:-1, 2:] == 1) & (number[2:, 1:-1] == 1)
        step = np.hypot(at[1:-1, 2:] - at[1:-1, 1:-1], at[2:, 1:-1] - at[1:-1, 1:-1])[inner]
        np.testing.assert_allclose(wide[1:-1, 1:-1][inner], step, rtol=0.03)


def test_the_reference_agrees_from_afar(tmp_path):
    given = plates(0.5, 8, [sun((0.3, 0.2, 0.9))])
    given["meshes"], given["instances"] = given["meshes"][:2], given["instances"][:2]
    planes, _ = dump(given, tmp_path / "d.exr")
    assert planes["foot.U"].max() > 100 and checked(tmp_path / "d.exr").count("cloth far") == 2


def test_the_denoiser_s_albedo_is_both_yarns():
    """The mean of their colours."""
    warp, weft = (0.8, 0.2, 0.1), (0.1, 0.4, 0.6)
    job = native.start(scene(cloths=[cloth("silk_shantung", warp=warp, weft=weft)], materials=[fabric()], width=4, height=4, planes=[{"type": "ALBEDO"}]))
    assert native.wait(job, 60)
    albedo = np.zeros((4, 4, 3), np.float32)
    native.image(job, albedo, "ALBEDO")
    native.free(job)
    np.testing.assert_allclose(albedo, np.broadcast_to(np.add(warp, weft) / 2, albedo.shape), rtol=1e-5)


def test_an_even_sky_gives_the_albedo():
    """From afar, by quadrature over what `shade fabric` says, through draws and lights alike."""
    wo = unit(np.array((0.5, 0.2, 0.7)))
    n = 48
    z, turn = (np.arange(n) + 0.5) / n, (np.arange(2 * n) + 0.5) / n * np.pi
    z, turn = np.meshgrid(z, turn, indexing="ij")
    wi = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], -1).reshape(-1, 3)
    rows = np.c_[np.zeros((len(wi), 2)), np.full(len(wi), 50.0), wi, np.tile(wo, (len(wi), 1))]
    expected = asked("silk_shantung", rows).mean(0) * 2 * np.pi
    given = scene(cloths=[cloth("silk_shantung", 10.0)], materials=[fabric()], meshes=[square(1.5)],
                  camera=ortho(0.5, tuple(3 * wo)), lights=[], background=(1, 1, 1), max_bounces=1, samples=64)  # chance: .07 %
    picture, _ = render(given)
    np.testing.assert_allclose(picture[..., :3].mean((0, 1)), expected, rtol=0.01)
    picture, _ = render(given | {"camera": ortho(0.5)})
    np.testing.assert_allclose(picture[..., :3].mean((0, 1)), native.cloth_albedo("silk_shantung"), rtol=0.05)
    with pytest.raises(ValueError, match="no cloth 'chiffon'"):
        native.cloth_albedo("chiffon")


def test_from_afar_it_is_as_bright_as_from_near():
    """A whole repeat's mean, yarn by yarn, and from ever farther away, under one sun."""
    lights = [sun((0.4, 0.3, 0.8), (3, 3, 3))]
    seen = []
    for side in (256, 32, 4):  # of 128 crossings, on either side
        given = scene(cloths=[cloth("denim", 1.28 / 25)], materials=[fabric()], meshes=[square(1.0)], lights=lights,
                      width=side, height=side, camera=ortho(1.0), samples=max(1, 256 // side))
        seen.append(render(given)[0][..., :3].mean((0, 1)))
    for other in seen[1:]:
        np.testing.assert_allclose(other, seen[0], rtol=0.03)


def test_open_gaps_show_what_is_behind(tmp_path):
    """The picture's alpha is the dump's coverage, which the reference has checked."""
    given = scene(cloths=[cloth("linen", 0.01, open=True)], materials=[fabric(open=True)], samples=1024,
                  lights=[sun()], max_bounces=2, width=8, height=8, camera=ortho(0.9))
    picture, _ = render(given)
    planes, _ = dump(given, tmp_path / "d.exr")
    assert planes["coverage.A"].mean() < 0.98
    assert picture[..., 3].mean() == pytest.approx(planes["coverage.A"].mean(), abs=0.004)


def test_light_comes_through():
    """A sun behind: 0 without translucency; with it what leaves there, of the share that does."""
    seen = {}
    for transmit in (0.0, 0.5, 1.0):
        given = scene(cloths=[cloth("linen", 1.0, transmit=transmit, warp=(.6, .6, .6), weft=(.6, .6, .6))],
                      materials=[fabric()], lights=[sun((0, 0, -1), (np.pi,) * 3)], width=4, height=4,
                      camera=ortho(0.5))
        seen[transmit] = render(given)[0][..., 0].mean()
    assert seen[0.0] == 0 and seen[1.0] == pytest.approx(2 * seen[0.5], rel=0.05)
    assert 0.2 < seen[1.0] < 0.6


def test_textures_colour_each_yarn():
    """A colour by the UV map: as a cloth of that colour where the map has it."""
    uv = registers(10, 3)
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": uv}]
    plain = {"lights": [sun((0.3, 0.2, 0.9))], "samples": 64, "meshes": [square(1.0)], "camera": ortho(0.99)}
    picture, _ = render(scene(cloths=[cloth("denim", 0.5)], materials=[
        fabric(nodes=nodes, warp_from=[uv[0], 0.2, 0.1], weft_from=[0.5, uv[1], 0.1])], **plain))
    u, v = (4 + 0.5) / 16, (11 + 0.5) / 16
    own = scene(cloths=[cloth("denim", 0.5, warp=(u, 0.2, 0.1), weft=(0.5, v, 0.1))], materials=[fabric()],
                **plain)
    np.testing.assert_allclose(picture[11, 4, :3], render(own)[0][11, 4, :3], rtol=0.06)
    assert picture[8, 14, 0] > 1.5 * picture[8, 1, 0]


def test_however_many_runs_the_picture_is_one():
    """More cloths in a batch than are prepared: each material is the same cloth. Where a pass has 12 samples and more, far cloth has
    something in common with the samples beside it, and so with its run: of 64 that is left in the mean alone."""
    count = 20
    rows = [mesh([(-1, a, 0), (1, a, 0), (1, b, 0), (-1, b, 0)], [[0, 1, 2], [0, 2, 3]],
                 uvs=[(0, a), (1, a), (1, b), (0, b)], materials=k)
            for k in range(count) for a, b in [(-1 + 2 * k / count, -1 + 2 * (k + 1) / count)]]
    one = [row | {"material": np.zeros_like(row["material"])} for row in rows]
    given = scene(cloths=[cloth("gabardine", 0.02)], lights=[sun()], background=(1, 1, 1), max_bounces=2)
    for samples in (15, 64):
        many, few = [render(given | {"samples": samples, "materials": [fabric()] * k, "meshes": meshes, "instances": [
            {"mesh": i, "matrix": np.eye(4).ravel().tolist()} for i in range(count)]})[0]
                     for k, meshes in ((count, rows), (1, one))]
        if samples < 16:
            np.testing.assert_allclose(many, few, rtol=1e-3, atol=1e-4)
        assert many.mean() == pytest.approx(few.mean(), rel=1e-3)
        assert np.sqrt(((many - few) ** 2).mean()) < 0.01 * few.mean()


@pytest.mark.parametrize("change, message", [
    ({"cloths": [cloth("chiffon")]}, r"cloths\[0\]: preset: no cloth 'chiffon'"),
    ({"cloths": [cloth("brushed_gold")]}, r"no cloth 'brushed_gold'"),
    ({"cloths": [cloth(size=0.0)]}, r"size"),
    ({"materials": [fabric(1)]}, r"cloth must be"),
    ({"materials": [fabric() | {"place": [0.0] * 4}]}, r"place must be four registers"),
])
def test_what_cannot_be_cloth_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        native.start(scene(cloths=[cloth()], materials=[fabric()]) | change)


def test_hits_between_the_models_stay_where_they_are():
    """Those are shaded in another order: of other surfaces, and of the sky, nothing changes, and cloth is what it is near by."""
    looks = {}
    for tier in ("auto", "near"):
        cloths = [cloth("gabardine", 0.003, warp=(shade,) * 3, weft=(shade,) * 3, tier=tier) for shade in (0.7, 0.1)]
        corners = np.array([(0, -1, 0), (0.4, -1, 0), (0.4, 1, 0), (0, 1, 0)])
        uvs = np.float32([(0, 0), (1, 0), (1, 1), (0, 1)])
        meshes = [mesh(corners + (x, 0, 0), [[0, 1, 2], [0, 2, 3]], uvs=uvs, materials=k) for k, x in enumerate((-1, -0.5, 0, 0.5))]
        looks[tier], _ = render(scene(
            cloths=cloths, materials=[fabric(0), material(), fabric(1), material()], meshes=meshes, lights=[sun((0.3, 0.2, 0.9))],
            background=(0.2, 0.3, 0.4), camera=ortho(), width=40, height=40, samples=256, transparent=False, max_bounces=1))
    auto, near = looks["auto"], looks["near"]
    bright, dark = slice(0, 8), slice(20, 28)
    rest = [k for k in range(40) if k not in (*range(0, 9), *range(20, 29))]
    np.testing.assert_array_equal(auto[:, rest], near[:, rest])
    for part in (bright, dark):
        a, b = auto[:, part, 1].mean(), near[:, part, 1].mean()
        assert abs(a / b - 1) < 0.03, (a, b)
        assert (auto[:, part] != near[:, part]).any()
    assert auto[:, bright, 1].mean() > 3 * auto[:, dark, 1].mean()


SIDE = 32 if SANITIZED else 160


@pytest.mark.parametrize("preset", ["herringbone_tweed", "linen"])
def test_threads_change_no_bit_from_near_to_far(preset):
    """A plate up to its horizon: yarns in front, cloth behind, whose streaks samples have in common with those beside them."""
    given = scene(cloths=[cloth(preset, 16.0)], materials=[fabric()], meshes=[square(8.0)], lights=[sun((0.4, 0.5, 0.8), angle=0.05)],
                  background=(0.3, 0.3, 0.3), camera=persp(0.15, (0.3, -7.5, 0.08), (0.3, -7.24, 0)), width=SIDE, height=SIDE, samples=24,
                  transparent=False, max_bounces=1)
    one = render(given | {"threads": 1})[0]
    for threads in (2, 3, 5):
        np.testing.assert_array_equal(one, render(given | {"threads": threads})[0])
