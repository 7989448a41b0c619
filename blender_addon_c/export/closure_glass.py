# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of glass: Glass and Refraction BSDF."""

from .. import versions
from .closure_add import WHITE, add, normal_in, times
from .closure_film import film_of
from .closure_lobe import alpha_of, keeps_all, kept
from .value import color_of, number_of


def glass(reader, node, groups, share, reflects=True):
    color = color_of(reader, node.inputs["Color"], groups)
    alpha = alpha_of(reader, node, groups)
    add_glass(reader, node, groups, alpha, share, normal_in(reader, node, groups), color, reflects=reflects)


def refraction(reader, node, groups, share):
    glass(reader, node, groups, share, reflects=False)


def add_glass(reader, node, groups, alpha, share, normal, color=WHITE, **given):
    """Where the node says so, light that met the facets several times leaves as the rest does, each
    time in this colour."""
    seen = None
    if keeps_all(node, alpha):
        about = {"normal": normal} if normal else {}
        ior = number_of(reader, node.inputs["IOR"], groups)
        one, mean = reader.program.emit("GLASS_ALBEDO", 2, ior=[ior], alpha=[alpha], joint=versions.JOINT_SHADOWING,
                                        **about)
        factor = kept(reader, given.get("tint", color), one, mean)
        share = times(reader, factor, share)
        seen = tuple(reader.program.math("DIVIDE", 1.0, part) for part in factor)
    add(reader, _glass_closure(reader, node, groups, alpha=[alpha], **given, **film_of(reader, node, groups)),
        times(reader, color, share), normal, seen)


def _glass_closure(reader, node, groups, **given):
    ior = number_of(reader, node.inputs["IOR"], groups)
    joint = versions.JOINT_SHADOWING
    return {"closure": "GLASS", "ior": [ior], "tint": WHITE, "reflects": True, "refracts": True,
            "joint": joint, "flat": not joint and node.distribution != "MULTI_GGX",
            "beckmann": node.distribution == "BECKMANN", **given}
