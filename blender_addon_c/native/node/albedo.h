/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How much a round lobe, `lobe` (GGX where it is not said), of alpha `alpha`, one operand, about
 * `normal` reflects of even light towards the eye, by a table of libshade's. Writes `out`: with a
 * Fresnel of 1 everywhere; of GGX with that of a clear body, from 0 head-on to 1 (index 1.5,
 * scaled); the first one's mean over the eye's directions. What is lost of 1 left the surface's
 * facets more than once.
 */
#ifndef LIBSHADE_NODE_ALBEDO_H
#define LIBSHADE_NODE_ALBEDO_H

#include <pthread.h>
#include <stdlib.h>

#include "node/common.h"
#include "shade/albedo.h"

/* Even in sqrt(alpha) and in the eye's cosine. */
enum { ALBEDO_ROUGH = 24, ALBEDO_EYE = 32 };

typedef enum albedo_lobe { ALBEDO_GGX, ALBEDO_BECKMANN, ALBEDO_COSINES, ALBEDO_LOBES } albedo_lobe;

typedef struct node_albedo {
  int lobe;
  operand alpha;
  int normal[3], out[3];
  const float *table;
} node_albedo;

static inline bool node_albedo_read(reader *r, node_albedo *n, graph *g) {
  static const char *const lobes[] = {"GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY", NULL};
  n->lobe = ALBEDO_GGX;
  return (!reader_has(r, "lobe") || reader_word(r, "lobe", lobes, &n->lobe)) &&
         graph_normal(r, g, n->normal) && graph_operands(r, g, "alpha", 1, &n->alpha) &&
         graph_outputs(r, g, "out", 3, n->out);
}

/* False when out of memory. */
bool albedo_table_make(albedo_lobe lobe, const float **table);

static inline bool node_albedo_build(node_albedo *n, const node_place *place) {
  (void)place;
  return albedo_table_make((albedo_lobe)n->lobe, &n->table);
}

/* Where a table of lobes of an alpha is looked up. */
typedef struct albedo_place {
  int row, column;
  float s, t;
} albedo_place;

LEAF albedo_place albedo_find(float alpha, float cosine) {
  float y = sqrtf(clampf(alpha, 0.0f, 1.0f)) * (ALBEDO_ROUGH - 1);
  float x = clampf(cosine, 0.0f, 1.0f) * (ALBEDO_EYE - 1);
  int row = (int)y < ALBEDO_ROUGH - 2 ? (int)y : ALBEDO_ROUGH - 2;
  int column = (int)x < ALBEDO_EYE - 2 ? (int)x : ALBEDO_EYE - 2;
  return (albedo_place){row, column, x - (float)column, y - (float)row};
}

LEAF float albedo_look(const float *table, albedo_place p) {
  int at = p.row * ALBEDO_EYE + p.column;
  return lerp(lerp(table[at], table[at + 1], p.s),
              lerp(table[at + ALBEDO_EYE], table[at + ALBEDO_EYE + 1], p.s), p.t);
}

LEAF void node_albedo_run(const node_albedo *n, lane_run g, const corners *corner,
                          const surfaces *restrict point, inputs *at) {
  const float *alpha = lane_of(at, n->alpha, 0, g), *table = n->table;
  const float *nx = at->at[n->normal[0]], *ny = at->at[n->normal[1]], *nz = at->at[n->normal[2]];
  float *one = at->at[n->out[0]], *clear = at->at[n->out[1]], *mean = at->at[n->out[2]];
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 v = load(&point->wo, i);
    albedo_place p = albedo_find(alpha[i], nx[i] * v.x + ny[i] * v.y + nz[i] * v.z);
    float a = albedo_look(table, p);
    float b = albedo_look(table + ALBEDO_ROUGH * ALBEDO_EYE, p);
    const float *means = table + 2 * ALBEDO_ROUGH * ALBEDO_EYE;
    one[i] = a;
    clear[i] = b;
    mean[i] = lerp(means[p.row], means[p.row + 1], p.t);
  }
}

#endif
