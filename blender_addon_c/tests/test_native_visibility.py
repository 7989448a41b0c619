# SPDX-License-Identifier: GPL-3.0-or-later
"""What some kinds of ray do not see: lamps, the sky, objects, alone and as instances of one mesh."""

import numpy as np
import pytest

from native_scenes import (
    area, box, chance, dump, few, image, material, mesh, native, ortho, point, render, scene, sky, sphere, square, sun)
from test_native_closures import TRANSLUCENT, TRANSPARENT, diffuse, glass, glossy, of, weighed
from test_native_light_paths import LIGHTS, SURFACES, of_plate, shining

COST = 7.8

CAMERA, DIFFUSE, GLOSSY, TRANSMISSION, SHADOW = 1, 2, 4, 8, 16
PIXELS = np.full((8, 16, 3), 0.2, np.float32)
PIXELS[6, 8:12] = (6, 3, 1)
AROUND = {"images": [image(PIXELS)], "sky": sky()}


def picture(**changes):
    return render(scene(**changes))[0][..., :3].astype(float)


@pytest.mark.parametrize("kind", [*LIGHTS, "sharp"])
@pytest.mark.parametrize("beside", [False, True])
def test_a_lamp_is_hidden_from_kinds_of_surface(kind, beside):
    """beside: another lamp, so that samples choose."""
    lamp = LIGHTS.get(kind) or point((-1.2, 0, 1.6), (2, 2, 2))
    rest = [point((0.3, 0, 3.0))] * 5 * beside
    # wide metal and matt: of their own, mixed, each must lose its own light
    mixed = of(weighed(glossy(0.5), 0.5), weighed(diffuse(), 0.5))
    for hidden in (0, DIFFUSE, GLOSSY, TRANSMISSION):
        for surface, sees in (("wide", hidden != GLOSSY), ("matt", hidden != DIFFUSE)):
            both = of_plate(SURFACES[surface], [lamp | {"hidden": hidden}, *rest], samples=few(256))
            wanted = of_plate(SURFACES[surface], [lamp, *rest] if sees else rest, samples=few(256))
            np.testing.assert_allclose(both, wanted, rtol=0 if not rest else chance(0.03), atol=1e-7)
    parts = [of_plate(mixed, [lamp | {"hidden": hidden}], samples=few(1024)) for hidden in (0, DIFFUSE, GLOSSY)]
    assert parts[1].min() > 0.01 and parts[2].min() > 0.01
    np.testing.assert_allclose(parts[1] + parts[2], parts[0], rtol=chance(0.02))


def test_a_lamp_that_light_through_surfaces_does_not_meet():
    """Below a sheet that lets it through, by a facet or spread; beside one that mirrors it."""
    lamp = area((0, 0, 2), (2, 2), (3, 3, 3))
    below = {"camera": ortho(0.3, (0, 0, -3)), "samples": 64, "max_bounces": 2}
    for sheet, kinds in ((of(TRANSLUCENT), DIFFUSE), (of(glass(0.3)), TRANSMISSION)):
        for hidden in (0, DIFFUSE, GLOSSY, TRANSMISSION):
            seen = picture(lights=[lamp | {"hidden": hidden}], materials=[sheet], **below).mean()
            if hidden == kinds:
                assert seen == 0
            elif kinds == TRANSMISSION or hidden != TRANSMISSION:  # what is spread is of both kinds
                assert seen > 0.05
    mirrored = [picture(lights=[lamp | {"hidden": hidden}], materials=[of(glass(0.3))], samples=64).mean()
                for hidden in (0, TRANSMISSION)]
    assert mirrored[0] > 0.005 and mirrored[1] == pytest.approx(mirrored[0], rel=1e-6)


