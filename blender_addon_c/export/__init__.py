# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene to the dictionary that the native module renders."""

from .camera import camera_by, camera_of, region_of
from .denoise import denoiser
from .matte import Mattes
from .messages import Messages, SceneError, named
from .passes import passes_left_out, passes_of, planes_of
from .scene import read

__all__ = ["Mattes", "Messages", "SceneError", "camera_by", "camera_of", "denoiser", "named", "passes_left_out", "passes_of",
           "planes_of", "read", "region_of"]
