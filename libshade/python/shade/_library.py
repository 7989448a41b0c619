# SPDX-License-Identifier: Apache-2.0
"""The shared library: where it is, and the types of the functions that this module calls."""
import ctypes
import difflib
import os
import pathlib
from typing import Any

from . import _structs as structs

# a line a function: what it returns, its name, its parameters. p pointer, s text, n size_t, i int or
# enum, u unsigned, d double, v nothing. test_python.py holds them to the headers.
PROTOTYPES = """
v shade_params_init p
u shade_params_set_roughness pidd
u shade_params_set_choice pii
i shade_params_get_choice pi
u shade_params_set pip
u shade_params_get pip
u shade_params_set_slopes pp
u shade_params_get_slopes pp
i shade_params_set_metal ps
i shade_params_json pispn
i shade_roughness_row ipppp
i shade_metal_row ip
i shade_list_find is
s shade_list_word ii
i shade_list_row iipppp
s shade_list_name i
i shade_list_about ip
i shade_list_default ii
i shade_param_row ip
u shade_bsdf_setup pp
u shade_bsdf_eval_batch pnpp
u shade_bsdf_eval_batchf pnpp
u shade_bsdf_pdf_batch pnpp
u shade_bsdf_pdf_batchf pnpp
u shade_bsdf_sample_batch pnpp
u shade_bsdf_sample_batchf pnpp
u shade_mdf_eval_batch pnppppppp
u shade_mdf_eval_batchf pnppppppp
s shade_isa
i shade_isa_check pn
i shade_preset_row ip
i shade_preset_find sp
p shade_draft_named s
p shade_draft_from_pattern iii
p shade_draft_from_matrix iip
p shade_wif_read spn
v shade_draft_free p
i shade_weave_row ippp
v shade_weave_params_init p
i shade_yarn_param_row ip
p shade_yarn_param ps
i shade_occlusion_row ipppp
p shade_weave_create ppp
v shade_weave_free p
u shade_weave_lookup_batch pnppp
u shade_weave_lookup_batchf pnppp
v shade_fabric_params_init p
p shade_fabric_yarn_number pip
p shade_fabric_number pip
p shade_fabric_create ppp
v shade_fabric_free p
u shade_fabric_eval_batch pnpip
u shade_fabric_eval_batchf pnpip
u shade_fabric_pdf_batch pnpip
u shade_fabric_pdf_batchf pnpip
u shade_fabric_sample_batch pnpip
u shade_fabric_sample_batchf pnpip
u shade_fabric_albedo_towards ppp
v shade_fabric_get_info pp
v shade_slope_options_init p
p shade_slope_map_create piiipp
v shade_slope_map_free p
u shade_slope_lookup pddpp
u shade_params_split pppippp
p shade_relief_create npppppi
v shade_relief_free p
d shade_relief_whole pp
v shade_relief_lookup_batchf pnppp
v shade_scratch_params_init p
p shade_scratch_create pp
v shade_scratch_free p
u shade_scratch_eval pddppp
v shade_scratch_rows piiiiipp
"""
KINDS = {"p": ctypes.c_void_p, "s": ctypes.c_char_p, "n": ctypes.c_size_t, "i": ctypes.c_int,
         "u": ctypes.c_uint, "d": ctypes.c_double, "v": None}

HERE = pathlib.Path(__file__).resolve().parent


def found():
    """The library's file: LIBSHADE_LIBRARY; that of the same `make install`; that of the tree's build folder."""
    named = os.environ.get("LIBSHADE_LIBRARY")
    if named:
        if not os.path.isfile(named):
            raise ImportError(f"LIBSHADE_LIBRARY={named}: no such file; it names libshade.so.VERSION")
        return named
    installed = HERE / "library.txt"  # written by `make install`: the way from here to it
    if installed.is_file():
        path = HERE / installed.read_text(encoding="utf-8").strip()
        if not path.is_file():
            raise ImportError(f"{path}: no such file; LIBSHADE_LIBRARY may name another libshade.so.VERSION")
        return str(path)
    build = HERE.parents[2] / "build"
    built = sorted(build.glob("libshade.so.*"), key=lambda path: path.stat().st_mtime)
    if not built:
        raise ImportError(f"no libshade.so.VERSION in {build}: run make, or name one in LIBSHADE_LIBRARY")
    return str(built[-1])


