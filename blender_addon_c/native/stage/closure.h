/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each closure's stages, from its file. */
#include "closure/closure.h"
#include "stage/stage.h"

#define CLOSURE_STAGE(TYPE, name, always)                                                          \
  static unsigned stage_##name(const closure *c, lane_run run, const surfaces *at, inputs *given,  \
                               const lane_v *wi, bool density, reflections *out) {                 \
    return closure_##name##_eval(&c->of.name, run, at, given, wi, density, out);                   \
  }                                                                                                \
  static unsigned stage_draw_##name(const closure *c, lane_run run, const surfaces *at,            \
                                    inputs *given, draws *out) {                                   \
    return closure_##name##_draw(&c->of.name, run, at, given, out);                                \
  }                                                                                                \
  static void stage_albedo_##name(const closure *c, lane_run run, const surfaces *at,              \
                                  inputs *given, float *out) {                                     \
    closure_##name##_albedo(&c->of.name, run, at, given, out);                                     \
  }

#define CLOSURE_EVAL(TYPE, name, always) [CLOSURE_##TYPE] = stage_##name,
#define CLOSURE_DRAW(TYPE, name, always) [CLOSURE_##TYPE] = stage_draw_##name,
#define CLOSURE_ALBEDO(TYPE, name, always) [CLOSURE_##TYPE] = stage_albedo_##name,
