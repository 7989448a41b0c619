/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How steep bumps are about a point: writes `out`, the second moment xx, xy, yy of their slopes, of
 * which render/relief.h has made a map; 0 where bumps are even. With `shape` long waves are the
 * surface's own: `out` has their mean x, y, too, and the moment is about that. */
#ifndef LIBSHADE_NODE_RELIEF_H
#define LIBSHADE_NODE_RELIEF_H

#include "node/common.h"

enum { RELIEF_WIDER = 8 }; /* windows of a shape are so much wider than those of moments */

typedef struct node_relief {
  int outs, out[5];
  struct relief_map *map; /* its own, or NULL */
} node_relief;

/* Cells of a square, which begins at `first` of the UV map and comes again and again. The moment is
 * that of a cell's middle. */
typedef struct relief_map {
  int side; /* a power of 2 */
  float first[2], scale;
  float (*mean)[2];  /* of a shape, in cells RELIEF_WIDER as wide, else NULL; behind the moments */
  float moment[][3]; /* side * side, rows from the bottom */
} relief_map;

static inline bool node_relief_read(reader *r, node_relief *n, graph *g) {
  bool shape = false;
  n->map = NULL;
  if (!reader_may_flag(r, "shape", &shape))
    return false;
  n->outs = shape ? 5 : 3;
  return graph_outputs(r, g, "out", n->outs, n->out);
}

/* The cell that a coordinate lies in, those between whose middles it lies, and how far it is beyond
 * the first. */
typedef struct relief_place {
  int nearest, low, high;
  float past;
} relief_place;
LEAF relief_place relief_find_place(float at, float first, float scale, int side) {
  const float x = (at - first) * scale;
  const float cells = clampf(x - floor_small(x), 0.0f, 1.0f) * (float)side;
  const float beyond = cells + ((float)side - 0.5f); /* the middle of a cell, a side farther */
  const int low = (int)beyond, last = side - 1;
  return (relief_place){(int)cells & last, low & last, (low + 1) & last, beyond - (float)low};
}

/* Of a number in each cell, of which there are `per`. */
LEAF float relief_between(const float *number, int per, int side, relief_place x, relief_place y) {
  const float *low = number + y.low * side * per, *high = number + y.high * side * per;
  return lerp(lerp(low[x.low * per], low[x.high * per], x.past),
              lerp(high[x.low * per], high[x.high * per], x.past), y.past);
}

LEAF void node_relief_run(const node_relief *n, lane_run g, const corners *corner,
                          const surfaces *restrict point, inputs *restrict at) {
  (void)corner;
  if (!n->map) {
    for (int k = 0; k < n->outs; k++)
      memset(at->at[n->out[k]] + g.begin, 0, (g.end - g.begin) * sizeof(float));
    return;
  }
  float *const xx = at->at[n->out[0]], *const xy = at->at[n->out[1]], *yy = at->at[n->out[2]];
  const float *const moment = n->map->moment[0], u = n->map->first[0], v = n->map->first[1];
  const float scale = n->map->scale;
  const int side = n->map->side;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    const relief_place x = relief_find_place(point->u[i], u, scale, side);
    const relief_place y = relief_find_place(point->v[i], v, scale, side);
    xx[i] = relief_between(moment, 3, side, x, y);
    xy[i] = relief_between(moment + 1, 3, side, x, y);
    yy[i] = relief_between(moment + 2, 3, side, x, y);
  }
  if (!n->map->mean)
    return;
  float *const mean_x = at->at[n->out[3]], *const mean_y = at->at[n->out[4]];
  const float *const mean = n->map->mean[0];
  const int wide = side / RELIEF_WIDER;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    const relief_place x = relief_find_place(point->u[i], u, scale, wide);
    const relief_place y = relief_find_place(point->v[i], v, scale, wide);
    mean_x[i] = relief_between(mean, 2, wide, x, y);
    mean_y[i] = relief_between(mean + 1, 2, wide, x, y);
  }
}

#endif
