# SPDX-License-Identifier: Apache-2.0
"""A jacket of denim; with `near` its pocket, where yarns are seen.

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade --python-exit-code 1 -P make_scene.py -- PICTURE.png [near] [cycles] [SAMPLES]

Its panels (fronts, back, sleeves, bands, collar, flaps) are cut apart, as a tailor does: each has UVs of its own, in
metres, and lies on the body by a function of angle and height.
"""
import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

FRONT, BACK = 0.0, math.pi  # angles about the body; the left arm is at pi / 2
LAP = 0.021  # radians that the left front lies over the right one, on each side of the middle
THREAD = 0.00042  # radius, metres

# Up the body from the hem: half widths, half depths, heights; metres
BODY = np.array([(0.222, 0.128, 0.00), (0.218, 0.126, 0.05), (0.226, 0.132, 0.14), (0.236, 0.136, 0.26), (0.238, 0.134, 0.36),
                 (0.228, 0.125, 0.44), (0.205, 0.112, 0.495), (0.168, 0.099, 0.535), (0.125, 0.088, 0.563), (0.092, 0.081, 0.582),
                 (0.080, 0.078, 0.595)])
# Down the left arm: middles and radii
ARM = np.array([(0.095, 0.01, 0.446, 0.088), (0.150, 0.01, 0.441, 0.09), (0.200, 0.01, 0.425, 0.09), (0.240, 0.012, 0.383, 0.086),
                (0.268, 0.012, 0.32, 0.079), (0.286, 0.006, 0.25, 0.073), (0.295, -0.012, 0.17, 0.067), (0.297, -0.036, 0.09, 0.061),
                (0.293, -0.058, 0.02, 0.055), (0.290, -0.072, -0.03, 0.052)])


def table(rows):
    """A function of 0 to 1 along rows of numbers, by their places, without corners."""
    fine = np.linspace(0, 1, 400)
    at = np.linspace(0, 1, len(rows))
    kernel = np.hanning(41) / np.hanning(41).sum()
    columns = []
    for column in rows.T:
        line = np.interp(fine, at, column)
        ends = np.concatenate([2 * line[0] - line[20:0:-1], line, 2 * line[-1] - line[-2:-22:-1]])
        columns.append(np.convolve(ends, kernel, "valid"))
    return lambda t: [np.interp(t, fine, column) for column in columns]


_body, _arm = table(BODY), table(ARM)


def section(height):
    """Half width and half depth of the body at a height, and where along it that is."""
    t = np.linspace(0, 1, 800)
    a, b, z = _body(t)
    return np.interp(height, z, a), np.interp(height, z, b), np.interp(height, z, t)


def body(angle, t):
    """Points of the body. t: 0 at the hem to 1 at the neck."""
    a, b, z = _body(t)
    low = np.clip((t - 0.6) / 0.4, 0, 1)**2  # the neck is cut lower in front
    cosine, sine = np.cos(angle), np.sin(angle)
    wide = np.sign(sine) * np.abs(sine)**0.92
    return np.stack([a * wide, -b * np.sign(cosine) * np.abs(cosine)**0.88, z - 0.045 * low * np.clip(cosine, 0, 1)**2], -1)


def normals(points):
    across, up = np.gradient(points, axis=1), np.gradient(points, axis=0)
    n = np.cross(across, up)
    return n / np.maximum(np.linalg.norm(n, axis=-1, keepdims=True), 1e-12)


def waves(points, seed, length, turn=0.0, lean=0.6):
    """Folds: crests about `length` apart and several times as long, `turn` from level; -1 to 1."""
    chance = np.random.default_rng(seed)
    x, z = np.arctan2(points[..., 0], -points[..., 1]) * 0.17, points[..., 2]
    total = np.zeros(z.shape)
    for _ in range(9):
        way = turn + chance.normal(0, lean)
        k = 2 * math.pi / (length * chance.uniform(0.7, 1.6))
        warp = 0.6 * np.sin(chance.uniform(9, 20) * x + chance.uniform(9, 20) * z + chance.uniform(0, 6))
        total += 1 - 2 * np.abs(np.sin(0.5 * k * (x * np.sin(way) + z * np.cos(way)) + warp + chance.uniform(0, 6)))**1.3
    return total / 4.5


