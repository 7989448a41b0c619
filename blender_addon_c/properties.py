# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the engine: `scene.libshade`, and `view_layer.libshade`."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from . import report
from .nodes import BUMPS


def _update_passes(_settings, context):
    """What a view layer's node in the compositor offers."""
    if context.view_layer:
        context.view_layer.update_render_passes()


class LibshadeViewLayerSettings(bpy.types.PropertyGroup):
    denoising_store_passes: BoolProperty(
        name="Denoising Data",
        description="Passes of the surfaces' normals and colours, that Blender's Denoise node takes",
        default=False, update=_update_passes,
    )
    use_pass_shadow_catcher: BoolProperty(
        name="Shadow Catcher",
        description="What shadows leave of the light of objects that catch them",
        default=False, update=_update_passes,
    )
    pass_debug_sample_count: BoolProperty(
        name="Sample Count",
        description="The part of all samples that each pixel got: adaptive sampling or a time limit end them early",
        default=False, update=_update_passes,
    )


class LibshadeSettings(bpy.types.PropertyGroup):
    samples: IntProperty(
        name="Samples",
        description="Samples per pixel; more give smoother edges and highlights",
        default=64, min=1, soft_max=4096, max=1 << 16,
    )
    preview_samples: IntProperty(
        name="Viewport Samples",
        description="Samples per pixel in the viewport's Rendered mode",
        default=16, min=1, soft_max=256, max=1 << 16,
    )
    seed: IntProperty(
        name="Seed",
        description="Start of the sampling pattern; the same seed gives the same picture",
        default=0, min=0,
    )
    max_bounces: IntProperty(
        name="Max Bounces",
        description="How often light may be reflected on its way after the first surface; with 0 "
                    "surfaces see lamps and the world only, not each other",
        default=12, min=0, max=1024,
    )
    diffuse_bounces: IntProperty(
        name="Diffuse",
        description="How many of them may be off matt surfaces",
        default=4, min=0, max=1024,
    )
    glossy_bounces: IntProperty(
        name="Glossy",
        description="How many of them may be off shining surfaces",
        default=4, min=0, max=1024,
    )
    transmission_bounces: IntProperty(
        name="Transmission",
        description="How many of them may go through surfaces",
        default=12, min=0, max=1024,
    )
    transparent_max_bounces: IntProperty(
        name="Transparent",
        description="Through how many surfaces that are not wholly there a path goes straight on; "
                    "these are no bounces",
        default=8, min=0, max=1024,
    )
    sample_clamp_direct: FloatProperty(
        name="Clamp Direct",
        description="Largest brightness that lamps and the world may add to a sample at the first "
                    "surface; 0 leaves all as it is",
        default=0.0, min=0.0, max=1e8,
    )
    sample_clamp_indirect: FloatProperty(
        name="Clamp Indirect",
        description="Largest brightness that a bounce may add to a sample: less noise, and less "
                    "light where there should be a glare; 0 leaves all as it is",
        default=10.0, min=0.0, max=1e8,
    )
    light_sampling_threshold: FloatProperty(
        name="Light Threshold",
        description="Light of lamps that would add less than this to a surface is left to chance: "
                    "fewer shadow rays, a little more noise, the same picture in the mean; 0: none is",
        default=0.01, min=0.0, max=1.0, precision=4,
    )
    caustics_reflective: BoolProperty(
        name="Reflective Caustics",
        description="Matt surfaces are lit by what shining ones mirror; off: less noise, and too dark",
        default=True,
    )
    caustics_refractive: BoolProperty(
        name="Refractive Caustics",
        description="Matt surfaces are lit through glass; off: less noise, and too dark",
        default=True,
    )
    blur_glossy: FloatProperty(
        name="Filter Glossy",
        description="Shining surfaces that a path meets after a blurry bounce are blurred: less noise, "
                    "softer caustics; 0 leaves them sharp",
        default=1.0, min=0.0, max=10.0,
    )
    texture_blur: FloatProperty(
        name="Texture Blur",
        description="Colours of images are averaged over this part of a pixel, or of what a reflected "
                    "ray stands for: less noise where an image is small in the picture, more of its "
                    "edges with larger numbers; 0: points of the image, as in Cycles",
        default=0.25, min=0.0, max=10.0,
    )
    filter_normals: BoolProperty(
        name="Filter Normal Maps",
        description="Bumps of normal maps that are smaller than what a sample stands for become roughness: "
                    "few samples neither sparkle nor lose the highlight; off: points of the map, as in Cycles",
        default=True,
    )
    groove_transport: BoolProperty(
        name="Grooves Follow Bumps",
        description="Anisotropic shaders of Cycles reflect as the displaced surface would, as Libshade "
                    "Metal does; off: as in Cycles, where only the normal is bent",
        default=True,
    )
    bumps_mutual: BoolProperty(
        name="Bumps Shade Each Other",
        description="Bumps of Cycles' shining shaders shade and light each other, as those of the displaced surface do: "
                    "steep bumps get no darker, and not black; off: as in Cycles, where each is alone",
        default=False,
    )
    bumps_are: EnumProperty(
        name="Bumps Are",
        description="What images and scratches at Normal of Cycles' shining shaders are taken for where bumps shade each other",
        items=BUMPS,
        default="RELIEF",
    )
    bump_slopes: StringProperty(
        name="Bump Slopes",
        description="How steep the bumps of each material are that shade each other, along the strokes and across; of the last render",
        get=lambda self: report.slopes(self.id_data),
    )
    pixel_filter_type: EnumProperty(
        name="Pixel Filter",
        description="How samples around a pixel's middle count",
        items=(("BOX", "Box", "All in the pixel's own square count the same: sharp steps"),
               ("GAUSSIAN", "Gaussian", "Soft"),
               ("BLACKMAN_HARRIS", "Blackman-Harris", "Soft, and sharper than Gaussian")),
        default="BLACKMAN_HARRIS",
    )
    filter_width: FloatProperty(
        name="Width",
        description="Width of the pixel filter",
        default=1.5, min=0.01, max=10.0, subtype="PIXEL",
    )
    soft_terminator: BoolProperty(
        name="Soft Terminator",
        description="Smooth surfaces of few faces cast no shadows of these faces on themselves",
        default=True,
    )
    use_adaptive_sampling: BoolProperty(
        name="Adaptive Sampling",
        description="Parts of the picture that have little noise left get no more samples",
        default=False,
    )
    adaptive_threshold: FloatProperty(
        name="Noise Threshold",
        description="Noise at which a part of the picture is done; 0: by the number of samples",
        default=0.01, min=0.0, max=1.0, precision=4,
    )
    adaptive_min_samples: IntProperty(
        name="Min Samples",
        description="Samples that each pixel gets before; 0: by the threshold",
        default=0, min=0, max=4096,
    )
    use_denoising: BoolProperty(
        name="Denoise",
        description="Take the noise out of a finished render with Open Image Denoise: few samples "
                    "then look like many. Blender brings it from 4.x on; else install pyoidn from "
                    "PyPI for Blender's Python",
        default=False, update=_update_passes,
    )
    use_preview_denoising: BoolProperty(
        name="Denoise Viewport",
        description="Take the noise out of pictures in the viewport's Rendered mode: with Open Image Denoise "
                    "where that is found, else with a simple filter",
        default=True,
    )
    use_animated_seed: BoolProperty(
        name="Animate Seed",
        description="Another sampling pattern for each frame, so that noise does not stand still",
        default=False,
    )
    time_limit: FloatProperty(
        name="Time Limit",
        description="Ends a render after this time, with the samples that it has by then; 0: none",
        default=0.0, min=0.0, max=1e6, step=100, unit="TIME_ABSOLUTE",
    )


def _told(_settings, _context):
    """Blender tells a viewport of what a script sets only where a property has an update function."""


for _setting in (*LibshadeSettings.__annotations__.values(), *LibshadeViewLayerSettings.__annotations__.values()):
    _setting.keywords.setdefault("update", _told)

_OWNERS = ((LibshadeSettings, bpy.types.Scene), (LibshadeViewLayerSettings, bpy.types.ViewLayer))


def register():
    for settings, owner in _OWNERS:
        bpy.utils.register_class(settings)
        owner.libshade = PointerProperty(type=settings)


def unregister():
    for settings, owner in _OWNERS:
        del owner.libshade
        bpy.utils.unregister_class(settings)
