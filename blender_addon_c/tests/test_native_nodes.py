# SPDX-License-Identifier: GPL-3.0-or-later
"""Every kind of node that the module knows: what it says of a plate, and who asks for it in Blender.

A kind that has no entry here, or that nothing in export/ asks for, fails.
"""

import ast
import colorsys
import json
import subprocess

import numpy as np
import pytest

from native_scenes import (ROOT, dump, image, material, mesh, native, ortho, persp, registers, render, scene, square, sun,
                           unit, vectors)

COST = 5.3

KINDS = native.table()["nodes"]
COLORS = np.random.default_rng(3).random((5, 7, 3), np.float32)
TILT = unit(np.array((0.3, -0.2, 0.9)))
IMAGES = [
    image(COLORS, filter="CLOSEST"),
    image(np.full((2, 2, 3), 0.5 + 0.5 * TILT, np.float32)),
]


def nearest(u, v):
    rows, columns = COLORS.shape[:2]
    return COLORS[(v * rows).astype(int), (u * columns).astype(int)]


def tilted(u, v):
    return np.broadcast_to(TILT, (*u.shape, 3))


def stacked(function):
    """Three numbers at each (u, v) as one array."""
    return lambda u, v: np.stack([np.broadcast_to(part, u.shape) for part in function(u, v)], -1)


UV, COLOR, OUT = registers(3, 3), registers(6, 3), registers(9, 4)
PLACE = registers(13, 4)
SOURCES = [{"type": "GEOMETRY", "what": "UV", "out": UV},
           {"type": "IMAGE", "image": 0, "at": UV[:2], "out": COLOR},
           {"type": "WEAVE", "cloth": 0, "out": PLACE},
           *({"type": "MATH", "operation": "ADD", "a": [part], "b": [0.125], "c": [0.0], "out": [out]}
             for part, out in zip(UV, registers(25, 2)))]
ENDS, PICKS = (json.loads(subprocess.run([ROOT / "build/shade", "presets", "linen", "--json"], check=True,
                                         capture_output=True).stdout)[key] for key in ("ends_per_cm", "picks_per_cm"))
LINEN = PICKS / ENDS
CLOTHS = [{"preset": "linen", "size": 0.005 / ENDS, "transmit": 0.0, "open": False}]
TABLE = np.random.default_rng(4).random((256, 4), np.float32)
TURN = [0, -0.5, 0, 0.75, 0.25, 0, 0, 0.125, 0, 0, 1, 0.5]


# 60 on a square metre: too large to be true, but a pixel is a sixteenth of the plate
SCRATCHED = {"density": 0.006, "length": 300.0, "width": 60.0, "depth": 0.3, "direction": 0.4, "spread": 0.5, "seed": 7.0,
             "tile": 2.0}


def scratched(u, v):
    """(height in metres, normal) of the tool's own field, of lengths in tiles of two metres."""
    words = "--pits 240 --radius 0.01,0.0225 --stretch 2.5,7.5 --depth 0.15,0.45 --seed 7".split()
    words += ["--direction", str(np.degrees(0.4)), "--spread", str(np.degrees(0.5))]
    done = subprocess.run([ROOT / "build/shade", "scratch", "--eval", *words], capture_output=True, text=True, check=True,
                          input="".join(f"{a / 2:.17g} {b / 2:.17g}\n" for a, b in zip(u.ravel(), v.ravel())))
    said = np.array([line.split() for line in done.stdout.splitlines()], float).reshape(*u.shape, -1)
    return 2 * said[..., 0], said[..., 1:4]


def scratched_again(u, v):
    """On a plate that leans .7 of the slopes more; that it is twice as wide as they are told makes them deeper."""
    slopes = TILT[:2] / TILT[2] + 0.7 * (lambda n: n[..., :2] / n[..., 2:])(scratched(u, v)[1])
    return unit(np.concatenate([slopes, np.ones((*u.shape, 1))], -1))


def ramp(u, _v):
    at = np.clip(u, 0, 1) * 255
    return np.stack([np.interp(at, np.arange(256), TABLE[:, k]) for k in range(3)], -1)


def rough_albedo(u, _v):
    """Of GGX, alpha .5, seen head-on, Smith's masking: over the facets that the eye sees."""
    x = (np.arange(4096) + 0.5) / 4096
    light = np.cos(2 * np.arctan(0.5 * np.sqrt(x / (1 - x))))
    lit = light[light > 0]
    shadow = 0.5 * (np.sqrt(1 + 0.25 * (1 / lit**2 - 1)) - 1)
    return np.full((*u.shape, 3), (1 / (1 + shadow)).sum() / len(x))


def bare(u, _v):
    """What a metal of this index reflects of light that is not polarised, by its complex amplitudes."""
    n, sine2 = 0.4 + 2.5j, 1 - u**2
    inside = np.sqrt(n**2 - sine2)
    s, p = (u - inside) / (u + inside), (n**2 * u - inside) / (n**2 * u + inside)
    return np.repeat(0.5 * (abs(s) ** 2 + abs(p) ** 2)[..., None], 3, -1)


