# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient Occlusion and Bevel: rays that say what stands about a point."""

from . import tree
from .graph import is_known
from .value import Value, color_of, each, framed, normal_of, number_in, surface_normal, three, value_of

_MOST = 128  # rays; Blender's own limit


def _ambient_occlusion(reader, found):
    """A distance of 0 that nothing feeds is the world's."""
    node = found.node
    color = (1.0,) if found.output.name == "AO" else color_of(reader, node.inputs["Color"], found.groups)
    distance = number_in(reader, found, "Distance")
    if not node.inputs["Distance"].is_linked and distance == 0:
        distance = reader.reach()
    if node.samples < 1 or (is_known(distance) and not distance > 0):
        return color
    normal = normal_of(reader, node.inputs["Normal"], found.groups)
    normal = normal and reader.below.get(normal[0], normal)
    free = reader.program.emit("OCCLUSION", 1, samples=min(node.samples, _MOST), distance=[distance],
                               inside=node.inside, local=node.only_local, **({"normal": normal} if normal else {}))[0]
    return tuple(reader.program.math("MULTIPLY", part, free) for part in color)


def _bevel(reader, found):
    """The mean of the normals about the point; a bent normal differs from it as from the surface's own."""
    node = found.node
    radius, samples = number_in(reader, found, "Radius"), min(node.samples, _MOST)
    bent = tree.trace(node.inputs["Normal"], found.groups).node
    if samples < 1 or (is_known(radius) and not radius > 0) or not reader.has_surface:
        own = normal_of(reader, node.inputs["Normal"], found.groups) if bent else None
        return Value("NORMAL", own) if own else tuple(surface_normal(reader))
    mean = tuple(reader.program.emit("BEVEL", 3, samples=samples, radius=[radius]))
    if not bent:
        return mean
    given = three(reader, value_of(reader, node.inputs["Normal"], found.groups))
    shifted = each(reader, "ADD", given, each(reader, "SUBTRACT", mean, surface_normal(reader), (0.0,) * 3), (0.0,) * 3)
    return Value("NORMAL", framed(reader, shifted))


NODES = {"AMBIENT_OCCLUSION": _ambient_occlusion, "BEVEL": _bevel}
