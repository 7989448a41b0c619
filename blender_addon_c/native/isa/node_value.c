/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_VALUE(NODE_STAGE)
STAGES(node_value) = {.node = {NODES_VALUE(NODE_RUN)}};
