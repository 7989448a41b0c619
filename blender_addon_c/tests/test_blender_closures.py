# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders against Cycles of the same Blender: balls under an even sky and a sun."""

import re
from pathlib import Path

import numpy as np
import pytest

from blender_runs import ENGINES, by_each, measured, rgba

COST = 37.4
EXPORT = Path(__file__).parent.parent / "export"


def shader(kind, inputs=None, **more):
    return {"node": kind, "inputs": inputs or {}, "set": more}


def of_version(thing, version):
    """What a case says of this version alone, by a dictionary of versions."""
    if isinstance(thing, dict) and thing and set(thing) <= {"3.4", "5.0"}:
        return thing.get(version)
    if isinstance(thing, dict):
        made = {key: of_version(part, version) for key, part in thing.items()}
        return {key: part for key, part in made.items() if part is not None}
    if isinstance(thing, (list, tuple)):
        return [of_version(part, version) for part in thing]
    return thing


def cases_of(version, cases=None):
    made = of_version(cases or CASES, version)
    for case in made:
        for item in case.get("shaders", ()):
            item["node"] = "ShaderNode" + item["node"]
    return made


RED = (0.8, 0.3, 0.1, 1)


def one(name, kind, inputs=None, **more):
    return {"name": name, "shaders": [shader(kind, inputs, **more)]}


def two(name, by, *shaders):
    return {"name": name, "by": f"ShaderNode{by}", "shaders": shaders}


def principled(name, **inputs):
    """Inputs by the names of 4.0 on; what they were until 3.6 beside them."""
    old = {"Coat Weight": "Clearcoat", "Coat Roughness": "Clearcoat Roughness",
           "Transmission Weight": "Transmission", "Emission Color": "Emission",
           "Specular IOR Level": "Specular", "Sheen Weight": "Sheen"}
    given = {key.replace("_", " "): value for key, value in inputs.items()}
    given |= {old[key]: value for key, value in given.items() if key in old}
    return one(name, "BsdfPrincipled", {"Base Color": RED, **given})


def film(thickness, ior):
    """Sockets of 4.2 on, in nm."""
    return {"Thin Film Thickness": {"5.0": thickness}, "Thin Film IOR": {"5.0": ior}}


def toon(component, size, smooth):
    """3.4 draws soft rims brighter than it evaluates them."""
    return one(f"{component.lower()} toon {size} {smooth}", "BsdfToon", {
        "Color": RED, "Size": size, "Smooth": {"3.4": 0.0, "5.0": smooth}}, component=component)


def grooved(case, by="UV"):
    """Its grooves along the UV map, or round an axis."""
    case["shaders"][0]["grooved"] = by
    return case


