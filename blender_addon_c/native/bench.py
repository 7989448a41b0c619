#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time the native module on the bumped plate, stage by stage, without Blender.

usage: bench.py [--module FILE] [--size 512] [--samples 64] [--threads 0] [--repeat 5] [--mesh N]

The plate: one quad, a 2048 x 2048 float normal map of sinusoidal bumps of slope .6, one sun,
orthographic, rotate, exponents 6170.84 and 7.876543. With --mesh N the flat quad is cut into 2 N^2
triangles. Prints the fastest of the repetitions, each part for itself: ns per sample and thread
for the stages, then seconds. `wall` is all of a job: packing the image, tangents, BVH and picture;
`cpu` the same as processor time of all threads, which other programs disturb less.
"""

import argparse
import importlib.util
import os
import subprocess
import time

import numpy as np

WHOLE = ("wall", "cpu", "image", "mesh", "bvh", "samples")  # all other times are of stages
HERE = os.path.dirname(os.path.abspath(__file__))
BUILT = os.path.join(HERE, "../../build/blender/native/_native.abi3.so")


def load(path):
    spec = importlib.util.spec_from_file_location("_native", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def bumps(size=2048, waves=8, slope=0.6):
    """Tangent-space normal map of a height field of crossed sines, RGBA float32."""
    t = np.arange(size) + 0.5
    p = slope * np.cos(2 * np.pi * waves * t / size)
    n = np.empty((size, size, 3))
    n[..., 0] = -p[None, :]
    n[..., 1] = -p[:, None]
    n[..., 2] = 1
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    image = np.ones((size, size, 4), np.float32)
    image[..., :3] = 0.5 + 0.5 * n
    return image


def grid(cuts):
    """The square [-1, 1]^2 as 2 cuts^2 triangles."""
    t = np.linspace(-1, 1, cuts + 1)
    x, y = np.meshgrid(t, t)
    positions = np.stack([x, y, np.zeros_like(x)], -1).reshape(-1, 3).astype(np.float32)
    i = np.arange(cuts * (cuts + 1)).reshape(cuts, cuts + 1)[:, :-1].reshape(-1, 1)
    corners = (i + np.array([0, 1, cuts + 2, 0, cuts + 2, cuts + 1])).reshape(-1).astype(np.int32)
    return {
        "positions": positions,
        "corner_position": corners,
        "corner_normals": np.tile(np.float32([0, 0, 1]), (len(corners), 1)),
        "corner_uvs": (0.5 + 0.5 * positions[corners, :2]).astype(np.float32),
        "material": np.zeros(len(corners) // 3, np.int32),
    }


def plate(size=512, samples=64, threads=0, cuts=1, image=None):
    eye = np.eye(4)
    eye[2, 3] = 3
    return {
        "width": size,
        "height": size,
        "region": (0, 0, size, size),
        "samples": samples,
        "seed": 0,
        "threads": threads,
        "transparent": True,
        "background": (0, 0, 0),
        "camera": {
            "type": "ORTHO",
            "matrix": eye.ravel().tolist(),
            "frame": (-1, 1, -1, 1),
            "clip": (0.1, 100),
        },
        "lights": [
            {
                "name": "sun",
                "type": "SUN",
                "irradiance": (1, 1, 1),
                "direction": (0.3, 0.2, 0.9327379),
                "angle": 0,
                "shadow": True,
            }
        ],
        "images": [
            {
                "width": image.shape[1],
                "height": image.shape[0],
                "channels": 4,
                "data": image,
                "srgb": False,
                "wrap": "REPEAT",
                "filter": "LINEAR",
            }
        ],
        "materials": [
            {
                "name": "steel",
                "closure": "METAL",
                "mdf": "ASHIKHMIN_SHIRLEY",
                "brdf": "ASHIKHMIN_SHIRLEY",
                "detail": "ROTATE",
                "groove": "AUTO",
                "fresnel": "SCHLICK",
                "ex": 6170.84,
                "ey": 7.876543,
                "ax": 0.018,
                "ay": 0.45,
                "f0": (1, 1, 1),
                "f82": (1, 1, 1),
                "eta": (0.5, 0.5, 0.5),
                "k": (3, 3, 3),
                "diffuse": "LAMBERT",
                "kd": (0, 0, 0),
                "nodes": [
                    {"type": "NORMAL_MAP", "image": 0, "strength": 1, "out": [(3,), (4,), (5,)]}
                ],
                "normal": [(3,), (4,), (5,)],
            }
        ],
        "meshes": [grid(cuts)],
        "instances": [{"mesh": 0, "matrix": np.eye(4).ravel().tolist()}],
        "dump": "",
        "renderer": "bench",
    }


def machine():
    with open("/proc/cpuinfo") as info:
        lines = [line.split(":", 1) for line in info if ":" in line]
    about = {key.strip(): value.strip() for key, value in lines}
    model = "{} family {} model {}".format(
        about.get("model name"), about.get("cpu family"), about.get("model")
    )
    compiler = subprocess.run(
        [os.environ.get("CC", "cc"), "--version"], capture_output=True, text=True
    ).stdout.split("\n")[0]
    return model, len(os.sched_getaffinity(0)), compiler


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--module", default=BUILT)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--mesh", type=int, default=1, help="cuts of the plate along each side")
    args = parser.parse_args()
    native = load(args.module)
    model, cores, compiler = machine()
    threads = args.threads or cores
    scene = plate(args.size, args.samples, args.threads, args.mesh, bumps())
    best = None
    for _ in range(args.repeat):
        before = time.process_time()
        job = native.start(scene)
        native.wait(job, 1e9)
        cpu = time.process_time() - before
        state = native.poll(job)
        if state["state"] != "done":
            raise SystemExit(state["message"])
        times = native.timings(job) | {"cpu": cpu}
        native.free(job)
        best = {k: min(v, best[k]) if best else v for k, v in times.items()}
    samples = best["samples"]
    print(f"{model}, {threads} threads, {native.isa()}, {compiler}")
    print(f"{args.size} x {args.size}, {args.samples} samples, {2 * args.mesh**2} triangles")
    stages = [stage for stage in best if stage not in WHOLE and best[stage]]
    for stage in stages:
        print(f"  {stage:15s}{1e9 * best[stage] / samples:8.2f} ns")
    print(f"  {'sum':15s}{1e9 * sum(best[s] for s in stages) / samples:8.2f} ns a sample and thread")
    for part in ("image", "mesh", "bvh", "wall", "cpu"):
        print(f"  {part:15s}{best[part]:8.4f} s")
    print(
        f"  {samples / best['wall'] / 1e6:.1f} million samples a second, all threads, all included"
    )


if __name__ == "__main__":
    main()
