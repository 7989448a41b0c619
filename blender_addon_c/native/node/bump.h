/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A normal by heights, as Cycles' Bump node has it [Mikkelsen2008]: `height`, three operands, at
 * the point, a step of `step` further along u and as far along v; `strength` and `distance`;
 * `normal`, which it bends, three operands in the shading frame. Writes `out`, a normal there. */
#ifndef LIBSHADE_NODE_BUMP_H
#define LIBSHADE_NODE_BUMP_H

#include "node/frame.h"

typedef struct node_bump {
  operand height[3], strength, distance, normal[3];
  float per_step;
  int out[3];
} node_bump;

static inline bool node_bump_read(reader *r, node_bump *n, graph *g) {
  double step;
  if (!graph_operands(r, g, "height", 3, n->height) || !reader_number(r, "step", &step) ||
      !graph_operands(r, g, "strength", 1, &n->strength) ||
      !graph_operands(r, g, "distance", 1, &n->distance) ||
      !graph_operands(r, g, "normal", 3, n->normal) || !graph_outputs(r, g, "out", 3, n->out))
    return false;
  n->per_step = (float)(1.0 / fmin(fmax(step, 1e-6), 1.0));
  return true;
}

static inline bool node_bump_build(node_bump *n, const node_place *place) {
  (void)n, (void)place;
  return true;
}

LEAF vec3 in_frame(const surfaces *at, size_t i, vec3 v) {
  return (vec3){dot(v, load(&at->t, i)), dot(v, load(&at->b, i)), dot(v, load(&at->n, i))};
}

/* Where u and v say nothing of the surface, the normal stays. */
LEAF void node_bump_run(const node_bump *n, lane_run g, const corners *corner,
                        const surfaces *point, inputs *at) {
  const float *h = lane_of(at, n->height[0], 0, g), *hu = lane_of(at, n->height[1], 1, g);
  const float *hv = lane_of(at, n->height[2], 2, g), *force = lane_of(at, n->strength, 3, g);
  const float *far = lane_of(at, n->distance, 4, g), *x = lane_of(at, n->normal[0], 5, g);
  const float *y = lane_of(at, n->normal[1], 6, g), *z = lane_of(at, n->normal[2], 7, g);
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
  const float per_step = n->per_step;
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 own = {x[i], y[i], z[i]};
    vec3 du = in_frame(point, i, load(&point->du, i)), dv = in_frame(point, i, load(&point->dv, i));
    vec3 across_u = cross(dv, own), across_v = cross(own, du);
    float area = dot(du, across_u);
    float slope = (area < 0.0f ? -1.0f : 1.0f) * per_step * clampf(far[i], -1e6f, 1e6f);
    float su = slope * (hu[i] - h[i]), sv = slope * (hv[i] - h[i]), size = fabsf(area);
    vec3 bent = {size * own.x - su * across_u.x - sv * across_v.x,
                 size * own.y - su * across_u.y - sv * across_v.y,
                 size * own.z - su * across_u.z - sv * across_v.z};
    float square = dot(bent, bent), strength = clampf(force[i], 0.0f, 1e6f);
    bool good = size > 1e-18f && square > 1e-36f && square < 1e30f; /* false for NaN */
    vec3 to = select3(good, scaled(bent, 1.0f / sqrtf(good ? square : 1.0f)), own);
    vec3 mixed =
        upright((vec3){own.x + strength * (to.x - own.x), own.y + strength * (to.y - own.y),
                       own.z + strength * (to.z - own.z)});
    nx[i] = mixed.x;
    ny[i] = mixed.y;
    nz[i] = mixed.z;
  }
}

#endif
