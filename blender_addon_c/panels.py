# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the engine, and Blender's own ones that serve it as they are."""

import bpy

from .cycles_settings import LIBSHADE_OT_copy_cycles_settings
from .export import blur_settings
from .manual import draw_button
from .names import ENGINE
from .nodes import LIBSHADE_OT_convert_to_group
from .saved import LIBSHADE_OT_save_scene
from .studio import LIBSHADE_OT_add_studio_light, is_bare

# Marked for every external engine, but they set what libshade does not read.
_NOT_OURS = {
    "DATA_PT_area", "DATA_PT_falloff_curve", "DATA_PT_light", "DATA_PT_spot",
    "RENDER_PT_gpencil", "RENDER_PT_stereoscopy",
}
# Marked for EEVEE only, and right for us too.
_ALSO_OURS = {
    "EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
}


class _Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE


class RENDER_PT_libshade_sampling(_Panel, bpy.types.Panel):
    bl_label = "Sampling"
    bl_context = "render"

    def draw_header_preset(self, _context):
        self.layout.emboss = "NONE"
        draw_button(self.layout, "blender/rendering.html#sampling", text="")

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.libshade
        if is_bare(context.scene):
            layout.operator(LIBSHADE_OT_add_studio_light.bl_idname, icon="WORLD")
        layout.prop(settings, "samples", text="Render")
        layout.prop(settings, "preview_samples", text="Viewport")
        layout.prop(settings, "time_limit")
        layout.prop(settings, "use_adaptive_sampling")
        column = layout.column(align=True)
        column.active = settings.use_adaptive_sampling
        column.prop(settings, "adaptive_threshold")
        column.prop(settings, "adaptive_min_samples")
        layout.prop(settings, "light_sampling_threshold")
        column = layout.column(heading="Denoise", align=True)
        column.prop(settings, "use_denoising", text="Render")
        column.prop(settings, "use_preview_denoising", text="Viewport")
        layout.prop(settings, "seed")
        layout.prop(settings, "use_animated_seed")
        layout.operator(LIBSHADE_OT_copy_cycles_settings.bl_idname)
        layout.operator(LIBSHADE_OT_save_scene.bl_idname)


