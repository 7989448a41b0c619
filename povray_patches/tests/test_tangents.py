# SPDX-License-Identifier: AGPL-3.0-or-later
"""Where the tangent of a block points: in its texture's space, or along the object's UV coordinates."""
import numpy as np
import pytest

from scenes import dot, finish, normalise, scene
from test_bump_image import TOP, mapped, quad, random_map, write

COST = 8.5

AXIS = np.array([.3, 1, -.2])


def rotation(x, y, z):
    """The matrix of POV-Ray's `rotate <x, y, z>`: columns are what the axes become."""
    ax, ay, az = np.radians([x, y, z])
    rx = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
    ry = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
    rz = np.array([[np.cos(az), -np.sin(az), 0], [np.sin(az), np.cos(az), 0], [0, 0, 1]])
    return rz @ ry @ rx


def texture(tangent, transforms="", more=""):
    return f"texture {{ pigment {{ rgb .5 }} {more} {finish(tangent, exponents='20, 5')} {transforms} }}"


def check(dump, direction, limit=2e-6, least=200, known=None):
    """T is the direction (one, or one a pixel) along the surface; its sign means nothing to the BRDF."""
    n = dump.N
    expected = np.broadcast_to(direction, n.shape) - dot(np.broadcast_to(direction, n.shape), n)[..., None] * n
    with np.errstate(invalid="ignore"):
        clear = dump.hit & (np.linalg.norm(expected, axis=-1) > .02 * np.linalg.norm(np.broadcast_to(direction, n.shape), axis=-1))
    clear &= True if known is None else known
    assert clear.sum() > least
    across = np.cross(normalise(expected[clear]), dump.T[clear])
    assert np.linalg.norm(across, axis=-1).max() < limit


R = "rotate <20, -35, 50>"
M = rotation(20, -35, 50)
AXIS_WORDS = "tangent <.3, 1, -.2>"
T = texture(AXIS_WORDS)
TURNED = texture(AXIS_WORDS, R)


@pytest.mark.parametrize("name, objects, matrix", [
    ("texture", f"sphere {{ 0, 1 {TURNED} }}", M),
    ("object", f"sphere {{ 0, 1 {T} {R} }}", M),
    ("object turned before", f"sphere {{ 0, 1 {R} {T} }}", np.eye(3)),
    ("both", f"sphere {{ 0, 1 {TURNED} {R} }}", M @ M),
    ("finish first", f"sphere {{ 0, 1 texture {{ {finish(AXIS_WORDS)} {R} pigment {{ rgb .5 }} }} }}", M),
    ("finish last", f"sphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} {R} {finish(AXIS_WORDS)} }} }}", np.eye(3)),
    ("declared", f"#declare T = {TURNED} sphere {{ 0, 1 texture {{ T {R} }} }}", M @ M),
    ("a new tangent", f"#declare T = {TURNED} sphere {{ 0, 1 texture {{ T finish {{ mdf {{ {AXIS_WORDS} }} }} }} }}", np.eye(3)),
    ("a new colour", f"#declare T = {TURNED} sphere {{ 0, 1 texture {{ T finish {{ mdf {{ specular .5 }} }} }} }}", M),
    ("texture_map", f"sphere {{ 0, 1 texture {{ gradient y texture_map {{ [0 {T[9:-1]}] [1 {T[9:-1]}] }} {R} }} }}", M),
    ("map of turned", f"sphere {{ 0, 1 texture {{ gradient y texture_map {{ [0 {TURNED[9:-1]}] [1 {TURNED[9:-1]}] }} {R} }} }}", M @ M),
    ("average in a map", f"sphere {{ 0, 1 texture {{ gradient y texture_map {{ [0 average texture_map {{ [1 {T[9:-1]}] }} {R}] [1 average texture_map {{ [1 {T[9:-1]}] }} {R}] }} turbulence .3 {R} }} }}", M @ M),
    ("checker", f"sphere {{ 0, 1 texture {{ checker {T} {T} scale .3 {R} }} }}", M),
    ("layers", f"sphere {{ 0, 1 {texture('tangent z')} {TURNED} }}", M),
    ("union", f"union {{ sphere {{ 0, .9 rotate 40*x }} sphere {{ <1, 0, 0>, .5 rotate 70*z }} {T} {R} }}", M),
    ("union of textures", f"union {{ sphere {{ 0, .9 {T} rotate 40*x }} {R} }}", M @ rotation(40, 0, 0)),
    ("uv_mapping", f"sphere {{ 0, 1 texture {{ uv_mapping {T[9:-1]} }} {R} }}", M),
    ("uv_mapped object", f"sphere {{ 0, 1 uv_mapping {T} {R} }}", M),
    ("blob", f"blob {{ threshold .5 sphere {{ 0, 1.4, 1 {T} {R} }} }}", M),
])
def test_axis_moves_with_the_texture(render, name, objects, matrix):
    check(render(scene(objects)).dump, matrix @ AXIS)


