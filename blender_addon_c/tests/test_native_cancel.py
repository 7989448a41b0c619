# SPDX-License-Identifier: GPL-3.0-or-later
"""Esc: a job ends at once wherever it is, and leaves a whole picture."""

import time

import numpy as np
import pytest

from native_scenes import area, box, image, native, persp, point, scene, sky, some, sphere
from test_native_closures import TRANSLUCENT, diffuse, glass, glossy, of, weighed

COST = 1.5

WORST = 0.3  # seconds
CASES = {
    # 12 bounces of glass and metal under an image and forty lamps
    "usual": {"max_bounces": 12, "lights": [area((k - 20, 3, 3)) for k in range(20)] +
              [point((k - 20, 3, -3), radius=0.1) for k in range(20)]},
    # in a closed box that loses nothing: a batch's paths are a thousand surfaces long, each of which
    # chooses from a thousand lamps
    "endless": {"max_bounces": 1024, "shut": True,
                "lights": [point((k / 100 - 5, 3, 3)) for k in range(1000)]},
}


def heavy(shut=False, **changes):
    rng = np.random.default_rng(1)
    balls = [sphere(40, 0.4, center) for center in rng.uniform(-1, 1, (20, 3))]
    looks = [of(glass(0.1)), of(weighed(diffuse(), 0.5), weighed(glossy(0.2), 0.5)), of(TRANSLUCENT)]
    for k, ball in enumerate(balls):
        ball["material"] = np.full_like(ball["material"], 0 if shut else k % 3)
    walls = [box((-5,) * 3, (5,) * 3)] if shut else []
    for wall in walls:
        wall["material"] = np.full_like(wall["material"], 1)
    return scene(width=1000, height=1000, samples=65536, camera=persp(), transparent=False,
                 materials=looks, meshes=balls + walls, images=[image(rng.random((64, 128, 3), np.float32))],
                 sky=sky(), **{"glossy_bounces": 1024, "diffuse_bounces": 1024,
                               "transmission_bounces": 1024, **changes})


@pytest.mark.parametrize("name", CASES)
def test_a_cancelled_render_ends_soon(name):
    late = []
    for wait in some((0.01, 0.1, 0.3)):
        job = native.start(heavy(**CASES[name]))
        while native.poll(job)["stage"] == "build":
            assert not native.wait(job, 0.01)
        assert not native.wait(job, wait), "nothing to cancel"
        start = time.perf_counter()
        native.cancel(job)
        assert native.wait(job, 60)
        late.append(time.perf_counter() - start)
        out = np.full((1000, 1000, 4), np.nan, np.float32)
        native.image(job, out)
        native.free(job)
        assert np.isfinite(out).all()
    print(f"{name}: cancelled after {max(late):.3f} s at most")
    assert max(late) < WORST
