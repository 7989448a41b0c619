/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A direction, `vector`, three operands, from world space to the shading frame (`to` SHADING), made
 * a unit vector above its horizon there (`below`: or below), or back (WORLD). Writes `out`. */
#ifndef LIBSHADE_NODE_FRAME_H
#define LIBSHADE_NODE_FRAME_H

#include "node/geometry.h"

enum { FRAME_SHADING, FRAME_WORLD };

typedef struct node_frame {
  operand vector[3];
  int to, out[3];
  bool below;
} node_frame;

static inline bool node_frame_read(reader *r, node_frame *n, graph *g) {
  static const char *const words[] = {"SHADING", "WORLD", NULL};
  n->below = false;
  return reader_may_flag(r, "below", &n->below) && graph_operands(r, g, "vector", 3, n->vector) &&
         reader_word(r, "to", words, &n->to) && graph_outputs(r, g, "out", 3, n->out);
}

/* No direction at all becomes the normal. */
LEAF vec3 unit_over(vec3 v, float lowest) {
  v.z = v.z > lowest ? v.z : lowest;
  float square = dot(v, v);
  bool good = (square > 1e-20f) & (square < 1e30f);
  vec3 unit = scaled(v, 1.0f / sqrtf(good ? square : 1.0f));
  return select3(good, unit, (vec3){0.0f, 0.0f, 1.0f});
}
LEAF vec3 upright(vec3 v) {
  return unit_over(v, 1e-4f);
}

LEAF void node_frame_run(const node_frame *n, lane_run g, const corners *corner,
                         const surfaces *restrict point, inputs *restrict at) {
  const float *x = lane_of(at, n->vector[0], 0, g), *y = lane_of(at, n->vector[1], 1, g);
  const float *z = lane_of(at, n->vector[2], 2, g);
  float *ox = at->at[n->out[0]], *oy = at->at[n->out[1]], *oz = at->at[n->out[2]];
  const bool world = n->to == FRAME_WORLD;
  const float lowest = n->below ? -1e18f : 1e-4f;
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 v = {x[i], y[i], z[i]};
    vec3 local = {dot(v, load(&point->t, i)), dot(v, load(&point->b, i)),
                  dot(v, load(&point->n, i))};
    local = unit_over(local, lowest);
    vec3 o = select3(world, world_of(point, i, v), local);
    ox[i] = o.x;
    oy[i] = o.y;
    oz[i] = o.z;
  }
}

#endif
