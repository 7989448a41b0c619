# SPDX-License-Identifier: GPL-3.0-or-later
"""Grooves that follow bumps in any renderer: a group of plain nodes, and the operators that place it.

Cycles turns an anisotropic shader's tangent T into the plane of the bumped normal N' by the shortest
way, which swings the grooves aside. (N × T) × N' is what dP/du is on the displaced surface: it stays
in the plane of N and T. The group needs no add-on: files that hold it render the same without.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty

from .group import drop_patterns, new_socket
from .report import TellsOfNothing

NAME = "Libshade Groove"
_MARK = "libshade_groove"  # on the tree, and on nodes that the operator placed
TANGENT, ACROSS = "Tangent", "Strokes Across"
# Of Cycles' shaders those that have a direction, and what says how much.
_AMOUNT = {"ShaderNodeBsdfAnisotropic": "Anisotropy", "ShaderNodeBsdfMetallic": "Anisotropy",
           "ShaderNodeBsdfPrincipled": "Anisotropic"}


def vector_math(tree, operation, a, b=None):
    """A Vector Math node of these sockets; what it says."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    for socket, source in zip(node.inputs, (a, b)):
        if source is not None:
            tree.links.new(source, socket)
    return node.outputs["Value" if operation == "LENGTH" else "Vector"]


def either(tree, vector, other):
    """A vector, or another where it is 0, as where nothing is linked to a group's socket."""
    missing = tree.nodes.new("ShaderNodeMath")
    missing.operation = "LESS_THAN"
    tree.links.new(vector_math(tree, "LENGTH", vector), missing.inputs[0])
    missing.inputs[1].default_value = 1e-6
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "SCALE"
    tree.links.new(other, scaled.inputs[0])
    tree.links.new(missing.outputs[0], scaled.inputs["Scale"])
    return vector_math(tree, "ADD", vector, scaled.outputs["Vector"])


def arrange(tree):
    """From left to right by how many nodes stand before one."""
    depth, before = {}, {node: [] for node in tree.nodes}
    for link in tree.links:  # a socket would look through them all for its own
        before[link.to_node].append(link.from_node)

    def depth_of(node):
        if node not in depth:
            depth[node] = 0
            depth[node] = 1 + max(map(depth_of, before[node]), default=-1)
        return depth[node]

    rows = {}
    for node in tree.nodes:
        column = depth_of(node)
        rows[column] = rows.get(column, 0) + 1
        node.location = (180 * column, -180 * rows[column])


def groove_tree():
    """The file's group, made where there is none."""
    for tree in bpy.data.node_groups:
        if tree.get(_MARK) and not tree.library:
            return tree
    tree = bpy.data.node_groups.new(NAME, "ShaderNodeTree")
    tree[_MARK] = True
    for name, about in (("Normal", "The bumped normal; nothing: the surface's own"),
                        (TANGENT, "Of the surface without bumps; nothing: what shaders take by themselves")):
        socket = new_socket(tree, name, "INPUT", "NodeSocketVector")
        socket.hide_value, socket.description = True, about
    for name, about in ((TANGENT, "As dP/du of the displaced surface: for Tangent of anisotropic shaders"),
                        (ACROSS, "For shaders whose strokes lie across their tangent (Principled, Metallic and "
                                 "positive anisotropy): the strokes stay on the lines of the surface, which Cycles "
                                 "does not do on a displaced one")):
        new_socket(tree, name, "OUTPUT", "NodeSocketVector").description = about
    new_socket(tree, "Normal", "OUTPUT", "NodeSocketVector").description = "What is linked to Normal, or the surface's own"
    given = tree.nodes.new("NodeGroupInput").outputs
    surface = tree.nodes.new("ShaderNodeNewGeometry").outputs
    answer = tree.nodes.new("NodeGroupOutput").inputs
    normal = either(tree, given["Normal"], surface["Normal"])
    tangent = either(tree, given[TANGENT], surface["Tangent"])
    side = vector_math(tree, "CROSS_PRODUCT", surface["Normal"], tangent)
    along = vector_math(tree, "CROSS_PRODUCT", side, normal)
    across = vector_math(tree, "CROSS_PRODUCT", vector_math(tree, "CROSS_PRODUCT", normal, tangent), normal)
    tree.links.new(vector_math(tree, "NORMALIZE", along), answer[TANGENT])
    tree.links.new(vector_math(tree, "NORMALIZE", across), answer[ACROSS])
    tree.links.new(normal, answer["Normal"])
    arrange(tree)
    return tree


