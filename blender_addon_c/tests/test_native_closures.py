# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures and lists of them in the whole engine: a ball in an even white world. What loses nothing
is as bright as the world, what lets light through as well; nothing is brighter."""

import math
import sys

import numpy as np
import pytest

from native_scenes import (ROOT, dump, image, material, mesh, native, ortho, point, registers, render, scene, sky, some, sphere, square,
                           sun)

sys.path.insert(0, str(ROOT / "libshade/python"))
import shade  # noqa: E402

COST = 2.7

WHITE = (1.0, 1.0, 1.0)


def diffuse(model="LAMBERT", roughness=0.0, color=WHITE):
    return {"closure": "DIFFUSE", "model": model, "color": color, "roughness": [roughness]}


def glass(alpha, ior=1.5, **changes):
    return {"closure": "GLASS", "ior": [ior], "alpha": [alpha], "tint": WHITE, "reflects": True,
            "refracts": True, "joint": True} | changes


def glossy(alpha, across=None):
    made = material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=WHITE, ax=alpha, ay=across or alpha)
    return {key: value for key, value in made.items() if key not in ("name", "nodes")}


def toon(size, smooth, mirrors=False):
    return {"closure": "TOON", "mirrors": mirrors, "size": [size], "smooth": [smooth]}


def weighed(closure, *weight):
    return closure | {"weight": weight * (3 // len(weight))}


def of(*closures, nodes=()):
    return {"name": "listed", "nodes": list(nodes), "closures": list(closures)}


TRANSLUCENT, TRANSPARENT = {"closure": "TRANSLUCENT"}, {"closure": "TRANSPARENT"}
EMISSION = {"closure": "EMISSION"}
SIDE = 24


def furnace(given, shape=None, **changes):
    """Mean RGB of the ball, and its error by chance."""
    plain = {"width": SIDE, "height": SIDE, "samples": 64, "background": WHITE, "lights": [],
             "transparent": False, "max_bounces": 64, "transparent_max_bounces": 64,
             "materials": [given], "meshes": [shape or sphere(smooth=False)], "camera": ortho(1.0)}
    picture, _ = render(scene(**plain | changes))
    y, x = (np.mgrid[:SIDE, :SIDE] + 0.5) / (SIDE / 2) - 1
    ball = picture[np.hypot(x, y) < 0.9][:, :3].astype(float)
    return ball.mean(0), ball.std(0).max() / np.sqrt(len(ball))


KEEP_ALL = {
    "lambert": of(diffuse()), "eon": of(diffuse("EON", 0.7)), "translucent": of(TRANSLUCENT),
    "transparent": of(TRANSPARENT), "glass": of(glass(1e-4)), "refraction": of(
        glass(1e-4, reflects=False)), "mirror": of(glossy(1e-3)),
    "rough": of(glossy(0.2, 0.9) | {"multiscatter": "ON"}),
    "pane": of(glass(1e-4, refracts=False, straight=True)),
    "fibres": of({"closure": "SHEEN", "model": "FIBRES", "a": [0.4], "b": [-0.1]}),
    "toon": of(toon(0.5, 0.0)), "half there": of(weighed(diffuse(), 0.5), weighed(TRANSPARENT, 0.5)),
    "three": of(weighed(diffuse(), 0.2), weighed(TRANSLUCENT, 0.5), weighed(glass(1e-4), 0.3)),
}


@pytest.mark.parametrize("name", KEEP_ALL)
def test_what_keeps_all_light_is_not_seen(name):
    mean, _ = furnace(KEEP_ALL[name])
    assert mean == pytest.approx(WHITE, abs=0.01)


@pytest.mark.parametrize("alpha, clear, seen", [(1e-4, None, False), (1e-4, 0.0, False), (1e-4, 0.01, True), (0.2, 0.1, False),
                                               (0.05, 0.1, True)])
def test_a_transparent_film_is_seen_through_clear_glass(alpha, clear, seen):
    """Through both faces of a slab, and what that leaves is the white world's mirror image, be it a color or a picture."""
    left = {} if clear is None else {"clear_glass": clear}
    drawn = {"images": [image(np.ones((2, 4, 3), np.float32))], "sky": sky(np.ones(3) * WHITE)}
    for world in ({"background": WHITE}, drawn)[:1 + seen]:
        picture, _ = render(scene(width=8, height=8, samples=512, transparent=True, lights=[], max_bounces=16, materials=[of(glass(alpha))],
                                  meshes=[square(40.0), square(40.0, -0.5)], camera=ortho(0.1), **world, **left))
        mean = picture.mean((0, 1))
        assert mean[3] == pytest.approx(1 - 0.96**2 if seen else 1.0, abs=0.004)
        assert mean[:3] == pytest.approx(mean[3], abs=0.02)


