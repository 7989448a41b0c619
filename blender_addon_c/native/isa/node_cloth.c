/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_CLOTH(NODE_STAGE)
STAGES(node_cloth) = {.node = {NODES_CLOTH(NODE_RUN)}};
