# SPDX-License-Identifier: GPL-3.0-or-later
"""Formulas that are built of plain nodes for other renderers, in numbers: formulas.py."""

import math
import os
import sys
from types import SimpleNamespace as Of

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402
from parts_of import module  # noqa: E402

shade, place = module("fabric.shade"), module("fabric.place")
MATH = {"ADD": np.add, "SUBTRACT": np.subtract, "MULTIPLY": np.multiply, "DIVIDE": np.divide, "MINIMUM": np.minimum, "MAXIMUM": np.maximum, "POWER": np.power,
        "SQRT": np.sqrt, "FLOOR": np.floor, "LESS_THAN": lambda a, b: float(a < b), "GREATER_THAN": lambda a, b: float(a > b), "MULTIPLY_ADD": lambda a, b, c: a * b + c}
VECTOR = {**{name: MATH[name] for name in ("ADD", "SUBTRACT", "MULTIPLY", "MINIMUM")}, "SCALE": lambda a, b: a * b, "DOT_PRODUCT": np.dot, "CROSS_PRODUCT": np.cross,
          "LENGTH": np.linalg.norm, "NORMALIZE": lambda a: a / np.linalg.norm(a)}


class Later:
    """An output of a node: its number when it is asked, as the node may be told to clamp after it was linked."""

    def __init__(self, function, *given):
        self.function, self.given, self.node = function, given, Of(use_clamp=False)

    def number(self):
        made = self.function(*map(number, self.given))
        return np.clip(made, 0, 1) if self.node.use_clamp else made


def number(value):
    return value.number() if isinstance(value, Later) else np.array(value, float) if isinstance(value, (tuple, list)) else value


class Numbers(shade._Shader):
    """What builds nodes, but for the nodes. by_chance: of three numbers, what white noise is there, and its colour."""

    def __init__(self, by_chance=None, eye=(0.0, 0.0, 1.0)):
        self.by_chance, self.eye = by_chance, eye

    def math(self, operation, *values):
        return Later(MATH[operation], *values)

    def vector(self, operation, *values):
        return Later(VECTOR[operation], *values)

    def parts(self, vector):
        return [Later(lambda v, k=k: v[k], vector) for k in range(3)]

    def together(self, x, y, z=0.0):
        return Later(lambda *parts: np.array(parts), x, y, z)

    def new(self, kind, Vector):
        assert kind == "TexWhiteNoise"
        return Of(outputs={"Value": Later(lambda v: self.by_chance(*v), Vector), "Color": Later(lambda v: np.array([self.by_chance(*v, k) for k in range(3)]), Vector)})


def close(found, wanted):
    return np.allclose(number(found) if not isinstance(found, (tuple, list)) else [number(one) for one in found], wanted, rtol=1e-9, atol=1e-12)


def chance(*given):
    """From 0 to 1, of each four numbers another."""
    return float(np.modf(abs(math.sin(np.dot((12.9, 78.2, 37.7, 4.1), (*given, 0)[:4])) * 43758.5))[0])


