# SPDX-License-Identifier: AGPL-3.0-or-later
"""bump_image: the texel, the frame and the side that Blender's Normal Map node would take.

The convention. A normal map is what Blender, OpenGL and MikkTSpace mean by one: red along dP/du, green along
dP/dv, blue along the normal; u to the right of the picture, v up. A mesh exported from Blender with y and z
exchanged (Blender is right-handed with z up, POV-Ray left-handed with y up) keeps its UVs, and looks the same.
"""
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from scenes import dot, finish, normalise, saddle

sys.path.insert(0, str(Path(__file__).parents[2] / "libshade/python"))
import shade  # noqa: E402

COST = 15.4

TOP = """#version 3.7; global_settings { assumed_gamma 1 }
camera { orthographic location <.5, 3, .5> right 1.6*x up 1.2*z direction -y }
light_source { <3, 5, -1>, rgb 1 }
"""


def write_png(path, pixels, kind, colour_space=None):
    write(path, np.asarray(pixels, kind), kind, colour_space)


def write(path, pixels, kind, colour_space=None, origin=(0, 0), channels=("R", "G", "B")):
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, kind)
    spec.channelnames = tuple(channels)
    spec.x, spec.y = origin
    spec.attribute("oiio:UnassociatedAlpha", 1)  # the colours as they are, not divided by alpha
    if colour_space:
        spec.attribute("oiio:ColorSpace", colour_space)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec) and output.write_image(np.ascontiguousarray(pixels)), output.geterror()
    output.close()


def random_map(shape=(5, 7), seed=1):
    """Normals within 60 degrees of the pole, as colours, row 0 at the top."""
    n = np.random.default_rng(seed).normal(size=shape + (3,)) * [1, 1, .2] + [0, 0, 1.2]
    n[..., 2] = np.abs(n[..., 2]) + .3
    return (normalise(n) + 1) / 2


def bilinear(colours, uv):
    """Blender's look-up: repeat, texel centres at half, the first row at the top."""
    height, width, _ = colours.shape
    x, y = uv[..., 0] * width - .5, (1 - uv[..., 1]) * height - .5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = (x - i)[..., None], (y - j)[..., None]
    at = lambda a, b: colours[b % height, a % width]
    return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) + t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1))


def mapped(colours, uv, strength=1.0):
    n = normalise(2 * bilinear(colours, uv) - 1)
    slope = n * (strength, strength, min(strength, 1)) + (0, 0, 1 - min(strength, 1))
    return normalise(slope)


def quad(uv="<0,0>, <1,0>, <1,1>, <0,1>", faces="<0,1,2>, <0,2,3>", normals=True, extra=""):
    """Blender's square (0..1, 0..1, 0) with the normal +z and u = x, v = y, its y and z exchanged."""
    text = "mesh2 { vertex_vectors { 4, <0,0,0>, <1,0,0>, <1,0,1>, <0,0,1> }\n"
    text += "normal_vectors { 4, y, y, y, y }\n" if normals else ""
    return text + f"uv_vectors {{ 4, {uv} }} face_indices {{ 2, {faces} }} {extra}"


def textured(geometry, file="exr \"map.exr\"", more="", normal="", tangent=""):
    return f"{geometry} texture {{ pigment {{ rgb .5 }} {normal} {finish(f'bump_image {{ {file} {more} }} {tangent}')} }} }}\n"


def from_blender(n):
    return n[..., [0, 2, 1]]


def check(dump, expected, limit=2e-6):
    angle = np.linalg.norm(np.cross(dump.Ns[dump.hit], expected[dump.hit]), axis=-1)
    assert dump.hit.sum() > 200
    assert angle.max() < limit and dot(dump.Ns[dump.hit], expected[dump.hit]).min() > 0


@pytest.mark.parametrize("filtering", ["filter off", ""])
def test_once_is_flat_beside_the_picture(render, shade_check, colours, filtering):
    """As stock's `once` of pictures. Texels at the edge pass into the plate over half a texel each way."""
    more = f"strength 1.5 scale <.4, .5> translate <.3, -.2> once {filtering}"
    dump = render(TOP + textured(quad(), more=more), (96, 72)).dump
    around = np.full((11, 13, 3), (.5, .5, 1.))
    around[3:8, 3:10] = colours
    at = (dump.uv - (.3, -.2)) / (.4, .5)
    inside = ((at > -.2) & (at < 1.2)).all(-1)
    place = (at * (7, 5) + 3) / (13, 11)
    expected = np.where(inside[..., None], mapped(around, place, 1.5), (0, 0, 1.))
    assert .05 < np.mean(inside[dump.hit]) < .5
    check(dump, from_blender(expected), 2e-6 if filtering else .15)
    shade_check(dump)
    far = render(TOP + textured(quad(), more=more.replace("<.4, .5>", "<.04, .05>").replace("-.2>", ".2>")), (96, 72)).dump
    if not filtering:
        rough = far.channels["alpha.X"]
        at = (far.uv - (.3, .2)) / (.04, .05)
        beside = far.hit & ((at < -.8) | (at > 1.8)).any(-1)
        assert (rough[beside] == rough[far.hit].min()).all() and rough[far.hit].max() > rough[far.hit].min() + .02


