# SPDX-License-Identifier: GPL-3.0-or-later
"""Update the add-on of a running Blender 3.4 from its zip: what ran goes on, whole, and the preferences say so. arguments: ZIP"""

import os
import sys
from types import SimpleNamespace

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common


def drawn():
    """What the preferences say."""
    said = []
    row = SimpleNamespace(label=lambda text, icon="": said.append(text),
                          operator=lambda name, text="", icon="": SimpleNamespace())
    here = SimpleNamespace(layout=SimpleNamespace(label=row.label, row=lambda: row, prop=lambda *_told: None))
    sys.modules[common.MODULE + ".assets"].LibshadePreferences.draw(here, bpy.context)
    return said


path, = common.arguments()
common.enable()
node = common.metal()[2]
assert not any("Updated" in text for text in drawn())
bpy.ops.preferences.addon_disable(module=common.MODULE)
common.enable()
assert not any("Updated" in text for text in drawn())  # only switched off and on
before = {name: id(module) for name, module in sys.modules.items() if name.startswith(common.MODULE + ".")}
bpy.ops.preferences.addon_install(filepath=path, overwrite=True)
start = sys.modules[common.MODULE].__file__
with open(start, encoding="utf-8") as file:
    text = file.read()
assert "import kept" in text
with open(start, "w", encoding="utf-8") as file:
    file.write(text.replace("import kept", "import kept, something_new"))
try:
    for _again in range(2):
        bpy.ops.preferences.addon_enable(module=common.MODULE)
        assert [text for text in drawn() if "Updated" in text] == ["Updated: until Blender is started again the version before runs"]
        assert before == {name: id(module) for name, module in sys.modules.items() if name.startswith(common.MODULE + ".")}
        node.ex = 300
        assert common.metal("more")[2].inputs["Roughness"].default_value > 0 and hasattr(bpy.types.Scene, "libshade")
        bpy.ops.preferences.addon_disable(module=common.MODULE)
finally:  # others start what is installed here
    with open(start, "w", encoding="utf-8") as file:
        file.write(text)
common.finish()
