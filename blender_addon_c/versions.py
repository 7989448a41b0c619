# SPDX-License-Identifier: GPL-3.0-or-later
"""What a version of Blender does that another does not, a row each: since which one, or before which one. 3.4 and 5.0 are measured
in Cycles; of those between only what a row names. What merely has another name there is asked for where it is used, by hasattr."""

import bpy


def _since(*version):
    return bpy.app.version >= version


def _before(*version):
    return bpy.app.version < version


# ---- Blender
NODES_UNREGISTER = _since(5, 0)  # 3.4 crashes when it frees the evaluated copy of a node whose class is gone
ALWAYS_NODES = _since(5, 0)  # materials and worlds cannot do without, and asking them is deprecated
LONG_PASS_NAMES = _since(5, 0)  # whole words
MORE_TO_DENOISE = _since(5, 2)  # passes of denoising data, in another order [not asked of 5.1]
MUTED_AOVS_SPEAK = _since(5, 0)  # AOV Output nodes that are muted write all the same
GROUP_VALUES_COUNT = _since(5, 0)  # of group sockets that feed a normal or a texture's place, and that nothing feeds
BARE_IS_PRINCIPLED = _since(4, 0)  # what has no material has a Principled BSDF, not a matt surface

# ---- closures
BUMPS_FADE = _before(3, 5)  # light so low that bumps turn matt facets to it [Chiang2019]; later they shade it [Estevez2019]
MATT_LEANS = _since(4, 0)  # matt surfaces' normals lean away from the horizon, they do not fade there
JOINT_SHADOWING = _since(4, 0)  # Smith's, of both directions together
TOON_OVERCOUNTS = _before(4, 0)  # of Toon BSDFs that are glossy
ENERGY_OREN_NAYAR = _since(4, 3)  # rough Diffuse BSDFs are EON, not Oren and Nayar's
FILM_ON_METAL = _since(5, 0)  # of a Principled BSDF
SHINES_BELOW_0 = _since(5, 2)  # Emission Strength of a Principled BSDF takes light away [not asked of 5.1]
SHADOWS_STOP = _since(4, 0)  # by Transparent Shadows (off) [4.2]; 3.4's paths make up for most of it
TRANSPARENT_LESS = _since(5, 0)  # paths go through one surface less than shadow rays [4.2, 4.5]

# ---- nodes
NORMAL_MAPS_MIX = _before(3, 5)  # unit normals, by their strength, which later multiplies slopes
DISPLACED_CLOSELY = _since(4, 2)  # displacement that bumps is looked at a tenth of a pixel aside, not a whole one
NORMALS_STAY_ACROSS = _since(5, 0)  # surfaces, where Vector Transform turns them and objects are scaled unevenly
NOISE_CLAMPED = _before(4, 0)  # Roughness of Noise Texture, to 1
VORONOI_BY_WHOLE = _since(5, 0)  # numbers cells draw from
OLD_IES = _before(4, 0)  # horizontal angles go round (later cubics end at the first and mirror about the last); unlinked, Vector is the normal
LATER_SKY = _since(5, 0)  # of Nishita's
ALPHA_AS_SAID = _since(5, 2)  # by an image's mode alone colours are multiplied by alpha, or divided, unbounded [not asked of 5.1]

# ---- lights
OLD_LAMPS = _before(3, 5)  # areas have 4 / pi of their power, spots dim by the cosine to their axis, suns are flat discs
LAMPS_STAND_STILL = _before(4, 0)  # points of a lamp's own are those of the world, and it has no UV map
LAMPS_ALONE = _before(4, 4)  # what instances a lamp hides it from nothing [4.2]
CATCHERS_TWICE = _before(4, 0)  # shadow catchers, in ambient occlusion, and in light groups at all; not 4.2
