/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A wall of bricks in x and y, as Cycles lays it: `at`, two operands; `width` and `height` of a
 * brick; `mortar` between them, `smooth` how softly it ends, `bias` of the tint, an operand each;
 * each `shift_each`th row is moved by `shift` of a brick, each `squash_each`th has bricks `squash`
 * times as wide. Writes `out`, two: the brick's random tint and how much mortar there is. */
#ifndef LIBSHADE_NODE_BRICK_H
#define LIBSHADE_NODE_BRICK_H

#include "node/common.h"

typedef struct node_brick {
  operand at[2], width, height, mortar, smooth, bias;
  int shift_each, squash_each, out[2];
  float shift, squash;
} node_brick;

static inline bool node_brick_read(reader *r, node_brick *n, graph *g) {
  return graph_operands(r, g, "at", 2, n->at) && graph_operands(r, g, "width", 1, &n->width) &&
         graph_operands(r, g, "height", 1, &n->height) &&
         graph_operands(r, g, "mortar", 1, &n->mortar) &&
         graph_operands(r, g, "smooth", 1, &n->smooth) &&
         graph_operands(r, g, "bias", 1, &n->bias) &&
         reader_integer(r, "shift_each", 0, 99, &n->shift_each) &&
         reader_integer(r, "squash_each", 0, 99, &n->squash_each) &&
         reader_number_within(r, "shift", 0.0, 1.0, &n->shift) &&
         reader_number_within(r, "squash", 0.0, 99.0, &n->squash) &&
         graph_outputs(r, g, "out", 2, n->out);
}

/* [0, 1] of a whole number: the old noise of integers that Cycles has kept for bricks. */
LEAF float brick_chance(uint32_t n) {
  n = (n + 1013u) & 0x7fffffffu;
  n = n >> 13 ^ n;
  uint32_t h = (n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu;
  return 0.5f * ((float)(int32_t)h * (1.0f / 1073741824.0f));
}
/* Whether a whole number is a multiple of another; `by`, 1 by that. */
LEAF bool one_of_each(float whole, int each, float by) {
  return whole - (float)each * floor_small(whole * by + 1e-6f) == 0.0f;
}

LEAF void node_brick_run(const node_brick *n, lane_run g, const corners *corner,
                         const surfaces *point, inputs *at) {
  const float *across = lane_of(at, n->at[0], 0, g), *up = lane_of(at, n->at[1], 1, g);
  const float *widths = lane_of(at, n->width, 2, g), *heights = lane_of(at, n->height, 3, g);
  const float *mortars = lane_of(at, n->mortar, 4, g), *softness = lane_of(at, n->smooth, 5, g);
  const float *bias = lane_of(at, n->bias, 6, g);
  const float by_shift = 1.0f / (float)(n->shift_each > 0 ? n->shift_each : 1);
  const float by_squash = 1.0f / (float)(n->squash_each > 0 ? n->squash_each : 1);
  const bool both = (n->shift_each > 0) & (n->squash_each > 0);
  const float shift = both ? n->shift : 0.0f, squash = both ? n->squash : 1.0f;
  const int shift_each = n->shift_each, squash_each = n->squash_each;
  float *tint = at->at[n->out[0]], *mortar = at->at[n->out[1]];
  (void)corner, (void)point;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float height = heights[i] != 0.0f ? heights[i] : 1e-20f;
    float row = clampf(floor_small(up[i] / height), -4e6f, 4e6f);
    bool moved = one_of_each(row, shift_each, by_shift);
    bool wide = one_of_each(row, squash_each, by_squash);
    float width = widths[i] * (wide ? squash : 1.0f);
    float from = (moved ? shift : 0.0f) * width;
    width = width != 0.0f ? width : 1e-20f;
    float column = clampf(floor_small((across[i] + from) / width), -4e6f, 4e6f);
    float x = across[i] + from - width * column, y = up[i] - height * row;
    float random =
        brick_chance(((uint32_t)(int32_t)row << 16) + ((uint32_t)(int32_t)column & 0xffffu));
    tint[i] = clampf(random + bias[i], 0.0f, 1.0f);
    float right = width - x, top = height - y;
    float near = x < right ? x : right, lid = y < top ? y : top;
    near = near < lid ? near : lid;
    /* 1 at the rim of a brick, less further in */
    float in = mortars[i] != 0.0f ? 1.0f - near / mortars[i] : 0.0f;
    float soft = softness[i];
    float t = clampf(soft != 0.0f ? in / soft : 1.0f, 0.0f, 1.0f);
    mortar[i] = near >= mortars[i] ? 0.0f : t * t * (3.0f - 2.0f * t);
  }
}

#endif
