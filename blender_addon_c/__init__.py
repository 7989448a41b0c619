# SPDX-License-Identifier: GPL-3.0-or-later
"""libshade: anisotropic metals whose microfacets follow the bumped normal."""

bl_info = {
    "name": "libshade",
    "description": "Anisotropic metal, cloth and scratches: engine and nodes",
    "author": "libshade",
    "version": (0, 3, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine; Shader Editor > Add",
    "category": "Render",
}

import os

# An update in a running Blender 3.4 runs this file again, over what it left, but none of the others, whose nodes are in use:
# then all that ran goes on.
updated = "_MODULES" in globals() and globals().get("__time__") != os.path.getmtime(__file__) or globals().get("updated", False)

if not updated:
    from . import assets, cycles_settings, engine, fabric, groove, manual, menus, nodes, panels, properties, report, saved, scratches, studio
    from .export import kept

    _MODULES = (properties, cycles_settings, nodes, fabric, groove, scratches, menus, kept, engine, report, saved, studio, panels, assets, manual)


def register():
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
