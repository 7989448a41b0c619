# SPDX-License-Identifier: GPL-3.0-or-later
"""What a cloth is woven of: the properties of Libshade Fabric that say so, by libshade's own table, and their panels."""

import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, PointerProperty, StringProperty

from .. import _native

_TABLE = _native.table()
CUSTOM, DRAFT = "CUSTOM", "DRAFT"
_BEYOND = 1000  # numbers of choices that are none of a table's
YARNS = ("warp", "weft")
_ROWS = {row["word"]: row for row in _TABLE["yarns"]}
WEAVES = {row["word"].upper(): row for row in _TABLE["weaves"]}

# By the table's word: name, and where it is drawn; slant and fibre are Twist's
_NAMES = {
    "width": "Width", "gap": "Gap", "twist": "Twist", "segments": "Strands", "crimp": "Crimp", "slub": "Slub",
    "vary_brightness": "Varied Brightness", "vary_tilt": "Varied Tilt",
    "curve": "Roundness", "ridge": "Strand Relief", "crimp_length": "Crimp Length",
    "along_brightness": "Brightness Along", "along_tilt": "Tilt Along", "along_length": "Variation Length",
    "fuzz": "Fibres in Gaps", "along": "Exponent Along", "across": "Exponent Across",
}
_SOFT = {"width": 1.0, "gap": 1.0, "segments": 8.0, "along_length": 32.0, "along": 1000.0, "across": 100.0}
_TWIST = {"help": "Angle of the strands to the yarn's axis: above 0 S twist, below 0 Z twist", "unit": "rad",
          "minimum": -math.pi / 2, "maximum": math.pi / 2, "initial": 0.0}
_UNITS = {"width": "; the crossing is width and gap", "gap": "; the crossing is width and gap"}
_filling = [False]  # while a preset's numbers are set, which is no edit


def numbers():
    """Words of a yarn's numbers that are properties."""
    return [word for word in _NAMES if word == "twist" or word in _ROWS]


def base(node):
    """The preset that a node's cloth is made from."""
    presets = [row["word"].upper() for row in _TABLE["cloths"]]
    return next((word for word in (node.preset, node.based_on) if word in presets), presets[0])


def fill(node):
    """A node's numbers become those of its preset."""
    word = base(node)
    row = _native.cloth(word.lower())
    _filling[0] = True
    try:
        node.based_on, node.weave = word, row["weave"].upper()
        node.ends_per_cm, node.picks_per_cm = row["counts"]
        for yarn in YARNS:
            for number in numbers():
                setattr(node, f"{yarn}_{number}", row[yarn][number])
    finally:
        _filling[0] = False


def _edited(name):
    def update(node, _context):
        if _filling[0]:
            return
        if not node.based_on:  # of an older file: its other numbers are not there yet
            value = getattr(node, name)
            fill(node)
            _filling[0] = True
            setattr(node, name, value)
            _filling[0] = False
        node.preset = CUSTOM
        node.update_preview()
    return update


def _number(yarn, word):
    row, name = _ROWS.get(word, _TWIST), f"{yarn}_{word}"
    limits = {"soft_max": _SOFT[word]} if word in _SOFT else {}
    kind = {"subtype": "ANGLE", "unit": "ROTATION"} if word == "twist" else (
        {"subtype": "FACTOR"} if min(row["maximum"], _SOFT.get(word, math.inf)) <= 1 else {})
    return FloatProperty(name=_NAMES[word], description=row["help"] + _UNITS.get(word, ""), min=row["minimum"],
                         max=row["maximum"], default=row["initial"], precision=3, update=_edited(name),
                         **kind, **limits)


def _count(name, about, which):
    return FloatProperty(name=name, description=about, min=0.1, max=1000, soft_max=200, default=20, precision=1,
                         update=_edited(which))


_SIZES = (("LENGTH", "Length", "Size says how much cloth one unit of the UV map spans", 0),
          ("REAL", "Real World", "As large as the object: what a unit of the UV map spans is measured on the mesh before "
           "modifiers, times the object's scale and the scene's unit", 1),
          ("REPEATS", "Repeats", "So many repeats of the weave in one unit of the UV map", 2))
_DISTANCES = (("AUTO", "Automatic", "Yarns where pixels are smaller than these, else the cloth as a whole", 0),
              ("NEAR", "Near", "Yarns, however far it is", 1), ("FAR", "Far", "The cloth as a whole, however near it is", 2))


