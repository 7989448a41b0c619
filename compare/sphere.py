# SPDX-License-Identifier: Apache-2.0
"""The scratched sphere, as numbers: beside the plate of plate.py, what has curvature, silhouettes and a terminator.

A scratch is a groove along a small circle of the sphere: with its axis a, at the height c over the middle,

    h(p) = -depth exp(-(s / w)^2),  s = (p·a - c) / sqrt(1 - c^2)

for unit p; all are added up, and the surface is RADIUS (1 + h) p. Slopes and normals are known exactly, so that the
same surface can be given to a renderer as a normal map on a round sphere or as a mesh that is really displaced.
u runs about the y axis, which lies in the picture's plane, v from -y to y; both poles are at the rim.
"""
import numpy as np

RADIUS = 0.45  # of the picture's width
COUNT, WIDTH, SLOPE = 60, (0.008, 0.016), (0.3, 0.6)  # of scratches: half widths in radians, steepest slopes
JUDGED = 0.95  # of the radius: pixels beyond it, where a silhouette is displaced, are not compared
FLAT = 128  # quads along a side of the mesh that is not displaced
ROUND = 0.55  # the mesh goes that many times pi about the axis: what the camera and its light see
POLE = 2e-3  # radians about a pole that the mesh leaves out


def scratches():
    """(axes (COUNT, 3), heights, widths, depths): always the same ones."""
    random = np.random.default_rng(11)
    axes = random.normal(size=(COUNT, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    heights, widths = random.uniform(-0.85, 0.85, COUNT), random.uniform(*WIDTH, COUNT)
    return axes, heights, widths, random.uniform(*SLOPE, COUNT) * widths * np.sqrt(np.e / 2)


def height(p):
    """(h, gradient of h along the unit sphere) at unit vectors, shapes (...) and (..., 3)."""
    p = np.asarray(p, float)
    axes, middles, widths, depths = scratches()
    wide = widths * np.sqrt(1 - middles**2)
    flat = p.reshape(-1, 3)
    total, gradient = np.empty(len(flat)), np.empty(flat.shape)
    for first in range(0, len(flat), 65536):
        part = flat[first:first + 65536]
        s = (part @ axes.T - middles) / wide
        value = -depths * np.exp(-s * s)
        total[first:first + 65536] = value.sum(-1)
        full = (-2 * s * value / wide) @ axes  # in space, not along the sphere
        gradient[first:first + 65536] = full - (full * part).sum(-1, keepdims=True) * part
    return total.reshape(p.shape[:-1]), gradient.reshape(p.shape)


def frame(u, v):
    """(east, north, outwards): unit vectors of dP/du, dP/dv and the normal of the round sphere."""
    lon, lat = (np.asarray(u) - 0.5) * 2 * np.pi, (np.asarray(v) - 0.5) * np.pi
    lon, lat = np.broadcast_arrays(lon, lat)
    sin, cos, up, flat = np.sin(lon), np.cos(lon), np.sin(lat), np.cos(lat)
    zero = np.zeros_like(sin)
    return (np.stack([cos, zero, -sin], -1), np.stack([-up * sin, flat, -up * cos], -1),
            np.stack([flat * sin, up, flat * cos], -1))


def surface(u, v):
    """(points, unit normals) of the displaced sphere."""
    out = frame(u, v)[2]
    h, gradient = height(out)
    normal = out - gradient / (1 + h[..., None])
    return RADIUS * (1 + h[..., None]) * out, normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def normal_map(rows):
    """Tangent-space normal map, float32 RGB in [0, 1], rows x 2 rows pixels, rows from the top; flat at the back."""
    made = np.tile(np.float32([0.5, 0.5, 1.0]), (rows, 2 * rows, 1))
    first = int((1 - ROUND) * rows) - 2
    seen = slice(first, 2 * rows - first)
    v, u = (np.arange(rows)[:, None] + 0.5) / rows, (np.arange(2 * rows)[seen] + 0.5) / (2 * rows)
    normal = surface(u, v)[1]
    made[:, seen] = 0.5 + 0.5 * np.stack([(normal * axis).sum(-1) for axis in frame(u, v)], -1)[::-1]
    return made


def mesh(quads, displaced=True):
    """(positions, normals, faces, uv per vertex), quads x quads quads of the half that faces +z, and a little more."""
    v, u = (a.ravel() for a in np.meshgrid(np.linspace(POLE / np.pi, 1 - POLE / np.pi, quads + 1),
                                           np.linspace((1 - ROUND) / 2, (1 + ROUND) / 2, quads + 1), indexing="ij"))
    if displaced:
        positions, normals = surface(u, v)
    else:
        normals = frame(u, v)[2]
        positions = RADIUS * normals
    row = quads + 1
    first = (np.arange(quads)[:, None] * row + np.arange(quads)).ravel()
    return positions, normals, np.stack([first, first + 1, first + row + 1, first + row], -1), np.stack([u, v], -1)


def judged(size):
    """Which of size x size pixels of a picture of unit width, straight from +z, are compared."""
    x = (np.arange(size) + 0.5) / size - 0.5
    return np.hypot(x, x[:, None]) < JUDGED * RADIUS - 1.5 / size