@pytest.mark.parametrize("around", [{"background": (0.5, 1, 2)}, AROUND])
@pytest.mark.parametrize("surface, own", [("wide", GLOSSY), ("matt", DIFFUSE)])
def test_a_sky_is_hidden_from_kinds_of_surface(around, surface, own):
    given = {"max_bounces": 1, "samples": few(256), "transparent": False}
    clear = of_plate(SURFACES[surface], [], **around, **given)
    assert clear.min() > 0.02
    for hidden in (CAMERA, DIFFUSE, GLOSSY, TRANSMISSION):
        seen = of_plate(SURFACES[surface], [], **around, **given, sky_hidden=hidden)
        np.testing.assert_allclose(seen, 0 if hidden == own else clear, rtol=1e-6)


def test_a_sky_hidden_from_the_camera_is_so_behind_a_pane():
    pane = of(weighed(TRANSPARENT, 0.5))
    for around in ({"background": (1, 1, 1)}, AROUND):
        for hidden in (0, CAMERA):
            seen = picture(lights=[], materials=[pane], transparent=False, sky_hidden=hidden, **around)
            assert seen.mean() == 0 if hidden else seen.mean() > 0.05


def test_the_camera_sees_an_image_of_its_own():
    """Of half the light, beside what lights the scene: behind all, and by the half of a pane that lets it through."""
    seen = AROUND | {"backdrop_sky": sky(strength=(0.5, 0.25, 1.0))}
    around = picture(meshes=[], instances=[], lights=[], transparent=False, **seen)
    plain = picture(meshes=[], instances=[], lights=[], transparent=False, **AROUND)
    np.testing.assert_allclose(around, plain * (0.5, 0.25, 1.0), rtol=1e-5)
    matt = picture(lights=[], transparent=True, samples=64, **seen)
    np.testing.assert_array_equal(matt, picture(lights=[], transparent=True, samples=64, **AROUND))
    pane = {"lights": [], "materials": [of(weighed(TRANSPARENT, 0.5))], "transparent": False}
    np.testing.assert_allclose(picture(**pane, **seen), picture(**pane, **AROUND) * (0.5, 0.25, 1.0), rtol=1e-5)
    assert picture(**pane, **seen, sky_hidden=CAMERA).max() == 0


def look(*rays, **sees):
    return {"rays": np.array(rays, np.uint32), **sees}


@pytest.mark.parametrize("surface, own", [("wide", GLOSSY), ("matt", DIFFUSE)])
def test_rays_see_another_world_by_their_way(surface, own):
    """No light is drawn from an even one: what they see is all there is, of one colour or an image."""
    there = {"background": (0.5, 1, 2), "samples": 256}
    clear = of_plate(SURFACES[surface], [], **there)
    for sees in ({"background": (2, 0.25, 1)}, {"sky": sky(strength=(0.1, 0.5, 3.0))}):
        images = {"images": [image(np.full((4, 8, 3), (2, 0.25, 1), np.float32))]}
        seen = of_plate(SURFACES[surface], [], **there, **images, looks=[look(own, **sees)])
        wanted = np.array((2, 0.25, 1)) * sees.get("sky", {}).get("strength", 1) / (0.5, 1, 2)
        np.testing.assert_allclose(seen, clear * wanted, rtol=1e-3)
        other = look(own ^ DIFFUSE ^ GLOSSY, TRANSMISSION, **sees)
        np.testing.assert_array_equal(of_plate(SURFACES[surface], [], **there, **images, looks=[other]), clear)
        hidden = of_plate(SURFACES[surface], [], **there, **images, looks=[look(own, **sees)], sky_hidden=own)
        assert hidden.max() == 0


def test_an_image_shares_with_what_rays_see():
    """Matt, below one even image that directions are drawn from: shares of drawn rays are their squared
    densities' [VeachGuibas1995]. The mean of mu^2 / (mu^2 + a) over 2 mu is 1 - a log((1 + a) / a), a = 1 / 16."""
    drawn = 1 - np.log(17) / 16
    even = {"images": [image(np.full((4, 8, 3), 1.0, np.float32))], "sky": sky(), "background": (0, 0, 0)}
    seen = of_plate(SURFACES["matt"], [], **even, looks=[look(DIFFUSE, background=(2, 0, 1))])
    np.testing.assert_allclose(seen, 0.5 * (1 + drawn * np.array((1, -1, 0))), rtol=chance(0.005))


