# SPDX-License-Identifier: Apache-2.0
"""Truth by displacement: each detail method beside a surface that is really displaced (study.py)."""
import json
import shutil

import numpy as np

import displacement
import fabric
import gallery
import gallery_cloth
import pictures
import programs
import report
import sheet
import style
from displacement import GROOVED, ROUND
from gallery import pick, variation
from sheet import percent
from study import Figure, Finding, Table, Task

NAME, TITLE = "truth", "Beside displaced geometry"
INTRO = (
    "How much of a bumped metal's picture does a normal map get right? Plates, cylinders and spheres are really "
    "displaced, by waves or by scratches whose steepest slope is between 0.1 and 1.2, and ray-cast from the formulas "
    "of their heights: no mesh, no map. A facet is shaded by its own lobe, its grooves along the surface's own "
    "derivative. Beside it stands the smooth base with the same bumps as normals, by every detail method. The error "
    "is the mean absolute difference over the mean of the truth: as the eye sees it, and at the very points that it "
    "sees of the displaced surface, which leaves out that a normal map has no height. Light is reflected once. Then "
    "the figures of the four papers that libshade began with, made anew.")

SHOWN = ("none", "perturb", "deform_linear", "deform_smooth", "gram_schmidt", "shortest_arc")
# Total variation, exponents (200, 10), as it was found by other code before libshade was written.
# {method: at 10, 20, 30, 45 degrees}
DESIGN = {"none": (0.568, 0.835, 0.929, 0.978), "perturb": (0.390, 0.501, 0.513, 0.509),
          "deform_linear": (0.153, 0.303, 0.448, 0.657), "deform_smooth": (0.071, 0.149, 0.240, 0.409),
          "shortest_arc": (0.006, 0.025, 0.059, 0.137), "gram_schmidt": (0.013, 0.051, 0.115, 0.254),
          "rotate": (0.0, 0.0, 0.0, 0.0)}
TILTS = (10.0, 20.0, 30.0, 45.0)
MADE = "Made by `compare/report_page.py --only truth`."
RENDERED = {"waves": [], "scratches": ["--surface", "scratches"]}
STEEP, STEEP_AT = ("noise", "ridges", "letter"), ("--size", "96", "--samples", "24", "--quads", "400")
# Of truth.py's jobs under one sky: what is shown, and its label.
STEEP_SHOWN = {"displaced": "displaced", "valid_estevez": "before: valid_estevez", "mutual": "now: mutual", "Cycles' normal map": "Cycles"}


# ---- the work ------------------------------------------------------------------------------------


def surfaces(base, bumps, slopes, materials, size):
    def run(folder, say):
        rows = []
        for material in materials:
            for slope in slopes:
                say(f"slope {slope:g}")
                rows += displacement.pictures(folder, base, bumps, slope, material, size=size)[0]
        return rows
    return run


def lobes(materials, azimuths):
    def run(folder, say):
        return [row for material in materials for tilt in TILTS
                for row in displacement.lobes(folder, tilt, material, azimuths=azimuths)]
    return run


def cloths(names, points):
    def run(folder, say):
        rows = []
        for name in names or fabric.cloths():
            say(name)
            one = fabric.Cloth(name)
            far, single, doubt = fabric.colours(one, points)
            rows.append({"kind": "cloth", "cloth": name, "colour_far": float(far), "colour_single": float(single),
                         "standard_error": float(doubt)})
        return rows
    return run


def rendered(surface):
    """The meshes of truth.py, by Cycles and by our engine."""
    def run(folder, say):
        say("rendering")
        report.step(f"truth.py, {surface}", [
            str(programs.BUILD / "venv" / "bin" / "python"), str(programs.HERE / "truth.py"), *RENDERED[surface],
            "--size", "256", "--samples", "128", "--output", str(folder / "out")], folder / "log", allowed=(0, 1))
        found = json.loads((folder / "out" / "truth.json").read_text(encoding="utf-8"))
        shutil.rmtree(folder / "out")
        return [{"kind": "rendered", "surface": surface, "method": name, "error": value,
                 "compared": found["compared"]} for name, value in found["errors"].items()]
    return run


