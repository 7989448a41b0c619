/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A normal by heights, as Cycles' Bump node has it [Mikkelsen2008]: `height`, three operands, at
 * the point and two steps from there; `along`, four, these steps along u and v; `strength` and
 * `distance`; `normal`, which it bends, three operands in the shading frame. Writes `out`, a normal
 * there (`below`: or below). */
#ifndef LIBSHADE_NODE_BUMP_H
#define LIBSHADE_NODE_BUMP_H

#include "node/frame.h"

typedef struct node_bump {
  operand height[3], along[4], strength, distance, normal[3];
  int out[3];
  bool below;
} node_bump;

static inline bool node_bump_read(reader *r, node_bump *n, graph *g) {
  n->below = false;
  return reader_may_flag(r, "below", &n->below) && graph_operands(r, g, "height", 3, n->height) &&
         graph_operands(r, g, "along", 4, n->along) &&
         graph_operands(r, g, "strength", 1, &n->strength) &&
         graph_operands(r, g, "distance", 1, &n->distance) &&
         graph_operands(r, g, "normal", 3, n->normal) && graph_outputs(r, g, "out", 3, n->out);
}

LEAF vec3 in_frame(const surfaces *at, size_t i, vec3 v) {
  return (vec3){dot(v, load(&at->t, i)), dot(v, load(&at->b, i)), dot(v, load(&at->n, i))};
}

LEAF vec3 two_steps(vec3 du, vec3 dv, float u, float v) {
  return (vec3){u * du.x + v * dv.x, u * du.y + v * dv.y, u * du.z + v * dv.z};
}

/* Where the steps say nothing of the surface, the normal stays. They are scaled to an area of 1,
 * the heights with them. */
LEAF void node_bump_run(const node_bump *n, lane_run g, const corners *corner,
                        const surfaces *point, inputs *at) {
  const float *h = lane_of(at, n->height[0], 0, g), *hp = lane_of(at, n->height[1], 1, g);
  const float *hq = lane_of(at, n->height[2], 2, g), *force = lane_of(at, n->strength, 3, g);
  const float *far = lane_of(at, n->distance, 4, g), *x = lane_of(at, n->normal[0], 5, g);
  const float *y = lane_of(at, n->normal[1], 6, g), *z = lane_of(at, n->normal[2], 7, g);
  const float *pu = lane_of(at, n->along[0], 8, g), *pv = lane_of(at, n->along[1], 9, g);
  const float *qu = lane_of(at, n->along[2], 10, g), *qv = lane_of(at, n->along[3], 11, g);
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
  const float lowest = n->below ? -1e18f : 1e-4f;
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 own = {x[i], y[i], z[i]};
    vec3 du = in_frame(point, i, load(&point->du, i)), dv = in_frame(point, i, load(&point->dv, i));
    vec3 p = two_steps(du, dv, pu[i], pv[i]), q = two_steps(du, dv, qu[i], qv[i]);
    vec3 across_p = cross(q, own), across_q = cross(own, p);
    float area = dot(p, across_p), size = fabsf(area);
    bool flat = !(size > 1e-30f); /* true for NaN */
    float scale = 1.0f / (flat ? 1.0f : size);
    float slope = (area < 0.0f ? -1.0f : 1.0f) * scale * clampf(far[i], -1e6f, 1e6f);
    float sp = slope * (hp[i] - h[i]), sq = slope * (hq[i] - h[i]);
    vec3 bent = {own.x - sp * across_p.x - sq * across_q.x,
                 own.y - sp * across_p.y - sq * across_q.y,
                 own.z - sp * across_p.z - sq * across_q.z};
    float square = dot(bent, bent), strength = clampf(force[i], 0.0f, 1e6f);
    bool good = !flat & (square > 1e-36f) & (square < 1e30f); /* false for NaN */
    vec3 to = select3(good, scaled(bent, 1.0f / sqrtf(good ? square : 1.0f)), own);
    vec3 mixed =
        unit_over((vec3){own.x + strength * (to.x - own.x), own.y + strength * (to.y - own.y),
                         own.z + strength * (to.z - own.z)},
                  lowest);
    nx[i] = mixed.x;
    ny[i] = mixed.y;
    nz[i] = mixed.z;
  }
}

#endif
