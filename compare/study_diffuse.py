# SPDX-License-Identifier: Apache-2.0
"""Diffuse models of fibres: what each costs, and how far it is from fibres that shade and hide each other.

The truth is worked out here by numpy and shares no code with libshade: a layer of touching round fibres,
cut into many thin strips; a strip counts where a ray to the eye meets no neighbour, and is lit where a
ray to the light meets none.
"""
import numpy as np

import fronts
import programs  # noqa: F401  (finds the module)
import shade
import style
from study import Figure, Finding, Table, Task

NAME = "diffuse"
TITLE = "Diffuse light on fibres"
INTRO = ("Brushed metal and yarn scatter light as thin round fibres do. The truth is a layer of touching fibres, each "
         "strip of which is dark where a neighbour shades it and unseen where one hides it, after Poulin and Fournier: "
         "Φ is the mean of n′·l over what the eye sees, 1 where all of it faces the light. Light and eye are spread "
         "evenly over the hemisphere, 10° and more above the horizon. The error is the mean absolute one over the mean "
         "of the truth. Times are for the diffuse part alone about a bumped normal, in float.")
MODELS = ("lambert", "max_normal", "max_normal_scaled", "fibre", "fibre_view")


def directions(count, seed):
    """(count, 3), even over the solid angle, 10 degrees and more above the horizon."""
    k = np.arange(count) + 0.5
    random = np.random.default_rng(seed)
    z = np.sin(np.radians(10)) + (1 - np.sin(np.radians(10))) * k / count
    phi = 2 * np.pi * random.random(count)
    side = np.sqrt(1 - z * z)
    return np.stack([side * np.cos(phi), side * np.sin(phi), z], -1)


def free(points, w):
    """Which points of the fibre about (0, 0) see out along w, given across it (y, z), past fibres of
    radius 1 about (2k, 0), and lie on the side of it that faces w."""
    y, z = points
    wy, wz = w
    norm = np.hypot(wy, wz)
    out = y * wy + z * wz > 0
    for centre in (-6, -4, -2, 2, 4, 6):
        along = ((centre - y) * wy - z * wz) / norm
        apart = np.abs((centre - y) * wz + z * wy) / norm
        out &= ~((along > 0) & (apart < 1))
    return out


def truth(lights, eyes, strips):
    """Phi of each pair."""
    theta = np.pi * ((np.arange(strips) + 0.5) / strips - 0.5)
    y, z = np.sin(theta), np.cos(theta)
    found = []
    for light, eye in zip(lights, eyes):
        seen = np.where(free((y, z), eye[1:]), y * eye[1] + z * eye[2], 0.0)
        lit = np.where(free((y, z), light[1:]), y * light[1] + z * light[2], 0.0)
        found.append((seen * lit).sum() / max(seen.sum(), 1e-300))
    return np.array(found)


def model(word, lights, eyes):
    """Phi by the library."""
    scale = 2 / np.pi if word.endswith("_scaled") else 1.0
    made = shade.Material(diffuse=word.removesuffix("_scaled"), kd=1.0, detail="none", groove="x", horizon="hard")
    f, cosine = shade.eval(made, np.array([0.0, 0, 1]), lights, eyes, parts="diffuse")
    return scale * np.pi * f[:, 0] * cosine


def errors(pairs, strips):
    def run(_folder, _say):
        lights, eyes = directions(pairs, 1), np.random.default_rng(3).permutation(directions(pairs, 2))
        true, coarse = truth(lights, eyes, strips), truth(lights, eyes, strips // 2)
        rows = [{"kind": "truth", "mean": float(true.mean()), "quadrature": float(np.abs(true - coarse).mean())}]
        for word in MODELS:
            off = np.abs(model(word, lights, eyes) - true) / true.mean()
            low, high = np.percentile(off, [25, 75])
            rows.append({"kind": "error", "method": word, "error": float(off.mean()), "error_low": float(low),
                         "error_high": float(high), "worst": float(off.max()),
                         "bias": float((model(word, lights, eyes) - true).mean() / true.mean())})
        return rows
    return run


def speed(runs):
    def run(_folder, say):
        rows = fronts.bench(["--what", "diffuse"], runs, say)
        return [{"kind": "speed", **row} for row in rows if row["precision"] == "float"]
    return run


def tasks(quick):
    runs, pairs, strips = (7, 1500, 800) if quick else (21, 12000, 3200)
    return [Task("speed", 0.15 * runs, speed(runs), fronts.command(["--what", "diffuse"])),
            Task("error", 1 if quick else 25, errors(pairs, strips))]


def points(rows):
    found = []
    for word in MODELS:
        e = fronts.one(rows, kind="error", method=word)
        found.append(fronts.Point(word, fronts.times(rows, kind="speed", method=word.removesuffix("_scaled")),
                                  e["error"], min(e["error_low"], e["error"]), max(e["error_high"], e["error"])))
    return found


def findings(rows):
    e = {p.word: p.error for p in points(rows)}
    bias = {word: fronts.one(rows, kind="error", method=word)["bias"] for word in MODELS}
    cost = fronts.ratio(*(fronts.times(rows, kind="speed", method=m) for m in ("fibre_view", "lambert")))[0]
    fibre = fronts.ratio(*(fronts.times(rows, kind="speed", method=m) for m in ("fibre", "max_normal")))[0]
    return [
        Finding(f"Nearest to fibres that shade and hide each other is `fibre_view`, {e['fibre_view']:.2f} off, at "
                f"{cost:.2f} times Lambert's time; Lambert itself is {e['lambert']:.2f} off.",
                min(e, key=e.get) == "fibre_view" and cost < 3, "front",
                timed=True),
        Finding(f"The maximum normal, the papers' quick way, is {e['max_normal']:.2f} off and "
                f"{100 * bias['max_normal']:.0f} % too bright in the mean; scaled by 2/π it is "
                f"{e['max_normal_scaled']:.2f} off. The integral over the fibre, {e['fibre']:.2f} off, takes "
                f"{fibre:.2f} times its time.",
                e["fibre"] < e["max_normal"] and bias["max_normal"] > 0.1 and fibre < 2, "front",
                timed=True),
    ]


def figures(rows):
    panel, axes = style.figure(360, 290)
    fronts.chart(axes, points(rows), "", "mean error / mean of the truth")
    return [Figure("front", "Time against error of each diffuse model",
                   "Bars: the middle half of the runs, and of the pairs of light and eye; dashed: the Pareto front. "
                   "`build/venv/bin/python compare/report_page.py --only diffuse`", style.svg(panel),
                   "Time against error of Lambert, maximum normal, fibre and fibre view; the last is nearest to "
                   "the truth and takes longest.")]


def tables(rows):
    lines = []
    for p in points(rows):
        e = fronts.one(rows, kind="error", method=p.word)
        lines.append([style.of(p.word).label, p.ns, "{:.3g} to {:.3g}".format(*p.bar), e["error"], e["worst"],
                      100 * e["bias"]])
    return [Table("numbers", "Diffuse models against fibres with neighbours", "Errors over the mean of the truth.",
                  ["model", "ns", "middle half", "mean error", "worst error", "too bright, %"], lines)]
