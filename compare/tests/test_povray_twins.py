# SPDX-License-Identifier: Apache-2.0
"""Meshes that stand for POV-Ray's examples: each shape, place, camera, lamp and metal is that of the example's own text, read here."""
import re
from types import SimpleNamespace

import fake_blender
import numpy as np
import povray_common
import pytest
import study_consistency

COST = 1.8

EXAMPLES = {path.stem: path for path in study_consistency.POVRAY}
AXES = dict(zip("xyz", np.eye(3)))
GROUPS = ("union", "difference", "intersection")
OWN = {  # what single twins leave out
    "preset metals without their scratches": "scratches presets kitchen lampshade", "the table cloth in its preset's colours, not turned": "cloth kitchen", "the map's filter": "embossed",
    "patterns of pigments: each metal has one colour": "inlay", "the checkered box in one matt colour": "reflection", "the net, whose yarns are no preset's": "cloth",
    "a lamp without shadows as one with them": "cloth", "the shade's own yarns, which let light through: preset linen": "lampshade"}
SHAPES = "sphere torus box cylinder cone plane superellipsoid lathe bicubic_patch"


@pytest.fixture(scope="module")
def modules():
    """(bpy, twin_scenes, povray_shapes, povray_twins), their meshes coarse."""
    with fake_blender.imported("twin_scenes", "povray_shapes", "povray_twins") as (bpy, scenes, shapes, twins):
        shapes.FINE = 12
        twins.sphere, twins.torus = (lambda r=1.0, fine=0: shapes.sphere(r, 12)), (lambda a, b, fine=0: shapes.torus(a, b, 12))
        twins.lathe, twins.superellipsoid = (lambda points, *_fine: shapes.lathe(points, 6, 12)), (lambda a, b: shapes.superellipsoid(a, b, 12))
        yield bpy, scenes, shapes, twins


# ---- POV-Ray's language, as far as the examples need it


def values(text):
    """Numbers and vectors of a list of expressions."""
    said = re.sub("<([^<>]*)>", r"V(\1)", " ".join(text.split()))
    return eval(f"[{said}]", {"V": lambda *parts: np.array(parts, float), **AXES})  # noqa: S307


def arguments(text, start):
    """Of a call whose parenthesis begins there, and the end."""
    depth, parts = 0, [""]
    for at in range(start, len(text)):
        depth += {"(": 1, "<": 1, "{": 1, ")": -1, ">": -1, "}": -1}.get(text[at], 0)
        if not depth:
            return [part.strip() for part in parts], at + 1
        if depth == 1 and text[at] == ",":
            parts.append("")
        elif depth > 1 or text[at] != "(":
            parts[-1] += text[at]


def spelt_out(text):
    """Without directives: loops, macros, arrays and declarations are what they stand for."""
    text, _count = povray_common.without(re.sub(r"#ifndef.*?#end", "", text, flags=re.S), r"\bmesh2")
    text = re.sub(r"\bMDF_[FT]_(Brushed|Turned|Scratched)_(\w+)", lambda m: f'mdf {{ preset "{m[1].lower()}_{m[2].lower()}"' + " tangent radial y }" * (m[1] == "Turned") + " }" * (m[1] != "Turned"), text)
    text = re.sub(r"\bMDF_[FT]_(\w+)", lambda m: f'fabric {{ preset "{m[1].lower()}" mm_per_unit 200 }}', text)
    macros = re.findall(r"#macro (\w+)\(([\w, ]*)\)(.*?)#end", text, re.S)
    text = re.sub(r"#macro.*?#end", "", text, flags=re.S)
    loop = re.compile(r"#for \((\w+), (-?\d+), (\d+)(?:, (\d+))?\)((?:(?!#for|#end).)*)#end", re.S)
    while loop.search(text):
        text = loop.sub(lambda m: " ".join(re.sub(rf"\b{m[1]}\b", str(k), m[5]) for k in range(int(m[2]), int(m[3]) + 1, int(m[4] or 1))), text)
    arrays = {name: arguments(text, text.index("{", text.index(f"#local {name}")))[0] for name in re.findall(r"#local (\w+) = array", text)}
    text = re.sub(r"#local \w+ = array.*?\n}", "", text, flags=re.S)
    for name, names, body in macros:
        while (call := re.search(rf"\b{name}\(", text)):
            given, end = arguments(text, call.end() - 1)
            made = body
            for parameter, value in zip(names.split(", "), given):
                made = re.sub(rf"\b{parameter}\b", lambda _m, value=value: value, made)
            text = text[:call.start()] + made + text[end:]
    for name, listed in arrays.items():
        text = re.sub(rf"\b{name}\[([^]]*)\]", lambda m, listed=listed: listed[int(values(m[1])[0])].lstrip("{").rstrip("}") + "}", text)
    while (said := re.search(r"#declare (\w+) = (?:(?:texture|finish)\s*{|([^;]*);)", text)):
        end = said.end() if said[2] else povray_common.end_of(text, said.start())
        value = said[2] or text[text.index("=", said.start()) + 1:end]
        text = re.sub(rf"\b{said[1]}\b", lambda _m, value=value: value, text[:said.start()] + text[end:])
    return text


