# SPDX-License-Identifier: GPL-3.0-or-later
"""What other renderers see of the cloth node: its yarns, by pictures of one repeat and groups of plain nodes
(place.py, shade.py). Files made before have a matt cloth of the mean of its colours inside, and keep it."""

import bpy

from ..export import size
from ..group import like_pattern, new_socket, say
from . import maps
from .place import SLUBS, place_tree
from .shade import NUMBERS, YARNS, cloth_tree

_PLACE, _SHADE, _METRES, _KNOWN = "Place", "Cloth", "Metres", "Known"
_INSIDE = (_PLACE, _SHADE, _METRES)
_STAND_IN = ("Principled BSDF", "Mix", "Darken")  # of older files
_GLOSS = "Gloss"
# On objects, for Cycles: metres in a unit of the UV map, and in one of the object's space
MEASURES = {"MAP": "libshade_metres", "OBJECT": "libshade_metres_of_unit"}

# Sockets by name: kind, about, its own value, limits
SOCKETS = (
    ("Warp Color", "Color", "Of the yarns along v, where light is matt", None, None),
    ("Weft Color", "Color", "Of the yarns along u", None, None),
    ("Gloss", "Float", "How narrow the reflection is, as a part of what it is on these yarns", 1.0, (0.0, 1.0)),
    ("Fuzz", "Float", "Loose fibres over the cloth: their optical depth, which brightens edges", None, (0.0, 10.0)),
    ("Translucency", "Float", "Share of the matt light that leaves the yarns on the other side", 0.0, (0.0, 1.0)),
    ("Alpha", "Float", "Share of the cloth that is there", 1.0, (0.0, 1.0)),
    ("Scale", "Float", "What coordinates are multiplied by: 2 makes yarns half as large", 1.0, (-1e6, 1e6)),
    ("Rotation", "Float", "Turns the cloth on the surface; 1 is all the way round", 0.0, (0.0, 1.0)),
    ("Vector", "Vector", "Where on the cloth: x along the weft, y along the warp; unlinked, the UV map", None, None),
    ("Normal", "Vector", "Of folds; unlinked, the surface's own", None, None),
)
OF_PRESET = ("Warp Color", "Weft Color", "Fuzz")  # what a preset sets
NEW = [name for name, *_ in SOCKETS if name not in ("Warp Color", "Weft Color", "Normal")]  # not on older nodes


def new_tree():
    """Such a tree; what a preset sets is left as it is."""
    return like_pattern("Libshade Fabric", _fill)


def _fill(tree):
    for name, kind, about, value, limits in SOCKETS:
        socket = new_socket(tree, name, "INPUT", f"NodeSocket{kind}", "FACTOR" if limits == (0.0, 1.0) else "NONE")
        socket.description = about
        if limits:
            socket.min_value, socket.max_value = limits
        if value is not None:
            socket.default_value = value
        if kind == "Vector":
            socket.hide_value = True
    new_socket(tree, "BSDF", "OUTPUT", "NodeSocketShader")

    def new(kind, x, y, name=""):
        node = tree.nodes.new(kind)
        node.location, node.name = (x, y), name or node.name
        return node

    link = tree.links.new
    given, out = new("NodeGroupInput", -1100, 0), new("NodeGroupOutput", 500, 0)
    place, shade = new("ShaderNodeGroup", -500, -200, _PLACE), new("ShaderNodeGroup", 200, 0, _SHADE)
    place.node_tree, shade.node_tree = place_tree(), cloth_tree()
    place.label, shade.label = place.node_tree.name, f"{shade.node_tree.name} (approximate)"
    # an object that was never measured says 0: a unit of its map counts as a metre
    metres, missing, known = (new(f"ShaderNode{kind}", x, -500, name) for kind, x, name in (
        ("Attribute", -1100, _METRES), ("Math", -900, ""), ("Math", -700, _KNOWN)))
    metres.attribute_type = "OBJECT"
    missing.operation, missing.inputs[1].default_value, known.operation = "LESS_THAN", 1e-12, "ADD"
    link(metres.outputs["Fac"], missing.inputs[0])
    link(metres.outputs["Fac"], known.inputs[0])
    link(missing.outputs[0], known.inputs[1])
    for name in ("Vector", "Scale", "Rotation"):
        link(given.outputs[name], place.inputs[name])
    for number, word in enumerate(maps.WORDS):
        picture = new("ShaderNodeTexImage", -200, -300 * number, word)
        picture.label = word.title()
        link(place.outputs["Place"], picture.inputs["Vector"])
        if word != "tint":
            link(picture.outputs["Color"], shade.inputs[word.title()])
    for name in ("Crossing", "Tangent"):
        link(place.outputs[name], shade.inputs[name])
    for name in (*(f"{yarn} Color" for yarn in YARNS), *NUMBERS, "Normal"):
        link(given.outputs[name], shade.inputs[name])
    link(shade.outputs["BSDF"], out.inputs["BSDF"])


