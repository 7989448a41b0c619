#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Make data/albedo_fit.h: polynomials for multiscatter.h, with their errors. It needs numpy.

    python3 libshade/data/albedo_fit.py > libshade/data/albedo_fit.h

E, what a microfacet BRDF whose Fresnel is 1 reflects towards an eye in even light, is the mean of G2/G1
over the normals that the eye sees. Of an eye in the lobe's frame whose slopes are scaled by the alphas,
so that the lobe is round, (X, Y, u) is the unit direction. (1 - E) / (1 + E) is fitted in t (of u),
s + 1 and d, sum and difference of the alphas (GGX) or their squares (Beckmann), and q = X^2 - Y^2.
Exchanging x and y turns the signs of d and q: terms that this would change are left out, and those in
which a round lobe, whose d is 0, would see q.
test/test_furnace.c holds E by it against quadratures of its own.
"""
import itertools
import math

import numpy as np

DEGREE, WEIGHTS = 8, (1, 1.2, 1.2, 1.4)  # i of t, j of s, k of d, l of q: i + 1.2 j + 1.2 k + 1.4 l <= 8
POINTS, SIDE, ROUNDS = 5000, 96, 25


def ggx_eyes(u, azimuth):
    """Slopes that an eye sees of a round lobe of GGX, by their normals, and weights. [DupuyBenyoub2023]"""
    first, second = np.meshgrid((np.arange(SIDE) + 0.5) / SIDE, (np.arange(SIDE) + 0.5) / SIDE)
    z = (1 - second) * (1 + u) - u
    sine, turn = np.sqrt(1 - z * z), 2 * math.pi * first
    across = math.sqrt(1 - u * u)
    h = (sine * np.cos(turn) + across * math.cos(azimuth), sine * np.sin(turn) + across * math.sin(azimuth), z + u)
    return h, np.ones_like(z)


def beckmann_eyes(u, azimuth):
    """The same of Gaussian slopes."""
    nodes, weights = np.polynomial.legendre.leggauss(SIDE)
    across, most = math.sqrt(1 - u * u), 6.0
    high = min(u / max(across, 1e-9), most)
    along, aside = np.meshgrid((high - most) / 2 + (high + most) / 2 * nodes, 9 * ((np.arange(SIDE) + 0.5) / SIDE - 0.5),
                               indexing="ij")
    weight = weights[:, None] * np.exp(-along**2 - aside**2) * (u - across * along)
    c, s = math.cos(azimuth), math.sin(azimuth)
    return (s * aside - c * along, -s * along - c * aside, np.ones_like(along)), weight


def ggx_lambda(square):
    return (np.sqrt(1 + square) - 1) / 2


_ERF = np.vectorize(math.erf)
_STEPS = np.linspace(0, 6, 6001)
_LAMBDAS = np.exp(-_STEPS**2) / (2 * np.sqrt(np.pi)) - _STEPS * (1 - _ERF(_STEPS)) / 2  # times 1 / slope


def beckmann_lambda(square):
    inverse = 1 / np.sqrt(np.maximum(square, 1e-20))
    return np.interp(inverse, _STEPS, _LAMBDAS) / inverse


KINDS = {"GGX": (ggx_eyes, ggx_lambda, lambda a: a, lambda u: 2 * u - 1),
         "BECKMANN": (beckmann_eyes, beckmann_lambda, lambda a: a * a, lambda u: 2 * np.sqrt(1 - u) - 1)}


def albedo(kind, u, azimuth, ax, ay):
    eyes, smith, _, _ = KINDS[kind]
    across = math.sqrt(1 - u * u)
    eye = np.array([across * math.cos(azimuth) / ax, across * math.sin(azimuth) / ay, u])
    eye /= np.linalg.norm(eye)
    (hx, hy, hz), weight = eyes(u, azimuth)
    length = np.sqrt((ax * hx) ** 2 + (ay * hy) ** 2 + hz**2)
    hx, hy, hz = ax * hx / length, ay * hy / length, hz / length
    twice = 2 * (hx * eye[0] + hy * eye[1] + hz * eye[2])
    x, y, z = twice * hx - eye[0], twice * hy - eye[1], twice * hz - eye[2]
    up = np.where(z > 0, z, 1)
    light, own = smith(((ax * x) ** 2 + (ay * y) ** 2) / up**2), smith(np.array(1 / u**2 - 1))
    return float((np.where(z > 0, (1 + own) / (1 + own + light), 0) * weight).sum() / weight.sum())


def places(random, count):
    """Eyes evenly by u or by their own cosine; alphas of all ratios, their ends more often."""
    alphas = np.maximum(random.uniform(size=(2, count)) ** random.choice([1, 2], (2, count)), 1e-3)
    ends = random.uniform(size=(2, count))
    alphas = np.where(ends < 0.15, 1.0, np.where(ends > 0.9, 0.005, alphas))
    azimuth = random.uniform(0, math.pi / 2, count)
    ends = random.uniform(size=count)
    azimuth = np.where(ends < 0.15, 0.0, np.where(ends > 0.85, math.pi / 2, azimuth))
    u, cosine = random.uniform(0.01, 1, (2, count))
    x, y = alphas[0] * np.cos(azimuth), alphas[1] * np.sin(azimuth)
    own = random.uniform(size=count) < 0.5
    u = np.where(own, np.minimum(1 / np.sqrt(1 + (x * x + y * y) * (1 / cosine**2 - 1)), 1 - 1e-9), u)
    return u, np.where(own, np.arctan2(y, x), azimuth), alphas[0], alphas[1]


ALL = [(i, j, k, m) for k, m, j, i in itertools.product(range(DEGREE + 1), repeat=4)
       if np.dot((i, j, k, m), WEIGHTS) <= DEGREE and (k + m) % 2 == 0 and (k or not m)]


def terms(kind, u, azimuth, ax, ay):
    a, b, t = KINDS[kind][2](ax), KINDS[kind][2](ay), KINDS[kind][3](u)
    s, d, q = a + b - 1, a - b, (1 - u * u) * np.cos(2 * azimuth)
    return np.array([t**i * s**j * d**k * q**m for i, j, k, m in ALL]).T


def fit(kind, random):
    """Coefficients that keep the worst relative error of E low, and that error at other places."""
    seen = []
    for _ in range(2):
        at = places(random, POINTS)
        seen.append((terms(kind, *at), np.array([albedo(kind, *place) for place in zip(*at)])))
    (matrix, e), (other, true) = seen
    loss = (1 - e) / (1 + e)
    least = 2 / (1 - loss**2)
    weight = least.copy()
    for _ in range(ROUNDS):
        found = np.linalg.lstsq(matrix * weight[:, None], loss * weight, rcond=None)[0]
        off = np.abs(matrix @ found - loss) * least
        weight *= np.sqrt(0.5 + off / np.sqrt((off**2).mean()))
        weight = np.clip(weight / weight.mean(), 0.3 * least / least.mean(), 6 * least / least.mean())
    found = np.round(found, 6)
    got = np.maximum(other @ found, 0)
    off = np.abs((1 - got) / (1 + got) / true - 1)
    return found, off.max(), math.sqrt((off**2).mean())


def main():
    print("/* SPDX-" "License-Identifier: Apache-2.0 */\n"
          "/* Made by albedo_fit.py, which says of what. Do not edit. */\n"
          "#ifndef SHADE_MODEL_ALBEDO_FIT_H\n#define SHADE_MODEL_ALBEDO_FIT_H\n\n"
          "/*\n * The sum of d^k q^l (c + sum of c t^i s^j), by rows GROUP(k, l, c, TERM(i, j, c) ...).\n"
          " * Relative errors of E at places that were not fitted stand beside each.\n */\n\n/* clang-format off */")
    random = np.random.default_rng(7)
    for kind in KINDS:
        found, worst, mean = fit(kind, random)
        print(f"\n/* {len(ALL)} terms; worst {worst:.4f}, root of the mean square {mean:.4f} */")
        lines = [f"#define SHADE_ALBEDO_{kind}(GROUP, TERM)"]
        for (k, m), group in itertools.groupby(zip(ALL, found), lambda row: row[0][2:]):
            group = list(group)
            lines.append(f"  GROUP({k}, {m}, {group[0][1]:.6f},")
            for (i, j, _, _), c in group[1:]:
                term = f" TERM({i}, {j}, {c:.6f})"
                if len(lines[-1]) + len(term) > 96:
                    lines.append("   ")
                lines[-1] += term
            lines[-1] += ")"
        print(" \\\n".join(lines))
    print("/* clang-format on */\n\n#endif")


if __name__ == "__main__":
    main()