def bare(text):
    """Without blocks."""
    while re.search(r"\w+\s*{[^{}]*}", text):
        text = re.sub(r"\w+\s*{[^{}]*}", " ", text)
    return text


def turned(text):
    """The matrix of a statement's transformations, in their order."""
    matrix = np.eye(4)
    for word, by in re.findall(r"\b(rotate|translate|scale)\s+(<[^>]*>|[-\w.*()+ ]*?[xyz]\b)", bare(text)):
        by, step = values(by)[0], np.eye(4)
        if word == "translate":
            step[:3, 3] = by
        elif word == "scale":
            step[:3, :3] = np.diag(by)
        else:
            for axis, angle in zip(range(3), np.radians(by)):
                a, b, turn = (axis + 1) % 3, (axis + 2) % 3, np.eye(4)
                turn[[a, b], [a, b]], turn[a, b], turn[b, a] = np.cos(angle), -np.sin(angle), np.sin(angle)
                step = turn @ step
        matrix = step @ matrix
    return matrix


def objects(text, outer="", above=None):
    """(shape, its arguments, matrix, text with that of what holds it) of all that is seen."""
    found, at = [], 0
    above = np.eye(4) if above is None else above
    while (head := re.compile(rf"\b({'|'.join([*SHAPES.split(), *GROUPS])})\s*{{").search(text, at)):
        at = povray_common.end_of(text, head.start())
        body = text[head.end():at - 1]
        if head[1] in GROUPS:
            inner = objects(body, outer + bare_of_objects(body), above @ turned(body))
            found += inner if head[1] == "union" else inner[:1] if head[1] == "difference" else [("cut", inner, inner[0][2], inner[0][3])]
        elif head[1] in SHAPES:
            said = re.split(r"\b(?:rotate|translate|scale|open)\b", re.sub(r"cubic_spline \d+,|type[^<]*uv_vectors[^\n]*\n", "", bare(body)))[0]
            found.append((head[1], values(re.sub(r">\s*<", ">, <", said)), above @ turned(body), outer + body))
    return found


def bare_of_objects(body):
    for word in (*SHAPES.split(), *GROUPS):
        body, _count = povray_common.without(body, rf"\b{word}")
    return body


def outside(kind, given, p):
    """How far points lie outside of a shape, 0 on it."""
    x, y, z = p.T
    if kind == "sphere":
        return np.linalg.norm(p - given[0], axis=1) - given[1]
    if kind == "torus":
        return np.hypot(np.hypot(x, z) - given[0], y) - given[1]
    if kind == "box":
        low, high = (np.broadcast_to(v, 3) for v in given)
        return (np.abs(p - (low + high) / 2) - (high - low) / 2).max(1)
    if kind in ("cylinder", "cone"):
        start, first, end, last = given if kind == "cone" else (given[0], given[2], given[1], given[2])
        start, along = np.broadcast_to(start, 3), np.subtract(end, start)
        length = np.linalg.norm(along)
        t = (p - start) @ along / length
        aside = np.linalg.norm(p - start - np.outer(t, along / length), axis=1) - (first + (last - first) * t / length)
        return aside if kind == "cone" else np.maximum(aside, np.abs(t - length / 2) - length / 2)
    if kind == "plane":
        return p @ given[0] / np.linalg.norm(given[0]) - given[1]
    if kind == "superellipsoid":
        e, n = given[0]
        return (np.abs(x)**(2 / e) + np.abs(y)**(2 / e))**(e / n) + np.abs(z)**(2 / n) - 1
    if kind == "cut":
        return np.max([outside(one, said, p) for one, said, *_ in given], 0)
    if kind == "bicubic_patch":
        return y
    corners, t = np.array(given), np.linspace(0, 1, 301)[:, None]  # a spline through its inner points, its slopes those of the points beside
    curve = np.concatenate([(2 * t**3 - 3 * t**2 + 1) * b + (t**3 - 2 * t**2 + t) * (c - a) / 2 + (3 * t**2 - 2 * t**3) * c + (t**3 - t**2) * (d - b) / 2
                            for a, b, c, d in zip(corners, corners[1:], corners[2:], corners[3:])])
    return np.abs(np.unique(np.stack([np.hypot(x, z), y], 1).round(9), axis=0)[:, None] - curve).max(2).min(1)


def extent(kind, given):
    """Of a shape before it is turned, or None."""
    if kind == "sphere":
        return np.broadcast_to(given[0], 3) - given[1], np.broadcast_to(given[0], 3) + given[1]
    if kind == "torus":
        size = np.array([sum(given), given[1], sum(given)])
        return -size, size
    if kind == "box":
        return tuple(np.broadcast_to(v, 3) for v in given)
    if kind == "superellipsoid":
        return -np.ones(3), np.ones(3)
    if kind == "bicubic_patch":
        return np.min(given, 0), np.max(given, 0)
    return None