def test_lobes_of_yarns():
    """Alphas as our engine's Metal has them in Cycles; Schlick's white share, less of wide lobes by the alpha in the eye's plane."""
    shape_of, build = module("metal_tree").shape_of, Numbers()
    for alphas in ((0.1, 0.4), (0.4, 0.1), (0.3, 0.3), (0.02, 0.9)):
        assert close(shade._shape(build, [alpha * alpha for alpha in alphas]), shape_of(*alphas)), alphas
    for cosine, turn in ((0.9, 0.0), (0.3, 0.0), (0.3, 0.5), (0.05, math.pi / 2), (1.0, 0.3)):
        sine = math.sqrt(1 - cosine * cosine)
        build.eye = (sine * math.cos(turn), sine * math.sin(turn), cosine)
        for along, across in ((0.2, 0.7), (0.7, 0.2), (0.5, 0.5)):
            alpha = math.sqrt((along * math.cos(turn))**2 + (across * math.sin(turn))**2) if sine else across
            found = shade._white(build, (along * along, across * across), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
            assert close(found, (1 - cosine)**5 / (1 + 5.9 * alpha**1.7)), (cosine, turn, along, across)
    build.eye = (0.6, 0.0, -0.8)  # from behind all is white, and no more than that
    assert close(build.white((0.0, 0.0, 1.0)), 1)


def test_shine_of_yarns():
    """As bright as in its own dye, in the colour of the new one, and never more than all."""
    def seen(color, dyed, plain, mean):
        return shade._shine(Numbers(), {"Warp Color": color, "Warp Dyed Shine": dyed, "Warp Plain Shine": plain, "Warp Shine": mean}, "Warp")
    found = number(seen((0.5, 0.25, 0.75), (0.2, 0.2, 0.4), (0.0, 0.0, 0.0), 0.3))
    assert np.allclose(found, 0.9 * np.array((0.1, 0.05, 0.3)) / 0.45, atol=1e-5) and abs(found.mean() - 0.3) < 1e-6
    assert close(seen((1, 0, 0), (0, 0, 0), (0.25, 0.25, 0.25), 0.04), [0.04] * 3)  # what does not go with the dye
    assert np.allclose(number(seen((1, 0, 0), (0.5, 0.5, 0.5), (0, 0, 0), 0.9)), (1, 0, 0), atol=1e-5)


def test_frames_of_yarns():
    """Weft along the tangent, warp across it, each in the plane of the folds' normal."""
    for normal, tangent in (((0, 0, 1), (1, 0, 0)), ((0.28, 0, 0.96), (1, 0, 0)), ((0, 0.6, 0.8), (0.6, 0.8, 0))):
        weft, warp = ([number(one) for one in frame] for frame in shade._frames(Numbers(), normal, (0.0, 0.0, 1.0), tangent))
        for x, y in (weft, warp):
            assert close(np.cross(x, y), normal) and close([np.linalg.norm(x), np.linalg.norm(y)], 1), (normal, tangent)
        side = np.cross((0, 0, 1), tangent)
        assert abs(np.dot(weft[0], side)) < 1e-12 < np.dot(weft[0], tangent), normal  # the weft stays over the tangent
        assert abs(np.dot(warp[1], tangent)) < 1e-12 < np.dot(warp[1], side), normal


def test_yarns_that_differ():
    """Each end by its own number, along v; each pick by its own, along u; both by other numbers, by amounts that Vary and Along have, on yarns alone."""
    def noise(u, v, is_warp, yarn=1.0, **amounts):
        none = (0.0, 0.0, 1.0)
        given = {"Crossing": (u, v, 0.0), **{f"{word} {what}": none for word in shade.YARNS for what in ("Vary", "Along")}, **{key.replace("_", " "): value for key, value in amounts.items()}}
        return [number(part) for part in shade._noise(Numbers(chance), given, is_warp, yarn)]
    of_yarn = {"Warp_Vary": (0.3, 0.2, 0.5), "Weft_Vary": (0.6, 0.4, 0.25)}
    ends, picks = ([noise(*at, is_warp, **of_yarn) for at in ((2.25, 3.5), (2.75, 8.5), (3.25, 3.5))] for is_warp in (1.0, 0.0))
    assert close(ends[0], ends[1]) and not np.isclose(ends[0], ends[2]).any() and not np.isclose(np.divide(ends[0], 0.5), picks[0]).any()
    assert close(picks[0], picks[2]) and not np.isclose(picks[0], picks[1]).any()
    assert close(ends[0], np.multiply((0.3, 0.2, 0.2), [2 * chance(2, 0, 4, k) - 1 for k in range(3)]))
    assert close(picks[0], np.multiply((0.6, 0.4, 0.4), [2 * chance(3, 0, 3, k) - 1 for k in range(3)]))
    assert close(noise(2.25, 3.5, 1.0, 0.5, **of_yarn), np.multiply(ends[0], 0.5)) and close(noise(2.25, 3.5, 0.0), (0, 0, 0))
    # along it: at each whole number of lengths another number, halfway the mean of both, level at either
    on_it = {"Warp_Vary": (0.0, 0.0, 0.5), "Weft_Vary": (0.0, 0.0, 0.25), "Warp_Along": (0.3, 0.2, 0.0), "Weft_Along": (0.6, 0.4, 0.0)}
    for is_warp, channel, length, yarn, amounts in ((1.0, 6, 2.0, (5.5, None), (0.3, 0.2, 0.2)), (0.0, 5, 4.0, (None, 5.5), (0.6, 0.4, 0.4))):
        at = lambda knots: noise(*(knots * length if part is None else part for part in yarn), is_warp, **on_it)
        knots = [np.multiply(amounts, [2 * chance(5, knot, channel, k) - 1 for k in range(3)]) for knot in (7, 8)]
        assert close(at(7.0), knots[0]) and close(at(8.0), knots[1]) and close(at(7.5), np.mean(knots, 0)), is_warp
        assert np.allclose(at(7.25), knots[0] + (3 * 0.25**2 - 2 * 0.25**3) * (knots[1] - knots[0]))


def test_slopes_of_yarns():
    """What the picture says, and what a yarn has of its own; at most .98, and as much darker as it hides of itself."""
    def tilt(red, green, blue, varied=(0.0, 0.0), is_warp=1.0):
        given = {"Tilt": (red, green, blue), "Crossing": (0.5, 0.5, 0.0)}
        for word in shade.YARNS:
            given |= {f"{word} Vary": (*varied, 1.0), f"{word} Along": (0.0, 0.0, 0.0)}
        return [number(part) for part in shade._tilt(Numbers(lambda *_at: 1.0), given, is_warp, 1.0)]
    assert close(tilt(0.5, 0.5, 0.4), (0, 0, 1, 0.4, 1))
    assert close(tilt(0.8, 0.1, 0.4), (0.6, -0.8, math.sqrt(1 - 0.98**2), 0.4 + 0.02, 1) * np.array((0.98, 0.98, 1, 1, 1)))
    assert close(tilt(0.65, 0.7, 0.45), (0.3, 0.4, math.sqrt(0.75), 0.45, 1))
    assert close(tilt(0.5, 0.5, 0.4, (-1.5, 0.0)), (0, 0, 1, 0.4, 0)) and close(tilt(0.5, 0.5, 0.4, (0.25, 0.0))[4], 1.25)  # no yarn is darker than black
    x, y, z, left, _bright = tilt(0.5, 0.5, 0.9, (0.0, 0.3))
    assert close((x, y, left), (0.3, 0.3, 0.9 - 0.3 * math.sqrt(2))) and close(x * x + y * y + z * z, 1)
    assert close(tilt(0.5, 0.5, 0.1, (0.0, 0.3))[3], 0) and close(tilt(1.0, 0.5, 1.0)[3], 1)


def test_which_way_a_yarn_leans():
    """Along a warp is y, across it x; along a weft x."""
    given = {"Tilt": (0.5, 0.5, 0.5), "Crossing": (0.5, 0.5, 0.0), **{f"{word} {what}": (0.0, 0.3 * (what == "Vary"), 1.0) for word in shade.YARNS for what in ("Vary", "Along")}}
    for is_warp, wanted in ((1.0, (0.3, -0.3)), (0.0, (-0.3, 0.3))):
        build = Numbers(lambda *at: {2: 1.0}.get(at[3], 0.0))  # the third number is across
        assert close(shade._tilt(build, given, is_warp, 1.0)[:2], wanted), is_warp


def test_slubs():
    """A width of 1 and up to so much more or less, within .05 and the crossing; its picture is as much wider, within half a texel of its neighbours'."""
    for noise, amount, most, wanted in ((1.0, 0.3, 2.0, 1.3), (0.0, 0.3, 2.0, 0.7), (0.5, 0.3, 2.0, 1.0), (1.0, 0.5, 1.25, 1.25), (0.0, 0.99, 2.0, 0.05)):
        assert close(place._width(Numbers(lambda *_at, noise=noise: noise), 3.0, 0.7, (amount, 0.5, most), 1.0), wanted), (noise, amount, most)
    asked = []
    number(place._width(Numbers(lambda *at: asked.append(at) or 0.5), 3.0, 8.0, (0.3, 0.5, 2.0), 2.0))
    assert asked == [(3, 4, 2), (3, 5, 2)] or sorted(set(asked)) == [(3, 4, 2), (3, 5, 2)], asked
    for at, width, wanted in ((3.5, 0.5, 3.5), (3.625, 0.5, 3.75), (3.25, 2.0, 3.375), (3.01, 0.5, 3 + 1 / 64), (3.99, 0.5, 4 - 1 / 64), (3.75, 1.0, 3.75)):
        assert close(place._seen_at(Numbers(), 3.0, at, width), wanted), (at, width)
    build = Numbers()
    assert [number(build.sign(x)) for x in (-2.0, 0.0, 3.0)] == [-1, 1, 1] and close(build.flat((3.0, 1.0, 5.0), (0.0, 0.0, 1.0)), np.divide((3, 1, 0), math.sqrt(10)))
    assert close(build.sum(((1, 2, 3), 2.0), ((1, 0, 0), -1.0), ((0, 1, 0), 0.5)), (1, 4.5, 6)) and close(build.lerp(2.0, 6.0, 0.25), 3) and close(build.lerp_vector((0, 4, 8), (4, 4, 0), 0.25), (1, 4, 6))


def test_points_of_scratches():
    """By bytes: of x and y 128 is exactly 0 and 1 and 255 are -1 and 1, normals are as long as 1; of height 255 is the surface, which is no scratch, 0 the deepest. A
    normal that leans is drawn out until its part along the surface's is 1."""
    tree = module("scratches.tree")

    class Image(Numbers):
        def new(self, kind, Vector):
            self.made = Of(outputs={"Color": np.array(self.bytes) / 255}, interpolation="Linear")
            assert kind == "TexImage" and Vector == "place"
            return self.made
        points = tree._Builder.points
    build = Image()
    for build.bytes, normal, height, mask in (((128, 128, 255), (0, 0, 1), 0, 0), ((128, 128, 254), (0, 0, 1), -1 / 255, 1), ((191.5, 128, 0), (0.5, 0, math.sqrt(0.75)), -1, 1),
                                              ((128, 51.8, 51), (0, -0.6, 0.8), -0.8, 1), ((255, 255, 255), (1, 1, 2 * math.sqrt(1e-4)), 0, 0)):
        found, deep, there = (number(one) for one in build.points("image", "place"))
        assert close(2 * found - 1, normal) and close(deep, height) and there == mask, build.bytes
        assert build.made.image == "image" and build.made.interpolation == "Closest"
    for normal, surface, wanted in (((0.6, 0, 0.8), (0, 0, 1), (0.75, 0, 1)), ((0, 0, 1), (0, 0, 1), (0, 0, 1)), ((0, 1, 0), (0, 0.8, 0.6), (0, 1.25, 0)), ((1, 0, -1), (0, 0, 1), (1000, 0, -1000))):
        assert close(tree.leaning(Numbers(), normal, surface), wanted), normal
    assert close(tree._Builder.mixed(Numbers(), 2.0, 6.0, 0.25), 3)


for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__, "done", flush=True)
print("all asserted")
common.finish()
