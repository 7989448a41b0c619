/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets light through as if nothing were there: its weight says how much. */
#ifndef LIBSHADE_CLOSURE_TRANSPARENT_H
#define LIBSHADE_CLOSURE_TRANSPARENT_H

#include "closure/common.h"

typedef struct closure_transparent {
  char nothing;
} closure_transparent;

static inline bool closure_transparent_read(reader *r, closure_transparent *c, graph *g) {
  (void)r, (void)c, (void)g;
  return true;
}

LEAF unsigned closure_transparent_eval(const closure_transparent *c, lane_run run,
                                       const surfaces *at, inputs *given, const lane_v *wi,
                                       bool density, reflections *out) {
  (void)c, (void)at, (void)given, (void)wi, (void)density;
  for (size_t i = run.begin; i < run.end; i++)
    out->f.r[i] = out->f.g[i] = out->f.b[i] = out->cosine[i] = out->pdf[i] = 0.0f;
  return 0;
}

LEAF unsigned closure_transparent_draw(const closure_transparent *c, lane_run run,
                                       const surfaces *restrict at, inputs *given,
                                       draws *restrict out) {
  (void)c, (void)given;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    store(&out->wi, i, scaled(load(&at->wo, i), -1.0f));
    out->f.r[i] = out->f.g[i] = out->f.b[i] = CLOSURE_CERTAIN;
    out->cosine[i] = 1.0f;
    out->pdf[i] = CLOSURE_CERTAIN;
  }
  return 0;
}

LEAF void closure_transparent_albedo(const closure_transparent *c, lane_run run, const surfaces *at,
                                     inputs *given, float *out) {
  (void)c, (void)at, (void)given;
  for (size_t i = run.begin; i < run.end; i++)
    out[i] = 1.0f;
}

#endif
