# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes for the native module, and the formulas that they are checked against, long-hand.

NATIVE_MODULE names another build of the module, e.g. one with a sanitizer.
"""

import copy
import importlib.util
import os
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULE = Path(os.environ.get("NATIVE_MODULE", ROOT / "build/blender/native/_native.abi3.so"))
# Sanitizers look at memory and are slow: there the same places are rendered by fewer samples. What those say
# of a mean is asked of the release build.
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")
FEWER = 16 if SANITIZED else 1


def few(samples):
    """So many samples, under sanitizers a sixteenth."""
    return max(1, samples // FEWER)


def some(cases, every=3):
    """All cases in the release build; in others, which are asked about memory and about what a compiler makes of
    the same code, one of so many: of cases that differ in numbers, not in what runs."""
    return list(cases)[::every if "NATIVE_MODULE" in os.environ else 1]


# What looks at means of pictures and runs nothing that others of its file do not run under sanitizers
of_means = pytest.mark.skipif(SANITIZED, reason="a mean is asked of the release build")


def chance(limit):
    """A limit for noise of few(samples), given that of all: noise falls by up to the 3/4 power of their number."""
    return limit * FEWER**0.75


def load(path=MODULE):
    assert path.exists(), f"{path} is missing: run `make native`"
    spec = importlib.util.spec_from_file_location("_native", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


native = load()


# ---- scenes


def look_at(eye, target, up=(0, 1, 0)):
    """Camera to world, looking along -z."""
    back = np.subtract(eye, target).astype(float)
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = (
        right,
        np.cross(back, right),
        back,
        eye,
    )
    return matrix


def ortho(half=1.0, eye=(0, 0, 3), target=(0, 0, 0), clip=(0.01, 100)):
    return {
        "type": "ORTHO",
        "matrix": look_at(eye, target).ravel().tolist(),
        "frame": (-half, half, -half, half),
        "clip": clip,
    }


def persp(half=0.5, eye=(0, 0, 3), target=(0, 0, 0), clip=(0.01, 100)):
    return ortho(half, eye, target, clip) | {"type": "PERSP"}


def sun(direction=(0, 0, 1), irradiance=(1, 1, 1), angle=0.0, shadow=True):
    unit = np.divide(direction, np.linalg.norm(direction))
    return {
        "name": "sun",
        "type": "SUN",
        "irradiance": irradiance,
        "direction": tuple(unit),
        "angle": angle,
        "shadow": shadow,
    }


def point(position, intensity=(1, 1, 1), radius=0.0, shadow=True):
    return {
        "name": "point",
        "type": "POINT",
        "intensity": intensity,
        "position": position,
        "radius": radius,
        "shadow": shadow,
    }


def registers(first, count):
    """That many operands of a graph, from this register on."""
    return [(first + k,) for k in range(count)]


def spot(position, direction=(0, 0, -1), intensity=(1, 1, 1), angle=1.0, blend=0.0, radius=0.0, cosine_law=False):
    return point(position, intensity, radius) | {
        "name": "spot", "type": "SPOT", "direction": direction, "angle": angle, "blend": blend,
        "cosine_law": cosine_law,
    }


def area(position, size=(1, 1), intensity=(1, 1, 1), direction=(0, 0, -1), spread=np.pi, round=False):
    """Along x and y."""
    return {
        "name": "area", "type": "AREA", "intensity": intensity, "position": position,
        "axis_u": (size[0] / 2, 0, 0), "axis_v": (0, size[1] / 2, 0), "direction": direction,
        "spread": spread, "round": round, "shadow": True,
    }


def sky(strength=(1, 1, 1), matrix=np.eye(3, 4), projection="EQUIRECTANGULAR", index=0):
    return {"image": index, "strength": strength, "matrix": np.ravel(matrix).tolist(), "projection": projection}


def material(color_image=-1, normal_image=-1, normal_strength=1.0, **changes):
    """A metal; the images' indices become nodes."""
    color = {"type": "IMAGE", "image": color_image, "out": registers(3, 3)}
    normal = {"type": "NORMAL_MAP", "image": normal_image, "strength": normal_strength,
              "out": registers(6, 3)}
    plain = {
        "name": "metal",
        "closure": "METAL",
        "mdf": "ASHIKHMIN_SHIRLEY",
        "brdf": "ASHIKHMIN_SHIRLEY",
        "detail": "ROTATE",
        "groove": "AUTO",
        "fresnel": "SCHLICK",
        "ex": 200.0,
        "ey": 10.0,
        "ax": 0.1,
        "ay": 0.4,
        "f0": (0.9, 0.6, 0.3),
        "f82": (1, 1, 1),
        "eta": (0.5, 0.5, 0.5),
        "k": (3, 3, 3),
        "diffuse": "LAMBERT",
        "horizon": "HARD",
        "kd": (0, 0, 0),
        "nodes": [node for node in (color, normal) if node["image"] >= 0],
    }
    assert set(changes) <= set(plain)
    fed = {"f0_from": color["out"]} if color_image >= 0 else {}
    bumped = {"normal": normal["out"]} if normal_image >= 0 else {}
    return plain | fed | bumped | changes


def image(pixels, **changes):
    pixels = np.ascontiguousarray(pixels)
    return {
        "width": pixels.shape[1],
        "height": pixels.shape[0],
        "channels": pixels.shape[2],
        "data": pixels,
        "srgb": False,
        "wrap": "REPEAT",
        "filter": "LINEAR",
    } | changes


