# SPDX-License-Identifier: Apache-2.0
"""One sample of the stability atlas: `study_atlas.py --at form=… tilt=… …` prints what shows it."""
import subprocess

import numpy as np

import atlas_facing as facing
import atlas_forms as forms
import atlas_measures as measures
import programs
import shade
from atlas_forms import FORMS, HORIZONS, dot
from atlas_measures import direction

WORDS = (*FORMS, *(w for w in measures.FLOATS if w not in FORMS), *HORIZONS, "fibre_printed")
ANGLES = ("tilt", "azimuth", "theta", "phi", "size", "n_theta", "n_phi", "h_theta", "h_phi", "eye", "eye_azimuth",
          "light", "light_azimuth")


def parse(words):
    """{key: value} of words key=value; ValueError names what is wrong."""
    given = {}
    for word in words:
        key, sep, value = word.partition("=")
        if not sep:
            raise ValueError(f"--at {word}: expected KEY=VALUE")
        if key == "form":
            if value not in WORDS:
                raise ValueError(f"--at form={value}: expected one of {', '.join(WORDS)}")
            given[key] = value
        elif key == "horizon":
            if value not in HORIZONS:
                raise ValueError(f"--at horizon={value}: expected one of {', '.join(HORIZONS)}")
            given[key] = value
        elif key in ANGLES:
            try:
                given[key] = float(value)
            except ValueError:
                given[key] = np.nan
            if not np.isfinite(given[key]):
                raise ValueError(f"--at {word}: expected a number")
        else:
            raise ValueError(f"--at {key}=: expected one of form, horizon, {', '.join(ANGLES)}")
    if "form" not in given:
        raise ValueError("--at: form=… is missing")
    return given


def reference(what, form, shape, n, *directions, horizon="hard"):
    """What `shade eval --precision reference` says, as text."""
    names = ("--ex", "--ey") if form.mdf == "ashikhmin_shirley" else ("--ax", "--ay")
    numbers = " ".join(repr(float(x)) for v in (n, *directions) for x in v)
    done = subprocess.run(
        [programs.SHADE, "eval", "--what", what, "--precision", "reference", "--defaults", "0", "--mdf", form.mdf,
         *(("--brdf", "microfacet") if form.mdf in ("beckmann", "ggx") and what == "f" else ()), "--detail", form.detail, "--groove", form.groove, "--horizon", horizon, names[0], repr(float(shape[0])), names[1],
         repr(float(shape[1]))], input=numbers + "\n", text=True, capture_output=True, check=False)
    if done.returncode:
        raise ValueError(done.stderr.strip())
    return done.stdout.split()[0]


def vector(v):
    return "({:.9g}, {:.9g}, {:.9g})".format(*v)


def at(given):
    """Lines of (what, value)."""
    word = given["form"]
    form = FORMS.get(word, FORMS["rotate"])
    if word in HORIZONS:
        given = {"horizon": word, **given}
    if word == "fibre_printed":
        return fibre(given)
    shape = measures.shape_of(form, given["size"]) if "size" in given else form.shape
    names = "exponents" if form.mdf == "ashikhmin_shirley" else "alphas"
    n = direction(given.get("n_theta", given.get("tilt", 30.0)), given.get("n_phi", given.get("azimuth", 45.0)))
    head = [("form", f"{form.label}" + (f" ({form.source})" if form.source else "")),
            (f"{form.mdf}, {names}", "{:g}, {:g}".format(*shape)), ("n", vector(n))]
    if "eye" in given and "light" in given:
        return head + pair(given, form, shape, n)
    if "eye" in given:
        return head + furnace(given, form, shape, n)
    if "light" in given:
        return head + beam(given, form, n)
    if "theta" in given or "h_theta" in given:
        return head + half(given, word, form, shape, n)
    return head + normal(given, form, shape, n)


