# SPDX-License-Identifier: GPL-3.0-or-later
"""The Sky Texture of worlds, against the Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import by_turns, rgba
from test_blender_paths import averaged

COST = 46

NAMES = {"single": ("NISHITA", "SINGLE_SCATTERING"), "multiple": (None, "MULTIPLE_SCATTERING")}
SKIES = {
    "day": {"sun_elevation": 0.6, "sun_rotation": 0.7, "sun_size": 0.3},
    "low": {"sun_elevation": 0.15, "sun_rotation": -0.4, "sun_size": 0.2, "altitude": 500.0, "air_density": 2.0,
            "dust_density": 3.0, "ozone_density": 4.0},
    "dusk": {"sun_elevation": -0.05, "sun_disc": False},
    "past the zenith": {"sun_elevation": 2.3, "sun_rotation": 3.3, "sun_size": 0.3, "sun_intensity": 0.01},
    "high": {"sun_elevation": 0.0, "sun_rotation": 0.5, "sun_size": 0.4, "altitude": 20000.0},
}
FITTED = {
    "clear": {"sky_type": "PREETHAM", "sun_direction": (0.5, 0.9, 0.6), "turbidity": 3.0},
    "haze": {"sky_type": "PREETHAM", "sun_direction": (-0.2, 0.5, 0.1), "turbidity": 8.0},
}
CASES = {f"{sky}, {model}": {**SKIES[sky], "sky_type": model} for model in NAMES for sky in SKIES} | FITTED


def known_to(blender, sky):
    kind = NAMES.get(sky["sky_type"], (sky["sky_type"],) * 2)[blender.version >= "5"]
    if not kind:
        pytest.skip("this version has no such sky")
    return {**sky, "sky_type": kind}


def both(blender, tmp_path, scene, read=rgba, **options):
    pictures = []
    for engine in ("LIBSHADE", "CYCLES"):
        _, text = blender.scene(scene, tmp_path, dump="", engine=engine, **options)
        assert "not supported" not in text
        pictures.append(read(tmp_path / "picture.exr")[..., :3].astype(float))
    return pictures


def apart_of(ours, theirs):
    """Relative to what is there; the ground below the horizon fades to black."""
    return np.abs(ours - theirs).max(-1) / (theirs.max(-1) + 0.01 * theirs.max(-1).mean())


@pytest.mark.parametrize("name", CASES)
def test_directions(blender, tmp_path, name):
    """One a pixel; 16 of 12,288 may be on the other side of the disc's rim."""
    ours, theirs = both(blender, tmp_path, "seen_sky", sky=known_to(blender, CASES[name]))
    off = apart_of(ours, theirs)
    print(f"{name}: mean {off.mean():.5f}, most {np.sort(off.ravel())[-17:]}")
    assert theirs.std() > 0.05 * theirs.mean()
    assert np.sort(off.ravel())[-17] < 0.01 and off.mean() < 0.001


def test_a_turned_sky(blender, tmp_path):
    sky = known_to(blender, {**CASES["day, single"], "sun_disc": False})
    ours, theirs = both(blender, tmp_path, "seen_sky", sky=sky, turn=(0.5, -0.3, 0.8))
    off = apart_of(ours, theirs)
    assert np.sort(off.ravel())[-17] < 0.01 and off.mean() < 0.001


@by_turns("name", ["day, single", "low, multiple", "low, single"])  # multiple: not in 3.4
def test_light(blender, tmp_path, name):
    """With a sun as small as the sun."""
    ours, theirs = both(blender, tmp_path, "under_sky", averaged, samples=256,
                        sky=known_to(blender, {**CASES[name], "sun_size": 0.0095}))
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"{name}: relative error {apart:.4f}, mean {ours.mean() / theirs.mean():.4f} of {theirs.mean():.3f}")
    assert abs(ours.mean() / theirs.mean() - 1) <= 0.005
    assert apart <= 0.02


HUE = {"Hue": 0.6, "Saturation": 0.5, "Value": 0.8}


@by_turns("name", ["day, single", "past the zenith, single", "clear"])
def test_light_through_nodes(blender, tmp_path, name):
    """Of the sky and of a sun as small as the sun, by a picture of both."""
    sky = CASES[name] | ({} if name in FITTED else {"sun_size": 0.0095, "sun_rotation": -1.57})  # the sun's disc lies on the seam
    ours, theirs = both(blender, tmp_path, "under_sky", averaged, samples=256, sky=known_to(blender, sky), hue=HUE)
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"{name}: relative error {apart:.4f}, mean {ours.mean() / theirs.mean():.4f} of {theirs.mean():.3f}")
    assert abs(ours.mean() / theirs.mean() - 1) <= 0.01
    assert apart <= 0.02


def test_worlds_of_nodes(blender, tmp_path):
    """Direction by direction, whatever their nodes make of them; an image twice looked up is off by a part of a texel,
    a mirror ball's behind it by more."""
    for engine in ("LIBSHADE", "CYCLES"):
        _, text = blender.scene("seen_world", tmp_path, dump="", engine=engine)
        assert "libshade: " not in text
        for path in tmp_path.glob("picture.exr.*.exr"):
            path.rename(tmp_path / f"{engine} {path.name.split('.')[2]}")
    names = sorted(path.name.split(" ", 1)[1] for path in tmp_path.glob("CYCLES *"))
    assert len(names) == 9
    for name in names:
        ours, theirs = (rgba(tmp_path / f"{engine} {name}")[..., :3].astype(float) for engine in ("LIBSHADE", "CYCLES"))
        off = np.sort(np.abs(ours - theirs).max(-1).ravel()) / theirs.mean()
        print(f"{name}: mean {off.mean():.5f}, most {off[[-17, -1]]}; {theirs.mean():.3f}, {theirs.std():.3f}")
        assert theirs.std() > 0.05 * theirs.mean()
        assert off.mean() < 0.006 and off[-17] < (0.05 if "ball" in name else 0.02)


def test_noise_of_a_world_is_new_for_each_sample(blender, tmp_path):
    """Numbers even from 0 to 1: their mean's deviation is known."""
    blender.scene("noisy_world", tmp_path, dump="", engine="LIBSHADE", samples=[16, 256])
    for samples in (16, 256):
        seen = rgba(tmp_path / f"picture.exr.{samples}.exr")[..., :3].astype(float)
        assert abs(seen.mean() - 0.5) < 0.01
        assert abs(seen.std() / (12 * samples) ** -0.5 - 1) < 0.1


@pytest.mark.parametrize("kind", ["POINT", "SUN"])
def test_lamps_of_nodes(blender, tmp_path, kind):
    """Of a colour that nodes make."""
    ours, theirs = both(blender, tmp_path, "under_lamp", averaged, samples=16, kind=kind)
    np.testing.assert_allclose(ours.mean((0, 1)), theirs.mean((0, 1)), rtol=0.004)
    assert np.ptp(theirs.mean((0, 1))) > 0.5 * theirs.mean()
