# SPDX-License-Identifier: Apache-2.0
"""The test plate: a unit square with sinusoidal bumps, as numbers.

The height over the plate, with (u, v) in [0, 1]^2 and k = 2 pi PERIODS, is

    height(u, v) = SLOPE / k * sin(k u) * sin(k v)

whose steepest slope is SLOPE. Its slopes and normals are known exactly, so the
same surface can be given to a renderer as a normal map on a flat plate or as a
really displaced mesh. The sun stands high enough that no bump shadows another
and every normal faces both the sun and the camera above the plate.
"""
import numpy as np

SLOPE = 0.6
PERIODS = 2
SUN = np.array([0.3, 0.5, 0.8]) / np.sqrt(0.98)  # unit, to the sun

# Cycles' Anisotropic BSDF turns (roughness, anisotropy) into alphas
# r^2 (1 - a) and r^2 / (1 - a), and Ashikhmin-Shirley's exponents are
# 2 / alpha^2 - 2 (Blender 3.4, kernel/svm/closure.h, bsdf_ashikhmin_shirley.h).
ROUGHNESS = 0.3
ANISOTROPY = 0.8
EX = 2.0 / (ROUGHNESS**2 * (1.0 - ANISOTROPY)) ** 2 - 2.0
EY = 2.0 / (ROUGHNESS**2 / (1.0 - ANISOTROPY)) ** 2 - 2.0


def height(u, v):
    """Height of the bumps, in plate widths."""
    k = 2.0 * np.pi * PERIODS
    return SLOPE / k * np.sin(k * u) * np.sin(k * v)


def slopes(u, v):
    """(dh/du, dh/dv)."""
    k = 2.0 * np.pi * PERIODS
    return (SLOPE * np.cos(k * u) * np.sin(k * v), SLOPE * np.sin(k * u) * np.cos(k * v))


def _waves():
    """Numbers along u and v of waves of three to seven, with what each is shifted by; of equal parts of the slopes' variance."""
    numbers = np.array([(i, j) for i in range(-7, 8) for j in range(8) if 9 <= i * i + j * j <= 49 and (j > 0 or i > 0)])
    return numbers, np.random.default_rng(5).uniform(0, 2 * np.pi, len(numbers))


def _letter(u, v):
    """(height, dh/du, dh/dv) of a ring and a bar that stand out, with bevels of slope 1; elsewhere it is flat."""
    x, y = (2 * np.pi * (at - np.floor(at)) - np.pi for at in (u, v))
    out = np.maximum(np.hypot(x, y), 1e-9)
    # how far within the outlines of each, and which way that grows
    inside = np.stack([0.3 - np.abs(out - 1.7), 0.3 - np.abs(y), 2.6 - np.abs(x)])
    in_bar = np.minimum(inside[1], inside[2])
    way = np.sign(1.7 - out)
    ring, across = inside[0] > in_bar, inside[1] < inside[2]
    deep = np.maximum(inside[0], in_bar) + 0.1
    bevel = (deep > 0) & (deep < 0.25)
    du = np.where(ring, way * x / out, np.where(across, 0, -np.sign(x))) * bevel
    dv = np.where(ring, way * y / out, np.where(across, -np.sign(y), 0)) * bevel
    return np.clip(deep, 0, 0.25) / (2 * np.pi), du, dv


def relief(surface, slope, u, v):
    """(height, dh/du, dh/dv) of "waves", as of height(), "noise", "ridges" along v, or an embossed "letter". slope: the
    steepest, but of a noise the root of twice the variance along both axes."""
    if surface == "letter":
        return tuple(slope * each for each in _letter(u, v))
    if surface == "noise":
        numbers, shifts = _waves()
        height_, du, dv = (np.zeros(np.shape(u)) for _ in range(3))
        for (i, j), shift in zip(numbers, shifts):
            at, size = 2 * np.pi * (i * u + j * v) + shift, slope / np.sqrt(len(numbers)) / np.hypot(i, j)
            height_ += size / (2 * np.pi) * np.sin(at)
            du += size * i * np.cos(at)
            dv += size * j * np.cos(at)
        return height_, du, dv
    k = 2 * np.pi * PERIODS
    if surface == "ridges":
        return slope / k * np.sin(k * u), slope * np.cos(k * u), 0 * u
    return slope / SLOPE * height(u, v), *(slope / SLOPE * each for each in slopes(u, v))


def relief_map(surface, slope, size):
    """Its tangent-space normal map, as normal_map()."""
    return (0.5 + 0.5 * normals_of(*relief(surface, slope, *grid(size))[1:])[::-1]).astype(np.float32)


