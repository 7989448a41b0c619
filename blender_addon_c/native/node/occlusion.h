/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of the hemisphere about `normal`, weighted by the cosine, is free of surfaces as far as
 * `distance`, one operand: by `samples` rays, which `render/occlusion.c` casts before the node
 * runs. `inside`: of the hemisphere below; `local`: of the object's own surfaces. Writes `out`, one
 * number: 1 where nothing is, as Cycles' Ambient Occlusion node does. */
#ifndef LIBSHADE_NODE_OCCLUSION_H
#define LIBSHADE_NODE_OCCLUSION_H

#include "node/common.h"

enum { OCCLUSION_SAMPLES = 128 };

typedef struct node_occlusion {
  int samples, normal[3], out;
  operand distance;
  bool inside, local;
} node_occlusion;

static inline bool node_occlusion_read(reader *r, node_occlusion *n, graph *g) {
  n->inside = n->local = false;
  g->features->object_info = g->features->occlusion = true;
  return reader_integer(r, "samples", 1, OCCLUSION_SAMPLES, &n->samples) &&
         graph_operands(r, g, "distance", 1, &n->distance) &&
         reader_may_flag(r, "inside", &n->inside) && reader_may_flag(r, "local", &n->local) &&
         graph_normal(r, g, n->normal) && graph_outputs(r, g, "out", 1, &n->out);
}

LEAF void node_occlusion_run(const node_occlusion *n, lane_run g, const corners *corner,
                             const surfaces *restrict point, inputs *restrict at) {
  const float *stopped = at->stopped;
  const float share = 1.0f / (float)n->samples;
  float *out = at->at[n->out];
  (void)corner, (void)point;
  for (size_t i = g.begin; !stopped && i < g.end; i++)
    out[i] = 1.0f;
  if (!stopped)
    return;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++)
    out[i] = 1.0f - share * stopped[i];
}

#endif