def instance(mesh, hidden=0, z=0.0, scale=1.0):
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[2, 3] = z
    return {"mesh": mesh, "matrix": matrix.ravel().tolist(), "hidden": hidden}


@pytest.mark.parametrize("shared", [False, True])
def test_an_object_is_hidden_from_kinds_of_ray(shared):
    """A sheet over a plate: the eye, the shadows and the plate's own rays each see it or do not."""
    plate, sheet = square(1.0), square(3.0)
    meshes = [plate, sheet]
    if shared:  # sheets far away make many copies of it
        cuts = few(256)
        t = np.linspace(-3, 3, cuts + 1)
        x, y = np.meshgrid(t, t)
        i = np.arange(cuts * (cuts + 1)).reshape(cuts, cuts + 1)[:, :-1].reshape(-1, 1)
        meshes[1] = mesh(np.stack([x, y, 0 * x], -1).reshape(-1, 3),
                         (i + np.array([0, 1, cuts + 2, 0, cuts + 2, cuts + 1])).reshape(-1, 3))
    meshes[1]["material"][:] = 1
    matt = material(f0=(0, 0, 0), fresnel="NONE", kd=(0.5,) * 3)

    def seen(hidden, **changes):
        return picture(meshes=meshes, materials=[matt, shining(0.0)], samples=16, camera=ortho(0.5), **changes,
                       instances=[instance(0), instance(1, hidden, 1.0), instance(1, 0, 500.0)]).mean((0, 1))

    lit = {"lights": [sun(irradiance=(np.pi,) * 3)]}
    sky_only = {"lights": [], "background": (1, 1, 1), "max_bounces": 2}
    for case in (lit, sky_only):
        assert (seen(0, **case) == 0).all()  # black from above
    far = CAMERA | SHADOW | DIFFUSE | GLOSSY | TRANSMISSION
    # the other sheet, far above, stops the sun but not the sky
    assert (seen(CAMERA, **lit) == 0).all() and (seen(CAMERA | SHADOW, **lit) == 0).all()
    near = [instance(0), instance(1, 0, 1.0), instance(1, 0, -500.0)]
    for hidden, sunny, airy in ((CAMERA, 0, 0.1), (CAMERA | SHADOW, 0.5, 0.1), (CAMERA | DIFFUSE, 0, 0.5),
                                (CAMERA | GLOSSY, 0, 0.1), (far, 0.5, 0.5)):
        near[1]["hidden"] = hidden
        both = [picture(meshes=meshes, materials=[matt, shining(0.0)], samples=64, camera=ortho(0.05), instances=near,
                        **case).mean() for case in (lit, sky_only)]
        assert both[0] == pytest.approx(sunny, abs=1e-5)
        if airy == 0.5:
            assert both[1] == pytest.approx(0.5, rel=1e-4)
        else:  # what a square of 6 x 6 at height 1 leaves of the half sphere
            assert both[1] == pytest.approx(0.5 * (1 - form_factor(3.0)), rel=0.05)


def form_factor(half):
    """Of a square over its middle at height 1, seen from a facet below: quadrature."""
    t = (np.arange(2000) + 0.5) / 2000 * 2 * half - half
    x, y = np.meshgrid(t, t)
    return (1 / (np.pi * (x**2 + y**2 + 1) ** 2)).mean() * (2 * half) ** 2


def test_faces_that_shine_and_are_hidden():
    """No light any more that is drawn: rays of other kinds find it all the same."""
    lamp = square(0.5, 1.0, 1)
    matt = material(f0=(0, 0, 0), fresnel="NONE", kd=(0.5,) * 3)
    given = {"meshes": [square(), lamp], "lights": [], "samples": few(1024), "width": 8, "height": 8,
             "camera": ortho(1e-3, (1.5, 0, 1.5)), "max_bounces": 1}

    def seen(hidden, drawn):
        return picture(**given, materials=[matt, shining(3.0) | {"drawn": drawn}],
                       instances=[instance(0), instance(1, hidden)]).mean()

    truth = seen(0, True)
    assert truth > 0.1
    assert seen(GLOSSY, False) == pytest.approx(truth, rel=chance(0.02))
    assert seen(DIFFUSE, False) == 0


