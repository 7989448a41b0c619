# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials, lights and the world: where links lead."""

import sys
from collections import namedtuple
from contextlib import contextmanager

import bpy

from .. import versions

# Where a socket's links lead: the last input on the way (its value counts when nothing feeds
# it), and the node and output that feed it, or None. groups: of nodes and turns, from without.
Source = namedtuple("Source", "socket node output groups")
# Of a zone that repeats, among the groups around: its last node, and which time it is.
Turn = namedtuple("Turn", "node number")

_MOST_STEPS = 10000  # from one socket to what feeds it; more go round in a circle
_MOST_TURNS = 1000  # of a zone: each makes nodes of its own
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
    """Follow a socket through reroutes, muted nodes, groups, switches whose choice is known, and zones that repeat; `groups` are
    the nodes around. Sockets that a node has for another kind keep links that count for nothing."""
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
    if node.type == "GROUP_INPUT":
        while groups and isinstance(groups[-1], Turn):
            groups = groups[:-1]
        return (_twin(groups[-1].inputs, output), groups[:-1]) if groups else (None, groups)
    return _CHOICES[node.type](node, output, groups) if node.type in _CHOICES else (None, groups)


# ---- nodes that pass on one of their inputs, as _through


def _menu_switch(node, output, groups):
    """Its other outputs say which item it is."""
    chosen = known(node.inputs["Menu"], groups)
    items = [item.name for item in node.enum_items]
    if output.identifier != "Output" or chosen not in items:
        return None, groups
    return node.inputs[1 + items.index(chosen)], groups


def _switch(node, _output, groups):
    chosen = known(node.inputs["Switch"], groups)
    return (None if chosen is None else node.inputs[2 if chosen else 1]), groups


def _index_switch(node, _output, groups):
    chosen = known(node.inputs["Index"], groups)
    items = len(node.index_switch_items)
    return (node.inputs[1 + int(chosen)] if chosen is not None and 0 <= chosen < items else None), groups


def _repeat_output(node, output, groups):
    first = _first_of(node)
    times = known(first.inputs["Iterations"], groups) if first else None
    if times is None or times > _MOST_TURNS:
        return None, groups
    return _before(node, first, output, groups, int(times))


def _repeat_input(node, output, groups):
    last, within = node.paired_output, groups
    while within and isinstance(within[-1], Turn) and within[-1].node != last:  # of zones inside
        within = within[:-1]
    if output.identifier == "Iteration" or not (within and isinstance(within[-1], Turn)):
        return None, groups
    return _before(last, node, output, within[:-1], within[-1].number)


def _before(last, first, output, groups, number):
    """What a zone's item is before that turn."""
    if number <= 0:
        return _twin(first.inputs, output), groups
    return _twin(last.inputs, output), (*groups, Turn(last, number - 1))


def _first_of(last):
    return next((node for node in last.id_data.nodes if node.type == "REPEAT_INPUT" and node.paired_output == last), None)


_CHOICES = {"MENU_SWITCH": _menu_switch, "SWITCH": _switch, "INDEX_SWITCH": _index_switch,
            "REPEAT_OUTPUT": _repeat_output, "REPEAT_INPUT": _repeat_input}


def known(socket, groups):
    """A number or a text that is the same everywhere, as far as nodes tell by themselves, else None."""
    found = trace(socket, groups)
    node = found.node
    if node is None:
        return getattr(found.socket, "default_value", None)
    if node.type == "VALUE":
        return found.output.default_value
    if node.type == "REPEAT_INPUT":
        return iteration(found)
    if node.type == "MENU_SWITCH" and found.output.identifier != "Output":
        return is_item(found)
    return None


def iteration(found):
    """Which time it is in a zone, where its node is asked for that, else None."""
    turn = next((turn for turn in reversed(found.groups) if isinstance(turn, Turn)), None)
    return turn.number if turn and found.output.identifier == "Iteration" and turn.node == found.node.paired_output else None


def is_item(found):
    """Is the item of that output what a Menu Switch chooses? None: who knows."""
    chosen = known(found.node.inputs["Menu"], found.groups)
    return None if chosen is None else float(chosen == found.output.name)


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
