# SPDX-License-Identifier: GPL-3.0-or-later
"""What a hit reflects, against formulas written out in native_scenes."""

import json
import subprocess

import numpy as np
import pytest

from native_scenes import (
    ROOT,
    ashikhmin_shirley,
    dump,
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
    unit,
    vectors,
)

COST = 4.7

F0 = (0.9, 0.6, 0.3)


def flat_normal_map(n, size=4):
    pixels = np.ones((size, size, 4), np.float32)
    pixels[..., :3] = 0.5 + 0.5 * np.asarray(n)
    return image(pixels)


@pytest.mark.parametrize("direction", [(0, 0, 1), (0.3, 0.1, 0.9), (-0.05, 0.6, 0.5)])
def test_flat_plate_under_a_sun(direction):
    picture, _ = render(scene(lights=[sun(direction, (2, 1, 0.5))]))
    expected = ashikhmin_shirley((0, 0, 1), direction, (0, 0, 1), 200, 10, F0) * (2, 1, 0.5)
    np.testing.assert_allclose(picture[..., :3], np.broadcast_to(expected, (16, 16, 3)), rtol=2e-5)
    assert (picture[..., 3] == 1).all()


@pytest.mark.parametrize("tilt", [(0.3, 0.2), (-0.5, 0.1), (0.0, -0.4)])
def test_constant_normal_map_carries_the_lobe(tilt):
    n = np.array([*tilt, np.sqrt(1 - tilt[0] ** 2 - tilt[1] ** 2)])
    light = unit(2 * n[2] * n - (0, 0, 1) + (0.05, 0.1, 0.02))
    picture, _ = render(
        scene(
            lights=[sun(light)],
            images=[flat_normal_map(n)],
            materials=[material(normal_image=0)],
        )
    )
    expected = ashikhmin_shirley(n, light, (0, 0, 1), 200, 10, F0)
    # 16 bits a component of the normal: 2e-5 in angle
    np.testing.assert_allclose(picture[8, 8, :3], expected, rtol=2e-3)


def test_normal_strength_is_that_of_cycles(tmp_path):
    n = unit(np.array([0.4, -0.2, 0.8]))
    for strength in (0.0, 0.5, 2.0):
        planes, _ = dump(
            scene(
                images=[flat_normal_map(n)],
                materials=[material(normal_image=0, normal_strength=strength)],
            ),
            tmp_path / "d.exr",
        )
        keep = min(strength, 1)
        wanted = unit(np.array([n[0] * strength, n[1] * strength, 1 + keep * (n[2] - 1)]))
        np.testing.assert_allclose(vectors(planes, "Ns")[8, 8], wanted, atol=4e-5)