# By kind: a node that may read SOURCES and writes OUT, and what it says at (u, v): a colour of three
# (or one, which the others repeat), or NORMAL.
NODES = {
    "IMAGE": ({"image": 0, "out": OUT[:3]}, nearest),
    "NORMAL_MAP": ({"image": 1, "strength": 1.0, "out": OUT[:3]}, tilted),
    "PERTURB": ({"color": [float(0.5 + 0.5 * t) for t in TILT], "strength": [1.0], "out": OUT[:3]},
                tilted),
    "BUMP": ({"height": [0.1, 0.1 + 0.6 * 0.25, 0.1 - 0.4 * 0.25], "along": [0.25, 0, 0, 0.25], "strength": [0.5],
              "distance": [2.0], "normal": [0.0, 0.0, 1.0], "out": OUT[:3]}, lambda u, v:
             np.broadcast_to(unit(unit(np.array((-0.6, 0.4, 1))) + (0, 0, 1)), (*u.shape, 3))),
    "ALBEDO": ({"alpha": [0.5], "out": OUT[:3]}, rough_albedo),
    # a smooth body reflects and refracts all
    "GLASS_ALBEDO": ({"ior": [1.5], "alpha": [1e-4], "joint": True, "out": OUT[:2]},
                     stacked(lambda u, v: (1.0, 1.0, 1.0))),
    # from above, of roughness 1, as Cycles 5.0 was seen to reflect: .342 of even light, a .876, b about 0
    "FIBRES": ({"roughness": [1.0], "out": [OUT[1], OUT[2], OUT[0]]}, stacked(lambda u, v: (0.342, 0.876, 0.0))),
    # of no thickness; films: test_native_thin_film.py
    "THIN_FILM": ({"cosine": UV[:1], "film_thickness": [0.0], "film_ior": [1.33], "film_eta": [0.4] * 3,
                   "film_k": [2.5] * 3, "out": OUT[:3]}, bare),
    "GEOMETRY": ({"what": "UV", "out": OUT[:3]}, stacked(lambda u, v: (u, v, 0))),
    "LAYER": ({"layer": 0, "shift": [0.125, 0.0], "out": OUT[:3]},
              stacked(lambda u, v: (0.5 * (u + 0.125) + 0.25 * v, 0.75 - 0.5 * v, 0))),
    "OBJECT": ({"what": "POINT_INTO", "vector": UV, "out": OUT[:3]},
               stacked(lambda u, v: (0.5 * u + 0.25, v, 0.5))),
    # which says nothing by that name: test_native_told.py has those that do
    "ATTRIBUTE": ({"attribute": 0, "out": OUT[:3], "more": OUT[3:4]}, stacked(lambda u, v: (0, 0, 0))),
    # a pixel is a sixteenth of the plate; across (0, 0, 1) and (1, 1, 1) x (0, 0, 1)
    "STEP": ({"axis": "Y", "scale": 8.0, "otherwise": 0.1, "out": OUT[:2]},
             stacked(lambda u, v: (0.5 * 0.5**0.5,) * 3)),
    "PATH": ({"what": "CAMERA", "out": OUT[:1]}, stacked(lambda u, v: (1.0, 1.0, 1.0))),
    # the eye's mirror image is to be .01 above the plate
    "BEND": ({"normal": [0.8, 0.0, -0.6], "out": OUT[:3]},
             stacked(lambda u, v: (0.495**0.5, 0.0, 0.505**0.5))),
    "FRAME": ({"vector": [float(t) for t in TILT], "to": "SHADING", "out": OUT[:3]}, tilted),
    "TRANSFORM": ({"vector": UV, "matrix": TURN, "unit": False, "out": OUT[:3]},
                  stacked(lambda u, v: (0.75 - 0.5 * v, 0.25 * u + 0.125, 0.5))),
    "MATH": ({"operation": "MULTIPLY", "a": UV[:1], "b": UV[1:2], "c": [0.0], "out": OUT[:1]},
             stacked(lambda u, v: (u * v, u * v, u * v))),
    "MIX": ({"mode": "SCREEN", "factor": [0.75], "a": UV[:1], "b": UV[1:2], "out": OUT[:1]},
            stacked(lambda u, v: (1 - (0.25 + 0.75 * (1 - v)) * (1 - u),) * 3)),
    # half a crossing along u, a pixel is a sixteenth of the plate
    "WEAVE": ({"cloth": 0, "out": OUT}, stacked(lambda u, v: (0.5 * u, 0.5 * LINEN * v, 0.5 / 16))),
    "CLOTH": ({"cloth": 0, "place": PLACE, "out": OUT[:1]}, stacked(lambda u, v: (1.0, 1.0, 1.0))),
    "HUE": ({"what": "HSV_TO_RGB", "color": [0.25, *UV[:2]], "out": OUT[:3]},  # between yellow and green
            stacked(lambda u, v: (v * (1 - 0.5 * u), v, v * (1 - u)))),
    # nothing in a corner of the lattice, which is halfway
    "NOISE": ({"dimensions": 3, "what": "FBM", "even": True, "first": False, "at": [1.0, -2.0, 3.0, 0.0],
               "detail": [2.5], "roughness": [0.5], "lacunarity": [2.0], "offset": [0.0], "gain": [1.0],
               "out": OUT[:1]}, lambda u, v: np.full((*u.shape, 3), 0.5)),
    # not at random: the nearest corner of the lattice
    "VORONOI": ({"dimensions": 2, "feature": "F1", "metric": "EUCLIDEAN", "whole": True, "at": [*UV[:2], 0.0, 0.0],
                 "exponent": [1.0], "smoothness": [0.0], "randomness": [0.0], "out": registers(17, 8)},
                stacked(lambda u, v: (np.hypot(u - np.round(u), v - np.round(v)), np.round(u), np.round(v)))),
    # lookup3 of .37, and of it and 1 and 2, worked out apart
    "WHITE_NOISE": ({"dimensions": 1, "at": [0.37, 0.0, 0.0, 0.0], "out": OUT},
                    stacked(lambda u, v: (0.9755615, 0.5816281, 0.7770802))),
    "BRICK": ({"at": UV[:2], "width": [1.0], "height": [1.0], "mortar": [0.22], "smooth": [0.0], "bias": [-1.0],
               "shift": 0.5, "shift_each": 2, "squash": 1.0, "squash_each": 2, "out": OUT[:2]},
              stacked(lambda u, v: (0, np.minimum.reduce([(u + 0.5) % 1, 1 - (u + 0.5) % 1, v, 1 - v]) < 0.22, 0))),
    # between its x and its y side where neither is a third as large again, and from above
    "BOX": ({"normal": [*UV[:2], 0.0], "blend": 0.25, "out": OUT[:3]},
            stacked(lambda u, v: (np.clip((u / (u + v) - 0.375) * 4, 0, 1), np.clip((v / (u + v) - 0.375) * 4, 0, 1), 0))),
    # .2, .6, .4 over [.25, .75], and on as lines
    "CURVE": ({"table": np.array((0.2, 0.6, 0.4), np.float32), "low": 0.25, "high": 0.75, "at": UV[:1], "extend": True,
               "out": OUT[:1]}, stacked(lambda u, v: (np.where(u < 0.5, 1.6 * u - 0.2, 1 - 0.8 * u).clip(0, 1),) * 3)),
    "SCRATCHES": ({"what": "NORMAL", "field": 0, "at": UV[:2], "near": [(25,), UV[1], UV[0], (26,)], "step": 0.125,
                   "amount": [0.7], "normal": [float(t) for t in TILT], "out": OUT[:3]}, scratched_again),
    "OCCLUSION": ({"samples": 3, "distance": [9.0], "out": OUT[:1]}, lambda u, v: np.ones((*u.shape, 3))),  # it is alone
    "BEVEL": ({"samples": 3, "radius": [0.1], "out": OUT[:3]}, stacked(lambda u, v: (0, 0, 1))),  # it is flat
    "RELIEF": ({"out": OUT[:3]}, lambda u, v: np.zeros((*u.shape, 3))),  # no metal asks for it: test_native_shading.py
    "RAMP": ({"table": TABLE, "at": UV[:1], "smooth": True, "out": OUT}, ramp),
}
PLATE = square()
U, V = PLATE["corner_uvs"].reshape(-1, 2).T
# elsewhere and half as wide, which its instance makes good
AWRY = {"layers": [{"width": 2}],
        "meshes": [PLATE | {"positions": ((PLATE["positions"] + (0.5, 0, 0.5)) * (0.5, 1, 1)).astype(np.float32),
                            "layers": [{"layer": 0, "data": np.ascontiguousarray(
                                np.stack([0.5 * U + 0.25 * V, 0.75 - 0.5 * V], -1), np.float32)}]}],
        "instances": [{"mesh": 0, "matrix": [2, 0, 0, -0.5, 0, 1, 0, 0, 0, 0, 1, -0.5, 0, 0, 0, 1]}]}
