# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes of microfacets: a METAL of the native module, and what it reflects of even light."""

from .. import nodes, versions
from .closure_add import turned
from .graph import is_known
from .value import clamped, number_of

GGX = {"mdf": "ggx", "brdf": "microfacet"}
LOBES = {
    "GGX": GGX, "MULTI_GGX": GGX, "SHARP": GGX,
    "BECKMANN": {"mdf": "beckmann", "brdf": "microfacet"},
    "ASHIKHMIN_SHIRLEY": {"mdf": "ashikhmin_shirley", "brdf": "ashikhmin_shirley"},
}


def metal_closure(settings, **parts):
    """A METAL: settings, and what may be a register: f0, kd, f82, eta (three parts each), alpha (one
    or two), groove (two)."""
    made = {"closure": "METAL", **nodes.initial_settings(), "stock": True, **settings}
    for name, given in parts.items():
        if name == "groove":
            made |= {"groove_from": given} if given else {}
        elif name == "alpha":
            made |= _alphas(*(given if isinstance(given, tuple) else (given, given)))
        else:
            made[name] = tuple(part if is_known(part) else 1.0 for part in given)
            made |= {} if is_known(*given) else {f"{name}_from": given}
    return made


def _alphas(x, y):
    made = {}
    for axis, alpha in (("x", x), ("y", y)):
        known = min(max(alpha, 1e-4), 10.0) if is_known(alpha) else 1.0
        made |= {f"a{axis}": known, f"e{axis}": nodes.exponent_of(known)}
        made |= {} if is_known(alpha) else {f"a{axis}_from": [alpha]}
    return made


def alpha_of(reader, node, groups, name="Roughness"):
    """Of a node's roughness the square; of one without, 0."""
    socket = node.inputs.get(name)
    if not socket or getattr(node, "distribution", "") == "SHARP":
        return 1e-4
    roughness = clamped(reader, number_of(reader, socket, groups))
    return reader.program.math("MAXIMUM", reader.program.math("MULTIPLY", roughness, roughness),
                               1e-4)


def is_smooth(alpha):
    """Too sharp for light to be lost between facets."""
    return is_known(alpha) and alpha < 1e-3


def keeps_all(node, alpha):
    """Does light that meets facets several times leave such a node's lobe as the rest does?"""
    return getattr(node, "distribution", "GGX") == "MULTI_GGX" and not is_smooth(alpha)


def apart(distribution):
    """How Cycles' lobe is shadowed, where one bounce is all."""
    return {"apart": True} if not versions.JOINT_SHADOWING and distribution in ("GGX", "BECKMANN") else {}


def kept(reader, color, one, mean):
    """By which factor several bounces between facets raise a lobe of this mean reflectance, of which
    `one` is left, in the mean over all directions `mean` [KullaConty2017], as Cycles has it from 4.0
    on."""
    math = reader.program.math
    missing = math("DIVIDE", math("SUBTRACT", 1.0, one), one)
    lost = math("SUBTRACT", 1.0, mean)
    parts = []
    for part in color:
        again = math("DIVIDE", math("MULTIPLY", part, mean),
                     math("SUBTRACT", 1.0, math("MULTIPLY", part, lost)))
        parts.append(math("MULTIPLY_ADD", again, missing, 1.0))
    return tuple(parts)


class Lobe:
    """What a GGX lobe reflects of even light: `one` with a Fresnel of 1, `clear` a clear body's from 0 head-on to 1,
    `mean` the first's mean. alphas: along the tangent, which points to `groove` (None: the mesh's own), and across it, or one
    of both. From 4.0 on Cycles looks up a round one whose alpha is the geometric mean."""

    def __init__(self, reader, alphas, normal, groove=None):
        given = {"normal": turned(reader, normal)} if normal else {}
        self._reader, self._math = reader, reader.program.math
        x, y = alphas if isinstance(alphas, tuple) else (alphas, alphas)
        if x is not y and versions.JOINT_SHADOWING:
            x = self._math("SQRT", self._math("MULTIPLY", x, y))
        elif x is not y:
            given |= {"across": [y], "along": groove or (1.0, 0.0)}
        self.one, self.clear, self.mean = reader.program.emit("ALBEDO", alpha=[x], **given)

    def kept(self, color):
        return kept(self._reader, color, self.one, self.mean)

    def albedo(self, head_on):
        """Of a clear body with this reflectance head-on."""
        math = self._math
        rest = math("SUBTRACT", 1.0, head_on)
        return math("MULTIPLY_ADD", head_on, self.one, math("MULTIPLY", rest, self.clear))


# ---- what depends on the angle


def mean_of(reader, head_on):
    """Schlick's mean over the directions."""
    return reader.program.math("MULTIPLY_ADD", head_on, 20 / 21, 1 / 21)


def head_on_of(reader, eta):
    """What a clear body of this index reflects head-on."""
    math = reader.program.math
    root = math("DIVIDE", math("SUBTRACT", eta, 1.0), math("ADD", eta, 1.0))
    return math("MULTIPLY", root, root)


def eta_of(reader, head_on):
    """The index whose reflectance this is, at most of .99."""
    math = reader.program.math
    root = math("SQRT", math("CLAMP", head_on, 0.0, 0.99))
    return math("DIVIDE", math("ADD", 1.0, root), math("SUBTRACT", 1.0, root))
