/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/cone.h"
#include "stage/hit.h"
#include "stage/route.h"
#include "stage/surface.h"

STAGES(surface) = {
    .locate = stage_locate,
    .cover = stage_cover,
    .gather = stage_gather,
    .corner = stage_corner,
    .scatter = stage_scatter,
    .place = stage_place,
    .surface = stage_surface,
    .lift = stage_lift,
    .uv_width = stage_uv_width,
    .stretch = stage_stretch,
    .pixel_cone = stage_pixel_cone,
    .width = stage_width,
    .spread = stage_spread,
    .pixel = stage_pixel,
    .footprint = stage_footprint,
    .carry = stage_carry,
    .route_begin = stage_route_begin,
    .route_hit = stage_route_hit,
    .route_next = stage_route_next,
    .route_shadow = stage_route_shadow,
    .identify = stage_identify,
    .flat = stage_flat,
};
