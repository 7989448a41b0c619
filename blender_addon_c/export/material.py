# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: closures and a graph of nodes. Whatever is linked and not understood is named."""

import os

import numpy as np
from mathutils import Matrix

from .. import versions
from . import tree
from .aov import BLACK, read_into
from .attributes import Attributes, of_view_layer
from .closure import collect, held_out, shading
from .closure_matt import plain
from .closure_principled import of_no_material
from .graph import Program, TooLarge
from .image import Images
from .known import Unknown
from .layers import Layers
from .node import NODES
from .node_normal import displaced
from .size import unit_of


_MOST = 8  # closures of a material
_BARE = (0.8, 0.8, 0.8)  # of what has no material in 3.4; in 5.0 it is a new Principled BSDF [measured]
_FAR = 1e18  # farther than anything is


def displacement_method(material):
    """It has moved to the material itself."""
    owner = material if hasattr(material, "displacement_method") else getattr(material, "cycles", None)
    return getattr(owner, "displacement_method", "BUMP")


class Table:
    """Materials, images and layers of one render, each once."""

    def __init__(self, messages, settings, colors, camera, depsgraph, kept=None, aovs=()):
        """aovs: of passes (aov.wanted_of)."""
        self.aovs = {one: [] for one in aovs}  # materials of each
        self.threshold = depsgraph.view_layer.pass_alpha_threshold
        self.shaders = []  # of worlds
        self.materials, self.images, self.layers = [], Images(messages, depsgraph.scene.frame_current, kept), Layers()
        self.kept, self.shines = kept, {}  # by lamp
        self.cloths, self.scratches = [], []
        self.unknown = Unknown()
        self.transport = settings.groove_transport  # do grooves go with bumps?
        self.mutual = settings.bumps_mutual  # do bumps shade and light each other?
        self.shape = settings.bumps_are == "SHAPE"  # and are long waves of images and scratches the objects' own?
        self.averages = settings.texture_blur > 0  # are images averaged?
        # do bumps of normal maps become roughness? A dump holds points, as they are shaded then
        self.dumps = bool(os.environ.get("LIBSHADE_DUMP"))
        self.filters = settings.filter_normals and not self.dumps
        self.colors = colors  # are there passes of colour?
        self.by_camera = False  # does a material look different from elsewhere?
        self.by_object = False  # or for each object?
        self.attributes = Attributes(messages, depsgraph.scene_eval.frame_current_final)
        self.unit = unit_of(depsgraph.scene)
        self.camera, self._depsgraph = camera, depsgraph
        world = depsgraph.scene.world
        self.reach = world.light_settings.distance if world else _FAR  # measured: 3.4 and 5.0
        self._active_maps = None  # by material: names of the active UV maps of its objects
        self._messages = messages
        self._indices = {}  # by material
        self._uv_maps = []  # by index: the main one; "" is the mesh's active one
        self._layers = []  # by index: (number, kind, name)
        self._textured = []  # by index: does it look anything up there?
        self._measured = []  # and does it ask how large that is?

    def add_shader(self, shader):
        """Number of a world's, from 1 on: they come after all materials, which have all been read."""
        self.shaders.append(shader)
        return len(self.materials) + len(self.shaders)

    def index(self, material, drawn=True, *how):
        """Index of a material; None is an empty slot. Not drawn: no light, whatever it shines with. how: as Reader has it."""
        if not drawn:
            return self._undrawn(material, *how)
        key = (material, *how)
        if key not in self._indices:
            reader = Reader(self, self._messages, material, *how)
            self._indices[key] = len(self.materials)
            self.materials.append(reader.read())
            for (name, kind), made in self.aovs.items():
                made.append(reader.read_aov(name, kind))
            self._uv_maps.append(reader.uv_map or "")
            self._layers.append(reader.layers)
            self._textured.append(reader.uv_map is not None)
            self._measured.append(reader.measured)
        return self._indices[key]

    def _undrawn(self, material, *how):
        key = (material, *how, "undrawn")
        if key not in self._indices:
            like = self.index(material, True, *how)
            self._indices[key] = len(self.materials)
            self.materials.append({**self.materials[like], "drawn": False})
            for made in self.aovs.values():
                made.append(made[like])
            self._uv_maps.append(self._uv_maps[like])
            self._layers.append(self._layers[like])
            self._textured.append(self._textured[like])
            self._measured.append(self._measured[like])
        return self._indices[key]

    def of_view_layer(self, name):
        return of_view_layer(self._depsgraph, name)

    def uv_maps(self, indices):
        """By material: name of its main UV map, "" for the mesh's active one."""
        return {i: self._uv_maps[i] for i in indices}

    def layers_of(self, indices):
        """All that these materials ask for: (number, kind, name)."""
        return sorted({wanted for i in indices for wanted in self._layers[i]})

    def active_uv_maps(self, material):
        """Names of the active UV maps of the objects that it is on."""
        if self._active_maps is None:
            self._active_maps = {}
            for ob in self._depsgraph.objects:
                active = next((l.name for l in getattr(ob.data, "uv_layers", ()) if l.active_render), None)
                for slot in ob.material_slots if active else ():
                    self._active_maps.setdefault(slot.material, set()).add(active)
        return self._active_maps.get(material, set())

    def shines_evenly(self, mesh):
        """Is what it shines with, if it does, the same everywhere?"""
        for index in np.unique(mesh["material"]):
            made = self.materials[index]
            for closure in made.get("closures", [made]):
                if closure.get("closure") == "EMISSION" and not closure.get("holds"):
                    if any(isinstance(weight, tuple) for weight in closure.get("weight", ())):
                        return False
        return True

    def textured(self, indices):
        """Has any of the materials a texture?"""
        return any(self._textured[i] for i in indices)

    def measured(self, indices):
        """By which map the mesh is measured, if any of the materials asks for that."""
        return next((self._uv_maps[i] or "" for i in indices if self._measured[i]), None)


