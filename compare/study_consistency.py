# SPDX-License-Identifier: Apache-2.0
"""Both renderers on every example: dump beside reference, dump beside dump, picture beside picture (study.py)."""
import json
import re
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

import check
import consistency
import dumps
import flip
import gallery
import paths
import pictures
import plate
import povray_common
import programs
import report
import sheet
import sphere
import whole
from gallery import pick
from sheet import percent
from study import Figure, Finding, Table, Task

NAME, TITLE = "consistency", "Two renderers, one reference"
INTRO = (
    "Do both renderers shade what the library's reference says, and do they see the same? Each example is rendered with "
    "its dump, which holds point, normals, light and what was shaded of every pixel. The reference, which shares no code "
    "with what renders, shades each dump again. Where a scene has a form for both renderers, by `export_povray.py`, the "
    "two dumps are compared channel by channel and the two pictures pixel by pixel: by the mean difference over the "
    "mean, and by FLIP, which says how different they look (0 the same, 1 the most). Variants of the demo's scene "
    "change distribution, BRDF, detail, horizon and diffuse model. Three small scenes more, a brushed plate, a scratched "
    "sphere and swatches of cloth, are said once and rendered by both. Each example appears in both, too: those of Blender as "
    "`example_common.py` leaves them and the exporter writes them, those of POV-Ray with their own shapes there, and "
    "meshes of them here; a table says what that left out. Pictures of cloth, where each sample meets "
    "another yarn, are compared by means over 4 × 4 pixels.")

FLIP_LIMIT = 0.05
# Scripts that run inside Blender, which no import tells of.
INSIDE = ("blender_render", "example_common", "example_scene", "export_povray", "povray_shapes", "povray_twins", "twin_scenes")


@dataclass(frozen=True)
class Look:
    """How a scene is rendered in both: percent of its size, samples, side of the blocks whose means are compared, POV-Ray's
    rays along a pixel's side (1: its own anti-aliasing), percent of the size that dumps have."""

    percent: int
    samples: int = 64
    block: int = 1
    over: int = 1
    dumps: int = 0

    @property
    def dumped(self):
        return self.dumps or self.percent


BLENDER = {path.parent.name: path
           for path in sorted((programs.ROOT / "examples" / "blender").glob("*/make_scene.py"))}
# not the cookbook's: they are parts of these
POVRAY = sorted(path for path in (programs.ROOT / "examples" / "povray").glob("*/*.pov")
                if path.stem == path.parent.name != "suzanne")
# Of a picture's size. Where cloth is far, the reference takes the mean of many points for each pixel and light.
PERCENT, CLOTH_PERCENT = 30, 7
CLOTHS = ("bolts", "cloth", "drape", "jacket")
OVER = 4  # POV-Ray's rays along a pixel's side: its picture is a larger one's means, as the box filter has it
# Scenes of twin_scenes.py
TWINS = {"brushed_plate": Look(30, 64, 1, OVER), "scratched_sphere": Look(30, 64, 1, OVER), "swatches": Look(24, 256, 4, OVER)}
# Examples in both renderers, of either one's own size: percents that leave whole pixels, so that frames are the same.
METAL, CLOTH = {"Blender": Look(15, 64, 1, OVER), "POV-Ray": Look(25, 64, 1, OVER)}, {
    "Blender": Look(20, 144, 4, OVER, 5), "POV-Ray": Look(25, 144, 4, OVER, 10)}
# At 25 % pixels of `groove` lie on the plates' edges, where either answer is right; `dial` and `pan` have narrow lights.
OWN = {"dial": Look(25, 64, 1, OVER), "pan": Look(25, 64, 1, OVER), "groove": Look(50, 64, 1, OVER),
       "scratches": Look(40, 64, 1, OVER), "povray/embossed": Look(25, 400, 4, 6)}  # a pixel holds several of its bumps
