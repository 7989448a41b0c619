# SPDX-License-Identifier: GPL-3.0-or-later
"""What a point of a cloth sends on, by plain nodes: a group that all cloth nodes of a file share. libshade's near model
with what Cycles has: a lobe of Ashikhmin and Shirley for warp and weft, fibres as two matt sides, a nap that does not know
where light comes from. How far it is off is in docs/results/blender.md."""

import math

from ..builder import shared
from ..groove import either
from .place import Formulas, add_sockets

NAME = "Libshade Cloth"
_MARK = "libshade_cloth"
YARNS = ("Warp", "Weft")
# Constants of a yarn, vectors: exponents along and across and the fibres' angle; reflectance that goes with the dye, and
# that does not; its mean; amplitudes per yarn of brightness and tilt, 1 / length of noise; the same along it.
OF_YARN = (("Exponents", "Vector"), ("Dyed Shine", "Vector"), ("Plain Shine", "Vector"), ("Shine", "Float"),
           ("Vary", "Vector"), ("Along", "Vector"))
OF_CLOTH = (("Lit", "Float"), ("Dyed Backing", "Vector"), ("Fuzz in Gaps", "Float"), ("Open", "Float"), ("Nap Color", "Vector"))
NUMBERS = ("Gloss", "Fuzz", "Translucency", "Alpha")  # sockets of the cloth node
_MOST_TILT = 0.98
# Two matt sides at this slope to a round yarn's sides, and what each reflects: a fan of fibres reflects 1/pi of the
# light that comes along the horizon, and 2/pi of what comes from above. Between these two sides reflect less: .768 of even
# light where a fan does .818. Half of that is given back.
_SIDES, _SIDE = 1.0, 1.03 * math.sqrt(2) / math.pi
_FROM_BELOW = 20 / 21  # of light from all sides, what Schlick's share at its angle leaves of a matt surface
_TO_LIGHT = 1 / 0.65  # how long a nap is along the light's way, about


class _Shader(Formulas):
    def bsdf(self, kind, color, normal, **inputs):
        return self.new(f"Bsdf{kind}", Color=color, Normal=normal, **inputs).outputs[0]

    def add(self, *shaders):
        shaders = list(shaders)
        while len(shaders) > 1:
            node = self.new("AddShader")
            for socket, shader in zip(node.inputs, shaders[:2]):
                self.feed(socket, shader)
            shaders[:2] = [node.outputs[0]]
        return shaders[0]

    def white(self, normal):
        """Schlick's white share towards the eye."""
        cosine = self.vector("DOT_PRODUCT", normal, self.eye)
        facing = self.math("SUBTRACT", 1.0, cosine)
        facing.node.use_clamp = True
        return self.math("POWER", facing, 5.0)


def _frames(build, normal, surface, tangent):
    """(x, y) of weft and of warp: as dP/du and dP/dv of the surface whose normal it is."""
    side = build.vector("CROSS_PRODUCT", surface, tangent)
    x = build.vector("NORMALIZE", build.vector("CROSS_PRODUCT", side, normal))
    y = build.vector("NORMALIZE", build.vector("CROSS_PRODUCT", normal, tangent))
    return (x, build.vector("CROSS_PRODUCT", normal, x)), (build.vector("CROSS_PRODUCT", y, normal), y)


def _noise(build, given, is_warp, yarn):
    """(brightness, tilt along and across) of the yarn that is seen."""
    u, v, _ = build.parts(given["Crossing"])
    number = build.lerp(build.floor(v), build.floor(u), is_warp)
    vary = build.lerp_vector(given["Weft Vary"], given["Warp Vary"], is_warp)
    along = build.lerp_vector(given["Weft Along"], given["Warp Along"], is_warp)
    per_length = build.parts(vary)[2]
    place = build.math("MULTIPLY", build.lerp(u, v, is_warp), per_length)
    channel = build.math("ADD", is_warp, 3.0)
    of_yarn = build.random(number, 0.0, channel, "Color")
    on_it = build.along(number, place, build.math("ADD", is_warp, 5.0), "Color")
    found = []
    for one, by in ((of_yarn, vary), (on_it, along)):
        bright, tilt, _ = build.parts(by)
        even = build.vector("SUBTRACT", build.vector("SCALE", one, 2.0), (1.0, 1.0, 1.0))
        found.append(build.vector("MULTIPLY", even, build.together(bright, tilt, tilt)))
    return build.parts(build.vector("SCALE", build.vector("ADD", *found), yarn))


