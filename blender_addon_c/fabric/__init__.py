# SPDX-License-Identifier: GPL-3.0-or-later
"""Libshade Fabric: what the rest of the add-on, the makers of its assets and scripts take of it."""

from ..names import FABRIC
from .node import TRANSLUCENCY, cloths, register, settings, socket_rules, unregister