def steep(surface):
    """Steep bumps under skies, by truth.py; pictures of its first sky."""
    def run(folder, say):
        say("rendering")
        out = folder / "out"
        report.step(f"truth.py, {surface}", [
            str(programs.BUILD / "venv" / "bin" / "python"), str(programs.HERE / "truth.py"), "--surface", surface,
            *STEEP_AT, "--output", str(out)], folder / "log", allowed=(0, 1))
        found = json.loads((out / "truth.json").read_text(encoding="utf-8"))
        jobs = json.loads((out / "jobs.json").read_text(encoding="utf-8"))["jobs"]
        seen, first = {}, next(iter(found["skies"]))
        for job in jobs:
            name = job["horizon"].lower() if "horizon" in job else "displaced" if job["surface"] == "displaced" else CYCLES
            if job["sky"] == jobs[0]["sky"]:
                seen.setdefault(name, pictures.read(job["output"]))
        white = 2.5 * float(seen["displaced"].mean())
        tiles = sheet.tiles(folder, f"steep-{surface}", [
            (f"{surface}|{label}", sheet.grey(seen[name], white),
             *(("error {}", found["skies"][first][name]) if name != "displaced" else ())) for name, label in STEEP_SHOWN.items()])
        shutil.rmtree(out)
        return [*({"kind": "steep", "surface": surface, "sky": sky, "method": name, "error": value}
                  for sky, one in found["skies"].items() for name, value in one.items()), *tiles]
    return run


def tasks(quick):
    slopes = (0.2, 0.6, 1.2) if quick else (0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.2)
    materials = (GROOVED, ROUND) if quick else tuple(displacement.MATERIALS)
    size, tile = (48, 72) if quick else (160, 168)
    needs, word = (displacement.PROGRAM,), "quick" if quick else "full"
    command = f"compare/report_page.py {'--quick ' if quick else ''}--only truth"
    work = [Task(f"{base}-{bumps}", 1 if quick else 25, surfaces(base, bumps, slopes, materials, size),
                 f"{command}  # or build/displaced pictures OUT.csv --base {base} --bumps {bumps} --slope S", needs)
            for base in displacement.BASES for bumps in displacement.BUMPS]
    work.append(Task("lobes", 2 if quick else 12, lobes((GROOVED, ROUND) if quick else materials, 19 if quick else 91),
                     "build/displaced lobes OUT.csv --tilt DEGREES", needs))
    work.append(Task("cloth", 2 if quick else 40, cloths(("denim", "silk_charmeuse") if quick else (),
                                                       4096 if quick else 65536), "compare/fabric.py"))
    work.append(Task("fibres", 1, lambda folder, say: gallery_cloth.diffuse_rows(300 if quick else 2000), command))
    for paper, key in ((gallery.ROTATION, "rotation"), (gallery.DEFORMING, "deforming"),
                       (gallery.FABRIC, "fabric"), (gallery.DIFFUSE, "diffuse")):
        entries = [entry for entry in gallery.ENTRIES if entry.paper == paper]
        work.append(Task(f"gallery-{key}-{word}", 2 if quick else 15,
                         lambda folder, say, of=entries: gallery.make(of, folder, tile, say), command, needs))
    if not quick:
        work += [Task(f"rendered-{surface}", 90, rendered(surface),
                      " ".join(["compare/truth.py", *options, "--size 256 --samples 128"]))
                 for surface, options in RENDERED.items()]
        work += [Task(f"steep-{surface}", 60, steep(surface), f"compare/truth.py --surface {surface} {' '.join(STEEP_AT)}")
                 for surface in STEEP]
    return work


# ---- what was found --------------------------------------------------------------------------------


def of(rows, **wanted):
    return pick(rows, kind="picture", **wanted)


def span(rows, key="error_point"):
    values = [row[key] for row in rows]
    return (min(values), max(values)) if values else (float("nan"), float("nan"))


def finding_rotate(rows):
    exact = span(of(rows, material=GROOVED, method="rotate"))
    plate = span(of(rows, material=GROOVED, base="plate", method="rotate"), "error")
    others = {m: span(of(rows, material=GROOVED, method=m))[0] for m in SHOWN}
    nearest = min(others, key=others.get)
    return Finding(
        f"Rotation follows displaced grooves at every slope, on every surface: at the points seen it is off by "
        f"{percent(exact[1])} at most, and on the plate the whole picture by {percent(plate[1])}. The nearest other "
        f"method ({style.of(nearest).label}) is off by {percent(others[nearest])} or more.",
        exact[1] <= 1e-3 and plate[1] <= 1e-9 and 3 * exact[1] < others[nearest], "curves-waves")


