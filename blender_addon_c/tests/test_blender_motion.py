# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open, and cameras that see around them, against the Cycles of the same Blender."""

import numpy as np
import pytest

from blender_runs import averaged, read_picture, rgba

COST = 11


# Noise is .003 to .006; without blur, its curve or its steps .03 to .2 are missing.
CASES = {
    "shape": {"what": ["moving_shape"]},
    "all": {"what": ["moving_camera", "zooming_camera", "moving_object", "moving_shape"], "position": "END", "frame": 3,
            "shutter": 0.7, "curve": [(0, 0), (1, 1)], "object": {"motion_steps": 3}},
    "lines": {"what": ["moving_camera", "moving_object"], "rolling": 0.3, "curve": [(0, 0), (1, 1)],
              "border": (0.1, 0.25, 0.9, 0.8)},
}


@pytest.mark.parametrize("case", CASES)
def test_motion_blur(blender, tmp_path, case):
    pictures = []
    for engine, samples in ("LIBSHADE", 128), ("CYCLES", 192):
        blender.scene("moving", tmp_path, dump="", engine=engine, samples=samples, **CASES[case])
        pictures.append(averaged(tmp_path / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"{case}: relative error {apart:.4f}, means {ours.mean():.4f} {theirs.mean():.4f}")
    assert theirs.mean() > 0.05 and apart < 0.01


def test_what_cannot_be_blurred(blender, tmp_path):
    """Points that come and go, places that are no numbers: seen as in the middle, and named."""
    _, text = blender.scene("moving", tmp_path, engine="LIBSHADE", samples=4, what=["no_motion"], dump="")
    assert np.isfinite(rgba(tmp_path / "picture.exr")).all()
    for said in ("'Sphere': its mesh is not of the same points", "'far': its place is not always a number",
                 "'Cube' moves too far, or to no size"):
        assert said in text
    told, text = blender.scene("moving", tmp_path, engine="LIBSHADE", samples=4, what=["moving_object"])
    assert "a dump has no motion blur" in text and told["frame"] == 2


def test_vectors(blender, tmp_path):
    """In pixels, of camera, objects and shapes from a frame before to one after; with blur there are none."""
    what = ["moving_camera", "moving_object", "moving_shape"]
    if blender.version > "4":  # before, Cycles says something else of a camera that zooms
        what += ["zooming_camera"]

    def vectors(**options):
        _, text = blender.scene("moving", tmp_path, dump="", what=what,
                                passes=["vector", "z"], position="CENTER", **options)
        names, pixels = read_picture(tmp_path / "picture.exr")
        return np.stack([pixels[..., next(k for k, name in enumerate(names) if name.endswith(f"Vector.{axis}"))]
                         for axis in "XYZW"], -1).astype(float), text

    (ours, _), (theirs, _) = (vectors(engine=engine, samples=16, blur=False) for engine in ("LIBSHADE", "CYCLES"))
    apart = np.abs(ours - theirs).max(-1)
    print(f"of {np.abs(theirs).mean():.2f} pixels, {np.abs(theirs).max():.1f} at most: {np.median(apart):.4f} apart")
    assert np.abs(theirs).mean() > 2 and all(np.abs(theirs[..., k]).max() > 1 for k in range(4))
    assert np.quantile(apart, 0.8) < 0.05  # the rest are outlines, whose samples are chance
    none, text = vectors(engine="LIBSHADE", samples=4)
    assert (none == 0).all() and "the Vector pass is empty" in text


# ---- panoramas: each pixel is the direction that it shows

WIDE = {"width": 48, "height": 24, "shift_x": 0.06, "shift_y": -0.04}
AROUND = {
    "EQUIRECTANGULAR": {**WIDE, "longitude_min": -2.5, "longitude_max": 1.9, "latitude_min": -0.7},
    "EQUIANGULAR_CUBEMAP_FACE": {"width": 24, "height": 24},
    "MIRRORBALL": {"width": 24, "height": 24},
    "FISHEYE_EQUIDISTANT": {**WIDE, "fisheye_fov": 4.0},
    "FISHEYE_EQUISOLID": {"width": 24, "height": 40, "fisheye_fov": 3.0, "shift_x": -0.05, "shift_y": 0.1},
    "FISHEYE_LENS_POLYNOMIAL": {"width": 48, "height": 24, "fisheye_fov": 0.8, "sensor_fit": "VERTICAL"},
    "CENTRAL_CYLINDRICAL": {**WIDE, "central_cylindrical_range_u_max": 1.0, "central_cylindrical_radius": 0.8},
}


@pytest.mark.parametrize("kind", AROUND)
def test_directions(blender, tmp_path, kind):
    if kind == "CENTRAL_CYLINDRICAL" and blender.version < "5":
        return  # there is none
    pictures = []
    for engine in "LIBSHADE", "CYCLES":
        blender.scene("around", tmp_path, dump="", engine=engine, kind=kind, **AROUND[kind])
        pictures.append(rgba(tmp_path / "picture.exr").astype(float))
    ours, theirs = pictures
    outside = theirs[..., 0] == 0
    assert outside.any() == (kind in ("MIRRORBALL", "FISHEYE_EQUIDISTANT", "FISHEYE_EQUISOLID", "FISHEYE_LENS_POLYNOMIAL"))
    assert ((ours[..., 0] == 0) == outside).all() and (ours[..., 3] == 1).all()
    # both pixel filters are .01 wide; towards its rim a ball shows much of the world in a pixel
    assert np.abs(ours - theirs)[~outside].max() < (0.01 if kind == "MIRRORBALL" else 2e-3)


def test_depth_of_field(blender_new, tmp_path):
    """A lens of three blades and ratio 2, and what moves meanwhile."""
    pictures = []
    for engine, samples in ("LIBSHADE", 128), ("CYCLES", 192):
        blender_new.scene("moving", tmp_path, dump="", engine=engine, samples=samples, what=["moving_object"],
                        panorama={"panorama_type": "EQUIRECTANGULAR", "longitude_min": -1.0, "longitude_max": 1.0,
                                  "latitude_min": -0.9, "latitude_max": 0.5},
                        lens={"aperture_fstop": 0.1, "aperture_blades": 3, "aperture_ratio": 2.0,
                              "focus_distance": 3.0, "aperture_rotation": 0.4})
        pictures.append(averaged(tmp_path / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"relative error {apart:.4f}, means {ours.mean():.4f} {theirs.mean():.4f}")
    assert theirs.mean() > 0.05 and apart < 0.01


def test_a_lens_of_another_width_than_height(blender_new, tmp_path):
    """Ratio 4: all that is out of focus is blurred up and down, as in Cycles, and hardly to the sides; by three blades, turned."""
    pictures = []
    for engine, samples in ("LIBSHADE", 256), ("CYCLES", 256):
        blender_new.scene("moving", tmp_path, dump="", engine=engine, samples=samples, what=["moving_object"], blur=False,
                        lens={"aperture_fstop": 0.05, "aperture_ratio": 4.0, "focus_distance": 2.0, "aperture_blades": 3, "aperture_rotation": 1.2})
        pictures.append(averaged(tmp_path / "picture.exr"))
    ours, theirs = pictures
    apart = np.abs(ours - theirs).mean() / theirs.mean()
    print(f"relative error {apart:.4f}")
    assert apart < 0.007  # turned the other way .015
