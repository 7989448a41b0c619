/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How steep bumps are about a point: writes `out`, the second moment xx, xy, yy of their slopes, of
 * which render/relief.h has made a map; 0 where bumps are even. */
#ifndef LIBSHADE_NODE_RELIEF_H
#define LIBSHADE_NODE_RELIEF_H

#include "node/common.h"

typedef struct node_relief {
  int out[3];
  struct relief_map *map; /* its own, or NULL */
} node_relief;

/* Cells of a square, which begins at `first` of the UV map and comes again and again. The moment is
 * that of a cell's middle. */
typedef struct relief_map {
  int side; /* a power of 2 */
  float first[2], scale;
  float moment[][3]; /* side * side, rows from the bottom */
} relief_map;

static inline bool node_relief_read(reader *r, node_relief *n, graph *g) {
  n->map = NULL;
  return graph_outputs(r, g, "out", 3, n->out);
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

/* Of a number in each cell between two lines of cells. */
LEAF float relief_between(const float (*low)[3], const float (*high)[3], int k, relief_place x,
                          float past) {
  return lerp(lerp(low[x.low][k], low[x.high][k], x.past),
              lerp(high[x.low][k], high[x.high][k], x.past), past);
}

LEAF void node_relief_run(const node_relief *n, lane_run g, const corners *corner,
                          const surfaces *restrict point, inputs *restrict at) {
  float *const xx = at->at[n->out[0]], *const xy = at->at[n->out[1]], *yy = at->at[n->out[2]];
  (void)corner;
  if (!n->map) {
    for (int k = 0; k < 3; k++)
      memset(at->at[n->out[k]] + g.begin, 0, (g.end - g.begin) * sizeof(float));
    return;
  }
  const float(*const moment)[3] = n->map->moment, u = n->map->first[0], v = n->map->first[1];
  const float scale = n->map->scale;
  const int side = n->map->side;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    const relief_place x = relief_find_place(point->u[i], u, scale, side);
    const relief_place y = relief_find_place(point->v[i], v, scale, side);
    const float(*low)[3] = moment + y.low * side, (*high)[3] = moment + y.high * side;
    xx[i] = relief_between(low, high, 0, x, y.past);
    xy[i] = relief_between(low, high, 1, x, y.past);
    yy[i] = relief_between(low, high, 2, x, y.past);
  }
}

#endif
