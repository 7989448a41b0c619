# SPDX-License-Identifier: Apache-2.0
"""The structures of the C headers that this module fills or reads. test_python.py holds the offset and the
size of each member to what a C compiler makes of the headers."""
import ctypes
from ctypes import c_char_p, c_double, c_int, c_size_t, c_uint, c_uint32, c_uint64, c_void_p


def lanes(name, *groups, last=()):
    """A structure of arrays, the same for double and float: `size`, pointers, then numbers."""
    fields = [("size", c_size_t), *((word, c_void_p) for group in groups for word in group.split()), *last]
    return type(name, (ctypes.Structure,), {"_fields_": fields, "c_names": (name, f"{name}f")})


_SLOPES = ("slope_x", "slope_y", "slope_xx", "slope_xy", "slope_yy")
_PARTS = [("parts", c_size_t), *((word, c_void_p) for word in _SLOPES)]
_VARIED = "f82r f82g f82b etar etag etab kr kg kb kdr kdg kdb groove_x groove_y"
Lanes = lanes("shade_lanes", "nx ny nz wix wiy wiz wox woy woz f0r f0g f0b ax ay ex ey", _VARIED, last=_PARTS)
Result = lanes("shade_result", "r g b cosine")
SampleLanes = lanes("shade_sample_lanes", "nx ny nz wox woy woz u1 u2 f0r f0g f0b ax ay ex ey", _VARIED, last=_PARTS)
SampleResult = lanes("shade_sample_result", "wix wiy wiz r g b pdf cosine")
FabricLanes = lanes("shade_fabric_lanes", "u v du dv nx ny nz wix wiy wiz wox woy woz random",
                    "warp_r warp_g warp_b weft_r weft_g weft_b warp_gloss weft_gloss nap u1 u2 u3",
                    last=[("neighbours", c_size_t)])
FabricResult = lanes("shade_fabric_result", "r g b pdf coverage wix wiy wiz")
Crossings = lanes("shade_crossings", "top swap below yarn",
                  "sigma along dx dy tx ty occlusion brightness fuzz r g b")


def structure(name, **fields):
    return type(name, (ctypes.Structure,), {"_fields_": list(fields.items()), "c_names": (name,)})


ParamInfo = structure(
    "shade_param_info", word=c_char_p, unit=c_char_p, help=c_char_p, components=c_int, minimum=c_double,
    maximum=c_double, initial=c_double, list=c_int, choices=c_uint, in_every_dump=c_int, offset=c_size_t)
ListInfo = structure("shade_list_info", word=c_char_p, help=c_char_p, initial=c_int, older=c_int,
                     in_every_dump=c_int, offset=c_size_t)
Metal = structure("shade_metal", word=c_char_p, label=c_char_p, eta=c_double * 3, k=c_double * 3)
# the head of shade_params; the rest is set by row
ParamsHead = structure("shade_params", size=c_size_t)
Bsdf = structure("shade_bsdf", inside=c_double * 128)

Yarn = structure("shade_yarn", along=c_double, across=c_double, f0=c_double * 3, kd=c_double * 3, diffuse=c_int)
FabricParams = structure(
    "shade_fabric_params", size=c_size_t, mdf=c_int, brdf=c_int, detail=c_int, warp=Yarn, weft=Yarn,
    draft_colors=c_int, backing=c_double * 3, nap=c_double, nap_color=c_double * 3, warp_transmit=c_double * 3,
    weft_transmit=c_double * 3, horizon=c_int, shadows=c_int, defaults=c_size_t)
FabricInfo = structure(
    "shade_fabric_info", warp_lobes=c_int, weft_lobes=c_int, warp_share=c_double, weft_share=c_double,
    warp_single=c_double * 2, weft_single=c_double * 2)
YarnParams = structure("shade_yarn_params", **{word: c_double for word in (
    "width gap curve ridge slant segments fibre crimp crimp_length vary_brightness vary_tilt along_brightness "
    "along_tilt slub along_length fuzz").split()})
WeaveParams = structure("shade_weave_params", size=c_size_t, warp=YarnParams, weft=YarnParams, occlusion=c_int,
                        seed=c_uint32)

Slopes = structure("shade_slopes", normal=c_double * 3, mean=c_double * 2, covariance=c_double * 3)
SlopeOptions = structure("shade_slope_options", size=c_size_t, normals=c_int, wrap=c_int, directx=c_int,
                         strength=c_double)
SlopeLobes = structure("shade_slope_lobes", count=c_int, nx=c_double * 8, ny=c_double * 8, nz=c_double * 8,
                       weight=c_double * 8)
Range = structure("shade_range", low=c_double, high=c_double)
ScratchLayer = structure("shade_scratch_layer", pits=c_uint32, radius=Range, stretch=Range, depth=Range,
                         direction=c_double, spread=c_double)
ScratchParams = structure("shade_scratch_params", size=c_size_t, seed=c_uint64, aspect=c_double, cells=c_int,
                          layers=c_int, layer=ScratchLayer * 8)


def preset(params_size):
    """shade_preset, which holds a shade_params of that many bytes."""
    return structure(
        "shade_preset", kind=c_int, word=c_char_p, label=c_char_p, help=c_char_p, source=c_char_p,
        color_source=c_char_p, weave=c_char_p, ends_per_cm=c_double, picks_per_cm=c_double, yarns=WeaveParams,
        fabric=FabricParams, metal=c_double * (params_size // 8), scratches=ScratchParams, scratch_cm=c_double,
        turned=c_int)


ALL = (Lanes, Result, SampleLanes, SampleResult, FabricLanes, FabricResult, Crossings, ParamInfo,
       ListInfo, Metal, ParamsHead, Bsdf, Yarn, FabricParams, FabricInfo, YarnParams, WeaveParams, Slopes,
       SlopeOptions, SlopeLobes, Range, ScratchLayer, ScratchParams)
