# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender: what examples/povray/NAME/NAME.pov shows, as povray_common.py leaves it, of meshes.

    blender -b --factory-startup --addons libshade --python-exit-code 9 -P povray_twins.py -- NAME FOLDER

FOLDER gets scene.blend, and has basket.png of `embossed`. Sizes, places and colours are those of the example's text.
"""
import math
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import povray_common  # noqa: E402
import povray_shapes as shapes  # noqa: E402
import twin_scenes  # noqa: E402
from libshade import nodes  # noqa: E402
from povray_shapes import box, lathe, place, plane, round_, sphere, superellipsoid, torus  # noqa: E402

BLACK = (0.0, 0.0, 0.0)
# Exponents of presets without their scratches, which Blender's node has in its lobe (`shade presets NAME`)
LOBES = {"brushed": (798, 76), "turned": (1248, 245), "scratched": (1600, 1600)}


# ---- materials


def metal(color, grain="UV", turn=0.0, preset=None, **settings):
    """`mdf { … }`; what is not said is as a block has it."""
    made, node = twin_scenes.shader(preset or "metal", "LibshadeMetalNode")
    if preset:
        nodes.apply_preset(node, preset.upper())
        node.groove, (node.ex, node.ey) = "AUTO", LOBES[preset.split("_")[0]]
    else:
        node.fresnel = "SCHLICK"
        node.inputs["Color"].default_value = (*color, 1)
    for word, value in settings.items():
        setattr(node, word, value)
    node.grain, node.strokes = grain, 0.0
    node.inputs["Rotation"].default_value = turn
    return made


def around(color=None, preset=None, **settings):
    """Strokes round y: by POV-Ray's formula, whose world is mirrored, the other way."""
    return metal(color, "RADIAL_Z", 0.5, preset, **settings)


def ggx(color, ax, ay, **settings):
    return {"color": color, "distribution": "GGX", "ax": ax, "ay": ay, **settings}


def matt(color):
    return metal(BLACK, fresnel="NONE", diffuse="LAMBERT", kd=np.broadcast_to(color, 3).tolist())


def cloth(preset, mm_per_unit=200):
    made, node = twin_scenes.shader(preset, "LibshadeFabricNode")
    node.preset, node.size_mode, node.size = preset.upper(), "LENGTH", mm_per_unit / 1000
    return made


def bumped(made, folder, file, repeats, strength):
    """`bump_image { … scale 1/repeats }`."""
    tree = made.node_tree
    node = next(node for node in tree.nodes if node.bl_idname == "LibshadeMetalNode")
    spot, mapping, texture, bump = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("UVMap", "Mapping", "TexImage", "NormalMap"))
    texture.image = bpy.data.images.load(os.path.join(folder, file), check_existing=True)
    texture.image.colorspace_settings.name = "Non-Color"
    mapping.inputs["Scale"].default_value = (*repeats, 1)
    bump.inputs["Strength"].default_value = strength
    for source, target in ((spot.outputs[0], mapping.inputs["Vector"]), (mapping.outputs[0], texture.inputs["Vector"]),
                           (texture.outputs["Color"], bump.inputs["Color"]), (bump.outputs["Normal"], node.inputs["Normal"])):
        tree.links.new(source, target)
    return made


# ---- the examples


def sky():
    for at, color in povray_common.SKY:
        shapes.sun(at, color)


def metals(_folder):
    shapes.camera((0, 3.2, -9), (0, 0.85, 0), 52, 2)
    for at, color in (((-6, 8, -6), 0.6), ((7, 5, -4), (0.35, 0.4, 0.5)), ((2, 9, 6), 0.55)):
        shapes.sun(at, color)
    place("sphere", sphere(), metal((0.95, 0.64, 0.54), ex=120, ey=3), ("rotate", (0, 0, -15)), ("translate", (-2.7, 1, 0)))
    place("torus", torus(0.85, 0.38), metal((1.0, 0.78, 0.34), ex=200, ey=4), ("rotate", (-60, 0, 0)), ("translate", (0, 1.15, 0)))
    place("box", box((-0.8,) * 3, (0.8,) * 3), metal((0.46, 0.45, 0.44), "AXIS_X", ex=300, ey=3), ("rotate", (0, 46, 0)),
          ("translate", (2.7, 0.8, 0)))
    place("floor", plane((-60, -12), (60, 40)), matt(0.108))


