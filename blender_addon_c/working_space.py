# SPDX-License-Identifier: GPL-3.0-or-later
"""Which colours a file's numbers mean, by its working space: from 5.0 on it may be another than linear Rec. 709; before, as
a configuration of OpenColorIO says. What has colours of its own (presets, black bodies, skies) brings them there."""

from mathutils import Color

LUMINANCE = (0.2126, 0.7152, 0.0722)  # of Rec. 709
XYZ_TO_REC709 = ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560),  # D65
                 (0.0556434, -0.2040259, 1.0572252))
_UNITS = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_SAME = 1e-4  # Blender's own matrices for Rec. 709 are not quite the identity


def from_rec709():
    """The matrix, by rows, of linear Rec. 709 to the file's working space; None where that is the same."""
    rows = tuple(zip(*(Color(unit).from_rec709_linear_to_scene_linear() for unit in _UNITS)))
    if all(abs(part - same) < _SAME for row, units in zip(rows, _UNITS) for part, same in zip(row, units)):
        return None
    return rows


def here(color):
    """A colour of linear Rec. 709 in the file's working space."""
    return times(from_rec709(), color)


def times(matrix, color):
    """None: as it is."""
    return tuple(_dot(row, color) for row in matrix) if matrix else tuple(color)


def from_xyz():
    """The matrix, by rows, of XYZ to the file's working space; None where that is Rec. 709."""
    matrix = from_rec709()
    return matrix and tuple(times(zip(*XYZ_TO_REC709), row) for row in matrix)


def told(key, matrix):
    """A matrix as the native module takes it, which without one takes Rec. 709."""
    return {key: [part for row in matrix for part in row]} if matrix else {}


def luminance():
    """How much of it a file's red, green and blue have."""
    if not from_rec709():
        return LUMINANCE
    return tuple(Color(unit).from_scene_linear_to_xyz_d65()[1] for unit in _UNITS)


def _dot(a, b):
    return sum(one * other for one, other in zip(a, b))
