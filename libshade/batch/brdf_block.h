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
static int pass_half(size_t count, VEC(wi), VEC(wo), real *restrict hx, real *restrict hy,
                     real *restrict hz, real *restrict hwo) {
  int opposite = 0;
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

static void pass_cosines_about(size_t count, VEC(n), VEC(wi), VEC(wo), real *restrict cosi,
                               real *restrict coso) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real ci = dot(nx[i], ny[i], nz[i], wix[i], wiy[i], wiz[i]);
    real co = dot(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    cosi[i] = ci > 0 ? ci : 0;
    coso[i] = lit_cosine(ci, co, wiz[i], woz[i]);
  }
}

/* The same about z, for the method that ignores n. */
static void pass_cosines_flat(size_t count, const real *restrict wiz, const real *restrict woz,
                              real *restrict cosi, real *restrict coso) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    cosi[i] = wiz[i] > 0 ? wiz[i] : 0;
    coso[i] = lit_cosine(wiz[i], woz[i], wiz[i], woz[i]);
  }
}

LEAF void pass_cosines(const bsdf *b, size_t count, vec n, vec wi, vec wo, real *cosi, real *coso) {
  if (b->carry.map == SHADE_MAP_NONE)
    pass_cosines_flat(count, wi.z, wo.z, cosi, coso);
  else
    pass_cosines_about(count, XYZ(n), XYZ(wi), XYZ(wo), cosi, coso);
}

/* d becomes f without Fresnel: 0 where coso is. li and lo may be any array but d. */
#define BRDF_PASS(NAME, word, value, label, help)                                                  \
  static void pass_brdf_##word(size_t count, const real *restrict hwo, const real *restrict cosi,  \
                               const real *restrict coso, const real *li, const real *lo,          \
                               real *restrict d) {                                                 \
    (void)li, (void)lo;                                                                            \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      angles a = {hwo[i], cosi[i], coso[i], li[i], lo[i]};                                         \
      real f = brdf_##word(d[i], a);                                                               \
      d[i] = coso[i] > 0 ? f : 0;                                                                  \
    }                                                                                              \
  }
SHADE_TABLE_BRDF(BRDF_PASS)
#undef BRDF_PASS

static void pass_brdf(const bsdf *b, size_t count, const real *hwo, const real *cosi,
                      const real *coso, const real *li, const real *lo, real *d) {
  switch (b->brdf) {
#define BRDF_CASE(NAME, word, value, label, help)                                                  \
  case SHADE_BRDF_##NAME:                                                                          \
    pass_brdf_##word(count, hwo, cosi, coso, li, lo, d);                                           \
    break;
    SHADE_TABLE_BRDF(BRDF_CASE)
#undef BRDF_CASE
  case SHADE_BRDF_COUNT:
    break;
  }
}

#endif