@pytest.mark.parametrize("axis, other", [("x", [0, 0, 1]), ("y", [0, 0, 1]), ("z", [0, 1, 0])])
def test_where_an_axis_stands_upright_another_goes_with_the_object(render, axis, other):
    """On a side of a box that faces along the axis strokes run along z, or y, of the texture's space, however the box is turned."""
    dump = render(scene(f"box {{ -.7, .7 {texture(f'tangent {axis}')} {R} }}")).dump
    facing = np.abs(dot(dump.N, M[:, "xyz".index(axis)])) > .99
    check(dump, M @ np.array(other, float), known=facing, least=50)


def test_stretched_and_sheared(render):
    objects = f"sphere {{ 0, 1 {texture(AXIS_WORDS, 'scale <2, .5, 1> matrix <1, 0, 0, .4, 1, 0, 0, .2, 1, 3, 2, 1>')} scale <1, 1.2, .8> }}"
    shear = np.array([[1, 0, 0], [.4, 1, 0], [0, .2, 1]]).T
    check(render(scene(objects)).dump, np.diag([1, 1.2, .8]) @ shear @ np.diag([2, .5, 1]) @ AXIS)


@pytest.mark.parametrize("where", ["texture", "object", "map", "uv"])
def test_radial_runs_around_its_axis(render, shade_check, where):
    words = "tangent radial <0, 0, 1> at <.2, -.1, 5>"
    moves = "rotate <20, -35, 50> translate <.3, .1, 0>"
    inner = texture(words)
    objects = {"texture": f"sphere {{ 0, 1 {texture(words, moves)} }}", "object": f"sphere {{ <-.3, -.1, 0>, 1 {inner} {moves} }}",
               "map": f"sphere {{ 0, 1 texture {{ average texture_map {{ [1 {inner[9:-1]}] }} {moves} }} }}",
               "uv": f"sphere {{ 0, 1 uv_mapping {inner} {moves} }}"}[where]
    dump = render(scene(objects)).dump
    axis, point = M @ [0, 0, 1], M @ [.2, -.1, 0] + [.3, .1, 0]
    check(dump, np.cross(axis, dump.P - point), 1e-5)
    shade_check(dump)


def test_radial_without_a_point_goes_through_the_origin(render):
    dump = render(scene(f"plane {{ y, -.5 {texture('tangent radial y detail none tangent radial 3*y')} }}")).dump
    check(dump, np.cross([0, 1, 0], dump.P))


def sphere_directions(p):
    """dP/du and dP/dv of the unit sphere: u from x towards z, v from the bottom to the top."""
    ring = np.stack([-p[..., 2], 0 * p[..., 0], p[..., 0]], -1)
    up = np.cross(p, normalise(ring))
    return 2 * np.pi * ring, np.pi * np.where(up[..., 1:2] < 0, -up, up)


@pytest.mark.parametrize("turned_by, scale", [(30, ""), (90, ""), (30, "scale <3, 1, 1>")])
def test_texture_turns_uv_tangents_in_the_uv_plane(render, turned_by, scale):
    own = texture("tangent uv", f"{scale} rotate {turned_by}*z")
    a = np.radians(turned_by)
    for objects, matrix in ((f"sphere {{ 0, 1 {own} }}", np.eye(3)), (f"sphere {{ 0, 1 {own} {R} }}", M),
                            (f"union {{ sphere {{ 0, 1 {own} rotate 20*x }} {R} }}", M @ rotation(20, 0, 0))):
        dump = render(scene(objects)).dump
        p = np.where(dump.hit[..., None], dump.P, 1) @ matrix  # back in the sphere's space
        du, dv = sphere_directions(p)
        check(dump, (np.cos(a) * du + np.sin(a) * dv) @ matrix.T, 2e-5, known=np.abs(p[..., 1]) < .95)
    anew = render(scene(f"#declare T = {own} sphere {{ 0, 1 texture {{ T finish {{ mdf {{ tangent uv }} }} }} }}")).dump  # which counts from there
    check(anew, sphere_directions(np.where(anew.hit[..., None], anew.P, 1))[0], 2e-5, known=np.abs(anew.P[..., 1]) < .95)


