# SPDX-License-Identifier: GPL-3.0-or-later
"""What worlds and lamps shine with where nodes say it: their graphs are read as those of materials, what would be asked
of a surface is answered for a direction, and the light of all directions is rendered as that of a wall about a camera.
"""

import math

import numpy as np
from mathutils import Matrix, Vector

from .. import _native, versions
from . import tree
from .closure import collect
from .graph import Program, is_known
from .image import Images
from .material import Reader
from .node_image import on_map
from .node_place import position
from .sky import sky_of
from .value import Value, number_in, three, value_of

# Of what nodes make, in a viewport and else; those of their images where they have more, up to a number.
_ROWS = {True: (512, 1024), False: (1024, 2048)}
_LAMP_ROWS = {True: (128, 256), False: (256, 512)}
_MOST = 1e18  # of light
# What may vary faster than such a picture's texels, and is then asked by each sample, and by how much of the mean.
_PATTERNS = {"WHITE_NOISE", "NOISE", "VORONOI", "BRICK"}
_FINE_ROWS, _FINE = 64, 0.05
_FALLS = {"Quadratic": 0, "Linear": 1, "Constant": 2}  # by which power of the distance less than light does

_BEHIND = ("NORMAL", "TRUE_NORMAL", "INCOMING", "REFLECTION")  # point back where one looks from [Cycles 3.4, 5.0]


def turn_of(matrix):
    """Axes of an object that has neither scale nor shear, in columns: its z is kept, and x as far as it can be."""
    x, _y, z = matrix.to_3x3().col
    z = z.normalized() if z.length > 1e-20 else Vector((0.0, 0.0, 1.0))
    x = x.normalized()
    x = x - z * x.dot(z)
    x = x.normalized() if x.length > 1e-6 else z.orthogonal().normalized()
    return Matrix((x, z.cross(x), z)).transposed()


def stretch_of(matrix):
    """What an object's scale makes of it, in rows."""
    return tuple(tuple(round(part, 4) for part in row) for row in matrix.to_3x3().transposed() @ turn_of(matrix))


class _World:
    """What a direction is asked of: one looks along it, and it is its place as well."""

    def normal(self, program):
        return program.back()

    incoming = normal

    def position(self, program):
        return program.forth()

    generated = position

    def place_on(self, _program):
        """It has no face."""

    uv = place_on

    def between_spaces(self, program, what, vector):
        """There is one."""
        return vector


class _Lamp:
    """One that shines along the direction, in its own axes, which is the normal of bulbs; others have one of their own
    [measured in Cycles 3.4 and 5.0]."""

    def __init__(self, kind, matrix, size=None):
        """size: of the face, where it may shine unevenly over that."""
        self._size, self._sides = size, matrix.to_3x3()
        self._round = kind in ("POINT", "SPOT")
        self._sun = kind == "SUN"
        self._turn = turn_of(matrix)
        self._own = matrix.to_3x3()  # world space of its space
        self._place = tuple(matrix.translation)

    def _way(self, program, turns):
        return program.forth() if turns else [0.0, 0.0, -1.0]

    def _in_world(self, program, vector):
        made = self._turned(program, self._turn, vector)
        program.placed += 1
        program.own[tuple(map(id, made))] = (made, vector)
        return made

    def normal(self, program):
        program.upright = True
        return self._in_world(program, self._way(program, self._round))

    def incoming(self, program):
        return self._in_world(program, self._way(program, not self._sun))

    def position(self, program):
        program.placed += 1
        if self._size:
            at = self._turned(program, self._sides, [program.math("MULTIPLY", program.math("SUBTRACT", part, 0.5), length)
                                                     for part, length in zip(program.on_face(), self._size)] + [0.0])
            return [program.math("ADD", a, b) for a, b in zip(at, self._place)]
        return list(self._turn @ Vector((0.0, 0.0, -1.0))) if self._sun else list(self._place)

    def generated(self, program):
        return self.between_spaces(program, "POINT_INTO", self.position(program)) if self._size else self.position(program)

    def place_on(self, program):
        """Of its face, 0 to 1 along both sides; None of others."""
        return program.on_face() if self._size else None

    def uv(self, program):
        return None if versions.LAMPS_STAND_STILL else self.place_on(program)

    def between_spaces(self, program, what, vector):
        """Points of its own are those of the world in 3.4."""
        known = program.own.get(tuple(map(id, vector)))
        inverse = self._own.inverted_safe()
        if what.startswith("POINT"):
            program.placed += 1
            if versions.LAMPS_STAND_STILL:
                return vector
            if what.endswith("_INTO"):
                return self._turned(program, inverse, [program.math("SUBTRACT", a, b) for a, b in zip(vector, self._place)])
            return [program.math("ADD", a, b) for a, b in zip(self._turned(program, self._own, vector), self._place)]
        if not what.endswith("_INTO"):
            program.placed += 1
            return self._turned(program, inverse.transposed() if what.startswith("NORMAL") else self._own, vector)
        by = self._own.transposed() if what.startswith("NORMAL") else inverse
        if known:  # all that counts is its scale
            program.placed -= 1
            by, vector = by @ self._turn, known[1]
            if np.abs(np.array(by) - np.identity(3)).max() < 1e-5:
                return vector
        else:
            program.placed += 1
        made = self._turned(program, by, vector)
        return program.unit(made) if what.startswith("NORMAL") else made

    @staticmethod
    def _turned(program, turn, vector):
        made = []
        for row in turn:
            total = 0.0
            for by, part in zip(row, vector):
                total = program.math("ADD", total, program.math("MULTIPLY", part, float(by)))
            made.append(total)
        return made


