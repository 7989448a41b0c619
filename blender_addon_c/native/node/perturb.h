/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A colour as a tangent-space normal: `color`, three operands, and `strength`, one, as Cycles'
 * Normal Map node has them. Writes `out`, a normal in the shading frame. */
#ifndef LIBSHADE_NODE_PERTURB_H
#define LIBSHADE_NODE_PERTURB_H

#include "node/common.h"

typedef struct node_perturb {
  operand color[3], strength;
  int out[3];
} node_perturb;

static inline bool node_perturb_read(reader *r, node_perturb *n, graph *g) {
  return graph_operands(r, g, "color", 3, n->color) &&
         graph_operands(r, g, "strength", 1, &n->strength) && graph_outputs(r, g, "out", 3, n->out);
}

static inline bool node_perturb_build(node_perturb *n, const node_place *place) {
  (void)n, (void)place;
  return true;
}

/* x and y times the strength, z mixed towards 1 by a strength below 1; turned as an image's normal
 * is (normal_map.h) and, as that one, never below the horizon. */
LEAF void node_perturb_run(const node_perturb *n, lane_run g, const corners *corner,
                           const surfaces *point, inputs *at) {
  const float *red = lane_of(at, n->color[0], 0, g), *green = lane_of(at, n->color[1], 1, g);
  const float *blue = lane_of(at, n->color[2], 2, g), *force = lane_of(at, n->strength, 3, g);
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float strength = clampf(force[i], 0.0f, 1e6f);
    float x = clampf(2.0f * red[i] - 1.0f, -1e6f, 1e6f) * strength;
    float y = clampf(2.0f * green[i] - 1.0f, -1e6f, 1e6f) * strength;
    float z = 1.0f + clampf(strength, 0.0f, 1.0f) * (2.0f * blue[i] - 2.0f);
    z = clampf(z, 1e-4f, 1e6f);
    float inverse = 1.0f / sqrtf(x * x + y * y + z * z);
    nx[i] = x * point->side[i] * inverse;
    ny[i] = y * corner->handed[i] * inverse;
    nz[i] = z * inverse;
  }
}

#endif
