/* SPDX-License-Identifier: Apache-2.0 */
/* Before and after the distribution: half vectors and cosines, then the BRDF. */
#ifndef SHADE_BATCH_BRDF_BLOCK_H
#define SHADE_BATCH_BRDF_BLOCK_H

#include "../model/brdf.h"
#include "vec.h"

/*
 * h = wi + wo, not normalised, and its cosine hwo with either. Nonzero when some lane
 * has wi = -wo, where there is no h.
 */
static int pass_half(size_t count, vec wi, vec wo, real *restrict hx, real *restrict hy,
                     real *restrict hz, real *restrict hwo) {
  int opposite = 0;
  ARRAYS(wi);
  ARRAYS(wo);
#pragma omp simd reduction(| : opposite)
  for (size_t i = 0; i < count; i++) {
    hx[i] = wix[i] + wox[i];
    hy[i] = wiy[i] + woy[i];
    hz[i] = wiz[i] + woz[i];
    opposite |= no_direction(hx[i], hy[i], hz[i]);
    hwo[i] = half_cosine(hx[i], hy[i], hz[i]);
  }
  return opposite;
}

static void pass_unit(size_t count, real *restrict hx, real *restrict hy, real *restrict hz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real scale = scale_to_unit(hx[i], hy[i], hz[i]);
    hx[i] *= scale;
    hy[i] *= scale;
    hz[i] *= scale;
  }
}

LEAF void pass_cosines_of(int flat, size_t count, vec n, vec wi, vec wo, real *restrict cosi,
                          real *restrict coso) {
  ARRAYS(n);
  ARRAYS(wi);
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const cosines c = cosines_about(flat ? (triple){0, 0, 1} : AT(n), AT(wi), AT(wo));
    cosi[i] = c.i;
    coso[i] = c.o;
  }
}

/* About n, or about z for the method that ignores n. */
static void pass_cosines(const bsdf *b, size_t count, vec n, vec wi, vec wo, real *cosi,
                         real *coso) {
  if (b->carry.map == SHADE_MAP_NONE)
    pass_cosines_of(1, count, n, wi, wo, cosi, coso);
  else
    pass_cosines_of(0, count, n, wi, wo, cosi, coso);
}

/* d becomes f without Fresnel: 0 where coso is. li and lo are read by microfacet only. */
LEAF void pass_brdf_of(shade_brdf brdf, size_t count, const real *restrict hwo,
                       const real *restrict cosi, const real *restrict coso, const real *li,
                       const real *lo, real *restrict d) {
  const int smith = brdf == SHADE_BRDF_MICROFACET;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const angles a = {hwo[i], cosi[i], coso[i], smith ? li[i] : 0, smith ? lo[i] : 0};
    const real f = brdf_value(brdf, d[i], a);
    d[i] = coso[i] > 0 ? f : 0;
  }
}
static void pass_brdf(const bsdf *b, size_t count, const real *hwo, const real *cosi,
                      const real *coso, const real *li, const real *lo, real *d) {
#define LOOP(brdf) pass_brdf_of(brdf, count, hwo, cosi, coso, li, lo, d)
  SHADE_LOOP_OF_BRDF(b->brdf)
#undef LOOP
}

#endif
