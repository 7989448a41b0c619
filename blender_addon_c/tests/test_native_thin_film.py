# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films, against a sum over wavelengths: Maxwell's equations at each by the characteristic matrix of a
layer, weighed by the CIE's observer in steps of 5 nm. The module sums reflections instead, by the Fourier
transform of a fit of the observer."""

import ast

import numpy as np
import pytest

from native_scenes import ROOT, dump, few, finish, material, native, ortho, read_dump, registers, render, scene, some, sphere, square, sun

COST = 13

RGB = np.array([(3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560),
                (0.0556434, -0.2040259, 1.0572252)])


def observer():
    """(wavelengths in nm, their shares of red, green and blue), from the table of the node Wavelength."""
    tree = ast.parse((ROOT / "blender_addon_c/export/node_curve.py").read_text())
    text = next(node.value for node in tree.body if isinstance(node, ast.Assign)
                and getattr(node.targets[0], "id", "") == "_OBSERVER")
    rows = [[int(part) for part in row.value.split()] for row in ast.walk(text) if isinstance(row, ast.Constant)]
    wave = np.arange(380, 780.01, 0.5)
    shares = RGB @ [np.interp(wave, 380 + 5 * np.arange(81), row) for row in rows]
    return wave, shares / shares.sum(1)[:, None]


WAVE, SHARES = observer()


def truth(cosine, thickness, film, body):
    """Red, green and blue of light at this angle; body: its complex index in each. What enters no film is
    reflected."""
    out, sine2 = [], 1 - cosine**2
    if sine2 >= film**2:
        return np.ones(3)
    for shares, n in zip(SHARES, body):
        reflected = 0
        cosines = cosine, np.sqrt(1 - sine2 / film**2), np.sqrt(1 - sine2 / (n + 0j) ** 2)
        phase = 2 * np.pi * film * thickness * cosines[1] / WAVE
        for admits in ([i * c for i, c in zip((1, film, n), cosines)], [i / c for i, c in zip((1, film, n), cosines)]):
            electric = np.cos(phase) - 1j * np.sin(phase) * admits[2] / admits[1]
            magnetic = admits[2] * np.cos(phase) - 1j * np.sin(phase) * admits[1]
            reflected = reflected + 0.5 * abs((admits[0] * electric - magnetic) / (admits[0] * electric + magnetic))**2
        out.append((reflected * shares).sum())
    return np.clip(out, 0, 1)


GLASS, PLASTIC, DIAMOND = (1.5,) * 3, (1.2, 1.3, 1.4), (2.42,) * 3
GOLD, IRON = (0.18 + 3.4j, 0.42 + 2.35j, 1.37 + 1.77j), (2.87 + 3.11j, 2.93 + 2.93j, 2.59 + 2.77j)
UV, THICK, OUT = registers(3, 3), registers(6, 1), registers(7, 3)


def said_of(film, body):
    """A METAL's or node's words."""
    return {"film_thickness": THICK, "film_ior": [film], "film_eta": [complex(n).real for n in body],
            "film_k": [complex(n).imag for n in body]}


def sources(most):
    """u is a cosine; v a thickness, of at most this."""
    return [{"type": "GEOMETRY", "what": "UV", "out": UV},
            {"type": "MATH", "operation": "MULTIPLY", "a": UV[1:2], "b": [float(most)], "c": [0.0], "out": THICK}]


@pytest.mark.parametrize("body", [GLASS, PLASTIC, DIAMOND, GOLD, IRON], ids="glass plastic diamond gold iron".split())
@pytest.mark.parametrize("film", some([1.33, 1.8, 2.6]))
@pytest.mark.parametrize("most", some([1000, 60, 6000]))
def test_colours_of_films_are_those_of_a_sum_over_wavelengths(body, film, most, tmp_path):
    nodes = [*sources(most), {"type": "THIN_FILM", "cosine": UV[:1], "out": OUT, **said_of(film, body)}]
    given = scene(width=20, height=24, materials=[material() | {"nodes": nodes, "f0_from": OUT}])
    planes, _ = dump(given, tmp_path / "d.exr")
    cosine, v = planes["uv.U"].ravel().astype(float), planes["uv.V"].ravel().astype(float)
    wanted = np.array([truth(c, t * most, film, body) for c, t in zip(cosine, v)])
    found = np.stack([planes[f"Color.{part}"].ravel() for part in "RGB"], -1).astype(float)
    off = abs(found - wanted)
    assert off.mean() < 0.001 and off[cosine > 0.1].max() < 0.01 and off.max() < 0.02
    assert most < 1000 or wanted.std(0).max() > 0.02  # there is something to see


@pytest.mark.parametrize("angle", [0, 40, 75])
def test_a_metal_reflects_as_its_film_does(angle):
    """Beside the same lobe without a film, in the mirror of one light and by draws of an even world."""
    thickness, film = 420.0, 1.4
    sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    plain = material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=0.05, ay=0.05, ex=798.0, ey=798.0)
    filmed = plain | said_of(film, IRON) | {"film_thickness": [thickness]}
    camera = ortho(0.1, eye=(-3 * sine, 0, 3 * cosine))
    for light in ({"lights": [sun((sine, 0, cosine))]}, {"lights": [], "background": (1, 1, 1), "samples": 1024}):
        pictures = [render(scene(width=8, height=8, camera=camera, materials=[made], max_bounces=2, **light))[0][..., :3]
                    .astype(float).mean((0, 1)) for made in (filmed, plain)]
        # about this angle where the whole lobe counts
        about = 0.006 if light["lights"] else 0.03
        np.testing.assert_allclose(pictures[0] / pictures[1], truth(cosine, thickness, film, IRON), atol=about)


def split(samples, **given):
    """(what a plate of smooth glass reflects, what it lets through) of an even white world, in red, green and blue:
    a black plate takes the rest."""
    angle, below = given.pop("angle"), given.pop("below", False)
    up = -1 if below else 1
    sine, cosine = np.sin(np.radians(angle)), up * np.cos(np.radians(angle))
    clear = {"closure": "GLASS", "alpha": [1e-4], "tint": (1.0,) * 3, "reflects": True, "refracts": True, "joint": True}
    plate = {"name": "plate", "nodes": [], "closures": [clear | given]}
    black = material(fresnel="NONE", f0=(0, 0, 0), kd=(0, 0, 0))
    seen = []
    for side in (-up, up):  # the eye's rays start between the two
        picture, _ = render(scene(width=8, height=8, materials=[plate, black], meshes=[square(4.0), square(80.0, side, 1)],
                                  lights=[], background=(1, 1, 1), samples=samples, max_bounces=4,
                                  camera=ortho(0.1, eye=(-0.5 * sine, 0, 0.5 * cosine))))
        seen.append(picture[..., :3].astype(float).mean((0, 1)))
    return np.array(seen)


@pytest.mark.parametrize("below", [False, True], ids=["outside", "inside"])
@pytest.mark.parametrize("angle", some([35, 0, 60]))
@pytest.mark.parametrize("thickness, film, ior", some([(300.0, 1.33, 1.5), (450.0, 2.2, 1.5), (150.0, 1.8, 2.4)]))
def test_clear_bodies_split_light_as_their_films_do(thickness, film, ior, angle, below):
    """By colour, T = 1 - R. From inside indices count over the body's, as in Cycles 5.0."""
    reflected, rest = split(4096, ior=[ior], film_thickness=[thickness], film_ior=[film], angle=angle, below=below)
    by, n = (film / ior, 1 / ior) if below else (film, ior)
    wanted = truth(np.cos(np.radians(angle)), thickness, by, (n,) * 3)
    np.testing.assert_allclose(reflected, wanted, atol=0.006)
    np.testing.assert_allclose(rest, 1 - wanted, atol=0.006)
    assert reflected.max() - reflected.min() > 0.003 or below