class _Directions(Program):
    """A program for a direction. way: what Light Path says of rays that look, as words of its node. of: what is asked. `turns`: may it make a difference
    where to, or from where on its face? `by_way`, `faced`: was a direction asked for, such a place? `own`: vectors of the world, by who they are, and what they are in axes of a lamp's own; `placed`: how
    often else these axes were asked for; `upright`: was a normal?"""

    def __init__(self, way, of):
        super().__init__()
        self.turns, self._way, self._behind = False, way, None
        self.by_way, self.faced = False, None
        self._of, self.own, self.placed, self.upright = of, {}, 0, False

    def emit(self, kind, out=3, more=None, **given):
        answer = _ANSWERS.get(kind)
        if answer:
            return answer(self, out + bool(more), given)
        if kind == "IMAGE" and not given.get("at"):
            on = self._of.uv(self)
            given |= {"at": on} if on else {}
        self.turns = self.turns or kind == "IMAGE"
        return super().emit(kind, out, more, **given)

    def on_face(self):
        self.turns = True
        if self.faced is None:
            self.faced = super().emit("GEOMETRY", what="UV")[:2]
        return list(self.faced)

    def back(self):
        self.turns = self.by_way = True
        if self._behind is None:
            self._behind = super().emit("GEOMETRY", what="INCOMING")
        return list(self._behind)

    def unit(self, vector):
        total = 0.0
        for part in vector:
            total = self.math("ADD", total, self.math("MULTIPLY", part, part))
        length = self.math("SQRT", total)
        return [self.math("DIVIDE", part, length) for part in vector]

    def forth(self):
        return [self.math("MULTIPLY", part, -1.0) for part in self.back()]

    def _geometry(self, _out, given):
        if given["what"] == "POSITION":
            return self._of.position(self)
        if given["what"] == "UV":
            return [*(self._of.uv(self) or (0.0, 0.0)), 0.0]
        if given["what"] not in _BEHIND:
            return [0.0] * 3
        return self._of.incoming(self) if given["what"] in ("INCOMING", "REFLECTION") else self._of.normal(self)

    def _layer(self, out, given):
        if given["layer"] == "GENERATED":
            return [*self._of.generated(self), 1.0]
        on = {"PARAMETRIC": self._of.place_on, "UV": self._of.uv}.get(given["layer"])
        return [*((on(self) if on else None) or (0.0, 0.0)), 0.0, 0.0][:out]

    def _path(self, out, given):
        return [float(given["what"] in self._way)] * out

    def _between_spaces(self, out, given):
        return list(self._of.between_spaces(self, given.get("what", "VECTOR"), given.get("vector") or [0.0] * out))


_ANSWERS = {"GEOMETRY": _Directions._geometry, "LAYER": _Directions._layer, "PATH": _Directions._path,
            "ATTRIBUTE": lambda _program, out, _given: [0.0] * out, "OBJECT": _Directions._between_spaces, "FRAME": _Directions._between_spaces}


