# SPDX-License-Identifier: Apache-2.0
"""Figures of the papers on cloth and on diffuse fibres, made by us, and the fibres' truth.

[KangFabric] is "Fabric Rendering with Deformed Anisotropic Reflectance", [Hast2004] "Improved Diffuse
Anisotropic Shading" (REFERENCES.bib).
"""
import numpy as np

import gallery_metal
import programs
import sheet

import shade  # noqa: E402  (programs has said where it is)

assert programs  # imported for its paths


def direction(elevation, azimuth):
    e, a = np.radians(elevation), np.radians(azimuth)
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


# ---- cloth ---------------------------------------------------------------------------------------

YARN = {"width": 9.0, "gap": 1.0, "curve": 0.0, "ridge": 0.0, "slant": 0.0, "segments": 1.0, "along": 200.0,
        "across": 10.0, "f0": (0.4, 0.36, 0.3), "kd": (0.12, 0.1, 0.08)}


def cloth(pattern=(2, 1, 1), occlusion="none", detail="rotate", **yarn):
    both = {**YARN, **yarn}
    return shade.fabric(pattern=pattern, warp=both, weft=both, occlusion=occlusion, detail=detail,
                        horizon="hard", backing=(0.01, 0.01, 0.01))


def flat(fabric, size, crossings=9.0, light=(55, 120), tier="auto"):
    """A square patch from straight above."""
    extent = crossings / size
    side = (np.arange(size) + 0.5) * extent
    u, v = np.meshgrid(side, side[::-1])
    return colour(fabric.eval(np.stack([u, v], -1), direction(*light), np.array([0, 0, 1.0]),
                              footprint=extent, tier=tier))


def hung(fabric, size, crossings=60.0, light=(45, 150)):
    """Round a cylinder with a level axis, so that the warp runs round it."""
    side = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(side, -side)
    turn = np.arcsin(0.98 * y)
    c, s = np.cos(turn), np.sin(turn)

    def local(w):
        return np.stack([np.full_like(c, w[0]), c * w[1] - s * w[2], s * w[1] + c * w[2]], -1)

    half, step = crossings / 2, crossings / size
    wi, wo = local(direction(*light)), local(np.array([0, 0, 1.0]))
    seen = fabric.eval(np.stack([half * x, half * turn], -1), wi, wo,
                       footprint=np.stack([np.full_like(c, step), step / c], -1))
    return colour(np.where((wi[..., 2:] > 0) & (wo[..., 2:] > 0), seen, 0.0))


def colour(seen):
    return sheet.grey(seen, 0.22)


def alternating(folder, size):
    """KangFabric Fig. 2 and KangCho Fig. 10 (a)."""
    up = gallery_metal.normal_of(0, 0)
    metal = [gallery_metal.lobe("ashikhmin_shirley", *pair, "none") for pair in ((200, 10), (10, 200))]
    one = shade.fabric(pattern=(1, 1, 1), warp=YARN, weft={**YARN, "along": 10.0, "across": 200.0},
                       horizon="hard", occlusion="none")
    return [("weft's lobe", gallery_metal.disc(metal[0], up, size)),
            ("warp's lobe", gallery_metal.disc(metal[1], up, size)),
            ("one direction", hung(one, size, 8.0)), ("alternating", hung(cloth(), size, 8.0)),
            ("alternating, near", flat(cloth(), size))]


def elements(folder, size):
    """KangFabric Fig. 3: what lies on top in a 2/1 twill, by the formula as printed and mended."""
    crossings, n_w, n_p, n_s = 9.0, 2, 1, 1
    side = (np.arange(size) + 0.5) / size * crossings
    u, v = np.meshgrid(side, side[::-1])
    iu, iv = np.floor(u).astype(int), np.floor(v).astype(int)
    printed = (iu % n_w + n_s * (iv % n_p)) % (n_w + n_p)
    mended = (iu + n_s * iv) % (n_w + n_p)
    top = cloth().look_up(np.stack([u, v], -1))["top"]
    shown = {"as printed: all weft": printed >= n_w, "mended": mended >= n_w}
    grid = (np.abs(u - np.round(u)) > 0.03) & (np.abs(v - np.round(v)) > 0.03)
    return [*((word, np.where(grid, np.where(warp, 90, 215), 20).astype(np.uint8),
               "{} weft", 1 - warp.mean()) for word, warp in shown.items()),
            ("libshade, with gaps", np.choose(top, (215, 90, 20)).astype(np.uint8),
             "{} of yarn is weft", (top == 0).sum() / (top < 2).sum())]


