# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender draws by points: hair of particles and curves as tubes, points as balls. They are as thick as in
Cycles in the mean over all sides; its ribbons turn to each ray instead."""

from collections import namedtuple

import bpy
import numpy as np

from .layers import as_factor, four_of, read

# points: one after the other; radii of these; ends: behind the last point of each; root: a UV of each, or None; told: what
# they say of an attribute by its name, four numbers a point, None where that is nothing
Strands = namedtuple("Strands", "points radii ends roots told", defaults=(lambda _name: None,))
Points = namedtuple("Points", "places radii told")

_MANY = 1_000_000  # triangles from which on tubes have fewer sides, three at last and no more rings than points
_SIDES = (24, _MANY // 10), (16, _MANY // 4), (8, _MANY), (6, _MANY), (4, _MANY)  # of fewer triangles than these
_CLOSED = 16  # ends of tubes of so many sides
_TRIANGLES = np.int32([[0, 1, 2], [0, 2, 3]])


def of_curves(data):
    """Of a Curves object: its control points."""
    count = len(data.points)
    points = read(data.points, "position", 3).reshape(-1, 3)
    radius = data.attributes.get("radius")
    if radius and radius.domain == "POINT" and radius.data_type == "FLOAT":
        radii = read(radius.data, "value", 1)
    else:
        radii = np.full(count, 0.005, np.float32)  # as Cycles
    lengths = read(data.curves, "points_length", 1, np.int32)

    def told(name):
        found = data.attributes.get(name) if name else None
        numbers = four_of(found)
        if numbers is None or found.domain not in ("POINT", "CURVE"):
            return None
        return numbers if found.domain == "POINT" else np.repeat(numbers, lengths, 0)

    return Strands(points, radii, np.cumsum(lengths), None, told)


def hairs(ob):
    """(modifier, particle system) of each that is drawn as hair."""
    for modifier in ob.modifiers:
        if modifier.type == "PARTICLE_SYSTEM" and modifier.show_render:
            settings = modifier.particle_system.settings
            if settings.type == "HAIR" and settings.render_type == "PATH":
                yield modifier, modifier.particle_system


def of_hair(ob, modifier, system):
    """Of a particle system: children, else their parents, as long as they are."""
    settings = system.settings
    parents, children = len(system.particles), len(system.child_particles)
    first = parents if settings.child_type != "NONE" and children else 0
    last = parents + (children if first else 0)
    steps = (1 << settings.render_step) + 1 + (settings.kink_extra_steps if settings.kink == "SPIRAL" else 0)
    points = np.empty((last - first, steps, 3))
    for strand in range(first, last):
        for step in range(steps):
            points[strand - first, step] = system.co_hair(ob, particle_no=strand, step=step)
    roots = None
    if ob.type == "MESH" and ob.data.uv_layers and parents:
        any_ = system.particles[0]
        roots = np.float32([system.uv_on_emitter(modifier, particle=system.particles[k] if k < parents else any_,
                                                 particle_no=k, uv_no=0) for k in range(first, last)])
    place = np.linalg.pinv(np.array(ob.matrix_world, float))
    points = points @ place[:3, :3].T + place[:3, 3]
    steps_long = np.linalg.norm(np.diff(points, axis=1), axis=2)
    along = np.concatenate([np.zeros((len(points), 1)), np.cumsum(steps_long, 1)], 1)
    there = along[:, -1] > 0
    along, points, roots = along[there] / along[there, -1:], points[there], roots[there] if roots is not None else None
    left = 1.0 - along
    if settings.shape:
        left = left ** (1 + settings.shape if settings.shape < 0 else 1 / max(1 - settings.shape, 1e-6))
    root, tip = (0.5 * settings.radius_scale * radius for radius in (settings.root_radius, settings.tip_radius))
    radii = left * (root - tip) + tip
    if settings.use_close_tip:
        radii[:, -1] = 0
    return Strands(points.reshape(-1, 3).astype(np.float32), radii.ravel().astype(np.float32),
                   np.arange(1, len(points) + 1) * steps, roots)


def even_size(matrix):
    """By how much an object's matrix scales what stays round, as Cycles has it."""
    return float(abs(np.linalg.det(np.array(matrix, float)[:3, :3])) ** (1 / 3))


