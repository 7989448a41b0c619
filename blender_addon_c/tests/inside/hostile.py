# SPDX-License-Identifier: GPL-3.0-or-later
"""Awkward scenes by chance, each rendered tiny. arguments: FOLDER FIRST COUNT

For each seed: a line "SEED n", all that Blender prints, and "END finished|error|broken why". A seed
that takes too long ends the process with Python's stack.
"""

import faulthandler
import importlib
import math
import os
import random
import re
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

SECONDS = 40  # that a seed may take; most take a twentieth of one

_ODD = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-38, 1e-12, 1e-6, 1e6, 1e18, 1e30, 3e38,
        math.nan, math.inf, -math.inf)
# Properties that make a scene long, not awkward, that are none of the engine's, or that Blender itself
# falls over: another type of a light or socket, a mesh drawn as an empty's image.
_LEFT_ALONE = re.compile("name|rna_type|samples|resolution|use_nodes|script|filepath|bytecode|"
                         "compression|subsurf|^type$|^bl_|^empty_|time_limit|preview|show_|select|"
                         "location$|width$|height$|use_auto_update|label")


class Chance(random.Random):
    """What is drawn."""

    def one_in(self, n):
        return self.randrange(n) == 0

    def number(self):
        return self.choice(_ODD) if self.one_in(3) else self.uniform(-2.0, 4.0)

    def numbers(self, count):
        return [self.number() for _ in range(count)]

    def disturb(self, owner, one_in=3):
        """Some of the owner's properties become others."""
        for p in owner.bl_rna.properties:
            if not p.is_readonly and not _LEFT_ALONE.search(p.identifier) and self.one_in(one_in):
                try:
                    setattr(owner, p.identifier, self._another(p))
                except (TypeError, ValueError, AttributeError, OverflowError):
                    pass

    def _another(self, p):
        if p.type == "FLOAT":
            return self.numbers(p.array_length) if p.is_array else self.number()
        if p.type == "INT":
            return self.choice([0, 1, 2, 7, 100, 1024])
        if p.type == "BOOLEAN":
            return [self.one_in(2)] * p.array_length if p.is_array else self.one_in(2)
        if p.type == "ENUM" and not p.is_enum_flag:
            return self.choice(list(p.enum_items.keys()) or [""])
        raise TypeError


# ---- graphs

NODES = sorted(name for name in dir(bpy.types) if name.startswith("ShaderNode") and
               name not in {"ShaderNode", "ShaderNodeTree", "ShaderNodeCustomGroup"})
USUAL = ["LibshadeMetalNode"] * 3 + [
    "ShaderNodeBsdfPrincipled", "ShaderNodeBsdfGlass", "ShaderNodeBsdfDiffuse",
    "ShaderNodeBsdfTransparent", "ShaderNodeEmission", "ShaderNodeMixShader", "ShaderNodeAddShader",
    "ShaderNodeMath", "ShaderNodeVectorMath", "ShaderNodeMixRGB", "ShaderNodeMapping",
    "ShaderNodeTexImage", "ShaderNodeTexCoord", "ShaderNodeNormalMap", "ShaderNodeBump",
    "ShaderNodeValToRGB", "ShaderNodeUVMap", "ShaderNodeRGBCurve", "ShaderNodeMapRange",
    "ShaderNodeVectorTransform", "ShaderNodeLightPath", "ShaderNodeDisplacement", "ShaderNodeVectorRotate", "ShaderNodeTexEnvironment", "NodeReroute"]


def bend(chance, mapping):
    """Points of curves, some of them in one place."""
    for curve in mapping.curves:
        for _ in range(chance.randrange(4)):
            curve.points.new(*(chance.choice((-1e6, -1.0, 0.0, 0.5, 1.0, 1e6)) for _ in range(2)))
        for point in curve.points:
            point.handle_type = chance.choice(["AUTO", "VECTOR", "AUTO_CLAMPED"])
    mapping.use_clip, mapping.extend = chance.one_in(2), chance.choice(["HORIZONTAL", "EXTRAPOLATED"])
    mapping.update()


