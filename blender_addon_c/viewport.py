# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered mode of the viewport: coarse pictures first, then finer ones; the last whole one stays until the next is."""

import math
import time
from collections import namedtuple

import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d
from mathutils import Matrix, Vector

from . import _native, export, report

# The share of a redraw that may be spent waiting for more of the picture.
_WAIT_SECONDS = 0.02
# The same after an edit: most often the coarse picture is there by then.
_FIRST_SECONDS = 0.08
# A copy of the picture takes some milliseconds, so a window gets one only this often.
_FETCH_SECONDS = 0.1
# How long a coarse picture should take, and how many pixels' width one of its may have.
_COARSE_SECONDS = 0.01, 0.05
_COARSEST = 32

# What is looked at. region: the part of it that is rendered, in pixels.
_View = namedtuple("_View", "size to_world projection clip region")
# What the native module makes of a view. factor: pixels of the view across one of its own.
_Picture = namedtuple("_Picture", "view size region factor samples")


class Viewport:
    """One 3D view. A change of the scene or of the view starts a new job."""

    def __init__(self):
        self._kept, self._known = export.Kept(), 0  # what is read, and how much of it is with the job
        self._changed, self._is_reading = True, False  # since it was read; is it just being?
        self._scene, self._waiting = None, False  # what the native module gets; does it have it yet?
        self._view, self._denoiser = None, {}
        self._job, self._made, self._finished, self._failed = None, None, False, False
        self._behind = False  # was something else wanted than what the job makes, when it was drawn?
        self._began, self._fetched = 0.0, 0.0
        self._factor = 8  # of the first picture after an edit
        self._exposure = 1.0
        self._whole = None  # the last picture without holes: rows of pixels
        self._texture, self._place = None, None  # what is shown, and where
        self._error, self._messages = "", export.Messages()  # why the scene is not shown; what export said

    def scene_changed(self, depsgraph):
        try:
            self._kept.changed(depsgraph)
        except Exception:  # read all anew
            self._kept = export.Kept()
        self._changed = True

    def draw(self, engine, context, depsgraph):
        """Draw what there is; returns (text for the header, whether there will be more)."""
        view = _view_of(context, depsgraph)
        try:
            reading = not self._advance(view, depsgraph, context.space_data)
        except Exception as error:
            self._give_up(error, depsgraph.scene)
            self._view, reading = view, False
        if self._texture:
            x0, y0, x1, y1 = self._place
            gpu.state.blend_set("ALPHA_PREMULT")
            engine.bind_display_space_shader(depsgraph.scene)
            draw_texture_2d(self._texture, (x0, y0), x1 - x0, y1 - y0)
            engine.unbind_display_space_shader()
            gpu.state.blend_set("NONE")
        if reading:
            return "Reading the scene", True
        if not self._job:
            return self._error, False
        state = _native.poll(self._job)
        if not self._error:
            report.keep(depsgraph.scene, self._messages, state["warnings"])
        if state["state"] == "done":
            report.keep_slopes(depsgraph.scene, _native.slopes(self._job), self._scene["materials"])
        self._behind = self._waiting or self._view != view
        more = not self._is_last() or self._behind
        progress = "" if not more else "Building the BVH" if state["stage"] == "build" else (
            f"Sample {state['sample'] if self._made.factor == 1 else 0}/{self._scene['samples']}")
        return " | ".join(filter(None, (progress, self._complaint(state)))), more

    def _give_up(self, error, scene):
        """The last picture stays; where only reading the scene failed it is still refined, and seen from elsewhere."""
        self._error, details = report.failure(error)
        report.keep_failure(scene, self._error, details)
        if not self._is_reading:
            self._job, self._scene = None, None
        self._waiting = self._is_reading = False

    def has_news(self):
        """Would drawing it again show more, or get something done? Asked often, as drawing takes much longer."""
        if self._changed or not self._job:
            return True
        state = _native.poll(self._job)
        if state["state"] != "running":
            return True
        return state["stage"] != "build" if self._behind else self._is_due(state)

    def _complaint(self, state):
        """What went wrong, in one line: the worst of it, and how much more there is."""
        failed = [state["message"]] if state["state"] == "failed" else []
        said = [*filter(None, [self._error]), *failed, *self._messages.errors, *self._messages.warnings, *state["warnings"]]
        return "".join(said[:1]) + (f" (and {len(said) - 1} more)" if len(said) > 1 else "")

    def _is_last(self):
        """Is the best picture done?"""
        return self._finished and (self._made.factor == 1 or self._failed)

    def _advance(self, view, depsgraph, space):
        """Do what is to be done next; false while the scene is not all read."""
        if self._changed or (self._scene and self._scene["by_camera"] and view != self._view):
            try:
                self._read(view, depsgraph, space)
            except export.Later:
                return False
        if (self._waiting or view != self._view) and not self._is_building():
            self._begin(view)
        elif self._job and not self._finished:
            self._wait(_WAIT_SECONDS)
        elif self._job and not self._is_last():  # a finer one
            self._make(_picture(view, self._made.factor // 2, self._samples()))
        return True

    def _read(self, view, depsgraph, space):
        messages, self._is_reading = export.Messages(), True
        self._changed = False  # an error is told once
        self._exposure = export.exposure_of(depsgraph.scene)
        try:
            camera = export.camera_by(view.projection, view.to_world, view.clip)
            samples = depsgraph.scene.libshade.preview_samples
            self._scene = export.read(depsgraph, camera, view.size, view.region, samples, messages, kept=self._kept,
                                      space=space)
            self._denoiser = export.preview_denoiser(depsgraph.scene.libshade)
        except export.Later:
            self._changed = True
            raise
        self._messages, self._waiting, self._error, self._is_reading = messages, True, "", False

    def _is_building(self):
        """Is the job at what the next one needs, too? Then it is not stopped."""
        if not self._job or self._finished or self._known != self._kept.meshes_read:
            return False
        if _native.poll(self._job)["stage"] != "build":
            return False
        _native.wait(self._job, _WAIT_SECONDS)
        return _native.poll(self._job)["stage"] == "build"

    def _samples(self):
        return self._scene["samples"]

    def _begin(self, view):
        """Of a new scene or view: coarse first."""
        if not self._scene:
            return
        self._view, self._known = view, self._kept.meshes_read
        self._make(_picture(view, self._factor, self._samples()), first=True)

    def _make(self, picture, first=False):
        view = picture.view
        self._scene.update(camera=export.camera_by(view.projection, view.to_world, view.clip), width=picture.size[0],
                           height=picture.size[1], region=picture.region)
        given = {**self._scene, **self._denoiser, "samples": picture.samples}
        job = _native.look(self._job, given) if self._job and not self._waiting else None
        try:
            self._job = job or _native.start(given, self._job)
        except ValueError as error:
            raise export.SceneError(export.named(str(error), self._scene)) from error
        self._made, self._finished, self._failed, self._waiting = picture, False, False, False
        self._began = self._fetched = time.perf_counter()
        self._wait(_FIRST_SECONDS if first else _WAIT_SECONDS)

    def _wait(self, seconds):
        self._finished = _native.wait(self._job, seconds)
        state = _native.poll(self._job)
        self._failed = self._finished and state["state"] != "done"
        if self._failed:
            return
        if self._finished and self._made.factor > 1:
            self._adapt()
        if self._finished or self._is_due(state):
            self._fetch()
            self._fetched = time.perf_counter()

    def _is_due(self, state):
        """Of a coarse picture parts are no use; of the best one they stand before the last coarse one."""
        return (self._made.factor == 1 and state["stage"] == "render" and self._whole is not None
                and time.perf_counter() - self._fetched > _FETCH_SECONDS)

    def _adapt(self):
        """The first picture shall neither take long nor be coarser than it must."""
        low, high = _COARSE_SECONDS
        timings = _native.timings(self._job)
        taken = timings["wall"] - timings["image"] - timings["mesh"] - timings["bvh"]
        if self._made.factor != self._factor:
            return
        if taken > high:
            self._factor = min(2 * self._factor, _COARSEST)
        elif taken < low:
            self._factor = max(self._factor // 2, 2)

    def _fetch(self):
        x0, y0, x1, y1 = self._made.region
        width, height = x1 - x0, y1 - y0
        if self._finished or self._whole is None:
            pixels = np.empty((height, width, 4), np.float32)
        else:
            rows, columns = self._whole.shape[:2]
            pixels = self._whole[np.arange(height) * rows // height].take(np.arange(width) * columns // width, 1)
        _native.image(self._job, pixels, "", not self._finished)
        if self._finished:
            self._whole = pixels
        flat = (pixels * (*(self._exposure,) * 3, 1.0)).astype(np.float32).ravel() if self._exposure != 1.0 else pixels.ravel()
        buffer = gpu.types.Buffer("FLOAT", len(flat), flat)
        self._texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
        across, up = (self._made.view.size[k] / self._made.size[k] for k in (0, 1))
        self._place = x0 * across, y0 * up, x1 * across, y1 * up


def _picture(view, factor, samples):
    """Of a view, with one sample for each of so many pixels' width; factor 1: the best."""
    factor = max(factor, 1)
    if factor == 1:
        return _Picture(view, view.size, view.region, 1, samples)
    size = tuple(-(-side // factor) for side in view.size)
    x0, y0, x1, y1 = (side * size[k % 2] / view.size[k % 2] for k, side in enumerate(view.region))
    return _Picture(view, size, (int(x0), int(y0), math.ceil(x1), math.ceil(y1)), factor, 1)


def _view_of(context, depsgraph):
    region, space = context.region, context.region_data
    to_world = space.view_matrix.inverted()
    start, end = context.space_data.clip_start, context.space_data.clip_end
    if not space.is_perspective:  # shows as much behind its origin as before it
        to_world @= Matrix.Translation((0.0, 0.0, end))
        end *= 2.0
    size = region.width, region.height
    return _View(size, to_world, space.window_matrix.copy(), (start, end), _region_of(context, depsgraph, size))


def _region_of(context, depsgraph, size):
    """The part that is rendered: of the camera's frame, or that which the view has of its own; else all."""
    space, view, render = context.space_data, context.region_data, depsgraph.scene.render
    whole = (0, 0, *size)
    if view.view_perspective == "CAMERA" and space.camera and space.camera.type == "CAMERA":
        if not render.use_border:
            return whole
        ob = space.camera.evaluated_get(depsgraph)
        corners = [view.perspective_matrix @ ob.matrix_world.normalized() @ Vector((*corner, 1.0))
                   for corner in ob.data.view_frame(scene=depsgraph.scene)]
        if any(corner.w <= 0.0 for corner in corners):
            return whole
        places = [[0.5 * (corner[k] / corner.w + 1.0) * size[k] for corner in corners] for k in (0, 1)]
        owner, name = render, "border"
    elif space.use_render_border:
        places, owner, name = [(0, size[0]), (0, size[1])], space, "render_border"
    else:
        return whole
    sides = []
    for end in ("min", "max"):
        for axis, place in zip("xy", places):
            part = getattr(owner, f"{name}_{end}_{axis}")
            sides.append(round(min(place) + part * (max(place) - min(place))))
    x0, y0, x1, y1 = (min(max(side, 0), size[k % 2]) for k, side in enumerate(sides))
    return (x0, y0, x1, y1) if x0 < x1 and y0 < y1 else whole
