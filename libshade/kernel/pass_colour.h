/* SPDX-License-Identifier: Apache-2.0 */
/* Fresnel: f without it to the colour channels. */

/* All three channels of a colour that no texture changes, by Schlick's Fresnel, or none: grazing
 * is 1 or 0. */
static void FN(pass_colour)(size_t count, real grazing, real f0r, real f0g, real f0b,
                            const real *restrict d, const real *restrict hwo, real *restrict r,
                            real *restrict g, real *restrict b) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real white = grazing * FN(schlick_weight)(hwo[i]), f = d[i];
    r[i] = f * (f0r + (1 - f0r) * white);
    g[i] = f * (f0g + (1 - f0g) * white);
    b[i] = f * (f0b + (1 - f0b) * white);
  }
}

/* One channel with the material's own parameters, and with those of each sample. */
#define FRESNEL_PASS(NAME, word, value, label, help)                                               \
  static void FN(pass_fresnel_##word)(size_t count, real f0, real tint, real k,                    \
                                      const real *restrict d, const real *restrict hwo,            \
                                      real *restrict out) {                                        \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) out[i] =                                \
        d[i] * FN(fresnel_##word)(f0, tint, k, hwo[i]);                                            \
  }                                                                                                \
  static void FN(pass_each_fresnel_##word)(                                                        \
      size_t count, const real *restrict f0, const real *restrict tint, const real *restrict k,    \
      const real *restrict d, const real *restrict hwo, real *restrict out) {                      \
    (void)f0, (void)tint, (void)k;                                                                 \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) out[i] =                                \
        d[i] * FN(fresnel_##word)(f0[i], tint[i], k[i], hwo[i]);                                   \
  }
SHADE_TABLE_FRESNEL(FRESNEL_PASS)
#undef FRESNEL_PASS

/* The array, or one filled with the material's own where it is read, or any where it is not. */
static const real *FN(filled)(size_t count, const real *array, int is_read, real own, real *room) {
  if (array || !is_read)
    return array ? array : room;
  for (size_t i = 0; i < count; i++)
    room[i] = own;
  return room;
}

/* Colour channel c of f; f0, tint and k are those of each sample, or NULL. */
static void FN(pass_channel)(const bsdf *b, int c, size_t count, const real *f0, const real *tint,
                             const real *k, const real *d, const real *hwo, real *out) {
  const shade_fresnel_traits reads = shade_fresnel_is(b->fresnel);
  ROOM room[3][BLOCK];
  const int each = (f0 && reads.f0) || (tint && reads.tint) || (k && reads.k);
  if (each) {
    f0 = FN(filled)(count, f0, reads.f0, b->FN(f0)[c], room[0]);
    tint = FN(filled)(count, tint, reads.tint, b->FN(tint)[c], room[1]);
    k = FN(filled)(count, k, reads.k, b->FN(k)[c], room[2]);
  }
  switch (b->fresnel) {
#define FRESNEL_CASE(NAME, word, value, label, help)                                               \
  case SHADE_FRESNEL_##NAME:                                                                       \
    if (each)                                                                                      \
      FN(pass_each_fresnel_##word)(count, f0, tint, k, d, hwo, out);                               \
    else                                                                                           \
      FN(pass_fresnel_##word)(count, b->FN(f0)[c], b->FN(tint)[c], b->FN(k)[c], d, hwo, out);      \
    break;
    SHADE_TABLE_FRESNEL(FRESNEL_CASE)
#undef FRESNEL_CASE
  case SHADE_FRESNEL_COUNT:
    break;
  }
}

/* The same decision for one sample: all three channels. */
LEAF FN(triple) FN(fresnel)(const bsdf *b, real hwo) {
  switch (b->fresnel) {
#define FRESNEL_OF(word, c) FN(fresnel_##word)(b->FN(f0)[c], b->FN(tint)[c], b->FN(k)[c], hwo)
#define FRESNEL_CASE(NAME, word, value, label, help)                                               \
  case SHADE_FRESNEL_##NAME:                                                                       \
    return (FN(triple)){FRESNEL_OF(word, 0), FRESNEL_OF(word, 1), FRESNEL_OF(word, 2)};
    SHADE_TABLE_FRESNEL(FRESNEL_CASE)
#undef FRESNEL_CASE
#undef FRESNEL_OF
  case SHADE_FRESNEL_COUNT:
    break;
  }
  return (FN(triple)){0, 0, 0};
}
