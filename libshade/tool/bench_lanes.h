/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of parameters per sample, and of normal maps, of shade bench. */
#ifndef SHADE_TOOL_BENCH_LANES_H
#define SHADE_TOOL_BENCH_LANES_H

#include "tool/bench_cloth.h"

/* Time them on the instruction set in use, a row at a time. 0 when out of memory. */
int bench_lanes(bench_cloth_row *print, void *context);
int bench_maps(bench_cloth_row *print, void *context);

#endif
