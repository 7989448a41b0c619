# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns made of numbers: noise, cells, waves, bricks and the like."""

from math import ceil, pi
from struct import pack, unpack

from .. import versions
from .graph import is_known
from .node_place import layer
from .value import Value, clamped, dot, each, number_in, three, value_of, vector_in


def _place(reader, found):
    """Where a texture is looked up: what is linked, else generated coordinates. From Blender 5.0 on a
    node of one dimension does not show the socket."""
    if "Vector" not in found.node.inputs:
        return (0.0,) * 3
    value = value_of(reader, found.node.inputs["Vector"], found.groups, own=Value("VECTOR", None))
    return three(reader, value) if value.parts is not None else tuple(layer(reader, "GENERATED")[:3])


def _lattice_place(reader, found, vector, scale=1.0):
    """(dimensions, four parts): the vector's and W, by the node's Scale."""
    node = found.node
    dimensions = int(next(getattr(node, name) for name in ("noise_dimensions", "musgrave_dimensions",
                                                           "voronoi_dimensions") if hasattr(node, name))[0])
    w = number_in(reader, found, "W") if dimensions in (1, 4) else 0.0
    at = {1: (w,), 4: (*vector, w)}.get(dimensions, tuple(vector[:dimensions]))
    scaled = [reader.program.math("MULTIPLY", part, scale) for part in at]
    return dimensions, (*scaled, *(0.0,) * (4 - dimensions))


def _input(reader, found, name, otherwise=0.0):
    """A number that not every version asks for."""
    return number_in(reader, found, name) if found.node.inputs.get(name) else otherwise


def _outputs(found, part):
    return (part,) * 3 if found.output.name == "Color" else (part,)


# ---- noise


def _chance(*floats):
    """[0, 1] of one or two floats, as native/node/hash.h has it."""
    words = unpack(f"<{len(floats)}I", pack(f"<{len(floats)}f", *floats))
    seed = 0xDEADBEEF + (len(words) << 2) + 13
    state = [(seed + word) & 0xFFFFFFFF for word in (*words, 0, 0)[:3]]
    for by, one, other in ((14, 2, 1), (11, 0, 2), (25, 1, 0), (16, 2, 1), (4, 0, 2), (14, 1, 0), (24, 2, 1)):
        x = state[other]
        state[one] = ((state[one] ^ x) - (x << by | x >> (32 - by))) & 0xFFFFFFFF
    return state[2] / 0xFFFFFFFF


def _elsewhere(reader, at, seed, dimensions):
    """A place where noise has nothing to do with that here."""
    def random(k):
        return 100.0 + 100.0 * (_chance(seed) if dimensions == 1 else _chance(seed, float(k)))
    return tuple(reader.program.math("ADD", part, random(k)) if k < dimensions else part
                 for k, part in enumerate(at))


def _noise(reader, dimensions, at, what="FBM", even=False, first=False, detail=0.0, roughness=0.5,
           lacunarity=2.0, offset=0.0, gain=1.0):
    return reader.program.emit("NOISE", 1, dimensions=dimensions, what=what, even=even, first=first,
                               at=list(at), detail=[detail], roughness=[roughness],
                               lacunarity=[lacunarity], offset=[offset], gain=[gain])[0]


def _tex_noise(reader, found):
    node, program = found.node, reader.program
    dimensions, at = _lattice_place(reader, found, _place(reader, found), number_in(reader, found, "Scale"))
    distortion = number_in(reader, found, "Distortion")
    if not (is_known(distortion) and distortion == 0):
        moved = [program.math("MULTIPLY_ADD", _noise(reader, dimensions, _elsewhere(reader, at, float(k), dimensions)),
                              distortion, at[k]) for k in range(dimensions)]
        at = (*moved, *at[dimensions:])
    roughness = program.math("MAXIMUM", number_in(reader, found, "Roughness"), 0.0)
    if versions.NOISE_CLAMPED:
        roughness = program.math("MINIMUM", roughness, 1.0)
    choices = {"what": getattr(node, "noise_type", "FBM"), "even": getattr(node, "normalize", True),
               "detail": number_in(reader, found, "Detail"), "roughness": roughness,
               "lacunarity": _input(reader, found, "Lacunarity", 2.0),
               "offset": _input(reader, found, "Offset"), "gain": _input(reader, found, "Gain", 1.0)}
    color = found.output.name == "Color"
    places = [at, *(_elsewhere(reader, at, float(dimensions + k), dimensions) for k in (0, 1) if color)]
    return tuple(_noise(reader, dimensions, place, **choices) for place in places)