def shown(name, modules, monkeypatch):
    """(what is placed, cameras, suns, bulbs) of a twin's scene."""
    _bpy, scenes, shapes, twins = modules
    made = SimpleNamespace(placed=[], camera=[], sun=[], bulb=[])

    def shader(name, kind):
        material = SimpleNamespace(name=name, kind=kind, inputs={"Color": SimpleNamespace(default_value=None), "Rotation": SimpleNamespace(default_value=None)})
        return material, material
    monkeypatch.setattr(scenes, "shader", shader)
    monkeypatch.setattr(twins, "bumped", lambda look, folder, *how: SimpleNamespace(**{**vars(look), "bump": how}))
    monkeypatch.setattr(twins, "place", lambda name, piece, look, *steps, like=None: made.placed.append((name, piece, look, shapes.moved(*steps))))
    for word in ("camera", "sun", "bulb"):
        monkeypatch.setattr(shapes, word, lambda *said, word=word: getattr(made, word).append(said))
    twins.SCENES[name]("")
    return made


def metal_said(text):
    """What a block says of its metal: (words of the lobe, colour, tangent, preset, matt colour)."""
    last = lambda pattern: (re.findall(pattern, text) or [None])[-1]
    numbers = lambda said: None if said is None else np.broadcast_to(values(said)[0], 3).tolist()
    lobe = last(r"\b(ggx|ashikhmin_shirley|roughness) ([-\d./]+, [-\d./]+)")
    colour = r"(?:rgb )?(<[^>]*>|[\d.]+)"
    lean = {said: f"AXIS_{'xzy'['xyz'.index(axis)].upper()}" for axis, said in povray_common.LEAN.items()}
    lean["<1, -1e-3, 1e-6>"] = "AXIS_Z"  # of a texture that is turned by 90° about z
    tangent = last(r"\btangent (uv|radial y|<[^>]*>)")
    return (lobe and (lobe[0], values(lobe[1])), numbers(last(rf"\bspecular {colour}")), {None: "UV", "uv": "UV", "radial y": "RADIAL_Z"}.get(tangent) or lean[tangent],
            last(r'preset "(\w+)"'), numbers(last(rf"\bdiffuse lambert {colour}")))


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_twin_is_what_the_example_says(name, modules, monkeypatch):
    text, left_out = povray_common.common(name, EXAMPLES[name].read_text(encoding="utf-8"))
    assert [words for words in OWN if words in left_out] == [words for words, names in OWN.items() if name in names.split()]
    made, plain = shown(name, modules, monkeypatch), spelt_out(text)
    said = objects(plain)
    left = dict(enumerate(said))
    for part, piece, look, matrix in made.placed:
        if part == "curtain":
            continue
        world = np.asarray(matrix)
        points = piece.points @ world[:3, :3].T + world[:3, 3]
        out = points + 1e-4 * piece.normals @ np.linalg.inv(world[:3, :3])
        found = []
        for number, (kind, given, place, _block) in left.items():
            local, beyond = ((where - place[:3, 3]) @ np.linalg.inv(place[:3, :3]).T for where in (points, out))
            limit = 3e-3 if kind == "lathe" else 1e-6
            if all(np.abs(outside(kind, given, some)).max() < limit for some in (local[::99], local)):
                found.append(number)
                looks_in = (outside(kind, given, beyond) < 1e-6).sum()
                assert kind == "lathe" or not looks_in, f"{part}: normals that look in"
                size = extent(kind, given)
                assert size is None or np.allclose([local.min(0), local.max(0)], size, atol=0.02 * np.ptp(size)), part
        assert found, f"{part} is nowhere in the example"
        block = left.pop(found[0])[3]
        clipped = re.search(r"box { (<.*?>), (<.*?>) }", block)
        if clipped:
            low, high = values(clipped[1])[0], values(clipped[2])[0]
            assert np.allclose([points.min(0), points.max(0)], [[low[0], 0, low[2]], [high[0], 0, high[2]]]), part
        elif said[found[0]][0] == "plane":
            assert np.ptp(points[:, 0]) > 50 and np.ptp(points[:, 2]) > 40, part
        lobe, colour, tangent, preset, matt = metal_said(block)
        if look.kind == "LibshadeFabricNode":
            assert (look.preset, look.size_mode, 1000 * look.size) == (preset.upper(), "LENGTH", pytest.approx(float(re.findall(r"mm_per_unit ([\d.]+)", block)[-1]))), part
            continue
        bumps = re.search(r'png "basket.png" filter off strength ([\d.]+) scale 1/(<[^>]*>)', block)
        assert getattr(look, "bump", None) == (bumps and ("basket.png", tuple(values(bumps[2])[0]), float(bumps[1]))), part
        assert (look.grain, look.strokes) == (tangent, 0), part
        assert look.inputs["Rotation"].default_value == (0.5 if "RADIAL" in tangent else 0.75 if "rotate 90*z" in block and tangent == "UV" else 0), part
        if preset:
            assert (look.preset, look.groove) == (preset.upper(), "AUTO") and (look.ex, look.ey) == {
                "brushed": (798, 76), "turned": (1248, 245), "scratched": (1600, 1600)}[preset.split("_")[0]], part
            continue
        assert look.inputs["Color"].default_value == pytest.approx([*colour, 1]), part
        assert look.fresnel == ("NONE" if not any(colour) else "SCHLICK"), part
        if lobe:
            word, (along, across) = lobe
            along, across = (1 / along, 1 / across) if word == "roughness" else (along, across)
            assert ((look.distribution, look.ax, look.ay) if word == "ggx" else (getattr(look, "distribution", ""), look.ex, look.ey)) == (
                "GGX" if word == "ggx" else "", pytest.approx(along), pytest.approx(across)), part
        assert matt is None or look.diffuse == "LAMBERT" and look.kd == pytest.approx(matt), part
        assert matt is not None or not hasattr(look, "kd"), part
    assert not [kind for kind, *_ in left.values()]

    number = r"(<[^>]*>|[-\d.]+)"
    location, across, angle, look_at = (values(re.search(rf"camera.*?{word} {number}", text, re.S)[1])[0] for word in ("location", "right", "angle", "look_at"))
    wide = eval(re.search(r"right ([\d/]+)\*x", text)[1])  # noqa: S307
    (at, to, degrees, ratio), = made.camera
    assert np.allclose(at, location) and np.allclose(to, look_at) and (degrees, ratio) == (angle, pytest.approx(wide)) and across
    lamps = []
    for inner in re.findall(r"light_source {([^{}]*)}", plain):
        place, factor, colour = re.match(rf"\s*{number},? rgb {number}(?:\*([\d.e]+))?", inner).group(1, 3, 2)
        colour = np.broadcast_to(values(colour)[0], 3) * float(factor or 1)
        lamps.append([*values(place)[0], *colour])
        assert ("fade_distance" in inner) == (factor is not None)
        if factor:
            (where, light, fade), = made.bulb
            assert np.allclose([*where, *light], lamps.pop()) and fade == float(re.search(r"fade_distance ([\d.]+)", inner)[1])
    ours = [[*where, *np.broadcast_to(colour, 3)] for where, colour in made.sun]
    assert np.allclose(sorted(ours), sorted(lamps)) and ("fade_distance" in plain) == bool(made.bulb)


