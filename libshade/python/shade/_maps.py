# SPDX-License-Identifier: Apache-2.0
"""Normal maps and scratches seen over a footprint, what they make of a lobe, and how steep bumps are (maps.h)."""
import ctypes
import weakref
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _structs as structs
from ._arrays import Call, Floats, Status, gather
from ._library import LIB, PARAMS_SIZE, Fixed, one_of, truth
from ._material import UP, Material, numbers

Seen = NamedTuple("Seen", [("normal", Floats), ("covariance", Floats)])
Split = NamedTuple("Split", [("x", Floats), ("y", Floats), ("angle", Floats), ("n", Floats), ("weight", Floats)])
NORMALS = {"colour": (0,), "signed": (1,), "slope": (2,)}
WRAPS = {"repeat": (0,), "clamp": (1,), "mirror": (2,)}
LOBES = 8


def _places(uv, footprint):
    call = Call().add("uv", uv, "u", "v")
    return call.add("footprint", footprint, "du1", "dv1", "du2", "dv2")


def _one_by_one(call, look_up, status):
    """normal (…, 3) and covariance (…, 3), worked out in double, by a call for each place."""
    asked, call.dtype = call.dtype, np.dtype(np.float64)
    made, slopes = call.columns(), structs.Slopes()
    sides = np.ascontiguousarray(np.stack([made[m] for m in ("du1", "dv1", "du2", "dv2")], -1)) \
        if "du1" in made else None
    out = np.zeros((call.count, 6))
    for k, (u, v) in enumerate(zip(made["u"].tolist(), made["v"].tolist())):
        gather(status, look_up(u, v, None if sides is None else sides[k].ctypes.data, ctypes.byref(slopes)))
        out[k] = *slopes.normal, *slopes.covariance
    out = out.reshape(*call.shape, 6).astype(asked, copy=False)
    return Seen(out[..., :3], out[..., 3:])


class SlopeMap(Fixed):
    """A normal map with its pyramid of slopes.

    :param pixels: (height, width, channels), row 0 the top; colours are 0 to 1, or of a type of whole numbers without sign, of which
        the largest counts as 1
    :param normals: colour, signed or slope
    :param wrap: repeat, clamp or mirror
    :param directx: True where green points down
    :param strength: of the bumps, [0, 100]
    :param status: a Status that gathers what had to be mended

    >>> flat = shade.SlopeMap(np.full((4, 4, 3), (128, 128, 255), np.uint8))
    >>> flat.look_up([.5, .5], [.1, 0, 0, .1]).normal.round(2).tolist()
    [0.0, 0.0, 1.0]
    """

    CHANGED = "shade.SlopeMap(…, {}) makes another"

    def __init__(self, pixels: ArrayLike, *, normals: str = "colour", wrap: str = "repeat", directx: bool = False,
                 strength: float = 1.0, status: Status | None = None) -> None:
        options, bits = structs.SlopeOptions(), ctypes.c_uint()
        LIB.shade_slope_options_init(ctypes.byref(options))
        options.normals, options.wrap = one_of("normals", normals, NORMALS), one_of("wrap", wrap, WRAPS)
        options.directx = truth("directx", directx)
        options.strength, = numbers("strength", strength, 1, 0, 100)
        texels = self._floats(np.asarray(pixels), coloured=options.normals == 0)
        if texels.ndim != 3 or texels.shape[2] < 2 or not all(1 <= side <= 65536 for side in texels.shape[:2]):
            raise ValueError(f"pixels: an array of shape {texels.shape} given; expected (height, width, 2 or more), "
                             "sides of 1 to 65536")
        self._map = LIB.shade_slope_map_create(texels.ctypes.data, texels.shape[1], texels.shape[0],
                                               texels.shape[2], ctypes.byref(options), ctypes.byref(bits))
        if not self._map:
            raise MemoryError("no room for this map")
        weakref.finalize(self, LIB.shade_slope_map_free, self._map)
        gather(status, bits.value)

    @staticmethod
    def _floats(pixels, coloured):
        if pixels.dtype.kind == "u" and coloured:
            pixels = pixels / np.float32(np.iinfo(pixels.dtype).max)
        elif pixels.dtype.kind != "f":
            raise ValueError(f"pixels: an array of {pixels.dtype} given; expected floats, or with normals \"colour\" a "
                             "picture of uint8 or uint16")
        elif coloured and (pixels > 2).any():
            raise ValueError(f"pixels: colours up to {np.nanmax(pixels):g} given; expected 0 to 1 (a picture of uint8 or "
                             "uint16 is scaled)")
        return np.ascontiguousarray(pixels, np.float32)

    def look_up(self, uv: ArrayLike, footprint: ArrayLike | None = None, *, status: Status | None = None) -> Seen:
        """The slopes over a footprint. Each takes some microseconds.

        :param uv: where (…, 2), in pictures
        :param footprint: the sides du1, dv1, du2, dv2 of a parallelogram in uv (…, 4); None: the point
        :param status: a Status that gathers what had to be mended
        :returns: (normal, covariance): the mean normal (…, 3), and xx, xy, yy of the slopes (…, 3)
        """
        return _one_by_one(_places(uv, footprint).prepare(),
                           lambda *rest: LIB.shade_slope_lookup(self._map, *rest), status)


