# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender window to be driven by keys; tells its state line by line in a log.

Files that ask for something, and go when it is done: SCREENSHOT.please for a picture of the
window, LOG.viewport for the Rendered mode of the viewport, through the camera.

arguments: LOG SCREENSHOT LONG_SAMPLES
"""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(__file__))
import common

log_path, screenshot, long_samples = common.arguments()
renders = 0


def log(text):
    with open(log_path, "a") as file:
        print(text, file=file, flush=True)


def on_init(*_):
    log(f"init {renders}")


def on_complete(*_):
    global renders
    log(f"complete {renders}")
    renders += 1


def on_cancel(*_):
    global renders
    log(f"cancel {renders}")
    renders += 1


def start():
    """The window is there: show the engine's panels, then tell that keys may come."""
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "PROPERTIES":
            area.spaces.active.context = "RENDER"
    log("ready 0")


def watch():
    """Once rendering has ended: save what it left, then ready the next one."""
    if watch.seen == renders or bpy.app.is_job_running("RENDER"):
        return 0.1
    watch.seen = renders
    bpy.data.images["Render Result"].save_render(f"{log_path}.{renders}.exr")
    bpy.context.scene.libshade.samples = int(long_samples)
    log(f"ready {renders}")
    return 0.1


def take_screenshot():
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, screen=window.screen):
        bpy.ops.screen.screenshot(filepath=screenshot)


def show_viewport():
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "VIEW_3D":
            area.spaces.active.region_3d.view_perspective = "CAMERA"
            area.spaces.active.shading.type = "RENDERED"


def serve():
    for please, action in ((screenshot + ".please", take_screenshot),
                           (log_path + ".viewport", show_viewport)):
        if os.path.exists(please):
            action()
            os.remove(please)
    return 0.1


scene = common.empty_scene(320, 240, 16)
material, tree, node = common.metal(ex=200, ey=10)
node.inputs["Color"].default_value = (0.9, 0.7, 0.4, 1)
common.plane(material, 8)
common.monkey(material, location=(0, 0, 1))
common.camera(scene, (0, -3, 4), (0.7, 0, 0))
common.light(scene, rotation=(-0.6, 0.2, 0))
view = bpy.context.preferences.view
view.show_splash, view.render_display_type = False, "AREA"
bpy.app.handlers.render_init.append(on_init)
bpy.app.handlers.render_complete.append(on_complete)
bpy.app.handlers.render_cancel.append(on_cancel)
watch.seen = 0
bpy.app.timers.register(watch)
bpy.app.timers.register(serve)
bpy.app.timers.register(start, first_interval=1.0)