def folded(points, height):
    return points + normals(points) * height[..., None]


def body_folds(points):
    """Slanting from the arms, level above the waistband, hardly any on the chest."""
    z, side = points[..., 2], np.abs(points[..., 0]) / 0.23
    waist = np.exp(-((z - 0.09) / 0.05)**2)
    armpit = np.exp(-((z - 0.33) / 0.09)**2) * np.clip(side, 0, 1)**3
    back = np.where(points[..., 1] > 0, 0.5, 0.25)
    return (0.0045 * waist * waves(points, 5, 0.035, 0, 0.3) + 0.006 * armpit * waves(points, 7, 0.05, 0.7, 0.4) +
            0.0028 * back * waves(points, 9, 0.13, 0.9, 0.8))


def shell(angles, heights, out=0.0):
    """A grid of the body's surface with its folds; `out` above it. angles: (columns) or (rows, columns)."""
    heights = np.asarray(heights, float)
    angle = np.broadcast_to(angles, (heights.shape[0], np.shape(angles)[-1]))
    t = section(heights)[2] if heights.ndim == 1 else section(heights.ravel())[2].reshape(heights.shape)
    points = body(angle, t[:, None] if t.ndim == 1 else t)
    return folded(points, body_folds(points) + out)


class Jacket:
    """Denim and what holds it together."""

    def __init__(self):
        self.denim = parts.cloth("denim", "DENIM", 1.0)
        self.seams = []  # lines of thread: points, and the side that is up

    def piece(self, name, points, turned=False, thick=0.0011, flip=False):
        """turned: cut across the cloth, so that the warp runs along its rows."""
        mesh = parts.grid(points)
        if flip:
            mesh.flip_normals()
        uv = mesh.uv_layers[0].data
        if turned:
            flat = np.empty(2 * len(uv), np.float32)
            uv.foreach_get("uv", flat)
            uv.foreach_set("uv", np.stack([-flat[1::2], flat[::2]], -1).ravel())
        item = parts.place(name, mesh, self.denim)
        solid = item.modifiers.new("thick", "SOLIDIFY")
        solid.thickness, solid.offset = thick, -1
        return item

    def sew(self, points, row, column=None, lift=0.0012):
        """Along a row of a grid of points, or a column."""
        n = normals(points)
        line, up = (points[row], n[row]) if column is None else (points[:, column], n[:, column])
        self.seams.append((line + lift * up, up))

    def thread(self):
        """All seams: stitches of 3.2 mm, a millimetre apart, four sides each."""
        corners, faces = [], []
        for line, up in self.seams:
            length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
            for start in np.arange(0, length[-1] - 0.0032, 0.0042):
                at = start + np.array([0, 0.0005, 0.0016, 0.0027, 0.0032])
                p = np.stack([np.interp(at, length, line[:, k]) for k in range(3)], -1)
                n = np.stack([np.interp(at, length, up[:, k]) for k in range(3)], -1)
                side = np.cross(p[-1] - p[0], n[0])
                side /= max(np.linalg.norm(side), 1e-9)
                high = np.array([-1.5, 0.2, 0.6, 0.2, -1.5])[:, None] * THREAD
                first = len(corners)
                for angle in np.arange(6) * math.pi / 3:
                    corners.extend(p + n * (high + THREAD * math.sin(angle)) + side * THREAD * math.cos(angle))
                for k in range(6):
                    a, b = first + 5 * k, first + 5 * ((k + 1) % 6)
                    faces.extend((a + j, b + j, b + j + 1, a + j + 1) for j in range(4))
        mesh = bpy.data.meshes.new("thread")
        mesh.from_pydata(np.array(corners).tolist(), [], faces)
        parts.place("thread", mesh, parts.plain("thread", (0.55, 0.25, 0.055), 0.6))


