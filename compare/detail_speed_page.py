# SPDX-License-Identifier: Apache-2.0
"""What study_speed.py's rows say: findings, charts, tables."""

import fronts
import style
from study import Figure, Finding, Table

TWINS = ("rotate_plain", "rotate_literal")  # rotate, otherwise written
FLOOR = 1e-4  # below it, nothing but rounding and quadrature
# method.md 2.4, to its three digits
PRINTED = {"none": (.568, .835, .929, .978), "perturb": (.390, .501, .513, .509),
           "deform_linear": (.153, .303, .448, .657), "deform_smooth": (.071, .149, .240, .409),
           "shortest_arc": (.006, .025, .059, .137), "gram_schmidt": (.013, .051, .115, .254),
           "rotate": (0, 0, 0, 0)}
PRINTED_TILTS = (10, 20, 30, 45)


def error(rows, method, tilt, mdf="ashikhmin_shirley"):
    return fronts.one(rows, kind="error", method=method, tilt=tilt, distribution=mdf)


def times(rows, method, mdf="ashikhmin_shirley", precision="float"):
    return fronts.times(rows, kind="speed", method=method, distribution=mdf, precision=precision)


def methods_of(rows):
    return list(dict.fromkeys(r["method"] for r in rows if r["kind"] == "error"))


def tilts_of(rows):
    return sorted({r["tilt"] for r in rows if r["kind"] == "error"})


def mdfs_of(rows):
    return list(dict.fromkeys(r["distribution"] for r in rows if r["kind"] == "error"))


def drawn(rows):
    """Methods of the charts: the conserving warps, slower and no nearer, stand in the table alone."""
    return [m for m in methods_of(rows) if not m.endswith("conserving")]


def points(rows, tilt, mdf="ashikhmin_shirley", others=(), shown=False):
    """Of all methods, or of those that are drawn; `others`: of TWINS, which have rotate's error."""
    found = []
    for method in drawn(rows) if shown else methods_of(rows):
        e = error(rows, method, tilt, mdf)
        found.append(fronts.Point(method, times(rows, method, mdf), e["error"], e["error_low"],
                                  e["error_high"]))
    e = error(rows, "rotate", tilt, mdf)["error"]
    return found + [fronts.Point(word, times(rows, word, mdf), e) for word in others if times(rows, word, mdf)]


def agrees(rows):
    """Largest difference from the printed table, and whether the ranking is the same at each tilt."""
    worst, same = 0.0, True
    for column, tilt in enumerate(PRINTED_TILTS):
        found = {m: error(rows, m, tilt)["error"] for m in PRINTED}
        worst = max(worst, *(abs(found[m] - PRINTED[m][column]) for m in PRINTED))
        same &= sorted(PRINTED, key=found.get) == sorted(PRINTED, key=lambda m: PRINTED[m][column])
    return worst, same


def tables(rows):
    lines, ts = [], tilts_of(rows)
    for mdf in mdfs_of(rows):
        made = points(rows, 30, mdf, TWINS)
        for p in made:
            middle, low, high = fronts.ratio(p.times, times(rows, "perturb", mdf))
            lines.append([style.of(mdf).label, style.of(p.word).label,
                          *(error(rows, "rotate" if p.word in TWINS else p.word, t, mdf)["error"] for t in ts), p.ns, middle,
                          f"{low:.2f} to {high:.2f}"])
    return [Table("errors", "Error and time of every method",
                  "Total variation against the displaced surface, mean over azimuths, by tilt; time in float; its "
                  "ratio to that of perturb in the same runs, median and middle half.",
                  ["distribution", "method", *(f"{t}°" for t in ts), "ns", "ratio", "middle half"],
                  lines)]


def span(values, form):
    low, high = f"{min(values):{form}}", f"{max(values):{form}}"
    return low if low == high else f"{low} to {high}"


