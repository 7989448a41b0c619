# SPDX-License-Identifier: Apache-2.0
"""Dumps of both back ends (docs/theory/conventions.md): reading and comparing them."""
import json
from dataclasses import dataclass

import numpy as np
import OpenImageIO as oiio

DIRECTIONS = ("N", "T", "Ns", "V")


@dataclass
class Dump:
    """One hit per pixel, rows from the top, float64. `lights` holds L, E, S of each light."""

    header: dict
    material: np.ndarray  # -1 where nothing was hit
    P: np.ndarray
    N: np.ndarray
    T: np.ndarray  # along the grooves: the frame's x axis, turned by the dump's own angle where it has one
    Ns: np.ndarray
    V: np.ndarray
    uv: np.ndarray
    lights: list

    @property
    def covered(self):
        return self.material >= 0


def _header(path, text):
    """The attribute `libshade`: an object whose `materials` are objects with an id of their own."""
    try:
        header = json.loads(text)
    except (TypeError, ValueError, RecursionError) as error:
        raise ValueError(f"{path}: the attribute `libshade` is no JSON: {error}") from error
    listed = header.get("materials", []) if isinstance(header, dict) else None
    if not isinstance(listed, list) or not all(isinstance(m, dict) and isinstance(m.get("id"), int)
                                               for m in listed):
        raise ValueError(f"{path}: the attribute `libshade` is not as expected: "
                         'an object, its "materials" a list of objects with a whole "id"')
    return header


def read(path):
    """Read a dump; OSError or ValueError with the file's name if it is none."""
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise OSError(f"{path}: {(oiio.geterror() or 'cannot be read').splitlines()[-1]}")
    try:
        spec = source.spec()
        text = spec.getattribute("libshade")
        pixels = source.read_image(format=oiio.FLOAT)
        said = source.geterror()
    finally:
        source.close()
    if text is None:
        raise ValueError(f"{path}: not a dump (no attribute `libshade`)")
    if pixels is None:
        raise ValueError(f"{path}: truncated or corrupt: {said}")
    planes = dict(zip(spec.channelnames, np.moveaxis(np.asarray(pixels, np.float64), -1, 0)))

    def channels(name, parts):
        missing = [f"{name}.{p}" for p in parts if f"{name}.{p}" not in planes]
        if missing:
            raise ValueError(f"{path}: channel {missing[0]} is missing")
        return np.stack([planes[f"{name}.{p}"] for p in parts], axis=-1)

    lights = []
    while f"light{len(lights)}.L.X" in planes:
        name = f"light{len(lights)}"
        lights.append(
            {"L": channels(name + ".L", "XYZ"), "E": channels(name + ".E", "RGB"),
             "S": channels(name + ".S", "RGB")}
        )
    material = channels("material", ["ID"])[..., 0]
    if not np.isin(np.mod(material, 1.0), 0.0).all() or (np.abs(material) > 2**24).any():
        raise ValueError(f"{path}: material.ID holds what is no index; expected whole numbers, -1 for a miss")
    directions = {name: channels(name, "XYZ") for name in DIRECTIONS}
    if "groove.A" in planes:
        # one renderer turns the frame to the grooves, another keeps it and says how far they are off
        angle, along = planes["groove.A"][..., None], directions["T"]
        directions["T"] = np.cos(angle) * along + np.sin(angle) * np.cross(directions["N"], along)
    return Dump(
        header=_header(path, text),
        material=material.astype(int),
        P=channels("P", "XYZ"),
        uv=channels("uv", "UV"),
        lights=lights,
        **directions,
    )


def swap_handedness(dump):
    """A dump from POV-Ray's left-handed world (y up) in Blender's (z up), or the reverse. Where it shows cloth,
    whose yarns' twist has a hand, POV-Ray's dump has x turned round, so that it is right-handed there."""
    cloth = np.isin(dump.material, [m["id"] for m in dump.header.get("materials", []) if "fabric" in m])

    def swap(v):
        turned = v[..., [0, 2, 1]].copy()
        turned[cloth, 0] *= -1
        return turned

    def mirrored(m):
        """Slopes along T and N x T, which is the other way in the other world."""
        x, y, xx, xy, yy = m["slopes"]
        return {**m, "slopes": [x, -y, xx, -xy, yy]}

    return Dump(
        header={**dump.header, "materials": [mirrored(m) if "slopes" in m else m for m in dump.header.get("materials", [])]},
        material=dump.material,
        P=swap(dump.P),
        uv=dump.uv,
        lights=[{**light, "L": swap(light["L"])} for light in dump.lights],
        **{name: swap(getattr(dump, name)) for name in DIRECTIONS},
    )