class _Around(Reader):
    """A reader of the graph of a world or a lamp."""

    has_surface = False

    def __init__(self, owner, table, messages, way, of, falls):
        """falls: the node by which its light may fall off, or None. `gain`: how that does. `asked`: of ways. `lamp`: is it one?"""
        super().__init__(table, messages, None)
        self.owner, self.program = owner, _Directions(way, of)
        self.images, self.kept = Images(messages, table.images.frame, table.kept), table.kept
        self.averages = self.filters = self.colors = False
        self.falls, self.gain, self.lamp = falls, {}, isinstance(of, _Lamp)
        self.nodes, self.asked = {**self.nodes, "LIGHT_PATH": _light_path, "LIGHT_FALLOFF": _light_falloff, "TEX_SKY": _tex_sky}, frozenset()
        del self.nodes["LibshadeScratchesNode"]  # there is no surface

    def layer(self, kind, _name):
        return kind

    def is_main(self, _name):
        return True

    def asks_objects(self):
        """There are none."""

    def reach(self):
        """Nothing stands about it."""
        return 0.0

    def camera(self):
        """It is everywhere."""
        matrix, *rest = super().camera()
        return (matrix.to_3x3().to_4x4(), *rest)


def _tex_sky(reader, found):
    """Looked up in a picture of it, its sun as bright as it is."""
    node, vector = found.node, found.node.inputs.get("Vector")
    given = value_of(reader, vector, found.groups, own=Value("VECTOR", None)) if vector and vector.enabled else Value("VECTOR", None)
    to = three(reader, given) if given.parts is not None else tuple(position(reader))
    rows = _ROWS[reader.kept is not None][1]
    sky = sky_of(reader, node, 1.0, Matrix.Identity(4))
    data = reader.kept.around(str((rows, sky)), (), lambda: _of_sky(sky, rows)) if reader.kept else _of_sky(sky, rows)
    image = reader.images.made({"width": data.shape[1], "height": data.shape[0], "channels": 3, "data": data.ravel(), "srgb": False,
                                "wide": True, "wrap": "REPEAT", "filter": "LINEAR"})
    return reader.program.emit("IMAGE", 3, "alpha", image=image, cubic=False, at=on_map(reader, to))[:3]


def _of_sky(sky, rows):
    """Equirectangular; with many samples about its sun, which is a few pixels wide."""
    scene = {**_scene(rows, [], [], []), "meshes": [], "instances": [], "materials": [], "sky": sky, "transparent": False}
    data = _render(scene)
    if sky.get("sun_size"):
        columns, half = scene["width"], 0.5 * sky["sun_size"]
        across = half / max(math.cos(min(abs(sky["elevation"]) + half, math.pi / 2)), 1e-3)
        x = (0.5 - math.atan2(sky["matrix"][1], sky["matrix"][0]) / (2 * math.pi)) % 1.0 * columns
        y = (0.5 + sky["elevation"] / math.pi) * rows
        wide, high = across / (2 * math.pi) * columns + 2, half / math.pi * rows + 2
        y0, y1 = max(int(y - high), 0), min(int(y + high) + 1, rows)
        for turn in (-columns, 0, columns):  # its picture has a seam
            x0, x1 = max(int(x - wide) + turn, 0), min(int(x + wide) + 1 + turn, columns)
            if x0 < x1 and y0 < y1:
                data[y0:y1, x0:x1] = _render({**scene, "region": (x0, y0, x1, y1), "samples": 64, "filter_width": 0.0})
    return data


def _light_path(reader, found):
    name = found.output.name
    known = SEEN.keys() if not reader.lamp else {"Is Camera Ray"}
    if name in known:
        reader.asked |= {SEEN[name]}
    elif name not in _NEVER or reader.lamp:
        reader.warn(f"'{found.node.name}' ({name}) is not supported; 0")
    return (reader.program.emit("PATH", 1, what=SEEN[name] if name in known else None)[0],)


# What rays may be that see a world, as words of the Light Path node.
SEEN = {"Is Camera Ray": "CAMERA", "Is Diffuse Ray": "DIFFUSE", "Is Glossy Ray": "GLOSSY", "Is Singular Ray": "SINGULAR",
        "Is Reflection Ray": "REFLECTION", "Is Transmission Ray": "TRANSMISSION"}
_NEVER = ("Is Shadow Ray", "Is Volume Scatter Ray")  # are those that do


