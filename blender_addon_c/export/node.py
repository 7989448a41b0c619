# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that feed closures, by their type: each is tested by test_blender_nodes or _semantics."""

from . import (
    node_color, node_curve, node_fresnel, node_image, node_normal, node_occlusion, node_place, node_scratches, node_stand_in,
    node_texture, node_tiling)

NODES = {**node_place.NODES, **node_image.NODES, **node_normal.NODES, **node_color.NODES,
         **node_fresnel.NODES, **node_texture.NODES, **node_curve.NODES, **node_stand_in.NODES,
         **node_scratches.NODES, **node_occlusion.NODES, **node_tiling.NODES}