@pytest.mark.parametrize("horizon", [row["word"] for row in native.table()["lists"]["horizon"]])
def test_horizon_is_shaded_and_told(horizon, tmp_path):
    """A steep bump under a low light, which each choice sees in its own way."""
    path = tmp_path / "d.exr"
    n, light = unit(np.array([0.75, 0, 0.66])), unit(np.array([0.6, 0.1, 0.25]))
    changes = {"lights": [sun(light)], "images": [flat_normal_map(n)]}
    materials = {h: material(normal_image=0, ex=5.0, ey=5.0, horizon=h) for h in {horizon, "hard"}}
    planes, header = dump(scene(materials=[materials[horizon]], **changes), path)
    assert json.loads(header)["materials"][0]["horizon"] == horizon
    done = subprocess.run([ROOT / "build/shade", "check", path], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    hard, _ = dump(scene(materials=[materials["hard"]], **changes), path)
    same = vectors(planes, "light0.S", "RGB") == vectors(hard, "light0.S", "RGB")
    assert same.all() == (horizon in ("hard", "mutual"))  # which is hard where all of the map leans as one


def waves(slope, size=64):
    """The normal map of slope sin x sin y, which leans as a whole by .1 along y."""
    x, y = (2 * np.pi * (each + 0.5) / size for each in np.meshgrid(np.arange(size), np.arange(size)))
    n = unit(np.stack([-slope * np.cos(x) * np.sin(y), -slope * np.sin(x) * np.cos(y) - 0.1, np.ones_like(x)], -1))
    return image((0.5 + 0.5 * n).astype(np.float32))


def test_slopes_of_bumps_that_shade_each_other_are_found(tmp_path):
    """Of a sine plate the variance along either axis is a quarter of the square of its steepest slope."""
    path = tmp_path / "d.exr"
    _, header = dump(scene(images=[waves(1.2)], materials=[material(normal_image=0, horizon="mutual")]), path)
    np.testing.assert_allclose(json.loads(header)["materials"][0]["slopes"], [0, 0.1, 0.36, 0, 0.36], atol=0.02)
    done = subprocess.run([ROOT / "build/shade", "check", path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    told = [0.1, 0.0, 0.5, 0.1, 0.25]
    _, header = dump(scene(images=[waves(1.2)], materials=[{**material(normal_image=0, horizon="mutual"), "slopes": told}]), path)
    assert json.loads(header)["materials"][0]["slopes"] == pytest.approx(told)
    bumps = material(normal_image=0, horizon="mutual")
    job = native.start(scene(images=[waves(1.2)], materials=[bumps, material(), bumps]))
    assert finish(job)["state"] == "done"
    (first, *found), (last, *none) = native.slopes(job)
    assert (first, last, none) == (0, 2, [0] * 5)  # no surface has the last one
    np.testing.assert_allclose(found, [0, 0.1, 0.36, 0, 0.36], atol=0.02)
    native.free(job)


def test_slopes_of_bumps_do_not_depend_on_the_order_of_triangles():
    """Which Blender 5 may change from one evaluation to the next; of few and of more than points are looked at."""
    for side in (2, 80):
        x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side)))
        corner = np.arange(side * side).reshape(side, side)
        a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]))
        triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
        found = []
        for order in (triangles, triangles[::-1], np.random.default_rng(1).permutation(triangles)):
            job = native.start(scene(images=[waves(1.2)], materials=[material(normal_image=0, horizon="mutual")],
                                     meshes=[mesh(np.stack([2 * x - 1, 2 * y - 1, 0 * x], 1), order, uvs=np.stack([x, y], 1))]))
            assert finish(job)["state"] == "done"
            found.append(native.slopes(job)[0][1:])
            native.free(job)
        np.testing.assert_allclose(found, [found[0]] * 3, rtol=0, atol=1e-6)
        np.testing.assert_allclose(found[0], [0, 0.1, 0.36, 0, 0.36], atol=0.03)


def half_flat(slope, size=256):
    """Waves on the left half, of 32 texels, and a flat right half."""
    x, y = (2 * np.pi * (each + 0.5) / 32 for each in np.meshgrid(np.arange(size), np.arange(size)))
    here = slope * (np.arange(size) < size / 2)
    n = unit(np.stack([-here * np.cos(x) * np.sin(y), -here * np.sin(x) * np.cos(y), np.ones_like(x)], -1))
    return image((0.5 + 0.5 * n).astype(np.float32))