def mesh(positions, triangles, normals=None, uvs=None, materials=0):
    """normals and uvs per position; without normals each face has its own."""
    positions = np.asarray(positions, np.float32).reshape(-1, 3)
    corners = np.asarray(triangles, np.int32).ravel()
    if normals is None:
        a, b, c = (positions[corners[k::3]].astype(float) for k in range(3))
        face = np.cross(b - a, c - a)
        with np.errstate(invalid="ignore"):
            face /= np.linalg.norm(face, axis=1, keepdims=True)
        corner_normals = np.repeat(face, 3, axis=0)
    else:
        corner_normals = np.asarray(normals)[corners]
    return {
        "positions": positions,
        "corner_position": corners,
        "corner_normals": np.ascontiguousarray(corner_normals, np.float32),
        "corner_uvs": (
            None if uvs is None else np.ascontiguousarray(np.asarray(uvs)[corners], np.float32)
        ),
        "material": np.ascontiguousarray(np.broadcast_to(materials, len(corners) // 3), np.int32),
    }


def square(half=1.0, z=0.0, material_index=0):
    """Facing +z, u along x, v along y."""
    xy = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], float)
    return mesh(
        np.c_[half * xy, np.full(4, z)],
        [[0, 1, 2], [0, 2, 3]],
        uvs=0.5 + 0.5 * xy,
        materials=material_index,
    )


def box(low, high):
    """Closed, normals outwards, without UVs."""
    corner = np.array([[(low, high)[(i >> k) & 1][k] for k in range(3)] for i in range(8)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return mesh(corner, [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])


def sphere(rings=24, radius=1.0, center=(0, 0, 0), smooth=True):
    """UV sphere about z."""
    t, p = np.meshgrid(
        np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1), indexing="ij"
    )
    unit = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1).reshape(-1, 3)
    uvs = np.stack([p / (2 * np.pi), 1 - t / np.pi], -1).reshape(-1, 2)
    w = 2 * rings + 1
    first = (np.arange(rings)[:, None] * w + np.arange(w - 1)[None, :]).reshape(-1, 1)
    triangles = (first + np.array([0, w, w + 1, 0, w + 1, 1])).reshape(-1, 3)
    return mesh(np.add(center, radius * unit), triangles, unit if smooth else None, uvs)


def scene(**changes):
    plain = {
        "width": 16,
        "height": 16,
        "samples": 16,
        "seed": 1,
        "threads": 0,
        "transparent": True,
        "background": (0, 0, 0),
        "filter_width": 0.0,
        "camera": ortho(),
        "lights": [sun()],
        "images": [],
        "materials": [material()],
        "meshes": [square()],
        "dump": "",
        "renderer": "test",
    }
    merged = copy.copy(plain) | changes
    merged.setdefault("region", (0, 0, merged["width"], merged["height"]))
    merged.setdefault(
        "instances",
        [{"mesh": i, "matrix": np.eye(4).ravel().tolist()} for i in range(len(merged["meshes"]))],
    )
    return merged


# ---- runs


def finish(job):
    assert native.wait(job, 600)
    return native.poll(job)


def render(description):
    """The picture, (height, width, 4) from the bottom, and what poll said at the end."""
    job = native.start(description)
    state = finish(job)
    assert state["state"] == "done", state
    x0, y0, x1, y1 = description["region"]
    out = np.full((y1 - y0, x1 - x0, 4), np.nan, np.float32)
    native.image(job, out)
    native.free(job)
    assert np.isfinite(out).all()
    return out, state


def read_dump(path):
    """{channel: (height, width) float32 from the bottom}, and the header's JSON."""
    file = oiio.ImageInput.open(str(path))
    assert file is not None, oiio.geterror()
    spec = file.spec()
    pixels = np.asarray(file.read_image("float")).reshape(spec.height, spec.width, spec.nchannels)
    file.close()
    planes = {name: pixels[::-1, :, i] for i, name in enumerate(spec.channelnames)}
    return planes, spec.getattribute("libshade")


def dump(description, path):
    render(description | {"dump": str(path), "samples": 1})
    return read_dump(path)


def vectors(planes, name, parts="XYZ"):
    return np.stack([planes[f"{name}.{p}"] for p in parts], -1).astype(float)


# ---- truth: Ashikhmin and Shirley 2000 with the lobe carried by `rotate` (method.md, section 2)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def ashikhmin_shirley(n, wi, wo, ex, ey, f0):
    """f cos, RGB. Directions in the frame x = tangent, z = normal; ex > ey."""
    n, wi, wo = (unit(np.asarray(v, float)) for v in (n, wi, wo))
    h = unit(wi + wo)
    x = unit(np.stack([n[..., 2], 0 * n[..., 0], -n[..., 0]], -1))  # along the displaced surface
    y = np.cross(n, x)
    hx, hy, hz = ((h * axis).sum(-1) for axis in (x, y, n))
    r = hx**2 + hy**2
    e = np.where(r > 0, (ex * hx**2 + ey * hy**2) / np.where(r > 0, r, 1), 0)
    d = np.sqrt((ex + 1) * (ey + 1)) / (2 * np.pi) * np.abs(hz) ** e
    to_light, to_eye, ho = (n * wi).sum(-1), (n * wo).sum(-1), (h * wo).sum(-1)
    lit = (to_light > 0) & (to_eye > 0) & (wi[..., 2] > 0) & (wo[..., 2] > 0)
    fresnel = np.asarray(f0) + (1 - np.asarray(f0)) * (1 - ho[..., None]) ** 5
    f = d / (4 * ho * np.where(lit, np.maximum(to_light, to_eye), 1))
    return fresnel * np.where(lit, f * to_light, 0)[..., None]
