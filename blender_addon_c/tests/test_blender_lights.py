# SPDX-License-Identifier: GPL-3.0-or-later
"""Each light alone, and worlds, against the Cycles of the same Blender."""

import re

import numpy as np
import pytest

from blender_runs import ENGINES, averaged, by_each, by_turns, rgba

COST = 86

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


def profile(vertical, horizontal, candela, head="TILT=NONE\n1 -1 1", kind=1, tail="2 0 0 0\n1 1 60"):
    """A photometric file (LM-63)."""
    def numbers(row):
        return " ".join(f"{x:g}" for x in row)
    return "\n".join(["IESNA:LM-63-2002", "[TEST] of ours", f"{head} {len(vertical)} {len(horizontal)} {kind} {tail}",
                      numbers(vertical), numbers(horizontal), *map(numbers, candela), ""])


def some_candela(down, about):
    """Of a lamp that shines aslant."""
    return np.array([[60 + 500 * (1 - d / 90) ** 2 + (0 if d == 0 else 2 * d * np.cos(np.radians(h) / 2) ** 2) for d in down]
                     for h in about])


DOWN, ABOUT = (0, 15, 30, 45, 60, 75, 90), (0, 45, 90, 135, 180)
LAMP = profile(DOWN, ABOUT, some_candela(DOWN, ABOUT))
LIGHTS |= {
    "lamp's profile": ("POINT", {"energy": 10, "shadow_soft_size": 0}, {"pattern": {"profile": LAMP}}),
    "soft profile": ("POINT", {"energy": 10, "shadow_soft_size": 0.3}, {"pattern": {"profile": LAMP}}),
    "ball's profile": ("POINT", {"energy": 10, "shadow_soft_size": 0.3, "use_soft_falloff": False}, {"pattern": {"profile": LAMP}}),
    "spot's profile": ("SPOT", {"energy": 10, "spot_size": 2.5, "shadow_soft_size": 0.1}, {"pattern": {"profile": LAMP}}),
    "area's profile": ("AREA", {"energy": 10, "size": 0.5}, {"pattern": {"profile": LAMP}}),
    **{f"{kind} by {by}": (kind.upper(), {"energy": 800, "shadow_soft_size": 0.2} if kind != "area" else
                                                  {"energy": 200, "size": 0.5}, {"pattern": {"by": by}})
       for kind, by in (("point", "TexCoord.Normal"), ("point", "NewGeometry.Normal"), ("spot", "NewGeometry.Incoming"),
                        ("area", "NewGeometry.Incoming"), ("point", "TexCoord.Object"))},
    "scaled profile": ("POINT", {"energy": 10, "shadow_soft_size": 0.1}, {"pattern": {"profile": LAMP}, "scale": (2, 1, 0.5)}),
    "scaled by normal": ("SPOT", {"energy": 800, "spot_size": 2.5}, {"pattern": {"by": "TexCoord.Normal"}, "scale": (-1, 3, 2)}),
    "scaled area's profile": ("AREA", {"energy": 10, "size": 0.5}, {"pattern": {"profile": LAMP}, "scale": (2, 1, 0.5)}),
    **{f"face by {by}": ("AREA", {"energy": 200, "shape": "ELLIPSE", "size": 1.5, "size_y": 1}, {"pattern": {"by": by}, "scale": (1, 1.3, 2)})
       for by in ("NewGeometry.Parametric", "NewGeometry.Position", "TexCoord.Object", "TexCoord.Generated", "TexCoord.UV")},
    **{f"{kind}, {how[0]} {how[1]}": (kind.split()[-1].upper(), {"energy": 80, **size}, {"pattern": {"falls": how}})
       for kind, size, how in (
           ("point", {"shadow_soft_size": 0}, ("Constant", 0)), ("soft point", {"shadow_soft_size": 0.6}, ("Linear", 0.7)),
           ("spot", {"shadow_soft_size": 0.3, "spot_size": 2}, ("Linear", 0)), ("area", {"size": 1}, ("Constant", 2)),
           ("wide area", {"size": 1}, ("Quadratic", 1.5)))},
    "ball falls": ("POINT", {"energy": 80, "shadow_soft_size": 0.6, "use_soft_falloff": False}, {"pattern": {"falls": ("Linear", 0.7)}}),
    "ball by normal": ("POINT", {"energy": 200, "shadow_soft_size": 0.4, "use_soft_falloff": False},
                       {"pattern": {"by": "TexCoord.Normal"}}),
}
NOISY = ("shining mesh", "turned image", "bent image", "mirror ball", "square", "rectangle", "scaled area's profile")
LATER = {"ball's profile": "4", "ball falls": "4", "ball by normal": "4", "ball": "4", "for its area": "4.5"}  # the version that brought it