def test_slopes_of_uneven_bumps_are_those_near_a_point(tmp_path):
    """Of a map that is flat on one half: there none, and pictures are as `hard`; on the other those of its own waves."""
    path, light = tmp_path / "d.exr", sun(unit(np.array([0.3, 0.2, 0.4])))

    def half(horizon):
        uneven = {"nodes": [*material(normal_image=0)["nodes"], {"type": "RELIEF", "out": [[20], [21], [22]]}],
                  "moment_from": [[20], [21], [22]]}
        of = {**material(normal_image=0, ex=20.0, ey=20.0, horizon=horizon), **(uneven if horizon == "mutual" else {})}
        return dump(scene(width=64, height=64, images=[half_flat(1.2)], materials=[of], lights=[light]), path)

    hard, _ = half("hard")
    planes, header = half("mutual")
    done = subprocess.run([ROOT / "build/shade", "check", path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    np.testing.assert_allclose(json.loads(header)["materials"][0]["slopes"], [0, 0, 0.18, 0, 0.18], atol=0.01)
    bumpy, flat = np.s_[:, 6:26], np.s_[:, 38:58]
    for axis in "XY":
        moment = planes[f"slopes.{axis}{axis}"]
        assert moment[flat].max() < 1e-3 and moment[bumpy].mean() == pytest.approx(0.36, rel=0.05)
        assert moment[bumpy].std() < 0.1 * moment[bumpy].mean()
    np.testing.assert_allclose(vectors(planes, "light0.S", "RGB")[flat], vectors(hard, "light0.S", "RGB")[flat], rtol=0.01)


def test_slopes_of_even_bumps_are_those_of_all(tmp_path):
    """They pay for no map: a dump has one number of each, and no channels."""
    even = {**material(normal_image=0, horizon="mutual"), "moment_from": [[20], [21], [22]]}
    even["nodes"] = [*even["nodes"], {"type": "RELIEF", "out": [[20], [21], [22]]}]
    planes, header = dump(scene(images=[waves(1.2)], materials=[even]), tmp_path / "d.exr")
    np.testing.assert_allclose(json.loads(header)["materials"][0]["slopes"], [0, 0.1, 0.36, 0, 0.36], atol=0.02)
    assert "slopes.XX" not in planes


SHAPE = {"nodes": [*material(normal_image=0)["nodes"], {"type": "RELIEF", "out": [[r] for r in range(20, 25)], "shape": True}],
         "moment_from": [[20], [21], [22]], "mean_from": [[23], [24]]}


def of_slopes(x, y):
    return image((0.5 + 0.5 * unit(np.stack([-x, -y, np.ones_like(x)], -1))).astype(np.float32))


def of_waves(size):
    """Slopes of sin x sin y, finer than what else is there."""
    x, y = (2 * np.pi * by * (np.arange(size) + 0.5) / size for by in (31, 37))
    x, y = np.meshgrid(x, y)
    return np.cos(x) * np.sin(y), np.sin(x) * np.cos(y)


def shaped(periods, fine, size=512):
    """Long waves, .1 along y, and fine ones of so steep a slope: the map, and the long slopes at places of UV."""
    def long(u, v):
        x, y = 2 * np.pi * periods * u, 2 * np.pi * periods * v
        return 0.5 * np.cos(x) * np.sin(y), 0.5 * np.sin(x) * np.cos(y) + 0.1  # of 0 periods none but .1
    u, v = np.meshgrid(*[(np.arange(size) + 0.5) / size] * 2)
    return of_slopes(*(a + fine * b for a, b in zip(long(u, v), of_waves(size)))), long


def test_long_slopes_of_a_shape_are_no_bumps(tmp_path):
    """The mean at each place is theirs and the moment that of the fine ones; from place to place there is no step."""
    path = tmp_path / "d.exr"
    for periods, fine, within in ((0, 0.6, 0.01), (1, 0.6, 0.04)):
        pixels, long = shaped(periods, fine)
        metal = {**material(normal_image=0, ex=20.0, ey=20.0, horizon="mutual"), **SHAPE}
        planes, _ = dump(scene(width=96, height=96, images=[pixels], materials=[metal]), path)
        done = subprocess.run([ROOT / "build/shade", "check", path], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        inner = np.s_[8:-8, 8:-8]  # a window at the rim has one side
        for axis, wanted in zip("XY", long(*(0.5 + 0.5 * planes[f"P.{axis}"] for axis in "XY"))):
            found = planes[f"slopes.{axis}"]
            assert np.sqrt(((found - wanted)[inner] ** 2).mean()) < within, (periods, fine, axis)
            assert np.abs(np.diff(found)).max() < 2 * np.abs(np.diff(wanted)).max() + 0.01
            moment = planes[f"slopes.{axis}{axis}"]
            assert moment[inner].mean() == pytest.approx(fine**2 / 4, abs=0.05 * fine**2 + 2 * within**2), (periods, fine)
            assert moment.min() >= 0


def test_a_shape_without_bumps_is_hard(tmp_path):
    """Of a map that leans as one, and of a flat one."""
    path, light = tmp_path / "d.exr", sun(unit(np.array([0.3, 0.2, 0.4])))
    even = np.ones((64, 64))
    for pixels in (of_slopes(0.5 * even, 0.3 * even), of_slopes(0 * even, 0 * even)):
        shaded = []
        for how in ({"horizon": "hard"}, {"horizon": "mutual", **SHAPE}):
            planes, _ = dump(scene(images=[pixels], materials=[{**material(normal_image=0, ex=20.0, ey=20.0), **how}], lights=[light]), path)
            shaded.append(vectors(planes, "light0.S", "RGB"))
        np.testing.assert_allclose(*shaded, rtol=1e-3)


def test_a_shape_that_stands_free_is_shaded_as_such():
    """A bowl upside down that was baked onto a plane, by fine bumps on a mesh of it: the picture from straight above."""
    size, steep, (x, y) = 512, 0.7, np.meshgrid(*[np.linspace(-1, 1, 65)] * 2)
    fine = [0.4 * by for by in of_waves(size)]
    on = np.meshgrid(*[(np.arange(size) + 0.5) / size * 2 - 1] * 2)
    n = unit(np.stack([steep * on[0], steep * on[1], np.ones_like(on[0])], -1))
    t = unit(np.stack([np.ones_like(on[0]), 0 * on[0], -steep * on[0]], -1))
    baked = unit(n - fine[0][..., None] * t - fine[1][..., None] * np.cross(n, t))
    at = np.arange(65 * 65).reshape(65, 65)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
    x, y = x.ravel(), y.ravel()
    real = mesh(np.stack([x, y, -steep / 2 * (x * x + y * y)], 1), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]),
                unit(np.stack([steep * x, steep * y, np.ones_like(x)], -1)), np.stack([0.5 + 0.5 * x, 0.5 + 0.5 * y], 1))
    rough = material(normal_image=0, mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(0.6,) * 3, ax=0.2, ay=0.2, horizon="mutual")
    flat = image((0.5 + 0.5 * baked).astype(np.float32))
    truth, relief, shape = (
        render(scene(width=32, height=32, samples=64, camera=ortho(0.98), lights=[sun((1, 0, 3**0.5))], images=[pixels],
                     materials=[rough | how], meshes=[on_what]))[0][..., 0].reshape(8, 4, 8, 4).mean((1, 3))
        for pixels, how, on_what in ((of_slopes(*fine), {}, real), (flat, {}, square()), (flat, SHAPE, square())))
    off = [np.abs(each - truth).mean() / truth.mean() for each in (relief, shape)]
    assert off[1] < 0.1 and off[1] < off[0] / 2, off


def test_bumps_that_shade_each_other_lose_no_light():
    """A white metal of smooth facets under an even sky, seen from above and from the side; alone, each bump loses much."""
    smooth = {"mdf": "GGX", "brdf": "MICROFACET", "fresnel": "NONE", "f0": (1, 1, 1), "ax": 0.05, "ay": 0.05}
    for eye in ((0, 0, 3), (0, -2.5, 1.5)):
        around = {"images": [waves(1.4)], "lights": [], "background": (1, 1, 1), "transparent": False, "samples": 256,
                  "camera": persp(0.45, eye, (0, 0, 0)), "meshes": [square(3)]}
        mean = {horizon: render(scene(materials=[material(normal_image=0, **smooth, horizon=horizon)], **around))[0][..., :3].mean()
                for horizon in ("mutual", "hard")}
        assert mean["mutual"] == pytest.approx(1, abs=0.03) and mean["hard"] < 0.85, mean


def test_horizon_that_is_not_told_is_hard(tmp_path):
    untold = material()
    del untold["horizon"]
    _, header = dump(scene(materials=[untold]), tmp_path / "d.exr")
    assert json.loads(header)["materials"][0]["horizon"] == "hard"


def test_point_light_falls_off_with_the_square(tmp_path):
    position, intensity = np.array([0.3, -0.2, 0.7]), (3, 2, 1)
    planes, _ = dump(scene(lights=[point(tuple(position), intensity)]), tmp_path / "d.exr")
    p = vectors(planes, "P")
    to_light = position - p
    d2 = (to_light**2).sum(-1, keepdims=True)
    np.testing.assert_allclose(vectors(planes, "light0.L"), to_light / np.sqrt(d2), atol=3e-7)
    np.testing.assert_allclose(vectors(planes, "light0.E", "RGB"), intensity / d2, rtol=1e-6)
    expected = ashikhmin_shirley((0, 0, 1), to_light, (0, 0, 1), 200, 10, F0) * intensity / d2
    shaded = vectors(planes, "light0.S", "RGB")
    significant = expected > 1e-4 * expected.max()
    np.testing.assert_allclose(shaded[significant], expected[significant], rtol=5e-5)


def test_perspective_rays_go_through_pixel_centres(tmp_path):
    eye, half, size = np.array([0.5, -1.0, 2.0]), 0.4, 12
    camera = persp(half, eye, (0, 0, 0))
    planes, _ = dump(
        scene(width=size, height=size, camera=camera, meshes=[square(3)]), tmp_path / "d.exr"
    )
    at = ((np.arange(size) + 0.5) / size * 2 - 1) * half
    x, y = np.meshgrid(at, at)
    matrix = np.reshape(camera["matrix"], (4, 4))[:3, :3]
    ray = unit(np.stack([x, y, -np.ones_like(x)], -1) @ matrix.T)
    np.testing.assert_allclose(-vectors(planes, "V"), ray, atol=2e-7)
    p = eye - ray * (eye[2] / ray[..., 2:])
    np.testing.assert_allclose(vectors(planes, "P"), p, atol=2e-6)
    np.testing.assert_allclose(
        np.stack([planes["uv.U"], planes["uv.V"]], -1), 0.5 + p[..., :2] / 6, atol=1e-6
    )


def test_lights_add_up():
    """Each sample sees one of them, chosen by what it may give."""
    lights = [sun((0.2, 0.1, 1), (1, 2, 3)), point((0.5, 0.5, 1.5), (4, 1, 2)), sun((-0.3, 0, 1))]
    both, _ = render(scene(lights=lights, samples=1024))
    each = sum(render(scene(lights=[light]))[0][..., :3].astype(float) for light in lights)
    error = both[..., :3] - each
    assert np.abs(error).max() < 0.02 * each.max()
    assert np.abs(error.mean((0, 1))).max() < 5e-4 * each.mean()


def test_no_light_is_black_but_opaque():
    picture, _ = render(scene(lights=[]))
    assert (picture == (0, 0, 0, 1)).all()


def test_textured_reflectance(tmp_path):
    colors = np.random.default_rng(3).random((4, 4, 3)).astype(np.float32)
    for srgb, kind in (
        (False, np.float32),
        (True, np.float32),
        (True, np.uint8),
        (False, np.uint16),
    ):
        stored = (
            colors if kind is np.float32 else np.round(colors * np.iinfo(kind).max).astype(kind)
        )
        value = colors if kind is np.float32 else stored / float(np.iinfo(kind).max)
        if srgb:
            value = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
        planes, _ = dump(
            scene(
                images=[image(stored, srgb=srgb, filter="CLOSEST")],
                materials=[material(color_image=0, fresnel="NONE")],
            ),
            tmp_path / "d.exr",
        )
        expected = np.repeat(np.repeat(value, 4, 0), 4, 1)
        np.testing.assert_allclose(vectors(planes, "Color", "RGB"), expected, atol=3e-5)
        white = ashikhmin_shirley((0, 0, 1), (0, 0, 1), (0, 0, 1), 200, 10, (1, 1, 1))
        np.testing.assert_allclose(
            vectors(planes, "light0.S", "RGB"), white * expected, atol=3e-5 * white.max()
        )


@pytest.mark.parametrize("kind", [np.float32, np.uint8])
def test_a_normal_map_of_codes_is_decoded(tmp_path, kind):
    """One that is stored as sRGB says the light of its codes, with dark and bright parts."""
    normals = np.array([[(0.0, 0.0, 1.0), (-0.96, 0.0, 0.28)], [(0.6, 0.0, 0.8), (0.5, -0.7, 0.51)]])
    light = 0.5 + 0.5 * normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    code = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light**(1 / 2.4) - 0.055)
    stored = code.astype(kind) if kind is np.float32 else np.round(255 * code).astype(kind)
    value = stored / (1.0 if kind is np.float32 else 255.0)
    value = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    expected = 2 * value - 1
    expected /= np.linalg.norm(expected, axis=-1, keepdims=True)
    planes, _ = dump(scene(images=[image(stored, srgb=True, filter="CLOSEST")], materials=[material(normal_image=0)]), tmp_path / "d.exr")
    np.testing.assert_allclose(vectors(planes, "Ns"), np.repeat(np.repeat(expected, 8, 0), 8, 1), atol=2e-4)