def _new_group(tree):
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.label = groove_tree(), NAME
    return node


def _trees():
    """All that the file may change, but what is inside our own nodes and groups that these share."""
    inside = {node.node_tree for owner in (*bpy.data.materials, *bpy.data.node_groups)
              for node in getattr(getattr(owner, "node_tree", owner), "nodes", ())
              if node.bl_idname.startswith("Libshade")}
    trees = [owner.node_tree for owner in bpy.data.materials if owner.node_tree and not owner.library]
    trees += [tree for tree in bpy.data.node_groups
              if tree.bl_idname == "ShaderNodeTree" and not tree.library
              and not any(key.startswith("libshade_") for key in tree.keys())]
    return [tree for tree in trees if tree not in inside]


def _is_groove(node):
    return node.bl_idname == "ShaderNodeGroup" and node.node_tree and node.node_tree.get(_MARK)


def _source(socket):
    """What is linked to an input, past reroutes."""
    while socket.is_linked:
        source = socket.links[0].from_socket
        if source.node.bl_idname != "NodeReroute":
            return source
        socket = source.node.inputs[0]
    return None


def _comes_of_groove(socket):
    """Does the group stand anywhere before an input? Within a Libshade Metal nodes lie between."""
    sockets, seen = [socket], set()
    while sockets:
        for link in sockets.pop().links:
            node = link.from_node
            if _is_groove(node):
                return True
            if node.name not in seen:
                seen.add(node.name)
                sockets.extend(node.inputs)
    return False


def _has_bumped_grooves(node):
    if node.bl_idname not in _AMOUNT:  # asked for "", a group's output has a socket of that name
        return False
    amount = node.inputs.get(_AMOUNT[node.bl_idname])
    if not amount or not (amount.is_linked or amount.default_value != 0) or not _source(node.inputs["Normal"]):
        return False
    return not _comes_of_groove(node.inputs["Tangent"])


def _free_place(tree, node):
    """Left of a shader and below what stands there."""
    x, y = node.location[0] - 200, node.location[1] - 250
    beside = [other.location[1] for other in tree.nodes if other.parent == node.parent and x - other.width < other.location[0] < x + 140]
    while any(y - 170 < top < y + 170 for top in beside):
        y -= 30
    return x, y


def place(tree, strokes):
    """Put the group before the tree's anisotropic shaders with a bumped normal; how many."""
    nodes = [node for node in tree.nodes if _has_bumped_grooves(node)]
    for node in nodes:
        group = _new_group(tree)
        group[_MARK] = True
        group.parent, group.location = node.parent, _free_place(tree, node)
        tree.links.new(_source(node.inputs["Normal"]), group.inputs["Normal"])
        tangent = _source(node.inputs["Tangent"])
        if tangent:
            tree.links.new(tangent, group.inputs[TANGENT])
        tree.links.new(group.outputs[strokes], node.inputs["Tangent"])
    return len(nodes)


def take_away(tree):
    """Undo `place`; groups that were put there by hand stay. How many."""
    groups = [node for node in tree.nodes if _is_groove(node) and node.get(_MARK)]
    for group in groups:
        for output in group.outputs:
            source = _source(group.inputs["Normal" if output.name == "Normal" else TANGENT])
            for target in [link.to_socket for link in output.links]:
                if source:
                    tree.links.new(source, target)
        tree.nodes.remove(group)
    return len(groups)


