# SPDX-License-Identifier: AGPL-3.0-or-later
"""The dump: what POV-Ray shaded, held against the reference and against geometry."""
import numpy as np
import pytest

from scenes import LAMP, OBJECTS, SUN, dot, finish, largest_error, normalise, saddle, scene

COST = 5.9

BUMPS = "normal { bumps .4 scale .2 }"


def textured(name, words="", detail="rotate", bumps=BUMPS):
    """An object of OBJECTS, or the beginning of one, in metal."""
    return f"{OBJECTS.get(name, name)} texture {{ pigment {{ rgb .5 }} {bumps} {finish(words, detail)} }} }}\n"


@pytest.mark.parametrize("name", OBJECTS)
def test_object_agrees_with_the_references(render, shade_check, name):
    dump = render(scene(textured(name, "specular rgb <.9, .8, .6> fresnel schlick")), (100, 75)).dump
    assert dump.hit.mean() > .05
    assert all(dump.S[k].max() > 0 for k in range(2))
    assert largest_error(dump) < 5e-5
    shade_check(dump)


@pytest.mark.parametrize("detail", ["none", "perturb", "gram_schmidt", "rotate"])
@pytest.mark.parametrize("exponents", ["200, 10", "10, 200", "50, 50"])
def test_detail_agrees_with_the_references(render, shade_check, detail, exponents):
    objects = f"{OBJECTS['sphere']} texture {{ pigment {{ rgb .5 }} {BUMPS} {finish('', detail, exponents)} }} }}"
    dump = render(scene(objects), (84, 63)).dump
    if detail != "perturb":  # its phi is that of h, its theta that of n: covered by shade check
        assert largest_error(dump) < 5e-5
    shade_check(dump)


@pytest.mark.parametrize("groove", ["x", "y", "auto"])
def test_groove_agrees_with_the_references(render, shade_check, groove):
    dump = render(scene(textured("torus", f"groove {groove}")), (84, 63)).dump
    assert dump.header["materials"][0]["groove"] == groove
    assert largest_error(dump) < 5e-5
    shade_check(dump)


def test_picture_is_the_sum_of_the_dumped_lights(render):
    result = render(scene(textured("sphere", "specular rgb <.9, .8, .6>", detail="rotate")), (96, 72))
    dump, image = result.dump, result.image
    np.testing.assert_allclose(image[dump.hit], dump.S.sum(0)[dump.hit], rtol=1e-3, atol=1e-6)  # half floats


@pytest.mark.parametrize("name", ["sphere", "torus", "box", "mesh2"])
def test_frames(render, name):
    dump = render(scene(textured(name)), (96, 72)).dump
    for vectors in (dump.N, dump.T, dump.Ns, dump.V, *dump.L):
        np.testing.assert_allclose(np.linalg.norm(vectors[dump.hit], axis=-1), 1, atol=1e-6)
    assert np.abs(dot(dump.N, dump.T)[dump.hit]).max() < 1e-6
    assert dot(dump.N, dump.V)[dump.hit].min() >= -1e-6
    eye = normalise(np.array([1, 2, -5]) - dump.P)
    np.testing.assert_allclose(dump.V[dump.hit], eye[dump.hit], atol=1e-6)
    misses = ~dump.hit
    assert all(np.all(plane[misses] == (-1 if channel == "material.ID" else 0))
               for channel, plane in dump.channels.items())


def test_sphere_tangent_is_around_the_axis(render):
    # u grows with the angle from x towards z: dP/du = (-z, 0, x)
    dump = render(scene(textured("sphere")), (96, 72)).dump
    p, n = dump.P[dump.hit], dump.N[dump.hit]
    np.testing.assert_allclose(n, p, atol=1e-6)
    expected = normalise(np.stack([-p[:, 2], 0 * p[:, 0], p[:, 0]], -1))
    np.testing.assert_allclose(dump.T[dump.hit], expected, atol=2e-6)


def test_scaled_sphere_tangent_is_carried_along(render):
    # M = scale <1, 2, .5> then rotate 30*z: dP/du goes through M, then orthogonal to the normal
    dump = render(scene(textured("sphere { 0, 1 scale <1, 2, .5> rotate 30*z")), (96, 72)).dump
    a = np.radians(30)
    M = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) @ np.diag([1, 2, .5])
    p = dump.P[dump.hit] @ np.linalg.inv(M).T
    du = np.stack([-p[:, 2], 0 * p[:, 0], p[:, 0]], -1) @ M.T
    n = dump.N[dump.hit]
    expected = normalise(du - dot(du, n)[:, None] * n)
    away_from_poles = np.abs(p[:, 1]) < .999
    np.testing.assert_allclose(dump.T[dump.hit][away_from_poles], expected[away_from_poles], atol=5e-6)


