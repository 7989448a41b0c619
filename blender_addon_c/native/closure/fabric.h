/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libshade's woven cloth, yarn by yarn or from afar. It takes what node CLOTH does, which has
 * prepared its hits, and `coverage`, one operand, that node's output. What is not covered is no
 * part of it. */
#ifndef LIBSHADE_CLOSURE_FABRIC_H
#define LIBSHADE_CLOSURE_FABRIC_H

#include "closure/common.h"
#include "node/cloth.h"

typedef struct closure_fabric {
  cloth_use use;
  operand coverage;
} closure_fabric;

static inline bool closure_fabric_read(reader *r, closure_fabric *c, graph *g) {
  if (!cloth_use_read(r, &c->use, g) || !graph_operands(r, g, "coverage", 1, &c->coverage))
    return false;
  const shade_fabric_params *p = &c->use.cloth->preset.fabric;
  g->exponent = fmax(fmax(p->warp.along, p->warp.across), fmax(p->weft.along, p->weft.across));
  g->traits |= c->use.cloth->through ? CLOSURE_THROUGH : 0;
  return true;
}

static inline float closure_fabric_color(const closure_fabric *c, const inputs *in, int k,
                                         size_t i) {
  const shade_fabric_params *p = &c->use.cloth->preset.fabric;
  return 0.5f * (closure_color_of(in, c->use.warp[k], p->warp.kd[k], i) +
                 closure_color_of(in, c->use.weft[k], p->weft.kd[k], i));
}

LEAF void closure_fabric_albedo(const closure_fabric *c, lane_run run, const surfaces *at,
                                inputs *given, float *out) {
  const float *coverage = lane_of(given, c->coverage, 0, run), bright = c->use.cloth->bright;
  (void)at;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    out[i] = bright * clampf(coverage[i], 0.0f, 1.0f);
}

LEAF unsigned closure_fabric_eval(const closure_fabric *c, lane_run run, const surfaces *at,
                                  inputs *given, const lane_v *wi, bool density, reflections *out) {
  const size_t i = run.begin, count = run.end - run.begin;
  const shade_fabric *fabric = c->use.cloth->fabric;
  const shade_fabric_tier tier = c->use.cloth->tier;
  const void *hits = cloth_hits(given->cloth, run, c->use.place[0].at);
  shade_fabric_lanesf in = cloth_lanes(&c->use, run, at, given, hits != NULL);
  static _Thread_local cloth_light own;
  cloth_light_in(&c->use, run, given, wi, &own, &in);
  shade_fabric_resultf result = {.size = sizeof result,
                                 .r = out->f.r + i,
                                 .g = out->f.g + i,
                                 .b = out->f.b + i,
                                 .pdf = density ? out->pdf + i : NULL};
  for (size_t k = run.begin; k < run.end; k++)
    out->cosine[k] = 1.0f; /* it is in f */
  unsigned status = hits ? shade_fabric_hits_evalf(fabric, count, hits, &in, &result)
                         : shade_fabric_eval_batchf(fabric, count, &in, tier, &result);
  return status & ~(unsigned)SHADE_BAD_INPUT; /* light from straight behind has no half vector */
}

LEAF unsigned closure_fabric_draw(const closure_fabric *c, lane_run run, const surfaces *at,
                                  inputs *given, draws *out) {
  const size_t i = run.begin, count = run.end - run.begin;
  const shade_fabric *fabric = c->use.cloth->fabric;
  const shade_fabric_tier tier = c->use.cloth->tier;
  const void *hits = cloth_hits(given->cloth, run, c->use.place[0].at);
  shade_fabric_lanesf in = cloth_lanes(&c->use, run, at, given, hits != NULL);
  static _Thread_local cloth_light own;
  in.u1 = out->x + i;
  in.u2 = out->y + i;
  in.u3 = out->choice + i;
  shade_fabric_resultf result = {.size = sizeof result,
                                 .r = out->f.r + i,
                                 .g = out->f.g + i,
                                 .b = out->f.b + i,
                                 .pdf = out->pdf + i,
                                 .wix = out->wi.x + i,
                                 .wiy = out->wi.y + i,
                                 .wiz = out->wi.z + i};
  for (size_t k = run.begin; k < run.end; k++)
    out->cosine[k] = 1.0f;
  unsigned status = hits ? shade_fabric_hits_samplef(fabric, count, hits, &in, &result)
                         : shade_fabric_sample_batchf(fabric, count, &in, tier, &result);
  cloth_light_out(&c->use, run, given, &own, &out->wi);
  return status & ~(unsigned)SHADE_NO_SAMPLE;
}

#endif
