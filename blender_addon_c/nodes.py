# SPDX-License-Identifier: GPL-3.0-or-later
"""The material node, and the operator that turns it into a plain group.

Names, ranges and help come from libshade's own table, so that a word added
there appears here. Inside the node is an Anisotropic BSDF behind Libshade Groove: other renderers
see a metal whose grooves follow bumps. Older files have a Principled BSDF there, and keep it.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty

from . import _native, groove
from .group import new_socket
from .report import draw_on

METAL = "LibshadeMetalNode"
_OURS = (METAL, "LibshadeFabricNode")  # of fabric.py

_TABLE = _native.table()
# Table lists whose property on the node has another name.
_PROPERTY_OF_LIST = {"mdf": "distribution"}
_OLD_SHADER = "Principled BSDF"
_SHADER, _MATT, _GROOVE, _FRESNEL, _COLOR = "Anisotropic BSDF", "Diffuse BSDF", "Groove", "Fresnel", "Color"
_ACROSS, _STROKES = "Across", "Strokes"  # is it below 0; the tangent then; older files have a link in their place
# Sockets that properties set: what these say counts until a socket is linked or says something else.
SHAPE, MATT_COLOR = ("Roughness", "Anisotropy"), ("Diffuse Color",)
_SETS = {"ex": SHAPE, "ey": SHAPE, "ax": SHAPE, "ay": SHAPE, "kd": MATT_COLOR}
_INSIDE = {_SHADER, _MATT, _GROOVE, _FRESNEL, _COLOR}
# Of Cycles' distributions the nearest.
_DISTRIBUTION = {"ASHIKHMIN_SHIRLEY": "ASHIKHMIN_SHIRLEY", "GGX": "GGX"}


_NAMES = {"ex": "Exponent Along U", "ey": "Exponent Across U", "ax": "Alpha Along U", "ay": "Alpha Across U",
          "kd": "Diffuse Color"}


def _choices():
    """Pairs (list in the table, property on the node)."""
    return [(name, _PROPERTY_OF_LIST.get(name, name)) for name in _TABLE["lists"]]


def _parameters():
    """Rows of the table's parameters that are properties; f0 is the socket Color."""
    return [row for row in _TABLE["params"] if row["word"] != "f0"]


def _initial(row):
    return row["initial"] if row["components"] == 1 else (row["initial"],) * row["components"]


def _initial_choice(name):
    return _TABLE["about"][name]["initial"]


def _is_read(node, row):
    """Do the node's choices read this parameter?"""
    if not row["read_by"]:
        return True
    name, words = row["read_by"]
    return getattr(node, _PROPERTY_OF_LIST.get(name, name)).lower() in words


def settings(node):
    """A metal node's settings under the table's own names."""
    words = {name: getattr(node, attribute).lower() for name, attribute in _choices()}
    values = {row["word"]: getattr(node, row["word"]) for row in _parameters()}
    return {**words, **{word: value if isinstance(value, float) else tuple(value)
                        for word, value in values.items()}}


def initial_settings():
    """The same for a node as it is when new."""
    words = {name: _initial_choice(name) for name, _attribute in _choices()}
    return {**words, **{row["word"]: _initial(row) for row in _parameters()}}


def alpha_of(exponent):
    return (2.0 / (exponent + 2.0)) ** 0.5


def exponent_of(alpha):
    return max(0.0, 2.0 / (alpha * alpha) - 2.0)


def shape_of(ax, ay):
    """Roughness and anisotropy of alphas, as Cycles' Anisotropic BSDF has them: r² (1 - a) along the tangent and
    r² / (1 - a) across, or for a < 0 r² / (1 + a) and r² (1 + a)."""
    narrow, wide = sorted((ax, ay))
    ratio = 1.0 - (narrow / wide) ** 0.5
    return min(1.0, (ax * ay) ** 0.25), ratio if ax < ay else -ratio


def _numbers(socket):
    value = socket.default_value
    return tuple(value) if hasattr(value, "__len__") else (value,)


def sockets_rule(node, names):
    """Do these sockets say what the properties do not: are they linked, or not as properties set them? Nodes
    of older files have none."""
    sockets = [node.inputs[name] for name in names if name in node.inputs]
    if any(socket.is_linked for socket in sockets):
        return True
    kept = {"Roughness": node.set_shape[:1], "Anisotropy": node.set_shape[1:], "Diffuse Color": node.set_matt}
    return any(_numbers(socket) != tuple(kept[socket.name]) for socket in sockets)