CASES = [
    one("diffuse", "BsdfDiffuse", {"Color": RED}),
    one("rough diffuse", "BsdfDiffuse", {"Color": RED, "Roughness": 0.8}),
    one("glossy", "BsdfGlossy", {"Color": RED, "Roughness": 0.3}, distribution="GGX"),
    one("beckmann", "BsdfGlossy", {"Color": RED, "Roughness": 0.5}, distribution="BECKMANN"),
    one("very rough", "BsdfGlossy", {"Color": RED, "Roughness": 0.9}, distribution="GGX"),
    one("very rough beckmann", "BsdfGlossy", {"Color": RED, "Roughness": 0.9}, distribution="BECKMANN"),
    one("several", "BsdfGlossy", {"Color": RED, "Roughness": 0.7}, distribution="MULTI_GGX"),
    one("glass", "BsdfGlass", {"Color": RED, "Roughness": 0.1}, distribution="GGX"),
    one("several in glass", "BsdfGlass", {"Color": RED, "Roughness": 0.6}, distribution="MULTI_GGX"),
    one("rough glass", "BsdfGlass", {"Color": RED, "Roughness": 0.6}, distribution="GGX"),
    one("beckmann glass", "BsdfGlass", {"Color": RED, "Roughness": 0.5}, distribution="BECKMANN"),
    one("beckmann bends", "BsdfRefraction", {"Color": RED, "Roughness": 0.4}, distribution="BECKMANN"),
    one("refraction", "BsdfRefraction", {"Color": RED, "Roughness": 0.2}, distribution="GGX"),
    one("translucent", "BsdfTranslucent", {"Color": RED}),
    one("transparent", "BsdfTransparent", {"Color": RED}),
    one("emission", "Emission", {"Color": RED, "Strength": 2.0}),
    one("background", "Background", {"Color": RED, "Strength": 2.0}),
    one("a colour", "Gamma", {"Color": RED, "Gamma": 2.0}),
    two("half a number", "MixShader", shader("BsdfDiffuse", {"Color": RED}), shader("Math", {"Value": 0.2})),
    two("mixed", "MixShader", shader("BsdfDiffuse", {"Color": RED}),
        shader("BsdfGlossy", {"Roughness": 0.3}, distribution="GGX")),
    two("added", "AddShader", shader("BsdfDiffuse", {"Color": RED}),
        shader("Emission", {"Color": (0.1, 0.2, 0.3, 1)})),
    two("half there", "MixShader", shader("BsdfDiffuse", {"Color": RED}), shader("BsdfTransparent")),
    one("metallic by tints", {"3.4": "BsdfGlossy", "5.0": "BsdfMetallic"}, {
        "Color": RED, "Base Color": RED, "Edge Tint": (0.3, 0.6, 1, 1), "Roughness": 0.6}, distribution="MULTI_GGX",
        fresnel_type={"5.0": "F82"}),
    one("conductor", {"3.4": "BsdfGlossy", "5.0": "BsdfMetallic"}, {
        "Color": RED, "IOR": (0.18, 0.42, 1.37), "Extinction": (3.4, 2.35, 1.77), "Roughness": 0.7,
        "Anisotropy": {"5.0": 0.6}, "Rotation": {"5.0": 0.1}}, distribution="MULTI_GGX",
        fresnel_type={"5.0": "PHYSICAL_CONDUCTOR"}),
    one("beckmann conductor", {"3.4": "BsdfGlossy", "5.0": "BsdfMetallic"}, {
        "Color": RED, "Roughness": 0.4}, distribution="BECKMANN", fresnel_type={"5.0": "PHYSICAL_CONDUCTOR"}),
    one("filmed conductor", {"3.4": "BsdfGlossy", "5.0": "BsdfMetallic"}, {
        "Color": RED, "IOR": (2.87, 2.93, 2.59), "Extinction": (3.11, 2.93, 2.77), "Roughness": 0.3, **film(400.0, 1.4)},
        distribution="GGX", fresnel_type={"5.0": "PHYSICAL_CONDUCTOR"}),
    one("filmed conductor, several", {"3.4": "BsdfGlossy", "5.0": "BsdfMetallic"}, {
        "Color": RED, "IOR": (0.18, 0.42, 1.37), "Extinction": (3.4, 2.35, 1.77), "Roughness": 0.6, **film(250.0, 1.8)},
        distribution="MULTI_GGX", fresnel_type={"5.0": "PHYSICAL_CONDUCTOR"}),
    one("filmed tints", {"3.4": "BsdfGlossy", "5.0": "BsdfMetallic"}, {
        "Color": RED, "Base Color": RED, "Edge Tint": (0.9, 0.9, 0.9, 1), "Roughness": 0.3, **film(400.0, 1.33)},
        distribution="GGX", fresnel_type={"5.0": "F82"}),
    one("below", "SubsurfaceScattering", {"Color": RED, "Scale": 0.0}),
    principled("principled"),
    principled("principled below", Roughness=0.3, **{
        "Subsurface": 0.7, "Subsurface Weight": 0.7, "Subsurface Color": (0.2, 0.5, 0.9, 1),
        "Subsurface Radius": (0.0, 0.0, 0.0), "Subsurface Scale": 0.0}),
    principled("filmed", Roughness=0.2, **film(500.0, 1.33)),
    principled("filmed, rough", Roughness=0.7, **film(300.0, 1.8)),
    one("filmed glass", "BsdfGlass", {"Color": RED, "Roughness": 0.1, **film(300.0, 1.4)}, distribution="GGX"),
    one("filmed glass, sharp", "BsdfGlass", {"Roughness": 0.0, **film(500.0, 2.0)}, distribution="GGX"),
    one("filmed glass, several", "BsdfGlass", {"Color": RED, "Roughness": 0.6, **film(250.0, 1.8)},
        distribution={"3.4": "GGX", "5.0": "MULTI_GGX"}),
    one("filmed glass, beckmann", "BsdfGlass", {"Color": RED, "Roughness": 0.5, **film(400.0, 1.33)}, distribution="BECKMANN"),
    principled("filmed and clear", Transmission_Weight=1.0, Roughness=0.2, **film(500.0, 1.33)),
    principled("filmed, half clear", Transmission_Weight=0.5, Roughness=0.3, **film(350.0, 1.8)),
    principled("filmed, clear and tinted", Transmission_Weight=1.0, Roughness=0.3, **film(350.0, 1.8),
               **{"Specular Tint": {"5.0": (0.3, 0.6, 1, 1)}}),
    principled("clear and tinted", Transmission_Weight=1.0, Roughness=0.3, **{"Specular Tint": {"5.0": (0.3, 0.6, 1, 1)}}),
    one("filmed dark tints", {"3.4": "BsdfGlossy", "5.0": "BsdfMetallic"}, {
        "Color": RED, "Base Color": (0.9, 0.6, 0.3, 1), "Edge Tint": (0.2, 0.5, 0, 1), "Roughness": 0.3, **film(250.0, 1.8)},
        distribution="GGX", fresnel_type={"5.0": "F82"}),
    principled("filmed metal", Metallic=1.0, Roughness=0.3, **film(400.0, 1.33)),
    principled("metallic", Metallic=1.0, Roughness=0.4),
    principled("half metallic", Metallic=0.5, Roughness=0.4),
    principled("rough", Roughness=1.0),
    principled("thin", IOR=0.5, Roughness=0.3),
    principled("no index", IOR=0.0, Roughness=0.4),
    principled("coated", **{"Coat Weight": 1.0, "Coat Roughness": 0.1}),
    principled("clear", **{"Transmission Weight": 1.0, "Roughness": 0.1}),
    principled("rough and clear", **{"Transmission Weight": 1.0, "Roughness": 0.6}),
    principled("shining", **{"Emission Color": (0.1, 0.4, 0.9, 1), "Emission Strength": 1.0}),
    principled("see through", Alpha=0.4),
    principled("sheen", **{"Sheen Weight": 1.0, "Sheen Tint": {"3.4": 0.7, "5.0": (0.3, 0.6, 1.0, 1)}}),
    principled("tinted", Roughness=0.3, **{"Specular Tint": {"3.4": 1.0, "5.0": RED}}),
    principled("tinted metal", Roughness=0.3, Metallic=1.0, **{"Specular Tint": {"3.4": 1.0, "5.0": (0.3, 0.6, 1, 1)}}),
    principled("tinted coat", **{"Coat Weight": 0.8, "Coat Roughness": 0.2, "Coat Tint": {"5.0": RED}}),
    one("velvet", {"3.4": "BsdfVelvet", "5.0": "BsdfSheen"}, {"Color": RED, "Sigma": 0.5, "Roughness": 0.5},
        distribution={"5.0": "ASHIKHMIN"}),
    one("fibres", {"3.4": "BsdfVelvet", "5.0": "BsdfSheen"}, {"Color": RED, "Sigma": 0.9, "Roughness": 0.5},
        distribution={"5.0": "MICROFIBER"}),
    one("fine fibres", {"3.4": "BsdfVelvet", "5.0": "BsdfSheen"}, {"Color": RED, "Sigma": 0.25, "Roughness": 0.25},
        distribution={"5.0": "MICROFIBER"}),
    two("matt, below toon", "AddShader", shader("BsdfDiffuse", {"Color": RED}),
        shader("BsdfToon", {"Color": (0.5, 0.5, 0.5, 1), "Size": 0.2, "Smooth": 0.0}, component="GLOSSY")),
    toon("DIFFUSE", 0.5, 0.3), toon("DIFFUSE", 0.7, 0.0), toon("DIFFUSE", 0.9, 0.8), toon("GLOSSY", 0.3, 0.2), toon("GLOSSY", 0.8, 0.5),
    grooved(one("stretched", "BsdfAnisotropic", {"Color": RED, "Roughness": 0.5, "Anisotropy": 0.6,
                                                 "Rotation": 0.1}, distribution="GGX")),
    grooved(one("stretched far", "BsdfAnisotropic", {"Color": RED, "Roughness": 0.6, "Anisotropy": 0.9}, distribution="GGX")),
    grooved(one("stretched, several", "BsdfAnisotropic", {"Color": RED, "Roughness": 0.9, "Anisotropy": 0.8}, distribution="MULTI_GGX")),
    grooved(one("across", "BsdfAnisotropic", {"Color": RED, "Roughness": 0.5, "Anisotropy": -0.6},
                distribution="ASHIKHMIN_SHIRLEY")),
    grooved(one("round", "BsdfAnisotropic", {"Color": RED, "Roughness": 0.5, "Anisotropy": 0.6,
                                             "Rotation": 0.1}, distribution="GGX"), "X"),
    principled("turned", Metallic=1.0, Roughness=0.5, Anisotropic=0.7),
    grooved(principled("brushed", Metallic=1.0, Roughness=0.5, Anisotropic=0.7,
                       **{"Anisotropic Rotation": 0.2})),
]
# Far from the surface's, and below it.
BUMPS = {"steep": (1, 0.5, 0.6), "a vector": ("vector", 0, -0.6, 0.8), "a bumped vector": ("bumped", 0.5, 0.5, 0.5),
         "leaning": (0.8, 0.6, 0.75)}