def test_mesh_tangent_follows_u(render):
    # the saddle's u = (x + z)/2: on the tangent plane of the smooth normal, along the surface's (1, y', 1)
    dump = render(scene(textured("mesh2")), (112, 84)).dump
    x, z = dump.P[dump.hit][:, 0], dump.P[dump.hit][:, 2]
    du = np.stack([np.ones_like(x), .6 * (x - z), np.ones_like(x)], -1)
    n = dump.N[dump.hit]
    sign = np.sign(n[:, 1])[:, None]  # flipped where seen from below
    expected = normalise(du - dot(du, n)[:, None] * n)
    angle = np.degrees(np.arccos(np.clip(dot(dump.T[dump.hit], expected), -1, 1)))
    assert np.median(angle) < 1 and angle.max() < 5, "a mesh of 8x8 cells is that coarse"
    assert sign.max() == 1


def test_axis_tangent_moves_with_the_object(render):
    objects = textured("box { -.7, .7", "tangent <0, 1, 0>")[:-2] + "rotate <-20, 30, 10> }"
    dump = render(scene(objects), (96, 72)).dump
    ax, ay, az = np.radians([-20, 30, 10])
    # in its left-handed space POV-Ray turns by the left hand: the usual matrices
    rx = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
    ry = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
    rz = np.array([[np.cos(az), -np.sin(az), 0], [np.sin(az), np.cos(az), 0], [0, 0, 1]])
    axis = rz @ ry @ rx @ [0, 1, 0]
    n = dump.N[dump.hit]
    rest = axis - dot(axis, n)[:, None] * n
    clear = np.linalg.norm(rest, axis=-1) > .01
    assert clear.any() and not clear.all(), "one face of the box has the axis for its normal: there the tangent is another"
    np.testing.assert_allclose(dump.T[dump.hit][clear], normalise(rest[clear]), atol=1e-5)


def test_irradiance_is_pi_times_the_light(render):
    # a blocker in front of the lamp only
    objects = textured("sphere", bumps="") + "sphere { <-3, 1, -2>, .3 pigment { rgb 1 } }\n"
    dump = render(scene(objects), (112, 84)).dump
    sun, lamp = dump.E[0][dump.hit], dump.E[1][dump.hit]
    lit = sun[:, 0] > 0
    np.testing.assert_allclose(sun[lit], np.tile(np.pi * np.array([1, .9, .8]), (lit.sum(), 1)), rtol=1e-6)
    toward = dot(dump.N, dump.L[1])[dump.hit] > .05
    shadowed = toward & (lamp[:, 0] == 0)
    assert shadowed.any() and (toward & ~shadowed).any()
    assert np.all(dump.S[1][dump.hit][shadowed] == 0)
    np.testing.assert_allclose(lamp[toward & ~shadowed][:, 2], .6 * np.pi, rtol=1e-6)
    direction = normalise(np.array([-6, 2, -4]) - dump.P)
    np.testing.assert_allclose(dump.L[1][dump.hit][lamp[:, 0] > 0], direction[dump.hit][lamp[:, 0] > 0], atol=1e-6)


def test_lights_come_in_order_of_declaration(render, shade_check):
    colours = [.1, .2, .3, .4, .5, .6, .7, .8, .9, 1.0, 1.1, 1.2]
    lights = "".join(f"light_source {{ <{i - 5}, 4, -8>, rgb {c} }}\n" for i, c in enumerate(colours))
    dump = render(scene(textured("sphere"), lights), (64, 48)).dump
    assert dump.lights == 12
    for k, colour in enumerate(colours):
        assert dump.E[k].max() == pytest.approx(np.pi * colour, rel=1e-6)
    shade_check(dump)


def test_lights_of_a_group_follow_the_global_ones(render, shade_check):
    objects = "light_group { light_source { <4, 4, -6>, rgb .25 } " + textured("sphere") + "global_lights on }\n"
    dump = render(scene(objects + LAMP, SUN), (64, 48)).dump
    assert [dump.E[k].max() / np.pi for k in range(dump.lights)] == pytest.approx([1, .6, .25], rel=1e-6)
    shade_check(dump)


@pytest.mark.parametrize("light", [
    "spotlight point_at 0 radius 4 falloff 9", "cylinder point_at 0 radius .4 falloff .7", "fade_distance 3 fade_power 2",
    "area_light 2*x, 2*y, 4, 4", "spotlight point_at <.4, 0, 0> radius 4 falloff 5 area_light x, y, 3, 3 jitter"])
