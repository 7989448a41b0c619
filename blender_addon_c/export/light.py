# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights: one function for each kind that the native module knows."""

import math

import numpy as np

from . import tree


def kinds(join):
    """The kinds that are known, for a text."""
    return f" {join} ".join(name.lower() for name in _LIGHTS)


def light_of(ob, matrix, messages):
    """The light of an object, in a list; empty where its kind is not known."""
    light = ob.data
    strength = _strength(light, messages)
    if light.type not in _LIGHTS:
        messages.warning(f"light '{ob.name}': {light.type.lower()} lights are not supported, "
                         f"only {kinds('and')}")
        return []
    return [{"name": ob.name, "type": light.type, "shadow": light.use_shadow,
             **_LIGHTS[light.type](light, matrix, strength)}]


def _sun(light, matrix, strength):
    """A sun's strength is its irradiance, in W/m²."""
    return {"irradiance": strength, "angle": light.angle,
            "direction": tuple(matrix.to_3x3().col[2].normalized())}


def _point(light, matrix, strength):
    """A point light's power, in W, spreads evenly over the sphere."""
    return {"intensity": tuple(s / (4.0 * math.pi) for s in strength),
            "position": tuple(matrix.translation), "radius": light.shadow_soft_size}


_LIGHTS = {"SUN": _sun, "POINT": _point}  # as in the native module's table


def _strength(light, messages):
    """Energy × colour, linear RGB, in the light's own unit: W/m² (sun) or W."""
    owner = f"light '{light.name}'"
    scale = light.energy * 2.0 ** getattr(light, "exposure", 0.0)  # exposure: from 4.5 on
    factors = [light.color]
    if getattr(light, "use_temperature", False):
        factors.append(light.temperature_color)
    if not getattr(light, "normalize", True):
        messages.warning(f"{owner}: power by area (Normalize off) is not supported")
    if tree.of(light):
        color, strength = tree.emission(tree.of(light), "EMISSION", owner, messages, 1.0)
        factors.append(color)
        scale *= strength
    return tuple(scale * value for value in np.prod([tuple(f) for f in factors], axis=0))
