# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a scratches node: its presets, and what the native module is to know of it."""

import json
from math import isfinite

from .tree import DENSITY, DEPTH, DIRECTION, LENGTH, NUMBERS, SPREAD, WIDTH

# By word: what it is called, is, and what the sockets say. By eye, after what is said of such surfaces.
PRESETS = {
    "FINE_POLISH": ("Fine Polish", "Hairlines any way, as a cloth and paste leave them",
                    {DENSITY: 1200.0, LENGTH: 4.0, WIDTH: 0.012, DEPTH: 0.06, DIRECTION: 0.0, SPREAD: 1.5707963}),
    "BRUSHED": ("Brushed", "Long strokes along x of Vector, as a belt of grit 180 leaves them",
                {DENSITY: 500.0, LENGTH: 25.0, WIDTH: 0.03, DEPTH: 0.12, DIRECTION: 0.0, SPREAD: 0.035}),
    "USED": ("Used", "Sparse scratches any way, as on what lies in a drawer",
             {DENSITY: 20.0, LENGTH: 8.0, WIDTH: 0.03, DEPTH: 0.15, DIRECTION: 0.0, SPREAD: 1.5707963}),
    "DEEP": ("Deep", "Few and wide ones, as of keys and gravel",
             {DENSITY: 1.5, LENGTH: 25.0, WIDTH: 0.15, DEPTH: 0.35, DIRECTION: 0.3, SPREAD: 0.9}),
}


def apply_preset(node, preset):
    for name, value in PRESETS[preset][2].items():
        node.inputs[name].default_value = value
    node.chosen = preset


def tile_of(node, unit):
    """Metres of the square that repeats: the node's own, else that of its images, so that all renderers show the same
    scratches; 0: as many scratches fill."""
    if isfinite(node.tile) and node.tile > 0:
        return node.tile * unit
    try:
        return float(json.loads(node.baked)[-1])
    except (ValueError, IndexError, TypeError):
        return 0.0


def description(node, unit, numbers=None):
    """What the native module is to know of a node's field. unit: metres in one of the scene's. numbers: of its sockets,
    by name, else their own."""
    said = {}
    for name, (key, least, most, initial, _about) in NUMBERS.items():
        value = numbers[name] if numbers else node.inputs[name].default_value
        said[key] = min(max(value, least), most) if isfinite(value) else initial
    return {**said, "seed": float(node.seed), "tile": tile_of(node, unit)}


def metres(node, unit):
    """In a unit of Vector."""
    return unit * (node.size if node.unit == "UV" and isfinite(node.size) else 1.0)