def finding_normal_map(rows):
    mine = of(rows, material=GROOVED, base="plate", bumps="waves")
    slopes = sorted({row["slope"] for row in mine})
    low, high = span(pick(mine, method="perturb"), "error")
    first, last = (pick(mine, method="gram_schmidt", slope=s)[0]["error"] for s in (slopes[0], slopes[-1]))
    return Finding(
        f"Plain normal mapping loses an anisotropic highlight at once: between slopes {slopes[0]:g} and {slopes[-1]:g} it "
        f"is off by {percent(low)} to {percent(high)} on waves. Turning the tangent by Gram-Schmidt, as most renderers do, "
        f"is off by {percent(first)} at {slopes[0]:g} and by {percent(last)} at {slopes[-1]:g}: it fails where it is steep.",
        low > 0.1 and first < last < low, "curves-waves")


def finding_deform(rows):
    ahead = [(row, of(rows, **{k: row[k] for k in ("material", "base", "bumps", "slope")}, method="deform_linear")[0])
             for row in of(rows, material=GROOVED, method="deform_smooth")]
    steep = max(row["slope"] for row in of(rows))
    least = min(linear["error_point"] / smooth["error_point"] for smooth, linear in ahead)
    at = {m: span(of(rows, material=GROOVED, method=m, slope=steep)) for m in ("deform_smooth", "rotate")}
    return Finding(
        f"Of the two deformations the smooth one is always nearer, by {least:.1f} times or more, and still off by "
        f"{percent(at['deform_smooth'][0])} to {percent(at['deform_smooth'][1])} at slope {steep:g}.",
        least > 1 and at["deform_smooth"][0] > 10 * at["rotate"][1], "curves-waves")


def finding_round(rows):
    turned = ("perturb", "gram_schmidt", "shortest_arc", "rotate")
    best = max(span(of(rows, material=ROUND, method=m))[1] for m in turned)
    smooth = span(of(rows, material=ROUND, method="deform_smooth"))
    return Finding(
        f"A round lobe needs none of this: normal map, Gram-Schmidt, shortest arc and rotation agree with the displaced "
        f"surface within {percent(best)}. Only the deformations spoil it, by up to {percent(smooth[1])} (smooth).",
        best <= 2e-3 and smooth[1] > 20 * best, "errors")


def finding_approximate(rows):
    same = max(abs(a["error_point"] - b["error_point"]) for a in of(rows, method="rotate_approximate")
               for b in of(rows, method="rotate", **{k: a[k] for k in ("material", "base", "bumps", "slope")})
               if a["distribution"] == "ashikhmin_shirley")
    text = (f"The approximate rotation is the exact one for Ashikhmin-Shirley (the errors are the same to "
            f"{max(same, 1e-16):.0e})")
    others = [row for row in of(rows, method="rotate_approximate") if row["distribution"] != "ashikhmin_shirley"]
    if not others:
        return Finding(text + ".", same <= 1e-9, "errors")
    worst = max(others, key=lambda row: row["error_point"])
    return Finding(f"{text}; for {worst['material']} it is off by up to {percent(worst['error_point'])}, at slope "
                   f"{worst['slope']:g}.", same <= 1e-9 and worst["error_point"] > 0.02, "errors")


def finding_parallax(rows):
    curved = [row for row in of(rows, material=GROOVED, method="rotate", bumps="waves") if row["base"] != "plate"]
    low, high = span(curved, "error")
    return Finding(
        f"On curved bases what is left of rotation's error as seen, {percent(low)} to {percent(high)} under waves, is "
        f"that a normal map has no height (of the lobe itself {percent(span(curved)[1])} at most): no choice of lobe "
        "mends it.", span(curved)[1] < 0.1 * low, "seen")


def finding_design(rows):
    off = {(m, t): abs(variation(rows, m, t) - value) for m, values in DESIGN.items() for t, value in zip(TILTS, values)}
    worst = max(off, key=off.get)
    ranks = all(sorted(DESIGN, key=lambda m: variation(rows, m, t)) ==
                sorted(DESIGN, key=lambda m: DESIGN[m][k]) for k, t in enumerate(TILTS))
    return Finding(
        f"The ranking by which libshade's methods were chosen is found again by a program of its own, at all of "
        f"{', '.join(f'{t:g}°' for t in TILTS)}, and its {len(off)} figures within one of their last digit (largest "
        f"difference {off[worst]:.4f}, {style.of(worst[0]).label} at {worst[1]:g}°).",
        ranks and off[worst] <= 0.001, "lobes")


