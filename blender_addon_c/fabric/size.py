# SPDX-License-Identifier: GPL-3.0-or-later
"""How large cloth of real size is in Cycles and EEVEE: an operator measures objects, an Attribute node inside the cloth node
reads what it leaves on them. Our own engine measures by itself."""

import bpy
from bpy.app.handlers import persistent

from ..export import size
from ..names import FABRIC
from ..report import TellsOfNothing
from .tree import MEASURES

_FEEDS_SPACE = {("NEW_GEOMETRY", "Position"): "WORLD", ("TEX_COORD", "Object"): "OBJECT"}


def space_of(node, mode=None):
    """What its coordinates count: units of the UV MAP, of the OBJECT's space (keys of MEASURES) or of the WORLD; None where
    the node itself says how large it is. mode: its own, or an animated one."""
    if (mode or node.size_mode) != "REAL":
        return None
    seen, left = set(), [node.inputs["Vector"]] if "Vector" in node.inputs else []
    while left:
        for link in left.pop().links:
            if (link.from_node.type, link.from_socket.name) in _FEEDS_SPACE:
                return _FEEDS_SPACE[link.from_node.type, link.from_socket.name]
            if link.from_node not in seen:
                seen.add(link.from_node)
                left += link.from_node.inputs
    return "MAP"


def _cloths(tree, seen):
    """Cloth nodes of a tree and of the groups in it."""
    if not tree or tree in seen:
        return
    seen.add(tree)
    for node in tree.nodes:
        if node.bl_idname == FABRIC:
            yield node
        elif node.bl_idname == "ShaderNodeGroup":
            yield from _cloths(node.node_tree, seen)


def is_measured(material):
    """Has it cloth as large as the object?"""
    return any(node.size_mode == "REAL" for node in _cloths(material.node_tree, set()))


def measure(scene):
    """(objects with such cloth that now say how large they are, those that may not be changed)."""
    found, left = 0, 0
    measured = {material for material in bpy.data.materials if is_measured(material)}
    for ob in scene.objects:
        if ob.type != "MESH" or not any(slot.material in measured for slot in ob.material_slots):
            continue
        if ob.library:
            left += 1
            continue
        with size.before_modifiers(ob) as mesh:
            per_unit = size.unit_size(mesh, "")
        by = size.metres([part for row in ob.matrix_world for part in row], per_unit, size.unit_of(scene))
        for name, value in zip(MEASURES.values(), by):
            if ob.get(name) != value:
                ob[name] = value
        ob.update_tag()
        found += 1
    return found, left


class LIBSHADE_OT_measure_cloth(TellsOfNothing, bpy.types.Operator):
    """Measure the objects of this scene that wear cloth of real size, so that Cycles and EEVEE show it as large; again \
when meshes, UV maps or scales change. Libshade measures by itself"""

    bl_idname = "libshade.measure_cloth"
    bl_label = "Measure for Cycles"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        if context.mode.startswith("EDIT"):
            for ob in context.objects_in_mode:
                ob.update_from_editmode()
        for material in bpy.data.materials:  # what feeds Vector may be another since
            for node in _cloths(material.node_tree, set()):
                if not node.id_data.library:
                    node.update_preview()
        found, left = measure(context.scene)
        if left:
            self.report({"WARNING"}, f"{left} linked object(s) cannot be changed")
        if not found:
            return self.nothing("No object of this scene wears Libshade Fabric of real size")
        self.report({"INFO"}, f"Measured {found} object(s)")
        return {"FINISHED"}


_units = {}  # of scenes, by name, when cloth was last told of them


def note_unit(scene):
    """What follow_unit takes for known from here on."""
    if scene:
        _units[scene.name_full] = size.unit_of(scene)


@persistent
def follow_unit(scene=None, *_more):
    """Where a scene's unit is another than it was: cloth of so many units goes with it, as in our own engine."""
    unit = size.unit_of(scene)
    if not scene or _units.setdefault(scene.name_full, unit) == unit:
        return
    note_unit(scene)
    seen = set()
    for owner in (*bpy.data.materials, *bpy.data.node_groups):
        for node in _cloths(getattr(owner, "node_tree", owner), seen):
            if not node.id_data.library and (node.size_mode == "LENGTH" or space_of(node) == "WORLD"):
                node.update_preview(unit)


@persistent
def _note_all(*_arguments):
    _units.clear()
    for scene in bpy.data.scenes:
        note_unit(scene)


# undo_post and redo_post: what is undone may have been kept before cloth was told. render_init: in the background nothing else may
# have come since
_FOLLOW = ("depsgraph_update_post", "undo_post", "redo_post", "render_init")


def register():
    bpy.utils.register_class(LIBSHADE_OT_measure_cloth)
    for name in _FOLLOW:
        getattr(bpy.app.handlers, name).append(follow_unit)
    bpy.app.handlers.load_post.append(_note_all)


def unregister():
    for name, handler in (("load_post", _note_all), *((name, follow_unit) for name in _FOLLOW)):
        listed = getattr(bpy.app.handlers, name)
        if handler in listed:  # scripts of others may have cleared the list
            listed.remove(handler)
    bpy.utils.unregister_class(LIBSHADE_OT_measure_cloth)
