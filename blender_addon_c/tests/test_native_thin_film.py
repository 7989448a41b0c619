# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films, against a sum over wavelengths: Maxwell's equations at each by the characteristic matrix of a
layer, weighed by the CIE's observer in steps of 5 nm. The module sums reflections instead, by the Fourier
transform of a fit of the observer."""

import ast

import numpy as np
import pytest

from native_scenes import ROOT, dump, finish, material, native, ortho, read_dump, registers, render, scene, square, sun

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
    """Red, green and blue of light at this angle; body: its complex index in each."""
    out = []
    for shares, n in zip(SHARES, body):
        sine2, reflected = 1 - cosine**2, 0
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
@pytest.mark.parametrize("film", [1.33, 1.8, 2.6])
@pytest.mark.parametrize("most", [60, 1000, 6000])
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
