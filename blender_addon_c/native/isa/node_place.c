/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_PLACE(NODE_STAGE)
STAGES(node_place) = {.node = {NODES_PLACE(NODE_RUN)}};
