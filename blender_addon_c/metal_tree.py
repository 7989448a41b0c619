# SPDX-License-Identifier: GPL-3.0-or-later
"""What other renderers see of the metal node: an Anisotropic BSDF behind Libshade Groove, whose grooves follow
bumps. Older files have less inside, or a Principled BSDF, and keep it."""

from math import tau

from . import groove, working_space
from .group import like_pattern, new_socket, say

# Sockets that properties set: what these say counts until a socket is linked or says something else.
SHAPE, MATT_COLOR, EDGE = ("Roughness", "Anisotropy"), ("Diffuse Color",), ("Edge Tint",)
_OLD_SHADER = "Principled BSDF"
_SHADER, _MATT, _GROOVE, _FRESNEL, _COLOR = "Anisotropic BSDF", "Diffuse BSDF", "Groove", "Fresnel", "Color"
_INSIDE = {_SHADER, _MATT, _GROOVE, _FRESNEL, _COLOR}
# Not in files of before: is the anisotropy below 0; the tangent then; the tangent where none is linked, of a map or
# round an axis, or along one; that of the map or, where a mesh has none, the object's x axis; what 82 degrees lack of Schlick's
_ACROSS, _STROKES = "Across", "Strokes"
_EITHER, _ROUND, _AXIS, _MAP, _MAPLESS = "Either", "Tangent", "Axis", "UV Map", "Mapless"
_EDGE, _DIP = "Edge", "Dip"
# Nor of strokes: their places, those turned by Rotation, sizes, shares of a point, and what they make of Roughness
_STROKES_PLACE, _STROKES_MAP, _TURNED, _SIZES, _SHARE, _WORN = (
    "Place", "Place in UV Map", "Turned", "Sizes", "Share of Strokes", "Worn")
# Of Cycles' distributions the nearest.
_DISTRIBUTION = {"ASHIKHMIN_SHIRLEY": "ASHIKHMIN_SHIRLEY", "GGX": "GGX"}
AT_82 = (6 / 7) ** 5  # Schlick's share of white at a cosine of 1/7
# An axis of the object, with a little of the next ones for faces that it is at right angles to.
_LEAN = (1.0, 1e-3, 1e-6)
TINTED = ("SCHLICK", "F82")  # Fresnels that Edge Tint tells
# What strokes are like: alphas there, less those between; octaves after the coarsest, and how much weaker each is; their contrast;
# widths in a length, and lengths round an axis.
ROUGHER, OCTAVES, UNEVEN, CONTRAST, LENGTHS, A_TURN = 4.0, 8.0, 0.75, 1.2, 40.0, 0.5
_STEPS = 72  # of a turn, by which strokes turn: places that a texture turned by less and less would be sheared


def axis_vector(axis):
    """Along "X", "Y" or "Z" of an object."""
    at = "XYZ".index(axis)
    return tuple(_LEAN[(i - at) % 3] for i in range(3))


def shape_of(ax, ay):
    """Roughness and anisotropy of alphas, as Cycles' Anisotropic BSDF has them: r² (1 - a) along the tangent and
    r² / (1 - a) across, or for a < 0 r² / (1 + a) and r² (1 + a)."""
    narrow, wide = sorted((ax, ay))
    ratio = 1.0 - (narrow / wide) ** 0.5
    return min(1.0, (ax * ay) ** 0.25), ratio if ax < ay else -ratio


def alphas_of(roughness, anisotropy):
    """The way back; of numbers outside of what shades, the nearest that does (as Cycles, to .99 of anisotropy)."""
    anisotropy, roughness = max(-0.99, min(0.99, anisotropy)), max(0.01, min(1.0, roughness))
    size, alpha = 1.0 - abs(anisotropy), roughness * roughness
    small, large = alpha * size, min(1.0, alpha / size)
    return (small, large) if anisotropy > 0 else (large, small)


def reflectance(n, k, cosine):
    """Of a conductor, of light that is not polarised."""
    index = complex(n, -k)
    along = (index * index - (1.0 - cosine * cosine)) ** 0.5
    across, within = ((a - b) / (a + b) for a, b in ((cosine, along), (index * index * cosine, along)))
    return 0.5 * (abs(across) ** 2 + abs(within) ** 2)


