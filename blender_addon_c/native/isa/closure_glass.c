/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/closure.h"

CLOSURES_GLASS(CLOSURE_STAGE)
STAGES(closure_glass) = {
    .closure = {CLOSURES_GLASS(CLOSURE_EVAL)},
    .albedo = {CLOSURES_GLASS(CLOSURE_ALBEDO)},
    .draw = {CLOSURES_GLASS(CLOSURE_DRAW)},
};
