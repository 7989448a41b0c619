# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that look numbers up: curves, and colours of temperatures and wavelengths."""

import math
from array import array

from .. import working_space
from .graph import is_known
from .value import each, number_in, vector_in

_STEPS = 255  # of a curve's table, as Cycles has it


def _curve(reader, table, low, high, at, extend):
    """What a table says at a number or register."""
    if not is_known(at):
        return reader.program.emit("CURVE", 1, table=array("f", table), low=low, high=high, at=[at], extend=extend)[0]
    last = len(table) - 1
    place = (at - low) / (high - low) * last if high > low else 0.0
    place = place if math.isfinite(place) else 0.0
    place = place if extend else min(max(place, 0.0), last)
    k = int(min(max(place, 0.0), last - 1))
    return table[k] + (place - k) * (table[k + 1] - table[k])


def _range(curves):
    """Of all points of some curves."""
    ends = [curve.points[k].location[0] for curve in curves for k in (0, len(curve.points) - 1)]
    low, high = (min(max(end, -1e6), 1e6) for end in (min(ends), max(ends)))
    return low, high, [low + k / _STEPS * (high - low) for k in range(_STEPS + 1)]


def _mapping(node):
    mapping = node.mapping
    mapping.update()
    mapping.initialize()
    return mapping, list(mapping.curves), mapping.extend == "EXTRAPOLATED"


def _bent(reader, found, name):
    """Of three numbers each by its own curve; those of colours lie behind a fourth of them all."""
    mapping, curves, extend = _mapping(found.node)
    color = len(curves) > 3
    low, high, places = _range(curves)
    first = [mapping.evaluate(curves[3], x) for x in places] if color else places
    given = vector_in(reader, found, name)
    made = tuple(_curve(reader, [mapping.evaluate(curve, x) for x in first], low, high, part, extend)
                 for curve, part in zip(curves, given))
    return each(reader, "MIX", given, made, (number_in(reader, found, 0),) * 3)


def _curve_float(reader, found):
    mapping, (curve, *_), extend = _mapping(found.node)
    low, high, places = _range([curve])
    given = number_in(reader, found, "Value")
    made = _curve(reader, [mapping.evaluate(curve, x) for x in places], low, high, given, extend)
    return (reader.program.math("MIX", given, made, number_in(reader, found, "Factor")),)


# Colour of a black body of luminance 1, Rec. 709: from a temperature on, red and green are
# a / t + b t + c, blue is a polynomial: forms and stretches are those of Cycles, the numbers fitted to
# what its 3.4 and 5.0 say, within 1e-6; below 0 to what 5.0 says in ACEScg.
_HOT = (
    (800, (1.61919904e3, -2.05009840e-3, 5.02993546), (-4.89000435e2, 6.04331602e-4, -7.55807255e-2),
     (5.96956143e-11, -4.85775200e-8, -9.70589815e-5, -4.08027840e-3)),
    (965, (2.48845963e3, -1.11330365e-3, 3.22620128), (-7.55996349e2, 3.16728013e-4, 4.78311388e-1),
     (2.40418399e-11, 5.55054975e-8, -1.98506880e-4, 2.89324409e-2)),
    (1167, (3.34143542e3, -4.86547851e-4, 1.76485734), (-1.02363772e3, 1.20224200e-4, 9.36660739e-1),
     (-1.40967767e-11, 1.89886063e-7, -3.56642210e-4, 9.10811000e-2)),
    (1449, (4.09461719e3, -1.27445192e-4, 7.25726750e-1), (-1.26571216e3, 4.87329612e-6, 1.27054539),
     (-3.61442852e-11, 2.84812698e-7, -4.93195701e-4, 1.56715038e-1)),
    (1902, (4.67027623e3, 2.91259195e-5, 1.26703007e-1), (-1.42529187e3, -4.01150812e-5, 1.43972777),
     (-1.97075876e-11, 1.75359351e-7, -2.50542214e-4, -2.22790294e-2)),
    (3315, (4.59508698e3, 2.87495870e-5, 1.50345094e-1), (-1.17554688e3, -2.16378194e-5, 1.30408018),
     (-1.61988666e-13, -1.64217740e-8, 3.86217323e-4, -7.38078413e-1)),
    (6365, (3.78717080e3, 9.35908811e-6, 3.99075851e-1), (-5.00799159e2, -4.59832628e-6, 1.09098771),
     (6.72652331e-13, -2.73079347e-8, 4.24098667e-4, -7.52335603e-1)),
)
_COLDEST, _HOTTEST, _KELVINS = 800.0, 12000.0, 4096
_HOTTER = [0.8262955, 0.99450803, 1.56630766]


