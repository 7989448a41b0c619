/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much each of a box's three sides is seen along `normal`, three operands: its x, its y and its
 * z sides, alone or, near the edges, `blend` (0 to 1) into each other, as in Cycles. Writes `out`,
 * three numbers whose sum is 1. */
#ifndef LIBSHADE_NODE_BOX_H
#define LIBSHADE_NODE_BOX_H

#include "node/common.h"

typedef struct node_box {
  operand normal[3];
  float blend;
  int out[3];
} node_box;

static inline bool node_box_read(reader *r, node_box *n, graph *g) {
  return graph_operands(r, g, "normal", 3, n->normal) &&
         reader_number_within(r, "blend", 0, 1, &n->blend) && graph_outputs(r, g, "out", 3, n->out);
}

/* Of a point between two sides the share of the first; `per`: 1 / blend, 0 for none. */
LEAF float box_share(float a, float b, float blend, float per) {
  float sum = a + b;
  return clampf((a / (sum > 0.0f ? sum : 1.0f) - 0.5f * (1.0f - blend)) * per, 0.0f, 1.0f);
}

LEAF vec3 box_sides(vec3 n, float blend, float per) {
  float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z), sum = x + y + z;
  float limit = 0.5f * (1.0f + blend), rest = 1.0f - limit;
  sum = sum > 0.0f ? 1.0f / sum : 0.0f;
  x *= sum, y *= sum, z *= sum;
  bool only_x = (x > limit * (x + y)) & (x > limit * (x + z));
  bool only_y = (y > limit * (x + y)) & (y > limit * (y + z));
  bool only_z = (z > limit * (x + z)) & (z > limit * (y + z));
  bool no_z = z < rest * (x + y), no_x = x < rest * (y + z), no_y = y < rest * (x + z);
  float xy = box_share(x, y, blend, per), yz = box_share(y, z, blend, per);
  float xz = box_share(x, z, blend, per);
  vec3 all = {((2.0f - limit) * x + limit - 1.0f) * per, ((2.0f - limit) * y + limit - 1.0f) * per,
              ((2.0f - limit) * z + limit - 1.0f) * per};
  vec3 w = select3(no_y, (vec3){xz, 0.0f, 1.0f - xz}, all);
  w = select3(no_x, (vec3){0.0f, yz, 1.0f - yz}, w);
  w = select3(no_z, (vec3){xy, 1.0f - xy, 0.0f}, w);
  w = select3(per > 0.0f, w, (vec3){1.0f, 0.0f, 0.0f}); /* on an edge */
  w = select3(only_z, (vec3){0.0f, 0.0f, 1.0f}, w);
  w = select3(only_y, (vec3){0.0f, 1.0f, 0.0f}, w);
  return select3(only_x, (vec3){1.0f, 0.0f, 0.0f}, w);
}

LEAF void node_box_run(const node_box *n, lane_run g, const corners *corner, const surfaces *point,
                       inputs *restrict at) {
  const float *x = lane_of(at, n->normal[0], 0, g), *y = lane_of(at, n->normal[1], 1, g);
  const float *z = lane_of(at, n->normal[2], 2, g);
  float *ox = at->at[n->out[0]], *oy = at->at[n->out[1]], *oz = at->at[n->out[2]];
  const float blend = n->blend, per = blend > 0.0f ? 1.0f / blend : 0.0f;
  (void)corner, (void)point;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 w = box_sides((vec3){x[i], y[i], z[i]}, blend, per);
    ox[i] = w.x;
    oy[i] = w.y;
    oz[i] = w.z;
  }
}

#endif
