/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_NOISE(NODE_STAGE)
STAGES(node_noise) = {.node = {NODES_NOISE(NODE_RUN)}};
