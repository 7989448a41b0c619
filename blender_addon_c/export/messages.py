# SPDX-License-Identifier: GPL-3.0-or-later
"""What sync has to tell the artist."""


class SceneError(Exception):
    """The scene cannot be rendered; the text says why, for the artist."""


class Messages:
    """What to tell the artist; each text once, however many objects it concerns."""

    def __init__(self):
        self.errors, self.warnings = {}, {}

    def error(self, text):
        self.errors[text] = None

    def warning(self, text):
        self.warnings[text] = None
