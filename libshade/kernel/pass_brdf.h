/* SPDX-License-Identifier: Apache-2.0 */
/* Before and after the distribution: half vectors and cosines, then the BRDF. */

/*
 * h = wi + wo, not normalised, and its cosine hwo with either. Nonzero when some lane
 * has wi = -wo, where there is no h.
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

/*
 * The cosines about n; coso is 0 where light or eye is below either horizon. One comparison:
 * with several, gcc loads some arrays for some lanes only, and computes with what the others
 * held before.
 */
LEAF real FN(lit_cosine)(real ci, real co, real iz, real oz) {
  return FN(minimum)(FN(minimum)(ci, co), FN(minimum)(iz, oz)) > 0 ? co : 0;
}

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
    coso[i] = FN(lit_cosine)(ci, co, wiz[i], woz[i]);
  }
}

/* The same about z, for the method that ignores n. */
static void FN(pass_cosines_none)(size_t count, const real *restrict wiz, const real *restrict woz,
                                  real *restrict cosi, real *restrict coso) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    cosi[i] = wiz[i] > 0 ? wiz[i] : 0;
    coso[i] = FN(lit_cosine)(wiz[i], woz[i], wiz[i], woz[i]);
  }
}

/* d becomes f without Fresnel: 0 where coso is. li and lo may be any array but d. */
#define BRDF_PASS(name)                                                                            \
  static void FN(pass_brdf_##name)(size_t count, const real *restrict hwo,                         \
                                   const real *restrict cosi, const real *restrict coso,           \
                                   const real *li, const real *lo, real *restrict d) {             \
    (void)li, (void)lo;                                                                            \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(angles) a = {hwo[i], cosi[i], coso[i], li[i], lo[i]};                                     \
      real f = FN(brdf_##name)(d[i], a);                                                           \
      d[i] = coso[i] > 0 ? f : 0;                                                                  \
    }                                                                                              \
  }

BRDF_PASS(ashikhmin_shirley)
BRDF_PASS(ward_1992)
BRDF_PASS(ward_dur)
BRDF_PASS(ward_bounded)
BRDF_PASS(microfacet)
#undef BRDF_PASS

static void FN(pass_brdf)(const bsdf *b, size_t count, const real *hwo, const real *cosi,
                          const real *coso, const real *li, const real *lo, real *d) {
  switch (b->brdf) {
  case SHADE_BRDF_WARD_1992:
    FN(pass_brdf_ward_1992)(count, hwo, cosi, coso, li, lo, d);
    break;
  case SHADE_BRDF_WARD_DUR:
    FN(pass_brdf_ward_dur)(count, hwo, cosi, coso, li, lo, d);
    break;
  case SHADE_BRDF_WARD_BOUNDED:
    FN(pass_brdf_ward_bounded)(count, hwo, cosi, coso, li, lo, d);
    break;
  case SHADE_BRDF_MICROFACET:
    FN(pass_brdf_microfacet)(count, hwo, cosi, coso, li, lo, d);
    break;
  default:
    FN(pass_brdf_ashikhmin_shirley)(count, hwo, cosi, coso, li, lo, d);
  }
}

/* The same decision for one sample. */
LEAF real FN(brdf)(const bsdf *b, real d, FN(angles) a) {
  switch (b->brdf) {
  case SHADE_BRDF_WARD_1992:
    return FN(brdf_ward_1992)(d, a);
  case SHADE_BRDF_WARD_DUR:
    return FN(brdf_ward_dur)(d, a);
  case SHADE_BRDF_WARD_BOUNDED:
    return FN(brdf_ward_bounded)(d, a);
  case SHADE_BRDF_MICROFACET:
    return FN(brdf_microfacet)(d, a);
  default:
    return FN(brdf_ashikhmin_shirley)(d, a);
  }
}

/* Slopes of a direction, carried as h is, to 1 + 2 Lambda. */
static void FN(pass_smith_ggx)(size_t count, real gx, real gy, const real *restrict xx,
                               const real *restrict yy, real *restrict l) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    l[i] = FN(smith_ggx)(gx * xx[i] + gy * yy[i]);
}

static void FN(pass_smith_gaussian)(size_t count, real gx, real gy, const real *restrict xx,
                                    const real *restrict yy, real *restrict l) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    l[i] = FN(smith_gaussian)(gx * xx[i] + gy * yy[i]);
}