@pytest.mark.parametrize("clear", [None, 0.01])
def test_a_ray_says_whether_the_film_is_seen_through_what_is_before(clear):
    """Which is what shines behind a pane; what is beside it is seen by rays from the camera."""
    shines = of(EMISSION | {"weight": registers(3, 1) * 3}, nodes=[{"type": "PATH", "what": "FILM", "out": registers(3, 1)}])
    half = mesh([[0, -2, 0], [2, -2, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2], [0, 2, 3]])
    picture, _ = render(scene(width=4, height=4, samples=64, transparent=True, lights=[], max_bounces=2, camera=ortho(0.5),
                              materials=[of(glass(1e-4)), shines], meshes=[half, square(200.0, -0.5, 1)],
                              **({} if clear is None else {"clear_glass": clear})))
    assert picture[:, :2, :3].min() == 1
    assert picture[:, 2:, :3].mean() == pytest.approx(0 if clear is None else 0.96, abs=0.02)


@pytest.mark.parametrize("alpha, ior, joint", [(0.1, 1.5, True), (0.25, 1.5, False), (0.5, 1.5, True),
                                              (1.0, 1.5, True), (1.0, 1.5, False), (0.3, 1.8, True), (0.7, 1.1, True)])
def test_glass_with_all_its_bounces_is_not_seen(alpha, ior, joint):
    """The share that GLASS_ALBEDO says is lost goes the way of the rest."""
    one, more = registers(3, 2), registers(5, 1)
    nodes = [{"type": "GLASS_ALBEDO", "ior": [ior], "alpha": [alpha], "joint": joint, "out": one},
             {"type": "MATH", "operation": "DIVIDE", "a": [1.0], "b": one[:1], "c": [0.0], "out": more}]
    mean, _ = furnace(of(glass(alpha, ior, joint=joint) | {"weight": more * 3}, nodes=nodes))
    assert mean == pytest.approx(WHITE, abs=0.01)


@pytest.mark.parametrize("straight", [False, True])
def test_a_rough_pane_with_what_it_loses_is_not_seen(straight):
    """What of a mirror of this roughness is lost, ALBEDO says; of what goes through it is as much."""
    one, more = registers(3, 3), registers(6, 1)
    nodes = [{"type": "ALBEDO", "alpha": [0.5], "out": one},
             {"type": "MATH", "operation": "DIVIDE", "a": [1.0], "b": one[:1], "c": [0.0], "out": more}]
    mean, _ = furnace(of(glass(0.5, refracts=False, straight=straight) | {"weight": more * 3}, nodes=nodes))
    assert mean == pytest.approx(WHITE, abs=0.01)


def test_what_is_behind_a_pane_is_seen_where_it_is():
    """A square that shines, through one that stands askew before it."""
    pane, lit = of(glass(1e-4, refracts=False, straight=True)), of(weighed(EMISSION, 0.2, 0.5, 0.9))
    askew = square(4.0, 0.0)
    askew["positions"] = (np.reshape(askew["positions"], (-1, 3)) @ [[0.8, 0, -0.6], [0, 1, 0], [0.6, 0, 0.8]] + [0, 0, 3]).astype(
        np.float32).ravel()
    pictures = [render(scene(width=16, height=16, samples=16, lights=[], background=(0.1,) * 3, transparent=False, max_bounces=8,
                             materials=[lit, pane], meshes=[square(0.45), *panes], camera=ortho(1.0)))[0]
                for panes in ([], [{**askew, "material": np.ones(2, np.int32)}])]
    bare, seen = (picture[..., 2] for picture in pictures)
    within = np.isclose(bare, bare.min()) | np.isclose(bare, bare.max())  # of the square or beside it
    assert np.abs(bare - seen)[within].mean() < 0.002 and np.ptp(seen[within]) > 0.7 and 150 < within.sum()


