/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/closure.h"

CLOSURES_METAL(CLOSURE_STAGE)
STAGES(closure_metal) = {
    .closure = {CLOSURES_METAL(CLOSURE_EVAL)},
    .albedo = {CLOSURES_METAL(CLOSURE_ALBEDO)},
    .draw = {CLOSURES_METAL(CLOSURE_DRAW)},
};