def turned(_folder):
    shapes.camera((0, 4.4, -9), (0, 0.75, 0), 44, 2)
    for at, color in (((-6, 8, -6), 0.6), ((6, 7, -5), (0.35, 0.4, 0.5)), ((1, 9, 7), 0.6)):
        shapes.sun(at, color)
    steel = {"color": (0.56, 0.55, 0.53), "ex": 250, "ey": 4, "diffuse": "LAMBERT", "kd": (0.03,) * 3}
    place("lid", round_(0, 0.5, 1.25, 1.25), around(**steel), ("rotate", (-14, 0, -8)), ("translate", (-2.75, 0.45, 0.2)))
    upright = metal(grain="AXIS_Z", **steel)
    ends = np.array([(-0.5, 0.8, 0), (0.6, 0.55, -0.35)])
    for at, radius in zip(ends, (0.8, 0.55)):
        ball = sphere(radius)
        place("ball", shapes.Piece(ball.points + at, ball.normals, ball.uv, ball.faces), upright)
    place("bar", bar(*ends, 0.3), upright)
    gold = {**steel, "color": (1.0, 0.78, 0.34)}
    place("ring", torus(0.8, 0.28), metal(**gold), ("rotate", (-24, 0, 0)), ("translate", (2.7, 0.6, 0.5)))
    place("small ring", torus(0.38, 0.17), metal(turn=0.75, **gold), ("rotate", (-24, 0, 0)), ("translate", (2.7, 0.75, 0.35)))
    place("floor", plane((-60, -12), (60, 40)), matt((0.18, 0.19, 0.21)))


def bar(start, end, radius):
    """A cylinder between two points."""
    length = np.linalg.norm(end - start)
    y = (end - start) / length
    x = np.cross(y, (0.0, 1.0, 0.3))
    x /= np.linalg.norm(x)
    turn = np.stack([x, y, np.cross(x, y)])
    made = round_(0, length, radius, radius)
    return shapes.Piece(made.points @ turn + start, made.normals @ turn, made.uv, made.faces)


def embossed(folder):
    shapes.camera((0, 2.3, -5.4), (0, 0.75, 0), 52, 16 / 9)
    shapes.sun((-5, 6, -4), 0.6)

    def look(color, repeats, strength=1.0):
        return bumped(metal(**ggx(color, 0.07, 0.25)), folder, "basket.png", repeats, strength)

    fine = 512  # the map has edges, beside which 1e-5 of UV coordinates meets another slope
    place("sphere", sphere(0.85, fine), look((0.93, 0.62, 0.48), (6, 3)), ("rotate", (-15, 30, 0)), ("translate", (-1.9, 0.85, 0.3)))
    place("torus", torus(0.62, 0.3, fine), look((0.95, 0.79, 0.45), (6, 3)), ("rotate", (-60, 0, 10)), ("translate", (0.15, 0.78, 0)))
    tumbler = ((0, -0.2), (0.05, 0), (0.55, 0.02), (0.62, 0.5), (0.72, 1.5), (0.70, 1.52), (0.5, 1.3))
    place("tumbler", lathe(tumbler, 96, fine), look((0.62, 0.61, 0.60), (4, 2.5)), ("translate", (2.05, 0, 0.2)))
    floor = plane((-20, -6), (20, 34))
    floor.uv = floor.uv + (20, 6)
    place("floor", floor, look((0.50, 0.50, 0.51), (1, 1), 0.6))


def scratches(_folder):
    shapes.camera((0, 2.1, -5.6), (0, 0.5, 0), 58, 16 / 9)
    shapes.sun((-6, 8, -6), 0.7)
    sky()
    place("sphere", sphere(0.8), metal(None, preset="brushed_steel"), ("translate", (-2.1, 0.8, 0)))
    place("box", box((-0.65, 0, -0.5), (0.65, 1.1, 0.5)), metal(None, preset="brushed_brass"), ("rotate", (0, 25, 0)))
    place("cylinder", round_(0, 1.2, 0.65, 0.65), metal(None, preset="scratched_copper"), ("translate", (2.1, 0, 0)))
    place("plane", plane((-60, -12), (60, 40)), metal(None, preset="scratched_aluminium"))


