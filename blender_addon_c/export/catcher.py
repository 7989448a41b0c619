# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow catchers: what they show is by how much the other objects dim them. It takes pictures of the catchers with and
without these, and one of the others, in which catchers leave holes."""

import numpy as np

from .visibility import CAMERA

_BESIDE = ("planes", "mattes", "matte_slots", "mist", "dump")  # of the picture alone


def views(scene, apart):
    """The scenes to be rendered, by name, of one that has catchers; else None. "others" is the picture. apart: shadows
    are to be in a pass of their own, and the picture is without, as in Cycles."""
    seen, held = (scene["catchers"][name] for name in ("seen", "held"))
    if not seen:
        return None
    catchers = {id(instance) for instance in seen}
    others = [instance for instance in scene["instances"] if id(instance) not in catchers]
    plain = {key: value for key, value in scene.items() if key not in _BESIDE} | {"dump": "", "transparent": True}
    hidden = [{**instance, "hidden": instance["hidden"] | CAMERA} for instance in others]
    made = {"with": {**plain, "instances": [*seen, *hidden]}, "without": {**plain, "instances": seen}}
    if not apart and not scene["transparent"]:
        made["behind"] = {**plain, "instances": [], "transparent": False}
    return made | {"others": {**scene, "instances": [*others, *held], "transparent": scene["transparent"] or not apart}}


def shadow(pictures):
    """What is left of the light of catchers: 3 numbers a pixel."""
    with_, without = (pictures[name][:, :3] for name in ("with", "without"))
    return np.where(without > 0, with_ / np.where(without > 0, without, 1), 1).astype(np.float32)


def seen_shadow(pictures):
    """The same as a pass: 1 where something is before them."""
    return (1 + (1 - pictures["others"][:, 3:]).clip(0, 1) * (shadow(pictures) - 1)).astype(np.float32)


def composed(pictures):
    """The picture: where nothing is before them, catchers are as opaque as their shadow is dark; none is brighter than what is behind."""
    others, left = pictures["others"], shadow(pictures)
    alpha = others[:, 3:]
    if "behind" in pictures:
        color = others[:, :3] + (1 - alpha) * pictures["behind"][:, :3] * np.minimum(left, 1)
        return np.concatenate([color, np.ones_like(alpha)], 1).astype(np.float32)
    dark = 1 - left.mean(1, keepdims=True)
    return np.concatenate([others[:, :3], np.clip(alpha + (1 - alpha) * dark, 0, 1)], 1).astype(np.float32)
