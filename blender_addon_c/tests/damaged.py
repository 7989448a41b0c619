# SPDX-License-Identifier: GPL-3.0-or-later
"""Saved scenes, damaged by chance: each is refused with a message, or it is another scene that renders.

    build/venv/bin/python blender_addon_c/tests/damaged.py [--seeds 5000] [--first 0] [--tool build/sanitized/shade-render]
"""

import argparse
import concurrent.futures
import copy
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np

from native_scenes import area, image, material, persp, point, registers, scene, sky, sphere, spot, square
from shade_render import COMBINED, TOOL, channels, parts_of, put_parts, run, scene_file

VALUES = (None, True, False, -1, 0, 1, 2, 0.5, -0.0, 1e-300, 1e30, -1e300, 2**31, 2**32, 2**53, 65536, "", "METAL", "é" * 300, [], [0], [127],
          [1, 2, 3], {}, {"array": 0}, {"array": -1}, {"array": 1e9}, [[[[]]]])
WHOLE = (0, 1, 255, 2**31 - 1)
NUMBERS = (0.0, -1.0, 1e-40, 1e38, np.inf, -np.inf, np.nan)


def whole_scenes():
    """Between them most of what a file may have."""
    rng = np.random.default_rng(1)
    planes = "DEPTH", "NORMAL", "VECTOR", "DIFFUSE_DIRECT", "GLOSSY_INDIRECT", "SAMPLES"
    grey = image(rng.integers(0, 256, (8, 8, 3), np.uint8), srgb=True)
    places = np.repeat(np.eye(4, dtype=np.float32)[None, :3], 2, 0)
    places[1, 0, 3] = 0.3
    lit = scene(width=8, height=8, samples=2, max_bounces=3, camera=persp(), transparent=False,
                images=[grey, image(rng.random((4, 8, 3), np.float32))], materials=[material(0, 0)], lights=[area((0, 0, 3)), point((1, 1, 2), radius=0.1), spot((0, 1, 3), angle=1.2)],
                sky=sky(index=1), meshes=[sphere(6), square(2.0, -0.5)], planes=[{"type": p} for p in planes], adaptive_threshold=0.1,
                mattes=[{"type": "OBJECT"}], matte_slots=2, adaptive_min_samples=1)
    lit["instances"][0]["motion"] = places
    place, cover = registers(3, 4), registers(7, 1)
    cloth = {"name": "cloth", "closure": "FABRIC", "coverage": cover, "cloth": 0, "place": place, "nodes": [
        {"type": "WEAVE", "cloth": 0, "out": place}, {"type": "CLOTH", "cloth": 0, "place": place, "out": cover}]}
    matt = {"name": "matt", "nodes": [], "closures": [{"closure": "DIFFUSE", "model": "LAMBERT", "color": [0.5] * 3, "roughness": [0.0],
                                                       "weight": [0.5] * 3}, {"closure": "TRANSPARENT", "weight": [0.5] * 3}]}
    woven = scene(width=8, height=8, samples=2, max_bounces=2, materials=[cloth, matt], meshes=[square(), square(0.5, 0.5, 1)],
                  cloths=[{"preset": "denim", "size": 0.02, "transmit": 0.1, "open": False}])
    more = [("Depth", "Z", "DEPTH", 1.0), ("Normal", "XYZ", "NORMAL", 1.0), ("Vector", "XYZW", "VECTOR", 1.0),
            ("Crypto", "rgba", "OBJECT_MATTE00", 1.0)]
    return [[(lit, [COMBINED, *more])], [(woven, [COMBINED])], [(woven, [COMBINED]), (woven, [("AO", "RGB", "", 2.0)])]]


def places_in(value, found):
    """(container, key) of everything in JSON."""
    for key in (value if isinstance(value, dict) else range(len(value))):
        found.append((value, key))
        if isinstance(value[key], (dict, list)):
            places_in(value[key], found)
    return found


