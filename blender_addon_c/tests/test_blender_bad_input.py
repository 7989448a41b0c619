# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that cannot be rendered as they are: a clear message, never a crash, NaN or silence."""

import math
import re

import numpy as np
import pytest

from blender_runs import rgba

COST = 14.3


# case: (how it ends, what must be said); None: nothing
EXPECTED = {
    "fine": ("finished", None),
    "empty": ("finished", None),
    "no_camera": ("error", "no camera"),
    "no_light": ("finished", "Warning: .*no sun or point or spot or area light"),
    "no_uv": ("finished", "Warning: .*'Plane' has no UV map"),
    "no_uv_matt": ("finished", None),
    "no_uv_textured": ("finished", "Warning: .*'Plane': textures need a UV map"),
    "no_faces": ("finished", None),
    "missing_image": ("finished", "Warning: .*'steel': image file not found: .*gone.png"),
    "missing_normal_map": ("finished", "Warning: .*'steel': image file not found: .*gone.exr"),
    "broken_image": ("finished", "Warning: .*'steel': image 'broken.png' cannot be read: .*broken.png"),
    "no_image": ("finished", "Warning: .*'steel': 'Image Texture' has no image"),
    "eight_bit_normal_map": ("finished", "'bytes' has colour space 'sRGB': set it to Non-Color"),
    "blunt_eight_bit_normal_map": ("finished", None),
    "no_uv_area": ("finished", "Warning: .*'Plane': its UV map has no area: its tangent is the object's X axis"),
    "steep_normal_map": ("finished", "Warning: .*'steel': normal map 'steep' turns normals by more than 50 degrees in 10 % of it"),
    "less_steep_normal_map": ("finished", None),
    "bump_node": ("finished", "Warning: .*'steel': Height: 'Wireframe'.* not supported"),
    "sky_color": ("finished", "Warning: .*'steel': Color: 'Sky Texture'.* not supported"),
    "ies": ("finished", "Warning: .*'steel': 'IES Texture': it has no text; 100 for all"),
    "cycle": ("finished", None),
    "deep_nodes": ("finished", None),
    "too_many_nodes": ("finished", "Warning: .*'steel': its nodes are too many at once"),
    "other_uv_map": ("finished", "Warning: .*'Plane': no UV map 'elsewhere'"),
    "no_material": ("finished", None),
    "principled": ("finished", "Warning: .*'plain': 'Principled BSDF': Subsurface.* is not supported"),
    "displaced": ("finished", "Warning: .*'steel': displacement of the surface itself is not supported"),
    "light_linking": ("finished", None),
    "subsurface": ("finished", "Warning: .*'Subsurface Scattering': light below the surface is not supported"),
    "cloth_without_uv": ("finished", "Warning: .*'Plane': textures need a UV map"),
    "mixed": ("finished", None),
    "volume": ("finished", "Warning: .*'steel': volumes are not supported; left out"),
    "volume_alone": ("finished", "Warning: .*'steel': volumes are not supported; left out"),
    "hair": ("finished", "Warning: .*'Hair BSDF' is not supported; shaded as a Diffuse BSDF"),
    "no_shader": ("finished", "Warning: .*no shader .its surface has none"),
    "many_shaders": ("finished", "Warning: .*its 10 shaders are more than 8"),
    "flat_lights": ("finished", None),
    "no_strength": ("error", "libshade: light 'broken lamp': intensity must be"),
    "no_threshold": ("error", "adaptive_threshold must be"),
    "curve_of_no_number": ("error", "'steel': f0 must be a sequence of 3 finite numbers"),
    "portal": ("finished", "Warning: .*'area': portals are not supported; left out"),
    "cycles_alone": ("finished", r"Fast GI Approximation is not supported; left out"),
    "world_volume": ("finished", "Warning: .*world 'world': volumes are not supported; left out"),
    "world_shader": ("finished", "Warning: .*world 'world': 'Diffuse BSDF' does not shine; black"),
    "world_without_image": ("finished", "Warning: .*world 'world': 'Environment Texture' has no image"),
    "world_of_nothing": ("finished", None),
    "blind": ("error", "'camera' sees nothing"),
    "flat_object": ("finished", None),
    "vanished_object": ("finished", None),
    "nowhere": ("finished", "Warning: .*'lost': its place is not a number; left out"),
    "not_a_number": ("finished", "Warning: .*'Plane': some of its vertices have no valid position"),
    "slot_out_of_range": ("finished", None),
    "extreme_exponents": ("finished", None),
    "huge": ("error", "libshade: out of memory: 65536 × 65536 pixels and their passes take 12,544 GiB"),
    "one_pixel": ("finished", None),
    "text_and_curve": ("finished", None),
}


@pytest.fixture(scope="module")
def cases(blender, tmp_path_factory):
    """(all cases of one version in one run: name → (end, text), folder of pictures)"""
    folder = tmp_path_factory.mktemp("bad_input")
    text = blender.inside("bad_input.py", folder)
    found = re.findall(r"^CASE (\w+)\n(.*?)^END (\w+)$", text, re.M | re.S)
    return {name: (end, said) for name, said, end in found}, folder


