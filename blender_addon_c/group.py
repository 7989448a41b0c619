# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups, in the versions of Blender."""

from array import array

import bpy

_PATTERN = "libshade_pattern"  # on trees that others are copied from


def new_socket(tree, name, in_out, kind, subtype="NONE"):
    """A socket of a group. subtype: FACTOR is drawn as a slider, ANGLE in degrees."""
    if hasattr(tree, "interface"):  # 4.0 and later
        socket = tree.interface.new_socket(name, in_out=in_out, socket_type=kind)
        if subtype != "NONE":
            socket.subtype = subtype
        return socket
    kind += "" if subtype == "NONE" else subtype.title()
    return (tree.inputs if in_out == "INPUT" else tree.outputs).new(kind, name)


def new_inside(name):
    """A tree for the inside of a node of ours, which the menus that add groups and their search hide: there it would be called
    as the node is, and show none of its settings."""
    return bpy.data.node_groups.new("." + name, "ShaderNodeTree")


def like_pattern(name, fill):
    """A tree for the inside of a node of ours, as `fill` makes it. Blender goes over all trees of the file for each node and
    link that is made, but once for a copy: the file keeps one to copy, without users, which is not saved."""
    pattern = next((tree for tree in bpy.data.node_groups
                    if tree.get(_PATTERN) == name and not tree.users and not tree.library and _is_whole(tree)), None)
    if pattern is None:
        pattern = new_inside(f"{name} Pattern")
        fill(pattern)
        pattern[_PATTERN] = name
    tree = pattern.copy()
    del tree[_PATTERN]
    tree.name = f".{name}"
    return tree


def _is_whole(tree):
    """Are the groups inside still there?"""
    return all(node.node_tree for node in tree.nodes if node.bl_idname == "ShaderNodeGroup")


def drop_patterns():
    """What the add-on leaves in no file that is open."""
    for tree in [tree for tree in bpy.data.node_groups if tree.get(_PATTERN) and not tree.users]:
        bpy.data.node_groups.remove(tree)


def say(owner, name, value):
    """Set what is not so yet: Blender goes over all trees of the file for each value that is set inside of one."""
    said = getattr(owner, name)
    if isinstance(value, str):
        same = said == value
    else:
        was, new = ((part,) if isinstance(part, (float, int)) else part for part in (said, value))
        same = array("f", was) == array("f", new)
    if not same:
        setattr(owner, name, value)


def unhide(tree):
    """In these menus again, where a plain group has it."""
    if not tree.library:
        tree.name = tree.name.lstrip(".")


def own_tree(node):
    """What is inside a node of ours becomes its alone, where a copy of the node has it too (shares_tree), or another file."""
    tree = node.node_tree
    if (node.shares_tree and _holders(tree) > 1) or (tree.library and not node.id_data.library):
        node.node_tree = tree.copy()
    node.shares_tree = False
    return node.node_tree


def _holders(tree):
    """How many nodes have a tree inside: what Blender counts as its users may be one more."""
    owners = [getattr(user, "node_tree", user) for user in bpy.data.user_map(subset={tree})[tree]]
    return sum(getattr(node, "node_tree", None) == tree for owner in owners for node in getattr(owner, "nodes", ()))


def renew(tree, node, inside, fill):
    """Another tree inside a node of ours: links go to sockets of the same name, and `fill` sets what sockets say, by what they
    said by name."""
    said = {socket.name: socket.default_value[:] if hasattr(socket.default_value, "__len__") else socket.default_value
            for socket in node.inputs}
    links = [(link.from_socket, socket.name) for socket in node.inputs for link in socket.links]
    targets = [link.to_socket for link in node.outputs[0].links]
    old, node.node_tree, node.shares_tree = node.node_tree, inside, False
    for socket in node.inputs:  # Blender keeps links by sockets' numbers
        for link in list(socket.links):
            tree.links.remove(link)
    fill(said)
    for source, name in links:
        tree.links.new(source, node.inputs[name])
    for target in targets:
        tree.links.new(node.outputs[0], target)
    node.update_preview()
    if not old.users:
        bpy.data.node_groups.remove(old)
