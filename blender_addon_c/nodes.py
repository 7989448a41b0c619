# SPDX-License-Identifier: GPL-3.0-or-later
"""The metal node, its presets and measured metals, and the operator that turns it into a plain group.

Names, ranges and help come from libshade's own table, so that a word added
there appears here. What other renderers see of it is in metal_tree.py.
"""

from math import log10

import bpy
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, StringProperty

from . import _native, metal_tree, working_space
from .group import drop_patterns, own_tree, renew, unhide
from .manual import draw_button
from .metal_tree import EDGE, MATT_COLOR, SHAPE
from .names import FABRIC, METAL, SCRATCHES
from .own_node import CHOSEN, NodePanel, OnNode, add_button, preset_of_scripts, register_node, unregister_node
from .report import TellsOfNothing, draw_on, is_enabled

_NAME = "Libshade Metal"
_OURS = (METAL, FABRIC, SCRATCHES)

_TABLE = _native.table()
# Table lists whose property on the node has another name.
_PROPERTY_OF_LIST = {"mdf": "distribution"}
_OF_LOBE = ("distribution", "brdf")
_SETS = {"ex": SHAPE, "ey": SHAPE, "ax": SHAPE, "ay": SHAPE, "kd": MATT_COLOR}
_OF_SOCKETS = {SHAPE: "set_shape", MATT_COLOR: "set_matt", EDGE: "set_edge"}  # what properties set them to

_NAMES = {"ex": "Exponent Along U", "ey": "Exponent Across U", "ax": "Alpha Along U", "ay": "Alpha Across U",
          "kd": "Diffuse Color", "f82": "Edge Tint", "eta": "Index of Refraction", "k": "Extinction",
          "brdf": "BRDF", "detail": "Detail Method", "groove": "Stroke Axis", "diffuse": "Diffuse Model"}


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


def _first_choice(name):
    """The default of version 0: what a node says that a file keeps nothing of."""
    return _TABLE["about"][name]["first"]


def _is_read(node, row):
    """Do the node's choices read this parameter?"""
    if not row["read_by"]:
        return True
    name, words = row["read_by"]
    return getattr(node, _PROPERTY_OF_LIST.get(name, name)).lower() in words


def settings(node):
    """A metal node's settings under the table's own names."""
    words = {name: getattr(node, attribute).lower() for name, attribute in _choices()}
    values = {**{row["word"]: getattr(node, row["word"]) for row in _parameters()}, **_widths(node)}
    return {**words, **{word: value if isinstance(value, float) else tuple(value)
                        for word, value in values.items()}}


def initial_settings():
    """The same for a node as it is when new."""
    words = {name: _initial_choice(name) for name, _attribute in _choices()}
    return {**words, **{row["word"]: _initial(row) for row in _parameters()}}


def _widths(node):
    """Its exponents and alphas. Keyframes and drivers set one of a pair and run no update: the other is what that one says. Where
    it is not known which, as on nodes of older files, the one counts that the distribution reads."""
    told, found = getattr(node, "set_width", (0.0,) * 4), {}
    for at, axis in enumerate(_UV_AXES):
        pair = e, a = f"e{axis}", f"a{axis}"
        found[e], found[a] = getattr(node, e), getattr(node, a)
        if _agree(found[e], found[a]):
            continue
        known = [(word, was) for word, was in zip(pair, (told[at], told[at + 2])) if told[at + 2]]
        moved = [word for word, was in known if found[word] != was]
        if known and not moved:  # at the end of a range
            continue
        rules = moved[0] if len(moved) == 1 else pair[node.distribution != "ASHIKHMIN_SHIRLEY"]
        twin, convert = _TWIN[rules]
        found[twin] = convert(found[rules])
    return found


def _agree(exponent, alpha):
    return abs(exponent_of(alpha) - exponent) <= 1e-4 * exponent


def alpha_of(exponent):
    return (2.0 / (exponent + 2.0)) ** 0.5


