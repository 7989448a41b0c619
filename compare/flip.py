# SPDX-License-Identifier: Apache-2.0
"""How different two pictures look to an observer who flips between them: FLIP, of pictures for screens.

Written from the definition in [Andersson2020]: pictures are blurred as the eye blurs them at the
distance, compared by a colour difference (HyAB of Hunt-adjusted CIELAB), and where edges or points
differ the colour's difference counts more. 0 equal, 1 the most different.
"""
import numpy as np

PIXELS_PER_DEGREE = 0.7 * 3840 / 0.7 * np.pi / 180  # a screen of 3840 pixels and .7 m, seen from .7 m
WHITE = np.array([0.950428545, 1.0, 1.088900371])  # of sRGB, D65
TO_XYZ = np.array([[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
                   [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
                   [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]])
# contrast sensitivity of achromatic, red-green and blue-yellow: sums of Gaussians (a1, b1, a2, b2)
SENSITIVITY = ((1.0, 0.0047, 0.0, 1e-5), (1.0, 0.0053, 0.0, 1e-5), (34.1, 0.04, 13.5, 0.025))
FEATURE = 0.082  # width of the edge and point detectors, degrees
EXPONENT, KNEE, KNEE_VALUE, FEATURE_EXPONENT = 0.7, 0.4, 0.95, 0.5


def _opponent(rgb):
    """Linear RGB to YCxCz, linear in light."""
    x, y, z = np.moveaxis(rgb @ TO_XYZ.T / WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], -1)


def _from_opponent(values):
    y = (values[..., 0] + 16) / 116
    x, z = y + values[..., 1] / 500, y - values[..., 2] / 200
    return np.stack([x, y, z], -1) * WHITE @ np.linalg.inv(TO_XYZ).T


def _hunt_lab(rgb):
    """CIELAB, its a and b scaled by lightness."""
    t = rgb @ TO_XYZ.T / WHITE
    delta = 6 / 29
    f = np.where(t > delta**3, np.cbrt(t), t / (3 * delta**2) + 4 / 29)
    lightness = 116 * f[..., 1] - 16
    return np.stack([lightness, 0.01 * lightness * 500 * (f[..., 0] - f[..., 1]),
                     0.01 * lightness * 200 * (f[..., 1] - f[..., 2])], -1)


def _hyab(a, b):
    off = a - b
    return np.abs(off[..., 0]) + np.hypot(off[..., 1], off[..., 2])


def _filtered(image, rows, columns):
    """Convolved by a column and a row of weights; the edge goes on beyond the picture."""
    for axis, weights in ((0, rows), (1, columns)):
        radius = len(weights) // 2
        padded = np.pad(image, [(radius, radius) if k == axis else (0, 0) for k in range(2)], mode="edge")
        windows = np.lib.stride_tricks.sliding_window_view(padded, len(weights), axis=axis)
        image = windows @ weights
    return image


def _seen(opponent, ppd):
    """Filtered by the eye's contrast sensitivity."""
    radius = int(np.ceil(3 * np.sqrt(max(max(b1, b2) for _a, b1, _c, b2 in SENSITIVITY) / (2 * np.pi**2)) * ppd))
    x2 = (np.arange(-radius, radius + 1) / ppd) ** 2
    shown = []
    for k, (a1, b1, a2, b2) in enumerate(SENSITIVITY):
        parts, whole = [], 0.0
        for a, b in ((a1, b1), (a2, b2)):
            if a:
                weights = np.exp(-np.pi**2 * x2 / b)  # along one axis; the product is round
                parts.append((a * np.pi / b, weights))
                whole += a * np.pi / b * weights.sum() ** 2
        shown.append(sum(scale * _filtered(opponent[..., k], w, w) for scale, w in parts) / whole)
    return np.stack(shown, -1)


def _detected(luminance, ppd, points):
    """How much of an edge, or of a point, there is at each pixel."""
    width = 0.5 * FEATURE * ppd
    radius = int(np.ceil(3 * width))
    x = np.arange(-radius, radius + 1).astype(float)
    bell = np.exp(-x**2 / (2 * width**2))
    across = (x**2 / width**2 - 1) * bell if points else -x * bell
    whole = np.outer(bell, across)
    found = []
    for first in (bell, across):
        # positive weights sum to 1, negative ones to -1
        kernel = [whole.clip(min=0).sum(), -whole.clip(max=0).sum()]
        up, down = np.clip(across, 0, None) / kernel[0], np.clip(across, None, 0) / kernel[1]
        scaled = up + down
        pair = (bell, scaled) if first is bell else (scaled, bell)
        found.append(_filtered(luminance, *pair))
    return np.hypot(*found)


def _redistributed(difference):
    """To 0 … 1: most of the range for small differences."""
    most = _hyab(_hunt_lab(np.array([0.0, 1.0, 0.0])), _hunt_lab(np.array([0.0, 0.0, 1.0]))) ** EXPONENT
    power, knee = difference**EXPONENT, KNEE * most
    return np.where(power < knee, KNEE_VALUE / knee * power,
                    KNEE_VALUE + (power - knee) / (most - knee) * (1 - KNEE_VALUE))


def flip(reference, test, ppd=PIXELS_PER_DEGREE):
    """Of each pixel of two linear RGB pictures (height, width, 3), what is brighter than 1 cut off."""
    if reference.shape != test.shape or reference.ndim != 3 or reference.shape[-1] != 3:
        raise ValueError(f"pictures of {reference.shape} and {test.shape}; expected the same height and width, RGB")
    if not (np.isfinite(reference).all() and np.isfinite(test).all()):
        raise ValueError("a picture holds values that are not finite")
    pair = [_opponent(np.clip(image, 0.0, 1.0)) for image in (reference, test)]
    labs = [_hunt_lab(np.clip(_from_opponent(_seen(values, ppd)), 0.0, 1.0)) for values in pair]
    colour = _redistributed(_hyab(*labs))
    luminance = [(values[..., 0] + 16) / 116 for values in pair]
    edges, points = (np.abs(np.subtract(*(_detected(y, ppd, kind) for y in luminance))) for kind in (False, True))
    feature = (np.maximum(edges, points) / np.sqrt(2)) ** FEATURE_EXPONENT
    return colour ** (1 - feature)


def mean(reference, test):
    return float(flip(reference, test).mean())
