/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What belongs to the object that is hit: `what`, a word of the table; `vector`, three operands,
 * that it turns into the object's space or out of it. Writes `out`, three numbers. */
#ifndef LIBSHADE_NODE_OBJECT_H
#define LIBSHADE_NODE_OBJECT_H

#include "node/common.h"

/* By a matrix whose rows of four begin at `o`: of an object's floats its own at 0, the inverse
 * at 12. */
LEAF vec3 by_matrix(const float *m, size_t o, vec3 v, float moved) {
  return (vec3){m[o] * v.x + m[o + 1] * v.y + m[o + 2] * v.z + moved * m[o + 3],
                m[o + 4] * v.x + m[o + 5] * v.y + m[o + 6] * v.z + moved * m[o + 7],
                m[o + 8] * v.x + m[o + 9] * v.y + m[o + 10] * v.z + moved * m[o + 11]};
}
/* The transpose, as a unit vector; none stays none. */
LEAF vec3 by_transpose(const float *m, size_t o, vec3 v) {
  vec3 n = {m[o] * v.x + m[o + 4] * v.y + m[o + 8] * v.z,
            m[o + 1] * v.x + m[o + 5] * v.y + m[o + 9] * v.z,
            m[o + 2] * v.x + m[o + 6] * v.y + m[o + 10] * v.z};
  float square = dot(n, n);
  bool good = (square > 1e-36f) & (square < 1e36f); /* false for NaN */
  return scaled(n, good ? 1.0f / sqrtf(good ? square : 1.0f) : 0.0f);
}

#define OBJECT_TABLE(ROW)                                                                          \
  ROW(POINT_INTO, by_matrix(m, o + 12, v, 1.0f))                                                   \
  ROW(VECTOR_INTO, by_matrix(m, o + 12, v, 0.0f))                                                  \
  ROW(NORMAL_INTO, by_transpose(m, o, v))                                                          \
  ROW(POINT_OUT_OF, by_matrix(m, o, v, 1.0f))                                                      \
  ROW(VECTOR_OUT_OF, by_matrix(m, o, v, 0.0f))                                                     \
  ROW(NORMAL_OUT_OF, by_transpose(m, o + 12, v))                                                   \
  ROW(LOCATION, ((vec3){m[o + 3], m[o + 7], m[o + 11]}))                                           \
  ROW(COLOR, ((vec3){m[o + 24], m[o + 25], m[o + 26]}))                                            \
  ROW(NUMBERS, ((vec3){m[o + 27], m[o + 28], m[o + 29]})) /* alpha, index, random */               \
  ROW(METRES, ((vec3){m[o + 30], m[o + 31], 0.0f}))

#define OBJECT_NUMBER(WORD, formula) OBJECT_##WORD,
#define OBJECT_WORD(WORD, formula) #WORD,
enum { OBJECT_TABLE(OBJECT_NUMBER) };

typedef struct node_object {
  int what, out[3];
  operand vector[3];
} node_object;

static inline bool node_object_read(reader *r, node_object *n, graph *g) {
  static const char *const words[] = {OBJECT_TABLE(OBJECT_WORD) NULL};
  g->features->object_info = true;
  for (int k = 0; k < 3; k++)
    n->vector[k] = (operand){.at = OPERAND_NUMBER};
  return reader_word(r, "what", words, &n->what) &&
         (!reader_has(r, "vector") || graph_operands(r, g, "vector", 3, n->vector)) &&
         graph_outputs(r, g, "out", 3, n->out);
}

#define OBJECT_CASE(WORD, formula)                                                                 \
  case OBJECT_##WORD:                                                                              \
    _Pragma("omp simd") for (size_t i = g.begin; i < g.end; i++) {                                 \
      size_t o = OBJECT_FLOATS * (size_t)point->object[i];                                         \
      vec3 v = {vx[i], vy[i], vz[i]};                                                              \
      (void)v;                                                                                     \
      v = formula;                                                                                 \
      x[i] = v.x;                                                                                  \
      y[i] = v.y;                                                                                  \
      z[i] = v.z;                                                                                  \
    }                                                                                              \
    break;

LEAF void node_object_run(const node_object *n, lane_run g, const corners *corner,
                          const surfaces *restrict point, inputs *at) {
  const float *vx = lane_of(at, n->vector[0], 0, g), *vy = lane_of(at, n->vector[1], 1, g);
  const float *vz = lane_of(at, n->vector[2], 2, g), *m = (const float *)point->objects;
  float *x = at->at[n->out[0]], *y = at->at[n->out[1]], *z = at->at[n->out[2]];
  (void)corner;
  switch (n->what) { OBJECT_TABLE(OBJECT_CASE) }
}

#endif