@pytest.fixture
def colours(tmp_path):
    values = random_map()
    write(tmp_path / "map.exr", values.astype(np.float32), "float")
    return values.astype(np.float32).astype(float)


@pytest.mark.parametrize("uv, tangent, bitangent", [
    ("<0,0>, <1,0>, <1,1>, <0,1>", [1, 0, 0], [0, 1, 0]),     # as it is
    ("<1,0>, <0,0>, <0,1>, <1,1>", [-1, 0, 0], [0, 1, 0]),    # mirrored
    ("<0,0>, <0,-2>, <3,-2>, <3,0>", [0, 1, 0], [-1, 0, 0]),  # turned, stretched, repeated
])
def test_quad_as_in_blender(render, shade_check, colours, uv, tangent, bitangent):
    dump = render(TOP + textured(quad(uv)), (96, 72)).dump
    n = mapped(colours, dump.uv)
    T, B = np.array(tangent), np.array(bitangent)  # in Blender's space
    check(dump, from_blender(n[..., :1] * T + n[..., 1:2] * B + n[..., 2:] * np.array([0, 0, 1])))
    np.testing.assert_allclose(dump.T[dump.hit], np.tile(from_blender(T), (dump.hit.sum(), 1)), atol=1e-6)
    shade_check(dump)


CORNER_NORMALS = np.array([[-.3, 1, -.2], [.3, 1, -.2], [.3, 1, .2], [-.3, 1, .2]])


def curved_quad(p, colours, uv):
    """N, T and Ns of the quad whose corners lean outwards, by hand: both triangles share the diagonal."""
    x, z = p[..., :1], p[..., 2:]
    weights = np.where(x > z, np.concatenate([1 - x, x - z, z, 0 * x], -1), np.concatenate([1 - z, 0 * x, x, z - x], -1))
    corner = normalise(CORNER_NORMALS)
    along = np.array([1.0, 0, 0])  # dP/du
    tangents = normalise(along - dot(corner, along)[:, None] * corner)
    N = normalise(weights @ corner)
    T = weights @ tangents
    T = normalise(T - dot(T, N)[..., None] * N)
    up = np.array([0, 0, 1.0])  # dP/dv says on which side the bitangent is
    B = np.cross(N, T)
    B *= np.sign(dot(B, up))[..., None]
    n = mapped(colours, uv)
    return N, T, n[..., :1] * T + n[..., 1:2] * B + n[..., 2:] * N


@pytest.mark.parametrize("faces", ["<0,1,2>, <0,2,3>", "<0,2,1>, <0,3,2>", "<0,1,2>, <0,3,2>", "<2,0,1>, <3,0,2>"])
def test_winding_does_not_matter_where_there_are_normals(render, colours, faces):
    # (to POV-Ray a triangle with three equal normals is flat, and its winding decides: below)
    normals = ", ".join("<" + ",".join(map(str, n)) + ">" for n in CORNER_NORMALS)
    dump = render(TOP + textured(quad(faces=faces).replace("y, y, y, y", normals)), (96, 72)).dump
    for found, expected in zip((dump.N, dump.T, dump.Ns), curved_quad(dump.P, colours, dump.uv)):
        np.testing.assert_allclose(found[dump.hit], expected[dump.hit], atol=1e-5)
    assert dump.hit.sum() > 200


def test_uv_of_the_quad(render, colours):
    dump = render(TOP + textured(quad()), (96, 72)).dump
    np.testing.assert_allclose(dump.uv[dump.hit], dump.P[dump.hit][:, [0, 2]], atol=1e-6)


