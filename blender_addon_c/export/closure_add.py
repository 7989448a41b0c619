# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures as the native module reads them, added to a material's reader with their weight and their normal."""

from .. import versions
from .graph import is_known
from .value import each, normal_of

WHITE, BLACK = (1.0,) * 3, (0.0,) * 3
_DRAWN = {"IMAGE", "NORMAL_MAP", "SCRATCHES"}  # bumps that may leave most of a surface flat, and are soon looked at


def is_zero(part):
    """Everywhere?"""
    return is_known(part) and part == 0


def is_white(color):
    return is_known(*color) and tuple(color) == WHITE


def times(reader, color, factor):
    """factor: one for all, or three parts."""
    return each(reader, "MULTIPLY", color, factor if isinstance(factor, tuple) else (factor,) * 3)


def normal_in(reader, node, groups, name="Normal"):
    socket = node.inputs.get(name)
    return normal_of(reader, socket, groups) if socket else reader.bumped


def add(reader, closure, weight, normal=None, color=None):
    """weight: three parts, or one for all. What weighs nothing is left out. A `stock` metal is one of
    Cycles' own shaders; of one with `shape` slopes of long waves are the object's own. color: in passes of colour, where
    it is not what the closure says, by its weight."""
    stock, shape = closure.pop("stock", False), closure.pop("shape", False)
    if stock:
        closure |= {} if reader.transport and _is_drawn_out(closure) else {"detail": "gram_schmidt"}
        if reader.mutual and closure["f0"] != BLACK:
            closure["horizon"], shape = "mutual", reader.shape
        elif reader.bumped and reader.dumps:
            closure["horizon"] = "hard" if closure["f0"] == BLACK else "valid_reflection"
    if normal and normal[0] in reader.coarse:
        _warn_of_steps(reader, closure, *reader.coarse[normal[0]])
    if normal and normal[0] in reader.filtered and _is_even(closure):
        normal, closure["spread_from"] = reader.filtered[normal[0]]
    if normal and not reader.dumps:
        normal = _valid(reader, closure, normal, stock)
    weight = tuple(weight) if isinstance(weight, (tuple, list)) else (weight,) * 3
    if closure["closure"] == "DIFFUSE" or (stock and closure["fresnel"] == "NONE" and closure["f0"] == BLACK):
        weight = _colored(reader, closure, weight)
    shines = closure["closure"] == "EMISSION"  # below 0, too, as in Cycles
    if is_known(*weight) and not any(part > 0 or (shines and part < 0) for part in weight):
        return
    if not is_white(weight):
        closure = {**closure, "weight": weight}
    if reader.colors and color:
        closure = {**closure, "pass_color": tuple(color)}
    if normal and _is_mutual(closure) and reader.program.reads(normal, _DRAWN):
        moment = reader.program.emit("RELIEF", 5, shape=True) if shape else reader.program.emit("RELIEF")
        closure = {**closure, "moment_from": tuple(moment[:3]), **({"mean_from": tuple(moment[3:])} if shape else {})}
    reader.closures.append({**closure, "normal": normal} if normal else closure)


def _is_drawn_out(closure):
    return closure["ax"] != closure["ay"] or closure.get("ax_from") != closure.get("ay_from")


def _warn_of_steps(reader, closure, name, strength):
    """Of an 8-bit normal map: where a lobe is about as narrow as its steps."""
    if closure["closure"] == "METAL" and any(closure["f0"]):
        alphas = [closure[axis] for axis in ("ax", "ay") if f"{axis}_from" not in closure]
    else:
        alphas = closure.get("alpha", ())
    if any(is_known(alpha) and alpha < NARROW * strength for alpha in alphas):
        reader.warn(f"normal map '{name}' has 8 bits: its steps show in highlights as sharp as these; use 16 bits or float")


NARROW = 0.02  # alpha: 2.5 steps of 8 bits; the plate of docs/results is .03 off then, as it is not with 16 bits


def _is_even(closure):
    """A lobe that stays as it is where bumps finer than a sample widen it: about a Gaussian of slopes. GGX's tails
    would grow with it, to a half too much light beside highlights; where bumps shade each other a lobe of theirs would
    shade itself once more."""
    return (closure["closure"] == "METAL" and any(closure["f0"]) and not _is_mutual(closure) and
            closure["mdf"].lower() in ("ashikhmin_shirley", "beckmann", "ward", "ward_half"))


def _is_mutual(closure):
    return closure.get("horizon", "").lower() == "mutual"


def _colored(reader, closure, weight):
    """The weight of a matt closure, with its colour where that may be above 1, as in Cycles: closures clamp theirs,
    weights not."""
    metal = closure["closure"] == "METAL"
    color = closure.get("kd_from", closure["kd"]) if metal else closure["color"]
    if not is_bright(reader, color):
        return weight
    if closure.get("model") == "EON":  # of several bounces: what is above 1 alone
        more = tuple(reader.program.math("MAXIMUM", part, 1.0) for part in color)
        closure["color"] = tuple(reader.program.math("MINIMUM", part, 1.0) for part in color)
        return times(reader, more, weight)
    closure.pop("kd_from", None)
    closure["kd" if metal else "color"] = WHITE
    return times(reader, color, weight)


def is_bright(reader, color):
    """May it be above 1? A dump holds what a closure says."""
    return not reader.dumps and any(reader.most(part) > 1 for part in color)


def _valid(reader, closure, normal, stock):
    """The normal that Cycles' closure takes, here in place of a horizon of our own: so that the eye's mirror
    image is not below the surface, but from some version on not of what is matt. Libshade Metal keeps its own."""
    kind, below = closure["closure"], reader.below.get(normal[0], normal)
    if kind == "METAL":
        if not stock or _is_mutual(closure):
            return normal
        closure["horizon"] = "hard"
        return turned(reader, normal)
    if kind == "DIFFUSE":
        if normal is reader.bumped and versions.BUMPS_FADE:  # not by what its displacement turns it
            return reader.program.emit("BEND", normal=below)
        closure["bumps"] = "FADED" if versions.BUMPS_FADE else "SHADED"
        if reader.bumped:  # a Normal socket's bumps by what they turn that
            closure["own"] = reader.bumped
        if not versions.BUMPS_FADE:
            return below
    return reader.program.emit("BEND", normal=below)


def turned(reader, normal):
    """Of what shines."""
    if reader.dumps:
        return normal
    return reader.program.emit("BEND", normal=reader.below.get(normal[0], normal))
