# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes beside the picture, by view layer, in a multilayer file."""

import json
import math
import re

import numpy as np
import OpenImageIO as oiio
import pytest

from blender_runs import ENGINES, measured, read_picture
from test_blender_closures import cases_of

COST = 16

WANTED = ("z", "position", "normal", "uv", "object_index", "material_index", "mist",
          "vector")


def test_passes_of_two_view_layers(blender, tmp_path):
    told, text = blender.scene("passes", tmp_path, dump="", passes=WANTED)
    names, pixels = read_picture(tmp_path / "picture.exr")
    full, empty = ({name.split(".", 1)[1]: pixels[..., k] for k, name in enumerate(names)
                    if name.startswith(layer + ".")} for layer in told["layers"])
    indices = [f"{name}.X" for name in (("IndexOB", "IndexMA") if blender.version < "5" else
                                        ("Object Index", "Material Index"))]
    assert set(full) == set(empty) >= {"Depth.Z", "Position.X", "Normal.Z", "UV.U", "UV.A", *indices,
                                       "Combined.A"}
    assert (empty["Combined.A"] == 0).all() and (empty["Depth.Z"] == 1e10).all()
    assert all((full[f"Vector.{axis}"] == 0).all() for axis in "XYZW") and "are not rendered" not in text
    # pixels that the plate covers; each looks along -z, from (x, y, 3)
    whole = full["Combined.A"] == 1
    assert 20 < whole.sum() < 80 and (full["Depth.Z"][full["Combined.A"] == 0] == 1e10).all()
    x, z = full["Position.X"], full["Position.Z"]
    middle = (np.arange(16) + 0.5) / 8 - 1
    assert (abs(x - middle)[whole] <= 1 / 16 + 1e-6).all()  # its first sample, not its middle
    assert (abs(full["Position.Y"] + middle[:, None])[whole] <= 1 / 16 + 1e-6).all()
    np.testing.assert_allclose(z[whole], (1 - math.tan(0.5) * x)[whole], atol=1e-6)
    np.testing.assert_allclose(full["Depth.Z"][whole], (3 - z)[whole], atol=1e-6)
    # no world: 0 to 100 metres
    np.testing.assert_allclose(full["Mist.Z"][whole], (full["Depth.Z"] / 100)[whole], atol=1e-3)
    assert (empty["Mist.Z"] == 1).all()
    for axis, value in zip("XYZ", (math.sin(0.5), 0, math.cos(0.5))):
        np.testing.assert_allclose(full[f"Normal.{axis}"][whole], value, atol=1e-6)
    # u is the mean over the pixel, so that of its middle, but for the samples' own
    np.testing.assert_allclose(full["UV.U"][whole],
                               np.broadcast_to(0.5 + middle / math.cos(0.5), (16, 16))[whole], atol=0.01)
    assert (full["UV.A"][whole] == 1).all()
    assert (full[indices[0]][whole] == 7).all() and (full[indices[1]][whole] == 3).all()
    assert (empty[indices[0]] == 0).all()


KINDS = {"3.4": ("Diff", "Gloss", "Trans"), "5.0": ("Diffuse ", "Glossy ", "Transmission ")}
PARTS = {"3.4": ("Dir", "Ind", "Col"), "5.0": ("Direct", "Indirect", "Color")}
SEEN = {"3.4": ("Emit", "Env"), "5.0": ("Emission", "Environment")}
LIGHT = (*(f"{kind}_{part}" for kind in ("diffuse", "glossy", "transmission")
           for part in ("direct", "indirect", "color")), "emit", "environment")
NAMES = tuple(f"cryptomatte_{kind}" for kind in ("object", "material", "asset"))
BALLS = ("diffuse", "glossy", "glass", "translucent", "half there", "mixed", "added", "metallic",
         "half metallic", "clear")
SIDE = 24
# What denoising data are the same of: Cycles follows mirrors and what is clear to what they show, and
# 3.4 knows that metals are brighter towards their rims.
FIRST = ("diffuse", "glossy", "translucent", "mixed", "added")


def _words(blender):
    return "3.4" if blender.version < "5" else "5.0"