@pytest.mark.parametrize("sheet, beside", [(TRANSLUCENT, DIFFUSE), (glass(0.3, reflects=False), GLOSSY)])
def test_rays_through_a_surface_are_of_no_kind_beside(sheet, beside):
    """What they meet below it shines for them, though rays that this kind of closure mirrors would not see it."""
    given = {"meshes": [square(), square(200.0, -2.0, 1)], "lights": [], "max_bounces": 1, "samples": 16, "camera": ortho(0.3)}

    def seen(hidden):
        return picture(**given, materials=[of(sheet), shining(3.0) | {"drawn": False}], instances=[instance(0), instance(1, hidden)]).mean()

    assert seen(0) > 0.5 and seen(beside) == seen(0) and seen(TRANSMISSION) == 0


def moved(index, x, z=0.0, size=1.0, **more):
    return {"mesh": index, "matrix": [size, 0, 0, x, 0, size, 0, 0, 0, 0, 1, z, 0, 0, 0, 1], **more}


def halves(floor, plate, beside=(), z=2.0, drawn=True):
    """Means of the left and of the right of two plates on the floor, under a sheet and one that shines."""
    seen = picture(materials=[of(floor), shining(3.0) | {"drawn": drawn}, of(weighed(TRANSPARENT, 0.5))],
                   lights=list(beside), samples=few(1024), max_bounces=2, transparent_max_bounces=4,
                   meshes=[square(0.5), square(2.0, material_index=1), square(9.0, material_index=2)],
                   camera=ortho(eye=(0, 0, 1)), instances=[moved(0, -0.5), moved(0, 0.5, unlit=1 << 3),
                                                           moved(1, 0, z, **plate), moved(2, 0, 1.8)])
    return seen[4:12, 2:6].mean(), seen[4:12, 10:14].mean()


@pytest.mark.parametrize("drawn", [True, False])
@pytest.mark.parametrize("floor", [diffuse(), glossy(0.3), glossy(0.0)])
def test_a_plate_that_shines_for_some(floor, drawn):
    """By light samples and rays, by rays alone; beside lamps, from which samples choose."""
    everywhere = halves(floor, {}, drawn=drawn)
    lit, unlit = halves(floor, {"link": 3}, drawn=drawn)
    assert everywhere[0] > 0.5 and lit == pytest.approx(everywhere[0], rel=1e-5) and unlit == 0
    lamps = [point((0, 0, 1.5), (2, 2, 2), 0.1)] * 2
    alone, both = halves(floor, {}, lamps, z=-9.0, drawn=drawn), halves(floor, {"link": 3}, lamps, drawn=drawn)
    assert both[0] == pytest.approx(everywhere[0] + alone[0], rel=chance(0.02)) and both[1] == pytest.approx(alone[1], rel=chance(0.02))


@pytest.mark.parametrize("pane", [False, True])
@pytest.mark.parametrize("given", [{"link": 3}, {"shade": 5}])
def test_a_plate_that_shines_is_seen_by_the_camera(given, pane):
    """Through a pane, too, whose rays go straight on."""
    seen = picture(materials=[shining(3.0), of(weighed(TRANSPARENT, 0.5))], lights=[], transparent_max_bounces=4,
                   meshes=[square(4.0), square(4.0, material_index=1)],
                   instances=[moved(0, 0, **given, unlit=1 << 3, shadeless=1 << 5), *[moved(1, 0, 0.5)] * pane])
    np.testing.assert_allclose(seen, 1.5 if pane else 3.0, rtol=1e-6)


@pytest.mark.parametrize("floor, limit", [(diffuse(), 0.01), (glossy(0.3), 0.03)], ids=["matt", "rough"])
def test_light_samples_alone_find_what_some_do_not_shade(floor, limit):
    """Nothing is in the way: what rays would have found is not missing, though on what is rough that is most of it."""
    assert halves(floor, {"shade": 5}) == pytest.approx(halves(floor, {}), rel=limit)


