# SPDX-License-Identifier: Apache-2.0
"""shade_mesh_tangents against Blender's calc_tangents, corner by corner."""
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

COST = 2.3

HERE = Path(__file__).resolve().parent
LIBSHADE = HERE.parent
MESHES = ["suzanne", "sphere", "torus", "flat_suzanne", "cylinder_with_hard_edges",
          "mirrored_suzanne", "custom_normals", "degenerate_uvs"]


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    blender = shutil.which("blender")
    if not blender:
        pytest.fail("blender is not installed: make setup-blender")
    folder = tmp_path_factory.mktemp("tangents")
    subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "3",
                    "-P", HERE / "export_tangents.py", "--", folder],
                   check=True, stdout=subprocess.DEVNULL)
    subprocess.run([os.environ.get("CC", "cc"), "-std=c11", "-O2", f"-I{LIBSHADE}/include",
                    HERE / "tangents_driver.c", LIBSHADE / "src/tangents.c", "-lm",
                    "-o", folder / "driver"], check=True)
    return folder


@pytest.mark.parametrize("mesh", MESHES)
def test_agrees_with_blender(exported, mesh):
    with open(exported / f"{mesh}.in", "rb") as given:
        result = subprocess.run([exported / "driver"], stdin=given, check=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    ours = np.frombuffer(result.stdout, np.float32).reshape(-1, 4)
    theirs = np.fromfile(exported / f"{mesh}.out", np.float32).reshape(-1, 4)
    assert len(ours) == len(theirs) >= 3 * 100
    # Blender leaves corners without any UV direction at zero or at an axis of its own.
    has_uv = np.repeat(np.fromfile(exported / f"{mesh}.area", np.float32) != 0, 3)
    ours, theirs = ours[has_uv], theirs[has_uv]
    assert len(ours) > 0.9 * len(has_uv)
    np.testing.assert_allclose(np.linalg.norm(ours[:, :3], axis=1), 1, atol=1e-6)
    cosine = (ours[:, :3].astype(float) * theirs[:, :3]).sum(1)
    angle = np.degrees(np.arccos(np.clip(cosine / np.linalg.norm(theirs[:, :3], axis=1), -1, 1)))
    share = np.mean(angle <= 0.5)
    print(f"{mesh}: {len(ours)} corners, {100 * share:.3f} % within 0.5 degrees, "
          f"worst {angle.max():.3f}; {result.stderr.decode().strip()}")
    assert share >= 0.99
    assert (ours[:, 3] == theirs[:, 3]).all()
    if mesh == "mirrored_suzanne":
        assert len(np.unique(ours[:, 3])) == 2
