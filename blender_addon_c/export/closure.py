# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes: one function for each, to closures of the native module and what feeds them.

`collect` follows Mix and Add Shader; every shader that they lead to adds its closures, with its share
as their weight, to the material's reader. They follow Cycles of the Blender that runs.
"""

from types import SimpleNamespace

from .. import fabric, metal_tree, nodes, versions
from . import cloth, tree
from .graph import is_known
from .node_place import along_axis, round_tangent, tangent_of, tangent_of_map
from .value import color_of, normal_of, number_of

_WHITE, _BLACK = (1.0,) * 3, (0.0,) * 3
_LUMINANCE = (0.2126, 0.7152, 0.0722)  # of Rec. 709


def collect(reader, socket, groups, share=1.0):
    """All closures of what feeds a shader socket. share: a number or register."""
    found = tree.trace(socket, groups)
    node = found.node
    if node is None or (is_known(share) and share == 0):
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
        _shine(reader, color_of(reader, socket, groups), share)
    else:
        _unknown(reader, found, share)
    reader.open.remove(key)


def _combined(reader, found, share):
    inputs, math = found.node.inputs, reader.program.math
    if found.node.type == "ADD_SHADER":
        for socket in inputs:
            collect(reader, socket, found.groups, share)
        return
    factor = _clamp(reader, number_of(reader, inputs[0], found.groups))
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
        _lambert(reader, color_of(reader, color, found.groups), share,
                 _normal(reader, node, found.groups))
    else:
        reader.warn(f"'{node.name}' is not supported; left out")


# ---- what closures are made of


def _clamp(reader, x):
    return reader.program.math("CLAMP", x, 0.0, 1.0)


def _times(reader, color, factor):
    """factor: one for all, or three parts."""
    by = factor if isinstance(factor, tuple) else (factor,) * 3
    return tuple(reader.program.math("MULTIPLY", part, other) for part, other in zip(color, by))


def _normal(reader, node, groups, name="Normal"):
    socket = node.inputs.get(name)
    return normal_of(reader, socket, groups) if socket else reader.bumped


def _add(reader, closure, weight, normal=None, color=None):
    """weight: three parts, or one for all. What weighs nothing is left out. A `stock` metal is one of
    Cycles' own shaders. color: in passes of colour, where it is not what the closure says, by its
    weight."""
    stock = closure.pop("stock", False)
    if stock:
        closure |= {} if reader.transport else {"detail": "gram_schmidt"}
        if reader.bumped:  # Cycles fades by what bumps turn a displaced normal: less than they turn this one
            closure["horizon"] = "hard" if closure["f0"] == _BLACK else "valid_reflection"
    if normal and normal[0] in reader.filtered and _is_even(closure):
        normal, weight = _filtered(reader, closure, normal, weight)
    if normal and not reader.dumps:
        normal = _valid(reader, closure, normal, stock)
    weight = tuple(weight) if isinstance(weight, (tuple, list)) else (weight,) * 3
    if closure["closure"] == "DIFFUSE" or (stock and closure["fresnel"] == "NONE" and closure["f0"] == _BLACK):
        weight = _colored(reader, closure, weight)
    shines = closure["closure"] == "EMISSION"  # below 0, too, as in Cycles
    if is_known(*weight) and not any(part > 0 or (shines and part < 0) for part in weight):
        return
    if not is_known(*weight) or weight != _WHITE:
        closure = {**closure, "weight": weight}
    if reader.colors and color:
        closure = {**closure, "pass_color": tuple(color)}
    reader.closures.append({**closure, "normal": normal} if normal else closure)


def _colored(reader, closure, weight):
    """The weight of a matt closure, with its colour where that may be above 1, as in Cycles: closures clamp theirs,
    weights not."""
    metal = closure["closure"] == "METAL"
    color = closure.get("kd_from", closure["kd"]) if metal else closure["color"]
    if not _is_bright(reader, color):
        return weight
    if closure.get("model") == "EON":  # of several bounces: what is above 1 alone
        more = tuple(reader.program.math("MAXIMUM", part, 1.0) for part in color)
        closure["color"] = tuple(reader.program.math("MINIMUM", part, 1.0) for part in color)
        return _times(reader, more, weight)
    closure.pop("kd_from", None)
    closure["kd" if metal else "color"] = _WHITE
    return _times(reader, color, weight)


def _is_bright(reader, color):
    """May it be above 1? A dump holds what a closure says."""
    return not reader.dumps and any(reader.most(part) > 1 for part in color)


def _valid(reader, closure, normal, stock):
    """The normal that Cycles' closure takes, here in place of a horizon of our own: so that the eye's mirror
    image is not below the surface, but from some version on not of what is matt. With grooves that go with
    bumps metals keep theirs."""
    kind, below = closure["closure"], reader.below.get(normal[0], normal)
    if kind == "METAL":
        if stock and not reader.transport:
            closure["horizon"] = "hard"
        return _turned(reader, normal) if stock else normal
    elif kind == "DIFFUSE" and reader.bumped:
        return below
    elif kind == "DIFFUSE":
        closure["bumps"] = "FADED" if versions.BUMPS_FADE else "SHADED"
        if not versions.BUMPS_FADE:
            return below
    return reader.program.emit("BEND", normal=below)


def _turned(reader, normal):
    """Of what shines."""
    if reader.transport or reader.dumps:
        return normal
    return reader.program.emit("BEND", normal=reader.below.get(normal[0], normal))


def _metal_closure(settings, **parts):
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


_GGX = {"mdf": "ggx", "brdf": "microfacet"}
_LOBES = {
    "GGX": _GGX, "MULTI_GGX": _GGX, "SHARP": _GGX,
    "BECKMANN": {"mdf": "beckmann", "brdf": "microfacet"},
    "ASHIKHMIN_SHIRLEY": {"mdf": "ashikhmin_shirley", "brdf": "ashikhmin_shirley"},
}


def _alpha_of(reader, node, groups, name="Roughness"):
    """Of a node's roughness the square; of one without, 0."""
    socket = node.inputs.get(name)
    if not socket or getattr(node, "distribution", "") == "SHARP":
        return 1e-4
    roughness = _clamp(reader, number_of(reader, socket, groups))
    return reader.program.math("MAXIMUM", reader.program.math("MULTIPLY", roughness, roughness),
                               1e-4)


