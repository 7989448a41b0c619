# SPDX-License-Identifier: Apache-2.0
"""Materials of the kinds that public libraries hold, by stock nodes alone: each function gets a Maker of
materials_make.py and returns the shader. Without volumes. Those in STRANDS are shown on hair.
"""
import numpy as np

BUILDERS, STRANDS = {}, {}


def material(build):
    BUILDERS[build.__name__] = build
    return build


def on_strands(build):
    STRANDS[build.__name__] = build
    return build


# --- metals ---

@material
def brushed_steel(m):
    grain = m.noise(m.place((1, 80, 1)), 12, 8, 0.6)
    return m.principled(Base_Color=(0.6, 0.6, 0.62), Metallic=1, Roughness=m.range(grain, 0.2, 0.45), Normal=m.bump(grain, 0.05))


@material
def brushed_aluminium_anisotropic(m):
    grain = m.noise(m.place((60, 1, 1), "Generated"), 10, 4)
    return m.principled(Base_Color=(0.9, 0.91, 0.92), Metallic=1, Roughness=m.range(grain, 0.25, 0.4), Anisotropic=0.7,
                        Normal=m.bump(grain, 0.02), Tangent=m("Tangent", {"direction_type": "RADIAL", "axis": "Z"}))


@material
def turned_brass(m):
    rings = m.wave(m.place(1), 30, 0.5, "RINGS", way="Z")
    return m("BsdfAnisotropic" if not m.new else "BsdfGlossy", {"distribution": "GGX"}, Color=(0.88, 0.65, 0.3), Roughness=0.3,
             Anisotropy=0.8, Rotation=0.25, Normal=m.bump(rings, 0.05, 0.02), Tangent=m("Tangent", {"direction_type": "RADIAL", "axis": "Z"}))


@material
def hammered_copper(m):
    dents = m.voronoi(m.place(1), 6, "SMOOTH_F1", Smoothness=0.5)
    stain = m.noise(m.place(1), 3, 6)
    return m.principled(Base_Color=m.ramp(stain, (0.4, (0.95, 0.5, 0.35)), (0.7, (0.45, 0.2, 0.12))), Metallic=1,
                        Roughness=m.range(stain, 0.15, 0.45), Normal=m.bump(dents, 0.6, 0.1))


@material
def rusted_iron(m):
    at = m.place(1)
    patches = m.ramp(m.noise(at, 4, 12, 0.7), (0.45, 0.0), (0.55, 1.0))
    fine = m.noise(at, 40, 8)
    rust = m.principled(Base_Color=m.ramp(fine, (0.3, (0.12, 0.03, 0.01)), (0.7, (0.4, 0.14, 0.04))), Roughness=0.95,
                        Normal=m.bump(fine, 0.8, 0.05))
    bare = m.principled(Base_Color=(0.35, 0.34, 0.33), Metallic=1, Roughness=0.35, Normal=m.bump(fine, 0.1, 0.02))
    return m.mix(patches, bare, rust)


@material
def galvanised(m):
    cells = m.voronoi(m.place(1), 9, output="Color")
    value = m("SeparateColor" if m.new else "SeparateRGB", **{("Color" if m.new else "Image"): cells})
    shade = m.range(value, 0.25, 0.5)
    return m.principled(Base_Color=m.ramp(value, (0.0, 0.45), (1.0, 0.7)), Metallic=1, Roughness=shade, Anisotropic=0.3)


@material
def gold_glossy(m):
    return m("BsdfGlossy", {"distribution": "MULTI_GGX"}, Color=(1.0, 0.72, 0.3), Roughness=0.25)


@material
def gold_leaf(m):
    creases = m.musgrave(m.place(1), 5, 8, "RIDGED_MULTIFRACTAL")
    return m.principled(Base_Color=(1.0, 0.75, 0.33), Metallic=1, Roughness=0.22, Normal=m.bump(creases, 0.3, 0.03))