# ---- shapes, by their formulas and by POV-Ray's UV coordinates


def test_normals_and_coordinates_of_shapes(modules):
    """Normals are those of the shape; UV coordinates those that POV-Ray's own shapes have, in parts of a turn."""
    _bpy, _scenes, shapes, _twins = modules
    ball = shapes.sphere(2.0, 8)
    u, v = ball.uv.T
    assert ball.normals == pytest.approx(ball.points / 2, abs=1e-5) and np.allclose(np.degrees(np.arcsin(ball.points[:, 1] / 2)), 180 * v - 90)
    assert np.allclose(np.stack([np.cos(2 * np.pi * u), np.sin(2 * np.pi * u)], 1) * np.hypot(*ball.points[:, [0, 2]].T)[:, None], ball.points[:, [0, 2]])
    assert (v.min(), v.max()) == (1e-4, 1 - 1e-4) and (u.min(), u.max()) == (0, 1) and len(ball.points) == 17 * 9
    ring = shapes.torus(3.0, 1.0, 8)
    x, y, z = ring.points.T
    out = np.stack([x - 3 * x / np.hypot(x, z), y, z - 3 * z / np.hypot(x, z)], 1)
    assert ring.normals == pytest.approx(out, abs=1e-5) and np.allclose(np.hypot(x, z) - 3, -np.cos(2 * np.pi * ring.uv[:, 1])) and np.allclose(y, -np.sin(2 * np.pi * ring.uv[:, 1]))
    assert np.allclose(np.stack([-np.cos(2 * np.pi * ring.uv[:, 0]), np.sin(2 * np.pi * ring.uv[:, 0])], 1), np.stack([x, z], 1) / np.hypot(x, z)[:, None])
    drum = shapes.round_(1.0, 3.0, 2.0, 0.5)
    side = np.abs(drum.normals[:, 1]) < 0.9
    slant = np.hypot(2, 1.5)
    assert drum.normals[side][:, 1] == pytest.approx(1.5 / slant, abs=1e-6) and set(np.round(drum.normals[~side][:, 1])) == {-1, 1}
    assert np.allclose(drum.uv[side][:, 1], (drum.points[side][:, 1] - 1) / 2) and len(drum.points) == 25 * (65 + 2 + 2)
    ends = drum.points[~side]
    assert np.allclose(np.sign(ends[:, 1] - 2), np.sign(drum.normals[~side][:, 1])) and np.allclose(np.hypot(*ends[:, [0, 2]].T).reshape(4, 25)[:, 0], [2e-4, 2, 5e-5, 0.5])
    assert len(shapes.round_(0, 1, 2, 2).points) == 25 * (2 + 2 + 2) and len(shapes.round_(0, 1, 2, 1, ends=False).points) == 25 * 65
    floor = shapes.plane((-2, -1), (3, 4), 0.5)
    assert np.allclose(floor.points, np.stack([floor.uv[:, 0], np.full(4, 0.5), floor.uv[:, 1]], 1)) and np.allclose(floor.normals, (0, 1, 0)) and floor.uv.max(0).tolist() == [3, 4]
    pillow = shapes.superellipsoid(1.0, 1.0, 6)  # a ball
    assert np.allclose(np.linalg.norm(pillow.points, axis=1), 1) and np.allclose(pillow.normals, pillow.points) and len(pillow.points) == 6 * 49 and np.allclose(pillow.uv, pillow.points[:, :2])
    vase = shapes.lathe(((5, -1), (1, 0), (2, 1), (2, 3), (9, 9)), 4, 4)  # through its inner points, a unit of v from first to last
    inner = [np.hypot(*vase.points[np.isclose(vase.uv[:, 1], v)][0, [0, 2]]) for v in (0, 0.5, 1)]
    assert inner == pytest.approx([1, 2, 2]) and vase.points[:, 1].min() == pytest.approx(0) and vase.points[:, 1].max() == pytest.approx(3) and len(vase.points) == 9 * 9
    assert (vase.normals[np.isclose(vase.uv[:, 1], 0.5)] * vase.points[np.isclose(vase.uv[:, 1], 0.5)])[:, [0, 2]].sum(1) == pytest.approx(np.full(9, 2 * np.cos(np.arctan(0.5 / 1.5))), abs=1e-3)


