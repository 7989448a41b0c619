/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One of the scene's layers at the point: `layer`, its number; `shift`, where it is there, two
 * operands: how far along u and v from there. Writes `out`, three numbers, and, where it is there,
 * `more`, the fourth. Of tangents three are a direction in world space, the fourth is their
 * handedness. */
#ifndef LIBSHADE_NODE_LAYER_H
#define LIBSHADE_NODE_LAYER_H

#include "node/common.h"
#include "scene/geometry.h"

typedef struct node_layer {
  int layer, out[3], more; /* more: -1 where nothing asks for it */
  bool shifted;
  operand shift[2];
  const layer *of;
} node_layer;

static inline bool node_layer_read(reader *r, node_layer *n, graph *g) {
  n->more = -1;
  n->shifted = reader_has(r, "shift");
  g->features->object_info = true;
  return reader_integer(r, "layer", 0, (long)g->layers - 1, &n->layer) &&
         (!n->shifted || graph_operands(r, g, "shift", 2, n->shift)) &&
         graph_outputs(r, g, "out", 3, n->out) &&
         (!reader_has(r, "more") || graph_outputs(r, g, "more", 1, &n->more));
}

static inline bool node_layer_build(node_layer *n, const node_place *place) {
  n->of = place->layer + n->layer;
  return true;
}

/* Weights of the second and third corner, so far along u and v. As position by u and v
 * (scene.h, stretch): where the UV map says nothing of the surface, along its edges. */
LEAF void layer_weights(const node_layer *n, lane_run g, const surfaces *restrict point,
                        const float *restrict du, const float *restrict dv, float *restrict wa,
                        float *restrict wb) {
  const float *record = n->of->record;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    size_t at = 32 * (size_t)point->record[i];
    float u0 = record[at + 6], v0 = record[at + 7];
    float u1 = record[at + 14] - u0, v1 = record[at + 15] - v0;
    float u2 = record[at + 22] - u0, v2 = record[at + 23] - v0;
    float area = u1 * v2 - u2 * v1;
    bool good =
        uv_spans(u0, v0, record[at + 14], record[at + 15], record[at + 22], record[at + 23]);
    float by = good ? 1.0f / area : 1.0f;
    wa[i] = point->w1[i] + (good ? (du[i] * v2 - dv[i] * u2) * by : du[i]);
    wb[i] = point->w2[i] + (good ? (dv[i] * u1 - du[i] * v1) * by : dv[i]);
  }
}

LEAF void layer_mixed(int width, const node_layer *n, lane_run g, const uint32_t *restrict record,
                      const float *restrict wa, const float *restrict wb, inputs *restrict at) {
  const float *corner = n->of->corner;
  float *x = at->at[n->out[0]], *y = at->at[n->out[1]], *z = at->at[n->out[2]];
  float *w = n->more < 0 ? at->constant[2] : at->at[n->more];
  const size_t stride = (size_t)width;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    size_t first = 3 * stride * (size_t)record[i];
    float a = wa[i], b = wb[i], c = 1.0f - a - b;
    x[i] = c * corner[first] + a * corner[first + stride] + b * corner[first + 2 * stride];
    y[i] =
        c * corner[first + 1] + a * corner[first + stride + 1] + b * corner[first + 2 * stride + 1];
    z[i] = width < 4 ? 0.0f
                     : c * corner[first + 2] + a * corner[first + stride + 2] +
                           b * corner[first + 2 * stride + 2];
    w[i] = width < 4 ? 1.0f
                     : c * corner[first + 3] + a * corner[first + stride + 3] +
                           b * corner[first + 2 * stride + 3];
  }
}

/* Tangents of what is kept once into the world; their handedness is that of the first corner. */
LEAF void layer_turn(const node_layer *n, lane_run g, const surfaces *restrict point,
                     inputs *restrict at) {
  float *x = at->at[n->out[0]], *y = at->at[n->out[1]], *z = at->at[n->out[2]];
  float *w = n->more < 0 ? at->constant[2] : at->at[n->more];
  for (size_t i = g.begin; i < g.end; i++) {
    float hand = n->of->corner[12 * (size_t)point->record[i] + 3];
    if (point->placed && point->instance[i]) {
      const placed *p = &point->placed[point->instance[i]];
      vec3 v = {x[i], y[i], z[i]};
      x[i] = p->linear[0][0] * v.x + p->linear[0][1] * v.y + p->linear[0][2] * v.z;
      y[i] = p->linear[1][0] * v.x + p->linear[1][1] * v.y + p->linear[1][2] * v.z;
      z[i] = p->linear[2][0] * v.x + p->linear[2][1] * v.y + p->linear[2][2] * v.z;
      hand *= p->mirror;
    }
    w[i] = hand < 0.0f ? -1.0f : 1.0f;
  }
}

LEAF void node_layer_run(const node_layer *n, lane_run g, const corners *corner,
                         const surfaces *point, inputs *at) {
  float *a = at->constant[0], *b = at->constant[1];
  const float *wa = point->w1, *wb = point->w2;
  (void)corner;
  if (n->shifted) {
    layer_weights(n, g, point, lane_of(at, n->shift[0], 3, g), lane_of(at, n->shift[1], 4, g), a,
                  b);
    wa = a;
    wb = b;
  }
  if (n->of->width == 2)
    layer_mixed(2, n, g, point->record, wa, wb, at);
  else
    layer_mixed(4, n, g, point->record, wa, wb, at);
  if (n->of->tangents_of >= 0)
    layer_turn(n, g, point, at);
}

#endif