CASES += [{"name": f"{kind}, {name}", "shaders": [
    shader(kind, {"Color": RED, "Base Color": RED, **inputs}, distribution="GGX") | {"bump": bump}]}
          for name, bump in BUMPS.items()
          for kind, inputs in (("BsdfDiffuse", {}), ("BsdfDiffuse", {"Roughness": 0.7}), ("BsdfGlossy", {"Roughness": 0.6}),
                               ("BsdfPrincipled", {"Roughness": 0.5}))]
CASES += [{"name": kind, "bare": kind} for kind in
          ("none", "untouched", "no nodes", "no shader", "image")]
CASES += [principled("filmed and tinted", Roughness=0.3, **film(350.0, 1.5), **{"Specular Tint": {"5.0": (0.3, 0.6, 1, 1)}})]
# How far a ball's mean may be from that of Cycles where it is not the same model: 3.4's light walks among
# the facets of rough glass, where ours has the share that does leave as the rest; and it draws its clear coat by another density than it says, so that
# what is below is 2 % too dark under a sky (under the sun alone ours is within .5 %); its bumped GGX is 1 to 2 % brighter. What
# several bounces keep of total reflection is not in the table of "thin". Where "a bumped vector" lies in the surface, heights bend
# it without end. APART: of 4 x 4 pixels.
OFF = {**{(f"BsdfGlossy, {bump}", "3.4"): 0.02 for bump in BUMPS}, ("several in glass", "3.4"): 0.05, ("coated", "3.4"): 0.03, ("thin", "5.0"): 0.02, ("tinted coat", "3.4"): 0.03,
       **{(f"{kind}, a bumped vector", version): 0.025 for kind in ("BsdfDiffuse", "BsdfGlossy", "BsdfPrincipled")
          for version in ("3.4", "5.0")}}
