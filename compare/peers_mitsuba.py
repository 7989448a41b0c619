# SPDX-License-Identifier: Apache-2.0
"""Run by build/venv-peers: the plate of plate.py, or a sphere, in Mitsuba 3, once per job.

    build/venv-peers/bin/python peers_mitsuba.py JOBS.json

JOBS.json is {"result": file, "normals": .npy of a normal map (rows from the top), "jobs": [job, ...]}; a job is
    "shape":    "plate", as where there is none, or "sphere" (sphere.py); the normal map is of that
    "surface":  "bumped" (normal map) or "displaced" (mesh)
    "sky":      if there is one, an .npy of linear RGB that lights the plate in the sun's place
    "alphas":   of the anisotropic GGX, along u and along v
    "size", "samples", "quads", "seed": integers
    "repeat":   how often to render for time; the seconds of each go to the result file
    "output":   .npy for the picture, rows from the top, or ""
Mitsuba looks for Debian's libllvm19 where DRJIT_LIBLLVM_PATH says.
"""
import json
import sys
import time

import mitsuba as mi
import numpy as np

import plate
import sphere
import whole

mi.set_variant("llvm_ad_rgb")


def parts_of(job):
    """(positions, normals, faces, uv) of a job's surface."""
    displaced = job["surface"] == "displaced"
    if job.get("shape") == "sphere":
        return sphere.mesh(job["quads"] if displaced else sphere.FLAT, displaced)
    positions, normals, faces, uv = plate.mesh(job["quads"] if displaced else 1)
    if not displaced:
        positions, normals = positions * (1.0, 1.0, 0.0), np.broadcast_to([0.0, 0.0, 1.0], normals.shape)
    return positions, normals, faces, uv


def mesh(parts):
    positions, normals, faces, uv = parts
    triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    made = mi.Mesh("plate", len(positions), len(triangles), has_vertex_normals=True, has_vertex_texcoords=True)
    values = mi.traverse(made)
    for name, array, kind in (("vertex_positions", positions, mi.Float), ("vertex_normals", normals, mi.Float),
                              ("vertex_texcoords", uv, mi.Float), ("faces", triangles, mi.UInt32)):
        values[name] = kind(np.ascontiguousarray(array, np.uint32 if kind is mi.UInt32 else np.float32).ravel())
    values.update()
    return made


def written(shape, folder, name):
    path = f"{folder}/{name}.ply"
    shape.write_ply(path)
    return path


def scene_of(job, normals, folder):
    metal = {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha_u": job["alphas"][0],
             "alpha_v": job["alphas"][1]}
    shape = written(mesh(parts_of(job)), folder, job["surface"])
    if job["surface"] == "bumped":
        bitmap = mi.Bitmap(np.ascontiguousarray(normals[::-1], np.float32))  # its v grows downwards
        metal = {"type": "normalmap", "bsdf": metal,
                 "normalmap": {"type": "bitmap", "bitmap": bitmap, "raw": True}}
    if job.get("sky"):
        light = {"type": "envmap", "bitmap": mi.Bitmap(np.load(job["sky"]).astype(np.float32)),
                 # Mitsuba's sky has y up, Blender's z
                 "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90).rotate([0, 1, 0], 90)}
    else:
        light = {"type": "directional", "direction": (-plate.SUN).tolist(), "irradiance": 1.0}
    return mi.load_dict({
        "type": "scene", "integrator": {"type": "direct"} if not job.get("sky") else {"type": "path", "max_depth": 6},
        "light": light, "plate": {"type": "ply", "filename": shape, "bsdf": {"type": "twosided", "bsdf": metal}},
        "sensor": {"type": "orthographic", "near_clip": 0.1, "far_clip": 10.0,
                   "to_world": mi.ScalarTransform4f().look_at([0, 0, 2], [0, 0, 0], [0, 1, 0])
                   @ mi.ScalarTransform4f().scale([0.5, 0.5, 1]),
                   "film": {"type": "hdrfilm", "width": job["size"], "height": job["size"], "rfilter": {"type": "box"},
                            "pixel_format": "rgb", "component_format": "float32"}}})


def render(scene, job, turn):
    """(picture, seconds)."""
    start = time.perf_counter()
    picture = np.array(mi.render(scene, spp=job["samples"], seed=job["seed"] + turn))
    return picture, time.perf_counter() - start


def main(path):
    with open(path, encoding="utf-8") as file:
        order = json.load(file)
    normals, folder = np.load(order["normals"]), order["folder"]
    seconds = []
    for job in order["jobs"]:
        scene = scene_of(job, normals, folder)
        picture, _first = render(scene, job, 0)  # compiles its kernels, and is not timed
        seconds.append([render(scene, job, turn + 1)[1] for turn in range(job["repeat"])])
        if job["output"]:
            with whole.place(job["output"]) as part:
                np.save(part, picture[..., :3])
    whole.write_text(order["result"], json.dumps({"seconds": seconds, "version": mi.__version__}))


main(sys.argv[1])
