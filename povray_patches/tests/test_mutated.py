# SPDX-License-Identifier: AGPL-3.0-or-later
"""Broken blocks: a clear error or a picture, never a crash, a hang or a NaN. MUTATED says how many (25)."""
import os
import random

import numpy as np
import pytest

from scenes import scene

COST = 1.9

BLOCKS = ["ashikhmin_shirley 200 , 10 detail rotate fresnel schlick horizon valid_estevez specular rgb < .5 , .4 , .3 > tangent uv",
          "ggx .1 , .3 fresnel conductor rgb < .2 , .9 , 1.1 > , rgb < 3.9 , 2.4 , 2.1 > reflection { samples 4 clamp 10 } tangent radial y at < 0 , 1 , 0 >",
          "ward .2 , .1 diffuse fibre rgb < .2 , .3 , .4 > specular pigment roughness .01 , .2 groove y brdf ward_bounded",
          'fabric { preset "denim" crossings < 30 , 20 > warp { diffuse pigment width 1 gap .2 along 30 } nap .1 backing rgb 0 }',
          'fabric { weave 1 , 2 , 1 yarns { diffuse fibre rgb .3 transmit rgb .2 crimp .3 slub .2 } occlusion sky seed 3 ggx detail deform_smooth mm_per_unit 90 }',
          'preset "scratched_gold" scratches { tile_mm 9 mm_per_unit 30 layer { pits 90 radius .01 , .1 stretch 3 , 9 depth .1 , .4 direction 20 spread 9 } }',
          'beckmann .2 , .1 bump_image { png "bump.png" strength 2 once scale < 2 , 3 > translate < .1 , .2 > }']
WORDS = ["{", "}", ",", "<", ">", "-1", "0", "1e300", "1e300*1e300", "1e-300", "-7.5", "x", "rgb", "pigment", "\"denim\"", "off", "on", "#declare A = 1;",
         "fabric", "reflection", "mdf", "warp", "layer", "99999999999", "texture", "rotate", "none", "samples", "crossings", "occlusion", "tile_mm 4000", "normal", "ambient", "/*", "//", "'"]


def mutated(number):
    draw = random.Random(number)
    words = draw.choice(BLOCKS).split()
    for _ in range(draw.randint(1, 4)):
        at = draw.randrange(len(words)) if words else 0
        kind = draw.randrange(5)
        if kind == 0 and words:
            del words[at]
        elif kind == 1 and words:
            words[at] = draw.choice(WORDS)
        elif kind == 2:
            words.insert(at, draw.choice(WORDS))
        elif kind == 3 and words:
            words[at:at + 1] = words[at:at + draw.randint(1, 6)] * 2
        else:
            other = draw.choice(BLOCKS).split()
            words[at:] = other[draw.randrange(len(other)):]
    return " ".join(words)


@pytest.mark.parametrize("number", range(int(os.environ.get("MUTATED", "25"))))
def test_a_broken_block_is_an_error_or_a_picture(render, tmp_path, number):
    import OpenImageIO as oiio
    picture = oiio.ImageBuf(oiio.ImageSpec(4, 4, 3, "uint8"))
    assert picture.write(str(tmp_path / "bump.png"))
    block = mutated(number)
    text = scene(f"sphere {{ 0, 1 texture {{ pigment {{ rgb .5 }} finish {{ ambient .1 mdf {{ {block} }} }} }} }}\nplane {{ y, -1 pigment {{ rgb .5 }} }}")
    result = render(text, size=(12, 9), fails=True)  # a signal or a hang fails there
    if result.status == 0:
        assert np.isfinite(result.image).all(), block
        assert np.isfinite(result.dump.S).all() and np.isfinite(result.dump.Ns[result.dump.hit]).all(), block
    else:
        assert "Error" in result.log and "scene.pov" in result.log, f"{block}\n{result.log}"
