# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the engine: `scene.libshade`."""

import bpy
from bpy.props import FloatProperty, IntProperty, PointerProperty


class LibshadeSettings(bpy.types.PropertyGroup):
    samples: IntProperty(
        name="Samples",
        description="Samples per pixel; more give smoother edges and highlights",
        default=64, min=1, soft_max=4096, max=1 << 16,
    )
    preview_samples: IntProperty(
        name="Viewport Samples",
        description="Samples per pixel in the viewport's Rendered mode",
        default=8, min=1, soft_max=256, max=1 << 16,
    )
    seed: IntProperty(
        name="Seed",
        description="Start of the sampling pattern; the same seed gives the same picture",
        default=0, min=0,
    )
    filter_width: FloatProperty(
        name="Filter Width",
        description="Width of the pixel filter; 0 averages over the pixel's own square",
        default=0.0, min=0.0, max=10.0, subtype="PIXEL",
    )


def register():
    bpy.utils.register_class(LibshadeSettings)
    bpy.types.Scene.libshade = PointerProperty(type=LibshadeSettings)


def unregister():
    del bpy.types.Scene.libshade
    bpy.utils.unregister_class(LibshadeSettings)
