# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise of each kind in one to four dimensions, against Perlin's and Musgrave's formulas, long-hand."""

import itertools

import numpy as np
import pytest

from native_scenes import dump, material, registers, render, scene, vectors

COST = 0.4

SCALES = {1: 0.25, 2: 0.6616, 3: 0.982, 4: 0.8344}  # Cycles'
ROUGHNESS, LACUNARITY, OFFSET, GAIN = 0.6, 2.3, 0.7, 1.9


def turned(x, bits):
    return x << np.uint32(bits) | x >> np.uint32(32 - bits)


def lookup3(words):
    """Of one to four words, by Jenkins, begun with 13."""
    begin = np.uint32(0xdeadbeef + 4 * len(words) + 13)
    a, b, c = (begin + word for word in [*words, 0 * words[0], 0 * words[0]][:3])
    if len(words) == 4:
        a = (a - c) ^ turned(c, 4)
        c, b = c + b, (b - a) ^ turned(a, 6)
        a, c = a + c, (c - b) ^ turned(b, 8)
        b, a = b + a, (a - c) ^ turned(c, 16)
        c, b = c + b, (b - a) ^ turned(a, 19)
        a, c = a + c, (c - b) ^ turned(b, 4)
        a, b = a + words[3], b + a
    for bits in ((14, 11, 25), (16, 4, 14), (24, 0, 0)):
        c = (c ^ b) - turned(b, bits[0])
        if bits[1]:
            a = (a ^ c) - turned(c, bits[1])
            b = (b ^ a) - turned(a, bits[2])
    return c


def slope(h, at):
    """Of a corner, by [Perlin2002]: by a table of directions, in one dimension by eight lengths."""
    sign = lambda bit, x: np.where(h & bit, -x, x)
    if len(at) == 1:
        return sign(8, (1.0 + (h & 7)) * at[0])
    if len(at) == 2:
        low = h % 8 < 4
        return sign(1, np.where(low, *at)) + 2 * sign(2, np.where(low, *at[::-1]))
    if len(at) == 3:
        h = h % 16
        x, y, z = at
        return sign(1, np.where(h < 8, x, y)) + sign(2, np.select([h < 4, (h == 12) | (h == 14)], [y, x], z))
    h = h % 32
    x, y, z, w = at
    return sign(1, np.where(h < 24, x, y)) + sign(2, np.where(h < 16, y, z)) + sign(4, np.where(h < 8, z, w))


def perlin(at):
    cells = [np.floor(x) for x in at]
    sum_ = 0.0
    for corner in itertools.product((0, 1), repeat=len(at)):
        away = [x - cell - k for x, cell, k in zip(at, cells, corner)]
        fade = np.prod([1 - (6 * abs(t)**5 - 15 * abs(t)**4 + 10 * abs(t)**3) for t in away], 0)
        h = lookup3([(cell + k).astype(np.int64).astype(np.uint32) for cell, k in zip(cells, corner)])
        sum_ = sum_ + fade * slope(h, away)
    return SCALES[len(at)] * sum_


def octave_sum(what, even, noise, octaves):
    """Of one point [Musgrave2003]; `octaves` of its noise, the last in part."""
    whole, part = int(octaves), octaves % 1
    power = ROUGHNESS ** np.arange(whole + 1)
    if what == "FBM":
        sums = [(power[:k] * noise[:k]).sum() for k in (whole, whole + 1)]
        if even:
            sums = [0.5 + 0.5 * value / power[:k].sum() for value, k in zip(sums, (whole, whole + 1))]
        return (1 - part) * sums[0] + part * sums[1]
    shares = [1.0] * whole + [part]
    signals = noise[:whole + 1] + OFFSET
    if what == "MULTIFRACTAL":
        return np.prod([1 + share * p * n for share, p, n in zip(shares, power, noise)])
    if what == "HETERO_TERRAIN":
        value = signals[0]
        for share, p, signal in zip(shares[1:], power[1:], signals[1:]):
            value += share * signal * p * value
        return value
    value, weight = 0.0, 1.0
    if what == "HYBRID_MULTIFRACTAL":
        for share, p, signal in zip(shares, power, signals):
            if weight > 0.001:
                weight = min(weight, 1)
                value, weight = value + share * weight * p * signal, weight * GAIN * p * signal
        return value
    for p, n in zip(power[:whole], noise):  # what is there in part counts for nothing
        signal = weight * (OFFSET - abs(n)) ** 2
        value, weight = value + p * signal, np.clip(GAIN * signal, 0, 1)
    return value