def edge_tint(n, k):
    """What a conductor at 82 degrees keeps of Schlick's value, 0 to 1."""
    head_on = reflectance(n, k, 1.0)
    return min(1.0, reflectance(n, k, 1 / 7) / (head_on + (1.0 - head_on) * AT_82))


def here(eta, k):
    """The index and extinction, by channel, of a metal whose colours in the file's working space, head-on and at 82 degrees,
    are those that these reflect in Rec. 709."""
    if not working_space.from_rec709():
        return eta, k
    head_on, edge = (working_space.here([reflectance(n, x, cosine) for n, x in zip(eta, k)]) for cosine in (1.0, 1 / 7))
    return tuple(zip(*map(_index_of, head_on, edge)))


def _index_of(head_on, edge):
    """That reflects so much: the larger the index, of all that reflect the same head-on, the less at 82 degrees [Gulbrandsen2014]."""
    head_on = min(max(head_on, 1e-6), 1.0 - 1e-6)
    low, high = (1 - head_on) / (1 + head_on), (1 + head_on**0.5) / (1 - head_on**0.5)

    def extinction(n):
        return max((head_on * (n + 1) ** 2 - (n - 1) ** 2) / (1 - head_on), 0.0) ** 0.5

    for _ in range(60):
        n = 0.5 * (low + high)
        low, high = (n, high) if reflectance(n, extinction(n), 1 / 7) > edge else (low, n)
    return n, extinction(n)


def new_tree(color):
    """Such a tree; color: of the metal head-on."""
    return like_pattern("Libshade Metal", lambda tree: _fill(tree, color))


def _fill(tree, color):
    _add_sockets(tree, color)

    def new(kind, x, y, name=""):
        node = tree.nodes.new(kind)
        node.location, node.name = (x, y), name or node.name
        return node

    inputs, outputs = new("NodeGroupInput", -700, 0), new("NodeGroupOutput", 1300, 0)
    group = new("ShaderNodeGroup", 50, -200, _GROOVE)
    group.node_tree, group.label = groove.groove_tree(), groove.NAME
    shader, matt = new("ShaderNodeBsdfAnisotropic", 900, 0, _SHADER), new("ShaderNodeBsdfDiffuse", 900, -250, _MATT)
    both, link = new("ShaderNodeAddShader", 1100, 0), tree.links.new
    link(inputs.outputs["Normal"], group.inputs["Normal"])
    link(_tangent(tree, new, inputs.outputs["Tangent"]), group.inputs["Tangent"])
    link(_color(tree, new, inputs.outputs, group.outputs["Normal"]), shader.inputs["Color"])
    for name in (*SHAPE, "Rotation"):
        link(inputs.outputs[name], shader.inputs[name])
    _strokes(tree, new, inputs.outputs["Roughness"], inputs.outputs["Rotation"])
    across, strokes = new("ShaderNodeMath", 200, -350, _ACROSS), new("ShaderNodeMix", 400, -250, _STROKES)
    across.operation, strokes.data_type = "LESS_THAN", "VECTOR"
    across.inputs[1].default_value = 0.0
    link(inputs.outputs["Anisotropy"], across.inputs[0])
    sockets = mixed(strokes)
    link(group.outputs[groove.TANGENT], sockets["A_Vector"])
    link(group.outputs[groove.ACROSS], sockets["B_Vector"])
    link(sockets["Result_Vector"], shader.inputs["Tangent"])
    link(inputs.outputs["Diffuse Color"], matt.inputs["Color"])
    for node in (shader, matt):
        link(group.outputs["Normal"], node.inputs["Normal"])
    link(shader.outputs["BSDF"], both.inputs[0])
    link(matt.outputs["BSDF"], both.inputs[1])
    link(both.outputs["Shader"], outputs.inputs["BSDF"])