def test_flat_triangles_and_old_meshes(render, colours):
    old = "mesh { " + "".join(f"triangle {{ {a}, {b}, {c} uv_vectors {u}, {v}, {w} }} " for a, b, c, u, v, w in (
        ("0", "x", "x+z", "<0,0>", "<1,0>", "<1,1>"), ("0", "x+z", "z", "<0,0>", "<1,1>", "<0,1>")))
    for geometry in (quad(normals=False), quad(normals=False, faces="<0,2,1>, <0,3,2>"), old):
        dump = render(TOP + textured(geometry), (96, 72)).dump
        n, up = mapped(colours, dump.uv), dump.N[..., 1:2]
        # without normals the winding says which side is out, and the map is seen from there
        out = 1.0 if abs(dump.Ns[dump.hit][0] @ [1, 0, 0] - n[dump.hit][0, 0]) < 1e-5 else -1.0
        expected = from_blender(np.concatenate([out * n[..., :2], n[..., 2:]], -1))
        assert up[dump.hit].min() == 1
        check(dump, expected)


def test_seen_from_behind_a_bump_is_a_dent(render, shade_check, colours):
    below = TOP.replace("location <.5, 3, .5>", "location <.5, -3, .5>").replace("direction -y", "direction y").replace("<3, 5, -1>", "<3, -5, -1>")
    dump = render(below + textured(quad()), (96, 72)).dump
    np.testing.assert_allclose(dump.N[dump.hit], np.tile([0, -1, 0], (dump.hit.sum(), 1)), atol=1e-7)
    check(dump, -from_blender(mapped(colours, dump.uv)))
    shade_check(dump)


def test_mirrored_object(render, colours):
    dump = render(TOP + textured(quad(extra="scale <-1, 1, 1> translate x ")), (96, 72)).dump
    check(dump, from_blender(mapped(colours, dump.uv) * [-1, 1, 1]))


def test_turned_object(render, colours):
    text = TOP + textured(quad(extra="translate <-.5, 0, -.5> rotate <20, 30, 0> translate <.5, 0, .5> "))
    dump = render(text, (96, 72)).dump
    ax, ay = np.radians([20, 30])
    rx = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
    ry = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
    check(dump, from_blender(mapped(colours, dump.uv)) @ (ry @ rx).T, 1e-5)


@pytest.mark.parametrize("kind, peak, colour_space", [
    ("uint8", 255, None), ("uint16", 65535, None), ("uint8", 255, "sRGB"), ("uint16", 65535, "GammaCorrected2.2")])
def test_png_is_read_without_gamma(render, tmp_path, kind, peak, colour_space):
    stored = np.round(random_map() * peak)
    write_png(tmp_path / "map.png", stored, kind, colour_space)
    for gamma in ("assumed_gamma 1", "assumed_gamma 2.2"):
        text = (TOP + textured(quad(), 'png "map.png"')).replace("assumed_gamma 1", gamma)
        dump = render(text, (96, 72)).dump
        check(dump, from_blender(mapped(stored / peak, dump.uv)))


def test_png_with_alpha_and_grey(render, tmp_path):
    stored = np.round(random_map() * 255)
    write(tmp_path / "map.png", np.dstack([stored, np.full(stored.shape[:2], 100)]).astype("uint8"), "uint8", channels="RGBA")
    dump = render(TOP + textured(quad(), 'png "map.png"'), (96, 72)).dump
    check(dump, from_blender(mapped(stored / 255, dump.uv)))
    grey = np.full((3, 4, 1), 255)
    write(tmp_path / "map.png", grey.astype("uint8"), "uint8", channels="Y")
    dump = render(TOP + textured(quad(), 'png "map.png"'), (96, 72)).dump
    check(dump, np.broadcast_to(normalise(np.array([1.0, 1, 1])), dump.Ns.shape))


@pytest.mark.parametrize("kind, origin, channels", [
    ("float", (0, 0), "RGB"), ("half", (0, 0), "RGB"), ("float", (5, -3), "RGB"), ("float", (-2, 4), "ARGB")])
def test_exr_kinds(render, tmp_path, kind, origin, channels):
    values = random_map((6, 4))
    pixels = values if len(channels) == 3 else np.dstack([np.ones((6, 4)), values])
    pixels = pixels.astype(np.float16 if kind == "half" else np.float32)
    write(tmp_path / "map.exr", pixels, kind, origin=origin, channels=channels)
    dump = render(TOP + textured(quad()), (96, 72)).dump
    check(dump, from_blender(mapped(pixels[..., -3:].astype(float), dump.uv)))


def test_exr_without_colours_is_an_error(render, tmp_path):
    write(tmp_path / "map.exr", np.ones((2, 2, 1), np.float32), "float", channels="Y")
    result = render(TOP + textured(quad()), fails=True)
    assert result.status == 1 and "no full-size channel R" in result.message


@pytest.mark.parametrize("strength", [-1, 0, .25, 1, 2.5])
def test_strength(render, colours, strength):
    dump = render(TOP + textured(quad(), more=f"strength {strength}"), (96, 72)).dump
    check(dump, from_blender(mapped(colours, dump.uv, max(strength, 0))))


