# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered mode without a window: what the engine's viewport hands over to be drawn."""

import sys
import time
from types import SimpleNamespace

import bpy
import numpy as np

import common


class View:
    """One 3D view. space: whose clipping and local view count."""

    def __init__(self, width, height):
        self._module = sys.modules[f"{common.MODULE}.viewport"]
        self._size, self._drawn = (width, height), []
        space = next(area for screen in bpy.data.screens for area in screen.areas if area.type == "VIEW_3D").spaces.active
        self.space, self._viewport = space, self._module.Viewport()

    def changed(self, depsgraph):
        """As view_update does."""
        self._viewport.scene_changed(depsgraph)

    def picture(self, to_view, window, perspective, depsgraph):
        """(the last one, RGBA from the bottom; what the header says). to_view: a matrix, from the world; window: one, from
        there."""
        module, width, height = self._module, *self._size
        context = SimpleNamespace(
            region=SimpleNamespace(width=width, height=height), space_data=self.space,
            region_data=SimpleNamespace(view_matrix=to_view, is_perspective=perspective, window_matrix=window,
                                        view_perspective="PERSP" if perspective else "ORTHO"))
        engine = SimpleNamespace(bind_display_space_shader=lambda _scene: None, unbind_display_space_shader=lambda: None)
        held = module.gpu, module.draw_texture_2d
        module.gpu = SimpleNamespace(
            types=SimpleNamespace(Buffer=lambda _kind, _size, pixels: pixels,
                                  GPUTexture=lambda _size, format, data: self._drawn.append(data) or "it"),
            state=SimpleNamespace(blend_set=lambda _mode: None))
        module.draw_texture_2d = lambda *_: None
        more = True
        try:
            while more:
                said, more = self._viewport.draw(engine, context, depsgraph)
                self._until_news(more)
        finally:
            module.gpu, module.draw_texture_2d = held
        drawn = self._drawn[-1]
        self._drawn = [drawn]  # it stays until there is another
        return np.array(drawn, np.float32).reshape(height, width, 4), said

    def _until_news(self, more):
        """The engine draws no earlier."""
        deadline = time.monotonic() + 60
        while more and not self._viewport.has_news():
            assert time.monotonic() < deadline, "no news of the viewport"
            time.sleep(0.001)
