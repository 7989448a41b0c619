# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups, in the versions of Blender."""


def new_socket(tree, name, in_out, kind):
    """A socket of a group."""
    if hasattr(tree, "interface"):  # 4.0 and later
        return tree.interface.new_socket(name, in_out=in_out, socket_type=kind)
    return (tree.inputs if in_out == "INPUT" else tree.outputs).new(kind, name)