def angles(a, b):
    """Degrees between vectors; 180 where one of them is no direction."""
    la, lb = np.linalg.norm(a, axis=-1), np.linalg.norm(b, axis=-1)
    good = (la > 0.0) & (lb > 0.0) & np.isfinite(la) & np.isfinite(lb)
    ua = a / np.where(good, la, 1.0)[..., None]
    ub = b / np.where(good, lb, 1.0)[..., None]
    # The half-angle form keeps its digits for small angles, where acos loses them.
    half = np.arctan2(np.linalg.norm(ua - ub, axis=-1), np.linalg.norm(ua + ub, axis=-1))
    return np.where(good, np.degrees(2.0 * half), 180.0)


def size(dump):
    """Diagonal of the box around all that the camera sees."""
    points = dump.P[dump.covered]
    return float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0


def apart(a, b):
    """Largest relative difference of two JSON values; infinite where a word, a key or the kind of
    value differs."""
    if isinstance(a, dict) and isinstance(b, dict):
        return max((apart(a.get(k), b.get(k)) for k in {*a, *b}), default=0.0)
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return max(map(apart, a, b), default=0.0)
    if any(not isinstance(x, (int, float)) or isinstance(x, bool) for x in (a, b)):
        return 0.0 if a == b else np.inf
    return abs(a - b) / max(abs(a), abs(b), 1e-30)


def material_difference(a, b):
    """Of every pixel that both dumps cover: how far apart the parameters of its two materials are.
    Renderers number and name materials in their own way, so neither counts; nor does f0 where nothing reads it, nor
    slopes, which each looks for."""
    def said(m):
        read = m.get("fresnel") != "conductor" or m.get("diffuse") == "ashikhmin_shirley" and any(m.get("kd", ()))
        return {k: v for k, v in m.items() if k not in ("id", "name", "slopes") and (read or k != "f0")}

    return _by_pair(a, b, said, apart)


def slopes_difference(a, b):
    """Likewise of the slopes of bumps, where either says some: of their second moments over the larger one's trace, and of their
    means over its root."""
    def off(one, other):
        found = np.array([slopes if slopes else [0.0] * 5 for slopes in (one, other)])
        square = max(found[:, 2] + found[:, 4])
        return max(np.abs(found[0] - found[1])[2:].max() / square, np.abs(found[0] - found[1])[:2].max() / square**0.5) if square > 0 else 0.0

    return _by_pair(a, b, lambda m: m.get("slopes"), off)


def _by_pair(a, b, said, off):
    known = [{m["id"]: said(m) for m in dump.header.get("materials", [])} for dump in (a, b)]
    both = a.covered & b.covered
    pairs, which = np.unique(np.stack([a.material[both], b.material[both]], 1), axis=0,
                             return_inverse=True)
    return np.array([off(known[0].get(i), known[1].get(j)) for i, j in pairs])[which.ravel()]


def coverage_difference(a, b):
    """Pixels that only one dump covers, as a fraction of those that either does."""
    either = np.count_nonzero(a.covered | b.covered)
    return np.count_nonzero(a.covered != b.covered) / max(either, 1)


def _lit(a, b, light, both):
    """Of the pixels `both`, whether a light reaches them in both dumps."""
    return np.logical_and(*(d.lights[light]["E"][both].max(axis=-1) > 0.0 for d in (a, b)))


def pixels_of(a, b, name):
    """(row, column) of each pixel that deviations() compares under a name, in its order."""
    both = a.covered & b.covered
    pixels = np.argwhere(both)
    light, _, part = name.partition(".")
    return pixels[_lit(a, b, int(light[5:]), both)] if part == "L" else pixels


def deviations(a, b):
    """Where both dumps hit: {name: error per pixel}. Parameters of the material, relative; slopes, where there are
    some; P relative to the scene's size; directions in degrees; of each light E, the worst of its channels
    relative to the larger, and L, where both dumps are lit, in degrees (in shadow it may be
    anything)."""
    if a.material.shape != b.material.shape or len(a.lights) != len(b.lights):
        raise ValueError("dumps of different size or number of lights")
    both = a.covered & b.covered
    if not both.any():
        raise ValueError("the dumps have no covered pixel in common")
    result = {"material": material_difference(a, b),
              "P": np.linalg.norm(a.P[both] - b.P[both], axis=-1) / max(size(a), 1e-30),
              "uv": np.abs(a.uv[both] - b.uv[both]).max(axis=-1)}
    if any("slopes" in m for dump in (a, b) for m in dump.header.get("materials", [])):
        result["slopes"] = slopes_difference(a, b)
    for name in DIRECTIONS:
        result[name] = angles(getattr(a, name)[both], getattr(b, name)[both])
    for k, (la, lb) in enumerate(zip(a.lights, b.lights)):
        ea, eb = la["E"][both], lb["E"][both]
        lit = _lit(a, b, k, both)
        off = np.abs(ea - eb) / np.maximum(np.maximum(ea, eb), 1e-30)
        result[f"light{k}.E"] = off.max(axis=-1)
        if lit.any():
            result[f"light{k}.L"] = angles(la["L"][both][lit], lb["L"][both][lit])
    return result
