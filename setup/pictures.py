# SPDX-License-Identifier: Apache-2.0
"""Make README's pictures from what `make compare` left in build/, the swatches from the tool, the rest by rendering;
with `manual` those of the manual: nodes in the editor, what their sockets do, the cookbook of POV-Ray."""
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
DEMO = ROOT / "build" / "demo"
STRIP = ROOT / "build" / "compare" / "truth" / "strip.png"
WIDTH = 1600


def scaled(picture):
    return picture.resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.LANCZOS)


def side_by_side(pictures):
    strip = Image.new("RGB", (sum(p.width for p in pictures), pictures[0].height))
    x = 0
    for picture in pictures:
        strip.paste(picture, (x, 0))
        x += picture.width
    return strip


def swatches():
    """examples/swatches.jpg: every preset, as `shade swatch --all` draws it."""
    sheet = ROOT / "build" / "swatches.png"
    subprocess.run([ROOT / "build" / "shade", "swatch", "--all", "--size", "136", "-o", sheet],
                   check=True)
    Image.open(sheet).save(ROOT / "examples" / "swatches.jpg", quality=80, optimize=True, progressive=True)


def povray_cloth():
    """examples/povray-cloth.jpg: examples/povray/cloth, by the patched POV-Ray."""
    made = ROOT / "build" / "povray-cloth.png"
    subprocess.run([ROOT / "build" / "povray" / "povray", f"+I{ROOT}/examples/povray/cloth/cloth.pov", f"+O{made}",
                    "+W960", "+H540", "+A0.1", "-D", "-V"], check=True, stderr=subprocess.DEVNULL)
    Image.open(made).convert("RGB").save(ROOT / "examples" / "povray-cloth.jpg", quality=80, optimize=True, progressive=True)