POINTS, STRANDS, MAPLESS = "points", "strands", "mapless"


class Reader:
    """One material, and what its nodes found out: `uv_map`, its main one, None if nothing asks for any,
    and other `layers`; the `program`, what outputs say that are `known`, and `closures`. Held: it is a hole in the picture.
    kind: POINTS of a cloud, STRANDS of hair, MAPLESS of a mesh without a UV map."""

    has_surface = True

    def __init__(self, table, messages, material, held=False, kind=""):
        self._held, self._kind = held, kind
        self.of_points, self.of_strands, self.mapless = (kind == one for one in (POINTS, STRANDS, MAPLESS))
        self.transport, self.mutual, self.shape, self.colors = table.transport, table.mutual, table.shape, table.colors
        self.averages, self.filters, self.images, self._table = table.averages, table.filters, table.images, table
        self.dumps = table.dumps
        self._messages, self._material = messages, material
        self.owner = f"material '{material.name}'" if material else "no material"
        self.pass_index = material.pass_index if material else 0
        self.uv_map, self.layers, self.measured = None, set(), False
        self.nodes, self.program, self.known = NODES, Program(), {}
        self.shift = None  # two numbers or registers: coordinates are read so far along u and v
        self.in_height = False
        # by the first register of a normal: what it is in the mean, and what its bumps then add to squares of
        # alphas, along x and along y
        self.filtered = {}
        # by the first register of a normal, which is never below the surface: the one that it would be
        self.below = {}
        self.coarse = {}  # by the first register of a normal: the 8-bit image that it is read from, and how strong
        self.bumped = None  # registers of the normal that the displacement makes
        self.by_mesh = False  # do its strokes go by its meshes' own tangents?
        self.closures, self.open = [], set()  # open: shaders whose own shaders are being read

    def warn(self, text):
        self._messages.warning(f"{self.owner}: {text}")

    def read(self):
        material = self._material
        about = {"name": material.name if material else "",
                 "pass_index": self.pass_index}
        own = tree.of(material) if material else None
        if own:
            self._table.unknown.name(own, self.warn, bool(self._table.aovs))
            try:
                return {**about, **self._of_nodes(own)}
            except (TooLarge, RecursionError) as error:
                many = "many at once" if isinstance(error, TooLarge) else "deep"
                self.warn(f"its nodes are too {many}; shaded as a Diffuse BSDF of its viewport colour")
        if not material and versions.BARE_IS_PRINCIPLED:
            of_no_material(self)
            return {**about, **self._finished()}
        color = tuple(material.diffuse_color[:3]) if material else _BARE
        self.program, self.closures = Program(), [plain(color)]
        return {**about, **self._finished()}

    def _shades(self):
        """Does it stop shadow rays, however transparent it is?"""
        own = self._material
        return own and not getattr(own, "use_transparent_shadow", getattr(getattr(own, "cycles", None), "use_transparent_shadow", True))

    def read_aov(self, name, kind):
        """What it says by that name, after it was read."""
        other = Reader(self._table, self._messages, self._material, kind=self._kind)
        other.uv_map, other.layers = self.uv_map, self.layers
        other.colors = other.filters = False
        own = tree.of(self._material) if self._material else None
        passes = own and any(closure["closure"] == "TRANSPARENT" for closure in self.closures)
        made = read_into(other, own, name, kind, self._table.threshold if passes else None, self._held, self._shades())
        self.uv_map = other.uv_map
        return {"name": self._material.name if self._material else "", **made}

    def _of_nodes(self, own):
        shader = tree.shader_of(own)
        inputs = own.get_output_node("ALL").inputs if shader else {}
        volume = "Volume" in inputs and tree.trace(inputs["Volume"]).node
        if volume:
            self.warn("volumes are not supported; left out")
        if shader and shader.node:
            self.bumped = "Displacement" in inputs and displaced(self, inputs["Displacement"])
            if self.bumped and displacement_method(self._material) != "BUMP":
                self.warn("displacement of the surface itself is not supported; its normals are bumped")
            collect(self, inputs["Surface"], ())
        elif volume:
            self.closures.append({"closure": "TRANSPARENT"})
        else:
            self.warn("no shader (its surface has none); black, as in Cycles")
        if self._shades() and any(closure["closure"] == "TRANSPARENT" for closure in self.closures):
            if versions.SHADOWS_STOP:
                shading(self, "SHADOW", False)
            else:
                self.warn("Transparent Shadows (off) are not supported; its shadows are transparent")
        if len(self.closures) > _MOST:
            self.warn(f"its {len(self.closures)} shaders are more than {_MOST}; the last are left out")
        return self._finished()

    def _finished(self):
        if self._held:
            held_out(self)
        closures = self.closures[:_MOST] or [BLACK]
        nodes_, closures = self.program.finish(closures)
        made = {"nodes": nodes_, **({} if self.by_mesh else {"turned": True})}
        return {**made, **closures[0]} if len(closures) == 1 else {**made, "closures": closures}

    def cloth(self, given):
        """Index of a cloth, each once."""
        if given not in self._table.cloths:
            self._table.cloths.append(given)
        return self._table.cloths.index(given)

    def scratches(self, given):
        """Index of a field of scratches, each once."""
        if given not in self._table.scratches:
            self._table.scratches.append(given)
        return self._table.scratches.index(given)

    def is_main(self, name):
        """Is this UV map ("": the active one) the material's main one, the first that it asks for?"""
        if name and self._table.active_uv_maps(self._material) == {name}:
            name = ""
        self.uv_map = name if self.uv_map is None else self.uv_map
        return name == self.uv_map

    def layer(self, kind, name):
        """Number of a layer, which its meshes then have."""
        number = self._table.layers.number(kind, name)
        if kind == "TANGENT":
            self.layer("UV", name)
        self.layers.add((number, kind, name))
        return number

    def asks_objects(self):
        self._table.by_object = True

    def attribute(self, kind, name):
        """Four parts of what an object, its instancer or the view layer says by this name."""
        if kind == "VIEW_LAYER":
            return self._table.of_view_layer(name)
        self.asks_objects()
        key = ("attribute", kind, name)
        if key not in self.known:
            number = self._table.attributes.number(kind, name)
            self.known[key] = self.program.emit("ATTRIBUTE", 3, "more", attribute=number)
        return self.known[key]

    def most(self, part):
        """What a number or register is at most, as far as that is known, else infinite."""
        return self.program.range_of(part, self.images.range_of)[1]

    def measures(self):
        """Its meshes say what a unit of their UV map spans."""
        self.measured = True

    def reach(self):
        """As far as occlusion goes where a node does not say it, as the world's ambient occlusion does."""
        return self._table.reach

    def unit_of_length(self):
        """Metres in a unit of the scene."""
        return self._table.unit

    def camera(self):
        """(to its space, z away from it; frame; is it perspective?)"""
        self._table.by_camera = True
        camera = self._table.camera
        numbers = camera["matrix"]
        place = Matrix([numbers[4 * row:4 * row + 4] for row in range(4)])
        return (Matrix.Diagonal((1, 1, -1, 1)) @ place.inverted_safe(), camera["frame"],
                camera["type"] == "PERSP")