def _tilt(build, given, is_warp, yarn):
    """(dx, dy, z, occlusion, brightness)."""
    seen = build.vector("SUBTRACT", build.vector("SCALE", given["Tilt"], 2.0), (1.0, 1.0, 0.0))
    dx, dy, twice = build.parts(seen)
    bright, along, across = _noise(build, given, is_warp, yarn)
    more_x, more_y = build.lerp(along, across, is_warp), build.lerp(across, along, is_warp)
    own = build.together(dx, dy)
    whole = build.together(build.math("ADD", dx, more_x), build.math("ADD", dy, more_y))
    length = build.vector("LENGTH", whole)
    scale = build.math("MINIMUM", 1.0, build.math("DIVIDE", _MOST_TILT, build.math("MAXIMUM", length, 1e-6)))
    length = build.math("MINIMUM", length, _MOST_TILT)
    less = build.math("SUBTRACT", build.vector("LENGTH", own), length)
    occlusion = build.math("MULTIPLY_ADD", twice, 0.5, less)
    occlusion.node.use_clamp = True
    z = build.math("SQRT", build.math("MULTIPLY_ADD", build.math("MULTIPLY", length, length), -1.0, 1.0))
    x, y, _ = build.parts(build.vector("SCALE", whole, scale))
    return x, y, z, occlusion, build.math("MAXIMUM", build.math("ADD", bright, 1.0), 0.0)


def _white(build, squares, normal, fibre):
    """Schlick's white share of a lobe of such alphas, squared. Cycles has it by the angle of the eye to the normal; light
    from all sides meets wide lobes at smaller ones: quadrature gives 1/(1 + 5.9 a^1.7) of it, within .09 for exponents of
    3 to 525 and cosines down to .05, where a is the alpha in the eye's plane."""
    cosine = build.vector("DOT_PRODUCT", normal, build.eye)
    along = build.vector("DOT_PRODUCT", fibre, build.eye)
    flat = build.math("MAXIMUM", build.math("MULTIPLY_ADD", build.math("MULTIPLY", cosine, cosine), -1.0, 1.0), 1e-4)
    turn = build.math("DIVIDE", build.math("MULTIPLY", along, along), flat)
    turn.node.use_clamp = True
    wide = build.math("POWER", build.lerp(squares[1], squares[0], turn), 0.85)
    return build.math("DIVIDE", build.white(normal), build.math("MULTIPLY_ADD", wide, 5.9, 1.0))


def _shape(build, squares):
    """Cycles' roughness and anisotropy of alphas along and across, squared; as metal_tree.shape_of."""
    roughness = build.math("POWER", build.math("MULTIPLY", *squares), 1 / 8)
    ratio = build.math("POWER", build.math("DIVIDE", *squares), 1 / 4)
    wide = build.math("MINIMUM", build.math("DIVIDE", 1.0, ratio), 1.0)
    return roughness, build.math("SUBTRACT", wide, build.math("MINIMUM", ratio, 1.0))


def _shine(build, given, yarn):
    """Reflectance head-on of a yarn in its dye, as bright as in its own."""
    dyed = build.vector("ADD", build.vector("MULTIPLY", given[f"{yarn} Color"], given[f"{yarn} Dyed Shine"]),
                        given[f"{yarn} Plain Shine"])
    dyed = build.vector("ADD", dyed, (1e-7,) * 3)
    mean = build.vector("DOT_PRODUCT", dyed, (1 / 3,) * 3)
    scaled = build.vector("SCALE", dyed, build.math("DIVIDE", given[f"{yarn} Shine"], mean))
    return build.vector("MINIMUM", scaled, (1.0,) * 3)