@pytest.mark.parametrize("wrap", ["REPEAT", "EXTEND", "CLIP"])
@pytest.mark.parametrize("height, width", [(5, 7), (1, 1), (1, 4), (4, 1), (2, 1), (1, 2), (2, 2)])
def test_bilinear_and_wrap(tmp_path, wrap, height, width):
    """A plate whose UVs run from -1 to 2 against a look-up written out here."""
    texels = np.random.default_rng(5).random((height, width, 3)).astype(np.float32)
    plate = square()
    plate["corner_uvs"] = (plate["corner_uvs"] * 3 - 1).astype(np.float32)
    planes, _ = dump(
        scene(
            width=48,
            height=48,
            images=[image(texels, wrap=wrap)],
            materials=[material(color_image=0)],
            meshes=[plate],
        ),
        tmp_path / "d.exr",
    )

    def texel(ix, iy):
        h, w = texels.shape[:2]
        if wrap == "REPEAT":
            return texels[iy % h, ix % w]
        inside = (ix >= 0) & (ix < w) & (iy >= 0) & (iy < h)
        value = texels[np.clip(iy, 0, h - 1), np.clip(ix, 0, w - 1)]
        return value if wrap == "EXTEND" else value * inside[..., None]

    x = planes["uv.U"].astype(float) * texels.shape[1] - 0.5
    y = planes["uv.V"].astype(float) * texels.shape[0] - 0.5
    ix, iy = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = (x - ix)[..., None], (y - iy)[..., None]
    expected = (texel(ix, iy) * (1 - s) + texel(ix + 1, iy) * s) * (1 - t) + (
        texel(ix, iy + 1) * (1 - s) + texel(ix + 1, iy + 1) * s
    ) * t
    np.testing.assert_allclose(vectors(planes, "Color", "RGB"), expected, atol=3e-5)