def test_each_part_of_a_union_has_its_own_uv_grain(render):
    dump = render(scene(f"union {{ sphere {{ -.8*x, .7 rotate 40*z }} sphere {{ <.8, 0, 0>, .7 }} {texture('tangent uv')} }}")).dump
    turn = rotation(0, 0, 40)
    left = normalise(dump.P - turn @ [-.8, 0, 0]) @ turn
    check(dump, sphere_directions(left)[0] @ turn.T, 2e-5, 100, (dump.P[..., 0] < -.05) & (np.abs(left[..., 1]) < .95))
    right = dump.P - [.8, 0, 0]
    check(dump, sphere_directions(right)[0], 2e-5, 100, (dump.P[..., 0] > .15) & (np.abs(right[..., 1]) < .66))


def test_uv_plane_of_a_stretched_mesh(render):
    # uv = (3z, -2x): a texture turned by 90 degrees runs along v, by 45 along (-1/2, 1/3) of (x, z)
    square = quad("<0,0>, <0,-2>, <3,-2>, <3,0>")
    for turned_by, direction in ((0, [0, 0, 1]), (90, [1, 0, 0]), (45, [-1 / 2, 0, 1 / 3])):
        dump = render(TOP + square + texture("tangent uv", f"rotate {turned_by}*z") + " }", (96, 72)).dump
        check(dump, np.array(direction, float))


def test_a_sharp_edge_parts_the_strokes_of_its_sides(render):
    """A sheet folded along y, on whose right the strokes turn: neither side has something of the other's."""
    sheet = ("mesh2 { vertex_vectors { 6, <-1, -1, .5>, <0, -1, 0>, <1, -1, .5>, <-1, 1, .5>, <0, 1, 0>, <1, 1, .5> }\n"
             "uv_vectors { 6, <-1, -1>, <0, -1>, <1, 0>, <-1, 1>, <0, 1>, <1, 2> } face_indices { 4, <0, 1, 4>, <0, 4, 3>, <1, 2, 5>, <1, 5, 4> }\n")
    dump = render(scene(sheet + texture("tangent uv") + " }")).dump
    check(dump, np.where(dump.P[..., :1] < 0, [1, 0, -.5], [1, -1, .5]), 1e-5)


def test_a_texture_that_stands_on_the_uv_plane(render):
    dump = render(scene(f"sphere {{ 0, 1 {texture('tangent uv', 'rotate 90*y')} }}")).dump
    check(dump, sphere_directions(dump.P)[0], 2e-5, known=np.abs(dump.P[..., 1]) < .95)


@pytest.mark.parametrize("geometry", ["sphere { <.2, -.1, .3>, .8", "sphere { <.2, 0, 0>, .5 scale <1, 2, .7> rotate <30, 40, 50> translate .1*x",
                                      "torus { .8, .3 rotate -40*x", "ovus { .8, .5 scale <1, .8, 1.2> rotate 70*z",
                                      "sor { 5, <0, -.5>, <.6, 0>, <.9, .5>, <.5, 1>, <.4, 1.4> translate -.6*y rotate 20*x"])
def test_axes_of_round_shapes_agree_with_their_uv_function(render, geometry):
    """Without a map dP/du is worked out from the axis; where dP/dv is wanted too, from the gradients of u and v, or differences of UVCoord()."""
    plain = render(scene(f"{geometry} {texture('tangent uv')} }}")).dump
    differences = render(scene(f"{geometry} {texture('tangent uv', 'matrix <1, 1e-12, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0>')} }}")).dump
    clear = plain.hit & (np.abs(dot(plain.N, differences.T)) < 1)
    turned = np.linalg.norm(plain.T - differences.T, axis=-1)[clear]
    assert clear.sum() > 200 and np.median(turned) < 1e-6 and (turned > 1e-4).mean() < .01  # at the poles both are anything


@pytest.mark.parametrize("eye", ["<3, 2.5, -4>", "<-3, -2.5, 4>"])
def test_box_runs_along_u_and_v_of_every_side(render, eye):
    """dP/du and dP/dv of a side are what its points and their UV coordinates in the dump say."""
    seen = 0
    for turned_by, k in ((0, 0), (90, 1)):
        text = scene(f"box {{ <-.7, -.4, -.6>, <.5, .6, .8> {texture('tangent uv', f'rotate {turned_by}*z')} scale <1, 1.4, -.8> rotate <20, 30, -10> }}")
        dump = render(text[:text.index("camera")] + f"camera {{ location {eye} look_at 0 angle 40 }}\n" + text[text.index("light_source"):]).dump
        for n in np.unique(np.round(dump.N[dump.hit], 4), axis=0):
            side = dump.hit & (dot(dump.N, n) > .999)
            uv = dump.uv[side]
            step = np.linalg.lstsq(np.c_[uv, np.ones(len(uv))], dump.P[side], rcond=None)[0]
            check(dump, step[k], 1e-4, 50, side)
            seen += 1
    assert seen == 6