def exponent_of(alpha):
    return max(0.0, 2.0 / (alpha * alpha) - 2.0)


def _numbers(socket):
    value = socket.default_value
    return tuple(value) if hasattr(value, "__len__") else (value,)


def sockets_rule(node, names):
    """Do these sockets say what the properties do not: are they linked, or not as properties set them? Nodes
    of older files have none."""
    sockets = [node.inputs[name] for name in names if name in node.inputs]
    said = [part for socket in sockets for part in _numbers(socket)]
    return any(socket.is_linked for socket in sockets) or bool(sockets) and said != list(getattr(node, _OF_SOCKETS[names]))


def shows_index(node):
    """Do Color and Edge Tint show what its index of refraction reflects? Not on nodes of older files, which kept Color beside it."""
    return node.fresnel == "CONDUCTOR" and EDGE[0] in node.inputs and getattr(node, "set_color", (0.0,) * 4)[3] > 0


def colors_rule(node):
    """Are the colours that show an index of refraction linked, or changed since? They count then, not the index."""
    color = node.inputs["Color"]
    return shows_index(node) and (color.is_linked or _numbers(color) != tuple(node.set_color) or sockets_rule(node, EDGE))


def fresnel_of(node):
    """Its Fresnel: an Edge Tint is that of 82 degrees, where no index of refraction tells more."""
    if colors_rule(node):
        return "F82"
    if node.fresnel in metal_tree.TINTED and sockets_rule(node, EDGE):
        return "F82"
    return node.fresnel


def lobe(node):
    """Alphas along the tangent and across, of numbers on the sockets or of properties."""
    if SHAPE[0] in node.inputs and sockets_rule(node, SHAPE):
        return metal_tree.alphas_of(*(node.inputs[name].default_value for name in SHAPE))
    found = _widths(node)
    return found["ax"], found["ay"]


# Exponents and alphas say the same thing; setting one sets the other.
_UV_AXES = "xy"
_TWIN = {
    "ex": ("ax", alpha_of), "ey": ("ay", alpha_of),
    "ax": ("ex", exponent_of), "ay": ("ey", exponent_of),
}
# While a twin is being set, its own update must not answer.
_setting_twin = False
# While a preset sets them all, sockets and the tree inside follow once, at its end.
_setting_all = False


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
            node.note_width(word[1])
            if node.is_new and not _setting_all:  # who says the lobe's numbers means these
                node.is_new, node.strokes = False, 0.0
                node.grain = "UV" if node.grain == NEW_GRAIN else node.grain
        if _setting_all:
            return
        if word in _SETS:
            node.set_sockets(_SETS[word])
        if word == "f82" and node.fresnel == "F82" or word == "fresnel" and not sockets_rule(node, EDGE):
            node.set_sockets(EDGE)
        if word in ("eta", "k") and shows_index(node) and not colors_rule(node):
            node.show_index()
        node.update_preview()
    return update


_AXES = "XYZ"
_GRAINS = (
    ("UV", "UV", "Strokes run along u of a UV map"),
    *((f"RADIAL_{axis}", f"Radial {axis}", f"Strokes run round the object's {axis} axis, as on turned metal") for axis in _AXES),
    *((f"AXIS_{axis}", f"Object {axis}", f"Strokes run along the object's {axis} axis") for axis in _AXES),
)
_RESPONSES = (("FOLLOW", "Follow", "Strokes and reflections go with the bumps of Normal"),
              ("IGNORE", "Ignore", "The metal reflects as if nothing were linked to Normal"))
BUMPS = (("RELIEF", "Relief", "All slopes of Normal are bumps on the surface, which shade each other"),
         ("SHAPE", "Shape", "Of a baked map: slopes of long waves are the object's own shape, which shades nothing; those of short ones are bumps on it"))
