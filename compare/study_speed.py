# SPDX-License-Identifier: Apache-2.0
"""Detail methods: what each costs, and how far its highlight is from that of a displaced surface.

The truth is worked out here, with numpy, and shares no code with libshade: the surface whose normal is
n carries the distribution along its own dP/du, and the error is the total variation
1/2 int |D' - D_true| dh over the half vectors above the horizon. D' comes from the library.
"""
import ctypes
import math
import time

import numpy as np

import fronts
import programs
import report
import shade
from detail_speed_page import figures, findings, tables  # noqa: F401  (of the study)
from study import Task

NAME = "speed"
TITLE = "Detail methods: speed against accuracy"
INTRO = ("A normal map tilts the normal; a detail method says how the highlight follows. The truth is the "
         "same material on a surface that really has that slope, its grooves carried along by the surface: "
         "there the whole distribution turns with dP/du. The error is the total variation between the two "
         "distributions of half vectors, 0 where they agree and 1 where they have nothing in common, the mean "
         "over the azimuths of the tilt. Grooves run along x; exponents are 200 and 10. Times are for the "
         "distribution alone, in the library's float form, on one core over arrays in cache.")
EX, EY = 200.0, 10.0
TILTS = (10, 20, 30, 45, 60, 75)
QUICK_TILTS = (10, 20, 30, 45, 75)
MDFS = ("ashikhmin_shirley", "ward", "ward_half", "beckmann", "ggx")


# ---- the truth ----------------------------------------------------------------------------------


def lobe(mdf, x, y, z, ex, ey):
    """D of a half vector in the frame of the facet, z > 0; alphas match the exponents."""
    ax2, ay2 = 2 / (ex + 2), 2 / (ey + 2)
    norm = 1 / (math.pi * math.sqrt(ax2 * ay2))
    side2 = np.maximum(x * x + y * y, 1e-300)
    if mdf == "ashikhmin_shirley":
        exponent = (ex * x * x + ey * y * y) / side2
        return math.sqrt((ex + 1) * (ey + 1)) / (2 * math.pi) * z**exponent
    slope = (x * x / ax2 + y * y / ay2) / (z * z)
    if mdf == "ward":
        return norm * np.exp(-slope)
    if mdf == "ward_half":
        return norm * np.exp(-2 * (x * x / ax2 + y * y / ay2) / (1 + z))
    if mdf == "beckmann":
        return norm * np.exp(-slope) / z**4
    return norm / (z**4 * (1 + slope) ** 2)


def sphere(fine):
    """Half vectors (N, 3) above the horizon and their solid angles: Gauss over cos, even azimuths."""
    nodes, weights = np.polynomial.legendre.leggauss(fine)
    z, count = (nodes + 1) / 2, 2 * fine
    azimuth = 2 * np.pi * (np.arange(count) + 0.5) / count
    side = np.sqrt(1 - z * z)[:, None]
    h = np.stack([side * np.cos(azimuth), side * np.sin(azimuth),
                  np.broadcast_to(z[:, None], (fine, count))], -1)
    return h.reshape(-1, 3), np.repeat(weights / 2, count) * (2 * np.pi / count)


def displaced(mdf, n, h, ex, ey):
    """D of half vectors on the surface of normal n: its x axis is dP/du, along (nz, 0, -nx)."""
    x = np.array([n[2], 0, -n[0]]) / math.hypot(n[0], n[2])
    y = np.cross(n, x)
    out = np.zeros(len(h))
    up = h @ n > 1e-12
    out[up] = lobe(mdf, h[up] @ x, h[up] @ y, h[up] @ n, ex, ey)
    return out


def variation(mdf, methods, tilt, azimuths, fine, ex=EX, ey=EY):
    """{method: total variation at each azimuth of a quarter, which stands for all four}, D' in double."""
    h, weight = sphere(fine)
    made = {m: shade.Material(mdf=mdf, ex=ex, ey=ey, detail=m, groove="x") for m in methods}
    found = {m: [] for m in methods}
    for k in range(azimuths):
        phi = np.pi / 2 * (k + 0.5) / azimuths
        n = np.array([math.sin(math.radians(tilt)) * math.cos(phi),
                      math.sin(math.radians(tilt)) * math.sin(phi), math.cos(math.radians(tilt))])
        true = displaced(mdf, n, h, ex, ey)
        # what ∫ is 1 of: D, or of Beckmann and GGX the area that it stands for
        measure = weight * np.maximum(h @ n, 0) if mdf in ("beckmann", "ggx") else weight
        for m in methods:
            found[m].append(0.5 * float(measure @ np.abs(shade.D(made[m], n, h) - true)))
    return found


