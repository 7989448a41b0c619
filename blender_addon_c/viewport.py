# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered mode of the viewport: the native module's job for a render, drawn as it grows."""

import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d
from mathutils import Matrix

from . import _native, export

# The share of a redraw that may be spent waiting for more of the picture.
_WAIT_SECONDS = 0.02


class Viewport:
    """One 3D view. A change of the scene or of the view starts a new job."""

    def __init__(self):
        self._scene = None  # what the native module was given; None: to be read
        self._view = None  # (size, view to world, projection, clip) of the job
        self._job, self._finished, self._texture = None, False, None
        self._error, self._messages = "", export.Messages()  # why there is no job; what export said

    def scene_changed(self):
        self._scene = self._view = None

    def draw(self, engine, context, depsgraph):
        """Draw what there is; returns (text for the header, whether there will be more)."""
        region, space = context.region, context.region_data
        to_world = space.view_matrix.inverted()
        start, end = context.space_data.clip_start, context.space_data.clip_end
        if not space.is_perspective:  # shows as much behind its origin as before it
            to_world @= Matrix.Translation((0.0, 0.0, end))
            end *= 2.0
        view = ((region.width, region.height), to_world, space.window_matrix.copy(), (start, end))
        try:
            if view != self._view:
                self._start(view, depsgraph)
        except (export.SceneError, ValueError) as error:
            self._job, self._texture, self._error = None, None, str(error)
        if self._job and not self._finished:
            self._finished = _native.wait(self._job, _WAIT_SECONDS)
            self._fetch(view[0])
        if self._texture:
            gpu.state.blend_set("ALPHA_PREMULT")
            engine.bind_display_space_shader(depsgraph.scene)
            draw_texture_2d(self._texture, (0, 0), *view[0])
            engine.unbind_display_space_shader()
            gpu.state.blend_set("NONE")
        if not self._job:
            return self._error, False
        state = _native.poll(self._job)
        progress = "" if self._finished else f"Sample {state['sample']}/{state['samples']}"
        return " | ".join(filter(None, (progress, self._complaint(state)))), not self._finished

    def _complaint(self, state):
        """What went wrong, in one line: the worst of it, and how much more there is."""
        failed = [state["message"]] if state["state"] == "failed" else []
        said = [*failed, *self._messages.errors, *self._messages.warnings, *state["warnings"]]
        return "".join(said[:1]) + (f" (and {len(said) - 1} more)" if len(said) > 1 else "")

    def _start(self, view, depsgraph):
        self._view, self._finished, self._error = view, False, ""
        size, to_world, projection, clip = view
        camera = export.camera_by(projection, to_world, clip)
        region = (0, 0, *size)
        if not self._scene or self._scene["by_camera"]:
            self._messages = export.Messages()
            self._scene = export.read(depsgraph, camera, size, region,
                                    depsgraph.scene.libshade.preview_samples, self._messages)
        self._scene.update(camera=camera, width=size[0], height=size[1], region=region)
        try:
            self._job = _native.start(self._scene)  # the one before ends with its last reference
        except ValueError as error:
            raise export.SceneError(export.named(str(error), self._scene)) from error

    def _fetch(self, size):
        pixels = np.empty(size[0] * size[1] * 4, np.float32)
        _native.image(self._job, pixels)
        buffer = gpu.types.Buffer("FLOAT", len(pixels), pixels)
        self._texture = gpu.types.GPUTexture(size, format="RGBA16F", data=buffer)
