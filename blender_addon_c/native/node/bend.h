/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A normal in the shading frame, which may be below it, as Cycles' closures take it: bent until the
 * eye's mirror image is not below the facet. `normal`, three operands. Writes `out`. */
#ifndef LIBSHADE_NODE_BEND_H
#define LIBSHADE_NODE_BEND_H

#include "batch/valid.h"
#include "node/bump.h"

typedef struct node_bend {
  operand normal[3];
  int out[3];
} node_bend;

static inline bool node_bend_read(reader *r, node_bend *n, graph *g) {
  return graph_operands(r, g, "normal", 3, n->normal) && graph_outputs(r, g, "out", 3, n->out);
}

LEAF void node_bend_run(const node_bend *n, lane_run g, const corners *corner,
                        const surfaces *restrict point, inputs *restrict at) {
  const float *x = lane_of(at, n->normal[0], 0, g), *y = lane_of(at, n->normal[1], 1, g);
  const float *z = lane_of(at, n->normal[2], 2, g);
  float *ox = at->at[n->out[0]], *oy = at->at[n->out[1]], *oz = at->at[n->out[2]];
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 own = {x[i], y[i], z[i]}, v = load(&point->wo, i);
    vec3 flat = in_frame(point, i, geometry_true_normal(point, i));
    float facet = dot(flat, v), along = dot(own, flat), seen = dot(own, v);
    bool low = 2.0f * seen * along - facet < least_image(facet);
    vec3 to = select3(low, valid_normal(own, flat, scaled(v, -1.0f), facet, along), own);
    float square = dot(to, to);
    bool good = (square > 0.25f) & (square < 4.0f); /* false for NaN */
    ox[i] = good ? to.x : 0.0f;
    oy[i] = good ? to.y : 0.0f;
    oz[i] = good ? to.z : 1.0f;
  }
}

#endif
