/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where on `cloth`, its index, a hit is, by the UV map, and over what extent. Writes `out`, four
 * numbers: the place along weft and warp and the extent along either, in crossings.
 */
#ifndef LIBSHADE_NODE_WEAVE_H
#define LIBSHADE_NODE_WEAVE_H

#include "node/geometry.h"
#include "scene/cloth.h"

typedef struct node_weave {
  const cloth *cloth;
  int out[4];
} node_weave;

static inline bool node_weave_read(reader *r, node_weave *n, graph *g) {
  int number;
  if (!reader_integer(r, "cloth", 0, (long)g->cloths - 1, &number) ||
      !graph_outputs(r, g, "out", 4, n->out))
    return false;
  n->cloth = &g->cloth[number];
  return true;
}

static inline bool node_weave_build(node_weave *n, const node_place *place) {
  (void)n, (void)place;
  return true;
}

/*
 * A step q across the ray goes along v until it meets the surface again: q + s v = a du + b dv, so
 * that a = q . (dv x v) / (du . (dv x v)). Of steps as long as the pixel is wide the largest a is
 * the extent along u. The frame's y axis is cross(N, T): where the UV map is mirrored, or seen from
 * behind, v counts the other way.
 */
LEAF void node_weave_run(const node_weave *n, lane_run g, const corners *restrict corner,
                         const surfaces *restrict point, inputs *restrict at) {
  float *u = at->at[n->out[0]], *v = at->at[n->out[1]];
  float *along_u = at->at[n->out[2]], *along_v = at->at[n->out[3]];
  const float per_u = n->cloth->per_u, per_v = n->cloth->per_v;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 eye = world_of(point, i, load(&point->wo, i));
    vec3 du = load(&point->du, i), dv = load(&point->dv, i);
    vec3 across_v = cross(dv, eye), across_u = cross(eye, du);
    float area = fabsf(dot(du, across_v)), width = point->width[i];
    float lu = sqrtf(dot(across_v, across_v)), lv = sqrtf(dot(across_u, across_u));
    /* along the surface a footprint is seen as no longer than a thousand times its width */
    float least = 1e-3f * lu * sqrtf(dot(du, du));
    area = area > least ? area : least;
    float scale = width / (area > 1e-30f ? area : 1e-30f);
    float turned = corner->handed[i] * point->side[i];
    u[i] = clampf(per_u * point->u[i], -1e8f, 1e8f);
    v[i] = clampf(per_v * turned * point->v[i], -1e8f, 1e8f);
    along_u[i] = clampf(per_u * scale * lu, 0.0f, 1e8f);
    along_v[i] = clampf(per_v * scale * lv, 0.0f, 1e8f);
  }
}

#endif