STROKE_WIDTH, NEW_GRAIN = 60.0, "AXIS_Y"
NEW_HORIZON = "MUTUAL"  # not the library's default, which no slopes are known to
_WIDTHS = (("ROUGHNESS", "Roughness", "Roughness and anisotropy, as on the sockets"),
           ("ALPHA", "Alpha", "Alphas along the strokes' tangent and across it"),
           ("EXPONENTS", "Exponents", "Exponents along the strokes' tangent and across it"))
_LEAST_EXPONENT = 0.01


def _slider(kind, axis):
    """A logarithm of an alpha or an exponent of the lobe, whatever says it."""
    word = f"{kind}{'xy'[axis]}"

    low, high = (log10(_LEAST_EXPONENT), 6.0) if kind == "e" else (-4.0, 1.0)

    def get(node):
        alpha = lobe(node)[axis]
        return min(high, log10(max(10.0**low, exponent_of(alpha) if kind == "e" else alpha)))

    def put(node, value):
        for name, alpha in zip(("ax", "ay"), lobe(node)):
            setattr(node, name, alpha)
        # Blender leaves the limits of a property with a setter to the setter.
        setattr(node, word, 10.0 ** max(low, min(high, value)))

    row = next(row for row in _parameters() if row["word"] == word)
    return FloatProperty(name=_NAMES[word], description=f"{row['help']}; the slider is its power of ten", subtype="FACTOR",
                         min=low, max=high, get=get, set=put)