@pytest.mark.parametrize("mirror", ["mirror", "glass"])
@pytest.mark.parametrize("lamp", [[], [point((0, 0, 5), (1e-7,) * 3)]])
def test_what_gathers_light_is_not_seen_on_a_matt_plate(mirror, lamp):
    """With a lamp the plate aims at the balls, of which one is cut in two by it."""
    balls = [sphere(12, 0.4, (0.3, 0.3, 0.7), smooth=False), sphere(12, 0.3, (-0.4, -0.3, 0.05), smooth=False)]
    surface = of(glossy(0.01)) if mirror == "mirror" else KEEP_ALL[mirror]
    plate = square(4.0, material_index=1)
    mean, error = furnace(surface, lights=lamp, meshes=[*balls, plate], samples=256,
                          materials=[surface, of(diffuse())])
    assert mean == pytest.approx(WHITE, abs=0.004) and error < 0.002


LOSE = {
    "oren nayar": of(diffuse("OREN_NAYAR", 0.7)), "glass": of(glass(0.3)),
    "apart": of(glass(0.3, joint=False)), "glossy": of(glossy(0.4)),
    "velvet": of(weighed(diffuse(), 0.7), weighed({"closure": "SHEEN", "model": "VELVET", "sigma": [0.3]}, 0.2)),
    "coat": of(weighed(diffuse(), 0.8), weighed({"closure": "COAT", "alpha": [0.2]}, 0.25)),
    "rim": of(weighed(diffuse(), 0.7), weighed({"closure": "SHEEN", "model": "SCHLICK"}, 0.3)),
    "soft toon": of(toon(0.5, 0.3)), "toon in a mirror": of(toon(0.3, 0.1, True)),
    "mixed": of(weighed(glossy(0.4), 0.5), weighed(diffuse(), 0.25), weighed(glass(0.2), 0.25)),
}


@pytest.mark.parametrize("name", LOSE)
def test_nothing_makes_light(name):
    mean, error = furnace(LOSE[name])
    assert (mean < 1 + 3 * error).all() and (mean > 0.5).all()


@pytest.mark.parametrize("angle", [0, 35, 65])
@pytest.mark.parametrize("ax, ay, share", [(0.05, 0.05, 1.0), (0.3, 0.3, 1.0), (0.3, 0.1, 0.5), (0.2, 0.2, 0.0)])
def test_bumps_that_are_a_part_of_a_lobe_make_no_light(ax, ay, share, angle):
    """White facets of Ashikhmin and Shirley in an even world, by quadrature over their normals h: each that sends the
    eye light from above sends mi / max(mi, mo) of it, m that much of the way from the mean normal to h. Where all the
    lobe is bumps, facets hide nothing of one another: what they would take from below is lost, and of low light what is
    more than four times as much as without bumps."""
    sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    slopes = [a**2 / (2 - a**2) for a in (ax, ay)]  # mean squares of the lobe's, by axis
    own = [max(1e-4, math.sqrt(2 * rest / (1 + rest))) for rest in ((1 - share) * square for square in slopes)]
    made = material(mdf="ASHIKHMIN_SHIRLEY", brdf="ASHIKHMIN_SHIRLEY", fresnel="NONE", f0=WHITE, ax=own[0], ay=own[1],
                    ex=2 / own[0]**2 - 2, ey=2 / own[1]**2 - 2, detail="NONE") | {"spread_from": [2 * share * square for square in slopes]}
    picture, _ = render(scene(width=8, height=8, materials=[made], lights=[], background=WHITE, samples=1024, max_bounces=2,
                              camera=ortho(0.1, eye=(-3 * sine, 0, 3 * cosine))))
    # all but periodic in the turn: with 60 steps 5e-6 from 360
    z, turn = np.meshgrid((np.arange(4000) + 0.5) / 4000, np.pi * (np.arange(60) + 0.5) / 30, indexing="ij")
    flat = np.sqrt(1 - z**2)
    x, y = flat * np.cos(turn), flat * np.sin(turn)
    ex, ey = 2 / ax**2 - 2, 2 / ay**2 - 2
    lobe = np.sqrt((ex + 1) * (ey + 1)) * z ** (ex * np.cos(turn) ** 2 + ey * np.sin(turn) ** 2)
    ho = cosine * z - sine * x
    light = np.stack([2 * ho * x + sine, 2 * ho * y, 2 * ho * z - cosine])
    slopes = share * x / z, share * y / z
    mi = slopes[0] * light[0] + slopes[1] * light[1] + light[2]
    mo = cosine - slopes[0] * sine
    lit = (ho > 0) & (light[2] > 0)
    plain = light[2] / np.maximum(light[2], cosine)
    seen = np.where(mi > 0, np.minimum(mi / np.maximum(np.maximum(mi, mo), 1e-9), 4 * plain), plain)
    expected = np.mean(lobe * np.where(lit, seen, 0))
    found = picture[..., :3].astype(float).mean()
    assert found == pytest.approx(expected, abs=0.01) and found < 1.003
    assert (share, ax, angle) != (1.0, 0.05, 0) or found > 0.99