def findings(rows):
    ts, mdfs = tilts_of(rows), mdfs_of(rows)
    worst = max(error(rows, "rotate", t, mdf)["error_most"] for t in ts for mdf in mdfs)
    low, steep = ts[0], 45

    def e(method, tilt):
        return error(rows, method, tilt)["error"]

    def ratio(method, other):
        return fronts.ratio(times(rows, method), times(rows, other))[0]

    def against(method, other, name):
        """In words, what a method costs beside another."""
        a, b = (fronts.Point(m, times(rows, m), 0.0) for m in (method, other))
        much = "the time" if fronts.as_fast(a, b) else f"{ratio(method, other):.2f} times the time"
        return f"{much} of {name}" + (" (a tie)" if fronts.as_fast(a, b) else "")

    fronts_of = {t: [p.word for p in fronts.front(points(rows, t), FLOOR)] for t in ts}
    tied = {m for t in ts for p in fronts.front(points(rows, t), FLOOR) if p.word == "rotate" for m in p.also}
    always = [m for m in methods_of(rows) if all(m in front for front in fronts_of.values())]
    named = fronts.named([m for m in always if m not in tied])
    rough = {mdf: error(rows, "rotate_approximate", 30, mdf)["error"] for mdf in mdfs}
    others = [m for m in mdfs if m != "ashikhmin_shirley"]
    saved = {m: fronts.ratio(times(rows, "rotate_approximate", m), times(rows, "rotate", m))[0] for m in others}
    off, same = agrees(rows)
    warps = ("deform_linear", "deform_smooth")
    return [
        Finding(f"`rotate` follows the displaced surface exactly: at every tilt to {ts[-1]}° and for "
                f"{len(mdfs)} distributions its total variation stays below {style.power(10 * worst)}. "
                "Use it wherever a lobe is longer than wide.", worst < 1e-9, "tilts"),
        Finding("Being exact costs next to nothing: `rotate` takes "
                f"{against('rotate', 'gram_schmidt', 'Gram-Schmidt')} and "
                f"{against('rotate', 'perturb', 'plain `perturb`')}.",
                ratio("rotate", "perturb") < 1.5 and e("rotate", steep) < 1e-9,
                "fronts", timed=True),
        Finding(f"Gram-Schmidt, which most renderers use, is off by {e('gram_schmidt', low):.3f} at {low}° and "
                f"{e('gram_schmidt', steep):.2f} at {steep}°; `perturb`, the papers' simple normal mapping, by "
                f"{e('perturb', low):.2f} and {e('perturb', steep):.2f}.",
                0 < e("gram_schmidt", low) < e("perturb", low)
                and e("gram_schmidt", low) < e("gram_schmidt", steep) < e("perturb", steep), "tilts"),
        Finding("Deformation, which the papers offer for speed, is neither quicker nor nearer than rotation: at "
                f"30° the linear warp is off by {e('deform_linear', 30):.2f} in "
                f"{against('deform_linear', 'rotate', '`rotate`')}, the smooth one by "
                f"{e('deform_smooth', 30):.2f} in {ratio('deform_smooth', 'rotate'):.2f} times.",
                all(e(w, t) > 10 * max(e("rotate", t), FLOOR) for w in warps for t in ts)
                and all(ratio(w, "rotate") > 1 for w in warps), "fronts", timed=True),
        Finding("The papers' approximate rotation is worth little: for Ashikhmin-Shirley it is the exact one, in "
                f"{against('rotate_approximate', 'rotate', 'that')}; for {fronts.named(others)} it saves "
                f"{span([100 * (1 - s) for s in saved.values()], '.0f')} % of the time and is off by "
                f"{span([rough[m] for m in others], '.2f')} at 30°.",
                rough["ashikhmin_shirley"] < 1e-9 and min(rough[m] for m in others) > 0.02
                and 0.5 < min(saved.values()), "mdfs", timed=True),
        Finding("As printed, with arc tangents, powf and normalised axes, rotation takes "
                f"{ratio('rotate_literal', 'rotate'):.0f} times as long (the papers: 54 µs exact, 11 µs approximate). "
                "In plain C (`-O2`, libm, a sample after the other) the library's own formula takes "
                f"{span([fronts.ratio(times(rows, 'rotate_plain', m), times(rows, 'rotate', m))[0] for m in mdfs], '.1f')} "
                "times as long as its vectorised form.",
                ratio("rotate_literal", "rotate") > ratio("rotate_plain", "rotate") > 1.5, "choice", timed=True),
        Finding(f"At every tilt the front of speed against accuracy holds {named}"
                + (f"; {' and '.join(f'`{m}`' for m in sorted(tied))} ties with `rotate`." if tied else "."),
                "rotate" in always and not any(m.startswith("deform") for m in always), "fronts", timed=True),
        Finding("This quadrature ranks the methods as the table of the method's notes does at "
                f"{', '.join(f'{t}°' for t in PRINTED_TILTS)}, and differs from it by {off:.4f} at most; the "
                "table has three digits.", same and off < 0.0025, "errors"),
    ]


