# SPDX-License-Identifier: AGPL-3.0-or-later
"""Pieces of scenes, and the formulas that the tests hold against them."""
import numpy as np

HEADER = """#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <1, 2, -5> look_at 0 angle 30 }
"""
SUN = "light_source { <40, 60, -50>, rgb <1, .9, .8> parallel point_at 0 }\n"
LAMP = "light_source { <-6, 2, -4>, rgb <.3, .4, .6> }\n"


def finish(words, detail="rotate", exponents="200, 10"):
    return f"finish {{ ambient 0 diffuse 0 mdf {{ ashikhmin_shirley {exponents} detail {detail} horizon hard {words} }} }}"


def scene(objects, lights=SUN + LAMP, header=HEADER):
    return header + lights + objects


# name: (geometry, has it UV coordinates). The mesh is a saddle with smooth normals.
def saddle(cells=8, uv=True, extra=""):
    ticks = np.linspace(-1, 1, cells + 1)
    x, z = np.meshgrid(ticks, ticks, indexing="ij")
    y = .3 * (x * x - z * z)
    normals = np.stack([-.6 * x, np.ones_like(x), .6 * z], -1)
    vectors = lambda a: ", ".join("<" + ", ".join(f"{c:.9g}" for c in row) + ">" for row in a.reshape(-1, a.shape[-1]))
    faces = []
    for i in range(cells):
        for j in range(cells):
            a, b, c, d = (i * (cells + 1) + j, i * (cells + 1) + j + 1, (i + 1) * (cells + 1) + j + 1, (i + 1) * (cells + 1) + j)
            faces += [(a, b, c), (a, c, d)]
    count = (cells + 1) ** 2
    text = f"mesh2 {{ vertex_vectors {{ {count}, {vectors(np.stack([x, y, z], -1))} }}\n"
    text += f"normal_vectors {{ {count}, {vectors(normals)} }}\n"
    if uv:
        text += f"uv_vectors {{ {count}, {vectors(np.stack([(x + z) / 2, (z - x) / 2], -1))} }}\n"
    text += f"face_indices {{ {len(faces)}, " + ", ".join(f"<{a}, {b}, {c}>" for a, b, c in faces) + " }\n"
    return text + extra


OBJECTS = {
    "sphere": "sphere { 0, 1",
    "torus": "torus { .8, .3 rotate -40*x",
    "box": "box { -.7, .7 rotate 30*y",
    "mesh2": saddle(),
    "sor": "sor { 5, <0, -.5>, <.6, 0>, <.9, .5>, <.5, 1>, <.4, 1.4> translate -.6*y",
    "lathe": "lathe { cubic_spline 5, <0, -.5>, <.6, 0>, <.9, .5>, <.5, 1>, <.4, 1.4> translate -.6*y",
    "ovus": "ovus { .8, .5 translate -.4*y",
    "cone": "cone { -y, .9, y, .2",
    "plane": "plane { y, -.5",
    "blob": "blob { threshold .5 sphere { -.4*x, 1, 1 } sphere { .4*x, 1, 1 }",
}


def normalise(v):
    """Unit vectors; NaN where a pixel of a dump holds none."""
    with np.errstate(invalid="ignore"):
        return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a, b):
    return np.sum(a * b, -1)


def reflect(dump, light):
    """S of one light, recomputed in double from the dump by the textbook way: an explicit frame for
    every detail method, angles, Ashikhmin and Shirley's formula as printed in their 2000 paper (Eq. 4).
    Returns S and the mask of the pixels it speaks for."""
    N, Ns, V, L = (normalise(a) for a in (dump.N, dump.Ns, dump.V, dump.L[light]))
    T = normalise(dump.T - dot(dump.T, N)[..., None] * N)
    B = np.cross(N, T)
    S = np.zeros(dump.hit.shape + (3,))
    with np.errstate(all="ignore"):
        for m in dump.header["materials"]:
            mask = dump.id == m["id"]
            local = lambda a: np.stack([dot(a, T), dot(a, B), dot(a, N)], -1)
            n, wi, wo = local(Ns), local(L), local(V)
            if m["detail"] == "none":
                n = np.zeros_like(n) + [0., 0., 1.]
            h = normalise(wi + wo)
            groove_x = {"x": True, "y": False, "auto": m["ex"] >= m["ey"]}[m["groove"]]
            x, y = np.zeros_like(n) + [1., 0., 0.], np.zeros_like(n) + [0., 1., 0.]
            if m["detail"] == "rotate":
                if groove_x:  # x' in the plane of x and z, orthogonal to n
                    x = normalise(np.stack([n[..., 2], 0 * n[..., 0], -n[..., 0]], -1))
                else:
                    x = np.cross(normalise(np.stack([0 * n[..., 0], n[..., 2], -n[..., 1]], -1)), n)
                y = np.cross(n, x)
            elif m["detail"] == "gram_schmidt":
                x = normalise(x - dot(x, n)[..., None] * n)
                y = np.cross(n, x)
            phi = np.arctan2(dot(h, y), dot(h, x))
            cosine = np.clip(dot(h, n), 0, 1)
            exponent = m["ex"] * np.cos(phi) ** 2 + m["ey"] * np.sin(phi) ** 2
            D = np.sqrt((m["ex"] + 1) * (m["ey"] + 1)) / (2 * np.pi) * cosine ** exponent
            F = np.zeros(D.shape + (3,)) + m["f0"]
            if m["fresnel"] == "schlick":
                F = F + (1 - F) * ((1 - dot(h, wo)) ** 5)[..., None]
            ni, no = dot(n, wi), dot(n, wo)
            lit = mask & (ni > 0) & (no > 0) & (wi[..., 2] > 0) & (wo[..., 2] > 0)
            f = D / (4 * dot(h, wo) * np.maximum(ni, no))
            S = np.where(lit[..., None], f[..., None] * F * ni[..., None] * dump.E[light], S)
    return S


def largest_error(dump):
    """Largest relative error of S against reflect(), where S > 1e-4 of its maximum."""
    worst = 0.0
    for light in range(dump.lights):
        expected, found = reflect(dump, light), dump.S[light]
        scale = np.maximum(expected, found)
        compared = scale > 1e-4 * scale.max(initial=0)
        if scale.max(initial=0) > 0:
            worst = max(worst, np.max(np.abs(expected - found)[compared] / scale[compared]))
    return worst
