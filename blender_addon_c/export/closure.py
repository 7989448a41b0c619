# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes, to closures of the native module and what feeds them. They follow Cycles of the Blender that runs.

`collect` follows Mix and Add Shader; every shader that they lead to adds its closures, with its share
as their weight, to the material's reader: a function of a closure_*.py for each, in the table CLOSURES.
"""

from ..names import FABRIC, METAL
from . import cloth, tree
from .closure_add import WHITE, is_zero, normal_in, times
from .closure_glass import glass, refraction
from .closure_light import emission, holdout, ray_portal, shine, transparent
from .closure_matt import diffuse, lambert, sheen, subsurface, toon, translucent, velvet
from .closure_metal import glossy, metal, metallic
from .closure_principled import principled
from .value import clamped, color_of, number_of

# By the node's bl_idname.
CLOSURES = {
    METAL: metal,
    FABRIC: cloth.fabric_node,
    "ShaderNodeBsdfPrincipled": principled,
    "ShaderNodeBsdfDiffuse": diffuse,
    "ShaderNodeBsdfGlossy": glossy,
    "ShaderNodeBsdfAnisotropic": glossy,
    "ShaderNodeBsdfMetallic": metallic,
    "ShaderNodeBsdfGlass": glass,
    "ShaderNodeBsdfRefraction": refraction,
    "ShaderNodeBsdfSheen": sheen,
    "ShaderNodeBsdfVelvet": velvet,
    "ShaderNodeBsdfToon": toon,
    "ShaderNodeBsdfTranslucent": translucent,
    "ShaderNodeSubsurfaceScattering": subsurface,
    "ShaderNodeBsdfTransparent": transparent,
    "ShaderNodeBsdfRayPortal": ray_portal,
    "ShaderNodeEmission": emission,
    "ShaderNodeBackground": emission,
    "ShaderNodeHoldout": holdout,
}


def collect(reader, socket, groups, share=1.0):
    """All closures of what feeds a shader socket. share: a number or register."""
    found = tree.trace(socket, groups)
    node = found.node
    if node is None or is_zero(share):
        return
    key = (node, found.groups)
    if key in reader.open:
        reader.warn(f"'{node.name}' feeds itself; the link is left out")
        return
    reader.open.add(key)
    if node.type in ("MIX_SHADER", "ADD_SHADER"):
        _combined(reader, found, share)
    elif node.bl_idname in CLOSURES:
        CLOSURES[node.bl_idname](reader, node, found.groups, share)
    elif found.output.type != "SHADER":  # what is no shader shines
        shine(reader, color_of(reader, socket, groups), share)
    else:
        _unknown(reader, found, share)
    reader.open.remove(key)


def _combined(reader, found, share):
    inputs, math = found.node.inputs, reader.program.math
    if found.node.type == "ADD_SHADER":
        for socket in inputs:
            collect(reader, socket, found.groups, share)
        return
    factor = clamped(reader, number_of(reader, inputs[0], found.groups))
    collect(reader, inputs[1], found.groups,
            math("MULTIPLY", share, math("SUBTRACT", 1.0, factor)))
    collect(reader, inputs[2], found.groups, math("MULTIPLY", share, factor))


def _unknown(reader, found, share):
    """Its first shader, else a matt surface of its colour: never black without a word."""
    node = found.node
    shader = next((s for s in node.inputs if s.type == "SHADER" and s.is_linked), None)
    color = node.inputs.get("Color")
    if node.type in ("GROUP", "GROUP_INPUT"):
        reader.warn(f"'{node.name}' ({found.output.name}) has nothing to shade by; left out")
    elif shader:
        reader.warn(f"'{node.name}' is not supported; what feeds it is used")
        collect(reader, shader, found.groups, share)
    elif color:
        reader.warn(f"'{node.name}' is not supported; shaded as a Diffuse BSDF of its colour")
        lambert(reader, color_of(reader, color, found.groups), share,
                normal_in(reader, node, found.groups))
    else:
        reader.warn(f"'{node.name}' is not supported; left out")


# ---- what becomes of all closures of a material


def shading(reader, way, seen):
    """What is transparent is so for rays that are of this way (a word of the native node PATH), or for all others."""
    math = reader.program.math
    for number, closure in enumerate(reader.closures):
        if closure["closure"] == "TRANSPARENT":
            share = reader.program.emit("PATH", 1, what=way)[0]
            share = share if seen else math("SUBTRACT", 1.0, share)
            reader.closures[number] = {**closure, "weight": times(reader, tuple(closure.get("weight", WHITE)), share)}


def held_out(reader):
    """The camera sees a hole in the place of all but what is transparent; nothing else does."""
    math = reader.program.math
    camera = reader.program.emit("PATH", 1, what="FILM")[0]
    held, kept, others = (camera,) * 3, [], math("SUBTRACT", 1.0, camera)
    for closure in reader.closures:
        weight = tuple(closure.get("weight", WHITE))
        if closure["closure"] == "TRANSPARENT":
            held = tuple(clamped(reader, math("SUBTRACT", part, math("MULTIPLY", camera, by)))
                         for part, by in zip(held, weight))
            kept.append(closure)
        elif not closure.get("holds"):
            kept.append({**closure, "weight": times(reader, weight, others)})
    reader.closures = [{"closure": "EMISSION", "holds": True, "weight": held}, *kept]
