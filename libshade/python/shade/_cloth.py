# SPDX-License-Identifier: Apache-2.0
"""Woven cloth over numpy arrays (fabric.h, weave.h), and the presets (presets.h)."""
import ctypes
import functools
import os
import warnings
import weakref
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _structs as structs
from ._arrays import Call, Floats, Status, gather
from ._library import LIB, Fixed, Preset, one_of, rows, text, truth, words
from ._material import choices, default_of, numbers

PresetRow = NamedTuple("PresetRow", [
    ("kind", str), ("label", str), ("help", str), ("source", str), ("color_source", str), ("weave", str | None),
    ("ends_per_cm", float), ("picks_per_cm", float), ("scratch_cm", float), ("turned", bool)])
DrawnLight = NamedTuple("DrawnLight", [("wi", Floats), ("s", Floats), ("pdf", Floats)])
Info = NamedTuple("Info", [("warp_lobes", int), ("weft_lobes", int), ("warp_share", float), ("weft_share", float),
                           ("warp_single", tuple[float, ...]), ("weft_single", tuple[float, ...])])
TIERS = {"auto": (0,), "near": (1,), "far": (2,), "single": (3,)}
TOPS = ("weft", "warp", "gap")
CHOICES = ("mdf", "brdf", "detail", "horizon")


def presets() -> dict[str, PresetRow]:
    """{name: PresetRow} of cloths (kind "fabric") and metals (kind "metal"). Lengths are per cm or in cm."""
    return {text(row.word): PresetRow(
        "metal" if row.kind else "fabric", text(row.label), text(row.help), text(row.source), text(row.color_source),
        text(row.weave), row.ends_per_cm, row.picks_per_cm, row.scratch_cm, bool(row.turned))
        for row in rows(LIB.shade_preset_row, Preset)}


@functools.lru_cache(None)
def weaves() -> dict[str, str]:
    """{name: label} of the weaves that `fabric(weave=…)` takes."""
    listed, word, label = {}, ctypes.c_char_p(), ctypes.c_char_p()
    while LIB.shade_weave_row(len(listed), ctypes.byref(word), ctypes.byref(label), None):
        listed[text(word.value)] = text(label.value)
    return listed


def _draft(weave, pattern, draft, wif):
    """A draft, to be freed, of the one that is given."""
    if wif is not None:
        message = ctypes.create_string_buffer(1024)
        made = LIB.shade_wif_read(str(wif).encode(), message, len(message))
        if not made:
            raise ValueError(text(message.value))
        if message.value:
            warnings.warn(text(message.value), stacklevel=4)
        return made
    if pattern is not None:
        whole = np.asarray(pattern)
        fits = whole.shape == (3,) and whole.dtype.kind in "iu" and np.all(np.abs(whole) < 1 << 31)
        made = LIB.shade_draft_from_pattern(*whole.tolist()) if fits else None
        if not made:
            raise ValueError(f"pattern: {pattern!r} given; expected (n_w >= 1, n_p >= 0, n_s), n_w + n_p <= 4096")
        return made
    if draft is not None:
        up = np.ascontiguousarray(np.asarray(draft) != 0, np.uint8)
        made = LIB.shade_draft_from_matrix(up.shape[1], up.shape[0], up.ctypes.data) if up.ndim == 2 else None
        if not made:
            raise ValueError(f"draft: shape {up.shape} given; expected (picks, ends), sides of 1 to 16384, 2^24 in all")
        return made
    made = LIB.shade_draft_named(str(weave).encode())
    if not made:
        raise ValueError(f"weave: {weave!r} given; expected one of {', '.join(weaves())}")
    return made


class _Row:
    """A number kept in a structure, by the library's own row of it."""

    def __init__(self, info, address):
        self.info, self.address = info, address

    def set(self, name, value):
        components = max(self.info.components, 1)
        given = numbers(name, value, components, self.info.minimum, self.info.maximum)
        (ctypes.c_double * components).from_address(self.address)[:] = list(given)


def _numbers_of(function, structure):
    """{word: _Row} of what a function of (structure, row, info) tells."""
    found, info = {}, structs.ParamInfo()
    while True:
        address = function(ctypes.byref(structure), len(found), ctypes.byref(info))
        if not address:
            return found
        found[text(info.word)] = _Row(info, address)
        info = structs.ParamInfo()


def _set_yarn(name, shape, yarn, values):
    material, diffuse = _numbers_of(LIB.shade_fabric_yarn_number, yarn), choices("diffuse")
    shapes = {text(info.word): info for info in rows(LIB.shade_yarn_param_row, structs.ParamInfo)}
    for word, value in values.items():
        if word == "diffuse":
            yarn.diffuse = one_of(f"{name} {word}", value, diffuse)
        elif word in material:
            material[word].set(f"{name} {word}", value)
        elif word in shapes:
            _Row(shapes[word], LIB.shade_yarn_param(ctypes.byref(shape), word.encode())).set(f"{name} {word}", value)
        else:
            raise TypeError(f"{name} {word!r}: no such parameter; there are "
                            + ", ".join(["diffuse", *material, *shapes]))


