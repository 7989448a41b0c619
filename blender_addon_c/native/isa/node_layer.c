/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_LAYER(NODE_STAGE)
STAGES(node_layer) = {.node = {NODES_LAYER(NODE_RUN)}};
