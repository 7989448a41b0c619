# SPDX-License-Identifier: GPL-3.0-or-later
"""Images averaged over what a ray stands for, against means and waves worked out by hand."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from native_scenes import image, look_at, native, ortho, persp, registers, render, scene, square
from native_scenes import material as metal

COST = 1.2

WIDE = 256  # texels
SIDE = 16  # pixels: each WIDE / SIDE texels wide
UV, TURNED, NEAR_U, NEAR_V, COLOR, ALPHA = 3, 6, 9, 12, 15, 18


def shining(mixed=False, at=None, **given):
    """A material that shines with the image; mixed: and lets light from behind through by its alpha."""
    look = {"type": "IMAGE", "image": 0, "out": registers(COLOR, 3), "averaged": True, **given}
    nodes = []
    if at is not None:
        step = 1 / 256
        nodes = [{"type": "GEOMETRY", "what": "UV", "out": registers(UV, 3)}]
        for out, moved in ((TURNED, (0, 0)), (NEAR_U, (step, 0)), (NEAR_V, (0, step))):
            matrix = np.array(at, float)
            matrix[:2, 3] += matrix[:2, :2] @ moved
            nodes.append({"type": "TRANSFORM", "vector": registers(UV, 3), "matrix": matrix.ravel().tolist(),
                          "unit": False, "out": registers(out, 3)})
        look |= {"at": registers(TURNED, 2), "near": registers(NEAR_U, 2) + registers(NEAR_V, 2), "step": step}
    if mixed:
        look["alpha"] = registers(ALPHA, 1)
    return {"name": "shining", "nodes": nodes + [look],
            "closures": [{"closure": "EMISSION", "weight": registers(COLOR, 3)}]}


def seen(pixels, blur, material=None, camera=None, side=SIDE, samples=64, bodies=None, **given):
    """The first channel, row 0 at the bottom."""
    made = scene(width=side, height=side, samples=samples, lights=[], transparent=False, images=[image(pixels, **given)],
                 materials=[material or shining()], camera=camera or ortho(), texture_blur=blur, **(bodies or {}))
    return render(made)[0][..., :3]


def light_of(code):
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def wave(periods, across=WIDE, down=8, vertical=False):
    """A cosine along u, or v, about a half."""
    x = (np.arange(across) + 0.5) / across
    line = 0.5 + 0.4 * np.cos(2 * np.pi * periods * x)
    grid = np.repeat(line[None], down, 0)
    return np.repeat((grid.T if vertical else grid)[..., None], 3, -1).astype(np.float32)


def amplitude(line, periods):
    """Of this many periods in a row of pixels."""
    x = (np.arange(len(line)) + 0.5) / len(line)
    return 2 * np.mean(line * np.exp(-2j * np.pi * periods * x))


def kept(texels, periods):
    """Of a wave's amplitude by a blur as far as that of a square of so many texels."""
    return np.exp(-2 * np.pi**2 * (periods / WIDE) ** 2 * texels**2 / 12)


@pytest.mark.parametrize("blur, size", [(0.5, 1), (1.0, 1), (2.0, 1), (3.3, 1), (2.0, 1 / 256)])
def test_a_wave_fades_as_by_the_footprint(blur, size):
    """Pixels are squares beside it. Or the plate is one of two bodies of a mesh, and made so small there."""
    texels, periods = WIDE / SIDE, 2
    there, far = np.diag([size, size, size, 1.0]), np.eye(4)
    far[0, 3] = 9e3
    bodies = {"apart": 1, "meshes": [square(1 / size)], "instances": [{"mesh": 0, "matrix": m.ravel().tolist()} for m in (there, far)]}
    found = seen(wave(periods, down=WIDE), blur, samples=1024, bodies=bodies if size != 1 else None).mean(0)[:, 0]
    wanted = 0.4 * np.sinc(periods / SIDE) * kept(blur * texels, periods)
    assert abs(amplitude(found, periods)) == pytest.approx(wanted, abs=0.0015)