def _kept(reader, color, one, mean):
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


class _Lobe:
    """What a round GGX lobe reflects of even light: `one` with a Fresnel of 1, `clear` a clear body's
    from 0 head-on to 1, `mean` the first's mean."""

    def __init__(self, reader, alpha, normal):
        given = {"normal": _turned(reader, normal)} if normal else {}
        self._reader, self._math = reader, reader.program.math
        self.one, self.clear, self.mean = reader.program.emit("ALBEDO", alpha=[alpha], **given)

    def kept(self, color):
        return _kept(self._reader, color, self.one, self.mean)

    def albedo(self, head_on):
        """Of a clear body with this reflectance head-on."""
        math = self._math
        rest = math("SUBTRACT", 1.0, head_on)
        return math("MULTIPLY_ADD", head_on, self.one, math("MULTIPLY", rest, self.clear))


def _is_even(closure):
    """A lobe that stays as it is where it is widened: about a Gaussian of slopes. GGX's tails would
    grow with it, to a half too much light beside highlights."""
    return (closure["closure"] == "METAL" and closure["f0"] != _BLACK and
            closure["mdf"].lower() in ("ashikhmin_shirley", "beckmann", "ward", "ward_half"))


def _filtered(reader, closure, normal, weight):
    """The mean normal, a lobe as wide as its bumps make it, along its grooves and across (where these
    are turned, both as much), and its weight: a wide lobe loses light between its facets, bumps do not."""
    math = reader.program.math
    normal, spread = reader.filtered[normal[0]]
    if "groove_from" in closure:
        spread = (math("MULTIPLY", math("ADD", *spread), 0.5),) * 2
    if closure["mdf"].lower() == "ashikhmin_shirley":
        return normal, _filtered_cosines(reader, closure, spread, weight)
    before, after = 0.0, 0.0  # sums of squares
    for axis, more in zip("xy", spread):
        square, wide = _widened(reader, closure, axis, more)
        before, after = math("ADD", before, square), math("ADD", after, wide)
    if (closure["mdf"].lower(), closure["brdf"].lower()) != ("beckmann", "microfacet"):
        return normal, weight
    return normal, _kept_by(reader, normal, "BECKMANN", before, after, weight)


def _widened(reader, closure, axis, more):
    """The square of an alpha, and with that of bumps; how Beckmann's narrows these, shade/maps.h says."""
    math = reader.program.math
    alpha = closure.get(f"a{axis}_from", [closure[f"a{axis}"]])[0]
    square = math("MULTIPLY", alpha, alpha)
    if closure["mdf"].lower() == "beckmann":
        part = 1.0 if closure["brdf"].lower() == "microfacet" else 0.5
        narrow = math("DIVIDE", 1.0, math("MULTIPLY_ADD", square, part, 1.0))
        more = math("MULTIPLY", more, math("MULTIPLY", narrow, narrow))
    wide = math("ADD", square, more)
    closure[f"a{axis}_from"] = [math("SQRT", wide)]
    return square, wide


def _kept_by(reader, normal, lobe, before, after, weight):
    """A weight by which a wide lobe reflects as much as the one before."""
    math = reader.program.math
    kept = math("DIVIDE", *(reader.program.emit("ALBEDO", lobe=lobe, normal=normal,
                                                alpha=[math("SQRT", math("MULTIPLY", sum_, 0.5))])[0]
                            for sum_ in (before, after)))
    parts = weight if isinstance(weight, (tuple, list)) else (weight,) * 3
    return tuple(math("MULTIPLY", part, kept) for part in parts)


def _filtered_cosines(reader, closure, spread, weight):
    """About its middle a power e of the cosine, scaled to 1, is a Gaussian of slopes of the variance 1 / (e + 1);
    alpha squared is 2 / (e + 2). Which cosines count, and so what is lost, the bumps' share says."""
    math, shares = reader.program.math, []
    for axis, more in zip("xy", spread):
        alpha = closure.get(f"a{axis}_from", [closure[f"a{axis}"]])[0]
        square = math("MULTIPLY", alpha, alpha)
        own = math("DIVIDE", square, math("SUBTRACT", 2.0, math("MINIMUM", square, 1.0)))
        wide = math("MULTIPLY_ADD", more, 0.5, own)
        closure[f"a{axis}_from"] = [math("SQRT", math("DIVIDE", math("MULTIPLY", wide, 2.0), math("ADD", wide, 1.0)))]
        shares.append(math("SUBTRACT", 1.0, math("DIVIDE", own, wide)))
    if closure["brdf"].lower() == "ashikhmin_shirley":
        closure["bumps_from"] = shares
    return weight


def _is_smooth(alpha):
    """Too sharp for light to be lost between facets."""
    return is_known(alpha) and alpha < 1e-3


# ---- shaders