def by_pass(names, pixels):
    """{pass: height x width x channels} of a file's only layer; of four channels three."""
    place = {name.split(".", 1)[1]: k for k, name in enumerate(names)}
    channels = {}
    for name in place:
        channels.setdefault(name.rsplit(".", 1)[0], []).append(name.rsplit(".", 1)[1])
    return {name: pixels[..., [place[f"{name}.{end}"] for end in ends if end != "A"]].astype(float)
            for name, ends in channels.items()}


def coverage(picture, kind):
    """{number of a name: how much of each pixel shows it}."""
    found = {}
    for layer in range(3):
        pixels = picture[f"Crypto{kind}{layer:02}"]
        for pair in (0, 2):
            for name in np.unique(pixels[..., pair][pixels[..., pair + 1] > 0]):
                there = np.where(pixels[..., pair] == name, pixels[..., pair + 1], 0)
                found[name] = found.get(name, 0) + there
    return found


def check_mattes(pictures, headers):
    """The same names cover as much as in Cycles, and a file says what these are."""
    for kind in ("Object", "Material", "Asset"):
        ours, theirs = (coverage(picture, kind) for picture in pictures)
        assert set(ours) == set(theirs) and len(ours) == len(BALLS) + 1
        for name, pixels in theirs.items():
            assert abs(ours[name].mean() - pixels.mean()) < 0.01 * pixels.mean()
            assert np.abs(ours[name] - pixels).mean() < 0.05 * pixels.mean()
    ours, theirs = ({field.name: field.value for field in header.extra_attribs
                     if field.name.startswith("cryptomatte/")} for header in headers)
    assert set(ours) == set(theirs) and len(ours) == 12
    for key, value in ours.items():
        if not key.endswith("manifest"):
            assert value == theirs[key]
            continue
        assert json.loads(value).items() <= json.loads(theirs[key]).items()  # it lists what is hidden, too
        assert len(json.loads(value)) == len(BALLS) + 1


def test_passes_are_those_of_cycles(blender, tmp_path):
    """Balls and a floor under a sky and a sun: names, and what each pass adds to the picture; light alone is exposed."""
    cases = [case for case in cases_of(measured(blender.version)) if case["name"] in BALLS]
    _, text = blender.scene("balls", tmp_path, dump="", cases=cases, engines=("LIBSHADE", "CYCLES"), samples=256,
                            passes=(*WANTED, *LIGHT, *NAMES), floor=(0.6, 0.3, 0.2, 1), exposure=1.25)
    if blender.version < "5":  # which prints no status by itself
        said = re.search(r"\| Mem:([\d.]+)M, Peak:([\d.]+)M \| Rendering \| Sample \d+/256", text)
        assert said and 1 < float(said.group(1)) <= float(said.group(2)) < 100, text
    theirs, ours = (tmp_path / f"{engine}.exr" for engine in ENGINES)
    files = [read_picture(path) for path in (ours, theirs)]
    headers = [oiio.ImageBuf(str(path)).spec() for path in (ours, theirs)]
    left = () if blender.version < "5.2" else ("Denoising Specular Albedo", "Denoising Roughness")  # named
    # from 5.2 on Cycles' albedo is without what is glossy, and the sky far away, not at 0 (docs/results/blender.md)
    other = ("Denoising Albedo", "Denoising Depth") if left else ()
    assert all(name in text for name in left)
    assert files[0][0] == [name for name in files[1][0] if name.split(".")[1] not in left]  # layers, passes and channels, in their order
    pictures = [by_pass(*file) for file in files]
    check_mattes(pictures, headers)
    behind = pictures[1][SEEN[_words(blender)][1]].max(-1) > 0
    for picture in pictures:  # there Cycles takes the sky's colour for data
        picture["Denoising Albedo"][behind] = 0
    kinds, parts, seen = (names[_words(blender)] for names in (KINDS, PARTS, SEEN))
    for picture in pictures:
        for kind in kinds:
            for part in parts[:2]:
                picture[kind + part] *= picture[kind + parts[2]]
        np.testing.assert_allclose(
            sum(picture[kind + part] for kind in kinds for part in parts[:2])
            + sum(picture[name] for name in seen), picture["Combined"], rtol=1e-4, atol=1e-5)
    far = []
    for column, case in enumerate(cases):
        ours, theirs = ({name: p[:, SIDE * column:SIDE * (column + 1)].mean()
                         for name, p in picture.items()} for picture in pictures)
        whole = theirs["Combined"]
        for name, mean in theirs.items():
            if name.startswith("Crypto") or name in (*left, *other) or (name.startswith("Denoising") and case["name"] not in FIRST):
                continue
            off = abs(ours[name] - mean) / (abs(mean) + 0.1 * whole)
            # of one sample a pixel those at the rims are chance
            if off > (0.03 if name in ("Depth", "Position", "UV") else 0.01):
                far.append((case["name"], name, ours[name], mean, off))
    assert not far, '\n'.join(map(str, far))


