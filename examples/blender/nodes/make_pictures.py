# SPDX-License-Identifier: Apache-2.0
"""Pictures of libshade's nodes in the shader editor, which needs a window: metal.png, fabric.png, groove.png,
scratches.png.

    BLENDER_USER_SCRIPTS=build/blender LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 1600x1100x24" \
        blender --factory-startup --window-geometry 0 0 1600 1100 --addons libshade \
        -P examples/blender/nodes/make_pictures.py -- FOLDER
"""
import os
import sys
import traceback

import bpy
import numpy as np

FOLDER = os.path.abspath(sys.argv[sys.argv.index("--") + 1])
RIM = 16  # pixels around the nodes


def node(tree, kind, x, y, linked=(), **settings):
    """linked: (name of the input, node, name of its output)"""
    made = tree.nodes.new(kind)
    made.location = x, y
    for name, value in settings.items():
        setattr(made, name, value)
    for socket, other, output in linked:
        tree.links.new(other.outputs[output], made.inputs[socket])
    return made


def bumped(tree, x, y):
    image = node(tree, "ShaderNodeTexImage", x - 300, y, image=bpy.data.images.get("bumps") or
                 bpy.data.images.new("bumps", 64, 64, is_data=True))
    return node(tree, "ShaderNodeNormalMap", x, y, [("Color", image, "Color")])


def metal(tree):
    made = node(tree, "LibshadeMetalNode", 0, 0, [("Normal", bumped(tree, -220, -230), "Normal")])
    made.inputs["Color"].default_value = (0.9, 0.62, 0.3, 1)
    node(tree, "ShaderNodeOutputMaterial", 280, 0, [("Surface", made, 0)])


def fabric(tree):
    made = node(tree, "LibshadeFabricNode", 0, 0, [("Normal", bumped(tree, -220, -100), "Normal")], preset="DENIM")
    node(tree, "ShaderNodeOutputMaterial", 260, 0, [("Surface", made, 0)])


def groove(tree):
    normal = bumped(tree, -500, -140)
    shader = node(tree, "ShaderNodeBsdfAnisotropic", 0, 0, [("Normal", normal, "Normal")])
    shader.inputs["Anisotropy"].default_value = 0.5  # from Blender 4.0 on it has no direction at first
    node(tree, "ShaderNodeOutputMaterial", 220, 0, [("Surface", shader, 0)])
    bpy.ops.libshade.follow_bumps()
    group = next(n for n in tree.nodes if n.type == "GROUP")
    group.location = -230, -60
    for other in tree.nodes:
        if other.type == "TANGENT":
            other.location = -500, 60


def scratches(tree):
    made = node(tree, "LibshadeScratchesNode", -280, 0)
    shader = node(tree, "LibshadeMetalNode", 0, 0, [("Normal", made, "Normal")])
    node(tree, "ShaderNodeOutputMaterial", 280, 0, [("Surface", shader, 0)])


def drawn(window):
    """At once, however busy the machine is."""
    with bpy.context.temp_override(window=window):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)


class Pictures:
    """One after another: each graph is drawn before it is taken."""

    def __init__(self):
        self.left, self.step = [metal, fabric, groove, scratches], 0

    def window(self):
        window = bpy.context.window_manager.windows[0]
        area = max(window.screen.areas, key=lambda a: a.width * a.height)
        return window, area, next(r for r in area.regions if r.type == "WINDOW")

    def show(self, make):
        window, area, _region = self.window()
        area.ui_type = "ShaderNodeTree"
        area.spaces.active.show_region_ui = area.spaces.active.show_region_toolbar = False
        area.spaces.active.overlay.show_context_path = False
        ob = bpy.context.view_layer.objects.active
        material = bpy.data.materials.new(make.__name__)
        material.use_nodes = True
        material.node_tree.nodes.clear()
        ob.data.materials.clear()
        ob.data.materials.append(material)
        with bpy.context.temp_override(window=window, area=area):
            make(material.node_tree)
        for each in material.node_tree.nodes:
            each.select = False

    def focus(self):
        window, area, region = self.window()
        window.cursor_warp(window.width - 4, 4)  # nothing is under it
        drawn(window)  # how high nodes are is known once they were
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.node.view_all()
        drawn(window)

    def take(self, make):
        """The part of the editor that is not its background."""
        window, area, region = self.window()
        path = os.path.join(FOLDER, make.__name__ + ".png")
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.screen.screenshot_area(filepath=path)
        image = bpy.data.images.load(path)
        width, height = image.size
        pixels = np.array(image.pixels[:], np.float32).reshape(height, width, -1)
        nodes = (np.abs(pixels[..., :3] - pixels[60, 12, :3]) > 0.08).any(-1)
        nodes[-34:] = False  # the header
        nodes[:20] = False  # a scroll bar
        nodes[:, -20:] = False
        rows, columns = (np.flatnonzero(nodes.sum(axis) > 12) for axis in (1, 0))
        low, high = max(rows[0] - RIM, 0), rows[-1] + RIM
        left, right = max(columns[0] - RIM, 0), columns[-1] + RIM
        cut = pixels[low:high, left:right]
        made = bpy.data.images.new(make.__name__, cut.shape[1], cut.shape[0])
        made.pixels.foreach_set(cut.ravel())
        made.filepath_raw, made.file_format = path, "PNG"
        made.save()

    def __call__(self):
        try:
            make = self.left[0]
            (lambda: self.show(make), self.focus, lambda: None, lambda: self.take(make))[self.step]()
        except Exception:
            traceback.print_exc()
            os._exit(1)
        self.step = (self.step + 1) % 4
        if not self.step:
            self.left.pop(0)
        if not self.left:
            bpy.ops.wm.quit_blender()
            return None
        return 0.7


bpy.context.preferences.view.show_splash = bpy.context.preferences.view.show_tooltips = False
bpy.context.preferences.view.smooth_view = 0
bpy.context.scene.render.engine = "LIBSHADE"
os.makedirs(FOLDER, exist_ok=True)
bpy.app.timers.register(Pictures(), first_interval=1.5)