def _tex_musgrave(reader, found):
    """To Blender 4.0, then part of noise."""
    math = reader.program.math
    dimensions, at = _lattice_place(reader, found, _place(reader, found), number_in(reader, found, "Scale"))
    lacunarity = math("MAXIMUM", number_in(reader, found, "Lacunarity"), 1e-5)
    slope = math("MULTIPLY", math("MAXIMUM", number_in(reader, found, "Dimension"), 1e-5), -1.0)
    return (_noise(reader, dimensions, at, found.node.musgrave_type, first=True,
                   detail=number_in(reader, found, "Detail"), roughness=math("POWER", lacunarity, slope),
                   lacunarity=lacunarity, offset=_input(reader, found, "Offset"),
                   gain=_input(reader, found, "Gain", 1.0)),)


def _tex_white_noise(reader, found):
    vector = vector_in(reader, found, "Vector") if "Vector" in found.node.inputs else (0.0,) * 3
    dimensions, at = _lattice_place(reader, found, vector)
    key = ("white noise", found.node, found.groups, reader.shift)
    if key not in reader.known:
        reader.known[key] = reader.program.emit("WHITE_NOISE", 4, dimensions=dimensions, at=list(at))
    *color, number = reader.known[key]
    return tuple(color) if found.output.name == "Color" else (number,)


# ---- cells


def _tex_voronoi(reader, found):
    node, math = found.node, reader.program.math
    scale = number_in(reader, found, "Scale")
    dimensions, at = _lattice_place(reader, found, _place(reader, found), scale)
    key = ("voronoi", node, found.groups, reader.shift)
    if key not in reader.known:
        reader.known[key] = _cells(reader, found, dimensions, at)
    distance, *where = reader.known[key][:5]
    name = found.output.name
    if name == "Color":
        return tuple(reader.known[key][5:])
    if name in ("Position", "W"):
        place = [math("DIVIDE", part, scale) for part in where]
        if dimensions == 1:
            return (place[0],) if name == "W" else (0.0,) * 3
        return (place[3],) if name == "W" else tuple(place[:3])
    return (distance,)


def _cells(reader, found, dimensions, at):
    """Distance, four of a place, three of a colour."""
    node, math = found.node, reader.program.math
    feature = node.feature
    smoothness = _input(reader, found, "Smoothness")
    if feature == "SMOOTH_F1":
        smoothness = math("CLAMP", math("MULTIPLY", smoothness, 0.5), 0.0, 0.5)
        if is_known(smoothness) and smoothness == 0:
            feature = "F1"
    randomness = math("CLAMP", number_in(reader, found, "Randomness"), 0.0, 1.0)
    exponent = _input(reader, found, "Exponent", 1.0)

    def look(at):
        return reader.program.emit("VORONOI", 8, dimensions=dimensions, at=list(at), feature=feature,
                                   metric=node.distance, exponent=[exponent], smoothness=[smoothness],
                                   randomness=[randomness], whole=versions.VORONOI_BY_WHOLE)

    if feature == "N_SPHERE_RADIUS":
        return look(at)
    far = _farthest(reader, node, dimensions, exponent, randomness)
    add = _nearest_edge if feature == "DISTANCE_TO_EDGE" else _added_cells
    made, most = look(at), far if add is _nearest_edge else 1.0
    for scale, part, amplitude in _octaves(reader, found):
        made, most = add(reader, made, most, look([math("MULTIPLY", x, scale) for x in at]), scale,
                         math("MULTIPLY", amplitude, part), far)
    if getattr(node, "normalize", False):
        if add is _added_cells:
            made = (made[0], *made[1:5], *(math("DIVIDE", part, most) for part in made[5:]))
            most = math("MULTIPLY", most, far)
        made = (math("DIVIDE", made[0], most), *made[1:])
    return made


def _octaves(reader, found):
    """After the first: (scale, which part of it counts, amplitude)."""
    math = reader.program.math
    detail = math("CLAMP", _input(reader, found, "Detail"), 0.0, 15.0)
    roughness = math("CLAMP", _input(reader, found, "Roughness", 0.5), 0.0, 1.0)
    lacunarity, scale, amplitude = _input(reader, found, "Lacunarity", 2.0), 1.0, 1.0
    for k in range(1, (ceil(detail) if is_known(detail) else 15) + 1):
        scale, amplitude = math("MULTIPLY", scale, lacunarity), math("MULTIPLY", amplitude, roughness)
        yield scale, math("CLAMP", math("SUBTRACT", detail, k - 1.0), 0.0, 1.0), amplitude