def yarn_lobes(folder, size):
    """KangFabric Fig. 4 and 6: a lobe moved by a yarn's tilt, and darkened by 1 - |tilt|."""
    metal, made = gallery_metal.lobe("ashikhmin_shirley", 10, 200, "rotate"), []
    for words, dim in (("", False), ("darkened, ", True)):
        for tilt in (0.0, 0.3, 0.6):
            pixels = gallery_metal.disc(metal, gallery_metal.normal_of(tilt, 0), size)
            if dim:  # of light, in the picture's own scale
                lobe = pixels[..., 0] != 213
                pixels[..., :3] = np.where(lobe[..., None], pixels[..., :3] * (1 - tilt) ** (1 / 1.6),
                                           pixels[..., :3]).astype(np.uint8)
            made.append((f"{words}tilt {tilt:g}", pixels))
    return made


NEAR = {"filament": {"curve": 0.6}, "twisted": {"curve": 0.6, "ridge": 0.35, "slant": 0.25, "segments": 2.0},
        "darkened": {"curve": 0.6, "ridge": 0.35, "slant": 0.25, "segments": 2.0, "occlusion": "tilt"},
        "with noise": {"curve": 0.6, "ridge": 0.35, "slant": 0.25, "segments": 2.0, "occlusion": "tilt",
                       "vary_brightness": 0.5, "vary_tilt": 0.3, "along_brightness": 0.3}}


def yarns(folder, size):
    """KangFabric Fig. 7."""
    return [(word, flat(cloth(**values), size, 6.0)) for word, values in NEAR.items()]


def lights(folder, size):
    """KangFabric Fig. 8."""
    return [(f"light at {azimuth}°", hung(cloth(**NEAR["with noise"]), size, 14.0, (40, azimuth)))
            for azimuth in (180, 140, 90, 60, 20, 300)]


def distances(folder, size):
    """KangFabric Fig. 1 and 9: the far mixture takes over between .75 and 2 crossings a pixel."""
    made = []
    for extent in (0.06, 0.2, 0.6, 1.2, 2.4, 6.0):
        made.append((f"{extent:g} crossings a pixel", hung(cloth(**NEAR["darkened"]), size, extent * size)))
    return made


def weaves(folder, size):
    """KangFabric Fig. 10; a satin of five ends stands for n_w = infinity beside it."""
    return [tile for word, pattern in (("satin", (4, 1, 2)), ("twill", (2, 1, 1)))
            for tile in ((f"{word}, hung", hung(cloth(pattern, **NEAR["darkened"]), size, 16.0)),
                         (f"{word}, near", flat(cloth(pattern, **NEAR["darkened"]), size)))]


def three_cloths(folder, size):
    """KangCho Fig. 10: alternating lobes, normal mapping, rotation."""
    near = NEAR["darkened"]
    return [("alternating alone", flat(cloth(), size)),
            ("normal map", flat(cloth(detail="perturb", **near), size)),
            ("rotation", flat(cloth(detail="rotate", **near), size))]


# ---- diffuse fibres --------------------------------------------------------------------------------

DIFFUSE = ("lambert", "max_normal", "fibre", "fibre_view")
PRINTED, SCALED = "fibre_printed", "max_normal_scaled"


def phi(model, light, eye):
    """Phi in the fibre's frame, x along it: 1 is Lambert's of light from above."""
    light = np.asarray(light, float)
    if model == PRINTED:
        return printed(light)
    if model == SCALED:
        return phi("max_normal", light, eye) * 2 / np.pi
    matt = shade.Material(diffuse=model, kd=1.0, f0=0.0, fresnel="none", horizon="hard")
    f, cosine = shade.eval(matt, np.array([0, 0, 1.0]), light, eye, parts="diffuse")
    return np.pi * f[..., 0] * cosine


def printed(light):
    """Eq. 10 as it stands: n_min turns round with the sign of l.t."""
    t, b = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
    flat_part = light - light[..., :1] * t
    n_max = flat_part / np.maximum(np.linalg.norm(flat_part, axis=-1, keepdims=True), 1e-12)
    n_min = np.cross(light, n_max)
    n_min /= np.maximum(np.linalg.norm(n_min, axis=-1, keepdims=True), 1e-12)
    value = (light * n_max).sum(-1) * (1 - n_min @ b) / np.pi
    return np.where(light[..., 2] > 0, value, 0.0)


