# SPDX-License-Identifier: AGPL-3.0-or-later
"""Renders small scenes with the patched POV-Ray and reads pictures and dumps.

POVRAY names the program (default build/povray/povray), SHADE libshade's tool
(build/shade), POVRAY_UNPATCHED a POV-Ray as Debian has it (povray).
"""
import functools
import itertools
import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = Path(__file__).resolve().parents[2]


def program(variable, default):
    name = os.environ.get(variable, str(default))
    found = shutil.which(name)
    if found is None:
        pytest.fail(f"{name}: no such program; make it, or set {variable}")
    return os.path.abspath(found)


@pytest.fixture(scope="session")
def povray():
    return program("POVRAY", ROOT / "build/povray/povray")


@pytest.fixture(scope="session")
def unpatched():
    return program("POVRAY_UNPATCHED", "povray")


@pytest.fixture(scope="session")
def shade():
    return program("SHADE", ROOT / "build/shade")


def read_channels(path):
    """All channels of an image as {name: float32 array of shape (height, width)}, and its spec."""
    image = oiio.ImageInput.open(str(path))
    assert image is not None, f"{path}: {oiio.geterror()}"
    spec = image.spec()
    pixels = np.asarray(image.read_image("float")).reshape(spec.height, spec.width, spec.nchannels)
    image.close()
    return {name: pixels[..., i] for i, name in enumerate(spec.channelnames)}, spec


class Dump:
    """A LIBSHADE_DUMP: P, N, T, Ns, V of shape (h, w, 3); L, E, S of shape (lights, h, w, 3)."""

    def __init__(self, path):
        channels, spec = read_channels(path)
        self.path = path
        self.header = json.loads(spec.getattribute("libshade"))
        self.id = channels["material.ID"].astype(int)
        self.hit = self.id >= 0
        for name in ("P", "N", "T", "Ns", "V"):
            setattr(self, name, np.stack([channels[f"{name}.{c}"] for c in "XYZ"], -1).astype(float))
        self.uv = np.stack([channels["uv.U"], channels["uv.V"]], -1).astype(float)
        self.color = np.stack([channels[f"Color.{c}"] for c in "RGB"], -1).astype(float)
        self.lights = sum(name.endswith(".L.X") for name in channels)
        for name, components in (("L", "XYZ"), ("E", "RGB"), ("S", "RGB")):
            setattr(self, name, np.array([[channels[f"light{k}.{name}.{c}"] for c in components]
                                          for k in range(self.lights)]).transpose(0, 2, 3, 1).astype(float)
                    if self.lights else np.zeros((0,) + self.hit.shape + (3,)))
        self.channels = channels

    def only(self, mask):
        """A dump of these pixels alone, in a file beside it."""
        image = oiio.ImageBuf(str(self.path))
        pixels = image.get_pixels(oiio.FLOAT)
        names = image.spec().channelnames
        pixels[~mask] = 0
        pixels[~mask, names.index("material.ID")] = -1
        image.set_pixels(image.roi, np.ascontiguousarray(pixels))
        path = Path(self.path).with_suffix(".only.exr")
        assert image.write(str(path)), image.geterror()
        return Dump(path)


class Result:
    def __init__(self, status, log, image, dump):
        self.status, self.log, self.image_path, self.dump_path = status, log, image, dump

    @functools.cached_property
    def dump(self):
        return Dump(self.dump_path)

    @property
    def channels(self):
        """Of the picture, by name."""
        return read_channels(self.image_path)[0]

    @property
    def image(self):
        """Linear RGB, half precision."""
        channels = self.channels
        return np.stack([channels[c] for c in "RGB"], -1).astype(float)

    @property
    def message(self):
        """The log in one line: POV-Ray folds long messages."""
        return " ".join(self.log.split())


@pytest.fixture
def render(povray, tmp_path):
    """render(scene, size=(w, h), options=[…], dump=True | False | path, fails=False) -> Result"""

    count = itertools.count()

    def run(scene, size=(64, 48), options=(), dump=True, fails=False):
        number = next(count)
        image, dump = f"image{number}.exr", dump if isinstance(dump, str) else f"dump{number}.exr" if dump else ""
        (tmp_path / "scene.pov").write_text(scene)
        environment = dict(os.environ, LIBSHADE_DUMP=dump)
        done = subprocess.run([povray, "+Iscene.pov", f"+O{image}", "+FE", f"+W{size[0]}", f"+H{size[1]}", "-D", "-P",
                               "-V", *options], cwd=tmp_path, env=environment, text=True, errors="replace",
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300)
        log = done.stdout.split("OpenEXR Project.")[-1].split("Contributors to the OpenEXR")[-1]  # without the long greeting
        result = Result(done.returncode, log, tmp_path / image, tmp_path / dump)
        assert done.returncode >= 0, f"killed by signal {-done.returncode}:\n{log}"
        if not fails:
            assert done.returncode == 0, log
        return result

    return run


@pytest.fixture
def shade_check(shade):
    """Passes a dump to `shade check`; returns its report."""

    def check(dump, tolerance=5e-5, everything=True):
        done = subprocess.run([shade, "check", str(dump.path), "--tolerance", str(tolerance), *(["--all"] if everything else [])],
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        assert done.returncode == 0, done.stdout
        return done.stdout

    return check
