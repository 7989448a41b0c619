/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the object that is hit says by a name: `attribute`, which of the scene's names. Writes
 * `out`, three numbers, and `more`, the fourth; 0 where it says nothing. */
#ifndef LIBSHADE_NODE_ATTRIBUTE_H
#define LIBSHADE_NODE_ATTRIBUTE_H

#include "node/common.h"

typedef struct node_attribute {
  int attribute, out[3], more;
} node_attribute;

static inline bool node_attribute_read(reader *r, node_attribute *n, graph *g) {
  g->features->object_info = true;
  return reader_integer(r, "attribute", 0, (long)g->attributes - 1, &n->attribute) &&
         graph_outputs(r, g, "out", 3, n->out) && graph_outputs(r, g, "more", 1, &n->more);
}

LEAF void node_attribute_run(const node_attribute *n, lane_run g, const corners *corner,
                             const surfaces *point, inputs *at) {
  static const float nothing[4] = {0};
  (void)corner;
  for (size_t i = g.begin; i < g.end; i++) {
    const float *told = point->objects[point->object[i]].told;
    told = told ? told + 4 * (size_t)n->attribute : nothing;
    for (int k = 0; k < 3; k++)
      at->at[n->out[k]][i] = told[k];
    at->at[n->more][i] = told[3];
  }
}

#endif
