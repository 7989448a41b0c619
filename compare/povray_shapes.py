# SPDX-License-Identifier: Apache-2.0
"""POV-Ray's shapes as meshes of Blender, fine enough that neither silhouettes nor normals tell (inside Blender).

All is said in POV-Ray's words and axes: a point (x, y, z) there is (x, z, y) here. UV coordinates are those of POV-Ray's
own shapes; where a shape has none there, u runs as its strokes do, by `tangents.cpp` of the patches. Normals are those of the
shape, not of its faces.
"""
import math

import bpy
import numpy as np
import twin_scenes
from mathutils import Matrix, Vector

# Half as many faces round a shape. Quads that narrow, as towards a pole, bend UV coordinates along them.
FINE = 256
POLE = 1e-4  # of v: how near a pole a mesh goes
STEP = 1e-6


def swapped(points):
    return np.asarray(points, float)[..., [0, 2, 1]]


def axes(matrix):
    """A matrix of POV-Ray's world in Blender's."""
    swap = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
    return swap @ matrix @ swap


def moved(*steps):
    """A matrix from POV-Ray's transformations, in their order: ("rotate", (x, y, z)), …"""
    matrix = Matrix.Identity(4)
    for kind, by in steps:
        if kind == "rotate":
            for axis, angle in zip("XYZ", by):
                matrix = Matrix.Rotation(math.radians(angle), 4, axis) @ matrix
        elif kind == "scale":
            matrix = Matrix.Diagonal((*by, 1)) @ matrix
        else:
            matrix = Matrix.Translation(by) @ matrix
    return matrix


class Piece:
    """Points, normals and UVs of a mesh's vertices in POV-Ray's axes, and its faces; UVs may be each face's corners' own."""

    def __init__(self, points, normals, uv, faces):
        self.points, self.normals, self.uv, self.faces = (np.asarray(part) for part in (points, normals, uv, faces))

    def __add__(self, other):
        return Piece(*(np.concatenate([getattr(self, name), getattr(other, name)]) for name in ("points", "normals", "uv")),
                     np.concatenate([self.faces, other.faces + len(self.points)]))


def quads(rows, columns):
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    return np.stack([first, first + 1, first + columns + 1, first + columns], -1)


def normal_of(point, u, v):
    """Of a surface, by differences."""
    along, up = (point(u + a, v + b) - point(u - a, v - b) for a, b in ((STEP, 0), (0, STEP)))
    normals = np.cross(along, up)
    return normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)


def surface(point, us, vs, outwards=1.0, uv=None):
    """A grid of point(u, v); outwards: on which side of du x dv is the outside."""
    u, v = (part.ravel() for part in np.meshgrid(us, vs))
    said = uv(u, v) if uv else (u, v)
    return Piece(point(u, v), outwards * normal_of(point, u, v), np.stack(said, -1), quads(len(vs), len(us)))


def stack(x, y, z):
    return np.stack(np.broadcast_arrays(x, y, z), -1)


# ---- shapes, each round the origin as POV-Ray's UV coordinates have it


def sphere(radius=1.0, fine=FINE):
    def point(u, v):
        high, round_ = np.pi * (v - 0.5), 2 * np.pi * u
        return radius * stack(np.cos(high) * np.cos(round_), np.sin(high), np.cos(high) * np.sin(round_))

    return surface(point, np.linspace(0, 1, 2 * fine + 1), np.linspace(POLE, 1 - POLE, fine + 1), -1.0)


def torus(major, minor, fine=FINE):
    def point(u, v):
        round_, ring = np.pi - 2 * np.pi * u, 2 * np.pi * v - np.pi
        out = major + minor * np.cos(ring)
        return stack(out * np.cos(round_), minor * np.sin(ring), out * np.sin(round_))

    return surface(point, np.linspace(0, 1, 2 * fine + 1), np.linspace(0, 1, fine + 1))


def box(low, high):
    """Its UV coordinates unfold it, each side to its own scale."""
    low, size = np.asarray(low, float), np.subtract(high, low)
    sides = []
    for axis in range(3):
        for end in (0, 1):
            a, b = (k for k in range(3) if k != axis)
            at = np.zeros((4, 3))
            at[:, axis], at[:, a], at[:, b] = end, (0, 1, 1, 0), (0, 0, 1, 1)
            x, y, z = at.T
            u, v = {(0, 0): (z / 4, 1 / 3 + y / 3), (0, 1): (3 / 4 - z / 4, 1 / 3 + y / 3),
                    (1, 0): (1 / 4 + x / 4, z / 3), (1, 1): (1 / 4 + x / 4, 1 - z / 3),
                    (2, 0): (1 - x / 4, 1 / 3 + y / 3), (2, 1): (1 / 4 + x / 4, 1 / 3 + y / 3)}[axis, end]
            normals = np.zeros((4, 3))
            normals[:, axis] = 2 * end - 1
            sides.append(Piece(low + size * at, normals, np.stack([u, v], -1), [[0, 1, 2, 3]]))
    return together(sides)


def together(pieces):
    made = pieces[0]
    for piece in pieces[1:]:
        made = made + piece
    return made


