# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender window to be driven by keys; tells its state line by line in a log.

Files that ask for something, and go when it is done: SCREENSHOT.please for a picture of the
window, LOG.viewport for the Rendered mode of the viewport, through the camera, LOG.portal
for a light that is not supported, LOG.empty for a scene without meshes, LOG.redraw for all areas
to be drawn again, LOG.edits for edits by chance, LOG.material for the material's tab, LOG.select for what the first
message is about, LOG.WORD for what inside/artist.py does.

arguments: LOG SCREENSHOT [EDITS]; EDITS: how many edits by chance there will be, of a scene for them
"""

import os
import sys
import time

import bpy
from mathutils import Quaternion

sys.path.insert(0, os.path.dirname(__file__))
import artist
import common
import edits

log_path, screenshot, *count = common.arguments()
steps = int(count[0]) if count else 0
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
    if renders == 1:  # the next one would take hours
        scene = bpy.context.scene
        scene.render.resolution_percentage, scene.libshade.samples = 1000, 65_536
    log(f"ready {renders}")
    return 0.1


def take_screenshot():
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, screen=window.screen):
        bpy.ops.screen.screenshot(filepath=screenshot)


def show_viewport(shading="RENDERED"):
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "VIEW_3D":
            area.spaces.active.region_3d.view_perspective = "PERSP" if steps else "CAMERA"
            area.spaces.active.shading.type = shading


def border():
    """The right half of the camera's frame alone."""
    render = bpy.context.scene.render
    render.use_border, render.border_min_x = True, 0.5


def local_view():
    """Of the monkey and the lamp, without that border."""
    bpy.context.scene.render.use_border = False
    for ob in bpy.context.scene.objects:
        ob.select_set(ob.name in ("Suzanne", "sun"))
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.localview(frame_selected=False)


def split():
    """The view becomes two."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    for area in window.screen.areas:
        if area.type == "VIEW_3D":
            area.spaces.active.shading.type = "RENDERED"


def add_portal():
    common.light(bpy.context.scene, "AREA").data.cycles.is_portal = True


def remove_meshes():
    for ob in [ob for ob in bpy.context.scene.objects if ob.type == "MESH"]:
        bpy.data.objects.remove(ob)


def show_material():
    """Whose ball Blender has rendered for the preview."""
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "PROPERTIES":
            area.spaces.active.context = "MATERIAL"


def select_cause():
    scene = bpy.context.scene
    text, _error = sys.modules[common.MODULE + ".report"].told(scene)[0]
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window):
        bpy.ops.libshade.select_cause(text=text)
    log("selected " + " ".join(ob.name for ob in scene.objects if ob.select_get()))


def telling_previews(render):
    """engine.render that logs how bright a preview is."""
    def wrapper(engine, depsgraph, region, result, pixels, *more):
        render(engine, depsgraph, region, result, pixels, *more)
        if engine.is_preview:
            log(f"preview {pixels.max() > 0.5}")
    return wrapper


def redraw():
    for area in bpy.context.window_manager.windows[0].screen.areas:
        area.tag_redraw()


class Editing:
    """Edits, undone or not, each a while after the one before or once its first picture is there. Logs
    "blank": a picture has gone, "memory EDITS MIB OBJECTS" every hundred, "seconds ...": from each edit to its
    first picture, "edited", and "whole": a viewport has its last picture then."""

    def __init__(self):
        self.left, self.taken, self.began, self.pending = steps, [], None, False
        self.names, self.until = (), 0.0
        self.ended, self.whole = False, []

    def step(self):
        now = time.perf_counter()
        if self.began and now < self.until:
            return 0.02
        if (steps - self.left) % 100 == 0:
            log(f"memory {steps - self.left} {common.resident():.1f} {len(bpy.data.objects)}")
        if not self.left:
            log("seconds " + " ".join(f"{name}:{taken:.3f}" for name, taken in self.taken))
            log("edited")
            self.ended = True
            redraw()
            return None
        self.left -= 1
        window = bpy.context.window_manager.windows[0]
        area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
        region = next(region for region in area.regions if region.type == "WINDOW")
        with bpy.context.temp_override(window=window, area=area, region=region):
            self.began, self.pending = time.perf_counter(), False
            self.until = self.began + edits.chance.choice([0.02, 0.2, 3.0])
            self.edit(area.spaces.active.region_3d)
        return 0.02

    def edit(self, view):
        kind = edits.chance.randrange(6)
        self.names = ["view"] if kind < 2 else ["undo"] if kind == 2 else edits.some_names()
        if bpy.context.mode != "OBJECT" and kind > 1:
            self.names = ["edit_mode"]
        if kind < 2:
            view.view_perspective = "PERSP"
            view.view_rotation = view.view_rotation @ Quaternion((0, 1, 0), 0.2)
        elif kind == 2 and bpy.ops.ed.undo.poll():
            bpy.ops.ed.undo()
        elif kind > 2:
            for name in self.names:
                edits.EDITS[name]()
            bpy.ops.ed.undo_push(message="edit")

    def make(self, wrapped):
        def wrapper(viewport, picture, first=False):
            self.pending = self.pending or first
            wrapped(viewport, picture, first)
        return wrapper

    def fetch(self, wrapped):
        def wrapper(viewport):
            wrapped(viewport)
            if self.pending and self.began and viewport._finished:
                self.taken.append(("+".join(self.names), time.perf_counter() - self.began))
                self.began = None
        return wrapper

    def draw(self, wrapped):
        def wrapper(viewport, *arguments):
            was = viewport._texture
            told = wrapped(viewport, *arguments)
            if was and not viewport._texture:
                log(f"blank {viewport._error}")
            if self.ended and not told[1] and viewport not in self.whole:
                self.whole.append(viewport)
                log("whole")
            return told
        return wrapper


def metal_scene():
    scene = common.empty_scene(320, 240, 16)
    material, tree, node = common.metal(ex=200, ey=10)
    node.inputs["Color"].default_value = (0.9, 0.7, 0.4, 1)
    common.plane(material, 8)
    common.monkey(material, location=(0, 0, 1))
    common.camera(scene, (0, -3, 4), (0.7, 0, 0))
    common.light(scene, rotation=(-0.6, 0.2, 0))
    return scene


def telling_text(draw):
    """Viewport.draw that logs the header's text once there is no more to come."""
    def wrapper(*arguments):
        text, more_to_come = draw(*arguments)
        if not more_to_come:
            log(f"viewport: {text}")
        return text, more_to_come
    return wrapper


