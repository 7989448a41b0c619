/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/aim.h"
#include "stage/list.h"
#include "stage/through.h"
#include "stage/path.h"

STAGES(paths) = {
    .stopped = stage_stopped,
    .sift = stage_sift,
    .pass = stage_pass,
    .tint = stage_tint,
    .chance = stage_chance,
    .share = stage_share,
    .emit = stage_emit,
    .join_all = stage_join_all,
    .pick = stage_pick,
    .kind = stage_kind,
    .exclude = stage_exclude,
    .forbid = stage_forbid,
    .shadow_roulette = stage_shadow_roulette,
    .take = stage_take,
    .join = stage_join,
    .uncover = stage_uncover,
    .end = stage_end,
    .mute = stage_mute,
    .reflect = stage_reflect,
    .shuffled = stage_shuffled,
    .aim = stage_aim,
    .aim_pick = stage_aim_pick,
    .aim_turn = stage_aim_turn,
    .aim_mix = stage_aim_mix,
    .aim_take = stage_aim_take,
    .next_paths = stage_next_paths,
    .blur = stage_blur,
    .gain = stage_gain,
    .escape = stage_escape,
};
