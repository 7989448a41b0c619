# SPDX-License-Identifier: Apache-2.0
"""How the charts of the report look: one colour and marker for each method through the whole page.

    figure, axes = style.figure(360, 280)       # points; a panel that fits a phone
    look = style.of("rotate")                   # look.colour, look.marker, look.label
    axes.plot(x, y, color=look.colour, marker=look.marker)
    style.log_ticks(axes.xaxis); style.labels(axes, [(x, y, "rotate"), ...])
    text = style.svg(figure)                    # several may be joined: panels beside each other

Colours are those of Okabe and Ito, which the colour-blind tell apart, and no two looks differ by
colour alone. In the SVG each becomes a CSS variable, so that the page can change them for
dark screens, and --blue-word and so on where it is that of words, which want more contrast; INK, SOFT, FAINT and
PAPER are text, secondary text, lines of a grid and the ground.
"""
import functools
import hashlib
import io
import math
import os
import re
import tempfile
from dataclasses import dataclass

import numpy as np

from report import number, power, rounded  # noqa: F401  (of drawings, too)

os.environ.setdefault("MPLCONFIGDIR",
                      os.path.join(tempfile.gettempdir(), f"libshade-plots-{os.getuid()}"))
import matplotlib  # noqa: E402  (after its folder is set)

matplotlib.use("svg")
from matplotlib import pyplot, ticker  # noqa: E402
from matplotlib.textpath import TextPath  # noqa: E402

INK, SOFT, FAINT, PAPER = "#1a1c1f", "#5b6168", "#dfe2e6", "#fdfdfe"
BLUE, SKY, GREEN, ORANGE = "#0072b2", "#56b4e9", "#009e73", "#e69f00"
VERMILION, PURPLE, OLIVE, GREY = "#d55e00", "#cc79a7", "#a89a00", "#8a9097"
VARIABLES = {INK: "ink", SOFT: "soft", FAINT: "faint", PAPER: "paper", BLUE: "blue", SKY: "sky",
             GREEN: "green", ORANGE: "orange", VERMILION: "vermilion", PURPLE: "purple",
             OLIVE: "olive", GREY: "grey"}
HUES = tuple(name for name in VARIABLES.values() if name not in ("ink", "soft", "faint", "paper"))


@dataclass(frozen=True)
class Look:
    """What stands for a method. `hollow` markers are drawn in the colour, filled with PAPER."""

    colour: str
    marker: str
    label: str
    hollow: bool = False

    @property
    def line(self):
        """Keywords for axes.plot."""
        return {"color": self.colour, **self.points}

    @property
    def bars(self):
        """Keywords for axes.errorbar, without a line between the points."""
        return {"color": self.colour, "linestyle": "none", "ecolor": self.colour, "elinewidth": 1.2, "capsize": 2.5,
                **self.points}

    @property
    def points(self):
        """Keywords of markers, for axes.plot and axes.errorbar."""
        return {"marker": self.marker, "markersize": 6, "markeredgewidth": 1.4,
                "markeredgecolor": self.colour,
                "markerfacecolor": PAPER if self.hollow else self.colour}


