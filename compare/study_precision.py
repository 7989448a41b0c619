# SPDX-License-Identifier: Apache-2.0
"""Precision forms: what float, double and the reference cost, and the digits that each keeps.

The truth is D of a rotated lobe in decimal arithmetic of 40 digits, written here from the definitions.
"""
import decimal
import subprocess
from decimal import Decimal

import numpy as np

import fronts
import programs
import report
import style
from study import Figure, Finding, Table, Task

NAME = "precision"
TITLE = "Precision: float, double, reference"
INTRO = ("The library evaluates a distribution in single precision (float) or double, and has a reference "
         "in long double, which its tests trust. All three get the same directions, rounded to single precision, "
         "within 60° of the surface's normal, with detail `rotate` and exponents 200 and 10 or the matching "
         "alphas. The truth is decimal arithmetic with 40 digits, by a program that shares no code with them. The "
         "error is the worst relative one where D is above 10⁻¹² of its peak; its bar reaches down to the median.")
MDFS = ("ashikhmin_shirley", "ward", "ward_half", "beckmann", "ggx")
FORMS = ("float", "double", "reference")
EX, EY = 200, 10
PEAK_SHARE = Decimal("1e-12")
PI = Decimal("3.141592653589793238462643383279502884197169399375")


def directions(count, seed=7):
    """(count, 3) float32, within 60 degrees of z."""
    random = np.random.default_rng(seed)
    theta, phi = random.random(count) * np.pi / 3, random.random(count) * 2 * np.pi
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)],
                    -1).astype(np.float32)


