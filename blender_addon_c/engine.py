# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: hands the scene to the native module, waits, shows the picture."""

import os
import time
from collections import namedtuple

import bpy
import numpy as np

from . import _native, export, memory, report, saved
from .assets import tells_timings
from .names import ENGINE
from .viewport import Viewport

# The native module works on while Python sleeps; this is how late a cancel may be noticed.
_POLL_SECONDS = 0.05
# A redraw copies the whole picture, so a window gets one only this often.
_REDRAW_SECONDS = 0.5
_STATUS_SECONDS = 0.5
# How often a viewport asks whether there is something new to draw.
_LOOK_SECONDS = 0.01
_MEGABYTE = 1 << 20
_PREVIEW_SAMPLES = 32  # of a material's ball


class LibshadeEngine(bpy.types.RenderEngine):
    """Renders with libshade's native module on all cores"""

    bl_idname = ENGINE
    bl_label = "libshade"
    bl_use_preview = True
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    def update_render_passes(self, scene=None, renderlayer=None):
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for p in export.passes_of(scene, renderlayer):
            self.register_pass(scene, renderlayer, p.name, len(p.channels), p.channels, p.kind)

    def render(self, depsgraph):
        try:
            self._views(depsgraph)
        except Exception as error:  # 3.4 crashes writing a picture that is not there, unless an error was told
            self._tell_failure(depsgraph.scene, error)

    def _views(self, depsgraph):
        region = export.region_of(depsgraph.scene, self.resolution_x, self.resolution_y)
        x0, y0, x1, y1 = region
        count, passes = (y1 - y0) * (x1 - x0), export.passes_of(depsgraph.scene, depsgraph.view_layer)
        memory.ask_for(x1 - x0, y1 - y0, 4 + sum(len(p.channels) for p in passes))
        pixels = np.zeros(4 * count, np.float32)
        for p in passes:
            self.add_pass(p.name, len(p.channels), p.channels, layer=depsgraph.view_layer.name)
        messages, told = export.Messages(), set()
        for view in [view.name for view in self.get_result().views] or [""]:
            # Blender 3.4 crashes writing EXR when a render gave no result: there is one in any case.
            result = self.begin_result(0, 0, x1 - x0, y1 - y0, layer=depsgraph.view_layer.name, view=view)
            if not result:
                raise MemoryError
            self._view(depsgraph, region, _Result(result, view), pixels, messages, told)

    def _view(self, depsgraph, region, result, pixels, messages, told):
        """One eye's, or the only one. told: what was said of another."""
        if result.view:
            self.active_view_set(result.view)
        try:
            self._render(depsgraph, region, result, pixels, messages, told)
        except Exception as error:  # Blender would print it and show a black picture as if all were well
            self._tell_failure(depsgraph.scene, error)
        finally:
            self.end_result(result.whole)

    def _tell_failure(self, scene, error):
        text, details = report.failure(error)
        self.report({"ERROR"}, f"libshade: {text}")
        if not self.is_preview:
            report.keep_failure(scene, text, details)

    def _render(self, depsgraph, region, result, pixels, messages, told):
        try:
            self._render_scene(depsgraph, region, result, pixels, messages)
        finally:  # last, so that Blender's line of text shows them
            if not self.is_preview:
                self._tell(depsgraph.scene, messages, told)

    def _tell(self, scene, messages, told):
        report.keep(scene, messages)
        for kind, texts in (("ERROR", messages.errors), ("WARNING", messages.warnings)):
            for text in (text for text in texts if text not in told):
                self.report({kind}, f"libshade: {text}")
        told.update(messages.errors, messages.warnings)

    def _render_scene(self, depsgraph, region, result, pixels, messages):
        started = time.perf_counter()
        self.update_stats("", "Reading the scene")
        size = self.resolution_x, self.resolution_y
        passes = export.passes_of(depsgraph.scene, depsgraph.view_layer)
        mattes, dump = export.Mattes(passes), "" if self.is_preview else os.environ.get("LIBSHADE_DUMP", "")
        samples = _PREVIEW_SAMPLES if self.is_preview else depsgraph.scene.libshade.samples

        def camera():
            ob = self.camera_override
            eye = (self.camera_model_matrix(ob), self.camera_shift_x(ob)) if result.view and ob and ob.type == "CAMERA" else None
            return export.camera_of(ob, depsgraph, size, messages, eye)

        with export.motion_of(self, depsgraph, camera, dump, messages) as motion:
            scene = export.read(depsgraph, camera(), size, region, samples, messages, mattes, motion)
        scene["dump"] = dump
        scene.update(export.planes_of(passes, export.world_of_layer(depsgraph.scene, depsgraph.view_layer)))
        scene.update(export.denoiser(depsgraph.scene.libshade))
        export.passes_left_out(depsgraph.view_layer, messages)
        synced = time.perf_counter()
        pictures, exposure = {}, export.exposure_of(depsgraph.scene)
        path, only = ("", False) if self.is_preview else saved.place_of(depsgraph, result.view)
        if path:
            saved.write(path, depsgraph.view_layer.name, scene, passes, exposure, _others(scene, passes, depsgraph.view_layer, exposure),
                        mattes.fields(depsgraph.view_layer.name))
        if only:
            return
        apart = any(p.plane == export.CATCHER for p in passes)
        views = None if dump else export.catcher.views(scene, apart)
        if not views and scene["catchers"]["seen"]:
            messages.warning("a dump shows shadow catchers as they are")
        finished, scene = self._pictures(views, pictures, len(pixels), messages) if views else (False, scene)
        job = _start(scene)
        try:
            state = self._wait(job, result, pixels, exposure)
            _native.image(job, pixels)
            if finished:
                pictures["others"] = pixels.reshape(-1, 4).copy()
                pixels[:] = pixels if apart else export.catcher.composed(pictures).ravel()
            _set_pixels(result, pixels, exposure)
            left = export.catcher.seen_shadow(pictures).ravel() if finished else np.ones(len(pixels) // 4 * 3, np.float32)
            _set_passes(result, job, [p for p in passes if p.plane != export.AOV], left, exposure)
            for field, text in mattes.fields(depsgraph.view_layer.name):
                self.get_result().stamp_data_add_field(field, text)
            for text in state["warnings"]:
                messages.warning(text)
            if state["state"] == "failed":
                raise export.SceneError(state["message"])
            if not self.is_preview:
                report.keep_slopes(depsgraph.scene, _native.slopes(job), scene["materials"])
            if state["state"] == "done":
                self._others(_others(scene, passes, depsgraph.view_layer, exposure), result, len(pixels), messages)
            if state["state"] == "done" and tells_timings():
                self.report({"INFO"}, _summary(_native.timings(job), synced - started))
        finally:
            _native.free(job)

    def _others(self, others, result, count, messages):
        """Passes of pictures of their own, each rendered by itself; Esc leaves the rest black."""
        for view, name, letters, exposure in others:
            picture = self._picture(view, count, messages)
            if picture is None:
                return
            channels = len(letters)
            _set_pixels(result, picture[:, :channels].ravel(), exposure, name, channels)

    def _pictures(self, views, pictures, count, messages):
        """Those that the last one needs, which share its time limit: whether all are there, and the last one's scene."""
        ends = time.perf_counter() + views["others"].get("time_limit", 0.0)
        names = [name for name in views if name != "others"]
        for left, name in zip(range(len(views), 1, -1), names):
            pictures[name] = self._picture(_within(views[name], ends, left), count, messages)
            if pictures[name] is None:  # Esc
                return False, views["others"]
        return True, _within(views["others"], ends, 1)

    def _picture(self, scene, count, messages):
        """Of a scene that is only needed for another's: four numbers a pixel, or None after Esc."""
        pixels, job = np.zeros(count, np.float32), _start(scene)
        try:
            state = self._wait(job, None, pixels)
            for text in state["warnings"]:
                messages.warning(text)
            if state["state"] == "failed":
                raise export.SceneError(state["message"])
            _native.image(job, pixels)
        finally:
            _native.free(job)
        return pixels.reshape(-1, 4) if state["state"] == "done" else None

    def _wait(self, job, result, pixels, exposure=1.0):
        """Wait for the job, passing Esc on to it; returns its last state. result: None where nothing is to be shown."""
        status, drawn = _Status(), time.perf_counter()
        while not _native.wait(job, _POLL_SECONDS):
            if self.test_break():
                _native.cancel(job)
            state = _native.poll(job)
            self.update_progress(state["progress"])
            self.update_memory_stats(memory_used=state["memory"] / _MEGABYTE,
                                     memory_peak=state["memory_peak"] / _MEGABYTE)
            text = status.text(state)
            if text:
                self.update_stats("", text)
            if result and not bpy.app.background and time.perf_counter() - drawn > _REDRAW_SECONDS:
                _native.image(job, pixels)
                _set_pixels(result, pixels, exposure)
                self.update_result(result.whole)
                drawn = time.perf_counter()
        return _native.poll(job)

    _viewport = None

    def view_update(self, _context, depsgraph):
        self._viewport = self._viewport or Viewport()
        self._viewport.scene_changed(depsgraph)

    def view_draw(self, context, depsgraph):
        self._viewport = self._viewport or Viewport()
        text, more_to_come = self._viewport.draw(self, context, depsgraph)
        self.update_stats("libshade", text)
        if more_to_come and self._viewport.has_news():
            self.tag_redraw()
        elif more_to_come:
            _watch(self)

    def look(self):
        """Draw the viewport again if there is something new; is that so?"""
        news = self._viewport.has_news()
        if news:
            self.tag_redraw()
        return news


# Whose viewports wait for their jobs.
_watched = []


def _watch(engine):
    """Draw it when there is something new. To draw the whole view each time only to see whether there is took as much
    time as building what it waits for, without a graphics card."""
    if engine not in _watched:
        _watched.append(engine)
    if not bpy.app.timers.is_registered(_look):  # another file ends timers
        bpy.app.timers.register(_look, first_interval=_LOOK_SECONDS)


def _look():
    _watched[:] = [engine for engine in _watched if not _has_shown(engine)]
    return _LOOK_SECONDS if _watched else None


def _has_shown(engine):
    """Or is no longer there."""
    try:
        return engine.look()
    except ReferenceError:
        return True


# Blender's, and of which view; "" where there is one.
_Result = namedtuple("_Result", "whole view")


class _Status:
    """What is being done, as a line of text."""

    _NAMES = {"build": "Building the BVH", "render": "Rendering", "denoise": "Denoising",
              "dump": "Writing the dump"}

    def __init__(self):
        self._stage, self._begun, self._told = "", 0.0, 0.0

    def text(self, state):
        """The line, or "" where it is too soon for another: each is printed in the background."""
        now = time.perf_counter()
        if state["stage"] != self._stage:
            self._stage, self._begun, self._told = state["stage"], now, 0.0
        if now - self._told < _STATUS_SECONDS:
            return ""
        self._told = now
        used, peak = state["memory"] / _MEGABYTE, state["memory_peak"] / _MEGABYTE
        parts = [f"Mem:{used:.2f}M, Peak:{peak:.2f}M", self._NAMES[self._stage]]
        if self._stage == "render":
            parts.append(f"Sample {state['sample']}/{state['samples']}")
            spent, done = now - self._begun, state["progress"]
            if spent > 1.0 and done > 0.0:
                parts.insert(0, f"Remaining {_clock(spent * (1.0 - done) / done)}")
        return " | ".join(parts)


def _clock(seconds):
    """As 01:23, or 1:02:03."""
    minutes, seconds = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes:02}:{seconds:02}"