def test_black_and_not_a_number_are_flat(render, shade_check, tmp_path):
    pixels = np.full((2, 2, 3), .5, np.float32)
    pixels[0, 0] = np.nan
    pixels[1, 1] = np.inf
    write(tmp_path / "map.exr", pixels, "float")
    dump = render(TOP + textured(quad()), (96, 72)).dump
    assert np.isfinite(dump.S).all() and np.isfinite(dump.Ns).all()
    check(dump, np.broadcast_to([0.0, 1, 0], dump.Ns.shape))
    shade_check(dump)
    # what half the strength makes of normals straight down has no direction
    write(tmp_path / "map.exr", np.full((2, 2, 3), (.5, .5, 0), np.float32), "float")
    dump = render(TOP + textured(quad(), more="strength .5"), (96, 72)).dump
    assert np.isfinite(dump.S).all()
    check(dump, np.broadcast_to([0.0, 1, 0], dump.Ns.shape))


def test_slopes_of_normal_and_bump_image_add(render, shade_check, colours):
    def slopes(dump):
        with np.errstate(invalid="ignore"):  # misses
            return -dump.Ns[..., [0, 2]] / dump.Ns[..., 1:2]
    normal = "normal { bumps .3 scale .2 }"
    plain = quad(extra="texture { pigment { rgb .5 } " + normal + finish("") + " } }\n")
    only_normal = slopes(render(TOP + plain, (96, 72)).dump)
    only_image = slopes(render(TOP + textured(quad()), (96, 72)).dump)
    dump = render(TOP + textured(quad(), normal=normal), (96, 72)).dump
    assert np.abs(only_normal[dump.hit]).max() > .1
    np.testing.assert_allclose(slopes(dump)[dump.hit], (only_normal + only_image)[dump.hit], atol=2e-5)
    shade_check(dump)


def test_frame_of_the_map_does_not_follow_tangent(render, shade_check, colours):
    text = TOP + textured(quad(), tangent="tangent <1, 0, 2>")
    dump = render(text, (96, 72)).dump
    check(dump, from_blender(mapped(colours, dump.uv)))
    np.testing.assert_allclose(dump.T[dump.hit], np.tile(normalise(np.array([1.0, 0, 2])), (dump.hit.sum(), 1)), atol=1e-6)
    shade_check(dump)


SIDE = TOP.replace("orthographic location <.5, 3, .5> right 1.6*x up 1.2*z direction -y", "location <1, 2, -5> look_at 0 angle 30")


def primitive_frame(name, p, N):
    """dP/du and dP/dv of POV-Ray's UV mapping, by hand; NaN where it is not known."""
    zero = np.zeros_like(p[..., 0])
    ring = normalise(np.stack([p[..., 0], zero, p[..., 2]], -1))
    if name == "sphere":  # u grows from x towards z, v upwards
        du, dv = np.stack([-p[..., 2], zero, p[..., 0]], -1), np.stack([zero, zero + 1, zero], -1)
    elif name == "torus":  # u shrinks from x towards z, v grows up the outer side and down the inner one
        du = np.stack([p[..., 2], zero, -p[..., 0]], -1)
        dv = np.cross(np.cross(ring, [0, 1.0, 0]), N)
        dv *= np.sign(dv[..., 1:2] * np.where(dot(N, ring) > 0, 1, -1)[..., None])  # y rises on the outer side
    else:  # by the map drawn in boxes.cpp: on top u goes with x and v against z, on the right u against z and v with y
        top, right = N[..., 1] > .9, N[..., 0] > .9
        du = np.where(top[..., None], [1.0, 0, 0], np.where(right[..., None], [0, 0, -1.0], np.nan))
        dv = np.where(top[..., None], [0, 0, -1.0], np.where(right[..., None], [0, 1.0, 0], np.nan))
    return du, dv


def check_primitive(name, dump, colours):
    N = dump.N
    du, dv = primitive_frame(name, dump.P, N)
    T = normalise(du)
    B = normalise(dv - dot(dv, N)[..., None] * N - dot(dv, T)[..., None] * T)
    n = mapped(colours, dump.uv)
    expected = n[..., :1] * T + n[..., 1:2] * B + n[..., 2:] * N
    known = dump.hit & np.isfinite(expected).all(-1)
    known &= np.abs(N[..., 1]) < .999 if name == "sphere" else True
    # near poles and rims a pixel holds more than a texel: their mean, and a wider lobe
    sharp = np.abs(dump.channels["alpha.X"] - (2 / 202) ** .5) < 1e-6
    assert known.sum() > 100 and sharp[known].mean() > .98
    known &= sharp
    np.testing.assert_allclose(dump.Ns[known], expected[known], atol=2e-5)
    np.testing.assert_allclose(dump.T[known], T[known], atol=2e-5)
    return known


