# SPDX-License-Identifier: Apache-2.0
"""What the stability atlas measures where light or eye grazes, and of lobes of any width: rows, angles in degrees.

The BRDF is Ashikhmin and Shirley's, or `microfacet` for Beckmann and GGX, with F = 1. Printed forms have no horizons
but black below either, and no draws; since their D' is one of h alone they are reciprocal by construction.
"""
import numpy as np

import atlas_measures as measures
import shade
from atlas_forms import FORMS, dot
from atlas_measures import NEAR_BY, about, direction

OTHERS = (0, 20, 40, 60, 75, 85, 89)  # the direction that is not on the map's axis, from z
TINY, FLOOR = 1e-3, 0.05  # f below TINY is not exchanged; steps are parts of f cos of FLOOR or more


def material_of(form, horizon, shape=None):
    brdf = {} if form.mdf == "ashikhmin_shirley" else {"brdf": "microfacet"}
    return form.material(shape, horizon=horizon, **brdf)


def width_of(form, size):
    """Of the narrow axis, in radians."""
    return 1 / np.sqrt(max(size, 1)) if form.mdf == "ashikhmin_shirley" else min(size, 1.0)


# ---- D' of lobes of any width ------------------------------------------------------------------------

def widths(word, tilts, azimuth=45):
    """The worst jump of D', in parts of the peak, and NaN, in the plane of z and n, over sizes and tilts."""
    form, rows = FORMS[word], []
    for size in measures.sizes_of(form):
        shape, wide = measures.shape_of(form, size), np.degrees(width_of(form, size))
        offsets = wide * np.array([-3, -1, -0.3, 0, 0.3, 1, 3])
        peak, step = form.peak(shape), NEAR_BY * min(1.0, 30 * width_of(form, size))
        for tilt in tilts:
            theta = np.concatenate([np.arange(-80.0, 81, 10), np.clip(tilt + offsets, -89, 89)])
            n, h = direction(tilt, azimuth), direction(theta, azimuth)
            value = form.value(n, h, shape)
            jump = np.zeros(len(theta))
            for side in (direction(theta + 90, azimuth), direction(90, azimuth + 90)):
                for sign in (1, -1):
                    beside = h + sign * step * side
                    beside = form.value(n, beside / np.sqrt(dot(beside, beside))[:, None], shape)
                    with np.errstate(invalid="ignore"):
                        off = np.abs(beside - value) / peak
                    jump = np.maximum(jump, np.where(np.isfinite(off), off, 0))
            bad = ~np.isfinite(value)
            k, b = int(np.argmax(jump)), int(np.argmax(bad))
            rows.append({"map": "wide", "form": word, "size": float(size), "tilt": float(tilt), "azimuth": float(azimuth),
                         "jump": float(min(jump[k], 1e9)), "theta": float(theta[k]), "nan": int(bad.sum()),
                         "nan_theta": float(theta[b])})
    return rows


# ---- f where the eye or the light is at an angle -------------------------------------------------------

def others(fixed, n):
    """Directions all over the sphere's upper half, and the mirror image of `fixed` about n."""
    theta, phi = (a.ravel() for a in np.meshgrid(OTHERS, np.arange(12) * 30 + 10, indexing="ij"))
    mirror = 2 * dot(fixed, n) * n - fixed
    return np.concatenate([direction(theta, phi), mirror[None]]) if mirror[2] > 1e-3 else direction(theta, phi)


def shaded(material, n, wi, wo):
    """f cos."""
    f, cosine = shade.eval(material, n, wi, wo)
    return f[..., 0] * cosine


def spherical(v):
    """(theta, phi) in degrees; theta from z."""
    return float(np.degrees(np.arctan2(np.hypot(v[0], v[1]), v[2]))), float(np.degrees(np.arctan2(v[1], v[0])))


def swapped(material, n, fixed, other, which):
    """|f(wi, wo) − f(wo, wi)| over the larger of both, where that is above TINY."""
    pair = (other, fixed) if which == "eye" else (fixed, other)
    there, back = (shade.eval(material, n, *both).f[..., 0] for both in (pair, pair[::-1]))
    top = np.maximum(there, back)
    return np.where(top > TINY, np.abs(there - back) / np.where(top > 0, top, 1), 0), there


def stepped(material, n, fixed, other, which):
    """The largest difference of f cos as `fixed` moves by NEAR_BY along its polar angle, over its largest, which
    counts as FLOOR at least: what is nearly black and steep is no jump."""
    theta, phi = spherical(fixed)
    values = []
    for move in (-NEAR_BY, 0, NEAR_BY):
        moved = np.broadcast_to(direction(theta + np.degrees(move), phi), other.shape)
        values.append(shaded(material, n, *((other, moved) if which == "eye" else (moved, other))))
    top = max(np.max(values), FLOOR)
    return np.max(np.abs(np.diff(values, axis=0)), axis=0) / top


def returned(material, n, wi, rings, width):
    """What of a beam of light is reflected to any eye above: ∫ f cos (n·wo) dwo/(n·wi); 0
    where the light is behind the facet. `none` and `schuessler` are of the surface: there n is z."""
    facet = np.array([0.0, 0, 1]) if material.detail == "none" or material.horizon == "schuessler" else n
    incident = float(dot(facet, wi))
    if incident < 1e-6 or dot(n, wi) < 1e-6:
        return 0.0
    if material.horizon == "schuessler":  # a second lobe, by the bounce, is elsewhere
        wo, solid = measures.hemisphere(3 * rings, 6 * rings)
    else:
        h, solid = about(n if material.detail != "none" else facet, width, rings, rings)
        along = dot(h, wi)
        wo, solid = 2 * along[:, None] * h - wi, 4 * along * solid
    kept = (solid > 0) & (wo[:, 2] > 0) & (dot(wo, n) > 0)
    if not kept.any():
        return 0.0
    wo = wo[kept]
    value = shaded(material, n, np.broadcast_to(wi, wo.shape), wo)
    return float((value * dot(wo, facet) * solid[kept]).sum() / incident)


