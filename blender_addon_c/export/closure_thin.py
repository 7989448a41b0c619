# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets in place of bodies: what is reflected between their two sides is summed, and light goes on straight."""

from .. import versions
from .closure_add import BLACK, WHITE, add, is_zero, times
from .closure_film import film_of
from .closure_lobe import Lobe, alpha_of, head_on_of
from .graph import is_known
from .node_fresnel import dielectric
from .value import clamped, dot, number_of

_CLEAR = 0.0037  # the roughness up to which such a sheet is transparent, to lamps too [measured: 5.2]


def thin_glass(reader, node, groups, base, edge, share, normal):
    """base: the colour of light that went through head-on; edge: of what is reflected there. Both lobes are scaled so that none is
    lost between facets, whichever distribution it is, as in Cycles [measured: 5.2]."""
    math = reader.program.math
    eta = math("MAXIMUM", number_of(reader, node.inputs["IOR"], groups), 1e-5)
    alpha = alpha_of(reader, node, groups)
    cosine = _cosine(reader, normal)
    sine = math("DIVIDE", math("SUBTRACT", 1.0, math("MULTIPLY", cosine, cosine)), math("MULTIPLY", eta, eta))
    way = math("DIVIDE", 1.0, math("SQRT", math("SUBTRACT", 1.0, sine)))  # through it, in units of the shortest
    whole, head_on = dielectric(reader, cosine, eta), head_on_of(reader, eta)
    rest = math("DIVIDE", math("SUBTRACT", whole, head_on), math("SUBTRACT", 1.0, head_on))
    back, on = [], []
    film = film_of(reader, node, groups)
    if film:
        reader.warn(f"'{node.name}': a thin film on a Thin Wall is up to .05 off from Cycles'")
        seen = reader.program.emit("THIN_FILM", cosine=[cosine], **film, film_eta=(eta,) * 3, film_k=BLACK)
        reflected = times(reader, tuple(seen), edge)
    else:
        reflected = tuple(math("MIX", math("MULTIPLY", head_on, tint), 1.0, rest) for tint in edge)
    for part, r in zip(base, reflected):
        left = math("POWER", clamped(reader, part), way)
        t = math("SUBTRACT", 1.0, r)
        again = math("MULTIPLY", left, r)
        through = math("DIVIDE", math("MULTIPLY", left, math("MULTIPLY", t, t)),
                       math("SUBTRACT", 1.0, math("MULTIPLY", again, again)))
        on.append(through)
        back.append(math("MULTIPLY", r, math("MULTIPLY_ADD", through, left, 1.0)))
    lobes = [(False, alpha, back)]
    roughness = number_of(reader, node.inputs["Roughness"], groups)
    if is_known(roughness) and roughness <= _CLEAR:
        add(reader, {"closure": "TRANSPARENT"}, times(reader, tuple(on), share))
    else:
        lobes.append((True, _through(reader, alpha, eta), on))
    for straight, alpha, color in lobes:
        kept = math("DIVIDE", 1.0, Lobe(reader, alpha, normal).one)
        add(reader, {"closure": "GLASS", "ior": [eta], "alpha": [alpha], "tint": WHITE, "reflects": True, "refracts": False,
                     "joint": versions.JOINT_SHADOWING, "straight": straight},
            times(reader, tuple(color), math("MULTIPLY", share, kept)), normal, tuple(color))


def _cosine(reader, normal):
    """Of the eye and a normal in the shading frame, or the surface's own."""
    program = reader.program
    eye = program.emit("FRAME", vector=program.emit("GEOMETRY", what="INCOMING"), to="SHADING")
    return clamped(reader, dot(reader, eye, normal) if normal else eye[2])


def _through(reader, alpha, eta):
    """Alpha of what has gone through both sides: that of two refractions, by the index."""
    math = reader.program.math
    half = math("SUBTRACT", eta, 0.5)
    by = math("MULTIPLY", math("SUBTRACT", eta, 1.0), math("MULTIPLY", half, half))
    by = math("DIVIDE", math("MULTIPLY", by, 3.4), math("MULTIPLY", eta, math("MULTIPLY", eta, eta)))
    return math("CLAMP", math("MULTIPLY", alpha, math("SQRT", by)), 1e-4, 1.0)


def beyond(reader, node, groups, roughness):
    """The part of what is matt that leaves on the other side: of light that goes into a sheet as much as is scattered forward."""
    math = reader.program.math
    below = clamped(reader, number_of(reader, node.inputs["Subsurface Weight"], groups))
    forward = math("MULTIPLY_ADD", number_of(reader, node.inputs["Subsurface Anisotropy"], groups), 0.5, 0.5)
    if not is_zero(below) and not (is_known(roughness) and roughness <= 0):
        reader.warn(f"'{node.name}': Diffuse Roughness of a Thin Wall's other side is not supported; left out")
    return math("MULTIPLY", below, clamped(reader, forward))