def _properties():
    made = {}
    for name, attribute in _choices():
        made[attribute] = EnumProperty(
            name=_NAMES.get(name, attribute.replace("_", " ").title()),
            description=_TABLE["about"][name]["help"],
            items=[(row["word"].upper(), row["label"], row["help"], row["value"])
                   for row in _TABLE["lists"][name]],
            default=_first_choice(name).upper(),
            update=_updater(attribute),
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
    made["grain"] = EnumProperty(name="Grain", description="Where strokes run, if nothing is linked to Tangent",
                                 items=_GRAINS, update=_updater("grain"))
    made["uv_map"] = StringProperty(name="UV Map", description="Of the strokes; none: the active one", update=_updater("uv_map"))
    made["bump_response"] = EnumProperty(name="Bump Response", description="What bumps do to the metal", items=_RESPONSES,
                                         update=_updater("bump_response"))
    made["bumps_are"] = EnumProperty(name="Bumps Are", description="What Mutual takes an image or scratches at Normal for", items=BUMPS,
                                     update=_updater("bumps_are"))
    made["strokes"] = FloatProperty(name="Strokes", description="How much rougher the tool's strokes are than what is between them; 0: none",
                                    subtype="FACTOR", min=0.0, max=1.0, default=0.0, update=_updater("strokes"))
    made["stroke_width"] = FloatProperty(name="Width mm", description="Of the coarsest strokes, in millimetres; finer ones lie in between",
                                         min=0.01, soft_max=1000.0, max=1e5, default=STROKE_WIDTH, update=_updater("stroke_width"))
    made["is_new"] = BoolProperty(options={"HIDDEN"})  # has it still the strokes that it began with?
    made["width_as"] = EnumProperty(name="Width as", description="The same lobe in other numbers", items=_WIDTHS)
    for kind in "ae":
        for axis in (0, 1):
            made[f"shown_{kind}{'xy'[axis]}"] = _slider(kind, axis)
    # What the properties last set these sockets to.
    made["set_shape"] = FloatVectorProperty(size=2, options={"HIDDEN"})
    made["set_matt"] = FloatVectorProperty(size=4, options={"HIDDEN"})
    made["set_edge"] = FloatVectorProperty(size=4, options={"HIDDEN"})
    made["set_width"] = FloatVectorProperty(size=4, options={"HIDDEN"})  # ex, ey, ax, ay as they last set each other
    made["set_color"] = FloatVectorProperty(size=4, options={"HIDDEN"})  # 0: it never told of an index
    # The tree inside also belongs to a copy of this node, until one of them changes.
    made["shares_tree"] = BoolProperty(options={"HIDDEN"})
    return {**made, **CHOSEN}


def _initial_color():
    value = next(row["initial"] for row in _TABLE["params"] if row["word"] == "f0")
    return tuple(value) if hasattr(value, "__len__") else (value,) * 3


_METALS = {row["word"].upper(): row for row in _TABLE["metals"]}


class LibshadeMetalNode(bpy.types.ShaderNodeCustomGroup):
    """Anisotropic metal whose microfacets follow the bumped normal"""

    bl_idname = METAL
    bl_label = f"{_NAME} (brushed, anisotropic)"  # 3.4's search of nodes to add knows no other words
    bl_width_default = 230
    __annotations__ = _properties()
    preset = preset_of_scripts(_METALS, lambda node, word: apply_preset(node, word))

    def init(self, _context):
        global _setting_all
        self.name = _NAME
        self.node_tree = metal_tree.new_tree(_initial_color())
        _setting_all = True
        for name, attribute in _choices():
            if _initial_choice(name) != _first_choice(name):  # kept in the file: older ones have nothing there
                setattr(self, attribute, _initial_choice(name).upper())
        self.horizon = NEW_HORIZON
        self.strokes, self.grain, self.is_new = 1.0, NEW_GRAIN, True  # on what has no UV map, too
        _setting_all = False
        for axis in _UV_AXES:
            self.note_width(axis)
        for names in _OF_SOCKETS:
            self.set_sockets(names)
        self.update_preview()

    def note_width(self, axis):
        """Exponent and alpha along an axis say the same now."""
        at = _UV_AXES.index(axis)
        self.set_width[at], self.set_width[at + 2] = getattr(self, f"e{axis}"), getattr(self, f"a{axis}")

    def copy(self, node):
        # Giving the copy a tree of its own right here would upset Blender 3.4's count of the
        # tree's users, and a tree without users is not saved.
        self.shares_tree = node.shares_tree = True

    def set_sockets(self, names, by=None):
        """What properties (of `by`) say, to the sockets that say the same; a socket brings it into its range."""
        if any(name not in self.inputs for name in names):
            return  # of an older file
        by = by or self
        said = {**dict(zip(SHAPE, metal_tree.shape_of(*_alphas(by)))), "Diffuse Color": (*by.kd, 1.0),
                "Edge Tint": (*by.f82, 1.0) if by.fresnel == "F82" else (1.0,) * 4}
        if names == EDGE and shows_index(self):
            said["Edge Tint"] = (*(metal_tree.edge_tint(n, k) for n, k in zip(by.eta, by.k)), 1.0)
        for name in names:
            self.inputs[name].default_value = said[name]
        setattr(self, _OF_SOCKETS[names], [part for name in names for part in _numbers(self.inputs[name])])

    def show_index(self, by=None):
        """Color and Edge Tint become what the index of refraction (of `by`) reflects, until they are changed."""
        by, color = by or self, self.inputs["Color"]
        color.default_value = (*(metal_tree.reflectance(n, k, 1.0) for n, k in zip(by.eta, by.k)), 1.0)
        if EDGE[0] in self.inputs:
            self.set_color = _numbers(color)
            self.set_sockets(EDGE, by)

    def update_preview(self, by=None):
        """Carry the settings (of `by`) over to the shaders inside."""
        if not metal_tree.can_update(self.node_tree):
            return
        metal_tree.update(own_tree(self), by or self, _alphas(by or self))

    def follow(self, animated):
        """What keyframes and drivers make of the properties, for what is inside."""
        if shows_index(self) and not colors_rule(self) and animated.fresnel == "CONDUCTOR":
            self.show_index(animated)
        for names in _OF_SOCKETS:
            if not sockets_rule(self, names):
                self.set_sockets(names, animated)
        self.update_preview(animated)

    def draw_buttons(self, context, layout):
        if not draw_on(self, layout):
            return
        layout.operator_menu_enum(LIBSHADE_OT_metal_preset.bl_idname, "preset", text="Preset")
        if is_old(self):
            layout.operator(LIBSHADE_OT_update_nodes.bl_idname, icon="FILE_REFRESH")
            self._draw_numbers(layout)
            return
        layout.prop(self, "grain")
        if self.grain == "UV":
            meshes = [ob.data for ob in (getattr(context, "object", None),) if ob and ob.type == "MESH"]
            if meshes:
                layout.prop_search(self, "uv_map", meshes[0], "uv_layers")
            else:
                layout.prop(self, "uv_map")
        column = layout.column(align=True)
        column.prop(self, "strokes")
        if self.strokes > 0:
            column.prop(self, "stroke_width")
        layout.prop(self, "bump_response", text="Bumps")  # the whole name is wider than the node

    def _draw_numbers(self, layout):
        if SHAPE[0] in self.inputs:  # they say it
            return
        column = layout.column(align=True)
        for row in _parameters():
            if row["read_by"] and row["read_by"][0] == "mdf" and _is_read(self, row):
                column.prop(self, row["word"])

    def draw_buttons_ext(self, context, layout):
        self.draw_buttons(context, layout)
        if not is_enabled():
            return
        layout.operator(LIBSHADE_OT_convert_to_group.bl_idname)
        draw_button(layout, "blender/metal.html")

    def draw_advanced(self, layout):
        """What most artists need not touch."""
        for _name, attribute in _choices():
            choice = layout.row()
            choice.enabled = self.strokes == 0 or attribute not in _OF_LOBE  # strokes have a lobe of their own
            choice.prop(self, attribute)
            if attribute == "horizon" and self.horizon == "MUTUAL":
                layout.prop(self, "bumps_are")
        layout.operator_menu_enum(LIBSHADE_OT_measured_metal.bl_idname, "metal", text="Measured Metal")
        for row in _parameters():
            socket = {"f82": EDGE[0], "kd": "Diffuse Color"}.get(row["word"])  # says the same
            if row["word"] not in _TWIN and _is_read(self, row) and not (socket and socket in self.inputs):
                layout.prop(self, row["word"])
        layout.prop(self, "width_as")
        if any(self.inputs[name].is_linked for name in SHAPE if name in self.inputs):
            lines = layout.column(align=True)  # as wide as the sidebar at first
            lines.label(text="By what is linked to", icon="LINKED")
            lines.label(text="Roughness, Anisotropy", icon="BLANK1")
            return
        column = layout.column(align=True)
        if self.width_as == "ROUGHNESS" and SHAPE[0] in self.inputs:
            for name in SHAPE:
                column.prop(self.inputs[name], "default_value", text=name)
            return
        kind = "e" if self.width_as == "EXPONENTS" else "a"
        for axis, alpha in zip("xy", lobe(self)):
            value = exponent_of(alpha) if kind == "e" else alpha
            column.label(text=f"{_NAMES[kind + axis]}: {value:.4g}")
            row = column.row()
            row.use_property_split = False  # its name has room
            row.prop(self, f"shown_{kind}{axis}", text="Power of Ten")

    def draw_label(self):
        return _NAME


def _alphas(node):
    """What its properties say; one distribution reads exponents, which end where alphas go on."""
    found = _widths(node)
    if node.distribution != "ASHIKHMIN_SHIRLEY":
        return found["ax"], found["ay"]
    return tuple(a if _agree(e, a) else alpha_of(e) for e, a in ((found["ex"], found["ax"]), (found["ey"], found["ay"])))


def is_old(node):
    """Is it of a version with less inside, which no one has changed?"""
    return EDGE[0] not in node.inputs and metal_tree.can_update(node.node_tree)


_MEASURED = {row["word"].upper(): row for row in _TABLE["measured"]}
_ROUND = "libshade_round"  # on a Tangent node that a preset has placed, before nodes had a Grain


def metals():
    """Words of the presets, and their rows in the native module's table."""
    return dict(_METALS)


def apply_preset(node, preset):
    """Make a metal node a metal of libshade's; strokes of turned ones go round the object's z axis
    where nothing else says where."""
    global _setting_all
    row = _METALS[preset]
    values = _native.metal(row["word"])
    values["eta"], values["k"] = metal_tree.here(values["eta"], values["k"])
    values["kd"] = working_space.here(values["kd"])
    _setting_all = True
    try:
        for name, attribute in _choices():
            if name != "horizon":  # no metal's own
                setattr(node, attribute, values[name].upper())
        for parameter in _parameters():
            setattr(node, parameter["word"], values[parameter["word"]])
    finally:
        _setting_all = False
    for names in _OF_SOCKETS:
        node.set_sockets(names)
    node.show_index()
    node.update_preview()
    tangent = node.inputs["Tangent"]
    source = tangent.links[0].from_node if tangent.is_linked else None
    if source and source.get(_ROUND):
        tree = node.id_data
        tree.links.remove(tangent.links[0])
        if not source.outputs[0].is_linked:
            tree.nodes.remove(source)
    node.chosen = preset
    if node.is_new:
        node.strokes = 1.0 if row["turned"] or row["word"].startswith("brushed") else 0.0
    if row["turned"] or node.grain.startswith("RADIAL"):
        node.grain = "RADIAL_Z" if row["turned"] else NEW_GRAIN if node.is_new else "UV"


class LIBSHADE_OT_metal_preset(OnNode, bpy.types.Operator):
    """Give this Libshade Metal the settings of a metal; its scratches are in its roughness, as from afar"""

    kind = METAL
    bl_idname = "libshade.metal_preset"
    bl_label = "Metal"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Metal", description="Which metal, worked how",
                         items=[(word, row["label"], row["help"]) for word, row in _METALS.items()])

    def execute(self, context):
        apply_preset(self.node_of(context), self.preset)
        return {"FINISHED"}


