# SPDX-License-Identifier: Apache-2.0
"""Choices of horizon: what each costs, and how far bumps as normals are from displaced bumps.

The truth is that of horizon.py: build/horizon ray-casts two height fields, with shadows and hidden parts.
"""
import fronts
import horizon
import programs
import report
import style
from study import Figure, Finding, Table, Task

NAME = "horizons"
TITLE = "Horizons: what happens where a bump turns away"
INTRO = ("Where a bump turns its normal away from light or eye, a shading rule must say what is seen. The truth is a "
         "displaced surface, ray-cast with its shadows and hidden parts, lit and seen from 80° down to 5° of "
         "elevation. The error is that of the patch's brightness as a whole, over the mean of the truth; point by "
         "point most of it is parallax, which no rule mends. Times are those of the whole BRDF in float with "
         "detail `rotate`.")
MDFS = {"ashikhmin_shirley": "Ashikhmin-Shirley", "ggx": "GGX"}
CHOICES = ("hard", "valid_reflection", "estevez", "chiang", "schuessler", "valid_estevez")


def cast(count, azimuths):
    def run(folder, say):
        program, path = programs.BUILD / "horizon", folder / "horizon.csv"
        if not program.is_file():
            raise report.StepFailed(f"{program}: no such file; run make build/horizon")
        say("casting rays")
        options = horizon.arguments(["--points", str(count), "--azimuths", str(azimuths), "--output", str(folder)])
        found = horizon.measure(options)
        path.unlink()
        rows = []
        for material in MDFS:
            for choice in CHOICES:
                mine = horizon.pick(found, material=material, horizon=choice)
                for light in sorted({r["light"] for r in mine}):
                    here = horizon.pick(mine, light=light)
                    rows.append({"kind": "error", "distribution": material, "method": choice, "light": light,
                                 "truth": sum(r["truth"] for r in here),
                                 "error": sum(abs(r["mean"] - r["truth"]) for r in here),
                                 "picture": sum(r["image"] for r in here)})
        return rows
    return run


def speed(mdf, runs):
    def run(_folder, say):
        rows = []
        for choice in CHOICES:
            what = "f" if choice == "hard" else f"f_{choice}"
            found = fronts.bench(["--what", what, "--mdf", mdf, "--set", "cache"], runs, say)
            rows += [{"kind": "speed", **row, "method": choice} for row in found
                     if row["method"] == "rotate" and row["precision"] == "float"]
        return rows
    return run


def tasks(quick):
    runs, count, azimuths = (5, 16, 5) if quick else (15, 64, 5)
    return [*(Task(f"speed-{mdf}", 0.55 * runs, speed(mdf, runs),
                   fronts.command(["--what", "f_estevez", "--mdf", mdf.replace("_", "-"), "--set", "cache"]))
              for mdf in MDFS),
            Task("cast", 8 if quick else 90, cast(count, azimuths), "build/venv/bin/python compare/horizon.py",
                 (programs.BUILD / "horizon",))]


def share(rows, mdf, choice, most=90.0):
    mine = [r for r in fronts.pick(rows, kind="error", distribution=mdf, method=choice) if r["light"] <= most]
    return sum(r["error"] for r in mine) / sum(r["truth"] for r in mine)


def points(rows, mdf):
    found = []
    for choice in CHOICES:
        each = sorted(r["error"] / r["truth"]
                      for r in fronts.pick(rows, kind="error", distribution=mdf, method=choice))
        low, high = each[len(each) // 4], each[-1 - len(each) // 4]
        e = share(rows, mdf, choice)
        found.append(fronts.Point(choice, fronts.times(rows, kind="speed", method=choice, distribution=mdf), e,
                                  min(low, e), max(high, e)))
    return found


def findings(rows):
    ours = {mdf: share(rows, mdf, "valid_estevez") for mdf in MDFS}
    hard = {mdf: share(rows, mdf, "hard") for mdf in MDFS}
    ratio = {mdf: fronts.ratio(*(fronts.times(rows, kind="speed", distribution=mdf, method=c)
                                 for c in ("valid_estevez", "hard")))[0] for mdf in MDFS}
    low = {c: {mdf: share(rows, mdf, c, 15.0) for mdf in MDFS} for c in ("hard", "valid_estevez")}
    best = {mdf: min(CHOICES, key=lambda c: share(rows, mdf, c)) for mdf in MDFS}

    def both(values, form=".3f"):
        return " and ".join(f"{values[mdf]:{form}}" for mdf in MDFS)

    return [
        Finding("Over all elevations `valid_estevez`, where both renderers start, is nearest to a displaced "
                f"patch's brightness: {both(ours)} off (Ashikhmin-Shirley, GGX) where `hard` is {both(hard)} "
                f"off, at {both(ratio, '.1f')} times the time.",
                all(best[m] == "valid_estevez" for m in MDFS) and all(ours[m] < hard[m] for m in MDFS), "fronts"),
        Finding(f"It matters where light grazes: below 15° `hard` is {both(low['hard'])} off, `valid_estevez` "
                f"{both(low['valid_estevez'])}. `schuessler` costs most and errs most, but is reciprocal.",
                all(low["valid_estevez"][m] < 0.8 * low["hard"][m] for m in MDFS)
                and all(max(CHOICES, key=lambda c: share(rows, m, c)) == "schuessler" for m in MDFS)
                and all(max(points(rows, m), key=lambda p: p.ns).word == "schuessler" for m in MDFS), "numbers",
                timed=True),
    ]


def figures(rows):
    panels = []
    for mdf, label in MDFS.items():
        panel, axes = style.figure(360, 290)
        fronts.chart(axes, points(rows, mdf), label, "error of the brightness")
        panels.append(style.svg(panel))
    return [Figure("fronts", "Time against error of each horizon",
                   "Bars: the middle half of the runs, and of the lights' elevations; dashed: the Pareto front. "
                   "`build/venv/bin/python compare/report_page.py --only horizons`", "\n".join(panels),
                   "Two charts of time against error, one for each material, with six horizons.")]


def tables(rows):
    lines = []
    for mdf, label in MDFS.items():
        for p in points(rows, mdf):
            mine = fronts.pick(rows, kind="error", distribution=mdf, method=p.word)
            lines.append([label, style.of(p.word).label, p.error, share(rows, mdf, p.word, 15.0),
                          sum(r["picture"] for r in mine) / sum(r["truth"] for r in mine), p.ns,
                          "{:.3g} to {:.3g}".format(*p.bar)])
    return [Table("numbers", "Horizons", "Errors over the mean of the truth, all elevations of the eye.",
                  ["material", "horizon", "brightness", "light below 15°", "picture", "ns", "middle half"],
                  lines)]
