# SPDX-License-Identifier: Apache-2.0
"""Where the programs under comparison are, and how they are called."""
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"
HERE = Path(__file__).resolve().parent
# for `import shade`, after this one: our own module (docs/library/python.md), on the library in build/
sys.path.insert(0, str(ROOT / "libshade" / "python"))

BLENDER = os.environ.get("BLENDER", "blender")
POVRAY = os.environ.get("POVRAY", str(BUILD / "povray" / "povray"))
SHADE = os.environ.get("SHADE", str(BUILD / "shade"))
# What Blender needs to find the add-on that `make blender` leaves in build/.
ADD_ON = {"BLENDER_USER_SCRIPTS": str(BUILD / "blender")}


def blender(script, *arguments, scene=None, add_on=True):
    """Command line that runs a script inside Blender; a Python error gives exit status 9."""
    command = [BLENDER, "-b", "--factory-startup"]
    command += ["--addons", "libshade"] if add_on else []
    command += [str(scene)] if scene else []
    return [*command, "--python-exit-code", "9", "-P", str(script), "--", *map(str, arguments)]
