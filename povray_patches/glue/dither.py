#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Writes dither.h, the pairs of numbers that pixels shift their rays by: `dither.py >dither.h` (half a minute, numpy).

A set of pairs that covers the unit square evenly is put on the pixels of a tile so that near pixels have
pairs that are far apart [GeorgievFajardo2016]: pairs of pixels change places while that lowers the sum of
exp(-(pixels apart / 2.1)^2 - 4 (how far apart the pairs are)) over all of them; both wrap round.
"""
import numpy as np

SIDE, REACH, ROUNDS, AT_ONCE = 64, 5, 30000, 48


def pairs():
    """R2: multiples of the powers of the root of x^3 = x + 1."""
    i = np.arange(SIDE * SIDE)[:, None]
    root = 1.32471795724474602596
    return (0.5 + i * np.array([1 / root, 1 / root**2])) % 1


def arrange(rng):
    tile = pairs()[rng.permutation(SIDE * SIDE)]
    step = np.arange(-REACH, REACH + 1)
    dy, dx = (a.ravel() for a in np.meshgrid(step, step, indexing="ij"))
    near = (dx != 0) | (dy != 0)
    dx, dy = dx[near], dy[near]
    weight = np.exp(-(dx**2 + dy**2) / 2.1**2)

    def energy(pixel, pair, other):
        """Of `pair` at `pixel`, where `other`, which is to go, is not looked at."""
        at = (pixel // SIDE + dy[:, None]) % SIDE * SIDE + (pixel % SIDE + dx[:, None]) % SIDE
        apart = np.abs(tile[at] - pair)
        apart = np.minimum(apart, 1 - apart)
        return np.sum(weight[:, None] * np.exp(-4 * np.sqrt(np.sum(apart**2, -1))) * (at != other), 0)

    for _ in range(ROUNDS):
        a, b = rng.choice(SIDE * SIDE, (2, AT_ONCE), replace=False)
        before = energy(a, tile[a], b) + energy(b, tile[b], a)
        after = energy(a, tile[b], b) + energy(b, tile[a], a)
        a, b = a[after < before], b[after < before]
        tile[a], tile[b] = tile[b], tile[a]
    return tile


def main():
    numbers = np.floor(arrange(np.random.default_rng(12)) * 256).astype(int)
    # REUSE-IgnoreStart
    print("// SPDX-License-Identifier: AGPL-3.0-or-later")
    # REUSE-IgnoreEnd
    print("// Made by dither.py: for each pixel of a tile two numbers in 256ths.")
    print("#ifndef POVRAY_BACKEND_MDF_DITHER_H\n#define POVRAY_BACKEND_MDF_DITHER_H\n")
    print("#include <cstdint>\n\n// clang-format off")
    print(f"static const int DITHER_SIDE = {SIDE};")
    print("static const uint8_t DITHER[DITHER_SIDE * DITHER_SIDE][2] = {")
    for row in numbers.reshape(-1, 16, 2):
        print("  " + " ".join(f"{{{u},{v}}}," for u, v in row))
    print("};\n// clang-format on\n\n#endif")


if __name__ == "__main__":
    main()
