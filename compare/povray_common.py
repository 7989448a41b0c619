# SPDX-License-Identifier: Apache-2.0
"""POV-Ray's examples as text that both renderers can show: what povray_twins.py has no meshes or lights for is taken out
or replaced, and named. A pattern that is not found is an error: the example has changed, and its twin must."""
import re

BACKGROUND = 0.02
LAMP = " <-5, 8, -6>, rgb 1 "  # of examples that have none
# In place of a sky: (from where, colour). From behind, low, so that what lies flat shines; from the right; from the left.
SKY = (((1.9, 3.6, 9), (0.5, 0.5, 0.5)), ((6, 5, -6), (0.35, 0.4, 0.5)), ((-9, 4, 1), (0.5, 0.45, 0.35)))
LAMBERT = "pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 mdf {{ specular 0 diffuse lambert rgb {} }} }}"
CLIPPED = "clipped_by {{ box {{ <{}, -1, {}>, <{}, 1, {}> }} }}"  # a plane's part that the twin has
# Strokes along an axis: as Blender's node has it, which leans a little for faces at right angles to it
LEAN = {"x": "<1, 1e-6, 1e-3>", "y": "<1e-3, 1, 1e-6>", "z": "<1e-6, 1e-3, 1>"}
NO_SCRATCHES = "preset metals without their scratches"
NO_CLOTH_PIGMENT = "the table cloth in its preset's colours, not turned"


def plane(head, part, rest=""):
    """An edit of a plane: its part (x from, z from, x to, z to), and what else it says."""
    return head, head + CLIPPED.format(*part) + " " + rest


# By example: what is left out, beside what all leave out; edits (text, what comes in its place).
EDITS = {
    "metals": ((), (
        ("pigment { rgb 0.18 }\n  finish { ambient 0 diffuse 0.6 }", LAMBERT.format(0.108) + CLIPPED.format(-60, -12, 60, 40)),
    )),
    "turned": ((), (
        ("tangent x\n", "tangent <1, -1e-3, 1e-6>\n"),  # turned with its texture, LEAN of y
        plane("y, 0\n  ", (-60, -12, 60, 40)),
    )),
    "embossed": (("the map's filter",), (('png "basket.png"', 'png "basket.png" filter off'),)),
    "scratches": ((NO_SCRATCHES,), (
        ("scratches { mm_per_unit MmPerUnit }", "scratches off"),
        ("plane { y, 0 ", "plane { y, 0 " + CLIPPED.format(-60, -12, 60, 40) + " "),
    )),
    "inlay": (("patterns of pigments: each metal has one colour",), (
        ("tangent x specular pigment", "tangent x specular rgb <.56, .55, .53>"),
        ("tangent uv specular pigment", "tangent uv specular rgb <.5, .5, .5>"),
        ("tangent radial y specular pigment", "tangent radial y specular rgb <.95, .6, .46>"),
        ("tangent z specular pigment", "tangent z specular rgb <.56, .52, .42>"),
        plane("plane {\n  y, 0\n  ", (-60, -12, 60, 40)),
    )),
    "reflection": (("the checkered box in one matt colour",), (
        ("pigment { checker rgb <0.75, 0.12, 0.08> rgb 0.7 scale 0.3 } finish { ambient 0 diffuse 0 emission 0.8 }",
         LAMBERT.format("<.7, .12, .08>")),
    )),
    "presets": ((NO_SCRATCHES,), (
        ("mdf { reflection { samples 12 } }", "mdf { scratches off }"),
        ("pigment { rgb .35 } finish { ambient 0 diffuse .7 }", LAMBERT.format(.245)),
        ("pigment { rgb <.30, .27, .24> } finish { ambient 0 diffuse .7 }", LAMBERT.format("<.21, .19, .17>")),
    )),
    "cloth": (("the net, whose yarns are no preset's", NO_CLOTH_PIGMENT, "a lamp without shadows as one with them"), (
        (" shadowless", ""),
        ("mdf { fabric { preset \"linen\" mm_per_unit 180 yarns { diffuse pigment } backing rgb .05 } }",
         "mdf { fabric { preset \"linen\" mm_per_unit 180 } }"),
        ("rotate 30*y\n", ""),
        plane("plane {\n  y, 0\n  ", (-40, -7, 40, 40)),
    )),
    "lampshade": (("the shade's own yarns, which let light through: preset linen", NO_SCRATCHES), (
        ("fabric { crossings <300, 60> yarns { diffuse fibre rgb <.62, .52, .36> transmit rgb <.22, .17, .10> } backing rgb .02 }",
         "fabric { mm_per_unit 900 }"),
        ("MDF_F_Turned_Brass ambient .1", "MDF_F_Turned_Brass mdf { scratches off }"),
        ("rgb <1, .78, .5>*4 ", "rgb <1, .78, .5>*5e6 "), ("fade_distance 1.6", "fade_distance .001"),
        ("plane { y, 0 ", "plane { y, 0 " + CLIPPED.format(-40, -8, 40, 8) + " "),
    )),
    "kitchen": ((NO_SCRATCHES, NO_CLOTH_PIGMENT), (
        ("MDF_F_Turned_Steel mdf { scratches { mm_per_unit 90 }", "MDF_F_Turned_Steel mdf { scratches off"),
        ("tangent z scratches { mm_per_unit 260 }", "tangent z scratches off"),
        ("scratches { mm_per_unit 400 }", "scratches off"),
        ("finish { MDF_F_Turned_Brass }", "finish { MDF_F_Turned_Brass mdf { scratches off } }"),
        ("yarns { diffuse pigment } backing rgb .1 ", ""), ("    rotate 12*y\n", ""),
        plane("plane {\n  y, 0\n  ", (-60, -8, 60, 40)),
    )),
}


