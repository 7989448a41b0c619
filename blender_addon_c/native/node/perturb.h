/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A colour as a tangent-space normal: `color`, three operands, and `strength`, one, as Cycles'
 * Normal Map node has them; `tangent`, four operands, of another UV map than the mesh's own: a
 * direction in world space and its handedness. Writes `out`, a normal in the shading frame;
 * `below`: it may be below its horizon. */
#ifndef LIBSHADE_NODE_PERTURB_H
#define LIBSHADE_NODE_PERTURB_H

#include "node/common.h"

typedef struct node_perturb {
  operand color[3], strength, tangent[4];
  bool own; /* the tangent is the shading frame's */
  bool below;
  int out[3];
} node_perturb;

static inline bool node_perturb_read(reader *r, node_perturb *n, graph *g) {
  n->own = !reader_has(r, "tangent");
  n->below = false;
  return reader_may_flag(r, "below", &n->below) &&
         (n->own || graph_operands(r, g, "tangent", 4, n->tangent)) &&
         graph_operands(r, g, "color", 3, n->color) &&
         graph_operands(r, g, "strength", 1, &n->strength) && graph_outputs(r, g, "out", 3, n->out);
}

/* x and y times the strength, z mixed towards 1 by a strength below 1; turned as an image's normal
 * is (normal_map.h) and, as that one, not below the horizon. */
typedef struct perturb_lanes {
  const float *color[3], *force, *tangent[4];
} perturb_lanes;

LEAF void perturb(bool own, const node_perturb *n, lane_run g, const corners *restrict corner,
                  const surfaces *restrict point, perturb_lanes in, inputs *at) {
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
  const float lowest = n->below ? -1e6f : 1e-4f;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float strength = clampf(in.force[i], 0.0f, 1e6f), side = point->side[i];
    float x = clampf(2.0f * in.color[0][i] - 1.0f, -1e6f, 1e6f) * strength * side;
    float y = clampf(2.0f * in.color[1][i] - 1.0f, -1e6f, 1e6f) * strength;
    float z = 1.0f + clampf(strength, 0.0f, 1.0f) * (2.0f * in.color[2][i] - 2.0f);
    z = clampf(z, lowest, 1e6f);
    if (own) {
      y *= corner->handed[i];
    } else { /* x and y along the tangent and across it: where there is none, they are 0 */
      vec3 t = {in.tangent[0][i], in.tangent[1][i], in.tangent[2][i]};
      float tx = dot(t, load(&point->t, i)), ty = dot(t, load(&point->b, i));
      float square = tx * tx + ty * ty;
      bool good = square > 1e-12f;
      float scale = good ? 1.0f / sqrtf(good ? square : 1.0f) : 0.0f;
      float across = y * in.tangent[3][i], along = x;
      x = scale * (along * tx - across * ty);
      y = scale * (along * ty + across * tx);
      z = good ? z : 1.0f;
    }
    float square = x * x + y * y + z * z;
    z = square > 1e-12f ? z : 1.0f;
    float inverse = 1.0f / sqrtf(square > 1e-12f ? square : 1.0f);
    nx[i] = x * inverse;
    ny[i] = y * inverse;
    nz[i] = z * inverse;
  }
}

LEAF void node_perturb_run(const node_perturb *n, lane_run g, const corners *corner,
                           const surfaces *point, inputs *at) {
  perturb_lanes in = {.force = lane_of(at, n->strength, 3, g)};
  for (int k = 0; k < 3; k++)
    in.color[k] = lane_of(at, n->color[k], k, g);
  for (int k = 0; !n->own && k < 4; k++)
    in.tangent[k] = lane_of(at, n->tangent[k], 4 + k, g);
  if (n->own)
    perturb(true, n, g, corner, point, in, at);
  else
    perturb(false, n, g, corner, point, in, at);
}

#endif