IN_BOTH = "in both"
ALPHAS = {"ax": 0.12, "ay": 0.4}
# A reduced set: every distribution, BRDF, detail method, horizon and diffuse model once or more.
VARIANTS = {
    "perturb": {"detail": "PERTURB"},
    "gram_schmidt": {"detail": "GRAM_SCHMIDT", "horizon": "HARD"},
    "deform_smooth": {"detail": "DEFORM_SMOOTH", "horizon": "ESTEVEZ", "diffuse": "FIBRE", "kd": (0.1, 0.08, 0.05)},
    "deform_linear": {"detail": "DEFORM_LINEAR_CONSERVING", "horizon": "CHIANG", "diffuse": "MAX_NORMAL",
                      "kd": (0.1, 0.08, 0.05)},
    "shortest_arc": {"detail": "SHORTEST_ARC", "horizon": "VALID_REFLECTION", "diffuse": "FIBRE_VIEW",
                     "kd": (0.1, 0.08, 0.05)},
    "ggx": {"distribution": "GGX", "brdf": "MICROFACET", "detail": "ROTATE", **ALPHAS},
    "ggx_approximate": {"distribution": "GGX", "brdf": "MICROFACET", "detail": "ROTATE_APPROXIMATE",
                        "horizon": "SCHUESSLER", **ALPHAS},
    "beckmann": {"distribution": "BECKMANN", "brdf": "MICROFACET", "detail": "AUTO", "diffuse": "LAMBERT",
                 "kd": (0.1, 0.08, 0.05), **ALPHAS},
    "ward": {"distribution": "WARD", "brdf": "WARD_1992", "detail": "ROTATE", **ALPHAS},
    "ward_bounded": {"distribution": "WARD_HALF", "brdf": "WARD_BOUNDED", "detail": "ROTATE", "groove": "Y", **ALPHAS},
}


# ---- the work ------------------------------------------------------------------------------------


def make(script, folder, variants=None):
    """Blender files of an example; {name: path}."""
    wanted = [script, folder]
    if variants:
        whole.write_text(folder / "variants.json", json.dumps(variants))
        wanted.append(folder / "variants.json")
    report.step("Making the scene", programs.blender(programs.HERE / "example_scene.py", *wanted), folder / "scene.log",
                programs.ADD_ON)
    return {name: folder / f"{name}.blend" for name in ("scene", *(variants or {}))}


def checked_row(scene, variant, renderer, dump, folder, every=False):
    """What `shade check` says of a dump, as a row."""
    options = SimpleNamespace(all=every, output=folder)
    found = consistency.check(renderer, dump, options)
    rows, good = consistency.check_rows(renderer, found, every)
    limit = consistency.CHECK_LIMITS[renderer]
    # beyond the limit only what the rounding of the dump's directions does not explain
    error = max(min(found["largest"], limit[0]), consistency.beyond(found, "largest"))
    far = [cell["far"] for cell in found.get("cells", []) if "far" in cell]
    return {"kind": "check", "scene": scene, "variant": variant, "renderer": renderer, "largest": found["largest"],
            "error": error, "mean": found["mean"], "beyond": consistency.beyond(found, "mean"),
            "values": found["values"], "far_values": sum(cell["values"] for cell in far), "far_over": sum(cell["over"] for cell in far),
            "far_sum": max((cell["sum"] for cell in far), default=0.0), "limit": limit[0], "mean_limit": limit[1],
            "ok": int(good), "missed": "; ".join(row[0] for row in rows if row[3] == consistency.verdict(False))}


def ours(path, folder, percent_of, samples=64):
    """Our engine's picture and dump of a Blender file; the picture's (width, height)."""
    options = SimpleNamespace(output=folder, scene=path, percent=percent_of, samples=samples, grid=4)
    return options, consistency.render_blender(options)