def _added_cells(reader, made, most, octave, scale, amplitude, _far):
    math = reader.program.math
    distance, *color = (math("MULTIPLY_ADD", more, amplitude, part)
                        for part, more in zip((made[0], *made[5:]), (octave[0], *octave[5:])))
    place = [math("MIX", part, math("DIVIDE", more, scale), amplitude)
             for part, more in zip(made[1:5], octave[1:5])]
    return (distance, *place, *color), math("ADD", most, amplitude)


def _nearest_edge(reader, made, most, octave, scale, amplitude, far):
    math = reader.program.math
    nearer = math("MINIMUM", made[0], math("DIVIDE", octave[0], scale))
    return ((math("MIX", made[0], nearer, amplitude), *made[1:]),
            math("MIX", most, math("DIVIDE", far, scale), amplitude))


def _farthest(reader, node, dimensions, exponent, randomness):
    """What distances are divided by when they are normalized."""
    math = reader.program.math
    half = math("MULTIPLY_ADD", randomness, 0.5, 0.5)
    if node.feature == "DISTANCE_TO_EDGE":
        return half
    if node.distance == "MANHATTAN":
        far = math("MULTIPLY", half, float(dimensions))
    elif node.distance == "MINKOWSKI":
        far = math("MULTIPLY", half, math("POWER", float(dimensions), math("DIVIDE", 1.0, exponent)))
    else:
        far = math("MULTIPLY", half, dimensions ** (0.5 if node.distance == "EUCLIDEAN" else 0.0))
    return math("MULTIPLY", far, 2.0) if node.feature == "F2" else far


# ---- patterns


def _not_on_the_border(reader, vector):
    """A little beside whole numbers, where rounding would decide."""
    return each(reader, "MULTIPLY_ADD", vector, (0.999999,) * 3, (0.999999e-6,) * 3)


def _tex_checker(reader, found):
    math = reader.program.math
    scaled = each(reader, "MULTIPLY", _place(reader, found), (number_in(reader, found, "Scale"),) * 3)
    whole = each(reader, "FLOOR", _not_on_the_border(reader, scaled))
    first = math("MODULO", math("ABSOLUTE", dot(reader, whole, (1.0,) * 3)), 2.0)
    if found.output.name != "Color":
        return (first,)
    one, other = (vector_in(reader, found, name) for name in ("Color1", "Color2"))
    return each(reader, "MIX", other, one, (first,) * 3)


def _tex_gradient(reader, found):
    math, kind = reader.program.math, found.node.gradient_type
    vector = _place(reader, found)
    x, y, _ = vector
    if kind == "QUADRATIC":
        r = math("MAXIMUM", x, 0.0)
        part = math("MULTIPLY", r, r)
    elif kind == "EASING":
        r = clamped(reader, x)
        part = math("MULTIPLY", math("MULTIPLY", r, r), math("MULTIPLY_ADD", r, -2.0, 3.0))
    elif kind == "DIAGONAL":
        part = math("MULTIPLY", math("ADD", x, y), 0.5)
    elif kind == "RADIAL":
        part = math("MULTIPLY_ADD", math("ARCTAN2", y, x), 0.5 / pi, 0.5)
    elif kind in ("SPHERICAL", "QUADRATIC_SPHERE"):
        r = math("MAXIMUM", math("SUBTRACT", 0.999999, math("SQRT", dot(reader, vector, vector))), 0.0)
        part = math("MULTIPLY", r, r) if kind == "QUADRATIC_SPHERE" else r
    else:
        part = x
    return _outputs(found, clamped(reader, part))


# of the Magic texture, depth by depth: the part, the function, and the signs of x, y and z in it
_MAGIC = (("y", "COSINE", -1, (1, -1, 1)), ("x", "COSINE", 1, (1, -1, -1)), ("z", "SINE", 1, (-1, -1, -1)),
          ("x", "COSINE", -1, (-1, 1, -1)), ("y", "SINE", -1, (-1, 1, 1)), ("y", "COSINE", -1, (-1, 1, 1)),
          ("x", "COSINE", 1, (1, 1, 1)), ("z", "SINE", 1, (1, 1, -1)), ("x", "COSINE", -1, (-1, -1, 1)),
          ("y", "SINE", -1, (1, -1, 1)))