def test_back_side_shows_the_same_sheet_from_behind(tmp_path):
    """Seen from below N faces the eye, and the bumps are those of the one displaced sheet."""
    n = unit(np.array([0.3, 0.2, 0.9]))
    changes = {"images": [flat_normal_map(n)], "materials": [material(normal_image=0)]}
    front, _ = dump(scene(**changes), tmp_path / "d.exr")
    back, _ = dump(scene(camera=ortho(eye=(0, 0, -3)), **changes), tmp_path / "d.exr")
    np.testing.assert_allclose(vectors(front, "Ns")[4, 4], n, atol=4e-5)
    np.testing.assert_allclose(vectors(back, "Ns")[4, 4], -n, atol=4e-5)
    np.testing.assert_allclose(vectors(back, "N")[4, 4], (0, 0, -1), atol=1e-7)
    np.testing.assert_allclose(vectors(back, "T")[4, 4], (1, 0, 0), atol=1e-7)


def test_back_side_is_lit_from_its_own_side():
    below = {"camera": ortho(eye=(0, 0, -3)), "lights": [sun((0.2, 0.1, -1))]}
    above = {"lights": [sun((0.2, 0.1, 1))]}
    np.testing.assert_allclose(render(scene(**below))[0], render(scene(**above))[0], rtol=2e-5)
    dark, _ = render(scene(camera=ortho(eye=(0, 0, -3)), lights=[sun((0.2, 0.1, 1))]))
    assert (dark[..., :3] == 0).all()