class LIBSHADE_OT_follow_bumps(TellsOfNothing, bpy.types.Operator):
    """Put Libshade Groove before every anisotropic shader of the file that has a bumped normal, so \
that its grooves go with the bumps in Cycles; or take it away again"""

    bl_idname = "libshade.follow_bumps"
    bl_label = "Make Grooves Follow Bumps"
    bl_options = {"REGISTER", "UNDO"}

    take_away: BoolProperty(name="Take Away", description="Undo it: shaders are as they were", default=False)
    strokes: EnumProperty(
        name="Strokes",
        items=[("TANGENT", "As Displaced", "What Cycles shows of the same surface displaced"),
               ("ACROSS", "On the Surface", "Strokes across the tangent stay on the lines of the surface")],
    )

    def execute(self, _context):
        if self.take_away:
            count = sum(take_away(tree) for tree in _trees())
            drop_patterns()  # which have it inside
            tree = next((tree for tree in bpy.data.node_groups if tree.get(_MARK)), None)
            if tree and not tree.users and not tree.library:
                bpy.data.node_groups.remove(tree)
        else:
            count = sum(place(tree, TANGENT if self.strokes == "TANGENT" else ACROSS) for tree in _trees())
        done = "taken from" if self.take_away else "put before"
        if count:
            self.report({"INFO"}, f"{NAME} {done} {count} shader{'s' * (count > 1)}")
            return {"FINISHED"}
        if self.take_away:
            return self.nothing(f"Nothing to take away: no {NAME} is in the file")
        return self.nothing(f"Nothing to do: no anisotropic shader has a linked Normal (Libshade Metal needs no {NAME})")


class LIBSHADE_OT_add_groove(bpy.types.Operator):
    """Tangent of a bumped surface, for anisotropic shaders of any renderer"""

    bl_idname = "libshade.add_groove"
    bl_label = NAME
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        space = context.space_data
        tree = space.edit_tree if getattr(space, "tree_type", "") == "ShaderNodeTree" else None
        return tree is not None and not tree.library

    def execute(self, context):
        tree = context.space_data.edit_tree
        for node in tree.nodes:
            node.select = False
        group = _new_group(tree)
        group.location = context.space_data.cursor_location
        tree.nodes.active = group
        return {"FINISHED"}

    def invoke(self, context, event):
        context.space_data.cursor_location_from_region(event.mouse_region_x, event.mouse_region_y)
        result = self.execute(context)
        bpy.ops.node.translate_attach_remove_on_cancel("INVOKE_DEFAULT")
        return result


def _draw_add_menu(self, context):
    if context.space_data.tree_type == "ShaderNodeTree":
        self.layout.operator_context = "INVOKE_DEFAULT"  # as own_node.add_button
        self.layout.operator(LIBSHADE_OT_add_groove.bl_idname)


def _draw_menu(self, context):
    if getattr(context.space_data, "tree_type", "ShaderNodeTree") == "ShaderNodeTree":
        self.layout.separator()
        self.layout.operator(LIBSHADE_OT_follow_bumps.bl_idname).take_away = False
        self.layout.operator(LIBSHADE_OT_follow_bumps.bl_idname, text="Take Libshade Groove Away").take_away = True


_CLASSES = (LIBSHADE_OT_follow_bumps, LIBSHADE_OT_add_groove)
_MENUS = ("NODE_MT_node", "MATERIAL_MT_context_menu")


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.NODE_MT_add.append(_draw_add_menu)
    for menu in _MENUS:
        getattr(bpy.types, menu).append(_draw_menu)


def unregister():
    for menu in _MENUS:
        getattr(bpy.types, menu).remove(_draw_menu)
    bpy.types.NODE_MT_add.remove(_draw_add_menu)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