def shone(made, light):
    """A plate's light of a sun, seen at 20 degrees."""
    return render(scene(width=2, height=2, samples=1, materials=[made], lights=[sun(light)], camera=ortho(0.1, eye=(1, 0, 2.75)),
                        max_bounces=0))[0][..., :3].astype(float).mean()


@pytest.mark.parametrize("brdf", ["MICROFACET", "ASHIKHMIN_SHIRLEY"])
@pytest.mark.parametrize("mdf", ["BECKMANN", "WARD", "WARD_HALF"])
@pytest.mark.parametrize("alphas", some([(0.05, 0.2), (0.3, 0.3), (0.7, 0.4)]))
def test_bumps_widen_a_lobe_as_the_library_does(mdf, brdf, alphas):
    """By slopes of these variances; the microfacet lobe of Beckmann, which would lose light, is as bright as before."""
    def lobe(x, y, **spread):
        said = "AUTO" if (mdf, brdf) == ("BECKMANN", "MICROFACET") else brdf
        return material(mdf=mdf, brdf=said, fresnel="NONE", f0=WHITE, ax=x, ay=y, detail="NONE") | spread
    variances = (0.03, 0.01)
    split = shade.split(shade.Material(mdf=mdf.lower(), brdf=brdf.lower(), ax=alphas[0], ay=alphas[1]), None,
                        [variances[0], 0, variances[1]], 1)
    bumped, wide = lobe(*alphas, spread_from=[2 * v for v in variances]), lobe(float(split.x), float(split.y))
    lights = [(0.1, 0.2, 0.9), (-0.5, 0.1, 0.8), (-0.2, 0.6, 0.4)]
    kept = np.array([shone(bumped, light) / shone(wide, light) for light in lights])
    assert kept == pytest.approx(kept[0], rel=1e-4)
    if (mdf, brdf) != ("BECKMANN", "MICROFACET"):
        assert kept == pytest.approx(1, rel=1e-4)
        return
    even = {"lights": [], "background": WHITE, "max_bounces": 1, "camera": ortho(0.1, eye=(1, 0, 2.75))}
    own, both = (render(scene(width=16, height=16, samples=1024, materials=[made], **even))[0][..., :3].mean()
                 for made in (lobe(*alphas), wide))
    assert kept[0] == pytest.approx(own / both, rel=0.01)


def test_burley_is_as_bright_as_its_own_formula_says():
    """Disney's diffuse makes a little: its albedo, by quadrature, over the ball's visible half."""
    rough, steps = 0.5, 64
    cosine = (np.arange(steps) + 0.5) / steps
    nv, nl, phi = np.meshgrid(cosine, cosine, np.arange(steps) * 2 * np.pi / steps, indexing="ij")
    lv = nl * nv + np.sqrt((1 - nl**2) * (1 - nv**2)) * np.cos(phi)
    fl, fv, rr = (1 - nl) ** 5, (1 - nv) ** 5, 2 * rough * (0.5 + 0.5 * lv)
    f = (1 - fl / 2) * (1 - fv / 2) + rr * (fl + fv + fl * fv * (rr - 1))
    albedo = (2 * f * nl).mean((1, 2))  # f nl over the hemisphere, / pi
    seen = cosine > np.sqrt(1 - 0.9**2)
    mean, _ = furnace(of(diffuse("BURLEY", rough)), sphere(rings=64, smooth=False), samples=256)
    expected = np.average(albedo[seen], weights=cosine[seen])
    assert mean == pytest.approx(np.full(3, expected), abs=0.003)


def coat(alpha):
    """Burley's GTR of exponent 1, shadowed as GGX of .25, a dielectric of 1.5: f, of n.l, n.v, n.h and l.h."""
    def dark(cosine):
        return 2 * cosine / (cosine + math.sqrt(0.0625 + (1 - 0.0625) * cosine**2))

    def f(nl, nv, nh, lh):
        d = (alpha**2 - 1) / (math.pi * math.log(alpha**2) * (1 + (alpha**2 - 1) * nh**2))
        inside = math.sqrt(1 - (1 - lh**2) / 1.5**2)
        s, p = (lh - 1.5 * inside) / (lh + 1.5 * inside), (1.5 * lh - inside) / (1.5 * lh + inside)
        return d * dark(nl) * dark(nv) * (s * s + p * p) / 2 / (4 * nl * nv)

    return {"closure": "COAT", "alpha": [alpha]}, f