def unit(v):
    v = [Decimal(float(c)) for c in v]
    length = sum(c * c for c in v).sqrt()
    return [c / length for c in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def alpha2(e):
    return Decimal(2) / (e + 2)


def truth(mdf, n, h):
    """(D, its peak), of the lobe whose x axis is dP/du of the surface with normal n."""
    n, h = unit(n), unit(h)
    length = (n[0] * n[0] + n[2] * n[2]).sqrt()
    x = [n[2] / length, Decimal(0), -n[0] / length]
    hx, hy, hz = dot(x, h), dot(cross(n, x), h), dot(n, h)
    ex, ey = Decimal(EX), Decimal(EY)
    ax2, ay2 = alpha2(ex), alpha2(ey)
    if mdf == "ashikhmin_shirley":
        peak = ((ex + 1) * (ey + 1)).sqrt() / (2 * PI)
        power = (ex * hx * hx + ey * hy * hy) / (hx * hx + hy * hy)
        return (peak * (power * hz.ln()).exp() if hz > 0 else Decimal(0)), peak
    peak = 1 / (PI * (ax2 * ay2).sqrt())
    if hz <= 0:
        return Decimal(0), peak
    side = hx * hx / ax2 + hy * hy / ay2
    slope = side / (hz * hz)
    if mdf == "ward":
        return peak * (-slope).exp(), peak
    if mdf == "ward_half":
        return peak * (-2 * side / (1 + hz)).exp(), peak
    if mdf == "beckmann":
        return peak * (-slope).exp() / hz**4, peak
    return peak / (hz**4 * (1 + slope) ** 2), peak


def ask(mdf, form, lines):
    """Answers of `shade eval`, as texts."""
    command = [programs.SHADE, "eval", "--mdf", mdf, "--ex", str(EX), "--ey", str(EY), "--detail", "rotate",
               "--groove", "x", "--precision", form, "--what", "D"]
    done = subprocess.run(command, input=lines, capture_output=True, text=True, check=False)
    if done.returncode:
        raise report.StepFailed(f"{' '.join(command)}: {done.stderr}")
    return done.stdout.split()


def text(n, h):
    return "\n".join(" ".join(repr(float(c)) for c in row) for row in np.concatenate([n, h], -1))


def errors(mdf, count):
    def run(_folder, say):
        n, h = directions(count, 7), directions(count, 8)
        with decimal.localcontext(decimal.Context(prec=40)):
            want = []
            for k in range(count):
                if k % 100 == 0:
                    say(f"{100 * k // count} %")
                want.append(truth(mdf, n[k], h[k]))
            rows = []
            for form in FORMS:
                answers = ask(mdf, form, text(n, h))
                off = [abs(Decimal(a) / d - 1) for a, (d, peak) in zip(answers, want)
                       if d > PEAK_SHARE * peak]
                rows.append({"kind": "error", "distribution": mdf, "precision": form, "points": len(off),
                             "error": float(max(off)), "error_low": float(np.median([float(o) for o in off]))})
        return rows
    return run


def speed(mdf, runs):
    def run(_folder, say):
        rows = [row for row in fronts.bench(["--what", "D", "--mdf", mdf, "--set", "cache"], runs, say)
                if row["method"] == "rotate"]
        rows += [{**row, "precision": "reference"} for row in fronts.bench(["--what", "reference"], runs, say)
                 if row["distribution"] == mdf]
        return [{"kind": "speed", **row} for row in rows]
    return run


def tasks(quick):
    count, runs = (300, 5) if quick else (3000, 15)
    mdfs = ("ashikhmin_shirley", "ggx") if quick else MDFS
    bench = fronts.command(["--what", "D", "--set", "cache"])
    return ([Task(f"speed-{mdf}", 0.3 * runs, speed(mdf, runs), bench) for mdf in mdfs]
            + [Task(f"error-{mdf}", count * 1.5e-3, errors(mdf, count)) for mdf in mdfs])


def points(rows, mdf):
    found = []
    for form in FORMS:
        times = fronts.times(rows, kind="speed", distribution=mdf, precision=form)
        if times:
            e = fronts.one(rows, kind="error", distribution=mdf, precision=form)
            found.append(fronts.Point(form, times, e["error"], e["error_low"], e["error"]))
    return found


def mdfs_of(rows):
    return list(dict.fromkeys(r["distribution"] for r in rows))


def span(values, show=style.power):
    low, high = show(min(values)), show(max(values))
    return low if low == high else f"{low} to {high}"


def findings(rows):
    found = {mdf: {p.word: p for p in points(rows, mdf)} for mdf in mdfs_of(rows)}
    error = {form: [f[form].error for f in found.values() if form in f] for form in FORMS}
    ratio = [fronts.ratio(f["double"].times, f["float"].times)[0] for f in found.values()]
    slow = [fronts.ratio(f["reference"].times, f["double"].times)[0] for f in found.values()]
    return [
        Finding(f"Use float for pictures: its worst error is {span(error['float'], style.rounded)}, and double, "
                f"with {span(error['double'], style.rounded)}, takes {span(ratio, lambda v: f'{v:.1f}')} times "
                "as long.", max(error["float"]) < 1e-4 and max(error["double"]) < 1e-12 and min(ratio) > 1.2,
                "forms", timed=True),
        Finding("The reference that the tests trust is right to "
                f"{style.rounded(max(error['reference']))}, against 40 digits, and takes "
                f"{span(slow, lambda v: f'{v:.0f}')} times as long as double.",
                max(error["reference"]) < 1e-14 and min(slow) > 10, "forms", timed=True),
    ]


def figures(rows):
    panels = []
    for mdf in mdfs_of(rows):
        panel, axes = style.figure(360, 290)
        fronts.chart(axes, points(rows, mdf), style.of(mdf).label, "worst relative error")
        panels.append(style.svg(panel))
    return [Figure("forms", "Time against error of each precision",
                   "One core; bars: the middle half of the runs, and from the median to the worst error; dashed: "
                   "the Pareto front. `build/venv/bin/python compare/report_page.py --only precision`",
                   "\n".join(panels), "For each distribution a falling line from float, quick and right "
                   "to five digits, by double to the reference, slow and right to sixteen.")]


def tables(rows):
    lines = [[style.of(mdf).label, p.word, p.ns, "{:.3g} to {:.3g}".format(*p.bar), p.low, p.error]
             for mdf in mdfs_of(rows) for p in points(rows, mdf)]
    return [Table("numbers", "Precision forms", "D, detail `rotate`; relative errors against 40 digits.",
                  ["distribution", "precision", "ns", "middle half", "median error", "worst error"], lines)]
