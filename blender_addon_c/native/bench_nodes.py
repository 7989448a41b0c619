#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What images and graphs of nodes cost a vertex, without Blender.

usage: bench_nodes.py [--module FILE] [--other FILE] [--size 256] [--samples 64] [--repeat 11]

A plate from above, matt, its colour by what the table's first column says; one thread, seconds of samples over those
of a plate of one colour, in ns a vertex (least of the repetitions, by turns). --other: another build, by turns too.
    bytes, float     a look at a 2048 x 2048 sRGB image: points
    averaged ...     the same, by its pyramid (texture_blur .25), a pixel 8 texels wide
    30 nodes         4 images of bytes, mapped, mixed, multiplied, a ramp, numbers: as materials are; a pixel is
                     24 texels wide, so that looks wait for memory
    near             the same, a pixel 3 texels wide
    near, averaged   as they are looked up with the default texture_blur
"""

import argparse

import numpy as np

from bench import BUILT, load, plate


def registers(first, count):
    return [(first + k,) for k in range(count)]


UV, COLOR, OTHER, X = registers(3, 3), registers(6, 3), registers(9, 3), registers(12, 12)
_UV = {"type": "GEOMETRY", "what": "UV", "out": UV}


def math(operation, a, b, out, c=None):
    return {"type": "MATH", "operation": operation, "a": [a], "b": [b], "c": [c if c is not None else 0.0], "out": [out]}


def look(image=0, out=None, **more):
    return {"type": "IMAGE", "image": image, "out": out or COLOR, **more}


def thirty(scale=3.0, averaged=False):
    """30 nodes, of kinds and in numbers as in material libraries; 4 more tell what a pixel covers if images are
    averaged."""
    matrix, more = [scale, 0, 0, .1, 0, scale, 0, .2, 0, 0, 1, 0], {}
    turned = {"type": "TRANSFORM", "vector": UV, "matrix": matrix, "unit": False, "out": registers(24, 3)}
    at = registers(24, 2)
    ramp = np.linspace(0, 1, 256, dtype=np.float32)[:, None].repeat(4, 1)
    made = [_UV, turned]
    for k in range(2 if averaged else 0):
        further = [*UV[:k], (60,), *UV[k + 1:]]
        made += [math("ADD", UV[k], 0.125, (60,)), {**turned, "vector": further, "out": registers(54 + 3 * k, 3)}]
        more = {"averaged": True, "near": [(54,), (55,), (57,), (58,)], "step": 0.125}
    for k in range(4):
        made.append(look(k, registers(27 + 3 * k, 3), at=at, **more))
    for k in range(3):  # each channel of the second mixed into the first, then brightened
        made.append({"type": "MIX", "mode": "OVERLAY", "factor": [0.4], "a": [(27 + k,)], "b": [(30 + k,)], "out": [(39 + k,)]})
    made += [{"type": "RAMP", "table": ramp, "at": [(33,)], "smooth": True, "out": registers(42, 4)}]
    x = (42,)
    for k in range(16):
        operation = ("MULTIPLY", "ADD", "MULTIPLY_ADD", "MAXIMUM")[k % 4]
        made.append(math(operation, x, (0.9, 0.05, 0.8, 0.1)[k % 4], (46 + k % 2,), 0.1))
        x = (46 + k % 2,)
    made += [math("POWER", x, 1.5, (48,)), {"type": "HUE", "what": "HSV_TO_RGB", "color": registers(39, 3),
                                            "out": registers(49, 3)}]
    for k in range(2):
        made.append(math("MULTIPLY", (49 + k,), (48,), (52 + k,)))
    return made, [(52,), (53,), (51,)]


def cases():
    one = {"averaged": True}
    nodes, color = thirty()
    return {
        "plain": ([], [0.5] * 3, np.uint8, 0.0),
        "bytes": ([look()], COLOR, np.uint8, 0.0), "float": ([look()], COLOR, np.float32, 0.0),
        "averaged bytes": ([look(**one)], COLOR, np.uint8, 0.25),
        "averaged float": ([look(**one)], COLOR, np.float32, 0.25),
        f"{len(nodes)} nodes": (nodes, color, np.uint8, 0.0),
        "near": (*thirty(0.375), np.uint8, 0.0), "near, averaged": (*thirty(0.375, True), np.uint8, 0.25),
    }


def picture(kind, seed):
    made = np.random.default_rng(seed).integers(0, 256, (2048, 2048, 4)).astype(np.uint8)
    data = made if kind == np.uint8 else np.float32(made) / 255
    return {"width": 2048, "height": 2048, "channels": 4, "data": data, "srgb": True, "wrap": "REPEAT", "filter": "LINEAR"}


def scene_of(case, size, samples, images):
    nodes, color, kind, blur = case
    made = plate(size, samples, 1, 1, np.zeros((1, 1, 4), np.float32))
    used = {node["image"] for node in nodes if node["type"] == "IMAGE"}
    made["images"] = [images[kind, k] for k in range(max(used, default=-1) + 1)]
    made["texture_blur"] = blur
    made["materials"] = [{"name": "plate", "nodes": nodes, "closures": [
        {"closure": "DIFFUSE", "model": "LAMBERT", "color": color, "roughness": [0.0]}]}]
    return made


def seconds(native, scene):
    job = native.start(scene)
    native.wait(job, 1e9)
    state = native.poll(job)
    if state["state"] != "done":
        raise SystemExit(state["message"])
    times = native.timings(job)
    native.free(job)
    whole = ("wall", "image", "mesh", "bvh", "samples")
    return sum(time for stage, time in times.items() if stage not in whole), times["samples"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--module", default=BUILT)
    parser.add_argument("--other")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--repeat", type=int, default=11)
    options = parser.parse_args()
    modules = [load(path) for path in (options.module, options.other) if path]
    images = {(kind, k): picture(kind, k) for kind in (np.uint8, np.float32) for k in range(4)}
    least = {}
    for _ in range(options.repeat):
        for name, case in cases().items():
            scene = scene_of(case, options.size, options.samples, images)
            for number, native in enumerate(modules):
                spent, samples = seconds(native, scene)
                key = name, number
                least[key] = min(least.get(key, 1e9), 1e9 * spent / samples)
    for name in cases():
        more = [least[name, k] - least["plain", k] for k in range(len(modules))]
        print(f"{name:16s}" + "".join(f"{m:8.2f} ns" for m in more))


if __name__ == "__main__":
    main()
