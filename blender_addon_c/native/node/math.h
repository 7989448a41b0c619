/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One number of up to three: `operation`, a word of the table, and `a`, `b`, `c`, an operand each.
 * Writes `out`. Where a formula has no value, it is what Cycles takes it for. */
#ifndef LIBSHADE_NODE_MATH_H
#define LIBSHADE_NODE_MATH_H

#include "node/common.h"

LEAF float truncated(float x) {
  return x < 0.0f ? -floor_small(-x) : floor_small(x);
}
LEAF float quotient(float a, float b) {
  return b != 0.0f ? a / b : 0.0f;
}
LEAF float power(float a, float b) {
  bool whole = floor_small(b) == b, odd = whole & (2.0f * floor_small(0.5f * b) != b);
  float size = exponential2(b * logarithm2(fabsf(a)));
  size = a == 0.0f ? (b == 0.0f ? 1.0f : 0.0f) : size;
  return a < 0.0f ? (whole ? (odd ? -size : size) : 0.0f) : size;
}
LEAF float smooth_least(float a, float b, float c) {
  float h = c - fabsf(a - b);
  h = c != 0.0f ? (h > 0.0f ? h : 0.0f) / c : 0.0f;
  return (a < b ? a : b) - h * h * h * c * (1.0f / 6.0f);
}
LEAF float e_to(float x) {
  return exponential2(x * 1.44269504f);
}
LEAF float tanh_of(float x) {
  float e = e_to(-2.0f * fabsf(x)), t = (1.0f - e) / (1.0f + e);
  return x < 0.0f ? -t : t;
}
/* sin and cos of an angle in radians. */
LEAF void sine_cosine(float x, float *s, float *c) {
  float turns = x * 0.159154943f;
  turn(clampf(turns - floor_small(turns), 0.0f, 0.99999994f), s, c);
}
LEAF float sine(float x) {
  float s, c;
  sine_cosine(x, &s, &c);
  return s;
}
LEAF float cosine(float x) {
  float s, c;
  sine_cosine(x, &s, &c);
  return c;
}
LEAF float tangent(float x) {
  float s, c;
  sine_cosine(x, &s, &c);
  return quotient(s, c);
}
LEAF float wrapped(float a, float high, float low) {
  float range = high - low;
  return range != 0.0f ? a - range * floor_small((a - low) / range) : low;
}
LEAF float ping_pong(float a, float b) {
  float t = b != 0.0f ? (a - b) / (2.0f * b) : 0.0f;
  return b != 0.0f ? fabsf((t - floor_small(t)) * 2.0f * b - b) : 0.0f;
}
LEAF float arc_sine(float x) {
  x = clampf(x, -1.0f, 1.0f);
  return arc_tangent2(x, sqrtf((1.0f - x) * (1.0f + x)));
}
LEAF float arc_cosine(float x) {
  x = clampf(x, -1.0f, 1.0f);
  return arc_tangent2(sqrtf((1.0f - x) * (1.0f + x)), x);
}

