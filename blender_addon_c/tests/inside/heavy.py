# SPDX-License-Identifier: GPL-3.0-or-later
"""A window with a mesh of many triangles in Rendered mode, edited: seconds to its first new picture, and of what.

heavy.py LOG SIDE TIMES. The mesh is a grid of SIDE x SIDE quads. Logs "ready TRIANGLES", per edit "EDIT name seconds
reading SECONDS bvh SECONDS cpu SECONDS" (cpu: of all cores, Blender's drawing too), the first of which has a new picture over the
whole region, and "done".
"""

import os
import sys
import time

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

log_path, side, times = common.arguments()
side, times = int(side), int(times)
TICK = 0.05


def log(*words):
    with open(log_path, "a", encoding="utf-8") as file:
        print(*words, file=file, flush=True)


def build():
    scene = common.empty_scene(320, 240, 16)
    scene.libshade.preview_samples = 1
    material, _tree, node = common.metal(ex=60, ey=10)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side, size=4)
    ob = common.added(material)
    common.smooth(ob.data)
    common.camera(scene, (0, -4, 3), (0.95, 0, 0))
    common.light(scene, rotation=(-0.6, 0.2, 0))
    bpy.context.preferences.view.show_splash = False
    return ob, node, scene.objects["sun"]


def sculpt():
    """As a brush leaves it."""
    mesh = ob.data
    place = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", place)
    place[2::3] += np.random.default_rng(1).random(len(mesh.vertices), np.float32) * 0.002
    mesh.vertices.foreach_set("co", place)
    mesh.update()


def move_one():
    ob.data.vertices[0].co.z += 0.01
    ob.data.update()


def lamp():
    sun.data.energy *= 1.1


def slide():
    node.inputs["Color"].default_value[1] *= 0.9


def move():
    ob.location.x += 0.01


EDITS = (sculpt, move_one, lamp, slide, move)


class Measuring:
    """One edit after another, each when the last picture of that before is there."""

    def __init__(self):
        self.left = [edit for edit in EDITS for _ in range(times)]
        self.began, self.spent, self.name, self.first, self.reading = None, 0.0, "", True, 0.0
        self.idle = False

    def step(self):
        if not self.idle:
            return TICK
        if not self.left:
            log("done")
            return None
        edit = self.left.pop(0)
        self.idle, self.first, self.reading, self.name = False, True, 0.0, edit.__name__
        self.began, self.spent = time.perf_counter(), time.process_time()
        edit()
        return TICK

    def read(self, wrapped):
        def wrapper(viewport, *arguments):
            started = time.perf_counter()
            try:
                wrapped(viewport, *arguments)
            finally:
                self.reading += time.perf_counter() - started
        return wrapper

    def draw(self, wrapped):
        def wrapper(viewport, *arguments):
            told = wrapped(viewport, *arguments)
            if self.began and self.first and viewport._finished and not viewport._waiting and not viewport._changed:
                took, spent = time.perf_counter() - self.began, native.timings(viewport._job)
                self.first = False
                log(f"EDIT {self.name} {took:.3f} reading {self.reading:.3f} bvh {spent['mesh'] + spent['bvh']:.3f} "
                    f"cpu {time.process_time() - self.spent:.3f}")
            if not told[1]:
                self.idle = True
            return told
        return wrapper


def start():
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "VIEW_3D":
            area.spaces.active.region_3d.view_perspective = "CAMERA"
            area.spaces.active.overlay.show_overlays = False
            area.spaces.active.shading.type = "RENDERED"
    log("ready", 2 * len(ob.data.polygons))


ob, node, sun = build()
viewport_module, native = (sys.modules[f"{common.MODULE}.{name}"] for name in ("viewport", "_native"))
measuring = Measuring()
for method in ("_read", "draw"):
    setattr(viewport_module.Viewport, method, getattr(measuring, method.strip("_"))(getattr(viewport_module.Viewport, method)))
bpy.app.timers.register(start, first_interval=1.0)
bpy.app.timers.register(measuring.step, first_interval=2.0)
