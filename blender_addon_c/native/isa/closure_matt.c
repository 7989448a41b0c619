/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/closure.h"

CLOSURES_MATT(CLOSURE_STAGE)
STAGES(closure_matt) = {
    .closure = {CLOSURES_MATT(CLOSURE_EVAL)},
    .albedo = {CLOSURES_MATT(CLOSURE_ALBEDO)},
    .draw = {CLOSURES_MATT(CLOSURE_DRAW)},
};
