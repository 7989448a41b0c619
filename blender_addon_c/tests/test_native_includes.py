# SPDX-License-Identifier: GPL-3.0-or-later
"""Which files may include which. Natively includes point down one order of folders, in the library and from its users
too, and no files (a .c and its .h are one) include each other in a circle. Notices a header that reaches up, such as
scene/scene.h that would know closures, and two files that need each other, such as a worker that lives with the
bounces. Costs 0.3 s; needs nothing that is built."""

import re
from pathlib import Path

import pytest

COST = 0.1

ROOT = Path(__file__).resolve().parents[2]
NATIVE = "blender_addon_c/native/"

# From the bottom; node and light stand side by side and do not know each other.
ORDER = [["system"], ["batch"], ["scene"], ["node", "light"], ["closure"], ["stage"], ["isa"], ["render"], ["python"]]

# What each may include beside itself. Tests and benches may include all; the public headers nothing.
PUBLIC = {"libshade/include"}
NUMBERS = PUBLIC | {"libshade/data"}
MODEL = NUMBERS | {"libshade/model"}
BATCH = MODEL | {"libshade/batch"}
SOURCE = BATCH | {"libshade/src"}
DOORS = PUBLIC | {"libshade/dump"}
PORT = {"libshade/port"}
MAY = {
    "libshade/include": set(),
    "libshade/data": set(),
    "libshade/model": NUMBERS,
    "libshade/batch": MODEL,
    "libshade/port": set(),
    "libshade/src": BATCH | PORT,
    "libshade/reference": NUMBERS,
    "libshade/dump": SOURCE | PORT,
    "libshade/image": DOORS | PORT,
    "libshade/tool": SOURCE | DOORS | PORT | {"libshade/image", "libshade/reference"},
    "libshade/fuzz": PUBLIC | {"libshade/tool"},
    "blender_addon_c/native": DOORS | PORT,
    "blender_addon_c/tool": DOORS | PORT | {"blender_addon_c/native", "libshade/image", "libshade/tool"},
    "povray_patches/glue": DOORS,
    "compare": DOORS,
    "examples": DOORS,
    "farm": DOORS,
}
# The doors to the system, and the folders where nothing else asks which system it is, or for a header that C11 lacks;
# with those of other libraries that a folder reads files by
PORTABLE = {
    **{f"libshade/{name}/": () for name in "batch data fuzz include model reference src tool".split()},
    **{f"{NATIVE}{name}/": () for name in "batch closure isa light node render stage".split()},
    NATIVE + "scene/": ("embree3/rtcore.h", "embree4/rtcore.h"),
    NATIVE + "python/": ("Python.h",),
    "blender_addon_c/tool/": ("getopt.h", "zlib.h"),
    "libshade/dump/": ("openexr.h",),
    "libshade/image/": ("openexr.h", "png.h"),
}
STANDARD = {
    f"{name}.h"
    for name in "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic stdbool stddef "
    "stdint stdio stdlib stdnoreturn string tgmath time uchar wchar wctype".split()
}
ASKED = re.compile(
    r"\b(_WIN(?:32|64)|_MSC_VER|__MINGW\w*|__(?:linux|unix|APPLE|FreeBSD|CYGWIN)__|_(?:POSIX_C|XOPEN|GNU|DEFAULT|BSD)_SOURCE)\b"
)
# where an include is looked for, beside the folder of the file that has it
PATHS = ("libshade", "libshade/include", "blender_addon_c/native", "povray_patches/glue")


def sources():
    """By path from the root: the files of the project that it includes."""
    files = {
        str(f.relative_to(ROOT)): f.read_text(errors="replace")
        for top in ("libshade", "blender_addon_c", "povray_patches", "compare", "examples", "farm")
        for f in (ROOT / top).rglob("*")
        if f.suffix in (".c", ".h", ".cpp")
    }
    found = {}
    for name, text in files.items():
        found[name] = []
        for wanted in re.findall(r'^\s*#\s*include\s*"([^"]+)"', text, re.M):
            for folder in (str(Path(name).parent), *PATHS):
                path = str((ROOT / folder / wanted).resolve())[len(str(ROOT)) + 1 :]
                if path in files:
                    found[name].append(path)
                    break
    return found


