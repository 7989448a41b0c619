/* SPDX-License-Identifier: Apache-2.0 */
/* The number type of a unit; R(1.5) writes a constant of it. */
#ifndef SHADE_MODEL_REAL_H
#define SHADE_MODEL_REAL_H

#include <stdint.h>

#include "suffix.h"

/* One call that is not inlined and the loop around it stays scalar. */
#if defined(__GNUC__)
#define LEAF static inline __attribute__((always_inline))
#else
#define LEAF static inline
#endif

#if SHADE_FLOAT
#define real float
#define real_bits uint32_t
#define R(x) x##f
/*
 * Added to squares before a division by them: it is lost in any that matters, and 1e8 / TINY
 * is still finite. A maximum would not do: in vectors both of its branches are computed, and one
 * of them divides by 0.
 */
#define TINY 1e-29f
#define LEAST_NORMAL 0x1p-126f /* not to divide by 0 */
#define LOG2_UNIT 0x1p-23f     /* of log2_1p in elementary.h */
#else
#define real double
#define real_bits uint64_t
#define R(x) x
#define TINY 1e-290
#define LEAST_NORMAL 0x1p-1022
#define LOG2_UNIT 1.0
#endif

#endif