@pytest.mark.parametrize("angle", some([35, 0, 60, 75]))
@pytest.mark.parametrize("below", [False, True], ids=["outside", "inside"])
def test_tints_colour_what_is_reflected_head_on(angle, below):
    """Of the rest of Fresnel's, 1 is 1; what is not reflected is refracted."""
    tint, ior = np.array((0.25, 0.6, 1.0)), 1.8
    reflected, rest = split(4096, ior=[ior], mirror_tint=tuple(tint), angle=angle, below=below)
    eta, cosine, head_on = 1 / ior if below else ior, np.cos(np.radians(angle)), ((ior - 1) / (ior + 1)) ** 2
    bent = np.sqrt(max(1 - (1 - cosine**2) / eta**2, 0))
    bare = 0.5 * (((cosine - eta * bent) / (cosine + eta * bent))**2 + ((eta * cosine - bent) / (eta * cosine + bent))**2)
    wanted = head_on * tint + (1 - head_on * tint) * (bare - head_on) / (1 - head_on)
    np.testing.assert_allclose(reflected, wanted, atol=0.006)
    np.testing.assert_allclose(rest, 1 - wanted, atol=0.006)


@pytest.mark.parametrize("up", [True, False], ids=["reflected", "refracted"])
@pytest.mark.parametrize("beckmann", [False, True], ids=["ggx", "beckmann"])
def test_rough_films_under_a_lamp(up, beckmann):
    """Far from where a smooth one sends light: at the facets that send it from the lamp to the eye the film, not the
    body, says how much; all else is as without it."""
    thickness, film, ior = 430.0, 1.7, 2.4
    eye, light = (v / np.linalg.norm(v) for v in np.array([(-2.0, 0.0, 1.0), (0.3, 0.2, 1.0 if up else -1.0)]))
    half = eye + (light if up else ior * light)
    cosine = abs(half @ eye) / np.linalg.norm(half)
    rough = {"closure": "GLASS", "ior": [ior], "alpha": [0.6], "tint": (1.0,) * 3, "reflects": True, "refracts": True,
             "joint": True, "beckmann": beckmann}
    seen = []
    for more in ({"film_thickness": [thickness], "film_ior": [film]}, {}):
        plate = {"name": "plate", "nodes": [], "closures": [rough | more]}
        picture, _ = render(scene(width=8, height=8, camera=ortho(0.1, eye=3 * eye), materials=[plate], meshes=[square(4.0)],
                                  lights=[sun(light)]))
        seen.append(picture[..., :3].astype(float).mean((0, 1)))
    filmed, bare = truth(cosine, thickness, film, (ior,) * 3), truth(cosine, 0.0, film, (ior,) * 3)
    assert seen[1].min() > 0.01 and abs(filmed - bare).max() > 0.05
    wanted = filmed / bare if up else (1 - filmed) / (1 - bare)
    np.testing.assert_allclose(seen[0] / seen[1], wanted, atol=0.006 / bare.min() if up else 0.006)