def fabric(preset: str | None = None, *, weave: str | None = None, pattern: ArrayLike | None = None,
           draft: ArrayLike | None = None, wif: str | os.PathLike[str] | None = None, warp: dict[str, Any] | None = None,
           weft: dict[str, Any] | None = None, defaults: int | None = None, **values: Any) -> "Fabric":
    """A cloth: a preset (`shade.presets()`), changed by what else is given, or plain weave of the defaults.

    One of `weave` (a name), `pattern` (n_w, n_p, n_s), `draft` (an array of picks × ends, not 0 where the warp is
    up) and `wif` (a file's path) says what lies over what. `warp`, `weft`: dictionaries of yarns' numbers
    (`width`, `gap`, `curve`, … of weave.h; `along`, `across`, `f0`, `kd`, `diffuse` of fabric.h). `values`: mdf,
    brdf, detail, horizon, occlusion, seed, draft_colors, shadows, backing, nap, nap_color, warp_transmit,
    weft_transmit. `defaults`: as `shade.Material` has it.
    """
    found = Preset()
    if preset is None:
        LIB.shade_weave_params_init(ctypes.byref(found.yarns))
        LIB.shade_fabric_params_init(ctypes.byref(found.fabric))
    elif not LIB.shade_preset_find(str(preset).encode(), ctypes.byref(found)) or found.kind != 0:
        raise ValueError(f"preset: {preset!r} given; expected a cloth of shade.presets()")
    yarns, cloth = found.yarns, found.fabric
    cloth.brdf = default_of("brdf", defaults)
    _set_yarn("warp", yarns.warp, cloth.warp, warp or {})
    _set_yarn("weft", yarns.weft, cloth.weft, weft or {})
    known = _numbers_of(LIB.shade_fabric_number, cloth)
    for word, value in values.items():
        if word in known:
            known[word].set(word, value)
        elif word in CHOICES:
            setattr(cloth, word, one_of(word, value, choices(word)))
        elif word == "occlusion":
            yarns.occlusion = one_of(word, value, words(LIB.shade_occlusion_row))
        elif word == "seed":
            yarns.seed = int(value) & 0xFFFFFFFF
        elif word in ("draft_colors", "shadows"):
            setattr(cloth, word, truth(word, value))
        else:
            raise TypeError(f"{word!r}: no such parameter; there are "
                            + ", ".join([*CHOICES, "occlusion", "seed", "draft_colors", "shadows", *known]))
    if sum(way is not None for way in (weave, pattern, draft, wif)) > 1:
        raise TypeError("one of weave, pattern, draft and wif, not several")
    return Fabric(_draft(text(found.weave) if weave is None and preset is not None else weave or "plain",
                         pattern, draft, wif), yarns, cloth)


def _free(cloth, weave):
    LIB.shade_fabric_free(cloth)
    LIB.shade_weave_free(weave)


