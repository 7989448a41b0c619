# SPDX-License-Identifier: GPL-3.0-or-later
"""Install the add-on from a zip as a user would. arguments: ZIP"""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common

path, = common.arguments()
if bpy.app.version >= (4, 2):
    bpy.ops.extensions.package_install_files(filepath=path, repo="user_default",
                                             enable_on_install=True)
else:
    bpy.ops.preferences.addon_install(filepath=path)
    bpy.ops.preferences.addon_enable(module=common.MODULE)
assert common.MODULE in bpy.context.preferences.addons
assert hasattr(bpy.types.Scene, "libshade")
common.finish()
