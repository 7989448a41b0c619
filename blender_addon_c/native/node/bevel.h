/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mean normal of the object's surfaces as far as `radius`, one operand, about the point: as of
 * a round edge. By `samples` rays, which `render/bevel.c` casts before the node runs. Writes `out`,
 * a unit vector in world space, as Cycles' Bevel node does. */
#ifndef LIBSHADE_NODE_BEVEL_H
#define LIBSHADE_NODE_BEVEL_H

#include "node/geometry.h"

enum { BEVEL_SAMPLES = 128 };

typedef struct node_bevel {
  int samples, out[3];
  operand radius;
} node_bevel;

static inline bool node_bevel_read(reader *r, node_bevel *n, graph *g) {
  g->features->object_info = g->features->occlusion = true;
  return reader_integer(r, "samples", 1, BEVEL_SAMPLES, &n->samples) &&
         graph_operands(r, g, "radius", 1, &n->radius) && graph_outputs(r, g, "out", 3, n->out);
}

/* Where no ray met anything, the surface's own. */
LEAF void node_bevel_run(const node_bevel *n, lane_run g, const corners *corner,
                         const surfaces *restrict point, inputs *restrict at) {
  const lane_v *sum = at->around ? at->around : &point->n;
  float *x = at->at[n->out[0]], *y = at->at[n->out[1]], *z = at->at[n->out[2]];
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 v = load(sum, i), own = load(&point->n, i);
    float square = dot(v, v);
    bool some = square > 1e-12f;
    v = scaled(v, 1.0f / sqrtf(some ? square : 1.0f));
    x[i] = some ? v.x : own.x;
    y[i] = some ? v.y : own.y;
    z[i] = some ? v.z : own.z;
  }
}

#endif