NORMALS = ("NORMAL_MAP", "PERTURB", "BUMP", "BEND", "FRAME", "SCRATCHES")


def by_pixel(function):
    """One of a pixel's numbers, as one of arrays."""
    return lambda u, v: np.array([function(a, b) for a, b in zip(u.ravel(), v.ravel())]).reshape(*u.shape, 3)


def bricks(u, v):
    """Mortar of a wall whose every third row has wider bricks and whose every second one is moved."""
    wide, high, mortar = 0.27, 0.137, 0.031
    row = np.floor(v / high)
    wide = np.where(row % 3 == 0, 1.7 * wide, wide)
    x, y = (u + np.where(row % 2 == 0, 0.4 * wide, 0)) % wide, v % high
    return np.minimum.reduce([x, wide - x, y, high - y]) < mortar


def corners(metric):
    """How far the lattice's corners are, the nearest first."""
    return lambda u, v: np.sort([metric(np.abs(u - x), np.abs(v - y)) for x in range(-1, 3) for y in range(-1, 3)], 0)


# The same kinds again, set otherwise: what differs from above, and how many of the numbers count; the others repeat them.
AGAIN = [
    ("HUE", {"color": [1.0, *UV[:2]]}, 3, stacked(lambda u, v: (v, v * (1 - u), v * (1 - u)))),  # red, as of 0
    ("HUE", {"color": [UV[0], UV[1], 0.8]}, 3, by_pixel(lambda u, v: colorsys.hsv_to_rgb(u, v, 0.8))),
    ("HUE", {"what": "HSL_TO_RGB", "color": [UV[0], 0.6, UV[1]]}, 3, by_pixel(lambda u, v: colorsys.hls_to_rgb(u, v, 0.6))),
    *(("HUE", {"what": "RGB_TO_HSV", "color": color}, 3, by_pixel(lambda u, v, turned=turned: colorsys.rgb_to_hsv(*turned(u, v))))
      for color, turned in (([*UV[:2], 0.4], lambda u, v: (u, v, 0.4)), ([0.4, *UV[:2]], lambda u, v: (0.4, u, v)))),
    ("HUE", {"what": "RGB_TO_HSL", "color": [*UV[:2], 0.4]}, 3,
     by_pixel(lambda u, v: [colorsys.rgb_to_hls(u, v, 0.4)[k] for k in (0, 2, 1)])),
    ("BRICK", {"width": [0.27], "height": [0.137], "mortar": [0.031], "shift": 0.4, "squash": 1.7, "squash_each": 3}, 2,
     stacked(lambda u, v: (0, bricks(u, v), 0))),
    ("RAMP", {"smooth": False}, 3, lambda u, _v: TABLE[(u * 255).astype(int), :3]),
    # at another map's tangent and across it, also where that map is mirrored; flat where there is none
    *(("PERTURB", {"tangent": tangent}, 3, lambda u, v, to=to: np.broadcast_to(to, (*u.shape, 3)))
      for tangent, to in (([1.0, 0.0, 0.0, -1.0], TILT * (1, -1, 1)), ([0.0, 2.0, 0.0, 1.0], TILT[[1, 0, 2]] * (-1, 1, 1)),
                          ([0.0, 2.0, 0.0, -1.0], TILT[[1, 0, 2]]), ([0.0, 0.0, 0.0, 1.0], (0, 0, 1)))),
    ("TRANSFORM", {"unit": True}, 3, lambda u, v: unit(np.stack([0.75 - 0.5 * v, 0.25 * u + 0.125, 0.5 + 0 * u], -1))),
    ("CURVE", {"extend": False}, 1, stacked(lambda u, v: (np.interp(u, (0.25, 0.5, 0.75), (0.2, 0.6, 0.4)),) * 3)),
    *(("VORONOI", {"feature": feature, "metric": metric, "exponent": [0.5]}, 1,
       stacked(lambda u, v, far=far, k=k: (corners(far)(u, v)[k].clip(0, 1),) * 3))
      for k, feature in enumerate(("F1", "F2")) for metric, far in (
          ("EUCLIDEAN", np.hypot), ("MANHATTAN", np.add), ("CHEBYCHEV", np.maximum), ("MINKOWSKI", lambda x, y: (x**0.5 + y**0.5)**2))),
    ("VORONOI", {"feature": "N_SPHERE_RADIUS"}, 1, stacked(lambda u, v: (0.5,) * 3)),  # half as far as the next
    ("VORONOI", {"feature": "DISTANCE_TO_EDGE"}, 1,
     stacked(lambda u, v: (np.minimum(np.abs(u - 0.5), np.abs(v - 0.5)),) * 3)),  # halfway between corners
    *(("GEOMETRY", {"what": what}, 3, stacked(lambda u, v, value=value: value))
      for what, value in (("BACKFACING", (0, 0, 0)), ("INCOMING", (0, 0, 1)), ("REFLECTION", (0, 0, 1)), ("NORMAL", (0, 0, 1)),
                          ("TRUE_NORMAL", (0, 0, 1)), ("TANGENT", (1, 0, 0)))),
    ("GEOMETRY", {"what": "POSITION"}, 3, stacked(lambda u, v: ((2 * u - 1).clip(0), (2 * v - 1).clip(0), 0))),
    *(("PATH", {"what": what}, 1, stacked(lambda u, v, value=value: (value,) * 3))
      for what, value in (("FILM", 1), ("SHADOW", 0), ("DIFFUSE", 0), ("GLOSSY", 0), ("SINGULAR", 0), ("REFLECTION", 0),
                          ("TRANSMISSION", 0), ("DEPTH", 0), ("TRANSPARENT_DEPTH", 0)))]


@pytest.mark.parametrize("kind, changes, many, truth", [(kind, {}, 3, None) for kind in KINDS] + AGAIN)
def test_what_it_says_of_a_plate(kind, changes, many, truth, tmp_path):
    assert kind in NODES, f"{kind} is not tested: give it an entry in NODES"
    node, truth = {**NODES[kind][0], **changes}, truth or NODES[kind][1]
    said = (node["out"][:many] * 3)[:3] if "ALBEDO" not in kind else node["out"][:1] * 3
    said = sorted(said) if kind == "FIBRES" else said  # the albedo first: b is negative, and f0 is not
    error = 0.005 if "ALBEDO" in kind else 0.01 if kind == "FIBRES" else 4e-5  # a table; 16 bits a texel
    given = material() | {"nodes": [*SOURCES, {"type": kind, **node}],
                          ("normal" if kind in NORMALS else "f0_from"): said}
    fields = {"scratches": [SCRATCHED]} if "field" in node else {}  # dear to lay
    planes, _ = dump(scene(images=IMAGES, cloths=CLOTHS, **fields, attributes=1, materials=[given], **AWRY), tmp_path / "d.exr")
    channels = ("Ns", "XYZ") if kind in NORMALS else ("Color", "RGB")
    expected = truth(planes["uv.U"].astype(float), planes["uv.V"].astype(float))
    np.testing.assert_allclose(vectors(planes, *channels), expected, atol=error)


