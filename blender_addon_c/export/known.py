# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known here of each node that is read: its properties, with the words that these may be unless whoever reads them asks,
its inputs and its outputs, by their identifiers in 3.4 to 5.3. What another Blender adds is named where it says something."""

from collections import namedtuple

import bpy

from .. import versions
from . import tree
from .main_thread import on_main_thread

_MOST_GROUPS = 32  # one in another

_Kind = namedtuple("_Kind", "properties inputs outputs")

_TABLE = """
AddShader: | Shader, Shader_001 | Shader
AmbientOcclusion: samples inside only_local | Color, Distance, Normal | Color, AO
Attribute: attribute_type=GEOMETRY,OBJECT,INSTANCER,VIEW_LAYER attribute_name | | Color, Vector, Fac, Alpha
Background: | Color, Strength, Weight | Background
Bevel: samples | Radius, Normal | Normal
Blackbody: | Temperature | Color
BrightContrast: | Color, Bright, Contrast | Color
BsdfAnisotropic: distribution | Color, Roughness, Anisotropy, Rotation, Normal, Tangent, Weight | BSDF
BsdfDiffuse: | Color, Roughness, Normal, Weight | BSDF
BsdfGlass: distribution=SHARP,BECKMANN,GGX,MULTI_GGX | Color, Roughness, IOR, Normal, Weight, Thin Film Thickness, Thin Film IOR
    | BSDF
BsdfGlossy: distribution | Color, Roughness, Normal, Weight | BSDF
BsdfMetallic: distribution=BECKMANN,GGX,MULTI_GGX fresnel_type=PHYSICAL_CONDUCTOR,F82 | Base Color, Edge Tint, IOR, Extinction,
    Roughness, Anisotropy, Rotation, Normal, Tangent, Weight, Thin Film Thickness, Thin Film IOR | BSDF
BsdfPrincipled: distribution=GGX,MULTI_GGX
    subsurface_method=BURLEY,RANDOM_WALK_FIXED_RADIUS,RANDOM_WALK,RANDOM_WALK_SKIN,RANDOM_WALK_LEGACY | Base Color, Subsurface,
    Subsurface Radius, Subsurface Color, Subsurface IOR, Subsurface Anisotropy, Metallic, Specular, Specular Tint, Roughness,
    Anisotropic, Anisotropic Rotation, Sheen, Sheen Tint, Clearcoat, Clearcoat Roughness, IOR, Transmission, Transmission
    Roughness, Emission, Emission Strength, Alpha, Normal, Clearcoat Normal, Tangent, Weight, Subsurface Weight, Subsurface
    Scale, Specular IOR Level, Transmission Weight, Coat Weight, Coat Roughness, Coat IOR, Coat Tint, Coat Normal, Sheen Weight,
    Sheen Roughness, Emission Color, Thin Film Thickness, Thin Film IOR, Diffuse Roughness, Thin Wall | BSDF
BsdfRayPortal: | Color, Position, Direction, Weight | BSDF
BsdfRefraction: distribution=SHARP,BECKMANN,GGX | Color, Roughness, IOR, Normal, Weight | BSDF
BsdfSheen: distribution=ASHIKHMIN,MICROFIBER | Color, Roughness, Normal, Weight | BSDF
BsdfToon: component=DIFFUSE,GLOSSY | Color, Size, Smooth, Normal, Weight | BSDF
BsdfTranslucent: | Color, Normal, Weight | BSDF
BsdfTransparent: | Color, Weight | BSDF
BsdfVelvet: | Color, Sigma, Normal, Weight | BSDF
Bump: invert | Strength, Distance, Height, Normal, Filter Width | Normal
CameraData: | | View Vector, View Z Depth, View Distance
Clamp: clamp_type=MINMAX,RANGE | Value, Min, Max | Result
CombineColor: mode=RGB,HSV,HSL | Red, Green, Blue | Color
CombineHSV: | H, S, V | Color
CombineRGB: | R, G, B | Image
CombineXYZ: | X, Y, Z | Vector
Displacement: space=OBJECT,WORLD | Height, Midlevel, Scale, Normal | Displacement
Emission: | Color, Strength, Weight | Emission
FloatCurve: mapping | Factor, Value | Value
Fresnel: | IOR, Normal | Fac
Gamma: | Color, Gamma | Color
HairInfo: | | Is Strand, Intercept, Length, Thickness, Tangent Normal, Random
Holdout: | Weight | Holdout
HueSaturation: | Hue, Saturation, Value, Fac, Color | Color
Invert: | Fac, Color | Color
LayerWeight: | Blend, Normal | Fresnel, Facing
LightFalloff: | Strength, Smooth | Quadratic, Linear, Constant
LightPath: | | Is Camera Ray, Is Shadow Ray, Is Diffuse Ray, Is Glossy Ray, Is Singular Ray, Is Reflection Ray, Is Transmission
    Ray, Ray Length, Ray Depth, Diffuse Depth, Glossy Depth, Transparent Depth, Transmission Depth, Is Volume Scatter Ray,
    Portal Depth