def test_mirrored_and_stretched_instances(tmp_path):
    """A normal map on a mirrored object is the mirrored normal map; normals are no tangents."""
    n = unit(np.array([0.3, 0.2, 0.9]))
    changes = {
        "images": [flat_normal_map(n)],
        "materials": [material(normal_image=0)],
    }
    mirror = np.diag([-1.0, 1, 1, 1]).ravel().tolist()
    planes, _ = dump(
        scene(instances=[{"mesh": 0, "matrix": mirror}], **changes), tmp_path / "d.exr"
    )
    np.testing.assert_allclose(vectors(planes, "Ns")[4, 4], n * (-1, 1, 1), atol=4e-5)
    np.testing.assert_allclose(vectors(planes, "T")[4, 4], (-1, 0, 0), atol=1e-7)
    # a plate at 45 degrees, stretched 3 times along z: normal (-1/1, 0, 1/3) of the plane z = 3 x
    slope = square()
    slope["positions"][:, 2] = slope["positions"][:, 0]
    slope["corner_normals"][:] = unit(np.array([-1.0, 0, 1]))
    stretch = np.diag([1.0, 1, 3, 1]).ravel().tolist()
    planes, _ = dump(
        scene(
            meshes=[slope], camera=ortho(eye=(0, 0, 9)), instances=[{"mesh": 0, "matrix": stretch}]
        ),
        tmp_path / "d.exr",
    )
    np.testing.assert_allclose(vectors(planes, "N")[4, 4], unit(np.array([-3.0, 0, 1])), atol=2e-7)
    np.testing.assert_allclose(vectors(planes, "T")[4, 4], unit(np.array([1.0, 0, 3])), atol=2e-7)