@pytest.mark.parametrize("parts", [(0, 1, 2), (3, 2, 1)])
def test_a_ramp_in_a_picture_of_nine(parts, tmp_path):
    """Which is no multiple of four: each of its four numbers is that of the table."""
    node = {"type": "RAMP", "table": TABLE, "at": UV[:1], "smooth": True, "out": OUT}
    given = material() | {"nodes": [SOURCES[0], node], "f0_from": [OUT[k] for k in parts]}
    planes, _ = dump(scene(materials=[given], width=3, height=3), tmp_path / "d.exr")
    at = np.array([1, 3, 5]) / 6 * 255
    expected = np.stack([np.interp(at, np.arange(256), TABLE[:, k]) for k in parts], -1)
    np.testing.assert_allclose(vectors(planes, "Color", "RGB"), np.broadcast_to(expected, (3, 3, 3)), atol=4e-5)


@pytest.mark.parametrize("what, expected", [("ALONG_U", (0.5, 0.25, 0)), ("ALONG_V", (0.125, 0.75, 0))])
def test_a_direction_along_a_map_that_nothing_else_asks_for(what, expected):
    u, v = np.array([(-2, -2), (2, -2), (2, 2), (-2, 2)], float).T
    plate = mesh(np.outer(u, (0.5, 0.25, 0)) + np.outer(v, (0.125, 0.75, 0)), [[0, 1, 2], [0, 2, 3]], uvs=np.stack([u, v], -1))
    shines = {"name": "along", "closure": "EMISSION", "weight": OUT[:3], "nodes": [{"type": "GEOMETRY", "what": what, "out": OUT[:3]}]}
    seen = render(scene(meshes=[plate], materials=[shines], camera=ortho(0.1), lights=[], samples=1, width=4, height=4))[0]
    np.testing.assert_allclose(seen[..., :3], np.broadcast_to(expected, (4, 4, 3)), atol=1e-6)


def drawn_out_albedo(ax, ay, eye=(0, 0, 1), count=400):
    """Of GGX, by a sum over half vectors; Smith's shadowing of both directions together."""
    eye, turn = np.array(eye)[:, None, None], 2 * np.pi * (np.arange(count) + 0.5) / count
    theta = 0.5 * np.pi * ((np.arange(count) + 0.5) / count)[:, None]
    h = np.stack(np.broadcast_arrays(np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn), np.cos(theta)))
    density = 1 / (np.pi * ax * ay * ((h[0] / ax)**2 + (h[1] / ay)**2 + h[2]**2)**2)
    along = (h * eye).sum(0)
    to = 2 * along * h - eye

    def hidden(d):
        return 0.5 * np.sqrt(1 + ((ax * d[0])**2 + (ay * d[1])**2) / d[2]**2) - 0.5
    lit = (along > 0) & (to[2] > 0)
    value = density * along / eye[2] / (1 + hidden(eye) + np.where(lit, hidden(to), 0)) * np.sin(theta)
    return np.where(lit, value, 0).sum() * 0.5 * np.pi * 2 * np.pi / count**2


@pytest.mark.parametrize("ax, ay", [(0.5, 0.5), (0.05, 1.0), (0.6, 0.15)])
@pytest.mark.parametrize("angle, turn", [(0, 0), (60, 0), (60, 90), (50, 30)])
def test_albedo_of_lobes_that_are_drawn_out(tmp_path, ax, ay, angle, turn):
    """Seen from straight above, along it, across it and askew."""
    eye = np.sin(np.radians(angle)) * np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn)), 0]) + [0, 0, np.cos(np.radians(angle))]
    node = {"type": "ALBEDO", "alpha": [ax], "across": [ay], "along": [1.0, 0.0], "out": OUT[:3]}
    planes, _ = dump(scene(materials=[material() | {"nodes": [node], "f0_from": OUT[:1] * 3}], camera=ortho(0.2, 3 * eye)), tmp_path / "d.exr")
    np.testing.assert_allclose(vectors(planes, "Color", "RGB")[..., 0], drawn_out_albedo(ax, ay, eye), rtol=0.01 if angle == 0 else 0.03)


# How the UVs of a plate fall together: to v = 0, to a slanted line, to a point.
FALLEN = {"flat": (1.0, 0.0), "slanted": (0.3, 0.7), "point": (0.0, 0.0)}


@pytest.mark.parametrize("case", FALLEN)
def test_heights_where_a_map_has_no_area(tmp_path, case):
    """A bump by u itself: along the line that is left, and nothing of a point."""
    fallen = PLATE | {"corner_uvs": np.ascontiguousarray(U[:, None] * FALLEN[case] + 0.2, np.float32).ravel()}
    at = registers(14, 12)
    steps = [{"type": "STEP", "axis": axis, "scale": 1.0, "otherwise": 0.25, "out": to} for axis, to in (("X", at[:2]), ("Y", at[2:4]))]
    heights = [{"type": "GEOMETRY", "what": "UV", **shift, "out": [to, *at[10:]]}
               for to, shift in zip(at[4:7], ({}, {"shift": at[:2]}, {"shift": at[2:4]}))]
    bump = {"type": "BUMP", "height": at[4:7], "along": at[:4], "strength": [1.0], "distance": [1.0], "normal": [0.0, 0.0, 1.0],
            "out": OUT[:3]}
    given = material() | {"nodes": [*steps, *heights, bump], "normal": OUT[:3]}
    planes, _ = dump(scene(materials=[given], meshes=[fallen]), tmp_path / "d.exr")
    width = np.ptp(PLATE["positions"].reshape(-1, 3)[:, 0]) / np.ptp(U)
    normal = unit(np.array((-FALLEN[case][0] / width, 0, 1)))
    np.testing.assert_allclose(vectors(planes, "Ns"), np.broadcast_to(normal, (*planes["uv.U"].shape, 3)), atol=1e-4)


