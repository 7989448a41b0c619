# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene to the dictionary that the native module renders."""

from . import aov, catcher, groups
from .camera import camera_by, camera_of, region_of
from .denoise import denoiser, preview_denoiser
from .kept import Kept, Later
from .matte import Mattes
from .messages import Messages, SceneError, named
from .motion import blur_settings, motion_of
from .passes import AOV, CATCHER, exposure_of, is_light, passes_left_out, passes_of, planes_of, world_of_layer
from .scene import read

__all__ = ["AOV", "CATCHER", "Kept", "Later", "Mattes", "Messages", "SceneError", "aov", "blur_settings", "camera_by",
           "camera_of", "catcher", "denoiser", "exposure_of", "groups", "is_light", "motion_of", "named", "passes_left_out", "passes_of",
           "planes_of", "preview_denoiser", "read", "region_of", "world_of_layer"]