MapRange: clamp interpolation_type=LINEAR,STEPPED,SMOOTHSTEP,SMOOTHERSTEP data_type=FLOAT,FLOAT_VECTOR | Value, From Min, From
    Max, To Min, To Max, Steps, Vector, From_Min_FLOAT3, From_Max_FLOAT3, To_Min_FLOAT3, To_Max_FLOAT3, Steps_FLOAT3 | Result,
    Vector
Mapping: vector_type=POINT,TEXTURE,VECTOR,NORMAL | Vector, Location, Rotation, Scale | Vector
Math: operation use_clamp | Value, Value_001, Value_002 | Value
Mix: data_type factor_mode=UNIFORM,NON_UNIFORM blend_type clamp_factor clamp_result | Factor_Float, Factor_Vector, A_Float,
    B_Float, A_Vector, B_Vector, A_Color, B_Color, A_Rotation, B_Rotation | Result_Float, Result_Vector, Result_Color,
    Result_Rotation
MixRGB: blend_type use_alpha use_clamp | Fac, Color1, Color2 | Color
MixShader: | Fac, Shader, Shader_001 | Shader
NewGeometry: | | Position, Normal, Tangent, True Normal, Incoming, Parametric, Backfacing, Pointiness, Random Per Island
Normal: | Normal | Normal, Dot
NormalMap: space=TANGENT,OBJECT,WORLD,BLENDER_OBJECT,BLENDER_WORLD uv_map convention=OPENGL,DIRECTX base | Strength,
    Color | Normal
ObjectInfo: | | Location, Color, Alpha, Object Index, Material Index, Random
OutputAOV: aov_name | Color, Value |
OutputLight: is_active_output target=ALL,EEVEE,CYCLES | Surface |
OutputMaterial: is_active_output target=ALL,EEVEE,CYCLES | Surface, Volume, Displacement, Thickness |
OutputWorld: is_active_output target=ALL,EEVEE,CYCLES | Surface, Volume |
ParticleInfo: | | Index, Random, Age, Lifetime, Location, Size, Velocity, Angular Velocity
RadialTiling: normalize | Vector, Sides, Roundness |
    Segment Coordinates, Segment ID, Segment Width, Segment Rotation
RGB: | | Color
RGBCurve: mapping | Fac, Color | Color
RGBToBW: | Color | Val
SeparateColor: mode=RGB,HSV,HSL | Color | Red, Green, Blue
SeparateHSV: | Color | H, S, V
SeparateRGB: | Image | R, G, B
SeparateXYZ: | Vector | X, Y, Z
SubsurfaceScattering: falloff=BURLEY,RANDOM_WALK_FIXED_RADIUS,RANDOM_WALK,RANDOM_WALK_SKIN,RANDOM_WALK_LEGACY | Color, Scale,
    Radius, IOR, Anisotropy, Normal, Weight, Roughness | BSSRDF
Tangent: direction_type=RADIAL,UV_MAP axis=X,Y,Z uv_map | | Tangent
TexBrick: offset_frequency squash_frequency offset squash | Vector, Color1, Color2, Mortar, Scale, Mortar Size, Mortar Smooth,
    Bias, Brick Width, Row Height | Color, Fac
TexChecker: | Vector, Color1, Color2, Scale | Color, Fac
TexCoord: object from_instancer | | Generated, Normal, UV, Object, Camera, Window, Reflection
TexEnvironment: image projection=EQUIRECTANGULAR,MIRROR_BALL interpolation image_user | Vector | Color
TexGradient: gradient_type=LINEAR,QUADRATIC,EASING,DIAGONAL,SPHERICAL,QUADRATIC_SPHERE,RADIAL | Vector | Color, Fac
TexIES: ies filepath mode=INTERNAL,EXTERNAL | Vector, Strength | Fac
TexImage: image projection=FLAT,BOX,SPHERE,TUBE interpolation projection_blend extension image_user | Vector | Color, Alpha
TexMagic: turbulence_depth | Vector, Scale, Distortion | Color, Fac
TexMusgrave: musgrave_dimensions=1D,2D,3D,4D
    musgrave_type=MULTIFRACTAL,RIDGED_MULTIFRACTAL,HYBRID_MULTIFRACTAL,FBM,HETERO_TERRAIN | Vector, W, Scale, Detail, Dimension,
    Lacunarity, Offset, Gain | Fac
