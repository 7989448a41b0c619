/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of numbers: `table`, two or more, evenly over [`low`, `high`]; `at`, one operand, where
 * to look; `extend`, whether its first and last stretch go on as lines, else what is at the ends
 * does. Writes `out`, one. */
#ifndef LIBSHADE_NODE_CURVE_H
#define LIBSHADE_NODE_CURVE_H

#include "node/common.h"

enum { CURVE_MOST = 65536 };

typedef struct node_curve {
  const float *table;
  operand at;
  float low, scale; /* by which a place becomes an index */
  int last, out;    /* last: index of the last stretch */
  bool extend;
} node_curve;

static inline bool node_curve_read(reader *r, node_curve *n, graph *g) {
  reader_buffer table;
  float high;
  if (!reader_items(r, "table", SIZE_MAX, "f", 4, &table) ||
      !reader_number_within(r, "low", -1e18f, 1e18f, &n->low) ||
      !reader_number_within(r, "high", -1e18f, 1e18f, &high))
    return false;
  size_t items = table.size / 4;
  if (items < 2 || items > CURVE_MOST)
    return reader_expected(r, "table", "2 to 65536 numbers");
  n->table = table.data;
  n->last = (int)items - 2;
  float range = high - n->low;
  n->scale = range > 0.0f ? (float)(items - 1) / range : 0.0f;
  return graph_operands(r, g, "at", 1, &n->at) && reader_flag(r, "extend", &n->extend) &&
         graph_outputs(r, g, "out", 1, &n->out);
}

LEAF void node_curve_run(const node_curve *n, lane_run g, const corners *corner,
                         const surfaces *point, inputs *at) {
  const float *x = lane_of(at, n->at, 0, g), *table = n->table;
  float *out = at->at[n->out];
  const float low = n->low, scale = n->scale, last = (float)n->last;
  const float beyond = n->extend ? 1e30f : 0.0f;
  (void)corner, (void)point;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float place = clampf((x[i] - low) * scale, -beyond, last + 1.0f + beyond);
    int k = (int)clampf(place, 0.0f, last);
    out[i] = lerp(table[k], table[k + 1], place - (float)k);
  }
}

#endif