@material
def scratched_chrome(m):
    a = m.ramp(m.wave(m.place((1, 1, 1), turn=(0.3, 0.2, 0.1)), 6, 12, detail=3), (0.0, 1.0), (0.02, 0.0))
    b = m.ramp(m.noise(m.place((0.4, 60, 0.4), turn=(0.5, 0.1, 0.7)), 4, 2), (0.62, 0.0), (0.66, 1.0))
    both = m.math("MAXIMUM", a, b)
    return m.principled(Base_Color=(0.75, 0.75, 0.76), Metallic=1, Roughness=m.range(both, 0.08, 0.35), Normal=m.bump(both, 0.1, 0.02, invert=True))


@material
def anodised(m):
    rim = m("LayerWeight", Blend=0.3)["Facing"]
    return m.principled(Base_Color=m.ramp(rim, (0.0, (0.1, 0.05, 0.5)), (0.6, (0.5, 0.05, 0.4)), (1.0, (0.9, 0.4, 0.1))), Metallic=1,
                        Roughness=0.3, Thin_Film_Thickness=300.0)


@material
def cast_iron(m):
    at = m.place(1)
    pits = m.noise(at, 60, 6, 0.65)
    return m.principled(Base_Color=(0.06, 0.06, 0.065), Metallic=0.8, Roughness=m.range(pits, 0.5, 0.8), Specular_IOR_Level=0.4,
                        Normal=m.bump(pits, 0.5, 0.05, m.bump(m.noise(at, 3, 3), 0.4, 0.2)))


@material
def perforated_sheet(m):
    holes = m.math("LESS_THAN", m.voronoi(m.place(10, "UV"), 1.6, Randomness=0.0), 0.25)
    steel = m.principled(Base_Color=(0.5, 0.5, 0.5), Metallic=1, Roughness=0.35)
    return m.mix(holes, steel, m("BsdfTransparent"))


@material
def diamond_plate(m):
    bars = m.math("MULTIPLY", m.wave(m.place(3, turn=(0, 0, 0.78)), 3), m.wave(m.place(3, turn=(0, 0, -0.78)), 3))
    return m.principled(Base_Color=(0.4, 0.4, 0.42), Metallic=1, Roughness=0.4, Normal=m.bump(m.ramp(bars, (0.5, 0.0), (0.7, 1.0)), 0.5, 0.05))


@material
def oxidised_bronze(m):
    at = m.place(1)
    age = m.ramp(m.musgrave(at, 3, 10), (0.3, 0.0), (0.6, 1.0))
    bronze = m("BsdfGlossy", {"distribution": "BECKMANN"}, Color=(0.6, 0.4, 0.2), Roughness=0.35)
    patina = m("BsdfDiffuse", Color=m.ramp(m.noise(at, 20, 5), (0.3, (0.05, 0.3, 0.22)), (0.7, (0.2, 0.5, 0.4))), Roughness=0.6)
    return m.mix(age, bronze, patina)


# --- paints ---

@material
def car_paint_flakes(m):
    flake = m.voronoi(m.place(1), 150, output="Color")
    tilt = m("NormalMap", Color=m.color("MIX", 0.25, (0.5, 0.5, 1.0), flake), Strength=0.6)
    return m.principled(Base_Color=(0.3, 0.02, 0.02), Metallic=0.8, Roughness=0.35, Coat_Weight=1, Coat_Roughness=0.03, Normal=tilt)


@material
def car_paint_layers(m):
    base = m.mix(m("LayerWeight", Blend=0.5)["Facing"], m("BsdfDiffuse", Color=(0.02, 0.05, 0.4)), m("BsdfDiffuse", Color=(0.2, 0.02, 0.3)))
    flakes = m("BsdfGlossy", {"distribution": "GGX"}, Color=(0.3, 0.4, 0.9), Roughness=0.4)
    under = m.mix(0.4, base, flakes)
    return m.mix(m("Fresnel", IOR=1.45), under, m("BsdfGlossy", {"distribution": "GGX"}, Color=(1, 1, 1), Roughness=0.05))


