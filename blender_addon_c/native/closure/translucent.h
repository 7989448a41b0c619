/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A matt surface lit from behind: light goes through it and leaves evenly, as from Lambert's. What
 * it lets through is its weight. `normal`. */
#ifndef LIBSHADE_CLOSURE_TRANSLUCENT_H
#define LIBSHADE_CLOSURE_TRANSLUCENT_H

#include "closure/common.h"

typedef struct closure_translucent {
  int normal[3];
} closure_translucent;

static inline bool closure_translucent_read(reader *r, closure_translucent *c, graph *g) {
  return graph_normal(r, g, c->normal);
}

LEAF unsigned closure_translucent_eval(const closure_translucent *c, lane_run run,
                                       const surfaces *restrict at, inputs *given,
                                       const lane_v *restrict wi, bool density,
                                       reflections *restrict out) {
  (void)density, (void)at;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 l = load(wi, i);
    float below = -dot(normal_at(given, c->normal, i), l);
    bool lit = (below > 0.0f) & (l.z < 0.0f);
    float f = lit ? 0.318309886f : 0.0f;
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = lit ? below : 0.0f;
    out->pdf[i] = lit ? below * 0.318309886f : 0.0f;
  }
  return 0;
}

LEAF unsigned closure_translucent_draw(const closure_translucent *c, lane_run run,
                                       const surfaces *restrict at, inputs *given,
                                       draws *restrict out) {
  (void)at;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float below;
    vec3 l =
        cosine_about(scaled(normal_at(given, c->normal, i), -1.0f), out->x[i], out->y[i], &below);
    bool lit = (below > 0.0f) & (l.z < 0.0f);
    float f = lit ? 0.318309886f : 0.0f;
    store(&out->wi, i, l);
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = below;
    out->pdf[i] = lit ? below * 0.318309886f : 0.0f;
  }
  return 0;
}

LEAF void closure_translucent_albedo(const closure_translucent *c, lane_run run, const surfaces *at,
                                     inputs *given, float *out) {
  (void)c, (void)at, (void)given;
  for (size_t i = run.begin; i < run.end; i++)
    out[i] = 1.0f;
}

#endif
