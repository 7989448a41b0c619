/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shines evenly to both sides: its weight is the radiance. No direction is drawn by it. Or `holds`:
 * black, and as much of the picture as its weight says shows nothing there. */
#ifndef LIBSHADE_CLOSURE_EMISSION_H
#define LIBSHADE_CLOSURE_EMISSION_H

#include "closure/common.h"

typedef struct closure_emission {
  bool holds;
} closure_emission;

static inline bool closure_emission_read(reader *r, closure_emission *c, graph *g) {
  if (!reader_may_flag(r, "holds", &c->holds))
    return false;
  g->traits |= c->holds ? CLOSURE_HOLDS : CLOSURE_EMITS;
  return true;
}

LEAF unsigned closure_emission_eval(const closure_emission *c, lane_run run, const surfaces *at,
                                    inputs *given, const lane_v *wi, bool density,
                                    reflections *out) {
  (void)c, (void)at, (void)given, (void)wi, (void)density;
  for (size_t i = run.begin; i < run.end; i++)
    out->f.r[i] = out->f.g[i] = out->f.b[i] = out->cosine[i] = out->pdf[i] = 0.0f;
  return 0;
}

LEAF unsigned closure_emission_draw(const closure_emission *c, lane_run run, const surfaces *at,
                                    inputs *given, draws *out) {
  (void)c, (void)at, (void)given;
  for (size_t i = run.begin; i < run.end; i++)
    out->pdf[i] = 0.0f;
  return 0;
}

LEAF void closure_emission_albedo(const closure_emission *c, lane_run run, const surfaces *at,
                                  inputs *given, float *out) {
  (void)c, (void)at, (void)given;
  for (size_t i = run.begin; i < run.end; i++)
    out[i] = 0.0f;
}

#endif