def _light_falloff(reader, found):
    strength, smooth = (number_in(reader, found, name) for name in ("Strength", "Smooth"))
    if found.node == reader.falls and is_known(smooth):
        reader.gain = {"gain": _FALLS[found.output.name], "smooth": min(max(float(smooth), 0.0), _MOST)}
    elif found.output.name != "Quadratic" or not is_known(smooth) or smooth > 0:
        reader.warn(f"'{found.node.name}': lamps fall off as light does, without smoothing")
    return (strength,)


def _falls_by(own):
    """The Light Falloff that all of a lamp's strength is a multiple of, or None."""
    found = tree.shader_of(own)
    if not found or not found.node or found.node.type != "EMISSION":
        return None
    found = tree.trace(found.node.inputs["Strength"], found.groups)
    for _ in range(100):
        if not found.node or found.node.type != "MATH" or found.node.operation != "MULTIPLY" or found.node.use_clamp:
            break
        linked = [socket for socket in found.node.inputs[:2] if socket.is_linked]
        if len(linked) != 1:
            break
        found = tree.trace(linked[0], found.groups)
    return found.node if found.node and found.node.type == "LIGHT_FALLOFF" else None


class Shine:
    """What one shines with: `color`, unless it `turns`, for then there are several. `mixed`: by directions and by places
    on a face at once, which it cannot. `gain`: how its light falls off, {} as light does. `asked`: for which ways
    of rays may it be another? `there`: does any node shine?"""

    def __init__(self, own, owner, table, messages, way=frozenset(), lamp=None):
        """own: its node tree. way: of rays that see it, as words of SEEN. lamp: kind, matrix and perhaps size of one."""
        of = _Lamp(*lamp) if lamp else _World()
        falls = _falls_by(own) if lamp and lamp[0] != "SUN" else None
        self._reader = reader = _Around(owner, table, messages, way, of, falls)
        collect(reader, own.get_output_node("ALL").inputs["Surface"], ())
        self.placed = reader.program.placed > 0
        self._closures = [c for c in reader.closures if c["closure"] == "EMISSION" and not c.get("holds")]
        self.turns, self.asked, self.there = reader.program.turns, reader.asked, bool(self._closures)
        self._kept, self.gain = table.kept, {k: v for k, v in reader.gain.items() if v}
        self.mixed = reader.program.faced is not None and reader.program.by_way
        weights = [c.get("weight", (1.0,) * 3) for c in self._closures]
        if all(is_known(*weight) for weight in weights):
            self.turns, self.color = False, _light(np.sum([(0.0,) * 3, *weights], 0))
        elif not self.turns:
            self.color = tuple(map(float, self._rendered(1)[0, 0]))

    def picture(self):
        """Of all directions as the native module takes it, equirectangular."""
        rows, most = _ROWS[self._kept is not None]
        data = self._rendered(min(max([rows, *(image["height"] for image in self._reader.images.listed)]), most))
        return {"width": data.shape[1], "height": data.shape[0], "channels": 3, "data": data.ravel(), "srgb": False,
                "wrap": "EXTEND", "filter": "LINEAR"}  # at either pole no more of the other one

    def shader(self, rows, images):
        """Where neighbours within a texel of a picture of so many rows differ, its nodes as those of a material, which each sample
        asks; else None. images: of the scene, which its own are added to."""
        nodes, closures = self._reader.program.finish(self._closures)
        own = self._reader.images.listed
        if not any(node["type"] in _PATTERNS for node in nodes):
            return None
        coarse = {**_scene(_FINE_ROWS, nodes, closures, own), "filter_width": 3.0 * _FINE_ROWS / rows, "seed": 1}
        one, other = self._kept_picture(coarse), self._rendered(_FINE_ROWS)
        if not np.abs(one - other).mean() > _FINE * other.mean():
            return None
        moved = {}
        for node in nodes:
            if node["type"] == "IMAGE" and node["image"] not in moved:
                moved[node["image"]] = images.made(own[node["image"]])
        return {"name": "world", "nodes": [{**node, "image": moved[node["image"]]} if node["type"] == "IMAGE" else node for node in nodes],
                "closures": closures}

    def pattern(self):
        """(the mean over all directions, what of it is along each as the native module takes it, or None: all of it)"""
        few, most = _LAMP_ROWS[self._kept is not None]
        rows = max([few, *(image["height"] for image in self._reader.images.listed)])
        data, face = self._rendered(min(rows, most)), self._reader.program.faced is not None
        part = np.ones(len(data)) if face else np.cos((np.arange(len(data)) + 0.5 - len(data) / 2) * np.pi / len(data))
        mean = (data.mean(1, dtype=float) * part[:, None]).sum(0) / part.sum()
        if np.ptp(data, (0, 1)).max() <= 1e-4 * data.max():
            return tuple(mean), self.even()
        made = data / np.maximum(mean, 1e-30)
        return tuple(mean), {"width": data.shape[1], "height": data.shape[0], "data": made.astype(np.float32).ravel(),
                              "upright": self._reader.program.upright, "face": face, **self.gain}

    def even(self):
        """The pattern of what shines evenly, if that falls off otherwise."""
        return {"width": 1, "height": 1, "data": np.ones(3, np.float32), **self.gain} if self.gain else None

    def _rendered(self, rows):
        scene = _scene(rows, *self._reader.program.finish(self._closures), self._reader.images.listed)
        if self._reader.program.faced is not None:
            scene |= _before_face(rows)
        return self._kept_picture(scene)

    def _kept_picture(self, scene):
        if not self._kept:
            return _render(scene)
        key = str([scene[name] for name in ("width", "height", "seed", "materials")])
        return self._kept.around(key, [image["data"] for image in scene["images"]], lambda: _render(scene))