@pytest.mark.parametrize("name, geometry", [
    ("sphere", "sphere { 0, 1"), ("torus", "torus { .8, .3"), ("box", "box { -.7, .7")])
def test_primitives(render, shade_check, colours, name, geometry):
    dump = render(SIDE + textured(geometry), (96, 72)).dump
    check_primitive(name, dump, colours)
    shade_check(dump)


def test_bumps_of_all_sides_of_a_box_lean_as_a_pigment_runs(render, tmp_path):
    """What a map leans along red and green is where the colours of a pigment under uv_mapping rise: red u, green v."""
    lean = np.array([.6, .3, .55 ** .5])
    write(tmp_path / "map.exr", np.full((2, 2, 3), (lean + 1) / 2, np.float32), "float")
    ramps = ("uv_mapping average pigment_map { [1 gradient x color_map { [0 rgb 0] [1 red 2] }]"
             " [1 gradient y color_map { [0 rgb 0] [1 green 2] }] }")
    corner = "box { <-.7, -.5, -.6>, <.6, .7, .5> "
    turned = "matrix <0, -1, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0>"  # which brings the hidden sides to the front
    boxes = [corner + "translate -x", corner + turned + " translate x"]
    camera = "camera { orthographic location <3, 3, -3> right 4*x up 3*y look_at 0 }\n"
    text = "".join(textured(box) for box in boxes).replace("rgb .5", ramps).replace("ambient 0", "ambient 1")  # the only light
    result = render("#version 3.7; global_settings { assumed_gamma 1 }\n" + camera + text, (48, 36))
    dump, colour = result.dump, result.image[..., :2]
    for side in (-1, 1):
        for axis, N in enumerate(np.array([[1, 0, 0], [0, 1, 0], [0, 0, -1]])):
            here = dump.hit & (dump.P[..., 0] * side > 0) & (dot(dump.N, N) > .99)
            P = dump.P[here] - dump.P[here].mean(0)
            assert len(P) > 50
            rise = np.linalg.lstsq(P, colour[here] - colour[here].mean(0), rcond=1e-6)[0]
            T, B = normalise(rise.T)
            np.testing.assert_allclose(dump.Ns[here], np.tile(lean @ [T, B, N], (len(P), 1)), atol=5e-3, err_msg=f"{side} {axis}")


@pytest.mark.parametrize("name, geometry", [("sphere", "sphere { 0, 1"), ("torus", "torus { .8, .3")])
@pytest.mark.parametrize("side", ["x", "-x"])
def test_seams(render, colours, name, geometry, side):
    """Where u or v jumps from 1 to 0 the directions go on: the middle column of the picture lies in the plane z = 0,
    where u starts, the middle row in y = 0, where the torus's v does."""
    camera = f"camera {{ orthographic location 5*{side} right 2.4*z up 2.4*y direction -({side}) }}\n"
    text = SIDE.split("camera")[0] + camera + "light_source { <3, 5, -1>, rgb 1 }\n" + textured(geometry)
    dump = render(text, (65, 65)).dump
    known = check_primitive(name, dump, colours)
    assert (np.abs(dump.P[:, 32, 2][known[:, 32]]) < 1e-9).all() and known[:, 32].sum() > 10
    assert (np.abs(dump.P[32, :, 1][known[32]]) < 1e-9).all() and known[32].sum() > 40


def test_inside_of_a_difference_is_an_outside(render, shade_check, colours):
    # a bowl: the eye sees the sphere's inside, which is the outside of the difference
    bowl = "difference { box { <-1, -1, -1>, <1, 0, 1> } sphere { 0, .9 } texture { pigment { rgb .5 } "
    text = SIDE.replace("<1, 2, -5>", "<0, 5, -.1>") + bowl + finish('bump_image { exr "map.exr" }') + " } }\n"
    dump = render(text, (96, 72)).dump
    inside = dump.hit & (np.linalg.norm(dump.P, axis=-1) < .9001) & (dump.P[..., 1] < -1e-4)
    assert inside.sum() > 300
    N = dump.N
    np.testing.assert_allclose(N[inside], -dump.P[inside] / .9, atol=1e-5)
    T = normalise(np.stack([-dump.P[..., 2], 0 * N[..., 0], dump.P[..., 0]], -1))
    up = np.array([0, 1.0, 0])
    B = normalise(up - dot(up, N)[..., None] * N)
    n = mapped(colours, dump.uv)
    expected = n[..., :1] * T + n[..., 1:2] * B + n[..., 2:] * N
    clear = inside & (np.abs(N[..., 1]) < .99)
    np.testing.assert_allclose(dump.Ns[clear], expected[clear], atol=2e-5)
    shade_check(dump)


