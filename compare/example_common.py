# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: make the scene of an example into what both renderers can show, and say what that left out.

    blender -b --factory-startup --addons libshade SCENE.blend --python-exit-code 9 -P example_common.py -- FOLDER

FOLDER gets common.blend, which export_povray.py writes whole, and left_out.json, a list of texts. What both cannot show
is changed for both: soft lamps become points, skies a plain colour and a sun, other shaders matt, bumps that no normal
map holds go. Nothing else is touched: metals, cloths, normal maps, meshes, camera are the example's own.
"""
import json
import os
import sys

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import example_scene  # noqa: E402
import whole  # noqa: E402
from libshade import metal_tree, nodes  # noqa: E402

METAL, FABRIC = "LibshadeMetalNode", "LibshadeFabricNode"
FACES = 60_000  # of a mesh; more are thinned out, as POV-Ray reads them as text
SUN = (1.0, (-0.4, -0.6, 0.8))  # in place of a sky: irradiance, from where


class LeftOut:
    """What was changed, and of what by name."""

    def __init__(self):
        self._said = {}

    def say(self, what, name=""):
        self._said.setdefault(what, []).append(name)

    def texts(self):
        """A text for each change, with the names of what it was made to, each once."""
        return [what + (": " + ", ".join(dict.fromkeys(names)) if names[0] else "") for what, names in self._said.items()]


def fed_by(socket):
    return socket.links[0].from_node if socket.is_linked else None


def unlink(tree, socket):
    for link in list(socket.links):
        tree.links.remove(link)


# ---- materials


def even_metal(tree):
    """A new node of ours, without the strokes that artists see first."""
    made = tree.nodes.new(METAL)
    made.strokes, made.grain, made.is_new, made.horizon = 0.0, "UV", False, "VALID_ESTEVEZ"
    return made


def matt(material, node, left):
    """Another shader: Lambert's law in its base colour."""
    tree = material.node_tree
    color = next((tuple(node.inputs[name].default_value) for name in ("Base Color", "Color") if node and name in node.inputs),
                 tuple(material.diffuse_color))
    made = even_metal(tree)
    made.fresnel, made.diffuse, made.kd = "NONE", "LAMBERT", color[:3]
    made.inputs["Color"].default_value = (0, 0, 0, 1)
    tree.links.new(made.outputs["BSDF"], tree.get_output_node("ALL").inputs["Surface"])
    left.say(f"matt in its base colour in place of {node.bl_label if node else 'no shader'}", material.name)


def metal(material, node, left):
    """Sockets' numbers become properties, which a dump has for the whole material."""
    tree = material.node_tree
    for name in ("Color", *nodes.SHAPE, *nodes.MATT_COLOR, *nodes.EDGE, "Rotation", "Tangent"):
        if name in node.inputs and node.inputs[name].is_linked:
            unlink(tree, node.inputs[name])
            left.say(f"what is linked to {name}", material.name)
    if node.strokes > 0:
        node.strokes = 0.0
        left.say("strokes of the node, which no block of POV-Ray's has", material.name)
    node.fresnel = nodes.fresnel_of(node)
    node.kd, node.f82 = (node.inputs[name].default_value[:3] for name in (*nodes.MATT_COLOR, *nodes.EDGE))
    alphas = nodes.lobe(node) if nodes.sockets_rule(node, nodes.SHAPE) else (node.ax, node.ay)
    if nodes.sockets_rule(node, nodes.SHAPE) or node.inputs["Rotation"].default_value % 0.5:
        if node.inputs["Rotation"].default_value % 1.0 in (0.25, 0.75):  # the same surface, without a turn
            alphas = alphas[::-1]
            node.inputs["Rotation"].default_value = 0.0
            left.say("a quarter turn of Rotation, for which the lobe's two widths trade places", material.name)
        node.ax, node.ay = alphas
    bumps(material, node, left)


def bumps(material, node, left):
    source = fed_by(node.inputs["Normal"])
    if source and source.bl_idname != "ShaderNodeNormalMap":
        unlink(material.node_tree, node.inputs["Normal"])
        left.say(f"{source.bl_label} nodes, which no block of POV-Ray's has", material.name)
    elif source and node.horizon == "MUTUAL":
        node.horizon = "VALID_ESTEVEZ"
        left.say("how bumps shade each other, by slopes that each renderer finds by itself", material.name)


def anisotropic(material, node, left):
    """Cycles' shader: our metal of the same lobe; behind Libshade Groove its strokes go with the bumps, else they stay."""
    tree, normal = material.node_tree, fed_by(node.inputs["Normal"])
    made = even_metal(tree)
    made.distribution, made.brdf, made.fresnel = "GGX", "MICROFACET", "NONE"
    made.inputs["Color"].default_value = node.inputs["Color"].default_value
    made.ax, made.ay = metal_tree.alphas_of(*(node.inputs[name].default_value for name in nodes.SHAPE))
    made.detail = "ROTATE" if normal and normal.type == "GROUP" else "GRAM_SCHMIDT"
    normal = fed_by(normal.inputs["Normal"]) if normal and normal.type == "GROUP" else normal
    if normal:
        tree.links.new(normal.outputs["Normal"], made.inputs["Normal"])
    tree.links.new(made.outputs["BSDF"], tree.get_output_node("ALL").inputs["Surface"])
    left.say("Libshade Metal in place of Cycles' Anisotropic BSDF", material.name)