def other_scene(path, header, arrays, chance):
    """A file whose sums are right, of which some values are others."""
    header, arrays = copy.deepcopy(header), [array.copy() for array in arrays]
    for _ in range(chance.choice((1, 1, 2, 5))):
        pictures = header.get("pictures")
        there = places_in(pictures if pictures and isinstance(pictures, list) and chance.random() < 0.9 else header, [])
        holder, key = chance.choice(there)
        what = chance.random()
        if what < 0.2 and arrays:
            array = chance.choice(arrays)
            for _ in range(chance.choice((1, array.size))) if array.size else ():
                number = chance.choice(NUMBERS if array.dtype.kind == "f" else WHOLE)
                array[chance.randrange(array.size)] = number if array.dtype.kind == "f" else number % (np.iinfo(array.dtype).max + 1)
        elif what < 0.35 and isinstance(holder, dict):
            del holder[key]
        elif what < 0.5:
            other = chance.choice(there)
            holder[key] = copy.deepcopy(other[0][other[1]])
        elif what < 0.6 and isinstance(holder, list):
            holder.insert(key, copy.deepcopy(holder[key]))
        elif what < 0.7 and isinstance(holder[key], (int, float)):
            holder[key] = holder[key] * chance.choice((-1, 0.5, 2, 1e6))
        else:
            holder[key] = copy.deepcopy(chance.choice(VALUES))
    if not isinstance(header.get("arrays"), list) or not all(isinstance(one, dict) for one in header["arrays"]):
        header["arrays"] = []
    put_parts(path, header, arrays)


def other_bytes(path, data, chance):
    """What a disk or a line makes of it."""
    data = bytearray(data)
    at = chance.randrange(len(data))
    what = chance.randrange(4)
    if what == 0:
        data[at] ^= 1 << chance.randrange(8)
    elif what == 1:
        del data[at:]
    elif what == 2:
        del data[at:at + chance.randrange(1, 200)]
    else:
        data[at:at] = chance.randbytes(chance.randrange(1, 200))
    path.write_bytes(data)


def whole_files(folder):
    files = []
    for k, pictures in enumerate(whole_scenes()):
        path = pathlib.Path(folder) / f"whole-{k}.shscene"
        scene_file.write(path, "L", pictures, [("cryptomatte/0123456/name", "CryptoObject")] * (k == 0))
        files.append((path.read_bytes(), *parts_of(path)))
        path.unlink()
    return files


def wrong_with(files, folder, seed, tool=TOOL):
    """What is wrong with how one damaged file ends, or ""."""
    chance = random.Random(seed)
    data, header, arrays = chance.choice(files)
    path, picture = folder / f"{seed}.shscene", folder / f"{seed}.exr"
    raw = chance.random() < 0.2
    other_bytes(path, data, chance) if raw else other_scene(path, header, arrays, chance)
    try:
        done = run(path, "-o", picture, "--samples", 1, "--threads", 1, seconds=120, tool=tool)
    except subprocess.TimeoutExpired:
        return "hangs"
    same = raw and path.read_bytes() == data
    said = done.stderr.strip()
    there = picture.exists()
    if there != (done.returncode == 0):
        return f"status {done.returncode}, picture: {there}"
    if done.returncode not in (0, 1) or "ERROR" in said or "runtime error" in said:
        return f"status {done.returncode}: {said[-3000:]}"
    if done.returncode == 1 and (len(said.splitlines()) < 1 or not said.splitlines()[-1].startswith(f"shade-render: {path}: ")):
        return f"refused without a reason: {said}"
    if done.returncode == 0 and raw and not same:
        return "rendered in silence"
    if there and not all(np.isfinite(pixels).all() for name, pixels in channels(picture).items() if ".Combined." in name):
        return "pixels that are no numbers"
    path.unlink()
    picture.unlink(missing_ok=True)
    return ""


def main():
    words = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    words.add_argument("--seeds", type=int, default=5000)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--tool", type=pathlib.Path, default=TOOL)
    words.add_argument("--corpus", type=pathlib.Path, help="write whole scenes there as fuzz_scene.c takes them, and end")
    given = words.parse_args()
    if given.corpus:
        for k, (_data, header, arrays) in enumerate(whole_files(given.corpus)):
            text, room = json.dumps(header).encode(), [array.tobytes() for array in arrays]
            (given.corpus / f"whole-{k}").write_bytes(text + b"\0" + b"".join(data + bytes(-len(data) % 64) for data in room))
        return
    folder = pathlib.Path(tempfile.mkdtemp(prefix="damaged-"))
    files, failed = whole_files(folder), 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        seeds = range(given.first, given.first + given.seeds)
        for seed, wrong in zip(seeds, pool.map(lambda seed: wrong_with(files, folder, seed, given.tool), seeds)):
            if wrong:
                failed += 1
                print(f"seed {seed}, {folder / str(seed)}.shscene: {wrong}", flush=True)
    print(f"{given.seeds} damaged files: {failed} end badly")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
