# SPDX-License-Identifier: AGPL-3.0-or-later
"""The scenes of examples/povray: they render as README's and the manual's pictures show them, and what they show is there without a lamp too."""
import re
import subprocess

import numpy as np
import pytest
from PIL import Image

from conftest import ROOT

COST = 23

SCENES = sorted(p for p in (ROOT / "examples/povray").glob("*/*.pov") if p.stem != "suzanne")  # the demo's: compare/


def without_lamps(text):
    """The scene without its light_source { … }."""
    while (found := re.search(r"\blight_source\s*{", text)):
        depth, end = 1, found.end()
        while depth:
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        text = text[:found.start()] + text[end:]
    return text


SHEET = "embossed lampshade reflection kitchen presets inlay scratches turned metals".split()  # README's, three in a row


# How far apart small and few-rayed pictures may be from those: means of all and the largest of 8 by 4 parts, in thousandths of white
APART = {"averaged_normals": (13, 24), "checker_plate": (22, 75), "cloth": (12, 31), "embossed": (22, 53), "inlay": (16, 23), "kitchen": (18, 75), "lampshade": (8, 27),
         "lift_door": (11, 74), "metals": (9, 46), "presets": (29, 71), "radiosity": (19, 42), "recolour": (6, 16), "reflection": (25, 46), "scratches": (24, 48), "ten_colours": (5, 11),
         "turned": (11, 24), "twill_hand": (9, 25), "under_glass": (15, 30), "watch_dial": (13, 27)}


def published(scene):
    """The picture that a reader sees of it, in linear light, or None."""
    name = scene.stem
    place = ROOT / (f"docs/pictures/povray-{name.replace('_', '-')}.jpg" if scene.parent.name == "cookbook" else "examples/povray-cloth.jpg" if name == "cloth" else "examples/povray.jpg")
    if name == "costs":  # one ball, to measure
        return None
    picture = Image.open(place)
    if name in SHEET:
        x, y = 480 * (SHEET.index(name) % 3), 270 * (SHEET.index(name) // 3)
        picture = picture.crop((x, y, x + 480, y + 270))
    encoded = np.asarray(picture.convert("RGB").resize((480, 270))) / 255
    return np.where(encoded < .04045, encoded / 12.92, ((encoded + .055) / 1.055) ** 2.4)


def blocks(image, rows, columns):
    """Means of parts of a linear picture, as it is shown, encoded as sRGB."""
    image = np.minimum(image, 1)
    bounds = [np.linspace(0, length, parts + 1).astype(int) for length, parts in zip(image.shape, (rows, columns))]
    light = np.array([[image[a:b, c:d].mean((0, 1)) for c, d in zip(bounds[1], bounds[1][1:])] for a, b in zip(bounds[0], bounds[0][1:])])
    return np.where(light < .0031308, light * 12.92, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - .055)


def test_there_are_ten():
    assert len(SCENES) + 1 >= 10


@pytest.mark.parametrize("scene", SCENES, ids=lambda p: p.stem)
def test_example(render, shade, shade_check, tmp_path, scene):
    if "basket.png" in scene.read_text():
        command = re.search(r"build/shade (weave .*) -o", scene.read_text()).group(1).split()
        subprocess.run([shade, *command, "--size", "128", "-o", tmp_path / "basket.png"], check=True)
    shown = {}
    lit = scene.read_text()
    own_map = re.search(r"\+O(?:build/)?(\S+) .*(\+FN16 .*Declare=Map=1)$", lit, re.M)  # that the scene itself draws
    if own_map:
        render(lit, (64, 64), ["-A", f"+O{own_map[1]}", *own_map[2].split()], dump=False)
    dark = without_lamps(lit)
    # not those of the cookbook: what they are made of is in the others, too
    kinds = [("as it is", lit)] + [("dark", dark)] * (scene.parent.name != "cookbook" and dark != lit)
    for name, text in kinds:
        text = re.sub(r"\bsamples \d+", "samples 4", re.sub(r"\bcount \d+", "count 10", text))
        mutual = "horizon mutual" in text
        result = render(text.replace("horizon mutual", "horizon mutual notes on"), (64, 36), ["-A"], dump=mutual)
        if mutual:  # with the slopes near each point, which its dump has to tell
            shade_check(result.dump, everything=False)
            assert "its bump image is uneven: each hit has the slopes near it" in result.message, result.log
        assert "it is taken as" not in result.message, result.log
        shown[name] = result.image
        assert np.isfinite(shown[name]).all()
    picture = published(scene)
    if picture is not None:  # of fewer rays, without antialiasing; where a scene changes its picture does
        small, large = (np.abs(blocks(shown["as it is"], *parts) - blocks(picture, *parts)) for parts in ((9, 16), (4, 8)))
        mean, most = APART[scene.stem]
        assert small.mean() < mean / 1000 and large.max() < most / 1000, f"{scene.stem} looks otherwise than in its picture (make pictures): {small.mean():.4f} {large.max():.3f}"
    if dark == lit:
        shown["dark"] = shown["as it is"]
    # more than the background, and no even surface
    assert np.median(shown["as it is"]) > .01 and shown["as it is"].std() > .1 * shown["as it is"].mean()
    if "dark" in shown:
        assert shown["dark"].mean() > .005 and shown["dark"].std() > .2 * shown["dark"].mean()