class Changed(Exception):
    """An example is not what its edits expect."""


def end_of(text, start):
    """Behind the brace that closes the first one from `start` on."""
    depth = 0
    for at in range(text.index("{", start), len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if not depth:
            return at + 1
    raise Changed("a brace that nothing closes")


def without(text, pattern, keep=lambda block: False):
    """The text without the blocks `pattern { … }`, and how many there were."""
    at, count = 0, 0
    while (found := re.compile(pattern + r"\s*{").search(text, at)):
        end = end_of(text, found.start())
        if keep(text[found.start():end]):
            at = found.end()
        else:
            text, at, count = text[:found.start()] + text[end:], found.start(), count + 1
    return text, count


def common(name, text):
    """(the example's text as both renderers can show it, what that leaves out)."""
    own, edits = EDITS[name]
    text = re.sub(r"//[^\n]*", "", text)
    left = []

    def gone(pattern, words, keep=lambda block: False):
        nonlocal text
        text, count = without(text, pattern, keep)
        if count:
            left.append(words)
        return count

    for old, new in edits:
        if old not in text:
            raise Changed(f"{name}.pov has no `{old}`, which povray_common.py replaces")
        text = text.replace(old, new)
    left += own
    gone(r"\bradiosity", "radiosity")
    gone(r"\bnormal", "POV-Ray's own patterns of normals")
    # the low one is behind the wall of presets, and lets bumps of embossed glitter, which are finer than pixels far away
    suns = SKY if name not in ("presets", "embossed") else ()
    sky = gone(r"\bsky_sphere", "the sky: " + "three suns and " * bool(suns) + "a dark background")
    gone(r"\bbackground", "")
    gone(r"(?m)^(?:box|union|sphere)", "panels and bulbs that shine", lambda block: not re.search(r"\bPanel\b|\bemission\b", block))
    if name == "cloth":
        gone(r"(?m)^box", "")
    text = re.sub(r"\btangent ([xyz])\b", lambda found: "tangent " + LEAN[found.group(1)], text)
    text, soft = re.subn(r"\s*area_light[^}]*?adaptive 1(?: jitter)?", "", text)
    if soft:
        left.append("lamps with a size as sharp ones")
    text, number = re.subn(r"light_source {([^{}]*)}", lambda found: lamp(found.group(1)), text)
    if not number:
        text = text.replace("#version 3.7;\n", "#version 3.7;\n" + lamp(LAMP) + "\n")
        left.append("a sun in place of what shines")
    elif "parallel" in text:
        left.append("lamps as suns from where they are")
    for (x, y, z), (red, green, blue) in suns if sky else ():
        text += "\n" + lamp(f" <{x}, {y}, {z}>, rgb <{red}, {green}, {blue}> ")
    text = re.sub(r"max_trace_level \d+", "", text)
    text = text.replace("global_settings {", "global_settings { max_trace_level 1 ambient_light rgb 0 ", 1)
    left += ["reflections and ambient light"] + (["strokes along an axis lean by .06 degrees"] if "e-3" in text else [])
    return text + f"\nbackground {{ rgb {BACKGROUND} }}\n", [words for words in left if words]


def lamp(inner):
    """A light that fades is a point and stays one."""
    return f"light_source {{{inner}}}" if "fade_distance" in inner else f"light_source {{{inner} parallel point_at 0 }}"