def inlay(_folder):
    shapes.camera((0, 3.9, -6.4), (0.05, 0.5, 0), 55, 16 / 9)
    shapes.sun((-5, 7, -3), 0.5)
    sky()
    place("inlaid", superellipsoid(0.12, 0.12), metal(grain="AXIS_X", **ggx((0.56, 0.55, 0.53), 0.06, 0.25)),
          ("scale", (1.05, 0.3, 1.05)), ("rotate", (0, 28, 0)), ("translate", (-2.35, 0.3, 0.2)))
    place("damascene", sphere(0.95), metal(**ggx((0.5, 0.5, 0.5), 0.05, 0.22)), ("translate", (0.05, 0.95, 0.3)))
    coin, at = around(**ggx((0.95, 0.6, 0.46), 0.05, 0.28)), (("rotate", (-24, 0, -10)), ("translate", (2.4, 0.55, 0.3)))
    place("coin", round_(0, 0.16, 1.1, 1.1), coin, *at)
    place("rim", torus(1.06, 0.09), coin, ("translate", (0, 0.13, 0)), *at)
    place("sheet", plane((-60, -12), (60, 40)), metal(grain="AXIS_Y", **ggx((0.56, 0.52, 0.42), 0.09, 0.3)))


def reflection(_folder):
    shapes.camera((0, 2.6, -7), (0, 0.75, 0), 44, 2)
    shapes.sun((-5, 8, -6), 1.0)
    sky()
    place("ground", box((-7, -0.2, -3), (7, 0, 4)), metal(grain="AXIS_X", **ggx((0.56, 0.55, 0.53), 0.03, 0.25)))
    place("cylinder", round_(0, 1.5, 0.7, 0.7), around(**ggx((0.95, 0.79, 0.48), 0.06, 0.3)), ("translate", (-1.9, 0, 0.2)))
    place("sphere", sphere(0.85), metal(**ggx((0.93, 0.6, 0.47), 0.05, 0.3)), ("translate", (0, 0.85, 0)))
    place("box", box((-0.6, 0, -0.6), (0.6, 1.2, 0.6)), matt((0.7, 0.12, 0.08)), ("rotate", (0, 35, 0)), ("translate", (1.95, 0, 0.3)))


CLOTHS = ("silk_charmeuse", "silk_shantung", "denim", "gabardine", "linen", "wool_flannel", "polyester_lining", "shot_taffeta",
          "herringbone_tweed")


def presets(_folder):
    shapes.camera((0, 3.6, -17), (0, 2.62, 0), 45, 16 / 9)
    shapes.sun((-5, 8, -6), 1.0)
    kinds = [f"{how}_{what}" for how, order in (("brushed", 0), ("turned", 1), ("scratched", 1)) for what in (
        ("steel", "aluminium", "titanium", "brass", "copper", "gold"))]
    ball, first = sphere(0.62), None
    looks = [cloth(name) for name in CLOTHS]
    looks += [(around if name.startswith("turned") else metal)(None, preset=name) for name in kinds]
    for number, look in enumerate(looks):
        row, column = divmod(number, 9)
        first = place("ball", ball, look, ("rotate", (-70, 20, 0)), (
            "translate", (1.5 * (column - 4), 0.62 + 2.05 * row, 0.6 * row)), like=first)
    wood = matt(0.245)
    for row in range(3):
        place("shelf", box((-7.2, 2.05 * row - 0.12, 0.6 * row - 0.8), (7.2, 2.05 * row, 0.6 * row + 0.8)), wood)
    place("ground", box((-12, -0.12, -12), (12, -0.1, 3)), wood)
    place("wall", box((-12, -1, 2.6), (12, 9, 2.7)), matt((0.21, 0.19, 0.17)))


def by_facing(piece):
    """Cloth on what has no UV coordinates: along those two axes that a face looks along least."""
    corners, normals = piece.points[piece.faces], piece.normals[piece.faces]
    up = np.abs(normals.sum(1)).argmax(1)
    first, second = np.where(up == 0, 2, 0), np.where(up == 1, 2, 1)
    rows = np.arange(len(up))[:, None]
    uv = np.stack([corners[rows, range(4), axis[:, None]] for axis in (first, second)], -1)
    return shapes.Piece(piece.points, piece.normals, uv, piece.faces)


