/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/emitters.h"
#include "stage/light.h"
#include "stage/sky.h"

STAGES(light) = {
    .light = {LIGHT_TABLE(LIGHT_DRAW)},
    .chosen = {LIGHT_TABLE(LIGHT_CHOSEN)},
    .weigh = {LIGHT_TABLE(LIGHT_WEIGH)},
    .hit_light = {LIGHT_TABLE(LIGHT_HIT)},
    .pair = stage_pair,
    .place_samples = stage_place_samples,
    .add = stage_add,
    .choose = stage_choose,
    .weigh_emitters = stage_weigh_emitters,
    .lit_by_emitters = stage_lit_by_emitters,
    .hit_emitters = stage_hit_emitters,
    .sky = stage_sky,
    .sky_pdf = stage_sky_pdf,
    .sky_draw = stage_sky_draw,
    .missed = stage_missed,
    .lit_by_sky = stage_lit_by_sky,
    .hit_sky = stage_hit_sky,
    .lit = stage_lit,
    .shadow = stage_shadow,
};