# Exponents and alphas say the same thing; setting one sets the other.
_TWIN = {
    "ex": ("ax", alpha_of), "ey": ("ay", alpha_of),
    "ax": ("ex", exponent_of), "ay": ("ey", exponent_of),
}
# While a twin is being set, its own update must not answer.
_setting_twin = False


def _updater(word):
    def update(node, _context):
        global _setting_twin
        if _setting_twin:
            return
        if word in _TWIN:
            twin, convert = _TWIN[word]
            _setting_twin = True
            try:
                setattr(node, twin, convert(getattr(node, word)))
            finally:
                _setting_twin = False
        if word in _SETS:
            node.set_sockets(_SETS[word])
        node.update_preview()
    return update


def _properties():
    made = {}
    for name, attribute in _choices():
        made[attribute] = EnumProperty(
            name=attribute.replace("_", " ").title(),
            description=_TABLE["about"][name]["help"],
            items=[(row["word"].upper(), row["label"], row["help"], row["value"])
                   for row in _TABLE["lists"][name]],
            default=_initial_choice(name).upper(),
            update=lambda node, _context: node.update_preview(),
        )
    for row in _parameters():
        common = {
            "name": _NAMES.get(row["word"], row["word"]), "description": row["help"], "precision": 4,
            "min": row["minimum"], "max": row["maximum"], "default": _initial(row),
            "update": _updater(row["word"]),
        }
        if row["components"] == 1:
            made[row["word"]] = FloatProperty(**common)
        else:
            # A range of 0 to 1 is a colour; an index of refraction per channel is not.
            subtype = "COLOR" if row["maximum"] <= 1 else "NONE"
            made[row["word"]] = FloatVectorProperty(size=row["components"], subtype=subtype,
                                                    **common)
    # What the properties last set these sockets to.
    made["set_shape"] = FloatVectorProperty(size=2, options={"HIDDEN"})
    made["set_matt"] = FloatVectorProperty(size=4, options={"HIDDEN"})
    # The tree inside also belongs to a copy of this node, until one of them changes.
    made["shares_tree"] = BoolProperty(options={"HIDDEN"})
    return made


def _initial_color():
    value = next(row["initial"] for row in _TABLE["params"] if row["word"] == "f0")
    return tuple(value) if hasattr(value, "__len__") else (value,) * 3


def _new_tree():
    """What other renderers see: a metal along its tangent, of the UV map where that is 0."""
    tree = bpy.data.node_groups.new("Libshade Metal", "ShaderNodeTree")
    color = new_socket(tree, "Color", "INPUT", "NodeSocketColor")
    color.default_value = (*_initial_color(), 1.0)
    for name, low, high, about in (
            ("Roughness", 0.0, 1.0, "Its square is the width of the reflection"),
            ("Anisotropy", -0.99, 0.99, "How much narrower it is along the strokes: .9 is 100 : 1"),
            ("Rotation", -1e4, 1e4, "Turns the tangent; 1 is all the way round")):
        socket = new_socket(tree, name, "INPUT", "NodeSocketFloat")
        socket.min_value, socket.max_value, socket.description = low, high, about
    new_socket(tree, "Diffuse Color", "INPUT", "NodeSocketColor").default_value = (0.0, 0.0, 0.0, 1.0)
    normal = new_socket(tree, "Normal", "INPUT", "NodeSocketVector")
    normal.hide_value = True  # unlinked, it is the surface's own normal
    new_socket(tree, "Tangent", "INPUT", "NodeSocketVector").hide_value = True
    new_socket(tree, "BSDF", "OUTPUT", "NodeSocketShader")

    def new(kind, x, y, name=""):
        node = tree.nodes.new(kind)
        node.location, node.name = (x, y), name or node.name
        return node

    inputs, tangent = new("NodeGroupInput", -500, 0), new("ShaderNodeTangent", -500, -300)
    group = new("ShaderNodeGroup", 50, -200, _GROOVE)
    facing, power = new("ShaderNodeLayerWeight", 50, 200), new("ShaderNodeMath", 200, 200)
    edge, color = new("ShaderNodeMath", 350, 200, _FRESNEL), new("ShaderNodeMixRGB", 500, 100, _COLOR)
    shader, matt = new("ShaderNodeBsdfAnisotropic", 700, 0, _SHADER), new("ShaderNodeBsdfDiffuse", 700, -250, _MATT)
    both, outputs = new("ShaderNodeAddShader", 900, 0), new("NodeGroupOutput", 1100, 0)
    tangent.direction_type = "UV_MAP"
    group.node_tree, group.label = groove.groove_tree(), groove.NAME
    facing.inputs["Blend"].default_value = 0.5  # Facing is then 1 less the cosine to the eye
    power.operation, edge.operation = "POWER", "MULTIPLY"
    power.inputs[1].default_value = 5.0
    color.inputs["Color2"].default_value = (1.0, 1.0, 1.0, 1.0)
    link = tree.links.new
    link(inputs.outputs["Normal"], group.inputs["Normal"])
    link(_either(tree, inputs.outputs["Tangent"], tangent.outputs["Tangent"]), group.inputs["Tangent"])
    link(facing.outputs["Facing"], power.inputs[0])
    link(power.outputs[0], edge.inputs[0])
    link(edge.outputs[0], color.inputs["Fac"])
    link(inputs.outputs["Color"], color.inputs["Color1"])
    link(color.outputs[0], shader.inputs["Color"])
    for name in (*SHAPE, "Rotation"):
        link(inputs.outputs[name], shader.inputs[name])
    across, strokes = new("ShaderNodeMath", 200, -350, _ACROSS), new("ShaderNodeMix", 400, -250, _STROKES)
    across.operation, strokes.data_type = "LESS_THAN", "VECTOR"
    across.inputs[1].default_value = 0.0
    link(inputs.outputs["Anisotropy"], across.inputs[0])
    sockets = _mixed(strokes)
    link(group.outputs[groove.TANGENT], sockets["A_Vector"])
    link(group.outputs[groove.ACROSS], sockets["B_Vector"])
    link(sockets["Result_Vector"], shader.inputs["Tangent"])
    link(inputs.outputs["Diffuse Color"], matt.inputs["Color"])
    for node in (facing, shader, matt):
        link(group.outputs["Normal"], node.inputs["Normal"])
    link(shader.outputs["BSDF"], both.inputs[0])
    link(matt.outputs["BSDF"], both.inputs[1])
    link(both.outputs["Shader"], outputs.inputs["BSDF"])
    return tree


