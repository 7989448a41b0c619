# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender knows the engine and its nodes by."""

ENGINE = "LIBSHADE"
METAL, FABRIC, SCRATCHES = "LibshadeMetalNode", "LibshadeFabricNode", "LibshadeScratchesNode"
