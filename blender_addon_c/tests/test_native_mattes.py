# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomatte: hashes of names against published ones, slots of names against coverage that is known."""

import importlib.util
import json
import struct
from types import SimpleNamespace

import numpy as np
import pytest

from native_scenes import ROOT, finish, native, ortho, scene, square
from test_native_closures import TRANSPARENT, diffuse, of, weighed
from test_native_film import half_covered

COST = 0.15

spec = importlib.util.spec_from_file_location("matte", ROOT / "blender_addon_c/export/matte.py")
names = importlib.util.module_from_spec(spec)
spec.loader.exec_module(names)
KINDS = ("OBJECT", "MATERIAL", "ASSET")


def test_hashes():
    for name, value in {"": 0, "a": 0x3C2569B2, "hello": 0x248BFA47, "hello, world": 0x149BBB7F,
                        "The quick brown fox jumps over the lazy dog": 0x2E4FF723}.items():
        assert names.hash_of(name) == value
    assert names.hash_of("\udcc3\udca4") == names.hash_of("ä")  # bytes count, text or not
    assert struct.pack("<f", names.number_of(0x3C2569B2)) == struct.pack("<I", 0x3C2569B2)
    for odd in (0, 0x7FFFFFFF, 0xFF800000, 0x80000001):  # 0, NaN, infinity, too small
        number = names.number_of(odd)
        assert np.isfinite(np.float32(number)) and abs(number) >= np.finfo(np.float32).tiny
        assert np.float32(number).view(np.uint32) & 0x807FFFFF == odd & 0x807FFFFF


def test_header():
    asked = [SimpleNamespace(plane=f"{kind}_MATTE{layer:02}") for kind in ("OBJECT", "MATERIAL") for layer in (0, 1)]
    mattes = names.Mattes(asked)
    assert mattes.wanted() == {"mattes": [{"type": "OBJECT"}, {"type": "MATERIAL"}], "matte_slots": 4}
    top = SimpleNamespace(name='a "quoted" ä\udc80', parent=None)
    own = mattes.of_object(SimpleNamespace(name="hello", parent=SimpleNamespace(name="between", parent=top)))
    assert own["matte"] == (names.number_of(0x248BFA47), names.number_of(names.hash_of(top.name)))
    mattes.of_object(top)
    assert mattes.of_material("") == {"matte": (names.number_of(0x78D05529),)}  # as Cycles has it
    fields = dict(mattes.fields("ViewLayer"))
    "".join(fields.values()).encode("utf-8")
    assert fields["cryptomatte/542cafa/name"] == "ViewLayer.CryptoObject" and len(fields) == 8
    manifest = json.loads(fields["cryptomatte/542cafa/manifest"])
    assert manifest["hello"] == "248bfa47" and len(manifest) == 2


def instance(index, **more):
    return {"mesh": index, "matrix": np.eye(4).ravel().tolist(), **more}


def layers(description, count, kind="OBJECT"):
    """{name: its coverage, height x width}, and the layers' coverages by rank."""
    job = native.start(scene(**description) | {
        "mattes": [{"type": kind} for kind in KINDS], "matte_slots": 2 * count})
    assert finish(job)["state"] == "done"
    size = description.get("height", 16), description.get("width", 16)
    out, ranks = {}, []
    for layer in range(count):
        pixels = np.full((*size, 4), np.nan, np.float32)
        native.image(job, pixels, f"{kind}_MATTE{layer:02}")
        for pair in (0, 2):
            ranks.append(pixels[..., pair + 1])
            for name in np.unique(pixels[..., pair][pixels[..., pair + 1] > 0]):
                there = out.setdefault(float(name), np.zeros(size, np.float32))
                there += np.where(pixels[..., pair] == name, pixels[..., pair + 1], 0)
    native.free(job)
    return out, np.array(ranks)


@pytest.mark.parametrize("part", [0.25, 0.5, 0.75])
def test_coverage_of_objects_materials_and_assets(part):
    """A plate over a part of each pixel of a column, before another: whichever is seen first, what covers more comes first."""
    given = {"samples": 16, "height": 24, "lights": [], "meshes": [half_covered(part / 8), square(3.0, z=-1.0, material_index=1)],
             "materials": [of(diffuse()) | {"matte": (5.0,)}, of(diffuse()) | {"matte": (6.0,)}],
             "instances": [instance(0, matte=(1.5, 9.0)), instance(1, matte=(-2.5, 9.0))]}
    front = np.repeat([[1.0] * 8 + [part] + [0.0] * 7], 24, 0)
    for kind, near, far in (("OBJECT", 1.5, -2.5), ("MATERIAL", 5.0, 6.0)):
        found, ranks = layers(given, 3, kind)
        assert set(found) == {near, far}
        np.testing.assert_allclose(found[near], front, atol=1e-6)
        np.testing.assert_allclose(found[far], 1 - front, atol=1e-6)
        assert (np.diff(ranks, axis=0) <= 0).all()
    found, _ = layers(given, 3, "ASSET")  # both have one
    np.testing.assert_allclose(found[9.0], 1.0, atol=1e-6)


def veils(count):
    """Each lets half through, the last one is nearest."""
    veil = of(weighed(TRANSPARENT, 0.5), weighed(diffuse(), 0.5))
    return {"width": 4, "height": 4, "samples": 1024, "lights": [], "materials": [veil], "camera": ortho(0.5),
            "meshes": [square(z=0.1 * k) for k in range(count)], "transparent_max_bounces": 16,
            "instances": [instance(k, matte=(k + 1.0, 0.0)) for k in range(count)]}


def test_coverage_through_veils():
    found, ranks = layers(veils(4), 3)
    for k in range(4):
        assert found[4.0 - k].mean() == pytest.approx(0.5 ** (k + 1), rel=0.03)
    assert (ranks[:4].min((1, 2)) > 0).all() and (ranks[4:] == 0).all() and (np.diff(ranks, axis=0) <= 0).all()


def test_more_names_than_slots():
    """Nothing is lost: the last slot takes what is over."""
    whole, _ = layers(veils(4), 3)
    found, _ = layers(veils(4), 1)
    assert len(found) <= 4
    np.testing.assert_allclose(sum(found.values()), sum(whole.values()), rtol=1e-5)


def test_what_is_not_asked_for():
    job = native.start(scene(mattes=[{"type": "OBJECT"}], matte_slots=2))
    out = np.zeros((16, 16, 4), np.float32)
    finish(job)
    native.image(job, out, "OBJECT_MATTE00")
    for word in ("OBJECT_MATTE01", "MATERIAL_MATTE00", "OBJECT_MATTE0", "OBJECT_MATTExx", "OBJECT_MATTE"):
        with pytest.raises(ValueError, match="did not ask"):
            native.image(job, out, word)
    native.free(job)
    for bad in ({"mattes": [{"type": "COLOUR"}], "matte_slots": 2}, {"mattes": [{"type": "OBJECT"}]},
                {"mattes": [{"type": "OBJECT"}], "matte_slots": 17}, {"instances": [instance(0, matte=(1.0,))]}):
        with pytest.raises(ValueError, match="type|matte"):
            native.start(scene(**bad))