@pytest.mark.parametrize("normal, tangent", [((1, 0, 0), (0, 1, 0)), ((0.6, 0, 0.8), (0.8, 0, -0.6)), ((0, 0.6, 0.8), (1, 0, 0))])
def test_tangents_without_a_uv_map(tmp_path, normal, tangent):
    """The object's X axis along the surface, or its Y axis where the surface faces X."""
    along = np.cross(normal, tangent)
    plate = mesh(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ [tangent, along], [[0, 1, 2], [0, 2, 3]])
    planes, _ = dump(scene(meshes=[plate], camera=ortho(0.5, tuple(3 * np.array(normal)))), tmp_path / "d.exr")
    np.testing.assert_allclose(vectors(planes, "N")[4, 4], normal, atol=2e-7)
    np.testing.assert_allclose(vectors(planes, "T")[4, 4], tangent, atol=2e-7)


def test_smooth_normals_and_tangents_of_a_sphere(tmp_path):
    planes, _ = dump(
        scene(width=64, height=64, camera=ortho(1.1, (3, 0.5, 1)), meshes=[sphere(64)]),
        tmp_path / "d.exr",
    )
    hit = planes["material.ID"] == 0
    assert 0.6 < hit.mean() < 0.8
    p, normal, tangent, eye = (vectors(planes, name)[hit] for name in ("P", "N", "T", "V"))
    assert (np.abs(np.linalg.norm(normal, axis=1) - 1) < 3e-7).all()
    assert (np.abs(np.linalg.norm(tangent, axis=1) - 1) < 3e-7).all()
    assert (np.abs((normal * tangent).sum(1)) < 2e-7).all()
    assert ((normal * eye).sum(1) > 0).all()
    inner = (unit(p) * eye).sum(1) > 0.1
    assert ((normal * unit(p)).sum(1)[inner] > np.cos(np.radians(0.1))).all()
    east = unit(np.cross((0, 0, 1), p))
    assert ((tangent * east).sum(1)[inner] > np.cos(np.radians(2))).mean() > 0.99


def test_several_materials_in_one_batch(tmp_path):
    strips = square()
    cuts = 6
    x = np.linspace(-1, 1, cuts + 1)
    strips = mesh(
        np.array([[a, b, 0] for a in x for b in (-1, 1)]),
        [
            t
            for i in range(cuts)
            for t in ([2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1])
        ],
        materials=np.repeat(np.arange(cuts) % 3, 2),
        uvs=np.array([[a, b] for a in x for b in (-1, 1)]),
    )
    colors = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    materials = [material(f0=c, fresnel="NONE", ex=20.0 + i) for i, c in enumerate(colors)]
    changes = {"width": 12, "height": 12, "meshes": [strips], "materials": materials}
    picture, _ = render(scene(**changes))
    for i in range(3):
        lobe = ashikhmin_shirley((0, 0, 1), (0, 0, 1), (0, 0, 1), 20 + i, 10, (1, 1, 1))
        columns = picture[:, [2 * i, 2 * i + 1, 2 * i + 6, 2 * i + 7], :3]
        np.testing.assert_allclose(
            columns, np.broadcast_to(lobe * colors[i], columns.shape), rtol=2e-5
        )
    planes, header = dump(scene(**changes), tmp_path / "d.exr")
    assert (planes["material.ID"] == np.repeat(np.arange(6) % 3, 2)).all()
    header = json.loads(header)
    assert header["renderer"] == "test"
    assert [m["id"] for m in header["materials"]] == [0, 1, 2]
    assert [m["ex"] for m in header["materials"]] == [20, 21, 22]


def test_dump_of_misses(tmp_path):
    planes, _ = dump(scene(camera=ortho(2)), tmp_path / "d.exr")
    miss = planes["material.ID"] == -1
    assert miss.mean() == 0.75
    for name, plane in planes.items():
        assert name == "material.ID" or (plane[miss] == 0).all()


def test_mesh_without_uvs_has_a_tangent_and_warns_once(tmp_path):
    ball = sphere(16)
    ball["corner_uvs"] = None
    _, state = render(scene(camera=ortho(1.1), meshes=[ball]))
    assert len(state["warnings"]) == 1 and "UV" in state["warnings"][0]
    planes, _ = dump(scene(camera=ortho(1.1), meshes=[ball]), tmp_path / "d.exr")
    hit = planes["material.ID"] == 0
    normal, tangent = vectors(planes, "N")[hit], vectors(planes, "T")[hit]
    wanted = unit(np.array([1.0, 0, 0]) - normal[:, :1] * normal)
    assert ((wanted * tangent).sum(1)[np.abs(normal[:, 0]) < 0.9] > 0.999).all()


