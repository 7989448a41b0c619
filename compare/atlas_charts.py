# SPDX-License-Identifier: Apache-2.0
"""The maps of the stability atlas: small multiples of one colour scale, what fails outlined and named.

SVG by hand, since there are some hundred of them: a picture of a pixel a point, paths round the regions, text.
"""
import base64
import html
import math
import struct
import textwrap
import zlib

import numpy as np

import atlas_regions
import style
from atlas_forms import FORMS
from atlas_regions import FAILS

DARK, LIGHT, GREY = "#101114", "#ffffff", "#9aa0a6"  # on the map itself: the same on dark and light screens
HEADS = {"tilt": "tilt of n, °", "theta": "half vector from z, °", "azimuth": "azimuth of n, °", "size": "exponent",
         "eye": "eye from z, °", "light": "light from z, °"}
SIZE, WIDE, HIGH, LEFT, TOP, GAP = 11, 142, 118, 42, 20, 26  # points
LETTERS, LINE = 23, 13  # of a map's title: in a line, and from line to line


# ---- colours --------------------------------------------------------------------------------------------

def ramp(*stops):
    """Colours of numbers in [0, 1], evenly through the stops."""
    table = np.array([[int(stop[k:k + 2], 16) for k in (1, 3, 5)] for stop in stops], float)

    def colours(t):
        place = np.clip(t, 0, 1) * (len(stops) - 1)
        low = np.minimum(place.astype(int), len(stops) - 2)
        return table[low] + (place - low)[..., None] * (table[low + 1] - table[low])
    return colours


ERROR = ramp("#f3f6f9", "#b9d9ee", "#56b4e9", "#0072b2", "#12304f")
BOTH = ramp("#08446b", "#4f9fcf", "#f4f4f4", "#ee9a5b", "#8f3b00")


class Scale:
    """Numbers from low to high onto colours; logarithmic where log; `says` what they are."""

    def __init__(self, low, high, colours, says, log=False):
        self.low, self.high, self.colours, self.says, self.log = low, high, colours, says, log

    def place(self, value):
        if self.log:
            return np.log(np.maximum(value, self.low) / self.low) / np.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def rgb(self, values):
        missing = np.isnan(values)
        made = self.colours(self.place(np.where(missing, self.low, values)))
        made[missing] = [int(GREY[k:k + 2], 16) for k in (1, 3, 5)]
        return np.rint(made).astype(np.uint8)

    def ticks(self):
        if self.log:
            return [10.0**k for k in range(round(math.log10(self.low)), round(math.log10(self.high)) + 1)]
        return np.linspace(self.low, self.high, 5).tolist()


LESS = "∫D′ less that of the displaced surface"
SCALES = {  # of each map: the number that is drawn, its scale
    "half": (lambda r: np.nan if r["nan"] else r["error"],
             Scale(1e-3, 10, ERROR, "|D′ − D′ of the displaced surface| over the peak (grey: NaN)", True)),
    "energy": (lambda r: r["energy"] - r["true_energy"], Scale(-1, 1, BOTH, LESS)),
    "displaced": (lambda r: r["displaced"], Scale(0, 90, ERROR, "angle from n to the peak of D′, °")),
    "lobe": (lambda r: r["energy"] - r["true_energy"], Scale(-1, 1, BOTH, LESS)),
    "float": (lambda r: r["error"], Scale(1e-7, 1, ERROR, "relative error of D′, worst of 144 half vectors", True)),
    "albedo": (lambda r: r["albedo"], Scale(0, 2, BOTH, "albedo of a white metal, worst azimuth")),
    "spread": (lambda r: r["spread"], Scale(0, 5, ERROR, "deviation of f cos/pdf over its mean, worst azimuth")),
    "wide": (lambda r: r["jump"], Scale(1e-6, 1, ERROR, "jump of D′ in the plane of z and n, of the peak", True)),
    "peak": (lambda r: r["displaced"], Scale(0, 90, ERROR, "angle from n to the peak of D′, °")),
    "returned": (lambda r: r["albedo"], Scale(0, 2, BOTH, "share of a beam that is given back, worst azimuth")),
    "asymmetry": (lambda r: r["asymmetry"],
                  Scale(1e-6, 1, ERROR, "|f(wi, wo) − f(wo, wi)| / f, worst of both azimuths", True)),
    "step": (lambda r: r["jump"], Scale(1e-6, 1, ERROR, "jump of f cos over its largest, worst azimuth", True)),
    "pairs": (lambda r: r["asymmetry"], Scale(1e-6, 1, ERROR, "|f(wi, wo) − f(wo, wi)| / f, worst azimuth", True)),
    "fibre": (lambda r: np.nan if r["nan"] else r["error"],
              Scale(1e-3, 1, ERROR, "|Φ − mean over the fibre| (grey: NaN)", True)),
}