def _add_sockets(tree, color):
    def add(kind, name, about, value=None, limits=None, subtype="NONE"):
        socket = new_socket(tree, name, "INPUT", f"NodeSocket{kind}", subtype)
        socket.description = about
        if value is not None:
            socket.default_value = value
        if limits:
            socket.min_value, socket.max_value = limits
        return socket

    add("Color", "Color", "Of the reflection, seen head-on", (*color, 1.0))
    add("Color", "Edge Tint", "What is left of the reflection at 82 degrees, beside a white edge's", (1.0,) * 4)
    add("Float", "Roughness", "Its square is the width of the reflection", limits=(0.0, 1.0), subtype="FACTOR")
    add("Float", "Anisotropy", "How much narrower it is along the strokes: .9 is 100 : 1", limits=(-0.99, 0.99), subtype="FACTOR")
    add("Float", "Rotation", "Turns the tangent; 1 is all the way round", limits=(0.0, 1.0), subtype="FACTOR")
    add("Color", "Diffuse Color", "Of what is reflected to all sides", (0.0, 0.0, 0.0, 1.0))
    add("Vector", "Normal", "Bumped; unlinked, the surface's own").hide_value = True
    add("Vector", "Tangent", "Where the strokes run; unlinked, as Grain says").hide_value = True
    new_socket(tree, "BSDF", "OUTPUT", "NodeSocketShader")


def _color(tree, new, given, normal):
    """Schlick's by the angle to the eye, less what Edge Tint takes: (1 - tint) of it at a cosine of 1/7."""
    link = tree.links.new
    facing, power = new("ShaderNodeLayerWeight", -100, 300), new("ShaderNodeMath", 50, 300)
    edge, color = new("ShaderNodeMath", 200, 300, _FRESNEL), new("ShaderNodeMixRGB", 350, 200, _COLOR)
    facing.inputs["Blend"].default_value = 0.5  # Facing is then 1 less the cosine to the eye
    power.operation, edge.operation = "POWER", "MULTIPLY"
    power.inputs[1].default_value = 5.0
    color.inputs["Color2"].default_value = (1.0, 1.0, 1.0, 1.0)
    link(normal, facing.inputs["Normal"])
    link(facing.outputs["Facing"], power.inputs[0])
    link(power.outputs[0], edge.inputs[0])
    link(edge.outputs[0], color.inputs["Fac"])
    link(given["Color"], color.inputs["Color1"])
    # cosine (1 - cosine)^6, 1 where the cosine is 1/7
    cosine, sixth, dip = (new("ShaderNodeMath", x, 500, name) for x, name in ((50, ""), (200, ""), (350, _DIP)))
    cosine.operation, sixth.operation, dip.operation = "SUBTRACT", "POWER", "MULTIPLY"
    cosine.inputs[0].default_value, sixth.inputs[1].default_value = 1.0, 6.0
    link(facing.outputs["Facing"], cosine.inputs[1])
    link(facing.outputs["Facing"], sixth.inputs[0])
    link(cosine.outputs[0], dip.inputs[0])
    link(sixth.outputs[0], dip.inputs[1])
    whole, at_82, lost = (new(kind, x, 700, name) for kind, x, name in (
        ("ShaderNodeMath", 500, _EDGE), ("ShaderNodeMixRGB", 50, "At 82"), ("ShaderNodeMixRGB", 350, "Lost")))
    whole.operation = "MULTIPLY"
    link(dip.outputs[0], whole.inputs[0])
    at_82.inputs["Fac"].default_value, at_82.inputs["Color2"].default_value = AT_82, (1.0,) * 4
    link(given["Color"], at_82.inputs["Color1"])
    lost.blend_type, lost.inputs["Fac"].default_value = "SUBTRACT", 1.0
    lost.inputs["Color1"].default_value = (1.0,) * 4
    link(given["Edge Tint"], lost.inputs["Color2"])
    share, rest = new("ShaderNodeMixRGB", 500, 600, "Share"), new("ShaderNodeMixRGB", 700, 300, "Rest")
    share.blend_type, share.inputs["Fac"].default_value = "MULTIPLY", 1.0
    link(at_82.outputs[0], share.inputs["Color1"])
    link(lost.outputs[0], share.inputs["Color2"])
    rest.blend_type, rest.use_clamp = "SUBTRACT", True
    link(whole.outputs[0], rest.inputs["Fac"])
    link(color.outputs[0], rest.inputs["Color1"])
    link(share.outputs[0], rest.inputs["Color2"])
    return rest.outputs[0]