# What Blender's nodes say where it is awkward: (operation, a, b, c) and the value, by Blender's manual and its formulas.
MATHS = [
    ("ADD", 1.5, -4, 0, -2.5), ("SUBTRACT", -1, 2, 0, -3), ("MULTIPLY", -2, 3, 0, -6), ("MULTIPLY_ADD", -2, 3, 10, 4),
    ("DIVIDE", 1, 0, 0, 0), ("DIVIDE", -1, -4, 0, 0.25), ("DIVIDE", 0, 0, 0, 0),
    ("POWER", -2, 3, 0, -8), ("POWER", -2, 2, 0, 4), ("POWER", -2, -3, 0, -0.125), ("POWER", -2, 0.5, 0, 0), ("POWER", 0, 0, 0, 1),
    ("POWER", -1, 5, 0, -1), ("POWER", -3, 1, 0, -3), ("POWER", 0, 2, 0, 0), ("POWER", 4, -0.5, 0, 0.5), ("POWER", -2, 0, 0, 1),
    ("LOGARITHM", 8, 2, 0, 3), ("LOGARITHM", -8, 2, 0, 0), ("LOGARITHM", 8, -2, 0, 0), ("LOGARITHM", 8, 1, 0, 0),
    ("LOGARITHM", 0.25, 2, 0, -2), ("LOGARITHM", 0, 2, 0, 0), ("SQRT", -4, 0, 0, 0), ("SQRT", 9, 0, 0, 3), ("SQRT", 0, 0, 0, 0),
    ("INVERSE_SQRT", 4, 0, 0, 0.5), ("INVERSE_SQRT", 0, 0, 0, 0), ("INVERSE_SQRT", -4, 0, 0, 0), ("ABSOLUTE", -3, 0, 0, 3),
    ("EXPONENT", 1, 0, 0, 2.7182818), ("EXPONENT", -1, 0, 0, 0.36787944), ("EXPONENT", -90, 0, 0, 0),
    ("MINIMUM", -1, 2, 0, -1), ("MINIMUM", 3, 2, 0, 2), ("MAXIMUM", -1, 2, 0, 2), ("MAXIMUM", 3, 2, 0, 3),
    ("LESS_THAN", 1, 1, 0, 0), ("LESS_THAN", -2, 1, 0, 1), ("GREATER_THAN", 1, 1, 0, 0), ("GREATER_THAN", 2, 1, 0, 1),
    ("SIGN", -2, 0, 0, -1), ("SIGN", 0, 0, 0, 0), ("SIGN", 5, 0, 0, 1),
    ("COMPARE", 1, 2, 0.5, 0), ("COMPARE", 1, 2, 1, 1), ("COMPARE", 1, 1, 0, 1), ("COMPARE", 2, 1, 1.5, 1), ("COMPARE", 1, 1, -1, 1),
    ("SMOOTH_MIN", 1, 2, 0, 1), ("SMOOTH_MIN", 1, 1, 3, 0.5), ("SMOOTH_MIN", 5, 2, 1, 2), ("SMOOTH_MAX", 1, 1, 3, 1.5),
    ("SMOOTH_MAX", 1, 2, 0, 2), ("SMOOTH_MAX", -5, 2, 1, 2),
    ("ROUND", -1.6, 0, 0, -2), ("ROUND", 1.5, 0, 0, 2), ("ROUND", -0.4, 0, 0, 0), ("FLOOR", -1.2, 0, 0, -2), ("FLOOR", 1.8, 0, 0, 1),
    ("CEIL", -1.2, 0, 0, -1), ("CEIL", 1.2, 0, 0, 2), ("TRUNC", -1.7, 0, 0, -1), ("TRUNC", 1.7, 0, 0, 1), ("TRUNC", -0.5, 0, 0, 0),
    ("FRACT", -1.25, 0, 0, 0.75), ("FRACT", 1.25, 0, 0, 0.25),
    ("MODULO", -5.5, 3, 0, -2.5), ("MODULO", 5.5, -3, 0, 2.5), ("MODULO", 5.5, 0, 0, 0), ("MODULO", -5.5, -3, 0, -2.5),
    ("FLOORED_MODULO", -5.5, 3, 0, 0.5), ("FLOORED_MODULO", 5.5, -3, 0, -0.5), ("FLOORED_MODULO", 5.5, 0, 0, 0),
    ("WRAP", 5.5, 3, 1, 1.5), ("WRAP", -0.5, 3, 1, 1.5), ("WRAP", 5, 2, 2, 2), ("SNAP", -2.3, 0.5, 0, -2.5), ("SNAP", 2.3, 0, 0, 0),
    ("SNAP", 2.3, 0.5, 0, 2), ("PINGPONG", 2.5, 1, 0, 0.5), ("PINGPONG", -0.25, 1, 0, 0.25), ("PINGPONG", 2, 0, 0, 0),
    ("PINGPONG", 1.25, 1, 0, 0.75), ("SINE", -1.5707963, 0, 0, -1), ("SINE", 100, 0, 0, -0.5063656), ("COSINE", 3.1415927, 0, 0, -1),
    ("COSINE", -1, 0, 0, 0.5403023), ("TANGENT", -0.7853982, 0, 0, -1), ("TANGENT", 2.3561945, 0, 0, -1),
    ("ARCSINE", 2, 0, 0, 1.5707963), ("ARCSINE", -2, 0, 0, -1.5707963), ("ARCSINE", -0.5, 0, 0, -0.5235988),
    ("ARCCOSINE", 2, 0, 0, 0), ("ARCCOSINE", -2, 0, 0, 3.1415927), ("ARCCOSINE", -0.5, 0, 0, 2.0943951), ("ARCCOSINE", 1, 0, 0, 0),
    ("ARCTANGENT", -1, 0, 0, -0.7853982), ("ARCTANGENT", 1e6, 0, 0, 1.5707953), ("ARCTAN2", 1, -1, 0, 2.3561945),
    ("ARCTAN2", -1, -1, 0, -2.3561945), ("ARCTAN2", 0, 0, 0, 0), ("ARCTAN2", -2, 0, 0, -1.5707963),
    ("SINH", -1, 0, 0, -1.1752012), ("COSH", -1, 0, 0, 1.5430806), ("TANH", -1, 0, 0, -0.7615942), ("TANH", 50, 0, 0, 1),
    ("TANH", -50, 0, 0, -1), ("RADIANS", -180, 0, 0, -3.1415927), ("DEGREES", -3.1415927, 0, 0, -180),
    ("MIX", -1, 3, 2, 7), ("MIX", -1, 3, -0.5, -3), ("CLAMP", 5, -1, 2, 2), ("CLAMP", -5, -1, 2, -1), ("CLAMP", 0.5, -1, 2, 0.5)]