@pytest.mark.parametrize("alpha", some([1e-4, 0.1, 0.5], 2))
@pytest.mark.parametrize("changes", [{}, {"beckmann": True}, {"mirror_tint": (0.2, 0.5, 1.0)}], ids=["ggx", "beckmann", "tinted"])
def test_a_filmed_body_makes_no_light(alpha, changes):
    """A ball in an even world, all its bounces; a smooth one keeps all."""
    made = {"closure": "GLASS", "ior": [1.5], "alpha": [alpha], "tint": (1.0,) * 3, "reflects": True, "refracts": True,
            "joint": True, "film_thickness": [350.0], "film_ior": [1.9], **changes}
    picture, _ = render(scene(width=24, height=24, samples=few(256), background=(1, 1, 1), lights=[], transparent=False,
                              max_bounces=64, transparent_max_bounces=64, meshes=[sphere(smooth=False)], camera=ortho(1.0),
                              materials=[{"name": "ball", "nodes": [], "closures": [made]}]))
    y, x = (np.mgrid[:24, :24] + 0.5) / 12 - 1
    ball = picture[np.hypot(x, y) < 0.9][:, :3].astype(float)
    mean, error = ball.mean(0), ball.std(0) / np.sqrt(len(ball))
    assert (mean <= 1.001 + 3 * error).all()
    assert alpha > 1e-4 or (mean > 0.997).all()