def node(chance, tree, images):
    """One more, of a kind that this tree takes; None where Blender refuses."""
    try:
        made = tree.nodes.new(chance.choice(NODES if chance.one_in(2) else USUAL))
    except RuntimeError:
        return None
    chance.disturb(made)
    if hasattr(made, "image") and not chance.one_in(4):
        made.image = chance.choice(images)
    if hasattr(made, "uv_map"):
        made.uv_map = chance.choice(["", "UVMap", "elsewhere"])
    if hasattr(made, "attribute_name"):
        made.attribute_name = chance.choice(["", "odd", "UVMap", "color", "location", "data", "[0]", "nowhere", "frame_current"])
    if hasattr(made, "object") and bpy.data.objects:
        made.object = chance.choice(list(bpy.data.objects))
    if hasattr(made, "mapping"):
        bend(chance, made.mapping)
    for socket in made.inputs:
        if chance.one_in(3):
            disturb_value(chance, socket)
    made.mute = chance.one_in(8)
    return made


def disturb_value(chance, socket):
    """Its value alone: a socket of another type is one that Blender itself falls over."""
    value = getattr(socket, "default_value", "")
    if isinstance(value, float):
        socket.default_value = chance.number()
    elif hasattr(value, "__len__") and not isinstance(value, str):
        socket.default_value = chance.numbers(len(value))


def connect(chance, tree, count):
    nodes = list(tree.nodes)
    for _ in range(count):
        source, target = chance.choice(nodes), chance.choice(nodes)
        if "REROUTE" in (source.type, target.type) and nodes.index(source) >= nodes.index(target):
            continue  # Blender 5.0 itself goes round such a circle for ever
        if source.outputs and target.inputs:
            output, socket = chance.choice(list(source.outputs)), chance.choice(list(target.inputs))
            link = tree.links.new(output, socket, verify_limits=not chance.one_in(4))
            if link and chance.one_in(10):
                link.is_muted = True


def chain(chance, tree, feeds):
    """Many nodes, each of which feeds the next."""
    kind = chance.choice(["NodeReroute", "ShaderNodeMath", "ShaderNodeGamma", "ShaderNodeInvert",
                          "ShaderNodeMixShader", "ShaderNodeAddShader", "ShaderNodeHueSaturation",
                          "ShaderNodeMixRGB", "ShaderNodeBump"])
    for _ in range(chance.choice([3, 30, 250])):
        link = tree.nodes.new(kind)
        tree.links.new(link.outputs[0], feeds)
        fit = [s for s in link.inputs if s.type == link.outputs[0].type] or list(link.inputs)
        feeds = chance.choice(fit)
    return feeds


def group(chance, images, depth):
    """A node tree with an inside of its own, which may be of groups."""
    tree = bpy.data.node_groups.new("group", "ShaderNodeTree")
    tree.nodes.new("NodeGroupInput")
    tree.nodes.new("NodeGroupOutput")
    for into in ("INPUT", "OUTPUT"):
        for kind in ("Float", "Color", "Shader", "Vector"):
            if chance.one_in(2):
                if bpy.app.version < (4, 0):
                    sockets = tree.inputs if into == "INPUT" else tree.outputs
                    sockets.new("NodeSocket" + kind, kind)
                else:
                    tree.interface.new_socket(kind, in_out=into, socket_type="NodeSocket" + kind)
    fill(chance, tree, images, depth - 1)
    return tree


def fill(chance, tree, images, depth=3):
    """Nodes of all kinds, linked as chance will have it."""
    for _ in range(chance.choice([0, 1, 3, 10, 25])):
        node(chance, tree, images)
    while depth > 0 and chance.one_in(3):
        inner = tree.nodes.new("ShaderNodeGroup")
        inner.node_tree = chance.choice([None, group(chance, images, depth)])
    outputs = [n for n in tree.nodes if "OUTPUT" in n.type and n.inputs]
    fed = [s for n in tree.nodes for s in n.inputs]
    if fed and chance.one_in(3):
        chain(chance, tree, chance.choice(fed))
    if len(tree.nodes) > 1:
        connect(chance, tree, 2 * min(len(tree.nodes), 40))
        for out in outputs:  # most graphs shall be seen
            shaders = [s for n in tree.nodes for s in n.outputs if s.type == "SHADER"]
            for socket in out.inputs:
                if socket.type == "SHADER" and shaders and not chance.one_in(4):
                    tree.links.new(chance.choice(shaders), socket)
    if chance.one_in(8) and len(tree.nodes):
        tree.nodes.remove(chance.choice(list(tree.nodes)))