def velvet(sigma):
    """Ashikhmin and Premoze's inverse Gaussian, shadowed as V grooves."""
    def f(nl, nv, nh, lh):
        cot2 = nh**2 / (1 - nh**2)
        d = math.exp(-cot2 / sigma**2) / (math.pi * sigma**2 * (1 - nh**2) ** 2)
        return d * min(1, 2 * nh * nl / lh, 2 * nh * nv / lh) / (4 * nl * nv)

    return {"closure": "SHEEN", "model": "VELVET", "sigma": [sigma]}, f


RIM = {"closure": "SHEEN", "model": "SCHLICK"}, lambda nl, nv, nh, lh: (1 - lh) ** 5


def burley(rough):
    def f(nl, nv, _nh, lh):
        fl, fv, rr = (1 - nl) ** 5, (1 - nv) ** 5, 2 * rough * lh**2
        return ((1 - fl / 2) * (1 - fv / 2) + rr * (fl + fv + fl * fv * (rr - 1))) / math.pi

    return diffuse("BURLEY", rough), f


def oren_nayar(rough):
    """As Fujii replaced the tangents."""
    def f(nl, nv, _nh, lh):
        a, s = 1 / (1 + (0.5 - 2 / (3 * math.pi)) * rough), 2 * lh**2 - 1 - nl * nv
        return a * (1 + rough * (s / max(nl, nv) if s > 0 else s)) / math.pi

    return diffuse("OREN_NAYAR", rough), f


@pytest.mark.parametrize("lobe", [coat(0.05), coat(0.6), velvet(0.3), velvet(1.5), RIM, burley(0.3), burley(1.0), oren_nayar(0.4),
                                  oren_nayar(1.0)],
                         ids=["sharp coat", "coat", "narrow velvet", "velvet", "rim", "burley", "rough burley", "oren", "rough oren"])
@pytest.mark.parametrize("tilt", [0.0, 0.4, 1.1, -1.3])
def test_coats_and_sheens_of_a_plate_in_the_sun(lobe, tilt):
    """Beside a matt white plate's 1 / pi, from above and from the side."""
    closure, f = lobe
    light, eye = np.array((math.sin(1.0), 0, math.cos(1.0))), np.array((-math.sin(tilt), 0.2 * math.sin(tilt), math.cos(tilt)))
    eye /= np.linalg.norm(eye)
    given = {"lights": [sun(tuple(light), WHITE)], "width": 4, "height": 4, "samples": 1, "meshes": [square()],
             "camera": ortho(0.02, tuple(3 * eye), (0, 0, 0))}
    seen, white = (render(scene(materials=[of(one)], **given))[0][..., 0].astype(float).mean() for one in (closure, diffuse()))
    half = (light + eye) / np.linalg.norm(light + eye)
    assert white > 0
    assert seen / white == pytest.approx(math.pi * f(light[2], eye[2], half[2], light @ half), rel=1e-4)


def left_by_bumps(kind, own, n, light, eye):
    """Of the light that reaches a matt surface whose normal `own` is bent to n."""
    bent, up, low = n @ own, n @ light, own @ light
    if kind == "OPEN":
        return float(up > 0)
    if not (up > 0 and low > 0 and (n @ eye > 0 or kind == "SHADED")):
        return 0.0
    if kind == "SHADED":  # Estevez et al. 2019: GGX of an eighth of the bump's squared slope
        alpha2 = min(0.125 * (1 - bent**2) / bent**2, 1)
        return 2 / (1 + math.sqrt(1 + alpha2 * (1 / low**2 - 1))) if bent > 0 else 0.0
    if kind == "FADED":  # Chiang et al. 2019
        g = min(1, low / (up * bent)) if bent > 0 else 1.0
        return g + g**2 - g**3
    return 1.0


