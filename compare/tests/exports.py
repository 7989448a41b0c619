# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender on a scene: for each change of a list, the scene anew, changed and exported. Arguments:
CHANGES.json OUT; each goes to OUT/<its number>, and what kept one from being written to OUT/said.json. OUT/ends.json has
(exit status, text) of the script by how it is called.
"""
import contextlib
import io
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
ends = {}
for words in ([], ["-h"], ["--help"], ["--folder"], ["a", "b"]):
    sys.argv, told, status = ["blender", "--", *words], io.StringIO(), 0
    with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
        try:
            export_povray.main()
        except SystemExit as ended:
            status = ended.code
    ends[" ".join(words)] = status, told.getvalue()
with open(os.path.join(out, "ends.json"), "w", encoding="utf-8") as file:
    json.dump(ends, file)
