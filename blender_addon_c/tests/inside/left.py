# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on leaves in Blender once it is disabled, or installed again over itself: asserts that it is nothing.
argument: the zip"""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

zip_file, = common.arguments()


def handlers():
    return {name: [getattr(f, "__module__", "") for f in getattr(bpy.app.handlers, name)]
            for name in dir(bpy.app.handlers) if isinstance(getattr(bpy.app.handlers, name), list)}


def everything():
    """By kind, all that an add-on can leave: classes, properties, what menus draw, handlers, engines of panels, manuals."""
    found = {"manuals": len(bpy.utils._manual_map), "handlers": [f"{name} {owner}" for name, owners in handlers().items() for owner in owners],
             "libraries": [library.path for library in bpy.context.preferences.filepaths.asset_libraries]}
    for base in ("Panel", "Operator", "Menu", "PropertyGroup", "RenderEngine", "AddonPreferences", "Node", "NodeTree", "UIList", "Header"):
        classes = [cls for cls in getattr(bpy.types, base).__subclasses__() if getattr(cls, "is_registered", True)]
        found[base] = sorted(f"{cls.__module__}.{cls.__name__}" for cls in classes if hasattr(bpy.types, cls.__name__))
        found[base + " for"] = sorted(cls.__name__ for cls in classes if "LIBSHADE" in getattr(cls, "COMPAT_ENGINES", ()))
    for name in dir(bpy.types):
        kind = getattr(bpy.types, name)
        functions = getattr(getattr(kind, "draw", None), "_draw_funcs", ())
        if functions:
            found["drawn in " + name] = sorted(f"{f.__module__}.{f.__qualname__}" for f in functions)
    for owner in ("Scene", "ViewLayer", "Object", "Material", "World", "Light", "Camera", "Mesh", "WindowManager"):
        found["of " + owner] = sorted(getattr(bpy.types, owner).bl_rna.properties.keys())
    return found


def told(before, after):
    """What of ours there is more, but for the classes of nodes, which 3.4 keeps: it would crash where they are in use."""
    for key in sorted(after):
        was = before.get(key, ())
        if isinstance(was, int):
            more = [] if after[key] == was else [after[key]]
        else:
            more = [item for item in after[key] if item not in was]
        if not key.endswith(" for") and not isinstance(was, int):
            more = [item for item in more if "libshade" in str(item).lower()]
        if key == "Node" and bpy.app.version < (5, 0):
            more = []
        if more:
            print("LEFT", key, more)
            yield key


def enable():
    bpy.ops.preferences.addon_enable(module=common.MODULE)
    assert everything()["Panel for"], "not enabled"


def disable():
    bpy.ops.preferences.addon_disable(module=common.MODULE)


def install():
    if bpy.app.version < (4, 2):
        bpy.ops.preferences.addon_install(filepath=zip_file, overwrite=True)
    else:
        bpy.ops.extensions.package_install_files(filepath=zip_file, repo="user_default", enable_on_install=False, overwrite=True)


def files():
    folder = os.path.dirname(sys.modules[common.MODULE].__file__)
    return sorted(os.path.relpath(os.path.join(at, name), folder) for at, _, names in os.walk(folder) for name in names
                  if not name.endswith(".pyc"))


disable()
before, wrong = everything(), []
for _ in range(2):
    enable()
    disable()
    wrong += told(before, everything())
enable()
was = files()
stale = os.path.join(os.path.dirname(sys.modules[common.MODULE].__file__), "of_an_older_version.py")
with open(stale, "w") as file:
    file.write("raise RuntimeError\n")
install()
enable()
assert files() == was, set(files()) ^ set(was)
disable()
wrong += told(before, everything())
assert not wrong, wrong
print("all asserted", flush=True)
common.finish()
