/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each node's stage, from its file. */
#include "node/node.h"
#include "stage/stage.h"

#define NODE_STAGE(TYPE, name)                                                                     \
  static void stage_##name(const segment *g, const node *n, const corners *corner,                 \
                           const surfaces *at, inputs *out) {                                      \
    node_##name##_run(&n->of.name, g->run, corner, at, out);                                       \
  }

#define NODE_RUN(TYPE, name) [NODE_##TYPE] = stage_##name,