@pytest.mark.parametrize("kind", ["HARD", "SHADED", "FADED", "OPEN"])
@pytest.mark.parametrize("lean", [0.0, 0.5, 1.3])
def test_matt_bumps_shade_each_other(kind, lean):
    """In light from low to high, by the rule of each kind, and not where the normal faces away from the eye."""
    own, n = np.array((0.0, 0, 1)), np.array((math.sin(lean), 0, math.cos(lean)))
    turn = {"type": "FRAME", "vector": n.tolist(), "to": "SHADING", "out": registers(3, 3)}
    bumped = of({**diffuse(), "bumps": kind, "normal": registers(3, 3)}, nodes=[turn])
    for tilt in (-0.8, 0.6):
        eye = np.array((math.sin(tilt), 0, math.cos(tilt)))
        for angle in (-1.4, -0.9, -0.2, 0.3, 1.0, 1.5):
            light = np.array((math.sin(angle), 0, math.cos(angle)))
            made = scene(materials=[bumped], lights=[sun(tuple(light), (math.pi,) * 3)], width=2, height=2, samples=1,
                         camera=ortho(0.02, tuple(3 * eye)))
            seen = render(made)[0][..., 0].astype(float).mean()
            expected = max(n @ light, 0) * left_by_bumps(kind, own, n, light, eye)
            assert seen == pytest.approx(expected, rel=1e-4, abs=1e-6), (tilt, angle)


@pytest.mark.parametrize("a", [0.4, 2.0])
def test_fibres_seen_from_right_above(a):
    """Where no direction is the eye's: a cosine's lobe that is stretched by a in all."""
    closure = {"closure": "SHEEN", "model": "FIBRES", "a": [a], "b": [0.0]}
    for light in ((0.6, 0, 0.8), (0.0, 0.8, 0.6), (-0.48, 0.64, 0.6)):
        given = {"lights": [sun(light, WHITE)], "width": 4, "height": 4, "samples": 1, "camera": ortho(0.02)}
        seen, white = (render(scene(materials=[of(one)], **given))[0][..., 0].astype(float).mean() for one in (closure, diffuse()))
        assert seen / white == pytest.approx((a / (a**2 * (1 - light[2]**2) + light[2]**2)) ** 2, rel=1e-4)


def test_what_glass_lets_through_has_its_tint():
    """By light samples, of a sun behind it, and by drawn rays."""
    tint = (0.2, 0.5, 0.9)
    for given in ({"lights": [sun((0.2, 0.1, -1), WHITE)]}, {"lights": [], "background": WHITE, "transparent": False}):
        clear, seen = (render(scene(materials=[of(glass(0.4, reflects=False, tint=color))], width=4, height=4, max_bounces=1, **given))[0][..., :3]
                       for color in (WHITE, tint))
        assert clear.mean() > 0.05
        np.testing.assert_allclose(seen, clear * np.float32(tint), rtol=1e-5)


def test_a_register_weighs_and_emits():
    """Emission by the UV map: what shines is not lit, and no bounce is needed."""
    uv = registers(3, 3)
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": uv}]
    given = of(EMISSION | {"weight": [*uv[:2], 0.25]}, nodes=nodes)
    picture, _ = render(scene(materials=[given], lights=[], samples=64, max_bounces=0))
    at = (np.arange(16) + 0.5) / 16
    np.testing.assert_allclose(picture[..., 0], np.broadcast_to(at, (16, 16)), atol=0.01)
    np.testing.assert_allclose(picture[..., 1], np.broadcast_to(at[:, None], (16, 16)), atol=0.01)
    np.testing.assert_allclose(picture[..., 2], 0.25, rtol=1e-6)


def test_a_picture_shows_nothing_where_rays_pass():
    """Alpha of a film that is transparent, and no colour of the world behind."""
    given = of(weighed(EMISSION, 0.5), weighed(TRANSPARENT, 0.75))
    picture, _ = render(scene(materials=[given], lights=[], samples=256, background=WHITE,
                              max_bounces=2, camera=ortho(0.9)))
    np.testing.assert_allclose(picture[..., :3], 0.5, rtol=1e-5)
    assert picture[..., 3].mean() == pytest.approx(0.25, abs=0.01)


@pytest.mark.parametrize("kind, key, place", [
    (diffuse(), "diffuse_bounces", 4), (glossy(1e-3), "glossy_bounces", 4),
    (glass(1e-3, reflects=False), "transmission_bounces", -2),
    (TRANSLUCENT, "transmission_bounces", -2), (TRANSPARENT, "transparent_max_bounces", -2)])
def test_bounces_of_each_kind_have_their_end(kind, key, place):
    """A sheet, and a wide one that shines: behind the camera or below the first. Its brightness is
    a node's: as a plain number it would be a light, which needs no bounce."""
    meshes = [square(), square(200.0, place, 1)]
    one = {"type": "MATH", "operation": "ADD", "a": [1.0], "b": [0.0], "c": [0.0], "out": registers(3, 1)}
    shines = of(EMISSION | {"weight": registers(3, 1) * 3}, nodes=[one])
    given = scene(materials=[of(kind), shines], meshes=meshes, lights=[], max_bounces=3)
    seen = {}
    for word in ("diffuse_bounces", "glossy_bounces", "transmission_bounces",
                 "transparent_max_bounces", "max_bounces"):
        seen[word] = render(given | {word: 0})[0][..., 0].mean()
    stops = {key} | (set() if kind is TRANSPARENT else {"max_bounces"})
    for word, brightness in seen.items():
        assert brightness == (0 if word in stops else pytest.approx(1, abs=0.03)), word