class LIBSHADE_OT_measured_metal(OnNode, bpy.types.Operator):
    """Give this Libshade Metal a measured metal's index of refraction, and so its colour at every angle"""

    kind = METAL
    bl_idname = "libshade.measured_metal"
    bl_label = "Measured Metal"
    bl_options = {"REGISTER", "UNDO"}

    metal: EnumProperty(name="Metal", description="By its measured spectrum, under daylight",
                        items=[(word, row["label"], "") for word, row in _MEASURED.items()])

    def execute(self, context):
        node, row = self.node_of(context), _MEASURED[self.metal]
        node.fresnel = "CONDUCTOR"
        node.eta, node.k = metal_tree.here(row["eta"], row["k"])
        node.show_index()
        node.update_preview()
        return {"FINISHED"}


class LIBSHADE_OT_update_nodes(TellsOfNothing, bpy.types.Operator):
    """Give Libshade nodes of older files the sockets and properties that newer ones have"""

    bl_idname = "libshade.update_nodes"
    bl_label = "Update Libshade Nodes"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, _context):
        trees = [material.node_tree for material in bpy.data.materials if material.node_tree]
        trees += [tree for tree in bpy.data.node_groups if tree.bl_idname == "ShaderNodeTree"]
        old = [(tree, node) for tree in trees if not tree.library
               for node in tree.nodes if node.bl_idname in UPDATES and UPDATES[node.bl_idname][0](node)]
        for tree, node in old:
            UPDATES[node.bl_idname][1](tree, node)
        if not old:
            return self.nothing("No Libshade node is of an older version")
        self.report({"INFO"}, f"Updated {len(old)} Libshade node(s)")
        return {"FINISHED"}


