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

/* What a loop computes of one sample; lowest: z of the lower one of wi and wo. */
typedef struct FN(ggx_sample) {
  real cosi, coso, hwo, f;
  int opposite;
} FN(ggx_sample);

/* Slopes of a direction, times L, and its cosine with n. */
typedef struct FN(ggx_slopes) {
  real x, y, c;
} FN(ggx_slopes);

LEAF FN(ggx_sample) FN(ggx_of)(FN(ggx_slopes) i, FN(ggx_slopes) o, real hh, real ll, real kx,
                               real ky, real peak, real gx, real gy, real lowest) {
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
  /* one comparison, as in lit_cosine; as bits, or gcc weaves it into that of the minimum below */
  real_bits lit = -(real_bits)(FN(minimum)(FN(minimum)(i.c, o.c), lowest) > 0);
  s.cosi = FN(maximum)(i.c, 0);
  s.coso = FN(from_bits)(FN(to_bits)(o.c) & lit);
  s.hwo = FN(minimum)(R(0.5) * FN(root)(hh), 1);
  s.f = FN(from_bits)(FN(to_bits)(value) & lit);
  s.opposite = !(hh > R(1e-30));
  return s;
}

LEAF FN(ggx_slopes)
    FN(ggx_carried)(real a, real c, real nx, real ny, real nz, real wx, real wy, real wz) {
  FN(ggx_slopes) s;
  s.x = FN(difference)(c, wx, a, wz);
  s.y = FN(dot2)(a, c, FN(difference)(nx, wy, ny, wx), FN(difference)(nz, wy, ny, wz));
  s.c = FN(dot)(nx, ny, nz, wx, wy, wz);
  return s;
}

LEAF FN(ggx_sample)
    FN(ggx_rotated)(real nx, real ny, real nz, real wix, real wiy, real wiz, real wox, real woy,
                    real woz, real hh, real kx, real ky, real peak, real gx, real gy) {
  real scale = FN(rotate_scale)(nx, nz), a = nx * scale, c = nz * scale;
  return FN(ggx_of)(FN(ggx_carried)(a, c, nx, ny, nz, wix, wiy, wiz),
                    FN(ggx_carried)(a, c, nx, ny, nz, wox, woy, woz), hh, a * a + c * c, kx, ky,
                    peak, gx, gy, FN(minimum)(wiz, woz));
}

LEAF FN(ggx_sample)
    FN(ggx_flat)(real nx, real ny, real nz, real wix, real wiy, real wiz, real wox, real woy,
                 real woz, real hh, real kx, real ky, real peak, real gx, real gy) {
  (void)nx, (void)ny, (void)nz;
  return FN(ggx_of)((FN(ggx_slopes)){wix, wiy, wiz}, (FN(ggx_slopes)){wox, woy, woz}, hh, 1, kx, ky,
                    peak, gx, gy, 1);
}

#define GGX_PASS(name, leaf, ...)                                                                  \
  static int FN(name)(size_t count, FN(shape) s, FN(vec) n, FN(vec) wi, FN(vec) wo,                \
                      real *restrict hwo, real *restrict cosi, real *restrict coso,                \
                      real *restrict f) {                                                          \
    int opposite = 0;                                                                              \
    SHAPE(s);                                                                                      \
    const real *restrict gx = s.gx, *restrict gy = s.gy;                                           \
    const real own_gx = *gx, own_gy = *gy;                                                         \
    (void)own_gx, (void)own_gy;                                                                    \
    ARRAYS(n);                                                                                     \
    ARRAYS(wi);                                                                                    \
    ARRAYS(wo);                                                                                    \
    _Pragma("omp simd reduction(| : opposite)") for (size_t i = 0; i < count; i++) {               \
      real hx = wix[i] + wox[i], hy = wiy[i] + woy[i], hz = wiz[i] + woz[i];                       \
      real hh = hx * hx + hy * hy + hz * hz;                                                       \
      FN(ggx_sample)                                                                               \
      r = FN(leaf)(nx[i], ny[i], nz[i], wix[i], wiy[i], wiz[i], wox[i], woy[i], woz[i], hh,        \
                   __VA_ARGS__);                                                                   \
      hwo[i] = r.hwo;                                                                              \
      cosi[i] = r.cosi;                                                                            \
      coso[i] = r.coso;                                                                            \
      f[i] = r.f;                                                                                  \
      opposite |= r.opposite;                                                                      \
    }                                                                                              \
    return opposite;                                                                               \
  }
GGX_PASS(pass_ggx_flat, ggx_flat, OWN, own_gx, own_gy)
GGX_PASS(pass_ggx_rotated, ggx_rotated, OWN, own_gx, own_gy)
GGX_PASS(pass_each_ggx_flat, ggx_flat, EACH, gx[i], gy[i])
GGX_PASS(pass_each_ggx_rotated, ggx_rotated, EACH, gx[i], gy[i])
#undef GGX_PASS

static int FN(is_fused)(const bsdf *b) {
  const shade_map map = b->carry.map;
  return b->mdf == SHADE_MDF_GGX && b->brdf == SHADE_BRDF_MICROFACET &&
         (map == SHADE_MAP_NONE || map == SHADE_MAP_ROTATE_X || map == SHADE_MAP_ROTATE_Y);
}

/* hwo, the cosines as pass_cosines leaves them, and f without Fresnel; returns as pass_half. */
static int FN(pass_fused)(const bsdf *b, FN(shape) s, size_t count, FN(vec) n, FN(vec) wi,
                          FN(vec) wo, real *hwo, real *cosi, real *coso, real *f) {
  if (b->carry.map == SHADE_MAP_NONE) {
    if (s.varies)
      return FN(pass_each_ggx_flat)(count, s, n, wi, wo, hwo, cosi, coso, f);
    return FN(pass_ggx_flat)(count, s, n, wi, wo, hwo, cosi, coso, f);
  }
  if (b->carry.map == SHADE_MAP_ROTATE_Y)
    s = FN(shape_swapped)(s), n = FN(vec_swapped)(n), wi = FN(vec_swapped)(wi),
    wo = FN(vec_swapped)(wo);
  if (s.varies)
    return FN(pass_each_ggx_rotated)(count, s, n, wi, wo, hwo, cosi, coso, f);
  return FN(pass_ggx_rotated)(count, s, n, wi, wo, hwo, cosi, coso, f);
}

/* The same for one sample. */
static inline FN(ggx_sample)
    FN(fused)(const bsdf *b, const real n[3], const real wi[3], const real wo[3]) {
  const int x = b->carry.map == SHADE_MAP_ROTATE_Y, y = !x;
  const real hx = wi[0] + wo[0], hy = wi[1] + wo[1], hz = wi[2] + wo[2];
  const real hh = hx * hx + hy * hy + hz * hz, peak = b->FN(peak);
  const real kx = x ? b->FN(ky) : b->FN(kx), ky = x ? b->FN(kx) : b->FN(ky);
  const real gx = x ? b->FN(gy) : b->FN(gx), gy = x ? b->FN(gx) : b->FN(gy);
  if (b->carry.map == SHADE_MAP_NONE)
    return FN(ggx_flat)(n[0], n[1], n[2], wi[0], wi[1], wi[2], wo[0], wo[1], wo[2], hh, kx, ky,
                        peak, gx, gy);
  return FN(ggx_rotated)(n[x], n[y], n[2], wi[x], wi[y], wi[2], wo[x], wo[y], wo[2], hh, kx, ky,
                         peak, gx, gy);
}
