# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes: one function for each, to a closure of the native module and what feeds it."""

from .. import nodes
from .node import color_of, normal_of, number_of


def _metal(reader, node, groups):
    color = color_of(reader, node.inputs["Color"], groups)
    normal_of(reader, node.inputs["Normal"], groups)
    return {**nodes.settings(node), "f0": color}


def _principled(reader, node, groups):
    """Its base layer: a metal, or a matt body under a clear surface. Of a mixture of the two a
    texture's colour goes to the one that weighs more."""
    inputs = node.inputs
    metallic = _clamp(number_of(reader, inputs["Metallic"], groups))
    color = color_of(reader, inputs["Base Color"], groups)
    normal_of(reader, inputs["Normal"], groups)
    _name_left_out(reader, node, _LEFT_OUT)
    if inputs["Alpha"].is_linked or inputs["Alpha"].default_value < 1:
        reader.warn(f"'{node.name}': Alpha is not supported; opaque")
    specular = _specular(reader, inputs, groups)
    return {**_glossy_lobe(reader, node, groups), "fresnel": "SCHLICK",
            "color_is": "F0" if metallic >= 0.5 else "KD",
            "f0": tuple(metallic * c + (1 - metallic) * specular for c in color),
            "kd": tuple((1 - metallic) * c for c in color)}


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
    if "Specular" in inputs:  # until 3.6
        return _clamp(0.08 * number_of(reader, inputs["Specular"], groups))
    ior = max(number_of(reader, inputs["IOR"], groups), 1.0)
    level = number_of(reader, inputs["Specular IOR Level"], groups)
    return _clamp(2 * level * ((ior - 1) / (ior + 1)) ** 2)


def _diffuse(reader, node, groups):
    color = color_of(reader, node.inputs["Color"], groups)
    normal_of(reader, node.inputs["Normal"], groups)
    _name_left_out(reader, node, ("Roughness",))
    return {"fresnel": "NONE", "f0": (0.0, 0.0, 0.0), "kd": color, "color_is": "KD"}


def _glossy(reader, node, groups):
    color = color_of(reader, node.inputs["Color"], groups)
    normal_of(reader, node.inputs["Normal"], groups)
    _name_left_out(reader, node, ("Anisotropy",))
    if node.distribution not in {"GGX", "MULTI_GGX"}:
        reader.warn(f"'{node.name}': {node.distribution.lower()} is not supported; shaded as GGX")
    return {**_glossy_lobe(reader, node, groups), "fresnel": "NONE", "f0": color}


def _glossy_lobe(reader, node, groups):
    """GGX of a node's roughness, whose square is alpha."""
    roughness = number_of(reader, node.inputs["Roughness"], groups)
    return {**of_roughness(_clamp(roughness)), "mdf": "ggx", "brdf": "microfacet"}


def _clamp(x):
    return min(max(x, 0.0), 1.0)


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
    alpha = max(roughness * roughness, 1e-4)
    exponent = nodes.exponent_of(alpha)
    return {"ex": exponent, "ey": exponent, "ax": alpha, "ay": alpha}