def _update_node(tree, node):
    """A new tree inside; what the old sockets said goes on to hold."""
    ruled = {names for names in _OF_SOCKETS if all(name in node.inputs for name in names) and sockets_rule(node, names)}

    def fill(said):
        for names in _OF_SOCKETS:
            node.set_sockets(names)
            if names in ruled:
                for name in names:
                    node.inputs[name].default_value = said[name]
        for name in ("Color", "Rotation", "Normal", "Tangent"):
            if name in said:
                node.inputs[name].default_value = said[name]

    renew(tree, node, metal_tree.new_tree(_initial_color()), fill)


# By bl_idname: is a node old, and what makes it new.
UPDATES = {METAL: (is_old, _update_node)}

# By bl_idname: all that keyframes may change of a node whose `follow` carries it over.
FOLLOWED = {METAL: lambda node: (settings(node), node.grain, node.uv_map, node.bump_response,
                             getattr(node, "strokes", 0.0))}
_followed = {}  # by tree and node: what its properties last said


@persistent
def _follow_animation(_scene, depsgraph=None):
    """Properties that keyframes or drivers set run no updates of their own."""
    if depsgraph is None:
        return
    for owner in (*bpy.data.materials, *bpy.data.node_groups):
        tree = getattr(owner, "node_tree", owner)
        if not tree or not tree.animation_data:
            continue
        for node in tree.nodes:  # of linked materials too: what is inside them is as it is while this file is open
            if node.bl_idname in FOLLOWED:
                evaluated = owner.evaluated_get(depsgraph)
                animated = getattr(evaluated, "node_tree", evaluated).nodes.get(node.name)
                said = animated and FOLLOWED[node.bl_idname](animated)
                if animated and _followed.get((owner.name_full, node.name)) != said:
                    _followed[owner.name_full, node.name] = said
                    node.follow(animated)