def _mixed(node):
    """Sockets of a Mix node by identifier: their names repeat."""
    return {socket.identifier: socket for socket in (*node.inputs, *node.outputs)}


def _either(tree, vector, other):
    """A vector, or another one where it is 0."""
    length, there, mix = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("VectorMath", "Math", "Mix"))
    length.operation, there.operation, mix.data_type = "LENGTH", "GREATER_THAN", "VECTOR"
    there.inputs[1].default_value = 0.0
    length.location, there.location, mix.location = (-100, -300), (50, -300), (150, -150)
    sockets = _mixed(mix)
    tree.links.new(vector, length.inputs[0])
    tree.links.new(length.outputs["Value"], there.inputs[0])
    tree.links.new(there.outputs[0], sockets["Factor_Float"])
    tree.links.new(other, sockets["A_Vector"])
    tree.links.new(vector, sockets["B_Vector"])
    return sockets["Result_Vector"]


class LibshadeMetalNode(bpy.types.ShaderNodeCustomGroup):
    """Anisotropic metal whose microfacets follow the bumped normal"""

    bl_idname = METAL
    bl_label = "Libshade Metal"
    bl_width_default = 200
    __annotations__ = _properties()

    def init(self, _context):
        self.node_tree = _new_tree()
        self.set_sockets((*SHAPE, *MATT_COLOR))
        self.update_preview()

    def copy(self, node):
        # Giving the copy a tree of its own right here would upset Blender 3.4's count of the
        # tree's users, and a tree without users is not saved.
        self.shares_tree = node.shares_tree = True

    def set_sockets(self, names):
        """What properties say, to the sockets that say the same; a socket brings it into its range."""
        if any(name not in self.inputs for name in names):
            return  # of an older file
        said = {**dict(zip(SHAPE, shape_of(self.ax, self.ay))), "Diffuse Color": (*self.kd, 1.0)}
        for name in names:
            self.inputs[name].default_value = said[name]
        if names != MATT_COLOR:
            self.set_shape = [part for name in SHAPE for part in _numbers(self.inputs[name])]
        if names != SHAPE:
            self.set_matt = _numbers(self.inputs["Diffuse Color"])

    def update_preview(self):
        """Carry the settings over to the shaders inside."""
        inner = self.node_tree.nodes if self.node_tree else {}
        old = inner.get(_OLD_SHADER)
        if not old and not all(inner.get(name) for name in _INSIDE):
            return  # someone has been inside
        if self.shares_tree:
            self.node_tree, self.shares_tree = self.node_tree.copy(), False
            inner = self.node_tree.nodes
        if old:
            self._update_principled(inner[_OLD_SHADER])
        else:
            self._update_anisotropic(inner)

    def _update_principled(self, shader):
        """Cycles' convention: alphas are r²/a along the tangent and r²·a across, with
        a² = 1 − 0.9 anisotropic; a quarter turn swaps the two.
        """
        narrow, wide = sorted((self.ax, self.ay))
        shader.inputs["Roughness"].default_value = min(1.0, (narrow * wide) ** 0.25)
        shader.inputs["Anisotropic"].default_value = min(1.0, (1.0 - narrow / wide) / 0.9)
        shader.inputs["Anisotropic Rotation"].default_value = 0.25 if self.ax < self.ay else 0.0

    def _update_anisotropic(self, inner):
        """The sockets feed the shaders; those of older files, which have none, keep these values."""
        shader, matt = inner[_SHADER], inner[_MATT]
        shader.distribution = _DISTRIBUTION.get(self.distribution, "BECKMANN")
        for name, value in zip(SHAPE, shape_of(self.ax, self.ay)):
            shader.inputs[name].default_value = value
        inner[_FRESNEL].inputs[1].default_value = float(self.fresnel != "NONE")
        color, links = inner[_COLOR].inputs["Color1"], self.node_tree.links
        if self.fresnel == "CONDUCTOR":
            for link in color.links:
                links.remove(link)
            color.default_value = (*[((n - 1.0) ** 2 + k * k) / ((n + 1.0) ** 2 + k * k)
                                     for n, k in zip(self.eta, self.k)], 1.0)
        elif not color.is_linked:
            for given in (n for n in inner if n.bl_idname == "NodeGroupInput"):
                links.new(given.outputs["Color"], color)
        matt.inputs["Color"].default_value = (*self.kd, 1.0)
        if _STROKES in inner:
            self._turn_strokes(inner[_ACROSS], _mixed(inner[_STROKES])["Factor_Float"])
            return
        groove_x = self.groove == "X" or self.groove == "AUTO" and self.ax <= self.ay
        links.new(inner[_GROOVE].outputs[groove.TANGENT if groove_x else groove.ACROSS],
                  shader.inputs["Tangent"])

    def _turn_strokes(self, across, factor):
        """To the narrow axis, wherever that is, or to the one that is asked for."""
        if self.groove == "AUTO":
            self.node_tree.links.new(across.outputs[0], factor)
            return
        for link in factor.links:
            self.node_tree.links.remove(link)
        factor.default_value = float(self.groove == "Y")

    def draw_buttons(self, _context, layout):
        draw_on(self, layout)
        layout.operator_menu_enum(LIBSHADE_OT_metal_preset.bl_idname, "preset", text="Preset")
        layout.prop(self, "distribution", text="")
        layout.prop(self, "detail")
        if SHAPE[0] in self.inputs:  # they say it
            return
        column = layout.column(align=True)
        for row in _parameters():
            if row["read_by"] and row["read_by"][0] == "mdf" and _is_read(self, row):
                column.prop(self, row["word"])

    def draw_buttons_ext(self, _context, layout):
        layout.operator_menu_enum(LIBSHADE_OT_metal_preset.bl_idname, "preset", text="Preset")
        for _name, attribute in _choices():
            layout.prop(self, attribute)
        for row in _parameters():
            twin = _TWIN.get(row["word"])  # both of a pair: what one says in the other's terms
            if twin or _is_read(self, row):
                layout.prop(self, row["word"])
        layout.operator(LIBSHADE_OT_convert_to_group.bl_idname)

    def draw_label(self):
        return "Libshade Metal"


