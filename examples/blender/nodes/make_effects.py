# SPDX-License-Identifier: Apache-2.0
"""What sockets and properties of libshade's nodes do, each at three values, from left to right: NAME.jpg for each of EFFECTS,
or for those that are named. In a Blender from 4.x on, which denoises:

    BLENDER_USER_SCRIPTS=build/blender build/venv-bpy/bin/python examples/blender/nodes/make_effects.py -- FOLDER [NAME …]
"""
import math
import os
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402

WIDE, HIGH, SAMPLES = 720, 210, 32  # of what is denoised; of cloth, whose yarns denoising would blur, twice as many
STEEL, COPPER = (0.62, 0.60, 0.58), (0.95, 0.64, 0.54)
BRUSH = 20.0  # mm, for a plate a tenth of a metre wide
STEP = 0.12  # from one to the next, metres


# ---- what wears them


def dome(made, x):
    """A plate that bulges; its UV map runs straight over it, a metre to a unit."""
    profile = [(0.05 * math.sin(a), 0.05 * math.cos(a) - 0.018) for a in np.linspace(math.radians(72), 1e-4, 60)]
    mesh = parts.turned([(0.0495, -0.012), *profile])
    for loop, data in zip(mesh.loops, mesh.uv_layers[0].data):
        data.uv = mesh.vertices[loop.vertex_index].co.xy
    return parts.place("dome", mesh, made, (x, 0, 0.012))


def ball(made, x):
    """A ball; a unit of its UV map is a metre on its equator."""
    profile = [(0.05 * math.cos(a), 0.05 * math.sin(a)) for a in np.linspace(-1.57, 1.57, 80)]
    return parts.place("ball", parts.turned(profile), made, (x, 0, 0.05))


def folds(made, x):
    """A piece of cloth that hangs in folds."""
    s, t = np.meshgrid(np.linspace(0, 1, 160), np.linspace(0, 1, 40))
    deep = 0.006 * (0.5 + 0.5 * t) * (np.sin(6 * math.pi * s + 0.6 * np.sin(2 * t)) + 0.3 * np.sin(13 * s + t))
    points = np.stack([0.104 * (s - 0.5), -deep, 0.09 * t], -1)
    return parts.place("folds", parts.grid(points), made, (x, 0, 0))


def sheet(made, x):
    """A flat piece, seen from near."""
    s, t = np.meshgrid(np.linspace(-0.5, 0.5, 2), np.linspace(-0.5, 0.5, 2))
    return parts.place("sheet", parts.grid(np.stack([0.0046 * s, 0 * s, 0.0042 * t], -1)), made, (x / 25, 0, 0))


def plate(made, x):
    """A flat piece, seen from near."""
    s, t = np.meshgrid(np.linspace(-0.5, 0.5, 2), np.linspace(-0.5, 0.5, 2))
    return parts.place("plate", parts.grid(np.stack([0.037 * s, 0.044 * t, 0 * s], -1)), made, (x / 3, 0, 0))


# ---- materials


def steel(value=None, socket=None, roughness=0.35, anisotropy=0.5, color=STEEL):
    made = parts.metal("steel", color, roughness, anisotropy)
    if socket:
        shader_of(made).inputs[socket].default_value = value
    return made


def brushed(strokes):
    """The same as a brush left it."""
    made = steel(anisotropy=0.8)
    shader_of(made).strokes, shader_of(made).stroke_width = strokes, BRUSH
    return made


def shader_of(made, kind="LibshadeMetalNode"):
    return next(node for node in made.node_tree.nodes if node.bl_idname == kind)


def hammered(value):
    """A metal that follows its bumps, or does not; None: without bumps."""
    made = steel(color=COPPER, roughness=0.4, anisotropy=0.8)
    tree, shader = made.node_tree, shader_of(made)
    place, cells, bump = (tree.nodes.new("ShaderNode" + kind) for kind in ("TexCoord", "TexVoronoi", "Bump"))
    cells.feature = "SMOOTH_F1"
    cells.inputs["Scale"].default_value = 80
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.6, 0.004
    tree.links.new(place.outputs["Object"], cells.inputs["Vector"])
    tree.links.new(cells.outputs["Distance"], bump.inputs["Height"])
    if value:
        tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
        shader.bump_response = value
    return made


