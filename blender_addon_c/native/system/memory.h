/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How much memory the module holds. The linker sends its calls of malloc and its kin to memory.c
 * (native.mk), so that none is left out; Embree tells of its own. Buffers of Python are not in it,
 * nor what denoising takes.
 */
#ifndef LIBSHADE_MEMORY_H
#define LIBSHADE_MEMORY_H

#include <stddef.h>

/* `size` bytes that begin at a multiple of `alignment`, a power of two from 16 on; NULL when out of
 * memory. free() is for it, too. */
void *memory_aligned(size_t alignment, size_t size);

/* Bytes more, or fewer. Any thread. */
void memory_add(long long bytes);

long long memory_used(void);
/* The most since memory_restart. */
long long memory_peak(void);
void memory_restart(void);

#endif