# (mode, factor, a, b) and the value
MIXES = [
    ("MIX", 0.25, 4, -4, 2), ("DARKEN", 0.5, 1, -1, 0), ("DARKEN", 0.5, -1, 1, -1), ("LIGHTEN", 0.5, -1, 1, 0), ("LIGHTEN", 0.5, 2, 1, 2),
    ("MULTIPLY", 0.5, 2, 3, 4), ("MULTIPLY", 1, -2, 3, -6), ("BURN", 1, 0.5, 0, 0), ("BURN", 1, 3, 0.5, 1), ("BURN", 1, 0.75, 0.5, 0.5),
    ("BURN", 1, 0.25, 0.5, 0), ("BURN", 0, 0.25, 0.5, 0.25), ("SCREEN", 1, 0.5, 0.5, 0.75), ("SCREEN", 0.5, 0.5, 0.5, 0.625),
    ("SCREEN", 1, 2, 3, -1), ("DODGE", 1, 0.25, 0.5, 0.5), ("DODGE", 1, 0.75, 0.5, 1), ("DODGE", 1, 3, 0.5, 1), ("DODGE", 1, 0, 2, 0),
    ("DODGE", 1, 0.5, 1, 1), ("DODGE", 1, 0.25, 2, 1), ("DODGE", 0.5, 0.25, 1, 0.5), ("ADD", 0.5, 1, -4, -1), ("SUBTRACT", 0.5, 1, 4, -1),
    ("OVERLAY", 1, 0.25, 0.5, 0.25), ("OVERLAY", 1, 0.75, 0.25, 0.625), ("OVERLAY", 0, 0.75, 0.25, 0.75), ("OVERLAY", 1, 0.5, 0.25, 0.25),
    ("SOFT_LIGHT", 1, 0.5, 0.5, 0.5), ("SOFT_LIGHT", 0.5, 0.25, 0.75, 0.296875), ("LINEAR_LIGHT", 1, 0.5, 0.25, 0),
    ("LINEAR_LIGHT", 0.5, -1, 2, 0.5), ("DIFFERENCE", 1, 1, 3, 2), ("DIFFERENCE", 0.5, 3, 1, 2.5), ("EXCLUSION", 1, 0.5, 0.25, 0.5),
    ("EXCLUSION", 1, 2, 2, 0), ("EXCLUSION", 0.5, 1, 0, 1), ("DIVIDE", 1, 3, 0, 3), ("DIVIDE", 0.5, 2, -4, 0.75)]


# (what, color) and what comes out of it, of colours beyond 1 and hues that are none
HUES = [("RGB_TO_HSL", (2, 0.5, 1), (17 / 18, -3, 1)), ("RGB_TO_HSV", (2, 0.5, 1), (17 / 18, 0.75, 2)), ("RGB_TO_HSV", (0, 0, 0), (0, 0, 0)),
        ("RGB_TO_HSL", (0.5, 0.5, 0.5), (0, 0, 0.5)), ("HSV_TO_RGB", (1.25, 0.5, 1), (1, 0.5, 0.75)), ("HSV_TO_RGB", (-0.5, 0.5, 2), (2, 1, 2)),
        ("HSV_TO_RGB", (1, 0.5, 1), (1, 0.5, 0.5))]


def test_awkward_numbers_of_math_and_mix():
    """A quad of its own for each, which shines by the value and 200."""
    nodes = [({"type": "MATH", "operation": word, "a": [float(a)], "b": [float(b)], "c": [float(c)]}, 0, want, (word, a, b, c))
             for word, a, b, c, want in MATHS]
    nodes += [({"type": "MIX", "mode": word, "factor": [float(t)], "a": [float(a)], "b": [float(b)]}, 0, want, (word, t, a, b))
              for word, t, a, b, want in MIXES]
    nodes += [({"type": "HUE", "what": word, "color": [float(c) for c in color]}, k, want, (word, color, k))
              for word, color, three in HUES for k, want in enumerate(three)]
    materials = [{"name": str(number), "closure": "EMISSION", "weight": OUT[3:4] * 3, "nodes": [
        {**node, "out": OUT[:3 if node["type"] == "HUE" else 1]},
        {"type": "MATH", "operation": "ADD", "a": OUT[k:k + 1], "b": [200.0], "c": [0.0], "out": OUT[3:4]}]}
                 for number, (node, k, _want, _what) in enumerate(nodes)]
    count = len(nodes)
    corners = np.array([(-1 / count, -2, 0), (1 / count, -2, 0), (1 / count, 2, 0), (-1 / count, 2, 0)])
    plates = mesh(np.concatenate([corners + ((2 * k + 1) / count - 1, 0, 0) for k in range(count)]),
                  [t for k in range(0, 4 * count, 4) for t in ([k, k + 1, k + 2], [k, k + 2, k + 3])],
                  materials=np.repeat(np.arange(count), 2))
    made = scene(meshes=[plates], materials=materials, lights=[], samples=1, width=count, height=1)
    said = render(made)[0][0, :, 0].astype(float) - 200
    wrong = [(what, want, value) for (_node, _k, want, what), value in zip(nodes, said) if not abs(value - want) < 6e-5 + 2e-5 * abs(want)]
    assert not wrong


def test_a_dump_says_how_strokes_turn(tmp_path):
    """From the tangent towards the bitangent, as a node says it."""
    turned = [{"type": "MATH", "operation": "SUBTRACT", "a": [part], "b": [0.5], "c": [0.0], "out": [out]}
              for part, out in zip(UV[:2], OUT[:2])]
    given = material() | {"nodes": [SOURCES[0], *turned], "groove_from": OUT[:2]}
    planes, _ = dump(scene(materials=[given]), tmp_path / "d.exr")
    angle = np.arctan2(planes["uv.V"].astype(float) - 0.5, planes["uv.U"].astype(float) - 0.5)
    np.testing.assert_allclose(planes["groove.A"], angle, atol=1e-5)


def test_heights_and_mask_of_scratches(tmp_path):
    """.7 of the depth, here a hundred times as high and the other way up."""
    nodes = [*SOURCES, {"type": "SCRATCHES", "what": "HEIGHT", "field": 0, "at": UV[:2], "amount": [0.7], "out": OUT[:2]},
             {"type": "MATH", "operation": "MULTIPLY", "a": OUT[:1], "b": [-100.0], "c": [0.0], "out": OUT[:1]}]
    planes, _ = dump(scene(images=IMAGES, cloths=CLOTHS, scratches=[SCRATCHED], **AWRY,
                           materials=[material() | {"nodes": nodes, "f0_from": [*OUT[:2], 0.5]}]), tmp_path / "d.exr")
    height = scratched(planes["uv.U"].astype(float), planes["uv.V"].astype(float))[0]
    assert 0.2 < (height < 0).mean() < 0.9
    np.testing.assert_allclose(planes["Color.R"], np.clip(-70 * height, 0, 1), atol=2e-4)
    np.testing.assert_allclose(planes["Color.G"], 0.7 * (height < 0), atol=1e-6)


@pytest.mark.parametrize("given, open_", [
    ({}, 0.36), ({"distance": [0.6]}, (0.5 / 0.6)**2), ({"distance": [0.4]}, 1), ({"distance": [0.0]}, 1),
    ({"normal": [(9,), (10,), (11,)]}, 0.5 - 0.5 * 0.28), ({"inside": True}, 0.2**2 / 0.25**2), ({"local": True}, 1),
    ({"local": True, "own": True}, 0.36)])