@by_turns("name", LIGHTS, lambda name: name in ("sun", "point", "soft spot", "square", *LATER) or "scale" in (*LIGHTS[name], {})[2])
def test_light(blender, tmp_path, name):
    if blender.version < LATER.get(name, ""):
        pytest.skip("this version has no such light")
    samples = 256 if "sp" in name else 128 if name in NOISY else 64  # of spots and slats some reaches the floor by the ball only
    compare(blender, tmp_path, name, samples, (*LIGHTS[name], {})[:3])


BY_CAMERA = {"shaders": "turned image", "colors": "turned image", "colors of a colour": "world", "strengths": "world", "dimmed": "turned image"}


@by_turns("name, panes", [*((name, ()) for name in BY_CAMERA), *((name, ("glass paper",)) for name in ("colors of a colour", "dimmed"))])
def test_the_camera_sees_another_world(blender, tmp_path, name, panes):
    """By Is Camera Ray, through panes too; what lights the scene is as it was."""
    light, settings, more = LIGHTS[BY_CAMERA[name]]
    compare(blender, tmp_path, name, 128 if more.get("image") else 64, (light, settings, {  # a colour has little noise
        **more, "by camera": name.split()[0], **({"panes": panes} if panes else {})}))


@by_turns("way, world", [(way, world) for world in ("world", "turned image") for way in ("Is Diffuse Ray", "Is Glossy Ray", "Is Reflection Ray")])
def test_rays_see_another_world_by_their_way(blender, tmp_path, world, way):
    """Samples of its light see it as it is; of one colour none are drawn. An image with lamps and a colour share
    them, by densities of cells that are not Cycles' own."""
    light, settings, more = LIGHTS[world]
    samples, mean = (384, 0.01) if more.get("image") else (64, 0.005)
    told = compare(blender, tmp_path, f"{world}, {way}", samples, (light, settings, {**more, "by way": way}), mean=mean)
    assert "Light Path" not in told


ALL_PANES = ["glass paper", "half there", "holes"]
PANES = {
    "sun": ("SUN", {"energy": 3, "angle": 0}), "point": LIGHTS["point"],
    "square": LIGHTS["square"], "turned image": LIGHTS["turned image"],
    "one pass": ("SUN", {"energy": 3, "angle": 0}, {"passes": 1}),
    "full shadow": ("SUN", {"energy": 3, "angle": 0.5}, {"full": True}),
}


@by_turns("name", PANES, lambda name: name == "full shadow")
def test_light_through_panes(blender, tmp_path, name):
    light, settings, more = (*PANES[name], {})[:3]
    if more.get("full") and blender.version < "4":
        pytest.skip("named in Blender 3.4")
    samples = 256 if name in ("square", "turned image") else 128
    compare(blender, tmp_path, name, samples, (light, settings, {**more, "panes": ALL_PANES}))


HIDDEN = {
    "lamp, glossy": ("square", "lamp", ["glossy", "camera"]), "world, glossy": ("turned image", "world", ["glossy"]),
    "faces, diffuse": ("shining mesh", "lamp", ["diffuse"]),
    "ball, shadow": ("soft point", "ball", ["shadow"]),
    "ball, camera": ("soft point", "ball", ["indirect only"]),
}


@by_turns("name", HIDDEN)
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


