/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each node's stage. */
#include "stage/stage.h"

#define NODE_STAGE(TYPE, name)                                                                     \
  static void stage_##name(const segment *g, const node *n, const corners *corner,                 \
                           const surfaces *at, inputs *out) {                                      \
    node_##name##_run(&n->of.name, g->run, corner, at, out);                                       \
  }
NODE_TABLE(NODE_STAGE)

/* What is not perturbed, in the shading frame. */
static void stage_flat(const segment *g, inputs *restrict out) {
  float *x = out->at[REGISTER_NORMAL], *y = out->at[REGISTER_NORMAL + 1];
  float *z = out->at[REGISTER_NORMAL + 2];
#pragma omp simd
  for (size_t i = g->run.begin; i < g->run.end; i++) {
    x[i] = 0.0f;
    y[i] = 0.0f;
    z[i] = 1.0f;
  }
}