def fibres(light, eye, points=256):
    """The truth: radiance of half cylinders of Lambert's law, side by side along x, each of which
    hides and shades its neighbours, over that of a white sheet. light, eye: (..., 3)."""
    theta = (np.arange(points) + 0.5) / points * np.pi - np.pi / 2
    n = np.stack([np.sin(theta), np.cos(theta)], -1)  # (y, z), also the place on a fibre of radius 1

    def open_to(w):
        """How far each place turns to w, 0 where the fibre itself or a neighbour is in the way."""
        flat_w = w[..., 1:]
        facing = flat_w @ n.T
        length = np.linalg.norm(flat_w, axis=-1, keepdims=True)
        d = flat_w / np.maximum(length, 1e-12)
        free = facing > 0
        for middle in (-4.0, -2.0, 2.0, 4.0):
            rest = np.array([middle, 0.0]) - n  # to the neighbour's middle
            along = d @ rest.T
            off2 = (rest**2).sum(-1) - along**2
            free &= ~((along > 0) & (off2 < 1 - 1e-9))
        return np.where(free, facing, 0.0)

    lit, seen = open_to(np.asarray(light, float)), open_to(np.asarray(eye, float))
    return (lit * seen).sum(-1) / np.maximum(seen.sum(-1), 1e-12)


def sphere_of(model, along, size, light):
    """A matt sphere whose fibres run along its circles of latitude, or across them."""
    side = (np.arange(size) + 0.5) / size * 2.1 - 1.05
    x, y = np.meshgrid(side, -side)
    left = 1 - x * x - y * y
    z = np.sqrt(np.maximum(left, 1e-6))
    out = np.stack([x, y, z], -1)
    t = np.stack([z, 0 * x, -x], -1)
    t /= np.maximum(np.linalg.norm(t, axis=-1, keepdims=True), 1e-9)
    b = np.cross(out, t)
    if not along:
        t, b = b, -t

    def local(w):
        return np.stack([t @ w, b @ w, out @ w], -1)

    wi, wo = local(np.array(light) / np.linalg.norm(light)), local(np.array([0, 0, 1.0]))
    flat_wi, flat_wo = wi.reshape(-1, 3), wo.reshape(-1, 3)
    value = fibres(flat_wi, flat_wo) if model == "fibres" else phi(model, flat_wi, flat_wo)
    value = value.reshape(size, size) * (left > 0) * (wi[..., 2] > 0)
    return sheet.grey(value, 1.0), value


def diffuse_spheres(folder, size):
    """Hast2004 Fig. 1, with its formula as printed, mended, and real fibres beside it."""
    made = []
    for along, where in ((True, "fibres run round"), (False, "fibres run up")):
        truth, light = sphere_of("fibres", along, size, (0.5, 0.4, 0.75))
        for model, word in (("max_normal", "maximum normal"), (PRINTED, "printed"), ("fibre", "integral"),
                            ("fibre_view", "integral, by view"), ("lambert", "Lambert")):
            pixels, value = sphere_of(model, along, size, (0.5, 0.4, 0.75))
            made.append((f"{word}|{where}", pixels, "error {}",
                         np.abs(value - light).mean() / light.mean()))
        made.append((f"real fibres|{where}", truth))
    return made


def diffuse_rows(points):
    """Each model beside real fibres, lights over the hemisphere, by the eye's elevation."""
    rows = []
    k = np.arange(points) + 0.5
    z, a = k / points, np.pi * (1 + 5**0.5) * k
    light = np.stack([np.sqrt(1 - z * z) * np.cos(a), np.sqrt(1 - z * z) * np.sin(a), z], -1)
    for elevation in (90, 60, 30):
        eyes = [direction(elevation, azimuth) for azimuth in ((0,) if elevation == 90 else (0, 45, 90, 135, 180, 225, 270))]
        pairs = [(light, np.broadcast_to(eye, light.shape), fibres(light, np.broadcast_to(eye, light.shape)))
                 for eye in eyes]
        for model in (*DIFFUSE, SCALED, PRINTED):
            off = [phi(model, wi, wo) - truth for wi, wo, truth in pairs]
            mean = np.mean([truth.mean() for _wi, _wo, truth in pairs])
            rows.append({"kind": "diffuse", "method": model, "elevation": elevation,
                         "error": float(np.mean(np.abs(off)) / mean), "worst": float(np.max(np.abs(off))),
                         "brightness": float(1 + np.mean(off) / mean)})
    return rows
