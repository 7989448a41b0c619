# SPDX-License-Identifier: GPL-3.0-or-later
"""What is behind everything."""

from . import tree


def background(world, messages):
    """Constant background, linear RGB."""
    if not world:
        return (0.0, 0.0, 0.0)
    nodes = tree.of(world)
    if not nodes:
        return tuple(world.color)
    color, strength = tree.emission(nodes, "BACKGROUND", f"world '{world.name}'", messages, 0.0)
    return tuple(c * strength for c in color)