static void FN(pass_smith)(const bsdf *b, size_t count, const real *xx, const real *yy, real *l) {
  if (b->mdf == SHADE_MDF_GGX)
    FN(pass_smith_ggx)(count, b->FN(gx), b->FN(gy), xx, yy, l);
  else
    FN(pass_smith_gaussian)(count, b->FN(gx), b->FN(gy), xx, yy, l);
}

/* The same for one direction. */
LEAF real FN(smith)(const bsdf *b, const real n[3], const real w[3]) {
  FN(lobe_point) p = FN(lobe_at)(FN(detail)(b->shadow_map, n, w[0], w[1], w[2]));
  real slope2 = b->FN(gx) * p.xx + b->FN(gy) * p.yy;
  return b->mdf == SHADE_MDF_GGX ? FN(smith_ggx)(slope2) : FN(smith_gaussian)(slope2);
}

/* Schlick's weight times `grazing` (1 or 0). */
static void FN(pass_schlick)(size_t count, real grazing, const real *restrict hwo,
                             real *restrict white) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    white[i] = grazing * FN(schlick_weight)(hwo[i]);
}

/* One colour channel: f * (f0 + (1 - f0) * white). */
static void FN(pass_fresnel)(size_t count, real f0, const real *restrict d,
                             const real *restrict white, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = d[i] * (f0 + (1 - f0) * white[i]);
}

/* All three channels of a colour that no texture changes; grazing as in pass_schlick. */
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

/* A reflectance per sample, clamped to [0, 1]; NaN counts as 0. */
LEAF real FN(reflectance)(real f0) {
  return FN(minimum)(FN(maximum)(f0, 0), 1);
}

static void FN(pass_fresnel_textured)(size_t count, const real *restrict f0, const real *restrict d,
                                      const real *restrict white, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real f = FN(reflectance)(f0[i]);
    out[i] = d[i] * (f + (1 - f) * white[i]);
  }
}

static void FN(pass_fresnel_f82)(size_t count, real f0, real tint, const real *restrict d,
                                 const real *restrict hwo, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = d[i] * FN(fresnel_f82)(f0, tint, hwo[i]);
}

static void FN(pass_fresnel_f82_textured)(size_t count, const real *restrict f0, real tint,
                                          const real *restrict d, const real *restrict hwo,
                                          real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = d[i] * FN(fresnel_f82)(FN(reflectance)(f0[i]), tint, hwo[i]);
}

static void FN(pass_fresnel_conductor)(size_t count, real eta, real k, const real *restrict d,
                                       const real *restrict hwo, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = d[i] * FN(fresnel_conductor)(eta, k, hwo[i]);
}

/* Colour channel c of f; `texture` is its f0 per sample or NULL; white as pass_schlick made it. */
static void FN(pass_channel)(const bsdf *b, int c, size_t count, const real *texture, const real *d,
                             const real *hwo, const real *white, real *out) {
  const real f0 = b->FN(f0)[c], tint = b->FN(tint)[c];
  if (b->fresnel == SHADE_FRESNEL_CONDUCTOR)
    FN(pass_fresnel_conductor)(count, tint, b->FN(k)[c], d, hwo, out);
  else if (b->fresnel == SHADE_FRESNEL_F82 && texture)
    FN(pass_fresnel_f82_textured)(count, texture, tint, d, hwo, out);
  else if (b->fresnel == SHADE_FRESNEL_F82)
    FN(pass_fresnel_f82)(count, f0, tint, d, hwo, out);
  else if (texture)
    FN(pass_fresnel_textured)(count, texture, d, white, out);
  else
    FN(pass_fresnel)(count, f0, d, white, out);
}

/* The same decision for one sample. */
LEAF real FN(fresnel)(const bsdf *b, int c, real hwo) {
  const real f0 = b->FN(f0)[c], tint = b->FN(tint)[c];
  switch (b->fresnel) {
  case SHADE_FRESNEL_SCHLICK:
    return f0 + (1 - f0) * FN(schlick_weight)(hwo);
  case SHADE_FRESNEL_F82:
    return FN(fresnel_f82)(f0, tint, hwo);
  case SHADE_FRESNEL_CONDUCTOR:
    return FN(fresnel_conductor)(tint, b->FN(k)[c], hwo);
  default:
    return f0;
  }
}
