/* SPDX-License-Identifier: Apache-2.0 */
/* Fresnel: f without it to the colour channels. */
#ifndef SHADE_BATCH_FRESNEL_BLOCK_H
#define SHADE_BATCH_FRESNEL_BLOCK_H

#include "../model/fresnel.h"
#include "vec.h"

LEAF void pass_fresnel(shade_fresnel fresnel, size_t count, const real *restrict f0,
                       const real *restrict tint, const real *restrict k, const real *restrict d,
                       const real *restrict hwo, real *restrict out) {
  const shade_fresnel_traits reads = shade_fresnel_is(fresnel);
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = d[i] * fresnel_value(fresnel, reads.f0 ? f0[i] : 0, reads.tint ? tint[i] : 0,
                                  reads.k ? k[i] : 0, hwo[i]);
}

/* One colour channel of f. */
static void pass_channel(const bsdf *b, size_t count, const real *f0, const real *tint,
                         const real *k, const real *d, const real *hwo, real *out) {
#define LOOP(fresnel) pass_fresnel(fresnel, count, f0, tint, k, d, hwo, out)
  SHADE_LOOP_OF(FRESNEL, b->fresnel)
#undef LOOP
}

#endif
