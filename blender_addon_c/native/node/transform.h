/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A vector through a matrix: `vector`, three operands; `matrix`, three rows of four; `unit`,
 * whether what comes out is made a unit vector. Writes `out`. */
#ifndef LIBSHADE_NODE_TRANSFORM_H
#define LIBSHADE_NODE_TRANSFORM_H

#include "node/common.h"

typedef struct node_transform {
  operand vector[3];
  float matrix[12];
  bool unit;
  int out[3];
} node_transform;

static inline bool node_transform_read(reader *r, node_transform *n, graph *g) {
  return graph_operands(r, g, "vector", 3, n->vector) &&
         reader_floats(r, "matrix", 12, n->matrix) && reader_flag(r, "unit", &n->unit) &&
         graph_outputs(r, g, "out", 3, n->out);
}

LEAF void node_transform_run(const node_transform *n, lane_run g, const corners *corner,
                             const surfaces *point, inputs *at) {
  const float *x = lane_of(at, n->vector[0], 0, g), *y = lane_of(at, n->vector[1], 1, g);
  const float *z = lane_of(at, n->vector[2], 2, g), *m = n->matrix;
  float *ox = at->at[n->out[0]], *oy = at->at[n->out[1]], *oz = at->at[n->out[2]];
  const float m00 = m[0], m01 = m[1], m02 = m[2], m03 = m[3], m10 = m[4], m11 = m[5];
  const float m12 = m[6], m13 = m[7], m20 = m[8], m21 = m[9], m22 = m[10], m23 = m[11];
  const bool unit = n->unit;
  (void)corner, (void)point;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 v = {m00 * x[i] + m01 * y[i] + m02 * z[i] + m03,
              m10 * x[i] + m11 * y[i] + m12 * z[i] + m13,
              m20 * x[i] + m21 * y[i] + m22 * z[i] + m23};
    float square = dot(v, v);
    float scale = (unit & (square > 1e-30f)) ? 1.0f / sqrtf(square) : 1.0f;
    ox[i] = v.x * scale;
    oy[i] = v.y * scale;
    oz[i] = v.z * scale;
  }
}

#endif
