# SPDX-License-Identifier: Apache-2.0
"""The twin of a scene has POV-Ray's own words where the block stood, and nothing else changed."""
import pytest

import twins

COST = 0.1


def test_twin_replaces_blocks_alone():
    text = ('#ifndef (mdf_Version)\n  #error "x"\n#end\nsphere { 0, 1 finish { ambient 0 diffuse 0 mdf { ggx .1, .3 reflection { samples 2 } } } }\n'
            "box { 0, 1 finish { ambient 0 mdf { specular .5 } irid { .2 } } }\nplane { y, 0 finish { diffuse .6 } }\n")
    stock = f"sphere {{ 0, 1 finish {{ ambient 0 {twins.STOCK} }} }}\nbox {{ 0, 1 finish {{ ambient 0 {twins.STOCK} irid {{ .2 }} }} }}\nplane {{ y, 0 finish {{ diffuse .6 }} }}\n"
    assert twins.twin(text) == stock


def test_twin_of_a_broken_scene_is_refused():
    with pytest.raises(ValueError):
        twins.twin("sphere { finish { mdf { ggx .1, .1 ")


def test_primitives_are_all_named():
    text = (twins.ROOT / "compare/twins/primitives.pov").read_text()
    assert text.count("#case") == len(twins.SHAPES) and "mdf" not in twins.twin(text)
