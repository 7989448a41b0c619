# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes that Filter Normal Maps makes as wide as bumps finer than a sample. Those of Cycles' own shaders and of ours alike."""


def is_even(closure):
    """A lobe that stays as it is where it is widened: about a Gaussian of slopes. GGX's tails would
    grow with it, to a half too much light beside highlights."""
    return (closure["closure"] == "METAL" and any(closure["f0"]) and
            closure["mdf"].lower() in ("ashikhmin_shirley", "beckmann", "ward", "ward_half"))


def filtered(reader, closure, normal, weight):
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
        square, wide = widened(reader, closure, axis, more)
        before, after = math("ADD", before, square), math("ADD", after, wide)
    if (closure["mdf"].lower(), closure["brdf"].lower()) != ("beckmann", "microfacet"):
        return normal, weight
    return normal, _kept_by(reader, normal, "BECKMANN", before, after, weight)


def widened(reader, closure, axis, more):
    """The square of an alpha, and with that of bumps; how Beckmann's narrows these, shade/maps.h says."""
    math = reader.program.math
    alpha = _alpha(closure, axis)
    square = math("MULTIPLY", alpha, alpha)
    if closure["mdf"].lower() == "beckmann":
        part = 1.0 if closure["brdf"].lower() == "microfacet" else 0.5
        narrow = math("DIVIDE", 1.0, math("MULTIPLY_ADD", square, part, 1.0))
        more = math("MULTIPLY", more, math("MULTIPLY", narrow, narrow))
    wide = math("ADD", square, more)
    closure[f"a{axis}_from"] = [math("SQRT", wide)]
    return square, wide


def _alpha(closure, axis):
    return closure.get(f"a{axis}_from", [closure[f"a{axis}"]])[0]


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
        alpha = _alpha(closure, axis)
        square = math("MULTIPLY", alpha, alpha)
        own = math("DIVIDE", square, math("SUBTRACT", 2.0, math("MINIMUM", square, 1.0)))
        wide = math("MULTIPLY_ADD", more, 0.5, own)
        closure[f"a{axis}_from"] = [math("SQRT", math("DIVIDE", math("MULTIPLY", wide, 2.0), math("ADD", wide, 1.0)))]
        shares.append(math("SUBTRACT", 1.0, math("DIVIDE", own, wide)))
    if closure["brdf"].lower() == "ashikhmin_shirley":
        closure["bumps_from"] = shares
    return weight
