# SPDX-License-Identifier: GPL-3.0-or-later
"""The Sky Texture of a world, as numbers that the native module makes a sky of."""

import math

from mathutils import Matrix, Vector

from .. import versions, working_space

_SMALLEST = 0.0005  # disc [Cycles 3.4, 5.0]
_SCATTERING = {"NISHITA": "SINGLE", "SINGLE_SCATTERING": "SINGLE", "MULTIPLE_SCATTERING": "MULTIPLE"}


def sky_of(reader, node, strength, matrix):
    """`matrix`: of a direction to that in the sky, whose sun the node's settings place."""
    if not _turns(matrix):
        reader.warn(f"'{node.name}': coordinates that are not only turned are not supported; directions are "
                    "used as they are")
        matrix = Matrix.Identity(4)
    if node.sky_type in _SCATTERING:
        model, elevation, azimuth = _scattering(node)
    else:
        model, elevation, azimuth = _fitted(reader, node)
    turned = Matrix.Rotation(-azimuth, 4, "Z") @ matrix
    return {"strength": (max(strength, 0.0),) * 3, "elevation": elevation,
            "matrix": [value for row in turned[:3] for value in row], **model,
            **working_space.told("rgb", working_space.from_xyz())}


def _finite(angle):
    return angle if math.isfinite(angle) else 0.0


def _turns(matrix):
    axes = matrix.to_3x3()
    off = axes @ axes.transposed() - Matrix.Identity(3)
    return max(abs(v) for row in off for v in row) < 1e-4 and matrix.translation.length < 1e-6


def _scattering(node):
    """(settings, elevation, the sun's angle from the x axis)"""
    elevation = math.remainder(_finite(node.sun_elevation), 2 * math.pi)
    azimuth = math.pi / 2 - _finite(node.sun_rotation)
    if abs(elevation) > math.pi / 2:  # over the zenith and down again
        elevation, azimuth = math.copysign(math.pi, elevation) - elevation, azimuth + math.pi
    size = max(node.sun_size, _SMALLEST) if node.sun_disc else 0.0
    dust = node.aerosol_density if hasattr(node, "aerosol_density") else node.dust_density
    return {"model": _SCATTERING[node.sky_type], "altitude": node.altitude, "air": node.air_density, "dust": dust,
            "ozone": node.ozone_density, "later": versions.LATER_SKY, "sun_size": size,
            "sun_bright": node.sun_intensity}, elevation, azimuth


def _fitted(reader, node):
    if node.sky_type != "PREETHAM":
        reader.warn(f"'{node.name}': sky type '{node.sky_type}' is not supported; that of Preetham is used")
    to = Vector(map(_finite, node.sun_direction)).normalized()
    return ({"model": "PREETHAM", "turbidity": node.turbidity}, math.asin(max(-1.0, min(1.0, to.z))),
            math.atan2(to.y, to.x))
