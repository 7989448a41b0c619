# SPDX-License-Identifier: GPL-3.0-or-later
"""What sync has to tell the artist."""

import re


class SceneError(Exception):
    """The scene cannot be rendered; the text says why, for the artist."""

    for_artists = True


_OWNERS = {"lights": "light '{}'", "materials": "material '{}'", "meshes": "{}"}


def named(text, scene):
    """What the native module says of a scene, with the names of lights, materials and objects."""
    found = re.match(r"scene\.(\w+)\[(\d+)\]\.?", text)
    if not found or found[1] not in _OWNERS:
        return text
    name = scene[found[1]][int(found[2])].get("name")
    owner = _OWNERS[found[1]].format(name) if name else found[0].rstrip(".")
    rest = text[found.end():]
    return owner + ("" if rest.startswith(":") else ": ") + rest


class Messages:
    """What to tell the artist; each text once, however many objects it concerns."""

    def __init__(self):
        self.errors, self.warnings = {}, {}

    def error(self, text):
        self.errors[text] = None

    def warning(self, text):
        self.warnings[text] = None