def test_one_of_two_plates_is_not_shaded():
    """Beside lamps: their light is the sum of that of each alone, below a roof that stops none of one's."""
    roof = moved(0, 0, 0.6, 0.9, shadeless=1 << 5)

    def seen(plates, lamps=()):
        shown = picture(materials=[of(diffuse()), shining(3.0)], lights=list(lamps), samples=few(4096), max_bounces=1,
                        camera=ortho(eye=(0, 0, 0.2)), meshes=[square(0.5), square(0.3, material_index=1)],
                        instances=[moved(0, 0), roof, *plates])
        return shown[4:12, 6:10].mean()

    plates = [moved(1, -0.5, 2.0, shade=5), moved(1, 0.9, 1.4)]
    lamps = [point((-1.2, 0.2, 1.0), (1, 1, 1)), point((1.2, 0.1, 0.9), (0.5, 0.5, 0.5))]
    parts = [seen(plates[:1]), seen(plates[1:]), seen([], lamps)]
    assert min(parts) > 0.001 and seen(plates[:1]) > 1.5 * seen([moved(1, -0.5, 2.0)])
    assert seen(plates, lamps) == pytest.approx(sum(parts), rel=chance(0.02))


@pytest.mark.parametrize("sheet", [False, True])
@pytest.mark.parametrize("shade", [{}, {"shade": 5}])
def test_a_plate_whose_light_some_do_not_shade(shade, sheet):
    """Under two roofs, of which one stops none of it; and, or not, under a sheet that halves it."""
    clear = of(weighed(TRANSPARENT, 0.5))
    roofs = [moved(0, -0.5, 0.6, 0.9), moved(0, 0.5, 0.6, 0.9, shadeless=1 << 5)]
    def seen(*roofs):
        shown = picture(materials=[of(diffuse()), shining(3.0), clear], lights=[], samples=1024, max_bounces=1,
                        transparent_max_bounces=4, camera=ortho(eye=(0, 0, 0.2)),
                        meshes=[square(0.5), square(0.3, material_index=1), square(3.0, material_index=2)],
                        instances=[moved(0, -0.5), moved(0, 0.5), moved(1, -0.5, 2.0, **shade), moved(1, 0.5, 2.0, **shade),
                                   *[moved(2, 0, 1.0)] * sheet, *roofs])
        return shown[7:9, 3:5].mean(), shown[7:9, 11:13].mean()

    free, below = seen(), seen(*roofs)
    assert free[0] > 0.05 and below[0] < 0.9 * free[0]
    assert below[1] < 0.9 * free[1] if not shade else below[1] == pytest.approx(free[1], rel=0.03)


def test_a_dump_knows_of_no_hidden_lamps(tmp_path):
    seen, hidden = (dump(scene(lights=[sun() | {"hidden": bits}]), tmp_path / "d.exr")[0]["light0.S.R"]
                    for bits in (0, GLOSSY))
    assert seen.max() > 0 and (seen == hidden).all()


def test_threads_change_no_bit():
    given = {"lights": [LIGHTS["area"] | {"hidden": GLOSSY}, sun((0.3, 0, 1), angle=0.1)] + [point((0, 0, 2))] * 4,
             "meshes": [square(), sphere(12, 0.4, (0, 0, 0.5)), box((0.5, 0.5, 0), (0.7, 0.7, 0.4))],
             "materials": [of(weighed(glossy(0.5), 0.5), weighed(diffuse(), 0.5))], "sky_hidden": DIFFUSE, **AROUND,
             "width": 40, "height": 30, "max_bounces": 4,
             "instances": [instance(0), instance(1, GLOSSY), instance(2, CAMERA | SHADOW)]}
    assert (picture(**given, threads=1) == picture(**given, threads=2)).all()


@pytest.mark.parametrize("wrong", [{"lights": [sun() | {"hidden": 16}]}, {"sky_hidden": 16},
                                   {"instances": [instance(0, 32)]}])
def test_malformed(wrong):
    with pytest.raises(ValueError, match="hidden"):
        native.start(scene(**wrong))
