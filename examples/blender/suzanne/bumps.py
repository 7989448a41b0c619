# SPDX-License-Identifier: Apache-2.0
"""Seamless tangent-space normal maps for metal, made from height fields.

Every function returns unit normals, float64, shape (size, size, 3), rows from
the bottom, over one tile [0, 1]^2 that repeats in both directions.
"""
import numpy as np


def normals_of(height):
    """Normals of a periodic height field given in tile widths."""
    size = len(height)
    du = (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) * (0.5 * size)
    dv = (np.roll(height, -1, axis=0) - np.roll(height, 1, axis=0)) * (0.5 * size)
    n = np.stack([-du, -dv, np.ones_like(du)], axis=-1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def with_slope(height, slope):
    """Scale a height field so that its root-mean-square slope is `slope`."""
    size = len(height)
    du = (height - np.roll(height, 1, axis=1)) * size
    dv = (height - np.roll(height, 1, axis=0)) * size
    return height * (slope / np.sqrt(np.mean(du**2 + dv**2)))


def noise(size, along, across, seed):
    """Periodic Gaussian noise; features are `along` x `across` tiles long and wide."""
    rng = np.random.default_rng(seed)
    u = np.fft.rfftfreq(size, 1.0 / size)[None, :] * along
    v = np.fft.fftfreq(size, 1.0 / size)[:, None] * across
    spectrum = np.fft.rfft2(rng.standard_normal((size, size)))
    return np.fft.irfft2(spectrum * np.exp(-2.0 * (u**2 + v**2)), s=(size, size))


def strokes(size, seed):
    """Brush strokes along u: long fine scratches over longer, wider ones."""
    fine = with_slope(noise(size, 0.12, 0.004, seed), 1.0)
    wide = with_slope(noise(size, 0.30, 0.012, seed + 1), 0.7)
    return fine + wide


def blurred(field, width):
    """Periodic Gaussian blur; `width` is the standard deviation in tiles."""
    size = len(field)
    u = np.fft.rfftfreq(size, 1.0 / size)[None, :]
    v = np.fft.fftfreq(size, 1.0 / size)[:, None]
    kernel = np.exp(-2.0 * (np.pi * width) ** 2 * (u**2 + v**2))
    return np.fft.irfft2(np.fft.rfft2(field) * kernel, s=(size, size))


def dents(size, count, seed):
    """Hammer marks: round hollows about `count` spread points, their ridges worn soft."""
    centre = (np.arange(size) + 0.5) / size
    nearest = np.full((size, size), np.inf)
    for x, y in spread_points(count, np.random.default_rng(seed)):
        dx, dy = np.abs(centre - x), np.abs(centre - y)
        dx, dy = np.minimum(dx, 1.0 - dx), np.minimum(dy, 1.0 - dy)
        nearest = np.minimum(nearest, dx[None, :] ** 2 + dy[:, None] ** 2)
    return blurred(nearest, 0.10 / np.sqrt(count))


def spread_points(count, rng, tries=30):
    """Best-candidate points on the unit torus."""
    points = [rng.random(2)]
    while len(points) < count:
        candidates = rng.random((tries, 2))
        gap = np.abs(candidates[:, None] - np.asarray(points)[None])
        gap = np.minimum(gap, 1.0 - gap)
        points.append(candidates[np.argmax(np.min(np.sum(gap**2, axis=-1), axis=1))])
    return points


def hammered(size, seed=1):
    """Soft hammer marks under fine brush strokes."""
    marks = with_slope(dents(size, 120, seed), 0.085)
    return normals_of(marks + with_slope(strokes(size, seed), 0.045))


def grain(size, seed=7):
    """Brush strokes alone."""
    return normals_of(with_slope(strokes(size, seed), 0.05))