@persistent
def _follow_drivers(scene, depsgraph=None):
    """What they read may change without the frame."""
    if depsgraph and (depsgraph.id_type_updated("NODETREE") or depsgraph.id_type_updated("MATERIAL")):
        _follow_animation(scene, depsgraph)


@persistent
def _forget_followed(*_arguments):
    """Another file, or what was undone, may have older insides."""
    _followed.clear()


_HANDLERS = (("frame_change_post", _follow_animation), ("depsgraph_update_post", _follow_drivers),
             *((name, _forget_followed) for name in ("load_pre", "undo_pre", "redo_pre")))


def _replace_by_group(tree, node):
    """Put a Group node with the same tree, values and links in a Libshade node's place."""
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = node.node_tree
    unhide(group.node_tree)
    group.label, group.parent = node.label or node.draw_label(), node.parent
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


class LIBSHADE_OT_convert_to_group(TellsOfNothing, bpy.types.Operator):
    """Replace Libshade nodes by plain groups of Cycles' own shaders, for files that must \
render without this add-on, where Cycles would show black. Settings that those shaders lack are lost"""

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
            return self.nothing("No Libshade node here to convert")
        for tree, node in nodes:
            _replace_by_group(tree, node)
        self.report({"INFO"}, f"Converted {len(nodes)} Libshade node(s)")
        return {"FINISHED"}


def _draw_add_menu(self, context):
    if context.space_data.tree_type == "ShaderNodeTree":
        self.layout.separator()
        add_button(self.layout, METAL, LibshadeMetalNode.bl_label)


class NODE_PT_libshade_advanced(NodePanel, bpy.types.Panel):
    bl_label, kind = "Advanced", METAL

    def draw(self, context):
        layout = self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.context_pointer_set("node", context.active_node)
        context.active_node.draw_advanced(layout)


_CLASSES = (LIBSHADE_OT_metal_preset, LIBSHADE_OT_measured_metal, LIBSHADE_OT_update_nodes, LIBSHADE_OT_convert_to_group,
            NODE_PT_libshade_advanced)


def register():
    register_node(LibshadeMetalNode)
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.NODE_MT_add.append(_draw_add_menu)
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in _HANDLERS:
        listed = getattr(bpy.app.handlers, name)
        if handler in listed:  # scripts of others may have cleared the list
            listed.remove(handler)
    _followed.clear()
    bpy.types.NODE_MT_add.remove(_draw_add_menu)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    drop_patterns()
    unregister_node(LibshadeMetalNode)
