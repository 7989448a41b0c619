# SPDX-License-Identifier: GPL-3.0-or-later
"""Scratches from afar, which are roughness, against the points that they are; and how large fields are."""

import numpy as np
import pytest

from native_scenes import SANITIZED, material, native, of_means, ortho, registers, render, scene, some, sun

COST = 15.5

FINE = {"density": 5.0, "length": 20.0, "width": 1.0, "depth": 0.2, "direction": 0.3, "spread": 0.6, "seed": 5.0, "tile": 0.5}
UV, NEAR, NORMAL, SPREAD, ALPHA = registers(3, 3), registers(6, 2), registers(9, 3), registers(12, 2), registers(14, 2)


def plate(light, amount=1.0, **changes):
    """Two metres of scratched metal, of which a pixel is an eighth: the mean of each quarter's quarter."""
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": UV},
             *({"type": "MATH", "operation": "ADD", "a": [a], "b": [0.125], "c": [0.0], "out": [b]} for a, b in zip(UV, NEAR)),
             {"type": "SCRATCHES", "what": "NORMAL", "field": 0, "at": UV[:2], "near": [NEAR[0], UV[1], UV[0], NEAR[1]],
              "step": 0.125, "amount": [amount], "normal": [0.0, 0.0, 1.0], "filtered": True, "out": [*NORMAL, *SPREAD]}]
    for a, b in zip(SPREAD, ALPHA):
        nodes += [{"type": "MATH", "operation": "ADD", "a": [a], "b": [0.04], "c": [0.0], "out": [b]},
                  {"type": "MATH", "operation": "SQRT", "a": [b], "b": [0.0], "c": [0.0], "out": [b]}]
    metal = material(mdf="BECKMANN", brdf="MICROFACET", fresnel="NONE") | {
        "nodes": nodes, "normal": NORMAL, "ax_from": ALPHA[:1], "ay_from": ALPHA[1:]}
    picture = render(scene(scratches=[FINE], materials=[metal], lights=[sun(light)], **changes))[0][..., 0]
    return picture.reshape(4, 4, 4, 4).mean((1, 3))


@pytest.mark.parametrize("light", some([(0.25, 0.1, 1), (-0.1, 0.55, 1)]))
def test_far_scratches_are_the_roughness_of_near_ones(light):
    """Beside the light's mirror image, and far from it, at footprints from where the table begins to a pixel's."""
    fewer = 4 if SANITIZED else 1
    truth = plate(light, samples=1024 // fewer)
    assert abs(plate(light, 0.0, samples=16).mean() / truth.mean() - 1) > 0.1
    for blur in (0.02, 0.04, 0.2, 1.0):
        far = plate(light, samples=256 // fewer, normal_blur=blur)
        print(light, blur, np.abs(far / truth - 1).max(), far.mean() / truth.mean() - 1)
        assert abs(far.mean() / truth.mean() - 1) < 0.015 * fewer**0.5 and np.abs(far / truth - 1).max() < 0.05 * fewer**0.5


def drawn_plate(light, mdf="GGX", **changes):
    """As plate, of what is not widened: each ray sees a slope by chance."""
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": UV},
             *({"type": "MATH", "operation": "ADD", "a": [a], "b": [0.125], "c": [0.0], "out": [b]} for a, b in zip(UV, NEAR)),
             {"type": "SCRATCHES", "what": "NORMAL", "field": 0, "at": UV[:2], "near": [NEAR[0], UV[1], UV[0], NEAR[1]],
              "step": 0.125, "amount": [1.0], "normal": [0.0, 0.0, 1.0], "drawn": True, "out": NORMAL}]
    metal = material(mdf=mdf, brdf="MICROFACET", fresnel="NONE", ax=0.2, ay=0.2) | {"nodes": nodes, "normal": NORMAL}
    picture = render(scene(scratches=[FINE], materials=[metal], lights=[sun(light)], **changes))[0][..., 0]
    return picture.reshape(4, 4, 4, 4).mean((1, 3))


def moments(turn, **changes):
    """The mean square slope of what rays meet, and of what they stand for beside it; the field turned, seen along the plate."""
    c, s, step = np.cos(turn), np.sin(turn), 0.125
    at, near, parts = registers(16, 2), [c * step, s * step, -s * step, c * step], registers(20, 4)

    def math(operation, a, b, to):
        return {"type": "MATH", "operation": operation, "a": [a], "b": [b], "c": [0.0], "out": [to]}
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": UV}, {"type": "TRANSFORM", "vector": UV, "unit": False, "out": [*at, (18,)],
                                                              "matrix": [c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0]}]
    nodes += [math("ADD", at[k % 2], by, parts[k]) for k, by in enumerate(near)]
    nodes += [{"type": "SCRATCHES", "what": "NORMAL", "field": 0, "at": at, "near": parts, "step": step, "amount": [1.0],
               "normal": [0.0, 0.0, 1.0], "filtered": True, "out": [*NORMAL, *SPREAD]}]
    for k in range(2):
        nodes += [math("DIVIDE", NORMAL[k], NORMAL[2], parts[k]), math("MULTIPLY", parts[k], parts[k], parts[k])]
    nodes += [math("ADD", *parts[:2], parts[0]), math("ADD", *SPREAD, parts[1]), math("MULTIPLY", parts[1], 0.5, parts[1])]
    shines = {"name": "slopes", "closure": "EMISSION", "weight": [*parts[:2], 0.0], "nodes": nodes}
    picture = render(scene(scratches=[FINE | {"spread": np.pi / 2}], materials=[shines], lights=[], transparent=False,
                           camera=ortho(0.2, (0, -2.9, 0.8)), **changes))[0]
    return picture[..., :2].mean((0, 1))