ERROR = "total variation"
COMMAND = "`build/venv/bin/python compare/report_page.py --only speed`"


def figures(rows):
    ts, mdfs = tilts_of(rows), mdfs_of(rows)
    lines, axes = style.figure(360, 290)
    shown = [m for m in drawn(rows) if m != "rotate_approximate"]
    for m in shown:
        axes.plot(ts, [max(error(rows, m, t)["error"], FLOOR) for t in ts], **style.of(m).line)
    axes.set_yscale("log")
    most = max((error(rows, m, t)["error"], m, t) for m in shown for t in ts)
    axes.set_ylim(FLOOR / 1.4, 1.3 * max(most[0], 1))
    axes.set_xlim(ts[0] - 2, ts[-1] + 30)
    axes.set_xticks(ts, [f"{t}°" for t in ts])
    axes.set_xlabel("tilt of the normal")
    axes.set_ylabel(ERROR)
    style.log_ticks(axes.yaxis)
    style.ends(axes, [(ts[-1], max(error(rows, m, ts[-1])["error"], FLOOR), m) for m in shown])
    first = []
    for mdf in [m for m in ("ashikhmin_shirley", "ggx") if m in mdfs]:
        panel, on = style.figure(360, 290)
        fronts.chart(on, points(rows, 30, mdf, ("rotate_plain",), shown=True), f"{style.of(mdf).label}, 30°", ERROR, FLOOR)
        first.append(style.svg(panel))
    panels = []
    for tilt in ts:
        panel, on = style.figure(360, 290)
        fronts.chart(on, points(rows, tilt, shown=True), f"{tilt}° of tilt", ERROR, FLOOR)
        panels.append(style.svg(panel))
    others = []
    for mdf in mdfs:
        panel, on = style.figure(360, 290)
        fronts.chart(on, points(rows, 30, mdf, shown=True), f"{style.of(mdf).label}, 30°", ERROR, FLOOR)
        others.append(style.svg(panel))
    told = ("Bars: the middle half of the runs, and of the azimuths; dashed: the Pareto front, which nothing "
            f"to its left is below. What is below {style.power(FLOOR)} stands on the bottom: nothing but "
            f"rounding. A method that ties with another in both has no label of its own; the conserving warps are in the table. "
            + COMMAND)
    return [
        Figure("choice", "Speed against accuracy of the detail methods",
               "Time of D in float and the share of the highlight that lies elsewhere than on a displaced surface, the normal "
               "tilted by 30°. Below and left is better. Plain C: the same formula without vectors, `-O2` and libm. "
               + COMMAND, "\n".join(first), "Two charts of time against error. rotate is at the bottom and as quick as others; "
               "in plain C it is as exact and several times slower."),
        Figure("tilts", "Only rotation keeps to the displaced surface",
               "Total variation between a method's distribution and the displaced surface's, "
               "Ashikhmin-Shirley (200, 10), mean over azimuths; `rotate` stands on the bottom. "
               + (f"Above 1, as of {style.of(most[1]).label} at {most[2]}°, it makes light. " if most[0] > 1 else "") + COMMAND,
               style.svg(lines), "Lines of error against tilt, logarithmic. All rise with the tilt but rotate, "
               "which stays at the bottom; none and perturb are worst."),
        Figure("fronts", "Time against error, at each tilt", f"Ashikhmin-Shirley (200, 10). {told}",
               "\n".join(panels), "A chart for each tilt of time against error. rotate is at the bottom at "
               "little more time than perturb and none, which are far less exact; warps are slower and worse."),
        Figure("mdfs", "Time against error, by distribution", f"The matching roughness. {told}",
               "\n".join(others), "A chart for each distribution at 30 degrees. For all but Ashikhmin-Shirley "
               "the approximate rotation is no longer exact."),
    ]
