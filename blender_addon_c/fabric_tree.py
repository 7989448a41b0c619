# SPDX-License-Identifier: GPL-3.0-or-later
"""What other renderers see of the cloth node: a matt cloth of the mean of its colours. Files made before have less
inside, and keep it."""

import bpy

from .group import new_socket

_SHADER, _MIX, _DARKEN, _GLOSS = "Principled BSDF", "Mix", "Darken", "Gloss"
_INSIDE = (_SHADER, _MIX, _DARKEN)

# Sockets by name: kind, about, its own value, limits
SOCKETS = (
    ("Warp Color", "Color", "Of the yarns along v, where light is matt", None, None),
    ("Weft Color", "Color", "Of the yarns along u", None, None),
    ("Gloss", "Float", "How narrow the reflection is, as a part of what it is on these yarns", 1.0, (0.0, 1.0)),
    ("Fuzz", "Float", "Loose fibres over the cloth: their optical depth, which brightens edges", None, (0.0, 10.0)),
    ("Translucency", "Float", "Share of the matt light that leaves the yarns on the other side", 0.0, (0.0, 1.0)),
    ("Alpha", "Float", "Share of the cloth that is there", 1.0, (0.0, 1.0)),
    ("Scale", "Float", "What coordinates are multiplied by: 2 makes yarns half as large", 1.0, (-1e6, 1e6)),
    ("Rotation", "Float", "Turns the cloth on the surface; 1 is all the way round", 0.0, (-1e4, 1e4)),
    ("Vector", "Vector", "Where on the cloth: x along the weft, y along the warp; unlinked, the UV map", None, None),
    ("Normal", "Vector", "Of folds; unlinked, the surface's own", None, None),
)
OF_PRESET = ("Warp Color", "Weft Color", "Fuzz")  # what a preset sets
NEW = [name for name, *_ in SOCKETS if name not in ("Warp Color", "Weft Color", "Normal")]  # not on older nodes


def new_tree():
    """Such a tree; what a preset sets is left as it is."""
    tree = bpy.data.node_groups.new("Libshade Fabric", "ShaderNodeTree")
    for name, kind, about, value, limits in SOCKETS:
        socket = new_socket(tree, name, "INPUT", f"NodeSocket{kind}")
        socket.description = about
        if limits:
            socket.min_value, socket.max_value = limits
        if value is not None:
            socket.default_value = value
        if kind == "Vector":
            socket.hide_value = True
    new_socket(tree, "BSDF", "OUTPUT", "NodeSocketShader")
    _fill(tree)
    return tree


def _fill(tree):
    link = tree.links.new

    def new(kind, x, y, name="", **settings):
        node = tree.nodes.new(f"ShaderNode{kind}")
        node.location, node.name = (x, y), name or node.name
        for key, value in settings.items():
            setattr(node, key, value)
        return node

    given, out = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    given.location, out.location = (-900, 0), (700, 0)
    mix, darken = new("MixRGB", -650, 0, _MIX), new("MixRGB", -450, 0, _DARKEN, blend_type="MULTIPLY")
    darken.inputs[0].default_value = 1.0
    shader, behind, clear = new("BsdfPrincipled", -200, 0, _SHADER), new("BsdfTranslucent", -200, 150), \
        new("BsdfTransparent", 200, 150)
    through, whole = new("MixShader", 200, 0), new("MixShader", 450, 0)
    link(given.outputs["Warp Color"], mix.inputs[1])
    link(given.outputs["Weft Color"], mix.inputs[2])
    link(mix.outputs[0], darken.inputs[1])
    for node, socket in ((shader, "Base Color"), (behind, "Color")):
        link(darken.outputs[0], node.inputs[socket])
        link(given.outputs["Normal"], node.inputs["Normal"])
    # alpha squared over gloss, whose fourth root the roughness is
    least, root, wide = (new("Math", x, -250, name, operation=kind) for x, name, kind in (
        (-850, "", "MAXIMUM"), (-650, "", "POWER"), (-450, _GLOSS, "MULTIPLY")))
    least.inputs[1].default_value, root.inputs[1].default_value, wide.use_clamp = 1e-6, -0.25, True
    link(given.outputs["Gloss"], least.inputs[0])
    link(least.outputs[0], root.inputs[0])
    link(root.outputs[0], wide.inputs[0])
    link(wide.outputs[0], shader.inputs["Roughness"])
    link(given.outputs["Translucency"], through.inputs[0])
    link(shader.outputs[0], through.inputs[1])
    link(behind.outputs[0], through.inputs[2])
    link(given.outputs["Alpha"], whole.inputs[0])
    link(clear.outputs[0], whole.inputs[1])
    link(through.outputs[0], whole.inputs[2])
    link(whole.outputs[0], out.inputs["BSDF"])


def can_update(tree):
    """Is it as it was made, one time or another? Else someone has been inside."""
    return bool(tree) and all(tree.nodes.get(name) for name in _INSIDE)


def update(tree, weft_share, brightness, exponent):
    """weft_share: what shows of it; brightness: of the whole cloth beside that of its yarns."""
    inner, roughness = tree.nodes, (2.0 / (exponent + 2.0)) ** 0.25  # its square is alpha
    inner[_MIX].inputs[0].default_value = weft_share
    inner[_DARKEN].inputs[2].default_value = (*[brightness] * 3, 1.0)
    inner[_SHADER].inputs["Roughness"].default_value = roughness
    if _GLOSS in inner:
        inner[_GLOSS].inputs[1].default_value = roughness