# ---- the rows -----------------------------------------------------------------------------------


def errors(mdf, tilt, azimuths, fine):
    def run(_folder, _say):
        methods = [m for m in shade.choices("detail") if m != "auto"]
        fine_found = variation(mdf, methods, tilt, azimuths, fine)
        coarse = variation(mdf, methods, tilt, azimuths * 3 // 4, fine * 3 // 4)
        rows = []
        for m in methods:
            low, high = np.percentile(fine_found[m], [25, 75])
            rows.append({"kind": "error", "method": m, "distribution": mdf, "tilt": tilt,
                         "error": float(np.mean(fine_found[m])), "error_low": float(low),
                         "error_high": float(high), "error_most": max(fine_found[m]),
                         "quadrature": abs(float(np.mean(fine_found[m]) - np.mean(coarse[m])))})
        return rows
    return run


def speed(mdf, runs):
    def run(_folder, say):
        rows = fronts.bench(["--what", "D", "--mdf", mdf, "--set", "cache"], runs, say)
        return [{"kind": "speed", **row} for row in rows
                if row["precision"] in ("float", "double") and row["method"] != "auto"]
    return run


PLAIN = programs.BUILD / "plain.so"
ARRAY = 2048  # samples, in cache as those of `shade bench`


def plain(mdf, runs):
    """The same D by compare/plain.c, one sample after the other: -O2 and libm."""
    def run(_folder, _say):
        if not PLAIN.is_file():
            raise report.StepFailed(f"{PLAIN}: no such file; run make build/plain.so")
        call = ctypes.CDLL(str(PLAIN)).plain_D
        random = np.random.default_rng(5)
        n, h = (within(random) for _ in range(2))
        made = np.empty(ARRAY, np.float32)
        given = [ctypes.c_int(MDFS.index(mdf)), ctypes.c_size_t(ARRAY), ctypes.c_float(EX), ctypes.c_float(EY),
                 *(ctypes.c_void_p(a.ctypes.data) for a in (n, h, made))]
        call(*given)
        true = np.array([displaced(mdf, normal, half[None], EX, EY)[0] for normal, half in zip(n.astype(float), h.astype(float))])
        off = float(np.abs(made - true).max() / true.max())
        if off > 1e-4:
            raise ValueError(f"compare/plain.c: D of {mdf} is {off} of its peak off")
        rows = []
        for number in range(runs):
            best = 1e30
            for _ in range(60):
                begun = time.perf_counter()
                call(*given)
                best = min(best, time.perf_counter() - begun)
            rows.append({"kind": "speed", "method": "rotate_plain", "distribution": mdf, "precision": "float", "isa": "plain C",
                         "run": number, "ns": 1e9 * best / ARRAY, "rounding": off})
        return rows
    return run


def within(random):
    """Directions within 60 degrees of z, float32."""
    z, phi = 1 - 0.5 * random.random(ARRAY), 2 * np.pi * random.random(ARRAY)
    side = np.sqrt(1 - z * z)
    return np.ascontiguousarray(np.stack([side * np.cos(phi), side * np.sin(phi), z], -1), np.float32)


def tasks(quick):
    mdfs = ("ashikhmin_shirley", "ggx") if quick else MDFS
    tilts = QUICK_TILTS if quick else TILTS
    runs, azimuths, fine = (7, 12, 128) if quick else (15, 24, 240)
    made = []
    for mdf in mdfs:
        made.append(Task(f"speed-{mdf}", 0.3 * runs, speed(mdf, runs),
                         fronts.command(["--what", "D", "--mdf", mdf.replace("_", "-"), "--set", "cache"])))
        made.append(Task(f"plain-{mdf}", 0.1 * runs, plain(mdf, runs), needs=(PLAIN,)))
        made += [Task(f"error-{mdf}-{tilt}", 1.5 if quick else 6, errors(mdf, tilt, azimuths, fine))
                 for tilt in tilts]
    return made