@pytest.mark.parametrize("dimensions", SCALES)
def test_white_noise(dimensions):
    """Of the bits of numbers: of all of them; and of them with 1 and with 2 beside, or of four in other orders."""
    at = np.float32([0.37, -12.5, 3e7, 1e-3])
    node = {"type": "WHITE_NOISE", "dimensions": dimensions, "at": at.tolist(), "out": registers(3, 4)}
    words = [*at.view(np.uint32)[:dimensions]]
    beside = [[*words, np.float32(k).view(np.uint32)] for k in (1, 2)]
    orders = [words, *(beside if dimensions < 4 else ([words[k] for k in order] for order in ((2, 0, 3, 1), (3, 2, 1, 0))))]
    truth = [lookup3([np.uint32([word]) for word in order])[0] / 0xffffffff for order in orders]
    shown = []
    for out in (node["out"][:3], node["out"][3:] * 3):
        shines = {"name": "noise", "closure": "EMISSION", "weight": out, "nodes": [node]}
        shown.append(render(scene(materials=[shines], lights=[], width=1, height=1, samples=1))[0][0, 0, :3])
    np.testing.assert_allclose(shown, [truth, truth[:1] * 3], atol=1e-6)


@pytest.mark.parametrize("dimensions", SCALES)
@pytest.mark.parametrize("what, even, first", [
    ("FBM", True, False), ("FBM", False, True), ("MULTIFRACTAL", False, False), ("HETERO_TERRAIN", False, False),
    ("HYBRID_MULTIFRACTAL", False, False), ("RIDGED_MULTIFRACTAL", False, False)])
def test_noise(dimensions, what, even, first, tmp_path):
    """Over some cells on both sides of 0, of as many octaves as a place says."""
    uv, at, detail, said = registers(3, 3), registers(6, 4), registers(10, 1), registers(11, 1)
    lines = [(0, 3.0, -1.2), (1, 2.0, -0.3), (0, -1.5, 3.3), (1, -4.0, 0.9)]
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": uv}]
    nodes += [{"type": "MATH", "operation": "MULTIPLY_ADD", "a": [uv[k]], "b": [by], "c": [more], "out": [out]}
              for (k, by, more), out in zip([*lines, (1, 2.7, 1.1)], [*at, *detail])]
    nodes += [{"type": "NOISE", "dimensions": dimensions, "what": what, "even": even, "first": first, "at": at, "detail": detail,
               "roughness": [ROUGHNESS], "lacunarity": [LACUNARITY], "offset": [OFFSET], "gain": [GAIN], "out": said},
              {"type": "MATH", "operation": "MULTIPLY_ADD", "a": said, "b": [0.125], "c": [0.375], "out": said}]
    planes, _ = dump(scene(materials=[material() | {"nodes": nodes, "f0_from": said * 3}]), tmp_path / "d.exr")
    place = [planes[f"uv.{name}"].astype(float).ravel() for name in "UV"]
    points = [by * place[k] + more for k, by, more in lines[:dimensions]]
    noise = np.stack([perlin([LACUNARITY**k * x for x in points]) for k in range(5)], -1)
    octaves = 2.7 * place[1] + 1.1 + (not first)
    truth = [octave_sum(what, even, *one) for one in zip(noise, octaves)]
    assert np.ptp(truth) > 0.2
    np.testing.assert_allclose((vectors(planes, "Color", "RGB")[..., 0].ravel() - 0.375) / 0.125, truth, atol=3e-5, rtol=3e-5)
