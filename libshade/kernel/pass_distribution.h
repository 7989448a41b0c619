/* SPDX-License-Identifier: Apache-2.0 */
/* Distribution pass: points of the lobe to D, one loop per distribution. */
#define DISTRIBUTION_PASS(name)                                                                    \
  static void FN(pass_##name)(size_t count, real kx, real ky, real peak, const real *restrict t,   \
                              const real *restrict xx, const real *restrict yy,                    \
                              real *restrict d) {                                                  \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = {t[i], xx[i], yy[i]};                                                     \
      d[i] = FN(name)(p, kx, ky, peak);                                                            \
    }                                                                                              \
  }

DISTRIBUTION_PASS(ashikhmin_shirley)
DISTRIBUTION_PASS(ward)
DISTRIBUTION_PASS(ward_half)
DISTRIBUTION_PASS(beckmann)
DISTRIBUTION_PASS(ggx)
#undef DISTRIBUTION_PASS

static void FN(pass_distribution)(const shade_bsdf *b, size_t count, const real *t, const real *xx,
                                  const real *yy, real *d) {
  const real kx = b->FN(kx), ky = b->FN(ky), peak = b->FN(peak);
  switch (b->mdf) {
  case SHADE_MDF_WARD:
    FN(pass_ward)(count, kx, ky, peak, t, xx, yy, d);
    break;
  case SHADE_MDF_WARD_HALF:
    FN(pass_ward_half)(count, kx, ky, peak, t, xx, yy, d);
    break;
  case SHADE_MDF_BECKMANN:
    FN(pass_beckmann)(count, kx, ky, peak, t, xx, yy, d);
    break;
  case SHADE_MDF_GGX:
    FN(pass_ggx)(count, kx, ky, peak, t, xx, yy, d);
    break;
  default:
    FN(pass_ashikhmin_shirley)(count, kx, ky, peak, t, xx, yy, d);
  }
}

/* The same decision for one sample. */
static inline real FN(distribution)(const shade_bsdf *b, FN(lobe_point) p) {
  const real kx = b->FN(kx), ky = b->FN(ky), peak = b->FN(peak);
  switch (b->mdf) {
  case SHADE_MDF_WARD:
    return FN(ward)(p, kx, ky, peak);
  case SHADE_MDF_WARD_HALF:
    return FN(ward_half)(p, kx, ky, peak);
  case SHADE_MDF_BECKMANN:
    return FN(beckmann)(p, kx, ky, peak);
  case SHADE_MDF_GGX:
    return FN(ggx)(p, kx, ky, peak);
  default:
    return FN(ashikhmin_shirley)(p, kx, ky, peak);
  }
}
