/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_NORMAL(NODE_STAGE)
STAGES(node_normal) = {.node = {NODES_NORMAL(NODE_RUN)}};