def torso(jacket):
    """Fronts and back, sewn at the sides and the shoulders; a yoke and bands on them."""
    heights = np.concatenate([np.linspace(0.0, 0.49, 150), np.linspace(0.49, 0.594, 70)[1:]])
    for name, start, end, out in (("left front", FRONT - LAP * 2, math.pi / 2, 0.003), ("right front", -math.pi / 2, FRONT + LAP * 2, 0.0),
                                  ("back", math.pi / 2, 3 * math.pi / 2, 0.0)):
        angles = np.linspace(start, end, 240)
        over = out * np.exp(-(np.arange(240) / 60.0)**2)[None, :]
        points = shell(angles, heights, over)
        jacket.piece(name, points)
        if name == "left front":
            jacket.sew(points, None, 17)
        jacket.sew(points, None, 3 if name == "left front" else 6 if name == "back" else -6)
    yoke(jacket)
    band(jacket, "waistband", 0.0, 0.045, 0.004)


def yoke(jacket):
    """Over the chest and the back, one layer more, its lower edge sewn twice."""
    for name, start, end, low, dip in (("yoke left", LAP * 2, 1.45, 0.438, 0.012), ("yoke right", -1.45, -LAP * 2, 0.438, 0.012),
                                       ("yoke back", math.pi - 1.4, math.pi + 1.4, 0.43, -0.03)):
        angles = np.linspace(start, end, 160)
        middle = 1 - np.abs(np.linspace(-1, 1, 160))
        edge = low - dip * (middle if name == "yoke back" else np.abs(np.linspace(-1, 1, 160)))
        heights = edge[None, :] + np.linspace(0, 1, 60)[:, None] * (0.565 - edge[None, :])
        points = shell(angles, heights, 0.0016)
        jacket.piece(name, points)
        jacket.sew(points, 2)
        jacket.sew(points, 5)


def band(jacket, name, low, high, out):
    """Round the hem, cut along the cloth."""
    angles = np.linspace(FRONT - LAP * 2, FRONT + 2 * math.pi + LAP * 2, 700)
    over = out + 0.002 * np.exp(-(np.arange(700) / 40.0)**2)[None, :]
    points = shell(angles, np.linspace(low, high, 30), over)
    jacket.piece(name, points, turned=True, thick=0.003)
    jacket.sew(points, 2)
    jacket.sew(points, -3)


def sleeve(jacket, side):
    """From where it leaves the body to the cuff. side: 1 left, -1 right."""
    around, along = 220, 300
    angle = np.linspace(0, 2 * math.pi, around)
    t = np.linspace(0, 1, 600)
    x, y, z, radius = _arm(t)
    middle = np.stack([x, y, z], -1)
    way = np.gradient(middle, axis=0)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    front = np.array([0, -1.0, 0]) - way * (way @ np.array([0, -1.0, 0]))[:, None]
    front /= np.linalg.norm(front, axis=1, keepdims=True)
    outwards = np.cross(front, way)
    ring = np.cos(angle)[None, :, None] * front[:, None] + np.sin(angle)[None, :, None] * outwards[:, None]
    points = middle[:, None] + radius[:, None, None] * ring
    a, b, _t = section(points[..., 2].ravel())
    inside = ((points[..., 0].ravel() / a)**2 + (points[..., 1].ravel() / b)**2).reshape(points.shape[:2]) < 1.0
    inside &= points[..., 2] < 0.56
    first = np.where(inside.any(0), points.shape[0] - np.argmax(inside[::-1], 0), 0).clip(0, 240).astype(float)
    ends = np.concatenate([first[-30:-1], first, first[1:30]])
    first = np.convolve(ends, np.hanning(31) / np.hanning(31).sum(), "same")[29:29 + around]
    at = (first + np.linspace(0, 1, along)[:, None] * (599 - first)).clip(0, 599)
    low = np.floor(at).astype(int).clip(0, 598)
    part = (at - low)[..., None]
    column = np.arange(around)[None, :]
    cut = points[low, column] * (1 - part) + points[low + 1, column] * part
    # folds: level ones in the bend of the elbow and above the cuff, slanting ones below the shoulder
    local = np.stack([np.cos(angle)[None] * np.ones((along, 1)), np.sin(angle)[None] * np.ones((along, 1)), cut[..., 2]], -1)
    down = at / 599
    bend = np.exp(-((down - 0.60) / 0.13)**2) * (0.55 + 0.45 * np.cos(angle))[None]
    wrist = np.exp(-((down - 0.88) / 0.09)**2)
    top = np.exp(-((down - 0.28) / 0.12)**2) * (0.6 - 0.4 * np.sin(angle))[None]
    pads = np.exp(-np.arange(along) / 4.0)[:, None] * 0.003
    folds = (0.010 * bend * waves(local, 21, 0.075, 0.0, 0.3) + 0.007 * wrist * waves(local, 22, 0.05, 0.0, 0.2) +
             0.006 * top * waves(local, 23, 0.09, 0.6, 0.4) + 0.003 * waves(local, 24, 0.16, 0.4, 0.9))
    folds[:, -1] = folds[:, 0]  # UVs meet in front; both edges fold alike
    blend = np.clip(np.minimum(np.arange(around), around - 1 - np.arange(around)) / 12.0, 0, 1)[None]
    folds = folds * blend + folds[:, :1] * (1 - blend)
    points = folded(cut, -(folds * np.clip((down - 0.12) * 6, 0, 1) + pads))  # normals are those of the right arm
    points[..., 0] *= side
    jacket.piece(f"sleeve {side}", points, flip=side > 0)
    lift = 0.0012 if side < 0 else -0.0012
    for row in (5, 9):
        jacket.sew(points, row, lift=lift)
    cuff(jacket, points, side, lift)