def _fill(tree):
    add_sockets(tree, [("Crossing", "Vector"), ("Tangent", "Vector"), ("Normal", "Vector"), ("Tilt", "Color"),
                       ("Yarns", "Color"), ("Tint", "Color", (1.0,) * 4)]
                + [(f"{yarn} Color", "Color") for yarn in YARNS] + [(name, "Float") for name in NUMBERS]
                + [(f"{yarn} {name}", kind) for yarn in YARNS for name, kind in OF_YARN] + list(OF_CLOTH),
                [("BSDF", "Shader")])
    given, answer = tree.nodes.new("NodeGroupInput").outputs, tree.nodes.new("NodeGroupOutput").inputs
    build = _Shader(tree)
    surface = build.new("NewGeometry").outputs
    build.eye = surface["Incoming"]
    normal = build.vector("NORMALIZE", either(tree, given["Normal"], surface["Normal"]))
    frames = dict(zip(("Weft", "Warp"), _frames(build, normal, surface["Normal"], given["Tangent"])))
    warp, weft, _ = build.parts(given["Yarns"])
    share = {"Warp": warp, "Weft": weft}
    yarn = build.math("ADD", warp, weft)
    gap = build.math("SUBTRACT", 1.0, yarn)
    gap.node.use_clamp = True
    is_warp = build.math("GREATER_THAN", warp, weft)
    dx, dy, dz, occlusion, bright = _tilt(build, given, is_warp, yarn)

    # a nap: what it takes of the light on its way in and out, and sends back
    out = build.math("MAXIMUM", build.vector("DOT_PRODUCT", normal, build.eye), 0.02)
    way = build.math("ADD", build.math("DIVIDE", 1.0, out), _TO_LIGHT)
    left = build.math("EXPONENT", build.math("MULTIPLY", build.math("MULTIPLY", way, given["Fuzz"]), -0.5))
    sent = build.math("DIVIDE", build.math("MULTIPLY_ADD", build.math("MULTIPLY", left, left), -1.0, 1.0),
                      build.math("MULTIPLY_ADD", out, 4.0, 4 / _TO_LIGHT))
    nap = build.bsdf("Diffuse", build.vector("SCALE", given["Nap Color"], sent), normal)
    light = build.math("MULTIPLY", build.math("MULTIPLY", occlusion, left), given["Lit"])

    gloss = build.math("MAXIMUM", given["Gloss"], 1e-6)
    leaning, fibres, shine, lobes = {}, {}, {}, []
    for word in YARNS:
        x, y = frames[word]
        leaning[word] = build.sum((x, dx), (y, dy), (normal, dz))
        along, across, angle = build.parts(given[f"{word} Exponents"])
        cosine, sine = build.math("COSINE", angle), build.math("SINE", angle)
        fibres[word] = build.sum((x, cosine), (y, sine)) if word == "Weft" else \
            build.sum((y, cosine), (x, build.math("MULTIPLY", sine, -1.0)))
        side = build.vector("CROSS_PRODUCT", normal, fibres[word])
        carried = build.vector("NORMALIZE", build.vector("CROSS_PRODUCT", side, leaning[word]))
        shine[word] = _shine(build, given, word)
        squares = [build.math("DIVIDE", 2.0, build.math("MULTIPLY_ADD", e, gloss, 2.0)) for e in (along, across)]
        color = build.lerp_vector(shine[word], (1.0,) * 3, _white(build, squares, leaning[word], carried))
        color = build.vector("SCALE", color, build.math("MULTIPLY", light, share[word]))
        roughness, anisotropy = _shape(build, squares)
        lobes.append(build.bsdf("Anisotropic", color, leaning[word], Roughness=roughness, Anisotropy=anisotropy,
                                Tangent=carried))
        lobes[-1].node.distribution = "ASHIKHMIN_SHIRLEY"

    # what is matt: of the yarn that is seen, and of what shows through gaps
    lean = build.lerp_vector(leaning["Weft"], leaning["Warp"], is_warp)
    fibre = build.lerp_vector(fibres["Weft"], fibres["Warp"], is_warp)
    tinted = {word: build.vector("MULTIPLY", given[f"{word} Color"], given["Tint"]) for word in YARNS}
    dye = build.vector("SCALE", build.sum(*((tinted[word], share[word]) for word in YARNS)), bright)
    dye = build.vector("MINIMUM", dye, (1.0,) * 3)
    inside = build.vector("SUBTRACT", (1.0,) * 3, build.sum(*((shine[word], share[word]) for word in YARNS)))
    dye = build.vector("MULTIPLY", build.vector("MULTIPLY", dye, inside), inside)
    enters = build.math("MULTIPLY_ADD", build.white(lean), -_FROM_BELOW, _FROM_BELOW)
    dye = build.vector("SCALE", dye, build.math("MULTIPLY", enters, light))
    both = build.vector("ADD", given["Warp Color"], given["Weft Color"])
    backing = build.lerp_vector(build.vector("MULTIPLY", both, given["Dyed Backing"]),
                                build.vector("SCALE", both, 0.5), given["Fuzz in Gaps"])
    behind = build.vector("SCALE", build.vector("SCALE", backing, gap), light)
    back = build.math("SUBTRACT", 1.0, given["Translucency"])
    matt = build.sum((dye, build.math("MULTIPLY", back, _SIDE)), (behind, 0.5))
    across = build.vector("SCALE", build.vector("NORMALIZE", build.vector("CROSS_PRODUCT", lean, fibre)),
                          build.math("MULTIPLY", yarn, _SIDES))
    sides = [build.bsdf("Diffuse", matt, build.vector("NORMALIZE", build.vector(what, lean, across)))
             for what in ("ADD", "SUBTRACT")]
    through = build.bsdf("Translucent", build.vector("SCALE", dye, given["Translucency"]), lean)

    # nothing behind the gaps, where they are open
    open_ = build.math("MULTIPLY", build.math("MULTIPLY", given["Open"], gap),
                       build.math("SUBTRACT", 1.0, given["Fuzz in Gaps"]))
    seen = build.new("BsdfTransparent", Color=build.vector("SCALE", (1.0,) * 3, open_)).outputs[0]
    whole, clear = build.new("MixShader"), build.new("BsdfTransparent")
    build.feed(whole.inputs[0], given["Alpha"])
    build.feed(whole.inputs[1], clear.outputs[0])
    build.feed(whole.inputs[2], build.add(*lobes, *sides, through, nap, seen))
    tree.links.new(whole.outputs[0], answer["BSDF"])


def cloth_tree():
    return shared(NAME, _MARK, _fill)
