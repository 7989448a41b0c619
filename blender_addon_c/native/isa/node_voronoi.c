/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_VORONOI(NODE_STAGE)
STAGES(node_voronoi) = {.node = {NODES_VORONOI(NODE_RUN)}};