@pytest.mark.parametrize("most", range(5))
def test_bounces_of_all_kinds_are_counted_together(most):
    """Through a pane, to a mirror, through the pane again, to what shines: three. What lets a ray pass straight on is none."""
    one = {"type": "MATH", "operation": "ADD", "a": [1.0], "b": [0.0], "c": [0.0], "out": registers(3, 1)}
    shines = of(EMISSION | {"weight": registers(3, 1) * 3}, nodes=[one])
    given = scene(materials=[of(glass(1e-3, reflects=False)), of(glossy(1e-3)), shines, of(TRANSPARENT)], lights=[], max_bounces=most, samples=4,
                  meshes=[square(200.0), square(200.0, -2, 1), square(2000.0, 4, 2), square(200.0, -1, 3)])
    assert render(given)[0][..., 0].mean() == (0 if most < 3 else pytest.approx(1, abs=0.03))


# What nodes say of the ray that goes on from a closure, of PATH's words.
CAME = {"matt": (diffuse(), 4, "DIFFUSE REFLECTION"), "gloss": (glossy(0.3), 4, "GLOSSY REFLECTION"),
        "mirror": (glossy(1e-4), 4, "GLOSSY REFLECTION SINGULAR"), "refraction": (glass(0.3, reflects=False), -2, "GLOSSY TRANSMISSION"),
        "clear": (glass(1e-4, reflects=False), -2, "GLOSSY TRANSMISSION SINGULAR"),
        "translucent": (TRANSLUCENT, -2, "DIFFUSE TRANSMISSION"), "transparent": (TRANSPARENT, -2, "CAMERA FILM")}


@pytest.mark.parametrize("name", CAME)
def test_what_a_ray_says_it_is_behind_each_closure(name):
    """A sheet, and a wide one that shines by what its node says: all of its light or none."""
    kind, place, true = CAME[name]
    seen = set()
    for word in "CAMERA FILM SHADOW DIFFUSE GLOSSY SINGULAR REFLECTION TRANSMISSION".split():
        shines = of(EMISSION | {"weight": registers(3, 1) * 3}, nodes=[{"type": "PATH", "what": word, "out": registers(3, 1)}])
        picture, _ = render(scene(materials=[of(kind), shines], meshes=[square(), square(200.0, place, 1)], lights=[], max_bounces=1,
                                  width=4, height=4, samples=4, transparent=False))
        assert (picture[..., :3] == 0).all() or picture[..., :3].mean() > 0.3, word
        seen |= {word} if picture[..., 0].any() else set()
    assert seen == set(true.split())


def test_a_list_that_is_too_long_is_refused():
    with pytest.raises(ValueError, match=r"closures has 9 items; 1 to 8 are expected"):
        native.start(scene(materials=[of(*[TRANSPARENT] * 9)]))
    with pytest.raises(ValueError, match=r"closures has 0 items"):
        native.start(scene(materials=[of()]))
    with pytest.raises(ValueError, match=r"closures\[1\]: model must be one of LAMBERT, OREN_NAYAR"):
        native.start(scene(materials=[of(TRANSPARENT, diffuse("MINNAERT"))]))


def test_what_is_not_finite_stays_out():
    """Weights and parameters beyond their range, NaN too: a picture of numbers."""
    uv, bad = registers(3, 3), registers(6, 1)
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": uv},
             {"type": "MATH", "operation": "EXPONENT", "a": [1e4], "b": [0.0], "c": [0.0], "out": bad},
             {"type": "MATH", "operation": "SUBTRACT", "a": bad, "b": bad, "c": [0.0], "out": bad},
             {"type": "MATH", "operation": "MODULO", "a": [1e30], "b": [1e-30], "c": [0.0],
              "out": registers(7, 1)}]
    odd = registers(7, 1)
    given = of(weighed(diffuse("EON", 5.0, (bad[0], odd[0], -3.0)), 2.0),
               glass(-1.0, 0.0) | {"weight": [bad[0], odd[0], 0.1], "alpha": odd, "ior": bad},
               weighed(TRANSLUCENT, -1.0), glossy(0.1) | {"ax_from": bad, "ay_from": odd}, nodes=nodes)
    render(scene(materials=[given], meshes=[square()], max_bounces=4, background=WHITE))