@material
def pearl_paint(m):
    turn = m("LayerWeight", Blend=0.6)["Facing"]
    return m.principled(Base_Color=m.ramp(turn, (0.0, (0.8, 0.75, 0.7)), (0.5, (0.6, 0.7, 0.85)), (1.0, (0.9, 0.6, 0.7))), Metallic=0.3,
                        Roughness=0.3, Coat_Weight=1, Coat_Roughness=0.05, Sheen_Weight=0.3)


@material
def matte_black_wrap(m):
    return m.principled(Base_Color=(0.01, 0.01, 0.012), Roughness=0.55, Specular_IOR_Level=0.5, Coat_Weight=0.2, Coat_Roughness=0.4)


@material
def peeling_paint(m):
    at = m.place(1)
    edge = m.noise(at, 3, 10, 0.65, 0.5)
    mask = m.ramp(edge, (0.5, 0.0), (0.52, 1.0))
    paint = m.principled(Base_Color=(0.1, 0.35, 0.3), Roughness=0.4, Normal=m.bump(mask, 0.6, 0.05))
    wood = m.principled(Base_Color=m.ramp(m.noise(m.place((1, 1, 12)), 4, 6), (0.3, (0.15, 0.1, 0.06)), (0.7, (0.4, 0.3, 0.2))), Roughness=0.8)
    return m.mix(mask, wood, paint)


@material
def orange_peel_lacquer(m):
    peel = m.noise(m.place(1), 45, 1)
    return m.principled(Base_Color=(0.6, 0.25, 0.02), Roughness=0.5, Coat_Weight=1, Coat_Roughness=0.02, Coat_Normal=m.bump(peel, 0.15, 0.02))


@material
def carbon_fibre(m):
    weave = m("TexChecker", Vector=m.place((1, 1, 1), "UV"), Scale=40)["Fac"]
    strands = m.math("MULTIPLY", m.wave(m.place((1, 1, 1), "UV"), 40, way="X"), weave)
    return m.principled(Base_Color=m.ramp(weave, (0.0, 0.01), (1.0, 0.04)), Roughness=0.4, Specular_IOR_Level=0.6, Coat_Weight=1,
                        Coat_Roughness=0.03, Normal=m.bump(strands, 0.3, 0.02))


# --- woods ---

@material
def oak(m):
    at = m.place((1, 1, 0.15))
    rings = m.wave(at, 4, 6, "RINGS", 4, way="Z")
    pores = m.noise(m.place((20, 20, 1)), 6, 6)
    tone = m.color("MULTIPLY", 0.6, m.ramp(rings, (0.1, (0.35, 0.2, 0.09)), (0.8, (0.55, 0.36, 0.18))), m.ramp(pores, (0.35, 0.3), (0.5, 1.0)))
    return m.principled(Base_Color=tone, Roughness=m.range(pores, 0.35, 0.6), Normal=m.bump(pores, 0.2, 0.02))


@material
def varnished_walnut(m):
    grain = m.noise(m.place((8, 8, 0.6)), 3, 12, 0.6, 1.5)
    tone = m("HueSaturation", Hue=0.5, Saturation=1.1, Value=0.9, Color=m.ramp(grain, (0.3, (0.05, 0.02, 0.01)), (0.5, (0.15, 0.07, 0.03)), (0.7, (0.3, 0.16, 0.08))))
    return m.principled(Base_Color=tone, Roughness=0.5, Coat_Weight=0.8, Coat_Roughness=0.08, Normal=m.bump(grain, 0.1, 0.02))


