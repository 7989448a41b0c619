# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes kept once for many instances: the picture is that of copies, in a fraction of the memory."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from native_scenes import dump, image, look_at, material, registers, render, scene, sphere, square, sun

COST = 2.5

COPIES, RINGS = 60, 24  # 130,000 triangles in all: more than are copied


def matrices(count, kind):
    """Turned, stretched or mirrored, side by side."""
    rng = np.random.default_rng(5)
    out = []
    for i in range(count):
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turn[:, 0] *= np.sign(np.linalg.det(turn))
        if kind == "mirrored":
            turn[:, 1] *= -1
        size = rng.uniform(0.5, 1.5, 3) if kind == "stretched" else np.full(3, rng.uniform(0.7, 1.3))
        m = np.eye(4)
        m[:3, :3] = 0.12 * turn * size
        m[:3, 3] = (i % 8 / 4 - 0.875, i // 8 / 4 - 0.875, rng.uniform(-0.2, 0.2))
        out.append(m)
    return out


def place(placed, mesh, shared):
    """The same picture by one mesh, or by as many as there are instances."""
    floor, rest = square(2.0, z=-0.5), [mesh] if shared else [mesh] * len(placed)
    identity = np.eye(4).ravel().tolist()
    instances = [{"mesh": 1 if shared else 1 + i, "matrix": m.ravel().tolist()}
                 for i, m in enumerate(placed)]
    bumps = np.float32(np.random.default_rng(2).uniform(0.35, 0.65, (8, 8, 3)))
    bumps[..., 2] = 1
    return scene(meshes=[floor, *rest], instances=[{"mesh": 0, "matrix": identity}, *instances],
                 images=[image(bumps)], materials=[material(normal_image=0, detail="ROTATE")],
                 lights=[sun((0.4, 0.2, 1))], width=64, height=64, samples=4)


def test_an_instance_that_rays_cannot_be_turned_into():
    """So flat, and seen from so far, that in its space a ray's numbers would be too large."""
    flat, far = np.diag((0.5, 0.5, 1e-9, 1.0)), look_at((0, 0, 1e12), (0, 0, 0))
    given = place([*matrices(COPIES, "turned"), flat], sphere(RINGS), True)
    given["camera"] = {**given["camera"], "matrix": far.ravel().tolist(), "clip": (1, 2e12)}
    y, x = (np.mgrid[:64, :64] - 31.5) / 32
    assert (render(given)[0][np.hypot(x, y) < 0.45][:, 3] == 1).all()


@pytest.mark.parametrize("lens", [{}, {"lens": (3e38, 3e38), "focus": 1e-6, "blades": 0, "turn": 0.0}])
def test_a_camera_that_is_too_far_away(lens):
    """Its rays' numbers are too large for Embree: it sees nothing, and nothing breaks."""
    far = look_at((0, 0, 1), (0, 0, 0))
    far[2, 3] = 3e38
    camera = {**scene()["camera"], "matrix": far.ravel().tolist(), "clip": (0, 1e30), **lens}
    assert np.isfinite(render(scene(camera=camera))[0]).all()


@pytest.mark.parametrize("kind", ["turned", "stretched", "mirrored"])
def test_shared_mesh_is_shaded_as_copies_are(kind, tmp_path):
    placed = matrices(COPIES, kind)
    ball = sphere(RINGS)
    planes = [dump(place(placed, ball, shared), tmp_path / "d.exr")[0] for shared in (True, False)]
    same = np.ones_like(planes[0]["P.X"], bool)
    for axis in "XYZ":  # but for rays along an outline, which either meet it or do not
        same &= np.abs(planes[0][f"P.{axis}"] - planes[1][f"P.{axis}"]) < 1e-5
    assert same.mean() > 0.999 and (planes[1]["P.Z"] > -0.4).mean() > 0.2
    for name, plane in planes[1].items():
        if plane.dtype.kind != "f" or name.startswith("light"):
            continue
        # corners' normals and tangents are interpolated before they are stretched, not after
        limit = 0.02 if kind == "stretched" else 2e-4
        wrong = np.abs(planes[0][name] - plane)[same]
        assert np.quantile(wrong, 0.999) < limit, name


def asking():
    """Scene and material whose nodes ask for all that belongs to an object: a wave in its own space is a
    height, on a normal of another UV map than the mesh's, and the colour is its normal there."""
    step, free = 1e-3, iter(range(3, 64))
    nodes, heights = [], []

    def emit(kind, count=3, **given):
        nodes.append({"type": kind, **given, "out": [(next(free),) for _ in range(count)]})
        return nodes[-1]["out"]

    place = emit("GEOMETRY", what="POSITION")
    for what in ("", "ALONG_U", "ALONG_V"):
        here = place
        if what:
            along = emit("GEOMETRY", what=what)
            here = [emit("MATH", 1, operation="MULTIPLY_ADD", a=[a], b=[step], c=[b])[0]
                    for a, b in zip(along, place)]
        own = emit("OBJECT", what="POINT_INTO", vector=here)
        wide = emit("MATH", 1, operation="MULTIPLY", a=[own[2]], b=[6.0], c=[0.0])
        heights += emit("MATH", 1, operation="SINE", a=wide, b=[0.0], c=[0.0])
    more = [(next(free),)]
    tangent = [*emit("LAYER", layer=1, more=more), *more]
    normal = emit("PERTURB", color=[0.6, 0.45, 1.0], strength=[1.0], tangent=tangent)
    normal = emit("BUMP", height=heights, along=[step, 0.0, 0.0, step], strength=[1.0], distance=[0.01], normal=normal)
    inside = emit("OBJECT", what="NORMAL_INTO", vector=emit("GEOMETRY", what="NORMAL"))
    color = [emit("MATH", 1, operation="MULTIPLY_ADD", a=[part], b=[0.4], c=[0.5])[0] for part in inside]
    return {"layers": [{"width": 2}, {"width": 4, "tangents_of": 0}],
            "materials": [material(detail="ROTATE") | {"nodes": nodes, "normal": normal, "f0_from": color}]}


@pytest.mark.parametrize("kind", ["turned", "stretched", "mirrored"])
def test_what_nodes_ask_of_instances_is_that_of_copies(kind, tmp_path):
    """Position by u and v for bumps, layers, tangents of another UV map, the object's own space."""
    ball = sphere(RINGS)
    ball["layers"] = [{"layer": 0, "data": np.ascontiguousarray(
        ball["corner_uvs"].reshape(-1, 2) @ np.float32([[0.8, 0.6], [-0.6, 0.8]]))}]
    planes = [dump({**place(matrices(COPIES, kind), ball, shared), **asking()}, tmp_path / "d.exr")[0]
              for shared in (True, False)]
    same = planes[1]["P.Z"] > -0.4
    for axis in "XYZ":
        same &= np.abs(planes[0][f"P.{axis}"] - planes[1][f"P.{axis}"]) < 1e-5
    assert same.mean() > 0.2
    for name in ("Ns.X", "Ns.Y", "Ns.Z", "Color.R", "Color.G", "Color.B"):
        limit = 0.02 if kind == "stretched" else 5e-4
        assert np.quantile(np.abs(planes[0][name] - planes[1][name])[same], 0.998) < limit, name
    assert planes[1]["Ns.X"][same].std() > 0.1 and planes[1]["Color.R"][same].std() > 0.1


@pytest.mark.parametrize("shared", [True, False])
def test_other_instances_are_other_objects(shared):
    """A ball stops no ray about itself, and one of the same mesh is another one."""
    nodes = [{"type": "OCCLUSION", "out": registers(12, 1), "distance": [9.0], "local": True, "samples": 4}]
    shines = {"name": "open", "closure": "EMISSION", "weight": registers(12, 1) * 3, "nodes": nodes}
    given = place(matrices(COPIES, "turned"), sphere(RINGS, smooth=False), shared) | {"materials": [shines], "transparent": False}
    assert render(given)[0][..., 0].min() > 0.99


def test_paths_and_shadows_meet_instances():
    settings = {"max_bounces": 3, "background": (0.3, 0.4, 0.5)}
    seen = [render({**place(matrices(COPIES, "turned"), sphere(RINGS), shared), **settings})[0]
            for shared in (True, False)]
    assert seen[1][..., :3].std() > 0.05
    assert np.abs(seen[0] - seen[1]).mean() < 2e-3 * seen[1].mean()


@pytest.mark.parametrize("bad", [np.diag([0, 1, 1, 1]), np.diag([0, 0, 0, 1]),
                                 np.diag([1e-30, 1, 1, 1]), np.diag([1e30, 1e30, 1e30, 1])])
def test_flat_and_endless_instances_are_no_trouble(bad):
    placed = [*matrices(COPIES, "turned"), np.asarray(bad, float)]
    picture, state = render(place(placed, sphere(RINGS), True))
    assert state["state"] == "done" and np.isfinite(picture).all()


MEMORY = """
import resource, sys
sys.path.insert(0, sys.argv[1])
from test_native_instances import *
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
render(place(matrices(4000, "turned"), sphere(48), True))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def test_memory_of_many_instances():
    """4000 of 9000 triangles each: 36 million, of which 128 bytes each would be 4.6 GB."""
    done = subprocess.run([sys.executable, "-c", MEMORY, str(Path(__file__).parent)],
                          capture_output=True, text=True, timeout=300, check=True)
    megabytes = int(done.stdout.split()[-1]) / 1024
    print(f"{megabytes:.0f} MB")
    assert megabytes < 100