def lambda_of(alpha, mdf, tangent):
    """Smith's, of a direction so steep along the axis of this alpha."""
    if mdf == "GGX":
        return (np.sqrt(1 + (alpha * tangent) ** 2) - 1) / 2
    a = 1 / (alpha * tangent)
    return (math.erf(a) - 1) / 2 + np.exp(-a * a) / (2 * a * np.sqrt(np.pi))


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize("mdf, axis, angle, ax, ay", [
    ("GGX", 0, 70, 0.64, 0.64), ("GGX", 1, 70, 0.64, 0.2), ("GGX", 0, 50, 0.9, 0.3), ("BECKMANN", 0, 70, 0.64, 0.64)])
def test_shadowing_of_each_direction_or_of_both(mdf, axis, angle, ax, ay, apart):
    """One light, mirrored into the eye: f cos = D G / (4 cos), at 70 degrees, alpha .64 .249 or .281."""
    sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    toward = np.eye(3)[axis] * sine + (0, 0, cosine)
    made = material(mdf=mdf, brdf="MICROFACET", fresnel="NONE", detail="NONE", f0=WHITE, ax=ax, ay=ay) | {"apart": apart}
    camera = ortho(0.1, eye=tuple(3 * np.multiply(toward, (-1, -1, 1))))
    picture, _ = render(scene(width=4, height=4, materials=[made], camera=camera, lights=[sun(toward)], samples=1))
    facets = 1 / (np.pi * ax * ay)
    both = lambda_of((ax, ay)[axis], mdf, sine / cosine)
    seen = (1 + both) ** -2 if apart else 1 / (1 + 2 * both)
    wanted = facets * seen / (4 * cosine)
    if (mdf, angle) == ("GGX", 70) and axis == 0:
        assert wanted == pytest.approx(0.249 if apart else 0.281, abs=6e-4)
    assert picture[..., 0] == pytest.approx(wanted, rel=2e-3 if mdf == "BECKMANN" and apart else 2e-4)  # a fit


@pytest.mark.parametrize("mdf, brdf", [("ASHIKHMIN_SHIRLEY", "ASHIKHMIN_SHIRLEY"), ("WARD", "MICROFACET"), ("GGX", "WARD_BOUNDED")])
def test_other_lobes_have_no_shadows_apart(mdf, brdf):
    common = {"width": 4, "height": 4, "camera": ortho(0.1, eye=(-2, 0, 1)), "lights": [sun((0.8, 0.2, 0.5))], "samples": 1}
    values = [render(scene(materials=[material(mdf=mdf, brdf=brdf, ax=0.4, ay=0.3, ex=9.0, ey=5.0) | {"apart": apart}], **common))[0]
              for apart in (False, True)]
    assert values[0][..., 0].min() > 0.001
    np.testing.assert_allclose(*values, rtol=1e-6)


def test_a_dump_says_what_the_reference_shades(tmp_path):
    """Which has no shadows of each direction by itself."""
    planes = [dump(scene(materials=[material(mdf="GGX", brdf="MICROFACET") | {"apart": apart}], camera=ortho(0.1, eye=(-2, 0, 1)),
                         lights=[sun((0.8, 0.2, 0.5))]), tmp_path / "d.exr")[0] for apart in (False, True)]
    assert planes[0]["light0.S.R"].min() > 0.001
    np.testing.assert_allclose(planes[1]["light0.S.R"], planes[0]["light0.S.R"], rtol=1e-6)


def test_a_turned_tangent_turns_the_shadows():
    """The groove's direction by a node, a quarter turn."""
    sine, cosine = np.sin(np.radians(60)), np.cos(np.radians(60))
    plain = {"mdf": "GGX", "brdf": "MICROFACET", "fresnel": "NONE", "detail": "NONE", "f0": WHITE}
    camera = ortho(0.1, eye=(-3 * sine, 0, 3 * cosine))
    common = {"width": 4, "height": 4, "camera": camera, "lights": [sun((sine, 0, cosine))], "samples": 1}
    turned = material(ax=0.3, ay=0.8, **plain) | {"apart": True, "groove_from": [0.0, 2.0]}
    straight = material(ax=0.8, ay=0.3, **plain) | {"apart": True}
    values = [render(scene(materials=[made], **common))[0][..., 0] for made in (turned, straight)]
    assert values[0] == pytest.approx(values[1], rel=1e-5)