def both(scene, variant, path, folder, look, say, write=consistency.export_povray):
    """Rows of one Blender file in both renderers. write(options) leaves povray/scene.ini, POV-Ray's form of it."""
    folder.mkdir(exist_ok=True)
    (folder / "povray").mkdir(exist_ok=True)
    say(variant)
    if look.dumped != look.percent:  # the dump's is then the last
        ours(path, folder, look.percent, look.samples)
        (folder / "blender.exr").replace(folder / "blender_large.exr")
    options, size = ours(path, folder, look.dumped, look.samples if look.dumped == look.percent else 1)
    write(options)
    consistency.dump_povray(options, *size)
    if look.dumped != look.percent:
        (folder / "blender_large.exr").replace(folder / "blender.exr")
        size = pictures.read(folder / "blender.exr").shape[1::-1]
    consistency.render_povray(options, *size, look.over)
    files = {"Blender": folder / "blender_dump.exr", "POV-Ray": folder / "povray_dump.exr"}
    rows = [checked_row(scene, variant, name, file, folder) for name, file in files.items()]
    pair = [dumps.read(files["Blender"]), dumps.swap_handedness(dumps.read(files["POV-Ray"]))]
    if variant == IN_BOTH:
        own_uv(*pair, scene.startswith("povray/"))
    shown = [pictures.read(folder / f"{name}.exr") for name in ("blender", "povray")]
    shown[1] = paths.blocks(shown[1], look.over)
    shown = [paths.blocks(image, look.block) for image in shown]
    rows.append(pair_row(scene, variant, pair))
    rows.append(picture_row(scene, variant, shown))
    return rows + worst_tiles(folder, scene, variant, shown)


def own_uv(a, b, shapes):
    """Dumps of examples, POV-Ray's the second: where one of its own shapes has no UV coordinates, which is said by two zeros,
    a mesh of it has none; where more than a unit is seen of a map, as of cloth, which counts yarns, they are parts of that."""
    if shapes:
        a.uv[(b.uv == 0).all(-1)] = 0.0
    for material in b.header["materials"]:
        seen = (b.material == material["id"]) & a.covered
        wide = max(1.0, np.ptp(b.uv[seen], axis=0).max()) if seen.any() else 1.0
        for dump in (a, b):
            dump.uv[seen] /= wide


def pair_row(scene, variant, pair):
    rows, good = check.pair_rows(*pair)
    shaded, same = check.shaded_rows(*pair)
    # Beside a yarn's rim the last digits of uv say what a point of cloth shows: there S of the two differ by more than
    # any limit (median .16 %, mean 7.9 %), though each is the reference's. Their pictures are compared, which average.
    cloth = any("fabric" in material for dump in pair for material in dump.header["materials"])
    same, shaded = same or cloth, [] if cloth else shaded
    shares = {name: float(np.mean(error <= consistency.DUMP_LIMITS[name.split(".")[-1]][0]))
              for name, error in dumps.deviations(*pair).items()}
    least = min(shares, key=shares.get)
    return {"kind": "pair", "scene": scene, "variant": variant, "apart": dumps.coverage_difference(*pair),
            "least": least, "share": shares[least], "limit": consistency.SHARE, "ok": int(good and same),
            "missed": "; ".join(row[0] for row in rows + shaded if row[3] == consistency.verdict(False))}


def picture_row(scene, variant, shown):
    rows, good = consistency.picture_rows(*shown)
    look = flip.flip(*[displayed(image) for image in shown])
    return {"kind": "picture", "scene": scene, "variant": variant, "difference": pictures.worst_channel(shown[1], shown[0]),
            "limit": consistency.PICTURE_LIMIT, "flip": float(look.mean()), "flip_limit": FLIP_LIMIT,
            "ok": int(good and look.mean() <= FLIP_LIMIT)}


def displayed(image):
    """What a screen shows of it: 1 is white."""
    return np.clip(image, 0.0, 1.0)


