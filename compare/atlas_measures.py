# SPDX-License-Identifier: Apache-2.0
"""What the stability atlas measures of a form (atlas_forms.py). Each function returns rows; angles are degrees."""
import functools

import numpy as np

import atlas_forms as forms
import shade
from atlas_forms import FORMS, dot

NEAR_BY = 1e-7  # radians: what differs over this jumps


def direction(theta, phi):
    theta, phi = np.broadcast_arrays(np.radians(theta), np.radians(phi))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def is_off(form, n, h):
    """Where a warp leaves the disc, by its printed formula; rounding at the rim does not count."""
    if not form.warp:
        return np.zeros(np.broadcast_shapes(n.shape, h.shape)[:-1], bool)
    with np.errstate(all="ignore"):
        return np.abs(forms.warped(n, h, form.warp == "smooth")) > 1 + 1e-9


def half(word, tilts, thetas, azimuth):
    """D' at half vectors in the plane of z and n, theta < 0 away from n, beside the displaced surface's."""
    form = FORMS[word]
    tilt, theta = (a.ravel() for a in np.meshgrid(tilts, thetas, indexing="ij"))
    n, h = direction(tilt, azimuth), direction(theta, azimuth)
    peak, value, true = form.peak(), form.value(n, h), form.truth(n, h)
    along, across = direction(theta + 90, azimuth), direction(90, azimuth + 90)
    beside = [form.value(n, v / np.sqrt(dot(v, v))[:, None])
              for v in (h + sign * NEAR_BY * side for side in (along, across) for sign in (1, -1))]
    with np.errstate(invalid="ignore"):
        # on the carried horizon itself, z̃ = 0, rounding decides which side is taken: no error, but maybe a jump
        error = np.where(np.abs(dot(n, h)) < 1e-9, 0, np.abs(value - true) / peak)
        jump = np.max([np.abs(b - value) for b in beside], 0) / peak
    bad = ~np.isfinite(value)
    return [{"map": "half", "form": word, "azimuth": azimuth, "tilt": float(t), "theta": float(a),
             "error": 0.0 if b else float(e), "jump": 0.0 if b or not np.isfinite(j) else float(j), "nan": int(b),
             "off": int(o)}
            for t, a, e, j, b, o in zip(tilt, theta, error, jump, bad, is_off(form, n, h))]


@functools.lru_cache(None)
def hemisphere(rows, turns):
    """Directions of the midpoint rule, and their solid angles."""
    theta, phi = (np.arange(rows) + 0.5) * 90 / rows, (np.arange(turns) + 0.5) * 360 / turns
    theta, phi = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
    return direction(theta, phi), np.sin(np.radians(theta)) * (np.pi / 2 / rows) * (2 * np.pi / turns)


def weight(form, n, h):
    """What ∫D' is taken with: nothing, or n·h for the distributions that are normalised so."""
    return np.maximum(dot(n, h), 0) if form.mdf in ("beckmann", "ggx") else 1.0


def peak_at(form, n, start):
    """Where D' is largest: from the largest of a grid on, ever finer."""
    best, step = start, 2.0
    for _ in range(7):
        x = np.cross(best, [1.0, 0, 0] if abs(best[0]) < 0.7 else [0, 1.0, 0])
        x /= np.linalg.norm(x)
        side = np.radians(np.linspace(-step, step, 5))
        a, b = (s.ravel()[:, None] for s in np.meshgrid(side, side))
        tried = best + a * x + b * np.cross(best, x)
        tried /= np.linalg.norm(tried, axis=-1, keepdims=True)
        found = np.where(tried[:, 2] > 0, np.nan_to_num(form.value(n, tried), nan=-1.0), -1.0)
        best, step = tried[np.argmax(found)], step / 2
    return best