def test_curved_mesh_with_a_map(render, shade_check, colours):
    dump = render(SIDE + textured(saddle()), (96, 72)).dump
    assert dump.hit.sum() > 500
    shade_check(dump)


@pytest.fixture
def fine(tmp_path):
    """Fine bumps, 64 texels that repeat."""
    n = np.random.default_rng(5).normal(size=(64, 64, 2)) * [.12, .06]
    n = normalise(np.concatenate([n, np.ones((64, 64, 1))], -1))
    write_png(tmp_path / "fine.png", np.round((n + 1) / 2 * 65535), "uint16")
    return tmp_path / "fine.png"


PLATE = """#version 3.7; global_settings { assumed_gamma 1 max_trace_level 3 }
camera { location <0, 0, -4> right x up y angle 2 look_at 0 }
light_source { <2, 1.5, -5>, rgb 1 parallel point_at 0 }
"""


def plate(words, image='png "fine.png"', tiles=20):
    return (f"mesh2 {{ vertex_vectors {{ 4, <-.07, -.07, 0>, <.07, -.07, 0>, <.07, .07, 0>, <-.07, .07, 0> }}\n"
            f"uv_vectors {{ 4, <0, 0>, <{tiles}, 0>, <{tiles}, {tiles}>, <0, {tiles}> }} face_indices {{ 2, <0, 1, 2>, <0, 2, 3> }}\n"
            f"texture {{ pigment {{ rgb .5 }} finish {{ ambient 0 diffuse 0 mdf {{ {words} bump_image {{ {image} }} }} }} }} }}\n")


LOBES = ["beckmann .18, .36", "ashikhmin_shirley 60, 12 tangent <1, 1, 0>", "ward .18, .36 fresnel schlick specular pigment"]


@pytest.mark.parametrize("lobe", LOBES)
def test_bumps_below_a_pixel_are_roughness(render, shade_check, fine, lobe):
    """The mean of a plate is the same whether its bumps are seen or not, and what is shaded is said in the dump."""
    text = PLATE + plate(lobe)
    middle = render(text, (1280, 1280), ["+SC0.25", "+EC0.75"], dump=False).image  # ten tiles of twenty
    near = middle[:, 330:950].mean((0, 1))
    for size in (160, 48, 8, 2):
        result = render(text, size=(size, size))
        assert result.image.mean((0, 1)) == pytest.approx(near, rel=.03), size
    shade_check(result.dump)
    alpha = result.dump.channels["alpha.X"], result.dump.channels["alpha.Y"]
    own = {"beckmann": (.18, .36), "ashikhmin_shirley": ((2 / 62) ** .5, (2 / 14) ** .5), "ward": (.18, .36)}[lobe.split()[0]]
    # what is added is twice the slopes' variance, .0144 + .0036 in all, less what the texels' interpolation takes
    added = alpha[0] ** 2 + alpha[1] ** 2 - own[0] ** 2 - own[1] ** 2
    assert (added > .25 * 2 * .018).all() and (added < 1.1 * 2 * .018).all()


@pytest.mark.parametrize("texels", [1.2, 1.5, 1.8, 2.5])
def test_bumps_of_a_texel_to_a_pixel_become_roughness_bit_by_bit(render, fine, texels):
    """From one to two texels their share grows in a straight line, from what the map itself says of such a pixel."""
    across = 64 * 8 * np.tan(np.radians(1)) / .14  # of the picture, in texels
    size = round(across / texels)
    dump = render(PLATE + plate("beckmann .18, .36", tiles=1), size=(size, size)).dump
    added = (dump.channels["alpha.X"] ** 2 + dump.channels["alpha.Y"] ** 2)[dump.hit].mean() - .18 ** 2 - .36 ** 2
    side = across / size / 64
    xx, _xy, yy = shade.SlopeMap(oiio.ImageBuf(str(fine)).get_pixels(oiio.FLOAT)).look_up(
        np.random.default_rng(4).random((4000, 2)), [side, 0, 0, side]).covariance.mean(0)
    assert added == pytest.approx(min(64 * side - 1, 1) * 2 * (xx + yy), rel=.08)


