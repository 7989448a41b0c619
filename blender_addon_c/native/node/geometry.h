/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the surface itself is: `what`, a word of the table. Writes `out`, three numbers; directions
 * in world space, towards the eye where a surface has two sides. `shift`, of UV, two operands: how
 * far from the point along u and v, or where these have no area along edges. */
#ifndef LIBSHADE_NODE_GEOMETRY_H
#define LIBSHADE_NODE_GEOMETRY_H

#include "node/common.h"

LEAF vec3 world_of(const surfaces *at, size_t i, vec3 v) {
  vec3 t = load(&at->t, i), b = load(&at->b, i), n = load(&at->n, i);
  return (vec3){v.x * t.x + v.y * b.x + v.z * n.x, v.x * t.y + v.y * b.y + v.z * n.y,
                v.x * t.z + v.y * b.z + v.z * n.z};
}

LEAF vec3 geometry_uv(const surfaces *at, size_t i) {
  return (vec3){at->u[i], at->v[i], 0.0f};
}
LEAF vec3 geometry_position(const surfaces *at, size_t i) {
  return load(&at->p, i);
}
LEAF vec3 geometry_normal(const surfaces *at, size_t i) {
  return load(&at->n, i);
}
LEAF vec3 geometry_true_normal(const surfaces *at, size_t i) {
  vec3 g = load(&at->g, i);
  return scaled(g, 1.0f / sqrtf(dot(g, g) + 1e-38f));
}
LEAF vec3 geometry_tangent(const surfaces *at, size_t i) {
  return load(&at->t, i);
}
LEAF vec3 geometry_along_u(const surfaces *at, size_t i) {
  return load(&at->du, i);
}
LEAF vec3 geometry_along_v(const surfaces *at, size_t i) {
  return load(&at->dv, i);
}
LEAF vec3 geometry_incoming(const surfaces *at, size_t i) {
  return world_of(at, i, load(&at->wo, i));
}
LEAF vec3 geometry_reflection(const surfaces *at, size_t i) {
  return world_of(at, i, (vec3){-at->wo.x[i], -at->wo.y[i], at->wo.z[i]});
}
LEAF vec3 geometry_backfacing(const surfaces *at, size_t i) {
  float back = at->side[i] < 0.0f ? 1.0f : 0.0f;
  return (vec3){back, back, back};
}

#define GEOMETRY_TABLE(ROW)                                                                        \
  ROW(UV, uv)                                                                                      \
  ROW(POSITION, position)                                                                          \
  ROW(NORMAL, normal)                                                                              \
  ROW(TRUE_NORMAL, true_normal)                                                                    \
  ROW(TANGENT, tangent)                                                                            \
  ROW(ALONG_U, along_u)                                                                            \
  ROW(ALONG_V, along_v)                                                                            \
  ROW(INCOMING, incoming)                                                                          \
  ROW(REFLECTION, reflection)                                                                      \
  ROW(BACKFACING, backfacing)

#define GEOMETRY_NUMBER(WORD, name) GEOMETRY_##WORD,
#define GEOMETRY_WORD(WORD, name) #WORD,
enum { GEOMETRY_TABLE(GEOMETRY_NUMBER) };

typedef struct node_geometry {
  int what, out[3];
  bool shifted;
  operand shift[2];
} node_geometry;

static inline bool node_geometry_read(reader *r, node_geometry *n, graph *g) {
  static const char *const words[] = {GEOMETRY_TABLE(GEOMETRY_WORD) NULL};
  n->shifted = reader_has(r, "shift");
  return reader_word(r, "what", words, &n->what) &&
         (!n->shifted || (n->what == GEOMETRY_UV ? graph_operands(r, g, "shift", 2, n->shift)
                                                 : reader_fail(r, "shift: only UV has one"))) &&
         graph_outputs(r, g, "out", 3, n->out);
}

/* Does it need position by u and v? */
static inline bool geometry_stretches(const node_geometry *n) {
  return n->what == GEOMETRY_ALONG_U || n->what == GEOMETRY_ALONG_V;
}

#define GEOMETRY_CASE(WORD, name)                                                                  \
  case GEOMETRY_##WORD:                                                                            \
    _Pragma("omp simd") for (size_t i = g.begin; i < g.end; i++) {                                 \
      vec3 v = geometry_##name(point, i);                                                          \
      x[i] = v.x;                                                                                  \
      y[i] = v.y;                                                                                  \
      z[i] = v.z;                                                                                  \
    }                                                                                              \
    break;

/* Where a map has no area a picture shows one line of itself or one point, and no more beside it.
 */
LEAF void geometry_shifted_uv(bool edges, const node_geometry *n, lane_run g,
                              const surfaces *restrict point, inputs *restrict at) {
  const float *su = lane_of(at, n->shift[0], 0, g), *sv = lane_of(at, n->shift[1], 1, g);
  float *x = at->at[n->out[0]], *y = at->at[n->out[1]], *z = at->at[n->out[2]];
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float u = su[i], v = sv[i];
    x[i] = point->u[i] + (edges ? u * point->u_along.x[i] + v * point->v_along.x[i] : u);
    y[i] = point->v[i] + (edges ? u * point->u_along.y[i] + v * point->v_along.y[i] : v);
    z[i] = 0.0f;
  }
}

LEAF void node_geometry_run(const node_geometry *n, lane_run g, const corners *corner,
                            const surfaces *restrict point, inputs *restrict at) {
  float *x = at->at[n->out[0]], *y = at->at[n->out[1]], *z = at->at[n->out[2]];
  (void)corner;
  if (n->shifted && point->edges)
    geometry_shifted_uv(true, n, g, point, at);
  else if (n->shifted)
    geometry_shifted_uv(false, n, g, point, at);
  else
    switch (n->what) { GEOMETRY_TABLE(GEOMETRY_CASE) }
}

#endif