def _glow(t, space):
    """Nothing below 0. space: the working one, as a matrix from Rec. 709."""
    if t >= _HOTTEST:
        return [max(part, 0.0) for part in working_space.times(space, _HOTTER)]
    t = max(t, _COLDEST)
    _, red, green, blue = max((row for row in _HOT if row[0] <= t), key=lambda row: row[0])
    warm = [a / t + b * t + c for a, b, c in (red, green)]
    rec709 = *warm, ((blue[0] * t + blue[1]) * t + blue[2]) * t + blue[3]
    return [max(part, 0.0) for part in working_space.times(space, rec709)]


def _blackbody(reader, found):
    t, space = number_in(reader, found, "Temperature"), working_space.from_rec709()
    if is_known(t):
        return tuple(_glow(t, space))
    step = (_HOTTEST - _COLDEST) / (_KELVINS - 1)
    tables = zip(*(_glow(_COLDEST + k * step, space) for k in range(_KELVINS)))
    return tuple(_curve(reader, table, _COLDEST, _HOTTEST, t, False) for table in tables)


# The CIE's standard observer of 1931, 380 to 780 nm in steps of 5, in units of 1e-4.
_OBSERVER = tuple(tuple(map(int, row.split())) for row in (
    """14 22 42 76 143 232 435 776 1344 2148 2839 3285 3483 3481 3362 3187 2908 2511 1954 1421 956 580 320 147
       49 24 93 291 633 1096 1655 2257 2904 3597 4334 5121 5945 6784 7621 8425 9163 9786 10263 10567 10622 10456
       10026 9384 8544 7514 6424 5419 4479 3608 2835 2187 1649 1212 874 636 468 329 227 158 114 81 58 41 29 20 14
       10 7 5 3 2 2 1 1 1 0""",
    """0 1 1 2 4 6 12 22 40 73 116 168 230 298 380 480 600 739 910 1126 1390 1693 2080 2586 3230 4073 5030 6082
       7100 7932 8620 9149 9540 9803 9950 10000 9950 9786 9520 9154 8700 8163 7570 6949 6310 5668 5030 4412 3810
       3210 2650 2170 1750 1382 1070 816 610 446 320 232 170 119 82 57 41 29 21 15 10 7 5 4 2 2 1 1 1 0 0 0 0""",
    """65 105 201 362 679 1102 2074 3713 6456 10391 13856 16230 17471 17826 17721 17441 16692 15281 12876 10419
       8130 6162 4652 3533 2720 2123 1582 1117 782 573 422 298 203 134 87 57 39 27 21 18 17 14 11 10 8 6 3 2 2 1
       0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"""))
_BRIGHTEST = 2.52


def _wavelength(reader, found):
    """Nothing beyond both ends."""
    at = number_in(reader, found, "Wavelength")
    made = []
    for row in working_space.from_xyz() or working_space.XYZ_TO_REC709:
        table = [0.0, *(1e-4 / _BRIGHTEST * sum(by * part for by, part in zip(row, xyz))
                        for xyz in zip(*_OBSERVER)), 0.0]
        made.append(reader.program.math("MAXIMUM", _curve(reader, table, 375.0, 785.0, at, False), 0.0))
    return tuple(made)


NODES = {
    "CURVE_RGB": lambda reader, found: _bent(reader, found, "Color"),
    "CURVE_VEC": lambda reader, found: _bent(reader, found, "Vector"),
    "CURVE_FLOAT": _curve_float, "BLACKBODY": _blackbody, "WAVELENGTH": _wavelength,
}
