# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials, lights and the world: where links lead."""

import sys
from collections import namedtuple
from contextlib import contextmanager

import bpy

from .. import versions

# Where a socket's links lead: the last input on the way (its value counts when nothing feeds
# it), and the node and output that feed it, or None.
Source = namedtuple("Source", "socket node output groups")

_MOST_STEPS = 10000  # from one socket to what feeds it; more go round in a circle
# Of Python's calls inside each other while graphs are read: some thousand nodes, each of which feeds
# the next, and little enough for the stack of a thread.
_MOST_CALLS = 8000


@contextmanager
def deep():
    """Graphs are read by recursion, and may be deeper than Python likes by default."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, _MOST_CALLS))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


def trace(socket, groups=()):
    """Follow a socket through reroutes, muted nodes and groups; `groups` are the nodes around. Sockets that a node has for
    another kind keep links that count for nothing."""
    for _ in range(_MOST_STEPS):
        link = next((l for l in socket.links if l.is_valid and not l.is_muted and l.from_socket.enabled and l.to_socket.enabled), None)
        if not link:
            return Source(socket, None, None, groups)
        node, output = link.from_node, link.from_socket
        through, inside = _through(node, output, groups)
        if not through:
            return Source(socket, None, None, groups) if node.mute else Source(socket, node, output,
                                                                               groups)
        socket, groups = through, inside
    return Source(socket, None, None, groups)


def _through(node, output, groups):
    """The input that an output passes on, and the groups around it; (None, groups) where none."""
    if node.mute:
        link = next((l for l in node.internal_links if l.to_socket == output), None)
        return (link.from_socket if link else None), groups
    if node.type == "REROUTE":
        return node.inputs[0], groups
    if node.type == "GROUP" and node.node_tree:
        inner = next((n for n in node.node_tree.nodes
                      if n.type == "GROUP_OUTPUT" and n.is_active_output), None)
        return (_twin(inner.inputs, output) if inner else None), (*groups, node)
    if node.type == "GROUP_INPUT" and groups:
        return _twin(groups[-1].inputs, output), groups[:-1]
    return None, groups


def _twin(sockets, socket):
    return next((s for s in sockets if s.identifier == socket.identifier), None)


def own_value(socket):
    """A socket's own value: a number or a tuple of them; 0 where it has none, or a text."""
    value = getattr(socket, "default_value", 0.0)
    if isinstance(value, str) or value is None:
        return 0.0
    return tuple(float(v) for v in value) if hasattr(value, "__len__") else float(value)


def color_in(socket):
    """Three numbers of a socket's own value. Where a link has led to, its type may be any."""
    value = own_value(socket)
    return value[:3] if isinstance(value, tuple) else (value,) * 3


def number_in(socket):
    """One number of a socket's own value."""
    return sum(color_in(socket)) / 3


def of(owner):
    """Node tree of a material, light or world, if it uses one."""
    always = versions.ALWAYS_NODES and not isinstance(owner, bpy.types.Light)
    return owner.node_tree if always or owner.use_nodes else None


def shader_of(tree):
    """What feeds the Surface of a tree's active output."""
    output = tree.get_output_node("ALL")
    return trace(output.inputs["Surface"]) if output else None