def pictures(chance, folder):
    """Images, most of them good for nothing."""
    whole = bpy.data.images.new("whole", 4, 2, float_buffer=True, is_data=chance.one_in(2))
    whole.pixels.foreach_set(np.array([chance.number() for _ in range(32)], np.float32))
    gone = bpy.data.images.new("gone", 4, 4)
    gone.source, gone.filepath = "FILE", os.path.join(folder, "nowhere.png")
    broken = bpy.data.images.new("broken", 4, 4)
    with open(os.path.join(folder, "broken.exr"), "wb") as file:
        file.write(b"v/1\x01" + bytes(chance.randrange(256) for _ in range(60)))
    broken.source, broken.filepath = "FILE", file.name
    bare = bpy.data.images.new("bare", 4, 4)
    bare.source = chance.choice(["FILE", "MOVIE", "SEQUENCE", "TILED", "GENERATED"])
    tiny = bpy.data.images.new("tiny", 1, 1)
    chance.disturb(tiny.colorspace_settings, 1)
    return [None, whole, gone, broken, bare, tiny, whole, tiny]


def material(chance, images):
    made = bpy.data.materials.new("material")
    if chance.one_in(6):
        return made
    tree = common.tree_of(made)
    chance.disturb(made)
    if chance.one_in(4):
        tree.nodes.clear()
    fill(chance, tree, images)
    return made


# ---- what there is


def mesh(chance):
    """Faces of vertices that may be anywhere."""
    made = bpy.data.meshes.new("mesh")
    kind = chance.randrange(4)
    if kind == 0:  # a height field, with a fault or two
        side = chance.choice([2, 5, 20])
        at = [(2 * x / (side - 1) - 1, 2 * y / (side - 1) - 1, 0.2 * math.sin(7 * x * y))
              for y in range(side) for x in range(side)]
        for _ in range(chance.randrange(4)):
            at[chance.randrange(len(at))] = tuple(chance.numbers(3))
        faces = [(k, k + 1, k + side + 1, k + side) for k in range(side * (side - 1))
                 if (k + 1) % side]
    else:  # one on the other, in one place, in a line, or anywhere
        count = chance.choice([3, 4, 12, 40])
        at = [((0, 0, 0) if kind == 1 else (k, 0, 0) if kind == 2 else tuple(chance.numbers(3)))
              for k in range(count)]
        faces = [chance.sample(range(count), chance.randint(3, min(count, 6)))
                 for _ in range(chance.choice([0, 1, 10, 60]))]
    made.from_pydata(at, [], faces)
    if chance.one_in(2):
        common.smooth(made)
    for name in ["UVMap", "other"][:chance.randrange(3)]:
        layer = made.uv_layers.new(name=name)
        if layer:
            made.uv_layers[name].data.foreach_set(
                "uv", np.array(chance.numbers(2 * len(made.loops)), np.float32))
    if faces and chance.one_in(3):
        made.normals_split_custom_set([tuple(chance.numbers(3)) for _ in made.loops])
    if faces and chance.one_in(3):
        made.polygons.foreach_set("material_index",
                                  [chance.choice([0, 1, 5, 999, 32767]) for _ in made.polygons])
    return made


def place(chance, ob):
    """Near the middle, or where nothing can be."""
    ob.location = [chance.gauss(0, 1) for _ in range(3)]
    ob.rotation_euler = [chance.gauss(0, 2) for _ in range(3)]
    if chance.one_in(4):
        ob.scale = chance.choice([(0, 0, 0), (-1, 1, 1), (1, 0, 1), (1e30,) * 3, (1e-30,) * 3,
                                  (math.nan, 1, 1), tuple(chance.numbers(3))])
    if chance.one_in(12):
        ob.location = chance.numbers(3)
    if chance.one_in(12):
        ob.rotation_euler = chance.numbers(3)


