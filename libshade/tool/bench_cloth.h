/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of cloth of shade bench. */
#ifndef SHADE_TOOL_BENCH_CLOTH_H
#define SHADE_TOOL_BENCH_CLOTH_H

typedef void bench_cloth_row(void *context, const char *what, const char *preset,
                             const char *distribution, int single, double ns, double error);

/* Times cloth on the instruction set in use, a row at a time. 0 when out of memory. */
int bench_cloth(bench_cloth_row *print, void *context);

#endif
