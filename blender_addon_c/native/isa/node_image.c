/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/node.h"

NODES_IMAGE(NODE_STAGE)
STAGES(node_image) = {.node = {NODES_IMAGE(NODE_RUN)}};
