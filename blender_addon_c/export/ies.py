# SPDX-License-Identifier: GPL-3.0-or-later
"""Photometric files of lamps (ANSI/IESNA LM-63), as Cycles of the same Blender shows them: a picture of directions.

What Cycles makes of a file was measured (tests/test_blender_lights.py): candelas times both factors and the ballast's, neither lumens,
tilt nor number of lamps; a cubic between angles, where there are none nothing.
"""

import os
import re

import bpy
import numpy as np

from .. import versions

_PER_CANDELA = 0.0706650768  # of a node with strength 1 [measured: 3.4 and 5.0]
MISSING = 100.0  # what it says where there is no file, or none that can be read [measured]
_ROWS, COLUMNS = 720, 360
_MOST = 1 << 20  # of numbers

def text_of(node):
    """What the node's profile says; OSError where it cannot be read."""
    if node.mode == "INTERNAL":
        if not node.ies:
            raise OSError("it has no text")
        return node.ies.as_string()
    path = bpy.path.abspath(node.filepath, library=node.id_data.library)
    if not node.filepath or not os.path.isfile(path):
        raise OSError(f"file not found: {path}")
    with open(path, encoding="utf-8", errors="replace") as file:
        return file.read(_MOST * 16)


def picture(text):
    """The native module's image of a profile: u is the angle about z, a turn of it from 1 / (COLUMNS + 2) on, v that from straight down to
    straight up, 0 to 1. ValueError says by line what is wrong."""
    vertical, horizontal, candela = _closed(*_read(text))
    v = (np.arange(_ROWS) + 0.5) * (180 / _ROWS)
    h = (np.arange(COLUMNS) + 0.5) * (360 / COLUMNS)
    if len(horizontal) == 1:
        h = h[:1]
    else:
        h = np.concatenate([h[-1:], h, h[:1]])  # the image itself does not repeat: down is not beside up
    with np.errstate(over="ignore", invalid="ignore"):  # too large for a number: none
        data = _evaluated(vertical, horizontal, candela, v, h)
    data = np.clip(np.nan_to_num(data * _PER_CANDELA), 0, 1e15).astype(np.float32)
    return {"width": data.shape[1], "height": data.shape[0], "channels": 1, "data": data.ravel(), "srgb": False,
            "wrap": "EXTEND", "filter": "LINEAR", "wide": True, "straight": True}


class _Numbers:
    """What follows TILT, one by one."""

    def __init__(self, lines, first):
        self._words = [(number, word) for number, line in enumerate(lines, first)
                       for word in re.split(r"[\s,;]+", line) if word]
        self._at = 0

    def next(self, what):
        if self._at == len(self._words):
            raise ValueError(f"it ends where {what} was expected")
        line, word = self._words[self._at]
        self._at += 1
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise ValueError(f"line {line}: {what} was expected, not '{word[:20]}'")
        return value

    def some(self, count, what):
        return np.array([self.next(what) for _ in range(count)])

    def whole(self, what):
        value = int(self.next(what))
        if not 0 < value < _MOST:
            raise ValueError(f"{what} is {value}; expected 1 or more")
        return value


def _read(text):
    """(kind, vertical angles, horizontal ones, candelas by horizontal and vertical angle)"""
    lines = text.splitlines()
    at = next((k for k, line in enumerate(lines) if line.strip().startswith("TILT=")), None)
    if at is None:
        raise ValueError("it has no line that begins with TILT=")
    numbers = _Numbers(lines[at + 1:], at + 2)
    if lines[at].strip()[5:].strip() == "INCLUDE":
        numbers.next("the lamp's geometry")
        numbers.some(2 * numbers.whole("the number of tilt angles"), "a tilt angle or factor")
    numbers.some(2, "the number of lamps or lumens")
    factor = numbers.next("the multiplier")
    count_v, count_h = numbers.whole("the number of vertical angles"), numbers.whole("the number of horizontal angles")
    if count_v * count_h > _MOST:
        raise ValueError(f"it has {count_v} times {count_h} angles; {_MOST} are supported")
    kind = int(numbers.next("the photometric type"))
    numbers.some(4, "the unit or size of the opening")
    factor *= numbers.next("the ballast factor") * numbers.next("the ballast-lamp factor")
    numbers.next("the input watts")
    vertical = numbers.some(count_v, "a vertical angle")
    horizontal = numbers.some(count_h, "a horizontal angle")
    for angles, what in ((vertical, "vertical"), (horizontal, "horizontal")):
        if np.any(np.diff(angles) <= 0):
            raise ValueError(f"the {what} angles do not rise")
    with np.errstate(over="ignore", invalid="ignore"):
        candela = numbers.some(count_v * count_h, "a candela value").reshape(count_h, count_v) * factor
    if kind not in (1, 2, 3):
        raise ValueError(f"photometric type {kind}: expected 1, 2 or 3")
    return kind, vertical, horizontal, candela


