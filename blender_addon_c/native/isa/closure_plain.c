/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

#include "stage/closure.h"

CLOSURES_PLAIN(CLOSURE_STAGE)
STAGES(closure_plain) = {
    .closure = {CLOSURES_PLAIN(CLOSURE_EVAL)},
    .albedo = {CLOSURES_PLAIN(CLOSURE_ALBEDO)},
    .draw = {CLOSURES_PLAIN(CLOSURE_DRAW)},
};