def test_a_box_unfolds(modules):
    """Into a cross: the sides in a row of four, top and bottom over and under the second; seams meet."""
    _bpy, _scenes, shapes, _twins = modules
    box = shapes.box((-1, 0, 2), (3, 2, 5))
    sides = {tuple(normals[0]): (points, uv) for points, uv, normals in zip(*(part.reshape(6, 4, -1) for part in (box.points, box.uv, box.normals)))}
    assert len(sides) == 6 and box.faces.tolist() == np.arange(24).reshape(6, 4).tolist()
    for normal, (points, _uv) in sides.items():
        axis = int(np.argmax(np.abs(normal)))
        assert np.allclose(points[:, axis], (box.points.max(0) if sum(normal) > 0 else box.points.min(0))[axis])
    place = {normal: (uv.min(0) * (4, 3)).round(6).tolist() for normal, (_points, uv) in sides.items()}
    assert place == {(-1, 0, 0): [0, 1], (0, 0, 1): [1, 1], (1, 0, 0): [2, 1], (0, 0, -1): [3, 1], (0, -1, 0): [1, 0], (0, 1, 0): [1, 2]}
    assert all(np.allclose(np.ptp(uv, axis=0), (1 / 4, 1 / 3)) for _points, uv in sides.values())
    where = {normal: {tuple(p): tuple(t) for p, t in zip(points.tolist(), uv.round(9).tolist())} for normal, (points, uv) in sides.items()}
    for one, other in (((-1, 0, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0)), ((1, 0, 0), (0, 0, -1)), ((0, 0, 1), (0, 1, 0)), ((0, 0, 1), (0, -1, 0))):
        shared = where[one].keys() & where[other].keys()
        assert len(shared) == 2 and all(where[one][p] == pytest.approx(where[other][p]) for p in shared), (one, other)


def test_what_becomes_of_a_shape_in_blender(modules):
    """POV-Ray's y is up, z ahead; faces wind so that they look out; coordinates go with their corners."""
    bpy, _scenes, shapes, _twins = modules
    piece = shapes.box((0, 0, 0), (1, 2, 3)) + shapes.plane((0, 0), (1, 1))
    mesh = shapes.mesh_of("box", piece)
    (points, edges, faces), = (call.args for call in mesh.from_pydata.call_args_list)
    (normals,), = (call.args for call in mesh.normals_split_custom_set_from_vertices.call_args_list)
    assert np.allclose(points, piece.points[:, [0, 2, 1]]) and np.allclose(normals, piece.normals[:, [0, 2, 1]]) and edges == [] and len(faces) == 7
    (name, uv), = (call.args for call in mesh.uv_layers.new.return_value.data.foreach_set.call_args_list)
    assert name == "uv" and np.allclose(uv.reshape(-1, 2), piece.uv[np.ravel(faces)])
    for face in faces:
        a, b, c, _d = (np.array(points[k]) for k in face)
        assert np.dot(np.cross(b - a, c - a), normals[face[0]]) > 0
    (name, smooth), = (call.args for call in mesh.polygons.foreach_set.call_args_list)
    assert name == "use_smooth" and smooth.all() and len(smooth) == 7 and mesh.use_auto_smooth is True and mesh.materials.append.call_args.args == (None,)
    flat = shapes.Piece(np.eye(3)[[0, 1, 2]], np.ones((3, 3)), np.arange(6).reshape(1, 3, 2), np.array([[0, 1, 2]]))  # each corner its own
    corners = shapes.mesh_of("one", flat)
    (_name, uv), = (call.args for call in corners.uv_layers.new.return_value.data.foreach_set.call_args_list)
    assert uv.tolist() == [4, 5, 2, 3, 0, 1] and corners.from_pydata.call_args.args[2] == [[2, 1, 0]]  # mirrored, a face turns round

    look = object()
    item = shapes.place("ball", piece, look, ("scale", (1, 2, 3)), ("rotate", (90, 0, 0)), ("translate", (5, 6, 7)))
    bpy.context.scene.collection.objects.link.assert_called_with(item)
    assert item.material_slots[0].link == "OBJECT" and item.material_slots[0].material is look and item.said[0] == "ball"
    # POV-Ray's (1, 1, 1) is scaled to (1, 2, 3), turned to (1, -3, 2), moved to (6, 3, 9)
    assert np.allclose(item.matrix_world @ (1, 1, 1, 1), (6, 9, 3, 1))
    again = shapes.place("twin", None, look, like=item)
    assert again.said == ("twin", item.data) and np.allclose(again.matrix_world, np.eye(4))


