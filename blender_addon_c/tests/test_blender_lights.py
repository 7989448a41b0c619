# SPDX-License-Identifier: GPL-3.0-or-later
"""Each light alone, and worlds, against the Cycles of the same Blender."""

import numpy as np
import pytest

from test_blender_paths import averaged

LIGHTS = {
    "sun": ("SUN", {"energy": 3, "angle": 0.4}),
    "point": ("POINT", {"energy": 200, "shadow_soft_size": 0}),
    "soft point": ("POINT", {"energy": 200, "shadow_soft_size": 0.5}),
    "ball": ("POINT", {"energy": 200, "shadow_soft_size": 0.5, "use_soft_falloff": False}),
    "spot": ("SPOT", {"energy": 500, "spot_size": 1.3, "spot_blend": 0.4, "shadow_soft_size": 0}),
    "soft spot": ("SPOT", {"energy": 500, "spot_size": 1.3, "spot_blend": 0.4, "shadow_soft_size": 0.4}),
    "squeezed spot": ("SPOT", {"energy": 500, "spot_size": 1.3, "spot_blend": 0.4, "shadow_soft_size": 0},
                      {"scale": (0.6, 1.2, 0.9)}),
    "square": ("AREA", {"energy": 150, "shape": "SQUARE", "size": 1}),
    "rectangle": ("AREA", {"energy": 150, "shape": "RECTANGLE", "size": 1.5, "size_y": 0.3}),
    "disk": ("AREA", {"energy": 150, "shape": "DISK", "size": 1}),
    "ellipse": ("AREA", {"energy": 150, "shape": "ELLIPSE", "size": 1, "size_y": 0.4}, {"scale": (1.5, 1, 1)}),
    "spread": ("AREA", {"energy": 150, "shape": "SQUARE", "size": 1, "spread": 1.5}),
    "for its area": ("AREA", {"energy": 150, "shape": "DISK", "size": 0.7, "normalize": False, "exposure": 1}),
    "shining mesh": ("MESH", {"strength": 20}),
    "world": (None, {}, {"image": ""}),
    "turned image": (None, {}, {"image": "EQUIRECTANGULAR", "mapping": {
        "type": "POINT", "Rotation": (0.4, -0.3, 1)}}),
    "bent image": (None, {}, {"image": "EQUIRECTANGULAR", "mapping": {
        "type": "TEXTURE", "Location": (0.1, 0.2, -0.2), "Rotation": (0, 0.2, 2), "Scale": (1, 0.7, 1.2)}}),
    "left out": ("SUN", {"energy": 3, "angle": 0.4}, {"no sky": True}),
    "mirror ball": (None, {}, {"image": "MIRROR_BALL", "mapping": {"type": "VECTOR", "Rotation": (0, 0, 0.5)}}),
}
LATER = {"ball": "4", "for its area": "4.5"}  # the version that brought it


@pytest.mark.parametrize("name", LIGHTS)
def test_light(blender, tmp_path, name):
    if blender.version < LATER.get(name, ""):
        pytest.skip("this version has no such light")
    samples = 256 if "sp" in name else 128  # of spots and slats some reaches the floor by the ball only
    compare(blender, tmp_path, name, samples, (*LIGHTS[name], {})[:3])


BY_CAMERA = {"shaders": "turned image", "colors": "turned image", "colors of a colour": "world", "strengths": "world"}


@pytest.mark.parametrize("name", BY_CAMERA)
@pytest.mark.parametrize("panes", [(), ("glass paper",)])
def test_the_camera_sees_another_world(blender, tmp_path, name, panes):
    """By Is Camera Ray, through panes too; what lights the scene is as it was."""
    light, settings, more = LIGHTS[BY_CAMERA[name]]
    compare(blender, tmp_path, name, 256, (light, settings, {
        **more, "by camera": name.split()[0], **({"panes": panes} if panes else {})}))


ALL_PANES = ["glass paper", "half there", "holes"]
PANES = {
    "sun": ("SUN", {"energy": 3, "angle": 0}), "point": LIGHTS["point"],
    "square": LIGHTS["square"], "turned image": LIGHTS["turned image"],
    "one pass": ("SUN", {"energy": 3, "angle": 0}, {"passes": 1}),
}


@pytest.mark.parametrize("name", PANES)
def test_light_through_panes(blender, tmp_path, name):
    light, settings, more = (*PANES[name], {})[:3]
    compare(blender, tmp_path, name, 256, (light, settings, {**more, "panes": ALL_PANES}))


