/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How much a round lobe, `lobe` (GGX where it is not said), of alpha `alpha`, one operand, about
 * `normal` reflects of even light towards the eye, by a table of libshade's. Writes `out`: with a
 * Fresnel of 1 everywhere; of GGX with that of a clear body, from 0 head-on to 1 (index 1.5,
 * scaled); the first one's mean over the eye's directions. What is lost of 1 left the surface's
 * facets more than once. Of a GGX lobe that is drawn out `across`, one operand, is its other alpha,
 * and `along`, two, where the first one's direction points in the shading frame: the first and the
 * third number are then of that (within .03, .004 in the mean), the second is of a round one.
 */
#ifndef LIBSHADE_NODE_ALBEDO_H
#define LIBSHADE_NODE_ALBEDO_H

#include <stdlib.h>

#include "node/common.h"
#include "shade/albedo.h"
#include "system/threads.h"

/* Even in sqrt(alpha) and in the eye's cosine. */
enum { ALBEDO_ROUGH = 24, ALBEDO_EYE = 32 };

/* Of lobes that are drawn out: even in the roots of both alphas and of the eye's cosine, and in the
 * angle from the first one's direction to the eye. */
enum { PAIR_ROUGH = 16, PAIR_EYE = 16, PAIR_TURN = 7, PAIR_ROW = PAIR_EYE * PAIR_TURN };

typedef enum albedo_lobe { ALBEDO_GGX, ALBEDO_BECKMANN, ALBEDO_COSINES, ALBEDO_LOBES } albedo_lobe;

typedef struct node_albedo {
  int lobe;
  operand alpha, across, along[2];
  bool drawn_out;
  int normal[3], out[3];
  const float *table, *pairs;
} node_albedo;

static inline bool node_albedo_read(reader *r, node_albedo *n, graph *g) {
  static const char *const lobes[] = {"GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY", NULL};
  n->lobe = ALBEDO_GGX;
  n->drawn_out = reader_has(r, "across");
  return (!reader_has(r, "lobe") || reader_word(r, "lobe", lobes, &n->lobe)) &&
         graph_normal(r, g, n->normal) && graph_operands(r, g, "alpha", 1, &n->alpha) &&
         (!n->drawn_out || (graph_operands(r, g, "across", 1, &n->across) &&
                            graph_operands(r, g, "along", 2, n->along))) &&
         graph_outputs(r, g, "out", 3, n->out);
}

/* False when out of memory. */
bool albedo_table_make(albedo_lobe lobe, const float **table);

/* The same of lobes that are drawn out; their means stand behind them. */
const float *albedo_pairs_make(void);

static inline bool node_albedo_build(node_albedo *n, const node_place *place) {
  (void)place;
  n->pairs = n->drawn_out ? albedo_pairs_make() : NULL;
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

/* Where one of a table's numbers lies between two. */
typedef struct albedo_part {
  int at;
  float t;
} albedo_part;

LEAF albedo_part part_of(float x, int count) {
  float y = clampf(x, 0.0f, 1.0f) * (float)(count - 1);
  int at = (int)y < count - 2 ? (int)y : count - 2;
  return (albedo_part){at, y - (float)at};
}

LEAF float albedo_turned(const float *row, albedo_part eye, albedo_part turn) {
  const float *at = row + eye.at * PAIR_TURN + turn.at;
  return lerp(lerp(at[0], at[1], turn.t), lerp(at[PAIR_TURN], at[PAIR_TURN + 1], turn.t), eye.t);
}

LEAF void albedo_drawn_out(const node_albedo *n, lane_run g, const surfaces *restrict point,
                           inputs *at) {
  const float *ax = lane_of(at, n->alpha, 0, g), *ay = lane_of(at, n->across, 1, g);
  const float *tx = lane_of(at, n->along[0], 2, g), *ty = lane_of(at, n->along[1], 3, g);
  const float *nx = at->at[n->normal[0]], *ny = at->at[n->normal[1]], *nz = at->at[n->normal[2]];
  float *one = at->at[n->out[0]], *mean = at->at[n->out[2]];
  const float *pairs = n->pairs, *means = pairs + PAIR_ROUGH * PAIR_ROUGH * PAIR_ROW;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 v = load(&point->wo, i), m = {nx[i], ny[i], nz[i]}, t = {tx[i], ty[i], 0.0f};
    float down = dot(t, m), cosine = dot(m, v);
    t = (vec3){t.x - down * m.x, t.y - down * m.y, -down * m.z};
    float along = dot(t, v), square = dot(t, t) * (1.0f - cosine * cosine);
    float part = square > 1e-12f ? along * along / square : 0.5f; /* cos^2 of the turn */
    part = clampf(part, 0.0f, 1.0f);
    float angle = arc_tangent2(sqrtf(1.0f - part), sqrtf(part)) * 0.636619772f;
    albedo_part x = part_of(sqrtf(clampf(ax[i], 0.0f, 1.0f)), PAIR_ROUGH);
    albedo_part y = part_of(sqrtf(clampf(ay[i], 0.0f, 1.0f)), PAIR_ROUGH);
    albedo_part eye = part_of(sqrtf(clampf(cosine, 0.0f, 1.0f)), PAIR_EYE);
    albedo_part turn = part_of(angle, PAIR_TURN);
    int first = x.at * PAIR_ROUGH + y.at;
    const float *row = pairs + first * PAIR_ROW, *next = row + PAIR_ROUGH * PAIR_ROW;
    one[i] = lerp(
        lerp(albedo_turned(row, eye, turn), albedo_turned(row + PAIR_ROW, eye, turn), y.t),
        lerp(albedo_turned(next, eye, turn), albedo_turned(next + PAIR_ROW, eye, turn), y.t), x.t);
    const float *by = means + first, *after = by + PAIR_ROUGH;
    mean[i] = lerp(lerp(by[0], by[1], y.t), lerp(after[0], after[1], y.t), x.t);
  }
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
  if (n->drawn_out)
    albedo_drawn_out(n, g, point, at);
}

#endif
