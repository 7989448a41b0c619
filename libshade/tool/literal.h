/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What `shade bench` sets beside the library, one per instruction set and compiled with the flags
 * of the library's own.
 */
#ifndef SHADE_LITERAL_H
#define SHADE_LITERAL_H

#include <stddef.h>

/*
 * `rotate` with Ashikhmin-Shirley as one writes it down from the papers: normalised axes,
 * atan2, cosf, sinf and powf of libm.
 */
typedef void literal_batch(size_t count, float ex, float ey, const float *nx, const float *ny,
                           const float *nz, const float *hx, const float *hy, const float *hz,
                           float *d);

literal_batch literal_scalar, literal_sse2, literal_avx2, literal_avx512, literal_neon;

/*
 * Reads the inputs and writes the outputs of a query and adds in between, no more: a[0] to a[5] to
 * a[9] for a distribution, a[0] to a[8] to a[9] to a[12] for a whole BRDF.
 */
typedef void stream_single_batch(int whole, size_t count, float *const *a);
typedef void stream_twice_batch(int whole, size_t count, double *const *a);

stream_single_batch stream_single_scalar, stream_single_sse2, stream_single_avx2,
    stream_single_avx512, stream_single_neon;
stream_twice_batch stream_twice_scalar, stream_twice_sse2, stream_twice_avx2, stream_twice_avx512,
    stream_twice_neon;

#endif