def test_what_stands_about_a_point(given, open_):
    """Of a sheet half a unit above, or one below, as of form factors: within the distance r a sheet at h stops all
    within the cosine h/r."""
    given = {"distance": [0.5 / 0.6], "samples": 16} | given
    own = given.pop("own", False)
    if "normal" in given:  # 73.7 degrees aside: the sheet stops (1 + cos) / 2
        given |= {"distance": [1e4]}
    if "inside" in given:
        given |= {"distance": [0.25]}
    tilt = [0.96, 0.0, 0.28]
    nodes = [{"type": "MATH", "operation": "ADD", "a": [part], "b": [0.0], "c": [0.0], "out": [out]}
             for part, out in zip(tilt, registers(9, 3))]
    nodes.append({"type": "OCCLUSION", "out": registers(12, 1), **given})
    shines = {"name": "open", "closure": "EMISSION", "weight": registers(12, 1) * 3, "nodes": nodes}
    parts = [square(0.2), square(2e3, 0.5), *([square(20.0, -0.2)] if "inside" in given else [])]
    if own:  # the first two are one object
        parts = [mesh(np.concatenate([part["positions"] for part in parts[:2]]),
                      np.concatenate([parts[0]["corner_position"], parts[1]["corner_position"] + 4]))]
    made = scene(meshes=parts, materials=[shines], camera=ortho(0.1, (0, 0, 0.4)), lights=[], samples=64, width=8, height=8)
    assert render(made)[0][..., :3].mean() == pytest.approx(open_, abs=0.006)


def test_a_ray_about_a_point_goes_anywhere():
    """One of each point: height and turn have nothing to do with one another. Of a small sheet, a corner of it above the
    point, as of form factors."""
    nodes = [{"type": "OCCLUSION", "out": registers(12, 1), "distance": [9.0], "samples": 1}]
    shines = {"name": "open", "closure": "EMISSION", "weight": registers(12, 1) * 3, "nodes": nodes}
    sheet = mesh([[0, 0, 0.5], [0.25, 0, 0.5], [0.25, 0.25, 0.5], [0, 0.25, 0.5]], [[0, 1, 2], [0, 2, 3]])
    made = scene(meshes=[square(0.2), sheet], materials=[shines], camera=ortho(1e-3, (0, 0, 0.4)), lights=[], samples=256,
                 width=8, height=8)
    side = 0.5 / np.sqrt(1 + 0.5**2)
    assert render(made)[0][..., :3].mean() == pytest.approx(1 - side * np.arctan(side) / np.pi, abs=0.01)


def test_each_point_looks_as_far_as_it_says():
    """Past another object's sheet, which some rays miss: half of the points do not look as far as their own one."""
    half = {"type": "MATH", "operation": "GREATER_THAN", "a": UV[:1], "b": [0.5], "c": [0.0], "out": OUT[:1]}
    reach = {"type": "MATH", "operation": "MULTIPLY_ADD", "a": OUT[:1], "b": [0.2], "c": [0.4], "out": OUT[1:2]}
    look = {"type": "OCCLUSION", "out": registers(12, 1), "distance": OUT[1:2], "local": True, "samples": 16}
    shines = {"name": "open", "closure": "EMISSION", "weight": registers(12, 1) * 3, "nodes": [SOURCES[0], half, reach, look]}
    low, high = square(0.2), square(2e3, 0.5)
    own = mesh(np.concatenate([low["positions"], high["positions"]]),
               np.concatenate([low["corner_position"], high["corner_position"] + 4]),
               uvs=[(0, 0), (1, 0), (1, 1), (0, 1)] * 2)
    made = scene(meshes=[own, square(2e3, 0.3)], materials=[shines], camera=ortho(0.1, (0, 0, 0.2)), lights=[], samples=64,
                 width=16, height=16)
    seen = render(made)[0][..., 0]
    assert seen[:, :8].mean() == 1 and seen[:, 8:].mean() == pytest.approx((0.5 / 0.6) ** 2, abs=0.006)


@pytest.mark.parametrize("away, turned, order", [*((away, turned, 1) for away in (0.0, 0.1, 0.25, 0.6) for turned in (0.0, 90.0, 35.0)),
                                                 (0.1, 0.0, -1)])
def test_edges_are_round(away, turned, order):
    """So far from a square edge: the mean of the normals within half a unit, weighted by (1 - r/R)^3, by quadrature. What is turned is
    one of two bodies of a mesh, in the space of which rays meet it. Also where faces are wound the other way."""
    c, s = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    about = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    y, z = np.meshgrid(np.linspace(-0.5, 0.5, 401), np.linspace(-0.5, 0.5, 401))
    weight = lambda r: np.clip(1 - r / 0.5, 0, 1) ** 3
    own = (weight(np.hypot(y, z)) * (z < away)).sum()
    other = (weight(np.sqrt(y**2 + z**2 + away**2)) * (z < 0)).sum()
    expected = about @ unit(np.array([other, 0, own]))
    edge = mesh(np.array([(-2, -2, 0), (0, -2, 0), (0, 2, 0), (-2, 2, 0), (0, -2, -2), (0, 2, -2)]),
                np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])[:, ::order])
    bent = {"type": "BEVEL", "samples": 128, "radius": [0.5], "out": registers(3, 3)}
    shines = {"name": "round", "closure": "EMISSION", "weight": registers(3, 3), "nodes": [bent]}
    x, y, _ = about @ (-away - 1e-3, 0, 0)
    there, far = np.eye(4), np.eye(4)
    there[:3, :3], far[0, 3] = about, 50
    bodies = {"apart": 1, "instances": [{"mesh": 0, "matrix": matrix.ravel().tolist()} for matrix in (there, far)]} if turned else {}
    found = render(scene(**bodies, meshes=[edge], materials=[shines], camera=ortho(1e-4, (x, y, 3), (x, y, 0)), lights=[],
                         samples=32, width=8, height=8))[0][..., :3].mean((0, 1))
    np.testing.assert_allclose(unit(found.astype(float)), expected, atol=0.02)


@pytest.mark.parametrize("kind, given", [("PERTURB", {"color": [0.9, 0.5, 0.2], "strength": [1.0]}),
                                         ("FRAME", {"vector": [0.8, 0.0, -0.6], "to": "SHADING"}),
                                         ("BUMP", {"height": [0.0, 0.0, 0.0], "along": [0.25, 0, 0, 0.25], "strength": [1.0],
                                                   "distance": [1.0], "normal": [0.8, 0.0, -0.6]})])
