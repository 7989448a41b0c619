# SPDX-License-Identifier: GPL-3.0-or-later
"""shade-render on saved scenes, and scenes as files without Blender."""

import importlib.util
import json
import os
import subprocess

import numpy as np

from blender_runs import read_picture
from native_scenes import MODULE, ROOT

TOOL = MODULE.parents[2] / "shade-render"
COMBINED = ("Combined", "RGBA", "", 1.0)

_SPEC = importlib.util.spec_from_file_location("scene_file", ROOT / "blender_addon_c/scene_file.py")
scene_file = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(scene_file)


def run(*words, seconds=60, tool=TOOL):
    """ASan gives no memory for what no machine has, as the C library does. What looks for leaks may fall over a thread that ends
    meanwhile, on a busy machine: a fault of its own, which is asked again."""
    given = {name: value for name, value in os.environ.items() if not name.startswith("LIBSHADE_")}
    given |= {"ASAN_OPTIONS": "allocator_may_return_null=1", "UBSAN_OPTIONS": "print_stacktrace=1"}
    for _again in range(2):
        done = subprocess.run([tool, *map(str, words)], env=given, capture_output=True, text=True, errors="replace", timeout=seconds)
        if "LeakSanitizer has encountered a fatal error" not in done.stderr:
            break
    return done


def made(folder, path, *words):
    """What it renders, {channel: rows from the top}."""
    picture = folder / "ours.exr"
    done = run(path, "-o", picture, *words)
    assert done.returncode == 0 and not done.stderr, done.stderr
    return channels(picture)


def channels(path):
    names, pixels = read_picture(path)
    return {name: np.ascontiguousarray(pixels[..., k]) for k, name in enumerate(names)}


def assert_same(found, expected):
    """To the last bit."""
    assert set(found) == set(expected)
    differ = [name for name in expected if found[name].tobytes() != expected[name].tobytes()]
    assert not differ, differ


def parts_of(path):
    """(header, arrays as they lie in the file)."""
    data = path.read_bytes()
    length = int.from_bytes(data[8:12], "little")
    header = json.loads(data[16:16 + length])
    return header, [np.frombuffer(data, one["type"], int(np.prod(one["shape"])), 16 + length + one["offset"]).copy() for one in header["arrays"]]


def put_parts(path, header, arrays):
    """The same as a file whose sums are right."""
    for one, array in zip(header["arrays"], arrays):
        one["checksum"] = scene_file.checksum(array)
    scene_file.put(path, json.dumps(header), arrays)
