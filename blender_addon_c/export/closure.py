# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes: one function for each, to a closure of the native module and what feeds it."""

from .. import nodes
from .graph import is_known
from .node import color_of, normal_of, number_of


def _given(reader, node, groups, settings, **parts):
    """A metal's settings: f0, kd (three parts) and alpha, and what nodes say of them."""
    made = dict(settings)
    for name, given in parts.items():
        if name == "alpha":
            made |= _alpha(given)
            continue
        made[name] = tuple(part if is_known(part) else 1.0 for part in given)
        if not is_known(*given):
            made[f"{name}_from"] = given
    normal = normal_of(reader, node.inputs["Normal"], groups)
    return {**made, "normal": normal} if normal else made


def _alpha(alpha):
    if is_known(alpha):
        return of_alpha(alpha)
    return {**of_alpha(1.0), "ax_from": [alpha], "ay_from": [alpha]}


def _metal(reader, node, groups):
    color = color_of(reader, node.inputs["Color"], groups)
    return _given(reader, node, groups, nodes.settings(node), f0=color)


def _principled(reader, node, groups):
    """Its base layer: a metal, or a matt body under a clear surface."""
    inputs, math = node.inputs, reader.program.math
    metallic = _clamp(reader, number_of(reader, inputs["Metallic"], groups))
    color = color_of(reader, inputs["Base Color"], groups)
    _name_left_out(reader, node, _LEFT_OUT)
    if inputs["Alpha"].is_linked or inputs["Alpha"].default_value < 1:
        reader.warn(f"'{node.name}': Alpha is not supported; opaque")
    specular = _specular(reader, inputs, groups)
    matt = math("SUBTRACT", 1.0, metallic)
    return _given(reader, node, groups, {"fresnel": "SCHLICK", **_GGX},
                  alpha=_alpha_of(reader, node, groups),
                  f0=tuple(math("MIX", specular, c, metallic) for c in color),
                  kd=tuple(math("MULTIPLY", matt, c) for c in color))


# Lobes of the Principled BSDF that have no closure yet, by their socket in one version or another.
_LEFT_OUT = ("Subsurface", "Subsurface Weight", "Transmission", "Transmission Weight", "Sheen",
             "Sheen Weight", "Clearcoat", "Coat Weight", "Emission Strength", "Anisotropic")


def _name_left_out(reader, node, names):
    """A warning for each of these sockets that says something."""
    for name in names:
        socket = node.inputs.get(name)
        if socket and (socket.is_linked or socket.default_value) and _emits(name, node.inputs):
            reader.warn(f"'{node.name}': {name} is not supported; left out")


def _emits(name, inputs):
    """False for the strength of an emission that is black, as it is in a new node."""
    if name != "Emission Strength":
        return True
    color = inputs.get("Emission Color") or inputs["Emission"]  # the latter until 3.6
    return color.is_linked or any(color.default_value[:3])


def _specular(reader, inputs, groups):
    """Reflectance of the clear surface at normal incidence."""
    math = reader.program.math
    if "Specular" in inputs:  # until 3.6
        level = number_of(reader, inputs["Specular"], groups)
        return _clamp(reader, math("MULTIPLY", level, 0.08))
    ior = math("MAXIMUM", number_of(reader, inputs["IOR"], groups), 1.0)
    root = math("DIVIDE", math("SUBTRACT", ior, 1.0), math("ADD", ior, 1.0))
    level = math("MULTIPLY", number_of(reader, inputs["Specular IOR Level"], groups), 2.0)
    return _clamp(reader, math("MULTIPLY", level, math("MULTIPLY", root, root)))


def _diffuse(reader, node, groups):
    _name_left_out(reader, node, ("Roughness",))
    return _given(reader, node, groups, {"fresnel": "NONE"}, f0=(0.0, 0.0, 0.0),
                  kd=color_of(reader, node.inputs["Color"], groups))


def _glossy(reader, node, groups):
    _name_left_out(reader, node, ("Anisotropy",))
    if node.distribution not in {"GGX", "MULTI_GGX"}:
        reader.warn(f"'{node.name}': {node.distribution.lower()} is not supported; shaded as GGX")
    return _given(reader, node, groups, {"fresnel": "NONE", **_GGX},
                  alpha=_alpha_of(reader, node, groups),
                  f0=color_of(reader, node.inputs["Color"], groups))


_GGX = {"mdf": "ggx", "brdf": "microfacet"}


def _alpha_of(reader, node, groups):
    """Of a node's roughness the square."""
    roughness = _clamp(reader, number_of(reader, node.inputs["Roughness"], groups))
    return reader.program.math("MAXIMUM", reader.program.math("MULTIPLY", roughness, roughness),
                               1e-4)


def _clamp(reader, x):
    return reader.program.math("CLAMP", x, 0.0, 1.0)


# By the node's bl_idname.
CLOSURES = {
    nodes.METAL: _metal,
    "ShaderNodeBsdfPrincipled": _principled,
    "ShaderNodeBsdfDiffuse": _diffuse,
    "ShaderNodeBsdfGlossy": _glossy,
    "ShaderNodeBsdfAnisotropic": _glossy,
}


def of_roughness(roughness):
    """Settings of an isotropic metal of Blender's roughness, whose square is alpha."""
    return of_alpha(max(roughness * roughness, 1e-4))


def of_alpha(alpha):
    exponent = nodes.exponent_of(alpha)
    return {"ex": exponent, "ey": exponent, "ax": alpha, "ay": alpha}