def test_denoise_node(blender_new, tmp_path):
    """Blender's own node on our passes, and the picture as it was beside the one that is denoised."""
    def picture(samples, **options):
        blender_new.scene("first_minute", tmp_path, dump="", engine="LIBSHADE", floor=True, samples=samples,
                        **options)
        names, pixels = read_picture(tmp_path / "picture.exr")
        return names, pixels[..., :3].astype(float)

    (_, noisy), (_, clean), (_, many) = picture(4), picture(4, compositor=True), picture(192)
    before, after = (((p - many) ** 2 / (many**2 + 1e-3)).mean() for p in (noisy, clean))
    print(f"error of 4 samples {before:.4f}, after the node {after:.4f}")
    assert after < before / 4 and abs(clean.mean() / noisy.mean() - 1) < 0.01
    picture(4, denoise=True, multilayer=True)
    kept = by_pass(*read_picture(tmp_path / "picture.exr"))
    np.testing.assert_allclose(kept["Noisy Image"], noisy, rtol=1e-4, atol=1e-5)
    assert ((kept["Combined"] - many) ** 2 / (many**2 + 1e-3)).mean() < before / 4


def test_cryptomatte_node(blender_new, tmp_path):
    blender_new.scene("picked", tmp_path, dump="", who="right")
    matte = read_picture(tmp_path / "picture.exr")[1][..., 0]
    assert (matte[4:12, :8] == 0).all() and (matte[4:12, 8:] == 1).all() and (matte[:4] == 0).all()


@pytest.mark.parametrize("kind", ["Object", "Material", "Asset"])
def test_mattes_are_those_of_cycles(mattes, kind):
    """The same numbers stand for the same names, and each covers the same of every pixel, but for noise."""
    theirs, ours = (covers(picture, kind) for picture in mattes)
    assert set(theirs) == set(ours) and len(ours) == (3 if kind == "Asset" else 4)
    for number, there in theirs.items():
        assert np.abs(there - ours[number]).mean() < 0.03 * there.mean()
        assert abs(there.sum() - ours[number].sum()) < 0.01 * there.sum()


@pytest.fixture(scope="module")
def mattes(blender, tmp_path_factory):
    folder, pictures = tmp_path_factory.mktemp("mattes"), []
    for engine in ("CYCLES", "LIBSHADE"):
        blender.inside("mattes.py", folder / f"{engine}.exr", engine)
        pictures.append(read_picture(folder / f"{engine}.exr"))
    return pictures


def covers(picture, kind):
    """By the number of a name, how much of each pixel is its."""
    names, pixels = picture
    found = {}
    for layer in range(3):
        r, g, b, a = (next(i for i, name in enumerate(names) if f"Crypto{kind}{layer:02}." in name and name[-1].lower() == part)
                      for part in "rgba")
        for slot, share in ((r, g), (b, a)):
            numbers = np.ascontiguousarray(pixels[..., slot]).view(np.uint32)
            for number in np.unique(numbers):
                mine = np.where(numbers == number, pixels[..., share], 0)
                found[int(number)] = found.get(int(number), 0) + mine
    return {number: cover for number, cover in found.items() if cover.sum() > 1e-3}
