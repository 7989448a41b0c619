# SPDX-License-Identifier: GPL-3.0-or-later
"""Something for metal to reflect, where a scene has one lamp and a dim world: a sky of Blender's own studio, packed into the file."""

import os

import bpy

from . import versions

_SKY = "studio.exr"
_DIM = 0.2  # radiance


def _path():
    """Of Blender's own skies the one that looks like a studio; "" without it."""
    folders = [os.path.dirname(light.path) for light in bpy.context.preferences.studio_lights
               if light.type == "WORLD" and not light.is_user_defined]
    folders.append(os.path.join(bpy.utils.system_resource("DATAFILES"), "studiolights", "world"))
    return next((path for path in (os.path.join(folder, _SKY) for folder in folders) if os.path.isfile(path)), "")


def is_bare(scene):
    """Has metal nothing to reflect but one lamp at most, and an even world that is dim?"""
    return sum(ob.type == "LIGHT" for ob in scene.objects) <= 1 and _is_dim(scene.world)


def _is_dim(world):
    if not world:
        return True
    if not (versions.ALWAYS_NODES or world.use_nodes) or not world.node_tree:
        return max(world.color) < _DIM
    shines = [node for node in world.node_tree.nodes if node.bl_idname == "ShaderNodeBackground"]
    if any(socket.is_linked for node in shines for socket in node.inputs):
        return False
    return all(max(node.inputs["Color"].default_value[:3]) * node.inputs["Strength"].default_value < _DIM for node in shines)


class LIBSHADE_OT_add_studio_light(bpy.types.Operator):
    """Light the scene with one of Blender's own studio skies, which is packed into the file: metal has something to reflect then.
The world that was there stays in the file"""

    bl_idname = "libshade.add_studio_light"
    bl_label = "Add Studio Light"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        path = _path()
        if not path:
            self.report({"ERROR"}, f"This Blender has no {_SKY} among its studio lights")
            return {"CANCELLED"}
        image = bpy.data.images.load(path)
        image.pack()
        world = bpy.data.worlds.new("Studio Light")
        if not versions.ALWAYS_NODES:
            world.use_nodes = True
        tree = world.node_tree
        tree.nodes.clear()
        sky, shines, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Background", "OutputWorld"))
        for k, node in enumerate((sky, shines, output)):
            node.location = 300 * k, 0
        sky.image = image
        tree.links.new(sky.outputs["Color"], shines.inputs["Color"])
        tree.links.new(shines.outputs["Background"], output.inputs["Surface"])
        context.scene.world = world
        return {"FINISHED"}


def register():
    bpy.utils.register_class(LIBSHADE_OT_add_studio_light)


def unregister():
    bpy.utils.unregister_class(LIBSHADE_OT_add_studio_light)
