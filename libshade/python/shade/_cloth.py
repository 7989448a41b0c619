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
CHOICES = ("mdf", "brdf", "detail", "horizon")


def presets() -> dict[str, PresetRow]:
    """Cloths (kind "fabric") and metals (kind "metal") by name: {name: PresetRow}.

    A PresetRow has kind, label, help, source, color_source, weave, ends_per_cm, picks_per_cm, scratch_cm (in cm) and turned.

    >>> shade.presets()["denim"].kind
    'fabric'
    """
    return {text(row.word): PresetRow(
        "metal" if row.kind else "fabric", text(row.label), text(row.help), text(row.source), text(row.color_source),
        text(row.weave), row.ends_per_cm, row.picks_per_cm, row.scratch_cm, bool(row.turned))
        for row in rows(LIB.shade_preset_row, Preset)}


@functools.lru_cache(None)
def weaves() -> dict[str, str]:
    """The weaves that `fabric(weave=…)` takes: {name: label}.

    >>> shade.weaves()["satin_5"]
    'Satin of 5'
    """
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
            warnings.warn(text(message.value), stacklevel=3)
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
    """A cloth: a preset, changed by what else is given, or plain weave of the defaults.

    One of `weave`, `pattern`, `draft` and `wif` says what lies over what.

    :param preset: a cloth of `shade.presets()`
    :param weave: a name of `shade.weaves()`
    :param pattern: (n_w, n_p, n_s): ends under the weft, ends over it, and the shift from pick to pick
    :param draft: an array of picks × ends, not 0 where the warp is up
    :param wif: the path of a Weaving Information File
    :param warp: numbers of the warp yarns by name: `width`, `gap`, `curve`, … of weave.h; `along`, `across`, `f0`, `kd` and `diffuse`
        of fabric.h
    :param weft: the same of the weft yarns
    :param defaults: the version of the defaults, as `shade.Material` has it
    :param values: mdf, brdf, detail, horizon, occlusion, seed, draft_colors, shadows, backing, nap, nap_color, warp_transmit,
        weft_transmit
    :raises ValueError: for a number out of its range, an unknown word or a draft that is none
    :raises TypeError: for an unknown name

    >>> twill = shade.fabric(weave="twill_3_1", warp={"kd": (.02, .05, .2)}, nap=.1)
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
    """A cloth ready to be evaluated. `shade.fabric` makes it. Any number of threads may share one."""

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
        """What is seen for unit irradiance from wi: s = f · cos.

        :param uv: where, in crossings (…, 2)
        :param wi: to the light (…, 3), unit
        :param wo: to the eye (…, 3), unit
        :param footprint: extent of the pixel along u and v, in crossings, (…, 2) or one number; None: the point
        :param n: the cloth's own perturbed normal (…, 3), unit; None: z
        :param tier: auto, near, far or single
        :param status: a Status that gathers what had to be mended
        :param varied: of each sample, in place of the cloth's: warp_kd, weft_kd (…, 3), warp_gloss, weft_gloss, nap, random (…)
        :returns: RGB in 1/sr, an array (…, 3)

        >>> shade.fabric("denim").eval([.25, .5], [.6, 0, .8], [0, 0, 1], footprint=[[1, 1], [50, 50]]).shape
        (2, 3)
        """
        return self._call("shade_fabric_eval_batch", uv, wi, wo, None, footprint, n, tier, varied, status,
                          s="r g b")["s"]

    def coverage(self, uv: ArrayLike, wo: ArrayLike, *, footprint: ArrayLike | None = None,
                 n: ArrayLike | None = None, tier: str = "auto", status: Status | None = None, **varied: ArrayLike) -> Floats:
        """The share of the eye's ray that meets yarn, fibres or backing: an array (…).

        The parameters are those of `eval`.

        >>> float(shade.fabric("denim").coverage([.25, .5], [0, 0, 1]))
        1.0
        """
        return self._call("shade_fabric_eval_batch", uv, wo, wo, None, footprint, n, tier, varied, status,
                          s="r g b", coverage="coverage")["coverage"][()]

    def pdf(self, uv: ArrayLike, wi: ArrayLike, wo: ArrayLike, *, footprint: ArrayLike | None = None,
            n: ArrayLike | None = None, tier: str = "auto", status: Status | None = None, **varied: ArrayLike) -> Floats:
        """The density with which `sample` draws wi: an array (…), in 1/sr.

        The parameters are those of `eval`.

        >>> bool(shade.fabric("denim").pdf([.25, .5], [.6, 0, .8], [0, 0, 1]) > 0)
        True
        """
        return self._call("shade_fabric_pdf_batch", uv, wi, wo, None, footprint, n, tier, varied, status,
                          pdf="pdf")["pdf"][()]

    def sample(self, uv: ArrayLike, wo: ArrayLike, u: ArrayLike, *, footprint: ArrayLike | None = None,
               n: ArrayLike | None = None, tier: str = "auto", status: Status | None = None, **varied: ArrayLike) -> DrawnLight:
        """Draw directions to the light. s / pdf, averaged over u, is the albedo.

        All results are 0 where a draw found no direction. The other parameters are those of `eval`.

        :param u: three numbers for each draw (…, 3), uniform in [0, 1)
        :returns: (wi, s, pdf): (…, 3), RGB in 1/sr (…, 3), and in 1/sr (…)

        >>> shade.fabric("denim").sample([.25, .5], [0, 0, 1], [[.1, .2, .3], [.9, .4, .6]]).wi.shape
        (2, 3)
        """
        made = self._call("shade_fabric_sample_batch", uv, None, wo, u, footprint, n, tier, varied, status,
                          wi="wix wiy wiz", s="r g b", pdf="pdf")
        return DrawnLight(made["wi"], made["s"], made["pdf"][()])

    def albedo(self, wo: ArrayLike) -> Floats:
        """The share of even light that the far model sends towards wo (…, 3): RGB, an array (…, 3). Each takes some milliseconds.

        >>> bool((shade.fabric("denim").albedo([0, 0, 1]) < 1).all())
        True
        """
        call = Call().add("wo", np.asarray(wo, np.float64), "x", "y", "z").prepare()
        out = np.zeros((call.count, 3))
        for row, direction in zip(out, np.stack(list(call.columns().values()), -1)):
            LIB.shade_fabric_albedo_towards(self._fabric, direction.copy().ctypes.data, row.ctypes.data)
        return out.reshape(*call.shape, 3)

    def look_up(self, uv: ArrayLike, *, status: Status | None = None) -> dict[str, Any]:
        """What lies at uv (…, 2): a dictionary of arrays (…), as shade_crossing of weave.h has it.

        `top` is 0 for the weft, 1 for the warp, and 2 for a gap.

        >>> shade.fabric(pattern=(1, 2, 1)).look_up([[.5, .5], [1.5, .5]])["top"].tolist()
        [0, 1]
        """
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
        """How the far model sees the cloth: lobes, shares, and the exponents of the tier single.

        >>> shade.fabric("denim").info().warp_lobes > 1
        True
        """
        info = structs.FabricInfo()
        LIB.shade_fabric_get_info(self._fabric, ctypes.byref(info))
        values: list[Any] = [tuple(v) if hasattr(v, "__len__") else v
                             for v in (getattr(info, name) for name in Info._fields)]
        return Info(*values)
