/* SPDX-License-Identifier: Apache-2.0 */
/* Distribution pass: points of the lobe to D. */

static void FN(pass_ashikhmin_shirley)(size_t count, real ex, real ey, real peak,
                                       const real *restrict t, const real *restrict xx,
                                       const real *restrict yy, real *restrict d) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    FN(lobe_point) p = {t[i], xx[i], yy[i]};
    d[i] = FN(ashikhmin_shirley)(p, ex, ey, peak);
  }
}

static void FN(pass_distribution)(const shade_bsdf *b, size_t count, const real *t, const real *xx,
                                  const real *yy, real *d) {
  FN(pass_ashikhmin_shirley)(count, b->FN(ex), b->FN(ey), b->FN(peak), t, xx, yy, d);
}

static inline real FN(distribution)(const shade_bsdf *b, FN(lobe_point) p) {
  return FN(ashikhmin_shirley)(p, b->FN(ex), b->FN(ey), b->FN(peak));
}
