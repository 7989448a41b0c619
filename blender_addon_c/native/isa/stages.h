/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All stages in their order, for the one translation unit of each instruction set. */
#include "stage/stage.h"

#include "stage/camera.h"
#include "stage/cone.h"
#include "stage/hit.h"
#include "stage/route.h"
#include "stage/surface.h"
#include "stage/node.h"
#include "stage/light.h"
#include "stage/through.h"
#include "stage/sky.h"
#include "stage/emitters.h"
#include "stage/closure.h"
#include "stage/aim.h"
#include "stage/walk.h"
#include "stage/film.h"

#define LIGHT_FUNCTION(TYPE, name) stage_##name,
#define CHOSEN_FUNCTION(TYPE, name) stage_chosen_##name,
#define WEIGH_FUNCTION(TYPE, name) stage_weigh_##name,
#define MEET_FUNCTION(TYPE, name) stage_meet_##name,
#define NODE_FUNCTION(TYPE, name) stage_##name,
#define CLOSURE_FUNCTION(TYPE, name, always) stage_##name,
#define ALBEDO_FUNCTION(TYPE, name, always) stage_albedo_##name,
#define DRAW_FUNCTION(TYPE, name, always) stage_draw_##name,
#define STAGE_TABLE(isa)                                                                           \
  const stage_table stages_##isa = {.name = #isa,                                                  \
                                    .camera = stage_camera,                                        \
                                    .lens = stage_lens,                                            \
                                    .locate = stage_locate,                                        \
                                    .cover = stage_cover,                                          \
                                    .gather = stage_gather,                                        \
                                    .corner = stage_corner,                                        \
                                    .place = stage_place,                                          \
                                    .surface = stage_surface,                                      \
                                    .lift = stage_lift,                                            \
                                    .stretch = stage_stretch,                                      \
                                    .pixel_cone = stage_pixel_cone,                                \
                                    .width = stage_width,                                          \
                                    .spread = stage_spread,                                        \
                                    .pixel = stage_pixel,                                          \
                                    .footprint = stage_footprint,                                  \
                                    .carry = stage_carry,                                          \
                                    .depart = stage_depart,                                        \
                                    .route = stage_route,                                          \
                                    .trail = stage_trail,                                          \
                                    .route_shadow = stage_route_shadow,                            \
                                    .identify = stage_identify,                                    \
                                    .flat = stage_flat,                                            \
                                    .node = {NODE_TABLE(NODE_FUNCTION)},                           \
                                    .pair = stage_pair,                                            \
                                    .light = {LIGHT_TABLE(LIGHT_FUNCTION)},                        \
                                    .chosen = {LIGHT_TABLE(CHOSEN_FUNCTION)},                      \
                                    .weigh = {LIGHT_TABLE(WEIGH_FUNCTION)},                        \
                                    .settle = stage_settle,                                        \
                                    .add = stage_add,                                              \
                                    .choose = stage_choose,                                        \
                                    .meet = {LIGHT_TABLE(MEET_FUNCTION)},                          \
                                    .weigh_emitters = stage_weigh_emitters,                        \
                                    .lit_by_emitters = stage_lit_by_emitters,                      \
                                    .met_emitters = stage_met_emitters,                            \
                                    .sky = stage_sky,                                              \
                                    .sky_pdf = stage_sky_pdf,                                      \
                                    .sky_draw = stage_sky_draw,                                    \
                                    .missed = stage_missed,                                        \
                                    .lit_by_sky = stage_lit_by_sky,                                \
                                    .met_sky = stage_met_sky,                                      \
                                    .lit = stage_lit,                                              \
                                    .stopped = stage_stopped,                                      \
                                    .sift = stage_sift,                                            \
                                    .pass = stage_pass,                                            \
                                    .tint = stage_tint,                                            \
                                    .shadow = stage_shadow,                                        \
                                    .closure = {CLOSURE_TABLE(CLOSURE_FUNCTION)},                  \
                                    .albedo = {CLOSURE_TABLE(ALBEDO_FUNCTION)},                    \
                                    .chance = stage_chance,                                        \
                                    .share = stage_share,                                          \
                                    .emit = stage_emit,                                            \
                                    .join_all = stage_join_all,                                    \
                                    .pick = stage_pick,                                            \
                                    .kind = stage_kind,                                            \
                                    .exclude = stage_exclude,                                      \
                                    .forbid = stage_forbid,                                        \
                                    .spare = stage_spare,                                          \
                                    .take = stage_take,                                            \
                                    .join = stage_join,                                            \
                                    .uncover = stage_uncover,                                      \
                                    .end = stage_end,                                              \
                                    .mute = stage_mute,                                            \
                                    .reflect = stage_reflect,                                      \
                                    .shuffled = stage_shuffled,                                    \
                                    .draw = {CLOSURE_TABLE(DRAW_FUNCTION)},                        \
                                    .aim = stage_aim,                                              \
                                    .aim_pick = stage_aim_pick,                                    \
                                    .aim_turn = stage_aim_turn,                                    \
                                    .aim_mix = stage_aim_mix,                                      \
                                    .aim_take = stage_aim_take,                                    \
                                    .walk = stage_walk,                                            \
                                    .blur = stage_blur,                                            \
                                    .gain = stage_gain,                                            \
                                    .escape = stage_escape,                                        \
                                    .scatter = stage_scatter,                                      \
                                    .film = stage_film}
