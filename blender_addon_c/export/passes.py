# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes beside the picture: what a view layer asks for, as the native module's planes."""

from collections import namedtuple

from .. import versions
from . import groups
from .aov import OCCLUSION_NAME, of_nodes

# The view layer's property (or that of its `libshade`, or the scene's), Blender's name, what its channels are called, how Blender shows it,
# and the native module's plane.
Pass = namedtuple("Pass", "wanted_by name channels kind plane")

NOISY = "NOISY"  # the picture that was denoised, which is no plane
AOV = "AOV"  # a picture of its own


def _pass(wanted_by, name, long_name, channels, kind, plane):
    return Pass(f"use_pass_{wanted_by}", long_name if versions.LONG_PASS_NAMES else name, channels, kind, plane)


def _light_passes():
    for kind, short in (("diffuse", "Diff"), ("glossy", "Gloss"), ("transmission", "Trans")):
        for part, end in (("direct", "Dir"), ("indirect", "Ind"), ("color", "Col")):
            yield _pass(f"{kind}_{part}", short + end, f"{kind} {part}".title(), "RGB", "COLOR",
                        f"{kind}_{part}".upper())


# In the order of Cycles, and so of a file's channels.
PASSES = (
    _pass("z", "Depth", "Depth", "Z", "VALUE", "DEPTH"),
    _pass("mist", "Mist", "Mist", "Z", "VALUE", "MIST"),
    _pass("position", "Position", "Position", "XYZ", "VECTOR", "POSITION"),
    _pass("normal", "Normal", "Normal", "XYZ", "VECTOR", "NORMAL"),
    _pass("vector", "Vector", "Vector", "XYZW", "VECTOR", "VECTOR"),
    _pass("uv", "UV", "UV", "UVA", "VECTOR", "UV"),
    _pass("object_index", "IndexOB", "Object Index", "X", "VALUE", "OBJECT"),
    _pass("material_index", "IndexMA", "Material Index", "X", "VALUE", "MATERIAL"),
    *_light_passes(),
    _pass("emit", "Emit", "Emission", "RGB", "COLOR", "EMISSION"),
    _pass("environment", "Env", "Environment", "RGB", "COLOR", "ENVIRONMENT"),
    Pass("use_pass_ambient_occlusion", OCCLUSION_NAME, "RGB", "COLOR", AOV),
)
CATCHER = "SHADOW_CATCHER"  # of several pictures
_CATCHER = Pass("use_pass_shadow_catcher", "Shadow Catcher", "RGB", "COLOR", CATCHER)
_COUNT = Pass("pass_debug_sample_count", "Debug Sample Count", "X", "VALUE", "SAMPLES")
_TO_DENOISE = (
    Pass("denoising_store_passes", "Denoising Normal", "XYZ", "VECTOR", "SEEN_NORMAL"),
    Pass("denoising_store_passes", "Denoising Albedo", "RGB", "COLOR", "ALBEDO"),
    Pass("denoising_store_passes", "Denoising Depth", "Z", "VALUE", "DISTANCE"),
)
# After those of names, whose number is the view layer's.
_LAST = (
    Pass("use_denoising", "Noisy Image", "RGBA", "COLOR", NOISY),
    *((_TO_DENOISE[k] for k in (1, 0, 2)) if versions.MORE_TO_DENOISE else _TO_DENOISE),
)

# Properties of what no plane stands for yet, where the Blender that runs has them.
_UNKNOWN = {
    "use_pass_shadow": "Shadow",
    **{f"use_pass_subsurface_{part}": f"Subsurface {part.capitalize()}"
       for part in ("direct", "indirect", "color")},
}


def passes_of(scene, view_layer):
    """Those that the view layer asks for and the engine has."""
    owners = {"use_denoising": scene.libshade, **dict.fromkeys(
        ("denoising_store_passes", "pass_debug_sample_count", "use_pass_shadow_catcher"), view_layer.libshade)}
    known = [p for p in (*PASSES, _CATCHER, _COUNT, *_mattes(view_layer), *_LAST)
             if getattr(owners.get(p.wanted_by, view_layer), p.wanted_by)]
    known += [Pass("lightgroups", groups.pass_of(name), "RGB", "COLOR", AOV) for name in groups.names_of(view_layer)]
    return known + [Pass("aovs", name, "RGBA" if kind == "COLOR" else "X", kind, AOV) for name, kind in of_nodes(view_layer)]


def _mattes(view_layer):
    """Layers of two names each, of every kind; their channels are written as Cycles writes them."""
    layers = (min(16, view_layer.pass_cryptomatte_depth) + 1) // 2
    return [Pass(f"use_pass_cryptomatte_{kind}", f"Crypto{kind.title()}{layer:02}", "rgba", "COLOR",
                 f"{kind.upper()}_MATTE{layer:02}")
            for kind in ("object", "material", "asset") for layer in range(layers)]


def world_of_layer(scene, view_layer):
    """The world that it is rendered in: from 5.0 on a layer may have one of its own."""
    return getattr(view_layer, "world_override", None) or scene.world


def planes_of(passes, world):
    """What the native module reads for them."""
    planes = {"planes": [{"type": p.plane} for p in passes
                         if p.plane not in (NOISY, CATCHER, AOV) and "_MATTE" not in p.plane]}
    if any(p.plane == "MIST" for p in passes):
        settings = world.mist_settings if world else None
        planes["mist"] = {"start": settings.start if settings else 0.0,
                          "depth": settings.depth if settings else 100.0,
                          "falloff": settings.falloff if settings else "LINEAR"}
    return planes


def exposure_of(scene):
    """What Cycles multiplies light by before the picture is shown or saved; 1 without that add-on."""
    return getattr(getattr(scene, "cycles", None), "film_exposure", 1.0)


def is_light(found):
    """Does a pass show light, which exposure is for? The others say what there is."""
    return found.plane in ("EMISSION", "ENVIRONMENT", NOISY) or found.plane.endswith(("_DIRECT", "_INDIRECT"))


def have_colors(scene, view_layer):
    """Do any need the colours of surfaces? Light of each kind is divided by these."""
    return any(p.plane.endswith(("_DIRECT", "_INDIRECT", "_COLOR"))
               for p in passes_of(scene, view_layer))


def passes_left_out(view_layer, messages):
    """A warning that names those it asks for in vain."""
    left_out = [name for key, name in _UNKNOWN.items() if getattr(view_layer, key, False)]
    left_out += [f"AOV '{one.name}', whose name another has" for one in getattr(view_layer, "aovs", ()) if not one.is_valid]
    cycles = getattr(view_layer, "cycles", None)
    left_out += [f"Volume {part.capitalize()}" for part in ("direct", "indirect", "scatter", "transmit", "majorant")
                 if getattr(cycles, f"use_pass_volume_{part}", False)]
    if versions.MORE_TO_DENOISE and view_layer.libshade.denoising_store_passes:
        left_out += ["Denoising Specular Albedo", "Denoising Roughness"]
    if left_out:
        messages.warning(f"view layer '{view_layer.name}': passes that are not rendered: "
                         f"{', '.join(left_out)}")