def plain_cloth(material, node, left):
    for socket in node.inputs:
        if socket.is_linked:
            unlink(material.node_tree, socket)
            left.say(f"what is linked to {socket.name}", material.name)


KINDS = {METAL: metal, FABRIC: plain_cloth, "ShaderNodeBsdfAnisotropic": anisotropic}


def materials(left):
    for material in list(bpy.data.materials):
        output = material.node_tree.get_output_node("ALL") if material.use_nodes else None
        if not output:
            continue
        node = fed_by(output.inputs["Surface"])
        KINDS.get(node.bl_idname if node else "", matt)(material, node, left)


def images(folder):
    """Pictures that only the file has, as files."""
    for image in list(bpy.data.images):
        if image.packed_file and image.is_float:
            path = os.path.join(folder, f"{image.name}.exr")
            with whole.place(path) as part:
                part.write_bytes(image.packed_file.data)
            read = bpy.data.images.load(path)
            read.colorspace_settings.name = "Non-Color"
            image.user_remap(read)


# ---- meshes


def meshes(left):
    for item in bpy.data.objects:
        if item.type != "MESH":
            continue
        for modifier in list(item.modifiers):
            if modifier.type == "SUBSURF":
                fine = modifier.render_levels
                while fine > 0 and len(item.data.polygons) * 4**fine > FACES:
                    fine -= 1
                if fine < modifier.render_levels:
                    left.say(f"subdivided {fine} times in place of {modifier.render_levels}", item.name)
                modifier.levels = modifier.render_levels = fine
            elif modifier.type == "SOLIDIFY":
                item.modifiers.remove(modifier)
                left.say("the thickness of Solidify", item.name)
        if len(item.data.polygons) > FACES // 4 and not any(m.type == "SUBSURF" for m in item.modifiers):
            item.modifiers.new("thin", "DECIMATE").decimate_type = "UNSUBDIV"
            item.modifiers["thin"].iterations = 2
            left.say("meshes thinned out, to a quarter of their faces", item.name)
        if not item.data.uv_layers:
            project(item.data)
            left.say("a UV map from above where there was none", item.name)


def project(mesh):
    """A UV map by x + z and y + z."""
    at = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", at)
    of = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", of)
    at = at.reshape(-1, 3)[of]
    mesh.uv_layers.new().data.foreach_set("uv", (at[:, :2] + 0.37 * at[:, 2:]).ravel())


# ---- light


def lights(left):
    for item in bpy.data.objects:
        if item.type != "LIGHT":
            continue
        data = item.data
        if data.type in ("AREA", "SPOT"):
            energy, kind = data.energy, data.type
            data.type = "POINT"
            data = item.data
            data.energy = 4.0 * energy if kind == "AREA" else energy  # as bright straight below it
            left.say("sharp points in place of area lamps and spots", item.name)
        elif data.type == "SUN" and data.angle > 0 or data.type == "POINT" and data.shadow_soft_size > 0:
            left.say("soft lamps as sharp ones", item.name)
        if data.type == "SUN":
            data.angle = 0.0
        else:
            data.shadow_soft_size = 0.0


def world(scene, left):
    """A plain colour that the camera sees, and a sun in place of what shines."""
    own = scene.world
    if own is None or not own.use_nodes:
        return
    shaders = [node for node in own.node_tree.nodes if node.type == "BACKGROUND"]
    plain = next((node for node in shaders if not node.inputs["Color"].is_linked), None)
    color = [plain.inputs["Strength"].default_value * c for c in plain.inputs["Color"].default_value[:3]] if plain else (0, 0, 0)
    own.use_nodes = False
    own.color = color
    energy, towards = SUN
    data = bpy.data.lights.new("for the sky", "SUN")
    data.energy, data.angle = energy, 0.0
    item = bpy.data.objects.new("for the sky", data)
    item.rotation_euler = Vector(towards).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(item)
    left.say("a sun in place of the sky")


def main(folder):
    folder = os.path.abspath(folder)
    scene, left = bpy.context.scene, LeftOut()
    materials(left)
    images(folder)
    meshes(left)
    lights(left)
    world(scene, left)
    camera = scene.camera.data
    if camera.dof.use_dof:
        camera.dof.use_dof = False
        left.say("depth of field")
    scene.libshade.max_bounces = 0
    left.say("light that has met another surface")
    scene.render.engine = "LIBSHADE"
    example_scene.save(os.path.join(folder, "common.blend"))
    whole.write_text(os.path.join(folder, "left_out.json"), json.dumps(left.texts()))


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1:])