def test_cameras_and_lamps_of_twins(modules, monkeypatch):
    """POV-Ray's angle is across; a light's colour there times pi is a sun's irradiance; a point's power fades with the square."""
    bpy, scenes, shapes, _twins = modules
    shapes.camera((1, 2, 3), (1, 5, 3), 60, 2)
    item = bpy.context.scene.camera
    assert item.location == (1, 3, 2) and item.rotation_euler == ((0, 0, 3), "-Z", "Y")
    data = item.said[1]
    assert (data.sensor_fit, data.angle, data.clip_start, data.clip_end) == ("HORIZONTAL", pytest.approx(np.pi / 3), 1e-3, 1e5)
    assert (bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y) == (960, 480)
    bpy.context.scene.collection.objects.link.assert_called_with(item)
    lit = []
    with monkeypatch.context() as patch:
        patch.setattr(scenes, "light", lambda *said: lit.append(said))
        shapes.sun((1, 2, 3), (0.5, 1, 0.25))
        shapes.sun((0, 1, 0), 0.4)
        shapes.bulb((1, 2, 3), (4, 2, 0), 0.5)
    assert lit[:2] == [("SUN", pytest.approx(np.pi), [1, 3, 2], [0.5, 1, 0.25]), ("SUN", pytest.approx(0.4 * np.pi), [0, 0, 1], [1, 1, 1])]
    # at distance d POV-Ray has colour 2 fade^2/d^2, and pi f cos; a power of W is W/(4 pi^2)/d^2 of f cos
    kind, watts, place, colour = lit[2]
    assert (kind, place, colour) == ("POINT", [1, 3, 2], [1, 0.5, 0]) and watts / (4 * np.pi * np.pi) * np.pi == pytest.approx(4 * 2 * 0.5**2 * np.pi)
    for word, energy in (("SUN", 2.0), ("POINT", 60.0)):
        scenes.light(word, energy, (1, 2, 3), (1, 0.5, 0.25))
        item = bpy.context.scene.collection.objects.link.call_args.args[0]
        data = item.said[1]
        assert (item.said[0], data.said, data.energy, data.color, item.location, item.rotation_euler) == (word, (word, word), energy, (1, 0.5, 0.25), (1, 2, 3), ((1, 2, 3), "Z", "Y"))
        assert data.angle == 0 if word == "SUN" else data.shadow_soft_size == 0


# ---- parts of the twins