class Fabric(Fixed):
    """A cloth ready to be evaluated; `shade.fabric` makes it."""

    CHANGED = "shade.fabric(…, {}) makes another"

    def __init__(self, draft: Any, yarns: structs.WeaveParams, cloth: structs.FabricParams) -> None:
        bits = ctypes.c_uint()
        weave = LIB.shade_weave_create(draft, ctypes.byref(yarns), ctypes.byref(bits))
        LIB.shade_draft_free(draft)
        self._fabric = LIB.shade_fabric_create(weave, ctypes.byref(cloth), ctypes.byref(bits)) if weave else None
        self._weave = weave
        self._finalizer = weakref.finalize(self, _free, self._fabric, weave)
        if not self._fabric:
            raise MemoryError("no room for this cloth")

    def _call(self, function, uv, light, wo, random, footprint, n, tier, varied, status, **groups):
        call = Call().add("uv", uv, "u", "v").add("wo", wo, "wox", "woy", "woz")
        call.add("wi", light, "wix", "wiy", "wiz").add("u", random, "u1", "u2", "u3")
        if footprint is not None:
            footprint = np.asarray(footprint) if np.ndim(footprint) else np.array([footprint, footprint], np.float64)
            call.add("footprint", footprint if footprint.ndim > 1 else footprint.tolist(), "du", "dv")
        call.add("n", n, "nx", "ny", "nz")
        for name, value in varied.items():
            if name in ("warp_kd", "weft_kd"):
                call.add(name, value, *(f"{name[:4]}_{c}" for c in "rgb"))
            elif name in ("warp_gloss", "weft_gloss", "nap", "random"):
                call.add(name, value, name)
            else:
                raise TypeError(f"{name!r}: no parameter of a sample; there are warp_kd, weft_kd, warp_gloss, "
                                "weft_gloss, nap, random")
        lanes = call.prepare().lanes(structs.FabricLanes)
        result, made = call.results(structs.FabricResult, **groups)
        function = getattr(LIB, function + call.ending)
        gather(status, function(self._fabric, call.count, ctypes.byref(lanes), one_of("tier", tier, TIERS),
                                ctypes.byref(result)))
        return made

    def eval(self, uv: ArrayLike, wi: ArrayLike, wo: ArrayLike, *, footprint: ArrayLike | None = None,
             n: ArrayLike | None = None, tier: str = "auto", status: Status | None = None, **varied: ArrayLike) -> Floats:
        """s, what is seen for unit irradiance from wi, f · cos, RGB, in 1/sr: an array (…, 3).

        uv (…, 2): where, in crossings; footprint: extent of the pixel along u and v, (…, 2) or one number; n
        (…, 3): the cloth's own perturbed normal; tier: auto, near, far or single. `varied`, of each sample: warp_kd,
        weft_kd (…, 3), warp_gloss, weft_gloss, nap, random (…).
        """
        return self._call("shade_fabric_eval_batch", uv, wi, wo, None, footprint, n, tier, varied, status,
                          s="r g b")["s"]

    def coverage(self, uv: ArrayLike, wo: ArrayLike, *, footprint: ArrayLike | None = None,
                 n: ArrayLike | None = None, tier: str = "auto", status: Status | None = None, **varied: ArrayLike) -> Floats:
        """The share of the eye's ray that meets yarn, fibres or backing: an array (…)."""
        return self._call("shade_fabric_eval_batch", uv, wo, wo, None, footprint, n, tier, varied, status,
                          s="r g b", coverage="coverage")["coverage"][()]

    def pdf(self, uv: ArrayLike, wi: ArrayLike, wo: ArrayLike, *, footprint: ArrayLike | None = None,
            n: ArrayLike | None = None, tier: str = "auto", status: Status | None = None, **varied: ArrayLike) -> Floats:
        """The density, in 1/sr, with which `sample` draws wi: an array (…)."""
        return self._call("shade_fabric_pdf_batch", uv, wi, wo, None, footprint, n, tier, varied, status,
                          pdf="pdf")["pdf"][()]

    def sample(self, uv: ArrayLike, wo: ArrayLike, u: ArrayLike, *, footprint: ArrayLike | None = None,
               n: ArrayLike | None = None, tier: str = "auto", status: Status | None = None, **varied: ArrayLike) -> DrawnLight:
        """Draw wi for wo from u (…, 3), uniform in [0, 1). Returns (wi, s, pdf); all 0 where no direction was
        found. s / pdf over u is the albedo."""
        made = self._call("shade_fabric_sample_batch", uv, None, wo, u, footprint, n, tier, varied, status,
                          wi="wix wiy wiz", s="r g b", pdf="pdf")
        return DrawnLight(made["wi"], made["s"], made["pdf"][()])

    def albedo(self, wo: ArrayLike) -> Floats:
        """RGB of the share of even light that the far model sends towards wo (…, 3); some milliseconds each."""
        call = Call().add("wo", np.asarray(wo, np.float64), "x", "y", "z").prepare()
        out = np.zeros((call.count, 3))
        for row, direction in zip(out, np.stack(list(call.columns().values()), -1)):
            LIB.shade_fabric_albedo_towards(self._fabric, direction.copy().ctypes.data, row.ctypes.data)
        return out.reshape(*call.shape, 3)

    def look_up(self, uv: ArrayLike, *, status: Status | None = None) -> dict[str, Any]:
        """What lies at uv (…, 2): a dictionary of arrays (…), weave.h's shade_crossing; `top` is 0 weft, 1 warp,
        2 gap."""
        call = Call().add("uv", uv, "u", "v").prepare()
        made = call.columns()
        whole = ("top", "swap", "below", "yarn")
        real = ("sigma", "along", "dx", "dy", "tx", "ty", "occlusion", "brightness", "fuzz", "r", "g", "b")
        out = {name: np.zeros(call.count, np.intc if name in whole else call.dtype) for name in (*whole, *real)}
        result = structs.Crossings(ctypes.sizeof(structs.Crossings), *(a.ctypes.data for a in out.values()))
        function = getattr(LIB, "shade_weave_lookup_batch" + call.ending)
        gather(status, function(self._weave, call.count, made["u"].ctypes.data, made["v"].ctypes.data,
                                ctypes.byref(result)))
        return {name: array.reshape(call.shape)[()] for name, array in out.items()}

    def info(self) -> Info:
        """How the far model sees the cloth: lobes, shares, and the exponents of tier single."""
        info = structs.FabricInfo()
        LIB.shade_fabric_get_info(self._fabric, ctypes.byref(info))
        values: list[Any] = [tuple(v) if hasattr(v, "__len__") else v
                             for v in (getattr(info, name) for name in Info._fields)]
        return Info(*values)