def facing(word, horizon, which, tilts, angles, azimuths=(0, 45, 90), rings=0):
    """Of the eye or the light (`which`) at angles from z and tilts of n: the worst non-reciprocity, jump, NaN; of the
    light also what a beam gives back, where `rings` says how finely that is added up."""
    form, rows = FORMS[word], []
    material, other_name = material_of(form, horizon), {"eye": "light", "light": "eye"}[which]
    for tilt in tilts:
        for angle in angles:
            row = {"map": which, "form": word, "horizon": horizon, "tilt": float(tilt), which: float(angle), "nan": 0,
                   "asymmetry": -1.0, "jump": -1.0}
            if rings:
                row["albedo"] = -1.0
            for azimuth in azimuths:
                n = direction(tilt, azimuth)
                for turn in (0, 90, 180, 270):
                    fixed = direction(angle, azimuth + turn)
                    other = others(fixed, n)
                    spread = np.broadcast_to(fixed, other.shape)
                    off, values = swapped(material, n, spread, other, which)
                    row["nan"] += int((~np.isfinite(values)).sum())
                    for name, found in (("asymmetry", off), ("jump", stepped(material, n, fixed, other, which))):
                        k = int(np.argmax(found))
                        if found[k] > row[name]:
                            theta, phi = spherical(other[k])
                            row.update({name: float(found[k]), f"{name}_azimuth": float(azimuth),
                                        f"{name}_{which}_azimuth": float(azimuth + turn), f"{name}_{other_name}": theta,
                                        f"{name}_{other_name}_azimuth": phi})
                    if rings:
                        albedo = returned(material, n, fixed, rings, 0.07)
                        if albedo > row["albedo"]:
                            row.update(albedo=albedo, azimuth=float(azimuth), light_azimuth=float(azimuth + turn))
            rows.append(row)
    return rows


# ---- lobes of any width where the eye grazes -------------------------------------------------------------

def of_printed(form, n, wo, shape, size, rings, turns):
    """Albedo of a printed D', over half vectors about n."""
    h, solid = about(n, width_of(form, size), rings, turns)
    along = dot(h, wo)
    wi = 2 * along[:, None] * h - wo
    kept = (along > 0) & (wi[:, 2] > 0) & (dot(wi, n) > 0) & (dot(wo, n) > 0)
    value = measures.reflected(FormOf(form, shape), n, wi[kept], wo)
    return float((np.where(np.isfinite(value), value, 0) * 4 * along[kept] * solid[kept]).sum())


class FormOf:
    """A form with its lobe's parameters fixed."""

    def __init__(self, form, shape):
        self.value = lambda n, h: form.value(n, h, shape)


def narrow(word, horizon, tilts, eye, draws, azimuths=(0, 45), turns=4, rings=60):
    """Over sizes and tilts, the eye at an angle: albedo and spread of weights as grazing() has them, non-reciprocity."""
    form, rows = FORMS[word], []
    for size in measures.sizes_of(form):
        shape = measures.shape_of(form, size)
        material = material_of(form, horizon, shape)
        for tilt in tilts:
            row = {"map": "narrow", "form": word, "horizon": horizon, "size": float(size), "tilt": float(tilt),
                   "eye": float(eye), "albedo": -1.0, "spread": -1.0, "asymmetry": -1.0, "nan": 0}
            for azimuth in azimuths:
                n = direction(tilt, azimuth)
                for k in range(turns):
                    turn = k * 360 / turns
                    wo = direction(eye, turn)
                    if form.printed:
                        albedo, spread = of_printed(form, n, wo, shape, size, rings, rings), 0.0
                    else:
                        drawn = shade.sample(material, n, wo, measures.numbers(draws))
                        there = drawn.pdf > 0
                        weights = np.where(there, drawn.f[..., 0] * drawn.cosine / np.where(there, drawn.pdf, 1), 0)
                        row["nan"] += int((~np.isfinite(weights)).sum())
                        albedo = float(weights.mean())
                        spread = float(weights.std() / albedo) if albedo > 0.05 else 0.0
                        other = np.concatenate([others(wo, n), drawn.wi[there][:24]])
                        off, _values = swapped(material, n, np.broadcast_to(wo, other.shape), other, "eye")
                        worst = int(np.argmax(off))
                        if off[worst] > row["asymmetry"]:
                            theta, phi = spherical(other[worst])
                            row.update(asymmetry=float(off[worst]), asymmetry_azimuth=float(azimuth),
                                       asymmetry_eye_azimuth=turn, asymmetry_light=theta, asymmetry_light_azimuth=phi)
                    if albedo > row["albedo"]:
                        row.update(albedo=albedo, azimuth=float(azimuth), eye_azimuth=turn)
                    if spread > row["spread"]:
                        row.update(spread=spread, spread_azimuth=float(azimuth), spread_eye_azimuth=turn)
            row["asymmetry"] = max(row["asymmetry"], 0.0)
            rows.append(row)
    return rows