def test_a_blade_is_cut(modules):
    """A cube without a corner: its area, what is left of its faces with their coordinates, a new one that looks out."""
    _bpy, _scenes, shapes, twins = modules
    cube = shapes.box((0, 0, 0), (1, 1, 1))
    cube.uv = cube.points[:, :2]
    left = twins.cut(cube, ((2, 2, 2), 2.5 / 3**0.5), ((0, 1, 0), 2))
    corners, normals = left.points[left.faces], left.normals[left.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    new = np.isclose(normals, 3**-0.5).all((1, 2))
    assert areas[~new].sum() == pytest.approx(6 - 3 * 0.125) and areas[new].sum() == pytest.approx(3**0.5 / 8) and left.points.sum(1).max() == pytest.approx(2.5)
    assert np.allclose(((corners[:, 1:] - corners[:, :1]) * normals[:, :1]).sum(2), 0) and np.allclose(normals, normals[:, :1])
    uv = left.uv[left.faces]
    assert np.allclose(uv[~new], corners[~new][..., :2]) and np.allclose(uv[new], corners[new][..., [0, 2]])


def test_cloth_on_what_has_no_coordinates(modules):
    _bpy, _scenes, shapes, twins = modules
    made = twins.by_facing(shapes.box((0, 0, 0), (1, 2, 3)))
    for face, uv in zip(made.faces, made.uv):
        points, along = made.points[face], np.abs(made.normals[face[0]]).argmax()
        assert np.allclose(uv, points[:, {0: [2, 1], 1: [0, 2], 2: [0, 1]}[along]])


def test_the_curtain_is_the_examples(modules):
    """Fold(U) of lampshade.pov at its own corners, scaled; its normals by the inverse of that scale."""
    _bpy, _scenes, _shapes, twins = modules
    made = twins.curtain(240, 2.6)
    u = np.arange(241) / 240
    fold = lambda u: 1.55 + 0.16 * np.sin(44 * u + 1.5 * np.sin(9 * u)) + 0.05 * np.sin(101 * u)  # noqa: E731
    below, above = made.points[:2881], made.points[2881:]
    assert np.allclose(below[::12], np.stack([2.6 * 4.6 * (u - 0.5), np.full(241, -0.3), fold(u)], 1)) and np.allclose(above - below, (0, 4.3, 0))
    assert np.allclose(made.uv[:2881][::12], np.stack([2 * u, 0 * u], 1)) and np.allclose(made.uv[2881:] - made.uv[:2881], (0, 1))
    slope = (fold(u + 1e-3) - fold(u - 1e-3)) / (4.6 * 2e-3)  # y × (1, 0, slope)
    wanted = np.stack([slope / 2.6, 0 * u, -np.ones(241)], 1)
    assert np.allclose(made.normals[:2881][::12], wanted / np.linalg.norm(wanted, axis=1, keepdims=True)) and np.allclose(made.normals[2881:], made.normals[:2881])
    assert len(made.faces) == 2880 and made.faces[0].tolist() == [0, 1, 2882, 2881]
    assert 'scale <2.6, 1, 1>' in EXAMPLES["lampshade"].read_text() and "#declare Across = 240;" in EXAMPLES["lampshade"].read_text()


def test_nodes_of_twins(modules, tmp_path):
    """A normal map that repeats; ours as a block of POV-Ray's is, without what a new node has more."""
    bpy, scenes, _shapes, twins = modules
    look = twins.bumped(twins.metal((0.1, 0.2, 0.3), turn=0.5, ex=7), str(tmp_path), "basket.png", (6, 3), 0.6)
    tree = look.node_tree
    nodes = {node.bl_idname: node for node in tree.nodes}
    node = nodes["LibshadeMetalNode"]
    assert (node.strokes, node.grain, node.is_new, node.horizon, node.fresnel, node.ex, node.inputs["Color"].default_value, node.inputs["Rotation"].default_value) == (
        0, "UV", False, "VALID_ESTEVEZ", "SCHLICK", 7, (0.1, 0.2, 0.3, 1), 0.5)
    assert nodes["ShaderNodeMapping"].inputs["Scale"].default_value == (6, 3, 1) and nodes["ShaderNodeNormalMap"].inputs["Strength"].default_value == 0.6
    bpy.data.images.load.assert_called_with(str(tmp_path / "basket.png"), check_existing=True)
    assert nodes["ShaderNodeTexImage"].image.colorspace_settings.name == "Non-Color" and look.use_nodes
    assert set(tree.linked) == {("LibshadeMetalNode", "BSDF", "ShaderNodeOutputMaterial", "Surface"), ("ShaderNodeUVMap", 0, "ShaderNodeMapping", "Vector"),
                                ("ShaderNodeMapping", 0, "ShaderNodeTexImage", "Vector"), ("ShaderNodeTexImage", "Color", "ShaderNodeNormalMap", "Color"),
                                ("ShaderNodeNormalMap", "Normal", "LibshadeMetalNode", "Normal")}
    plain = scenes.material("steel", "LibshadeMetalNode", "image", (1, 2, 3), ax=0.5)
    nodes = {node.bl_idname: node for node in plain.node_tree.nodes}
    assert nodes["LibshadeMetalNode"].ax == 0.5 and nodes["LibshadeMetalNode"].inputs["Color"].default_value == (1, 2, 3, 1) and nodes["ShaderNodeTexImage"].image == "image"
    assert set(plain.node_tree.linked) == {("LibshadeMetalNode", "BSDF", "ShaderNodeOutputMaterial", "Surface"), ("ShaderNodeTexImage", "Color", "ShaderNodeNormalMap", "Color"),
                                           ("ShaderNodeNormalMap", "Normal", "LibshadeMetalNode", "Normal")}
    cloth = scenes.material("denim", "LibshadeFabricNode", size=2)
    assert [node.bl_idname for node in cloth.node_tree.nodes] == ["ShaderNodeOutputMaterial", "LibshadeFabricNode"] and not hasattr(cloth.node_tree.nodes[1], "strokes")
    assert scenes.map_file("folder", "bumps.exr").colorspace_settings.name == "Non-Color"
    bpy.data.images.load.assert_called_with("folder/bumps.exr")


def test_small_scenes(modules, monkeypatch, tmp_path):
    """What study_consistency.py's own scenes are made of, where they stand, and the sharp lamps and the camera over them."""
    bpy, scenes, _shapes, _twins = modules
    points, faces, uv = scenes.grid(2, lambda x, y: x + 2 * y)
    assert np.allclose(points[:, 2], points[:, 0] + 2 * points[:, 1]) and np.allclose(points[:, :2], 2 * uv - 1) and (points.min(), uv.min(), uv.max()) == (-3, 0, 1)
    assert len(points) == 9 and faces.tolist() == [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]
    made = []
    with monkeypatch.context() as patch:
        patch.setattr(scenes, "mesh", lambda name, look, points, faces, uv, **place: made.append((name, len(faces), np.ptp(points, axis=0).round(3).tolist(), place, look)))
        for name in ("brushed_plate", "scratched_sphere", "swatches"):
            scenes.SCENES[name](str(tmp_path))
    said = {name: (count, size, place) for name, count, size, place, _look in made}
    looks = {name: look.node_tree.nodes[1] for name, *_rest, look in made}
    assert said["plate"] == (64, [2, 2, 0], {"rotation_euler": (0.1, -0.05, 0.3)}) and said["floor"] == (16, [2, 2, 0], {})
    assert said["ball"][1][:2] == [1.44, 1.44] and said["ball"][2] == {"location": (0, 0, 0.72), "rotation_euler": (0.83, 0, 0)}  # of radius .45, by 1.6
    for number, (name, size) in enumerate((("denim", 0.002), ("shot_taffeta", 0.001))):
        count, extent, place = said[name]
        assert count == 48 * 48 and extent[2] == pytest.approx(0.16, abs=2e-3) and place["scale"] == (0.55, 0.8, 1) and place["location"] == pytest.approx((-0.6 + 1.2 * number, 0, 0.1))
        assert place["rotation_euler"] == pytest.approx((0.25, 0, 0.15 - 0.3 * number))
        assert (looks[name].preset, looks[name].size_mode, looks[name].size) == (name.upper(), "LENGTH", size)
    plate, ball, floor = looks["plate"], looks["ball"], looks["floor"]
    assert (plate.ex, plate.ey, plate.detail, plate.fresnel, plate.diffuse, plate.kd) == (200, 10, "ROTATE", "SCHLICK", "LAMBERT", (0.03, 0.02, 0.015))
    assert (ball.distribution, ball.brdf, ball.ax, ball.ay, ball.detail, ball.fresnel) == ("GGX", "MICROFACET", 0.1, 0.4, "ROTATE", "SCHLICK") and (floor.ex, floor.ey) == (20, 400)
    assert [look.inputs["Color"].default_value for look in (plate, ball, floor)] == [(0.93, 0.62, 0.52, 1), (0.6, 0.585, 0.565, 1), (0.6, 0.585, 0.565, 1)]
    assert ["Normal" in look.inputs for look in (plate, ball, floor)] == [True, True, False]

    scenes.mesh("one", "look", points, faces, uv, location=(1, 2, 3))
    item = bpy.context.scene.collection.objects.link.call_args.args[0]
    data = item.said[1]
    assert data.from_pydata.call_args.args == (points.tolist(), [], faces.tolist()) and item.location == (1, 2, 3)
    word, corners = data.uv_layers.new.return_value.data.foreach_set.call_args.args
    assert word == "uv" and np.allclose(corners.reshape(-1, 2), uv[faces.ravel()]) and data.polygons.foreach_set.call_args.args[1].all()
    data.materials.append.assert_called_with("look")

    lamps, scene = [], bpy.context.scene
    monkeypatch.setattr(scenes, "light", lambda *said: lamps.append(said))
    monkeypatch.setitem(scenes.SCENES, "none", lambda folder: lamps.append(folder))
    scenes.main("none", "folder")
    assert lamps == ["folder", ("SUN", 2.0, (1.5, -1.0, 2.5), (1.0, 0.95, 0.88)), ("POINT", 60.0, (-2.0, 0.5, 1.8), (0.8, 0.88, 1.0))]
    bpy.ops.wm.read_factory_settings.assert_called_with(use_empty=True)
    bpy.ops.preferences.addon_enable.assert_called_with(module="libshade")
    camera = scene.camera
    scene.collection.objects.link.assert_called_with(camera)
    assert camera.location == (0, -2.6, 2.6) and camera.rotation_euler == ((0, -2.6, 2.35), "Z", "Y") and camera.data.lens == 45
    assert (scene.render.resolution_x, scene.render.resolution_y, scene.world.color, scene.render.engine, scene.libshade.max_bounces) == (800, 600, (0, 0, 0), "LIBSHADE", 0)
    assert bpy.context.preferences.filepaths.save_version == 0
    bpy.ops.wm.save_as_mainfile.assert_called_with(filepath="folder/scene.blend")
    scenes.save("folder", 0.02)
    assert scene.world.color == (0.02,) * 3
