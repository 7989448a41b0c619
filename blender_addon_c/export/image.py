# SPDX-License-Identifier: GPL-3.0-or-later
"""Images, each once whatever its uses."""

import os

import bpy
import numpy as np


class Images:
    """`listed`: what the native module gets."""

    def __init__(self, messages):
        self.listed = []
        self._messages = messages
        self._indices = {}  # by image, wrap and filter
        self._pixels = {}  # by image; None: cannot be read

    def index(self, image, wrap, filtering, owner):
        """Index of an image, or -1 when it cannot be used."""
        key = (image, wrap, filtering)
        if key not in self._indices:
            if image not in self._pixels:
                self._pixels[image] = self._fetch(image, owner)
            pixels = self._pixels[image]
            self._indices[key] = -1 if pixels is None else len(self.listed)
            if pixels is not None:
                self.listed.append({**pixels, "wrap": wrap, "filter": filtering})
        return self._indices[key]

    def _fetch(self, image, owner):
        if image.source not in {"FILE", "GENERATED"}:
            self._messages.warning(f"{owner}: image '{image.name}' is a "
                                   f"{image.source.lower()}: only single images are supported")
            return None
        path = os.path.normpath(bpy.path.abspath(image.filepath, library=image.library))
        on_disk = image.source == "FILE" and not image.packed_file and not image.is_dirty
        if on_disk and not os.path.isfile(path):
            self._messages.error(f"{owner}: image file not found: {path}")
            return None
        width, height = image.size
        if not width or not height:
            self._messages.error(f"{owner}: image '{image.name}' cannot be read: {path}")
            return None
        data = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(data)
        # Blender hands float images over in linear light, bytes as they are in the file.
        srgb = not image.is_float and image.colorspace_settings.name == "sRGB"
        if not (srgb or image.is_float or image.colorspace_settings.is_data):
            self._messages.warning(f"{owner}: image '{image.name}': colour space "
                                   f"'{image.colorspace_settings.name}' is read as Non-Color")
        return {"width": width, "height": height, "channels": image.channels, "data": data,
                "srgb": srgb}
