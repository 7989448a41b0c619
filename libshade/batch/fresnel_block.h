/* SPDX-License-Identifier: Apache-2.0 */
/* Fresnel: f without it to the colour channels. */
#ifndef SHADE_BATCH_FRESNEL_BLOCK_H
#define SHADE_BATCH_FRESNEL_BLOCK_H

#include "../model/fresnel.h"
#include "vec.h"

/* All three channels of a colour that no texture changes, by Schlick's Fresnel, or none: grazing
 * is 1 or 0. */
static void pass_colour(size_t count, real grazing, real f0r, real f0g, real f0b,
                        const real *restrict d, const real *restrict hwo, real *restrict r,
                        real *restrict g, real *restrict b) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real white = grazing * schlick_weight(hwo[i]), f = d[i];
    r[i] = f * (f0r + (1 - f0r) * white);
    g[i] = f * (f0g + (1 - f0g) * white);
    b[i] = f * (f0b + (1 - f0b) * white);
  }
}

/* One channel with the material's own parameters, and with those of each sample. */
#define FRESNEL_PASS(NAME, word, value, label, help)                                               \
  static void pass_fresnel_##word(size_t count, real f0, real tint, real k,                        \
                                  const real *restrict d, const real *restrict hwo,                \
                                  real *restrict out) {                                            \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) out[i] =                                \
        d[i] * fresnel_##word(f0, tint, k, hwo[i]);                                                \
  }                                                                                                \
  static void pass_each_fresnel_##word(                                                            \
      size_t count, const real *restrict f0, const real *restrict tint, const real *restrict k,    \
      const real *restrict d, const real *restrict hwo, real *restrict out) {                      \
    (void)f0, (void)tint, (void)k;                                                                 \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) out[i] =                                \
        d[i] * fresnel_##word(f0[i], tint[i], k[i], hwo[i]);                                       \
  }
SHADE_TABLE_FRESNEL(FRESNEL_PASS)
#undef FRESNEL_PASS

/* The array, or one filled with the material's own where it is read, or any where it is not. */
static const real *filled(size_t count, const real *array, int is_read, real own, real *room) {
  if (array || !is_read)
    return array ? array : room;
  for (size_t i = 0; i < count; i++)
    room[i] = own;
  return room;
}

/* Colour channel c of f; f0, tint and k are those of each sample, or NULL. */
static void pass_channel(const bsdf *b, int c, size_t count, const real *f0, const real *tint,
                         const real *k, const real *d, const real *hwo, real *out) {
  const shade_fresnel_traits reads = shade_fresnel_is(b->fresnel);
  ROOM room[3][BLOCK];
  const int each = (f0 && reads.f0) || (tint && reads.tint) || (k && reads.k);
  if (each) {
    f0 = filled(count, f0, reads.f0, numbers_of(b)->f0[c], room[0]);
    tint = filled(count, tint, reads.tint, numbers_of(b)->tint[c], room[1]);
    k = filled(count, k, reads.k, numbers_of(b)->k[c], room[2]);
  }
  switch (b->fresnel) {
#define FRESNEL_CASE(NAME, word, value, label, help)                                               \
  case SHADE_FRESNEL_##NAME:                                                                       \
    if (each)                                                                                      \
      pass_each_fresnel_##word(count, f0, tint, k, d, hwo, out);                                   \
    else                                                                                           \
      pass_fresnel_##word(count, numbers_of(b)->f0[c], numbers_of(b)->tint[c],                     \
                          numbers_of(b)->k[c], d, hwo, out);                                       \
    break;
    SHADE_TABLE_FRESNEL(FRESNEL_CASE)
#undef FRESNEL_CASE
  case SHADE_FRESNEL_COUNT:
    break;
  }
}

#endif
