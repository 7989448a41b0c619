# SPDX-License-Identifier: GPL-3.0-or-later
"""Where on a cloth a point is, by plain nodes: a group that all cloth nodes of a file share. As native/node/weave.h
has it, but for the change of Vector along the surface, which Bump nodes tell here."""

import math

from ..builder import Builder, shared
from ..groove import either
from ..group import new_socket

NAME = "Libshade Cloth Place"
_MARK = "libshade_cloth_place"
_EDGE = 1 / 64  # of a crossing: half a texel, within which neighbours are mixed in
SLUBS = ("Warp Slub", "Weft Slub")  # relative variation of width, 1 / length of it, largest width
_LEAST_WIDTH = 0.05


def add_sockets(tree, inputs, outputs):
    """By name: kind, or kind and value."""
    for name, kind, *value in inputs:
        socket = new_socket(tree, name, "INPUT", f"NodeSocket{kind}")
        if value:
            socket.default_value = value[0]
    for name, kind in outputs:
        new_socket(tree, name, "OUTPUT", f"NodeSocket{kind}")


class Formulas(Builder):
    """With what formulas of cloth repeat."""

    def floor(self, x):
        return self.math("FLOOR", x)

    def lerp(self, a, b, share):
        return self.math("MULTIPLY_ADD", self.math("SUBTRACT", b, a), share, a)

    def lerp_vector(self, a, b, share):
        return self.vector("ADD", a, self.vector("SCALE", self.vector("SUBTRACT", b, a), share))

    def sum(self, *scaled):
        """Of pairs (vector, number)."""
        parts = [self.vector("SCALE", *pair) for pair in scaled]
        while len(parts) > 1:
            parts[:2] = [self.vector("ADD", *parts[:2])]
        return parts[0]

    def random(self, number, knot, channel, output="Value"):
        """From 0 to 1."""
        noise = self.new("TexWhiteNoise", Vector=self.together(number, knot, channel))
        noise.noise_dimensions = "3D"
        return noise.outputs[output]

    def along(self, number, place, channel, output="Value"):
        """Random numbers at whole numbers of `place`, joined by cubics that are level there: noise of the kind that
        libshade has along yarns."""
        knot = self.floor(place)
        t = self.math("SUBTRACT", place, knot)
        share = self.math("MULTIPLY", self.math("MULTIPLY", t, t), self.math("MULTIPLY_ADD", t, -2.0, 3.0))
        ends = [self.random(number, k, channel, output) for k in (knot, self.math("ADD", knot, 1.0))]
        return (self.lerp if output == "Value" else self.lerp_vector)(*ends, share)

    def toward(self, height, normal):
        """Along the surface, where a number grows."""
        bump = self.new("Bump", Strength=1.0, Distance=1.0, Height=height)
        if "Filter Width" in bump.inputs:
            bump.inputs["Filter Width"].default_value = 0.1
        bumped = bump.outputs[0]
        up = self.vector("SCALE", normal, self.vector("DOT_PRODUCT", normal, bumped))
        return self.vector("NORMALIZE", self.vector("SUBTRACT", up, bumped))

    def flat(self, tangent, normal):
        """What lies in the surface of it, of length 1."""
        off = self.vector("SCALE", normal, self.vector("DOT_PRODUCT", normal, tangent))
        return self.vector("NORMALIZE", self.vector("SUBTRACT", tangent, off))

    def sign(self, x):
        return self.math("MULTIPLY_ADD", self.math("LESS_THAN", x, 0.0), -2.0, 1.0)


def _width(build, number, place, slub, channel):
    """Of a yarn there, beside what it is in the mean."""
    amount, per_length, most = build.parts(slub)
    noise = build.along(number, build.math("MULTIPLY", place, per_length), channel)
    width = build.math("MULTIPLY_ADD", build.math("MULTIPLY_ADD", noise, 2.0, -1.0), amount, 1.0)
    return build.math("MINIMUM", build.math("MAXIMUM", width, _LEAST_WIDTH), most)


def _seen_at(build, number, place, width):
    """Where on the picture of a yarn of even width: nearer to its middle where it is wide."""
    across = build.math("SUBTRACT", build.math("SUBTRACT", place, number), 0.5)
    across = build.math("ADD", build.math("DIVIDE", across, width), 0.5)
    return build.math("ADD", number, build.math("MINIMUM", build.math("MAXIMUM", across, _EDGE), 1 - _EDGE))


def _fill(tree):
    add_sockets(tree, [("Vector", "Vector"), ("Scale", "Float", 1.0), ("Rotation", "Float"), ("Metres", "Float", 1.0),
                       ("Per Unit", "Vector"), ("Per Crossing", "Vector"), *((name, "Vector") for name in SLUBS)],
                [("Place", "Vector"), ("Crossing", "Vector"), ("Tangent", "Vector")])
    given, answer = tree.nodes.new("NodeGroupInput").outputs, tree.nodes.new("NodeGroupOutput").inputs
    build = Formulas(tree)
    surface = build.new("NewGeometry").outputs
    normal = surface["Normal"]
    # nothing linked to Vector is 0
    missing = build.math("LESS_THAN", build.vector("LENGTH", given["Vector"]), 1e-12)
    at = build.vector("ADD", given["Vector"], build.vector("SCALE", build.new("UVMap").outputs[0], missing))
    x, y, _z = build.parts(at)
    map_ = build.new("Tangent")
    map_.direction_type = "UV_MAP"
    axis = build.lerp_vector(build.toward(x, normal), either(tree, map_.outputs[0], surface["Tangent"]), missing)
    axis = build.flat(axis, normal)
    side = build.vector("CROSS_PRODUCT", normal, axis)
    # v counts the other way where the map is mirrored, or seen from behind
    turned = build.sign(build.vector("DOT_PRODUCT", side, build.toward(y, normal)))
    angle = build.math("MULTIPLY", given["Rotation"], 2 * math.pi)
    cosine, sine = build.math("COSINE", angle), build.math("SINE", angle)
    size = build.math("MULTIPLY", given["Scale"], given["Metres"])
    flip = build.sign(size)
    tangent = build.sum((axis, build.math("MULTIPLY", cosine, flip)),
                        (side, build.math("MULTIPLY", build.math("MULTIPLY", sine, turned), flip)))
    per_u, per_v, _ = build.parts(given["Per Unit"])
    u = build.math("ADD", build.math("MULTIPLY", cosine, x), build.math("MULTIPLY", sine, y))
    v = build.math("SUBTRACT", build.math("MULTIPLY", cosine, y), build.math("MULTIPLY", sine, x))
    u = build.math("MULTIPLY", build.math("MULTIPLY", u, size), per_u)
    v = build.math("MULTIPLY", build.math("MULTIPLY", build.math("MULTIPLY", v, size), per_v), turned)
    end, pick = build.floor(u), build.floor(v)
    seen = build.together(_seen_at(build, end, u, _width(build, end, v, given[SLUBS[0]], 1.0)),
                          _seen_at(build, pick, v, _width(build, pick, u, given[SLUBS[1]], 2.0)))
    tree.links.new(build.vector("MULTIPLY", seen, given["Per Crossing"]), answer["Place"])
    tree.links.new(build.together(u, v), answer["Crossing"])
    tree.links.new(tangent, answer["Tangent"])


def place_tree():
    return shared(NAME, _MARK, _fill)