def test_coarse_normal_map_warns():
    pixels = np.full((4, 4, 4), 128, np.uint8)
    fine = np.full((4, 4, 4), 0.50001, np.float32)
    for ex, data, expected in (
        (6000, pixels, 1),
        (6000, pixels / np.float32(255), 1),
        (6000, fine, 0),
        (100, pixels, 0),
    ):
        _, state = render(
            scene(images=[image(data)], materials=[material(normal_image=0, ex=float(ex))])
        )
        assert len(state["warnings"]) == expected, state


@pytest.mark.parametrize(
    "detail, ex, ey",
    [
        (detail, *e)
        for detail in ("GRAM_SCHMIDT", "ROTATE")
        for e in ((200, 10), (10, 200))
    ]
    + [("NONE", 200, 10), ("PERTURB", 200, 10), ("GRAM_SCHMIDT", 1000, 10)],
)
def test_reference_agrees_with_the_dump(tmp_path, detail, ex, ey):
    """Bumps, grazing views and lights, smooth normals: `shade check` within its limits.

    Not beyond: float32 directions alone cost `perturb` 1.0e-4 at exponent 1000, near the pole where
    it jumps, and all methods 1.5e-4 at 6170.
    """
    slope = 0.6 * np.cos(2 * np.pi * 6 * (np.arange(256) + 0.5) / 256)
    n = unit(np.stack(np.broadcast_arrays(-slope[None, :], -slope[:, None], 1.0), -1))
    description = scene(
        width=200,
        height=200,
        samples=1,
        camera=persp(0.35, (1, -3, 1.5)),
        meshes=[sphere(48), square(3, -1)],
        images=[image((0.5 + 0.5 * n).astype(np.float32))],
        materials=[material(ex=ex, ey=ey, detail=detail, normal_image=0)],
        lights=[sun((0.4, -0.5, 0.8)), point((1, -2, 0.3), (5, 5, 5)), sun((0.2, 0.9, 0.1))],
        dump=str(tmp_path / "d.exr"),
    )
    render(description)
    check = subprocess.run(
        [ROOT / "build/shade", "check", description["dump"]],
        capture_output=True,
        text=True,
        env={"LD_PRELOAD": ""},
    )
    assert check.returncode == 0, check.stdout + check.stderr
    assert "PASS" in check.stdout


def test_rotate_is_what_a_displaced_surface_does():
    """A height field as a normal map, and as a fine mesh with its own tangents."""
    slope, k = 0.6, 4 * np.pi

    def height_and_normal(u, v):
        n = np.stack(
            [
                -slope * np.cos(k * u) * np.sin(k * v),
                -slope * np.sin(k * u) * np.cos(k * v),
                np.ones_like(u),
            ],
            -1,
        )
        return slope / k * np.sin(k * u) * np.sin(k * v), unit(n)

    cuts = 400
    u, v = (a.ravel() for a in np.meshgrid(*[np.linspace(0, 1, cuts + 1)] * 2))
    height, normals = height_and_normal(u, v)
    corner = (np.arange(cuts)[:, None] * (cuts + 1) + np.arange(cuts)).reshape(-1, 1)
    displaced = mesh(
        np.stack([2 * u - 1, 2 * v - 1, 2 * height], -1),
        corner + np.array([0, 1, cuts + 2, 0, cuts + 2, cuts + 1]),
        normals,
        np.stack([u, v], -1),
    )
    centre = (np.arange(1024) + 0.5) / 1024
    texels = (0.5 + 0.5 * height_and_normal(*np.meshgrid(centre, centre))[1]).astype(np.float32)
    common = {"width": 128, "height": 128, "samples": 64, "lights": [sun((0.3, 0.5, 0.8))]}
    lobe = {"ex": 6170.84, "ey": 7.876543, "f0": (1, 1, 1)}
    truth, _ = render(
        scene(meshes=[displaced], materials=[material(detail="NONE", **lobe)], **common)
    )
    error = {}
    for detail in ("GRAM_SCHMIDT", "ROTATE"):
        picture, _ = render(
            scene(
                images=[image(texels)],
                materials=[material(detail=detail, normal_image=0, **lobe)],
                **common,
            )
        )
        error[detail] = np.abs(picture - truth)[..., 0].mean() / truth[..., 0].mean()
    assert error["ROTATE"] < 0.01 and error["GRAM_SCHMIDT"] > 0.2, error
