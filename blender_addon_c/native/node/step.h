/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step along the surface as long as a pixel is wide there, as far as the way of its ray says, by
 * u and v: `axis` (X, Y), which of two across each other; `scale`, how many pixels. Where no width
 * is known, `otherwise` along u or v. Writes `out`, two numbers. */
#ifndef LIBSHADE_NODE_STEP_H
#define LIBSHADE_NODE_STEP_H

#include "node/geometry.h"

typedef struct node_step {
  int axis, out[2];
  float scale, otherwise;
} node_step;

static inline bool node_step_read(reader *r, node_step *n, graph *g) {
  static const char *const words[] = {"X", "Y", NULL};
  g->features->pixel_size = true;
  return reader_word(r, "axis", words, &n->axis) &&
         reader_number_within(r, "scale", 0, 1e6f, &n->scale) &&
         reader_number_within(r, "otherwise", 1e-6f, 1, &n->otherwise) &&
         graph_outputs(r, g, "out", 2, n->out);
}

/* Across a facet's normal, as Cycles has it: (1, 1, 1) x n, or where there is none (-1, 1, 1) x n.
 */
LEAF vec3 step_across(vec3 n) {
  vec3 one = {n.z - n.y, n.x - n.z, n.y - n.x}, other = {n.z - n.y, n.x + n.z, -n.y - n.x};
  bool there = (n.x != n.y) | (n.x != n.z);
  vec3 a = select3(there, one, other);
  return scaled(a, 1.0f / sqrtf(dot(a, a) + 1e-38f));
}

LEAF void node_step_run(const node_step *n, lane_run g, const corners *corner,
                        const surfaces *restrict point, inputs *restrict at) {
  float *su = at->at[n->out[0]], *sv = at->at[n->out[1]];
  const float along = n->axis ? 0.0f : 1.0f, across = 1.0f - along, scale = n->scale;
  const float otherwise_u = along * n->otherwise, otherwise_v = across * n->otherwise;
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 facet = geometry_true_normal(point, i), a = step_across(facet), b = cross(facet, a);
    float width = scale * point->pixel[i], x = width * along, y = width * across;
    vec3 d = {x * a.x + y * b.x, x * a.y + y * b.y, x * a.z + y * b.z};
    vec3 du = load(&point->du, i), dv = load(&point->dv, i), area = cross(du, dv);
    float area2 = dot(area, area);
    bool good = (width > 0.0f) & (area2 > 1e-36f) & (area2 < 1e36f); /* false for NaN */
    float by = good ? 1.0f / area2 : 0.0f;
    su[i] = good ? dot(area, cross(d, dv)) * by : otherwise_u;
    sv[i] = good ? dot(area, cross(du, d)) * by : otherwise_v;
  }
}

#endif