def cuff(jacket, sleeve_points, side, lift):
    """A band over the sleeve's end, cut along the cloth."""
    rows = sleeve_points[-34:]
    centre = rows.mean(1, keepdims=True)
    even = np.linalg.norm(rows - centre, axis=2).mean(1)[:, None, None]
    spread = (rows - centre) / np.linalg.norm(rows - centre, axis=2, keepdims=True)
    points = centre + spread * (even + 0.004)
    jacket.piece(f"cuff {side}", points, turned=True, thick=0.003, flip=side > 0)
    jacket.sew(points, 3, lift=lift)
    jacket.sew(points, -4, lift=lift)
    button(jacket, points[16, 30], spread[16, 30], 0.0078)


def collar(jacket):
    """Stands round the neck, folds over and lies down, its points in front."""
    around = 260
    angle = np.linspace(0.17, 2 * math.pi - 0.17, around)
    ring = body(angle, np.full(around, 0.985))
    outwards = np.stack([np.sin(angle), -np.cos(angle), np.zeros(around)], -1)
    to_front = np.clip(np.cos(angle), 0, 1)**2
    fall = 0.062 + 0.028 * np.clip(np.cos(angle), 0, 1)**6
    rows = []
    for t in np.linspace(0, 1, 70):
        if t < 0.32:  # the stand
            s = t / 0.32
            up, out = 0.032 * s * (1 - 0.45 * to_front), -0.004 * s
        else:
            s = (t - 0.32) / 0.68
            turn = min(s / 0.16, 1.0) * math.pi
            up = 0.032 * (1 - 0.45 * to_front) + 0.005 * math.sin(turn) - np.maximum(s - 0.08, 0) * fall * 0.80
            out = -0.004 + 0.005 * (1 - math.cos(turn)) + np.maximum(s - 0.08, 0) * fall * (0.74 - 0.12 * to_front)
        lift = np.zeros_like(ring)
        lift[:, 2] = up
        ahead = np.zeros_like(ring)
        ahead[:, 0] = np.sign(np.sin(angle)) * np.clip(np.cos(angle), 0, 1)**8 * max(t - 0.4, 0) * 0.05
        rows.append(ring + lift + outwards * np.broadcast_to(out, (around,))[:, None] + ahead)
    points = np.array(rows)
    jacket.piece("collar", points, turned=True, thick=0.0018)
    jacket.sew(points, -3, lift=0.0014)
    for column in (3, -4):
        jacket.sew(points[24:], None, column, lift=0.0014)


