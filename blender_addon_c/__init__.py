# SPDX-License-Identifier: GPL-3.0-or-later
"""libshade: anisotropic metals whose microfacets follow the bumped normal."""

bl_info = {
    "name": "libshade",
    "description": "Anisotropic metal, cloth and scratches: engine and nodes",
    "author": "libshade",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine; Shader Editor > Add",
    "category": "Render",
}

from . import assets, cycles_settings, engine, fabric, groove, manual, menus, nodes, panels, properties, report, scratches
from .export import kept

_MODULES = (properties, cycles_settings, nodes, fabric, groove, scratches, menus, kept, engine, report, panels, assets, manual)


def register():
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
