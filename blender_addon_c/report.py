# SPDX-License-Identifier: GPL-3.0-or-later
"""What the last render or viewport could not show as Cycles does, where artists look: a panel, and a line on our nodes."""

import os
import platform
import textwrap
import traceback

import bpy

from . import _native
from .names import ENGINE

# What messages begin with ("material 'steel': ..."), where such things are, and their icons.
_KINDS = {"material": ("materials", "MATERIAL"), "object": ("objects", "OBJECT_DATA"), "light": ("objects", "LIGHT"),
          "camera": ("objects", "CAMERA_DATA"), "world": ("worlds", "WORLD"), "view layer": (None, "RENDERLAYERS")}
_last = {}  # by name of the scene: ((text, is it an error?), ...)
_slopes = {}  # by the same: a line for each material whose bumps shade each other
_details = {}  # by the same: where in the program its failure was
_FOLDER = os.path.dirname(os.path.abspath(__file__)) + os.sep
_stale = [False]  # is something else to be shown?
_REDRAW_SECONDS = 0.3


def keep(scene, messages, more=()):
    """What was told of a scene. more: warnings of the native module."""
    _keep(scene, [(text, True) for text in messages.errors] + [(text, False) for text in (*messages.warnings, *more)])


def keep_failure(scene, text, details=""):
    """Why there is no picture of a scene, above what else was told of it."""
    _keep(scene, [(text, True), *(said for said in told(scene) if said[0] != text)])
    _details[scene.name] = details


def keep_slopes(scene, found, materials):
    """found: what the native module says of these materials, as it got them, once it has looked at their bumps. What
    has none is not told."""
    lines = []
    for number, *slopes in found:
        if slopes[2] + slopes[4] > 0:
            said = ", ".join(f"{slopes[k] ** 0.5:.2g}" for k in (2, 4))
            lines.append(f"{materials[number].get('name') or 'A material'}: slopes {said}")
    _slopes[scene.name] = "\n".join(lines)


def slopes(scene):
    return _slopes.get(scene.name, "")


def failure(error):
    """(what an exception comes to, in one line; where it was, for those who mend it)."""
    if getattr(error, "for_artists", False):
        return str(error), ""
    details, said = "".join(traceback.format_exception(error)), " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return f"out of memory: {said}" if said else "out of memory", details
    ours = [(frame.filename.removeprefix(_FOLDER), frame.lineno) for frame in traceback.extract_tb(error.__traceback__)
            if frame.filename.startswith(_FOLDER)]
    place = "{}, line {}: ".format(*ours[-1]) if ours else ""
    return f"internal error: {place}{type(error).__name__}: {said} (Copy Report is in the Render properties)", details


def whole(scene):
    """All that was told of a scene, and by what, as text."""
    lines = [f"libshade {_native.version()} ({_native.isa()}), Blender {bpy.app.version_string}, {platform.platform()}"]
    lines += [f"{'Error' if error else 'Warning'}: {text}" for text, error in told(scene)]
    lines += [f"Note: {text}" for text in slopes(scene).splitlines()]
    return "\n".join([*lines, _details.get(scene.name, "")]).rstrip() + "\n"


def _keep(scene, texts):
    _details.pop(scene.name, None)
    if _last.get(scene.name) != texts:
        _last[scene.name] = texts
        _stale[0] = True  # renders have threads of their own, which must not touch windows


def told(scene):
    return _last.get(scene.name, ())


def _redraw():
    if _stale[0]:
        _stale[0] = False
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type in {"PROPERTIES", "NODE_EDITOR"}:
                    area.tag_redraw()
    return _REDRAW_SECONDS


def cause(text):
    """(data-block or None, name of the node or "", icon, what is said of it)."""
    for kind, (where, icon) in _KINDS.items():
        if not text.startswith(f"{kind} '"):
            continue
        # the longest name, for names have quotes too
        owners = [owner for owner in getattr(bpy.data, where) if text.startswith(f"{kind} '{owner.name}'")] if where else []
        owner = max(owners, key=lambda owner: len(owner.name), default=None)
        rest = text[len(f"{kind} '{owner.name}'"):].lstrip(": ") if owner else text
        return owner, _node_in(owner, rest), icon, rest
    return None, "", "ERROR", text


def _node_in(owner, text):
    """The first node that a text about its owner names."""
    tree = getattr(owner, "node_tree", None) or getattr(getattr(owner, "data", None), "node_tree", None)
    named = [(text.find(f"'{node.name}'"), node.name) for node in tree.nodes] if tree else []
    return min((place for place in named if place[0] >= 0), default=(0, ""))[1]


def of_node(node):
    """What was said of a node of ours, or of its material as a whole."""
    causes = [cause(text) for text in {text for texts in _last.values() for text, _error in texts}]
    return sorted(rest for owner, name, _icon, rest in causes
                  if isinstance(owner, bpy.types.Material) and owner.node_tree == node.id_data and name in ("", node.name))