def objects(chance, scene, images):
    materials = [material(chance, images) for _ in range(chance.choice([0, 1, 4]))]
    meshes = [mesh(chance) for _ in range(chance.choice([1, 2]))]
    for made in meshes:
        count = chance.choice([0, 1, 2, 3]) if not chance.one_in(12) else 3000
        for _ in range(count):
            made.materials.append(chance.choice([None, *materials]))
    for _ in range(chance.choice([0, 1, 3, 30])):
        ob = common.link(scene, "object", chance.choice(meshes))
        if chance.one_in(3):
            ob["odd"] = chance.choice([7, "12", 1e300, chance.numbers(1)[0], chance.numbers(3), chance.numbers(9), {"a": 1}, True])
        place(chance, ob)
        if chance.one_in(3) and ob.material_slots:
            slot = chance.choice(list(ob.material_slots))
            slot.link, slot.material = "OBJECT", chance.choice([None, *materials])
        chance.disturb(ob, 12)
    if chance.one_in(4):
        bpy.ops.object.text_add()
        bpy.ops.object.metaball_add(radius=chance.uniform(0.5, 2))
        bpy.ops.curve.primitive_bezier_circle_add()
        bpy.context.view_layer.objects.active.data.bevel_depth = chance.choice([0, 0.1, math.nan])
    if chance.one_in(4):  # thousands, by the faces of another
        parent = common.link(scene, "parent", chance.choice(meshes))
        parent.instance_type = chance.choice(["FACES", "VERTS"])
        parent.use_instance_faces_scale = True
        common.link(scene, "child", chance.choice(meshes)).parent = parent
    if chance.one_in(4):
        ob = common.link(scene, "modified", chance.choice(meshes))
        ob.modifiers.new("solidify", "SOLIDIFY").thickness = chance.number()
        ob.modifiers.new("array", "ARRAY").count = chance.choice([0, 1, 9])
        ob.modifiers.new("boolean", "BOOLEAN").object = None


def lights(chance, scene, images):
    for _ in range(chance.choice([0, 1, 1, 2, 6, 40])):
        data = bpy.data.lights.new("light", chance.choice(["SUN", "POINT", "SPOT", "AREA"]))
        data.energy = chance.uniform(0, 100)
        chance.disturb(data, chance.choice([2, 10]))
        if getattr(data, "cycles", None):
            chance.disturb(data.cycles, 8)
        if chance.one_in(4):
            data.use_nodes = True
            fill(chance, data.node_tree, images, 1)
        place(chance, common.link(scene, "light", data))


def world(chance, scene, images):
    if chance.one_in(3):
        return
    scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(scene.world)
    chance.disturb(scene.world)
    if chance.one_in(2):
        texture = tree.nodes.new(chance.choice(["ShaderNodeTexEnvironment", "ShaderNodeTexSky"]))
        if hasattr(texture, "image"):
            texture.image = chance.choice(images)
        chance.disturb(texture)
        tree.links.new(texture.outputs[0], tree.nodes["Background"].inputs["Color"])
        disturb_value(chance, tree.nodes["Background"].inputs["Strength"])
    if chance.one_in(3):
        fill(chance, tree, images)


def seen_by(chance, scene):
    if chance.one_in(15):
        return
    ob = common.camera(scene, chance.choice([(0, 0, 4), (0, 0, 0), (0, 0, 1e-6), (0, 0, 1e12)]))
    ob.data.dof.use_dof = chance.one_in(3)
    if chance.one_in(3):
        chance.disturb(ob.data)
        chance.disturb(ob.data.dof)
    ob.data.type = chance.choice(["PERSP"] * 8 + ["ORTHO"] * 3 + ["PANO"])
    if ob.data.type == "PANO":
        chance.disturb(ob.data if hasattr(ob.data, "panorama_type") else ob.data.cycles)
    if chance.one_in(6):
        place(chance, ob)
    if chance.one_in(8):
        ob.data.dof.focus_object = ob


def moving(chance, scene):
    """Things are elsewhere, and other ones, while the shutter is open."""
    render = scene.render
    render.use_motion_blur, render.motion_blur_shutter = True, chance.choice([0.5, 1, 0.01, 100])
    for ob in scene.objects:
        if chance.one_in(2):
            for frame in (1, 2):
                for path in ("location", "rotation_euler", "scale"):
                    ob.keyframe_insert(path, frame=frame)
                place(chance, ob)
        if chance.one_in(3) and ob.type == "MESH" and ob.data.vertices:
            modifier = ob.modifiers.new("moves", chance.choice(["WAVE", "BUILD", "ARRAY", "CAST"]))
            for name in ("time_offset", "frame_start", "factor", "count"):
                if hasattr(modifier, name):
                    setattr(modifier, name, int(chance.gauss(0, 3)))
        chance.disturb(ob.cycles)
        ob.cycles.motion_steps = chance.choice([1, 1, 2, 5])