def worst_tiles(folder, scene, variant, shown, side=40):
    """The neighbourhood of the pixel that looks most different, in both, and ten times the difference."""
    look = flip.flip(*[displayed(image) for image in shown])
    row, column = np.unravel_index(np.argmax(look), look.shape)
    high, wide = look.shape
    top, left = (int(np.clip(at - side // 2, 0, max(most - side, 0))) for at, most in ((row, high), (column, wide)))
    crops = [displayed(image)[top:top + side, left:left + side] for image in shown]
    crops.append(np.clip(10 * np.abs(crops[0] - crops[1]), 0, 1))
    large = [np.repeat(np.repeat(pictures.encode(crop), 3, 0), 3, 1) for crop in crops]
    at = f"at ({column}, {row})"
    name = f"{scene}-{variant}".replace(" ", "_").replace("/", "-")
    return sheet.tiles(folder, name, [
        (f"{scene}|{variant}|Blender".replace("_", " "), large[0]), (f"POV-Ray|{at}", large[1]),
        ("difference,|ten times", large[2], "FLIP there {}", float(look.max()))])


def demo(variants, percent_of):
    def run(folder, say):
        say("making the scene")
        files = make(BLENDER["suzanne"], folder, variants)
        rows = []
        for variant, path in files.items():
            variant = "as it is" if variant == "scene" else variant
            rows += both("suzanne", variant, path, folder / path.stem, Look(percent_of), say)
        return rows
    return run


def twin(name):
    def run(folder, say):
        say("making the scene")
        pictures.write_float(folder / "bumps.exr", plate.normal_map(512))
        # fine, since between texels one renderer blends slopes, the other normals
        pictures.write_float(folder / "scratches.exr", sphere.normal_map(2048))
        report.step("Making the scene", programs.blender(programs.HERE / "twin_scenes.py", name, folder),
                    folder / "scene.log", programs.ADD_ON)
        return both(name, "as it is", folder / "scene.blend", folder / "out", TWINS[name], say)
    return run


def blender_example(name):
    """As it is, in Blender; and as far as both renderers can show it."""
    def run(folder, say):
        say("making the scene")
        path = make(BLENDER[name], folder)["scene"]
        say("rendering")
        ours(path, folder, CLOTH_PERCENT if name in CLOTHS else PERCENT, 4)
        rows = [checked_row(name, "as it is", "Blender", folder / "blender_dump.exr", folder)]
        report.step("Changing what one renderer cannot show", programs.blender(
            programs.HERE / "example_common.py", folder, scene=path), folder / "common.log", programs.ADD_ON)
        rows += left_rows(name, json.loads((folder / "left_out.json").read_text(encoding="utf-8")))
        look = OWN.get(name) or (CLOTH if name in CLOTHS else METAL)["Blender"]
        return rows + both(name, IN_BOTH, folder / "common.blend", folder / "both", look, say)
    return run


def povray_example(path):
    """As it is, in POV-Ray; and with its own shapes there and meshes of them in Blender, as far as both can show it."""
    def run(folder, say):
        scene, said = f"povray/{path.stem}", path.read_text(encoding="utf-8")
        if "basket.png" in said:
            words = re.search(r"build/shade (weave .*) -o", said).group(1).split()
            report.step("Weaving", [programs.SHADE, *words, "--size", "1024", "-o", str(folder / "basket.png")],
                        folder / "weave.log")
        say("rendering")
        rows = [povray_as_it_is(scene, path, said, folder)]
        say("making the scene")
        text, left = povray_common.common(path.stem, said)
        report.step("Making the scene", programs.blender(programs.HERE / "povray_twins.py", path.stem, folder),
                    folder / "scene.log", programs.ADD_ON)

        def write(options):
            whole.write_text(options.output / "povray" / "scene.pov", text)
            whole.write_text(options.output / "povray" / "scene.ini", f'Input_File_Name=scene.pov\nLibrary_Path="{folder}"\n')

        look = OWN.get(scene) or (CLOTH if "fabric" in text else METAL)["POV-Ray"]
        return rows + left_rows(scene, left) + both(scene, IN_BOTH, folder / "scene.blend", folder / "both", look, say, write)
    return run


def povray_as_it_is(scene, path, text, folder):
    lamp = "" if re.search(r"\blight_source\b", text) else "light_source { <-5, 8, -6>, rgb 1 }\n"
    text = re.sub(r"(?s)radiosity\s*\{.*?\}", "", re.sub(r"\bsamples \d+", "samples 1", text))
    whole.write_text(folder / "scene.pov", text + lamp)
    width, height = (96, 54) if "fabric" in text else (192, 108)
    report.step("Dumping in POV-Ray", [
        programs.POVRAY, f"+I{folder / 'scene.pov'}", f"+L{folder}", f"+L{path.parent}",
        f"+O{folder / 'picture.png'}", f"+W{width}", f"+H{height}", "-A", "-D"],
                folder / "povray.log", {"LIBSHADE_DUMP": str(folder / "povray_dump.exr")})
    return checked_row(scene, "as it is", "POV-Ray", folder / "povray_dump.exr", folder)


def left_rows(scene, left):
    return [{"kind": "left", "scene": scene, "variant": IN_BOTH, "place": place, "what": what} for place, what in enumerate(left)]


def tasks(quick):
    needs = (programs.POVRAY, programs.BUILD / "blender" / "addons" / "libshade" / "_native.abi3.so",
             *(programs.HERE / f"{name}.py" for name in INSIDE))
    command = "compare/consistency.py build/demo/suzanne.blend"
    if quick:
        return [Task("suzanne-quick", 14, demo({}, 20), command + " --percent 20", needs)]
    work = [Task("suzanne", 150, demo(VARIANTS, 30), command + " --percent 30", (*needs, BLENDER["suzanne"]))]
    work += [Task(f"twin-{name}", 30, twin(name), "build/venv/bin/python compare/report_page.py --only consistency", needs)
             for name in TWINS]
    work += [Task(f"blender-{name}", 25, blender_example(name), f"examples/blender/{name}/make_scene.py", (*needs, path))
             for name, path in BLENDER.items() if name != "suzanne"]
    return work + [Task(f"povray-{path.stem}", 20, povray_example(path), f"the command at the top of {path.name}", (*needs, path))
                   for path in POVRAY]


# ---- what was found --------------------------------------------------------------------------------


# Which part of the dumps may be named so, of examples in both and of the rest. In both there are two of each, cloth's among them.
OVER_SHARE = {True: 0.25, False: 0.2}
FAR_SHARE, FAR_SUM = 0.005, 0.02  # of cloth from afar: values over their limit, and how far sums may be off


def nearly(row):
    """Whether a dump that misses its limits does so by few values of cloth from afar alone."""
    return not row.get("missed") and 0 < row["far_over"] <= FAR_SHARE * row["far_values"] and row["far_sum"] <= FAR_SUM


def part(rows, in_both):
    return sum((row["variant"] == IN_BOTH) == in_both for row in rows)


def name_of(row):
    return row["scene"] + (f" in both, {row['renderer']}" if row["variant"] == IN_BOTH else "")


def far_text(row):
    return f" ({row['far_over']} of {row['far_values']} values of cloth from afar)"


def finding_reference(rows):
    """Each value and each material's mean within its limit, but for what the rounding of the dump's directions may do, which
    `shade check` computes from the reference and takes off both."""
    found = pick(rows, kind="check")
    names = sorted({row["renderer"] for row in found})
    worst = {name: max(row["error"] for row in found if row["renderer"] == name) for name in names}
    over = [row for row in found if not row["ok"]]
    sharp = [row for row in found if row["mean"] > row["mean_limit"]]
    text = (f"{len(found) - len(over)} of {len(found)} dumps are shaded as the reference says, "
            f"{sum(row['values'] for row in found)} values in all: "
            + " and ".join(f"{name} within {worst[name]:.0e} of each value" for name in names) + ", but for what the "
            "rounding of a dump's directions explains.")
    if sharp:
        text += (f" That alone takes a material's mean over its limit in {len(sharp)}, whose lobes are narrow: the largest is "
                 f"{max(row['mean'] for row in sharp):.1e}; beyond that rounding no mean of them is above "
                 f"{max(row['beyond'] for row in sharp):.1e}.")
    if over:
        text += " Not within all limits: " + ", ".join(name_of(row) + far_text(row) for row in over) + "."
    return Finding(
        text, names == ["Blender", "POV-Ray"] and all(
            row["values"] > 0 and row["error"] <= row["limit"] and row["beyond"] <= row["mean_limit"]
            and (row["ok"] or nearly(row)) for row in found)
        and all(part(over, variant) < most * max(1, part(found, variant)) for variant, most in OVER_SHARE.items()), "matrix")


def finding_pair(rows):
    found = pick(rows, kind="pair")
    least = min(found, key=lambda row: row["share"])
    missed = [row for row in found if not (row["ok"] and row["share"] >= row["limit"])]
    text = (f"Both renderers see the same in {len({row['scene'] for row in found})} scenes, {len(found) - len(missed)} times of "
            f"{len(found)}: point, normals, tangent, light and "
            f"material of a pixel agree in {least['share']:.2%} of all pixels or more (the least is {least['least']} of "
            f"{least['scene'].replace('_', ' ')}, {least['variant'].replace('_', ' ')}).")
    for row in missed:
        text += f" MISSED: {row['scene']} ({row['least']} in {row['share']:.2%} of its pixels, limit {row['limit']:.1%})."
    return Finding(text, not missed, "matrix")


def finding_pictures(rows):
    found = pick(rows, kind="picture")
    worst, look = max(row["difference"] for row in found), max(row["flip"] for row in found)
    return Finding(
        f"Their pictures differ by {percent(worst)} of the mean at most, channel by channel, and look the same: FLIP "
        f"{look:.3f} at most in the mean.",
        all(row["ok"] and row["difference"] <= row["limit"] and row["flip"] <= row["flip_limit"] for row in found), "matrix")


def findings(rows):
    return [finding_reference(rows), finding_pair(rows), finding_pictures(rows)]


def figures(rows):
    made = []
    for name in dict.fromkeys(row["figure"] for row in pick(rows, kind="tile")):
        tiles = sorted(gallery.pick(rows, kind="tile", figure=name), key=lambda row: row["place"])
        made.append((name, tiles))
    text = "".join(sheet.svg(tiles) for _name, tiles in made)
    return [Figure("worst", "Where they look most different", "The pixel of the highest FLIP and its neighbourhood, three "
                   "times as large; edges, where each renderer has rays of its own. Made by `compare/report_page.py --only "
                   "consistency`.", text, "Crops of both renderers' pictures and their difference")] if made else []


def cell(found, column, form):
    if not found:
        return None
    row = found[0]  # a miss by cloth from afar alone shows in no error
    return f"{'ok' if row['ok'] else 'MISSED'}, {form(row[column])}" + ("" if row["ok"] or not row.get("far_over") else far_text(row))


def tables(rows):
    scenes = dict.fromkeys((row["scene"], row["variant"]) for row in rows if row["kind"] in ("check", "pair", "picture"))
    lines = []
    for scene, variant in scenes:
        of = {"scene": scene, "variant": variant}
        small, share = "{:.1e}".format, "{:.3%}".format
        lines.append([scene, variant.replace("_", " "),
                      cell(pick(rows, kind="check", renderer="Blender", **of), "error", small),
                      cell(pick(rows, kind="check", renderer="POV-Ray", **of), "error", small),
                      cell(pick(rows, kind="pair", **of), "share", share),
                      cell(pick(rows, kind="picture", **of), "difference", percent),
                      cell(pick(rows, kind="picture", **of), "flip", "{:.3f}".format)])
    return [Table("matrix", "Verdicts", "Largest relative error of a value beside the reference; least share of pixels that "
                  "agree; mean difference over the mean, worst channel; mean FLIP. Empty: as it is, the example is of the "
                  "other renderer; `in both` is what both can show of it.",
                  ("scene", "variant", "Blender, reference", "POV-Ray, reference", "dump, dump", "picture, picture", "FLIP"),
                  lines), *left_table(rows)]


def left_table(rows):
    left = {}
    for row in sorted(pick(rows, kind="left"), key=lambda row: row["place"]):
        left.setdefault(row["scene"], []).append(row["what"])
    return [Table("left", "What both renderers show an example without", "What one of them has no words for, or no light that "
                  "is the other's: taken out of both, or changed in both alike. The dump of the example as it is, in the table "
                  "above, has all of it.", ("scene", "left out or changed"),
                  [[scene, "; ".join(words)] for scene, words in left.items()])] if left else []