def _mirrored(angles, values, about, before=False):
    """Angles on one side of what they are mirrored about, and on the other. Values: by angle first."""
    other, twin = 2 * about - angles[::-1], values[::-1]
    if before:
        return np.concatenate([other[:-1], angles]), np.concatenate([twin[:-1], values])
    return np.concatenate([angles, other[1:]]), np.concatenate([values, twin[1:]])


def _closed(kind, vertical, horizontal, candela):
    """As type C has it, all about z and from straight down up."""
    v, h, values = vertical, horizontal, candela
    if kind != 1:
        if kind == 3 and versions.OLD_IES:
            raise ValueError("photometric type A: this Blender's Cycles does not show it")
        if h[0] == 0 and len(h) > 1:
            h, values = _mirrored(h, values, 0.0, before=True)
        if kind == 2:  # its poles lie across
            if v[0] == 0 and len(v) > 1:
                v, values = _mirrored(v, values.T, 0.0, before=True)
                values = values.T
            v, h, values = h + 90, v + 90, values.T
            if versions.OLD_IES:
                h, values = np.append(h, 360.0), np.concatenate([values, values[:1]])
        else:
            v, h, values = v + 90, 180 - h[::-1], values[::-1]
        return v, h, values
    if versions.OLD_IES and v[0] not in (0, 90):
        raise ValueError("its vertical angles begin neither at 0 nor at 90; this Blender's Cycles does not show it")
    if len(h) > 1:
        h = h - (h[0] if versions.OLD_IES or h[0] == 90 else 0)
        if h[-1] == 90:
            h, values = _mirrored(h, values, 90.0)
        if h[-1] == 180:
            h, values = _mirrored(h, values, 180.0)
        elif h[-1] < 360 and abs(360 - h[-1] - (h[-1] - h[-2])) < 1e-3:
            h, values = np.append(h, 360.0), np.concatenate([values, values[:1]])
        if versions.OLD_IES and h[-1] != 360:
            raise ValueError("its horizontal angles do not go all around; this Blender's Cycles does not show it")
    if versions.OLD_IES and v[0] == 90:
        values = values * 0
    return v, h, values


def _cubic(before, one, two, after, t):
    return one + 0.5 * t * (two - before + t * (2 * before - 5 * one + 4 * two - after + t * (3 * (one - two) + after - before)))


def _along(angles, wanted):
    """(index of the one before, how far on to the next, is it between any)"""
    index = np.clip(np.searchsorted(angles, wanted, side="right") - 1, 0, max(len(angles) - 2, 0))
    if len(angles) < 2:
        return index, np.zeros(len(wanted)), np.zeros(len(wanted), bool)
    part = (wanted - angles[index]) / (angles[index + 1] - angles[index])
    return index, part, (part >= 0) & (part < 1)


def _evaluated(vertical, horizontal, values, v, h):
    """Of each v and h, in rows of one v."""
    across = values[:1]
    if len(horizontal) > 1:
        k, t, inside = _along(horizontal, h)
        last = len(horizontal) - 1
        before = np.where(k > 0, k - 1, last - 1 if versions.OLD_IES else 0)
        after = np.where(k + 2 <= last, k + 2, 1 if versions.OLD_IES else last - 1)
        across = np.where(inside[:, None], _cubic(values[before], values[k], values[k + 1], values[after], t[:, None]), 0)
    across = across.T
    k, t, inside = _along(vertical, v)
    if len(vertical) < 2:
        return np.zeros((len(v), across.shape[1]))
    last = len(vertical) - 1
    before, after = np.where(k > 0, k - 1, 1 if vertical[0] == 0 else 0), np.minimum(k + 2, last)
    made = _cubic(across[before], across[k], across[k + 1], across[after], t[:, None])
    return np.where(inside[:, None], made, 0)