LOOKS = {word: Look(colour, marker, word.replace("_", " ") if not label else label, hollow)
         for word, colour, marker, label, hollow in (
    # detail methods: a family has a colour, its members have markers
    ("displaced", INK, "*", "displaced (truth)", False),
    ("none", GREY, "X", "", False),
    ("perturb", ORANGE, "s", "", False),
    ("gram_schmidt", GREEN, "^", "Gram-Schmidt", False),
    ("shortest_arc", PURPLE, "v", "shortest arc", False),
    ("rotate", BLUE, "o", "", False),
    ("rotate_approximate", BLUE, "o", "rotate, approximate", True),
    ("rotate_literal", BLUE, "P", "rotate, as printed", True),
    ("rotate_plain", BLUE, "P", "rotate, plain C", False),
    ("auto", SKY, "h", "", False),
    ("deform_linear", VERMILION, "D", "deform, linear", False),
    ("deform_linear_conserving", VERMILION, "D", "deform, linear, conserving", True),
    ("deform_smooth", OLIVE, "p", "deform, smooth", False),
    ("deform_smooth_conserving", OLIVE, "p", "deform, smooth, conserving", True),
    # distributions
    ("ashikhmin_shirley", BLUE, "o", "Ashikhmin-Shirley", False),
    ("ward", VERMILION, "D", "Ward", False),
    ("ward_half", VERMILION, "D", "Ward, cheap", True),
    ("beckmann", GREEN, "^", "Beckmann", False),
    ("ggx", ORANGE, "s", "GGX", False),
    # precisions
    ("float", BLUE, "o", "", False),
    ("double", GREEN, "^", "", False),
    ("reference", INK, "*", "", False),
    # horizons
    ("hard", GREY, "X", "", False),
    ("valid_reflection", ORANGE, "s", "", False),
    ("estevez", GREEN, "^", "Estevez", False),
    ("chiang", VERMILION, "D", "Chiang", False),
    ("schuessler", PURPLE, "v", "Schüßler", False),
    ("valid_estevez", BLUE, "o", "valid, Estevez", False),
    # diffuse models
    ("lambert", GREY, "X", "Lambert", False),
    ("max_normal", ORANGE, "s", "maximum normal", False),
    ("max_normal_scaled", ORANGE, "s", "maximum normal · 2/π", True),
    ("fibre", GREEN, "^", "", False),
    ("fibre_view", BLUE, "o", "fibre, view", False),
    ("poulin_fournier", INK, "*", "Poulin-Fournier", False),
    # cloth
    ("near", INK, "*", "", False),
    ("far", BLUE, "o", "far", False),
    ("far_nodes", BLUE, "o", "far, all lobes", True),
    ("single", ORANGE, "s", "one lobe", False),
    *((f"lobes_{n}", c, m, "one lobe" if n == 1 else f"{n} lobes", False) for n, c, m in (
        (1, ORANGE, "s"), (2, GREY, "X"), (3, PURPLE, "v"), (4, GREEN, "^"), (6, BLUE, "o"), (8, VERMILION, "D"))),
    # renderers
    ("libshade", BLUE, "o", "", False),
    ("cycles", VERMILION, "D", "Cycles", False),
    ("cycles_5", VERMILION, "D", "Cycles 5", True),
    ("povray", GREEN, "^", "POV-Ray", False),
    ("mitsuba", PURPLE, "v", "Mitsuba 3", False),
)}
_SPARE = [(c, m) for m in "<>Hd8" for c in (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, OLIVE)]


def of(word):
    """The look of a method by its word, - and _ alike; words that are not listed get one that stays."""
    word = word.replace("-", "_")
    if word not in LOOKS:
        colour, marker = _SPARE[int(hashlib.sha256(word.encode()).hexdigest(), 16) % len(_SPARE)]
        LOOKS[word] = Look(colour, marker, word.replace("_", " "), True)
    return LOOKS[word]


RC = {"svg.fonttype": "none", "svg.hashsalt": "libshade", "font.size": 11, "axes.titlesize": 11.5,
      "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.titlepad": 8,
      "axes.edgecolor": SOFT, "axes.labelcolor": INK, "text.color": INK, "axes.titlecolor": INK,
      "xtick.color": SOFT, "ytick.color": SOFT, "xtick.labelcolor": INK, "ytick.labelcolor": INK,
      "xtick.labelsize": 11, "ytick.labelsize": 11, "axes.labelsize": 11,
      "axes.grid": True, "grid.color": FAINT, "grid.linewidth": 0.7, "axes.axisbelow": True,
      "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8,
      "xtick.major.size": 0, "ytick.major.size": 0, "xtick.minor.size": 0, "ytick.minor.size": 0,
      "figure.facecolor": "none", "axes.facecolor": "none", "savefig.facecolor": "none",
      "legend.frameon": False, "lines.linewidth": 1.5, "figure.constrained_layout.use": True}


matplotlib.rcParams.update(RC)


def figure(width=360, height=280, rows=1, columns=1, **keywords):
    """(figure, axes) of that size in points, which are the page's pixels on a phone."""
    return pyplot.subplots(rows, columns, figsize=(width / 72, height / 72), **keywords)