_METALS = {row["word"].upper(): row for row in _TABLE["metals"]}
_ROUND = "libshade_round"  # on a Tangent node that a preset has placed


def apply_preset(node, preset):
    """Make a metal node a metal of libshade's; strokes of turned ones go round the object's z axis
    where nothing else says where."""
    row = _METALS[preset]
    values = _native.metal(row["word"])
    for name, attribute in _choices():
        setattr(node, attribute, values[name].upper())
    for parameter in _parameters():
        setattr(node, parameter["word"], values[parameter["word"]])
    node.inputs["Color"].default_value = (*values["f0"], 1.0)
    tree, tangent = node.id_data, node.inputs["Tangent"]
    source = tangent.links[0].from_node if tangent.is_linked else None
    if row["turned"] and not source:
        source = tree.nodes.new("ShaderNodeTangent")
        source.direction_type, source.axis, source[_ROUND] = "RADIAL", "Z", True
        source.parent, source.location = node.parent, (node.location[0] - 200, node.location[1] - 150)
        tree.links.new(source.outputs[0], tangent)
    elif not row["turned"] and source and source.get(_ROUND):
        tree.links.remove(tangent.links[0])
        if not source.outputs[0].is_linked:
            tree.nodes.remove(source)


class LIBSHADE_OT_metal_preset(bpy.types.Operator):
    """Give this Libshade Metal the settings of a metal; its scratches are in its roughness, as from afar"""

    bl_idname = "libshade.metal_preset"
    bl_label = "Metal"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Metal", description="Which metal, worked how",
                         items=[(word, row["label"], row["help"]) for word, row in _METALS.items()])

    @staticmethod
    def node_of(context):
        node = getattr(context, "node", None) or getattr(context, "active_node", None)
        return node if node and node.bl_idname == METAL else None

    @classmethod
    def poll(cls, context):
        node = cls.node_of(context)
        return node is not None and not node.id_data.library

    def execute(self, context):
        apply_preset(self.node_of(context), self.preset)
        return {"FINISHED"}