@pytest.mark.parametrize("vertical", [False, True])
def test_the_short_axis_of_an_oblique_footprint_counts(vertical):
    """Seen at 60 degrees a pixel is twice as long along y; the image is blurred as across, either way."""
    blur, periods, texels = 2.0, 2, WIDE / SIDE
    camera = ortho() | {"matrix": look_at((0, -3 * np.sin(np.pi / 3), 1.5), (0, 0, 0)).ravel().tolist()}
    if vertical:  # pixels see the middle of the square, all of it fits into half of the frame
        camera |= {"frame": (-1, 1, -0.5, 0.5)}
    pixels = wave(periods, down=WIDE, vertical=vertical)
    found = seen(pixels, blur, camera=camera, samples=1024)[..., 0]
    if vertical:
        texels *= np.sqrt(0.5)  # a pixel's side is that of a square as large
        assert abs(amplitude(found.mean(1), periods)) == pytest.approx(
            0.4 * np.sinc(periods / SIDE) * kept(blur * texels, periods), abs=0.002)
    else:
        middle = found[SIDE // 2 - 3:SIDE // 2 + 3].mean(0)
        assert abs(amplitude(middle, periods)) == pytest.approx(
            0.4 * np.sinc(periods / SIDE) * kept(blur * texels, periods), abs=0.002)


@pytest.mark.parametrize("changes, wide", [
    ({"panorama": "EQUIRECTANGULAR", "range": [-1 / 30, 1 / 30, -1 / 30, 1 / 30]}, 1.0),
    ({"panorama": "EQUIRECTANGULAR", "range": [-1 / 30, 1 / 30, -1 / 240, 1 / 240]}, 0.125), ({"panorama": "FISHEYE_EQUIDISTANT", "fov": 1 / 15}, 1.0)])
def test_a_panorama_has_pixels_too(changes, wide):
    """From far enough it is flat: a pixel is as wide as above, or an eighth as high; that of a fisheye's middle."""
    blur, periods, texels = 2.0, 2, WIDE / SIDE
    camera = {**ortho(1.0, (0, 0, 30)), "type": "PANO", "fov": 1.0, "focal": 1.0, "range": [0.0] * 4, "sensor": (1.0, 1.0), "polynomial": [0.0] * 5,
              "frame": [0, 1, 0, 1], **changes}
    found = seen(wave(periods, down=WIDE), blur, camera=camera, samples=1024)[SIDE // 2 - 1:SIDE // 2 + 1].mean(0)[:, 0]
    wanted = 0.4 * np.sinc(periods / SIDE) * kept(blur * texels * np.sqrt(wide), periods)
    assert abs(amplitude(found, periods)) == pytest.approx(wanted, abs=0.005)


def test_a_step_in_a_mirror_is_as_wide_as_the_way_is_long():
    """That of a pixel of what is three units away, by a flat mirror or a panorama of such pixels, too; that of what is as near as the mirror
    is a third of it."""
    step = {"type": "STEP", "axis": "Y", "scale": 1.0, "otherwise": 0.1, "out": registers(UV, 2)}
    marked = {"name": "step", "nodes": [step], "closures": [{"closure": "EMISSION", "weight": registers(UV, 1) * 3}]}
    mirror = {**metal(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=1e-3, ay=1e-3), "name": "mirror"}

    def middle(eye, *meshes, **changes):
        camera = {**persp(1 / 3, (0, 0, eye)), **changes}
        made = scene(width=SIDE, height=SIDE, samples=64, lights=[], materials=[marked, mirror], meshes=list(meshes), camera=camera, max_bounces=1)
        return render(made)[0][SIDE // 2 - 1:SIDE // 2 + 1, SIDE // 2 - 1:SIDE // 2 + 1, 0].mean()
    far, near, mirrored = middle(3.0, square()), middle(1.0, square()), middle(1.0, square(1.0, 2.0), square(2.0, 0.0, 1))
    angle = np.arctan(1 / 3)
    around = middle(3.0, square(), type="PANO", panorama="EQUIRECTANGULAR", range=[-angle, angle, -angle, angle], fov=1.0, focal=1.0, sensor=(1.0, 1.0),
                    polynomial=[0.0] * 5, frame=[0, 1, 0, 1])
    assert far > 0.01 and near == pytest.approx(far / 3, rel=0.01) and mirrored == pytest.approx(far, rel=0.02)
    assert around == pytest.approx(far * angle * 3, rel=0.02)


def test_coordinates_say_how_large_the_footprint_is():
    """Turned by 30 degrees, three times as dense along one axis as along the other."""
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turned = np.zeros((3, 4))
    turned[:2, :2] = np.diag((3.0, 1.0)) @ ((c, -s), (s, c))
    blur, texels = 2.0, WIDE / SIDE
    found = seen(wave(1, down=WIDE, vertical=True), blur, shining(at=turned), samples=1024)[..., 0]
    y, x = (np.mgrid[:SIDE, :SIDE] + 0.5) / SIDE
    plain = np.exp(-2j * np.pi * (s * x + c * y))
    # the wave runs along the second axis, by one period in a turned unit of the picture
    fit = np.c_[np.ones(x.size), plain.real.ravel(), plain.imag.ravel()]
    _, a, b = np.linalg.lstsq(fit, found.ravel().astype(float), rcond=None)[0]
    wanted = 0.4 * np.sinc(s / SIDE) * np.sinc(c / SIDE) * kept(blur * texels, 1)
    assert np.hypot(a, b) == pytest.approx(wanted, abs=0.002)


@pytest.mark.parametrize("wrap", ["REPEAT", "MIRROR"])
@pytest.mark.parametrize("size", [(64, 64), (47, 65), (3, 200), (1, 1)])
def test_nothing_is_lost(size, wrap):
    """Whatever the size, the mean of a picture that shows all of the image is the image's."""
    pixels = np.random.default_rng(5).random((*size, 3)).astype(np.float32)
    for blur in (1.0, 20.0, 1000.0):
        found = seen(pixels, blur, samples=256, wrap=wrap).mean((0, 1))
        if blur == 1000.0 or wrap == "REPEAT":
            assert found == pytest.approx(pixels.mean((0, 1)), abs=2e-3 if wrap == "REPEAT" else 1e-4)


@pytest.mark.parametrize("blur", [0.0, 1.0])
def test_two_channels_are_grey_and_alpha(blur):
    pixels = np.empty((8, WIDE, 2), np.float32)
    pixels[...] = 0.25, 0.75
    np.testing.assert_allclose(seen(pixels, blur, samples=1), 0.25, atol=1e-4)
    alpha = {"type": "IMAGE", "image": 0, "out": registers(COLOR, 3), "alpha": registers(ALPHA, 1), "averaged": True}
    told = {"name": "alpha", "nodes": [alpha], "closures": [{"closure": "EMISSION", "weight": registers(ALPHA, 1) * 3}]}
    np.testing.assert_allclose(seen(pixels, blur, told, samples=1), 0.75, atol=1e-4)


def test_a_point_is_near_the_mean_of_its_footprint():
    """By one sample a pixel, of white noise: the whole pixel's mean, by adding up its texels."""
    texels = 16
    pixels = np.random.default_rng(1).random((SIDE * texels,) * 2).astype(np.float32)
    truth = pixels.reshape(SIDE, texels, SIDE, texels).mean((1, 3))
    errors = [np.sqrt(np.mean((seen(np.repeat(pixels[..., None], 3, -1), blur, samples=1)[..., 0] - truth) ** 2))
              for blur in (0.0, 1.0)]
    assert errors[1] < 0.15 * errors[0]


@pytest.mark.parametrize("floats", [False, True])
@pytest.mark.parametrize("low, high", [(0, 255), (60, 200)])
def test_light_is_averaged_not_its_code(floats, low, high):
    board = np.where(np.indices((64, 64)).sum(0) % 2, high, low)
    pixels = np.repeat(board[..., None], 3, -1).astype(np.uint8)
    found = seen(np.float32(pixels) / 255 if floats else pixels, 2.0, srgb=True)
    truth = np.mean([light_of(code / 255) for code in (low, high)])
    assert found.mean() == pytest.approx(truth, abs=1e-3)
    assert found == pytest.approx(truth, abs=1e-4 if floats else 4e-3)  # coarser levels of bytes are bytes, too


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
def test_of_alpha_the_number_is_averaged(kind):
    """It is no light, whatever the colours beside it are; of all three kinds of texels."""
    board = np.where(np.indices((64, 64)).sum(0) % 2, 0.8, 0.2)
    most = np.iinfo(kind).max if kind != np.float32 else 1
    pixels = np.repeat((board * most)[..., None], 4, -1)
    given = pixels.astype(kind) if kind == np.float32 else np.rint(pixels).astype(kind)
    about = shining(mixed=True)
    about["closures"] = [{"closure": "EMISSION", "weight": registers(ALPHA, 1) * 3}]
    assert seen(given, 2.0, about, srgb=True) == pytest.approx(0.5, abs=4e-3)
    whole = np.full((64, 64, 4), most, kind)
    whole[..., :3] = given[..., :3]
    assert seen(whole, 2.0, shining(mixed=True), srgb=True).mean() == pytest.approx(np.mean(light_of(np.array([0.2, 0.8]))), abs=2e-3)


@pytest.mark.parametrize("floats", [False, True])
@pytest.mark.parametrize("srgb", [False, True])
def test_codes_are_mixed_as_they_are(srgb, floats):
    """Between two texels it is the light of the code between, as in Cycles."""
    pixels = np.zeros((1, 2, 3), np.uint8)
    pixels[0] = (10, 60, 200), (30, 250, 90)
    half = np.zeros((3, 4))
    half[:2] = (0.5, 0, 0, 0.25), (0, 0, 0, 0.5)  # from the middle of one to that of the other
    for cubic in (False, True):
        given = np.float32(pixels) / 255 if floats else pixels
        found = seen(given, 0.0, shining(at=half, cubic=cubic), srgb=srgb, wrap="EXTEND", samples=256)
        x = (np.arange(SIDE) + 0.5)[:, None] / SIDE
        if cubic:  # a B-spline over two texels that go on
            x = (1 + 3 * x + 3 * x**2 - 2 * x**3) / 6
        code = (pixels[0, 0] * (1 - x) + pixels[0, 1] * x) / 255
        light = light_of(code) if srgb else code
        np.testing.assert_allclose(found.mean(0), light, atol=2e-3)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
def test_what_cannot_be_seen_colours_nothing(kind):
    """Half of the texels are grey, the others green and transparent; of all three kinds of texels."""
    pixels = np.zeros((64, 64, 4), np.float32)
    on = np.indices((64, 64)).sum(0) % 2 == 1
    pixels[on], pixels[~on] = (0.5, 0.5, 0.5, 1), (0, 1, 0, 0)
    most = np.iinfo(kind).max if kind != np.float32 else 1
    given = (pixels * most).astype(kind)
    grey = int(0.5 * most) / most if kind != np.float32 else 0.5
    off = 1e-3 if kind != np.uint8 else 1 / 255  # smaller copies of bytes are bytes
    assert seen(given, 4.0, shining(mixed=True)) == pytest.approx(grey, abs=off)
    assert seen(given, 4.0)[..., 1] == pytest.approx(0.5 + 0.5 * grey, abs=off)  # who does not ask for alpha sees green
    about = shining(mixed=True)
    about["closures"] = [{"closure": "EMISSION", "weight": registers(ALPHA, 1) * 3}]
    assert seen(given, 4.0, about) == pytest.approx(0.5, abs=off)
    given[..., 3] = 0  # and where all is, its colour stays
    assert seen(given, 4.0, shining(mixed=True))[..., 1] == pytest.approx(0.5 + 0.5 * grey, abs=off)


def test_images_that_are_not_smaller_than_their_pixels_stay():
    pixels = np.random.default_rng(2).random((8, 8, 3)).astype(np.float32)
    assert (seen(pixels, 1.0) == seen(pixels, 0.0)).all()
    fine = np.random.default_rng(2).random((256, 256, 3)).astype(np.float32)
    for given, material in (({"filter": "CLOSEST"}, None), ({}, shining(cubic=True)), ({}, shining(averaged=False))):
        assert (seen(fine, 1.0, material, **given) == seen(fine, 0.0, material, **given)).all()
    assert not (seen(fine, 1.0) == seen(fine, 0.0)).all()


def test_what_is_beyond_a_clipped_image_fades():
    """Far away it is a square of light about the middle, as bright in all."""
    pixels = np.ones((64, 64, 3), np.float32)
    half = np.zeros((3, 4))
    half[:2] = (2, 0, 0, -0.5), (0, 2, 0, -0.5)  # the image is half as wide as the square
    whole = seen(pixels, 0.0, shining(at=half), wrap="CLIP").mean()
    assert whole == pytest.approx(0.25, abs=2e-3)
    assert seen(pixels, 4.0, shining(at=half), wrap="CLIP", samples=256).mean() == pytest.approx(0.25, abs=2e-3)
    assert seen(pixels, 4.0, shining(at=half), wrap="EXTEND") == pytest.approx(1, abs=1e-4)


def test_a_look_elsewhere_says_how_it_moves():
    look = shining(at=np.eye(3, 4))
    del look["nodes"][-1]["near"]
    with pytest.raises(ValueError, match="near"):
        native.start(scene(images=[image(wave(1))], materials=[look]))
    with pytest.raises(ValueError, match="texture_blur"):
        native.start(scene(texture_blur=-1.0))


@pytest.mark.parametrize("folder", ["", "/dev/shm", "/nowhere/at/all"])
def test_large_images_look_the_same_wherever_they_lie(folder, monkeypatch, tmp_path):
    """In a file without a name, or where there is none in memory; what is in a file is not held."""
    folder = folder or str(tmp_path)
    pixels = np.zeros((4200, 4200, 3), np.uint8)
    pixels[:2100, :, 0], pixels[2100:, :, 1] = 255, 128
    monkeypatch.setenv("TMPDIR", folder)
    made = scene(width=4, height=4, samples=4, lights=[], transparent=False, images=[image(pixels)],
                 materials=[shining()], camera=ortho(), texture_blur=0.0)
    job = native.start(made)
    native.wait(job, 1e9)
    state = native.poll(job)
    native.free(job)
    assert state["state"] == "done" and str(tmp_path) not in Path("/proc/self/maps").read_text()
    kind = subprocess.run(["stat", "-f", "-c", "%T", folder], capture_output=True, text=True).stdout.strip()
    on_disk = kind not in ("", "tmpfs")
    assert not list(tmp_path.iterdir())
    assert (state["memory_peak"] < 4 * pixels.size / 3) == on_disk, (kind, state["memory_peak"])
    found = render(made)[0][..., :3]
    np.testing.assert_allclose(found[:1, :, 0], 1, atol=1e-5)
    np.testing.assert_allclose(found[3:, :, 1], 128 / 255, atol=1e-5)


@pytest.mark.parametrize("filtering", ["LINEAR", "CLOSEST"])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_a_wide_image_is_what_its_floats_say(filtering, channels):
    """Light brighter than white, and heights below zero; one pixel a texel, the middle of each. NaN is 0."""
    chance = np.random.default_rng(channels)
    pixels = chance.uniform(-3, 50, (SIDE, SIDE, channels)).astype(np.float32)
    pixels[3, 5, 0], pixels[6, 7, 0] = np.nan, 60000.0
    look = {"type": "IMAGE", "image": 0, "out": registers(COLOR, 3), "alpha": registers(ALPHA, 1), "averaged": True}
    above = [{"type": "MATH", "operation": "ADD", "a": [(k,)], "b": [10.0], "c": [0.0], "out": [(k,)]} for k in (15, 16, 17, 18)]
    colors = {"nodes": [look, *above], "closures": [{"closure": "EMISSION", "weight": registers(COLOR, 3)}]}
    alphas = {"nodes": [look, *above], "closures": [{"closure": "EMISSION", "weight": registers(ALPHA, 1) * 3}]}
    def looked(material):
        made = scene(width=SIDE, height=SIDE, samples=1, lights=[], images=[image(pixels, filter=filtering, wide=True)],
                     materials=[{"name": "", **material}], filter_width=1e-4, pixel_filter_type="GAUSSIAN", texture_blur=1.0)
        return render(made)[0][..., :3]

    wanted = np.nan_to_num(pixels)[..., :3] if channels > 1 else np.repeat(np.nan_to_num(pixels), 3, -1)
    alpha = np.nan_to_num(pixels[..., 3]) if channels == 4 else np.ones((SIDE, SIDE))
    for found, said in ((looked(colors), wanted), (looked(alphas)[..., 0], alpha)):
        off = np.abs(found - (said + 10)) / (1 + np.abs(said))
        assert np.sort(off.ravel())[-16] < 0.002 and off.max() < 2  # beside 60,000 the filter's width counts