def log_ticks(axis, most=7):
    """A logarithmic axis with plain numbers: decades, and 2 and 5 between them where there are few."""
    getattr(axis.axes, f"set_{axis.axis_name}scale")("log")
    low, high = sorted(axis.get_view_interval())
    decades = math.log10(high / low)
    subs = (1, 2, 5) if decades < 2.2 else (1,)
    axis.set_major_locator(ticker.LogLocator(subs=subs, numticks=most))
    axis.set_major_formatter(lambda value, _place: power(value))
    axis.set_minor_locator(ticker.NullLocator())


# Where a word may stand beside its point, in points: the farther, the later
_AROUND = sorted(((side * (6 + abs(y) / 12 if y else 7), y, {1: "left", -1: "right", 0: "center"}[side])
                  for y in (0, 9, -9, 16, -16, 25, -25, 38, -38, 52, -52, 66, -66, 80, -80, 96, -96) for side in (1, -1, 0) if y or side),
                 key=lambda at: (abs(at[1]), at[2] != "left"))


def _within(points, boxes, more=0.0):
    return ((boxes[..., :2] - more < points) & (points < boxes[..., 2:] + more)).all(-1)


def labels(axes, points, size=11, lines=()):
    """Write each word beside its point, (x, y, word), in its colour, where least lies below it.

    `lines`: lists of points (x, y), lines that words should not lie on.
    """
    canvas = axes.figure
    canvas.draw_without_rendering()  # the axes' place is known from here on
    if not points:
        return
    dots = axes.transData.transform([(x, y) for x, y, _word in points])
    strokes = [np.empty((0, 2))]
    for line in lines:
        corners = axes.transData.transform(line)
        for a, b in zip(corners[:-1], corners[1:]):
            strokes.append(a + (b - a) * np.linspace(0, 1, max(int(np.abs(b - a).max() / 3), 1) + 1)[:, None])
    strokes, frame, scale = np.concatenate(strokes), axes.get_window_extent(), canvas.dpi / 72
    offsets = np.array([at[:2] for at in _AROUND]) * scale
    shares = np.array([{"left": 0.0, "right": 1.0, "center": 0.5}[side] for *_xy, side in _AROUND])
    far = np.abs(offsets[:, 1]) > 12 * scale  # these have a line to their point
    boxes, alone, leads = [], [], []
    for (_x, _y, word), dot in zip(points, dots):
        wide, high = _width(of(word).label, size) * scale, 1.1 * size * scale
        low = dot + offsets - np.stack([shares * wide, np.full(len(shares), high / 2)], 1)
        box = np.concatenate([low, low + (wide, high)], 1)
        lead = np.stack([np.broadcast_to(dot, low.shape), dot + offsets], 1)
        out = np.maximum(frame.x0 - box[:, 0], 0) + np.maximum(box[:, 2] - frame.x1 - 4 * scale, 0)
        out += np.maximum(frame.y0 - box[:, 1], 0) + np.maximum(box[:, 3] - frame.y1, 0)
        others = dots[(dots != dot).any(1)]
        covered = _within(dots, box[:, None], 4 * scale).sum(1)
        struck = _within(strokes, box[:, None]).sum(1)
        along = lead[:, None, 0] + (lead[:, None, 1] - lead[:, None, 0]) * np.linspace(0, 1, 9)[None, :, None]
        over = (np.abs(along[:, :, None] - others).max(-1) < 5 * scale).any(1).sum(1)
        boxes.append(box)
        leads.append(along)
        alone.append(200 * out + 60 * covered + 4 * struck + np.arange(len(box)) + far * (10 + 40 * over))

    def beside(k, chosen):
        """What each place of a word costs, the others being where they are."""
        cost = alone[k].copy()
        for other, place in enumerate(chosen):
            if other == k or place is None:
                continue
            theirs = boxes[other][place]
            shared = np.clip(np.minimum(boxes[k][:, 2:], theirs[2:] + 2) - np.maximum(boxes[k][:, :2], theirs[:2] - 2), 0, None)
            cost += 20 * shared.prod(1) + far * 6 * _within(leads[k], theirs).sum(1)
            if far[place]:
                cost += 6 * _within(leads[other][place], boxes[k][:, None]).sum(1)
        return cost

    def arranged(order):
        chosen = [None] * len(points)
        for _ in range(4):
            for k in order:
                chosen[k] = int(beside(k, chosen).argmin())
        return sum(beside(k, chosen)[place] for k, place in enumerate(chosen)), chosen

    count = len(points)
    orders = [[*range(start, count), *range(start)] for start in range(count)]
    _cost, chosen = min((arranged(order) for order in [*orders, *(order[::-1] for order in orders)]), key=lambda found: found[0])
    for (x, y, word), place in zip(points, chosen):
        dx, dy, side = _AROUND[place]
        line = {"arrowprops": {"arrowstyle": "-", "color": SOFT, "linewidth": 0.6, "shrinkA": 0,
                               "shrinkB": 4}} if far[place] else {}
        axes.annotate(of(word).label, (x, y), xytext=(dx, dy), textcoords="offset points", ha=side,
                      va="center", fontsize=size, color=of(word).colour, **line)


