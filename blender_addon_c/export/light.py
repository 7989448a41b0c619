# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights: one function for each kind that the native module knows. Units, shapes and shares are
those of the Cycles of the Blender that runs."""

import math

import numpy as np

from .. import versions
from . import tree
from .around import Shine, stretch_of, turn_of
from .graph import TooLarge
from .visibility import BOUNCED, is_hidden, of_both


def kinds(join):
    """The kinds that are known, for a text."""
    return f" {join} ".join(name.lower() for name in _LIGHTS)


def light_of(ob, maker, matrix, links, table, messages):
    """The light of an object, in a list; empty where its kind is not known. maker: what instances it, or None."""
    light = ob.data
    if light.type not in _LIGHTS:  # hemispheres of old files and of importers have no name any more, nor a strength
        messages.warning(f"light '{ob.name}': {light.type.lower() or 'hemi'} lights are not supported, "
                         f"only {kinds('and')}")
        return []
    strength, pattern = _strength(light, matrix, table, messages)
    bits = of_both(ob, None if versions.LAMPS_ALONE else maker, BOUNCED)  # the camera never sees lamps, whatever the object says
    if is_hidden(bits, *BOUNCED):
        return []
    cycles = getattr(light, "cycles", None)
    if getattr(cycles, "is_portal", False):
        messages.warning(f"light '{ob.name}': portals are not supported; left out")
        return []
    shadow = getattr(cycles, "cast_shadow", light.use_shadow)  # until 4.1 Cycles' own
    met = getattr(cycles, "use_multiple_importance_sampling", True)
    return [{"name": ob.name, "type": light.type, "shadow": shadow, "met": met, "hidden": bits,
             **links.of_light(ob), **pattern, **_LIGHTS[light.type](light, matrix, strength)}]


class Links:
    """From 4.0 on a lamp, or an object that shines, may be for some objects alone, and be shaded by some alone.
    `of_light`, for all, then what each object does not get."""

    def __init__(self, messages):
        self._lit = _Sets("link", "receiver", "light linking", "it lights all", messages)
        self._shaded = _Sets("shade", "blocker", "shadow linking", "all shade it", messages)

    def of_light(self, ob):
        """Its bits, where it is not for all."""
        return {**self._lit.of_light(ob), **self._shaded.of_light(ob)}

    def of_object(self, ob, parent):
        """What does not light it and what it does not shade, nor, if that has no say, its instancer."""
        unlit, shadeless = self._lit.of_object(ob, parent), self._shaded.of_object(ob, parent)
        return {**({"unlit": unlit} if unlit else {}), **({"shadeless": shadeless} if shadeless else {})}


class _Sets:
    """Collections of objects that lights name, as bits."""

    _MOST = 30  # as in the native module

    def __init__(self, word, kind, name, otherwise, messages):
        self._word, self._kind, self._name, self._otherwise, self._messages = word, f"{kind}_collection", name, otherwise, messages
        self._bits, self._some, self._without = {}, [], []

    def of_light(self, ob):
        linking = getattr(ob.original, "light_linking", None)
        collection = linking and getattr(linking, self._kind)
        if not collection:
            return {}
        if collection not in self._bits:
            if len(self._some) == self._MOST:
                what = "light" if ob.type == "LIGHT" else "object"
                self._messages.warning(f"{what} '{ob.name}': the {self._name} of {self._MOST} sets of lights is "
                                       f"supported; {self._otherwise}")
                return {}
            included, excluded = _receivers(collection)
            self._bits[collection] = len(self._some)
            self._some.append(included)
            self._without.append(excluded)
        return {self._word: self._bits[collection]}

    def of_object(self, ob, parent):
        bits = 0
        for k, (some, without) in enumerate(zip(self._some, self._without)):
            mine = {ob.original, *([parent.original] if parent else ())}
            bits |= ((bool(some) and not mine & some) or bool(mine & without)) << k
        return bits


def _receivers(collection):
    """(objects that it is for, none: all others; those that it is not for)."""
    sets = {"INCLUDE": set(), "EXCLUDE": set()}
    for ob, how in zip(collection.objects, collection.collection_objects):
        sets[how.light_linking.link_state].add(ob)
    for child, how in zip(collection.children, collection.collection_children):
        sets[how.light_linking.link_state].update(child.all_objects)
    return sets["INCLUDE"], sets["EXCLUDE"]


def name_shading(ob, mesh, table, messages):
    """What shines is shaded by some alone where light samples find it: even light of what keeps still. mesh: None where
    none do."""
    linking = getattr(ob.original, "light_linking", None)
    if linking and linking.blocker_collection and not (mesh and table.shines_evenly(mesh)):
        messages.warning(f"object '{ob.name}': shadow linking of what shines unevenly, moves or is hidden from some "
                         "rays is not supported; all objects shade its light")


def _sun(light, matrix, strength):
    """A sun's strength is its irradiance, in W/m², or the radiance of its disc."""
    sine = math.sin(min(light.angle, math.pi) / 2)
    if not _normalized(light) and sine > 0:
        strength = _times(strength, math.pi * sine * sine)
    return {"irradiance": strength, "angle": light.angle, "even": not versions.OLD_LAMPS,
            "direction": _unit(matrix.to_3x3().col[2])}


