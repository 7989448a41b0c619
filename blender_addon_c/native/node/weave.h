/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Where on `cloth`, its index, a hit is, and over what extent. Writes `out`, four numbers: the
 * place along weft and warp and the extent along either, in crossings.
 *
 * It lies by the UV map, or by `vector`, six operands: x and y of a point, and what they are `step`
 * on along u, and along v, of the map. `turn`, two operands: cosine and sine of the angle that it
 * is turned by, anticlockwise; `scale`, one: what its coordinates are multiplied by. Where it does
 * not lie along u, `frame` is written, two numbers: its x axis in the shading frame.
 */
#ifndef LIBSHADE_NODE_WEAVE_H
#define LIBSHADE_NODE_WEAVE_H

#include "node/geometry.h"
#include "scene/cloth.h"

typedef struct node_weave {
  const cloth *cloth;
  operand vector[6], turn[2], scale;
  float step;
  int out[4], frame[2];
  bool fed, moved, framed; /* has a vector; is not as the map says; has a frame */
} node_weave;

static inline bool weave_read_moves(reader *r, node_weave *n, graph *g) {
  bool turned = reader_has(r, "turn"), scaled = reader_has(r, "scale");
  n->fed = reader_has(r, "vector");
  n->framed = n->fed || turned;
  n->moved = n->framed || scaled;
  n->turn[0] = n->scale = (operand){.at = OPERAND_NUMBER, .number = 1.0f};
  n->turn[1] = n->vector[0] = (operand){.at = OPERAND_NUMBER};
  n->step = 1.0f;
  return (!n->fed || (graph_operands(r, g, "vector", 6, n->vector) &&
                      reader_number_within(r, "step", 1e-6, 1, &n->step))) &&
         (!turned || graph_operands(r, g, "turn", 2, n->turn)) &&
         (!scaled || graph_operands(r, g, "scale", 1, &n->scale)) &&
         (!n->framed || graph_outputs(r, g, "frame", 2, n->frame));
}

static inline bool node_weave_read(reader *r, node_weave *n, graph *g) {
  int number;
  if (!reader_integer(r, "cloth", 0, (long)g->cloths - 1, &number) || !weave_read_moves(r, n, g) ||
      !graph_outputs(r, g, "out", 4, n->out))
    return false;
  n->cloth = &g->cloth[number];
  return true;
}

/*
 * A step q across the ray goes along v until it meets the surface again: q + s v = a du + b dv, so
 * that a = q . (dv x v) / (du . (dv x v)). Of steps as long as the pixel is wide the largest a is
 * the extent along u.
 */
LEAF void weave_extent(vec3 du, vec3 dv, vec3 eye, float width, float *along_u, float *along_v) {
  vec3 across_v = cross(dv, eye), across_u = cross(eye, du);
  float area = fabsf(dot(du, across_v));
  float lu = sqrtf(dot(across_v, across_v)), lv = sqrtf(dot(across_u, across_u));
  /* along the surface a footprint is seen as no longer than a thousand times its width */
  float least = 1e-3f * lu * sqrtf(dot(du, du));
  area = area > least ? area : least;
  float scale = width / (area > 1e-30f ? area : 1e-30f);
  *along_u = scale * lu;
  *along_v = scale * lv;
}

/* The frame's y axis is cross(N, T): where the UV map is mirrored, or seen from behind, v counts
 * the other way. */
LEAF void weave_by_map(const node_weave *n, lane_run g, const corners *restrict corner,
                       const surfaces *restrict point, inputs *restrict at) {
  float *u = at->at[n->out[0]], *v = at->at[n->out[1]];
  float *along_u = at->at[n->out[2]], *along_v = at->at[n->out[3]];
  const float per_u = n->cloth->per_u, per_v = n->cloth->per_v;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 eye = world_of(point, i, load(&point->wo, i));
    float turned = corner->handed[i] * point->side[i], lu, lv;
    weave_extent(load(&point->du, i), load(&point->dv, i), eye, point->width[i], &lu, &lv);
    u[i] = clampf(per_u * point->u[i], -1e8f, 1e8f);
    v[i] = clampf(per_v * turned * point->v[i], -1e8f, 1e8f);
    along_u[i] = clampf(per_u * lu, 0.0f, 1e8f);
    along_v[i] = clampf(per_v * lv, 0.0f, 1e8f);
  }
}

/* A vector of the surface's plane as one of length 1 in it; what is none becomes x. */
LEAF vec3 weave_axis(float x, float y) {
  float square = x * x + y * y;
  bool good = (square > 1e-30f) & (square < 1e30f); /* false for NaN */
  float size = 1.0f / sqrtf(good ? square : 1.0f);
  return (vec3){good ? size * x : 1.0f, good ? size * y : 0.0f, 0.0f};
}

