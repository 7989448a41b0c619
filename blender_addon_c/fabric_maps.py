# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of one repeat of a cloth, which the native module makes, as images of the file: one set for all nodes that are
woven alike, replaced where a node's weave changes, packed, so that they are saved, linked and undone with it."""

import hashlib
import json
from functools import lru_cache

import bpy

from . import _native

WORDS = ("tilt", "yarns", "tint")
_MARK = "libshade_cloth"  # on images: what they hold


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


def image(made, word, name):
    """The file's image of such a picture, or a new one."""
    key, data = made[word]
    for other in bpy.data.images:
        if other.get(_MARK) == key and not other.library:
            return other
    new = bpy.data.images.new(f"{name} {word.title()}", *made["size"], alpha=False, is_data=word != "tint")
    new[_MARK] = key
    new.pixels.foreach_set(memoryview(data).cast("f"))
    new.update()
    new.pack()
    return new


def drop(images):
    """Those that nothing uses any more."""
    for old in images:
        if old.get(_MARK) and not old.users and not old.library:
            bpy.data.images.remove(old)
