# SPDX-License-Identifier: Apache-2.0
"""Sheets of small pictures for the report: made once as files, then one SVG with all of them.

A tile is a row of a study: {"kind": "tile", "figure": id, "label": text, "file": path from build/} and, if
there is something to say below it, "value" (a share) with "what" (a format such as "error {}"). A label
may hold | where its next lines begin.
"""
import base64
import html
import os

import numpy as np
from PIL import Image

import programs
import whole

SIDE, GAP, ACROSS = 112, 12, 3  # of a tile, in the page's pixels; tiles in a row, which fit a phone
WORDS, LINE = 11, 13  # the size of words, and from line to line


def save(folder, name, pixels):
    """Write 8-bit grey, RGB or RGBA pixels; a path from build/. JPEG, or PNG where there is alpha."""
    path = folder / f"{name}.{'png' if pixels.shape[-1:] == (4,) else 'jpg'}"
    with whole.place(path) as part:
        if path.suffix == ".png":
            Image.fromarray(pixels, "RGBA").quantize(64).save(part, "PNG", optimize=True)
        else:
            Image.fromarray(pixels).save(part, "JPEG", quality=82)
    return os.path.relpath(path, programs.BUILD)


def tiles(folder, figure, made):
    """Rows of tiles from (label, pixels) or (label, pixels, what, value)."""
    rows = []
    for place, (label, pixels, *note) in enumerate(made):
        row = {"kind": "tile", "figure": figure, "place": place, "label": label,
               "file": save(folder, f"{figure}-{place}", pixels)}
        if note:
            row.update(what=note[0], value=float(note[1]))
        rows.append(row)
    return rows


def address(file):
    """A picture of build/ as an address that holds it."""
    path = programs.BUILD / file
    kind = "png" if path.suffix == ".png" else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"


def percent(value):
    if value < 1e-4:
        return "less than 0.01 %"
    return f"{100 * value:.0f} %" if value >= 0.0995 else f"{100 * value:.2g} %"


def panels(rows, across=ACROSS):
    """A row of tiles a panel, so that wide pages have two rows beside each other."""
    return "".join(svg(rows[k:k + across], across) for k in range(0, len(rows), across))


def svg(rows, across=ACROSS):
    """The tiles in rows of `across`, each with its label below and its number."""
    lines = 3 if any("value" in row for row in rows) else 2
    sizes = [fitted(row["file"]) for row in rows]
    tall = max(size[1] for size in sizes)
    step, high = SIDE + GAP, tall + LINE * lines + 8
    down = -(-len(rows) // across)
    wide = max(step * across - GAP, 360)
    parts = []
    for place, (row, size) in enumerate(zip(rows, sizes)):
        x, y = place % across * step, place // across * high
        box = f'x="{x}" y="{y + tall - size[1]:g}" width="{size[0]:g}" height="{size[1]:g}"'
        parts.append(f'<image {box} preserveAspectRatio="none" href="{address(row["file"])}"/>'
                     f'<rect {box} style="fill: none; stroke: var(--faint)"/>')  # dark ones on a dark page
        words = wrapped(row["label"])
        if "value" in row:
            words = [*words[:2], row["what"].format(percent(row["value"]))]
        parts += [f'<text x="{x}" y="{y + tall + LINE + LINE * k}" font-size="{WORDS}" '
                  f'style="fill: var(--{"soft" if k and k == len(words) - 1 else "ink"})">{html.escape(word)}</text>'
                  for k, word in enumerate(words) if word]
    return (f'<svg viewBox="0 0 {wide} {down * high}" style="--wide:{wide}" aria-hidden="true">'
            + "".join(parts) + "</svg>")


def fitted(file):
    """(width, height) of a picture of build/, its longer side that of a tile."""
    with Image.open(programs.BUILD / file) as picture:
        part = SIDE / max(picture.size)
        return tuple(part * side for side in picture.size)


def wrapped(text, width=20):
    """Two lines at most, or those between the |."""
    if "|" in text:
        return text.split("|")
    words, lines = text.split(), [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return [lines[0], " ".join(lines[1:])] if len(lines) > 1 else lines


def grey(values, white, gamma=None):
    """Numbers as 8-bit grey: `white` is 255, by sRGB or the power 1/gamma."""
    part = np.clip(np.nan_to_num(values) / white, 0.0, 1.0)
    if gamma is None:
        part = np.where(part <= 0.0031308, 12.92 * part, 1.055 * part ** (1 / 2.4) - 0.055)
    else:
        part = part ** (1 / gamma)
    return np.round(255 * part).astype(np.uint8)
