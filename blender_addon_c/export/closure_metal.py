# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of metal: Libshade Metal, Glossy (once Anisotropic) and Metallic BSDF."""

from .. import metal_tree, nodes, versions
from . import tree
from .closure_add import WHITE, add, is_bright, normal_in, times
from .closure_film import film_of, tinted
from .closure_groove import drawn_out, in_frame, pulled, rotated, stretched, tangent
from .closure_lobe import GGX, LOBES, Lobe, alpha_of, apart, keeps_all, mean_of, metal_closure
from .node_place import along_axis, round_tangent, tangent_of_map
from .strokes import is_worn, worn
from .value import clamped, color_of

_AT_82 = metal_tree.AT_82
_DIP = 7 * (7 / 6) ** 6 / 126  # the mean over the directions of x (1 - x)^6 scaled to 1 at 82 degrees


def metal(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    settings, parts = {**nodes.settings(node), "stock": False, "shape": node.bumps_are == "SHAPE",
                       "fresnel": nodes.fresnel_of(node).lower()}, {"f0": color}
    if nodes.sockets_rule(node, nodes.SHAPE):
        parts["alpha"] = pulled(reader, node, groups, alpha_of(reader, node, groups))
    if is_worn(node):
        worn(reader, node, groups, settings, parts)
    for part, names in (("kd", nodes.MATT_COLOR), ("f82", nodes.EDGE)):
        if nodes.sockets_rule(node, names) or part == "f82" and nodes.colors_rule(node):
            tint = color_of(reader, node.inputs[names[0]], groups)
            parts[part] = tuple(clamped(reader, by) for by in tint)
    normal = normal_in(reader, node, groups) if node.bump_response == "FOLLOW" else None
    linked = "Tangent" in node.inputs and tree.trace(node.inputs["Tangent"], groups).node
    groove = tangent(reader, node, groups) if linked else _grain(reader, node)
    reader.by_mesh = reader.by_mesh or not groove
    if "Rotation" in node.inputs:
        groove = rotated(reader, groove, node.inputs["Rotation"], groups)
    add(reader, metal_closure(settings, groove=groove, **parts), share, normal)


def _grain(reader, node):
    """Where strokes run if nothing is linked to Tangent, as closure_groove.tangent."""
    kind, _space, axis = node.grain.partition("_")
    if kind == "RADIAL":
        vector = round_tangent(reader, axis)
    elif kind == "AXIS":
        vector = along_axis(reader, metal_tree.axis_vector(axis))
    else:
        vector = tangent_of_map(reader, node.uv_map) if node.uv_map or reader.uv_map else None
    return vector and in_frame(reader, vector)


def glossy(reader, node, groups, share):
    color, alpha = color_of(reader, node.inputs["Color"], groups), alpha_of(reader, node, groups)
    normal, distribution = normal_in(reader, node, groups), node.distribution
    if distribution not in LOBES:
        reader.warn(f"'{node.name}': {distribution.lower()} is not supported; shaded as GGX")
        distribution = "GGX"
    alphas, groove = stretched(reader, node, groups, alpha)
    if distribution == "BECKMANN" and alphas[0] != alphas[1] and not versions.JOINT_SHADOWING:
        reader.warn(f"'{node.name}': Cycles of this version shades a stretched Beckmann a few percent brighter")
    seen = None
    if is_bright(reader, color):
        share, own = times(reader, color, share), WHITE
    else:
        own = color
    if keeps_all(node, alpha):
        lobe = Lobe(reader, alphas, normal, groove)
        kept = lobe.kept(color)
        share = times(reader, kept, share)
        seen = (times(reader, own, lobe.one) if versions.JOINT_SHADOWING else
                tuple(reader.program.math("DIVIDE", part, by) for part, by in zip(own, kept)))
    add(reader, metal_closure({"fresnel": "NONE", **LOBES[distribution], **apart(distribution)}, f0=own,
                              alpha=alphas, groove=groove), share, normal, seen)


def metallic(reader, node, groups, share):
    """The Metallic BSDF of 4.3 on: colours head-on and at 82 degrees, or a conductor's."""
    alpha, normal = alpha_of(reader, node, groups), normal_in(reader, node, groups)
    alphas, groove = drawn_out(reader, node, groups, alpha, "Anisotropy", "Rotation")
    settings, parts, head_on, lost = (_colored if node.fresnel_type == "F82" else _conducting)(reader, node.inputs, groups)
    film = film_of(reader, node, groups)
    if film:
        film |= ({"film_eta": parts["eta"], "film_k": parts["k"]} if "k" in parts else
                 tinted(reader, parts["f0"], parts["f82"]))
        settings, parts = {"fresnel": "NONE"}, {"f0": WHITE}
    lobe = Lobe(reader, alphas, normal, groove)
    if keeps_all(node, alpha):
        share = times(reader, lobe.kept(_means(reader, head_on, lost)), share)
    made = metal_closure({**LOBES.get(node.distribution, GGX), **settings}, alpha=alphas, groove=groove, **parts)
    add(reader, made | film, share, normal, tuple(map(lobe.albedo, head_on)))


def _colored(reader, inputs, groups):
    """(settings of a METAL, its parts, what it reflects head-on, and at 82 degrees less than Schlick's)"""
    math, base = reader.program.math, color_of(reader, inputs["Base Color"], groups)
    edge = tuple(clamped(reader, part) for part in color_of(reader, inputs["Edge Tint"], groups))
    lost = tuple(math("MULTIPLY", _schlick_82(reader, part), math("SUBTRACT", 1.0, by)) for part, by in zip(base, edge))
    return {"fresnel": "F82"}, {"f0": base, "f82": edge}, base, lost


def _conducting(reader, inputs, groups):
    """The same."""
    math = reader.program.math
    eta, k = (tuple(math("MAXIMUM", part, 0.0) for part in color_of(reader, inputs[name], groups))
              for name in ("IOR", "Extinction"))
    head_on = tuple(_conductor(reader, n, x, 1.0) for n, x in zip(eta, k))
    lost = tuple(math("SUBTRACT", _schlick_82(reader, part), _conductor(reader, n, x, 1 / 7))
                 for part, n, x in zip(head_on, eta, k))
    return {"fresnel": "CONDUCTOR"}, {"f0": WHITE, "eta": eta, "k": k}, head_on, lost


def _schlick_82(reader, head_on):
    return reader.program.math("MULTIPLY_ADD", head_on, 1 - _AT_82, _AT_82)


def _means(reader, head_on, lost):
    """Over the directions, of Schlick's and of the dip at 82 degrees."""
    return tuple(reader.program.math("MULTIPLY_ADD", less, -_DIP, mean_of(reader, part)) for part, less in zip(head_on, lost))


def _conductor(reader, n, k, cosine):
    """Reflectance of even light, not polarised, where the index is large against 1: within a hundredth."""
    math = reader.program.math
    square = math("ADD", math("MULTIPLY", n, n), math("MULTIPLY", k, k))
    middle, parts = math("MULTIPLY", n, 2.0 * cosine), []
    for low, high in ((square, cosine * cosine), (math("MULTIPLY", square, cosine * cosine), 1.0)):
        whole = math("ADD", low, high)
        parts.append(math("DIVIDE", math("SUBTRACT", whole, middle), math("ADD", whole, middle)))
    return math("MULTIPLY", 0.5, math("ADD", *parts))