# ---- lathe, patch and parametric ----

@pytest.fixture
def colours(tmp_path):
    values = random_map().astype(np.float32)
    write(tmp_path / "map.exr", values, "float")
    return values.astype(float)


def check_uv(render, colours, shade_check, geometry, directions, limit):
    """Tangents and normal map against dP/du and dP/dv worked out by hand from the dump's points."""
    for words, pick in (("tangent uv", 0), ("tangent uv", 1)):
        dump = render(scene(geometry + texture(words, "rotate 90*z" if pick else "") + " }")).dump
        check(dump, directions(dump)[pick], limit)
    dump = render(scene(geometry + texture('bump_image { exr "map.exr" }') + " }")).dump
    du, dv = directions(dump)
    N = dump.N
    T = normalise(du - dot(du, N)[..., None] * N)
    B = normalise(dv - dot(dv, N)[..., None] * N - dot(dv, T)[..., None] * T)
    n = mapped(colours, dump.uv)
    expected = n[..., :1] * T + n[..., 1:2] * B + n[..., 2:] * N
    front = dump.hit & (dot(N, dump.P) > 0)  # the outside of what goes round the y axis
    assert front.sum() > 200
    np.testing.assert_allclose(dump.Ns[front], expected[front], atol=10 * limit)
    shade_check(dump)


def test_lathe(render, colours, shade_check):
    # a cone by a straight spline: v runs up it, u from x towards z
    def directions(dump):
        ring = normalise(np.stack([dump.P[..., 0], 0 * dump.P[..., 0], dump.P[..., 2]], -1))
        return np.stack([-dump.P[..., 2], 0 * dump.P[..., 0], dump.P[..., 0]], -1) * 2 * np.pi, ring * -.6 + [0, 2, 0]
    check_uv(render, colours, shade_check, "lathe { linear_spline 2, <1, -1>, <.4, 1>\n", directions, 5e-6)


def test_bent_lathe_follows_its_spline(render):
    # quadratic_spline through three points; v's direction is that of the profile, orthogonal to u and to N
    dump = render(scene("lathe { cubic_spline 5, <0, -.9>, <.6, -.5>, <.9, 0>, <.5, .6>, <.4, 1.2> " + texture("tangent uv", "rotate 90*z") + " }")).dump
    ring = np.stack([-dump.P[..., 2], 0 * dump.P[..., 0], dump.P[..., 0]], -1)
    check(dump, np.cross(dump.N, ring), 1e-5)


def test_a_turned_texture_on_a_bent_lathe(render):
    """Half-way between dP/du and dP/dv, by their lengths: r and y are cubics of v in each of the spline's parts, which the
    dump's points tell."""
    geometry = "lathe { cubic_spline 6, <0, -1.2>, <.6, -.9>, <.9, -.2>, <.5, .5>, <.4, 1>, <.1, 1.2> "
    dump = render(scene(geometry + texture("tangent uv", "rotate 45*z") + " }")).dump
    ring = normalise(np.stack([dump.P[..., 0], 0 * dump.P[..., 0], dump.P[..., 2]], -1))
    v, profile = dump.uv[..., 1], np.stack([dot(dump.P, ring), dump.P[..., 1]])
    slope, parts = np.zeros_like(profile), np.floor(3 * v)
    for part in range(3):
        here = dump.hit & (parts == part)
        assert here.sum() > 50
        for what in (0, 1):
            fit = np.polynomial.Polynomial.fit(v[here], profile[what][here], 3)
            assert abs(fit(v[here]) - profile[what][here]).max() < 1e-5
            slope[what][here] = fit.deriv()(v[here])
    du = 2 * np.pi * np.stack([-dump.P[..., 2], 0 * dump.P[..., 0], dump.P[..., 0]], -1)
    check(dump, du + slope[0][..., None] * ring + slope[1][..., None] * [0, 1, 0], 1e-3)


