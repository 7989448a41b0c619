# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Scratches, by its bl_idname: a field that the native module evaluates."""

from .. import _native
from ..names import SCRATCHES
from ..report import in_digits
from ..scratches.field import description, metres
from ..scratches.tree import AMOUNT, HEIGHT, NORMAL, NUMBERS, VECTOR
from . import tree
from .graph import is_known
from .node_place import of_object, position, uv
from .value import Value, each, normal_of, number_in, three, value_of

_STEP = 1 / 256  # along u and v, by which coordinates say how they move
_UP = (0.0, 0.0, 1.0)


def _scratches(reader, found):
    amount = number_in(reader, found, AMOUNT)
    if found.output.name == NORMAL:
        return _normal(reader, found, amount)
    key = ("scratches", found.node, found.groups, reader.shift)
    if key not in reader.known:
        reader.known[key] = reader.program.emit("SCRATCHES", 2, what="HEIGHT", field=_field(reader, found),
                                                at=_where(reader, found), amount=[amount])
    height, mask = reader.known[key]
    if found.output.name != HEIGHT:
        return [mask]
    return [reader.program.math("MULTIPLY", height, 1.0 / reader.unit_of_length())]


def _normal(reader, found, amount):
    node = found.node
    own = normal_of(reader, node.inputs["Normal"], found.groups)
    if reader.in_height:
        reader.warn(f"'{node.name}' bends a normal that a height depends on; left out")
    if reader.in_height or is_known(amount) and not amount > 0:
        return Value("NORMAL", own) if own else None
    given = {"what": "NORMAL", "field": _field(reader, found), "at": _where(reader, found), "near": [], "step": _STEP,
             "amount": [amount]}
    for reader.shift in ((_STEP, 0.0), (0.0, _STEP)):
        given["near"] += _where(reader, found)
    reader.shift = None
    drawn = {"drawn": True} if reader.filters else {}
    normal = reader.program.emit("SCRATCHES", normal=own or _UP, **given, **drawn)
    if reader.filters:
        mean, spread = reader.filtered.get(own[0], (own, (0.0, 0.0))) if own else (None, (0.0, 0.0))
        *mean, x, y = reader.program.emit("SCRATCHES", 5, filtered=True, normal=mean or _UP, **given)
        reader.filtered[normal[0]] = mean, tuple(reader.program.math("ADD", *two) for two in zip(spread, (x, y)))
    return Value("NORMAL", normal)


def _field(reader, found):
    """Index of the node's field; what differs from place to place is the node's own number, and named."""
    key = ("scratch field", found.node, found.groups)
    if key in reader.known:
        return reader.known[key]
    node, numbers = found.node, {}
    for name in NUMBERS:
        numbers[name] = number_in(reader, found, name)
        if not is_known(numbers[name]):
            numbers[name] = node.inputs[name].default_value
            reader.warn(f"'{node.name}': what feeds {name} differs from place to place, which only Amount may; "
                        f"{in_digits(numbers[name])} is used")
    said = description(node, reader.unit_of_length(), numbers)
    plan = _native.scratches(said)
    if plan["fewer"]:
        reader.warn(f"'{node.name}': {in_digits(said['density'])} scratches per cm² are too many; there are {in_digits(plan['density'])}")
    reader.known[key] = reader.scratches(said)
    return reader.known[key]


def _where(reader, found):
    """x and y on the field, metres."""
    node = found.node
    socket = node.inputs[VECTOR]
    value = (value_of(reader, socket, found.groups, own=Value("VECTOR", None))
             if tree.trace(socket, found.groups).node else Value("VECTOR", None))
    if value.parts is not None:
        at = three(reader, value)
    elif node.unit == "UV":
        at = uv(reader, node.uv_map)
    else:
        at = _by_side(reader)
    by = metres(node, reader.unit_of_length())
    return list(each(reader, "MULTIPLY", at[:2], (by, by)))


def _by_side(reader):
    """The object's coordinates along its faces: of x, y and z those two that a face looks at least."""
    math = reader.program.math
    place = of_object(reader, "POINT_INTO", position(reader))
    if "side of object" not in reader.known:
        normal = of_object(reader, "NORMAL_INTO", reader.program.emit("GEOMETRY", what="TRUE_NORMAL"))
        x, y, z = each(reader, "ABSOLUTE", normal)
        to_x = math("MULTIPLY", math("GREATER_THAN", x, y), math("GREATER_THAN", x, z))
        reader.known["side of object"] = to_x, math("SUBTRACT", 1.0, math("GREATER_THAN", math("MAXIMUM", x, y), z))
    to_x, to_z = reader.known["side of object"]
    return math("MIX", place[0], place[1], to_x), math("MIX", place[2], place[1], to_z)


NODES = {SCRATCHES: _scratches}
