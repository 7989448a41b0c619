# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Scratches: what the rest of the add-on, the makers of its assets and scripts take of it."""

from ..names import SCRATCHES
from .field import PRESETS, apply_preset
from .images import bake, drop, is_stale, tile_of_images
from .node import register, unregister