def _replace_by_group(tree, node):
    """Put a Group node with the same tree, values and links in a Libshade node's place."""
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = node.node_tree
    group.label, group.parent = node.label or node.bl_label, node.parent
    group.location, group.width, group.hide = node.location, node.width, node.hide
    for old, new in zip(node.inputs, group.inputs):
        if hasattr(old, "default_value"):
            new.default_value = old.default_value
        for link in old.links:
            tree.links.new(link.from_socket, new)
    for old, new in zip(node.outputs, group.outputs):
        for target in [link.to_socket for link in old.links]:
            tree.links.new(new, target)
    name = node.name
    tree.nodes.remove(node)
    group.name = name


class LIBSHADE_OT_convert_to_group(bpy.types.Operator):
    """Replace Libshade nodes by plain groups of Cycles' own shaders, for files that must \
render without this add-on. Settings that those shaders lack are lost"""

    bl_idname = "libshade.convert_to_group"
    bl_label = "Convert to Plain Group"
    bl_options = {"REGISTER", "UNDO"}

    all_materials: BoolProperty(
        name="All Materials",
        description="Convert in every material of the file, not only in the active one",
        default=False,
    )

    def execute(self, context):
        if self.all_materials:
            trees = [m.node_tree for m in bpy.data.materials if m.node_tree]
            trees += [t for t in bpy.data.node_groups if t.bl_idname == "ShaderNodeTree"]
        else:
            material = getattr(context, "material", None) or (
                context.object and context.object.active_material)
            trees = [material.node_tree] if material and material.node_tree else []
        nodes = [(t, n) for t in trees if not t.library for n in t.nodes if n.bl_idname in _OURS]
        if not nodes:
            self.report({"WARNING"}, "No Libshade node here to convert")
            return {"CANCELLED"}
        for tree, node in nodes:
            _replace_by_group(tree, node)
        self.report({"INFO"}, f"Converted {len(nodes)} Libshade node(s)")
        return {"FINISHED"}


def _draw_add_menu(self, context):
    if context.space_data.tree_type == "ShaderNodeTree":
        self.layout.separator()
        add = self.layout.operator("node.add_node", text=LibshadeMetalNode.bl_label)
        add.type, add.use_transform = METAL, True


def register():
    if not bpy.types.Node.bl_rna_get_subclass_py(METAL):  # see unregister
        bpy.utils.register_class(LibshadeMetalNode)
    bpy.utils.register_class(LIBSHADE_OT_metal_preset)
    bpy.utils.register_class(LIBSHADE_OT_convert_to_group)
    bpy.types.NODE_MT_add.append(_draw_add_menu)


def unregister():
    bpy.types.NODE_MT_add.remove(_draw_add_menu)
    bpy.utils.unregister_class(LIBSHADE_OT_convert_to_group)
    bpy.utils.unregister_class(LIBSHADE_OT_metal_preset)
    # Blender 3.4 crashes when it frees the evaluated copy of a node whose class is gone: there
    # the class stays until Blender ends, and the add-on finds it when it is enabled again.
    if bpy.app.version >= (5, 0):
        bpy.utils.unregister_class(LibshadeMetalNode)
