# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scenes of examples/blender consist of, as these tables say it: what stands where in which material, its lamps, camera and picture.

The tables were printed from what the scripts built, by inside/example_scenes.py, and read against the scripts. So they tell when a
scene is no longer what it was; that it was right, its picture alone says.

Each scene has
    picture    engine, width, height, per cent of them, samples of ours and of Cycles, whether ours is denoised, view transform and look, file, format; bounces
               of ours and of Cycles where those are not as many as a new scene has
    camera     place, where it looks, kind, lens (of an orthographic one how wide it sees), where it begins to see; f-number and what distance is sharp
    lamps      kind, power, place, where it shines, colour, size
    world      its nodes
    materials  nodes with what was set of each, and links
    bodies     how many, materials, lowest and highest corner together, area, units of the UV map for a metre, whether it is smooth, modifiers,
               1: its outward side is out, -1: in, 0: it is flat
    finer      what is done less finely here
    falls      of cloth that falls: frames, quality, mass, how stiff it is (tension, compression, shear, bending), damping by the air, how far it keeps off
               itself and others, and on what it falls, how thick
"""
import json
import os

import pytest

from blender_runs import ROOT

COST = 12.4

WORDS = {"jacket-near-cycles-7": "near cycles 7"}
SKY_LINKS = ["Background.Background MixShader.Shader", "Background.Background MixShader.Shader", "LightPath.Is Camera Ray MixShader.Factor",
             "Mapping.Vector TexEnvironment.Vector", "MixShader.Shader OutputWorld.Surface", "TexCoord.Generated Mapping.Vector",
             "TexEnvironment.Color Background.Color"]
PLATE = [{"Color": [0.8, 0.62, 0.42, 1], "Roughness": 0.4, "Anisotropy": 0.75}, "BsdfAnisotropic.BSDF OutputMaterial.Surface"]


def sky(strength, turn, seen):
    """A picture lights, and the camera sees a colour."""
    lit, turned = {"Strength": strength} if strength != 1 else {}, {"Rotation": [0, 0, turn]} if turn else {}
    return [[["Background", {"Color": [*seen, 1]}], ["Background", lit], ["LightPath", {}], ["Mapping", turned], ["MixShader", {}], ["TexCoord", {}],
             ["TexEnvironment", {}]], SKY_LINKS]


def room(color):
    return [[["Background", {"Color": [*color, 1]}]], ["Background.Background OutputWorld.Surface"]]


def metal(color, roughness, anisotropy, grain="UV", rotation=None):
    turned = {} if rotation is None else {"Rotation": rotation}
    return [[["Metal", {"grain": grain, "strokes": 0, "Color": [*color, 1], "Roughness": roughness, "Anisotropy": anisotropy, **turned}]],
            ["Metal.BSDF OutputMaterial.Surface"]]


def lathe(color, anisotropy, fine, low, high, depth):
    """Rings: noise by the distance from the axis is roughness, from `low` to `high`, and height."""
    return [[["Bump", {"Distance": depth}], ["CombineXYZ", {}], ["MapRange", {"From Min": 0.3, "From Max": 0.7, "To Min": low, "To Max": high}],
             *[["Math", {"operation": word}] for word in ("MULTIPLY", "MULTIPLY", "SQRT")], ["Math", {}],
             ["Metal", {"grain": "RADIAL_Z", "strokes": 0, "Color": [*color, 1], "Anisotropy": anisotropy}], ["SeparateXYZ", {}], ["TexCoord", {}],
             ["TexNoise", {"Scale": fine, "Detail": 3}]],
            ["Bump.Normal Metal.Normal", "CombineXYZ.Vector TexNoise.Vector", "MapRange.Result Metal.Roughness", "Math.Value CombineXYZ.X",
             *["Math.Value Math.Value"] * 3, "Metal.BSDF OutputMaterial.Surface", *["SeparateXYZ.X Math.Value"] * 2, *["SeparateXYZ.Y Math.Value"] * 2,
             "SeparateXYZ.Z CombineXYZ.Y", "TexCoord.Object SeparateXYZ.Vector", "TexNoise.Factor Bump.Height", "TexNoise.Factor MapRange.Value"]]


def cloth(preset, size):
    return [[["Fabric", {"preset": preset, "size": size}]], ["Fabric.BSDF OutputMaterial.Surface"]]


def plain(color, roughness):
    other = {"Roughness": roughness} if roughness != 0.5 else {}
    return [[["BsdfPrincipled", {"Base Color": [*color, 1], **other}]], ["BsdfPrincipled.BSDF OutputMaterial.Surface"]]


SCENES = {
    "dial": {
        "picture": ["LIBSHADE", 960, 640, 100, 256, 256, False, "AgX", "AgX - Medium High Contrast", "a.png", "PNG"],
        "camera": [[1, -6.2, 8.2], [-0.088962, 0.58986, -0.80259], "PERSP", 60, 0.01],
        "lamps": [["AREA", 300, [2.5, 6, 6.5], [-0.27196, -0.65271, -0.70711], [0.85, 0.92, 1], 3], ["AREA", 650, [-4.5, 4, 6], [0.52941, -0.47059,
            -0.70588], [1, 0.96, 0.9], 3.4]],
        "world": sky(1.3, 2.6, [0.02, 0.02, 0.022]),
        "materials": {
            "brushed steel": metal([0.62, 0.6, 0.58], 0.3, 0.88),
            "dial of rays": metal([0.035, 0.1, 0.34], 0.34, 0.92, "RADIAL_Z", 0.25),
            "polished gold": metal([0.95, 0.74, 0.46], 0.14, 0),
            "polished steel": metal([0.62, 0.6, 0.58], 0.1, 0),
            "slate": plain([0.02, 0.021, 0.023], 0.42),
            "turned blue": metal([0.05, 0.13, 0.38], 0.3, 0.9, "RADIAL_Z"),
            "turned steel": metal([0.62, 0.6, 0.58], 0.28, 0.9, "RADIAL_Z"),
        },
        "bodies": {
            "Plane": [1, ["slate"], [-40, -40, -0.75], [40, 40, -0.75], 6400, 0.0125, False, [], 0],
            "dial": [1, ["dial of rays"], [-2, -2, 0], [2, 2, 0], 12.6, 1, True, [], 0],
            "flange": [1, ["turned blue"], [-2.12, -2.12, 0], [2.12, 2.12, 0.22], 3.36, 1, True, [], 1],
            "bezel": [1, ["turned steel"], [-2.62, -2.62, 0.02], [2.62, 2.62, 0.33], 11.4, 0.992, True, [], 1],
            "case": [1, ["brushed steel"], [-2.69, -2.69, -0.75], [2.69, 2.69, 0.04], 26.5, 1.06, True, [], 1],
            "hour": [11, ["polished gold"], [-1.86, -1.65, 0], [1.86, 1.86, 0.06], 2.44, 0.953, False, [["BEVEL", 0.02, 3]], 1],
            "minute": [48, ["polished steel"], [-1.94, -1.94, 0], [1.94, 1.94, 0.012], 0.27, 0.947, False, [["BEVEL", 0.003, 3]], 1],
            "seconds": [1, ["turned blue"], [-0.58, -1.63, 0], [0.58, -0.47, 0.03], 1.12, 1.29, True, [], 1],
            "tick": [12, ["polished steel"], [-0.47, -1.52, 0], [0.47, -0.58, 0.02], 0.107, 0.944, False, [["BEVEL", 0.003, 3]], 1],
            "second": [1, ["polished gold"], [-0.328, -1.34, 0.045], [0.112, -0.949, 0.08], 0.0771, 0.994, False, [["BEVEL", 0.01, 3]], 1],
            "hours": [1, ["polished steel"], [-0.929, -0.181, 0.12], [0.239, 0.626, 0.155], 0.426, 0.995, False, [["BEVEL", 0.01, 3]], 1],
            "minutes": [1, ["polished steel"], [-0.249, -0.216, 0.17], [1.27, 1.07, 0.205], 0.465, 0.997, False, [["BEVEL", 0.01, 3]], 1],
            "pin": [1, ["polished gold"], [-0.12, -0.12, 0], [0.12, 0.12, 0.25], 0.195, 0.93, True, [], 1],
            "crown": [1, ["brushed steel"], [2.64, -0.252, -0.502], [2.98, 0.252, 0.002], 0.863, 0.959, True, [], 1],
        },
    },
    "cloth": {
        "finer": {"STEPS": 192}, "falls": {},
        "picture": ["LIBSHADE", 960, 400, 100, 128, 4096, False, "Standard", "None", "a.png", "PNG"],
        "camera": [[0, -5.2, 0.8], [0, 1, 0], "PERSP", 44, 0.1],
        "lamps": [["AREA", 60, [2.8, -2.5, 1.2], [-0.7239, 0.63593, -0.2675], [1, 1, 1], 1.2], ["AREA", 260, [-2.6, -2.5, 2.2], [0.62225, 0.60434,
            -0.49757], [1, 1, 1], 0.5]],
        "world": room([0.1, 0.1, 0.1]),
        "materials": {
            "DENIM": cloth("DENIM", 1),
            "HERRINGBONE_TWEED": cloth("HERRINGBONE_TWEED", 1),
            "LINEN": cloth("LINEN", 1),
            "SHOT_TAFFETA": cloth("SHOT_TAFFETA", 1),
            "SILK_CHARMEUSE": cloth("SILK_CHARMEUSE", 1),
        },
        "bodies": {
            "SILK_CHARMEUSE": [1, ["SILK_CHARMEUSE"], [-2.08, -0.0721, 0], [-1.27, 0.0789, 1.6], 1.56, 1, True, [], 1],
            "DENIM": [1, ["DENIM"], [-1.25, -0.0721, 0], [-0.445, 0.0789, 1.6], 1.56, 1, True, [], 1],
            "SHOT_TAFFETA": [1, ["SHOT_TAFFETA"], [-0.415, -0.0721, 0], [0.385, 0.0789, 1.6], 1.56, 1, True, [], 1],
            "HERRINGBONE_TWEED": [1, ["HERRINGBONE_TWEED"], [0.415, -0.0721, 0], [1.22, 0.0789, 1.6], 1.56, 1, True, [], 1],
            "LINEN": [1, ["LINEN"], [1.25, -0.0721, 0], [2.05, 0.0789, 1.6], 1.56, 1, True, [], 1],
        },
    },
    "cloth-near": {
        "picture": ["LIBSHADE", 960, 192, 100, 128, 4096, False, "Standard", "None", "a.png", "PNG"],
        "camera": [[0, -0.2, 0], [0, 1, 0], "ORTHO", 0.06, 0.0001],
        "lamps": [["AREA", 4, [-0.25, -0.3, 0.3], [0.46213, 0.54866, -0.69671], [1, 1, 1], 0.1]],
        "world": room([0.1, 0.1, 0.1]),
        "materials": {
            "DENIM": cloth("DENIM", 1),
            "HERRINGBONE_TWEED": cloth("HERRINGBONE_TWEED", 1),
            "LINEN": cloth("LINEN", 1),
            "SHOT_TAFFETA": cloth("SHOT_TAFFETA", 1),
            "SILK_CHARMEUSE": cloth("SILK_CHARMEUSE", 1),
        },
        "bodies": {
            "Plane": [5, ["DENIM", "HERRINGBONE_TWEED", "LINEN", "SHOT_TAFFETA", "SILK_CHARMEUSE"], [-0.03, 0, -0.006], [0.03, 0, 0.006], 0.00072, 1,
                False, [], 0],
        },
    },
    "pan": {
        "picture": ["LIBSHADE", 960, 540, 100, 256, 256, False, "AgX", "AgX - Medium High Contrast", "a.png", "PNG"],
        "camera": [[0.6, -6.4, 3.9], [-0.019935, 0.87051, -0.49174], "PERSP", 52, 0.01],
        "lamps": [["AREA", 260, [5, -1.5, 4], [-0.72524, 0.24175, -0.64466], [0.85, 0.92, 1], 2.5], ["AREA", 700, [-3.5, 3.5, 5.5], [0.50359,
            -0.46383, -0.72888], [1, 0.95, 0.88], 3.5]],
        "world": sky(0.9, 2.2, [0.03, 0.03, 0.032]),
        "materials": {
            "brushed steel": metal([0.61, 0.59, 0.57], 0.3, 0.85),
            "counter": plain([0.16, 0.11, 0.075], 0.38),
            "polished brass": metal([0.9, 0.72, 0.4], 0.12, 0),
            "turned copper": lathe([0.93, 0.62, 0.5], 0.8, 40, 0.18, 0.3, 0.002),
            "turned steel": lathe([0.61, 0.59, 0.57], 0.85, 42, 0.2, 0.34, 0.002),
            "turned steel inside": lathe([0.61, 0.59, 0.57], 0.9, 60, 0.2, 0.3, 0.002),
        },
        "bodies": {
            "Plane": [1, ["counter"], [-30, -30, 0], [30, 30, 0], 3600, 0.0167, False, [], 0],
            "pan": [1, ["turned steel"], [-1.95, -1.3, 0.02], [0.85, 1.5, 0.52], 8.44, 1.15, True, [], 1],
            "pan inside": [1, ["turned steel inside"], [-1.92, -1.27, 0.05], [0.82, 1.47, 0.52], 7.68, 1.14, True, [], -1],
            "handle": [2, ["brushed steel"], [0.647, -1.3, 0.405], [3.77, 2.97, 1.13], 1.54, 1.01, True, [], -1],
            "Sphere": [2, ["polished brass"], [0.614, -0.543, 0.38], [0.743, -0.354, 0.46], 0.0401, 6.92, True, [], 1],
            "sauce pan": [1, ["turned copper"], [0.8, 0.6, 0.02], [2.7, 2.5, 0.87], 6.35, 1.04, True, [], 1],
            "sauce pan inside": [1, ["turned steel inside"], [0.83, 0.63, 0.05], [2.67, 2.47, 0.87], 5.73, 1.03, True, [], -1],
            "lid": [1, ["turned steel"], [0.535, -2.21, 0.02], [2.56, -0.185, 0.34], 3.93, 1.17, True, [], 1],
            "knob": [1, ["polished brass"], [1.35, -1.4, 0.32], [1.75, -1, 0.6], 0.374, 1.09, True, [], 1],
        },
    },
    "bolts": {
        "picture": ["LIBSHADE", 960, 540, 100, 192, 192, False, "AgX", "AgX - Medium High Contrast", "a.png", "PNG"],
        "camera": [[0.1, -1.2, 0.58], [-0.075657, 0.90789, -0.41233], "PERSP", 46, 0.01],
        "lamps": [["AREA", 5, [1, -0.9, 0.8], [-0.63888, 0.57499, -0.5111], [0.88, 0.94, 1], 0.5], ["AREA", 26, [-1.3, 0.9, 1.2], [0.65493, -0.45341,
            -0.60455], [1, 0.96, 0.9], 0.7]],
        "world": sky(0.55, 2.1, [0.03, 0.03, 0.03]),
        "materials": {
            "card": plain([0.42, 0.3, 0.19], 0.7),
            "DENIM": cloth("DENIM", 1),
            "HERRINGBONE_TWEED": cloth("HERRINGBONE_TWEED", 1),
            "LINEN": cloth("LINEN", 1),
            "table": plain([0.19, 0.125, 0.08], 0.45),
        },
        "bodies": {
            "Plane": [1, ["table"], [-6, -6, 0], [6, 6, 0], 144, 0.0833, False, [], 0],
            "herringbone_tweed": [1, ["HERRINGBONE_TWEED"], [-0.519, -0.0573, 0.001], [-0.016, 0.399, 0.116], 2.26, 1, True, [], -1],
            "core": [3, ["card"], [-0.506, -0.0549, 0.036], [0.536, 0.372, 0.08], 0.179, 1, True, [], 1],
            "linen": [1, ["LINEN"], [0.0404, -0.0548, 0.001], [0.545, 0.388, 0.116], 2.27, 1, True, [], -1],
            "denim": [1, ["DENIM"], [-0.213, -0.372, 0.001], [0.23, 0.0501, 0.116], 2.31, 1, True, [], -1],
        },
    },
    "drape": {
        "finer": {"QUADS": 72, "FRAMES": 70},
        "falls": {"cloth": [1, 5, 0.25, 12, 12, 12, 1.5, 2, 0.004, ["stand", 0.004]]},
        "picture": ["LIBSHADE", 960, 960, 100, 192, 192, False, "AgX", "AgX - Medium High Contrast", "a.png", "PNG"],
        "camera": [[0, -3.6, 0.82], [0, 0.99194, -0.12675], "PERSP", 88, 0.01],
        "lamps": [["AREA", 110, [2.2, 0.4, 1.2], [-0.92637, -0.16843, -0.33686], [0.88, 0.94, 1], 0.8], ["AREA", 170, [-2, -1.2, 2], [0.70711,
            0.42426, -0.56568], [1, 0.96, 0.9], 0.7]],
        "world": sky(0.25, 0.4, [0.05, 0.05, 0.05]),
        "materials": {
            "DENIM": cloth("DENIM", 1),
            "floor": plain([0.07, 0.07, 0.075], 0.7),
            "GABARDINE": cloth("GABARDINE", 1),
            "HERRINGBONE_TWEED": cloth("HERRINGBONE_TWEED", 1),
            "LINEN": cloth("LINEN", 1),
            "POLYESTER_LINING": cloth("POLYESTER_LINING", 1),
            "SHOT_TAFFETA": cloth("SHOT_TAFFETA", 1),
            "SILK_CHARMEUSE": cloth("SILK_CHARMEUSE", 1),
            "SILK_SHANTUNG": cloth("SILK_SHANTUNG", 1),
            "wood": plain([0.24, 0.14, 0.08], 0.4),
            "WOOL_FLANNEL": cloth("WOOL_FLANNEL", 1),
        },
        "bodies": {
            "stand": [9, ["wood"], [-0.49, -0.41, -0.55], [0.49, 0.41, 0.9], 1.82, 1.34, True, [["COLLISION"]], 1],
            "silk_charmeuse": [1, ["SILK_CHARMEUSE"], [-0.842, -0.162, 0.91], [0.0816, 0.762, 0.91], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "shot_taffeta": [1, ["SHOT_TAFFETA"], [-0.455, -0.155, 0.91], [0.455, 0.755, 0.91], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "polyester_lining": [1, ["POLYESTER_LINING"], [-0.118, -0.198, 0.91], [0.878, 0.798, 0.91], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "denim": [1, ["DENIM"], [-0.771, -0.391, 0.54], [0.0114, 0.391, 0.54], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "linen": [1, ["LINEN"], [-0.509, -0.509, 0.54], [0.509, 0.509, 0.54], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "silk_shantung": [1, ["SILK_SHANTUNG"], [-0.026, -0.406, 0.54], [0.786, 0.406, 0.54], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "gabardine": [1, ["GABARDINE"], [-0.873, -0.793, 0.17], [0.113, 0.193, 0.17], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "herringbone_tweed": [1, ["HERRINGBONE_TWEED"], [-0.465, -0.765, 0.17], [0.465, 0.165, 0.17], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "wool_flannel": [1, ["WOOL_FLANNEL"], [-0.0713, -0.751, 0.17], [0.831, 0.151, 0.17], 0.518, 1, True, [["SUBSURF", 2]], 0],
            "Plane": [1, ["floor"], [-15, -3.53, -14.2], [15, 5.93, 14.2], 900, 0.0333, False, [], 0],
        },
    },
    "table": {
        "picture": ["LIBSHADE", 960, 480, 100, 256, 4096, False, "Standard", "None", "a.png", "PNG"],
        "camera": [[0.1, -8.6, 4.3], [0, 0.90441, -0.42666], "PERSP", 46, 0.1],
        "lamps": [["POINT", 700, [3.5, -3, 5], [0, 0, -1], [1, 0.85, 0.7], 0.5]],
        "world": room([0.35, 0.45, 0.6]),
        "materials": {
            "blue": plain([0.08, 0.16, 0.45], 0.6),
            "brushed brass": [[["Metal", {"ex": 900, "ey": 12, "grain": "UV", "strokes": 0, "Color": [0.91, 0.7, 0.32, 1], "Roughness": 0.36525,
                "Anisotropy": 0.64704}]], ["Metal.BSDF OutputMaterial.Surface"]],
            "gold": [[["Metal", {"ex": 150, "ey": 150, "grain": "UV", "strokes": 0, "Color": [1, 0.78, 0.34, 1], "Roughness": 0.33869,
                "Anisotropy": 0}]], ["Metal.BSDF OutputMaterial.Surface"]],
            "table": plain([0.3, 0.17, 0.1], 0.6),
            "turned steel": [[["Metal", {"ex": 4, "ey": 900, "grain": "UV", "strokes": 0, "Color": [0.6, 0.585, 0.565, 1], "Roughness": 0.40606,
                "Anisotropy": -0.71441}]], ["Metal.BSDF OutputMaterial.Surface"]],
        },
        "bodies": {
            "Plane": [1, ["table"], [-15, -15, 0], [15, 15, 0], 900, 0.0333, True, [], 0],
            "Cube": [1, ["blue"], [-3.72, 0.282, 0], [-1.68, 2.32, 1.5], 13.5, 0.167, False, [], 1],
            "Sphere": [1, ["turned steel"], [-1.8, -0.9, 0], [0, 0.9, 1.8], 10.2, 0.311, True, [], 1],
            "Torus": [1, ["brushed brass"], [-0.08, -2.28, 0], [2.08, -0.12, 0.56], 8.83, 0.336, True, [], 1],
            "Suzanne": [1, ["gold"], [0.191, 0.116, 0.258], [2.63, 2.14, 1.8], 11.1, 0.249, True, [["SUBSURF", 2]], 1],
        },
    },
    "groove": {
        "picture": ["CYCLES", 972, 324, 100, 64, 128, False, "Standard", "None", "a.png", "PNG", 12, 0],
        "camera": [[0, 0, 3], [0, 0, -1], "ORTHO", 3.24, 0.1],
        "lamps": [["SUN", 0.6, [0, 0, 0], [0.58835, 0.19612, -0.78446], [1, 1, 1], 0.4], ["SUN", 1.2, [0, 0, 0], [-0.30305, -0.50508, -0.80812], [1,
            1, 1], 0.2]],
        "world": room([0.06, 0.065, 0.075]),
        "materials": {
            "alone": PLATE + ["NormalMap.Normal BsdfAnisotropic.Normal", "Tangent.Tangent BsdfAnisotropic.Tangent", "TexImage.Color NormalMap.Color"],
            "displaced": PLATE + ["Tangent.Tangent BsdfAnisotropic.Tangent"],
            "follows": PLATE + ["Group.Tangent BsdfAnisotropic.Tangent", "NormalMap.Normal BsdfAnisotropic.Normal", "NormalMap.Normal Group.Normal",
                "Tangent.Tangent Group.Tangent", "TexImage.Color NormalMap.Color"],
        },
        "bodies": {
            "follows": [1, ["follows"], [-0.5, -0.5, 0], [0.5, 0.5, 0], 1, 1, True, [], 0],
            "other": [1, ["alone"], [-1.56, -0.5, 0], [-0.56, 0.5, 0], 1, 1, True, [], 0],
            "displaced": [1, ["displaced"], [0.56, -0.5, -0.0398], [1.56, 0.5, 0.0398], 1.06, 0.971, True, [], 0],
        },
    },
    "groove-across": {
        "picture": ["CYCLES", 972, 324, 100, 64, 128, False, "Standard", "None", "a.png", "PNG", 12, 0],
        "camera": [[0, 0, 3], [0, 0, -1], "ORTHO", 3.24, 0.1],
        "lamps": [["SUN", 0.6, [0, 0, 0], [0.58835, 0.19612, -0.78446], [1, 1, 1], 0.4], ["SUN", 1.2, [0, 0, 0], [-0.30305, -0.50508, -0.80812], [1,
            1, 1], 0.2]],
        "world": room([0.06, 0.065, 0.075]),
        "materials": {
            "displaced": PLATE + ["Tangent.Tangent BsdfAnisotropic.Tangent"],
            "follows": PLATE + ["Group.Tangent BsdfAnisotropic.Tangent", "NormalMap.Normal BsdfAnisotropic.Normal", "NormalMap.Normal Group.Normal",
                "Tangent.Tangent Group.Tangent", "TexImage.Color NormalMap.Color"],
            "other": PLATE + ["Group.Strokes Across BsdfAnisotropic.Tangent", "NormalMap.Normal BsdfAnisotropic.Normal",
                "NormalMap.Normal Group.Normal", "Tangent.Tangent Group.Tangent", "TexImage.Color NormalMap.Color"],
        },
        "bodies": {
            "follows": [1, ["follows"], [-1.56, -0.5, 0], [-0.56, 0.5, 0], 1, 1, True, [], 0],
            "other": [1, ["other"], [-0.5, -0.5, 0], [0.5, 0.5, 0], 1, 1, True, [], 0],
            "displaced": [1, ["displaced"], [0.56, -0.5, -0.0398], [1.56, 0.5, 0.0398], 1.06, 0.971, True, [], 0],
        },
    },
    "scratches": {
        "picture": ["LIBSHADE", 600, 400, 100, 128, 128, False, "AgX", "AgX - Medium High Contrast", "a.png", "PNG"],
        "camera": [[0, -0.24, 0.3], [0, 0.6247, -0.78087], "PERSP", 60, 0.01],
        "lamps": [["AREA", 0.025, [0.05, 0.22, 0.3], [-0.1332, -0.58609, -0.79922], [1, 1, 1], 0.03]],
        "world": sky(1, 0, [0.05, 0.05, 0.05]),
        "materials": {
            "brushed": [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1],
                "Roughness": 0.25, "Anisotropy": 0}], ["Scratches", {"unit": "METRES", "seed": 3, "Density per cm²": 500, "Length mm": 25,
                "Depth": 0.12, "Spread": 0.035}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
            "deep": [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1],
                "Roughness": 0.2, "Anisotropy": 0}], ["Scratches", {"unit": "METRES", "seed": 3, "Density per cm²": 1200, "Length mm": 4,
                "Width mm": 0.012, "Depth": 0.06}], ["Scratches", {"unit": "METRES", "seed": 4}], ["Scratches", {"unit": "METRES", "seed": 5,
                "Density per cm²": 1.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35, "Direction": 0.3, "Spread": 0.9}]],
                ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal", "Scratches.Normal Scratches.Normal",
                "Scratches.Normal Scratches.Normal"]],
            "slate": plain([0.02, 0.021, 0.023], 0.5),
            "used": [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1],
                "Roughness": 0.2, "Anisotropy": 0}], ["Scratches", {"unit": "METRES", "seed": 3, "Density per cm²": 1200, "Length mm": 4,
                "Width mm": 0.012, "Depth": 0.06}], ["Scratches", {"unit": "METRES", "seed": 4}]], ["Metal.BSDF OutputMaterial.Surface",
                "Scratches.Normal Metal.Normal", "Scratches.Normal Scratches.Normal"]],
        },
        "bodies": {
            "Plane": [1, ["slate"], [-2, -2, 0], [2, 2, 0], 16, 0.25, False, [], 0],
            "Cube": [3, ["brushed", "deep", "used"], [-0.091, -0.055, 0], [0.091, 0.055, 0.003], 0.0359, 5.6, False, [["BEVEL", 0.0007, 3]], 1],
        },
    },
    "jacket": {
        "picture": ["LIBSHADE", 960, 776, 100, 128, 128, False, "AgX", "AgX - Medium High Contrast", "a.png", "PNG"],
        "camera": [[0.55, -2.3, 0.42], [-0.23209, 0.97058, -0.064142], "PERSP", 88, 0.01],
        "lamps": [["AREA", 14, [1.8, -0.6, 0.7], [-0.92828, 0.30943, -0.20628], [0.88, 0.94, 1], 0.5], ["AREA", 48, [-1.6, -1.5, 1.4], [0.65211,
            0.61135, -0.44833], [1, 0.96, 0.9], 0.6]],
        "world": sky(0.35, 0.4, [0.3, 0.28, 0.26]),
        "materials": {
            "copper": metal([0.72, 0.36, 0.2], 0.28, 0.3, "RADIAL_Z"),
            "wall": plain([0.3, 0.28, 0.26], 0.8),
        },
        "bodies": {
            "button": [7, ["copper"], [-0.00891, -0.145, 0.0111], [0.009, -0.114, 0.51], 0.00398, 1.07, True, [], 1],
            "Plane": [1, ["wall"], [-15, -1.79, -14.6], [15, 4.79, 14.6], 900, 0.0333, False, [], 0],
        },
    },
    "jacket-near-cycles-7": {
        "picture": ["CYCLES", 960, 776, 100, 7, 7, False, "AgX", "AgX - Medium High Contrast", "a.png", "PNG"],
        "camera": [[0.155, -0.34, 0.45], [-0.12095, 0.96758, -0.22174], "PERSP", 85, 0.01, 16, 0.23024],
        "lamps": [["AREA", 14, [1.8, -0.6, 0.7], [-0.92828, 0.30943, -0.20628], [0.88, 0.94, 1], 0.5], ["AREA", 48, [-1.6, -1.5, 1.4], [0.65211,
            0.61135, -0.44833], [1, 0.96, 0.9], 0.6]],
        "world": sky(0.35, 0.4, [0.3, 0.28, 0.26]),
        "materials": {
            "copper": metal([0.72, 0.36, 0.2], 0.28, 0.3, "RADIAL_Z"),
            "denim": cloth("DENIM", 1),
            "thread": plain([0.55, 0.25, 0.055], 0.6),
            "wall": plain([0.3, 0.28, 0.26], 0.8),
        },
        "bodies": {
            "left front": [1, ["denim"], [-0.0129, -0.139, 0], [0.237, 0, 0.594], 0.176, 0.987, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "right front": [1, ["denim"], [-0.242, -0.136, 0], [0.0128, 0, 0.594], 0.175, 0.987, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "back": [1, ["denim"], [-0.241, 0, 0], [0.237, 0.136, 0.595], 0.341, 0.991, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "yoke left": [1, ["denim"], [0.00659, -0.128, 0.426], [0.229, -0.0137, 0.566], 0.0318, 1.03, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "yoke right": [1, ["denim"], [-0.228, -0.128, 0.426], [-0.00659, -0.0137, 0.566], 0.0318, 1.03, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "yoke back": [1, ["denim"], [-0.226, 0.0184, 0.43], [0.226, 0.122, 0.567], 0.0581, 1.05, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "waistband": [1, ["denim"], [-0.225, -0.134, 0], [0.225, 0.131, 0.0451], 0.053, 1, True, [["SOLIDIFY", 0.003, -1]], 1],
            "collar": [1, ["denim"], [-0.13, -0.133, 0.506], [0.13, 0.127, 0.63], 0.0629, 1.02, True, [["SOLIDIFY", 0.0018, -1]], -1],
            "sleeve 1": [1, ["denim"], [0.13, -0.122, -0.0436], [0.362, 0.103, 0.53], 0.229, 1.1, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "cuff 1": [1, ["denim"], [0.235, -0.125, -0.0448], [0.346, -0.00688, 0.0276], 0.0142, 1, True, [["SOLIDIFY", 0.003, -1]], 1],
            "button": [11, ["copper"], [-0.342, -0.145, -0.00745], [0.342, -0.0951, 0.51], 0.00592, 1.07, True, [], 1],
            "pocket 1": [1, ["denim"], [0.0943, -0.129, 0.296], [0.196, -0.0818, 0.432], 0.0135, 1.01, True, [["SOLIDIFY", 0.0016, -1]], 1],
            "flap 1": [1, ["denim"], [0.0941, -0.126, 0.387], [0.191, -0.0834, 0.441], 0.00475, 1.01, True, [["SOLIDIFY", 0.0016, -1]], 1],
            "sleeve -1": [1, ["denim"], [-0.362, -0.122, -0.0436], [-0.13, 0.103, 0.53], 0.229, 1.1, True, [["SOLIDIFY", 0.0011, -1]], 1],
            "cuff -1": [1, ["denim"], [-0.346, -0.125, -0.0448], [-0.235, -0.00688, 0.0276], 0.0142, 1, True, [["SOLIDIFY", 0.003, -1]], 1],
            "pocket -1": [1, ["denim"], [-0.195, -0.129, 0.296], [-0.0944, -0.0824, 0.433], 0.0135, 1.01, True, [["SOLIDIFY", 0.0016, -1]], 1],
            "flap -1": [1, ["denim"], [-0.193, -0.126, 0.387], [-0.0942, -0.0836, 0.441], 0.00477, 1.01, True, [["SOLIDIFY", 0.0016, -1]], 1],
            "thread": [1, ["thread"], [-0.00749, -0.141, 0], [0.0219, -0.0744, 0.561], 0.00255, None, True, [], -1],
            "Plane": [1, ["wall"], [-15, -1.79, -14.6], [15, 4.79, 14.6], 900, 0.0333, False, [], 0],
        },
    },
    "suzanne": {
        "picture": ["LIBSHADE", 960, 720, 100, 64, 4096, False, "Standard", "None", "", "PNG", 0, 12],
        "camera": [[0.9, -6.2, 2.6], [-0.13759, 0.94787, -0.28742], "PERSP", 55, 0.1],
        "lamps": [["POINT", 420, [-3.6, -2.6, 2.6], [0.69959, 0.50526, -0.50526], [0.82, 0.91, 1], 0], ["POINT", 420, [2.5, 4, 4.2], [-0.39583,
            -0.63333, -0.66499], [1, 1, 1], 0], ["SUN", 2.6, [2.4, -2.8, 3.2], [-0.49154, 0.57346, -0.65538], [1, 0.95, 0.88], 0]],
        "world": room([0.012, 0.014, 0.018]),
        "materials": {
            "Brushed steel": [[["Metal", {"ex": 100, "ey": 2.5, "grain": "UV", "strokes": 0, "Color": [0.6, 0.585, 0.565, 1], "Roughness": 0.55275,
                "Anisotropy": 0.5417}], ["NormalMap", {}], ["TexImage", {}]], ["Metal.BSDF OutputMaterial.Surface", "NormalMap.Normal Metal.Normal",
                "TexImage.Color NormalMap.Color"]],
            "Turned steel": [[["Metal", {"ex": 70, "ey": 4, "grain": "UV", "strokes": 0, "Color": [0.6, 0.585, 0.565, 1], "Roughness": 0.55696,
                "Anisotropy": 0.46271}], ["NormalMap", {}], ["TexImage", {}]], ["Metal.BSDF OutputMaterial.Surface", "NormalMap.Normal Metal.Normal",
                "TexImage.Color NormalMap.Color"]],
        },
        "bodies": {
            "Suzanne": [1, ["Brushed steel"], [-1.48, -0.881, 0.113], [1.04, 1.1, 1.89], 12.3, 0.71, True, [["SUBSURF", 3]], 1],
            "Turntable": [1, ["Turned steel"], [-3.4, -3.4, 0], [3.4, 3.4, 0], 36.3, 0.664, True, [], 0],
        },
    },
    "make_first": {
        "picture": ["LIBSHADE", 1920, 1080, 50, 64, 4096, False, "AgX", "None", "a.png", "PNG"],
        "camera": [[7.3589, -6.9258, 4.9583], [-0.65156, 0.61417, -0.44527], "PERSP", 50, 0.1],
        "lamps": [],
        "world": [[["Background", {"Strength": 0.05}], ["TexSky", {"sun_elevation": 0.5236, "sun_rotation": 3.4907}]],
            ["Background.Background OutputWorld.Surface", "TexSky.Color Background.Color"]],
        "materials": {
            "Material": [[["BsdfPrincipled", {}]], ["BsdfPrincipled.BSDF OutputMaterial.Surface"]],
            "Turned brass": [[["Metal", {"groove": "X", "fresnel": "CONDUCTOR", "ex": 1247.9, "ey": 124.13, "eta": [0.4777, 0.5235, 1.128],
                "k": [4.342, 2.67, 1.812], "grain": "RADIAL_Z", "set_edge": [0.9472, 0.97829, 1, 1], "set_color": [0.90917, 0.77841, 0.42241, 1],
                "Color": [0.90917, 0.77841, 0.42241, 1], "Edge Tint": [0.9472, 0.97829, 1, 1], "Roughness": 0.26641, "Anisotropy": 0.43638}]],
                ["Metal.BSDF OutputMaterial.Surface"]],
        },
        "bodies": {
            "Suzanne": [1, ["Turned brass"], [-1.37, -0.852, -0.984], [1.37, 0.852, 0.984], 12.3, 0.237, True, [["SUBSURF", 2]], 1],
            "Plane": [1, [], [-20, -20, -1], [20, 20, -1], 1600, 0.025, False, [], 0],
        },
    },
}
SCENES["bolts-near"] = {**SCENES["bolts"], "camera": [[0.05, -0.415, 0.055], [-0.36117, 0.80788, -0.46572], "PERSP", 60, 0.01, 9, 0.095179]}
SCENES["scratches-near"] = {**SCENES["scratches"], "camera": [[0.066, -0.05, 0.075], [-0.041072, 0.63661, -0.77009], "PERSP", 70, 0.01]}
# The same by three engines
ENGINES = {
    "camera": [[0, -0.62, 0.02], [0, 0.99948, -0.032241], "PERSP", 46, 0.01],
    "lamps": [["AREA", 2.2, [-0.4, -0.6, 0.5], [0.45584, 0.68376, -0.5698], [1, 1, 1], 0.12]],
    "world": sky(0.6, 2.1, [0.05, 0.05, 0.05]),
    "materials": {
        "brass": [[["Bump", {"Strength": 0.3, "Distance": 0.1}], ["Metal", {"grain": "UV", "strokes": 0, "Color": [0.9, 0.72, 0.36, 1],
            "Roughness": 0.35, "Anisotropy": 0.7}], ["TexNoise", {"Scale": 7}]], ["Bump.Normal Metal.Normal", "Metal.BSDF OutputMaterial.Surface",
            "TexNoise.Factor Bump.Height"]],
        "denim": cloth("DENIM", 0.06),
        "steel": [[["Metal", {"grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.3, "Anisotropy": 0}], ["Scratches",
            {"size": 0.12, "Density per cm²": 1.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35, "Direction": 0.3, "Spread": 0.9}]],
            ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
    },
    "bodies": {
        "Suzanne": [3, ["brass", "denim", "steel"], [-0.221, -0.0526, -0.0418], [0.221, 0.0655, 0.053], 0.112, 4.3, True, [["SUBSURF", 3]], 1],
    },
}
# Of each of the manual's pictures of what sockets do: what wears the materials, how often it is sampled and whether it is denoised, and the three
EFFECTS = {
    "roughness": ("dome", 32, True, [
        metal([0.62, 0.6, 0.58], 0.2, 0.5),
        metal([0.62, 0.6, 0.58], 0.45, 0.5),
        metal([0.62, 0.6, 0.58], 0.7, 0.5),
    ]),
    "anisotropy": ("dome", 32, True, [
        metal([0.62, 0.6, 0.58], 0.35, 0),
        metal([0.62, 0.6, 0.58], 0.35, 0.5),
        metal([0.62, 0.6, 0.58], 0.35, 0.9),
    ]),
    "strokes": ("dome", 32, True, [
        [[["Metal", {"grain": "UV", "strokes": 0, "stroke_width": 20, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.35, "Anisotropy": 0.8}]],
            ["Metal.BSDF OutputMaterial.Surface"]],
        [[["Metal", {"grain": "UV", "strokes": 0.5, "stroke_width": 20, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.35, "Anisotropy": 0.8}]],
            ["Metal.BSDF OutputMaterial.Surface"]],
        [[["Metal", {"grain": "UV", "stroke_width": 20, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.35, "Anisotropy": 0.8}]],
            ["Metal.BSDF OutputMaterial.Surface"]],
    ]),
    "rotation": ("dome", 32, True, [
        metal([0.62, 0.6, 0.58], 0.35, 0.8),
        metal([0.62, 0.6, 0.58], 0.35, 0.8, "UV", 0.125),
        metal([0.62, 0.6, 0.58], 0.35, 0.8, "UV", 0.25),
    ]),
    "bump-response": ("dome", 32, True, [
        [[["Bump", {"Strength": 0.6, "Distance": 0.004}], ["Metal", {"grain": "UV", "strokes": 0, "Color": [0.95, 0.64, 0.54, 1], "Roughness": 0.4,
            "Anisotropy": 0.8}], ["TexCoord", {}], ["TexVoronoi", {"feature": "SMOOTH_F1", "Scale": 80}]], ["Metal.BSDF OutputMaterial.Surface",
            "TexCoord.Object TexVoronoi.Vector", "TexVoronoi.Distance Bump.Height"]],
        [[["Bump", {"Strength": 0.6, "Distance": 0.004}], ["Metal", {"grain": "UV", "bump_response": "IGNORE", "strokes": 0, "Color": [0.95, 0.64,
            0.54, 1], "Roughness": 0.4, "Anisotropy": 0.8}], ["TexCoord", {}], ["TexVoronoi", {"feature": "SMOOTH_F1", "Scale": 80}]],
            ["Bump.Normal Metal.Normal", "Metal.BSDF OutputMaterial.Surface", "TexCoord.Object TexVoronoi.Vector",
            "TexVoronoi.Distance Bump.Height"]],
        [[["Bump", {"Strength": 0.6, "Distance": 0.004}], ["Metal", {"grain": "UV", "strokes": 0, "Color": [0.95, 0.64, 0.54, 1], "Roughness": 0.4,
            "Anisotropy": 0.8}], ["TexCoord", {}], ["TexVoronoi", {"feature": "SMOOTH_F1", "Scale": 80}]], ["Bump.Normal Metal.Normal",
            "Metal.BSDF OutputMaterial.Surface", "TexCoord.Object TexVoronoi.Vector", "TexVoronoi.Distance Bump.Height"]],
    ]),
    "amount": ("plate", 32, True, [
        [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.2,
            "Anisotropy": 0}], ["Scratches", {"size": 1, "Amount": 0, "Density per cm²": 7.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35,
            "Direction": 0.3, "Spread": 0.9}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
        [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.2,
            "Anisotropy": 0}], ["Scratches", {"size": 1, "Amount": 0.1, "Density per cm²": 7.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35,
            "Direction": 0.3, "Spread": 0.9}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
        [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.2,
            "Anisotropy": 0}], ["Scratches", {"size": 1, "Density per cm²": 7.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35, "Direction": 0.3,
            "Spread": 0.9}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
    ]),
    "scratch-size": ("plate", 32, True, [
        [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.2,
            "Anisotropy": 0}], ["Scratches", {"size": 0.5, "Density per cm²": 7.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35, "Direction": 0.3,
            "Spread": 0.9}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
        [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.2,
            "Anisotropy": 0}], ["Scratches", {"size": 1, "Density per cm²": 7.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35, "Direction": 0.3,
            "Spread": 0.9}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
        [[["Metal", {"distribution": "BECKMANN", "brdf": "MICROFACET", "grain": "UV", "strokes": 0, "Color": [0.62, 0.6, 0.58, 1], "Roughness": 0.2,
            "Anisotropy": 0}], ["Scratches", {"size": 2, "Density per cm²": 7.5, "Length mm": 25, "Width mm": 0.15, "Depth": 0.35, "Direction": 0.3,
            "Spread": 0.9}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"]],
    ]),
    "gloss": ("ball", 64, False, [
        [[["Fabric", {"preset": "POLYESTER_LINING", "size": 1, "Gloss": 0.1}]], ["Fabric.BSDF OutputMaterial.Surface"]],
        [[["Fabric", {"preset": "POLYESTER_LINING", "size": 1, "Gloss": 0.4}]], ["Fabric.BSDF OutputMaterial.Surface"]],
        cloth("POLYESTER_LINING", 1),
    ]),
    "fuzz": ("ball", 64, False, [
        [[["Fabric", {"preset": "WOOL_FLANNEL", "size": 1, "Fuzz": 0}]], ["Fabric.BSDF OutputMaterial.Surface"]],
        [[["Fabric", {"preset": "WOOL_FLANNEL", "size": 1, "Fuzz": 0.3}]], ["Fabric.BSDF OutputMaterial.Surface"]],
        [[["Fabric", {"preset": "WOOL_FLANNEL", "size": 1, "Fuzz": 1.5}]], ["Fabric.BSDF OutputMaterial.Surface"]],
    ]),
    "cloth-size": ("folds", 64, False, [
        cloth("HERRINGBONE_TWEED", 0.5),
        cloth("HERRINGBONE_TWEED", 1),
        cloth("HERRINGBONE_TWEED", 2),
    ]),
    "distance": ("folds", 64, False, [
        cloth("HERRINGBONE_TWEED", 0.5),
        [[["Fabric", {"preset": "HERRINGBONE_TWEED", "size": 0.5, "distance": "NEAR"}]], ["Fabric.BSDF OutputMaterial.Surface"]],
        [[["Fabric", {"preset": "HERRINGBONE_TWEED", "size": 0.5, "distance": "FAR"}]], ["Fabric.BSDF OutputMaterial.Surface"]],
    ]),
    "twist": ("sheet", 32, True, [
        [[["Fabric", {"preset": "CUSTOM", "based_on": "GABARDINE", "weave": "TWILL_3_1", "ends_per_cm": 44, "picks_per_cm": 22, "size": 1,
            "distance": "NEAR", "warp_twist": -0.61086, "warp_segments": 2, "warp_crimp": 0.4, "warp_vary_brightness": 0.06, "warp_vary_tilt": 0,
            "warp_curve": 0.55, "warp_ridge": 0.6, "warp_crimp_length": 0.7, "warp_along_brightness": 0.04, "warp_along_tilt": 0,
            "warp_along_length": 10, "warp_along": 40, "warp_across": 5, "weft_width": 0.95, "weft_gap": 0.05, "weft_twist": -0.61086,
            "weft_segments": 2, "weft_vary_brightness": 0.06, "weft_curve": 0.55, "weft_ridge": 0.6, "weft_crimp_length": 0.7,
            "weft_along_brightness": 0.04, "weft_along_length": 10, "weft_along": 40, "weft_across": 5, "repeat_mm": [0.90909, 1.8182],
            "Warp Color": [0.34, 0.24, 0.13, 1], "Weft Color": [0.3, 0.21, 0.115, 1], "Fuzz": 0.02}]], ["Fabric.BSDF OutputMaterial.Surface"]],
        [[["Fabric", {"preset": "CUSTOM", "based_on": "GABARDINE", "weave": "TWILL_3_1", "ends_per_cm": 44, "picks_per_cm": 22, "size": 1,
            "distance": "NEAR", "warp_segments": 2, "warp_crimp": 0.4, "warp_vary_brightness": 0.06, "warp_vary_tilt": 0, "warp_curve": 0.55,
            "warp_ridge": 0.6, "warp_crimp_length": 0.7, "warp_along_brightness": 0.04, "warp_along_tilt": 0, "warp_along_length": 10,
            "warp_along": 40, "warp_across": 5, "weft_width": 0.95, "weft_gap": 0.05, "weft_twist": 0, "weft_segments": 2,
            "weft_vary_brightness": 0.06, "weft_curve": 0.55, "weft_ridge": 0.6, "weft_crimp_length": 0.7, "weft_along_brightness": 0.04,
            "weft_along_length": 10, "weft_along": 40, "weft_across": 5, "repeat_mm": [0.90909, 1.8182], "Warp Color": [0.34, 0.24, 0.13, 1],
            "Weft Color": [0.3, 0.21, 0.115, 1], "Fuzz": 0.02}]], ["Fabric.BSDF OutputMaterial.Surface"]],
        [[["Fabric", {"preset": "CUSTOM", "based_on": "GABARDINE", "weave": "TWILL_3_1", "ends_per_cm": 44, "picks_per_cm": 22, "size": 1,
            "distance": "NEAR", "warp_twist": 0.61086, "warp_segments": 2, "warp_crimp": 0.4, "warp_vary_brightness": 0.06, "warp_vary_tilt": 0,
            "warp_curve": 0.55, "warp_ridge": 0.6, "warp_crimp_length": 0.7, "warp_along_brightness": 0.04, "warp_along_tilt": 0,
            "warp_along_length": 10, "warp_along": 40, "warp_across": 5, "weft_width": 0.95, "weft_gap": 0.05, "weft_twist": 0.61086,
            "weft_segments": 2, "weft_vary_brightness": 0.06, "weft_curve": 0.55, "weft_ridge": 0.6, "weft_crimp_length": 0.7,
            "weft_along_brightness": 0.04, "weft_along_length": 10, "weft_along": 40, "weft_across": 5, "repeat_mm": [0.90909, 1.8182],
            "Warp Color": [0.34, 0.24, 0.13, 1], "Weft Color": [0.3, 0.21, 0.115, 1], "Fuzz": 0.02}]], ["Fabric.BSDF OutputMaterial.Surface"]],
    ]),
}
VIEWS = {
    "dome": {
        "camera": [[0, -0.36, 0.3], [0, 0.77492, -0.63206], "PERSP", 44, 0.01],
        "lamps": [["AREA", 0.35, [-0.25, -0.05, 0.4], [0.52705, 0.10541, -0.84327], [1, 1, 1], 0.06]],
        "world": sky(0.8, 2.1, [0.05, 0.05, 0.05]),
        "bodies": {
            "dome": [3, [-0.169, -0.0495, 0], [0.169, 0.0495, 0.044], 0.0414, 0.747, True, [], 1],
            "Plane": [1, [-2, -2, 0], [2, 2, 0], 16, 0.25, False, [], 0],
        },
    },
    "plate": {
        "camera": [[0, -0.4, 0.35], [0, 0.75258, -0.65851], "PERSP", 156, 0.01],
        "lamps": [["AREA", 0.025, [0.05, 0.22, 0.3], [-0.1332, -0.58609, -0.79922], [1, 1, 1], 0.03]],
        "world": sky(1, 0, [0.05, 0.05, 0.05]),
        "bodies": {
            "plate": [3, [-0.0585, -0.022, 0], [0.0585, 0.022, 0], 0.00488, 1, True, [], 0],
        },
    },
    "ball": {
        "camera": [[0, -0.5, 0.16], [0, 0.9754, -0.22044], "PERSP", 50, 0.01],
        "lamps": [["AREA", 0.5, [-0.2, -0.3, 0.35], [0.39802, 0.59702, -0.69653], [1, 1, 1], 0.08]],
        "world": sky(0.8, 2.1, [0.05, 0.05, 0.05]),
        "bodies": {
            "ball": [3, [-0.17, -0.05, 0], [0.17, 0.05, 0.1], 0.0942, 0.994, True, [], 1],
            "Plane": [1, [-2, -2, 0], [2, 2, 0], 16, 0.25, False, [], 0],
        },
    },
    "folds": {
        "camera": [[0, -0.6, 0.05], [0, 0.99998, -0.006666], "PERSP", 58, 0.01],
        "lamps": [["AREA", 0.6, [-0.35, -0.3, 0.35], [0.60471, 0.51832, -0.60471], [1, 1, 1], 0.1]],
        "world": sky(0.5, 2.1, [0.05, 0.05, 0.05]),
        "bodies": {
            "folds": [3, [-0.172, -0.00778, 0], [0.172, 0.00726, 0.09], 0.0324, 1, True, [], -1],
        },
    },
    "sheet": {
        "camera": [[0, -0.024, 0], [0, 1, 0], "PERSP", 58, 0.01],
        "lamps": [["AREA", 0.02, [-0.03, -0.04, 0.06], [0.38411, 0.51215, -0.76822], [1, 1, 1], 0.01]],
        "world": sky(0.7, 2.1, [0.05, 0.05, 0.05]),
        "bodies": {
            "sheet": [3, [-0.0071, 0, -0.0021], [0.0071, 0, 0.0021], 5.8e-05, 1, True, [], 0],
        },
    },
}

def unlike(found, said, place=""):
    """Where they part by more than a hundredth, as texts."""
    if isinstance(said, dict) and isinstance(found, dict):
        parts = [f"{place}: {sorted(found)}, not {sorted(said)}"] if set(found) != set(said) else []
        return parts + [one for key in said if key in found for one in unlike(found[key], said[key], f"{place} {key}")]
    if isinstance(said, list) and isinstance(found, list) and len(said) == len(found):
        return [one for k, (a, b) in enumerate(zip(found, said)) for one in unlike(a, b, f"{place} {k}")]
    near = found == pytest.approx(said, rel=1e-2, abs=2e-6) if isinstance(said, (int, float)) and isinstance(found, (int, float)) else found == said
    return [] if near else [f"{place}: {found}, not {said}"]


@pytest.fixture(scope="module")
def built(blender_new, tmp_path_factory):
    scripts = [f"{ROOT}/examples/blender/{name.partition('-')[0]}/make_scene.py {WORDS.get(name, name.partition('-')[2])}".strip() for name in SCENES
               if not name.startswith("make_")]
    scripts += [f"{ROOT}/examples/blender/nodes/{name}.py" for name in ("make_first", "make_effects", "make_engines", "make_pictures")]
    facts = tmp_path_factory.mktemp("facts") / "facts.json"
    blender_new.run("example_scenes.py", facts, *scripts)
    return json.loads(facts.read_text())


def without_copies(scene):
    """A material that was made again, as it was, once."""
    made = scene["materials"]
    return {**scene, "materials": {name: tree for name, tree in made.items() if "." not in name or tree != made[name.partition(".")[0]]}}


@pytest.mark.parametrize("name", SCENES)
def test_scene(built, name):
    (found,) = built[name]
    found = without_copies(found)
    if name.startswith("groove"):  # of the plates what differs: links
        for material, (nodes, links) in found["materials"].items():
            assert ["Tangent", {"direction_type": "UV_MAP"}] in nodes and links[0] == PLATE[1]
            assert not unlike(nodes[0], ["BsdfAnisotropic", PLATE[0]]), material
            found["materials"][material] = [nodes[0][1], *links]
    assert not unlike(found, SCENES[name])


GRAPHS = {  # of each picture of the editor: nodes and links, and where nodes stand
    "metal": [[["Metal", {"Color": [0.9, 0.62, 0.3, 1]}], ["NormalMap", {}], ["TexImage", {}]],
              ["Metal.BSDF OutputMaterial.Surface", "NormalMap.Normal Metal.Normal", "TexImage.Color NormalMap.Color"],
              {"TexImage": [-520, -230], "NormalMap": [-220, -230], "LibshadeMetalNode": [0, 0], "OutputMaterial": [280, 0]}],
    "fabric": [[["Fabric", {"preset": "DENIM"}], ["NormalMap", {}], ["TexImage", {}]],
               ["Fabric.BSDF OutputMaterial.Surface", "NormalMap.Normal Fabric.Normal", "TexImage.Color NormalMap.Color"],
               {"TexImage": [-520, -100], "NormalMap": [-220, -100], "LibshadeFabricNode": [0, 0], "OutputMaterial": [260, 0]}],
    "groove": [[["BsdfAnisotropic", {"Anisotropy": 0.5}], ["Group", {"of": "Libshade Groove"}], ["NormalMap", {}], ["TexImage", {}]],
               ["BsdfAnisotropic.BSDF OutputMaterial.Surface", "Group.Tangent BsdfAnisotropic.Tangent", "NormalMap.Normal BsdfAnisotropic.Normal",
                "NormalMap.Normal Group.Normal", "TexImage.Color NormalMap.Color"],
               {"TexImage": [-800, -140], "NormalMap": [-500, -140], "Group": [-230, -60], "BsdfAnisotropic": [0, 0], "OutputMaterial": [220, 0]}],
    "scratches": [[["Metal", {}], ["Scratches", {}]], ["Metal.BSDF OutputMaterial.Surface", "Scratches.Normal Metal.Normal"],
                  {"LibshadeScratchesNode": [-280, 0], "LibshadeMetalNode": [0, 0], "OutputMaterial": [280, 0]}],
}


def test_graphs_in_the_editor(built):
    """In an editor of shaders without side bars; nothing is selected."""
    assert {name: [*tree, places] for name, tree, places, _area in built["make_pictures"]} == GRAPHS
    assert all(area == ["ShaderNodeTree", False, False, False, []] for *_tree, area in built["make_pictures"])


def test_three_engines(built):
    if "BOTH" not in os.environ:  # else it is baked
        assert built["make_engines"].pop(0) == ["LibshadeScratchesNode", "steel", True]
    pictures = [scene.pop("picture") for scene in built["make_engines"]]
    assert [picture[0] for picture in pictures] == ["LIBSHADE", "CYCLES", "BLENDER_EEVEE"]
    assert {tuple(picture[1:6]) for picture in pictures} == {(900, 210, 100, 64, 64)}
    for scene in built["make_engines"]:
        assert not unlike(scene, ENGINES)


def test_effects(built):
    assert [scene["picture"][9] for scene in built["make_effects"]] == [f"{name}.jpg" for name in EFFECTS]


@pytest.mark.parametrize("name", EFFECTS)
def test_effect(built, name):
    """Its three materials, from left to right."""
    found = built["make_effects"][list(EFFECTS).index(name)]
    wears, samples, denoised, three = EFFECTS[name]
    assert found["picture"] == ["LIBSHADE", 720, 210, 100, samples, samples, denoised, "AgX", "AgX - Medium High Contrast", f"{name}.jpg", "JPEG"]
    slate = found["materials"].pop("slate", None)
    if "Plane" in VIEWS[wears]["bodies"]:
        assert not unlike(slate, plain([0.01, 0.0105, 0.012], 0.6))
    assert not unlike([tree for _name, tree in sorted(found["materials"].items())], three)
    bodies = {name: [body[0], *body[2:]] for name, body in found["bodies"].items()}
    assert not unlike({**{word: found[word] for word in ("camera", "lamps", "world")}, "bodies": bodies}, VIEWS[wears])
