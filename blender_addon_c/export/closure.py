# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes: one function for each, to a closure of the native module and what feeds it."""

from .. import nodes
from .node import color_of, normal_of


def _metal(reader, node, groups):
    color = color_of(reader, node.inputs["Color"], groups)
    normal_of(reader, node.inputs["Normal"], groups)
    return {**nodes.settings(node), "f0": color}


def _principled(reader, node, groups):
    reader.warn("no Libshade Metal node; its Principled BSDF is rendered as metal of its base "
                "colour and roughness")
    color = color_of(reader, node.inputs["Base Color"], groups)
    normal_of(reader, node.inputs["Normal"], groups)
    return {**of_roughness(node.inputs["Roughness"].default_value), "f0": color}


# By the node's bl_idname.
CLOSURES = {nodes.METAL: _metal, "ShaderNodeBsdfPrincipled": _principled}


def of_roughness(roughness):
    """Settings of an isotropic metal of Blender's roughness, whose square is alpha."""
    alpha = max(roughness * roughness, 1e-4)
    exponent = nodes.exponent_of(alpha)
    return {"ex": exponent, "ey": exponent, "ax": alpha, "ay": alpha}
