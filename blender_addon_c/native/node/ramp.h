/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of colours: `table`, 256 times red, green, blue and alpha over [0, 1]; `at`, one operand,
 * where to look; `smooth`, whether what lies between two of them is mixed. Writes `out`, four. */
#ifndef LIBSHADE_NODE_RAMP_H
#define LIBSHADE_NODE_RAMP_H

#include "node/common.h"

enum { RAMP_STEPS = 256 };

typedef struct node_ramp {
  const float *table;
  operand at;
  bool smooth;
  int out[4];
} node_ramp;

static inline bool node_ramp_read(reader *r, node_ramp *n, graph *g) {
  reader_buffer table;
  if (!reader_items(r, "table", 4 * (size_t)RAMP_STEPS, "f", 4, &table))
    return false;
  n->table = table.data;
  return graph_operands(r, g, "at", 1, &n->at) && reader_flag(r, "smooth", &n->smooth) &&
         graph_outputs(r, g, "out", 4, n->out);
}

typedef float ramp_row __attribute__((vector_size(16), aligned(4), may_alias));

/* Red, green, blue and alpha from `first` of the table on: so much of the next ones. */
LEAF ramp_row ramp_look(const float *table, int32_t first, float part) {
  const float *second = table + first + (first < 4 * (RAMP_STEPS - 1) ? 4 : 0);
  ramp_row low = *(const ramp_row *)(table + first), high = *(const ramp_row *)second;
  return low + part * (high - low);
}

/*
 * By rows, not by lanes, as in stage_corner: two loads of a colour a lane, where lanes would gather
 * eight numbers each. Four rows are turned into columns at a time.
 */
LEAF void node_ramp_run(const node_ramp *n, lane_run g, const corners *corner,
                        const surfaces *point, inputs *at) {
  const float *x = lane_of(at, n->at, 0, g), *table = n->table;
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *alpha = at->at[n->out[3]];
  const float smooth = n->smooth ? 1.0f : 0.0f;
  int32_t first[BATCH];
  float part[BATCH];
  (void)corner, (void)point;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float place = clampf(x[i], 0.0f, 1.0f) * (RAMP_STEPS - 1);
    int32_t k = (int32_t)place;
    first[i] = 4 * k;
    part[i] = (place - (float)k) * smooth;
  }
  size_t i = g.begin;
  for (; i + 4 <= g.end; i += 4) {
    ramp_row a = ramp_look(table, first[i], part[i]);
    ramp_row b = ramp_look(table, first[i + 1], part[i + 1]);
    ramp_row c = ramp_look(table, first[i + 2], part[i + 2]);
    ramp_row d = ramp_look(table, first[i + 3], part[i + 3]);
    ramp_row ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    ramp_row cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    *(ramp_row *)(red + i) = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    *(ramp_row *)(green + i) = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    ab = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    *(ramp_row *)(blue + i) = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    *(ramp_row *)(alpha + i) = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  }
  for (; i < g.end; i++) {
    ramp_row one = ramp_look(table, first[i], part[i]);
    red[i] = one[0];
    green[i] = one[1];
    blue[i] = one[2];
    alpha[i] = one[3];
  }
}

#endif