def round_(low, high, base, cap, ends=True):
    """A cylinder or cone about y, from a height and radius to others. It has no UV coordinates: u is once round."""
    rise = high - low

    def side(u, v):
        radius = base + (cap - base) * v
        return stack(radius * np.cos(2 * np.pi * u), low + rise * v, radius * np.sin(2 * np.pi * u))

    us = np.linspace(0, 1, 2 * FINE + 1)
    pieces = [surface(side, us, np.linspace(0, 1, 2 if base == cap else 65), -1.0)]  # quads that narrow bend u
    for height, radius, facing in ((low, base, -1.0), (high, cap, 1.0)) if ends else ():
        def disc(u, v, height=height, radius=radius):
            return stack(radius * v * np.cos(2 * np.pi * u), height + 0 * u, radius * v * np.sin(2 * np.pi * u))

        pieces.append(surface(disc, us, np.array([POLE, 1.0]), facing))
    return together(pieces)


def plane(low, high, height=0.0):
    """A part of the plane y; u is x and v is z."""
    return surface(lambda u, v: stack(u, height + 0 * u, v), np.array([low[0], high[0]]), np.array([low[1], high[1]]), -1.0)


def lathe(points, steps=48, fine=FINE):
    """Of a `cubic_spline`: its first and last points bend the ends only."""
    points = np.asarray(points, float)
    count = len(points) - 3
    kept = np.stack([points[k:k + 4] for k in range(count)])
    weights = np.array([[-0.5, 1.5, -1.5, 0.5], [1, -2.5, 2, -0.5], [-0.5, 0, 0.5, 0], [0, 1, 0, 0]])
    parts = np.einsum("pk,nkc->npc", weights, kept)

    def point(u, v):
        at = np.clip(np.floor(v * count).astype(int), 0, count - 1)
        t = (v * count - at)[:, None]
        a, b, c, d = (parts[at, k] for k in range(4))
        radius, height = (((a * t + b) * t + c) * t + d).T
        return stack(radius * np.cos(2 * np.pi * u), height, radius * np.sin(2 * np.pi * u))

    return surface(point, np.linspace(0, 1, 2 * fine + 1), np.linspace(0, 1, steps * count + 1), -1.0)


def superellipsoid(east, north, fine=224):
    """|x|^(2/e) + … as POV-Ray has it: points of a cube, drawn in. u is x."""
    side = np.sin(np.linspace(-np.pi / 2, np.pi / 2, fine + 1))  # finer at edges
    pieces = []
    for axis in range(3):
        for end in (-1.0, 1.0):
            a, b = (part.ravel() for part in np.meshgrid(side, side))
            at = np.stack([np.full_like(a, end), a, b], -1)[:, np.argsort([axis, *(k for k in range(3) if k != axis)])]
            x, y, z = np.abs(at).T
            inner = x**(2 / east) + y**(2 / east)
            at = at * ((inner**(east / north) + z**(2 / north))**(-north / 2))[:, None]
            x, y, z = np.abs(at).T
            inner = np.maximum(x**(2 / east) + y**(2 / east), 1e-300)
            slope = np.stack([inner**(east / north - 1) * x**(2 / east - 1), inner**(east / north - 1) * y**(2 / east - 1),
                              z**(2 / north - 1)], -1) * np.sign(at)
            pieces.append(Piece(at, slope / np.linalg.norm(slope, axis=1, keepdims=True), at[:, :2], quads(fine + 1, fine + 1)))
    return together(pieces)


# ---- what is seen


def place(name, piece, material, *steps, like=None):
    """An object of the shape, smooth, its transformations in POV-Ray's order; or of the mesh of another object."""
    item = bpy.data.objects.new(name, like.data if like else mesh_of(name, piece))
    bpy.context.scene.collection.objects.link(item)
    item.material_slots[0].link = "OBJECT"
    item.material_slots[0].material = material
    item.matrix_world = axes(moved(*steps))
    return item


def mesh_of(name, piece):
    points, normals, faces = swapped(piece.points), swapped(piece.normals), piece.faces
    corners, corner_uv = points[faces], piece.uv if piece.uv.ndim == 3 else piece.uv[faces]
    winding = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inside = (winding * normals[faces].sum(1)).sum(1) < 0
    uv = np.where(inside[:, None, None], corner_uv[:, ::-1], corner_uv)
    faces = np.where(inside[:, None], faces[:, ::-1], faces)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.astype(np.float32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    if hasattr(mesh, "use_auto_smooth"):  # until 4.1 normals of one's own count by this alone
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set_from_vertices(normals.tolist())
    mesh.materials.append(None)  # each object has its own
    return mesh


def camera(location, look_at, angle, wide):
    """`angle` across, in degrees; `wide`: width over height."""
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "HORIZONTAL", math.radians(angle)
    data.clip_start, data.clip_end = 1e-3, 1e5
    item = bpy.data.objects.new("camera", data)
    at, to = (Vector(swapped(p).tolist()) for p in (location, look_at))
    item.location = at
    item.rotation_euler = (to - at).to_track_quat("-Z", "Y").to_euler()
    scene = bpy.context.scene
    scene.collection.objects.link(item)
    scene.camera = item
    scene.render.resolution_x, scene.render.resolution_y = 960, round(960 / wide)


def lamp(kind, location, color, energy):
    """energy: Blender's for a colour of 1."""
    color = np.broadcast_to(np.asarray(color, float), 3)
    twin_scenes.light(kind, energy * float(color.max()), swapped(location).tolist(), (color / color.max()).tolist())


def bulb(location, color, fade):
    """A point that fades as POV-Ray's do by `fade_distance` and a power of 2, for a distance far below those of the scene."""
    lamp("POINT", location, color, 8 * math.pi**2 * fade**2)


def sun(location, color):
    """A `parallel` light from there to the origin; POV-Ray multiplies pi f cos by its colour."""
    lamp("SUN", location, color, math.pi)