def _metal(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    settings, parts = {**nodes.settings(node), "stock": False, "fresnel": nodes.fresnel_of(node).lower()}, {"f0": color}
    if nodes.sockets_rule(node, nodes.SHAPE):
        parts["alpha"] = _pulled(reader, node, groups, _alpha_of(reader, node, groups))
    for part, names in (("kd", nodes.MATT_COLOR), ("f82", nodes.EDGE)):
        if nodes.sockets_rule(node, names) or part == "f82" and nodes.colors_rule(node):
            tint = color_of(reader, node.inputs[names[0]], groups)
            parts[part] = tuple(_clamp(reader, by) for by in tint)
    normal = _normal(reader, node, groups) if node.bump_response == "FOLLOW" else None
    linked = "Tangent" in node.inputs and tree.trace(node.inputs["Tangent"], groups).node
    groove = _tangent(reader, node, groups) if linked else _grain(reader, node)
    if "Rotation" in node.inputs:
        groove = _rotated(reader, groove, node.inputs["Rotation"], groups)
    _add(reader, _metal_closure(settings, groove=groove, **parts), share, normal)


def _grain(reader, node):
    """Where strokes run if nothing is linked to Tangent, as _tangent."""
    kind, _space, axis = node.grain.partition("_")
    if kind == "RADIAL":
        vector = round_tangent(reader, axis)
    elif kind == "AXIS":
        vector = along_axis(reader, metal_tree.axis_vector(axis))
    else:
        vector = tangent_of_map(reader, node.uv_map) if node.uv_map or reader.uv_map else None
    return vector and _in_frame(reader, vector)


def _fabric(reader, node, groups, share):
    """Through some of its yarns, as a number or a texture says, light passes: of two cloths, of which one lets
    all of it through, as much of either."""
    math, alpha = reader.program.math, _socket_number(reader, node, groups, "Alpha", 1.0)
    through = _clamp(reader, _socket_number(reader, node, groups, fabric.TRANSLUCENCY, 0.0)
                     if fabric.socket_rules(node) else node.transmission)
    alpha = _clamp(reader, alpha)
    parts = [(through, 1.0)] if is_known(through) else [(0.0, math("SUBTRACT", 1.0, through)), (1.0, through)]
    fed = cloth.of(reader, node, groups)
    normal = _normal(reader, node, groups)
    fed |= {"normal": normal} if normal else {}
    for transmit, part in parts:
        made = cloth.made(reader, node, groups, transmit, fed)
        _add(reader, {"closure": "FABRIC", **made}, math("MULTIPLY", math("MULTIPLY", share, alpha), part))
    covered = math("MULTIPLY", alpha, made["coverage"][0]) if node.open_gaps else alpha
    _add(reader, {"closure": "TRANSPARENT"}, math("MULTIPLY", share, math("SUBTRACT", 1.0, covered)))


def _socket_number(reader, node, groups, name, missing):
    """Of nodes of older files, what they were as."""
    return number_of(reader, node.inputs[name], groups) if name in node.inputs else missing


_MATT = {"fresnel": "NONE", "horizon": "chiang" if versions.BUMPS_FADE else "estevez"}


def _lambert_closure(color):
    return _metal_closure(_MATT, f0=_BLACK, kd=color)


def _lambert(reader, color, share, normal):
    if normal and not reader.dumps:  # a dump knows metals and cloth
        _add(reader, {"closure": "DIFFUSE", "model": "LAMBERT", "color": color, "roughness": [0.0]}, share, normal)
    else:
        _add(reader, _lambert_closure(color), share, normal)


def _diffuse(reader, node, groups, share):
    color, normal = color_of(reader, node.inputs["Color"], groups), _normal(reader, node, groups)
    _matt(reader, color, number_of(reader, node.inputs["Roughness"], groups), share, normal)


def _subsurface(reader, node, groups, share):
    """Without a radius Cycles has a Diffuse BSDF too."""
    if _spreads(node, "Scale", "Radius"):
        reader.warn(f"'{node.name}': light below the surface is not supported; shaded as a Diffuse BSDF of its colour")
    _lambert(reader, color_of(reader, node.inputs["Color"], groups), share, _normal(reader, node, groups))


def _spreads(node, *names):
    """Do sockets say how far light goes below the surface?"""
    for name in names:
        socket = node.inputs.get(name)
        if socket and not socket.is_linked and not any(tree.color_in(socket)):
            return False
    return True


def _matt(reader, color, roughness, share, normal):
    if is_known(roughness) and roughness <= 0:
        _lambert(reader, color, share, normal)
        return
    model = "EON" if versions.ENERGY_OREN_NAYAR else "OREN_NAYAR"
    _add(reader, {"closure": "DIFFUSE", "model": model, "color": color, "roughness": [roughness]},
         share, normal)


def _glossy(reader, node, groups, share):
    color, alpha = color_of(reader, node.inputs["Color"], groups), _alpha_of(reader, node, groups)
    normal, distribution = _normal(reader, node, groups), node.distribution
    if distribution not in _LOBES:
        reader.warn(f"'{node.name}': {distribution.lower()} is not supported; shaded as GGX")
        distribution = "GGX"
    alphas, groove = _stretched(reader, node, groups, alpha)
    if distribution == "BECKMANN" and alphas[0] != alphas[1] and not versions.JOINT_SHADOWING:
        reader.warn(f"'{node.name}': Cycles of this version shades a stretched Beckmann a few percent brighter")
    seen = None
    if _is_bright(reader, color):
        share, own = _times(reader, color, share), _WHITE
    else:
        own = color
    if distribution == "MULTI_GGX" and not _is_smooth(alpha):
        lobe = _Lobe(reader, alpha, normal)
        kept = lobe.kept(color)
        share = _times(reader, kept, share)
        seen = (_times(reader, own, lobe.one) if versions.JOINT_SHADOWING else
                tuple(reader.program.math("DIVIDE", part, by) for part, by in zip(own, kept)))
    _add(reader, _metal_closure({"fresnel": "NONE", **_LOBES[distribution], **_apart(distribution)}, f0=own,
                                alpha=alphas, groove=groove), share, normal, seen)


def _apart(distribution):
    """How Cycles' lobe is shadowed, where one bounce is all."""
    return {"apart": True} if not versions.JOINT_SHADOWING and distribution in ("GGX", "BECKMANN") else {}


def _metallic(reader, node, groups, share):
    """The Metallic BSDF of 4.3 on: colours head-on and at 82 degrees, or a conductor's."""
    inputs, math = node.inputs, reader.program.math
    alpha, normal = _alpha_of(reader, node, groups), _normal(reader, node, groups)
    alphas, groove = _drawn_out(reader, node, groups, alpha, "Anisotropy", "Rotation")
    if node.fresnel_type == "F82":
        base = color_of(reader, inputs["Base Color"], groups)
        edge = tuple(_clamp(reader, part) for part in color_of(reader, inputs["Edge Tint"], groups))
        settings, parts, head_on = {"fresnel": "F82"}, {"f0": base, "f82": edge}, base
        lost = tuple(math("MULTIPLY", math("MULTIPLY_ADD", part, 1 - _SCHLICK_82, _SCHLICK_82),
                          math("SUBTRACT", 1.0, by)) for part, by in zip(base, edge))
    else:
        eta, k = (tuple(math("MAXIMUM", part, 0.0) for part in color_of(reader, inputs[name], groups))
                  for name in ("IOR", "Extinction"))
        settings, parts = {"fresnel": "CONDUCTOR"}, {"f0": _WHITE, "eta": eta, "k": k}
        head_on = tuple(_conductor(reader, n, x, 1.0) for n, x in zip(eta, k))
        lost = tuple(math("SUBTRACT", math("MULTIPLY_ADD", part, 1 - _SCHLICK_82, _SCHLICK_82),
                          _conductor(reader, n, x, 1 / 7)) for part, n, x in zip(head_on, eta, k))
    film = _film(reader, node, groups)
    if film:
        film |= ({"film_eta": parts["eta"], "film_k": parts["k"]} if "k" in parts else
                 _tinted(reader, base, edge))
        settings, parts = {"fresnel": "NONE"}, {"f0": _WHITE}
    lobe = _Lobe(reader, alpha, normal)
    if node.distribution == "MULTI_GGX" and not _is_smooth(alpha):
        # the mean over the directions of Schlick's and of the dip at 82 degrees
        means = tuple(math("MULTIPLY_ADD", less, -_DIP, _mean(reader, part)) for part, less in zip(head_on, lost))
        share = _times(reader, lobe.kept(means), share)
    made = _metal_closure({**_LOBES[node.distribution], **settings}, alpha=alphas, groove=groove, **parts)
    _add(reader, made | film, share, normal, tuple(map(lobe.albedo, head_on)))


def _film(reader, node, groups):
    """What a METAL or GLASS says of a thin film on it, or nothing."""
    socket = node.inputs.get("Thin Film Thickness")
    thickness = number_of(reader, socket, groups) if socket else 0.0
    if is_known(thickness) and thickness <= 0:
        return {}
    return {"film_thickness": [thickness], "film_ior": [number_of(reader, node.inputs["Thin Film IOR"], groups)]}


def _tinted(reader, base, edge):
    """What a METAL says of a metal of this colour and tint below a film."""
    eta, k = _index_of(reader, base, edge)
    return {"film_eta": eta, "film_k": k, "film_tint": edge}


def _index_of(reader, base, edge):
    """A metal's index and extinction that reflect this colour head-on; how much the first is, that at 82 degrees
    says [Gulbrandsen2014], as in Cycles. edge: its tint there."""
    math, etas, ks = reader.program.math, [], []
    for part, tint in zip(base, edge):
        part = math("CLAMP", part, 0.0, 0.99)
        tint = math("MULTIPLY", tint, math("MULTIPLY_ADD", part, 1 - _SCHLICK_82, _SCHLICK_82))
        root = math("SQRT", part)
        least = math("DIVIDE", math("SUBTRACT", 1.0, part), math("ADD", 1.0, part))
        most = math("DIVIDE", math("ADD", 1.0, root), math("SUBTRACT", 1.0, root))
        eta = math("MIX", most, least, tint)
        above, below = math("ADD", eta, 1.0), math("SUBTRACT", eta, 1.0)
        square = math("SUBTRACT", math("MULTIPLY", part, math("MULTIPLY", above, above)), math("MULTIPLY", below, below))
        etas.append(eta)
        ks.append(math("SQRT", math("MAXIMUM", math("DIVIDE", square, math("SUBTRACT", 1.0, part)), 0.0)))
    return tuple(etas), tuple(ks)


def _mean(reader, head_on):
    """Schlick's mean over the directions."""
    return reader.program.math("MULTIPLY_ADD", head_on, 20 / 21, 1 / 21)


_SCHLICK_82 = (6 / 7) ** 5  # at a cosine of 1/7; what is missing there of the mean of x (1 - x)^6, scaled to 1
_DIP = 7 * (7 / 6) ** 6 / 126


def _conductor(reader, n, k, cosine):
    """Reflectance of even light, not polarised, where the index is large against 1: within a hundredth."""
    math = reader.program.math
    square = math("ADD", math("MULTIPLY", n, n), math("MULTIPLY", k, k))
    middle, parts = math("MULTIPLY", n, 2.0 * cosine), []
    for low, high in ((square, cosine * cosine), (math("MULTIPLY", square, cosine * cosine), 1.0)):
        whole = math("ADD", low, high)
        parts.append(math("DIVIDE", math("SUBTRACT", whole, middle), math("ADD", whole, middle)))
    return math("MULTIPLY", 0.5, math("ADD", *parts))


def _drawn_out(reader, node, groups, alpha, name, rotation):
    """alpha / a and alpha a, a^2 = 1 - 0.9 anisotropic; where the tangent is turned to, or None."""
    math, amount = reader.program.math, _clamp(reader, number_of(reader, node.inputs[name], groups))
    if is_known(amount) and amount == 0:
        return (alpha, alpha), None
    a = math("SQRT", math("SUBTRACT", 1.0, math("MULTIPLY", amount, 0.9)))
    return (math("MINIMUM", math("DIVIDE", alpha, a), 1.0), math("MULTIPLY", alpha, a)), _groove(reader, node, rotation, groups)


def _stretched(reader, node, groups, alpha):
    """Alphas along the tangent and across it, and where it is turned to, or None."""
    alphas = _pulled(reader, node, groups, alpha)
    return alphas, None if alphas[0] is alphas[1] else _groove(reader, node, "Rotation", groups)


def _pulled(reader, node, groups, alpha):
    """Alphas along the tangent and across it, of the Glossy BSDF: alpha / (1 + a) and alpha (1 + a) below 0,
    alpha (1 - a) and alpha / (1 - a) above."""
    math, socket = reader.program.math, node.inputs.get("Anisotropy")
    a = number_of(reader, socket, groups) if socket else 0.0
    if is_known(a) and a == 0:
        return alpha, alpha
    a = math("CLAMP", a, -0.99, 0.99)
    size = math("SUBTRACT", 1.0, math("ABSOLUTE", a))
    small, large = math("MULTIPLY", alpha, size), math("MINIMUM", math("DIVIDE", alpha, size), 1.0)
    along = math("GREATER_THAN", a, 0.0) if not is_known(a) else float(a > 0)
    return math("MIX", large, small, along), math("MIX", small, large, along)


def _tangent(reader, node, groups):
    """x and y of a node's Tangent in the shading frame, or None: the UV map's own. Where nothing feeds
    it, it goes round the object's z axis."""
    found = tree.trace(node.inputs["Tangent"], groups)
    if found.node is None:
        vector = round_tangent(reader, "Z")
    elif found.node.type == "TANGENT":
        vector = tangent_of(reader, found.node)
    else:
        vector = color_of(reader, node.inputs["Tangent"], groups)
    return vector and _in_frame(reader, vector)


def _in_frame(reader, vector):
    return reader.program.emit("FRAME", vector=tuple(vector), to="SHADING")[:2]


def _groove(reader, node, rotation, groups):
    """Where the tangent points once it is turned, as x and y, or None: the UV map's own."""
    return _rotated(reader, _tangent(reader, node, groups), node.inputs[rotation], groups)


def _rotated(reader, own, rotation, groups):
    """The same of a tangent, None for the UV map's own, and a socket of turns."""
    turns = number_of(reader, rotation, groups)
    if is_known(turns) and turns % 1 == 0:
        return own
    math = reader.program.math
    angle = math("MULTIPLY", turns, 6.283185307179586)
    c, s = math("COSINE", angle), math("SINE", angle)
    if not own:
        return [c, s]
    x, y = own
    return [math("SUBTRACT", math("MULTIPLY", x, c), math("MULTIPLY", y, s)),
            math("MULTIPLY_ADD", x, s, math("MULTIPLY", y, c))]


def _glass_closure(reader, node, groups, **given):
    ior = number_of(reader, node.inputs["IOR"], groups)
    return {"closure": "GLASS", "ior": [ior], "tint": _WHITE, "reflects": True, "refracts": True,
            "joint": versions.JOINT_SHADOWING, "flat": not versions.JOINT_SHADOWING and node.distribution != "MULTI_GGX",
            "beckmann": node.distribution == "BECKMANN", **given}


def _glass(reader, node, groups, share, reflects=True):
    color = color_of(reader, node.inputs["Color"], groups)
    alpha = _alpha_of(reader, node, groups)
    _add_glass(reader, node, groups, alpha, share, _normal(reader, node, groups), color,
               reflects=reflects)


def _add_glass(reader, node, groups, alpha, share, normal, color=_WHITE, **given):
    """Where the node says so, light that met the facets several times leaves as the rest does, each
    time in this colour."""
    seen = None
    if node.distribution == "MULTI_GGX" and not _is_smooth(alpha):
        about = {"normal": normal} if normal else {}
        ior = number_of(reader, node.inputs["IOR"], groups)
        one, mean = reader.program.emit("GLASS_ALBEDO", 2, ior=[ior], alpha=[alpha], joint=versions.JOINT_SHADOWING,
                                        **about)
        kept = _kept(reader, given.get("tint", color), one, mean)
        share = _times(reader, kept, share)
        seen = tuple(reader.program.math("DIVIDE", 1.0, part) for part in kept)
    _add(reader, _glass_closure(reader, node, groups, alpha=[alpha], **given, **_film(reader, node, groups)),
         _times(reader, color, share), normal, seen)


def _refraction(reader, node, groups, share):
    _glass(reader, node, groups, share, reflects=False)


def _velvet(reader, node, groups, share):
    _add_velvet(reader, node, groups, share, number_of(reader, node.inputs["Sigma"], groups))


def _add_velvet(reader, node, groups, share, sigma):
    color, normal = color_of(reader, node.inputs["Color"], groups), _normal(reader, node, groups)
    _add(reader, {"closure": "SHEEN", "model": "VELVET", "sigma": [sigma]},
         _times(reader, color, share), normal, color)


def _sheen(reader, node, groups, share):
    roughness = _clamp(reader, number_of(reader, node.inputs["Roughness"], groups))
    if node.distribution == "ASHIKHMIN":
        _add_velvet(reader, node, groups, share, roughness)
        return
    color = color_of(reader, node.inputs["Color"], groups)
    _fibres(reader, color, roughness, share, _normal(reader, node, groups))


def _fibres(reader, color, roughness, share, normal):
    """What they reflect of even light, by colour."""
    about = {"normal": normal} if normal else {}
    a, b, one = reader.program.emit("FIBRES", roughness=[roughness], **about)
    seen = _times(reader, color, one)
    _add(reader, {"closure": "SHEEN", "model": "FIBRES", "a": [a], "b": [b]},
         _times(reader, seen, share), normal)
    return seen


def _toon(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    size, smooth = (number_of(reader, node.inputs[name], groups) for name in ("Size", "Smooth"))
    mirrors = node.component == "GLOSSY"
    _add(reader, {"closure": "TOON", "mirrors": mirrors, "overcounts": mirrors and versions.TOON_OVERCOUNTS,
                  "size": [size], "smooth": [smooth]},
         _times(reader, color, share), _normal(reader, node, groups), color)


def _translucent(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    _add(reader, {"closure": "TRANSLUCENT"}, _times(reader, color, share),
         _normal(reader, node, groups))


def _transparent(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    _add(reader, {"closure": "TRANSPARENT"}, _times(reader, color, share))


def _holdout(reader, _node, _groups, share):
    _add(reader, {"closure": "EMISSION", "holds": True}, share)


def _emission(reader, node, groups, share):
    color = color_of(reader, node.inputs["Color"], groups)
    strength = number_of(reader, node.inputs["Strength"], groups)
    _shine(reader, color, reader.program.math("MULTIPLY", strength, share))


def _shine(reader, color, strength):
    _add(reader, {"closure": "EMISSION"}, _times(reader, color, strength))


# ---- Principled BSDF


def _principled(reader, node, groups, share):
    inputs, math = node.inputs, reader.program.math
    alpha = _clamp(reader, number_of(reader, inputs["Alpha"], groups))
    _add(reader, {"closure": "TRANSPARENT"}, math("MULTIPLY", share, math("SUBTRACT", 1.0, alpha)))
    share = math("MULTIPLY", share, alpha)
    _name_left_out(reader, node)
    layers = _Principled(reader, node, groups)
    (layers.until_3_6 if "Specular" in inputs else layers.from_4_0)(share)


# Sockets without a closure yet, in one version or another, and what they are where they say nothing.
_LEFT_OUT = {"Transmission Roughness": 0}
# What goes below the surface, in 3.4 and from 4.0 on, is matt.
_BELOW = ("Subsurface", "Subsurface Weight")


def _name_left_out(reader, node):
    """A warning for each of these sockets that says something."""
    for name, plain in _LEFT_OUT.items():
        socket = node.inputs.get(name)
        if not socket:
            continue
        if socket.is_linked or socket.default_value != plain:
            reader.warn(f"'{node.name}': {name} is not supported; left out")
    for name in _BELOW:
        socket = node.inputs.get(name)
        if (socket and (socket.is_linked or socket.default_value > 0) and
                _spreads(node, "Subsurface Radius", "Subsurface Scale")):
            reader.warn(f"'{node.name}': {name} is not supported; shaded as matt")


def _largest(reader, color):
    math = reader.program.math
    return math("MAXIMUM", math("MAXIMUM", color[0], color[1]), color[2])


class _Principled:
    """Its layers, from the top: each takes its part of the share, the rest goes to those below."""

    def __init__(self, reader, node, groups):
        self.reader, self.node, self.groups, self.math = reader, node, groups, reader.program.math
        self.base = color_of(reader, node.inputs["Base Color"], groups)
        self.metallic = _clamp(reader, self._number("Metallic"))
        self.alpha, self.normal = _alpha_of(reader, node, groups), _normal(reader, node, groups)
        self.alphas, self.groove = _drawn_out(reader, node, groups, self.alpha, "Anisotropic",
                                              "Anisotropic Rotation")
        self.several = getattr(node, "distribution", "GGX") == "MULTI_GGX" and not _is_smooth(
            self.alpha)

    def _number(self, *names):
        name = next(name for name in names if name in self.node.inputs)
        return number_of(self.reader, self.node.inputs[name], self.groups)

    def _rest(self, share, part):
        return self._part(share, self.math("SUBTRACT", 1.0, part))

    def _part(self, share, part):
        """share: one for all, or three parts."""
        if isinstance(share, tuple):
            return _times(self.reader, share, part)
        return self.math("MULTIPLY", share, part)

    def _lobe(self, share, settings, head_on, film=None, **parts):
        lobe = _Lobe(self.reader, self.alpha, self.normal)
        kept = lobe.kept(tuple(_mean(self.reader, part) for part in head_on)) if self.several else _WHITE
        share = _times(self.reader, kept, share)
        # from 4.0 on Cycles' colour is the albedo, before it is 1 for all lobes
        seen = (tuple(map(lobe.albedo, head_on)) if versions.JOINT_SHADOWING else
                tuple(self.math("DIVIDE", 1.0, part) for part in kept))
        shadow = {} if self.several else _apart("GGX")
        made = _metal_closure({**_GGX, **shadow, **settings}, alpha=self.alphas, groove=self.groove, **parts)
        _add(self.reader, made | (film or {}), share, self.normal, seen)

    def _clear(self, share, head_on, thin=0.0):
        """thin: 1 where light is faster inside than outside."""
        eta = self._eta(head_on)
        if not (is_known(thin) and thin == 0):
            eta = self.math("MIX", eta, self.math("DIVIDE", 1.0, eta), thin)
        self._lobe(share, {"fresnel": "CONDUCTOR", "k": _BLACK}, (head_on,) * 3, f0=_WHITE,
                   eta=(eta,) * 3)

    def _head_on(self, eta):
        root = self.math("DIVIDE", self.math("SUBTRACT", eta, 1.0), self.math("ADD", eta, 1.0))
        return self.math("MULTIPLY", root, root)

    def _eta(self, head_on):
        """The index whose reflectance this is, at most of .99."""
        root = self.math("SQRT", self.math("CLAMP", head_on, 0.0, 0.99))
        return self.math("DIVIDE", self.math("ADD", 1.0, root), self.math("SUBTRACT", 1.0, root))

    def _coat(self, share, weight, alpha, eta, normal, color):
        _add(self.reader, _metal_closure({**_GGX, "fresnel": "CONDUCTOR", "k": _BLACK}, f0=_WHITE,
                                         eta=(eta,) * 3, alpha=alpha),
             self._part(share, weight), normal, (color,) * 3)

    def _emission(self, share, least=None):
        """least: of its strength."""
        inputs, strength = self.node.inputs, self._number("Emission Strength")
        strength = strength if least is None else self.math("MAXIMUM", strength, least)
        color = color_of(self.reader, inputs.get("Emission Color") or inputs["Emission"],
                         self.groups)
        _shine(self.reader, color, self._part(share, strength))

    def _hue(self, name, bright):
        """White, or as far as this socket says the base colour as bright as white."""
        amount = self._number(name)
        if is_known(amount) and amount == 0:
            return _WHITE
        math, sum_ = self.math, 0.0
        for part, by in zip(self.base, bright):
            sum_ = math("ADD", sum_, math("MULTIPLY", part, by))
        there = float(sum_ > 0) if is_known(sum_) else math("GREATER_THAN", sum_, 0.0)
        least = math("MAXIMUM", sum_, 1e-6)
        return tuple(math("MIX", 1.0, math("DIVIDE", part, least), math("MULTIPLY", amount, there))
                     for part in self.base)

    def _below(self):
        """The base colour, or as far as light goes below the surface its own."""
        part = _clamp(self.reader, self._number("Subsurface"))
        if is_known(part) and part == 0:
            return self.base
        other = color_of(self.reader, self.node.inputs["Subsurface Color"], self.groups)
        return tuple(self.math("MIX", one, two, part) for one, two in zip(self.base, other))

    def until_3_6(self, share):
        math = self.math
        through = _clamp(self.reader, self._number("Transmission"))
        ior = self._number("IOR")
        if is_known(ior) and ior <= 0 and not (is_known(through) and through == 0):
            self.reader.warn(f"'{self.node.name}': an IOR of {ior:g} has no meaning: as Cycles of 3.4 does not show it "
                             "(black), it is shaded as 1")
        self._emission(share)
        coat = _clamp(self.reader, self._number("Clearcoat"))
        alpha = _alpha_of(self.reader, self.node, self.groups, "Clearcoat Roughness")
        _add(self.reader, {"closure": "COAT", "alpha": [alpha]},
             self._part(share, math("MULTIPLY", coat, 0.25)),
             _normal(self.reader, self.node, self.groups, "Clearcoat Normal"), (4.0,) * 3)
        matt = self._rest(share, self.metallic)
        glass = self._part(matt, through)
        if not (is_known(glass) and glass == 0):
            _add_glass(self.reader, self.node, self.groups, self.alpha, glass, self.normal,
                       tint=self.base)
        _add(self.reader, {"closure": "DIFFUSE", "model": "BURLEY", "color": self._below(),
                           "roughness": [_clamp(self.reader, self._number("Roughness"))]},
             self._rest(matt, through), self.normal)
        sheen = self._number("Sheen")
        _add(self.reader, {"closure": "SHEEN", "model": "SCHLICK"},
             _times(self.reader, self._hue("Sheen Tint", _LUMINANCE),
                    self._part(self._rest(matt, through), sheen)), self.normal, _WHITE)
        surface = math("SUBTRACT", share, glass)
        head_on = math("CLAMP", math("MULTIPLY", self._number("Specular"), 0.08), 0.0, 1.0)
        hue = self._hue("Specular Tint", (0.3, 0.6, 0.1))
        if is_known(self.metallic) and self.metallic == 0 and hue == _WHITE:
            self._clear(surface, head_on)
            return
        f0 = tuple(math("MIX", math("MULTIPLY", head_on, tint), part, self.metallic)
                   for part, tint in zip(self.base, hue))
        self._lobe(surface, {"fresnel": "SCHLICK"}, f0, f0=f0)

    def from_4_0(self, share):
        math, reader = self.math, self.reader
        sheen = math("MAXIMUM", self._number("Sheen Weight"), 0.0)
        if not (is_known(sheen) and sheen == 0):
            share = self._under_sheen(share, sheen)
        coat = _clamp(reader, self._number("Coat Weight"))
        if not (is_known(coat) and coat == 0):
            share = self._coated(share, coat)
        self._emission(share, 0.0)
        tint = color_of(reader, self.node.inputs["Specular Tint"], self.groups)
        white = is_known(*tint) and all(part >= 1 for part in tint)
        metal = {"fresnel": "SCHLICK"} if white else {"fresnel": "F82"}
        edge, film = tuple(_clamp(reader, part) for part in tint), _film(reader, self.node, self.groups)
        base = self.base
        if _is_bright(reader, base):  # Cycles clamps it but for what is matt
            base = tuple(math("MINIMUM", part, 1.0) for part in base)
        if film and versions.FILM_ON_METAL:
            self._lobe(self._part(share, self.metallic), {"fresnel": "NONE"}, base,
                       film | _tinted(reader, base, edge), f0=_WHITE)
        else:
            self._lobe(self._part(share, self.metallic), metal, base, f0=base,
                       **({} if white else {"f82": edge}))
        share = self._rest(share, self.metallic)
        through = _clamp(reader, self._number("Transmission Weight"))
        glass = self._part(share, through)
        if not (is_known(glass) and glass == 0):
            beyond = tuple(math("SQRT", _clamp(reader, part)) for part in self.base)
            _add_glass(reader, self.node, self.groups, self.alpha, glass, self.normal, tint=beyond,
                       **({} if white else {"mirror_tint": edge}))
        share = self._rest(share, through)
        if is_known(share) and share == 0:
            return
        ior = math("MAXIMUM", self._number("IOR"), 1e-5)
        if is_known(ior) and ior < 0.1 and not (is_known(through) and through == 0):
            reader.warn(f"'{self.node.name}': an IOR of {ior:.2g} has no meaning; what is transmitted is off from Cycles'")
        head_on = self._head_on(ior)
        level = self._number("Specular IOR Level")
        if not (is_known(level) and level == 0.5):
            head_on = math("MULTIPLY", head_on, math("MULTIPLY", level, 2.0))
        lobe = _Lobe(reader, self.alpha, self.normal)
        if film:
            hidden = self._filmed(share, film, head_on, tint)
        elif is_known(*tint) and tuple(tint) == _WHITE:
            self._clear(share, head_on, math("LESS_THAN", ior, 1.0))
        else:
            f0 = tuple(_clamp(reader, math("MULTIPLY", head_on, part)) for part in tint)
            self._lobe(share, {"fresnel": "SCHLICK"}, f0, f0=f0)
            head_on = _largest(reader, f0)
        if not film:
            hidden = lobe.albedo(head_on)
        elif self.several:  # of a film it is that of a mirror
            hidden = math("MULTIPLY", hidden, lobe.one)
        if self.several:
            hidden = math("MULTIPLY", hidden, lobe.kept((_mean(reader, head_on),))[0])
        roughness = self._number("Diffuse Roughness") if "Diffuse Roughness" in self.node.inputs else 0.0
        _matt(reader, self.base, roughness, self._rest(share, _clamp(reader, hidden)), self.normal)

    def _filmed(self, share, film, head_on, tint):
        """A clear body under a thin film; what that hides of what is below, by its largest colour at the eye's
        angle."""
        film |= {"film_eta": (self._eta(head_on),) * 3, "film_k": _BLACK}
        share = share if is_known(*tint) and tuple(tint) == _WHITE else _times(self.reader, tint, share)
        self._lobe(share, {"fresnel": "NONE"}, (head_on,) * 3, film, f0=_WHITE)
        seen = self.reader.program.emit("THIN_FILM", cosine=[self._seen(self.normal)], **film)
        return _largest(self.reader, _times(self.reader, seen, tint))

    def _coated(self, share, weight):
        reader = self.reader
        alpha = _alpha_of(reader, self.node, self.groups, "Coat Roughness")
        eta = self.math("MAXIMUM", self._number("Coat IOR"), 1.0)
        normal = _normal(reader, self.node, self.groups, "Coat Normal")
        hidden = _Lobe(reader, alpha, normal).albedo(self._head_on(eta))
        self._coat(share, weight, alpha, eta, normal, hidden)
        share = self._rest(share, self._part(weight, hidden))
        tint = color_of(reader, self.node.inputs["Coat Tint"], self.groups)
        if is_known(*tint) and tuple(tint) == _WHITE:
            return share
        # as long a way as the eye's ray has in it, in units of the shortest
        math = self.math
        cosine = self._seen(normal)
        sine = math("DIVIDE", math("SUBTRACT", 1.0, math("MULTIPLY", cosine, cosine)),
                    math("MULTIPLY", eta, eta))
        way = math("DIVIDE", 1.0, math("SQRT", math("SUBTRACT", 1.0, sine)))
        return _times(self.reader, tuple(math("MIX", 1.0, math(
            "POWER", math("MAXIMUM", part, 0.0), way), weight) for part in tint), share)

    def _seen(self, normal):
        """Cosine of the eye and a normal in the shading frame."""
        program = self.reader.program
        eye = program.emit("FRAME", vector=program.emit("GEOMETRY", what="INCOMING"), to="SHADING")
        if not normal:
            return eye[2]
        sum_ = 0.0
        for a, b in zip(eye, normal):
            sum_ = self.math("ADD", sum_, self.math("MULTIPLY", a, b))
        return _clamp(self.reader, sum_)

    def _under_sheen(self, share, weight):
        reader = self.reader
        tint = color_of(reader, self.node.inputs["Sheen Tint"], self.groups)
        color = tuple(self.math("MULTIPLY", weight, part) for part in tint)
        seen = _fibres(reader, color, _clamp(reader, self._number("Sheen Roughness")), share,
                       self.normal)
        return self._rest(share, _clamp(reader, _largest(reader, seen)))


# By the node's bl_idname.
CLOSURES = {
    nodes.METAL: _metal,
    fabric.FABRIC: _fabric,
    "ShaderNodeBsdfPrincipled": _principled,
    "ShaderNodeBsdfDiffuse": _diffuse,
    "ShaderNodeBsdfGlossy": _glossy,
    "ShaderNodeBsdfAnisotropic": _glossy,
    "ShaderNodeBsdfMetallic": _metallic,
    "ShaderNodeBsdfGlass": _glass,
    "ShaderNodeBsdfRefraction": _refraction,
    "ShaderNodeBsdfSheen": _sheen,
    "ShaderNodeBsdfVelvet": _velvet,
    "ShaderNodeBsdfToon": _toon,
    "ShaderNodeBsdfTranslucent": _translucent,
    "ShaderNodeSubsurfaceScattering": _subsurface,
    "ShaderNodeBsdfTransparent": _transparent,
    "ShaderNodeEmission": _emission,
    "ShaderNodeBackground": _emission,
    "ShaderNodeHoldout": _holdout,
}


def shading(reader, way, seen):
    """What is transparent is so for rays that are of this way (a word of the native node PATH), or for all others."""
    math = reader.program.math
    for number, closure in enumerate(reader.closures):
        if closure["closure"] == "TRANSPARENT":
            share = reader.program.emit("PATH", 1, what=way)[0]
            share = share if seen else math("SUBTRACT", 1.0, share)
            reader.closures[number] = {**closure, "weight": _times(reader, tuple(closure.get("weight", _WHITE)), share)}


def held_out(reader):
    """The camera sees a hole in the place of all but what is transparent; nothing else does."""
    math = reader.program.math
    camera = reader.program.emit("PATH", 1, what="FILM")[0]
    held, kept, others = (camera,) * 3, [], math("SUBTRACT", 1.0, camera)
    for closure in reader.closures:
        weight = tuple(closure.get("weight", _WHITE))
        if closure["closure"] == "TRANSPARENT":
            held = tuple(_clamp(reader, math("SUBTRACT", part, math("MULTIPLY", camera, by)))
                         for part, by in zip(held, weight))
            kept.append(closure)
        elif not closure.get("holds"):
            kept.append({**closure, "weight": _times(reader, weight, others)})
    reader.closures = [{"closure": "EMISSION", "holds": True, "weight": held}, *kept]


def plain(color):
    """The closure of a Diffuse BSDF of one colour, without a reader."""
    return _lambert_closure(color)


_PRINCIPLED = {"Base Color": (0.8, 0.8, 0.8, 1.0), "Metallic": 0.0, "Roughness": 0.5, "IOR": 1.5, "Alpha": 1.0,
               "Diffuse Roughness": 0.0, "Specular IOR Level": 0.5, "Specular Tint": (1.0,) * 4, "Anisotropic": 0.0,
               "Transmission Weight": 0.0, "Coat Weight": 0.0, "Sheen Weight": 0.0, "Emission Strength": 0.0,
               "Emission Color": (1.0,) * 4}


def principled(reader):
    """The closures of a new Principled BSDF of 5.0, without a node."""
    sockets = {name: SimpleNamespace(links=(), is_linked=False, default_value=value)
               for name, value in _PRINCIPLED.items()}
    _principled(reader, SimpleNamespace(name="", inputs=sockets, distribution="MULTI_GGX"), (), 1.0)