def _summary(timings, sync_seconds):
    longest = sorted(((seconds, name) for name, seconds in timings.items() if name not in ("wall", "samples")), reverse=True)
    stages = [f"{name} {seconds:.3f}" for seconds, name in longest if seconds >= 5e-4]  # Blender cuts reports
    return (f"libshade: sync {sync_seconds:.3f} s, render {timings['wall']:.3f} s, "
            f"{timings['samples']:.0f} samples; seconds summed over threads: {', '.join(stages)}")


def _others(scene, passes, view_layer, exposure):
    """(scene, pass, its channels, exposure) of each that is a picture of its own: of AOVs and light groups."""
    letters = {p.name: p.channels for p in passes}
    for (name, kind), materials in scene["aovs"].items():
        yield export.aov.view(scene, kind, materials), name, letters[name], 1.0
    for name in export.groups.names_of(view_layer):
        name_of_pass = export.groups.pass_of(name)
        yield export.groups.view(scene, name), name_of_pass, letters[name_of_pass], exposure


def _within(scene, ends, count):
    """A scene with its part of the time that is left, if that is limited: one of so many pictures."""
    if not scene.get("time_limit"):
        return scene
    return {**scene, "time_limit": max(ends - time.perf_counter(), 0.1) / count}


def _start(scene):
    try:
        return _native.start(scene)
    except ValueError as error:
        raise export.SceneError(export.named(str(error), scene)) from error


def _set_pixels(result, pixels, exposure=1.0, name="Combined", channels=4):
    """exposure: what colours are multiplied by, but not alpha."""
    if exposure != 1.0:
        pixels = pixels.reshape(-1, channels) * np.array((exposure,) * 3 + (1.0,) * (channels - 3), np.float32)
        pixels = pixels.ravel()
    rect = result.whole.layers[0].passes.find_by_name(name, result.view).rect
    try:
        rect.foreach_set(pixels)
    except TypeError:  # until 4.0 rows of as many as there are channels
        rect.foreach_set(pixels.reshape(-1, channels))


def _set_passes(result, job, passes, left, exposure):
    """left: what shadows leave of catchers."""
    count = len(left) // 3
    for p in passes:
        numbers = np.zeros(count * len(p.channels), np.float32)
        if p.plane == export.CATCHER:
            numbers = left
        else:
            _native.image(job, numbers, p.plane)
        _set_pixels(result, numbers, exposure if export.is_light(p) else 1.0, p.name, len(p.channels))


def register():
    bpy.utils.register_class(LibshadeEngine)


def unregister():
    _watched.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
    bpy.utils.unregister_class(LibshadeEngine)