class TellsOfNothing:
    """An operator that may find nothing to do. 3.4's window shows an error of one that is cancelled, but no warning; in a script an
    error is an exception."""

    _in_window = False

    def invoke(self, context, _event):
        self._in_window = True
        return self.execute(context)

    def nothing(self, text):
        self.report({"ERROR" if self._in_window else "WARNING"}, text)
        return {"CANCELLED"}


class LIBSHADE_OT_select_cause(TellsOfNothing, bpy.types.Operator):
    """Select what this is said of, and its node"""
    bl_idname = "libshade.select_cause"
    bl_label = "Select"
    bl_options = {"REGISTER", "UNDO"}

    text: bpy.props.StringProperty(options={"HIDDEN"})

    def execute(self, context):
        owner, node, _icon, _rest = cause(self.text)
        if not owner:
            return self.nothing("It is not in this file any more")
        shown = [ob for ob in context.view_layer.objects if ob.visible_get()]
        if isinstance(owner, bpy.types.Material):
            users = [ob for ob in shown if any(slot.material == owner for slot in ob.material_slots)]
        else:
            users = [ob for ob in shown if ob == owner]
        if users and context.mode == "OBJECT":
            for ob in shown:
                ob.select_set(ob in users)
            context.view_layer.objects.active = users[0]
        for ob in users:
            for k, slot in enumerate(ob.material_slots):
                if slot.material == owner:
                    ob.active_material_index = k
        tree = getattr(owner, "node_tree", None) or getattr(getattr(owner, "data", None), "node_tree", None)
        if node and node in tree.nodes:
            for other in tree.nodes:
                other.select = other.name == node
            tree.nodes.active = tree.nodes[node]
        return {"FINISHED"}


class LIBSHADE_OT_copy_report(bpy.types.Operator):
    """Copy what is told here, with the versions of all that told it, to send it to those who can mend it"""
    bl_idname = "libshade.copy_report"
    bl_label = "Copy Report"

    def execute(self, context):
        context.window_manager.clipboard = whole(context.scene)
        self.report({"INFO"}, "Copied")
        return {"FINISHED"}


class RENDER_PT_libshade_differences(bpy.types.Panel):
    bl_label = "Not Rendered as in Cycles"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE and told(context.scene)

    def draw_header(self, context):
        self.layout.label(text=str(len(told(context.scene))))

    def draw(self, context):
        width = max(20, int(context.region.width / (6.5 * context.preferences.system.ui_scale)) - 8)
        for text, error in told(context.scene):
            owner, _node, icon, rest = cause(text)
            box = self.layout.box()
            row = box.row()
            row.alert = error
            row.label(text=owner.name if owner else "Scene", icon=icon)
            if owner:
                row.operator(LIBSHADE_OT_select_cause.bl_idname, text="", icon="RESTRICT_SELECT_OFF").text = text
            lines = box.column(align=True)
            lines.alert = error
            for line in textwrap.wrap(rest, width):
                lines.label(text=line)
        self.layout.operator(LIBSHADE_OT_copy_report.bl_idname, icon="COPYDOWN")


def in_digits(number):
    """As people write numbers, without powers of ten."""
    digits = f"{number:.3g}"
    return f"{number:,.0f}" if abs(number) >= 1000 else f"{number:.6f}".rstrip("0").rstrip(".") if "e" in digits else digits


def is_enabled():
    """Whether the add-on is: 3.4 keeps its nodes, and draws them, when their operators are gone."""
    return hasattr(bpy.types, LIBSHADE_OT_select_cause.__name__)


def draw_on(node, layout):
    """A red line for each thing that was said of a node. False where the add-on is switched off, with a line that says so."""
    if not is_enabled():
        layout.label(text="libshade is disabled", icon="ERROR")
        return False
    layout.context_pointer_set("node", node)  # a node editor does that for its operators, a material's tab does not
    for text in of_node(node):
        column = layout.column(align=True)
        column.alert = True
        for k, line in enumerate(textwrap.wrap(text, max(20, int(node.width / 7)))):
            column.label(text=line, icon="NONE" if k else "ERROR")
    return True


@bpy.app.handlers.persistent
def _forget(*_arguments):
    _last.clear()
    _slopes.clear()
    _details.clear()


_CLASSES = (LIBSHADE_OT_select_cause, LIBSHADE_OT_copy_report, RENDER_PT_libshade_differences)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.app.handlers.load_post.append(_forget)
    if not bpy.app.background:
        bpy.app.timers.register(_redraw, persistent=True)


def unregister():
    if bpy.app.timers.is_registered(_redraw):
        bpy.app.timers.unregister(_redraw)
    bpy.app.handlers.load_post.remove(_forget)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    _forget()