@material
def planks(m):
    bricks = m("TexBrick", {"offset": 0.37}, Vector=m.place(1, "UV"), Scale=6, Mortar_Size=0.01, Brick_Width=1.5, Row_Height=0.3,
               Color1=(0.45, 0.28, 0.14), Color2=(0.28, 0.15, 0.07), Mortar=(0.02, 0.01, 0.01))
    grain = m.noise(m.place((1, 14, 1), "UV"), 8, 8)
    return m.principled(Base_Color=m.color("OVERLAY", 0.5, bricks["Color"], m.ramp(grain, (0.3, 0.2), (0.7, 0.8))), Roughness=0.45,
                        Normal=m.bump(bricks["Fac"], 0.6, 0.02, m.bump(grain, 0.1, 0.01), invert=True))


@material
def bark(m):
    at = m.place((1, 1, 0.3))
    cracks = m.voronoi(m.color("LINEAR_LIGHT", 0.1, at, m.noise(at, 4, 4, color=True)), 6, "DISTANCE_TO_EDGE")
    return m.principled(Base_Color=m.ramp(cracks, (0.0, (0.03, 0.02, 0.01)), (0.3, (0.2, 0.13, 0.08))), Roughness=0.9, Specular_IOR_Level=0.2,
                        Normal=m.bump(cracks, 0.9, 0.15))


@material
def cork(m):
    grain = m.voronoi(m.place(1), 25, "F2")
    return m.principled(Base_Color=m.ramp(grain, (0.2, (0.25, 0.13, 0.06)), (0.8, (0.6, 0.4, 0.22))), Roughness=0.85, Normal=m.bump(grain, 0.4, 0.03))


@material
def bamboo(m):
    knots = m.wave(m.place(1), 2, way="Z", profile="SAW")
    streaks = m.noise(m.place((25, 25, 0.5)), 3, 3)
    return m.principled(Base_Color=m.color("MIX", 0.4, m.ramp(knots, (0.0, (0.2, 0.18, 0.05)), (0.1, (0.6, 0.55, 0.25))), m.ramp(streaks, (0.3, (0.5, 0.4, 0.1)), (0.7, (0.8, 0.7, 0.4)))),
                        Roughness=0.35, Normal=m.bump(knots, 0.4, 0.05))


# --- fabrics ---

@material
def denim(m):
    warp = m.wave(m.place(1, "UV", (0, 0, 0.78)), 60)
    fuzz = m.noise(m.place(1), 80, 4)
    return m.principled(Base_Color=m.color("MIX", m.math("MULTIPLY", warp, fuzz), (0.03, 0.06, 0.18), (0.35, 0.4, 0.5)), Roughness=0.9,
                        Sheen_Weight=0.5, Normal=m.bump(warp, 0.4, 0.01))


@material
def linen(m):
    cross = m.math("ADD", m.wave(m.place(1, "UV"), 45, 1.0), m.wave(m.place(1, "UV"), 45, 1.0, way="Y"))
    return m.principled(Base_Color=m.ramp(cross, (0.3, (0.5, 0.44, 0.33)), (1.0, (0.8, 0.74, 0.62))), Roughness=0.8, Sheen_Weight=0.3,
                        Normal=m.bump(cross, 0.3, 0.02))


@material
def velvet(m):
    nap = m.noise(m.place(1), 2, 3)
    soft = m("BsdfVelvet" if not m.new else "BsdfSheen", Color=(0.6, 0.05, 0.1), **({"Sigma": 0.6} if not m.new else {"Roughness": 0.5}))
    return m.add(m("BsdfDiffuse", Color=m.ramp(nap, (0.3, (0.1, 0.005, 0.01)), (0.7, (0.25, 0.01, 0.03)))), soft)


@material
def satin(m):
    fold = m.wave(m.place(1), 1.5, 3)
    return m.principled(Base_Color=(0.55, 0.1, 0.3), Roughness=0.35, Anisotropic=0.8, Sheen_Weight=0.4, Specular_IOR_Level=0.8, Normal=m.bump(fold, 0.3, 0.1))


