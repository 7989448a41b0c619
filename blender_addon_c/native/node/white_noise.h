/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A random number and a random colour for each place that differs in a single bit: `dimensions`;
 * `at`, four operands. Writes `out`, four: red, green, blue, and the number. */
#ifndef LIBSHADE_NODE_WHITE_NOISE_H
#define LIBSHADE_NODE_WHITE_NOISE_H

#include "node/common.h"
#include "node/hash.h"

typedef struct node_white_noise {
  int dimensions, out[4];
  operand at[LATTICE_DIMENSIONS];
} node_white_noise;

static inline bool node_white_noise_read(reader *r, node_white_noise *n, graph *g) {
  return reader_integer(r, "dimensions", 1, LATTICE_DIMENSIONS, &n->dimensions) &&
         graph_operands(r, g, "at", LATTICE_DIMENSIONS, n->at) &&
         graph_outputs(r, g, "out", 4, n->out);
}

#define WHITE_NOISE_CASE(dimensions)                                                               \
  case dimensions:                                                                                 \
    _Pragma("omp simd") for (size_t i = g.begin; i < g.end; i++) {                                 \
      vec4 p = {x[i], y[i], z[i], w[i]};                                                           \
      vec3 c = chances3(dimensions, p);                                                            \
      red[i] = c.x;                                                                                \
      green[i] = c.y;                                                                              \
      blue[i] = c.z;                                                                               \
      number[i] = c.x;                                                                             \
    }                                                                                              \
    break;

LEAF void node_white_noise_run(const node_white_noise *n, lane_run g, const corners *corner,
                               const surfaces *point, inputs *at) {
  const float *x = lane_of(at, n->at[0], 0, g), *y = lane_of(at, n->at[1], 1, g);
  const float *z = lane_of(at, n->at[2], 2, g), *w = lane_of(at, n->at[3], 3, g);
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *number = at->at[n->out[3]];
  (void)corner, (void)point;
  switch (n->dimensions) {
    WHITE_NOISE_CASE(1)
    WHITE_NOISE_CASE(2)
    WHITE_NOISE_CASE(3)
    WHITE_NOISE_CASE(4)
  }
}

#endif
