# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise: Blender brings it from 4.x on; PyPI's pyoidn is taken where it is installed."""

import contextlib
import ctypes
import functools
import importlib.util
import os


def denoiser(settings):
    """The settings that the native module reads, {} where none are needed."""
    return {"use_denoising": True, "denoiser": _path()} if settings.use_denoising else {}


def preview_denoiser(settings):
    """The same for a viewport, which does without the library where there is none."""
    return {"use_denoising": True, "denoiser": "?" + _path()} if settings.use_preview_denoising else {}


@functools.cache
def _path():
    """Of the library in pyoidn, or "": the native module then looks among the loaded ones."""
    found = importlib.util.find_spec("pyoidn")
    for folder in (found.submodule_search_locations or ()) if found else ():
        path = os.path.join(folder, "oidn", "lib", "libOpenImageDenoise.so.2")
        if os.path.exists(path):
            # oneTBB would load hwloc so that it frees by libc what jemalloc gave, which Debian's Blender is linked to
            with contextlib.suppress(OSError):
                ctypes.CDLL("libhwloc.so.15")
            return path
    return ""