TexNoise: noise_dimensions=1D,2D,3D,4D noise_type=MULTIFRACTAL,RIDGED_MULTIFRACTAL,HYBRID_MULTIFRACTAL,FBM,HETERO_TERRAIN
    normalize | Vector, W, Scale, Detail, Roughness, Distortion, Lacunarity, Offset, Gain | Fac, Color
TexSky: sky_type sun_direction turbidity ground_albedo sun_disc sun_size sun_intensity sun_elevation sun_rotation altitude
    air_density dust_density ozone_density aerosol_density | Vector | Color
TexVoronoi: voronoi_dimensions=1D,2D,3D,4D distance=EUCLIDEAN,MANHATTAN,CHEBYCHEV,MINKOWSKI
    feature=F1,F2,SMOOTH_F1,DISTANCE_TO_EDGE,N_SPHERE_RADIUS normalize | Vector, W, Scale, Smoothness, Exponent, Randomness,
    Detail, Roughness, Lacunarity | Distance, Color, Position, W, Radius
TexWave: wave_type=BANDS,RINGS bands_direction=X,Y,Z,DIAGONAL rings_direction=X,Y,Z,SPHERICAL wave_profile=SIN,SAW,TRI | Vector,
    Scale, Distortion, Detail, Detail Scale, Detail Roughness, Phase Offset | Color, Fac
TexWhiteNoise: noise_dimensions=1D,2D,3D,4D | Vector, W | Value, Color
UVMap: from_instancer uv_map | | UV
ValToRGB: color_ramp | Fac | Color, Alpha
Value: | | Value
VectorCurve: mapping | Fac, Vector | Vector
VectorDisplacement: space=TANGENT,OBJECT,WORLD | Vector, Midlevel, Scale | Displacement
VectorMath: operation | Vector, Vector_001, Vector_002, Scale | Vector, Value
VectorRotate: rotation_type=AXIS_ANGLE,X_AXIS,Y_AXIS,Z_AXIS,EULER_XYZ invert | Vector, Center, Axis, Angle, Rotation | Vector
VectorTransform: vector_type=POINT,VECTOR,NORMAL convert_from=WORLD,OBJECT,CAMERA convert_to=WORLD,OBJECT,CAMERA | Vector |
    Vector
VertexColor: layer_name | | Color, Alpha
Wavelength: | Wavelength | Color
"""

# Of a Texture Mapping, which scripts set, what bl_rna does not know.
_MAPPING = {"scale": (1.0,) * 3, "max": (1.0,) * 3, "mapping_x": "X", "mapping_y": "Y", "mapping_z": "Z"}


def _kinds():
    """By bl_idname."""
    made = {}
    for row in _TABLE.strip().replace("\n    ", " ").split("\n"):
        name, rest = row.split(":", 1)
        properties, *sockets = rest.split("|") + ["", ""]
        words = (word.partition("=") for word in properties.split())
        made["ShaderNode" + name] = _Kind({word: frozenset(by.split(",")) if by else None for word, _, by in words},
                                          *({one.strip() for one in part.split(",")} for part in sockets[:2]))
    return made


KINDS = _kinds()
# Of every node, and what Cycles does not read either.
_OF_ALL = {*bpy.types.ShaderNode.bl_rna.properties.keys(), "color_mapping"}


def understood(node, output):
    """Is what a node says there known, as it is set?"""
    kind = KINDS.get(node.bl_idname)
    return not kind or (output.identifier in kind.outputs and not any(_odd_words(node, kind)))


def _odd_words(node, kind):
    """Properties that say what is not known."""
    return (name for name, words in kind.properties.items() if words and getattr(node, name, None) not in (None, "", *words))


def _unknown_of(node):
    """What a node says that is not known, as texts."""
    kind = KINDS.get(node.bl_idname)
    if not kind:
        return []
    told = []
    for name in _odd_words(node, kind):
        rna = node.bl_rna.properties[name]
        item = rna.enum_items.get(getattr(node, name))
        told.append(f"{_title(rna)} {item.name if item else getattr(node, name)}")
    for name in sorted({*node.bl_rna.properties.keys()} - _OF_ALL - kind.properties.keys()):
        if _is_set(node, name):
            told.append(_title(node.bl_rna.properties[name]))
    for socket in node.inputs:
        if socket.identifier not in kind.inputs and socket.enabled and (socket.is_linked or _is_other(node, socket)):
            told.append(socket.name)
    return told


def _title(rna):
    """A property's name, and how scripts call it where that is another."""
    return rna.name if rna.name.lower().replace(" ", "_") == rna.identifier else f"{rna.name} ({rna.identifier})"


