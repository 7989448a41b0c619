# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of a scene that is shown and rendered in between, without a window: is each picture that of a scene which was made
so before anything was read of it?

redraw.py FOLDER. Prints for each "EDIT name view|render", what it changes of the picture and what is wrong with that then, as
parts of the mean; "DONE".
"""

import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common
import windowless

folder, = common.arguments()
WIDTH, HEIGHT = 32, 24


def bumps(seed):
    """Pixels of a normal map, none of them steep."""
    texels = np.random.default_rng(seed).random((64, 4), np.float32)
    texels[:, 2] = 0.8 + 0.2 * texels[:, 2]
    return texels.ravel()


def build():
    """A bumped ball of metal on a plate whose shape has a key, under a sun, a lamp and a grey world."""
    for update in [one for one in bpy.app.handlers.depsgraph_update_post if getattr(one, "__self__", None).__class__ is Pictures]:
        bpy.app.handlers.depsgraph_update_post.remove(update)
    scene = common.empty_scene(WIDTH, HEIGHT, 4)
    scene.libshade.preview_samples, scene.libshade.max_bounces = 4, 2
    scene.libshade.use_preview_denoising = False  # or the pixels beside one that is elsewhere were, too
    picture = bpy.data.images.new("picture", 8, 8, float_buffer=True, is_data=True)
    picture.pixels.foreach_set(bumps(1))
    steel, tree, node = common.metal("steel", ex=40, ey=8)
    common.normal_map(tree, node, picture, 0.4)
    matt = bpy.data.materials.new("matt")
    common.tree_of(matt)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, location=(0, 0, 0.6))
    common.added(steel).name = "ball"
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=6)
    plate = common.added(matt)
    plate.name = "plate"
    plate.shape_key_add(name="basis")
    bent = plate.shape_key_add(name="bent")
    bent.value = 0  # 1 in 5.0
    for k, point in enumerate(bent.data):
        point.co.z += 0.4 * (k % 3)
    common.camera(scene, (0, -4, 3), (0.95, 0, 0))
    common.light(scene, rotation=(0.5, 0.3, 0))
    common.light(scene, "POINT", 100.0, 0.1, location=(1.5, -1, 2))
    scene.world = bpy.data.worlds.new("world")
    common.tree_of(scene.world)
    return scene


class Pictures:
    """Of the scene that is open."""

    def __init__(self, scene):
        self._scene, self._view = scene, windowless.View(WIDTH, HEIGHT)
        bpy.app.handlers.depsgraph_update_post.append(self._update)

    def _update(self, _scene, depsgraph):
        self._view.changed(depsgraph)

    def of_view(self, wanted=""):
        """wanted: what the header has to say, None: anything."""
        graph = bpy.context.evaluated_depsgraph_get()
        camera = self._scene.camera.evaluated_get(graph)
        window = camera.calc_matrix_camera(graph, x=WIDTH, y=HEIGHT)
        pixels, self.said = self._view.picture(camera.matrix_world.inverted(), window, True, graph)
        assert self.said == wanted or wanted is None, self.said
        return pixels

    def of_render(self):
        path = os.path.join(folder, "picture.exr")
        common.render(path)
        image = bpy.data.images.load(path)
        pixels = np.array(image.pixels[:], np.float32).reshape(HEIGHT, WIDTH, -1)
        bpy.data.images.remove(image)
        return pixels


def mesh(name):
    return bpy.data.objects[name].data


def node():
    return bpy.data.materials["steel"].node_tree.nodes["Libshade Metal"]


def move_camera(scene):
    scene.camera.location.x += 0.5


def zoom_camera(scene):
    scene.camera.data.lens = 70


def brighten_lamp(_scene):
    bpy.data.lights["point"].energy *= 3


def move_lamp(_scene):
    bpy.data.objects["point"].location.x = -1.5


def turn_sun(_scene):
    bpy.data.objects["sun"].rotation_euler.x = -0.6


def light_world(scene):
    common.tree_of(scene.world).nodes["Background"].inputs["Color"].default_value = (0.4, 0.1, 0.1, 1)


def move_object(_scene):
    bpy.data.objects["ball"].location.z += 0.4


def scale_object(_scene):
    bpy.data.objects["ball"].scale.x = 1.5


def other_material(_scene):
    bpy.data.objects["ball"].material_slots[0].material = bpy.data.materials["matt"]


def slide(_scene):
    node().inputs["Color"].default_value = (0.9, 0.3, 0.1, 1)


def set_property(_scene):
    node().distribution = "BECKMANN"


def unlink(_scene):
    tree = node().id_data
    tree.links.remove(node().inputs["Normal"].links[0])


def relink(_scene):
    tree = node().id_data
    tree.links.new(tree.nodes["Normal Map"].outputs[0], node().inputs["Normal"])


def link_emission(_scene):
    tree = bpy.data.materials["matt"].node_tree
    shines = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shines.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def paint(_scene):
    picture = bpy.data.images["picture"]
    picture.pixels.foreach_set(bumps(2))
    picture.update()


def move_vertices(_scene):
    for point in mesh("ball").vertices:
        point.co.x *= 0.5
    mesh("ball").update()


def more_faces(_scene):
    mesh("ball").clear_geometry()
    mesh("ball").from_pydata([(-1, 0, 0), (1, 0, 0), (0, 0, 2)], [], [(0, 1, 2)])
    mesh("ball").uv_layers.new(name="UVMap")
    mesh("ball").update()


def turn_uvs(_scene):
    layer = mesh("ball").uv_layers[0]
    for corner in layer.data:
        corner.uv = corner.uv.yx
    mesh("ball").update()


def smooth(_scene):
    common.smooth(mesh("ball"))


def bend(_scene):
    mesh("plate").shape_keys.key_blocks["bent"].value = 1


def modify(_scene):
    # not of subdivision, whose last bits in 5.0 are others each time
    bpy.data.objects["ball"].modifiers.new("thick", "SOLIDIFY").thickness = -0.2


def add_object(scene):
    common.link(scene, "more", mesh("ball"), (1.5, 0, 1))


def remove_object(_scene):
    bpy.data.objects.remove(bpy.data.objects["more"])


def hide(_scene):
    bpy.data.objects["ball"].hide_viewport = bpy.data.objects["ball"].hide_render = True


def play(scene):
    ball = bpy.data.objects["ball"]
    ball.keyframe_insert("location", frame=1)
    ball.location.x = 1
    ball.keyframe_insert("location", frame=5)
    scene.frame_set(5)


def fewer_bounces(scene):
    scene.libshade.max_bounces = 0


# One after another, in one scene; those last that leave little to see of others
EDITS = (move_camera, zoom_camera, brighten_lamp, move_lamp, turn_sun, light_world, slide, set_property, paint, unlink, relink, turn_uvs,
         smooth, modify, move_vertices, move_object, scale_object, bend, add_object, remove_object, play, fewer_bounces, other_material, more_faces, hide,
         link_emission)


def shown(pictures):
    return pictures.of_view(), pictures.of_render()


def difference(a, b, but=0):
    """but: for so many pixels, those furthest off. Blender 5.0's smooth normals differ in their last bits from one evaluation to the
    next, which may send a path of one pixel elsewhere."""
    off = np.sort(np.abs(a - b).reshape(-1, a.shape[-1]).mean(-1))
    return off[:len(off) - but].sum() / off.size / np.abs(b).mean()


shown_scene = build()
live = Pictures(shown_scene)
seen = [shown(live)]
for edit in EDITS:
    edit(shown_scene)
    seen.append(shown(live))
for k, edit in enumerate(EDITS):
    scene = build()
    for made in EDITS[:k + 1]:
        made(scene)
    for name, before, after, fresh in zip(("view", "render"), seen[k], seen[k + 1], shown(Pictures(scene))):
        print("EDIT", edit.__name__, name, f"{difference(after, before):.5f} {difference(after, fresh, 1):.7f}", flush=True)


def unread(pictures, scene):
    """What goes wrong in reading it: the picture before stays, and the header says so in one line."""
    viewport, report = (sys.modules[f"{common.MODULE}.{name}"] for name in ("viewport", "report"))
    before, read = pictures.of_view(), viewport.export.read

    def fails(*_arguments, **_more):
        raise KeyError("inner")
    viewport.export.read = fails
    try:
        light_world(scene)
        bpy.context.view_layer.update()
        after, said = pictures.of_view(None), pictures.said
    finally:
        viewport.export.read = read
    assert "internal error" in said and "'inner'" in said and "\n" not in said, said
    assert np.array_equal(before, after) and "in fails" in report.whole(scene)
    light_world(scene)
    scene.libshade.max_bounces = 1
    bpy.context.view_layer.update()
    assert difference(pictures.of_view(), before) > 5e-3


last = build()
unread(Pictures(last), last)
print("DONE")
common.finish()
