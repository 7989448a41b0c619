# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF, as Blender has it to 3.6 and from 4.0 on: layers, from the top. Each takes its part of the share, the rest
goes to those below."""

from types import SimpleNamespace

from .. import versions, working_space
from .closure_add import BLACK, WHITE, add, is_bright, is_white, is_zero, normal_in, times
from .closure_film import film_of, tinted
from .closure_glass import add_glass
from .closure_groove import drawn_out
from .closure_light import shine
from .closure_lobe import GGX, Lobe, alpha_of, apart, eta_of, head_on_of, keeps_all, mean_of, metal_closure
from .closure_matt import fibres, matt, spreads
from .closure_thin import beyond, thin_glass
from .graph import is_known
from .value import clamped, color_of, dot, number_of


def principled(reader, node, groups, share):
    inputs, math = node.inputs, reader.program.math
    alpha = clamped(reader, number_of(reader, inputs["Alpha"], groups))
    add(reader, {"closure": "TRANSPARENT"}, math("MULTIPLY", share, math("SUBTRACT", 1.0, alpha)))
    share = math("MULTIPLY", share, alpha)
    _name_left_out(reader, node, groups)
    (_Until36 if "Specular" in inputs else _From40)(reader, node, groups).layers(share)


# Sockets without a closure yet, in one version or another, and what they are where they say nothing.
_LEFT_OUT = {"Transmission Roughness": 0}
# What goes below the surface, in 3.4 and from 4.0 on, is matt.
_BELOW = ("Subsurface", "Subsurface Weight")


def _name_left_out(reader, node, groups):
    """A warning for each of these sockets that says something."""
    for name, plain in _LEFT_OUT.items():
        socket = node.inputs.get(name)
        if not socket:
            continue
        if socket.is_linked or socket.default_value != plain:
            reader.warn(f"'{node.name}': {name} is not supported; left out")
    for name in () if _is_thin(reader, node, groups) else _BELOW:
        socket = node.inputs.get(name)
        if (socket and (socket.is_linked or socket.default_value > 0) and
                spreads(node, "Subsurface Radius", "Subsurface Scale")):
            reader.warn(f"'{node.name}': {name} is not supported; shaded as matt")


def _is_thin(reader, node, groups):
    """From 5.2 on: is it a sheet, not the surface of a body?"""
    socket = node.inputs.get("Thin Wall")
    part = number_of(reader, socket, groups) if socket else 0.0
    if not is_known(part):
        reader.warn(f"'{node.name}': a Thin Wall that differs from place to place is not supported; left out")
    return is_known(part) and part > 0


class _Principled:
    """What its layers share."""

    def __init__(self, reader, node, groups):
        self.reader, self.node, self.groups, self.math = reader, node, groups, reader.program.math
        self.base = self._color("Base Color")
        self.metallic = clamped(reader, self._number("Metallic"))
        self.alpha, self.normal = alpha_of(reader, node, groups), normal_in(reader, node, groups)
        self.alphas, self.groove = drawn_out(reader, node, groups, self.alpha, "Anisotropic",
                                             "Anisotropic Rotation")
        self.several = keeps_all(node, self.alpha)

    def _number(self, name):
        return number_of(self.reader, self.node.inputs[name], self.groups)

    def _share_of(self, name):
        return clamped(self.reader, self._number(name))

    def _color(self, name):
        return color_of(self.reader, self.node.inputs[name], self.groups)

    def _rest(self, share, part):
        return self._part(share, self.math("SUBTRACT", 1.0, part))

    def _part(self, share, part):
        """share: one for all, or three parts."""
        if isinstance(share, tuple):
            return times(self.reader, share, part)
        return self.math("MULTIPLY", share, part)

    def _lobe(self, share, settings, head_on, film=None, **parts):
        lobe = Lobe(self.reader, self.alphas, self.normal, self.groove)
        kept = lobe.kept(tuple(mean_of(self.reader, part) for part in head_on)) if self.several else WHITE
        share = times(self.reader, kept, share)
        # with joint shadowing Cycles' colour is the albedo, before that it is 1 for all lobes
        seen = (tuple(map(lobe.albedo, head_on)) if versions.JOINT_SHADOWING else
                tuple(self.math("DIVIDE", 1.0, part) for part in kept))
        shadow = {} if self.several else apart("GGX")
        made = metal_closure({**GGX, **shadow, **settings}, alpha=self.alphas, groove=self.groove, **parts)
        add(self.reader, made | (film or {}), share, self.normal, seen)

    def _clear(self, share, head_on, thin=0.0):
        """thin: 1 where light is faster inside than outside."""
        eta = eta_of(self.reader, head_on)
        if not is_zero(thin):
            eta = self.math("MIX", eta, self.math("DIVIDE", 1.0, eta), thin)
        self._lobe(share, {"fresnel": "CONDUCTOR", "k": BLACK}, (head_on,) * 3, f0=WHITE, eta=(eta,) * 3)

    def _emission(self, share, color, least=None):
        """least: of its strength."""
        strength, shade = self._number("Emission Strength"), self._color(color)
        strength = strength if least is None else self.math("MAXIMUM", strength, least)
        if versions.SHINES_BELOW_0 and is_known(strength) and strength < 0 and not is_known(*shade):
            shade = tuple(self.node.inputs[color].default_value)[:3]  # Cycles forgets the link
        shine(self.reader, shade, self._part(share, strength))

    def _glass(self, share, **tints):
        if not is_zero(share):
            add_glass(self.reader, self.node, self.groups, self.alpha, share, self.normal, **tints)


class _Until36(_Principled):
    def layers(self, share):
        through = self._share_of("Transmission")
        self._name_no_index(through)
        self._emission(share, "Emission")
        self._clearcoat(share)
        body = self._rest(share, self.metallic)
        glass = self._part(body, through)
        self._glass(glass, tint=self.base)
        add(self.reader, {"closure": "DIFFUSE", "model": "BURLEY", "color": self._below(),
                          "roughness": [self._share_of("Roughness")]},
            self._rest(body, through), self.normal)
        sheen = self._number("Sheen")
        add(self.reader, {"closure": "SHEEN", "model": "SCHLICK"},
            times(self.reader, self._hue("Sheen Tint", working_space.luminance()),
                  self._part(self._rest(body, through), sheen)), self.normal, WHITE)
        self._specular(self.math("SUBTRACT", share, glass))

    def _name_no_index(self, through):
        ior = self._number("IOR")
        if is_known(ior) and ior <= 0 and not is_zero(through):
            self.reader.warn(f"'{self.node.name}': an IOR of {ior:g} has no meaning: as Cycles of 3.4 does not show it "
                             "(black), it is shaded as 1")

    def _clearcoat(self, share):
        coat = self._share_of("Clearcoat")
        alpha = alpha_of(self.reader, self.node, self.groups, "Clearcoat Roughness")
        add(self.reader, {"closure": "COAT", "alpha": [alpha]}, self._part(share, self.math("MULTIPLY", coat, 0.25)),
            normal_in(self.reader, self.node, self.groups, "Clearcoat Normal"), (4.0,) * 3)

    def _specular(self, share):
        """Of metal and of what is clear at once, where some is metal or coloured."""
        math = self.math
        head_on = math("CLAMP", math("MULTIPLY", self._number("Specular"), 0.08), 0.0, 1.0)
        hue = self._hue("Specular Tint", (0.3, 0.6, 0.1))
        if is_zero(self.metallic) and hue == WHITE:
            self._clear(share, head_on)
            return
        f0 = tuple(math("MIX", math("MULTIPLY", head_on, tint), part, self.metallic)
                   for part, tint in zip(self.base, hue))
        self._lobe(share, {"fresnel": "SCHLICK"}, f0, f0=f0)

    def _hue(self, name, bright):
        """White, or as far as this socket says the base colour as bright as white."""
        amount = self._number(name)
        if is_zero(amount):
            return WHITE
        math, sum_ = self.math, dot(self.reader, self.base, bright)
        there = float(sum_ > 0) if is_known(sum_) else math("GREATER_THAN", sum_, 0.0)
        least = math("MAXIMUM", sum_, 1e-6)
        return tuple(math("MIX", 1.0, math("DIVIDE", part, least), math("MULTIPLY", amount, there))
                     for part in self.base)

    def _below(self):
        """The base colour, or as far as light goes below the surface its own."""
        part = self._share_of("Subsurface")
        if is_zero(part):
            return self.base
        return tuple(self.math("MIX", one, two, part) for one, two in zip(self.base, self._color("Subsurface Color")))


class _From40(_Principled):
    def layers(self, share):
        share = self._coated(self._under_sheen(share))
        self._emission(share, "Emission Color", None if versions.SHINES_BELOW_0 else 0.0)
        self.tint = self._color("Specular Tint")
        self.edge = tuple(clamped(self.reader, part) for part in self.tint)
        self.film, self.thin = film_of(self.reader, self.node, self.groups), _is_thin(self.reader, self.node, self.groups)
        self._metal(self._part(share, self.metallic))
        share = self._rest(share, self.metallic)
        through = self._share_of("Transmission Weight")
        self._transmission(self._part(share, through))
        share = self._rest(share, through)
        if is_zero(share):
            return
        hidden = self._specular(share, through)
        roughness = self._number("Diffuse Roughness") if "Diffuse Roughness" in self.node.inputs else 0.0
        share = self._rest(share, clamped(self.reader, hidden))
        through = beyond(self.reader, self.node, self.groups, roughness) if self.thin else 0.0
        matt(self.reader, self.base, roughness, self._rest(share, through), self.normal)
        if not is_zero(through):
            add(self.reader, {"closure": "TRANSLUCENT"}, times(self.reader, self.base, self._part(share, through)), self.normal)

    def _under_sheen(self, share):
        reader, weight = self.reader, self.math("MAXIMUM", self._number("Sheen Weight"), 0.0)
        if is_zero(weight):
            return share
        color = tuple(self.math("MULTIPLY", weight, part) for part in self._color("Sheen Tint"))
        seen = fibres(reader, color, self._share_of("Sheen Roughness"), share, self.normal)
        return self._rest(share, clamped(reader, _largest(reader, seen)))

    def _coated(self, share):
        weight = self._share_of("Coat Weight")
        if is_zero(weight):
            return share
        reader = self.reader
        alpha = alpha_of(reader, self.node, self.groups, "Coat Roughness")
        eta = self.math("MAXIMUM", self._number("Coat IOR"), 1.0)
        normal = normal_in(reader, self.node, self.groups, "Coat Normal")
        hidden = Lobe(reader, alpha, normal).albedo(head_on_of(reader, eta))
        add(reader, metal_closure({**GGX, "fresnel": "CONDUCTOR", "k": BLACK}, f0=WHITE, eta=(eta,) * 3, alpha=alpha),
            self._part(share, weight), normal, (hidden,) * 3)
        return self._below_coat(self._rest(share, self._part(weight, hidden)), weight, eta, normal)

    def _below_coat(self, share, weight, eta, normal):
        """What its tint leaves: on as long a way as the eye's ray has in it, in units of the shortest."""
        tint, math = self._color("Coat Tint"), self.math
        if is_white(tint):
            return share
        cosine = self._cosine(normal)
        sine = math("DIVIDE", math("SUBTRACT", 1.0, math("MULTIPLY", cosine, cosine)),
                    math("MULTIPLY", eta, eta))
        way = math("DIVIDE", 1.0, math("SQRT", math("SUBTRACT", 1.0, sine)))
        left = (math("POWER", math("MAXIMUM", part, 0.0), way) for part in tint)
        return times(self.reader, tuple(math("MIX", 1.0, part, weight) for part in left), share)

    def _has_edge(self):
        return not (is_known(*self.tint) and all(part >= 1 for part in self.tint))

    def _metal(self, share):
        base = self.base
        if is_bright(self.reader, base):  # Cycles clamps it but for what is matt
            base = tuple(self.math("MINIMUM", part, 1.0) for part in base)
        if self.film and versions.FILM_ON_METAL:
            self._lobe(share, {"fresnel": "NONE"}, base, self.film | tinted(self.reader, base, self.edge), f0=WHITE)
        elif self._has_edge():
            self._lobe(share, {"fresnel": "F82"}, base, f0=base, f82=self.edge)
        else:
            self._lobe(share, {"fresnel": "SCHLICK"}, base, f0=base)

    def _transmission(self, share):
        if self.thin:
            thin_glass(self.reader, self.node, self.groups, self.base, self.edge, share, self.normal)
        elif not is_zero(share):
            beyond = tuple(self.math("SQRT", clamped(self.reader, part)) for part in self.base)
            self._glass(share, tint=beyond, **({"mirror_tint": self.edge} if self._has_edge() else {}))

    def _specular(self, share, through):
        """What is clear; how much that hides of what is below."""
        math, reader = self.math, self.reader
        ior = math("MAXIMUM", self._number("IOR"), 1e-5)
        if is_known(ior) and ior < 0.1 and not is_zero(through):
            reader.warn(f"'{self.node.name}': an IOR of {ior:.2g} has no meaning; what is transmitted is off from Cycles'")
        head_on = head_on_of(reader, ior)
        level = self._number("Specular IOR Level")
        if not (is_known(level) and level == 0.5):
            head_on = math("MULTIPLY", head_on, math("MULTIPLY", level, 2.0))
        if is_zero(head_on) and not self.film:
            return 0.0
        lobe = Lobe(reader, self.alphas, self.normal, self.groove)
        if self.film:
            hidden = self._filmed(share, head_on)
            if self.several:  # of a film it is that of a mirror
                hidden = math("MULTIPLY", hidden, lobe.one)
        else:
            head_on = self._unfilmed(share, head_on, ior)
            hidden = lobe.albedo(head_on)
        if self.several:
            hidden = math("MULTIPLY", hidden, lobe.kept((mean_of(reader, head_on),))[0])
        return hidden

    def _unfilmed(self, share, head_on, ior):
        """The largest of what it reflects head-on."""
        if is_white(self.tint):
            self._clear(share, head_on, self.math("LESS_THAN", ior, 1.0))
            return head_on
        f0 = tuple(clamped(self.reader, self.math("MULTIPLY", head_on, part)) for part in self.tint)
        self._lobe(share, {"fresnel": "SCHLICK"}, f0, f0=f0)
        return _largest(self.reader, f0)

    def _filmed(self, share, head_on):
        """A clear body under a thin film; what that hides of what is below, by its largest colour at the eye's
        angle."""
        film = {**self.film, "film_eta": (eta_of(self.reader, head_on),) * 3, "film_k": BLACK}
        share = share if is_white(self.tint) else times(self.reader, self.tint, share)
        self._lobe(share, {"fresnel": "NONE"}, (head_on,) * 3, film, f0=WHITE)
        seen = self.reader.program.emit("THIN_FILM", cosine=[self._cosine(self.normal)], **film)
        return _largest(self.reader, times(self.reader, seen, self.tint))

    def _cosine(self, normal):
        """Of the eye and a normal in the shading frame."""
        program = self.reader.program
        eye = program.emit("FRAME", vector=program.emit("GEOMETRY", what="INCOMING"), to="SHADING")
        return clamped(self.reader, dot(self.reader, eye, normal)) if normal else eye[2]


def _largest(reader, color):
    math = reader.program.math
    return math("MAXIMUM", math("MAXIMUM", color[0], color[1]), color[2])


_PRINCIPLED = {"Base Color": (0.8, 0.8, 0.8, 1.0), "Metallic": 0.0, "Roughness": 0.5, "IOR": 1.5, "Alpha": 1.0,
               "Diffuse Roughness": 0.0, "Specular IOR Level": 0.5, "Specular Tint": (1.0,) * 4, "Anisotropic": 0.0,
               "Transmission Weight": 0.0, "Coat Weight": 0.0, "Sheen Weight": 0.0, "Emission Strength": 0.0,
               "Emission Color": (1.0,) * 4}


def of_no_material(reader):
    """The closures of a new Principled BSDF of 5.0, without a node."""
    sockets = {name: SimpleNamespace(links=(), is_linked=False, default_value=value)
               for name, value in _PRINCIPLED.items()}
    principled(reader, SimpleNamespace(name="", inputs=sockets, distribution="MULTI_GGX"), (), 1.0)