def tubes(strands, matrix, owner, material, wanted=()):
    """Their surface as a mesh of the native module, round where its object stands; None without any. wanted: layers
    that its material asks for, (number, kind, name)."""
    points, radii, ends = _good(strands)
    to_world = np.array(matrix, float)[:3, :3]
    if not np.isfinite(to_world).all() or not even_size(matrix) > 1e-12:
        to_world = np.eye(3)
    points, radii = points @ to_world.T, radii * even_size(to_world)
    starts = np.concatenate([[0], ends[:-1]]).astype(np.int64) if len(ends) else np.zeros(0, np.int64)
    counts = ends - starts
    keep = np.repeat(counts > 1, counts)
    long = np.flatnonzero(counts > 1)
    if not len(long):
        return None
    told = [(number, kind, strands.told(name)) for number, kind, name in wanted if kind in ("ATTRIBUTE", "FACTOR", "COLOR")]
    told = [(number, np.nan_to_num((as_factor(numbers) if kind == "FACTOR" else numbers)[keep]))
            for number, kind, numbers in told if numbers is not None]
    points, radii, counts = points[keep], radii[keep], counts[counts > 1]
    sides = next((n for n, most in _SIDES if 4 * n * len(points) < most), 3)
    parts = next((n for n in (8, 4) if 2 * n * sides * len(points) < _MANY // 4), 2 if sides > 3 else 1)
    told = [(number, _between(numbers, counts, parts)) for number, numbers in told]
    (points, along), radii, counts = _curves(points, counts, parts), _between(radii, counts, parts), parts * (counts - 1) + 1
    ends = np.cumsum(counts)
    of_object = np.linalg.inv(to_world).T
    layers = [{"layer": number, "data": _told(points @ of_object, _unit(along @ of_object), radii / even_size(to_world), ends, long, name)}
              for number, kind, name in wanted if kind == "STRAND"]
    layers += [{"layer": number, "data": numbers} for number, numbers in told]
    number, last = np.arange(len(points)), np.repeat(ends - 1, counts)
    side, up = _across(along, ends - counts)
    angle = 2 * np.pi * np.arange(sides) / sides
    # a polygon whose width is that of the circle, in the mean over all sides
    wide = np.pi / (sides * np.sin(np.pi / sides)) * radii
    normals = np.cos(angle)[None, :, None] * side[:, None] + np.sin(angle)[None, :, None] * up[:, None]
    rings = points[:, None] + wide[:, None, None] * normals
    before = np.flatnonzero(number != last)
    k = np.arange(sides)
    a = before[:, None] * sides + k
    b = before[:, None] * sides + (k + 1) % sides
    quads = np.stack([a, b, b + sides, a + sides], -1).reshape(-1, 4)
    corners = quads[:, _TRIANGLES].reshape(-1)
    # which point each vertex is of; discs, shaded as the side is, close the ends where these are not many, as in Cycles
    of = np.repeat(number, sides)
    rings, normals = rings.reshape(-1, 3), normals.reshape(-1, 3)
    for at, sign in ((ends - counts, -1), (ends - 1, 1)) if sides >= _CLOSED else ():
        at = at[wide[at] > 0]
        a, b = at[:, None] * sides + k, at[:, None] * sides + (k + 1) % sides
        middle = len(rings) + np.arange(a.size).reshape(a.shape)
        corners = np.concatenate([corners, np.stack([a, b, middle][::sign], -1).reshape(-1)])
        of = np.concatenate([of, np.repeat(at, sides)])
        rings, normals = np.concatenate([rings, points[of[len(rings):]]]), np.concatenate([normals, normals[a.ravel()]])
    rings, normals = rings @ np.linalg.inv(to_world).T, normals @ to_world
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    uvs = None
    if strands.roots is not None:
        strand = np.repeat(np.arange(len(counts)), counts)[of]
        uvs = np.ascontiguousarray(strands.roots[long][strand][corners], np.float32)
    return {"name": owner, "positions": np.ascontiguousarray(rings, np.float32),
            "corner_position": corners.astype(np.int32),
            "corner_normals": np.ascontiguousarray(normals[corners], np.float32),
            "corner_uvs": uvs, "material": np.full(len(corners) // 3, material, np.int32),
            "layers": [{**one, "data": np.ascontiguousarray(np.asarray(one["data"])[of[corners]], np.float32).ravel()}
                       for one in layers]}


def _along(points, ends):
    """Directions of strands at their points: from each one's neighbour before to the one after."""
    counts, number = np.diff(ends, prepend=0), np.arange(len(points))
    first, last = np.repeat(ends - counts, counts), np.repeat(ends - 1, counts)
    return _unit(points[np.minimum(number + 1, last)] - points[np.maximum(number - 1, first)])


def _told(points, along, radii, ends, numbers, name):
    """What nodes may ask of each point: which part of its strand's length lies before it, this length, a number by chance
    for each strand and 1; or how thick it is there, or which way it runs. numbers: of the strands."""
    told = np.zeros((len(points), 4))
    if name == "thickness":
        told[:, 0] = 2 * radii
        return told
    if name == "tangent":
        told[:, :3] = along
        return told
    counts = np.diff(ends, prepend=0)
    first = np.repeat(ends - counts, counts)
    steps = np.linalg.norm(np.diff(points, axis=0, prepend=points[:1]), axis=1)
    steps[ends - counts] = 0
    along = np.cumsum(steps)
    along -= along[first]
    lengths = np.repeat(along[ends - 1], counts)
    told[:, 0], told[:, 1] = along / np.where(lengths > 0, lengths, 1), lengths
    told[:, 2], told[:, 3] = np.repeat(by_chance(numbers), counts), 1
    return told


def by_chance(numbers):
    """From 0 to 1, the same for a number as in Cycles: it and 0 mixed by lookup3 [Jenkins2006]."""
    numbers = np.asarray(numbers)
    if not numbers.ndim:  # numpy warns where a single number wraps round
        return by_chance(numbers[None])[0]
    whole = np.uint64(0xffffffff)
    a = b = c = np.full(numbers.shape, 0xdeadbeef + 8 + 13, np.uint64)
    parts = [a + numbers.astype(np.uint64) & whole, b, c]
    for k, shift in enumerate((14, 11, 25, 16, 4, 14, 24)):
        to, by = ((2, 1), (0, 2), (1, 0))[k % 3]
        turned = parts[by] << np.uint64(shift) | parts[by] >> np.uint64(32 - shift)
        parts[to] = (parts[to] ^ parts[by]) - (turned & whole) & whole
    return parts[2] / 0xffffffff


def _good(strands):
    """Points that are no numbers are where the first one is, without thickness."""
    ends = np.asarray(strands.ends, np.int64)
    bad = ~np.isfinite(strands.points).all(1) | ~np.isfinite(strands.radii)
    points, radii = np.where(bad[:, None], 0, strands.points), np.where(bad, 0, strands.radii)
    if bad.any() and not bad.all():
        counts = np.diff(ends, prepend=0)
        # of each strand the first point that is good, if there is one
        place = np.where(bad, len(bad), np.arange(len(bad)))
        first = np.full(len(counts), len(bad))
        first[counts > 0] = np.minimum.reduceat(place, (ends - counts)[counts > 0])
        first = np.repeat(np.minimum(first, len(bad) - 1), counts)
        points = np.where(bad[:, None], points[first], points)
    return points.clip(-1e17, 1e17), np.abs(radii).clip(0, 1e17), ends


def _curves(points, counts, parts):
    """(points, directions) of curves of Catmull and Rom through these, each piece in so many parts."""
    ends, number = np.cumsum(counts), np.arange(len(points))
    first, last = np.repeat(ends - counts, counts), np.repeat(ends - 1, counts)
    four = np.stack([points[(number + k).clip(first, last)] for k in (-1, 0, 1, 2)])
    u = np.arange(parts) / parts
    one, u2, u3 = np.ones(parts), u * u, u * u * u
    weights = 0.5 * np.stack([-u + 2 * u2 - u3, 2 * one - 5 * u2 + 3 * u3, u + 4 * u2 - 3 * u3, u3 - u2])
    slopes = 0.5 * np.stack([-one + 4 * u - 3 * u2, -10 * u + 9 * u2, one + 8 * u - 9 * u2, 3 * u2 - 2 * u])
    keep = _but_last(counts, parts)
    made, along = (np.einsum("kp,knd->npd", by, four).reshape(-1, 3)[keep] for by in (weights, slopes))
    still = np.linalg.norm(along, axis=1) == 0
    return made, np.where(still[:, None], _along(made, np.cumsum(parts * (counts - 1) + 1)), _unit(along))


def _between(numbers, counts, parts):
    """Those of points, and evenly between each two of a strand."""
    last = np.repeat(np.cumsum(counts) - 1, counts)
    after = numbers[np.minimum(np.arange(len(numbers)) + 1, last)]
    made = np.stack([numbers + k / parts * (after - numbers) for k in range(parts)], 1)
    return made.reshape(-1, *numbers.shape[1:])[_but_last(counts, parts)]


def _but_last(counts, parts):
    """Of so many parts for each point, all but what comes behind the last point of a strand."""
    keep = np.ones((counts.sum(), parts), bool)
    keep[np.cumsum(counts) - 1, 1:] = False
    return keep.ravel()


def _unit(vectors):
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(length > 0, vectors / np.where(length > 0, length, 1), (0, 0, 1))


def _across(axis, first):
    """Two axes across unit vectors, which turn about those as little as can be from each to the next of a strand. first: of
    strands."""
    other = np.where(np.abs(axis[:, :1]) < 0.7, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    side = _unit(np.cross(axis, other))
    up = np.cross(axis, side)
    before = np.concatenate([side[:1], side[:-1]])
    turn = np.arctan2((before * up).sum(1), (before * side).sum(1))
    turn[first] = 0
    turn = np.cumsum(turn)
    turn -= np.repeat(turn[first], np.diff(first, append=len(axis)))
    cosine, sine = np.cos(turn)[:, None], np.sin(turn)[:, None]
    return cosine * side + sine * up, cosine * up - sine * side


def ball(count, owner, material):
    """A ball of radius 1, the coarser the more of them there are; in the mean its outline is as large as a circle."""
    points, faces = _icosahedron()
    for _ in range(3 if count <= 500 else 2 if count <= 5000 else 1):
        points, faces = _split(points, faces)
    a, b, c = (points[faces[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    corners = faces.ravel().astype(np.int32)
    return {"name": owner, "positions": np.ascontiguousarray(points * np.sqrt(4 * np.pi / area), np.float32),
            "corner_position": corners, "corner_normals": np.ascontiguousarray(points[corners], np.float32),
            "corner_uvs": None, "material": np.full(len(faces), material, np.int32), "layers": []}


def _icosahedron():
    g = (1 + 5**0.5) / 2
    points = np.array([(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
                       (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)])
    faces = np.array([(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                      (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
                      (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)])
    return points / np.linalg.norm(points[0]), faces


def _split(points, faces):
    """Each face in four."""
    a, b, c = faces.T
    pairs = np.sort(np.concatenate([np.stack(p, 1) for p in ((a, b), (b, c), (c, a))]), 1)
    unique, index = np.unique(pairs, axis=0, return_inverse=True)
    ab, bc, ca = (index.ravel() + len(points)).reshape(3, -1)
    points = np.concatenate([points, _unit(points[unique].sum(1))])
    return points, np.concatenate([np.stack(f, 1) for f in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])


def of_points(data):
    """A point cloud's."""
    attributes = data.attributes
    places, radius = attributes.get("position"), attributes.get("radius")
    if not places:
        return Points(np.zeros((0, 3), np.float32), np.zeros(0, np.float32), lambda _name: None)
    points = read(places.data, "vector", 3).reshape(-1, 3)
    radii = read(radius.data, "value", 1) if radius else np.full(len(points), 0.01, np.float32)  # as Cycles
    good = np.isfinite(points).all(1) & np.isfinite(radii) & (radii > 0)

    def told(name):
        numbers = four_of(attributes.get(name) if name else None)
        return None if numbers is None else numbers[good]

    return Points(points[good], radii[good], told)


CURVES = getattr(bpy.types, "Curves", ())
POINTS = getattr(bpy.types, "PointCloud", ())