def _has(tree, names):
    return bool(tree) and all(tree.nodes.get(name) for name in names)


def is_stand_in(tree):
    """Is it a matt cloth, as older files have?"""
    return _has(tree, _STAND_IN)


def can_update(tree):
    """Is it as it was made, one time or another? Else someone has been inside."""
    return _has(tree, _INSIDE) or is_stand_in(tree)


def update_stand_in(tree, weft_share, brightness, exponent):
    """weft_share: what shows of it; brightness: of the whole cloth beside that of its yarns."""
    inner, roughness = tree.nodes, (2.0 / (exponent + 2.0)) ** 0.25  # its square is alpha
    inner["Mix"].inputs[0].default_value = weft_share
    inner["Darken"].inputs[2].default_value = (*[brightness] * 3, 1.0)
    inner["Principled BSDF"].inputs["Roughness"].default_value = roughness
    if _GLOSS in inner:
        inner[_GLOSS].inputs[1].default_value = roughness


# ---- what properties change in it


def _say(socket, value):
    say(socket, "default_value", value)


def _dyed(yarn):
    """Reflectance head-on that goes with the colour, that does not, and its mean; as native/scene/cloth.c dyes."""
    f0, kd = yarn["f0"], yarn["kd"]
    goes = [max(f0) != min(f0) and part > 1e-3 for part in kd]
    dyed = [f / part if goes_ else 0.0 for f, part, goes_ in zip(f0, kd, goes)]
    return dyed, [0.0 if goes_ else f for f, goes_ in zip(f0, goes)], sum(f0) / 3


def _of_yarn(yarn):
    dyed, plain, mean = _dyed(yarn)
    return {"Exponents": (yarn["along"], yarn["across"], yarn["fibre"]), "Dyed Shine": dyed, "Plain Shine": plain,
            "Shine": mean, "Vary": (yarn["vary_brightness"], yarn["vary_tilt"], 1 / yarn["along_length"]),
            "Along": (yarn["along_brightness"], yarn["along_tilt"], 0.0)}


def update(tree, made, name, real, unit, open_gaps):
    """Carry a cloth over. made: of maps.py; name: for its images; real: size.space_of; unit: metres in one of the
    scene."""
    inner = tree.nodes
    place, shade = inner[_PLACE].inputs, inner[_SHADE].inputs
    _say(place["Per Unit"], (*made["per_unit"], 0.0))
    _say(place["Per Crossing"], (*(1 / side for side in made["repeat"]), 0.0))
    for word, slub in zip(YARNS, SLUBS):
        yarn = made[word.lower()]
        _say(place[slub], (yarn["slub"], 1 / yarn["along_length"], 1 / yarn["share"]))
        for key, value in _of_yarn(yarn).items():
            _say(shade[f"{word} {key}"], value)
    both = [a + b for a, b in zip(made["warp"]["kd"], made["weft"]["kd"])]
    _say(shade["Dyed Backing"], [0.0 if open_gaps else part / max(whole, 1e-3) for part, whole in zip(made["backing"], both)])
    _say(shade["Fuzz in Gaps"], 1 - (1 - made["warp"]["fuzz"]) * (1 - made["weft"]["fuzz"]))
    _say(shade["Lit"], made["lit"])
    _say(shade["Open"], float(open_gaps))
    _say(shade["Nap Color"], made["nap_color"])
    _measure(tree, real, unit)
    _show(tree, made, name)


def scene_unit():
    """Metres in a unit of the scene that is open."""
    return size.unit_of(getattr(bpy.context, "scene", None))


def _measure(tree, real, unit):
    inner = tree.nodes
    socket = inner[_PLACE].inputs["Metres"]
    if real in MEASURES:
        say(inner[_METRES], "attribute_name", MEASURES[real])
        if not socket.is_linked:
            tree.links.new(inner[_KNOWN].outputs[0], socket)
        return
    for link in list(socket.links):
        tree.links.remove(link)
    _say(socket, unit if real else 1.0)


def _show(tree, made, name):
    inner = tree.nodes
    for word in maps.WORDS:
        node, target = inner[word], inner[_SHADE].inputs[word.title()]
        new = maps.image(made, word, name) if made[word] is not None else None
        if node.image != new:
            node.image = new
        if word == "tint" and bool(new) != target.is_linked:
            if new:
                tree.links.new(node.outputs["Color"], target)
            else:
                tree.links.remove(target.links[0])
    maps.drop()
