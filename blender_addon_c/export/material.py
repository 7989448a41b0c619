# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: a closure and a graph of nodes. Whatever is linked and not understood is named."""

from .. import nodes
from . import tree
from .closure import CLOSURES, of_roughness
from .graph import Program, TooLarge
from .image import Images


class Table:
    """Materials and images of one render, each once."""

    def __init__(self, messages):
        self.materials, self.images = [], Images(messages)
        self._messages = messages
        self._indices = {}  # by material
        self._uv_maps = []  # by index, "" is the mesh's active one
        self._textured = []  # by index: does it look anything up there?

    def index(self, material, owner):
        """Index of a material; None is an empty slot of the object `owner`."""
        if material not in self._indices:
            if not material:
                self._messages.warning(f"object '{owner}': no material, rendered as grey metal")
            reader = Reader(self.images, self._messages, material)
            self._indices[material] = len(self.materials)
            self.materials.append(reader.read())
            self._uv_maps.append(reader.uv_map)
            self._textured.append(reader.uses_uv)
        return self._indices[material]

    def uv_map(self, indices, owner):
        """Name of the UV map that materials ask for, "" for the mesh's active one."""
        names = sorted({self._uv_maps[i] for i in indices})
        if len(names) > 1:
            self._messages.warning(f"object '{owner}': its materials use different UV maps; "
                                   f"libshade uses '{names[-1]}' for all")
        return names[-1]

    def textured(self, indices):
        """Has any of the materials a texture?"""
        return any(self._textured[i] for i in indices)


class Reader:
    """One material, and what its nodes found out: `uv_map`, that its images ask for, if one of them
    `uses_uv`; the `program`, and what outputs say that are `known`."""

    def __init__(self, images, messages, material):
        self.images, self._messages, self._material = images, messages, material
        self.owner = f"material '{material.name}'" if material else "no material"
        self.uv_map, self.uses_uv = "", False
        self.program, self.known = Program(), {}

    def warn(self, text):
        self._messages.warning(f"{self.owner}: {text}")

    def read(self):
        material = self._material
        plain = {"name": material.name if material else "",
            "pass_index": material.pass_index if material else 0, "closure": "METAL",
                 **nodes.initial_settings(), "nodes": []}
        if not material:
            return {**plain, **of_roughness(0.5), "f0": (0.8, 0.8, 0.8)}
        own = tree.of(material)
        shader = tree.shader_of(own) if own else None
        node = shader.node if shader else None
        closure = CLOSURES.get(node.bl_idname) if node else None
        if closure:
            try:
                made = closure(self, node, shader.groups)
                listed, made = self.program.finish(made)
                return {**plain, **made, "nodes": listed}
            except TooLarge:
                self.warn("its nodes are too many at once; rendered as metal of its viewport "
                          "colour")
        else:
            fed_by = f"its surface is '{node.name}'" if node else "its surface has no shader"
            self.warn(f"no Libshade Metal node ({fed_by if own else 'it has no nodes'}); "
                      "rendered as metal of its viewport colour")
        return {**plain, **of_roughness(material.roughness),
                "f0": tuple(material.diffuse_color[:3])}

    def use_uv_map(self, name):
        self.uses_uv = True
        if name and self.uv_map and name != self.uv_map:
            self.warn(f"uses the UV maps '{self.uv_map}' and '{name}'; "
                      f"libshade uses '{self.uv_map}' for both")
        self.uv_map = self.uv_map or name