def _tex_magic(reader, found):
    math, depth = reader.program.math, found.node.turbulence_depth
    by = math("MULTIPLY", number_in(reader, found, "Scale"), 5.0)
    distortion = number_in(reader, found, "Distortion")
    vector = each(reader, "MODULO", _place(reader, found), (2 * pi,) * 3)

    def wave(function, sign, signs, of, factor):
        return math("MULTIPLY", math(function, math("MULTIPLY", dot(reader, of, signs), factor)), sign)
    part = {"x": wave("SINE", 1.0, (1, 1, 1), vector, by), "y": wave("COSINE", 1.0, (-1, 1, -1), vector, by),
            "z": wave("COSINE", -1.0, (-1, -1, 1), vector, by)}
    if depth > 0:
        part = {name: math("MULTIPLY", value, distortion) for name, value in part.items()}
    for name, function, sign, signs in _MAGIC[:depth]:
        made = wave(function, float(sign), signs, tuple(part.values()), 1.0)
        part[name] = math("MULTIPLY", made, distortion)
    twice = math("MULTIPLY", distortion, 2.0)
    none = math("COMPARE", distortion, 0.0, 0.0)
    share = math("DIVIDE", 1.0, math("ADD", twice, none))
    color = each(reader, "SUBTRACT", (0.5,) * 3, each(reader, "MULTIPLY", tuple(part.values()), (share,) * 3))
    return color if found.output.name == "Color" else (dot(reader, color, (1 / 3,) * 3),)


_BANDS = {"X": (20.0, 0.0, 0.0), "Y": (0.0, 20.0, 0.0), "Z": (0.0, 0.0, 20.0), "DIAGONAL": (10.0,) * 3}
_RINGS = {"X": (0.0, 1.0, 1.0), "Y": (1.0, 0.0, 1.0), "Z": (1.0, 1.0, 0.0), "SPHERICAL": (1.0,) * 3}


def _tex_wave(reader, found):
    node, math = found.node, reader.program.math
    at = each(reader, "MULTIPLY", _place(reader, found), (number_in(reader, found, "Scale"),) * 3)
    at = _not_on_the_border(reader, at)
    if node.wave_type == "BANDS":
        angle = dot(reader, at, _BANDS[node.bands_direction])
    else:
        flat = each(reader, "MULTIPLY", at, _RINGS[node.rings_direction])
        angle = math("MULTIPLY", math("SQRT", dot(reader, flat, flat)), 20.0)
    angle = math("ADD", angle, number_in(reader, found, "Phase Offset"))
    distortion = number_in(reader, found, "Distortion")
    if not (is_known(distortion) and distortion == 0):
        fine = each(reader, "MULTIPLY", at, (number_in(reader, found, "Detail Scale"),) * 3)
        noise = _noise(reader, 3, (*fine, 0.0), even=True, detail=number_in(reader, found, "Detail"),
                       roughness=number_in(reader, found, "Detail Roughness"))
        angle = math("MULTIPLY_ADD", distortion, math("MULTIPLY_ADD", noise, 2.0, -1.0), angle)
    if node.wave_profile == "SIN":
        part = math("MULTIPLY_ADD", math("COSINE", angle), -0.5, 0.5)
    else:
        turns = math("MULTIPLY", angle, 0.5 / pi)
        if node.wave_profile == "SAW":
            part = math("FRACT", turns)
        else:
            nearest = math("FLOOR", math("ADD", turns, 0.5))
            part = math("MULTIPLY", math("ABSOLUTE", math("SUBTRACT", turns, nearest)), 2.0)
    return _outputs(found, part)


def _tex_brick(reader, found):
    node = found.node
    key = ("brick", node, found.groups, reader.shift)
    if key not in reader.known:
        x, y, _ = each(reader, "MULTIPLY", _place(reader, found), (number_in(reader, found, "Scale"),) * 3)
        width, height, mortar, smooth, bias = (
            [number_in(reader, found, name)]
            for name in ("Brick Width", "Row Height", "Mortar Size", "Mortar Smooth", "Bias"))
        reader.known[key] = reader.program.emit(
            "BRICK", 2, at=[x, y], width=width, height=height, mortar=mortar, smooth=smooth, bias=bias,
            shift=node.offset, shift_each=node.offset_frequency, squash=node.squash,
            squash_each=node.squash_frequency)
    tint, mortar = reader.known[key]
    if found.output.name != "Color":
        return (mortar,)
    one, other, between = (vector_in(reader, found, name) for name in ("Color1", "Color2", "Mortar"))
    return each(reader, "MIX", each(reader, "MIX", one, other, (tint,) * 3), between, (mortar,) * 3)


NODES = {
    "TEX_NOISE": _tex_noise, "TEX_MUSGRAVE": _tex_musgrave, "TEX_WHITE_NOISE": _tex_white_noise,
    "TEX_VORONOI": _tex_voronoi, "TEX_CHECKER": _tex_checker, "TEX_GRADIENT": _tex_gradient,
    "TEX_MAGIC": _tex_magic, "TEX_WAVE": _tex_wave, "TEX_BRICK": _tex_brick,
}