class Scratches(Fixed):
    """A field of scratches on a tile that repeats. Lengths are in tile widths.

    :param layers: at most 8 dictionaries of pits (how many), radius, stretch, depth (a number or the two ends of a range), direction
        and spread (radians), as maps.h has them
    :param seed: another seed makes other scratches of the same kind
    :param aspect: height of the tile over its width, [1e-3, 1e3]
    :param cells: of the table that answers footprints, [0, 4096]; 0: none

    >>> field = shade.Scratches({"pits": 300, "radius": (.01, .02), "depth": .1}, cells=64)
    >>> field.look_up([.5, .5], [1, 0, 0, 1]).covariance.shape
    (3,)
    """

    CHANGED = "shade.Scratches(…, {}) makes another"

    RANGES = {"radius": (1e-6, 0.5), "stretch": (1, 1e5), "depth": (0, 0.99)}
    SINGLE = {"pits": (0, 4000000), "direction": (-1e6, 1e6), "spread": (0, np.pi / 2)}

    def __init__(self, *layers: dict[str, Any], seed: int | None = None, aspect: float | None = None,
                 cells: int | None = None) -> None:
        params = structs.ScratchParams()
        LIB.shade_scratch_params_init(ctypes.byref(params))
        if len(layers) > len(params.layer):
            raise ValueError(f"layers: {len(layers)} given; expected at most {len(params.layer)}")
        params.layers = len(layers) or params.layers
        params.seed = params.seed if seed is None else int(seed)
        for name, value, low, high, kind in (("aspect", aspect, 1e-3, 1e3, float), ("cells", cells, 0, 4096, int)):
            if value is not None:
                setattr(params, name, kind(numbers(name, value, 1, low, high)[0]))
        for layer, given in zip(params.layer, layers):
            self._fill(layer, given)
        self._field = LIB.shade_scratch_create(ctypes.byref(params), None)
        if not self._field:
            raise MemoryError("no room for these scratches")
        weakref.finalize(self, LIB.shade_scratch_free, self._field)

    def _fill(self, layer, given):
        for name, value in given.items():
            if name in self.RANGES:
                ends = np.ravel(value).tolist()
                if len(ends) not in (1, 2):
                    raise ValueError(f"{name}: {value!r} given; expected a number or the two ends of a range")
                low, high = (numbers(name, end, 1, *self.RANGES[name])[0] for end in (ends[0], ends[-1]))
                setattr(layer, name, structs.Range(low, high))
            elif name in self.SINGLE:
                number, = numbers(name, value, 1, *self.SINGLE[name])
                setattr(layer, name, int(number) if name == "pits" else number)
            else:
                raise TypeError(f"{name!r}: no such parameter of a layer; there are "
                                + ", ".join([*self.SINGLE, *self.RANGES]))

    def look_up(self, uv: ArrayLike, footprint: ArrayLike | None = None, *, status: Status | None = None) -> Seen:
        """The slopes over a footprint: mean normal and covariance, as of a SlopeMap."""
        return _one_by_one(
            _places(uv, footprint).prepare(),
            lambda u, v, sides, out: LIB.shade_scratch_eval(self._field, u, v, sides, None, out), status)

    def picture(self, width: int, height: int, *, samples: int = 1) -> tuple[Floats, Floats]:
        """A picture of the field, float32, row 0 the top.

        :param width: texels of a row
        :param height: rows
        :param samples: points along each side of a texel, of which it is the mean
        :returns: heights (height, width) in tile widths, and unit normals (height, width, 3)

        >>> heights, normals = shade.Scratches(cells=0).picture(32, 16)
        >>> heights.shape, normals.shape
        ((16, 32), (16, 32, 3))
        """
        if min(width, height, samples) < 1:
            raise ValueError(f"picture: {width} x {height}, {samples} samples given; expected 1 or more of each")
        depth, normal = np.zeros((height, width), np.float32), np.zeros((height, width, 3), np.float32)
        LIB.shade_scratch_rows(self._field, width, height, 0, height, samples, depth.ctypes.data,
                               normal.ctypes.data)
        return depth, normal