def half(given, word, form, shape, n):
    if "h_theta" in given:
        h = direction(given["h_theta"], given["h_phi"])
    else:
        phi = given.get("phi", given.get("azimuth", 45.0))
        h = direction(abs(given["theta"]), phi + (180 if given["theta"] < 0 else 0))
    lines = [("h", vector(h))]
    if word in measures.FLOATS:
        n, h = n.astype(np.float32), h.astype(np.float32)
        with np.errstate(all="ignore"):
            lines.append((f"{word} (of float n and h)", f"{float(measures.FLOATS[word](n, h, shape)):.9g}"))
    if form.warp:
        with np.errstate(all="ignore"):
            lines.append(("|p| as printed", f"{float(np.abs(forms.warped(n, h, form.warp == 'smooth'))):.9g}"))
    if form.printed:
        x, y, z = forms.displaced(n, h, form.groove)
        lines += [("T⁻¹h of the displaced surface", f"({x:.9g}, {y:.9g}, {z:.9g})"),
                  ("D′ as printed", f"{float(form.value(n, h, shape)):.17g}")]
    long_n, long_h = (v.astype(np.longdouble) for v in (n, h))
    long_n, long_h = (v / np.sqrt(dot(v, v)) for v in (long_n, long_h))
    material = form.material(shape)
    return lines + [
        (f"D′ of the library, {form.detail}", f"{shade.D(material, n.astype(float), h.astype(float)):.17g}"),
        ("the same in float", f"{shade.D(material, n.astype('f4'), h.astype('f4')):.9g}"),
        ("D′ of the reference", reference("D", form, shape, n, h)),
        ("D′ of the displaced surface", f"{float(forms.truth(long_n, long_h, shape, form.mdf, form.groove)):.17g}"),
        ("peak", f"{form.peak(shape):.9g}")]


def normal(given, form, shape, n):
    if "size" in given:
        width = 1 / np.sqrt(max(max(shape), 1)) if form.mdf == "ashikhmin_shirley" else min(min(shape), 1.0)
        h, solid = measures.about(n if form.detail != "none" else np.array([0.0, 0, 1]), width, 400, 200)
    else:
        h, solid = measures.hemisphere(300, 600)
    value, true = form.value(n, h, shape), form.truth(n, h, shape)
    wide = measures.weight(form, n, h) * solid
    bad = ~np.isfinite(value)
    value = np.where(bad, 0, value)
    ours = shade.D(form.material(shape), n, h)
    top = measures.peak_at(form, n, h[np.argmax(value)]) if "size" not in given else h[np.argmax(value)]
    away = np.degrees(np.arccos(min(1, dot(top, n))))
    lines = [("∫D′", f"{(value * wide).sum():.6g}"),
             ("∫D′ of the library, " + form.detail, f"{(ours * wide).sum():.6g}"),
             ("∫D′ of the displaced surface", f"{(true * wide).sum():.6g}"),
             ("share that is NaN, of the sphere", f"{(bad * solid).sum() / (2 * np.pi):.6g}"),
             ("D′ is largest at", f"{vector(top)}, {away:.3g}° from n")]
    k = int(np.argmax(np.where(bad, 0, np.abs(value - true))))
    return lines + [("most off at h", vector(h[k])), ("there D′", f"{value[k]:.9g}"),
                    ("there of the reference, " + form.detail, reference("D", form, shape, n, h[k])),
                    ("there of the displaced surface", f"{true[k]:.9g}")]


def beam(given, form, n):
    """Light at an angle: what is given back of a beam."""
    horizon = given.get("horizon", "hard")
    wi = direction(given["light"], given.get("light_azimuth", 0.0))
    material = facing.material_of(form, horizon)
    return [("wi", vector(wi)), ("horizon", horizon), ("n·wi", f"{dot(n, wi):.9g}"),
            ("share of a beam given back", f"{facing.returned(material, n, wi, 200, 0.07):.6g}"),
            ("f cos towards the mirror image of wi about n",
             f"{facing.shaded(material, n, wi, 2 * dot(n, wi) * n - wi):.9g}")]