def _tangent(tree, new, given):
    """What is linked, or what Grain says."""
    link = tree.links.new

    def where(vector, then, other, x, name):
        """One socket or another, by whether a vector is there."""
        length, there = new("ShaderNodeVectorMath", x - 300, -400), new("ShaderNodeMath", x - 150, -400)
        mix = new("ShaderNodeMix", x, -200, name)
        length.operation, there.operation, mix.data_type = "LENGTH", "GREATER_THAN", "VECTOR"
        there.inputs[1].default_value = 0.0
        sockets = mixed(mix)
        for source, target in ((vector, length.inputs[0]), (length.outputs["Value"], there.inputs[0]),
                               (there.outputs[0], sockets["Factor_Float"]), (then, sockets["B_Vector"]), (other, sockets["A_Vector"])):
            link(source, target)
        return sockets["Result_Vector"]

    round_, axis, uv = (new(f"ShaderNode{kind}", -900, y, name) for kind, y, name in (
        ("Tangent", -300, _ROUND), ("VectorTransform", -500, _AXIS), ("UVMap", -700, _MAP)))
    round_.direction_type = "UV_MAP"
    axis.vector_type, axis.convert_from, axis.convert_to = "VECTOR", "OBJECT", "WORLD"
    axis.inputs["Vector"].default_value = axis_vector("X")
    # without a map Cycles' own tangents run round the object, ours along its x axis
    return where(given, given, where(uv.outputs[0], round_.outputs[0], axis.outputs[0], -400, _MAPLESS), -100, _EITHER)


def _strokes(tree, new, roughness, rotation):
    """What the tool left, as far as noise of Cycles' tells it: a factor of Roughness, which feeds the shader where there are strokes."""
    link = tree.links.new
    place, uv, sizes = new("ShaderNodeTexCoord", -300, -900), new("ShaderNodeUVMap", -300, -1150, _STROKES_MAP), new(
        "ShaderNodeVectorMath", -100, -900, _SIZES)
    turned, noise, share, root, worn = (new(f"ShaderNode{kind}", x, -900, name) for kind, x, name in (
        ("VectorRotate", -200, _TURNED), ("TexNoise", 100, ""), ("MapRange", 300, _SHARE), ("Math", 500, ""), ("Math", 700, _WORN)))
    place.name = _STROKES_PLACE
    sizes.operation, root.operation, worn.operation, worn.use_clamp = "MULTIPLY", "POWER", "MULTIPLY", True
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 1.0, OCTAVES
    noise.inputs["Roughness"].default_value = UNEVEN
    # even noise is .5 +- about a quarter; alphas are squares of roughness
    share.inputs["From Min"].default_value, share.inputs["From Max"].default_value = 0.25, 0.75
    share.inputs["To Min"].default_value, root.inputs[1].default_value = 1.0, 0.5
    turned.invert = True
    link(_faced(tree, new), turned.inputs["Axis"])
    steps, step, angle = (new("ShaderNodeMath", x, -1300) for x in (-500, -350, -200))
    steps.operation, step.operation, angle.operation = "MULTIPLY", "ROUND", "MULTIPLY"
    steps.inputs[1].default_value, angle.inputs[1].default_value = _STEPS, tau / _STEPS
    for source, target in ((rotation, steps.inputs[0]), (steps.outputs[0], step.inputs[0]), (step.outputs[0], angle.inputs[0]),
                           (angle.outputs[0], turned.inputs["Angle"]),
                           (place.outputs["Object"], turned.inputs["Vector"]), (turned.outputs[0], sizes.inputs[0]),
                           (sizes.outputs[0], noise.inputs["Vector"]),
                           (noise.outputs[0], share.inputs["Value"]), (share.outputs[0], root.inputs[0]),
                           (root.outputs[0], worn.inputs[0]), (roughness, worn.inputs[1])):
        link(source, target)
    uv.location = (-300, -1150)


