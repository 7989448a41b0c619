# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist has open beside the viewport: libshade's nodes with all their panels, the Asset Browser, the preferences."""

import os

import bpy

import common

_WEAVES = os.path.join(os.path.dirname(__file__), *[".."] * 3, "examples", "weaves")


def _window():
    return bpy.context.window_manager.windows[0]


def _area(kind):
    return next((area for area in _window().screen.areas if area.type == kind), None)


class NODE_PT_all_of_it(bpy.types.Panel):
    """What the sidebar's panels draw of a node, closed ones too: nothing opens these but the mouse."""

    bl_label, bl_space_type, bl_region_type, bl_category = "All of it", "NODE_EDITOR", "UI", "Node"
    bl_order = -1

    def draw(self, context):
        node, layout = context.active_node, self.layout
        node.draw_buttons_ext(context, layout)
        for panel in bpy.types.Panel.__subclasses__() + [p for q in bpy.types.Panel.__subclasses__() for p in q.__subclasses__()]:
            if panel.__module__.startswith(common.MODULE) and getattr(panel, "bl_parent_id", "").startswith("NODE_PT"):
                if panel.poll(context):
                    layout.label(text=panel.bl_label)
                    column = layout.column()

                    class Shown:
                        layout = column
                        yarn = getattr(panel, "yarn", None)
                    panel.draw(Shown, context)


def show_node(name):
    """The shader editor in place of the timeline and most of the viewport, a node of ours active in it."""
    if not hasattr(bpy.types, NODE_PT_all_of_it.__name__):
        bpy.utils.register_class(NODE_PT_all_of_it)
    area = _area("NODE_EDITOR")
    if not area:
        view = _area("VIEW_3D")
        with bpy.context.temp_override(window=_window(), screen=_window().screen, area=view,
                                       region=next(r for r in view.regions if r.type == "WINDOW")):
            bpy.ops.screen.area_split(direction="VERTICAL", factor=0.4)
        area = max((a for a in _window().screen.areas if a.type == "VIEW_3D"), key=lambda a: a.x)
        area.ui_type = "ShaderNodeTree"
        area.spaces.active.show_region_ui = True
    tree = bpy.context.view_layer.objects.active.active_material.node_tree
    for node in tree.nodes:
        node.select = node.bl_idname == name
    tree.nodes.active = next(node for node in tree.nodes if node.bl_idname == name)
    area.tag_redraw()


def weave():
    """All objects are of cloth by a draft, through the operator that artists press."""
    made = bpy.data.materials.new("woven")
    tree = common.tree_of(made)
    tree.nodes.clear()
    node = tree.nodes.new("LibshadeFabricNode")
    node.size_mode, node.distance = "LENGTH", "FAR"
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for x, kind in ((-600, "LibshadeScratchesNode"), (-300, "LibshadeMetalNode")):
        tree.nodes.new(kind).location.x = x
    output.location.x = 300
    for ob in bpy.context.scene.objects:
        if ob.type == "MESH":
            ob.data.materials.clear()
            ob.data.materials.append(made)
            bpy.context.view_layer.objects.active = ob
    bpy.ops.libshade.import_wif(filepath=os.path.join(_WEAVES, "houndstooth.wif"), material=made.name, node=node.name)


def dye():
    """Only the Text is edited: every colour of its table becomes red."""
    text, lines, inside = next(t for t in bpy.data.texts if t.name.endswith(".wif")), [], False
    for line in text.as_string().splitlines():
        inside = line.strip().upper() == "[COLOR TABLE]" if line.startswith("[") else inside
        number = line.partition("=")[0]
        lines.append(f"{number}=255,0,0" if inside and number.strip().isdigit() else line)
    text.from_string("\n".join(lines))


def _scratches():
    tree = bpy.context.view_layer.objects.active.active_material.node_tree
    return next(node for node in tree.nodes if node.bl_idname == "LibshadeScratchesNode")


def press_bake():
    """The button on a node that is not the active one: its dialog waits for a key."""
    area = _area("NODE_EDITOR")
    with bpy.context.temp_override(window=_window(), screen=_window().screen, area=area, node=_scratches(),
                                   region=next(r for r in area.regions if r.type == "WINDOW")):
        bpy.ops.libshade.bake_scratches("INVOKE_DEFAULT", size="512", samples=1)


def look_at_bake():
    if _scratches().baked:
        print("baked by its dialog", flush=True)


def show_assets():
    bpy.ops.libshade.add_assets()
    area = _area("NODE_EDITOR")
    area.ui_type = "ASSETS"


def choose_assets():
    """Once the browser has been drawn."""
    _area("FILE_BROWSER").spaces.active.params.asset_library_ref = "Libshade"


def show_preferences():
    area = _area("FILE_BROWSER")
    area.ui_type = "PREFERENCES"
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "libshade"
    bpy.ops.preferences.addon_expand(module=common.MODULE)
