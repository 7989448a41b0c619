/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Detail pass: perturbed normals and half vectors to points of the lobe, one
 * loop per method so that no lane decides anything. Arrays are at most
 * BLOCK long and do not overlap.
 */
#define DETAIL_PASS(method, ...)                                                                   \
  static void FN(pass_##method)(size_t count, const real *restrict nx, const real *restrict ny,    \
                                const real *restrict nz, const real *restrict hx,                  \
                                const real *restrict hy, const real *restrict hz,                  \
                                real *restrict t, real *restrict xx, real *restrict yy) {          \
    (void)nx, (void)ny, (void)nz;                                                                  \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = FN(detail_##method)(__VA_ARGS__);                                         \
      t[i] = p.t;                                                                                  \
      xx[i] = p.xx;                                                                                \
      yy[i] = p.yy;                                                                                \
    }                                                                                              \
  }

DETAIL_PASS(none, hx[i], hy[i], hz[i])
DETAIL_PASS(perturb_ratio, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(perturb, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(rotate, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
#undef DETAIL_PASS

static void FN(pass_detail)(const shade_bsdf *b, size_t count, const real *nx, const real *ny,
                            const real *nz, const real *hx, const real *hy, const real *hz, real *t,
                            real *xx, real *yy) {
  if (b->detail == SHADE_DETAIL_NONE)
    FN(pass_none)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
  else if (b->detail == SHADE_DETAIL_PERTURB && b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY)
    FN(pass_perturb_ratio)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
  else if (b->detail == SHADE_DETAIL_PERTURB)
    FN(pass_perturb)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
  else if (b->swap_axes)
    FN(pass_rotate)(count, ny, nx, nz, hy, hx, hz, t, yy, xx);
  else
    FN(pass_rotate)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
}

/* The same decision for one sample. */
static inline FN(lobe_point)
    FN(detail)(const shade_bsdf *b, const real n[3], real hx, real hy, real hz) {
  if (b->detail == SHADE_DETAIL_NONE)
    return FN(detail_none)(hx, hy, hz);
  if (b->detail == SHADE_DETAIL_PERTURB)
    return FN(detail_perturb)(n[0], n[1], n[2], hx, hy, hz);
  if (!b->swap_axes)
    return FN(detail_rotate)(n[0], n[1], n[2], hx, hy, hz);
  FN(lobe_point) p = FN(detail_rotate)(n[1], n[0], n[2], hy, hx, hz);
  real swap = p.xx;
  p.xx = p.yy;
  p.yy = swap;
  return p;
}