@material
def knit(m):
    loops = m("TexMagic", {"turbulence_depth": 2}, Vector=m.place(14, "UV"), Scale=2.0, Distortion=1.0)["Fac"]
    return m.principled(Base_Color=m.ramp(loops, (0.2, (0.15, 0.2, 0.12)), (0.8, (0.5, 0.6, 0.4))), Roughness=1.0, Sheen_Weight=0.8, Normal=m.bump(loops, 0.7, 0.05))


@material
def tartan(m):
    a = m.ramp(m.wave(m.place(1, "UV"), 5), (0.3, (0.3, 0.02, 0.02)), (0.5, (0.02, 0.1, 0.04)), (0.9, (0.5, 0.5, 0.1)), how="CONSTANT")
    b = m.ramp(m.wave(m.place(1, "UV"), 5, way="Y"), (0.3, (0.3, 0.02, 0.02)), (0.5, (0.02, 0.1, 0.04)), (0.9, (0.5, 0.5, 0.1)), how="CONSTANT")
    return m.principled(Base_Color=m.color("MIX", 0.5, a, b), Roughness=0.85, Sheen_Weight=0.5)


@material
def leather(m):
    at = m.place(1)
    grain = m.voronoi(m.color("MIX", 0.1, at, m.noise(at, 10, 2, color=True)), 22, "SMOOTH_F1", Smoothness=1.0)
    return m.principled(Base_Color=m.ramp(grain, (0.2, (0.2, 0.08, 0.03)), (0.7, (0.08, 0.03, 0.015))), Roughness=m.range(grain, 0.35, 0.6),
                        Specular_IOR_Level=0.4, Normal=m.bump(grain, 0.5, 0.04, invert=True))


@material
def canvas_translucent(m):
    threads = m("TexBrick", Vector=m.place(1, "UV"), Scale=50, Mortar_Size=0.02, Color1=(0.8, 0.75, 0.6), Color2=(0.7, 0.64, 0.5), Mortar=(0.3, 0.25, 0.2))
    return m.mix(0.3, m("BsdfDiffuse", Color=threads["Color"], Roughness=0.5, Normal=m.bump(threads["Fac"], 0.3, 0.01)), m("BsdfTranslucent", Color=threads["Color"]))


@material
def silk_scarf(m):
    print_ = m.ramp(m.noise(m.place(1), 2, 1, 0.5, 3.0), (0.3, (0.02, 0.1, 0.4)), (0.5, (0.8, 0.5, 0.05)), (0.7, (0.6, 0.05, 0.2)))
    return m.mix(m("LayerWeight", Blend=0.2)["Fresnel"], m("BsdfDiffuse", Color=print_), m("BsdfGlossy", {"distribution": "ASHIKHMIN_SHIRLEY"}, Color=print_, Roughness=0.35))


# --- stones, tiles, walls ---

@material
def marble(m):
    at = m.place(1)
    veins = m.ramp(m.math("ABSOLUTE", m.math("SUBTRACT", m.noise(at, 2, 12, 0.6, 1.0), 0.5)), (0.0, (0.1, 0.1, 0.12)), (0.06, (0.8, 0.8, 0.78)))
    return m.principled(Base_Color=veins, Roughness=0.12, Specular_IOR_Level=0.5)


@material
def granite(m):
    at = m.place(1)
    grains = m.voronoi(at, 40, output="Color")
    speck = m("RGBToBW", Color=grains)
    return m.principled(Base_Color=m.ramp(speck, (0.2, (0.02, 0.02, 0.02)), (0.4, (0.4, 0.3, 0.28)), (0.6, (0.6, 0.58, 0.55)), how="CONSTANT"), Roughness=0.2)


@material
def terrazzo(m):
    chips = m.voronoi(m.place(1), 12, "DISTANCE_TO_EDGE")
    chip = m.ramp(chips, (0.04, 0.0), (0.05, 1.0))
    tone = m.voronoi(m.place(1), 12, output="Color")
    return m.principled(Base_Color=m.color("MIX", chip, (0.75, 0.73, 0.7), m("HueSaturation", Saturation=0.4, Value=0.7, Color=tone)), Roughness=0.25, Coat_Weight=0.3)


