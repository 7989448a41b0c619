/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One channel of two colours, blended: `mode`, a word of the table; `factor`, `a`, `b`, an operand
 * each. Writes `out`. */
#ifndef LIBSHADE_NODE_MIX_H
#define LIBSHADE_NODE_MIX_H

#include "node/common.h"

LEAF float blend_screen(float t, float a, float b) {
  return 1.0f - (1.0f - t + t * (1.0f - b)) * (1.0f - a);
}
LEAF float blend_overlay(float t, float a, float b) {
  return a < 0.5f ? a * (1.0f - t + 2.0f * t * b)
                  : 1.0f - (1.0f - t + 2.0f * t * (1.0f - b)) * (1.0f - a);
}
LEAF float blend_dodge(float t, float a, float b) {
  float rest = 1.0f - t * b;
  float whole = rest > 0.0f ? a / rest : 1.0f;
  return a != 0.0f ? (whole < 1.0f ? whole : 1.0f) : 0.0f;
}
LEAF float blend_burn(float t, float a, float b) {
  float rest = 1.0f - t + t * b;
  return rest > 0.0f ? clampf(1.0f - (1.0f - a) / rest, 0.0f, 1.0f) : 0.0f;
}
LEAF float blend_soft_light(float t, float a, float b) {
  float screen = 1.0f - (1.0f - b) * (1.0f - a);
  return (1.0f - t) * a + t * ((1.0f - a) * b * a + a * screen);
}

/* Words of Blender's blending; those that mix hues are made of other nodes. */
#define MIX_TABLE(ROW)                                                                             \
  ROW(MIX, lerp(a, b, t))                                                                          \
  ROW(DARKEN, lerp(a, a < b ? a : b, t))                                                           \
  ROW(MULTIPLY, lerp(a, a *b, t))                                                                  \
  ROW(BURN, blend_burn(t, a, b))                                                                   \
  ROW(LIGHTEN, lerp(a, a > b ? a : b, t))                                                          \
  ROW(SCREEN, blend_screen(t, a, b))                                                               \
  ROW(DODGE, blend_dodge(t, a, b))                                                                 \
  ROW(ADD, a + t * b)                                                                              \
  ROW(OVERLAY, blend_overlay(t, a, b))                                                             \
  ROW(SOFT_LIGHT, blend_soft_light(t, a, b))                                                       \
  ROW(LINEAR_LIGHT, a + t * (2.0f * b - 1.0f))                                                     \
  ROW(DIFFERENCE, lerp(a, fabsf(a - b), t))                                                        \
  ROW(EXCLUSION, clampf(lerp(a, a + b - 2.0f * a * b, t), 0.0f, INFINITY))                         \
  ROW(SUBTRACT, a - t * b)                                                                         \
  ROW(DIVIDE, b != 0.0f ? lerp(a, a / b, t) : a)

#define MIX_NUMBER(WORD, formula) MIX_##WORD,
#define MIX_WORD(WORD, formula) #WORD,
enum { MIX_TABLE(MIX_NUMBER) };

typedef struct node_mix {
  int mode, out;
  operand factor, a, b;
} node_mix;

static inline bool node_mix_read(reader *r, node_mix *n, graph *g) {
  static const char *const words[] = {MIX_TABLE(MIX_WORD) NULL};
  return reader_word(r, "mode", words, &n->mode) && graph_operands(r, g, "factor", 1, &n->factor) &&
         graph_operands(r, g, "a", 1, &n->a) && graph_operands(r, g, "b", 1, &n->b) &&
         graph_outputs(r, g, "out", 1, &n->out);
}

#define MIX_CASE(WORD, formula)                                                                    \
  case MIX_##WORD:                                                                                 \
    _Pragma("omp simd") for (size_t i = g.begin; i < g.end; i++) {                                 \
      float t = factor[i], a = lane_a[i], b = lane_b[i];                                           \
      out[i] = formula;                                                                            \
    }                                                                                              \
    break;

LEAF void node_mix_run(const node_mix *n, lane_run g, const corners *corner, const surfaces *point,
                       inputs *at) {
  const float *factor = lane_of(at, n->factor, 0, g), *lane_a = lane_of(at, n->a, 1, g);
  const float *lane_b = lane_of(at, n->b, 2, g);
  float *out = at->at[n->out];
  (void)corner, (void)point;
  switch (n->mode) { MIX_TABLE(MIX_CASE) }
}

#endif