APART = {("several in glass", "3.4"): 0.025}


def test_shaders_are_those_of_cycles(blender, tmp_path):
    version = measured(blender.version)
    cases = cases_of(version)
    blender.scene("balls", tmp_path, cases=cases, engines=ENGINES, samples=128, dump="")
    theirs, ours = (picture[..., :3].astype(float) for picture in by_each(tmp_path))
    far = []
    for column, case in enumerate(cases):
        at = np.s_[:, 24 * column:24 * column + 24]
        mean = theirs[at].mean((0, 1))
        off = np.abs(ours[at].mean((0, 1)) / mean - 1).max()
        # 4 x 4 pixels at a time: less noise
        blocks = (ours[at] - theirs[at]).reshape(6, 4, 6, 4, 3).mean((1, 3))
        apart = np.abs(blocks).mean() / mean.mean()
        if off > OFF.get((case["name"], version), 0.01) or apart > APART.get(
                (case["name"], version), 0.02):
            far.append((case["name"], off, apart))
    assert not far, far


def test_smooth_cubes(blender, tmp_path):
    """Where normals turn far from the facets' and from the eye, shaders take those that Cycles' take."""
    pictures = []
    for engine in ("LIBSHADE", "CYCLES"):
        blender.scene("cubes", tmp_path, engine=engine, dump="")
        pictures.append(rgba(tmp_path / "picture.exr")[..., :3].astype(float))
    ours, theirs = pictures
    for half in np.s_[:, :32], np.s_[:, 32:]:
        assert theirs[half].mean() > 0.05
        assert np.abs(ours[half] - theirs[half]).mean() / theirs[half].mean() < 0.01


def test_every_shader_has_a_case():
    """Our own nodes are elsewhere, and so is what sends rays on or leaves a hole."""
    closures, known = ((EXPORT / name).read_text(encoding="utf-8") for name in ("closure.py", "known.py"))
    covered = {item["node"] for version in ("3.4", "5.0") for case in cases_of(version) for item in case.get("shaders", ())}
    for name in re.findall(r'^    "ShaderNode(\w+)": ', closures, re.M):
        assert "ShaderNode" + name in covered or name in ("BsdfRayPortal", "Holdout"), f"{name}: give it a case"
        assert re.search(rf"^{name}: ", known, re.M), f"{name}: give it a row in known.py"


@pytest.mark.parametrize("transport, detail, axis", [(True, "ROTATE", ""), (False, "GRAM_SCHMIDT", ""),
                                                     (True, "ROTATE", "Z")])
def test_grooves_go_with_bumps_or_as_in_cycles(blender, tmp_path, transport, detail, axis):
    pictures = []
    for own in ("", detail, "GRAM_SCHMIDT" if transport else "ROTATE"):
        blender.scene("grooves", tmp_path, transport=transport, detail=own, axis=axis, dump="")
        pictures.append(rgba(tmp_path / "picture.exr")[8, 8, :3])
    np.testing.assert_allclose(pictures[0], pictures[1], rtol=1e-4)
    assert np.abs(pictures[0] / pictures[2] - 1).min() > 0.05