def _light(numbers):
    return tuple(float(x) for x in np.clip(np.nan_to_num(numbers), 0.0, _MOST))


# A camera that looks along x, z up, as the middle of a world's picture does.
_ALONG_X = [0.0, 0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def _scene(rows, nodes, closures, images):
    """A box of that material about a camera that looks all around, through the middles of its pixels."""
    size = 2 * rows, rows
    corners = np.array([[1.0 - 2.0 * (k >> axis & 1) for axis in range(3)] for k in range(8)], np.float32)
    faces = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
    order = np.array([(a, b, c, a, c, d) for a, b, c, d in faces], np.int32).ravel()
    thirds = corners[order].reshape(-1, 3, 3)
    normals = np.cross(thirds[:, 1] - thirds[:, 0], thirds[:, 2] - thirds[:, 0]) / 4
    box = {"name": "", "positions": corners, "corner_position": order, "corner_normals": np.repeat(normals, 3, 0).astype(np.float32),
           "corner_uvs": None, "material": np.zeros(12, np.int32)}
    camera = {"type": "PANO", "panorama": "EQUIRECTANGULAR", "matrix": _ALONG_X, "frame": (0.0, 1.0, 0.0, 1.0),
              "range": (-np.pi, np.pi, -np.pi / 2, np.pi / 2), "clip": (1e-3, 10.0), "fov": np.pi, "focal": 10.5,
              "sensor": (36.0, 18.0), "polynomial": [0.0] * 5}
    return {"width": size[0], "height": size[1], "region": (0, 0, *size), "samples": 1, "seed": 0, "threads": 0,
            "transparent": True, "background": (0.0,) * 3, "pixel_filter_type": "GAUSSIAN", "filter_width": 1e-3, "camera": camera, "lights": [],
            "images": images, "materials": [{"name": "", "nodes": nodes, "closures": closures}], "meshes": [box],
            "instances": [{"mesh": 0, "matrix": [float(i == j) for i in range(4) for j in range(4)]}],
            "dump": "", "renderer": ""}


def _before_face(rows):
    """A square instead, seen from before through the middles of its pixels."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
    order = np.array((0, 1, 2, 0, 2, 3), np.int32)
    square = {"name": "", "positions": corners, "corner_position": order, "corner_normals": np.tile(np.float32((0, 0, 1)), (6, 1)),
              "corner_uvs": (corners[order, :2] * 0.5 + 0.5).astype(np.float32).ravel(), "material": np.zeros(2, np.int32)}
    matrix = [float(i == j) for i in range(4) for j in range(4)]
    matrix[11] = 1.0
    camera = {"type": "ORTHO", "matrix": matrix, "frame": (-1.0, 1.0, -1.0, 1.0), "clip": (1e-3, 10.0)}
    return {"width": rows, "region": (0, 0, rows, rows), "camera": camera, "meshes": [square]}


def _render(scene):
    x0, y0, x1, y1 = scene["region"]
    pixels = np.zeros((y1 - y0, x1 - x0, 4), np.float32)
    job = _native.start(scene)
    try:
        while not _native.wait(job, 1.0):
            pass
        _native.image(job, pixels)
    finally:
        _native.free(job)
    return np.clip(np.nan_to_num(pixels[..., :3]), 0.0, _MOST)
