# SPDX-License-Identifier: GPL-3.0-or-later
"""What other renderers see of the scratches node: nothing, until images of one tile are baked; then these."""

from ..builder import Builder, shared
from ..groove import arrange, either
from ..group import new_socket

NAME = "Libshade Scratches"
_MARK = "libshade_scratches"  # on the tree that nodes without images share
VECTOR, AMOUNT, NORMAL = "Vector", "Amount", "Normal"
DENSITY, LENGTH, WIDTH, DEPTH, DIRECTION, SPREAD = (
    "Density per cm²", "Length mm", "Width mm", "Depth", "Direction", "Spread")
HEIGHT, MASK = "Height", "Mask"
_TURN = 6.2831853
_SMALL = 0.01  # slope by which places tell how they change
# Sockets with a number for all of the surface: key of the native module, least, most, at first, what it is.
NUMBERS = {
    DENSITY: ("density", 0.0, 1e6, 20.0, "How many there are on a square centimetre"),
    LENGTH: ("length", 1e-3, 1e4, 8.0, "In the mean; from half of it to one and a half"),
    WIDTH: ("width", 1e-3, 1e3, 0.03, "In the mean; from two thirds of it to one and a half"),
    DEPTH: ("depth", 0.0, 0.99, 0.15, "Of the middle, in halves of the width; from half of it to one and a half"),
    DIRECTION: ("direction", -100 * _TURN, 100 * _TURN, 0.0, "Of the scratches, from x of Vector towards y"),
    SPREAD: ("spread", 0.0, _TURN / 4, _TURN / 4, "As far to either side of the direction; 90 degrees: any way"),
}


def _add_sockets(tree):
    def add(name, kind, about, subtype="NONE", limits=None, value=None):
        socket = new_socket(tree, name, "INPUT", f"NodeSocket{kind}", subtype)
        if limits:
            socket.min_value, socket.max_value = limits
        if value is not None:
            socket.default_value = value
        socket.description = about
        return socket

    add(VECTOR, "Vector", "Where they lie: x and y; unlinked: a UV map, or the object's own coordinates").hide_value = True
    add(AMOUNT, "Float", "What their depth is multiplied by; may differ from place to place", "FACTOR", (0.0, 1.0), 1.0)
    for name, (_key, least, most, value, about) in NUMBERS.items():
        add(name, "Float", about, "ANGLE" if name in (DIRECTION, SPREAD) else "NONE", (least, most), value)
    add(NORMAL, "Vector", "What they are scratched into; unlinked: the surface's own").hide_value = True
    for name, kind, about in ((NORMAL, "Vector", "Scratched"), (HEIGHT, "Float", "In the scene's units: 0, and below 0 in scratches"),
                              (MASK, "Float", "1 in scratches, 0 beside them")):
        new_socket(tree, name, "OUTPUT", f"NodeSocket{kind}").description = about


def _fill(tree):
    _add_sockets(tree)
    given, answer = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    own = tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"]
    tree.links.new(either(tree, given.outputs[NORMAL], own), answer.inputs[NORMAL])


def plain():
    """The one without images: its normal is the one that comes in."""
    return shared(NAME, _MARK, _fill)


def is_plain(tree):
    return tree is None or bool(tree.get(_MARK))


class _Builder(Builder):
    """With what images of scratches need."""

    def image(self, image, place):
        node = self.new("TexImage", Vector=place)
        node.image = image
        return node.outputs["Color"]

    def points(self, image, place):
        """Normal (0 to 1), height (0 to -1), mask of an image that has x and y of normals, and heights."""
        node = self.new("TexImage", Vector=place)
        node.image, node.interpolation = image, "Closest"  # between points they would be flatter than they are
        x, y, height = self.parts(node.outputs["Color"])
        x, y = (self.math("MULTIPLY_ADD", part, 255 / 254, -1 / 254) for part in (x, y))
        lean = [self.math("SUBTRACT", part, 0.5) for part in (x, y)]
        flat = self.math("SUBTRACT", 0.25, self.math("ADD", *(self.math("MULTIPLY", part, part) for part in lean)))
        z = self.math("ADD", self.math("SQRT", self.math("MAXIMUM", flat, 1e-4)), 0.5)
        return (self.together(x, y, z), self.math("SUBTRACT", height, 1.0),
                self.math("LESS_THAN", height, 254.5 / 255))

    def by_side(self):
        """The object's coordinates along its faces: of x, y and z those two that a face looks at least."""
        place = self.parts(self.new("TexCoord").outputs["Object"])
        turned = self.new("VectorTransform", Vector=self.new("NewGeometry").outputs["True Normal"])
        turned.vector_type, turned.convert_from, turned.convert_to = "NORMAL", "WORLD", "OBJECT"
        x, y, z = self.parts(self.vector("ABSOLUTE", turned.outputs[0]))
        to_x = self.math("MULTIPLY", self.math("GREATER_THAN", x, y), self.math("GREATER_THAN", x, z))
        to_z = self.math("SUBTRACT", 1.0, self.math("GREATER_THAN", self.math("MAXIMUM", x, y), z))
        across = self.mixed(place["X"], place["Y"], to_x)
        return self.together(across, self.mixed(place["Z"], place["Y"], to_z))

    def gradient(self, height, surface, distance):
        """Of a height that changes evenly, along the surface, times the distance, which is to make it small. By heights and
        depths: what Cycles does to normals that turn far from the eye is the same for both, and goes."""
        up, down = (leaning(self, self.bump(height, distance, invert), surface) for invert in (False, True))
        return self.vector("SCALE", self.vector("SUBTRACT", down, up), 0.5)

    def bump(self, height, distance, invert):
        node = self.new("Bump", Strength=1.0, Distance=distance, Height=height)
        node.invert = invert
        return node.outputs[0]

    def mixed(self, a, b, share):
        return self.math("MULTIPLY_ADD", self.math("SUBTRACT", b, a), share, a)


