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


def normals(u, v):
    """Unit normals of the displaced surface, shape (..., 3)."""
    du, dv = slopes(u, v)
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


def mesh(quads):
    """The displaced plate as (positions, normals, faces, uv per vertex)."""
    side = np.linspace(0.0, 1.0, quads + 1)
    u, v = (a.ravel() for a in np.meshgrid(side, side))
    positions = np.stack([u - 0.5, v - 0.5, height(u, v)], axis=-1)
    first = (np.arange(quads)[:, None] * (quads + 1) + np.arange(quads)).ravel()
    faces = np.stack([first, first + 1, first + quads + 2, first + quads + 1], axis=-1)
    return positions, normals(u, v), faces, np.stack([u, v], axis=-1)
