# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes say, against Cycles of the same Blender: a plane for each case, whose colour (the
dump's, or in Cycles emission) is what the node's output says."""

import ast

import numpy as np
import pytest

from blender_runs import ENGINES, ROOT, Dump, by_each, rgba

COST = 76.5


# what A and B are: images of one colour, so that nothing is worked out before the picture
COLORS = {"A": (0.2, 0.5, 0.7), "B": (0.6, 0.3, 0.1), "X": (0.35, 0.35, 0.35)}


def node(kind, inputs=None, since="3.4", until="9", **more):
    return {"node": f"ShaderNode{kind}", "inputs": inputs or {}, "since": since, "until": until,
            **more}


MATH = """ADD SUBTRACT MULTIPLY DIVIDE MULTIPLY_ADD POWER LOGARITHM SQRT INVERSE_SQRT ABSOLUTE EXPONENT
MINIMUM MAXIMUM LESS_THAN GREATER_THAN SIGN COMPARE SMOOTH_MIN SMOOTH_MAX ROUND FLOOR CEIL TRUNC FRACT
MODULO WRAP SNAP PINGPONG SINE COSINE TANGENT ARCSINE ARCCOSINE ARCTANGENT ARCTAN2 SINH COSH TANH
RADIANS DEGREES""".split()
VECTORS = """ADD SUBTRACT MULTIPLY DIVIDE MULTIPLY_ADD CROSS_PRODUCT DOT_PRODUCT DISTANCE LENGTH SCALE
NORMALIZE ABSOLUTE MINIMUM MAXIMUM FLOOR CEIL FRACTION MODULO WRAP SNAP SINE COSINE TANGENT PROJECT
REFLECT REFRACT FACEFORWARD""".split()
MODES = """MIX DARKEN MULTIPLY BURN LIGHTEN SCREEN DODGE ADD OVERLAY SOFT_LIGHT LINEAR_LIGHT DIFFERENCE
SUBTRACT DIVIDE HUE SATURATION VALUE COLOR""".split()
TURN = (0.3, -0.5, 0.2)

DIMENSIONS = ("1D", "2D", "3D", "4D")


def of(size, **inputs):
    """Inputs, with W where there is one."""
    return {**inputs, **({"W": 0.37} if size in ("1D", "4D") else {})}


CASES = [
    node("RGB", own=(0.25, 0.5, 0.75, 1)),
    node("Value", own=0.4),
    *(node("Math", {"0": "X", "1": 0.8, "2": 0.25}, set={"operation": op}) for op in MATH),
    node("Math", {"0": "X", "1": 0.8}, set={"operation": "FLOORED_MODULO"}, since="4.0"),
    node("Math", {"0": "A", "1": "B"}, set={"operation": "SUBTRACT"}),  # grey of a colour
    node("Math", {"0": "X", "1": 0.9}, set={"operation": "ADD", "use_clamp": True}),
    *(node("VectorMath", {"0": "A", "1": "B", "2": (0.3, 0.17, 0.64), "3": 0.7},
           set={"operation": op}, output={"DOT_PRODUCT": 1, "DISTANCE": 1, "LENGTH": 1}.get(op, 0))
      for op in VECTORS if op != "MULTIPLY_ADD"),
    node("VectorMath", {"0": "A", "1": "B", "2": (0.3, 0.2, 0.6)}, set={"operation": "MULTIPLY_ADD"}),
    *(node("MixRGB", {"Fac": "X", "Color1": "A", "Color2": "B"}, set={"blend_type": mode})
      for mode in MODES),
    *(node("MixRGB", {"Fac": "X", "Color1": one, "Color2": other}, set={"blend_type": mode})
      for mode in ("HUE", "SATURATION", "VALUE", "COLOR") for one, other in (("X", "B"), ("B", "X"))),
    *(node("Mix", {"Factor_Float": "X", "A_Color": "A", "B_Color": "B"}, output="Result_Color",
           set={"data_type": "RGBA", "blend_type": mode}) for mode in ("HUE", "COLOR")),
    node("MixRGB", {"Fac": 1.5, "Color1": "A", "Color2": "B"}, set={"blend_type": "ADD",
                                                                    "use_clamp": True}),
    node("Mix", {"Factor_Float": "X", "A_Float": 0.2, "B_Float": "B"}, set={"data_type": "FLOAT"},
         output="Result_Float"),
    node("Mix", {"Factor_Float": 0.4, "A_Vector": "A", "B_Vector": "B"}, output="Result_Vector",
         set={"data_type": "VECTOR"}),
    node("Mix", {"Factor_Vector": "A", "A_Vector": (0.1, 0.2, 0.3), "B_Vector": "B"},
         output="Result_Vector", set={"data_type": "VECTOR", "factor_mode": "NON_UNIFORM"}),
    node("Mix", {"Factor_Float": "X", "A_Color": "A", "B_Color": "B"}, output="Result_Color",
         set={"data_type": "RGBA", "blend_type": "OVERLAY"}),
    node("Mix", {"Factor_Float": "X", "A_Color": "A", "B_Color": "B"}, output="Result_Color",
         set={"data_type": "RGBA", "blend_type": "EXCLUSION"}, since="4.0"),
    *(node("Mapping", {"Vector": "A", "Location": (0.1, 0.2, -0.1), "Rotation": TURN,
                       "Scale": (0.8, 1.2, 0.9)}, set={"vector_type": kind})
      for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL")),
    node("Mapping", {"Vector": "A", "Rotation": TURN, "Scale": "B", "Location": "B"}),
    *(node("Mapping", {"Vector": "A", "Rotation": TURN, "Scale": "B"}, set={"vector_type": kind})
      for kind in ("TEXTURE", "NORMAL")),
    *(node("Mapping", {"Vector": "A", "Rotation": "B", "Scale": (0.8, 1.2, 0.9), "Location": (0.1, 0.2, 0.1)},
           set={"vector_type": kind}) for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL")),
    node("UVMap", set={"uv_map": "UVMap"}),
    *(node("TexCoord", output=output) for output in ("UV", "Normal", "Reflection")),
    *(node("NewGeometry", output=output)
      for output in ("Normal", "True Normal", "Incoming", "Backfacing")),
    node("ValToRGB", {"Fac": "X"}, ramp=[(0.2, (1, 0.2, 0.1, 1)), (0.6, (0.1, 0.9, 0.3, 0.5))]),
    node("ValToRGB", {"Fac": "X"}, output="Alpha",
         ramp=[(0.2, (1, 0.2, 0.1, 1)), (0.6, (0.1, 0.9, 0.3, 0.5))]),
    *(node("SeparateRGB", {"Image": "A"}, output=k, until="4.9") for k in range(3)),
    *(node("SeparateXYZ", {"Vector": "A"}, output=k) for k in range(3)),
    *(node("SeparateColor", {"Color": "A"}, output=k) for k in range(3)),
    *(node("SeparateColor", {"Color": color}, output=k, set={"mode": mode})
      for mode in ("HSV", "HSL") for color in "ABX" for k in range(3)),
    *(node("SeparateHSV", {"Color": "B"}, output=k, until="4.9") for k in range(3)),
    node("CombineHSV", {"H": 0.1, "S": "X", "V": 0.9}, until="4.9"),
    *(node("CombineColor", {"Red": h, "Green": "X", "Blue": 0.6}, set={"mode": mode})
      for mode in ("HSV", "HSL") for h in (0.1, 0.3, 0.45, 0.6, 0.7, 0.9, 1.0)),
    *(node("HueSaturation", {"Hue": h, "Saturation": s, "Value": v, "Fac": f, "Color": color})
      for h, s, v, f, color in ((0.7, 1.2, 0.8, 1.0, "A"), (0.1, 0.5, 1.4, 0.6, "B"), ("X", 2.0, "X", 1.0, "A"))),
    node("CombineRGB", {"R": 0.1, "G": "X", "B": 0.9}, until="4.9"),
    node("CombineXYZ", {"X": 0.1, "Y": "X", "Z": 0.9}),
    node("CombineColor", {"Red": 0.1, "Green": "X", "Blue": 0.9}),
    *(node("TexWhiteNoise", of(size, **({"Vector": (0.3, -2.4, 7.1)} if size != "1D" else {})), output=output,
           set={"noise_dimensions": size}) for size in DIMENSIONS for output in ("Value", "Color")),
    node("Clamp", {"Value": "X", "Min": 0.5, "Max": 0.9}),
    node("Clamp", {"Value": "X", "Min": 0.9, "Max": 0.5}, set={"clamp_type": "RANGE"}),
    node("Invert", {"Fac": "X", "Color": "A"}),
    *(node("Blackbody", {"Temperature": t}) for t in (300.0, 1000.0, 5200.0, 20000.0)),
    *(node("Wavelength", {"Wavelength": nm}) for nm in (300.0, 433.0, 612.0)),
    *(node("RGBCurve", {"Fac": 0.8, "Color": color}, curves=[[(0, 0.2), (0.8, 0.9), (0.4, 0.1)]] * 4)
      for color in ("A", (0.1, 0.5, 0.9, 1))),
    node("Gamma", {"Color": "A", "Gamma": 2.2}),
    node("BrightContrast", {"Color": "A", "Bright": 0.1, "Contrast": 0.3}),
    node("RGBToBW", {"Color": "A"}),
    node("MapRange", {"Value": "X", "From Min": 0.1, "From Max": 0.7, "To Min": 0.9, "To Max": 0.2}),
    node("MapRange", {"Value": "X", "From Min": 0.4, "From Max": 0.7, "To Min": 0.9, "To Max": 0.2}),
]


def test_nodes_say_what_they_say_in_cycles(blender, tmp_path):
    cases = [case for case in CASES if case["since"] <= blender.version < case["until"]]
    blender.scene("graph", tmp_path, cases=cases, colors=COLORS, engines=ENGINES, dump="")
    cycles, ours = (picture[2, 2::4, :3].clip(0, 1) for picture in by_each(tmp_path))
    far = [(case, a, b) for case, a, b in zip(cases, ours, cycles) if not np.abs(a - b).max() < 2e-4]
    assert not far, "\n".join(map(str, far))
    assert len({tuple(color.round(3)) for color in ours}) > len(cases) / 2


def place(kind, output=0, **more):
    return {"node": f"ShaderNode{kind}", "output": output, **{"since": "3.4", **more}}


TURNED = {"turn": (2.9, 0.2, 0.2)}  # seen from behind
# where axes are scaled apart, Cycles turns UV tangents as normals; here they stay on the surface
EVEN = {"scale": (0.8, 0.8, 0.8)}
# and, like 3.4 where eye and normal are nearly at right angles, bends normals of a curved mesh a little
NEARLY_FLAT = EVEN | {"height": 0.02}
SPACES = ("WORLD", "OBJECT", "CAMERA")
PLACES = [
    *(place("TexCoord", output) for output in ("Generated", "Normal", "UV", "Object", "Camera", "Window",
                                               "Reflection")),
    place("TexCoord", "Generated", modifiers=["SUBSURF", "CAST"]),
    place("TexCoord", "Normal", **TURNED),
    *(place("UVMap", set={"uv_map": name}) for name in ("UVMap", "second", "", "missing")),
    *(place("UVMap", set={"uv_map": name}, beside=True) for name in ("UVMap", "second", "", "missing")),
    place("UVMap", set={"uv_map": "UVMap"}, other={"set": {"uv_map": "second"}}),
    *(place("TexImage", uv_map=name, beside=True) for name in ("UVMap", "second", "missing")),
    place("Tangent", set={"direction_type": "UV_MAP", "uv_map": "UVMap"}, beside=True, **EVEN),
    *(place("Tangent", set={"direction_type": "RADIAL", "axis": axis}) for axis in "XYZ"),
    *(place("Tangent", set={"direction_type": "UV_MAP", "uv_map": name}, **EVEN)
      for name in ("UVMap", "second", "")),
    *(place("NewGeometry", output) for output in ("Position", "Normal", "True Normal", "Tangent", "Incoming")),
    *(place("Attribute", output, set={"attribute_name": name})
      for name, output in (("number", "Color"), ("number", "Fac"), ("vector", "Vector"), ("vector", "Fac"),
                           ("count", "Fac"), ("bytes", "Color"), ("floats", "Color"), ("floats", "Fac"),
                           ("floats", "Alpha"), ("UVMap", "Vector"), ("gone", "Color"))),
    *(place("VertexColor", output, set={"layer_name": name})
      for name, output in (("", "Color"), ("bytes", "Color"), ("bytes", "Alpha"), ("floats", "Alpha"))),
    *(place("ObjectInfo", output)
      for output in ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random")),
    *(place(kind, output, inputs={socket: value, **({"Normal": (0.2, 0.1, 1)} if bent else {})}, **turn)
      for kind, output, socket, value in (
          ("Fresnel", 0, "IOR", 1.45), ("Fresnel", 0, "IOR", 0.7), ("LayerWeight", "Fresnel", "Blend", 0.3),
          ("LayerWeight", "Facing", "Blend", 0.3), ("LayerWeight", "Facing", "Blend", 0.8))
      for turn, bent in (({}, False), (TURNED, False), (TURNED, True))),
    *(place("LayerWeight", "Facing", group=(vector, hidden), **TURNED)
      for vector in ((0, 0, 0), (0.6, 0, 0.8)) for hidden in (False, True)),
    *(place("TexImage", set={"interpolation": kind, "extension": wrap})
      for kind, wrap in (("Cubic", "REPEAT"), ("Cubic", "EXTEND"), ("Cubic", "CLIP"), ("Smart", "REPEAT"),
                         ("Linear", "REPEAT"))),
    place("TexImage", "Alpha", set={"interpolation": "Cubic"}),
    *(place("TexImage", output, set={"projection": "BOX", "projection_blend": blend}, fed={"Vector": by}, height=0.3, **more)
      for output, blend, by, more in (
          ("Color", 0.0, (1.0, 0.0), {}), ("Color", 0.3, (1.7, -0.3), {}), ("Color", 1.0, (0.6, 0.1), {}),
          ("Alpha", 0.5, (1.0, 0.0), {"turn": (1.2, 0.5, 0.7)}), ("Color", 0.2, (1.0, 0.0), {"turn": (2.6, -0.7, 0.2)}),
          ("Color", 0.5, (1.0, 0.0), {"turn": (-0.7, -0.5, 0.3)}))),
    place("TexImage", set={"projection": "BOX", "projection_blend": 0.3}),
    *(place("TexImage", set={"projection": kind, "interpolation": mixed}, fed={"Vector": (1.3, -0.2)})
      for kind in ("SPHERE", "TUBE") for mixed in ("Linear", "Cubic")),
    *(place("TexEnvironment", set={"projection": kind, "interpolation": mixed}, **fed)
      for kind, mixed, fed in (
          ("EQUIRECTANGULAR", "Linear", {"fed": {"Vector": (1.3, -0.4)}}), ("EQUIRECTANGULAR", "Cubic", {}),
          ("EQUIRECTANGULAR", "Linear", {}), ("MIRROR_BALL", "Linear", {"fed": {"Vector": (1.3, -0.4)}}))),
    *(place("LightFalloff", output, inputs={"Strength": 0.4, "Smooth": smooth}, times=0.1)
      for output in ("Quadratic", "Linear", "Constant") for smooth in (0.0, 3.0)),
    *(place("ParticleInfo", output) for output in ("Index", "Random", "Age", "Lifetime", "Location", "Size", "Velocity",
                                                   "Angular Velocity")),
    *(place("HairInfo", output) for output in ("Is Strand", "Intercept", "Length", "Thickness", "Tangent Normal", "Random")),
    *(place("AmbientOcclusion", output, inputs={"Color": (0.3, 0.5, 0.7, 1), "Distance": 1e-5}) for output in ("Color", "AO")),
    *(place("Bevel", inputs={"Radius": 0.0, **bent}) for bent in ({}, {"Normal": (0.2, 0.1, 1)})),
    *(place("LightPath", output) for output in ("Is Camera Ray", "Ray Length", "Ray Depth")),
    *(place("CameraData", output) for output in ("View Vector", "View Z Depth", "View Distance")),
    *(place("VectorTransform", set={"vector_type": kind, "convert_from": one, "convert_to": other},
            fed={"Vector": ([0.9, 0.5, -0.7], [0.1, 0.4, 0.3])}, times=0.1)
      for kind in ("POINT", "VECTOR", "NORMAL") for one in SPACES for other in SPACES),
    place("NormalMap", set={"uv_map": "UVMap"}, beside=True, **NEARLY_FLAT),
    place("NormalMap", set={"uv_map": "UVMap"}, beside=True, **TURNED, **NEARLY_FLAT),
    *(place("NormalMap", set={"space": space, "uv_map": name}, strength=strength, **more)
      for space, name, strength, more in (
          ("TANGENT", "UVMap", 1.0, NEARLY_FLAT), ("TANGENT", "second", 1.0, NEARLY_FLAT),
          ("TANGENT", "second", 0.6, NEARLY_FLAT),
          ("TANGENT", "UVMap", 1.5, TURNED | NEARLY_FLAT), ("OBJECT", "", 1.0, {}), ("WORLD", "", 0.7, {}),
          ("BLENDER_OBJECT", "", 1.0, {"blue": 0.1}),
          ("BLENDER_WORLD", "", 1.0, TURNED))),
]


@pytest.mark.parametrize("perspective", ["", "TexCoord", "CameraData", "VectorTransform", "LightPath",
                                         "LightFalloff"])
def test_places_are_those_of_cycles(blender, tmp_path, perspective):
    """Of a camera in perspective those of one kind, where that makes a difference."""
    cases = [case for case in PLACES if not perspective or case["node"] == f"ShaderNode{perspective}"]
    cases = [case for case in cases if case["since"] <= blender.version]
    options = {"cases": cases, "perspective": bool(perspective)}
    blender.scene("places", tmp_path, engine="LIBSHADE", **options)
    ours = Dump(tmp_path / "dump.exr")["Color"]
    blender.scene("places", tmp_path, engine="CYCLES", dump="", **options)
    cycles = rgba(tmp_path / "picture.exr")[..., :3].clip(0, 1)
    far = []
    for column, case in enumerate(cases):
        a, b = (picture[5:12, 16 * column + 5:16 * column + 12] for picture in (ours, cycles))
        if not np.abs(a - b).max() < 2e-4:
            far.append((case, np.abs(a - b).max(), a[3, 3], b[3, 3]))
    assert not far, "\n".join(map(str, far))


NOISE = {"Scale": 3.0, "Detail": 2.4, "Roughness": 0.6}
MUSGRAVE = {"Scale": 3.0, "Detail": 2.4, "Dimension": 0.7, "Lacunarity": 1.8}
FRACTALS = "MULTIFRACTAL RIDGED_MULTIFRACTAL HYBRID_MULTIFRACTAL FBM HETERO_TERRAIN".split()
BRICKS = {"Scale": 3.0, "Mortar Size": 0.1, "Bias": 0.1, "Color1": (0.9, 0.2, 0.1, 1), "Color2": (0.3, 0.6, 0.1, 1)}


LINES = [[(-0.2, 0.9), (1.3, 0.1), (0.2, 0.1), (0.6, 0.8)], [(0.1, 0.3), (0.9, 0.4), (0.5, 0.9)],
         [(0, 0.2), (1, 1.4), (0.7, 0.1)], [(0, 0.1), (1, 0.9), (0.4, 0.6)]]
RANGES = ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP")
ENDS = ((0.2, 0.8, 1.5, -0.5), (0.9, 0.1, 0.0, 1.2), (0.4, 0.4, 0.3, 0.9))


def ends(four, steps=3.0, vector=False):
    names = ("From Min", "From Max", "To Min", "To Max", "Steps")
    names = [name.replace(" ", "_") + "_FLOAT3" for name in names] if vector else names
    values = [*four, steps]
    return dict(zip(names, [[v, v + 0.05, v - 0.02] for v in values] if vector else values))


PATTERNS = [
    *(place(kind, fed={socket: (1.6, -0.3)}, inputs={factor: by}, curves=LINES[:curves], extend=extend)
      for kind, socket, factor, curves in (("RGBCurve", "Color", "Fac", 4), ("VectorCurve", "Vector", "Fac", 3),
                                           ("FloatCurve", "Value", "Factor", 1))
      for by in (1.0, 0.7) for extend in ("EXTRAPOLATED", "HORIZONTAL")),
    *(place("Blackbody", fed={"Temperature": (by, more)}, times=0.1)
      for by, more in ((14000.0, -200.0), (2500.0, 700.0))),
    place("Wavelength", fed={"Wavelength": (500.0, 340.0)}, times=0.5),
    *(place("MapRange", set={"interpolation_type": kind, "clamp": clamp}, inputs=ends(four),
            fed={"Value": (1.0, 0.0)}) for kind in RANGES for clamp in (True, False) for four in ENDS),
    *(place("MapRange", "Vector", set={"interpolation_type": kind, "clamp": clamp, "data_type": "FLOAT_VECTOR"},
            inputs=ends(four, vector=True), fed={"Vector": (1.0, 0.0)})
      for kind in RANGES for clamp in (True, False) for four in ENDS),
    place("MapRange", set={"interpolation_type": "STEPPED"}, inputs=ends(ENDS[0], 0.0), fed={"Value": (1.0, 0.0)}),
    *(place("VectorRotate", set={"rotation_type": kind, "invert": invert},
            inputs={"Center": (0.1, 0.4, -0.2), **more}, fed={"Vector": (2.0, -1.0)} | fed)
      for kind, more in (("AXIS_ANGLE", {"Axis": (1, 2, -0.5), "Angle": 0.8}), ("AXIS_ANGLE", {"Axis": (0, 0, 0)}),
                         ("X_AXIS", {"Angle": 0.8}), ("Y_AXIS", {"Angle": 0.8}), ("Z_AXIS", {"Angle": 0.8}),
                         ("EULER_XYZ", {"Rotation": TURN}))
      for invert in (False, True) for fed in ({}, {"Rotation" if kind[0] == "E" else "Angle": (2.0, 0.1)})),
    place("VectorRotate", inputs={"Angle": 0.8}, fed={"Vector": (2.0, -1.0), "Axis": (1.5, -0.4)}),
    *(place("Normal", output, own=(0.48, 0.36, 0.8), fed={"Normal": (2.0, -0.7)}) for output in ("Normal", "Dot")),
    *(place("TexNoise", output, set={"noise_dimensions": size}, inputs=of(size, **NOISE, Distortion=by))
      for size in DIMENSIONS for output, by in ((0, 0.0), ("Color", 0.6))),
    *(place("TexNoise", 0, set={"noise_type": kind, "normalize": False}, since="4.1",
            inputs=NOISE | {"Lacunarity": 1.8, **({"Offset": 0.7} if "H" in kind or "RI" in kind else {})})
      for kind in FRACTALS),
    *(place("TexMusgrave", 0, set={"musgrave_type": kind, "musgrave_dimensions": size}, until="4.1",
            inputs=of(size, **MUSGRAVE, **({"Offset": 0.7} if "H" in kind or "RI" in kind else {})))
      for kind in FRACTALS for size in (DIMENSIONS if kind == "FBM" else ("3D",))),
    *(place("TexMusgrave", 0, set={"musgrave_type": kind}, until="4.1", inputs=MUSGRAVE | {"Detail": 0.4})
      for kind in FRACTALS),
    *(place("TexVoronoi", output, set={"voronoi_dimensions": size, "feature": feature},
            inputs=of(size, Scale=3.0, Randomness=0.9))
      for size in DIMENSIONS for feature, outputs in (
          ("F1", ("Distance", "Color", "W" if size == "1D" else "Position")), ("F2", ("Distance", "Color")),
          ("SMOOTH_F1", ("Distance", "Color", "W" if size in ("1D", "4D") else "Position")),
          ("DISTANCE_TO_EDGE", ("Distance",)), ("N_SPHERE_RADIUS", ("Radius",))) for output in outputs),
    *(place("TexVoronoi", output, set={"voronoi_dimensions": size, "feature": feature, "normalize": even}, since="4.0",
            inputs=of(size, Scale=2.0, Randomness=0.9, Roughness=0.6, Lacunarity=1.8, Detail=detail))
      for size, detail, even in (("1D", 1.0, False), ("2D", 2.4, True), ("3D", 1.3, False), ("4D", 0.7, True))
      for feature, outputs in (("F1", ("Distance", "Color", "W" if size == "1D" else "Position")),
                               ("F2", ("Distance", "Color")), ("SMOOTH_F1", ("Distance", "Color")),
                               ("DISTANCE_TO_EDGE", ("Distance",)), ("N_SPHERE_RADIUS", ("Radius",)))
      for output in outputs),
    *(place("TexVoronoi", "Distance", set={"feature": feature}, inputs={"Scale": 2.0, "Lacunarity": 1.7, "Roughness": 0.4},
            fed={"Detail": (6.0, -0.5)}, since="4.0") for feature in ("F1", "DISTANCE_TO_EDGE")),
    *(place("TexVoronoi", "Distance", set={"distance": metric, "feature": feature},
            inputs={"Scale": 3.0, **({"Exponent": 0.7} if metric == "MINKOWSKI" else {})})
      for metric in ("MANHATTAN", "CHEBYCHEV", "MINKOWSKI") for feature in ("F1", "F2")),
    *(place("TexVoronoi", "Distance", set={"distance": metric, "feature": feature, "normalize": True}, since="4.0",
            inputs={"Scale": 3.0}) for metric, feature in (
                ("EUCLIDEAN", "F1"), ("MANHATTAN", "F2"), ("MINKOWSKI", "F1"), ("EUCLIDEAN", "DISTANCE_TO_EDGE"))),
    *(place("TexChecker", output, inputs={"Scale": 4.0}) for output in ("Color", "Fac")),
    *(place("TexGradient", "Fac", set={"gradient_type": kind}) for kind in (
        "LINEAR QUADRATIC EASING DIAGONAL SPHERICAL QUADRATIC_SPHERE RADIAL".split())),
    *(place("TexMagic", "Color", set={"turbulence_depth": depth}, inputs={"Scale": 1.5, "Distortion": 1.2})
      for depth in (0, 1, 2, 5, 10)),
    place("TexMagic", "Fac"),
    *(place("TexWave", 0, set={"wave_type": kind, f"{kind.lower()}_direction": way, "wave_profile": profile},
            inputs={"Scale": 0.7, "Distortion": by, "Phase Offset": 0.4})
      for kind, way, profile, by in (
          ("BANDS", "X", "SIN", 0.0), ("BANDS", "Y", "SAW", 2.0), ("BANDS", "Z", "TRI", 0.0), ("BANDS", "DIAGONAL", "SIN", 1.0),
          ("RINGS", "X", "SIN", 0.0), ("RINGS", "Y", "SIN", 0.0), ("RINGS", "Z", "TRI", 3.0), ("RINGS", "SPHERICAL", "SIN", 0.0))),
    *(place("RadialTiling", output, set={"normalize": even}, inputs={"Sides": sides, "Roundness": round_}, times=times, since="5.0",
            fed={"Vector": ([2.3, 2.1, 0.0], [-1.2, -1.1, 0.0])})
      for sides, round_ in ((5.0, 0.0), (4.6, 0.0), (2.0, 0.0), (6.0, 0.4), (3.0, 1.0))
      for output, even, times in (("Segment Coordinates", False, 0.25), ("Segment Coordinates", True, 0.25), ("Segment ID", False, 0.05),
                                  ("Segment Width", False, 0.1), ("Segment Rotation", False, 0.05))),
    *(place("TexBrick", output, inputs=BRICKS | more, set={"squash": 0.8, "squash_frequency": 3, "offset": 0.3})
      for output in ("Color", "Fac") for more in ({}, {"Mortar Smooth": 0.5}, {"Mortar Smooth": 0.0})),
    *(place("TexGradient", "Fac", set={"gradient_type": kind}, fed={"Vector": ([4.0, 4.0, 0.0], [-1.0, -2.0, -0.3])})
      for kind in "LINEAR QUADRATIC EASING DIAGONAL SPHERICAL QUADRATIC_SPHERE RADIAL".split()),
]


def test_patterns_are_those_of_cycles(blender, tmp_path):
    """Two of 49 places may be on the other side of a border."""
    cases = [case for case in PATTERNS if case["since"] <= blender.version < case.get("until", "9")]
    blender.scene("places", tmp_path, engine="LIBSHADE", cases=cases, perspective=False)
    ours = Dump(tmp_path / "dump.exr")["Color"]
    blender.scene("places", tmp_path, engine="CYCLES", dump="", cases=cases, perspective=False)
    cycles = rgba(tmp_path / "picture.exr")[..., :3].clip(0, 1)
    far, flat = [], 0
    for column, case in enumerate(cases):
        a, b = (picture[5:12, 16 * column + 5:16 * column + 12] for picture in (ours, cycles))
        error = np.abs(a - b).max(-1).ravel()
        flat += b.std() < 1e-3
        if not np.sort(error)[-3] < 2e-4:
            far.append((case, np.sort(error)[-3], a[3, 3], b[3, 3]))
    assert not far, "\n".join(map(str, far))
    assert flat < 3 + len(cases) / 8


WAYS = [("Is Camera Ray", "Is Shadow Ray", "Is Diffuse Ray"), ("Is Glossy Ray", "Is Singular Ray", "Is Reflection Ray"),
        ("Is Transmission Ray", "Ray Length", "Ray Depth"), ("Diffuse Depth", "Glossy Depth", "Transparent Depth"),
        ("Transmission Depth", "Ray Length", "Is Camera Ray")]


@pytest.mark.parametrize("shadow", [False, True])
@pytest.mark.parametrize("outputs", WAYS)
def test_ways_are_those_of_cycles(blender, tmp_path, outputs, shadow):
    """What Light Path says of rays from all kinds of surface, and of shadow rays through two panes."""
    pictures = []
    for engine in ("LIBSHADE", "CYCLES"):
        blender.scene("ways", tmp_path, engine=engine, dump="", outputs=outputs, shadow=shadow, samples=64,
                      scale=0.05 if "Ray Length" in outputs else 0.3)
        pictures.append(rgba(tmp_path / "picture.exr")[..., :3].astype(float))
    if shadow:
        ours, theirs = (np.stack([p[4:28, x:x + 24] for x in (4, 36)]) for p in pictures)
        assert theirs.mean((1, 2)).min() > 0
        np.testing.assert_allclose(ours, theirs, rtol=2e-3, atol=2e-4)
        return
    ours, theirs = (p[2:6].reshape(4, -1, 8, 3)[:, :, 2:6].mean((0, 2)) for p in pictures)
    np.testing.assert_allclose(ours, theirs, rtol=4e-3)


BUMPS = {"image": {}, "inverted": {"invert": True, "strength": 0.5, "distance": 0.4},
         "mapped": {"mapping": 2.0, "distance": 0.1}, "position": {"position": True, "distance": 0.4},
         "two": {"chain": True}, "other map": {"other": True},
         "displaced": {"displaced": "OBJECT"}, "displaced in the world": {"displaced": "WORLD"},
         "displaced steeply": {"displaced": "OBJECT", "height": 1.5},
         "displaced by a vector": {"displaced": "OBJECT", "by": "VectorDisplacement"},
         "displaced in the tangent's space": {"displaced": "TANGENT", "by": "VectorDisplacement"},
         "displaced and bumped": {"displaced": "WORLD", "chain": True, "distance": 0.1},
         "wide": {"filter": 12.0}, "far": {"mapping": 9.0, "distance": 0.03, "filter": 1.0},
         "perspective": {"mapping": 9.0, "distance": 0.03, "filter": 1.0, "perspective": True},
         "mirror": {"mapping": 9.0, "distance": 0.03, "filter": 1.0, "mirror": True}}


@pytest.mark.parametrize("case", BUMPS)
def test_bumps_are_those_of_cycles(blender, tmp_path, case):
    """A matt plate whose smooth heights a low sun lights: read as far apart as a pixel is wide, here and
    seen in a mirror."""
    pictures = []
    for engine in ("LIBSHADE", "CYCLES"):
        blender.scene("heights", tmp_path, engine=engine, dump="", **BUMPS[case])
        pictures.append(rgba(tmp_path / "picture.exr")[..., 0].astype(float))
    ours, theirs = pictures
    assert theirs.std() > 0.05 * theirs.mean()  # there are bumps
    limit = 0.01 if case == "displaced steeply" else 0.001
    assert abs(ours.mean() / theirs.mean() - 1) < limit
    blocks = (ours - theirs).reshape(16, 8, 16, 8).mean((1, 3))
    assert np.abs(blocks).mean() < limit * theirs.mean()


def test_new_nodes_say_nothing_unknown(blender, tmp_path):
    assert "all asserted" in blender.inside("later.py", "stock", tmp_path)


@pytest.mark.parametrize("what", ["planted", "chosen", "unsure"])
def test_what_is_not_known_of_a_node_is_named(blender_new, tmp_path, what):
    assert "all asserted" in blender_new.inside("later.py", what, tmp_path)


def test_every_node_has_a_case():
    keys = []
    for file in (ROOT / "blender_addon_c/export").glob("node_*.py"):
        (table,) = (n.value for n in ast.parse(file.read_text()).body
                    if isinstance(n, ast.Assign) and getattr(n.targets[0], "id", "") == "NODES")
        keys += [key.value if isinstance(key, ast.Constant) else key.id for key in table.keys]
    types = {"UVMAP": "UVMap", "NEW_GEOMETRY": "NewGeometry",
             "VECT_MATH": "VectorMath", "MIX_RGB": "MixRGB", "VALTORGB": "ValToRGB",
             "SEPRGB": "SeparateRGB", "SEPXYZ": "SeparateXYZ", "COMBRGB": "CombineRGB",
             "COMBXYZ": "CombineXYZ", "SEPHSV": "SeparateHSV", "COMBHSV": "CombineHSV", "HUE_SAT": "HueSaturation", "BRIGHTCONTRAST": "BrightContrast", "RGBTOBW": "RGBToBW",
             "RGB": "RGB", "CURVE_RGB": "RGBCurve", "CURVE_VEC": "VectorCurve", "CURVE_FLOAT": "FloatCurve",
             "CAMERA": "CameraData", "VECT_TRANSFORM": "VectorTransform"}
    types["ShaderNodeRadialTiling"] = "RadialTiling"
    # test_blender_semantics.py, test_blender_scratches.py, test_blender_lights.py, inside/later.py, and here
    elsewhere = {"MENU_SWITCH", "REPEAT_INPUT", "BUMP", "DISPLACEMENT", "VECTOR_DISPLACEMENT", "SCRATCHES", "TEX_IES"}
    covered = {case["node"].removeprefix("ShaderNode") for case in CASES + PLACES + PATTERNS}
    for key in keys:
        word = types.get(key, key.title().replace("_", ""))
        assert word in covered or key in elsewhere, f"{key}: give it a case"
