# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera that goes from one metre to a hundred off a plate: how its brightness moves, and what a frame costs.

    build/venv/bin/python blender_addon_c/tests/zoom.py [--frames 100] [--side 256] [--samples 8] [name ...]

A name is a surface or how some begin: `zoom.py fabric`. Cloths are looked at aslant, under a sun and an even sky, by pixels
of a picture 1920 wide at 40 degrees, in which there is a yarn or less at one metre, and by four times the samples: of 8 points
denim's mean is .15 % noisy from frame to frame. What they are made of is made once, and not counted. Their points are their
yarns', whatever the footprint.

Of each surface, a line: by how much the mean changes from frame to frame beyond what that of 1,024 samples of points
does, at most, over the median change (limit 3); the largest distance of a frame's mean from those points' (limit 3 %; of
fewer pixels, which points do not know); and processor time of a frame in each fifth of the way over that of the first
(limit 1.1). What the points do by themselves is said, not judged: near, where a picture is of a few bumps, each frame
shows others; nor is the time to equal noise, that of a frame times the variance of its pixels from one seed to another.
Changes below .1 % of the mean, which no eye sees, count as so much: where nothing moves the median is noise. Exit status 0
if all are within their limits.
"""

import argparse
import sys
import time

import numpy as np

from native_scenes import finish, image, material, native, persp, registers, render, scene, square, sun, unit
from test_native_cloth import cloth, fabric
from test_native_scratches import FINE
from test_native_zoom import SLOPE, bumps, cosines, metal

TILES, FLOOR, TRUTH = 400, 1e-3, 1024
LIMITS = {"step": 3.0, "apart": 0.03, "cost": 1.1}
UV, NEAR, NORMAL, SPREAD, ALPHA = registers(3, 3), registers(6, 2), registers(9, 3), registers(12, 2), registers(14, 2)


def checker(_filtered):
    """Squares of 1/8 m, an image that is averaged."""
    look = {"type": "IMAGE", "image": 0, "out": registers(3, 3), "averaged": True}
    return {"name": "checker", "nodes": [look], "closures": [
        {"closure": "DIFFUSE", "model": "LAMBERT", "color": registers(3, 3), "roughness": [0.0]}]}


def scratched(filtered):
    """Scratches of test_native_scratches.py, two fields in a metre."""
    moved = [{"type": "MATH", "operation": "ADD", "a": [a], "b": [0.125], "c": [0.0], "out": [b]} for a, b in zip(UV, NEAR)]
    field = {"type": "SCRATCHES", "what": "NORMAL", "field": 0, "at": UV[:2], "near": [NEAR[0], UV[1], UV[0], NEAR[1]],
             "step": 0.125, "amount": [1.0], "normal": [0.0, 0.0, 1.0], "filtered": True, "out": [*NORMAL, *SPREAD]}
    nodes = [{"type": "GEOMETRY", "what": "UV", "out": UV}, *moved, field]
    for a, b in zip(SPREAD, ALPHA):
        nodes += [{"type": "MATH", "operation": "ADD", "a": [a], "b": [0.04], "c": [0.0], "out": [b]},
                  {"type": "MATH", "operation": "SQRT", "a": [b], "b": [0.0], "c": [0.0], "out": [b]}]
    return material(mdf="BECKMANN", brdf="MICROFACET", fresnel="NONE", f0=(1, 1, 1)) | {
        "nodes": nodes, "normal": NORMAL, "ax_from": ALPHA[:1], "ay_from": ALPHA[1:]}


def squares():
    pixels = (np.indices((64, 64)) // 8).sum(0) % 2
    return np.float32(0.1 + 0.7 * pixels)[..., None].repeat(3, -1)


SURFACES = {"brushed, Beckmann": (metal, lambda: [image(bumps(*SLOPE["brushed"]))], []),
            "brushed, Ashikhmin-Shirley": (cosines, lambda: [image(bumps(*SLOPE["brushed"]))], []),
            "checker": (checker, lambda: [image(squares())], []),
            "scratched": (scratched, list, [FINE])}
FABRICS = {f"fabric, {word.replace('_', ' ')}": word for word in ("denim", "silk_charmeuse", "herringbone_tweed", "wool_flannel")}


def variance(picture, again):
    """Of a pixel, by the picture of another seed, over the mean squared."""
    return np.square(picture - again, dtype=float).mean() / 2 / picture.mean(dtype=float) ** 2


def green(job, side):
    picture = np.full((side, side, 4), np.nan, np.float32)
    native.image(job, picture)
    return picture[..., 1]


def frame(name, far, side, samples, filtered):
    """(mean of the picture, seconds of processor time, variance of a pixel: of points not told)."""
    make, images, fields = SURFACES[name]
    plate = square(TILES)
    plate["corner_uvs"] = np.float32(plate["corner_uvs"] * 2 * TILES)
    blur = {"normal_blur": samples**-0.5, "texture_blur": 0.25} if filtered else {}
    made = scene(meshes=[plate], images=images(), scratches=fields, materials=[make(filtered)], lights=[sun((0.3, 0.1, 0.9), angle=0.02)],
                 camera=persp(0.25, (0, 0.013, far), (0, 0.013, 0), clip=(0.01, 1000)), width=side, height=side,
                 samples=samples, seed=1 if filtered else 2, transparent=False, max_bounces=0, **blur)
    begin = time.process_time()
    picture = render(made)[0][..., 1]
    seconds = time.process_time() - begin
    again = render({**made, "seed": 3})[0][..., 1] if filtered else picture
    return picture.mean(dtype=float), seconds, variance(picture, again)


def frames_of(name, way, side, samples, filtered):
    """Rows as frame has them."""
    if name in SURFACES:
        return np.array([frame(name, far, side, samples, filtered) for far in way])
    samples *= 4 if filtered else 1
    cloths, rows, job = [cloth(FABRICS[name], 16.0, tier="auto" if filtered else "near")], [], None
    for far in way:
        made = scene(cloths=cloths, materials=[fabric()], meshes=[square(8.0)], lights=[sun((0.4, 0.5, 0.8), (2, 2, 2), angle=0.05)],
                     background=(0.3, 0.3, 0.3), camera=persp(0.364 * 256 / 1920, tuple(far * unit(np.array((0.45, -0.3, 1.0)))), clip=(0.01, 1000)),
                     width=side, height=side, samples=samples, seed=1 if filtered else 2, transparent=False, max_bounces=1)
        if not job:
            job = native.start(made)
            finish(job)
        begin, before = time.process_time(), job
        job = native.look(before, {key: made[key] for key in ("width", "height", "region", "samples", "camera")})
        assert finish(job)["state"] == "done"
        seconds, picture = time.process_time() - begin, green(job, side)
        native.free(before)
        again = picture
        if filtered:  # a look keeps its seed
            other = native.start({**made, "seed": 3})
            finish(other)
            again = green(other, side)
            native.free(other)
        rows.append((picture.mean(dtype=float), seconds, variance(picture, again)))
    native.free(job)
    return np.array(rows)


def measure(name, frames, side, samples):
    """By limit: what was found, where, and by fifth of the way what a frame costs."""
    way = np.geomspace(1, 100, frames)
    means, cost, noise = frames_of(name, way, side, samples, True).T
    truth = frames_of(name, way, max(side // 4, 4), TRUTH, False)[:, 0]
    steps, true = (np.diff(values) / values.mean() for values in (means, truth))
    beyond, steps, true = np.abs(steps - true), np.abs(steps), np.abs(true)
    apart = np.abs(means / truth - 1)
    fifths = np.array([np.min(part) for part in np.array_split(cost, 5)])
    alike = fifths * [np.mean(part) for part in np.array_split(noise, 5)]
    return {"step": beyond.max() / max(np.median(steps), FLOOR), "apart": apart.max(), "cost": (fifths / fifths[0]).max()}, \
        (f"changes to {100 * steps.max():.3f} % at {way[steps.argmax()]:.1f} m (points: {100 * true.max():.3f} % at "
         f"{way[true.argmax()]:.1f} m), median {100 * np.median(steps):.3f} % ({100 * np.median(true):.3f} %), {100 * beyond.max():.3f} % "
         f"beyond those of points at {way[beyond.argmax()]:.1f} m; "
         f"{100 * apart.max():.2f} % from {TRUTH} samples at {way[apart.argmax()]:.1f} m, {100 * abs(np.mean(means / truth) - 1):.2f} % in "
         f"the mean; cost by fifth {', '.join(f'{part:.2f}' for part in fifths / fifths[0])}, to equal noise "
         f"{', '.join(f'{part:.3f}' for part in alike / alike[0])}")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("names", nargs="*", metavar="name", default=[*SURFACES, "fabric"])
    for word, number in ("frames", 100), ("side", 256), ("samples", 8):
        words.add_argument("--" + word, type=int, default=number)
    given = words.parse_args()
    known = [*SURFACES, *FABRICS]
    for name in given.names:
        if not any(each.startswith(name) for each in known):
            words.error(f"no surface begins with {name!r}; there are {'; '.join(known)}")
    missed = 0
    for name in [each for each in known if any(each.startswith(name) for name in given.names)]:
        found, text = measure(name, given.frames, given.side, given.samples)
        over = [f"{limit} {found[limit]:.3g} (limit {most:g})" for limit, most in LIMITS.items() if not found[limit] <= most]
        missed += len(over)
        print(f"{name}: {text}; {'MISSED: ' + ', '.join(over) if over else 'within all limits'}", flush=True)
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