@material
def concrete(m):
    at = m.place(1)
    base = m.noise(at, 3, 15, 0.6)
    holes = m.ramp(m.voronoi(at, 18), (0.05, 0.0), (0.12, 1.0))
    return m.principled(Base_Color=m.ramp(base, (0.3, 0.22), (0.7, 0.42)), Roughness=0.85, Normal=m.bump(holes, 0.5, 0.05, m.bump(base, 0.3, 0.1)))


@material
def brick_wall(m):
    at = m.place(1, "UV")
    bricks = m("TexBrick", Vector=at, Scale=12, Mortar_Size=0.03, Mortar_Smooth=0.3, Color1=(0.4, 0.1, 0.05), Color2=(0.25, 0.07, 0.04), Mortar=(0.5, 0.48, 0.45))
    rough = m.noise(m.place(1), 30, 8)
    height = m.math("ADD", m.math("MULTIPLY", bricks["Fac"], -1.0), m.math("MULTIPLY", rough, 0.3))
    return m.principled(Base_Color=m.color("MULTIPLY", 0.5, bricks["Color"], m.ramp(rough, (0.3, 0.3), (0.7, 1.0))), Roughness=0.9, Normal=m.bump(height, 0.8, 0.03))


@material
def bathroom_tiles(m):
    bricks = m("TexBrick", {"offset": 0.0}, Vector=m.place(1, "UV"), Scale=8, Mortar_Size=0.015, Mortar_Smooth=0.5, Brick_Width=0.5, Row_Height=0.5,
               Color1=(0.1, 0.4, 0.5), Color2=(0.15, 0.5, 0.55), Mortar=(0.7, 0.7, 0.68))
    return m.principled(Base_Color=bricks["Color"], Roughness=m.range(bricks["Fac"], 0.08, 0.7), Normal=m.bump(bricks["Fac"], 0.7, 0.02, invert=True))


@material
def hexagon_mosaic(m):
    edge = m.voronoi(m.place((8, 8, 8), "UV"), 1.5, "DISTANCE_TO_EDGE", Randomness=0.15)
    tile = m.ramp(edge, (0.03, 0.0), (0.07, 1.0))
    return m.mix(tile, m("BsdfDiffuse", Color=(0.3, 0.3, 0.28)), m.principled(Base_Color=(0.7, 0.55, 0.15), Roughness=0.15, Normal=m.bump(tile, 0.5, 0.03)))


@material
def displaced_cobbles(m):
    stones = m.voronoi(m.place(1), 5, "SMOOTH_F1", Smoothness=0.3)
    m.displaced(m("Displacement", Height=stones, Scale=0.1, Midlevel=0.5))
    return m.principled(Base_Color=m.ramp(stones, (0.2, (0.35, 0.33, 0.3)), (0.6, (0.1, 0.09, 0.08))), Roughness=0.7)


@material
def stucco_displacement(m):
    lumps = m.noise(m.place(1), 15, 6)
    m.displaced(m("Displacement", Height=lumps, Scale=0.05, Midlevel=0.0))
    return m("BsdfDiffuse", Color=(0.7, 0.6, 0.45), Roughness=0.4)


@material
def sandstone(m):
    at = m.place((0.3, 0.3, 3))
    layers = m.noise(at, 3, 8, 0.55, 0.6)
    return m.principled(Base_Color=m.ramp(layers, (0.35, (0.45, 0.22, 0.1)), (0.5, (0.65, 0.42, 0.22)), (0.65, (0.5, 0.3, 0.15))), Roughness=0.95,
                        Specular_IOR_Level=0.2, Normal=m.bump(m.noise(m.place(1), 90, 4), 0.4, 0.02))