@pytest.mark.parametrize("turn", [0.0, np.pi / 4, 3 * np.pi / 4])
def test_footprints_are_long_any_way(turn):
    """What points along one are, it stands for: also where it lies askew in the field."""
    near, far = moments(turn, samples=64), moments(turn, samples=64, normal_blur=1.0)
    assert near[1] == 0 and far[0] < 0.05 * far[1] and far.sum() == pytest.approx(near[0], rel=0.07)


@of_means
@pytest.mark.parametrize("light", some([(0.25, 0.1, 1), (-0.1, 0.55, 1)]))
def test_far_scratches_come_bit_by_bit(light):
    """The mean, which is the same in truth, at footprints an eighth of an octave apart, over four octaves."""
    means = np.array([plate(light, samples=256, normal_blur=0.014 * 2**(k / 8)).mean() for k in range(33)])
    steps = np.abs(np.diff(means)) / means.mean()
    print(light, steps.max(), means.max() / means.min() - 1)
    assert steps.max() < 0.0045


@pytest.mark.parametrize("light", some([(0.25, 0.1, 1), (-0.1, 0.55, 1)]))
def test_far_scratches_spread_what_is_not_widened(light):
    """GGX, whose tails would grow: slopes by chance have the mean of the points, and are not the plate's own."""
    samples, limit = (1024, 0.03) if SANITIZED else (8192, 0.02)  # noise of a mean: .004, .0014
    truth = drawn_plate(light, samples=samples)
    for blur in some((0.04, 0.2, 1.0)):
        far = drawn_plate(light, samples=samples, normal_blur=blur)
        print(light, blur, np.abs(far / truth - 1).max(), far.mean() / truth.mean() - 1)
        assert abs(far.mean() / truth.mean() - 1) < limit and np.abs(far / truth - 1).max() < 0.05


@pytest.mark.parametrize("changes, tile, density", [
    ({"density": 20.0, "tile": 0.0}, 1.0, 20.0),  # 200,000 fill a square metre
    ({"density": 2000.0, "length": 100.0, "width": 0.01, "direction": 0.0, "spread": 0.0, "tile": 0.0}, 0.4, 375.0),  # 600,000
    ({"density": 50.0, "length": 10.0, "width": 10.0, "tile": 0.0}, 0.6325, 20.4),  # 16 over each point
    ({"density": 0.0, "tile": 0.0}, 1.0, 0.0),
])
def test_how_large_a_tile_is(changes, tile, density):
    plan = native.scratches(FINE | changes)
    assert plan["tile"] == pytest.approx(tile, rel=2e-3) and plan["density"] == pytest.approx(density, rel=2e-2)
    assert plan["fewer"] == (density < 0.98 * changes["density"])


def test_pictures_are_refused_where_they_cannot_be():
    for size, samples in ((0, 1), (20000, 1), (16, 0)):
        with pytest.raises(ValueError, match="a size of 1 to 16384 and 1 to 16 samples"):
            native.scratch_images(FINE, size, samples)
    with pytest.raises(ValueError, match="depth is missing"):
        native.scratch_images({name: value for name, value in FINE.items() if name != "depth"}, 4, 1)
