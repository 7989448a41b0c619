# SPDX-License-Identifier: AGPL-3.0-or-later
"""The scenes of examples/povray: they render, and what they show is there without a lamp too."""
import re
import subprocess

import numpy as np
import pytest

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
    if dark == lit:
        shown["dark"] = shown["as it is"]
    # more than the background, and no even surface
    assert np.median(shown["as it is"]) > .01 and shown["as it is"].std() > .1 * shown["as it is"].mean()
    if "dark" in shown:
        assert shown["dark"].mean() > .005 and shown["dark"].std() > .2 * shown["dark"].mean()