@material
def wet_asphalt(m):
    at = m.place(1)
    stones = m.voronoi(at, 50)
    puddle = m.ramp(m.noise(at, 1.5, 4), (0.5, 0.0), (0.6, 1.0))
    return m.principled(Base_Color=m.ramp(stones, (0.1, 0.02), (0.6, 0.08)), Roughness=m.range(puddle, 0.8, 0.06),
                        Normal=m.bump(stones, m.range(puddle, 0.8, 0.02), 0.03), Specular_IOR_Level=0.5)


@material
def mossy_rock(m):
    at = m.place(1)
    up = m("SeparateXYZ", Vector=m("NewGeometry")["Normal"])["Z"]
    mask = m.ramp(m.math("ADD", up, m.math("MULTIPLY", m.noise(at, 6, 8), 0.8)), (0.6, 0.0), (0.9, 1.0))
    rock = m.principled(Base_Color=(0.25, 0.24, 0.22), Roughness=0.85, Normal=m.bump(m.musgrave(at, 4, 10, "HYBRID_MULTIFRACTAL"), 0.5, 0.1))
    moss = m.principled(Base_Color=(0.08, 0.16, 0.02), Roughness=1.0, Sheen_Weight=1.0, Normal=m.bump(m.noise(at, 60, 4), 1.0, 0.03))
    return m.mix(mask, rock, moss)


# --- glazes, ceramics, plastics, organic ---

@material
def porcelain(m):
    return m.principled(Base_Color=(0.85, 0.85, 0.82), Roughness=0.08, Subsurface_Weight=0.0, Coat_Weight=0.5, Coat_Roughness=0.02)


@material
def celadon_crackle(m):
    cracks = m.ramp(m.voronoi(m.place(1), 9, "DISTANCE_TO_EDGE"), (0.0, (0.15, 0.12, 0.08)), (0.02, (0.45, 0.6, 0.5)))
    return m.principled(Base_Color=cracks, Roughness=0.4, Coat_Weight=1.0, Coat_Roughness=0.02, Coat_IOR=1.5)


@material
def drip_glaze(m):
    height = m("SeparateXYZ", Vector=m.place(1, "Generated"))["Z"]
    run = m.math("GREATER_THAN", m.math("ADD", height, m.math("MULTIPLY", m.noise(m.place((4, 4, 0.5)), 2, 2), 0.4)), 0.75)
    clay = m("BsdfDiffuse", Color=(0.35, 0.16, 0.08), Roughness=0.8)
    glaze = m.mix(m("Fresnel", IOR=1.5), m("BsdfDiffuse", Color=(0.05, 0.15, 0.35)), m("BsdfGlossy", {"distribution": "GGX"}, Color=(1, 1, 1), Roughness=0.08))
    return m.mix(run, clay, glaze)


@material
def speckled_stoneware(m):
    specks = m.ramp(m.voronoi(m.place(1), 30), (0.12, (0.1, 0.06, 0.03)), (0.16, (0.75, 0.7, 0.6)))
    return m.principled(Base_Color=specks, Roughness=0.35, Coat_Weight=0.6, Coat_Roughness=0.15, Normal=m.bump(m.noise(m.place(1), 8, 2), 0.1, 0.05))


@material
def lustre_raku(m):
    thick = m.noise(m.place(1), 3, 4)
    return m.principled(Base_Color=m.ramp(thick, (0.3, (0.5, 0.2, 0.05)), (0.5, (0.1, 0.3, 0.4)), (0.7, (0.6, 0.5, 0.1))), Metallic=m.range(thick, 0.2, 1.0),
                        Roughness=0.25, Thin_Film_Thickness=m.range(thick, 200.0, 600.0), Thin_Film_IOR=1.5)


@material
def grained_plastic(m):
    return m.principled(Base_Color=(0.05, 0.05, 0.06), Roughness=0.45, Normal=m.bump(m.voronoi(m.place(1), 70), 0.25, 0.01))


@material
def rubber_sole(m):
    sole = m.wave(m.place(1), 10, profile="TRI")
    return m.principled(Base_Color=(0.03, 0.03, 0.03), Roughness=0.8, Specular_IOR_Level=0.3, Normal=m.bump(sole, 0.8, 0.03))


