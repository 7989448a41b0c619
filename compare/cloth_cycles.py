# SPDX-License-Identifier: Apache-2.0
"""How far cloth in Cycles is from our own engine's near model: each preset on a plane and on a ball.

    build/venv/bin/python compare/cloth_cycles.py [3.4] [5.0] [--presets DENIM,LINEN] [--keep FOLDER]

Prints a table for each Blender (all by default), as docs/results/blender.md has it: the mean absolute difference of pixels over the mean, and the
mean brightness and colour (red, green, blue) of Cycles beside ours. The plane shows some twenty crossings, without what varies from
yarn to yarn, which differs by chance; the ball has it, its pixels hold half a crossing to many, and means of 4 x 4 pixels are compared.
--keep: the pictures, and sheet.png, ours beside Cycles'. A quarter of an hour.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "blender_addon_c/tests"), str(ROOT / "compare")]
from blender_runs import Blender, rgba  # noqa: E402
import whole  # noqa: E402

PRESETS = ("SILK_CHARMEUSE", "SHOT_TAFFETA", "POLYESTER_LINING", "DENIM", "LINEN", "SILK_SHANTUNG", "GABARDINE",
           "HERRINGBONE_TWEED", "WOOL_FLANNEL")
SCENES = {"plane": {"even": True, "samples": 32, "side": 160}, "ball": {"even": False, "samples": 48, "side": 192}}
ENGINES = ("LIBSHADE", "CYCLES")
BLOCK = 4


def picture_of(folder, scene, preset, engine):
    return Path(folder) / f"{scene}_{preset}_{engine}.exr"


def render(version, presets, folder):
    with tempfile.TemporaryDirectory() as home:
        blender = Blender(version, Path(home))
        requests = [{"preset": preset, "scene": scene, "engine": engine, **given,
                     "picture": str(picture_of(folder, scene, preset, engine))}
                    for scene, given in SCENES.items() for preset in presets for engine in ENGINES]
        words = [*blender._command, str(ROOT / "compare/cloth_render.py"), "--"]
        done = subprocess.run(words, input="".join(json.dumps(request) + "\n" for request in requests), text=True,
                              env=blender.environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.stdout.count("DONE") != len(requests):
        sys.exit(f"Blender {version}: {len(requests)} pictures expected\n{done.stdout[-2000:]}")


def blocks(picture):
    height, width = (side // BLOCK for side in picture.shape[:2])
    return picture[:BLOCK * height, :BLOCK * width].reshape(height, BLOCK, width, BLOCK, -1).mean((1, 3))


def figures(folder, scene, preset):
    """(difference of pixels over the mean, of brightness, of the three colours), Cycles beside ours."""
    ours, cycles = (rgba(picture_of(folder, scene, preset, engine)).astype(float)[..., :3] for engine in ENGINES)
    seen = (blocks(ours), blocks(cycles)) if scene == "ball" else (ours, cycles)
    return (np.abs(seen[1] - seen[0]).mean() / ours.mean(), cycles.mean() / ours.mean(),
            cycles.mean((0, 1)) / ours.mean((0, 1)))


def table(version, folder, presets):
    print(f"\nBlender {version}\n\n| cloth | plane: pixels | brightness | colour | ball: pixels | brightness | colour |\n"
          "|---|---|---|---|---|---|---|")
    for preset in presets:
        cells = []
        for scene in SCENES:
            pixels, bright, color = figures(folder, scene, preset)
            cells += [f"{pixels:.3f}", f"{bright:.2f}", ", ".join(f"{part:.2f}" for part in color)]
        print("| " + " | ".join([preset.replace("_", " ").capitalize(), *cells]) + " |", flush=True)


def sheet(folder, presets, path):
    """Plane and ball of each, ours at the left."""
    import OpenImageIO as oiio
    side = SCENES["ball"]["side"]

    def shown_of(*given):
        picture = rgba(picture_of(folder, *given))[..., :3]
        return np.pad(picture, [(0, side - picture.shape[0]), (0, side - picture.shape[1]), (0, 0)])

    rows = [np.concatenate([shown_of(scene, preset, engine) for scene in SCENES for engine in ENGINES], 1)
            for preset in presets]
    shown = np.clip(np.concatenate(rows), 0, 1)
    shown = np.where(shown < 0.0031308, 12.92 * shown, 1.055 * np.maximum(shown, 1e-9) ** (1 / 2.4) - 0.055)
    image = oiio.ImageBuf(oiio.ImageSpec(shown.shape[1], shown.shape[0], 3, oiio.UINT8))
    image.set_pixels(oiio.ROI(0, shown.shape[1], 0, shown.shape[0], 0, 1, 0, 3), shown.astype(np.float32))
    with whole.place(path) as part:
        image.write(str(part))


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("versions", nargs="*", metavar="VERSION", help="of Blender: 3.4, 5.0")
    parser.add_argument("--presets", default=",".join(PRESETS))
    parser.add_argument("--keep", metavar="FOLDER")
    given = parser.parse_args(words)
    presets = given.presets.upper().split(",")
    for version in given.versions or ["3.4", "5.0"]:
        if version not in ("3.4", "5.0") or not set(presets) <= set(PRESETS):
            parser.error(f"{version} {given.presets}: 3.4 or 5.0, and presets of {', '.join(PRESETS)} are expected")
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(given.keep or scratch) / version if given.keep else Path(scratch)
            folder.mkdir(parents=True, exist_ok=True)
            render(version, presets, folder)
            table(version, folder, presets)
            if given.keep:
                sheet(folder, presets, folder / "sheet.png")


if __name__ == "__main__":
    main()
