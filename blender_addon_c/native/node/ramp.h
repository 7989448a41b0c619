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

static inline bool node_ramp_build(node_ramp *n, const node_place *place) {
  (void)n, (void)place;
  return true;
}

LEAF void node_ramp_run(const node_ramp *n, lane_run g, const corners *corner,
                        const surfaces *point, inputs *at) {
  const float *x = lane_of(at, n->at, 0, g), *table = n->table;
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *alpha = at->at[n->out[3]];
  const float smooth = n->smooth ? 1.0f : 0.0f;
  (void)corner, (void)point;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float place = clampf(x[i], 0.0f, 1.0f) * (RAMP_STEPS - 1);
    int k = (int)place, next = k + 1 < RAMP_STEPS ? k + 1 : k;
    float t = (place - (float)k) * smooth;
    red[i] = lerp(table[4 * k], table[4 * next], t);
    green[i] = lerp(table[4 * k + 1], table[4 * next + 1], t);
    blue[i] = lerp(table[4 * k + 2], table[4 * next + 2], t);
    alpha[i] = lerp(table[4 * k + 3], table[4 * next + 3], t);
  }
}

#endif