class RENDER_PT_libshade_light_paths(_Panel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_context = "render"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(context.scene.libshade, "max_bounces")
        column = layout.column(align=True)
        for name in ("diffuse", "glossy", "transmission", "transparent_max"):
            column.prop(context.scene.libshade, f"{name}_bounces")
        layout.prop(context.scene.libshade, "groove_transport")
        layout.prop(context.scene.libshade, "bumps_mutual")
        row = layout.row()
        row.active = context.scene.libshade.bumps_mutual
        row.prop(context.scene.libshade, "bumps_are")
        for line in context.scene.libshade.bump_slopes.splitlines():
            layout.label(text=line)
        layout.prop(context.scene.libshade, "sample_clamp_direct")
        layout.prop(context.scene.libshade, "sample_clamp_indirect")
        layout.prop(context.scene.libshade, "blur_glossy")
        layout.prop(context.scene.libshade, "caustics_reflective")
        layout.prop(context.scene.libshade, "caustics_refractive")
        layout.prop(context.scene.libshade, "soft_terminator")


class RENDER_PT_libshade_film(_Panel, bpy.types.Panel):
    bl_label = "Film"
    bl_context = "render"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(context.scene.render, "film_transparent")
        if hasattr(context.scene, "cycles"):
            layout.prop(context.scene.cycles, "film_exposure")
            column = layout.column()
            column.active = context.scene.render.film_transparent
            column.prop(context.scene.cycles, "film_transparent_glass")
            column.prop(context.scene.cycles, "film_transparent_roughness")
        settings = context.scene.libshade
        layout.prop(settings, "pixel_filter_type")
        row = layout.row()
        row.active = settings.pixel_filter_type != "BOX"
        row.prop(settings, "filter_width")
        layout.prop(settings, "texture_blur")
        layout.prop(settings, "filter_normals")


class RENDER_PT_libshade_motion_blur(_Panel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context):
        layout, render = self.layout, context.scene.render
        layout.use_property_split = True
        layout.active = render.use_motion_blur
        if blur_settings(context.scene):
            layout.prop(blur_settings(context.scene), "motion_blur_position", text="Position")
        layout.prop(render, "motion_blur_shutter")
        cycles = getattr(context.scene, "cycles", None)
        if hasattr(cycles, "rolling_shutter_type"):
            layout.prop(cycles, "rolling_shutter_type")
            row = layout.row()
            row.active = cycles.rolling_shutter_type != "NONE"
            row.prop(cycles, "rolling_shutter_duration")
        layout.template_curve_mapping(render, "motion_blur_shutter_curve")


class OBJECT_PT_libshade_motion_blur(_Panel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and hasattr(context.object, "cycles")

    def draw_header(self, context):
        self.layout.prop(context.object.cycles, "use_motion_blur", text="")

    def draw(self, context):
        layout, settings = self.layout, context.object.cycles
        layout.use_property_split = True
        layout.active = context.scene.render.use_motion_blur and settings.use_motion_blur
        layout.prop(settings, "motion_steps", text="Steps")
        if context.object.type != "CAMERA":
            layout.prop(settings, "use_deform_motion", text="Deformation")


class RENDER_PT_libshade_performance(_Panel, bpy.types.Panel):
    bl_label = "Performance"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, render = self.layout, context.scene.render
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(render, "threads_mode")
        row = layout.row()
        row.active = render.threads_mode == "FIXED"
        row.prop(render, "threads")


class VIEWLAYER_PT_libshade_override(_Panel, bpy.types.Panel):
    bl_label = "Override"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop(context.view_layer, "material_override", text="Material")


class RENDER_PT_libshade_share(_Panel, bpy.types.Panel):
    bl_label = "Sharing the File"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context):
        self.layout.operator(
            LIBSHADE_OT_convert_to_group.bl_idname, text="Convert All Nodes to Plain Groups",
        ).all_materials = True


class VIEWLAYER_PT_libshade_passes(_Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        view_layer = context.view_layer
        column = layout.column(heading="Include", align=True)
        for name in ("z", "mist", "position", "normal", "vector", "uv"):
            column.prop(view_layer, f"use_pass_{name}")
        for name in ("denoising_store_passes", "use_pass_shadow_catcher", "pass_debug_sample_count"):
            column.prop(view_layer.libshade, name)
        column = layout.column(heading="Indexes", align=True)
        for name in ("object_index", "material_index"):
            column.prop(view_layer, f"use_pass_{name}")
        for kind in ("diffuse", "glossy", "transmission"):
            column = layout.column(heading=kind.title(), align=True)
            for part in ("direct", "indirect", "color"):
                column.prop(view_layer, f"use_pass_{kind}_{part}", text=part.title())
        column = layout.column(heading="Other", align=True)
        column.prop(view_layer, "use_pass_emit", text="Emission")
        column.prop(view_layer, "use_pass_environment")
        column.prop(view_layer, "use_pass_ambient_occlusion", text="Ambient Occlusion")
        column = layout.column(heading="Cryptomatte", align=True)
        for kind in ("object", "material", "asset"):
            column.prop(view_layer, f"use_pass_cryptomatte_{kind}", text=kind.title())
        layout.prop(view_layer, "pass_cryptomatte_depth", text="Levels")
        layout.prop(view_layer, "pass_alpha_threshold")


class VIEWLAYER_PT_libshade_passes_aov(_Panel, bpy.types.Panel):
    bl_label = "Shader AOV"
    bl_context = "view_layer"
    bl_parent_id = "VIEWLAYER_PT_libshade_passes"

    def draw(self, context):
        bpy.types.VIEWLAYER_PT_layer_passes_aov.draw(self, context)


class VIEWLAYER_PT_libshade_passes_light_groups(_Panel, bpy.types.Panel):
    bl_label = "Light Groups"
    bl_context = "view_layer"
    bl_parent_id = "VIEWLAYER_PT_libshade_passes"

    def draw(self, context):
        bpy.types.VIEWLAYER_PT_layer_passes_lightgroups.draw(self, context)


class _LightGroupPanel(_Panel):
    bl_label = "Light Group"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and cls.of(context)

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop_search(self.of(context), "lightgroup", context.view_layer, "lightgroups", results_are_suggestions=True)


class OBJECT_PT_libshade_light_group(_LightGroupPanel, bpy.types.Panel):
    bl_context = "object"

    @staticmethod
    def of(context):
        return context.object


class WORLD_PT_libshade_light_group(_LightGroupPanel, bpy.types.Panel):
    bl_context = "world"

    @staticmethod
    def of(context):
        return context.world


class DATA_PT_libshade_light(_Panel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.light

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        layout.prop(light, "color")
        layout.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        for name in ("exposure", "normalize"):  # from 4.5 on
            if hasattr(light, name):
                layout.prop(light, name)
        if light.type == "SUN":
            layout.prop(light, "angle")
        elif light.type == "AREA":
            self._draw_area(light)
        else:
            layout.prop(light, "shadow_soft_size", text="Radius")
            if hasattr(light, "use_soft_falloff"):
                layout.prop(light, "use_soft_falloff")
        if light.type == "SPOT":
            layout.prop(light, "spot_size")
            layout.prop(light, "spot_blend", slider=True)
        cycles = getattr(light, "cycles", None)
        if hasattr(cycles, "cast_shadow"):  # until 4.1
            layout.prop(cycles, "cast_shadow", text="Shadow")
        else:
            layout.prop(light, "use_shadow")

    def _draw_area(self, light):
        layout = self.layout
        layout.prop(light, "shape")
        if light.shape in {"RECTANGLE", "ELLIPSE"}:
            layout.prop(light, "size", text="Size X")
            layout.prop(light, "size_y", text="Y")
        else:
            layout.prop(light, "size")
        layout.prop(light, "spread")


class DATA_PT_libshade_panorama(_Panel, bpy.types.Panel):
    bl_label = "Panorama"
    bl_context = "data"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.camera and context.camera.type == "PANO" and cls.settings(context.camera)

    @staticmethod
    def settings(camera):
        """Cycles' until 4.5, then the camera's own."""
        return camera if hasattr(camera, "panorama_type") else getattr(camera, "cycles", None)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        settings = self.settings(context.camera)
        # names by what each type reads
        layout.prop(settings, "panorama_type", text="Type")
        read = {"EQUIRECTANGULAR": ("longitude_", "latitude_"), "FISHEYE_EQUIDISTANT": ("fisheye_fov",),
                "FISHEYE_EQUISOLID": ("fisheye_lens", "fisheye_fov"),
                "FISHEYE_LENS_POLYNOMIAL": ("fisheye_fov", "fisheye_polynomial_"),
                "CENTRAL_CYLINDRICAL": ("central_cylindrical_",)}.get(settings.panorama_type, ())
        column = layout.column(align=True)
        for name in settings.bl_rna.properties.keys():
            if read and name.startswith(read):
                column.prop(settings, name)


class _VisibilityPanel(_Panel):
    bl_label = "Ray Visibility"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        owner, prefix, more = self.of(context)
        layout = self.layout
        layout.use_property_split = True
        column = layout.column()
        for kind in ("camera", "diffuse", "glossy", "transmission", "shadow"):
            if hasattr(owner, prefix + kind):
                column.prop(owner, prefix + kind, text=kind.title())
        for name in more:
            layout.prop(owner, name)


class OBJECT_PT_libshade_visibility(_VisibilityPanel, bpy.types.Panel):
    bl_context = "object"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object

    @staticmethod
    def of(context):
        return context.object, "visible_", ("is_holdout", "is_shadow_catcher")


class WORLD_PT_libshade_visibility(_VisibilityPanel, bpy.types.Panel):
    bl_context = "world"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and hasattr(context.world, "cycles_visibility")

    @staticmethod
    def of(context):
        return context.world.cycles_visibility, "", ()


_CLASSES = (
    RENDER_PT_libshade_sampling, RENDER_PT_libshade_light_paths, RENDER_PT_libshade_film,
    RENDER_PT_libshade_motion_blur, OBJECT_PT_libshade_motion_blur, RENDER_PT_libshade_performance,
    RENDER_PT_libshade_share, VIEWLAYER_PT_libshade_passes, VIEWLAYER_PT_libshade_passes_aov,
    VIEWLAYER_PT_libshade_passes_light_groups, OBJECT_PT_libshade_light_group, WORLD_PT_libshade_light_group, VIEWLAYER_PT_libshade_override,
    DATA_PT_libshade_light, DATA_PT_libshade_panorama, OBJECT_PT_libshade_visibility, WORLD_PT_libshade_visibility,
)


def _simplify():
    """Blender's own panels, but below ours: they would be first in the tab, for they were there before."""
    name = "RENDER_PT_simplify"
    for panel in (getattr(bpy.types, name + part, None) for part in ("", "_viewport", "_render")):
        if panel:
            own = {word: part for word, part in vars(panel).items() if word in ("bl_label", "draw", "draw_header")}
            inside = {"bl_parent_id": "RENDER_PT_libshade_simplify"} if panel.__name__ != name else {"bl_options": {"DEFAULT_CLOSED"}}
            yield type(panel.__name__.replace("_PT_", "_PT_libshade_"), (_Panel, bpy.types.Panel),
                       {"bl_context": "render", **own, **inside})


def _shared_panels():
    for panel in bpy.types.Panel.__subclasses__():
        engines, name = getattr(panel, "COMPAT_ENGINES", ()), panel.__name__.removeprefix("NODE_")  # which shares that set with another
        external = "BLENDER_RENDER" in engines and name not in _NOT_OURS and not name.startswith("RENDER_PT_simplify")
        if name in _ALSO_OURS or (external and "freestyle" not in name):
            yield panel


_registered = []


def register():
    _registered.extend((*_CLASSES, *_simplify()))
    for cls in _registered:
        bpy.utils.register_class(cls)
    for panel in _shared_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    for panel in _shared_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
    while _registered:
        bpy.utils.unregister_class(_registered.pop())
