# SPDX-License-Identifier: GPL-3.0-or-later
"""Cloth from one metre to a hundred, by pixels as narrow as those of a picture 1920 wide: yarns become cloth without a jump,
in pixels beside the frames before and after, in brightness beside the yarns themselves (by more points of the same view).

Three times the median of the whole way is what differences from frame to frame may be, or what the yarns' own are: a camera that
goes by constant ratios changes near frames more than far ones, whatever renders them. Of 100 frames the first three differences are of
denim .28, .27, .24 of the mean, of 1,024 points of yarns in each pixel .31, .30, .29; of lining .019, .018, .017 for .078, .071, .064; of
linen .13, .12, .13 for .17, .16, .16. Noise of 16 samples is in these: of 256 linen's are .098, .084, .086.

FRAMES=100 is the whole way (a minute); `-s` shows differences from frame to frame and what a frame costs.
"""

import os
import time

import numpy as np
import pytest

from native_scenes import SANITIZED, chance, finish, native, persp, scene, some, square, sun, unit
from test_native_cloth import cloth, fabric

COST = 5.7


# under sanitizers a sixteenth of the pixels, as wide: what an eye sees of a jump is asked of other builds
FRAMES, SIDE, SAMPLES = int(os.environ.get("FRAMES", "25")), 8 if SANITIZED else 32, 16
HALF = 0.364 * SIDE / 1920  # of the picture, at one metre: 40 degrees over 1920 pixels
QUIET = 256  # samples, where noise of less would be a difference
FLOOR = 1e-3  # of the mean: what no eye sees


def frames_of(preset, far, tier, samples=SAMPLES):
    """(The pixels of the middle of a plate of 8 m, seconds of all cores) from so far: looks at one scene, made once."""
    job = None
    for z in far:
        eye = z * unit(np.array((0.45, -0.3, 1.0)))
        made = scene(cloths=[cloth(preset, 8.0, tier=tier)], materials=[fabric()], meshes=[square(4.0)],
                     camera=persp(HALF, tuple(eye), clip=(0.01, 1000)), lights=[sun((0.4, 0.5, 0.8), (2, 2, 2), angle=0.05)],
                     background=(0.3, 0.3, 0.3), width=SIDE, height=SIDE, samples=samples, transparent=False, max_bounces=1)
        begin = time.process_time()
        if job is None:
            job = native.start(made)
        else:
            before, job = job, native.look(job, {key: made[key] for key in ("width", "height", "region", "samples", "camera")})
            native.free(before)
        assert finish(job)["state"] == "done"
        seconds, picture = time.process_time() - begin, np.full((SIDE, SIDE, 4), np.nan, np.float32)
        native.image(job, picture)
        assert np.isfinite(picture).all()
        yield picture[..., :3].astype(float), seconds
    native.free(job)


def steps_of(frames):
    """From frame to frame, over the mean."""
    return np.array([np.abs(a - b).mean() for a, b in zip(frames, frames[1:])]) / np.mean([f.mean() for f in frames])


def pops(frames):
    """Numbers of those after which more changes than three times what changes before and after, in the median of three; (they,
    differences over the mean)."""
    seen = steps_of(frames)
    found = []
    for k, step in enumerate(seen):
        sides = [np.median(side) for side in (seen[max(0, k - 3):k], seen[k + 1:k + 4]) if len(side)]
        if step > 3 * max(sides) + FLOOR:
            found.append(k)
    return found, seen


def jumps(frames, truths):
    """Numbers of those after which brightness changes by 2.5 % more or less than what the yarns themselves do."""
    ratio = np.array([a.mean() / b.mean() for a, b in zip(frames, truths)])
    return [k for k, step in enumerate(ratio[1:] / ratio[:-1]) if abs(step - 1) > 0.025], ratio


@pytest.mark.parametrize("preset", some(["denim", "linen", "polyester_lining"]))
def test_no_popping(preset):
    far = np.geomspace(1, 100, FRAMES)
    frames, cost = zip(*frames_of(preset, far, "auto"))
    found, seen = pops(frames)
    means = np.array([f.mean() for f in frames])
    fifths = np.array_split(np.arange(FRAMES), 5)
    by_fifth = [round(float(np.median(seen[part[part < FRAMES - 1]])), 5) for part in fifths]
    ms = [round(1e3 * float(np.median(np.array(cost)[part])), 1) for part in fifths]
    print(f"{preset}: differences by fifth of the way {by_fifth}, largest {seen.max():.4f} at {far[seen.argmax()]:.2f} m, median "
          f"{np.median(seen):.5f}; means within {np.abs(means / means[-1] - 1).max():.4f} of the last; ms a frame {ms}")
    assert SANITIZED or not found, [(round(far[k], 2), seen[k]) for k in found]
    assert np.abs(means / means[-1] - 1)[far > 10].max() < chance(0.01)  # nearer there are some twenty yarns, which vary
    truths = [picture for picture, _ in frames_of(preset, far, "near", 4 * SAMPLES)]
    # where more than three medians change the picture itself changes as much, noise apart
    over = np.flatnonzero(seen > 3 * np.median(seen))
    if len(over) and not SANITIZED:
        reach = far[:over.max() + 2]
        ours, own = (steps_of([picture for picture, _ in frames_of(preset, reach, tier, QUIET)]) for tier in ("auto", "near"))
        print(f"{preset}: {len(over)} differences over three medians; there those of {QUIET} samples are "
              f"{(ours[over] / own[over]).max():.2f} of the yarns' own at most")
        assert (ours[over] <= own[over] + FLOOR).all(), [(round(far[k], 2), ours[k], own[k]) for k in over]
    found, ratio = jumps(frames, truths)
    print(f"{preset}: brightness beside that of yarns {ratio.min():.4f} to {ratio.max():.4f}, from frame to frame within "
          f"{np.abs(ratio[1:] / ratio[:-1] - 1).max():.4f}")
    assert (SANITIZED or not found) and np.abs(ratio - 1).max() < chance(0.02), [(round(far[k], 2), ratio[k:k + 2]) for k in found]
    for at in range(1, 0 if SANITIZED else FRAMES):  # one between two models would be seen wherever it is
        assert jumps([f * (1.05 if k >= at else 1.0) for k, f in enumerate(frames)], truths)[0] == [at - 1]
