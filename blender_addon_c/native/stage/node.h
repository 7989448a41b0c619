/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each node's stage. */
#include "stage/stage.h"

#define NODE_STAGE(TYPE, name, OUTPUT)                                                             \
  static void stage_##name(const segment *g, const node *n, const corners *restrict corner,        \
                           const surfaces *restrict at, inputs *restrict out) {                    \
    node_##name##_run(&n->of.name, g->run, corner, at, out);                                       \
  }
NODE_TABLE(NODE_STAGE)

/* What is not perturbed, in the shading frame. */
static void stage_flat(const segment *g, inputs *restrict out) {
#pragma omp simd
  for (size_t i = g->run.begin; i < g->run.end; i++) {
    out->normal.x[i] = 0.0f;
    out->normal.y[i] = 0.0f;
    out->normal.z[i] = 1.0f;
  }
}