@functools.cache
def _width(text, size):
    """In points, of a wide font: what a browser has may be narrower."""
    return TextPath((0, 0), text, size=size).get_extents().width + 0.1 * size


def ends(axes, points, size=11):
    """Write each word right of its line's last point, (x, y, word), one above the other."""
    axes.figure.draw_without_rendering()
    step = 1.25 * size * axes.figure.dpi / 72
    heights = axes.transData.transform([(x, y) for x, y, _word in points])[:, 1]
    order = sorted(range(len(points)), key=lambda k: heights[k])
    placed = {}
    for k in order:
        placed[k] = max([heights[k]] + [placed[j] + step for j in placed])
    for k in reversed(order):  # back down where there is room, so that groups stay about their lines
        below = [placed[j] for j in order if placed[j] < placed[k]]
        lifted = placed[k] - heights[k]
        if lifted > 0:
            placed[k] = max([placed[k] - lifted / 2] + [b + step for b in below])
    for k, (x, y, word) in enumerate(points):
        look = of(word)
        axes.annotate(look.label, (x, y), xytext=(9, (placed[k] - heights[k]) * 72 / axes.figure.dpi),
                      textcoords="offset points", va="center", fontsize=size, color=look.colour)


def svg(drawing):
    """The figure as text to stand in HTML: colours as variables, text as text, ids of its own."""
    with io.StringIO() as part:
        drawing.savefig(part, format="svg", metadata={"Date": None, "Creator": None, "Format": None,
                                                      "Type": None})
        text = part.getvalue()
    pyplot.close(drawing)
    text = text[text.index("<svg"):]
    text = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"<style.*?</style>", "", text, flags=re.S)
    text = re.sub(r"font: (?:(\d+|bold) )?([\d.]+px)[^;\"]*",
                  lambda m: f"font-weight: {m[1] or 400}; font-size: {m[2]}", text)
    text = re.sub(r"font-family: [^;\"]*;?", "", text)
    for colour, name in VARIABLES.items():
        text = text.replace(colour, f"var(--{name})")
    # words in a method's colour are darker than its lines where the ground is light
    text = re.sub(r"<text[^>]*>", lambda m: re.sub(rf"var\(--({'|'.join(HUES)})\)", r"var(--\1-word)", m[0]), text)
    own = "f" + hashlib.sha256(text.encode()).hexdigest()[:8] + "-"
    used = set(re.findall(r"(?:url\(#|href=\"#)([^)\"]+)", text))
    text = re.sub(r' id="([^"]+)"', lambda m: f' id="{own}{m[1]}"' if m[1] in used else "", text)
    text = re.sub(r'(url\(#|href="#)', rf"\g<1>{own}", text)
    wide = float(re.search(r'viewBox="0 0 ([\d.]+)', text)[1])
    text = re.sub(r'<svg[^>]*?(viewBox="[^"]*")[^>]*>',
                  rf'<svg \1 style="--wide:{wide:g}" aria-hidden="true">', text, count=1)
    return re.sub(r"\s*\n\s*", " ", text).replace("> <", "><").strip()
