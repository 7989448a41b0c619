#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Which tests of `make check` reach a file: by what they include, import and start, as texts say it, cheapest first.

    setup/reach.py FILE …     as lines of setup/mutants.txt
"""
import functools
import os
import re
import subprocess
import sys
from pathlib import Path

import costs

ROOT = Path(__file__).resolve().parent.parent
# Where includes begin, and packages of Python.
INCLUDES = ("", "libshade/", "libshade/include/", "blender_addon_c/native/", "blender_addon_c/", "povray_patches/")
PACKAGES = ("", "compare/", "compare/tests/", "libshade/python/", "libshade/test/", "blender_addon_c/tests/", "blender_addon_c/tests/inside/",
            "setup/", "povray_patches/tests/", "farm/", "farm/tests/")
# What stands behind a header, where that is no file of its name.
BEHIND = (("libshade/include/shade/", r"libshade/src/.*\.c$"), ("libshade/reference/reference.h", r"libshade/reference/.*\.c$"),
          ("libshade/image/", r"libshade/image/.*\.(c|cpp)$"), ("libshade/dump/", r"libshade/dump/.*\.c$"))
# What a text names that is no include: what is built of those files.
BUILT = ((r"build/shade\b|BUILD / .shade.|\bSHADE\b", r"libshade/tool/[^/]*\.c$"),
         (r"native_scenes|_native\b", r"blender_addon_c/native/(python|render|scene|isa|system)/[^/]*\.c$"),
         (r"\bblender(_old|_new|52)?\b|common\.MODULE", r"blender_addon_c/((?!tests|tool)[^.]*\.py|native/(python|render|scene|isa|system)/[^/]*\.c)$"),
         (r"shade[-_]render\b", r"blender_addon_c/tool/[^/]*\.c$"),
         (r"(?i)\bpovray\b", r"povray_patches/(glue|editor)/|povray_patches/series$"),
         (r"libshade\.so|\bimport shade\b", r"libshade/src/[^/]*\.c$"), (r"BUILD / .horizon.", r"compare/horizon\.c$"),
         (r'ROOT / "farm"', r"farm/(?!tests/).*\.py$"), (r"\bdisplacement\b", r"compare/displaced/.*\.c$"), (r"\bsteep_bumps\b", r"compare/bumps/.*\.c$"),
         (r"\breport_page\b", r"compare/(study_\w+\.py|plain\.c)$"), (r"\bmake(_scene|\b.*-C\b)|[\"']make[\"']", r"(Makefile|.*\.mk)$"),
         (r"make_scene|\bexamples/blender\b", r"examples/blender/.*\.py$"), (r"\bpip\b", r"libshade/python/setup\.py$"),
         (r"programs\.HERE / .bumps", r"compare/((displaced/surface|bumps/field)\.[ch]|horizon\.c)$"))
# What no text names, and which stands for it: POV-Ray's own files, as the patches leave them, and what lies beside them.
STANDS_FOR = ((r"build/povray/src/|povray_patches/(.*\.patch$|include/|build\.sh$)", "povray_patches/series"),)


@functools.cache
def files():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\n")
    return frozenset(name for name in listed if re.search(r"\.(c|h|cpp|py|sh|mk)$|^Makefile$|/series$", name))


def _there(name):
    return {os.path.normpath(name)} & files()


@functools.cache
def needs(file):
    """Files that one names."""
    text = (ROOT / file).read_text(encoding="utf-8")
    folder = file.rpartition("/")[0] + "/"
    found = set()
    if file.endswith(".py"):
        for dots, module, names in re.findall(r"^ *from (\.*)([\w.]*) import \(?([\w, ]*)", text, re.M):
            places = [folder if len(dots) == 1 else folder.rstrip("/").rpartition("/")[0] + "/"] if dots else (folder, *PACKAGES)
            own = _there(f"{folder}{module}.py")  # each folder of tests has its conftest
            for place in places[:1] if own and not dots else places:
                path = place + module.replace(".", "/")
                found |= _there(f"{path}.py") | _there(f"{path}/__init__.py")
                for name in re.split(r"[, ]+", names):
                    found |= _there(f"{path.rstrip('/')}/{name}.py") | _there(f"{path.rstrip('/')}/{name}/__init__.py")
        for names in re.findall(r"^ *import ([\w., ]+)", text, re.M):
            for name in re.split(r"[, ]+", names):
                for place in (folder, *PACKAGES):
                    path = place + name.replace(".", "/")
                    found |= _there(f"{path}.py") | _there(f"{path}/__init__.py")
        for names in re.findall(r"fake_blender\.imported\(([^)]*)\)|\bread\((\"\w+\")\)", text):  # scripts of Blender's or Mitsuba's, read without them
            found |= {there for name in re.findall(r"\w+", " ".join(names)) for there in _there(f"compare/{name}.py")}
        for name in re.findall(r"[\"']([\w/-]+\.(?:py|sh|mk))[\"']", text):  # scripts that are started
            for place in (folder, f"{folder}inside/", "", "setup/", folder.rstrip("/").rpartition("/")[0] + "/"):
                found |= _there(place + name)
        if ".scene(" in text:
            found |= _there(f"{folder}inside/scenes.py")
    else:
        for name in re.findall(r"^ *# *include [\"<]([\w/.+-]+)[\">]", text, re.M):
            for place in (folder, *INCLUDES):
                found |= _there(place + name)
        for header in [name for name in found if name.endswith(".h")]:  # what it declares
            found |= _there(header[:-1] + "c") | _there(header[:-1] + "cpp")
            found |= {name for start, behind in BEHIND if header.startswith(start) for name in files() if re.match(behind, name)}
    if "/test" in file:
        for word, built in BUILT:
            if re.search(word, text):
                found |= {name for name in files() if re.match(built, name)}
    return frozenset(found - {file})


def reached(file):
    """All files that one reaches, itself too."""
    seen, left = {file}, [file]
    while left:
        for other in needs(left.pop()):
            if other not in seen:
                seen.add(other)
                left.append(other)
    return seen


def tests(file):
    """Lines of setup/mutants.txt: the tests that reach a file, cheapest first."""
    file = next((other for kind, other in STANDS_FOR if re.match(kind, file)), file)
    found = sorted((test for test in costs.files() if file in reached(test)), key=costs.cost)
    lines = []
    for test in found:
        if test.endswith(".c"):
            if test.startswith("libshade/"):
                lines.append("c " + Path(test).stem.removeprefix("test_"))
        else:
            kind = {"blender_addon_c": "blender", "povray_patches": "povray"}.get(test.split("/")[0], "py")
            lines.append(f"{kind} {test}")
    return lines


def main():
    for file in sys.argv[1:]:
        print(file)
        for line in tests(file):
            print(f"$ {line}")


if __name__ == "__main__":
    main()