def normal(word, tilts, azimuths, size):
    """∫D' over the hemisphere, displacement of the peak from n, shares of NaN and off the disc."""
    form, rows = FORMS[word], []
    size *= 2 if form.family == forms.SLOPES and form.printed else 1  # some stand close to the horizon, and narrow
    h, solid = hemisphere(size, 2 * size)
    for tilt in tilts:
        for azimuth in azimuths:
            n = direction(tilt, azimuth)
            value, true, wide = form.value(n, h), form.truth(n, h), weight(form, n, h) * solid
            bad = ~np.isfinite(value)
            value = np.where(bad, 0, value)
            flat = np.ptp(value) < 1e-9 * form.peak()
            best = peak_at(form, n, h[np.argmax(value)])
            # lobes narrower than the grid: n counts where D' is as large there, or beside it
            near = n + 1e-6 * np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0.0]])
            if np.nanmax(form.value(n, near / np.sqrt(dot(near, near))[:, None])) >= form.value(n, best):
                best = n
            away = np.degrees(np.arctan2(np.linalg.norm(np.cross(best, n)), dot(best, n)))
            rows.append({"map": "normal", "form": word, "tilt": float(tilt), "azimuth": float(azimuth),
                         "energy": float((value * wide).sum()), "true_energy": float((true * wide).sum()),
                         "variation": float(0.5 * (np.abs(value - true) * wide).sum()),
                         "displaced": 0.0 if flat else float(away), "flat": int(flat),
                         "nan_share": float((bad * solid * h[:, 2]).sum() / np.pi),
                         "off_share": float((is_off(form, n, h) * solid * h[:, 2]).sum() / np.pi)})
    return rows


@functools.lru_cache(64)
def rings_about(width, rings, turns):
    """Of directions about z: cos and sin of the angle from it, of the azimuth, and solid angles."""
    near, far = np.geomspace(3e-3 * width, 0.4, 3 * rings // 5), rings // 20
    t = np.concatenate([near, np.linspace(0.4, 1.35, 3 * far)[1:], np.linspace(1.35, np.pi / 2, 5 * far)[1:],
                        np.linspace(np.pi / 2, np.pi, 2 * far)[1:]])
    radius, phi = (t[1:] + t[:-1]) / 2, (np.arange(turns) + 0.5) * 2 * np.pi / turns
    r, phi = (a.ravel()[:, None] for a in np.meshgrid(radius, phi, indexing="ij"))
    solid = np.repeat((np.cos(t[:-1]) - np.cos(t[1:])) * 2 * np.pi / turns, turns)
    return np.cos(r), np.sin(r), np.cos(phi), np.sin(phi), solid


def about(middle, width, rings, turns):
    """Directions about one, rings ever wider, close again at 90° from it, and their solid angles."""
    cos_r, sin_r, cos_phi, sin_phi, solid = rings_about(width, rings, turns)
    x = np.cross(middle, [1.0, 0, 0] if abs(middle[0]) < 0.7 else [0, 1.0, 0])
    x /= np.linalg.norm(x)
    h = cos_r * middle + sin_r * (cos_phi * x + sin_phi * np.cross(middle, x))
    up = h[:, 2] > 0
    return h[up], solid[up]


def shape_of(form, size):
    """The parameters of a lobe by its narrow axis: an exponent, or an alpha."""
    if form.mdf == "ashikhmin_shirley":
        pair = (size, size / 20)
    else:
        pair = (size, min(4 * size, 10.0))
    return pair if form.groove == "x" else pair[::-1]


def sizes_of(form):
    return ((0.0, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6) if form.mdf == "ashikhmin_shirley"
            else (1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0, 10.0))


def off_peak(form, function, n, h, value, shape, width):
    """Angle from n to where function(n, h, shape) is largest, by its values on a grid; 0 where nothing is larger than
    at n or beside it."""
    value = np.where(np.isfinite(value), value, 0)
    near = n + 1e-6 * width * np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0.0]])
    there = np.nanmax(function(n, near / np.sqrt(dot(near, near))[:, None], shape))
    k = int(np.argmax(value))
    if there >= value[k] * (1 - 1e-9) or np.ptp(value) < 1e-9 * form.peak(shape):
        return 0.0
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(h[k], n)), dot(h[k], n))))


