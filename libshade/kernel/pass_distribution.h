/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Distribution pass: points of the lobe to D, one loop per distribution. Ashikhmin-Shirley, which
 * needs no slopes, goes from n and h to D in one loop per detail method.
 */
#define DISTRIBUTION_PASS(name)                                                                    \
  static void FN(pass_##name)(size_t count, real kx, real ky, real peak, const real *restrict t,   \
                              const real *restrict xx, const real *restrict yy,                    \
                              real *restrict d) {                                                  \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = {t[i], xx[i], yy[i]};                                                     \
      d[i] = FN(name)(p, kx, ky, peak);                                                            \
    }                                                                                              \
  }

DISTRIBUTION_PASS(ward)
DISTRIBUTION_PASS(ward_half)
DISTRIBUTION_PASS(beckmann)
DISTRIBUTION_PASS(ggx)
#undef DISTRIBUTION_PASS

#define ASHIKHMIN_SHIRLEY_PASS(method, ...)                                                        \
  static void FN(pass_as_##method)(size_t count, const real *restrict nx, const real *restrict ny, \
                                   const real *restrict nz, const real *restrict hx,               \
                                   const real *restrict hy, const real *restrict hz, real kx,      \
                                   real ky, real peak, real *restrict d) {                         \
    (void)nx, (void)ny, (void)nz;                                                                  \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) d[i] =                                  \
        FN(ashikhmin_shirley)(FN(detail_##method)(__VA_ARGS__), kx, ky, peak);                     \
  }

ASHIKHMIN_SHIRLEY_PASS(none, hx[i], hy[i], hz[i])
ASHIKHMIN_SHIRLEY_PASS(perturb_ratio, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
ASHIKHMIN_SHIRLEY_PASS(rotate_approximate, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
ASHIKHMIN_SHIRLEY_PASS(shortest_arc, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
ASHIKHMIN_SHIRLEY_PASS(deform_linear, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
ASHIKHMIN_SHIRLEY_PASS(deform_smooth, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
#undef ASHIKHMIN_SHIRLEY_PASS

static void FN(pass_ashikhmin_shirley)(const bsdf *b, size_t count, const real *nx, const real *ny,
                                       const real *nz, const real *hx, const real *hy,
                                       const real *hz, real *d) {
  const real kx = b->FN(kx), ky = b->FN(ky), peak = b->FN(peak);
  switch (b->map) {
  case SHADE_MAP_PERTURB_RATIO:
    FN(pass_as_perturb_ratio)(count, nx, ny, nz, hx, hy, hz, kx, ky, peak, d);
    break;
  case SHADE_MAP_APPROXIMATE_X:
    FN(pass_as_rotate_approximate)(count, nx, ny, nz, hx, hy, hz, kx, ky, peak, d);
    break;
  case SHADE_MAP_APPROXIMATE_Y:
    FN(pass_as_rotate_approximate)(count, ny, nx, nz, hy, hx, hz, ky, kx, peak, d);
    break;
  case SHADE_MAP_SHORTEST_ARC:
    FN(pass_as_shortest_arc)(count, nx, ny, nz, hx, hy, hz, kx, ky, peak, d);
    break;
  case SHADE_MAP_DEFORM_LINEAR:
    FN(pass_as_deform_linear)(count, nx, ny, nz, hx, hy, hz, kx, ky, peak, d);
    break;
  case SHADE_MAP_DEFORM_SMOOTH:
    FN(pass_as_deform_smooth)(count, nx, ny, nz, hx, hy, hz, kx, ky, peak, d);
    break;
  default:
    FN(pass_as_none)(count, nx, ny, nz, hx, hy, hz, kx, ky, peak, d);
  }
}

static void FN(pass_distribution)(const bsdf *b, size_t count, const real *t, const real *xx,
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
  default:
    FN(pass_ggx)(count, kx, ky, peak, t, xx, yy, d);
  }
}

/* The same decision for one sample. */
static inline real FN(distribution)(const bsdf *b, FN(lobe_ratio) r) {
  const real kx = b->FN(kx), ky = b->FN(ky), peak = b->FN(peak);
  switch (b->mdf) {
  case SHADE_MDF_WARD:
    return FN(ward)(FN(lobe_at)(r), kx, ky, peak);
  case SHADE_MDF_WARD_HALF:
    return FN(ward_half)(FN(lobe_at)(r), kx, ky, peak);
  case SHADE_MDF_BECKMANN:
    return FN(beckmann)(FN(lobe_at)(r), kx, ky, peak);
  case SHADE_MDF_GGX:
    return FN(ggx)(FN(lobe_at)(r), kx, ky, peak);
  default:
    return FN(ashikhmin_shirley)(r, kx, ky, peak);
  }
}

/* The conserving warps: d times their stretch. */
#define STRETCH_PASS(name, smooth, projected)                                                      \
  static void FN(pass_stretch_##name)(size_t count, const real *restrict nx,                       \
                                      const real *restrict ny, const real *restrict nz,            \
                                      const real *restrict hx, const real *restrict hy,            \
                                      const real *restrict hz, real *restrict d) {                 \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) d[i] *=                                 \
        FN(warp_stretch)(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i], smooth, projected);             \
  }

STRETCH_PASS(linear, 0, 0)
STRETCH_PASS(linear_projected, 0, 1)
STRETCH_PASS(smooth, 1, 0)
STRETCH_PASS(smooth_projected, 1, 1)
#undef STRETCH_PASS

static int FN(projected)(const bsdf *b) {
  return b->mdf == SHADE_MDF_BECKMANN || b->mdf == SHADE_MDF_GGX;
}

static void FN(pass_conserve)(const bsdf *b, size_t count, const real *nx, const real *ny,
                              const real *nz, const real *hx, const real *hy, const real *hz,
                              real *d) {
  if (b->map == SHADE_MAP_DEFORM_SMOOTH)
    (FN(projected)(b) ? FN(pass_stretch_smooth_projected)
                      : FN(pass_stretch_smooth))(count, nx, ny, nz, hx, hy, hz, d);
  else
    (FN(projected)(b) ? FN(pass_stretch_linear_projected)
                      : FN(pass_stretch_linear))(count, nx, ny, nz, hx, hy, hz, d);
}