def _faced(tree, new):
    """The axis of the object that a face looks along most."""
    link = tree.links.new
    normal, into, size, parts, largest, whole, below, share, only = (new(f"ShaderNode{kind}", -1500 + 150 * k, -1500) for k, kind in enumerate((
        "NewGeometry", "VectorTransform", "VectorMath", "SeparateXYZ", "Math", "Math", "Math", "VectorMath", "VectorMath")))
    floor = new("ShaderNodeVectorMath", -100, -1500)
    into.vector_type, into.convert_from, into.convert_to = "NORMAL", "WORLD", "OBJECT"
    size.operation, largest.operation, whole.operation, below.operation = "ABSOLUTE", "MAXIMUM", "MAXIMUM", "MULTIPLY"
    below.inputs[1].default_value = 1.0 - 1e-4
    share.operation, floor.operation, only.operation = "DIVIDE", "FLOOR", "MULTIPLY"
    for source, target in ((normal.outputs["True Normal"], into.inputs[0]), (into.outputs[0], size.inputs[0]), (size.outputs[0], parts.inputs[0]),
                           (parts.outputs[0], largest.inputs[0]), (parts.outputs[1], largest.inputs[1]), (largest.outputs[0], whole.inputs[0]),
                           (parts.outputs[2], whole.inputs[1]), (whole.outputs[0], below.inputs[0]), (size.outputs[0], share.inputs[0]),
                           (below.outputs[0], share.inputs[1]), (share.outputs[0], floor.inputs[0]), (floor.outputs[0], only.inputs[0]),
                           (into.outputs[0], only.inputs[1])):
        link(source, target)
    return only.outputs[0]


def _update_strokes(tree, by):
    inner, strength = tree.nodes, getattr(by, "strokes", 0.0)
    if _TURNED not in inner:
        return
    target, worn = inner[_SHADER].inputs["Roughness"], inner[_WORN]
    if strength > 0:
        if not target.is_linked or target.links[0].from_node != worn:
            tree.links.new(worn.outputs[0], target)
    elif target.is_linked and target.links[0].from_node == worn:
        tree.links.new(worn.inputs[1].links[0].from_socket, target)
    say(inner[_SHARE].inputs["To Max"], "default_value", 1.0 + ROUGHER * strength)
    kind, _space, axis = by.grain.partition("_")
    across = 1e3 / by.stroke_width
    along = across / LENGTHS
    source, sizes = (inner[_STROKES_MAP].outputs[0], (along, across, 0.0)) if kind == "UV" else (
        inner[_STROKES_PLACE].outputs["Object"], tuple(along if (part == axis) == (kind == "AXIS") else across for part in "XYZ"))
    turned = inner[_TURNED]
    if turned.inputs["Vector"].links[0].from_socket != source:
        tree.links.new(source, turned.inputs["Vector"])
    say(turned, "rotation_type", "Z_AXIS" if kind == "UV" else "AXIS_ANGLE")
    say(inner[_SIZES].inputs[1], "default_value", sizes)
    say(inner[_STROKES_MAP], "uv_map", by.uv_map)


def mixed(node):
    """Sockets of a Mix node by identifier: their names repeat."""
    return {socket.identifier: socket for socket in (*node.inputs, *node.outputs)}


# ---- what properties change in it


def can_update(tree):
    """Is it as it was made, one time or another? Else someone has been inside."""
    inner = tree.nodes if tree else {}
    return _OLD_SHADER in inner or all(name in inner for name in _INSIDE)


def update(tree, by, alphas):
    """Carry the settings of a node (`by`), whose lobe has these alphas, over to the shaders inside."""
    inner = tree.nodes
    if _OLD_SHADER in inner:
        _update_principled(inner[_OLD_SHADER], *alphas)
        return
    shader, matt = inner[_SHADER], inner[_MATT]
    tailed = getattr(by, "strokes", 0.0) > 0
    say(shader, "distribution", "GGX" if tailed else _DISTRIBUTION.get(by.distribution, "BECKMANN"))
    for name, value in zip(SHAPE, shape_of(*alphas)):  # where no sockets feed them
        say(shader.inputs[name], "default_value", value)
    say(matt.inputs["Color"], "default_value", (*by.kd, 1.0))
    _update_fresnel(tree, by)
    _update_strokes(tree, by)
    if _STROKES in inner:
        _turn_strokes(tree, by)
    else:
        groove_x = by.groove == "X" or by.groove == "AUTO" and alphas[0] <= alphas[1]
        tree.links.new(inner[_GROOVE].outputs[groove.TANGENT if groove_x else groove.ACROSS],
                       shader.inputs["Tangent"])
    if _EITHER in inner:
        _update_grain(inner, by)
        _feed(tree, inner[_GROOVE].inputs["Normal"], "Normal", by.bump_response == "FOLLOW")


