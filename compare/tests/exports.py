# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender on a scene: for each change of a list, the scene anew, changed and exported. Arguments:
CHANGES.json OUT; each goes to OUT/<its number>, and what kept one from being written to OUT/said.json.
"""
import json
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import export_povray  # noqa: E402

changes, out = sys.argv[sys.argv.index("--") + 1:]
said = []
for number, change in enumerate(json.load(open(changes, encoding="utf-8"))):
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    exec(change)
    try:
        export_povray.export(os.path.join(out, str(number)))
        said.append("")
    except export_povray.ExportError as error:
        said.append(str(error))
with open(os.path.join(out, "said.json"), "w", encoding="utf-8") as file:
    json.dump(said, file)