def furnace(given, form, shape, n):
    horizon = given.get("horizon", "hard")
    wo = direction(given["eye"], given.get("eye_azimuth", 0.0))
    material = facing.material_of(form, horizon, shape)
    if "size" in given:  # half vectors about n, where the lobe may be narrow
        h, solid = measures.about(n, facing.width_of(form, given["size"]), 300, 300)
        along = dot(h, wo)
        wi = 2 * along[:, None] * h - wo
        kept = (along > 0) & (wi[:, 2] > 0)
        wi, solid = wi[kept], 4 * along[kept] * solid[kept]
    else:
        wi, solid = measures.hemisphere(300, 600)
    plain, cosine = shade.eval(material, n, wi, wo)
    value = measures.reflected(facing.FormOf(form, shape), n, wi, wo) if form.printed else plain[:, 0] * cosine
    value = np.where(np.isfinite(value), value, 0)
    k = int(np.argmax(value))
    lines = [("wo", vector(wo)), ("horizon", horizon), ("albedo, by quadrature", f"{(value * solid).sum():.6g}")]
    if not form.printed:
        drawn = shade.sample(material, n, wo, measures.numbers(65536))
        there = drawn.pdf > 0
        weight = np.where(there, drawn.f[:, 0] * drawn.cosine / np.where(there, drawn.pdf, 1), 0)
        lines += [("mean of f cos/pdf, 65536 draws", f"{weight.mean():.6g}"),
                  ("its deviation over the mean", f"{weight.std() / max(weight.mean(), 1e-300):.6g}"),
                  ("largest weight", f"{weight.max():.6g}"),
                  ("draws that find no direction", f"{1 - there.mean():.6g}")]
    else:
        lines.append(("of the library, " + form.detail, f"{(plain[:, 0] * cosine * solid).sum():.6g}"))
    there = float(reference("f", form, shape, n, wi[k], wo, horizon=horizon)) * cosine[k]
    return lines + [("f cos is largest at wi", vector(wi[k])), ("f cos there", f"{value[k]:.9g}"),
                    ("that of the reference, " + form.detail, f"{there:.9g}")]


def pair(given, form, shape, n):
    horizon = given.get("horizon", "hard")
    wo = direction(given["eye"], given.get("eye_azimuth", 0.0))
    wi = direction(given["light"], given.get("light_azimuth", 0.0))
    material = facing.material_of(form, horizon, shape)
    wi_theta, wo_theta = given["light"], given["eye"]
    steps = []
    for who, theta, at_step in (
            ("light", wi_theta, lambda t: (direction(t, given.get("light_azimuth", 0.0)), wo)),
            ("eye", wo_theta, lambda t: (wi, direction(t, given.get("eye_azimuth", 0.0))))):
        values = [float(facing.shaded(material, n, *at_step(theta + np.degrees(d))))
                  for d in (-facing.NEAR_BY, facing.NEAR_BY)]
        steps.append((f"f cos with the {who} 10⁻⁷ rad nearer to z, and farther", "{:.9g}, {:.9g}".format(*values)))
    return [("wi", vector(wi)), ("wo", vector(wo)), ("horizon", horizon), *steps,
            ("f(wi, wo)", f"{shade.eval(material, n, wi, wo).f[0]:.17g}"),
            ("f(wo, wi)", f"{shade.eval(material, n, wo, wi).f[0]:.17g}"),
            ("f(wi, wo) of the reference", reference("f", form, shape, n, wi, wo, horizon=horizon)),
            ("f(wo, wi) of the reference", reference("f", form, shape, n, wo, wi, horizon=horizon))]


def fibre(given):
    light = direction(given.get("theta", 45.0), given.get("azimuth", 150.0))
    f, cosine = shade.eval(measures.fibres(), None, light, [0, 0, 1.0], parts="diffuse")
    done = subprocess.run(
        [programs.SHADE, "eval", "--what", "diffuse", "--diffuse", "fibre", "--precision", "reference"], text=True,
        input=" ".join(map(repr, light.tolist())) + "\n", capture_output=True, check=False)
    return [("light", vector(light)),
            ("Φ as printed (Hast, Wesslén and Seipel, Eq. 10)", f"{float(forms.fibre(light)):.9g}"),
            ("Φ of the library, (√(1 − (l·t)²) + n·l)/π", f"{np.pi * f[0] * cosine:.9g}"),
            ("Φ of the reference", done.stdout.strip()), ("mean over the fibre", f"{measures.over_fibre(light):.9g}")]