HIDDEN = {
    "lamp, glossy": ("square", "lamp", ["glossy", "camera"]), "world, glossy": ("turned image", "world", ["glossy"]),
    "faces, diffuse": ("shining mesh", "lamp", ["diffuse"]),
    "ball, shadow": ("soft point", "ball", ["shadow"]),
    "ball, camera": ("soft point", "ball", ["indirect only"]),
}


@pytest.mark.parametrize("name", HIDDEN)
def test_what_is_hidden(blender, tmp_path, name):
    light, what, kinds = HIDDEN[name]
    light, settings, more = (*LIGHTS[light], {})[:3]
    samples = 512 if name.startswith("faces") else 128
    compare(blender, tmp_path, name, samples, (light, settings, {**more, "hidden": {what: kinds}}))


SHORTCUTS = {
    "blur": ("small lamp", {"blur_glossy": 10.0}, {"roughness": 0.1}),
    "no caustics": ("square", {"caustics_reflective": False}, {"roughness": 0.3}),
    "threshold": ("soft point", {"light_sampling_threshold": 0.5}, {}),
    "adaptive": ("soft point", {"use_adaptive_sampling": True, "adaptive_threshold": 0.03}, {}),
}


@pytest.mark.parametrize("name", SHORTCUTS)
def test_shortcuts(blender, tmp_path, name):
    light, given, more = SHORTCUTS[name]
    kind, settings = LIGHTS.get(light) or ("SUN", {"energy": 3, "angle": 0.02})
    case = kind, settings, {**more, "given": given}
    compare(blender, tmp_path, name, 256, case, rows=np.s_[4:])  # the floor: no highlights


def compare(blender, tmp_path, name, samples, case, rows=np.s_[:]):
    light, settings, more = case
    pictures = []
    for engine in "LIBSHADE", "CYCLES":
        blender.scene("lit", tmp_path, dump="", engine=engine, samples=samples, light=light,
                      settings=settings, **more)
        pictures.append(averaged(tmp_path / "picture.exr"))
    ours, theirs = (p[rows] for p in pictures)
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"{name}: relative error {apart:.4f}, mean {ours.mean() / theirs.mean():.4f} of {theirs.mean():.3f}")
    assert theirs.mean() > 0.05
    assert abs(ours.mean() / theirs.mean() - 1) <= 0.005
    assert apart <= 0.02


def test_a_world_alone(blender, tmp_path):
    """A scene without a face is its world, pixel by pixel."""
    pictures = []
    for engine in "LIBSHADE", "CYCLES":
        blender.scene("lit", tmp_path, dump="", engine=engine, samples=64, light=None, empty=True,
                      image="EQUIRECTANGULAR", mapping={"type": "POINT", "Rotation": (1.5, 0.2, 0.3)})
        pictures.append(averaged(tmp_path / "picture.exr"))
    assert pictures[1].std() > 0.1
    np.testing.assert_allclose(pictures[0], pictures[1], rtol=0.05, atol=0.02)


def linked_apart(blender50, folder, samples, **scene):
    """By how much our picture of linked lights is apart from Cycles', over its mean."""
    pictures = []
    for engine in "LIBSHADE", "CYCLES":
        _, text = blender50.scene("linked", folder, dump="", engine=engine, samples=samples, **scene)
        assert "linking" not in text
        pictures.append(averaged(folder / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"relative error {apart:.4f}, means {ours.mean((0, 1))} {theirs.mean((0, 1))}")
    return apart


@pytest.mark.parametrize("more, radius", [(0, 0.0), (4, 0.5)])
@pytest.mark.parametrize("shades", [False, True])
def test_lights_for_some_objects(blender50, tmp_path, more, radius, shades):
    """All lamps at the first surface, and one of many, soft ones; or which objects shade them."""
    assert linked_apart(blender50, tmp_path, 256, more=more, radius=radius, shades=shades) < 0.012


@pytest.mark.parametrize("shades, shines", [(False, "evenly"), (True, "evenly"), (False, "unevenly")])
def test_plates_that_shine_for_some_objects(blender50, tmp_path, shades, shines):
    """Or that some shade; beside a lamp for all, seen in a polished ball, too."""
    assert linked_apart(blender50, tmp_path, 512, more=0, radius=0.5, shades=shades, shines=shines) < 0.02


def test_uneven_light_that_some_shade_is_named(blender50, tmp_path):
    _, text = blender50.scene("linked", tmp_path, dump="", engine="LIBSHADE", samples=1, more=0, radius=0.5, shades=True,
                              shines="unevenly")
    assert text.count("shadow linking of what shines unevenly") == 2