def test_kinds_of_lights(render, shade_check, light):
    dump = render(scene(textured("sphere"), f"light_source {{ <3, 4, -6>, rgb 1 {light} }}"), (96, 72)).dump
    assert dump.S.max() > 0
    assert largest_error(dump) < 5e-5
    shade_check(dump)


def test_full_area_light_shades_but_is_left_out(render):
    lights = "".join(f"light_source {{ <3, 4, -6>, rgb {c} area_light 2*x, 2*y, 4, 4 {words} }}\n" for c, words in ((0, ""), (1, "area_illumination")))
    result = render(scene(textured("sphere"), lights))
    assert "light 1 has area_illumination" in result.message and result.message.count("has area_illumination") == 1
    assert result.image.max() > .1
    assert result.dump.S.max() == 0 and result.dump.E.max() == 0


def test_materials_and_misses(render, shade_check):
    objects = (textured("sphere { -x, .7") + textured("sphere { x, .7", "specular rgb .5", "perturb") +
               "plane { y, -1 pigment { rgb .5 } }\n")
    dump = render(scene(objects), (96, 72)).dump
    assert set(np.unique(dump.id)) == {-1, 0, 1}
    header = dump.header
    assert header["renderer"] == "POV-Ray 3.7.0.10 + libshade" and header["version"]
    assert [m["detail"] for m in header["materials"]] == ["rotate", "perturb"]
    assert [m["id"] for m in header["materials"]] == [0, 1]
    assert all(m["name"].startswith("scene.pov:") for m in header["materials"])
    np.testing.assert_allclose(dump.color[dump.id == 1], .5)
    shade_check(dump)


def test_threads_do_not_matter(render):
    # no_shadow: POV-Ray's self-shadowing depends on what the thread traced just before (its shadow cache)
    text = scene(textured(saddle(extra="no_shadow ")))
    one = render(text, (112, 84), ["+WT1"]).dump.channels
    four = render(text, (112, 84), ["+WT4", "+BS8"]).dump.channels
    assert all(np.array_equal(one[name], four[name]) for name in one)


def test_dump_holds_one_ray_a_pixel(render):
    text = scene(textured("sphere")).replace("angle 30", "angle 30 focal_point 0 aperture .4 blur_samples 20")
    plain = render(scene(textured("sphere"))).dump.channels
    result = render(text, options=["+A0.1", "+AM2", "+SP16"])
    assert "anti-aliasing is switched off" in result.message and "focal blur is switched off" in result.message
    dump = result.dump.channels
    assert all(np.array_equal(plain[name], dump[name]) for name in plain)


def test_first_layer_counts(render, shade_check):
    layers = f"texture {{ pigment {{ rgb .5 }} {finish('specular rgb .3')} }} texture {{ pigment {{ rgbt <.5, .5, .5, .5> }} {finish('specular rgb .7', 'none')} }}"
    dump = render(scene(f"sphere {{ 0, 1 {layers} }}")).dump
    np.testing.assert_allclose(dump.color[dump.hit], .7)  # the last layer written is the top one
    shade_check(dump, everything=False)


def test_only_the_primary_hit_is_recorded(render):
    # a mirror in front of the metal: the metal is seen, but not first
    objects = textured("sphere") + "box { <-3, -3, -2.1>, <.3, 3, -2> pigment { rgbt <.5, .5, .5, .7> } finish { reflection .3 } }\n"
    result = render(scene(objects), (96, 72))
    alone = render(scene(textured("sphere")), (96, 72)).dump.hit
    assert 0 < result.dump.hit.sum() < alone.sum()
    assert np.all(alone[result.dump.hit])


def test_nothing_hit_is_a_dump_of_misses(render):
    dump = render(scene("sphere { 0, 1 pigment { rgb 1 } }")).dump
    assert not dump.hit.any() and dump.header["materials"] == []


def test_no_lights(render):
    dump = render(scene(textured("sphere"), "")).dump
    assert dump.lights == 0 and dump.hit.any()


@pytest.mark.parametrize("path, wrong", [("missing/folder/dump.exr", "in the folder missing/folder/: cannot write: No such file or directory"),
                                         ("/proc/dump.exr", "in the folder /proc/: cannot write: "), (".", "in the folder .: cannot write: is a folder")])
def test_unwritable_dump_is_an_error(render, path, wrong):
    """Before the picture is begun."""
    result = render(scene(textured("sphere")), dump=path, fails=True)
    assert result.status != 0
    assert f"LIBSHADE_DUMP: {path}, {wrong}" in result.message, result.message
    assert "Pixels:" not in result.message and not result.image_path.exists()