INCLUDES = sources()


def part_of(name):
    parts = name.split("/")
    return "/".join(parts[:2]) if "/".join(parts[:2]) in MAY else parts[0]


def upward(includes):
    """Includes among native folders that do not point down."""
    rank = {folder: k for k, row in enumerate(ORDER) for folder in row}
    wrong = []
    for name, targets in includes.items():
        for target in targets:
            if name.startswith(NATIVE) and target.startswith(NATIVE):
                above, below = (path[len(NATIVE) :].split("/")[0] for path in (name, target))
                if above != below and rank[above] <= rank[below]:
                    wrong.append(f"{name} includes {target}")
    return wrong


def trespasses(includes):
    """Includes between parts of the project that MAY does not have."""
    wrong = []
    for name, targets in includes.items():
        own = part_of(name)
        for target in targets:
            if own in MAY and part_of(target) != own and part_of(target) not in MAY[own]:
                wrong.append(f"{name} includes {target}")
    return wrong


def circles(includes):
    """Sets of files that include each other, a .c and its .h as one: Tarjan's strong components."""
    graph = {}
    for name, targets in includes.items():
        stem = str(Path(name).with_suffix(""))
        graph.setdefault(stem, set()).update(str(Path(t).with_suffix("")) for t in targets)
        graph[stem].discard(stem)
    number, low, stack, found = {}, {}, [], []

    def visit(stem):
        number[stem] = low[stem] = len(number)
        stack.append(stem)
        for other in sorted(graph.get(stem, ())):
            if other not in number:
                visit(other)
            if other in stack:
                low[stem] = min(low[stem], low[other])
        if low[stem] == number[stem]:
            circle = stack[stack.index(stem) :]
            del stack[stack.index(stem) :]
            if len(circle) > 1:
                found.append(sorted(circle))

    for stem in sorted(graph):
        if stem not in number:
            visit(stem)
    return found


def test_includes_point_down():
    assert len([name for name in INCLUDES if name.startswith(NATIVE)]) > 150
    assert not upward(INCLUDES)


def test_parts_enter_by_their_doors():
    assert sum(map(len, INCLUDES.values())) > 500
    assert not trespasses(INCLUDES)


def of_the_system(name, text):
    """What a file knows of the system that it runs on."""
    others = next((others for folder, others in PORTABLE.items() if name.startswith(folder)), None)
    if others is None or not name.endswith((".c", ".h")):
        return []
    headers = re.findall(r"^\s*#\s*include\s*<([^>]+)>", text, re.M)
    return [h for h in headers if h not in STANDARD and h not in others] + ASKED.findall(text)


@pytest.mark.parametrize("line", ["#ifdef _WIN32", "#define _GNU_SOURCE /* sched_getaffinity */", "#include <unistd.h>", "# if defined(__APPLE__)"])
def test_one_door_to_the_system(line):
    asked = {name: of_the_system(name, (ROOT / name).read_text(encoding="utf-8")) for name in INCLUDES}
    assert not {name: found for name, found in asked.items() if found}
    for folder in PORTABLE:
        assert any(name.startswith(folder) for name in INCLUDES)
        assert len(of_the_system(folder + "a.c", f"#include <math.h>\n{line}\n")) == 1


def test_no_circles():
    assert not circles({name: to for name, to in INCLUDES.items() if name.startswith(NATIVE)})


@pytest.mark.parametrize(
    "name, target, finds",
    [
        (NATIVE + "scene/scene.h", NATIVE + "closure/closure.h", upward),
        (NATIVE + "light/area.h", NATIVE + "node/common.h", upward),
        ("libshade/src/dispatch.c", "libshade/reference/reference.h", trespasses),
        (NATIVE + "node/cloth.h", "libshade/batch/isa.h", trespasses),
        (NATIVE + "render/worker.h", NATIVE + "render/through.h", circles),
        (NATIVE + "scene/emitters.c", NATIVE + "scene/scene.h", circles),
    ],
)
def test_notices(name, target, finds):
    """Each of them, and nothing else, where one include is added."""
    assert name in INCLUDES and target in INCLUDES
    assert len(finds(INCLUDES | {name: INCLUDES[name] + [target]})) == len(finds(INCLUDES)) + 1