def finding_fibres(rows):
    at = {row["method"]: row for row in pick(rows, kind="diffuse", elevation=90)}
    error = {m: row["error"] for m, row in at.items()}
    return Finding(
        f"Of matt fibres side by side, seen from above, the maximum normal is off by {percent(error['max_normal'])}, Hast's "
        f"integral by {percent(error['fibre'])} (as printed {percent(error['fibre_printed'])}), plain Lambert by "
        f"{percent(error['lambert'])}: the integral needs the weight of the view, with which {percent(error['fibre_view'])} "
        "is left.",
        error["fibre_view"] < 0.7 * error["fibre"] and error["fibre"] < error["fibre_printed"] < error["max_normal"]
        and error["fibre"] < error["lambert"], "fibres")


def finding_cloth(rows):
    found = pick(rows, kind="cloth")
    far, single = max(r["colour_far"] for r in found), max(r["colour_single"] for r in found)
    return Finding(
        f"Cloth from afar has the mean colour of what it is near within {percent(far)} (worst of {len(found)} cloths, 20 "
        f"pairs of light and eye, any channel); by one lobe a direction of yarn within {percent(single)}.",
        far < single and far <= 0.02 + 3 * max(r["standard_error"] for r in found), "cloth")


def finding_rendered(rows):
    found = {s: {r["method"]: r["error"] for r in pick(rows, kind="rendered", surface=s)} for s in RENDERED}
    others = {s: min(v for m, v in one.items() if m in ("none", "perturb", "gram_schmidt", "deform_smooth"))
              for s, one in found.items()}
    return Finding(
        "Rendered by programs it is the same: beside a dense displaced mesh in Cycles our engine's rotation is off by "
        + " and ".join(f"{percent(one['rotate'])} ({s}; the nearest of the others {percent(others[s])})" for s, one in
                       found.items()) + f", Cycles' own normal map by {percent(found['waves'][CYCLES])} on the waves.",
        all(one["rotate"] <= 0.02 and one["rotate"] < others[s] for s, one in found.items())
        and found["waves"][CYCLES] > 0.1, "rendered")


def medians(rows, surface):
    """{method: error}, of all skies."""
    here = pick(rows, kind="steep", surface=surface)
    return {m: float(np.median([r["error"] for r in here if r["method"] == m])) for m in STEEP_SHOWN if m != "displaced"}


def finding_steep(rows):
    found = {s: medians(rows, s) for s in STEEP}
    return Finding(
        "Under skies bumps of slope 1 that shade each other (`mutual`) are nearer to displaced ones than today's rule, as seen "
        "from above, in the median of skies: " + ", ".join(
            f"{percent(one['mutual'])} for {percent(one['valid_estevez'])} ({s})" for s, one in found.items()) + ".",
        all(one["mutual"] < one["valid_estevez"] for one in found.values()), "steep")


CYCLES = "Cycles' normal map"  # truth.CYCLES


def findings(rows):
    found = [finding_rotate, finding_normal_map, finding_deform, finding_round, finding_approximate, finding_parallax,
             finding_design, finding_fibres, finding_cloth]
    if pick(rows, kind="rendered"):
        found.append(finding_rendered)
    if pick(rows, kind="steep"):
        found.append(finding_steep)
    return [one(rows) for one in found]


# ---- figures and tables ------------------------------------------------------------------------------


def curves(rows, bumps, key, methods, floor):
    """A panel a base: error against the steepest slope."""
    text = ""
    for base in displacement.BASES:
        drawing, axes = style.figure(360, 280)
        axes.set_yscale("log")
        for method in methods:
            mine = sorted(of(rows, material=GROOVED, base=base, bumps=bumps, method=method), key=lambda r: r["slope"])
            look = style.of(method)
            axes.plot([r["slope"] for r in mine], [100 * max(r[key], floor) for r in mine], **look.line, label=look.label)
        axes.set_ylim(100 * floor * 0.8, 300)
        style.log_ticks(axes.yaxis)
        axes.set_xlabel("steepest slope")
        axes.set_ylabel("mean error, % of the mean")
        axes.set_title(f"{base}, {bumps}", loc="left")
        if base == "plate":
            axes.legend(fontsize=11, ncols=2, loc="lower right")
        text += style.svg(drawing)
    return text


