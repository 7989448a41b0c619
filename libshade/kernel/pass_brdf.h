/* SPDX-License-Identifier: Apache-2.0 */
/* Before and after the distribution: half vectors and cosines, then the BRDF. */

/*
 * h = wi + wo, not normalised, and its cosine hwo with either. Nonzero when some lane
 * has wi = -wo, where there is no h; f is 0 there by the horizon test.
 */
static int FN(pass_half)(size_t count, const real *restrict wix, const real *restrict wiy,
                         const real *restrict wiz, const real *restrict wox,
                         const real *restrict woy, const real *restrict woz, real *restrict hx,
                         real *restrict hy, real *restrict hz, real *restrict hwo) {
  int opposite = 0;
#pragma omp simd reduction(| : opposite)
  for (size_t i = 0; i < count; i++) {
    hx[i] = wix[i] + wox[i];
    hy[i] = wiy[i] + woy[i];
    hz[i] = wiz[i] + woz[i];
    opposite |= FN(no_direction)(hx[i], hy[i], hz[i]);
    hwo[i] = FN(half_cosine)(hx[i], hy[i], hz[i]);
  }
  return opposite;
}

static void FN(pass_unit)(size_t count, real *restrict hx, real *restrict hy, real *restrict hz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real scale = FN(scale_to_unit)(hx[i], hy[i], hz[i]);
    hx[i] *= scale;
    hy[i] *= scale;
    hz[i] *= scale;
  }
}

/* The cosines about n, 0 where light or eye is below either horizon. */
static void FN(pass_cosines)(size_t count, const real *restrict nx, const real *restrict ny,
                             const real *restrict nz, const real *restrict wix,
                             const real *restrict wiy, const real *restrict wiz,
                             const real *restrict wox, const real *restrict woy,
                             const real *restrict woz, real *restrict cosi, real *restrict coso) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real ci = nx[i] * wix[i] + ny[i] * wiy[i] + nz[i] * wiz[i];
    real co = nx[i] * wox[i] + ny[i] * woy[i] + nz[i] * woz[i];
    cosi[i] = ci > 0 ? ci : 0;
    coso[i] = ((ci > 0) & (co > 0) & (wiz[i] > 0) & (woz[i] > 0)) ? co : 0;
  }
}

/* The same about z, for the method that ignores n. */
static void FN(pass_cosines_none)(size_t count, const real *restrict wiz, const real *restrict woz,
                                  real *restrict cosi, real *restrict coso) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    cosi[i] = wiz[i] > 0 ? wiz[i] : 0;
    coso[i] = ((wiz[i] > 0) & (woz[i] > 0)) ? woz[i] : 0;
  }
}

/* d becomes f without Fresnel, and `white` Schlick's weight times `grazing` (1 or 0). */
static void FN(pass_brdf)(size_t count, real grazing, const real *restrict hwo,
                          const real *restrict cosi, const real *restrict coso, real *restrict d,
                          real *restrict white) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real f = FN(brdf_ashikhmin_shirley)(d[i], hwo[i], cosi[i], coso[i]);
    d[i] = coso[i] > 0 ? f : 0;
    white[i] = grazing * FN(schlick_weight)(hwo[i]);
  }
}

/* One colour channel: f * (f0 + (1 - f0) * white). */
static void FN(pass_fresnel)(size_t count, real f0, const real *restrict d,
                             const real *restrict white, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = d[i] * (f0 + (1 - f0) * white[i]);
}

/* The same with a reflectance per sample, clamped to [0, 1]; NaN counts as 0. */
static void FN(pass_fresnel_textured)(size_t count, const real *restrict f0, const real *restrict d,
                                      const real *restrict white, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real f = FN(minimum)(FN(maximum)(f0[i], 0), 1);
    out[i] = d[i] * (f + (1 - f) * white[i]);
  }
}
