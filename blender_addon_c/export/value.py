# SPDX-License-Identifier: GPL-3.0-or-later
"""What sockets say: a node's own value, or parts that the nodes behind it make.

A function of a node gets the material's reader and where a link came from (tree.Source), and returns what
the node's output says: parts, each a number or a register, one of a value, three of a colour or vector.
The functions are in node_*.py.
"""

from collections import namedtuple

from .. import versions, working_space
from . import tree
from .known import understood

# kind: VALUE, RGBA, VECTOR, or NORMAL, a vector in the shading frame.
Value = namedtuple("Value", "kind parts")


def color_of(reader, socket, groups):
    """Three parts of a socket."""
    return three(reader, value_of(reader, socket, groups))


def number_of(reader, socket, groups):
    """The one part of a socket."""
    return one(reader, value_of(reader, socket, groups))


def normal_of(reader, socket, groups):
    """Registers of a normal in the shading frame, or None for the surface's own."""
    found = tree.trace(socket, groups)
    if found.node is None:
        given = group_vector(found)
        if not given or not any(given):
            return reader.bumped
        return framed(reader, given)
    value = value_of(reader, socket, groups, own=Value("NORMAL", None))
    if value.parts is None or value.kind == "NORMAL":
        return value.parts or reader.bumped
    if value.kind == "RGBA":
        reader.warn(f"'{socket.node.name}': {socket.name} is fed by a colour ('{found.node.name}') without a Normal Map "
                    "node: such normals point anywhere, below the surface too, where Cycles of 3.4 shades otherwise")
    return framed(reader, three(reader, value))


def framed(reader, vector):
    """A vector in the world as a normal, which may be below the surface."""
    normal = reader.program.emit("FRAME", vector=vector, to="SHADING")
    reader.below[normal[0]] = reader.program.emit("FRAME", vector=vector, to="SHADING", below=True)
    return normal


def of_group(found):
    """Does a value of a group's feed a socket that nothing else does, and count where a texture is looked up, too?"""
    return versions.GROUP_VALUES_COUNT and found.node is None and found.socket.node.type == "GROUP"


def group_vector(found):
    """What a group's socket says that feeds a normal and that nothing feeds: a vector, if that counts and
    its value is shown; else None."""
    if not versions.GROUP_VALUES_COUNT or found.socket.node.type != "GROUP" or found.socket.hide_value:
        return None
    return tree.color_in(found.socket)


def surface_normal(reader):
    """The surface's own in world space, as its displacement bumps it."""
    if reader.bumped:
        return three(reader, Value("NORMAL", reader.bumped))
    return reader.program.emit("GEOMETRY", what="NORMAL")


def value_of(reader, socket, groups, own=None):
    """What feeds a socket. `own`: what it is where nothing does, else the socket's own value."""
    found = tree.trace(socket, groups)
    if own and found.node is None and own.kind == "VECTOR" and of_group(found):
        own = None
    own = own or own_value(found.socket)
    if found.node is None:
        return own
    key = (found.output, found.groups, reader.shift)
    if key not in reader.known:
        reader.known[key] = None  # being asked for
        reader.known[key] = _value(reader, found, socket) or "unknown"
    known = reader.known[key]
    if known is None:
        reader.warn(f"'{found.node.name}' feeds itself; the link is left out")
    return own if known in (None, "unknown") else known


def own_value(socket):
    value = tree.own_value(socket)
    if isinstance(value, tuple):
        return Value("RGBA" if len(value) == 4 else "VECTOR", value[:3])
    return Value("VALUE", (value,))


def _value(reader, found, socket):
    node = found.node
    function = reader.nodes.get(node.type) or reader.nodes.get(node.bl_idname)  # the latter: of our own ones
    if not (function and understood(node, found.output)):
        reader.warn(f"{socket.name}: '{node.name}' ({found.output.name}) is not supported; "
                    "what feeds it is used, or the socket's own value")
        through = next((l for l in node.internal_links if l.to_socket == found.output), None)
        if not (through and through.from_socket.is_linked):
            return None
        return value_of(reader, through.from_socket, found.groups)
    value = function(reader, found)
    if value is None or isinstance(value, Value):
        return value
    return Value("VALUE" if len(value) == 1 else found.output.type, tuple(value))


def three(reader, value):
    if value.kind == "NORMAL":
        return tuple(reader.program.emit("FRAME", vector=value.parts, to="WORLD"))
    return value.parts if len(value.parts) == 3 else value.parts * 3


def one(reader, value):
    if len(value.parts) == 1:
        return value.parts[0]
    weights = working_space.luminance() if value.kind == "RGBA" else (1 / 3,) * 3
    return dot(reader, three(reader, value), weights)


# ---- several numbers at once


def each(reader, operation, a, b=(0.0,) * 3, c=(0.0,) * 3):
    return tuple(reader.program.math(operation, *parts) for parts in zip(a, b, c))


def dot(reader, a, b):
    total = 0.0
    for one, other in zip(a, b):
        total = reader.program.math("ADD", total, reader.program.math("MULTIPLY", one, other))
    return total


def unit(reader, vector):
    """Of length 1; nothing stays nothing."""
    return each(reader, "DIVIDE", vector, (reader.program.math("SQRT", dot(reader, vector, vector)),) * 3)


def clamped(reader, part):
    return reader.program.math("CLAMP", part, 0.0, 1.0)


def vector_in(reader, found, name):
    """Three parts of an input, by name or number."""
    return color_of(reader, found.node.inputs[name], found.groups)


def number_in(reader, found, name):
    return number_of(reader, found.node.inputs[name], found.groups)