/* Words of Blender's Math node, and what other nodes are made of: MIX, CLAMP. */
#define MATH_TABLE(ROW)                                                                            \
  ROW(ADD, a + b)                                                                                  \
  ROW(SUBTRACT, a - b)                                                                             \
  ROW(MULTIPLY, a *b)                                                                              \
  ROW(DIVIDE, quotient(a, b))                                                                      \
  ROW(MULTIPLY_ADD, a *b + c)                                                                      \
  ROW(POWER, power(a, b))                                                                          \
  ROW(LOGARITHM, ((a > 0.0f) & (b > 0.0f)) ? quotient(logarithm2(a), logarithm2(b)) : 0.0f)        \
  ROW(SQRT, a > 0.0f ? sqrtf(a > 0.0f ? a : 0.0f) : 0.0f)                                          \
  ROW(INVERSE_SQRT, a > 0.0f ? 1.0f / sqrtf(a > 0.0f ? a : 1.0f) : 0.0f)                           \
  ROW(ABSOLUTE, fabsf(a))                                                                          \
  ROW(EXPONENT, e_to(a))                                                                           \
  ROW(MINIMUM, a < b ? a : b)                                                                      \
  ROW(MAXIMUM, a > b ? a : b)                                                                      \
  ROW(LESS_THAN, a < b ? 1.0f : 0.0f)                                                              \
  ROW(GREATER_THAN, a > b ? 1.0f : 0.0f)                                                           \
  ROW(SIGN, a > 0.0f ? 1.0f : (a < 0.0f ? -1.0f : 0.0f))                                           \
  ROW(COMPARE, fabsf(a - b) <= (c > 1.1920929e-7f ? c : 1.1920929e-7f) ? 1.0f : 0.0f)              \
  ROW(SMOOTH_MIN, smooth_least(a, b, c))                                                           \
  ROW(SMOOTH_MAX, -smooth_least(-a, -b, c))                                                        \
  ROW(ROUND, floor_small(a + 0.5f))                                                                \
  ROW(FLOOR, floor_small(a))                                                                       \
  ROW(CEIL, -floor_small(-a))                                                                      \
  ROW(TRUNC, truncated(a))                                                                         \
  ROW(FRACT, a - floor_small(a))                                                                   \
  ROW(MODULO, b != 0.0f ? a - b * truncated(a / b) : 0.0f)                                         \
  ROW(FLOORED_MODULO, b != 0.0f ? a - b * floor_small(a / b) : 0.0f)                               \
  ROW(WRAP, wrapped(a, b, c))                                                                      \
  ROW(SNAP, floor_small(quotient(a, b)) * b)                                                       \
  ROW(PINGPONG, ping_pong(a, b))                                                                   \
  ROW(SINE, sine(a))                                                                               \
  ROW(COSINE, cosine(a))                                                                           \
  ROW(TANGENT, tangent(a))                                                                         \
  ROW(ARCSINE, arc_sine(a))                                                                        \
  ROW(ARCCOSINE, arc_cosine(a))                                                                    \
  ROW(ARCTANGENT, arc_tangent2(a, 1.0f))                                                           \
  ROW(ARCTAN2, arc_tangent2(a, b))                                                                 \
  ROW(SINH, 0.5f * (e_to(a) - e_to(-a)))                                                           \
  ROW(COSH, 0.5f * (e_to(a) + e_to(-a)))                                                           \
  ROW(TANH, tanh_of(a))                                                                            \
  ROW(RADIANS, a * 0.0174532925f)                                                                  \
  ROW(DEGREES, a * 57.2957795f)                                                                    \
  ROW(MIX, a + c * (b - a))                                                                        \
  ROW(CLAMP, clampf(a, b, c))

#define MATH_NUMBER(WORD, formula) MATH_##WORD,
#define MATH_WORD(WORD, formula) #WORD,
enum { MATH_TABLE(MATH_NUMBER) };

typedef struct node_math {
  int operation, out;
  operand a, b, c;
} node_math;

static inline bool node_math_read(reader *r, node_math *n, graph *g) {
  static const char *const words[] = {MATH_TABLE(MATH_WORD) NULL};
  return reader_word(r, "operation", words, &n->operation) && graph_operands(r, g, "a", 1, &n->a) &&
         graph_operands(r, g, "b", 1, &n->b) && graph_operands(r, g, "c", 1, &n->c) &&
         graph_outputs(r, g, "out", 1, &n->out);
}

#define MATH_CASE(WORD, formula)                                                                   \
  case MATH_##WORD:                                                                                \
    _Pragma("omp simd") for (size_t i = g.begin; i < g.end; i++) {                                 \
      float a = lane_a[i], b = lane_b[i], c = lane_c[i];                                           \
      (void)a, (void)b, (void)c;                                                                   \
      out[i] = formula;                                                                            \
    }                                                                                              \
    break;

LEAF void node_math_run(const node_math *n, lane_run g, const corners *corner,
                        const surfaces *point, inputs *at) {
  const float *lane_a = lane_of(at, n->a, 0, g), *lane_b = lane_of(at, n->b, 1, g);
  const float *lane_c = lane_of(at, n->c, 2, g);
  float *out = at->at[n->out];
  (void)corner, (void)point;
  switch (n->operation) { MATH_TABLE(MATH_CASE) }
}

#endif