def relief_mesh(surface, slope, quads, tiles):
    """The plate with that relief, so often in a row along v, as (positions, faces, uv per vertex)."""
    along = np.linspace(0.5 - tiles / 2, 0.5 + tiles / 2, quads * tiles + 1)
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0.0, 1.0, quads + 1), along))
    positions = np.stack([u - 0.5, v - 0.5, relief(surface, slope, u, v)[0]], axis=-1)
    first = (np.arange(quads * tiles)[:, None] * (quads + 1) + np.arange(quads)).ravel()
    return positions, np.stack([first, first + 1, first + quads + 2, first + quads + 1], axis=-1), np.stack([u, v], axis=-1)


def normals(u, v):
    """Unit normals of the displaced surface, shape (..., 3)."""
    return normals_of(*slopes(u, v))


def normals_of(du, dv):
    """Unit normals by slopes."""
    n = np.stack([-du, -dv, np.ones_like(du)], axis=-1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def grid(size):
    """(u, v) of the centres of size x size pixels, rows from the bottom."""
    centre = (np.arange(size) + 0.5) / size
    return np.meshgrid(centre, centre)


def normal_map(size):
    """Tangent-space normal map, float32 RGB in [0, 1], rows from the top."""
    n = normals(*grid(size))
    return (0.5 + 0.5 * n[::-1]).astype(np.float32)


def same_normals(size):
    """Where among size x size pixels the plate has the normal that it has at each of them.

    Pairs (column, row) of whole-numbered pictures, 8 PERIODS^2 in all, rows from either side; size is
    a multiple of 4 PERIODS. With s = k (u + v) and d = k (u - v) the slopes are SLOPE/2 times
    (sin s - sin d, sin s + sin d): they stay where s becomes pi - s, or d does, and over periods.
    """
    if size % (4 * PERIODS):
        raise ValueError(f"{size} pixels: no multiple of {4 * PERIODS}")
    period = size // PERIODS
    column, row = np.meshgrid(np.arange(size), np.arange(size))
    places = []
    for turned_s in (False, True):
        for turned_d in (False, True):
            u, v = column, row
            if turned_s:
                u, v = period // 4 - 1 - v, period // 4 - 1 - u
            if turned_d:
                u, v = v + period // 4, u - period // 4
            places += [((u + half * period // 2 + i * period) % size,
                        (v + half * period // 2 + j * period) % size)
                       for half in (0, 1) for i in range(PERIODS) for j in range(PERIODS)]
    return places


def mesh(quads):
    """The displaced plate as (positions, normals, faces, uv per vertex)."""
    side = np.linspace(0.0, 1.0, quads + 1)
    u, v = (a.ravel() for a in np.meshgrid(side, side))
    positions = np.stack([u - 0.5, v - 0.5, height(u, v)], axis=-1)
    first = (np.arange(quads)[:, None] * (quads + 1) + np.arange(quads)).ravel()
    faces = np.stack([first, first + 1, first + quads + 2, first + quads + 1], axis=-1)
    return positions, normals(u, v), faces, np.stack([u, v], axis=-1)


# Scratches for the same plate: wide enough for the mesh, as steep as the waves at most, so
# that no pit shadows itself under SUN. Options of `shade scratch`.
SCRATCHES = ("--pits", "40", "--radius", "0.02,0.05", "--stretch", "1.5,6", "--depth", "0.1,0.25",
             "--spread", "90", "--seed", "3")


def height_mesh(height):
    """A plate displaced by a height picture (square, rows from the top), which repeats.

    Vertices lie at the texels' centres and one texel beyond each edge, so the mesh covers the
    plate. Returns (positions, faces, uv per vertex).
    """
    size = len(height)
    padded = np.pad(height[::-1], 1, mode="wrap")
    side = (np.arange(size + 2) - 0.5) / size
    u, v = (a.ravel() for a in np.meshgrid(side, side))
    positions = np.stack([u - 0.5, v - 0.5, padded.ravel()], axis=-1)
    row = size + 2
    first = (np.arange(row - 1)[:, None] * row + np.arange(row - 1)).ravel()
    faces = np.stack([first, first + 1, first + row + 1, first + row], axis=-1)
    return positions, faces, np.stack([u, v], axis=-1)


def off_creases(normals, pixels, jump=0.06, margin=2):
    """Which of pixels x pixels keep `margin` pixels away from any crease of a normal map.

    A crease is where the slopes of neighbouring texels differ by more than `jump`.
    """
    n = 2.0 * np.asarray(normals, float) - 1.0
    slopes = -n[..., :2] / n[..., 2:]
    crease = np.zeros(slopes.shape[:2], bool)
    for axis in range(2):
        step = np.abs(slopes - np.roll(slopes, 1, axis)).max(-1) > jump
        crease |= step | np.roll(step, -1, axis)
    size = len(crease)
    edges = np.arange(pixels) * size // pixels
    coarse = np.logical_or.reduceat(np.logical_or.reduceat(crease, edges, 0), edges, 1)
    for axis in range(2):
        coarse = np.logical_or.reduce([np.roll(coarse, k, axis)
                                       for k in range(-margin, margin + 1)])
    return ~coarse