def picture(rgb):
    """(rows, columns, 3) bytes as the address of a PNG."""
    lines = b"".join(b"\0" + row.tobytes() for row in rgb)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", rgb.shape[1], rgb.shape[0], 8, 2, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b"")
    return "data:image/png;base64," + base64.b64encode(data).decode()


# ---- pieces of SVG -----------------------------------------------------------------------------------------

def text(x, y, words, anchor="middle", size=SIZE, fill="var(--ink)", more=""):
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}px" style="fill: {fill};{more}">'
            f"{html.escape(words)}</text>")


def image(x, y, wide, high, rgb):
    return (f'<image x="{x:.1f}" y="{y:.1f}" width="{wide}" height="{high}" preserveAspectRatio="none" '
            f'style="image-rendering: pixelated" href="{picture(rgb)}"/>')


def whole(wide, high, parts, above=0):
    return (f'<svg viewBox="0 {-above} {wide} {high + above}" style="--wide:{wide}" aria-hidden="true" '
            f'xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>')


def outline(mask, xs, ys):
    """A path round the cells of a mask, runs of edges joined."""
    padded, said = np.pad(mask, 1), []
    for across in (True, False):
        differ = padded[1:, 1:-1] != padded[:-1, 1:-1] if across else (padded[1:-1, 1:] != padded[1:-1, :-1]).T
        for i, line in enumerate(differ):
            ends = np.flatnonzero(np.diff(np.concatenate([[0], line.astype(int), [0]])))
            for a, b in zip(ends[::2], ends[1::2]):
                said.append(f"M{xs[a]:.1f} {ys[i]:.1f}H{xs[b]:.1f}" if across else
                            f"M{xs[i]:.1f} {ys[a]:.1f}V{ys[b]:.1f}")
    path = "".join(said)
    return "".join(f'<path d="{path}" class="on-map" fill="none" stroke="{colour}" stroke-width="{width}" stroke-linecap="square"/>'
                   for colour, width in ((LIGHT, 2.6), (DARK, 1.1)))


def place_of(mask, taken, xs, ys, wide, high):
    """The middle of a name of that size: inside the mask, far from its rim and from what is taken."""
    depth, rest = np.zeros(mask.shape), mask.copy()
    while rest.any():
        depth += rest
        p = np.pad(rest, 1)
        rest = p[1:-1, 1:-1] & p[:-2, 1:-1] & p[2:, 1:-1] & p[1:-1, :-2] & p[1:-1, 2:]
    best, low, high_y = None, min(ys), max(ys)
    for i, j in zip(*np.nonzero(mask)):
        middle = (xs[j] + xs[j + 1]) / 2, (ys[i] + ys[i + 1]) / 2
        x = min(max(middle[0], xs[0] + wide / 2 + 2), xs[-1] - wide / 2 - 2)
        y = min(max(middle[1], low + high), high_y - high / 2)
        clash = sum(max(0, 1 - abs(x - a) / ((wide + w) / 2 + 3)) * max(0, 1 - abs(y - b) / (high + 2))
                    for a, b, w in taken)
        score = depth[i, j] - 100 * clash - abs(x - middle[0]) / 4 - abs(y - middle[1]) / 4
        if best is None or score > best[0]:
            best = score, x, y
    return best[1:]


def edges(values):
    """Bounds of cells about values."""
    values = np.asarray(values, float)
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


# ---- a map ---------------------------------------------------------------------------------------------------

