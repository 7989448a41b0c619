# SPDX-License-Identifier: GPL-3.0-or-later
"""Images, each once whatever its uses."""

import mmap
import os
import struct
import tempfile

import bpy
import numpy as np

from .. import versions, working_space
from .main_thread import on_main_thread


MISSING = -2  # instead of an index: no file, or none that can be read
MISSING_COLOR = (1.0, 0.0, 1.0)  # as Cycles and the viewport show it
_LARGE = 1 << 26  # bytes
_SLICE = 1 << 22  # numbers
_LOOKED_AT = 1 << 14  # of the texels of an image, where a part tells
_MOST_TEXELS = 1 << 28  # of all tiles together


def tiles_of(image):
    """How many tiles lie beside each other and above each other; what is not tiled is one."""
    if image.source != "TILED":
        return 1, 1
    places = [_place(tile.number) for tile in image.tiles]
    return tuple(1 + max(place[axis] for place in places) for axis in (0, 1))


def _place(number):
    return (number - 1001) % 10, (number - 1001) // 10


class Images:
    """`listed`: what the native module gets; `frame`: the scene's."""

    def __init__(self, messages, frame, kept=None):
        self.listed, self.frame = [], frame
        self._messages, self._kept = messages, kept
        self._down, self._slopes, self._ranges = {}, {}, {}  # by index
        self._indices = {}  # by image and file, wrap and filter
        self._pixels = {}  # by image and file; what has no pixels: the index that stands for it

    def index(self, image, wrap, filtering, owner, user=None, apart=False):
        """Index of an image, MISSING, or -1 when it cannot be used. user: says which of a sequence or a movie. apart:
        are colours wanted beside alpha, not as much of them as it leaves?"""
        path = _shown(image, user, self.frame) if user else None
        if image.source == "TILED":  # its tiles are made as large as the largest by it
            path = filtering
        key = (image, path, wrap, filtering, apart)
        if key not in self._indices:
            if (image, path, apart) not in self._pixels:
                self._pixels[image, path, apart] = self._by_alpha(image, owner, path, apart)
            pixels = self._pixels[image, path, apart]
            self._indices[key] = pixels if isinstance(pixels, int) else len(self.listed)
            if not isinstance(pixels, int):
                self.listed.append({**pixels, "wrap": wrap, "filter": filtering})
        return self._indices[key]

    def made(self, image):
        """Index of one that is of no file, as the native module gets it."""
        self.listed.append(image)
        return len(self.listed) - 1

    def points_down(self, index):
        """Is it, as a normal map, below the surface somewhere?"""
        if index not in self._down:
            found = self.listed[index]
            blue = found["data"][2::found["channels"]] if found["channels"] >= 3 else np.empty(0, np.float32)
            self._down[index] = bool(len(blue) and np.nanmin(blue) < 0.49 * _opaque(blue))
        return self._down[index]

    def range_of(self, index):
        """(least, most) of its numbers."""
        if index not in self._ranges:
            data = self.listed[index]["data"]
            least, most = (0.0, 1.0) if data.dtype == np.uint8 else (float(data.min()), float(data.max()))
            self._ranges[index] = (least, most) if np.isfinite(least + most) else (-np.inf, np.inf)
        return self._ranges[index]

    def turned(self, index, slope, strength):
        """Which part of it, as a normal map of that strength, is steeper than a slope; of some of its texels."""
        if index not in self._slopes:
            found = self.listed[index]
            texels = found["data"].reshape(-1, found["channels"])
            texels = texels[::max(1, len(texels) // _LOOKED_AT)].astype(np.float32) / _opaque(texels)
            if found["srgb"]:
                texels = _decoded(texels)
            x, y, z = (2 * texels[:, k if found["channels"] >= 3 else 0] - 1 for k in range(3))
            self._slopes[index] = np.hypot(x, y), z
        along, up = self._slopes[index]
        return float(np.mean(strength * along > slope * (1 + min(strength, 1.0) * (up - 1))))

    def _by_alpha(self, image, owner, path, apart):
        """As Cycles does it: colours are multiplied by alpha, in bytes as they are in the file, and divided again where
        a node's alpha is linked. Not those of data and of channels that are packed."""
        if (image, path) not in self._pixels:
            self._pixels[image, path] = self._find(image, owner, path)
        pixels = self._pixels[image, path]
        if isinstance(pixels, int) or image.alpha_mode not in ("STRAIGHT", "PREMUL") or image.colorspace_settings.is_data:
            return pixels
        straight = pixels["straight"]
        # files of light, and TIFF's of 16 bits, say what they are themselves
        if versions.ALPHA_AS_SAID and not (_is_on_disk(image) and image.is_float and (image.file_format == "TIFF" or not straight)):
            straight = image.alpha_mode == "STRAIGHT"
        if pixels["channels"] not in (2, 4) or straight == apart:
            return pixels
        if not (pixels["data"][pixels["channels"] - 1::pixels["channels"]] < _opaque(pixels["data"])).any():
            return pixels
        if self._kept:
            return self._kept.image(image, (path, apart), lambda: _times_alpha(pixels, straight))
        return _times_alpha(pixels, straight)

    def _find(self, image, owner, path):
        if self._kept:
            return self._kept.image(image, path, lambda: self._fetch(image, owner, path))
        return self._fetch(image, owner, path)

    def _fetch(self, image, owner, path):
        if image.source == "TILED":
            return self._tiled(image, owner, path == "CLOSEST")
        if image.source == "SEQUENCE" and path:
            found = self._loaded(image, path, owner)
            return MISSING if found is None else found
        if image.source not in {"FILE", "GENERATED", "MOVIE"}:
            self._messages.warning(f"{owner}: image '{image.name}' is a "
                                   f"{image.source.lower()}: only images are supported")
            return -1
        frame, path = path, _absolute(image, image.filepath)
        on_disk = image.source in {"FILE", "MOVIE"} and _is_on_disk(image)
        if on_disk and not os.path.isfile(path):
            self._messages.warning(f"{owner}: image file not found: {path}")
            return MISSING
        if not all(image.size):
            self._messages.warning(f"{owner}: image '{image.name}' cannot be read: {path}")
            return MISSING
        if on_disk and image.source == "FILE" and _is_divided(image):
            found = self._loaded(image, path, owner)
            return MISSING if found is None else found
        if image.source != "MOVIE":
            return self._read(image, owner)
        try:
            return on_main_thread(lambda: self._movie(image, frame, owner))
        except (RuntimeError, TimeoutError) as error:
            self._messages.warning(f"{owner}: image '{image.name}': {str(error).strip()}")
            return MISSING

    def _movie(self, image, frame, owner):
        """One frame. `pixels` are of the one that was asked for last, by whatever has an image user: a texture."""
        asks = bpy.data.textures.new("libshade", "IMAGE")
        try:
            asks.image, asks.image_user.frame_current = image, frame
            asks.evaluate((0.0, 0.0, 0.0))
            return self._read(image, owner)
        finally:
            bpy.data.textures.remove(asks)

    def _read(self, image, owner):
        width, height = image.size
        count = width * height * image.channels
        data, pages = _room(count, np.float32) if image.is_float else (np.empty(count, np.float32), None)
        image.pixels.foreach_get(data)
        if not image.is_float:
            data, pages = _bytes(data)
        wide = image.is_float and not (data.min() >= 0 and data.max() <= 1)
        if image.is_float:
            _leave(pages, 0, data.nbytes)
        # Blender hands float images over in linear light, bytes as they are in the file. Cycles mixes the latter as they
        # are there where that is the working space's light.
        srgb = (image.colorspace_settings.name == "sRGB" and not working_space.from_rec709()
                and (not image.is_float or not wide and _is_of_integers(image)))
        straight = not image.is_float or srgb
        if image.is_float and srgb:
            _encode(data, image.channels, image.alpha_mode != "CHANNEL_PACKED")
        if straight and not srgb and not image.colorspace_settings.is_data:
            data, pages, wide = self._in_scene_light(image, data, pages, owner)
        return {"width": width, "height": height, "channels": image.channels, "data": data,
                "srgb": srgb, "paged": pages is not None, "wide": wide, "straight": straight}

    def _in_scene_light(self, image, data, pages, owner):
        """Bytes of a colour space that the native module does not know, as floats, with what holds them and whether any is
        beyond 0 to 1. Blender converts what it reads from a file of floats: one of all colours that there are."""
        count, space = image.channels, image.colorspace_settings.name
        texels = data.reshape(-1, count)
        whole = [texels[:, k if count >= 3 else 0].astype(np.int32) for k in range(3)]
        whole = whole[0] << 16 | whole[1] << 8 | whole[2]
        seen = np.zeros(1 << 24, bool)
        seen[whole] = True
        colors = np.flatnonzero(seen)
        try:
            made = on_main_thread(lambda: _converted(colors, space))
        except (RuntimeError, TimeoutError, OSError) as error:
            self._messages.warning(f"{owner}: image '{image.name}': colour space '{space}' is read as Non-Color "
                                   f"({str(error).strip()})")
            return data, pages, False
        place = np.zeros(1 << 24, np.int32)
        place[colors] = np.arange(len(colors))
        floats, room = _room(data.size, np.float32)
        lit = floats.reshape(-1, count)
        lit[:, :min(count, 3)] = made[place[whole]][:, :3 if count >= 3 else 1]
        if count in (2, 4):
            lit[:, -1] = texels[:, -1] / np.float32(255)
        _leave(room, 0, floats.nbytes)
        return floats, room, bool(made.min() < 0 or made.max() > 1)

    def _loaded(self, like, path, owner, packed=None):
        """Pixels of a file that Blender shows as a part of an image; None without any."""
        def load():
            if packed:
                one = bpy.data.images.new("libshade", 1, 1)
                one.pack(data=packed, data_len=len(packed))
                one.source = "FILE"
            else:
                one = bpy.data.images.load(path)
            try:
                one.colorspace_settings.name = like.colorspace_settings.name
                one.alpha_mode = like.alpha_mode
                if not packed and _is_divided(one):
                    one.alpha_mode = "STRAIGHT"
                return self._read(one, owner) if all(one.size) else None
            finally:
                bpy.data.images.remove(one)

        if not packed and not os.path.isfile(path):
            self._messages.warning(f"{owner}: image file not found: {path}")
            return None
        try:
            found = on_main_thread(load)
        except (RuntimeError, TimeoutError) as error:
            self._messages.warning(f"{owner}: {path}: {str(error).strip()}")
            return None
        if found is None:
            self._messages.warning(f"{owner}: image cannot be read: {path}")
        return found

    def _tiled(self, image, owner, closest):
        """All tiles as one image, as large as their largest each; closest: texels are not mixed."""
        packed = {f.tile_number: f.packed_file.data for f in getattr(image, "packed_files", ()) if hasattr(f, "tile_number")}
        tiles = {}
        for tile in image.tiles:
            u, v = _place(tile.number)
            path = image.filepath.replace("<UDIM>", str(tile.number)).replace("<UVTILE>", f"u{u + 1}_v{v + 1}")
            found = self._loaded(image, _absolute(image, path), owner, packed.get(tile.number))
            if found:
                tiles[u, v] = found
        if not tiles:
            return MISSING
        columns, rows = tiles_of(image)
        width, height, channels = (max(t[k] for t in tiles.values()) for k in ("width", "height", "channels"))
        if columns * rows * width * height > _MOST_TEXELS:
            self._messages.warning(f"{owner}: image '{image.name}': {columns} times {rows} tiles are too many")
            return -1
        channels = max(channels, 3)
        kinds = {tile["data"].dtype for tile in tiles.values()}
        whole = np.empty((rows * height, columns * width, channels), kinds.pop() if len(kinds) == 1 else np.float32)
        opaque = _opaque(whole)
        whole[:] = [opaque * part for part in (*MISSING_COLOR, 1)[:channels]]
        for (u, v), tile in tiles.items():
            part = whole[v * height:(v + 1) * height, u * width:(u + 1) * width]
            part[:] = _as_large(tile, width, height, channels, closest) * (opaque / _opaque(tile["data"]))
        return {"width": columns * width, "height": rows * height, "channels": channels, "data": whole.ravel(),
                "srgb": next(iter(tiles.values()))["srgb"], "wide": any(tile["wide"] for tile in tiles.values()),
                "straight": any(tile["straight"] for tile in tiles.values())}


def _is_divided(image):
    """Does Blender divide by alpha what it says of a file of integers? Cycles takes what is in the file, in this mode, too.
    (Of TIFF both say light times alpha, but for bytes later.)"""
    return (image.alpha_mode == "PREMUL" and image.channels == 4
            and (image.file_format != "TIFF" or versions.ALPHA_AS_SAID and not image.is_float)
            and (not image.is_float or _is_of_integers(image)))


def _is_on_disk(image):
    return not (image.packed_file or image.is_dirty or image.source == "GENERATED")


def _is_of_integers(image):
    """Does it lie in a file of 16-bit integers? Cycles mixes these as they are there; packed it takes Blender's light."""
    if not _is_on_disk(image):
        return False
    try:
        with open(_absolute(image, image.filepath), "rb") as file:
            start = file.read(26)
            if start[:8] == b"\x89PNG\r\n\x1a\n":
                return len(start) == 26 and start[24] == 16
            return start[:4] in (b"II*\0", b"MM\0*") and _tiff_is_of_integers(file, "<" if start[:1] == b"I" else ">", start)
    except (OSError, struct.error, UnicodeError):
        return False


def _tiff_is_of_integers(file, order, start):
    """Are its samples, as the first directory says, 16 bits each, and no floats?"""
    file.seek(struct.unpack(order + "I", start[4:8])[0])
    bits, kind = 1, 1
    for _ in range(struct.unpack(order + "H", file.read(2))[0]):
        entry = file.read(12)
        tag, _type, count = struct.unpack(order + "HHI", entry[:8])
        if tag not in (258, 339):
            continue
        value = struct.unpack(order + "H", entry[8:10])[0]
        if count > 2:  # they lie elsewhere
            next_ = file.tell()
            file.seek(struct.unpack(order + "I", entry[8:])[0])
            value = struct.unpack(order + "H", file.read(2))[0]
            file.seek(next_)
        bits, kind = (value, kind) if tag == 258 else (bits, value)
    return bits == 16 and kind == 1


def _decoded(texels):
    """Light of what an sRGB file has."""
    return np.where(texels <= 0.04045, texels / 12.92, ((texels + 0.055) / 1.055) ** 2.4)


def _encode(data, count, by_alpha):
    """Light of 0 to 1, times alpha if that is so, becomes what an sRGB file has, of the same numbers."""
    for start in range(0, len(data), _SLICE // count * count):
        part = data[start:start + _SLICE // count * count].reshape(-1, count)
        color = part[:, :-1] if count in (2, 4) else part
        if by_alpha and count in (2, 4):
            alpha = part[:, -1:]
            color /= np.where(alpha == 0, 1, alpha)
        np.clip(color, 0, 1, out=color)
        color[:] = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1 / 2.4) - 0.055)


def _bytes(data):
    """Of 0 to 1; by parts, so that it takes no more than the result."""
    made, pages = _room(len(data), np.uint8)
    for start in range(0, len(data), 1 << 22):
        part = data[start:start + (1 << 22)]
        np.rint(part * 255, out=part)
        made[start:start + (1 << 22)] = part
        _leave(pages, start, len(part))
    return made, pages


def _leave(pages, start, size):
    """To the file, until the native module reads it."""
    if pages and hasattr(mmap, "MADV_DONTNEED"):
        pages.madvise(mmap.MADV_DONTNEED, start, size)


def _room(count, kind):
    """So many numbers; many of them lie in a file without a name, not in memory."""
    size = count * np.dtype(kind).itemsize
    if size >= _LARGE and hasattr(os, "posix_fallocate"):
        try:
            with tempfile.TemporaryFile() as file:
                os.posix_fallocate(file.fileno(), 0, size)
                pages = mmap.mmap(file.fileno(), size)
            return np.frombuffer(pages, kind), pages
        except OSError:  # no room there
            pass
    return np.empty(count, kind), None


def _opaque(data):
    return 255 if data.dtype == np.uint8 else 1


def _converted(colors, space):
    """Three numbers each, in linear light of the scene, of colours of three bytes in a colour space."""
    side = int(np.ceil(len(colors) ** 0.5))
    pixels = np.ones((side * side, 4), np.float32)
    for k in range(3):
        pixels[:len(colors), k] = (colors >> 8 * (2 - k) & 255) / np.float32(255)
    images = []
    with tempfile.TemporaryDirectory() as folder:
        try:
            images.append(bpy.data.images.new("libshade", side, side, float_buffer=True, is_data=True))
            images[0].pixels.foreach_set(pixels.ravel())
            images[0].filepath_raw, images[0].file_format = os.path.join(folder, "colors.exr"), "OPEN_EXR"
            images[0].save()
            images.append(bpy.data.images.load(images[0].filepath_raw))
            images[1].colorspace_settings.name = space
            images[1].pixels.foreach_get(pixels.ravel())
        finally:
            for image in images:
                bpy.data.images.remove(image)
    return pixels[:len(colors), :3]


def _times_alpha(pixels, straight):
    """An image with its colours times alpha, or, where they are that already, divided by it: light, which may be above 1."""
    given, count = pixels["data"], pixels["channels"]
    data, pages = _room(len(given), given.dtype if straight else np.float32)
    half = 0 if versions.ALPHA_AS_SAID else 127
    for start in range(0, len(given), _SLICE):  # of whole texels: what is in use at once is small
        part = given[start:start + _SLICE].reshape(-1, count)
        alpha, made = part[:, -1:], data[start:start + _SLICE].reshape(-1, count)
        if straight and given.dtype == np.uint8:
            made[:, :-1] = (part[:, :-1].astype(np.uint16) * alpha + half) // 255
        elif straight:
            made[:, :-1] = part[:, :-1] * alpha
        else:
            part, alpha = part / np.float32(_opaque(given)), alpha / np.float32(_opaque(given))
            color = part[:, :-1] / np.where(alpha == 0, 1, alpha)
            made[:, :-1] = _decoded(color) if pixels["srgb"] else color
        made[:, -1:] = alpha
    _leave(pages, 0, data.nbytes)
    wide = pixels["wide"] or data.dtype != np.uint8 and not (data.min() >= 0 and data.max() <= 1)
    return {**pixels, "data": data, "paged": pages is not None, "wide": bool(wide), "srgb": straight and pixels["srgb"]}


def _as_large(tile, width, height, channels, closest):
    """By the nearest texel, or mixed as far as texels are; grey becomes a colour, what has no alpha is opaque."""
    own = tile["data"].reshape(tile["height"], tile["width"], tile["channels"])
    for axis, count in enumerate((height, width)):
        own = _resized(own, axis, count, closest)
    color = own[..., :3] if tile["channels"] >= 3 else np.repeat(own[..., :1], 3, -1)
    alpha = own[..., -1:] if tile["channels"] % 2 == 0 else np.full_like(own[..., :1], _opaque(own))
    return np.concatenate((color, alpha), -1)[..., :channels]


def _resized(texels, axis, count, closest):
    """So many along an axis; beyond an end comes the other one."""
    before = texels.shape[axis]
    if count == before:
        return texels
    if closest:
        return texels.take(np.arange(count) * before // count, axis)
    at = (np.arange(count) + 0.5) * before / count - 0.5
    first = np.floor(at).astype(int)
    part = (at - first).astype(np.float32).reshape((-1,) + (1,) * (2 - axis))
    mixed = texels.take(first % before, axis) * (1 - part) + texels.take((first + 1) % before, axis) * part
    return np.rint(mixed).astype(np.uint8) if texels.dtype == np.uint8 else mixed.astype(texels.dtype)


def _absolute(image, path):
    if os.sep == "/":  # paths that Windows wrote: Blender finds these files, too
        path = path.replace("\\", "/")
    return os.path.normpath(bpy.path.abspath(path, library=image.library))


def _shown(image, user, frame):
    """What a node shows at a scene's frame: of a sequence the file, of a movie the number; None of others."""
    if image.source == "SEQUENCE":
        user.frame_current = _number(user, frame)  # it is the scene's with Auto Refresh alone
        return _absolute(image, image.filepath_from_user(image_user=user))
    return _number(user, frame) if image.source == "MOVIE" else None


def _number(user, frame):
    """Of a frame of the scene that of the images, as Blender has it."""
    count, at = user.frame_duration, frame - user.frame_start + 1
    if not count:
        return 0
    if user.use_cyclic:
        return ((at - 1) % count + user.frame_offset) % count + 1
    return min(max(at, 0), count) + user.frame_offset