def _bulb(light, matrix, strength):
    """Power, in W, spreads evenly over the sphere; or power a square metre, over a ball's."""
    scale = 1.0 / (4.0 * math.pi)
    if not _normalized(light):
        scale = light.shadow_soft_size**2 or 1.0 / math.pi
    return {"intensity": _times(strength, scale), "position": tuple(matrix.translation),
            "radius": light.shadow_soft_size, "ball": not getattr(light, "use_soft_falloff", True)}


def _spot(light, matrix, strength):
    return {**_bulb(light, matrix, strength), **_cone(matrix), "angle": light.spot_size,
            "blend": light.spot_blend, "cosine_law": versions.OLD_LAMPS}


def _cone(matrix):
    """Where a spot shines. Its object's scale makes the cone wide or narrow, but not in 3.4."""
    x, y, z = matrix.to_3x3().col
    across = {}
    if not versions.OLD_LAMPS and min(x.length, y.length, z.length) > 1e-6:
        across = {"across_u": tuple(x.normalized() * z.length / x.length),
                  "across_v": tuple(y.normalized() * z.length / y.length)}
    return {"direction": _unit(-z), **across}


def _face_of(light):
    """(width, height) of an area lamp before it is scaled; None of others, and of one that is a point."""
    if light.type != "AREA":
        return None
    size = light.size, light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    return size if min(size) > 0 else None


def _area(light, matrix, strength):
    """Power, in W, spreads by the cosine over a half sphere; or power a square metre."""
    x, y, z = matrix.to_3x3().col
    size = light.size, light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    u, v = (tuple(0.5 * length * a for a in axis) for length, axis in zip(size, (x, y)))
    round_ = light.shape in {"DISK", "ELLIPSE"}
    scale = 0.25 if versions.OLD_LAMPS else 1.0 / math.pi
    if not _normalized(light):
        area = np.linalg.norm(np.cross(u, v)) * (math.pi if round_ else 4.0)
        scale = area / math.pi
    return {"intensity": _times(strength, scale), "position": tuple(matrix.translation),
            "axis_u": u, "axis_v": v, "direction": _unit(-z), "spread": light.spread,
            "round": round_}


_LIGHTS = {"SUN": _sun, "POINT": _bulb, "SPOT": _spot, "AREA": _area}  # as in the native module


def _times(color, factor):
    return tuple(float(c * factor) for c in color)


def _unit(axis):
    """Its direction; of an object of no size, up."""
    return tuple(axis.normalized()) if axis.length > 1e-20 else (0.0, 0.0, 1.0)


def _normalized(light):
    """Is its strength that of the whole light, whatever its size? Can be chosen from 4.5 on."""
    return getattr(light, "normalize", True)


def _strength(light, matrix, table, messages):
    """(energy × colour, linear RGB, in the light's own unit: W/m² (sun) or W; its pattern, where it shines unevenly)"""
    scale = light.energy * 2.0 ** getattr(light, "exposure", 0.0)  # exposure: from 4.5 on
    factors, pattern = [light.color], None
    if getattr(light, "use_temperature", False):
        factors.append(light.temperature_color)
    if tree.of(light):
        shared, own = (light, stretch_of(matrix)), (light, tuple(map(tuple, matrix)))
        key = own if own in table.shines else shared
        if key not in table.shines:
            shine, placed = _shine(light, matrix, table, messages)
            key = own if placed else shared
            table.shines[key] = shine
        color, pattern = table.shines[key]
        factors.append(color)
    if pattern:
        pattern = {"pattern": {**pattern, "axes": [part for axis in turn_of(matrix).col for part in axis]}}
    return tuple(scale * value for value in np.prod([tuple(f) for f in factors], axis=0)), pattern or {}


def _shine(light, matrix, table, messages):
    """(what its nodes make of it: a colour, and a pattern or None; does it ask where the object is?)"""
    own, owner = tree.of(light), f"light '{light.name}'"
    table.unknown.name(own, lambda text: messages.warning(f"{owner}: {text}"))
    shader = tree.shader_of(own)
    if not shader or not shader.node:
        return ((0.0,) * 3, None), False
    try:
        shine = Shine(own, owner, table, messages, lamp=(light.type, matrix, _face_of(light)))
        if shine.mixed:
            messages.warning(f"{owner}: nodes that make it uneven by direction and over its face at once are not supported; "
                             "all of its face is as its middle")
            shine = Shine(own, owner, table, messages, lamp=(light.type, matrix))
        if not shine.there and shader.node.type != "EMISSION":
            messages.warning(f"{owner}: '{shader.node.name}' is not supported; its nodes are left out")
            return ((1.0,) * 3, None), False
        return (shine.pattern() if shine.turns else (shine.color, shine.even())), shine.placed
    except (RecursionError, TooLarge, ValueError) as error:  # or the native module has said what is wrong
        why = error if isinstance(error, ValueError) else "its nodes are too many"
        messages.warning(f"{owner}: {why}; they are left out")
        return ((1.0,) * 3, None), False
