# SPDX-License-Identifier: Apache-2.0
"""Tiles of a PNG, each in a picture of the whole's size, to the whole."""

import struct
import zlib

import files

_MAGIC = b"\x89PNG\r\n\x1a\n"
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}


def _chunks(path):
    with open(path, "rb") as file:
        data = file.read()
    if data[:8] != _MAGIC:
        raise files.Refusal(f"{path}: no PNG")
    at, found = 8, []
    while at + 12 <= len(data):
        length, = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        if zlib.crc32(kind + body) != struct.unpack_from(">I", data, at + 8 + length)[0]:
            raise files.Refusal(f"{path}: chunk {kind.decode('latin-1')} must have its checksum")
        found.append((kind, body))
        at += 12 + length
    if not found or found[0][0] != b"IHDR" or found[-1][0] != b"IEND":
        raise files.Refusal(f"{path}: it must begin with IHDR and end with IEND")
    return found


def _unfilter(kind, row, above, step):
    """A row's bytes, in place [PNG, 9.2]."""
    if kind == 1:
        for k in range(step, len(row)):
            row[k] = row[k] + row[k - step] & 255
    elif kind == 2:
        for k, up in enumerate(above):
            row[k] = row[k] + up & 255
    elif kind == 3:
        for k, up in enumerate(above):
            row[k] = row[k] + ((row[k - step] if k >= step else 0) + up >> 1) & 255
    elif kind == 4:
        for k, up in enumerate(above):
            left, corner = (row[k - step], above[k - step]) if k >= step else (0, 0)
            guess = left + up - corner
            a, b, c = abs(guess - left), abs(guess - up), abs(guess - corner)
            row[k] = row[k] + (left if a <= b and a <= c else up if b <= c else corner) & 255


def rows_of(path, last=None):
    """(header, bytes of a pixel, rows down to `last`), without the filter's byte."""
    chunks = _chunks(path)
    width, height, bits, kind, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[0][1])
    if bits < 8 or interlaced or kind not in _CHANNELS:
        raise files.Refusal(f"{path}: a PNG of 8 or 16 bits a channel, not interlaced, was expected")
    step = _CHANNELS[kind] * bits // 8
    data = zlib.decompress(b"".join(body for name, body in chunks if name == b"IDAT"))
    size, rows, above = 1 + step * width, [], bytes(step * width)
    if len(data) != size * height:
        raise files.Refusal(f"{path}: it must have {height} rows")
    for y in range(height if last is None else last):
        row = bytearray(data[y * size + 1:(y + 1) * size])
        _unfilter(data[y * size], row, above, step)
        rows.append(row)
        above = row
    return chunks, step, rows


def paste(tiles, place):
    """tiles: [(path, (x, y, width, height))]. All else of the file is the first tile's."""
    whole, first = None, None
    for path, (x, y, width, height) in tiles:
        chunks, step, rows = rows_of(path, y + height)
        if whole is None:
            columns, lines = struct.unpack_from(">II", chunks[0][1])
            whole, first = [bytearray(step * columns) for _ in range(lines)], chunks
        if chunks[0] != first[0]:
            raise files.Refusal(f"{path}: its size and channels must be those of the other tiles")
        for line in range(y, y + height):
            whole[line][step * x:step * (x + width)] = rows[line][step * x:step * (x + width)]
    with open(place, "wb") as file:
        file.write(_MAGIC)
        pixels = zlib.compress(b"".join(b"\0" + row for row in whole), 6)
        kept = [chunk for chunk in first if chunk[0] not in (b"IDAT", b"IEND")]
        for kind, body in [*kept, (b"IDAT", pixels), (b"IEND", b"")]:
            file.write(struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)))
