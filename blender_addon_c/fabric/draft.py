# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts of cloth: Weaving Information Files as Texts of the file; what follows where such a Text is edited."""

import os

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import _native
from ..names import FABRIC
from ..own_node import shown_node
from . import maps
from .yarns import DRAFT

_MOST_BYTES = 64 << 20
_LOOK_SECONDS = 0.5
_SIZES = {
    "thickness": "no spacing: square crossings as wide as the yarns are thick, %.4g to the centimetre",
    "even": "neither spacing nor thickness: as many crossings as before, but square, %.4g to the centimetre",
}
_seen = {}  # by Text: what it held


def decoded(data):
    """The text of a WIF; some are UTF-16."""
    for mark, encoding in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig")):
        if data.startswith(mark):
            return data.decode(encoding, "replace")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def import_wif(node, path):
    """Make a file a node's draft: what was mended in it, and its size where it states none. ValueError: it is none, by
    the file's name and line."""
    name = os.path.basename(path)
    with open(path, "rb") as file:
        data = file.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise ValueError(f"{name}: more than {_MOST_BYTES >> 20} MiB; a Weaving Information File was expected")
    found = _native.wif(data, name, (node.ends_per_cm, node.picks_per_cm))
    text = bpy.data.texts.new(name)
    text.from_string(decoded(data).replace("\r\n", "\n").replace("\r", "\n"))
    text.cursor_set(0)  # else editors show what is below its last line: nothing
    node.draft, node.weave = text, DRAFT
    node.ends_per_cm, node.picks_per_cm = found["counts"]
    if found["widths"]:
        for yarn, (width, gap) in zip(("warp", "weft"), found["widths"]):
            whole = width + gap
            setattr(node, f"{yarn}_width", width / whole)
            setattr(node, f"{yarn}_gap", gap / whole)
    if found["colored"] and node.draft_colors:  # they say it all
        for socket in ("Warp Color", "Weft Color"):
            node.inputs[socket].default_value = (0.8, 0.8, 0.8, 1.0)
    if found["sett"] == "spacing":
        return found["mended"]
    size = _SIZES[found["sett"]] % node.ends_per_cm
    return f"{found['mended']}; {size}" if found["mended"] else f"{name}: {size}"


class LIBSHADE_OT_import_wif(bpy.types.Operator, ImportHelper):
    """Make a Weaving Information File (WIF) this cloth's draft, as a Text that is saved with the file"""

    bl_idname = "libshade.import_wif"
    bl_label = "Import WIF"
    bl_options = {"REGISTER", "UNDO"}
    filename_ext = ".wif"
    filter_glob: StringProperty(default="*.wif", options={"HIDDEN"})
    material: StringProperty(options={"HIDDEN"})
    group: StringProperty(options={"HIDDEN"})  # or the node group that holds it
    node: StringProperty(options={"HIDDEN"})

    def invoke(self, context, event):
        node = shown_node(context, FABRIC)
        if node:  # the file browser's context has none
            owner = next((m for m in bpy.data.materials if m.node_tree == node.id_data), None)
            self.material, self.node = owner.name if owner else "", node.name
            self.group = "" if owner else node.id_data.name
        return super().invoke(context, event)

    def execute(self, context):
        material = bpy.data.materials.get(self.material)
        tree = material.node_tree if material else bpy.data.node_groups.get(self.group)
        node = tree.nodes.get(self.node) if tree else shown_node(context, FABRIC)
        if not node or node.bl_idname != FABRIC:
            self.report({"ERROR"}, "No Libshade Fabric node is chosen")
            return {"CANCELLED"}
        try:
            mended = import_wif(node, self.filepath)
        except OSError as error:
            self.report({"ERROR"}, f"{self.filepath}: {error.strerror or error}")
            return {"CANCELLED"}
        except ValueError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if mended:
            self.report({"WARNING"}, mended)
        else:  # in place of an error that was told before
            self.report({"INFO"}, f"'{node.draft.name}' is the draft of this cloth")
        return {"FINISHED"}


def follow():
    """Retags materials whose drafts were edited: Blender does not know that they are read. And tidies up."""
    maps.sweep()
    changed = set()
    for text in bpy.data.texts:
        if text.users > text.use_fake_user:
            held = hash(text.as_string())
            if _seen.setdefault(text.name_full, held) != held:
                changed.add(text)
                _seen[text.name_full] = held
    for owner in (*bpy.data.materials, *bpy.data.node_groups) if changed else ():
        tree = getattr(owner, "node_tree", owner)
        if tree and any(node.bl_idname == FABRIC and node.draft in changed for node in tree.nodes):
            owner.update_tag()
            tree.update_tag()
            for node in tree.nodes:
                if node.bl_idname == FABRIC and not owner.library:
                    node.update_preview()
    return _LOOK_SECONDS


def register():
    bpy.utils.register_class(LIBSHADE_OT_import_wif)
    bpy.app.timers.register(follow, first_interval=_LOOK_SECONDS, persistent=True)


def unregister():
    if bpy.app.timers.is_registered(follow):
        bpy.app.timers.unregister(follow)
    bpy.utils.unregister_class(LIBSHADE_OT_import_wif)
