# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of what AOV Output nodes say, and of ambient occlusion. Each is a picture of its own, in which the first surfaces that
the camera sees shine with that, and those without such a node are holes."""

from .. import versions
from .closure import collect, shading
from .graph import Program, TooLarge, is_known
from .value import color_of, number_of
from .visibility import DIFFUSE, SHADOW

_MOST_GROUPS = 32  # one in another
OCCLUSION = "OCCLUSION"
CHANNELS = {"COLOR": 4, "VALUE": 1, OCCLUSION: 3}
OCCLUSION_NAME = "Ambient Occlusion" if versions.LONG_PASS_NAMES else "AO"
BLACK = {"closure": "EMISSION", "weight": (0.0,) * 3}
_RAYS, _MOST_SAMPLES = 2, 1 << 16  # of occlusion, of a sample
# What of a scene is of the picture alone, and what lights it.
_BESIDE = ("sky_hidden", "planes", "mattes", "matte_slots", "mist", "adaptive_threshold", "adaptive_min_samples", "sky", "looks", "backdrop",
           "backdrop_sky", "time_limit")
_DARK = {"background": (0.0,) * 3, "lights": [], "max_bounces": 0, "transparent": True, "dump": "", "sample_clamp_direct": 0.0,
         "sample_clamp_indirect": 0.0}


def of_nodes(view_layer):
    """(name, "COLOR" or "VALUE") of those of AOV Output nodes that a view layer asks for."""
    return [(one.name, one.type) for one in getattr(view_layer, "aovs", ()) if one.is_valid]


def wanted_of(view_layer):
    """(name, one of CHANNELS) of all that it asks for."""
    return ([(OCCLUSION_NAME, OCCLUSION)] if view_layer.use_pass_ambient_occlusion else []) + of_nodes(view_layer)


def view(scene, kind, materials):
    """The scene to be rendered for one of them, of that kind. materials: as many as the scene has."""
    kept = {key: value for key, value in scene.items() if key not in _BESIDE}
    lit = {}
    if kind == OCCLUSION:  # what its rays meet is what shadow rays do
        lit = {"background": (1.0,) * 3, "reach": max(scene["aov_reach"], 1e-30), "samples": min(scene["samples"] * _RAYS, _MOST_SAMPLES),
               "instances": [_as_to_shadows(one) for one in _with_catchers(scene)]}
    return {**kept, **_DARK, **lit, "materials": materials}


def _with_catchers(scene):
    """Its instances; shadow catchers in place of the holes that they leave."""
    held = {id(one) for one in scene["catchers"]["held"]}
    there = {id(one) for one in scene["instances"]}
    return [*(one for one in scene["instances"] if id(one) not in held),
            *(one for one in scene["catchers"]["seen"] if id(one) not in there)]


def _as_to_shadows(instance):
    hidden = instance["hidden"]
    return instance if (hidden & SHADOW != 0) == (hidden & DIFFUSE != 0) else {**instance, "hidden": hidden ^ DIFFUSE}


def read_into(reader, own, name, kind, threshold, held, shades):
    """What a material of that node tree, or None, says by that name, as the native module takes a material. kind: one of CHANNELS.
    threshold: of its alpha, below which the next surfaces say it as well; None where light does not pass through it. held: is it a
    hole in the picture? shades: does it stop shadow rays, however clear?"""
    try:
        if kind == OCCLUSION:
            return _material(reader, [BLACK]) if held else _occluded(reader, own, threshold is not None, shades)
        return _finished(reader, own, name, kind == "COLOR", threshold)
    except (TooLarge, RecursionError):
        reader.warn(f"its nodes are too many for the pass '{name}'; left out")
        reader.program = Program()
        return _material(reader, [{"closure": "EMISSION", "holds": True}])


def _finished(reader, own, name, is_color, threshold):
    found = _find(own, name, ()) if own else None
    clear = 0.0 if threshold is None else _clear(reader, own, 1.0 - threshold)
    if found:
        node, groups = found
        socket = node.inputs["Color" if is_color else "Value"]
        value = color_of(reader, socket, groups) if is_color else (number_of(reader, socket, groups),) * 3
        made = [{"closure": "EMISSION", "weight": tuple(value)}]
    else:
        made = [{"closure": "EMISSION", "holds": True, "weight": (reader.program.math("SUBTRACT", 1.0, clear),) * 3}]
    if not is_known(clear) or clear:
        made.append({"closure": "TRANSPARENT", "weight": (clear,) * 3})
    return _material(reader, made)


def _occluded(reader, own, passes, shades):
    """How much of the hemisphere about what is matt in it, or about the surface's own normal, is free of others, as far as the
    world's ambient occlusion goes; of what is clear, the surface behind says it. passes: is any of it clear?"""
    math, through = reader.program.math, (0.0,) * 3
    output = own.get_output_node("ALL") if own else None
    if output:
        collect(reader, output.inputs["Surface"], ())
    if shades:
        shading(reader, "CAMERA", True)
    for closure in reader.closures if passes else ():
        if closure["closure"] == "TRANSPARENT":
            through = tuple(math("ADD", sum_, part) for sum_, part in zip(through, closure.get("weight", (1.0,) * 3)))
    normal = next((closure.get("normal") for closure in reader.closures if closure["closure"] == "DIFFUSE"), None)
    normal = normal and reader.below.get(normal[0], normal)
    there = tuple(math("MAXIMUM", math("SUBTRACT", 1.0, part), 0.0) for part in through)
    made = [{"closure": "DIFFUSE", "model": "LAMBERT", "color": (1.0,) * 3, "roughness": [0.0], "bumps": "OPEN", "weight": there,
             **({"normal": normal} if normal else {})}]
    return _material(reader, made + ([{"closure": "TRANSPARENT", "weight": through}] if passes else []))


def _material(reader, closures):
    nodes, closures = reader.program.finish(closures)
    return {"nodes": nodes, "closures": closures, "drawn": False}


def _find(own, name, groups):
    """(node, groups around it) of the one that says it, or None."""
    for node in own.nodes:
        if node.mute and not (versions.MUTED_AOVS_SPEAK and node.type == "OUTPUT_AOV"):
            continue
        if node.type == "OUTPUT_AOV" and getattr(node, "aov_name", node.name) == name:  # until 4.0 it was the node's own
            return node, groups
        if node.type == "GROUP" and node.node_tree and len(groups) < _MOST_GROUPS:
            found = _find(node.node_tree, name, (*groups, node))
            if found:
                return found
    return None


def _clear(reader, own, least):
    """The part of light that it lets through, if that is more than the least: what is behind it counts as much. In Cycles
    as much as paths go on, which is more where the rest of the surface is dark [measured in 3.4 and 5.0]."""
    collect(reader, own.get_output_node("ALL").inputs["Surface"], ())
    math, through = reader.program.math, 0.0
    if not reader.closures:  # there is only a volume
        return 1.0
    for closure in reader.closures:
        if closure["closure"] == "TRANSPARENT":
            for part in closure.get("weight", (1.0,) * 3):
                through = math("ADD", through, math("MULTIPLY", part, 1 / 3))
    return math("MULTIPLY", through, math("GREATER_THAN", through, least))
