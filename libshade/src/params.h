/* SPDX-License-Identifier: Apache-2.0 */
/* A caller's parameters, whichever header it was built against. Private to src/. */
#ifndef SHADE_SRC_PARAMS_H
#define SHADE_SRC_PARAMS_H

#include "shade/shade.h"

/*
 * *given, with the defaults for members beyond given->size; but `hard` for the horizon, which
 * was the rule before there was a choice.
 */
shade_params shade_whole_params(const shade_params *given);

#endif
