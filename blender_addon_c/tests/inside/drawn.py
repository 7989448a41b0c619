# SPDX-License-Identifier: GPL-3.0-or-later
"""A window in Rendered mode that counts how often the viewport is drawn, and for what; no mouse, no other edits.

drawn.py LOG. Logs "PHASE draws D pictures P copies C readings R idle I" of three phases: "refining", of a best picture of hours until it has
been copied COPIES times; "building", of meshes that are edited one after the other until their last picture; "whole", of
the SECONDS after that; then "done". idle: drawings in which no picture was begun, copied or finished, and nothing was read.
"""

import collections
import os
import sys
import time

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

SIDE, EDITS, COPIES, SECONDS = 300, 3, 3, 2.0
TICK = 0.05
log_path, = common.arguments()
counted = collections.Counter()


def log(*words):
    with open(log_path, "a", encoding="utf-8") as file:
        print(*words, file=file, flush=True)


def build():
    scene = common.empty_scene(320, 240, 16)
    scene.libshade.preview_samples = 1 << 16
    scene.render.threads_mode, scene.render.threads = "FIXED", 1  # what renders meanwhile does not matter
    material, _tree, _node = common.metal(ex=60, ey=10)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=SIDE, y_subdivisions=SIDE, size=4)
    ob = common.added(material)
    common.smooth(ob.data)
    common.camera(scene, (0, -4, 3), (0.95, 0, 0))
    common.light(scene, rotation=(-0.6, 0.2, 0))
    bpy.context.preferences.view.show_splash = False
    return scene, ob


def sculpt(mesh):
    place = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", place)
    place[2::3] += np.random.default_rng(1).random(len(mesh.vertices), np.float32) * 0.002
    mesh.vertices.foreach_set("co", place)
    mesh.update()


def counting(name):
    """A method of the viewport that counts its calls."""
    wrapped = getattr(viewport.Viewport, "_" + name)

    def wrapper(*arguments, **more):
        counted[name] += 1
        return wrapped(*arguments, **more)
    setattr(viewport.Viewport, "_" + name, wrapper)


def counting_draws(draw):
    def wrapper(shown, *arguments):
        def done():
            return counted["make"], counted["fetch"], counted["read"], shown._finished
        before = done()
        told = draw(shown, *arguments)
        counted["draw"] += 1
        counted["idle"] += done() == before
        wrapper.seen, wrapper.more = shown, told[1]
        return told
    wrapper.seen, wrapper.more = None, True
    return wrapper


def tell(phase):
    log(phase, *(f"{label} {counted[name]}" for label, name in (
        ("draws", "draw"), ("pictures", "make"), ("copies", "fetch"), ("readings", "read"), ("idle", "idle"))))
    counted.clear()


def phases():
    """Each yield waits."""
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "VIEW_3D":
            area.spaces.active.region_3d.view_perspective = "CAMERA"
            area.spaces.active.shading.type = "RENDERED"
    drawn = viewport.Viewport.draw
    while not (drawn.seen and drawn.seen._made and drawn.seen._made.factor == 1):
        yield
    counted.clear()
    while counted["fetch"] < COPIES:
        yield
    tell("refining")
    scene.libshade.preview_samples = 4
    yield
    for _edit in range(EDITS):
        while drawn.more:
            yield
        sculpt(ob.data)
        drawn.more = True
    while drawn.more:
        yield
    tell("building")
    ends = time.monotonic() + SECONDS
    while time.monotonic() < ends:
        yield
    tell("whole")
    log("done")


def step():
    return TICK if next(todo, "done") is None else None


common.enable()
viewport = sys.modules[common.MODULE + ".viewport"]
scene, ob = build()
for name in ("make", "fetch", "read"):
    counting(name)
viewport._FETCH_SECONDS = SECONDS  # some drawings' time on any screen
viewport.Viewport.draw = counting_draws(viewport.Viewport.draw)
todo = phases()
bpy.app.timers.register(step, first_interval=1.0)
