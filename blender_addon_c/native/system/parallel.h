/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LIBSHADE_PARALLEL_H
#define LIBSHADE_PARALLEL_H

#include <stddef.h>

/*
 * Call work(context, i) for i = 0 … count - 1, each once, in any order, on up to
 * `threads` threads, this one included. Falls back to fewer threads when the
 * system gives none. Denormals are flushed to zero on all of them.
 */
void parallel_for(int threads, size_t count, void (*work)(void *context, size_t i), void *context);

/* Number of cores that this process may use. */
int parallel_cores(void);

/* Seconds of a steady clock. */
double parallel_clock(void);

#endif
