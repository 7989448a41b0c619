/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How much of even light closure GLASS of `ior` and `alpha`, one operand each, about `normal` sends
 * to the eye where it is clear, by a table; `joint` as there. Writes `out`, one number: what it
 * lacks of 1 met the surface's facets more than once.
 */
#ifndef LIBSHADE_NODE_GLASS_ALBEDO_H
#define LIBSHADE_NODE_GLASS_ALBEDO_H

#include "node/common.h"
#include "node/dielectric.h"

/* Even in the eye's cosine, in sqrt(alpha) and in s = (eta - 1) / (eta + 1), whose square is the
 * reflectance head-on; of indices below 1 s is negative. */
enum { GLASS_EYE = 16, GLASS_ROUGH = 12, GLASS_ETA = 16, GLASS_PLANE = GLASS_EYE * GLASS_ROUGH };
enum { GLASS_TABLE = 2 * GLASS_ETA * GLASS_PLANE, GLASS_MEANS = GLASS_ETA * GLASS_ROUGH };
#define GLASS_MOST_ETA 0.6f

typedef struct node_glass_albedo {
  operand ior, alpha;
  bool joint;
  int normal[3], out[2];
  const float *table; /* of s > 0, then of s < 0; then the means of both */
} node_glass_albedo;

static inline bool node_glass_albedo_read(reader *r, node_glass_albedo *n, graph *g) {
  return graph_normal(r, g, n->normal) && graph_operands(r, g, "ior", 1, &n->ior) &&
         graph_operands(r, g, "alpha", 1, &n->alpha) && reader_flag(r, "joint", &n->joint) &&
         graph_outputs(r, g, "out", 2, n->out);
}

const float *glass_albedo_table(bool joint);

static inline bool node_glass_albedo_build(node_glass_albedo *n, const node_place *place) {
  (void)place;
  n->table = glass_albedo_table(n->joint);
  return true;
}

/* Between four entries of a plane. */
LEAF float glass_albedo_look(const float *table, int at, float s, float t) {
  return lerp(lerp(table[at], table[at + 1], s),
              lerp(table[at + GLASS_EYE], table[at + GLASS_EYE + 1], s), t);
}

LEAF void node_glass_albedo_run(const node_glass_albedo *n, lane_run g, const corners *corner,
                                const surfaces *restrict point, inputs *at) {
  const float *alpha = lane_of(at, n->alpha, 0, g), *ior = lane_of(at, n->ior, 1, g);
  const float *nx = at->at[n->normal[0]], *ny = at->at[n->normal[1]], *nz = at->at[n->normal[2]];
  const float *table = n->table;
  float *out = at->at[n->out[0]], *mean = at->at[n->out[1]];
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 v = load(&point->wo, i);
    float eta = dielectric_eta(ior[i], point->side[i]), s = (eta - 1.0f) / (eta + 1.0f);
    float x = clampf(nx[i] * v.x + ny[i] * v.y + nz[i] * v.z, 0.0f, 1.0f) * (GLASS_EYE - 1);
    float y = sqrtf(clampf(alpha[i], 0.0f, 1.0f)) * (GLASS_ROUGH - 1);
    float z = clampf(fabsf(s) * (1.0f / GLASS_MOST_ETA), 0.0f, 1.0f) * (GLASS_ETA - 1);
    int column = (int)x < GLASS_EYE - 2 ? (int)x : GLASS_EYE - 2;
    int row = (int)y < GLASS_ROUGH - 2 ? (int)y : GLASS_ROUGH - 2;
    int plane = (int)z < GLASS_ETA - 2 ? (int)z : GLASS_ETA - 2;
    int place = plane * GLASS_PLANE + row * GLASS_EYE + column;
    int means = GLASS_TABLE + plane * GLASS_ROUGH + row;
    place += s < 0.0f ? GLASS_ETA * GLASS_PLANE : 0;
    means += s < 0.0f ? GLASS_MEANS : 0;
    float p = x - (float)column, q = y - (float)row;
    out[i] = lerp(glass_albedo_look(table, place, p, q),
                  glass_albedo_look(table, place + GLASS_PLANE, p, q), z - (float)plane);
    mean[i] =
        lerp(lerp(table[means], table[means + 1], q),
             lerp(table[means + GLASS_ROUGH], table[means + GLASS_ROUGH + 1], q), z - (float)plane);
  }
}

#endif
