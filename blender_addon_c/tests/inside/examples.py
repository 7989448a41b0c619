# SPDX-License-Identifier: GPL-3.0-or-later
"""Scripts of examples, each as its command runs it, a few pixels of it: examples.py FOLDER SCRIPT..."""

import os
import runpy
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

folder, *scripts = common.arguments()
sys.dont_write_bytecode = True  # beside an example


@bpy.app.handlers.persistent
def hasty(scene, *_):
    """Whatever the script renders."""
    scene.render.resolution_percentage, scene.libshade.samples, scene.cycles.samples = 2, 1, 1


bpy.app.handlers.render_init.append(hasty)
for script in scripts:
    name = os.path.basename(os.path.dirname(script))
    made = os.path.join(folder, name + (".blend" if name == "suzanne" else ".png"))
    sys.argv = [script, "--", made]
    runpy.run_path(script, run_name="__main__")
    if name == "suzanne":
        bpy.ops.wm.open_mainfile(filepath=made)
        common.render(os.path.join(folder, "suzanne.png"))
common.finish()
