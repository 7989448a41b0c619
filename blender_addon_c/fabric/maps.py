# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of one repeat of a cloth, which the native module makes, as images of the file: one set for all nodes that are
woven alike, replaced where a node's weave changes, packed, so that they are saved, linked and undone with it."""

import hashlib
import json
import time
from functools import lru_cache

import bpy

from .. import _native

WORDS = ("tilt", "yarns", "tint")
_MARK = "libshade_cloth"  # on images: what they hold
_REST_SECONDS = 5.0


@lru_cache(maxsize=16)
def _made(text):
    made = _native.cloth_images(json.loads(text))
    for word in WORDS:
        if made[word] is not None:
            key = hashlib.sha1(made[word], usedforsecurity=False).hexdigest()
            made[word] = key, bytes(made[word])
    return made


def of(settings):
    """What the native module says of a cloth (cloth_images), pictures as (digest, floats)."""
    return _made(json.dumps({**settings, "transmit": 0.0}, sort_keys=True))


def _there(key):
    return next((image for image in bpy.data.images if image.get(_MARK) == key and not image.library), None)


def may_show(made):
    """Are its pictures there, or may they be made now? A window's renderer reads the file's images with threads of its own."""
    return bpy.app.background or not bpy.app.is_job_running("RENDER") or all(
        made[word] is None or _there(made[word][0]) for word in WORDS)


def image(made, word, name):
    """The file's image of such a picture, or a new one."""
    key, data = made[word]
    known = _there(key)
    if known:
        return known
    new = bpy.data.images.new(f"{name} {word.title()}", *made["size"], alpha=False, is_data=word != "tint")
    new[_MARK] = key
    new.pixels.foreach_set(memoryview(data).cast("f"))
    new.update()
    new.pack()
    return new


def _unused():
    return [image for image in bpy.data.images if image.get(_MARK) and not image.users and not image.library]


def drop():
    """Those that nothing uses any more go; with a window, where a renderer's own thread may still be reading one, by sweep()."""
    if bpy.app.background:
        for old in _unused():
            bpy.data.images.remove(old)


_since = {}  # by name of what nothing uses: when that was seen


def sweep():
    """From a timer: what nothing has used for some seconds, while nothing is rendered for good."""
    unused, now = {image.name: image for image in _unused()}, time.monotonic()
    for name in [name for name in _since if name not in unused]:
        del _since[name]
    for name, image in unused.items():
        if now - _since.setdefault(name, now) > _REST_SECONDS and not bpy.app.is_job_running("RENDER"):
            bpy.data.images.remove(image)