def test_every_case_has_run(cases):
    assert set(cases[0]) == set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_case(cases, name):
    ran, folder = cases
    (end, said), (expected_end, expected) = ran[name], EXPECTED[name]
    assert end == expected_end, said
    assert "internal error" not in said and "Traceback" not in said, said
    if expected:
        assert re.search(expected, said), said
    if end == "finished":
        assert np.isfinite(rgba(folder / f"{name}.exr")).all()


@pytest.mark.parametrize("name, rows", {
    "fine": [],
    "less_steep_normal_map": [],
    "blind": ["True|camera|"],
    "no_light": ["False||"],
    "no_uv_textured": ["False|Plane|"] * 2,
    "no_image": ["False|steel|Image Texture"],
    "bump_node": ["False|steel|Wireframe"],
    "no_strength": ["True|broken lamp|"],
    "portal": ["False|area|"],
    "cycles_alone": ["False||"],
    "world_shader": ["False|world|Diffuse BSDF"],
    "nowhere": ["False|lost|"],
}.items())
def test_the_panel_says_whose_it_is(cases, name, rows):
    assert re.findall(r"^ROW (.*)$", cases[0][name][1], re.M) == rows


def metal(ex, ey, color):
    """Ashikhmin and Shirley's lobe at its peak, under a sun of strength 3."""
    return 3 * math.sqrt((ex + 1) * (ey + 1)) / (8 * math.pi) * np.array(color)


STEEL = metal(6, 2, (0.9, 0.6, 0.3))
# what stands in for what cannot be rendered, at the picture's centre
FALLBACK = {
    "fine": STEEL, "no_uv": STEEL, "bump_node": STEEL, "sky_color": STEEL,
    "other_uv_map": STEEL, "deep_nodes": STEEL, "nowhere": STEEL, "slot_out_of_range": STEEL,
    "no_light": np.zeros(3),
    "no_uv_textured": metal(6, 2, (0.2, 0.4, 0.6)),
    "ies": metal(6, 2, (0.2, 0.4, 0.6)), "cycle": metal(6, 2, (0.9, 0.6, 0.3)),
    "too_many_nodes": np.full(3, 3 * 0.8 / math.pi),
    "no_material": np.full(3, 3 * 0.8 / math.pi),
    "missing_image": metal(6, 2, (1, 0, 1)), "broken_image": metal(6, 2, (1, 0, 1)),
    "subsurface": np.full(3, 3 * 0.8 / math.pi), "light_linking": STEEL, "displaced": STEEL,
    "volume": STEEL,
    "mixed": STEEL / 2, "hair": np.full(3, 3 * 0.8 / math.pi), "many_shaders": STEEL,
    "no_shader": np.zeros(3),
}


# In 5.0 a new Principled BSDF: the peak of GGX of alpha .25 on a clear body of .04, the rest matt.
NEW = np.full(3, 3 * (0.8 / math.pi * 0.96 + 0.04 / (4 * math.pi * 0.25**2)))


@pytest.mark.parametrize("name", FALLBACK)
def test_what_stands_in_for_it(blender, cases, name):
    middle = rgba(cases[1] / f"{name}.exr")[11:13, 15:17]
    expected = NEW if name == "no_material" and blender.version > "4" else FALLBACK[name]
    assert middle[..., :3] == pytest.approx(np.broadcast_to(expected, (2, 2, 3)), rel=0.01)
    assert (middle[..., 3] == 1).all()


@pytest.mark.parametrize("name", ["flat_object", "vanished_object"])
def test_what_has_no_area_is_not_seen(cases, name):
    assert not rgba(cases[1] / f"{name}.exr").any()


def test_a_volume_alone_is_seen_through(cases):
    assert np.abs(rgba(cases[1] / "volume_alone.exr")).max() < 1e-6


def test_tangents_matter_to_grooves_only(cases):
    assert "Warning" not in cases[0]["no_uv_matt"][1]


def test_linking_of_what_does_not_shine_is_nothing(cases):
    assert "linking" not in cases[0]["light_linking"][1].replace("light_linking", "")


def test_eight_bits(cases):
    assert "'bytes' has 8 bits" in cases[0]["eight_bit_normal_map"][1]


def test_a_world_that_is_left_out_is_black(cases):
    picture = rgba(cases[1] / "world_shader.exr")
    assert picture[0, 0].tolist() == [0, 0, 0, 1] and picture[12, 16, :3].max() > 0


def test_unwritable_dump(blender, tmp_path):
    """The dump cannot be written: an error that names the file."""
    path = tmp_path / "no such folder" / "dump.exr"
    told, _text = blender.scene("unrendered", tmp_path, dump=str(path), what="plane")
    assert "Error: libshade: " in told["error"] and str(path) in told["error"]
