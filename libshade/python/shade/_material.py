# SPDX-License-Identifier: Apache-2.0
"""Materials, and what one reflects: shade.h over numpy arrays."""
import ctypes
import functools
import json
import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _structs as structs
from ._arrays import Call, Floats, Status, gather
from ._library import DEFAULTS, LIB, PARAMS_SIZE, Fixed, Preset, one_of, rows, text, truth, words

Parameter = NamedTuple("Parameter", [
    ("word", str), ("unit", str), ("help", str), ("components", int), ("minimum", float), ("maximum", float),
    ("initial", float), ("list", str | None), ("choices", tuple[str, ...] | None)])
Choice = NamedTuple("Choice", [("value", int), ("label", str), ("help", str)])
MetalRow = NamedTuple("MetalRow", [("label", str), ("eta", tuple[float, ...]), ("k", tuple[float, ...])])
Shaded = NamedTuple("Shaded", [("f", Floats), ("cosine", Floats)])
Drawn = NamedTuple("Drawn", [("wi", Floats), ("f", Floats), ("pdf", Floats), ("cosine", Floats)])
COLOURS = ("f0", "f82", "eta", "k", "kd")
PARTS = {"both": (0,), "specular": (1,), "diffuse": (2,)}


@functools.lru_cache(None)
def lists() -> dict[str, str]:
    """The lists of choices of a material, each with its default: {name: word}.

    >>> shade.lists()["detail"]
    'rotate'
    """
    listed, about = {}, structs.ListInfo()
    while LIB.shade_list_about(len(listed), ctypes.byref(about)):
        listed[text(about.word)] = text(LIB.shade_list_word(len(listed), about.initial))
    return listed


@functools.lru_cache(None)
def choices(name: str) -> dict[str, Choice]:
    """The choices of a list: {word: Choice(value, label, help)}.

    :param name: the list, of `shade.lists()`

    >>> shade.choices("fresnel")["conductor"].help
    "Exact, from a metal's complex index of refraction"
    """
    number = one_of("list", name, {word: (k,) for k, word in enumerate(lists())})
    return {word: Choice(*row) for word, row in words(LIB.shade_list_row, number).items()}


@functools.lru_cache(None)
def parameters() -> dict[str, Parameter]:
    """The numbers of a material, in the table's order: {name: Parameter}.

    A Parameter has word, unit, help, components, minimum, maximum and initial. Its `list` and `choices` say which choices read it.
    None means that all do.

    >>> shade.parameters()["ax"].maximum
    10.0
    """
    names, listed = list(lists()), {}
    for info in rows(LIB.shade_param_row, structs.ParamInfo):
        of = names[info.list] if info.list < len(names) else None
        read_by = tuple(w for w, c in choices(of).items() if info.choices >> c.value & 1) if of else None
        listed[text(info.word)] = Parameter(text(info.word), text(info.unit), text(info.help), info.components,
                                            info.minimum, info.maximum, info.initial, of, read_by)
    return listed


def metals() -> dict[str, MetalRow]:
    """The measured metals: {word: (label, eta, k)}, with eta and k at red, green and blue.

    >>> shade.metals()["gold"].label
    'Gold'
    """
    return {text(row.word): MetalRow(text(row.label), tuple(row.eta), tuple(row.k))
            for row in rows(LIB.shade_metal_row, structs.Metal)}


def numbers(name, value, components, minimum, maximum):
    """`components` doubles within the range, or an error that names all three."""
    try:
        given = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        given = np.full(9, np.nan)
    fits = given.shape == () or given.shape == (components,) != (1,)
    if not (fits and np.all((given >= minimum) & (given <= maximum))):  # NaN is not
        expected = "a number" if components == 1 else f"one number or {components}"
        raise ValueError(f"{name}: {value!r} given; expected {expected} from {minimum:g} to {maximum:g}")
    return (ctypes.c_double * components)(*np.broadcast_to(given, components))


def _no_axis_twice(given):
    for exponent, alpha in (("ex", "ax"), ("ey", "ay")):
        if exponent in given and alpha in given:
            raise TypeError(f"{exponent} and {alpha} given; expected one of them, which sets the other")


def default_of(name, defaults):
    """A list's default, as a number, in a version of the defaults; None: the newest."""
    if defaults is None:
        defaults = DEFAULTS
    if isinstance(defaults, bool) or not isinstance(defaults, int) or not 0 <= defaults <= DEFAULTS:
        raise ValueError(f"defaults: {defaults!r} given; expected a whole number from 0 to {DEFAULTS}")
    return LIB.shade_list_default(list(lists()).index(name), defaults)


