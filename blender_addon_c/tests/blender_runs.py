# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of Blenders with the add-on installed from the zip, and what they write.

Old is the system's, new PyPI's bpy for its Python: 3.4 and 5.0 on Debian 12, 4.3 and 5.2 on Debian 13. Others go by their version.
"""

import functools
import json
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
ZIP = BUILD / "libshade-blender.zip"
BPY = BUILD / "venv-bpy/bin/python"
DEBIAN13 = BUILD / "debian13"  # a system to change root into: setup/debian13.sh
INSIDE = Path(__file__).resolve().parent / "inside"

# Paths are the same inside. The mounts go with their namespace.
IN_DEBIAN13 = """root=$1 places=$2
shift 2
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
printf '%s' "$places" | while IFS= read -r place; do
  mkdir -p "$root$place"
  mount --bind "$place" "$root$place"
done
exec chroot "$root" "$@"
"""
NAMESPACE = ["unshare", *(["--map-root-user"] if os.geteuid() else []), "--mount", "--pid", "--fork", "--kill-child"]


def measured(version):
    """Which of the versions that tables of tests have numbers for is like it."""
    return "3.4" if version < "4" else "5.0"


class Missing(Exception):
    """A Blender that is not on this machine."""


@functools.cache
def _system_version():
    program = shutil.which("blender")
    said = program and subprocess.run([program, "--version"], capture_output=True, text=True, check=False).stdout
    found = re.match(r"Blender (\d+\.\d+)", said or "")
    return found and found[1]


def _bpy_version(venv):
    return next((folder.name for folder in venv.glob("lib/python3*/site-packages/bpy/[0-9]*")), None)


def find(which):
    """(version, words that start it, the system it is in) of "old", "new" or of a version."""
    if _system_version() and which in ("old", _system_version()):
        return _system_version(), [shutil.which("blender"), "-b", "--factory-startup", "--python-exit-code", "3", "-P"], None
    environments = [BPY.parents[1]]
    if which != "new":
        environments += [*BUILD.glob("venv-bpy-*"), *DEBIAN13.glob("opt/bpy-*")]
    for environment in environments:
        version = _bpy_version(environment)
        if version and which in ("new", version):
            if DEBIAN13 not in environment.parents:
                return version, [str(environment / "bin/python")], None
            if subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False).returncode:
                raise Missing(f"Blender {which} is in {DEBIAN13}: this machine lets nobody make a mount namespace")
            return version, [f"/{environment.relative_to(DEBIAN13)}/bin/python"], DEBIAN13.resolve()
    raise Missing(f"Blender {which} is not here: {DEBIAN13} has some, where setup/debian13.sh could make it")


class Blender:
    """One version of Blender with a home of its own."""

    def __init__(self, which, home, zip_file=ZIP):
        self.version, self._command, system = find(which)
        self._env = {name: value for name, value in os.environ.items()
                     if not name.startswith(("LIBSHADE_", "BLENDER_", "PYTHON"))}
        self.module = "libshade" if self.version < "4.2" else "bl_ext.user_default.libshade"
        self._env["LIBSHADE_MODULE"] = self.module
        if system:
            places = sorted({ROOT, Path(tempfile.gettempdir()).resolve(), home.resolve().parent})  # what holds others first
            self._command = [*NAMESPACE, "sh", "-ec", IN_DEBIAN13, "sh",
                             str(system), "".join(f"{place}\n" for place in places), *self._command]
            self._env |= {"HOME": str(home), "LC_ALL": "C.UTF-8"}
        for what in ("config", "scripts", "extensions"):
            (home / what).mkdir(parents=True)
            self._env[f"BLENDER_USER_{what.upper()}"] = str(home / what)
        self._studio = None  # one process that renders scene after scene
        self.run("install.py", zip_file)

    def _words(self, script, *arguments):
        return [str(word) for word in (*self._command, INSIDE / script, "--", *arguments)]

    def inside(self, script, *arguments):
        """Run inside/`script` in the process that renders scenes, from an empty file; returns all it printed."""
        return self._ask("script", "", {"script": script, "arguments": [str(word) for word in arguments]})[1]

    def run(self, script, *arguments, env=None, prefix=(), status=0, stdin="", seconds=300):
        """Run inside/`script` in a process of its own: of a second or more; returns all it printed. status None: any."""
        done = subprocess.run([*prefix, *self._words(script, *arguments)], input=stdin,
                              env=self.environment(env), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace",
                              timeout=seconds, check=False)
        assert status is None or done.returncode == status, done.stdout[-4000:]
        return done.stdout

    def environment(self, more=None):
        return {**self._env, **(more or {})}

    def scene(self, name, folder, env=None, prefix=(), **options):
        """Render scene `name` of inside/scenes.py: (what it told, all it printed).

        Writes picture.exr and dump.exr into the folder; dump="" asks for none.
        """
        dump = options.pop("dump", str(folder / "dump.exr"))
        options = {"picture": str(folder / "picture.exr"), **options}
        if env or prefix:
            request = {"name": name, "dump": dump, "options": options}
            text = self.run("scenes.py", env=env, prefix=prefix, stdin=json.dumps(request) + "\n")
            return json.loads(re.search(r"^TOLD (.*)$", text, re.M).group(1)), text
        return self._ask(name, dump, options)

    def _ask(self, name, dump, options):
        """(what it told, all it printed)."""
        if not self._studio or self._studio.poll() is not None:
            self._studio = subprocess.Popen(
                self._words("scenes.py"), env=self.environment(), text=True,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        print(json.dumps({"name": name, "dump": dump, "options": options}), file=self._studio.stdin, flush=True)
        text = ""
        for line in self._studio.stdout:
            if line.startswith("TOLD "):
                return json.loads(line[5:]), text
            text += line
        raise AssertionError(text[-4000:])

    def close(self):
        if self._studio:
            self._studio.stdin.close()
            self._studio.wait(60)


def read_picture(path):
    """(channel names, float32 array of height × width × channels, top row first), of all parts."""
    names, parts = [], []
    for part in range(oiio.ImageBuf(str(path)).nsubimages):
        picture = oiio.ImageBuf(str(path), part, 0)
        pixels = picture.get_pixels(oiio.FLOAT)
        assert not picture.has_error, picture.geterror()
        names += picture.spec().channelnames
        parts.append(pixels)
    return names, np.concatenate(parts, axis=-1)


def rgba(path):
    return read_picture(path)[1]


class Dump:
    """Channels of a dump by name: dump["P"] is height × width × 3."""

    def __init__(self, path):
        self._names, self._pixels = read_picture(path)

    def __getitem__(self, name):
        suffixes = {"uv": "UV", "material": ["ID"]}.get(
            name, "RGB" if name.split(".")[-1] in ("E", "S", "Color") else "XYZ")
        planes = [self._pixels[..., self._names.index(f"{name}.{s}")] for s in suffixes]
        return planes[0] if len(planes) == 1 else np.stack(planes, axis=-1)

    @property
    def hit(self):
        return self["material"] >= 0


def by_turns(name, cases, of_versions=lambda case: False):
    """A parametrization by Blender and `name`, or names: each case in one of them, which run the same renderer; in both those that an export
    makes for each version in its own way. `make soak` asks all of both."""
    both = "BOTH" in os.environ
    pairs = [(version, *(case if isinstance(case, tuple) else (case,))) for version in ("old", "new") for turn, case in enumerate(cases)
             if both or of_versions(case) or turn % 2 == (version == "new")]
    return pytest.mark.parametrize(f"blender, {name}", pairs, indirect=["blender"])


ENGINES = "CYCLES", "LIBSHADE"  # in a scene's option `engines`: one file for both


def by_each(folder, read=rgba):
    """(Cycles' picture, ours) of such a scene."""
    return [read(folder / f"{engine}.exr") for engine in ENGINES]


def difference(a, b):
    """Mean absolute difference over mean, of linear RGB."""
    return np.abs(a - b)[..., :3].mean() / b[..., :3].mean()


def averaged(path):
    """Means of 4 x 4 pixels."""
    pixels = rgba(path)[..., :3].astype(float)
    height, width = (side // 4 for side in pixels.shape[:2])
    return pixels[:4 * height, :4 * width].reshape(height, 4, width, 4, 3).mean((1, 3))