def test_normals_below_the_surface_are_bent_up(kind, given, tmp_path):
    """Where it is asked for they stay there, else they end at the horizon: both bend to the same."""
    for below in (True, False):
        nodes = [{"type": kind, "below": below, "out": OUT[:3], **given},
                 {"type": "BEND", "normal": OUT[:3], "out": UV}]
        made = scene(images=IMAGES, cloths=CLOTHS, materials=[material() | {"nodes": nodes, "normal": UV}], **AWRY)
        planes, _ = dump(made, tmp_path / "d.exr")
        np.testing.assert_allclose(vectors(planes, "Ns", "XYZ").mean((0, 1)), (0.495**0.5, 0, 0.505**0.5), atol=2e-4)


@pytest.mark.parametrize("uvs", [[(0, 0), (0.5, 0.2), (0.9, 1.1), (0.4, 0.9)],
                                 [(0, 0), (-1, 0), (-1, 2), (0, 2)], [(0.3, 0.3)] * 4])
def test_bumps_of_a_slope_are_the_same_by_any_uv_map(uvs, tmp_path):
    """Sheared, mirrored, or none: height 0.5 x - 0.25 y has the same normal."""
    position, du, dv, h = registers(3, 3), registers(6, 3), registers(9, 3), registers(12, 6)

    def slope(a, b, c, first, out):
        return [{"type": "MATH", "operation": "MULTIPLY_ADD", "a": [a], "b": [0.5 * c], "c": [first],
                 "out": [out]},
                {"type": "MATH", "operation": "MULTIPLY_ADD", "a": [b], "b": [-0.25 * c], "c": [out],
                 "out": [out]}]

    nodes = [{"type": "GEOMETRY", "what": what, "out": out}
             for what, out in (("POSITION", position), ("ALONG_U", du), ("ALONG_V", dv))]
    nodes += slope(*position[:2], 1, 0.0, h[0]) + slope(*du[:2], 0.125, h[0], h[1])
    nodes += slope(*dv[:2], 0.125, h[0], h[2])
    nodes += [{"type": "BUMP", "height": h[:3], "along": [0.125, 0, 0, 0.125], "strength": [1.0], "distance": [1.0],
               "normal": [0.0, 0.0, 1.0], "out": h[3:]}]
    corners = 0.5 * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    plate = mesh(corners, [[0, 1, 2], [0, 2, 3]], uvs=np.float32(uvs))
    planes, _ = dump(scene(materials=[material() | {"nodes": nodes, "normal": h[3:]}],
                           meshes=[plate]), tmp_path / "d.exr")
    seen = planes["material.ID"] == 0
    expected = np.broadcast_to(unit(np.array((-0.5, 0.25, 1))), (seen.sum(), 3))
    assert seen.any()
    np.testing.assert_allclose(vectors(planes, "Ns", "XYZ")[seen], expected, atol=1e-5)


@pytest.mark.parametrize("strength", [-1.0, 0.0, 0.25, 1.0, 2.5])
def test_bumps_may_be_stronger_than_they_are(strength, tmp_path):
    """As in Cycles: beyond 1 the normal leans on, below 0 it stays."""
    node = {"type": "BUMP", "height": [0.0, 0.6 * 0.25, -0.4 * 0.25], "along": [0.25, 0, 0, 0.25], "strength": [strength],
            "distance": [2.0], "normal": [0.0, 0.0, 1.0], "out": OUT[:3]}
    planes, _ = dump(scene(materials=[material() | {"nodes": [node], "normal": OUT[:3]}], **AWRY), tmp_path / "d.exr")
    bent, up = unit(np.array((-0.6, 0.4, 1))), np.array((0.0, 0.0, 1.0))
    expected = unit(up + max(strength, 0.0) * (bent - up))
    np.testing.assert_allclose(vectors(planes, "Ns", "XYZ").mean((0, 1)), expected, atol=1e-5)


def varied(**changes):
    """A metal whose colours and roughness are textures."""
    nodes = [*SOURCES, {"type": "MATH", "operation": "MULTIPLY_ADD", "a": UV[:1], "b": [0.4],
                        "c": [0.1], "out": OUT[:1]}]
    return material(kd=(0.1, 0.1, 0.1), mdf="GGX", brdf="MICROFACET") | {
        "nodes": nodes, "f0_from": COLOR, "kd_from": [(3,), 0.1, 0.1], "ax_from": OUT[:1],
        "ay_from": [(4,)]} | changes


def test_the_reference_agrees_where_everything_varies(tmp_path):
    """Reflectance, matt colour and both alphas from nodes: `shade check` reads them in the dump."""
    given = scene(images=IMAGES, cloths=CLOTHS, materials=[varied(), material()], camera=persp(),
                  lights=[sun((0.3, 0.2, 0.9))], meshes=[square(), square(0.5, 0.2, 1)])
    planes, _ = dump(given, tmp_path / "d.exr")
    own = planes["material.ID"] == 0
    np.testing.assert_allclose(planes["alpha.X"][own], 0.1 + 0.4 * planes["uv.U"][own], atol=1e-6)
    np.testing.assert_allclose(planes["kd.R"][own], planes["uv.U"][own], atol=1e-6)
    assert (planes["kd.R"][~own] == 0).all() and own.any() and not own.all()
    done = subprocess.run([ROOT / "build/shade", "check", tmp_path / "d.exr"], capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("change, message", [
    ({"f0_from": registers(40, 3)}, r"f0_from: no node before has written register 40"),
    ({"f0_from": registers(254, 3)}, r"f0_from must be 3 operands: finite numbers, or registers"),
    ({"f0_from": [0.5, 0.5]}, r"f0_from must be 3 operands"),
    ({"f0_from": [0.5] * 4}, r"f0_from must be 3 operands"),
    ({"normal": registers(3, 4)}, r"normal must be 3 operands"),
    ({"normal": [(3,), (4,), 1.0]}, r"normal must be three registers"),
    ({"nodes": [{"type": "GEOMETRY", "what": "UV", "out": registers(2, 3)}]},
     r"nodes\[0\]: out must be registers from 3 on"),
    ({"nodes": [{"type": "GEOMETRY", "what": "SHADOW", "out": UV}]}, r"what must be one of UV, POS"),
    ({"nodes": [{"type": "RAMP", "table": TABLE[:9], "at": [0.5], "smooth": True, "out": OUT}]},
     r"table has 36 items; 1024 are expected"),
])
def test_a_graph_that_cannot_be_right_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        native.start(scene(images=IMAGES, cloths=CLOTHS, materials=[varied(**change)]))


def test_blender_asks_for_what_the_module_knows():
    tree = ast.parse("")
    for file in (ROOT / "blender_addon_c/export").glob("*.py"):
        tree.body += ast.parse(file.read_text()).body
    asked = {node.args[0].value for node in ast.walk(tree)
             if isinstance(node, ast.Call) and "emit" in (getattr(node.func, "attr", ""), getattr(node.func, "id", ""))
             and isinstance(node.args[0], ast.Constant)}  # an emit that hands another's kind on names none
    assert asked == set(KINDS)