@pytest.mark.parametrize("lobe", LOBES[:2])
def test_bumps_below_a_pixel_are_roughness_in_a_mirror(render, fine, lobe):
    """The same plate at the same distance, in a mirror: 1 to it, 3 back."""
    direct = render(PLATE + plate(lobe), size=(12, 12), dump=False).image
    text = (PLATE.replace("location <0, 0, -4>", "location <0, 0, -2>").replace("look_at 0", "look_at <0, 0, -3>")
            + "plane { z, -3 pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection 1 } no_shadow }\n"
            + plate(lobe))
    mirrored = render(text, size=(12, 12), dump=False).image[:, ::-1]
    assert mirrored.mean((0, 1)) == pytest.approx(direct.mean((0, 1)), rel=.01)
    assert mirrored == pytest.approx(direct, rel=.1)


# three waves on a quad, two to three pixels of 32 long
WAVES = """#version 3.7; global_settings { assumed_gamma 1 max_trace_level 3 }
light_source { <30, 50, -100>, rgb 1 parallel point_at 0 }
#declare Waves = mesh2 { vertex_vectors { 4, <-.5, -.5, 0>, <.5, -.5, 0>, <.5, .5, 0>, <-.5, .5, 0> }
  uv_vectors { 4, <0, 0>, <1, 0>, <1, 1>, <0, 1> } face_indices { 2, <0, 1, 2>, <0, 2, 3> }
  texture { pigment { rgb 0 } finish { ambient 0 diffuse 0 mdf { beckmann .2, .2 tangent uv bump_image { png "waves.png" WORDS } } } } }
"""


def waves(path, words):
    """The scene, and its map."""
    a = np.arange(64) * 2 * np.pi / 64
    x, y = np.meshgrid(a, a)
    n = [.3 * np.cos(9 * x + 3 * y + 1) + .2 * np.cos(4 * x - 8 * y), .3 * np.cos(7 * y - 2 * x) + .2 * np.cos(10 * x + 5 * y + 2), 1 + 0 * x]
    write_png(path / "waves.png", np.round((normalise(np.stack(n, -1)) + 1) / 2 * 65535), "uint16")
    return WAVES.replace("WORDS", words)


FRONT = "camera { orthographic location <0, 0, -2> right x up y direction z }\nobject { Waves }\n"


@pytest.mark.parametrize("camera", ["orthographic location <0, 0, -2> right x up y", "location <0, 0, -2> right .5*x up .5*y"])
@pytest.mark.parametrize("n", [2, 3])
def test_samples_of_a_pixel_are_pixels_of_a_larger_picture(render, tmp_path, camera, n):
    """+AM1 adds n x n samples to a pixel's own and divides by all: they stand where the pixels of a picture n times as large
    do, and are as wide. (As wide as pixels each, they blurred the picture.)"""
    text = waves(tmp_path, "") + f"camera {{ {camera} direction z }}\nobject {{ Waves }}\n"
    one, fine, found = (render(text, size=(size, size), dump=False, options=more).image
                        for size, more in ((12, []), (12 * n, []), (12, ["+A0.0", "-J", "+AM1", f"+R{n}"])))
    expected = (one + fine.reshape(12, n, 12, n, 3).sum((1, 3))) / (1 + n * n)
    assert found[1:-1, 1:-1] == pytest.approx(expected[1:-1, 1:-1], rel=2e-3, abs=1e-4)
    assert np.abs(fine.reshape(12, n, 12, n, 3) - one[:, None, :, None]).mean() > .05 * one.mean()


def test_samples_of_a_divided_pixel_share_its_width(render, tmp_path):
    """Against the mean of points: more samples are nearer to it, in blocks of any size."""
    points = render(waves(tmp_path, "filter off") + FRONT, size=(512, 512), dump=False).image
    truth = points.reshape(32, 16, 32, 16, 3).mean((1, 3))
    divided = ["+A0.0", "-J", "+AM2", "+R4", "+WT1"]
    one, many, blocks = (render(waves(tmp_path, "") + FRONT, size=(32, 32), dump=False, options=more).image
                         for more in ([], [*divided, "+BS32"], [*divided, "+BS8"]))
    assert np.array_equal(many, blocks)  # whatever was divided before
    error = [np.abs(image - truth)[1:-1, 1:-1].mean() for image in (one, many)]
    assert .02 * truth.mean() < error[0] and error[1] < .25 * error[0]


