# SPDX-License-Identifier: GPL-3.0-or-later
"""Saved scenes, .shscene, of the format that tool/scene_file.h tells. Needs no Blender."""

import json
import os
import struct
import zlib

import numpy as np

_VERSION, _ALIGNMENT, _PREAMBLE = 1, 64, 16
_MAGIC = b"shscene\n"
# Of a scene, what the exporter keeps for itself.
_OURS = {"aovs", "aov_reach", "by_camera", "catchers", "group", "dump"}


def write(path, layer, pictures, texts=()):
    """pictures: (scene, as the native module takes it, [(pass, channels, plane, exposure)]) of each that is rendered by itself. texts: (name, text) of what the rendered file's header is to say.
    ValueError: a number is not finite."""
    arrays = _Arrays()
    told = [{"layer": layer, "passes": [dict(zip(("name", "channels", "plane", "exposure"), one)) for one in passes],
             "scene": {key: value for key, value in scene.items() if key not in _OURS}} for scene, passes in pictures]
    said = json.dumps([{"name": name, "text": text} for name, text in texts], ensure_ascii=False)
    text = json.dumps(told, default=arrays.told, allow_nan=False, ensure_ascii=False)
    put(path, f'{{"version": {_VERSION}, "texts": {said}, "pictures": {text}, "arrays": {json.dumps(arrays.listed)}}}', arrays.kept)


def put(path, text, arrays):
    """A header and its arrays; the file appears whole or not at all."""
    header = text.encode("utf-8", "replace")  # names of files from elsewhere may be no UTF-8
    header += b" " * (-(_PREAMBLE + len(header)) % _ALIGNMENT)
    part = f"{path}.{os.getpid()}.tmp"
    try:
        with open(part, "wb") as file:
            file.write(_MAGIC + struct.pack("<II", len(header), zlib.crc32(header)) + header)
            for array in arrays:
                file.write(array.data)
                file.write(_after(array))
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def checksum(array):
    return zlib.crc32(_after(array), zlib.crc32(array.reshape(-1).view(np.uint8)))


def _after(array):
    return bytes(-array.nbytes % _ALIGNMENT)


class _Arrays:
    """Those that scenes have, each once."""

    def __init__(self):
        self.kept, self.listed, self._end, self._known = [], [], 0, {}

    def told(self, value):
        """What JSON does not have: a number of NumPy's, or a buffer."""
        if isinstance(value, np.generic):
            return value.item()
        array = np.ascontiguousarray(value if isinstance(value, np.ndarray) else np.asarray(memoryview(value)))
        key = array.__array_interface__["data"][0], array.nbytes, array.dtype.str
        if key not in self._known:
            self._known[key] = len(self.kept)
            self.kept.append(array)
            self.listed.append({"type": array.dtype.name, "shape": array.shape, "offset": self._end, "checksum": checksum(array)})
            self._end += array.nbytes + len(_after(array))
        return {"array": self._known[key]}