class Material(Fixed):
    """A metal or another surface, ready to be evaluated.

    It takes choices and numbers by the names of the table, which `shade.lists()` and `shade.parameters()` hold. `preset` and `metal`
    are taken first, then `roughness`, then the rest. An exponent sets the alpha of its axis and the other way round: give one of
    them. Values are read as attributes and never change. `replace` makes another material. Any number of threads may share one.

    :param preset: a metal of `shade.presets()`
    :param metal: a word of `shade.metals()`
    :param roughness: (convention, roughness, anisotropy), as another program states it: roughness in [0, 1], anisotropy in [0, 1], or
        in [-1, 1] for Blender Glossy. The convention is blender_principled, blender_glossy, blender_glossy_2_79, gltf, materialx or
        openpbr
    :param slopes: of the map, for horizon mutual: its mean slope x, y, and the second moment of slopes about it, xx, xy, yy
    :param defaults: the version of the defaults, 0 for those of libshade 0.2 (brdf ashikhmin_shirley, not auto); without it the newest
    :param fast: a word of older versions, read no more
    :param values: choices as words, numbers within their range, colours as one number or three
    :raises ValueError: for a number out of its range or an unknown word
    :raises TypeError: for an unknown name

    `multiscatter="on"` needs mdf ggx or beckmann, and brdf auto or microfacet. Elsewhere it changes nothing, and a warning says so.

    >>> gold = shade.Material(mdf="ggx", ax=.1, ay=.4, metal="gold")
    >>> gold.fresnel, gold.ay
    ('conductor', 0.4)
    """

    CHANGED = "replace({}) makes a material like it that has it"

    def __init__(self, *, preset: str | None = None, metal: str | None = None,
                 roughness: tuple[str, float, float] | None = None, fast: bool | None = None,
                 defaults: int | None = None, **values: Any) -> None:
        self._params = (ctypes.c_double * (PARAMS_SIZE // 8))()
        LIB.shade_params_init(self._params)
        if preset is not None:
            self._take_preset(preset)
        for number, (name, word) in enumerate(lists().items()):
            older = default_of(name, defaults)
            if older != default_of(name, None) and getattr(self, name) == word:  # of presets too, which leave it open
                LIB.shade_params_set_choice(self._params, number, older)
        self._set(metal, roughness, fast, values)

    def _take_preset(self, name):
        found = Preset()
        if not LIB.shade_preset_find(str(name).encode(), ctypes.byref(found)) or found.kind != 1:
            raise ValueError(f"preset: {name!r} given; expected a metal of shade.presets()")
        self._params = type(self._params)(*found.metal)

    def _set(self, metal, roughness, fast, values):
        if metal is not None and not LIB.shade_params_set_metal(self._params, str(metal).encode()):
            raise ValueError(f"metal: {metal!r} given; expected one of {', '.join(metals())}")
        if roughness is not None:
            try:
                convention, rough, anisotropy = roughness
            except (TypeError, ValueError):
                raise ValueError(f"roughness: {roughness!r} given; expected (convention, roughness, anisotropy)") \
                    from None
            value = one_of("roughness", convention, words(LIB.shade_roughness_row))
            rough, = numbers("roughness", rough, 1, 0, 1)
            anisotropy, = numbers("anisotropy", anisotropy, 1, -1, 1)
            LIB.shade_params_set_roughness(self._params, value, rough, anisotropy)
        if fast is not None:
            truth("fast", fast)
        _no_axis_twice(values)
        for name, value in values.items():
            self._set_one(name, value)
        if {"mdf", "brdf", "multiscatter"} & {*values} and self.multiscatter == "on" and not (
                self.mdf in ("ggx", "beckmann") and self.brdf in ("auto", "microfacet")):
            warnings.warn(f"multiscatter on changes nothing with mdf {self.mdf} and brdf {self.brdf}; it needs mdf ggx or beckmann, and "
                          "brdf auto or microfacet", stacklevel=3)
        self._bsdf = structs.Bsdf()
        LIB.shade_bsdf_setup(ctypes.byref(self._bsdf), self._params)

    def _set_one(self, name, value):
        if name in lists():
            LIB.shade_params_set_choice(self._params, list(lists()).index(name), one_of(name, value, choices(name)))
        elif name in parameters():
            row = parameters()[name]
            LIB.shade_params_set(self._params, list(parameters()).index(name),
                                 numbers(name, value, row.components, row.minimum, row.maximum))
        elif name == "slopes":
            given = np.asarray(value, float)
            if given.shape != (5,) or LIB.shade_params_set_slopes(self._params, (ctypes.c_double * 5)(*given)):
                raise ValueError(f"slopes: {value!r} given; expected x, y from -1e3 to 1e3, xx, xy, yy from 0 to 1e6, "
                                 "and xy at most sqrt(xx yy) either way")
        else:
            raise TypeError(f"{name!r}: no such parameter; there are preset, metal, roughness, defaults, slopes, fast, "
                            + ", ".join([*lists(), *parameters()]))

    def replace(self, *, metal: str | None = None, roughness: tuple[str, float, float] | None = None,
                fast: bool | None = None, **values: Any) -> "Material":
        """A material like this but for what is given.

        >>> shade.Material(ex=200).replace(ex=50).ex
        50.0
        """
        other = object.__new__(Material)
        other._params = type(self._params)(*self._params)
        other._set(metal, roughness, fast, values)
        return other

    def __getattr__(self, name: str) -> Any:
        if name in lists():
            number = list(lists()).index(name)
            return text(LIB.shade_list_word(number, LIB.shade_params_get_choice(self._params, number)))
        if name in parameters():
            got = (ctypes.c_double * 3)()
            LIB.shade_params_get(self._params, list(parameters()).index(name), got)
            return tuple(got) if parameters()[name].components == 3 else got[0]
        if name == "slopes":
            slopes = (ctypes.c_double * 5)()
            LIB.shade_params_get_slopes(self._params, slopes)
            return tuple(slopes)
        raise AttributeError(f"a material has no {name!r}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *lists(), *parameters(), "slopes"]

    def json(self, number: int = 0, name: str | None = None) -> dict[str, Any]:
        """The material as the header of a dump has it: a dictionary.

        :param number: its `id` there
        :param name: its name there

        >>> shade.Material().json(3)["id"]
        3
        """
        called = None if name is None else str(name).encode()
        length = LIB.shade_params_json(self._params, number, called, None, 0)
        buffer = ctypes.create_string_buffer(length + 1)
        LIB.shade_params_json(self._params, number, called, buffer, len(buffer))
        return json.loads(buffer.value)

    def __repr__(self) -> str:
        said = [f"{name}={getattr(self, name)!r}" for name, first in lists().items() if getattr(self, name) != first]
        reads = {name: row for name, row in parameters().items()
                 if row.choices is None or getattr(self, str(row.list)) in row.choices}
        said += [f"{name}={getattr(self, name)!r}" for name, row in reads.items()]
        said += [f"slopes={self.slopes!r}"] * any(self.slopes)
        return f"shade.Material({', '.join(said)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (bytes(self._params),)


def _again(params):
    material = object.__new__(Material)
    # of an older version it is shorter
    material._params = (ctypes.c_double * (PARAMS_SIZE // 8)).from_buffer_copy(params + bytes(PARAMS_SIZE))
    material._set(None, None, None, {})
    return material


UP = (0.0, 0.0, 1.0)


def _varied(call, parts, varied):
    """Parameters of each sample. Returns the number of `parts`."""
    _no_axis_twice(varied)
    for name, value in varied.items():
        if name in COLOURS:
            call.add(name, value, *(name + c for c in "rgb"))
        elif name in ("ax", "ay", "ex", "ey"):
            call.add(name, value, name)
        elif name == "groove":
            call.add(name, value, "groove_x", "groove_y")
        elif name == "slopes":
            call.add(name, value, "slope_x", "slope_y", "slope_xx", "slope_xy", "slope_yy")
        else:
            raise TypeError(f"{name!r}: no parameter of a sample; there are ax, ay, ex, ey, groove, slopes, "
                            + ", ".join(COLOURS))
    return one_of("parts", parts, PARTS)


def _directions(call, n, wo):
    call.add("n", UP if n is None else n, "nx", "ny", "nz").add("wo", wo, "wox", "woy", "woz")
    return call


def _made(material):
    if not isinstance(material, Material):
        raise TypeError(f"{material!r} given; expected a shade.Material")
    return ctypes.byref(material._bsdf)


def eval(material: Material, n: ArrayLike | None, wi: ArrayLike, wo: ArrayLike, *, parts: str = "both",
         status: Status | None = None, **varied: ArrayLike) -> Shaded:
    """The BRDF f(wi, wo) and its cosine. A picture is f · cosine · irradiance.

    All arrays are broadcast against each other. The results are float32 where all numpy arrays are, else float64.

    :param n: perturbed normal (…, 3), unit; None: z
    :param wi: to the light (…, 3), unit
    :param wo: to the eye (…, 3), unit
    :param parts: both, specular or diffuse
    :param status: a Status that gathers what had to be mended
    :param varied: parameters of each sample in place of the material's: ax, ay, ex, ey (…); f0, f82, eta, k, kd (…, 3); groove (…, 2);
        slopes (…, 5)
    :returns: (f, cosine): RGB in 1/sr (…, 3), and (…)

    >>> f, cosine = shade.eval(shade.Material(ex=200, ey=10), None, [.6, 0, .8], [-.6, 0, .8])
    >>> f.shape, float(cosine)
    ((3,), 0.8)
    """
    call = _directions(Call(), n, wo).add("wi", wi, "wix", "wiy", "wiz")
    number = _varied(call, parts, varied)
    lanes = call.prepare().lanes(structs.Lanes, parts=number)
    result, made = call.results(structs.Result, f="r g b", cosine="cosine")
    function = getattr(LIB, "shade_bsdf_eval_batch" + call.ending)
    gather(status, function(_made(material), call.count, ctypes.byref(lanes), ctypes.byref(result)))
    return Shaded(made["f"], made["cosine"][()])


def D(material: Material, n: ArrayLike | None, h: ArrayLike, *, status: Status | None = None) -> Floats:
    """D'(h), the distribution carried by the perturbed normal.

    :param n: perturbed normal (…, 3), unit; None: z
    :param h: half vector (…, 3), unit
    :param status: a Status that gathers what had to be mended
    :returns: an array (…), in 1/sr

    >>> float(shade.D(shade.Material(ex=2, ey=2), None, [0, 0, 1]) * 2 * np.pi)  # √(3 · 3)
    3.0
    """
    call = Call().add("n", UP if n is None else n, "nx", "ny", "nz").add("h", h, "hx", "hy", "hz").prepare()
    made, out = call.columns(), np.zeros(call.count, call.dtype)
    function = getattr(LIB, "shade_mdf_eval_batch" + call.ending)
    gather(status, function(_made(material), call.count, *(a.ctypes.data for a in made.values()), out.ctypes.data))
    return out.reshape(call.shape)[()]


def pdf(material: Material, n: ArrayLike | None, wi: ArrayLike, wo: ArrayLike, *, parts: str = "both",
        status: Status | None = None, **varied: ArrayLike) -> Floats:
    """The density with which `sample` draws wi for wo.

    The parameters are those of `eval`.

    :returns: an array (…), in 1/sr

    >>> bool(shade.pdf(shade.Material(), None, [.6, 0, .8], [-.6, 0, .8]) > 1)
    True
    """
    call = _directions(Call(), n, wo).add("wi", wi, "wix", "wiy", "wiz")
    number = _varied(call, parts, varied)
    lanes, out = call.prepare().lanes(structs.Lanes, parts=number), np.zeros(call.count, call.dtype)
    function = getattr(LIB, "shade_bsdf_pdf_batch" + call.ending)
    gather(status, function(_made(material), call.count, ctypes.byref(lanes), out.ctypes.data))
    return out.reshape(call.shape)[()]


def sample(material: Material, n: ArrayLike | None, wo: ArrayLike, u: ArrayLike, *, parts: str = "both",
           status: Status | None = None, **varied: ArrayLike) -> Drawn:
    """Draw directions to the light. f · cosine / pdf, averaged over u, is the albedo.

    All results are 0 where a draw found no direction, and it counts so in an average.

    :param n: perturbed normal (…, 3), unit; None: z
    :param wo: to the eye (…, 3), unit
    :param u: two numbers for each draw (…, 2), uniform in [0, 1)
    :param parts: both, specular or diffuse
    :param status: a Status that gathers what had to be mended
    :param varied: as for `eval`
    :returns: (wi, f, pdf, cosine): (…, 3), RGB in 1/sr (…, 3), in 1/sr (…), and (…)

    >>> drawn = shade.sample(shade.Material(), None, [0, 0, 1], [[.2, .3], [.5, .5]])
    >>> drawn.wi.shape, bool((drawn.pdf > 0).all())
    ((2, 3), True)
    """
    call = _directions(Call(), n, wo).add("u", u, "u1", "u2")
    number = _varied(call, parts, varied)
    lanes = call.prepare().lanes(structs.SampleLanes, parts=number)
    result, made = call.results(structs.SampleResult, wi="wix wiy wiz", f="r g b", pdf="pdf", cosine="cosine")
    function = getattr(LIB, "shade_bsdf_sample_batch" + call.ending)
    gather(status, function(_made(material), call.count, ctypes.byref(lanes), ctypes.byref(result)))
    return Drawn(made["wi"], made["f"], made["pdf"][()], made["cosine"][()])


def isa() -> str:
    """The instruction set that what is made now runs on: "avx512", "avx2", "sse2", "neon" or "scalar".

    >>> shade.isa() in ("avx512", "avx2", "sse2", "neon", "scalar")
    True
    """
    return text(LIB.shade_isa())