def cloth_table(_folder):
    shapes.camera((0, 2.6, -6.4), (0, 0.8, 0), 50, 16 / 9)
    shapes.sun((-5, 8, -5), 1.15)
    shapes.sun((7, 4, -4), (0.28, 0.33, 0.42))
    place("table", plane((-40, -7), (40, 40)), cloth("linen", 180))
    place("silk", sphere(0.8), cloth("silk_charmeuse"), ("rotate", (0, 40, -20)), ("translate", (-2.1, 0.8, 0.2)))
    place("denim", sphere(0.8), cloth("denim", 300), ("rotate", (20, 0, 0)), ("translate", (0.1, 0.8, -0.5)))
    place("cushion", by_facing(superellipsoid(0.8, 0.45)), cloth("herringbone_tweed", 70), ("scale", (0.8, 0.8, 0.5)),
          ("rotate", (-22, -25, 0)), ("translate", (2.1, 0.78, 0.4)))


def lampshade(_folder):
    shapes.camera((0, 1.9, -7.5), (0, 1.75, 0), 40, 16 / 9)
    shapes.bulb((-0.8, 2.25, 0), np.array((1, 0.78, 0.5)) * 5e6, 0.001)
    shapes.sun((5, 5, -6), (0.5, 0.58, 0.75))
    shade = round_(1.6, 2.9, 1.05, 0.62, ends=False)
    # POV-Ray counts u from -1/2 to 1/2, here the half that is seen, and v from the cone's tip, where it is 0, to its foot
    shade.uv = np.stack([shade.uv[:, 0] - 1, shade.uv[:, 1] * (1 - 0.62 / 1.05) - 1], -1)
    place("shade", shade, cloth("linen", 900), ("translate", (-0.8, 0, 0)))
    foot = ((0.7, -0.1), (0.68, 0), (0.62, 0.09), (0.3, 0.16), (0.09, 0.35), (0.07, 0.7), (0.16, 0.85), (0.07, 1), (0.06, 1.5),
            (0.05, 1.9), (0.04, 2.1))
    place("foot", lathe(foot), around(preset="turned_brass"), ("translate", (-0.8, 0, 0)))
    place("curtain", curtain(240, 2.6), cloth("shot_taffeta", 1200))
    place("floor", plane((-40, -8), (40, 8)), metal(grain="AXIS_X", diffuse="LAMBERT", kd=(0.13, 0.07, 0.035),
                                                    **ggx((0.05,) * 3, 0.12, 0.04)))