@pytest.mark.parametrize("angle", [0, 50, 80])
@pytest.mark.parametrize("tint", [0.0, 0.5, 1.0])
def test_tinted_metals_under_a_film(tint, angle):
    """The inner side reflects by Schlick's with a dip at 82 degrees, in the phase that the index says, both swings as
    much: 18 pictures of Cycles 5.0 (3 colours, 3 tints, 2 angles, films of 1.05 to 2.5 to 1 µm) are within .001 of this in the mean."""
    thickness, film, n = 330.0, 1.4, 1.6 + 2.2j
    cosine = np.cos(np.radians(angle))
    inner = np.sqrt(1 - (1 - cosine**2) / film**2)
    head_on = abs((film - n) / (film + n)) ** 2
    own = head_on + (1 - head_on) * (1 - inner) ** 5 - (inner * (1 - inner) ** 6 * 7 * (7 / 6) ** 6 * (1 - tint)
                                                        * (head_on + (1 - head_on) * (6 / 7) ** 5))
    below, wanted = np.sqrt(1 - (1 - cosine**2) / n**2), np.zeros(3)
    turn = np.exp(2j * np.pi * 2 * film * thickness * inner / WAVE)
    for outer, phase in (((cosine - film * inner) / (cosine + film * inner), (film * inner - n * below) / (film * inner + n * below)),
                         ((film * cosine - inner) / (film * cosine + inner), (n * inner - film * below) / (n * inner + film * below))):
        way = np.sqrt(np.clip(own, 0, 1)) * phase / abs(phase) * turn
        wanted += 0.5 * SHARES @ abs((outer + way) / (1 + outer * way)) ** 2
    plain = material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=0.05, ay=0.05, ex=798.0, ey=798.0)
    filmed = plain | said_of(film, (n,) * 3) | {"film_thickness": [thickness], "film_tint": (tint,) * 3}
    sine = np.sqrt(1 - cosine**2)
    pictures = [render(scene(width=8, height=8, camera=ortho(0.1, eye=(-3 * sine, 0, 3 * cosine)), materials=[made],
                             lights=[sun((sine, 0, cosine))]))[0][..., :3].astype(float).mean((0, 1)) for made in (filmed, plain)]
    np.testing.assert_allclose(pictures[0] / pictures[1], wanted, atol=0.006)


@pytest.mark.parametrize("tint, counts_as", [(1.7, 1.0), (-0.5, 0.0)])
def test_a_tint_beyond_its_range_is_its_limit(tint, counts_as):
    sine, cosine = np.sin(np.radians(80)), np.cos(np.radians(80))
    seen = [render(scene(width=4, height=4, camera=ortho(0.1, eye=(-3 * sine, 0, 3 * cosine)), lights=[sun((sine, 0, cosine))], materials=[
        material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1), ax=0.05, ay=0.05, ex=798.0, ey=798.0)
        | said_of(1.05, GOLD) | {"film_thickness": [330.0], "film_tint": (part,) * 3}]))[0] for part in (tint, counts_as, 0.5)]
    assert (seen[0] == seen[1]).all() and abs(seen[2] - seen[1])[..., :3].max() > 0.01 * seen[1].max()


def test_a_dump_has_no_words_for_a_film(tmp_path):
    """It leaves such a material out, with a warning: its header would say a white mirror."""
    plain = material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1))
    filmed = plain | said_of(1.4, IRON) | {"film_thickness": [420.0]}
    for made, there in ((plain, True), (filmed, False)):
        path = tmp_path / f"{there}.exr"
        _picture, state = render(scene(width=4, height=4, materials=[made], samples=1, dump=str(path)))
        assert bool((read_dump(path)[0]["light0.S.R"] > 0).any()) == there
        assert any("thin film" in text for text in state["warnings"]) == (not there)


def test_the_denoiser_s_albedo_is_that_below_a_film():
    """As without it: a film is thin, and its colour is not that of a white mirror."""
    filmed = material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1)) | said_of(1.4, GOLD) | {"film_thickness": [420.0]}
    job = native.start(scene(width=4, height=4, materials=[filmed], meshes=[square(4.0)], planes=[{"type": "ALBEDO"}]))
    assert finish(job)["state"] == "done"
    albedo = np.zeros((4, 4, 3), np.float32)
    native.image(job, albedo, "ALBEDO")
    native.free(job)
    n = np.array(GOLD)
    np.testing.assert_allclose(albedo[2, 2], abs((n - 1) / (n + 1)) ** 2, atol=2e-3)


def test_no_film_makes_light_or_numbers_that_are_none():
    odd = [0.0, 1e-30, -1.0, 1e30, 3e38]
    for thickness in odd:
        for ior in (0.0, 0.5, 1.0, 1e9):
            made = material(mdf="GGX", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1)) | {
                "film_thickness": [thickness], "film_ior": [ior], "film_eta": [0.0, 1e9, -4.0], "film_k": [0.0, 1e9, -1.0]}
            picture, _ = render(scene(materials=[made], lights=[], background=(1, 1, 1), samples=16, max_bounces=2,
                                      meshes=[square()]))
            assert (picture[..., :3] >= 0).all() and (picture[..., :3] <= 1.001).all()
    with pytest.raises(ValueError, match="film_ior"):
        native.start(scene(materials=[material() | {"film_thickness": [100.0]}]))