def properties(set_length, changed):
    """What follows: set_length, where Size is set; changed, where it is measured in another way."""
    made = {
        "based_on": StringProperty(options={"HIDDEN"}),  # a preset; "" where the numbers were never filled in
        "weave": EnumProperty(
            name="Weave", description="Which yarn is on top where", update=_edited("weave"),
            items=[(word, row["label"], row["help"], k) for k, (word, row) in enumerate(WEAVES.items())]
            + [(DRAFT, "Draft", "By a Weaving Information File (WIF), as a Text of this file", _BEYOND)]),
        "draft": PointerProperty(name="Draft", description="A Weaving Information File", type=bpy.types.Text,
                                 update=_edited("draft")),
        "draft_colors": BoolProperty(name="Draft Colors", default=True, update=_edited("draft_colors"), description=(
            "Yarns have their colours in the draft, times Warp and Weft Color")),
        "ends_per_cm": _count("Ends per cm", "Warp yarns side by side in a centimetre", "ends_per_cm"),
        "picks_per_cm": _count("Picks per cm", "Weft yarns side by side in a centimetre", "picks_per_cm"),
        "size_mode": EnumProperty(name="Size", description="How large the cloth is", items=_SIZES, default="LENGTH",
                                  update=changed),
        "size": FloatProperty(
            name="Length per Unit", subtype="DISTANCE", unit="LENGTH", min=1e-4, max=1e4, soft_max=10,
            default=0.2, description="Length of cloth that one unit of the UV map spans", update=set_length),
        "repeats": FloatVectorProperty(name="Repeats", size=2, min=-1e6, max=1e6, default=(50, 50), update=changed, description=(
            "Repeats of the weave in one unit of the UV map, along u and v")),
        "distance": EnumProperty(name="Distance", description="How the cloth is looked at", items=_DISTANCES),
    }
    for yarn in YARNS:
        for word in numbers():
            made[f"{yarn}_{word}"] = _number(yarn, word)
    return made


def settings(node, unit):
    """What the native module is to know of it; (settings, what is wrong with them or ""). unit: metres in one of the scene,
    which lengths in the interface count."""
    made, trouble = {"preset": base(node).lower()}, ""
    if node.preset == CUSTOM and node.based_on:
        own = _native.cloth(made["preset"])
        made["counts"] = (node.ends_per_cm, node.picks_per_cm)
        for yarn in YARNS:
            made[f"{yarn}_yarn"] = given = {}
            for word in numbers():
                value = getattr(node, f"{yarn}_{word}")
                if abs(value - own[yarn][word]) > 1e-5 * max(1.0, abs(value)):
                    row = _ROWS.get(word, _TWIST)
                    given[word] = min(max(value, row["minimum"]), row["maximum"])  # single precision is beyond
            if "twist" in given:
                given["plied"] = own[yarn]["fibre"] == 0 and own[yarn]["segments"] > 0
        if node.weave == DRAFT:
            text, trouble = _draft(node)
            made |= {"draft": text, "draft_name": node.draft.name, "draft_colors": node.draft_colors} if text else {}
        else:
            made["weave"] = node.weave.lower()
    if node.size_mode == "REPEATS":
        made["repeats"] = tuple(node.repeats)
    else:
        made["size"] = 1.0 if node.size_mode == "REAL" else min(max(node.size * unit, 1e-6), 1e6)
    if node.distance != "AUTO":
        made["tier"] = node.distance.lower()
    return made, trouble


def _draft(node):
    if not node.draft:
        return "", "no draft is chosen (a Text, or Import WIF, in the sidebar); woven as its preset"
    text = node.draft.as_string()
    try:
        _native.wif(text.encode(), node.draft.name)
    except ValueError as error:
        return "", f"{error}; woven as its preset"
    return text, ""


def weft_share(node):
    """Of what shows."""
    if node.preset == CUSTOM and node.weave in WEAVES:
        return WEAVES[node.weave]["weft_share"]
    if node.preset == CUSTOM and node.draft:
        try:
            return _native.wif(node.draft.as_string().encode(), node.draft.name)["weft_share"]
        except ValueError:
            pass
    return next(row["weft_share"] for row in _TABLE["cloths"] if row["word"].upper() == base(node))