def _plain(value):
    """A value that can be compared."""
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, (str, bytes, set)) else value


def _is_set(node, name):
    """Is a property other than in a new node?"""
    rna, value = node.bl_rna.properties[name], getattr(node, name)
    if rna.type == "POINTER" and value is not None and not isinstance(value, bpy.types.ID):
        return any(_plain(getattr(value, part.identifier)) != _MAPPING.get(part.identifier, _default_of(part))
                   for part in value.bl_rna.properties if part.type not in ("POINTER", "COLLECTION"))
    if rna.type in ("POINTER", "COLLECTION"):
        return bool(value)
    return _plain(value) != _new(node, name, lambda other: _plain(getattr(other, name)), _default_of(rna))


def _default_of(rna):
    if getattr(rna, "is_array", False):
        return tuple(rna.default_array)
    return rna.default_flag if getattr(rna, "is_enum_flag", False) else rna.default


def _is_other(node, socket):
    """Does a socket's own value differ from a new node's?"""
    value = _plain(getattr(socket, "default_value", None))
    if value is None or socket.hide_value:
        return False
    rna = socket.bl_rna.properties["default_value"]
    return value != _new(node, socket.identifier, lambda other: _plain(
        next(one for one in other.inputs if one.identifier == socket.identifier).default_value), _default_of(rna))


_of_new = {}  # by bl_idname and name


def _new(node, name, ask, otherwise):
    """What a new node of that kind says: bl_rna knows only what properties are before a node is made. It is asked once."""
    key = node.bl_idname, name
    if key not in _of_new:
        try:
            _of_new[key] = on_main_thread(lambda: _made(node.bl_idname, ask))
        except (RuntimeError, TimeoutError, StopIteration, AttributeError):
            return otherwise
    return _of_new[key]


def _made(idname, ask):
    group = bpy.data.node_groups.new("libshade", "ShaderNodeTree")
    try:
        return ask(group.nodes.new(idname))
    finally:
        bpy.data.node_groups.remove(group)


class Unknown:
    """Of the node trees of a scene, each of which is looked at once."""

    def __init__(self):
        self._of = {}  # by tree: (by node what it says, trees of its groups)

    def name(self, own, warn, with_aovs=False):
        """A warning for each such thing that leads to a tree's output."""
        told = self._all(own, {own})
        if not told:
            return
        for node in _reached(own, with_aovs):
            for text in told.pop(node, ()):
                warn(f"'{node.name}': {text} is not supported; left out")

    def _all(self, own, seen):
        if own not in self._of:
            told = {node: texts for node in own.nodes if (texts := _unknown_of(node))}
            self._of[own] = told, {node.node_tree for node in own.nodes if node.type == "GROUP" and node.node_tree}
        told, groups = self._of[own]
        told = {**told}
        for group in groups - seen:
            seen.add(group)
            told.update(self._all(group, seen))
        return told


def _aovs(own, groups):
    """(node, groups around it) of what says an AOV."""
    for node in own.nodes:
        if node.type == "OUTPUT_AOV" and (versions.MUTED_AOVS_SPEAK or not node.mute):
            yield node, groups
        elif node.type == "GROUP" and node.node_tree and not node.mute and len(groups) < _MOST_GROUPS:
            yield from _aovs(node.node_tree, (*groups, node))


def _reached(own, with_aovs):
    """The nodes that links lead to from a tree's output."""
    output, seen = own.get_output_node("ALL"), set()
    left = ([(output, ())] if output else []) + (list(_aovs(own, ())) if with_aovs else [])
    while left:
        node, groups = left.pop()
        if (node, groups) in seen:
            continue
        seen.add((node, groups))
        yield node
        for socket in node.inputs:
            if socket.is_linked:
                found = tree.trace(socket, groups)
                if found.node:
                    left.append((found.node, found.groups))
