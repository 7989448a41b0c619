# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray visibility: bits of the kinds of ray that do not see something, as in the native module."""

_BITS = {"camera": 1, "diffuse": 2, "glossy": 4, "transmission": 8, "shadow": 16}  # batch/lanes.h
BOUNCED = ("diffuse", "glossy", "transmission")
ALL = tuple(_BITS)
CAMERA, DIFFUSE, SHADOW = (_BITS[kind] for kind in ("camera", "diffuse", "shadow"))


def hidden(owner, kinds, prefix="visible_"):
    """What is not there hides nothing."""
    return sum(_BITS[kind] for kind in kinds if not getattr(owner, prefix + kind, True))


def of_both(owner, maker, kinds):
    """What instances it hides it, too."""
    return hidden(owner, kinds) | (hidden(maker, kinds) if maker else 0)


def is_hidden(bits, *kinds):
    """From all of these?"""
    wanted = sum(_BITS[kind] for kind in kinds)
    return bits & wanted == wanted