def settings(chance, scene):
    render, ours, layer = scene.render, scene.libshade, bpy.context.view_layer
    chance.disturb(ours)
    ours.samples = chance.randint(1, 4)
    ours.time_limit = chance.choice([0, 0, 1e-9])
    ours.use_denoising = chance.one_in(6)
    render.film_transparent = chance.one_in(2)
    render.use_border = chance.one_in(4)
    if render.use_border:
        a, b = sorted(chance.uniform(0, 1) for _ in range(2))
        render.border_min_x, render.border_max_x = (a, b) if chance.one_in(2) else (b, a)
        render.border_min_y = render.border_max_y * chance.choice([0, 1, 0.999])
    render.pixel_aspect_x = chance.choice([1, 1, 1, 200])
    render.threads_mode = chance.choice(["AUTO", "FIXED"])
    render.threads = chance.choice([1, 2, 64])
    render.use_multiview = chance.one_in(12)
    if chance.one_in(4):
        moving(chance, scene)
    for ob in scene.objects if chance.one_in(6) else ():
        ob.is_shadow_catcher, ob.is_holdout = chance.one_in(2), chance.one_in(4)
    if chance.one_in(3):
        for name in dir(layer):
            if name.startswith("use_pass_"):
                setattr(layer, name, chance.one_in(2))
    if chance.one_in(6):
        layer.material_override = chance.choice([None, *bpy.data.materials])
    if chance.one_in(12):
        chance.disturb(layer)
        layer.use = True  # else there is nothing to render
    if chance.one_in(8):
        scene.view_layers.new("other")
    if chance.one_in(12):
        for child in layer.layer_collection.children:
            child.exclude = True
        layer.layer_collection.collection.hide_render = True


def library_gone(chance, scene, folder):
    """What came from another file that is no longer there."""
    path = os.path.join(folder, "library.blend")
    used = {ob for ob in bpy.data.objects if ob.type == "MESH"}
    if not used:
        return
    bpy.data.libraries.write(path, used)
    with bpy.data.libraries.load(path, link=True) as (there, here):
        here.objects, here.materials = list(there.objects), list(there.materials)
    for ob in here.objects:
        scene.collection.objects.link(ob)
    os.remove(path)
    if chance.one_in(2):
        for library in bpy.data.libraries:
            try:
                library.reload()
            except RuntimeError:  # as it should say
                pass


def build(seed, folder):
    chance = Chance(seed)
    scene = common.empty_scene(*chance.choice([(16, 12)] * 6 + [(4, 4), (33, 5)]))
    images = pictures(chance, folder)
    objects(chance, scene, images)
    lights(chance, scene, images)
    world(chance, scene, images)
    seen_by(chance, scene)
    settings(chance, scene)
    if chance.one_in(8):
        library_gone(chance, scene, folder)
    if chance.one_in(4):
        common.write_multilayer(scene)
        scene.render.pixel_aspect_x = 1  # Blender 5.0 cannot write others


# ---- what came out

_wrong = []  # what this seed's picture has that no picture may have


def watch(engine):
    """Look at all numbers on their way into Blender's picture."""
    hand_over = engine._set_pixels

    def look(result, pixels, exposure=1.0, name="Combined", channels=4):
        if not np.isfinite(pixels).all():
            _wrong.append(f"{name} is not finite")
        hand_over(result, pixels, exposure, name, channels)
    engine._set_pixels = look


def outcome(folder):
    _wrong.clear()
    try:
        common.render(os.path.join(folder, "picture.exr"))
        ended = "finished"
    except RuntimeError as error:
        print(error)
        ended = "error"
        if "internal error" in str(error):
            _wrong.append("internal error")
        elif not re.search("libshade|camera|Image too small|No render layer", str(error)):
            _wrong.append(str(error))
    return "broken " + "; ".join(_wrong) if _wrong else ended


def main(folder, first, count, seconds=SECONDS):
    faulthandler.enable()
    common.enable()
    watch(importlib.import_module(common.MODULE + ".engine"))
    for seed in range(int(first), int(first) + int(count)):
        print("SEED", seed, flush=True)
        faulthandler.dump_traceback_later(float(seconds), exit=True)
        build(seed, folder)
        print("END", outcome(folder), flush=True)
        faulthandler.cancel_dump_traceback_later()
    common.finish()


if __name__ == "__main__":
    main(*common.arguments())
