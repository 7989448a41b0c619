# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: closures and a graph of nodes. Whatever is linked and not understood is named."""

from . import tree
from .closure import collect, plain
from .graph import Program, TooLarge
from .image import Images


_MOST = 8  # closures of a material
_BARE = (0.8, 0.8, 0.8)  # of what has no material [measured in Cycles 3.4, 5.0]
_NOTHING = {"closure": "EMISSION", "weight": (0.0,) * 3}  # black


class Table:
    """Materials and images of one render, each once."""

    def __init__(self, messages, transport, colors):
        self.materials, self.images = [], Images(messages)
        self.cloths = []
        self._transport = transport  # do grooves go with bumps?
        self._colors = colors  # are there passes of colour?
        self._messages = messages
        self._indices = {}  # by material
        self._uv_maps = []  # by index, "" is the mesh's active one
        self._textured = []  # by index: does it look anything up there?

    def index(self, material, drawn=True):
        """Index of a material; None is an empty slot. Not drawn: no light, whatever it shines with."""
        if not drawn:
            return self._undrawn(material)
        if material not in self._indices:
            reader = Reader(self, self._messages, material, self._transport,
                            self._colors)
            self._indices[material] = len(self.materials)
            self.materials.append(reader.read())
            self._uv_maps.append(reader.uv_map)
            self._textured.append(reader.uses_uv)
        return self._indices[material]

    def _undrawn(self, material):
        key = (material, "undrawn")
        if key not in self._indices:
            like = self.index(material)
            self._indices[key] = len(self.materials)
            self.materials.append({**self.materials[like], "drawn": False})
            self._uv_maps.append(self._uv_maps[like])
            self._textured.append(self._textured[like])
        return self._indices[key]

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
    `uses_uv`; the `program`, what outputs say that are `known`, and `closures`."""

    def __init__(self, table, messages, material, transport, colors):
        self.transport, self.colors = transport, colors
        self.images, self._cloths = table.images, table.cloths
        self._messages, self._material = messages, material
        self.owner = f"material '{material.name}'" if material else "no material"
        self.uv_map, self.uses_uv = "", False
        self.program, self.known = Program(), {}
        self.shift = None  # (0 or 1, step): coordinates are read so far along u or v
        self.in_height = False
        self.closures, self.open = [], set()  # open: shaders whose own shaders are being read

    def warn(self, text):
        self._messages.warning(f"{self.owner}: {text}")

    def read(self):
        material = self._material
        about = {"name": material.name if material else "",
                 "pass_index": material.pass_index if material else 0}
        own = tree.of(material) if material else None
        if own:
            try:
                return {**about, **self._of_nodes(own)}
            except (TooLarge, RecursionError) as error:
                many = "many at once" if isinstance(error, TooLarge) else "deep"
                self.warn(f"its nodes are too {many}; shaded as a Diffuse BSDF of its viewport colour")
        color = tuple(material.diffuse_color[:3]) if material else _BARE
        return {**about, **plain(color), "nodes": []}

    def _of_nodes(self, own):
        shader = tree.shader_of(own)
        if shader and shader.node:
            collect(self, own.get_output_node("ALL").inputs["Surface"], ())
        else:
            self.warn("no shader (its surface has none); black, as in Cycles")
        if len(self.closures) > _MOST:
            self.warn(f"its {len(self.closures)} shaders are more than {_MOST}; the last are left out")
        closures = self.closures[:_MOST] or [_NOTHING]
        nodes_, closures = self.program.finish(closures)
        if len(closures) == 1:
            return {"nodes": nodes_, **closures[0]}
        return {"nodes": nodes_, "closures": closures}

    def cloth(self, given):
        """Index of a cloth, each once."""
        if given not in self._cloths:
            self._cloths.append(given)
        return self._cloths.index(given)

    def use_uv_map(self, name):
        self.uses_uv = True
        if name and self.uv_map and name != self.uv_map:
            self.warn(f"uses the UV maps '{self.uv_map}' and '{name}'; "
                      f"libshade uses '{self.uv_map}' for both")
        self.uv_map = self.uv_map or name