/*
 * Position by x and y of a vector is position by u and v times the inverse of what these change in
 * it. The cloth's x axis is where x grows; y lies across it, on the side where y grows.
 */
LEAF void weave_moved(const node_weave *n, lane_run g, const corners *restrict corner,
                      const surfaces *restrict point, inputs *restrict at) {
  const float *lane[6], *cosine = lane_of(at, n->turn[0], 6, g);
  const float *sine = lane_of(at, n->turn[1], 7, g), *scale = lane_of(at, n->scale, 8, g);
  for (int k = 0; k < 6; k++)
    lane[k] = n->fed ? lane_of(at, n->vector[k], k, g) : k % 2 ? point->v : point->u;
  const float *x = lane[0], *y = lane[1], *xu = lane[2], *yu = lane[3], *xv = lane[4];
  const float *yv = lane[5];
  float *frame_x = n->framed ? at->at[n->frame[0]] : at->constant[9];
  float *frame_y = n->framed ? at->at[n->frame[1]] : at->constant[10];
  float *u = at->at[n->out[0]], *v = at->at[n->out[1]];
  float *along_u = at->at[n->out[2]], *along_v = at->at[n->out[3]];
  const float per_u = n->cloth->per_u, per_v = n->cloth->per_v, per_step = 1.0f / n->step;
  const bool fed = n->fed;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float a = fed ? (xu[i] - x[i]) * per_step : 1.0f, b = fed ? (xv[i] - x[i]) * per_step : 0.0f;
    float c = fed ? (yu[i] - y[i]) * per_step : 0.0f, d = fed ? (yv[i] - y[i]) * per_step : 1.0f;
    float area = a * d - b * c;
    bool flat = !((fabsf(area) > 1e-20f) & (fabsf(area) < 1e20f));
    float by = flat ? 0.0f : 1.0f / (flat ? 1.0f : area);
    vec3 du = load(&point->du, i), dv = load(&point->dv, i);
    vec3 ex = {by * (d * du.x - c * dv.x), by * (d * du.y - c * dv.y), by * (d * du.z - c * dv.z)};
    vec3 ey = {by * (a * dv.x - b * du.x), by * (a * dv.y - b * du.y), by * (a * dv.z - b * du.z)};
    vec3 side = cross(load(&point->n, i), ex);
    float turned = fed ? (dot(side, ey) < 0.0f ? -1.0f : 1.0f) : corner->handed[i] * point->side[i];
    vec3 along = weave_axis(dot(ex, load(&point->t, i)), dot(ex, load(&point->b, i)));
    along = select3(fed, along, (vec3){1.0f, 0.0f, 0.0f});

    vec3 turn = weave_axis(cosine[i], sine[i]);
    float size = fabsf(scale[i]) < 1e18f ? scale[i] : 0.0f, flip = size < 0.0f ? -1.0f : 1.0f;
    vec3 axis = weave_axis(turn.x * along.x - turned * turn.y * along.y,
                           turn.x * along.y + turned * turn.y * along.x);
    frame_x[i] = flip * axis.x;
    frame_y[i] = flip * axis.y;
    u[i] = clampf(per_u * size * (turn.x * x[i] + turn.y * y[i]), -1e8f, 1e8f);
    v[i] = clampf(per_v * turned * size * (turn.x * y[i] - turn.y * x[i]), -1e8f, 1e8f);

    vec3 eye = world_of(point, i, load(&point->wo, i));
    vec3 ax = {turn.x * ex.x + turn.y * ey.x, turn.x * ex.y + turn.y * ey.y,
               turn.x * ex.z + turn.y * ey.z};
    vec3 ay = {turn.x * ey.x - turn.y * ex.x, turn.x * ey.y - turn.y * ex.y,
               turn.x * ey.z - turn.y * ex.z};
    float lu, lv;
    weave_extent(ax, ay, eye, point->width[i], &lu, &lv);
    along_u[i] = clampf(per_u * fabsf(size) * lu, 0.0f, 1e8f);
    along_v[i] = clampf(per_v * fabsf(size) * lv, 0.0f, 1e8f);
  }
}

LEAF void node_weave_run(const node_weave *n, lane_run g, const corners *restrict corner,
                         const surfaces *restrict point, inputs *restrict at) {
  if (n->moved)
    weave_moved(n, g, corner, point, at);
  else
    weave_by_map(n, g, corner, point, at);
}

#endif