def load(path):
    library = ctypes.CDLL(path)
    for line in PROTOTYPES.split("\n"):
        if line:
            returns, name, *parameters = line.split()
            try:
                function = getattr(library, name)
            except AttributeError:
                raise ImportError(f"{path} has no {name}: it is of another version than this module") from None
            function.restype = KINDS[returns]
            function.argtypes = [KINDS[kind] for kind in "".join(parameters)]
    return library


PATH = found()
LIB = load(PATH)

_room = (ctypes.c_double * 1024)()
LIB.shade_params_init(_room)
PARAMS_SIZE = structs.ParamsHead.from_buffer(_room).size


def _defaults_at():
    """Where the version of the defaults is: behind the horizon."""
    info, horizon = structs.ListInfo(), 0
    while LIB.shade_list_name(horizon) != b"horizon":
        horizon += 1
    LIB.shade_list_about(horizon, ctypes.byref(info))
    step = ctypes.sizeof(ctypes.c_size_t)
    return (info.offset + ctypes.sizeof(ctypes.c_int) + step - 1) // step * step


DEFAULTS_AT = _defaults_at()
DEFAULTS = ctypes.c_size_t.from_buffer(_room, DEFAULTS_AT).value
Preset = structs.preset(PARAMS_SIZE)


def _fits():
    """What a preset holds is where this module looks for it."""
    buffer = (ctypes.c_double * 8192)()
    LIB.shade_preset_row(0, buffer)
    preset = Preset.from_buffer(buffer)
    return (preset.yarns.size == ctypes.sizeof(structs.WeaveParams)
            and preset.fabric.size == ctypes.sizeof(structs.FabricParams)
            and preset.scratches.size == ctypes.sizeof(structs.ScratchParams))


if not _fits():
    raise ImportError(f"{PATH}: its structures are not those of this module: it is of another version")


def text(value):
    return value.decode() if value is not None else None


def rows(function, structure):
    """What a function of (row, structure) gives for row 0, 1, … until it returns 0."""
    listed = []
    while True:
        row = structure()
        if not function(len(listed), ctypes.byref(row)):
            return listed
        listed.append(row)


def words(function, *before):
    """{word: (value, label, help)} of a function of (…, row, value, word, label, help)."""
    listed = {}
    value = ctypes.c_int()
    word, label, help_ = (ctypes.c_char_p() for _ in range(3))
    while function(*before, len(listed), *map(ctypes.byref, (value, word, label, help_))):
        listed[text(word.value)] = (value.value, text(label.value), text(help_.value))
    return listed


def plain(word):
    """A name as all names are read: - and _ alike, without regard to case."""
    return str(word).strip().lower().replace("-", "_")


class Fixed:
    """What is made once: to set an attribute of it, which nothing would read, is an error that says what to do."""

    CHANGED = "make another"

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_"):
            near = difflib.get_close_matches(name, (word for word in dir(self) if not word.startswith("_")), 1)
            meant = near[0] if near else name
            raise AttributeError(f"{name}: a {type(self).__name__} never changes; "
                                 + (f"did you mean {meant}? " if near and meant != name else "")
                                 + self.CHANGED.format(f"{meant}={value!r:.40}"))
        super().__setattr__(name, value)


def truth(name, value):
    """A switch: what is neither on nor off, such as the word "off", is no yes."""
    if value not in (True, False):
        raise ValueError(f"{name}: {value!r} given; expected True or False")
    return bool(value)


def one_of(name, word, listed):
    """The value of `word` in {word: (value, …)}; an error names both and the list."""
    if isinstance(word, str) and plain(word) in listed:
        return listed[plain(word)][0]
    raise ValueError(f"{name}: {word!r} given; expected one of {', '.join(listed)}")