def scratched(**said):
    """Polished steel under scratches."""
    scratches = parts.of_addon("scratches")
    made = steel(roughness=0.2, anisotropy=0)
    tree, shader = made.node_tree, shader_of(made)
    shader.distribution, shader.brdf = "BECKMANN", "MICROFACET"
    node = tree.nodes.new(scratches.SCRATCHES)
    scratches.apply_preset(node, "DEEP")
    node.inputs["Density per cm²"].default_value *= 5
    node.size = said.get("size", 1.0)
    node.inputs["Amount"].default_value = said.get("amount", 1.0)
    tree.links.new(node.outputs["Normal"], shader.inputs["Normal"])
    return made


def cloth(preset, socket=None, value=None, size=1.0, **said):
    made = parts.cloth(preset.lower(), preset, size)
    node = shader_of(made, "LibshadeFabricNode")
    for name, number in said.items():
        setattr(node, name, number)
    if socket:
        node.inputs[socket].default_value = value
    return made


def twisted(degrees):
    """Yarns of two strands, twisted together."""
    angle = math.radians(degrees)
    return cloth("GABARDINE", distance="NEAR", **{f"{yarn}_{name}": number for yarn in ("warp", "weft")
                                                  for name, number in (("twist", angle), ("segments", 2), ("ridge", 0.6))})


# ---- each effect: what wears it, and its three materials


EFFECTS = {
    "roughness": (dome, lambda value: steel(value, "Roughness"), (0.2, 0.45, 0.7)),
    "anisotropy": (dome, lambda value: steel(value, "Anisotropy"), (0.0, 0.5, 0.9)),
    "strokes": (dome, brushed, (0.0, 0.5, 1.0)),
    "rotation": (dome, lambda value: steel(value, "Rotation", anisotropy=0.8), (0.0, 0.125, 0.25)),
    "bump-response": (dome, hammered, (None, "IGNORE", "FOLLOW")),
    "amount": (plate, lambda value: scratched(amount=value), (0.0, 0.1, 1.0)),
    "scratch-size": (plate, lambda value: scratched(size=value), (0.5, 1.0, 2.0)),
    "gloss": (ball, lambda value: cloth("POLYESTER_LINING", "Gloss", value), (0.1, 0.4, 1.0)),
    "fuzz": (ball, lambda value: cloth("WOOL_FLANNEL", "Fuzz", value), (0.0, 0.3, 1.5)),
    "cloth-size": (folds, lambda value: cloth("HERRINGBONE_TWEED", size=value), (0.5, 1.0, 2.0)),
    "distance": (folds, lambda value: cloth("HERRINGBONE_TWEED", size=0.5, distance=value), ("AUTO", "NEAR", "FAR")),
    "twist": (sheet, twisted, (-35, 0, 35)),
}
# Of each: the sky, its strength and turn; power, place and size of the lamp; the camera's place, aim and lens.
VIEWS = {
    dome: (("interior", 0.8, 2.1), (0.35, (-0.25, -0.05, 0.4), 0.06), ((0, -0.36, 0.3), (0, -0.002, 0.008), 44)),
    ball: (("interior", 0.8, 2.1), (0.5, (-0.2, -0.3, 0.35), 0.08), ((0, -0.5, 0.16), (0, 0, 0.047), 50)),
    plate: (("forest", 1.0, 0.0), (0.025, (0.05, 0.22, 0.3), 0.03), ((0, -0.4, 0.35), (0, 0, 0), 156)),
    folds: (("interior", 0.5, 2.1), (0.6, (-0.35, -0.3, 0.35), 0.1), ((0, -0.6, 0.05), (0, 0, 0.046), 58)),
    sheet: (("interior", 0.7, 2.1), (0.02, (-0.03, -0.04, 0.06), 0.01), ((0, -0.024, 0), (0, 0, 0), 58)),
}


def build(wears, made_of, values):
    parts.begin()
    for place, value in enumerate(values):
        wears(made_of(value), STEP * (place - 1))
    if wears in (dome, ball):
        bpy.ops.mesh.primitive_plane_add(size=4)
        bpy.context.object.data.materials.append(parts.plain("slate", (0.01, 0.0105, 0.012), 0.6))
    (picture, sky, turn), (power, place, size), camera = VIEWS[wears]
    parts.sky(picture, sky, turn)
    parts.lamp(power, place, (0, 0, 0), size)
    parts.camera(*camera)
    bpy.context.scene.libshade.sample_clamp_indirect = 1


def main(folder, *names):
    for name in names or EFFECTS:
        build(*EFFECTS[name])
        denoised = bpy.context.scene.libshade.use_denoising = EFFECTS[name][0] not in (ball, folds)
        parts.render(os.path.join(folder, name + ".jpg"), "LIBSHADE", WIDE, HIGH, SAMPLES if denoised else 2 * SAMPLES)


main(*sys.argv[sys.argv.index("--") + 1:])
