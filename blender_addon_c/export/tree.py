# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials, lights and the world: where links lead."""

from collections import namedtuple

import bpy

# Where a socket's links lead: the last input on the way (its value counts when nothing feeds
# it), and the node and output that feed it, or None.
Source = namedtuple("Source", "socket node output groups")


def trace(socket, groups=()):
    """Follow a socket through reroutes, muted nodes and groups; `groups` are the nodes around."""
    link = next((l for l in socket.links if l.is_valid and not l.is_muted), None)
    if not link:
        return Source(socket, None, None, groups)
    node, output = link.from_node, link.from_socket
    if node.mute:
        through = next((l for l in node.internal_links if l.to_socket == output), None)
        return trace(through.from_socket, groups) if through else Source(socket, None, None, groups)
    if node.type == "REROUTE":
        return trace(node.inputs[0], groups)
    if node.type == "GROUP" and node.node_tree:
        inner = next((n for n in node.node_tree.nodes
                      if n.type == "GROUP_OUTPUT" and n.is_active_output), None)
        if inner:
            return trace(_twin(inner.inputs, output), (*groups, node))
    if node.type == "GROUP_INPUT" and groups:
        return trace(_twin(groups[-1].inputs, output), groups[:-1])
    return Source(socket, node, output, groups)


def _twin(sockets, socket):
    return next(s for s in sockets if s.identifier == socket.identifier)


def of(owner):
    """Node tree of a material, light or world, if it uses one."""
    # From 5.0 on only lights may do without, and asking the others is deprecated.
    always = bpy.app.version >= (5, 0) and not isinstance(owner, bpy.types.Light)
    return owner.node_tree if always or owner.use_nodes else None


def shader_of(tree):
    """What feeds the Surface of a tree's active output."""
    output = tree.get_output_node("ALL")
    return trace(output.inputs["Surface"]) if output else None


def emission(tree, kind, owner, messages, otherwise):
    """(colour, strength) of an Emission or Background shader, linked values left out.

    Any other shader counts as a white one of strength `otherwise`.
    """
    shader = shader_of(tree)
    if not shader or not shader.node:
        return (0.0, 0.0, 0.0), 0.0
    if shader.node.type != kind:
        messages.warning(f"{owner}: '{shader.node.name}' is not supported; "
                         "its nodes are left out")
        return (1.0, 1.0, 1.0), otherwise
    color, strength = (trace(shader.node.inputs[name], shader.groups)
                       for name in ("Color", "Strength"))
    for found in (color, strength):
        if found.node:
            messages.warning(f"{owner}: '{found.node.name}' is not supported; "
                             "the socket's own value is used")
    return tuple(color.socket.default_value[:3]), strength.socket.default_value