def _update_principled(shader, ax, ay):
    """Cycles' convention: alphas are r²/a along the tangent and r²·a across, with a² = 1 − 0.9 anisotropic;
    a quarter turn swaps the two."""
    narrow, wide = sorted((ax, ay))
    shader.inputs["Roughness"].default_value = min(1.0, (narrow * wide) ** 0.25)
    shader.inputs["Anisotropic"].default_value = min(1.0, (1.0 - narrow / wide) / 0.9)
    shader.inputs["Anisotropic Rotation"].default_value = 0.25 if ax < ay else 0.0


def _feed(tree, socket, name, fed=True, value=None):
    """Is a socket inside fed by the node's own? Else it has the value."""
    links = tree.links
    if fed and not socket.is_linked:
        links.new(next(n for n in tree.nodes if n.bl_idname == "NodeGroupInput").outputs[name], socket)
    elif not fed:
        for link in socket.links:
            links.remove(link)
    if value is not None:
        say(socket, "default_value", value)


def _update_fresnel(tree, by):
    inner, conductor = tree.nodes, by.fresnel == "CONDUCTOR"
    hidden = conductor and not getattr(by, "set_color", (0,) * 4)[3]  # else the sockets show it
    say(inner[_FRESNEL].inputs[1], "default_value", float(by.fresnel != "NONE"))
    head_on = (*[reflectance(n, k, 1.0) for n, k in zip(by.eta, by.k)], 1.0) if conductor else None
    _feed(tree, inner[_COLOR].inputs["Color1"], "Color", not hidden, head_on)
    if _EDGE not in inner:
        return
    scale = 7 * (7 / 6) ** 6 if conductor or by.fresnel in TINTED else 0.0
    say(inner[_EDGE].inputs[1], "default_value", scale)
    tint = (*[edge_tint(n, k) for n, k in zip(by.eta, by.k)], 1.0) if conductor else None
    _feed(tree, inner["At 82"].inputs["Color1"], "Color", not hidden, head_on)
    _feed(tree, inner["Lost"].inputs["Color2"], "Edge Tint", not hidden, tint)


def _turn_strokes(tree, by):
    """To the narrow axis, wherever that is, or to the one that is asked for."""
    across, factor = tree.nodes[_ACROSS], mixed(tree.nodes[_STROKES])["Factor_Float"]
    if by.groove == "AUTO":
        if not factor.is_linked:
            tree.links.new(across.outputs[0], factor)
        return
    for link in factor.links:
        tree.links.remove(link)
    say(factor, "default_value", float(by.groove == "Y"))


def _update_grain(inner, by):
    kind, _space, axis = by.grain.partition("_")
    round_, along = inner[_ROUND], inner[_AXIS]
    source = {"AXIS": along, "UV": inner.get(_MAPLESS, round_)}.get(kind, round_)
    target = mixed(inner[_EITHER])["A_Vector"]
    if target.links[0].from_node != source:
        inner.id_data.links.new(mixed(source)["Result_Vector"] if source.name == _MAPLESS else source.outputs[0], target)
    say(along.inputs["Vector"], "default_value", axis_vector(axis if kind == "AXIS" else "X"))
    if kind == "RADIAL":
        say(round_, "direction_type", "RADIAL")
        say(round_, "axis", axis)
    elif kind == "UV":
        say(round_, "direction_type", "UV_MAP")
        for node in (round_, inner.get(_MAP)):
            if node:
                say(node, "uv_map", by.uv_map)