def leaning(build, normal, surface):
    """Its length along the surface's normal is 1: what is left of it are slopes."""
    up = build.math("MAXIMUM", build.vector("DOT_PRODUCT", normal, surface), 1e-3)
    return build.vector("SCALE", normal, build.math("DIVIDE", 1.0, up))


def _slopes(build, normal, at, surface, distance):
    """What a picture's normals add to the surface's, by how the place on the picture changes along it; but for how much larger
    that is all in all: scratches on what is scaled grow deeper as they grow wider."""
    x, y, z = build.parts(build.vector("MULTIPLY_ADD", normal, (2.0,) * 3, (-1.0,) * 3))
    where = build.parts(at)
    along, up = (build.gradient(where[axis], surface, distance) for axis in "XY")
    area = build.vector("LENGTH", build.vector("CROSS_PRODUCT", along, up))
    by = build.math("DIVIDE", 1.0, build.math("MULTIPLY", build.math("SQRT", build.math("MAXIMUM", area, 1e-12)), z))
    seen = build.math("MULTIPLY_ADD", build.new("NewGeometry").outputs["Backfacing"], -2.0, 1.0)
    by = build.math("MULTIPLY", by, seen)
    return build.vector("ADD", *(build.vector("SCALE", axis, build.math("MULTIPLY", slope, by))
                                 for axis, slope in ((along, x), (up, y))))


def baked(images, place, scale, uv_map, tile, unit, deepest=None):
    """A tree that shows images (normal, height, mask) of a tile. tile, unit: metres of it, and in one of the scene's.
    deepest: of one image of points, as images.py makes it, metres that its level 0 is below the surface; else None.

    place: VECTOR, what comes in; UV, that of a UV map's; OBJECT, of the object's own. scale: tiles in a unit of it.
    uv_map: whose tangents the normals are of; None: what Vector says has others.
    """
    tree = plain().copy()
    del tree[_MARK]
    tree.name = f".{NAME} (images)"
    tree.nodes.clear()
    build = _Builder(tree)
    given, answer = tree.nodes.new("NodeGroupInput").outputs, tree.nodes.new("NodeGroupOutput").inputs
    surface = build.new("NewGeometry").outputs["Normal"]
    if place == "VECTOR":
        at = given[VECTOR]
    elif place == "OBJECT":
        at = build.by_side()
    else:
        where = build.new("UVMap")
        where.uv_map, at = uv_map or "", where.outputs[0]
    at = build.vector("SCALE", at, scale)
    if deepest:
        normal, height, mask = build.points(images[0], at)
        height = build.math("MULTIPLY", height, deepest / unit)
    else:
        normal, height, mask = (build.image(image, at) for image in images)
        height = build.math("MULTIPLY", height, 1.0 / unit)
    amount = build.math("MAXIMUM", given[AMOUNT], 0.0)
    if uv_map is None:
        slopes = _slopes(build, normal, at, surface, _SMALL * tile / unit)
    else:
        read = build.new("NormalMap", Color=normal)
        read.uv_map = uv_map
        slopes = build.vector("SUBTRACT", leaning(build, read.outputs[0], surface), surface)
    slopes = build.vector("SCALE", slopes, amount)
    base = leaning(build, either(tree, given[NORMAL], surface), surface)
    tree.links.new(build.vector("NORMALIZE", build.vector("ADD", base, slopes)), answer[NORMAL])
    tree.links.new(build.math("MULTIPLY", height, amount), answer[HEIGHT])
    mask = build.math("MULTIPLY", mask, build.math("MINIMUM", amount, 1.0))
    tree.links.new(mask, answer[MASK])
    arrange(tree)
    return tree
