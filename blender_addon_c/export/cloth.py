# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Fabric: where cloth lies on a surface, what varies on it, and its closures."""

import math

from .. import fabric
from . import tree
from .closure_add import add, normal_in
from .graph import is_known
from .node_place import of_object, place
from .value import clamped, color_of, each, number_of

_STEP = 2.0**-7  # along u and v, over which a linked Vector's change is seen


def fabric_node(reader, node, groups, share):
    """Through some of its yarns, as a number or a texture says, light passes: of two cloths, of which one lets
    all of it through, as much of either."""
    math, alpha = reader.program.math, _number(reader, node, groups, "Alpha", 1.0)
    through = clamped(reader, _number(reader, node, groups, fabric.TRANSLUCENCY, 0.0)
                      if fabric.socket_rules(node) else node.transmission)
    alpha = clamped(reader, alpha)
    parts = [(through, 1.0)] if is_known(through) else [(0.0, math("SUBTRACT", 1.0, through)), (1.0, through)]
    fed = _varied(reader, node, groups)
    normal, reader.by_mesh = normal_in(reader, node, groups), True
    fed |= {"normal": normal} if normal else {}
    for transmit, part in parts:
        made = _made(reader, node, groups, transmit, fed)
        add(reader, {"closure": "FABRIC", **made}, math("MULTIPLY", math("MULTIPLY", share, alpha), part))
    covered = math("MULTIPLY", alpha, made["coverage"][0]) if node.open_gaps else alpha
    add(reader, {"closure": "TRANSPARENT"}, math("MULTIPLY", share, math("SUBTRACT", 1.0, covered)))


def _varied(reader, node, groups):
    """What node CLOTH and closure FABRIC take of what nodes say, but for what _made finds."""
    fed = {}
    for key, name, most in (("gloss", "Gloss", 1.0), ("nap", "Fuzz", 10.0)):
        number = _number(reader, node, groups, name, None)
        if number is not None and not is_known(number):
            fed[f"{key}_from"] = [reader.program.math("CLAMP", number, 0.0, most)]
    return fed


def _made(reader, node, groups, transmit, fed):
    """Cloth with this share of what is matt going through. Where the nodes say the same everywhere, the cloth has
    these colours; else the preset's own, and each point another."""
    cloth, trouble = fabric.settings(node, reader.unit_of_length())
    cloth, fed = {**cloth, "transmit": transmit}, {**fed}
    if trouble:
        reader.warn(f"'{node.name}': {trouble}")
    if "draft" in cloth and "from_rec709" in cloth:
        cloth["draft_from_rec709"] = cloth["from_rec709"]
    for yarn in ("warp", "weft"):
        color = color_of(reader, node.inputs[f"{yarn.title()} Color"], groups)
        if is_known(*color):
            cloth[yarn] = tuple(min(part, 1.0) if part > 0 else 0.0 for part in color)  # NaN too
        else:  # the rest goes through
            fed[f"{yarn}_from"] = each(reader, "MULTIPLY", color, (1.0 - transmit,) * 3)
    for key, name, most in (("gloss", "Gloss", 1.0), ("nap", "Fuzz", 10.0)):
        number = _number(reader, node, groups, name, None)
        if number is not None and is_known(number):
            cloth[key] = min(number, most) if number > 0 else 0.0
    fed["cloth"] = reader.cloth(cloth)
    fed |= _lie(reader, node, groups, fed["cloth"])
    return fed | {"coverage": reader.program.emit("CLOTH", 1, **fed)}


def _number(reader, node, groups, name, missing):
    """Of a socket; nodes of older files do not have all."""
    return number_of(reader, node.inputs[name], groups) if name in node.inputs else missing


def _lie(reader, node, groups, cloth):
    """Its place on the surface, and its x axis in the shading frame where that is not the tangent."""
    given = {"cloth": cloth}
    vector = _vector(reader, node, groups)
    if vector:
        given |= {"vector": vector, "step": _STEP}
    scale = _number(reader, node, groups, "Scale", 1.0)
    if node.size_mode == "REAL":
        scale = reader.program.math("MULTIPLY", scale, _metres(reader, node, groups))
    if not is_known(scale) or scale != 1:
        given["scale"] = [scale]
    turns = _number(reader, node, groups, "Rotation", 0.0)
    if not is_known(turns) or turns != 0:
        angle = reader.program.math("MULTIPLY", turns, 2 * math.pi)
        given["turn"] = [reader.program.math(what, angle) for what in ("COSINE", "SINE")]
    if not ("turn" in given or "vector" in given):
        return {"place": reader.program.emit("WEAVE", 4, **given)}
    return dict(zip(("place", "frame"), reader.program.emit_each("WEAVE", {"out": 4, "frame": 2}, **given)))


def _vector(reader, node, groups):
    """x and y of what feeds Vector, there and a step on along u and along v; None where it lies by the UV map that
    is the mesh's own."""
    socket = node.inputs.get("Vector")
    if not socket:
        reader.is_main("")
        return None
    here = place(reader, socket, groups)
    if here is None:
        return None
    seen = list(here[:2])
    for shift in ((_STEP, 0.0), (0.0, _STEP)):
        reader.shift = shift
        seen += place(reader, socket, groups)[:2]
    reader.shift = None
    return seen


def _metres(reader, node, groups):
    """In a unit of the coordinates: of the map that the mesh was measured by, of the object's space, or of the scene."""
    space = _space(node.inputs["Vector"], groups, set()) if "Vector" in node.inputs else "MAP"
    if space == "WORLD":
        return reader.unit_of_length()
    reader.measures()
    return of_object(reader, "METRES")[0 if space == "MAP" else 1]


def _space(socket, groups, seen):
    """What coordinates feed a vector, as far as nodes tell by themselves."""
    found = tree.trace(socket, groups)
    node = found.node
    if node is None or (node, found.groups) in seen:
        return "MAP"
    seen.add((node, found.groups))
    if node.type == "NEW_GEOMETRY" and found.output.name == "Position":
        return "WORLD"
    if node.type == "TEX_COORD":
        return "OBJECT" if found.output.name == "Object" else "MAP"
    spaces = {_space(other, found.groups, seen) for other in node.inputs if other.is_linked}
    return next((space for space in ("OBJECT", "WORLD") if space in spaces), "MAP")
