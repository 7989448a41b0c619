/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of shade bench share, and the parts that are in files of their own. */
#ifndef SHADE_TOOL_BENCH_PARTS_H
#define SHADE_TOOL_BENCH_PARTS_H

#include <stdint.h>

#include "port/threads.h"

/* The clock on the wall: a thread's own time is a guess on virtual machines, at times a short one.
 */
static inline double bench_seconds(void) {
  return shade_port_seconds();
}

static inline double bench_uniform(uint64_t *state) { /* splitmix64 */
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

typedef void bench_row(void *context, const char *what, const char *method,
                       const char *distribution, int single, double ns, double error);

/*
 * Time cloth, parameters of each sample, normal maps, diffuse models, lobes of filtered maps, the
 * reference on the instruction set in use, a row at a time. 0 when out of memory.
 */
int bench_cloth(bench_row *print, void *context);
int bench_lanes(bench_row *print, void *context);
int bench_maps(bench_row *print, void *context);
int bench_diffuse(bench_row *print, void *context);
int bench_lobes(bench_row *print, void *context);
int bench_reference(bench_row *print, void *context);

#endif