@pytest.mark.parametrize("size, count, limit", [(16, 37, 1.2), (8, 7, .75)])
def test_samples_of_a_focal_blur_share_a_pixel_s_width(render, tmp_path, size, count, limit):
    """Against many points, drawn over a pixel as POV-Ray draws them, they are no worse than as many points: each as wide as the
    pixel would blur it twice. Few, of three texels each, are much better than points."""
    def picture(words, count):
        front = (f"camera {{ location <0, 0, -20> right x up y direction 20*z aperture 1e-6 focal_point 0 blur_samples {count} "
                 "confidence .999 variance 1e-9 }\nobject { Waves }\n")
        return render(waves(tmp_path, words) + front, size=(size, size), dump=False).image[1:-1, 1:-1]

    truth = picture("filter off", 800)
    off = {words: np.abs(picture(words, count) - truth).mean() / truth.mean() for words in ("", "filter off")}
    assert off[""] < limit * off["filter off"]


BEHIND = """camera { orthographic location <0, 0, -3> right .6*x up .6*y direction z }
light_source { <60, 50, 100>, rgb 1 parallel point_at 0 }
object { Waves scale 5 rotate 180*y translate -4*z }
"""


BLOCK = "sphere { 0, 1 finish { mdf { ggx .001, .001 specular rgb 1 fresnel none reflection { samples 4 } } }"


@pytest.mark.parametrize("mirror, limit", [(BLOCK, .4), ("sphere { 0, 1 scale <1.4, 1.4, 2> translate z", .4),
                                           ("cylinder { -3*y, 3*y, 1", .8), ("blob { threshold .5 sphere { 0, 1.9, 1 }", .4),
                                           ("quadric { <1, 1, 1>, 0, 0, -1", .4), ("difference { box { -1, 1 } sphere { -2*z, 1.1 }", .6)])
def test_curved_mirrors_spread_rays(render, tmp_path, mirror, limit):
    """Seven times as wide in a ball: what a pixel holds is the mean of points, and one point is not."""
    def mean(words, size, blocks):
        image = render(waves(tmp_path, words) + BEHIND + mirror + f" pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 reflection {mirror != BLOCK:d} }} no_shadow }}\n",
                       size=(size, size), dump=False).image
        return image.reshape(24, blocks, 24, blocks, 3).mean((1, 3))

    truth = mean("filter off", 24 * 16, 16)
    error = [np.abs(mean(words, 24, 1) - truth)[1:-1, 1:-1].mean() for words in ("filter off", "")]
    assert error[0] > .1 * truth.mean() and error[1] < limit * error[0]


def test_a_block_that_begins_with_another_has_its_own_roughness(render, fine):
    """Of bumps half as strong a quarter, also where the one that it began with was shown before."""
    def added(words):
        dump = render(PLATE + "#declare F = finish { ambient 0 diffuse 0 mdf { beckmann .1, .1 bump_image { png \"fine.png\" } } }\n" + words
                      + plate("bump_image { png \"fine.png\" strength .5 }").replace("finish { ambient 0", "finish { F ambient 0").replace("bump_image { png \"fine.png\" } }", "}"), size=(8, 8)).dump
        return dump.channels["alpha.X"][dump.hit].mean() ** 2 - .01
    whole = render(PLATE + plate("beckmann .1, .1"), size=(8, 8)).dump.channels["alpha.X"].mean() ** 2 - .01
    assert added("") == pytest.approx(whole / 4, rel=.05)
    assert added("sphere { 99*y, 1 texture { finish { F } } }\n") == pytest.approx(whole / 4, rel=.05)


def test_scale_and_translate_move_the_map(render, fine):
    moved = render(PLATE + plate("beckmann .1, .2", 'png "fine.png" scale <.5, 2> translate <.25, .125>', 2), size=(64, 64)).dump
    text = plate("beckmann .1, .2", tiles=2).replace("<0, 0>, <2, 0>, <2, 2>, <0, 2>", "<-.5, -.0625>, <3.5, -.0625>, <3.5, .9375>, <-.5, .9375>")
    by_uv = render(PLATE + text, size=(64, 64)).dump
    assert moved.Ns == pytest.approx(by_uv.Ns, abs=1e-5)
    assert moved.S == pytest.approx(by_uv.S, rel=1e-3, abs=1e-6)
    before = 'png "fine.png" translate <.5, .0625> scale <.5, 2>'  # which scales what it moved by
    assert render(PLATE + plate("beckmann .1, .2", before, 2), size=(64, 64)).dump.Ns == pytest.approx(moved.Ns, abs=1e-6)


def test_without_a_filter_a_pixel_is_a_point(render, fine):
    dump = render(PLATE + plate("beckmann .18, .36", 'png "fine.png" filter off'), size=(32, 32)).dump
    assert "alpha.X" not in dump.channels
    assert np.abs(dump.Ns[..., 0]).max() > .1