PATCH = """bicubic_patch { type 1 flatness 0 u_steps 3 v_steps 3 UV
""" + ", ".join("<" + ", ".join(f"{c:.9g}" for c in (2 * i / 3 - 1, .1 * j, 2 * j / 3 - 1 + .2 * i)) + ">" for j in range(4) for i in range(4)) + "\n"


@pytest.mark.parametrize("corners", [[(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 0), (0, 2), (-1, 2), (-1, 0)],
                                     [(0, 0), (1, .2), (1.3, 1.4), (-.2, .9)]])
def test_bicubic_patch(render, shade_check, corners):
    """A patch that is a parallelogram, P = corner + p e + q f, so that p and q follow from P; uv is bilinear in them."""
    words = "uv_vectors " + " ".join(f"<{u}, {v}>" for u, v in corners)
    corner, e, f = np.array([-1, 0, -1]), np.array([2, 0, .6]), np.array([0, .3, 2])
    a, b, c, d = (np.array(st, float) for st in corners)
    for turned_by in (0, 90):
        dump = render(scene(PATCH.replace("UV", words) + " " + texture("tangent uv", f"rotate {turned_by}*z") + " }")).dump
        p, q, _ = np.moveaxis((dump.P - corner) @ np.linalg.inv(np.array([e, f, np.cross(e, f)])), -1, 0)[..., None]
        uv = (1 - q) * ((1 - p) * a + p * b) + q * ((1 - p) * d + p * c)
        np.testing.assert_allclose(dump.uv[dump.hit], uv[dump.hit], atol=1e-5)
        dp, dq = (1 - q) * (b - a) + q * (c - d), (1 - p) * (d - a) + p * (c - b)
        det = dp[..., :1] * dq[..., 1:] - dp[..., 1:] * dq[..., :1]
        du, dv = (dq[..., 1:] * e - dp[..., 1:] * f) / det, (dp[..., :1] * f - dq[..., :1] * e) / det
        check(dump, dv if turned_by else du, 1e-5)
    shade_check(dump)


def test_parametric(render, shade_check):
    # x = u, z = v + u/2, y = .3 u v
    geometry = """parametric { function { u } function { .3 * u * v } function { v + u / 2 } <-1, -1>, <1, 1>
  contained_by { box { -2, 2 } } max_gradient 4 accuracy .0001 precompute 12 x, y, z
"""
    def directions(dump):
        u = dump.P[..., 0]
        v = dump.P[..., 2] - u / 2
        one, zero = np.ones_like(u), np.zeros_like(u)
        return np.stack([one, .3 * v, one / 2], -1), np.stack([zero, .3 * u, one], -1)
    for turned_by in (0, 90):
        dump = render(scene(geometry + " " + texture("tangent uv", f"rotate {turned_by}*z") + " scale <1, 1, 1> }"), (32, 24)).dump
        check(dump, directions(dump)[1 if turned_by else 0], 1e-3, 50)
    shade_check(dump)


# ---- objects without UV coordinates ----

@pytest.mark.parametrize("geometry, direction, said", [
    ("cone { <-.4, -1, 0>, .9, <.2, 1, .1>, .2", lambda d: np.cross([.6, 2, .1], d.P - [-.4, -1, 0]), "on a cone or cylinder, which has no UV coordinates: strokes run around its axis."),
    ("cylinder { -y, y, .6 rotate 30*z", lambda d: np.cross(rotation(0, 0, 30) @ [0, 1, 0], d.P), "strokes run around its axis."),
    ("plane { y, -.5", lambda d: np.array([1., 0, 0]), "on a plane or disc, which has no UV coordinates: strokes run along its x axis, or z where it faces x."),
    ("plane { -x, -.5 rotate 20*y", lambda d: rotation(0, 20, 0) @ [0, 0, 1], "or z where it faces x."),
    ("disc { 0, y - z, 1", lambda d: np.array([1., 0, 0]), "on a plane or disc"),
    ("blob { threshold .5 sphere { 0, 1.4, 1 } rotate 20*z", lambda d: rotation(0, 0, 20) @ [1, 0, 0], "on an object without UV coordinates: strokes run along its x axis."),
])
def test_fallback_and_what_is_said(render, shade_check, geometry, direction, said):
    result = render(scene(geometry + " " + texture("tangent uv") + " }"))
    assert said in result.message
    check(result.dump, direction(result.dump), 5e-6, 100)
    shade_check(result.dump, everything=False)
    quiet = render(scene(geometry + " " + texture("") + " }"))
    assert "Warning:" not in quiet.log
    np.testing.assert_array_equal(quiet.dump.T, result.dump.T)