def figures(rows):
    made = [
        Figure("curves-waves", "Error of the lobe by slope: waves", f"Grooved metal, {GROOVED}; at the points that the eye "
               "sees of the displaced surface. Rotation is not drawn: its errors are below 0.1 %. " + MADE,
               curves(rows, "waves", "error_point", SHOWN, 1e-3), "Curves of error against slope for six methods"),
        Figure("curves-scratches", "Error of the lobe by slope: scratches", "The same for 48 scratches in any direction; "
               "much of the surface is flat between them. " + MADE,
               curves(rows, "scratches", "error_point", SHOWN, 1e-3), "Curves of error against slope for six methods"),
        Figure("seen", "Error as seen, by slope: waves", "Pixel by pixel, as the eye sees the surface: on curved bases "
               "parallax is added, which is all that rotation has. On the plate, seen from above, there is none, and rotation, drawn "
               "on the axis, is below it. " + MADE,
               curves(rows, "waves", "error", ("perturb", "deform_smooth", "gram_schmidt", "rotate"), 1e-3),
               "Curves of error against slope for four methods"),
    ]
    made += [Figure(f"steep-{surface}", f"Steep bumps under a sky: {surface}", "Slope 1, from above, under the first of the skies: really "
                    "displaced with 12 reflections, by the normal as before and now, and by Cycles' own node. " + MADE,
                    sheet.panels(pick(rows, kind="tile", figure=f"steep-{surface}"), 2), "Four pictures of a bumped plate")
             for surface in STEEP if pick(rows, kind="tile", figure=f"steep-{surface}")]
    return made + [gallery.figure(entry, rows, MADE) for entry in gallery.ENTRIES
                   if pick(rows, kind="tile", figure=entry.id)]


def tables(rows):
    made = [
        Table("errors", "Errors of every method and surface", "Mean absolute error over the mean of the truth; brightness: "
              "mean over that of the truth.",
              ("base", "bumps", "slope", "material", "method", "error of the lobe, %", "error as seen, %", "brightness"),
              [[r["base"], r["bumps"], r["slope"], r["material"], style.of(r["method"]).label, 100 * r["error_point"],
                100 * r["error"], r["brightness"]] for r in of(rows)]),
        Table("lobes", "Total variation of lobes", "Half the integral of |D' - D of the displaced surface|, mean over the "
              "azimuths of the normal; energy: the integral of D' above the base. The last column is the figure that "
              "libshade was designed by.",
              ("material", "tilt, °", "method", "total variation", "energy", "design"),
              [[r["material"], r["tilt"], style.of(r["method"]).label, r["variation"], r["energy"],
                DESIGN[r["method"]][TILTS.index(r["tilt"])] if r["method"] in DESIGN and r["material"] == GROOVED else None]
               for r in pick(rows, kind="lobe")]),
        Table("fibres", "Diffuse models beside real fibres", "Half cylinders of Lambert's law side by side, which hide and "
              "shade each other; lights over the hemisphere. Error: mean absolute difference over the mean.",
              ("model", "eye's elevation, °", "error, %", "worst difference of Phi", "brightness"),
              [[style.of(r["method"]).label, r["elevation"], 100 * r["error"], r["worst"], r["brightness"]]
               for r in pick(rows, kind="diffuse")]),
        Table("cloth", "Cloth from afar", "Mean colour beside the mean of the near model, worst of 20 pairs and 3 channels.",
              ("cloth", "far, %", "one lobe, %", "standard error of the truth, %"),
              [[r["cloth"].replace("_", " "), 100 * r["colour_far"], 100 * r["colour_single"], 100 * r["standard_error"]]
               for r in pick(rows, kind="cloth")]),
    ]
    if pick(rows, kind="rendered"):
        made.append(Table("rendered", "Rendered beside displaced meshes", "truth.py: slope 0.6, exponents (6170, 7.7), a sun; "
                          "scratches: off their creases.", ("surface", "method", "error, %"),
                          [[r["surface"], style.of(r["method"]).label, 100 * r["error"]] for r in pick(rows, kind="rendered")]))
    if pick(rows, kind="steep"):
        made.append(Table("steep", "Steep bumps under skies", "truth.py: round GGX of alpha 0.2, slope 1, from above; means of 4 × 4 pixels. "
                          "noise of the truth: half of what two of its pictures differ by.", ("surface", "sky", "method", "error, %"),
                          [[r["surface"], r["sky"], r["method"], 100 * r["error"]] for r in pick(rows, kind="steep")]))
    return made