def povray_sheet():
    """examples/povray.jpg: what is in examples/povray beside the demo and the cloth."""
    build = ROOT / "build"
    names = ["embossed", "lampshade", "reflection", "kitchen", "presets", "inlay", "scratches", "turned", "metals"]
    subprocess.run([build / "shade", "weave", "--name", "basket", "--cells", "16", "--curve", ".35", "--ridge", "0", "--map", "normal",
                    "--bits", "16", "-o", build / "basket.png"], check=True)
    sheet = Image.new("RGB", (3 * 480, 3 * 270))
    for i, name in enumerate(names):
        made = build / f"povray-{name}.png"
        subprocess.run([build / "povray" / "povray", f"+I{ROOT}/examples/povray/{name}/{name}.pov", f"+L{build}", f"+O{made}",
                        "+W960", "+H540", "+A0.2", "-D", "-V"], check=True, stderr=subprocess.DEVNULL)
        sheet.paste(Image.open(made).convert("RGB").resize((480, 270), Image.LANCZOS), (480 * (i % 3), 270 * (i // 3)))
    sheet.save(ROOT / "examples" / "povray.jpg", quality=80, optimize=True, progressive=True)


# Of each scene in examples/blender its arguments, and what of its picture (in 480ths of a sheet's width) goes where.
_BLENDER = (("pan", (), (0, 0, 240, 135)), ("dial", (), (240, 0, 240, 135)), ("drape", (), (0, 135, 146, 135)),
            ("jacket", (), (146, 135, 167, 135)), ("jacket", ("near",), (313, 135, 167, 135)))


def fitted(picture, width, height):
    """Scaled until it fills a rectangle; what is beyond it at the sides, or on top, is cut off."""
    scale = max(width / picture.width, height / picture.height)
    picture = picture.resize((round(picture.width * scale), round(picture.height * scale)), Image.LANCZOS)
    left, top = (picture.width - width) // 2, picture.height - height
    return picture.crop((left, top, left + width, top + height))


def rendered(name, *words):
    """A scene of examples/blender."""
    build = ROOT / "build"
    made = build / ("-".join(["blender", name, *words]) + ".png")
    if not made.is_file():
        subprocess.run(["blender", "-b", "--factory-startup", "--addons", "libshade", "--python-exit-code", "1", "-P",
                        ROOT / "examples/blender" / name / "make_scene.py", "--", made, *words], check=True,
                       stdout=subprocess.DEVNULL, env={**os.environ, "BLENDER_USER_SCRIPTS": str(build / "blender")})
    return Image.open(made).convert("RGB")


def blender_sheet():
    """examples/blender.jpg: scenes of examples/blender by our engine (half an hour of a processor)."""
    unit = 3
    sheet = Image.new("RGB", (480 * unit, 270 * unit))
    for name, words, place in _BLENDER:
        x, y, width, height = (unit * k for k in place)
        sheet.paste(fitted(rendered(name, *words), width, height), (x, y))
    sheet.save(ROOT / "examples" / "blender.jpg", quality=78, optimize=True, progressive=True)


# By rows: how high, and of each scene its arguments and how wide.
_TWINS = ((162, (("pan", (), 288), ("dial", (), 288))), (210, (("scratches", (), 315), ("jacket", ("near",), 261))),
          (248, (("drape", (), 269), ("jacket", (), 307))))


def twins(picture_of=rendered):
    """examples/twins.jpg: the same by our engine and, on the right, by Cycles (an hour of a processor)."""
    sheet, y = Image.new("RGB", (1152, sum(height for height, _scenes in _TWINS))), 0
    for height, scenes in _TWINS:
        x = 0
        for name, words, width in scenes:
            for engine in ((), ("cycles",)):
                sheet.paste(fitted(picture_of(name, *words, *engine), width, height), (x, y))
                x += width
        y += height
    sheet.save(ROOT / "examples" / "twins.jpg", quality=74, optimize=True, progressive=True)


def nodes():
    """examples/nodes: our nodes in the shader editor, which needs a window."""
    size = "1600", "1100"
    subprocess.run(["xvfb-run", "-a", "-s", f"-screen 0 {'x'.join(size)}x24", "blender", "--factory-startup", "--window-geometry", "0", "0", *size,
                    "--addons", "libshade", "-P", ROOT / "examples/blender/nodes/make_pictures.py", "--", ROOT / "examples/nodes"], check=True,
                   stdout=subprocess.DEVNULL, env={**os.environ, "BLENDER_USER_SCRIPTS": str(ROOT / "build/blender"), "LIBGL_ALWAYS_SOFTWARE": "1"})
    for path in (ROOT / "examples/nodes").glob("*.png"):
        Image.open(path).convert("RGB").quantize(128).save(path, optimize=True)


def first():
    """docs/pictures/first.jpg: what the manual's first steps in Blender lead to."""
    made = ROOT / "build/first.png"
    subprocess.run(["blender", "-b", "--factory-startup", "--addons", "libshade", "--python-exit-code", "1", "-P",
                    ROOT / "examples/blender/nodes/make_first.py", "--", made], check=True,
                   stdout=subprocess.DEVNULL, env={**os.environ, "BLENDER_USER_SCRIPTS": str(ROOT / "build/blender")})
    Image.open(made).convert("RGB").resize((640, 360), Image.LANCZOS).save(ROOT / "docs/pictures/first.jpg", quality=80, optimize=True,
                                                                          progressive=True)


def effects():
    """docs/pictures: what sockets do, by a Blender that denoises."""
    subprocess.run([ROOT / "build/venv-bpy/bin/python", ROOT / "examples/blender/nodes/make_effects.py", "--", ROOT / "docs/pictures"], check=True,
                   stdout=subprocess.DEVNULL, env={**os.environ, "BLENDER_USER_SCRIPTS": str(ROOT / "build/blender")})


def cookbook():
    """docs/pictures: each scene of POV-Ray's cookbook, by the commands on its top."""
    for scene in sorted((ROOT / "examples/povray/cookbook").glob("*.pov")):
        if scene.stem == "costs":
            continue  # of one ball
        for command in re.findall(r"^// +(build/povray/povray .*)", scene.read_text(encoding="utf-8"), re.M):
            subprocess.run([*shlex.split(command), "-D", "-V"], check=True, cwd=ROOT, stderr=subprocess.DEVNULL)
        picture = Image.open(ROOT / "build" / f"{scene.stem}.png").convert("RGB")
        picture.resize((480, 270), Image.LANCZOS).save(ROOT / "docs/pictures" / f"povray-{scene.stem.replace('_', '-')}.jpg", quality=80,
                                                       optimize=True, progressive=True)


def manual():
    nodes()
    first()
    effects()
    cookbook()


def main():
    swatches()
    blender_sheet()
    twins()
    povray_cloth()
    povray_sheet()
    both = side_by_side([Image.open(DEMO / f"{name}.png") for name in ("blender", "povray")])
    scaled(both).save(ROOT / "examples" / "suzanne.jpg", quality=82, optimize=True)
    scaled(Image.open(STRIP).convert("RGB")).save(ROOT / "examples" / "plate.jpg", quality=82, optimize=True)


if __name__ == "__main__":
    manual() if "manual" in sys.argv else main()
