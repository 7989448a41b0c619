# SPDX-License-Identifier: Apache-2.0
"""Forms of cloth from afar: what each costs, and how far it is from the mean of what the cloth is near."""
import time

import numpy as np

import fabric
import fronts
import programs  # noqa: F401  (finds the module)
import shade
import style
from study import Figure, Finding, Table, Task

NAME = "cloth"
TITLE = "Cloth from afar"
INTRO = ("From afar a pixel holds many yarns. The far form shades a mixture of lobes read from tables, the single form one "
         "lobe for each direction of yarn. The truth is the mean of the near form, thread by thread, over points spread "
         "evenly over thousands of crossings, for 20 pairs of light and eye. The error is the mean one over the pairs. "
         "Times are for a whole sample in float, called from Python over arrays, a bar over all cloths.")
FORMS = ("near", "far", "single")
BATCH = 1 << 15
QUICK = ("denim", "silk_charmeuse", "linen")


def cloths():
    return [name for name, p in shade.presets().items() if p.kind == "fabric"]


def measure(name, points, runs):
    def run(_folder, say):
        cloth, rows = shade.fabric(name), []
        uv, here = fabric.spread(points, 4096), np.zeros((1, 2))
        off, noise = {form: [] for form in FORMS[1:]}, []
        pairs = [(fabric.direction(*light), fabric.direction(*eye)) for light in fabric.LIGHTS for eye in fabric.EYES]
        for number, (wi, wo) in enumerate(pairs):
            say(f"{100 * number // len(pairs)} %")
            near = np.array(cloth.eval(uv, wi, wo, tier="near"))
            true = near.mean(0)
            for form in off:
                got = np.array(cloth.eval(here, wi, wo, footprint=1e6, tier=form))[0]
                off[form].append(float(np.abs(got / true - 1).max()))
            noise.append(float((near.std(0) / np.sqrt(points) / true).max()))
        for form in off:
            low, high = np.percentile(off[form], [25, 75])
            rows.append({"kind": "error", "cloth": name, "method": form, "error": float(np.mean(off[form])),
                         "error_low": float(low), "error_high": float(high), "worst": max(off[form]),
                         "noise": max(noise)})
        random = np.random.default_rng(1)
        many = (64 * random.random((BATCH, 2))).astype(np.float32)
        wi, wo = (within(random) for _ in range(2))
        for number in range(runs):
            say(f"run {number + 1} of {runs}")
            best = dict.fromkeys(FORMS, 1e30)
            for _round in range(10):
                for form in FORMS:  # by turns
                    size = np.float32(0 if form == "near" else 20)
                    begun = time.perf_counter()
                    cloth.eval(many, wi, wo, footprint=size, tier=form)
                    best[form] = min(best[form], time.perf_counter() - begun)
            rows += [{"kind": "speed", "cloth": name, "method": form, "precision": "float", "isa": shade.isa(),
                      "run": number, "ns": 1e9 * best[form] / BATCH} for form in FORMS]
        return rows
    return run


def within(random):
    theta, phi = random.random(BATCH) * np.pi / 3, random.random(BATCH) * 2 * np.pi
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1).astype(np.float32)


def tasks(quick):
    names, points, runs = (QUICK, 8192, 5) if quick else (cloths(), 65536, 11)
    return [Task(name, 0.8 if quick else 5, measure(name, points, runs),
                 f"build/venv/bin/python compare/fabric.py {name}") for name in names]


def names_of(rows):
    return list(dict.fromkeys(r["cloth"] for r in rows))


def point(rows, name, form):
    e = fronts.one(rows, kind="error", cloth=name, method=form)
    return fronts.Point(form, fronts.times(rows, kind="speed", cloth=name, method=form), e["error"],
                        min(e["error_low"], e["error"]), max(e["error_high"], e["error"]))


def findings(rows):
    names = names_of(rows)
    worst = {form: max(point(rows, n, form).error for n in names) for form in FORMS[1:]}
    least = min(point(rows, n, "single").error for n in names)
    cost = [fronts.ratio(*(fronts.times(rows, kind="speed", cloth=n, method=m) for m in ("single", "far")))[0]
            for n in names]
    near = [fronts.ratio(*(fronts.times(rows, kind="speed", cloth=n, method=m) for m in ("far", "near")))[0]
            for n in names]
    return [
        Finding(f"The far form is within {100 * worst['far']:.1f} % of the mean of near for each of {len(names)} "
                f"cloths, and a sample of it takes {min(near):.1f} to {max(near):.1f} times as long as one of near, of "
                "which a pixel would need thousands.", worst["far"] < 0.02, "front"),
        Finding(f"One lobe a yarn, the papers' alternating exponents seen from afar, is {100 * least:.0f} to "
                f"{100 * worst['single']:.0f} % off and takes {min(cost):.1f} to {max(cost):.1f} times as long: "
                + ("quicker, and for backgrounds only." if max(cost) < 1 else "nothing speaks for it but its few tables."),
                least > worst["far"] and worst["single"] > 5 * worst["far"], "front"),
    ]


def figures(rows):
    panel, axes = style.figure(360, 290)
    axes.set_xscale("log")
    axes.set_yscale("log")
    for form in FORMS[1:]:
        each = [point(rows, n, form) for n in names_of(rows)]
        for p in each:
            axes.errorbar(p.ns, p.error, xerr=[[p.ns - p.bar[0]], [p.bar[1] - p.ns]],
                          yerr=[[p.error - p.low], [p.high - p.error]], zorder=3, **style.of(form).bars)
    near = float(np.median([np.median(fronts.times(rows, kind="speed", cloth=n, method="near"))
                            for n in names_of(rows)]))
    axes.axvline(near, color=style.SOFT, linewidth=1, dashes=(3, 2), zorder=1)
    style.log_ticks(axes.xaxis)
    style.log_ticks(axes.yaxis)
    axes.annotate("a sample of near", (near, axes.get_ylim()[0]), xytext=(4, 6), textcoords="offset points",
                  fontsize=11, color=style.SOFT)
    axes.set_xlabel("ns a sample, one core")
    axes.set_ylabel("mean error of the colour")
    style.labels(axes, [(np.median([point(rows, n, f).ns for n in names_of(rows)]),
                         max(point(rows, n, f).error for n in names_of(rows)), f) for f in FORMS[1:]])
    return [Figure("front", "Time against error of each form, a point for each cloth",
                   "Bars: the middle half of the runs, and of the pairs of light and eye. "
                   "`build/venv/bin/python compare/report_page.py --only cloth`", style.svg(panel),
                   "Time against error: far points lie low, at about a hundredth; those of one lobe to the left "
                   "of them, ten times as high and more.")]


def tables(rows):
    lines = []
    for n in names_of(rows):
        for form in FORMS[1:]:
            p, e = point(rows, n, form), fronts.one(rows, kind="error", cloth=n, method=form)
            lines.append([n.replace("_", " "), style.of(form).label, 100 * p.error, 100 * e["worst"],
                          100 * e["noise"], p.ns, "{:.0f} to {:.0f}".format(*p.bar)])
    return [Table("numbers", "Cloth from afar against the mean of near",
                  "The worst channel; noise is the standard error of the truth.",
                  ["cloth", "form", "off, %", "worst pair, %", "noise, %", "ns", "middle half"], lines)]
