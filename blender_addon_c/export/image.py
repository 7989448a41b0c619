# SPDX-License-Identifier: GPL-3.0-or-later
"""Images, each once whatever its uses."""

import os

import bpy
import numpy as np


MISSING = -2  # instead of an index: no file, or none that can be read
MISSING_COLOR = (1.0, 0.0, 1.0)  # as Cycles and the viewport show it


class Images:
    """`listed`: what the native module gets."""

    def __init__(self, messages):
        self.listed = []
        self._messages = messages
        self._indices = {}  # by image, wrap and filter
        self._pixels = {}  # by image; what has no pixels: the index that stands for it

    def index(self, image, wrap, filtering, owner):
        """Index of an image, MISSING, or -1 when it cannot be used."""
        key = (image, wrap, filtering)
        if key not in self._indices:
            if image not in self._pixels:
                self._pixels[image] = self._fetch(image, owner)
            pixels = self._pixels[image]
            self._indices[key] = pixels if isinstance(pixels, int) else len(self.listed)
            if not isinstance(pixels, int):
                self.listed.append({**pixels, "wrap": wrap, "filter": filtering})
        return self._indices[key]

    def _fetch(self, image, owner):
        if image.source not in {"FILE", "GENERATED"}:
            self._messages.warning(f"{owner}: image '{image.name}' is a "
                                   f"{image.source.lower()}: only single images are supported")
            return -1
        path = os.path.normpath(bpy.path.abspath(image.filepath, library=image.library))
        on_disk = image.source == "FILE" and not image.packed_file and not image.is_dirty
        if on_disk and not os.path.isfile(path):
            self._messages.warning(f"{owner}: image file not found: {path}")
            return MISSING
        width, height = image.size
        if not width or not height:
            self._messages.warning(f"{owner}: image '{image.name}' cannot be read: {path}")
            return MISSING
        data = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(data)
        # Blender hands float images over in linear light, bytes as they are in the file.
        srgb = not image.is_float and image.colorspace_settings.name == "sRGB"
        if not (srgb or image.is_float or image.colorspace_settings.is_data):
            self._messages.warning(f"{owner}: image '{image.name}': colour space "
                                   f"'{image.colorspace_settings.name}' is read as Non-Color")
        return {"width": width, "height": height, "channels": image.channels, "data": data,
                "srgb": srgb}