def panel(x0, rows, which, failures, columns, title, heads, first):
    """One map with its left edge at x0: rows of one form on a grid of two columns. title: its lines."""
    measure, scale = SCALES[which]
    across, upwards = (sorted({row[c] for row in rows}) for c in columns)
    decades = columns[0] == "size"
    grid = np.full((len(upwards), len(across)), np.nan)
    masks = {failure: np.zeros(grid.shape, bool) for failure in failures}
    rank = {v: k for k, v in enumerate(across)}, {v: k for k, v in enumerate(upwards)}
    for row in rows:
        at = rank[1][row[columns[1]]], rank[0][row[columns[0]]]
        grid[at] = measure(row)
        for failure in failures:
            masks[failure][at] |= FAILS[failure][1](row) > FAILS[failure][2]
    bounds = edges(range(len(across)) if decades else across), edges(upwards)
    px = [x0 + (v - bounds[0][0]) / np.ptp(bounds[0]) * WIDE for v in bounds[0]]
    py = [TOP + HIGH - (v - bounds[1][0]) / np.ptp(bounds[1]) * HIGH for v in bounds[1]]
    column = np.searchsorted(px, x0 + np.arange(WIDE) + 0.5) - 1
    row = len(upwards) - np.searchsorted(sorted(py), TOP + np.arange(HIGH) + 0.5)
    parts = [image(x0, TOP, WIDE, HIGH, scale.rgb(grid)[row][:, column])]
    parts += [text(x0, TOP - 7 - LINE * k, line, "start", more=" font-weight: 600") for k, line in enumerate(reversed(title))]
    if decades:
        marks = [(k, style.power(across[k])) for k in range(0, len(across), 2)]
    else:
        span = across[-1] - across[0]
        step = 90 if span > 180 else 45 if span > 90 else 30
        marks = [(v, f"{v}".replace("-", "−")) for v in range(-360, 361, step)
                 if across[0] <= v <= bounds[0][-1]]
    for value, words in marks:
        parts.append(text(x0 + (value - bounds[0][0]) / np.ptp(bounds[0]) * WIDE, TOP + HIGH + 13, words,
                          fill="var(--soft)"))
    parts.append(text(x0 + WIDE / 2, TOP + HIGH + 27, heads[columns[0]]))
    if first:
        for value in (0, 30, 60, 90):
            if upwards[0] <= value <= bounds[1][-1]:
                y = TOP + HIGH - (value - bounds[1][0]) / np.ptp(bounds[1]) * HIGH
                parts.append(text(x0 - 5, min(y + 4, TOP + HIGH), f"{value}", "end", fill="var(--soft)"))
        middle = TOP + HIGH / 2
        parts.append(f'<g transform="rotate(-90 10 {middle})">{text(10, middle + 3, heads[columns[1]])}</g>')
    return "".join([*parts, *names(masks, atlas_regions.key_of(rows[0]), px, py)])


def names(masks, form, px, py):
    """Outlines and names of what fails, the smallest last, so that it lies on top."""
    said, lines, words, taken = {}, [], [], []
    for failure, mask in masks.items():
        if mask.any():
            found = atlas_regions.reason(form, failure)
            name = found[0] if found else "unexplained"
            said[name] = said.get(name, np.zeros(mask.shape, bool)) | mask
    for name, mask in sorted(said.items(), key=lambda item: item[1].sum()):
        wide = 0.53 * SIZE * len(name)
        x, y = place_of(mask, taken, px, py, wide, 13)
        taken.append((x, y, wide))
        lines.append(outline(mask, px, py))
        words.append(text(x, y + 4, name, fill=DARK,
                          more=f" paint-order: stroke; stroke: {LIGHT}; stroke-width: 3px; stroke-linejoin: round"))
    return lines[::-1] + words


def key(scale):
    """The bar that says what the colours are, as a panel."""
    wide, left = 320, 20
    values = np.linspace(0, 1, wide)
    values = (scale.low * (scale.high / scale.low) ** values if scale.log
              else scale.low + values * (scale.high - scale.low))
    parts = [image(left, 18, wide, 14, scale.rgb(values[None])), text(left, 12, scale.says, "start")]
    parts += [text(left + wide * float(scale.place(v)), 44, style.power(v).replace("-", "−"), fill="var(--soft)")
              for v in scale.ticks()]
    return whole(360, 52, parts)


def maps(groups, which, failures, columns, title, heads=None):
    """Panels of two maps each. groups: lists of rows, a map each; title(rows): of a map."""
    made = [key(SCALES[which][1])]
    for first in range(0, len(groups), 2):
        parts, beside = [], groups[first:first + 2]
        titles = [textwrap.wrap(title(rows), LETTERS) for rows in beside]
        for place, rows in enumerate(beside):
            form = FORMS.get(rows[0]["form"])
            alpha = {"size": "α"} if form and form.mdf != "ashikhmin_shirley" else {}
            parts.append(panel(LEFT + place * (WIDE + GAP), rows, which, failures, columns, titles[place],
                               {**HEADS, **alpha, **(heads or {})}, place == 0))
        made.append(whole(360, TOP + HIGH + 34, parts, LINE * (max(map(len, titles)) - 1)))
    return "".join(made)


def grouped(rows, *keys):
    """Lists of rows with the same values in the columns `keys`, in order."""
    found = {}
    for row in rows:
        found.setdefault(tuple(row[k] for k in keys), []).append(row)
    return list(found.values())