@material
def soap_bubble_wax(m):
    return m.mix(0.35, m.principled(Base_Color=(0.7, 0.6, 0.45), Roughness=0.4), m("BsdfTranslucent", Color=(0.8, 0.5, 0.3)))


@material
def frosted_glass(m):
    return m("BsdfGlass", {"distribution": "GGX"}, Color=(0.9, 0.97, 0.95), Roughness=0.25, IOR=1.45, Normal=m.bump(m.noise(m.place(1), 40, 3), 0.1, 0.02))


@material
def backlit_panel(m):
    grid = m("TexChecker", Vector=m.place(1, "UV"), Scale=12)["Fac"]
    return m.mix(grid, m.principled(Base_Color=(0.02, 0.02, 0.02), Roughness=0.3), m("Emission", Color=(0.3, 0.8, 1.0), Strength=1.5))


# --- sets of images ---

def _waves(rows=128):
    y, x = np.mgrid[:rows, :rows] / rows * 2 * np.pi
    return 0.5 + 0.2 * np.sin(4 * x + np.sin(3 * y)) + 0.2 * np.sin(7 * y + 2 * np.sin(x)) + 0.1 * np.sin(19 * x) * np.sin(17 * y)


def _normals(height, strength):
    dx = np.roll(height, -1, 1) - np.roll(height, 1, 1)
    dy = np.roll(height, -1, 0) - np.roll(height, 1, 0)
    n = np.stack([-dx * strength, -dy * strength, np.full_like(dx, 1.0)], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True) * 0.5 + 0.5


def _grey(values):
    return np.repeat(values[..., None], 3, 2).clip(0, 1)


@material
def scanned_plaster(m):
    height, at = _waves(), m.place(3, "UV")
    color = np.stack([0.5 + 0.3 * height, 0.45 + 0.3 * height, 0.4 + 0.2 * height], -1)
    return m.principled(Base_Color=m.image(color, at), Roughness=m.image(_grey(0.9 - 0.4 * height), at, True),
                        Normal=m("NormalMap", Color=m.image(_normals(height, 3.0), at, True), Strength=1.0))


@material
def scanned_metal_plate(m):
    height, at = _waves(), m.place(2, "UV")
    mask = (height > 0.55).astype(float)
    return m.principled(Base_Color=m.image(_grey(0.3 + 0.4 * mask), at), Metallic=m.image(_grey(mask), at, True),
                        Roughness=m.image(_grey(0.6 - 0.35 * mask), at, True),
                        Normal=m("NormalMap", Color=m.image(_normals(height, 2.0), at, True), Strength=0.8))


@material
def scanned_fabric(m):
    height, at = _waves(64), m.place(8, "UV")
    picture = m.image(_grey(height), at, True)
    return m.principled(Base_Color=m.color("MULTIPLY", 1.0, (0.5, 0.3, 0.2), m.image(_grey(0.4 + 0.6 * height), at)), Roughness=0.9, Sheen_Weight=0.6,
                        Normal=m.bump(picture, 0.5, 0.05))


# --- hair ---

def _glossy(m, **inputs):
    return m("BsdfAnisotropic", {"distribution": "GGX"}, Color=(0.8, 0.4, 0.1), **inputs)


@on_strands
def hair_along(m):
    return _glossy(m, Roughness=0.4, Anisotropy=0.8)


@on_strands
def hair_across(m):
    return _glossy(m, Roughness=0.4, Anisotropy=-0.7)


@on_strands
def hair_turned(m):
    return _glossy(m, Roughness=0.5, Anisotropy=0.8, Rotation=0.15)


@on_strands
def hair_principled(m):
    return m.principled(Base_Color=(0.8, 0.5, 0.2), Metallic=1, Roughness=0.4, Anisotropic=0.8)


@on_strands
def hair_matt(m):
    return m("BsdfDiffuse", Color=(0.8, 0.4, 0.1))