def telling_progress(text):
    """engine._Status.text that logs once when a render has got somewhere."""
    def wrapper(status, state):
        got_somewhere = state["stage"] == "render" and state["progress"] > 0
        if got_somewhere and telling_progress.seen != renders:
            telling_progress.seen = renders
            log(f"rendering {renders}")
        return text(status, state)
    return wrapper


def serve():
    for please, action in ((screenshot + ".please", take_screenshot),
                           (log_path + ".viewport", show_viewport),
                           (log_path + ".border", border), (log_path + ".local", local_view), (log_path + ".split", split),
                           (log_path + ".portal", add_portal),
                           (log_path + ".empty", remove_meshes),
                           (log_path + ".solid", lambda: show_viewport("SOLID")),
                           (log_path + ".edits", lambda: bpy.app.timers.register(editing.step)),
                           (log_path + ".material", show_material),
                           (log_path + ".select", select_cause),
                           (log_path + ".weave", artist.weave), (log_path + ".dye", artist.dye),
                           (log_path + ".fabric", lambda: artist.show_node("LibshadeFabricNode")),
                           (log_path + ".scratches", lambda: artist.show_node("LibshadeScratchesNode")),
                           (log_path + ".metal", lambda: artist.show_node("LibshadeMetalNode")),
                           (log_path + ".bake", artist.press_bake), (log_path + ".baked", artist.look_at_bake),
                           (log_path + ".assets", artist.show_assets), (log_path + ".library", artist.choose_assets),
                           (log_path + ".preferences", artist.show_preferences),
                           (log_path + ".redraw", redraw)):
        if os.path.exists(please):
            action()
            os.remove(please)
    return 0.1


common.enable()
engine, viewport = (sys.modules[f"{common.MODULE}.{name}"] for name in ("engine", "viewport"))
viewport.Viewport.draw = telling_text(viewport.Viewport.draw)
engine._Status.text = telling_progress(engine._Status.text)
engine.LibshadeEngine._render = telling_previews(engine.LibshadeEngine._render)
telling_progress.seen = None
editing = Editing()
for name in ("_make", "_fetch", "draw") if steps else ():
    setattr(viewport.Viewport, name, getattr(editing, name.strip("_"))(getattr(viewport.Viewport, name)))
if steps:
    edits.chance.seed(1)
    scene = edits.build()
else:
    scene = metal_scene()
view = bpy.context.preferences.view
view.show_splash, view.render_display_type = False, "AREA"
bpy.app.handlers.render_init.append(on_init)
bpy.app.handlers.render_complete.append(on_complete)
bpy.app.handlers.render_cancel.append(on_cancel)
watch.seen = 0
bpy.app.timers.register(watch)
bpy.app.timers.register(serve)
bpy.app.timers.register(start, first_interval=1.0)
