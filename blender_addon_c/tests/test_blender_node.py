# SPDX-License-Identifier: GPL-3.0-or-later
"""The metal and the cloth node: their properties, their files, and what other renderers make of them."""

import subprocess

import numpy as np
import pytest

from blender_runs import BUILD, Dump, difference, rgba

COST = 18


def test_node(blender, tmp_path):
    text = blender.inside("node.py", tmp_path / "node.blend")
    assert "all asserted" in text


@pytest.mark.parametrize("converted", [False, True])
def test_cycles_renders_it(blender, tmp_path, converted):
    """Cycles sees an anisotropic metal: as node, and as plain group, the same picture."""
    blender.scene("cycles", tmp_path, converted=converted, dump="")
    picture = rgba(tmp_path / "picture.exr")
    blender.scene("cycles", tmp_path, converted="anisotropic", dump="")
    anisotropic = rgba(tmp_path / "picture.exr")
    assert anisotropic[..., :3].max() > 0.5
    assert difference(picture, anisotropic) < 1e-6


def test_without_the_add_on(blender, tmp_path):
    """A converted file shows in Cycles what it showed with the add-on; else 3.4 shows black, as the manual says."""
    blender.inside("shared.py", tmp_path, "with")
    blender.run("shared.py", tmp_path, "without")
    made, converted = ([rgba(tmp_path / f"{what}_{how}.exr")[..., :3] for how in ("with", "without")]
                       for what in ("made", "converted"))
    for with_it in made[0], converted[0]:
        halves = np.split(with_it, 2, axis=1)
        assert all(half.mean() > 0.05 for half in halves) and abs(halves[0].mean((0, 1)) - halves[1].mean((0, 1))).max() > 0.05
    assert abs(converted[0] - converted[1]).max() < 1e-5
    assert blender.version != "3.4" or made[1].max() == 0


@pytest.mark.parametrize("ggx", [False, True])
@pytest.mark.parametrize("fed", [[], ["Roughness", "Anisotropy", "Rotation", "Diffuse Color"]])
def test_sockets(blender, tmp_path, fed, ggx):
    """By our engine and by Cycles, and by the reference through the dump."""
    blender.scene("metal_sockets", tmp_path, fed=fed, ggx=ggx)
    ours, dump = rgba(tmp_path / "picture.exr"), Dump(tmp_path / "dump.exr")
    done = subprocess.run([BUILD / "shade", "check", tmp_path / "dump.exr"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert dump.hit.mean() > 0.5
    blender.scene("metal_sockets", tmp_path, fed=fed, ggx=ggx, engine="CYCLES", dump="")
    assert difference(ours, rgba(tmp_path / "picture.exr")) < 0.01


@pytest.mark.parametrize("fed", [[], ["Edge Tint"]])
def test_edge_tint(blender, tmp_path, fed):
    """Of a number and of an image, by the reference through the dump."""
    told = {}
    for edge in (True, False):
        blender.scene("metal_sockets", tmp_path, fed=fed, edge=edge)
        done = subprocess.run([BUILD / "shade", "check", tmp_path / "dump.exr"], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        told[edge] = rgba(tmp_path / "picture.exr")
    assert difference(told[True], told[False]) > 1e-4  # the eye is far from 82 degrees


@pytest.mark.parametrize("engine", ["LIBSHADE", "CYCLES"])
def test_color_of_a_preset(blender, tmp_path, engine):
    """What an artist gives a measured metal's Color is seen, as an F82 of that colour; else it is the measured one, by its index
    in our engine and as before in Cycles."""
    def picture(**options):
        blender.scene("metal_preset", tmp_path, engine=engine, dump="", **options)
        return rgba(tmp_path / "picture.exr")
    measured, blue = picture(by=""), picture(by="socket")
    assert difference(measured, picture(by="", kept=True)) < 1e-6
    assert difference(blue, picture(by="f82")) < 1e-6 and difference(blue, measured) > 0.3


def test_cloth(blender, tmp_path):
    """The reference agrees with the first plate; the second, whose colours vary, is not in the dump."""
    _told, text = blender.scene("cloth", tmp_path)
    done = subprocess.run([BUILD / "shade", "check", tmp_path / "dump.exr"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    dump = Dump(tmp_path / "dump.exr")
    assert np.ptp(dump["uv"][..., 0][dump.hit]) == pytest.approx(8, rel=0.1) and dump.hit[:, :24].all()
    assert not dump.hit[:, 24:].any() and "more than one metal or cloth" in text
    picture = rgba(tmp_path / "picture.exr")
    assert 0.9 < picture[:, 26:46, 3].mean() < 0.99 and (picture[:, 2:22, 3] == 1).all()
    light, dark = picture[4:-4, 38:46, :3].mean((0, 1)), picture[4:-4, 26:34, :3].mean((0, 1))
    assert (light > 4 * dark).all() and (dark > 0).all()
    # Cycles too, about as bright
    ours = picture[4:-4, 4:20, :3].mean((0, 1))
    blender.scene("cloth", tmp_path, engine="CYCLES", dump="")
    theirs = rgba(tmp_path / "picture.exr")[4:-4, 4:20, :3].mean((0, 1))
    assert (np.abs(np.log(theirs / ours)) < np.log(1.5)).all(), (ours, theirs)
