/* SPDX-License-Identifier: Apache-2.0 */
/*
 * `rotate` with Ashikhmin-Shirley as one writes it down from the papers, for `shade bench`:
 * normalised axes, atan2, cosf, sinf and powf of libm. One per instruction set, compiled with
 * the flags of the library's own.
 */
#ifndef SHADE_LITERAL_H
#define SHADE_LITERAL_H

#include <stddef.h>

typedef void literal_batch(size_t count, float ex, float ey, const float *nx, const float *ny,
                           const float *nz, const float *hx, const float *hy, const float *hz,
                           float *d);

literal_batch literal_scalar, literal_sse2, literal_avx2, literal_avx512;

#endif