def lobe(word, tilts, azimuths, rings=160, turns=96):
    """∫D' and the displacement of its peak over exponents and alphas, each the worst of some azimuths of n."""
    form, rows = FORMS[word], []
    for size in sizes_of(form):
        shape = shape_of(form, size)
        width = 1 / np.sqrt(max(size, 1)) if form.mdf == "ashikhmin_shirley" else min(size, 1.0)
        for tilt in tilts:
            worst, moved = None, (-1.0, 0.0)
            for azimuth in azimuths:
                n = direction(tilt, azimuth)
                energy, away = [], []
                stands = n if form.detail != "none" else np.array([0.0, 0, 1])
                for value, middle in ((form.value, stands), (form.truth, n)):
                    h, solid = about(middle, width, rings, turns)
                    d = value(n, h, shape)
                    energy.append(float((np.where(np.isfinite(d), d, 0) * weight(form, n, h) * solid).sum()))
                    if value == form.value:
                        nan = int((~np.isfinite(d)).sum())
                    away.append(off_peak(form, value, n, h, d, shape, width))
                # of the widest lobes the displaced surface's own is largest elsewhere
                moved = max(moved, (away[0] if away[1] == 0 else 0.0, float(azimuth)))
                row = {"map": "lobe", "form": word, "size": size, "tilt": float(tilt), "azimuth": float(azimuth),
                       "energy": energy[0], "true_energy": energy[1], "nan": nan}
                if worst is None or abs(energy[0] - energy[1]) > abs(worst["energy"] - worst["true_energy"]):
                    worst = row
            rows.append({**worst, "displaced": moved[0], "displaced_azimuth": moved[1]})
    return rows


# ---- rounding ---------------------------------------------------------------------------------------

def literal_float(n, h, shape):
    """The textbook's frame in float: axes made unit, pow of the cosine."""
    return forms.ashikhmin_shirley(*forms.displaced(n, h), *map(np.float32, shape))


def common_float(n, h, shape):
    """The same over 1 − z² instead of x² + y²."""
    x, y, z = forms.displaced(n, h)
    return forms.ashikhmin_shirley(x, y, z, *map(np.float32, shape), sin2=1 - z * z)


FLOATS = {
    "literal": literal_float, "common": common_float,
    "float": lambda n, h, shape: FORMS["rotate"].value(n, h, shape),
    "double": lambda n, h, shape: FORMS["rotate"].value(n.astype(float), h.astype(float), shape)}


def rounded(tilts, exponents, azimuths=(0, 35, 90)):
    """Relative error of D in float against the frame of the displaced surface in 80-bit numbers, on the same float
    inputs; h within three widths of the lobe, D above 10⁻⁶ of the peak, z̃ above .05."""
    rows, form = [], FORMS["rotate"]
    spin, out = (a.ravel() for a in np.meshgrid(np.arange(12) * 30 + 4.0, [0.2, 0.7, 1.5, 3.0]))
    for exponent in exponents:
        shape = shape_of(form, exponent)
        for tilt in tilts:
            n = np.concatenate([np.broadcast_to(direction(tilt, a), (len(spin), 3)) for a in azimuths])
            wide = np.tile(out, len(azimuths)) / np.sqrt(max(exponent / 20, 1))
            x = np.cross(n, [0.0, 1, 0.01])
            x /= np.linalg.norm(x, axis=-1, keepdims=True)
            turn = np.radians(np.tile(spin, len(azimuths)))[:, None]
            h = n + np.tan(np.minimum(wide, 1.4))[:, None] * (np.cos(turn) * x + np.sin(turn) * np.cross(n, x))
            h = (h / np.linalg.norm(h, axis=-1, keepdims=True)).astype(np.float32)
            n = n.astype(np.float32)
            long_n, long_h = (v.astype(np.longdouble) for v in (n, h))
            long_n, long_h = (v / np.sqrt(dot(v, v))[:, None] for v in (long_n, long_h))
            true = forms.truth(long_n, long_h, tuple(map(np.longdouble, shape)))
            kept = (true > 1e-6 * form.peak(shape)) & (dot(long_n, long_h) > 0.05) & (long_h[:, 2] > 0)
            for word, value in FLOATS.items():
                with np.errstate(all="ignore"):
                    d = value(n, h, shape).astype(np.longdouble)
                    error = np.where(kept, np.abs(d / true - 1), 0)
                error = np.where(np.isnan(error), np.inf, error)
                k = int(np.argmax(error))
                rows.append({"map": "float", "form": word, "tilt": float(tilt), "size": float(exponent),
                             "error": float(min(error[k], 1e9)), **spherical("n", n[k]), **spherical("h", h[k])})
    return rows


def spherical(name, v):
    """A direction as columns: degrees from z and about it."""
    v = v.astype(float)
    return {f"{name}_theta": float(np.degrees(np.arctan2(np.hypot(v[0], v[1]), v[2]))),
            f"{name}_phi": float(np.degrees(np.arctan2(v[1], v[0])))}


