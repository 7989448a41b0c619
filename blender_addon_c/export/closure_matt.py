# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of what is matt, of fibres on it, and of drawn looks: Diffuse, Subsurface, Translucent, Sheen (once Velvet) and Toon."""

from .. import versions
from . import tree
from .closure_add import BLACK, add, normal_in, times
from .closure_lobe import metal_closure
from .graph import is_known
from .value import clamped, color_of, number_of

_MATT = {"fresnel": "NONE", "horizon": "chiang" if versions.BUMPS_FADE else "estevez"}


def plain(color):
    """The closure of a Diffuse BSDF of one colour, without a reader."""
    return metal_closure(_MATT, f0=BLACK, kd=color)


def lambert(reader, color, share, normal):
    if normal and not reader.dumps:  # a dump knows metals and cloth
        add(reader, {"closure": "DIFFUSE", "model": "LAMBERT", "color": color, "roughness": [0.0]}, share, normal)
    else:
        add(reader, plain(color), share, normal)


def matt(reader, color, roughness, share, normal):
    if is_known(roughness) and roughness <= 0:
        lambert(reader, color, share, normal)
        return
    model = "EON" if versions.ENERGY_OREN_NAYAR else "OREN_NAYAR"
    add(reader, {"closure": "DIFFUSE", "model": model, "color": color, "roughness": [roughness]}, share, normal)


def diffuse(reader, node, groups, share):
    color, normal = color_of(reader, node.inputs["Color"], groups), normal_in(reader, node, groups)
    matt(reader, color, number_of(reader, node.inputs["Roughness"], groups), share, normal)


def subsurface(reader, node, groups, share):
    """Without a radius Cycles has a Diffuse BSDF too."""
    if spreads(node, "Scale", "Radius"):
        reader.warn(f"'{node.name}': light below the surface is not supported; shaded as a Diffuse BSDF of its colour")
    lambert(reader, color_of(reader, node.inputs["Color"], groups), share, normal_in(reader, node, groups))


def spreads(node, *names):
    """Do sockets say how far light goes below the surface?"""
    for name in names:
        socket = node.inputs.get(name)
        if socket and not socket.is_linked and not any(tree.color_in(socket)):
            return False
    return True


def velvet(reader, node, groups, share):
    _add_velvet(reader, node, groups, share, number_of(reader, node.inputs["Sigma"], groups))


def _add_velvet(reader, node, groups, share, sigma):
    color, normal = color_of(reader, node.inputs["Color"], groups), normal_in(reader, node, groups)
    add(reader, {"closure": "SHEEN", "model": "VELVET", "sigma": [sigma]}, times(reader, color, share), normal, color)


def sheen(reader, node, groups, share):
    roughness = clamped(reader, number_of(reader, node.inputs["Roughness"], groups))
    if node.distribution == "ASHIKHMIN":
        _add_velvet(reader, node, groups, share, roughness)
        return
    color = color_of(reader, node.inputs["Color"], groups)
    fibres(reader, color, roughness, share, normal_in(reader, node, groups))


def fibres(reader, color, roughness, share, normal):
    """What they reflect of even light, by colour."""
    about = {"normal": normal} if normal else {}
    a, b, one = reader.program.emit("FIBRES", roughness=[roughness], **about)
    seen = times(reader, color, one)
    add(reader, {"closure": "SHEEN", "model": "FIBRES", "a": [a], "b": [b]}, times(reader, seen, share), normal)
    return seen


def toon(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    size, smooth = (number_of(reader, node.inputs[name], groups) for name in ("Size", "Smooth"))
    mirrors = node.component == "GLOSSY"
    add(reader, {"closure": "TOON", "mirrors": mirrors, "overcounts": mirrors and versions.TOON_OVERCOUNTS,
                 "size": [size], "smooth": [smooth]}, times(reader, color, share), normal_in(reader, node, groups), color)


def translucent(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    add(reader, {"closure": "TRANSLUCENT"}, times(reader, color, share), normal_in(reader, node, groups))
