/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How steep bumps are about a point: writes `out`, the second moment xx, xy, yy of their slopes, of
 * which render/relief.h has made a relief; 0 where bumps are even. With `shape` long waves are the
 * surface's own: `out` has their mean x, y, too, and the moment is about that. */
#ifndef LIBSHADE_NODE_RELIEF_H
#define LIBSHADE_NODE_RELIEF_H

#include "node/common.h"
#include "shade/maps.h"

typedef struct node_relief {
  int outs, out[5];
  shade_relief *relief; /* its own, or NULL */
} node_relief;

static inline bool node_relief_read(reader *r, node_relief *n, graph *g) {
  bool shape = false;
  n->relief = NULL;
  if (!reader_may_flag(r, "shape", &shape))
    return false;
  n->outs = shape ? 5 : 3;
  return graph_outputs(r, g, "out", n->outs, n->out);
}

LEAF void node_relief_run(const node_relief *n, lane_run g, const corners *corner,
                          const surfaces *restrict point, inputs *restrict at) {
  (void)corner;
  float *slopes[5] = {NULL}; /* x, y, xx, xy, yy; outs begin with the moment */
  for (int k = 0; k < n->outs; k++) {
    float *const out = at->at[n->out[k]] + g.begin;
    slopes[(k + 2) % 5] = out;
    if (!n->relief)
      memset(out, 0, (g.end - g.begin) * sizeof *out);
  }
  if (n->relief)
    shade_relief_lookup_batchf(n->relief, g.end - g.begin, point->u + g.begin, point->v + g.begin,
                               slopes);
}

#endif
