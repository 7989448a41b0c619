/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All stages in their order, for the one translation unit of each instruction set. */
#include "stage/stage.h"

#include "stage/camera.h"
#include "stage/hit.h"
#include "stage/surface.h"
#include "stage/bump.h"
#include "stage/light.h"
#include "stage/shade.h"
#include "stage/film.h"

#define LIGHT_FUNCTION(TYPE, name) stage_##name,
#define STAGE_TABLE(isa)                                                                           \
  const stage_table stages_##isa = {.name = #isa,                                                  \
                                    .camera = stage_camera,                                        \
                                    .locate = stage_locate,                                        \
                                    .gather = stage_gather,                                        \
                                    .corner = stage_corner,                                        \
                                    .surface = stage_surface,                                      \
                                    .bilinear = stage_bilinear,                                    \
                                    .bump = stage_bump,                                            \
                                    .tint = stage_tint,                                            \
                                    .pair = stage_pair,                                            \
                                    .light = {LIGHT_TABLE(LIGHT_FUNCTION)},                        \
                                    .lit = stage_lit,                                              \
                                    .shadow = stage_shadow,                                        \
                                    .reflect = stage_reflect,                                      \
                                    .scatter = stage_scatter,                                      \
                                    .film = stage_film}