# ---- the BRDF: grazing light and eye ------------------------------------------------------------------

def numbers(count):
    """Points that fill the unit square evenly."""
    k = np.arange(count)[:, None]
    return np.modf(0.5 + k * np.array([[0.7548776662466927, 0.5698402909980532]]))[0]


def reflected(form, n, wi, wo):
    """f cos of a printed D' in Ashikhmin and Shirley's BRDF, F = 1, black below either horizon."""
    h = wi + wo
    h = h / np.linalg.norm(h, axis=-1, keepdims=True)
    ni, no, oz = dot(n, wi), dot(n, wo), wo[..., 2]
    with np.errstate(all="ignore"):
        value = form.value(n, h) * ni / (4 * dot(h, wo) * np.maximum(ni, no))
    return np.where((ni > 0) & (no > 0) & (wi[..., 2] > 0) & (oz > 0), value, 0)


def grazing(word, horizon, tilts, eyes, draws, azimuths, turns):
    """Albedo of a white material (F = 1) under even light, and the deviation of sampling weights over their mean,
    worst of some azimuths of n and the eye. Printed forms by quadrature over the light, without weights."""
    form, rows = FORMS[word], []
    material = form.material(horizon=horizon)
    for tilt in tilts:
        for eye in eyes:
            found = []
            for azimuth in azimuths:
                n = direction(tilt, azimuth)
                wo = direction(eye, np.arange(turns) * 360 / turns)
                if form.printed:
                    wi, solid = hemisphere(draws, 2 * draws)
                    value = reflected(form, n, wi, wo[:, None])
                    albedo, spread = (np.where(np.isfinite(value), value, 0) * solid).sum(-1), np.zeros(turns)
                else:
                    drawn = shade.sample(material, n, wo[:, None], numbers(draws))
                    there = drawn.pdf > 0
                    weights = np.where(there, drawn.f[..., 0] * drawn.cosine / np.where(there, drawn.pdf, 1), 0)
                    albedo = weights.mean(-1)
                    spread = weights.std(-1) / np.where(albedo > 1e-6, albedo, 1) * (albedo > 0.05)
                for k in range(turns):
                    found.append((float(albedo[k]), float(spread[k]), azimuth, k * 360 / turns))
            best, wide = max(found), max(found, key=lambda f: f[1])
            rows.append({"map": "grazing", "form": word, "horizon": horizon, "tilt": float(tilt), "eye": float(eye),
                         "albedo": best[0], "azimuth": float(best[2]), "eye_azimuth": float(best[3]),
                         "spread": wide[1], "spread_azimuth": float(wide[2]), "spread_eye_azimuth": float(wide[3])})
    return rows


def pairs(word, horizon, tilt, angles, azimuths=(0, 45, 90), turns=8):
    """|f(wi, wo) − f(wo, wi)| over the larger of both where that is above 10⁻³, worst of some azimuths."""
    material, rows = FORMS[word].material(horizon=horizon), []
    phi = np.arange(turns) * 360 / turns + 10
    a, b = np.meshgrid(phi, phi)
    for eye in angles:
        for light in angles:
            worst = (0.0, 0.0, 0.0, 0.0)
            for azimuth in azimuths:
                n, wo, wi = direction(tilt, azimuth), direction(eye, a), direction(light, b)
                there, back = (shade.eval(material, n, *both).f[..., 0] for both in ((wi, wo), (wo, wi)))
                top = np.maximum(there, back)
                off = np.where(top > 1e-3, np.abs(there - back) / np.where(top > 0, top, 1), 0)
                k = np.unravel_index(np.argmax(off), off.shape)
                worst = max(worst, (float(off[k]), float(azimuth), float(a[k]), float(b[k])))
            rows.append({"map": "pairs", "form": word, "horizon": horizon, "tilt": float(tilt), "eye": float(eye),
                         "light": float(light), "asymmetry": worst[0], "azimuth": worst[1], "eye_azimuth": worst[2],
                         "light_azimuth": worst[3]})
    return rows


# ---- jumps --------------------------------------------------------------------------------------------

def fibres():
    return shade.Material(diffuse="fibre", kd=1.0, f0=0.0, fresnel="none", detail="none")