@by_turns("name", SHORTCUTS)
def test_shortcuts(blender, tmp_path, name):
    light, given, more = SHORTCUTS[name]
    kind, settings = LIGHTS.get(light) or ("SUN", {"energy": 3, "angle": 0.02})
    case = kind, settings, {**more, "given": given}
    compare(blender, tmp_path, name, 256 if name == "adaptive" else 128, case, rows=np.s_[4:])  # the floor: no highlights


def compare(blender, tmp_path, name, samples, case, rows=np.s_[:], mean=0.005):
    light, settings, more = case
    _, told = blender.scene("lit", tmp_path, dump="", engines=ENGINES, samples=samples, light=light,
                            settings=settings, **more)
    theirs, ours = (p[rows] for p in by_each(tmp_path, averaged))
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"{name}: relative error {apart:.4f}, mean {ours.mean() / theirs.mean():.4f} of {theirs.mean():.3f}")
    assert theirs.mean() > 0.05
    assert abs(ours.mean() / theirs.mean() - 1) <= mean
    assert apart <= 0.02
    return told


def test_a_world_alone(blender, tmp_path):
    """A scene without a face is its world, pixel by pixel."""
    blender.scene("lit", tmp_path, dump="", engines=ENGINES, samples=64, light=None, empty=True,
                  image="EQUIRECTANGULAR", mapping={"type": "POINT", "Rotation": (1.5, 0.2, 0.3)})
    theirs, ours = by_each(tmp_path, averaged)
    assert theirs.std() > 0.1
    np.testing.assert_allclose(ours, theirs, rtol=0.05, atol=0.02)


