# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes beside the picture: what a view layer asks for, as the native module's planes."""

from collections import namedtuple

# The view layer's property, Blender's name, what its channels are called, how Blender shows it,
# and the native module's plane.
Pass = namedtuple("Pass", "wanted_by name channels kind plane")

PASSES = (
    Pass("use_pass_z", "Depth", "Z", "VALUE", "DEPTH"),
    Pass("use_pass_position", "Position", "XYZ", "VECTOR", "POSITION"),
    Pass("use_pass_normal", "Normal", "XYZ", "VECTOR", "NORMAL"),
    Pass("use_pass_uv", "UV", "UVA", "VECTOR", "UV"),
    Pass("use_pass_object_index", "IndexOB", "X", "VALUE", "OBJECT"),
    Pass("use_pass_material_index", "IndexMA", "X", "VALUE", "MATERIAL"),
)

# Properties of what no plane stands for yet, where the Blender that runs has them.
_UNKNOWN = {
    "use_pass_mist": "Mist", "use_pass_vector": "Vector", "use_pass_shadow": "Shadow",
    "use_pass_ambient_occlusion": "Ambient Occlusion", "use_pass_emit": "Emission",
    "use_pass_environment": "Environment",
    **{f"use_pass_{what}_{part}": f"{what.capitalize()} {part.capitalize()}"
       for what in ("diffuse", "glossy", "transmission", "subsurface")
       for part in ("direct", "indirect", "color")},
    **{f"use_pass_cryptomatte_{what}": f"Cryptomatte {what.capitalize()}"
       for what in ("object", "material", "asset")},
}


def passes_of(view_layer):
    """Those that the view layer asks for and the engine has."""
    return [p for p in PASSES if getattr(view_layer, p.wanted_by)]


def passes_left_out(view_layer, messages):
    """A warning that names those it asks for in vain."""
    left_out = [name for key, name in _UNKNOWN.items() if getattr(view_layer, key, False)]
    if left_out:
        messages.warning(f"view layer '{view_layer.name}': passes that are not rendered: "
                         f"{', '.join(left_out)}")