def over_fibre(light):
    """The mean of max(0, n'·l) over the upper half of a fibre along x, by the midpoint rule."""
    turn = (np.arange(4000) + 0.5) * np.pi / 4000
    return np.maximum(np.sin(turn) * light[..., 2:] + np.cos(turn) * light[..., 1:2], 0).mean(-1)


def fibre(thetas, azimuths):
    """Φ of fibres along x as printed (Eq. 10) and as the library has it, beside the mean over the fibre."""
    theta, phi = (a.ravel() for a in np.meshgrid(thetas, azimuths, indexing="ij"))
    light = direction(theta, phi)
    ours, cosine = shade.eval(fibres(), None, light, [0, 0, 1.0], parts="diffuse")
    true, printed = over_fibre(light), forms.fibre(light)
    bad = ~np.isfinite(printed)
    return [{"map": "fibre", "form": "fibre_printed", "theta": float(t), "azimuth": float(p), "nan": int(b),
             "error": 0.0 if b else float(abs(v - q)), "library_error": float(abs(np.pi * o * c - q))}
            for t, p, b, v, o, c, q in zip(theta, phi, bad, printed, ours[:, 0], cosine, true)]


def jumps(distances=(1e-2, 1e-4, 1e-6)):
    """Where D' or f cos is known not to be continuous: the difference over the peak between two directions at a
    distance; what stays as they come together is a jump."""
    rows = []

    def add(word, place, path):
        form = FORMS[word]
        for distance in distances:
            (n1, h1), (n2, h2) = path(distance)
            values = [float(form.value(n, h)) for n, h in ((n1, h1), (n2, h2))]
            rows.append({"map": "jump", "form": word, "place": place, "distance": distance,
                         "jump": min(abs(values[0] - values[1]) / form.peak(), 1e9)
                         if np.all(np.isfinite(values)) else 1e9})

    unit = lambda x, y, z: np.array([x, y, z]) / np.sqrt(x * x + y * y + z * z)  # noqa: E731
    tilted = direction(20, 45)
    for word in ("perturb", "ward_of_h", "gram_schmidt", "rotate", "deform_smooth"):
        add(word, "h = z", lambda d: ((tilted, unit(d, 0, 1)), (tilted, unit(0, d, 1))))
    for word in ("deform_linear_conserving", "deform_smooth_conserving", "deform_linear", "deform_smooth", "rotate"):
        add(word, "h = n", lambda d: ((tilted, direction(20 + np.degrees(d), 45)),
                                      (tilted, direction(20 - np.degrees(d), 45))))
    for word in ("rotate", "shortest_arc"):
        add(word, "n → y", lambda d: ((unit(d * d, 1, d), unit(1, 3, 0.5)), (unit(d, 1, d * d), unit(1, 3, 0.5))))
    for word in ("gram_schmidt", "rotate"):
        add(word, "n → x", lambda d: ((unit(1, d * d, d), unit(3, 1, 0.5)), (unit(1, d, d * d), unit(3, 1, 0.5))))
    for word in ("ggx_rotate", "beckmann_rotate", "rotate"):
        add(word, "z̃ = 0", lambda d: ((direction(60, 0), direction(30 - np.degrees(d), 180)),
                                       (direction(60, 0), direction(30 + np.degrees(d), 180))))
    return rows


def horizons(distances=(1e-2, 1e-4, 1e-6)):
    """f cos on both sides of the surface's horizon for the light and of n's for the eye, apart by those angles, over
    what it is 20 degrees above; a broad lobe (exponents 10 and 5), n tilted by 30 degrees."""
    n, rows = direction(30, 45), []
    places = {"wi.z = 0": lambda d: (direction(90 - np.degrees(d), 45), direction(30, 225)),
              "n·wo = 0": lambda d: (direction(60, 45), direction(60 - np.degrees(d), 225))}
    for horizon in forms.HORIZONS:
        material = shade.Material(ex=10, ey=5, fresnel="none", horizon=horizon)
        for place, at in places.items():
            for distance in distances:
                values = []
                for d in (np.radians(20), distance / 2, -distance / 2):
                    f, cosine = shade.eval(material, n, *at(d))
                    values.append(float(f[0] * cosine))
                rows.append({"map": "edge", "form": "rotate", "horizon": horizon, "place": place, "distance": distance,
                             "jump": abs(values[1] - values[2]) / values[0]})
    return rows
