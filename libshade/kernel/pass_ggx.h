/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The microfacet BRDF of GGX in one loop, for the methods whose frame is a rotation: with
 * X, Y = L x, L y the unnormalised slopes of `rotate`'s leaf and c = n.w,
 *   D = peak ((L^2 |h|^2)/(L^2 (n.h)^2 + kx X^2 + ky Y^2))^2,
 *   1 + 2 Lambda(w) = S(w)/(L c), S(w)^2 = L^2 c^2 + ax^2 X^2 + ay^2 Y^2,
 *   f = D L/(2 (co S(wi) + ci S(wo))):
 * two divisions where leaf by leaf has six. X and Y of h = wi + wo are the sums of those of
 * wi and wo. Errors as leaf_brdf.h states them. [Heitz2014 Eq. 72, 85, 99]
 */

/* What a loop computes of one sample. */
typedef struct FN(ggx_sample) {
  real cosi, coso, hwo, f;
  int opposite;
} FN(ggx_sample);

/* Slopes of a direction, times L, and its cosine with n. */
typedef struct FN(ggx_slopes) {
  real x, y, c;
} FN(ggx_slopes);

LEAF FN(ggx_sample) FN(ggx_of)(FN(ggx_slopes) i, FN(ggx_slopes) o, real hh, real ll, real kx,
                               real ky, real peak, real gx, real gy, int above) {
  FN(ggx_sample) s;
  real x = i.x + o.x, y = i.y + o.y, d = i.c + o.c;
  real den = ll * (d * d) + (kx * (x * x) + ky * (y * y));
  /* at most 100, alpha being at most 10, but for wi and wo that nearly cancel */
  real ratio = ll * hh / FN(maximum)(den, R(1e-5) * (ll * hh) + TINY);
  real l = FN(root)(ll);
  real si = FN(root)(ll * (i.c * i.c) + (gx * (i.x * i.x) + gy * (i.y * i.y)));
  real so = FN(root)(ll * (o.c * o.c) + (gx * (o.x * o.x) + gy * (o.y * o.y)));
  real value = peak * (ratio * ratio) * l /
               FN(maximum)(2 * (o.c * si + i.c * so), R(1e-20) * FN(maximum)(l, R(1e-12)));
  int lit = (i.c > 0) & (o.c > 0) & above;
  s.cosi = i.c > 0 ? i.c : 0;
  s.coso = lit ? o.c : 0;
  s.hwo = FN(minimum)(R(0.5) * FN(root)(hh), 1);
  s.f = lit ? value : 0;
  s.opposite = !(hh > R(1e-30));
  return s;
}

#define GGX_PASS(name, ...)                                                                        \
  static int FN(pass_ggx_##name)(                                                                  \
      size_t count, real kx, real ky, real peak, real gx, real gy, const real *restrict nx,        \
      const real *restrict ny, const real *restrict nz, const real *restrict wix,                  \
      const real *restrict wiy, const real *restrict wiz, const real *restrict wox,                \
      const real *restrict woy, const real *restrict woz, real *restrict hwo, real *restrict cosi, \
      real *restrict coso, real *restrict f) {                                                     \
    int opposite = 0;                                                                              \
    (void)nx, (void)ny, (void)nz;                                                                  \
    _Pragma("omp simd reduction(| : opposite)") for (size_t k = 0; k < count; k++) {               \
      real hx = wix[k] + wox[k], hy = wiy[k] + woy[k], hz = wiz[k] + woz[k];                       \
      real hh = hx * hx + hy * hy + hz * hz;                                                       \
      FN(ggx_sample) s = __VA_ARGS__;                                                              \
      hwo[k] = s.hwo;                                                                              \
      cosi[k] = s.cosi;                                                                            \
      coso[k] = s.coso;                                                                            \
      f[k] = s.f;                                                                                  \
      opposite |= s.opposite;                                                                      \
    }                                                                                              \
    return opposite;                                                                               \
  }

LEAF FN(ggx_slopes)
    FN(ggx_carried)(real a, real c, real nx, real ny, real nz, real wx, real wy, real wz) {
  FN(ggx_slopes) s;
  s.x = c * wx - a * wz;
  s.y = a * (nx * wy - ny * wx) + c * (nz * wy - ny * wz);
  s.c = nx * wx + ny * wy + nz * wz;
  return s;
}

LEAF FN(ggx_sample)
    FN(ggx_rotated)(real nx, real ny, real nz, real wix, real wiy, real wiz, real wox, real woy,
                    real woz, real hh, real kx, real ky, real peak, real gx, real gy) {
  real scale = FN(rotate_scale)(nx, nz), a = nx * scale, c = nz * scale;
  return FN(ggx_of)(FN(ggx_carried)(a, c, nx, ny, nz, wix, wiy, wiz),
                    FN(ggx_carried)(a, c, nx, ny, nz, wox, woy, woz), hh, a * a + c * c, kx, ky,
                    peak, gx, gy, (wiz > 0) & (woz > 0));
}

GGX_PASS(none, FN(ggx_of)((FN(ggx_slopes)){wix[k], wiy[k], wiz[k]},
                          (FN(ggx_slopes)){wox[k], woy[k], woz[k]}, hh, 1, kx, ky, peak, gx, gy, 1))
GGX_PASS(rotate, FN(ggx_rotated)(nx[k], ny[k], nz[k], wix[k], wiy[k], wiz[k], wox[k], woy[k],
                                 woz[k], hh, kx, ky, peak, gx, gy))
#undef GGX_PASS

static int FN(is_fused)(const bsdf *b) {
  return b->mdf == SHADE_MDF_GGX && b->brdf == SHADE_BRDF_MICROFACET &&
         (b->map == SHADE_MAP_NONE || b->map == SHADE_MAP_ROTATE_X || b->map == SHADE_MAP_ROTATE_Y);
}

/* hwo, the cosines as pass_cosines leaves them, and f without Fresnel; returns as pass_half. */
static int FN(pass_fused)(const bsdf *b, size_t count, const real *const v[3][3], real *hwo,
                          real *cosi, real *coso, real *f) {
  const real kx = b->FN(kx), ky = b->FN(ky), peak = b->FN(peak), gx = b->FN(gx), gy = b->FN(gy);
  if (b->map == SHADE_MAP_NONE)
    return FN(pass_ggx_none)(count, kx, ky, peak, gx, gy, v[0][0], v[0][1], v[0][2], v[1][0],
                             v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], hwo, cosi, coso, f);
  if (b->map == SHADE_MAP_ROTATE_X)
    return FN(pass_ggx_rotate)(count, kx, ky, peak, gx, gy, v[0][0], v[0][1], v[0][2], v[1][0],
                               v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], hwo, cosi, coso, f);
  return FN(pass_ggx_rotate)(count, ky, kx, peak, gy, gx, v[0][1], v[0][0], v[0][2], v[1][1],
                             v[1][0], v[1][2], v[2][1], v[2][0], v[2][2], hwo, cosi, coso, f);
}