def linked_apart(blender_new, folder, samples, **scene):
    """By how much our picture of linked lights is apart from Cycles', over its mean."""
    pictures = []
    for engine in "LIBSHADE", "CYCLES":
        _, text = blender_new.scene("linked", folder, dump="", engine=engine, samples=samples, **scene)
        assert "linking" not in text
        pictures.append(averaged(folder / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"relative error {apart:.4f}, means {ours.mean((0, 1))} {theirs.mean((0, 1))}")
    return apart


@pytest.mark.parametrize("more, radius", [(0, 0.0), (4, 0.5)])
@pytest.mark.parametrize("shades", [False, True])
def test_lights_for_some_objects(blender_new, tmp_path, more, radius, shades):
    """All lamps at the first surface, and one of many, soft ones; or which objects shade them."""
    assert linked_apart(blender_new, tmp_path, 192, more=more, radius=radius, shades=shades) < 0.012


@pytest.mark.parametrize("shades, shines, samples", [(False, "evenly", 256), (True, "evenly", 256), (False, "unevenly", 384)])
def test_plates_that_shine_for_some_objects(blender_new, tmp_path, shades, shines, samples):
    """Or that some shade; beside a lamp for all, seen in a polished ball, too."""
    assert linked_apart(blender_new, tmp_path, samples, more=0, radius=0.5, shades=shades, shines=shines) < 0.02


def test_uneven_light_that_some_shade_is_named(blender_new, tmp_path):
    _, text = blender_new.scene("linked", tmp_path, dump="", engine="LIBSHADE", samples=1, more=0, radius=0.5, shades=True,
                              shines="unevenly")
    assert text.count("shadow linking of what shines unevenly") == 2


TILTED = "TILT=INCLUDE\n1\n3\n0 45 90\n1 .5 .25\n1 1000 .5"
ALL_DOWN = tuple(range(0, 181, 20))
PROFILES = {
    "even": profile((0, 30, 60, 90), (0,), [[100, 80, 50, 10]]),
    "quarter": profile(ALL_DOWN, (0, 30, 90), some_candela(ALL_DOWN, (0, 60, 200))),
    "half": LAMP,
    "from 90": profile(DOWN, (90, 180, 270), some_candela(DOWN, ABOUT[:3])),
    "whole": profile(ALL_DOWN, (0, 60, 170, 360), some_candela(ALL_DOWN, (0, 100, 220, 0))),
    "open": profile(ALL_DOWN, (0, 120, 240), some_candela(ALL_DOWN, (0, 120, 280))),
    "tilt": profile(DOWN, (0,), [[5, 4, 3, 4, 5, 2, 1]], TILTED),
    "factors": profile(DOWN, (0,), [[5, 4, 3, 4, 5, 2, 1]], "TILT=NONE\n3 1000 2", tail="1 .1 .2 .3\n.9 .8 60"),
    "commas": profile(DOWN, (0,), [[5, 4, 3, 4, 5, 2, 1]]).replace(" ", ","),
    "below 0": profile((0, 90, 180), (0,), [[100, -200, 300]]),
    "type B": profile((-90, 0, 90), (-90, 0, 90), [[100, 200, 300], [10, 20, 30], [1, 2, 3]], kind=2),
    "one angle": profile((0,), (0,), [[100]]),
    "a type that is none": profile((0, 90), (0,), [[100, 50]], kind=9),
    "cut": LAMP[:-40], "no file": "hello", "empty": "",
}
UNREADABLE = {  # text: what is told
    LAMP.replace("1 -1 1 7 5", "1 -1 1 1e300 5"): "the number of vertical angles is 1000000.*; expected 1 or more",
    LAMP.replace("1 -1 1 7 5", "1 -1 1 1000000 1000000"): "1000000 times 1000000 angles; 1048576 are supported",
    LAMP.replace("1 -1 1 7 5", "1 -1 1 0 5"): "the number of vertical angles is 0; expected 1 or more",
    LAMP.replace("1 -1 1 7 5", "1 -1 1 7 -5"): "the number of horizontal angles is -5; expected 1 or more",
    LAMP.replace("1 -1 1 7 5", "1 -1 nan 7 5"): "line 4: the multiplier was expected, not 'nan'",
    LAMP.replace("0 15 30", "0 15 15"): "the vertical angles do not rise",
    LAMP.replace("TILT=NONE", "TILT=INCLUDE\n1\n999999"): "it ends where a tilt angle or factor was expected",
    "TILT=": "it ends where the number of lamps or lumens was expected",
}
PROFILES_LATER = {"up": profile((90, 135, 180), (0,), [[100, 50, 20]]), "between": profile((30, 90, 150), (0,), [[100, 50, 20]]),
                  "type A": profile((-90, 0, 90), (-90, 0, 45, 90), [[100, 200, 300], [10, 20, 30], [1, 2, 3], [50, 60, 70]], kind=3)}


def test_photometric_files(blender, tmp_path):
    """What the IES Texture says of directions, beside the angles where a file ends: in 3.4, too, of what it does not show."""
    given = {**PROFILES, **PROFILES_LATER}
    shown = {}
    for engine in "LIBSHADE", "CYCLES":
        _, text = blender.scene("profiles", tmp_path, dump="", engine=engine, lattice=(36, 18), profiles=list(given.values()))
        shown[engine] = rgba(tmp_path / "picture.exr")[..., 0].reshape(-1, 18, 36)
        if engine == "LIBSHADE":
            assert "ends where a candela value was expected" in text and "no line that begins with TILT=" in text
    for name, ours, theirs in zip(given, shown["LIBSHADE"][::-1], shown["CYCLES"][::-1]):
        if name == "cut":  # Cycles reads on behind its end, where now and then there are numbers
            theirs = np.full_like(ours, 100.0)
        off = np.abs(ours - theirs).max() / max(theirs.max(), 1)
        print(f"{name}: {off:.5f} of {theirs.max():.3f}")
        assert off < 0.004, name


def test_photometric_files_that_cannot_be_read(blender, tmp_path):
    """They are named, and say 100 wherever one looks; numbers that are too large end somewhere."""
    large = profile((0, 90), (0,), [[1e308, -1e308]], "TILT=NONE\n1 -1 1e308")
    _, text = blender.scene("profiles", tmp_path, dump="", engine="LIBSHADE", lattice=(4, 4), profiles=[*UNREADABLE, large])
    for told in UNREADABLE.values():
        assert re.search(f"Warning: .*'profile.*{told}; 100 for all directions", text), told
    shown = rgba(tmp_path / "picture.exr")[..., 0].reshape(-1, 4, 4)[::-1]
    np.testing.assert_allclose(shown[:-1], 100, rtol=1e-6)
    assert np.isfinite(shown).all()