class Relief(Fixed):
    """How steep bumps are near each place, from points that lie as densely on all of a surface: what horizon mutual needs.

    Where bumps are uneven, as round an embossed letter, each place has the slopes near it; else all have those of all points.
    Places repeat with period 1. Where all lie in a smaller square, it is that which is divided. It works in float.

    :param uv: where the points are (…, 2), as of a picture
    :param slopes: theirs along the tangent and y of the local frame: -n.x/n.z, -n.y/n.z (…, 2)
    :param weight: what each counts beside the others, above 0 (…); None: all alike. Where it is not above 0, or any number of a
        point is not finite, the point counts nothing
    :param shape: True where long waves are the surface's own, which nothing shades: slopes are about means of wide windows

    >>> uv, lean = np.random.default_rng(1).random((65536, 2)), np.random.default_rng(2).normal(0, .5, (65536, 2))
    >>> lean[uv[:, 0] < .5] = 0  # bumps on one half
    >>> relief = shade.Relief(uv, lean)
    >>> relief.varies > .5, relief.look_up([[.25, .5], [.75, .5]])[:, 2] > .1
    (True, array([False,  True]))
    """

    CHANGED = "shade.Relief(…, {}) makes another"

    def __init__(self, uv: ArrayLike, slopes: ArrayLike, weight: ArrayLike | None = None, *, shape: bool = False) -> None:
        call = Call().add("uv", uv, "u", "v").add("slopes", slopes, "x", "y").add("weight", weight, "weight").prepare()
        call.dtype = np.dtype(np.float32)
        made = call.columns()
        at = [made[name].ctypes.data if name in made else None for name in ("u", "v", "x", "y", "weight")]
        self._relief = LIB.shade_relief_create(call.count, *at, truth("shape", shape))
        if not self._relief:
            raise MemoryError("no room for this relief")
        weakref.finalize(self, LIB.shade_relief_free, self._relief)
        whole = (ctypes.c_double * 5)()
        self._varies = LIB.shade_relief_whole(self._relief, whole)
        self._slopes = tuple(whole)

    @property
    def slopes(self) -> tuple[float, ...]:
        """Of all points x, y, xx, xy, yy, as a Material takes them: the mean slope, and the second moment about it; with shape
        that about its means."""
        return self._slopes

    @property
    def varies(self) -> float:
        """The variance of xx + yy in windows over the square of its mean. Up to .5, and without shape, every place has the slopes
        of all."""
        return self._varies

    def look_up(self, uv: ArrayLike) -> Floats:
        """The slopes at places, from middle to middle of windows without a step.

        :param uv: where (…, 2); a place that is not finite has the slopes of all
        :returns: x, y, xx, xy, yy (…, 5), as eval takes them of each sample
        """
        call = Call().add("uv", uv, "u", "v").prepare()
        asked, call.dtype = call.dtype, np.dtype(np.float32)
        made, found = call.columns(), np.zeros((5, call.count), np.float32)
        rows = (ctypes.c_void_p * 5)(*(row.ctypes.data for row in found))
        LIB.shade_relief_lookup_batchf(self._relief, call.count, made["u"].ctypes.data, made["v"].ctypes.data, rows)
        return np.moveaxis(found.reshape(5, *call.shape), 0, -1).astype(asked, copy=False)


def split(material: Material, n: ArrayLike | None, covariance: ArrayLike, most: int = 1, *,
          status: Status | None = None) -> Split:
    """The lobes that stand for a material's over slopes of a mean normal and a covariance.

    :param n: mean normal (…, 3); None: z
    :param covariance: xx, xy, yy of the slopes (…, 3)
    :param most: lobes at most, 1 to 8, of equal shape
    :param status: a Status that gathers what had to be mended
    :returns: (x, y, angle, n, weight): exponents or alphas along and across (…); radians by which their axes are turned from the
        tangent (…); normals (…, most, 3), not turned; weights (…, most), 0 where fewer lobes do

    >>> lobes = shade.split(shade.Material(ex=200, ey=10), None, [.01, 0, .01], 4)
    >>> bool(lobes.x < 200), lobes.n.shape
    (True, (4, 3))
    """
    most = int(numbers("most", most, 1, 1, LOBES)[0])
    call = Call().add("n", UP if n is None else n, "nx", "ny", "nz").add("covariance", covariance, "xx", "xy", "yy")
    call.prepare().dtype = np.dtype(np.float64)
    made = np.stack(list(call.columns().values()), -1)
    wide, angle, lobes = (ctypes.c_double * (PARAMS_SIZE // 8))(), ctypes.c_double(), structs.SlopeLobes()
    shape = np.zeros((call.count, 3))
    normals, weights = np.zeros((call.count, most, 3)), np.zeros((call.count, most))
    normals[..., 2] = 1
    carrier = object.__new__(Material)
    carrier._params = wide
    names = ("ex", "ey") if material.mdf == "ashikhmin_shirley" else ("ax", "ay")
    for k, row in enumerate(made):
        gather(status, LIB.shade_params_split(
            material._params, row.ctypes.data, row[3:].ctypes.data, most, wide, ctypes.byref(angle),
            ctypes.byref(lobes)))
        shape[k] = *(getattr(carrier, name) for name in names), angle.value
        count, c, s = lobes.count, np.cos(angle.value), np.sin(angle.value)
        x, y = np.array(lobes.nx[:count]), np.array(lobes.ny[:count])
        normals[k, :count] = np.stack([c * x - s * y, s * x + c * y, lobes.nz[:count]], -1)
        weights[k, :count] = lobes.weight[:count]
    x, y, turn = np.moveaxis(shape.reshape(*call.shape, 3), -1, 0)
    return Split(x[()], y[()], turn[()], normals.reshape(*call.shape, most, 3), weights.reshape(*call.shape, most))
