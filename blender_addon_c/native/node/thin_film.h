/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a thin film reflects at `cosine`: operands `film_thickness`, in nm, and `film_ior`, one
 * each, `film_eta` and `film_k`, three each, of what is below. Writes `out`, three numbers.
 */
#ifndef LIBSHADE_NODE_THIN_FILM_H
#define LIBSHADE_NODE_THIN_FILM_H

#include "node/interference.h"

#include <string.h>

typedef struct node_thin_film {
  thin_film film;
  operand cosine;
  int out[3];
} node_thin_film;

static inline bool node_thin_film_read(reader *r, node_thin_film *n, graph *g) {
  return thin_film_read(r, &n->film, g) && graph_operands(r, g, "cosine", 1, &n->cosine) &&
         graph_outputs(r, g, "out", 3, n->out);
}

LEAF void node_thin_film_run(const node_thin_film *n, lane_run g, const corners *corner,
                             const surfaces *restrict point, inputs *at) {
  const thin_film_lanes from = thin_film_lanes_of(&n->film, at, g);
  const float *cosine = lane_of(at, n->cosine, 11, g);
  (void)corner, (void)point;
  for (size_t begin = g.begin; begin < g.end; begin += FILM_ROOM) {
    size_t left = g.end - begin, count = left < FILM_ROOM ? left : FILM_ROOM;
    float color[3][FILM_ROOM]; /* what is asked may lie where the answer goes */
    for (int k = 0; k < 3; k++)
      thin_film_reflects(false, &from, k, begin, count, cosine + begin, color[k]);
    for (int k = 0; k < 3; k++)
      memcpy(at->at[n->out[k]] + begin, color[k], count * sizeof(float));
  }
}

#endif