def curtain(across, wide, parts=12):
    """The example's own triangles, each in parts: POV-Ray interpolates normals before a scale of x, Blender after it."""
    def fold(u):
        return shapes.stack(4.6 * (u - 0.5), 0, 1.55 + 0.16 * np.sin(44 * u + 1.5 * np.sin(9 * u)) + 0.05 * np.sin(101 * u))

    u = np.arange(across + 1) / across
    normals = np.cross((0.0, 1.0, 0.0), fold(u + 1e-3) - fold(u - 1e-3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    fine = np.linspace(0, 1, parts * across + 1)
    points, normals = (np.stack([np.interp(fine, u, column) for column in rows.T], -1) for rows in (fold(u), normals))
    normals = normals / (wide, 1.0, 1.0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = [shapes.Piece(points * (wide, 1, 1) + (0, height, 0), normals, shapes.stack(2 * fine, v, 0)[:, :2], np.empty((0, 4), int))
            for height, v in ((-0.3, 0.0), (4.0, 1.0))]
    made = rows[0] + rows[1]
    made.faces = shapes.quads(2, len(fine))
    return made


def kitchen(_folder):
    shapes.camera((0.5, 3.6, -7.2), (0.35, 0.55, -0.1), 52, 16 / 9)
    shapes.sun((-5, 8, -6), 1.0)
    sky()
    faced, belted, brass = around(preset="turned_steel"), around(preset="brushed_steel"), around(preset="turned_brass")
    pot = (("rotate", (0, 35, 0)), ("translate", (-1.35, 0, 0.5)))
    place("side", round_(0, 1.3, 1.25, 1.25), belted, *pot)
    place("rim", round_(1.3, 1.36, 1.3, 1.3), faced, *pot)
    place("lid", sphere(1.28), faced, ("scale", (1, 0.16, 1)), ("translate", (0, 1.36, 0)), *pot)
    place("knob", sphere(0.22), brass, ("scale", (1, 0.8, 1)), ("translate", (0, 1.78, 0)), *pot)
    place("stem", round_(1.5, 1.7, 0.09, 0.09), brass, *pot)
    steel = metal(None, preset="brushed_steel")
    for side in (-1, 1):
        place("handle", torus(0.3, 0.06), steel, ("translate", (1.42 * side, 1, 0)), *pot)
    knife = (("rotate", (0, -24, 0)), ("translate", (1.3, 0.04, -1.75)))
    blade = cut(box((-1.7, 0, -0.16), (0.9, 0.05, 0.3)), ((-0.45, 0, 0.6), 0.55), ((0, 1, -0.13), 0.035))
    place("blade", blade, metal(None, "AXIS_Y", preset="brushed_steel"), *knife)
    place("grip", box((0.9, -0.02, -0.16), (2.1, 0.1, 0.1)), metal(grain="AXIS_X", diffuse="LAMBERT", kd=(0.055, 0.03, 0.02),
                                                                   **ggx((0.04,) * 3, 0.25, 0.12)), *knife)
    for number in range(3):
        x = 1.15 + 0.35 * number
        place("rivet", round_(0.09, 0.106, 0.045, 0.045), brass, ("translate", (x, 0, -0.03)), *knife)
    bowl = ((0, 0.03), (0.05, 0.02), (0.6, 0.06), (1.0, 0.42), (1.12, 0.78), (1.08, 0.78), (0.95, 0.45), (0.5, 0.1))
    place("bowl", lathe(bowl), around(preset="turned_copper"), ("translate", (2.05, 0, 0.55)))
    place("table", plane((-60, -8), (60, 40)), cloth("linen", 60))


def cut(piece, *planes):
    """What lies below each plane, (normal, distance), of a convex body of flat faces, which keep their UVs."""
    polygons = [(list(np.concatenate([piece.points[face], piece.uv[face]], 1)), piece.normals[face[0]]) for face in piece.faces]
    for normal, distance in planes:
        normal = np.asarray(normal, float) / np.linalg.norm(normal)
        kept, edge = [], []
        for points, facing in polygons:
            inside = []
            for a, b in zip(points, points[1:] + points[:1]):
                da, db = np.dot(a[:3], normal) - distance, np.dot(b[:3], normal) - distance
                inside += [a] if da <= 0 else []
                if da * db < 0:
                    inside.append(a + (b - a) * da / (da - db))
                    edge.append(inside[-1][:3])
            if len(inside) > 2:
                kept.append((inside, facing))
        if len(edge) > 2:
            middle = np.mean(edge, axis=0)
            x = edge[0] - middle
            y = np.cross(normal, x)
            edge.sort(key=lambda p: math.atan2(np.dot(p - middle, y), np.dot(p - middle, x)))
            kept.append(([np.array([*p, p[0], p[2]]) for p in edge], normal))
        polygons = kept
    triangles = [(np.array([points[0], points[k], points[k + 1]]), facing) for points, facing in polygons
                 for k in range(1, len(points) - 1)]
    points = np.concatenate([corners for corners, _ in triangles])
    normals = np.repeat([facing for _, facing in triangles], 3, axis=0)
    return shapes.Piece(points[:, :3], normals, points[:, 3:], np.arange(len(points)).reshape(-1, 3))


SCENES = {"metals": metals, "turned": turned, "embossed": embossed, "scratches": scratches, "inlay": inlay,
          "reflection": reflection, "presets": presets, "cloth": cloth_table, "lampshade": lampshade, "kitchen": kitchen}


def main(name, folder):
    twin_scenes.begin()
    SCENES[name](folder)
    twin_scenes.save(folder, povray_common.BACKGROUND)


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1:])