def pocket(jacket, side):
    """A patch on the chest and its flap, pointed below, with a button."""
    middle, half = 0.66 * side, 0.27
    across = np.linspace(-1, 1, 120)
    angles = middle + half * across
    for name, top, deep, point, out in (("pocket", 0.432, 0.12, 0.016, 0.003), ("flap", 0.44, 0.036, 0.018, 0.0058)):
        edge = top - deep - point * (1 - np.abs(across))
        heights = edge[None, :] + np.linspace(0, 1, 70)[:, None] * (top - edge[None, :])
        points = shell(angles, heights, out)
        jacket.piece(f"{name} {side}", points, thick=0.0016)
        for row in (3, 6):
            jacket.sew(points, row)
        for column in (2, 5, -3, -6):
            jacket.sew(points, None, column)
    n = normals(points)
    button(jacket, points[14, 60], n[14, 60], 0.0082)
    for lean in (0.24, -0.19):  # two seams from the pocket to the waist
        start = middle + 0.8 * lean
        heights = np.linspace(0.318, 0.05, 220)
        line = np.linspace(start, start - 0.35 * lean, 220)
        strip = np.stack([shell(np.array([a - 0.02, a, a + 0.02]), np.array([h, h + 0.001]), 0.0006)[0] for a, h in zip(line, heights)])
        for k in (0, 2):
            ups = np.cross(strip[:, 2] - strip[:, 0], np.gradient(strip[:, 1], axis=0))
            ups /= np.linalg.norm(ups, axis=1, keepdims=True)
            ups *= np.sign((ups * strip[:, 1] * [1, 1, 0]).sum(1, keepdims=True))
            place = strip[:, 1] + (strip[:, 2 * (k > 0)] - strip[:, 1]) * 0.55
            jacket.seams.append((place + 0.0008 * ups, ups))


def button(jacket, at, up, radius):
    """Copper, with a rim and a dent."""
    profile = np.array([(0.0, 0.0026), (0.45, 0.0026), (0.6, 0.0030), (0.72, 0.0041), (0.9, 0.0042), (1.0, 0.0034), (1.0, 0.0012), (0.5, 0.0)])
    profile[:, 0] *= radius
    profile = parts.rounded(profile, 0.0006, 5)[::-1]
    mesh = parts.turned([(max(r, 1e-5), h) for r, h in profile], 64)
    item = parts.place("button", mesh, jacket.copper)
    item.rotation_euler = Vector(up).to_track_quat("Z", "Y").to_euler()
    item.location = np.asarray(at) + 0.0005 * np.asarray(up)


def build(near):
    parts.begin()
    jacket = Jacket()
    jacket.copper = parts.metal("copper", (0.72, 0.36, 0.2), 0.28, 0.3, "RADIAL_Z")
    torso(jacket)
    collar(jacket)
    for side in (1, -1):
        sleeve(jacket, side)
        pocket(jacket, side)
    front = shell(np.array([-0.02, 0.0, 0.02]), np.linspace(0.02, 0.5, 7), 0.0042)
    n = normals(front)
    for row in range(7):
        button(jacket, front[row, 1], n[row, 1], 0.0088)
    jacket.thread()
    bpy.ops.mesh.primitive_plane_add(size=30, location=(0, 1.5, 0), rotation=(1.35, 0, 0))
    bpy.context.object.data.materials.append(parts.plain("wall", (0.30, 0.28, 0.26), 0.8))
    parts.sky("interior", 0.35, 0.4, (0.3, 0.28, 0.26))
    parts.lamp(48, (-1.6, -1.5, 1.4), (0, 0, 0.3), 0.6, (1, 0.96, 0.9))
    parts.lamp(14, (1.8, -0.6, 0.7), (0, 0, 0.3), 0.5, (0.88, 0.94, 1))
    if near:
        parts.camera((0.155, -0.34, 0.45), (0.125, -0.1, 0.395), 85, 16, (0.12, -0.118, 0.40))
    else:
        parts.camera((0.55, -2.3, 0.42), (0.0, 0.0, 0.268), 88)


if __name__ == "__main__":
    close = "near" in sys.argv
    if close:
        sys.argv.remove("near")
    parts.main(lambda: build(close), 960, 776, 128)
